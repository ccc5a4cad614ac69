use std::collections::HashSet;

use super::parse::{at_comment, skip_comments};
use crate::cursor::{Cursor, Lexed, is_blank, quote, text};
use crate::skeleton::MAX_JOINTS;
use crate::warning::Oddities;
use crate::{Axis, Channel, Joint, OffsetFrame, ParseError, ParseErrorKind, Skeleton, WarningKind};

const CHANNELS: &str = "Xposition, Yposition, Zposition, Xrotation, Yrotation and Zrotation";

/// What a number of a row is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Column {
    Channel(Channel),
    /// A scale factor, which a skeleton has no place for.
    Scale,
}

/// The joints of a file and the columns of its rows.
#[derive(Default)]
pub(super) struct Hierarchy {
    /// Without channels.
    joints: Vec<Joint>,
    /// Per joint.
    columns: Vec<Vec<Column>>,
    /// Per joint.
    n_end_sites: Vec<usize>,
}

impl Hierarchy {
    /// Of all joints, in the order of the rows.
    pub(super) fn columns(&self) -> impl Iterator<Item = Column> {
        self.columns.iter().flatten().copied()
    }

    pub(super) fn into_skeleton(mut self, cursor: &Cursor<'_>) -> Result<Skeleton, ParseError> {
        for (joint, columns) in self.joints.iter_mut().zip(&self.columns) {
            let channels = columns.iter().filter_map(|&column| match column {
                Column::Channel(channel) => Some(channel),
                Column::Scale => None,
            });
            joint.channels = channels.collect();
        }
        Skeleton::new(self.joints, OffsetFrame::Parent).map_err(|_| {
            // Every number was checked and every parent was open when its child was read.
            cursor.error_at(0, ParseErrorKind::Missing { what: "hierarchy" })
        })
    }

    fn push(
        &mut self,
        cursor: &Cursor<'_>,
        name: String,
        parent: Option<usize>,
        end_site: bool,
    ) -> Result<usize, ParseError> {
        if self.joints.len() == MAX_JOINTS {
            let (what, limit) = ("joints", MAX_JOINTS);
            let kind = ParseErrorKind::TooMany { what, limit };
            return Err(cursor.error_at(cursor.byte(), kind));
        }
        self.joints.push(Joint {
            name,
            parent,
            offset: [0.0; 3],
            channels: Vec::new(),
            axis: None,
            end_site,
        });
        self.columns.push(Vec::new());
        self.n_end_sites.push(0);
        Ok(self.joints.len() - 1)
    }
}

/// Reads all trees, up to what comes after them.
pub(super) fn parse_hierarchy(
    cursor: &mut Cursor<'_>,
    oddities: &mut Oddities,
) -> Result<Hierarchy, ParseError> {
    find_hierarchy(cursor, oddities)?;
    let mut reader = Reader {
        cursor,
        oddities,
        tree: Hierarchy::default(),
    };
    loop {
        skip_comments(reader.cursor, reader.oddities);
        if reader.take("ROOT") {
            reader.parse_tree()?;
        } else if reader.tree.joints.is_empty() {
            return Err(reader.cursor.expected("ROOT"));
        } else if reader.cursor.peek() == Some(b'}') {
            let at = reader.cursor.byte();
            reader.oddities.push_once(at, WarningKind::ExtraBrace);
            reader.cursor.advance(1);
        } else {
            return Ok(reader.tree);
        }
    }
}

/// Moves behind HIERARCHY, or before ROOT where that comes first.
fn find_hierarchy(cursor: &mut Cursor<'_>, oddities: &mut Oddities) -> Result<(), ParseError> {
    const HIERARCHY: &str = "HIERARCHY";
    skip_comments(cursor, oddities);
    let start = cursor.clone();
    let is_root = |word: &[u8]| word.eq_ignore_ascii_case(b"ROOT");
    if is_root(start.peek_keyword()) {
        let keyword = HIERARCHY;
        oddities.push(start.byte(), WarningKind::MissingKeyword { keyword });
        return Ok(());
    }
    while !cursor.at_end() {
        cursor.skip_blanks();
        if cursor
            .peek_keyword()
            .eq_ignore_ascii_case(HIERARCHY.as_bytes())
        {
            if cursor.byte() > start.byte() {
                let found = quote(start.clone().line_text(None));
                oddities.push_once(start.byte(), WarningKind::SkippedText { found });
            }
            cursor.advance(HIERARCHY.len());
            return Ok(());
        }
        cursor.next_line();
    }
    Err(start.expected(HIERARCHY))
}

struct Reader<'r, 'a> {
    cursor: &'r mut Cursor<'a>,
    oddities: &'r mut Oddities,
    tree: Hierarchy,
}

/// A joint or End Site whose closing brace is still to come.
struct Open {
    joint_idx: usize,
    has_offset: bool,
    at: usize,
}

impl<'a> Reader<'_, 'a> {
    /// Takes `keyword`, in any case, if it comes next.
    fn take(&mut self, keyword: &str) -> bool {
        let is_next = self
            .cursor
            .peek_keyword()
            .eq_ignore_ascii_case(keyword.as_bytes());
        if is_next {
            self.cursor.advance(keyword.len());
        }
        is_next
    }

    /// Reads one tree from behind its ROOT keyword. An explicit stack keeps deep files from exhausting
    /// the call stack.
    fn parse_tree(&mut self) -> Result<(), ParseError> {
        let mut names = HashSet::new();
        let mut open = vec![self.open_joint(None, &mut names)?];
        while let Some(current) = open.last_mut() {
            let joint_idx = current.joint_idx;
            let in_end_site = self.tree.joints[joint_idx].end_site;
            skip_comments(self.cursor, self.oddities);
            let at = self.cursor.byte();
            if self.cursor.peek() == Some(b'}') {
                self.cursor.advance(1);
                self.close(open.pop());
            } else if self.take("OFFSET") {
                self.parse_offset(current)?;
            } else if self.take("CHANNELS") {
                self.parse_channels(joint_idx, at)?;
            } else if !in_end_site && self.take("JOINT") {
                open.push(self.open_joint(Some(joint_idx), &mut names)?);
            } else if !in_end_site && (self.take("End") || self.take("EndSite")) {
                open.push(self.open_end_site(joint_idx)?);
            } else if self.cursor.peek_keyword().eq_ignore_ascii_case(b"MOTION") {
                let n = open.len();
                self.oddities.push(at, WarningKind::MissingBraces { n });
                while !open.is_empty() {
                    self.close(open.pop());
                }
            } else if in_end_site {
                return Err(self.cursor.expected("OFFSET or }"));
            } else {
                let expected = "OFFSET, CHANNELS, JOINT, End Site or }";
                return Err(self.cursor.expected(expected));
            }
        }
        Ok(())
    }

    fn close(&mut self, open: Option<Open>) {
        if let Some(open) = open.filter(|open| !open.has_offset) {
            let joint = self.tree.joints[open.joint_idx].name.clone();
            self.oddities
                .push_once(open.at, WarningKind::NoOffset { joint });
        }
    }

    fn open_joint(
        &mut self,
        parent: Option<usize>,
        names: &mut HashSet<String>,
    ) -> Result<Open, ParseError> {
        self.cursor.skip_blanks();
        let at = self.cursor.byte();
        let name = text(self.name_text());
        if name.is_empty() {
            return Err(self.cursor.expected("a joint name"));
        }
        self.take_brace()?;
        if !names.insert(name.clone()) {
            let name = name.clone();
            self.oddities.push(at, WarningKind::DuplicateName { name });
        }
        let joint_idx = self.tree.push(self.cursor, name, parent, false)?;
        Ok(Open {
            joint_idx,
            has_offset: false,
            at,
        })
    }

    /// The rest of the line before a brace or a comment. A comment has blanks around it, since names
    /// may have any sign in them.
    fn name_text(&mut self) -> &'a [u8] {
        let line_at = self.cursor.byte();
        let line = self.cursor.line_text(Some(b'{'));
        let Some(n) = comment_in_name(line) else {
            return line;
        };
        self.oddities.push_once(line_at + n, WarningKind::Comment);
        // A brace within the comment opens nothing.
        if self.cursor.peek() == Some(b'{') {
            self.cursor.next_line();
        }
        let n_name = line[..n].iter().rposition(|&b| !is_blank(b));
        &line[..n_name.map_or(0, |last| last + 1)]
    }

    fn open_end_site(&mut self, parent: usize) -> Result<Open, ParseError> {
        let at = self.cursor.byte();
        // `Site`, and the name that some exporters write behind it.
        self.name_text();
        self.take_brace()?;
        self.tree.n_end_sites[parent] += 1;
        let number = match self.tree.n_end_sites[parent] {
            1 => String::new(),
            n => n.to_string(),
        };
        let name = format!("{}_End{number}", self.tree.joints[parent].name);
        let joint_idx = self.tree.push(self.cursor, name, Some(parent), true)?;
        Ok(Open {
            joint_idx,
            has_offset: false,
            at,
        })
    }

    fn take_brace(&mut self) -> Result<(), ParseError> {
        skip_comments(self.cursor, self.oddities);
        if self.cursor.peek() != Some(b'{') {
            return Err(self.cursor.expected("{"));
        }
        self.cursor.advance(1);
        Ok(())
    }

    /// A number, on this line or a following one. It may touch the one before it if it has a sign.
    fn number(&mut self, touches: bool) -> Result<f64, ParseError> {
        if touches && !self.cursor.at_white_space() && !at_comment(self.cursor) {
            self.oddities
                .push_once(self.cursor.byte(), WarningKind::GluedNumbers);
        }
        skip_comments(self.cursor, self.oddities);
        match self.cursor.lex_number() {
            Lexed::Number(value) => Ok(value),
            Lexed::LineEnd | Lexed::Wrong => Err(self.cursor.number_error()),
        }
    }

    fn parse_offset(&mut self, open: &mut Open) -> Result<(), ParseError> {
        if open.has_offset {
            let kind = WarningKind::Repeated {
                keyword: "OFFSET",
                resolution: "the last one counts",
            };
            self.oddities.push_once(self.cursor.byte(), kind);
        }
        open.has_offset = true;
        let mut offset = [0.0; 3];
        for (i, value) in offset.iter_mut().enumerate() {
            *value = self.number(i > 0)?;
        }
        self.tree.joints[open.joint_idx].offset = offset;
        Ok(())
    }

    /// Reads the number of channels and their names behind the keyword at `keyword_at`.
    fn parse_channels(&mut self, joint_idx: usize, keyword_at: usize) -> Result<(), ParseError> {
        skip_comments(self.cursor, self.oddities);
        let count_at = self.cursor.byte();
        let declared = match self.cursor.peek() {
            Some(b) if b.is_ascii_alphabetic() && !self.cursor.at_not_finite() => None,
            _ => Some(self.number(false)?),
        };
        if let Some(found) = declared.filter(|n| n.fract() != 0.0 || *n < 0.0) {
            let kind = ParseErrorKind::OutOfRange {
                what: "the number of channels",
                limit: "a whole number, not negative",
                found: found.to_string(),
            };
            return Err(self.cursor.error_at(count_at, kind));
        }
        let is_short = |n: usize| declared.is_none_or(|declared| (n as f64) < declared);
        let mut n_listed = 0;
        loop {
            skip_comments(self.cursor, self.oddities);
            let at = self.cursor.byte();
            let word = self.cursor.peek_keyword();
            let Some(column) = column_from_word(word) else {
                if !is_short(n_listed) || ends_channels(word) && !self.cursor.at_end() {
                    break;
                }
                if self.cursor.at_end() {
                    return Err(self.cursor.expected("a channel"));
                }
                let (what, found, known) = ("channel", text(word), CHANNELS);
                let kind = ParseErrorKind::UnknownKeyword { what, found, known };
                return Err(self.cursor.error_at(at, kind));
            };
            self.push_column(joint_idx, column, at)?;
            self.cursor.advance(word.len());
            n_listed += 1;
        }
        let joint = &self.tree.joints[joint_idx];
        if declared != Some(n_listed as f64) {
            let kind = WarningKind::ChannelCount {
                joint: joint.name.clone(),
                header: declared.map(|n| n.to_string()),
                listed: n_listed,
            };
            self.oddities.push_once(count_at, kind);
        }
        let n_columns = self.tree.columns[joint_idx].len();
        if joint.end_site && n_columns > 0 {
            let kind = ParseErrorKind::OutOfRange {
                what: "the number of channels of an End Site",
                limit: "0",
                found: n_columns.to_string(),
            };
            return Err(self.cursor.error_at(count_at, kind));
        }
        if n_columns > n_listed {
            let kind = WarningKind::Repeated {
                keyword: "CHANNELS",
                resolution: "the lists were joined",
            };
            self.oddities.push_once(keyword_at, kind);
        }
        Ok(())
    }

    fn push_column(
        &mut self,
        joint_idx: usize,
        column: Column,
        at: usize,
    ) -> Result<(), ParseError> {
        let columns = &mut self.tree.columns[joint_idx];
        match column {
            Column::Channel(channel) if columns.contains(&column) => {
                let (what, name) = ("channel", channel.to_string());
                let kind = ParseErrorKind::Twice { what, name };
                return Err(self.cursor.error_at(at, kind));
            }
            Column::Channel(_) => {}
            Column::Scale => self.oddities.push_once(at, WarningKind::ScaleChannels),
        }
        columns.push(column);
        Ok(())
    }
}

/// Where a comment begins: behind a blank, `//`, or `#` and a blank.
pub(super) fn comment_in_name(line: &[u8]) -> Option<usize> {
    let is_comment = |w: &[u8]| {
        let begins = w[1..] == *b"//" || w[1] == b'#' && is_blank(w[2]);
        begins && is_blank(w[0])
    };
    line.windows(3).position(is_comment).map(|i| i + 1)
}

/// Whether a list of channels ends before this word, however many were announced.
fn ends_channels(word: &[u8]) -> bool {
    const NEXT: [&str; 8] = [
        "", "OFFSET", "CHANNELS", "JOINT", "ROOT", "End", "EndSite", "MOTION",
    ];
    NEXT.iter()
        .any(|next| word.eq_ignore_ascii_case(next.as_bytes()))
}

fn column_from_word(word: &[u8]) -> Option<Column> {
    let axis = match word.first()?.to_ascii_uppercase() {
        b'X' => Axis::X,
        b'Y' => Axis::Y,
        b'Z' => Axis::Z,
        _ => return None,
    };
    match word[1..].to_ascii_lowercase().as_slice() {
        b"position" => Some(Column::Channel(Channel::Translation(axis))),
        b"rotation" => Some(Column::Channel(Channel::Rotation(axis))),
        b"scale" => Some(Column::Scale),
        _ => None,
    }
}
