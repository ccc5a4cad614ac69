//! The motions of the paper's three examples (section 6.2, Figures 7 to 9) in our recordings.

use std::ops::Range;

use segidx::{Segment, segment};

use crate::clips::{Clip, Part};
use crate::judgement::Judgement;
use crate::naive::coarsen;

/// Features by which a motion is looked for, by their numbers in the paper.
pub(crate) struct Selection {
    pub(crate) features: &'static [u32],
    /// Positions and hits of the paper's query.
    pub(crate) paper: &'static str,
}

impl Selection {
    pub(crate) fn care(&self) -> u64 {
        care(self.features)
    }

    pub(crate) fn name(&self, part: Part) -> String {
        let names = self
            .features
            .iter()
            .map(|n| format!("F{}{n}", part.letter()));
        names.collect::<Vec<_>>().join(" ")
    }
}

fn care(features: &[u32]) -> u64 {
    features
        .iter()
        .fold(0, |bits, number| bits | 1 << (number - 1))
}

/// A motion that is looked for.
pub(crate) struct Example {
    pub(crate) title: &'static str,
    pub(crate) part: Part,
    /// What relevant clips show, and what others show that hold the motion among others.
    relevant: &'static [&'static str],
    unjudged: &'static [&'static str],
    /// Query frames of a relevant clip, from its words.
    pub(crate) queries: fn(&[u64]) -> Vec<Range<usize>>,
    /// The paper's first selection comes first.
    pub(crate) selections: &'static [Selection],
}

impl Example {
    /// What a clip is to this motion.
    pub(crate) fn judgement(&self, clip: &Clip) -> Judgement {
        let shows_one = |of: &[&str]| of.iter().any(|what| clip.shows.contains(what));
        if shows_one(self.relevant) {
            Judgement::Relevant
        } else if shows_one(self.unjudged) {
            Judgement::Unjudged
        } else {
            Judgement::Other
        }
    }
}

const fn by(features: &'static [u32], paper: &'static str) -> Selection {
    Selection { features, paper }
}

/// In the paper's order.
pub(crate) const EXAMPLES: [Example; 3] = [
    Example {
        // Oiduki is a lunge punch.
        title: "Punch (Fig. 7). Queries: left hand punches in boxing, punch and Oiduki; other karate is not judged",
        part: Part::Upper,
        relevant: &["punch", "boxing", "Oiduki"],
        unjudged: &[
            "Empi",
            "Front Kick",
            "Gedanbarai",
            "Heiansyodan",
            "Mawashigeri",
            "Syutouuke",
            "Yokogeri",
        ],
        queries: left_punches,
        selections: &[
            by(&[1, 2, 7, 8], "6 segs, 16 hits"),
            by(&[2, 8], "4 segs, 264 hits"),
            by(&[1, 2, 3, 4, 7, 8], "8 segs, 1 hit"),
        ],
    },
    Example {
        title: "Squat (Fig. 8). Queries: every clip of squat1Reps; trials of several exercises are not judged",
        part: Part::Lower,
        relevant: &["squat1Reps"],
        unjudged: &["squat"],
        queries: whole_clip,
        selections: &[
            by(
                &[5, 6, 7, 10, 11],
                "5 segs, 33 hits: 7 squats of 11, on top",
            ),
            by(&[7, 10, 11], "5 segs, 63 hits: the same 7 on top"),
        ],
    },
    Example {
        // Mawashigeri and Yokogeri are kicks, Empi is a form with many techniques.
        title: "Kick (Fig. 9). Queries: every clip of kickLFront1Reps; kicks of soccer and karate are not judged",
        part: Part::Lower,
        relevant: &["kickLFront1Reps"],
        unjudged: &["kick", "Kick", "Mawashigeri", "Yokogeri", "Empi"],
        queries: whole_clip,
        selections: &[
            by(&[3, 4, 7, 8], "19 hits: 13 kicks of 13"),
            by(&[4, 8], "more hits"),
            by(&[4], "more hits"),
        ],
    },
];

fn whole_clip(words: &[u64]) -> Vec<Range<usize>> {
    std::iter::once(0..words.len()).collect()
}

/// Left hand in front, left elbow bent.
const LEFT_HAND_FRONT: u64 = 1 << 1;
const LEFT_ELBOW_BENT: u64 = 1 << 7;
/// Segments of the paper's query.
const PUNCH_SEGMENTS: usize = 6;

/// Stretches of six segments by the features of the paper's query that begin and end with a bent
/// left elbow, between which the arm is straight with its hand in front.
fn left_punches(words: &[u64]) -> Vec<Range<usize>> {
    let segments = coarsen(&segment(words), care(&[1, 2, 7, 8]));
    let is_bent = |s: &Segment| s.word & LEFT_ELBOW_BENT != 0;
    let is_blow = |s: &Segment| !is_bent(s) && s.word & LEFT_HAND_FRONT != 0;
    let mut punches = Vec::new();
    for window in segments.windows(PUNCH_SEGMENTS) {
        let (first, last) = (&window[0], &window[PUNCH_SEGMENTS - 1]);
        if is_bent(first) && is_bent(last) && window.iter().any(is_blow) {
            punches.push(first.span().start..last.span().end);
        }
    }
    punches
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_are_counted_from_1() {
        assert_eq!(care(&[1, 2, 7, 8]), 0b1100_0011);
        assert_eq!(
            care(&[1, 2, 7, 8]) & (LEFT_HAND_FRONT | LEFT_ELBOW_BENT),
            0b1000_0010
        );
    }

    #[test]
    fn a_punch_stretches_the_left_arm_between_bends() {
        let [bent, both, blow, back] = [0x80, 0x82, 0x02, 0x40];
        // An unrelated bit changes within the first segment.
        let punch = [bent, bent | 4, both, blow, both, bent, both];
        let found = left_punches(&punch);
        assert_eq!(found.first(), Some(&(0..7)));
        assert_eq!(found.len(), 1);
        assert_eq!(left_punches(&[bent, both, bent, both, bent, both]), []);
        assert_eq!(left_punches(&[back, bent, both, blow, both, back]), []);
    }
}
