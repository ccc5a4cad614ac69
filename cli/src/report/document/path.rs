//! How a hit and the example are played together.

use super::{PageHit, Place};

impl PageHit {
    /// The path along which segments of the hit play together with those of the example, which are in `segments`:
    /// from both first frames over the first of each further segment to both last ones. Where there are not as many
    /// segments, from end to end alone.
    #[must_use]
    pub fn path_to(&self, example: &Place, segments: &[[usize; 2]]) -> Vec<[usize; 2]> {
        let last = [self.place.end, example.end].map(|end| end.saturating_sub(1));
        let mut path = vec![[self.place.start, example.start]];
        let others = match self.segments.len() == segments.len() {
            true => segments,
            false => &[],
        };
        for (own, other) in self.segments.iter().zip(others).skip(1) {
            let pair = [own[0], other[0]];
            let before = path[path.len() - 1];
            if (0..2).all(|side| (before[side]..=last[side]).contains(&pair[side])) {
                path.push(pair);
            }
        }
        path.push(last);
        path
    }
}

#[cfg(test)]
mod tests {
    use std::ops::Range;

    use super::*;

    #[test]
    fn segments_play_together() {
        let hit = |frames: Range<usize>, segments: &[[usize; 2]]| PageHit {
            place: Place::new(0, frames, 30.0),
            rank: 1,
            cost: 0.0,
            mirrored: false,
            segments: segments.to_vec(),
            path: Vec::new(),
            agreement: None,
            ask: None,
        };
        let example = Place::new(1, 100..140, 30.0);
        let asked = [[100, 110], [110, 130], [130, 140]];
        let found = hit(10..30, &[[10, 12], [12, 13], [13, 30]]);
        let path = found.path_to(&example, &asked);
        assert_eq!(path, [[10, 100], [12, 110], [13, 130], [29, 139]]);
        // As many are needed, and none lies outside.
        assert_eq!(found.path_to(&example, &asked[..2]), [[10, 100], [29, 139]]);
        let outside = hit(10..30, &[[4, 12], [12, 40], [40, 50]]);
        let path = outside.path_to(&example, &asked);
        assert_eq!(path, [[10, 100], [12, 110], [29, 139]]);
        let one = hit(5..6, &[]).path_to(&Place::new(1, 7..8, 30.0), &[]);
        assert_eq!(one, [[5, 7], [5, 7]]);
    }
}
