use clap::{Args, ValueEnum};
use mtemplate::{ClassTemplate, ShortClips};

use crate::failure::Failure;

/// The quality threshold of templates that have none of their own (2006 paper, section 5.4).
pub const DEFAULT_TAU: f64 = 0.06;

/// How well a match has to fit a template.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct MatchingArgs {
    /// The most that a match may cost: a number from 0 to 1, or auto for what was learned with the template
    /// [default: auto where there is such a thing, else 0.06]
    #[arg(long, value_name = "TAU", value_parser = parse_tau)]
    pub tau: Option<Tau>,
    /// How near to 0 or 1 a template's value has to be, or else it does not matter [default: 0.1]
    #[arg(long, value_name = "DELTA")]
    pub delta: Option<f64>,
}

/// The most that a match may cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tau {
    /// What was learned with the template.
    Learned,
    /// This much.
    Value(f64),
}

/// What becomes of clips that are too short for any match.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ShortClipsArg {
    /// Their first and last frames are held until a match is possible.
    Held,
    /// Nothing matches.
    Unmatched,
}

impl From<ShortClipsArg> for ShortClips {
    fn from(arg: ShortClipsArg) -> ShortClips {
        match arg {
            ShortClipsArg::Held => ShortClips::Held,
            ShortClipsArg::Unmatched => ShortClips::Unmatched,
        }
    }
}

pub(super) fn parse_tau(text: &str) -> Result<Tau, String> {
    if text == "auto" {
        return Ok(Tau::Learned);
    }
    let value = text.parse::<f64>().ok();
    let value = value.filter(|tau| (0.0..=1.0).contains(tau));
    let tau = value.ok_or_else(|| "expected auto or a number from 0 to 1".to_owned());
    tau.map(Tau::Value)
}

impl MatchingArgs {
    /// The most that a match with `template` may cost.
    ///
    /// # Errors
    /// [`Failure::Usage`] if it was to be learned with the template, but was not.
    pub fn tau_of(&self, template: &ClassTemplate) -> Result<f64, Failure> {
        match (self.tau, template.tau) {
            (Some(Tau::Value(tau)), _) | (None | Some(Tau::Learned), Some(tau)) => Ok(tau),
            (None, None) => Ok(DEFAULT_TAU),
            (Some(Tau::Learned), None) => Err(Failure::Usage(format!(
                "--tau auto: template {:?} has no threshold; `motif learn --tau auto` learns one",
                template.name
            ))),
        }
    }

    /// The threshold δ that templates are quantised with.
    #[must_use]
    pub fn delta(&self) -> f64 {
        /// Of the paper's experiments (section 5.2).
        const DELTA: f64 = 0.1;
        self.delta.unwrap_or(DELTA)
    }
}
