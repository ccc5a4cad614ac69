//! Right lengths and checksums over wrong bytes.

use xxhash_rust::xxh3::Xxh3;

/// Makes magic, version, length and checksum of a saved model fit its payload.
pub(crate) fn reseal(bytes: &mut [u8]) {
    let Some((header, payload)) = bytes.split_first_chunk_mut::<28>() else {
        return;
    };
    header[..8].copy_from_slice(b"MOTIFMBG");
    header[8..12].copy_from_slice(&1_u32.to_le_bytes());
    header[12..20].copy_from_slice(&(payload.len() as u64).to_le_bytes());
    let mut state = Xxh3::new();
    state.update(&header[..20]);
    state.update(payload);
    header[20..].copy_from_slice(&state.digest().to_le_bytes());
}
