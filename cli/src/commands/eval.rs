//! `motif eval`.

mod json;
mod text;

use mtemplate::TauConfig;

use super::index::{DEFAULT_RATE, DEFAULT_SET};
use crate::args::{EvalArgs, Global, SplitArg, StepsArg, Tau};
use crate::eval::baseline::{Baseline, match_example};
use crate::eval::clips::{PosesKept, Reading, read};
use crate::eval::folders::Folders;
use crate::eval::hits::Response;
use crate::eval::split::{Role, Split};
use crate::eval::{Documents, Learned, Method, Trial, learn_and_match_all, learn_tau};
use crate::failure::{Exit, Failure, Skipped};
use crate::library::NamedSet;
use crate::output::{Outcome, Voice};

pub use json::{BaselineJson, ClassJson, ConfusionJson, EvalJson};

/// Runs the command.
///
/// # Errors
/// [`Failure`] if there are no labelled clips, if they cannot be divided as asked, or if nothing can be
/// written.
pub fn run(args: &EvalArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let (result, skipped) = evaluate(args, global, voice)?;
    let outcome = Outcome {
        found: result.map.is_some(),
        result,
        skipped,
    };
    voice.report("eval", &outcome, |out| text::write(out, &outcome.result))
}

/// What the command finds.
///
/// # Errors
/// As [`run`].
pub fn evaluate(
    args: &EvalArgs,
    global: &Global,
    voice: Voice,
) -> Result<(EvalJson, Vec<Skipped>), Failure> {
    let named = NamedSet::find(args.set.set.as_deref().unwrap_or(DEFAULT_SET))?;
    let rate = args.set.rate.unwrap_or(DEFAULT_RATE);
    if !(rate > 0.0 && rate.is_finite()) {
        let message = format!("expected a positive --rate, found {rate}");
        return Err(Failure::Usage(message));
    }
    let folders = Folders::find(&args.dir)?;
    let roles = split(args)?.roles(&folders)?;
    let reading = Reading {
        options: &global.read_options()?,
        set: &named.set,
        rate,
        poses: match args.baselines {
            true => PosesKept::Yes,
            false => PosesKept::No,
        },
    };
    let (clips, skipped) = read(&folders, &reading, voice);
    // Clips that could not be read have no role.
    let role = |clip: &crate::eval::clips::Clip| {
        let at = folders.files.iter().position(|f| f.file == clip.file);
        at.map_or(Role::Train, |at| roles[at])
    };
    let roles: Vec<Role> = clips.iter().map(role).collect();
    let trial = Trial {
        classes: &folders.classes,
        clips: &clips,
        roles: &roles,
        n_features: named.set.features().len(),
    };
    let taus = taus(args, &trial)?;
    let learned = learn_and_match_all(&trial, &method(args))?;
    let of_baselines = match args.baselines {
        true => baselines(&trial, args.short_clips.into())?,
        false => Vec::new(),
    };
    Ok((
        json::result(&trial, &taus, &learned, &of_baselines),
        skipped,
    ))
}

fn split(args: &EvalArgs) -> Result<Split, Failure> {
    let refuse =
        |option: &str, split: &str| Err(Failure::Usage(format!("{option} is for --split {split}")));
    match args.split {
        SplitArg::Actor => {}
        _ if !args.test.is_empty() => return refuse("--test", "actor"),
        _ if args.actor_part.is_some() => return refuse("--actor-part", "actor"),
        _ => {}
    }
    match args.split {
        SplitArg::File => {}
        _ if args.seed.is_some() => return refuse("--seed", "file"),
        _ => {}
    }
    Ok(match args.split {
        SplitArg::Paper => Split::Paper,
        SplitArg::Actor => Split::Actor {
            test: args.test.clone(),
            part: args.actor_part,
        },
        SplitArg::File => Split::File {
            every: args.every,
            seed: args.seed,
        },
    })
}

fn method(args: &EvalArgs) -> Method {
    let mut method = Method {
        delta: args.delta,
        steps: args.steps.into(),
        documents: args.short_clips.into(),
        ..Method::default()
    };
    method.learn.unwarp = args.unwarp.into();
    method
}

/// The threshold of each class.
fn taus(args: &EvalArgs, trial: &Trial<'_>) -> Result<Vec<f64>, Failure> {
    let classes = 0..trial.classes.len();
    let method = method(args);
    match args.tau {
        Tau::Value(tau) => Ok(vec![tau; classes.len()]),
        Tau::Learned if args.steps == StepsArg::Unit => Err(Failure::Usage(
            "--tau auto is learned with --steps advance".to_owned(),
        )),
        Tau::Learned => {
            let config = TauConfig {
                learn: method.learn,
                quantization: method.delta,
            };
            classes
                .map(|class| learn_tau(trial, class, &config))
                .collect()
        }
    }
}

/// By class, the responses to each baseline.
type OfBaselines = Vec<Vec<(Baseline, Option<Vec<Response>>)>>;

fn baselines(trial: &Trial<'_>, documents: Documents) -> Result<OfBaselines, Failure> {
    let of_class = |class| {
        let each = Baseline::ALL.into_iter();
        each.map(|baseline| Ok((baseline, match_example(trial, class, baseline, documents)?)))
            .collect()
    };
    (0..trial.classes.len()).map(of_class).collect()
}

/// By class, as [`learn_and_match_all`] gives them.
type OfTemplates = [Option<Learned>];
