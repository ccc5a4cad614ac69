use std::borrow::Cow;

use crate::cursor::{Cursor, is_newline, is_space, text};
use crate::skeleton::MAX_JOINTS;
use crate::warning::Oddities;
use crate::{
    Axis, AxisFrame, Channel, LengthUnit, ParseError, ParseErrorKind, Skeleton, Warning,
    WarningKind,
};

/// The unit of the angles in an Acclaim file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AngleUnit {
    /// 360 to the turn.
    Degrees,
    /// 2π to the turn.
    Radians,
}

impl AngleUnit {
    pub(crate) fn to_degrees(self, value: f64) -> f64 {
        match self {
            AngleUnit::Degrees => value,
            AngleUnit::Radians => value.to_degrees(),
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            AngleUnit::Degrees => "degrees",
            AngleUnit::Radians => "radians",
        }
    }
}

/// An ASF file.
#[derive(Clone, Debug, PartialEq)]
pub struct Asf {
    /// The name behind `:name`; empty if there is none.
    pub name: String,
    /// Bones as joints; the first is called `root`. Angles are in degrees, offsets in file units.
    pub skeleton: Skeleton,
    /// Metres per file unit: 1/`length` inch (spec.md f).
    pub unit: LengthUnit,
    /// The unit of the angles in the file, and in motions that do not say their own.
    pub angle_unit: AngleUnit,
    /// What was odd, in file order.
    pub warnings: Vec<Warning>,
}

const DOFS: &str = "tx, ty, tz, rx, ry, rz and l";

/// Reads an ASF file.
///
/// Sections may come in any order, bones may be defined and connected in any order, directions need
/// not be normalised; masses and limits are skipped. Unknown sections and keywords are skipped, too,
/// a bone that the hierarchy does not name is left out, a unit that is not said is an inch or a degree,
/// a length that is not said is zero: each with a warning. A `#` at the start of a word begins a
/// comment.
///
/// O(bytes), in time and in memory.
///
/// # Errors
/// [`ParseError`] with line and column.
pub fn parse_asf(bytes: &[u8]) -> Result<Asf, ParseError> {
    Cursor::new(bytes).check_encoding()?;
    let text_only = without_comments(bytes);
    let mut reader = Reader::new(&text_only);
    while reader.next_content_line() {
        let at = reader.cursor.byte();
        let word = reader.cursor.word().to_ascii_lowercase();
        match word.as_slice() {
            b":version" | b":documentation" => reader.skip_section(),
            b":name" => reader.name = text(reader.cursor.line_text(None)),
            b":units" => {
                reader.units_at = at;
                reader.parse_units()?;
            }
            b":root" => reader.parse_root()?,
            b":bonedata" => reader.parse_bones()?,
            b":hierarchy" => reader.parse_hierarchy()?,
            [b':', name @ ..] => {
                let name = text(name);
                reader
                    .oddities
                    .push(at, WarningKind::UnknownSection { name });
                reader.skip_section();
            }
            // Text between sections means nothing: the rest of a section that was read in full.
            _ => {}
        }
        reader.cursor.next_line();
    }
    reader.finish()
}

/// The same text with comments replaced by blanks.
fn without_comments(bytes: &[u8]) -> Cow<'_, [u8]> {
    if !bytes.contains(&b'#') {
        return Cow::Borrowed(bytes);
    }
    let mut text_only = bytes.to_vec();
    let (mut in_comment, mut at_word) = (false, true);
    for byte in &mut text_only {
        in_comment = !is_newline(*byte) && (in_comment || at_word && *byte == b'#');
        at_word = is_space(*byte);
        if in_comment {
            *byte = b' ';
        }
    }
    Cow::Owned(text_only)
}

/// A bone as it stands in the file: lengths and angles in file units.
struct Bone {
    at: usize,
    name: String,
    direction: [f64; 3],
    length: Option<f64>,
    axis: AxisFrame,
    dofs: Vec<Channel>,
}

/// A line of the hierarchy. Names come with their places.
struct Family {
    parent: (String, usize),
    children: Vec<(String, usize)>,
}

struct Reader<'a> {
    cursor: Cursor<'a>,
    name: String,
    /// Where `:units` stands.
    units_at: usize,
    unit: Option<LengthUnit>,
    angle_unit: Option<AngleUnit>,
    root: Option<Bone>,
    bones: Vec<Bone>,
    families: Vec<Family>,
    oddities: Oddities,
}

impl<'a> Reader<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Reader {
            cursor: Cursor::new(bytes),
            name: String::new(),
            units_at: 0,
            unit: None,
            angle_unit: None,
            root: None,
            bones: Vec::new(),
            families: Vec::new(),
            oddities: Oddities::default(),
        }
    }

    /// Moves to the first word of the next line that is not empty.
    fn next_content_line(&mut self) -> bool {
        self.cursor.skip_space();
        !self.cursor.at_end()
    }

    /// Moves to the first word of the next line of this section; `false` at the next section.
    fn next_section_line(&mut self) -> bool {
        self.cursor.next_line();
        self.next_content_line() && self.cursor.peek() != Some(b':')
    }

    /// Leaves the cursor before the line end that precedes the next section.
    fn skip_section(&mut self) {
        let mut before = self.cursor.clone();
        while self.next_section_line() {
            before = self.cursor.clone();
        }
        self.cursor = before;
    }

    fn parse_units(&mut self) -> Result<(), ParseError> {
        let mut before = self.cursor.clone();
        while self.next_section_line() {
            let word_at = self.cursor.byte();
            let word = self.cursor.word().to_ascii_lowercase();
            self.cursor.skip_blanks();
            let at = self.cursor.byte();
            match word.as_slice() {
                b"length" => {
                    let length = self.cursor.required_number()?;
                    let unit = LengthUnit::from_acclaim_length(length).ok_or_else(|| {
                        self.out_of_range(at, "the length unit", "positive", length)
                    })?;
                    self.unit = Some(unit);
                }
                b"angle" => {
                    let angle = self.cursor.word().to_ascii_lowercase();
                    let unit = match angle.as_slice() {
                        b"deg" | b"degree" | b"degrees" => AngleUnit::Degrees,
                        b"rad" | b"radian" | b"radians" => AngleUnit::Radians,
                        other => return Err(self.unknown(at, "angle unit", other, "deg and rad")),
                    };
                    self.angle_unit = Some(unit);
                }
                b"mass" => {}
                other => self.skip_keyword(word_at, other),
            }
            before = self.cursor.clone();
        }
        self.cursor = before;
        Ok(())
    }

    fn parse_root(&mut self) -> Result<(), ParseError> {
        let mut root = Bone {
            at: self.cursor.byte(),
            name: "root".to_owned(),
            direction: [0.0; 3],
            length: Some(0.0),
            axis: AxisFrame::xyz([0.0; 3]),
            dofs: Vec::new(),
        };
        let mut before = self.cursor.clone();
        while self.next_section_line() {
            let at = self.cursor.byte();
            let word = self.cursor.word().to_ascii_lowercase();
            match word.as_slice() {
                b"order" => root.dofs = self.parse_dofs()?,
                b"axis" => {
                    self.cursor.skip_blanks();
                    root.axis.order = self.parse_axis_order()?;
                }
                b"position" => root.direction = self.parse_vector()?,
                b"orientation" => root.axis.degrees = self.parse_vector()?,
                other => self.skip_keyword(at, other),
            }
            before = self.cursor.clone();
        }
        self.cursor = before;
        self.root = Some(root);
        Ok(())
    }

    fn parse_bones(&mut self) -> Result<(), ParseError> {
        let mut before = self.cursor.clone();
        let mut open: Option<Bone> = None;
        while self.next_section_line() {
            let at = self.cursor.byte();
            let word = self.cursor.word().to_ascii_lowercase();
            match (word.as_slice(), &mut open) {
                (b"begin", None) if self.bones.len() + 1 >= MAX_JOINTS => {
                    return Err(self.too_many(at, "bones"));
                }
                (b"begin", None) => {
                    open = Some(Bone {
                        at,
                        name: String::new(),
                        direction: [0.0; 3],
                        length: None,
                        axis: AxisFrame::xyz([0.0; 3]),
                        dofs: Vec::new(),
                    });
                }
                (b"begin", Some(_)) => {
                    self.cursor = before;
                    self.next_section_line();
                    return Err(self.cursor.expected("end"));
                }
                (b"end", Some(_)) => self.bones.extend(open.take()),
                (b"name", Some(bone)) => bone.name = text(self.cursor.line_text(None)),
                (b"direction", Some(bone)) => bone.direction = self.parse_vector()?,
                (b"length", Some(bone)) => bone.length = Some(self.parse_length()?),
                (b"axis", Some(bone)) => {
                    bone.axis.degrees = self.parse_vector()?;
                    self.cursor.skip_blanks();
                    if !self.cursor.at_line_end() {
                        bone.axis.order = self.parse_axis_order()?;
                    }
                }
                (b"dof", Some(bone)) => bone.dofs = self.parse_dofs()?,
                (b"id" | b"bodymass" | b"cofmass" | b"limits", Some(_)) => {}
                (other, Some(_)) => self.skip_keyword(at, other),
                (_, None) => {
                    self.cursor = before;
                    self.next_section_line();
                    return Err(self.cursor.expected("begin or a section"));
                }
            }
            before = self.cursor.clone();
        }
        if open.is_some() {
            return Err(self.cursor.expected("end"));
        }
        self.cursor = before;
        Ok(())
    }

    /// Skips a line that begins with a word the format does not have, or continues `limits`.
    fn skip_keyword(&mut self, at: usize, word: &[u8]) {
        let is_limit = word.starts_with(b"inf");
        if word.first().is_some_and(u8::is_ascii_alphabetic) && !is_limit {
            let name = text(word);
            self.oddities
                .push_once(at, WarningKind::UnknownAsfKeyword { name });
        }
    }

    fn too_many(&self, at: usize, what: &'static str) -> ParseError {
        let limit = MAX_JOINTS;
        let kind = ParseErrorKind::TooMany { what, limit };
        self.cursor.error_at(at, kind)
    }

    fn parse_length(&mut self) -> Result<f64, ParseError> {
        self.cursor.skip_blanks();
        let at = self.cursor.byte();
        let length = self.cursor.required_number()?;
        if length < 0.0 {
            return Err(self.out_of_range(at, "a bone's length", "not negative", length));
        }
        Ok(length)
    }

    fn parse_hierarchy(&mut self) -> Result<(), ParseError> {
        let mut n_children = 0;
        let mut before = self.cursor.clone();
        while self.next_section_line() {
            let at = self.cursor.byte();
            let parent = (text(self.cursor.word()), at);
            let mut children = Vec::new();
            self.cursor.skip_blanks();
            while !matches!(parent.0.as_str(), "begin" | "end") && !self.cursor.at_line_end() {
                let at = self.cursor.byte();
                n_children += 1;
                if n_children > MAX_JOINTS {
                    return Err(self.too_many(at, "children in the hierarchy"));
                }
                children.push((text(self.cursor.word()), at));
                self.cursor.skip_blanks();
            }
            if !children.is_empty() {
                self.families.push(Family { parent, children });
            }
            before = self.cursor.clone();
        }
        self.cursor = before;
        Ok(())
    }

    fn parse_vector(&mut self) -> Result<[f64; 3], ParseError> {
        let mut vector = [0.0; 3];
        for value in &mut vector {
            *value = self.cursor.required_number()?;
        }
        Ok(vector)
    }

    fn parse_dofs(&mut self) -> Result<Vec<Channel>, ParseError> {
        let mut dofs = Vec::new();
        loop {
            self.cursor.skip_blanks();
            let at = self.cursor.byte();
            if self.cursor.at_line_end() {
                return Ok(dofs);
            }
            let word = self.cursor.word();
            let Some(dof) = dof_from_word(word) else {
                return Err(self.unknown(at, "degree of freedom", word, DOFS));
            };
            if dofs.contains(&dof) {
                let (what, name) = ("degree of freedom", text(word));
                return Err(self
                    .cursor
                    .error_at(at, ParseErrorKind::Twice { what, name }));
            }
            dofs.push(dof);
        }
    }

    fn parse_axis_order(&mut self) -> Result<[Axis; 3], ParseError> {
        let at = self.cursor.byte();
        let word = self.cursor.word();
        let letters: Vec<Axis> = word.iter().filter_map(|&b| axis_from_letter(b)).collect();
        match <[Axis; 3]>::try_from(letters) {
            Ok(order) if word.len() == 3 && Axis::ALL.iter().all(|a| order.contains(a)) => {
                Ok(order)
            }
            _ => Err(self.unknown(at, "axis order", word, "XYZ and its permutations")),
        }
    }

    fn unknown(
        &self,
        at: usize,
        what: &'static str,
        found: &[u8],
        known: &'static str,
    ) -> ParseError {
        let found = text(found);
        self.cursor
            .error_at(at, ParseErrorKind::UnknownKeyword { what, found, known })
    }

    fn out_of_range(
        &self,
        at: usize,
        what: &'static str,
        limit: &'static str,
        found: f64,
    ) -> ParseError {
        let found = found.to_string();
        self.cursor
            .error_at(at, ParseErrorKind::OutOfRange { what, limit, found })
    }
}

fn axis_from_letter(letter: u8) -> Option<Axis> {
    match letter.to_ascii_uppercase() {
        b'X' => Some(Axis::X),
        b'Y' => Some(Axis::Y),
        b'Z' => Some(Axis::Z),
        _ => None,
    }
}

fn dof_from_word(word: &[u8]) -> Option<Channel> {
    match word {
        [b'l' | b'L'] => Some(Channel::Length),
        [b't' | b'T', axis] => axis_from_letter(*axis).map(Channel::Translation),
        [b'r' | b'R', axis] => axis_from_letter(*axis).map(Channel::Rotation),
        _ => None,
    }
}

mod assemble;
pub(crate) use assemble::nearest;

#[cfg(test)]
mod tests;
