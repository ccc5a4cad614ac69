use std::ops::Range;

use bundles::Submotion;
use mocap_io::{FrameRate, parse_bvh};
use ndarray::Array2;
use proptest::prelude::*;

use super::*;

const HZ: f64 = 120.0;
/// Shorter blends are spread: 0.3 s.
const LONG_ENOUGH: usize = 36;
/// Rotations go to quaternions and back.
const DEGREES: f64 = 1e-6;
/// The channel of the joint that turns.
const JOINT: usize = 6;

const FIGURE: &[u8] = b"HIERARCHY ROOT hips { OFFSET 0 0 0
    CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
    JOINT knee { OFFSET 0 -40 0 CHANNELS 1 Xrotation End Site { OFFSET 0 -40 0 } } }
    MOTION Frames: 1 Frame Time: 0.01\n0 90 0 0 0 0 0\n";

/// A figure that stands, and whose knee is at these degrees.
fn figure(knee: &[f64]) -> Motion {
    let parsed = parse_bvh(FIGURE).unwrap();
    let stands = parsed.motion.channels.row(0).to_owned();
    let channels = Array2::from_shape_fn((knee.len(), stands.len()), |(k, column)| {
        if column == JOINT {
            knee[k]
        } else {
            stands[column]
        }
    });
    Motion {
        channels,
        rate: FrameRate::from_hz(HZ).unwrap(),
        ..parsed.motion
    }
}

/// Pieces of these lengths, blends or not.
fn walk(pieces: &[(bool, usize)]) -> Walk {
    let span = |len: usize| Submotion {
        clip: 0,
        span: 0..len,
    };
    let piece = |&(is_blend, len): &(bool, usize)| match is_blend {
        false => Piece::Plain(span(len)),
        true => Piece::Blend {
            bundle: 0,
            entry: span(len),
            exit: span(len),
        },
    };
    Walk {
        bundles: vec![0],
        pieces: pieces.iter().map(piece).collect(),
    }
}

fn n_frames(pieces: &[(bool, usize)]) -> usize {
    pieces.iter().map(|&(_, len)| len).sum::<usize>() + 1
}

/// The frames of each blend that is too short.
fn short_blends(pieces: &[(bool, usize)]) -> Vec<Range<usize>> {
    let mut at = 0;
    let spans = pieces.iter().map(|&(is_blend, len)| {
        at += len;
        (is_blend && len < LONG_ENOUGH).then_some(at - len..at)
    });
    spans.flatten().collect()
}

fn pieces(longest: usize) -> impl Strategy<Value = Vec<(bool, usize)>> {
    prop::collection::vec((any::<bool>(), 1..longest), 1..12)
}

proptest! {
    /// Time never runs back, the ends stay, and both places are within the motion.
    #[test]
    fn places_are_in_order_and_around_their_frame(pieces in pieces(60), share in 0.0..=1.0) {
        let reach = reach(&walk(&pieces), n_frames(&pieces), HZ);
        let places = places(&reach, share);
        let last = (places.len() - 1) as f64;
        prop_assert_eq!((places[0], places[places.len() - 1]), ((0.0, 0.0), (last, last)));
        for (k, &(before, after)) in places.iter().enumerate() {
            prop_assert!(0.0 <= before && before <= k as f64);
            prop_assert!(k as f64 <= after && after <= last);
        }
        for pair in places.windows(2) {
            prop_assert!(pair[0].0 <= pair[1].0 && pair[0].1 <= pair[1].1, "{pair:?}");
        }
    }

    /// A short blend has the reach it lacks; frames as far away as a whole blend takes have none.
    #[test]
    fn reach_is_what_short_blends_lack(pieces in pieces(60)) {
        let n_frames = n_frames(&pieces);
        let short = short_blends(&pieces);
        for (k, reach) in reach(&walk(&pieces), n_frames, HZ).into_iter().enumerate() {
            let lacking = |span: &&Range<usize>| (LONG_ENOUGH - span.len()) as f64 / 4.0;
            let inside = short.iter().filter(|span| span.start <= k && k <= span.end);
            let inside = inside.map(|span| lacking(&span)).fold(0.0, f64::max);
            prop_assert!(reach >= inside, "{k}: {reach} of {inside}");
            let mut near = short.iter().filter(|span| {
                span.start <= k + LONG_ENOUGH / 2 && k <= span.end + LONG_ENOUGH / 2
            });
            prop_assert!(reach == 0.0 || near.next().is_some(), "{k}: {reach}");
        }
    }

    /// Means of poses stay between the poses, and the first and last one stay as they are.
    #[test]
    fn poses_stay_within_what_was_there(
        pieces in pieces(30),
        degrees in prop::collection::vec(-60.0..60.0, 361),
    ) {
        let degrees = &degrees[..n_frames(&pieces)];
        let softened = soften(figure(degrees), &walk(&pieces));
        let found = softened.channels.column(JOINT);
        let low = degrees.iter().copied().fold(f64::INFINITY, f64::min);
        let high = degrees.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        prop_assert_eq!(found.len(), degrees.len());
        for &degrees in found {
            prop_assert!(low - DEGREES <= degrees && degrees <= high + DEGREES);
        }
        let last = degrees.len() - 1;
        prop_assert!((found[0] - degrees[0]).abs() <= DEGREES);
        prop_assert!((found[last] - degrees[last]).abs() <= DEGREES);
    }

    /// What bends one way only still does.
    #[test]
    fn what_rises_still_rises(
        pieces in pieces(30),
        steps in prop::collection::vec(0.0..0.3, 361),
    ) {
        let rising = steps[..n_frames(&pieces)].iter().scan(0.0, |sum, step| {
            *sum += step;
            Some(*sum)
        });
        let rising: Vec<f64> = rising.collect();
        let softened = soften(figure(&rising), &walk(&pieces));
        let found = softened.channels.column(JOINT);
        for k in 1..found.len() {
            prop_assert!(found[k] >= found[k - 1] - DEGREES, "frame {k}");
        }
    }

    #[test]
    fn long_blends_and_clips_stay_as_they_are(
        pieces in prop::collection::vec((any::<bool>(), LONG_ENOUGH..60), 1..6),
        degrees in prop::collection::vec(-60.0..60.0, 361),
    ) {
        let motion = figure(&degrees[..n_frames(&pieces)]);
        prop_assert_eq!(soften(motion.clone(), &walk(&pieces)), motion);
    }
}

/// A jump of 30 degrees within one frame becomes a slope of 0.2 s: a line would have 24 steps of 1.25
/// degrees.
#[test]
fn a_jump_becomes_a_slope() {
    const SLOPE_FRAMES: usize = 24;
    let (jump, pieces) = (30.0, [(false, 120), (true, 1), (false, 120)]);
    let degrees: Vec<f64> = (0..242)
        .map(|k| if k <= 120 { 0.0 } else { jump })
        .collect();
    let softened = soften(figure(&degrees), &walk(&pieces));
    let found = softened.channels.column(JOINT);
    let steps = (1..found.len()).map(|k| found[k] - found[k - 1]);
    let largest = steps.fold(0.0, f64::max);
    // Twice the line's at most, as it starts and ends slowly.
    assert!(largest <= 2.0 * jump / SLOPE_FRAMES as f64, "{largest}");
    let (first, last) = (121 - SLOPE_FRAMES / 2, 120 + SLOPE_FRAMES / 2);
    for k in (0..first).chain(last + 1..242) {
        let (found, degrees) = (found[k], degrees[k]);
        assert!((found - degrees).abs() <= DEGREES, "frame {k}: {found}");
    }
}
