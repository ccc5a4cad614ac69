//! The stages of the algorithm, one by one.

use std::num::NonZeroUsize;
use std::ops::Range;

use anyhow::{Context, Result};
use bundles::{
    Accessibility, BundleGraph, Closure, EmOptions, ExtractOptions, Kappa, LabelRule,
    MappingOptions, MotionString, PAPER_SHARE, Pca, PoseClusters, SeedInstance,
    adjacent_distance_median, exemplars, extract, fit_mixture, link, map_frames, max_letters,
    spell,
};
use cli::bundling::{LetterRule, smoothed_clips};
use ndarray::{Array2, ArrayView2};

use crate::overlap::owners;
use crate::takes::{GAMMA, How, MAX_FRAMES};

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
    /// Iterations of EM, if there was any.
    pub(crate) n_iterations: usize,
}

impl Letters {
    pub(crate) fn fit(
        clips: Clips<'_>,
        (rule, kappa): (LetterRule, usize),
        seed: u64,
        mark: &mut dyn FnMut(&str),
    ) -> Result<Letters> {
        let pca = Pca::fit(clips.vectors, PAPER_SHARE)?;
        let reduced = pca.project(clips.vectors)?;
        mark("PCA");
        let kappa = NonZeroUsize::new(kappa).context("no letters")?;
        let (clusters, n_iterations) = match rule {
            LetterRule::Exemplars => (exemplars(reduced.view(), kappa)?, 0),
            LetterRule::Mixture => {
                let em = EmOptions {
                    seed,
                    ..EmOptions::new(Kappa::Letters(kappa))
                };
                let fit = fit_mixture(reduced.view(), &em)?;
                (fit.clusters, fit.log_likelihoods.len())
            }
        };
        mark("letters");
        Ok(Letters {
            pca,
            clusters,
            n_iterations,
        })
    }

    pub(crate) fn spell(&self, clips: Clips<'_>) -> Result<MotionString> {
        let reduced: Array2<f64> = self.pca.project(clips.vectors)?;
        let labels = self.clusters.label(reduced.view(), LabelRule::Likelihood)?;
        Ok(spell(&labels, clips.ranges)?)
    }

    /// The paper's τ of a string.
    fn threshold(&self, string: &MotionString) -> Result<f64> {
        Ok(adjacent_distance_median(string, &self.clusters)?.unwrap_or(0.0))
    }

    /// The letters of which distances are up to `tau`.
    fn access(&self, tau: f64) -> Result<Accessibility> {
        Ok(Accessibility::new(self.clusters.distances().view(), tau)?)
    }
}

/// Clips, and what of them is put into clusters.
pub(crate) struct Smooth<'a> {
    clips: Clips<'a>,
    smooth: Array2<f64>,
    how: How,
}

impl<'a> Smooth<'a> {
    pub(crate) fn new(clips: Clips<'a>, rate: f64, how: How) -> Smooth<'a> {
        Smooth {
            clips,
            smooth: smoothed_clips(clips.vectors, clips.ranges, how.smooth * rate),
            how,
        }
    }

    pub(crate) fn letters(
        &self,
        kappa: usize,
        seed: u64,
        mark: &mut dyn FnMut(&str),
    ) -> Result<Letters> {
        Letters::fit(self.poses(), (self.how.letters, kappa), seed, mark)
    }

    /// The clips in these letters, and which of these are near each other: with the string's own threshold
    /// unless `tau` is given.
    pub(crate) fn spelt(
        &self,
        letters: &Letters,
        tau: Option<f64>,
    ) -> Result<(MotionString, Accessibility)> {
        let string = letters.spell(self.poses())?;
        let tau = match tau {
            None => self.how.near * letters.threshold(&string)?,
            Some(tau) => tau,
        };
        let access = letters.access(tau)?;
        Ok((string, access))
    }

    /// τ of these letters.
    pub(crate) fn threshold(&self, letters: &Letters) -> Result<f64> {
        Ok(self.spelt(letters, None)?.1.tau())
    }

    /// Bundles of the letters of the clips; see [`Self::spelt`].
    pub(crate) fn bundles(
        &self,
        letters: &Letters,
        tau: Option<f64>,
        (closure, seed): (Closure, SeedInstance),
    ) -> Result<BundleGraph> {
        let (string, access) = self.spelt(letters, tau)?;
        let options = ExtractOptions {
            seed,
            ..options(&string, closure, 0)
        };
        graph(self.clips, (&string, &access), &options, &mut |_| ())
    }

    pub(crate) fn owners(&self, graph: &BundleGraph) -> Vec<Option<usize>> {
        owners(graph, self.clips.vectors.nrows())
    }

    fn poses(&self) -> Clips<'_> {
        Clips {
            vectors: self.smooth.view(),
            ranges: self.clips.ranges,
        }
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
