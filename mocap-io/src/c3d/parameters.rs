use crate::cursor::text;

use super::ByteOrder;
use super::error::C3dWarningKind;

/// The parameter section of a C3D file: groups of named values, in file order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters {
    /// The groups.
    pub groups: Vec<ParameterGroup>,
}

/// Parameters that belong together, such as `POINT`.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterGroup {
    /// Its name in upper case; empty if the file has parameters of a group that it does not define.
    pub name: String,
    /// What the file says about it.
    pub description: String,
    /// The parameters.
    pub parameters: Vec<Parameter>,
    id: u8,
}

/// A named value, a list or an array of up to seven dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name in upper case.
    pub name: String,
    /// What the file says about it.
    pub description: String,
    /// The file asks editors not to change it.
    pub locked: bool,
    /// Sizes, the fastest first (column order, as in Fortran); empty for a single value.
    pub dimensions: Vec<u8>,
    /// The values, in file order.
    pub value: ParameterValue,
    /// Offset of the record in the file.
    pub(super) byte: usize,
}

/// The values of a parameter.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ParameterValue {
    /// Characters; [`Parameter::texts`] cuts them.
    Text(Vec<u8>),
    /// Bytes.
    Bytes(Vec<u8>),
    /// 16-bit integers, which writers mean signed or unsigned.
    Integers(Vec<i16>),
    /// Floating point.
    Floats(Vec<f32>),
}

/// Enough for as many points as the header can count, at 255 labels each.
const MAX_CONTINUATIONS: u16 = 257;

impl Parameters {
    /// The parameter `name` of `group`; names are compared without regard to case.
    #[must_use]
    pub fn get(&self, group: &str, name: &str) -> Option<&Parameter> {
        let of_group = |g: &&ParameterGroup| g.name.eq_ignore_ascii_case(group);
        let found = self.groups.iter().filter(of_group);
        let mut parameters = found.flat_map(|g| &g.parameters);
        parameters.find(|p| p.name.eq_ignore_ascii_case(name))
    }

    /// `name` and its continuations `name2`, `name3`, …: a dimension has at most 255 entries.
    pub(super) fn continued<'a>(
        &'a self,
        group: &'a str,
        name: &'a str,
    ) -> impl Iterator<Item = &'a Parameter> {
        let rest =
            (2..=MAX_CONTINUATIONS).map_while(move |n| self.get(group, &format!("{name}{n}")));
        self.get(group, name).into_iter().chain(rest)
    }

    /// All texts of `name`, `name2`, ….
    pub(super) fn texts(&self, group: &str, name: &str) -> Vec<String> {
        let parameters = self.continued(group, name);
        parameters.flat_map(Parameter::texts).collect()
    }

    /// All numbers of `name`, `name2`, ….
    pub(super) fn numbers(&self, group: &str, name: &str, unsigned: bool) -> Vec<f64> {
        let all = self.continued(group, name);
        all.flat_map(|p| (0..p.len()).filter_map(move |i| p.number_as(i, unsigned)))
            .collect()
    }

    /// The first number of a parameter, integers as unsigned.
    pub(super) fn number(&self, group: &str, name: &str) -> Option<f64> {
        self.get(group, name)?.number_as(0, true)
    }

    /// The first text of a parameter, if it is not blank.
    pub(super) fn text(&self, group: &str, name: &str) -> Option<String> {
        let mut texts = self.get(group, name)?.texts().into_iter();
        texts.next().filter(|text| !text.is_empty())
    }
}

impl Parameter {
    /// Number of values; of texts, the number of characters.
    #[must_use]
    pub fn len(&self) -> usize {
        match &self.value {
            ParameterValue::Text(bytes) | ParameterValue::Bytes(bytes) => bytes.len(),
            ParameterValue::Integers(values) => values.len(),
            ParameterValue::Floats(values) => values.len(),
        }
    }

    /// Whether there is no value.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The texts, without the blanks and zero bytes that fill them up: the first dimension is their
    /// length. Empty if the values are numbers.
    #[must_use]
    pub fn texts(&self) -> Vec<String> {
        let ParameterValue::Text(bytes) = &self.value else {
            return Vec::new();
        };
        let width = self.dimensions.first().copied().unwrap_or(1);
        let texts = bytes.chunks(usize::from(width.max(1)));
        texts.map(trimmed_text).collect()
    }

    /// Number `i`, counted from 0; integers as signed. `None` for texts and past the end.
    #[must_use]
    pub fn number(&self, i: usize) -> Option<f64> {
        self.number_as(i, false)
    }

    fn number_as(&self, i: usize, unsigned: bool) -> Option<f64> {
        match &self.value {
            ParameterValue::Text(_) => None,
            ParameterValue::Bytes(values) => values.get(i).map(|&v| f64::from(v)),
            ParameterValue::Integers(values) if unsigned => {
                values.get(i).map(|&v| f64::from(v as u16))
            }
            ParameterValue::Integers(values) => values.get(i).map(|&v| f64::from(v)),
            ParameterValue::Floats(values) => values.get(i).map(|&v| f64::from(v)),
        }
    }

    /// A frame number: a float, or one integer, or two of which the second is the high word.
    pub(super) fn frame_number(&self) -> Option<f64> {
        let low = self.number_as(0, true)?;
        Some(match (&self.value, self.number_as(1, true)) {
            (ParameterValue::Integers(_), Some(high)) => low + 65_536.0 * high,
            _ => low,
        })
    }
}

/// `bytes` without what fills them up, as UTF-8 or Latin-1.
pub(super) fn trimmed_text(bytes: &[u8]) -> String {
    let end = bytes.iter().rposition(|&b| b != 0 && b != b' ');
    text(&bytes[..end.map_or(0, |last| last + 1)])
}

/// What the records of a parameter section say, and what is odd about them.
pub(super) struct Section {
    pub(super) parameters: Parameters,
    pub(super) oddities: Vec<(usize, C3dWarningKind)>,
}

/// Reads the records from `start` on, as far as they are chained. Nothing is read at or after `end`.
pub(super) fn read_records(file: &[u8], start: usize, end: usize, order: ByteOrder) -> Section {
    let section = &file[..end];
    let mut groups: Vec<ParameterGroup> = Vec::new();
    let mut oddities = Vec::new();
    let mut at = start;
    while let Some(record) = read_record(section, at, order) {
        let Some(record) = record else {
            oddities.push((at, C3dWarningKind::BrokenParameters));
            break;
        };
        let by_id = groups.iter().position(|g| g.id == record.group);
        match record.body {
            Body::Group { description } => match by_id {
                // Its parameters came first.
                Some(idx) if groups[idx].name.is_empty() => {
                    groups[idx].name = record.name;
                    groups[idx].description = description;
                }
                Some(_) => {}
                None => groups.push(ParameterGroup {
                    name: record.name,
                    description,
                    parameters: Vec::new(),
                    id: record.group,
                }),
            },
            Body::Parameter {
                dimensions,
                value,
                description,
                cut,
            } => {
                let idx = by_id.unwrap_or_else(|| {
                    groups.push(ParameterGroup {
                        name: String::new(),
                        description: String::new(),
                        parameters: Vec::new(),
                        id: record.group,
                    });
                    groups.len() - 1
                });
                if cut {
                    let name = record.name.clone();
                    oddities.push((at, C3dWarningKind::CutParameter { name }));
                }
                groups[idx].parameters.push(Parameter {
                    name: record.name,
                    description,
                    locked: record.locked,
                    dimensions,
                    value,
                    byte: at,
                });
            }
        }
        let Some(next) = record.next else { break };
        at = next;
    }
    for group in groups.iter().filter(|g| g.name.is_empty()) {
        let byte = group.parameters.first().map_or(start, |p| p.byte);
        oddities.push((byte, C3dWarningKind::NamelessGroup { id: group.id }));
    }
    Section {
        parameters: Parameters { groups },
        oddities,
    }
}

struct Record {
    name: String,
    locked: bool,
    group: u8,
    next: Option<usize>,
    body: Body,
}

enum Body {
    Group {
        description: String,
    },
    Parameter {
        dimensions: Vec<u8>,
        value: ParameterValue,
        description: String,
        /// The value reaches past its record.
        cut: bool,
    },
}

/// The record at `at`; `None` at the end of the list, `Some(None)` where nothing sensible stands or
/// the list leads out of the section.
fn read_record(section: &[u8], at: usize, order: ByteOrder) -> Option<Option<Record>> {
    if at > section.len() {
        return Some(None);
    }
    let head = section.get(at..at + 2)?;
    // A negative length locks the record.
    let name_len = usize::from((head[0] as i8).unsigned_abs());
    let group_id = head[1] as i8;
    if name_len == 0 || group_id == 0 {
        return None;
    }
    Some(
        read_named(section, at, name_len, group_id, order).map(|mut record| {
            record.locked = (head[0] as i8) < 0;
            record
        }),
    )
}

fn read_named(
    section: &[u8],
    at: usize,
    name_len: usize,
    group_id: i8,
    order: ByteOrder,
) -> Option<Record> {
    let name = section.get(at + 2..at + 2 + name_len)?;
    if name.iter().any(|&b| b < b' ') {
        return None;
    }
    let pointer = at + 2 + name_len;
    let &[o0, o1] = section.get(pointer..pointer + 2)? else {
        return None;
    };
    // Counted from the pointer itself, and not less than its own length.
    let next = match usize::from(order.u16([o0, o1])) {
        0 => None,
        1 => return None,
        offset if offset > usize::from(i16::MAX as u16) => return None,
        offset => Some(pointer + offset),
    };
    let end = next.unwrap_or(section.len()).min(section.len());
    let rest = section.get(pointer + 2..end)?;
    let body = if group_id < 0 {
        Body::Group {
            description: description(rest),
        }
    } else {
        read_value(rest, order)?
    };
    Some(Record {
        name: text(name).trim().to_ascii_uppercase(),
        locked: false,
        group: group_id.unsigned_abs(),
        next,
        body,
    })
}

fn read_value(record: &[u8], order: ByteOrder) -> Option<Body> {
    let (&kind, rest) = record.split_first()?;
    let (&n_dimensions, rest) = rest.split_first()?;
    let size = match kind as i8 {
        -1 | 1 => 1,
        2 => 2,
        4 => 4,
        _ => return None,
    };
    let dimensions = rest.get(..usize::from(n_dimensions))?.to_vec();
    let rest = &rest[dimensions.len()..];
    let count = dimensions
        .iter()
        .try_fold(1usize, |n, &d| n.checked_mul(d.into()));
    let n_bytes = count.and_then(|n| n.checked_mul(size));
    let (bytes, after, cut) = match n_bytes.filter(|&n| n <= rest.len()) {
        Some(n) => (&rest[..n], &rest[n..], false),
        None => (&rest[..rest.len() / size * size], &rest[..0], true),
    };
    let value = match kind as i8 {
        -1 => ParameterValue::Text(bytes.to_vec()),
        1 => ParameterValue::Bytes(bytes.to_vec()),
        2 => ParameterValue::Integers(
            bytes
                .chunks_exact(2)
                .map(|b| order.u16([b[0], b[1]]) as i16)
                .collect(),
        ),
        _ => ParameterValue::Floats(
            bytes
                .chunks_exact(4)
                .map(|b| order.f32([b[0], b[1], b[2], b[3]]))
                .collect(),
        ),
    };
    Some(Body::Parameter {
        dimensions,
        value,
        description: description(after),
        cut,
    })
}

/// A length byte and so many characters; what is not there is left out.
fn description(bytes: &[u8]) -> String {
    let Some((&len, rest)) = bytes.split_first() else {
        return String::new();
    };
    trimmed_text(&rest[..rest.len().min(len.into())])
}
