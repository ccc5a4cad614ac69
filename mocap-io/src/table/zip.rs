use std::io::Write;

use crate::WriteError;

const LOCAL_SIGNATURE: u32 = 0x0403_4b50;
const CENTRAL_SIGNATURE: u32 = 0x0201_4b50;
const END_SIGNATURE: u32 = 0x0605_4b50;
/// Version 1.0 of the format: files are stored as they are.
const VERSION: u16 = 10;
/// 1 January 1980, midnight: the format has no way to say that nothing is known.
const DATE: u16 = 1 << 5 | 1;

/// Writes an archive of stored files (PKWARE APPNOTE 6.3.10, sections 4.3.7, 4.3.12 and 4.3.16), without
/// the extensions for 4 GiB and more.
pub(super) struct ZipWriter<W> {
    out: W,
    n_written: u64,
    n_files: u16,
    directory: Vec<u8>,
}

impl<W: Write> ZipWriter<W> {
    pub(super) fn new(out: W) -> Self {
        ZipWriter {
            out,
            n_written: 0,
            n_files: 0,
            directory: Vec::new(),
        }
    }

    pub(super) fn add(&mut self, name: &'static str, data: &[u8]) -> Result<(), WriteError> {
        let at = size(self.n_written)?;
        let length = size(data.len() as u64)?;
        let name_length = u16::try_from(name.len()).expect("names of arrays are short");
        // What the local header and the directory both say, from the flags to the extra field.
        let mut common = Vec::new();
        for short in [0, 0, 0, DATE] {
            push_short(&mut common, short);
        }
        for long in [crc32fast::hash(data), length, length] {
            push_long(&mut common, long);
        }
        for short in [name_length, 0] {
            push_short(&mut common, short);
        }
        let mut header = Vec::new();
        push_long(&mut header, LOCAL_SIGNATURE);
        push_short(&mut header, VERSION);
        header.extend_from_slice(&common);
        header.extend_from_slice(name.as_bytes());
        self.out.write_all(&header)?;
        self.out.write_all(data)?;
        self.n_written += (header.len() + data.len()) as u64;

        push_long(&mut self.directory, CENTRAL_SIGNATURE);
        push_short(&mut self.directory, VERSION);
        push_short(&mut self.directory, VERSION);
        self.directory.extend_from_slice(&common);
        // No comment, first disk, binary; no attributes.
        for short in [0, 0, 0] {
            push_short(&mut self.directory, short);
        }
        push_long(&mut self.directory, 0);
        push_long(&mut self.directory, at);
        self.directory.extend_from_slice(name.as_bytes());
        self.n_files += 1;
        Ok(())
    }

    pub(super) fn finish(mut self) -> Result<(), WriteError> {
        let mut end = Vec::new();
        push_long(&mut end, END_SIGNATURE);
        for short in [0, 0, self.n_files, self.n_files] {
            push_short(&mut end, short);
        }
        push_long(&mut end, size(self.directory.len() as u64)?);
        push_long(&mut end, size(self.n_written)?);
        push_short(&mut end, 0);
        self.out.write_all(&self.directory)?;
        self.out.write_all(&end)?;
        Ok(())
    }
}

fn size(n_bytes: u64) -> Result<u32, WriteError> {
    // The largest number would announce an extension.
    let size = u32::try_from(n_bytes).ok().filter(|&n| n < u32::MAX);
    size.ok_or(WriteError::Limit {
        format: "NPZ",
        what: "4 GiB or more",
    })
}

fn push_short(bytes: &mut Vec<u8>, value: u16) {
    bytes.extend_from_slice(&value.to_le_bytes());
}

fn push_long(bytes: &mut Vec<u8>, value: u32) {
    bytes.extend_from_slice(&value.to_le_bytes());
}
