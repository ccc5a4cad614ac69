//! The parts of a feature set, each of which has an index of its own in a library (2005 paper, section
//! 6.1: I_ℓ, I_u and I_m).

use relfeat::FeatureSet;

/// Name and bits of each part, in the order of their first features. A set of one part has none: the
/// index of all features is its index.
pub(super) fn parts(set: &FeatureSet) -> Vec<(String, u64)> {
    let mut parts: Vec<(String, u64)> = Vec::new();
    for (i, feature) in set.features().iter().enumerate() {
        match parts.iter_mut().find(|(name, _)| *name == feature.set) {
            Some((_, bits)) => *bits |= 1 << i,
            None => parts.push((feature.set.clone(), 1 << i)),
        }
    }
    if parts.len() == 1 {
        parts.clear();
    }
    parts
}

/// The file of a shard.
pub(super) fn shard_file(number: u32) -> String {
    format!("{number:04}.shard")
}

/// The file of a part of a shard. A set's author may call a part anything: small letters and digits
/// stand for themselves, all other bytes are written out, so that no two parts share a file where
/// capitals do not count, and none lies in another folder.
pub(super) fn part_file(number: u32, part: &str) -> String {
    let mut file = format!("{number:04}-");
    for byte in part.bytes() {
        match byte {
            b'a'..=b'z' | b'0'..=b'9' => file.push(char::from(byte)),
            other => file.push_str(&format!("_{other:02x}")),
        }
    }
    file + ".shard"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_tile_the_features() {
        for name in relfeat::BUILTIN_SETS {
            let set = FeatureSet::builtin(name).unwrap();
            let parts = parts(&set);
            let names: Vec<&str> = parts.iter().map(|(name, _)| name.as_str()).collect();
            assert_eq!(names.len(), 3, "{name}: {names:?}");
            assert_eq!(parts.iter().map(|(_, bits)| bits).sum::<u64>(), set.all());
            for (part, bits) in &parts {
                assert_eq!(set.select(part), Some(*bits), "{name}: {part}");
            }
        }
    }

    #[test]
    fn a_set_of_one_part_is_that_part() {
        let text = FeatureSet::builtin_toml("mueller2005").unwrap();
        let text = ["lower", "upper", "mix"]
            .iter()
            .fold(text.to_owned(), |text, part| {
                text.replace(&format!("set = \"{part}\""), "set = \"all\"")
            });
        let set = FeatureSet::from_toml(&text).unwrap();
        assert_eq!(set.select("all"), Some(set.all()));
        assert_eq!(parts(&set), []);
    }

    #[test]
    fn files_of_parts_differ_and_stay_in_their_folder() {
        assert_eq!(part_file(7, "upper"), "0007-upper.shard");
        assert_eq!(part_file(7, "Upper"), "0007-_55pper.shard");
        assert_eq!(part_file(12345, "../a_b"), "12345-_2e_2e_2fa_5fb.shard");
        assert_eq!(shard_file(7), "0007.shard");
    }
}
