use super::*;

#[test]
fn free_bits_of_a_mask_are_dropped() {
    assert_eq!(Mask::new(0b10, 0b11), Mask::new(0b10, 0b10));
    assert_eq!(Mask::new(0b10, 0b11).value(), 0b10);
    assert_eq!(Mask::new(0b10, 0b11).care(), 0b10);
}

#[test]
fn a_mask_without_care_matches_every_word() {
    let all = Mask::new(0, 0b101);
    assert!(all.matches(0) && all.matches(u64::MAX));
}

#[test]
fn a_set_without_masks_matches_nothing_and_meets_nothing() {
    let empty = FuzzySet::default();
    assert!(!empty.matches(0));
    assert!(!empty.intersects(&Mask::new(0, 0).into()));
}

#[test]
fn the_order_of_masks_does_not_matter() {
    assert_eq!(
        FuzzySet::from_words([2, 1, 2]),
        FuzzySet::from_words([1, 2])
    );
}

#[test]
fn masks_meet_as_the_words_they_stand_for() {
    for bits in 0..1u64 << 12 {
        let mask = |shift: u64| Mask::new((bits >> shift) & 7, (bits >> (shift + 3)) & 7);
        let (a, b) = (mask(0), mask(6));
        let shared = (0..8).any(|word| a.matches(word) && b.matches(word));
        assert_eq!(a.intersects(&b), shared, "{a:?} {b:?}");
    }
}
