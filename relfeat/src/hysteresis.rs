use crate::Bound;

/// A Schmitt trigger over a column of numbers (spec.md a.1): off before the first frame; on from the
/// first frame where `enter` holds until the first one where `stay` fails.
///
/// NaN passes no test, so a missing number turns the feature off.
pub(crate) fn schmitt(values: &[f64], enter: Bound, stay: Bound, mut set: impl FnMut(usize)) {
    let mut on = false;
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_at_equality_and_gaps() {
        let values = [0.9, 1.0, 0.5, 0.4, 0.9, f64::NAN, 1.5, f64::NAN, 0.7];
        let mut on = Vec::new();
        schmitt(&values, Bound::AtLeast(1.0), Bound::AtLeast(0.5), |t| {
            on.push(t)
        });
        assert_eq!(on, [1, 2, 6]);
        on.clear();
        schmitt(&values, Bound::Above(1.0), Bound::Above(0.5), |t| {
            on.push(t)
        });
        assert_eq!(on, [6]);
    }
}
