use std::fmt::Debug;

use num_traits::Float;

use crate::lanes::Real;

/// An element of a sequence: `f32` or `f64`, which is also what its local costs and their sums are
/// computed in.
///
/// `f64` gives the textbook's result to the last bit on every machine. `f32` is several times
/// faster; see the crate's README for its error.
pub trait Sample: Float + Into<f64> + Real + Debug + Default + Send + Sync + 'static {}

impl Sample for f32 {}
impl Sample for f64 {}
