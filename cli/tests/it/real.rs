//! Real files, from the folder that `MOTIF_DATA` names (default: `../shared/data` beside the
//! repository).

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use cli::commands::search::{SearchResult, What, search};
use cli::library::Library;
use cli::output::Voice;
use cli::recording::{ReadOptions, load};
use cli::source::ClipRef;
use mocap_io::forward_kinematics;
use relfeat::{BodyMap, Bound, FeatureSet, extract, measure, source_frame};

/// The folder with the real data; `None` if it is absent, which CI does not forgive.
pub(crate) fn data() -> Option<PathBuf> {
    let dir = std::env::var_os("MOTIF_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"),
        PathBuf::from,
    );
    if dir.is_dir() {
        return Some(dir);
    }
    assert!(
        std::env::var_os("CI").is_none(),
        "no data at {}",
        dir.display()
    );
    println!("skipped: no data");
    None
}

/// Words and the native-rate quantities behind them.
struct Computed {
    words: Vec<u64>,
    near: Vec<u64>,
}

/// A quantity this close to a threshold, relative to it, may fall on either side: positions are
/// rounded to `f32` here, and the other implementation sums in another order.
const NEAR: f64 = 1e-4;

/// The words of a clip; and for each word the features that a rounding error may have decided: some
/// frame since the feature last had to be off or on whatever the rounding lies near a threshold.
fn compute(path: &Path, set: &FeatureSet) -> Computed {
    let recording = load(path, &ReadOptions::default()).unwrap().recording;
    let positions = recording.positions();
    let map = BodyMap::recognise(&recording.names()).unwrap();
    let rate = recording.rate().0.hz();
    let words = extract(set, positions.view(), &map, rate, 30.0)
        .unwrap()
        .words;
    let mut native = vec![0u64; positions.dim().0];
    for bit in 0..set.features().len() {
        let measured = measure(set, bit, positions.view(), &map, rate).unwrap();
        let (enter, stay) = (measured.enter, measured.stay);
        // The trigger run twice: with every doubtful comparison failing, and with it passing.
        let (mut low, mut high) = (false, false);
        for (t, &value) in measured.values.iter().enumerate() {
            let test = |on: bool| if on { stay } else { enter };
            low = test(low).holds(value) && !is_near(value, test(low));
            high = test(high).holds(value) || is_near(value, test(high));
            if low != high {
                native[t] |= 1 << bit;
            }
        }
    }
    let near = (0..words.len())
        .map(|k| native[source_frame(k, rate, 30.0)])
        .collect();
    Computed { words, near }
}

fn is_near(value: f64, bound: Bound) -> bool {
    bound
        .thresholds()
        .any(|x| (value - x).abs() <= NEAR * x.abs().max(1e-3))
}

#[test]
fn real_features_agree_with_an_independent_implementation() {
    let Some(data) = data() else { return };
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let mut n_words = 0;
    let mut n_near = 0;
    let mut wrong: Vec<String> = Vec::new();
    let mut files: Vec<PathBuf> = fs::read_dir(data.join("labels/reference-features"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    files.sort();
    for file in &files {
        let text = fs::read_to_string(file).unwrap();
        let clip = text.lines().next().unwrap().trim_start_matches("# ");
        let expected: Vec<u64> = text
            .lines()
            .filter(|l| !l.starts_with('#'))
            .map(|l| u64::from_str_radix(l.trim_start_matches("0x"), 16).unwrap())
            .collect();
        let computed = compute(&data.join(clip), &set);
        assert_eq!(computed.words.len(), expected.len(), "{clip}");
        for (k, (&found, &expected)) in computed.words.iter().zip(&expected).enumerate() {
            n_words += 1;
            let differing = found ^ expected;
            if differing & !computed.near[k] != 0 {
                wrong.push(format!(
                    "{clip} word {k}: {found:#x}, expected {expected:#x}, differing {differing:#x}"
                ));
            } else if differing != 0 {
                n_near += 1;
                println!("{clip} word {k} differs in {differing:#x}, near a threshold");
            }
        }
    }
    println!(
        "{} clips, {n_words} words, {n_near} decided by rounding",
        files.len()
    );
    assert!(files.len() >= 27 && n_words > 5_000);
    assert!(
        wrong.is_empty(),
        "{} of {n_words} words:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    assert!(
        n_near * 1000 <= n_words,
        "{n_near} of {n_words} words are near a threshold"
    );
}

/// The words of a file, all frames, at 30 per second.
fn words(path: &Path, first_frame: usize, set: &FeatureSet) -> Vec<u64> {
    let recording = load(path, &ReadOptions::default()).unwrap().recording;
    let motion = recording.motion().unwrap();
    let motion = motion.slice(first_frame..motion.n_frames()).unwrap();
    let positions = forward_kinematics(&motion);
    let names: Vec<&str> = motion.skeleton.names().collect();
    let map = BodyMap::recognise(&names).unwrap();
    extract(set, positions.view(), &map, motion.rate.hz(), 30.0)
        .unwrap()
        .words
}

/// The conversion lost the thorax and wrist bones; the rig `cmu-bvh` puts them back nearly, not exactly,
/// which shows most where a hand is held just above the neck (F3, F4).
const LEAST_AGREEMENT: f64 = 0.9;

#[test]
fn real_amc_and_bvh_of_the_same_motion_have_the_same_features() {
    let Some(data) = data() else { return };
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let pairs = [
        ("cmu/02/02_01.amc", "bvh/cgspeed/02/02_01.bvh"),
        ("bvh/cgspeed/05_13.amc", "bvh/cgspeed/05/05_13.bvh"),
    ];
    for (amc, bvh) in pairs {
        let of_amc = words(&data.join(amc), 0, &set);
        // A T-pose stands in front.
        let of_bvh = words(&data.join(bvh), 1, &set);
        assert_eq!(of_amc.len(), of_bvh.len(), "{bvh}");
        let n_words = of_amc.len();
        let mut n_equal = 0;
        for (bit, feature) in set.features().iter().enumerate() {
            let equal = of_amc
                .iter()
                .zip(&of_bvh)
                .filter(|(a, b)| (*a ^ *b) >> bit & 1 == 0)
                .count();
            n_equal += equal;
            let share = equal as f64 / n_words as f64;
            println!("{bvh} F{:<2} {:<26} {:.3}", bit + 1, feature.name, share);
            assert!(
                share >= LEAST_AGREEMENT,
                "{bvh} {}: only {share}",
                feature.name
            );
        }
        let share = n_equal as f64 / (n_words * set.features().len()) as f64;
        println!("{bvh}: {share:.4} of all bits agree");
    }
}

#[test]
fn real_libraries_are_indexed_whole() {
    let Some(data) = data() else { return };
    let dir = tempfile::tempdir().unwrap();
    let paths = [data.join("hdm05"), data.join("cmu")];
    let outcome = crate::corpus::index(&paths, dir.path(), &ReadOptions::default());
    let result = outcome.result;
    assert!(outcome.skipped.is_empty(), "{:?}", outcome.skipped);
    assert_eq!((result.clips, result.frames), (288 + 195, 218_062));
    let [cut] = result.warnings.as_slice() else {
        panic!("{:?}", result.warnings)
    };
    assert!(
        cut.path.ends_with("07_12.amc") && cut.code == "AMC001",
        "{cut:?}"
    );
}

/// A library of the clips in `folder`.
fn index(folder: &Path, dir: &Path) -> Library {
    let outcome = crate::corpus::index(&[folder.to_owned()], dir, &ReadOptions::default());
    assert!(outcome.skipped.is_empty(), "{:?}", outcome.skipped);
    Library::open(dir).unwrap()
}

/// All adaptive hits.
fn find(library: &Library, example: &Path, features: &[&str]) -> SearchResult {
    let features: Vec<String> = features.iter().map(|&f| f.to_owned()).collect();
    let what = What::new(&features);
    let example = ClipRef {
        path: example.to_owned(),
        span: None,
    };
    search(
        library,
        &example,
        &what,
        &ReadOptions::default(),
        Voice::default(),
    )
    .unwrap()
}

#[test]
fn real_searches_hit_the_clips_that_were_counted_independently() {
    let Some(data) = data() else { return };
    let dir = tempfile::tempdir().unwrap();
    let library = index(&data.join("hdm05"), dir.path());
    let squat = |n: &str| format!("squat1Reps/HDM_bd_squat1Reps_{n}_120.amc");
    let kick = "kickLFront1Reps/HDM_bd_kickLFront1Reps_001_120.amc".to_owned();
    let lie_down = "lieDownFloor/HDM_bd_lieDownFloor_001_120.amc".to_owned();
    let check = |example: String, features: &[&str], expected: &[(&str, usize)]| {
        let result = find(&library, &data.join("hdm05").join(&example), features);
        let mut clips: Vec<&str> = result.hits.iter().map(|h| h.clip.as_str()).collect();
        clips.sort_unstable();
        clips.dedup();
        assert_eq!(clips.len(), result.n_clips);
        let mut by_class: BTreeMap<&str, usize> = BTreeMap::new();
        for clip in &clips {
            let class = Path::new(clip).parent().unwrap().file_name().unwrap();
            *by_class.entry(class.to_str().unwrap()).or_default() += 1;
        }
        println!(
            "{example} {features:?}: {} hits in {by_class:?}",
            result.n_hits
        );
        assert_eq!(
            by_class.into_iter().collect::<Vec<_>>(),
            expected,
            "{example}"
        );
        for hit in &result.hits {
            assert_eq!(hit.segments.len(), result.query.segments.len());
            assert_eq!(hit.segments[0][0], hit.start);
            assert_eq!(hit.segments.last().unwrap()[1], hit.end);
            assert!(
                hit.segments.windows(2).all(|w| w[0][1] == w[1][0]),
                "{hit:?}"
            );
        }
        let best = &result.hits[0];
        assert_eq!(
            (best.rank, best.cost),
            (1, 0),
            "the example finds itself first"
        );
        assert!(best.clip.ends_with(&example), "{}", best.clip);
    };
    let low = ["F20", "F21", "F37"];
    check(
        squat("002"),
        &low,
        &[("depositFloorR", 2), ("squat1Reps", 31)],
    );
    check(squat("001"), &low, &[("squat1Reps", 5)]);
    check(kick, &["F18", "F21"], &[("kickLFront1Reps", 23)]);
    check(
        lie_down,
        &["F32"],
        &[("depositFloorR", 24), ("lieDownFloor", 20)],
    );
}
