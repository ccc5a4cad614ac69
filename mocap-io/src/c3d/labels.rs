//! Which points are markers, and what they are called.

use std::collections::HashSet;

use super::error::C3dWarningKind;
use super::parameters::Parameters;

/// Lists of points that are no positions, with the parameter that names their unit (c3d.org, "The POINT
/// group"; Plug-in Gait). A file may add others in TYPE_GROUPS.
const KINDS: [(&str, &str); 6] = [
    ("ANGLES", "ANGLE_UNITS"),
    ("FORCES", "FORCE_UNITS"),
    ("MOMENTS", "MOMENT_UNITS"),
    ("POWERS", "POWER_UNITS"),
    ("SCALARS", "SCALAR_UNITS"),
    ("REACTIONS", "REACTION_UNITS"),
];

/// A dimension has at most so many entries.
const MAX_KINDS: usize = 255;

/// A point that is no position.
pub(super) struct Other {
    /// Which point of a frame.
    pub(super) idx: usize,
    /// Such as `ANGLES`.
    pub(super) kind: String,
    pub(super) unit: Option<String>,
}

/// The points that are no positions, in file order. Unlabelled and unlisted points are positions.
pub(super) fn others(labels: &[String], parameters: &Parameters) -> Vec<Other> {
    let listed: Vec<(String, Option<String>, HashSet<String>)> = kinds(parameters)
        .into_iter()
        .map(|(kind, unit)| {
            let names = parameters.texts("POINT", &kind).into_iter().collect();
            (kind, parameters.text("POINT", &unit), names)
        })
        .collect();
    let of = |(idx, label): (usize, &String)| {
        let (kind, unit, _) =
            (listed.iter()).find(|(_, _, names)| !label.is_empty() && names.contains(label))?;
        Some(Other {
            idx,
            kind: kind.clone(),
            unit: unit.clone(),
        })
    };
    labels.iter().enumerate().filter_map(of).collect()
}

fn kinds(parameters: &Parameters) -> Vec<(String, String)> {
    let mut kinds: Vec<(String, String)> = KINDS
        .map(|(kind, unit)| (kind.to_owned(), unit.to_owned()))
        .into();
    // Pairs: the list's name, the quantity's. Modelled markers are positions all the same.
    let pairs = parameters.texts("POINT", "TYPE_GROUPS");
    for pair in pairs.chunks_exact(2).take(MAX_KINDS) {
        let is_new = kinds.iter().all(|(kind, _)| *kind != pair[0]);
        if is_new && !pair[0].is_empty() && !pair[0].contains("MARKER") {
            kinds.push((pair[0].clone(), format!("{}_UNITS", pair[1])));
        }
    }
    kinds
}

/// A name for each of `n` points: its label, or `point` and its number counted from 1; a name that was
/// there before gets `_2`, `_3`, ….
pub(super) fn distinct_names(
    labels: &[String],
    n: usize,
    at: usize,
    oddities: &mut Vec<(usize, C3dWarningKind)>,
) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(n);
    let mut taken: HashSet<String> = HashSet::with_capacity(n);
    let mut next_number = std::collections::HashMap::new();
    let (mut unlabelled, mut renamed) = ((0, 0), (0, String::new()));
    for i in 0..n {
        let label = labels.get(i).filter(|label| !label.is_empty());
        let wanted = label.cloned().unwrap_or_else(|| {
            unlabelled = (
                unlabelled.0 + 1,
                if unlabelled.0 == 0 {
                    i + 1
                } else {
                    unlabelled.1
                },
            );
            format!("point{}", i + 1)
        });
        let mut name = wanted.clone();
        while !taken.insert(name.clone()) {
            let number = next_number.entry(wanted.clone()).or_insert(1usize);
            *number += 1;
            name = format!("{wanted}_{number}");
        }
        if name != wanted {
            renamed.0 += 1;
            if renamed.0 == 1 {
                renamed.1 = wanted;
            }
        }
        names.push(name);
    }
    if unlabelled.0 > 0 {
        let (count, first) = unlabelled;
        oddities.push((at, C3dWarningKind::NoLabels { count, first }));
    }
    if renamed.0 > 0 {
        let (count, name) = renamed;
        oddities.push((at, C3dWarningKind::DuplicateLabels { name, count }));
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_distinct_whatever_the_labels() {
        let labels = ["A", "", "A", "A_2", "A", "point2"].map(str::to_owned);
        let mut oddities = Vec::new();
        let names = distinct_names(&labels, 7, 0, &mut oddities);
        assert_eq!(
            names,
            ["A", "point2", "A_2", "A_2_2", "A_3", "point2_2", "point7"]
        );
        let kinds: Vec<C3dWarningKind> = oddities.into_iter().map(|(_, kind)| kind).collect();
        let unlabelled = C3dWarningKind::NoLabels { count: 2, first: 2 };
        let name = "A".to_owned();
        let renamed = C3dWarningKind::DuplicateLabels { name, count: 4 };
        assert_eq!(kinds, [unlabelled, renamed]);
    }
}
