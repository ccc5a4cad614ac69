//! Files in memory without reading them.

use std::fs::File;
use std::io;
use std::path::Path;

use memmap2::Mmap;

/// The bytes of a shard file, read by the system where they are touched.
///
/// # Errors
/// Those of opening and mapping the file.
#[allow(unsafe_code)]
pub(super) fn map(path: &Path) -> io::Result<Mmap> {
    let file = File::open(path)?;
    // SAFETY: the bytes behind a map must not change while it is there. A shard file is immutable:
    // it is written under another name, renamed into place, never written again, and in the end
    // removed, which leaves the maps of those who have it open as they are.
    unsafe { Mmap::map(&file) }
}
