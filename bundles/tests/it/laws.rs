use std::ops::Range;

use bundles::ndarray::{Array1, Array2};
use bundles::{Letter, PoseClusters, adjacent_distance_median, spell};
use proptest::prelude::*;

use crate::naive;

const N_LETTERS: usize = 4;

/// Clips in order, some empty, with frames before, between and after them that belong to none.
fn labelled_clips() -> impl Strategy<Value = (Vec<u32>, Vec<Range<usize>>)> {
    prop::collection::vec((0_usize..3, 0_usize..12), 0..5).prop_flat_map(|parts| {
        let mut clips = Vec::new();
        let mut frame = 0;
        for (gap, length) in parts {
            clips.push(frame + gap..frame + gap + length);
            frame += gap + length;
        }
        let labels = prop::collection::vec(0..N_LETTERS as u32, frame + 1);
        (labels, Just(clips))
    })
}

fn clusters() -> impl Strategy<Value = (Array2<f64>, Array1<f64>)> {
    (0_usize..4).prop_flat_map(|dims| {
        let means = prop::collection::vec(-9.0..9.0_f64, N_LETTERS * dims);
        let sigmas = prop::collection::vec(0.1..3.0_f64, N_LETTERS);
        (means, sigmas).prop_map(move |(means, sigmas)| {
            (
                Array2::from_shape_vec((N_LETTERS, dims), means).unwrap(),
                Array1::from(sigmas),
            )
        })
    })
}

proptest! {
    #[test]
    fn strings_equal_the_definition((labels, clips) in labelled_clips()) {
        let string = spell(&labels, &clips).unwrap();
        let expected = naive::spell(&labels, &clips);
        prop_assert_eq!(string.len(), expected.len());
        for (run, (label, clip, frames)) in string.runs().iter().zip(expected) {
            prop_assert_eq!((run.letter.label(), run.clip), (label, clip));
            prop_assert_eq!(run.frames.clone().collect::<Vec<_>>(), &frames[..]);
            prop_assert_eq!(run.mean_frame(), naive::mean(&frames));
        }
    }

    #[test]
    fn runs_tile_each_clip((labels, clips) in labelled_clips()) {
        let string = spell(&labels, &clips).unwrap();
        prop_assert_eq!(string.n_clips(), clips.len());
        for (clip, span) in clips.iter().enumerate() {
            let mut frame = span.start;
            for run in &string.runs()[string.clip_span(clip).unwrap()] {
                prop_assert_eq!(run.clip, clip);
                prop_assert_eq!(run.frames.start, frame);
                prop_assert!(run.frames.end > frame);
                frame = run.frames.end;
            }
            prop_assert_eq!(frame, span.end);
        }
    }

    #[test]
    fn neighbours_within_a_clip_differ((labels, clips) in labelled_clips()) {
        let string = spell(&labels, &clips).unwrap();
        for pair in string.runs().windows(2) {
            prop_assert!(pair[0].clip != pair[1].clip || pair[0].letter != pair[1].letter);
        }
    }

    #[test]
    fn widths_add_up_and_never_span_clips((labels, clips) in labelled_clips()) {
        let string = spell(&labels, &clips).unwrap();
        let m = string.len();
        for (i, j) in (0..m).flat_map(|i| (0..=m).map(move |j| (i, j))) {
            let width = string.width(i, j);
            let is_one_clip = i <= j && j < m && string.runs()[i].clip == string.runs()[j].clip;
            prop_assert_eq!(width.is_some(), is_one_clip);
            if let Some(width) = width {
                // Halves are exact in binary: so is every sum of them here.
                let steps: f64 = (i..j).map(|k| string.width(k, k + 1).unwrap()).sum();
                prop_assert_eq!(steps, width);
            }
        }
    }

    #[test]
    fn spelling_clip_by_clip_is_the_same((labels, clips) in labelled_clips()) {
        let string = spell(&labels, &clips).unwrap();
        for (clip, span) in clips.iter().enumerate() {
            let alone = spell(&labels, std::slice::from_ref(span)).unwrap();
            let runs = &string.runs()[string.clip_span(clip).unwrap()];
            prop_assert_eq!(alone.len(), runs.len());
            for (alone, run) in alone.runs().iter().zip(runs) {
                prop_assert_eq!((alone.letter, &alone.frames), (run.letter, &run.frames));
            }
        }
    }

    #[test]
    fn distances_equal_the_definition((means, sigmas) in clusters()) {
        let clusters = PoseClusters::new(means.view(), sigmas.view()).unwrap();
        let letter = |index: usize| Letter::from_label(index as u32);
        for (a, b) in (0..N_LETTERS).flat_map(|a| (0..N_LETTERS).map(move |b| (a, b))) {
            let distance = clusters.distance(letter(a), letter(b));
            prop_assert_eq!(distance, Some(naive::distance(&means, &sigmas, a, b)));
            prop_assert_eq!(distance, clusters.distance(letter(b), letter(a)));
        }
    }

    #[test]
    fn thresholds_equal_the_definition(
        (labels, clips) in labelled_clips(),
        (means, sigmas) in clusters(),
    ) {
        let string = spell(&labels, &clips).unwrap();
        let clusters = PoseClusters::new(means.view(), sigmas.view()).unwrap();
        let expected = naive::threshold(&naive::spell(&labels, &clips), &means, &sigmas);
        prop_assert_eq!(adjacent_distance_median(&string, &clusters).unwrap(), expected);
    }

    #[test]
    fn any_clips_are_spelt_or_refused(
        labels in prop::collection::vec(0_u32..3, 0..8),
        bounds in prop::collection::vec((0_usize..10, 0_usize..10), 0..4),
    ) {
        let clips: Vec<Range<usize>> = bounds.into_iter().map(|(start, end)| start..end).collect();
        let mut free = 0;
        let is_valid = clips.iter().all(|clip| {
            let fits = free <= clip.start && clip.start <= clip.end && clip.end <= labels.len();
            free = clip.end;
            fits
        });
        prop_assert_eq!(spell(&labels, &clips).is_ok(), is_valid);
    }
}
