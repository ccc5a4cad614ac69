use ndarray::{Array2, ArrayView2};

use crate::{Band, Dtw, DtwError, Ends, Sample, Step, parallel};

impl Dtw {
    /// Costs of every ordered pair: row i, column j holds [`Self::distance`] of series i and j.
    ///
    /// Nothing is assumed: the diagonal is computed too, as a sequence costs something against
    /// itself where a path may not keep to the diagonal, and so are both orders of a pair where
    /// band, steps or ends do not treat the two alike. Where they do (closed ends, steps with their
    /// mirror images, a band that is full, Sakoe and Chiba's or Itakura's), a pair is computed once,
    /// with the earlier series as the first. Pairs run in parallel with the feature `rayon`, with
    /// the same result.
    ///
    /// ```
    /// use dtw::Dtw;
    /// use dtw::ndarray::array;
    ///
    /// let series = [array![[0.0], [1.0]], array![[0.0], [3.0], [3.0]]];
    /// let views = [series[0].view(), series[1].view()];
    /// let costs = Dtw::default().distance_matrix(&views)?;
    /// assert_eq!(costs, array![[Some(0.0), Some(4.0)], [Some(4.0), Some(0.0)]]);
    /// # Ok::<(), dtw::DtwError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Self::distance`], for the first such pair.
    pub fn distance_matrix<T: Sample>(
        &self,
        series: &[ArrayView2<'_, T>],
    ) -> Result<Array2<Option<f64>>, DtwError> {
        let n = series.len();
        let is_symmetric = self.is_symmetric();
        let columns = |i: usize| if is_symmetric { i..n } else { 0..n };
        let pairs: Vec<(usize, usize)> = (0..n)
            .flat_map(|i| columns(i).map(move |j| (i, j)))
            .collect();
        let cost = |(): &mut (), &(i, j): &(usize, usize)| self.distance(series[i], series[j]);
        let costs = parallel::map(&pairs, || (), cost);
        let mut matrix = Array2::from_elem((n, n), None);
        for ((i, j), cost) in pairs.into_iter().zip(costs) {
            let cost = cost?;
            matrix[[i, j]] = cost;
            if is_symmetric {
                matrix[[j, i]] = cost;
            }
        }
        Ok(matrix)
    }

    /// Whether a path from (0, 0) with steps (di, dj) costs what it costs with (dj, di).
    fn is_symmetric(&self) -> bool {
        let steps = self.steps.steps();
        let has_mirror_image = |step: &Step| {
            let image = Step::new(step.columns, step.rows, step.weight);
            steps.contains(&image)
        };
        let is_alike = matches!(
            self.band(),
            Band::Full | Band::SakoeChiba(_) | Band::Itakura(_)
        );
        is_alike && self.ends == Ends::Closed && steps.iter().all(has_mirror_image)
    }
}
