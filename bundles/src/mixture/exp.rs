//! e^t for the exponents of responsibilities.

use pulp::Simd;

/// Exponents below are taken for impossible: e^-80 is less than 2e-35, far below the rounding of a
/// sum that has a term of 1.
pub(super) const LEAST: f64 = -80.0;

/// Adding and subtracting it rounds a number of small magnitude to an integer, which the low bits
/// of the sum hold: 1.5 · 2^52.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// ln 2 in two parts, of which the first has so few bits that its product with an integer of the
/// range is exact.
const LN_2_HIGH: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
const MANTISSA_BITS: u32 = f64::MANTISSA_DIGITS - 1;
const EXPONENT_OF_ONE: u64 = 1.0_f64.to_bits();

/// 1/13!, …, 1/1!, 1/0!. The next term of the series, for |r| ≤ ln(2)/2, is below 5e-18.
const INVERSE_FACTORIALS: [f64; 14] = [
    1.0 / 6_227_020_800.0,
    1.0 / 479_001_600.0,
    1.0 / 39_916_800.0,
    1.0 / 3_628_800.0,
    1.0 / 362_880.0,
    1.0 / 40_320.0,
    1.0 / 5_040.0,
    1.0 / 720.0,
    1.0 / 120.0,
    1.0 / 24.0,
    1.0 / 6.0,
    0.5,
    1.0,
    1.0,
];

/// a b + c, rounded once where the processor can.
#[inline(always)]
pub(super) fn mul_add<S: Simd>(simd: S, a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
    if S::IS_SCALAR {
        simd.add_f64s(simd.mul_f64s(a, b), c)
    } else {
        simd.mul_add_f64s(a, b, c)
    }
}

/// e^t of numbers between [`LEAST`] and 0, with a relative error below 4e-16.
///
/// t = n ln 2 + r with |r| ≤ ln(2)/2 but for rounding; e^r is its Taylor series, and 2^n is made of
/// its bits.
#[inline(always)]
pub(super) fn exp<S: Simd>(simd: S, t: S::f64s) -> S::f64s {
    let splat = |x| simd.splat_f64s(x);
    let sum = mul_add(simd, t, splat(std::f64::consts::LOG2_E), splat(ROUNDER));
    let n = simd.sub_f64s(sum, splat(ROUNDER));
    let r = mul_add(simd, n, splat(-LN_2_HIGH), t);
    let r = mul_add(simd, n, splat(-LN_2_LOW), r);
    let [first, rest @ ..] = INVERSE_FACTORIALS;
    let mut series = splat(first);
    for term in rest {
        series = mul_add(simd, series, r, splat(term));
    }
    let mut power = sum;
    let lanes = pulp::bytemuck::cast_slice_mut::<_, f64>(std::slice::from_mut(&mut power));
    for lane in lanes {
        let bits = (lane.to_bits() << MANTISSA_BITS).wrapping_add(EXPONENT_OF_ONE);
        *lane = f64::from_bits(bits);
    }
    simd.mul_f64s(series, power)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use pulp::{Arch, Scalar, WithSimd};

    use super::*;

    /// Two roundings of the reduction and of the last steps of the series, and of the library's.
    const REL_TOL: f64 = 4e-16;

    struct Exp<'a>(&'a mut [f64]);

    impl WithSimd for Exp<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            for t in pulp::bytemuck::cast_slice_mut::<_, S::f64s>(self.0) {
                *t = exp(simd, *t);
            }
        }
    }

    #[track_caller]
    fn check(exponents: &[f64]) {
        let mut by_vector = exponents.to_vec();
        by_vector.resize(exponents.len().next_multiple_of(8), 0.0);
        let mut by_number = exponents.to_vec();
        Arch::new().dispatch(Exp(&mut by_vector));
        Exp(&mut by_number).with_simd(Scalar::new());
        for ((&t, vector), number) in exponents.iter().zip(by_vector).zip(by_number) {
            for found in [vector, number] {
                assert!((found - t.exp()).abs() <= REL_TOL * t.exp(), "{t}: {found}");
            }
        }
    }

    #[test]
    fn ends_and_middles_of_intervals() {
        let half_steps = (0..=230).map(|i| -f64::from(i) * std::f64::consts::LN_2 / 2.0);
        let mut exponents: Vec<f64> = half_steps.filter(|t| *t >= LEAST).collect();
        exponents.extend([LEAST, -0.0, 0.0, -f64::MIN_POSITIVE, -1e-17]);
        check(&exponents);
    }

    proptest! {
        #[test]
        fn vectors_and_numbers_equal_the_library(
            exponents in prop::collection::vec(LEAST..0.0, 1..40),
        ) {
            check(&exponents);
        }
    }
}
