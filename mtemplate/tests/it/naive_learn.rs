//! Learning by the definitions: one alignment at a time, columns as vectors of numbers.

use mtemplate::{LearnConfig, MotionTemplate, Unwarp};

/// Values and weight.
type Column = (Vec<f64>, f64);

/// Sums of weights that miss a bound by no more have reached it.
const ROUNDING: f64 = 1e-9;

pub(crate) fn columns(template: &MotionTemplate) -> Vec<Column> {
    (0..template.n_columns())
        .map(|k| (template.values().row(k).to_vec(), template.weights()[k]))
        .collect()
}

/// Local cost: the L1 distance over f, times the mean weight.
fn local((x, a): &Column, (y, b): &Column) -> f64 {
    let mut distance = 0.0;
    for feature in 0..x.len() {
        distance += (x[feature] - y[feature]).abs();
    }
    distance / x.len() as f64 * (a + b) / 2.0
}

/// The best path and its cost.
pub(crate) fn align(reference: &[Column], other: &[Column]) -> (Vec<(usize, usize)>, f64) {
    let mut d = vec![vec![0.0; other.len()]; reference.len()];
    let mut from = vec![vec![(0, 0); other.len()]; reference.len()];
    for i in 0..reference.len() {
        for j in 0..other.len() {
            // In the order in which ties are broken.
            let steps = [(1, 1), (0, 1), (1, 0)];
            let mut best: Option<(f64, (usize, usize))> = None;
            for (di, dj) in steps {
                if i >= di && j >= dj && best.is_none_or(|(cost, _)| d[i - di][j - dj] < cost) {
                    best = Some((d[i - di][j - dj], (i - di, j - dj)));
                }
            }
            let (before, at) = best.unwrap_or((0.0, (0, 0)));
            d[i][j] = before + local(&reference[i], &other[j]);
            from[i][j] = at;
        }
    }
    let mut at = (reference.len() - 1, other.len() - 1);
    let cost = d[at.0][at.1];
    let mut path = vec![at];
    while at != (0, 0) {
        at = from[at.0][at.1];
        path.insert(0, at);
    }
    (path, cost)
}

/// `other` on the columns of the reference.
fn warp(n_columns: usize, other: &[Column], path: &[(usize, usize)]) -> Vec<Column> {
    let column = |k: usize| {
        let matched: Vec<usize> = path.iter().filter(|p| p.0 == k).map(|p| p.1).collect();
        let weight: f64 = matched.iter().map(|&l| other[l].1).sum();
        let mean = |feature: usize| {
            let sum: f64 = matched
                .iter()
                .map(|&l| other[l].1 * other[l].0[feature])
                .sum();
            sum / weight
        };
        let share = |&l: &usize| other[l].1 / path.iter().filter(|p| p.1 == l).count() as f64;
        let values = (0..other[0].0.len()).map(mean).collect();
        (values, matched.iter().map(share).sum())
    };
    (0..n_columns).map(column).collect()
}

/// The mean by weight of columns that lie on each other, and their mean weight.
fn mean(columns: &[&Column]) -> Column {
    let weight: f64 = columns.iter().map(|c| c.1).sum();
    let value = |feature: usize| {
        let sum: f64 = columns.iter().map(|c| c.1 * c.0[feature]).sum();
        (sum / weight).min(1.0)
    };
    let values = (0..columns[0].0.len()).map(value).collect();
    (values, weight / columns.len() as f64)
}

/// Cell c is the mean over the times c to c + 1.
fn exact(average: &[Column]) -> Vec<Column> {
    let total: f64 = average.iter().map(|c| c.1).sum();
    let n_cells = ((total - ROUNDING).ceil() as usize).max(1);
    let cell = |c: usize| {
        let is_last = c + 1 == n_cells;
        let end = if is_last {
            f64::INFINITY
        } else {
            (c + 1) as f64
        };
        let mut at = 0.0;
        let (mut sums, mut mass) = (vec![0.0; average[0].0.len()], 0.0);
        for (values, weight) in average {
            let next: f64 = at + weight;
            let overlap = (next.min(end) - f64::max(at, c as f64)).max(0.0);
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += overlap * value;
            }
            mass += overlap;
            at = next;
        }
        let values = sums.iter().map(|sum| (sum / mass).min(1.0)).collect();
        (values, if is_last { total - c as f64 } else { 1.0 })
    };
    (0..n_cells).map(cell).collect()
}

fn expand(columns: &[Column]) -> Vec<Column> {
    let mut out = Vec::new();
    for (values, weight) in columns {
        let n = ((weight + ROUNDING).round() as usize).max(1);
        out.extend(std::iter::repeat_n((values.clone(), weight / n as f64), n));
    }
    out
}

fn join(left: &Column, right: &Column) -> Column {
    let weight = left.1 + right.1;
    let value = |(x, y): (&f64, &f64)| ((x * left.1 + y * right.1) / weight).min(1.0);
    (left.0.iter().zip(&right.0).map(value).collect(), weight)
}

/// Groups from the left: each ends as soon as it weighs 0.75.
fn contract(mut columns: Vec<Column>) -> Vec<Column> {
    let is_light = |column: &Column| column.1 < 0.75 - ROUNDING;
    let mut k = 0;
    while k < columns.len() {
        while is_light(&columns[k]) && k + 1 < columns.len() {
            let right = columns.remove(k + 1);
            columns[k] = join(&columns[k], &right);
        }
        k += 1;
    }
    if columns.len() > 1 && is_light(&columns[columns.len() - 1]) {
        let rest = columns.remove(columns.len() - 1);
        let last = columns.len() - 1;
        columns[last] = join(&columns[last], &rest);
    }
    columns
}

/// Template, iterations and distance.
pub(crate) fn learn(motions: &[MotionTemplate], config: &LearnConfig) -> (Vec<Column>, usize, f64) {
    let mut templates: Vec<Vec<Column>> = motions.iter().map(columns).collect();
    let mut distances: Vec<f64> = Vec::new();
    loop {
        let mut worst: f64 = 0.0;
        let mut next = Vec::new();
        for (k, reference) in templates.iter().enumerate() {
            let mut costs = Vec::new();
            let mut warped = Vec::new();
            for (l, other) in templates.iter().enumerate() {
                if l == k {
                    warped.push(reference.clone());
                } else {
                    let (path, cost) = align(reference, other);
                    warped.push(warp(reference.len(), other, &path));
                    costs.push(cost);
                }
            }
            let average: Vec<Column> = (0..reference.len())
                .map(|c| mean(&warped.iter().map(|one| &one[c]).collect::<Vec<_>>()))
                .collect();
            let unwarped = match config.unwarp {
                Unwarp::Exact => exact(&average),
                Unwarp::Balance => expand(&contract(expand(&average))),
            };
            let total: f64 = unwarped.iter().map(|c| c.1).sum();
            worst = costs
                .iter()
                .fold(worst, |worst, cost| worst.max(cost / total));
            next.push(unwarped);
        }
        templates = next;
        let is_settled = worst <= config.tolerance || distances.last() == Some(&worst);
        distances.push(worst);
        if is_settled || distances.len() >= config.max_iterations {
            return (templates.swap_remove(0), distances.len(), worst);
        }
    }
}
