//! The files of `motif walk`, read back.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use gltf::Gltf;
use gltf::animation::util::ReadOutputs;
use mocap_io::{Motion, UpAxis, forward_kinematics};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

use crate::jumps::Steps;
use crate::walk::{Bundles, ids, motion, result};

/// Metres: GLB files are in single precision, which leaves some 1e-5 m after ten joints; feet that slide
/// a tenth of this between frames of 60 Hz slide 0.6 mm/s.
const SAME_PLACE: f32 = 1e-4;

/// Seconds: times in GLB files are in single precision.
const SAME_TIME: f64 = 1e-5;

/// Where each joint is, by name, in metres, Y up.
type Places = BTreeMap<String, Vec<[f32; 3]>>;

fn places_of(motion: &Motion) -> Places {
    let motion = motion.to_up(UpAxis::Y);
    let places = forward_kinematics(&motion);
    let of_joint = |j: usize| {
        let frames = 0..motion.n_frames();
        frames
            .map(|k| [0, 1, 2].map(|axis| places[[k, j, axis]]))
            .collect()
    };
    let names = motion.skeleton.names().map(str::to_owned);
    names
        .enumerate()
        .map(|(j, name)| (name, of_joint(j)))
        .collect()
}

/// Places of the nodes of a GLB file, and the times of its keys.
fn read_glb(file: &Path) -> (Places, Vec<f32>) {
    let gltf = Gltf::from_slice(&fs::read(file).unwrap()).unwrap();
    let binary = gltf.blob.as_deref();
    let mut parents = vec![None; gltf.nodes().len()];
    for node in gltf.nodes() {
        node.children()
            .for_each(|child| parents[child.index()] = Some(node.index()));
    }
    let turn =
        |[x, y, z, w]: [f32; 4]| UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    let rest = gltf.nodes().map(|node| {
        let (shift, rotation, scale) = node.transform().decomposed();
        assert_eq!(scale, [1.0; 3]);
        Isometry3::from_parts(Translation3::from(shift), turn(rotation))
    });
    let rest: Vec<Isometry3<f32>> = rest.collect();
    let animation = gltf.animations().next().unwrap();
    let mut all_times: Option<Vec<f32>> = None;
    let mut locals: Vec<Vec<Isometry3<f32>>> = Vec::new();
    for channel in animation.channels() {
        let node = channel.target().node().index();
        let reader = channel.reader(|_| binary);
        let times: Vec<f32> = reader.read_inputs().unwrap().collect();
        locals.resize(times.len(), rest.clone());
        assert_eq!(all_times.get_or_insert(times.clone()), &times);
        match reader.read_outputs().unwrap() {
            ReadOutputs::Translations(values) => {
                let keys = locals.iter_mut().zip(values);
                keys.for_each(|(local, value)| local[node].translation = value.into());
            }
            ReadOutputs::Rotations(values) => {
                let keys = locals.iter_mut().zip(values.into_f32());
                keys.for_each(|(local, value)| local[node].rotation = turn(value));
            }
            _ => panic!("a walk neither scales nor morphs"),
        }
    }
    let mut places = Places::new();
    for local in &locals {
        let mut worlds: Vec<Isometry3<f32>> = Vec::new();
        for node in gltf.nodes() {
            // Parents come before their children.
            let parent = parents[node.index()].map_or(Isometry3::identity(), |p: usize| worlds[p]);
            let world = parent * local[node.index()];
            let of_node = places.entry(node.name().unwrap().to_owned()).or_default();
            of_node.push(world.translation.vector.into());
            worlds.push(world);
        }
    }
    (places, all_times.unwrap())
}

/// Asserts that all joints of `expected` are where they are in `found`, and gives how far they are apart.
#[track_caller]
fn assert_same(expected: &Places, found: &Places) -> f32 {
    let mut farthest: f32 = 0.0;
    for (name, expected) in expected {
        let found = found.get(name).unwrap_or_else(|| panic!("no {name}"));
        assert_eq!(expected.len(), found.len(), "{name}");
        for (k, (a, b)) in expected.iter().zip(found).enumerate() {
            let far = (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f32::max);
            assert!(far <= SAME_PLACE, "{name}, frame {k}: {a:?} is not {b:?}");
            farthest = farthest.max(far);
        }
    }
    farthest
}

/// All formats hold the same motion, as it is and with feet locked; it does not jump, and locked feet
/// slide less.
#[test]
fn every_format_holds_the_walk_without_jumps_and_locked_feet_skate_less() {
    let bundles = Bundles::get();
    let dir = tempfile::tempdir().unwrap();
    let sources = bundles.steps();
    let way = ["--random", "12", "--seed", "5"];
    for locked in [false, true] {
        let more: &[&str] = if locked { &["--footlock"] } else { &[] };
        let files = ["bvh", "amc", "glb"].map(|e| dir.path().join(format!("walk{locked}.{e}")));
        let told = files
            .each_ref()
            .map(|file| result(&bundles.walk(&[&way[..], more].concat(), file)));
        for other in &told[1..] {
            for key in [
                "bundles",
                "pieces",
                "frames",
                "seconds",
                "skate_before",
                "skate_after",
            ] {
                assert_eq!(told[0][key], other[key], "{key}");
            }
        }
        assert!(ids(&told[0]).len() > 1);
        assert_eq!(
            told[1]["files"].as_array().unwrap().len(),
            2,
            "with its .asf"
        );

        let [bvh, amc] = [0, 1].map(|i| motion(&files[i]));
        let n_frames = told[0]["frames"].as_u64().unwrap() as usize;
        assert_eq!([bvh.n_frames(), amc.n_frames()], [n_frames; 2]);
        assert_eq!(bvh.rate, amc.rate);
        let (in_glb, times) = read_glb(&files[2]);
        assert_eq!(times.len(), n_frames);
        for (k, &time) in times.iter().enumerate() {
            assert!(
                (f64::from(time) - k as f64 / bvh.rate.hz()).abs() <= SAME_TIME,
                "key {k}"
            );
        }
        let expected = places_of(&bvh);
        let apart = [
            assert_same(&expected, &places_of(&amc)),
            assert_same(&expected, &in_glb),
        ];
        let ratio = Steps::of(&bvh).assert_no_jump(&sources);
        println!(
            "{n_frames} frames of {} joints; AMC {:.0e} m and GLB {:.0e} m from BVH; steps up to {ratio:.2} of the takes'; \
            skate {} m/s, locked {} m/s",
            expected.len(),
            apart[0],
            apart[1],
            told[0]["skate_before"],
            told[0]["skate_after"]
        );
        if locked {
            let [before, after] =
                ["skate_before", "skate_after"].map(|k| told[0][k].as_f64().unwrap());
            assert!(after < before, "{after} of {before}");
        }
    }
}
