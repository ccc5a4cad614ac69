//! Right checksums for wrong bytes, from the description of the format alone.

const HEADER_LEN: usize = 28;
const PAGE_LEN: usize = 1 << 16;

/// The bytes with the checksums of all pages and of the head put right, as far as they have such.
pub(crate) fn reseal(bytes: &mut [u8]) {
    let Some((header, rest)) = bytes.split_first_chunk_mut::<HEADER_LEN>() else {
        return;
    };
    let len = header[12..20].try_into().map(u64::from_le_bytes);
    let len = usize::try_from(len.unwrap_or(0)).unwrap_or(usize::MAX);
    let Some((payload, body)) = rest.split_at_mut_checked(len) else {
        return;
    };
    let sums: Vec<u8> = body
        .chunks(PAGE_LEN)
        .flat_map(|page| segidx::checksum(page).to_le_bytes())
        .collect();
    if let Some(at) = payload.len().checked_sub(sums.len()) {
        payload[at..].copy_from_slice(&sums);
    }
    let sum = segidx::checksum(&[&header[..20], payload].concat());
    header[20..].copy_from_slice(&sum.to_le_bytes());
}
