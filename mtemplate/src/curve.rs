//! Subsequence alignment. D(1,l) = c(1,l), and for k > 1
//! D(k,l) = min(D(k-1,l-1) + c(k,l), D(k-1,l-2) + c(k,l), D(k-2,l-1) + 2 c(k,l)),
//! with c the local cost of template column k and data frame l; the curve is D(K,l).

use std::ops::Range;

/// Cost of the best match that ends at each frame, and where it starts.
#[derive(Debug, Clone, PartialEq)]
pub struct DistanceCurve {
    /// Cost for each frame; `None` where no match can end.
    pub costs: Vec<Option<f64>>,
    /// First frame of that match; `None` where there is no cost.
    pub starts: Vec<Option<usize>>,
}

/// The cheapest match of a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Best {
    /// Its frames.
    pub span: Range<usize>,
    /// Its cost.
    pub cost: f64,
}

impl DistanceCurve {
    /// The cheapest match, the earliest end among equals; `None` when there is no match.
    pub fn best(&self) -> Option<Best> {
        let ends = self.costs.iter().zip(&self.starts).enumerate();
        ends.filter_map(|(end, (cost, start))| {
            Some(Best {
                span: (*start)?..end + 1,
                cost: (*cost)?,
            })
        })
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
    }
}

#[derive(Debug, Clone, Copy)]
struct Reached {
    cost: f64,
    start: usize,
}

/// Ties go to the first of (1,1), (1,2), (2,1).
pub(crate) fn distance_curve(
    n_columns: usize,
    words: &[u64],
    local: impl Fn(usize, u64) -> f64,
) -> DistanceCurve {
    let mut curve = DistanceCurve {
        costs: vec![None; words.len()],
        starts: vec![None; words.len()],
    };
    if n_columns < 2 {
        return curve;
    }
    // Invariant: before frame l, `before` is D(·,l-1) and `twice_before` is D(·,l-2).
    let mut before: Vec<Option<Reached>> = vec![None; n_columns];
    let mut twice_before = before.clone();
    let mut now = before.clone();
    for (frame, &word) in words.iter().enumerate() {
        now[0] = Some(Reached {
            cost: local(0, word),
            start: frame,
        });
        for k in 1..n_columns {
            let cost = local(k, word);
            let over_a_column = if k >= 2 { before[k - 2] } else { None };
            let ways = [
                step(before[k - 1], cost),
                step(twice_before[k - 1], cost),
                step(over_a_column, 2.0 * cost),
            ];
            // `min_by` keeps the first of equals.
            now[k] = ways
                .into_iter()
                .flatten()
                .min_by(|a, b| a.cost.total_cmp(&b.cost));
        }
        if let Some(reached) = now[n_columns - 1] {
            curve.costs[frame] = Some(reached.cost);
            curve.starts[frame] = Some(reached.start);
        }
        // The oldest of the three is overwritten next.
        std::mem::swap(&mut before, &mut twice_before);
        std::mem::swap(&mut before, &mut now);
    }
    curve
}

fn step(from: Option<Reached>, cost: f64) -> Option<Reached> {
    from.map(|from| Reached {
        cost: from.cost + cost,
        ..from
    })
}
