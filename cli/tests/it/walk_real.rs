//! `motif walk` on real clips.

use std::path::PathBuf;

use crate::command::{motif, text};
use crate::jumps::Steps;
use crate::real::data;
use crate::walk::{motion, result};

/// Walks straight on, veering and turning to both sides.
const TRIALS: std::ops::RangeInclusive<usize> = 11..=24;

#[test]
fn real_walks_do_not_jump_and_locked_feet_skate_less() {
    let Some(data) = data() else { return };
    let clips = TRIALS.map(|trial| data.join(format!("cmu/16/16_{trial:02}.amc")));
    let clips: Vec<PathBuf> = clips.collect();
    let dir = tempfile::tempdir().unwrap();
    let (model, output) = (dir.path().join("16.mbg"), dir.path().join("walk.amc"));
    let mut args = vec!["bundle"];
    args.extend(clips.iter().map(|clip| text(clip)));
    args.extend(["--kappa", "90", "-o", text(&model), "--quiet"]);
    let made = motif(&args);
    assert_eq!(made.code, 0, "{made:?}");
    let sources: Vec<Steps> = clips.iter().map(|clip| Steps::of(&motion(clip))).collect();
    for seed in ["1", "2", "3"] {
        let way = [
            "--random",
            "12",
            "--seed",
            seed,
            "-o",
            text(&output),
            "--json",
        ];
        let args = [&["walk", text(&model)], &way[..]].concat();
        result(&motif(&args));
        let ratio = Steps::of(&motion(&output)).assert_no_jump(&sources);
        let locked = result(&motif(&[&args[..], &["--footlock"]].concat()));
        let locked_ratio = Steps::of(&motion(&output)).assert_no_jump(&sources);
        let [before, after] =
            ["skate_before", "skate_after"].map(|key| locked[key].as_f64().unwrap());
        println!(
            "seed {seed}: bundles {}, {:.1} s, steps up to {ratio:.2} of the takes', {locked_ratio:.2} locked; \
            skate {before:.3} m/s, {after:.3} m/s locked",
            locked["bundles"],
            locked["seconds"].as_f64().unwrap()
        );
        assert!(after < before, "{after} of {before}");
    }
}
