//! Explained hits as a picture.

use std::path::Path;

use super::super::hits::{HitJson, SearchResult};
use crate::failure::Failure;
use crate::library::Library;
use crate::output::count;
use crate::picture::agreement::{Panel, Sheet, agreement_sheet};
use crate::selection::names;

/// Hits that a picture shows at most.
pub const MOST_PANELS: usize = 12;

/// Writes the picture of explained hits, [`MOST_PANELS`] at most.
///
/// # Errors
/// [`Failure::Io`].
pub(in super::super) fn write_picture(
    path: &Path,
    library: &Library,
    result: &SearchResult,
) -> Result<(), Failure> {
    let query = &result.query;
    let all = names(&library.features.set, library.features.set.all());
    let explained = result
        .hits
        .iter()
        .filter_map(|hit| Some((hit, hit.explained.as_ref()?)));
    let panels = explained.take(MOST_PANELS).map(|(hit, explained)| Panel {
        captions: captions(hit),
        segments: explained
            .agreement
            .stretches
            .iter()
            .map(|s| s.hit.clone())
            .collect(),
        rows: (0..all.len())
            .map(|bit| explained.agreement.cells(bit))
            .collect(),
    });
    let panels: Vec<Panel> = panels.collect();
    let hits = match (panels.len(), result.n_hits) {
        (shown, all) if shown < all => format!("the best {shown} of {}", count(all, "hit")),
        (_, all) => count(all, "hit"),
    };
    let (clip, start, end) = (tail(&query.clip), query.start, query.end);
    let title = format!("{clip} frames {start}-{end}: {hits}");
    let sheet = Sheet {
        title: &title,
        names: &all,
        panels: &panels,
        rate: library.rate,
    };
    let png = agreement_sheet(&sheet).to_png();
    let written = png
        .map_err(std::io::Error::other)
        .and_then(|png| std::fs::write(path, png));
    written.map_err(|e| Failure::io(path, e))
}

fn captions(hit: &HitJson) -> Vec<String> {
    let mut cost = format!("cost {}", hit.cost);
    if let Some(metres) = hit.dtw {
        cost += &format!(", dtw {metres:.3} m");
    }
    if hit.mirrored {
        cost += ", sides exchanged";
    }
    vec![
        format!("{}: {}", hit.rank, tail(&hit.clip)),
        format!(
            "frames {}-{}, {:.2}-{:.2} s",
            hit.start, hit.end, hit.start_s, hit.end_s
        ),
        cost,
    ]
}

/// A path's folder and name.
pub(super) fn tail(path: &str) -> String {
    let parts: Vec<&str> = path.rsplitn(3, ['/', '\\']).collect();
    parts
        .into_iter()
        .take(2)
        .rev()
        .collect::<Vec<_>>()
        .join("/")
}
