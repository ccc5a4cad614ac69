use ndarray::ArrayView1;

/// Cost of aligning one frame with another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum LocalCost {
    /// Length of the difference.
    #[default]
    Euclidean,
    /// Squared length of the difference.
    SquaredEuclidean,
    /// Sum of absolute differences.
    Manhattan,
}

impl LocalCost {
    pub(crate) fn between<T: Copy + Into<f64>>(
        self,
        a: ArrayView1<'_, T>,
        b: ArrayView1<'_, T>,
    ) -> f64 {
        let differences = a.into_iter().zip(b).map(|(&a, &b)| a.into() - b.into());
        match self {
            Self::Euclidean => differences.map(|d| d * d).sum::<f64>().sqrt(),
            Self::SquaredEuclidean => differences.map(|d| d * d).sum(),
            Self::Manhattan => differences.map(f64::abs).sum(),
        }
    }
}

#[cfg(test)]
mod tests {
    use ndarray::array;

    use super::*;

    #[test]
    fn a_three_four_five_triangle() {
        let (a, b) = (array![1.0, 1.0], array![4.0, -3.0]);
        let cost = |local: LocalCost| local.between(a.view(), b.view());
        assert_eq!(cost(LocalCost::Euclidean), 5.0);
        assert_eq!(cost(LocalCost::SquaredEuclidean), 25.0);
        assert_eq!(cost(LocalCost::Manhattan), 7.0);
    }
}
