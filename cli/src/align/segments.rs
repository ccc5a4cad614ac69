//! The coarse stage: segments in pieces, their alignment, and the band around an alignment.

use std::ops::Range;

use segidx::segment;

use super::Poses;

/// The columns of each row of a matrix that are computed, half open.
pub type Rows = Vec<Range<usize>>;

/// Cuts a clip where its words change, and segments longer than `max_piece` into even pieces.
///
/// Only every `stride`-th word is looked at, the first of all included, so that no cut is nearer to the
/// next than `stride` frames. The pieces tile `0..words.len()` in order.
#[must_use]
pub fn pieces(words: &[u64], stride: usize, max_piece: usize) -> Vec<Range<usize>> {
    let sampled: Vec<u64> = words.iter().copied().step_by(stride.max(1)).collect();
    let cut = |span: Range<usize>| {
        let start = span.start * stride;
        let len = (span.end * stride).min(words.len()) - start;
        let n = len.div_ceil(max_piece.max(1));
        (0..n).map(move |k| start + len * k / n..start + len * (k + 1) / n)
    };
    segment(&sampled)
        .iter()
        .flat_map(|s| cut(s.span()))
        .collect()
}

/// A clip in pieces, each with its mean pose.
#[derive(Clone, Debug)]
pub struct Level<'a> {
    clip: &'a Poses,
    spans: Vec<Range<usize>>,
    pub(super) poses: Poses,
}

impl<'a> Level<'a> {
    /// The clip cut into `spans`, which tile it in order.
    #[must_use]
    pub fn new(clip: &'a Poses, spans: Vec<Range<usize>>) -> Level<'a> {
        let poses = clip.means(&spans);
        Level { clip, spans, poses }
    }

    /// The clip cut every `stride` frames.
    #[must_use]
    pub fn even(clip: &'a Poses, stride: usize) -> Level<'a> {
        let n = clip.n_frames();
        let spans = (0..n)
            .step_by(stride)
            .map(|start| start..(start + stride).min(n));
        Level::new(clip, spans.collect())
    }

    /// The pieces joined two by two.
    #[must_use]
    pub fn joined(&self) -> Level<'a> {
        let join = |pair: &[Range<usize>]| pair[0].start..pair[pair.len() - 1].end;
        Level::new(self.clip, self.spans.chunks(2).map(join).collect())
    }

    /// Number of pieces.
    #[must_use]
    pub fn len(&self) -> usize {
        self.spans.len()
    }

    /// Whether the clip has no frame.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.spans.is_empty()
    }

    /// Frames of each piece.
    #[must_use]
    pub fn lengths(&self) -> Vec<usize> {
        self.spans.iter().map(Range::len).collect()
    }

    /// The pieces that share a frame with `span`.
    fn pieces_in(&self, span: &Range<usize>) -> Range<usize> {
        let start = self.spans.partition_point(|piece| piece.end <= span.start);
        start..self.spans.partition_point(|piece| piece.start < span.end)
    }
}

/// The cheapest way through the cells of `rows` from the first pieces of both clips to the last, each
/// step to the next piece of one clip or of both.
///
/// A step costs the distance of the pieces that it reaches times the frames that it takes to play them:
/// those of the longer one if both are new, else those of the new one. That is what DTW over frames
/// would pay if all frames of a piece were alike. On a tie a step of both comes before one of
/// the first clip, and that before one of the second. `None` if no way is inside `rows`.
///
/// O(cells) in time, a byte per cell.
#[must_use]
pub fn align_pieces(
    lengths_a: &[usize],
    lengths_b: &[usize],
    rows: &[Range<usize>],
    distance: impl Fn(usize, usize) -> f64,
) -> Option<Vec<(usize, usize)>> {
    let mut above = Costs::default();
    let mut came: Vec<Vec<Step>> = Vec::with_capacity(rows.len());
    for (i, (row, &len_a)) in rows.iter().zip(lengths_a).enumerate() {
        let mut current = Costs::before(row.start);
        let mut steps = Vec::with_capacity(row.len());
        for j in row.clone() {
            let (len_a, len_b) = (len_a as f64, lengths_b[j] as f64);
            let diagonal = if (i, j) == (0, 0) {
                0.0
            } else {
                above.left_of(j)
            };
            let d = distance(i, j);
            let mut best = (diagonal + d * len_a.max(len_b), Step::Both);
            let first = (above.left_of(j + 1) + d * len_a, Step::First);
            let second = (current.left_of(j) + d * len_b, Step::Second);
            for other in [first, second] {
                if other.0 < best.0 {
                    best = other;
                }
            }
            current.costs.push(best.0);
            steps.push(best.1);
        }
        came.push(steps);
        above = current;
    }
    let is_reached = rows.len() == lengths_a.len() && above.left_of(lengths_b.len()).is_finite();
    is_reached.then(|| trace(&came, rows, lengths_b.len()))
}

/// Costs of neighbouring cells of a row; infinite elsewhere.
#[derive(Debug, Default)]
struct Costs {
    start: usize,
    costs: Vec<f64>,
}

impl Costs {
    fn before(start: usize) -> Costs {
        let costs = Vec::new();
        Costs { start, costs }
    }

    /// Of the cell left of column `j`.
    fn left_of(&self, j: usize) -> f64 {
        let place = j.checked_sub(self.start + 1);
        let cost = place.and_then(|place| self.costs.get(place));
        cost.copied().unwrap_or(f64::INFINITY)
    }
}

#[derive(Clone, Copy, Debug)]
enum Step {
    Both,
    First,
    Second,
}

fn trace(came: &[Vec<Step>], rows: &[Range<usize>], n_columns: usize) -> Vec<(usize, usize)> {
    let (mut i, mut j) = (rows.len() - 1, n_columns - 1);
    let mut path = vec![(i, j)];
    while (i, j) != (0, 0) {
        (i, j) = match came[i][j - rows[i].start] {
            Step::Both => (i - 1, j - 1),
            Step::First => (i - 1, j),
            Step::Second => (i, j - 1),
        };
        path.push((i, j));
    }
    path.reverse();
    path
}

/// The cells of a finer pair of levels that lie in the cells of a path over a coarser one, enlarged by
/// `margin` pieces of the finer levels on every side.
///
/// Rows start and end no earlier than the row before, and a path through them exists: each of the
/// path's cells meets the next one.
#[must_use]
pub fn rows_around(
    path: &[(usize, usize)],
    coarse: (&Level<'_>, &Level<'_>),
    fine: (&Level<'_>, &Level<'_>),
    margin: usize,
) -> Rows {
    let mut rows: Vec<Option<Range<usize>>> = vec![None; fine.0.len()];
    let enlarged = |span: Range<usize>, n: usize| {
        span.start.saturating_sub(margin)..(span.end.saturating_add(margin)).min(n)
    };
    for &(i, j) in path {
        let columns = enlarged(fine.1.pieces_in(&coarse.1.spans[j]), fine.1.len());
        for row in enlarged(fine.0.pieces_in(&coarse.0.spans[i]), fine.0.len()) {
            rows[row] = Some(match &rows[row] {
                None => columns.clone(),
                Some(known) => known.start.min(columns.start)..known.end.max(columns.end),
            });
        }
    }
    rows.into_iter().map(Option::unwrap_or_default).collect()
}
