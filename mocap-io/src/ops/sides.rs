use std::collections::BTreeMap;

use crate::Skeleton;

/// Of each joint the one on the other side of the body, itself where there is none.
///
/// A name has a side if one of its words is `left`, `right`, `l` or `r` in any case. Words end at
/// anything that is no letter, between letters and digits, and where a capital starts one
/// (`mixamorig:LeftArm`, `Bip01 L Thigh`, `upper_arm.R.001`, `LHipJoint`). Names all in lower case or
/// all in capitals may have their side glued to the front (`lfemur`, `RTHI`, `lefthand`). The
/// partner has the same name but for the side, and its parent is the partner of the joint's parent;
/// so `lowerback`, `root` and `Llama`, whose other halves do not exist, are their own partners.
///
/// The result is its own inverse. O(joints · log joints), plus the ones of equal name.
#[must_use]
pub fn mirror_pairs(skeleton: &Skeleton) -> Vec<usize> {
    let joints = skeleton.joints();
    let mut named: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (joint_idx, name) in skeleton.names().enumerate() {
        named.entry(name).or_default().push(joint_idx);
    }
    let mut pairs: Vec<usize> = (0..joints.len()).collect();
    for (joint_idx, joint) in joints.iter().enumerate() {
        if pairs[joint_idx] != joint_idx {
            continue;
        }
        let parent = joint.parent.map(|p| pairs[p]);
        let is_free = |&&other: &&usize| {
            other > joint_idx && pairs[other] == other && joints[other].parent == parent
        };
        let partner = other_sides(&joint.name)
            .into_iter()
            .find_map(|name| named.get(name.as_str())?.iter().find(is_free).copied());
        if let Some(partner) = partner {
            pairs[joint_idx] = partner;
            pairs[partner] = joint_idx;
        }
    }
    pairs
}

/// What the joint on the other side could be called.
fn other_sides(name: &str) -> Vec<String> {
    let mut swapped = String::with_capacity(name.len() + 1);
    for word in words(name) {
        swapped.push_str(&other_word(word).unwrap_or_else(|| word.to_owned()));
    }
    if swapped != name {
        return vec![swapped];
    }
    let has_lower = name.bytes().any(|b| b.is_ascii_lowercase());
    let has_upper = name.bytes().any(|b| b.is_ascii_uppercase());
    if has_lower && has_upper {
        return Vec::new();
    }
    let prefixes = ["left", "right", "LEFT", "RIGHT", "l", "r", "L", "R"];
    let glued = |prefix: &&str| Some(other_word(prefix)? + name.strip_prefix(*prefix)?);
    prefixes.iter().filter_map(glued).collect()
}

/// The word for the other side, in the same case.
fn other_word(word: &str) -> Option<String> {
    let other = match word.to_ascii_lowercase().as_str() {
        "left" => "right",
        "right" => "left",
        "l" => "r",
        "r" => "l",
        _ => return None,
    };
    let mut letters = word.chars();
    let first_is_upper = letters.next().is_some_and(|c| c.is_ascii_uppercase());
    let rest_is_upper = letters.next().is_some_and(|c| c.is_ascii_uppercase());
    Some(match (first_is_upper, rest_is_upper) {
        (true, false) => other[..1].to_ascii_uppercase() + &other[1..],
        (true, true) => other.to_ascii_uppercase(),
        (false, _) => other.to_owned(),
    })
}

/// A name in pieces: words, and what stands between them.
fn words(name: &str) -> impl Iterator<Item = &str> {
    let mut rest = name;
    std::iter::from_fn(move || {
        let bytes = rest.as_bytes();
        let ends = |end: &usize| {
            let (before, after) = (bytes[end - 1], bytes[*end]);
            let starts_word = |i: usize| bytes[i].is_ascii_uppercase();
            let next_is_lower = bytes.get(end + 1).is_some_and(u8::is_ascii_lowercase);
            before.is_ascii_alphabetic() != after.is_ascii_alphabetic()
                || (before.is_ascii_lowercase() && starts_word(*end))
                // The last capital of a run starts the word after it: LHip is L, Hip.
                || (before.is_ascii_uppercase() && starts_word(*end) && next_is_lower)
        };
        let end = (1..bytes.len())
            .filter(|&i| rest.is_char_boundary(i))
            .find(ends)
            .unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        rest = after;
        (!word.is_empty()).then_some(word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(left: &str, right: &str) {
        assert!(
            other_sides(left).contains(&right.to_owned()),
            "{:?}",
            other_sides(left)
        );
        assert!(
            other_sides(right).contains(&left.to_owned()),
            "{:?}",
            other_sides(right)
        );
    }

    #[test]
    fn names_of_all_rigs_have_sides() {
        check("LeftUpLeg", "RightUpLeg");
        check("lfemur", "rfemur");
        check("LHipJoint", "RHipJoint");
        check("lThumb1", "rThumb1");
        check("mixamorig:LeftArm", "mixamorig:RightArm");
        check(
            "mixamorig2:LeftHandThumb4_End",
            "mixamorig2:RightHandThumb4_End",
        );
        check("Bip01 L Thigh", "Bip01 R Thigh");
        check("CC_Base_L_Upperarm", "CC_Base_R_Upperarm");
        check("upperarm_l", "upperarm_r");
        check("DEF-thigh.L.001", "DEF-thigh.R.001");
        check("left_hip", "right_hip");
        check("L_Hip", "R_Hip");
        check("FemurL", "FemurR");
        check("jLeftToe", "jRightToe");
        check("LTHI", "RTHI");
        check("LEFT_KNEE", "RIGHT_KNEE");
        check("lefthand", "righthand");
        check("Übung.L", "Übung.R");
    }

    #[test]
    fn parts_of_words_are_no_sides() {
        for name in [
            "Llama",
            "Rotor",
            "Hips",
            "L",
            "Leftover",
            "HandLeftie",
            "",
            "Ü",
        ] {
            let others = other_sides(name);
            assert!(others.is_empty() || name == "L", "{name}: {others:?}");
        }
    }
}
