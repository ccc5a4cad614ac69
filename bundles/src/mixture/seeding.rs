//! k-means++: each centre a frame, drawn with a chance in proportion to its squared distance from
//! the nearest centre before.

use std::cmp::Ordering;
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

/// The arrival of frames that all stand still.
const NOBODY: (f64, usize) = (f64::INFINITY, 0);

/// Clusters about at most `n_letters` frames: fewer where fewer frames are distinct. Each frame
/// belongs to the nearest, ties to the earlier drawn.
pub(super) fn seed(packed: &Packed, n_letters: usize, seed: u64) -> State {
    let mut race = Race::new(packed, seed);
    let drawn = race.draw(packed, n_letters);
    assigned(packed, &race.parts, drawn.len())
}

/// The draws, as a race. Each frame has a way to go, of exponential length, and goes at a speed of
/// its squared distance from the nearest centre; who arrives is the next centre. What is left of an
/// exponential way is as long as a new one on average, so that each draw is in proportion to the
/// squared distances, whatever was drawn before. But one number for each frame decides all draws:
/// where poses differ by a little noise, most of them draw the same frames.
struct Race<'a> {
    parts: Vec<Part<'a>>,
    /// The frame that arrives first, and how long that takes.
    next: (f64, usize),
}

impl<'a> Race<'a> {
    fn new(packed: &'a Packed, seed: u64) -> Self {
        let mut dice = ChaCha8Rng::seed_from_u64(seed);
        let chunks = packed.chunks();
        let parts = chunks
            .iter()
            .map(|chunk| Part::new(packed, chunk, &mut dice));
        let mut parts: Vec<Part<'_>> = parts.collect();
        // As long as there is no centre, all go at the same speed.
        let ways = parts
            .iter()
            .flat_map(|part| part.frames.clone().zip(&part.ways));
        let ways = ways.map(|(frame, &way)| (way, frame));
        let (way, frame) = ways.min_by(earlier).unwrap_or_default();
        for left in parts.iter_mut().flat_map(|part| &mut part.ways) {
            *left -= way;
        }
        let next = (0.0, frame);
        Self { parts, next }
    }

    /// At most `n_letters` frames, as long as some are away from all drawn before. Frames that
    /// arrive at once are drawn by index.
    fn draw(&mut self, packed: &Packed, n_letters: usize) -> Vec<usize> {
        let mut drawn = Vec::with_capacity(n_letters);
        while drawn.len() < n_letters && self.next.0 < f64::INFINITY {
            let (time, frame) = self.next;
            let letter = drawn.len() as f64;
            drawn.push(frame);
            let centre = packed.frame(frame);
            let draw_near = |part: &mut Part<'_>| {
                Arch::new().dispatch(Nearer {
                    part,
                    time,
                    centre,
                    letter,
                })
            };
            if packed.n_frames * packed.dims < MANY {
                self.parts.iter_mut().for_each(draw_near);
            } else {
                parallel::map_mut(&mut self.parts, draw_near);
            }
            let arrivals = self.parts.iter().map(|part| part.next);
            self.next = arrivals.min_by(earlier).unwrap_or(NOBODY);
        }
        drawn
    }
}

/// In `[0, 1)`.
fn uniform(dice: &mut ChaCha8Rng) -> f64 {
    let bits = dice.next_u64() >> (u64::BITS - f64::MANTISSA_DIGITS);
    bits as f64 / (1_u64 << f64::MANTISSA_DIGITS) as f64
}

/// A chunk, what its frames are nearest to, and how far they have to go.
struct Part<'a> {
    frames: Range<usize>,
    dims: usize,
    tiles: &'a [f64],
    /// What is left to go; after the last frame there is no end.
    ways: Vec<f64>,
    /// Squared distances from the nearest centre; zero after the last frame.
    squares: Vec<f64>,
    /// The letter of that centre.
    nearest: Vec<f64>,
    /// Of its frames, when the first one arrives, and which.
    next: (f64, usize),
}

impl<'a> Part<'a> {
    fn new(packed: &'a Packed, frames: &Range<usize>, dice: &mut ChaCha8Rng) -> Self {
        let padded = frames.len().next_multiple_of(BLOCK);
        let mut squares = vec![0.0; padded];
        squares[..frames.len()].fill(f64::INFINITY);
        let mut ways = vec![f64::INFINITY; padded];
        // The logarithm of 1 - u is finite.
        ways[..frames.len()].fill_with(|| -(1.0 - uniform(dice)).ln());
        Self {
            frames: frames.clone(),
            dims: packed.dims,
            tiles: packed.tiles(frames),
            ways,
            squares,
            nearest: vec![0.0; padded],
            next: NOBODY,
        }
    }
}

/// Goes on until a new centre is there, and accounts for it.
struct Nearer<'a, 'b> {
    part: &'a mut Part<'b>,
    time: f64,
    centre: &'a [f64],
    letter: f64,
}

impl WithSimd for Nearer<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let lanes = S::F64_LANES;
        let numbers = [self.time, self.letter, 0.0, f64::MAX];
        let [time, letter, zero, most] = numbers.map(|x| simd.splat_f64s(x));
        let part = self.part;
        let tiles = part.tiles.chunks_exact((part.dims + 1) * BLOCK);
        let ways = part.ways.chunks_exact_mut(BLOCK);
        let squares = part.squares.chunks_exact_mut(BLOCK);
        let nearest = part.nearest.chunks_exact_mut(BLOCK);
        // Of each place in a block, when the first frame arrives and in which block it is.
        let mut arrivals = [f64::INFINITY; BLOCK];
        let mut blocks = [0.0; BLOCK];
        let both = tiles.zip(ways).zip(squares).zip(nearest).enumerate();
        for (block, (((tile, ways), squares), nearest)) in both {
            let block = simd.splat_f64s(block as f64);
            let arrivals = cast_slice_mut::<_, S::f64s>(&mut arrivals);
            let blocks = cast_slice_mut::<_, S::f64s>(&mut blocks);
            let ways = cast_slice_mut::<_, S::f64s>(ways);
            let squares = cast_slice_mut::<_, S::f64s>(squares);
            let nearest = cast_slice_mut::<_, S::f64s>(nearest);
            for (i, (way, least)) in ways.iter_mut().zip(squares).enumerate() {
                // Before there is a centre no time passes, and no speed is known.
                if self.time > 0.0 {
                    let left = simd.sub_f64s(*way, simd.mul_f64s(time, *least));
                    // Rounding takes nobody beyond the end.
                    *way = simd.max_f64s(left, zero);
                }
                let mut square = zero;
                for (numbers, &centre) in tile.chunks_exact(BLOCK).zip(self.centre) {
                    let numbers = cast_slice::<_, S::f64s>(&numbers[i * lanes..][..lanes]);
                    let difference = simd.sub_f64s(numbers[0], simd.splat_f64s(centre));
                    square = simd.add_f64s(square, simd.mul_f64s(difference, difference));
                }
                let is_nearer = simd.less_than_f64s(square, *least);
                *least = simd.select_f64s(is_nearer, square, *least);
                nearest[i] = simd.select_f64s(is_nearer, letter, nearest[i]);
                // Nobody who stands still is earlier than anybody: infinity times 0 is no number.
                let bound = simd.mul_f64s(arrivals[i], *least);
                let is_earlier = simd.less_than_f64s(*way, bound);
                if simd.first_true_m64s(is_earlier) == lanes {
                    continue;
                }
                // Who moves arrives, however long it takes.
                let arrival = simd.min_f64s(simd.div_f64s(*way, *least), most);
                arrivals[i] = simd.select_f64s(is_earlier, arrival, arrivals[i]);
                blocks[i] = simd.select_f64s(is_earlier, block, blocks[i]);
            }
        }
        let arrivals = arrivals.iter().zip(&blocks).enumerate();
        let arrivals = arrivals.map(|(place, (&time, &block))| {
            (time, part.frames.start + block as usize * BLOCK + place)
        });
        part.next = arrivals.min_by(earlier).unwrap_or(NOBODY);
    }
}

/// Arrivals by time, and those at once by index.
fn earlier(a: &(f64, usize), b: &(f64, usize)) -> Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
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

#[cfg(test)]
mod tests {
    use ndarray::{Array2, array};

    use super::*;

    fn drawn(frames: &Array2<f64>, n_letters: usize, seed: u64) -> Vec<usize> {
        let packed = Packed::new(frames.view()).unwrap();
        Race::new(&packed, seed).draw(&packed, n_letters)
    }

    /// The law of k-means++: the first frame any, then each by squared distance from those before.
    #[test]
    fn frames_are_drawn_by_squared_distance() {
        const SEEDS: u64 = 40_000;
        /// Standard errors: beyond them a true count is one time in a million.
        const ERRORS: f64 = 5.0;
        let places = [0.0_f64, 1.0, 3.0, 7.0];
        let frames = array![[0.0], [1.0], [3.0], [7.0]];
        let mut counts = [[[0_u32; 4]; 4]; 4];
        for seed in 0..SEEDS {
            let [a, b, c] = drawn(&frames, 3, seed)[..] else {
                panic!("three frames");
            };
            counts[a][b][c] += 1;
        }
        let speed = |of: usize, centres: &[usize]| {
            let squares = centres.iter().map(|&c| (places[of] - places[c]).powi(2));
            squares.fold(f64::INFINITY, f64::min)
        };
        let share = |of: usize, centres: &[usize]| {
            speed(of, centres) / (0..4).map(|i| speed(i, centres)).sum::<f64>()
        };
        for (a, b, c) in (0..64).map(|i| (i / 16, i / 4 % 4, i % 4)) {
            let chance = 0.25 * share(b, &[a]) * share(c, &[a, b]);
            let expected = chance * SEEDS as f64;
            let error = (expected * (1.0 - chance)).sqrt();
            let found = f64::from(counts[a][b][c]);
            assert!((found - expected).abs() <= ERRORS * error, "{a} {b} {c}");
        }
    }

    /// Frames on a curve, and the same with noise of a hundredth of the distance between centres.
    #[test]
    fn a_little_noise_leaves_most_draws() {
        let curve = |i: usize, dim: usize| (i as f64 / 200.0 * (dim + 1) as f64).sin();
        let clean = Array2::from_shape_fn((5000, 4), |(i, dim)| curve(i, dim));
        let mut dice = ChaCha8Rng::seed_from_u64(3);
        let noisy = clean.mapv(|x| x + 0.002 * (uniform(&mut dice) - 0.5));
        let (before, after) = (drawn(&clean, 100, 0), drawn(&noisy, 100, 0));
        let kept = before.iter().filter(|frame| after.contains(frame)).count();
        assert!(kept >= 90, "{kept} of 100");
        assert_ne!(before, drawn(&clean, 100, 1));
    }

    #[test]
    fn draws_end_when_no_frame_is_away_from_all() {
        let frames = array![[1.0], [2.0], [1.0], [2.0]];
        assert_eq!(drawn(&frames, 9, 0).len(), 2);
        // The speeds are as small as numbers can be: the ways take longer than any number.
        let near = array![[0.0], [1e-160], [3e-160]];
        assert_eq!(drawn(&near, 9, 0).len(), 3);
    }
}
