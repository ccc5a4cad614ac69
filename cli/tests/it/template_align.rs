//! The alignment that `mtemplate` brings along, beside that of crate `dtw`.

use dtw::{Band, Dtw, StepPattern};
use mtemplate::{MotionTemplate, align};
use ndarray::Array2;
use proptest::prelude::*;

/// Both sum the same local costs, of which there are at most two dozen; each sum is rounded by 2⁻⁵³
/// of itself.
const ROUNDED: f64 = 1e-13;

fn template() -> impl Strategy<Value = MotionTemplate> {
    let value = prop_oneof![(0_u8..=2).prop_map(|v| f64::from(v) / 2.0), 0.0..=1.0_f64];
    let weight = prop_oneof![Just(1.0), 0.25..2.0_f64];
    let columns = prop::collection::vec((prop::collection::vec(value, 3), weight), 1..=12);
    columns.prop_map(|columns| {
        let values = columns.iter().flat_map(|c| c.0.clone()).collect();
        let values = Array2::from_shape_vec((columns.len(), 3), values).unwrap();
        MotionTemplate::new(values, columns.iter().map(|c| c.1).collect()).unwrap()
    })
}

fn local(a: &MotionTemplate, b: &MotionTemplate, i: usize, j: usize) -> f64 {
    let pairs = a.values().row(i).to_owned() - b.values().row(j);
    let mean = (a.weights()[i] + b.weights()[j]) / 2.0;
    pairs.mapv(f64::abs).sum() / a.n_features() as f64 * mean
}

/// Whether no other path comes within `tolerance` of the best.
fn is_unique(costs: &Array2<f64>, tolerance: f64) -> bool {
    let mut reached = Array2::from_elem(costs.dim(), 0.0);
    let mut n_paths = Array2::from_elem(costs.dim(), 1_u32);
    for ((i, j), local) in costs.indexed_iter() {
        let steps = [(1, 1), (0, 1), (1, 0)];
        let before = steps.iter().filter(|(di, dj)| i >= *di && j >= *dj);
        let before: Vec<(usize, usize)> = before.map(|(di, dj)| (i - di, j - dj)).collect();
        if before.is_empty() {
            reached[[i, j]] = *local;
            continue;
        }
        let least = before
            .iter()
            .map(|&at| reached[at])
            .fold(f64::INFINITY, f64::min);
        let good = before
            .iter()
            .filter(|&&at| reached[at] <= least + tolerance);
        n_paths[[i, j]] = good.map(|&at| n_paths[at]).fold(0, u32::saturating_add);
        reached[[i, j]] = least + local;
    }
    n_paths[[costs.nrows() - 1, costs.ncols() - 1]] == 1
}

proptest! {
    #[test]
    fn templates_are_aligned_as_sequences_are(a in template(), b in template()) {
        let found = align(&a, &b).unwrap();
        let costs = Array2::from_shape_fn((a.n_columns(), b.n_columns()), |(i, j)| local(&a, &b, i, j));
        let (rows, columns) = costs.dim();
        let dtw = Dtw::new(Band::Full).with_steps(StepPattern::classic());
        let expected = dtw.align_with(rows, columns, |i, j| costs[[i, j]]).unwrap().unwrap();
        let tolerance = ROUNDED * (1.0 + expected.cost);
        prop_assert!((found.cost - expected.cost).abs() <= tolerance);
        // Ties are broken by rules that differ.
        let along: f64 = found.path.iter().map(|&(i, j)| costs[[i, j]]).sum();
        prop_assert!((along - expected.cost).abs() <= tolerance);
        if is_unique(&costs, tolerance) {
            prop_assert_eq!(found.path, expected.steps);
        }
    }
}
