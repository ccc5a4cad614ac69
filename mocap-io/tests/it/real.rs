//! Real files, from the folder that `MOTIF_DATA` names (default: `../shared/data` beside the
//! repository).

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use mocap_io::{Amc, Asf, forward_kinematics, parse_amc, parse_asf};

/// The reference is printed with six decimals, and was computed from the same text: what remains is
/// rounding of `f32` and of the printout, far below what any feature can tell apart.
const POSITION_TOLERANCE: f32 = 1e-4;

/// The folder with the real data; `None` if it is absent, which CI does not forgive.
fn data() -> Option<PathBuf> {
    let dir = std::env::var_os("MOTIF_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"),
        PathBuf::from,
    );
    if dir.is_dir() {
        return Some(dir);
    }
    assert!(std::env::var_os("CI").is_none(), "no data at {}", dir.display());
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
fn skeleton_of(clip: &Path) -> PathBuf {
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

fn files_below(dir: &Path, extension: &str, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(dir).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files_below(&path, extension, found);
        } else if path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension)) {
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

#[test]
fn real_bvh_files_of_all_dialects_load() {
    let Some(data) = data() else { return };
    let mut clips = Vec::new();
    files_below(&data, "bvh", &mut clips);
    assert!(clips.len() > 40, "only {} files", clips.len());
    for clip in &clips {
        let bvh = mocap_io::parse_bvh(&fs::read(clip).unwrap())
            .unwrap_or_else(|e| panic!("{}:{e}", clip.display()));
        let positions = forward_kinematics(&bvh.motion);
        assert!(positions.iter().all(|v| v.is_finite()), "{}", clip.display());
        println!(
            "{}: {} frames, {} Hz, {} joints, unit {} {:?}",
            clip.strip_prefix(&data).unwrap().display(),
            bvh.motion.n_frames(),
            bvh.motion.rate.hz(),
            bvh.motion.skeleton.joints().len(),
            bvh.motion.unit,
            bvh.motion.unit_source
        );
        for warning in bvh.warnings {
            println!("    {warning}");
        }
    }
}
