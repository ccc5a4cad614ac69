//! Alignments.

use crate::commands::align::DEFAULT_MAX_DISTANCE;
use crate::report::document::{AlignmentPage, Fact};
use crate::report::make::Maker;
use crate::report::pictures;
use crate::report::results::{AlignRead, StepRead};

/// Two clips and the path that warps one to the other; `None` if they were not aligned or cannot be read.
pub fn page(maker: &mut Maker<'_>, read: &AlignRead) -> Option<AlignmentPage> {
    let found = read.alignment.as_ref()?;
    let (a, b) = (maker.clip(&read.a.clip)?, maker.clip(&read.b.clip)?);
    let fact = |name: &str, value: String| Fact {
        name: name.to_owned(),
        value,
    };
    let mut facts = vec![
        fact("mean distance", format!("{:.3} m", found.mean_distance)),
        fact("cost", format!("{:.3} m", found.cost)),
        fact("steps", format!("{} at {} Hz", found.path.len(), read.rate)),
        fact(
            "cells computed",
            format!("{:.1} % of {}", 100.0 * found.cells.share, found.cells.full),
        ),
    ];
    if let Some(excess) = found.excess {
        facts.push(fact("above full DTW", format!("{:.2} %", 100.0 * excess)));
    }
    let columns = columns(&found.path, maker.rate(a), read.rate);
    let from = found.path.first()?.a as f64 / maker.rate(a);
    let mean = |values: Vec<f64>| {
        let n = values.len() as f64;
        (n > 0.0).then(|| (values.iter().sum::<f64>() / n) as f32)
    };
    let costs = columns
        .iter()
        .map(|c| mean(c.iter().map(|step| step.cost).collect()));
    let costs: Vec<Option<f32>> = costs.collect();
    let rows = (0..read.points.len()).map(|point| {
        let known = |step: &&StepRead| step.points.get(point).copied().flatten();
        let columns = columns.iter();
        columns
            .map(|c| mean(c.iter().filter_map(known).collect()))
            .collect()
    });
    let rows: Vec<Vec<Option<f32>>> = rows.collect();
    let to = from + costs.len() as f64 / read.rate;
    Some(AlignmentPage {
        a,
        b,
        facts,
        path: found.path.iter().map(|step| [step.a, step.b]).collect(),
        cost: pictures::curve(&costs, "distance in m", None, ([from, to], &[])),
        points: pictures::distances(
            &read.points,
            &rows,
            DEFAULT_MAX_DISTANCE as f32,
            (read.rate, from),
        ),
    })
}

/// The steps at each pose of the first clip, `rate` of them a second; none where it has no pose.
fn columns(path: &[StepRead], source_rate: f64, rate: f64) -> Vec<Vec<&StepRead>> {
    let first = path.first().map_or(0, |step| step.a);
    let mut columns: Vec<Vec<&StepRead>> = Vec::new();
    for step in path {
        let at = (step.a.saturating_sub(first) as f64 * rate / source_rate).round() as usize;
        if columns.len() <= at {
            columns.resize(at + 1, Vec::new());
        }
        columns[at].push(step);
    }
    columns
}
