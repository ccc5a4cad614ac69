//! Real C3D files.

use std::fs;

use mocap_io::{C3d, LengthUnit, UpAxis, UpSource, parse_c3d};

use crate::real::{data, files_below};

fn read(path: &std::path::Path) -> C3d {
    parse_c3d(&fs::read(path).unwrap()).unwrap_or_else(|e| panic!("{}:{e}", path.display()))
}

#[test]
fn real_c3d_files_are_read_or_refused_with_a_reason() {
    let Some(data) = data() else { return };
    let mut paths = Vec::new();
    files_below(&data, "c3d", &mut paths);
    assert!(paths.len() > 50, "only {} files", paths.len());
    for path in paths {
        let name = path.strip_prefix(&data).unwrap().display();
        let c3d = match parse_c3d(&fs::read(&path).unwrap()) {
            Ok(c3d) => c3d,
            // Every file here has points that other programs show.
            Err(error) => panic!("{name}: refused: {error}"),
        };
        let m = &c3d.markers;
        let n_missing: usize = m.gaps().iter().map(|gap| gap.frames.len()).sum();
        println!(
            "{name}: {} {}, {} frames from {}, {} Hz, {} markers, {} others, {n_missing} missing, {} events, \
             {} {:?}, up {} {:?}",
            c3d.byte_order,
            c3d.storage,
            m.n_frames(),
            m.first_frame_number,
            m.rate.hz(),
            m.names.len(),
            c3d.other_points.names.len(),
            c3d.events.len(),
            m.unit,
            m.unit_source,
            m.up,
            m.up_source,
        );
        for warning in &c3d.warnings {
            println!("    {warning}");
        }
        // A laboratory is smaller than this, in metres.
        let far = 100.0;
        assert!(
            m.positions_y_up()
                .iter()
                .all(|v| v.is_nan() || v.abs() < far),
            "{name}"
        );
    }
}

/// Both files say the same, but that integers are rounded to whole multiples of the scale, and may be
/// cut off instead: a step at most.
#[track_caller]
fn check_twins(a: &C3d, b: &C3d, name: &str) {
    assert_eq!(a.markers.names, b.markers.names, "{name}");
    assert_eq!(
        a.markers.positions.dim(),
        b.markers.positions.dim(),
        "{name}"
    );
    let scale = a
        .parameters
        .get("POINT", "SCALE")
        .unwrap()
        .number(0)
        .unwrap()
        .abs();
    // A VAX float has the same digits; what is left is the rounding of an integer times the scale.
    let step = if a.storage == b.storage {
        1e-3
    } else {
        scale * 1.01
    };
    let mut worst = 0.0f64;
    for (a, b) in a.markers.positions.iter().zip(&b.markers.positions) {
        assert_eq!(a.is_nan(), b.is_nan(), "{name}");
        if !a.is_nan() {
            worst = worst.max(f64::from((a - b).abs()));
        }
    }
    println!("{name}: largest difference {worst} of {step} (scale {scale})");
    assert!(worst <= step, "{name}: {worst} of {step}");
    assert_eq!(a.markers.rate, b.markers.rate);
    let analog = a.analog.as_ref().zip(b.analog.as_ref());
    if let Some((a, b)) = analog {
        assert_eq!(a.values.dim(), b.values.dim());
        assert_eq!((&a.names, a.rate), (&b.names, b.rate));
    }
}

#[test]
fn real_c3d_twins_say_the_same() {
    let Some(data) = data() else { return };
    let org = data.join("c3d/c3d-org");
    for (folder, first, twins) in [
        (
            org.join("sample_01"),
            "Eb015pi.c3d",
            vec![
                "Eb015pr.c3d",
                "Eb015si.c3d",
                "Eb015sr.c3d",
                "Eb015vi.c3d",
                "Eb015vr.c3d",
            ],
        ),
        (
            org.join("sample_02"),
            "pc_real.c3d",
            vec![
                "pc_int.c3d",
                "dec_int.c3d",
                "dec_real.c3d",
                "sgi_int.c3d",
                "sgi_real.c3d",
            ],
        ),
        // The same data with sections in other places.
        (
            org.join("sample_08"),
            "EB015PI.c3d",
            vec!["TESTAPI.c3d", "TESTBPI.c3d", "TESTCPI.c3d", "TESTDPI.c3d"],
        ),
        (
            data.join("tricky/c3d"),
            "btk_ADemo1_rewrite_c3d_pc_float.c3d",
            vec!["btk_ADemo1_rewrite_c3d_pc_integer.c3d"],
        ),
    ] {
        let reference = read(&folder.join(first));
        assert!(reference.markers.positions.iter().any(|v| v.is_finite()));
        for twin in twins {
            check_twins(&reference, &read(&folder.join(twin)), twin);
        }
    }
}

#[test]
fn real_c3d_takes_have_the_known_frames() {
    let Some(data) = data() else { return };
    // Frames and numbers as data/README.md and TRICKY.md give them.
    for (path, n_frames, first, n_markers) in [
        ("tricky/c3d/CMU_02_01.c3d", 343, 50, 41),
        ("bvh/cgspeed/05_13.c3d", 1095, 20, 330),
        ("c3d/hdm05-take/HDM_dg_06-03_03_120.c3d", 202, 2925, 44),
        ("tricky/c3d/ezc3d_Qualisys.c3d", 340, 705, 55),
        ("tricky/c3d/btk_MyCube.c3d", 1, 1, 14),
        ("tricky/c3d/btk_shd01.c3d", 237, 91, 27),
        ("tricky/c3d/btk_mocap36.c3d", 1380, 1, 36),
    ] {
        let markers = read(&data.join(path)).markers;
        assert_eq!(markers.n_frames(), n_frames, "{path}");
        assert_eq!(markers.first_frame_number, first, "{path}");
        assert_eq!(markers.names.len(), n_markers, "{path}");
        assert_eq!(markers.unit, LengthUnit::MILLIMETRE, "{path}");
    }
    let markers = read(&data.join("bvh/cgspeed/05_13.c3d")).markers;
    assert_eq!(
        (markers.names[0].as_str(), markers.names[255].as_str()),
        ("Dance:LFHD", "Dance:LULN6")
    );
    // Its Y_SCREEN says -Z, but the heads are at +Z.
    let markers = read(&data.join("tricky/c3d/ezc3d_Qualisys.c3d")).markers;
    assert!(matches!(
        (markers.up, markers.up_source),
        (UpAxis::Z, UpSource::Guessed { .. })
    ));
}

/// A gait file of Vicon's: events lie within the recording, once counted from its first frame.
#[test]
fn real_c3d_events_lie_within_the_recording() {
    let Some(data) = data() else { return };
    let c3d = read(&data.join("c3d/c3d-org/sample_03/gait-pig-nz.c3d"));
    assert_eq!(c3d.markers.first_frame_number, 300);
    assert_eq!(c3d.events.len(), 7);
    for event in &c3d.events {
        assert!(
            (0.0..c3d.markers.duration()).contains(&event.seconds),
            "{event:?}"
        );
    }
    let kinds: Vec<&str> = c3d.other_points.kinds.iter().map(String::as_str).collect();
    assert!(
        ["ANGLES", "FORCES", "MOMENTS", "POWERS"]
            .iter()
            .all(|kind| kinds.contains(kind))
    );
    assert_eq!(c3d.other_points.units[0].as_deref(), Some("deg"));
}
