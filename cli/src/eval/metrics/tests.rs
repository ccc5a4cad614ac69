use mtemplate::Match;
use proptest::prelude::*;

use super::*;

fn response(costs: &[f64]) -> Response {
    let mut hits: Vec<Match> = costs
        .iter()
        .enumerate()
        .map(|(end, &cost)| Match {
            span: end..end + 1,
            cost,
        })
        .collect();
    hits.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    Response {
        costs: costs.to_vec(),
        hits,
    }
}

/// Few values, so that costs are often equal.
fn trials() -> impl Strategy<Value = (Vec<Response>, Vec<bool>)> {
    let cost = (0_u8..6).prop_map(|c| f64::from(c) / 50.0);
    let clip = prop::collection::vec(cost, 0..4);
    prop::collection::vec((clip, any::<bool>()), 0..12).prop_map(|clips| {
        let responses = clips.iter().map(|(costs, _)| response(costs)).collect();
        (
            responses,
            clips.iter().map(|(_, relevant)| *relevant).collect(),
        )
    })
}

/// Whether clip `a` is ranked before clip `b`.
fn before(responses: &[Response], a: usize, b: usize) -> bool {
    let least = |clip: usize| {
        let costs = responses[clip].costs.iter().copied();
        costs.fold(f64::INFINITY, f64::min)
    };
    least(a) < least(b) || (least(a) == least(b) && a < b)
}

/// By the definition, a relevant clip at a time, without sorting.
fn textbook_average_precision(responses: &[Response], relevant: &[bool]) -> Option<f64> {
    let of: Vec<usize> = (0..relevant.len()).filter(|&clip| relevant[clip]).collect();
    let precision = |&clip: &usize| {
        if responses[clip].costs.is_empty() {
            return 0.0;
        }
        let down_to = |&other: &usize| other == clip || before(responses, other, clip);
        let ranked: Vec<usize> = (0..relevant.len()).filter(down_to).collect();
        let n_relevant = ranked.iter().filter(|&&other| relevant[other]).count();
        n_relevant as f64 / ranked.len() as f64
    };
    let sum: f64 = of.iter().map(precision).sum();
    (!of.is_empty()).then(|| sum / of.len() as f64)
}

/// Sums of at most a dozen shares, added in another order.
const SUM_TOLERANCE: f64 = 12.0 * f64::EPSILON;

proptest! {
    #[test]
    fn average_precision_is_the_textbooks((responses, relevant) in trials()) {
        let found = average_precision(&responses, &relevant);
        let expected = textbook_average_precision(&responses, &relevant);
        prop_assert_eq!(found.is_some(), expected.is_some());
        let difference = found.unwrap_or(0.0) - expected.unwrap_or(0.0);
        prop_assert!(difference.abs() <= SUM_TOLERANCE, "{:?} {:?}", found, expected);
    }

    #[test]
    fn hits_are_counted_one_by_one((responses, relevant) in trials(), tau in 0.0..0.12_f64) {
        let counts = count_hits(&responses, &relevant, tau);
        let (mut hits, mut relevant_hits) = (0, 0);
        for (response, &is_relevant) in responses.iter().zip(&relevant) {
            let within = response.costs.iter().filter(|cost| **cost <= tau).count();
            hits += within;
            relevant_hits += usize::from(is_relevant && within > 0);
        }
        prop_assert_eq!((counts.hits, counts.relevant_hits), (hits, relevant_hits));
        prop_assert_eq!(counts.precision.is_none(), hits == 0);
        prop_assert_eq!(counts.recall.is_none(), !relevant.contains(&true));
    }

    #[test]
    fn the_top_holds_what_fewer_hits_precede((responses, relevant) in trials(), n in 0_usize..12) {
        // Every hit on its own: (cost, clip) with how many come before it.
        let all: Vec<(f64, usize)> = responses
            .iter()
            .enumerate()
            .flat_map(|(clip, r)| r.hits.iter().map(move |hit| (hit.cost, clip)))
            .collect();
        let found = (0..responses.len()).filter(|&clip| {
            relevant[clip]
                && all.iter().filter(|(_, c)| *c == clip).any(|own| {
                    let first = responses[clip].hits[0].cost;
                    let n_before = all.iter().filter(|other| {
                        other.0 < first || (other.0 == first && other.1 < clip)
                    });
                    own.0 == first && n_before.count() < n
                })
        });
        prop_assert_eq!(relevant_in_top(&responses, &relevant, n), found.count());
    }
}

#[test]
fn separation_by_hand() {
    // Costs in ascending order: .1 .2 .2 .3 .4 .6; the correct ones are .1 and .3.
    let responses = [response(&[0.3, 0.1]), response(&[0.2, 0.4, 0.2, 0.6])];
    let quotient = separation(&responses, &[true, false]);
    assert_eq!(quotient, Separation::Quotient(0.25 / 0.2));
    assert_eq!(
        separation(&responses, &[false, false]),
        Separation::Undefined
    );
    let perfect = [response(&[0.0]), response(&[0.4])];
    assert_eq!(separation(&perfect, &[true, false]), Separation::Infinite);
    assert_eq!(separation(&[], &[]), Separation::Undefined);
}

#[test]
fn a_correct_hit_past_the_tenth_does_not_count() {
    let many: Vec<f64> = (1..=10).map(|k| f64::from(k) / 100.0).collect();
    let responses = [response(&many), response(&[0.5])];
    assert_eq!(
        separation(&responses, &[false, true]),
        Separation::Undefined
    );
}

#[test]
fn separations_in_json() {
    let json = |s: Separation| serde_json::to_string(&s).unwrap();
    assert_eq!(json(Separation::Quotient(1.5)), "1.5");
    assert_eq!(json(Separation::Infinite), "\"inf\"");
    assert_eq!(json(Separation::Undefined), "null");
}

#[test]
fn the_least_cost_tells_the_class() {
    assert_eq!(classify(&[Some(0.3), None, Some(0.1), Some(0.1)]), Some(2));
    assert_eq!(classify(&[None, None]), None);
    assert_eq!(classify(&[]), None);
}

#[test]
fn clips_that_cannot_be_aligned_have_no_rank() {
    let responses = [response(&[0.2]), response(&[]), response(&[0.1])];
    assert_eq!(
        average_precision(&responses, &[true, true, false]),
        Some(0.25)
    );
}
