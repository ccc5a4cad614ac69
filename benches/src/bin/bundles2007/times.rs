//! Times of the stages for as many frames as the paper's largest example.

use anyhow::Result;
use cli::output::table;

use crate::clock::Clock;
use crate::mixed::with_boxing;
use crate::stages::{self, Clips, Letters};
use crate::takes::{CLOSURES, Sets};

/// The paper's seconds for 7,300 frames and 250 clusters; the graph is one of less than 15 ms.
const PUBLISHED: [(&str, &str); 3] = [("EM", "460"), ("extraction", "76"), ("graph", "< 0.015")];

pub(crate) fn report(sets: &Sets) -> Result<String> {
    let (mixed, _) = with_boxing(&sets.walking, &sets.boxing);
    let (vectors, ranges) = mixed.vectors()?;
    let clips = Clips {
        vectors: vectors.view(),
        ranges: &ranges,
    };
    let mut rows = table(&["stage", "closure", "CPU s", "paper s"]);
    let mut add = |closure: &str, clock: Clock| {
        for stage in clock.stages {
            let paper = PUBLISHED.iter().find(|row| row.0 == stage.name);
            rows.add_row([
                stage.name.clone(),
                closure.to_owned(),
                format!("{:.4}", stage.cpu),
                paper.map_or("", |row| row.1).to_owned(),
            ]);
        }
    };
    let mut clock = Clock::start();
    let letters = Letters::fit(clips, mixed.kappa, 0, &mut |name| clock.end(name))?;
    add("", clock);
    let string = letters.spell(clips)?;
    let access = letters.access(letters.threshold(&string)?)?;
    for (name, closure) in CLOSURES {
        let options = stages::options(&string, closure, 0);
        let mut clock = Clock::start();
        stages::graph(clips, (&string, &access), &options, &mut |name| {
            clock.end(name)
        })?;
        add(name, clock);
    }
    Ok(format!(
        "Times: {} frames of boxing and walking, {} letters, {} iterations of EM, a string of {}; one run, the paper's with \
         7,300 frames on an Athlon64 3500+\n{}\n\n",
        mixed.n_frames(),
        mixed.kappa,
        letters.n_iterations,
        string.len(),
        rows.trim_fmt()
    ))
}
