use clap::{Args, ValueEnum};

use crate::commands::search::{DEFAULT_REFINED, Ranking};
use crate::failure::Failure;

/// In which order hits are told.
#[derive(Args, Clone, Debug, Default)]
pub struct RankArgs {
    /// What hits are put in order by
    #[arg(long = "rank", value_enum, value_name = "BY", default_value_t = RankBy::Frames, conflicts_with = "scene")]
    pub by: RankBy,
    /// How many of the best hits by frames --rank dtw compares with the example; 0 for all [default: 50]
    #[arg(long, value_name = "N", conflicts_with = "scene")]
    pub refine: Option<usize>,
}

/// What hits are put in order by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum RankBy {
    /// How much the lengths of their segments differ from the example's
    #[default]
    Frames,
    /// How far their poses are from the example's, aligned in time, in metres per step; reads their files
    Dtw,
}

impl RankArgs {
    /// The order.
    ///
    /// # Errors
    /// [`Failure::Usage`] if hits are to be refined, but not ranked by it.
    pub fn ranking(&self) -> Result<Ranking, Failure> {
        match (self.by, self.refine) {
            (RankBy::Frames, Some(_)) => Err(Failure::Usage(
                "--refine: expected --rank dtw, found frames".to_owned(),
            )),
            (RankBy::Frames, None) => Ok(Ranking::Frames),
            (RankBy::Dtw, refine) => Ok(Ranking::Dtw {
                refine: refine.unwrap_or(DEFAULT_REFINED),
            }),
        }
    }
}
