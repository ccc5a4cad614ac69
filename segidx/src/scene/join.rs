//! The hits of a scene in one document.
//!
//! Let a combination give each line the number of one of its hits. Every bound is of the form "given the number of the
//! left line, that of the right line is at least so much", and grows with it (see [`super::bound`]). So of two
//! combinations that satisfy all bounds, the smaller numbers of each line satisfy them too, and above any given
//! numbers there is a least combination, found by raising numbers until no bound asks for more. Nothing is tried out.

use std::ops::Range;

use super::bound::{Bound, Extent};

/// Per hit of a line its runs.
pub(super) type LineHits = Vec<Vec<Range<usize>>>;

/// A span, and the combination it comes from.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Found {
    pub(super) span: (i64, i64),
    /// Per line the number of its hit.
    pub(super) hits: Vec<usize>,
}

/// A document: the hits of every line in order of time, and what is asked of them.
pub(super) struct Join<'a> {
    lines: Vec<LineHits>,
    cores: &'a [Extent],
    between_lines: Vec<Bound>,
}

impl<'a> Join<'a> {
    pub(super) fn new(lines: Vec<LineHits>, cores: &'a [Extent], bounds: &[Bound]) -> Join<'a> {
        let (within_line, between_lines): (Vec<Bound>, Vec<Bound>) =
            bounds.iter().partition(|b| b.left.line == b.right.line);
        let mut join = Join {
            lines,
            cores,
            between_lines,
        };
        for bound in within_line {
            let holds = |runs: &Vec<Range<usize>>| bound.left.of(runs) <= bound.right.of(runs);
            join.lines[bound.left.line].retain(holds);
        }
        join
    }

    pub(super) fn runs(&self, line: usize, hit: usize) -> &[Range<usize>] {
        &self.lines[line][hit]
    }

    /// Every span once, by start and end, with the first of its combinations: the earliest hit of line 0 that has one,
    /// then of line 1, and so on.
    pub(super) fn spans(&self) -> Vec<Found> {
        let mut found = Vec::new();
        for (first, hits) in self.lines.iter().enumerate() {
            for hit in 0..hits.len() {
                self.starting_with(first, hit, &mut found);
            }
        }
        found.sort_unstable();
        found.dedup_by_key(|found| found.span);
        found
    }

    /// Collects the combinations whose span starts with `hit` of line `first`: for each hit that could end the span
    /// the least combination.
    fn starting_with(&self, first: usize, hit: usize, found: &mut Vec<Found>) {
        let start = self.cores[first].start.of(&self.lines[first][hit]);
        let starts_late = |(line, hits): (usize, &LineHits)| {
            let edge = self.cores[line].start;
            let low = hits.partition_point(|runs| edge.of(runs) < start);
            (low < hits.len()).then_some(low)
        };
        let low: Option<Vec<usize>> = self.lines.iter().enumerate().map(starts_late).collect();
        let Some(mut low) = low else { return };
        if !self.raise(&mut low) || low[first] != hit {
            return;
        }
        for (last, hits) in self.lines.iter().enumerate() {
            let mut low = low.clone();
            // Termination: `low[last]` grows with each turn.
            while low[last] < hits.len() {
                let candidate = low[last];
                if !self.raise(&mut low) || low[first] != hit {
                    // Larger numbers of the last line ask for no less.
                    break;
                }
                if low[last] == candidate {
                    let end = self.end(last, candidate);
                    if (0..low.len()).all(|line| self.end(line, low[line]) <= end) {
                        let (span, hits) = ((start, end), low.clone());
                        found.push(Found { span, hits });
                    }
                    low[last] += 1;
                }
            }
        }
    }

    fn end(&self, line: usize, hit: usize) -> i64 {
        self.cores[line].end.of(&self.lines[line][hit])
    }

    /// Raises `low` to the least combination that is nowhere below it; false if there is none.
    fn raise(&self, low: &mut [usize]) -> bool {
        // Termination: each round but the last raises a number.
        loop {
            let mut is_done = true;
            for Bound { left, right } in &self.between_lines {
                let least = left.of(&self.lines[left.line][low[left.line]]);
                let at = &mut low[right.line];
                let later = &self.lines[right.line][*at..];
                let n_short = later.partition_point(|runs| right.of(runs) < least);
                if n_short == later.len() {
                    return false;
                }
                *at += n_short;
                is_done &= n_short == 0;
            }
            if is_done {
                return true;
            }
        }
    }
}
