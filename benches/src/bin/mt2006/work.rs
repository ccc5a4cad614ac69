//! Clips, the paper's split, and templates learned as the authors learned them.

use std::path::Path;

use anyhow::{Result, ensure};
use cli::eval::clips::{Clip, PosesKept, Reading, read};
use cli::eval::folders::Folders;
use cli::eval::split::{Role, Split};
use cli::eval::{Learned, Method, Trial, learn_and_match_all};
use cli::output::Voice;
use cli::recording::ReadOptions;
use mtemplate::Unwarp;
use relfeat::FeatureSet;

/// Words per second.
const RATE: f64 = 30.0;

pub(crate) struct Work {
    pub(crate) classes: Vec<String>,
    pub(crate) clips: Vec<Clip>,
    pub(crate) roles: Vec<Role>,
    pub(crate) n_features: usize,
    /// By class.
    pub(crate) learned: Vec<Option<Learned>>,
}

/// As the published experiments were run.
pub(crate) fn method() -> Method {
    let mut method = Method::default();
    method.learn.unwarp = Unwarp::Balance;
    method
}

impl Work {
    pub(crate) fn new(data: &Path) -> Result<Work> {
        let folders = Folders::find(&data.join("hdm05"))?;
        let roles = Split::Paper.roles(&folders)?;
        let set = FeatureSet::builtin("mueller2006");
        let set = set.ok_or_else(|| anyhow::anyhow!("no feature set mueller2006"))?;
        let reading = Reading {
            options: &ReadOptions::default(),
            set: &set,
            rate: RATE,
            poses: PosesKept::Yes,
        };
        let (clips, skipped) = read(&folders, &reading, Voice::default());
        ensure!(skipped.is_empty(), "cannot read {skipped:?}");
        let mut work = Work {
            classes: folders.classes,
            clips,
            roles,
            n_features: set.features().len(),
            learned: Vec::new(),
        };
        work.learned = learn_and_match_all(&work.trial(), &method())?;
        Ok(work)
    }

    pub(crate) fn trial(&self) -> Trial<'_> {
        self.trial_with(&self.roles)
    }

    pub(crate) fn trial_with<'a>(&'a self, roles: &'a [Role]) -> Trial<'a> {
        Trial {
            classes: &self.classes,
            clips: &self.clips,
            roles,
            n_features: self.n_features,
        }
    }
}
