//! An average back in real time as the authors did it: columns that are too heavy are repeated,
//! those that are too light merged.

use crate::learn::ROUNDING;
use crate::learn::warp::Weighted;

/// Columns are merged until they weigh this much.
const ENOUGH: f64 = 0.75;

/// Expands, contracts, and expands what has become too heavy by it.
pub(super) fn balance(average: &Weighted) -> Weighted {
    expand(&contract(&expand(average)))
}

fn empty(n_features: usize) -> Weighted {
    Weighted {
        n_features,
        values: Vec::new(),
        weights: Vec::new(),
    }
}

/// Each column as often as its weight in whole numbers says, halves rounded up, and once at least;
/// the weight is shared out.
fn expand(columns: &Weighted) -> Weighted {
    let mut expanded = empty(columns.n_features);
    for (column, weight) in columns.columns() {
        let n = (weight + ROUNDING).round().max(1.0);
        for _ in 0..n as usize {
            expanded.push(column, weight / n);
        }
    }
    expanded
}

/// From left to right, columns are merged until they weigh enough; what remains at the end goes to
/// the column before.
fn contract(columns: &Weighted) -> Weighted {
    let mut merged = empty(columns.n_features);
    let is_light = |merged: &Weighted| {
        let last = merged.weights.last();
        last.is_some_and(|&last| last < ENOUGH - ROUNDING)
    };
    for (column, weight) in columns.columns() {
        if is_light(&merged) {
            join(&mut merged, column, weight);
        } else {
            merged.push(column, weight);
        }
    }
    if is_light(&merged) && merged.weights.len() > 1 {
        let weight = merged.weights.pop().expect("two or more");
        let rest = merged
            .values
            .split_off(merged.values.len() - merged.n_features);
        join(&mut merged, &rest, weight);
    }
    merged
}

/// The last column becomes the mean, by weight, of itself and another.
fn join(columns: &mut Weighted, column: &[f64], weight: f64) {
    let start = columns.values.len() - columns.n_features;
    let last = columns.weights.last_mut().expect("one or more");
    let total = *last + weight;
    for (value, other) in columns.values[start..].iter_mut().zip(column) {
        *value = ((*value * *last + other * weight) / total).clamp(0.0, 1.0);
    }
    *last = total;
}
