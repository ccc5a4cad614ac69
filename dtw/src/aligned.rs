use crate::DtwError;

/// Samples that begin on a cache line, so that no vector of them crosses one.
#[derive(Debug)]
pub(crate) struct Aligned<T> {
    samples: Vec<T>,
    offset: usize,
    len: usize,
}

const LINE_BYTES: usize = 64;

impl<T: Copy> Aligned<T> {
    /// # Errors
    ///
    /// [`DtwError::TooLarge`] when there is no memory for `len` samples.
    pub(crate) fn filled(len: usize, value: T) -> Result<Self, DtwError> {
        let too_large = DtwError::TooLarge {
            rows: 1,
            columns: len,
        };
        let padding = LINE_BYTES / size_of::<T>();
        let capacity = len.checked_add(padding).ok_or(too_large)?;
        let mut samples = Vec::new();
        samples.try_reserve_exact(capacity).map_err(|_| too_large)?;
        samples.resize(capacity, value);
        let offset = samples.as_ptr().align_offset(LINE_BYTES).min(padding);
        Ok(Self {
            samples,
            offset,
            len,
        })
    }

    pub(crate) fn as_slice(&self) -> &[T] {
        &self.samples[self.offset..self.offset + self.len]
    }

    pub(crate) fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.samples[self.offset..self.offset + self.len]
    }
}
