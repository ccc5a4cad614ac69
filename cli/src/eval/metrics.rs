//! Measures of retrieval: hits at a threshold, ranked clips, separation, confusion.
//!
//! Responses and relevance go by test clip, in the order of the trial; ties are broken by
//! that order.

use serde::{Serialize, Serializer};

use super::hits::Response;

/// The thresholds τ of the 2006 paper's Table 2.
pub const TAUS: [f64; 6] = [0.01, 0.02, 0.04, 0.06, 0.08, 0.1];

/// The ranks up to which Table 4 counts correct hits.
pub const TOPS: [usize; 3] = [5, 10, 20];

/// Hits of a class at a threshold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HitCounts {
    /// The threshold τ: the largest cost of a hit.
    pub tau: f64,
    /// Hits, |H|.
    pub hits: usize,
    /// Relevant test clips that have a hit, |H⁺|: several hits of one clip count once.
    pub relevant_hits: usize,
    /// |H⁺| / |H|; `None` without hits.
    pub precision: Option<f64>,
    /// |H⁺| over the relevant test clips; `None` if there are none.
    pub recall: Option<f64>,
}

/// Counts hits that cost at most `tau`.
#[must_use]
pub fn count_hits(responses: &[Response], relevant: &[bool], tau: f64) -> HitCounts {
    let within = |response: &Response| response.hits.partition_point(|hit| hit.cost <= tau);
    let hits: usize = responses.iter().map(within).sum();
    let found = responses.iter().zip(relevant);
    let found = found.filter(|(response, is_relevant)| **is_relevant && within(response) > 0);
    let relevant_hits = found.count();
    let n_relevant = relevant.iter().filter(|r| **r).count();
    HitCounts {
        tau,
        hits,
        relevant_hits,
        precision: share(relevant_hits, hits),
        recall: share(relevant_hits, n_relevant),
    }
}

fn share(part: usize, of: usize) -> Option<f64> {
    (of > 0).then(|| part as f64 / of as f64)
}

/// Average precision of the test clips ranked by their best cost.
///
/// The mean over relevant clips of the precision at their rank: of the clips down to this one, the share
/// that are relevant. A clip that cannot be aligned with the query has no rank; a relevant one counts
/// with precision 0. `None` if no clip is relevant.
#[must_use]
pub fn average_precision(responses: &[Response], relevant: &[bool]) -> Option<f64> {
    let best = responses.iter().zip(relevant).enumerate();
    let mut ranked: Vec<(f64, usize, bool)> = best
        .filter_map(|(clip, (response, &relevant))| Some((response.best()?, clip, relevant)))
        .collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut n_found = 0;
    let mut sum = 0.0;
    for (rank, (_, _, is_relevant)) in ranked.iter().enumerate() {
        if *is_relevant {
            n_found += 1;
            sum += f64::from(n_found) / (rank + 1) as f64;
        }
    }
    let n_relevant = relevant.iter().filter(|r| **r).count();
    (n_relevant > 0).then(|| sum / n_relevant as f64)
}

/// The clip and the cost of each hit of all clips, in order of (cost, clip, end).
fn ranked_hits(responses: &[Response]) -> Vec<(usize, f64)> {
    let by_clip = responses.iter().enumerate();
    let mut hits: Vec<(usize, f64)> = by_clip
        .flat_map(|(clip, response)| response.hits.iter().map(move |hit| (clip, hit.cost)))
        .collect();
    // Stable: the hits of a clip come in order of (cost, end), the clips in theirs.
    hits.sort_by(|a, b| a.1.total_cmp(&b.1));
    hits
}

/// How many relevant clips are among the best `n` hits of all clips, in order of (cost, clip, end).
/// Several hits of one clip count once.
#[must_use]
pub fn relevant_in_top(responses: &[Response], relevant: &[bool], n: usize) -> usize {
    let mut clips: Vec<usize> = ranked_hits(responses)
        .into_iter()
        .take(n)
        .map(|(clip, _)| clip)
        .filter(|clip| relevant[*clip])
        .collect();
    clips.sort_unstable();
    clips.dedup();
    clips.len()
}

/// How far Δ is from the cost of what is sought (section 5.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Separation {
    /// The median of Δ over the median cost of correct hits among the best ten.
    Quotient(f64),
    /// The correct hits cost nothing.
    Infinite,
    /// There is no correct hit among the best ten.
    Undefined,
}

impl Separation {
    /// For comparing: infinite as such, undefined as `None`.
    #[must_use]
    pub fn value(self) -> Option<f64> {
        match self {
            Separation::Quotient(quotient) => Some(quotient),
            Separation::Infinite => Some(f64::INFINITY),
            Separation::Undefined => None,
        }
    }
}

/// A number, `"inf"`, or null where it is undefined.
impl Serialize for Separation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Separation::Quotient(quotient) => serializer.serialize_f64(*quotient),
            Separation::Infinite => serializer.serialize_str("inf"),
            Separation::Undefined => serializer.serialize_none(),
        }
    }
}

/// Hits among which correct ones are sought for the separation quotient.
const SEPARATION_TOP: usize = 10;

/// The median of all finite values of Δ over the median cost of the correct hits among the best ten.
#[must_use]
pub fn separation(responses: &[Response], relevant: &[bool]) -> Separation {
    let mut costs: Vec<f64> = responses.iter().flat_map(|r| &r.costs).copied().collect();
    let mut correct: Vec<f64> = ranked_hits(responses)
        .into_iter()
        .take(SEPARATION_TOP)
        .filter(|(clip, _)| relevant[*clip])
        .map(|(_, cost)| cost)
        .collect();
    match (median(&mut costs), median(&mut correct)) {
        (Some(_), Some(0.0)) => Separation::Infinite,
        (Some(all), Some(correct)) => Separation::Quotient(all / correct),
        _ => Separation::Undefined,
    }
}

/// The mean of the two in the middle if the values are even in number; `None` of none.
fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        n if n % 2 == 1 => Some(values[middle]),
        _ => Some((values[middle - 1] + values[middle]) / 2.0),
    }
}

/// The class whose template a clip answers best, 0-based.
///
/// `costs` has the clip's best cost for each class, where it has one, over the class's threshold; of
/// equals the first class. `None` if it has none.
#[must_use]
pub fn classify(costs: &[Option<f64>]) -> Option<usize> {
    let known = costs.iter().enumerate();
    let known = known.filter_map(|(class, cost)| Some((class, (*cost)?)));
    // `min_by` keeps the first of equals.
    known
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(class, _)| class)
}

#[cfg(test)]
mod tests;
