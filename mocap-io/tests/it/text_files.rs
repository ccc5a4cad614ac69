//! Every text file of the real data: read, read with warnings, or refused, in one table.

use std::collections::BTreeMap;
use std::fs;

use mocap_io::{ParseError, Warning, parse_amc, parse_asf, parse_bvh};

use crate::real::{acclaim_clips, data, files_below};

/// Files by extension and outcome: the codes of their warnings, or the message of the error.
#[derive(Default)]
struct Table(BTreeMap<(&'static str, String), Vec<String>>);

impl Table {
    fn enter(
        &mut self,
        format: &'static str,
        file: String,
        read: Result<Vec<Warning>, ParseError>,
    ) {
        let outcome = match read {
            Ok(warnings) => {
                let mut codes: Vec<&str> = warnings.iter().map(Warning::code).collect();
                codes.dedup();
                match codes.join(" ") {
                    none if none.is_empty() => "read".to_owned(),
                    codes => format!("read with {codes}"),
                }
            }
            Err(error) => format!("refused: {error}"),
        };
        self.0.entry((format, outcome)).or_default().push(file);
    }
}

#[test]
fn real_text_files_are_all_read() {
    let Some(data) = data() else { return };
    let mut table = Table::default();
    for (format, read) in [
        (
            "bvh",
            (|bytes| parse_bvh(bytes).map(|bvh| bvh.warnings)) as fn(&[u8]) -> _,
        ),
        ("asf", |bytes| parse_asf(bytes).map(|asf| asf.warnings)),
    ] {
        let mut files = Vec::new();
        files_below(&data, format, &mut files);
        for file in files {
            let read = read(&fs::read(&file).unwrap());
            table.enter(format, file.display().to_string(), read);
        }
    }
    for (skeleton, clip) in acclaim_clips(&data) {
        let asf = parse_asf(&fs::read(skeleton).unwrap()).unwrap();
        let read = parse_amc(&fs::read(&clip).unwrap(), &asf).map(|amc| amc.warnings);
        table.enter("amc", clip.display().to_string(), read);
    }
    let mut n_refused = 0;
    let mut n_files = 0;
    for ((format, outcome), files) in &table.0 {
        println!("{format} {:5} {outcome}", files.len());
        if outcome != "read" {
            files.iter().for_each(|file| println!("          {file}"));
        }
        n_refused += files.len() * usize::from(outcome.starts_with("refused"));
        n_files += files.len();
    }
    assert!(n_files > 600, "only {n_files} files");
    assert_eq!(n_refused, 0);
}
