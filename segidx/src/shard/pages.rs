//! The bytes behind the head, checked page by page when they are first read.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::envelope::checksum;

/// Bytes of a page: a checksum of it takes a few microseconds, and its 8 bytes in the head are next to nothing.
pub(crate) const PAGE_LEN: usize = 1 << PAGE_BITS;
const PAGE_BITS: u32 = 16;

/// The checksums of the pages, and which of them were found right.
#[derive(Debug)]
pub(crate) struct Pages {
    sums: Vec<u64>,
    good: Vec<AtomicBool>,
}

impl Pages {
    /// Pages still to be checked against `sums`.
    pub(crate) fn new(sums: Vec<u64>) -> Pages {
        let good = sums.iter().map(|_| AtomicBool::new(false)).collect();
        Pages { sums, good }
    }

    /// The checksums of the pages of `body`.
    pub(crate) fn sums_of(body: &[u8]) -> Vec<u64> {
        body.chunks(PAGE_LEN).map(checksum).collect()
    }

    /// Whether the page of byte `at` was found right.
    #[inline]
    pub(crate) fn is_good(&self, at: usize) -> bool {
        // Nothing else is published by the flag: the bytes themselves never change.
        let page = self.good.get(at >> PAGE_BITS);
        page.is_some_and(|good| good.load(Ordering::Relaxed))
    }

    /// Checks the page that starts at byte `start` of `body`; else gives the stated checksum and that of the bytes.
    pub(crate) fn check(&self, body: &[u8], start: usize) -> Result<(), (u64, u64)> {
        let page = start >> PAGE_BITS;
        let bytes = body.get(start..).unwrap_or_default();
        let found = checksum(&bytes[..bytes.len().min(PAGE_LEN)]);
        let expected = self.sums.get(page).copied().unwrap_or_default();
        if found != expected {
            return Err((expected, found));
        }
        if let Some(good) = self.good.get(page) {
            good.store(true, Ordering::Relaxed);
        }
        Ok(())
    }

    /// The byte at which each page starts.
    pub(crate) fn starts(&self) -> impl Iterator<Item = usize> {
        (0..self.sums.len()).map(|page| page << PAGE_BITS)
    }
}
