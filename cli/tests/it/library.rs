//! Libraries of several shards: they grow, follow their files, and give the answers of one shard.

use std::fs;
use std::path::{Path, PathBuf};

use cli::commands::library::{compact, remove};
use cli::corpus::Class;
use cli::library::{Library, Writer, verify};
use cli::recording::ReadOptions;
use serde_json::Value;
use tempfile::TempDir;

use crate::command::{motif, text};
use crate::corpus::{Fixture, index};

/// The shards of all features. Each has its parts beside it, and nothing else is there.
pub(crate) fn shard_files(library: &Path) -> Vec<String> {
    let entries = fs::read_dir(library.join("shards")).unwrap();
    let names = entries.map(|e| e.unwrap().file_name().into_string().unwrap());
    let (mut parts, mut shards): (Vec<_>, Vec<_>) = names.partition(|name| name.contains('-'));
    parts.sort();
    shards.sort();
    let of_shard = |shard: &String| {
        let number = shard.strip_suffix(".shard").unwrap().to_owned();
        ["lower", "mix", "upper"].map(|part| format!("{number}-{part}.shard"))
    };
    let expected: Vec<String> = shards.iter().flat_map(of_shard).collect();
    assert_eq!(parts, expected);
    shards
}

fn names(library: &Path) -> Vec<String> {
    let clips = Library::open(library).unwrap().clips().unwrap();
    clips.into_iter().map(|clip| clip.name).collect()
}

/// Copies of some clips of the corpus, with the skeletons beside them.
pub(crate) fn takes(dir: &Path, performer: &str, n: usize) -> PathBuf {
    let from = Fixture::get().corpus().join(performer);
    let to = dir.join(performer);
    fs::create_dir_all(&to).unwrap();
    let mut files: Vec<PathBuf> = fs::read_dir(from)
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    files.sort();
    let (skeletons, clips): (Vec<_>, Vec<_>) = files
        .into_iter()
        .partition(|f| f.extension().is_some_and(|e| e == "asf"));
    for file in skeletons.iter().chain(clips.iter().take(n)) {
        fs::copy(file, to.join(file.file_name().unwrap())).unwrap();
    }
    to
}

fn sync(paths: &[&Path], library: &Path) -> Value {
    let mut args = vec!["index"];
    args.extend(paths.iter().map(|path| text(path)));
    args.extend(["-o", text(library), "--sync", "--json"]);
    let run = motif(&args);
    assert_eq!(run.code, 0, "{run:?}");
    run.json()["result"].clone()
}

pub(crate) fn counts(result: &Value) -> [u64; 5] {
    let keys = ["clips", "replaced", "unchanged", "forgotten"];
    let [a, b, c, d] = keys.map(|key| result[key].as_u64().unwrap());
    [a, b, c, d, result["total"]["clips"].as_u64().unwrap()]
}

#[test]
fn a_library_grows_by_shards_and_compacts_to_one() {
    let fixture = Fixture::get();
    let dir = TempDir::new().unwrap();
    let library = dir.path().join("library");
    let add = |folder: &str, options: &ReadOptions| {
        let folder = fixture.corpus().join(folder);
        index(&[folder], &library, options).result
    };
    let plain = ReadOptions::default();
    let first = add("anna", &plain);
    assert_eq!(
        (first.clips, first.replaced, first.total.clips),
        (47, 0, 47)
    );
    let second = add("eva", &plain);
    assert_eq!(
        (second.clips, second.replaced, second.total.clips),
        (46, 0, 93)
    );
    assert_eq!(shard_files(&library), ["0001.shard", "0002.shard"]);
    let again = add("anna", &plain);
    assert_eq!(
        (again.clips, again.unchanged, again.total.clips),
        (0, 47, 93)
    );
    assert_eq!(
        shard_files(&library).len(),
        2,
        "nothing is written for nothing"
    );
    // Read in another way, the clips are others: the first shard is left without any and goes.
    let filled = ReadOptions {
        fill: Some(1.0),
        ..ReadOptions::default()
    };
    let other = add("anna", &filled);
    assert_eq!(
        (other.clips, other.replaced, other.total.clips),
        (47, 47, 93)
    );
    assert_eq!(other.total.words, second.total.words);
    assert_eq!(shard_files(&library), ["0002.shard", "0003.shard"]);
    let removed = fixture.clip("eva", Class::Squat);
    remove(&library, &[removed]).unwrap();
    assert_eq!(shard_files(&library), ["0002.shard", "0003.shard"]);
    let before = names(&library);
    let reader = Library::open(&library).unwrap();
    let result = compact(&library).unwrap();
    assert_eq!((result.shards_before, result.shards), (2, 1));
    assert!(result.bytes < result.bytes_before);
    assert_eq!(shard_files(&library), ["0004.shard"]);
    assert_eq!(names(&library), before);
    assert_eq!(verify(&library).unwrap().damage, []);
    // Whoever had the library open goes on with what was there.
    for clip in reader.clips().unwrap() {
        assert_eq!(reader.words(clip.id).unwrap().len(), clip.n_words);
    }
    let nothing = compact(&library).unwrap();
    assert_eq!((nothing.shards_before, nothing.shards), (1, 1));
    assert_eq!(shard_files(&library), ["0004.shard"]);
}

#[test]
fn several_shards_give_the_answers_of_one() {
    let fixture = Fixture::get();
    let dir = TempDir::new().unwrap();
    let (several, one) = (dir.path().join("several"), dir.path().join("one"));
    let folders = ["anna", "ben", "eva"].map(|name| fixture.corpus().join(name));
    for folder in &folders {
        index(
            std::slice::from_ref(folder),
            &several,
            &ReadOptions::default(),
        );
    }
    index(&folders, &one, &ReadOptions::default());
    let gone = fixture.clip("ben", Class::KickRight);
    for library in [&several, &one] {
        remove(library, std::slice::from_ref(&gone)).unwrap();
    }
    assert_eq!(shard_files(&several).len(), 3);
    let mut n_hits = 0;
    for class in Class::ALL {
        for mode in ["exact", "adaptive"] {
            let example = fixture.clip("ben", class);
            let run = |library: &Path| {
                motif(&[
                    "search",
                    text(library),
                    "--example",
                    text(&example),
                    "--features",
                    "F20",
                    "F21",
                    "--mode",
                    mode,
                    "--top",
                    "0",
                    "--json",
                ])
            };
            let (found, expected) = (run(&several), run(&one));
            assert_eq!(found.stdout, expected.stdout, "{class} {mode}");
            assert!(
                !found
                    .stdout
                    .contains(&format!("\"clip\":\"{}\"", gone.display()))
                    || example == gone
            );
            n_hits += found.json()["result"]["n_hits"].as_u64().unwrap();
        }
    }
    assert!(
        n_hits > 300,
        "only {n_hits} hits in all: the test says nothing"
    );
}

#[test]
fn sync_follows_the_files() {
    let dir = TempDir::new().unwrap();
    let library = dir.path().join("library");
    let anna = takes(dir.path(), "anna", 4);
    let eva = takes(dir.path(), "eva", 3);
    assert_eq!(counts(&sync(&[&anna, &eva], &library)), [7, 0, 0, 0, 7]);
    assert_eq!(counts(&sync(&[&anna, &eva], &library)), [0, 0, 7, 0, 7]);

    // A changed clip, a clip that is gone, a new one.
    let mut files: Vec<PathBuf> = fs::read_dir(&eva)
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    files.sort();
    fs::copy(&files[1], &files[0]).unwrap();
    fs::rename(&files[2], eva.join("new.bvh")).unwrap();
    assert_eq!(
        counts(&sync(&[&anna], &library)),
        [0, 0, 4, 0, 7],
        "eva is not asked about"
    );
    assert_eq!(counts(&sync(&[&eva], &library)), [2, 1, 1, 1, 7]);

    // A changed skeleton changes all its clips.
    let skeleton = anna.join("anna.asf");
    let longer = fs::read_to_string(&skeleton).unwrap() + "# a comment\n";
    fs::write(&skeleton, longer).unwrap();
    assert_eq!(counts(&sync(&[&anna], &library)), [4, 4, 0, 0, 7]);

    // A file and a folder that are given and gone.
    fs::remove_file(eva.join("new.bvh")).unwrap();
    assert_eq!(
        counts(&sync(&[&eva.join("new.bvh")], &library)),
        [0, 0, 0, 1, 6]
    );
    fs::remove_dir_all(&anna).unwrap();
    assert_eq!(counts(&sync(&[&anna, &eva], &library)), [0, 0, 2, 4, 2]);
    let nowhere = dir.path().join("nowhere");
    assert_eq!(
        motif(&["index", text(&nowhere), "-o", text(&library), "--sync"]).code,
        4
    );
    let clips = names(&library);
    assert!(
        clips.iter().all(|clip| Path::new(clip).starts_with(&eva)),
        "{clips:?}"
    );
    assert_eq!(verify(&library).unwrap().damage, []);
}

#[test]
fn without_sync_nothing_is_forgotten() {
    let dir = TempDir::new().unwrap();
    let library = dir.path().join("library");
    let eva = takes(dir.path(), "eva", 2);
    index(
        std::slice::from_ref(&eva),
        &library,
        &ReadOptions::default(),
    );
    let files: Vec<PathBuf> = fs::read_dir(&eva)
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    fs::remove_file(&files[0]).unwrap();
    let result = index(&[eva], &library, &ReadOptions::default()).result;
    assert_eq!((result.unchanged, result.total.clips), (1, 2));
}

#[test]
fn the_library_command_speaks_text_and_json() {
    let dir = TempDir::new().unwrap();
    let library = dir.path().join("library");
    let eva = takes(dir.path(), "eva", 3);
    index(
        std::slice::from_ref(&eva),
        &library,
        &ReadOptions::default(),
    );
    let lib = text(&library);
    let info = motif(&["library", "info", lib, "--json"]).json();
    assert_eq!(info["command"], "library info");
    assert_eq!(info["result"]["total"]["clips"], 3);
    let shard = &info["result"]["shards"][0];
    assert_eq!(shard["file"], "0001.shard");
    let files = fs::read_dir(library.join("shards")).unwrap();
    let bytes: u64 = files.map(|e| e.unwrap().metadata().unwrap().len()).sum();
    assert_eq!(info["result"]["bytes"], bytes);
    let segments = |json: &Value| json["segments"].as_u64().unwrap();
    for part in shard["parts"].as_array().unwrap() {
        assert!(segments(part) < segments(shard), "{shard}");
    }
    let run = motif(&["library", "info", lib]);
    for word in ["mueller2006", "0001-upper.shard"] {
        assert!(run.stdout.contains(word), "{run:?}");
    }
    let run = motif(&["library", "verify", lib]);
    assert!(run.code == 0 && run.stdout.contains("no damage"), "{run:?}");

    let clip = names(&library)[1].clone();
    let run = motif(&["library", "remove", lib, &clip, "--json"]);
    assert_eq!(run.json()["result"]["removed"], 1, "{run:?}");
    assert!(!names(&library).contains(&clip));
    let run = motif(&["library", "remove", lib, &clip]);
    assert!(run.code == 2 && run.stderr.contains(&clip), "{run:?}");
    let run = motif(&["library", "compact", lib]);
    assert!(
        run.code == 0 && run.stdout.contains("2 clips in 1 shard"),
        "{run:?}"
    );
    // A folder stands for its clips; a library may be empty.
    let run = motif(&["library", "remove", lib, text(&eva)]);
    assert!(
        run.code == 0 && run.stdout.contains("2 clips removed"),
        "{run:?}"
    );
    assert_eq!(shard_files(&library), [""; 0]);
    assert_eq!(motif(&["library", "verify", lib]).code, 0);
    assert_eq!(
        index(&[eva], &library, &ReadOptions::default())
            .result
            .total
            .clips,
        3
    );

    let shard = library.join("shards").join(&shard_files(&library)[0]);
    let mut bytes = fs::read(&shard).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&shard, bytes).unwrap();
    let run = motif(&["library", "verify", lib, "--json"]);
    assert_eq!(run.code, 3, "{run:?}");
    assert_eq!(run.json()["result"]["damage"][0]["path"], text(&shard));
    assert_eq!(motif(&["library", "info", "no/such/library"]).code, 4);
    assert_eq!(motif(&["library", "compact", text(dir.path())]).code, 4);
}

#[test]
fn two_writers_exclude_each_other() {
    let dir = TempDir::new().unwrap();
    let library = dir.path().join("library");
    let eva = takes(dir.path(), "eva", 2);
    index(
        std::slice::from_ref(&eva),
        &library,
        &ReadOptions::default(),
    );
    let writer = Writer::open(&library).unwrap();
    for args in [
        &["index", text(&eva), "-o", text(&library)][..],
        &["library", "compact", text(&library)],
    ] {
        let run = motif(args);
        assert_eq!(run.code, 4, "{run:?}");
        assert!(run.stderr.contains("locked"), "{run:?}");
    }
    assert_eq!(
        motif(&["library", "verify", text(&library)]).code,
        0,
        "readers do not mind"
    );
    drop(writer);
    assert_eq!(motif(&["library", "compact", text(&library)]).code, 0);
}

#[test]
fn what_a_killed_writer_leaves_is_ignored_and_cleared_away() {
    let dir = TempDir::new().unwrap();
    let library = dir.path().join("library");
    let eva = takes(dir.path(), "eva", 2);
    index(
        std::slice::from_ref(&eva),
        &library,
        &ReadOptions::default(),
    );
    let left = [
        "shards/0002.shard",
        "shards/0002-upper.shard",
        "shards/0003.shard.tmp",
        "manifest.tmp",
        "library.toml.tmp",
    ];
    for file in left {
        fs::write(library.join(file), "half of someth").unwrap();
    }
    assert_eq!(names(&library).len(), 2);
    assert_eq!(verify(&library).unwrap().damage, []);
    drop(Writer::open(&library).unwrap());
    for file in left {
        assert!(!library.join(file).exists(), "{file}");
    }
    assert_eq!(shard_files(&library), ["0001.shard"]);
}
