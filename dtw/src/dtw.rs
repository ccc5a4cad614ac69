use ndarray::ArrayView2;
use pulp::{Arch, Simd, WithSimd};

use crate::costs::{Called, Costs, Pair};
use crate::engine::{Classic, Engine, Found, General, Grid, trace};
use crate::{Band, DtwError, Ends, LocalCost, Missing, Sample, StepPattern, WarpingPath};

/// Bytes for the steps of a path, when nothing else is said.
const PATH_MEMORY: u64 = 1 << 28;

/// Dynamic time warping: which pairs of frames a path may use, what they cost, how it moves.
///
/// Of equally cheap paths the one chosen is fixed: seen from its end, it goes back by the earliest
/// step of the [`StepPattern`] that is as cheap as any.
///
/// ```
/// use dtw::ndarray::array;
/// use dtw::{Dtw, LocalCost};
///
/// let dtw = Dtw::default().with_local_cost(LocalCost::Manhattan);
/// let (a, b) = (array![[0.0_f32, 1.0]], array![[2.0_f32, 0.0], [0.0, 1.0]]);
/// assert_eq!(dtw.distance(a.view(), b.view())?, Some(3.0));
/// # Ok::<(), dtw::DtwError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Dtw {
    band: Band,
    local: LocalCost,
    missing: Missing,
    pub(crate) steps: StepPattern,
    pub(crate) ends: Ends,
    path_memory: u64,
}

impl Default for Dtw {
    fn default() -> Self {
        Self::new(Band::Full)
    }
}

impl Dtw {
    /// Warping inside `band`, with Euclidean local costs, classic steps and closed ends.
    pub fn new(band: impl Into<Band>) -> Self {
        Self {
            band: band.into(),
            local: LocalCost::default(),
            missing: Missing::default(),
            steps: StepPattern::default(),
            ends: Ends::default(),
            path_memory: PATH_MEMORY,
        }
    }

    /// The same with another local cost.
    #[must_use]
    pub fn with_local_cost(self, local: LocalCost) -> Self {
        Self { local, ..self }
    }

    /// The same with another meaning of NaN.
    #[must_use]
    pub fn with_missing(self, missing: Missing) -> Self {
        Self { missing, ..self }
    }

    /// The same with other steps.
    #[must_use]
    pub fn with_steps(self, steps: StepPattern) -> Self {
        Self { steps, ..self }
    }

    /// The same with other ends; [`Ends::Open`] finds the first sequence within the second.
    #[must_use]
    pub fn with_ends(self, ends: Ends) -> Self {
        Self { ends, ..self }
    }

    /// The same with another bound on the memory for a path's steps; 256 MiB at first. What needs
    /// more is computed in parts, at most once more for each time that the parts are divided by
    /// eight, with the same result.
    #[must_use]
    pub fn with_path_memory(self, bytes: u64) -> Self {
        Self {
            path_memory: bytes,
            ..self
        }
    }

    /// The cells that a path may use.
    pub fn band(&self) -> &Band {
        &self.band
    }

    /// Cost of the cheapest path; `None` when there is no path.
    ///
    /// # Errors
    ///
    /// [`DtwError::Dimensions`] when the sequences' dimensions differ, [`DtwError::BandRows`] when
    /// the band is for another number of rows, [`DtwError::TooLarge`] when one row of costs or a
    /// copy of `b` does not fit in memory.
    pub fn distance<T: Sample>(
        &self,
        a: ArrayView2<'_, T>,
        b: ArrayView2<'_, T>,
    ) -> Result<Option<f64>, DtwError> {
        self.between(a, b, Distance { limit: None })
    }

    /// [`Self::distance`] when it is at most `limit`, else `None`, which is often known early.
    ///
    /// # Errors
    ///
    /// As [`Self::distance`].
    pub fn distance_within<T: Sample>(
        &self,
        a: ArrayView2<'_, T>,
        b: ArrayView2<'_, T>,
        limit: f64,
    ) -> Result<Option<f64>, DtwError> {
        self.between(a, b, Distance { limit: Some(limit) })
    }

    /// The cheapest path; `None` when there is none.
    ///
    /// # Errors
    ///
    /// As [`Self::distance`].
    pub fn align<T: Sample>(
        &self,
        a: ArrayView2<'_, T>,
        b: ArrayView2<'_, T>,
    ) -> Result<Option<WarpingPath>, DtwError> {
        self.between(a, b, Path)
    }

    /// [`Self::distance`] of two sequences of `n` and `m` frames whose local costs are `cost(i, j)`.
    ///
    /// `cost` is called once for each cell of the band. A cost that is not finite closes its cell.
    ///
    /// # Errors
    ///
    /// [`DtwError::BandRows`] and [`DtwError::TooLarge`] as above.
    pub fn distance_with<T: Sample>(
        &self,
        n: usize,
        m: usize,
        cost: impl Fn(usize, usize) -> T,
    ) -> Result<Option<f64>, DtwError> {
        self.run((n, m), |_| Ok(Called(cost)), Distance { limit: None })
    }

    /// [`Self::align`] of two sequences of `n` and `m` frames whose local costs are `cost(i, j)`.
    ///
    /// ```
    /// let path = dtw::Dtw::default().align_with(2, 3, |i, j| i.abs_diff(j) as f32)?;
    /// assert_eq!(path.expect("a path exists").steps, [(0, 0), (1, 1), (1, 2)]);
    /// # Ok::<(), dtw::DtwError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`DtwError::BandRows`] and [`DtwError::TooLarge`] as above.
    pub fn align_with<T: Sample>(
        &self,
        n: usize,
        m: usize,
        cost: impl Fn(usize, usize) -> T,
    ) -> Result<Option<WarpingPath>, DtwError> {
        self.run((n, m), |_| Ok(Called(cost)), Path)
    }

    /// [`Self::distance`] by a matrix of local costs, a row for each frame of the first sequence.
    ///
    /// # Errors
    ///
    /// [`DtwError::BandRows`] and [`DtwError::TooLarge`] as above.
    pub fn distance_of<T: Sample>(
        &self,
        costs: ArrayView2<'_, T>,
    ) -> Result<Option<f64>, DtwError> {
        let (n, m) = costs.dim();
        self.distance_with(n, m, |i, j| costs[[i, j]])
    }

    /// [`Self::align`] by a matrix of local costs, a row for each frame of the first sequence.
    ///
    /// # Errors
    ///
    /// [`DtwError::BandRows`] and [`DtwError::TooLarge`] as above.
    pub fn align_of<T: Sample>(
        &self,
        costs: ArrayView2<'_, T>,
    ) -> Result<Option<WarpingPath>, DtwError> {
        let (n, m) = costs.dim();
        self.align_with(n, m, |i, j| costs[[i, j]])
    }

    fn between<T: Sample, J: Job<T>>(
        &self,
        a: ArrayView2<'_, T>,
        b: ArrayView2<'_, T>,
        job: J,
    ) -> Result<Option<J::Output>, DtwError> {
        if a.ncols() != b.ncols() {
            return Err(DtwError::Dimensions {
                a: a.ncols(),
                b: b.ncols(),
            });
        }
        let shape = (a.nrows(), b.nrows());
        let is_missing = |frames: ArrayView2<'_, T>| frames.iter().any(|sample| sample.is_nan());
        if self.missing == Missing::LeftOut && (is_missing(a) || is_missing(b)) {
            let cost = |i, j| self.local.between(Missing::LeftOut, a.row(i), b.row(j));
            return self.run(shape, |_| Ok(Called(cost)), job);
        }
        self.run(shape, |height| Pair::new(self.local, (a, b), height), job)
    }

    fn run<T: Sample, C: Costs<T>, J: Job<T>>(
        &self,
        shape: (usize, usize),
        costs: impl FnOnce(usize) -> Result<C, DtwError>,
        job: J,
    ) -> Result<Option<J::Output>, DtwError> {
        self.run_on(Arch::new(), shape, costs, job)
    }

    /// The same by the kernels of one kind of processor.
    fn run_on<T: Sample, C: Costs<T>, J: Job<T>>(
        &self,
        arch: Arch,
        shape: (usize, usize),
        costs: impl FnOnce(usize) -> Result<C, DtwError>,
        job: J,
    ) -> Result<Option<J::Output>, DtwError> {
        let (n, m) = shape;
        if n == 0 || m == 0 {
            return Ok(None);
        }
        self.band.check(n)?;
        let reaches = self.ends.end_is_open() || self.band.columns(n - 1, shape).contains(&(m - 1));
        if !reaches {
            return Ok(None);
        }
        J::check(self, shape)?;
        let grid = Grid {
            shape,
            band: &self.band,
            ends: self.ends,
        };
        let height = arch.dispatch(Height::<T>(std::marker::PhantomData));
        let costs = costs(height)?;
        let place = (arch, height);
        match self.steps.weights_of_unit_steps() {
            Some(weights) => job.run(&mut Classic::new(grid, weights, place, costs)?, self),
            None => job.run(&mut General::new(grid, &self.steps, place, costs)?, self),
        }
    }
}

/// Rows of a strip: the lanes of two vectors.
struct Height<T>(std::marker::PhantomData<T>);

impl<T: Sample> WithSimd for Height<T> {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        2 * T::lanes::<S>()
    }
}

/// What is wanted of an engine.
trait Job<T: Sample> {
    type Output;

    /// Whether there is memory for a row, before rows without number are looked at.
    fn check(dtw: &Dtw, (n, m): (usize, usize)) -> Result<(), DtwError> {
        let width = dtw.band.width_bound(m);
        let mut row = Vec::<T>::new();
        let reserved = row.try_reserve_exact(width);
        reserved.map_err(|_| DtwError::TooLarge {
            rows: Self::rows(n),
            columns: width,
        })
    }

    /// Rows that are kept of `n`.
    fn rows(n: usize) -> usize;

    fn run<E: Engine<T>>(self, engine: &mut E, dtw: &Dtw)
    -> Result<Option<Self::Output>, DtwError>;
}

struct Distance {
    limit: Option<f64>,
}

impl<T: Sample> Job<T> for Distance {
    type Output = f64;

    fn rows(_: usize) -> usize {
        1
    }

    fn run<E: Engine<T>>(self, engine: &mut E, _: &Dtw) -> Result<Option<f64>, DtwError> {
        let n = engine.grid().shape.0;
        let limit = self.limit.unwrap_or(f64::INFINITY);
        let within = |cost: &f64| *cost <= limit;
        let mut costs = engine.start()?;
        // A cost that is equal to the limit may be rounded up when it becomes a sample.
        let limit = T::from(limit).map_or_else(T::infinity, |limit| limit + limit * T::epsilon());
        if !engine.sweep(0..n, &mut costs, limit)? {
            return Ok(None);
        }
        let found = costs.last().and_then(|row| Found::in_last_row(engine, row));
        Ok(found.map(|found| found.cost.into()).filter(within))
    }
}

struct Path;

impl<T: Sample> Job<T> for Path {
    type Output = WarpingPath;

    fn rows(n: usize) -> usize {
        n
    }

    fn run<E: Engine<T>>(self, engine: &mut E, dtw: &Dtw) -> Result<Option<WarpingPath>, DtwError> {
        trace(engine, dtw.path_memory)
    }
}

mod curve;
#[cfg(test)]
mod tests;
