//! The page of a clip.

use super::View;
use super::answer::Refusal;
use super::fragment::fragment;
use crate::report::document::{ClipPage, Document, Page};

/// `/api/clips/ID`.
pub(super) fn answer(view: &View, id: u32) -> Result<Document, Refusal> {
    // Says why, where the file cannot be drawn.
    view.clips.sketch(id)?;
    let page = ClipPage {
        clip: id,
        features: None,
    };
    fragment(view, &[id], vec![Page::Clip(page)])
}
