//! A quality threshold τ for a class, from the motions it is learned from.

use crate::{
    LearnConfig, Learned, MotionTemplate, QuantizedTemplate, TemplateError, learn, parallel,
};

/// The papers' threshold, for want of a better one (spec.md d).
const TAU: f64 = 0.06;

/// How a threshold is learned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TauConfig {
    /// How templates are learned.
    pub learn: LearnConfig,
    /// The threshold δ that templates are quantised with, in \[0, 0.5).
    pub quantization: f64,
}

impl Default for TauConfig {
    /// Learning as by default, and the papers' quantisation threshold of 0.1.
    fn default() -> Self {
        Self {
            learn: LearnConfig::default(),
            quantization: 0.1,
        }
    }
}

/// A threshold, and the costs that it was chosen by.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnedTau {
    /// Quality threshold τ: a match of at most this cost is taken for the class.
    pub tau: f64,
    /// What all motions together gave.
    pub learned: Learned,
    /// For each motion the least cost, in it, of the template learned from the others; `None` where
    /// that cannot match, and where there are no others.
    pub left_out: Vec<Option<f64>>,
    /// For each negative the least cost of the template learned from all motions; `None` where that
    /// cannot match.
    pub negatives: Vec<Option<f64>>,
}

/// Learns a class from `motions`, and its quality threshold from what each of them costs when it is
/// left out and from what clips of other classes cost. All are words of whole clips.
///
/// The threshold is where the F-measure over these clips is largest, which is twice the number of
/// motions that cost at most τ, over the number of all clips that do and of all motions. It lies
/// midway between the costliest clip let in and the cheapest kept out; of equally good cuts the one
/// with the widest gap between these two is taken, then the lowest. A cut that keeps out no clip
/// lies at the costliest let in. Where no negative or no left-out motion can be matched, nothing can
/// be learned, and τ is the papers' 0.06.
///
/// Learns a template for each motion, and so takes N + 1 times as long as [`learn()`]. Uses all
/// threads; the result does not depend on their number.
///
/// # Errors
///
/// Those of [`learn()`] and [`MotionTemplate::from_words`] on the motions, and when the quantisation
/// threshold lies outside \[0, 0.5).
///
/// ```
/// use mtemplate::{TauConfig, learn_tau};
///
/// let raised: [&[u64]; 3] = [&[1, 1, 1]; 3];
/// let lowered: [&[u64]; 1] = [&[0, 0, 0]];
/// let found = learn_tau(&raised, &lowered, 1, &TauConfig::default())?;
/// assert_eq!(found.left_out, [Some(0.0); 3]);
/// assert_eq!(found.negatives, [Some(1.0)]);
/// assert_eq!(found.tau, 0.5);
/// # Ok::<(), mtemplate::TemplateError>(())
/// ```
pub fn learn_tau(
    motions: &[&[u64]],
    negatives: &[&[u64]],
    n_features: usize,
    config: &TauConfig,
) -> Result<LearnedTau, TemplateError> {
    let templates = motions
        .iter()
        .map(|words| MotionTemplate::from_words(words, n_features));
    let templates: Vec<MotionTemplate> = templates.collect::<Result<_, _>>()?;
    let learned = learn(&templates, &config.learn)?;
    let quantized = learned.template.quantize(config.quantization)?;
    let left_out = |index: usize| {
        let mut others = templates.clone();
        others.remove(index);
        if others.is_empty() {
            return Ok(None);
        }
        let template = learn(&others, &config.learn)?.template;
        let template = template.quantize(config.quantization)?;
        Ok(least_cost(&template, motions[index]))
    };
    let indices: Vec<usize> = (0..motions.len()).collect();
    let left_out = parallel::map(&indices, || (), |(), &index| left_out(index));
    let left_out = left_out
        .into_iter()
        .collect::<Result<Vec<_>, TemplateError>>()?;
    let negatives = parallel::map(negatives, || (), |(), words| least_cost(&quantized, words));
    Ok(LearnedTau {
        tau: best_cut(&left_out, &negatives).unwrap_or(TAU),
        learned,
        left_out,
        negatives,
    })
}

fn least_cost(template: &QuantizedTemplate, words: &[u64]) -> Option<f64> {
    let curve = template.distance_curve(words);
    curve.costs().flatten().min_by(f64::total_cmp)
}

/// The cut of the largest F-measure; `None` where one of the two has no costs.
fn best_cut(positives: &[Option<f64>], negatives: &[Option<f64>]) -> Option<f64> {
    let n_positives = positives.len();
    let count = |clips: &[Option<f64>], tau: f64| {
        let costs = clips.iter().flatten();
        costs.filter(|&&cost| cost <= tau).count()
    };
    negatives.iter().flatten().next()?;
    positives.iter().flatten().next()?;
    let mut costs: Vec<f64> = positives
        .iter()
        .chain(negatives)
        .flatten()
        .copied()
        .collect();
    costs.sort_by(f64::total_cmp);
    costs.dedup();
    let cut = |(index, &let_in): (usize, &f64)| {
        let kept_out = costs.get(index + 1).copied();
        let (hits, false_hits) = (count(positives, let_in), count(negatives, let_in));
        // A clip that is kept out bounds the gap; without one there is none to choose by.
        let gap = kept_out.map_or(0.0, |kept_out| kept_out - let_in);
        let score = 2.0 * hits as f64 / (hits + false_hits + n_positives) as f64;
        (score, gap, let_in + gap / 2.0)
    };
    let better = |best: (f64, f64, f64), next: (f64, f64, f64)| {
        // Equal fractions of whole numbers are equal quotients.
        if (next.0, next.1) > (best.0, best.1) {
            next
        } else {
            best
        }
    };
    let cuts = costs.iter().enumerate().map(cut);
    cuts.reduce(better).map(|(_, _, tau)| tau)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(positives: &[f64], negatives: &[f64], expected: Option<f64>) {
        let some = |costs: &[f64]| costs.iter().copied().map(Some).collect::<Vec<_>>();
        assert_eq!(best_cut(&some(positives), &some(negatives)), expected);
    }

    #[test]
    fn separable_clips_are_cut_midway() {
        check(&[0.0, 0.25, 0.125], &[0.75, 0.5], Some(0.375));
    }

    #[test]
    fn a_motion_worse_than_many_negatives_is_given_up() {
        // At 0.25: 2 of 3 motions, no negative, F = 4/5. At 1: 3 and 4 negatives, F = 6/10.
        check(&[0.0, 0.25, 1.0], &[0.5; 4], Some(0.375));
        check(&[0.0, 0.25, 1.0], &[0.5, 0.75, 0.75, 0.75], Some(0.375));
    }

    #[test]
    fn a_negative_is_let_in_for_many_motions() {
        // At 0.125: F = 2/5. At 1: 4 motions and a negative, F = 8/9, and nothing is kept out.
        check(&[0.125, 0.5, 0.5, 1.0], &[0.25], Some(1.0));
        check(&[0.125, 0.5, 0.5, 1.0], &[0.25, 2.0], Some(1.5));
    }

    #[test]
    fn equally_good_cuts_are_decided_by_the_gap_then_the_lowest() {
        // At 0.25 and at 2: F = 2/4 = 4/8. The gaps are 0.25 and 1, then both 1.
        check(
            &[0.25, 2.0, 9.0],
            &[0.5, 1.0, 1.0, 3.0, 3.0, 3.0, 3.0],
            Some(2.5),
        );
        check(
            &[1.0, 3.0, 9.0],
            &[2.0, 2.5, 2.75, 4.0, 4.0, 4.0, 4.0],
            Some(1.5),
        );
    }

    #[test]
    fn nothing_is_learned_from_one_side() {
        check(&[0.25], &[], None);
        check(&[], &[0.25], None);
        assert_eq!(best_cut(&[None], &[Some(0.5)]), None);
        assert_eq!(best_cut(&[Some(0.5)], &[None]), None);
    }
}
