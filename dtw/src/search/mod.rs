//! Nearest neighbours and best windows under banded warping.
//!
//! A window passes a cascade of lower bounds of its cost, each dearer and mostly greater than the
//! one before, and is left once one of them is above the k-th best cost so far:
//!
//! 1. for windows that start side by side, one to a lane: the cheapest pairs at both ends
//!    (`groups`), on means and deviations that are off by a known bound (`block`);
//! 2. in the same way, the distance of the other frames from the query's envelope, those first that
//!    promise most, until all windows of a group are out;
//! 3. in ascending order of that, on the window as defined: the query's distance from the window's
//!    envelope, and from that of the window's projection onto the query's envelope (`bounds`);
//! 4. the warping itself, several windows at once, given up with the frames to come (`together`).
//!
//! Only what is left has its cost computed by [`crate::Dtw`]. All bounds are sums in `f64`; how far
//! rounding may take that cost below them is subtracted (`margin`).

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
///
/// Results are those of comparing the query with every candidate by
/// `Dtw::new(radius).with_local_cost(local).distance(query, candidate)`, to the last bit and on any
/// number of threads. A candidate without a path is left out: one with a frame that holds no
/// finite number, or whose length differs from the query's by more than the band's radius.
///
/// # Source
///
/// The cascade is that of Rakthanmanon et al., *Searching and mining trillions of time series
/// subsequences under dynamic time warping* (2012, sect. 4), from bounds by Kim, Park and Chu
/// (*An index-based approach for similarity search supporting time warping*, 2001), by Keogh and
/// Ratanamahatana (*Exact indexing of dynamic time warping*, 2005) and by Lemire (*Faster retrieval
/// with a two-pass dynamic-time-warping lower bound*, 2009). It differs in these points:
///
/// - windows are compared side by side, and the best promises first instead of in order of starts;
/// - Kim's and Keogh's bounds are added, over different frames, instead of used in turn;
/// - with several dimensions, the deviations from the envelopes in each are combined by the local
///   cost. Lemire's bound is left out for [`LocalCost::Euclidean`] in more than one dimension,
///   where it does not hold;
/// - [`LocalCost::Cosine`] bounds half the squared distance of the frames' directions. For
///   z-normalised windows that starts with the third step of the cascade, on every window.
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

    /// The same for z-normalised sequences: query, and each candidate or window, become
    /// (x - mean) / deviation in each dimension, with the population standard deviation. Both are
    /// computed in `f64`, in order of frames, in two passes. A dimension becomes zeros where all
    /// its samples are equal, without tolerance, or where the squares of its deviations are too
    /// small for `f64`.
    #[must_use]
    pub fn z_normalised(self) -> Self {
        Self {
            normalisation: Normalisation::ZScores,
            ..self
        }
    }

    /// The `k` candidates of least cost, sorted by cost and then by index; fewer if fewer have a
    /// path.
    ///
    /// ```
    /// use dtw::ndarray::array;
    /// use dtw::{BandRadius, Search};
    ///
    /// let query = array![[0.0], [1.0], [0.0]];
    /// let candidates = [array![[5.0], [5.0], [5.0]], array![[0.0], [1.0], [1.0]]];
    /// let views = candidates.each_ref().map(|frames| frames.view());
    /// let found = Search::new(BandRadius::cells(1)).nearest(query.view(), &views, 1)?;
    /// assert_eq!((found[0].index, found[0].cost), (1, 1.0));
    /// # Ok::<(), dtw::DtwError>(())
    /// ```
    ///
    /// A candidate of m frames takes O(m log r) time for its bounds, r being the band's radius,
    /// and if they do not suffice O(m r) local costs.
    ///
    /// # Errors
    ///
    /// [`DtwError::Dimensions`] when a candidate's dimensions are not the query's,
    /// [`DtwError::TooLarge`] as [`crate::Dtw::distance`].
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

    /// The `k` best windows of `series` that are as long as `query`, whose starts are at least
    /// `exclusion` frames apart: the cheapest, then the cheapest of those that are not too near to
    /// it, and so on. Of equal costs the earlier start is taken first. 0 and 1 exclude nothing.
    ///
    /// ```
    /// use dtw::ndarray::array;
    /// use dtw::{BandRadius, Search};
    ///
    /// let series = array![[9.0], [0.0], [1.0], [9.0], [10.0], [12.0], [9.0]];
    /// let query = array![[0.0], [1.0]];
    /// let search = Search::new(BandRadius::cells(0));
    /// let found = search.best_windows(query.view(), series.view(), 2, 2)?;
    /// assert_eq!((found[0].start, found[0].cost), (1, 0.0));
    /// assert_eq!((found[1].start, found[1].cost), (3, 18.0));
    /// let normalised = search.z_normalised().best_windows(query.view(), series.view(), 2, 2)?;
    /// assert_eq!((normalised[1].start, normalised[1].cost), (3, 0.0));
    /// # Ok::<(), dtw::DtwError>(())
    /// ```
    ///
    /// With N frames in `series`, n in `query` and a band of radius r, the first bound of all
    /// windows takes O(N log n) time; what it leaves takes O(n), O(n log r) and O(n r), and should
    /// be less from step to step. Memory is O(N + n): some six numbers for each window, three of them
    /// for each dimension.
    ///
    /// # Errors
    ///
    /// As [`Self::nearest`].
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
