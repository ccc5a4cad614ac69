//! How a clip answers a query, whatever the query is made of.

use std::cmp::Reverse;
use std::ops::Range;

use mtemplate::{Match, MatchConfig, select_matches};

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
    /// Hits are those of [`select_matches`].
    #[must_use]
    pub fn of_curve(curve: &[Option<f64>], start: impl Fn(usize) -> Option<usize>) -> Response {
        Response {
            costs: curve.iter().copied().flatten().collect(),
            hits: select_matches(curve.iter().copied(), start, &ALL),
        }
    }

    /// The responses of clips of these lengths, one after another in one stream whose Δ is `curve`.
    ///
    /// Hits are those of the stream, as [`Self::of_curve`]; each is one of the clip that has most of its frames,
    /// of the earlier one of equals, and its span is what of it lies in that clip.
    #[must_use]
    pub fn divided(
        curve: &[Option<f64>],
        start: impl Fn(usize) -> Option<usize>,
        lengths: impl Iterator<Item = usize>,
    ) -> Vec<Response> {
        let mut clips: Vec<Range<usize>> = Vec::new();
        for length in lengths {
            let from = clips.last().map_or(0, |clip| clip.end);
            clips.push(from..from + length);
        }
        let of_clip = |clip: &Range<usize>| Response {
            costs: curve
                .iter()
                .take(clip.end)
                .skip(clip.start)
                .flatten()
                .copied()
                .collect(),
            hits: Vec::new(),
        };
        let mut responses: Vec<Response> = clips.iter().map(of_clip).collect();
        for hit in select_matches(curve.iter().copied(), start, &ALL) {
            let first = clips.partition_point(|clip| clip.end <= hit.span.start);
            let touched = (first..clips.len()).take_while(|&k| clips[k].start < hit.span.end);
            let common =
                |k: usize| hit.span.start.max(clips[k].start)..hit.span.end.min(clips[k].end);
            let Some(most) = touched.max_by_key(|&k| (common(k).len(), Reverse(k))) else {
                continue;
            };
            let span = common(most);
            let from = clips[most].start;
            responses[most].hits.push(Match {
                span: span.start - from..span.end - from,
                ..hit
            });
        }
        responses
    }
}

/// Every hit there is.
const ALL: MatchConfig = MatchConfig {
    tau: f64::INFINITY,
    max_matches: usize::MAX,
};

#[cfg(test)]
mod tests;
