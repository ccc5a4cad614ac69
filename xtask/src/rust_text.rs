//! Rust source split into code and comments, so that a rule about one never trips over the other.

/// One source line.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub(crate) struct Line {
    /// Code; string and character contents are replaced by spaces.
    pub(crate) code: String,
    /// Comment text without its marker; empty when the line has none.
    pub(crate) comment: String,
    /// Whether the comment is documentation (`///`, `//!`, `/**`, `/*!`).
    pub(crate) is_doc: bool,
}

enum State {
    Code,
    LineComment,
    BlockComment { depth: usize },
    Str,
    RawStr { hashes: usize },
}

/// Splits a source file into lines. Line `i` of the result is line `i + 1` of the file.
pub(crate) fn split(source: &str) -> Vec<Line> {
    let chars: Vec<char> = source.chars().collect();
    let mut lines = vec![Line::default()];
    let mut state = State::Code;
    let mut i = 0;
    // Invariant: every branch advances `i` by at least one.
    while i < chars.len() {
        let c = chars[i];
        let next = chars.get(i + 1).copied();
        if c == '\n' {
            if matches!(state, State::LineComment) {
                state = State::Code;
            }
            lines.push(Line::default());
            i += 1;
            continue;
        }
        let last = lines.len() - 1;
        let line = &mut lines[last];
        match state {
            State::Code => match (c, next) {
                ('/', Some('/')) => {
                    let third = chars.get(i + 2).copied();
                    // Four slashes are an ordinary comment again.
                    let is_outer = third == Some('/') && chars.get(i + 3) != Some(&'/');
                    line.is_doc = is_outer || third == Some('!');
                    i += if line.is_doc { 3 } else { 2 };
                    state = State::LineComment;
                }
                ('/', Some('*')) => {
                    line.is_doc = matches!(chars.get(i + 2), Some('*' | '!'));
                    state = State::BlockComment { depth: 1 };
                    i += 2;
                }
                ('"', _) => {
                    line.code.push('"');
                    state = State::Str;
                    i += 1;
                }
                ('r', _) if !ends_in_word(&line.code) || line.code.ends_with(['b', 'c']) => {
                    let hashes = chars[i + 1..].iter().take_while(|&&c| c == '#').count();
                    line.code.push('r');
                    i += 1;
                    if chars.get(i + hashes) == Some(&'"') {
                        line.code.push('"');
                        state = State::RawStr { hashes };
                        i += hashes + 1;
                    }
                }
                ('\'', _) => {
                    let length = char_literal_length(&chars[i..]);
                    line.code.push('\'');
                    if length > 1 {
                        line.code.push_str(" '");
                    }
                    i += length;
                }
                _ => {
                    line.code.push(c);
                    i += 1;
                }
            },
            State::LineComment => {
                line.comment.push(c);
                i += 1;
            }
            State::BlockComment { depth } => match (c, next) {
                ('*', Some('/')) => {
                    state = match depth {
                        1 => State::Code,
                        _ => State::BlockComment { depth: depth - 1 },
                    };
                    i += 2;
                }
                ('/', Some('*')) => {
                    state = State::BlockComment { depth: depth + 1 };
                    i += 2;
                }
                _ => {
                    line.comment.push(c);
                    i += 1;
                }
            },
            State::Str => match c {
                // An escaped line break must still start a new line.
                '\\' if next != Some('\n') => {
                    line.code.push_str("  ");
                    i += 2;
                }
                '"' => {
                    line.code.push('"');
                    state = State::Code;
                    i += 1;
                }
                _ => {
                    line.code.push(' ');
                    i += 1;
                }
            },
            State::RawStr { hashes } => {
                let closes = c == '"'
                    && chars[i + 1..]
                        .iter()
                        .take(hashes)
                        .filter(|&&c| c == '#')
                        .count()
                        == hashes;
                if closes {
                    line.code.push('"');
                    state = State::Code;
                    i += hashes + 1;
                } else {
                    line.code.push(' ');
                    i += 1;
                }
            }
        }
    }
    lines
}

fn ends_in_word(code: &str) -> bool {
    code.ends_with(|c: char| c.is_alphanumeric() || c == '_')
}

/// How many characters the literal at the start takes; 1 for the quote of a lifetime.
fn char_literal_length(chars: &[char]) -> usize {
    match (chars.get(1), chars.get(2)) {
        (Some('\\'), Some(_)) => {
            // The escaped character itself may be a quote.
            chars
                .iter()
                .skip(3)
                .position(|&c| c == '\'')
                .map_or(1, |at| at + 4)
        }
        (Some(_), Some('\'')) => 3,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(source: &str, code: &[&str], comments: &[&str]) {
        let lines = split(source);
        let got: Vec<&str> = lines.iter().map(|line| line.code.trim()).collect();
        assert_eq!(got, code);
        let got: Vec<&str> = lines.iter().map(|line| line.comment.trim()).collect();
        assert_eq!(got, comments);
    }

    #[test]
    fn comments_leave_the_code() {
        check(
            "let a = 1; // why\n/// doc\nb();",
            &["let a = 1;", "", "b();"],
            &["why", "doc", ""],
        );
        check("a /* x /* y */ z */ b", &["a  b"], &["x  y  z"]);
        check("a /* x\ny */ b", &["a", "b"], &["x", "y"]);
    }

    #[test]
    fn string_contents_are_blank() {
        check(
            r#"f("// no \" ok"); g()"#,
            &[r#"f("           "); g()"#],
            &[""],
        );
        check("f(r#\"\" // no\"#); g()", &["f(r\"       \"); g()"], &[""]);
        check("f(br\"x\", b\"//\")", &["f(br\" \", b\"  \")"], &[""]);
        check("\"a\\\nb\" c", &["\"", "\" c"], &["", ""]);
    }

    #[test]
    fn quotes_of_characters_and_lifetimes() {
        check(
            "('\"', '\\'', '\\u{7f}', x)",
            &["(' ', ' ', ' ', x)"],
            &[""],
        );
        check(
            "fn f<'a>(x: &'a str) {} // c",
            &["fn f<'a>(x: &'a str) {}"],
            &["c"],
        );
    }

    #[test]
    fn doc_is_told_from_comment() {
        let docs: Vec<bool> = split("// a\n/// b\n//! c\n//// d\n/** e */")
            .iter()
            .map(|line| line.is_doc)
            .collect();
        assert_eq!(docs, [false, true, true, false, true]);
    }
}
