//! Motion bundles of the built-in corpus.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use cli::bundling::load;
use cli::corpus::Class;
use serde_json::Value;
use tempfile::TempDir;

use crate::command::{GOOD, Output, motif, text};
use crate::corpus::Fixture;

const PERFORMER: &str = "anna";

/// Squats and jumps of one performer, bundled once for all tests.
pub(crate) struct Made {
    dir: TempDir,
    pub(crate) json: Value,
}

pub(crate) fn clips() -> Vec<PathBuf> {
    [Class::Squat, Class::KickLeft]
        .map(|class| Fixture::get().clip(PERFORMER, class))
        .to_vec()
}

/// `motif bundle` of `clips` with what else is asked.
pub(crate) fn bundle(clips: &[PathBuf], output: &Path, more: &[&str]) -> Output {
    let mut args = vec!["bundle", "--json", "--kappa", "12", "-o", text(output)];
    if more.contains(&"--add") {
        args.drain(2..4);
    }
    args.extend(more);
    args.extend(clips.iter().map(|clip| text(clip)));
    motif(&args)
}

impl Made {
    pub(crate) fn get() -> &'static Made {
        static MADE: OnceLock<Made> = OnceLock::new();
        MADE.get_or_init(|| {
            let dir = tempfile::tempdir().unwrap();
            let path = |name: &str| dir.path().join(name);
            let exports = [path("g.dot"), path("g.svg"), path("g.graphml")];
            let [dot, svg, graphml] = [0, 1, 2].map(|k| text(&exports[k]));
            let more = ["--dot", dot, "--svg", svg, "--graphml", graphml];
            let run = bundle(&clips(), &path("model.mbg"), &more);
            assert_eq!(run.code, 0, "{run:?}");
            let json = run.json();
            Made { dir, json }
        })
    }

    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }
}

/// The spans of bundles, by clip.
fn spans(json: &Value) -> BTreeMap<String, Vec<(u64, u64)>> {
    let mut spans: BTreeMap<String, Vec<(u64, u64)>> = BTreeMap::new();
    for bundle in json["result"]["bundles"].as_array().unwrap() {
        for span in bundle["spans"].as_array().unwrap() {
            let ends = ["start", "end"].map(|end| span[end].as_u64().unwrap());
            let clip = span["clip"].as_str().unwrap().to_owned();
            spans.entry(clip).or_default().push((ends[0], ends[1]));
        }
    }
    for of_clip in spans.values_mut() {
        of_clip.sort_unstable();
    }
    spans
}

#[test]
fn bundles_are_told_and_share_no_frames() {
    let made = Made::get();
    let result = &made.json["result"];
    assert_eq!(result["clusters"], 12);
    assert!(result["string_length"].as_u64().unwrap() > 12);
    let bundles = result["bundles"].as_array().unwrap();
    assert!(!bundles.is_empty());
    for (id, bundle) in bundles.iter().enumerate() {
        assert_eq!(bundle["id"], id);
        let spans = bundle["spans"].as_array().unwrap();
        assert_eq!(bundle["height"], spans.len());
        assert!(spans.len() > 1);
        let frames = |span: &Value| span["end"].as_f64().unwrap() - span["start"].as_f64().unwrap();
        let mean = spans.iter().map(frames).sum::<f64>() / spans.len() as f64;
        assert!((bundle["mean_frames"].as_f64().unwrap() - mean).abs() < 1e-9);
    }
    for of_clip in spans(&made.json).values() {
        assert!(of_clip.iter().all(|(start, end)| start < end));
        assert!(of_clip.windows(2).all(|pair| pair[0].1 <= pair[1].0));
    }
    for edge in result["edges"].as_array().unwrap() {
        let is_bundle = |end: &str| edge[end].as_u64().unwrap() < bundles.len() as u64;
        assert!(is_bundle("from") && is_bundle("to"));
    }
}

/// All submotions, of bundles, on edges and loose, tile each clip between its first and last one.
#[test]
fn submotions_tile_the_clips() {
    let bundled = load(&Made::get().file("model.mbg")).unwrap();
    let graph = bundled.model.graph();
    graph.debug_validate().unwrap();
    let passages = graph.edges().iter().flat_map(|edge| &edge.passages);
    let mut all: Vec<_> = graph.bundles().iter().flat_map(|b| &b.submotions).collect();
    all.extend(passages.filter_map(|passage| passage.transition.as_ref()));
    all.extend(graph.loose());
    all.sort_by_key(|submotion| submotion.span.start);
    let mut n_tiled = 0;
    for pair in all.windows(2).filter(|pair| pair[0].clip == pair[1].clip) {
        assert_eq!(pair[0].span.end, pair[1].span.start);
        n_tiled += 1;
    }
    assert!(n_tiled > 2);
    for submotion in all {
        let (clip, frames) = bundled.source(submotion).unwrap();
        assert!(clip.frames.start <= frames.start && frames.end < clip.frames.end);
        assert_eq!(frames.len(), submotion.span.len());
    }
}

#[test]
fn spans_are_frames_of_the_file() {
    let made = Made::get();
    let clip = &clips()[0];
    let n_frames = load(&made.file("model.mbg")).unwrap().clips[0].frames.end;
    let cut = PathBuf::from(format!("{}@40-{n_frames}", text(clip)));
    let output = made.file("cut.mbg");
    let run = bundle(&[cut], &output, &["--gamma", "0"]);
    assert!(run.code < 2, "{run:?}");
    for (file, spans) in spans(&run.json()) {
        assert_eq!(file, text(clip));
        assert!(spans.iter().all(|&(start, _)| start >= 40));
    }
    assert_eq!(load(&output).unwrap().clips[0].frames, 40..n_frames);
}

#[test]
fn exports_are_what_they_claim_to_be() {
    let made = Made::get();
    let read = |name: &str| fs::read_to_string(made.file(name)).unwrap();
    let n_bundles = made.json["result"]["bundles"].as_array().unwrap().len();
    let n_edges = made.json["result"]["edges"].as_array().unwrap().len();
    let dot = read("g.dot");
    assert!(dot.starts_with("digraph") && dot.trim_end().ends_with('}'));
    assert_eq!(dot.matches("->").count(), n_edges);
    for (name, element, n) in [
        ("g.graphml", "node", n_bundles),
        ("g.svg", "rect", n_bundles),
    ] {
        let document = read(name);
        let mut reader = quick_xml::Reader::from_str(&document);
        let mut found = 0;
        loop {
            match reader.read_event().unwrap() {
                quick_xml::events::Event::Eof => break,
                quick_xml::events::Event::Start(e) | quick_xml::events::Event::Empty(e) => {
                    found += usize::from(e.name().as_ref() == element);
                }
                _ => {}
            }
        }
        assert!(found >= n, "{name}: {found} of {n}");
    }
}

#[test]
fn adding_clips_keeps_what_was_there() {
    let made = Made::get();
    let (old, new) = (made.file("model.mbg"), made.file("more.mbg"));
    let added = [Fixture::get().clip("ben", Class::Squat), clips()[0].clone()];
    let run = bundle(&added, &new, &["--add", text(&old)]);
    assert_eq!(run.code, 0, "{run:?}");
    let json = run.json();
    // The clip that the model has already is left out.
    let skipped = json["skipped"].as_array().unwrap();
    assert_eq!(skipped.len(), 1);
    assert_eq!(skipped[0]["path"], text(&added[1]));
    let before = made.json["result"]["bundles"].as_array().unwrap();
    let after = json["result"]["bundles"].as_array().unwrap();
    for (was, is) in before.iter().zip(after) {
        let is = is["spans"].as_array().unwrap();
        let kept = was["spans"].as_array().unwrap();
        assert!(kept.iter().all(|span| is.contains(span)));
    }
    let count_all = |json: &Value| spans(json).values().map(Vec::len).sum::<usize>();
    assert!(count_all(&json) > count_all(&made.json));
    let (old, new) = (load(&old).unwrap(), load(&new).unwrap());
    assert_eq!((old.clips.len(), new.clips.len()), (2, 3));
    assert_eq!(old.clusters, new.clusters);
    let n_letters = old.model.string().len();
    assert!((0..n_letters).all(|k| old.model.mapping().frame(k) == new.model.mapping().frame(k)));
}

#[test]
fn threads_change_nothing() {
    let made = Made::get();
    let expected = fs::read(made.file("model.mbg")).unwrap();
    for threads in ["1", "2"] {
        let output = made.file(&format!("threads{threads}.mbg"));
        let run = bundle(&clips(), &output, &["--threads", threads]);
        assert_eq!(
            run.json()["result"]["bundles"],
            made.json["result"]["bundles"]
        );
        assert_eq!(fs::read(output).unwrap(), expected);
    }
}

#[test]
fn a_table_of_bundles_is_printed() {
    let made = Made::get();
    let output = made.file("text.mbg");
    let mut args = vec!["bundle", "--kappa", "12", "-o", text(&output)];
    let clips = clips();
    args.extend(clips.iter().map(|clip| text(clip)));
    let run = motif(&args);
    assert_eq!(run.code, 0, "{run:?}");
    let n_bundles = made.json["result"]["bundles"].as_array().unwrap().len();
    let rows = run
        .stdout
        .lines()
        .filter(|line| line.trim().starts_with('B'));
    assert_eq!(rows.count(), n_bundles);
}

#[test]
fn what_cannot_be_bundled_is_refused() {
    let made = Made::get();
    let output = made.file("none.mbg");
    let foreign = made.file("foreign.bvh");
    fs::write(
        &foreign,
        GOOD.replace("CHANNELS 0", "CHANNELS 1 Xrotation")
            .replace("1 2 3", "1 2 3 4")
            .replace("0 0 0\n1", "0 0 0 0\n1"),
    )
    .unwrap();
    let clip = clips()[0].clone();
    let run = bundle(&[clip.clone(), foreign.clone()], &output, &[]);
    assert_eq!(run.code, 0, "{run:?}");
    let skipped = run.json()["skipped"].clone();
    assert_eq!(skipped[0]["path"], text(&foreign));
    let error = skipped[0]["error"].as_str().unwrap();
    assert!(error.contains("skeleton of the first clip"), "{error}");
    let rigid = made.file("rigid.bvh");
    fs::write(&rigid, GOOD).unwrap();
    let run = bundle(&[rigid], &output, &[]);
    assert_eq!(run.code, 3, "{run:?}");
    for (option, value) in [("--rho", "-1"), ("--gamma", "1.5"), ("--max-frames", "0")] {
        let option = format!("{option}={value}");
        assert_eq!(
            bundle(std::slice::from_ref(&clip), &output, &[&option]).code,
            2
        );
    }
    let old = made.file("model.mbg");
    let run = bundle(
        std::slice::from_ref(&clip),
        &output,
        &["--add", text(&old), "--rho", "2"],
    );
    assert_eq!(run.code, 2, "{run:?}");
}

#[test]
fn nothing_is_written_over_what_is_read() {
    let made = Made::get();
    let dir = tempfile::tempdir().unwrap();
    let clip = dir.path().join("squat.bvh");
    let source = text(&clips()[0]).to_owned();
    assert_eq!(motif(&["convert", &source, text(&clip)]).code, 0);
    let (before, new) = (fs::read(&clip).unwrap(), dir.path().join("new.mbg"));
    // A clip by another name, known by how it begins.
    let plain = dir.path().join("squat.dat");
    fs::write(&plain, &before).unwrap();
    let skeleton = dir.path().join("squat.asf");
    let (clip, span) = (text(&clip), format!("{}@0-60", text(&clip)));
    let (plain, skeleton) = (text(&plain), text(&skeleton));
    let folder = text(dir.path());
    let (old, picture) = (made.file("model.mbg"), dir.path().join("g.svg"));
    let (new, old, picture) = (text(&new), text(&old), text(&picture));
    let around = dir.path().join(".").join("squat.bvh");
    for args in [
        &[clip, "-o", clip][..],
        &[clip, "-o", text(&around)],
        &[&span, "-o", clip],
        &[folder, "-o", clip],
        &[plain, "-o", plain],
        &[plain, "-o", new, "--svg", plain],
        &[clip, "-o", skeleton],
        &[clip, "-o", new, "--svg", clip],
        &[clip, "-o", new, "--dot", clip],
        &[clip, "-o", new, "--graphml", clip],
        &[clip, "-o", clip, "--add", old],
        &[clip, "-o", new, "--svg", picture, "--dot", picture],
        &[clip, "-o", new, "--svg", new],
    ] {
        let run = motif(&[&["bundle"], args].concat());
        assert_eq!(run.code, 2, "{args:?}: {run:?}");
        for source in [clip, plain] {
            assert_eq!(fs::read(source).unwrap(), before, "{args:?}");
        }
        assert!(!Path::new(new).exists() && !Path::new(picture).exists());
    }
}

/// The clips of a model have one rate, that of the first one, and so has what is added to it.
#[test]
fn clips_of_another_rate_are_left_out() {
    let made = Made::get();
    let (clip, slow) = (&clips()[0], made.file("slow.amc"));
    let run = motif(&["convert", text(clip), text(&slow), "--rate", "30"]);
    assert_eq!(run.code, 0, "{run:?}");
    let old = made.file("model.mbg");
    for (given, more) in [
        (vec![clip.clone(), slow.clone()], vec![]),
        (
            vec![Fixture::get().clip("ben", Class::Squat), slow.clone()],
            vec!["--add", text(&old)],
        ),
    ] {
        let output = made.file("rates.mbg");
        let run = bundle(&given, &output, &more);
        assert!(run.code < 2, "{run:?}");
        let skipped = run.json()["skipped"].clone();
        assert_eq!(skipped.as_array().unwrap().len(), 1);
        assert_eq!(skipped[0]["path"], text(&slow));
        let error = skipped[0]["error"].as_str().unwrap();
        for part in ["frames per second", "found 30", "motif convert --rate"] {
            assert!(error.contains(part), "{part}: {error}");
        }
        let clips = load(&output).unwrap().clips;
        assert!(clips.iter().all(|clip| clip.path != slow));
    }
    // A model of its own is no matter.
    let run = bundle(&[slow], &made.file("slow.mbg"), &["--gamma", "0"]);
    assert!(run.code < 2, "{run:?}");
}

#[test]
fn a_changed_bit_in_a_model_is_seen() {
    let made = Made::get();
    let bytes = fs::read(made.file("model.mbg")).unwrap();
    let broken = made.file("broken.mbg");
    let step = bytes.len() / 50 + 1;
    for at in (0..40).chain((40..bytes.len()).step_by(step)) {
        let mut changed = bytes.clone();
        changed[at] ^= 4;
        fs::write(&broken, changed).unwrap();
        assert!(load(&broken).is_err(), "byte {at}");
    }
    for len in (0..bytes.len()).step_by(step) {
        fs::write(&broken, &bytes[..len]).unwrap();
        assert!(load(&broken).is_err(), "{len} bytes");
    }
    let clip = clips()[0].clone();
    let run = bundle(&[clip], &made.file("x.mbg"), &["--add", text(&broken)]);
    assert_eq!(run.code, 3, "{run:?}");
    assert!(run.stderr.contains("broken.mbg"), "{run:?}");
}
