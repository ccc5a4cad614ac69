//! How much of the bundles of boxing is left when the poses are noisy.

use anyhow::{Context, Result};
use bundles::{BundleGraph, Closure, SeedInstance};
use cli::output::table;

use crate::noisy::{AMPLITUDE, NOISES, Noisy};
use crate::overlap::{Kept, frames, kept, matches, returning};
use crate::takes::{CLOSURES, How, SMOOTHED, STEADY, Sets, percent};

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
    How::PAPER,
    How::smoothed(0.05),
    How::smoothed(0.1),
    How::smoothed(0.15),
    How::smoothed(SMOOTHED),
    How::smoothed(0.25),
    How::smoothed(0.3),
    How::smoothed(0.4),
    How::near(1.4),
    How {
        smooth: SMOOTHED,
        near: 1.4,
    },
    How {
        smooth: 0.3,
        near: 1.4,
    },
    STEADY,
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
    Ok(trials(&boxing)? + &remedies(&boxing)? + &largest(&boxing)?)
}

/// What is kept in each trial, bundled as the paper does.
fn trials(boxing: &Noisy) -> Result<String> {
    let mut rows = table(&[
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
    for kappa in KAPPAS {
        for (name, closure) in CLOSURES {
            for (what, trial) in TRIALS {
                let places = 0..NOISES.len();
                let found = places.map(|place| try_out(boxing, (kappa, closure), trial, place));
                let found: Vec<Kept> = found.collect::<Result<_>>()?;
                let mean =
                    |of: fn(&Kept) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
                let matching = found.iter().map(|kept| kept.matching);
                let stands = mean(|kept| kept.matching) >= LEAST;
                rows.add_row([
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
    (kappa, closure): (usize, Closure),
    trial: Trial,
    place: usize,
) -> Result<Kept> {
    let clean = boxing.smooth(&boxing.clean, How::PAPER);
    let noisy = boxing.smooth(&boxing.poses[place], How::PAPER);
    let seed = NOISES[place];
    let way = (closure, SeedInstance::Random(0));
    let letters = clean.letters(kappa, 0)?;
    let before = clean.bundles(&letters, None, way)?;
    let after = match trial {
        Trial::Poses => noisy.bundles(&noisy.letters(kappa, 0)?, None, way)?,
        Trial::Channels => {
            let noisy = boxing.smooth(&boxing.channels[place], How::PAPER);
            noisy.bundles(&noisy.letters(kappa, 0)?, None, way)?
        }
        Trial::SameLetters => {
            let tau = clean.threshold(&letters)?;
            noisy.bundles(&letters, Some(tau), way)?
        }
        Trial::OtherSeed => clean.bundles(&clean.letters(kappa, seed)?, None, way)?,
        Trial::OtherInstances => {
            clean.bundles(&letters, None, (closure, SeedInstance::Random(seed)))?
        }
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

/// What is kept where poses are smoothed, where more are near, and where each bundle is the largest there is.
fn remedies(boxing: &Noisy) -> Result<String> {
    let mut rows = table(&[
        "smoothed, s",
        "near",
        "from",
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
    for how in HOW {
        // Of each number of letters, closure and way to start.
        let mut sums = [[[Sums::default(); 2]; 2]; 2];
        for (sums, kappa) in sums.iter_mut().zip(KAPPAS) {
            for seed in SEEDS {
                add(boxing, (how, kappa, seed), sums)?;
            }
        }
        for (from, name) in ["frequent", "all"].into_iter().enumerate() {
            for (noise, what) in ["poses", "channels"].into_iter().enumerate() {
                let runs = (SEEDS.len() * NOISES.len()) as f64;
                let mut cells = [how.smooth, how.near].map(|x| x.to_string()).to_vec();
                cells.extend([name, what].map(str::to_owned));
                let mut stands = true;
                for (kappa, sums) in KAPPAS.iter().zip(&sums) {
                    for sums in sums.iter().map(|of_closure| of_closure[from]) {
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
    }
    Ok(format!(
        "The same share, in matching bundles, mean of {} seeds of letters and {} of the noise, where poses are smoothed over time \
         (motif bundle --smooth), are near at a multiple of the threshold (--near), and where bundles grow from all letters, not \
         from an instance of the most frequent one (--from). Returning: of the frames of those bundles alone that come back, in another \
         clip or after more than half of their length, and how many these are of all frames. Where poses change slowly, and more so \
         where they are smoothed, what follows at once is similar, too. It stands where all bundles of {KAPPA} letters do, with both \
         closures\n{}\n\n",
        SEEDS.len(),
        NOISES.len(),
        rows.trim_fmt()
    ))
}

/// Adds what is kept to the sums of each closure and each way to start.
fn add(
    boxing: &Noisy,
    (how, kappa, seed): (How, usize, u64),
    sums: &mut [[Sums; 2]; 2],
) -> Result<()> {
    let spelt = |poses| boxing.spelt(poses, (how, kappa, seed));
    let (clean, letters) = spelt(&boxing.clean)?;
    let noisy = [&boxing.poses, &boxing.channels];
    let noisy = noisy.map(|of| of.iter().map(spelt).collect::<Result<Vec<_>>>());
    let [poses, channels] = noisy;
    let noisy = [poses?, channels?];
    for (sums, (_, closure)) in sums.iter_mut().zip(CLOSURES) {
        let ways = [SeedInstance::Random(seed), SeedInstance::Largest];
        for (sums, from) in sums.iter_mut().zip(ways) {
            let graph = clean.bundles(&letters, None, (closure, from))?;
            let before = clean.owners(&graph);
            let returning = returning(&graph, &before);
            sums.share += returning.iter().flatten().count() as f64 / before.len() as f64;
            for (noise, takes) in noisy.iter().enumerate() {
                for (take, letters) in takes {
                    let after = take.owners(&take.bundles(letters, None, (closure, from))?);
                    sums.matching[noise] += kept(&before, &after).matching;
                    sums.returning[noise] += kept(&returning, &after).matching;
                }
            }
        }
    }
    Ok(())
}

/// The largest bundles and what they match, in the paper's terms.
fn largest(boxing: &Noisy) -> Result<String> {
    let mut rows = table(&["smoothed, s", "near", "from", "closure", "1", "2", "3", "4"]);
    let noisy = boxing.poses.first().context("no noise")?;
    let ways = [
        (How::PAPER, "frequent", SeedInstance::Random(0)),
        (How::smoothed(SMOOTHED), "all", SeedInstance::Largest),
        (STEADY, "all", SeedInstance::Largest),
    ];
    for (how, name, from) in ways {
        let (clean, noisy) = (boxing.smooth(&boxing.clean, how), boxing.smooth(noisy, how));
        let (old, new) = (clean.letters(KAPPA, 0)?, noisy.letters(KAPPA, 0)?);
        for (closure_name, closure) in CLOSURES {
            let before = clean.bundles(&old, None, (closure, from))?;
            let after = noisy.bundles(&new, None, (closure, from))?;
            let found = matches(&clean.owners(&before), &noisy.owners(&after));
            let size = |graph: &BundleGraph, bundle: usize| {
                let bundle = &graph.bundles()[bundle];
                format!("{}x{:.0}", bundle.height(), bundle.mean_frames())
            };
            let mut order: Vec<usize> = (0..before.bundles().len()).collect();
            let volume = |bundle: usize| before.bundles()[bundle].volume;
            order.sort_by(|&a, &b| volume(b).total_cmp(&volume(a)));
            let mut cells = [how.smooth, how.near].map(|x| x.to_string()).to_vec();
            cells.extend([name, closure_name].map(str::to_owned));
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
