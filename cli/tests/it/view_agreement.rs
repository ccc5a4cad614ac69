//! Pictures of hits in the live viewer: those that the search itself would show.

use std::collections::BTreeSet;
use std::ops::Range;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use cli::args::MatchingArgs;
use cli::commands::search::scene::{self, SceneHitJson};
use cli::output::Voice;
use cli::report::document::Picture;
use cli::report::pictures;
use relfeat::source_frame;
use serde_json::Value;

use crate::learn::Learned;
use crate::view::library;
use crate::view_client::{Server, encoded};

/// The hits of the last page.
pub(crate) fn shown(answer: &Value) -> &Vec<Value> {
    let page = answer["pages"].as_array().unwrap().last().unwrap();
    page["hits"].as_array().unwrap()
}

/// The picture that a hit says how to ask for.
#[track_caller]
pub(crate) fn asked(hit: &Value) -> Value {
    assert!(hit["agreement"].is_null());
    let ask = hit["ask"].as_str().unwrap();
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/?&=%+-._*".contains(&byte);
    assert!(ask.bytes().all(is_plain), "{ask}");
    let answer = Server::get().json(&format!("/api/{ask}"));
    assert!(answer["agreement"]["image"].is_string(), "{ask}");
    answer["agreement"].clone()
}

/// Holds the picture of a hit against the one expected. Pictures are too long to be told.
#[track_caller]
pub(crate) fn check_picture(hit: &Value, expected: Option<Picture>) {
    // As text, so that numbers are rounded alike.
    let expected: Value = serde_json::from_str(&serde_json::to_string(&expected).unwrap()).unwrap();
    let found = asked(hit);
    for field in ["width", "height", "area", "seconds", "values"] {
        assert_eq!(found[field], expected[field], "{}: {field}", hit["ask"]);
    }
    assert!(found["image"] == expected["image"], "{}", hit["ask"]);
}

/// The codes of a hit's line by definition, in source frames: on or off as asked, otherwise, nothing asked.
fn codes(line: &scene::LineJson, runs: &[[usize; 2]], frames: &[(usize, bool)]) -> Vec<u8> {
    let asked = line.progression.split(' ').zip(runs);
    let asked: Vec<_> = asked.collect();
    let code = |&(frame, is_on): &(usize, bool)| {
        let value = asked
            .iter()
            .find(|(_, run)| (run[0]..run[1]).contains(&frame));
        match (value.map_or("*", |(value, _)| *value), is_on) {
            ("1", true) => 0,
            ("0", false) => 1,
            ("*", _) => 3,
            _ => 2,
        }
    };
    frames.iter().map(code).collect()
}

#[test]
fn the_picture_of_a_scene_tells_when_which_line_asks_what() {
    let library = library();
    let set = &library.features.set;
    let clips = library.clips().unwrap();
    let text = "rknee_bent : * 0 1 0; F21 as other : 1 0; within 3s rknee_bent[3] other[1]";
    let expected = scene::search(&library, text, 12, Voice::default()).unwrap();
    let answer = Server::get().json(&format!("/api/scene?text={}&top=12", encoded(text)));
    assert_eq!(shown(&answer).len(), expected.hits.len());
    assert!(!expected.hits.is_empty());
    let mut seen = BTreeSet::new();
    for (shown, SceneHitJson { hit, lines }) in shown(&answer).iter().zip(&expected.hits) {
        let picture = asked(shown);
        let values = &picture["values"];
        let rows = serde_json::json!(["rknee_bent", "lknee_bent as other"]);
        assert_eq!(values["rows"], rows);
        assert_eq!(picture["seconds"][0], hit.start_s);
        let clip = clips.iter().find(|clip| clip.name == hit.clip).unwrap();
        let words = library.words(clip.id).unwrap();
        let mut all = Vec::new();
        for (line, of) in expected.query.lines.iter().zip(lines) {
            let bit = set.select(&line.feature).unwrap();
            let frames = words.iter().enumerate().map(|(k, word)| {
                let frame = source_frame(k, clip.meta.source_rate, library.rate);
                (frame, word & bit != 0)
            });
            let of_hit = frames.filter(|(frame, _)| (hit.start..hit.end).contains(frame));
            all.extend(codes(line, &of.segments, &of_hit.collect::<Vec<_>>()));
        }
        seen.extend(all.iter().copied());
        assert_eq!(values["codes"], STANDARD.encode(all), "{hit:?}");
    }
    assert_eq!(seen, BTreeSet::from([0, 1, 3]));
}

/// The curve Δ of the squat in a clip, with what was found.
pub(crate) fn curve(clip: &str, tau: f64, found: &[Range<f64>]) -> Option<Picture> {
    let library = library();
    let quantized = Learned::get().template("squat");
    let quantized = quantized.template.quantize(MatchingArgs::default().delta());
    let clips = library.clips().unwrap();
    let clip = clips.iter().find(|one| one.name == clip).unwrap();
    let words = library.words(clip.id).unwrap();
    let curve = quantized.unwrap().distance_curve(&words);
    let costs: Vec<Option<f32>> = curve.costs().map(|c| c.map(|c| c as f32)).collect();
    let seconds = [0.0, words.len() as f64 / library.rate];
    pictures::curve(&costs, "cost Δ", Some(tau as f32), (seconds, found))
}
