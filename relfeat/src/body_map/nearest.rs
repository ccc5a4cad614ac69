//! Joint names that resemble those of a body point.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use super::joint_name::{is_side, key, split_namespace, words};
use super::rig::{PointRule, RIGS};
use crate::BodyPoint;

/// Names less alike than this are nobody's slip: `Spine` and `Spike` are 0.8, `Neck` and `Head` 0.25.
const MIN_LIKENESS: f64 = 0.6;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

/// A name in words, without those for a side.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Plain {
    words: Vec<String>,
    key: String,
}

/// Per body point the joints that the built-in rigs take it to be.
static KNOWN: LazyLock<[Vec<Plain>; BodyPoint::COUNT]> = LazyLock::new(|| {
    BodyPoint::ALL.map(|point| {
        let rules = RIGS.iter().filter_map(|rig| rig.points.get(&point));
        let names = rules.flatten().filter_map(|rule| match rule {
            PointRule::Joint(name) => Some(plain(&words(name), side_of(point))),
            PointRule::Mix(_) => None,
        });
        let names: BTreeSet<Plain> = names.collect();
        names.into_iter().collect()
    })
});

pub(super) fn nearest<'a>(point: BodyPoint, joint_names: &[&'a str], n: usize) -> Vec<&'a str> {
    let split: Vec<Vec<String>> = joint_names
        .iter()
        .map(|name| words(split_namespace(name).1))
        .collect();
    let keys: BTreeSet<String> = split.iter().map(|words| key(words)).collect();
    let mut found: Vec<(f64, &'a str)> = Vec::new();
    for (&name, words) in joint_names.iter().zip(&split) {
        let side = side_of_name(words, &keys);
        if side.is_some() && side != side_of(point) {
            continue;
        }
        let joint = plain(words, side);
        let likeness = KNOWN[point.idx()]
            .iter()
            .map(|known| likeness(&joint, known))
            .fold(0.0, f64::max);
        if likeness >= MIN_LIKENESS {
            found.push((likeness, name));
        }
    }
    // Stable: equally near names keep the file's order.
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().take(n).map(|(_, name)| name).collect()
}

fn side_of(point: BodyPoint) -> Option<Side> {
    match point {
        BodyPoint::Root => None,
        _ if point.name().starts_with('l') => Some(Side::Left),
        _ if point.name().starts_with('r') => Some(Side::Right),
        _ => None,
    }
}

/// A side is a word of the name, or its first letters where the other side's name exists as well:
/// `lfemur` beside `rfemur`, but not `lowerback`.
fn side_of_name(words: &[String], keys: &BTreeSet<String>) -> Option<Side> {
    for word in words {
        match word.as_str() {
            "l" | "left" => return Some(Side::Left),
            "r" | "right" => return Some(Side::Right),
            _ => {}
        }
    }
    let key = key(words);
    let twins = [
        ("left", "right", Side::Left),
        ("right", "left", Side::Right),
        ("l", "r", Side::Left),
        ("r", "l", Side::Right),
    ];
    let is_twin = |&&(own, other, _): &&(&str, &str, Side)| {
        key.strip_prefix(own)
            .is_some_and(|rest| keys.contains(&format!("{other}{rest}")))
    };
    twins.iter().find(is_twin).map(|&(_, _, side)| side)
}

/// Without the words, or first letters, for a side.
fn plain(words: &[String], side: Option<Side>) -> Plain {
    let mut rest: Vec<String> = words.iter().filter(|w| !is_side(w)).cloned().collect();
    if rest.len() == words.len()
        && let Some(first) = rest.first_mut()
    {
        let marks = match side {
            Some(Side::Left) => ["left", "l"],
            Some(Side::Right) => ["right", "r"],
            None => {
                return Plain {
                    key: key(&rest),
                    words: rest,
                };
            }
        };
        if let Some(bare) = marks.iter().find_map(|m| first.strip_prefix(m)) {
            *first = bare.to_owned();
        }
    }
    Plain {
        key: key(&rest),
        words: rest,
    }
}

/// What is left of a likeness of letters where the numbers differ: `Spine1` is further from `Spine6`
/// than `Spike1`.
const OTHER_NUMBERS: f64 = 0.8;

/// 1 for equal names; the better of how alike the letters are and what share of the words is common.
fn likeness(a: &Plain, b: &Plain) -> f64 {
    let common = a.words.iter().filter(|w| b.words.contains(w)).count();
    let n_words = (a.words.len() + b.words.len()).max(1);
    let by_word = 2.0 * common as f64 / n_words as f64;
    let numbers = |name: &Plain| -> String { name.key.matches(char::is_numeric).collect() };
    let same_numbers = numbers(a) == numbers(b);
    let by_letter = strsim::normalized_damerau_levenshtein(&a.key, &b.key);
    by_word.max(by_letter * if same_numbers { 1.0 } else { OTHER_NUMBERS })
}
