//! Exact queries, which are phrases of words to a search engine for text.
//!
//! A document is a clip, a term the feature word of a segment. Both sides have one index on disk, mapped
//! by the peer and read by ours, searched before by the same queries. Ours gives whole hits, with
//! document, cost and the frames of each segment. The peer counts the documents of a phrase, which is less, or finds
//! every place of it (`tantivy:hits`), of which only the number of the document and the position are
//! known then. Ours stores the duration of each segment too, the peer only where the size on disk is
//! stated a second time (`tantivy:frames`).

use std::fs;
use std::path::{Path, PathBuf};
use std::process;

use anyhow::{Context, Result, anyhow};

use super::install::{self, Package};
use super::{Amount, Contestant, Job, Role, Toolbox};
use crate::workspace::{DATA, Workspace, capture, text};

mod data;

use data::{Queries, Words};

const CRATES: [Package; 1] = [Package {
    name: "tantivy",
    version: "0.27.0",
}];

/// Inner runs of one process.
const RUNS: u32 = 7;

const HITS: &[&str] = &["hits", "places"];
const DOCUMENTS: &[&str] = &["documents"];

/// Names of a job's lines: that of the job, and that against the peer that finds every place.
type Names = (&'static str, &'static [(&'static str, &'static str)]);
const EVERY_PLACE: &str = "tantivy:hits";

struct Programs {
    ours: Toolbox,
    rust: Toolbox,
}

/// Documents and what both sides made of them.
struct Indexed {
    words: Words,
    shard: PathBuf,
    folder: PathBuf,
}

/// Makes the data, builds ours, installs the peer, indexes; prints what the indexes take on disk.
pub(super) fn jobs(workspace: &Workspace, scratch: &Path) -> Result<Vec<Job>> {
    let programs = Programs {
        ours: install::ours(workspace, "retrieval_peer", "segidx")?,
        rust: install::rust(
            workspace,
            &scratch.join("rust"),
            include_str!("retrieval/drivers/main.rs"),
            &CRATES,
            &[],
        ),
    };
    let folder = scratch.join("data");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let plain = folder.join("repeated.u64");
    programs.write_documents(&plain)?;
    let repeated = Words::read(&plain)?;
    let various = repeated.turned();
    various.write(&folder.join("exact.u64"))?;

    let mut indexed = vec![
        (programs.index("exact", various, &folder)?, NAMES_OF_VARIOUS),
        (
            programs.index("repeated", repeated, &folder)?,
            NAMES_OF_REPEATED,
        ),
    ];
    if let Some(recordings) = workspace.recordings() {
        let real = folder.join("real.u64");
        programs.write_recordings(&real, &recordings)?;
        let real = programs.index("real", Words::read(&real)?, &folder)?;
        indexed.push((real, NAMES_OF_REAL));
    } else {
        println!("no jobs on real words: {DATA} is not set");
    }
    let mut jobs = Vec::new();
    for (indexed, names) in &indexed {
        for &(n_segments, names) in names {
            let queries = indexed.words.queries(n_segments);
            let path = folder.join(format!("{}.u64", names.0));
            queries.write(&path)?;
            jobs.push(programs.job(names, indexed, &queries, &path));
        }
    }
    Ok(jobs)
}

const NAMES_OF_VARIOUS: [(usize, Names); 2] = [
    (5, ("exact5", &[("exact5-hits", EVERY_PLACE)])),
    (10, ("exact10", &[("exact10-hits", EVERY_PLACE)])),
];
const NAMES_OF_REPEATED: [(usize, Names); 2] = [
    (5, ("repeated5", &[("repeated5-hits", EVERY_PLACE)])),
    (10, ("repeated10", &[("repeated10-hits", EVERY_PLACE)])),
];

const NAMES_OF_REAL: [(usize, Names); 2] = [
    (5, ("real5", &[("real5-hits", EVERY_PLACE)])),
    (10, ("real10", &[("real10-hits", EVERY_PLACE)])),
];
/// Words per second of recordings: the rate of most of them, at which the 2005 paper indexes.
const REAL_RATE: u32 = 120;

impl Programs {
    fn write_recordings(&self, file: &Path, folder: &Path) -> Result<()> {
        let files = [file, folder];
        let writer = self
            .ours
            .contestant(Role::Ours, "motif:recordings", REAL_RATE, &files, &[]);
        stated_by(&writer).map(|_| ())
    }

    fn write_documents(&self, file: &Path) -> Result<()> {
        let n = data::DOCUMENTS as u32;
        let writer = self
            .ours
            .contestant(Role::Ours, "motif:documents", n, &[file], &[]);
        stated_by(&writer).map(|_| ())
    }

    /// Both indexes, and the line about their sizes.
    fn index(&self, name: &str, words: Words, folder: &Path) -> Result<Indexed> {
        let documents = folder.join(format!("{name}.u64"));
        let indexed = Indexed {
            words,
            shard: folder.join(format!("{name}.shard")),
            folder: folder.join(format!("{name}.tantivy")),
        };
        let build = |toolbox: &Toolbox, name, to: &Path| {
            let arguments = [documents.as_path(), to];
            let builder = toolbox.contestant(Role::Ours, name, 0, &arguments, &[]);
            bytes_of(&stated_by(&builder)?)
        };
        let ours = build(&self.ours, "motif:build", &indexed.shard)?;
        let with_frames = indexed.folder.with_extension("frames");
        for (peer, build_peer, folder) in [
            ("tantivy", "tantivy:build", &indexed.folder),
            ("tantivy:frames", "tantivy:build-frames", &with_frames),
        ] {
            match build(&self.rust, build_peer, folder) {
                Ok(bytes) => println!(
                    "disk {name} ours={ours} {peer}={bytes} ratio={:.2}",
                    bytes / ours
                ),
                Err(error) => println!("disk {name} ours={ours} {peer}=- ratio=-  {error:#}"),
            }
        }
        Ok(indexed)
    }

    fn job(&self, (name, duels): Names, indexed: &Indexed, queries: &Queries, path: &Path) -> Job {
        let (ours, peer) = ([&indexed.shard, path], [&indexed.folder, path]);
        Job {
            name,
            amount: Amount {
                millions: (queries.len() * indexed.words.n_segments()) as f64 / 1e6,
                unit: "Msegments",
            },
            facts: queries.facts(&indexed.words),
            contestants: vec![
                self.ours.contestant(Role::Ours, "motif", RUNS, &ours, HITS),
                self.rust
                    .contestant(Role::Peer, "tantivy", RUNS, &peer, DOCUMENTS),
                self.rust
                    .contestant(Role::Peer, EVERY_PLACE, RUNS, &peer, HITS),
            ],
            duels,
        }
    }
}

/// What a program prints that is run once, before the contest.
fn stated_by(program: &Contestant) -> Result<String> {
    let line = program
        .command
        .as_ref()
        .map_err(|reason| anyhow!("{reason}"))?;
    let (program, arguments) = line.split_first().context("no program")?;
    let output = capture(process::Command::new(program).args(arguments))?;
    if !output.status.success() {
        return Err(anyhow!("failed: {}", text(&output.stderr).trim()));
    }
    Ok(text(&output.stdout))
}

fn bytes_of(stated: &str) -> Result<f64> {
    let bytes = stated.trim().strip_prefix("bytes=");
    let bytes = bytes.with_context(|| format!("no bytes in `{stated}`"))?;
    Ok(bytes.parse()?)
}
