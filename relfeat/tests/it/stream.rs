//! A stream's words are those of the whole motion, however its frames come.

use proptest::prelude::*;
use relfeat::ndarray::{Array3, s};
use relfeat::{ExtractError, FeatureSet, WordStream, extract};

use crate::figure::{idx, map, motion};

/// A figure whose points jump about, go missing and meet, so that directions vanish and are kept.
fn restless(choices: &[u8]) -> Array3<f32> {
    motion(choices.len(), |frame, name, at| {
        let choice = usize::from(choices[frame])
            .wrapping_add(name.len() * 7 + usize::from(name.as_bytes()[0]));
        match choice % 64 {
            0 if frame > 0 => [f32::NAN; 3],
            1..=5 => [0.0, 1.0, 0.0],
            _ => at.map(|x| x + (choice % 7) as f32 * 0.05),
        }
    })
}

/// Pushes stretches of the lengths in `cuts`, again and again.
fn streamed(
    set: &FeatureSet,
    positions: &Array3<f32>,
    rates: [f64; 2],
    cuts: &[usize],
) -> Vec<u64> {
    let mut stream = WordStream::new(set.clone(), map(), rates[0], rates[1]).unwrap();
    let (mut words, mut at) = (Vec::new(), 0);
    for &cut in cuts.iter().cycle() {
        if at >= positions.dim().0 {
            break;
        }
        let end = (at + cut).min(positions.dim().0);
        words.extend(stream.push(positions.slice(s![at..end, .., ..])).unwrap());
        at = end;
    }
    words.extend(stream.finish());
    words
}

proptest! {
    #[test]
    fn streamed_words_equal_extracted_ones(
        set in prop::sample::select(vec!["mueller2006", "mueller2006-table6", "mueller2005"]),
        choices in prop::collection::vec(any::<u8>(), 0..150),
        rate in prop::sample::select(vec![120.0, 100.0, 30.0, 7.5]),
        library_rate in prop::sample::select(vec![30.0, 25.0, 240.0]),
        cuts in prop::collection::vec(1_usize..40, 1..6),
    ) {
        let set = FeatureSet::builtin(set).unwrap();
        let positions = restless(&choices);
        let whole = extract(&set, positions.view(), &map(), rate, library_rate).unwrap().words;
        prop_assert_eq!(streamed(&set, &positions, [rate, library_rate], &cuts), whole);
    }
}

#[test]
fn a_direction_is_kept_over_any_number_of_frames() {
    let set = FeatureSet::builtin("mueller2006").unwrap();
    // Neck and hips meet after the first frame: no plane, no axis for the next 400.
    let positions = motion(400, |frame, name, at| match name {
        "neck" | "chest" | "rhip" | "lhip" if frame > 0 => [0.0, 1.0, 0.0],
        "rwrist" => [
            at[0],
            at[1] + (frame as f32 * 0.2).sin(),
            at[2] + (frame as f32 * 0.3).cos(),
        ],
        _ => at,
    });
    let whole = extract(&set, positions.view(), &map(), 120.0, 120.0)
        .unwrap()
        .words;
    assert!(whole.iter().any(|word| *word != whole[0]));
    assert_eq!(streamed(&set, &positions, [120.0, 120.0], &[1]), whole);
}

#[test]
fn words_come_sixteen_frames_after_theirs() {
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let positions = motion(100, |_, _, at| at);
    let mut stream = WordStream::new(set, map(), 120.0, 120.0).unwrap();
    let mut come = |frames| {
        stream
            .push(positions.slice(s![frames, .., ..]))
            .unwrap()
            .len()
    };
    // 250 ms at 120 Hz: the velocity of frame t ends at frame t + 16.
    assert_eq!(come(0..16), 0);
    assert_eq!(come(16..17), 1);
    assert_eq!(come(17..100), 83);
    assert_eq!(stream.finish().len(), 16);
}

#[test]
fn frames_that_do_not_fit_are_errors() {
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let found = WordStream::new(set.clone(), map(), 0.0, 30.0).unwrap_err();
    assert!(matches!(found, ExtractError::Rate { .. }), "{found}");
    let found = WordStream::new(set.clone(), map(), 1e-9, 30.0).unwrap_err();
    assert!(
        matches!(found, ExtractError::TooManyFrames { .. }),
        "{found}"
    );
    let mut stream = WordStream::new(set, map(), 120.0, 120.0).unwrap();
    let positions = motion(40, |_, _, at| at);
    stream.push(positions.view()).unwrap();
    let more = Array3::zeros((1, 30, 3));
    assert!(stream.push(more.view()).is_err());
    let fewer = positions.slice(s![.., ..idx("rtoes").min(3), ..]);
    assert!(stream.push(fewer).is_err());
    assert_eq!(stream.finish().len(), 16);
}
