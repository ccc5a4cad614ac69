use clap::{Args, ValueEnum};
use segidx::Engine;

/// How the segments of an example are compared, one by one.
#[derive(Args, Clone, Debug, Default)]
pub struct SegmentArgs {
    /// Compare segment K of the query on these features alone, such as 2:F5,*knee*; -NAME leaves one out, +NAME adds one; may be given more than once
    #[arg(
        long = "segment",
        value_name = "K:NAMES",
        conflicts_with = "scene",
        allow_hyphen_values = true
    )]
    pub segments: Vec<String>,
    /// Accept at segment K of the query also what differs from it like this, such as 2:rknee_bent=0,F5=1; may be given more than once
    #[arg(long = "or", value_name = "K:NAME=0|1", conflicts_with = "scene")]
    pub alternatives: Vec<String>,
}

/// How hits are found, which changes none of them.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct PlanArgs {
    /// Say which indexes and engines found the hits, and what they touched
    #[arg(long, conflicts_with = "scene")]
    pub explain_plan: bool,
    /// Where candidates come from
    #[arg(long, value_enum, default_value_t = EngineArg::Auto, conflicts_with = "scene")]
    pub engine: EngineArg,
    /// Which indexes are searched, where several have the answer
    #[arg(long, value_enum, default_value_t = IndexArg::Auto, conflicts_with = "scene")]
    pub indexes: IndexArg,
}

/// Where candidates come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum EngineArg {
    /// The one that is expected to cost least
    #[default]
    Auto,
    /// The inverted lists of all segments of the query, joined
    Lists,
    /// The inverted lists of its rarest segment
    Pivot,
    /// All segments in order
    Scan,
}

impl EngineArg {
    /// The engine.
    #[must_use]
    pub fn engine(self) -> Engine {
        match self {
            EngineArg::Auto => Engine::Auto,
            EngineArg::Lists => Engine::Lists,
            EngineArg::Pivot => Engine::Pivot,
            EngineArg::Scan => Engine::Scan,
        }
    }
}

/// Which indexes are searched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum IndexArg {
    /// Those that are expected to cost least
    #[default]
    Auto,
    /// The index of all features
    Joint,
    /// The indexes of the parts of the feature set, then that of all features where they agree
    Parts,
}
