//! Whether bundles keep to what somebody has labelled.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use cli::bundling::purity::{
    FrameLabels, Group, bundle_groups, frame_labels, purity, window_groups,
};
use cli::output::table;

use crate::takes::{CLOSURES, How, Set, Sets, percent};

/// Lengths of the windows of the baseline, in frames, beside the mean length of submotions.
const WINDOWS: [usize; 3] = [60, 120, 200];

/// The least share of frames with the label of most of their bundle, as the project asks.
const LEAST: f64 = 0.85;

/// Numbers of letters: that of the tables, and such as give fewer and longer letters.
const KAPPAS: [usize; 3] = [90, 150, 250];

const HOW: [How; 8] = [
    How::STEADY,
    How::STEADY.smoothed(0.0),
    How::STEADY.smoothed(0.2),
    How::STEADY.near(1.2),
    How::STEADY.near(1.4),
    How::PAPER,
    How::PAPER.smoothed(0.2),
    How::PAPER.near(1.4),
];

pub(crate) fn report(data: &Path, sets: &Sets) -> Result<String> {
    let set = &sets.labelled;
    let labels = labels(data, set)?;
    let mut heads = How::HEADS.to_vec();
    heads.extend(["how many", "closure", "bundles", "in bundles", "purity"]);
    heads.extend(["windows", "", "", "", "stands"]);
    let mut rows = table(&heads);
    let windows = ["as long", "60", "120", "200", ""];
    rows.add_row([""; How::HEADS.len() + 5].into_iter().chain(windows));
    for (how, kappa) in HOW.iter().flat_map(|&how| KAPPAS.map(|kappa| (how, kappa))) {
        let poses = set.poses.clone();
        let set = Set {
            kappa,
            poses,
            ..*set
        };
        for (name, closure) in CLOSURES {
            let bundled = set.bundled(how, closure)?;
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
            let mut row = how.cells().to_vec();
            row.extend([
                kappa.to_string(),
                name.to_owned(),
                groups.len().to_string(),
                percent(in_bundles as f64 / set.n_frames() as f64),
                format!("{found:.3}"),
            ]);
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
