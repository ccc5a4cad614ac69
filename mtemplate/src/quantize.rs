//! Ternary columns as two words, so that a local cost is one population count.

use ndarray::ArrayView1;

use crate::fixed::{Column, FixedCosts, UNREACHED};
use crate::{
    DistanceCurve, Ending, Match, MatchConfig, MotionTemplate, ShortClips, Steps, TemplateError,
    matches, sweep,
};

/// What a template asks of a feature in one column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Cell {
    /// The feature is off.
    Zero,
    /// The feature is on.
    One,
    /// Either (the papers' gray, drawn between black and white).
    Wildcard,
}

/// A template of 0, 1 and wildcards.
#[derive(Debug, Clone, PartialEq)]
pub struct QuantizedTemplate {
    columns: Vec<Column>,
    n_features: usize,
    costs: FixedCosts,
    short_clips: ShortClips,
}

/// A word with the bit of every feature, for at most 64 of them.
pub(crate) fn all_features(n_features: usize) -> u64 {
    u64::MAX
        .checked_shr(64_u32.saturating_sub(n_features as u32))
        .unwrap_or(0)
}

pub(crate) fn quantize(
    template: &MotionTemplate,
    threshold: f64,
) -> Result<QuantizedTemplate, TemplateError> {
    if !(0.0..0.5).contains(&threshold) {
        return Err(TemplateError::Threshold { found: threshold });
    }
    let to_column = |(row, &weight): (ArrayView1<'_, f64>, &f64)| {
        let mut column = Column {
            care: 0,
            value: 0,
            weight,
        };
        for (feature, &value) in row.iter().enumerate() {
            let is_one = value >= 1.0 - threshold;
            if is_one || value <= threshold {
                column.care |= 1 << feature;
                column.value |= u64::from(is_one) << feature;
            }
        }
        column
    };
    let columns: Vec<Column> = template
        .values()
        .rows()
        .into_iter()
        .zip(template.weights())
        .map(to_column)
        .collect();
    Ok(QuantizedTemplate {
        costs: FixedCosts::new(&columns, Steps::default()),
        columns,
        n_features: template.n_features(),
        short_clips: ShortClips::default(),
    })
}

impl QuantizedTemplate {
    /// Number of columns K.
    pub fn n_columns(&self) -> usize {
        self.columns.len()
    }

    /// Number of features f.
    pub fn n_features(&self) -> usize {
        self.n_features
    }

    /// What `column` asks of `feature`; `None` outside the template.
    pub fn cell(&self, column: usize, feature: usize) -> Option<Cell> {
        let column = self
            .columns
            .get(column)
            .filter(|_| feature < self.n_features)?;
        Some(
            match (column.care >> feature & 1, column.value >> feature & 1) {
                (0, _) => Cell::Wildcard,
                (_, 0) => Cell::Zero,
                _ => Cell::One,
            },
        )
    }

    /// The features `column` asks anything of, and what it asks: bits of `.1` outside `.0` are 0.
    pub fn words(&self, column: usize) -> Option<(u64, u64)> {
        self.columns
            .get(column)
            .map(|column| (column.care, column.value))
    }

    /// Cost of aligning `column` with a frame: the share of its cells other than wildcards that
    /// disagree, times (α + 1)/2, over K. Bits that are no feature of the template are not looked
    /// at; a column of wildcards alone costs nothing. `None` past the last column.
    pub fn local_cost(&self, column: usize, word: u64) -> Option<f64> {
        self.columns
            .get(column)
            .map(|column| column.cost(word) / self.columns.len() as f64)
    }

    /// The same template with other step weights.
    #[must_use]
    pub fn with_steps(self, steps: Steps) -> Self {
        Self {
            costs: FixedCosts::new(&self.columns, steps),
            ..self
        }
    }

    /// The same template with another rule for clips that are too short for any match.
    #[must_use]
    pub fn with_short_clips(self, short_clips: ShortClips) -> Self {
        Self {
            short_clips,
            ..self
        }
    }

    /// Cheapest cost of aligning the template with a stretch of `words`, for each frame the stretch
    /// may end at.
    ///
    /// A match starts at any frame with the first column, moves by (template, data) steps (1,1),
    /// (1,2), (2,1) that weigh as [`Steps`] says, and ends with the last column. All costs are
    /// `None` when the template has fewer than two columns. When the clip has half as many frames as
    /// the template or fewer, they are as [`ShortClips`] says.
    pub fn distance_curve(&self, words: &[u64]) -> DistanceCurve {
        let costs = match self.held(words) {
            None => sweep::costs(&self.costs, words),
            Some(held) => {
                let mut costs = vec![UNREACHED; words.len()];
                let ends = costs.last_mut().zip(sweep::costs(&self.costs, &held).pop());
                if let Some((end, cost)) = ends {
                    *end = cost;
                }
                costs
            }
        };
        DistanceCurve::new(costs, self.costs.scale())
    }

    /// The curve's costs together with the first frame of the best match that ends at each frame.
    /// Of equal ways to a cell the first of the steps (1,1), (1,2), (2,1) is taken.
    pub fn endings(&self, words: &[u64]) -> Vec<Option<Ending>> {
        if words.len() < self.shortest_match() {
            // A short clip is matched as a whole or not at all.
            let costs = self.distance_curve(words);
            let whole = costs.costs().map(|cost| {
                Some(Ending {
                    cost: cost?,
                    start: 0,
                })
            });
            return whole.collect();
        }
        let (costs, starts) = sweep::costs_and_starts(&self.costs, words);
        let ending = |(frame, (cost, start))| self.costs.ending(frame, cost, start);
        costs
            .into_iter()
            .zip(starts)
            .enumerate()
            .map(ending)
            .collect()
    }

    /// First frame of the best match that ends at each frame; `None` where none can end.
    pub fn starts(&self, words: &[u64]) -> Vec<Option<usize>> {
        let endings = self.endings(words).into_iter();
        endings.map(|ending| Some(ending?.start)).collect()
    }

    /// First frame of the best match that ends with frame `last`; `None` where none can end. Looks
    /// at no more frames than a match may have.
    pub fn start_of(&self, words: &[u64], last: usize) -> Option<usize> {
        if last + 1 < self.shortest_match() && last + 1 < words.len() {
            return None;
        }
        let from = (last + 1).saturating_sub(self.longest_match());
        let stretch = words.get(from..=last)?;
        let ending = self.endings(stretch).pop()??;
        Some(from + ending.start)
    }

    /// Matches of the template in a clip, in order of (cost, end).
    ///
    /// The cheapest end is taken, the earliest among equals. Its match is kept unless it starts
    /// where an earlier one has claimed the starts: a match of n frames claims those from ⌈0.1 n⌉
    /// before its own to ⌈0.5 n⌉ after it. In both cases ends from ⌈0.5 n⌉ before this one to
    /// ⌈0.1 n⌉ after it are closed, with the n of the match that claimed the start (the latest one
    /// found, if there are several). That is repeated until no end up to τ is left (spec.md d).
    pub fn find_matches(&self, words: &[u64], config: &MatchConfig) -> Vec<Match> {
        self.matches_of(words, &self.distance_curve(words), config)
    }

    /// As [`find_matches`](Self::find_matches), of a curve that this template gave for `words`.
    pub fn matches_of(
        &self,
        words: &[u64],
        curve: &DistanceCurve,
        config: &MatchConfig,
    ) -> Vec<Match> {
        let start_of = |last| self.start_of(words, last);
        matches::select_matches(curve.costs(), start_of, config)
    }

    /// Frames of the shortest match: a path of K columns takes two columns for each but the first
    /// frame.
    fn shortest_match(&self) -> usize {
        self.columns.len() / 2 + 1
    }

    /// A clip that is too short, with its ends held; `None` if it is not, if it has nothing to hold, or
    /// if that is not the rule.
    fn held(&self, words: &[u64]) -> Option<Vec<u64>> {
        if self.short_clips == ShortClips::Unmatched {
            return None;
        }
        let missing = self.shortest_match().saturating_sub(words.len());
        if missing == 0 {
            return None;
        }
        let (first, last) = (*words.first()?, *words.last()?);
        let (before, after) = (missing / 2, missing.div_ceil(2));
        let held = std::iter::repeat_n(first, before);
        let held = held.chain(words.iter().copied());
        Some(held.chain(std::iter::repeat_n(last, after)).collect())
    }

    /// Frames of the longest match: a path of K columns takes two frames for each but the first.
    pub(crate) fn longest_match(&self) -> usize {
        (2 * self.columns.len()).saturating_sub(1)
    }

    pub(crate) fn costs(&self) -> &FixedCosts {
        &self.costs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_features_fill_from_the_lowest_bit() {
        assert_eq!(all_features(0), 0);
        assert_eq!(all_features(1), 1);
        assert_eq!(all_features(39), (1 << 39) - 1);
        assert_eq!(all_features(64), u64::MAX);
    }
}
