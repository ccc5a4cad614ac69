//! Motion bundles of real takes: what somebody has labelled in CMU subject 13, and boxing with noise.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;

use bundles::{Closure, Kappa};
use cli::bundling::purity::{FrameLabels, bundle_groups, frame_labels, purity, window_groups};
use cli::bundling::{Bundled, Poses, What, bundle, load};
use cli::recording::ReadOptions;
use cli::source::ClipRef;
use ndarray::Axis;

use crate::command::{motif, text};
use crate::real::data;

/// The dimensions that the paper counts for this skeleton.
const PAPER_DIMS: usize = 62;
/// Lengths of the windows of the baseline, in frames, beside the mean length of submotions.
const WINDOWS: [usize; 3] = [60, 120, 200];

/// The least share of frames that have the label of most of their bundle, as the project asks.
const MIN_PURITY: f64 = 0.85;

/// The paper's noise, in deviations of each degree of freedom.
const NOISE: f64 = 0.1;

/// The least share of frames of bundles that stay in the matching bundle, as the project asks.
const MIN_KEPT: f64 = 0.8;

fn takes(data: &Path) -> Vec<Poses> {
    let read = |take: &str| {
        let path = data.join(format!("cmu/13/{take}.amc"));
        let clip = ClipRef { path, span: None };
        Poses::read(&clip, &ReadOptions::default()).unwrap()
    };
    ["13_29", "13_30", "13_31"].map(read).to_vec()
}

fn labels(data: &Path, takes: &[Poses]) -> FrameLabels {
    let table = fs::read_to_string(data.join("labels/mocap6-subject13.csv")).unwrap();
    let of_take = |poses: &Poses| {
        let stem = poses.clip.path.file_stem().unwrap().to_str().unwrap();
        frame_labels(&table, stem, poses.vectors.nrows()).unwrap()
    };
    takes.iter().map(of_take).collect()
}

/// With letters of the paper's mixture, the transitive closure drifts through all that is near; it is printed for
/// comparison.
#[test]
fn real_bundles_of_subject_13_are_pure() {
    let Some(data) = data() else { return };
    let takes = takes(&data);
    assert!(
        takes
            .iter()
            .all(|poses| poses.vectors.ncols() == PAPER_DIMS)
    );
    let labels = labels(&data, &takes);
    let steady = What::new(Some(letters()));
    let paper = What::paper(letters());
    let (direct, transitive) = (Closure::Direct, Closure::Transitive);
    for (name, what, is_pure) in [
        ("steady, direct", steady, true),
        (
            "steady, transitive",
            What {
                closure: transitive,
                ..steady
            },
            true,
        ),
        (
            "paper, direct",
            What {
                closure: direct,
                ..paper
            },
            true,
        ),
        ("paper, transitive", paper, false),
    ] {
        let bundled = bundle(&takes, &what).unwrap();
        let groups = bundle_groups(&bundled);
        let (share, n_frames) = purity(&groups, &labels);
        let share = share.unwrap();
        let reduced = takes
            .iter()
            .map(|poses| bundled.pca.project(poses.vectors.view()).unwrap());
        let reduced: Vec<_> = reduced.collect();
        let reduced: Vec<_> = reduced.iter().map(|poses| poses.view()).collect();
        let n_all: usize = takes.iter().map(|poses| poses.vectors.nrows()).sum();
        let n_groups = groups.len();
        println!(
            "{name}: {n_groups} bundles of {n_frames} labelled of {n_all} frames: purity {share:.3}"
        );
        // Windows as long as the submotion that a frame is in on average, and longer ones; as many in a
        // group as submotions are in a bundle.
        let lengths: Vec<usize> = groups
            .iter()
            .flatten()
            .map(|(_, span)| span.len())
            .collect();
        let height = lengths.len() as f64 / n_groups as f64;
        let squares: usize = lengths.iter().map(|len| len * len).sum();
        let length = squares / lengths.iter().sum::<usize>();
        for len in [length].into_iter().chain(WINDOWS) {
            let k = (n_all as f64 / len as f64 / height).ceil() as usize;
            let (baseline, n_frames) = purity(&window_groups(&reduced, len, k), &labels);
            let baseline = baseline.unwrap();
            println!(
                "  {k} clusters of windows of {len}: {n_frames} labelled frames, purity {baseline:.3}"
            );
            assert!(!is_pure || share > baseline);
        }
        assert!(!is_pure || share >= MIN_PURITY);
    }
}

/// The paper's number.
fn letters() -> Kappa {
    NonZeroUsize::new(250).map_or(Kappa::Auto, Kappa::Letters)
}

/// The bundle of each frame of a clip.
fn owners(bundled: &Bundled, n_frames: usize) -> Vec<Option<usize>> {
    let mut owners = vec![None; n_frames];
    let bundles = bundled.model.graph().bundles().iter().enumerate();
    for (id, bundle) in bundles {
        for submotion in &bundle.submotions {
            owners[submotion.span.clone()].fill(Some(id));
        }
    }
    owners
}

/// Of the frames in a bundle of `before`, the share in the bundle of `after` that matches it. Each matches at most
/// one, by descending number of common frames.
fn kept(before: &[Option<usize>], after: &[Option<usize>]) -> f64 {
    let mut common: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for pair in before.iter().zip(after) {
        if let (Some(old), Some(new)) = pair {
            *common.entry((*old, *new)).or_default() += 1;
        }
    }
    let mut pairs: Vec<_> = common.into_iter().collect();
    pairs.sort_by_key(|&(_, n)| Reverse(n));
    let (mut old, mut new, mut kept) = (BTreeSet::new(), BTreeSet::new(), 0);
    for ((from, to), n) in pairs {
        if !old.contains(&from) && !new.contains(&to) {
            old.insert(from);
            new.insert(to);
            kept += n;
        }
    }
    kept as f64 / before.iter().flatten().count() as f64
}

/// With Gaussian noise in proportion to the deviation of each degree of freedom, by the sum of twelve uniform numbers.
fn disturbed(poses: &Poses, seed: u64) -> Poses {
    let mut state = seed;
    // Steele, Lea and Flood 2014: SplitMix64.
    let mut uniform = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    };
    let deviations = poses.vectors.std_axis(Axis(0), 0.0);
    let mut noisy = poses.clone();
    for mut row in noisy.vectors.rows_mut() {
        for (x, deviation) in row.iter_mut().zip(&deviations) {
            let normal: f64 = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
            *x += NOISE * deviation * normal;
        }
    }
    noisy
}

/// Boxing, as in section 5.1 of the paper.
#[test]
fn real_bundles_of_boxing_withstand_noise() {
    let Some(data) = data() else { return };
    let path = data.join("cmu/14/14_02.amc");
    let clip = ClipRef { path, span: None };
    let clean = Poses::read(&clip, &ReadOptions::default()).unwrap();
    let n_frames = clean.vectors.nrows();
    for closure in [Closure::Direct, Closure::Transitive] {
        let what = What {
            closure,
            ..What::new(Some(letters()))
        };
        let of = |poses: &Poses| {
            let bundled = bundle(std::slice::from_ref(poses), &what).unwrap();
            owners(&bundled, n_frames)
        };
        let before = of(&clean);
        let shares = (1..=5).map(|seed| kept(&before, &of(&disturbed(&clean, seed))));
        let shares: Vec<f64> = shares.collect();
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        println!("{closure:?}: {mean:.3} of {shares:.3?}");
        assert!(mean >= MIN_KEPT, "{shares:?}");
    }
}

/// Markers do not turn, so they have no poses to bundle: they are left out beside others, and refused alone.
#[test]
fn real_markers_are_left_out() {
    let Some(data) = data() else { return };
    let take = data.join("c3d/hdm05-take/HDM_dg_06-03_03_120");
    let [amc, c3d] = ["amc", "c3d"].map(|extension| take.with_extension(extension));
    let dir = tempfile::tempdir().unwrap();
    let output = dir.path().join("markers.mbg");
    let run = |paths: &[&str]| {
        let options = ["--json", "--kappa", "30", "-o", text(&output)];
        motif(&[&["bundle"], paths, &options].concat())
    };
    let alone = run(&[text(&c3d)]);
    assert_eq!(alone.code, 3, "{alone:?}");
    assert!(!output.exists());
    let both = run(&[text(&c3d), text(&amc)]);
    assert!(both.code < 2, "{both:?}");
    for run in [alone, both] {
        let skipped = run.json()["skipped"].clone();
        assert_eq!(skipped.as_array().unwrap().len(), 1);
        assert_eq!(skipped[0]["path"], text(&c3d));
        let error = skipped[0]["error"].as_str().unwrap();
        assert!(error.contains("markers"), "{error}");
    }
    let clips = load(&output).unwrap().clips;
    assert_eq!(
        clips.iter().map(|clip| &clip.path).collect::<Vec<_>>(),
        [&amc]
    );
}
