//! Scene descriptions as text (design.md §4): what a motion goes through, feature by feature.
//!
//! ```text
//! # right foot kick followed by a left hand punch
//! rfoot_raised : 0 1 0
//! rknee_bent   : 0 1 0 1 0
//! lelbow_bent as punch : * 1 0 1
//! overlap rfoot_raised[2] rknee_bent[3]
//! before  rfoot_raised[2] punch[3]
//! within 2s rfoot_raised[2] punch[3]
//! within 5s
//! ```
//!
//! # Syntax
//! One statement per line, or several with `;` between them; `#` begins a comment that the line ends. Words are
//! apart by blanks; `:`, `[` and `]` need none. Statements may stand in any order.
//!
//! - `FEATURE : VALUES` is a *line*: a feature by name or number (`F20`), and what it goes through: `0` off, `1` on,
//!   `*` unspecified. `FEATURE as NAME : VALUES` gives the line a name of its own, which it needs if another line
//!   has the same feature.
//! - `overlap A[i] B[j]`: run i of line A and run j of line B share a frame. Positions count from 1, `*` included.
//! - `before A[i] B[j]`: the run of A has ended when that of B begins; they may touch.
//! - `within 1.5s A[i] B[j]`: at most so much time lies between the two runs; none does if they overlap or touch.
//!   Times are in `s` or `ms`.
//! - `within 5s`: the whole hit takes at most so long.
//!
//! # Meaning
//! A line alone is an adaptive query on its feature; a run is as long as the feature keeps its value. The same value
//! twice in a row is one run, to which both positions refer (spec j.1, conjoining). `*` may only stand at the ends
//! of a line and is everything the document has there, maybe nothing: conjoining would make one run of the whole line
//! of it, which is why it cannot stand between values. A hit has one hit of each line, in one document, that satisfy
//! all relations; lines that no chain of relations connects overlap. See [`segidx::search_scene`] for overlap, span and
//! ranking.
//!
//! # Source
//! Müller, Röder, Clausen 2005, section 6.3 and figure 10.

mod error;
mod parse;
#[cfg(test)]
mod tests;
mod tokens;

use mocap_io::Position;
use segidx::{FuzzySet, Mask, Progression, RunRef, Scene, SceneError};

pub use error::{SceneTextError, SceneTextErrorKind};
pub use parse::parse;

/// A scene description that was understood.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneText {
    /// What each feature goes through.
    pub lines: Vec<Line>,
    /// How runs lie to each other.
    pub relations: Vec<Relation>,
    /// The longest that a hit may take, in seconds.
    pub max_seconds: Option<f64>,
    /// What is odd, and how it was read.
    pub notes: Vec<(Position, String)>,
}

/// A feature and its progression.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What relations call it: its own name, or that of the feature as it was written.
    pub name: String,
    /// The feature, as its bit in the words.
    pub feature_idx: usize,
    /// Off, on or unspecified.
    pub values: Vec<Option<bool>>,
}

impl Line {
    /// The values as they are written.
    #[must_use]
    pub fn progression(&self) -> String {
        let value = |value: &Option<bool>| match value {
            Some(false) => "0",
            Some(true) => "1",
            None => "*",
        };
        self.values.iter().map(value).collect::<Vec<_>>().join(" ")
    }
}

/// A relation between two runs, as 0-based line and position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relation {
    /// Which one.
    pub kind: RelationKind,
    /// The first run.
    pub a: RunRef,
    /// The second run.
    pub b: RunRef,
}

/// The relations of the language.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RelationKind {
    /// The runs share a frame.
    Overlap,
    /// The first has ended when the second begins.
    Before,
    /// At most so many seconds lie between them.
    Within(f64),
}

/// What a duration may lack of a whole number of frames and still count as that number: decimals such as 0.7 s are
/// not exact in binary, a hundred-thousandth of a frame is nothing.
const FRAME_SLACK: f64 = 1e-5;

impl SceneText {
    /// The scene as a query for words at `rate` per second. A duration is as many frames as fit into it.
    ///
    /// # Errors
    /// None for what [`parse`] gives.
    pub fn query(&self, rate: f64) -> Result<Scene, SceneError> {
        // The cast saturates.
        let frames = |seconds: f64| (seconds * rate + FRAME_SLACK).floor() as usize;
        let lines: Result<Vec<Progression>, SceneError> = self
            .lines
            .iter()
            .map(|line| {
                let bit = 1 << line.feature_idx;
                let set = |on: bool| FuzzySet::from(Mask::new(bit, if on { bit } else { 0 }));
                Progression::new(line.values.iter().map(|value| value.map(set)))
            })
            .collect();
        let relation = |r: &Relation| match r.kind {
            RelationKind::Overlap => segidx::Relation::Overlap(r.a, r.b),
            RelationKind::Before => segidx::Relation::Before(r.a, r.b),
            RelationKind::Within(seconds) => segidx::Relation::Within(frames(seconds), r.a, r.b),
        };
        let scene = Scene::new(lines?, self.relations.iter().map(relation).collect())?;
        Ok(match self.max_seconds {
            Some(seconds) => scene.within(frames(seconds)),
            None => scene,
        })
    }

    /// The bits of all features of the scene.
    #[must_use]
    pub fn care(&self) -> u64 {
        let bits = self.lines.iter().map(|line| 1 << line.feature_idx);
        bits.fold(0, |care, bit| care | bit)
    }
}
