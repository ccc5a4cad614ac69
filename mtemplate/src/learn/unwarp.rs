//! An average back in real time: columns of weight 1.

use crate::learn::ROUNDING;
use crate::learn::warp::Weighted;

/// The step function of cumulative weight, averaged over cells of weight 1. There are as many as
/// the whole weight, rounded up; the last has what remains.
pub(super) fn unwarp(average: &Weighted) -> Weighted {
    let n_features = average.n_features;
    let total: f64 = average.weights.iter().sum();
    let n_cells = ((total - ROUNDING).ceil() as usize).max(1);
    let mut values = vec![0.0; n_cells * n_features];
    let mut masses = vec![0.0; n_cells];
    let mut at = 0.0;
    for (column, weight) in average.columns() {
        let end = at + weight;
        let mut from: f64 = at;
        // Termination: `to` is the next whole number or `end`, and so more than `from`.
        while from < end {
            let cell = (from as usize).min(n_cells - 1);
            let next = (cell + 1) as f64;
            let to = if cell + 1 == n_cells {
                end
            } else {
                end.min(next)
            };
            let part = to - from;
            for (sum, value) in values[cell * n_features..].iter_mut().zip(column) {
                *sum += part * value;
            }
            masses[cell] += part;
            from = to;
        }
        at = end;
    }
    for (cell, mass) in values.chunks_exact_mut(n_features).zip(&masses) {
        // A mean of shares may be rounded to a little more than 1.
        cell.iter_mut()
            .for_each(|value| *value = (*value / mass).clamp(0.0, 1.0));
    }
    let mut weights = vec![1.0; n_cells];
    weights[n_cells - 1] = total - (n_cells - 1) as f64;
    Weighted {
        n_features,
        values,
        weights,
    }
}
