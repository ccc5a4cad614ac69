//! Work of `cargo xtask paper bundles2007`: section 5 of Beaudoin, van de Panne and Poulin 2007 on the CMU
//! takes of a data folder, beside the paper's figures.
//!
//! `bundles2007 DATA [--growth]` prints to standard output. All but times and memory is the same on every
//! run. With `--growth` there are only times and memory, from 1,000 to 400,000 frames.

#![cfg_attr(test, allow(clippy::unwrap_used))]

use std::env;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};

mod clock;
mod growth;
mod largest;
mod library;
mod mixed;
mod noise;
mod noisy;
mod overlap;
mod pure;
mod rho;
mod stages;
mod takes;
mod times;
mod ways;

use takes::Sets;

fn main() -> Result<()> {
    let mut args = env::args_os().skip(1);
    let data: PathBuf = args.next().context("DATA expected")?.into();
    let rest: Vec<String> = args.map(|arg| arg.to_string_lossy().into_owned()).collect();
    match rest.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => tables(&data),
        ["--growth"] => growth::report(&data),
        [growth::SIZE, n_frames] => growth::measure(&data, n_frames.parse()?),
        _ => bail!("expected --growth, found {}", rest.join(" ")),
    }
}

fn tables(data: &std::path::Path) -> Result<()> {
    let sets = Sets::read(data)?;
    for report in [
        largest::report,
        rho::report,
        mixed::report,
        noise::report,
        times::report,
    ] {
        print!("{}", report(&sets)?);
    }
    print!("{}", ways::report(data, &sets)?);
    print!("{}", pure::report(data, &sets)?);
    Ok(())
}
