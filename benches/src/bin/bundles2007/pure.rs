//! Whether bundles keep to what somebody has labelled.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use cli::bundling::purity::{
    FrameLabels, Group, bundle_groups, frame_labels, purity, window_groups,
};
use cli::output::table;

use crate::takes::{CLOSURES, How, SMOOTHED, STEADY, Set, Sets, percent};

/// Lengths of the windows of the baseline, in frames, beside the mean length of submotions.
const WINDOWS: [usize; 3] = [60, 120, 200];

/// The least share of frames with the label of most of their bundle, as the project asks.
const LEAST: f64 = 0.85;

/// Numbers of letters: that of the tables, and such as give fewer and longer letters.
const KAPPAS: [usize; 3] = [90, 150, 250];

/// The first smoothing with which all stands is [`SMOOTHED`].
const HOW: [How; 8] = [
    How::PAPER,
    How::smoothed(0.1),
    How::smoothed(0.15),
    How::smoothed(SMOOTHED),
    How::smoothed(0.3),
    How::near(1.4),
    How::near(2.0),
    STEADY,
];

pub(crate) fn report(data: &Path, sets: &Sets) -> Result<String> {
    let set = &sets.labelled;
    let labels = labels(data, set)?;
    let mut rows = table(&[
        "smoothed, s",
        "near",
        "letters",
        "closure",
        "bundles",
        "in bundles",
        "purity",
        "windows",
        "",
        "",
        "",
        "stands",
    ]);
    rows.add_row([
        "", "", "", "", "", "", "", "as long", "60", "120", "200", "",
    ]);
    for (how, kappa) in HOW.iter().flat_map(|&how| KAPPAS.map(|kappa| (how, kappa))) {
        let poses = set.poses.clone();
        let set = Set {
            kappa,
            how,
            poses,
            ..*set
        };
        for (name, closure) in CLOSURES {
            let bundled = set.bundled(closure, 1.0)?;
            let groups = bundle_groups(&bundled);
            let found = purity(&groups, &labels).0.context("nothing is labelled")?;
            let reduced = set
                .poses
                .iter()
                .map(|poses| bundled.pca.project(poses.vectors.view()));
            let reduced: Vec<_> = reduced.collect::<std::result::Result<_, _>>()?;
            let views: Vec<_> = reduced.iter().map(|poses| poses.view()).collect();
            let (own, height, in_bundles) = shape(&groups);
            let baseline = |len: usize| {
                let n_groups = set.n_frames() as f64 / len as f64 / height;
                let windows = window_groups(&views, len, n_groups.ceil() as usize);
                purity(&windows, &labels).0.unwrap_or(0.0)
            };
            let baselines: Vec<f64> = [own].into_iter().chain(WINDOWS).map(baseline).collect();
            let stands = found >= LEAST && baselines.iter().all(|other| found > *other);
            let mut row = vec![
                how.smooth.to_string(),
                how.near.to_string(),
                kappa.to_string(),
                name.to_owned(),
                groups.len().to_string(),
                percent(in_bundles as f64 / set.n_frames() as f64),
                format!("{found:.3}"),
            ];
            row.extend(baselines.iter().map(|other| format!("{other:.3}")));
            row.push(if stands { "yes" } else { "no" }.to_owned());
            rows.add_row(row);
        }
    }
    Ok(format!(
        "Purity: share of the frames of bundles, on 13_29 to 13_31, that have the label of most of their bundle; at least \
         {LEAST} and more than k-means of windows of one length. Windows as long as the submotion that a frame is in on \
         average, and longer ones; as many in a group as submotions are in a bundle\n{}\n\n",
        rows.trim_fmt()
    ))
}

fn labels(data: &Path, set: &Set) -> Result<FrameLabels> {
    let path = data.join("labels/mocap6-subject13.csv");
    let text = fs::read_to_string(&path);
    let text = text.with_context(|| format!("cannot read {}", path.display()))?;
    let of_take = |poses: &cli::bundling::Poses| {
        let stem = poses.clip.path.file_stem().unwrap_or_default();
        let labels = frame_labels(&text, &stem.to_string_lossy(), poses.vectors.nrows());
        labels.map_err(|error| anyhow!("{}: {error}", path.display()))
    };
    set.poses.iter().map(of_take).collect()
}

/// The length of the stretch that a frame is in on average, stretches in a group, and frames.
fn shape(groups: &[Group]) -> (usize, f64, usize) {
    let lengths: Vec<usize> = groups
        .iter()
        .flatten()
        .map(|(_, span)| span.len())
        .collect();
    let all: usize = lengths.iter().sum();
    let squares: usize = lengths.iter().map(|len| len * len).sum();
    let height = lengths.len() as f64 / groups.len().max(1) as f64;
    (squares / all.max(1), height, all)
}
