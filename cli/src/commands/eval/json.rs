//! Figures from responses.

use serde::Serialize;

use super::{OfBaselines, OfTemplates};
use crate::eval::baseline::Baseline;
use crate::eval::hits::Response;
use crate::eval::metrics::{
    HitCounts, Separation, TAUS, TOPS, average_precision, classify, count_hits, relevant_in_top,
    separation,
};
use crate::eval::split::Role;
use crate::eval::{Learned, Trial};

/// What `eval` found.
#[derive(Clone, Debug, Serialize)]
pub struct EvalJson {
    /// In alphabetical order.
    pub classes: Vec<ClassJson>,
    /// Mean of the average precisions of all classes that have one.
    pub map: Option<f64>,
    /// The same for each baseline, if asked for.
    pub baseline_map: Vec<(Baseline, Option<f64>)>,
    /// Test clips whose class was told rightly, of all.
    pub accuracy: Option<f64>,
    /// Which classes test clips were taken for.
    pub confusion: ConfusionJson,
}

/// The figures of a class.
#[derive(Clone, Debug, Serialize)]
pub struct ClassJson {
    /// Name of the folder.
    pub class: String,
    /// Number of clips learned from.
    pub train: usize,
    /// Number of test clips of the class.
    pub test: usize,
    /// Columns of the template; null for a class without training clips.
    pub template_frames: Option<usize>,
    /// Iterations that learning took.
    pub iterations: Option<usize>,
    /// Average precision of all test clips ranked by least cost; null without template or test clips.
    pub ap: Option<f64>,
    /// Hits, relevant hits, precision and recall at the threshold of the class.
    #[serde(flatten)]
    pub at: Option<HitCounts>,
    /// The same at the thresholds of the 2006 paper.
    pub taus: Vec<HitCounts>,
    /// Relevant clips among the best 5, 10 and 20 hits.
    pub top: Option<[usize; 3]>,
    /// Separation quotient: a number, "inf", or null if no correct hit is among the best ten.
    pub separation: Option<Separation>,
    /// The same for one example, if asked for.
    pub baselines: Vec<BaselineJson>,
}

/// How one example of a class does.
#[derive(Clone, Debug, Serialize)]
pub struct BaselineJson {
    /// `RF`, `Q` or `3D`.
    pub method: Baseline,
    /// As of the class.
    pub ap: Option<f64>,
    /// As of the class.
    pub top: Option<[usize; 3]>,
    /// As of the class.
    pub separation: Option<Separation>,
}

/// Which classes test clips were taken for.
#[derive(Clone, Debug, Serialize)]
pub struct ConfusionJson {
    /// For each class, how many of its test clips were taken for each class.
    pub counts: Vec<Vec<usize>>,
    /// For each class, how many could not be aligned with any template.
    pub none: Vec<usize>,
}

pub(super) fn result(
    trial: &Trial<'_>,
    taus: &[f64],
    learned: &OfTemplates,
    of_baselines: &OfBaselines,
) -> EvalJson {
    let classes = 0..trial.classes.len();
    let classes: Vec<ClassJson> = classes
        .map(|class| {
            let baselines = of_baselines.get(class).into_iter().flatten();
            let relevant = trial.relevance(class);
            let baselines = baselines.map(|(method, responses)| {
                let (ap, top, separation) = figures(responses.as_deref(), &relevant);
                let method = *method;
                BaselineJson {
                    method,
                    ap,
                    top,
                    separation,
                }
            });
            let baselines = baselines.collect();
            ClassJson {
                baselines,
                ..of_class(trial, class, taus[class], learned)
            }
        })
        .collect();
    let of_baseline = |k: usize| classes.iter().map(move |class| class.baselines.get(k)?.ap);
    let confusion = confusion(trial, taus, learned);
    let right = (0..trial.classes.len()).map(|class| confusion.counts[class][class]);
    let n_tests = trial.tests().len();
    let right: usize = right.sum();
    let baselines = Baseline::ALL.into_iter().enumerate();
    let baselines = baselines.filter(|_| !of_baselines.is_empty());
    EvalJson {
        map: mean(classes.iter().map(|class| class.ap)),
        baseline_map: baselines.map(|(k, b)| (b, mean(of_baseline(k)))).collect(),
        accuracy: (n_tests > 0).then(|| right as f64 / n_tests as f64),
        confusion,
        classes,
    }
}

fn of_class(trial: &Trial<'_>, class: usize, tau: f64, learned: &OfTemplates) -> ClassJson {
    let relevant = trial.relevance(class);
    let learned = learned[class].as_ref();
    let responses = learned.map(|learned| &learned.responses[..]);
    let (ap, top, separation) = figures(responses, &relevant);
    let count = |tau| Some(count_hits(responses?, &relevant, tau));
    ClassJson {
        class: trial.classes[class].clone(),
        train: trial.training(class).count(),
        test: relevant.iter().filter(|r| **r).count(),
        template_frames: learned.map(|l| l.learned.template.n_columns()),
        iterations: learned.map(|l| l.learned.iterations),
        ap,
        at: count(tau),
        taus: TAUS.into_iter().filter_map(count).collect(),
        top,
        separation,
        baselines: Vec::new(),
    }
}

type Figures = (Option<f64>, Option<[usize; 3]>, Option<Separation>);

fn figures(responses: Option<&[Response]>, relevant: &[bool]) -> Figures {
    let Some(responses) = responses else {
        return (None, None, None);
    };
    let top = TOPS.map(|n| relevant_in_top(responses, relevant, n));
    let separation = separation(responses, relevant);
    (
        average_precision(responses, relevant),
        Some(top),
        Some(separation),
    )
}

fn mean(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let known: Vec<f64> = values.flatten().collect();
    (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
}

fn confusion(trial: &Trial<'_>, taus: &[f64], learned: &OfTemplates) -> ConfusionJson {
    let n_classes = trial.classes.len();
    let mut counts = vec![vec![0; n_classes]; n_classes];
    let mut none = vec![0; n_classes];
    let tests = trial.clips.iter().zip(trial.roles);
    let tests = tests.filter(|(_, role)| **role == Role::Test);
    for (test, (clip, _)) in tests.enumerate() {
        let cost = |(learned, tau): (&Option<Learned>, &f64)| {
            // A class whose clips cost nothing may have a threshold of 0.
            let tau = tau.max(f64::MIN_POSITIVE);
            Some(learned.as_ref()?.responses[test].best()? / tau)
        };
        let costs: Vec<Option<f64>> = learned.iter().zip(taus).map(cost).collect();
        match classify(&costs) {
            Some(taken_for) => counts[clip.class][taken_for] += 1,
            None => none[clip.class] += 1,
        }
    }
    ConfusionJson { counts, none }
}
