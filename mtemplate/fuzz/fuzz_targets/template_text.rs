//! Arbitrary text as a template, of a known set of features and of an unknown one. What is read is
//! written and read again, and can be edited and matched.

#![no_main]

use libfuzzer_sys::fuzz_target;
use mtemplate::{ClassTemplate, FileError, Place};

fuzz_target!(|text: &str| {
    for names in [None, Some(vec!["low".to_owned(), "rhand_fast".to_owned()])] {
        match ClassTemplate::from_text(text, |_| names.clone()) {
            Ok(class) => check(&class),
            Err(error) => check_error(text, &error),
        }
    }
});

fn check(class: &ClassTemplate) {
    let text = class.to_text().expect("what is read can be written");
    let again = ClassTemplate::from_text(&text, |_| Some(class.features.clone()));
    assert_eq!(again.as_ref(), Ok(class));
    let bytes = class.to_bytes().expect("what is read can be written");
    assert_eq!(ClassTemplate::from_bytes(&bytes, |_| None).as_ref(), Ok(class));
    // Long templates are slow to match, and no different.
    if (1..100).contains(&class.template.n_columns()) {
        let part = class.restricted(1, 0..1).expect("there is a feature and a column");
        assert_eq!(part.check(), Ok(()));
        let quantized = class.template.quantize(0.1).expect("a threshold");
        assert_eq!(quantized.distance_curve(&[0, 1, 3, 2]).len(), 4);
    }
}

fn check_error(text: &str, error: &FileError) {
    let Place::Text { line, column, byte } = error.at else {
        panic!("the error has no line");
    };
    assert!(byte <= text.len() && line >= 1 && column >= 1);
    assert!(line <= text.matches('\n').count() + 1 && !error.to_string().is_empty());
}
