//! The automatic choice of 2006 (section 5.4), as the authors ran it (spec.md e).

use std::f64::consts::PI;

use crate::{Keyframe, MotionTemplate, QuantizedTemplate, TemplateError};

/// How keyframes are chosen from the template alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AutomaticConfig {
    /// Quantisation threshold δ.
    pub threshold: f64,
    /// While nothing is found, δ is raised by 0.01 up to this.
    pub max_threshold: f64,
    /// The most keyframes.
    pub max_keyframes: usize,
    /// The least score of a keyframe.
    pub min_score: f64,
}

impl AutomaticConfig {
    /// As in the authors' interactive program: two keyframes at most, δ = 0.1. Table 3 has two throughout.
    pub fn interactive() -> Self {
        Self {
            threshold: 0.1,
            max_threshold: 0.1,
            max_keyframes: 2,
            min_score: 0.9,
        }
    }

    /// As in the authors' batches: eight keyframes at most, δ up to 0.2.
    pub fn batch() -> Self {
        Self {
            max_threshold: 0.2,
            max_keyframes: 8,
            ..Self::interactive()
        }
    }
}

const WHITE: f64 = 2.0;
const BLACK: f64 = 1.2;
/// Share of the columns over which scores rise at either end.
const RAMP: f64 = 0.2;
/// Columns on either side of a keyframe that have no other.
const APART: usize = 5;
const RAISE: f64 = 0.01;

/// Chooses columns with many ones and few wildcards, in ascending order; none if no column is good enough.
///
/// The template is quantised, and a cell that differs from one of its neighbours in time becomes a wildcard, as do those
/// of the first and last column. A group of features, one of the masks `groups`, scores (2 · ones + 1.2 · zeros) / features
/// in a column, times a Hann ramp over the first and the last fifth of the columns. The best group and column is taken
/// again and again, the earliest column and then the first group of equals; then five columns on either side are closed
/// to all groups, and those over which the score falls away from it to its own group. A keyframe asks for the cells of its
/// group that are no wildcards, with [`Keyframe::LOOSE`] as stiffness: the authors' rule has no stiffness.
///
/// # Errors
///
/// A threshold outside \[0, 0.5).
pub fn choose_keyframes(
    template: &MotionTemplate,
    groups: &[u64],
    config: &AutomaticConfig,
) -> Result<Vec<Keyframe>, TemplateError> {
    let mut n_raised = 0.0;
    loop {
        let threshold = config.threshold + n_raised * RAISE;
        let steady = steady(&template.quantize(threshold)?);
        let keyframes = choose(&steady, groups, config);
        n_raised += 1.0;
        // Half a step, so that rounding does not decide.
        let next = config.threshold + n_raised * RAISE;
        if !keyframes.is_empty() || next > config.max_threshold + RAISE / 2.0 {
            return Ok(keyframes);
        }
    }
}

/// Care and value of each column, of cells that are the same in both neighbouring columns.
fn steady(template: &QuantizedTemplate) -> Vec<(u64, u64)> {
    let words = |column: Option<usize>| column.and_then(|column| template.words(column));
    let cells = |column: usize| {
        let all = [column.checked_sub(1), Some(column), Some(column + 1)].map(words);
        let [before, this, after] = all.map(Option::unwrap_or_default);
        let same = !(before.1 ^ this.1) & !(after.1 ^ this.1);
        let care = before.0 & this.0 & after.0 & same;
        (care, this.1 & care)
    };
    (0..template.n_columns()).map(cells).collect()
}

fn choose(cells: &[(u64, u64)], groups: &[u64], config: &AutomaticConfig) -> Vec<Keyframe> {
    let score = |group: u64, column: usize| {
        let (care, value) = cells[column];
        let ones = f64::from((value & group).count_ones());
        let zeros = f64::from((care & !value & group).count_ones());
        let n = f64::from(group.count_ones().max(1));
        (WHITE * ones + BLACK * zeros) / n * window(column, cells.len())
    };
    let mut scores: Vec<Vec<f64>> = groups
        .iter()
        .map(|&group| {
            (0..cells.len())
                .map(|column| score(group, column))
                .collect()
        })
        .collect();
    let mut chosen = Vec::new();
    while chosen.len() < config.max_keyframes {
        let places =
            (0..cells.len()).flat_map(|column| (0..groups.len()).map(move |g| (g, column)));
        let mut best: Option<(usize, usize)> = None;
        for (group, column) in places {
            let found = scores[group][column];
            if found >= config.min_score && best.is_none_or(|(g, c)| found > scores[g][c]) {
                best = Some((group, column));
            }
        }
        let Some((group, column)) = best else { break };
        let (care, value) = cells[column];
        chosen.push(Keyframe {
            column,
            care: care & groups[group],
            value: value & groups[group],
            stiffness: Keyframe::LOOSE,
        });
        blank(&mut scores, group, column);
    }
    chosen.sort_by_key(|keyframe| keyframe.column);
    chosen
}

fn window(column: usize, n_columns: usize) -> f64 {
    let ramp = RAMP * n_columns as f64;
    let from_end = column.min(n_columns - 1 - column) as f64;
    if from_end >= ramp {
        1.0
    } else {
        (1.0 - (PI * from_end / ramp).cos()) / 2.0
    }
}

fn blank(scores: &mut [Vec<f64>], group: usize, column: usize) {
    let own = &scores[group];
    let falls = |pair: &[f64]| pair[1] <= pair[0];
    let right = own[column..]
        .windows(2)
        .take_while(|pair| falls(pair))
        .count();
    let left: Vec<f64> = own[..=column].iter().rev().copied().collect();
    let left = left.windows(2).take_while(|pair| falls(pair)).count();
    scores[group][column - left..=column + right].fill(0.0);
    for scores in scores {
        let end = (column + APART + 1).min(scores.len());
        scores[column.saturating_sub(APART)..end].fill(0.0);
    }
}
