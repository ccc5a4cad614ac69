use super::*;

#[track_caller]
fn check(query: &Query, lengths: &[Option<usize>], segments: &[Range<usize>]) {
    let positions = query.positions();
    let found: Vec<_> = positions.iter().map(|p| p.n_frames).collect();
    assert_eq!(found, lengths);
    let found: Vec<_> = positions.iter().map(|p| p.segments.clone()).collect();
    assert_eq!(found, segments);
}

#[test]
fn an_exact_query_keeps_every_segment() {
    let query = Query::exact(&[0b01, 0b01, 0b11, 0b00], 0b01);
    check(&query, &[Some(2), Some(1), Some(1)], &[0..1, 1..2, 2..3]);
}

#[test]
fn a_fuzzy_query_unites_neighbours_that_agree() {
    let query = Query::fuzzy(&[0b01, 0b01, 0b11, 0b00], 0b01);
    check(&query, &[Some(3), Some(1)], &[0..2, 2..3]);
    let of: Vec<_> = (0..4).map(|i| query.position_of(i)).collect();
    assert_eq!(of, [Some(0), Some(0), Some(1), None]);
}

#[test]
fn no_words_give_no_positions() {
    assert!(Query::fuzzy(&[], 1).positions().is_empty());
    assert_eq!(Query::default().position_of(0), None);
}

#[test]
fn a_union_can_touch_the_set_before_it() {
    // The first and the third set share word 1 and are kept apart by the second, until the fourth joins the last two.
    let sets = [vec![1, 2], vec![3], vec![1, 4], vec![3, 4]];
    let lengths = [Some(1), Some(2), None, Some(4)];
    let sets = sets.map(FuzzySet::from_words).into_iter().zip(lengths);
    let query = Query::from_sets(sets);
    check(&query, &[None], std::slice::from_ref(&(0..4)));
    assert_eq!(query.positions()[0].set, FuzzySet::from_words([1, 2, 3, 4]));
}

#[test]
fn conjoining_is_idempotent_and_borrows_when_idle() {
    let exact = Query::exact(&[0, 1, 2, 3], 0b10);
    assert_eq!(*exact.conjoined(), Query::fuzzy(&[0, 1, 2, 3], 0b10));
    assert!(matches!(exact.conjoined(), Cow::Owned(_)));
    let fuzzy = Query::fuzzy(&[0, 1, 2, 3], 0b10);
    assert!(matches!(fuzzy.conjoined(), Cow::Borrowed(_)));
}

#[test]
fn lengths_saturate() {
    let set = FuzzySet::from_words([1]);
    let query = Query::from_sets([(set.clone(), Some(usize::MAX)), (set, Some(2))]);
    check(&query, &[Some(usize::MAX)], std::slice::from_ref(&(0..2)));
}

#[test]
fn an_excerpt_is_as_long_as_its_runs() {
    let clip = [1, 1, 2, 2, 2, 3, 1, 1, 1];
    for start in 0..=clip.len() {
        // Without a frame there is no segment.
        for end in start + 1..=clip.len() {
            let (before, rest) = clip.split_at(start);
            let (example, after) = rest.split_at(end - start);
            let query = Query::exact(example, u64::MAX).of_excerpt(before, after);
            let whole = segment(&clip).into_iter();
            let touched = whole.filter(|run| run.start < end && start < run.start + run.len);
            let expected: Vec<Option<usize>> = touched.map(|run| Some(run.len)).collect();
            let found: Vec<_> = query.positions().iter().map(|p| p.n_frames).collect();
            assert_eq!(found, expected, "{start} {end}");
        }
    }
}
