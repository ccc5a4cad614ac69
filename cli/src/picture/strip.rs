//! Pictures of motions: sampled poses side by side, as PNG.
//!
//! # Units and shapes
//! Positions have shape `(frames, joints, 3)`, metres, +Y up, the floor at height 0. Pictures are
//! RGB, 8 bits, rows from the top.

#[cfg(test)]
mod tests;

use ndarray::ArrayView3;

use super::canvas::{Canvas, Image, Rgb};
use super::font;
use crate::report::document::Side;

/// Left limbs.
const LEFT: Rgb = [0x1f, 0x6f, 0xc4];
/// Right limbs.
const RIGHT: Rgb = [0xe6, 0x7e, 0x22];
/// Trunk and head.
const TRUNK: Rgb = [0x33, 0x3b, 0x47];
const FLOOR: Rgb = [0xb4, 0xba, 0xc4];
const RULE: Rgb = [0xe4, 0xe7, 0xec];
const TEXT: Rgb = [0x33, 0x3b, 0x47];
/// Pixels around the rows of a sheet.
const MARGIN: usize = 14;
/// Pixels between two poses that fill their cells.
const GAP: f32 = 14.0;
/// Metres shown below the floor.
const UNDERGROUND: f32 = 0.12;
/// Pixels per dot of the font.
const TEXT_SCALE: usize = 2;

/// A bone as it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Index of the joint where it starts.
    pub from: usize,
    /// Index of the joint where it ends.
    pub to: usize,
    /// Red, green, blue.
    pub colour: [u8; 3],
    /// Thickness in metres.
    pub width: f32,
}

/// How a strip is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripConfig {
    /// Poses, evenly spread over the frames, the first and the last included.
    pub n_poses: usize,
    /// Pixels from pose to pose.
    pub cell_width: usize,
    /// Pixels from top to bottom.
    pub height: usize,
    /// Metres from top to bottom.
    pub extent: f32,
    /// Degrees by which the camera is turned from looking along −Z, to the left: see
    /// [`three_quarter`].
    pub camera: f32,
}

impl Default for StripConfig {
    fn default() -> Self {
        StripConfig {
            n_poses: 10,
            cell_width: 76,
            height: 160,
            extent: 2.45,
            camera: -50.0,
        }
    }
}

/// Strokes for bones between named joints: left limbs blue, right ones orange, the trunk dark.
///
/// A joint is left if its name starts with `l` or contains `left` (`r`, `right` alike), except for
/// `lower…` and `root`.
#[must_use]
pub fn strokes(names: &[&str], bones: &[(usize, usize)]) -> Vec<Stroke> {
    bones
        .iter()
        .filter_map(|&(from, to)| {
            let name = names.get(to)?.to_ascii_lowercase();
            Some(Stroke {
                from,
                to,
                colour: colour_of(&name),
                width: width_of(&name),
            })
        })
        .collect()
}

fn colour_of(name: &str) -> Rgb {
    match side_of(name) {
        Side::Left => LEFT,
        Side::Right => RIGHT,
        Side::Middle => TRUNK,
    }
}

/// The side of the body that a joint is on, by its name in small letters, see [`strokes`].
pub(crate) fn side_of(name: &str) -> Side {
    if name.contains("hipjoint") || name.contains("clavicle") {
        return Side::Middle;
    }
    match name.as_bytes().first() {
        _ if name.contains("left") => Side::Left,
        _ if name.contains("right") => Side::Right,
        Some(b'l') if !name.starts_with("lower") => Side::Left,
        Some(b'r') if !name.starts_with("root") => Side::Right,
        _ => Side::Middle,
    }
}

fn width_of(name: &str) -> f32 {
    const WIDTHS: [(&str, f32); 16] = [
        ("thumb", 0.020),
        ("finger", 0.030),
        ("hand", 0.042),
        ("wrist", 0.048),
        ("radius", 0.056),
        ("humerus", 0.064),
        ("femur", 0.090),
        ("tibia", 0.070),
        ("foot", 0.052),
        ("toe", 0.042),
        ("back", 0.105),
        ("thorax", 0.115),
        ("upperneck", 0.070),
        ("neck", 0.062),
        ("head", 0.150),
        ("hipjoint", 0.100),
    ];
    let found = WIDTHS.iter().find(|(part, _)| name.contains(part));
    found.map_or(0.06, |&(_, width)| width)
}

/// The camera that sees a figure from its front left: `degrees` to the side of where it faces in the
/// first frame, judged by its hips or shoulders. 0 looks it in the face, 90 shows its left side.
#[must_use]
pub fn three_quarter(
    positions: ArrayView3<'_, f32>,
    left: usize,
    right: usize,
    degrees: f32,
) -> f32 {
    let (n_frames, n_joints, _) = positions.dim();
    if n_frames == 0 || left >= n_joints || right >= n_joints {
        return degrees;
    }
    let across = |axis: usize| positions[[0, left, axis]] - positions[[0, right, axis]];
    // Left is +X when facing +Z, so a turn to the left by h takes the hips to (cos h, −sin h).
    (-across(2)).atan2(across(0)).to_degrees() + degrees
}

/// Poses of a motion side by side, on a common floor. Upright poses are `cell_width` apart; one that
/// is wider takes the room it needs.
#[must_use]
pub fn skeleton_strip(
    positions: ArrayView3<'_, f32>,
    strokes: &[Stroke],
    config: &StripConfig,
) -> Image {
    let scale = config.height as f32 / config.extent.max(f32::EPSILON);
    let floor = config.height as f32 - UNDERGROUND * scale;
    let poses = sample(positions, config);
    let cell = config.cell_width as f32;
    let lefts: Vec<(f32, f32)> = poses
        .iter()
        .scan(0.0, |right, pose| {
            let (low, high) = extent(pose);
            let room = cell.max((high - low) * scale + GAP);
            // In a cell with room to spare the root is in the middle, so that an outstretched arm
            // does not push the body aside.
            let root = pose.first().map_or(0.0, |p| p[0]);
            let spare = 0.5 * (room - GAP) / scale;
            let middle = root.clamp(high - spare, (low + spare).max(high - spare));
            let left = *right;
            *right += room;
            Some((left + 0.5 * room - middle * scale, *right))
        })
        .collect();
    let width = lefts.last().map_or(cell, |last| last.1);
    let mut canvas = Canvas::new(width.ceil() as usize, config.height);
    canvas.segment([0.0, floor + 1.5], [width, floor + 1.5], 0.75, FLOOR);
    for (pose, (left, _)) in poses.iter().zip(lefts) {
        let place = |joint: usize| -> Option<[f32; 3]> {
            let p = pose
                .get(joint)
                .filter(|p| p.iter().all(|v| v.is_finite()))?;
            Some([left + p[0] * scale, floor - p[1] * scale, p[2]])
        };
        draw_figure(&mut canvas, strokes, scale, place);
    }
    canvas.into_image()
}

/// The poses to draw, in camera coordinates: right on the picture, up, toward the camera.
fn sample(positions: ArrayView3<'_, f32>, config: &StripConfig) -> Vec<Vec<[f32; 3]>> {
    let (n_frames, n_joints, n_axes) = positions.dim();
    if n_frames == 0 || n_joints == 0 || n_axes != 3 {
        return Vec::new();
    }
    let (sin, cos) = config.camera.to_radians().sin_cos();
    (0..config.n_poses)
        .map(|k| k * (n_frames - 1) / (config.n_poses - 1).max(1))
        .map(|frame| {
            (0..n_joints)
                .map(|joint| {
                    let [x, y, z] = [0, 1, 2].map(|axis| positions[[frame, joint, axis]]);
                    [x * cos - z * sin, y, x * sin + z * cos]
                })
                .collect()
        })
        .collect()
}

/// Leftmost and rightmost coordinate of a pose; joints that are not finite do not count.
fn extent(pose: &[[f32; 3]]) -> (f32, f32) {
    let finite = pose.iter().map(|p| p[0]).filter(|x| x.is_finite());
    let (low, high) = finite.fold((f32::MAX, f32::MIN), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

/// Draws the strokes from back to front.
fn draw_figure(
    canvas: &mut Canvas,
    strokes: &[Stroke],
    scale: f32,
    place: impl Fn(usize) -> Option<[f32; 3]>,
) {
    let mut ordered: Vec<(f32, &Stroke, [f32; 3], [f32; 3])> = strokes
        .iter()
        .filter_map(|stroke| {
            let (from, to) = (place(stroke.from)?, place(stroke.to)?);
            Some((from[2] + to[2], stroke, from, to))
        })
        .collect();
    ordered.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, stroke, from, to) in ordered {
        let radius = (0.5 * stroke.width * scale).max(0.8);
        canvas.segment([from[0], from[1]], [to[0], to[1]], radius, stroke.colour);
    }
}

/// Strips one below the other, each with a caption on its left.
#[must_use]
pub fn contact_sheet(rows: &[(String, Image)]) -> Image {
    let caption = rows
        .iter()
        .map(|(text, _)| font::width(text, TEXT_SCALE))
        .max();
    let left = 2 * MARGIN + caption.unwrap_or(0);
    let width = left + rows.iter().map(|(_, strip)| strip.width).max().unwrap_or(0) + MARGIN;
    let height = rows
        .iter()
        .map(|(_, strip)| strip.height + 1)
        .sum::<usize>()
        + 2 * MARGIN;
    let mut canvas = Canvas::new(width, height);
    let mut top = MARGIN;
    for (k, (text, strip)) in rows.iter().enumerate() {
        canvas.paste(strip, left, top);
        let baseline = top + strip.height / 2 - font::HEIGHT * TEXT_SCALE / 2;
        font::write(&mut canvas, text, [MARGIN, baseline], TEXT_SCALE, TEXT);
        top += strip.height;
        if k + 1 < rows.len() {
            canvas.fill([MARGIN, top], [width.saturating_sub(2 * MARGIN), 1], RULE);
        }
        top += 1;
    }
    canvas.into_image()
}
