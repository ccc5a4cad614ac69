//! The measuring side of `cargo xtask scale`: `scale TIMES DIR DATA` indexes TIMES the words of the folders
//! `hdm05` and `cmu` in DATA into libraries in DIR, and asks them. Each library is built and asked in processes
//! of its own, so that memory and caches are theirs alone.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};
use std::{env, fs};

use anyhow::{Context, Result, bail, ensure};
use benches::scale::fit::{exponent, median};
use benches::scale::{self, Answer, Originals, PART, POSITIONS, Question};
use cli::args::SetArgs;
use cli::commands::index;
use cli::library::{Library, SEGMENTS_PER_SHARD};
use cli::output::Voice;
use cli::recording::ReadOptions;

const SET: &str = "mueller2005";
const RATE: f64 = 30.0;

/// The sizes, as divisors of the full one.
const SERIES: [u32; 5] = [16, 8, 4, 2, 1];

const QUESTIONS: usize = 1_000;

/// Opened and asked by new processes, which takes longer than the answers.
const PROCESSES: usize = 20;

/// Runs of the questions of those processes.
const PROCESS_POSITIONS: usize = 10;

/// Least hits of the groups of the report.
const GROUPS: [usize; 5] = [1, 10, 100, 1_000, 10_000];

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["build", times, dir, originals] => build(times.parse()?, dir.as_ref(), originals.as_ref()),
        ["ask", times, dir, originals] => ask(times.parse()?, dir.as_ref(), originals.as_ref()),
        ["probe", dir, ref words @ ..] => probe(dir.as_ref(), words),
        [times, dir, data] => run(times.parse()?, dir.as_ref(), data.as_ref()),
        _ => bail!("TIMES DIR DATA expected"),
    }
}

fn run(times: u32, dir: &Path, data: &Path) -> Result<()> {
    fs::create_dir_all(dir)?;
    let originals = dir.join("originals");
    index_originals(data, &originals)?;
    let mut sizes: Vec<u32> = SERIES.iter().map(|part| times.div_ceil(*part)).collect();
    sizes.dedup();
    let (mut builds, mut rounds) = (Vec::new(), Vec::new());
    for &size in &sizes {
        let library = dir.join(size.to_string());
        let arguments = [size.to_string().into(), library.clone(), originals.clone()];
        let built = facts(&child("build", &arguments)?)?;
        print_built(size, &built);
        // The questions come from the smallest library: every size holds its clips.
        let arguments = [
            sizes[0].to_string().into(),
            library.clone(),
            originals.clone(),
        ];
        let asked = child("ask", &arguments)?;
        let (head, answers) = asked.split_once('\n').context("no answers")?;
        println!("  {head}");
        let answers: Vec<Measured> = answers
            .lines()
            .map(Measured::parse)
            .collect::<Result<_>>()?;
        print_groups(&answers);
        builds.push((number(&built, "frames")?, number(&built, "build_s")?));
        rounds.push((number(&built, "frames")?, answers));
        if size != times {
            fs::remove_dir_all(&library)?;
        }
    }
    print_fits(&builds, &rounds);
    Ok(())
}

/// The library that copies are made of.
fn index_originals(data: &Path, library: &Path) -> Result<()> {
    let what = index::What {
        set: &SetArgs {
            set: Some(SET.to_owned()),
            rate: Some(RATE),
        },
        sync: false,
    };
    let folders = ["hdm05", "cmu"].map(|folder| data.join(folder));
    let options = ReadOptions::default();
    let indexed = index::index(&folders, library, &what, &options, Voice::default())?;
    let total = indexed.result.total;
    ensure!(total.words > 0, "no clips in {}", data.display());
    println!(
        "originals: {} clips, {} words, {} segments; {SET} at {RATE} words per second",
        total.clips, total.words, total.segments
    );
    Ok(())
}

/// What this program prints in another process.
fn child(task: &str, arguments: &[PathBuf]) -> Result<String> {
    let output = Command::new(env::current_exe()?)
        .arg(task)
        .args(arguments)
        .output()?;
    let error = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{task}: {}", error.trim());
    Ok(String::from_utf8(output.stdout)?)
}

fn build(times: u32, dir: &Path, originals: &Path) -> Result<()> {
    let originals = Originals::open(originals)?;
    let built = scale::build(&originals, times, dir, SEGMENTS_PER_SHARD)?;
    let peak = peak_memory();
    let library = Library::open(dir)?;
    let shards = library.shards();
    let sum = |of: fn(&cli::library::OpenShard) -> u64| shards.iter().map(of).sum::<u64>();
    let segments = sum(|open| open.shard.n_segments() as u64);
    let bytes = sum(|open| open.entry.len);
    let part_bytes = sum(|open| open.parts.iter().map(|part| part.entry.len).sum());
    let all_bytes = bytes + part_bytes;
    let most = |of: fn(&cli::library::OpenShard) -> usize| shards.iter().map(of).max();
    let words = most(|open| open.shard.n_lists()).unwrap_or(0);
    let of_part = most(|open| {
        let words = open.parts.iter().map(|part| part.shard.n_lists());
        words.max().unwrap_or(0)
    });
    println!(
        "frames={} clips={} segments={segments} shards={} bytes={all_bytes} part_bytes={part_bytes} \
         bytes_per_segment={:.2} words={words} part_words={} build_s={:.2} peak_mb={}",
        built.n_frames,
        built.n_clips,
        shards.len(),
        all_bytes as f64 / segments as f64,
        of_part.unwrap_or(0),
        built.time.as_secs_f64(),
        peak.map_or("unknown".to_owned(), |mb| format!("{mb:.0}")),
    );
    Ok(())
}

fn ask(times: u32, dir: &Path, originals: &Path) -> Result<()> {
    let opening = Instant::now();
    let library = Library::open(dir)?;
    let first_ms = milliseconds(opening.elapsed());
    let mut opens = Vec::new();
    for _ in 0..PROCESSES {
        let start = Instant::now();
        drop(Library::open(dir)?);
        opens.push(milliseconds(start.elapsed()));
    }
    let care = library.features.set.select(PART).context("no such part")?;
    drop(library);
    let questions = scale::questions(&Originals::open(originals)?, times, QUESTIONS, care);
    let answers = scale::ask(dir, &questions, care)?;
    let peak = peak_memory();
    let of_process = processes(dir, &questions)?;
    println!(
        "open_ms={:.2} first_open_ms={first_ms:.2} process_ms={:.2} process_max_ms={:.2} questions={} peak_mb={}",
        median(&opens),
        median(&of_process),
        of_process.iter().fold(0.0, |most: f64, &ms| most.max(ms)),
        answers.len(),
        peak.map_or("unknown".to_owned(), |mb| format!("{mb:.0}")),
    );
    for answer in answers {
        println!("{}", Measured::new(&answer).line());
    }
    Ok(())
}

/// Milliseconds of whole processes that open the library and ask one question each.
fn processes(dir: &Path, questions: &[Question]) -> Result<Vec<f64>> {
    let questions = questions
        .iter()
        .filter(|q| q.n_positions == PROCESS_POSITIONS);
    let of_one = |question: &Question| {
        let words = question.words.iter().map(|word| format!("{word:x}"));
        let mut command = Command::new(env::current_exe()?);
        command.arg("probe").arg(dir).args(words);
        let start = Instant::now();
        ensure!(command.output()?.status.success(), "a process failed");
        Ok(milliseconds(start.elapsed()))
    };
    questions.take(PROCESSES).map(of_one).collect()
}

fn probe(dir: &Path, words: &[&str]) -> Result<()> {
    let words = words.iter().map(|word| u64::from_str_radix(word, 16));
    let question = Question {
        words: words.collect::<Result<_, _>>()?,
        n_positions: PROCESS_POSITIONS,
    };
    let library = Library::open(dir)?;
    let care = library.features.set.select(PART).context("no such part")?;
    println!("{}", scale::hits(&library, &question, care)?);
    Ok(())
}

/// An [`Answer`] as one process tells it to another.
#[derive(Clone, Copy, Debug)]
struct Measured {
    n_positions: usize,
    n_hits: usize,
    n_postings: u64,
    cold_ms: f64,
    warm_ms: f64,
}

impl Measured {
    fn new(answer: &Answer) -> Measured {
        Measured {
            n_positions: answer.n_positions,
            n_hits: answer.n_hits,
            n_postings: answer.n_postings,
            cold_ms: milliseconds(answer.cold),
            warm_ms: milliseconds(answer.warm),
        }
    }

    fn line(&self) -> String {
        format!(
            "{} {} {} {} {}",
            self.n_positions, self.n_hits, self.n_postings, self.cold_ms, self.warm_ms
        )
    }

    fn parse(line: &str) -> Result<Measured> {
        let numbers: Vec<&str> = line.split(' ').collect();
        let [positions, hits, postings, cold, warm] = numbers[..] else {
            bail!("five numbers expected, found {line:?}");
        };
        Ok(Measured {
            n_positions: positions.parse()?,
            n_hits: hits.parse()?,
            n_postings: postings.parse()?,
            cold_ms: cold.parse()?,
            warm_ms: warm.parse()?,
        })
    }
}

fn print_built(size: u32, built: &BTreeMap<String, String>) {
    println!("times={size}");
    let facts: Vec<String> = built
        .iter()
        .map(|(key, value)| format!("{key}={value}"))
        .collect();
    println!("  {}", facts.join(" "));
}

fn print_groups(answers: &[Measured]) {
    println!("  |Q|         hits  queries  postings  cold ms (max)    warm ms (max)");
    for n_positions in POSITIONS {
        for (i, &least) in GROUPS.iter().enumerate() {
            let end = GROUPS.get(i + 1).copied().unwrap_or(usize::MAX);
            let group: Vec<&Measured> = answers
                .iter()
                .filter(|a| a.n_positions == n_positions && (least..end).contains(&a.n_hits))
                .collect();
            if group.is_empty() {
                continue;
            }
            let of = |value: fn(&Measured) -> f64| -> (f64, f64) {
                let values: Vec<f64> = group.iter().map(|a| value(a)).collect();
                (median(&values), values.iter().fold(0.0, |a, &b| a.max(b)))
            };
            let (cold, warm) = (of(|a| a.cold_ms), of(|a| a.warm_ms));
            println!(
                "  {n_positions:>3} {:>12} {:>8} {:>9} {:>8.2} ({:>6.2}) {:>8.2} ({:>6.2})",
                match end {
                    usize::MAX => format!("{least}-"),
                    end => format!("{least}-{}", end - 1),
                },
                group.len(),
                of(|a| a.n_postings as f64).0,
                cold.0,
                cold.1,
                warm.0,
                warm.1
            );
        }
    }
}

/// How time grows. One query's time is set against what it has to look at; the queries' mean time and mean
/// time per hit against the size of the library, which all sizes answer the same queries for.
fn print_fits(builds: &[(f64, f64)], rounds: &[(f64, Vec<Measured>)]) {
    let show = |what: &str, points: &[(f64, f64)]| match exponent(points) {
        Some(b) => println!("exponent={b:.2} {what}"),
        None => println!("exponent=unknown {what}: too few sizes"),
    };
    show("build seconds over frames", builds);
    let over_size = |value: fn(&[Measured]) -> f64| -> Vec<(f64, f64)> {
        rounds
            .iter()
            .map(|(frames, answers)| (*frames, value(answers)))
            .collect()
    };
    let warm = |answers: &[Measured]| answers.iter().map(|a| a.warm_ms).sum::<f64>();
    let hits = |answers: &[Measured]| answers.iter().map(|a| a.n_hits as f64).sum::<f64>();
    show(
        "warm milliseconds of all queries over frames",
        &over_size(warm),
    );
    show("hits of all queries over frames", &over_size(hits));
    let per_hit = |answers: &[Measured]| {
        let ms = answers.iter().map(|a| a.warm_ms).sum::<f64>();
        ms / answers.iter().map(|a| a.n_hits as f64).sum::<f64>()
    };
    show("warm milliseconds per hit over frames", &over_size(per_hit));
    let all = rounds.iter().flat_map(|(_, answers)| answers);
    let points: Vec<(f64, f64)> = all
        .map(|a| (a.n_hits as f64 + a.n_postings as f64, a.warm_ms))
        .collect();
    show(
        "warm milliseconds of a query over its hits and postings",
        &points,
    );
}

fn facts(line: &str) -> Result<BTreeMap<String, String>> {
    let facts = line.split_whitespace().map(|fact| {
        let (key, value) = fact.split_once('=').context("key=value expected")?;
        Ok((key.to_owned(), value.to_owned()))
    });
    facts.collect()
}

fn number(facts: &BTreeMap<String, String>, key: &str) -> Result<f64> {
    let value = facts.get(key).with_context(|| format!("no {key}"))?;
    Ok(value.parse()?)
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Megabytes of memory this process ever had; only Linux says.
fn peak_memory() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
    Some(kilobytes / 1e3)
}
