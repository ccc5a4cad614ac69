use super::*;

#[test]
fn every_builtin_set_reads() {
    for name in BUILTIN_SETS {
        let text = FeatureSet::builtin_toml(name).unwrap();
        let set = FeatureSet::from_toml(text).unwrap_or_else(|e| panic!("{name}:{e}"));
        assert_eq!(set.name(), name);
        assert_eq!(set.features().len(), 39);
        assert_eq!(set.all(), (1 << 39) - 1);
    }
    assert_eq!(FeatureSet::builtin("mueller1906"), None);
}
