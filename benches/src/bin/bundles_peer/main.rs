//! Our side of `cargo xtask peers bundles`.
//!
//! `bundles_peer seed KAPPA FRAMES START` draws what every mixture starts from: weights, variances
//! and means as `f64`. `bundles_peer motif RUNS em FRAMES START` fits from there. `bundles_peer spelt FOLDER`
//! writes a string and the submotions of its bundles; `bundles_peer motif RUNS JOB FOLDER`, the job being
//! `extract`, `extract-transitive` or `graph`, makes bundles and graph of the same string.

use std::path::Path;
use std::{env, fs};

use anyhow::{Context, Result, bail};
use bundles::{Closure, EmOptions, Kappa, MixtureFit, PoseClusters, fit_mixture, fit_mixture_from};
use cpu_time::ProcessTime;
use ndarray::{Array1, Array2, ArrayView1, ArrayView2};

mod cut;

const DIMS: usize = 12;

/// An iteration takes as long as the last of these more than the first, over their number.
const ITERATIONS: [usize; 2] = [5, 25];

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["seed", kappa, frames, start] => seed(kappa.parse()?, frames.as_ref(), start.as_ref()),
        ["motif", runs, "em", frames, start] => em(runs.parse()?, frames.as_ref(), start.as_ref()),
        ["spelt", folder] => cut::write(folder.as_ref()),
        ["motif", runs, "extract", _] => cut::extraction(runs.parse()?, Closure::Direct),
        ["motif", runs, "extract-transitive", _] => {
            cut::extraction(runs.parse()?, Closure::Transitive)
        }
        ["motif", runs, "graph", _] => cut::graph(runs.parse()?),
        _ => bail!("seed KAPPA FRAMES START, spelt FOLDER, or motif RUNS JOB FILES expected"),
    }
}

/// Frames, `(frames, DIMS)`.
fn frames(path: &Path) -> Result<Array2<f64>> {
    let numbers = numbers(path)?;
    let shape = (numbers.len() / DIMS, DIMS);
    Ok(Array2::from_shape_vec(shape, numbers)?)
}

fn numbers(path: &Path) -> Result<Vec<f64>> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let (numbers, _) = bytes.as_chunks();
    Ok(numbers.iter().map(|b| f64::from_le_bytes(*b)).collect())
}

fn options(kappa: Kappa, max_iterations: usize) -> EmOptions {
    EmOptions {
        max_iterations,
        tolerance: 0.0,
        ..EmOptions::new(kappa)
    }
}

/// Of the start: one whose clusters all have several frames, since the peers have no floor of variances.
const SEED: u64 = 1;

fn seed(kappa: usize, path: &Path, start: &Path) -> Result<()> {
    let kappa = Kappa::Letters(kappa.try_into()?);
    let options = EmOptions {
        seed: SEED,
        ..options(kappa, 0)
    };
    let MixtureFit { clusters, .. } = fit_mixture(frames(path)?.view(), &options)?;
    let variances = clusters.sigmas().mapv(|sigma| sigma * sigma);
    let means = clusters.means();
    let weights = clusters.weights();
    let numbers = weights.iter().chain(&variances).chain(&means);
    let bytes: Vec<u8> = numbers.flat_map(|x| x.to_le_bytes()).collect();
    fs::write(start, bytes).with_context(|| format!("cannot write {}", start.display()))
}

fn em(runs: usize, path: &Path, start: &Path) -> Result<()> {
    let frames = frames(path)?;
    let start = numbers(start)?;
    let kappa = start.len() / (DIMS + 2);
    let (weights, rest) = start.split_at(kappa);
    let (variances, means) = rest.split_at(kappa);
    let sigmas: Array1<f64> = variances.iter().map(|variance| variance.sqrt()).collect();
    let means = ArrayView2::from_shape((kappa, DIMS), means)?;
    let start = PoseClusters::new(means, sigmas.view())?.with_weights(ArrayView1::from(weights))?;
    let fit = |iterations| {
        let options = options(Kappa::Auto, iterations);
        let from = ProcessTime::now();
        let fit = fit_mixture_from(frames.view(), &start, &options);
        fit.map(|fit| (fit, from.elapsed().as_secs_f64() * 1e3))
    };
    let [few, many] = ITERATIONS;
    let mut times = Vec::with_capacity(runs);
    for _ in 0..runs {
        let ((_, short), (_, long)) = (fit(few)?, fit(many)?);
        times.push((long - short) / (many - few) as f64);
    }
    times.sort_by(f64::total_cmp);
    let (fit, _) = fit(many)?;
    let last = fit.log_likelihoods.last().context("no iteration")?;
    let clusters = &fit.clusters;
    let spread = |mean: ArrayView1<'_, f64>| mean.dot(&mean);
    let means = clusters.means();
    let spreads = means.outer_iter().map(spread);
    let spread: f64 = spreads.zip(clusters.weights()).map(|(x, w)| x * w).sum();
    let log_likelihood = last / frames.nrows() as f64;
    let ms = times[runs / 2];
    println!("log_likelihood={log_likelihood} spread={spread} ms={ms}");
    Ok(())
}
