use std::io::Write;

use ndarray::{ArrayView3, Axis as ArrayAxis};

use crate::WriteError;

/// NumPy wants the data to start at a multiple of this many bytes.
const ALIGNMENT: usize = 64;
/// Magic, version 1.0 and the length of the header.
const PREAMBLE: usize = 10;

/// Writes positions as a NumPy array of shape `(frames, joints, 3)`: `<f4`, C order, version 1.0 of the
/// format. Missing coordinates stay NaN. O(frames · joints).
///
/// # Errors
/// [`WriteError::Io`] when the sink fails.
pub fn write_npy(positions: ArrayView3<'_, f32>, mut out: impl Write) -> Result<(), WriteError> {
    out.write_all(&header("<f4", positions.shape()))?;
    let mut bytes = Vec::new();
    for pose in positions.axis_iter(ArrayAxis(0)) {
        bytes.clear();
        bytes.extend(pose.iter().flat_map(|v| v.to_le_bytes()));
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// A whole array in the format: elements in C order, each as its little-endian bytes.
pub(super) fn array<const N: usize>(
    descr: &str,
    shape: &[usize],
    elements: impl IntoIterator<Item = [u8; N]>,
) -> Vec<u8> {
    let mut bytes = header(descr, shape);
    for element in elements {
        bytes.extend_from_slice(&element);
    }
    bytes
}

/// An array of strings: `<U` and the length of the longest, in UTF-32, filled up with zeros.
pub(super) fn text_array(texts: &[&str]) -> Vec<u8> {
    let n_chars = texts.iter().map(|t| t.chars().count()).max();
    // NumPy has no strings of length zero in files.
    let n_chars = n_chars.unwrap_or(0).max(1);
    let mut bytes = header(&format!("<U{n_chars}"), &[texts.len()]);
    for text in texts {
        let filled = text.chars().chain(std::iter::repeat('\0')).take(n_chars);
        bytes.extend(filled.flat_map(|c| u32::from(c).to_le_bytes()));
    }
    bytes
}

fn header(descr: &str, shape: &[usize]) -> Vec<u8> {
    let sizes: Vec<String> = shape.iter().map(|n| format!("{n},")).collect();
    let mut dict = format!(
        "{{'descr': '{descr}', 'fortran_order': False, 'shape': ({}), }}",
        sizes.concat()
    );
    let unpadded = PREAMBLE + dict.len() + 1;
    let padding = unpadded.next_multiple_of(ALIGNMENT) - unpadded;
    dict.push_str(&" ".repeat(padding));
    dict.push('\n');
    let length = u16::try_from(dict.len()).expect("a type and at most three numbers are short");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend_from_slice(&length.to_le_bytes());
    bytes.extend_from_slice(dict.as_bytes());
    bytes
}
