//! Files as recordings, whatever their format.

use std::fs;
use std::path::{Path, PathBuf};

use mocap_io::{
    C3d, Filled, FrameRate, LengthUnit, Motion, RateSource, UnitSource, UpAxis, UpSource, Warning,
    forward_kinematics, parse_amc, parse_asf, parse_bvh, parse_c3d,
};
use ndarray::Array3;
use relfeat::{BodyMap, Rig};
use segidx::checksum;

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
    /// Labelled points, and what was recorded beside them.
    Markers(Box<C3d>),
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
    /// Gaps of markers that were filled, as asked.
    pub filled: Vec<Filled>,
    /// What was odd, with the file it was odd in.
    pub warnings: Vec<(PathBuf, Warning)>,
}

impl Recording {
    /// Names of joints or markers, for [`BodyMap`].
    #[must_use]
    pub fn names(&self) -> Vec<&str> {
        match self {
            Recording::Joints(motion) => motion.skeleton.names().collect(),
            Recording::Markers(c3d) => c3d.markers.names.iter().map(String::as_str).collect(),
        }
    }

    /// Shape `(frames, joints, 3)`, metres, Y up.
    #[must_use]
    pub fn positions(&self) -> Array3<f32> {
        match self {
            Recording::Joints(motion) => forward_kinematics(motion),
            Recording::Markers(c3d) => c3d.markers.positions_y_up(),
        }
    }

    /// Number of frames.
    #[must_use]
    pub fn n_frames(&self) -> usize {
        match self {
            Recording::Joints(motion) => motion.n_frames(),
            Recording::Markers(c3d) => c3d.markers.n_frames(),
        }
    }

    /// Frames per second, and where they come from.
    #[must_use]
    pub fn rate(&self) -> (FrameRate, RateSource) {
        match self {
            Recording::Joints(motion) => (motion.rate, motion.rate_source),
            Recording::Markers(c3d) => (c3d.markers.rate, c3d.markers.rate_source),
        }
    }

    /// Unit of length, and where it comes from.
    #[must_use]
    pub fn unit(&self) -> (LengthUnit, UnitSource) {
        match self {
            Recording::Joints(motion) => (motion.unit, motion.unit_source),
            Recording::Markers(c3d) => (c3d.markers.unit, c3d.markers.unit_source),
        }
    }

    /// Up axis, and where it comes from.
    #[must_use]
    pub fn up(&self) -> (UpAxis, UpSource) {
        match self {
            Recording::Joints(motion) => (motion.up, motion.up_source),
            Recording::Markers(c3d) => (c3d.markers.up, c3d.markers.up_source),
        }
    }

    /// Bones as pairs (parent, child); none between markers.
    #[must_use]
    pub fn bones(&self) -> Vec<(usize, usize)> {
        match self {
            Recording::Joints(motion) => motion.skeleton.bones().collect(),
            Recording::Markers(_) => Vec::new(),
        }
    }

    /// The skeleton and its motion, if there is one.
    #[must_use]
    pub fn motion(&self) -> Option<&Motion> {
        match self {
            Recording::Joints(motion) => Some(motion),
            Recording::Markers(_) => None,
        }
    }

    /// What a C3D file holds.
    #[must_use]
    pub fn c3d(&self) -> Option<&C3d> {
        match self {
            Recording::Joints(_) => None,
            Recording::Markers(c3d) => Some(c3d),
        }
    }

    /// Puts what the user says in place of what the file says.
    fn overrule(&mut self, options: &ReadOptions) {
        let (rate, unit, up) = match self {
            Recording::Joints(m) => (
                (&mut m.rate, &mut m.rate_source),
                (&mut m.unit, &mut m.unit_source),
                (&mut m.up, &mut m.up_source),
            ),
            Recording::Markers(c3d) => {
                let m = &mut c3d.markers;
                (
                    (&mut m.rate, &mut m.rate_source),
                    (&mut m.unit, &mut m.unit_source),
                    (&mut m.up, &mut m.up_source),
                )
            }
        };
        if let Some(given) = options.rate {
            (*rate.0, *rate.1) = (given, RateSource::Given);
        }
        if let Some(given) = options.unit {
            (*unit.0, *unit.1) = (given, UnitSource::Given);
        }
        if let Some(given) = options.up {
            (*up.0, *up.1) = (given, UpSource::Given);
        }
    }

    /// Fills the gaps of markers that are no longer than asked.
    fn fill(&mut self, options: &ReadOptions) -> Vec<Filled> {
        match (self, options.fill) {
            (Recording::Markers(c3d), Some(seconds)) => {
                let (markers, filled) = c3d.markers.filled(seconds);
                c3d.markers = markers;
                filled
            }
            _ => Vec::new(),
        }
    }
}

/// The bytes of a clip, before they are parsed.
#[derive(Clone, Debug)]
pub struct Files {
    format: Format,
    bytes: Vec<u8>,
    /// The skeleton of an AMC file.
    asf: Option<(PathBuf, Vec<u8>)>,
}

impl Files {
    /// Reads the files of a clip.
    ///
    /// # Errors
    /// [`Failure`] for a file that cannot be read, or is in no format that is.
    pub fn read(path: &Path, options: &ReadOptions) -> Result<Files, Failure> {
        let read = |path: &Path| fs::read(path).map_err(|e| Failure::io(path, e));
        let bytes = read(path)?;
        let format = Format::of(path).or_else(|| Format::sniff(&bytes));
        let format = format.ok_or_else(|| Failure::Usage(unknown_format(path)))?;
        let asf = match format {
            Format::Amc => {
                let found = find_asf(path, options.asf.as_deref())?;
                let bytes = read(&found)?;
                Some((found, bytes))
            }
            _ => None,
        };
        Ok(Files { format, bytes, asf })
    }

    /// The bytes of a file that needs no other beside it.
    pub(crate) fn of_bytes(format: Format, bytes: Vec<u8>) -> Files {
        let asf = None;
        Files { format, bytes, asf }
    }

    /// A checksum of everything that the words of the clip come from, except the feature set and the
    /// rate of the library: the files, the options, and the program.
    #[must_use]
    pub fn content(&self, options: &ReadOptions) -> u64 {
        let ReadOptions {
            asf: _, // Its bytes count.
            rate,
            unit,
            up,
            rig,
            fill,
            strict: _, // Refuses clips, but changes none.
        } = options;
        let version = env!("CARGO_PKG_VERSION");
        let options = format!("{version} {rate:?} {unit:?} {up:?} {rig:?} {fill:?}");
        let asf = self.asf.as_ref().map_or(&[][..], |(_, bytes)| bytes);
        let sums = [options.as_bytes(), asf, &self.bytes].map(|part| checksum(part).to_le_bytes());
        checksum(sums.as_flattened())
    }
}

/// Reads a clip. The span, if any, is checked and cut by the caller: features look beyond it.
///
/// # Errors
/// [`Failure`] with the file and the place in it.
pub fn load(path: &Path, options: &ReadOptions) -> Result<Loaded, Failure> {
    parse(path, Files::read(path, options)?, options)
}

/// A clip from its bytes; `path` is for errors and warnings.
///
/// # Errors
/// [`Failure`] with the file and the place in it.
pub fn parse(path: &Path, files: Files, options: &ReadOptions) -> Result<Loaded, Failure> {
    let Files { format, bytes, asf } = files;
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
            let motion = match options.up {
                Some(_) => bvh.motion,
                None => bvh.motion.with_guessed_up(),
            };
            (Recording::Joints(motion), warnings)
        }
        Format::Amc => {
            // There is one: an AMC file was read with its skeleton.
            let (found, asf) = asf.unwrap_or_default();
            let asf = parse_asf(&asf).map_err(|e| Failure::parse(&found, &e))?;
            let amc = parse_amc(&bytes, &asf).map_err(refused)?;
            let mut warnings = named(asf.warnings, &found);
            warnings.extend(named(amc.warnings, path));
            asf_path = Some(found);
            (Recording::Joints(amc.motion), warnings)
        }
        Format::C3d => {
            let c3d = parse_c3d(&bytes).map_err(refused)?;
            let warnings = named(c3d.warnings.clone(), path);
            (Recording::Markers(Box::new(c3d)), warnings)
        }
        Format::Asf => {
            let asf = parse_asf(&bytes).map_err(refused)?;
            // The motion of no frames, at the rate that such motions have.
            let none = parse_amc(b"", &asf).map_err(refused)?;
            (Recording::Joints(none.motion), named(asf.warnings, path))
        }
    };
    recording.overrule(options);
    let filled = recording.fill(options);
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
            filled,
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
    map_of(path, &recording.names(), options)
}

/// The body map of joints or markers of these names: by the rig given, or by the one recognised.
///
/// # Errors
/// [`Failure::Input`] if no rig fits, with the joints there are.
pub(crate) fn map_of(
    path: &Path,
    names: &[&str],
    options: &ReadOptions,
) -> Result<BodyMap, Failure> {
    let map = match &options.rig {
        Some(rig) => Some(BodyMap::with_rig(names, rig)).filter(|map| map.n_placed() > 0),
        None => BodyMap::recognise(names),
    };
    map.ok_or_else(|| {
        let some: Vec<&str> = names.iter().take(8).copied().collect();
        let dots = if names.len() > some.len() {
            ", …"
        } else {
            ""
        };
        let rig = match &options.rig {
            Some(rig) => format!("the rig {} finds none of its names among", rig.name),
            None => "no known rig has".to_owned(),
        };
        Failure::input(
            path,
            format!("{rig} these names: {}{dots}", some.join(", ")),
        )
    })
}
