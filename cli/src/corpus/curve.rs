use super::dice::Dice;

/// 0 up to `from`, 1 beyond `to`, in between the quintic with vanishing first and second
/// derivatives at both ends.
pub(crate) fn ease(from: f64, to: f64, x: f64) -> f64 {
    let u = ((x - from) / (to - from)).clamp(0.0, 1.0);
    u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
}

/// `max(x, 0)` with the corner rounded over about `width`; never below the exact value.
pub(crate) fn soft_positive(x: f64, width: f64) -> f64 {
    0.5 * (x + (x * x + width * width).sqrt())
}

/// A curve through key values, twice continuously differentiable, at rest at both ends.
///
/// Slopes at the keys are those of the monotone cubic of Fritsch and Carlson (harmonic means), so a
/// value that is the same in two successive keys stays put between them and extrema lie on keys;
/// pieces are quintics with zero second derivative at the keys.
#[derive(Clone, Debug)]
pub(crate) struct Spline<const N: usize> {
    times: Vec<f64>,
    values: Vec<[f64; N]>,
    slopes: Vec<[f64; N]>,
}

impl<const N: usize> Spline<N> {
    /// `times` must rise; surplus values are ignored.
    pub(crate) fn new(times: Vec<f64>, values: Vec<[f64; N]>) -> Spline<N> {
        let n_keys = times.len().min(values.len());
        let secant = |k: usize, i: usize| {
            (values[k + 1][i] - values[k][i]) / (times[k + 1] - times[k]).max(f64::EPSILON)
        };
        let slope = |k: usize, i: usize| {
            let (before, after) = (secant(k - 1, i), secant(k, i));
            if before * after > 0.0 {
                2.0 * before * after / (before + after)
            } else {
                0.0
            }
        };
        let slopes = (0..n_keys)
            .map(|k| match k {
                0 => [0.0; N],
                _ if k + 1 == n_keys => [0.0; N],
                _ => std::array::from_fn(|i| slope(k, i)),
            })
            .collect();
        Spline {
            times,
            values,
            slopes,
        }
    }

    /// The value at time `t`; the first or last key outside of them.
    pub(crate) fn at(&self, t: f64) -> [f64; N] {
        let k = self.times.partition_point(|&key| key <= t);
        if k == 0 {
            return self.values.first().copied().unwrap_or([0.0; N]);
        }
        if k >= self.slopes.len() {
            return self.values.last().copied().unwrap_or([0.0; N]);
        }
        let span = self.times[k] - self.times[k - 1];
        let u = (t - self.times[k - 1]) / span;
        let (u3, u4, u5) = (u.powi(3), u.powi(4), u.powi(5));
        let to = 10.0 * u3 - 15.0 * u4 + 6.0 * u5;
        let leave = span * (u - 6.0 * u3 + 8.0 * u4 - 3.0 * u5);
        let arrive = span * (-4.0 * u3 + 7.0 * u4 - 3.0 * u5);
        std::array::from_fn(|i| {
            self.values[k - 1][i] * (1.0 - to)
                + self.values[k][i] * to
                + self.slopes[k - 1][i] * leave
                + self.slopes[k][i] * arrive
        })
    }
}

/// A scalar [`Spline`] through `(time, value)` pairs.
pub(crate) fn track(keys: &[(f64, f64)]) -> Spline<1> {
    Spline::new(
        keys.iter().map(|key| key.0).collect(),
        keys.iter().map(|key| [key.1]).collect(),
    )
}

/// Slow random drift around zero: three sine waves of unrelated frequency.
#[derive(Clone, Debug)]
pub(crate) struct Drift {
    waves: [Wave; 3],
}

#[derive(Clone, Debug)]
struct Wave {
    amplitude: f64,
    /// Radians per second.
    speed: f64,
    phase: f64,
}

impl Drift {
    /// Root mean square `amplitude`; `speed` in cycles per second scales all three waves.
    pub(crate) fn new(dice: &mut Dice, amplitude: f64, speed: f64) -> Drift {
        let waves = [0.37, 0.83, 1.49].map(|factor| Wave {
            // Three waves of amplitude a have the root mean square a·√(3/2).
            amplitude: amplitude * (2.0_f64 / 3.0).sqrt(),
            speed: std::f64::consts::TAU * speed * factor * dice.between(0.8, 1.2),
            phase: dice.between(0.0, std::f64::consts::TAU),
        });
        Drift { waves }
    }

    pub(crate) fn at(&self, t: f64) -> f64 {
        self.waves
            .iter()
            .map(|wave| wave.amplitude * (wave.speed * t + wave.phase).sin())
            .sum()
    }
}

/// Low-pass filtered Gaussian noise with unit variance: two equal first-order filters in series.
#[derive(Clone, Debug)]
pub(crate) struct SensorNoise {
    pole: f64,
    gain: f64,
    state: [f64; 2],
}

impl SensorNoise {
    /// Corner frequency and sampling rate in hertz.
    pub(crate) fn new(dice: &mut Dice, corner: f64, rate: f64) -> SensorNoise {
        let pole = (-std::f64::consts::TAU * corner / rate).exp();
        // Variance of the cascade for white input of unit variance.
        let variance = (1.0 - pole).powi(4) * (1.0 + pole * pole) / (1.0 - pole * pole).powi(3);
        let mut noise = SensorNoise {
            pole,
            gain: variance.sqrt().recip(),
            state: [0.0; 2],
        };
        // Forget the start at zero: 1/corner seconds are 2π time constants.
        for _ in 0..(rate / corner).ceil() as usize {
            noise.next(dice);
        }
        noise
    }

    pub(crate) fn next(&mut self, dice: &mut Dice) -> f64 {
        let input = dice.normal();
        self.state[0] += (1.0 - self.pole) * (input - self.state[0]);
        self.state[1] += (1.0 - self.pole) * (self.state[0] - self.state[1]);
        self.state[1] * self.gain
    }
}
