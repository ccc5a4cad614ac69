//! Relations as inequalities between edges of runs.
//!
//! The hits of a progression in one document can be counted so that every edge of every run grows with the number:
//! the runs of a set are disjoint, and each run of a hit decides the next one. So an inequality `left ≤ right`
//! between edges of two lines gives, for each hit of the left line, the first hit of the right line that satisfies it,
//! and this number grows with that of the left hit. The join rests on this.

use std::ops::Range;

use super::{Progression, Relation, RunRef, Scene};

/// An end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Start,
    End,
}

/// An edge of a run of one line, moved by some frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Edge {
    pub(super) line: usize,
    run: usize,
    side: Side,
    shift: i64,
}

impl Edge {
    fn start(line: usize, run: usize) -> Edge {
        let side = Side::Start;
        Edge {
            line,
            run,
            side,
            shift: 0,
        }
    }

    fn end(line: usize, run: usize) -> Edge {
        let side = Side::End;
        Edge {
            side,
            ..Edge::start(line, run)
        }
    }

    fn plus(self, frames: i64) -> Edge {
        let shift = self.shift + frames;
        Edge { shift, ..self }
    }

    /// Where it lies, given the runs of a hit of its line.
    pub(super) fn of(&self, runs: &[Range<usize>]) -> i64 {
        let run = &runs[self.run];
        let frame = match self.side {
            Side::Start => run.start,
            Side::End => run.end,
        };
        frame as i64 + self.shift
    }
}

/// Where a line's own part of a hit lies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) start: Edge,
    pub(super) end: Edge,
}

impl Extent {
    /// The core of spec j.3. A line of one run has no frame in which it is entered or left; its core is the run.
    pub(super) fn core(line: usize, progression: &Progression) -> Extent {
        let runs = progression.specified();
        let (first, last) = (runs.start, runs.end - 1);
        if first == last {
            let (start, end) = (Edge::start(line, first), Edge::end(line, last));
            return Extent { start, end };
        }
        Extent {
            start: Edge::end(line, first).plus(-1),
            end: Edge::start(line, last).plus(1),
        }
    }

    fn hull(line: usize, progression: &Progression) -> Extent {
        Extent {
            start: Edge::start(line, 0),
            end: Edge::end(line, progression.n_runs() - 1),
        }
    }

    fn meets(self, other: Extent) -> [Bound; 2] {
        [
            Bound::new(self.start.plus(1), other.end),
            Bound::new(other.start.plus(1), self.end),
        ]
    }
}

/// The inequality `left ≤ right`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Bound {
    pub(super) left: Edge,
    pub(super) right: Edge,
}

impl Bound {
    fn new(left: Edge, right: Edge) -> Bound {
        Bound { left, right }
    }
}

/// Everything a scene asks of the edges of its runs.
pub(super) fn bounds(scene: &Scene) -> Vec<Bound> {
    let mut bounds = Vec::new();
    for relation in scene.relations() {
        let [a, b] = relation.runs().map(|run| extent(scene, run));
        match *relation {
            Relation::Overlap(..) => bounds.extend(a.meets(b)),
            Relation::Before(..) => bounds.push(Bound::new(a.end, b.start)),
            Relation::Within(gap, ..) => {
                let gap = frames(gap);
                bounds.push(Bound::new(b.start, a.end.plus(gap)));
                bounds.push(Bound::new(a.start, b.end.plus(gap)));
            }
        }
    }
    let component = scene.components();
    for (a, one) in scene.lines().iter().enumerate() {
        for (b, other) in scene.lines().iter().enumerate() {
            let core = Extent::core(a, one);
            if let Some(max) = scene.max_frames() {
                let end = Extent::core(b, other).end;
                bounds.push(Bound::new(end, core.start.plus(frames(max))));
            }
            if component[a] != component[b] {
                // Cores are never empty, so hulls that cores meet have a frame in common.
                bounds.extend(core.meets(Extent::hull(b, other)));
            }
        }
    }
    bounds
}

fn extent(scene: &Scene, RunRef { line, position }: RunRef) -> Extent {
    // `Scene::new` has checked the position.
    let run = scene.lines()[line].run_of(position).unwrap_or(0);
    Extent {
        start: Edge::start(line, run),
        end: Edge::end(line, run),
    }
}

/// A number of frames; no document is longer than 2³² of them, so that larger numbers need not be told apart.
fn frames(n: usize) -> i64 {
    n.min(u32::MAX as usize) as i64
}
