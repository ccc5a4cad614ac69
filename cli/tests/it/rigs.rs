//! Which rig each real file has, from the folder that `MOTIF_DATA` names.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use cli::source::find_asf;
use cli::wire::available;
use mocap_io::{parse_asf, parse_bvh};
use relfeat::{BodyMap, BodyPoint, FeatureSet};

use crate::real::data;

/// The files below a folder, by extension in lower case.
fn files_below(dir: &Path, found: &mut BTreeMap<String, Vec<PathBuf>>) {
    for entry in fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files_below(&path, found);
        } else if let Some(extension) = path.extension() {
            let extension = extension.to_str().unwrap().to_lowercase();
            found.entry(extension).or_default().push(path);
        }
    }
}

/// The joint names of every skeleton: of each BVH, and of each ASF that an AMC has or that lies
/// there alone. Files that the readers refuse are left out.
fn skeletons(data: &Path) -> BTreeMap<PathBuf, Vec<String>> {
    let mut files = BTreeMap::new();
    files_below(data, &mut files);
    let mut skeletons = BTreeMap::new();
    for path in &files["bvh"] {
        match parse_bvh(&fs::read(path).unwrap()) {
            Ok(bvh) => {
                let names = bvh.motion.skeleton.names().map(str::to_owned).collect();
                skeletons.insert(path.clone(), names);
            }
            Err(e) => println!("{}:{e}", path.display()),
        }
    }
    let mut of_amc: BTreeSet<PathBuf> = files["asf"].iter().cloned().collect();
    of_amc.extend(
        files["amc"]
            .iter()
            .filter_map(|path| find_asf(path, None).ok()),
    );
    for path in of_amc {
        match parse_asf(&fs::read(&path).unwrap()) {
            Ok(asf) => {
                let names = asf.skeleton.names().map(str::to_owned).collect();
                skeletons.insert(path, names);
            }
            Err(e) => println!("{}:{e}", path.display()),
        }
    }
    skeletons
}

/// What a skeleton must be taken for: the first line whose path begins the file's path.
const EXPECTED: &[(&str, Option<&str>)] = &[
    ("bvh/animated-drawings/cmu1", Some("cmu-bvh-max")),
    ("bvh/animated-drawings/fair1", Some("vicon")),
    ("bvh/animated-drawings/rokoko", Some("rokoko")),
    ("bvh/cgspeed/05.asf", Some("acclaim")),
    ("bvh/cgspeed", Some("cmu-bvh")),
    // The only one without the nodes of a mesh.
    ("bvh/mass/kick.bvh", Some("motionbuilder")),
    ("bvh/mass", Some("mass")),
    ("c3d/hdm05-take", Some("acclaim")),
    ("cmu", Some("acclaim")),
    ("hdm05", Some("acclaim")),
    ("tricky/asfamc/cmu_kitchen", Some("cmu-kitchen")),
    // Six bones: a pair of legs.
    ("tricky/asfamc/encadyma_debug.asf", None),
    ("tricky/asfamc", Some("acclaim")),
    ("tricky/bvh/AnimatedDrawings_dab.bvh", Some("vicon")),
    (
        "tricky/bvh/AnimatedDrawings_jesse_dance.bvh",
        Some("rokoko"),
    ),
    (
        "tricky/bvh/AnimatedDrawings_jumping_jacks.bvh",
        Some("cmu-bvh-max"),
    ),
    (
        "tricky/bvh/PyMO_AV_8Walk_Meredith.bvh",
        Some("motionbuilder"),
    ),
    ("tricky/bvh/XBMotionGraph_input1.bvh", Some("max-bvh")),
    ("tricky/bvh/assimp_Boxing_Toes", Some("optitrack-bvh")),
    ("tricky/bvh/bvh-python_test_freebvh.bvh", Some("mixamo")),
    ("tricky/bvh/bvh-python_test_mocapbank.bvh", Some("max-bvh")),
    ("tricky/bvh/bvh-toolbox_walk01.bvh", Some("motionbuilder")),
    // Two joints without a body.
    ("tricky/bvh/bvh_anim_test_simple.bvh", None),
    ("tricky/bvh/dme_rest.bvh", Some("cmu-bvh")),
    ("tricky/bvh/fairmotion_pfnn_hierarchy.bvh", Some("cmu-bvh")),
    ("tricky/bvh/iclone_002_03.bvh", Some("iclone")),
    ("tricky/bvh/mocaputil_Example1.bvh", Some("biovision")),
    (
        "tricky/bvh/mocaputil_Male1_B3_Walk.bvh",
        Some("motionbuilder"),
    ),
    ("tricky/bvh/motionSynth_demo.bvh", Some("cmu-bvh-daz")),
    ("tricky/bvh/pfnn_rest.bvh", Some("cmu-bvh")),
    ("tricky/bvh/pybvh_bvh_test2.bvh", Some("xsens-bvh")),
    // Hips and a head.
    ("tricky/bvh/pybvh_full_precision_frame_time.bvh", None),
    ("tricky/bvh/pybvh_old_bvh_test4.bvh", Some("vicon")),
    ("tricky/bvh/pybvh_standard_skeleton.bvh", Some("vicon")),
];

/// What is not among the joints of a skeleton but lies between them.
const DERIVED: &[(&str, &[&str])] = &[
    ("tricky/asfamc/cmu_kitchen_01.asf", &["chest"]),
    ("tricky/asfamc/cmu_kitchen_03.asf", &["chest"]),
    ("tricky/bvh/PyMO_AV_8Walk_Meredith.bvh", &["chest", "neck"]),
    ("tricky/bvh/iclone_002_03.bvh", &["headtop"]),
    ("tricky/bvh/mocaputil_Example1.bvh", &["belly"]),
    ("tricky/bvh/motionSynth_demo.bvh", &["headtop"]),
];

#[test]
fn real_skeletons_have_the_rigs_that_their_makers_used() {
    let Some(data) = data() else { return };
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let mut n_people = 0;
    for (path, names) in skeletons(&data) {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let path = path.strip_prefix(&data).unwrap().to_str().unwrap();
        // A file that was added since is shown, not judged.
        let Some(&(_, expected)) = EXPECTED.iter().find(|(start, _)| path.starts_with(start))
        else {
            println!(
                "{path}: not in the table, {:?}",
                BodyMap::candidates(&names)
            );
            continue;
        };
        let map = BodyMap::recognise(&names);
        assert_eq!(map.as_ref().map(BodyMap::rig), expected, "{path}");
        let Some(map) = map else {
            println!(
                "{path}: no rig; nearest {:?}",
                BodyMap::candidates(&names).first()
            );
            continue;
        };
        let is_derived = |p: &BodyPoint| map.derived(*p).is_some();
        let derived: Vec<&str> = BodyPoint::ALL
            .into_iter()
            .filter(is_derived)
            .map(BodyPoint::name)
            .collect();
        println!(
            "{path}: {}, score {:.2}, placed {}, derived {derived:?}, missing {:?}",
            map.rig(),
            map.score(),
            map.n_placed(),
            map.missing().map(BodyPoint::name).collect::<Vec<_>>()
        );
        let expected = DERIVED.iter().find(|(file, _)| path == *file);
        assert_eq!(
            derived,
            expected.map_or(&[][..], |(_, points)| points),
            "{path}"
        );
        assert_eq!(available(&set, &map), set.all(), "{path}");
        n_people += 1;
    }
    assert!(
        n_people >= 130,
        "only {n_people} skeletons in {}",
        data.display()
    );
}
