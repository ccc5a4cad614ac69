use std::fmt;

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Position {
    /// In a text file.
    Text {
        /// Line, 1-based; lines end with LF, CR or CRLF.
        line: usize,
        /// Column in bytes, 1-based.
        column: usize,
        /// Offset in bytes from the start of the file, 0-based.
        byte: usize,
    },
    /// In a binary file.
    Binary {
        /// Offset in bytes from the start of the file, 0-based.
        byte: usize,
    },
}

impl Position {
    /// The position of byte `byte` of `text`. Offsets past the end count as the end.
    ///
    /// O(`byte`): positions are only worked out when there is something to report, so that reading
    /// a file never pays for counting lines.
    #[must_use]
    pub fn locate(text: &[u8], byte: usize) -> Position {
        Locator::new(text).locate(byte)
    }

    /// Offset in bytes from the start of the file, 0-based.
    #[must_use]
    pub fn byte(self) -> usize {
        match self {
            Position::Text { byte, .. } | Position::Binary { byte } => byte,
        }
    }

    /// Line of a text file, 1-based.
    #[must_use]
    pub fn line(self) -> Option<usize> {
        match self {
            Position::Text { line, .. } => Some(line),
            Position::Binary { .. } => None,
        }
    }

    /// Column in bytes of a text file, 1-based.
    #[must_use]
    pub fn column(self) -> Option<usize> {
        match self {
            Position::Text { column, .. } => Some(column),
            Position::Binary { .. } => None,
        }
    }
}

/// Finds positions in one pass, as long as they are asked for in ascending order.
pub(crate) struct Locator<'a> {
    text: &'a [u8],
    line: usize,
    line_start: usize,
    seen: usize,
}

impl<'a> Locator<'a> {
    pub(crate) fn new(text: &'a [u8]) -> Self {
        Locator {
            text,
            line: 1,
            line_start: 0,
            seen: 0,
        }
    }

    /// The position of `byte`, which must not lie before one asked for earlier.
    pub(crate) fn locate(&mut self, byte: usize) -> Position {
        let byte = byte.min(self.text.len());
        for i in self.seen..byte {
            let b = self.text[i];
            let ends_line = b == b'\n' || (b == b'\r' && self.text.get(i + 1) != Some(&b'\n'));
            if ends_line {
                self.line += 1;
                self.line_start = i + 1;
            }
        }
        self.seen = self.seen.max(byte);
        Position::Text {
            line: self.line,
            column: byte.saturating_sub(self.line_start) + 1,
            byte,
        }
    }
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Position::Text { line, column, .. } => write!(f, "{line}:{column}"),
            Position::Binary { byte } => write!(f, "byte {byte}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, byte: usize, line: usize, column: usize) {
        let at = Position::locate(text.as_bytes(), byte);
        assert_eq!((at.line(), at.column()), (Some(line), Some(column)));
    }

    #[test]
    fn counts_every_line_ending_once() {
        check("", 0, 1, 1);
        check("ab\ncd", 3, 2, 1);
        check("ab\r\ncd", 4, 2, 1);
        check("ab\rcd", 3, 2, 1);
        check("ab\r\rcd", 4, 3, 1);
        check("ab\ncd", 4, 2, 2);
        check("ab\ncd", 99, 2, 3);
    }
}
