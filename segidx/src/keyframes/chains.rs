//! From the runs of each keyframe to chains. Runs, and ranges of frames in general, are increasing and do not touch.

use std::ops::{Range, RangeInclusive};

/// For each longest range of frames that chains begin with: it, and the frames from the earliest to the latest end.
pub(super) fn with_gaps(
    runs: &[Vec<Range<usize>>],
    gaps: &[RangeInclusive<usize>],
) -> Vec<(Range<usize>, Range<usize>)> {
    if gaps.iter().any(RangeInclusive::is_empty) {
        return Vec::new();
    }
    // First the frames that chains may have reached, then those of them that can be completed.
    let mut levels: Vec<Vec<Range<usize>>> = Vec::with_capacity(runs.len());
    for (i, runs) in runs.iter().enumerate() {
        let reached = match levels.last() {
            None => runs.clone(),
            Some(before) => intersection(&after(before, &gaps[i - 1]), runs),
        };
        if reached.is_empty() {
            return Vec::new();
        }
        levels.push(reached);
    }
    for i in (1..levels.len()).rev() {
        levels[i - 1] = intersection(&before(&levels[i], &gaps[i - 1]), &levels[i - 1]);
    }
    let Some((firsts, others)) = levels.split_first() else {
        return Vec::new();
    };
    // A later first frame has no earlier next frames to choose from, and no fewer later ones: the earliest and the
    // latest ends are those of the first and of the last of these frames, each taking the earliest or latest next.
    let ends = |first: &Range<usize>| {
        let (mut earliest, mut latest) = (first.start, first.end - 1);
        for (level, gap) in others.iter().zip(gaps) {
            earliest = first_from(level, earliest.saturating_add(*gap.start()));
            latest = last_to(level, latest.saturating_add(*gap.end()));
        }
        earliest..latest + 1
    };
    firsts
        .iter()
        .map(|first| (first.clone(), ends(first)))
        .collect()
}

/// The least frame in `ranges` that is no less than `frame`, which exists.
fn first_from(ranges: &[Range<usize>], frame: usize) -> usize {
    let at = ranges.partition_point(|range| range.end <= frame);
    ranges.get(at).map_or(frame, |range| range.start.max(frame))
}

/// The greatest frame in `ranges` that is no greater than `frame`, which exists.
fn last_to(ranges: &[Range<usize>], frame: usize) -> usize {
    let at = ranges.partition_point(|range| range.start <= frame);
    match ranges[..at].last() {
        Some(range) => frame.min(range.end - 1),
        None => frame,
    }
}

fn after(ranges: &[Range<usize>], gap: &RangeInclusive<usize>) -> Vec<Range<usize>> {
    united(ranges.iter().map(|range| {
        range.start.saturating_add(*gap.start())..range.end.saturating_add(*gap.end())
    }))
}

fn before(ranges: &[Range<usize>], gap: &RangeInclusive<usize>) -> Vec<Range<usize>> {
    united(ranges.iter().map(|range| {
        range.start.saturating_sub(*gap.end())..range.end.saturating_sub(*gap.start())
    }))
}

/// Ranges of increasing starts, without the empty ones, touching ones made one.
fn united(ranges: impl Iterator<Item = Range<usize>>) -> Vec<Range<usize>> {
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

/// The chains of the rule of 2006, one for each run of the first keyframe at most; here runs may touch.
pub(super) fn greedy(
    runs: &[Vec<Range<usize>>],
    max_frames: usize,
) -> Vec<(Range<usize>, Range<usize>)> {
    let Some((firsts, others)) = runs.split_first() else {
        return Vec::new();
    };
    let chain = |run: &Range<usize>| {
        let first = run.end - 1;
        let last = others.iter().try_fold(first, |frame, runs| {
            let next = runs.partition_point(|run| run.start < frame);
            runs.get(next).map(|run| run.start)
        })?;
        (last - first < max_frames).then_some((first..first + 1, last..last + 1))
    };
    firsts.iter().filter_map(chain).collect()
}
