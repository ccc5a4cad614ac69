//! Motion bundles of the labelled takes of CMU subject 13.

use std::collections::BTreeMap;
use std::fs;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::Path;

use bundles::{Closure, Kappa};
use cli::bundling::{Bundled, Poses, What, bundle, load};
use cli::recording::ReadOptions;
use cli::source::ClipRef;
use ndarray::{Array2, ArrayView1, Axis, s};

use crate::command::{motif, text};
use crate::real::data;

/// The dimensions that the paper counts for this skeleton.
const PAPER_DIMS: usize = 62;
/// Lengths of the windows of the baseline, in frames, beside the mean length of submotions.
const WINDOWS: [usize; 3] = [60, 120, 200];

/// The least share of frames that have the label of most of their bundle, as the project asks.
const MIN_PURITY: f64 = 0.85;

/// A label for each frame of each take, `None` where there is none.
type Labels = Vec<Vec<Option<String>>>;

fn takes(data: &Path) -> Vec<Poses> {
    let read = |take: &str| {
        let path = data.join(format!("cmu/13/{take}.amc"));
        let clip = ClipRef { path, span: None };
        Poses::read(&clip, &ReadOptions::default()).unwrap()
    };
    ["13_29", "13_30", "13_31"].map(read).to_vec()
}

fn labels(data: &Path, takes: &[Poses]) -> Labels {
    let text = fs::read_to_string(data.join("labels/mocap6-subject13.csv")).unwrap();
    let of_take = |poses: &Poses| {
        let stem = poses.clip.path.file_stem().unwrap().to_str().unwrap();
        let mut labels = vec![None; poses.vectors.nrows()];
        for line in text.lines() {
            let fields: Vec<&str> = line.split(',').collect();
            if fields[0] != stem {
                continue;
            }
            // The file counts frames from 1 and includes the last one.
            let ends = [1, 2].map(|k| fields[k].parse::<usize>().unwrap());
            let n_frames = labels.len();
            for label in &mut labels[ends[0] - 1..ends[1].min(n_frames)] {
                *label = Some(fields[3].to_owned());
            }
        }
        labels
    };
    takes.iter().map(of_take).collect()
}

/// The share of labelled frames that have the majority label of their group, and their number.
/// Groups are stretches of takes.
fn purity(groups: &[Vec<(usize, Range<usize>)>], labels: &Labels) -> (f64, usize) {
    let (mut pure, mut all) = (0, 0);
    for group in groups {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for (take, span) in group {
            for label in labels[*take][span.clone()].iter().flatten() {
                *counts.entry(label).or_default() += 1;
            }
        }
        pure += counts.values().max().copied().unwrap_or_default();
        all += counts.values().sum::<usize>();
    }
    (pure as f64 / all as f64, all)
}

fn groups(bundled: &Bundled) -> Vec<Vec<(usize, Range<usize>)>> {
    let of_bundle = |bundle: &bundles::Bundle| {
        let spans = bundle.submotions.iter().map(|submotion| {
            let (_, frames) = bundled.source(submotion).unwrap();
            (submotion.clip, frames)
        });
        spans.collect()
    };
    let graph = bundled.model.graph();
    graph.bundles().iter().map(of_bundle).collect()
}

/// Lloyd's k-means of the takes cut into windows of `len` frames, each the chain of its reduced poses
/// at eight evenly spaced frames, from evenly spaced windows.
fn windows(
    bundled: &Bundled,
    takes: &[Poses],
    (len, k): (usize, usize),
) -> Vec<Vec<(usize, Range<usize>)>> {
    let mut cut = Vec::new();
    let mut rows = Vec::new();
    for (take, poses) in takes.iter().enumerate() {
        let reduced = bundled.pca.project(poses.vectors.view()).unwrap();
        for start in (0..(reduced.nrows() / len) * len).step_by(len) {
            cut.push((take, start..start + len));
            let picked = (0..8).map(|i| start + i * len / 8);
            rows.extend(picked.flat_map(|frame| reduced.row(frame).to_vec()));
        }
    }
    let points = Array2::from_shape_vec((cut.len(), rows.len() / cut.len()), rows).unwrap();
    let k = k.min(cut.len());
    let mut centres = points.select(
        Axis(0),
        &(0..k).map(|c| c * cut.len() / k).collect::<Vec<_>>(),
    );
    let mut nearest = vec![0; cut.len()];
    for _ in 0..100 {
        for (point, own) in points.rows().into_iter().zip(&mut nearest) {
            let apart = |c: &usize| squares(point, centres.row(*c));
            *own = (0..k).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
        }
        for c in 0..k {
            let own: Vec<usize> = (0..cut.len()).filter(|&p| nearest[p] == c).collect();
            if let Some(mean) = points.select(Axis(0), &own).mean_axis(Axis(0)) {
                centres.slice_mut(s![c, ..]).assign(&mean);
            }
        }
    }
    let mut groups = vec![Vec::new(); k];
    for (window, &own) in cut.into_iter().zip(&nearest) {
        groups[own].push(window);
    }
    groups
}

fn squares(a: ArrayView1<'_, f64>, b: ArrayView1<'_, f64>) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
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
        let groups = groups(&bundled);
        let (share, n_frames) = purity(&groups, &labels);
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
            let (baseline, n_frames) = purity(&windows(&bundled, &takes, (len, k)), &labels);
            println!(
                "  {k} clusters of windows of {len}: {n_frames} labelled frames, purity {baseline:.3}"
            );
            assert!(closure == Closure::Transitive || share > baseline);
        }
        assert!(closure == Closure::Transitive || share >= MIN_PURITY);
    }
}

fn what(closure: Closure) -> What {
    What {
        kappa: NonZeroUsize::new(250).map_or(Kappa::Auto, Kappa::Letters),
        rho: 1.0,
        gamma: 0.8,
        closure,
        max_frames: 200.0,
        duration_weight: 1.0,
        seed: 0,
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
