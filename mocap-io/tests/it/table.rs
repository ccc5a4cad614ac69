//! CSV, NPY and NPZ, read back with other crates.

use std::io::Cursor;

use mocap_io::ndarray::{Array0, Array1, Array2, Array3, s};
use mocap_io::{
    FrameRate, Motion, OffsetFrame, forward_kinematics, write_csv, write_npy, write_npz,
    write_npz_points,
};
use ndarray_npy::{NpzReader, ReadNpyExt, ReadableElement};
use proptest::prelude::*;
use proptest::sample::select;

use crate::naive;
use crate::strategies::{Freedom, angle, motion, skeleton};

/// Quaternions are single precision, and turn offsets of a metre through ten joints.
const POSITION_METRES: f64 = 1e-5;

/// A table as a CSV reader sees it: the header, and rows of a frame, a time and positions.
pub(crate) struct Table {
    pub(crate) header: Vec<String>,
    pub(crate) frames: Vec<usize>,
    pub(crate) times: Vec<f64>,
    pub(crate) positions: Array3<f32>,
}

pub(crate) fn read_csv(bytes: &[u8]) -> Table {
    let mut reader = csv::Reader::from_reader(bytes);
    let header: Vec<String> = reader
        .headers()
        .unwrap()
        .iter()
        .map(str::to_owned)
        .collect();
    let (mut frames, mut times, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.unwrap();
        frames.push(record[0].parse().unwrap());
        times.push(record[1].parse().unwrap());
        let coordinate = |cell: &str| {
            if cell.is_empty() {
                f32::NAN
            } else {
                cell.parse().unwrap()
            }
        };
        values.extend(record.iter().skip(2).map(coordinate));
    }
    let shape = (frames.len(), (header.len() - 2) / 3, 3);
    let positions = Array3::from_shape_vec(shape, values).unwrap();
    Table {
        header,
        frames,
        times,
        positions,
    }
}

/// Equal to the bit, where every NaN is as good as another.
pub(crate) fn same(a: &Array3<f32>, b: &Array3<f32>) -> bool {
    let is_same = |(a, b): (&f32, &f32)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    a.dim() == b.dim() && a.iter().zip(b).all(is_same)
}

pub(crate) fn read_npz<D: mocap_io::ndarray::Dimension, A: ReadableElement>(
    bytes: &[u8],
    name: &str,
) -> mocap_io::ndarray::Array<A, D> {
    NpzReader::new(Cursor::new(bytes))
        .unwrap()
        .by_name(name)
        .unwrap()
}

/// An array of strings of an archive that is not compressed. The crate reads none.
fn read_texts(bytes: &[u8], name: &str) -> Vec<String> {
    let file = format!("{name}.npy\u{93}NUMPY");
    // In the file the byte 0x93 stands alone.
    let start: Vec<u8> = file.chars().map(|c| c as u32 as u8).collect();
    let at = bytes.windows(start.len()).position(|w| w == start).unwrap();
    let array = &bytes[at + start.len() - 6..];
    let header_end = 10 + usize::from(u16::from_le_bytes([array[8], array[9]]));
    assert_eq!(header_end % 64, 0);
    let header = std::str::from_utf8(&array[10..header_end]).unwrap();
    let between = |from: &str, to: &str| {
        let rest = header.split_once(from).unwrap().1;
        rest.split_once(to).unwrap().0.parse::<usize>().unwrap()
    };
    let (n_chars, n_texts) = (between("'<U", "'"), between("'shape': (", ","));
    let text = |i: usize| {
        let chars = array[header_end + 4 * n_chars * i..]
            .chunks(4)
            .take(n_chars);
        let chars =
            chars.map(|c| char::from_u32(u32::from_le_bytes(c.try_into().unwrap())).unwrap());
        chars.collect::<String>().trim_end_matches('\0').to_owned()
    };
    (0..n_texts).map(text).collect()
}

fn names() -> impl Strategy<Value = Vec<String>> {
    let name = prop_oneof![
        select(vec![
            "Hips",
            "mixamorig:Hips",
            "left, upper",
            "say \"a\"",
            "two\nlines",
            "",
            " a ",
            "Hüfte 腰"
        ])
        .prop_map(str::to_owned),
        "[ -~]{0,6}",
    ];
    proptest::collection::vec(name, 0..5)
}

fn coordinate() -> impl Strategy<Value = f32> {
    use proptest::num::f32::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    prop_oneof![
        3 => -2.0f32..2.0,
        1 => Just(f32::NAN),
        1 => POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO,
    ]
}

/// Names, and positions for up to four frames.
fn points() -> impl Strategy<Value = (Vec<String>, Array3<f32>)> {
    (names(), 0usize..4).prop_flat_map(|(names, n_frames)| {
        let shape = (n_frames, names.len(), 3);
        proptest::collection::vec(coordinate(), n_frames * names.len() * 3).prop_map(
            move |values| {
                (
                    names.clone(),
                    Array3::from_shape_vec(shape, values).unwrap(),
                )
            },
        )
    })
}

fn slices(names: &[String]) -> Vec<&str> {
    names.iter().map(String::as_str).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_table_reads_back((names, positions) in points(), hz in 0.1..1000.0) {
        let rate = FrameRate::from_hz(hz).unwrap();
        let mut bytes = Vec::new();
        write_csv(&slices(&names), positions.view(), rate, &mut bytes).unwrap();
        let table = read_csv(&bytes);
        let mut header = vec!["frame".to_owned(), "time_s".to_owned()];
        header.extend(names.iter().flat_map(|n| ["x", "y", "z"].map(|a| format!("{n}_{a}"))));
        prop_assert_eq!(table.header, header);
        prop_assert!(same(&table.positions, &positions));
        for (frame, time) in table.times.into_iter().enumerate() {
            prop_assert_eq!((table.frames[frame], time), (frame, frame as f64 / hz));
        }
    }

    #[test]
    fn arrays_read_back((names, positions) in points(), hz in 0.1..1000.0) {
        let mut bytes = Vec::new();
        write_npy(positions.view(), &mut bytes).unwrap();
        prop_assert!(same(&Array3::read_npy(bytes.as_slice()).unwrap(), &positions));

        let mut bytes = Vec::new();
        let rate = FrameRate::from_hz(hz).unwrap();
        write_npz_points(&slices(&names), positions.view(), rate, &mut bytes).unwrap();
        prop_assert!(same(&read_npz(&bytes, "positions"), &positions));
        prop_assert_eq!(read_texts(&bytes, "names"), names);
        let rate: Array0<f64> = read_npz(&bytes, "rate");
        prop_assert_eq!(rate.into_scalar(), hz);
    }

    #[test]
    fn a_bvh_motion_reads_back_as_arrays(
        motion in motion(skeleton(OffsetFrame::Parent, Freedom::of_bvh()), angle().boxed(), 3)
    ) {
        check_npz(&motion)?;
    }

    #[test]
    fn an_acclaim_motion_reads_back_as_arrays(
        motion in motion(skeleton(OffsetFrame::Own, Freedom::of_turning_bones()), angle().boxed(), 3)
    ) {
        check_npz(&motion)?;
    }
}

fn check_npz(motion: &Motion) -> Result<(), TestCaseError> {
    let mut bytes = Vec::new();
    write_npz(motion, &mut bytes).unwrap();
    let joints = motion.skeleton.joints();
    prop_assert!(same(
        &read_npz(&bytes, "positions"),
        &forward_kinematics(motion)
    ));
    let channels: Array2<f64> = read_npz(&bytes, "channels");
    prop_assert_eq!(&channels, &motion.channels);
    let parents: Array1<i64> = read_npz(&bytes, "parents");
    let offsets: Array2<f64> = read_npz(&bytes, "offsets");
    prop_assert_eq!(
        (parents.len(), offsets.dim()),
        (joints.len(), (joints.len(), 3))
    );
    for (idx, joint) in joints.iter().enumerate() {
        prop_assert_eq!(usize::try_from(parents[idx]).ok(), joint.parent);
        prop_assert_eq!(offsets.row(idx).to_vec(), joint.offset.to_vec());
    }
    let names: Vec<&str> = motion.skeleton.names().collect();
    prop_assert_eq!(read_texts(&bytes, "names"), names);
    let of_channels: Vec<String> = joints
        .iter()
        .flat_map(|j| j.channels.iter().map(|c| format!("{}_{c}", j.name)))
        .collect();
    prop_assert_eq!(read_texts(&bytes, "channel_names"), of_channels);
    prop_assert_eq!(read_texts(&bytes, "up"), ["Y"]);
    let numbers: [Array0<f64>; 2] = ["rate", "unit"].map(|name| read_npz(&bytes, name));
    prop_assert_eq!(
        numbers.map(Array0::into_scalar),
        [motion.rate.hz(), motion.unit.metres()]
    );
    let rotations: Array3<f32> = read_npz(&bytes, "rotations");
    prop_assert_eq!(rotations.dim(), (motion.n_frames(), joints.len(), 4));
    check_rotations(motion, &rotations)
}

/// The rotations put the offsets where the joints are.
fn check_rotations(motion: &Motion, rotations: &Array3<f32>) -> Result<(), TestCaseError> {
    let motion = &Motion {
        unit: mocap_io::LengthUnit::METRE,
        ..motion.clone()
    };
    let joints = motion.skeleton.joints();
    let expected = naive::positions(motion);
    for frame in 0..motion.n_frames() {
        let mut turned: Vec<[f64; 4]> = Vec::new();
        for (idx, joint) in joints.iter().enumerate() {
            let own = [0, 1, 2, 3].map(|i| f64::from(rotations[[frame, idx, i]]));
            turned.push(joint.parent.map_or(own, |p| product(turned[p], own)));
            let (Some(parent), true) = (joint.parent, only_turns(joint)) else {
                continue;
            };
            let by = match motion.skeleton.offset_frame() {
                OffsetFrame::Parent => turned[parent],
                OffsetFrame::Own => turned[idx],
            };
            let offset = turn(by, joint.offset);
            for axis in 0..3 {
                let found = expected[frame][parent][axis] + offset[axis];
                prop_assert!((found - expected[frame][idx][axis]).abs() <= POSITION_METRES);
            }
        }
    }
    for (before, after) in (1..motion.n_frames()).map(|f| (f - 1, f)) {
        for idx in 0..joints.len() {
            let of = |frame: usize| rotations.slice(s![frame, idx, ..]);
            prop_assert!(of(before).dot(&of(after)) >= -f32::EPSILON, "a sign flips");
        }
    }
    Ok(())
}

fn only_turns(joint: &mocap_io::Joint) -> bool {
    let mut channels = joint.channels.iter();
    channels.all(|c| matches!(c, mocap_io::Channel::Rotation(_)))
}

/// Hamilton's product of w, x, y, z.
fn product([a, b, c, d]: [f64; 4], [e, f, g, h]: [f64; 4]) -> [f64; 4] {
    [
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    ]
}

fn turn(q: [f64; 4], [x, y, z]: [f64; 3]) -> [f64; 3] {
    let inverse = [q[0], -q[1], -q[2], -q[3]];
    let [_, x, y, z] = product(product(q, [0.0, x, y, z]), inverse);
    [x, y, z]
}

#[test]
fn a_table_is_written_as_it_should_look() {
    let positions = Array3::from_shape_vec((2, 1, 3), vec![0.1, -2.0, 0.0, f32::NAN, 1e-7, 3.5]);
    let rate = FrameRate::from_hz(4.0).unwrap();
    let mut bytes = Vec::new();
    write_csv(&["a, \"b\""], positions.unwrap().view(), rate, &mut bytes).unwrap();
    let expected = "frame,time_s,\"a, \"\"b\"\"_x\",\"a, \"\"b\"\"_y\",\"a, \"\"b\"\"_z\"\n\
                    0,0,0.1,-2,0\n1,0.25,,0.0000001,3.5\n";
    assert_eq!(String::from_utf8(bytes).unwrap(), expected);
}

#[test]
fn positions_that_do_not_fit_are_refused() {
    let rate = FrameRate::from_hz(4.0).unwrap();
    for (shape, n_names) in [((2, 2, 3), 1), ((2, 1, 2), 1), ((0, 1, 3), 0)] {
        let positions = Array3::zeros(shape);
        let names = vec!["a"; n_names];
        let expected = format!(
            "expected positions of shape (frames, {n_names}, 3), found {:?}",
            [shape.0, shape.1, shape.2]
        );
        let error = write_csv(&names, positions.view(), rate, Vec::new()).unwrap_err();
        assert_eq!(error.to_string(), expected);
        let error = write_npz_points(&names, positions.view(), rate, Vec::new()).unwrap_err();
        assert_eq!(error.to_string(), expected);
    }
    let mut infinite = Array3::zeros((2, 2, 3));
    infinite[[1, 1, 2]] = f32::NEG_INFINITY;
    let error = write_csv(&["a", "b"], infinite.view(), rate, Vec::new()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "joint \"b\", frame 1: expected finite values, found -inf"
    );
}
