//! Motion bundles of the labelled takes of CMU subject 13.

use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;

use bundles::{Closure, Kappa};
use cli::bundling::purity::{FrameLabels, bundle_groups, frame_labels, purity, window_groups};
use cli::bundling::{Poses, What, bundle, load};
use cli::recording::ReadOptions;
use cli::source::ClipRef;

use crate::command::{motif, text};
use crate::real::data;

/// The dimensions that the paper counts for this skeleton.
const PAPER_DIMS: usize = 62;
/// Lengths of the windows of the baseline, in frames, beside the mean length of submotions.
const WINDOWS: [usize; 3] = [60, 120, 200];

/// The least share of frames that have the label of most of their bundle, as the project asks.
const MIN_PURITY: f64 = 0.85;

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

/// Only the direct closure keeps to one motion: with the transitive one, bundles drift through all that is near, and
/// are printed for comparison.
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
    for closure in [Closure::Transitive, Closure::Direct] {
        let bundled = bundle(&takes, &what(closure)).unwrap();
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
            "{closure:?}: {n_groups} bundles of {n_frames} labelled of {n_all} frames: purity {share:.3}"
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
            assert!(closure == Closure::Transitive || share > baseline);
        }
        assert!(closure == Closure::Transitive || share >= MIN_PURITY);
    }
}

fn what(closure: Closure) -> What {
    let kappa = NonZeroUsize::new(250).map_or(Kappa::Auto, Kappa::Letters);
    What {
        closure,
        ..What::new(kappa)
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
