use ndarray::{Array2, Array3, Axis};

use crate::markers::Markers;
use crate::unit::guess_from_extent;
use crate::up::{OVERRULES_DEFAULT, UpAxis, UpSource, guess_up, typical_extent};
use crate::{FrameRate, LengthUnit, ParseError, Position, RateSource, UnitSource, Warning};

use super::error::{C3dErrorKind, C3dWarningKind};
use super::header::{self, BLOCK, Header};
use super::labels::{Other, distinct_names, others};
use super::layout::{self, Layout};
use super::parameters::{self, Parameters};
use super::points::{self, Points};
use super::{Analog, ByteOrder, Event, Storage, analog, events};

/// What a C3D file says.
#[derive(Clone, Debug, PartialEq)]
pub struct C3d {
    /// The points that are positions.
    pub markers: Markers,
    /// Which cameras saw each marker: shape `(frames, markers)`, bit i for camera i; 0 where the file
    /// does not say.
    pub cameras: Array2<u8>,
    /// Points that are no positions: angles, forces and the like.
    pub other_points: OtherPoints,
    /// Force plates, EMG and the like; `None` if the file has none.
    pub analog: Option<Analog>,
    /// The events of the header, then those of the EVENT group.
    pub events: Vec<Event>,
    /// All parameters.
    pub parameters: Parameters,
    /// How the file writes numbers.
    pub byte_order: ByteOrder,
    /// How it stores points and samples.
    pub storage: Storage,
    /// What was odd, in file order.
    pub warnings: Vec<Warning>,
}

/// Points of a C3D file that are no positions, such as the joint angles of a gait model.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherPoints {
    /// Their names, distinct from each other and from those of the markers.
    pub names: Vec<String>,
    /// What each of them is: `ANGLES`, `FORCES`, `MOMENTS`, `POWERS`, `SCALARS` or as the file says.
    pub kinds: Vec<String>,
    /// The unit of each as the file says it, such as `deg` or `Nmm`.
    pub units: Vec<Option<String>>,
    /// Shape `(frames, points, 3)`, NaN where missing.
    pub values: Array3<f32>,
}

/// A rate for files that name none; what most of the laboratories' systems record at.
const DEFAULT_HZ: f64 = 100.0;

/// How much of a parameter section is read: twice what its length byte can say, because some writers
/// let it wrap around.
const MAX_PARAMETER_BLOCKS: usize = 512;

/// How sure the motion must be to overrule the file's word on the vertical axis.
const OVERRULES_FILE: f64 = 0.9;

/// Reads a C3D file.
///
/// Points whose fourth word is negative are missing, that is NaN. So are markers at exactly 0 0 0 with
/// nothing measured, which some writers write for missing ones (C3D014). If every point is marked
/// invalid, as in files by SIMI, coordinates are used all the same (C3D015).
///
/// Where header and parameters disagree, the size of the data decides, then the parameters; either is
/// warned of. The unit is POINT:UNITS or a guess from the extent of the cloud. Up is POINT:Y_SCREEN
/// unless the motion clearly says otherwise, else [`guess_up`], else Z.
///
/// O(bytes); memory is a small multiple of the bytes that are there, whatever the header claims.
///
/// # Errors
/// [`ParseError`] with [`ParseErrorKind::C3d`](crate::ParseErrorKind::C3d) and the byte, if this is no
/// C3D file, there is no frame in it, or neither points nor analog values.
pub fn parse_c3d(bytes: &[u8]) -> Result<C3d, ParseError> {
    read(bytes).map_err(|(byte, kind)| ParseError {
        at: position(bytes, byte),
        kind: kind.into(),
    })
}

/// What should stand past the end of the file is missing at its end.
fn position(file: &[u8], byte: usize) -> Position {
    let byte = byte.min(file.len());
    Position::Binary { byte }
}

fn read(bytes: &[u8]) -> Result<C3d, (usize, C3dErrorKind)> {
    let mut oddities = Vec::new();
    if let Some(&found) = bytes.get(1).filter(|&&mark| mark != 80) {
        return Err((1, C3dErrorKind::Mark { found }));
    }
    let found = bytes.len();
    let block: &[u8; BLOCK] = (bytes.first_chunk()).ok_or((0, C3dErrorKind::Header { found }))?;
    let (order, parameters, after_parameters) = read_parameters(bytes, block, &mut oddities)?;
    let header = Header::read(block, order);
    let layout = layout::resolve(
        bytes.len(),
        order,
        &header,
        &parameters,
        after_parameters,
        &mut oddities,
    )?;
    // `resolve` counted the frames that are there.
    let data = &bytes[layout.start..][..layout.frame_len() * layout.n_frames];
    let (rate, rate_source) = frame_rate(&header, &parameters, &mut oddities);

    let labels = parameters.texts("POINT", "LABELS");
    let labels_at = parameters.get("POINT", "LABELS").map_or(0, |p| p.byte);
    let mut names = distinct_names(&labels, layout.n_points, labels_at, &mut oddities);
    let others = others(&labels[..labels.len().min(layout.n_points)], &parameters);
    let mut points = points::read(data, &layout);
    if points.all_invalid {
        oddities.push((layout.start, C3dWarningKind::AllInvalid));
    }
    let other_points = take_others(&others, &mut names, &mut points);
    if points.has_zeros {
        let count = drop_zeros(&mut points, &layout);
        if count > 0 {
            oddities.push((layout.start, C3dWarningKind::Zeros { count }));
        }
    }
    let (unit, unit_source) = length_unit(&points.positions, &parameters, &mut oddities);
    let (up, up_source) = up_axis(&points.positions, &parameters, &mut oddities);
    let analog = analog::read(data, &layout, rate, &parameters);
    let mut all_events = events::in_header(block, order, &mut oddities);
    let first_seconds = layout.first_frame_number.saturating_sub(1) as f64 * rate.frame_time();
    all_events.extend(events::in_parameters(
        &parameters,
        first_seconds,
        &mut oddities,
    ));
    oddities.sort_by_key(|&(byte, _)| byte);
    let warnings = oddities.into_iter().map(|(byte, kind)| Warning {
        at: position(bytes, byte),
        kind: kind.into(),
    });
    Ok(C3d {
        markers: Markers {
            names,
            positions: points.positions,
            residuals: points.residuals,
            rate,
            rate_source,
            unit,
            unit_source,
            up,
            up_source,
            first_frame_number: layout.first_frame_number,
        },
        cameras: points.cameras,
        other_points,
        analog,
        events: all_events,
        parameters,
        byte_order: order,
        storage: layout.storage,
        warnings: warnings.collect(),
    })
}

/// The byte order, the parameters, and where the data start if nothing else says so.
fn read_parameters(
    bytes: &[u8],
    block: &[u8; BLOCK],
    oddities: &mut Vec<(usize, C3dWarningKind)>,
) -> Result<(ByteOrder, Parameters, usize), (usize, C3dErrorKind)> {
    let start = usize::from(block[0]).saturating_sub(1).max(1) * BLOCK;
    let head = bytes.get(start..start + 4);
    let found = head.map_or(0, |head| head[3]);
    let by_processor = |order: &ByteOrder| order.processor() == found;
    let order = ByteOrder::ALL.into_iter().find(by_processor);
    let by_header = |order: &ByteOrder| Header::read(block, *order).is_plausible(bytes.len());
    let order = match order {
        Some(order) => order,
        None => {
            let order = ByteOrder::ALL.into_iter().find(by_header);
            let order = order.ok_or((start + 3, C3dErrorKind::Processor { found }))?;
            oddities.push((start + 3, C3dWarningKind::Processor { found, order }));
            order
        }
    };
    let n_blocks = head.map_or(0, |head| usize::from(head[2]));
    let after = start + n_blocks * BLOCK;
    // The number of blocks wraps around in long sections; what it leaves out ends at the data.
    let data_start = usize::from(Header::read(block, order).data_start).saturating_sub(1) * BLOCK;
    let longest = start + MAX_PARAMETER_BLOCKS * BLOCK;
    let end = after.max(data_start).min(longest).min(bytes.len());
    let section = parameters::read_records(bytes, start + 4, end, order);
    if section.parameters.groups.is_empty() {
        oddities.push((start, C3dWarningKind::NoParameters));
    } else {
        oddities.extend(section.oddities);
    }
    Ok((order, section.parameters, after))
}

/// POINT:RATE, or the header's.
fn frame_rate(
    header: &Header,
    parameters: &Parameters,
    oddities: &mut Vec<(usize, C3dWarningKind)>,
) -> (FrameRate, RateSource) {
    let said = parameters.number("POINT", "RATE");
    let usable = |hz: f64| FrameRate::from_hz(shortest_decimal(hz));
    let in_header = f64::from(header.rate);
    let Some(rate) = said.and_then(usable).or_else(|| usable(in_header)) else {
        let kind = C3dWarningKind::NoRate { used: DEFAULT_HZ };
        oddities.push((header::RATE, kind));
        let rate = FrameRate::from_hz(DEFAULT_HZ).expect("a positive number");
        return (rate, RateSource::Default);
    };
    if let Some(value) = said.filter(|&v| usable(v) != usable(in_header)) {
        let kind = C3dWarningKind::Disagreement {
            what: "frame rate",
            header: in_header,
            parameter: "POINT:RATE",
            value,
            used: rate.hz(),
        };
        oddities.push((header::RATE, kind));
    }
    (rate, RateSource::File)
}

/// The rate that an `f32` stands for: 59.94 was stored as 59.93999863, and 25 after a calculation as
/// 25.000001907.
fn shortest_decimal(hz: f64) -> f64 {
    let whole = hz.round();
    if (hz - whole).abs() <= whole.abs() * f64::from(f32::EPSILON) {
        return whole;
    }
    (hz as f32).to_string().parse().unwrap_or(hz)
}

/// Moves the points that are no positions out of `points` and `names`.
fn take_others(others: &[Other], names: &mut Vec<String>, points: &mut Points) -> OtherPoints {
    let indices: Vec<usize> = others.iter().map(|other| other.idx).collect();
    let taken = OtherPoints {
        names: indices.iter().map(|&idx| names[idx].clone()).collect(),
        kinds: others.iter().map(|other| other.kind.clone()).collect(),
        units: others.iter().map(|other| other.unit.clone()).collect(),
        values: points.positions.select(Axis(1), &indices),
    };
    if !indices.is_empty() {
        let is_other = |idx: &usize| indices.binary_search(idx).is_ok();
        let kept: Vec<usize> = (0..names.len()).filter(|idx| !is_other(idx)).collect();
        *names = kept.iter().map(|&idx| names[idx].clone()).collect();
        points.positions = points.positions.select(Axis(1), &kept);
        points.residuals = points.residuals.select(Axis(1), &kept);
        points.cameras = points.cameras.select(Axis(1), &kept);
    }
    taken
}

/// Makes positions at the origin missing where nothing was measured: no residual and no camera, or every
/// bit of the fourth word but the sign, which is what some writers leave of -1. Gives their number.
fn drop_zeros(points: &mut Points, layout: &Layout) -> usize {
    let all_bits = (255.0 * layout.scale, 127);
    let mut count = 0;
    let rows = points.positions.lanes_mut(Axis(2)).into_iter();
    for ((mut at, residual), camera) in rows.zip(&mut points.residuals).zip(&mut points.cameras) {
        let word = (*residual, *camera);
        let unmeasured = residual.is_nan() || word == (0.0, 0) || word == all_bits;
        if unmeasured && at.iter().all(|&v| v == 0.0) {
            at.fill(f32::NAN);
            *residual = f32::NAN;
            *camera = 0;
            count += 1;
        }
    }
    count
}

fn length_unit(
    positions: &Array3<f32>,
    parameters: &Parameters,
    oddities: &mut Vec<(usize, C3dWarningKind)>,
) -> (LengthUnit, UnitSource) {
    let said = parameters.text("POINT", "UNITS");
    if let Some(unit) = said.as_deref().and_then(unit_from_text) {
        return (unit, UnitSource::File);
    }
    if let Some(found) = said {
        let byte = parameters.get("POINT", "UNITS").map_or(0, |p| p.byte);
        oddities.push((byte, C3dWarningKind::Unit { found }));
    }
    guess_from_extent(typical_extent(positions.view()))
}

/// Laboratories write it out, and in the plural. A bare number is no unit here.
fn unit_from_text(text: &str) -> Option<LengthUnit> {
    let text = text.trim().trim_end_matches('.').to_ascii_lowercase();
    match text.as_str() {
        "millimetre" | "millimeter" | "millimetres" | "millimeters" => Some(LengthUnit::MILLIMETRE),
        "centimetre" | "centimeter" | "centimetres" | "centimeters" => Some(LengthUnit::CENTIMETRE),
        "metres" | "meters" => Some(LengthUnit::METRE),
        "inches" => Some(LengthUnit::INCH),
        // What fits into the usual four characters.
        "mill" => Some(LengthUnit::MILLIMETRE),
        "cent" => Some(LengthUnit::CENTIMETRE),
        "mete" | "metr" => Some(LengthUnit::METRE),
        name if name.starts_with(|c: char| c.is_ascii_alphabetic()) => LengthUnit::from_name(name),
        _ => None,
    }
}

/// The file's word is how its makers looked at it, and so usually but not always up.
fn up_axis(
    positions: &Array3<f32>,
    parameters: &Parameters,
    oddities: &mut Vec<(usize, C3dWarningKind)>,
) -> (UpAxis, UpSource) {
    let said = parameters.text("POINT", "Y_SCREEN");
    let said = said.as_deref().and_then(UpAxis::from_name);
    let across = parameters.text("POINT", "X_SCREEN");
    let across = across.as_deref().and_then(UpAxis::from_name);
    // Both along one axis make no picture.
    let said = said.filter(|up| across.is_none_or(|across| across.axis() != up.axis()));
    let guess = guess_up(positions.view());
    let sure = |limit: f64| guess.filter(|&(_, confidence)| confidence >= limit);
    match (said, sure(OVERRULES_FILE), sure(OVERRULES_DEFAULT)) {
        (Some(said), Some((used, confidence)), _) if said != used => {
            let byte = parameters.get("POINT", "Y_SCREEN").map_or(0, |p| p.byte);
            oddities.push((byte, C3dWarningKind::UpAxis { said, used }));
            (used, UpSource::Guessed { confidence })
        }
        (Some(said), ..) => (said, UpSource::File),
        (None, _, Some((up, confidence))) => (up, UpSource::Guessed { confidence }),
        (None, _, None) => (UpAxis::Z, UpSource::Default),
    }
}
