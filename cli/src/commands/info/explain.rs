//! `motif info --explain CODE`.

use mocap_io::{explain, explanations};
use serde::Serialize;

use crate::failure::{Exit, Failure};
use crate::output::{Outcome, Voice};

#[derive(Serialize)]
struct ExplainJson {
    code: &'static str,
    title: &'static str,
    meaning: &'static str,
    remedy: &'static str,
}

/// Says what a code means.
pub(super) fn run(code: &str, voice: Voice) -> Result<Exit, Failure> {
    let found = explain(code).ok_or_else(|| {
        let known: Vec<&str> = explanations().map(|e| e.code).collect();
        Failure::Usage(format!(
            "there is no code {code}; there are {}",
            known.join(", ")
        ))
    })?;
    let outcome = Outcome {
        result: ExplainJson {
            code: found.code,
            title: found.title,
            meaning: found.meaning,
            remedy: found.remedy,
        },
        skipped: Vec::new(),
        found: true,
    };
    voice.report("info", &outcome, |out| {
        writeln!(out, "{}: {}", found.code, found.title)?;
        writeln!(out, "\n{}\n\nWhat to do: {}", found.meaning, found.remedy)
    })
}
