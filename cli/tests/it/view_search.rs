//! Searches of the live viewer: they find what the command finds.

use std::ops::Range;

use cli::args::{MatchingArgs, Mode, Tau};
use cli::commands::search::template::{Places, search as search_template};
use cli::commands::search::{Mismatches, Sides, What, scene, search, template};
use cli::library::Clip;
use cli::output::Voice;
use cli::recording::ReadOptions;
use cli::report::pictures;
use cli::source::{ClipRef, Span};
use serde_json::Value;

use crate::learn::Learned;
use crate::view::library;
use crate::view_agreement::{check_picture, curve, shown};
use crate::view_client::{Server, encoded};

const KICK_PUNCH: &str = include_str!("../../examples/right_kick_left_punch.scene");

/// Hits as clip, frames, rank, cost, segments and side.
type Hits = Vec<(String, u64, u64, usize, f64, Vec<[u64; 2]>, bool)>;

fn hits(answer: &Value) -> Hits {
    let page = &answer["pages"][0];
    assert_eq!(page["kind"], "search");
    let name = |id: &Value| {
        let mut clips = answer["clips"].as_array().unwrap().iter();
        let clip = clips.find(|clip| clip["id"] == *id).unwrap();
        assert!(clip["strip"].is_object());
        clip["name"].as_str().unwrap().to_owned()
    };
    let hits = page["hits"].as_array().unwrap().iter();
    hits.map(|hit| {
        (
            name(&hit["clip"]),
            hit["start"].as_u64().unwrap(),
            hit["end"].as_u64().unwrap(),
            hit["rank"].as_u64().unwrap() as usize,
            hit["cost"].as_f64().unwrap(),
            serde_json::from_value(hit["segments"].clone()).unwrap(),
            hit["mirrored"].as_bool().unwrap(),
        )
    })
    .collect()
}

/// The id and the clip of the first whose name has `part`.
fn clip(part: &str) -> (usize, Clip) {
    let mut clips = library().clips().unwrap().into_iter().enumerate();
    clips.find(|(_, clip)| clip.name.contains(part)).unwrap()
}

#[track_caller]
fn check(part: &str, frames: Option<Span>, what: &What<'_>) {
    let (id, clip) = clip(part);
    let source = ClipRef {
        span: frames,
        ..ClipRef::parse(clip.name.as_ref()).unwrap()
    };
    let library = library();
    let explained = What {
        explain: true,
        ..*what
    };
    let options = ReadOptions::default();
    let expected = search(&library, &source, &explained, &options, Voice::default());
    let expected = expected.unwrap();
    let mut target = format!(
        "/api/search?clip={id}&features={}&mode={}&mismatches={}&mirror={}&top={}",
        what.features.join(","),
        what.mode.name(),
        what.mismatches.map_or(0, |m| m.max),
        u8::from(what.sides == Sides::Both),
        what.top
    );
    if let Some(Span { start, end }) = frames {
        target += &format!("&start={start}&end={end}");
    }
    let answer = Server::get().json(&target);
    assert_eq!(answer["pages"][0]["n_hits"], expected.n_hits);
    // Of all features at once, single segments seldom are a run of some.
    assert!(expected.n_hits > 0 || what.mode == Mode::Fuzzy, "{target}");
    for (shown, hit) in shown(&answer).iter().zip(&expected.hits).step_by(9) {
        let explained = hit.explained.as_ref().unwrap();
        let set = &library.features.set;
        let picture = pictures::agreement(set, &explained.agreement, library.rate, hit.start_s);
        check_picture(shown, picture);
    }
    let expected = expected.hits.iter().map(|hit| {
        let segments = hit.segments.iter().map(|s| [s[0] as u64, s[1] as u64]);
        let frames = (hit.start as u64, hit.end as u64);
        let segments = segments.collect();
        (
            hit.clip.clone(),
            frames.0,
            frames.1,
            hit.rank,
            hit.cost as f64,
            segments,
            hit.mirrored,
        )
    });
    assert_eq!(hits(&answer), expected.collect::<Hits>(), "{target}");
}

#[test]
fn an_example_finds_what_the_command_finds() {
    let knees = ["rknee_bent".to_owned(), "F21".to_owned()];
    let lower = ["lower".to_owned()];
    for mode in [Mode::Exact, Mode::Fuzzy, Mode::Adaptive] {
        for features in [&knees[..], &lower, &[]] {
            let what = What {
                mode,
                top: 30,
                ..What::new(features)
            };
            check("anna/squat_01", None, &what);
        }
    }
}

#[test]
fn spans_are_those_of_the_file() {
    let features = [
        "rknee_bent".to_owned(),
        "lknee_bent".to_owned(),
        "vertical_extent_small".to_owned(),
    ];
    for name in ["anna/squat_01", "eva/squat_01"] {
        let end = clip(name).1.meta.source_frames as usize;
        for k in 0..12 {
            let start = k * end / 24;
            let span = Span {
                start,
                end: end - k * end / 30,
            };
            let what = What {
                top: 200,
                ..What::new(&features)
            };
            check(name, Some(span), &what);
        }
    }
}

#[test]
fn mismatches_and_mirrored_bodies_are_found_too() {
    let features = ["lfoot_raised".to_owned(), "lknee_bent".to_owned()];
    let what = What {
        top: 50,
        ..What::new(&features)
    };
    let mismatches = Some(Mismatches { max: 1, at: &[] });
    check("anna/kick_left_01", None, &What { mismatches, ..what });
    let sides = Sides::Both;
    check("anna/kick_left_01", None, &What { sides, ..what });
    let span = Span {
        start: 10,
        end: 200,
    };
    check("anna/kick_left_01", Some(span), &What { sides, ..what });
}

#[test]
fn a_scene_finds_what_the_command_finds() {
    let expected = scene::search(&library(), KICK_PUNCH, 20, Voice::default()).unwrap();
    let target = format!("/api/scene?text={}", encoded(KICK_PUNCH));
    let answer = Server::get().json(&target);
    assert_eq!(answer["pages"][0]["n_hits"], expected.n_hits);
    let found: Vec<_> = hits(&answer)
        .into_iter()
        .map(|hit| (hit.0, hit.1 as usize, hit.2 as usize))
        .collect();
    let expected = expected
        .hits
        .iter()
        .map(|one| (one.hit.clip.clone(), one.hit.start, one.hit.end));
    assert!(!found.is_empty());
    assert_eq!(found, expected.collect::<Vec<_>>());
}

#[test]
fn titles_have_the_name_of_the_file_alone() {
    let (id, clip) = clip("anna/squat_01");
    let of = |frames: &str| {
        let answer = Server::get().json(&format!("/api/search?clip={id}{frames}"));
        answer["pages"][0].clone()
    };
    let file = clip.name.rsplit('/').next().unwrap();
    assert_eq!(of("")["title"], format!("like {file}"));
    let page = of("&start=10&end=99");
    assert_eq!(page["title"], format!("like {file}@10-99"));
    assert_eq!(page["query"][0]["value"], format!("{} 10-99", clip.name));
}

#[test]
fn a_scene_error_says_where_and_what() {
    let of = |text: &str| Server::get().refused(&format!("/api/scene?text={}", encoded(text)), 400);
    let error = of("rknee_bent : 0 1 0\nrknee_bend : 0 1\n");
    assert_eq!(
        (&error["line"], &error["column"]),
        (&2.into(), &1.into()),
        "{error}"
    );
    assert_eq!(error["found"], "rknee_bend");
    assert_eq!(error["expected"], "rknee_bent");
    let error = of("rknee_bent : 0 2");
    assert_eq!(
        (&error["line"], &error["column"]),
        (&1.into(), &16.into()),
        "{error}"
    );
    assert_eq!(
        error["found"].as_str().map(|found| found.contains('2')),
        Some(true),
        "{error}"
    );
    // Four bytes, two units of what a browser counts in, one character.
    let error = of("rknee_bent : 0 1\nrknee_bent as \u{1F9B5} : 0 1; before \u{1F9B5}[1] x[1]");
    assert_eq!(
        (&error["line"], &error["column"]),
        (&2.into(), &38.into()),
        "{error}"
    );
    of("");
    of("# nothing");
}

#[test]
fn a_template_finds_what_the_command_finds() {
    for tau in [None, Some(0.03)] {
        let what = template::What {
            matching: MatchingArgs {
                tau: tau.map(Tau::Value),
                delta: None,
            },
            places: Places::Everywhere,
            top: 10,
            ..template::What::default()
        };
        let squat = Learned::get().template("squat");
        let expected = search_template(&library(), &squat, &what, Voice::default()).unwrap();
        let tau = tau.map_or(String::new(), |tau| format!("&tau={tau}"));
        let answer = Server::get().json(&format!("/api/template?name=squat&top=10{tau}"));
        let pages = answer["pages"].as_array().unwrap();
        assert_eq!(pages[0]["kind"], "template");
        assert_eq!(
            pages[0]["matrix"]["values"]["columns"],
            squat.template.n_columns()
        );
        let page = &pages[1];
        assert_eq!(page["kind"], "search");
        assert_eq!(page["n_hits"], expected.n_hits);
        let found = page["hits"].as_array().unwrap().iter();
        let found: Vec<_> = found
            .map(|hit| (hit["start"].as_u64(), hit["cost"].as_f64()))
            .collect();
        let listed = expected
            .hits
            .iter()
            .map(|hit| (Some(hit.start as u64), Some(hit.cost)));
        assert!(!found.is_empty());
        assert_eq!(found, listed.collect::<Vec<_>>());
        let all = template::What { top: 0, ..what };
        let all = search_template(&library(), &squat, &all, Voice::default()).unwrap();
        for (shown, hit) in shown(&answer).iter().zip(&expected.hits) {
            let of_clip = all.hits.iter().filter(|other| other.clip == hit.clip);
            let found: Vec<Range<f64>> = of_clip.map(|one| one.start_s..one.end_s).collect();
            let picture = curve(&hit.clip, expected.query.tau, &found);
            check_picture(shown, picture);
        }
    }
}

#[test]
fn questions_that_are_none_are_refused() {
    let server = Server::get();
    for target in [
        "/api/search",
        "/api/search?clip=-1",
        "/api/search?clip=0&clip=1",
        "/api/search?clip=0&top=0",
        "/api/search?clip=0&top=201",
        "/api/search?clip=0&start=5&end=5",
        "/api/search?clip=0&start=9&end=5",
        "/api/search?clip=0&end=18446744073709551615",
        "/api/search?clip=0&end=18446744073709551616",
        "/api/search?clip=0&start=5&end=5&mirror=1",
        "/api/search?clip=0&end=99999999&mirror=1",
        "/api/search?clip=0&features=no_such_feature",
        "/api/search?clip=0&mode=other",
        "/api/search?clip=0&mismatches=99999999",
        "/api/search?clip=0&other=1",
        "/api/clips?n=201",
        "/api/clips?sort=size",
        "/api/clips?from=x",
        "/api/template?name=squat&tau=2",
        "/api/template?name=squat&tau=NaN",
        "/api/template?name=squat&top=0",
        "/api/scene?text=rknee_bent%20:%200%201%200&top=0",
        "/api/scene?text=%FF",
        "/api/agreement",
        "/api/agreement?clip=0&start=0&end=9",
        "/api/agreement?clip=0&start=9&end=9&hit=0&from=0&to=9",
        "/api/agreement?clip=0&start=0&end=9&hit=0&from=0&to=9&top=1",
        "/api/agreement?clip=0&start=0&end=9&hit=0&from=0&to=9&features=no_such_feature",
        "/api/agreement/scene?text=rknee_bend%20:%200&hit=0&from=0&to=9",
        "/api/agreement/template?name=squat&tau=2&hit=0",
    ] {
        server.refused(target, 400);
    }
    for target in [
        "/api/search?clip=99999",
        "/api/clips/99999",
        "/api/clips/99999/motion",
        "/api/template?name=walk",
        "/api",
        "/api/clips/",
        "/api/agreement?clip=0&start=0&end=9&hit=99999&from=0&to=9",
        "/api/agreement?clip=0&start=0&end=90&hit=0&from=1&to=2",
        "/api/agreement?clip=0&start=0&end=90&hit=0&from=9&to=1",
        "/api/agreement/scene?text=rknee_bent%20:%200%201&hit=0&from=1&to=1",
        "/api/agreement/template?name=walk&hit=0",
        "/api/agreement/template?name=squat&hit=99999",
    ] {
        server.refused(target, 404);
    }
    let none = server.json("/api/clips?from=18446744073709551615&text=squat");
    assert_eq!(none["clips"], Value::Array(Vec::new()));
}
