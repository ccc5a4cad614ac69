//! Our side of `cargo xtask peers retrieval`; numbers in files are `u64`, least significant byte
//! first.
//!
//! - `retrieval_peer motif:documents N FILE` writes N documents of the corpus, each as its number
//!   of frames and then its words.
//! - `retrieval_peer motif:build 0 DOCUMENTS SHARD` indexes them and prints `bytes=…`.
//! - `retrieval_peer motif RUNS SHARD QUERIES` searches. A file of queries has their number of
//!   segments first, then word and frames of each segment.

use std::fs;
use std::path::Path;
use std::{env, iter};

use anyhow::{Context, Result, bail};
use benches::stopwatch;
use cli::recording::ReadOptions;
use cli::source::find_clips;
use cli::wire::clip_words;
use segidx::{Query, Shard, search_exact};

const SEARCHED_BEFORE: &str = "the same pages were read before";

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["motif:documents", n, file] => write_documents(n.parse()?, Path::new(file)),
        ["motif:recordings", rate, file, folder] => {
            write_recordings(rate.parse()?, Path::new(file), Path::new(folder))
        }
        ["motif:build", _, documents, shard] => build(Path::new(documents), Path::new(shard)),
        ["motif", runs, shard, queries] => {
            search(runs.parse()?, Path::new(shard), Path::new(queries))
        }
        _ => bail!("NAME RUNS FILE… expected"),
    }
}

/// The words of all clips in the folders `hdm05` and `cmu`, at `rate` per second.
fn write_recordings(rate: f64, file: &Path, folder: &Path) -> Result<()> {
    let clips = find_clips(&["hdm05", "cmu"].map(|name| folder.join(name)))?;
    let set = benches::features();
    let words = clips.iter().map(|clip| {
        let clip = clip_words(clip, &ReadOptions::default(), &set, rate)?;
        Ok(clip.words)
    });
    write_words(&words.collect::<Result<Vec<_>>>()?, file)
}

fn write_documents(n: usize, file: &Path) -> Result<()> {
    write_words(&benches::documents(n), file)
}

fn write_words(documents: &[Vec<u64>], file: &Path) -> Result<()> {
    let numbers = documents
        .iter()
        .flat_map(|words| iter::once(words.len() as u64).chain(words.iter().copied()));
    let bytes: Vec<u8> = numbers.flat_map(u64::to_le_bytes).collect();
    Ok(fs::write(file, bytes)?)
}

fn build(documents: &Path, shard: &Path) -> Result<()> {
    let numbers = numbers(documents)?;
    let mut documents: Vec<Vec<u64>> = Vec::new();
    let mut left = &numbers[..];
    while let Some((&n_frames, rest)) = left.split_first() {
        let words = rest.split_at_checked(n_frames as usize);
        let (words, rest) = words.context("a document is cut off")?;
        documents.push(words.to_vec());
        left = rest;
    }
    let index = benches::index(&documents);
    fs::write(shard, index.as_bytes())?;
    println!("bytes={}", index.as_bytes().len());
    Ok(())
}

fn search(runs: usize, shard: &Path, queries: &Path) -> Result<()> {
    let shard = Shard::open(fs::read(shard)?)?;
    let numbers = numbers(queries)?;
    let (&n_segments, segments) = numbers.split_first().context("no queries")?;
    let (segments, _) = segments.as_chunks::<2>();
    let queries = segments.chunks_exact(n_segments as usize);
    let queries: Vec<Query> = queries.map(query).collect();
    for query in &queries {
        search_exact(&shard, query)?;
    }
    let work = || {
        let (mut n_hits, mut places) = (0, 0);
        for query in &queries {
            let hits = search_exact(&shard, query).expect(SEARCHED_BEFORE);
            n_hits += hits.len();
            let place = hits
                .iter()
                .map(|hit| hit.doc.index() + hit.first_segment_in_doc);
            places += place.sum::<usize>();
        }
        (n_hits, places)
    };
    stopwatch::report(runs, work, |&(n_hits, places)| {
        [("hits", n_hits as f64), ("places", places as f64)]
    });
    Ok(())
}

/// The exact query of an example with these segments.
fn query(segments: &[[u64; 2]]) -> Query {
    let frames = segments
        .iter()
        .flat_map(|&[word, n_frames]| iter::repeat_n(word, n_frames as usize));
    Query::exact(&frames.collect::<Vec<u64>>(), u64::MAX)
}

fn numbers(path: &Path) -> Result<Vec<u64>> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let (numbers, _) = bytes.as_chunks();
    Ok(numbers.iter().map(|b| u64::from_le_bytes(*b)).collect())
}
