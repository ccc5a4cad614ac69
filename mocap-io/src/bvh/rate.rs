use std::ops::RangeInclusive;

use crate::FrameRate;

/// Frame times with which movement is recorded, in seconds: one a second is a slide show, and optical
/// systems end at ten thousand a second. Others are a file's mistake.
pub(super) const PLAUSIBLE_SECONDS: RangeInclusive<f64> = 1e-4..=1.0;

/// What is assumed where a file has no frame time that can be meant. Blender, where most such files go,
/// then keeps the scene's rate; 30 is the rate at which cameras and pose estimators, which write
/// such files, give frames.
pub(super) const DEFAULT_HZ: f64 = 30.0;

/// Rates that software writes. A frame time that is one of them to its last printed digit is taken
/// as that rate: 0.008333 means 120 Hz, not 120.0048.
const COMMON_HZ: [f64; 24] = [
    10.0, 12.0, 15.0, 20.0, 24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 72.0, 75.0, 90.0, 100.0, 120.0,
    125.0, 144.0, 150.0, 180.0, 200.0, 240.0, 250.0, 300.0, 480.0,
];

/// The rate of a frame time as `written`: a whole number if its frame time is exactly this, one of
/// [`COMMON_HZ`] if its frame time rounds to what is written, else the reciprocal.
pub(super) fn rate_from_frame_time(seconds: f64, written: &[u8]) -> Option<FrameRate> {
    let rate = FrameRate::from_frame_time(seconds)?;
    let whole = rate.hz().round();
    if whole.recip() == seconds {
        // Nothing was lost: 0.002 is 500 Hz, not 480 Hz cut off after three decimals.
        return FrameRate::from_hz(whole);
    }
    let mut n_decimals = 0;
    let mut in_fraction = false;
    for &b in written {
        match b {
            b'.' => in_fraction = true,
            b'0'..=b'9' if in_fraction => n_decimals += 1,
            b'e' | b'E' => return Some(rate),
            _ => {}
        }
    }
    // Exporters round, or cut the digits off.
    let last_digit = 10f64.powi(-n_decimals);
    let lost = |hz: f64| hz.recip() - seconds;
    COMMON_HZ
        .into_iter()
        .filter(|&hz| (-0.5 * last_digit..last_digit).contains(&lost(hz)))
        .filter(|&hz| lost(hz).abs() < 0.1 * seconds)
        .min_by(|&a, &b| lost(a).abs().total_cmp(&lost(b).abs()))
        .and_then(FrameRate::from_hz)
        .or(Some(rate))
}
