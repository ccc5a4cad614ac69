//! From statements to a scene.

use mocap_io::Position;
use relfeat::{BUILTIN_SETS, FeatureSet};
use segidx::RunRef;

use super::tokens::{Statement, Token, statements};
use super::{Line, Relation, RelationKind, SceneText, SceneTextError, SceneTextErrorKind};
use crate::selection::nearest;

use SceneTextErrorKind as Kind;

const A_STATEMENT: &str = "`FEATURE : 0 1 …`, overlap, before or within";

/// Understands a scene description about the features of `set`.
///
/// # Errors
/// The first statement that is none, or that names what does not exist.
pub fn parse(text: &str, set: &FeatureSet) -> Result<SceneText, SceneTextError> {
    let mut parser = Parser {
        text,
        set,
        line_starts: Vec::new(),
        scene: SceneText {
            lines: Vec::new(),
            relations: Vec::new(),
            max_seconds: None,
            notes: Vec::new(),
        },
    };
    // Relations may stand before the lines they refer to.
    let (lines, others): (Vec<_>, Vec<_>) = statements(text)
        .into_iter()
        .partition(|s| s.tokens.iter().any(|t| t.text == ":"));
    for statement in &lines {
        parser.line(&mut Reader::new(text, statement))?;
    }
    for statement in &others {
        parser.relation(&mut Reader::new(text, statement))?;
    }
    if parser.scene.lines.is_empty() {
        return Err(fail(text, text.len(), Kind::NoLines));
    }
    Ok(parser.scene)
}

fn fail(text: &str, byte: usize, kind: Kind) -> SceneTextError {
    let at = Position::locate(text.as_bytes(), byte);
    SceneTextError { at, kind }
}

/// The words of a statement, one after the other.
struct Reader<'a> {
    text: &'a str,
    statement: &'a Statement<'a>,
    next: usize,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str, statement: &'a Statement<'a>) -> Reader<'a> {
        Reader {
            text,
            statement,
            next: 0,
        }
    }

    fn peek(&self) -> Option<Token<'a>> {
        self.statement.tokens.get(self.next).copied()
    }

    fn expected(&self, expected: &'static str) -> SceneTextError {
        let (byte, found) = match self.peek() {
            Some(token) => (token.byte, format!("{:?}", token.text)),
            None => (self.statement.end, "the end of the statement".to_owned()),
        };
        fail(self.text, byte, Kind::Expected { expected, found })
    }

    /// The next word if `read` makes something of it.
    fn take<T>(
        &mut self,
        expected: &'static str,
        read: impl FnOnce(&'a str) -> Option<T>,
    ) -> Result<(Token<'a>, T), SceneTextError> {
        let token = self.peek().ok_or_else(|| self.expected(expected))?;
        let value = read(token.text).ok_or_else(|| self.expected(expected))?;
        self.next += 1;
        Ok((token, value))
    }

    fn word(&mut self, expected: &'static str) -> Result<Token<'a>, SceneTextError> {
        let is_word = |text: &str| !matches!(text, ":" | "[" | "]");
        let (token, ()) = self.take(expected, |text| is_word(text).then_some(()))?;
        Ok(token)
    }

    fn symbol(&mut self, expected: &'static str, symbol: &str) -> Result<(), SceneTextError> {
        self.take(expected, |text| (text == symbol).then_some(()))?;
        Ok(())
    }

    fn end(&self) -> Result<(), SceneTextError> {
        match self.peek() {
            Some(_) => Err(self.expected("the end of the statement, which is a line's or a `;`")),
            None => Ok(()),
        }
    }
}

struct Parser<'a> {
    text: &'a str,
    set: &'a FeatureSet,
    /// Where the name of each line stands.
    line_starts: Vec<usize>,
    scene: SceneText,
}

impl Parser<'_> {
    /// `FEATURE [as NAME] : VALUES`
    fn line(&mut self, reader: &mut Reader<'_>) -> Result<(), SceneTextError> {
        let feature = reader.word("a feature")?;
        let name = if reader.peek().is_some_and(|t| t.text == "as") {
            reader.next += 1;
            reader.word("a name for the line")?
        } else {
            feature
        };
        reader.symbol("`:`, or `as` and a name for the line", ":")?;
        let feature_idx = self.feature(feature)?;
        let twin = self.scene.lines.iter().position(|l| l.name == name.text);
        if let Some(twin) = twin {
            let first = Position::locate(self.text.as_bytes(), self.line_starts[twin]);
            let kind = Kind::Twice {
                name: name.text.to_owned(),
                first_line: first.line().unwrap_or(1),
            };
            return Err(fail(self.text, name.byte, kind));
        }
        let mut values = Vec::new();
        while values.is_empty() || reader.peek().is_some() {
            values.push(reader.take("0, 1 or *", |text| match text {
                "0" => Some(Some(false)),
                "1" => Some(Some(true)),
                "*" => Some(None),
                _ => None,
            })?);
        }
        self.check_values(&values)?;
        self.line_starts.push(name.byte);
        self.scene.lines.push(Line {
            name: name.text.to_owned(),
            feature_idx,
            values: values.into_iter().map(|(_, value)| value).collect(),
        });
        Ok(())
    }

    fn check_values(&mut self, values: &[(Token<'_>, Option<bool>)]) -> Result<(), SceneTextError> {
        let is_value = |(_, value): &(Token<'_>, Option<bool>)| value.is_some();
        let bounds = (
            values.iter().position(is_value),
            values.iter().rposition(is_value),
        );
        let (Some(first), Some(last)) = bounds else {
            let byte = values.first().map_or(0, |(token, _)| token.byte);
            return Err(fail(self.text, byte, Kind::Unspecified));
        };
        for pair in values[first..=last].windows(2) {
            let [(_, before), (token, value)] = pair else {
                continue;
            };
            if value.is_none() {
                return Err(fail(self.text, token.byte, Kind::Wildcard));
            }
            if before == value {
                let at = Position::locate(self.text.as_bytes(), token.byte);
                let note = format!("{} twice in a row is one run", token.text);
                self.scene.notes.push((at, note));
            }
        }
        Ok(())
    }

    fn feature(&self, token: Token<'_>) -> Result<usize, SceneTextError> {
        let found = token.text.to_owned();
        let kind = match self.set.select(token.text) {
            Some(bits) if bits.count_ones() == 1 => return Ok(bits.trailing_zeros() as usize),
            Some(bits) => Kind::ManyFeatures {
                found,
                n_features: bits.count_ones(),
            },
            None => {
                let has = |name: &&&str| {
                    let set = FeatureSet::builtin(name);
                    set.is_some_and(|set| set.features().iter().any(|f| f.name == token.text))
                };
                let names = self.set.features().iter().map(|f| f.name.as_str());
                Kind::UnknownFeature {
                    set: self.set.name().to_owned(),
                    nearest: nearest(&found, names).unwrap_or_default().to_owned(),
                    elsewhere: BUILTIN_SETS.iter().find(has).copied(),
                    found,
                }
            }
        };
        Err(fail(self.text, token.byte, kind))
    }

    /// `overlap A[i] B[j]`, `before A[i] B[j]`, `within TIME A[i] B[j]` or `within TIME`
    fn relation(&mut self, reader: &mut Reader<'_>) -> Result<(), SceneTextError> {
        let (keyword, kind) = reader.take(A_STATEMENT, |text| match text {
            "overlap" => Some(Some(RelationKind::Overlap)),
            "before" => Some(Some(RelationKind::Before)),
            "within" => Some(None),
            _ => None,
        })?;
        let kind = match kind {
            Some(kind) => kind,
            None => {
                let (_, seconds) = reader.take("a time such as 1.5s or 250ms", seconds)?;
                if reader.peek().is_none() {
                    let max = self.scene.max_seconds.map_or(seconds, |m| m.min(seconds));
                    self.scene.max_seconds = Some(max);
                    return Ok(());
                }
                RelationKind::Within(seconds)
            }
        };
        let (a, b) = (self.run(reader)?, self.run(reader)?);
        reader.end()?;
        if a.line == b.line {
            self.check_order(keyword, kind, [a, b])?;
        }
        self.scene.relations.push(Relation { kind, a, b });
        Ok(())
    }

    /// `NAME [ POSITION ]`
    fn run(&self, reader: &mut Reader<'_>) -> Result<RunRef, SceneTextError> {
        let token = reader.word("a run such as rknee_bent[2]")?;
        reader.symbol("`[` and a position", "[")?;
        let (number, ()) = reader.take("a position from 1 on", |text| {
            text.bytes().all(|b| b.is_ascii_digit()).then_some(())
        })?;
        reader.symbol("`]`", "]")?;
        let lines = &self.scene.lines;
        let Some(line) = lines.iter().position(|line| line.name == token.text) else {
            let found = token.text.to_owned();
            let names = lines.iter().map(|line| line.name.as_str());
            let kind = match nearest(&found, names) {
                Some(name) => Kind::UnknownLine {
                    nearest: name.to_owned(),
                    found,
                },
                None => Kind::NoLines,
            };
            return Err(fail(self.text, token.byte, kind));
        };
        let n_positions = lines[line].values.len();
        let position = number
            .text
            .parse()
            .ok()
            .filter(|p| (1..=n_positions).contains(p));
        let Some(position) = position else {
            let kind = Kind::Position {
                name: token.text.to_owned(),
                n_positions,
                found: number.text.to_owned(),
            };
            return Err(fail(self.text, number.byte, kind));
        };
        Ok(RunRef {
            line,
            position: position - 1,
        })
    }

    /// Of one line, only a run itself overlaps it, and only earlier runs are before it.
    fn check_order(
        &self,
        keyword: Token<'_>,
        kind: RelationKind,
        [a, b]: [RunRef; 2],
    ) -> Result<(), SceneTextError> {
        let Line { name, values, .. } = &self.scene.lines[a.line];
        let (from, to) = (a.position.min(b.position), a.position.max(b.position));
        let is_one_run = values[from..=to].windows(2).all(|pair| pair[0] == pair[1]);
        let (relation, can_hold) = match kind {
            RelationKind::Overlap => ("overlap", is_one_run),
            RelationKind::Before => ("before", a.position < b.position && !is_one_run),
            RelationKind::Within(_) => ("within", true),
        };
        if can_hold {
            return Ok(());
        }
        let name = name.clone();
        Err(fail(
            self.text,
            keyword.byte,
            Kind::Never { relation, name },
        ))
    }
}

/// A duration with its unit, in seconds.
fn seconds(text: &str) -> Option<f64> {
    let (number, factor) = match text.strip_suffix("ms") {
        Some(number) => (number, 1e-3),
        None => (text.strip_suffix('s')?, 1.0),
    };
    // `parse` would take names of infinity, and signs.
    let is_plain = number.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    let number: f64 = is_plain.then(|| number.parse().ok()).flatten()?;
    Some(number * factor).filter(|s| s.is_finite())
}
