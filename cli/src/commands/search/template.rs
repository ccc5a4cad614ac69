//! `motif search --template`: where a class of motions occurs.

mod told;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use mtemplate::{
    AutomaticConfig, ClassTemplate, Keyframe, Match, MatchConfig, Preselection, QuantizedTemplate,
    ShortClips,
};
use rayon::prelude::*;

use self::told::write_hits;
pub use self::told::{
    KeyframeJson, Lost, Searched, TemplateHitJson, TemplateQueryJson, TemplateResult,
};
use super::plan::PlanStep;
use crate::args::{Global, MatchingArgs, SearchArgs};
use crate::failure::{Exit, Failure};
use crate::keyframes::{self, Rule, preselect};
use crate::library::{Clip, ClipId, Library};
use crate::output::{Outcome, Voice};
use crate::templates;

/// Where hits are looked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Places {
    /// Everywhere.
    #[default]
    Everywhere,
    /// Around the keyframes that the template has, or if it has none those of the automatic choice.
    Automatic,
    /// Around these keyframes.
    Around(Vec<Keyframe>),
}

/// How a template is looked for.
#[derive(Clone, Debug, Default)]
pub struct What {
    /// How well it has to fit.
    pub matching: MatchingArgs,
    /// Where.
    pub places: Places,
    /// When keyframes follow each other.
    pub rule: Rule,
    /// What becomes of clips that are too short for any match.
    pub short_clips: ShortClips,
    /// Whether everything is searched as well, to tell what is lost.
    pub lost: bool,
    /// Whether the result says how the places were found.
    pub explain_plan: bool,
    /// Most hits to list; 0 for all.
    pub top: usize,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`].
pub(super) fn run(path: &Path, args: &SearchArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let library = Library::open(&args.library)?;
    let template = templates::load(path)?;
    let places = match args.template.keyframes.as_deref() {
        None => Places::Everywhere,
        Some(keyframes) if keyframes.as_os_str() == "off" => Places::Everywhere,
        Some(keyframes) if keyframes.as_os_str() == "auto" => Places::Automatic,
        Some(file) => Places::Around(keyframes::read(file, &library.features.set)?),
    };
    let what = What {
        matching: args.template.matching,
        places,
        rule: Rule::default(),
        short_clips: args.template.short_clips.into(),
        lost: args.template.lost,
        explain_plan: args.plan.explain_plan,
        top: args.top,
    };
    let result = search(&library, &template, &what, voice)?;
    let outcome = Outcome {
        found: result.n_hits > 0,
        skipped: Vec::new(),
        result,
    };
    let result = &outcome.result;
    voice.report("search", &outcome, |out| write_hits(out, result))
}

/// Finds the hits of a template: per clip, or per stretch around keyframes, those of
/// [`QuantizedTemplate::find_matches`]. Ranked by cost, then clip, then start, whatever the number of threads.
///
/// A hit of the whole clip that lies in a stretch is found there at the same cost; hits of a stretch do not compete with
/// those outside. A hit is lost if less than half of it lies in any one hit around keyframes.
///
/// # Errors
/// [`Failure`]: a template for other features, no learned τ where it is asked for, keyframes outside the template.
pub fn search(
    library: &Library,
    template: &ClassTemplate,
    what: &What,
    voice: Voice,
) -> Result<TemplateResult, Failure> {
    let set = &library.features.set;
    let template = templates::for_set(template, set)?;
    if template.rate != library.rate {
        return Err(Failure::Usage(format!(
            "template {:?} is for {} words per second, the library has {}",
            template.name, template.rate, library.rate
        )));
    }
    let tau = what.matching.tau_of(&template)?;
    let quantized = template.template.quantize(what.matching.delta());
    let quantized = quantized.map_err(|e| refuse(&template, e))?;
    let preselection = preselection(library, &template, &what.places, voice)?;

    let columns = 0..quantized.n_columns();
    let of_columns = columns.filter_map(|column| Some(quantized.words(column)?.0));
    let of_keyframes = preselection
        .iter()
        .flat_map(|p| p.keyframes())
        .map(|k| k.care);
    let care = of_columns
        .chain(of_keyframes)
        .fold(0, |all, care| all | care);
    let lacking = library.lacking(care)?;
    let mut clips = library.clips()?;
    clips.retain(|clip| !lacking.contains(&clip.id));

    let mut plan = Vec::new();
    let everything = || -> Work<'_> {
        let whole = |clip: &Clip| std::iter::once(0..clip.n_words).collect();
        clips.iter().map(|clip| (clip, whole(clip))).collect()
    };
    let work = match &preselection {
        None => everything(),
        Some(preselection) => {
            let mut found = preselect(library, &clips, preselection, what.rule)?;
            let steps = found.answers.iter();
            plan.extend(steps.map(|(index, answer)| PlanStep::keyframes(index, answer)));
            let stretches = clips.iter();
            stretches
                .filter_map(|clip| Some((clip, found.stretches.remove(&clip.id)?)))
                .collect()
        }
    };
    let by = (&quantized, what.short_clips);
    let hits = matches(library, by, &work, tau)?;
    let everywhere = match (&preselection, what.lost) {
        (Some(_), true) => Some(matches(library, by, &everything(), tau)?),
        (None, true) => Some(hits.clone()),
        (_, false) => None,
    };
    let searched = searched(&clips, &work);
    let mut with_hits: Vec<_> = hits.iter().map(|(clip, _)| clip.id).collect();
    with_hits.sort_unstable();
    with_hits.dedup();
    let n_listed = if what.top == 0 { usize::MAX } else { what.top };
    let listed = hits.iter().take(n_listed).enumerate();
    Ok(TemplateResult {
        query: TemplateQueryJson {
            columns: quantized.n_columns(),
            tau,
            keyframes: preselection
                .iter()
                .flat_map(|p| p.keyframes())
                .map(|k| KeyframeJson::new(library, k))
                .collect(),
            template: template.name,
        },
        n_hits: hits.len(),
        n_clips: with_hits.len(),
        n_unsearched: lacking.len(),
        searched,
        lost: everywhere.map(|all| lost(library, &all, &hits, n_listed)),
        plan: what.explain_plan.then_some(plan),
        hits: listed
            .map(|(i, (clip, found))| TemplateHitJson::new(library, clip, found, i + 1))
            .collect(),
    })
}

fn refuse(template: &ClassTemplate, error: impl std::fmt::Display) -> Failure {
    Failure::Usage(format!("template {:?}: {error}", template.name))
}

/// The keyframes to look around; `None` to look everywhere.
fn preselection(
    library: &Library,
    template: &ClassTemplate,
    places: &Places,
    voice: Voice,
) -> Result<Option<Preselection>, Failure> {
    let keyframes = match places {
        Places::Everywhere => return Ok(None),
        Places::Around(keyframes) => keyframes.clone(),
        Places::Automatic if !template.keyframes.is_empty() => template.keyframes.clone(),
        Places::Automatic => {
            let config = AutomaticConfig::interactive();
            let chosen = keyframes::choose(template, &library.features.set, &config)?;
            if chosen.is_empty() {
                voice.note(
                    "no column of the template stands out as a keyframe: everything is searched",
                );
                return Ok(None);
            }
            chosen
        }
    };
    let n_columns = template.template.n_columns();
    let preselection = Preselection::new(&keyframes, n_columns);
    preselection.map(Some).map_err(|e| refuse(template, e))
}

type Work<'a> = Vec<(&'a Clip, Vec<Range<usize>>)>;

type Found<'a> = Vec<(&'a Clip, Match)>;

/// The matches of all stretches, best first. A short clip that is to be held is matched as a whole, if it has any
/// stretch; stretches of other clips are not held.
fn matches<'a>(
    library: &Library,
    (template, short_clips): (&QuantizedTemplate, ShortClips),
    work: &Work<'a>,
    tau: f64,
) -> Result<Found<'a>, Failure> {
    let config = MatchConfig::up_to(tau);
    let holding = template.clone().with_short_clips(short_clips);
    let of_clip = |(clip, stretches): &(&'a Clip, Vec<Range<usize>>)| {
        let words = library.words(clip.id)?;
        let mut found = Vec::new();
        if words.len() <= template.n_columns() / 2 {
            let whole = holding.find_matches(&words, &config);
            return Ok(whole.into_iter().map(|one| (*clip, one)).collect());
        }
        for stretch in stretches {
            for one in template.find_matches(&words[stretch.clone()], &config) {
                let span = one.span.start + stretch.start..one.span.end + stretch.start;
                found.push((*clip, Match { span, ..one }));
            }
        }
        Ok(found)
    };
    let of_clips: Vec<Result<Found<'_>, Failure>> = work.par_iter().map(of_clip).collect();
    let mut hits = Vec::new();
    for of_clip in of_clips {
        hits.extend(of_clip?);
    }
    hits.sort_by(|(a, one), (b, other)| {
        let by_cost = one.cost.total_cmp(&other.cost);
        by_cost.then_with(|| (a.id, one.span.start).cmp(&(b.id, other.span.start)))
    });
    Ok(hits)
}

/// Of the hits `everywhere`, those that are not `found`; at most `n_listed` are listed.
fn lost(library: &Library, everywhere: &Found<'_>, found: &Found<'_>, n_listed: usize) -> Lost {
    let mut by_clip: BTreeMap<ClipId, Vec<&Range<usize>>> = BTreeMap::new();
    for (clip, one) in found {
        by_clip.entry(clip.id).or_default().push(&one.span);
    }
    let is_found = |clip: &Clip, span: &Range<usize>| {
        let mut found = by_clip.get(&clip.id).into_iter().flatten();
        found.any(|other| {
            let common = span.start.max(other.start)..span.end.min(other.end);
            2 * common.len() >= span.len()
        })
    };
    let ranked = everywhere.iter().enumerate();
    let lost: Vec<_> = ranked
        .filter(|(_, (clip, one))| !is_found(clip, &one.span))
        .collect();
    let listed = lost.iter().take(n_listed);
    Lost {
        n_hits: lost.len(),
        of: everywhere.len(),
        hits: listed
            .map(|(i, (clip, one))| TemplateHitJson::new(library, clip, one, i + 1))
            .collect(),
    }
}

fn searched(clips: &[Clip], work: &Work<'_>) -> Searched {
    let of: usize = clips.iter().map(|clip| clip.n_words).sum();
    let stretches = work.iter().flat_map(|(_, stretches)| stretches);
    let words = stretches.map(Range::len).sum();
    let share = match of {
        0 => 1.0,
        of => words as f64 / of as f64,
    };
    Searched { words, of, share }
}
