//! Arbitrary text as a feature set and as a rig. What is read can be used on a small motion.

#![no_main]

use libfuzzer_sys::fuzz_target;
use relfeat::ndarray::Array3;
use relfeat::{BodyMap, BodyPoint, ConfigError, FeatureSet, Rig, extract, measure};

const N_FRAMES: usize = 5;

fuzz_target!(|text: &str| {
    let names: Vec<&str> = BodyPoint::ALL.iter().map(|p| p.name()).collect();
    match FeatureSet::from_toml(text) {
        Ok(set) => {
            let points: String = names.iter().map(|n| format!("{n} = [\"{n}\"]\n")).collect();
            let rig =
                Rig::from_toml(&format!("name = \"plain\"\n[points]\n{points}")).expect("a rig");
            check(&set, &BodyMap::with_rig(&names, &rig));
        }
        Err(error) => check_error(text, &error),
    }
    match Rig::from_toml(text) {
        Ok(rig) => {
            let set = FeatureSet::builtin("mueller2006").expect("the default set");
            check(&set, &BodyMap::with_rig(&names, &rig));
        }
        Err(error) => check_error(text, &error),
    }
});

fn check(set: &FeatureSet, map: &BodyMap) {
    // Some points move, some coincide, one is missing for a while.
    let mut positions =
        Array3::from_shape_fn((N_FRAMES, BodyPoint::COUNT, 3), |(frame, point, axis)| {
            (point / 2) as f32 * 0.1 + ((frame * point * (axis + 3)) % 7) as f32
        });
    positions[[2, 1, 0]] = f32::NAN;
    for rate in [30.0, 120.0] {
        let found =
            extract(set, positions.view(), map, rate, 30.0).expect("shape, map and rates fit");
        assert_eq!(found.words.len(), if rate == 30.0 { N_FRAMES } else { 2 });
        assert!(found.words.iter().all(|word| word & !set.all() == 0));
        for (feature_idx, feature) in set.features().iter().enumerate() {
            let is_available = found
                .unavailable
                .iter()
                .all(|u| u.feature_idx != feature_idx);
            let measured = measure(set, feature_idx, positions.view(), map, rate);
            assert_eq!(measured.is_some(), is_available);
            assert_eq!(set.features()[feature.mirror].mirror, feature_idx);
            assert_ne!(set.select(&feature.name).unwrap_or(0) >> feature_idx & 1, 0);
        }
    }
}

fn check_error(text: &str, error: &ConfigError) {
    assert!(error.line >= 1 && error.line <= text.matches('\n').count() + 1);
    assert!(error.column >= 1 && !error.to_string().is_empty());
}
