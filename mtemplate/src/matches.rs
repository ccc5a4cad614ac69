//! From a curve to matches: minima first, each with a zone around it that yields no other.

use std::ops::Range;

/// A stretch of a clip that fits a template.
#[derive(Debug, Clone, PartialEq)]
pub struct Match {
    /// Its frames.
    pub span: Range<usize>,
    /// Its cost.
    pub cost: f64,
}

/// Which matches are wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatchConfig {
    /// Quality threshold τ: the largest cost of a match.
    pub tau: f64,
    /// The most matches of a clip, the best ones.
    pub max_matches: usize,
}

impl MatchConfig {
    /// Matches up to `tau`, at most 500 (spec.md d).
    pub fn up_to(tau: f64) -> Self {
        Self {
            tau,
            max_matches: 500,
        }
    }
}

/// Starts that yield no second match, and the length of the match that claimed them.
#[derive(Debug, Clone)]
pub(crate) struct Claim {
    pub(crate) starts: Range<usize>,
    pub(crate) length: usize,
}

impl Claim {
    pub(crate) fn of(span: &Range<usize>) -> Self {
        let length = span.len();
        Self {
            starts: span.start.saturating_sub(lesser(length))..span.start + greater(length) + 1,
            length,
        }
    }
}

/// Ends around `last` that yield no match, `length` being that of the match which claimed its start.
pub(crate) fn closed(last: usize, length: usize) -> Range<usize> {
    last.saturating_sub(greater(length))..last + lesser(length) + 1
}

/// ⌈0.1 n⌉
pub(crate) fn lesser(length: usize) -> usize {
    length.div_ceil(10)
}

/// ⌈0.5 n⌉
pub(crate) fn greater(length: usize) -> usize {
    length.div_ceil(2)
}

/// The matches of any curve: `costs` has the least cost of a stretch that ends with each frame, and
/// `start_of` tells the first frame of the one that ends with a frame of finite cost.
///
/// The rule is that of [`QuantizedTemplate::find_matches`](crate::QuantizedTemplate::find_matches).
/// O(L log L) time for L costs, and a call of `start_of` for each end that is not closed.
pub fn select_matches(
    costs: impl ExactSizeIterator<Item = Option<f64>>,
    start_of: impl Fn(usize) -> Option<usize>,
    config: &MatchConfig,
) -> Vec<Match> {
    let mut is_closed = vec![false; costs.len()];
    let mut ends: Vec<(f64, usize)> = costs
        .enumerate()
        .filter_map(|(end, cost)| Some((cost.filter(|cost| *cost <= config.tau)?, end)))
        .collect();
    ends.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut claims: Vec<Claim> = Vec::new();
    let mut found = Vec::new();
    for (cost, last) in ends {
        if found.len() == config.max_matches {
            break;
        }
        if is_closed[last] {
            continue;
        }
        let Some(start) = start_of(last) else {
            continue;
        };
        let claimed = claims
            .iter()
            .rev()
            .find(|claim| claim.starts.contains(&start));
        let length = claimed.map(|claim| claim.length).unwrap_or_else(|| {
            let span = start..last + 1;
            claims.push(Claim::of(&span));
            let length = span.len();
            found.push(Match { span, cost });
            length
        });
        let closed = closed(last, length);
        let n_frames = is_closed.len();
        is_closed[closed.start..closed.end.min(n_frames)].fill(true);
    }
    found
}
