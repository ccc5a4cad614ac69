//! From motions of a class to the class's template (section 4.1, spec.md c).

mod align;
mod balance;
mod columns;
mod unwarp;
mod warp;

pub use align::{Alignment, align};

use crate::{MotionTemplate, TemplateError, parallel};
use align::{Step, Table};
use columns::Columns;
use warp::Average;

/// The most columns, and the most weight, of a template that is aligned with others.
pub const MAX_ALIGNED_COLUMNS: usize = 8192;

/// Weights this close to a bound have reached it: they are sums of fractions, and rounded.
const ROUNDING: f64 = 1e-9;

/// How the columns of an average are brought back to real time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Unwarp {
    /// The template is a step function of cumulative weight, averaged over cells of weight 1: all
    /// weights but the last are 1, and the last is at most 1.
    #[default]
    Exact,
    /// As the authors ran it: columns are repeated, merged up to a weight of 0.75 and repeated
    /// again; weights lie between 0.75 and about 1.5.
    Balance,
}

/// When to stop learning, and how to unwarp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearnConfig {
    /// How averages are unwarped.
    pub unwarp: Unwarp,
    /// Learning stops when the templates of all references are this close to each other: the
    /// largest alignment cost over the reference's total weight.
    pub tolerance: f64,
    /// The most iterations; there is always one.
    pub max_iterations: usize,
}

impl Default for LearnConfig {
    fn default() -> Self {
        Self {
            unwarp: Unwarp::Exact,
            tolerance: 0.005,
            max_iterations: 10,
        }
    }
}

/// What was learned.
#[derive(Debug, Clone, PartialEq)]
pub struct Learned {
    /// The class template, that of the first motion as reference.
    pub template: MotionTemplate,
    /// Number of iterations M.
    pub iterations: usize,
    /// How far the templates of two references still were apart before the last iteration: the
    /// largest cost of an alignment over the reference's total weight after it.
    pub distance: f64,
}

/// Learns the template that `motions` have in common.
///
/// In one iteration every template is the reference once: the others are [aligned](align()) with
/// it, warped onto its columns and averaged with it by weight, and the average is unwarped to real
/// time. The results take the templates' places all at once. Learning stops when the largest
/// [`distance`](Learned::distance) is within the tolerance, when it is what it was an iteration
/// before, or after the last iteration allowed.
///
/// The total weight is the mean of the motions', and stays it. The result belongs to the first
/// motion. The order of the others does not matter but for rounding: an average adds them up in
/// this order.
///
/// Takes O(N²·K²·f) time and O(N·K·f + N²·K + K²) memory for each iteration on N motions of K
/// columns, half of that time where all values are 0 or 1. Uses all threads; the result does not
/// depend on their number.
///
/// # Errors
///
/// When there are no motions, one has no columns, more than [`MAX_ALIGNED_COLUMNS`] or more total weight,
/// or they disagree on the number of features; and when weights are so small that a mean by weight
/// is undefined.
///
/// ```
/// use mtemplate::{LearnConfig, MotionTemplate, learn};
///
/// let motions = [
///     MotionTemplate::from_words(&[0b00, 0b01, 0b01, 0b10], 2)?,
///     MotionTemplate::from_words(&[0b00, 0b01, 0b10, 0b10], 2)?,
/// ];
/// let learned = learn(&motions, &LearnConfig::default())?;
/// assert_eq!(learned.template.n_columns(), 4);
/// assert_eq!(learned.template.values().column(0).to_vec(), [0.0, 1.0, 0.5, 0.0]);
/// # Ok::<(), mtemplate::TemplateError>(())
/// ```
pub fn learn(motions: &[MotionTemplate], config: &LearnConfig) -> Result<Learned, TemplateError> {
    check(motions)?;
    let mut templates = motions.to_vec();
    let mut before = None;
    for iteration in 1.. {
        let (next, distance) = iterate(&templates, config.unwarp)?;
        templates = next;
        let is_settled = distance <= config.tolerance || before == Some(distance);
        if is_settled || iteration >= config.max_iterations {
            return Ok(Learned {
                template: templates.swap_remove(0),
                iterations: iteration,
                distance,
            });
        }
        before = Some(distance);
    }
    unreachable!("the loop ends at the last iteration")
}

fn check(motions: &[MotionTemplate]) -> Result<(), TemplateError> {
    let first = motions.first().ok_or(TemplateError::NoMotions)?;
    let expected = first.n_features();
    for (motion, template) in motions.iter().enumerate() {
        if template.n_columns() == 0 {
            return Err(TemplateError::EmptyMotion { motion });
        }
        let found = template.n_features();
        if found != expected {
            return Err(TemplateError::FeatureCounts {
                motion,
                expected,
                found,
            });
        }
        let found = template.weights().sum().max(template.n_columns() as f64);
        if found > MAX_ALIGNED_COLUMNS as f64 {
            return Err(TemplateError::TooLong { motion, found });
        }
    }
    Ok(())
}

/// Two templates aligned, once with each of them as the reference.
struct Pair {
    cost: f64,
    /// The path with the first as the reference, and that with the second.
    steps: [Vec<Step>; 2],
}

/// Every template averaged with all others, and the largest cost over total weight.
fn iterate(
    templates: &[MotionTemplate],
    unwarp: Unwarp,
) -> Result<(Vec<MotionTemplate>, f64), TemplateError> {
    let n = templates.len();
    let columns = Columns::of_all(templates);
    let pairs: Vec<(usize, usize)> = (0..n)
        .flat_map(|a| (a + 1..n).map(move |b| (a, b)))
        .collect();
    let pairs = parallel::map(&pairs, Table::default, |table, &(first, second)| {
        table.fill(&columns[first], &columns[second]);
        Pair {
            cost: table.cost(),
            steps: [Step::Second, Step::First].map(|other| table.trace(other)),
        }
    });
    let references: Vec<usize> = (0..n).collect();
    let averaged = parallel::map(
        &references,
        || (),
        |(), &reference| {
            let (average, cost) = average(templates, &pairs, reference);
            let unwarped = match unwarp {
                Unwarp::Exact => unwarp::unwarp(&average),
                Unwarp::Balance => balance::balance(&average),
            };
            let total: f64 = unwarped.weights.iter().sum();
            Ok((unwarped.into_template()?, cost / total))
        },
    );
    let averaged: Vec<_> = averaged.into_iter().collect::<Result<_, TemplateError>>()?;
    let distance = averaged
        .iter()
        .map(|(_, distance)| *distance)
        .fold(0.0, f64::max);
    let templates = averaged.into_iter().map(|(template, _)| template);
    Ok((templates.collect(), distance))
}

/// The average of all templates aligned with `reference`, and the largest cost of an alignment.
/// `pairs` come in ascending order.
fn average(
    templates: &[MotionTemplate],
    pairs: &[Pair],
    reference: usize,
) -> (warp::Weighted, f64) {
    let mut average = Average::onto(&templates[reference]);
    let mut worst: f64 = 0.0;
    for (other, template) in templates.iter().enumerate() {
        if other == reference {
            average.add_reference(template);
            continue;
        }
        let (first, second) = (reference.min(other), reference.max(other));
        let before = first * (2 * templates.len() - first - 1) / 2;
        let pair = &pairs[before + second - first - 1];
        worst = worst.max(pair.cost);
        if reference == first {
            average.add(template, align::pairs(&pair.steps[0]));
        } else {
            average.add(
                template,
                align::pairs(&pair.steps[1]).map(|(other, to)| (to, other)),
            );
        }
    }
    (average.finish(), worst)
}
