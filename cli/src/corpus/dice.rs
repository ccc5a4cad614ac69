use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A seeded stream of random numbers.
#[derive(Clone, Debug)]
pub(crate) struct Dice {
    rng: ChaCha8Rng,
    /// The second normal number of the last Box–Muller pair.
    spare: Option<f64>,
}

impl Dice {
    /// The stream of `seed` for one item, named by its indices. Streams of different items are
    /// unrelated, so items can be made in any order.
    pub(crate) fn new(seed: u64, item: &[u64]) -> Dice {
        let key = item.iter().fold(mix(seed), |key, &idx| mix(key ^ mix(idx)));
        Dice {
            rng: ChaCha8Rng::seed_from_u64(key),
            spare: None,
        }
    }

    /// Uniform in `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f64 {
        // 53 bits are what the mantissa holds.
        (self.rng.next_u64() >> 11) as f64 * (0.5_f64).powi(53)
    }

    /// Uniform between `low` and `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Standard normal (Box–Muller).
    pub(crate) fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * self.unit()).sin_cos();
        self.spare = Some(radius * sin);
        radius * cos
    }

    /// Normal with mean 1, cut at two standard deviations: a factor that stays positive.
    pub(crate) fn about_one(&mut self, deviation: f64) -> f64 {
        1.0 + deviation * self.normal().clamp(-2.0, 2.0)
    }
}

/// The finaliser of SplitMix64: a bijection that spreads every input bit.
fn mix(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
