//! The textbook recursion, without rows, bands of storage, or step bytes.

use dtw::LocalCost;
use dtw::ndarray::Array2;

/// Cheapest cost and path to the last pair, trying every predecessor of every cell.
pub(crate) fn align(
    a: &Array2<f64>,
    b: &Array2<f64>,
    local: LocalCost,
    radius: Option<usize>,
) -> Option<(f64, Vec<(usize, usize)>)> {
    if a.nrows() == 0 || b.nrows() == 0 {
        return None;
    }
    reach(a, b, local, radius, (a.nrows() - 1, b.nrows() - 1))
}

fn reach(
    a: &Array2<f64>,
    b: &Array2<f64>,
    local: LocalCost,
    radius: Option<usize>,
    (i, j): (usize, usize),
) -> Option<(f64, Vec<(usize, usize)>)> {
    if radius.is_some_and(|radius| i.abs_diff(j) > radius) {
        return None;
    }
    let here = cost(a, b, local, i, j);
    if !here.is_finite() {
        return None;
    }
    if (i, j) == (0, 0) {
        return Some((here, vec![(0, 0)]));
    }
    let mut best: Option<(f64, Vec<(usize, usize)>)> = None;
    for (di, dj) in [(1, 1), (0, 1), (1, 0)] {
        if i < di || j < dj {
            continue;
        }
        let Some(found) = reach(a, b, local, radius, (i - di, j - dj)) else {
            continue;
        };
        if best.as_ref().is_none_or(|best| found.0 < best.0) {
            best = Some(found);
        }
    }
    let (cost, mut steps) = best?;
    steps.push((i, j));
    Some((cost + here, steps))
}

fn cost(a: &Array2<f64>, b: &Array2<f64>, local: LocalCost, i: usize, j: usize) -> f64 {
    let mut sum = 0.0;
    for d in 0..a.ncols() {
        let difference = a[[i, d]] - b[[j, d]];
        sum += if local == LocalCost::Manhattan {
            difference.abs()
        } else {
            difference.powi(2)
        };
    }
    if local == LocalCost::Euclidean {
        sum.sqrt()
    } else {
        sum
    }
}
