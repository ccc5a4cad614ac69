//! Every file of the data, and the same motion in several formats.

use std::collections::BTreeMap;
use std::path::Path;

use cli::failure::Failure;
use cli::recording::{ReadOptions, Recording, body_map, load};
use cli::source::Format;
use mocap_io::{FrameRate, UpAxis};
use ndarray::{Array3, ArrayView3, Axis, s};
use relfeat::{BodyMap, BodyPoint, FeatureSet, extract};
use walkdir::WalkDir;

use crate::real::data;

/// Files that are not read, and why a person would agree: motions that came without their skeleton.
const REFUSED: [(&str, &str); 4] = [
    (
        "tricky/asfamc/dm_control_zeros.amc",
        "name the skeleton with --asf",
    ),
    ("tricky/asfamc/encadyma_null.amc", "fit equally well"),
    (
        "tricky/asfamc/walk02_01_CRLF.amc",
        "name the skeleton with --asf",
    ),
    (
        "tricky/asfamc/walk02_01_LF.amc",
        "name the skeleton with --asf",
    ),
];
/// The skeletons that they are read with when asked to.
const SKELETONS: [(&str, &str); 4] = [
    ("tricky/asfamc/dm_control_zeros.amc", "cmu/02/02.asf"),
    (
        "tricky/asfamc/encadyma_null.amc",
        "tricky/asfamc/encadyma_mjackson.asf",
    ),
    ("tricky/asfamc/walk02_01_CRLF.amc", "cmu/02/02.asf"),
    ("tricky/asfamc/walk02_01_LF.amc", "cmu/02/02.asf"),
];

#[test]
fn real_every_file_is_read_or_refused_for_a_reason() {
    let Some(data) = data() else { return };
    let mut n_read = 0;
    let mut codes: BTreeMap<&str, usize> = BTreeMap::new();
    let mut refused = Vec::new();
    for entry in WalkDir::new(&data).sort_by_file_name() {
        let entry = entry.unwrap();
        let path = entry.path();
        if !entry.file_type().is_file() || Format::of(path).is_none() {
            continue;
        }
        let name = path.strip_prefix(&data).unwrap().display().to_string();
        match load(path, &ReadOptions::default()) {
            Ok(loaded) => {
                n_read += 1;
                let of_file: Vec<&str> = loaded.warnings.iter().map(|(_, w)| w.code()).collect();
                for code in &of_file {
                    *codes.entry(code).or_default() += 1;
                }
                if !of_file.is_empty() {
                    println!("read with warnings  {name}: {}", of_file.join(" "));
                }
            }
            Err(failure) => {
                println!("refused             {name}: {failure}");
                refused.push((name, failure));
            }
        }
    }
    println!(
        "{n_read} files read, {} refused, warnings {codes:?}",
        refused.len()
    );
    let expected: Vec<&str> = REFUSED.iter().map(|(name, _)| *name).collect();
    let found: Vec<&str> = refused.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(found, expected);
    for ((_, failure), (_, why)) in refused.iter().zip(REFUSED) {
        assert!(matches!(failure, Failure::Input { .. }), "{failure}");
        assert!(failure.to_string().contains(why), "{failure}");
    }
}

#[test]
fn real_motions_without_skeleton_are_read_with_the_one_named() {
    let Some(data) = data() else { return };
    for (motion, skeleton) in SKELETONS {
        let options = ReadOptions {
            asf: Some(data.join(skeleton)),
            ..ReadOptions::default()
        };
        let loaded = load(&data.join(motion), &options).unwrap_or_else(|e| panic!("{e}"));
        assert!(loaded.recording.n_frames() > 0, "{motion}");
    }
}

/// Mean distance that AMC and C3D of one motion may have over all body points, in metres: markers sit
/// on the skin, joints inside.
const MARKERS_NEAR: f64 = 0.06;
/// Share of the feature bits in which they agree.
const SAME_BITS: f64 = 0.88;

/// A motion in several files: the frames of each that belong together.
struct Same {
    amc: &'static str,
    c3d: &'static str,
    /// With the frames in front that only the BVH file has.
    bvh: Option<(&'static str, usize)>,
    n_frames: usize,
}

const SAME: [Same; 3] = [
    Same {
        amc: "cmu/02/02_01.amc",
        c3d: "tricky/c3d/CMU_02_01.c3d",
        bvh: Some(("bvh/cgspeed/02/02_01.bvh", 1)),
        n_frames: 343,
    },
    Same {
        amc: "bvh/cgspeed/05_13.amc",
        c3d: "bvh/cgspeed/05_13.c3d",
        bvh: Some(("bvh/cgspeed/05/05_13.bvh", 1)),
        n_frames: 1095,
    },
    Same {
        amc: "c3d/hdm05-take/HDM_dg_06-03_03_120.amc",
        c3d: "c3d/hdm05-take/HDM_dg_06-03_03_120.c3d",
        bvh: None,
        n_frames: 202,
    },
];

/// Body points and words of a file from `first` on.
fn read(path: &Path, first: usize, n_frames: usize) -> (Vec<Array3<f32>>, Vec<u64>) {
    let options = ReadOptions::default();
    let recording = load(path, &options).unwrap().recording;
    assert_eq!(recording.n_frames(), first + n_frames, "{}", path.display());
    let map = body_map(path, &recording, &options).unwrap();
    let all = recording.positions();
    let positions = all.slice(s![first.., .., ..]);
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let hz = recording.rate().0.hz();
    let words = extract(&set, positions, &map, hz, 30.0).unwrap().words;
    let points = BodyPoint::ALL.map(|point| path_of(positions, &map, point));
    (points.to_vec(), words)
}

/// Shape `(frames, 1, 3)`.
fn path_of(positions: ArrayView3<'_, f32>, map: &BodyMap, point: BodyPoint) -> Array3<f32> {
    let mut path = Array3::zeros((positions.len_of(Axis(0)), 1, 3));
    for &(joint, weight) in map.sources(point) {
        path.scaled_add(weight as f32, &positions.slice(s![.., joint..=joint, ..]));
    }
    path
}

/// Mean distance; `turn` brings the second one's axes to those of the first.
fn distance(a: &Array3<f32>, b: &Array3<f32>, turn: fn([f32; 3]) -> [f32; 3]) -> f64 {
    let pairs = a.lanes(Axis(2)).into_iter().zip(b.lanes(Axis(2)));
    let ways = pairs.map(|(a, b)| {
        let b = turn([b[0], b[1], b[2]]);
        let square: f32 = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum();
        f64::from(square.sqrt())
    });
    ways.sum::<f64>() / a.len_of(Axis(0)) as f64
}

fn shared_bits(a: &[u64], b: &[u64], n_features: u32) -> f64 {
    assert_eq!(a.len(), b.len());
    let different: u32 = a.iter().zip(b).map(|(a, b)| (a ^ b).count_ones()).sum();
    1.0 - f64::from(different) / f64::from(n_features) / a.len() as f64
}

#[test]
fn real_one_motion_in_three_formats_is_one_motion() {
    let Some(data) = data() else { return };
    // CMU and HDM05 turned the laboratory's axes when they solved the skeletons: X of the AMC file is
    // Y of the C3D file, which Y up becomes -Z, and Z is X.
    let of_markers = |[x, y, z]: [f32; 3]| [-z, y, x];
    for same in SAME {
        let (amc, amc_words) = read(&data.join(same.amc), 0, same.n_frames);
        let (c3d, c3d_words) = read(&data.join(same.c3d), 0, same.n_frames);
        let bvh = same
            .bvh
            .map(|(path, first)| read(&data.join(path), first, same.n_frames));
        println!("{}: mean distance in cm from C3D, from BVH", same.amc);
        let mut sum = 0.0;
        for (i, point) in BodyPoint::ALL.iter().enumerate() {
            let from_c3d = distance(&amc[i], &c3d[i], of_markers);
            let from_bvh = bvh
                .as_ref()
                .map(|(bvh, _)| distance(&amc[i], &bvh[i], |at| at));
            sum += from_c3d;
            let text = from_bvh.map_or(String::new(), |way| format!("{:6.1}", 100.0 * way));
            println!("  {:<10} {:5.1} {text}", point.name(), 100.0 * from_c3d);
        }
        let mean = sum / BodyPoint::COUNT as f64;
        let bits = shared_bits(&amc_words, &c3d_words, 39);
        println!(
            "  mean {:.1} cm; {:.1} % of the bits agree",
            100.0 * mean,
            100.0 * bits
        );
        assert!(mean < MARKERS_NEAR, "{}: {mean} m", same.amc);
        assert!(bits >= SAME_BITS, "{}: {bits}", same.amc);
    }
}

#[test]
fn real_overrides_reach_the_positions() {
    let Some(data) = data() else { return };
    let path = data.join("bvh/cgspeed/02/02_01.bvh");
    let read = |options: &ReadOptions| load(&path, options).unwrap().recording;
    let plain = read(&ReadOptions::default());
    let given = read(&ReadOptions {
        rate: FrameRate::from_hz(60.0),
        unit: mocap_io::LengthUnit::from_name("m"),
        up: Some(UpAxis::Z),
        ..ReadOptions::default()
    });
    assert_eq!(given.rate().0.hz(), 60.0);
    let (a, b) = (plain.positions(), given.positions());
    let scale = 1.0 / plain.unit().0.metres() as f32;
    for (a, b) in a.lanes(Axis(2)).into_iter().zip(b.lanes(Axis(2))) {
        // What was Y is read as the direction away from the viewer: (x, y, z) becomes (x, z, -y).
        let expected = [a[0] * scale, a[2] * scale, -a[1] * scale];
        for i in 0..3 {
            assert!(
                (expected[i] - b[i]).abs() <= 1e-4 * scale,
                "{expected:?} {b}"
            );
        }
    }
    assert!(matches!(given, Recording::Joints(_)));
}
