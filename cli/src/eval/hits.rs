//! How a clip answers a query, whatever the query is made of.

use std::ops::Range;

use mtemplate::Match;

/// How a clip answers a query.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Response {
    /// Finite values of Δ, in order of frames.
    pub costs: Vec<f64>,
    /// All hits, however costly, in order of (cost, end).
    pub hits: Vec<Match>,
}

impl Response {
    /// The least cost; `None` if no stretch of the clip can be aligned with the query.
    #[must_use]
    pub fn best(&self) -> Option<f64> {
        self.hits.first().map(|hit| hit.cost)
    }

    /// The response of a clip whose Δ is `curve`; `start` is the first frame of the cheapest stretch that
    /// ends with a frame.
    ///
    /// Hits are chosen by the rule of [`mtemplate::QuantizedTemplate::find_matches`], which knows
    /// templates only.
    #[must_use]
    pub fn of_curve(curve: &[Option<f64>], start: impl Fn(usize) -> Option<usize>) -> Response {
        let finite = curve
            .iter()
            .enumerate()
            .filter_map(|(end, cost)| Some(((*cost)?, end)));
        let mut ends: Vec<(f64, usize)> = finite.collect();
        let costs = ends.iter().map(|(cost, _)| *cost).collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut closed = vec![false; curve.len()];
        let mut claims: Vec<(Range<usize>, usize)> = Vec::new();
        let mut hits = Vec::new();
        for (cost, last) in ends {
            let Some(start) = (!closed[last]).then(|| start(last)).flatten() else {
                continue;
            };
            let claimed = claims.iter().rev().find(|(zone, _)| zone.contains(&start));
            let length = claimed.map(|(_, length)| *length).unwrap_or_else(|| {
                let length = last + 1 - start;
                claims.push((zone(start, length, [SHORT, LONG]), length));
                let span = start..last + 1;
                hits.push(Match { span, cost });
                length
            });
            let blank = zone(last, length, [LONG, SHORT]);
            closed[blank.start..blank.end.min(curve.len())].fill(true);
        }
        Response { costs, hits }
    }
}

/// Reach of a zone as a share of the hit's length, rounded up (spec.md d).
const SHORT: f64 = 0.1;
const LONG: f64 = 0.5;

fn zone(around: usize, length: usize, [before, after]: [f64; 2]) -> Range<usize> {
    let share = |share: f64| (share * length as f64).ceil() as usize;
    around.saturating_sub(share(before))..around + share(after) + 1
}

#[cfg(test)]
mod tests;
