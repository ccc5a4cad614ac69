//! The stages of the algorithm, one by one.

use std::num::NonZeroUsize;
use std::ops::Range;

use anyhow::{Context, Result};
use bundles::{
    Accessibility, BundleGraph, Closure, EmOptions, ExtractOptions, Kappa, LabelRule,
    MappingOptions, MotionString, PAPER_SHARE, Pca, PoseClusters, SeedInstance,
    adjacent_distance_median, extract, fit_mixture, link, map_frames, max_letters, spell,
};
use ndarray::{Array2, ArrayView2};

use crate::takes::{GAMMA, MAX_FRAMES};

/// Pose vectors of clips one after the other.
#[derive(Clone, Copy)]
pub(crate) struct Clips<'a> {
    /// Of shape `(frames, dims)`.
    pub(crate) vectors: ArrayView2<'a, f64>,
    /// The frames of each clip.
    pub(crate) ranges: &'a [Range<usize>],
}

/// What spells poses.
pub(crate) struct Letters {
    pub(crate) pca: Pca,
    pub(crate) clusters: PoseClusters,
    /// Iterations of EM.
    pub(crate) n_iterations: usize,
}

impl Letters {
    pub(crate) fn fit(
        clips: Clips<'_>,
        kappa: usize,
        seed: u64,
        mark: &mut dyn FnMut(&str),
    ) -> Result<Letters> {
        let pca = Pca::fit(clips.vectors, PAPER_SHARE)?;
        let reduced = pca.project(clips.vectors)?;
        mark("PCA");
        let kappa = Kappa::Letters(NonZeroUsize::new(kappa).context("no letters")?);
        let em = EmOptions {
            seed,
            ..EmOptions::new(kappa)
        };
        let fit = fit_mixture(reduced.view(), &em)?;
        mark("EM");
        Ok(Letters {
            pca,
            clusters: fit.clusters,
            n_iterations: fit.log_likelihoods.len(),
        })
    }

    pub(crate) fn spell(&self, clips: Clips<'_>) -> Result<MotionString> {
        let reduced: Array2<f64> = self.pca.project(clips.vectors)?;
        let labels = self.clusters.label(reduced.view(), LabelRule::Likelihood)?;
        Ok(spell(&labels, clips.ranges)?)
    }

    /// τ of a string.
    pub(crate) fn threshold(&self, string: &MotionString) -> Result<f64> {
        Ok(adjacent_distance_median(string, &self.clusters)?.unwrap_or(0.0))
    }

    /// The letters of which distances are up to `tau`.
    pub(crate) fn access(&self, tau: f64) -> Result<Accessibility> {
        Ok(Accessibility::new(self.clusters.distances().view(), tau)?)
    }
}

/// How strings are cut.
pub(crate) fn options(string: &MotionString, closure: Closure, seed: u64) -> ExtractOptions {
    ExtractOptions {
        gamma: GAMMA,
        closure,
        seed: SeedInstance::Random(seed),
        ..ExtractOptions::new(max_letters(string, MAX_FRAMES))
    }
}

/// Bundles of a string, with the frames of `clips`.
pub(crate) fn graph(
    clips: Clips<'_>,
    (string, access): (&MotionString, &Accessibility),
    options: &ExtractOptions,
    mark: &mut dyn FnMut(&str),
) -> Result<BundleGraph> {
    let partition = extract(string, access, options)?;
    mark("extraction");
    let mapping = map_frames(
        string,
        &partition,
        clips.vectors,
        &MappingOptions::default(),
    )?;
    mark("frames");
    let graph = link(string, &partition, &mapping).context("no graph of these frames")?;
    mark("graph");
    Ok(graph)
}
