//! The textbook recursion over cells, without strips, vectors, or packed steps.

use dtw::ndarray::Array2;
use dtw::{Band, Ends, LocalCost, Missing, Step};

/// What a path may do.
#[derive(Debug, Clone)]
pub(crate) struct Rules {
    pub(crate) band: Band,
    pub(crate) steps: Vec<Step>,
    pub(crate) ends: Ends,
}

/// Cost and pairs of the cheapest path.
pub(crate) type Best = Option<(f64, Vec<(usize, usize)>)>;

#[derive(Clone, Copy)]
enum Cell {
    Unknown,
    Closed,
    Reached {
        cost: f64,
        from: Option<(usize, usize)>,
    },
}

/// Cheapest path through a matrix of local costs, trying every predecessor of every cell.
pub(crate) fn align(costs: &Array2<f64>, rules: &Rules) -> Best {
    let (n, m) = costs.dim();
    if n == 0 || m == 0 {
        return None;
    }
    let mut known = Array2::from_elem((n, m), Cell::Unknown);
    let ends = match rules.ends {
        Ends::Closed | Ends::OpenBegin => vec![m - 1],
        Ends::OpenEnd | Ends::Open => (0..m).collect(),
    };
    let mut best: Option<(f64, usize)> = None;
    for column in ends {
        if let Cell::Reached { cost, .. } = reach(costs, rules, &mut known, (n - 1, column))
            && best.is_none_or(|(least, _)| cost < least)
        {
            best = Some((cost, column));
        }
    }
    let (cost, column) = best?;
    let mut pairs = vec![];
    let mut at = Some((n - 1, column));
    while let Some(cell) = at {
        pairs.push(cell);
        at = match known[cell] {
            Cell::Reached { from, .. } => from,
            _ => unreachable!("the path was reached"),
        };
    }
    pairs.reverse();
    Some((cost, pairs))
}

fn reach(
    costs: &Array2<f64>,
    rules: &Rules,
    known: &mut Array2<Cell>,
    (i, j): (usize, usize),
) -> Cell {
    if !matches!(known[[i, j]], Cell::Unknown) {
        return known[[i, j]];
    }
    let here = costs[[i, j]];
    if !here.is_finite() || !is_inside(&rules.band, (i, j), costs.dim()) {
        known[[i, j]] = Cell::Closed;
        return Cell::Closed;
    }
    // With all weights 1 it is the predecessors that are compared, else the sums.
    let is_unit = rules.steps.iter().all(|step| step.weight == 1.0);
    let open = matches!(rules.ends, Ends::OpenBegin | Ends::Open);
    let mut best = Cell::Closed;
    if i == 0 && (j == 0 || open) {
        best = Cell::Reached {
            cost: if is_unit { 0.0 } else { here },
            from: None,
        };
    }
    for step in &rules.steps {
        if i < step.rows || j < step.columns {
            continue;
        }
        let from = (i - step.rows, j - step.columns);
        let Cell::Reached { cost, .. } = reach(costs, rules, known, from) else {
            continue;
        };
        let through = if is_unit {
            cost
        } else {
            cost + step.weight * here
        };
        let is_better = match best {
            Cell::Reached { cost, .. } => through < cost,
            _ => true,
        };
        if is_better {
            best = Cell::Reached {
                cost: through,
                from: Some(from),
            };
        }
    }
    if let Cell::Reached { cost, .. } = &mut best
        && is_unit
    {
        *cost += here;
    }
    known[[i, j]] = best;
    best
}

/// The bands by their definitions, cell by cell.
pub(crate) fn is_inside(band: &Band, (i, j): (usize, usize), (n, m): (usize, usize)) -> bool {
    match band {
        Band::SakoeChiba(radius) => i.abs_diff(j) <= radius.radius(),
        Band::Slanted(radius) => (0..m)
            .filter(|&column| is_on_line(i, column, (n, m)))
            .any(|column| column.abs_diff(j) <= radius.radius()),
        Band::Itakura(slope) => {
            let slope = slope.columns_per_row();
            let (i, j) = (i as f64, j as f64);
            let (left, right) = (n as f64 - 1.0 - i, m as f64 - 1.0 - j);
            j <= slope * i && i <= slope * j && right <= slope * left && left <= slope * right
        }
        Band::Rows(rows) => rows[i].contains(&j),
        _ => true,
    }
}

/// Whether the line from corner to corner comes closer than half a column to `j` while it is
/// within half a row of `i`.
fn is_on_line(i: usize, j: usize, (n, m): (usize, usize)) -> bool {
    if n == 1 {
        return true;
    }
    let (i, j, run, rise) = (i as i128, j as i128, n as i128 - 1, m as i128 - 1);
    let (low, high) = ((2 * i - 1) * rise, (2 * i + 1) * rise);
    2 * run * j > low - run && 2 * run * j < high + run
}

/// Local costs by their definitions.
pub(crate) fn costs(
    local: LocalCost,
    missing: Missing,
    a: &Array2<f64>,
    b: &Array2<f64>,
) -> Array2<f64> {
    Array2::from_shape_fn((a.nrows(), b.nrows()), |(i, j)| {
        let mut pairs = vec![];
        for d in 0..a.ncols() {
            let (x, y) = (a[[i, d]], b[[j, d]]);
            if missing == Missing::Closes || !(x.is_nan() || y.is_nan()) {
                pairs.push((x, y));
            }
        }
        let share = if pairs.len() == a.ncols() {
            1.0
        } else if pairs.is_empty() {
            f64::NAN
        } else {
            a.ncols() as f64 / pairs.len() as f64
        };
        let mut sum = 0.0;
        match local {
            LocalCost::Manhattan => {
                for (x, y) in pairs {
                    sum += (x - y).abs();
                }
                sum * share
            }
            LocalCost::Cosine => {
                let (mut xx, mut yy) = (0.0, 0.0);
                for (x, y) in pairs {
                    sum += x * y;
                    xx += x * x;
                    yy += y * y;
                }
                if a.ncols() == 0 {
                    0.0
                } else {
                    1.0 - sum / (xx.sqrt() * yy.sqrt())
                }
            }
            _ => {
                for (x, y) in pairs {
                    sum += (x - y).powi(2);
                }
                if local == LocalCost::Euclidean {
                    (sum * share).sqrt()
                } else {
                    sum * share
                }
            }
        }
    })
}

/// Sum of the weighted local costs along a path; `None` when it does not keep to the rules.
pub(crate) fn cost_of(costs: &Array2<f64>, rules: &Rules, pairs: &[(usize, usize)]) -> Option<f64> {
    let (n, m) = costs.dim();
    let (first, last) = (*pairs.first()?, *pairs.last()?);
    let open_begin = matches!(rules.ends, Ends::OpenBegin | Ends::Open);
    let open_end = matches!(rules.ends, Ends::OpenEnd | Ends::Open);
    let starts = first.0 == 0 && (open_begin || first.1 == 0);
    let ends = last.0 == n - 1 && (open_end || last.1 == m - 1);
    if !starts || !ends || !is_inside(&rules.band, first, (n, m)) {
        return None;
    }
    let mut sum = costs[first];
    for pair in pairs.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let advance = (to.0.checked_sub(from.0)?, to.1.checked_sub(from.1)?);
        let fits = |step: &&Step| (step.rows, step.columns) == advance;
        let weights = rules.steps.iter().filter(fits).map(|step| step.weight);
        if !is_inside(&rules.band, to, (n, m)) {
            return None;
        }
        sum += weights.min_by(f64::total_cmp)? * costs[to];
    }
    Some(sum)
}
