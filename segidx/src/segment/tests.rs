use super::*;

#[track_caller]
fn check(words: &[u64], expected: &[(u64, usize, usize)]) {
    let found: Vec<_> = segment(words)
        .iter()
        .map(|s| (s.word, s.start, s.len))
        .collect();
    assert_eq!(found, expected);
}

#[test]
fn no_frames_give_no_segments() {
    check(&[], &[]);
}

#[test]
fn one_frame_is_one_segment() {
    check(&[9], &[(9, 0, 1)]);
}

#[test]
fn equal_frames_are_one_segment() {
    check(&[4; 6], &[(4, 0, 6)]);
}

#[test]
fn a_word_may_return() {
    check(&[1, 1, 0, 1], &[(1, 0, 2), (0, 2, 1), (1, 3, 1)]);
}
