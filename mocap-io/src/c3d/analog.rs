use ndarray::Array2;

use crate::FrameRate;

use super::layout::Layout;
use super::parameters::Parameters;
use super::points::{BigInteger, DecFloat, Decode, IntelFloat, LittleInteger, MipsFloat};
use super::{ByteOrder, Storage};

/// Samples of force plates, EMG and whatever else was recorded beside the points.
#[derive(Clone, Debug, PartialEq)]
pub struct Analog {
    /// One per channel; may repeat, and be empty where the file has no label.
    pub names: Vec<String>,
    /// One per channel; empty where the file names none.
    pub units: Vec<String>,
    /// Shape `(samples, channels)`, in `units`: (stored − offset) · scale · general scale.
    pub values: Array2<f32>,
    /// Samples per second.
    pub rate: FrameRate,
    /// Samples per frame of points: sample i belongs to frame i / `samples_per_frame`.
    pub samples_per_frame: usize,
}

/// `None` if the file has no channels.
pub(super) fn read(
    data: &[u8],
    layout: &Layout,
    point_rate: FrameRate,
    parameters: &Parameters,
) -> Option<Analog> {
    if layout.n_analog == 0 {
        return None;
    }
    let n_channels = layout.n_analog / layout.samples_per_frame;
    let text = |name: &str, i: usize| -> Vec<String> {
        let mut texts = parameters.texts("ANALOG", name);
        texts.resize(i, String::new());
        texts
    };
    let format = parameters.text("ANALOG", "FORMAT");
    let unsigned = format.is_some_and(|f| f.eq_ignore_ascii_case("UNSIGNED"));
    let offsets = parameters.numbers("ANALOG", "OFFSET", unsigned);
    let scales = parameters.numbers("ANALOG", "SCALE", false);
    let general = parameters
        .get("ANALOG", "GEN_SCALE")
        .and_then(|p| p.number(0));
    let channels: Vec<Channel> = (0..n_channels)
        .map(|i| Channel {
            offset: offsets.get(i).map_or(0.0, |&v| v as f32),
            scale: (scales.get(i).unwrap_or(&1.0) * general.unwrap_or(1.0)) as f32,
        })
        .collect();
    let values = match (layout.storage, layout.order) {
        (Storage::Integer, ByteOrder::Mips) => {
            decode::<BigInteger>(data, layout, &channels, unsigned)
        }
        (Storage::Integer, _) => decode::<LittleInteger>(data, layout, &channels, unsigned),
        (Storage::Float, ByteOrder::Intel) => decode::<IntelFloat>(data, layout, &channels, false),
        (Storage::Float, ByteOrder::Mips) => decode::<MipsFloat>(data, layout, &channels, false),
        (Storage::Float, ByteOrder::Dec) => decode::<DecFloat>(data, layout, &channels, false),
    };
    let n_samples = layout.n_frames * layout.samples_per_frame;
    let rate = FrameRate::from_hz(point_rate.hz() * layout.samples_per_frame as f64);
    Some(Analog {
        names: text("LABELS", n_channels),
        units: text("UNITS", n_channels),
        values: Array2::from_shape_vec((n_samples, n_channels), values)
            .expect("every frame has so many samples of so many channels"),
        rate: rate.unwrap_or(point_rate),
        samples_per_frame: layout.samples_per_frame,
    })
}

struct Channel {
    offset: f32,
    scale: f32,
}

fn decode<D: Decode>(
    data: &[u8],
    layout: &Layout,
    channels: &[Channel],
    unsigned: bool,
) -> Vec<f32> {
    let mut values = Vec::with_capacity(layout.n_frames * layout.n_analog);
    let points_len = layout.n_points * 4 * D::SIZE;
    for frame in data.chunks_exact(layout.frame_len()).take(layout.n_frames) {
        for sample in frame[points_len..].chunks_exact(channels.len() * D::SIZE) {
            let stored = sample.chunks_exact(D::SIZE).zip(channels);
            values.extend(stored.map(|(bytes, channel)| {
                let value = D::value(bytes);
                let wrapped = unsigned && value < 0.0;
                let value = if wrapped { value + 65_536.0 } else { value };
                (value - channel.offset) * channel.scale
            }));
        }
    }
    values
}
