//! Curves over whole clips: block by block of frames, and in a block column by column, so that what
//! a column needs of the two before it lies in the first-level cache.

use pulp::{Arch, Simd, WithSimd};

use crate::fixed::{Change, FixedCosts, UNREACHED};
use crate::relax::{self, From};

/// Frames of a block.
const BLOCK: usize = 1536;
/// A path steps over one frame at most.
const BEFORE: usize = 2;
const BYTES: usize = size_of::<u64>();

/// Cost of the best path that ends at each frame, [`UNREACHED`] or more where there is none.
pub(crate) fn costs(fixed: &FixedCosts, words: &[u64]) -> Vec<u32> {
    let mut costs = vec![UNREACHED; words.len()];
    if fixed.n_columns() >= 2 {
        Arch::new().dispatch(Sweep::<false> {
            fixed,
            words,
            costs: &mut costs,
            starts: &mut [],
        });
    }
    costs
}

/// The same costs, and the frame modulo 2³² where the path begins.
pub(crate) fn costs_and_starts(fixed: &FixedCosts, words: &[u64]) -> (Vec<u32>, Vec<u32>) {
    let mut costs = vec![UNREACHED; words.len()];
    let mut starts = vec![0; words.len()];
    if fixed.n_columns() >= 2 {
        Arch::new().dispatch(Sweep::<true> {
            fixed,
            words,
            costs: &mut costs,
            starts: &mut starts,
        });
    }
    (costs, starts)
}

struct Sweep<'a, const STARTS: bool> {
    fixed: &'a FixedCosts,
    words: &'a [u64],
    costs: &'a mut [u32],
    starts: &'a mut [u32],
}

/// One column over the frames of a block, after the last ones of the block before.
#[repr(align(64))]
#[derive(Clone, Copy)]
struct Row([u32; BEFORE + BLOCK]);

/// A byte of each word of a block.
type Plane = [[u8; LANES]; BLOCK / LANES];
/// Frames of a group whose bytes fill a vector.
const LANES: usize = 64;

/// Costs or starts of paths to the cells that are still needed.
struct Track {
    now: Box<Row>,
    before: Box<Row>,
    twice_before: Box<Row>,
    /// The last cells of each column in the block before.
    ends: Vec<[u32; BEFORE]>,
}

impl Track {
    fn new(n_columns: usize) -> Self {
        let row = Box::new(Row([UNREACHED; BEFORE + BLOCK]));
        Self {
            now: row.clone(),
            before: row.clone(),
            twice_before: row,
            ends: vec![[UNREACHED; BEFORE]; n_columns],
        }
    }

    /// Begins a block: nothing lies before the first column.
    fn begin(&mut self) {
        self.before.0.fill(UNREACHED);
        self.twice_before.0.fill(UNREACHED);
    }

    /// The cells of column `k` in a block of `n` frames, and where they are reached from.
    #[inline(always)]
    fn column(&mut self, k: usize, n: usize) -> (&mut [u32], From<'_>) {
        self.now.0[..BEFORE].copy_from_slice(&self.ends[k]);
        let from = From {
            ahead: &self.before.0[1..],
            over_a_frame: &self.before.0,
            over_a_column: &self.twice_before.0[1..],
        };
        (&mut self.now.0[BEFORE..][..n], from)
    }

    /// Goes on to the column after `k`.
    #[inline(always)]
    fn turn(&mut self, k: usize, n: usize) {
        self.ends[k].copy_from_slice(&self.now.0[n..][..BEFORE]);
        std::mem::swap(&mut self.before, &mut self.twice_before);
        std::mem::swap(&mut self.before, &mut self.now);
    }

    /// The cells of the last column.
    fn last(&self, n: usize) -> &[u32] {
        &self.before.0[BEFORE..][..n]
    }
}

impl<const STARTS: bool> WithSimd for Sweep<'_, STARTS> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let fixed = self.fixed;
        let mut costs = Track::new(fixed.n_columns());
        let mut starts = Track::new(if STARTS { fixed.n_columns() } else { 0 });
        let mut planes = Box::new([[[0; LANES]; BLOCK / LANES]; BYTES]);
        let asked = fixed.care.iter().fold(0, |all, care| all | care);
        for (block, words) in self.words.chunks(BLOCK).enumerate() {
            let (first, n) = (block * BLOCK, words.len());
            split(words, asked, &mut planes);
            let mut counts: Plane = [[0; LANES]; BLOCK / LANES];
            costs.begin();
            for k in 0..fixed.n_columns() {
                let counts = &mut counts[..n.div_ceil(LANES)];
                count(counts, &fixed.changes[k], &planes);
                let counts = &counts.as_flattened()[..n];
                let (ones, weight) = (fixed.value[k].count_ones() as u8, fixed.weight[k]);
                let local = || {
                    let all = counts.iter();
                    all.map(|count| u32::from(count.wrapping_add(ones)) * weight)
                };
                let (to, from) = costs.column(k, n);
                if k == 0 {
                    begin(to, local());
                } else {
                    relax::costs(to, from, fixed.skip, local());
                }
                if STARTS {
                    let (to, begun) = starts.column(k, n);
                    if k == 0 {
                        begin(to, (first..).map(|frame| frame as u32));
                    } else {
                        relax::starts(to, from, begun, fixed.skip, local());
                    }
                    starts.turn(k, n);
                }
                costs.turn(k, n);
            }
            self.costs[first..][..n].copy_from_slice(costs.last(n));
            if STARTS {
                self.starts[first..][..n].copy_from_slice(starts.last(n));
            }
        }
    }
}

#[inline(always)]
fn begin(to: &mut [u32], first: impl Iterator<Item = u32>) {
    for (to, first) in to.iter_mut().zip(first) {
        *to = first;
    }
}

/// Bytes of words that hold features asked for.
#[inline(always)]
fn split(words: &[u64], asked: u64, planes: &mut [Plane; BYTES]) {
    for (byte, plane) in planes.iter_mut().enumerate() {
        let shift = 8 * byte;
        if asked >> shift & 0xFF != 0 {
            for (to, word) in plane.as_flattened_mut().iter_mut().zip(words) {
                *to = (word >> shift) as u8;
            }
        }
    }
}

/// Adds changes to the counts of disagreements, a few at a time so that counts are read less often.
#[inline(always)]
fn count(counts: &mut [[u8; LANES]], changes: &[Change], planes: &[Plane; BYTES]) {
    let (fours, ones) = changes.as_chunks::<4>();
    for four in fours {
        add(counts, four, planes);
    }
    for one in ones {
        add(counts, std::array::from_ref(one), planes);
    }
}

#[inline(always)]
fn add<const N: usize>(counts: &mut [[u8; LANES]], changes: &[Change; N], planes: &[Plane; BYTES]) {
    let planes = changes.map(|change| &planes[change.byte % BYTES]);
    // Apart from the changes, which might lie anywhere in memory for all the compiler knows.
    let (bits, by) = (
        changes.map(|change| change.bit),
        changes.map(|change| change.by),
    );
    for (group, counts) in counts.iter_mut().enumerate() {
        let mut sums = *counts;
        for j in 0..N {
            let plane = &planes[j][group];
            for i in 0..LANES {
                let gain = if plane[i] & bits[j] == 0 { 0 } else { by[j] };
                sums[i] = sums[i].wrapping_add(gain);
            }
        }
        *counts = sums;
    }
}

#[cfg(test)]
mod tests;
