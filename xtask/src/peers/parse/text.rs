//! BVH, ASF and AMC as text.

use std::fmt::Write as _;

use super::super::dice::Dice;
use super::data::N_FRAMES;

/// Parent of each joint of the BVH, each after its parent.
const PARENTS: [Option<usize>; 31] = {
    let mut parents = [None; 31];
    let list = [
        0, 1, 2, 3, 4, 0, 6, 7, 8, 9, 0, 11, 12, 13, 14, 15, 13, 17, 18, 19, 20, 21, 20, 13, 24,
        25, 26, 27, 28, 27,
    ];
    let mut i = 0;
    while i < list.len() {
        parents[i + 1] = Some(list[i]);
        i += 1;
    }
    parents
};
pub(super) const BVH_CHANNELS: usize = 3 + 3 * PARENTS.len();

/// Bones of the ASF beside the root, as in CMU and HDM05: name, parent, rotations.
const BONES: [(&str, &str, &str); 28] = [
    ("lowerback", "root", "rx ry rz"),
    ("upperback", "lowerback", "rx ry rz"),
    ("thorax", "upperback", "rx ry rz"),
    ("lowerneck", "thorax", "rx ry rz"),
    ("upperneck", "lowerneck", "rx ry rz"),
    ("head", "upperneck", "rx ry rz"),
    ("rclavicle", "thorax", "ry rz"),
    ("rhumerus", "rclavicle", "rx ry rz"),
    ("rradius", "rhumerus", "rx"),
    ("rwrist", "rradius", "ry"),
    ("rhand", "rwrist", "rx rz"),
    ("rfingers", "rhand", "rx"),
    ("rthumb", "rhand", "rx rz"),
    ("lclavicle", "thorax", "ry rz"),
    ("lhumerus", "lclavicle", "rx ry rz"),
    ("lradius", "lhumerus", "rx"),
    ("lwrist", "lradius", "ry"),
    ("lhand", "lwrist", "rx rz"),
    ("lfingers", "lhand", "rx"),
    ("lthumb", "lhand", "rx rz"),
    ("rfemur", "root", "rx ry rz"),
    ("rtibia", "rfemur", "rx"),
    ("rfoot", "rtibia", "rx rz"),
    ("rtoes", "rfoot", "rx"),
    ("lfemur", "root", "rx ry rz"),
    ("ltibia", "lfemur", "rx"),
    ("lfoot", "ltibia", "rx rz"),
    ("ltoes", "lfoot", "rx"),
];
const ROOT_CHANNELS: usize = 6;
pub(super) const AMC_CHANNELS: usize = 62;

/// A BVH up to where its values begin.
pub(super) fn bvh_hierarchy(dice: &mut Dice) -> String {
    let mut out = "HIERARCHY\n".to_owned();
    write_joint(0, 0, dice, &mut out);
    out + &format!("MOTION\nFrames: {N_FRAMES}\nFrame Time: 0.0083333\n")
}

fn write_joint(joint: usize, depth: usize, dice: &mut Dice, out: &mut String) {
    let indent = "\t".repeat(depth);
    let mut offset = || {
        let [x, y, z] = std::array::from_fn(|_| 3.0 * dice.normal());
        format!("OFFSET {x:.6} {y:.6} {z:.6}")
    };
    let (head, positions) = match PARENTS[joint] {
        None => ("ROOT Hips".to_owned(), "6 Xposition Yposition Zposition"),
        Some(_) => (format!("JOINT Joint{joint}"), "3"),
    };
    *out += &format!("{indent}{head}\n{indent}{{\n{indent}\t{}\n", offset());
    *out += &format!("{indent}\tCHANNELS {positions} Zrotation Yrotation Xrotation\n");
    let children = PARENTS.iter().enumerate();
    let children = children.filter(|(_, parent)| **parent == Some(joint));
    let children: Vec<usize> = children.map(|(child, _)| child).collect();
    if children.is_empty() {
        *out += &format!(
            "{indent}\tEnd Site\n{indent}\t{{\n{indent}\t\t{}\n{indent}\t}}\n",
            offset()
        );
    }
    for child in children {
        write_joint(child, depth + 1, dice, out);
    }
    *out += &format!("{indent}}}\n");
}

/// The skeleton of the AMC.
pub(super) fn asf() -> String {
    let mut out = "# a skeleton of CMU's proportions of text\n:version 1.10\n:name bench\n\
        :units\n  mass 1.0\n  length 0.45\n  angle deg\n:documentation\n  seeded\n\
        :root\n  order TX TY TZ RX RY RZ\n  axis XYZ\n  position 0 0 0\n  orientation 0 0 0\n\
        :bonedata\n"
        .to_owned();
    for (i, (name, _, dof)) in BONES.iter().enumerate() {
        let limits = vec!["(-180.0 180.0)"; dof.split(' ').count()].join("\n    ");
        let _ = write!(
            out,
            "  begin\n    id {}\n    name {name}\n    direction 0 1 0\n    length 2.5\n    \
             axis 0 0 0 XYZ\n    dof {dof}\n    limits {limits}\n  end\n",
            i + 1
        );
    }
    out += ":hierarchy\n  begin\n";
    let mut parents: Vec<&str> = BONES.iter().map(|(_, parent, _)| *parent).collect();
    parents.dedup();
    parents.sort_by_key(|parent| BONES.iter().position(|(name, ..)| name == parent));
    parents.dedup();
    for parent in parents {
        let children = BONES.iter().filter(|(_, p, _)| *p == parent);
        let children: Vec<&str> = children.map(|(name, ..)| *name).collect();
        out += &format!("    {parent} {}\n", children.join(" "));
    }
    out + "  end\n"
}

/// An AMC without its first line.
pub(super) fn amc_body(rows: &[Vec<String>]) -> String {
    let mut out = ":FULLY-SPECIFIED\n:DEGREES\n".to_owned();
    for (i, row) in rows.iter().enumerate() {
        let (root, mut rest) = row.split_at(ROOT_CHANNELS);
        out += &format!("{}\nroot {}\n", i + 1, root.join(" "));
        for (name, _, dof) in BONES {
            let (own, others) = rest.split_at(dof.split(' ').count());
            out += &format!("{name} {}\n", own.join(" "));
            rest = others;
        }
    }
    out
}

/// The values, one frame a line.
pub(super) fn numbers(rows: &[Vec<String>]) -> String {
    rows.iter().map(|row| row.join(" ") + "\n").collect()
}

/// As C prints `%.6g`, which is how AMC files are written.
pub(super) fn six_digits(value: f64) -> String {
    const DIGITS: i32 = 6;
    let scientific = format!("{value:.5e}");
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if !(-4..DIGITS).contains(&exponent) {
        let sign = if exponent < 0 { '-' } else { '+' };
        return format!("{}e{sign}{:02}", trim(mantissa), exponent.abs());
    }
    let decimals = usize::try_from(DIGITS - 1 - exponent).unwrap_or(0);
    trim(&format!("{value:.decimals$}")).to_owned()
}

/// Without zeros at the end that say nothing.
fn trim(number: &str) -> &str {
    if !number.contains('.') {
        return number;
    }
    number.trim_end_matches('0').trim_end_matches('.')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_digits_are_those_of_c() {
        // Right-hand sides as printed by `printf '%.6g\n'`.
        for (value, printed) in [
            (0.0, "0"),
            (100.0, "100"),
            (100_000.0, "100000"),
            (1e6, "1e+06"),
            (1e-4, "0.0001"),
            (0.000_012_34, "1.234e-05"),
            (-12.345_678_9, "-12.3457"),
            (999_999.5, "1e+06"),
            (-6.559_89e-14, "-6.55989e-14"),
        ] {
            assert_eq!(six_digits(value), printed);
        }
    }

    #[test]
    fn bones_use_up_the_channels_and_follow_their_parents() {
        let own: usize = BONES.iter().map(|(_, _, dof)| dof.split(' ').count()).sum();
        assert_eq!(ROOT_CHANNELS + own, AMC_CHANNELS);
        for (i, (_, parent, _)) in BONES.iter().enumerate() {
            let is_known = BONES[..i].iter().any(|(name, ..)| name == parent);
            assert!(is_known || *parent == "root", "{parent}");
        }
    }
}
