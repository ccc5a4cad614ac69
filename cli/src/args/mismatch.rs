use clap::Args;

/// What of an example may be wrong.
#[derive(Args, Clone, Debug, Default)]
pub struct MismatchArgs {
    /// Let up to M segments of the query differ
    #[arg(long, value_name = "M", conflicts_with = "scene")]
    pub mismatches: Option<usize>,
    /// Let only these segments of the query differ, counted from 1, such as 2,4 [default: any]
    #[arg(
        long,
        value_name = "POSITIONS",
        value_delimiter = ',',
        requires = "mismatches"
    )]
    pub at: Vec<usize>,
}
