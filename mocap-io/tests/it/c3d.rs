//! C3D files written by the tests: what the format allows, and what exporters make of it.

use mocap_io::{
    ByteOrder, C3d, EventSource, LengthUnit, ParseErrorKind, Position, RateSource, Storage,
    UnitSource, UpAxis, UpSource, parse_c3d,
};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

use crate::c3d_writer::{Value, Writer, texts};

const ORDERS: [ByteOrder; 3] = [ByteOrder::Intel, ByteOrder::Dec, ByteOrder::Mips];
const STORAGES: [Storage; 2] = [Storage::Integer, Storage::Float];

/// Two markers in three frames; the second is missing in the middle.
fn small(order: ByteOrder, storage: Storage) -> Writer {
    let frame = |k: f32, word| vec![[k, 20.0, 300.5, 0x0307 as f32], [-4.0, k, 170.0, word]];
    Writer::new(
        order,
        storage,
        vec![frame(1.0, 0.0), frame(2.0, -1.0), frame(3.0, 2.0)],
    )
}

#[track_caller]
fn read(writer: &Writer) -> C3d {
    parse_c3d(&writer.write()).unwrap()
}

#[track_caller]
fn check_codes(c3d: &C3d, expected: &[&str]) {
    let codes: Vec<&str> = c3d.warnings.iter().map(|w| w.code()).collect();
    assert_eq!(codes, expected, "{:?}", c3d.warnings);
}

#[test]
fn every_byte_order_and_type_says_the_same() {
    for order in ORDERS {
        for storage in STORAGES {
            let c3d = read(&small(order, storage));
            let markers = &c3d.markers;
            assert_eq!((c3d.byte_order, c3d.storage), (order, storage));
            assert_eq!(markers.names, ["M0", "M1"]);
            assert_eq!(markers.positions.dim(), (3, 2, 3));
            assert_eq!(markers.positions[[2, 0, 0]], 3.0);
            assert_eq!(markers.positions[[0, 0, 2]], 300.5);
            assert!((0..3).all(|axis| markers.positions[[1, 1, axis]].is_nan()));
            // The low byte times the scale; the high byte is the cameras.
            assert_eq!(markers.residuals[[0, 0]], 7.0 * 0.1);
            assert_eq!(c3d.cameras[[0, 0]], 3);
            assert_eq!(markers.residuals[[0, 1]], 0.0);
            assert!(markers.residuals[[1, 1]].is_nan());
            assert_eq!(markers.rate.hz(), 100.0);
            assert_eq!(markers.rate_source, RateSource::File);
            assert_eq!(
                (markers.unit, markers.unit_source),
                (LengthUnit::MILLIMETRE, UnitSource::File)
            );
            assert_eq!(markers.first_frame_number, 1);
            check_codes(&c3d, &[]);
        }
    }
}

/// Half a step of the integers, and the rounding of `f32` before it.
fn rounding(scale: f32) -> f32 {
    scale * 0.51
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Points and analog values come back as they were written: floats to the bit, integers to half
    /// a step. VAX floats have two exponents less than IEEE ones, which no coordinate needs.
    #[test]
    fn what_is_written_is_read(
        order in select(ORDERS.to_vec()),
        storage in select(STORAGES.to_vec()),
        n_points in 1usize..5,
        numbers in vec((-3000.0f32..3000.0, -3000.0f32..3000.0, 1.0f32..3000.0, -1i16..0x7fff), 1..40),
        (n_channels, samples_per_frame) in (0usize..4, 1usize..4),
        first_frame in 1u16..1000,
        parameter_block in 2u8..6,
    ) {
        let n_frames = numbers.len().div_ceil(n_points);
        let point = |i: usize| {
            let (x, y, z, word) = numbers[i % numbers.len()];
            [x, y, z, f32::from(word)]
        };
        let points = (0..n_frames).map(|f| (0..n_points).map(|p| point(f * n_points + p)).collect());
        let mut writer = Writer::new(order, storage, points.collect());
        let n_analog = n_channels * samples_per_frame;
        writer.analog = (0..n_frames).map(|f| (0..n_analog).map(|i| (f * 7 + i) as f32 - 3.0).collect()).collect();
        writer.samples_per_frame = samples_per_frame as u16;
        writer.set("ANALOG", "USED", Value::Integers(vec![n_channels as u16]));
        writer.set("ANALOG", "GEN_SCALE", Value::Floats(vec![0.5]));
        writer.set("ANALOG", "OFFSET", Value::Integers(vec![4; n_channels]));
        writer.set("ANALOG", "SCALE", Value::Floats(vec![3.0; n_channels]));
        writer.first_frame = first_frame;
        writer.parameter_block = parameter_block;
        let c3d = read(&writer);
        prop_assert_eq!(c3d.markers.n_frames(), n_frames);
        prop_assert_eq!(c3d.markers.first_frame_number, u64::from(first_frame));
        let all_missing = writer.points.iter().flatten().all(|p| p[3] < 0.0);
        for (f, frame) in writer.points.iter().enumerate() {
            for (p, point) in frame.iter().enumerate() {
                for axis in 0..3 {
                    let found = c3d.markers.positions[[f, p, axis]];
                    if point[3] < 0.0 && !all_missing {
                        prop_assert!(found.is_nan());
                    } else if storage == Storage::Float {
                        prop_assert_eq!(found, point[axis]);
                    } else {
                        prop_assert!((found - point[axis]).abs() <= rounding(writer.scale));
                    }
                }
                if point[3] >= 0.0 {
                    let word = point[3] as u16;
                    let residual = f32::from(word & 255) * writer.scale;
                    prop_assert_eq!(c3d.markers.residuals[[f, p]], residual);
                    prop_assert_eq!(u16::from(c3d.cameras[[f, p]]), word >> 8);
                }
            }
        }
        prop_assert_eq!(c3d.analog.is_some(), n_analog > 0);
        if let Some(analog) = c3d.analog {
            prop_assert_eq!(analog.values.dim(), (n_frames * samples_per_frame, n_channels));
            prop_assert_eq!(analog.rate.hz(), 100.0 * samples_per_frame as f64);
            for ((sample, channel), &value) in analog.values.indexed_iter() {
                let frame = &writer.analog[sample / samples_per_frame];
                let stored = frame[sample % samples_per_frame * n_channels + channel];
                prop_assert_eq!(value, (stored - 4.0) * 1.5);
            }
        }
    }

    /// Cut anywhere, a file gives its whole frames or an error.
    #[test]
    fn a_file_may_end_anywhere(order in select(ORDERS.to_vec()), share in 0.0..1.0f64) {
        let bytes = small(order, Storage::Float).write();
        let cut = (bytes.len() as f64 * share) as usize;
        match parse_c3d(&bytes[..cut]) {
            Ok(c3d) => prop_assert!(c3d.markers.n_frames() >= 1),
            Err(error) => prop_assert!(error.at.byte() <= cut),
        }
    }
}

#[test]
fn more_markers_than_one_parameter_can_name() {
    let frame: Vec<[f32; 4]> = (0..600).map(|i| [i as f32, 1.0, 2.0, 0.0]).collect();
    let c3d = read(&Writer::new(
        ByteOrder::Intel,
        Storage::Float,
        vec![frame; 2],
    ));
    assert_eq!(c3d.markers.names.len(), 600);
    assert_eq!(c3d.markers.names[599], "M599");
    assert_eq!(c3d.markers.positions[[1, 599, 0]], 599.0);
    check_codes(&c3d, &[]);
}

/// One marker on its way along X.
fn long(n_frames: usize) -> Writer {
    let points = (0..n_frames).map(|f| vec![[f as f32, 5.0, 100.0, 0.0]]);
    Writer::new(ByteOrder::Intel, Storage::Float, points.collect())
}

#[test]
fn more_frames_than_a_word_can_count() {
    const N: usize = 70_000;
    let saturated = long(N);
    let mut by_long_frames = saturated.clone();
    by_long_frames.set("POINT", "LONG_FRAMES", Value::Floats(vec![N as f32]));
    let mut by_float = saturated.clone();
    by_float.set("POINT", "FRAMES", Value::Floats(vec![N as f32]));
    let mut by_trial = saturated.clone();
    let words = |n: usize| Value::Integers(vec![(n & 0xffff) as u16, (n >> 16) as u16]);
    by_trial.set("TRIAL", "ACTUAL_START_FIELD", words(1));
    by_trial.set("TRIAL", "ACTUAL_END_FIELD", words(N));
    // Some writers let the count wrap around.
    let mut wrapped = saturated.clone();
    wrapped.set(
        "POINT",
        "FRAMES",
        Value::Integers(vec![(N & 0xffff) as u16]),
    );
    for (writer, name) in [
        (by_long_frames, "LONG_FRAMES"),
        (by_float, "FRAMES as float"),
        (by_trial, "TRIAL"),
        (wrapped, "wrapped"),
    ] {
        let markers = read(&writer).markers;
        assert_eq!(markers.n_frames(), N, "{name}");
        assert_eq!(markers.positions[[N - 1, 0, 0]], (N - 1) as f32, "{name}");
    }
    // Nothing but the size says it; what fills the last block cannot be told from frames at the origin.
    let n_frames = read(&saturated).markers.n_frames();
    assert!((N..N + 512 / 16).contains(&n_frames), "{n_frames}");
}

#[test]
fn a_trial_that_starts_late_keeps_its_number() {
    let mut writer = small(ByteOrder::Dec, Storage::Integer);
    writer.set("TRIAL", "ACTUAL_START_FIELD", Value::Integers(vec![1, 2]));
    writer.set("TRIAL", "ACTUAL_END_FIELD", Value::Integers(vec![3, 2]));
    assert_eq!(read(&writer).markers.first_frame_number, 131_073);
}

#[test]
fn points_at_the_origin_that_nothing_measured_are_missing() {
    let frame = |word| {
        vec![
            [0.0, 0.0, 0.0, word],
            [1.0, 2.0, 3.0, 0.0],
            [0.0, 4.0, 0.0, 0.0],
        ]
    };
    for (word, missing) in [
        (0.0, true),
        (32_767.0, true),
        (65_535.0, true),
        (-1.0, true),
        (9.0, false),
    ] {
        let c3d = read(&Writer::new(
            ByteOrder::Intel,
            Storage::Float,
            vec![frame(word); 2],
        ));
        assert_eq!(c3d.markers.positions[[0, 0, 0]].is_nan(), missing, "{word}");
        assert_eq!(c3d.markers.positions[[1, 2, 1]], 4.0);
        // -1 is the format's own mark, and 65535 the same bits.
        let zeros = [0.0, 32_767.0].contains(&word);
        check_codes(&c3d, if zeros { &["C3D014"] } else { &[] });
    }
}

#[test]
fn when_all_points_are_marked_invalid_coordinates_count() {
    let frames = vec![
        vec![
            [1.0, 2.0, 3.0, -1.0],
            [-1e9, -1e9, -1e9, -1.0],
            [0.0, 0.0, 0.0, -1.0]
        ];
        2
    ];
    let c3d = read(&Writer::new(ByteOrder::Intel, Storage::Float, frames));
    assert_eq!(c3d.markers.positions[[0, 0, 1]], 2.0);
    assert!(c3d.markers.positions[[0, 1, 1]].is_nan() && c3d.markers.positions[[0, 2, 1]].is_nan());
    assert!(c3d.markers.residuals.iter().all(|r| r.is_nan()));
    check_codes(&c3d, &["C3D015", "C3D014"]);
}

#[test]
fn outputs_of_a_gait_model_are_no_markers_and_not_lost() {
    let frame = vec![
        [1.0, 2.0, 3.0, 0.0],
        [30.0, 0.0, -5.0, 0.0],
        [0.0, 0.0, 0.0, 0.0],
        [4.0, 5.0, 6.0, 0.0],
    ];
    let mut writer = Writer::new(ByteOrder::Mips, Storage::Float, vec![frame; 3]);
    writer.set(
        "POINT",
        "LABELS",
        texts(&["LASI", "LKneeAngles", "Grip", "RASI"]),
    );
    writer.set("POINT", "ANGLES", texts(&["LKneeAngles", "RKneeAngles"]));
    writer.set("POINT", "ANGLE_UNITS", texts(&["deg"]));
    writer.set(
        "POINT",
        "TYPE_GROUPS",
        texts(&["GRIPS", "GRIP", "MODELED_MARKERS", "LENGTH"]),
    );
    writer.set("POINT", "GRIPS", texts(&["Grip"]));
    writer.set("POINT", "MODELED_MARKERS", texts(&["RASI"]));
    let c3d = read(&writer);
    assert_eq!(c3d.markers.names, ["LASI", "RASI"]);
    assert_eq!(c3d.markers.positions[[2, 1, 2]], 6.0);
    assert_eq!(c3d.other_points.names, ["LKneeAngles", "Grip"]);
    assert_eq!(c3d.other_points.kinds, ["ANGLES", "GRIPS"]);
    assert_eq!(c3d.other_points.units, [Some("deg".to_owned()), None]);
    assert_eq!(c3d.other_points.values[[0, 0, 2]], -5.0);
    // A zero is an ordinary value of what is no position.
    assert_eq!(c3d.other_points.values[[0, 1, 0]], 0.0);
    check_codes(&c3d, &[]);
}

#[test]
fn events_count_from_the_first_frame_of_the_file() {
    let mut writer = small(ByteOrder::Dec, Storage::Float);
    writer.first_frame = 51;
    writer.events = vec![(0.01, "RHS"), (0.02, "RTO")];
    writer.set("EVENT", "USED", Value::Integers(vec![3]));
    writer.set(
        "EVENT",
        "LABELS",
        texts(&["Foot Strike", "Foot Off", "lost"]),
    );
    writer.set("EVENT", "CONTEXTS", texts(&["Left", "", "Right"]));
    writer.set("EVENT", "SUBJECTS", texts(&["", "A22", ""]));
    // Frame 51 at 100 Hz is half a second after frame 1.
    writer.set(
        "EVENT",
        "TIMES",
        Value::Times(vec![[0.0, 0.515], [1.0, 0.5]]),
    );
    let c3d = read(&writer);
    let summary: Vec<(&str, Option<&str>, Option<&str>, f64)> = c3d
        .events
        .iter()
        .map(|e| {
            (
                e.label.as_str(),
                e.context.as_deref(),
                e.subject.as_deref(),
                (e.seconds * 1e5).round() / 1e5,
            )
        })
        .collect();
    assert_eq!(
        summary,
        [
            ("RHS", None, None, 0.01),
            ("RTO", None, None, 0.02),
            ("Foot Strike", Some("Left"), None, 0.015),
            ("Foot Off", None, Some("A22"), 60.0),
        ]
    );
    assert_eq!(
        (c3d.events[1].source, c3d.events[2].source),
        (EventSource::Header, EventSource::Parameters)
    );
    check_codes(&c3d, &["C3D017"]);
}

#[test]
fn unsigned_samples_have_no_sign() {
    let mut writer = small(ByteOrder::Mips, Storage::Integer);
    writer.analog = vec![vec![65_000.0, 1.0]; 3];
    writer.set("ANALOG", "USED", Value::Integers(vec![2]));
    writer.set("ANALOG", "OFFSET", Value::Integers(vec![32_768, 0]));
    writer.set("ANALOG", "LABELS", texts(&["Fz"]));
    let first = |writer: &Writer| read(writer).analog.unwrap().values[[0, 0]];
    // As signed numbers both wrap around.
    assert_eq!(first(&writer), -536.0 + 32_768.0);
    writer.set("ANALOG", "FORMAT", texts(&["UNSIGNED"]));
    writer.set("ANALOG", "OFFSET", Value::Integers(vec![40_000, 0]));
    assert_eq!(first(&writer), 25_000.0);
    assert_eq!(read(&writer).analog.unwrap().names, ["Fz", ""]);
}

#[test]
fn what_is_missing_is_taken_from_elsewhere() {
    let mut writer = small(ByteOrder::Intel, Storage::Float);
    writer.rate = 50.0;
    for name in ["USED", "FRAMES", "SCALE", "RATE", "UNITS", "LABELS"] {
        writer.remove("POINT", name);
    }
    let c3d = read(&writer);
    assert_eq!(c3d.markers.names, ["point1", "point2"]);
    assert_eq!(c3d.markers.rate.hz(), 50.0);
    assert!(matches!(
        c3d.markers.unit_source,
        UnitSource::Guessed { .. }
    ));
    check_codes(&c3d, &["C3D012"]);
    writer.rate = 0.0;
    let c3d = read(&writer);
    assert_eq!(c3d.markers.rate_source, RateSource::Default);
    check_codes(&c3d, &["C3D012", "C3D010"]);
}

#[test]
fn without_parameters_the_header_is_enough() {
    let mut bytes = small(ByteOrder::Mips, Storage::Integer).write();
    bytes[512..1024].fill(0);
    let c3d = parse_c3d(&bytes).unwrap();
    assert_eq!(c3d.byte_order, ByteOrder::Mips);
    assert_eq!(c3d.markers.positions[[2, 0, 0]], 3.0);
    check_codes(&c3d, &["C3D012", "C3D002", "C3D001"]);
}

#[test]
fn the_size_of_the_file_decides_between_header_and_parameters() {
    // Two of four points would be a frame half as long.
    let frame = vec![[1.0, 2.0, 3.0, 0.0]; 40];
    let mut writer = Writer::new(ByteOrder::Intel, Storage::Float, vec![frame; 40]);
    writer.set("POINT", "USED", Value::Integers(vec![20]));
    writer.set("POINT", "SCALE", Value::Floats(vec![0.1]));
    writer.set("POINT", "DATA_START", Value::Integers(vec![9]));
    writer.set("POINT", "RATE", Value::Floats(vec![60.0]));
    let c3d = read(&writer);
    assert_eq!(c3d.markers.positions.dim(), (40, 40, 3));
    assert_eq!(c3d.storage, Storage::Float);
    assert!(
        c3d.markers
            .positions
            .outer_iter()
            .all(|f| f[[39, 2]] == 3.0)
    );
    assert_eq!(c3d.markers.rate.hz(), 60.0);
    check_codes(&c3d, &["C3D006"; 4]);
}

#[test]
fn a_wrong_number_of_frames_is_corrected() {
    let mut writer = long(100);
    writer.set("POINT", "FRAMES", Value::Integers(vec![60]));
    let c3d = read(&writer);
    assert_eq!(c3d.markers.n_frames(), 100);
    check_codes(&c3d, &["C3D007"]);
    let bytes = long(100).write();
    let data = bytes.len() - (100usize * 16).next_multiple_of(512);
    let c3d = parse_c3d(&bytes[..data + 16 * 30 + 7]).unwrap();
    assert_eq!(c3d.markers.n_frames(), 30);
    check_codes(&c3d, &["C3D008"]);
}

#[test]
fn broken_parameters_keep_those_before() {
    let bytes = small(ByteOrder::Intel, Storage::Float).write();
    let find = |name: &[u8]| bytes.windows(name.len()).position(|w| w == name).unwrap();
    // The pointer behind the name UNITS leads backwards.
    let at = find(b"UNITS");
    let mut broken = bytes.clone();
    broken[at + 5..at + 7].copy_from_slice(&(-1i16).to_le_bytes());
    let c3d = parse_c3d(&broken).unwrap();
    assert!(c3d.parameters.get("point", "rate").is_some());
    assert!(c3d.parameters.get("POINT", "UNITS").is_none());
    check_codes(&c3d, &["C3D012", "C3D003"]);
    // More texts than bytes.
    let mut long_value = bytes.clone();
    long_value[at + 5 + 2 + 3] = 200;
    check_codes(&parse_c3d(&long_value).unwrap(), &["C3D004"]);
    // A locked parameter has a negative length of its name.
    let mut locked = bytes.clone();
    locked[at - 2] = (-5i8) as u8;
    let c3d = parse_c3d(&locked).unwrap();
    assert!(c3d.parameters.get("POINT", "UNITS").unwrap().locked);
    check_codes(&c3d, &[]);
    // Parameters of a group that nobody defined.
    let mut nameless = bytes.clone();
    nameless[at - 1] = 77;
    check_codes(&parse_c3d(&nameless).unwrap(), &["C3D005"]);
}

#[test]
fn a_useless_scale_is_replaced() {
    let mut writer = small(ByteOrder::Intel, Storage::Float);
    writer.scale = 0.0;
    writer.points = vec![vec![[1.0, 2.0, 3.0, 0.0]; 40]; 20];
    writer.set("POINT", "USED", Value::Integers(vec![40]));
    writer.set("POINT", "FRAMES", Value::Integers(vec![20]));
    writer.set("POINT", "SCALE", Value::Floats(vec![0.0]));
    let c3d = read(&writer);
    assert_eq!(c3d.storage, Storage::Float);
    assert_eq!(c3d.markers.positions[[19, 39, 1]], 2.0);
    check_codes(&c3d, &["C3D009", "C3D012"]);
}

#[test]
fn units_are_read_as_laboratories_write_them() {
    for (text, unit) in [
        ("mm", LengthUnit::MILLIMETRE),
        ("MM  ", LengthUnit::MILLIMETRE),
        ("cm", LengthUnit::CENTIMETRE),
        ("meters", LengthUnit::METRE),
        ("mete", LengthUnit::METRE),
        ("in", LengthUnit::INCH),
    ] {
        let mut writer = small(ByteOrder::Intel, Storage::Float);
        writer.set("POINT", "UNITS", texts(&[text]));
        let markers = read(&writer).markers;
        assert_eq!(
            (markers.unit, markers.unit_source),
            (unit, UnitSource::File),
            "{text}"
        );
    }
    let mut writer = small(ByteOrder::Intel, Storage::Float);
    writer.set("POINT", "UNITS", texts(&["7"]));
    check_codes(&read(&writer), &["C3D011"]);
}

#[test]
fn the_up_axis_is_what_the_file_says_or_z() {
    let mut writer = small(ByteOrder::Intel, Storage::Float);
    let up = |writer: &Writer| {
        let markers = read(writer).markers;
        (markers.up, markers.up_source)
    };
    assert_eq!(up(&writer), (UpAxis::Z, UpSource::Default));
    writer.set("POINT", "Y_SCREEN", texts(&["+Y"]));
    assert_eq!(up(&writer), (UpAxis::Y, UpSource::File));
    writer.set("POINT", "X_SCREEN", texts(&["-Y"]));
    assert_eq!(up(&writer), (UpAxis::Z, UpSource::Default));
}

#[test]
fn positions_in_metres_have_y_up() {
    let markers = read(&small(ByteOrder::Intel, Storage::Float)).markers;
    let turned = markers.positions_y_up();
    // Z up becomes Y up about the X axis: (x, y, z) is (x, z, -y).
    let first: Vec<f32> = (0..3).map(|axis| turned[[0, 0, axis]]).collect();
    assert_eq!(first, [0.001, 0.3005, -0.02]);
    assert!((0..3).all(|axis| turned[[1, 1, axis]].is_nan()));
}

#[test]
fn a_slice_keeps_the_frame_numbers() {
    let markers = read(&small(ByteOrder::Intel, Storage::Float)).markers;
    let slice = markers.slice(1..3).unwrap();
    assert_eq!((slice.n_frames(), slice.first_frame_number), (2, 2));
    assert_eq!(slice.positions[[1, 0, 0]], 3.0);
    assert_eq!(slice.duration(), 0.02);
    assert_eq!(markers.slice(2..4), None);
}

#[track_caller]
fn check_refused(bytes: &[u8], byte: usize, message: &str) {
    let error = parse_c3d(bytes).unwrap_err();
    assert!(matches!(error.kind, ParseErrorKind::C3d(_)));
    assert_eq!(
        (error.at, error.kind.to_string().as_str()),
        (Position::Binary { byte }, message)
    );
}

#[test]
fn what_is_no_c3d_file_is_refused() {
    check_refused(b"", 0, "expected a header of 512 bytes, found 0");
    check_refused(
        b"HIERARCHY",
        1,
        "expected the byte 80 that marks a C3D file, found 73",
    );
    let bytes = small(ByteOrder::Intel, Storage::Float).write();
    let data = bytes.len() - 512;
    check_refused(
        &bytes[..data + 31],
        data,
        "expected at least one frame of 32 bytes, found 31",
    );
    let mut strange = bytes.clone();
    strange[515] = 7;
    strange[16..18].fill(0);
    let message =
        "expected a processor type of 84, 85 or 86, found 7, and the header fits none of them";
    check_refused(&strange, 515, message);
    let mut empty = small(ByteOrder::Intel, Storage::Float);
    empty.points = vec![Vec::new(); 3];
    empty.set("POINT", "USED", Value::Integers(vec![0]));
    check_refused(
        &empty.write(),
        2,
        "the file has neither points nor analog values",
    );
}
