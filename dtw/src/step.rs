use std::borrow::Cow;

use crate::DtwError;

/// One way to reach a cell: from `rows` back in the first sequence and `columns` back in the
/// second, for `weight` times the cell's local cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Frames of the first sequence that the step advances.
    pub rows: usize,
    /// Frames of the second sequence that the step advances.
    pub columns: usize,
    /// Factor of the local cost of the cell that the step leads to.
    pub weight: f64,
}

impl Step {
    /// A step that advances `rows` and `columns`.
    pub const fn new(rows: usize, columns: usize, weight: f64) -> Self {
        Self {
            rows,
            columns,
            weight,
        }
    }
}

/// The steps that a path may take, in the order that settles ties: of equally cheap ways into a
/// cell, the one that comes first.
///
/// A path's first cell costs its local cost, whatever the pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct StepPattern(Cow<'static, [Step]>);

const CLASSIC: [Step; 3] = [
    Step::new(1, 1, 1.0),
    Step::new(0, 1, 1.0),
    Step::new(1, 0, 1.0),
];
const SYMMETRIC2: [Step; 3] = [
    Step::new(1, 1, 2.0),
    Step::new(0, 1, 1.0),
    Step::new(1, 0, 1.0),
];
const ASYMMETRIC: [Step; 3] = [
    Step::new(1, 1, 1.0),
    Step::new(1, 2, 1.0),
    Step::new(1, 0, 1.0),
];

impl StepPattern {
    /// Steps of a pattern at most.
    pub const MAX_STEPS: usize = 15;

    /// Frames that one step advances at most.
    pub const MAX_ADVANCE: usize = 64;

    /// A pattern of one's own.
    ///
    /// # Errors
    ///
    /// [`DtwError::StepPattern`] for no steps or more than [`Self::MAX_STEPS`], for a step that
    /// advances nothing or more than [`Self::MAX_ADVANCE`] frames, and for a weight that is
    /// negative or not finite.
    pub fn new(steps: impl Into<Vec<Step>>) -> Result<Self, DtwError> {
        let steps = steps.into();
        let is_valid = |step: &Step| {
            let advance = step.rows.max(step.columns);
            (1..=Self::MAX_ADVANCE).contains(&advance)
                && step.weight.is_finite()
                && step.weight >= 0.0
        };
        if steps.is_empty() || steps.len() > Self::MAX_STEPS || !steps.iter().all(is_valid) {
            return Err(DtwError::StepPattern);
        }
        Ok(Self(Cow::Owned(steps)))
    }

    /// (1,1), (0,1), (1,0), each of weight 1.
    pub const fn classic() -> Self {
        Self(Cow::Borrowed(&CLASSIC))
    }

    /// (1,1) of weight 2, (0,1) and (1,0) of weight 1 (Sakoe and Chiba's symmetric form): but for
    /// its first cell, every path's weights sum to the frames that it advances in both sequences.
    pub const fn symmetric2() -> Self {
        Self(Cow::Borrowed(&SYMMETRIC2))
    }

    /// (1,1), (1,2), (1,0), each of weight 1: every frame of the first sequence is used once, and
    /// frames of the second may be skipped one at a time or held.
    pub const fn asymmetric() -> Self {
        Self(Cow::Borrowed(&ASYMMETRIC))
    }

    /// (1,1), (1,2), (2,1) with these weights: slopes from 1/2 to 2. Weights 1, 1, 2 count each
    /// frame of the first sequence once (Müller and Röder 2006).
    ///
    /// # Errors
    ///
    /// [`DtwError::StepPattern`] for a weight that is negative or not finite.
    pub fn slope_limited(weights: [f64; 3]) -> Result<Self, DtwError> {
        let [both, columns, rows] = weights;
        Self::new([
            Step::new(1, 1, both),
            Step::new(1, 2, columns),
            Step::new(2, 1, rows),
        ])
    }

    /// The steps, in the order that settles ties.
    pub fn steps(&self) -> &[Step] {
        &self.0
    }

    /// Weights of (1,1), (0,1) and (1,0) when these are the steps, in this order.
    pub(crate) fn weights_of_unit_steps(&self) -> Option<[f64; 3]> {
        let advances = |k: usize| (self.0[k].rows, self.0[k].columns);
        let are_unit = self.0.len() == 3
            && [advances(0), advances(1), advances(2)] == [(1, 1), (0, 1), (1, 0)];
        are_unit.then(|| [self.0[0].weight, self.0[1].weight, self.0[2].weight])
    }
}

impl Default for StepPattern {
    fn default() -> Self {
        Self::classic()
    }
}

/// Which of the second sequence's frames a path may start and end at. It always starts at the
/// first sequence's first frame and ends at its last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Ends {
    /// From the first frame to the last.
    #[default]
    Closed,
    /// From any frame to the last.
    OpenBegin,
    /// From the first frame to any.
    OpenEnd,
    /// From any frame to any: subsequence DTW. Of equally cheap ends, the earliest.
    Open,
}

impl Ends {
    pub(crate) const fn begin_is_open(self) -> bool {
        matches!(self, Self::OpenBegin | Self::Open)
    }

    pub(crate) const fn end_is_open(self) -> bool {
        matches!(self, Self::OpenEnd | Self::Open)
    }
}
