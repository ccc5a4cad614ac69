//! Exact hits around a candidate: one segment per position (2005 paper, eq. 9).

use super::Pattern;

/// Whether the probed position holds, without which there is no hit around the candidate. Most candidates fail here.
#[inline]
pub(super) fn may_extend(pattern: &Pattern<'_, '_>, candidate: usize) -> bool {
    let Some(probe) = pattern.probe else {
        return true;
    };
    // A candidate too near the beginning is beyond the end here.
    let segment = candidate.wrapping_sub(pattern.pivot).wrapping_add(probe);
    segment < pattern.view.n_segments() && pattern.holds(probe, pattern.entry(segment))
}

pub(super) fn extend(pattern: &Pattern<'_, '_>, candidate: usize, bounds: &mut [usize]) -> bool {
    let Some(first) = candidate.checked_sub(pattern.pivot) else {
        return false;
    };
    for (position, bound) in bounds[..pattern.n_positions].iter_mut().enumerate() {
        let segment = first + position;
        let entry = match position {
            0 => Some(pattern.entry(segment)),
            _ => pattern.next_in_document(segment),
        };
        if !entry.is_some_and(|entry| pattern.holds(position, entry)) {
            return false;
        }
        *bound = segment;
    }
    bounds[pattern.n_positions] = first + pattern.n_positions;
    true
}
