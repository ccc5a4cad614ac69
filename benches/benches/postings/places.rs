//! The places of sequences of words, from words, lists, and numbers of words.

use crate::Universe;
use crate::Visited;
use crate::segments::{Position, Segments, is_set};

pub(crate) fn scan_for(segments: &Segments, words: &[u64], visited: &mut Visited) {
    for (at, window) in segments.words.windows(words.len()).enumerate() {
        if window == words && !segments.is_first[at + 1..at + words.len()].contains(&true) {
            visited.add(at + words.len() - 1);
        }
    }
}

/// Lists of all words, moved by their positions, the shortest looked up in the others.
pub(crate) fn intersect(
    u: &Universe,
    words: &[u64],
    list: impl Fn(usize) -> Vec<u32>,
    visited: &mut Visited,
) {
    let mut lists: Vec<(u32, Vec<u32>)> = (0..)
        .zip(words)
        .map(|(at, word)| (at, list(u.segments.number(*word))))
        .collect();
    lists.sort_by_key(|(_, list)| list.len());
    let (pivot, shortest) = &lists[0];
    let mut places = vec![0; lists.len()];
    'segments: for segment in shortest {
        let Some(start) = segment.checked_sub(*pivot) else {
            continue;
        };
        for ((position, list), place) in lists.iter().zip(&mut places).skip(1) {
            *place = gallop(list, *place, start + position);
            if list.get(*place) != Some(&(start + position)) {
                continue 'segments;
            }
        }
        let end = start as usize + words.len();
        if !u.segments.is_first[start as usize + 1..end].contains(&true) {
            visited.add(end - 1);
        }
    }
}

/// The first place from `from` on whose number is at least `wanted`.
fn gallop(list: &[u32], from: usize, wanted: u32) -> usize {
    let mut step = 1;
    while list.get(from + step).is_some_and(|&number| number < wanted) {
        step *= 2;
    }
    let (low, high) = (from + step / 2, list.len().min(from + step + 1));
    low + list[low..high].partition_point(|&number| number < wanted)
}

/// As a shard is searched: the list of the rarest word, and the words around its segments.
pub(crate) fn from_rarest(u: &Universe, words: &[u64], visited: &mut Visited) {
    let numbers: Vec<usize> = words.iter().map(|&word| u.segments.number(word)).collect();
    let rarest = (0..words.len()).min_by_key(|&i| u.raw.list(numbers[i]).len());
    let rarest = rarest.expect("words");
    for segment in u.packed.list(numbers[rarest]) {
        let Some(start) = (segment as usize).checked_sub(rarest) else {
            continue;
        };
        let is_there = |(i, &number): (usize, &usize)| {
            start + i < u.segments.len() && {
                let (found, is_first) = u.numbers.entry(start + i);
                found == number && !(i > 0 && is_first)
            }
        };
        if numbers.iter().enumerate().all(is_there) {
            visited.add(start + words.len() - 1);
        }
    }
}

/// As anybody would: the runs of each document, and all sequences of them.
pub(crate) fn runs_in_words(segments: &Segments, positions: &[Position], visited: &mut Visited) {
    let care = positions[0].care;
    let mut runs: Vec<(u64, usize)> = Vec::new();
    let mut end_document = |runs: &mut Vec<(u64, usize)>| {
        for window in runs.windows(positions.len()) {
            let mut both = window.iter().zip(positions);
            if both.all(|((word, _), position)| position.holds(*word)) {
                visited.add(window[positions.len() - 1].1);
            }
        }
        runs.clear();
    };
    for (segment, &word) in segments.words.iter().enumerate() {
        if segments.is_first[segment] {
            end_document(&mut runs);
        }
        match runs.last_mut() {
            Some((last, end)) if *last == word & care => *end = segment + 1,
            _ => runs.push((word & care, segment + 1)),
        }
    }
    end_document(&mut runs);
}

/// As a shard is searched: a table of words for each position, and from each run of the first
/// position on as far as the others go.
pub(crate) fn runs_in_numbers(u: &Universe, positions: &[Position], visited: &mut Visited) {
    let n = u.segments.len();
    let members: Vec<_> = positions.iter().map(|p| u.segments.members(*p)).collect();
    let goes_on = |at: usize, members: &[u64]| {
        at < n && {
            let (number, is_first) = u.numbers.entry(at);
            !is_first && is_set(members, number)
        }
    };
    let mut is_inside = false;
    for segment in 0..n {
        let (number, is_first) = u.numbers.entry(segment);
        let is_held = is_set(&members[0], number);
        let is_start = is_held && (is_first || !is_inside);
        is_inside = is_held;
        if !is_start {
            continue;
        }
        let mut end = segment + 1;
        let is_hit = members.iter().enumerate().all(|(position, members)| {
            let is_there = position == 0 || goes_on(end, members);
            while goes_on(end, members) {
                end += 1;
            }
            is_there
        });
        if is_hit {
            visited.add(end);
        }
    }
}
