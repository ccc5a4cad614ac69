//! The only place where one crate's types become another's.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use mocap_io::{LengthUnit, Motion, Warning, forward_kinematics, parse_amc, parse_asf, parse_bvh};
use relfeat::{BodyMap, BodyPoint, FeatureSet, extract, source_frame};
use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use crate::source::{ClipRef, Format, Span, find_asf};

/// What the command line says about how files are to be read.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// The skeleton of AMC files.
    pub asf: Option<PathBuf>,
    /// The unit of BVH files, instead of a guess.
    pub unit: Option<LengthUnit>,
    /// Whether a warning is an error.
    pub strict: bool,
}

/// A file as it was read.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// How it was stored.
    pub format: Format,
    /// The skeleton file, for AMC.
    pub asf: Option<PathBuf>,
    /// Skeleton and motion.
    pub motion: Motion,
    /// What was odd, with the file it was odd in.
    pub warnings: Vec<(PathBuf, Warning)>,
}

/// Reads a clip. The span, if any, is checked and cut by the caller: features look beyond it.
///
/// # Errors
/// [`Failure`] with the file and the place in it.
pub fn load(path: &Path, options: &ReadOptions) -> Result<Loaded, Failure> {
    let read = |path: &Path| fs::read(path).map_err(|e| Failure::io(path, e));
    let format = Format::of(path).ok_or_else(|| {
        Failure::Usage(format!("{}: expected a .bvh or .amc file", path.display()))
    })?;
    let loaded = match format {
        Format::Bvh => {
            let mut bvh = parse_bvh(&read(path)?).map_err(|e| Failure::parse(path, &e))?;
            if let Some(unit) = options.unit {
                bvh = bvh.with_unit(unit);
            }
            let warnings = bvh
                .warnings
                .into_iter()
                .map(|w| (path.to_owned(), w))
                .collect();
            Loaded {
                format,
                asf: None,
                motion: bvh.motion,
                warnings,
            }
        }
        Format::Amc => {
            let asf_path = find_asf(path, options.asf.as_deref())?;
            let asf = parse_asf(&read(&asf_path)?).map_err(|e| Failure::parse(&asf_path, &e))?;
            let amc = parse_amc(&read(path)?, &asf).map_err(|e| Failure::parse(path, &e))?;
            let of_asf = asf.warnings.into_iter().map(|w| (asf_path.clone(), w));
            let of_amc = amc.warnings.into_iter().map(|w| (path.to_owned(), w));
            let warnings = of_asf.chain(of_amc).collect();
            Loaded {
                format,
                asf: Some(asf_path),
                motion: amc.motion,
                warnings,
            }
        }
    };
    match loaded.warnings.first() {
        Some((path, warning)) if options.strict => Err(Failure::Input {
            path: path.clone(),
            at: Some(warning.at),
            message: format!("{}: {}", warning.code(), warning.kind),
        }),
        _ => Ok(loaded),
    }
}

/// Joint names, for [`BodyMap`].
#[must_use]
pub fn joint_names(motion: &Motion) -> Vec<&str> {
    motion.skeleton.names().collect()
}

/// What a library keeps of a clip beside its words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClipMeta {
    /// Frames per second of the source file.
    pub source_rate: f64,
    /// Frames of the source file.
    pub source_frames: u64,
    /// First source frame of the clip; its words start here.
    pub first_frame: u64,
    /// One past the last source frame of the clip.
    pub end_frame: u64,
    /// First word of the whole file's words that belongs to the clip.
    pub first_word: u64,
    /// Features that the rig lacks no body point for.
    pub available: u64,
    /// The rig that placed the body points.
    pub rig: String,
}

impl ClipMeta {
    /// Source frames of the words `words` of this clip (0-based, end exclusive), such that
    /// neighbouring words have neighbouring frames and the clip's last word ends where the clip ends.
    #[must_use]
    pub fn source_span(&self, words: std::ops::Range<usize>, n_words: usize, rate: f64) -> Span {
        let frame = |word: usize| {
            let whole = word.saturating_add(self.first_word as usize);
            let frame = source_frame(whole, self.source_rate, rate);
            frame.clamp(self.first_frame as usize, self.end_frame as usize)
        };
        let start = match words.start {
            0 => self.first_frame as usize,
            word => frame(word),
        };
        let end = match words.end {
            word if word >= n_words => self.end_frame as usize,
            word => frame(word),
        };
        Span { start, end }
    }
}

/// Time spent per stage.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageTimes {
    /// Reading the file and parsing it.
    pub read: Duration,
    /// Forward kinematics.
    pub kinematics: Duration,
    /// Body map, features and words.
    pub features: Duration,
}

/// The words of a clip and what belongs to them.
#[derive(Clone, Debug)]
pub struct ClipWords {
    /// One word per step of the library rate.
    pub words: Vec<u64>,
    /// For the library.
    pub meta: ClipMeta,
    /// Body points that the features needed and the rig lacks.
    pub missing: Vec<BodyPoint>,
    /// What was odd.
    pub warnings: Vec<(PathBuf, Warning)>,
    /// Time spent.
    pub times: StageTimes,
}

/// From a file to words.
///
/// # Errors
/// [`Failure`]: a file that cannot be read, a skeleton that no rig fits, a span beyond the end.
pub fn clip_words(
    clip: &ClipRef,
    options: &ReadOptions,
    set: &FeatureSet,
    rate: f64,
) -> Result<ClipWords, Failure> {
    let start = Instant::now();
    let loaded = load(&clip.path, options)?;
    let read = start.elapsed();
    let motion = &loaded.motion;
    let span = check_span(clip, motion.n_frames())?;

    let start = Instant::now();
    let positions = forward_kinematics(motion);
    let kinematics = start.elapsed();

    let start = Instant::now();
    let map = body_map(&clip.path, motion)?;
    let extracted = extract(set, positions.view(), &map, motion.rate.hz(), rate)
        .map_err(|e| Failure::input(&clip.path, e))?;
    let mut missing: Vec<BodyPoint> = extracted
        .unavailable
        .iter()
        .flat_map(|u| u.missing.clone())
        .collect();
    missing.sort_unstable();
    missing.dedup();
    let source_rate = motion.rate.hz();
    let is_in = |k: &usize| span.range().contains(&source_frame(*k, source_rate, rate));
    let in_span: Vec<usize> = (0..extracted.words.len()).filter(is_in).collect();
    let words = in_span.iter().map(|&k| extracted.words[k]).collect();
    let features = start.elapsed();
    Ok(ClipWords {
        words,
        meta: ClipMeta {
            source_rate,
            source_frames: motion.n_frames() as u64,
            first_frame: span.start as u64,
            end_frame: span.end as u64,
            first_word: in_span.first().map_or(0, |&k| k as u64),
            available: available(set, &map),
            rig: map.rig().to_owned(),
        },
        missing,
        warnings: loaded.warnings,
        times: StageTimes {
            read,
            kinematics,
            features,
        },
    })
}

/// The body map of a motion.
///
/// # Errors
/// [`Failure::Input`] if no rig fits, with the joints there are.
pub fn body_map(path: &Path, motion: &Motion) -> Result<BodyMap, Failure> {
    let names = joint_names(motion);
    BodyMap::recognise(&names).ok_or_else(|| {
        let some: Vec<&str> = names.iter().take(8).copied().collect();
        let dots = if names.len() > some.len() {
            ", …"
        } else {
            ""
        };
        Failure::input(
            path,
            format!("no known rig has these joints: {}{dots}", some.join(", ")),
        )
    })
}

/// The bits of the features that can be computed with a body map.
#[must_use]
pub fn available(set: &FeatureSet, map: &BodyMap) -> u64 {
    set.unavailable(map)
        .iter()
        .fold(set.all(), |bits, gone| bits & !(1 << gone.feature_idx))
}

/// The clip's span, or all frames.
///
/// # Errors
/// [`Failure::Input`] for a span that reaches beyond the file.
pub fn check_span(clip: &ClipRef, n_frames: usize) -> Result<Span, Failure> {
    match clip.span {
        None => Ok(Span {
            start: 0,
            end: n_frames,
        }),
        Some(span) if span.end <= n_frames => Ok(span),
        Some(span) => Err(Failure::input(
            &clip.path,
            format!(
                "expected a span within 0-{n_frames}, found {}-{}",
                span.start, span.end
            ),
        )),
    }
}
