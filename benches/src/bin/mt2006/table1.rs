//! Table 1: what was learned.

use std::time::Instant;

use anyhow::Result;
use cli::eval::learn_and_match;
use cli::eval::split::Role;
use cli::output::table;

use crate::work::{Work, method};

/// Folder, size N of the training set, mean length ᾱ in frames of 30 Hz, iterations M, seconds.
const PUBLISHED: [(&str, usize, f64, usize, f64); 2] = [
    ("lieDownFloor", 10, 165.0, 5, 25.6),
    ("squat1Reps", 26, 47.3, 5, 24.6),
];

/// Frames at 120 Hz per frame of the paper.
const STEP: usize = 4;

pub(crate) fn report(work: &Work) -> Result<String> {
    let mut rows = table(&["class", "N", "", "length", "", "M", "", "ms", ""]);
    rows.add_row([
        "", "ours", "paper", "ours", "paper", "ours", "paper", "ours", "paper",
    ]);
    // Nothing is tested, so that learning alone is timed.
    let training = |role: &Role| *role == Role::Train;
    let n_training = work.roles.iter().filter(|role| training(role)).count();
    let mut untested = work.trial();
    let (clips, roles): (Vec<_>, Vec<_>) = work
        .clips
        .iter()
        .cloned()
        .zip(work.roles.iter().copied())
        .filter(|(_, role)| training(role))
        .unzip();
    (untested.clips, untested.roles) = (&clips, &roles);
    for (class, name) in work.classes.iter().enumerate() {
        let lengths: Vec<f64> = untested
            .training(class)
            .map(|clip| (clip.n_frames / STEP) as f64)
            .collect();
        let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
        let start = Instant::now();
        let learned = learn_and_match(&untested, class, &method())?;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let paper = PUBLISHED.iter().find(|row| row.0 == name);
        let paper = |cell: fn(&(&str, usize, f64, usize, f64)) -> String| {
            paper.map_or_else(String::new, cell)
        };
        rows.add_row([
            name.clone(),
            lengths.len().to_string(),
            paper(|row| row.1.to_string()),
            format!("{mean:.1}"),
            paper(|row| format!("{:.1}", row.2)),
            learned.map_or_else(String::new, |l| l.learned.iterations.to_string()),
            paper(|row| row.3.to_string()),
            format!("{ms:.0}"),
            paper(|row| format!("{:.0}", row.4 * 1e3)),
        ]);
    }
    Ok(format!(
        "Table 1: training ({n_training} of {} clips; times on one run, the paper's on a Pentium 4)\n{}\n\n",
        work.clips.len(),
        rows.trim_fmt()
    ))
}
