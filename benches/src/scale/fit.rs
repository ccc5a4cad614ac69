//! How one quantity grows with another.

/// The exponent b of y = a·x^b by least squares of logarithms. `None` for fewer than two different x, or if a
/// number is not positive.
#[must_use]
pub fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    if points.iter().any(|&(x, y)| !(x > 0.0 && y > 0.0)) {
        return None;
    }
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(|p| of(p).ln()).sum::<f64>() / n;
    let (mean_x, mean_y) = (mean(|p| p.0), mean(|p| p.1));
    let (mut xx, mut xy) = (0.0, 0.0);
    for (x, y) in points {
        let dx = x.ln() - mean_x;
        xx += dx * dx;
        xy += dx * (y.ln() - mean_y);
    }
    (xx > 0.0).then(|| xy / xx)
}

/// The middle one, the lower of two; 0 of none.
#[must_use]
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len().saturating_sub(1) / 2;
    sorted.get(middle).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a few logarithms.
    const TOLERANCE: f64 = 1e-12;

    #[test]
    fn powers_have_their_exponents() {
        for b in [-1.0, 0.0, 0.5, 1.0, 2.0] {
            let points: Vec<(f64, f64)> = [1.0_f64, 2.0, 3.0, 50.0]
                .iter()
                .map(|&x| (x, 7.0 * x.powf(b)))
                .collect();
            assert!((exponent(&points).unwrap() - b).abs() < TOLERANCE, "{b}");
        }
    }

    #[test]
    fn what_has_no_exponent() {
        assert_eq!(exponent(&[]), None);
        assert_eq!(exponent(&[(2.0, 3.0)]), None);
        assert_eq!(exponent(&[(2.0, 3.0), (2.0, 4.0)]), None);
        assert_eq!(exponent(&[(1.0, 3.0), (2.0, 0.0)]), None);
        assert_eq!(exponent(&[(1.0, 3.0), (f64::NAN, 1.0)]), None);
    }

    #[test]
    fn medians() {
        assert_eq!(median(&[]), 0.0);
        assert_eq!(median(&[3.0]), 3.0);
        assert_eq!(median(&[5.0, 1.0, 9.0, 2.0]), 2.0);
    }
}
