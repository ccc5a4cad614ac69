//! What the options of `motif bundle` change.

use std::path::{Path, PathBuf};

use bundles::{Closure, LabelRule, SeedInstance};
use cli::bundling::{Bundled, Poses, load, smoothed};
use cli::recording::ReadOptions;
use cli::source::ClipRef;

use crate::bundle::{Made, bundle, clips};
use crate::command::{motif, text};

fn poses(path: &Path) -> Poses {
    let path = path.to_owned();
    Poses::read(&ClipRef { path, span: None }, &ReadOptions::default()).unwrap()
}

/// A model of all clips, with as many letters as the method says.
fn automatic(name: &str, more: &[&str]) -> Bundled {
    let file = Made::get().file(name);
    let clips = clips();
    let mut args = vec!["bundle", "--quiet", "-o", text(&file)];
    args.extend(more);
    args.extend(clips.iter().map(|clip| text(clip)));
    let run = motif(&args);
    assert!(run.code < 2, "{run:?}");
    load(&file).unwrap()
}

#[test]
fn letters_are_poses_six_a_second_and_no_seed_changes_them() {
    const PER_SECOND: f64 = 6.0;
    const SECONDS: f64 = 0.1;
    let model = automatic("steady.mbg", &[]);
    assert_eq!(model.model.options().closure, Closure::Direct);
    assert_eq!(model.model.options().seed, SeedInstance::Largest);
    let other = automatic("steady-7.mbg", &["--method", "steady", "--seed", "7"]);
    assert_eq!(model.clusters, other.clusters);
    assert_eq!(model.model.string(), other.model.string());

    let clips: Vec<Poses> = clips().iter().map(|clip| poses(clip)).collect();
    let n_frames: usize = clips.iter().map(|poses| poses.vectors.nrows()).sum();
    let per_letter = n_frames as f64 / model.clusters.n_letters() as f64;
    let expected = clips[0].rate / PER_SECOND;
    assert!(
        (per_letter - expected).abs() < 1.0,
        "{per_letter} frames each"
    );
    let mut rows = Vec::new();
    for poses in &clips {
        let smooth = smoothed(poses.vectors.view(), SECONDS * poses.rate);
        let reduced = model.pca.project(smooth.view()).unwrap();
        rows.extend(reduced.rows().into_iter().map(|row| row.to_vec()));
    }
    // Clips are smoothed apart, as they were when the letters were chosen.
    for mean in model.clusters.means().rows() {
        assert!(rows.contains(&mean.to_vec()), "{mean}");
    }
}

/// The criterion is that of a mixture of the same poses, whatever the letters then are.
#[test]
fn auto_is_what_the_criterion_says_by_both_methods() {
    let steady = automatic("auto.mbg", &["--kappa", "auto"]);
    let sigmas = steady.clusters.sigmas();
    assert!(sigmas.iter().all(|sigma| *sigma == sigmas[0]));
    let mixture = ["--method", "paper", "--smooth", "0.1"];
    let paper = automatic("auto-paper.mbg", &mixture);
    assert_eq!(steady.clusters.n_letters(), paper.clusters.n_letters());
    let given = automatic(
        "auto-given.mbg",
        &[&mixture[..], &["--kappa", "auto"]].concat(),
    );
    assert_eq!(given.clusters, paper.clusters);
}

#[test]
fn the_method_sets_what_is_not_given() {
    let paper = automatic("paper.mbg", &["--method", "paper", "--seed", "7"]);
    assert_eq!(paper.model.options().closure, Closure::Transitive);
    assert_eq!(paper.model.options().seed, SeedInstance::Random(7));
    assert_eq!(paper.settings.smooth.to_bits(), 0.0_f64.to_bits());
    // Each letter of a mixture has a deviation of its own.
    let sigmas = paper.clusters.sigmas();
    assert!(sigmas.iter().any(|sigma| *sigma != sigmas[0]));

    let own = ["--closure", "direct", "--from", "all", "--smooth", "0.05"];
    let own = automatic("own.mbg", &[&["--method", "paper"], &own[..]].concat());
    assert_eq!(own.model.options().closure, Closure::Direct);
    assert_eq!(own.model.options().seed, SeedInstance::Largest);
    assert_eq!(own.settings.smooth.to_bits(), 0.05_f64.to_bits());
    let sigmas = own.clusters.sigmas();
    assert!(sigmas.iter().any(|sigma| *sigma != sigmas[0]));

    let old = Made::get().file("paper.mbg");
    let more = ["--add", text(&old), "--method", "steady"];
    let run = bundle(&clips(), &Made::get().file("x.mbg"), &more);
    assert_eq!(run.code, 2, "{run:?}");
}

#[test]
fn near_is_a_multiple_of_the_threshold_and_stays_with_the_model() {
    let made = Made::get();
    let [first, second] = &clips()[..] else {
        panic!("two clips");
    };
    let clip = std::slice::from_ref(first);
    let model = |name: &str, clips: &[PathBuf], more: &[&str]| {
        let file = made.file(name);
        let run = bundle(clips, &file, more);
        assert!(run.code < 2, "{run:?}");
        load(&file).unwrap()
    };
    let one = model("near-1.mbg", clip, &[]);
    let two = model("near-2.mbg", clip, &["--near", "2"]);
    assert!(one.settings.tau > 0.0);
    // A factor of two is exact.
    assert_eq!(
        two.settings.tau.to_bits(),
        (2.0 * one.settings.tau).to_bits()
    );
    let bundled = |of: &Bundled| {
        let bundles = of.model.graph().bundles().iter();
        let spans = bundles.flat_map(|bundle| &bundle.submotions);
        spans.map(|submotion| submotion.span.len()).sum::<usize>()
    };
    assert!(bundled(&two) > bundled(&one));
    let old = made.file("near-2.mbg");
    let more = model(
        "near-more.mbg",
        std::slice::from_ref(second),
        &["--add", text(&old)],
    );
    assert_eq!(more.settings.tau.to_bits(), two.settings.tau.to_bits());
    let wrong = bundle(clip, &made.file("x.mbg"), &["--near", "-1"]);
    assert_eq!(wrong.code, 2, "{wrong:?}");
}

#[test]
fn smoothed_poses_give_the_letters_of_old_and_added_clips() {
    const SECONDS: f64 = 0.2;
    let made = Made::get();
    let (old, new) = (made.file("smooth-old.mbg"), made.file("smooth-new.mbg"));
    let [first, second] = &clips()[..] else {
        panic!("two clips");
    };
    let more = ["--smooth", "0.2", "--from", "frequent", "--seed", "7"];
    let first_clip = std::slice::from_ref(first);
    // Whether there are bundles or not, there is a model.
    assert!(bundle(first_clip, &old, &more).code < 2);
    let run = bundle(std::slice::from_ref(second), &new, &["--add", text(&old)]);
    assert!(run.code < 2, "{run:?}");
    let model = load(&new).unwrap();
    assert_eq!(model.model.options().seed, SeedInstance::Random(7));
    let mut labels = Vec::new();
    for path in [first, second] {
        let poses = poses(path);
        let smooth = smoothed(poses.vectors.view(), SECONDS * poses.rate);
        let reduced = model.pca.project(smooth.view()).unwrap();
        labels.extend(
            model
                .clusters
                .label(reduced.view(), LabelRule::Likelihood)
                .unwrap(),
        );
    }
    let runs = model.model.string().runs();
    assert!(runs.len() > 2 && runs.iter().any(|run| run.clip == 1));
    for run in runs {
        assert!(
            labels[run.frames.clone()]
                .iter()
                .all(|label| *label == run.letter.label())
        );
    }
}
