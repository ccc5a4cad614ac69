//! From a curve to matches: minima first, each with a zone around it that yields no other.

use std::ops::Range;

use crate::{DistanceCurve, QuantizedTemplate};

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

/// Length of a zone as a share of a match's length, rounded up.
const LESSER_SHARE: f64 = 0.1;
const GREATER_SHARE: f64 = 0.5;

/// Starts that yield no second match, and the length of the match that claimed them.
struct Claim {
    starts: Range<usize>,
    length: usize,
}

/// Matches in order of (cost, end).
///
/// The cheapest end is taken, the earliest among equals. Its match is kept unless it starts where an
/// earlier one has claimed the starts; a kept match of `n` frames claims those from 0.1 n before its
/// own to 0.5 n after it. In both cases ends from 0.5 n before this one to 0.1 n after it are
/// closed, with `n` of the match that has claimed the start.
pub(crate) fn find(
    template: &QuantizedTemplate,
    words: &[u64],
    curve: &DistanceCurve,
    config: &MatchConfig,
) -> Vec<Match> {
    let mut ends: Vec<(f64, usize)> = curve
        .costs()
        .enumerate()
        .filter_map(|(end, cost)| Some((cost.filter(|cost| *cost <= config.tau)?, end)))
        .collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut closed = vec![false; curve.len()];
    let mut claims: Vec<Claim> = Vec::new();
    let mut found = Vec::new();
    for (cost, last) in ends {
        if found.len() == config.max_matches {
            break;
        }
        if closed[last] {
            continue;
        }
        let Some(start) = template.start_of(words, last) else {
            continue;
        };
        let claimed = claims.iter().rev().find(|c| c.starts.contains(&start));
        let length = match claimed {
            Some(claim) => claim.length,
            None => {
                let length = last + 1 - start;
                claims.push(Claim {
                    starts: zone(start, length, LESSER_SHARE, GREATER_SHARE),
                    length,
                });
                found.push(Match {
                    span: start..last + 1,
                    cost,
                });
                length
            }
        };
        let blank = zone(last, length, GREATER_SHARE, LESSER_SHARE);
        closed[blank.start..blank.end.min(curve.len())].fill(true);
    }
    found
}

fn zone(around: usize, length: usize, before: f64, after: f64) -> Range<usize> {
    let share = |share: f64| (share * length as f64).ceil() as usize;
    around.saturating_sub(share(before))..around + share(after) + 1
}
