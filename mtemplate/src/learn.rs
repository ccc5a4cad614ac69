//! From motions of a class to the class's template (section 4.1, spec.md c).

use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis};

use crate::{MotionTemplate, TemplateError};

/// How the columns of an average are brought back to real time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Unwarp {
    /// The template is a step function of cumulative weight, averaged over cells of weight 1: all
    /// weights but the last are 1.
    #[default]
    Exact,
    /// As the authors ran it: columns are repeated, merged up to a weight of 0.75 and repeated again;
    /// weights lie between 0.75 and about 1.5.
    Balance,
}

/// When to stop learning, and how to unwarp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearnConfig {
    /// How averages are unwarped.
    pub unwarp: Unwarp,
    /// Learning stops when the templates of all references are this close to each other: the
    /// largest alignment cost over the reference's total weight.
    pub tolerance: f64,
    /// The most iterations.
    pub max_iterations: usize,
}

impl Default for LearnConfig {
    fn default() -> Self {
        Self {
            unwarp: Unwarp::Exact,
            tolerance: 0.005,
            max_iterations: 10,
        }
    }
}

/// What was learned.
#[derive(Debug, Clone, PartialEq)]
pub struct Learned {
    /// The class template, that of the first motion as reference.
    pub template: MotionTemplate,
    /// Number of iterations M.
    pub iterations: usize,
    /// How far the templates of two references still were apart.
    pub distance: f64,
}

/// Learns the template that `motions` have in common.
///
/// # Errors
///
/// When there are no motions, one has no columns, or they disagree on the number of features.
pub fn learn(motions: &[MotionTemplate], config: &LearnConfig) -> Result<Learned, TemplateError> {
    let n_features = motions
        .first()
        .ok_or(TemplateError::NoMotions)?
        .n_features();
    for (motion, template) in motions.iter().enumerate() {
        if template.n_columns() == 0 {
            return Err(TemplateError::EmptyMotion { motion });
        }
        if template.n_features() != n_features {
            return Err(TemplateError::FeatureCounts {
                motion,
                expected: n_features,
                found: template.n_features(),
            });
        }
    }
    let mut inputs = motions.to_vec();
    let mut before = f64::NAN;
    for iteration in 1.. {
        let averaged: Vec<(MotionTemplate, f64)> = (0..inputs.len())
            .map(|reference| average(&inputs, reference, config.unwarp))
            .collect();
        let distance = averaged.iter().map(|(_, cost)| *cost).fold(0.0, f64::max);
        inputs = averaged.into_iter().map(|(template, _)| template).collect();
        if distance <= config.tolerance || distance == before || iteration >= config.max_iterations
        {
            return Ok(Learned {
                template: inputs.swap_remove(0),
                iterations: iteration,
                distance,
            });
        }
        before = distance;
    }
    unreachable!("the loop ends at the last iteration")
}

/// The average of all inputs aligned with one of them, and the largest cost of an alignment over the
/// average's total weight.
fn average(inputs: &[MotionTemplate], reference: usize, unwarp: Unwarp) -> (MotionTemplate, f64) {
    let target = &inputs[reference];
    let mut sums = Array2::zeros(target.values().raw_dim());
    let mut weights: Array1<f64> = Array1::zeros(target.n_columns());
    let mut worst: f64 = 0.0;
    for (k, input) in inputs.iter().enumerate() {
        let warped = if k == reference {
            (input.values().to_owned(), input.weights().to_owned())
        } else {
            let (path, cost) = align(target, input);
            worst = worst.max(cost);
            warp(target.n_columns(), input, &path)
        };
        for column in 0..target.n_columns() {
            let weight = warped.1[column];
            sums.row_mut(column)
                .scaled_add(weight, &warped.0.row(column));
            weights[column] += weight;
        }
    }
    for (mut row, weight) in sums.rows_mut().into_iter().zip(&weights) {
        row /= *weight;
        row.mapv_inplace(|value: f64| value.clamp(0.0, 1.0));
    }
    weights /= inputs.len() as f64;
    let (values, weights) = match unwarp {
        Unwarp::Exact => exact(sums.view(), weights.view()),
        Unwarp::Balance => balance(sums.view(), weights.view()),
    };
    let total = weights.sum();
    let template = MotionTemplate::new(values, weights).expect("averages of shares are shares");
    (template, worst / total)
}

/// Pairs (reference column, other column), and the path's cost.
fn align(reference: &MotionTemplate, other: &MotionTemplate) -> (Vec<(usize, usize)>, f64) {
    let (rows, columns) = (reference.n_columns(), other.n_columns());
    let n_features = reference.n_features() as f64;
    let local = |i: usize, j: usize| {
        let (a, b) = (reference.values(), other.values());
        let l1: f64 = a
            .row(i)
            .iter()
            .zip(b.row(j))
            .map(|(a, b)| (a - b).abs())
            .sum();
        l1 / n_features * (reference.weights()[i] + other.weights()[j]) / 2.0
    };
    let mut reached = Array2::from_elem((rows + 1, columns + 1), f64::INFINITY);
    reached[[0, 0]] = 0.0;
    for i in 0..rows {
        for j in 0..columns {
            let least = reached[[i, j]]
                .min(reached[[i + 1, j]])
                .min(reached[[i, j + 1]]);
            reached[[i + 1, j + 1]] = local(i, j) + least;
        }
    }
    let mut path = vec![(rows - 1, columns - 1)];
    let (mut i, mut j) = (rows, columns);
    while (i, j) != (1, 1) {
        let (both, of_other, of_reference) = (
            reached[[i - 1, j - 1]],
            reached[[i, j - 1]],
            reached[[i - 1, j]],
        );
        if both <= of_other && both <= of_reference {
            (i, j) = (i - 1, j - 1);
        } else if of_other <= of_reference {
            j -= 1;
        } else {
            i -= 1;
        }
        path.push((i - 1, j - 1));
    }
    path.reverse();
    (path, reached[[rows, columns]])
}

fn warp(
    n_columns: usize,
    input: &MotionTemplate,
    path: &[(usize, usize)],
) -> (Array2<f64>, Array1<f64>) {
    let mut partners = vec![0.0; input.n_columns()];
    for &(_, j) in path {
        partners[j] += 1.0;
    }
    let mut values = Array2::zeros((n_columns, input.n_features()));
    let mut sums: Array1<f64> = Array1::zeros(n_columns);
    let mut weights = Array1::zeros(n_columns);
    for &(i, j) in path {
        let weight = input.weights()[j];
        values.row_mut(i).scaled_add(weight, &input.values().row(j));
        sums[i] += weight;
        weights[i] += weight / partners[j];
    }
    for (mut row, sum) in values.rows_mut().into_iter().zip(&sums) {
        row /= *sum;
    }
    (values, weights)
}

/// A total weight this close to a whole number is one: sums of weights are rounded.
const WHOLE: f64 = 1e-9;

fn exact(values: ArrayView2<'_, f64>, weights: ArrayView1<'_, f64>) -> (Array2<f64>, Array1<f64>) {
    let total = weights.sum();
    let n_cells = ((total - WHOLE).ceil() as usize).max(1);
    let mut sums = Array2::zeros((n_cells, values.ncols()));
    let mut masses: Array1<f64> = Array1::zeros(n_cells);
    let mut at = 0.0;
    for (row, &weight) in values.rows().into_iter().zip(weights) {
        let end = at + weight;
        let mut from = at;
        while from < end {
            let cell = (from.floor() as usize).min(n_cells - 1);
            let to = if cell + 1 == n_cells {
                end
            } else {
                end.min((cell + 1) as f64)
            };
            sums.row_mut(cell).scaled_add(to - from, &row);
            masses[cell] += to - from;
            from = to;
        }
        at = end;
    }
    for (mut row, mass) in sums.rows_mut().into_iter().zip(&masses) {
        row /= *mass;
        row.mapv_inplace(|value: f64| value.clamp(0.0, 1.0));
    }
    let whole = |cell: usize| {
        if cell + 1 == n_cells {
            total - (n_cells - 1) as f64
        } else {
            1.0
        }
    };
    (sums, Array1::from_shape_fn(n_cells, whole))
}

/// Columns are merged until they weigh this much.
const ENOUGH: f64 = 0.75;

fn balance(
    values: ArrayView2<'_, f64>,
    weights: ArrayView1<'_, f64>,
) -> (Array2<f64>, Array1<f64>) {
    let columns: Vec<(Array1<f64>, f64)> = values
        .rows()
        .into_iter()
        .map(|row| row.to_owned())
        .zip(weights.iter().copied())
        .collect();
    let columns = expand(contract(expand(columns)));
    let rows: Vec<ArrayView1<'_, f64>> = columns.iter().map(|(row, _)| row.view()).collect();
    let values = ndarray::stack(Axis(0), &rows).expect("rows have one length");
    (values, columns.iter().map(|(_, weight)| *weight).collect())
}

fn expand(columns: Vec<(Array1<f64>, f64)>) -> Vec<(Array1<f64>, f64)> {
    let copies = |(row, weight): (Array1<f64>, f64)| {
        let n = weight.round().max(1.0);
        vec![(row, weight / n); n as usize]
    };
    columns.into_iter().flat_map(copies).collect()
}

fn contract(columns: Vec<(Array1<f64>, f64)>) -> Vec<(Array1<f64>, f64)> {
    let mut merged: Vec<(Array1<f64>, f64)> = Vec::new();
    let mut open = false;
    for (row, weight) in columns {
        match merged.last_mut() {
            Some(last) if open => *last = join(last, &(row, weight)),
            _ => merged.push((row, weight)),
        }
        open = merged.last().is_some_and(|last| last.1 < ENOUGH);
    }
    if open && merged.len() > 1 {
        let rest = merged.pop().expect("two or more");
        let last = merged.last_mut().expect("one or more");
        *last = join(last, &rest);
    }
    merged
}

fn join(a: &(Array1<f64>, f64), b: &(Array1<f64>, f64)) -> (Array1<f64>, f64) {
    let weight = a.1 + b.1;
    ((&a.0 * a.1 + &b.0 * b.1) / weight, weight)
}
