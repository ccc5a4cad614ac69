//! Positions survive every format: parse(write(x)) puts the joints where x has them.

use std::path::Path;

use mocap_io::ndarray::{Array3, ArrayView3, Axis};
use mocap_io::{
    Asf, Motion, OffsetFrame, forward_kinematics, parse_amc, parse_asf, parse_bvh, write_amc,
    write_asf, write_bvh, write_csv, write_glb, write_npy, write_npz,
};
use ndarray_npy::ReadNpyExt;

use crate::real::{acclaim_clips, data, files_below, read_amc, read_asf, read_bvh};
use crate::scene::Scene;
use crate::table::{read_csv, read_npz, same};

/// What is promised of every format; arrays and tables keep every bit.
const POSITION_METRES: f32 = 1e-4;

/// Frames of each clip that are written and read, spread evenly from the first to the last: a frame is
/// written without regard to the others, and this way every clip is tried in seconds. Other tests
/// compare all channel values of all frames of BVH and AMC to the bit.
const SPREAD_FRAMES: usize = 12;

fn spread(motion: &Motion) -> Motion {
    let last = motion.n_frames().saturating_sub(1);
    let n_frames = motion.n_frames().min(SPREAD_FRAMES);
    let frames: Vec<usize> = (0..n_frames)
        .map(|i| i * last / (n_frames - 1).max(1))
        .collect();
    let channels = motion.channels.select(Axis(0), &frames);
    Motion {
        channels,
        ..motion.clone()
    }
}

/// The largest difference of a coordinate.
#[track_caller]
fn difference(a: ArrayView3<'_, f32>, b: ArrayView3<'_, f32>) -> f32 {
    assert_eq!(a.dim(), b.dim());
    assert!(a.iter().chain(b).all(|v| v.is_finite()));
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max)
}

/// What a BVH file does not say is taken from the motion that was written.
fn through_bvh(motion: &Motion) -> Motion {
    let mut text = Vec::new();
    write_bvh(motion, &mut text).unwrap();
    let Motion { unit, up, .. } = *motion;
    Motion {
        unit,
        up,
        ..parse_bvh(&text).unwrap().motion
    }
}

/// The joints of `converted` that stand where the joints of `motion` are: those themselves, or, where an
/// Acclaim bone ends, the first child of the joint of its name.
fn same_places(motion: &Motion, converted: &Motion) -> Vec<usize> {
    let joints = converted.skeleton.joints();
    match motion.skeleton.offset_frame() {
        OffsetFrame::Parent => (0..joints.len()).collect(),
        OffsetFrame::Own => {
            let first_child = |name| {
                let start = converted.skeleton.find(name);
                joints.iter().position(|j| j.parent == start).unwrap()
            };
            motion.skeleton.names().map(first_child).collect()
        }
    }
}

/// The largest difference through GLB, and through BVH after a conversion where that is needed.
fn converted_difference(motion: &Motion, positions: &Array3<f32>) -> f32 {
    let bvh = through_bvh(&motion.to_parent_offsets());
    let places = same_places(motion, &bvh);
    let found = forward_kinematics(&bvh).select(Axis(1), &places);
    let of_bvh = difference(found.view(), positions.view());

    let mut bytes = Vec::new();
    write_glb(motion, &mut bytes).unwrap();
    let scene = Scene::read(&bytes);
    // The node above the roots comes first, then the joints.
    let nodes: Vec<usize> = places.iter().map(|joint| joint + 1).collect();
    for (node, joint) in scene.names[1..].iter().zip(bvh.skeleton.joints()) {
        assert_eq!(node, &joint.name);
    }
    let found = scene.positions(motion.n_frames(), &nodes);
    of_bvh.max(difference(found.view(), positions.view()))
}

/// Tables and arrays keep every bit.
fn check_tables(motion: &Motion, positions: &Array3<f32>, clip: &Path) {
    let clip = clip.display();
    let names: Vec<&str> = motion.skeleton.names().collect();
    let mut bytes = Vec::new();
    write_csv(&names, positions.view(), motion.rate, &mut bytes).unwrap();
    let table = read_csv(&bytes);
    assert!(same(&table.positions, positions), "{clip}");
    assert_eq!(table.header.len(), 2 + 3 * names.len(), "{clip}");
    bytes.clear();
    write_npy(positions.view(), &mut bytes).unwrap();
    assert!(
        same(&Array3::read_npy(bytes.as_slice()).unwrap(), positions),
        "{clip}"
    );
    bytes.clear();
    write_npz(motion, &mut bytes).unwrap();
    assert!(same(&read_npz(&bytes, "positions"), positions), "{clip}");
}

#[test]
fn real_bvh_positions_survive_every_format() {
    let Some(data) = data() else { return };
    let mut clips = Vec::new();
    files_below(&data, "bvh", &mut clips);
    let mut worst = 0.0f32;
    for clip in &clips {
        let motion = spread(&read_bvh(clip).motion);
        let positions = forward_kinematics(&motion);
        check_tables(&motion, &positions, clip);
        worst = worst.max(converted_difference(&motion, &positions));
        assert!(worst <= POSITION_METRES, "{}: {worst} m", clip.display());
    }
    println!("{} files, largest difference {worst} m", clips.len());
    assert!(clips.len() > 40, "only {} files", clips.len());
}

/// Through both Acclaim files.
fn through_acclaim(asf: &Asf, motion: &Motion) -> Motion {
    let (mut skeleton, mut frames) = (Vec::new(), Vec::new());
    write_asf(asf, &mut skeleton).unwrap();
    write_amc(motion, &mut frames).unwrap();
    parse_amc(&frames, &parse_asf(&skeleton).unwrap())
        .unwrap()
        .motion
}

#[test]
fn real_acclaim_positions_survive_every_format() {
    let Some(data) = data() else { return };
    let clips = acclaim_clips(&data);
    assert!(clips.len() > 490, "only {} files", clips.len());
    let mut worst = 0.0f32;
    for (skeleton, clip) in &clips {
        let asf = read_asf(skeleton);
        let motion = spread(&read_amc(clip, &asf).motion);
        let positions = forward_kinematics(&motion);
        check_tables(&motion, &positions, clip);
        let again = forward_kinematics(&through_acclaim(&asf, &motion));
        worst = worst
            .max(difference(again.view(), positions.view()))
            .max(converted_difference(&motion, &positions));
        assert!(worst <= POSITION_METRES, "{}: {worst} m", clip.display());
    }
    println!("{} files, largest difference {worst} m", clips.len());
}

/// Bones of different lengths along different axes: an offset that slipped to the joint above or below
/// would show.
#[test]
fn offsets_of_a_converted_skeleton_stand_at_the_right_joints() {
    let skeleton = ":units\nlength 1\n:root\norder TX TY TZ RX RY RZ\nposition 0 0 0\n:bonedata\n\
         begin\nname hip\ndirection 1 0 0\nlength 2\naxis 0 0 30 XYZ\ndof rx ry rz\nend\n\
         begin\nname thigh\ndirection 0 -1 0\nlength 3\naxis 40 0 0 XYZ\ndof rx\nend\n\
         begin\nname shin\ndirection 0 0 1\nlength 5\naxis 0 50 0 XYZ\nend\n\
         :hierarchy\nbegin\nroot hip\nhip thigh\nthigh shin\nend\n";
    let asf = parse_asf(skeleton.as_bytes()).unwrap();
    let rest = parse_amc(b"1\nroot 0 0 0 0 0 0\nhip 0 0 0\nthigh 0\n", &asf)
        .unwrap()
        .motion;
    let mut bvh = Vec::new();
    write_bvh(&rest.to_parent_offsets(), &mut bvh).unwrap();
    let bvh = String::from_utf8(bvh).unwrap();
    let words: Vec<&str> = bvh.split_whitespace().collect();
    let offset_of = |name: &[&str]| {
        let at = words.windows(name.len()).position(|w| w == name).unwrap();
        let numbers = &words[at + name.len() + 2..][..3];
        numbers
            .iter()
            .map(|n| n.parse().unwrap())
            .collect::<Vec<f64>>()
    };
    // A joint starts where the bone before it ends, and the first bone at the root.
    assert_eq!(offset_of(&["JOINT", "hip"]), [0.0, 0.0, 0.0]);
    assert_eq!(offset_of(&["JOINT", "thigh"]), [2.0, 0.0, 0.0]);
    assert_eq!(offset_of(&["JOINT", "shin"]), [0.0, -3.0, 0.0]);
    assert_eq!(offset_of(&["End", "Site"]), [0.0, 0.0, 5.0]);
}
