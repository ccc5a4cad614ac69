//! `motif report` as a user runs it.

use std::fs;
use std::path::{Path, PathBuf};

use cli::corpus::Class;
use serde_json::Value;

use crate::command::{motif, text};
use crate::corpus::Fixture;
use crate::real::data;
use crate::view_agreement::asked;
use crate::view_client::Server;
use crate::walk::result;

/// What two clips of a minute may take, in bytes: small enough to be sent by mail.
const TWO_MINUTES: usize = 1_600_000;

/// The document in a page.
fn document(html: &str) -> Value {
    let inside = html.split_once("id=\"document\">").unwrap().1;
    serde_json::from_str(inside.split_once("</script>").unwrap().0).unwrap()
}

/// Writes a report of these files, checks that it loads nothing, and gives its text and its document.
fn report(files: &[&Path], more: &[&str]) -> (String, Value) {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out.html");
    let mut args = vec!["report"];
    args.extend(files.iter().map(|file| text(file)));
    args.extend(["-o", text(&out), "--json"]);
    args.extend(more);
    let told = result(&motif(&args));
    let html = fs::read_to_string(&out).unwrap();
    assert_eq!(told["bytes"], html.len());
    let document = document(&html);
    let n = |list: &str| document[list].as_array().unwrap().len();
    assert_eq!(
        (&told["pages"], &told["clips"]),
        (&n("pages").into(), &n("clips").into())
    );
    let mut rest = html.as_str();
    while let Some((_, after)) = rest.split_once("://") {
        // Names of XML namespaces are no addresses.
        assert!(
            after.starts_with("www.w3.org/"),
            "{}",
            &after[..after.len().min(60)]
        );
        rest = after;
    }
    for loaded in [" src=\"", " href=\"http", "url(http", "@import"] {
        assert!(!html.contains(loaded), "{loaded}");
    }
    (html, document)
}

fn kinds(document: &Value) -> Vec<&str> {
    let pages = document["pages"].as_array().unwrap().iter();
    pages.map(|page| page["kind"].as_str().unwrap()).collect()
}

/// A BVH file of a minute: a take, over and over.
fn a_minute(dir: &Path, name: &str) -> PathBuf {
    let fixture = Fixture::get();
    let takes = fixture.files.iter().filter(|file| file.class.is_none());
    let mut bvhs = takes.filter(|file| file.path.extension().is_some_and(|e| e == "bvh"));
    let take = fs::read_to_string(&bvhs.next().unwrap().path).unwrap();
    let (hierarchy, motion) = take.split_once("MOTION").unwrap();
    let mut lines = motion.lines().skip(1);
    let (_, time) = (lines.next(), lines.next().unwrap());
    let frames: Vec<&str> = lines.filter(|line| !line.trim().is_empty()).collect();
    let seconds: f64 = time.rsplit_once(' ').unwrap().1.trim().parse().unwrap();
    let n_frames = (60.0 / seconds).round() as usize;
    let repeated: Vec<&str> = frames.iter().copied().cycle().take(n_frames).collect();
    let path = dir.join(name);
    let text = format!(
        "{hierarchy}MOTION\nFrames: {n_frames}\n{time}\n{}\n",
        repeated.join("\n")
    );
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn two_clips_are_aligned_and_stay_small() {
    let dir = tempfile::tempdir().unwrap();
    let [a, b] = ["a.bvh", "b.bvh"].map(|name| a_minute(dir.path(), name));
    let (html, document) = report(&[&a, &b], &[]);
    assert_eq!(kinds(&document), ["clip", "clip", "alignment"]);
    assert!(html.len() <= TWO_MINUTES, "{} bytes", html.len());
    for clip in document["clips"].as_array().unwrap() {
        let motion = &clip["motion"];
        assert_eq!(
            (&motion["rate"], &motion["frames"]),
            (&30.0.into(), &1800.into())
        );
        // 24 points of three 16-bit numbers, four letters for three bytes.
        let letters = motion["bytes"].as_str().unwrap().len();
        assert_eq!(letters, 1800 * 24 * 3 * 2 / 3 * 4);
        assert_eq!(clip["rig"], document["clips"][0]["rig"]);
    }
    assert_eq!(document["figures"].as_array().unwrap().len(), 1);
    let path = document["pages"][2]["path"].as_array().unwrap();
    let steps = path.windows(2);
    assert!(
        steps
            .into_iter()
            .all(|step| step[0][0].as_u64() <= step[1][0].as_u64())
    );
    assert_eq!(path[0], serde_json::json!([0, 0]));
}

/// An AMC file of a minute beside its skeleton: a clip of CMU, over and over.
fn a_real_minute(cmu: &Path, name: &str, dir: &Path) -> PathBuf {
    let amc = fs::read_to_string(cmu.join(format!("{name}.amc"))).unwrap();
    let is_number = |line: &&str| line.trim().parse::<usize>().is_ok();
    let lines: Vec<&str> = amc.lines().collect();
    let starts: Vec<usize> = (0..lines.len()).filter(|&i| is_number(&lines[i])).collect();
    let frame = |k: usize| {
        let end = starts.get(k + 1).copied().unwrap_or(lines.len());
        lines[starts[k] + 1..end].join("\n")
    };
    let mut text = lines[..starts[0]].join("\n");
    for k in 0..60 * 120 {
        text += &format!("\n{}\n{}", k + 1, frame(k % starts.len()));
    }
    let path = dir.join(format!("{name}.amc"));
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn real_two_clips_of_a_minute_stay_small() {
    let Some(data) = data() else { return };
    let (cmu, dir) = (data.join("cmu/14"), tempfile::tempdir().unwrap());
    fs::copy(cmu.join("14.asf"), dir.path().join("14.asf")).unwrap();
    let [a, b] = ["14_06", "14_14"].map(|name| a_real_minute(&cmu, name, dir.path()));
    let (html, document) = report(&[&a, &b], &[]);
    assert_eq!(kinds(&document), ["clip", "clip", "alignment"]);
    assert_eq!(document["clips"][1]["motion"]["frames"], 1800);
    assert!(html.len() <= TWO_MINUTES, "{} bytes", html.len());
    println!("two real clips of a minute: {} bytes", html.len());
}

#[test]
fn a_library_is_a_contact_sheet_within_its_budget() {
    let library = Fixture::get().library();
    let (_, all) = report(&[&library], &["--budget", "1000"]);
    let (_, some) = report(&[&library], &["--budget", "0.5"]);
    let (_, none) = report(&[&library], &["--budget", "0"]);
    let bytes = |document: &Value| -> Vec<usize> {
        let clips = document["clips"].as_array().unwrap().iter();
        let motions = clips.filter_map(|clip| clip["motion"]["bytes"].as_str());
        motions.map(str::len).collect()
    };
    assert_eq!(bytes(&all).len(), Fixture::get().files.len());
    assert_eq!(all["pages"][0]["note"], Value::Null);
    let n_some = bytes(&some).len();
    assert!(n_some > 0 && n_some < bytes(&all).len());
    assert!(bytes(&some).iter().sum::<usize>() <= 500_000);
    assert!(
        some["pages"][0]["note"]
            .as_str()
            .unwrap()
            .contains("--budget 0.5")
    );
    assert!(bytes(&none).is_empty());
    for clip in none["clips"].as_array().unwrap() {
        assert_eq!(clip["strip"]["poses"], 8);
    }
    assert_eq!(kinds(&none), ["library"]);
    // Performers' folders lie side by side.
    assert!(
        none["pages"][0]["labels"]
            .as_array()
            .unwrap()
            .contains(&"eva".into())
    );
}

#[test]
fn the_same_files_give_the_same_bytes() {
    let fixture = Fixture::get();
    let (a, b) = (
        fixture.clip("eva", Class::Walk),
        fixture.clip("anna", Class::Walk),
    );
    let one = report(&[&a, &b], &["--threads", "1"]).0;
    assert!(one == report(&[&a, &b], &["--threads", "3"]).0);
}

#[test]
fn results_are_shown_with_their_clips() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let save = |name: &str, args: &[&str]| {
        let run = motif(args);
        assert_eq!(run.code, 0, "{run:?}");
        let path = dir.path().join(name);
        fs::write(&path, run.json().to_string()).unwrap();
        path
    };
    let (squat, walk) = (
        fixture.clip("anna", Class::Squat),
        fixture.clip("eva", Class::Walk),
    );
    let (squat, walk) = (text(&squat), text(&walk));
    let library = fixture.library();
    let features = "rknee_bent,lknee_bent";
    let example = save(
        "search.json",
        &[
            "search",
            text(&library),
            "--example",
            squat,
            "--features",
            features,
            "--json",
        ],
    );
    let scene = save(
        "scene.json",
        &[
            "search",
            text(&library),
            "--scene",
            "rknee_bent: 0 1 0",
            "--top",
            "3",
            "--json",
        ],
    );
    let align = save("align.json", &["align", walk, walk, "--json"]);
    let (_, shown) = report(&[&example, &scene, &align], &[]);
    assert_eq!(kinds(&shown), ["search", "search", "alignment"]);
    let [of_example, of_scene] = [0, 1].map(|page: usize| &shown["pages"][page]);
    let searched: Value = serde_json::from_slice(&fs::read(&example).unwrap()).unwrap();
    let searched = &searched["result"];
    assert_eq!(of_example["n_hits"], searched["n_hits"]);
    let hits = of_example["hits"].as_array().unwrap();
    assert_eq!(hits.len(), searched["hits"].as_array().unwrap().len());
    for (hit, found) in hits.iter().zip(searched["hits"].as_array().unwrap()) {
        for field in ["start", "end", "rank", "start_s", "segments"] {
            assert_eq!(hit[field], found[field], "{field}");
        }
        let clip = &shown["clips"][hit["clip"].as_u64().unwrap() as usize];
        assert_eq!(clip["name"], found["clip"]);
    }
    // The example is its own best hit: nothing compared differs.
    let cells = &hits[0]["agreement"]["values"];
    let first = cells["rows"][0].as_str().unwrap();
    assert!(features.contains(first), "{first}");
    assert_eq!(cells["meanings"][1], "compared, different");
    assert_eq!(of_scene["hits"].as_array().unwrap().len(), 3);
    let live = Server::get().json("/api/scene?text=rknee_bent:%200%201%200&top=3");
    let live = live["pages"][0]["hits"].as_array().unwrap();
    for (hit, live) in of_scene["hits"].as_array().unwrap().iter().zip(live) {
        assert!(hit["agreement"] == asked(live));
        assert!(hit.get("ask").is_none());
    }
}

#[test]
fn what_is_no_result_is_refused_with_its_place() {
    let dir = tempfile::tempdir().unwrap();
    let refused = |content: &str| {
        let path = dir.path().join("found.json");
        fs::write(&path, content).unwrap();
        let run = motif(&[
            "report",
            text(&path),
            "-o",
            text(&dir.path().join("out.html")),
        ]);
        assert_eq!(run.code, 3, "{run:?}");
        run.stderr
    };
    let told = refused("{\"command\": \"search\",\n \"result\": 7}");
    assert!(told.contains("found.json:2:"), "{told}");
    assert!(refused("{\"command\": \"info\"}").contains("expected what search"));
    assert!(!dir.path().join("out.html").exists());
}

#[test]
fn a_name_stays_a_name() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("x<");
    fs::create_dir(&folder).unwrap();
    let evil = folder.join("script><img src=x onerror=alert(1)>.amc");
    let walk = Fixture::get().clip("anna", Class::Walk);
    let asf = fs::read_dir(walk.parent().unwrap()).unwrap();
    let asf = asf.map(|entry| entry.unwrap().path());
    let mut asf = asf.filter(|path| path.extension().is_some_and(|e| e == "asf"));
    fs::copy(asf.next().unwrap(), folder.join("only.asf")).unwrap();
    fs::copy(&walk, &evil).unwrap();
    let (html, document) = report(&[&evil], &[]);
    assert_eq!(document["clips"][0]["name"], text(&evil));
    assert!(!html.contains("<img"));
    assert_eq!(html.matches("</script>").count(), 2);
}

#[test]
fn templates_label_the_clips_given_with_them() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let squat = fixture.clip("anna", Class::Squat);
    let template = dir.path().join("squat.mtpl");
    let run = motif(&["learn", text(&squat), "-o", text(&template)]);
    assert_eq!(run.code, 0, "{run:?}");
    let (_, document) = report(&[&squat, &template], &[]);
    assert_eq!(kinds(&document), ["clip", "annotation", "template"]);
    let track = &document["pages"][1]["tracks"][0];
    assert_eq!(track["label"], "squat");
    // What was learned from this one clip fits it without any cost.
    assert_eq!(track["spans"][0]["cost"], 0.0);
    let curve = &track["curve"];
    assert!(curve["image"].as_str().unwrap().starts_with("<svg"));
    assert_eq!(curve["values"]["of"], "curve");
    let y = curve["values"]["y"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_f64);
    assert_eq!(y.fold(1.0, f64::min), 0.0);
    assert_eq!(document["pages"][2]["examples"], 1);

    let run = motif(&[
        "annotate",
        text(&squat),
        "--templates",
        text(&template),
        "--json",
    ]);
    let found = dir.path().join("found.json");
    fs::write(&found, run.json().to_string()).unwrap();
    let (_, told) = report(&[&found], &[]);
    let told = &told["pages"][0]["tracks"][0];
    assert!(track["tau"].is_number());
    for field in ["label", "tau", "spans"] {
        assert_eq!(told[field], track[field], "{field}");
    }
}

#[test]
fn bundles_are_a_graph_with_walks() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let model = dir.path().join("walks.mbg");
    let (walk, jog) = (
        fixture.clip("eva", Class::Walk),
        fixture.clip("eva", Class::Jog),
    );
    let run = motif(&[
        "bundle",
        text(&walk),
        text(&jog),
        "--kappa",
        "20",
        "-o",
        text(&model),
    ]);
    assert_eq!(run.code, 0, "{run:?}");
    let (_, document) = report(&[&model], &[]);
    assert_eq!(kinds(&document), ["bundles"]);
    let page = &document["pages"][0];
    let svg = page["svg"].as_str().unwrap();
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>") && !svg.contains("style="));
    for node in page["nodes"].as_array().unwrap() {
        let id = node["id"].as_str().unwrap();
        assert!(svg.contains(&format!("<g class=\"node\" data-bundle=\"{id}\">")));
        assert_eq!(node["spans"].as_array().unwrap().len(), node["height"]);
        for next in node["next"].as_array().unwrap() {
            let next = next.as_str().unwrap();
            assert!(svg.contains(&format!("data-from=\"{id}\" data-to=\"{next}\"")));
        }
    }
    let walks = page["walks"].as_array().unwrap();
    assert_eq!(walks.len(), 2);
    for walk in walks {
        let clip = &document["clips"][walk["clip"].as_u64().unwrap() as usize];
        assert!(clip["motion"]["frames"].as_u64().unwrap() > 0);
        assert_eq!(walk["path"][0]["start_s"], 0.0);
    }
}
