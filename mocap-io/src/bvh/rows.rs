use super::parse::{at_comment, skip_line};
use crate::cursor::{Cursor, Lexed, is_newline, skip_blanks};
use crate::warning::Oddities;
use crate::{ParseError, ParseErrorKind, WarningKind, number};

/// Reads all rows of `n_columns` values. Only whole rows are kept.
///
/// One frame a line is what the format asks for. Frames that go on over several lines and lines of
/// several frames are read, too, where frames and lines begin together often enough to leave no doubt.
pub(super) fn parse_rows(
    cursor: &mut Cursor<'_>,
    n_columns: usize,
    header_frames: Option<u64>,
    oddities: &mut Oddities,
) -> Result<Vec<f64>, ParseError> {
    let mut reader = Reader {
        start: cursor.byte(),
        cursor,
        oddities,
        n_columns,
        header_frames,
        values: Vec::new(),
        row: vec![0.0; n_columns],
        layout: Layout::default(),
    };
    loop {
        reader.read_usual_rows();
        reader.cursor.skip_space();
        if reader.cursor.at_end() || reader.skip_epilogue() {
            return reader.finish();
        }
        reader.read_line()?;
    }
}

struct Reader<'r, 'a> {
    cursor: &'r mut Cursor<'a>,
    oddities: &'r mut Oddities,
    /// Where the rows begin.
    start: usize,
    n_columns: usize,
    header_frames: Option<u64>,
    values: Vec<f64>,
    /// Room for a frame: were it made anew for each line, wide skeletons would take quadratic time
    /// where lines are no rows.
    row: Vec<f64>,
    layout: Layout,
}

impl Reader<'_, '_> {
    /// Reads lines of exactly one frame, up to a line that needs care.
    fn read_usual_rows(&mut self) {
        if self.n_columns == 0 || self.layout.open.is_some() {
            return;
        }
        let text = self.cursor.whole();
        loop {
            self.cursor.skip_space();
            let at = self.cursor.byte();
            let Some(end) = read_usual_row(text, at, &mut self.row) else {
                return;
            };
            self.reserve(self.n_columns);
            let n_before = self.values.len();
            self.values.extend_from_slice(&self.row);
            self.cursor.seek(end);
            self.layout
                .note(at, self.n_columns, n_before, self.n_columns);
        }
    }

    fn reserve(&mut self, n: usize) {
        let (n_read, n_rest) = (self.cursor.byte() - self.start, self.cursor.rest().len());
        // A value takes a digit and a blank.
        let max = self.values.len() + n_rest / 2 + n;
        number::reserve(&mut self.values, n, n_read, n_rest, max);
    }

    /// Whether nothing but text follows the last frame that the header announces.
    fn skip_epilogue(&mut self) -> bool {
        let n_frames = self.values.len().checked_div(self.n_columns).unwrap_or(0);
        let is_number = |b: u8| b.is_ascii_digit() || matches!(b, b'.' | b',' | b'+' | b'-');
        let is_epilogue = self.header_frames == Some(n_frames as u64)
            && self.layout.open.is_none()
            && !self.layout.is_untidy
            && !self.cursor.peek().is_some_and(is_number)
            && !self.cursor.at_not_finite()
            && !at_comment(self.cursor);
        if is_epilogue {
            skip_line(self.cursor, self.oddities);
        }
        is_epilogue
    }

    /// Reads a line of any number of values.
    fn read_line(&mut self) -> Result<(), ParseError> {
        let line_at = self.cursor.byte();
        let n_before = self.values.len();
        let mut is_cut = false;
        loop {
            let at = self.cursor.byte();
            let touches = self.values.len() > n_before && !self.cursor.at_white_space();
            self.cursor.skip_blanks();
            if at_comment(self.cursor) {
                self.oddities
                    .push_once(self.cursor.byte(), WarningKind::Comment);
                self.cursor.line_text(None);
                break;
            }
            match self.cursor.lex_number() {
                Lexed::Number(value) => {
                    self.reserve(1);
                    self.values.push(value);
                }
                Lexed::LineEnd => break,
                Lexed::Wrong => {
                    is_cut = self.values.len() - n_before < self.n_columns
                        && self.cursor.at_cut_number();
                    if is_cut {
                        self.cursor.seek(self.cursor.whole().len());
                        break;
                    }
                    return Err(self.cursor.number_error());
                }
            }
            if touches {
                self.oddities.push_once(at, WarningKind::GluedNumbers);
            }
        }
        let n_values = self.values.len() - n_before;
        if self.n_columns == 0 && n_values > 0 {
            let (frame, at) = (1, line_at);
            return Err(self.value_count(&OddLine {
                at,
                frame,
                n_values,
            }));
        }
        if n_values > 0 || is_cut {
            self.layout
                .note(line_at, n_values, n_before, self.n_columns);
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Vec<f64>, ParseError> {
        let n_columns = self.n_columns;
        let mut odd = self.layout.first_odd.take();
        if let Some(Open { at, n_values }) = self.layout.open {
            self.values.truncate(self.values.len() - n_values);
            let (expected, found) = (n_columns, n_values);
            self.oddities
                .push(at, WarningKind::TruncatedRow { expected, found });
            odd = odd.filter(|odd| odd.at < at);
        }
        let Some(odd) = odd else {
            return Ok(self.values);
        };
        if self.layout.is_untidy && !self.is_even_flow() {
            return Err(self.value_count(&odd));
        }
        self.oddities.push(odd.at, WarningKind::RowLayout);
        Ok(self.values)
    }

    /// Whether lines of equal length, shorter than a frame, hold just the frames that the header
    /// announces.
    fn is_even_flow(&self) -> bool {
        let n_values = self.values.len();
        !self.layout.is_ragged
            && self.layout.line_len.is_some_and(|n| n < self.n_columns)
            && n_values.is_multiple_of(self.n_columns)
            && self.header_frames == Some((n_values / self.n_columns) as u64)
    }

    fn value_count(&self, odd: &OddLine) -> ParseError {
        let kind = ParseErrorKind::ValueCount {
            what: format!("frame {}", odd.frame),
            expected: self.n_columns,
            found: odd.n_values,
        };
        self.cursor.error_at(odd.at, kind)
    }
}

/// Fills `row` with the numbers of the line at `pos` and gives the end of the line, if the line holds
/// just these numbers and blanks.
#[inline(always)]
fn read_usual_row(text: &[u8], mut pos: usize, row: &mut [f64]) -> Option<usize> {
    for slot in row {
        // One blank is what nearly all files have between two numbers.
        if text.get(pos) == Some(&b' ') {
            pos += 1;
        }
        (*slot, pos) = match number::short_decimal(text, pos) {
            Some(read) => read,
            None => number::spaced(text, skip_blanks(text, pos))?,
        };
    }
    pos = skip_blanks(text, pos);
    text.get(pos).is_none_or(|&b| is_newline(b)).then_some(pos)
}

/// How lines and frames go together.
#[derive(Default)]
struct Layout {
    first_odd: Option<OddLine>,
    /// What the lines so far have of a frame that goes on.
    open: Option<Open>,
    /// A frame began or ended within a line and did not fill it with others.
    is_untidy: bool,
    /// Number of values of the first line.
    line_len: Option<usize>,
    /// The last line had fewer values than the first.
    is_short: bool,
    /// Lines before the last one had other numbers of values than the first.
    is_ragged: bool,
}

/// A line that is not one frame.
struct OddLine {
    at: usize,
    /// 1-based.
    frame: usize,
    n_values: usize,
}

struct Open {
    at: usize,
    n_values: usize,
}

impl Layout {
    /// Notes a line of `n_values` at `at`, behind `n_before` values. `n_columns` is not 0.
    fn note(&mut self, at: usize, n_values: usize, n_before: usize, n_columns: usize) {
        if self.first_odd.is_none() && n_values == n_columns {
            self.line_len = Some(n_columns);
            return;
        }
        let line_len = *self.line_len.get_or_insert(n_values);
        self.is_ragged |= self.is_short || n_values > line_len;
        self.is_short = n_values < line_len;
        let frame = n_before / n_columns + 1;
        self.first_odd.get_or_insert(OddLine {
            at,
            frame,
            n_values,
        });
        let (open_at, n_open) = self.open.as_ref().map_or((at, 0), |o| (o.at, o.n_values));
        let n = n_open + n_values;
        let is_whole = n.is_multiple_of(n_columns) && (n_open == 0 || n == n_columns);
        let is_tidy = n < n_columns || is_whole;
        self.is_untidy |= !is_tidy;
        self.open = (!self.is_untidy && n < n_columns).then_some(Open {
            at: open_at,
            n_values: n,
        });
    }
}
