//! Costs of all ends of a path.

use ndarray::ArrayView2;

use super::{Called, Dtw, DtwError, Ends, Engine, Job, Sample};

impl Dtw {
    /// For each frame of `b`, the cost of the cheapest path that ends there, if one does; the curve
    /// whose minimum is [`Self::distance`] when the ends are open.
    ///
    /// ```
    /// use dtw::ndarray::array;
    /// use dtw::{Dtw, Ends};
    ///
    /// let (query, series) = (array![[1.0], [2.0]], array![[0.0], [1.0], [2.0], [2.5]]);
    /// let curve = Dtw::default().with_ends(Ends::Open).end_costs(query.view(), series.view())?;
    /// assert_eq!(curve, [Some(3.0), Some(1.0), Some(0.0), Some(0.5)]);
    /// # Ok::<(), dtw::DtwError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Self::distance`].
    pub fn end_costs<T: Sample>(
        &self,
        a: ArrayView2<'_, T>,
        b: ArrayView2<'_, T>,
    ) -> Result<Vec<Option<f64>>, DtwError> {
        let n_frames = b.nrows();
        let costs = self.with_open_end().between(a, b, Curve)?;
        Ok(costs.unwrap_or_else(|| vec![None; n_frames]))
    }

    /// [`Self::end_costs`] of two sequences of `n` and `m` frames whose local costs are `cost(i, j)`.
    ///
    /// `cost` is called once for each cell of the band. A cost that is not finite closes its cell.
    ///
    /// ```
    /// use dtw::{Dtw, Ends};
    ///
    /// let (query, series) = ([1, 2], [0, 1, 2, 4_i32]);
    /// let cost = |i: usize, j: usize| f64::from((query[i] - series[j]).abs());
    /// let curve = Dtw::default().with_ends(Ends::Open).end_costs_with(2, 4, cost)?;
    /// assert_eq!(curve, [Some(3.0), Some(1.0), Some(0.0), Some(2.0)]);
    /// # Ok::<(), dtw::DtwError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`DtwError::BandRows`] and [`DtwError::TooLarge`] as above.
    pub fn end_costs_with<T: Sample>(
        &self,
        n: usize,
        m: usize,
        cost: impl Fn(usize, usize) -> T,
    ) -> Result<Vec<Option<f64>>, DtwError> {
        let open = self.with_open_end();
        let costs = open.run((n, m), |_| Ok(Called(cost)), Curve)?;
        Ok(costs.unwrap_or_else(|| vec![None; m]))
    }

    fn with_open_end(&self) -> Self {
        Self {
            ends: match self.ends {
                Ends::Closed => Ends::OpenEnd,
                Ends::OpenBegin => Ends::Open,
                open => open,
            },
            ..self.clone()
        }
    }
}

struct Curve;

impl<T: Sample> Job<T> for Curve {
    type Output = Vec<Option<f64>>;

    fn rows(_: usize) -> usize {
        1
    }

    fn run<E: Engine<T>>(self, engine: &mut E, _: &Dtw) -> Result<Option<Self::Output>, DtwError> {
        let (n, m) = engine.grid().shape;
        let mut costs = engine.start()?;
        engine.sweep(0..n, &mut costs, T::infinity())?;
        let end = |column| costs.last().map(|row| row.get(column));
        let finite = |cost: &T| cost.is_finite();
        Ok(Some(
            (0..m)
                .map(|column| end(column).filter(finite).map(T::into))
                .collect(),
        ))
    }
}
