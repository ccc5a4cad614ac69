//! From clips to bundles, and more clips to the bundles there are.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;

use bundles::{
    Accessibility, BundleModel, Closure, EmOptions, ExtractOptions, Kappa, LabelRule,
    MappingOptions, MixtureError, MotionString, PAPER_SHARE, Partition, Pca, PoseClusters,
    SeedInstance, adjacent_distance_median, exemplars, extend, extract, fit_mixture, map_frames,
    max_letters, spell,
};
use mocap_io::Warning;
use ndarray::{Array2, ArrayView2, Axis, concatenate, s};

use super::{BundleClip, Bundled, Settings, layout, pose_vectors, smoothed, smoothed_clips};
use crate::failure::Failure;
use crate::recording::{Files, ReadOptions, parse};
use crate::source::ClipRef;
use crate::wire::check_span;

/// What letters are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LetterRule {
    /// Poses at even distances in time.
    Exemplars,
    /// An isotropic Gaussian mixture, as the paper has it.
    Mixture,
}

/// Letters for each second, if nobody says how many; the paper has 5.6, 250 for 5,400 frames at 120 Hz.
const LETTERS_PER_SECOND: f64 = 6.0;

/// Letters at most, if nobody says how many: their distances are a table of this size squared.
const MOST_LETTERS: usize = 2_000;

/// What makes bundles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct What {
    /// What letters are.
    pub letters: LetterRule,
    /// Number of pose clusters κ; if none is said, six for each second, at most 2,000.
    pub kappa: Option<Kappa>,
    /// Bias ρ towards long submotions.
    pub rho: f64,
    /// Least ratio γ of widths in a bundle.
    pub gamma: f64,
    /// How far similarity is followed.
    pub closure: Closure,
    /// What a model keeps beside these; the threshold is computed.
    pub max_frames: f64,
    /// Weight of durations when frames are chosen.
    pub duration_weight: f64,
    /// Of everything that is drawn, but for the letters that bundles grow from.
    pub seed: u64,
    /// Which letters bundles grow from.
    pub from: SeedInstance,
    /// Standard deviation, in seconds, of the weights that poses are smoothed with before their
    /// components are taken; 0 leaves them as they are, as the paper does.
    pub smooth: f64,
    /// How many times the paper's threshold τ, the median distance of adjacent letters, near letters
    /// are apart at most; the paper's is 1.
    pub near: f64,
}

impl What {
    /// What `motif bundle` makes if nothing else is asked. It differs from [`What::paper`] in what a little
    /// noise, or another seed, would turn into other bundles: letters are poses at even distances in time,
    /// poses are smoothed before, each bundle is the largest there is, and similarity is followed to its seed
    /// alone.
    #[must_use]
    pub const fn new(kappa: Option<Kappa>) -> What {
        What {
            letters: LetterRule::Exemplars,
            kappa,
            closure: Closure::Direct,
            from: SeedInstance::Largest,
            smooth: 0.1,
            ..What::paper(Kappa::Auto)
        }
    }

    /// The paper's values and ways, seed 0.
    #[must_use]
    pub const fn paper(kappa: Kappa) -> What {
        What {
            letters: LetterRule::Mixture,
            kappa: Some(kappa),
            rho: 1.0,
            gamma: 0.8,
            closure: Closure::Transitive,
            max_frames: 200.0,
            duration_weight: 1.0,
            seed: 0,
            from: SeedInstance::Random(0),
            smooth: 0.0,
            near: 1.0,
        }
    }
}

/// A clip and its pose vectors.
#[derive(Clone, Debug)]
pub struct Poses {
    /// The clip.
    pub clip: BundleClip,
    /// Frames per second.
    pub rate: f64,
    /// What the dimensions are.
    pub layout: Vec<String>,
    /// Shape `(frames, dims)`, the frames being those of the clip.
    pub vectors: Array2<f64>,
    /// What was odd about the file.
    pub warnings: Vec<(PathBuf, Warning)>,
}

impl Poses {
    /// Reads a clip. Its first and last frames move as they do in the whole file.
    ///
    /// # Errors
    /// [`Failure`]: a file that cannot be read, that holds markers, or whose poses make no vectors; a span
    /// beyond its end; no frames.
    pub fn read(clip: &ClipRef, options: &ReadOptions) -> Result<Poses, Failure> {
        let refused = |message: String| Failure::input(&clip.path, message);
        let files = Files::read(&clip.path, options)?;
        let content = files.content(options);
        let loaded = parse(&clip.path, files, options)?;
        let Some(motion) = loaded.recording.motion() else {
            let message = "bundles need a skeleton that turns, and this file holds markers";
            return Err(refused(message.to_owned()));
        };
        let frames = check_span(clip, motion.n_frames())?.range();
        if frames.is_empty() {
            return Err(refused("expected frames, found none".to_owned()));
        }
        let all = pose_vectors(motion).map_err(|e| refused(e.to_string()))?;
        Ok(Poses {
            rate: motion.rate.hz(),
            layout: layout(motion),
            vectors: all.slice(s![frames.clone(), ..]).to_owned(),
            clip: BundleClip {
                path: clip.path.clone(),
                asf: options.asf.clone(),
                is_span: clip.span.is_some(),
                frames,
                content,
            },
            warnings: loaded.warnings,
        })
    }

    /// Checks that the clip has the dimensions and the rate of a model, or of its first clip.
    ///
    /// # Errors
    /// [`Failure::Input`] with the first dimension that differs.
    pub fn check_like(&self, layout: &[String], rate: f64) -> Result<(), Failure> {
        let refuse = |message| Err(Failure::input(&self.clip.path, message));
        let mut pairs = self.layout.iter().zip(layout);
        if let Some((found, expected)) = pairs.find(|(own, other)| own != other) {
            return refuse(format!(
                "expected the skeleton of the first clip with {expected:?}, found {found:?}"
            ));
        }
        if self.layout.len() != layout.len() {
            let (expected, found) = (layout.len(), self.layout.len());
            return refuse(format!(
                "expected the skeleton of the first clip with {expected} dimensions, found {found}"
            ));
        }
        if (self.rate - rate).abs() > RATE_TOLERANCE * rate {
            let found = self.rate;
            return refuse(format!(
                "expected the {rate} frames per second of the first clip, found {found}; see motif convert --rate"
            ));
        }
        Ok(())
    }
}

/// Rates this close, relative to each other, are the same: files round the time of a frame.
const RATE_TOLERANCE: f64 = 1e-3;

/// An error of a step that has no file.
fn failed(step: &'static str) -> impl Fn(String) -> Failure {
    move |message| Failure::Usage(format!("{step}: {message}"))
}

/// Bundles of clips of one layout and rate.
///
/// # Errors
/// [`Failure::Usage`] with the step: there are no clips, or an option is out of its range.
pub fn bundle(clips: &[Poses], what: &What) -> Result<Bundled, Failure> {
    let views: Vec<ArrayView2<'_, f64>> = clips.iter().map(|clip| clip.vectors.view()).collect();
    let vectors = concatenate(Axis(0), &views).map_err(|e| failed("poses")(e.to_string()))?;
    let own: Vec<BundleClip> = clips.iter().map(|clip| clip.clip.clone()).collect();
    let rate = clips.first().map_or(1.0, |clip| clip.rate);
    let ranges = ranges(&own);
    let poses = smoothed_clips(vectors.view(), &ranges, what.smooth * rate);
    let pca = Pca::fit(poses.view(), PAPER_SHARE)
        .map_err(|e| failed("principal components")(e.to_string()))?;
    let reduced = pca.project(poses.view());
    let reduced = reduced.map_err(|e| failed("principal components")(e.to_string()))?;
    let clusters = clusters(reduced.view(), rate, what);
    let clusters = clusters.map_err(|e| failed("pose clusters")(e.to_string()))?;
    let string = spelt(&clusters, reduced.view(), &ranges)?;
    let tau = adjacent_distance_median(&string, &clusters);
    // Where every clip stays within one letter, no letter is near another.
    let tau = tau
        .map_err(|e| failed("threshold")(e.to_string()))?
        .unwrap_or(0.0);
    let tau = what.near * tau;
    let options = ExtractOptions {
        rho: what.rho,
        gamma: what.gamma,
        closure: what.closure,
        seed: what.from,
        ..ExtractOptions::new(max_letters(&string, what.max_frames))
    };
    let partition = extract(&string, &accessibility(&clusters, tau)?, &options);
    let partition = partition.map_err(|e| failed("bundles")(e.to_string()))?;
    let settings = Settings {
        max_frames: what.max_frames,
        tau,
        duration_weight: what.duration_weight,
        seed: what.seed,
        smooth: what.smooth,
    };
    let mapping = mapping_options(&settings);
    let model = placed(string, options, partition, (vectors.view(), &mapping))?;
    let first = clips.first();
    let bundled = Bundled {
        rate,
        layout: first.map_or_else(Vec::new, |clip| clip.layout.clone()),
        clips: own,
        pca,
        clusters,
        settings,
        model,
        boundary_poses: Vec::new(),
    };
    Ok(with_boundary_poses(bundled, vectors.view()))
}

fn clusters(
    poses: ArrayView2<'_, f64>,
    rate: f64,
    what: &What,
) -> Result<PoseClusters, MixtureError> {
    let by_time = || {
        let seconds = poses.nrows() as f64 / rate;
        let n_letters = ((LETTERS_PER_SECOND * seconds) as usize).min(MOST_LETTERS);
        Kappa::Letters(NonZeroUsize::new(n_letters).unwrap_or(NonZeroUsize::MIN))
    };
    let kappa = what.kappa.unwrap_or_else(by_time);
    let mixture = || {
        let em = EmOptions {
            seed: what.seed,
            ..EmOptions::new(kappa)
        };
        Ok(fit_mixture(poses, &em)?.clusters)
    };
    match (what.letters, kappa) {
        (LetterRule::Mixture, _) => mixture(),
        (LetterRule::Exemplars, Kappa::Letters(n_letters)) => exemplars(poses, n_letters),
        // The criterion is that of a mixture.
        (LetterRule::Exemplars, Kappa::Auto) => {
            let n_letters = NonZeroUsize::new(mixture()?.n_letters());
            exemplars(poses, n_letters.unwrap_or(NonZeroUsize::MIN))
        }
    }
}

/// A model and further clips: labels of the old clusters, the old bundles with new members, and new
/// bundles of what remains. Nothing old changes; the old clips are not read.
///
/// # Errors
/// [`Failure::Usage`] with the step that fails.
pub fn extended(old: &Bundled, clips: &[Poses]) -> Result<Bundled, Failure> {
    let mut all = old.clips.clone();
    all.extend(clips.iter().map(|clip| clip.clip.clone()));
    let ranges = ranges(&all);
    let n_frames = ranges.last().map_or(0, |range| range.end);
    // Of the old clips only poses at boundaries count, since these stay where they are.
    let mut vectors = Array2::zeros((n_frames, old.layout.len()));
    let kept = old.boundary_poses.chunks_exact(old.layout.len().max(1));
    for (frame, pose) in old.boundaries().zip(kept) {
        vectors.row_mut(frame).assign(&ndarray::aview1(pose));
    }
    let mut labels: Vec<u32> = Vec::with_capacity(n_frames);
    for run in old.model.string().runs() {
        labels.extend(run.frames.clone().map(|_| run.letter.label()));
    }
    for (clip, range) in clips.iter().zip(&ranges[old.clips.len()..]) {
        vectors
            .slice_mut(s![range.clone(), ..])
            .assign(&clip.vectors);
        let poses = smoothed(clip.vectors.view(), old.settings.smooth * old.rate);
        let reduced = old.pca.project(poses.view());
        let reduced = reduced.map_err(|e| failed("principal components")(e.to_string()))?;
        let found = old.clusters.label(reduced.view(), LabelRule::Likelihood);
        labels.extend(found.map_err(|e| failed("labels")(e.to_string()))?);
    }
    let string = spell(&labels, &ranges).map_err(|e| failed("labels")(e.to_string()))?;
    let access = accessibility(&old.clusters, old.settings.tau)?;
    let options = *old.model.options();
    let partition = extend(old.model.partition(), &string, &access, &options);
    let partition = partition.map_err(|e| failed("bundles")(e.to_string()))?;
    let mapping = MappingOptions {
        fixed: old.model.mapping().clone(),
        ..mapping_options(&old.settings)
    };
    let model = placed(string, options, partition, (vectors.view(), &mapping))?;
    let bundled = Bundled {
        clips: all,
        model,
        ..old.clone()
    };
    Ok(with_boundary_poses(bundled, vectors.view()))
}

/// The frames of clips that follow each other.
fn ranges(clips: &[BundleClip]) -> Vec<Range<usize>> {
    let mut end = 0;
    let of_clip = clips.iter().map(|clip| {
        let start = end;
        end += clip.frames.len();
        start..end
    });
    of_clip.collect()
}

fn spelt(
    clusters: &PoseClusters,
    reduced: ArrayView2<'_, f64>,
    ranges: &[Range<usize>],
) -> Result<MotionString, Failure> {
    let labels = clusters.label(reduced, LabelRule::Likelihood);
    let labels = labels.map_err(|e| failed("labels")(e.to_string()))?;
    spell(&labels, ranges).map_err(|e| failed("labels")(e.to_string()))
}

fn accessibility(clusters: &PoseClusters, tau: f64) -> Result<Accessibility, Failure> {
    let access = Accessibility::new(clusters.distances().view(), tau);
    access.map_err(|e| failed("letters")(e.to_string()))
}

fn mapping_options(settings: &Settings) -> MappingOptions {
    MappingOptions {
        duration_weight: settings.duration_weight,
        seed: settings.seed,
        ..MappingOptions::default()
    }
}

/// Chooses the frames of a partition.
fn placed(
    string: MotionString,
    options: ExtractOptions,
    partition: Partition,
    (poses, mapping): (ArrayView2<'_, f64>, &MappingOptions),
) -> Result<BundleModel, Failure> {
    let mapping = map_frames(&string, &partition, poses, mapping);
    let mapping = mapping.map_err(|e| failed("frames")(e.to_string()))?;
    let model = BundleModel::new(string, options, partition, mapping);
    model.map_err(|e| failed("graph")(e.to_string()))
}

fn with_boundary_poses(bundled: Bundled, poses: ArrayView2<'_, f64>) -> Bundled {
    let rows = bundled.boundaries().map(|frame| poses.row(frame).to_vec());
    Bundled {
        boundary_poses: rows.collect::<Vec<_>>().concat(),
        ..bundled
    }
}
