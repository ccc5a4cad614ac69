//! Bitmaps of features.

use crate::segments::{Position, Segments, WORD_BITS, each_bit};

/// A bit per segment for each feature, and one for the first segments of documents.
pub(crate) struct Bitmaps {
    n: usize,
    of_feature: Vec<Vec<u64>>,
    is_first: Vec<u64>,
}

impl Bitmaps {
    pub(crate) fn of(segments: &Segments, n_features: usize) -> Self {
        // One more bit, for what ends with the last segment.
        let n_words = (segments.len() + 1).div_ceil(WORD_BITS);
        let bitmap = |is_set: &dyn Fn(usize) -> bool| {
            let mut bits = vec![0; n_words];
            for segment in (0..segments.len()).filter(|&segment| is_set(segment)) {
                bits[segment / WORD_BITS] |= 1 << (segment % WORD_BITS);
            }
            bits
        };
        let of_feature = |feature| bitmap(&|segment| segments.words[segment] >> feature & 1 == 1);
        Self {
            n: segments.len(),
            of_feature: (0..n_features).map(of_feature).collect(),
            is_first: bitmap(&|segment| segments.is_first[segment]),
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.is_first[..]) * (1 + self.of_feature.len())
    }

    /// The segments that a position accepts, 64 at a time.
    fn accepted(&self, position: Position) -> impl Fn(usize) -> u64 {
        let (mut care, mut chosen) = (position.care, Vec::new());
        while care != 0 && (care.trailing_zeros() as usize) < self.of_feature.len() {
            let feature = care.trailing_zeros();
            let is_off = u64::from(position.value >> feature & 1 == 0);
            chosen.push((
                &self.of_feature[feature as usize][..],
                0u64.wrapping_sub(is_off),
            ));
            care &= care - 1;
        }
        let n = self.n;
        move |at| {
            let bits = chosen.iter();
            let bits = bits.fold(u64::MAX, |bits, (bitmap, off)| bits & (bitmap[at] ^ off));
            // Only in the last word there are bits without a segment.
            let n_left = n - (at * WORD_BITS).min(n);
            bits & u64::MAX
                .checked_shr((WORD_BITS - n_left.min(WORD_BITS)) as u32)
                .unwrap_or(0)
        }
    }

    pub(crate) fn scan(&self, position: Position, mut visit: impl FnMut(usize)) {
        let accepted = self.accepted(position);
        for at in 0..self.is_first.len() {
            each_bit(accepted(at), |i| visit(WORD_BITS * at + i));
        }
    }

    /// Visits the last segment of each exact hit: the segments of one position after the other.
    pub(crate) fn exact(&self, positions: &[Position], mut visit: impl FnMut(usize)) {
        let accepted = positions.iter().map(|&position| self.accepted(position));
        let mut accepted: Vec<_> = accepted.map(|accepted| (accepted, 0_u64)).collect();
        for at in 0..self.is_first.len() {
            let mut before = None;
            for (accepted, carry) in &mut accepted {
                let mut found = accepted(at);
                if let Some(before) = before {
                    found &= (before << 1 | *carry) & !self.is_first[at];
                    *carry = before >> 63;
                }
                before = Some(found);
            }
            each_bit(before.unwrap_or(0), |i| visit(WORD_BITS * at + i));
        }
    }

    /// Visits the end of each adaptive hit, one past its last segment. The sets of neighbouring
    /// positions must be disjoint.
    ///
    /// A marker behind the first segment of a run is carried behind its last one by an addition, as
    /// Parabix scans through character classes (Cameron et al., 2014). The first segment of a
    /// document is no part of what is scanned through, so that runs end with their document.
    pub(crate) fn adaptive(&self, positions: &[Position], mut visit: impl FnMut(usize)) {
        #[derive(Clone, Copy, Default)]
        struct Carries {
            accepted: u64,
            start: u64,
            sum: bool,
        }
        let accepted = positions.iter().map(|&position| self.accepted(position));
        let mut accepted: Vec<_> = accepted.map(|of| (of, Carries::default())).collect();
        for at in 0..self.is_first.len() {
            let first = self.is_first[at];
            let mut ends = None;
            for (accepted, carries) in &mut accepted {
                let all = accepted(at);
                let inner = all & !first;
                let starts = match ends {
                    None => all & !(inner & (all << 1 | carries.accepted)),
                    Some(ends) => inner & ends,
                };
                carries.accepted = all >> 63;
                let behind = starts << 1 | carries.start;
                carries.start = starts >> 63;
                let (sum, over) = behind.overflowing_add(inner);
                let (sum, over_too) = sum.overflowing_add(u64::from(carries.sum));
                carries.sum = over | over_too;
                ends = Some(sum & !inner);
            }
            each_bit(ends.unwrap_or(0), |i| visit(WORD_BITS * at + i));
        }
    }
}
