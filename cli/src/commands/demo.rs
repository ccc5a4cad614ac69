//! `motif demo`.

/// The seed of the corpus unless another is asked for.
pub const SEED: u64 = 2006;

use crate::args::{DemoArgs, Global};
use crate::failure::{Exit, Failure};

/// Runs.
///
/// # Errors
/// none
pub fn run(_: &DemoArgs, _: &Global) -> Result<Exit, Failure> {
    Ok(Exit::Ok)
}
