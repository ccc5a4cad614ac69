//! The largest bundles of each set.

use std::fmt::Write as _;

use anyhow::Result;
use cli::output::{count, table};

use crate::takes::{CLOSURES, How, METHODS, Set, Sets, Summary, percent};

/// Bundles shown of a set.
const SHOWN: usize = 10;

/// Figures 4 and 6: right punches, idle, left punches, steps; height and mean frames.
const BOXING: [(usize, f64); 4] = [(20, 36.0), (8, 40.0), (7, 32.0), (5, 34.0)];

/// Figure 5: principal bundles of walking.
const WALKING_BUNDLES: usize = 5;

pub(crate) fn report(sets: &Sets) -> Result<String> {
    let mut text = "Bundles, rho 1, gamma 0.8, submotions up to 200 frames: the largest by volume (height - 1) x frames. \
                    A submotion is in a bundle if another one is in it, too\n\n"
        .to_owned();
    for (set, (method, how)) in sets
        .all()
        .into_iter()
        .flat_map(|set| METHODS.map(|of| (set, of)))
    {
        let paper: &[(usize, f64)] = if set.name == sets.boxing.name {
            &BOXING
        } else {
            &[]
        };
        text += &of_set(set, (method, how), paper)?;
    }
    let _ = writeln!(
        text,
        "The paper's walking has {WALKING_BUNDLES} principal bundles, of 1,900 frames and 90 letters\n"
    );
    Ok(text)
}

fn of_set(set: &Set, (method, how): (&str, How), paper: &[(usize, f64)]) -> Result<String> {
    let mut text = String::new();
    let mut heads = vec!["", "height", "frames", "volume"];
    let mut columns: Vec<Vec<(usize, f64, f64)>> = Vec::new();
    for (name, closure) in CLOSURES {
        let bundled = set.bundled(how, closure)?;
        let summary = Summary::of(&bundled);
        if columns.is_empty() {
            let string = bundled.model.string();
            let _ = writeln!(
                text,
                "{}, {method}: {} in {}, {} components, {} letters, {} in the string, {:.1} frames each",
                set.name,
                count(set.n_frames(), "frame"),
                count(set.poses.len(), "take"),
                bundled.pca.n_components(),
                set.kappa,
                string.len(),
                set.n_frames() as f64 / string.len() as f64,
            );
        }
        let _ = writeln!(
            text,
            "  {name}: {} of {}, {:.1} frames on average, {} of the frames; {} parts of the graph",
            count(summary.n_bundles, "bundle"),
            count(summary.n_submotions, "submotion"),
            summary.mean_frames,
            percent(summary.share),
            bundled.model.graph().components().len(),
        );
        columns.push(summary.sizes);
    }
    if !paper.is_empty() {
        let volume = |&(height, frames): &(usize, f64)| (height - 1) as f64 * frames;
        columns.push(
            paper
                .iter()
                .map(|size| (size.0, size.1, volume(size)))
                .collect(),
        );
    }
    heads.extend(["height", "frames", "volume", "height", "frames", "volume"]);
    heads.truncate(1 + 3 * columns.len());
    let mut rows = table(&heads);
    let names = ["direct", "", "", "transitive", "", "", "paper", "", ""];
    rows.add_row(
        [""].into_iter()
            .chain(names.into_iter().take(3 * columns.len())),
    );
    for place in 0..SHOWN {
        let cells = columns.iter().flat_map(|sizes| match sizes.get(place) {
            Some((height, frames, volume)) => [
                height.to_string(),
                format!("{frames:.1}"),
                format!("{volume:.0}"),
            ],
            None => Default::default(),
        });
        let cells: Vec<String> = cells.collect();
        rows.add_row([(place + 1).to_string()].into_iter().chain(cells));
    }
    let _ = writeln!(text, "{}\n", rows.trim_fmt());
    Ok(text)
}
