//! Table 4: templates beside a single example.

use anyhow::{Context, Result};
use cli::eval::baseline::{Baseline, match_example};
use cli::eval::hits::Response;
use cli::eval::metrics::{Separation, TOPS, relevant_in_top, separation};
use cli::eval::split::Role;
use cli::eval::{Trial, responses};
use cli::output::table;

use crate::work::{Work, method};

/// Test clips of each class: the paper has ten of each of ten classes.
const PER_CLASS: usize = 10;

/// Folder, then for MT, RF, Q and 3D relevant clips among 5, 10 and 20 hits with the quotient.
const PUBLISHED: [(&str, [&str; 4]); 3] = [
    (
        "squat1Reps",
        ["5/10/10 259.5", "5/10/10 16.1", "5/7/9 2.79", "4/6/7 2.52"],
    ),
    (
        "lieDownFloor",
        ["5/9/10 11.65", "5/9/10 2.10", "4/7/9 1.69", "2/3/7 1.29"],
    ),
    (
        "grabHighR",
        ["5/7/9 33.93", "3/8/8 9.72", "3/5/8 3.39", "1/3/4 2.22"],
    ),
];

pub(crate) fn report(work: &Work) -> Result<String> {
    let (clips, roles) = few(work);
    let trial = Trial {
        clips: &clips,
        roles: &roles,
        ..work.trial()
    };
    let mut rows = table(&["class", "relevant", "", "MT", "RF", "Q", "3D"]);
    for (class, name) in work.classes.iter().enumerate() {
        let learned = work.learned[class]
            .as_ref()
            .context("a class without training clips")?;
        let method = method();
        let template = learned.learned.template.quantize(method.delta)?;
        let relevant = trial.relevance(class);
        let of_template = responses(&template.with_steps(method.steps), &trial, method.documents);
        let mut cells = vec![cell(&of_template, &relevant)];
        for baseline in Baseline::ALL {
            let responses = match_example(&trial, class, baseline, method.documents)?;
            cells.push(responses.map_or_else(String::new, |r| cell(&r, &relevant)));
        }
        let n_relevant = relevant.iter().filter(|r| **r).count().to_string();
        let heads = [name.clone(), n_relevant, "ours".to_owned()];
        rows.add_row(heads.into_iter().chain(cells));
        if let Some((_, paper)) = PUBLISHED.iter().find(|row| row.0 == name) {
            let heads = [String::new(), "10".to_owned(), "paper".to_owned()];
            rows.add_row(heads.into_iter().chain(paper.map(str::to_owned)));
        }
    }
    Ok(format!(
        "Table 4: relevant clips among the best 5/10/20 hits, and separation quotient; ours over up to {PER_CLASS} test clips of each \
         of {} classes, the paper's over other clips\n{}\n\n",
        work.classes.len(),
        rows.trim_fmt()
    ))
}

/// All training clips and the first test clips of each class.
fn few(work: &Work) -> (Vec<cli::eval::clips::Clip>, Vec<Role>) {
    let mut n_tests = vec![0; work.classes.len()];
    let all = work.clips.iter().cloned().zip(work.roles.iter().copied());
    let kept = all.filter(|(clip, role)| {
        let n = &mut n_tests[clip.class];
        *n += usize::from(*role == Role::Test);
        *role == Role::Train || *n <= PER_CLASS
    });
    kept.unzip()
}

fn cell(responses: &[Response], relevant: &[bool]) -> String {
    let tops = TOPS.map(|n| relevant_in_top(responses, relevant, n).to_string());
    let quotient = match separation(responses, relevant) {
        Separation::Quotient(quotient) => format!("{quotient:.2}"),
        Separation::Infinite => "inf".to_owned(),
        Separation::Undefined => "-".to_owned(),
    };
    format!("{} {quotient}", tops.join("/"))
}
