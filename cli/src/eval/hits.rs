//! How a clip answers a query, whatever the query is made of.

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
        let all = MatchConfig {
            tau: f64::INFINITY,
            max_matches: usize::MAX,
        };
        Response {
            costs: curve.iter().copied().flatten().collect(),
            hits: select_matches(curve.iter().copied(), start, &all),
        }
    }
}

#[cfg(test)]
mod tests;
