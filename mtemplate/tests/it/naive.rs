//! The definitions, cell by cell, without words or rolling rows.

use mtemplate::Cell;
use mtemplate::ndarray::{ArrayView1, ArrayView2};

/// 0, 1 or wildcard, straight from the thresholds.
pub(crate) fn quantize(value: f64, threshold: f64) -> Cell {
    if value <= threshold {
        Cell::Zero
    } else if value >= 1.0 - threshold {
        Cell::One
    } else {
        Cell::Wildcard
    }
}

/// Local cost of column k and one frame.
pub(crate) fn local_cost(
    values: ArrayView2<'_, f64>,
    weights: ArrayView1<'_, f64>,
    threshold: f64,
    k: usize,
    word: u64,
) -> f64 {
    let (mut asked, mut disagreements) = (0, 0);
    for feature in 0..values.ncols() {
        let is_on = (word >> feature) & 1 == 1;
        match quantize(values[[k, feature]], threshold) {
            Cell::Wildcard => continue,
            Cell::Zero => disagreements += usize::from(is_on),
            Cell::One => disagreements += usize::from(!is_on),
        }
        asked += 1;
    }
    if asked == 0 {
        return 0.0;
    }
    disagreements as f64 / asked as f64 * ((weights[k] + 1.0) / 2.0) / values.nrows() as f64
}

/// Cost and start of the best match with column k at frame l, by trying every way there.
pub(crate) fn reach(c: &dyn Fn(usize, usize) -> f64, k: usize, l: usize) -> Option<(f64, usize)> {
    if k == 0 {
        return Some((c(0, l), l));
    }
    let mut best: Option<(f64, usize)> = None;
    for (dk, dl, weight) in [(1, 1, 1.0), (1, 2, 1.0), (2, 1, 2.0)] {
        if k < dk || l < dl {
            continue;
        }
        let Some((before, start)) = reach(c, k - dk, l - dl) else {
            continue;
        };
        let cost = before + weight * c(k, l);
        if best.is_none_or(|(best, _)| cost < best) {
            best = Some((cost, start));
        }
    }
    best
}
