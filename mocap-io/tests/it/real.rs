//! Real files, from the folder that `MOTIF_DATA` names (default: `../shared/data` beside the
//! repository).

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use mocap_io::ndarray::Array3;
use mocap_io::{
    Amc, Asf, Bvh, LengthUnit, Motion, forward_kinematics, parse_amc, parse_asf, parse_bvh,
    write_amc, write_bvh,
};

/// The reference is printed with six decimals, and was computed from the same text: what remains is
/// rounding of `f32` and of the printout, far below what any feature can tell apart.
const POSITION_TOLERANCE: f32 = 1e-4;

/// The folder with the real data; `None` if it is absent, which CI does not forgive.
pub(crate) fn data() -> Option<PathBuf> {
    let dir = std::env::var_os("MOTIF_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"),
        PathBuf::from,
    );
    if dir.is_dir() {
        return Some(dir);
    }
    assert!(
        std::env::var_os("CI").is_none(),
        "no data at {}",
        dir.display()
    );
    println!("skipped: no data");
    None
}

fn read_asf(path: &Path) -> Asf {
    parse_asf(&fs::read(path).unwrap()).unwrap_or_else(|e| panic!("{}:{e}", path.display()))
}

fn read_amc(path: &Path, asf: &Asf) -> Amc {
    parse_amc(&fs::read(path).unwrap(), asf).unwrap_or_else(|e| panic!("{}:{e}", path.display()))
}

/// The skeleton of a clip of `hdm05` (`HDM_bd_…` has `HDM_bd.asf`) or `cmu` (`02_01` has `02.asf`).
pub(crate) fn skeleton_of(clip: &Path) -> PathBuf {
    let stem = clip.file_stem().unwrap().to_str().unwrap();
    let actor = match stem.strip_prefix("HDM_") {
        Some(rest) => format!("HDM_{}", rest.split('_').next().unwrap()),
        None => stem.split('_').next().unwrap().to_owned(),
    };
    clip.with_file_name(actor).with_extension("asf")
}

/// Which bone's end each body point is (spec.md f).
fn bone_of(point: &str) -> &str {
    match point {
        "root" => "root",
        "lhip" => "lhipjoint",
        "rhip" => "rhipjoint",
        "lknee" => "lfemur",
        "rknee" => "rfemur",
        "lankle" => "ltibia",
        "rankle" => "rtibia",
        "belly" => "lowerback",
        "chest" => "upperback",
        "neck" | "lclavicle" | "rclavicle" => "thorax",
        "head" => "upperneck",
        "headtop" => "head",
        "lshoulder" => "lclavicle",
        "rshoulder" => "rclavicle",
        "lelbow" => "lhumerus",
        "relbow" => "rhumerus",
        same => same,
    }
}

#[test]
fn real_positions_agree_with_an_independent_implementation() {
    let Some(data) = data() else { return };
    let table = fs::read_to_string(data.join("labels/reference-positions.csv")).unwrap();
    let mut by_clip: BTreeMap<&str, Vec<Vec<&str>>> = BTreeMap::new();
    for line in table.lines().skip(1) {
        let row: Vec<&str> = line.split(',').collect();
        by_clip.entry(row[0]).or_default().push(row);
    }
    let mut worst = 0.0f32;
    let mut n_points = 0;
    for (clip, rows) in by_clip {
        let path = data.join(clip);
        let amc = read_amc(&path, &read_asf(&skeleton_of(&path)));
        let positions = forward_kinematics(&amc.motion);
        for row in rows {
            let frame: usize = row[1].parse().unwrap();
            let joint_idx = amc.motion.skeleton.find(bone_of(row[2])).unwrap();
            for (axis, text) in row[3..].iter().enumerate() {
                let expected: f32 = text.parse().unwrap();
                let distance = (positions[[frame, joint_idx, axis]] - expected).abs();
                assert!(distance <= POSITION_TOLERANCE, "{row:?}: off by {distance}");
                worst = worst.max(distance);
            }
            n_points += 1;
        }
    }
    println!("{n_points} points, largest difference {worst} m");
    assert!(n_points > 1_000, "only {n_points} points in the table");
}

pub(crate) fn files_below(dir: &Path, extension: &str, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(dir)
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files_below(&path, extension, found);
        } else if path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(extension))
        {
            found.push(path);
        }
    }
}

#[test]
fn real_libraries_have_the_counted_frames() {
    let Some(data) = data() else { return };
    let mut n_frames = 0;
    let mut n_warnings = 0;
    for (folder, n_clips) in [("hdm05", 288), ("cmu", 195)] {
        let mut clips = Vec::new();
        files_below(&data.join(folder), "amc", &mut clips);
        assert_eq!(clips.len(), n_clips, "{folder}");
        for clip in clips {
            let amc = read_amc(&clip, &read_asf(&skeleton_of(&clip)));
            n_frames += amc.motion.n_frames();
            for warning in amc.warnings {
                println!("{}:{warning}", clip.display());
                n_warnings += 1;
                assert!(clip.ends_with("07_12.amc"), "an unexpected warning");
                assert_eq!(warning.code(), "AMC001");
            }
        }
    }
    // Counted with `grep -c '^[0-9]'` over all files, less the cut frame of 07_12.
    assert_eq!(n_frames, 218_062);
    assert_eq!(n_warnings, 1);
}

fn read_bvh(path: &Path) -> Bvh {
    parse_bvh(&fs::read(path).unwrap()).unwrap_or_else(|e| panic!("{}:{e}", path.display()))
}

/// Files that are odd, and how: this one has 3070 rows (counted with `wc`), its header says 3069.
const ODD_BVH: [(&str, &str); 1] = [("assimp_Boxing_Toes_crlf.bvh", "BVH012")];

#[test]
fn real_bvh_files_of_all_dialects_load_and_survive_a_round_trip() {
    let Some(data) = data() else { return };
    let mut clips = Vec::new();
    files_below(&data, "bvh", &mut clips);
    assert!(clips.len() > 40, "only {} files", clips.len());
    for clip in &clips {
        let Bvh { motion, warnings } = read_bvh(clip);
        let name = clip.file_name().unwrap().to_str().unwrap();
        let codes: Vec<&str> = warnings.iter().map(|w| w.code()).collect();
        let expected: Vec<&str> = ODD_BVH
            .iter()
            .filter(|o| o.0 == name)
            .map(|o| o.1)
            .collect();
        assert_eq!(codes, expected, "{name}");
        assert!(
            forward_kinematics(&motion).iter().all(|v| v.is_finite()),
            "{name}"
        );
        let mut text = Vec::new();
        write_bvh(&motion, &mut text).unwrap();
        assert!(parse_bvh(&text).unwrap().motion == motion, "{name}");
    }
}

#[track_caller]
fn check_tricky_bvh(name: &str, n_frames: usize, n_joints: usize, hz: f64) {
    let Some(data) = data() else { return };
    let motion = read_bvh(&data.join("tricky/bvh").join(name)).motion;
    let n_inner = motion
        .skeleton
        .joints()
        .iter()
        .filter(|j| !j.end_site)
        .count();
    assert_eq!(
        (motion.n_frames(), n_inner, motion.rate.hz()),
        (n_frames, n_joints, hz),
        "{name}"
    );
}

/// Rows and joints counted with `grep`, rates as TRICKY.md and the files' headers have them.
#[test]
fn real_tricky_bvh_files_have_the_frames_joints_and_rates_they_name() {
    check_tricky_bvh("bvh_anim_test_simple.bvh", 2, 2, 30.0);
    check_tricky_bvh("bvh-python_test_freebvh.bvh", 69, 55, 30.0);
    check_tricky_bvh("bvh-python_test_mocapbank.bvh", 455, 19, 30.0);
    check_tricky_bvh("bvh-toolbox_walk01.bvh", 101, 19, 24.0);
    check_tricky_bvh(
        "pybvh_full_precision_frame_time.bvh",
        3,
        2,
        1.0 / 0.0417083750417,
    );
    check_tricky_bvh("pybvh_bvh_test2.bvh", 61, 23, 120.0);
    check_tricky_bvh("pybvh_old_bvh_test4.bvh", 100, 24, 120.0);
    check_tricky_bvh("motionSynth_demo.bvh", 300, 43, 120.0);
    check_tricky_bvh("mocaputil_Example1.bvh", 2, 18, 30.0);
    check_tricky_bvh("XBMotionGraph_input1.bvh", 270, 50, 90.0);
    check_tricky_bvh("AnimatedDrawings_jumping_jacks.bvh", 125, 31, 30.0);
    check_tricky_bvh("AnimatedDrawings_jesse_dance.bvh", 1007, 60, 100.0);
    check_tricky_bvh("iclone_002_03.bvh", 86, 101, 60.0);
}

#[test]
fn real_line_endings_do_not_matter() {
    let Some(data) = data() else { return };
    let folder = data.join("tricky/asfamc");
    let asf = read_asf(&data.join("cmu/02/02.asf"));
    let lf = read_amc(&folder.join("walk02_01_LF.amc"), &asf);
    assert_eq!(read_amc(&folder.join("walk02_01_CRLF.amc"), &asf), lf);
    assert_eq!(
        read_amc(&data.join("cmu/02/02_01.amc"), &asf).motion,
        lf.motion
    );
    assert_eq!(lf.motion.n_frames(), 343);
    let crlf = fs::read(data.join("tricky/bvh/assimp_Boxing_Toes_crlf.bvh")).unwrap();
    assert!(crlf.contains(&b'\r'));
    let lf: Vec<u8> = crlf.iter().copied().filter(|&b| b != b'\r').collect();
    let (lf, crlf) = (parse_bvh(&lf).unwrap(), parse_bvh(&crlf).unwrap());
    assert!(lf.motion == crlf.motion);
    assert_eq!(lf.warnings[0].to_string(), crlf.warnings[0].to_string());
}

/// Each motion of `tricky/asfamc` with its skeleton, number of frames (counted with `grep`), first frame
/// number and warnings.
const TRICKY_AMC: [(&str, &str, usize, u64, &[&str]); 12] = [
    (
        "comment_after_header_11_01.amc",
        "tricky/asfamc/comment_in_header_11.asf",
        597,
        1,
        &[],
    ),
    (
        "terryum_124_03.amc",
        "tricky/asfamc/terryum_124.asf",
        620,
        700,
        &[],
    ),
    (
        "terryum_124_02_copy.amc",
        "tricky/asfamc/terryum_124.asf",
        1319,
        1,
        &[],
    ),
    (
        "Forrest.Jumping.AMC",
        "tricky/asfamc/Forrest.ASF",
        592,
        1,
        &[],
    ),
    (
        "Forrest.Running.AMC",
        "tricky/asfamc/Forrest.ASF",
        356,
        1,
        &[],
    ),
    (
        "Forrest.Spinning.AMC",
        "tricky/asfamc/Forrest.ASF",
        373,
        1,
        &[],
    ),
    (
        "Forrest.Walking.AMC",
        "tricky/asfamc/Forrest.ASF",
        446,
        1,
        &[],
    ),
    ("Forrest.Wave.AMC", "tricky/asfamc/Forrest.ASF", 520, 1, &[]),
    (
        "dm_control_zeros.amc",
        "tricky/asfamc/comment_in_header_11.asf",
        7,
        1,
        &[],
    ),
    (
        "encadyma_null.amc",
        "tricky/asfamc/encadyma_mjackson.asf",
        1,
        1,
        &[],
    ),
    ("walk02_01_LF.amc", "cmu/02/02.asf", 343, 1, &[]),
    ("walk02_01_CRLF.amc", "cmu/02/02.asf", 343, 1, &[]),
];

#[test]
fn real_tricky_acclaim_files_load() {
    let Some(data) = data() else { return };
    let mut motions = Vec::new();
    files_below(&data.join("tricky/asfamc"), "amc", &mut motions);
    assert_eq!(motions.len(), TRICKY_AMC.len());
    for (name, skeleton, n_frames, first, codes) in TRICKY_AMC {
        let amc = read_amc(
            &data.join("tricky/asfamc").join(name),
            &read_asf(&data.join(skeleton)),
        );
        assert_eq!(amc.motion.n_frames(), n_frames, "{name}");
        assert_eq!(amc.first_frame_number, Some(first), "{name}");
        let found: Vec<&str> = amc.warnings.iter().map(|w| w.code()).collect();
        assert_eq!(found, codes, "{name}");
    }
    let mut skeletons = Vec::new();
    files_below(&data, "asf", &mut skeletons);
    for path in skeletons {
        let asf = read_asf(&path);
        let name = path.file_name().unwrap().to_str().unwrap();
        let codes: Vec<&str> = asf.warnings.iter().map(|w| w.code()).collect();
        let expected: &[&str] = match name {
            "encadyma_mjackson.asf" => &["ASF002"],
            // Its hierarchy does not name the first bone.
            "encadyma_debug.asf" => &["ASF002", "ASF001"],
            _ => &[],
        };
        assert_eq!(codes, expected, "{name}");
        assert!(asf.skeleton.joints().len() >= 5, "{name}");
    }
    let debug = read_asf(&data.join("tricky/asfamc/encadyma_debug.asf"));
    assert_eq!(
        (debug.name.as_str(), debug.skeleton.joints().len()),
        ("Walk Skeleton Mini", 5)
    );
    let kitchen = read_asf(&data.join("tricky/asfamc/cmu_kitchen_01.asf"));
    assert_eq!(kitchen.skeleton.joints().len(), 27);
    assert_eq!(kitchen.unit.metres(), 0.0254 / 0.045);
}

/// Second half of a trial against the whole (TRICKY.md): frame 700 of the file is frame 699 from 0.
#[test]
fn real_halves_equal_their_whole() {
    let Some(data) = data() else { return };
    let asf = read_asf(&data.join("tricky/asfamc/terryum_124.asf"));
    let whole = read_amc(&data.join("tricky/asfamc/terryum_124_02_copy.amc"), &asf).motion;
    let half = read_amc(&data.join("tricky/asfamc/terryum_124_03.amc"), &asf).motion;
    assert_eq!(whole.slice(699..1319), Some(half));
}

/// The joints of the cgspeed conversion that agree with the Acclaim skeleton (the data's README), with
/// the bones that end there.
const GOLDEN_JOINTS: [(&str, &str); 14] = [
    ("Hips", "root"),
    ("LeftUpLeg", "lhipjoint"),
    ("LeftLeg", "lfemur"),
    ("LeftFoot", "ltibia"),
    ("LeftToeBase", "lfoot"),
    ("LeftToeBase_End", "ltoes"),
    ("RightUpLeg", "rhipjoint"),
    ("RightLeg", "rfemur"),
    ("RightFoot", "rtibia"),
    ("RightToeBase", "rfoot"),
    ("RightToeBase_End", "rtoes"),
    ("Spine", "lowerback"),
    ("Spine1", "upperback"),
    ("LHipJoint", "root"),
];

/// The conversion prints four decimals of 5.6 cm; along a leg of five bones rounding of angles and
/// offsets adds up to less than a millimetre.
const GOLDEN_METRES: f32 = 1e-3;

#[track_caller]
fn check_golden_pair(skeleton: &str, amc: &str, bvh: &str, n_frames: usize) {
    let Some(data) = data() else { return };
    let amc = read_amc(&data.join(amc), &read_asf(&data.join(skeleton))).motion;
    let bvh = read_bvh(&data.join(bvh));
    assert_eq!(bvh.motion.unit, LengthUnit::ACCLAIM_CMU, "the guess");
    assert_eq!(
        (amc.n_frames(), bvh.motion.n_frames()),
        (n_frames, n_frames + 1)
    );
    // The first frame is a T-pose.
    let bvh = bvh.motion.slice(1..n_frames + 1).unwrap();
    let (a, b) = (forward_kinematics(&amc), forward_kinematics(&bvh));
    let mut worst = 0.0f32;
    for (joint, bone) in GOLDEN_JOINTS {
        let (i, j) = (
            amc.skeleton.find(bone).unwrap(),
            bvh.skeleton.find(joint).unwrap(),
        );
        worst = worst.max(largest_difference(&a, i, &b, j));
    }
    println!("largest difference {worst} m");
    assert!(worst <= GOLDEN_METRES, "{worst} m");
}

fn largest_difference(a: &Array3<f32>, i: usize, b: &Array3<f32>, j: usize) -> f32 {
    assert_eq!(a.dim().0, b.dim().0);
    let mut worst = 0.0f32;
    for frame in 0..a.dim().0 {
        for axis in 0..3 {
            worst = worst.max((a[[frame, i, axis]] - b[[frame, j, axis]]).abs());
        }
    }
    worst
}

#[test]
fn real_conversions_of_two_trials_have_the_same_legs_and_spine() {
    check_golden_pair(
        "cmu/02/02.asf",
        "cmu/02/02_01.amc",
        "bvh/cgspeed/02/02_01.bvh",
        343,
    );
    check_golden_pair(
        "bvh/cgspeed/05.asf",
        "bvh/cgspeed/05_13.amc",
        "bvh/cgspeed/05/05_13.bvh",
        1095,
    );
}

/// Every Acclaim motion of the data with its skeleton.
fn acclaim_clips(data: &Path) -> Vec<(PathBuf, PathBuf)> {
    let mut clips = Vec::new();
    for folder in ["hdm05", "cmu", "c3d/hdm05-take", "bvh/cgspeed"] {
        files_below(&data.join(folder), "amc", &mut clips);
    }
    let mut pairs: Vec<_> = clips
        .into_iter()
        .map(|clip| (skeleton_of(&clip), clip))
        .collect();
    for (name, skeleton, ..) in TRICKY_AMC {
        pairs.push((data.join(skeleton), data.join("tricky/asfamc").join(name)));
    }
    pairs
}

#[test]
fn real_acclaim_motions_survive_a_round_trip_to_the_bit() {
    let Some(data) = data() else { return };
    let pairs = acclaim_clips(&data);
    assert!(pairs.len() > 490, "only {} files", pairs.len());
    for (skeleton, clip) in pairs {
        let asf = read_asf(&skeleton);
        let motion = read_amc(&clip, &asf).motion;
        let mut text = Vec::new();
        write_amc(&motion, &mut text).unwrap();
        assert!(
            parse_amc(&text, &asf).unwrap().motion.channels == motion.channels,
            "{}",
            clip.display()
        );
    }
}

/// Frames per clip that are converted to BVH, so that the whole run takes seconds.
const CONVERTED_FRAMES: usize = 200;

#[test]
fn real_acclaim_motions_keep_their_bone_ends_as_bvh() {
    let Some(data) = data() else { return };
    let mut worst = 0.0f32;
    for (skeleton, clip) in acclaim_clips(&data) {
        let motion = read_amc(&clip, &read_asf(&skeleton)).motion;
        let motion = motion
            .slice(0..motion.n_frames().min(CONVERTED_FRAMES))
            .unwrap();
        let mut text = Vec::new();
        write_bvh(&motion.to_parent_offsets(), &mut text).unwrap();
        let bvh = parse_bvh(&text).unwrap().with_unit(motion.unit).motion;
        let (a, b) = (forward_kinematics(&motion), forward_kinematics(&bvh));
        for bone_idx in 0..motion.skeleton.joints().len() {
            worst = worst.max(largest_difference(
                &a,
                bone_idx,
                &b,
                end_of_bone(&motion, bone_idx, &bvh),
            ));
        }
        assert!(worst <= POSITION_TOLERANCE, "{}: {worst} m", clip.display());
    }
    println!("largest difference {worst} m");
}

/// The joint of `bvh` that stands where a bone of `acclaim` ends: its first child, or its End Site.
fn end_of_bone(acclaim: &Motion, bone_idx: usize, bvh: &Motion) -> usize {
    let joint_idx = bvh
        .skeleton
        .find(&acclaim.skeleton.joints()[bone_idx].name)
        .unwrap();
    let children = bvh.skeleton.joints().iter();
    children
        .clone()
        .position(|j| j.parent == Some(joint_idx))
        .unwrap()
}
