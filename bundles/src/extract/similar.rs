//! Substrings similar to a given one: valid paths of ones through SSA (section 3.4, equation 4).
//!
//! Row i of a search holds, as bits over the letters from a candidate's first on, the cells that a
//! valid path reaches in row i of SSA. The rows of a substring are also the first rows of every
//! longer substring with the same first letter, so one search answers for many ends.

use std::cmp::Ordering;

use crate::extract::Substring;
use crate::extract::bits::{Bits, lowest, ones};
use crate::extract::text::{Band, Text};

/// A last letter that a search answers for, and the widths it admits.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub(super) last: usize,
    pub(super) band: Band,
}

/// A similar substring and what decides when its turn comes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    /// Mean distance along the best path.
    pub(super) mean: f64,
    /// Difference of widths, in half frames.
    pub(super) stretch: usize,
    pub(super) substring: Substring,
}

impl Candidate {
    /// Which one is accepted first.
    pub(super) fn before(&self, other: &Self) -> Ordering {
        (self.mean.total_cmp(&other.mean))
            .then(self.stretch.cmp(&other.stretch))
            .then(self.substring.cmp(&other.substring))
    }
}

/// The least sum of distances to a cell, and the least number of cells of such a path.
#[derive(Debug, Clone, Copy)]
struct Cost {
    sum: f64,
    cells: u32,
}

impl Cost {
    const NONE: Self = Self {
        sum: f64::INFINITY,
        cells: 0,
    };

    fn min(self, other: Self) -> Self {
        match self.sum.total_cmp(&other.sum) {
            Ordering::Less => self,
            Ordering::Greater => other,
            Ordering::Equal if self.cells <= other.cells => self,
            Ordering::Equal => other,
        }
    }
}

/// Memory of searches, used again from one to the next.
#[derive(Debug, Default)]
pub(super) struct Search {
    /// Words of all rows.
    rows: Vec<u64>,
    costs: [Vec<Cost>; 2],
    /// Of the ends whose last rows meet a candidate's window: index, row and offsets of the hits.
    hits: Vec<(usize, usize, Vec<u64>)>,
}

/// Which intervals a candidate may use: those in `free` and not in `taken`.
#[derive(Clone, Copy)]
pub(super) struct Allowed<'a> {
    pub(super) free: &'a Bits,
    pub(super) taken: &'a Bits,
}

impl Allowed<'_> {
    fn window(&self, at: usize) -> u64 {
        self.free.window(at) & !self.taken.window(at)
    }

    /// How many intervals from `at` on are allowed one after the other, up to `most`.
    pub(super) fn run(&self, at: usize, most: usize) -> usize {
        let mut length = 0;
        while length < most {
            let ones = self.window(at + length).trailing_ones() as usize;
            length += ones;
            if ones < 64 {
                break;
            }
        }
        length.min(most)
    }
}

impl Search {
    /// Emits all similar substrings of those from letter `first` to each of `ends`, which are in
    /// increasing order: the end's index and the candidate, by the candidate's first letter.
    pub(super) fn similar(
        &mut self,
        (text, allowed): (&Text<'_>, Allowed<'_>),
        first: usize,
        ends: &[End],
        mut emit: impl FnMut(usize, Candidate),
    ) {
        let Some(widest) = ends.iter().map(|end| end.band.most).max() else {
            return;
        };
        let starts = text.near(first).words();
        for (word, near) in starts.iter().enumerate() {
            let allowed_starts = near & allowed.window(word * 64);
            for start in ones(allowed_starts).map(|bit| word * 64 + bit) {
                let last = start + allowed.run(start, text.max_letters - 1);
                let n = text.letters_within(start, last, widest);
                if n < 2 || !may_end(text, ends, start..start + n) {
                    continue;
                }
                if self.reach(text, first, ends, start..start + n) {
                    self.weigh(text, first, ends, start..start + n, &mut emit);
                }
            }
        }
    }

    /// Fills the rows over `window` and notes the ends that are reached.
    fn reach(
        &mut self,
        text: &Text<'_>,
        first: usize,
        ends: &[End],
        window: std::ops::Range<usize>,
    ) -> bool {
        let n_words = window.len().div_ceil(64);
        self.rows.clear();
        self.hits.clear();
        self.rows.resize(n_words, 0);
        flood(
            text.near(first),
            window.clone(),
            None,
            &mut self.rows[..n_words],
        );
        let mut next_end = 0;
        for position in first + 1..=ends[ends.len() - 1].last {
            let before = self.rows.len();
            self.rows.resize(before + n_words, 0);
            let (done, row) = self.rows.split_at_mut(before);
            let previous = &done[before - n_words..];
            if !flood(text.near(position), window.clone(), Some(previous), row) {
                break;
            }
            if ends[next_end].last == position {
                let (start, band) = (window.start, ends[next_end].band);
                let from = text.letters_within(start, window.end - 1, band.least.max(1) - 1);
                let to = text.letters_within(start, window.end - 1, band.most);
                let hits = between(row, from, to);
                if hits.iter().any(|&word| word != 0) {
                    self.hits.push((next_end, position - first, hits));
                }
                next_end += 1;
            }
        }
        !self.hits.is_empty()
    }

    /// The mean distances to all cells noted.
    fn weigh(
        &mut self,
        text: &Text<'_>,
        first: usize,
        ends: &[End],
        window: std::ops::Range<usize>,
        emit: &mut impl FnMut(usize, Candidate),
    ) {
        let n_words = window.len().div_ceil(64);
        let [previous, current] = &mut self.costs;
        previous.clear();
        previous.resize(window.len(), Cost::NONE);
        let mut hits = self.hits.iter().peekable();
        for (i, row) in self.rows.chunks_exact(n_words).enumerate() {
            if hits.peek().is_none() {
                break;
            }
            current.clear();
            current.resize(window.len(), Cost::NONE);
            let distances = text.access.distance_row(text.letters[first + i]);
            for k in positions(row) {
                let mut best = previous[k];
                if k > 0 {
                    best = best.min(previous[k - 1]).min(current[k - 1]);
                }
                if (i, k) == (0, 0) {
                    best = Cost { sum: 0.0, cells: 0 };
                }
                current[k] = Cost {
                    sum: best.sum + distances[text.letters[window.start + k]],
                    cells: best.cells + 1,
                };
            }
            while let Some((end, _, cells)) = hits.next_if(|(_, at, _)| *at == i) {
                let last = ends[*end].last;
                let width = text.width(Substring { first, last });
                for k in positions(cells) {
                    let substring = Substring {
                        first: window.start,
                        last: window.start + k,
                    };
                    let candidate = Candidate {
                        mean: current[k].sum / f64::from(current[k].cells),
                        stretch: text.width(substring).abs_diff(width),
                        substring,
                    };
                    emit(*end, candidate);
                }
            }
            std::mem::swap(previous, current);
        }
    }
}

/// Whether a candidate from the window's start may end near one of `ends` at all; a certain no
/// saves the rows when there is one end.
fn may_end(text: &Text<'_>, ends: &[End], window: std::ops::Range<usize>) -> bool {
    let [end] = ends else {
        return true;
    };
    let below = end.band.least.max(1) - 1;
    let from = window.start + text.letters_within(window.start, window.end - 1, below);
    text.near(end.last).meets(from..window.end)
}

/// One row of reached cells from the one before it, or the first row; whether any is reached.
///
/// A cell is entered from the cells before it in the previous row, at the same or the previous
/// letter; adding these entries to the row of ones carries them along each run of ones.
fn flood(
    near: &Bits,
    window: std::ops::Range<usize>,
    previous: Option<&[u64]>,
    row: &mut [u64],
) -> bool {
    let (mut shifted_in, mut carry, mut is_alive) = (u64::from(previous.is_none()), false, false);
    for (k, cell) in row.iter_mut().enumerate() {
        let at = window.start + k * 64;
        let ones = near.window(at) & lowest(window.end - at);
        let before = previous.map_or(0, |previous| previous[k]);
        let entries = (before | before << 1 | shifted_in) & ones;
        shifted_in = before >> 63;
        let (sum, over) = ones.overflowing_add(entries);
        let (sum, over_again) = sum.overflowing_add(u64::from(carry));
        carry = over || over_again;
        *cell = ((sum ^ ones) | entries) & ones;
        is_alive |= *cell != 0;
    }
    is_alive
}

/// The bits of `row` within `from..to`.
fn between(row: &[u64], from: usize, to: usize) -> Vec<u64> {
    let words = row.iter().enumerate().map(|(k, word)| {
        let below = |end: usize| lowest(end.saturating_sub(k * 64).min(64));
        word & below(to) & !below(from)
    });
    words.collect()
}

fn positions(words: &[u64]) -> impl Iterator<Item = usize> {
    let offsets = words.iter().enumerate();
    offsets.flat_map(|(k, &word)| ones(word).map(move |bit| k * 64 + bit))
}

#[cfg(test)]
mod tests;
