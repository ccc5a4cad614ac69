//! One class: its template, its threshold, its keyframes.

use std::path::Path;

use mtemplate::{
    ClassTemplate, ExampleConfig, Examples, Keyframe, Learned, MotionTemplate, TauConfig, learn,
    learn_keyframes, learn_tau,
};
use relfeat::FeatureSet;

use super::What;
use crate::failure::Failure;
use crate::selection;
use crate::wire::ClipWords;

/// Features that every motion has.
pub(super) fn available(motions: &[&ClipWords], set: &FeatureSet) -> u64 {
    let all = motions.iter().map(|words| words.meta.available);
    all.fold(set.all(), |bits, of_one| bits & of_one)
}

/// The threshold of a class, from its motions and clips of something else. Features that one of the
/// motions lacks do not count, and clips that lack one of the others do not either.
pub(super) fn tau(
    name: &str,
    motions: &[&ClipWords],
    rest: &[&ClipWords],
    what: &What<'_>,
) -> Result<f64, Failure> {
    let available = available(motions, what.set);
    let bits: Vec<u32> = (0..u64::BITS)
        .filter(|bit| available >> bit & 1 == 1)
        .collect();
    let squeezed = |word: &u64| {
        let at = bits.iter().enumerate();
        at.fold(0, |squeezed, (i, bit)| squeezed | (word >> bit & 1) << i)
    };
    let squeezed = |clips: &[&ClipWords]| -> Vec<Vec<u64>> {
        let usable = clips
            .iter()
            .filter(|clip| available & !clip.meta.available == 0);
        usable
            .map(|clip| clip.words.iter().map(squeezed).collect())
            .collect()
    };
    let (motions, rest) = (squeezed(motions), squeezed(rest));
    let slices = [&motions, &rest].map(|clips| clips.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let config = TauConfig {
        learn: what.config,
        ..TauConfig::default()
    };
    let learned = learn_tau(&slices[0], &slices[1], bits.len(), &config);
    let learned = learned.map_err(|e| Failure::Usage(format!("{name}: {e}")))?;
    Ok(learned.tau)
}

/// Keyframes of a class, from its motions and clips of something else that have its features.
pub(super) fn keyframes(
    class: &ClassTemplate,
    motions: &[&ClipWords],
    rest: &[&ClipWords],
    what: &What<'_>,
) -> Result<Vec<Keyframe>, Failure> {
    let refuse = |e: &dyn std::error::Error| Failure::Usage(format!("{}: {e}", class.name));
    let available = available(motions, what.set);
    let usable = rest
        .iter()
        .filter(|clip| available & !clip.meta.available == 0);
    let words = |clip: &&'_ ClipWords| clip.words.clone();
    let positives: Vec<Vec<u64>> = motions.iter().map(words).collect();
    let negatives: Vec<Vec<u64>> = usable.map(words).collect();
    let [positives, negatives] =
        [&positives, &negatives].map(|c| c.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let quantized = class.template.quantize(TauConfig::default().quantization);
    let quantized = quantized.map_err(|e| refuse(&e))?;
    let examples = Examples {
        positives: &positives,
        negatives: &negatives,
    };
    let learned = learn_keyframes(
        &quantized,
        &examples,
        &ExampleConfig::of_features(available),
    );
    Ok(learned.keyframes)
}

/// The template `name` of motions, the first of which is the reference. Features that one of them
/// lacks do not matter.
///
/// # Errors
/// [`Failure::Input`] under the class's name if there are no motions, one has no words, or no feature
/// is there in all of them.
pub fn learn_class(
    name: &str,
    motions: &[&ClipWords],
    what: &What<'_>,
) -> Result<(ClassTemplate, Learned), Failure> {
    let refuse = |error: &dyn ToString| Failure::input(Path::new(name), error.to_string());
    let available = available(motions, what.set);
    if available == 0 {
        return Err(refuse(
            &"expected a feature that the rigs of all clips have, found none",
        ));
    }
    let n_features = what.set.features().len();
    let inputs: Result<Vec<MotionTemplate>, _> = motions
        .iter()
        .map(|words| MotionTemplate::from_words(&words.words, n_features))
        .collect();
    let learned = inputs.and_then(|inputs| learn(&inputs, &what.config));
    let learned = learned.map_err(|e| refuse(&e))?;
    let class = ClassTemplate {
        name: name.to_owned(),
        feature_set: what.set.name().to_owned(),
        rate: what.rate,
        features: selection::names(what.set, what.set.all()),
        template: learned.template.clone(),
        n_motions: Some(motions.len()),
        tau: None,
        keyframes: Vec::new(),
    };
    let columns = 0..class.template.n_columns();
    let class = class.restricted(available, columns);
    Ok((class.map_err(|e| refuse(&e))?, learned))
}
