//! Libraries that are written shard by shard while clips come.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use cli::library::{ClipId, Library, NamedSet, Writer, verify};
use cli::recording::ReadOptions;
use cli::wire::ClipMeta;
use proptest::collection::vec;
use proptest::prelude::*;
use segidx::{Hit, Query, Shard, search_adaptive};
use tempfile::TempDir;

use crate::corpus::{Fixture, index};
use crate::library::shard_files;

/// Frames and costs of hits, which do not depend on how a library is cut into shards and parts.
pub(crate) fn frames(hits: Vec<(ClipId, Hit)>) -> Vec<(ClipId, u64, Vec<std::ops::Range<usize>>)> {
    let plain = |(clip, hit): (ClipId, Hit)| (clip, hit.cost, hit.segments);
    hits.into_iter().map(plain).collect()
}

fn meta(n_words: usize) -> ClipMeta {
    ClipMeta {
        source_rate: 30.0,
        source_frames: n_words as u64,
        first_frame: 0,
        end_frame: n_words as u64,
        first_word: 0,
        available: u64::MAX,
        rig: "none".to_owned(),
        content: 0,
    }
}

fn writer(dir: &Path, limit: usize) -> Writer {
    let set = NamedSet::find("mueller2005").unwrap();
    let writer = Writer::create(dir, set, 30.0).unwrap();
    writer.with_segments_per_shard(limit)
}

fn push(writer: &mut Writer, clips: &[Vec<u64>]) {
    for (i, words) in clips.iter().enumerate() {
        writer
            .push(&format!("clip {i}"), &meta(words.len()), words)
            .unwrap();
    }
}

fn library(dir: &Path, clips: &[Vec<u64>], limit: usize) -> Library {
    let mut writer = writer(dir, limit);
    push(&mut writer, clips);
    writer.commit(&BTreeSet::new()).unwrap();
    Library::open(dir).unwrap()
}

fn names(library: &Library) -> Vec<String> {
    let clips = library.clips().unwrap().into_iter();
    clips.map(|clip| clip.name).collect()
}

/// Hits with names in place of the numbers of shards.
fn found(library: &Library, query: &Query, care: u64) -> Vec<(String, u64, usize)> {
    let names: BTreeMap<ClipId, String> = library
        .clips()
        .unwrap()
        .into_iter()
        .map(|clip| (clip.id, clip.name))
        .collect();
    let hits = library.search_adaptive(care, |shard| search_adaptive(shard, query));
    let hits = hits.unwrap().into_iter();
    hits.map(|(clip, hit)| (names[&clip].clone(), hit.cost, hit.span().start))
        .collect()
}

/// Every file below `dir` but the lock, with its content.
fn files(dir: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let shards = fs::read_dir(dir.join("shards")).unwrap();
    let mut files: Vec<PathBuf> = shards.map(|e| e.unwrap().path()).collect();
    files.extend([dir.join("manifest"), dir.join("library.toml")]);
    let content = |path: PathBuf| {
        let content = fs::read(&path).unwrap();
        (path.strip_prefix(dir).unwrap().to_owned(), content)
    };
    files.into_iter().map(content).collect()
}

/// Words that differ in few bits of each part of the set.
fn clips() -> impl Strategy<Value = Vec<Vec<u64>>> {
    let word =
        vec(0..31u32, 0..3).prop_map(|bits| bits.iter().fold(0, |word, bit| word | 1 << bit));
    vec(vec(word, 0..12), 1..10)
}

proptest! {
    // Each case writes files and waits for the disk.
    #![proptest_config(ProptestConfig {
        cases: 24,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn shards_of_any_size_make_the_same_library(
        clips in clips(),
        limit in 1..30usize,
        example in any::<prop::sample::Index>(),
    ) {
        let dir = TempDir::new().unwrap();
        let (many, one) = (dir.path().join("many"), dir.path().join("one"));
        let (several, single) = (library(&many, &clips, limit), library(&one, &clips, usize::MAX));
        prop_assert_eq!(names(&several), names(&single));
        prop_assert_eq!(verify(&many).unwrap().damage, []);
        let all_but_last = several.shards().iter().rev().skip(1);
        for open in all_but_last {
            let n = open.shard.n_segments() + open.shard.n_documents();
            let last = open.shard.documents().last().unwrap().unwrap().n_segments() + 1;
            prop_assert!(n >= limit && n - last < limit, "{n} {last} {limit}");
        }
        let words = &clips[example.index(clips.len())];
        let set = &single.features.set;
        for care in ["upper", "lower", "mix"].map(|part| set.select(part).unwrap()).into_iter().chain([set.all()]) {
            let query = Query::fuzzy(words, care);
            let search = |shard: &Shard<_>| search_adaptive(shard, &query);
            let expected = found(&single, &query, care);
            prop_assert!(!expected.is_empty() || words.is_empty());
            prop_assert_eq!(found(&several, &query, care), expected);
            for library in [&several, &single] {
                let whole = library.search(search).unwrap();
                let part = library.search_adaptive(care, search).unwrap();
                prop_assert_eq!(frames(part), frames(whole));
            }
        }
        // Compacting puts the same shards on the disk as one go does, and then has nothing to do.
        let mut writer = writer(&many, usize::MAX);
        prop_assert_eq!(writer.compact().unwrap(), several.shards().len() > 1);
        prop_assert!(!writer.compact().unwrap());
        let bytes = |library: &Library| library.shards()[0].shard.as_bytes().to_vec();
        prop_assert_eq!(bytes(writer.library()), bytes(&single));
    }
}

#[test]
fn a_full_shard_is_written_and_counts_with_the_others() {
    let dir = TempDir::new().unwrap();
    let clips = vec![vec![1, 2, 3]; 5];
    library(dir.path(), &clips[..1], usize::MAX);
    let mut writer = writer(dir.path(), 8);
    push(&mut writer, &clips);
    // Two clips of three segments fill a shard; the fifth waits for more.
    let expected = ["0001.shard", "0002.shard", "0003.shard"];
    assert_eq!(shard_files(dir.path()), expected);
    assert_eq!(names(&Library::open(dir.path()).unwrap()).len(), 1);
    // Whoever dies now leaves the old library, and files that the next writer clears away.
    drop(writer);
    assert_eq!(verify(dir.path()).unwrap().damage, []);
    drop(Writer::open(dir.path()).unwrap());
    assert_eq!(shard_files(dir.path()), ["0001.shard"]);

    let mut writer = Writer::open(dir.path()).unwrap().with_segments_per_shard(8);
    push(&mut writer, &clips);
    let first = writer.library().clips().unwrap()[0].id;
    writer.commit(&BTreeSet::from([first])).unwrap();
    // The clip that was there was replaced, and its shard is gone.
    assert_eq!(
        shard_files(dir.path()),
        ["0002.shard", "0003.shard", "0004.shard"]
    );
    let library = Library::open(dir.path()).unwrap();
    assert_eq!(
        names(&library),
        ["clip 0", "clip 1", "clip 2", "clip 3", "clip 4"]
    );
    assert!(
        !writer.compact().unwrap(),
        "every shard but the last is full"
    );
}

#[test]
fn nothing_new_writes_nothing() {
    let dir = TempDir::new().unwrap();
    library(dir.path(), &[vec![1, 2]], 8);
    let before = files(dir.path());
    let mut writer = Writer::open(dir.path()).unwrap();
    writer.commit(&BTreeSet::new()).unwrap();
    assert_eq!(files(dir.path()), before);
}

/// More clips than are read at a time.
#[test]
fn batches_and_threads_do_not_show() {
    const CLIPS: usize = 300;
    let bvh = Fixture::get().files.iter().map(|file| &file.path);
    let bvh = bvh.filter(|path| path.extension().is_some_and(|e| e == "bvh"));
    let shortest = bvh.min_by_key(|path| fs::metadata(path).unwrap().len());
    let path = shortest.unwrap().display();
    let clips: Vec<PathBuf> = (0..CLIPS)
        .map(|i| format!("{path}@{}-{}", i % 20, 40 + i / 20).into())
        .collect();
    let build = |n_threads| {
        let dir = TempDir::new().unwrap();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
        let indexed = pool
            .build()
            .unwrap()
            .install(|| index(&clips, dir.path(), &ReadOptions::default()));
        assert_eq!(indexed.result.clips, CLIPS, "{:?}", indexed.skipped);
        files(dir.path())
    };
    assert!(build(1) == build(3));
}
