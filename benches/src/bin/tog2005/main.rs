//! Work of `cargo xtask paper tog2005`: Tables 2 and 3 and the three retrieval examples of Müller,
//! Röder and Clausen 2005, section 6, on the recordings of a data folder, beside the paper's figures.
//!
//! `tog2005 DATA` prints to standard output. All but the times is the same on every run.

#![cfg_attr(test, allow(clippy::unwrap_used))]

use std::env;
use std::path::PathBuf;

use anyhow::{Context, Result};

mod asked;
mod clips;
mod examples;
mod indexing;
mod judgement;
mod motions;
mod naive;
mod queries;
mod random;
mod table;

use clips::Part;
use indexing::PartIndex;

/// Words per second: every frame, as the paper indexes, and the rate of the later papers.
const RATES: [f64; 2] = [120.0, 30.0];

fn main() -> Result<()> {
    let data: PathBuf = env::args_os().nth(1).context("DATA expected")?.into();
    let clips = clips::find(&data)?;
    let mut indexes: Vec<Vec<PartIndex>> = Vec::new();
    for rate in RATES {
        let parts = Part::EACH.into_iter();
        let built = parts.map(|part| PartIndex::build(&clips, part, rate));
        indexes.push(built.collect::<Result<_>>()?);
    }
    print!("{}", indexing::table(clips.len(), &indexes));
    let upper = indexes.iter().flatten().filter(|i| i.part == Part::Upper);
    let upper: Vec<&PartIndex> = upper.collect();
    print!("{}", random::table(&upper)?);
    for indexes in &indexes {
        print!("{}", examples::report(&clips, indexes)?);
    }
    Ok(())
}
