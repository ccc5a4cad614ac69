use super::ByteOrder;

/// Everything in a C3D file starts at a multiple of this; blocks are counted from 1.
pub(super) const BLOCK: usize = 512;

/// The first block. Words are 16 bits.
pub(super) struct Header {
    pub(super) n_points: u16,
    /// Analog values per frame of points: channels times samples.
    pub(super) n_analog: u16,
    pub(super) first_frame: u16,
    pub(super) last_frame: u16,
    pub(super) scale: f32,
    /// Block of the first frame.
    pub(super) data_start: u16,
    pub(super) samples_per_frame: u16,
    pub(super) rate: f32,
}

/// Where words of the header are, in bytes.
pub(super) const N_POINTS: usize = 2;
pub(super) const N_ANALOG: usize = 4;
pub(super) const FIRST_FRAME: usize = 6;
pub(super) const LAST_FRAME: usize = 8;
pub(super) const SCALE: usize = 12;
pub(super) const DATA_START: usize = 16;
pub(super) const SAMPLES_PER_FRAME: usize = 18;
pub(super) const RATE: usize = 20;

impl Header {
    pub(super) fn read(block: &[u8; BLOCK], order: ByteOrder) -> Header {
        Header {
            n_points: u16_at(block, N_POINTS, order),
            n_analog: u16_at(block, N_ANALOG, order),
            first_frame: u16_at(block, FIRST_FRAME, order),
            last_frame: u16_at(block, LAST_FRAME, order),
            scale: f32_at(block, SCALE, order),
            data_start: u16_at(block, DATA_START, order),
            samples_per_frame: u16_at(block, SAMPLES_PER_FRAME, order),
            rate: f32_at(block, RATE, order),
        }
    }

    /// Number of frames, unless the range is none.
    pub(super) fn n_frames(&self) -> Option<u64> {
        let after_first = self.last_frame.checked_sub(self.first_frame)?;
        // Both are zero where nothing was written.
        (self.last_frame > 0).then_some(u64::from(after_first) + 1)
    }

    /// Whether a file of `len` bytes can have this header: what the wrong byte order makes of one is
    /// far off.
    pub(super) fn is_plausible(&self, len: usize) -> bool {
        let start = usize::from(self.data_start).saturating_sub(1) * BLOCK;
        let numbers = usize::from(self.n_points) * 4 + usize::from(self.n_analog);
        let n_frames = self.n_frames().map_or(usize::MAX, |n| n as usize);
        let n_bytes = numbers.saturating_mul(2).saturating_mul(n_frames);
        // Some write a rate of 0 when they do not know it.
        let rate_fits = self.rate == 0.0 || (0.1..1e5).contains(&self.rate);
        start >= BLOCK && n_bytes > 0 && n_bytes <= len.saturating_sub(start) && rate_fits
    }
}

pub(super) fn u16_at(block: &[u8; BLOCK], byte: usize, order: ByteOrder) -> u16 {
    order.u16([block[byte], block[byte + 1]])
}

pub(super) fn f32_at(block: &[u8; BLOCK], byte: usize, order: ByteOrder) -> f32 {
    order.f32([
        block[byte],
        block[byte + 1],
        block[byte + 2],
        block[byte + 3],
    ])
}
