//! Time and memory of each stage from 1,000 to 400,000 frames.

use std::collections::BTreeMap;
use std::env;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use benches::scale::fit::exponent;
use bundles::{ExtractOptions, SeedInstance};
use cli::output::table;

use crate::clock::{Clock, Stage};
use crate::library;
use crate::stages::{self, Clips, Letters};
use crate::takes::CLOSURES;

/// The option for one size in a process of its own, so that memory is its alone.
pub(crate) const SIZE: &str = "--growth-size";

const SIZES: [usize; 6] = [1_000, 4_000, 16_000, 64_000, 200_000, 400_000];

/// As many frames have a letter in the paper's examples: 1,900 for 90, 5,400 for 250.
const FRAMES_PER_LETTER: usize = 20;

/// The most letters.
const MOST_LETTERS: usize = 500;

/// Exponents are fitted from here on, where the number of letters stays the same.
const FITTED_FROM: usize = MOST_LETTERS * FRAMES_PER_LETTER;

/// The project's bar for the largest size, in seconds on two cores.
const MOST_SECONDS: f64 = 600.0;

/// Which letters bundles grow from.
const FROM: [(&str, SeedInstance); 2] = [
    ("frequent", SeedInstance::Random(0)),
    ("all", SeedInstance::Largest),
];

/// All stages, with the bundles that grow from such letters.
fn total_name(from: &str) -> String {
    format!("sum, {from}")
}

/// EM over its iterations and components, of which there are more where there is more motion; no stage of
/// its own.
const EM_SHARE: &str = "EM/(iterations x components)";

/// What a table shows of a stage.
type Quantity = fn(&Stage) -> Option<f64>;

/// Measures one size and prints a line of facts, then `name|wall|cpu|peak` for each stage.
pub(crate) fn measure(data: &Path, n_frames: usize) -> Result<()> {
    let mut clock = Clock::start();
    let (motions, n_refused) = library::motions(data, n_frames)?;
    clock.end("read");
    let (vectors, ranges) = library::vectors(&motions, n_frames)?;
    drop(motions);
    clock.end("vectors");
    let clips = Clips {
        vectors: vectors.view(),
        ranges: &ranges,
    };
    let kappa = (n_frames / FRAMES_PER_LETTER).min(MOST_LETTERS);
    let letters = Letters::fit(clips, kappa, 0, &mut |name| clock.end(name))?;
    let string = letters.spell(clips)?;
    let access = letters.access(letters.threshold(&string)?)?;
    clock.end("labels");
    let mut sizes = Vec::new();
    for (closure_name, closure) in CLOSURES {
        for (from, seed) in FROM {
            let options = ExtractOptions {
                seed,
                ..stages::options(&string, closure, 0)
            };
            let name = format!("{closure_name}, {from}");
            let mut mark = |stage: &str| clock.end(&format!("{stage}, {name}"));
            let graph = stages::graph(clips, (&string, &access), &options, &mut mark)?;
            sizes.push(format!("{} bundles {name}", graph.bundles().len()));
        }
    }
    println!(
        "{n_frames} frames in {} clips ({n_refused} takes left out), {kappa} letters, {} components, {} iterations, a string of \
         {}, {}",
        ranges.len(),
        letters.pca.n_components(),
        letters.n_iterations,
        string.len(),
        sizes.join(", ")
    );
    let n_products = (letters.n_iterations * letters.pca.n_components()) as f64;
    let em = clock
        .stages
        .iter()
        .find(|stage| stage.name == "EM")
        .cloned();
    let em = em.map(|em| Stage {
        name: EM_SHARE.to_owned(),
        wall: em.wall / n_products,
        cpu: em.cpu / n_products,
        peak: None,
    });
    for Stage {
        name,
        wall,
        cpu,
        peak,
    } in clock.stages.into_iter().chain(em)
    {
        println!(
            "{name}|{wall}|{cpu}|{}",
            peak.map_or(String::new(), |mb| mb.to_string())
        );
    }
    Ok(())
}

/// Runs all sizes, each in a process.
pub(crate) fn report(data: &Path) -> Result<()> {
    println!(
        "Growth: takes of cmu and hdm05 in order of their paths, then their mirror images; a letter for {FRAMES_PER_LETTER} \
         frames, at most {MOST_LETTERS}. Seconds on the wall and of the processor, most memory of the process during the stage"
    );
    let mut names: Vec<String> = Vec::new();
    let mut found: BTreeMap<(String, usize), Stage> = BTreeMap::new();
    for n_frames in SIZES {
        let (facts, stages) = child(data, n_frames)?;
        println!("  {facts}");
        for stage in stages {
            if !names.contains(&stage.name) {
                names.push(stage.name.clone());
            }
            found.insert((stage.name.clone(), n_frames), stage);
        }
    }
    for (from, _) in FROM {
        let totals = SIZES.map(|n_frames| total(&found, n_frames, from));
        let keys = SIZES.map(|n_frames| (total_name(from), n_frames));
        found.extend(keys.into_iter().zip(totals));
        names.push(total_name(from));
    }
    let cells: [(&str, Quantity); 3] = [
        ("wall s", |stage| Some(stage.wall)),
        ("CPU s", |stage| Some(stage.cpu)),
        ("peak MB", |stage| stage.peak),
    ];
    for (what, cell) in cells {
        println!(
            "{}\n",
            grown(what, &names, &|name, n| found
                .get(&(name.to_owned(), n))
                .and_then(cell))
        );
    }
    let largest = SIZES[SIZES.len() - 1];
    for (from, _) in FROM {
        if let Some(Stage { wall, cpu, .. }) = found.get(&(total_name(from), largest)) {
            println!(
                "{largest} frames with {MOST_LETTERS} letters, both closures, from {from}: {wall:.1} s on the wall, {cpu:.1} s of \
                 the processor; at most {MOST_SECONDS} s: {}",
                if *wall < MOST_SECONDS { "yes" } else { "no" }
            );
        }
    }
    Ok(())
}

/// All stages of a size together, but for bundles that grow from other letters.
fn total(found: &BTreeMap<(String, usize), Stage>, n_frames: usize, from: &str) -> Stage {
    let is_other = |name: &str| {
        let mut others = FROM.iter().filter(|(other, _)| *other != from);
        others.any(|(other, _)| name.ends_with(&format!(", {other}")))
    };
    let of_size = found
        .iter()
        .filter(|((name, n), _)| *n == n_frames && name != EM_SHARE && !is_other(name));
    let stages: Vec<&Stage> = of_size.map(|(_, stage)| stage).collect();
    let peaks = stages.iter().filter_map(|stage| stage.peak);
    Stage {
        name: total_name(from),
        wall: stages.iter().map(|stage| stage.wall).sum(),
        cpu: stages.iter().map(|stage| stage.cpu).sum(),
        peak: peaks.max_by(f64::total_cmp),
    }
}

/// A table of one quantity by stage and size, with its exponent.
fn grown(what: &str, names: &[String], cell: &dyn Fn(&str, usize) -> Option<f64>) -> String {
    let sizes = SIZES.map(|n_frames| n_frames.to_string());
    let mut heads = vec![what];
    heads.extend(sizes.iter().map(String::as_str));
    heads.push("exponent");
    let mut rows = table(&heads);
    for name in names {
        let values = SIZES.map(|n_frames| cell(name, n_frames));
        let points = SIZES.iter().zip(values).filter(|(n, _)| **n >= FITTED_FROM);
        let points: Option<Vec<(f64, f64)>> = points.map(|(n, y)| Some((*n as f64, y?))).collect();
        let fitted = points.and_then(|points| exponent(&points));
        let mut row = vec![name.clone()];
        row.extend(values.map(|value| value.map_or("-".to_owned(), |x| format!("{x:.4}"))));
        row.push(fitted.map_or("-".to_owned(), |b| format!("{b:.2}")));
        rows.add_row(row);
    }
    rows.trim_fmt()
}

/// What this program says of a size, in another process.
fn child(data: &Path, n_frames: usize) -> Result<(String, Vec<Stage>)> {
    let mut command = Command::new(env::current_exe()?);
    let output = command
        .arg(data)
        .args([SIZE, &n_frames.to_string()])
        .output()?;
    let error = String::from_utf8_lossy(&output.stderr);
    ensure!(
        output.status.success(),
        "{n_frames} frames: {}",
        error.trim()
    );
    let text = String::from_utf8(output.stdout)?;
    let (facts, lines) = text.split_once('\n').context("no stages")?;
    let stages = lines.lines().map(stage).collect::<Result<_>>()?;
    Ok((facts.to_owned(), stages))
}

fn stage(line: &str) -> Result<Stage> {
    let cells: Vec<&str> = line.split('|').collect();
    let [name, wall, cpu, peak] = cells[..] else {
        anyhow::bail!("expected a stage, found {line}");
    };
    Ok(Stage {
        name: name.to_owned(),
        wall: wall.parse()?,
        cpu: cpu.parse()?,
        peak: peak.parse().ok(),
    })
}
