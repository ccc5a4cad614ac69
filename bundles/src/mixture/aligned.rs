//! Numbers that begin on a cache line, so that no vector of them crosses one.

use std::ops::{Deref, DerefMut};

const LINE_BYTES: usize = 64;
const PADDING: usize = LINE_BYTES / size_of::<f64>();

#[derive(Debug)]
pub(super) struct Aligned {
    numbers: Vec<f64>,
    offset: usize,
    len: usize,
}

impl Aligned {
    pub(super) fn filled(len: usize, value: f64) -> Self {
        let numbers = vec![value; len + PADDING];
        // Where the address cannot be told, the numbers are merely not aligned.
        let offset = numbers.as_ptr().align_offset(LINE_BYTES).min(PADDING);
        Self {
            numbers,
            offset,
            len,
        }
    }
}

impl Deref for Aligned {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.numbers[self.offset..self.offset + self.len]
    }
}

impl DerefMut for Aligned {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.numbers[self.offset..self.offset + self.len]
    }
}
