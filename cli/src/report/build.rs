//! Puts a document together: each clip and each skeleton once.

use std::collections::BTreeMap;

use super::clip::Drawn;
use super::document::{Clip, Document, Figure, Page};

/// A document in the making.
#[derive(Debug)]
pub struct Builder {
    document: Document,
    ids: BTreeMap<String, u32>,
    /// Bytes of motion that may still be put in.
    room: usize,
    /// Clips that there was no room for.
    without_motion: usize,
}

impl Builder {
    /// `budget` is the most bytes of motion.
    #[must_use]
    pub fn new(title: String, budget: usize) -> Builder {
        Builder {
            document: Document {
                motif: env!("CARGO_PKG_VERSION"),
                title,
                ..Document::default()
            },
            ids: BTreeMap::new(),
            room: budget,
            without_motion: 0,
        }
    }

    /// The number of a clip that is there.
    #[must_use]
    pub fn id(&self, name: &str) -> Option<u32> {
        self.ids.get(name).copied()
    }

    /// A clip by its number.
    #[must_use]
    pub fn clip(&self, id: u32) -> Option<&Clip> {
        self.document.clips.get(id as usize)
    }

    /// Adds a clip, with its motion if there is room, and gives its number; one of the same name stays as it is.
    pub fn add(&mut self, drawn: &Drawn) -> u32 {
        if let Some(id) = self.id(&drawn.name) {
            return id;
        }
        let id = u32::try_from(self.document.clips.len()).unwrap_or(u32::MAX);
        let figure = self.figure(&drawn.figure);
        let mut clip = drawn.to_clip(id, figure, None);
        let needed = drawn.motion_bytes();
        if needed <= self.room {
            self.room -= needed;
            clip.motion = Some(drawn.motion());
        } else {
            self.without_motion += 1;
        }
        self.document.clips.push(clip);
        self.ids.insert(drawn.name.clone(), id);
        id
    }

    /// As [`add`](Self::add), for a motion that is in no file, and so on no contact sheet.
    pub fn add_made(&mut self, drawn: &Drawn) -> u32 {
        let id = self.add(drawn);
        if let Some(clip) = self.document.clips.get_mut(id as usize) {
            clip.strip = None;
        }
        id
    }

    /// Says what a clip shows.
    pub fn label(&mut self, id: u32, label: String) {
        if let Some(clip) = self.document.clips.get_mut(id as usize) {
            clip.label = Some(label);
        }
    }

    /// Clips that there was no room for so far.
    #[must_use]
    pub fn without_motion(&self) -> usize {
        self.without_motion
    }

    fn figure(&mut self, figure: &Figure) -> usize {
        let figures = &mut self.document.figures;
        let known = figures.iter().position(|known| known == figure);
        known.unwrap_or_else(|| {
            figures.push(figure.clone());
            figures.len() - 1
        })
    }

    /// The document with these pages.
    #[must_use]
    pub fn finish(self, pages: Vec<Page>) -> Document {
        Document {
            pages,
            ..self.document
        }
    }
}
