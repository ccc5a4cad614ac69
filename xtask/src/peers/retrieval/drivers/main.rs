//! Tantivy on documents of feature words; numbers in files are `u64`, least significant byte first.
//!
//! - `rust_peers tantivy:build 0 DOCUMENTS INDEX` indexes documents and prints `bytes=…`.
//! - `rust_peers tantivy:build-frames 0 DOCUMENTS INDEX` also stores how many frames each segment has,
//!   without which a hit cannot be ranked, nor be told in frames.
//! - `rust_peers tantivy RUNS INDEX QUERIES` counts the documents of phrase queries.
//! - `rust_peers tantivy:hits RUNS INDEX QUERIES` finds every place of the phrases, as ours does;
//!   tantivy has no collector for that, so its postings and positions are intersected here.

use std::path::Path;
use std::{env, fs};

use tantivy::collector::Count;
use tantivy::postings::{Postings, SegmentPostings};
use tantivy::query::PhraseQuery;
use tantivy::schema::{FAST, Field, IndexRecordOption, STORED, Schema, TextFieldIndexing, TextOptions};
use tantivy::tokenizer::{PreTokenizedString, Token};
use tantivy::{
    DocSet, Index, IndexWriter, InvertedIndexReader, ReloadPolicy, Searcher, TERMINATED,
    TantivyDocument, Term,
};

mod stopwatch;

const WORDS: &str = "words";
const NUMBER: &str = "number";
const FRAMES: &str = "frames";
/// Enough for all documents at once, so that they are one segment from the beginning.
const MEMORY: usize = 2_000_000_000;

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [name, runs, from, to] = arguments.try_into().expect("NAME RUNS FILE FILE");
    let runs = runs.parse().expect("a number of runs");
    match name.as_str() {
        "tantivy:build" => build(Path::new(&from), Path::new(&to), None).expect("an index"),
        "tantivy:build-frames" => {
            build(Path::new(&from), Path::new(&to), Some(FRAMES)).expect("an index");
        }
        "tantivy" => count(runs, Path::new(&from), Path::new(&to)).expect("counts"),
        "tantivy:hits" => find(runs, Path::new(&from), Path::new(&to)).expect("hits"),
        other => panic!("no peer is named {other}"),
    }
}

/// One segment, with words and positions and a number for each document, and in the field `stored`, if
/// there is one, the frames of its segments.
fn build(documents: &Path, folder: &Path, stored: Option<&str>) -> tantivy::Result<()> {
    let _ = fs::remove_dir_all(folder);
    fs::create_dir_all(folder)?;
    let mut schema = Schema::builder();
    let indexing = TextFieldIndexing::default()
        .set_fieldnorms(false)
        .set_index_option(IndexRecordOption::WithFreqsAndPositions);
    let options = TextOptions::default().set_indexing_options(indexing);
    let words = schema.add_text_field(WORDS, options);
    let number = schema.add_u64_field(NUMBER, FAST);
    let stored = stored.map(|name| schema.add_bytes_field(name, STORED));
    let index = Index::create_in_dir(folder, schema.build())?;
    let mut writer: IndexWriter = index.writer_with_num_threads(1, MEMORY)?;
    let numbers = numbers(documents);
    let mut left = &numbers[..];
    let mut n_documents = 0;
    while let Some((&n_frames, rest)) = left.split_first() {
        let (frames, rest) = rest.split_at(n_frames as usize);
        let mut document = TantivyDocument::new();
        document.add_pre_tokenized_text(words, tokens(frames));
        document.add_u64(number, n_documents);
        if let Some(stored) = stored {
            document.add_bytes(stored, &durations(frames));
        }
        writer.add_document(document)?;
        n_documents += 1;
        left = rest;
    }
    writer.commit()?;
    writer.merge(&index.searchable_segment_ids()?).wait()?;
    writer.garbage_collect_files().wait()?;
    writer.wait_merging_threads()?;
    println!("bytes={}", open(folder)?.space_usage()?.total().get_bytes());
    Ok(())
}

/// A token for each segment.
fn tokens(frames: &[u64]) -> PreTokenizedString {
    let segments = frames.chunk_by(|a, b| a == b);
    let token = |(position, segment): (usize, &[u64])| Token {
        position,
        text: term(segment[0]),
        ..Token::default()
    };
    PreTokenizedString {
        text: String::new(),
        tokens: segments.enumerate().map(token).collect(),
    }
}

/// The frames of each segment: seven bits a byte, the lowest first, the highest bit of all but the last.
fn durations(frames: &[u64]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for segment in frames.chunk_by(|a, b| a == b) {
        let mut left = segment.len();
        while left > 0x7f {
            bytes.push(left as u8 | 0x80);
            left >>= 7;
        }
        bytes.push(left as u8);
    }
    bytes
}

fn term(word: u64) -> String {
    format!("{word:x}")
}

fn open(folder: &Path) -> tantivy::Result<Searcher> {
    let index = Index::open_in_dir(folder)?;
    let reader = index.reader_builder();
    let searcher = reader
        .reload_policy(ReloadPolicy::Manual)
        .try_into()?
        .searcher();
    assert_eq!(searcher.segment_readers().len(), 1, "one segment");
    Ok(searcher)
}

fn count(runs: usize, folder: &Path, queries: &Path) -> tantivy::Result<()> {
    let searcher = open(folder)?;
    let queries: Vec<PhraseQuery> = phrases(queries, field(&searcher)?)
        .into_iter()
        .map(PhraseQuery::new)
        .collect();
    let work = || -> usize {
        let counts = queries.iter().map(|query| {
            let count = searcher.search(query, &Count);
            count.expect("the same files were searched before")
        });
        counts.sum()
    };
    stopwatch::report(runs, work, |&n| [("documents", n as f64)]);
    Ok(())
}

fn find(runs: usize, folder: &Path, queries: &Path) -> tantivy::Result<()> {
    let searcher = open(folder)?;
    let field = field(&searcher)?;
    let queries = phrases(queries, field);
    let segment = searcher.segment_reader(0);
    let work = || {
        let (mut n_hits, mut places) = (0, 0);
        for phrase in &queries {
            let inverted = segment.inverted_index(field).expect("the field's index");
            let hits = occurrences(&inverted, phrase).expect("postings");
            n_hits += hits.len();
            places += hits
                .iter()
                .map(|&(doc, position)| (doc + position) as usize)
                .sum::<usize>();
        }
        (n_hits, places)
    };
    stopwatch::report(runs, work, |&(n_hits, places)| {
        [("hits", n_hits as f64), ("places", places as f64)]
    });
    Ok(())
}

/// Document and position of every occurrence.
fn occurrences(
    inverted: &InvertedIndexReader,
    phrase: &[Term],
) -> tantivy::Result<Vec<(u32, u32)>> {
    let mut lists: Vec<(u32, SegmentPostings)> = Vec::with_capacity(phrase.len());
    for (offset, term) in phrase.iter().enumerate() {
        match inverted.read_postings(term, IndexRecordOption::WithFreqsAndPositions)? {
            Some(postings) => lists.push(((phrase.len() - 1 - offset) as u32, postings)),
            None => return Ok(Vec::new()),
        }
    }
    lists.sort_by_key(|(_, postings)| postings.doc_freq());
    let mut hits = Vec::new();
    let (mut left, mut right) = (Vec::new(), Vec::new());
    let (rarest, others) = lists.split_first_mut().expect("a phrase has terms");
    let mut doc = rarest.1.doc();
    'documents: while doc != TERMINATED {
        for (_, other) in others.iter_mut() {
            if other.doc() < doc {
                other.seek(doc);
            }
            if other.doc() > doc {
                doc = rarest.1.seek(other.doc());
                continue 'documents;
            }
        }
        rarest.1.positions_with_offset(rarest.0, &mut left);
        for (offset, other) in others.iter_mut() {
            if left.is_empty() {
                break;
            }
            other.positions_with_offset(*offset, &mut right);
            intersect(&mut left, &right);
        }
        let last = phrase.len() as u32 - 1;
        hits.extend(left.iter().map(|position| (doc, position - last)));
        doc = rarest.1.advance();
    }
    Ok(hits)
}

/// Keeps of `left` what is in `right` too; both increase.
fn intersect(left: &mut Vec<u32>, right: &[u32]) {
    let mut at = 0;
    left.retain(|position| {
        while right.get(at).is_some_and(|other| other < position) {
            at += 1;
        }
        right.get(at) == Some(position)
    });
}

fn field(searcher: &Searcher) -> tantivy::Result<Field> {
    searcher.schema().get_field(WORDS)
}

fn phrases(queries: &Path, field: Field) -> Vec<Vec<Term>> {
    let numbers = numbers(queries);
    let (&n_segments, segments) = numbers.split_first().expect("queries");
    let (segments, _) = segments.as_chunks::<2>();
    let terms = |segments: &[[u64; 2]]| {
        let terms = segments.iter();
        terms
            .map(|&[word, _]| Term::from_field_text(field, &term(word)))
            .collect()
    };
    segments
        .chunks_exact(n_segments as usize)
        .map(terms)
        .collect()
}

fn numbers(path: &Path) -> Vec<u64> {
    let bytes = fs::read(path).expect("a file");
    let (numbers, _) = bytes.as_chunks();
    numbers.iter().map(|b| u64::from_le_bytes(*b)).collect()
}
