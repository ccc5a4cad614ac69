//! Steps (1,1), (0,1), (1,0) for a strip of rows at once.
//!
//! A vector holds one cell of each row, lane r one column behind lane r - 1, so that a cell's three
//! predecessors are in the vectors of the two steps before: the one to the left in the same lane,
//! those above in the lane before. Two vectors, one behind the other, hide each other's latency.
//! Costs come as columns and are skewed first: lane r is delayed by r columns, one stage for each
//! bit of r.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use crate::lanes::BLOCK;
use crate::{DtwError, Sample, aligned::Aligned};

/// Factors of the local cost for the steps (1,1), (0,1), (1,0).
#[derive(Debug, Clone, Copy)]
pub(super) struct Weights<T> {
    pub(super) steps: [T; 3],
    /// Whether the strip begins with row 0, where every path starts, at its local cost alone.
    pub(super) at_start: bool,
}

/// What the wavefront carries from one block of columns to the next, and its working memory.
#[derive(Debug)]
pub(super) struct Front<T> {
    /// Samples of a vector.
    lanes: usize,
    /// Local costs: for each column two vectors.
    pub(super) tile: Aligned<T>,
    /// Accumulated costs of the last step and of those above it, upper and lower vector.
    state: Aligned<T>,
    /// The last columns before each stage of the skew, upper and lower.
    held: Aligned<T>,
    upper: Aligned<T>,
    /// Costs of the lower vector, which is one vector's lanes behind.
    lower: Aligned<T>,
    /// Vectors whose first lane is the strip's last row.
    outgoing: Aligned<T>,
}

impl<T: Sample> Front<T> {
    pub(super) fn new(height: usize) -> Result<Self, DtwError> {
        let lanes = height / 2;
        let vectors = |count: usize| Aligned::filled(count * lanes, T::infinity());
        Ok(Self {
            lanes,
            tile: vectors(2 * BLOCK)?,
            state: vectors(4)?,
            held: vectors(2 * STAGES * CHUNK)?,
            upper: vectors(BLOCK)?,
            lower: vectors(BLOCK + lanes)?,
            outgoing: vectors(BLOCK)?,
        })
    }

    /// Begins a strip: nothing is reached but what lies above its first column and one before.
    pub(super) fn begin(&mut self, above_and_before: T) {
        self.state.as_mut_slice().fill(T::infinity());
        self.held.as_mut_slice().fill(T::infinity());
        self.lower.as_mut_slice()[..self.lanes * self.lanes].fill(T::infinity());
        self.state.as_mut_slice()[2 * self.lanes] = above_and_before;
    }

    /// Accumulated costs of the strip's last row that the last block has come to.
    pub(super) fn outgoing(&self, len: usize) -> impl Iterator<Item = T> {
        let first_lanes = self.outgoing.as_slice().iter().step_by(self.lanes);
        first_lanes.copied().take(len)
    }
}

/// Words that hold the steps of a block of `len` columns, for strips of `height` rows.
pub(super) fn n_words<T: Sample>(len: usize, height: usize) -> usize {
    2 * height * len.div_ceil(T::WORD_BITS)
}

/// Advances the front by a block.
pub(super) struct Advance<'a, T: Sample> {
    pub(super) front: &'a mut Front<T>,
    pub(super) weights: Weights<T>,
    /// Rows of the strip; below them, costs pass through unchanged.
    pub(super) n_rows: usize,
    /// Columns whose costs stand in the tile; those after them are infinite.
    pub(super) n_columns: usize,
    /// Accumulated costs of the row above the strip; as many as the front is to advance by.
    pub(super) incoming: &'a [T],
    /// Where steps are kept: for every [`Real::WORD_BITS`](crate::lanes::Real::WORD_BITS) columns a
    /// bit for each lane says whether the cell was reached by (0,1), then by (1,0).
    pub(super) record: Option<&'a mut [T::Word]>,
}

impl<T: Sample> WithSimd for Advance<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let is_unit = self.weights.steps == [T::one(); 3];
        let is_full = self.n_rows == 2 * self.front.lanes;
        match (is_unit, self.record.is_some(), is_full) {
            (true, false, true) => self.run::<S, true, false, true>(simd),
            (true, false, false) => self.run::<S, true, false, false>(simd),
            (true, true, true) => self.run::<S, true, true, true>(simd),
            (true, true, false) => self.run::<S, true, true, false>(simd),
            (false, false, _) => self.run::<S, false, false, false>(simd),
            (false, true, _) => self.run::<S, false, true, false>(simd),
        }
    }
}

impl<T: Sample> Advance<'_, T> {
    #[inline(always)]
    fn run<S: Simd, const UNIT: bool, const RECORD: bool, const FULL: bool>(self, simd: S) {
        let lanes = T::lanes::<S>();
        let infinite = T::splat(simd, T::infinity());
        let len = self.incoming.len();
        let front = self.front;
        let upper = T::vectors_mut::<S>(front.upper.as_mut_slice());
        let lower = T::vectors_mut::<S>(front.lower.as_mut_slice());
        let tile = T::vectors::<S>(front.tile.as_slice());
        let held = T::vectors_mut::<S>(front.held.as_mut_slice());
        let (held_upper, held_lower) = held.split_at_mut(held.len() / 2);
        let n_skewed = len.next_multiple_of(CHUNK);
        let cost_of = |half: usize| {
            move |column: usize| {
                if column < self.n_columns {
                    tile[2 * column + half]
                } else {
                    infinite
                }
            }
        };
        skew::<T, S>(simd, cost_of(0), &mut upper[..n_skewed], held_upper);
        skew::<T, S>(
            simd,
            cost_of(1),
            &mut lower[lanes..lanes + n_skewed],
            held_lower,
        );

        let first_lane = T::less(
            simd,
            numbers::<T, S>(simd, |lane| lane),
            T::splat(simd, small(1)),
        );
        let is_row = |above: usize| {
            let rows = small(self.n_rows.saturating_sub(above));
            T::less(
                simd,
                numbers::<T, S>(simd, |lane| lane),
                T::splat(simd, rows),
            )
        };
        let is_row = [is_row(0), is_row(lanes)];
        let mut weights = self.weights.steps.map(|weight| [T::splat(simd, weight); 2]);
        if self.weights.at_start {
            for from_above in [0, 2] {
                let upper = &mut weights[from_above][0];
                *upper = T::select(simd, first_lane, T::splat(simd, T::one()), *upper);
            }
        }

        let state = T::vectors_mut::<S>(front.state.as_mut_slice());
        let [mut left0, mut left1, mut diagonal0, mut diagonal1] =
            [state[0], state[1], state[2], state[3]];
        let outgoing = T::vectors_mut::<S>(front.outgoing.as_mut_slice());
        let mut bits = [T::no_bits(simd); 4];
        let mut record = self.record;
        let costs = upper.iter().zip(&*lower);
        let steps = self.incoming.iter().zip(costs).zip(outgoing);
        for (step, ((&incoming, (&cost0, &cost1)), outgoing)) in steps.enumerate() {
            let (rotated0, rotated1) = (T::rotate(simd, left0), T::rotate(simd, left1));
            *outgoing = rotated1;
            let up0 = T::select(simd, first_lane, T::splat(simd, incoming), rotated0);
            let up1 = T::select(simd, first_lane, rotated0, rotated1);
            let cell = |half: usize, cost, ways: [T::Vector<S>; 3]| {
                let sums = |k: usize| {
                    if UNIT {
                        ways[k]
                    } else {
                        T::adds(simd, ways[k], T::muls(simd, weights[k][half], cost))
                    }
                };
                let (diagonal, left, up) = (sums(0), sums(1), sums(2));
                let by_left = T::less(simd, left, diagonal);
                let best = if RECORD {
                    T::select(simd, by_left, left, diagonal)
                } else {
                    T::mins(simd, left, diagonal)
                };
                let by_up = T::less(simd, up, best);
                let best = if RECORD {
                    T::select(simd, by_up, up, best)
                } else {
                    T::mins(simd, up, best)
                };
                let reached = if UNIT {
                    T::adds(simd, best, cost)
                } else {
                    // An infinite cost of weight zero is no number.
                    T::select(simd, T::less(simd, cost, infinite), best, infinite)
                };
                let reached = if FULL {
                    reached
                } else {
                    T::select(simd, is_row[half], reached, ways[2])
                };
                (reached, by_left, by_up)
            };
            let (reached0, by_left0, by_up0) = cell(0, cost0, [diagonal0, left0, up0]);
            let (reached1, by_left1, by_up1) = cell(1, cost1, [diagonal1, left1, up1]);
            (left0, left1, diagonal0, diagonal1) = (reached0, reached1, up0, up1);
            if RECORD {
                let bit = step % T::WORD_BITS;
                let masks = [by_left0, by_left1, by_up0, by_up1];
                for (bits, mask) in bits.iter_mut().zip(masks) {
                    *bits = T::set_bit(simd, *bits, mask, bit);
                }
                let is_last = bit + 1 == T::WORD_BITS || step + 1 == len;
                if is_last && let Some(words) = &mut record {
                    let words = pulp::bytemuck::cast_slice_mut::<_, T::Bits<S>>(words);
                    words[step / T::WORD_BITS * 4..][..4].copy_from_slice(&bits);
                    bits = [T::no_bits(simd); 4];
                }
            }
        }
        state[..4].copy_from_slice(&[left0, left1, diagonal0, diagonal1]);
        lower.copy_within(len..len + lanes, 0);
    }
}

/// Stages of the skew of the widest vectors, of 16 lanes.
const STAGES: usize = 4;

/// Columns that are skewed at once: no stage delays by more.
const CHUNK: usize = 8;

/// Delays lane r by r columns, from `costs`, two vectors a column, into `skewed` and its sibling.
/// `held` keeps the last chunk of each stage. The vectors are whole chunks.
#[inline(always)]
fn skew<T: Sample, S: Simd>(
    simd: S,
    costs: impl Fn(usize) -> T::Vector<S>,
    skewed: &mut [T::Vector<S>],
    held: &mut [T::Vector<S>],
) {
    let zero = T::splat(simd, T::zero());
    for (chunk, skewed) in skewed.chunks_exact_mut(CHUNK).enumerate() {
        let mut columns = [zero; CHUNK];
        for (k, column) in columns.iter_mut().enumerate() {
            *column = costs(chunk * CHUNK + k);
        }
        for (stage, held) in held.chunks_exact_mut(CHUNK).enumerate() {
            let delay = 1 << stage;
            if delay >= T::lanes::<S>() {
                break;
            }
            let is_delayed = T::less(simd, zero, numbers::<T, S>(simd, |lane| lane / delay % 2));
            let mut delayed = columns;
            for k in 0..CHUNK {
                let earlier = if k < delay {
                    held[CHUNK + k - delay]
                } else {
                    columns[k - delay]
                };
                delayed[k] = T::select(simd, is_delayed, earlier, columns[k]);
            }
            held[CHUNK - delay..].copy_from_slice(&columns[CHUNK - delay..]);
            columns = delayed;
        }
        skewed.copy_from_slice(&columns);
    }
}

/// A vector of a number for each lane.
#[inline(always)]
fn numbers<T: Sample, S: Simd>(simd: S, number: impl Fn(usize) -> usize) -> T::Vector<S> {
    let mut vector = T::splat(simd, T::zero());
    let lanes = pulp::bytemuck::cast_slice_mut::<_, T>(std::slice::from_mut(&mut vector));
    for (lane, slot) in lanes.iter_mut().enumerate() {
        *slot = small(number(lane));
    }
    vector
}

/// A number of lanes.
#[inline(always)]
fn small<T: Sample>(number: usize) -> T {
    T::from(number).unwrap_or_else(T::infinity)
}

/// Which of the steps led to the cell of row `lane` of a strip at `column` of its columns, by its
/// recorded words: 0 for (1,1), 1 for (0,1), 2 for (1,0).
pub(super) fn step_of<T: Sample>(
    words: &[T::Word],
    height: usize,
    lane: usize,
    column: usize,
) -> usize {
    let lanes = height / 2;
    let step = column + lane;
    let (half, lane) = (lane / lanes, lane % lanes);
    let block = step / T::WORD_BITS * 4;
    let bit = |plane: usize| {
        let word: u64 = words[(block + 2 * plane + half) * lanes + lane].into();
        word >> (step % T::WORD_BITS) & 1 == 1
    };
    if bit(1) { 2 } else { usize::from(bit(0)) }
}

/// Columns that a strip's front passes over, with those in which its last rows catch up.
pub(super) fn steps(columns: &Range<usize>, height: usize) -> usize {
    columns.len() + height
}
