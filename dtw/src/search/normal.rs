//! Zero mean and unit deviation, by the definition.

use ndarray::{Array2, ArrayView2, ArrayViewMut1};

use crate::Sample;

/// Each dimension minus its mean and divided by its population standard deviation, both in `f64`
/// and in order of frames; zeros for a dimension without deviation.
pub(super) fn z_normalised<T: Sample>(frames: ArrayView2<'_, T>) -> Array2<T> {
    let mut normal = frames.to_owned();
    for dimension in normal.columns_mut() {
        z_normalise(dimension);
    }
    normal
}

fn z_normalise<T: Sample>(mut samples: ArrayViewMut1<'_, T>) {
    let n_samples = samples.len() as f64;
    let sum = samples.fold(0.0, |sum, &x| sum + x.into());
    let mean = sum / n_samples;
    let squares = samples.fold(0.0, |sum, &x| {
        let difference = x.into() - mean;
        sum + difference * difference
    });
    let deviation = (squares / n_samples).sqrt();
    // The mean of equal samples is rounded, so that their deviation need not be zero.
    let is_constant = mean.is_finite() && samples.iter().all(|&x| x == samples[0]);
    if is_constant || deviation == 0.0 {
        samples.fill(T::zero());
    } else {
        samples.mapv_inplace(|x| T::from((x.into() - mean) / deviation).unwrap_or_else(T::nan));
    }
}
