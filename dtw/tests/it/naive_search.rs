//! Search by its definition: every candidate, no bounds.

use dtw::Sample;
use dtw::ndarray::{Array2, ArrayView2, s};

/// Zero mean and unit population deviation in each dimension, or zeros.
pub(crate) fn z_normalised<T: Sample>(frames: ArrayView2<'_, T>) -> Array2<T> {
    let (n, dims) = frames.dim();
    let mut normal = Array2::from_elem((n, dims), T::zero());
    for d in 0..dims {
        let samples: Vec<f64> = (0..n).map(|i| frames[[i, d]].into()).collect();
        let mut mean = 0.0;
        for x in &samples {
            mean += x;
        }
        mean /= n as f64;
        let mut variance = 0.0;
        for x in &samples {
            variance += (x - mean) * (x - mean);
        }
        let deviation = (variance / n as f64).sqrt();
        let is_constant = samples.iter().all(|x| *x == samples[0] && x.is_finite());
        for i in 0..n {
            normal[[i, d]] = if is_constant || deviation == 0.0 {
                T::zero()
            } else {
                T::from((samples[i] - mean) / deviation).unwrap()
            };
        }
    }
    normal
}

/// All (cost, start) of windows with a path.
pub(crate) fn windows<T: Sample>(
    n: usize,
    series: &Array2<T>,
    cost: impl Fn(ArrayView2<'_, T>) -> Option<f64>,
) -> Vec<(f64, usize)> {
    if n == 0 {
        return vec![];
    }
    (0..(series.nrows() + 1).saturating_sub(n))
        .filter_map(|start| Some((cost(series.slice(s![start..start + n, ..]))?, start)))
        .collect()
}

/// Takes the cheapest, the first of equals, and drops what is too near to it, `k` times.
pub(crate) fn choose(
    mut costs: Vec<(f64, usize)>,
    k: usize,
    exclusion: usize,
) -> Vec<(usize, f64)> {
    let mut chosen = vec![];
    while chosen.len() < k && !costs.is_empty() {
        let mut best = costs[0];
        for &(cost, start) in &costs {
            if cost < best.0 || cost == best.0 && start < best.1 {
                best = (cost, start);
            }
        }
        chosen.push((best.1, best.0));
        costs.retain(|&(_, start)| start != best.1 && start.abs_diff(best.1) >= exclusion);
    }
    chosen
}
