//! How well class templates find the motions of their class: labelled folders, divided into clips to
//! learn from and clips to test on.
//!
//! For each class a template is learned from its training clips and matched against the test clips of
//! *all* classes, each clip apart or all as one stream ([`Documents`]). The measures ([`metrics`]) are those of
//! Müller and Röder 2006, sections 5.4 and 5.5, with spec.md d for what a hit is; the baselines ([`baseline`]) are
//! those of its Table 4.

pub mod baseline;
pub mod clips;
pub mod folders;
pub mod hits;
pub mod metrics;
pub mod split;

use mtemplate::{
    LearnConfig, MatchConfig, MotionTemplate, QuantizedTemplate, ShortClips, Steps, TauConfig,
    learn,
};
use rayon::prelude::*;

use crate::failure::Failure;
use clips::Clip;
use hits::Response;
use split::Role;

/// How templates are learned and matched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    /// How they are learned.
    pub learn: LearnConfig,
    /// Values this near to 0 or 1 count as that, all others are wildcards (δ).
    pub delta: f64,
    /// What steps weigh in matching.
    pub steps: Steps,
    /// What a template is matched against.
    pub documents: Documents,
}

/// What a template is matched against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Documents {
    /// Each test clip by itself (spec.md d). One with fewer frames than any match is a motion cut out and done
    /// fast; unless its ends are held ([`ShortClips::Held`]), it cannot be found.
    Apart(ShortClips),
    /// All test clips, one after another, as one stream (section 5.4). A match may begin in the clip before and
    /// end in the one after; its clip is [`Response::divided`]'s.
    Joined,
}

impl Documents {
    /// What becomes of a document that is too short for any match.
    fn short_clips(self) -> ShortClips {
        match self {
            Documents::Apart(short_clips) => short_clips,
            Documents::Joined => ShortClips::Unmatched,
        }
    }
}

impl Default for Method {
    /// δ = 0.1 and step weights by the template's advance, as published; clips apart, no cost for short ones (spec.md d).
    fn default() -> Method {
        Method {
            learn: LearnConfig::default(),
            delta: 0.1,
            steps: Steps::Advance,
            documents: Documents::Apart(ShortClips::Unmatched),
        }
    }
}

/// Clips with their roles, and the features that their words have.
#[derive(Clone, Copy, Debug)]
pub struct Trial<'a> {
    /// Names of the classes.
    pub classes: &'a [String],
    /// The clips of all classes, in order of class and path.
    pub clips: &'a [Clip],
    /// What each clip is for.
    pub roles: &'a [Role],
    /// Number of features of a word.
    pub n_features: usize,
}

impl<'a> Trial<'a> {
    /// The training clips of a class, in order.
    pub fn training(&self, class: usize) -> impl Iterator<Item = &'a Clip> {
        let all = self.clips.iter().zip(self.roles);
        all.filter(move |(clip, role)| clip.class == class && **role == Role::Train)
            .map(|(clip, _)| clip)
    }

    /// The test clips of all classes, in order.
    #[must_use]
    pub fn tests(&self) -> Vec<&'a Clip> {
        let all = self.clips.iter().zip(self.roles);
        all.filter(|(_, role)| **role == Role::Test)
            .map(|(clip, _)| clip)
            .collect()
    }

    /// For each test clip, whether it shows a class.
    #[must_use]
    pub fn relevance(&self, class: usize) -> Vec<bool> {
        let tests = self.tests();
        tests.iter().map(|clip| clip.class == class).collect()
    }
}

/// What the template of a class was learned from, and how the test clips answer it.
#[derive(Clone, Debug)]
pub struct Learned {
    /// The template and how it came about.
    pub learned: mtemplate::Learned,
    /// The response of each test clip.
    pub responses: Vec<Response>,
}

/// Learns the template of a class and matches it against all test clips; `None` for a class without
/// training clips.
///
/// # Errors
/// [`Failure`] if the words of a clip are not of the trial's features.
pub fn learn_and_match(
    trial: &Trial<'_>,
    class: usize,
    method: &Method,
) -> Result<Option<Learned>, Failure> {
    let motions: Vec<MotionTemplate> = trial
        .training(class)
        .map(|clip| {
            let template = MotionTemplate::from_words(&clip.words, trial.n_features);
            template.map_err(|e| Failure::input(&clip.file.path, e))
        })
        .collect::<Result<_, _>>()?;
    if motions.is_empty() {
        return Ok(None);
    }
    let of_class = |e| Failure::Usage(format!("{}: {e}", trial.classes[class]));
    let learned = learn(&motions, &method.learn).map_err(of_class)?;
    let quantized = learned.template.quantize(method.delta).map_err(of_class)?;
    let quantized = quantized
        .with_steps(method.steps)
        .with_short_clips(method.documents.short_clips());
    let responses = responses(&quantized, trial, method.documents);
    Ok(Some(Learned { learned, responses }))
}

/// [`learn_and_match`] for every class, in order.
///
/// # Errors
/// As [`learn_and_match`].
pub fn learn_and_match_all(
    trial: &Trial<'_>,
    method: &Method,
) -> Result<Vec<Option<Learned>>, Failure> {
    (0..trial.classes.len())
        .into_par_iter()
        .with_max_len(1)
        .map(|class| learn_and_match(trial, class, method))
        .collect()
}

/// How each test clip answers a template.
#[must_use]
pub fn responses(
    template: &QuantizedTemplate,
    trial: &Trial<'_>,
    documents: Documents,
) -> Vec<Response> {
    let tests = trial.tests();
    if documents == Documents::Joined {
        let words: Vec<u64> = tests.iter().flat_map(|clip| &clip.words).copied().collect();
        let curve: Vec<Option<f64>> = template.distance_curve(&words).costs().collect();
        let lengths = tests.iter().map(|clip| clip.words.len());
        return Response::divided(&curve, |last| template.start_of(&words, last), lengths);
    }
    tests
        .par_iter()
        .map(|clip| response(template, &clip.words))
        .collect()
}

fn response(template: &QuantizedTemplate, words: &[u64]) -> Response {
    let curve = template.distance_curve(words);
    let hits = template.matches_of(words, &curve, &MatchConfig::up_to(f64::INFINITY));
    Response {
        costs: curve.costs().flatten().collect(),
        hits,
    }
}

/// The threshold of a class, learned from its training clips and those of all other classes
/// ([`mtemplate::learn_tau`]); of a class without training clips, the paper's 0.06.
///
/// # Errors
/// As [`learn_and_match`].
pub fn learn_tau(trial: &Trial<'_>, class: usize, config: &TauConfig) -> Result<f64, Failure> {
    let classes = 0..trial.classes.len();
    let words = |class| trial.training(class).map(|clip| &clip.words[..]);
    let own: Vec<&[u64]> = words(class).collect();
    if own.is_empty() {
        return Ok(UNLEARNED_TAU);
    }
    let others: Vec<&[u64]> = classes.filter(|c| *c != class).flat_map(words).collect();
    let found = mtemplate::learn_tau(&own, &others, trial.n_features, config);
    let of_class = |e| Failure::Usage(format!("{}: {e}", trial.classes[class]));
    Ok(found.map_err(of_class)?.tau)
}

/// The paper's trade-off between precision and recall (section 5.4).
const UNLEARNED_TAU: f64 = 0.06;
