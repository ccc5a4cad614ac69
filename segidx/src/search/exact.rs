//! Exact hits around a candidate: one segment per position (2005 paper, eq. 9).

use super::Pattern;

pub(super) fn extend(pattern: &Pattern<'_>, candidate: usize, bounds: &mut [usize]) -> bool {
    let Some(first) = candidate.checked_sub(pattern.pivot) else {
        return false;
    };
    for (position, set) in pattern.sets.iter().enumerate() {
        let segment = first + position;
        let in_document = match position {
            0 => segment < pattern.words.len(),
            _ => pattern.continues(segment),
        };
        if !in_document || !set.matches(pattern.words[segment]) {
            return false;
        }
        bounds[position] = segment;
    }
    bounds[pattern.sets.len()] = first + pattern.sets.len();
    true
}
