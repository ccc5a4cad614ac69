//! k-means++: each centre a frame, drawn with a chance in proportion to its squared distance from
//! the nearest centre before.

use std::ops::Range;

use pulp::bytemuck::{cast_slice, cast_slice_mut};
use pulp::{Arch, Simd, WithSimd};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::packed::{BLOCK, Packed};
use super::state::State;
use crate::parallel;

/// Numbers, frames times dimensions, from which on threads are worth their start.
const MANY: usize = 1 << 19;

/// Clusters about at most `n_letters` frames: fewer where fewer frames are distinct. Each frame
/// belongs to the nearest, ties to the earlier drawn.
pub(super) fn seed(packed: &Packed, n_letters: usize, seed: u64) -> State {
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    let chunks = packed.chunks();
    let mut parts: Vec<Part<'_>> = chunks
        .iter()
        .map(|chunk| Part::new(packed, chunk))
        .collect();
    let first = (uniform(&mut dice) * packed.n_frames as f64) as usize;
    let mut drawn = first.min(packed.n_frames - 1);
    let mut n_drawn = 0;
    loop {
        let centre = packed.frame(drawn);
        let letter = n_drawn as f64;
        let draw_near = |part: &mut Part<'_>| {
            Arch::new().dispatch(Nearer {
                part,
                centre,
                letter,
            })
        };
        if packed.n_frames * packed.dims < MANY {
            parts.iter_mut().for_each(draw_near);
        } else {
            parallel::map_mut(&mut parts, draw_near);
        }
        n_drawn += 1;
        if n_drawn == n_letters {
            break;
        }
        match draw(&parts, uniform(&mut dice)) {
            Some(frame) => drawn = frame,
            None => break,
        }
    }
    assigned(packed, &parts, n_drawn)
}

/// In `[0, 1)`.
fn uniform(dice: &mut ChaCha8Rng) -> f64 {
    let bits = dice.next_u64() >> (u64::BITS - f64::MANTISSA_DIGITS);
    bits as f64 / (1_u64 << f64::MANTISSA_DIGITS) as f64
}

/// A chunk and what its frames are nearest to.
struct Part<'a> {
    frames: Range<usize>,
    dims: usize,
    tiles: &'a [f64],
    /// Squared distances from the nearest centre; zero after the last frame.
    squares: Vec<f64>,
    /// The letter of that centre.
    nearest: Vec<f64>,
    /// Of the squared distances.
    total: f64,
}

impl<'a> Part<'a> {
    fn new(packed: &'a Packed, frames: &Range<usize>) -> Self {
        let padded = frames.len().next_multiple_of(BLOCK);
        let mut squares = vec![0.0; padded];
        squares[..frames.len()].fill(f64::INFINITY);
        Self {
            frames: frames.clone(),
            dims: packed.dims,
            tiles: packed.tiles(frames),
            squares,
            nearest: vec![0.0; padded],
            total: 0.0,
        }
    }
}

/// The frame at `share` of the sum of squared distances; `None` when all are zero.
fn draw(parts: &[Part<'_>], share: f64) -> Option<usize> {
    let mut rest = share * parts.iter().map(|part| part.total).sum::<f64>();
    for part in parts {
        if rest >= part.total {
            rest -= part.total;
            continue;
        }
        for (frame, &square) in part.frames.clone().zip(&part.squares) {
            if rest < square {
                return Some(frame);
            }
            rest -= square;
        }
    }
    // Rounding has left a remainder after the last frame.
    let mut far = parts.iter().rev().flat_map(|part| {
        let frames = part.frames.clone().zip(&part.squares[..part.frames.len()]);
        let mut frames = frames.rev();
        frames.find_map(|(frame, square)| (*square > 0.0).then_some(frame))
    });
    far.next()
}

/// Accounts for a new centre.
struct Nearer<'a, 'b> {
    part: &'a mut Part<'b>,
    centre: &'a [f64],
    letter: f64,
}

impl WithSimd for Nearer<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let lanes = S::F64_LANES;
        let letter = simd.splat_f64s(self.letter);
        let tiles = self.part.tiles.chunks_exact((self.part.dims + 1) * BLOCK);
        let squares = self.part.squares.chunks_exact_mut(BLOCK);
        let nearest = self.part.nearest.chunks_exact_mut(BLOCK);
        for ((tile, squares), nearest) in tiles.zip(squares).zip(nearest) {
            let squares = cast_slice_mut::<_, S::f64s>(squares);
            let nearest = cast_slice_mut::<_, S::f64s>(nearest);
            for (i, (least, nearest)) in squares.iter_mut().zip(nearest).enumerate() {
                let mut square = simd.splat_f64s(0.0);
                for (numbers, &centre) in tile.chunks_exact(BLOCK).zip(self.centre) {
                    let numbers = cast_slice::<_, S::f64s>(&numbers[i * lanes..][..lanes]);
                    let difference = simd.sub_f64s(numbers[0], simd.splat_f64s(centre));
                    square = simd.add_f64s(square, simd.mul_f64s(difference, difference));
                }
                let is_nearer = simd.less_than_f64s(square, *least);
                *least = simd.select_f64s(is_nearer, square, *least);
                *nearest = simd.select_f64s(is_nearer, letter, *nearest);
            }
        }
        self.part.total = self.part.squares.iter().sum();
    }
}

/// The M step where each frame belongs to its nearest centre alone.
fn assigned(packed: &Packed, parts: &[Part<'_>], n_letters: usize) -> State {
    let width = packed.width;
    let mut sums = vec![0.0; n_letters * width];
    for part in parts {
        let rows = packed.rows(&part.frames).chunks_exact(width);
        for (row, &letter) in rows.zip(&part.nearest).take(part.frames.len()) {
            let sums = &mut sums[letter as usize * width..][..width];
            sums.iter_mut().zip(row).for_each(|(sum, x)| *sum += x);
        }
    }
    let (state, _) = State::of_sums(&sums, n_letters, packed);
    state
}
