//! Writers that are killed, and readers beside a writer.
#![cfg(unix)]

use std::collections::BTreeSet;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Instant;

use assert_cmd::cargo::cargo_bin;
use cli::library::{Library, verify};
use cli::recording::ReadOptions;
use segidx::{Query, Shard, search_adaptive};
use tempfile::TempDir;

use crate::command::text;
use crate::corpus::{Fixture, index};
use crate::library::shard_files;
use crate::library_stream::frames;

/// Kills in all.
const ROUNDS: u64 = 200;

/// Times that the writer changes the library while others read it.
const CHANGES: usize = 12;

type Names = BTreeSet<String>;

/// A library of some of four clips.
struct Stage {
    _dir: TempDir,
    takes: PathBuf,
    library: PathBuf,
    all: Vec<String>,
}

/// A command that changes the library.
#[derive(Clone, Copy, Debug)]
enum Change {
    /// Adds what is missing.
    Index,
    /// Removes the last two clips.
    Remove,
    Compact,
}

impl Stage {
    fn new() -> Stage {
        let dir = TempDir::new().unwrap();
        let (takes, library) = (dir.path().join("takes"), dir.path().join("library"));
        fs::create_dir(&takes).unwrap();
        let files = Fixture::get().files.iter().map(|file| &file.path);
        // The shortest, so that most of the time of a writer is writing.
        let mut files: Vec<&PathBuf> = files
            .filter(|path| path.extension().is_some_and(|e| e == "bvh"))
            .collect();
        files.sort_by_key(|path| (fs::metadata(path).unwrap().len(), path.to_path_buf()));
        for (i, file) in files[..4].iter().enumerate() {
            fs::copy(file, takes.join(format!("{i}.bvh"))).unwrap();
        }
        index(
            std::slice::from_ref(&takes),
            &library,
            &ReadOptions::default(),
        );
        let all = (0..4).map(|i| takes.join(format!("{i}.bvh")).display().to_string());
        Stage {
            all: all.collect(),
            _dir: dir,
            takes,
            library,
        }
    }

    fn spawn(&self, change: Change) -> Child {
        let mut command = Command::new(cargo_bin("motif"));
        let library = text(&self.library);
        match change {
            Change::Index => command.args(["index", text(&self.takes), "-o", library]),
            Change::Remove => command
                .args(["library", "remove", library])
                .args(&self.all[2..]),
            Change::Compact => command.args(["library", "compact", library]),
        };
        let command = command.args(["--threads", "1"]);
        let command = command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        command.spawn().unwrap()
    }

    /// What `names` become; a removal of what is gone changes nothing.
    fn after(&self, change: Change, names: &Names) -> Names {
        match change {
            Change::Index => self.all.iter().cloned().collect(),
            Change::Remove if self.all[2..].iter().all(|name| names.contains(name)) => {
                self.all[..2].iter().cloned().collect()
            }
            Change::Remove | Change::Compact => names.clone(),
        }
    }

    /// The clips of a library that must be sound, each of which is found by its own words.
    fn check(&self) -> Names {
        let verified = verify(&self.library).unwrap();
        assert_eq!(verified.damage, []);
        let library = Library::open(&self.library).unwrap();
        check_searches(&library)
    }
}

fn check_searches(library: &Library) -> Names {
    let clips = library.clips().unwrap();
    for clip in &clips {
        let words = library.words(clip.id).unwrap();
        let query = Query::fuzzy(&words, u64::MAX);
        let search = |shard: &Shard<_>| search_adaptive(shard, &query);
        let hits = library.search(search).unwrap();
        assert!(
            hits.iter().any(|(id, hit)| *id == clip.id && hit.cost == 0),
            "{}",
            clip.name
        );
        assert!(
            hits.iter()
                .all(|(id, _)| clips.iter().any(|clip| clip.id == *id))
        );
        check_part(library, &words);
    }
    clips.into_iter().map(|clip| clip.name).collect()
}

/// The part has what the whole library has.
fn check_part(library: &Library, words: &[u64]) {
    let care = library.features.set.select("upper").unwrap();
    let query = Query::fuzzy(words, care);
    let search = |shard: &Shard<_>| search_adaptive(shard, &query);
    let whole = library.search(search).unwrap();
    let part = library.search_adaptive(care, search).unwrap();
    assert!(!part.is_empty());
    assert_eq!(frames(part), frames(whole));
}

fn random(state: &mut u64, below: u64) -> u64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) % below
}

#[test]
fn a_killed_writer_leaves_the_old_library_or_the_new_one() {
    let stage = Stage::new();
    let changes = [Change::Remove, Change::Index, Change::Compact];
    // About how long each change takes here, so that the kills fall all over it.
    let times = changes.map(|change| {
        let start = Instant::now();
        assert!(stage.spawn(change).wait().unwrap().success(), "{change:?}");
        start.elapsed()
    });
    let mut state = 1;
    let mut names = stage.check();
    let (mut n_killed, mut n_old, mut n_new) = (0, 0, 0);
    for round in 0..ROUNDS {
        let choice = random(&mut state, 3) as usize;
        let change = changes[choice];
        let share = random(&mut state, 1200);
        let life = times[choice].mul_f64(share as f64 / 1000.0);
        let (start, mut child) = (Instant::now(), stage.spawn(change));
        while start.elapsed() < life && child.try_wait().unwrap().is_none() {
            thread::yield_now();
        }
        // It may have ended by itself; both are well.
        let _ = child.kill();
        let killed = child.wait().unwrap().signal().is_some();
        let found = stage.check();
        let expected = stage.after(change, &names);
        assert!(
            found == names || found == expected,
            "round {round}, {change:?}: {found:?}"
        );
        n_killed += usize::from(killed);
        if expected != names {
            n_old += usize::from(found == names);
            n_new += usize::from(found == expected);
        }
        names = found;
    }
    println!("{n_killed} of {ROUNDS} writers were killed; {n_old} old libraries, {n_new} new ones");
    // The next writer clears away whatever was left.
    assert!(stage.spawn(Change::Index).wait().unwrap().success());
    assert!(stage.spawn(Change::Compact).wait().unwrap().success());
    assert_eq!(stage.check().len(), 4);
    assert_eq!(shard_files(&stage.library).len(), 1);
    assert!(!leftovers(&stage.library));
}

fn leftovers(library: &Path) -> bool {
    let mut entries = fs::read_dir(library).unwrap();
    entries.any(|entry| {
        entry
            .unwrap()
            .path()
            .extension()
            .is_some_and(|e| e == "tmp")
    })
}

#[test]
fn readers_do_not_mind_a_writer() {
    let stage = Stage::new();
    let done = AtomicBool::new(false);
    let n_reads: usize = thread::scope(|scope| {
        let readers: Vec<_> = (0..2)
            .map(|_| {
                scope.spawn(|| {
                    let mut n_reads = 0;
                    while !done.load(Ordering::Relaxed) {
                        let n_names = stage.check().len();
                        assert!(n_names == 2 || n_names == 4, "{n_names} clips");
                        n_reads += 1;
                    }
                    n_reads
                })
            })
            .collect();
        let written: Vec<bool> = (0..CHANGES)
            .flat_map(|_| [Change::Remove, Change::Index, Change::Compact])
            .map(|change| stage.spawn(change).wait().unwrap().success())
            .collect();
        done.store(true, Ordering::Relaxed);
        assert!(written.iter().all(|&ok| ok));
        readers
            .into_iter()
            .map(|reader| reader.join().unwrap())
            .sum()
    });
    println!("{n_reads} reads beside {} changes", 3 * CHANGES);
    assert!(n_reads > 0);
}
