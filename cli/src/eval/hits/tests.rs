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

#[test]
fn nothing_answers_nothing() {
    assert_eq!(Response::of_curve(&[], |_| None), Response::default());
    assert_eq!(Response::default().best(), None);
}
