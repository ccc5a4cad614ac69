//! Adaptive hits around a candidate: one maximal run of segments per position (spec j.1).

use super::Pattern;

/// Accepts a candidate only as the first segment of its run, so each hit is found once.
///
/// The sets of neighbouring positions are disjoint. So a run that ends where its neighbour begins needs no check that
/// it is maximal on that side, and both directions are forced moves.
pub(super) fn extend(pattern: &Pattern<'_, '_>, candidate: usize, bounds: &mut [usize]) -> bool {
    let pivot = pattern.pivot;
    // Going left, a segment that is the first of its document has nothing before it.
    let mut entry = pattern.entry(candidate);
    let before = |segment: usize| pattern.entry(segment - 1);
    if !entry.is_first && candidate > 0 && pattern.holds(pivot, before(candidate)) {
        return false;
    }

    bounds[pivot] = candidate;
    let mut end = candidate + 1;
    let mut next = pattern.next_in_document(end);
    for (position, bound) in (pivot..).zip(&mut bounds[pivot..pattern.n_positions]) {
        if position > pivot {
            if !next.is_some_and(|next| pattern.holds(position, next)) {
                return false;
            }
            *bound = end;
        }
        while next.is_some_and(|next| pattern.holds(position, next)) {
            end += 1;
            next = pattern.next_in_document(end);
        }
    }
    bounds[pattern.n_positions] = end;

    let mut start = candidate;
    for position in (0..pivot).rev() {
        bounds[position] = start;
        while !entry.is_first && start > 0 {
            let previous = before(start);
            if !pattern.holds(position, previous) {
                break;
            }
            (entry, start) = (previous, start - 1);
        }
        if bounds[position] == start {
            return false;
        }
        bounds[position] = start;
    }
    true
}
