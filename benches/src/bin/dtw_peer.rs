//! Our side of `cargo xtask peers dtw`: `dtw_peer motif[:f64] RUNS JOB FILE`. Files hold numbers as
//! `f32`; `motif:f64` works on the same numbers as `f64`.

use std::{env, fs};

use anyhow::{Context, Result, bail};
use benches::stopwatch;
use dtw::{Band, BandRadius, Dtw, LocalCost, Sample, Search, WarpingPath, Window};
use ndarray::{ArrayView2, Axis};

const FRAMES: usize = 1000;
const SERIES: usize = 200;
const BAND: BandRadius = BandRadius::cells(100);
const PAIRWISE_BAND: BandRadius = BandRadius::cells(20);
const QUERY: usize = 128;
const WINDOWS_BAND: BandRadius = BandRadius::cells(6);

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [name, runs, job, file] = &arguments[..] else {
        bail!("NAME RUNS JOB FILE expected");
    };
    let bytes = fs::read(file)?;
    let (numbers, _) = bytes.as_chunks();
    let numbers: Vec<f32> = numbers.iter().map(|b| f32::from_le_bytes(*b)).collect();
    let runs = runs.parse()?;
    if name.ends_with(":f64") {
        let numbers: Vec<f64> = numbers.into_iter().map(f64::from).collect();
        work(job, runs, &numbers)
    } else {
        work(job, runs, &numbers)
    }
}

fn work<T: Sample>(job: &str, runs: usize, numbers: &[T]) -> Result<()> {
    let euclidean = |band: Band| Dtw::new(band).with_local_cost(LocalCost::Euclidean);
    let squared = |band: Band| Dtw::new(band).with_local_cost(LocalCost::SquaredEuclidean);
    let same: fn(f64) -> f64 = |cost| cost;
    let root: fn(f64) -> f64 = f64::sqrt;
    match job {
        "multi" => distance(&euclidean(Band::Full), runs, pair(numbers)?, same),
        "multi-squared" => distance(&squared(Band::Full), runs, pair(numbers)?, root),
        "path" => path(&euclidean(Band::Full), runs, pair(numbers)?, same),
        "path-squared" => path(&squared(Band::Full), runs, pair(numbers)?, root),
        "band" => distance(&euclidean(BAND.into()), runs, pair(numbers)?, same),
        "band-squared" | "univariate" => {
            distance(&squared(BAND.into()), runs, pair(numbers)?, root)
        }
        "pairwise" => pairwise(&squared(Band::Full), runs, numbers),
        "pairwise-band" => pairwise(&squared(PAIRWISE_BAND.into()), runs, numbers),
        "windows" => windows(runs, numbers),
        _ => bail!("no job is named {job}"),
    }
}

type Pair<'a, T> = [ArrayView2<'a, T>; 2];

/// Two sequences of equal length, one after the other.
fn pair<T: Sample>(numbers: &[T]) -> Result<Pair<'_, T>> {
    let shape = (2 * FRAMES, numbers.len() / (2 * FRAMES));
    let both = ArrayView2::from_shape(shape, numbers)?;
    let (a, b) = both.split_at(Axis(0), FRAMES);
    Ok([a, b])
}

fn distance<T: Sample>(
    dtw: &Dtw,
    runs: usize,
    [a, b]: Pair<'_, T>,
    scale: fn(f64) -> f64,
) -> Result<()> {
    let between = || dtw.distance(a, b).ok().flatten();
    between().context("no distance")?;
    let facts = |cost: &Option<f64>| [("cost", cost.map_or(f64::NAN, scale))];
    stopwatch::report(runs, between, facts);
    Ok(())
}

fn path<T: Sample>(
    dtw: &Dtw,
    runs: usize,
    [a, b]: Pair<'_, T>,
    scale: fn(f64) -> f64,
) -> Result<()> {
    let align = || dtw.align(a, b).ok().flatten();
    align().context("no path")?;
    stopwatch::report(runs, align, |path: &Option<WarpingPath>| {
        let stated = path.as_ref().map(|p| (scale(p.cost), p.steps.len() as f64));
        let (cost, steps) = stated.unwrap_or((f64::NAN, f64::NAN));
        [("cost", cost), ("steps", steps)]
    });
    Ok(())
}

/// Roots of the distances of all pairs, summed.
fn pairwise<T: Sample>(dtw: &Dtw, runs: usize, numbers: &[T]) -> Result<()> {
    let length = numbers.len() / SERIES;
    let series = numbers
        .chunks_exact(length)
        .map(|one| ArrayView2::from_shape((length, 1), one));
    let series: Vec<ArrayView2<'_, T>> = series.collect::<Result<_, _>>()?;
    let all = || dtw.distance_matrix(&series).ok();
    all().context("no distances")?;
    stopwatch::report(runs, all, |distances| {
        let of_pair = |(i, j): (usize, usize)| {
            let distance = distances.as_ref().and_then(|matrix| matrix[[i, j]]);
            distance.map_or(f64::NAN, f64::sqrt)
        };
        let pairs = (0..SERIES).flat_map(|i| (0..i).map(move |j| (i, j)));
        [("cost", pairs.map(of_pair).sum())]
    });
    Ok(())
}

/// The window of the series, in `numbers` after the query, that is nearest to the query.
fn windows<T: Sample>(runs: usize, numbers: &[T]) -> Result<()> {
    let (query, series) = numbers.split_at(QUERY);
    let query = ArrayView2::from_shape((query.len(), 1), query)?;
    let series = ArrayView2::from_shape((series.len(), 1), series)?;
    let search = Search::new(WINDOWS_BAND)
        .with_local_cost(LocalCost::SquaredEuclidean)
        .z_normalised();
    let best = || search.best_windows(query, series, 1, QUERY).ok();
    let first = |found: &Option<Vec<Window>>| found.as_ref().and_then(|w| w.first().copied());
    first(&best()).context("no window")?;
    stopwatch::report(runs, best, |found| {
        let (start, cost) = first(found).map_or((f64::NAN, f64::NAN), |window| {
            (window.start as f64, window.cost.sqrt())
        });
        [("start", start), ("cost", cost)]
    });
    Ok(())
}
