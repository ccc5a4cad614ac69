use super::*;
use cli::library::verify;

/// A library of a few clips, walks over words of which neighbours differ in one bit.
fn originals(dir: &Path) -> Originals {
    let features = NamedSet::find("mueller2005").unwrap();
    let n_features = features.set.features().len();
    let mut writer = Writer::create(dir, features, 30.0).unwrap();
    let mut dice = Dice::new(5);
    for clip in 0..6 {
        let mut word = 0u64;
        let words: Vec<u64> = (0..200)
            .map(|_| {
                word ^= u64::from(dice.below(3) == 0) << dice.below(n_features);
                word
            })
            .collect();
        let meta = ClipMeta {
            source_rate: 30.0,
            source_frames: 200,
            first_frame: 0,
            end_frame: 200,
            first_word: 0,
            available: u64::MAX,
            rig: "none".to_owned(),
            content: clip,
        };
        writer.push(&format!("clip {clip}"), &meta, &words).unwrap();
    }
    writer.commit(&BTreeSet::new()).unwrap();
    Originals::open(dir).unwrap()
}

#[test]
fn a_small_run_is_sound_and_finds_what_was_put_in() {
    const PERFORMERS: u32 = 8;
    let dir = tempfile::tempdir().unwrap();
    let originals = originals(&dir.path().join("originals"));
    let (one, many) = (dir.path().join("one"), dir.path().join("many"));
    let built = build(&originals, PERFORMERS, &one, usize::MAX).unwrap();
    build(&originals, PERFORMERS, &many, 500).unwrap();
    assert_eq!(built.n_clips, 48);
    let n_frames = originals.n_frames() as u64 * u64::from(PERFORMERS);
    assert!(built.n_frames.abs_diff(n_frames) < n_frames / 10);
    assert_eq!(verify(&many).unwrap().damage, []);
    let library = Library::open(&many).unwrap();
    assert!(library.shards().len() > 2);
    for (number, clip) in library.clips().unwrap().iter().enumerate() {
        let words = library.words(clip.id).unwrap();
        let performer = (number / originals.clips.len()) as u32;
        assert_eq!(
            words,
            originals.copy(performer, number % originals.clips.len())
        );
    }

    let care = originals.features.set.select(PART).unwrap();
    let questions = questions(&originals, 2, 30, care);
    assert_eq!(questions.len(), 30);
    let (one, many) = (
        ask(&one, &questions, care).unwrap(),
        ask(&many, &questions, care).unwrap(),
    );
    for (question, (one, many)) in questions.iter().zip(one.iter().zip(&many)) {
        assert!(many.n_hits > 0, "{question:?}");
        let facts = |answer: &Answer| (answer.n_positions, answer.n_hits, answer.n_postings);
        assert_eq!(facts(one), facts(many));
        assert!(one.n_postings >= one.n_hits as u64);
        assert_eq!(segment(&question.words).len(), question.n_positions);
    }
}
