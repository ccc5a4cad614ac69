use ndarray::array;
use proptest::prelude::*;

use super::*;

/// D(k, l) of spec.md d by its definition, without a table: the cheapest way to end in a cell.
fn textbook(costs: &Array2<f64>, k: usize, l: usize) -> f64 {
    let here = costs[[k, l]];
    if k == 0 {
        return here;
    }
    let mut best = f64::INFINITY;
    for (rows, columns, weight) in [(1, 1, 1.0), (1, 2, 1.0), (2, 1, 2.0)] {
        if k >= rows && l >= columns {
            best = best.min(textbook(costs, k - rows, l - columns) + weight * here);
        }
    }
    best
}

/// Of sums of at most six costs in another order.
const SUM_TOLERANCE: f64 = 1e-12;

proptest! {
    #[test]
    fn an_example_is_matched_as_a_template_is(
        (n, m) in (2_usize..7, 1_usize..12),
        values in prop::collection::vec(0_u8..5, 72),
    ) {
        let costs = Array2::from_shape_fn((n, m), |(i, j)| f64::from(values[i * 12 + j]));
        let response = respond(costs.view(), ShortClips::Unmatched).unwrap();
        let expected: Vec<f64> = (0..m)
            .map(|l| textbook(&costs, n - 1, l) / n as f64)
            .filter(|cost| cost.is_finite())
            .collect();
        prop_assert_eq!(response.costs.len(), expected.len());
        for (found, expected) in response.costs.iter().zip(&expected) {
            prop_assert!((found - expected).abs() <= SUM_TOLERANCE);
        }
        for hit in &response.hits {
            prop_assert!((n.div_ceil(2)..=2 * n).contains(&hit.span.len()), "{:?}", hit);
        }
    }
}

/// A clip whose words are its frames' costs, the same for all frames of the example, is held as templates hold it.
#[test]
fn short_clips_are_held_at_their_ends() {
    // Frames 0 to 2 of a clip; of the four missing ones two come first.
    let (n, clip) = (13, [1.0, 2.0, 4.0]);
    let costs = Array2::from_shape_fn((n, clip.len()), |(_, j)| clip[j]);
    let held = [1.0, 1.0, 1.0, 2.0, 4.0, 4.0, 4.0];
    let held = Array2::from_shape_fn((n, held.len()), |(_, j)| held[j]);
    let expected = textbook(&held, n - 1, held.ncols() - 1) / n as f64;
    let response = respond(costs.view(), ShortClips::Held).unwrap();
    assert_eq!(response.hits.len(), 1);
    assert_eq!(response.hits[0].span, 0..clip.len());
    assert!((response.hits[0].cost - expected).abs() <= SUM_TOLERANCE);
    assert_eq!(response.costs, [response.hits[0].cost]);
    let unmatched = respond(costs.view(), ShortClips::Unmatched).unwrap();
    assert_eq!(unmatched, Response::default());
}

#[test]
fn angles_are_on_the_sphere() {
    let half = 0.5_f64.sqrt();
    let (still, quarter) = (array![1.0, 0.0, 0.0, 0.0], array![half, half, 0.0, 0.0]);
    let angle = mean_angle(still.view(), quarter.view());
    assert!((angle - std::f64::consts::FRAC_PI_4).abs() < SUM_TOLERANCE);
    // The opposite quaternion is the same rotation.
    assert_eq!(mean_angle(still.view(), (-&still).view()), 0.0);
}

#[test]
fn a_pose_without_names_in_common_has_no_cost() {
    let named = |name: &str| Named {
        names: vec![name.to_owned()],
        values: array![[0.0, 3.0, 4.0]],
    };
    let (a, b) = (named("lknee"), named("rknee"));
    assert_eq!(local_costs(&a, &b, Baseline::Coordinates), None);
    let origin = Named {
        values: array![[0.0, 0.0, 0.0]],
        ..a.clone()
    };
    assert_eq!(
        local_costs(&a, &origin, Baseline::Coordinates),
        Some(array![[5.0]])
    );
}

/// Clips of which nothing reaches beyond its own: the same apart and in one stream.
#[test]
fn what_lacks_poses_parts_a_stream() {
    let none = Array2::from_elem((4, 3), f64::NAN);
    let clip =
        |seed: usize| Array2::from_shape_fn((4, 6), |(i, j)| ((i * 5 + j * seed) % 7) as f64);
    let (a, b) = (clip(2), clip(3));
    let joined = respond_joined(&[a.clone(), none, b.clone()]).unwrap();
    let apart = |costs: &Array2<f64>| respond(costs.view(), ShortClips::Unmatched).unwrap();
    assert_eq!(joined, [apart(&a), Response::default(), apart(&b)]);
    // Without what parts them, a match of the second clip may begin in the first.
    let [_, second] = &respond_joined(&[a, b.clone()]).unwrap()[..] else {
        panic!("two clips");
    };
    assert!(second.costs.len() > apart(&b).costs.len());
    assert_eq!(respond_joined(&[]).unwrap(), []);
}
