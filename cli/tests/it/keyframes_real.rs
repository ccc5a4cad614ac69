//! Keyframes of templates learned from real recordings, with the authors' split.

use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use cli::recording::ReadOptions;
use cli::source::ClipRef;
use cli::wire::{clip_words, keyframe_query};
use mtemplate::{
    AutomaticConfig, ExampleConfig, Examples, Keyframe, LearnConfig, MatchConfig, MotionTemplate,
    Preselection, QuantizedTemplate, choose_keyframes, learn, learn_keyframes,
};
use rayon::prelude::*;
use relfeat::FeatureSet;
use segidx::{Index, IndexBuilder, KeyframeQuery, search_keyframes};

use crate::real::data;

struct Clip {
    class: String,
    words: Vec<u64>,
    trains: bool,
}

fn clips(dir: &Path, set: &FeatureSet) -> Vec<Clip> {
    let mut classes: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for folder in fs::read_dir(dir).unwrap() {
        let folder = folder.unwrap().path();
        let name = folder.file_name().unwrap().to_str().unwrap().to_owned();
        let files = fs::read_dir(&folder)
            .unwrap()
            .map(|file| file.unwrap().path());
        let mut files: Vec<PathBuf> = files
            .filter(|f| f.extension().is_some_and(|e| e == "amc"))
            .collect();
        files.sort();
        classes.insert(name, files);
    }
    let mut listed = Vec::new();
    for (class, files) in classes {
        let n = files.len();
        let m = n.div_ceil(2).clamp(2, n);
        let train: Vec<usize> = (0..m).map(|j| j * n / m).collect();
        for (i, file) in files.into_iter().enumerate() {
            listed.push((class.clone(), file, train.contains(&i)));
        }
    }
    let clips = listed.into_par_iter().map(|(class, path, trains)| {
        let clip = ClipRef { path, span: None };
        let words = clip_words(&clip, &ReadOptions::default(), set, 30.0)
            .unwrap()
            .words;
        Clip {
            class,
            words,
            trains,
        }
    });
    clips.collect()
}

fn index_of(clips: &[&Clip]) -> Index {
    let mut builder = IndexBuilder::new();
    for clip in clips {
        builder.push("", [], &clip.words).unwrap();
    }
    builder.build()
}

fn stretches(
    index: &Index,
    p: &Preselection,
    query: &KeyframeQuery,
    clips: &[&Clip],
) -> Vec<Vec<Range<usize>>> {
    let mut stretches = vec![Vec::new(); clips.len()];
    for hit in search_keyframes(index, query).unwrap().hits {
        let doc = hit.doc.index();
        stretches[doc].push(p.stretch(hit.first.start, hit.last.end - 1, clips[doc].words.len()));
    }
    stretches.iter_mut().for_each(Preselection::merge);
    stretches
}

#[test]
fn real_keyframes() {
    let Some(data) = data() else { return };
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let all = clips(&data.join("hdm05"), &set);
    let mut classes: Vec<&str> = all.iter().map(|c| c.class.as_str()).collect();
    classes.dedup();
    let eval: Vec<&Clip> = all.iter().filter(|c| !c.trains).collect();
    let index = index_of(&eval);
    let n_frames: usize = eval.iter().map(|c| c.words.len()).sum();
    let groups: Vec<u64> = ["upper", "lower", "mix"]
        .iter()
        .map(|p| set.select(p).unwrap())
        .collect();
    for class in classes {
        let of = |trains: bool, same: bool| -> Vec<&[u64]> {
            all.iter()
                .filter(|c| c.trains == trains && (c.class == class) == same)
                .map(|c| c.words.as_slice())
                .collect()
        };
        let positives = of(true, true);
        let motions: Vec<MotionTemplate> = positives
            .iter()
            .map(|w| MotionTemplate::from_words(w, set.features().len()).unwrap())
            .collect();
        let template = learn(&motions, &LearnConfig::default()).unwrap().template;
        let q = template.quantize(0.1).unwrap();
        let start = std::time::Instant::now();
        let negatives = of(false, false).len();
        let negs = of(true, false);
        let learned = learn_keyframes(
            &q,
            &Examples {
                positives: &positives,
                negatives: &negs,
            },
            &ExampleConfig::of_features(set.all()),
        );
        let t = start.elapsed();
        let full = hits(&q, &eval, None);
        println!(
            "{class} K {} train {} eval {} full hits {} relevant {}; learned in {t:?} kept on training {:.3} negs {negatives}",
            q.n_columns(),
            positives.len(),
            eval.iter().filter(|c| c.class == class).count(),
            full.len(),
            relevant(&full, &eval, class),
            learned.kept
        );
        for (name, keyframes) in [
            (
                "auto2",
                choose_keyframes(&template, &groups, &AutomaticConfig::interactive()).unwrap(),
            ),
            (
                "auto8",
                choose_keyframes(&template, &groups, &AutomaticConfig::batch()).unwrap(),
            ),
            ("learned", learned.keyframes.clone()),
        ] {
            let Ok(p) = Preselection::new(&keyframes, q.n_columns()) else {
                println!("  {name}: none");
                continue;
            };
            for rule in ["2008", "2006"] {
                let query = keyframe_query(&p);
                let query = if rule == "2006" {
                    query.greedy(p.greedy_frames())
                } else {
                    query
                };
                let s = stretches(&index, &p, &query, &eval);
                if rule == "2008" {
                    for (s, clip) in s.iter().zip(&eval) {
                        assert_eq!(*s, p.stretches(&clip.words));
                    }
                }
                let kept: usize = s.iter().flatten().map(Range::len).sum();
                let n_rel = eval.iter().filter(|c| c.class == class).count();
                let alive = eval
                    .iter()
                    .zip(&s)
                    .filter(|(c, s)| c.class == class && !s.is_empty())
                    .count();
                let found = hits(&q, &eval, Some(&s));
                println!(
                    "  {name} {rule}: {} kf, kept {:.1}%, relevant clips kept {alive}/{n_rel}, hits {}, relevant {}",
                    keyframes.len(),
                    100.0 * kept as f64 / n_frames as f64,
                    found.len(),
                    relevant(&found, &eval, class)
                );
            }
            print_keyframes(&set, &keyframes);
        }
        let p = Preselection::new(&learned.keyframes, q.n_columns()).unwrap();
        for words in positives {
            assert!(!p.stretches(words).is_empty());
        }
    }
}

fn print_keyframes(set: &FeatureSet, keyframes: &[Keyframe]) {
    for k in keyframes {
        let fs: Vec<String> = (0..64)
            .filter(|b| k.care >> b & 1 == 1)
            .map(|b| format!("{}={}", set.features()[b].name, k.value >> b & 1))
            .collect();
        println!(
            "      col {} s {:.2}: {}",
            k.column,
            k.stiffness,
            fs.join(" ")
        );
    }
}

fn relevant(hits: &[(usize, Range<usize>)], eval: &[&Clip], class: &str) -> usize {
    let mut docs: Vec<usize> = hits
        .iter()
        .map(|h| h.0)
        .filter(|&d| eval[d].class == class)
        .collect();
    docs.dedup();
    docs.len()
}

fn hits(
    q: &QuantizedTemplate,
    eval: &[&Clip],
    s: Option<&[Vec<Range<usize>>]>,
) -> Vec<(usize, Range<usize>)> {
    let mut out = Vec::new();
    for (doc, clip) in eval.iter().enumerate() {
        let whole = [0..clip.words.len()];
        let stretches: &[Range<usize>] = s.map_or(&whole, |s| &s[doc]);
        for st in stretches {
            for m in q.find_matches(&clip.words[st.clone()], &MatchConfig::up_to(0.06)) {
                out.push((doc, m.span.start + st.start..m.span.end + st.start));
            }
        }
    }
    out
}
