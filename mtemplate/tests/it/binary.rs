//! The binary form.

use mtemplate::{ClassTemplate, FileErrorKind, Place};
use proptest::prelude::*;

use crate::classes::class;

fn bytes() -> impl Strategy<Value = (ClassTemplate, Vec<u8>)> {
    class().prop_map(|class| {
        let bytes = class.to_bytes().unwrap();
        (class, bytes)
    })
}

fn read(bytes: &[u8]) -> Result<ClassTemplate, mtemplate::FileError> {
    ClassTemplate::from_bytes(bytes, |_| None)
}

proptest! {
    #[test]
    fn reading_gives_what_was_written((class, bytes) in bytes()) {
        prop_assert_eq!(&read(&bytes), &Ok(class.clone()));
        // Text is told apart by its content.
        let text = class.to_text().unwrap();
        prop_assert_eq!(read(text.as_bytes()), Ok(class));
    }

    #[test]
    fn a_flipped_bit_is_an_error_that_says_where(
        (_, bytes) in bytes(),
        at in any::<prop::sample::Index>(),
    ) {
        let at = at.index(8 * bytes.len());
        let mut bad = bytes.clone();
        bad[at / 8] ^= 1 << (at % 8);
        let error = read(&bad).unwrap_err();
        let is_text = matches!(error.at, Place::Text { .. });
        let is_length = matches!(
            error.kind,
            FileErrorKind::Truncated { .. } | FileErrorKind::Trailing { .. }
        );
        match at / 8 {
            // Without the magic it can only be text, and is none.
            0..8 => prop_assert!(is_text),
            8..12 => prop_assert_eq!(error.at, Place::Binary { byte: 8 }),
            12..20 => prop_assert!(is_length),
            _ => prop_assert_eq!(error.at, Place::Binary { byte: 20 }),
        }
    }

    #[test]
    fn a_file_of_another_length_is_refused(
        (_, bytes) in bytes(),
        cut in any::<prop::sample::Index>(),
        more in prop::collection::vec(any::<u8>(), 1..4),
    ) {
        let cut = cut.index(bytes.len());
        let error = read(&bytes[..cut]).unwrap_err();
        if cut >= 8 {
            prop_assert_eq!(error.at, Place::Binary { byte: cut });
        }
        let error = read(&[&bytes[..], &more].concat()).unwrap_err();
        prop_assert_eq!(error.at, Place::Binary { byte: bytes.len() });
        prop_assert_eq!(error.kind, FileErrorKind::Trailing { found: more.len() });
    }
}

#[test]
fn bytes_that_are_no_text_are_refused_where_they_stop_being_text() {
    let error = read(b"name = 1\nx\xff").unwrap_err();
    assert_eq!(
        error.to_string(),
        "2:2: expected a motion template, found bytes that are no text"
    );
}
