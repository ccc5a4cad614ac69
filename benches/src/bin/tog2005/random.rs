//! Table 3: random queries, by mode, length and number of hits.

use std::hint::black_box;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use segidx::{Hit, Index, search_adaptive, search_exact};

use crate::indexing::PartIndex;
use crate::naive::{Place, scan};
use crate::queries::{Dice, Excerpt, Mode};
use crate::table::{Table, mean, median, number};

const QUERIES: usize = 10_000;
const SEED: u64 = 2005;

/// Passes over all queries of a scenario; the time of a query is the median of its times.
const PASSES: usize = 3;

/// One query in this many is also answered by the naive scan.
const SAMPLE: usize = 50;

/// Mean milliseconds that queries with 1 to 9 hits are to take.
const LIMIT_MS: f64 = 0.05;

/// Groups of the paper, by number of hits.
const GROUPS: [(&str, std::ops::Range<usize>); 3] = [
    ("1-9", 1..10),
    ("10-99", 10..100),
    (">=100", 100..usize::MAX),
];

/// Mean and standard deviation of the hits, mean milliseconds.
type Figures = [f64; 3];

struct Scenario {
    mode: Mode,
    n_positions: usize,
    /// The paper's figures per group, in the index of 180 minutes.
    paper: [Figures; 3],
}

const fn scenario(mode: Mode, n_positions: usize, paper: [Figures; 3]) -> Scenario {
    Scenario {
        mode,
        n_positions,
        paper,
    }
}

const SCENARIOS: [Scenario; 6] = [
    scenario(
        Mode::Exact,
        5,
        [[3.0, 2.4, 16.0], [44.0, 28.0, 20.0], [649.0, 567.0, 144.0]],
    ),
    scenario(
        Mode::Exact,
        10,
        [[1.7, 1.6, 17.0], [34.0, 22.0, 26.0], [239.0, 147.0, 71.0]],
    ),
    scenario(
        Mode::Exact,
        20,
        [[1.1, 0.6, 19.0], [32.0, 26.0, 36.0], [130.0, 5.0, 52.0]],
    ),
    scenario(
        Mode::Fuzzy,
        5,
        [
            [3.6, 2.5, 23.0],
            [44.0, 27.0, 29.0],
            [1878.0, 1101.0, 291.0],
        ],
    ),
    scenario(
        Mode::Fuzzy,
        10,
        [
            [2.4, 2.1, 28.0],
            [40.0, 26.0, 35.0],
            [1814.0, 1149.0, 281.0],
        ],
    ),
    scenario(
        Mode::Fuzzy,
        20,
        [
            [2.0, 1.9, 42.0],
            [36.0, 24.0, 35.0],
            [1908.0, 1152.0, 294.0],
        ],
    ),
];

impl Scenario {
    fn name(&self) -> String {
        let mode = match self.mode {
            Mode::Exact => "exact",
            Mode::Fuzzy => "fuzzy",
        };
        format!("{mode}, |Q| = {}", self.n_positions)
    }
}

/// A query that was answered.
#[derive(Clone, Copy, Debug)]
struct Answered {
    n_hits: usize,
    ms: f64,
}

/// The queries of a scenario on one index.
struct Answers {
    answered: Vec<Answered>,
    /// Milliseconds of the naive scan and of the search, for the queries both answered.
    compared: Vec<(f64, f64)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Group {
    n_queries: usize,
    mean_hits: f64,
    /// Of all queries of the group, not of a sample.
    deviation: f64,
    mean_ms: f64,
    median_ms: f64,
}

impl Group {
    fn of(answered: &[Answered]) -> Option<Group> {
        let hits: Vec<f64> = answered.iter().map(|a| a.n_hits as f64).collect();
        let ms: Vec<f64> = answered.iter().map(|a| a.ms).collect();
        let mean_hits = mean(&hits)?;
        let squares: Vec<f64> = hits.iter().map(|h| (h - mean_hits).powi(2)).collect();
        Some(Group {
            n_queries: answered.len(),
            mean_hits,
            deviation: mean(&squares)?.sqrt(),
            mean_ms: mean(&ms)?,
            median_ms: median(&ms)?,
        })
    }

    fn cells(group: Option<&Group>) -> [String; 5] {
        let of = |figure: fn(&Group) -> f64, decimals| number(group.map(figure), decimals);
        [
            group.map_or(0, |g| g.n_queries).to_string(),
            of(|g| g.mean_hits, 1),
            of(|g| g.deviation, 1),
            of(|g| g.mean_ms, 4),
            of(|g| g.median_ms, 4),
        ]
    }
}

/// By number of hits; a group without queries is `None`.
fn grouped(answered: &[Answered]) -> [Option<Group>; 3] {
    GROUPS.map(|(_, range)| {
        let of_group = answered.iter().filter(|a| range.contains(&a.n_hits));
        Group::of(&of_group.copied().collect::<Vec<_>>())
    })
}

fn search(index: &Index, excerpt: &Excerpt, mode: Mode) -> Result<(Vec<Hit>, f64)> {
    let query = excerpt.query();
    let start = Instant::now();
    let hits = match mode {
        Mode::Exact => search_exact(index, &query),
        Mode::Fuzzy => search_adaptive(index, &query),
    };
    let ms = start.elapsed().as_secs_f64() * 1e3;
    Ok((hits?, ms))
}

fn answer(part: &PartIndex, scenario: &Scenario, seed: u64) -> Result<Answers> {
    let documents = part.segments();
    let mut dice = Dice::seeded(seed);
    let excerpts: Option<Vec<Excerpt>> = (0..QUERIES)
        .map(|_| {
            dice.excerpt(
                &documents,
                part.n_features,
                (scenario.mode, scenario.n_positions),
            )
        })
        .collect();
    let excerpts = excerpts.context("no document is long enough for the queries")?;
    let mut times = vec![Vec::new(); QUERIES];
    for _ in 0..PASSES {
        for (excerpt, times) in excerpts.iter().zip(&mut times) {
            times.push(search(&part.index, excerpt, scenario.mode)?.1);
        }
    }
    let mut answers = Answers {
        answered: Vec::new(),
        compared: Vec::new(),
    };
    for (number, (excerpt, times)) in excerpts.iter().zip(&times).enumerate() {
        let (hits, _) = search(&part.index, excerpt, scenario.mode)?;
        ensure!(!hits.is_empty(), "query {number} does not find itself");
        let ms = median(times).unwrap_or(f64::NAN);
        let n_hits = hits.len();
        answers.answered.push(Answered { n_hits, ms });
        if number.is_multiple_of(SAMPLE) {
            let start = Instant::now();
            let expected = black_box(scan(&documents, &excerpt.segments, excerpt.care));
            answers
                .compared
                .push((start.elapsed().as_secs_f64() * 1e3, ms));
            let places: Vec<Place> = hits.into_iter().map(place).collect();
            let name = scenario.name();
            ensure!(
                places == expected,
                "{name}: query {number} differs from the naive scan"
            );
        }
    }
    Ok(answers)
}

fn place(hit: Hit) -> Place {
    Place {
        cost: hit.cost,
        doc: hit.doc,
        segments: hit.segments,
    }
}

/// The paper's Table 3 and ours, for each index; then ours beside the naive scan.
pub(crate) fn table(indexes: &[&PartIndex]) -> Result<String> {
    let mut text = format!(
        "Table 3: {QUERIES} random queries per scenario, seed {SEED}, each alone on one thread, whole search call\n\
         A query is an excerpt of |Q| consecutive segments of one clip, all such excerpts being as likely. Fuzzy: 6 of\n\
         the 12 features are drawn to be free for each query, so each fuzzy set has 2^6 = 64 words, and the |Q| segments\n\
         are those of the other 6. The time of a query is the median of {PASSES} passes. n: queries; hits: mean and\n\
         deviation. The paper's index has 135742 segments.\n"
    );
    for part in indexes {
        let title = format!("I_{} at {} Hz", part.part.letter(), part.rate);
        text += &format!("\n{title}, {} segments\n\n", part.index.n_segments());
        let head = [
            "queries",
            "hits",
            "n",
            "hits",
            "dev",
            "mean ms",
            "median ms",
            "paper hits",
            "dev",
            "ms",
        ];
        let mut table = Table::new(head);
        let mut versus = Table::new(["queries", "checked", "search ms", "naive ms", "ratio"]);
        let mut slowest: f64 = 0.0;
        for (seed, scenario) in (SEED..).zip(&SCENARIOS) {
            let answers = answer(part, scenario, seed)?;
            let groups = grouped(&answers.answered);
            slowest = slowest.max(groups[0].map_or(0.0, |g| g.mean_ms));
            for ((name, _), (group, paper)) in GROUPS.iter().zip(groups.iter().zip(scenario.paper))
            {
                let [n, hits, deviation, mean_ms, median_ms] = Group::cells(group.as_ref());
                let [paper_hits, paper_deviation, paper_ms] =
                    paper.map(|figure| figure.to_string());
                table.row([
                    scenario.name(),
                    (*name).to_owned(),
                    n,
                    hits,
                    deviation,
                    mean_ms,
                    median_ms,
                    paper_hits,
                    paper_deviation,
                    paper_ms,
                ]);
            }
            let (naive, ours): (Vec<f64>, Vec<f64>) = answers.compared.into_iter().unzip();
            let (naive_ms, ms) = (median(&naive), median(&ours));
            versus.row([
                scenario.name(),
                naive.len().to_string(),
                number(ms, 4),
                number(naive_ms, 3),
                number(naive_ms.zip(ms).map(|(naive, ours)| naive / ours), 1),
            ]);
        }
        let verdict = if slowest <= LIMIT_MS {
            "kept"
        } else {
            "missed"
        };
        text += &format!(
            "{table}\n  1-9 hits: slowest mean {slowest:.4} ms, limit {LIMIT_MS} ms: {verdict}\n\n\
             Every {SAMPLE}th query against a scan of all segments without an index: same hits, same order; medians\n\n\
             {versus}"
        );
    }
    text.push('\n');
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answered(hits: &[usize]) -> Vec<Answered> {
        let ms = |n_hits| n_hits as f64 / 2.0;
        hits.iter()
            .map(|&n_hits| Answered {
                n_hits,
                ms: ms(n_hits),
            })
            .collect()
    }

    #[test]
    fn groups_are_the_papers() {
        let [few, some, many] = grouped(&answered(&[1, 9, 10, 99, 3]));
        let few = few.unwrap();
        assert_eq!((few.n_queries, some.unwrap().n_queries), (3, 2));
        assert_eq!(many, None);
        assert_eq!(grouped(&answered(&[100]))[2].unwrap().n_queries, 1);
    }

    #[test]
    fn figures_are_mean_deviation_and_median() {
        // 2, 4, 4, 4, 5, 5, 7, 9 have mean 5 and deviation 2.
        let group = Group::of(&answered(&[2, 4, 4, 4, 5, 5, 7, 9])).unwrap();
        assert_eq!((group.mean_hits, group.deviation), (5.0, 2.0));
        assert_eq!((group.mean_ms, group.median_ms), (2.5, 2.0));
        assert_eq!(Group::cells(None), ["0", "-", "-", "-", "-"]);
    }
}
