//! `motif bundle`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use bundles::{Kappa, SeedInstance, Submotion};
use serde::Serialize;

use super::convert::is_same_file;
use super::tell_warnings;
use crate::args::{BundleArgs, FromArg, Global, MethodArg};
use crate::bundling::{Bundled, Poses, What, bundle, extended, load, save};
use crate::failure::{Exit, Failure, Skipped};
use crate::output::{Outcome, count, table};
use crate::source::{Format, find_clips};
use crate::targets;

/// What was made.
#[derive(Clone, Debug, Serialize)]
pub struct BundleResult {
    /// The model file.
    pub file: String,
    /// Clips of the model.
    pub clips: usize,
    /// Their frames.
    pub frames: usize,
    /// Frames from first to last pose of all spans of bundles.
    pub bundled_frames: usize,
    /// Pose clusters κ.
    pub clusters: usize,
    /// Letters of the motion string.
    pub string_length: usize,
    /// The nodes of the graph.
    pub bundles: Vec<BundleJson>,
    /// Its edges.
    pub edges: Vec<EdgeJson>,
}

/// A bundle.
#[derive(Clone, Debug, Serialize)]
pub struct BundleJson {
    /// Its number, from 0.
    pub id: usize,
    /// Number of submotions.
    pub height: usize,
    /// Frames of a submotion on average.
    pub mean_frames: f64,
    /// (height - 1)·frames^ρ.
    pub volume: f64,
    /// The submotions.
    pub spans: Vec<SpanJson>,
}

/// A submotion: the pose at `end` is the first of what follows.
#[derive(Clone, Debug, Serialize)]
pub struct SpanJson {
    /// The file.
    pub clip: String,
    /// First frame of the file.
    pub start: usize,
    /// One past the last.
    pub end: usize,
}

/// Two bundles that follow each other somewhere.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct EdgeJson {
    /// The one that is left.
    pub from: usize,
    /// The one that is entered.
    pub to: usize,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] if the command line makes no sense, a model cannot be read, or a file cannot be written.
pub fn run(args: &BundleArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let options = global.read_options()?;
    let old = args.add.as_deref().map(load).transpose()?;
    let clips = find_clips(&args.paths)?;
    let sources = clips.iter().map(|clip| &clip.path);
    check_targets(args, sources.chain(&options.asf))?;
    let (done, mut skipped) = voice.batch(&clips, "reading", |clip| Poses::read(clip, &options));
    let read: Vec<Poses> = done.into_iter().map(|(_, poses)| poses).collect();
    let fitting = fitting(read, old.as_ref(), &mut skipped);
    tell_warnings(voice, fitting.iter().flat_map(|poses| &poses.warnings));
    let bundled = match (&old, fitting.as_slice()) {
        (_, []) => None,
        (Some(old), fitting) => Some(extended(old, fitting)?),
        (None, fitting) => Some(bundle(fitting, &what(args))?),
    };
    if let Some(bundled) = &bundled {
        save(bundled, &args.output)?;
        export(bundled, args)?;
    }
    let result = bundled.as_ref().map(|b| summary(b, &args.output));
    let outcome = Outcome {
        found: result.as_ref().is_some_and(|r| !r.bundles.is_empty()),
        result,
        skipped,
    };
    voice.report("bundle", &outcome, |out| match &outcome.result {
        Some(result) => write_text(out, result),
        None => Ok(()),
    })
}

/// Refuses to write over a clip or a skeleton, and to write two things into one file. The model that is added to may be
/// written over, since it is read as a whole before.
fn check_targets<'a>(
    args: &BundleArgs,
    sources: impl Iterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    let exports = [&args.dot, &args.svg, &args.graphml];
    let exports: Vec<&PathBuf> = exports.into_iter().flatten().collect();
    let refuse = |path: &Path, why| Err(Failure::Usage(format!("{}: {why}", path.display())));
    // The skeleton that an AMC file finds beside it is read as well, so no name of a motion will do.
    let mut targets = exports.iter().copied().chain([&args.output]);
    if let Some(target) = targets.find(|target| Format::of(target).is_some()) {
        return refuse(target, "expected another name, since this is a motion's");
    }
    for source in sources {
        let mut targets = exports.iter().copied().chain([&args.output]);
        if let Some(target) = targets.find(|target| is_same_file(target, source)) {
            return refuse(target, "would be written over what is read");
        }
    }
    for (i, target) in exports.iter().enumerate() {
        let mut others = exports[..i]
            .iter()
            .copied()
            .chain([&args.output])
            .chain(&args.add);
        if others.any(|other| other == *target || is_same_file(other, target)) {
            return refuse(target, "would hold two things");
        }
    }
    Ok(())
}

fn what(args: &BundleArgs) -> What {
    let kappa = args.kappa.map(|kappa| kappa.0);
    let usual = match args.method {
        MethodArg::Steady => What::new(kappa),
        MethodArg::Paper => What {
            from: SeedInstance::Random(args.seed),
            ..What::paper(kappa.unwrap_or(Kappa::Auto))
        },
    };
    What {
        rho: args.rho,
        gamma: args.gamma,
        closure: args.closure.map_or(usual.closure, Into::into),
        max_frames: args.max_frames.get() as f64,
        duration_weight: args.duration_weight,
        seed: args.seed,
        from: match args.from {
            None => usual.from,
            Some(FromArg::Frequent) => SeedInstance::Random(args.seed),
            Some(FromArg::All) => SeedInstance::Largest,
        },
        smooth: args.smooth.unwrap_or(usual.smooth),
        near: args.near,
        ..usual
    }
}

/// Clips like the first one, or like those of the old model and not in it.
fn fitting(read: Vec<Poses>, old: Option<&Bundled>, skipped: &mut Vec<Skipped>) -> Vec<Poses> {
    let mut fitting: Vec<Poses> = Vec::new();
    for poses in read {
        let like = match (old, fitting.first()) {
            (Some(old), _) => poses.check_like(&old.layout, old.rate),
            (None, Some(first)) => poses.check_like(&first.layout, first.rate),
            (None, None) => Ok(()),
        };
        let clip = poses.clip.clip();
        let is_known = old.is_some_and(|old| old.clips.iter().any(|known| known.clip() == clip));
        let refused = like.and(match is_known {
            true => Err(Failure::input(
                &clip.path,
                "the model has this clip already",
            )),
            false => Ok(()),
        });
        match refused {
            Ok(()) => fitting.push(poses),
            Err(failure) => skipped.push(Skipped::new(&clip.path, &failure)),
        }
    }
    fitting
}

fn export(bundled: &Bundled, args: &BundleArgs) -> Result<(), Failure> {
    let names: Vec<String> = bundled.clips.iter().map(|c| c.clip().display()).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let graph = bundled.model.graph();
    let write = |path: &Option<PathBuf>, text: &dyn Fn() -> String| match path {
        Some(path) => targets::write(path, text().as_bytes()),
        None => Ok(()),
    };
    write(&args.dot, &|| graph.to_dot(&names))?;
    write(&args.svg, &|| graph.to_svg(&names))?;
    write(&args.graphml, &|| graph.to_graphml(&names))
}

/// A model as JSON.
#[must_use]
pub fn summary(bundled: &Bundled, file: &Path) -> BundleResult {
    let graph = bundled.model.graph();
    let span = |submotion: &Submotion| {
        let (clip, frames) = bundled.source(submotion)?;
        Some(SpanJson {
            clip: clip.path.display().to_string(),
            start: frames.start,
            end: frames.end,
        })
    };
    let bundles = graph.bundles().iter().enumerate();
    let bundles: Vec<BundleJson> = bundles
        .map(|(id, bundle)| BundleJson {
            id,
            height: bundle.height(),
            mean_frames: bundle.mean_frames(),
            volume: bundle.volume,
            spans: bundle.submotions.iter().filter_map(span).collect(),
        })
        .collect();
    let spans = bundles.iter().flat_map(|bundle| &bundle.spans);
    BundleResult {
        file: file.display().to_string(),
        clips: bundled.clips.len(),
        frames: bundled.clips.iter().map(|clip| clip.frames.len()).sum(),
        bundled_frames: spans.map(|span| span.end - span.start).sum(),
        clusters: bundled.clusters.n_letters(),
        string_length: bundled.model.string().len(),
        edges: graph
            .edges()
            .iter()
            .map(|edge| EdgeJson {
                from: edge.from,
                to: edge.to,
            })
            .collect(),
        bundles,
    }
}

/// Spans that a line of the table shows.
const SPANS_SHOWN: usize = 3;

fn write_text(out: &mut dyn Write, result: &BundleResult) -> io::Result<()> {
    writeln!(
        out,
        "{}: {} of {}, {} in {} of {} pose clusters",
        result.file,
        count(result.clips, "clip"),
        count(result.frames, "frame"),
        count(result.bundles.len(), "bundle"),
        count(result.string_length, "letter"),
        result.clusters,
    )?;
    let share = 100.0 * result.bundled_frames as f64 / result.frames.max(1) as f64;
    writeln!(
        out,
        "{share:.1} % of the frames are in bundles, joined by {}",
        count(result.edges.len(), "edge")
    )?;
    if result.bundles.is_empty() {
        return Ok(());
    }
    let mut lines = table(&["bundle", "height", "frames", "volume", "next", "spans"]);
    for bundle in &result.bundles {
        let next = result.edges.iter().filter(|edge| edge.from == bundle.id);
        let next: Vec<String> = next.map(|edge| format!("B{}", edge.to)).collect();
        let spans = bundle.spans.iter().take(SPANS_SHOWN);
        let mut spans: Vec<String> = spans
            .map(|span| format!("{}@{}-{}", span.clip, span.start, span.end))
            .collect();
        if bundle.spans.len() > spans.len() {
            spans.push("…".to_owned());
        }
        lines.add_row([
            format!("B{}", bundle.id),
            bundle.height.to_string(),
            format!("{:.1}", bundle.mean_frames),
            format!("{:.0}", bundle.volume),
            next.join(" "),
            spans.join(" "),
        ]);
    }
    writeln!(out, "{lines}")
}
