//! Times of the stages for as many frames as the paper's largest example.

use anyhow::Result;
use bundles::ExtractOptions;
use cli::output::table;

use crate::clock::Clock;
use crate::mixed::with_boxing;
use crate::stages::{self, Clips, Smooth};
use crate::takes::{CLOSURES, METHODS, Sets};

/// The paper's seconds for 7,300 frames and 250 clusters; the graph is one of less than 15 ms.
const PUBLISHED: [(&str, &str); 3] = [
    ("letters", "460"),
    ("extraction", "76"),
    ("graph", "< 0.015"),
];

pub(crate) fn report(sets: &Sets) -> Result<String> {
    let (mixed, _) = with_boxing(&sets.walking, &sets.boxing);
    let (vectors, ranges) = mixed.vectors()?;
    let clips = Clips {
        vectors: vectors.view(),
        ranges: &ranges,
    };
    let mut rows = table(&["method", "stage", "closure", "CPU s", "paper s"]);
    let mut add = |method: &str, closure: &str, clock: Clock| {
        for stage in clock.stages {
            let paper = PUBLISHED.iter().find(|row| row.0 == stage.name);
            rows.add_row([
                method.to_owned(),
                stage.name.clone(),
                closure.to_owned(),
                format!("{:.4}", stage.cpu),
                paper.map_or("", |row| row.1).to_owned(),
            ]);
        }
    };
    let mut facts = Vec::new();
    for (method, how) in METHODS {
        let mut clock = Clock::start();
        let smooth = Smooth::new(clips, mixed.rate()?, how);
        clock.end("smoothing");
        let letters = smooth.letters(mixed.kappa, 0, &mut |name| clock.end(name))?;
        add(method, "", clock);
        let (string, access) = smooth.spelt(&letters, None)?;
        for (name, closure) in CLOSURES {
            let options = ExtractOptions {
                seed: how.instance(0),
                ..stages::options(&string, closure, 0)
            };
            let mut clock = Clock::start();
            stages::graph(clips, (&string, &access), &options, &mut |name| {
                clock.end(name)
            })?;
            add(method, name, clock);
        }
        let (n_letters, n_iterations) = (string.len(), letters.n_iterations);
        facts.push(format!(
            "{method}: a string of {n_letters}, {n_iterations} iterations of EM"
        ));
    }
    Ok(format!(
        "Times: {} frames of boxing and walking, {} letters ({}); one run, the paper's with 7,300 frames on an Athlon64 3500+\n{}\n\n",
        mixed.n_frames(),
        mixed.kappa,
        facts.join("; "),
        rows.trim_fmt()
    ))
}
