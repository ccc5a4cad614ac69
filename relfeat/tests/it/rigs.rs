//! Rigs against joint names as their makers and users list them.

use std::collections::BTreeMap;

use proptest::prelude::*;
use relfeat::{BodyMap, BodyPoint, FeatureSet, PointRule, Rig};

/// `%` stands for the side: one name for each of the two.
fn sided(names: &str, left: &str, right: &str) -> Vec<String> {
    let both = |name: &str| match name.contains('%') {
        true => vec![name.replace('%', left), name.replace('%', right)],
        false => vec![name.to_owned()],
    };
    names.split_whitespace().flat_map(both).collect()
}

/// A convention: its rig, its joints, and where some body points must be.
struct Case {
    rig: &'static str,
    joints: Vec<String>,
    places: &'static [(&'static str, &'static str)],
    derived: &'static [&'static str],
    missing: &'static [&'static str],
}

const HUMAN_IK: &str = "Hips %UpLeg %Leg %Foot Neck Head %Shoulder %Arm %ForeArm %Hand";

fn cases() -> Vec<Case> {
    let human_ik = |more: &str| sided(&format!("{HUMAN_IK} {more}"), "Left", "Right");
    vec![
        Case {
            rig: "mixamo",
            joints: human_ik(
                "Spine Spine1 Spine2 HeadTop_End %ToeBase %Toe_End %HandMiddle1 %HandThumb1",
            ),
            places: &[
                ("chest", "Spine2"),
                ("headtop", "HeadTop_End"),
                ("ltoes", "LeftToe_End"),
                ("lknee", "LeftLeg"),
            ],
            derived: &[],
            missing: &[],
        },
        Case {
            rig: "lafan1",
            joints: human_ik("Spine Spine1 Spine2 %Toe %Hand_End Head_End"),
            places: &[
                ("ltoes", "LeftToe"),
                ("rshoulder", "RightArm"),
                ("chest", "Spine2"),
            ],
            derived: &[],
            missing: &[],
        },
        Case {
            rig: "lafan1",
            joints: human_ik("Spine Spine1 Spine2 %Toe"),
            places: &[],
            derived: &["headtop"],
            missing: &["lfingers", "rfingers"],
        },
        Case {
            rig: "perception-neuron",
            joints: human_ik(
                "Spine Spine1 Spine2 Spine3 %InHandIndex %InHandMiddle %HandMiddle1 %Foot_End Head_End",
            ),
            places: &[
                ("chest", "Spine3"),
                ("ltoes", "LeftFoot_End"),
                ("lfingers", "LeftHandMiddle1"),
            ],
            derived: &[],
            missing: &[],
        },
        Case {
            rig: "rokoko-newton",
            joints: sided(
                "Hips %Thigh %Shin %Foot %Toe %ToeTip Spine1 Spine2 Spine3 Spine4 %Shoulder %Arm %ForeArm %Hand Neck Head",
                "Left",
                "Right",
            ),
            places: &[
                ("lknee", "LeftShin"),
                ("ltoes", "LeftToeTip"),
                ("chest", "Spine4"),
            ],
            derived: &["headtop"],
            missing: &["lfingers", "rfingers"],
        },
        Case {
            rig: "soma",
            joints: sided(
                "Hips Spine1 Spine2 Chest Neck1 Neck2 Head HeadEnd Jaw %Shoulder %Arm %ForeArm %Hand %HandMiddleEnd %Leg %Shin %Foot %ToeBase %ToeEnd",
                "Left",
                "Right",
            ),
            places: &[
                ("lhip", "LeftLeg"),
                ("lknee", "LeftShin"),
                ("neck", "Neck1"),
            ],
            derived: &[],
            missing: &[],
        },
        Case {
            rig: "xsens",
            joints: sided(
                "Pelvis L5 L3 T12 T8 Neck Head %Shoulder %UpperArm %ForeArm %Hand %UpperLeg %LowerLeg %Foot %Toe",
                "Left",
                "Right",
            ),
            places: &[
                ("belly", "L3"),
                ("chest", "T8"),
                ("rknee", "RightLowerLeg"),
                ("lelbow", "LeftForeArm"),
            ],
            derived: &["headtop"],
            missing: &["lfingers", "rfingers"],
        },
        Case {
            rig: "xsens-bvh",
            joints: sided(
                "Hips Chest Chest2 Chest3 Chest4 Neck Head %Collar %Shoulder %Elbow %Wrist %Wrist_End %Hip %Knee %Ankle %Toe Head_End",
                "Left",
                "Right",
            ),
            places: &[
                ("chest", "Chest4"),
                ("lclavicle", "LeftCollar"),
                ("lshoulder", "LeftShoulder"),
            ],
            derived: &[],
            missing: &[],
        },
        Case {
            rig: "optitrack",
            joints: sided(
                "Hip Ab Chest Neck Head %Shoulder %UArm %FArm %Hand %Thigh %Shin %Foot %Toe",
                "L",
                "R",
            ),
            places: &[
                ("root", "Hip"),
                ("lclavicle", "LShoulder"),
                ("lshoulder", "LUArm"),
                ("belly", "Ab"),
            ],
            derived: &["headtop"],
            missing: &["lfingers", "rfingers"],
        },
        Case {
            rig: "unreal",
            joints: sided(
                "root pelvis spine_01 spine_02 spine_03 neck_01 head clavicle_% upperarm_% upperarm_twist_01_% lowerarm_% hand_% index_01_% middle_01_% thumb_01_% thigh_% thigh_twist_01_% calf_% foot_% ball_%",
                "l",
                "r",
            ),
            places: &[
                ("root", "pelvis"),
                ("ltoes", "ball_l"),
                ("chest", "spine_03"),
                ("rfingers", "middle_01_r"),
            ],
            derived: &["headtop"],
            missing: &[],
        },
        Case {
            rig: "unreal5",
            joints: sided(
                "root pelvis spine_01 spine_02 spine_03 spine_04 spine_05 neck_01 neck_02 head clavicle_% upperarm_% lowerarm_% hand_% middle_01_% thigh_% calf_% foot_% ball_%",
                "l",
                "r",
            ),
            places: &[("chest", "spine_05"), ("lhip", "thigh_l")],
            derived: &["headtop"],
            missing: &[],
        },
        Case {
            rig: "rigify",
            joints: sided(
                "spine spine.001 spine.002 spine.003 spine.004 spine.005 spine.006 pelvis.% shoulder.% upper_arm.% forearm.% hand.% f_middle.01.% thigh.% shin.% foot.% toe.% heel.02.%",
                "L",
                "R",
            ),
            places: &[
                ("root", "spine"),
                ("neck", "spine.004"),
                ("head", "spine.006"),
                ("lshoulder", "upper_arm.L"),
            ],
            derived: &["headtop"],
            missing: &[],
        },
        Case {
            // Generated: the animator's controls stand among the deforming bones.
            rig: "rigify",
            joints: sided(
                "root torso hips chest neck head foot_ik.% hand_ik.% toe.% DEF-spine DEF-spine.001 DEF-spine.002 DEF-spine.003 DEF-spine.004 DEF-spine.005 DEF-spine.006 DEF-shoulder.% DEF-upper_arm.% DEF-upper_arm.%.001 DEF-forearm.% DEF-hand.% DEF-f_middle.01.% DEF-thigh.% DEF-shin.% DEF-foot.% DEF-toe.%",
                "L",
                "R",
            ),
            places: &[
                ("root", "DEF-spine"),
                ("head", "DEF-spine.006"),
                ("ltoes", "DEF-toe.L"),
                ("lelbow", "DEF-forearm.L"),
            ],
            derived: &["headtop"],
            missing: &[],
        },
        Case {
            rig: "biped",
            joints: [
                "",
                "Pelvis",
                "Spine",
                "Spine1",
                "Spine2",
                "Neck",
                "Head",
                "HeadNub",
                "L Thigh",
                "L Calf",
                "L Foot",
                "L Toe0",
                "L Clavicle",
                "L UpperArm",
                "L Forearm",
                "L Hand",
                "L Finger0",
                "L Finger1",
                "R Thigh",
                "R Calf",
                "R Foot",
                "R Toe0",
                "R Clavicle",
                "R UpperArm",
                "R Forearm",
                "R Hand",
                "R Finger0",
                "R Finger1",
            ]
            .map(|n| format!("Bip01 {n}").trim().to_owned())
            .to_vec(),
            places: &[
                ("root", "Bip01 Pelvis"),
                ("lknee", "Bip01 L Calf"),
                ("chest", "Bip01 Spine2"),
                ("headtop", "Bip01 HeadNub"),
            ],
            derived: &[],
            missing: &[],
        },
        Case {
            rig: "smpl",
            joints: sided(
                "Pelvis %_Hip Spine1 %_Knee Spine2 %_Ankle Spine3 %_Foot Neck %_Collar Head %_Shoulder %_Elbow %_Wrist %_Hand",
                "L",
                "R",
            ),
            places: &[
                ("lhip", "L_Hip"),
                ("ltoes", "L_Foot"),
                ("lshoulder", "L_Shoulder"),
                ("chest", "Spine3"),
            ],
            derived: &["headtop"],
            missing: &[],
        },
        Case {
            rig: "smpl",
            joints: sided(
                "pelvis %_hip spine1 %_knee spine2 %_ankle spine3 %_foot neck %_collar head %_shoulder %_elbow %_wrist jaw %_eye_smplhf %_index1 %_middle1",
                "left",
                "right",
            ),
            places: &[("lhip", "left_hip"), ("rfingers", "right_middle1")],
            derived: &["headtop"],
            missing: &[],
        },
        Case {
            rig: "smpl",
            joints: sided(
                "m_avg_root m_avg_Pelvis m_avg_%_Hip m_avg_Spine1 m_avg_%_Knee m_avg_Spine2 m_avg_%_Ankle m_avg_Spine3 m_avg_%_Foot m_avg_Neck m_avg_%_Collar m_avg_Head m_avg_%_Shoulder m_avg_%_Elbow m_avg_%_Wrist m_avg_%_Hand",
                "L",
                "R",
            ),
            places: &[("root", "m_avg_Pelvis"), ("lfingers", "m_avg_L_Hand")],
            derived: &["headtop"],
            missing: &[],
        },
        Case {
            // Gait laboratories often tape no markers to arms and head.
            rig: "plug-in-gait",
            joints: sided(
                "Jo:SACR Jo:%ASI Jo:%THI Jo:%KNE Jo:%TIB Jo:%ANK Jo:%HEE Jo:%TOE",
                "L",
                "R",
            ),
            places: &[("ltoes", "Jo:LTOE")],
            derived: &[],
            missing: &[
                "belly",
                "chest",
                "neck",
                "head",
                "headtop",
                "lclavicle",
                "rclavicle",
                "lshoulder",
                "rshoulder",
                "lelbow",
                "relbow",
                "lwrist",
                "rwrist",
                "lfingers",
                "rfingers",
            ],
        },
        Case {
            rig: "plug-in-gait",
            joints: sided(
                "%FHD %BHD C7 T10 CLAV STRN RBAK %SHO %UPA %ELB %FRM %WRA %WRB %FIN %ASI %PSI %THI %KNE %TIB %ANK %HEE %TOE %FEP %FEO %TIO",
                "L",
                "R",
            ),
            places: &[
                ("lhip", "LFEP"),
                ("lknee", "LFEO"),
                ("lankle", "LTIO"),
                ("lelbow", "LELB"),
            ],
            derived: &["lclavicle", "rclavicle"],
            missing: &[],
        },
    ]
}

#[test]
fn conventions_are_recognised_by_the_names_that_their_users_list() {
    let names_of =
        |points: Vec<BodyPoint>| points.into_iter().map(BodyPoint::name).collect::<Vec<_>>();
    for case in cases() {
        let names: Vec<&str> = case.joints.iter().map(String::as_str).collect();
        let map = BodyMap::recognise(&names).unwrap();
        assert_eq!(map.rig(), case.rig);
        for &(point, joint) in case.places {
            let point = BodyPoint::ALL
                .into_iter()
                .find(|p| p.name() == point)
                .unwrap();
            let [(found, weight)] = map.sources(point) else {
                panic!("{} {point}: {:?}", case.rig, map.sources(point))
            };
            assert_eq!(
                (names[*found], *weight),
                (joint, 1.0),
                "{} {point}",
                case.rig
            );
        }
        let is_derived = |p: &BodyPoint| map.derived(*p).is_some();
        let derived = names_of(BodyPoint::ALL.into_iter().filter(is_derived).collect());
        assert_eq!(derived, case.derived, "{}", case.rig);
        assert_eq!(
            names_of(map.missing().collect()),
            case.missing,
            "{}",
            case.rig
        );
        let found = BodyPoint::COUNT - case.derived.len() - case.missing.len();
        assert_eq!(map.score(), found as f64 / BodyPoint::COUNT as f64);
        assert_eq!(BodyMap::candidates(&names)[0], (case.rig, map.score()));
        let set = FeatureSet::builtin("mueller2006").unwrap();
        assert_eq!(
            set.unavailable(&map).is_empty(),
            case.missing.is_empty(),
            "{}",
            case.rig
        );
    }
}

/// A joint's name without anything but letters and digits, numbers without zeros in front and kept
/// apart: how names are compared, written down without splitting them into words.
fn squeezed(name: &str) -> String {
    let name = name.rsplit([':', '|']).next().unwrap();
    let mut out = String::new();
    let mut rest = name.chars().peekable();
    while let Some(c) = rest.next() {
        if c.is_ascii_digit() {
            let mut number = String::from(c);
            while let Some(digit) = rest.next_if(char::is_ascii_digit) {
                number.push(digit);
            }
            if out.ends_with(|c: char| c.is_ascii_digit()) {
                out.push('_');
            }
            out += &number.parse::<u64>().unwrap().to_string();
        } else if c.is_alphanumeric() {
            out.extend(c.to_lowercase());
        }
    }
    out
}

fn joint_name() -> impl Strategy<Value = String> {
    let part = prop::sample::select(vec![
        "Spine", "spine", "SPINE", "1", "01", "001", "2", "12", "_", ".", " ", "-", "Left", "Arm",
        "A:", "split", "É",
    ]);
    prop::collection::vec(part, 1..5).prop_map(|parts| parts.concat())
}

proptest! {
    /// Fewer than a family of names have no prefix to lose, so that a search by hand is simple.
    #[test]
    fn joints_are_found_like_by_hand(
        names in prop::collection::vec(joint_name(), 0..8),
        wanted in prop::collection::vec(joint_name(), 1..4),
    ) {
        let joints: Vec<&str> = names.iter().map(String::as_str).collect();
        let rules = wanted.iter().cloned().map(PointRule::Joint).collect();
        let points = BTreeMap::from([(BodyPoint::LKnee, rules)]);
        let rig = Rig { name: "r".into(), requires: vec![], points };
        let bare = |name: &str| name.rsplit(':').next().unwrap().trim().to_lowercase();
        let by_hand = wanted.iter().filter(|w| !squeezed(w).is_empty()).find_map(|w| {
            let exact = joints.iter().position(|j| bare(j) == bare(w));
            let squeezed_to = |name: &str| joints.iter().position(|j| squeezed(j) == squeezed(name));
            exact.or_else(|| squeezed_to(w))
        });
        let map = BodyMap::with_rig(&joints, &rig);
        let expected: Vec<(usize, f64)> = by_hand.into_iter().map(|j| (j, 1.0)).collect();
        prop_assert_eq!(map.sources(BodyPoint::LKnee), expected.as_slice());
    }

    #[test]
    fn whatever_is_missing_weights_sum_to_one(
        rig in prop::sample::select(Rig::builtin().iter().collect::<Vec<_>>()),
        keep in prop::collection::vec(any::<bool>(), 200),
    ) {
        let mut names: Vec<&str> = Vec::new();
        for rule in rig.points.values().flatten() {
            match rule {
                PointRule::Joint(name) => names.push(name),
                PointRule::Mix(weights) => names.extend(weights.keys().map(String::as_str)),
            }
        }
        names.sort_unstable();
        names.dedup();
        let kept: Vec<&str> = names.iter().zip(&keep).filter(|(_, k)| **k).map(|(n, _)| *n).collect();
        let map = BodyMap::with_rig(&kept, rig);
        let mut n_found = 0;
        for point in BodyPoint::ALL {
            let sources = map.sources(point);
            prop_assert_eq!(sources.is_empty(), !map.places(point));
            prop_assert!(sources.iter().all(|&(joint, _)| joint < kept.len()));
            if map.places(point) {
                let sum: f64 = sources.iter().map(|s| s.1).sum();
                prop_assert!((sum - 1.0).abs() < 1e-9, "{} {}", point, sum);
                n_found += usize::from(map.derived(point).is_none());
            } else {
                prop_assert_eq!(map.derived(point), None);
            }
        }
        prop_assert_eq!(map.score(), n_found as f64 / BodyPoint::COUNT as f64);
        // Recognised is the best candidate, and at least as good as the rig in question.
        let best = BodyMap::candidates(&kept).first().copied();
        let recognised = BodyMap::recognise(&kept);
        prop_assert_eq!(
            recognised.as_ref().map(|m| (m.rig(), m.score())),
            best.filter(|(_, score)| *score >= BodyMap::MIN_SCORE)
        );
    }

    #[test]
    fn any_names_are_taken(names in prop::collection::vec(".{0,12}", 0..40)) {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        if let Some(map) = BodyMap::recognise(&names) {
            prop_assert!(map.score() >= BodyMap::MIN_SCORE);
        }
        for point in BodyPoint::ALL {
            prop_assert!(BodyMap::nearest(point, &names, 3).len() <= 3);
        }
    }

    #[test]
    fn a_rig_written_is_the_rig_read(rig in rig()) {
        let text = rig.to_toml();
        prop_assert_eq!(Rig::from_toml(&text).map_err(|e| format!("{e}\n{text}")), Ok(rig));
    }
}

#[test]
fn builtin_rigs_written_are_the_rigs_read() {
    for rig in Rig::builtin() {
        assert_eq!(Rig::from_toml(&rig.to_toml()).unwrap(), *rig);
    }
}

fn rule() -> impl Strategy<Value = PointRule> {
    // Names with quotes, backslashes, control characters and what else a file may hold.
    let name = ".{0,8}";
    let mix = prop::collection::btree_map(name, -2.0..2.0f64, 1..4).prop_map(|mut weights| {
        let others: f64 = weights.values().skip(1).sum();
        *weights.values_mut().next().unwrap() = 1.0 - others;
        PointRule::Mix(weights)
    });
    prop_oneof![name.prop_map(PointRule::Joint), mix]
}

fn rig() -> impl Strategy<Value = Rig> {
    let point = prop::sample::select(BodyPoint::ALL.to_vec());
    let points = prop::collection::btree_map(point, prop::collection::vec(rule(), 1..3), 0..6);
    let requires = prop::collection::vec("\\PC{0,8}", 0..3);
    ("(?s).{0,8}", requires, points).prop_map(|(name, requires, points)| Rig {
        name,
        requires,
        points,
    })
}
