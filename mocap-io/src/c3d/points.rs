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
    /// Whether these are floats as processors of today have them, which [`read_plain`] reads.
    const IS_PLAIN: bool = false;
    /// A coordinate before scaling, or an analog sample.
    fn value(bytes: &[u8]) -> f32;
    /// The fourth word of a point, as the signed 16-bit number that it stands for.
    fn word(bytes: &[u8]) -> i16;
}

macro_rules! decoders {
    ($($name:ident: $size:literal, $read:expr $(, $is_plain:literal)?;)*) => {$(
        pub(super) struct $name;
        impl Decode for $name {
            const SIZE: usize = $size;
            $(const IS_PLAIN: bool = $is_plain;)?
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
    IntelFloat: 4, f32::from_le_bytes, true;
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
        let points = &frame[..n_points * point_len];
        let is_plain = D::IS_PLAIN
            && !REGARDLESS
            && read_plain(
                points,
                layout.scale,
                &mut frame_positions,
                &mut frame_residuals,
                &mut frame_cameras,
            );
        if is_plain {
            positions.extend_from_slice(frame_positions.as_flattened());
            residuals.extend_from_slice(&frame_residuals);
            cameras.extend_from_slice(&frame_cameras);
            continue;
        }
        let points = points.chunks_exact(point_len);
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

/// Reads a frame of Intel floats in which every marker is there and away from x = 0, and every fourth
/// word is a whole number, as in most frames of most files. Otherwise says `false`.
///
/// The four numbers of a point go through the same steps, which compilers turn into one each.
fn read_plain(
    points: &[u8],
    scale: f32,
    positions: &mut [[f32; 3]],
    residuals: &mut [f32],
    cameras: &mut [u8],
) -> bool {
    /// Below [`NO_COORDINATE`].
    const MOST: f32 = 0.5e9;
    /// Above this a float has no fraction: what is added to it is rounded, and stands in its lowest bits.
    const WHOLE: f32 = 8_388_608.0;
    const LOWEST: [f32; 4] = [-MOST, -MOST, -MOST, 0.0];
    const HIGHEST: [f32; 4] = [MOST, MOST, MOST, 32_767.0];
    /// Nothing equals NaN: only x is compared.
    const ODD: [f32; 4] = [0.0, f32::NAN, f32::NAN, f32::NAN];
    let mut is_odd = [0u32; 4];
    let mut has_fraction = false;
    let row = positions.iter_mut().zip(residuals).zip(cameras);
    let (points, _) = points.as_chunks::<16>();
    for (bytes, ((at, residual), camera)) in points.iter().zip(row) {
        let (numbers, _) = bytes.as_chunks::<4>();
        let mut point = [0.0; 4];
        for i in 0..4 {
            point[i] = f32::from_le_bytes(numbers[i]);
            let is_usual = (point[i] >= LOWEST[i]) & (point[i] <= HIGHEST[i]);
            is_odd[i] |= u32::from(!is_usual | (point[i] == ODD[i]));
        }
        let [x, y, z, word] = point;
        let shifted = word + WHOLE;
        has_fraction |= shifted - WHOLE != word;
        let bits = shifted.to_bits();
        *at = [x, y, z];
        *residual = f32::from(bits as u8) * scale;
        *camera = (bits >> 8) as u8;
    }
    is_odd == [0; 4] && !has_fraction
}

pub(super) fn array3(n_frames: usize, n: usize, values: Vec<f32>) -> Array3<f32> {
    Array3::from_shape_vec((n_frames, n, 3), values).expect("three numbers per frame and point")
}

pub(super) fn array2<T>(n_frames: usize, n: usize, values: Vec<T>) -> Array2<T> {
    Array2::from_shape_vec((n_frames, n), values).expect("one number per frame and point")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::sample::select;

    use super::*;

    /// Numbers at every border that a point may cross, and any others.
    fn any_number() -> impl Strategy<Value = f32> {
        let borders = vec![
            0.0,
            -0.0,
            1.0,
            255.0,
            256.0,
            32_767.0,
            32_768.0,
            65_535.0,
            -1.0,
            0.5,
            127.5,
            1e9,
            -1e9,
            4.9e8,
            8_388_608.0,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MIN_POSITIVE,
        ];
        prop_oneof![2 => -2000.0f32..2000.0, 1 => select(borders)]
    }

    fn bits(points: &Points) -> (Vec<u32>, Vec<u32>, Vec<u8>, bool, bool) {
        let of = |values: Vec<f32>| values.into_iter().map(f32::to_bits).collect();
        (
            of(points.positions.iter().copied().collect()),
            of(points.residuals.iter().copied().collect()),
            points.cameras.iter().copied().collect(),
            points.has_zeros,
            points.all_invalid,
        )
    }

    proptest! {
        #[test]
        fn intel_floats_are_what_the_same_floats_the_other_way_round_are(
            frames in prop::collection::vec(
                prop::collection::vec((-2000.0f32..2000.0, any_number(), any_number(), any_number()), 3),
                0..4,
            ),
            tame in any::<bool>(),
        ) {
            let numbers: Vec<f32> = frames
                .iter()
                .flatten()
                .flat_map(|&(x, y, z, word)| {
                    // Half of the cases have words as cameras write them, so that frames are plain.
                    let word = if tame { word.abs().min(32_767.0).floor() } else { word };
                    [x, y, z, word]
                })
                .collect();
            let layout = |order| Layout {
                order,
                storage: Storage::Float,
                scale: 0.1,
                n_points: 3,
                n_analog: 0,
                samples_per_frame: 0,
                start: 0,
                n_frames: frames.len(),
                first_frame_number: 1,
            };
            let intel: Vec<u8> = numbers.iter().flat_map(|v| v.to_le_bytes()).collect();
            let mips: Vec<u8> = numbers.iter().flat_map(|v| v.to_be_bytes()).collect();
            let intel = read(&intel, &layout(ByteOrder::Intel));
            let mips = read(&mips, &layout(ByteOrder::Mips));
            prop_assert_eq!(bits(&intel), bits(&mips));
        }
    }
}
