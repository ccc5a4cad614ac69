//! How many frames of bundles are in the matching bundles of another partition of the same frames.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use bundles::{Bundle, BundleGraph, Submotion};

/// The bundle of each of `n_frames` frames.
pub(crate) fn owners(graph: &BundleGraph, n_frames: usize) -> Vec<Option<usize>> {
    let mut owners = vec![None; n_frames];
    for (bundle, submotions) in graph.bundles().iter().map(|b| &b.submotions).enumerate() {
        for submotion in submotions {
            owners[submotion.span.clone()].fill(Some(bundle));
        }
    }
    owners
}

/// Whether a bundle is in two clips, or away in between for more than half of its mean length. Where poses
/// change slowly, what follows at once is similar to what was before.
fn comes_back(bundle: &Bundle) -> bool {
    let pairs = bundle.submotions.windows(2);
    let mut pairs = pairs.filter_map(|pair| <&[Submotion; 2]>::try_from(pair).ok());
    pairs.any(|[before, after]| {
        let away = after.span.start.saturating_sub(before.span.end);
        before.clip != after.clip || away as f64 > 0.5 * bundle.mean_frames()
    })
}

/// Of `owners`, the bundles that come back.
pub(crate) fn returning(graph: &BundleGraph, owners: &[Option<usize>]) -> Vec<Option<usize>> {
    let come_back: Vec<bool> = graph.bundles().iter().map(comes_back).collect();
    let owners = owners.iter().copied();
    owners
        .map(|owner| owner.filter(|&bundle| come_back[bundle]))
        .collect()
}

/// Of all submotions of a bundle.
pub(crate) fn frames(graph: &BundleGraph, bundle: usize) -> usize {
    let submotions = graph.bundles()[bundle].submotions.iter();
    submotions.map(|submotion| submotion.span.len()).sum()
}

/// Shares of the frames that are in bundles before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kept {
    /// In the matching bundle, each bundle matching at most one: pairs are taken by descending number of
    /// common frames, ties to the smaller pair, where neither is taken yet.
    pub(crate) matching: f64,
    /// In that bundle which has most of their own bundle's frames, whatever else it has.
    pub(crate) likeliest: f64,
    /// In any bundle.
    pub(crate) any: f64,
}

/// Common frames of each pair of bundles that have some, most first, ties to the smaller pair.
fn common(before: &[Option<usize>], after: &[Option<usize>]) -> Vec<((usize, usize), usize)> {
    let mut common: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for pair in before.iter().zip(after) {
        if let (Some(old), Some(new)) = pair {
            *common.entry((*old, *new)).or_default() += 1;
        }
    }
    let mut pairs: Vec<_> = common.into_iter().collect();
    pairs.sort_by_key(|&(pair, n)| (Reverse(n), pair));
    pairs
}

/// The bundle that each one of `before` matches, and their common frames; see [`Kept::matching`].
pub(crate) fn matches(
    before: &[Option<usize>],
    after: &[Option<usize>],
) -> BTreeMap<usize, (usize, usize)> {
    let (mut matches, mut taken) = (BTreeMap::new(), BTreeSet::new());
    for ((old, new), n) in common(before, after) {
        if !matches.contains_key(&old) && taken.insert(new) {
            matches.insert(old, (new, n));
        }
    }
    matches
}

/// What is kept of `before` in `after`; nothing of nothing.
pub(crate) fn kept(before: &[Option<usize>], after: &[Option<usize>]) -> Kept {
    let (mut met, mut likeliest, mut any) = (BTreeSet::new(), 0, 0);
    for ((old, _), n) in common(before, after) {
        any += n;
        if met.insert(old) {
            likeliest += n;
        }
    }
    let matching: usize = matches(before, after).values().map(|(_, n)| n).sum();
    let all = before.iter().flatten().count().max(1) as f64;
    Kept {
        matching: matching as f64 / all,
        likeliest: likeliest as f64 / all,
        any: any as f64 / all,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn owned(text: &str) -> Vec<Option<usize>> {
        let owner = |c: char| c.to_digit(10).map(|digit| digit as usize);
        text.chars().map(owner).collect()
    }

    #[test]
    fn what_follows_at_once_is_not_what_comes_back() {
        let bundle = |submotions: &[(usize, std::ops::Range<usize>)]| Bundle {
            submotions: submotions
                .iter()
                .cloned()
                .map(|(clip, span)| Submotion { clip, span })
                .collect(),
            volume: 0.0,
        };
        assert!(!comes_back(&bundle(&[
            (0, 0..10),
            (0, 10..20),
            (0, 25..35)
        ])));
        assert!(comes_back(&bundle(&[(0, 0..10), (0, 10..20), (0, 26..36)])));
        assert!(comes_back(&bundle(&[(0, 0..10), (1, 10..20)])));
    }

    #[test]
    fn frames_are_kept_by_the_largest_pairs() {
        let shares = |before: &str, after: &str| {
            let kept = kept(&owned(before), &owned(after));
            [kept.matching, kept.likeliest, kept.any].map(|share| (share * 10.0).round())
        };
        // New numbers, the same bundles.
        assert_eq!(shares("0000011111", "7777733333"), [10.0; 3]);
        // Both in one: only one of them matches it.
        assert_eq!(shares("0000001111", "5555555555"), [6.0, 10.0, 10.0]);
        // One of them falls apart, and a frame is in no bundle.
        assert_eq!(shares("0000011111", "111224444-"), [7.0, 7.0, 9.0]);
        // What is in no bundle before does not count.
        assert_eq!(shares("00000-----", "1111111111"), [10.0; 3]);
        assert_eq!(shares("----------", "1111111111"), [0.0; 3]);
    }
}
