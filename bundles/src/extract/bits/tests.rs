use std::collections::BTreeSet;

use proptest::prelude::*;

use super::*;

proptest! {
    #[test]
    fn sets_equal_ordered_sets(
        changes in prop::collection::vec((0_usize..200, 0_usize..80, any::<bool>()), 0..12),
        read in 0_usize..260,
        n in 0_usize..130,
    ) {
        let (mut bits, mut set) = (Bits::none(200), BTreeSet::new());
        for (start, length, is_new) in changes {
            let range = start..(start + length).min(200);
            if is_new {
                bits.insert(range.clone());
                set.extend(range);
            } else {
                bits.remove(range.clone());
                set.retain(|position| !range.contains(position));
            }
        }
        prop_assert_eq!(&bits, &(0..200).map(|position| set.contains(&position)).collect());
        prop_assert_eq!(bits.contains(read), set.contains(&read));
        prop_assert_eq!(bits.meets(read..read + n), set.range(read..read + n).next().is_some());
        let window: Vec<usize> = ones(bits.window(read)).map(|bit| read + bit).collect();
        prop_assert_eq!(window, set.range(read..read + 64).copied().collect::<Vec<_>>());
    }
}
