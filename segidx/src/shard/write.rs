//! From documents to the bytes of a shard.

use super::SHARD;
use super::layout::{Counts, Layout, Part, ROW};
use super::packed::{BLOCK, BitWriter, pack};
use super::pages::Pages;

/// What a builder has collected.
#[derive(Clone, Debug)]
pub(crate) struct Collected {
    pub(crate) names: Vec<String>,
    pub(crate) metas: Vec<Vec<u8>>,
    /// Document d owns segments `offsets[d]..offsets[d + 1]`.
    pub(crate) offsets: Vec<u32>,
    /// Per segment: its word.
    pub(crate) words: Vec<u64>,
    /// Per segment: its frames.
    pub(crate) lengths: Vec<u32>,
}

impl Default for Collected {
    fn default() -> Collected {
        Collected {
            names: Vec::new(),
            metas: Vec::new(),
            offsets: vec![0],
            words: Vec::new(),
            lengths: Vec::new(),
        }
    }
}

impl Collected {
    /// The same documents, nameless, cut into the segments of `word & bits`.
    pub(crate) fn restricted(&self, bits: u64) -> Collected {
        let n_documents = self.names.len();
        let mut restricted = Collected {
            names: vec![String::new(); n_documents],
            metas: vec![Vec::new(); n_documents],
            ..Collected::default()
        };
        for bounds in self.offsets.windows(2) {
            let (words, lengths) = (&mut restricted.words, &mut restricted.lengths);
            let first = words.len();
            for k in bounds[0] as usize..bounds[1] as usize {
                let word = self.words[k] & bits;
                match lengths.last_mut() {
                    // No document has more frames than 32 bits can count.
                    Some(len) if words.len() > first && words.last() == Some(&word) => {
                        *len += self.lengths[k];
                    }
                    _ => {
                        words.push(word);
                        lengths.push(self.lengths[k]);
                    }
                }
            }
            restricted.offsets.push(words.len() as u32);
        }
        restricted
    }
}

/// The words of all segments, by word.
struct Sorted {
    words: Vec<u64>,
    lists: Vec<u64>,
    /// First segment of each list, gaps less one within it.
    postings: Vec<u64>,
    /// Per segment: the number of its word.
    numbers: Vec<u32>,
}

impl Sorted {
    fn new(words: &[u64]) -> Sorted {
        let mut order: Vec<u32> = (0..words.len() as u32).collect();
        // The number breaks ties, so each list comes out increasing.
        order.sort_unstable_by_key(|&k| (words[k as usize], k));
        let mut sorted = Sorted {
            words: Vec::new(),
            lists: Vec::new(),
            postings: Vec::with_capacity(words.len()),
            numbers: vec![0; words.len()],
        };
        for list in order.chunk_by(|&a, &b| words[a as usize] == words[b as usize]) {
            for &k in list {
                sorted.numbers[k as usize] = sorted.words.len() as u32;
            }
            sorted.words.push(words[list[0] as usize]);
            sorted.lists.push(list.len() as u64 - 1);
            sorted.postings.push(u64::from(list[0]));
            let gaps = list.windows(2).map(|pair| u64::from(pair[1] - pair[0] - 1));
            sorted.postings.extend(gaps);
        }
        sorted
    }
}

/// The bytes of the shard.
pub(crate) fn write(collected: &Collected) -> Vec<u8> {
    let sorted = Sorted::new(&collected.words);
    let lengths = &collected.lengths;
    let (rows, text, prefix_len, n_frames) = clip_table(collected);
    let counts = Counts {
        n_documents: collected.names.len() as u32,
        n_segments: collected.words.len() as u32,
        n_words: sorted.words.len() as u32,
        prefix_len,
        n_frames,
    };
    let before = std::iter::once(0).chain(sorted.words.iter().map(|word| word.wrapping_add(1)));
    let gaps: Vec<u64> = sorted
        .words
        .iter()
        .zip(before)
        .map(|(word, before)| word - before)
        .collect();
    let lengths_less_one: Vec<u64> = lengths.iter().map(|&len| u64::from(len) - 1).collect();
    let sections = [
        (Part::Documents, rows),
        (Part::Text, text),
        (Part::Words, pack(&gaps)),
        (Part::Lists, pack(&sorted.lists)),
        (
            Part::Segments,
            segments(collected, &sorted.numbers, &counts),
        ),
        (Part::Frames, frames(lengths)),
        (Part::Lengths, pack(&lengths_less_one)),
        (Part::Postings, pack(&sorted.postings)),
    ];
    let (mut payload, body) = Layout::assemble(&counts, sections);
    for sum in Pages::sums_of(&body) {
        payload.extend(sum.to_le_bytes());
    }
    [&SHARD.header(&payload)[..], &payload, &body].concat()
}

/// The clip table, its text, the bytes all names share, and the frames of all documents.
fn clip_table(collected: &Collected) -> (Vec<u8>, Vec<u8>, u32, u64) {
    let prefix = shared_prefix(&collected.names);
    let mut text = prefix.as_bytes().to_vec();
    let mut rows = Vec::with_capacity((collected.names.len() + 1) * ROW);
    let mut frame = 0u64;
    let mut push_row = |frame: u64, segment: u32, name: usize, meta: usize| {
        rows.extend(frame.to_le_bytes());
        rows.extend(segment.to_le_bytes());
        rows.extend((name as u32).to_le_bytes());
        rows.extend((meta as u32).to_le_bytes());
    };
    let clips = collected.names.iter().zip(&collected.metas);
    for ((name, meta), bounds) in clips.zip(collected.offsets.windows(2)) {
        let start = text.len();
        text.extend(&name.as_bytes()[prefix.len()..]);
        push_row(frame, bounds[0], start, text.len());
        text.extend(meta);
        let lengths = &collected.lengths[bounds[0] as usize..bounds[1] as usize];
        frame += lengths.iter().map(|&len| u64::from(len)).sum::<u64>();
    }
    push_row(frame, collected.words.len() as u32, text.len(), text.len());
    (rows, text, prefix.len() as u32, frame)
}

/// The longest beginning of all names, which is mostly the path of a folder.
fn shared_prefix(names: &[String]) -> &str {
    let Some((first, others)) = names.split_first() else {
        return "";
    };
    let mut prefix = first.as_str();
    for name in others {
        while !name.starts_with(prefix) {
            let end = prefix.char_indices().next_back().map_or(0, |(at, _)| at);
            prefix = &prefix[..end];
        }
    }
    prefix
}

fn segments(collected: &Collected, numbers: &[u32], counts: &Counts) -> Vec<u8> {
    let width = counts.segment_width();
    let mut bits = BitWriter::default();
    for bounds in collected.offsets.windows(2) {
        for k in bounds[0]..bounds[1] {
            let is_first = u64::from(k == bounds[0]);
            bits.push(u64::from(numbers[k as usize]) << 1 | is_first, width);
        }
    }
    bits.finish()
}

fn frames(lengths: &[u32]) -> Vec<u8> {
    let mut frame = 0u64;
    let mut section = Vec::new();
    for block in lengths.chunks(BLOCK) {
        section.extend(frame.to_le_bytes());
        frame += block.iter().map(|&len| u64::from(len)).sum::<u64>();
    }
    section
}
