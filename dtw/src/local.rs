use ndarray::ArrayView1;

use crate::Sample;

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
    /// One minus the cosine of the angle between the two, from 0 to 2. A frame of length zero has
    /// no direction and aligns with nothing.
    Cosine,
}

/// What a NaN among a frame's samples means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Missing {
    /// The frame aligns with nothing.
    #[default]
    Closes,
    /// The dimension is left out of this frame's costs, which are scaled up to what all dimensions
    /// together would give: squared and Manhattan costs by dims / present ones, Euclidean ones by
    /// its root; a cosine is that of the common dimensions. Frames without a common dimension do
    /// not align.
    LeftOut,
}

impl LocalCost {
    /// The cost by its definition, dimension after dimension; NaN or infinite where there is none.
    pub(crate) fn between<T: Sample>(
        self,
        missing: Missing,
        a: ArrayView1<'_, T>,
        b: ArrayView1<'_, T>,
    ) -> T {
        let pairs = || {
            let both = a.iter().zip(b.iter()).map(|(&a, &b)| (a, b));
            both.filter(|(a, b)| missing == Missing::Closes || !(a.is_nan() || b.is_nan()))
        };
        let sum = |term: fn((T, T)) -> T| pairs().fold(T::zero(), |sum, pair| sum + term(pair));
        let squared = || sum(|(a, b)| (a - b) * (a - b));
        let scale = match missing {
            Missing::Closes => T::one(),
            Missing::LeftOut => share(a.len(), pairs().count()),
        };
        if scale.is_nan() {
            return scale;
        }
        match self {
            Self::Euclidean => (squared() * scale).sqrt(),
            Self::SquaredEuclidean => squared() * scale,
            Self::Manhattan => sum(|(a, b)| (a - b).abs()) * scale,
            Self::Cosine => {
                let (a, b) = (sum(|(a, _)| a * a).sqrt(), sum(|(_, b)| b * b).sqrt());
                let half = T::one() / (T::one() + T::one());
                // Half the squared distance of the directions: 1 - cos without its cancellation.
                half * pairs().fold(T::zero(), |sum, (x, y)| {
                    let difference = x / a - y / b;
                    sum + difference * difference
                })
            }
        }
    }
}

/// dims / present; NaN where none is present of some.
fn share<T: Sample>(dims: usize, present: usize) -> T {
    if dims == present {
        return T::one();
    }
    let count = |count: usize| T::from(count).unwrap_or_else(T::nan);
    if present == 0 {
        T::nan()
    } else {
        count(dims) / count(present)
    }
}

#[cfg(test)]
mod tests {
    use ndarray::array;

    use super::*;

    #[test]
    fn a_three_four_five_triangle() {
        let (a, b) = (array![1.0, 1.0], array![4.0, -3.0]);
        let cost = |local: LocalCost| local.between(Missing::Closes, a.view(), b.view());
        assert_eq!(cost(LocalCost::Euclidean), 5.0);
        assert_eq!(cost(LocalCost::SquaredEuclidean), 25.0);
        assert_eq!(cost(LocalCost::Manhattan), 7.0);
    }

    #[test]
    fn right_angles_and_opposites() {
        let (a, b) = (array![2.0, 0.0], array![0.0, 0.5]);
        let cost = |b: ndarray::ArrayView1<'_, f64>| {
            LocalCost::Cosine.between(Missing::Closes, a.view(), b)
        };
        assert_eq!(cost(b.view()), 1.0);
        assert_eq!(cost(array![-7.0, 0.0].view()), 2.0);
        assert_eq!(cost(a.view()), 0.0);
        assert!(cost(array![0.0, 0.0].view()).is_nan());
    }

    #[test]
    fn what_is_missing_is_made_up_for() {
        let (a, b) = (
            array![0.0, f64::NAN, 1.0, 5.0],
            array![3.0, 1.0, f64::NAN, 9.0],
        );
        let cost = |local: LocalCost| local.between(Missing::LeftOut, a.view(), b.view());
        assert_eq!(cost(LocalCost::SquaredEuclidean), 50.0);
        assert_eq!(cost(LocalCost::Euclidean), 50.0_f64.sqrt());
        assert_eq!(cost(LocalCost::Manhattan), 14.0);
        let none = array![f64::NAN, 1.0];
        let other = array![1.0, f64::NAN];
        let cost = LocalCost::Euclidean.between(Missing::LeftOut, none.view(), other.view());
        assert!(cost.is_nan());
    }
}
