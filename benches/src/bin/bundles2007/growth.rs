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
use crate::stages::{self, Clips, Smooth};
use crate::takes::{CLOSURES, How};

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

/// The letters that bundles grow from.
#[derive(Clone, Copy)]
struct Way {
    name: &'static str,
    from: SeedInstance,
}

/// As the paper has it.
const FREQUENT: Way = Way {
    name: "frequent",
    from: SeedInstance::Random(0),
};

/// The same letters.
const ALL: Way = Way {
    name: "all",
    from: SeedInstance::Largest,
};

/// The command's own method.
const STEADY: Way = Way {
    name: "steady",
    from: SeedInstance::Largest,
};

/// Tag of the stages that the paper's ways share.
const PAPER: &str = "paper";

/// Each method, with the tag of its own stages and its ways.
const TAGGED: [(How, &str, &[Way]); 2] = [
    (How::STEADY, STEADY.name, &[STEADY]),
    (How::PAPER, PAPER, &[FREQUENT, ALL]),
];

impl Way {
    /// All its stages.
    fn total_name(self) -> String {
        format!("sum, {}", self.name)
    }

    /// Whether it needs a stage: what no way or its own one has as tag.
    fn needs(self, stage: &str) -> bool {
        match stage.rsplit_once(", ") {
            None => true,
            Some((_, PAPER)) => self.name != STEADY.name,
            Some((_, tag)) => tag == self.name,
        }
    }
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
    let rate = motions.first().map_or(1.0, |motion| motion.rate.hz());
    drop(motions);
    clock.end("vectors");
    let clips = Clips {
        vectors: vectors.view(),
        ranges: &ranges,
    };
    let kappa = (n_frames / FRAMES_PER_LETTER).min(MOST_LETTERS);
    let mut sizes = Vec::new();
    let mut n_products = 1;
    for (how, tag, ways) in TAGGED {
        let smooth = Smooth::new(clips, rate, how);
        clock.end(&format!("smoothing, {tag}"));
        let mut mark = |stage: &str| clock.end(&format!("{stage}, {tag}"));
        let letters = smooth.letters(kappa, 0, &mut mark)?;
        let (string, access) = smooth.spelt(&letters, None)?;
        clock.end(&format!("labels, {tag}"));
        let (n_components, n_iterations) = (letters.pca.n_components(), letters.n_iterations);
        n_products = n_products.max(n_components * n_iterations);
        sizes.push(format!(
            "{tag}: {n_components} components, {n_iterations} iterations, a string of {}",
            string.len()
        ));
        for ((closure_name, closure), way) in CLOSURES
            .iter()
            .flat_map(|closure| ways.iter().map(move |way| (closure, way)))
        {
            let options = ExtractOptions {
                seed: way.from,
                ..stages::options(&string, *closure, 0)
            };
            let name = format!("{closure_name}, {}", way.name);
            let mut mark = |stage: &str| clock.end(&format!("{stage}, {name}"));
            let graph = stages::graph(clips, (&string, &access), &options, &mut mark)?;
            sizes.push(format!("{} bundles {name}", graph.bundles().len()));
        }
    }
    println!(
        "{n_frames} frames in {} clips ({n_refused} takes left out), {kappa} letters, {}",
        ranges.len(),
        sizes.join(", ")
    );
    let n_products = n_products as f64;
    let em = format!("letters, {PAPER}");
    let em = clock.stages.iter().find(|stage| stage.name == em).cloned();
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
    let ways = [STEADY, FREQUENT, ALL];
    for way in ways {
        let totals = SIZES.map(|n_frames| total(&found, n_frames, way));
        let keys = SIZES.map(|n_frames| (way.total_name(), n_frames));
        found.extend(keys.into_iter().zip(totals));
        names.push(way.total_name());
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
    for way in ways {
        if let Some(Stage { wall, cpu, .. }) = found.get(&(way.total_name(), largest)) {
            println!(
                "{largest} frames with {MOST_LETTERS} letters, both closures, {}: {wall:.1} s on the wall, {cpu:.1} s of \
                 the processor; at most {MOST_SECONDS} s: {}",
                way.name,
                if *wall < MOST_SECONDS { "yes" } else { "no" }
            );
        }
    }
    Ok(())
}

/// All stages of a size that a way needs together.
fn total(found: &BTreeMap<(String, usize), Stage>, n_frames: usize, way: Way) -> Stage {
    let of_size = found
        .iter()
        .filter(|((name, n), _)| *n == n_frames && name != EM_SHARE && way.needs(name));
    let stages: Vec<&Stage> = of_size.map(|(_, stage)| stage).collect();
    let peaks = stages.iter().filter_map(|stage| stage.peak);
    Stage {
        name: way.total_name(),
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
