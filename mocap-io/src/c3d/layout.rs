//! Where the data are and how many, when header and parameters may disagree.

use super::error::{C3dErrorKind, C3dWarningKind};
use super::header::{self, BLOCK, Header};
use super::parameters::Parameters;
use super::{ByteOrder, Storage};

/// What the rest of the reader needs to know.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) order: ByteOrder,
    pub(super) storage: Storage,
    /// Factor of integer points and of all residuals; positive.
    pub(super) scale: f32,
    pub(super) n_points: usize,
    /// Analog values per frame.
    pub(super) n_analog: usize,
    /// Samples of each channel per frame.
    pub(super) samples_per_frame: usize,
    /// First byte of the data.
    pub(super) start: usize,
    pub(super) n_frames: usize,
    pub(super) first_frame_number: u64,
}

impl Layout {
    /// Bytes of one frame.
    pub(super) fn frame_len(&self) -> usize {
        (self.n_points * 4 + self.n_analog) * self.storage.size()
    }
}

/// Frame counts are 16-bit words; longer recordings say this, or wrap around.
const SATURATED: u64 = 65_535;
const WRAP: u64 = 65_536;
/// The header counts points in 16 bits.
const MAX_POINTS: u64 = 65_535;

type Oddities = Vec<(usize, C3dWarningKind)>;

/// One reading of the file: what a frame is and where the first one starts.
#[derive(Clone, Copy, PartialEq)]
struct Reading {
    n_points: u64,
    n_analog: u64,
    storage: Storage,
    start: usize,
}

impl Reading {
    /// `None` if it does not fit into memory.
    fn frame_len(&self) -> Option<usize> {
        let numbers = self.n_points.checked_mul(4)?.checked_add(self.n_analog)?;
        usize::try_from(numbers)
            .ok()?
            .checked_mul(self.storage.size())
    }

    /// Whole frames between the start of the data and the end of the file.
    fn n_available(&self, file_len: usize) -> u64 {
        let there = file_len.saturating_sub(self.start);
        match self.frame_len() {
            Some(len) if len > 0 => (there / len) as u64,
            _ => 0,
        }
    }

    /// Whether so many frames fill the file but for less than a block of padding.
    fn is_filled_by(&self, n_frames: u64, file_len: usize) -> bool {
        let there = file_len.saturating_sub(self.start);
        let data = self.frame_len().zip(usize::try_from(n_frames).ok());
        let data = data.and_then(|(len, n)| len.checked_mul(n));
        data.is_some_and(|data| data > 0 && data <= there && there - data < BLOCK)
    }
}

/// Decides. Where header and parameters differ, the one that accounts for the size of the file is
/// right; if neither does, the parameters are.
pub(super) fn resolve(
    file_len: usize,
    order: ByteOrder,
    header: &Header,
    parameters: &Parameters,
    after_parameters: usize,
    oddities: &mut Oddities,
) -> Result<Layout, (usize, C3dErrorKind)> {
    let claims = frame_claims(header, parameters);
    let whole = |group, name| parameters.number(group, name).and_then(whole_number);

    let used = whole("POINT", "USED").filter(|&n| n <= MAX_POINTS);
    let points = candidates([used, Some(header.n_points.into())]);
    let samples = u64::from(header.samples_per_frame.max(1));
    let channels = whole("ANALOG", "USED");
    let analog = candidates([
        Some(header.n_analog.into()),
        channels.and_then(|n| n.checked_mul(samples)),
    ]);
    let said_scale = parameters.number("POINT", "SCALE").map(|v| v as f32);
    let storages: Vec<Storage> =
        match candidates([said_scale, Some(header.scale)].map(|s| s.and_then(storage_of))) {
            signs if signs.is_empty() => vec![Storage::Float, Storage::Integer],
            signs => signs,
        };
    let said_start = whole("POINT", "DATA_START");
    let in_file = |block: u64| {
        let start = usize::try_from(block)
            .ok()?
            .checked_sub(1)?
            .checked_mul(BLOCK)?;
        (start >= BLOCK && start < file_len).then_some(start)
    };
    let starts = match candidates([
        said_start.and_then(in_file),
        in_file(header.data_start.into()),
    ]) {
        starts if starts.is_empty() => vec![after_parameters],
        starts => starts,
    };

    let mut readings = Vec::new();
    for &start in &starts {
        for &storage in &storages {
            for &n_points in &points {
                for &n_analog in &analog {
                    readings.push(Reading {
                        n_points,
                        n_analog,
                        storage,
                        start,
                    });
                }
            }
        }
    }
    let fits = |reading: &&Reading| claims.iter().any(|&n| reading.is_filled_by(n, file_len));
    let Some(&reading) = readings.iter().find(fits).or(readings.first()) else {
        return Err((header::N_POINTS, C3dErrorKind::Empty));
    };
    if reading.n_points == 0 && reading.n_analog == 0 {
        return Err((header::N_POINTS, C3dErrorKind::Empty));
    }
    let frame_len = reading.frame_len().ok_or((
        header::N_POINTS,
        C3dErrorKind::FrameSize {
            points: reading.n_points,
            analog: reading.n_analog,
        },
    ))?;
    let n_frames = count_frames(&reading, &claims, file_len, oddities);
    if n_frames == 0 {
        return Err((
            reading.start,
            C3dErrorKind::NoData {
                frame: frame_len,
                found: file_len.saturating_sub(reading.start),
            },
        ));
    }

    let mut compare = |what, byte, from_header: f64, parameter, value: Option<f64>, used: f64| {
        if let Some(value) = value.filter(|&v| v != from_header) {
            let kind = C3dWarningKind::Disagreement {
                what,
                header: from_header,
                parameter,
                value,
                used,
            };
            oddities.push((byte, kind));
        }
    };
    compare(
        "number of points",
        header::N_POINTS,
        header.n_points.into(),
        "POINT:USED",
        parameters.number("POINT", "USED"),
        reading.n_points as f64,
    );
    compare(
        "first data block",
        header::DATA_START,
        header.data_start.into(),
        "POINT:DATA_START",
        parameters.number("POINT", "DATA_START"),
        (reading.start / BLOCK + 1) as f64,
    );
    // Of the scales of samples whose sizes can be judged, the header's is right.
    let said = [Some(header.scale), said_scale];
    let usable = |s: &f32| storage_of(*s).is_some();
    let scale = said
        .into_iter()
        .flatten()
        .find(|s| storage_of(*s) == Some(reading.storage));
    let scale = scale.or(said.into_iter().flatten().find(usable));
    if let Some(used) = scale {
        compare(
            "scale",
            header::SCALE,
            header.scale.into(),
            "POINT:SCALE",
            parameters.number("POINT", "SCALE"),
            used.into(),
        );
    } else {
        let kind = C3dWarningKind::Scale {
            found: said_scale.unwrap_or(header.scale),
            storage: reading.storage,
        };
        oddities.push((header::SCALE, kind));
    }
    Ok(Layout {
        order,
        storage: reading.storage,
        scale: scale.map_or(1.0, f32::abs),
        n_points: reading.n_points as usize,
        n_analog: reading.n_analog as usize,
        samples_per_frame: samples_per_frame(reading.n_analog, channels, header, parameters),
        start: reading.start,
        n_frames,
        first_frame_number: first_frame_number(header, parameters, n_frames),
    })
}

/// The sign of the scale says how numbers are stored; zero, NaN and infinities say nothing.
fn storage_of(scale: f32) -> Option<Storage> {
    let usable = scale.is_finite() && scale != 0.0;
    usable.then_some(if scale < 0.0 {
        Storage::Float
    } else {
        Storage::Integer
    })
}

/// The values that are there, each once.
fn candidates<T: PartialEq, const N: usize>(values: [Option<T>; N]) -> Vec<T> {
    let mut found: Vec<T> = Vec::new();
    for value in values.into_iter().flatten() {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    found
}

/// Parameters are integers or floats; a count below 2^53 is exact in both.
fn whole_number(value: f64) -> Option<u64> {
    (value >= 0.0 && value.fract() == 0.0 && value < 9e15).then_some(value as u64)
}

/// What the file says about its number of frames, the most trustworthy first (c3d.org, "The C3D frame
/// count"): LONG_FRAMES overrides FRAMES, TRIAL is for counts beyond 16 bits, the header describes the
/// recording that the file was cut from.
fn frame_claims(header: &Header, parameters: &Parameters) -> Vec<u64> {
    let trial = |name| parameters.get("TRIAL", name)?.frame_number();
    let range = trial("ACTUAL_START_FIELD").zip(trial("ACTUAL_END_FIELD"));
    let claims = [
        parameters
            .number("POINT", "LONG_FRAMES")
            .and_then(whole_number),
        parameters.number("POINT", "FRAMES").and_then(whole_number),
        range.and_then(|(first, last)| whole_number(last - first + 1.0)),
        header.n_frames(),
    ];
    let mut claims = candidates(claims);
    claims.retain(|&n| n > 0);
    claims
}

fn count_frames(
    reading: &Reading,
    claims: &[u64],
    file_len: usize,
    oddities: &mut Oddities,
) -> usize {
    let available = reading.n_available(file_len);
    let wrapped = |n: u64| (n < available).then(|| n + (available - n) / WRAP * WRAP);
    let fits = |n: &u64| reading.is_filled_by(*n, file_len);
    let saturated = claims.contains(&SATURATED) && available > SATURATED;
    let used = (claims.iter().copied().find(fits))
        .or_else(|| claims.iter().copied().filter_map(wrapped).find(fits))
        .or_else(|| saturated.then_some(available))
        .or_else(|| claims.iter().copied().find(|&n| n <= available))
        .unwrap_or(available);
    let said = claims.first().copied().unwrap_or(0);
    // A file has at most as many frames as bytes.
    let used = used as usize;
    if said > used as u64 && used as u64 == available {
        oddities.push((file_len, C3dWarningKind::Truncated { cut: used }));
    } else if said != used as u64 && !(said == SATURATED && used as u64 > SATURATED) {
        oddities.push((
            header::LAST_FRAME,
            C3dWarningKind::FrameCount { said, used },
        ));
    }
    used
}

/// Samples of each channel per frame: what the header says, unless the values of a frame cannot be
/// dealt out so and the number of channels or the rates know better.
fn samples_per_frame(
    n_analog: u64,
    channels: Option<u64>,
    header: &Header,
    parameters: &Parameters,
) -> usize {
    let by_header = u64::from(header.samples_per_frame);
    let rate = |group| parameters.number(group, "RATE");
    let ratio = rate("ANALOG").zip(rate("POINT"));
    let by_rate = ratio.and_then(|(analog, point)| whole_number((analog / point).round()));
    let by_channels = channels.and_then(|n| n_analog.checked_div(n));
    let divides = |n: u64| n > 0 && n_analog.is_multiple_of(n);
    let agreed = |n: u64| n == by_header || Some(n) == by_rate;
    let found = (by_channels.filter(|&n| divides(n) && agreed(n)))
        .or(Some(by_header).filter(|&n| divides(n)))
        .or(by_rate.filter(|&n| divides(n)));
    found.unwrap_or(1) as usize
}

/// TRIAL counts beyond 16 bits; it is believed where it describes as many frames as there are.
fn first_frame_number(header: &Header, parameters: &Parameters, n_frames: usize) -> u64 {
    let trial = |name| {
        let number = parameters.get("TRIAL", name)?.frame_number();
        number.and_then(whole_number)
    };
    let first = trial("ACTUAL_START_FIELD").filter(|&first| {
        trial("ACTUAL_END_FIELD")
            .is_some_and(|last| last + 1 == first.saturating_add(n_frames as u64))
    });
    first.unwrap_or(header.first_frame.into())
}
