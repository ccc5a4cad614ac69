//! Algorithm A: the lists of all positions, joined.
//!
//! Per position ℓ the segments of V_ℓ are united and coalesced into runs; a run is a single segment in exact search, as
//! long as the word stays the same (of the bits looked at) with mismatches, and as long as V_ℓ lasts in adaptive search.
//! Level ℓ holds the beginnings of hits that end with position ℓ, by increasing end. It is the union over j of the
//! H(ℓ, j) of spec j.2, of those elements that have matched at least once: others are put in when they first match, which
//! is when it turns out how many positions before have been wrong. Without mismatches this leaves the equality join of
//! spec j.1. Neither the runs of a position nor the ends of a level overlap, so each level is one merge.

use super::pattern::{Kind, Match, Pattern};
use super::{Hits, SearchPlan};
use crate::shard::Dictionary;

/// From the first segment of a run to one past its last.
#[derive(Clone, Copy)]
struct Run {
    start: usize,
    end: usize,
}

/// The beginning of a hit, up to some position.
struct Partial {
    /// Its run at the last position.
    run: Run,
    n_mismatches: usize,
    is_mismatch: bool,
    /// Its beginning one position shorter, by number; `None` if all positions before are mismatches.
    before: Option<usize>,
}

pub(super) fn run(
    pattern: &Pattern<'_, '_>,
    kind: Kind<'_>,
    dictionary: &Dictionary,
    (done, hits): (&mut SearchPlan, &mut Hits<'_, '_>),
) {
    let mut of_set: Vec<Option<Vec<Run>>> = Vec::new();
    of_set.resize_with(pattern.sets.n_different(), || None);
    let may = |&position: &usize| kind.may_mismatch(position);
    // The positions that may all be wrong before the first right one.
    let n_leading = (0..kind.max_mismatches()).take_while(may).count();
    let mut levels: Vec<Vec<Partial>> = Vec::with_capacity(pattern.n_positions);
    for position in 0..pattern.n_positions {
        let runs = of_set[pattern.sets.of_position(position)]
            .get_or_insert_with(|| runs_of(pattern, kind, dictionary, (position, &mut *done)));
        let before = levels.last().map_or(&[][..], |level| level);
        let level = Level {
            pattern,
            kind,
            position,
            n_leading,
        }
        .after(before, runs);
        if pattern.view.failed() || level.is_empty() && position >= n_leading {
            return;
        }
        levels.push(level);
    }
    let mut found = Match::new(pattern.n_positions);
    for last in levels.last().into_iter().flatten() {
        trace(pattern, &levels, last, &mut found);
        hits.push(&found);
    }
}

/// The runs of a position, in order.
fn runs_of(
    pattern: &Pattern<'_, '_>,
    kind: Kind<'_>,
    dictionary: &Dictionary,
    (position, done): (usize, &mut SearchPlan),
) -> Vec<Run> {
    let mut segments: Vec<u32> = Vec::new();
    for list in pattern.sets.numbers(position) {
        done.n_lists += 1;
        let postings = pattern.view.postings(dictionary, list);
        segments.extend(postings.map(|segment| segment as u32));
    }
    done.n_postings += segments.len();
    let mut runs: Vec<Run> = Vec::new();
    let mut add = |segment: usize| {
        if let Some(run) = runs.last_mut()
            && run.end == segment
            && continues(pattern, kind, segment)
        {
            run.end += 1;
            return;
        }
        let (start, end) = (segment, segment + 1);
        runs.push(Run { start, end });
    };
    if segments.len() < pattern.view.n_segments() / 64 {
        segments.sort_unstable();
        segments
            .into_iter()
            .for_each(|segment| add(segment as usize));
    } else {
        in_order(&segments, pattern.view.n_segments()).for_each(add);
    }
    done.n_candidates += runs.len();
    runs
}

/// Different numbers below `n`, increasing, by way of a bit for each.
fn in_order(numbers: &[u32], n: usize) -> impl Iterator<Item = usize> {
    let mut bits = vec![0u64; n.div_ceil(64)];
    for &number in numbers {
        bits[number as usize / 64] |= 1 << (number % 64);
    }
    bits.into_iter().enumerate().flat_map(|(at, bits)| {
        let mut left = bits;
        std::iter::from_fn(move || {
            let bit = (left != 0).then(|| left.trailing_zeros() as usize)?;
            left &= left - 1;
            Some(64 * at + bit)
        })
    })
}

/// Whether `segment`, of the same position as the one before it, belongs to the same run.
fn continues(pattern: &Pattern<'_, '_>, kind: Kind<'_>, segment: usize) -> bool {
    match kind {
        Kind::Exact => false,
        Kind::Adaptive => !pattern.entry(segment).is_first,
        Kind::Mismatch(_) if !pattern.sets.is_restricted() => false,
        Kind::Mismatch(_) => {
            let (before, entry) = (pattern.entry(segment - 1), pattern.entry(segment));
            !entry.is_first && pattern.sets.agree(before.word, entry.word)
        }
    }
}

/// How one level follows from the one before it.
struct Level<'p, 'a> {
    pattern: &'p Pattern<'p, 'a>,
    kind: Kind<'p>,
    position: usize,
    n_leading: usize,
}

impl Level<'_, '_> {
    fn after(&self, before: &[Partial], runs: &[Run]) -> Vec<Partial> {
        let mut level = Vec::new();
        let mut before = before.iter().enumerate().peekable();
        let mut runs = runs.iter().peekable();
        // Termination: every turn takes something.
        loop {
            let end = before.peek().map(|(_, partial)| partial.run.end);
            let start = runs.peek().map(|run| run.start);
            let ends_first = match (end, start) {
                (None, None) => return level,
                (Some(end), Some(start)) => end <= start,
                (end, None) => end.is_some(),
                (None, Some(_)) => false,
            };
            let run = (end == start || !ends_first).then(|| runs.next()).flatten();
            let partial = if ends_first { before.next() } else { None };
            level.extend(match (partial, run) {
                (Some((number, partial)), Some(&run)) => self.matched(number, partial, run),
                (Some((number, partial)), None) => self.missed(number, partial),
                (None, Some(&run)) => self.entered(run),
                (None, None) => None,
            });
        }
    }

    fn matched(&self, number: usize, partial: &Partial, run: Run) -> Option<Partial> {
        self.pattern.next_in_document(run.start)?;
        Some(Partial {
            run,
            n_mismatches: partial.n_mismatches,
            is_mismatch: false,
            before: Some(number),
        })
    }

    fn missed(&self, number: usize, partial: &Partial) -> Option<Partial> {
        let may = self.kind.may_mismatch(self.position);
        if !may || partial.n_mismatches == self.kind.max_mismatches() {
            return None;
        }
        let start = partial.run.end;
        let entry = self.pattern.next_in_document(start)?;
        let end = self.pattern.end_of_word(start, entry);
        Some(Partial {
            run: Run { start, end },
            n_mismatches: partial.n_mismatches + 1,
            is_mismatch: true,
            before: Some(number),
        })
    }

    /// A beginning that matches here for the first time.
    fn entered(&self, run: Run) -> Option<Partial> {
        if self.position > self.n_leading {
            return None;
        }
        let mut start = run.start;
        for _ in 0..self.position {
            start = run_before(self.pattern, start)?;
        }
        Some(Partial {
            run,
            n_mismatches: self.position,
            is_mismatch: false,
            before: None,
        })
    }
}

/// The first segment of the run of equal words that ends where another run starts, in the same document.
fn run_before(pattern: &Pattern<'_, '_>, start: usize) -> Option<usize> {
    if pattern.entry(start).is_first {
        return None;
    }
    let last = start.checked_sub(1)?;
    Some(pattern.start_of_word(last, pattern.entry(last)).0)
}

/// The runs and mismatches of a hit, from its last run backwards.
fn trace(pattern: &Pattern<'_, '_>, levels: &[Vec<Partial>], last: &Partial, found: &mut Match) {
    found.mismatches.clear();
    found.bounds[levels.len()] = last.run.end;
    let mut partial = Some(last);
    for position in (0..levels.len()).rev() {
        found.bounds[position] = match partial {
            Some(partial) => partial.run.start,
            // `entered` has been there.
            None => run_before(pattern, found.bounds[position + 1]).unwrap_or_default(),
        };
        if partial.is_none_or(|partial| partial.is_mismatch) {
            found.mismatches.push(position);
        }
        let before = partial.and_then(|partial| partial.before);
        partial = before.and_then(|number| levels[position.checked_sub(1)?].get(number));
    }
    found.mismatches.reverse();
}
