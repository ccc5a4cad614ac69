//! Numbers of varying size: blocks of [`BLOCK`], each in runs of [`RUN`] that share a bit width.
//!
//! A packed section is a directory, then bits. The directory has 16 bytes per block: the bit at which the block
//! begins, counted from the end of the directory (u64), and the widths of its eight runs (u8 each). Bits are filled
//! from the least significant of each byte. The last run may be short and takes only the bits it needs.

use super::Part;
use super::view::View;

/// Numbers per block.
pub(crate) const BLOCK: usize = 128;
/// Numbers of one width. Words and durations come in clusters, so that short runs pay for their width byte.
const RUN: usize = 16;
/// The width up to which a run has at most 128 bits.
const NARROW: u32 = 128 / RUN as u32;
const ENTRY: usize = 16;

/// Per width of up to [`NARROW`] bits, for fields of 1, 2, 4 and 8 times this width: the bits of every second field.
const NEIGHBOURS: [[u128; 4]; NARROW as usize + 1] = {
    let mut masks = [[0; 4]; NARROW as usize + 1];
    let mut width = 1;
    while width <= NARROW as usize {
        let mut level = 0;
        while level < 4 {
            let field = width << level;
            let mut at = 0;
            while at < u128::BITS as usize {
                masks[width][level] |= ((1 << field) - 1) << at;
                at += 2 * field;
            }
            level += 1;
        }
        width += 1;
    }
    masks
};

/// Bytes of the directory of `n` numbers.
pub(crate) fn directory_len(n: u64) -> u64 {
    n.div_ceil(BLOCK as u64) * ENTRY as u64
}

/// Bits needed for `number`; none for zero.
pub(crate) fn width_of(number: u64) -> u32 {
    u64::BITS - number.leading_zeros()
}

/// Fills bytes bit by bit, least significant first.
#[derive(Default)]
pub(crate) struct BitWriter {
    bytes: Vec<u8>,
    pending: u128,
    n_pending: u32,
}

impl BitWriter {
    /// Appends the lowest `width` bits, at most 64; the others must be zero.
    pub(crate) fn push(&mut self, number: u64, width: u32) {
        self.pending |= u128::from(number) << self.n_pending;
        self.n_pending += width;
        while self.n_pending >= 8 {
            self.bytes.push(self.pending as u8);
            self.pending >>= 8;
            self.n_pending -= 8;
        }
    }

    fn n_bits(&self) -> u64 {
        8 * self.bytes.len() as u64 + u64::from(self.n_pending)
    }

    pub(crate) fn finish(mut self) -> Vec<u8> {
        if self.n_pending > 0 {
            self.bytes.push(self.pending as u8);
        }
        self.bytes
    }
}

/// The packed section of `numbers`.
pub(crate) fn pack(numbers: &[u64]) -> Vec<u8> {
    let mut section = Vec::new();
    let mut bits = BitWriter::default();
    for block in numbers.chunks(BLOCK) {
        section.extend(bits.n_bits().to_le_bytes());
        let mut widths = [0u8; BLOCK / RUN];
        for (run, out) in block.chunks(RUN).zip(&mut widths) {
            let width = width_of(run.iter().fold(0, |all, number| all | number));
            *out = width as u8;
            for &number in run {
                bits.push(number, width);
            }
        }
        section.extend(widths);
    }
    section.extend(bits.finish());
    section
}

/// Reads the numbers of a packed section in order. It has no end of its own: past the last number it reads on
/// through whatever follows, or reports that the shard is flawed.
pub(crate) struct Unpacker<'v, 'a> {
    view: &'v View<'a>,
    section: Part,
    /// Where the directory and the bits begin in the body, in bytes.
    directory: usize,
    bits: u64,
    next: usize,
    /// The widths of the runs from the next one on, least significant byte first.
    widths: u64,
    width: u32,
    /// The bit of the body at which the next number begins.
    at: u64,
}

impl<'v, 'a> Unpacker<'v, 'a> {
    /// Starts at number `from` of the `n` numbers in `section`.
    pub(crate) fn new(view: &'v View<'a>, section: Part, n: usize, from: usize) -> Self {
        let directory = view.start_of(section);
        let bits = 8 * (directory as u64).wrapping_add(directory_len(n as u64));
        let mut unpacker = Unpacker {
            view,
            section,
            directory,
            bits,
            next: from / BLOCK * BLOCK,
            widths: 0,
            width: 0,
            at: 0,
        };
        unpacker.skip_to(from);
        unpacker
    }

    /// Goes forward within the block to number `to`.
    fn skip_to(&mut self, to: usize) {
        while self.next < to {
            if self.next.is_multiple_of(RUN) {
                self.enter_run();
            }
            let step = RUN.min(to - self.next);
            self.at = self.at.wrapping_add(step as u64 * u64::from(self.width));
            self.next += step;
        }
    }

    fn enter_run(&mut self) {
        if self.next.is_multiple_of(BLOCK) {
            let entry = self.directory + self.next / BLOCK * ENTRY;
            self.at = self.bits.wrapping_add(self.view.u64_at(entry));
            self.widths = self.view.u64_at(entry + ENTRY / 2);
        }
        self.width = (self.widths & 0xff) as u32;
        self.widths >>= 8;
        if self.width > u64::BITS {
            let found = u64::from(self.width);
            let part = self.section;
            self.view
                .flaw(part, self.next, "a width of at most 64 bits", found);
            self.width = 0;
        }
    }

    #[inline]
    pub(crate) fn next(&mut self) -> u64 {
        if self.next.is_multiple_of(RUN) {
            self.enter_run();
        }
        let number = self.view.bits(self.at, self.width);
        self.at = self.at.wrapping_add(u64::from(self.width));
        self.next += 1;
        number
    }

    /// The sum of the next `n` numbers, modulo 2^64.
    pub(crate) fn sum(&mut self, n: usize) -> u64 {
        if n == 1 {
            return self.next();
        }
        let end = self.next + n;
        let mut sum = 0u64;
        while self.next < end {
            let n_left = RUN - self.next % RUN;
            if n_left == RUN {
                self.enter_run();
            }
            let n = n_left.min(end - self.next);
            if self.width <= NARROW {
                // The whole run in two loads; numbers that are missing are zeros.
                let bits = n as u32 * self.width;
                let low = self.view.bits(self.at, bits.min(u64::BITS));
                let high = bits.saturating_sub(u64::BITS);
                let high = self.view.bits(self.at.wrapping_add(64), high);
                let mut sums = u128::from(high) << 64 | u128::from(low);
                // Neighbours are added two by two, in fields twice as wide each time.
                let mut width = self.width;
                for mask in NEIGHBOURS[self.width as usize] {
                    sums = (sums & mask) + (sums >> width & mask);
                    width *= 2;
                }
                sum = sum.wrapping_add(sums as u64);
            } else {
                for i in 0..n as u64 {
                    let at = self.at.wrapping_add(i * u64::from(self.width));
                    sum = sum.wrapping_add(self.view.bits(at, self.width));
                }
            }
            self.at = self.at.wrapping_add(n as u64 * u64::from(self.width));
            self.next += n;
        }
        sum
    }
}
