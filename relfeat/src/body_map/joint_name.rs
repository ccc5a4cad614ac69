//! Joint names as sequences of words.

use std::collections::{BTreeMap, HashMap};

/// The words of a name, in lower case: split at case changes, at borders of letters and digits and
/// at everything else. Zeros in front of a number are dropped, so that `spine_01` is `Spine1`.
pub(super) fn words(name: &str) -> Vec<String> {
    let chars: Vec<char> = name.chars().collect();
    let mut words: Vec<String> = Vec::new();
    let mut start = 0;
    for end in 1..=chars.len() {
        let at_border = end == chars.len() || {
            let (before, here) = (chars[end - 1], chars[end]);
            let next_is_lower = chars.get(end + 1).is_some_and(|c| c.is_lowercase());
            before.is_alphanumeric() != here.is_alphanumeric()
                || before.is_numeric() != here.is_numeric()
                || here.is_uppercase() && (!before.is_uppercase() || next_is_lower)
        };
        if at_border {
            if chars[start].is_alphanumeric() {
                let word: String = chars[start..end].iter().collect();
                let trimmed = word.trim_start_matches('0');
                let number = word.starts_with('0');
                let word = if number && trimmed.is_empty() {
                    "0"
                } else {
                    trimmed
                };
                words.push(word.to_lowercase());
            }
            start = end;
        }
    }
    words
}

/// The words in one, so that `lhipjoint` is `LHipJoint`. Numbers are kept apart: `Spine1_2` is not
/// `Spine12`.
pub(super) fn key(words: &[String]) -> String {
    let mut key = String::new();
    for word in words {
        let is_digit = |c: char| c.is_numeric();
        if key.ends_with(is_digit) && word.starts_with(is_digit) {
            key.push('_');
        }
        key.push_str(word);
    }
    key
}

/// What comes before the last colon, or before the last bar of a Maya path, and the rest.
pub(super) fn split_namespace(name: &str) -> (&str, &str) {
    match name.rfind([':', '|']) {
        Some(at) => (&name[..at], &name[at + 1..]),
        None => ("", name),
    }
}

/// Whether a word names a side of the body.
pub(super) fn is_side(word: &str) -> bool {
    matches!(word, "l" | "r" | "left" | "right")
}

/// How a rig spells a joint.
#[derive(Clone, Debug)]
pub(super) struct Spelling {
    exact: String,
    key: String,
}

impl Spelling {
    pub(super) fn new(name: &str) -> Self {
        let (_, bare) = split_namespace(name);
        Spelling {
            exact: bare.trim().to_lowercase(),
            key: key(&words(bare)),
        }
    }
}

/// The names of a skeleton, in each way of reading them.
#[derive(Debug)]
pub(super) struct Names {
    readings: Vec<Reading>,
}

/// Joints by name; of several with one name, the first.
#[derive(Debug, Default)]
pub(super) struct Reading {
    /// As the file spells them, but for case. Empty where a prefix was taken off.
    by_spelling: HashMap<String, usize>,
    by_key: HashMap<String, usize>,
}

/// A namespace or a first word that fewer joints share is part of their names, or too few joints for
/// a body.
const MIN_FAMILY: usize = 8;

/// Of many families only the largest are read: work stays linear in the joints.
const MAX_FAMILIES: usize = 12;

/// `CC_Base_`, `m_avg_` and `Bip01 ` are two words.
const MAX_PREFIX_WORDS: usize = 3;

struct Name<'a> {
    joint: usize,
    namespace: &'a str,
    bare: &'a str,
    words: Vec<String>,
}

impl Names {
    pub(super) fn new(joint_names: &[&str]) -> Names {
        let names: Vec<Name<'_>> = joint_names
            .iter()
            .enumerate()
            .map(|(joint, name)| {
                let (namespace, bare) = split_namespace(name);
                let words = words(bare);
                Name {
                    joint,
                    namespace,
                    bare,
                    words,
                }
            })
            .collect();
        let mut sizes: BTreeMap<&str, usize> = BTreeMap::new();
        for name in &names {
            *sizes.entry(name.namespace).or_default() += 1;
        }
        let families = largest(sizes);
        let mut readings = Vec::new();
        if families.len() > 1 {
            // Two people in one file: each has a body.
            for namespace in families {
                let of_one = names.iter().filter(|n| n.namespace == namespace);
                read(&of_one.collect::<Vec<_>>(), &mut readings);
            }
        } else {
            read(&names.iter().collect::<Vec<_>>(), &mut readings);
        }
        Names { readings }
    }

    pub(super) fn readings(&self) -> &[Reading] {
        &self.readings
    }
}

/// The families that are large enough, the largest first; equally large ones in alphabetical order.
fn largest<T>(sizes: BTreeMap<T, usize>) -> Vec<T> {
    let mut families: Vec<(T, usize)> = sizes.into_iter().collect();
    families.retain(|&(_, n)| n >= MIN_FAMILY);
    families.sort_by_key(|&(_, n)| std::cmp::Reverse(n));
    families.truncate(MAX_FAMILIES);
    families.into_iter().map(|(family, _)| family).collect()
}

/// The names as they are, then for each prefix that many share the names that have it, without it.
fn read(names: &[&Name<'_>], readings: &mut Vec<Reading>) {
    let mut whole = Reading::default();
    for name in names {
        let spelling = name.bare.trim().to_lowercase();
        whole.by_spelling.entry(spelling).or_insert(name.joint);
        whole.by_key.entry(key(&name.words)).or_insert(name.joint);
    }
    readings.push(whole);

    let mut sizes: BTreeMap<&[String], usize> = BTreeMap::new();
    for name in names {
        let longest = MAX_PREFIX_WORDS.min(name.words.len().saturating_sub(1));
        for n_words in 1..=longest {
            if is_side(&name.words[n_words - 1]) {
                break;
            }
            *sizes.entry(&name.words[..n_words]).or_default() += 1;
        }
    }
    for prefix in largest(sizes) {
        let mut reading = Reading::default();
        for name in names {
            if let Some(rest) = name.words.strip_prefix(prefix).filter(|r| !r.is_empty()) {
                reading.by_key.entry(key(rest)).or_insert(name.joint);
            }
        }
        readings.push(reading);
    }
}

impl Reading {
    /// Whether no prefix was taken off.
    pub(super) fn is_whole(&self) -> bool {
        !self.by_spelling.is_empty()
    }

    /// The joint of a name: rather one that is spelt alike. A name without letters and digits is none.
    pub(super) fn find(&self, name: &Spelling) -> Option<usize> {
        if name.key.is_empty() {
            return None;
        }
        let joint = self.by_spelling.get(&name.exact);
        joint.or_else(|| self.by_key.get(&name.key)).copied()
    }
}
