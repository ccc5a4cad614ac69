use ndarray::{Array2, Array3};

use super::layout::Layout;
use super::order::dec_f32;
use super::{ByteOrder, Storage};

/// All points of a file, positions or not.
pub(super) struct Points {
    /// `(frames, points, 3)`, NaN where missing.
    pub(super) positions: Array3<f32>,
    /// `(frames, points)`, in file units, NaN where missing.
    pub(super) residuals: Array2<f32>,
    /// `(frames, points)`, bit i for camera i.
    pub(super) cameras: Array2<u8>,
    /// Some are at 0 0 0.
    pub(super) has_zeros: bool,
    /// Every point is marked invalid, and coordinates were used all the same.
    pub(super) all_invalid: bool,
}

/// Reads a number of the data section.
pub(super) trait Decode {
    /// Bytes of a number.
    const SIZE: usize;
    /// A coordinate before scaling, or an analog sample.
    fn value(bytes: &[u8]) -> f32;
    /// The fourth word of a point, as the signed 16-bit number that it stands for.
    fn word(bytes: &[u8]) -> i16;
}

macro_rules! decoders {
    ($($name:ident: $size:literal, $read:expr;)*) => {$(
        pub(super) struct $name;
        impl Decode for $name {
            const SIZE: usize = $size;
            #[inline(always)]
            fn value(bytes: &[u8]) -> f32 {
                let mut own = [0; $size];
                own.copy_from_slice(bytes);
                f32::from($read(own))
            }
            #[inline(always)]
            fn word(bytes: &[u8]) -> i16 {
                let mut own = [0; $size];
                own.copy_from_slice(bytes);
                // Through i32: writers of floats say 65535 where they mean the word of -1.
                $read(own) as i32 as i16
            }
        }
    )*};
}

decoders! {
    LittleInteger: 2, i16::from_le_bytes;
    BigInteger: 2, i16::from_be_bytes;
    IntelFloat: 4, f32::from_le_bytes;
    MipsFloat: 4, f32::from_be_bytes;
    DecFloat: 4, dec_f32;
}

/// No measurement reaches this; SIMI Motion writes -1e9 for what is missing.
const NO_COORDINATE: f32 = 1e9;

pub(super) fn read(data: &[u8], layout: &Layout) -> Points {
    match (layout.storage, layout.order) {
        (Storage::Integer, ByteOrder::Mips) => read_as::<BigInteger>(data, layout),
        (Storage::Integer, _) => read_as::<LittleInteger>(data, layout),
        (Storage::Float, ByteOrder::Intel) => read_as::<IntelFloat>(data, layout),
        (Storage::Float, ByteOrder::Mips) => read_as::<MipsFloat>(data, layout),
        (Storage::Float, ByteOrder::Dec) => read_as::<DecFloat>(data, layout),
    }
}

fn read_as<D: Decode>(data: &[u8], layout: &Layout) -> Points {
    let points = decode::<D, false>(data, layout);
    let nothing = points.positions.iter().all(|v| v.is_nan());
    if !nothing || points.positions.is_empty() {
        return points;
    }
    let regardless = decode::<D, true>(data, layout);
    if regardless
        .positions
        .iter()
        .any(|&v| v != 0.0 && !v.is_nan())
    {
        return regardless;
    }
    points
}

/// With `REGARDLESS`, the fourth word is not looked at and residuals stay unknown.
fn decode<D: Decode, const REGARDLESS: bool>(data: &[u8], layout: &Layout) -> Points {
    let (n_frames, n_points) = (layout.n_frames, layout.n_points);
    let mut positions = Vec::with_capacity(n_frames * n_points * 3);
    let mut residuals = Vec::with_capacity(n_frames * n_points);
    let mut cameras = Vec::with_capacity(n_frames * n_points);
    let mut has_zeros = false;
    let scale = match layout.storage {
        Storage::Integer => layout.scale,
        Storage::Float => 1.0,
    };
    // A frame is decoded in the cache and then copied: the large arrays are written once, not cleared
    // before.
    let mut frame_positions = vec![[0.0f32; 3]; n_points];
    let mut frame_residuals = vec![0.0f32; n_points];
    let mut frame_cameras = vec![0u8; n_points];
    let point_len = 4 * D::SIZE;
    for frame in data.chunks_exact(layout.frame_len()) {
        let points = frame[..n_points * point_len].chunks_exact(point_len);
        let row = (frame_positions.iter_mut())
            .zip(&mut frame_residuals)
            .zip(&mut frame_cameras);
        for (bytes, ((at, residual), camera)) in points.zip(row) {
            let [x, y, z] = [0, 1, 2].map(|i| scale * D::value(&bytes[i * D::SIZE..][..D::SIZE]));
            let word = D::word(&bytes[3 * D::SIZE..]);
            let is_known = |v: f32| v.abs() < NO_COORDINATE;
            let is_known = is_known(x) & is_known(y) & is_known(z);
            let is_there = is_known & (REGARDLESS | (word >= 0));
            let has_word = is_there & !REGARDLESS;
            *at = if is_there { [x, y, z] } else { [f32::NAN; 3] };
            let measured = f32::from(word as u8) * layout.scale;
            *residual = if has_word { measured } else { f32::NAN };
            *camera = if has_word { (word >> 8) as u8 } else { 0 };
            has_zeros |= is_there & (x == 0.0) & (y == 0.0) & (z == 0.0);
        }
        positions.extend_from_slice(frame_positions.as_flattened());
        residuals.extend_from_slice(&frame_residuals);
        cameras.extend_from_slice(&frame_cameras);
    }
    Points {
        positions: array3(n_frames, n_points, positions),
        residuals: array2(n_frames, n_points, residuals),
        cameras: array2(n_frames, n_points, cameras),
        has_zeros,
        all_invalid: REGARDLESS,
    }
}

pub(super) fn array3(n_frames: usize, n: usize, values: Vec<f32>) -> Array3<f32> {
    Array3::from_shape_vec((n_frames, n, 3), values).expect("three numbers per frame and point")
}

pub(super) fn array2<T>(n_frames: usize, n: usize, values: Vec<T>) -> Array2<T> {
    Array2::from_shape_vec((n_frames, n), values).expect("one number per frame and point")
}
