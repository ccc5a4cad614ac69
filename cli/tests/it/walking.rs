//! Walks made into motions, on clips of the built-in corpus.

use bundles::{Piece, Submotion, Walk};
use cli::corpus::{Class, plan};
use cli::walking::{Contacts, FOOT_POINTS, PlayError, WalkClip, WalkClips, footlock, play, skate};
use mocap_io::{Motion, forward_kinematics};
use proptest::prelude::*;
use relfeat::BodyMap;

use crate::jumps::Steps;

/// Positions are single precision, and metres.
const ROUNDING: f32 = 1e-4;

/// Locked feet slide at most so much of what they slid: they are held to a millimetre, but ankle and
/// toes of one foot cannot both be where they differ in their own travel.
const MAX_SKATE_LEFT: f64 = 0.5;

const SEED: u64 = 7;

/// The clips of one class by one performer, one after the other, and where its span is in each.
struct Clips {
    clips: WalkClips,
    spans: Vec<Submotion>,
}

impl Clips {
    fn of(performer: &str, class: Class) -> Clips {
        let recordings = plan();
        let own = recordings
            .iter()
            .filter(|r| r.performer().name == performer);
        let (mut clips, mut spans, mut first) = (WalkClips::new(), Vec::new(), 0);
        for (index, recording) in own.filter(|r| r.class() == Some(class)).enumerate() {
            let clip = recording.clip(SEED).unwrap();
            let names: Vec<&str> = clip.motion.skeleton.names().collect();
            let map = BodyMap::recognise(&names);
            let span = clip.labels[0].span.clone();
            let span = first + span.start..first + span.end.min(clip.motion.n_frames() - 1);
            spans.push(Submotion { clip: index, span });
            let n_frames = clip.motion.n_frames();
            let motion = clip.motion;
            clips.insert(index, WalkClip { motion, map, first });
            first += n_frames;
        }
        Clips { clips, spans }
    }

    fn map(&self) -> &BodyMap {
        self.clips[&0].map.as_ref().unwrap()
    }

    fn play(&self, walk: &Walk) -> Motion {
        let motion = play(walk, &self.clips).unwrap();
        let frames: usize = walk.pieces.iter().map(Piece::n_frames).sum();
        assert_eq!(motion.n_frames(), frames + 1);
        motion
    }

    fn part(&self, clip: usize, from: f64, to: f64) -> Submotion {
        let span = &self.spans[clip].span;
        let at = |share: f64| span.start + (share * span.len() as f64).round() as usize;
        Submotion {
            clip,
            span: at(from)..at(to),
        }
    }

    /// Plain, a blend, another blend, plain: through three clips.
    fn across(&self, cut: f64) -> Walk {
        let (a, b, c) = (0, 1, 2);
        let blend = |entry, exit| Piece::Blend {
            bundle: 0,
            entry,
            exit,
        };
        let first = self.clips[&a].first;
        let last = &self.clips[&c];
        let end = self.spans[c].span.end;
        let before = Submotion {
            clip: a,
            span: first..self.spans[a].span.start,
        };
        let after = Submotion {
            clip: c,
            span: end..last.first + last.motion.n_frames() - 1,
        };
        let pieces = vec![
            Piece::Plain(before),
            blend(self.part(a, 0.0, cut), self.part(b, 0.0, cut)),
            blend(self.part(b, cut, 1.0), self.part(c, cut, 1.0)),
            Piece::Plain(after),
        ];
        let pieces = pieces
            .into_iter()
            .filter(|piece| piece.n_frames() > 0)
            .collect();
        Walk {
            bundles: vec![0],
            pieces,
        }
    }

    fn steps(&self) -> Vec<Steps> {
        self.clips
            .values()
            .map(|clip| Steps::of(&clip.motion))
            .collect()
    }
}

fn assert_same_places(a: &Motion, b: &Motion) {
    let (a, b) = (forward_kinematics(a), forward_kinematics(b));
    assert_eq!(a.dim(), b.dim());
    let far = a.iter().zip(&b).map(|(p, q)| (p - q).abs());
    let far = far.fold(0.0, f32::max);
    assert!(far <= ROUNDING, "{far} m apart");
}

#[test]
fn pieces_of_one_clip_in_a_row_are_the_clip() {
    let clips = Clips::of("eva", Class::Jog);
    let cuts = [0, 5, 6, 40, clips.clips[&0].motion.n_frames() - 1];
    let pieces = cuts.windows(2).map(|cut| {
        Piece::Plain(Submotion {
            clip: 0,
            span: cut[0]..cut[1],
        })
    });
    let walk = Walk {
        bundles: vec![0],
        pieces: pieces.collect(),
    };
    assert_same_places(&clips.play(&walk), &clips.clips[&0].motion);
}

#[test]
fn a_submotion_blended_with_itself_is_itself() {
    let clips = Clips::of("eva", Class::Walk);
    let entry = clips.part(1, 0.0, 1.0);
    let blend = Piece::Blend {
        bundle: 0,
        entry: entry.clone(),
        exit: entry.clone(),
    };
    let walk = |piece| Walk {
        bundles: vec![0],
        pieces: vec![piece],
    };
    assert_same_places(
        &clips.play(&walk(blend)),
        &clips.play(&walk(Piece::Plain(entry))),
    );
}

#[test]
fn a_blend_begins_and_ends_in_the_poses_of_its_clips() {
    let clips = Clips::of("anna", Class::Squat);
    let (entry, exit) = (clips.part(0, 0.0, 1.0), clips.part(2, 0.0, 1.0));
    let blend = Piece::Blend {
        bundle: 0,
        entry: entry.clone(),
        exit: exit.clone(),
    };
    let played = clips.play(&Walk {
        bundles: vec![0],
        pieces: vec![blend],
    });
    let pose = |clip: usize, frame: usize| {
        let source = &clips.clips[&clip];
        source.motion.channels.row(frame - source.first).to_owned()
    };
    let last = played.n_frames() - 1;
    let ends = [
        (0, pose(0, entry.span.start)),
        (last, pose(2, exit.span.end)),
    ];
    for (k, pose) in ends {
        // Behind the channels of the root, which is elsewhere.
        for column in 6..played.channels.ncols() {
            let (found, expected) = (played.channels[[k, column]], pose[column]);
            assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
        }
    }
}

#[test]
fn no_class_jumps_from_one_frame_to_the_next() {
    for class in [
        Class::Walk,
        Class::Jog,
        Class::Squat,
        Class::PunchLeft,
        Class::Hop,
    ] {
        for performer in ["anna", "eva"] {
            let clips = Clips::of(performer, class);
            let walk = clips.across(0.5);
            let motion = clips.play(&walk);
            let sources = clips.steps();
            let ratio = Steps::of(&motion).assert_no_jump(&sources);
            let contacts = Contacts::of_walk(&walk, &clips.clips).unwrap();
            assert_eq!(
                contacts.on_floor.dim(),
                (motion.n_frames(), FOOT_POINTS.len())
            );
            let locked = footlock(&motion, clips.map(), &contacts);
            let locked_ratio = Steps::of(&locked).assert_no_jump(&sources);
            println!("{performer} {class:?}: {ratio:.2}, {locked_ratio:.2} with feet locked");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn no_cut_makes_a_walk_jump(cut in 0.2..0.8) {
        let clips = Clips::of("chiyo", Class::Walk);
        let motion = clips.play(&clips.across(cut));
        Steps::of(&motion).assert_no_jump(&clips.steps());
    }
}

#[test]
fn a_clip_that_stands_does_not_skate_and_one_that_is_pushed_does() {
    let clips = Clips::of("eva", Class::Squat);
    let mut motion = clips.clips[&0].motion.slice(0..60).unwrap();
    for k in 0..60 {
        let first = motion.channels.row(0).to_owned();
        motion.channels.row_mut(k).assign(&first);
    }
    let contacts = Contacts::of_clip(&motion, clips.map());
    assert!(contacts.on_floor.iter().all(|&c| c));
    assert_eq!(skate(&motion, clips.map(), &contacts), Some(0.0));
    // A metre per second along X, by the root's first channel.
    let (hz, metres) = (motion.rate.hz(), motion.unit.metres());
    for k in 0..60 {
        motion.channels[[k, 0]] += k as f64 / hz / metres;
    }
    let found = skate(&motion, clips.map(), &contacts).unwrap();
    assert!((found - 1.0).abs() < 1e-3, "{found}");
    // What travels that fast is not in contact of its own.
    let pushed = Contacts::of_clip(&motion, clips.map());
    assert!(!pushed.on_floor.iter().any(|&c| c));
    assert_eq!(skate(&motion, clips.map(), &pushed), None);
}

#[test]
fn locked_feet_skate_less_and_the_root_stays() {
    for performer in ["anna", "eva"] {
        let clips = Clips::of(performer, Class::Walk);
        let walk = clips.across(0.4);
        let motion = clips.play(&walk);
        let contacts = Contacts::of_walk(&walk, &clips.clips).unwrap();
        let locked = footlock(&motion, clips.map(), &contacts);
        let skate = |motion: &Motion| skate(motion, clips.map(), &contacts).unwrap();
        let (before, after) = (skate(&motion), skate(&locked));
        println!("{performer}: {before:.3} m/s, locked {after:.3} m/s");
        assert!(after <= MAX_SKATE_LEFT * before, "{after} of {before}");
        for column in 0..6 {
            assert_eq!(
                motion.channels.column(column),
                locked.channels.column(column)
            );
        }
    }
}

#[test]
fn a_walk_through_other_clips_is_refused() {
    let clips = Clips::of("eva", Class::Walk);
    let beyond = clips.clips[&2].first + clips.clips[&2].motion.n_frames();
    for (clip, span) in [(7, 0..4), (0, 0..beyond), (2, 0..4)] {
        let piece = Piece::Plain(Submotion {
            clip,
            span: span.clone(),
        });
        let walk = Walk {
            bundles: vec![0],
            pieces: vec![piece],
        };
        let expected = PlayError::Frames { clip, span };
        assert_eq!(play(&walk, &clips.clips).unwrap_err(), expected);
        assert_eq!(
            Contacts::of_walk(&walk, &clips.clips).unwrap_err(),
            expected
        );
    }
    let walk = Walk {
        bundles: vec![],
        pieces: vec![],
    };
    assert_eq!(play(&walk, &clips.clips).unwrap_err(), PlayError::Empty);
}
