/// A cheapest way to walk both sequences from their first to their last frames.
#[derive(Debug, Clone, PartialEq)]
pub struct WarpingPath {
    /// Aligned pairs of frames, from `(0, 0)` to `(n - 1, m - 1)`; each step advances one or both
    /// by one.
    pub steps: Vec<(usize, usize)>,
    /// Sum of the local costs of all pairs.
    pub cost: f64,
}
