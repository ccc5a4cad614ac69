//! The page of a clip.

use super::View;
use super::answer::Refusal;
use super::fragment::fragment;
use crate::report::document::{ClipPage, Document, Page};
use crate::report::pictures;

/// `/api/clips/ID`.
pub(super) fn answer(view: &View, id: u32) -> Result<Document, Refusal> {
    // Says why, where the file cannot be drawn.
    view.clips.sketch(id)?;
    let (library, clip) = (&view.library, &view.clips.row(id)?.clip);
    let from = clip.meta.first_word as f64 / library.rate;
    let words = library.words(clip.id)?;
    let page = ClipPage {
        clip: id,
        features: pictures::features(&library.features.set, &words, library.rate, from),
    };
    fragment(view, &[id], vec![Page::Clip(page)])
}
