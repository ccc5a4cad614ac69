use super::joint_name::{key, words};
use super::*;

/// The first rule of each body point and all required joints: names that the rig is made for.
fn names_of(rig: &Rig) -> Vec<String> {
    let first = rig.points.values().filter_map(|rules| rules.first());
    let mut names: Vec<String> = first
        .flat_map(|rule| match rule {
            PointRule::Joint(name) => vec![name.clone()],
            PointRule::Mix(weights) => weights.keys().cloned().collect(),
        })
        .chain(rig.requires.iter().cloned())
        .collect();
    names.sort();
    names.dedup();
    names
}

fn borrowed(names: &[String]) -> Vec<&str> {
    names.iter().map(String::as_str).collect()
}

fn builtin(name: &str) -> &'static Rig {
    Rig::builtin().iter().find(|r| r.name == name).unwrap()
}

#[test]
fn names_fall_into_words() {
    let cases = [
        ("LeftUpLeg", "left up leg"),
        ("LFArm", "lf arm"),
        ("spine_01", "spine 1"),
        ("Spine12", "spine 12"),
        ("Spine00", "spine 0"),
        ("Spine1_2", "spine 1 2"),
        ("Bip01 L Thigh", "bip 1 l thigh"),
        ("DEF-upper_arm.L.001", "def upper arm l 1"),
        ("CC_Base_L_Thigh", "cc base l thigh"),
        ("lhipjoint", "lhipjoint"),
        ("T10", "t 10"),
        ("Hüfte", "hüfte"),
        ("__", ""),
        ("", ""),
    ];
    for (name, expected) in cases {
        assert_eq!(words(name).join(" "), expected, "{name}");
    }
}

#[test]
fn names_are_compared_whole() {
    let same = |a: &str, b: &str| key(&words(a)) == key(&words(b));
    for name in ["spine_01", "Spine.1", "SPINE1", "spine 1", "Spine_001"] {
        assert!(same("Spine1", name), "{name}");
    }
    for name in [
        "Spine1_split",
        "Spine12",
        "Spine1_2",
        "Spine",
        "Spine10",
        "MySpine1",
    ] {
        assert!(!same("Spine1", name), "{name}");
    }
    assert!(same("lhipjoint", "LHipJoint"));
    assert!(!same("Spine12", "Spine1_2"));
}

#[test]
fn every_builtin_rig_has_a_name_of_its_own_and_a_body() {
    let mut names: Vec<&str> = Rig::builtin().iter().map(|r| r.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), Rig::builtin().len());
    for rig in Rig::builtin() {
        let names = names_of(rig);
        let map = BodyMap::with_rig(&borrowed(&names), rig);
        let missing: Vec<&str> = map.missing().map(BodyPoint::name).collect();
        assert!(missing.is_empty(), "{}: {missing:?}", rig.name);
    }
}

#[test]
fn each_rig_recognises_its_own_names() {
    for rig in Rig::builtin() {
        let names = names_of(rig);
        let map = BodyMap::recognise(&borrowed(&names)).unwrap();
        assert_eq!(map.rig(), rig.name);
        assert_eq!(
            map.score(),
            rig.points.len() as f64 / BodyPoint::COUNT as f64
        );
    }
}

#[test]
fn prefixes_that_all_joints_share_do_not_matter() {
    let prefixes = [
        "mixamorig:",
        "mixamorig_",
        "mixamorig1:",
        "mixamorig12_",
        "Bip001 ",
        "Character1_",
        "Robot_",
        "m_avg_",
        "DEF-",
        "|Group|Alice:",
        "CC_Base_",
    ];
    for rig in Rig::builtin() {
        let plain = names_of(rig);
        let expected = BodyMap::recognise(&borrowed(&plain)).unwrap();
        for prefix in prefixes {
            let mut names: Vec<String> = plain.iter().map(|n| format!("{prefix}{n}")).collect();
            names.push("Scene".to_owned());
            let map = BodyMap::recognise(&borrowed(&names)).unwrap();
            assert_eq!(map, expected, "{prefix}");
        }
    }
}

#[test]
fn a_prefix_of_the_wanted_names_keeps_others_out() {
    // Meshes of another naming stand between the joints, as in one of the MASS files.
    let names: Vec<String> = names_of(builtin("motionbuilder"))
        .iter()
        .flat_map(|n| [n.clone(), format!("Character1_{n}")])
        .filter(|n| n != "Hips" && n != "LeftArm")
        .collect();
    let map = BodyMap::recognise(&borrowed(&names)).unwrap();
    assert_eq!(map.score(), 1.0);
    for point in BodyPoint::ALL {
        for &(joint, _) in map.sources(point) {
            assert!(names[joint].starts_with("Character1_"), "{}", names[joint]);
        }
    }
}

#[test]
fn of_two_people_one_is_taken() {
    let rig = builtin("hdm05-cmu-markers");
    let mut names: Vec<String> = names_of(rig).iter().map(|n| format!("Bob:{n}")).collect();
    let alice = names_of(rig);
    names.extend(
        alice
            .iter()
            .filter(|n| *n != "LKNE")
            .map(|n| format!("Alice:{n}")),
    );
    let map = BodyMap::recognise(&borrowed(&names)).unwrap();
    assert_eq!(map.score(), 1.0);
    let used = BodyPoint::ALL.iter().flat_map(|&p| map.sources(p));
    assert!(
        used.into_iter()
            .all(|&(joint, _)| names[joint].starts_with("Bob:"))
    );
}

#[test]
fn part_of_a_name_is_not_the_name() {
    let rig = Rig::from_toml("name = 'r'\n[points]\nchest = 'Spine1'\nroot = 'hips'").unwrap();
    let map = BodyMap::with_rig(&["mixamorig:Hips", "Spine1_split", "SPINE1"], &rig);
    assert_eq!(map.sources(BodyPoint::Root), [(0, 1.0)]);
    assert_eq!(map.sources(BodyPoint::Chest), [(2, 1.0)]);
    assert!(!map.places(BodyPoint::Neck));
    assert_eq!(map.score(), 2.0 / 24.0);
}

#[test]
fn a_name_spelt_as_in_the_rig_comes_before_one_that_is_spelt_otherwise() {
    let rig = Rig::from_toml("name = 'r'\n[points]\nlfingers = 'LeftHand_End'").unwrap();
    let map = BodyMap::with_rig(&["LeftHandEnd", "lefthand_end"], &rig);
    assert_eq!(map.sources(BodyPoint::LFingers), [(1, 1.0)]);
    let map = BodyMap::with_rig(&["Root", "LeftHandEnd"], &rig);
    assert_eq!(map.sources(BodyPoint::LFingers), [(1, 1.0)]);
}

#[test]
fn a_required_joint_tells_like_named_rigs_apart() {
    let names = names_of(builtin("cmu-bvh"));
    let mut plain = borrowed(&names);
    plain.retain(|n| *n != "LowerBack");
    assert_eq!(BodyMap::recognise(&plain).unwrap().rig(), "motionbuilder");
}

#[test]
fn nothing_is_recognised_in_foreign_names() {
    assert_eq!(BodyMap::recognise(&["a", "b"]), None);
    assert_eq!(BodyMap::recognise(&[]), None);
    assert_eq!(BodyMap::candidates(&["a", "b"]), []);
}

#[test]
fn a_quarter_of_the_body_is_the_least_that_is_recognised() {
    let names = ["Hips", "Spine", "Neck", "Head", "LeftArm", "RightArm"];
    let map = BodyMap::recognise(&names).unwrap();
    assert_eq!(
        (map.rig(), map.score()),
        ("motionbuilder", BodyMap::MIN_SCORE)
    );
    assert_eq!(BodyMap::recognise(&names[..5]), None);
    assert_eq!(
        BodyMap::candidates(&names[..5])[0],
        ("motionbuilder", 5.0 / 24.0)
    );
}

#[test]
fn candidates_come_best_first() {
    let names = names_of(builtin("xsens-bvh"));
    let candidates = BodyMap::candidates(&borrowed(&names));
    assert_eq!(candidates[0], ("xsens-bvh", 1.0));
    assert!(candidates.iter().any(|&(rig, _)| rig == "max-bvh"));
    assert!(candidates.iter().all(|&(rig, _)| rig != "xsens"));
    assert!(candidates.windows(2).all(|w| w[0].1 >= w[1].1));
}

#[test]
fn what_lies_between_placed_points_is_derived_and_said() {
    let names = [
        "Hips",
        "LeftUpLeg",
        "RightUpLeg",
        "Head",
        "LeftArm",
        "RightArm",
        "LeftForeArm",
        "LeftHand",
    ];
    let map = BodyMap::recognise(&names).unwrap();
    let close = |point: BodyPoint, expected: &[(usize, f64)]| {
        let mut found = map.sources(point).to_vec();
        found.sort_by_key(|s| s.0);
        assert_eq!(found.len(), expected.len(), "{point}");
        for (a, b) in found.iter().zip(expected) {
            assert!(
                a.0 == b.0 && (a.1 - b.1).abs() < 1e-12,
                "{point}: {found:?}"
            );
        }
    };
    let third = 1.0 / 3.0;
    close(BodyPoint::Neck, &[(4, 0.5), (5, 0.5)]);
    close(BodyPoint::LClavicle, &[(4, 0.5), (5, 0.5)]);
    close(
        BodyPoint::Belly,
        &[(0, 2.0 * third), (4, 0.5 * third), (5, 0.5 * third)],
    );
    close(BodyPoint::Chest, &[(0, third), (4, third), (5, third)]);
    close(BodyPoint::HeadTop, &[(3, 2.5), (4, -0.75), (5, -0.75)]);
    assert_eq!(
        map.derived(BodyPoint::Neck),
        Some("midway between the shoulders")
    );
    assert_eq!(map.derived(BodyPoint::Head), None);
    assert_eq!(map.derived(BodyPoint::LKnee), None);
    assert!(!map.places(BodyPoint::LKnee) && !map.places(BodyPoint::LFingers));
    assert_eq!(map.score(), 8.0 / 24.0);
}

#[test]
fn a_mix_needs_all_its_joints_and_weights_that_sum_to_one() {
    let text = "name = 'r'\n[points]\nlwrist = { a = 1.5, b = -0.5 }";
    let rig = Rig::from_toml(text).unwrap();
    let map = BodyMap::with_rig(&["b", "a"], &rig);
    assert_eq!(map.sources(BodyPoint::LWrist), [(1, 1.5), (0, -0.5)]);
    assert_eq!(BodyMap::with_rig(&["a"], &rig).n_placed(), 0);
    let error = Rig::from_toml(&text.replace("1.5", "1.6")).unwrap_err();
    assert_eq!((error.line, error.column), (3, 10));
}

#[test]
fn the_first_rule_whose_joints_exist_counts() {
    let text = "name = 'r'\n[points]\nlknee = ['LKJC', { LKNE = 0.5, LKNM = 0.5 }, 'LKNE']";
    let rig = Rig::from_toml(text).unwrap();
    let knee = |names: &[&str]| {
        BodyMap::with_rig(names, &rig)
            .sources(BodyPoint::LKnee)
            .to_vec()
    };
    assert_eq!(knee(&["LKNE", "LKNM", "LKJC"]), [(2, 1.0)]);
    assert_eq!(knee(&["LKNE", "LKNM"]), [(0, 0.5), (1, 0.5)]);
    assert_eq!(knee(&["LKNE"]), [(0, 1.0)]);
    assert_eq!(knee(&["LKNM"]), []);
}

#[test]
fn errors_in_a_rig_say_where_and_what() {
    let error = |text: &str| Rig::from_toml(text).unwrap_err().to_string();
    assert_eq!(
        error("name = 'r'\n[points]\n  chset = ['Spine1']"),
        "3:3: expected a body point, found `chset`; the nearest is `chest`"
    );
    assert_eq!(
        error("name = 'r'\n[points]\nchest = []"),
        "3:9: expected a joint for chest, found an empty list"
    );
    assert!(error("name = 'r'\n[points]\nchest = 1").starts_with("3:9: expected a joint name"));
    assert!(error("name = 'r'\n[point]\nchest = 'a'").starts_with("2:2: unknown field `point`"));
}

#[test]
fn the_nearest_joints_are_of_the_same_side() {
    let names = [
        "Hips",
        "LeftKneeJoint",
        "RightKneeJoint",
        "LeftWing",
        "lfemur",
        "rfemur",
        "l_shin_bone",
        "Spike1",
        "lowerback",
    ];
    assert_eq!(
        BodyMap::nearest(BodyPoint::LKnee, &names, 9),
        ["lfemur", "LeftKneeJoint", "l_shin_bone"]
    );
    assert_eq!(BodyMap::nearest(BodyPoint::RKnee, &names, 1), ["rfemur"]);
    assert_eq!(BodyMap::nearest(BodyPoint::Chest, &names, 1), ["Spike1"]);
    assert_eq!(BodyMap::nearest(BodyPoint::Head, &names, 3), [""; 0]);
}

#[test]
fn a_map_can_be_saved_as_a_rig() {
    let names = [
        "x:Hips",
        "x:Spine",
        "x:Neck",
        "x:Head",
        "x:LeftArm",
        "x:RightArm",
    ];
    let map = BodyMap::recognise(&names).unwrap();
    let rig = Rig::from_toml(&map.to_rig(&names).to_toml()).unwrap();
    let again = BodyMap::with_rig(&names, &rig);
    for point in BodyPoint::ALL {
        let sorted = |map: &BodyMap| {
            let mut sources = map.sources(point).to_vec();
            sources.sort_by_key(|s| s.0);
            sources
        };
        assert_eq!(sorted(&map), sorted(&again), "{point}");
    }
    assert_eq!(again.rig(), "motionbuilder");
}

#[test]
fn a_mirrored_map_has_the_sides_exchanged() {
    let names = ["hips", "lknee", "rknee"];
    let rig = Rig {
        name: "three".to_owned(),
        requires: Vec::new(),
        points: [
            (BodyPoint::Root, 0),
            (BodyPoint::LKnee, 1),
            (BodyPoint::RKnee, 2),
        ]
        .map(|(point, joint)| (point, vec![PointRule::Joint(names[joint].to_owned())]))
        .into(),
    };
    let mirrored = BodyMap::with_rig(&names, &rig).mirrored();
    let sources =
        [BodyPoint::Root, BodyPoint::LKnee, BodyPoint::RKnee].map(|p| mirrored.sources(p));
    assert_eq!(sources, [&[(0, 1.0)][..], &[(2, 1.0)], &[(1, 1.0)]]);
    for point in BodyPoint::ALL {
        assert_eq!(point.mirrored().mirrored(), point);
        let is_middle = !point.name().starts_with(['l', 'r']) || point == BodyPoint::Root;
        assert_eq!(point.mirrored() == point, is_middle, "{point}");
    }
}
