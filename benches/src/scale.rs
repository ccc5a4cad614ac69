//! A library of any size, made of perturbed copies of real clips, and what building and asking it costs.
//!
//! Nothing is held in memory but the originals: copies are made one after another, from seeds.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::{Duration, Instant};

use cli::failure::Failure;
use cli::library::{Library, NamedSet, Writer};
use cli::wire::ClipMeta;
use segidx::{Query, Shard, ShardError, search_adaptive, segment};

use perturb::{Dice, perform};

pub mod fit;
pub mod perturb;

/// The part that is asked about.
pub const PART: &str = "upper";

/// Times a question is asked for one figure, so that what else the machine does seldom shows.
const RUNS: usize = 5;

/// Positions of queries.
pub const POSITIONS: [usize; 3] = [5, 10, 20];

/// The clips that copies are made of.
#[derive(Debug)]
pub struct Originals {
    /// What their words mean.
    pub features: NamedSet,
    /// Words per second.
    pub rate: f64,
    /// The clips.
    pub clips: Vec<Original>,
}

/// A clip.
#[derive(Debug)]
pub struct Original {
    name: String,
    meta: ClipMeta,
    words: Vec<u64>,
}

impl Originals {
    /// All clips of a library.
    ///
    /// # Errors
    /// [`Failure`] if it is missing or damaged.
    pub fn open(library: &Path) -> Result<Originals, Failure> {
        let library = Library::open(library)?;
        let mut clips = Vec::new();
        for clip in library.clips()? {
            clips.push(Original {
                words: library.words(clip.id)?,
                name: clip.name,
                meta: clip.meta,
            });
        }
        Ok(Originals {
            features: library.features,
            rate: library.rate,
            clips,
        })
    }

    /// Frames of all clips.
    #[must_use]
    pub fn n_frames(&self) -> usize {
        self.clips.iter().map(|clip| clip.words.len()).sum()
    }

    /// The words of clip `clip` as performer `performer` does it.
    #[must_use]
    pub fn copy(&self, performer: u32, clip: usize) -> Vec<u64> {
        let seed = u64::from(performer) << 32 | clip as u64;
        let other = Dice::new(!seed).below(self.clips.len());
        let n_features = self.features.set.features().len();
        perform(
            &self.clips[clip].words,
            &self.clips[other].words,
            n_features,
            seed,
        )
    }
}

/// A library that was built.
#[derive(Clone, Copy, Debug)]
pub struct Built {
    /// Time of everything but making the copies.
    pub time: Duration,
    /// Clips.
    pub n_clips: usize,
    /// Frames.
    pub n_frames: u64,
}

/// Builds a library of all clips by `n_performers` performers.
///
/// # Errors
/// [`Failure`] if it cannot be written.
pub fn build(
    originals: &Originals,
    n_performers: u32,
    dir: &Path,
    segments_per_shard: usize,
) -> Result<Built, Failure> {
    let start = Instant::now();
    let mut making = Duration::ZERO;
    let writer = Writer::create(dir, originals.features.clone(), originals.rate)?;
    let mut writer = writer.with_segments_per_shard(segments_per_shard);
    let mut n_frames = 0;
    for performer in 0..n_performers {
        for (number, clip) in originals.clips.iter().enumerate() {
            let start = Instant::now();
            let words = originals.copy(performer, number);
            making += start.elapsed();
            n_frames += words.len() as u64;
            writer.push(&format!("{performer:05}/{}", clip.name), &clip.meta, &words)?;
        }
    }
    writer.commit(&BTreeSet::new())?;
    Ok(Built {
        time: start.elapsed() - making,
        n_clips: n_performers as usize * originals.clips.len(),
        n_frames,
    })
}

/// A progression to look for.
#[derive(Clone, Debug)]
pub struct Question {
    /// One word per frame, with the bits of the part.
    pub words: Vec<u64>,
    /// Runs in them.
    pub n_positions: usize,
}

/// `n` seeded random progressions of whole runs under `care`, from the copies of the first `n_performers`
/// performers: each is found there at least once. Lengths take turns through [`POSITIONS`]; clips that have
/// too few runs are passed over.
#[must_use]
pub fn questions(originals: &Originals, n_performers: u32, n: usize, care: u64) -> Vec<Question> {
    /// Draws per question: long clips are rare, but not that rare.
    const DRAWS: usize = 1_000;
    let mut dice = Dice::new(care);
    let mut questions = Vec::with_capacity(n);
    if originals.clips.is_empty() || n_performers == 0 {
        return questions;
    }
    for _ in 0..n * DRAWS {
        if questions.len() == n {
            break;
        }
        let n_positions = POSITIONS[questions.len() % POSITIONS.len()];
        let performer = dice.below(n_performers as usize) as u32;
        let mut words = originals.copy(performer, dice.below(originals.clips.len()));
        words.iter_mut().for_each(|word| *word &= care);
        let runs = segment(&words);
        if runs.len() < n_positions {
            continue;
        }
        let first = dice.below(runs.len() + 1 - n_positions);
        let (first, last) = (&runs[first], &runs[first + n_positions - 1]);
        questions.push(Question {
            words: words[first.start..last.start + last.len].to_vec(),
            n_positions,
        });
    }
    questions
}

/// How a question was answered.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// Runs of the question.
    pub n_positions: usize,
    /// Hits.
    pub n_hits: usize,
    /// Segments in the lists of its rarest run: at least so many postings must be looked at.
    pub n_postings: u64,
    /// Time to open the library and answer, everything unread and unchecked but for what the system keeps of
    /// files.
    pub cold: Duration,
    /// Time to answer when everything was read before.
    pub warm: Duration,
}

/// Asks the library in `dir`.
///
/// # Errors
/// It is missing or damaged.
pub fn ask(dir: &Path, questions: &[Question], care: u64) -> anyhow::Result<Vec<Answer>> {
    let library = Library::open(dir)?;
    let counts = list_lengths(&library, care)?;
    for question in questions {
        hits(&library, question, care)?;
    }
    let mut answers = Vec::with_capacity(questions.len());
    for question in questions {
        let (cold, _) = middle_of_runs(|| hits(&Library::open(dir)?, question, care))?;
        let (warm, n_hits) = middle_of_runs(|| hits(&library, question, care))?;
        let lengths = question.words.iter().map(|word| counts.get(word));
        answers.push(Answer {
            n_positions: question.n_positions,
            n_hits,
            n_postings: lengths.map(|n| n.copied().unwrap_or(0)).min().unwrap_or(0),
            cold,
            warm,
        });
    }
    Ok(answers)
}

/// The median time of [`RUNS`] runs, and what the last one gave.
fn middle_of_runs(run: impl Fn() -> Result<usize, Failure>) -> Result<(Duration, usize), Failure> {
    let mut times = [Duration::ZERO; RUNS];
    let mut n_hits = 0;
    for time in &mut times {
        let start = Instant::now();
        n_hits = run()?;
        *time = start.elapsed();
    }
    times.sort();
    Ok((times[RUNS / 2], n_hits))
}

/// The number of hits.
///
/// # Errors
/// [`Failure`] if the library is damaged.
pub fn hits(library: &Library, question: &Question, care: u64) -> Result<usize, Failure> {
    let query = Query::fuzzy(&question.words, care);
    let search = |shard: &Shard<_>| search_adaptive(shard, &query);
    Ok(library.search_adaptive(care, search)?.len())
}

/// Segments per word of the part.
fn list_lengths(library: &Library, care: u64) -> Result<BTreeMap<u64, u64>, ShardError> {
    let mut counts = BTreeMap::new();
    for open in library.shards() {
        let Some(part) = open.part_for(care) else {
            continue;
        };
        for list in part.shard.lists()? {
            *counts.entry(list.word).or_insert(0) += list.segments.len() as u64;
        }
    }
    Ok(counts)
}

#[cfg(test)]
mod tests;
