//! Bundles and graph of a seeded string of as many frames as the paper's largest example.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use benches::stopwatch::report;
use benches::strings::{Spelt, spelt};
use bundles::{
    BundleGraph, Closure, ExtractOptions, FrameMapping, MappingOptions, Partition, SeedInstance,
    extract, link, map_frames, max_letters,
};

const FRAMES: usize = 7_300;
const LETTERS: usize = 250;
const SEED: u64 = 1;
/// The paper's λ′.
const MAX_FRAMES: f64 = 200.0;

/// From the first occurrence of each seed letter, so that others need not draw as ours does.
fn options(spelt: &Spelt, closure: Closure) -> ExtractOptions {
    ExtractOptions {
        closure,
        seed: SeedInstance::First,
        ..ExtractOptions::new(max_letters(&spelt.string, MAX_FRAMES))
    }
}

/// Bundles by the direct closure, and their frames.
fn placed(spelt: &Spelt) -> Result<(Partition, FrameMapping)> {
    let (string, poses) = (&spelt.string, spelt.poses.view());
    let partition = extract(string, &spelt.access, &options(spelt, Closure::Direct))?;
    let mapping = map_frames(string, &partition, poses, &MappingOptions::default())?;
    Ok((partition, mapping))
}

/// Writes what others read: `string.txt` of one line of the threshold, the most letters of a substring and
/// γ, and a line of clip, first frame, end and label for each run; `distances.f64` of letters; `spans.txt`
/// of a line of bundle, or a dash, clip, first frame and end for each submotion.
pub(crate) fn write(folder: &Path) -> Result<()> {
    let spelt = spelt(FRAMES, LETTERS, SEED);
    let options = options(&spelt, Closure::Direct);
    let mut text = format!(
        "{:?} {} {:?}\n",
        spelt.access.tau(),
        options.max_letters,
        options.gamma
    );
    for run in spelt.string.runs() {
        let (frames, label) = (&run.frames, run.letter.label());
        let _ = writeln!(text, "{} {} {} {label}", run.clip, frames.start, frames.end);
    }
    fs::write(folder.join("string.txt"), text)?;
    let letter = |label: usize| bundles::Letter::from_label(label as u32);
    let mut bytes = Vec::with_capacity(LETTERS * LETTERS * 8);
    for (a, b) in (0..LETTERS).flat_map(|a| (0..LETTERS).map(move |b| (a, b))) {
        let distance = spelt.access.distance(letter(a), letter(b));
        bytes.extend(distance.context("a letter is missing")?.to_le_bytes());
    }
    fs::write(folder.join("distances.f64"), bytes)?;
    let (partition, mapping) = placed(&spelt)?;
    let mut text = String::new();
    let bundles = partition.bundles.iter().enumerate();
    let members =
        bundles.flat_map(|(id, bundle)| bundle.members.iter().map(move |m| (Some(id), m)));
    for (id, member) in members.chain(partition.degenerate.iter().map(|m| (None, m))) {
        let ends = [member.first, member.last].map(|letter| mapping.frame(letter));
        let [Some(start), Some(end)] = ends else {
            anyhow::bail!("a frame is missing");
        };
        let clip = spelt.string.runs()[member.first].clip;
        let id = id.map_or("-".to_owned(), |id| id.to_string());
        let _ = writeln!(text, "{id} {clip} {start} {end}");
    }
    fs::write(folder.join("spans.txt"), text)?;
    Ok(())
}

/// Extraction, and what it comes to.
pub(crate) fn extraction(runs: usize, closure: Closure) -> Result<()> {
    let spelt = spelt(FRAMES, LETTERS, SEED);
    let options = options(&spelt, closure);
    let work = || extract(&spelt.string, &spelt.access, &options).unwrap_or_default();
    report(runs, work, |found| {
        let place = |member: &bundles::Substring| (member.first + 2 * member.last) as f64;
        let bundles = found.bundles.iter().zip(1_u32..);
        let places = bundles.map(|(bundle, number)| {
            f64::from(number) * bundle.members.iter().map(place).sum::<f64>()
        });
        let n_members: usize = found
            .bundles
            .iter()
            .map(|bundle| bundle.members.len())
            .sum();
        [
            ("bundles", found.bundles.len() as f64),
            ("members", n_members as f64),
            ("degenerate", found.degenerate.len() as f64),
            ("places", places.sum()),
        ]
    });
    Ok(())
}

/// The graph of bundles whose frames are chosen, and its strongly connected components.
pub(crate) fn graph(runs: usize) -> Result<()> {
    let spelt = spelt(FRAMES, LETTERS, SEED);
    let (partition, mapping) = placed(&spelt)?;
    let work = || {
        let graph = link(&spelt.string, &partition, &mapping).unwrap_or_default();
        let components = graph.components();
        (graph, components)
    };
    report(runs, work, |(graph, components): &(BundleGraph, _)| {
        let n_passages: usize = graph.edges().iter().map(|edge| edge.passages.len()).sum();
        [
            ("nodes", graph.bundles().len() as f64),
            ("edges", graph.edges().len() as f64),
            ("passages", n_passages as f64),
            ("loose", graph.loose().len() as f64),
            ("components", Vec::len(components) as f64),
        ]
    });
    Ok(())
}
