//! Table 2: hits at six thresholds.

use anyhow::Result;
use cli::eval::Learned;
use cli::eval::metrics::{HitCounts, TAUS, count_hits};
use cli::output::table;

use crate::published::{Published, Row};
use crate::work::Work;

/// A class's figures beside the published ones.
pub(crate) struct Beside<'a> {
    pub(crate) class: usize,
    pub(crate) paper: &'a Row,
    pub(crate) n_columns: usize,
    pub(crate) counts: Vec<HitCounts>,
}

/// The classes with published rows, in order.
pub(crate) fn beside<'a>(
    work: &Work,
    published: &'a Published,
    learned: &[Option<Learned>],
) -> Vec<Beside<'a>> {
    let classes = work.classes.iter().enumerate().zip(learned);
    let rows = classes.filter_map(|((class, name), learned)| {
        let (paper, learned) = (published.of(name)?, learned.as_ref()?);
        let relevant = work.trial().relevance(class);
        let count = |tau| count_hits(&learned.responses, &relevant, tau);
        Some(Beside {
            class,
            paper,
            n_columns: learned.learned.template.n_columns(),
            counts: TAUS.map(count).to_vec(),
        })
    });
    rows.collect()
}

/// Sum of |ΔH⁺| over classes and thresholds.
pub(crate) fn off_by(rows: &[Beside<'_>]) -> usize {
    let of_row = |row: &Beside<'_>| -> usize {
        let pairs = row.counts.iter().zip(row.paper.relevant_hits);
        pairs
            .map(|(ours, paper)| ours.relevant_hits.abs_diff(paper))
            .sum()
    };
    rows.iter().map(of_row).sum()
}

pub(crate) fn report(work: &Work, published: &Published) -> Result<String> {
    let rows = beside(work, published, &work.learned);
    let heads = TAUS.map(|tau| tau.to_string());
    let mut all = vec!["class", "relevant", "", "K", ""];
    all.extend(heads.iter().map(String::as_str));
    let mut printed = table(&all);
    let joined = |a: usize, b: usize| format!("{a} / {b}");
    for row in &rows {
        let name = &work.classes[row.class];
        let n_relevant = work.trial().relevance(row.class);
        let n_relevant = n_relevant.iter().filter(|r| **r).count();
        let ours = row
            .counts
            .iter()
            .map(|at| joined(at.hits, at.relevant_hits));
        let cells = [
            name.clone(),
            n_relevant.to_string(),
            "ours".to_owned(),
            row.n_columns.to_string(),
            String::new(),
        ];
        printed.add_row(cells.into_iter().chain(ours));
        let paper = row.paper.hits.iter().zip(row.paper.relevant_hits);
        let paper = paper.map(|(hits, relevant)| joined(*hits, relevant));
        let delta = row.n_columns as isize - row.paper.n_columns as isize;
        let cells = [
            String::new(),
            row.paper.n_relevant.to_string(),
            "paper".to_owned(),
            row.paper.n_columns.to_string(),
            format!("{delta:+}"),
        ];
        printed.add_row(cells.into_iter().chain(paper));
    }
    let largest = rows
        .iter()
        .map(|row| row.n_columns.abs_diff(row.paper.n_columns));
    Ok(format!(
        "Table 2: hits / relevant hits; the paper's hits are over clips of 64 classes, ours over those of {}; of \
         squats the paper prints hits alone\n{}\n\
         relevant hits: sum of differences {} over {} cells (at most 24 wanted); length: largest difference {} (at most \
         3 wanted)\n\n",
        work.classes.len(),
        printed.trim_fmt(),
        off_by(&rows),
        rows.len() * TAUS.len(),
        largest.max().unwrap_or(0)
    ))
}
