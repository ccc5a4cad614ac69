//! `.mbg` files.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use bundles::{BundleModel, Pca, PoseClusters, Submotion};
use mocap_io::Position;
use segidx::checksum;
use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use crate::source::{ClipRef, Span};
use crate::targets;

const MAGIC: &[u8; 8] = b"MOTIFMBF";
const VERSION: u32 = 2;
/// Magic, version, length of the payload, checksum of all that and the payload.
const HEADER_LEN: usize = 28;

/// A clip of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BundleClip {
    /// Its file, as given.
    pub path: PathBuf,
    /// The skeleton that the command line named for AMC files; `None` if it is beside them.
    pub asf: Option<PathBuf>,
    /// The frames of the file that are the clip's, 0-based, end exclusive.
    pub frames: Range<usize>,
    /// Whether the command line named these frames.
    pub is_span: bool,
    /// Checksum of the bytes and the reading options that the poses come from, see
    /// [`Files::content`](crate::recording::Files::content).
    pub content: u64,
}

impl BundleClip {
    /// The clip as on the command line.
    #[must_use]
    pub fn clip(&self) -> ClipRef {
        let Range { start, end } = self.frames;
        let span = self.is_span.then_some(Span { start, end });
        let path = self.path.clone();
        ClipRef { path, span }
    }
}

/// How bundles were made, beside what [`BundleModel::options`] says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Longest submotion λ′ in frames.
    pub max_frames: f64,
    /// Letters up to so many standard deviations apart are near, τ.
    pub tau: f64,
    /// Weight of durations among the frames of a bundle.
    pub duration_weight: f64,
    /// Of everything that is drawn.
    pub seed: u64,
    /// Standard deviation, in seconds, of the weights that poses are smoothed with before they are
    /// reduced; 0 where they are not.
    pub smooth: f64,
}

/// Clips, their pose clusters and their bundles: what a `.mbg` file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Bundled {
    /// The clips; clip k is clip k of the string and of the graph.
    pub clips: Vec<BundleClip>,
    /// Frames per second of all clips.
    pub rate: f64,
    /// The dimensions of pose vectors, the same for all clips; see [`layout`](super::layout).
    pub layout: Vec<String>,
    /// From pose vectors to a few components.
    pub pca: Pca,
    /// The letters, over those components.
    pub clusters: PoseClusters,
    /// How bundles were made.
    pub settings: Settings,
    /// String, bundles, frames and graph.
    pub model: BundleModel,
    /// For each letter with a frame its pose vector, in the order of the string, so that clips can be
    /// added without reading the old ones.
    pub boundary_poses: Vec<f64>,
}

#[derive(Serialize, Deserialize)]
struct Wire {
    clips: Vec<BundleClip>,
    rate: f64,
    layout: Vec<String>,
    pca: Pca,
    clusters: PoseClusters,
    settings: Settings,
    model: Vec<u8>,
    boundary_poses: Vec<f64>,
}

impl Bundled {
    /// The clip of a submotion, and its frames in the clip's file: from the first pose to the last one,
    /// which is the first of what follows.
    #[must_use]
    pub fn source(&self, submotion: &Submotion) -> Option<(&BundleClip, Range<usize>)> {
        let clip = self.clips.get(submotion.clip)?;
        let own = self.model.graph().clips().get(submotion.clip)?;
        let Range { start, end } = submotion.span;
        let of_file = |frame: usize| Some(frame.checked_sub(own.start)? + clip.frames.start);
        Some((clip, of_file(start)?..of_file(end)?))
    }

    /// The model as bytes: magic, version, length, checksum, payload.
    ///
    /// # Errors
    ///
    /// Says why, should it not fit into memory.
    fn to_bytes(&self) -> Result<Vec<u8>, String> {
        let wire = Wire {
            clips: self.clips.clone(),
            rate: self.rate,
            layout: self.layout.clone(),
            pca: self.pca.clone(),
            clusters: self.clusters.clone(),
            settings: self.settings.clone(),
            model: self.model.to_bytes().map_err(|e| e.to_string())?,
            boundary_poses: self.boundary_poses.clone(),
        };
        let payload = postcard::to_stdvec(&wire).map_err(|e| e.to_string())?;
        let mut bytes = Vec::with_capacity(HEADER_LEN + payload.len());
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((payload.len() as u64).to_le_bytes());
        bytes.extend(digest(&bytes, &payload).to_le_bytes());
        bytes.extend(payload);
        Ok(bytes)
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, Refusal> {
        let payload = open(bytes)?;
        let inside = |message: String| Refusal {
            at: HEADER_LEN,
            message,
        };
        let wire: Wire = postcard::from_bytes(payload)
            .map_err(|e| inside(format!("expected the fields of a bundle file: {e}")))?;
        let model = BundleModel::from_bytes(&wire.model).map_err(|e| inside(e.to_string()))?;
        let bundled = Bundled {
            clips: wire.clips,
            rate: wire.rate,
            layout: wire.layout,
            pca: wire.pca,
            clusters: wire.clusters,
            settings: wire.settings,
            model,
            boundary_poses: wire.boundary_poses,
        };
        bundled.check().map_err(inside)?;
        Ok(bundled)
    }

    /// Whether the parts belong together.
    fn check(&self) -> Result<(), String> {
        let of_graph = self.model.graph().clips().iter().map(Range::len);
        let lengths = self.clips.iter().map(|clip| clip.frames.len());
        if !of_graph.eq(lengths) {
            return Err("expected the clips of the motion string".to_owned());
        }
        let dims = self.layout.len();
        if self.pca.dims() != dims || self.pca.n_components() != self.clusters.means().ncols() {
            return Err(format!("expected components of {dims} dimensions"));
        }
        let n_letters = self.model.string().runs().iter();
        if n_letters
            .map(|run| run.letter.label() as usize)
            .any(|label| label >= self.clusters.n_letters())
        {
            let n_letters = self.clusters.n_letters();
            return Err(format!("expected {n_letters} letters, found more"));
        }
        let settings = &self.settings;
        if self.boundary_poses.len() != dims * self.boundaries().count()
            || !self.boundary_poses.iter().all(|value| value.is_finite())
        {
            return Err("expected a pose for each boundary of submotions".to_owned());
        }
        let positive = [self.rate, settings.max_frames];
        let others = [settings.tau, settings.duration_weight, settings.smooth];
        let is_number = |x: &f64| x.is_finite() && *x >= 0.0;
        if !(positive.iter().all(|x| is_number(x) && *x > 0.0) && others.iter().all(is_number)) {
            return Err("expected positive settings".to_owned());
        }
        Ok(())
    }

    /// The frames at which submotions begin or end, through all clips, ascending.
    pub(crate) fn boundaries(&self) -> impl Iterator<Item = usize> {
        let mapping = self.model.mapping();
        (0..self.model.string().len()).filter_map(|position| mapping.frame(position))
    }
}

/// Why bytes are no model, and where that shows.
struct Refusal {
    at: usize,
    message: String,
}

fn open(bytes: &[u8]) -> Result<&[u8], Refusal> {
    let refuse = |at: usize, message: String| Err(Refusal { at, message });
    let Some((header, payload)) = bytes.split_first_chunk::<HEADER_LEN>() else {
        let found = bytes.len();
        let message = format!("expected a header of {HEADER_LEN} bytes, found {found}");
        return refuse(found, message);
    };
    if &header[..8] != MAGIC {
        let (expected, found) = (MAGIC.escape_ascii(), header[..8].escape_ascii());
        return refuse(
            0,
            format!("expected a bundle file ({expected:?}), found {found:?}"),
        );
    }
    let version = number(&header[8..12]);
    if version != u64::from(VERSION) {
        return refuse(8, format!("expected version {VERSION}, found {version}"));
    }
    let (expected, found) = (number(&header[12..20]), payload.len() as u64);
    if expected != found {
        let message = format!("expected {expected} bytes after the header, found {found}");
        return refuse(12, message);
    }
    let (expected, found) = (number(&header[20..]), digest(&header[..20], payload));
    if expected != found {
        let message = format!("expected the checksum {expected:#018x}, found {found:#018x}");
        return refuse(20, message);
    }
    Ok(payload)
}

/// Covers the other fields of the header, too, so that a changed bit in them is seen.
fn digest(fields: &[u8], payload: &[u8]) -> u64 {
    let sums = [fields, payload].map(|part| checksum(part).to_le_bytes());
    checksum(sums.as_flattened())
}

/// At most eight bytes, least significant first.
fn number(bytes: &[u8]) -> u64 {
    let fold = |value, &byte: &u8| value << 8 | u64::from(byte);
    bytes.iter().rev().fold(0, fold)
}

/// Reads a model.
///
/// # Errors
/// [`Failure`] with the path and the byte: a file that cannot be read, or is no intact model.
pub fn load(path: &Path) -> Result<Bundled, Failure> {
    let bytes = fs::read(path).map_err(|e| Failure::io(path, e))?;
    Bundled::from_bytes(&bytes).map_err(|Refusal { at, message }| Failure::Input {
        path: path.to_owned(),
        at: Some(Position::Binary { byte: at }),
        message,
    })
}

/// Writes a model, making the folder of `path` if need be.
///
/// # Errors
/// [`Failure`] with the path.
pub fn save(bundled: &Bundled, path: &Path) -> Result<(), Failure> {
    let bytes = bundled.to_bytes().map_err(|e| Failure::input(path, e))?;
    targets::write(path, &bytes)
}
