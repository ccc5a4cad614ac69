//! Two walks of the tour, aligned.

use std::io::{self, Write};
use std::path::Path;

use relfeat::FeatureSet;
use serde::Serialize;

use crate::commands::align::{AlignResult, How, align_takes};
use crate::commands::index::DEFAULT_SET;
use crate::corpus::Class;
use crate::corpus_files::ClipFile;
use crate::failure::Failure;
use crate::recording::ReadOptions;
use crate::source::ClipRef;
use crate::take::Take;

/// What aligning the first and the last performer's walks gave.
#[derive(Debug, Serialize)]
pub struct DemoAlignment {
    /// The first walk.
    pub a: String,
    /// The second one.
    pub b: String,
    /// The mean distance of the aligned poses' points, in metres.
    pub mean_distance: f64,
    /// The share of the full matrix that was computed.
    pub share: f64,
    /// By how much the cost is above that of the full matrix, as a share of it.
    pub excess: Option<f64>,
    /// What it comes from.
    #[serde(skip)]
    pub result: AlignResult,
}

impl DemoAlignment {
    pub(super) fn new(files: &[ClipFile]) -> Result<DemoAlignment, Failure> {
        let mut walks = files.iter().filter(|f| f.class == Some(Class::Walk));
        let (first, last) = (walks.next(), walks.next_back());
        let missing = || Failure::input(Path::new("labels.csv"), "a class without two clips");
        let take = |file: Option<&ClipFile>| {
            let clip = ClipRef {
                path: file.ok_or_else(missing)?.path.clone(),
                span: None,
            };
            Take::load(&clip, &ReadOptions::default())
        };
        let (a, b) = (take(first)?, take(last)?);
        let set = FeatureSet::builtin(DEFAULT_SET).ok_or_else(missing)?;
        let result = align_takes(&a, &b, &How::new(set))?;
        let refused = || Failure::input(&b.clip.path, result.reason.clone().unwrap_or_default());
        let found = result.alignment.as_ref().ok_or_else(refused)?;
        Ok(DemoAlignment {
            a: result.a.clip.clone(),
            b: result.b.clip.clone(),
            mean_distance: found.mean_distance,
            share: found.cells.share,
            excess: found.excess,
            result,
        })
    }

    pub(super) fn tell(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "\nTwo walks aligned, {}\n  with {}:\n  joints {:.3} m apart on average, {:.1} % of the full matrix computed",
            self.a,
            self.b,
            self.mean_distance,
            100.0 * self.share
        )
    }
}
