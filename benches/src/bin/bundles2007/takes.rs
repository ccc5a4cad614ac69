//! The takes, and how they are bundled.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use bundles::{Closure, Kappa, SeedInstance};
use cli::bundling::{Bundled, LetterRule, Poses, What, bundle};
use cli::recording::ReadOptions;
use cli::source::{ClipRef, find_clips};
use ndarray::{Array2, Axis, concatenate};

/// The paper's λ′, in frames.
pub(crate) const MAX_FRAMES: f64 = 200.0;

/// The paper's γ.
pub(crate) const GAMMA: f64 = 0.8;

/// How poses become bundles, but for the closure.
#[derive(Clone, Copy)]
pub(crate) struct How {
    pub(crate) letters: LetterRule,
    /// Deviation of the weights of smoothing, in seconds.
    pub(crate) smooth: f64,
    /// Times the paper's threshold.
    pub(crate) near: f64,
    /// Which letters bundles grow from; the seed is that of a run.
    from: SeedInstance,
}

impl How {
    /// As the paper does it: `motif bundle --method paper`.
    pub(crate) const PAPER: How = How::of(&What::paper(Kappa::Auto));

    /// As the command does it.
    pub(crate) const STEADY: How = How::of(&What::new(None));

    const fn of(what: &What) -> How {
        How {
            letters: what.letters,
            smooth: what.smooth,
            near: what.near,
            from: what.from,
        }
    }

    pub(crate) const fn smoothed(self, smooth: f64) -> How {
        How { smooth, ..self }
    }

    pub(crate) const fn near(self, near: f64) -> How {
        How { near, ..self }
    }

    pub(crate) const fn growing_from_all(self) -> How {
        let from = SeedInstance::Largest;
        How { from, ..self }
    }

    pub(crate) const fn growing_from_frequent(self) -> How {
        let from = SeedInstance::Random(0);
        How { from, ..self }
    }

    /// Where bundles grow from, drawn with this seed.
    pub(crate) fn instance(self, seed: u64) -> SeedInstance {
        match self.from {
            SeedInstance::Random(_) => SeedInstance::Random(seed),
            from => from,
        }
    }

    /// What [`How::cells`] are.
    pub(crate) const HEADS: [&str; 4] = ["letters", "smoothed, s", "near", "from"];

    pub(crate) fn cells(self) -> [String; 4] {
        let letters = match self.letters {
            LetterRule::Exemplars => "exemplars",
            LetterRule::Mixture => "mixture",
        };
        let from = match self.from {
            SeedInstance::Largest => "all",
            _ => "frequent",
        };
        [
            letters.to_owned(),
            self.smooth.to_string(),
            self.near.to_string(),
            from.to_owned(),
        ]
    }
}

/// The two methods of the command, and their names.
pub(crate) const METHODS: [(&str, How); 2] = [("steady", How::STEADY), ("paper", How::PAPER)];

/// What the tables show of both.
pub(crate) const CLOSURES: [(&str, Closure); 2] = [
    ("direct", Closure::Direct),
    ("transitive", Closure::Transitive),
];

/// Takes that are bundled together.
pub(crate) struct Set {
    pub(crate) name: &'static str,
    /// Pose clusters κ.
    pub(crate) kappa: usize,
    pub(crate) poses: Vec<Poses>,
}

/// What the paper's section 5 is repeated on.
pub(crate) struct Sets {
    /// About the paper's 5,400 frames, with its κ.
    pub(crate) boxing: Set,
    /// About the paper's 1,900 frames, with its κ.
    pub(crate) walking: Set,
    /// All walks of that subject.
    pub(crate) walks: Set,
    pub(crate) labelled: Set,
    pub(crate) exercises: Set,
    pub(crate) karate: Set,
}

/// Subjects of which no take had been looked at when the steady method was chosen.
const OTHERS: [(&str, u32); 8] = [
    ("subject 02", 2),
    ("subject 05", 5),
    ("subject 09", 9),
    ("subject 10", 10),
    ("subject 17", 17),
    ("subject 35", 35),
    ("subject 64", 64),
    ("subject 124", 124),
];

/// Frames for a letter: six letters a second.
const FRAMES_PER_LETTER: usize = 20;

/// All takes of each of the other subjects.
pub(crate) fn others(data: &Path) -> Result<Vec<Set>> {
    let of_subject = |&(name, subject): &(&'static str, u32)| {
        let folder = data.join(format!("cmu/{subject:02}"));
        let clips = find_clips(&[folder])?;
        let poses = read_clips(&clips)?;
        let n_frames: usize = poses.iter().map(|poses| poses.vectors.nrows()).sum();
        let kappa = n_frames / FRAMES_PER_LETTER;
        Ok(Set { name, kappa, poses })
    };
    OTHERS.iter().map(of_subject).collect()
}

impl Sets {
    pub(crate) fn read(data: &Path) -> Result<Sets> {
        let walks = [11..=34, 47..=47, 58..=58];
        let walks: Vec<u32> = walks.into_iter().flatten().collect();
        let set = |name, subject, takes: &[u32], kappa| {
            let poses = read(data, subject, takes)?;
            Ok::<Set, anyhow::Error>(Set { name, kappa, poses })
        };
        Ok(Sets {
            boxing: set("boxing, 14_02", 14, &[2], 250)?,
            walking: set("walking, 16_11 to 16_14", 16, &[11, 12, 13, 14], 90)?,
            walks: set("all walks of subject 16", 16, &walks, 250)?,
            labelled: set("exercises, 13_29 to 13_31", 13, &[29, 30, 31], 250)?,
            exercises: set("exercises, 14_06 14_14 14_20", 14, &[6, 14, 20], 250)?,
            karate: set(
                "karate, takes of subject 135 from 2,000 frames on",
                135,
                &[2, 3, 5, 6, 9, 10, 11],
                250,
            )?,
        })
    }

    pub(crate) fn all(&self) -> [&Set; 6] {
        [
            &self.boxing,
            &self.walking,
            &self.walks,
            &self.labelled,
            &self.exercises,
            &self.karate,
        ]
    }
}

fn read(data: &Path, subject: u32, takes: &[u32]) -> Result<Vec<Poses>> {
    let subject = format!("{subject:02}");
    let clip = |take: &u32| ClipRef {
        path: data.join(format!("cmu/{subject}/{subject}_{take:02}.amc")),
        span: None,
    };
    read_clips(&takes.iter().map(clip).collect::<Vec<_>>())
}

/// Clips of one skeleton and rate.
fn read_clips(clips: &[ClipRef]) -> Result<Vec<Poses>> {
    let of_clip = |clip: &ClipRef| {
        Poses::read(clip, &ReadOptions::default())
            .with_context(|| format!("cannot read {}", clip.path.display()))
    };
    let poses: Vec<Poses> = clips.iter().map(of_clip).collect::<Result<_>>()?;
    let first = poses.first().context("no takes")?;
    for other in &poses {
        other.check_like(&first.layout, first.rate)?;
    }
    Ok(poses)
}

impl Set {
    pub(crate) fn n_frames(&self) -> usize {
        self.poses.iter().map(|poses| poses.vectors.nrows()).sum()
    }

    /// Frames per second.
    pub(crate) fn rate(&self) -> Result<f64> {
        Ok(self.poses.first().context("no clips")?.rate)
    }

    /// Pose vectors one after the other, and the frames of each take.
    pub(crate) fn vectors(&self) -> Result<(Array2<f64>, Vec<Range<usize>>)> {
        let views: Vec<_> = self
            .poses
            .iter()
            .map(|poses| poses.vectors.view())
            .collect();
        let mut end = 0;
        let ranges = views.iter().map(|view| {
            let start = end;
            end += view.nrows();
            start..end
        });
        let ranges = ranges.collect();
        Ok((concatenate(Axis(0), &views)?, ranges))
    }

    /// As the command does it, but for what is stated.
    pub(crate) fn bundled(&self, how: How, closure: Closure) -> Result<Bundled> {
        let kappa = Kappa::Letters(NonZeroUsize::new(self.kappa).context("no letters")?);
        let what = What {
            letters: how.letters,
            gamma: GAMMA,
            closure,
            max_frames: MAX_FRAMES,
            from: how.instance(0),
            smooth: how.smooth,
            near: how.near,
            ..What::new(Some(kappa))
        };
        let bundled = bundle(&self.poses, &what)?;
        ensure!(bundled.clusters.n_letters() == self.kappa, "too few poses");
        Ok(bundled)
    }
}

/// Bundles in a word: how many, and of what.
pub(crate) struct Summary {
    pub(crate) n_bundles: usize,
    pub(crate) n_submotions: usize,
    /// Height, mean frames and volume, by descending volume.
    pub(crate) sizes: Vec<(usize, f64, f64)>,
    /// Mean frames of a submotion.
    pub(crate) mean_frames: f64,
    /// Of all frames, of those in a bundle.
    pub(crate) share: f64,
}

impl Summary {
    pub(crate) fn of(bundled: &Bundled) -> Summary {
        let bundles = bundled.model.graph().bundles();
        let size =
            |bundle: &bundles::Bundle| (bundle.height(), bundle.mean_frames(), bundle.volume);
        let mut sizes: Vec<(usize, f64, f64)> = bundles.iter().map(size).collect();
        sizes.sort_by(|a, b| b.2.total_cmp(&a.2));
        let submotions = || bundles.iter().flat_map(|bundle| &bundle.submotions);
        let n_submotions = submotions().count();
        let frames: usize = submotions().map(|submotion| submotion.span.len()).sum();
        let all: usize = bundled.clips.iter().map(|clip| clip.frames.len()).sum();
        Summary {
            n_bundles: bundles.len(),
            n_submotions,
            sizes,
            mean_frames: frames as f64 / n_submotions.max(1) as f64,
            share: frames as f64 / all.max(1) as f64,
        }
    }
}

/// A share as per cent.
pub(crate) fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}
