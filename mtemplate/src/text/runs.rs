//! Rows as runs of equal values.

use std::ops::Range;

use crate::ANY;

/// A number in the fewest digits that give it back when read.
pub(super) fn number(value: f64) -> String {
    let digits = format!("{value:?}");
    digits.strip_suffix(".0").unwrap_or(&digits).to_owned()
}

/// A value of a template, `*` for 0.5.
pub(super) fn value(value: f64) -> String {
    if value == ANY {
        "*".to_owned()
    } else {
        // The negative zero is a zero.
        number(value + 0.0)
    }
}

/// The row of `values`; `symbol` writes one of them.
pub(super) fn write(values: impl Iterator<Item = f64>, symbol: fn(f64) -> String) -> String {
    let values: Vec<f64> = values.collect();
    let runs: Vec<&[f64]> = values.chunk_by(|a, b| a == b).collect();
    if let [run] = runs[..] {
        return symbol(run[0]);
    }
    let runs = runs.into_iter().map(|run| match run.len() {
        1 => symbol(run[0]),
        n => format!("{}x{n}", symbol(run[0])),
    });
    runs.collect::<Vec<_>>().join(" ")
}

/// What a row may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Row {
    /// Values of a feature.
    Values,
    /// Weights of columns.
    Weights,
}

/// What is wrong with a row; bytes count from its start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum RowError {
    /// The piece there is no run.
    Run(Range<usize>),
    /// There are fewer or more columns; with more, the byte is that of the run that goes too far.
    Columns { found: usize, byte: usize },
}

impl Row {
    fn read(self, text: &str) -> Option<f64> {
        let number = || text.parse::<f64>().ok();
        match self {
            Row::Values if text == "*" => Some(ANY),
            Row::Values => number().filter(|value| (0.0..=1.0).contains(value)),
            Row::Weights => number().filter(|weight| *weight > 0.0 && weight.is_finite()),
        }
    }

    /// The `n_columns` values of a row.
    pub(super) fn values(self, text: &str, n_columns: usize) -> Result<Vec<f64>, RowError> {
        let pieces: Vec<Range<usize>> = pieces(text).collect();
        let mut values = Vec::new();
        for piece in &pieces {
            let wrong = || RowError::Run(piece.clone());
            let run = &text[piece.clone()];
            let (value, count) = match run.split_once('x') {
                None if pieces.len() == 1 => (run, n_columns),
                None => (run, 1),
                Some((value, count)) => (value, read_count(count).ok_or_else(wrong)?),
            };
            let value = self.read(value).ok_or_else(wrong)?;
            let found = values.len().saturating_add(count);
            if found > n_columns {
                let byte = piece.start;
                return Err(RowError::Columns { found, byte });
            }
            values.resize(found, value);
        }
        if values.len() < n_columns {
            let (found, byte) = (values.len(), text.len());
            return Err(RowError::Columns { found, byte });
        }
        Ok(values)
    }
}

/// A number from 1, in digits alone.
fn read_count(text: &str) -> Option<usize> {
    let is_plain = text.bytes().all(|b| b.is_ascii_digit());
    let count = text.parse().ok().filter(|&count| count > 0);
    count.filter(|_| is_plain)
}

/// Where the words of a text stand.
fn pieces(text: &str) -> impl Iterator<Item = Range<usize>> {
    let start = text.as_ptr() as usize;
    text.split_ascii_whitespace().map(move |piece| {
        let from = piece.as_ptr() as usize - start;
        from..from + piece.len()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, n_columns: usize, expected: Result<&[f64], RowError>) {
        let found = Row::Values.values(text, n_columns);
        assert_eq!(found, expected.map(<[f64]>::to_vec));
    }

    #[test]
    fn runs_are_read() {
        check("0x2 0.25 1x1 *", 5, Ok(&[0.0, 0.0, 0.25, 1.0, 0.5]));
        check(" 1e-3\t0.5\r\n0 ", 3, Ok(&[0.001, 0.5, 0.0]));
        check("1", 3, Ok(&[1.0; 3]));
        check("*", 1, Ok(&[0.5]));
        check("", 0, Ok(&[]));
        check("1", 0, Ok(&[]));
    }

    #[test]
    fn what_is_no_row_is_found_where_it_stands() {
        let columns = |found, byte| Err(RowError::Columns { found, byte });
        check("0x2 1", 4, columns(3, 5));
        check("0x2 1x3 *", 4, columns(5, 4));
        check("1x2", 1, columns(2, 0));
        check("", 1, columns(0, 0));
        check("1x99999999999999999999", 1, Err(RowError::Run(0..22)));
        check("1x18446744073709551615 1", 1, columns(usize::MAX, 0));
        for (text, at) in [
            ("0 2 0", 2..3),
            ("0 -0.1 0", 2..6),
            ("0 nan 0", 2..5),
            ("0 1x0 0", 2..5),
            ("0 1x+1 0", 2..6),
            ("0 x2 0", 2..4),
            ("0 1x 0", 2..4),
            ("0 ** 0", 2..4),
            ("0 ½ 0", 2..4),
        ] {
            check(text, 3, Err(RowError::Run(at)));
        }
        assert_eq!(Row::Weights.values("1.5 *", 2), Err(RowError::Run(4..5)));
        assert_eq!(Row::Weights.values("0", 2), Err(RowError::Run(0..1)));
    }

    #[test]
    fn runs_are_written_short() {
        let row = |values: &[f64]| write(values.iter().copied(), value);
        assert_eq!(row(&[0.0, -0.0, 0.25, 1.0, 0.5, 0.5]), "0x2 0.25 1 *x2");
        assert_eq!(row(&[1.0, 1.0]), "1");
        assert_eq!(row(&[]), "");
        assert_eq!(row(&[1.0 / 3.0, 1e-9]), "0.3333333333333333 1e-9");
    }
}
