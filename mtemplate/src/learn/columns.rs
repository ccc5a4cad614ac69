//! Columns of a template as the local cost wants them, and the local cost.

use crate::MotionTemplate;

/// Columns whose costs are summed at once.
const LANES: usize = 8;
/// Rows that share a load of those columns.
const ROWS: usize = 4;

/// The columns of one template.
#[derive(Debug)]
pub(super) struct Columns {
    n_features: usize,
    pub(super) weights: Vec<f64>,
    values: Values,
}

#[derive(Debug)]
enum Values {
    /// All values are 0 or 1: a bit for each.
    Boolean(Vec<u64>),
    Real(Real),
}

#[derive(Debug)]
struct Real {
    n_features: usize,
    /// Column after column.
    by_column: Vec<f64>,
    /// For each group of [`LANES`] columns, feature after feature; columns past the last are 0.
    by_group: Vec<[f64; LANES]>,
}

impl Columns {
    /// The columns of each of `templates`: boolean if all of them are.
    pub(super) fn of_all(templates: &[MotionTemplate]) -> Vec<Columns> {
        let is_boolean = |template: &MotionTemplate| {
            let mut values = template.values().into_iter();
            values.all(|&value| value == 0.0 || value == 1.0)
        };
        let values = if templates.iter().all(is_boolean) {
            |template: &MotionTemplate| Values::Boolean(words(template))
        } else {
            |template: &MotionTemplate| Values::Real(Real::new(template))
        };
        let columns = templates.iter().map(|template| Columns {
            n_features: template.n_features(),
            weights: template.weights().to_vec(),
            values: values(template),
        });
        columns.collect()
    }

    pub(super) fn len(&self) -> usize {
        self.weights.len()
    }

    /// Rows that [`local_costs`](Self::local_costs) fills at once.
    pub(super) const BLOCK: usize = ROWS;

    /// Entries of a row of costs with `len` columns, with room for whole groups.
    pub(super) fn stride(len: usize) -> usize {
        len.next_multiple_of(LANES)
    }

    /// Local costs of the columns from `first` on, a block of them or as many as there are, with
    /// each column of `other`, row after row, [`stride`](Self::stride) apart: the L1 distance over f,
    /// times the mean of both weights. A cost does not depend on which of the two is which, nor on
    /// how many are computed at once: each sum runs over the features in order.
    ///
    /// Both come from one [`of_all`](Self::of_all).
    #[inline(always)]
    pub(super) fn local_costs(&self, first: usize, other: &Columns, costs: &mut [f64]) {
        match (&self.values, &other.values) {
            (Values::Boolean(a), Values::Boolean(b)) => {
                let stride = Self::stride(b.len());
                for (&word, costs) in a[first..].iter().zip(costs.chunks_exact_mut(stride)) {
                    for (cost, &other) in costs.iter_mut().zip(b) {
                        *cost = f64::from((word ^ other).count_ones());
                    }
                }
            }
            (Values::Real(a), Values::Real(b)) => a.distances(first, b, costs),
            _ => unreachable!("templates that are aligned are laid out together"),
        }
        let n_features = self.n_features as f64;
        let stride = Self::stride(other.len());
        for (&weight, costs) in self.weights[first..]
            .iter()
            .zip(costs.chunks_exact_mut(stride))
        {
            for (cost, other) in costs.iter_mut().zip(&other.weights) {
                *cost = *cost / n_features * (weight + other) / 2.0;
            }
        }
    }
}

/// Values of 0 and 1 as bits.
fn words(template: &MotionTemplate) -> Vec<u64> {
    let rows = template.values().into_outer_iter();
    let word = |row: ndarray::ArrayView1<'_, f64>| {
        let bits = row.iter().enumerate();
        bits.fold(0, |word, (feature, &value)| {
            word | u64::from(value == 1.0) << feature
        })
    };
    rows.map(word).collect()
}

impl Real {
    fn new(template: &MotionTemplate) -> Self {
        let values = template.values();
        let (n_columns, n_features) = values.dim();
        let n_groups = n_columns.div_ceil(LANES);
        let mut by_group = vec![[0.0; LANES]; n_groups * n_features];
        for ((column, feature), &value) in values.indexed_iter() {
            by_group[column / LANES * n_features + feature][column % LANES] = value;
        }
        Self {
            n_features,
            by_column: values.iter().copied().collect(),
            by_group,
        }
    }

    #[inline(always)]
    fn distances(&self, first: usize, other: &Real, costs: &mut [f64]) {
        let n_features = self.n_features;
        let n_groups = other.by_group.len() / n_features;
        let last = self.by_column.len() / n_features - 1;
        // Rows past the last repeat it; nobody reads what comes of them.
        let row = |r: usize| {
            let start = (first + r).min(last) * n_features;
            &self.by_column[start..start + n_features]
        };
        let rows: [&[f64]; ROWS] = std::array::from_fn(row);
        for (group, columns) in other.by_group.chunks_exact(n_features).enumerate() {
            let mut sums = [[0.0; LANES]; ROWS];
            for (feature, column) in columns.iter().enumerate() {
                for r in 0..ROWS {
                    let value = rows[r][feature];
                    for lane in 0..LANES {
                        sums[r][lane] += (value - column[lane]).abs();
                    }
                }
            }
            for (r, sums) in sums.iter().enumerate() {
                let start = (r * n_groups + group) * LANES;
                costs[start..start + LANES].copy_from_slice(sums);
            }
        }
    }
}
