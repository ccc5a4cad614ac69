//! Textbook twins of the fast routines, from the definitions alone: sets are sets of words, nothing is indexed.

use std::collections::BTreeSet;

pub(crate) type Set = BTreeSet<u64>;

/// First and last segment of one position of a hit, both inclusive, in the document.
pub(crate) type Run = (usize, usize);

/// A hit as `(cost, document, frame ranges)`; sorted, this is the order of results, since a document and a first
/// frame belong to one hit.
pub(crate) type NaiveHit = (u64, usize, Vec<(usize, usize)>);

/// The words below 2^bits that agree with `value` on `care`.
pub(crate) fn set_of_mask(care: u64, value: u64, bits: u32) -> Set {
    (0..1u64 << bits)
        .filter(|word| {
            (0..bits).all(|bit| care >> bit & 1 == 0 || word >> bit & 1 == value >> bit & 1)
        })
        .collect()
}

/// `(word, first frame, last frame)` of every interval of equal words that cannot be made longer.
pub(crate) fn segments(words: &[u64]) -> Vec<(u64, usize, usize)> {
    let mut found = Vec::new();
    for first in 0..words.len() {
        for last in first..words.len() {
            let set = Set::from([words[first]]);
            if is_run(words, &set, first, last) {
                found.push((words[first], first, last));
            }
        }
    }
    found
}

/// Whether `first..=last` is an interval of words in `set` that cannot be made longer.
fn is_run(words: &[u64], set: &Set, first: usize, last: usize) -> bool {
    words[first..=last].iter().all(|word| set.contains(word))
        && (first == 0 || !set.contains(&words[first - 1]))
        && (last + 1 == words.len() || !set.contains(&words[last + 1]))
}

/// Eq. 9 and 10: all k with w_k in V_1, w_{k+1} in V_2, and so on.
pub(crate) fn exact(segment_words: &[u64], sets: &[Set]) -> Vec<Vec<Run>> {
    let mut found = Vec::new();
    for k in 0..segment_words.len() {
        let runs: Vec<Run> = (0..sets.len()).map(|l| (k + l, k + l)).collect();
        let holds = |l: usize| {
            let word = segment_words.get(k + l);
            word.is_some_and(|word| sets[l].contains(word))
        };
        if !sets.is_empty() && (0..sets.len()).all(holds) {
            found.push(runs);
        }
    }
    found
}

/// Spec j.1: all sequences of runs of V_1, V_2, ... in which each begins where the one before has ended.
pub(crate) fn adaptive(segment_words: &[u64], sets: &[Set]) -> Vec<Vec<Run>> {
    let Some((set, rest)) = sets.split_last() else {
        return Vec::new();
    };
    let n = segment_words.len();
    let mut last_runs = Vec::new();
    for first in 0..n {
        for last in first..n {
            if is_run(segment_words, set, first, last) {
                last_runs.push((first, last));
            }
        }
    }
    if rest.is_empty() {
        return last_runs.into_iter().map(|run| vec![run]).collect();
    }
    let mut found = Vec::new();
    for head in adaptive(segment_words, rest) {
        for &run in &last_runs {
            if head.last().is_some_and(|&(_, last)| last + 1 == run.0) {
                found.push([&head[..], &[run]].concat());
            }
        }
    }
    found
}

/// Unites an adjacent intersecting pair of `(set, frames)`, chosen by `pick` among those there are, until none is
/// left.
pub(crate) fn conjoin(
    mut sets: Vec<(Set, usize)>,
    mut pick: impl FnMut(usize) -> usize,
) -> Vec<(Set, usize)> {
    loop {
        let touching: Vec<usize> = (1..sets.len())
            .filter(|&i| !sets[i - 1].0.is_disjoint(&sets[i].0))
            .collect();
        if touching.is_empty() {
            return sets;
        }
        let i = touching[pick(touching.len()) % touching.len()];
        let (set, frames) = sets.remove(i);
        sets[i - 1].0.extend(set);
        sets[i - 1].1 += frames;
    }
}

/// All hits of all documents, ranked by Σ |query frames − hit frames|.
pub(crate) fn search(
    documents: &[Vec<u64>],
    query: &[(Set, usize)],
    hits_of: fn(&[u64], &[Set]) -> Vec<Vec<Run>>,
) -> Vec<NaiveHit> {
    let sets: Vec<Set> = query.iter().map(|(set, _)| set.clone()).collect();
    let mut hits = Vec::new();
    for (doc, words) in documents.iter().enumerate() {
        let segments = segments(words);
        let segment_words: Vec<u64> = segments.iter().map(|segment| segment.0).collect();
        for runs in hits_of(&segment_words, &sets) {
            let mut cost = 0;
            let mut ranges = Vec::new();
            for (&(first, last), (_, frames)) in runs.iter().zip(query) {
                let (start, end) = (segments[first].1, segments[last].2 + 1);
                cost += frames.abs_diff(end - start) as u64;
                ranges.push((start, end));
            }
            hits.push((cost, doc, ranges));
        }
    }
    hits.sort();
    hits
}

/// All chains of frames of one document, each with a word in its set and as far from the one before as its gap says.
pub(crate) fn chains(words: &[u64], sets: &[Set], gaps: &[(usize, usize)]) -> Vec<Vec<usize>> {
    let mut chains: Vec<Vec<usize>> = vec![Vec::new()];
    for (i, set) in sets.iter().enumerate() {
        let mut longer = Vec::new();
        for chain in &chains {
            for (frame, word) in words.iter().enumerate() {
                let is_near = chain.last().is_none_or(|&last| {
                    frame >= last && (gaps[i - 1].0..=gaps[i - 1].1).contains(&(frame - last))
                });
                if is_near && set.contains(word) {
                    longer.push([chain.as_slice(), &[frame]].concat());
                }
            }
        }
        chains = longer;
    }
    chains
}

/// The longest intervals of frames that chains begin with, and the earliest and the latest end of chains from there.
pub(crate) fn chain_hits(chains: &[Vec<usize>]) -> Vec<(Run, Run)> {
    let firsts: BTreeSet<usize> = chains.iter().map(|chain| chain[0]).collect();
    let starts = firsts
        .iter()
        .filter(|&&f| f == 0 || !firsts.contains(&(f - 1)));
    let hit = |&first: &usize| {
        let end = (first..).find(|frame| !firsts.contains(frame)).unwrap();
        let from_here = chains
            .iter()
            .filter(|chain| (first..end).contains(&chain[0]));
        let lasts: Vec<usize> = from_here.map(|chain| *chain.last().unwrap()).collect();
        let (earliest, latest) = (lasts.iter().min().unwrap(), lasts.iter().max().unwrap());
        ((first, end - 1), (*earliest, *latest))
    };
    starts.map(hit).collect()
}

/// First and last frame by the rule of 2006: the last frame of a segment of the first set, then the next frame for each
/// other set that is the first of a segment. A frame begins a segment if a bit of the set's segmentation changes there.
pub(crate) fn greedy_chains(
    words: &[u64],
    sets: &[Set],
    bits: &[u64],
    max_frames: usize,
) -> Vec<Run> {
    let is_in = |set: usize, frame: usize| sets[set].contains(&words[frame]);
    let begins = |set: usize, frame: usize| {
        frame == 0 || frame == words.len() || (words[frame] ^ words[frame - 1]) & bits[set] != 0
    };
    let mut found = Vec::new();
    for first in (0..words.len()).filter(|&f| is_in(0, f) && begins(0, f + 1)) {
        let mut frame = Some(first);
        for set in 1..sets.len() {
            let next = |f: &usize| is_in(set, *f) && begins(set, *f);
            frame = frame.and_then(|from| (from..words.len()).find(next));
        }
        if let Some(last) = frame
            && last + 1 - first <= max_frames
        {
            found.push((first, last));
        }
    }
    found
}
