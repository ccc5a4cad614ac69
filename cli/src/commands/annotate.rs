//! `motif annotate`.

mod live;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde::Serialize;

use super::{tell_filled, tell_warnings};
use crate::annotation::{Annotation, Span, Tier, write_eaf};
use crate::args::{AnnotateArgs, AnnotationFormat, Global};
use crate::failure::{Exit, Failure};
use crate::output::{Outcome, count, table};
use crate::source::{ClipRef, find_clips};
use crate::take::Take;
use crate::targets;

/// The spans of a clip, as design.md §4 lays it down.
#[derive(Clone, Debug, Serialize)]
pub struct AnnotationJson {
    /// The file, with its span if one was asked for.
    pub clip: String,
    /// In order of their frames.
    pub spans: Vec<SpanJson>,
    /// Labels that could not be looked for, as the clip's rig lacks features that they ask for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lacking: Vec<String>,
}

/// A labelled span. Frames are those of the source file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpanJson {
    /// The template's name.
    pub label: String,
    /// First frame.
    pub start: usize,
    /// One past the last frame.
    pub end: usize,
    /// Seconds from the start of the file.
    pub start_s: f64,
    /// Seconds from the start of the file.
    pub end_s: f64,
    /// Cost of the match that the span is of.
    pub cost: f64,
    /// The most that it might have been.
    pub tau: f64,
}

impl SpanJson {
    fn new(span: &Span, labels: &[String], rate: f64) -> SpanJson {
        SpanJson {
            label: labels[span.label].clone(),
            start: span.frames.start,
            end: span.frames.end,
            start_s: span.frames.start as f64 / rate,
            end_s: span.frames.end as f64 / rate,
            cost: span.cost,
            tau: span.tau,
        }
    }
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] for templates that cannot be read, and if nothing can be written.
pub fn run(args: &AnnotateArgs, global: &Global) -> Result<Exit, Failure> {
    let labeller = args.labeller()?;
    if args.stream {
        return live::run(&labeller, global);
    }
    let voice = global.voice();
    let clips = find_clips(&args.paths)?;
    let target = args.output.as_deref();
    let target = target.map(|path| Target::new(path, args.format, &clips));
    let target = target.transpose()?;
    let options = global.read_options()?;
    let (done, skipped) = voice.batch(&clips, "annotating", |clip| {
        let take = Take::load(clip, &options)?;
        let annotation = labeller.annotate(&take)?;
        let annotation = match args.exclusive {
            true => annotation.exclusive(),
            false => annotation,
        };
        let json = to_json(clip, annotation, labeller.labels(), take.rate());
        Ok((json, take.loaded.filled.len(), take.loaded.warnings))
    });
    tell_warnings(
        voice,
        done.iter().flat_map(|(_, (_, _, warnings))| warnings),
    );
    tell_filled(voice, done.iter().map(|(_, (_, filled, _))| filled).sum());
    let result: Vec<(ClipRef, AnnotationJson)> = done
        .into_iter()
        .map(|(clip, (json, ..))| (clip, json))
        .collect();
    let written = match target {
        Some(target) => target.write(&result, args.exclusive)?,
        None => Vec::new(),
    };
    let result: Vec<AnnotationJson> = result.into_iter().map(|(_, json)| json).collect();
    let outcome = Outcome {
        found: result.iter().any(|clip| !clip.spans.is_empty()),
        result,
        skipped,
    };
    voice.report("annotate", &outcome, |out| {
        match written.as_slice() {
            [] => write_table(out, &outcome.result)?,
            files => {
                for path in files {
                    writeln!(out, "{}", path.display())?;
                }
            }
        }
        write_lacking(out, &outcome.result)
    })
}

fn to_json(clip: &ClipRef, found: Annotation, labels: &[String], rate: f64) -> AnnotationJson {
    let spans = found.spans.iter();
    let lacking = found.lacking.iter();
    AnnotationJson {
        clip: clip.display(),
        spans: spans
            .map(|span| SpanJson::new(span, labels, rate))
            .collect(),
        lacking: lacking.map(|&label| labels[label].clone()).collect(),
    }
}

fn write_table(out: &mut dyn Write, clips: &[AnnotationJson]) -> io::Result<()> {
    let mut spans = table(&["clip", "label", "frames", "seconds", "cost"]);
    for clip in clips {
        for span in &clip.spans {
            spans.add_row([
                clip.clip.clone(),
                span.label.clone(),
                format!("{}-{}", span.start, span.end),
                format!("{:.2}-{:.2}", span.start_s, span.end_s),
                format!("{:.4}", span.cost),
            ]);
        }
    }
    let n_spans = clips.iter().map(|clip| clip.spans.len()).sum();
    if n_spans > 0 {
        writeln!(out, "{spans}")?;
    }
    writeln!(
        out,
        "{} in {}",
        count(n_spans, "span"),
        count(clips.len(), "clip")
    )
}

fn write_lacking(out: &mut dyn Write, clips: &[AnnotationJson]) -> io::Result<()> {
    for clip in clips.iter().filter(|clip| !clip.lacking.is_empty()) {
        let labels = clip.lacking.join(", ");
        writeln!(
            out,
            "{}: its rig lacks features of {labels}, which were not looked for",
            clip.clip
        )?;
    }
    Ok(())
}

/// Where spans go.
enum Target {
    /// All into one file.
    File(PathBuf, AnnotationFormat),
    /// One file per clip, with these paths.
    Folder(Vec<(ClipRef, PathBuf)>, AnnotationFormat),
}

impl Target {
    fn new(
        path: &Path,
        format: Option<AnnotationFormat>,
        clips: &[ClipRef],
    ) -> Result<Target, Failure> {
        if targets::is_folder(path) {
            let format = format.unwrap_or(AnnotationFormat::Csv);
            let paths = targets::file_per_clip(path, format.extension(), clips);
            let files = clips.iter().cloned().zip(paths).collect();
            return Ok(Target::Folder(files, format));
        }
        let extension = path
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or_default();
        let format = format.or_else(|| AnnotationFormat::from_str(extension, true).ok());
        let format = format.ok_or_else(|| {
            Failure::Usage(format!(
                "{}: expected .json, .csv or .eaf, a folder, or --format",
                path.display()
            ))
        })?;
        if format == AnnotationFormat::Eaf && clips.len() > 1 {
            return Err(Failure::Usage(format!(
                "{} can hold one clip, there are {}; name a folder (with / at its end) and --format eaf",
                path.display(),
                clips.len()
            )));
        }
        Ok(Target::File(path.to_owned(), format))
    }

    /// Writes everything and gives the files written.
    fn write(
        &self,
        clips: &[(ClipRef, AnnotationJson)],
        one_tier: bool,
    ) -> Result<Vec<PathBuf>, Failure> {
        match self {
            Target::File(path, format) => {
                let all: Vec<&AnnotationJson> = clips.iter().map(|(_, json)| json).collect();
                write_file(path, *format, &all, one_tier)?;
                Ok(vec![path.clone()])
            }
            Target::Folder(files, format) => {
                let mut written = Vec::new();
                for (clip, json) in clips {
                    if let Some((_, path)) = files.iter().find(|(named, _)| named == clip) {
                        write_file(path, *format, &[json], one_tier)?;
                        written.push(path.clone());
                    }
                }
                Ok(written)
            }
        }
    }
}

fn write_file(
    path: &Path,
    format: AnnotationFormat,
    clips: &[&AnnotationJson],
    one_tier: bool,
) -> Result<(), Failure> {
    let mut bytes = Vec::new();
    let written = match format {
        AnnotationFormat::Json => {
            serde_json::to_writer_pretty(&mut bytes, clips).map_err(Into::into)
        }
        AnnotationFormat::Csv => write_csv(&mut bytes, clips),
        AnnotationFormat::Eaf => write_eaf(&tiers(clips, one_tier), &mut bytes),
    };
    written.map_err(|e| Failure::io(path, e))?;
    targets::write(path, &bytes)
}

fn write_csv(out: &mut impl Write, clips: &[&AnnotationJson]) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(["clip", "label", "start", "end", "start_s", "end_s", "cost"])?;
    for clip in clips {
        for span in &clip.spans {
            let [start, end] = [span.start, span.end].map(|frame| frame.to_string());
            let [start_s, end_s] = [span.start_s, span.end_s].map(|time| format!("{time:.6}"));
            let cost = span.cost.to_string();
            csv.write_record([
                &clip.clip,
                &span.label,
                &start,
                &end,
                &start_s,
                &end_s,
                &cost,
            ])?;
        }
    }
    csv.flush()
}

/// A tier per label; one for all where no two labels hold at once.
fn tiers(clips: &[&AnnotationJson], one_tier: bool) -> Vec<Tier> {
    let mut tiers: Vec<Tier> = Vec::new();
    for span in clips.iter().flat_map(|clip| &clip.spans) {
        let name = if one_tier { "motion" } else { &span.label };
        let i = match tiers.iter().position(|tier| tier.name == name) {
            Some(i) => i,
            None => {
                tiers.push(Tier {
                    name: name.to_owned(),
                    spans: Vec::new(),
                });
                tiers.len() - 1
            }
        };
        tiers[i]
            .spans
            .push((span.start_s..span.end_s, span.label.clone()));
    }
    tiers
}
