//! Where hits are as their scenes ask.

use std::ops::Range;
use std::path::Path;

use relfeat::FeatureSet;
use segidx::search_scene;

use super::super::asked::index_of;
use crate::failure::Failure;
use crate::library::{Clip, Library};
use crate::picture::scene::State;
use crate::scene::{Line, SceneText};
use crate::source::Span;

/// How a hit stands to what its scene asks, line by line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneAgreement {
    /// What each line is called: its feature, and its own name where it has one.
    pub names: Vec<String>,
    /// Per line as many states as the hit has words.
    pub rows: Vec<Vec<State>>,
}

impl SceneAgreement {
    /// Holds the words of a clip within `span` against a scene. `runs` has the words of each position of each line.
    /// O(words of the hit · positions).
    #[must_use]
    pub fn new(
        set: &FeatureSet,
        scene: &SceneText,
        runs: &[Vec<Range<usize>>],
        (words, span): (&[u64], Range<usize>),
    ) -> SceneAgreement {
        let rows = scene.lines.iter().zip(runs).map(|(line, runs)| {
            let words = words.iter().enumerate().take(span.end).skip(span.start);
            let states = words.map(|(at, &word)| state(line, runs, (at, word)));
            states.collect()
        });
        SceneAgreement {
            rows: rows.collect(),
            names: scene.lines.iter().map(|line| name(set, line)).collect(),
        }
    }
}

fn name(set: &FeatureSet, line: &Line) -> String {
    let feature = &set.features()[line.feature_idx].name;
    // A feature may be named by its number.
    match set.select(&line.name) == Some(1 << line.feature_idx) {
        true => feature.clone(),
        false => format!("{feature} as {}", line.name),
    }
}

/// Of several positions that have a word all ask the same.
fn state(line: &Line, runs: &[Range<usize>], (at, word): (usize, u64)) -> State {
    let is_on = word >> line.feature_idx & 1 == 1;
    let mut asked = line.values.iter().zip(runs);
    let asked = asked.find(|(_, run)| run.contains(&at));
    match asked.and_then(|(value, _)| *value) {
        None => State::Free,
        Some(value) if value != is_on => State::Otherwise,
        Some(true) => State::On,
        Some(false) => State::Off,
    }
}

/// How the hit of these source frames of a clip stands to the scene; `None` if there is no such hit. Only the clip is
/// searched.
///
/// # Errors
/// [`Failure::Input`] where the library is damaged.
pub fn explain_scene(
    library: &Library,
    scene: &SceneText,
    clip: &Clip,
    frames: Span,
) -> Result<Option<SceneAgreement>, Failure> {
    let query = scene.query(library.rate);
    let query = query.map_err(|e| Failure::Usage(format!("--scene: {e}")))?;
    if scene.care() & !clip.meta.available != 0 {
        return Ok(None);
    }
    let (words, index) = index_of(library, clip)?;
    let hits = search_scene(&index, &query);
    let hits = hits.map_err(|e| Failure::input(Path::new(&clip.name), e))?;
    let source = |span: Range<usize>| clip.meta.source_span(span, words.len(), library.rate);
    let hit = hits.iter().find(|hit| source(hit.span.clone()) == frames);
    Ok(hit.map(|hit| {
        let of_hit = (words.as_slice(), hit.span.clone());
        SceneAgreement::new(&library.features.set, scene, &hit.lines, of_hit)
    }))
}
