//! Nearest neighbours and best windows under banded warping.

use ndarray::{ArrayView2, Axis};

use crate::{BandRadius, DtwError, LocalCost, Sample, parallel};

mod best;
mod block;
mod bounds;
mod envelope;
mod groups;
mod margin;
mod normal;
mod query;
mod refine;
#[cfg(test)]
mod tests;
mod together;
mod windows;

use best::{Best, Found};
use bounds::Scratch;
use query::Query;
use refine::refine;

/// What is cheapest under warping with classic steps and closed ends in a Sakoe–Chiba band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    radius: BandRadius,
    local: LocalCost,
    normalisation: Normalisation,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Normalisation {
    AsGiven,
    ZScores,
}

/// A candidate and its cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Which of the candidates, from 0.
    pub index: usize,
    /// Warping cost of the query and the candidate, in units of the local cost.
    pub cost: f64,
}

/// A part of a series as long as the query, and its cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Its first frame in the series, from 0.
    pub start: usize,
    /// Warping cost of the query and the window, in units of the local cost.
    pub cost: f64,
}

impl Search {
    /// Within a band of `radius`, with Euclidean local costs, of sequences as they are given.
    pub fn new(radius: BandRadius) -> Self {
        Self {
            radius,
            local: LocalCost::default(),
            normalisation: Normalisation::AsGiven,
        }
    }

    /// The same with another local cost.
    #[must_use]
    pub fn with_local_cost(self, local: LocalCost) -> Self {
        Self { local, ..self }
    }

    /// The same for z-normalised sequences.
    #[must_use]
    pub fn z_normalised(self) -> Self {
        Self {
            normalisation: Normalisation::ZScores,
            ..self
        }
    }

    /// The `k` candidates of least cost.
    ///
    /// # Errors
    ///
    /// As [`crate::Dtw::distance`].
    pub fn nearest<T: Sample>(
        &self,
        query: ArrayView2<'_, T>,
        candidates: &[ArrayView2<'_, T>],
        k: usize,
    ) -> Result<Vec<Neighbour>, DtwError> {
        for candidate in candidates {
            check(query, *candidate)?;
        }
        let longest = candidates.iter().map(|frames| frames.nrows()).max();
        let Some(query) = Query::new(self, query, longest.unwrap_or(0)).filter(|_| k > 0) else {
            return Ok(Vec::new());
        };
        let indices: Vec<usize> = (0..candidates.len()).collect();
        let bounds = parallel::map(&indices, Scratch::default, |scratch, &index| {
            let frames = self.normalised(candidates[index]);
            let bound = query.bound_within(frames.view(), f64::INFINITY, scratch)?;
            Some((bound, index))
        });
        let mut bounds: Vec<Found> = bounds.into_iter().flatten().collect();
        bounds.sort_unstable_by(best::by_cost);
        let mut best = Best::new(k, 0);
        refine(&query, &bounds, &mut best, |_, index, _| {
            Some(self.normalised(candidates[index]))
        })?;
        let neighbour = |(cost, index)| Neighbour { index, cost };
        Ok(best.into_chosen().into_iter().map(neighbour).collect())
    }

    /// The `k` best windows of `series` that are as long as `query`.
    ///
    /// # Errors
    ///
    /// As [`crate::Dtw::distance`].
    pub fn best_windows<T: Sample>(
        &self,
        query: ArrayView2<'_, T>,
        series: ArrayView2<'_, T>,
        k: usize,
        exclusion: usize,
    ) -> Result<Vec<Window>, DtwError> {
        check(query, series)?;
        let n = query.nrows();
        let query = Query::new(self, query, n).filter(|_| k > 0 && n <= series.nrows());
        let Some(query) = query else {
            return Ok(Vec::new());
        };
        let found = windows::best_windows(&query, series, Best::new(k, exclusion))?;
        let window = |(cost, start)| Window { start, cost };
        Ok(found.into_iter().map(window).collect())
    }

    fn is_z_normalised(&self) -> bool {
        self.normalisation == Normalisation::ZScores
    }
}

fn check<T>(a: ArrayView2<'_, T>, b: ArrayView2<'_, T>) -> Result<(), DtwError> {
    let (a, b) = (a.len_of(Axis(1)), b.len_of(Axis(1)));
    if a == b {
        Ok(())
    } else {
        Err(DtwError::Dimensions { a, b })
    }
}
