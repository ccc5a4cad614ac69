//! What the kernels ask of a vector of samples, whatever its width; the width is the processor's.

use pulp::Simd;
use pulp::bytemuck::Pod;

/// Columns that a kernel works on at a time: a tile of them stays in the first-level cache.
pub(crate) const BLOCK: usize = 64;

/// Columns that are packed side by side, and summed at once where registers allow.
pub(crate) const GROUP: usize = 8;

/// Operations on vectors of a sample. Lane r of a strip's vectors is its row r.
pub trait Real: Pod + PartialOrd {
    type Vector<S: Simd>: Copy + Pod;
    type Mask<S: Simd>: Copy;
    /// As wide as a vector, with one integer per lane.
    type Bits<S: Simd>: Copy + Pod;
    /// One lane of `Bits`.
    type Word: Pod + Into<u64>;

    const ZERO: Self;
    const INFINITE: Self;
    /// Whether squared differences are summed in the expanded form, with fused operations.
    const IS_FAST: bool;
    const WORD_BITS: usize = 8 * size_of::<Self::Word>();

    fn splat<S: Simd>(simd: S, value: Self) -> Self::Vector<S>;
    fn adds<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    fn subs<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    fn muls<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    /// The lesser; no lane may be NaN.
    fn mins<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    /// a b + c: rounded once where [`Self::IS_FAST`] and the processor can, else twice.
    fn mul_adds<S: Simd>(
        simd: S,
        a: Self::Vector<S>,
        b: Self::Vector<S>,
        c: Self::Vector<S>,
    ) -> Self::Vector<S>;
    fn magnitudes<S: Simd>(simd: S, a: Self::Vector<S>) -> Self::Vector<S>;
    fn roots<S: Simd>(simd: S, a: Self::Vector<S>) -> Self::Vector<S>;
    fn less<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Mask<S>;
    fn any<S: Simd>(simd: S, mask: Self::Mask<S>) -> bool;
    fn select<S: Simd>(
        simd: S,
        mask: Self::Mask<S>,
        a: Self::Vector<S>,
        b: Self::Vector<S>,
    ) -> Self::Vector<S>;
    /// Lane r of the result is lane r - 1; lane 0 is the last.
    fn rotate<S: Simd>(simd: S, a: Self::Vector<S>) -> Self::Vector<S>;

    fn no_bits<S: Simd>(simd: S) -> Self::Bits<S>;
    /// Sets bit `bit` of the lanes in `mask`.
    fn set_bit<S: Simd>(
        simd: S,
        bits: Self::Bits<S>,
        mask: Self::Mask<S>,
        bit: usize,
    ) -> Self::Bits<S>;

    /// Lanes of a vector.
    #[inline(always)]
    fn lanes<S: Simd>() -> usize {
        size_of::<Self::Vector<S>>() / size_of::<Self>()
    }

    /// Vectors of a slice whose length is a multiple of [`Self::lanes`].
    #[inline(always)]
    fn vectors<S: Simd>(samples: &[Self]) -> &[Self::Vector<S>] {
        pulp::bytemuck::cast_slice(samples)
    }

    #[inline(always)]
    fn vectors_mut<S: Simd>(samples: &mut [Self]) -> &mut [Self::Vector<S>] {
        pulp::bytemuck::cast_slice_mut(samples)
    }

    /// Lane 0.
    #[inline(always)]
    fn first<S: Simd>(vector: &Self::Vector<S>) -> Self {
        pulp::bytemuck::cast_slice::<_, Self>(std::slice::from_ref(vector))[0]
    }
}

macro_rules! real {
    ($real:ty, $word:ty, $vector:ident, $mask:ident, $bits:ident, fast: $fast:literal,
     $splat:ident, $splat_bits:ident, $add:ident, $sub:ident, $mul:ident, $mul_add:ident,
     $abs:ident, $sqrt:ident, $less:ident, $first_true:ident, $select:ident, $select_bits:ident,
     $rotate:ident, $or:ident, $min:ident) => {
        impl Real for $real {
            type Vector<S: Simd> = S::$vector;
            type Mask<S: Simd> = S::$mask;
            type Bits<S: Simd> = S::$bits;
            type Word = $word;

            const ZERO: Self = 0.0;
            const INFINITE: Self = <$real>::INFINITY;
            const IS_FAST: bool = $fast;

            #[inline(always)]
            fn splat<S: Simd>(simd: S, value: Self) -> S::$vector {
                simd.$splat(value)
            }
            #[inline(always)]
            fn adds<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$add(a, b)
            }
            #[inline(always)]
            fn subs<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$sub(a, b)
            }
            #[inline(always)]
            fn muls<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$mul(a, b)
            }
            #[inline(always)]
            fn mins<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$min(a, b)
            }
            #[inline(always)]
            fn mul_adds<S: Simd>(
                simd: S,
                a: S::$vector,
                b: S::$vector,
                c: S::$vector,
            ) -> S::$vector {
                if $fast && !S::IS_SCALAR {
                    simd.$mul_add(a, b, c)
                } else {
                    simd.$add(simd.$mul(a, b), c)
                }
            }
            #[inline(always)]
            fn magnitudes<S: Simd>(simd: S, a: S::$vector) -> S::$vector {
                simd.$abs(a)
            }
            #[inline(always)]
            fn roots<S: Simd>(simd: S, a: S::$vector) -> S::$vector {
                simd.$sqrt(a)
            }
            #[inline(always)]
            fn less<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$mask {
                simd.$less(a, b)
            }
            #[inline(always)]
            fn any<S: Simd>(simd: S, mask: S::$mask) -> bool {
                simd.$first_true(mask) < Self::lanes::<S>()
            }
            #[inline(always)]
            fn select<S: Simd>(
                simd: S,
                mask: S::$mask,
                a: S::$vector,
                b: S::$vector,
            ) -> S::$vector {
                simd.$select(mask, a, b)
            }
            #[inline(always)]
            fn rotate<S: Simd>(simd: S, a: S::$vector) -> S::$vector {
                simd.$rotate(a, 1)
            }
            #[inline(always)]
            fn no_bits<S: Simd>(simd: S) -> S::$bits {
                simd.$splat_bits(0)
            }
            #[inline(always)]
            fn set_bit<S: Simd>(simd: S, bits: S::$bits, mask: S::$mask, bit: usize) -> S::$bits {
                let with = simd.$or(bits, simd.$splat_bits(1 << bit));
                simd.$select_bits(mask, with, bits)
            }
        }
    };
}

real!(f32, u32, f32s, m32s, u32s, fast: true,
    splat_f32s, splat_u32s, add_f32s, sub_f32s, mul_f32s, mul_add_f32s,
    abs_f32s, sqrt_f32s, less_than_f32s, first_true_m32s, select_f32s, select_u32s,
    rotate_right_f32s, or_u32s, min_f32s);
real!(f64, u64, f64s, m64s, u64s, fast: false,
    splat_f64s, splat_u64s, add_f64s, sub_f64s, mul_f64s, mul_add_f64s,
    abs_f64s, sqrt_f64s, less_than_f64s, first_true_m64s, select_f64s, select_u64s,
    rotate_right_f64s, or_u64s, min_f64s);
