//! The paper's three examples of retrieval on our recordings: how good the hits are.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::fmt::Write;

use anyhow::{Context, Result};

use crate::asked::{Asked, check_fewer_find_more, stretch_of};
use crate::clips::{Clip, Part};
use crate::indexing::PartIndex;
use crate::judgement::{Judgement, Quality, Stretch};
use crate::motions::{EXAMPLES, Example, Selection};
use crate::table::{Table, mean, median, number};

/// Ranks that are listed and whose precision is stated.
const TOP: usize = 10;
/// Kinds of irrelevant clips that are named.
const OTHERS: usize = 4;

/// All examples on the indexes of one rate.
pub(crate) fn report(clips: &[Clip], indexes: &[PartIndex]) -> Result<String> {
    let mut text = format!(
        "Retrieval examples at {} Hz: adaptive fuzzy hits, ranked by difference of segment lengths\n\
         Means (medians) over all queries; hits include the query's own, the rest leaves it out. prec: relevant share of\n\
         all judged hits, which is also what the first {TOP} have on average when not ranked; top: that of the first {TOP}\n\
         by rank; both over the queries that find anything else. lead: relevant hits before the first other. rec: share of\n\
         the other relevant clips that are found. alone: queries that find nothing else. ms: median.\n\
         The first and the last segment of a query cut out of a take count with the length that they have in the take,\n\
         since those of hits are whole runs; squats and kicks are clips of their own.\n",
        indexes.first().map_or(f64::NAN, |index| index.rate)
    );
    for example in &EXAMPLES {
        let part = indexes.iter().find(|index| index.part == example.part);
        text += &example.report(clips, part.context("an index of every part")?)?;
    }
    Ok(text)
}

impl Example {
    fn report(&self, clips: &[Clip], part: &PartIndex) -> Result<String> {
        let judged: Vec<Judgement> = clips.iter().map(|clip| self.judgement(clip)).collect();
        let stretches = self.stretches(part, &judged);
        let count = |what| judged.iter().filter(|j| **j == what).count();
        let mut text = format!(
            "\n{}\n{} queries, {} relevant clips, {} not judged\n\n",
            self.title,
            stretches.len(),
            count(Judgement::Relevant),
            count(Judgement::Unjudged)
        );
        let mut table = Table::new([
            "features", "segs", "hits", "alone", "prec", "top", "lead", "rec", "ms", "paper",
        ]);
        let mut others = String::new();
        let mut all: Vec<Vec<Asked>> = Vec::new();
        for selection in self.selections {
            let ask = |stretch| Asked::ask(part, stretch, selection.care(), &judged);
            let asked: Vec<Asked> = stretches.iter().map(ask).collect::<Result<_>>()?;
            table.row(selection.row(part.part, &asked));
            let name = selection.name(part.part);
            writeln!(
                others,
                "  Others by {name}: {}",
                others_show(clips, &judged, &asked)
            )?;
            all.push(asked);
        }
        self.check(&all)?;
        write!(
            text,
            "{table}\n{others}  Each hit lies inside a hit by fewer features, for every query.\n"
        )?;
        if let (Some(selection), Some(asked)) = (self.selections.first(), all.first()) {
            text += &spell_out(clips, &judged, selection, part, asked)?;
        }
        Ok(text)
    }

    /// The queries.
    fn stretches(&self, part: &PartIndex, judged: &[Judgement]) -> Vec<Stretch> {
        let documents = part.words.iter().enumerate();
        let relevant = documents.filter(|(doc, _)| judged[*doc] == Judgement::Relevant);
        relevant
            .flat_map(|(doc, words)| {
                let spans = (self.queries)(words).into_iter();
                spans.map(move |span| Stretch { doc, span })
            })
            .collect()
    }

    /// Holds every selection against those of fewer of its features.
    fn check(&self, all: &[Vec<Asked>]) -> Result<()> {
        for (more, more_asked) in self.selections.iter().zip(all) {
            for (fewer, fewer_asked) in self.selections.iter().zip(all) {
                if fewer.care() != more.care() && fewer.care() & !more.care() == 0 {
                    check_fewer_find_more(more_asked, fewer_asked)?;
                }
            }
        }
        Ok(())
    }
}

/// What the irrelevant hits of all queries show, the most frequent first.
fn others_show(clips: &[Clip], judged: &[Judgement], asked: &[Asked]) -> String {
    let hits = asked.iter().flat_map(|a| &a.hits);
    let docs = hits.map(|hit| hit.doc.index());
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for doc in docs.filter(|doc| judged[*doc] == Judgement::Other) {
        *counts.entry(&clips[doc].shows).or_default() += 1;
    }
    let total: usize = counts.values().sum();
    let mut ranked: Vec<(&str, usize)> = counts.into_iter().collect();
    ranked.sort_by_key(|&(_, n)| Reverse(n));
    ranked.truncate(OTHERS);
    let share = |(shows, n)| format!("{shows} {:.0} %", 100.0 * n as f64 / total as f64);
    match total {
        0 => "none".to_owned(),
        _ => ranked.into_iter().map(share).collect::<Vec<_>>().join(", "),
    }
}

/// `mean (median)`.
fn both(values: &[f64], decimals: usize) -> String {
    let (mean, median) = (mean(values), median(values));
    format!("{} ({})", number(mean, decimals), number(median, decimals))
}

impl Selection {
    fn row(&self, part: Part, asked: &[Asked]) -> [String; 10] {
        let of = |value: fn(&Asked) -> f64| asked.iter().map(value).collect::<Vec<f64>>();
        let some = |value: fn(&Quality) -> Option<f64>| {
            let values = asked.iter().filter_map(|a| value(&a.quality));
            values.collect::<Vec<f64>>()
        };
        let n_alone = asked.iter().filter(|a| a.quality.ranked.is_empty()).count();
        let leading = asked.iter().map(|a| a.quality.n_leading() as f64);
        [
            self.name(part),
            both(&of(|a| a.query.positions().len() as f64), 0),
            both(&of(|a| a.hits.len() as f64), 0),
            n_alone.to_string(),
            both(&some(Quality::precision), 2),
            both(&some(|quality| quality.precision_at(TOP)), 2),
            both(&leading.collect::<Vec<f64>>(), 0),
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
    let Some(Asked {
        stretch,
        query,
        hits,
        quality,
        ..
    }) = representative(asked)
    else {
        return Ok(text);
    };
    let place = |stretch: &Stretch| {
        format!(
            "{} {}-{}",
            clips[stretch.doc].name, stretch.span.start, stretch.span.end
        )
    };
    let n_relevant = quality.ranked.iter().filter(|hit| **hit).count();
    writeln!(text, "\n  One of middling recall: {}", place(stretch))?;
    let bits = |word: u64| {
        let bit = |number: &u32| {
            if word >> (number - 1) & 1 == 1 {
                '1'
            } else {
                '0'
            }
        };
        selection.features.iter().map(bit).collect::<String>()
    };
    let mut steps = Vec::new();
    for position in query.positions() {
        let value = position.set.masks().first().map_or(0, |mask| mask.value());
        steps.push(format!(
            "{} x{}",
            bits(value),
            position.n_frames.unwrap_or(0)
        ));
    }
    writeln!(
        text,
        "  {}: {}",
        selection.name(part.part),
        steps.join(", ")
    )?;
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
        table.row([
            format!("{rank}"),
            hit.cost.to_string(),
            mark.to_owned(),
            place(&found),
        ]);
    }
    writeln!(text, "\n{table}")?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use segidx::Query;

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
