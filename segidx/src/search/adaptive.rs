//! Adaptive hits around a candidate: one maximal run of segments per position (spec j.1).

use super::Pattern;

/// Accepts a candidate only as the first segment of its run, so each hit is found once.
///
/// The sets of neighbouring positions are disjoint. So a run that ends where its neighbour begins needs no check that
/// it is maximal on that side, and both directions are forced moves.
pub(super) fn extend(pattern: &Pattern<'_>, candidate: usize, bounds: &mut [usize]) -> bool {
    let (sets, pivot) = (&pattern.sets, pattern.pivot);
    let holds = |position: usize, segment: usize| sets[position].matches(pattern.words[segment]);
    if pattern.continues(candidate) && holds(pivot, candidate - 1) {
        return false;
    }
    let run_end = |position: usize, mut segment: usize| {
        while pattern.continues(segment) && holds(position, segment) {
            segment += 1;
        }
        segment
    };

    bounds[pivot] = candidate;
    let mut end = run_end(pivot, candidate + 1);
    for (position, bound) in (pivot + 1..sets.len()).zip(&mut bounds[pivot + 1..]) {
        if !pattern.continues(end) || !holds(position, end) {
            return false;
        }
        *bound = end;
        end = run_end(position, end + 1);
    }
    bounds[sets.len()] = end;

    let mut start = candidate;
    for position in (0..pivot).rev() {
        if !pattern.continues(start) || !holds(position, start - 1) {
            return false;
        }
        start -= 1;
        while pattern.continues(start) && holds(position, start - 1) {
            start -= 1;
        }
        bounds[position] = start;
    }
    true
}
