//! The paper's three examples of retrieval (section 6.2, Figures 7 to 9) on our recordings.

use std::fmt::Write;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use segidx::{Hit, Query, Segment, search_adaptive, segment};

use crate::clips::{Clip, Part};
use crate::indexing::PartIndex;
use crate::judgement::{Judgement, Quality, Stretch};
use crate::naive::coarsen;
use crate::table::{Table, mean, median, number};

/// Ranks that are listed and whose precision is stated.
const TOP: usize = 10;

/// Features by which a motion is looked for, by their numbers in the paper.
struct Selection {
    features: &'static [u32],
    /// Positions and hits of the paper's query.
    paper: &'static str,
}

impl Selection {
    fn care(&self) -> u64 {
        care(self.features)
    }

    fn name(&self, part: Part) -> String {
        let names = self.features.iter().map(|n| format!("F{}{n}", part.letter()));
        names.collect::<Vec<_>>().join(" ")
    }
}

fn care(features: &[u32]) -> u64 {
    features.iter().fold(0, |bits, number| bits | 1 << (number - 1))
}

struct Example {
    title: &'static str,
    part: Part,
    /// What relevant clips show, and what others show that hold the motion among others.
    relevant: &'static [&'static str],
    unjudged: &'static [&'static str],
    /// Query frames of a relevant clip, from its words.
    queries: fn(&[u64]) -> Vec<Segment>,
    /// The paper's first selection comes first.
    selections: &'static [Selection],
}

const fn by(features: &'static [u32], paper: &'static str) -> Selection {
    Selection { features, paper }
}

const EXAMPLES: [Example; 3] = [
    Example {
        title: "Punch (Fig. 7). Queries: left hand punches in clips described as boxing or punch",
        part: Part::Upper,
        relevant: &["punch", "boxing"],
        unjudged: &[],
        queries: left_punches,
        selections: &[
            by(&[1, 2, 7, 8], "6 segs, 16 hits"),
            by(&[2, 8], "4 segs, 264 hits"),
            by(&[1, 2, 3, 4, 7, 8], "8 segs, 1 hit"),
        ],
    },
    Example {
        title: "Squat (Fig. 8). Queries: every clip of squat1Reps; trials of several exercises are not judged",
        part: Part::Lower,
        relevant: &["squat1Reps"],
        unjudged: &["squat"],
        queries: whole_clip,
        selections: &[
            by(&[5, 6, 7, 10, 11], "5 segs, 33 hits: 7 squats of 11, on top"),
            by(&[7, 10, 11], "5 segs, 63 hits: the same 7 on top"),
        ],
    },
    Example {
        title: "Kick (Fig. 9). Queries: every clip of kickLFront1Reps; kicks of CMU are not judged",
        part: Part::Lower,
        relevant: &["kickLFront1Reps"],
        unjudged: &["kick", "Kick"],
        queries: whole_clip,
        selections: &[
            by(&[3, 4, 7, 8], "19 hits: 13 kicks of 13"),
            by(&[4, 8], "more hits"),
            by(&[4], "more hits"),
        ],
    },
];

fn whole_clip(words: &[u64]) -> Vec<Segment> {
    let (word, start, len) = (0, 0, words.len());
    vec![Segment { word, start, len }]
}

/// Left hand in front, left elbow bent.
const LEFT_HAND_FRONT: u64 = 1 << 1;
const LEFT_ELBOW_BENT: u64 = 1 << 7;
/// Segments of the paper's query.
const PUNCH_SEGMENTS: usize = 6;

/// Stretches of six segments by the features of the paper's query that begin and end with a bent
/// left elbow, between which the arm is straight with its hand in front.
fn left_punches(words: &[u64]) -> Vec<Segment> {
    let segments = coarsen(&segment(words), care(&[1, 2, 7, 8]));
    let is_bent = |s: &Segment| s.word & LEFT_ELBOW_BENT != 0;
    let is_blow = |s: &Segment| !is_bent(s) && s.word & LEFT_HAND_FRONT != 0;
    let windows = segments.windows(PUNCH_SEGMENTS);
    let punches = windows.filter(|window| {
        let (first, last) = (&window[0], &window[PUNCH_SEGMENTS - 1]);
        is_bent(first) && is_bent(last) && window.iter().any(is_blow)
    });
    let whole = |window: &[Segment]| Segment {
        len: window.iter().map(|s| s.len).sum(),
        ..window[0]
    };
    punches.map(whole).collect()
}

/// A query of an example by one selection, and its hits in order of rank.
struct Asked {
    stretch: Stretch,
    query: Query,
    hits: Vec<Hit>,
    ms: f64,
    quality: Quality,
}

impl Asked {
    fn ask(part: &PartIndex, stretch: &Stretch, care: u64, judged: &[Judgement]) -> Result<Asked> {
        let query = Query::fuzzy(&part.words[stretch.doc][stretch.span.clone()], care);
        let start = Instant::now();
        let hits = search_adaptive(&part.index, &query)?;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let stretches: Vec<Stretch> = hits.iter().map(stretch_of).collect();
        let is_itself = |hit: &Stretch| hit.contains(stretch);
        ensure!(stretches.iter().any(is_itself), "{stretch:?} does not find itself");
        Ok(Asked {
            quality: Quality::of(stretch, &stretches, judged),
            stretch: stretch.clone(),
            query,
            hits,
            ms,
        })
    }
}

fn stretch_of(hit: &Hit) -> Stretch {
    Stretch {
        doc: hit.doc.index(),
        span: hit.span(),
    }
}

/// Every hit by more features lies inside one by fewer, and if the query by fewer still has two
/// positions, no two in the same: where two of its positions meet fixes where those of the other do.
fn check_fewer_find_more(more: &[Asked], fewer: &[Asked]) -> Result<()> {
    for (more, fewer) in more.iter().zip(fewer) {
        let wider: Vec<Stretch> = fewer.hits.iter().map(stretch_of).collect();
        let stretches = more.hits.iter().map(stretch_of);
        let mut homes = stretches.map(|hit| wider.iter().position(|wide| wide.contains(&hit)));
        ensure!(
            homes.all(|home| home.is_some()),
            "{:?}: a hit by more features is lost by fewer",
            more.stretch
        );
        ensure!(
            fewer.query.positions().len() < 2 || more.hits.len() <= fewer.hits.len(),
            "{:?}: fewer features have fewer hits",
            more.stretch
        );
    }
    Ok(())
}

/// All examples on the indexes of one rate.
pub(crate) fn report(clips: &[Clip], indexes: &[PartIndex; 3]) -> Result<String> {
    let mut text = format!(
        "Retrieval examples at {} Hz: adaptive fuzzy hits, ranked by difference of segment lengths\n\
         Means (medians) over all queries; hits include the query's own, the rest leaves it out. prec: relevant share of\n\
         all judged hits, which is also what the first {TOP} have on average when not ranked; top: that of the first {TOP}\n\
         by rank; both over the queries that find anything else. rec: share of the other relevant clips that are found.\n",
        indexes[0].rate
    );
    for example in &EXAMPLES {
        let part = indexes.iter().find(|index| index.part == example.part);
        text += &example.report(clips, part.context("an index of every part")?)?;
    }
    Ok(text)
}

impl Example {
    fn judgement(&self, clip: &Clip) -> Judgement {
        let shows_one = |of: &[&str]| of.iter().any(|what| clip.shows.contains(what));
        if shows_one(self.relevant) {
            Judgement::Relevant
        } else if shows_one(self.unjudged) {
            Judgement::Unjudged
        } else {
            Judgement::Other
        }
    }

    fn report(&self, clips: &[Clip], part: &PartIndex) -> Result<String> {
        let judged: Vec<Judgement> = clips.iter().map(|clip| self.judgement(clip)).collect();
        let mut stretches = Vec::new();
        for (doc, words) in part.words.iter().enumerate() {
            if judged[doc] == Judgement::Relevant {
                let spans = (self.queries)(words).into_iter().map(|s| s.span());
                stretches.extend(spans.map(|span| Stretch { doc, span }));
            }
        }
        let mut text = format!("\n{}\n", self.title);
        let n_relevant = judged.iter().filter(|j| **j == Judgement::Relevant).count();
        let n_unjudged = judged.iter().filter(|j| **j == Judgement::Unjudged).count();
        let n_queries = stretches.len();
        writeln!(text, "{n_queries} queries, {n_relevant} relevant clips, {n_unjudged} not judged\n")?;
        let head = [
            "features", "segs", "hits", "alone", "prec", "top", "rec", "median ms", "paper",
        ];
        let mut table = Table::new(head);
        let mut asked: Vec<Vec<Asked>> = Vec::new();
        for selection in self.selections {
            let ask = |stretch| Asked::ask(part, stretch, selection.care(), &judged);
            let answers: Result<Vec<Asked>> = stretches.iter().map(ask).collect();
            let answers = answers?;
            table.row(selection.row(part.part, &answers));
            asked.push(answers);
        }
        writeln!(text, "{table}")?;
        for (more, more_asked) in self.selections.iter().zip(&asked) {
            for (fewer, fewer_asked) in self.selections.iter().zip(&asked) {
                if fewer.care() != more.care() && fewer.care() & !more.care() == 0 {
                    check_fewer_find_more(more_asked, fewer_asked)?;
                }
            }
        }
        text += "  Fewer features find all that more do, for every query: each hit lies inside one by fewer.\n";
        if let (Some(selection), Some(asked)) = (self.selections.first(), asked.first()) {
            text += &spell_out(clips, &judged, selection, part, asked)?;
        }
        Ok(text)
    }
}

/// `mean (median)`.
fn both(values: &[f64], decimals: usize) -> String {
    let (mean, median) = (mean(values), median(values));
    format!("{} ({})", number(mean, decimals), number(median, decimals))
}

impl Selection {
    fn row(&self, part: Part, asked: &[Asked]) -> [String; 9] {
        let of = |value: fn(&Asked) -> f64| asked.iter().map(value).collect::<Vec<f64>>();
        let some = |value: fn(&Quality) -> Option<f64>| {
            let values = asked.iter().filter_map(|a| value(&a.quality));
            values.collect::<Vec<f64>>()
        };
        let n_alone = asked.iter().filter(|a| a.quality.ranked.is_empty()).count();
        [
            self.name(part),
            both(&of(|a| a.query.positions().len() as f64), 0),
            both(&of(|a| a.hits.len() as f64), 0),
            n_alone.to_string(),
            both(&some(Quality::precision), 2),
            both(&some(|quality| quality.precision_at(TOP)), 2),
            both(&some(Quality::recall), 2),
            number(median(&of(|a| a.ms)), 3),
            self.paper.to_owned(),
        ]
    }
}

/// The query in the middle by relevant hits, of equal ones the first.
fn representative(asked: &[Asked]) -> Option<&Asked> {
    let n_relevant = |a: &Asked| a.quality.ranked.iter().filter(|hit| **hit).count();
    let mut sorted: Vec<&Asked> = asked.iter().collect();
    sorted.sort_by_key(|a| n_relevant(a));
    let middle = n_relevant(sorted.get(sorted.len().checked_sub(1)? / 2)?);
    asked.iter().find(|a| n_relevant(a) == middle)
}

fn spell_out(
    clips: &[Clip],
    judged: &[Judgement],
    selection: &Selection,
    part: &PartIndex,
    asked: &[Asked],
) -> Result<String> {
    let mut text = String::new();
    let Some(Asked { stretch, query, hits, quality, .. }) = representative(asked) else {
        return Ok(text);
    };
    let place = |stretch: &Stretch| {
        format!("{} {}-{}", clips[stretch.doc].name, stretch.span.start, stretch.span.end)
    };
    let n_relevant = quality.ranked.iter().filter(|hit| **hit).count();
    writeln!(text, "\n  One of middling recall: {}", place(stretch))?;
    let bits = |word: u64| {
        let bit = |number: &u32| if word >> (number - 1) & 1 == 1 { '1' } else { '0' };
        selection.features.iter().map(bit).collect::<String>()
    };
    let mut steps = Vec::new();
    for position in query.positions() {
        let value = position.set.masks().first().map_or(0, |mask| mask.value());
        steps.push(format!("{} x{}", bits(value), position.n_frames.unwrap_or(0)));
    }
    writeln!(text, "  {}: {}", selection.name(part.part), steps.join(", "))?;
    writeln!(
        text,
        "  {} hits; besides itself {} judged, {n_relevant} relevant, of which {} before any other",
        hits.len(),
        quality.ranked.len(),
        quality.n_leading()
    )?;
    let mut table = Table::new(["rank", "cost", "", "clip and frames"]);
    for (rank, hit) in (1..).zip(hits).take(TOP) {
        let found = stretch_of(hit);
        let mark = match judged[found.doc] {
            _ if found.overlaps(stretch) => "itself",
            Judgement::Relevant => "relevant",
            Judgement::Unjudged => "not judged",
            Judgement::Other => "other",
        };
        table.row([format!("{rank}"), hit.cost.to_string(), mark.to_owned(), place(&found)]);
    }
    writeln!(text, "\n{table}")?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_are_counted_from_1() {
        assert_eq!(care(&[1, 2, 7, 8]), 0b1100_0011);
        assert_eq!(care(&[1, 2, 7, 8]) & (LEFT_HAND_FRONT | LEFT_ELBOW_BENT), 0b1000_0010);
    }

    #[test]
    fn a_punch_stretches_the_left_arm_between_bends() {
        let [bent, both, blow, back] = [0x80, 0x82, 0x02, 0x40];
        // An unrelated bit changes within the first segment.
        let punch = [bent, bent | 4, both, blow, both, bent, both];
        let found = left_punches(&punch);
        assert_eq!(found.iter().map(Segment::span).collect::<Vec<_>>(), [0..7]);
        assert_eq!(left_punches(&[bent, both, bent, both, bent, both]), []);
        assert_eq!(left_punches(&[back, bent, both, blow, both, back]), []);
    }

    #[test]
    fn the_middle_query_is_the_first_of_its_kind() {
        let asked = |doc: usize, ranked: &[bool]| Asked {
            stretch: Stretch { doc, span: 0..1 },
            query: Query::default(),
            hits: Vec::new(),
            ms: 0.0,
            quality: Quality {
                ranked: ranked.to_vec(),
                found: (0, 0),
            },
        };
        let all = [
            asked(0, &[true, true]),
            asked(1, &[true]),
            asked(2, &[false, true]),
            asked(3, &[]),
        ];
        assert_eq!(representative(&all).map(|a| a.stretch.doc), Some(1));
        assert!(representative(&[]).is_none());
    }
}
