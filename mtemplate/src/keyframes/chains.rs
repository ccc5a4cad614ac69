//! Frames that can follow each other, as increasing ranges that do not touch.

use std::ops::{Range, RangeInclusive};

/// Frames of `words` that `accepts` takes.
pub(super) fn runs(words: &[u64], accepts: impl Fn(u64) -> bool) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (frame, &word) in words.iter().enumerate() {
        if !accepts(word) {
            continue;
        }
        match runs.last_mut() {
            Some(run) if run.end == frame => run.end += 1,
            _ => runs.push(frame..frame + 1),
        }
    }
    runs
}

/// First and last frames of chains: a frame of each of `runs`, as far from the one before as its gap says. For each
/// longest range of frames that chains begin with, its first frame and the latest end of a chain from it.
pub(super) fn spans(runs: &[&[Range<usize>]], gaps: &[RangeInclusive<usize>]) -> Vec<Range<usize>> {
    let mut levels: Vec<Vec<Range<usize>>> = Vec::with_capacity(runs.len());
    for (i, runs) in runs.iter().enumerate() {
        let reached = match levels.last() {
            None => runs.to_vec(),
            Some(before) => intersection(&after(before, &gaps[i - 1]), runs),
        };
        if reached.is_empty() {
            return Vec::new();
        }
        levels.push(reached);
    }
    // Now of each level what leads to the last one.
    for i in (1..levels.len()).rev() {
        levels[i - 1] = intersection(&before(&levels[i], &gaps[i - 1]), &levels[i - 1]);
    }
    let Some((firsts, others)) = levels.split_first() else {
        return Vec::new();
    };
    // A later first frame has no fewer late frames to go on to, so the last of a range ends latest.
    let latest = |first: &Range<usize>| {
        let steps = others.iter().zip(gaps);
        steps.fold(first.end - 1, |frame, (level, gap)| {
            last_to(level, frame.saturating_add(*gap.end()))
        })
    };
    firsts
        .iter()
        .map(|first| first.start..latest(first) + 1)
        .collect()
}

/// The greatest frame in `ranges` that is no greater than `frame`, which exists.
fn last_to(ranges: &[Range<usize>], frame: usize) -> usize {
    let at = ranges.partition_point(|range| range.start <= frame);
    ranges[..at]
        .last()
        .map_or(frame, |range| frame.min(range.end - 1))
}

fn after(ranges: &[Range<usize>], gap: &RangeInclusive<usize>) -> Vec<Range<usize>> {
    let shift = |range: &Range<usize>| {
        range.start.saturating_add(*gap.start())..range.end.saturating_add(*gap.end())
    };
    united(ranges.iter().map(shift).filter(|_| !gap.is_empty()))
}

fn before(ranges: &[Range<usize>], gap: &RangeInclusive<usize>) -> Vec<Range<usize>> {
    let shift = |range: &Range<usize>| {
        range.start.saturating_sub(*gap.end())..range.end.saturating_sub(*gap.start())
    };
    united(ranges.iter().map(shift))
}

/// Ranges of increasing starts, without the empty ones, touching ones made one.
pub(super) fn united(ranges: impl Iterator<Item = Range<usize>>) -> Vec<Range<usize>> {
    let mut united: Vec<Range<usize>> = Vec::new();
    for range in ranges.filter(|range| !range.is_empty()) {
        match united.last_mut() {
            Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
            _ => united.push(range),
        }
    }
    united
}

fn intersection(a: &[Range<usize>], b: &[Range<usize>]) -> Vec<Range<usize>> {
    let (mut i, mut j) = (0, 0);
    let mut both = Vec::new();
    while let (Some(one), Some(other)) = (a.get(i), b.get(j)) {
        let common = one.start.max(other.start)..one.end.min(other.end);
        if !common.is_empty() {
            both.push(common);
        }
        // Termination: the one that ends first is done with.
        if one.end <= other.end {
            i += 1;
        } else {
            j += 1;
        }
    }
    both
}
