//! Endings, matches and streams, against the definitions.

use mtemplate::ndarray::{Array1, Array2};
use mtemplate::{
    COST_ERROR, Ending, Match, MatchConfig, MatchStream, MotionTemplate, QuantizedTemplate,
    ShortClips, Steps, StreamMatcher,
};
use proptest::prelude::*;

use crate::naive;

/// Templates of up to `columns` columns over few features: costs are often equal.
fn template(columns: usize) -> impl Strategy<Value = QuantizedTemplate> {
    let shape = (0..=columns, 1_usize..=3);
    let steps = prop_oneof![Just(Steps::Advance), Just(Steps::Unit)];
    (shape, steps).prop_flat_map(|((columns, features), steps)| {
        let cell = prop_oneof![3 => Just(0.0), 3 => Just(1.0), 1 => Just(0.5)];
        let values = prop::collection::vec(cell, columns * features);
        values.prop_map(move |values| {
            let values = Array2::from_shape_vec((columns, features), values).unwrap();
            let template = MotionTemplate::new(values, Array1::ones(columns)).unwrap();
            template.quantize(0.1).unwrap().with_steps(steps)
        })
    })
}

/// Words that mostly stay.
fn words(at_most: usize) -> impl Strategy<Value = Vec<u64>> {
    let runs = prop::collection::vec((0..8_u64, 1_usize..5), 0..=at_most / 3);
    runs.prop_map(move |runs| {
        let runs = runs.into_iter();
        let words = runs.flat_map(|(word, n)| std::iter::repeat_n(word, n));
        words.take(at_most).collect()
    })
}

/// A template, words, and a threshold: any, or at one of the costs.
fn case() -> impl Strategy<Value = (QuantizedTemplate, Vec<u64>, f64)> {
    let tau = prop_oneof![
        Just(None),
        Just(Some(0.0)),
        Just(Some(1.0)),
        (0.0..0.7_f64).prop_map(Some)
    ];
    (template(9), words(150), tau, any::<prop::sample::Index>()).prop_map(
        |(template, words, tau, index)| {
            let costs: Vec<f64> = template.distance_curve(&words).costs().flatten().collect();
            let at = || {
                if costs.is_empty() {
                    0.1
                } else {
                    costs[index.index(costs.len())]
                }
            };
            let tau = tau.unwrap_or_else(at);
            (template, words, tau)
        },
    )
}

fn by_cost(mut matches: Vec<Match>) -> Vec<Match> {
    matches.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.span.end.cmp(&b.span.end)));
    matches
}

fn streamed(template: &QuantizedTemplate, words: &[u64], tau: f64) -> Vec<Match> {
    let mut stream = MatchStream::new(template, tau);
    let mut matches: Vec<Match> = words.iter().flat_map(|word| stream.push(*word)).collect();
    matches.extend(stream.finish());
    by_cost(matches)
}

proptest! {
    #[test]
    fn endings_equal_the_textbook(template in template(6), words in words(10)) {
        let n_columns = template.n_columns();
        let expected = naive::exact_endings(&template, &words);
        let endings = template.endings(&words);
        prop_assert_eq!(endings.len(), words.len());
        let largest = COST_ERROR * n_columns as f64;
        for (ending, expected) in endings.iter().zip(expected) {
            let expected = if n_columns < 2 { None } else { expected };
            prop_assert_eq!(ending.map(|e| e.start), expected.map(|e| e.start));
            let costs = ending.zip(expected).map(|(a, b)| (a.cost - b.cost).abs());
            prop_assert!(costs.is_none_or(|error| error <= largest));
        }
    }

    #[test]
    fn starts_and_curve_are_parts_of_endings(template in template(9), words in words(60)) {
        let endings = template.endings(&words);
        let curve = template.distance_curve(&words);
        let starts: Vec<Option<usize>> = endings.iter().map(|e| Some(e.as_ref()?.start)).collect();
        prop_assert_eq!(&template.starts(&words), &starts);
        for (frame, ending) in endings.iter().enumerate() {
            prop_assert_eq!(curve.cost(frame), ending.map(|ending| ending.cost));
            prop_assert_eq!(template.start_of(&words, frame), starts[frame]);
        }
    }

    #[test]
    fn short_clips_are_held_until_they_fit(template in template(8), words in words(8)) {
        let template = template.with_short_clips(ShortClips::Held);
        let endings = template.endings(&words);
        prop_assert_eq!(endings.len(), words.len());
        let largest = COST_ERROR * template.n_columns() as f64;
        for (frame, (ending, expected)) in endings.iter().zip(held(&template, &words)).enumerate() {
            prop_assert_eq!(ending.map(|e| e.start), expected.map(|e| e.start));
            let costs = ending.zip(expected).map(|(a, b)| (a.cost - b.cost).abs());
            prop_assert!(costs.is_none_or(|error| error <= largest));
            prop_assert_eq!(template.distance_curve(&words).cost(frame), ending.map(|e| e.cost));
            prop_assert_eq!(template.start_of(&words, frame), ending.map(|e| e.start));
        }
        let config = MatchConfig::up_to(f64::INFINITY);
        prop_assert_eq!(
            template.find_matches(&words, &config),
            naive::find_matches(endings, &config)
        );
    }

    #[test]
    fn holding_changes_no_clip_that_is_long_enough(template in template(9), words in words(60)) {
        let held = template.clone().with_short_clips(ShortClips::Held);
        if template.endings(&words).iter().any(Option::is_some) {
            prop_assert_eq!(held.endings(&words), template.endings(&words));
        }
    }

    #[test]
    fn a_stream_has_the_endings_of_the_whole(template in template(40), words in words(300)) {
        let mut matcher = StreamMatcher::new(&template);
        let streamed: Vec<Option<Ending>> = words.iter().map(|word| matcher.push(*word)).collect();
        prop_assert_eq!(streamed, template.endings(&words));
        prop_assert_eq!(matcher.n_frames(), words.len());
    }

    #[test]
    fn matches_equal_the_definition(
        (template, words, tau) in case(),
        max_matches in prop_oneof![Just(0), Just(1), Just(3), Just(500)],
    ) {
        let config = MatchConfig { tau, max_matches };
        let found = template.find_matches(&words, &config);
        prop_assert_eq!(found, naive::find_matches(template.endings(&words), &config));
    }

}

/// The last frame is held once more, then the first, and so on until a match ends somewhere.
fn held(template: &QuantizedTemplate, words: &[u64]) -> Vec<Option<Ending>> {
    if template.n_columns() < 2 || words.is_empty() {
        return vec![None; words.len()];
    }
    let mut held = words.to_vec();
    loop {
        let endings = naive::exact_endings(template, &held);
        if endings.iter().any(Option::is_some) {
            if held.len() == words.len() {
                return endings;
            }
            let whole = endings.last().unwrap().unwrap();
            let mut endings = vec![None; words.len() - 1];
            endings.push(Some(Ending { start: 0, ..whole }));
            return endings;
        }
        if (held.len() - words.len()).is_multiple_of(2) {
            held.push(*words.last().unwrap());
        } else {
            held.insert(0, words[0]);
        }
    }
}

proptest! {
    // Few of the cases are the knotty ones.
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn a_stream_has_the_matches_of_the_whole((template, words, tau) in case()) {
        let config = MatchConfig { tau, max_matches: usize::MAX };
        let whole = template.find_matches(&words, &config);
        prop_assert_eq!(streamed(&template, &words, tau), whole);
    }
}

/// A motion of five poses, whose last one is short, in a clip of something else.
fn planted(n_before: usize, n_after: usize) -> (QuantizedTemplate, Vec<u64>) {
    let motion: Vec<u64> = (0..21).map(|frame| 1 << (frame / 5)).collect();
    let template = MotionTemplate::from_words(&motion, 5).unwrap();
    let words = [
        &vec![0b11111; n_before][..],
        &motion,
        &vec![0b11111; n_after],
    ]
    .concat();
    (template.quantize(0.1).unwrap(), words)
}

#[test]
fn a_match_comes_out_when_no_word_can_change_it() {
    let (template, words) = planted(30, 200);
    let mut stream = MatchStream::new(&template, 0.2);
    let out: Vec<(usize, Match)> = words
        .iter()
        .enumerate()
        .flat_map(|(frame, word)| stream.push(*word).into_iter().map(move |m| (frame, m)))
        .collect();
    // At no cost there is nothing to wait for.
    assert_eq!(out.len(), 1);
    assert_eq!(
        (out[0].0, out[0].1.span.clone(), out[0].1.cost),
        (50, 30..51, 0.0)
    );
    assert_eq!(stream.finish(), []);
}

#[test]
fn a_dearer_match_waits_for_its_neighbours() {
    let (template, mut words) = planted(30, 200);
    // One frame could be stepped over.
    words[36..38].fill(0b11111);
    let mut stream = MatchStream::new(&template, 0.2);
    let certain_at = words.iter().position(|word| !stream.push(*word).is_empty());
    let last = template.find_matches(&words, &MatchConfig::up_to(0.2))[0]
        .span
        .end
        - 1;
    let waited = certain_at.unwrap() - last;
    assert!(
        0 < waited && waited <= 17 * template.n_columns() / 10,
        "{waited}"
    );
}

#[test]
fn an_infinite_or_missing_threshold_is_one_all_the_same() {
    let (template, words) = planted(5, 5);
    let all = MatchConfig {
        tau: f64::INFINITY,
        max_matches: usize::MAX,
    };
    let found = template.find_matches(&words, &all);
    assert_eq!(streamed(&template, &words, f64::INFINITY), found);
    assert!(!found.is_empty());
    assert_eq!(streamed(&template, &words, f64::NAN), []);
    assert_eq!(
        template.find_matches(&words, &MatchConfig::up_to(f64::NAN)),
        []
    );
}
