//! Table 2: what an index takes, in space and in time.

use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use cli::recording::ReadOptions;
use cli::wire::{ClipWords, clip_words};
use segidx::{Index, IndexBuilder, Segment, segment};

use crate::clips::{Clip, Part};
use crate::table::{Table, median};

/// Each index is built this often; a time is the median.
const ROUNDS: usize = 3;

const MINUTE: f64 = 60.0;
/// The paper's: its bytes per segment are consistent with this one.
const MEGABYTE: f64 = (1 << 20) as f64;

/// Seconds of a single thread.
#[derive(Clone, Copy, Debug)]
struct Seconds {
    /// Reading files, parsing them, and from joint angles to positions.
    read: f64,
    features: f64,
    /// Segments and inverted lists, up to the bytes of the file.
    lists: f64,
}

/// The index of the clips by the features of one part. Documents are the clips, in order.
#[derive(Debug)]
pub(crate) struct PartIndex {
    pub(crate) part: Part,
    pub(crate) n_features: usize,
    /// Words per second.
    pub(crate) rate: f64,
    pub(crate) index: Index,
    /// Per document a word per frame.
    pub(crate) words: Vec<Vec<u64>>,
    /// Bytes of a file with the same clips and no frames.
    n_bytes_of_clips: usize,
    seconds: Seconds,
}

impl PartIndex {
    pub(crate) fn build(clips: &[Clip], part: Part, rate: f64) -> Result<PartIndex> {
        let mut times = Vec::new();
        loop {
            let built = PartIndex::build_once(clips, part, rate)?;
            times.push(built.seconds);
            if times.len() == ROUNDS {
                let of = |stage: fn(&Seconds) -> f64| {
                    let stages: Vec<f64> = times.iter().map(stage).collect();
                    median(&stages).unwrap_or(f64::NAN)
                };
                let seconds = Seconds {
                    read: of(|s| s.read),
                    features: of(|s| s.features),
                    lists: of(|s| s.lists),
                };
                return Ok(PartIndex { seconds, ..built });
            }
        }
    }

    fn build_once(clips: &[Clip], part: Part, rate: f64) -> Result<PartIndex> {
        let set = part.features()?;
        let (mut read, mut features) = (Duration::ZERO, Duration::ZERO);
        let mut found: Vec<(ClipWords, Vec<u8>)> = Vec::new();
        for clip in clips {
            let words = clip_words(&clip.file, &ReadOptions::default(), &set, rate)?;
            read += words.times.read + words.times.kinematics;
            features += words.times.features;
            let meta = postcard::to_stdvec(&words.meta).context("what the library keeps")?;
            found.push((words, meta));
        }
        let start = Instant::now();
        let mut builder = IndexBuilder::new();
        for (clip, (words, meta)) in clips.iter().zip(&found) {
            builder.push(clip.name.as_str(), meta.as_slice(), &words.words)?;
        }
        let index = part.index(&builder);
        let lists = start.elapsed();
        let mut clips_alone = IndexBuilder::new();
        for (clip, (_, meta)) in clips.iter().zip(&found) {
            clips_alone.push(clip.name.as_str(), meta.as_slice(), &[])?;
        }
        Ok(PartIndex {
            part,
            n_features: set.features().len(),
            rate,
            index,
            n_bytes_of_clips: part.index(&clips_alone).as_bytes().len(),
            words: found.into_iter().map(|(clip, _)| clip.words).collect(),
            seconds: Seconds {
                read: read.as_secs_f64(),
                features: features.as_secs_f64(),
                lists: lists.as_secs_f64(),
            },
        })
    }

    /// The segments of each document.
    pub(crate) fn segments(&self) -> Vec<Vec<Segment>> {
        self.words.iter().map(|words| segment(words)).collect()
    }

    fn row(&self) -> [String; 14] {
        let Seconds {
            read,
            features,
            lists,
        } = self.seconds;
        let (n_segments, n_frames) = (self.index.n_segments(), self.index.n_frames());
        let bytes = self.index.as_bytes().len() as f64;
        let minutes = n_frames as f64 / self.rate / MINUTE;
        [
            format!(
                "ours  I{minutes:.0}_{} {} Hz",
                self.part.letter(),
                self.rate
            ),
            self.n_features.to_string(),
            (1u64 << self.n_features).to_string(),
            self.index.n_lists().to_string(),
            n_frames.to_string(),
            n_segments.to_string(),
            percent(n_segments as f64, n_frames as f64),
            format!("{:.2}", bytes / MEGABYTE),
            format!("{:.1}", bytes / n_segments as f64),
            format!(
                "{:.1}",
                (bytes - self.n_bytes_of_clips as f64) / n_segments as f64
            ),
            format!("{read:.2}"),
            format!("{features:.2}"),
            format!("{lists:.4}"),
            format!("{:.2}", read + features + lists),
        ]
    }
}

fn percent(part: f64, whole: f64) -> String {
    format!("{:.1}", 100.0 * part / whole)
}

/// A row of the paper's Table 2.
struct Row {
    part: Part,
    minutes: u32,
    n_features: u32,
    n_lists: u32,
    n_frames: u32,
    n_segments: u32,
    megabytes: f64,
    bytes_per_segment: f64,
    /// Read-in, features, lists, total.
    seconds: [u32; 4],
}

impl Row {
    fn cells(&self) -> [String; 14] {
        let [read, features, lists, total] = self.seconds.map(|s| s.to_string());
        [
            format!("paper I{}_{} 120 Hz", self.minutes, self.part.letter()),
            self.n_features.to_string(),
            (1u64 << self.n_features).to_string(),
            self.n_lists.to_string(),
            self.n_frames.to_string(),
            self.n_segments.to_string(),
            percent(self.n_segments.into(), self.n_frames.into()),
            format!("{:.2}", self.megabytes),
            format!("{:.1}", self.bytes_per_segment),
            "-".to_owned(),
            read,
            features,
            lists,
            total,
        ]
    }
}

const D60: (u32, u32) = (60, 425_294);
const D180: (u32, u32) = (180, 1_288_846);

const fn row(
    part: Part,
    (minutes, n_frames): (u32, u32),
    [n_features, n_lists, n_segments]: [u32; 3],
    [megabytes, bytes_per_segment]: [f64; 2],
    seconds: [u32; 4],
) -> Row {
    Row {
        part,
        minutes,
        n_features,
        n_lists,
        n_frames,
        n_segments,
        megabytes,
        bytes_per_segment,
        seconds,
    }
}

const PAPER: [Row; 6] = [
    row(
        Part::Lower,
        D60,
        [11, 409, 21_108],
        [0.72, 35.8],
        [26, 10, 6, 42],
    ),
    row(
        Part::Lower,
        D180,
        [11, 550, 41_587],
        [1.41, 35.5],
        [71, 26, 13, 110],
    ),
    row(
        Part::Upper,
        D60,
        [12, 642, 53_036],
        [1.71, 33.8],
        [26, 13, 10, 49],
    ),
    row(
        Part::Upper,
        D180,
        [12, 877, 135_742],
        [4.33, 33.4],
        [71, 33, 25, 129],
    ),
    row(
        Part::Mix,
        D60,
        [8, 55, 19_067],
        [0.60, 33.0],
        [26, 20, 3, 49],
    ),
    row(
        Part::Mix,
        D180,
        [8, 75, 55_526],
        [1.80, 34.0],
        [71, 54, 12, 137],
    ),
];

/// The paper's Table 2 and ours, part by part.
pub(crate) fn table(n_clips: usize, indexes: &[Vec<PartIndex>]) -> String {
    let head = [
        "index", "f", "2^f", "lists", "frames", "segs", "% of fr", "MB", "B/seg", "bare", "read s",
        "feat s", "list s", "total s",
    ];
    let mut table = Table::new(head);
    for part in Part::EACH {
        for row in PAPER.iter().filter(|row| row.part == part) {
            table.row(row.cells());
        }
        for index in indexes.iter().flatten().filter(|index| index.part == part) {
            table.row(index.row());
        }
    }
    format!(
        "Table 2: feature computation and index construction, {n_clips} clips\n\
         Lists: nonempty ones. Our MB are those of a shard file as motif index writes it, with clip table and\n\
         checksums; bare: bytes per segment without what the same clips take with no frames. all: the index of all\n\
         features, which has the clips' names and rates for the others. Seconds of one thread, median of {ROUNDS}; read: file, parse, joint\n\
         positions. The paper read binary files in Matlab on a Pentium 4 of 3.6 GHz.\n\n{table}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the rounding of both figures allows.
    const ROUNDING: f64 = 0.05 + 0.5;

    #[test]
    fn figures_of_the_paper_agree_with_each_other() {
        for row in &PAPER {
            let bytes = row.megabytes * MEGABYTE / f64::from(row.n_segments);
            let slack = 0.005 * MEGABYTE / f64::from(row.n_segments) + ROUNDING;
            assert!((bytes - row.bytes_per_segment).abs() <= slack, "{bytes}");
            let [read, features, lists, total] = row.seconds;
            // One unit, since each is rounded.
            assert!((read + features + lists).abs_diff(total) <= 1);
        }
    }
}
