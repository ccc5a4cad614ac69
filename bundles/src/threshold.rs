//! τ: letters up to this far apart count as equal (equation 2).

use crate::{BundlesError, MotionString, PoseClusters};

/// The median distance of neighbouring letters; the mean of the middle two when their number is
/// even.
///
/// Letters on both sides of a clip boundary are no neighbours. `None` when there are none: when
/// every clip stays within one letter. At this threshold about half of all neighbours count as
/// equal.
///
/// # Errors
///
/// [`BundlesError::UnknownLetter`] when the string uses a letter that `clusters` lacks.
pub fn adjacent_distance_median(
    string: &MotionString,
    clusters: &PoseClusters,
) -> Result<Option<f64>, BundlesError> {
    let n_letters = clusters.n_letters();
    for run in string.runs() {
        if clusters.distance(run.letter, run.letter).is_none() {
            let letter = run.letter.label();
            return Err(BundlesError::UnknownLetter { letter, n_letters });
        }
    }
    let neighbours = string
        .runs()
        .windows(2)
        .filter(|pair| pair[0].clip == pair[1].clip);
    let distances = neighbours.filter_map(|pair| clusters.distance(pair[0].letter, pair[1].letter));
    Ok(median(distances.collect()))
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    let is_even = values.len().is_multiple_of(2);
    if values.is_empty() {
        return None;
    }
    let (below, upper, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    let upper = *upper;
    if !is_even {
        return Some(upper);
    }
    let lower = below.iter().copied().max_by(f64::total_cmp)?;
    // Halved before they are added: the sum of two large distances may not be finite.
    Some(lower / 2.0 + upper / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_of_few() {
        assert_eq!(median(vec![]), None);
        assert_eq!(median(vec![4.0]), Some(4.0));
        assert_eq!(median(vec![4.0, 1.0]), Some(2.5));
        assert_eq!(median(vec![4.0, 1.0, 3.0]), Some(3.0));
        assert_eq!(median(vec![4.0, 1.0, 3.0, 4.0]), Some(3.5));
        assert_eq!(median(vec![f64::MAX, f64::MAX]), Some(f64::MAX));
    }
}
