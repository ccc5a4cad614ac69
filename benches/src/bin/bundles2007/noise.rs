//! How much of the bundles of boxing is left when the poses are noisy.

use anyhow::{Context, Result};
use bundles::{BundleGraph, Closure};
use cli::output::table;

use crate::noisy::{AMPLITUDE, NOISES, Noisy};
use crate::overlap::{Kept, frames, kept, matches, returning};
use crate::stages::Smooth;
use crate::takes::{CLOSURES, How, METHODS, Sets, percent};

/// Seeds of the letters, and of the instances that bundles grow from.
const SEEDS: [u64; 4] = [0, 1, 2, 3];

/// Where the paper finds boxing to go well: from 100 to 250 letters.
const KAPPAS: [usize; 2] = [100, 250];

/// The paper's κ.
const KAPPA: usize = 250;

/// The least share of frames that stay, as the project asks.
const LEAST: f64 = 0.8;

/// What is tried.
const HOW: [How; 12] = [
    How::STEADY,
    How::STEADY.growing_from_frequent(),
    How::STEADY.smoothed(0.0),
    How::STEADY.smoothed(0.05),
    How::STEADY.smoothed(0.2),
    How::STEADY.near(1.2),
    How::STEADY.near(1.4),
    How::PAPER,
    How::PAPER.growing_from_all(),
    How::PAPER.smoothed(0.1).growing_from_all(),
    How::PAPER.smoothed(0.2).growing_from_all(),
    How::PAPER.smoothed(0.4).near(1.4).growing_from_all(),
];

/// The largest bundles shown one by one.
const SHOWN: usize = 4;

/// What is disturbed, and what is made anew.
#[derive(Clone, Copy, PartialEq)]
enum Trial {
    /// Noise on the 62 dimensions of the poses; components, letters and bundles are made anew.
    Poses,
    /// The same on the 62 channels of the recording.
    Channels,
    /// Noise on the poses, spelt with the letters of the clean ones.
    SameLetters,
    /// No noise: letters from another seed.
    OtherSeed,
    /// Neither: the same letters, and bundles that grow from other instances.
    OtherInstances,
}

const TRIALS: [(&str, Trial); 5] = [
    ("noise on poses", Trial::Poses),
    ("noise on channels", Trial::Channels),
    ("noise on poses, old letters", Trial::SameLetters),
    ("no noise, letters of another seed", Trial::OtherSeed),
    ("no noise, other instances", Trial::OtherInstances),
];

pub(crate) fn report(sets: &Sets) -> Result<String> {
    let boxing = Noisy::of(&sets.boxing)?;
    Ok(trials(&boxing)? + &ways(&boxing)? + &largest(&boxing)?)
}

/// What is kept in each trial, by each method.
fn trials(boxing: &Noisy) -> Result<String> {
    let mut rows = table(&[
        "method",
        "letters",
        "closure",
        "",
        "matching",
        "least",
        "most",
        "likeliest",
        "any",
        "stands",
    ]);
    for ((method, how), kappa) in METHODS
        .iter()
        .flat_map(|&of| KAPPAS.map(|kappa| (of, kappa)))
    {
        for (name, closure) in CLOSURES {
            for (what, trial) in TRIALS {
                let places = 0..NOISES.len();
                let found =
                    places.map(|place| try_out(boxing, how, (kappa, closure), trial, place));
                let found: Vec<Kept> = found.collect::<Result<_>>()?;
                let mean =
                    |of: fn(&Kept) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
                let matching = found.iter().map(|kept| kept.matching);
                let stands = mean(|kept| kept.matching) >= LEAST;
                rows.add_row([
                    method.to_owned(),
                    kappa.to_string(),
                    name.to_owned(),
                    what.to_owned(),
                    percent(mean(|kept| kept.matching)),
                    percent(matching.clone().fold(1.0, f64::min)),
                    percent(matching.fold(0.0, f64::max)),
                    percent(mean(|kept| kept.likeliest)),
                    percent(mean(|kept| kept.any)),
                    if stands { "yes" } else { "no" }.to_owned(),
                ]);
            }
        }
    }
    let [yaw, left, front] = boxing.of_rates()?;
    Ok(format!(
        "Noise of {AMPLITUDE} standard deviations on boxing, mean of {} seeds: share of the frames of bundles that are in the \
         matching bundle afterwards (at least {LEAST}). Each bundle matches at most one, by descending number of common frames; \
         likeliest: in the one with most of the bundle's frames, whatever else is there; any: in a bundle. Noise on poses is on \
         each of their degrees of freedom; noise on channels is on those of the recording, and through place and heading is as much \
         as {yaw:.1}, {left:.1} and {front:.1} deviations of the poses' yaw rate and velocities\n{}\n\n",
        NOISES.len(),
        rows.trim_fmt()
    ))
}

fn try_out(
    boxing: &Noisy,
    how: How,
    (kappa, closure): (usize, Closure),
    trial: Trial,
    place: usize,
) -> Result<Kept> {
    let clean = boxing.smooth(&boxing.clean, how);
    let noisy = boxing.smooth(&boxing.poses[place], how);
    let seed = NOISES[place];
    let way = (closure, how.instance(0));
    let letters_of = |of: &Smooth<'_>, seed| of.letters(kappa, seed, &mut |_| ());
    let letters = letters_of(&clean, 0)?;
    let before = clean.bundles(&letters, None, way)?;
    let after = match trial {
        Trial::Poses => noisy.bundles(&letters_of(&noisy, 0)?, None, way)?,
        Trial::Channels => {
            let noisy = boxing.smooth(&boxing.channels[place], how);
            noisy.bundles(&letters_of(&noisy, 0)?, None, way)?
        }
        Trial::SameLetters => {
            let tau = clean.threshold(&letters)?;
            noisy.bundles(&letters, Some(tau), way)?
        }
        Trial::OtherSeed => clean.bundles(&letters_of(&clean, seed)?, None, way)?,
        Trial::OtherInstances => clean.bundles(&letters, None, (closure, how.instance(seed)))?,
    };
    Ok(kept(&clean.owners(&before), &clean.owners(&after)))
}

/// Shares that are kept, with noise on poses and on channels: sums over seeds.
#[derive(Clone, Copy, Default)]
struct Sums {
    matching: [f64; 2],
    /// The same of the bundles that come back.
    returning: [f64; 2],
    /// Of all frames, of those in bundles that come back: a sum over the seeds of letters.
    share: f64,
}

/// What is kept in each way to make bundles.
fn ways(boxing: &Noisy) -> Result<String> {
    let mut heads = How::HEADS.to_vec();
    heads.extend([
        "noise on",
        "100 direct",
        "100 transitive",
        "250 direct",
        "returning",
        "of all",
        "250 transitive",
        "returning",
        "of all",
        "stands at 250",
    ]);
    let mut rows = table(&heads);
    for how in HOW {
        // Of each number of letters and closure.
        let mut sums = [[Sums::default(); 2]; 2];
        for (sums, kappa) in sums.iter_mut().zip(KAPPAS) {
            for seed in SEEDS {
                add(boxing, (how, kappa, seed), sums)?;
            }
        }
        for (noise, what) in ["poses", "channels"].into_iter().enumerate() {
            let runs = (SEEDS.len() * NOISES.len()) as f64;
            let mut cells = how.cells().to_vec();
            cells.push(what.to_owned());
            let mut stands = true;
            for (kappa, sums) in KAPPAS.iter().zip(&sums) {
                for sums in sums {
                    let matching = sums.matching[noise] / runs;
                    cells.push(percent(matching));
                    if *kappa == KAPPA {
                        stands &= matching >= LEAST;
                        cells.push(percent(sums.returning[noise] / runs));
                        cells.push(percent(sums.share / SEEDS.len() as f64));
                    }
                }
            }
            cells.push(if stands { "yes" } else { "no" }.to_owned());
            rows.add_row(cells);
        }
    }
    Ok(format!(
        "The same share, in matching bundles, mean of {} seeds of letters (which exemplars do not have) and {} of the noise, for \
         several ways to make bundles. Returning: of the frames of those bundles alone that come back, in another clip or after more \
         than half of their length, and how many these are of all frames. Where poses change slowly, and more so where they are \
         smoothed, what follows at once is similar, too. It stands where all bundles of {KAPPA} letters do, with both closures\n{}\n\n",
        SEEDS.len(),
        NOISES.len(),
        rows.trim_fmt()
    ))
}

/// Adds what is kept to the sums of each closure.
fn add(boxing: &Noisy, (how, kappa, seed): (How, usize, u64), sums: &mut [Sums; 2]) -> Result<()> {
    let spelt = |poses| boxing.spelt(poses, (how, kappa, seed));
    let (clean, letters) = spelt(&boxing.clean)?;
    let noisy = [&boxing.poses, &boxing.channels];
    let noisy = noisy.map(|of| of.iter().map(spelt).collect::<Result<Vec<_>>>());
    let [poses, channels] = noisy;
    let noisy = [poses?, channels?];
    for (sums, (_, closure)) in sums.iter_mut().zip(CLOSURES) {
        let way = (closure, how.instance(seed));
        let graph = clean.bundles(&letters, None, way)?;
        let before = clean.owners(&graph);
        let returning = returning(&graph, &before);
        sums.share += returning.iter().flatten().count() as f64 / before.len() as f64;
        for (noise, takes) in noisy.iter().enumerate() {
            for (take, letters) in takes {
                let after = take.owners(&take.bundles(letters, None, way)?);
                sums.matching[noise] += kept(&before, &after).matching;
                sums.returning[noise] += kept(&returning, &after).matching;
            }
        }
    }
    Ok(())
}

/// The largest bundles and what they match, in the paper's terms.
fn largest(boxing: &Noisy) -> Result<String> {
    let mut rows = table(&["method", "closure", "1", "2", "3", "4"]);
    let noisy = boxing.poses.first().context("no noise")?;
    for (method, how) in METHODS {
        let (clean, noisy) = (boxing.smooth(&boxing.clean, how), boxing.smooth(noisy, how));
        let letters_of = |of: &Smooth<'_>| of.letters(KAPPA, 0, &mut |_| ());
        let (old, new) = (letters_of(&clean)?, letters_of(&noisy)?);
        for (closure_name, closure) in CLOSURES {
            let way = (closure, how.instance(0));
            let before = clean.bundles(&old, None, way)?;
            let after = noisy.bundles(&new, None, way)?;
            let found = matches(&clean.owners(&before), &noisy.owners(&after));
            let size = |graph: &BundleGraph, bundle: usize| {
                let bundle = &graph.bundles()[bundle];
                format!("{}x{:.0}", bundle.height(), bundle.mean_frames())
            };
            let mut order: Vec<usize> = (0..before.bundles().len()).collect();
            let volume = |bundle: usize| before.bundles()[bundle].volume;
            order.sort_by(|&a, &b| volume(b).total_cmp(&volume(a)));
            let mut cells = [method, closure_name].map(str::to_owned).to_vec();
            cells.extend(order.into_iter().take(SHOWN).map(|bundle| {
                let all = frames(&before, bundle);
                let old = size(&before, bundle);
                found.get(&bundle).map_or_else(
                    || format!("{old} -> none"),
                    |&(to, n)| {
                        let share = percent(n as f64 / all as f64);
                        format!("{old} -> {}, {share}", size(&after, to))
                    },
                )
            }));
            rows.add_row(cells);
        }
    }
    Ok(format!(
        "The {SHOWN} largest bundles of {KAPPA} letters, height x frames, and what they match with noise on the poses, with the share \
         of their frames that is there. The paper's right punches go from 20x36 to 19x41, its left ones from 7x32 to 7x30\n{}\n\n",
        rows.trim_fmt()
    ))
}
