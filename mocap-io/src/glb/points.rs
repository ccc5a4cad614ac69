use std::io::Write;

use nalgebra::Vector3;
use ndarray::{ArrayView2, ArrayView3, Axis as ArrayAxis};

use super::document::Document;
use super::json::{Node, Path};
use super::mesh::Octahedra;
use crate::error::check_shape;
use crate::{FrameRate, WriteError};

/// Writes markers, or any points, as GLB: a node of its name for each, with a small octahedron, moved by
/// an animation. There is no skeleton.
///
/// `positions` has shape `(frames, names, 3)`, in metres, Y up. A point of which a coordinate is missing
/// (NaN) in a frame has no key there and is scaled to nothing until it is back, since glTF has no visibility to
/// animate; one that is never there is a node without a shape. Frame `i` is at `i / rate` seconds.
///
/// The same points give the same bytes. O(frames · names) time and memory.
///
/// # Errors
/// [`WriteError::Layout`] without any name, [`WriteError::Shape`] if names and positions do not fit,
/// [`WriteError::NotFinite`] for an infinite coordinate, [`WriteError::Limit`] for frames so many or so close
/// that single precision cannot tell their times apart and for 4 GiB or more, [`WriteError::Io`] when
/// the sink fails.
pub fn write_glb_points(
    names: &[&str],
    positions: ArrayView3<'_, f32>,
    rate: FrameRate,
    out: impl Write,
) -> Result<(), WriteError> {
    check_shape(names, positions)?;
    if names.is_empty() {
        return Err(WriteError::Layout {
            expected: "non-empty",
        });
    }
    let mut document = Document::new();
    let mut octahedron = Octahedra::default();
    octahedron.add_marker(Vector3::zeros(), 0);
    let mesh = octahedron.store(&mut document, false)?;
    let n_frames = positions.len_of(ArrayAxis(0));
    let all_times = match n_frames {
        0 => None,
        _ => Some(document.add_times(0..n_frames, rate)?),
    };
    for (name, track) in names.iter().zip(positions.axis_iter(ArrayAxis(1))) {
        let keys = keys(name, track)?;
        let node = document.nodes.len();
        document.nodes.push(Node {
            name: (*name).to_owned(),
            translation: keys.first().map(|key| key.1),
            mesh: (!keys.is_empty()).then_some(mesh),
            ..Node::default()
        });
        let (Some(all_times), false) = (all_times, keys.is_empty()) else {
            continue;
        };
        let places: Vec<[f32; 3]> = keys.iter().map(|key| key.1).collect();
        if keys.len() == n_frames {
            document.animate(node, Path::Translation, all_times, &places)?;
            continue;
        }
        let times = document.add_times(keys.iter().map(|key| key.0), rate)?;
        document.animate(node, Path::Translation, times, &places)?;
        let switches = switches(track);
        let times = document.add_times(switches.iter().map(|s| s.0), rate)?;
        let scales: Vec<[f32; 3]> = switches.iter().map(|s| s.1).collect();
        document.animate(node, Path::Scale, times, &scales)?;
    }
    let roots = (0..document.nodes.len()).collect();
    document.write(roots, out)
}

/// The frames in which a point is there, and where.
fn keys(name: &str, track: ArrayView2<'_, f32>) -> Result<Vec<(usize, [f32; 3])>, WriteError> {
    let mut keys = Vec::new();
    for (frame, place) in track.rows().into_iter().enumerate() {
        if let Some(&value) = place.iter().find(|v| v.is_infinite()) {
            return Err(WriteError::NotFinite {
                joint: name.to_owned(),
                frame,
                value: f64::from(value),
            });
        }
        if !place.iter().any(|v| v.is_nan()) {
            keys.push((frame, [place[0], place[1], place[2]]));
        }
    }
    Ok(keys)
}

/// The first frame, and those in which a point comes or goes, each with its scale from then on.
fn switches(track: ArrayView2<'_, f32>) -> Vec<(usize, [f32; 3])> {
    let mut switches: Vec<(usize, [f32; 3])> = Vec::new();
    for (frame, place) in track.rows().into_iter().enumerate() {
        let is_missing = place.iter().any(|v| v.is_nan());
        let scale = if is_missing { [0.0; 3] } else { [1.0; 3] };
        if switches.last().is_none_or(|last| last.1 != scale) {
            switches.push((frame, scale));
        }
    }
    switches
}
