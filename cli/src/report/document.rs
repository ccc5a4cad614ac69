//! What a page shows, as the JSON that `cli/web` reads.
//!
//! # Units and shapes
//! Frames are those of the source file, 0-based, end exclusive; seconds are frame divided by the
//! source's rate. Positions are millimetres, +Y up. Missing points are missing: see [`MISSING`].

use std::ops::Range;

use serde::Serialize;

mod path;

/// In place of each coordinate of a point that a frame lacks; no coordinate is this far from the origin.
pub const MISSING: i16 = i16::MIN;

/// A whole page, or in a live viewer an answer that is added to it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Document {
    /// Version of motif.
    pub motif: &'static str,
    /// What stands above everything.
    pub title: String,
    /// Whether clips can be asked for and searched, under `/api`.
    pub live: bool,
    /// Skeletons, named by their place.
    pub figures: Vec<Figure>,
    /// The clips that pages speak of.
    pub clips: Vec<Clip>,
    /// In order.
    pub pages: Vec<Page>,
}

/// A skeleton that is drawn.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Of its points.
    pub points: Vec<String>,
    /// What is drawn between points.
    pub bones: Vec<Bone>,
}

/// A bone of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bone {
    /// Point where it starts.
    pub from: usize,
    /// Point where it ends.
    pub to: usize,
    /// What colour it has.
    pub side: Side,
    /// Thickness in millimetres.
    pub width: u16,
}

/// Side of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs, reason = "the names are the documentation")]
pub enum Side {
    Left,
    Right,
    Middle,
}

/// A clip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Clip {
    /// What pages name it by; in a live viewer the place in the library.
    pub id: u32,
    /// Path as indexed or given, with its span.
    pub name: String,
    /// What it shows, if its folder says so.
    pub label: Option<String>,
    /// Frames per second of the source file.
    pub rate: f64,
    /// First source frame.
    pub start: usize,
    /// One past the last source frame.
    pub end: usize,
    /// The rig that placed the body points.
    pub rig: Option<String>,
    /// Place of its figure in [`Document::figures`].
    pub figure: usize,
    /// A few poses side by side; `None` for a motion that was made for a page, and on no contact sheet.
    pub strip: Option<Strip>,
    /// What is played; `None` in a live viewer, where it is asked for, and where a report has no room.
    pub motion: Option<Motion>,
}

/// A few poses side by side, evenly spread over the clip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Strip {
    /// Number of poses.
    pub poses: usize,
    /// Base64 of unsigned bytes, shape `(poses, points, 2)`: x from the left, y from the floor, in units of
    /// 10 mm; x is relative to the middle of its pose and has 128 added. 255 twice is a missing point.
    pub bytes: String,
}

/// Positions over time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Motion {
    /// Frames per second, the library's, or the source's if that is lower. Frame k shows source frame `start + round(k · source rate / rate)`.
    pub rate: f64,
    /// Number of frames.
    pub frames: usize,
    /// What is added to every position, in millimetres.
    pub origin: [i32; 3],
    /// Base64 of little-endian 16-bit integers, shape `(frames, points, 3)`, millimetres.
    pub bytes: String,
}

/// A part of the document with a tab of its own.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[allow(missing_docs, reason = "the names are the documentation")]
pub enum Page {
    Library(LibraryPage),
    Clip(ClipPage),
    Search(SearchPage),
    Annotation(AnnotationPage),
    Template(TemplatePage),
    Alignment(AlignmentPage),
    Bundles(BundlesPage),
}

/// All clips of a library.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LibraryPage {
    /// Its folder.
    pub path: String,
    /// Feature set.
    pub set: String,
    /// Words per second.
    pub rate: f64,
    /// Number of clips; in a live viewer the clips themselves are asked for.
    pub n_clips: usize,
    /// Their length together.
    pub seconds: f64,
    /// All labels, in order.
    pub labels: Vec<String>,
    /// Why a clip cannot be played in this report, if any cannot.
    pub note: Option<String>,
}

/// One clip with its features.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClipPage {
    /// Which clip.
    pub clip: u32,
    /// Its feature matrix.
    pub features: Option<Picture>,
}

/// The result of a search.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SearchPage {
    /// What the tab is called.
    pub title: String,
    /// What was asked, a fact a line.
    pub query: Vec<Fact>,
    /// The example, if there was one.
    pub example: Option<Place>,
    /// Number of hits, listed or not.
    pub n_hits: usize,
    /// The listed hits in order.
    pub hits: Vec<PageHit>,
}

/// A name and a value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fact {
    /// Such as `mode`.
    pub name: String,
    /// Such as `adaptive`.
    pub value: String,
}

/// Some frames of a clip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// Which clip.
    pub clip: u32,
    /// First source frame.
    pub start: usize,
    /// One past the last source frame.
    pub end: usize,
    /// `start` in seconds.
    pub start_s: f64,
    /// `end` in seconds.
    pub end_s: f64,
}

/// A hit of a search.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PageHit {
    /// Where.
    #[serde(flatten)]
    pub place: Place,
    /// From 1.
    pub rank: usize,
    /// As the search states it.
    pub cost: f64,
    /// Whether the left/right mirrored example was found.
    pub mirrored: bool,
    /// Source frames of each segment.
    pub segments: Vec<[usize; 2]>,
    /// Pairs of source frames of the hit and the example that are played at once; empty without an example.
    pub path: Vec<[usize; 2]>,
    /// Where it agrees with what was asked; in a live viewer it is asked for.
    pub agreement: Option<Picture>,
    /// What to ask for below `/api/`, in a live viewer, to get it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ask: Option<String>,
}

/// A clip with labelled spans.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AnnotationPage {
    /// Which clip.
    pub clip: u32,
    /// A row per label.
    pub tracks: Vec<Track>,
}

/// A label's spans in a clip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Track {
    /// The label.
    pub label: String,
    /// The threshold, if it is known.
    pub tau: Option<f64>,
    /// In order.
    pub spans: Vec<LabelledSpan>,
    /// The curve Δ with the threshold, the matches and where they are labelled.
    pub curve: Option<Picture>,
}

/// A labelled span.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LabelledSpan {
    /// Where.
    #[serde(flatten)]
    pub place: Place,
    /// What the match costs.
    pub cost: f64,
}

/// A motion template.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TemplatePage {
    /// Of the class.
    pub name: String,
    /// Feature set.
    pub set: String,
    /// Columns per second.
    pub rate: f64,
    /// The threshold learned with it.
    pub tau: Option<f64>,
    /// Motions that it was learned from.
    pub examples: Option<usize>,
    /// Values from 0 to 1.
    pub matrix: Picture,
}

/// Two clips and the path that warps one to the other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlignmentPage {
    /// The first clip.
    pub a: u32,
    /// The second one.
    pub b: u32,
    /// Cost, mean distance, cells and so on.
    pub facts: Vec<Fact>,
    /// Pairs of source frames, from both first ones to both last ones.
    pub path: Vec<[usize; 2]>,
    /// The distance along the path, over the first clip's seconds.
    pub cost: Option<Picture>,
    /// The same for each body point, a row each.
    pub points: Option<Picture>,
}

/// Motion bundles and their graph.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BundlesPage {
    /// Clusters, string length, share of frames in bundles and so on.
    pub facts: Vec<Fact>,
    /// The graph as SVG; each node is a `<g class="node" data-bundle="ID">`.
    pub svg: String,
    /// The bundles.
    pub nodes: Vec<BundleNode>,
    /// Walks through the graph.
    pub walks: Vec<PageWalk>,
}

/// A bundle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BundleNode {
    /// Such as `B3`.
    pub id: String,
    /// Submotions.
    pub height: usize,
    /// Mean length in source frames.
    pub mean_frames: f64,
    /// As the paper's eq. 3.
    pub volume: f64,
    /// Its submotions.
    pub spans: Vec<Place>,
    /// Bundles that can follow.
    pub next: Vec<String>,
}

/// A walk through the graph.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PageWalk {
    /// What it is called.
    pub title: String,
    /// The motion made by blending.
    pub clip: u32,
    /// Bundles along it and the seconds where each begins.
    pub path: Vec<WalkStep>,
}

/// A bundle of a walk.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WalkStep {
    /// Which bundle.
    pub bundle: String,
    /// Where it begins.
    pub start_s: f64,
}

/// A picture over time, with what it takes to read values off it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Picture {
    /// SVG text, or a `data:image/png` address.
    pub image: String,
    /// Pixels from left to right.
    pub width: u32,
    /// Pixels from top to bottom.
    pub height: u32,
    /// Where the data are: left, top, right, bottom, in pixels.
    pub area: [u32; 4],
    /// What the area's left and right edges stand for, in seconds from the beginning of the source file,
    /// or of the template.
    pub seconds: [f64; 2],
    /// What can be read off it.
    pub values: Values,
}

/// What can be read off a picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "of", rename_all = "lowercase")]
pub enum Values {
    /// A number per column, evenly spread over the area.
    Curve {
        /// `None` where there is none.
        y: Vec<Option<f32>>,
        /// What they are called, with their unit.
        name: String,
    },
    /// A code per cell, rows from the top.
    Cells {
        /// Of the rows.
        rows: Vec<String>,
        /// Number of columns.
        columns: usize,
        /// Base64 of unsigned bytes, shape `(rows, columns)`.
        codes: String,
        /// What each code means, by its number; empty where codes are numbers.
        meanings: Vec<String>,
        /// What a code is multiplied with; `None` where codes have meanings.
        unit: Option<f32>,
    },
}

impl Place {
    /// Frames of a clip whose source has `rate` frames per second.
    #[must_use]
    pub fn new(clip: u32, frames: Range<usize>, rate: f64) -> Place {
        Place {
            clip,
            start: frames.start,
            end: frames.end,
            start_s: frames.start as f64 / rate,
            end_s: frames.end as f64 / rate,
        }
    }
}
