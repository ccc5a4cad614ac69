use mtemplate::{MatchConfig, MotionTemplate};
use proptest::prelude::*;

use super::*;

proptest! {
    /// Templates choose their hits by the same rule.
    #[test]
    fn hits_of_a_curve_are_those_of_templates(
        query in prop::collection::vec(0_u64..8, 2..12),
        words in prop::collection::vec(0_u64..8, 0..120),
    ) {
        let template = MotionTemplate::from_words(&query, 3).unwrap().quantize(0.1).unwrap();
        let curve: Vec<Option<f64>> = template.distance_curve(&words).costs().collect();
        let response = Response::of_curve(&curve, |last| template.start_of(&words, last));
        let config = MatchConfig::up_to(f64::INFINITY);
        prop_assert_eq!(response.hits, template.find_matches(&words, &config));
        prop_assert_eq!(response.costs, curve.into_iter().flatten().collect::<Vec<_>>());
    }
}

/// The hits of a stream of which no frame is told apart, and whose clips they are.
fn textbook(words: &[u64], query: &[u64], lengths: &[usize]) -> Vec<Response> {
    let template = MotionTemplate::from_words(query, 3)
        .unwrap()
        .quantize(0.1)
        .unwrap();
    let costs: Vec<Option<f64>> = template.distance_curve(words).costs().collect();
    let owners: Vec<usize> = lengths
        .iter()
        .enumerate()
        .flat_map(|(k, &n)| vec![k; n])
        .collect();
    let mut responses = vec![Response::default(); lengths.len()];
    for (cost, &owner) in costs.iter().zip(&owners) {
        responses[owner].costs.extend(cost);
    }
    for hit in template.find_matches(words, &MatchConfig::up_to(f64::INFINITY)) {
        let frames = |clip: usize| -> Vec<usize> {
            hit.span
                .clone()
                .filter(|&frame| owners[frame] == clip)
                .collect()
        };
        let most = (0..lengths.len())
            .map(|clip| frames(clip).len())
            .max()
            .unwrap();
        let clip = (0..lengths.len())
            .find(|&clip| frames(clip).len() == most)
            .unwrap();
        let before: usize = lengths[..clip].iter().sum();
        let (first, last) = (frames(clip)[0], frames(clip)[most - 1]);
        let span = first - before..last + 1 - before;
        responses[clip].hits.push(Match {
            span,
            cost: hit.cost,
        });
    }
    responses
}

proptest! {
    #[test]
    fn a_stream_is_divided_among_its_clips(
        query in prop::collection::vec(0_u64..8, 2..12),
        clips in prop::collection::vec(prop::collection::vec(0_u64..8, 0..20), 0..9),
    ) {
        let words = clips.concat();
        let lengths: Vec<usize> = clips.iter().map(Vec::len).collect();
        let template = MotionTemplate::from_words(&query, 3).unwrap().quantize(0.1).unwrap();
        let curve: Vec<Option<f64>> = template.distance_curve(&words).costs().collect();
        let start = |last| template.start_of(&words, last);
        let responses = Response::divided(&curve, start, lengths.iter().copied());
        prop_assert_eq!(responses, textbook(&words, &query, &lengths));
    }
}

#[test]
fn nothing_answers_nothing() {
    assert_eq!(Response::of_curve(&[], |_| None), Response::default());
    assert_eq!(Response::default().best(), None);
}
