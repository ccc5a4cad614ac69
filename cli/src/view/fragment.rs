//! Answers that a page is added to: clips, their figures, pages.

use std::collections::BTreeSet;

use rayon::prelude::*;
use serde::Serialize;

use super::View;
use super::answer::Refusal;
use crate::report::document::{Clip, Document, Figure, Page};

/// Some of the clips that were asked for.
#[derive(Debug, Serialize)]
pub(super) struct Listing {
    /// How many there are.
    total: usize,
    figures: Vec<Figure>,
    clips: Vec<Clip>,
    pages: Vec<Page>,
}

impl Listing {
    pub(super) fn new(view: &View, total: usize, ids: &[u32]) -> Result<Listing, Refusal> {
        let (figures, clips) = gather(view, ids)?;
        Ok(Listing {
            total,
            figures,
            clips,
            pages: Vec::new(),
        })
    }
}

/// Pages with the clips that they speak of, each with its strip where that can be drawn.
pub(super) fn fragment(view: &View, ids: &[u32], pages: Vec<Page>) -> Result<Document, Refusal> {
    let (figures, clips) = gather(view, ids)?;
    Ok(Document {
        motif: env!("CARGO_PKG_VERSION"),
        title: view.title(),
        live: true,
        figures,
        clips,
        pages,
    })
}

/// The clips of `ids`, each once, in the order they are first named, and the figures they have.
fn gather(view: &View, ids: &[u32]) -> Result<(Vec<Figure>, Vec<Clip>), Refusal> {
    let mut seen = BTreeSet::new();
    let ids = ids.iter().copied().filter(|id| seen.insert(*id));
    let ids: Vec<u32> = ids.collect();
    let sketches = ids.par_iter().with_max_len(1).map(|&id| {
        // A clip that cannot be drawn is listed all the same; who wants to see it hears why.
        let sketch = view.clips.sketch(id);
        let sketch = sketch.map(|sketch| (sketch.clip.clone(), sketch.figure.clone()));
        sketch.or_else(|_| view.clips.bare(id).map(|bare| (bare.clip, bare.figure)))
    });
    let sketches: Vec<Result<(Clip, Figure), Refusal>> = sketches.collect();
    let mut figures: Vec<Figure> = Vec::new();
    let mut clips = Vec::new();
    for sketch in sketches {
        let (clip, figure) = sketch?;
        let known = figures.iter().position(|one| *one == figure);
        let place = known.unwrap_or(figures.len());
        if known.is_none() {
            figures.push(figure);
        }
        clips.push(Clip {
            figure: place,
            ..clip
        });
    }
    Ok((figures, clips))
}
