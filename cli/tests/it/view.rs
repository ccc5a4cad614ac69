//! The live viewer: page, clips, motions.

use std::collections::BTreeSet;

use cli::bundling;
use cli::library::{Clip, Library};
use cli::recording::ReadOptions;
use cli::report::clip::Drawn;
use cli::source::ClipRef;
use cli::take::Take;
use cli::view::Config;
use serde_json::Value;

use crate::bundle::Made;
use crate::command::motif;
use crate::corpus::Fixture;
use crate::view_client::Server;

pub(crate) fn library() -> Library {
    Library::open(&Fixture::get().library()).unwrap()
}

fn clips() -> Vec<Clip> {
    library().clips().unwrap()
}

fn names(answer: &Value) -> Vec<String> {
    let clips = answer["clips"].as_array().unwrap().iter();
    clips
        .map(|clip| clip["name"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn the_page_comes_with_a_strict_policy() {
    let reply = Server::get().get_path("/");
    assert_eq!(reply.status, 200);
    assert_eq!(
        reply.header("content-type"),
        Some("text/html; charset=utf-8")
    );
    let policy = reply.header("content-security-policy").unwrap();
    for needle in [
        "default-src 'none'",
        "script-src 'sha256-",
        "connect-src 'self'",
        "frame-ancestors 'none'",
    ] {
        assert!(policy.contains(needle), "{policy}");
    }
    assert!(!policy.contains("unsafe"), "{policy}");
    assert!(!policy.contains("http"), "{policy}");
    assert!(reply.text().contains("\"live\":true"));
    assert!(
        reply
            .text()
            .contains(&format!("\"n_clips\":{}", clips().len()))
    );
}

#[test]
fn every_answer_says_what_browsers_may_do_with_it() {
    for target in [
        "/",
        "/api/vocabulary",
        "/api/clips/0/motion",
        "/nothing",
        "/api/clips/x",
        "/api/search",
        "/api/agreement",
        "/api/agreement/template?name=squat&hit=0",
    ] {
        let reply = Server::get().get_path(target);
        for (name, value) in [
            ("x-content-type-options", "nosniff"),
            ("referrer-policy", "no-referrer"),
            ("cross-origin-resource-policy", "same-origin"),
            ("cross-origin-opener-policy", "same-origin"),
        ] {
            assert_eq!(reply.header(name), Some(value), "{target}");
        }
        assert!(
            reply
                .header("content-security-policy")
                .unwrap()
                .contains("default-src 'none'")
        );
        let mut names = reply.headers.keys();
        assert!(
            !names.any(|name| name.starts_with("access-control-")),
            "{target}"
        );
    }
}

#[test]
fn clips_are_listed_by_name_label_and_length() {
    let server = Server::get();
    let clips = clips();
    let mut expected: Vec<String> = clips.iter().map(|clip| clip.name.clone()).collect();
    expected.sort();
    let mut listed = Vec::new();
    while listed.len() < clips.len() {
        let answer = server.json(&format!("/api/clips?from={}&n=100", listed.len()));
        assert_eq!(answer["total"], clips.len());
        listed.extend(names(&answer));
    }
    assert_eq!(listed, expected);

    let answer = server.json("/api/clips?n=200&sort=seconds&down=1");
    let longest = answer["clips"].as_array().unwrap().iter().map(|clip| {
        let frames = clip["end"].as_f64().unwrap() - clip["start"].as_f64().unwrap();
        frames / clip["rate"].as_f64().unwrap()
    });
    let longest: Vec<f64> = longest.collect();
    assert!(longest.is_sorted_by(|a, b| a >= b));
    let seconds = |clip: &Clip| clip.meta.source_frames as f64 / clip.meta.source_rate;
    let of_all = clips.iter().map(seconds).fold(0.0, f64::max);
    assert_eq!(longest[0], of_all);

    let answer = server.json("/api/clips?n=200&label=anna&text=SQUAT");
    let squats = expected
        .iter()
        .filter(|name| name.contains("/anna/") && name.contains("squat"));
    let squats: Vec<String> = squats.cloned().collect();
    assert!(squats.len() > 1);
    assert_eq!(names(&answer), squats);
    let answer = server.json("/api/clips?sort=label&n=200&down=1");
    let labels = answer["clips"].as_array().unwrap().iter();
    let labels: Vec<&str> = labels.map(|clip| clip["label"].as_str().unwrap()).collect();
    assert!(labels.is_sorted_by(|a, b| a >= b));
}

#[test]
fn a_listed_clip_has_its_place_its_figure_and_a_strip() {
    let server = Server::get();
    let clips = clips();
    let answer = server.json("/api/clips?n=7&from=3");
    for clip in answer["clips"].as_array().unwrap() {
        let known = &clips[clip["id"].as_u64().unwrap() as usize];
        assert_eq!(clip["name"], known.name);
        assert_eq!(clip["rate"], known.meta.source_rate);
        assert_eq!(clip["end"], known.meta.end_frame);
        assert_eq!(clip["rig"], known.meta.rig);
        assert!(clip["motion"].is_null());
        let strip = drawn(known).strip().unwrap();
        assert_eq!(clip["strip"], serde_json::to_value(strip).unwrap());
        let figure = &answer["figures"][clip["figure"].as_u64().unwrap() as usize];
        assert_eq!(*figure, serde_json::to_value(drawn(known).figure).unwrap());
    }
    let ids = answer["clips"].as_array().unwrap().iter();
    let ids: BTreeSet<u64> = ids.map(|clip| clip["id"].as_u64().unwrap()).collect();
    assert_eq!(ids.len(), 7);
}

fn drawn(clip: &Clip) -> Drawn {
    let source = ClipRef::parse(clip.name.as_ref()).unwrap();
    let take = Take::load(&source, &ReadOptions::default()).unwrap();
    Drawn::of_take(&take, library().rate)
}

fn motion(id: u32) -> Vec<u8> {
    let reply = Server::get().get_path(&format!("/api/clips/{id}/motion"));
    assert_eq!(reply.status, 200, "{}", reply.text());
    reply.body
}

#[test]
fn a_motion_has_the_positions_of_the_file() {
    for id in [0, 40] {
        let drawn = drawn(&clips()[id as usize]);
        let expected = drawn.millimetres();
        let reply = Server::get().get_path(&format!("/api/clips/{id}/motion"));
        let [x, y, z] = expected.origin;
        let (frames, points, _) = drawn.positions.dim();
        assert!(frames > 0);
        for (name, value) in [
            ("content-type", "application/octet-stream".to_owned()),
            ("accept-ranges", "bytes".to_owned()),
            ("motif-rate", drawn.rate.to_string()),
            ("motif-frames", frames.to_string()),
            ("motif-points", points.to_string()),
            ("motif-origin", format!("{x},{y},{z}")),
        ] {
            assert_eq!(reply.header(name), Some(value.as_str()), "{name}");
        }
        let values = reply
            .body
            .chunks_exact(2)
            .map(|two| i16::from_le_bytes([two[0], two[1]]));
        assert_eq!(values.collect::<Vec<i16>>(), expected.values);
        assert_eq!(reply.body.len(), frames * points * 3 * 2);
    }
}

#[test]
fn parts_of_a_motion_make_the_whole() {
    let server = Server::get();
    let whole = motion(0);
    let n_bytes = whole.len();
    let mut parts = Vec::new();
    for start in (0..n_bytes).step_by(1000) {
        let last = (start + 999).min(n_bytes - 1);
        let header = format!("Range: bytes={start}-{}\r\n", start + 999);
        let reply = server.ask("GET", "/api/clips/0/motion", &header);
        assert_eq!(reply.status, 206);
        let expected = format!("bytes {start}-{last}/{n_bytes}");
        assert_eq!(reply.header("content-range"), Some(expected.as_str()));
        assert_eq!(
            reply.header("content-length"),
            Some(reply.body.len().to_string().as_str())
        );
        parts.extend(reply.body);
    }
    assert!(parts == whole);
    let reply = server.ask("GET", "/api/clips/0/motion", "Range: bytes=-10\r\n");
    assert_eq!(
        (reply.status, &reply.body[..]),
        (206, &whole[n_bytes - 10..])
    );
}

#[test]
fn ranges_that_are_not_there_are_refused_and_several_are_the_whole() {
    let server = Server::get();
    let n_bytes = motion(0).len();
    let reply = server.ask(
        "GET",
        "/api/clips/0/motion",
        &format!("Range: bytes={n_bytes}-\r\n"),
    );
    assert_eq!(reply.status, 416);
    let expected = format!("bytes */{n_bytes}");
    assert_eq!(reply.header("content-range"), Some(expected.as_str()));
    assert!(reply.json()["error"].is_string());
    for header in [
        "Range: bytes=0-1,5-6\r\n",
        "Range: bytes=0-1\r\nRange: bytes=5-6\r\n",
        "Range: frames=0-1\r\n",
    ] {
        let reply = server.ask("GET", "/api/clips/0/motion", header);
        assert_eq!((reply.status, reply.body.len()), (200, n_bytes), "{header}");
    }
}

#[test]
fn a_part_of_another_motion_is_not_given() {
    let server = Server::get();
    let first = server.get_path("/api/clips/0/motion");
    let tag = first.header("etag").unwrap();
    let of = |tag: &str| {
        let headers = format!("Range: bytes=0-1\r\nIf-Range: {tag}\r\n");
        server.ask("GET", "/api/clips/0/motion", &headers).status
    };
    assert_eq!(of(tag), 206);
    assert_eq!(of("\"another\""), 200);
}

#[test]
fn a_clip_has_a_page() {
    let answer = Server::get().json("/api/clips/5");
    assert_eq!(answer["pages"][0]["kind"], "clip");
    assert_eq!(answer["pages"][0]["clip"], 5);
    assert_eq!(answer["clips"][0]["id"], 5);
    assert_eq!(answer["clips"][0]["name"], clips()[5].name);
    let matrix = &answer["pages"][0]["features"];
    assert_eq!(matrix["values"]["columns"], clips()[5].n_words);
    assert!(
        matrix["image"]
            .as_str()
            .unwrap()
            .starts_with("data:image/png")
    );
}

#[test]
fn heads_have_no_body_and_nothing_else_is_allowed() {
    let server = Server::get();
    let head = server.ask("HEAD", "/api/clips/0/motion", "");
    let length = motion(0).len().to_string();
    assert_eq!((head.status, head.body.len()), (200, 0));
    assert_eq!(head.header("content-length"), Some(length.as_str()));
    for method in [
        "POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "CONNECT",
    ] {
        let reply = server.ask(method, "/api/clips", "Content-Length: 0\r\n");
        // The target of CONNECT is a host, so ours is none.
        let expected: &[u16] = if method == "CONNECT" {
            &[400, 405]
        } else {
            &[405]
        };
        assert!(
            expected.contains(&reply.status),
            "{method}: {}",
            reply.status
        );
    }
    let reply = server.ask("POST", "/api/clips", "Content-Length: 0\r\n");
    assert_eq!(reply.header("allow"), Some("GET, HEAD"));
}

#[test]
fn words_of_scenes_are_told() {
    let answer = Server::get().json("/api/vocabulary");
    let features = answer["features"].as_array().unwrap();
    assert_eq!(features.len(), 39);
    assert_eq!(features[19]["name"], "rknee_bent");
    assert_eq!(features[19]["number"], 20);
    assert_eq!(features[19]["part"], "lower");
    let description = features[19]["description"].as_str().unwrap();
    assert!(description.starts_with("angle"), "{description}");
    assert_eq!(answer["keywords"][1], "overlap");
    let templates = answer["templates"].as_array().unwrap();
    let templates: Vec<&str> = templates
        .iter()
        .map(|t| t["name"].as_str().unwrap())
        .collect();
    assert_eq!(templates, ["squat", "kick_left"]);
}

#[test]
fn what_cannot_be_shown_is_said_at_once() {
    let missing = motif(&["view", "/there/is/no/library"]);
    assert_eq!(missing.code, 4, "{missing:?}");
    let library = Fixture::get().library();
    let no_templates = motif(&[
        "view",
        library.to_str().unwrap(),
        "--templates",
        "/there/is/nothing",
    ]);
    assert_eq!(no_templates.code, 4, "{no_templates:?}");
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let taken = motif(&["view", library.to_str().unwrap(), "--port", &port]);
    assert_eq!(taken.code, 4, "{taken:?}");
}

/// The document that a page holds.
fn document(server: &Server) -> Value {
    let page = server.get_path("/").text();
    let (_, rest) = page.split_once("id=\"document\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn bundles_are_shown_where_they_are_in_the_library() {
    let made = Made::get();
    let config = Config {
        bundles: Some(bundling::load(&made.file("model.mbg")).unwrap()),
        ..Config::default()
    };
    let document = document(&Server::of(&Fixture::get().library(), config));
    let page = &document["pages"][1];
    assert_eq!(page["kind"], "bundles");
    let name = |id: &Value| {
        let mut clips = document["clips"].as_array().unwrap().iter();
        clips.find(|clip| clip["id"] == *id).unwrap()["name"].clone()
    };
    let bundles = made.json["result"]["bundles"].as_array().unwrap();
    assert_eq!(page["nodes"].as_array().unwrap().len(), bundles.len());
    for (node, bundle) in page["nodes"].as_array().unwrap().iter().zip(bundles) {
        assert_eq!(node["id"], format!("B{}", bundle["id"]));
        let spans = node["spans"].as_array().unwrap().iter();
        let found = spans.map(|span| {
            (
                name(&span["clip"]),
                span["start"].clone(),
                span["end"].clone(),
            )
        });
        let spans = bundle["spans"].as_array().unwrap().iter();
        let expected = spans.map(|span| {
            (
                span["clip"].clone(),
                span["start"].clone(),
                span["end"].clone(),
            )
        });
        assert_eq!(found.collect::<Vec<_>>(), expected.collect::<Vec<_>>());
        let node = format!("data-bundle=\"B{}\"", bundle["id"]);
        assert!(page["svg"].as_str().unwrap().contains(&node));
    }
}
