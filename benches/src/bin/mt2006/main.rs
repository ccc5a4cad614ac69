//! Work of `cargo xtask paper mt2006`: Tables 1 to 5 of Müller and Röder 2006 on the HDM05 classes of a
//! data folder, beside the paper's figures.
//!
//! `mt2006 DATA [--ablations]` prints to standard output. All but the times is the same on every run.

#![cfg_attr(test, allow(clippy::unwrap_used))]

use std::env;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};

mod ablations;
mod published;
mod table1;
mod table2;
mod table3;
mod table4;
mod table5;
mod work;

use published::Published;
use work::Work;

fn main() -> Result<()> {
    let mut args = env::args_os().skip(1);
    let data: PathBuf = args.next().context("DATA expected")?.into();
    let wants_ablations = match args.next() {
        None => false,
        Some(option) if option == "--ablations" => true,
        Some(option) => bail!("expected --ablations, found {}", option.display()),
    };
    let published = Published::read(&data)?;
    let work = Work::new(&data)?;
    print!("{}", table1::report(&work)?);
    print!("{}", table2::report(&work, &published)?);
    print!("{}", table3::report(&work)?);
    print!("{}", table4::report(&work)?);
    print!("{}", table5::report(&work)?);
    if wants_ablations {
        print!("{}", ablations::report(&work, &published)?);
    }
    Ok(())
}
