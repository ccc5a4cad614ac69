//! What a C3D file holds beside positions, and where positions are missing.

use mocap_io::{C3d, Filled};
use serde::Serialize;

use crate::source::Span;

/// A C3D file's own findings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MarkersJson {
    /// Byte order and number type, such as `Intel, float`.
    pub storage: String,
    /// What the file calls its first frame.
    pub first_frame_number: u64,
    /// Missing positions, after filling.
    pub gaps: Gaps,
    /// Gaps that were filled, as asked.
    pub filled: usize,
    /// Frames in them.
    pub filled_frames: usize,
    /// Points that are no positions, such as angles.
    pub other_points: usize,
    /// Analog channels.
    pub analog_channels: usize,
    /// Samples per second of each analog channel.
    pub analog_rate: Option<f64>,
    /// What happened when.
    pub events: Vec<EventJson>,
}

/// Missing positions in the span.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Gaps {
    /// Runs of frames in which a marker is missing.
    pub count: usize,
    /// Share of all positions that is missing, 0 to 1.
    pub share: f64,
    /// The longest of them, in seconds.
    pub longest_s: f64,
    /// Markers with gaps, the worst first.
    pub markers: Vec<MarkerGaps>,
}

/// One marker's missing positions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MarkerGaps {
    /// The marker.
    pub marker: String,
    /// Gaps.
    pub count: usize,
    /// Frames in them.
    pub frames: usize,
}

/// An event.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EventJson {
    /// What happened.
    pub label: String,
    /// Whom or which side it concerns.
    pub context: Option<String>,
    /// Seconds from the first frame of the file.
    pub seconds: f64,
    /// The frame at that time, if it is in the file.
    pub frame: Option<usize>,
}

/// Findings within `span`.
pub(super) fn markers_json(c3d: &C3d, filled: &[Filled], span: Span) -> MarkersJson {
    let markers = &c3d.markers;
    let hz = markers.rate.hz();
    let analog = c3d.analog.as_ref();
    let event = |event: &mocap_io::Event| {
        let frame = (event.seconds * hz).round();
        let is_inside = frame >= 0.0 && frame < markers.n_frames() as f64;
        EventJson {
            label: event.label.clone(),
            context: event.context.clone(),
            seconds: event.seconds,
            frame: is_inside.then_some(frame as usize),
        }
    };
    MarkersJson {
        storage: format!("{:?}, {:?}", c3d.byte_order, c3d.storage).to_lowercase(),
        first_frame_number: markers.first_frame_number,
        gaps: gaps(c3d, span),
        filled: filled.len(),
        filled_frames: filled.iter().map(|gap| gap.frames.len()).sum(),
        other_points: c3d.other_points.names.len(),
        analog_channels: analog.map_or(0, |a| a.names.len()),
        analog_rate: analog.map(|a| a.rate.hz()),
        events: c3d.events.iter().map(event).collect(),
    }
}

fn gaps(c3d: &C3d, span: Span) -> Gaps {
    let markers = &c3d.markers;
    let mut all = Gaps::default();
    let mut longest = 0;
    let mut n_missing = 0;
    let mut of_marker = vec![(0, 0); markers.names.len()];
    for gap in markers.gaps() {
        let start = gap.frames.start.max(span.start);
        let n_frames = gap.frames.end.min(span.end).saturating_sub(start);
        if n_frames == 0 {
            continue;
        }
        all.count += 1;
        n_missing += n_frames;
        longest = longest.max(n_frames);
        of_marker[gap.marker].0 += 1;
        of_marker[gap.marker].1 += n_frames;
    }
    let n_positions = (span.end - span.start) * markers.names.len();
    all.share = n_missing as f64 / n_positions.max(1) as f64;
    all.longest_s = longest as f64 / markers.rate.hz();
    let named = markers.names.iter().zip(of_marker);
    let with_gaps = named.filter(|(_, (count, _))| *count > 0);
    let mut with_gaps: Vec<MarkerGaps> = with_gaps
        .map(|(name, (count, frames))| MarkerGaps {
            marker: name.clone(),
            count,
            frames,
        })
        .collect();
    with_gaps.sort_by_key(|marker| std::cmp::Reverse(marker.frames));
    all.markers = with_gaps;
    all
}
