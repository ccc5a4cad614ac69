//! A [`Document`] as one HTML file that loads nothing: `cli/web`, inlined.
//!
//! Modules cannot be imported from `file://`, so the page's modules become one: in the order of `MODULES`, without
//! their imports and without `export`. That takes names that no two modules share, see the tests.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

use super::document::Document;

const INDEX: &str = include_str!("../../web/index.html");
const STYLE: &str = include_str!("../../web/style.css");

macro_rules! modules {
    ($($path:literal),* $(,)?) => {
        /// Path below `cli/web` and text of each module; none imports from one behind it.
        const MODULES: &[(&str, &str)] = &[$(($path, include_str!(concat!("../../web/", $path)))),*];
    };
}

modules![
    "store.js",
    "strip.js",
    "camera.js",
    "stage.js",
    "player.js",
    "plot.js",
    "timeline.js",
    "scene.js",
    "pages/clip.js",
    "pages/library.js",
    "pages/search.js",
    "pages/annotation.js",
    "pages/template.js",
    "pages/alignment.js",
    "pages/bundles.js",
    "live.js",
    "app.js",
];

/// The page as HTML.
#[must_use]
pub fn page(document: &Document) -> String {
    let script = script();
    let mut out = String::with_capacity(INDEX.len() + STYLE.len() + script.len());
    let mut rest = INDEX;
    while let Some((before, name, after)) = next_placeholder(rest) {
        out.push_str(before);
        match name {
            "CSP" => out.push_str(&content_security_policy(document.live)),
            "TITLE" => out.push_str(&escaped(&document.title)),
            "STYLE" => out.push_str(STYLE),
            "SCRIPT" => out.push_str(&script),
            "DOCUMENT" => out.push_str(&json(document)),
            _ => {}
        }
        rest = after;
    }
    out.push_str(rest);
    out
}

/// What the page may load and run: its own script and style, `data:` pictures, and, if it is `live`, answers of
/// where it comes from. For the page itself and for the header of an HTTP answer.
#[must_use]
pub fn content_security_policy(live: bool) -> String {
    let connect = if live { "; connect-src 'self'" } else { "" };
    format!(
        "default-src 'none'; script-src '{}'; style-src '{}'; img-src data:; base-uri 'none'; form-action 'none'{connect}",
        source_hash(&script()),
        source_hash(STYLE)
    )
}

/// All modules as one.
fn script() -> String {
    let mut script = String::new();
    for line in MODULES.iter().flat_map(|(_, text)| text.lines()) {
        if !line.starts_with("import ") {
            script.push_str(line.strip_prefix("export ").unwrap_or(line));
            script.push('\n');
        }
    }
    script
}

/// The document as JSON in which nothing looks like a tag.
fn json(document: &Document) -> String {
    // Its fields are plain data, and its maps have strings for keys: there is nothing that JSON cannot say.
    let json = serde_json::to_string(document).unwrap_or_default();
    // In JSON, < stands in strings alone.
    json.replace('<', "\\u003c")
}

/// What stands before the next `<!--NAME-->`, its name, and what follows it.
fn next_placeholder(text: &str) -> Option<(&str, &str, &str)> {
    let (before, rest) = text.split_once("<!--")?;
    let (name, after) = rest.split_once("-->")?;
    Some((before, name, after))
}

fn source_hash(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text)))
}

/// Text for the inside of an element or of a quoted attribute.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests;
