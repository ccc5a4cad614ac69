use proptest::prelude::*;

use super::*;
use crate::Steps;
use crate::fixed::Column;

/// Every processor's kernels that this one can run.
fn kinds() -> Vec<Arch> {
    let mut kinds = vec![Arch::Scalar];
    #[cfg(target_arch = "x86_64")]
    {
        kinds.extend(pulp::x86::V3::try_new().map(Arch::V3));
        kinds.extend(pulp::x86::V4::try_new().map(Arch::V4));
    }
    kinds
}

/// D(k,l) cell by cell in a whole table, and starts; `None` where no path leads.
fn textbook(fixed: &FixedCosts, words: &[u64]) -> Vec<Option<(u32, u32)>> {
    let local = |k: usize, word: u64| {
        ((word ^ fixed.value[k]) & fixed.care[k]).count_ones() * fixed.weight[k]
    };
    let n_columns = fixed.n_columns();
    let mut table = vec![vec![None; words.len()]; n_columns];
    for (l, &word) in words.iter().enumerate() {
        for k in 0..n_columns {
            let cost = local(k, word);
            let twice = if fixed.skip == 0 { cost } else { 2 * cost };
            let ways = [(1, 1, cost), (1, 2, cost), (2, 1, twice)];
            let mut best: Option<(u32, u32)> = (k == 0).then_some((cost, l as u32));
            for (columns, frames, cost) in ways {
                if k < columns || l < frames {
                    continue;
                }
                let reached: Option<(u32, u32)> = table[k - columns][l - frames];
                let Some((before, start)) = reached else {
                    continue;
                };
                if best.is_none_or(|(best, _)| before + cost < best) {
                    best = Some((before + cost, start));
                }
            }
            table[k][l] = best;
        }
    }
    table.pop().unwrap_or_default()
}

fn columns() -> impl Strategy<Value = Vec<Column>> {
    let bits = prop_oneof![Just(0), Just(u64::MAX), any::<u64>(), 0..4_u64];
    let column = (bits.clone(), bits, prop_oneof![Just(1.0), 0.1..4.0_f64]);
    let column = column.prop_map(|(care, value, weight)| Column {
        care,
        value: value & care,
        weight,
    });
    // Runs of equal columns, and single ones.
    prop::collection::vec((column, 1_usize..4), 1..12).prop_map(|runs| {
        let runs = runs.into_iter();
        runs.flat_map(|(column, n)| vec![column; n]).collect()
    })
}

/// Up to a few blocks of frames.
fn words() -> impl Strategy<Value = Vec<u64>> {
    let word = prop_oneof![Just(0), Just(u64::MAX), any::<u64>(), 0..4_u64];
    let n = prop_oneof![0_usize..40, BLOCK - 2..BLOCK + 3, 2 * BLOCK..2 * BLOCK + 40];
    (prop::collection::vec(word, 1..60), n)
        .prop_map(|(some, n)| some.iter().copied().cycle().take(n).collect())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn kernels_equal_the_textbook(
        columns in columns(),
        words in words(),
        steps in prop_oneof![Just(Steps::Advance), Just(Steps::Unit)],
    ) {
        prop_assume!(columns.len() >= 2);
        let fixed = FixedCosts::new(&columns, steps);
        let expected = textbook(&fixed, &words);
        for arch in kinds() {
            let [mut alone, mut costs, mut starts] = [(); 3].map(|()| vec![0; words.len()]);
            arch.dispatch(Sweep::<false> {
                fixed: &fixed,
                words: &words,
                costs: &mut alone,
                starts: &mut [],
            });
            arch.dispatch(Sweep::<true> {
                fixed: &fixed,
                words: &words,
                costs: &mut costs,
                starts: &mut starts,
            });
            prop_assert_eq!(&alone, &costs);
            for (frame, expected) in expected.iter().enumerate() {
                let found = (costs[frame] < UNREACHED).then(|| (costs[frame], starts[frame]));
                prop_assert_eq!(found, *expected, "frame {} of {:?}", frame, arch);
            }
        }
    }
}
