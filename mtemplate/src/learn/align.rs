//! Dynamic time warping of two templates from end to end.
//!
//! C(i,j) is the local cost of column i of the one and column j of the other, and
//! D(i,j) = C(i,j) + min(D(i-1,j-1), D(i,j-1), D(i-1,j)).

use pulp::{Arch, Simd, WithSimd};

use crate::learn::check;
use crate::learn::columns::Columns;
use crate::{MotionTemplate, TemplateError};

/// How two templates correspond.
#[derive(Debug, Clone, PartialEq)]
pub struct Alignment {
    /// Columns that belong together, the reference's first: from the first of both to the last of
    /// both.
    pub path: Vec<(usize, usize)>,
    /// Sum of the local costs along the path, in frames.
    pub cost: f64,
}

/// A cheapest alignment of `other` with `reference`, over the whole of both.
///
/// A step advances both templates by a column, or either of them, and no step is dearer than
/// another. The local cost of column i of the reference and column j of the other is their L1
/// distance over f, times the mean (α(i) + α(j))/2 of their weights (spec.md c.3). Seen from the
/// end, among paths of one cost the step that advances both is taken first, then that of the
/// other, then that of the reference.
///
/// A local cost is rounded before it is added to what precedes it. Costs of paths that differ in
/// rounding alone are no tie, here as in the authors' code.
///
/// Takes O(K·L·f) time and O(K·L) memory for templates of K and L columns.
///
/// # Errors
///
/// When either has no columns, more than [`MAX_ALIGNED_COLUMNS`](crate::MAX_ALIGNED_COLUMNS) or more total weight
/// (motion 0 is the reference, motion 1 the other), and when they disagree on the number of features.
///
/// ```
/// use mtemplate::{MotionTemplate, align};
///
/// let reference = MotionTemplate::from_words(&[0b00, 0b01, 0b10], 2)?;
/// let other = MotionTemplate::from_words(&[0b00, 0b00, 0b11], 2)?;
/// let alignment = align(&reference, &other)?;
/// // (0, 0), (0, 1), (1, 2), (2, 2) costs as much.
/// assert_eq!(alignment.path, [(0, 0), (1, 1), (2, 2)]);
/// assert_eq!(alignment.cost, 1.0);
/// # Ok::<(), mtemplate::TemplateError>(())
/// ```
pub fn align(
    reference: &MotionTemplate,
    other: &MotionTemplate,
) -> Result<Alignment, TemplateError> {
    let both = [reference.clone(), other.clone()];
    check(&both)?;
    let columns = Columns::of_all(&both);
    let mut table = Table::default();
    table.fill(&columns[0], &columns[1]);
    let steps = table.trace(Step::Second);
    Ok(Alignment {
        path: pairs(&steps).collect(),
        cost: table.cost(),
    })
}

/// What a step of a path advances.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    Both,
    First,
    Second,
}

/// Accumulated costs of two templates, with a row and a column of infinities in front.
#[derive(Debug, Default)]
pub(super) struct Table {
    reached: Vec<f64>,
    costs: Vec<f64>,
    /// Columns of the first and the second.
    shape: (usize, usize),
}

impl Table {
    /// Costs of `first` and `second`, which have one column or more each. The sums are those of
    /// `second` and `first`, since a minimum does not depend on the order.
    pub(super) fn fill(&mut self, first: &Columns, second: &Columns) {
        self.fill_on(Arch::new(), first, second);
    }

    fn fill_on(&mut self, arch: Arch, first: &Columns, second: &Columns) {
        self.shape = (first.len(), second.len());
        arch.dispatch(Fill {
            table: self,
            first,
            second,
        });
    }

    #[inline(always)]
    fn sweep(&mut self, first: &Columns, second: &Columns) {
        let (rows, columns) = self.shape;
        let (stride, cost_stride) = (columns + 1, Columns::stride(columns));
        self.reached.clear();
        self.reached.resize((rows + 1) * stride, f64::INFINITY);
        self.reached[0] = 0.0;
        self.costs.resize(Columns::BLOCK * cost_stride, 0.0);
        for block in (0..rows).step_by(Columns::BLOCK) {
            first.local_costs(block, second, &mut self.costs);
            let n_rows = Columns::BLOCK.min(rows - block);
            for (row, costs) in (block..block + n_rows).zip(self.costs.chunks_exact(cost_stride)) {
                let (above, here) =
                    self.reached[row * stride..(row + 2) * stride].split_at_mut(stride);
                advance(above, &mut here[1..], &costs[..columns]);
            }
        }
    }

    /// Cost of the best path.
    pub(super) fn cost(&self) -> f64 {
        self.reached.last().copied().unwrap_or(f64::INFINITY)
    }

    /// The best path from the first columns to the last. Among equals the step of both comes first,
    /// then that of `other`, the one that is not the reference.
    pub(super) fn trace(&self, other: Step) -> Vec<Step> {
        let (mut i, mut j) = self.shape;
        let stride = j + 1;
        let mut steps = Vec::with_capacity(i + j);
        // Invariant: i and j are 1 or more, and one of them more: the cells in front of the first
        // are infinite and those of the table finite. Each step lessens i + j.
        while (i, j) != (1, 1) {
            let at = i * stride + j;
            let both = self.reached[at - stride - 1];
            let (of_second, of_first) = (self.reached[at - 1], self.reached[at - stride]);
            let step = if both <= of_second && both <= of_first {
                Step::Both
            } else if of_second < of_first || (of_second == of_first && other == Step::Second) {
                Step::Second
            } else {
                Step::First
            };
            i -= usize::from(step != Step::Second);
            j -= usize::from(step != Step::First);
            steps.push(step);
        }
        steps.reverse();
        steps
    }
}

struct Fill<'a> {
    table: &'a mut Table,
    first: &'a Columns,
    second: &'a Columns,
}

/// Its loops are compiled for every instruction set; no operation is fused, so all give the same.
impl WithSimd for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.table.sweep(self.first, self.second);
    }
}

/// A row of accumulated costs from the one `above`, which has one more in front.
#[inline(always)]
fn advance(above: &[f64], here: &mut [f64], costs: &[f64]) {
    // What comes from above needs no result of this row, and is taken many cells at a time.
    for (cell, above) in here.iter_mut().zip(above.windows(2)) {
        *cell = least(above[0], above[1]);
    }
    let mut before = f64::INFINITY;
    for (cell, cost) in here.iter_mut().zip(costs) {
        before = cost + least(*cell, before);
        *cell = before;
    }
}

/// The lesser of two numbers, as one instruction: [`f64::min`] looks after NaN.
#[inline(always)]
fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Columns that steps lead through.
pub(super) fn pairs(steps: &[Step]) -> impl Iterator<Item = (usize, usize)> + Clone {
    let advance = |at: &mut (usize, usize), step: &Step| {
        at.0 += usize::from(*step != Step::Second);
        at.1 += usize::from(*step != Step::First);
        Some(*at)
    };
    std::iter::once((0, 0)).chain(steps.iter().scan((0, 0), advance))
}

#[cfg(test)]
mod tests {
    use ndarray::{Array1, Array2};

    use super::*;

    /// Every instruction set this machine has.
    fn kinds() -> Vec<Arch> {
        let mut kinds = vec![Arch::Scalar];
        #[cfg(target_arch = "x86_64")]
        {
            kinds.extend(pulp::x86::V3::try_new().map(Arch::V3));
            kinds.extend(pulp::x86::V4::try_new().map(Arch::V4));
        }
        kinds
    }

    #[test]
    fn every_instruction_set_gives_the_same_sums() {
        let share = |k: usize| (k as f64 * 0.618_034).fract();
        for (n_features, rounding) in [(1, 1.0), (5, 0.0), (39, 0.0), (39, 1.0), (64, 0.0)] {
            // Rounded values are boolean.
            let value = |k: usize| {
                if rounding == 1.0 {
                    share(k).round()
                } else {
                    share(k)
                }
            };
            let template = |n_columns: usize, seed: usize| {
                let at = |(i, j): (usize, usize)| value(seed + 64 * i + j);
                let values = Array2::from_shape_fn((n_columns, n_features), at);
                let weights = Array1::from_shape_fn(n_columns, |i| 0.5 + share(seed + 7 * i));
                MotionTemplate::new(values, weights).unwrap()
            };
            for (rows, columns) in [(1, 1), (4, 8), (5, 9), (23, 17)] {
                let columns = Columns::of_all(&[template(rows, 3), template(columns, 1000)]);
                let mut expected: Option<Vec<f64>> = None;
                for arch in kinds() {
                    let mut table = Table::default();
                    table.fill_on(arch, &columns[0], &columns[1]);
                    let expected = expected.get_or_insert_with(|| table.reached.clone());
                    assert_eq!(&table.reached, expected, "{arch:?}");
                }
            }
        }
    }
}
