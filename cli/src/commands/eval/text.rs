//! Tables for people.

use std::io::{self, Write};

use super::json::{BaselineJson, ClassJson, EvalJson};
use crate::eval::metrics::{HitCounts, Separation};
use crate::output::{count, table};

pub(super) fn write(out: &mut dyn Write, result: &EvalJson) -> io::Result<()> {
    let mut rows = table(&[
        "class",
        "train",
        "test",
        "frames",
        "ap",
        "tau",
        "hits",
        "relevant",
        "precision",
        "recall",
        "sep",
    ]);
    for class in &result.classes {
        let at = |value: fn(&HitCounts) -> String| class.at.as_ref().map_or_else(dash, value);
        rows.add_row([
            class.class.clone(),
            class.train.to_string(),
            class.test.to_string(),
            class.template_frames.map_or_else(dash, |n| n.to_string()),
            number(class.ap),
            at(|at| number(Some(at.tau))),
            at(|at| at.hits.to_string()),
            at(|at| at.relevant_hits.to_string()),
            at(|at| number(at.precision)),
            at(|at| number(at.recall)),
            quotient(class.separation),
        ]);
    }
    writeln!(out, "{}", rows.trim_fmt())?;
    write_taus(out, result)?;
    if !result.baseline_map.is_empty() {
        write_baselines(out, result)?;
    }
    write_confusion(out, result)?;
    let map = number(result.map);
    let accuracy = number(result.accuracy);
    writeln!(out, "\nmean average precision {map}, accuracy {accuracy}")
}

fn write_taus(out: &mut dyn Write, result: &EvalJson) -> io::Result<()> {
    writeln!(out, "\nhits / relevant hits at each tau:")?;
    let taus = result.classes.iter().map(|class| &class.taus);
    let Some(taus) = taus.max_by_key(|taus| taus.len()) else {
        return Ok(());
    };
    let heads: Vec<String> = taus.iter().map(|at| at.tau.to_string()).collect();
    let heads = ["class"]
        .into_iter()
        .chain(heads.iter().map(String::as_str));
    let mut rows = table(&heads.collect::<Vec<_>>());
    for class in &result.classes {
        let cells = class.taus.iter();
        let cells = cells.map(|at| format!("{} / {}", at.hits, at.relevant_hits));
        rows.add_row([class.class.clone()].into_iter().chain(cells));
    }
    writeln!(out, "{}", rows.trim_fmt())
}

fn write_baselines(out: &mut dyn Write, result: &EvalJson) -> io::Result<()> {
    writeln!(
        out,
        "\none example instead of a template: ap; relevant clips in the best 5/10/20 hits; sep:"
    )?;
    let mut heads = vec!["class".to_owned(), "template".to_owned()];
    heads.extend(result.baseline_map.iter().map(|(b, _)| b.name().to_owned()));
    let mut rows = table(&heads.iter().map(String::as_str).collect::<Vec<_>>());
    for class in &result.classes {
        let cell = |ap, top: Option<[usize; 3]>, separation| {
            let top = top.map_or_else(dash, |top| top.map(|n| n.to_string()).join("/"));
            format!("{}; {top}; {}", number(ap), quotient(separation))
        };
        let own = |class: &ClassJson| cell(class.ap, class.top, class.separation);
        let other = |b: &BaselineJson| cell(b.ap, b.top, b.separation);
        let cells = [class.class.clone(), own(class)].into_iter();
        rows.add_row(cells.chain(class.baselines.iter().map(other)));
    }
    let means = result.baseline_map.iter().map(|(_, map)| number(*map));
    let cells = ["mean".to_owned(), number(result.map)].into_iter();
    rows.add_row(cells.chain(means));
    writeln!(out, "{}", rows.trim_fmt())
}

fn write_confusion(out: &mut dyn Write, result: &EvalJson) -> io::Result<()> {
    writeln!(out, "\ntest clips taken for another class:")?;
    let mut n_wrong = 0;
    let names = || result.classes.iter().map(|class| &class.class);
    for ((own, counts), none) in names()
        .zip(&result.confusion.counts)
        .zip(&result.confusion.none)
    {
        let others = names()
            .zip(counts)
            .filter(|(name, n)| *name != own && **n > 0);
        for (other, &n) in others {
            n_wrong += n;
            writeln!(out, "  {} of {own} for {other}", count(n, "clip"))?;
        }
        if *none > 0 {
            n_wrong += none;
            writeln!(out, "  {} of {own} for none", count(*none, "clip"))?;
        }
    }
    if n_wrong == 0 {
        writeln!(out, "  none")?;
    }
    Ok(())
}

fn dash() -> String {
    "-".to_owned()
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(dash, |value| format!("{value:.3}"))
}

fn quotient(separation: Option<Separation>) -> String {
    match separation {
        Some(Separation::Quotient(quotient)) => format!("{quotient:.2}"),
        Some(Separation::Infinite) => "inf".to_owned(),
        Some(Separation::Undefined) | None => dash(),
    }
}
