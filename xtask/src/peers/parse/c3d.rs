//! A C3D of float points in Intel order, without analog channels.
//!
//! Source: The C3D File Format User Guide (c3d.org): a header of one block, parameters, points of
//! four words: x, y, z, and cameras with residual.

use super::super::Fact;
use super::super::dice::Dice;
use super::data::{N_FRAMES, frames, sum};

const BLOCK: usize = 512;
const N_MARKERS: usize = 41;
const RATE: f32 = 120.0;
/// Negative: points are floats. Its magnitude is the unit of residuals, in millimetres.
const SCALE: f32 = -0.1;
const PARAMETER_BLOCK: u8 = 2;
const KEY: u8 = 0x50;
const INTEL: u8 = 84;

type Point = [f32; 4];

/// Markers that wander, in millimetres, each with its word of cameras and residual.
pub(super) fn markers(dice: &mut Dice) -> Vec<[Point; N_MARKERS]> {
    const SPREAD: f64 = 500.0;
    const STEP: f64 = 2.0;
    const CAMERAS: u8 = 0b0001_1111;
    const RESIDUALS: f64 = 20.0;
    let mut places: [[f64; 3]; N_MARKERS] =
        std::array::from_fn(|_| std::array::from_fn(|_| SPREAD * dice.normal()));
    let mut frame = || {
        places.each_mut().map(|place| {
            place.iter_mut().for_each(|x| *x += STEP * dice.normal());
            let residual = (RESIDUALS * dice.uniform()) as u8;
            let last = f32::from(i16::from_be_bytes([CAMERAS, residual]));
            [place[0] as f32, place[1] as f32, place[2] as f32, last]
        })
    };
    (0..N_FRAMES).map(|_| frame()).collect()
}

/// Frame count and sum of all coordinates.
pub(super) fn facts(markers: &[[Point; N_MARKERS]]) -> Vec<Fact> {
    let points = markers.iter().flatten();
    let coordinates = points.flat_map(|point| &point[..3]).copied().map(f64::from);
    vec![frames(), sum("sum", coordinates)]
}

/// The file's bytes.
pub(super) fn file(markers: &[[Point; N_MARKERS]]) -> Vec<u8> {
    // The pointer to the data stands in the parameters and does not change their length.
    let n_blocks = parameters(0).len().div_ceil(BLOCK);
    let data_block = usize::from(PARAMETER_BLOCK) + n_blocks;
    let mut out = header(data_block as u16);
    let mut section = parameters(data_block as i16);
    section[2] = n_blocks as u8;
    section.resize(n_blocks * BLOCK, 0);
    out.extend(section);
    out.extend(points(markers));
    out.resize(out.len().next_multiple_of(BLOCK), 0);
    out
}

/// The bytes of the points alone.
pub(super) fn points(markers: &[[Point; N_MARKERS]]) -> Vec<u8> {
    let words = markers.iter().flatten().flatten();
    words.flat_map(|word| word.to_le_bytes()).collect()
}

fn header(data_block: u16) -> Vec<u8> {
    const MAX_GAP: u16 = 10;
    let mut out = vec![PARAMETER_BLOCK, KEY];
    for word in [N_MARKERS as u16, 0, 1, N_FRAMES as u16, MAX_GAP] {
        out.extend(word.to_le_bytes());
    }
    out.extend(SCALE.to_le_bytes());
    out.extend(data_block.to_le_bytes());
    out.extend(0_u16.to_le_bytes());
    out.extend(RATE.to_le_bytes());
    out.resize(BLOCK, 0);
    out
}

/// The parameter section with its own header; the count of its blocks is still open.
fn parameters(data_block: i16) -> Vec<u8> {
    const POINT: i8 = 1;
    const ANALOG: i8 = 2;
    const LABEL: usize = 4;
    let labels: String = (1..=N_MARKERS).map(|i| format!("M{i:03}")).collect();
    let integer = |value: i16| (2, Vec::new(), value.to_le_bytes().to_vec());
    let float = |value: f32| (4, Vec::new(), value.to_le_bytes().to_vec());
    let mut out = vec![1, KEY, 0, INTEL];
    for (group, name, content) in [
        (POINT, "USED", integer(N_MARKERS as i16)),
        (POINT, "SCALE", float(SCALE)),
        (POINT, "RATE", float(RATE)),
        (POINT, "DATA_START", integer(data_block)),
        (POINT, "FRAMES", integer(N_FRAMES as i16)),
        (POINT, "UNITS", (-1, vec![2], b"mm".to_vec())),
        (
            POINT,
            "LABELS",
            (-1, vec![LABEL as u8, N_MARKERS as u8], labels.into_bytes()),
        ),
        (ANALOG, "USED", integer(0)),
        (ANALOG, "RATE", float(0.0)),
    ] {
        if name == "USED" {
            let group_name = if group == POINT { "POINT" } else { "ANALOG" };
            record(-group, group_name, &[0], &mut out);
        }
        let (kind, dimensions, data): (i8, Vec<u8>, Vec<u8>) = content;
        let mut body = vec![kind.to_le_bytes()[0], dimensions.len() as u8];
        body.extend(dimensions);
        body.extend(data);
        body.push(0);
        record(group, name, &body, &mut out);
    }
    out.extend([0; 2]);
    out
}

/// Name, distance to the next record, content.
fn record(group: i8, name: &str, body: &[u8], out: &mut Vec<u8>) {
    out.push(name.len() as u8);
    out.extend(group.to_le_bytes());
    out.extend(name.bytes());
    out.extend((body.len() as u16 + 2).to_le_bytes());
    out.extend(body);
}
