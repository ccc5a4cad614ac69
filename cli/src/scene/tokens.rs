//! A text as statements of words.

/// A word with its place in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Token<'a> {
    pub(super) text: &'a str,
    /// Offset in bytes.
    pub(super) byte: usize,
}

/// The words between two ends of statements.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Statement<'a> {
    pub(super) tokens: Vec<Token<'a>>,
    /// Offset of its end in bytes, for what is missing there.
    pub(super) end: usize,
}

/// The statements of a text that have a word.
pub(super) fn statements(text: &str) -> Vec<Statement<'_>> {
    let mut statements = Vec::new();
    let mut byte = 0;
    for line in text.split(['\n', '\r']) {
        let code = line.split('#').next().unwrap_or(line);
        let mut at = byte;
        for part in code.split(';') {
            let tokens = tokens(part, at);
            let end = tokens.last().map_or(at, |t| t.byte + t.text.len());
            if !tokens.is_empty() {
                statements.push(Statement { tokens, end });
            }
            at += part.len() + 1;
        }
        byte += line.len() + 1;
    }
    statements
}

fn tokens(part: &str, byte: usize) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let mut start = None;
    let mut push = |from: usize, to: usize| {
        let (text, byte) = (&part[from..to], byte + from);
        tokens.push(Token { text, byte });
    };
    for (at, c) in part.char_indices() {
        let stands_alone = matches!(c, ':' | '[' | ']');
        if c.is_whitespace() || stands_alone {
            if let Some(from) = start.take() {
                push(from, at);
            }
            if stands_alone {
                push(at, at + 1);
            }
        } else {
            start.get_or_insert(at);
        }
    }
    if let Some(from) = start {
        push(from, part.len());
    }
    tokens
}
