//! `motif search --scene`.

mod explain;

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use mocap_io::Position;
use segidx::{SceneHit, search_scene};
use serde::Serialize;

pub use self::explain::{SceneAgreement, explain_scene};
use super::hits::{Found, HitJson, Place, boundaries, write_unsearched};
use crate::args::Global;
use crate::failure::{Exit, Failure};
use crate::library::{Clip, Library};
use crate::output::{Outcome, Voice, count, table};
use crate::scene::{SceneText, parse};
use crate::source::Span;

/// What was looked for and where it was found.
#[derive(Clone, Debug, Serialize)]
pub struct SceneResult {
    /// What was looked for.
    pub query: SceneQueryJson,
    /// Number of hits, listed or not.
    pub n_hits: usize,
    /// Number of clips with a hit.
    pub n_clips: usize,
    /// Clips that could not be searched, because their rigs lack a feature of the scene.
    pub n_unsearched: usize,
    /// The best hits, the shortest first.
    pub hits: Vec<SceneHitJson>,
}

/// What was looked for.
#[derive(Clone, Debug, Serialize)]
pub struct SceneQueryJson {
    /// The scene description as it was given.
    pub scene: String,
    /// Its lines.
    pub lines: Vec<LineJson>,
}

/// A line of the scene.
#[derive(Clone, Debug, Serialize)]
pub struct LineJson {
    /// What relations call it.
    pub name: String,
    /// Its feature.
    pub feature: String,
    /// What the feature goes through, such as `0 1 0`.
    pub progression: String,
}

/// A hit, as design.md §4 lays it down. `start` and `end` are the smallest span with the cores of all lines, `cost`
/// is its length in words, `segments` has the core of each line.
#[derive(Clone, Debug, Serialize)]
pub struct SceneHitJson {
    /// Where it is.
    #[serde(flatten)]
    pub hit: HitJson,
    /// The runs of each line.
    pub lines: Vec<LineHitJson>,
}

/// A line of a hit.
#[derive(Clone, Debug, Serialize)]
pub struct LineHitJson {
    /// What relations call it.
    pub name: String,
    /// Frames of the run of each written position.
    pub segments: Vec<[usize; 2]>,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`].
pub(super) fn run(
    library: &Path,
    scene: &str,
    top: usize,
    global: &Global,
) -> Result<Exit, Failure> {
    let voice = global.voice();
    let library = Library::open(library)?;
    let result = search(&library, scene, top, voice)?;
    let outcome = Outcome {
        found: result.n_hits > 0,
        result,
        skipped: Vec::new(),
    };
    let result = &outcome.result;
    voice.report("search", &outcome, |out| write_hits(out, result))
}

/// Finds a scene, given as a text or as the path of a file with it. `top` hits are listed, all if it is 0.
///
/// # Errors
/// [`Failure`]: a file that cannot be read, a text that is no scene description.
pub fn search(
    library: &Library,
    scene: &str,
    top: usize,
    voice: Voice,
) -> Result<SceneResult, Failure> {
    let given = Given::read(scene)?;
    let set = &library.features.set;
    let scene = parse(&given.text, set).map_err(|e| given.failure(e.at, e.kind))?;
    for (at, note) in &scene.notes {
        voice.note(&format!("{}:{at}: {note}", given.name()));
    }
    search_scene_text(library, &scene, &given.text, top)
}

/// Finds a scene, understood from `text`. `top` hits are listed, all if it is 0.
///
/// # Errors
/// [`Failure::Input`] where the library is damaged.
pub fn search_scene_text(
    library: &Library,
    scene: &SceneText,
    text: &str,
    top: usize,
) -> Result<SceneResult, Failure> {
    // A text that was understood is a query.
    let query = scene.query(library.rate);
    let query = query.map_err(|e| Failure::Usage(format!("--scene: {e}")))?;
    let mut found = Found::new(library);
    let hits = library.search(|shard| search_scene(shard, &query))?;
    found.add(scene.care(), hits)?;
    let listed = found.listed(top);
    let listed = listed.map(|(rank, clip, hit)| hit_json(library, scene, (clip, hit), rank));
    let hits = listed.collect();
    let set = &library.features.set;
    let line = |line: &crate::scene::Line| LineJson {
        name: line.name.clone(),
        feature: set.features()[line.feature_idx].name.clone(),
        progression: line.progression(),
    };
    Ok(SceneResult {
        query: SceneQueryJson {
            lines: scene.lines.iter().map(line).collect(),
            scene: text.to_owned(),
        },
        n_hits: found.hits.len(),
        n_clips: found.n_clips(),
        n_unsearched: found.n_unsearched(),
        hits,
    })
}

/// A scene description as it was given.
struct Given<'a> {
    /// `None` if the text stood on the command line.
    path: Option<&'a Path>,
    text: String,
}

impl Given<'_> {
    /// A file if there is one of this name, else the text itself, which has a `:`.
    fn read(scene: &str) -> Result<Given<'_>, Failure> {
        let path = Path::new(scene);
        if path.is_file() {
            let bytes = fs::read(path).map_err(|e| Failure::io(path, e))?;
            let text = String::from_utf8(bytes)
                .map_err(|e| Failure::input(path, format!("expected UTF-8 text: {e}")))?;
            let path = Some(path);
            return Ok(Given { path, text });
        }
        if !scene.contains(':') {
            let message = format!(
                "--scene {scene}: no such file, and no scene, which has a line such as `rknee_bent : 0 1 0`"
            );
            return Err(Failure::Usage(message));
        }
        let text = scene.to_owned();
        Ok(Given { path: None, text })
    }

    fn name(&self) -> String {
        let name = self.path.map(|path| path.display().to_string());
        name.unwrap_or_else(|| "--scene".to_owned())
    }

    fn failure(&self, at: Position, what: impl std::fmt::Display) -> Failure {
        match self.path {
            Some(path) => Failure::Input {
                path: path.to_owned(),
                at: Some(at),
                message: what.to_string(),
            },
            None => Failure::Usage(format!("--scene:{at}: {what}")),
        }
    }
}

fn hit_json(
    library: &Library,
    scene: &SceneText,
    (clip, hit): (&Clip, &SceneHit),
    rank: usize,
) -> SceneHitJson {
    let meta = &clip.meta;
    let source = |words: &std::ops::Range<usize>| {
        let Span { start, end } = meta.source_span(words.clone(), clip.n_words, library.rate);
        [start, end]
    };
    let lines = scene.lines.iter().zip(&hit.lines);
    let place = Place {
        span: hit.span.clone(),
        segments: &hit.cores,
        cost: hit.cost(),
    };
    SceneHitJson {
        hit: HitJson::new(library, clip, place, rank),
        lines: lines
            .map(|(line, runs)| LineHitJson {
                name: line.name.clone(),
                segments: runs.iter().map(source).collect(),
            })
            .collect(),
    }
}

fn write_hits(out: &mut dyn Write, result: &SceneResult) -> io::Result<()> {
    let lines = &result.query.lines;
    let looked_for: Vec<String> = lines
        .iter()
        .map(|line| format!("{} {}", line.name, line.progression))
        .collect();
    writeln!(out, "looked for {}", looked_for.join(", "))?;
    write_unsearched(out, result.n_unsearched)?;
    if result.n_hits == 0 {
        return writeln!(out, "nothing found");
    }
    let (hits, clips) = (count(result.n_hits, "hit"), count(result.n_clips, "clip"));
    writeln!(out, "{hits} in {clips}, the shortest first")?;
    let names = lines.iter().map(|line| line.name.as_str());
    let heads: Vec<&str> = ["rank", "clip", "frames", "seconds"]
        .into_iter()
        .chain(names)
        .collect();
    let mut rows = table(&heads);
    for SceneHitJson { hit, .. } in &result.hits {
        let mut row = vec![
            hit.rank.to_string(),
            hit.clip.clone(),
            format!("{}-{}", hit.start, hit.end),
            format!("{:.2}-{:.2}", hit.start_s, hit.end_s),
        ];
        let cores = hit.segments.iter();
        row.extend(cores.map(|core| boundaries(std::slice::from_ref(core))));
        rows.add_row(row);
    }
    writeln!(out, "{}", rows.trim_fmt())?;
    let n_more = result.n_hits - result.hits.len();
    if n_more > 0 {
        writeln!(out, "… and {n_more} more; --top 0 lists all")?;
    }
    Ok(())
}
