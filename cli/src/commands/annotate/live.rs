//! `motif annotate --stream`.

use std::io::{self, Write};

use super::SpanJson;
use crate::annotation::{Labeller, Live};
use crate::args::Global;
use crate::failure::{Exit, Failure};

/// Labels standard input and prints each span on a line of its own.
pub(super) fn run(labeller: &Labeller, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let live = Live::open(labeller, io::stdin().lock(), &global.read_options()?)?;
    let labels = labeller.labels();
    let lacking: Vec<&str> = live
        .lacking()
        .into_iter()
        .map(|i| labels[i].as_str())
        .collect();
    if !lacking.is_empty() {
        let lacking = lacking.join(", ");
        voice.note(&format!(
            "the stream's rig lacks features of {lacking}, which are not looked for"
        ));
    }
    let rate = live.rate();
    let mut exit = Exit::Nothing;
    let mut out = io::stdout().lock();
    live.run(|span| {
        exit = Exit::Ok;
        let span = SpanJson::new(&span, labels, rate);
        // Whoever waits for a span wants it now.
        write_line(&mut out, &span, voice.json)
            .and_then(|()| out.flush())
            .map_err(Failure::stdout)
    })?;
    Ok(exit)
}

fn write_line(out: &mut impl Write, span: &SpanJson, json: bool) -> io::Result<()> {
    if json {
        serde_json::to_writer(&mut *out, span)?;
        return writeln!(out);
    }
    writeln!(
        out,
        "{}\t{}\t{}\t{:.3}\t{:.3}\t{:.4}",
        span.label, span.start, span.end, span.start_s, span.end_s, span.cost
    )
}
