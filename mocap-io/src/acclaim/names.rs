use std::collections::HashMap;

/// Finds bones by name.
pub(super) struct Names {
    exact: HashMap<String, usize>,
    /// By name in lower case; `None` where several bones have it.
    folded: HashMap<String, Option<usize>>,
}

impl Names {
    pub(super) fn new<'n>(names: impl Iterator<Item = &'n str>) -> Self {
        let (mut exact, mut folded) = (HashMap::new(), HashMap::new());
        for (bone_idx, name) in names.enumerate() {
            exact.entry(name.to_owned()).or_insert(bone_idx);
            folded
                .entry(name.to_lowercase())
                .and_modify(|bone| *bone = None)
                .or_insert(Some(bone_idx));
        }
        Names { exact, folded }
    }

    pub(super) fn find_exact(&self, name: &str) -> Option<usize> {
        self.exact.get(name).copied()
    }

    /// The bone that differs from `name` in letter case alone, if there is just one.
    pub(super) fn find_folded(&self, name: &str) -> Option<usize> {
        self.folded.get(&name.to_lowercase()).copied().flatten()
    }
}
