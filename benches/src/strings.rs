//! Seeded motion strings: a body that goes through a few cyclic motions again and again, never twice the same way.

use bundles::{Accessibility, MotionString, PoseClusters, adjacent_distance_median, spell};
use ndarray::{Array1, Array2, ArrayView1, Axis, s};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// As many as principal components are kept.
const DIMS: usize = 10;
const N_MOTIONS: usize = 12;
const N_HARMONICS: usize = 3;
/// Frames of a cycle, on average.
const CYCLE: f64 = 120.0;
const CLIP: usize = 3_000;

/// A string, its letters and the poses behind it.
#[derive(Clone, Debug)]
pub struct Spelt {
    /// The string.
    pub string: MotionString,
    /// Distances of letters, and how near they are.
    pub access: Accessibility,
    /// Of shape `(frames, dims)`.
    pub poses: Array2<f64>,
}

fn uniform(dice: &mut ChaCha8Rng) -> f64 {
    f64::from(dice.next_u32()) / f64::from(u32::MAX) - 0.5
}

/// Poses of shape `(frames, dims)`.
fn motions(n_frames: usize, seed: u64) -> Array2<f64> {
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    let shape = (N_MOTIONS * N_HARMONICS * 2, DIMS);
    let curves = Array2::from_shape_simple_fn(shape, || uniform(&mut dice));
    let mut poses = Array2::zeros((n_frames, DIMS));
    let (mut motion, mut phase, mut speed) = (0, 0.0, 1.0);
    let mut style = Array1::<f64>::zeros(DIMS);
    for mut pose in poses.rows_mut() {
        for harmonic in 0..N_HARMONICS {
            let angle = std::f64::consts::TAU * phase * (harmonic + 1) as f64;
            let weight = 1.0 / (harmonic + 1) as f64;
            let row = (motion * N_HARMONICS + harmonic) * 2;
            pose.scaled_add(weight * angle.cos(), &curves.row(row));
            pose.scaled_add(weight * angle.sin(), &curves.row(row + 1));
        }
        pose += &style;
        // The style wanders and comes back.
        style.mapv_inplace(|x| 0.97 * x + 0.02 * uniform(&mut dice));
        phase += speed / CYCLE;
        if phase >= 1.0 {
            phase -= 1.0;
            speed = 1.0 + 0.3 * uniform(&mut dice);
            if dice.next_u32().is_multiple_of(4) {
                motion = dice.next_u32() as usize % N_MOTIONS;
            }
        }
    }
    poses
}

fn squares(a: ArrayView1<'_, f64>, b: ArrayView1<'_, f64>) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

/// A string of `n_frames` frames in clips of 3,000, in `n_letters` letters: each frame takes the nearest of as many
/// centres, which are frames themselves, refined twice.
///
/// # Panics
/// Never: frames, letters and distances are consistent.
#[must_use]
pub fn spelt(n_frames: usize, n_letters: usize, seed: u64) -> Spelt {
    let poses = motions(n_frames, seed);
    let learnt = poses.slice(s![..n_frames.min(20_000), ..]);
    let step = learnt.nrows() / n_letters;
    let mut means = learnt.slice(s![..step * n_letters; step, ..]).to_owned();
    let nearest = |means: &Array2<f64>, pose: ArrayView1<'_, f64>| {
        let distances = means.rows().into_iter().map(|mean| squares(mean, pose));
        let least = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        least.expect("there are letters").0
    };
    let mut sigmas = Array1::ones(n_letters);
    for _ in 0..2 {
        let labels: Vec<usize> = learnt
            .rows()
            .into_iter()
            .map(|p| nearest(&means, p))
            .collect();
        for letter in 0..n_letters {
            let own: Vec<usize> = (0..labels.len()).filter(|&i| labels[i] == letter).collect();
            let own = learnt.select(Axis(0), &own);
            if let Some(mean) = own.mean_axis(Axis(0)) {
                let variance: f64 = own
                    .rows()
                    .into_iter()
                    .map(|p| squares(p, mean.view()))
                    .sum();
                sigmas[letter] = (variance / (own.len() as f64)).sqrt().max(1e-2);
                means.row_mut(letter).assign(&mean);
            }
        }
    }
    let labels: Vec<u32> = poses
        .rows()
        .into_iter()
        .map(|p| nearest(&means, p) as u32)
        .collect();
    let clips = (0..n_frames)
        .step_by(CLIP)
        .map(|start| start..(start + CLIP).min(n_frames));
    let string = spell(&labels, &clips.collect::<Vec<_>>()).expect("clips in order");
    let clusters = PoseClusters::new(means.view(), sigmas.view()).expect("finite clusters");
    let tau = adjacent_distance_median(&string, &clusters).expect("known letters");
    let letter = |label: usize| bundles::Letter::from_label(label as u32);
    let distances = Array2::from_shape_fn((n_letters, n_letters), |(a, b)| {
        let distance = clusters.distance(letter(a), letter(b));
        distance.expect("known letters")
    });
    let access = Accessibility::new(distances.view(), tau.unwrap_or(0.0)).expect("distances");
    Spelt {
        string,
        access,
        poses,
    }
}
