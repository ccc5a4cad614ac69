//! The guess of a length unit.

use mocap_io::{Joint, LengthUnit, OffsetFrame, Skeleton, UnitSource, guess_unit};

/// A root far from the origin and one bone.
fn skeleton(bone: [f64; 3], frame: OffsetFrame) -> Skeleton {
    let joint = |parent, offset| Joint {
        name: String::new(),
        parent,
        offset,
        channels: Vec::new(),
        axis: None,
        end_site: false,
    };
    Skeleton::new(
        vec![joint(None, [0.0, 1e6, 0.0]), joint(Some(0), bone)],
        frame,
    )
    .unwrap()
}

#[track_caller]
fn check(height: f64, unit: LengthUnit, plausible: bool) {
    for frame in [OffsetFrame::Parent, OffsetFrame::Own] {
        for bone in [
            [0.0, height, 0.0],
            [height, 0.1 * height, 0.0],
            [0.0, 0.0, -height],
        ] {
            let (found, source) = guess_unit(&skeleton(bone, frame));
            let UnitSource::Guessed {
                plausible: found_plausible,
                ..
            } = source
            else {
                panic!("{source:?}");
            };
            assert_eq!((found, found_plausible), (unit, plausible), "{height}");
        }
    }
}

#[test]
fn people_are_recognised_in_every_unit() {
    check(1.7, LengthUnit::METRE, true);
    check(180.0, LengthUnit::CENTIMETRE, true);
    check(1650.0, LengthUnit::MILLIMETRE, true);
    // 1.7 m are 30 units of 5.6 cm and 67 inches.
    check(30.0, LengthUnit::ACCLAIM_CMU, true);
    check(67.0, LengthUnit::INCH, true);
}

#[test]
fn other_sizes_are_no_people() {
    check(0.4, LengthUnit::METRE, false);
    check(6.0, LengthUnit::METRE, false);
    check(100.0, LengthUnit::CENTIMETRE, false);
    check(1e5, LengthUnit::MILLIMETRE, false);
    check(0.0, LengthUnit::CENTIMETRE, false);
    let (unit, _) = guess_unit(&Skeleton::new(Vec::new(), OffsetFrame::Parent).unwrap());
    assert_eq!(unit, LengthUnit::CENTIMETRE);
}

#[test]
fn rest_extents_too_large_to_add_up_are_no_people() {
    let chain = [f64::MAX, f64::MAX, -f64::MAX, -f64::MAX, -f64::MAX];
    let joints = chain.iter().enumerate().map(|(i, &x)| Joint {
        name: String::new(),
        parent: i.checked_sub(1),
        offset: [x, 0.0, 0.0],
        channels: Vec::new(),
        axis: None,
        end_site: false,
    });
    let (_, source) = guess_unit(&Skeleton::new(joints.collect(), OffsetFrame::Parent).unwrap());
    assert!(matches!(
        source,
        UnitSource::Guessed {
            plausible: false,
            ..
        }
    ));
}

#[test]
fn units_have_names() {
    for (name, metres) in [
        ("m", 1.0),
        (" CM ", 0.01),
        ("mm", 0.001),
        ("inch", 0.0254),
        ("in", 0.0254),
        ("ft", 0.3048),
        ("cmu", 0.0254 / 0.45),
        ("0.05", 0.05),
    ] {
        let found = LengthUnit::from_name(name).map_or(f64::NAN, LengthUnit::metres);
        // A foot is twelve inches, rounded once.
        assert!(
            (found / metres - 1.0).abs() <= f64::EPSILON,
            "{name}: {found}"
        );
    }
    for name in ["", "ell", "0", "-1", "nan", "inf"] {
        assert_eq!(LengthUnit::from_name(name), None, "{name}");
    }
    assert_eq!(LengthUnit::ACCLAIM_CMU.to_string(), "1/0.45 inch");
    assert_eq!(
        LengthUnit::from_acclaim_length(0.45),
        Some(LengthUnit::ACCLAIM_CMU)
    );
    assert_eq!(LengthUnit::from_acclaim_length(0.0), None);
}
