//! What each way to make bundles gives and costs, on all takes.

use std::path::Path;

use anyhow::Result;
use cli::output::table;

use crate::noisy::Noisy;
use crate::overlap::{frames, kept, returning};
use crate::takes::{self, CLOSURES, How, METHODS, Set, Sets, percent};

/// What is compared.
const HOW: [How; 8] = [
    How::STEADY,
    How::STEADY.smoothed(0.0),
    How::STEADY.smoothed(0.05),
    How::STEADY.near(1.2),
    How::STEADY.near(1.4),
    How::PAPER,
    How::PAPER.near(1.4),
    How::PAPER.smoothed(0.2).growing_from_all(),
];

/// Seeds of the letters, and of the instances that bundles grow from.
const SEEDS: u64 = 2;

/// Seeds of the noise.
const NOISES: usize = 3;

pub(crate) fn report(data: &Path, sets: &Sets) -> Result<String> {
    let own = rows_of(sets.all().into_iter(), &HOW)?;
    let others = takes::others(data)?;
    let others = rows_of(others.iter(), &METHODS.map(|(_, how)| how))?;
    Ok(format!(
        "Ways to make bundles on all takes, mean of {SEEDS} seeds of letters and {NOISES} of noise on the poses. Matching: as above; \
         returning: of bundles that come back alone; lead to each other: share of the frames of bundles that are in the largest \
         part of the graph in which each bundle leads to each other one, which is what a walk can use\n{own}\n\n\
         The same, by both methods, of all takes of subjects that were not looked at when the steady one was chosen\n{others}\n\n"
    ))
}

fn rows_of<'a>(sets: impl Iterator<Item = &'a Set>, ways: &[How]) -> Result<String> {
    let mut heads = vec![""];
    heads.extend(How::HEADS);
    heads.extend([
        "closure",
        "matching",
        "returning",
        "in bundles",
        "returning",
        "bundles",
        "height",
        "frames",
        "lead to each other",
    ]);
    let mut rows = table(&heads);
    for set in sets {
        let clips = Noisy::of(set)?;
        for &how in ways {
            for ((name, _), cost) in CLOSURES.iter().zip(costs_of(set, &clips, how)?) {
                let mut row = vec![format!("{}, {} letters", set.name, set.kappa)];
                row.extend(how.cells());
                row.extend([
                    (*name).to_owned(),
                    percent(cost.matching),
                    percent(cost.matching_returning),
                    percent(cost.in_bundles),
                    percent(cost.returning),
                    format!("{:.1}", cost.bundles),
                    format!("{:.2}", cost.submotions / cost.bundles),
                    format!("{:.1}", cost.bundled / cost.submotions),
                    percent(cost.together / cost.bundled),
                ]);
                rows.add_row(row);
            }
        }
    }
    Ok(rows.trim_fmt())
}

/// Sums or means over the seeds of letters.
#[derive(Clone, Copy, Default)]
struct Cost {
    matching: f64,
    matching_returning: f64,
    in_bundles: f64,
    returning: f64,
    bundles: f64,
    submotions: f64,
    /// Frames in bundles, and those of the largest part of the graph.
    bundled: f64,
    together: f64,
}

/// Of each closure.
fn costs_of(set: &Set, clips: &Noisy, how: How) -> Result<[Cost; 2]> {
    let mut costs = [Cost::default(); 2];
    let share = 1.0 / SEEDS as f64;
    for seed in 0..SEEDS {
        let spelt = |poses| clips.spelt(poses, (how, set.kappa, seed));
        let (clean, letters) = spelt(&clips.clean)?;
        let noisy: Vec<_> = clips
            .poses
            .iter()
            .take(NOISES)
            .map(spelt)
            .collect::<Result<_>>()?;
        for (cost, (_, closure)) in costs.iter_mut().zip(CLOSURES) {
            let way = (closure, how.instance(seed));
            let graph = clean.bundles(&letters, None, way)?;
            let before = clean.owners(&graph);
            let returning = returning(&graph, &before);
            for (take, letters) in &noisy {
                let after = take.owners(&take.bundles(letters, None, way)?);
                let share = share / NOISES as f64;
                cost.matching += kept(&before, &after).matching * share;
                cost.matching_returning += kept(&returning, &after).matching * share;
            }
            let n_submotions: usize = graph.bundles().iter().map(bundles::Bundle::height).sum();
            let n_frames = |bundle: usize| frames(&graph, bundle) as f64;
            let bundled: f64 = (0..graph.bundles().len()).map(n_frames).sum();
            let parts = graph.components();
            let of_part = |part: &Vec<usize>| part.iter().copied().map(n_frames).sum::<f64>();
            cost.in_bundles += bundled * share / before.len() as f64;
            cost.returning +=
                returning.iter().flatten().count() as f64 * share / before.len() as f64;
            cost.bundles += graph.bundles().len() as f64 * share;
            cost.submotions += n_submotions as f64 * share;
            cost.bundled += bundled * share;
            cost.together += parts.iter().map(of_part).fold(0.0, f64::max) * share;
        }
    }
    Ok(costs)
}
