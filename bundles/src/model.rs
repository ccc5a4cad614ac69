//! What is kept of an extraction: string, options, partition and frames; the graph follows from them.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::extract::check;
use crate::graph::link;
use crate::mapping::initial;
use crate::{
    BundleGraph, ExtractError, ExtractOptions, FrameMapping, MappingError, MotionString, Partition,
    StringBundle, Substring,
};

mod envelope;

pub use envelope::EnvelopeError;

/// A motion string, its bundles, their frames and their graph.
#[derive(Debug, Clone, PartialEq)]
pub struct BundleModel {
    string: MotionString,
    options: ExtractOptions,
    partition: Partition,
    mapping: FrameMapping,
    graph: BundleGraph,
}

/// Why parts do not make a model, or bytes are none.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("byte {at}: {kind}")]
pub struct ModelError {
    /// Where it shows, a 0-based byte offset; the start of the payload for what is wrong in there,
    /// and for parts that come from no bytes.
    pub at: usize,
    /// What is wrong.
    pub kind: ModelErrorKind,
}

/// What is wrong with a model.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ModelErrorKind {
    /// The header is not that of an intact model.
    #[error(transparent)]
    Envelope(#[from] EnvelopeError),
    /// The payload is no list of fields.
    #[error("expected the fields of a model, found {0}")]
    Payload(#[from] postcard::Error),
    /// A clip's runs are empty, alike, or beyond what can be counted.
    #[error("clip {clip}, run {run}: expected frames in a letter unlike the one before")]
    Run {
        /// Index of the clip.
        clip: usize,
        /// Index of the run in the clip.
        run: usize,
    },
    /// Options out of range, or substrings that are none of the string's.
    #[error(transparent)]
    Extract(#[from] ExtractError),
    /// Frames that are none of their letters'.
    #[error(transparent)]
    Mapping(#[from] MappingError),
    /// A bundle is not as extraction gives it.
    #[error("bundle {bundle}: expected at least 2 members in order")]
    Bundle {
        /// The bundle.
        bundle: usize,
    },
    /// Degenerate submotions are out of order or adjacent.
    #[error("expected degenerate submotions in order and apart, found letters {first}..={last}")]
    Degenerate {
        /// First letter of the later one.
        first: usize,
        /// Its last letter.
        last: usize,
    },
    /// Intervals are in no bundle.
    #[error("expected {expected} intervals in bundles, found {found}")]
    Uncovered {
        /// Intervals within clips.
        expected: usize,
        /// Intervals of all substrings.
        found: usize,
    },
}

impl From<ModelErrorKind> for ModelError {
    fn from(kind: ModelErrorKind) -> Self {
        let at = envelope::HEADER_LEN;
        Self { at, kind }
    }
}

/// The payload. Widths, volumes and the graph are computed again on reading.
#[derive(Serialize, Deserialize)]
struct Wire {
    /// Frames between the end of the clip before and the start of each clip, and the letter and
    /// number of frames of each of its runs.
    clips: Vec<(usize, Vec<(u32, usize)>)>,
    options: ExtractOptions,
    bundles: Vec<Vec<Substring>>,
    degenerate: Vec<Substring>,
    /// Of each letter with a frame, that frame, counted from the start of the letter's run.
    frames: Vec<Option<usize>>,
}

impl BundleModel {
    /// A model of the partition of all of `string` under `options`, with a frame for each end of
    /// its substrings.
    ///
    /// # Errors
    ///
    /// When the parts do not fit each other.
    pub fn new(
        string: MotionString,
        options: ExtractOptions,
        partition: Partition,
        mapping: FrameMapping,
    ) -> Result<Self, ModelError> {
        Self::checked(string, options, partition, mapping).map_err(ModelError::from)
    }

    fn checked(
        string: MotionString,
        options: ExtractOptions,
        partition: Partition,
        mapping: FrameMapping,
    ) -> Result<Self, ModelErrorKind> {
        options.check()?;
        check(&partition, &string)?;
        for (bundle, members) in partition.bundles.iter().map(|b| &b.members).enumerate() {
            if members.len() < 2 || !members.is_sorted() {
                return Err(ModelErrorKind::Bundle { bundle });
            }
        }
        for pair in partition.degenerate.windows(2) {
            if pair[0].last >= pair[1].first && !is_boundary(&string, pair[0].last, pair[1].first) {
                let Substring { first, last } = pair[1];
                return Err(ModelErrorKind::Degenerate { first, last });
            }
        }
        let clips = (0..string.n_clips()).filter_map(|clip| string.clip_span(clip));
        let expected = clips.map(|span| span.len().saturating_sub(1)).sum();
        let found = partition.substrings().map(|s| s.intervals().len()).sum();
        if expected != found {
            return Err(ModelErrorKind::Uncovered { expected, found });
        }
        // Every letter is fixed, so this checks and changes nothing.
        let position = mapping.frames.len();
        if position != string.len() {
            let found = mapping.frame(position);
            return Err(MappingError::Fixed { position, found }.into());
        }
        let mapping = initial(&string, &partition, &mapping)?;
        let graph = link(&string, &partition, &mapping).unwrap_or_default();
        Ok(Self {
            string,
            options,
            partition,
            mapping,
            graph,
        })
    }

    /// The motion string.
    pub fn string(&self) -> &MotionString {
        &self.string
    }

    /// The options of the extraction, for [`extend`](crate::extend).
    pub fn options(&self) -> &ExtractOptions {
        &self.options
    }

    /// The partition of the string.
    pub fn partition(&self) -> &Partition {
        &self.partition
    }

    /// The frames of the partition.
    pub fn mapping(&self) -> &FrameMapping {
        &self.mapping
    }

    /// The graph of the bundles.
    pub fn graph(&self) -> &BundleGraph {
        &self.graph
    }

    /// The model as bytes: magic, version, length, checksum, payload.
    ///
    /// # Errors
    ///
    /// When it is too large for memory.
    pub fn to_bytes(&self) -> Result<Vec<u8>, ModelError> {
        let runs = self.string.runs();
        let mut end = 0;
        let clips = (0..self.string.n_clips()).map(|clip| {
            let own = &runs[self.string.clip_span(clip).unwrap_or_default()];
            let start = own.first().map_or(end, |run| run.frames.start);
            let gap = start - end;
            end = own.last().map_or(end, |run| run.frames.end);
            let lengths = own.iter().map(|run| (run.letter.label(), run.frames.len()));
            (gap, lengths.collect())
        });
        let frames = runs.iter().zip(&self.mapping.frames);
        let wire = Wire {
            clips: clips.collect(),
            options: self.options,
            bundles: self
                .partition
                .bundles
                .iter()
                .map(|b| b.members.clone())
                .collect(),
            degenerate: self.partition.degenerate.clone(),
            frames: frames
                .map(|(run, frame)| frame.map(|frame| frame - run.frames.start))
                .collect(),
        };
        let payload = postcard::to_stdvec(&wire).map_err(ModelErrorKind::Payload)?;
        Ok(envelope::seal(&payload))
    }

    /// The model that [`to_bytes`](Self::to_bytes) wrote.
    ///
    /// # Errors
    ///
    /// When a byte changed, or the bytes were never a model.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ModelError> {
        let payload = envelope::open(bytes).map_err(|(at, error)| ModelError {
            at,
            kind: error.into(),
        })?;
        let (wire, rest): (Wire, _) =
            postcard::take_from_bytes(payload).map_err(ModelErrorKind::Payload)?;
        if !rest.is_empty() {
            let kind = EnvelopeError::Trailing {
                found: rest.len() as u64,
            }
            .into();
            let at = bytes.len() - rest.len();
            return Err(ModelError { at, kind });
        }
        Ok(Self::from_wire(wire)?)
    }

    fn from_wire(wire: Wire) -> Result<Self, ModelErrorKind> {
        let string = MotionString::from_lengths(&wire.clips);
        let string = string.map_err(|(clip, run)| ModelErrorKind::Run { clip, run })?;
        let rho = wire.options.rho;
        let mut bundles = Vec::with_capacity(wire.bundles.len());
        for (bundle, members) in wire.bundles.into_iter().enumerate() {
            let found = StringBundle::measured(members, &string, rho);
            bundles.push(found.ok_or(ModelErrorKind::Bundle { bundle })?);
        }
        let degenerate = wire.degenerate;
        let partition = Partition {
            bundles,
            degenerate,
        };
        let mut frames = wire.frames;
        for (position, (frame, run)) in frames.iter_mut().zip(string.runs()).enumerate() {
            let Some(offset) = *frame else { continue };
            if offset >= run.frames.len() {
                let found = Some(offset);
                return Err(MappingError::Fixed { position, found }.into());
            }
            *frame = Some(run.frames.start + offset);
        }
        Self::checked(string, wire.options, partition, FrameMapping { frames })
    }
}

/// Whether letters `a` and `b` are next to each other in different clips.
fn is_boundary(string: &MotionString, a: usize, b: usize) -> bool {
    let clip = |position: usize| string.runs().get(position).map(|run| run.clip);
    a < b && clip(a) != clip(b)
}
