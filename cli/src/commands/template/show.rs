//! `motif template show`.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::PathBuf;

use mtemplate::{Cell, ClassTemplate, QuantizedTemplate};
use serde::Serialize;

use super::DELTA;
use crate::args::ShowArgs;
use crate::failure::{Exit, Failure};
use crate::output::{Outcome, Voice, count};
use crate::picture::template::template_heatmap;
use crate::targets;
use crate::templates;

/// A template as JSON.
#[derive(Clone, Debug, Serialize)]
pub(super) struct TemplateJson {
    /// Name of the class.
    pub name: String,
    /// Name of its feature set.
    pub feature_set: String,
    /// Words per second.
    pub rate: f64,
    /// Number of columns.
    pub columns: usize,
    /// Its length: the sum of the weights over the rate.
    pub seconds: f64,
    /// Motions that it was learned from.
    pub n_motions: Option<usize>,
    /// Its threshold.
    pub tau: Option<f64>,
    /// A weight for each column.
    pub weights: Vec<f64>,
    /// The rows.
    pub features: Vec<RowJson>,
    /// The keyframes.
    pub keyframes: Vec<KeyframeJson>,
    /// The picture that was written.
    pub picture: Option<String>,
}

/// A row of a template as JSON.
#[derive(Clone, Debug, Serialize)]
pub(super) struct RowJson {
    /// The feature.
    pub name: String,
    /// Shares of motions; 0.5 where it does not matter.
    pub values: Vec<f64>,
    /// A character for each column, quantised at 0.1: 0, 1, or * for what does not matter.
    pub cells: String,
}

/// A keyframe as JSON.
#[derive(Clone, Debug, Serialize)]
pub(super) struct KeyframeJson {
    /// Its column.
    pub column: usize,
    /// Its stiffness.
    pub stiffness: f64,
    /// What it asks for.
    pub features: BTreeMap<String, u8>,
}

/// Shows a template.
pub(super) fn run(args: &ShowArgs, voice: Voice) -> Result<Exit, Failure> {
    let is_png = |path: &&PathBuf| {
        path.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("png"))
    };
    if let Some(path) = args.output.as_ref().filter(|path| !is_png(path)) {
        let message = format!("{}: expected a picture, .png", path.display());
        return Err(Failure::Usage(message));
    }
    let class = templates::load(&args.file)?;
    let quantized = class.template.quantize(DELTA);
    let quantized = quantized.map_err(|e| Failure::input(&args.file, e))?;
    if let Some(path) = &args.output {
        let picture = template_heatmap(&class.features, class.template.values(), class.rate);
        let png = picture.to_png();
        let png = png.map_err(|e| Failure::io(path, io::Error::other(e)))?;
        targets::write(path, &png)?;
    }
    let picture = args.output.as_ref().map(|path| path.display().to_string());
    let outcome = Outcome {
        result: to_json(&class, &quantized, picture),
        skipped: Vec::new(),
        found: true,
    };
    voice.report("template", &outcome, |out| {
        draw(out, &outcome.result, voice)
    })
}

fn to_json(
    class: &ClassTemplate,
    quantized: &QuantizedTemplate,
    picture: Option<String>,
) -> TemplateJson {
    let cell = |column, feature| match quantized.cell(column, feature) {
        Some(Cell::Zero) => '0',
        Some(Cell::One) => '1',
        _ => '*',
    };
    let row = |feature: usize| RowJson {
        name: class.features[feature].clone(),
        values: class.template.values().column(feature).to_vec(),
        cells: (0..quantized.n_columns())
            .map(|column| cell(column, feature))
            .collect(),
    };
    let keyframes = class.keyframes.iter().map(|one| {
        let asked = class.features.iter().enumerate();
        let asked = asked.filter(|(bit, _)| one.care >> bit & 1 == 1);
        KeyframeJson {
            column: one.column,
            stiffness: one.stiffness,
            features: asked
                .map(|(bit, name)| (name.clone(), u8::from(one.value >> bit & 1 == 1)))
                .collect(),
        }
    });
    TemplateJson {
        name: class.name.clone(),
        feature_set: class.feature_set.clone(),
        rate: class.rate,
        columns: class.template.n_columns(),
        seconds: class.template.weights().sum() / class.rate,
        n_motions: class.n_motions,
        tau: class.tau,
        weights: class.template.weights().to_vec(),
        features: (0..class.features.len()).map(row).collect(),
        keyframes: keyframes.collect(),
        picture,
    }
}

/// Characters of a row, at most; longer templates have several columns in one.
const WIDTH: usize = 100;

/// Features that matter nowhere are listed up to this many, without `--verbose`.
const LISTED: usize = 5;

/// The template as text.
fn draw(out: &mut dyn Write, class: &TemplateJson, voice: Voice) -> io::Result<()> {
    let (columns, seconds) = (count(class.columns, "column"), class.seconds);
    write!(out, "{}: {columns}, {seconds:.2} s of ", class.name)?;
    write!(
        out,
        "{} at {} words per second",
        class.feature_set, class.rate
    )?;
    if let Some(n) = class.n_motions {
        write!(out, ", from {}", count(n, "motion"))?;
    }
    if let Some(tau) = class.tau {
        write!(out, ", tau {tau}")?;
    }
    writeln!(out)?;
    let per_character = class.columns.div_ceil(WIDTH).max(1);
    write!(out, "# on, . off, blank: does not matter")?;
    if per_character > 1 {
        write!(
            out,
            "; a character is {per_character} columns, + if they differ"
        )?;
    }
    writeln!(out)?;
    let matters = |row: &&RowJson| row.cells.contains(['0', '1']);
    let width = class.features.iter().map(|row| row.name.chars().count());
    let width = width.max().unwrap_or(0);
    for (number, row) in (1..).zip(&class.features) {
        if matters(&row) {
            let number = format!("F{number}");
            let cells = characters(&row.cells, per_character);
            writeln!(out, "{number:>3} {:width$} |{cells}|", row.name)?;
        }
    }
    if class.columns > 0 {
        let axis = seconds_axis(class, per_character);
        writeln!(out, "{:1$} |{axis}", "", width + 4)?;
    }
    let rest = class.features.iter().filter(|row| !matters(row));
    let rest: Vec<&str> = rest.map(|row| row.name.as_str()).collect();
    match rest.len() {
        0 => {}
        n if n > LISTED && !voice.verbose => writeln!(out, "{n} features matter nowhere")?,
        _ => writeln!(out, "matter nowhere: {}", rest.join(", "))?,
    }
    for one in &class.keyframes {
        let asked = one
            .features
            .iter()
            .map(|(name, bit)| format!("{name} = {bit}"));
        let asked: Vec<String> = asked.collect();
        let (column, stiffness) = (one.column, one.stiffness);
        writeln!(
            out,
            "keyframe {column}, stiffness {stiffness}: {}",
            asked.join(", ")
        )?;
    }
    match &class.picture {
        Some(picture) => writeln!(out, "{picture}"),
        None => Ok(()),
    }
}

/// A character for each `per_character` cells.
fn characters(cells: &str, per_character: usize) -> String {
    let drawn = cells.as_bytes().chunks(per_character).map(|group| {
        match (group[0], group.iter().all(|cell| *cell == group[0])) {
            (_, false) => '+',
            (b'0', _) => '.',
            (b'1', _) => '#',
            _ => ' ',
        }
    });
    drawn.collect()
}

/// The times at which every twentieth character begins.
fn seconds_axis(class: &TemplateJson, per_character: usize) -> String {
    const APART: usize = 20;
    let columns = (0..class.columns).step_by(APART * per_character);
    let times = columns.map(|column| {
        // Not a sum, which is -0 of nothing.
        let frames = class.weights[..column].iter().fold(0.0, |sum, w| sum + w);
        format!("{:<APART$}", format!("{:.2} s", frames / class.rate))
    });
    times.collect::<String>().trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_templates_are_drawn_in_groups() {
        assert_eq!(characters("0011**", 1), "..##  ");
        assert_eq!(characters("001*11*", 2), ".+# ");
    }
}
