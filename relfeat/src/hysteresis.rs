use crate::Bound;

/// A Schmitt trigger over a column of numbers (spec.md a.1): on from the first frame where `enter`
/// holds until the first one where `stay` fails. `on` says how it stood before the first frame, and
/// how it stands after the last: off where a motion begins.
///
/// NaN passes no test, so a missing number turns the feature off.
pub(crate) fn schmitt(
    values: &[f64],
    [enter, stay]: [Bound; 2],
    mut on: bool,
    mut set: impl FnMut(usize),
) -> bool {
    for (t, &value) in values.iter().enumerate() {
        on = if on {
            stay.holds(value)
        } else {
            enter.holds(value)
        };
        if on {
            set(t);
        }
    }
    on
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_at_equality_and_gaps() {
        let values = [0.9, 1.0, 0.5, 0.4, 0.9, f64::NAN, 1.5, f64::NAN, 0.7];
        let mut on = Vec::new();
        let least = [1.0, 0.5].map(Bound::AtLeast);
        schmitt(&values, least, false, |t| on.push(t));
        assert_eq!(on, [1, 2, 6]);
        on.clear();
        schmitt(&values, [1.0, 0.5].map(Bound::Above), false, |t| on.push(t));
        assert_eq!(on, [6]);
    }
}
