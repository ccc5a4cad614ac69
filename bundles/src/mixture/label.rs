//! The likeliest letter of each frame.
//!
//! Squared distances are sums of squared differences, so that equal clusters are equally likely and
//! ties are what they are.

use ndarray::{ArrayView2, s};
use pulp::bytemuck::{cast_slice, cast_slice_mut};
use pulp::{Arch, Simd, WithSimd};

use super::aligned::Aligned;
use super::packed::{BLOCK, check_finite, chunks};
use super::{LabelRule, MixtureError};
use crate::{PoseClusters, parallel};

impl PoseClusters {
    /// The letter of each of `frames`, of shape `(frames, dims)`: the one that `rule` says, ties to
    /// the lower label. The frames need not be those the mixture was fitted to.
    ///
    /// # Errors
    ///
    /// When there are no letters, the dimensions differ, or a number is not finite.
    pub fn label(
        &self,
        frames: ArrayView2<'_, f64>,
        rule: LabelRule,
    ) -> Result<Vec<u32>, MixtureError> {
        self.check_frames(frames)?;
        let terms = Terms::new(self, rule);
        let arch = Arch::new();
        let labelled = parallel::map(&chunks(frames.nrows()), |_, chunk| {
            arch.dispatch(Labels {
                terms: &terms,
                frames: frames.slice(s![chunk.clone(), ..]),
            })
        });
        Ok(labelled.concat())
    }

    /// Whether frames can be compared with these clusters.
    pub(super) fn check_frames(&self, frames: ArrayView2<'_, f64>) -> Result<(), MixtureError> {
        let (expected, found) = (self.means().ncols(), frames.ncols());
        if self.n_letters() == 0 {
            return Err(MixtureError::NoLetters);
        }
        if expected != found {
            return Err(MixtureError::Dimensions { expected, found });
        }
        check_finite(frames)
    }
}

/// ln p(x|a) = scale - half |x - µ|², with ln w where the rule has it.
struct Terms {
    /// Scale, half and mean of each letter, one after the other.
    numbers: Vec<f64>,
    dims: usize,
}

impl Terms {
    fn new(clusters: &PoseClusters, rule: LabelRule) -> Self {
        let dims = clusters.means().ncols();
        let means = clusters.means();
        let others = clusters.sigmas().into_iter().zip(clusters.weights());
        let mut numbers = Vec::with_capacity(clusters.n_letters() * (dims + 2));
        for (mean, (sigma, weight)) in means.outer_iter().zip(others) {
            let weight = match rule {
                LabelRule::Likelihood => 0.0,
                LabelRule::Posterior => weight.ln(),
            };
            // A square that underflows would make nothing of a distance of nothing.
            let variance = (sigma * sigma).clamp(f64::MIN_POSITIVE, f64::MAX);
            // Without the term that all letters share.
            numbers.extend([weight - dims as f64 * sigma.ln(), 0.5 / variance]);
            numbers.extend(mean);
        }
        Self { numbers, dims }
    }
}

struct Labels<'a> {
    terms: &'a Terms,
    frames: ArrayView2<'a, f64>,
}

impl WithSimd for Labels<'_> {
    type Output = Vec<u32>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<u32> {
        let n_frames = self.frames.nrows();
        let mut labels = Vec::with_capacity(n_frames.next_multiple_of(BLOCK));
        let mut tile = Aligned::filled(self.terms.dims * BLOCK, 0.0);
        for start in (0..n_frames).step_by(BLOCK) {
            let end = (start + BLOCK).min(n_frames);
            let block = self.frames.slice(s![start..end, ..]);
            for ((frame, dim), &x) in block.indexed_iter() {
                tile[dim * BLOCK + frame] = x;
            }
            let likeliest = likeliest(simd, &tile, self.terms);
            labels.extend(likeliest.map(|label| label as u32));
        }
        labels.truncate(n_frames);
        labels
    }
}

/// Labels of a block's frames.
#[inline(always)]
fn likeliest<S: Simd>(simd: S, tile: &[f64], terms: &Terms) -> [f64; BLOCK] {
    let lanes = S::F64_LANES;
    let mut labels = [0.0; BLOCK];
    let mut most = [f64::NEG_INFINITY; BLOCK];
    let best = cast_slice_mut::<_, S::f64s>(&mut labels);
    let most = cast_slice_mut::<_, S::f64s>(&mut most);
    for (label, terms) in terms.numbers.chunks_exact(terms.dims + 2).enumerate() {
        let [scale, half, mean @ ..] = terms else {
            continue;
        };
        let [label, scale, half] = [label as f64, *scale, *half].map(|x| simd.splat_f64s(x));
        for (i, (best, most)) in best.iter_mut().zip(&mut *most).enumerate() {
            let mut square = simd.splat_f64s(0.0);
            for (numbers, &mean) in tile.chunks_exact(BLOCK).zip(mean) {
                let numbers = cast_slice::<_, S::f64s>(&numbers[i * lanes..][..lanes]);
                let difference = simd.sub_f64s(numbers[0], simd.splat_f64s(mean));
                square = simd.add_f64s(square, simd.mul_f64s(difference, difference));
            }
            let density = simd.sub_f64s(scale, simd.mul_f64s(half, square));
            let is_more = simd.less_than_f64s(*most, density);
            *most = simd.select_f64s(is_more, density, *most);
            *best = simd.select_f64s(is_more, label, *best);
        }
    }
    labels
}
