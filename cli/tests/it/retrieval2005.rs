//! The examples of retrieval of Müller, Röder and Clausen 2005, section 6.2, on real clips: every clip
//! of a class is looked for in turn.

use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::command::{motif, text};
use crate::real::data;

/// The classes with an example in the paper, and its features there, then fewer of them.
const SQUAT: (&str, [&[&str]; 3]) = (
    "squat1Reps",
    [
        &[
            "rfoot_fast",
            "lfoot_fast",
            "rknee_bent",
            "lleg_sideways",
            "legs_crossed",
        ],
        &["rknee_bent", "lleg_sideways", "legs_crossed"],
        &["rknee_bent"],
    ],
);
const KICK: (&str, [&[&str]; 3]) = (
    "kickLFront1Reps",
    [
        &["rfoot_raised", "lfoot_raised", "rknee_bent", "lknee_bent"],
        &["lfoot_raised", "lknee_bent"],
        &["lfoot_raised"],
    ],
);

/// Ranks that a user looks at.
const TOP: usize = 10;
/// Where more of the hits than this are of the class, ranking has nothing to sort out.
const MOST: f64 = 0.5;

#[derive(Debug)]
struct Hit {
    clip: String,
    start: u64,
    end: u64,
    cost: u64,
}

impl Hit {
    fn shows(&self, class: &str) -> bool {
        Path::new(&self.clip)
            .parent()
            .is_some_and(|folder| folder.ends_with(class))
    }

    fn contains(&self, other: &Hit) -> bool {
        self.clip == other.clip && self.start <= other.start && other.end <= self.end
    }
}

/// A query by a whole clip, and its hits in order of rank.
#[derive(Debug)]
struct Answer {
    clip: String,
    n_frames: u64,
    n_segments: usize,
    hits: Vec<Hit>,
}

fn number(value: &Value) -> u64 {
    value.as_u64().unwrap()
}

impl Answer {
    fn ask(library: &Path, clip: &str, features: &[&str]) -> Answer {
        let features = features.join(",");
        let run = motif(&[
            "search",
            text(library),
            "--example",
            clip,
            "--features",
            &features,
            "--mode",
            "adaptive",
            "--top",
            "0",
            "--json",
        ]);
        let result = run.json()["result"].clone();
        let hits = result["hits"].as_array().unwrap().iter().map(|hit| Hit {
            clip: hit["clip"].as_str().unwrap().to_owned(),
            start: number(&hit["start"]),
            end: number(&hit["end"]),
            cost: number(&hit["cost"]),
        });
        Answer {
            clip: clip.to_owned(),
            n_frames: number(&result["query"]["end"]),
            n_segments: result["query"]["segments"].as_array().unwrap().len(),
            hits: hits.collect(),
        }
    }

    fn shares_of(&self, class: &str) -> (f64, f64) {
        let share = |hits: &[&Hit]| {
            let n = hits.iter().filter(|hit| hit.shows(class)).count();
            n as f64 / hits.len().max(1) as f64
        };
        let others: Vec<&Hit> = self
            .hits
            .iter()
            .filter(|hit| hit.clip != self.clip)
            .collect();
        (share(&others[..TOP.min(others.len())]), share(&others))
    }
}

/// A library of all clips, at the rate of the recordings, as the paper has it.
fn index(data: &Path, dir: &TempDir) -> std::path::PathBuf {
    let library = dir.path().join("library");
    let (hdm05, cmu) = (data.join("hdm05"), data.join("cmu"));
    let run = motif(&[
        "index",
        text(&hdm05),
        text(&cmu),
        "-o",
        text(&library),
        "--set",
        "mueller2005",
        "--rate",
        "120",
    ]);
    assert_eq!(run.code, 0, "{run:?}");
    library
}

fn clips_of(data: &Path, class: &str) -> Vec<String> {
    let folder = std::fs::read_dir(data.join("hdm05").join(class)).unwrap();
    let files = folder.map(|entry| text(&entry.unwrap().path()).to_owned());
    let mut clips: Vec<String> = files.filter(|file| file.ends_with(".amc")).collect();
    clips.sort();
    clips
}

/// A whole clip is a maximal run of its document whatever the features, so it is a hit of no cost, which
/// is the least there is.
fn finds_itself_first(answer: &Answer) {
    let whole =
        |hit: &&Hit| hit.clip == answer.clip && (hit.start, hit.end) == (0, answer.n_frames);
    let itself = answer.hits.iter().find(whole);
    assert_eq!(itself.map(|hit| hit.cost), Some(0), "{}", answer.clip);
    assert!(
        answer.hits.is_sorted_by_key(|hit| hit.cost),
        "{}",
        answer.clip
    );
}

/// The paper: "reducing the number of selected features leads to an increased number of hits". What looks
/// like the query by more features does by fewer; the first and the last segment may reach further. From
/// two segments on, where those meet fixes the rest, so no two hits become one.
fn fewer_features_find_more(more: &Answer, fewer: &Answer) {
    for hit in &more.hits {
        let is_found = fewer.hits.iter().any(|wider| wider.contains(hit));
        assert!(is_found, "{}: {hit:?}", more.clip);
    }
    assert!(fewer.n_segments >= 2);
    assert!(more.hits.len() <= fewer.hits.len(), "{}", more.clip);
}

/// Whoever does one squat bends the right knee once, whoever does one kick raises that foot once: by this
/// feature alone, which goes off, on, off, every query finds every clip of the class.
fn finds_the_whole_class(answer: &Answer, class: &str, clips: &[String]) {
    for clip in clips {
        let is_found = answer.hits.iter().any(|hit| hit.clip == *clip);
        assert!(is_found, "{class}: {} does not find {clip}", answer.clip);
    }
}

#[test]
fn real_squats_and_kicks_are_found_and_ranked_by_duration() {
    let Some(data) = data() else { return };
    let dir = TempDir::new().unwrap();
    let library = index(&data, &dir);
    for (class, selections) in [SQUAT, KICK] {
        let clips = clips_of(&data, class);
        assert!(clips.len() > TOP);
        let asked = selections.map(|features| {
            let answers = clips
                .iter()
                .map(|clip| Answer::ask(&library, clip, features));
            answers.collect::<Vec<Answer>>()
        });
        asked.iter().flatten().for_each(finds_itself_first);
        for pair in asked.windows(2) {
            for (more, fewer) in pair[0].iter().zip(&pair[1]) {
                fewer_features_find_more(more, fewer);
            }
        }
        for answer in &asked[2] {
            assert_eq!(answer.n_segments, 3, "{}", answer.clip);
            finds_the_whole_class(answer, class, &clips);
        }
        for (features, answers) in selections.iter().zip(&asked) {
            let shares: Vec<(f64, f64)> = answers.iter().map(|a| a.shares_of(class)).collect();
            let n = shares.len() as f64;
            let top = shares.iter().map(|(top, _)| top).sum::<f64>() / n;
            let all = shares.iter().map(|(_, all)| all).sum::<f64>() / n;
            println!("{class} by {features:?}: {top:.2} of the top {TOP}, {all:.2} of all hits");
            // Clips that are cut to one squat last about as long as each other; what else bends a knee
            // does so for longer or shorter.
            assert!(
                top > all || all > MOST,
                "{class} by {features:?}: {top} of the top, {all} of all"
            );
        }
    }
}
