//! The words of scenes and searches.

use serde::Serialize;
use toml::{Table, Value};

use super::View;

/// What relations and other names begin with.
const KEYWORDS: [&str; 4] = ["as", "overlap", "before", "within"];

/// `/api/vocabulary`.
#[derive(Debug, Serialize)]
pub(super) struct Vocabulary<'v> {
    features: Vec<FeatureName<'v>>,
    keywords: [&'static str; 4],
    templates: Vec<TemplateName<'v>>,
}

#[derive(Debug, Serialize)]
struct FeatureName<'v> {
    name: &'v str,
    /// `F1` is 1.
    number: usize,
    part: &'v str,
    description: String,
}

#[derive(Debug, Serialize)]
struct TemplateName<'v> {
    name: &'v str,
    tau: Option<f64>,
}

impl Vocabulary<'_> {
    pub(super) fn new(view: &View) -> Vocabulary<'_> {
        let features = &view.library.features;
        // The set was read from this text when the library was opened.
        let text: Table = features.text.parse().unwrap_or_default();
        let described = text.get("feature").and_then(Value::as_array);
        let described = described.map_or(&[][..], Vec::as_slice);
        let templates = view.templates.iter();
        Vocabulary {
            features: (1..)
                .zip(features.set.features())
                .map(|(number, feature)| FeatureName {
                    name: &feature.name,
                    number,
                    part: &feature.set,
                    description: described.get(number - 1).map_or_else(String::new, describe),
                })
                .collect(),
            keywords: KEYWORDS,
            templates: templates
                .map(|template| TemplateName {
                    name: &template.name,
                    tau: template.tau,
                })
                .collect(),
        }
    }
}

/// What a feature measures, and when it is 1, in the words of its file.
fn describe(feature: &Value) -> String {
    let text = |name: &str| feature.get(name).map(plain).unwrap_or_default();
    let (measured, enter, stay) = (text("quantity"), text("enter"), text("stay"));
    if enter == stay {
        return format!("{measured}: 1 while {enter}");
    }
    format!("{measured}: 1 once {enter}, as long as {stay}")
}

/// A value without brackets: its kind first, then its other parts.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(plain).collect::<Vec<_>>().join(" "),
        Value::Table(table) => {
            let kind = table.get("kind").map(plain);
            let others = table.iter().filter(|(name, _)| *name != "kind");
            let others =
                others.map(|(name, value)| format!("{} {}", name.replace('_', " "), plain(value)));
            kind.into_iter()
                .chain(others)
                .collect::<Vec<_>>()
                .join(", ")
        }
        other => other.to_string(),
    }
}
