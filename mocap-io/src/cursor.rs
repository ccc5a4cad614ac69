use crate::number;
use crate::{ParseError, ParseErrorKind, Position};

/// Longest piece of foreign text that an error quotes, in bytes.
const QUOTE_LEN: usize = 24;

/// A reading position in the bytes of a text file.
///
/// Knows three line endings (LF, CR, CRLF) and treats every byte that is not ASCII white space as
/// part of a word, so files in any encoding can be read.
#[derive(Clone, Debug)]
pub(crate) struct Cursor<'a> {
    text: &'a [u8],
    pos: usize,
}

/// What [`Cursor::lex_number`] finds. Errors are large; rows are read without carrying one along.
pub(crate) enum Lexed {
    Number(f64),
    LineEnd,
    /// Something that is not a finite number.
    Wrong,
}

/// Blanks, and the bytes that fill up files: zeros, and the end-of-file mark of DOS.
#[inline]
pub(crate) fn is_blank(b: u8) -> bool {
    matches!(b, b' ' | b'\t' | 0x0b | 0x0c | 0 | 0x1a)
}

#[inline]
pub(crate) fn is_newline(b: u8) -> bool {
    matches!(b, b'\n' | b'\r')
}

#[inline]
pub(crate) fn is_space(b: u8) -> bool {
    is_blank(b) || is_newline(b)
}

/// The place of the first byte from `pos` on that is no blank.
#[inline(always)]
pub(crate) fn skip_blanks(text: &[u8], mut pos: usize) -> usize {
    while text.get(pos).is_some_and(|&b| is_blank(b)) {
        pos += 1;
    }
    pos
}

impl<'a> Cursor<'a> {
    /// Starts behind a UTF-8 byte order mark, if there is one.
    pub(crate) fn new(text: &'a [u8]) -> Self {
        let pos = if text.starts_with(b"\xef\xbb\xbf") {
            3
        } else {
            0
        };
        Cursor { text, pos }
    }

    /// An error if the bytes are text of two or four bytes a character.
    pub(crate) fn check_encoding(&self) -> Result<(), ParseError> {
        let found = match self.text {
            [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] => "UTF-32",
            [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "UTF-16",
            [a, 0, b, 0, ..] | [0, a, 0, b, ..] if a.is_ascii_graphic() && b.is_ascii_graphic() => {
                "UTF-16"
            }
            _ => return Ok(()),
        };
        Err(self.error_at(0, ParseErrorKind::Encoding { found }))
    }

    pub(crate) fn byte(&self) -> usize {
        self.pos
    }

    pub(crate) fn rest(&self) -> &'a [u8] {
        &self.text[self.pos..]
    }

    /// All bytes of the file.
    pub(crate) fn whole(&self) -> &'a [u8] {
        self.text
    }

    pub(crate) fn text_between(&self, from: usize, to: usize) -> &'a [u8] {
        &self.text[from..to]
    }

    pub(crate) fn peek(&self) -> Option<u8> {
        self.text.get(self.pos).copied()
    }

    pub(crate) fn at_end(&self) -> bool {
        self.pos >= self.text.len()
    }

    pub(crate) fn advance(&mut self, n_bytes: usize) {
        self.pos = (self.pos + n_bytes).min(self.text.len());
    }

    /// Moves to `pos`, which is no further than the end.
    pub(crate) fn seek(&mut self, pos: usize) {
        self.pos = pos.min(self.text.len());
    }

    /// Skips blanks within the line.
    #[inline]
    pub(crate) fn skip_blanks(&mut self) {
        self.pos = skip_blanks(self.text, self.pos);
    }

    /// Skips blanks and line ends.
    pub(crate) fn skip_space(&mut self) {
        while self.pos < self.text.len() && is_space(self.text[self.pos]) {
            self.pos += 1;
        }
    }

    /// Moves to the start of the next line.
    pub(crate) fn next_line(&mut self) {
        while self.peek().is_some_and(|b| !is_newline(b)) {
            self.pos += 1;
        }
        match self.peek() {
            Some(b'\r') if self.text.get(self.pos + 1) == Some(&b'\n') => self.pos += 2,
            Some(_) => self.pos += 1,
            None => {}
        }
    }

    pub(crate) fn at_white_space(&self) -> bool {
        self.peek().is_none_or(is_space)
    }

    pub(crate) fn at_line_end(&self) -> bool {
        self.peek().is_none_or(is_newline)
    }

    /// The next run of bytes without white space; empty at the end of the file.
    #[inline]
    pub(crate) fn word(&mut self) -> &'a [u8] {
        let start = self.pos;
        while self.pos < self.text.len() && !is_space(self.text[self.pos]) {
            self.pos += 1;
        }
        &self.text[start..self.pos]
    }

    /// What comes next, up to white space or a brace.
    pub(crate) fn peek_keyword(&self) -> &'a [u8] {
        let rest = self.rest();
        let ends = |&b: &u8| is_space(b) || matches!(b, b'{' | b'}');
        &rest[..rest.iter().position(ends).unwrap_or(rest.len())]
    }

    /// The rest of the line without surrounding blanks; stops before `stop`, too, where given.
    pub(crate) fn line_text(&mut self, stop: Option<u8>) -> &'a [u8] {
        self.skip_blanks();
        let start = self.pos;
        while self
            .peek()
            .is_some_and(|b| !is_newline(b) && Some(b) != stop)
        {
            self.pos += 1;
        }
        let mut end = self.pos;
        while end > start && is_blank(self.text[end - 1]) {
            end -= 1;
        }
        &self.text[start..end]
    }

    /// A number on this line, after blanks. Stays before what is no number.
    ///
    /// The number must be followed by white space, the end of the file, a brace, or the sign of a next
    /// number glued to it.
    pub(crate) fn lex_number(&mut self) -> Lexed {
        self.skip_blanks();
        if self.at_line_end() {
            return Lexed::LineEnd;
        }
        match number::longest(self.text, self.pos) {
            Some((value, end)) if self.ends_number(end) => {
                self.pos = end;
                Lexed::Number(value)
            }
            _ => Lexed::Wrong,
        }
    }

    fn ends_number(&self, end: usize) -> bool {
        let next = self.text.get(end).copied();
        next.is_none_or(|b| is_space(b) || matches!(b, b'-' | b'+' | b'{' | b'}'))
    }

    /// Whether what comes next is a number to a C library, but not a finite one.
    pub(crate) fn at_not_finite(&self) -> bool {
        let word = self.clone().word();
        let unsigned = word.strip_prefix(b"-").or(word.strip_prefix(b"+"));
        let name = unsigned.unwrap_or(word).to_ascii_lowercase();
        if name.starts_with(b"nan") || name.starts_with(b"inf") {
            let letters = name.iter().take_while(|b| b.is_ascii_lowercase()).count();
            return matches!(&name[..letters], b"nan" | b"inf" | b"infinity");
        }
        // `-1.#IND`, as Microsoft's library printed it.
        let is_overflow = fast_float2::parse::<f64, _>(word).is_ok_and(|v| v.is_infinite());
        is_overflow || name.starts_with(b"1.#")
    }

    /// Why [`Cursor::lex_number`] found something wrong here.
    #[cold]
    pub(crate) fn number_error(&self) -> ParseError {
        if self.at_not_finite() {
            let found = quote(self.clone().word());
            return self.error_at(self.pos, ParseErrorKind::NotFinite { found });
        }
        self.expected("a number")
    }

    /// Whether the file ends here within something that could have become a number, such as `-` or
    /// `1.5e`.
    pub(crate) fn at_cut_number(&self) -> bool {
        let in_number = |b: &u8| matches!(b, b'0'..=b'9' | b'.' | b'e' | b'E' | b'+' | b'-');
        !self.at_end() && self.rest().iter().all(in_number)
    }

    /// A number that must be there.
    pub(crate) fn required_number(&mut self) -> Result<f64, ParseError> {
        match self.lex_number() {
            Lexed::Number(value) => Ok(value),
            Lexed::LineEnd => Err(self.expected("a number")),
            Lexed::Wrong => Err(self.number_error()),
        }
    }

    /// An error here: `expected` against what comes next.
    pub(crate) fn expected(&self, expected: &'static str) -> ParseError {
        let found = match self.peek() {
            None => "the end of the file".to_owned(),
            Some(b) if is_newline(b) => "the end of the line".to_owned(),
            Some(_) => quote(self.clone().word()),
        };
        self.error_at(self.pos, ParseErrorKind::Expected { expected, found })
    }

    pub(crate) fn error_at(&self, byte: usize, kind: ParseErrorKind) -> ParseError {
        ParseError {
            at: self.locate(byte),
            kind,
        }
    }

    pub(crate) fn locate(&self, byte: usize) -> Position {
        Position::locate(self.text, byte)
    }
}

/// `bytes` in quotes, shortened, with bytes that are not UTF-8 replaced.
pub(crate) fn quote(bytes: &[u8]) -> String {
    let text = text(&bytes[..bytes.len().min(QUOTE_LEN)]);
    let dots = if bytes.len() > QUOTE_LEN { "…" } else { "" };
    format!("{text:?}{dots}")
}

/// `bytes` as text: UTF-8 where it is, else each byte as the Latin-1 character it is.
pub(crate) fn text(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
    }
}
