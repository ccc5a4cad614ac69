//! Walking and boxing in one set.

use std::ops::Range;

use anyhow::Result;
use bundles::Bundle;
use cli::output::table;

use crate::takes::{CLOSURES, METHODS, Set, Sets, Summary, percent};

/// The paper's κ for both together, Figure 8.
const KAPPA: usize = 250;

/// The largest share of a bundle's frames that may be of the kind that is rarer in it.
const MOST: f64 = 0.05;

/// Walking and boxing, the walks first, and how many clips are walks.
pub(crate) fn with_boxing(walks: &Set, boxing: &Set) -> (Set, usize) {
    let poses = [&walks.poses[..], &boxing.poses[..]].concat();
    let mixed = Set {
        name: "walking and boxing",
        kappa: KAPPA,
        poses,
    };
    (mixed, walks.poses.len())
}

pub(crate) fn report(sets: &Sets) -> Result<String> {
    let mut rows = table(&[
        "method",
        "walks",
        "frames",
        "closure",
        "bundles",
        "of both",
        "rarer kind at most",
        "edges between",
        "apart",
    ]);
    for (method, how) in METHODS {
        for walks in [&sets.walking, &sets.walks] {
            let (mixed, n_walks) = with_boxing(walks, &sets.boxing);
            for (name, closure) in CLOSURES {
                let bundled = mixed.bundled(how, closure)?;
                let graph = bundled.model.graph();
                let shares: Vec<f64> = graph
                    .bundles()
                    .iter()
                    .map(|b| share_of(b, 0..n_walks))
                    .collect();
                let rarer = shares.iter().map(|share| share.min(1.0 - share));
                let most = rarer.clone().fold(0.0, f64::max);
                let is_walking = |bundle: usize| shares[bundle] > 0.5;
                let between = graph.edges().iter();
                let between = between.filter(|edge| is_walking(edge.from) != is_walking(edge.to));
                rows.add_row([
                    method.to_owned(),
                    walks.name.to_owned(),
                    mixed.n_frames().to_string(),
                    name.to_owned(),
                    Summary::of(&bundled).n_bundles.to_string(),
                    rarer.filter(|share| *share > 0.0).count().to_string(),
                    percent(most),
                    between.count().to_string(),
                    if most <= MOST { "yes" } else { "no" }.to_owned(),
                ]);
            }
        }
    }
    Ok(format!(
        "Mixed: walking and boxing, {KAPPA} letters for both; apart if no bundle has more than {} of its frames of the \
         rarer kind. The paper's graphs are disjoint\n{}\n\n",
        percent(MOST),
        rows.trim_fmt()
    ))
}

/// The share of a bundle's frames that are of these clips.
fn share_of(bundle: &Bundle, clips: Range<usize>) -> f64 {
    let frames = |is_counted: &dyn Fn(usize) -> bool| {
        let counted = bundle.submotions.iter().filter(|s| is_counted(s.clip));
        counted.map(|submotion| submotion.span.len()).sum::<usize>() as f64
    };
    frames(&|clip| clips.contains(&clip)) / frames(&|_| true).max(1.0)
}
