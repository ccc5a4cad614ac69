//! Scene descriptions: several progressions at once, and how their runs lie to each other in time.

mod bound;
mod join;
mod progression;
mod search;

use std::ops::Range;

pub use self::progression::Progression;
pub use self::search::search_scene;
use crate::DocId;

/// One run of a scene: a position of one of its lines, both 0-based.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RunRef {
    /// Number of the line.
    pub line: usize,
    /// Number of the position as given to [`Progression::new`]. Positions that were conjoined have one run.
    pub position: usize,
}

/// How two runs lie to each other. Both may belong to one line.
///
/// A run is written [start, end) in frames of its document. The run of an unspecified position may be empty, at the
/// edge of the document; it overlaps nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Relation {
    /// The runs share a frame: a.start < b.end and b.start < a.end.
    Overlap(RunRef, RunRef),
    /// The first one has ended when the second one begins: a.end ≤ b.start. Runs that touch are one before the other.
    Before(RunRef, RunRef),
    /// At most this many frames lie between the runs; none do if they overlap or touch.
    Within(usize, RunRef, RunRef),
}

impl Relation {
    /// The two runs, in order.
    pub fn runs(&self) -> [RunRef; 2] {
        match *self {
            Relation::Overlap(a, b) | Relation::Before(a, b) | Relation::Within(_, a, b) => [a, b],
        }
    }
}

/// Why progressions and relations are no scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Nothing is asked for.
    #[error("expected at least one line, found none")]
    NoLines,
    /// A progression without a set.
    #[error("expected a set in the progression, found {found} unspecified positions alone")]
    Unspecified {
        /// Positions of the progression.
        found: usize,
    },
    /// An unspecified position with sets on both sides.
    #[error("expected a set at position {position}, found an unspecified one between sets")]
    Gap {
        /// The position, 0-based.
        position: usize,
    },
    /// A relation to a line that does not exist.
    #[error("relation {relation}: expected a line below {n_lines}, found {found}")]
    Line {
        /// The relation, 0-based.
        relation: usize,
        /// Number of lines.
        n_lines: usize,
        /// The line it refers to.
        found: usize,
    },
    /// A relation to a position that does not exist.
    #[error(
        "relation {relation}: expected a position below {n_positions} of line {line}, found {found}"
    )]
    Position {
        /// The relation, 0-based.
        relation: usize,
        /// The line it refers to, 0-based.
        line: usize,
        /// Number of positions of that line.
        n_positions: usize,
        /// The position it refers to.
        found: usize,
    },
}

/// What to look for: a [`Progression`] per line, relations between runs of them, and the longest a hit may last.
///
/// Source: 2005 paper, section 6.3, which says that progressions are queried separately and their hits intersected
/// "to account for cooccurrence conditions"; the rest is decided here and in spec j.3.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Scene {
    lines: Vec<Progression>,
    relations: Vec<Relation>,
    max_frames: Option<usize>,
}

impl Scene {
    /// A scene of any duration.
    ///
    /// # Errors
    ///
    /// [`SceneError`] if there is no line, or a relation refers to a line or a position that does not exist.
    pub fn new(lines: Vec<Progression>, relations: Vec<Relation>) -> Result<Scene, SceneError> {
        let n_lines = lines.len();
        if n_lines == 0 {
            return Err(SceneError::NoLines);
        }
        for (relation, runs) in relations.iter().map(Relation::runs).enumerate() {
            for RunRef { line, position } in runs {
                let Some(progression) = lines.get(line) else {
                    let found = line;
                    return Err(SceneError::Line {
                        relation,
                        n_lines,
                        found,
                    });
                };
                let n_positions = progression.n_positions();
                if position >= n_positions {
                    let found = position;
                    return Err(SceneError::Position {
                        relation,
                        line,
                        n_positions,
                        found,
                    });
                }
            }
        }
        Ok(Scene {
            lines,
            relations,
            max_frames: None,
        })
    }

    /// The same, with hits of at most `n_frames` frames.
    #[must_use]
    pub fn within(self, n_frames: usize) -> Scene {
        let max_frames = Some(self.max_frames.map_or(n_frames, |max| max.min(n_frames)));
        Scene { max_frames, ..self }
    }

    /// The lines in order.
    pub fn lines(&self) -> &[Progression] {
        &self.lines
    }

    /// The relations in order.
    pub fn relations(&self) -> &[Relation] {
        &self.relations
    }

    /// The longest span of a hit in frames, if it is limited.
    pub fn max_frames(&self) -> Option<usize> {
        self.max_frames
    }

    /// Per line the first line that a chain of relations connects it with, itself included.
    pub(crate) fn components(&self) -> Vec<usize> {
        let mut first: Vec<usize> = (0..self.lines.len()).collect();
        for relation in &self.relations {
            let [a, b] = relation.runs().map(|run| first[run.line]);
            let (kept, gone) = (a.min(b), a.max(b));
            for component in &mut first {
                if *component == gone {
                    *component = kept;
                }
            }
        }
        first
    }
}

/// One place that matches a scene.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct SceneHit {
    /// The document the hit lies in.
    pub doc: DocId,
    /// The smallest interval that contains the core of every line, in frames of the document.
    pub span: Range<usize>,
    /// Per line its core: from the last frame of its first run to the first frame of its last one, the run itself if
    /// there is one alone. Unspecified positions do not count.
    pub cores: Vec<Range<usize>>,
    /// Per line and position the frames that match it. Unspecified positions reach to the edge of the document;
    /// positions that were conjoined have the same frames.
    pub lines: Vec<Vec<Range<usize>>>,
}

impl SceneHit {
    /// Frames of the span: what hits are ranked by.
    pub fn cost(&self) -> u64 {
        self.span.len() as u64
    }
}

#[cfg(test)]
mod tests;
