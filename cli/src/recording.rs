//! Files as recordings, whatever their format.

use std::fs;
use std::path::{Path, PathBuf};

use mocap_io::{
    FrameRate, LengthUnit, Motion, RateSource, UnitSource, UpAxis, UpSource, Warning,
    forward_kinematics, parse_amc, parse_asf, parse_bvh,
};
use ndarray::{Array2, Array3};
use relfeat::{BodyMap, Rig};

use crate::failure::Failure;
use crate::source::{Format, find_asf};

/// What the command line says about how files are to be read.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// The skeleton of AMC files.
    pub asf: Option<PathBuf>,
    /// The rate, whatever the file says.
    pub rate: Option<FrameRate>,
    /// The unit, whatever the file says.
    pub unit: Option<LengthUnit>,
    /// The up axis, whatever the file says.
    pub up: Option<UpAxis>,
    /// The rig, whatever would be recognised.
    pub rig: Option<Rig>,
    /// Longest gap of a marker that is filled, in seconds.
    pub fill: Option<f64>,
    /// Whether a warning is an error.
    pub strict: bool,
}

/// What a file holds.
#[derive(Clone, Debug)]
pub enum Recording {
    /// A skeleton and its motion.
    Joints(Motion),
}

/// A file as it was read.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// How it was stored.
    pub format: Format,
    /// The skeleton file, for AMC.
    pub asf: Option<PathBuf>,
    /// What it holds.
    pub recording: Recording,
    /// What was odd, with the file it was odd in.
    pub warnings: Vec<(PathBuf, Warning)>,
}

impl Recording {
    /// Names of joints or markers, for [`BodyMap`].
    #[must_use]
    pub fn names(&self) -> Vec<&str> {
        match self {
            Recording::Joints(motion) => motion.skeleton.names().collect(),
        }
    }

    /// Shape `(frames, joints, 3)`, metres, Y up.
    #[must_use]
    pub fn positions(&self) -> Array3<f32> {
        match self {
            Recording::Joints(motion) => forward_kinematics(motion),
        }
    }

    /// Number of frames.
    #[must_use]
    pub fn n_frames(&self) -> usize {
        match self {
            Recording::Joints(motion) => motion.n_frames(),
        }
    }

    /// Frames per second, and where they come from.
    #[must_use]
    pub fn rate(&self) -> (FrameRate, RateSource) {
        match self {
            Recording::Joints(motion) => (motion.rate, motion.rate_source),
        }
    }

    /// Unit of length, and where it comes from.
    #[must_use]
    pub fn unit(&self) -> (LengthUnit, UnitSource) {
        match self {
            Recording::Joints(motion) => (motion.unit, motion.unit_source),
        }
    }

    /// Up axis, and where it comes from.
    #[must_use]
    pub fn up(&self) -> (UpAxis, UpSource) {
        match self {
            Recording::Joints(motion) => (motion.up, motion.up_source),
        }
    }

    /// Bones as pairs (parent, child); none between markers.
    #[must_use]
    pub fn bones(&self) -> Vec<(usize, usize)> {
        match self {
            Recording::Joints(motion) => motion.skeleton.bones().collect(),
        }
    }

    /// The skeleton and its motion, if there is one.
    #[must_use]
    pub fn motion(&self) -> Option<&Motion> {
        match self {
            Recording::Joints(motion) => Some(motion),
        }
    }

    fn overrule(&mut self, options: &ReadOptions) {
        match self {
            Recording::Joints(motion) => {
                if let Some(rate) = options.rate {
                    (motion.rate, motion.rate_source) = (rate, RateSource::Given);
                }
                if let Some(unit) = options.unit {
                    (motion.unit, motion.unit_source) = (unit, UnitSource::Given);
                }
                if let Some(up) = options.up {
                    (motion.up, motion.up_source) = (up, UpSource::Given);
                }
            }
        }
    }
}

/// Reads a clip. The span, if any, is checked and cut by the caller: features look beyond it.
///
/// # Errors
/// [`Failure`] with the file and the place in it.
pub fn load(path: &Path, options: &ReadOptions) -> Result<Loaded, Failure> {
    let read = |path: &Path| fs::read(path).map_err(|e| Failure::io(path, e));
    let bytes = read(path)?;
    let format = Format::of(path).or_else(|| Format::sniff(&bytes));
    let format = format.ok_or_else(|| Failure::Usage(unknown_format(path)))?;
    let named = |warnings: Vec<Warning>, path: &Path| -> Vec<(PathBuf, Warning)> {
        let of_path = warnings.into_iter().map(|w| (path.to_owned(), w));
        of_path.collect()
    };
    let refused = |e| Failure::parse(path, &e);
    let mut asf_path = None;
    let (mut recording, warnings) = match format {
        Format::Bvh => {
            let bvh = parse_bvh(&bytes).map_err(refused)?;
            let warnings = named(bvh.warnings, path);
            (Recording::Joints(bvh.motion), warnings)
        }
        Format::Amc => {
            let found = find_asf(path, options.asf.as_deref())?;
            let asf = parse_asf(&read(&found)?).map_err(|e| Failure::parse(&found, &e))?;
            let amc = parse_amc(&bytes, &asf).map_err(refused)?;
            let mut warnings = named(asf.warnings, &found);
            warnings.extend(named(amc.warnings, path));
            asf_path = Some(found);
            (Recording::Joints(amc.motion), warnings)
        }
        Format::Asf => {
            let asf = parse_asf(&bytes).map_err(refused)?;
            let no_frames = Array2::zeros((0, asf.skeleton.n_channels()));
            let rate = FrameRate::from_hz(120.0)
                .ok_or_else(|| Failure::input(path, "a skeleton without rate"))?;
            let mut motion = Motion::new(asf.skeleton, no_frames, rate, asf.unit)
                .map_err(|e| Failure::input(path, e))?;
            (motion.rate_source, motion.unit_source) = (RateSource::Default, UnitSource::File);
            motion.up_source = UpSource::Default;
            (Recording::Joints(motion), named(asf.warnings, path))
        }
    };
    recording.overrule(options);
    match warnings.first() {
        Some((path, warning)) if options.strict => Err(Failure::Input {
            path: path.clone(),
            at: Some(warning.at),
            message: format!("{}: {}", warning.code(), warning.kind),
        }),
        _ => Ok(Loaded {
            format,
            asf: asf_path,
            recording,
            warnings,
        }),
    }
}

/// That a file is in no format that is read.
pub(crate) fn unknown_format(path: &Path) -> String {
    format!("{}: expected a .bvh, .amc or .c3d file", path.display())
}

/// The body map of a recording: by the rig given, or by the one recognised.
///
/// # Errors
/// [`Failure::Input`] if no rig fits, with the joints there are.
pub fn body_map(
    path: &Path,
    recording: &Recording,
    options: &ReadOptions,
) -> Result<BodyMap, Failure> {
    let names = recording.names();
    let map = match &options.rig {
        Some(rig) => Some(BodyMap::with_rig(&names, rig)).filter(|map| map.n_placed() > 0),
        None => BodyMap::recognise(&names),
    };
    map.ok_or_else(|| {
        let some: Vec<&str> = names.iter().take(8).copied().collect();
        let dots = if names.len() > some.len() {
            ", …"
        } else {
            ""
        };
        let rig = match &options.rig {
            Some(rig) => format!("the rig {} finds none of its joints among", rig.name),
            None => "no known rig has".to_owned(),
        };
        Failure::input(
            path,
            format!("{rig} these joints: {}{dots}", some.join(", ")),
        )
    })
}
