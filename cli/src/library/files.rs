//! How a writer touches the disk.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// The lock of a library, held until it is dropped.
#[derive(Debug)]
pub(super) struct Lock(File);

impl Drop for Lock {
    fn drop(&mut self) {
        // Closing alone would not do while a process that is just being started shares the open file.
        let _ = self.0.unlock();
    }
}

/// Takes the lock of a library.
pub(super) fn lock(dir: &Path) -> Result<Lock, Failure> {
    let path = dir.join("lock");
    let mut options = OpenOptions::new();
    // The file stays: whoever removed it would let two writers hold locks of two files.
    let file = options.create(true).truncate(false).write(true).open(&path);
    let file = file.map_err(|e| Failure::io(&path, e))?;
    match file.try_lock() {
        Ok(()) => Ok(Lock(file)),
        Err(TryLockError::Error(e)) => Err(Failure::io(&path, e)),
        Err(TryLockError::WouldBlock) => {
            let message = "locked: another motif is writing to this library";
            Err(Failure::io(&path, io::Error::other(message)))
        }
    }
}

pub(super) fn files_in(dir: &Path) -> Result<Vec<PathBuf>, Failure> {
    let fail = |e| Failure::io(dir, e);
    let entries = match fs::read_dir(dir) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(fail)?,
    };
    entries
        .map(|entry| Ok(entry.map_err(fail)?.path()))
        .collect()
}

pub(super) fn temporary(path: &Path) -> PathBuf {
    let mut temporary = path.as_os_str().to_owned();
    temporary.push(".tmp");
    temporary.into()
}

/// Writes a file beside its place and renames it there, so that nobody ever sees a part of it.
pub(super) fn replace(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let fail = |e| Failure::io(path, e);
    let temporary = temporary(path);
    let mut file = File::create(&temporary).map_err(fail)?;
    file.write_all(bytes).map_err(fail)?;
    file.sync_all().map_err(fail)?;
    fs::rename(&temporary, path).map_err(fail)?;
    if let Some(dir) = path.parent() {
        // The rename itself must reach the disk. Not every file system can sync a folder.
        if let Ok(dir) = File::open(dir) {
            let _ = dir.sync_all();
        }
    }
    Ok(())
}
