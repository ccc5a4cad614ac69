use std::collections::HashMap;

use crate::cursor::{Cursor, text};
use crate::error::Oddities;
use crate::{
    Axis, AxisFrame, Channel, Joint, LengthUnit, OffsetFrame, ParseError, ParseErrorKind, Skeleton,
    Warning, WarningKind,
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
/// not be normalised; masses, limits and unknown sections are skipped; a bone that the hierarchy does
/// not name is left out, with a warning. A `:units` section without
/// `length` counts as 1.
///
/// O(bytes).
///
/// # Errors
/// [`ParseError`] with line and column.
pub fn parse_asf(bytes: &[u8]) -> Result<Asf, ParseError> {
    let mut reader = Reader::new(bytes);
    while reader.next_content_line() {
        let at = reader.cursor.byte();
        let word = reader.cursor.word().to_ascii_lowercase();
        match word.as_slice() {
            b":version" | b":documentation" => reader.skip_section(),
            b":name" => reader.name = text(reader.cursor.line_text(None)),
            b":units" => reader.parse_units()?,
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

/// A bone as it stands in the file: lengths and angles in file units.
struct Bone {
    at: usize,
    name: String,
    direction: [f64; 3],
    length: f64,
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
    unit: LengthUnit,
    angle_unit: AngleUnit,
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
            unit: LengthUnit::INCH,
            angle_unit: AngleUnit::Degrees,
            root: None,
            bones: Vec::new(),
            families: Vec::new(),
            oddities: Oddities::default(),
        }
    }

    /// Moves to the first word of the next line that is neither empty nor a comment.
    fn next_content_line(&mut self) -> bool {
        loop {
            self.cursor.skip_space();
            match self.cursor.peek() {
                None => return false,
                Some(b'#') => self.cursor.next_line(),
                Some(_) => return true,
            }
        }
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
            let word = self.cursor.word().to_ascii_lowercase();
            self.cursor.skip_blanks();
            let at = self.cursor.byte();
            match word.as_slice() {
                b"length" => {
                    let length = self.cursor.required_number()?;
                    self.unit = LengthUnit::from_acclaim_length(length).ok_or_else(|| {
                        self.out_of_range(at, "the length unit", "positive", length)
                    })?;
                }
                b"angle" => {
                    let angle = self.cursor.word().to_ascii_lowercase();
                    self.angle_unit = match angle.as_slice() {
                        b"deg" | b"degree" | b"degrees" => AngleUnit::Degrees,
                        b"rad" | b"radian" | b"radians" => AngleUnit::Radians,
                        other => return Err(self.unknown(at, "angle unit", other, "deg and rad")),
                    };
                }
                _ => {}
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
            length: 0.0,
            axis: AxisFrame::xyz([0.0; 3]),
            dofs: Vec::new(),
        };
        let mut before = self.cursor.clone();
        while self.next_section_line() {
            let word = self.cursor.word().to_ascii_lowercase();
            match word.as_slice() {
                b"order" => root.dofs = self.parse_dofs()?,
                b"axis" => {
                    self.cursor.skip_blanks();
                    root.axis.order = self.parse_axis_order()?;
                }
                b"position" => root.direction = self.parse_vector()?,
                b"orientation" => root.axis.degrees = self.parse_vector()?,
                _ => {}
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
                (b"begin", None) => {
                    open = Some(Bone {
                        at,
                        name: String::new(),
                        direction: [0.0; 3],
                        length: 0.0,
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
                (b"length", Some(bone)) => bone.length = self.cursor.required_number()?,
                (b"axis", Some(bone)) => {
                    bone.axis.degrees = self.parse_vector()?;
                    self.cursor.skip_blanks();
                    if !self.cursor.at_line_end() {
                        bone.axis.order = self.parse_axis_order()?;
                    }
                }
                (b"dof", Some(bone)) => bone.dofs = self.parse_dofs()?,
                // Masses, limits, ids and their continuation lines.
                (_, Some(_)) => {}
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

    fn parse_hierarchy(&mut self) -> Result<(), ParseError> {
        let mut before = self.cursor.clone();
        while self.next_section_line() {
            let at = self.cursor.byte();
            let parent = (text(self.cursor.word()), at);
            let mut children = Vec::new();
            self.cursor.skip_blanks();
            while !matches!(parent.0.as_str(), "begin" | "end") && !self.cursor.at_line_end() {
                let at = self.cursor.byte();
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

    /// Orders the bones depth first and makes them a skeleton.
    fn finish(mut self) -> Result<Asf, ParseError> {
        let end = self.cursor.byte();
        let missing = |what| self.cursor.error_at(end, ParseErrorKind::Missing { what });
        let root = self.root.take().ok_or_else(|| missing(":root section"))?;
        if self.bones.is_empty() {
            return Err(missing(":bonedata section"));
        }
        if self.families.is_empty() {
            return Err(missing(":hierarchy section"));
        }
        let bones: Vec<Bone> = std::iter::once(root).chain(self.bones.drain(..)).collect();
        let children = self.children(&bones)?;
        let mut joints = Vec::with_capacity(bones.len());
        let mut stack = vec![(0, None)];
        while let Some((bone_idx, parent)) = stack.pop() {
            let joint_idx = joints.len();
            joints.push(self.joint(&bones[bone_idx], parent)?);
            stack.extend(
                children[bone_idx]
                    .iter()
                    .rev()
                    .map(|&c| (c, Some(joint_idx))),
            );
        }
        let skeleton = Skeleton::new(joints, OffsetFrame::Own).map_err(|_| {
            // Every number was checked, and parents were put before their children.
            let what = "consistent hierarchy";
            self.cursor.error_at(end, ParseErrorKind::Missing { what })
        })?;
        Ok(Asf {
            name: self.name,
            skeleton,
            unit: self.unit,
            angle_unit: self.angle_unit,
            warnings: self.oddities.into_warnings(self.cursor.whole()),
        })
    }

    /// Children of each bone in file order. Every bone that the hierarchy names hangs on the root by
    /// exactly one parent.
    fn children(&mut self, bones: &[Bone]) -> Result<Vec<Vec<usize>>, ParseError> {
        let mut idx_of: HashMap<&str, usize> = HashMap::new();
        for (bone_idx, bone) in bones.iter().enumerate() {
            if idx_of.insert(&bone.name, bone_idx).is_some() {
                let (what, name) = ("bone", bone.name.clone());
                return Err(self
                    .cursor
                    .error_at(bone.at, ParseErrorKind::Twice { what, name }));
            }
        }
        let find = |name: &str, at: usize| {
            idx_of.get(name).copied().ok_or_else(|| {
                let kind = ParseErrorKind::UnknownBone {
                    name: name.to_owned(),
                    nearest: nearest(name, bones.iter().map(|b| b.name.as_str())),
                };
                self.cursor.error_at(at, kind)
            })
        };
        let mut children = vec![Vec::new(); bones.len()];
        let mut parent_of = vec![None; bones.len()];
        for family in &self.families {
            let parent = find(&family.parent.0, family.parent.1)?;
            for (child, at) in &family.children {
                let child = find(child, *at)?;
                if child == 0 || parent_of[child].replace(parent).is_some() {
                    let (what, name) = ("child", bones[child].name.clone());
                    return Err(self
                        .cursor
                        .error_at(*at, ParseErrorKind::Twice { what, name }));
                }
                children[parent].push(child);
            }
        }
        // With one parent each, a bone is connected unless its ancestors form a circle or end
        // at a bone without a parent.
        let mut connected = vec![false; bones.len()];
        let mut stack = vec![0];
        while let Some(bone_idx) = stack.pop() {
            connected[bone_idx] = true;
            stack.extend(&children[bone_idx]);
        }
        for bone_idx in (0..bones.len()).filter(|&i| !connected[i]) {
            let (at, name) = (bones[bone_idx].at, bones[bone_idx].name.clone());
            if parent_of[bone_idx].is_some() || !children[bone_idx].is_empty() {
                return Err(self
                    .cursor
                    .error_at(at, ParseErrorKind::Unconnected { name }));
            }
            self.oddities.push(at, WarningKind::LooseBone { name });
        }
        Ok(children)
    }

    fn joint(&self, bone: &Bone, parent: Option<usize>) -> Result<Joint, ParseError> {
        let offset = match parent {
            None => bone.direction,
            Some(_) => {
                let norm = bone.direction.iter().map(|v| v * v).sum::<f64>().sqrt();
                let scale = bone.length / norm;
                if bone.length == 0.0 {
                    [0.0; 3]
                } else if norm.is_finite() && scale.is_finite() {
                    bone.direction.map(|v| v * scale)
                } else {
                    let (what, limit) = ("the direction's length", "positive and finite");
                    return Err(self.out_of_range(bone.at, what, limit, norm));
                }
            }
        };
        let degrees = bone.axis.degrees.map(|a| self.angle_unit.to_degrees(a));
        for (what, numbers) in [("the bone", offset), ("an axis angle", degrees)] {
            if let Some(&found) = numbers.iter().find(|v| !v.is_finite()) {
                return Err(self.out_of_range(bone.at, what, "finite", found));
            }
        }
        Ok(Joint {
            name: bone.name.clone(),
            parent,
            offset,
            channels: bone.dofs.clone(),
            axis: Some(AxisFrame {
                degrees,
                order: bone.axis.order,
            }),
            end_site: false,
        })
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

/// The name with the smallest edit distance to `name`, unless more than half of it differs. The
/// distance takes time by the product of the lengths, so names longer than any bone's have none.
pub(crate) fn nearest<'n>(name: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
    /// Longest name that is compared, in bytes.
    const MAX_LEN: usize = 64;
    if name.len() > MAX_LEN {
        return None;
    }
    names
        .filter(|n| n.len() <= 2 * MAX_LEN)
        .map(|n| (strsim::levenshtein(name, n), n))
        .min()
        .filter(|&(distance, _)| 2 * distance <= name.len())
        .map(|(_, n)| n.to_owned())
}

#[cfg(test)]
mod tests;
