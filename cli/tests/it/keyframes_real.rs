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


fn unmerged(words: &[u64], k: &Keyframe, bits: u64) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for f in 0..words.len() {
        if !k.accepts(words[f]) { continue; }
        match runs.last_mut() {
            Some(r) if r.end == f && (words[f] ^ words[f-1]) & bits == 0 => r.end += 1,
            _ => runs.push(f..f + 1),
        }
    }
    runs
}

fn greedy2006(words: &[u64], p: &Preselection, groups: &[u64], full: bool) -> Vec<Range<usize>> {
    let runs: Vec<_> = p.keyframes().iter().map(|k| {
        let g = if full { u64::MAX } else { *groups.iter().find(|g| k.care & !**g == 0).unwrap() };
        unmerged(words, k, g)
    }).collect();
    let mut out = Vec::new();
    for r in &runs[0] {
        let first = r.end - 1;
        let mut at = Some(first);
        for rs in &runs[1..] {
            at = at.and_then(|at| rs.iter().find(|r| r.start >= at)).map(|r| r.start);
        }
        if let Some(last) = at && last + 1 - first <= p.greedy_frames() { out.push(p.stretch(first, last, words.len())); }
    }
    Preselection::merge(&mut out);
    out
}

#[test]
fn real_keyframes() {
    let Some(data) = data() else { return };
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let all = clips(&data.join("hdm05"), &set);
    let mut classes: Vec<&str> = all.iter().map(|c| c.class.as_str()).collect();
    classes.dedup();
    let eval: Vec<&Clip> = all.iter().filter(|c| !c.trains).collect();
    let n_frames: usize = eval.iter().map(|c| c.words.len()).sum();
    let groups: Vec<u64> = ["upper", "lower", "mix"].iter().map(|p| set.select(p).unwrap()).collect();
    let prepared: Vec<_> = classes.par_iter().map(|class| {
        let of = |trains: bool, same: bool| -> Vec<&[u64]> {
            all.iter().filter(|c| c.trains == trains && (c.class == *class) == same).map(|c| c.words.as_slice()).collect()
        };
        let positives = of(true, true);
        let motions: Vec<MotionTemplate> = positives.iter().map(|w| MotionTemplate::from_words(w, set.features().len()).unwrap()).collect();
        let template = learn(&motions, &LearnConfig::default()).unwrap().template;
        let q = template.quantize(0.1).unwrap();
        (*class, template, q, positives, of(true, false))
    }).collect();
    for (class, template, q, _, _) in &prepared {
        let auto = choose_keyframes(template, &groups, &AutomaticConfig::interactive()).unwrap();
        let p = Preselection::new(&auto, q.n_columns()).unwrap();
        let mut line = format!("2006 {class}");
        for full in [true, false] {
            let s: Vec<_> = eval.iter().map(|c| greedy2006(&c.words, &p, &groups, full)).collect();
            let kept: usize = s.iter().flatten().map(Range::len).sum();
            let alive = eval.iter().zip(&s).filter(|(c, s)| c.class == *class && !s.is_empty()).count();
            line += &format!("  full {full} kept {:.1} clips {alive}", 100.0 * kept as f64 / n_frames as f64);
        }
        println!("{line}");
    }
    let base = ExampleConfig::of_features(set.all());
    let mut configs = vec![];
    for enough in [0.0, 0.02, 0.05] { for slack in [0.75, 0.5] { for margin in [1, 2, 4] {
        configs.push(ExampleConfig { enough, slack, margin, ..base });
    } } }
    for config in configs {
        let rows: Vec<_> = prepared.par_iter().map(|(class, _, q, positives, negatives)| {
            let lost = |keyframes: &[Keyframe], words: &[u64]| match Preselection::new(keyframes, q.n_columns()) {
                Err(_) => 0,
                Ok(p) => usize::from(p.stretches(words).is_empty()),
            };
            let k = learn_keyframes(q, &Examples { positives, negatives }, &config).keyframes;
            let kept: usize = eval.iter().map(|c| Preselection::new(&k, q.n_columns()).map_or(c.words.len(), |p| p.stretches(&c.words).iter().map(Range::len).sum())).sum();
            let eval_lost: usize = eval.iter().filter(|c| c.class == *class).map(|c| lost(&k, &c.words)).sum();
            let mut loo = 0;
            for i in 0..positives.len() {
                let mut rest = positives.clone();
                let out = rest.remove(i);
                let k = learn_keyframes(q, &Examples { positives: &rest, negatives }, &config).keyframes;
                loo += lost(&k, out);
            }
            (*class, k.len(), kept as f64 / n_frames as f64, eval_lost, loo)
        }).collect();
        println!("enough {} slack {} margin {}: mean kept {:.3} eval lost {} loo lost {} | {}", config.enough, config.slack, config.margin,
            rows.iter().map(|r| r.2).sum::<f64>() / rows.len() as f64, rows.iter().map(|r| r.3).sum::<usize>(), rows.iter().map(|r| r.4).sum::<usize>(),
            rows.iter().map(|r| format!("{} {:.3} {} {}", r.1, r.2, r.3, r.4)).collect::<Vec<_>>().join("; "));
    }
}

#[allow(dead_code)]
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

#[allow(dead_code)]
fn relevant(hits: &[(usize, Range<usize>)], eval: &[&Clip], class: &str) -> usize {
    let mut docs: Vec<usize> = hits
        .iter()
        .map(|h| h.0)
        .filter(|&d| eval[d].class == class)
        .collect();
    docs.dedup();
    docs.len()
}

#[allow(dead_code)]
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
