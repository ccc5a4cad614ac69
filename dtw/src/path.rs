/// A cheapest way to walk both sequences.
#[derive(Debug, Clone, PartialEq)]
pub struct WarpingPath {
    /// Aligned pairs of frames in order, from (0, 0) to (n - 1, m - 1) unless the
    /// [`Ends`](crate::Ends) are open; each follows from the one before by a step of the pattern.
    pub steps: Vec<(usize, usize)>,
    /// Sum of the weighted local costs of all pairs.
    pub cost: f64,
}
