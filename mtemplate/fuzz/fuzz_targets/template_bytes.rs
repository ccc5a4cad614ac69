//! Arbitrary bytes as a template file, once as they are and once as the payload of a right header, so
//! that the checksum does not keep the fuzzer out. What is read is written and read again.

#![no_main]

use libfuzzer_sys::fuzz_target;
use mtemplate::ClassTemplate;
use xxhash_rust::xxh3::xxh3_64;

/// Bytes before the payload.
const HEADER_LEN: usize = 28;

fuzz_target!(|bytes: &[u8]| {
    check(bytes);
    check(&sealed(bytes.get(HEADER_LEN..).unwrap_or(bytes)));
});

fn check(bytes: &[u8]) {
    let Ok(class) = ClassTemplate::from_bytes(bytes, |_| None) else {
        return;
    };
    let again = class.to_bytes().expect("what is read can be written");
    let again = ClassTemplate::from_bytes(&again, |_| None);
    assert_eq!(again.as_ref(), Ok(&class));
    let text = class.to_text().expect("what is read can be written");
    assert_eq!(ClassTemplate::from_text(&text, |_| None), Ok(class));
}

fn sealed(payload: &[u8]) -> Vec<u8> {
    let mut bytes = b"MOTIFTPL\x01\0\0\0".to_vec();
    bytes.extend((payload.len() as u64).to_le_bytes());
    let sum = xxh3_64(&[&bytes, payload].concat());
    bytes.extend(sum.to_le_bytes());
    bytes.extend(payload);
    bytes
}
