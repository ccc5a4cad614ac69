/// What a warning's code means, for people who meet it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Explanation {
    /// Such as `BVH012`.
    pub code: &'static str,
    /// One line.
    pub title: &'static str,
    /// What the reader found, why files are like that, and what was done about it.
    pub meaning: &'static str,
    /// What the user can do.
    pub remedy: &'static str,
}

const FORMATS: [&[Explanation]; 3] = [
    crate::bvh::EXPLANATIONS,
    crate::acclaim::EXPLANATIONS,
    crate::c3d::EXPLANATIONS,
];

/// The explanations of all codes, by format and number.
pub fn explanations() -> impl Iterator<Item = &'static Explanation> {
    FORMATS.into_iter().flatten()
}

/// What `code`, in any case, means; `None` if there is no such code.
#[must_use]
pub fn explain(code: &str) -> Option<&'static Explanation> {
    explanations().find(|e| e.code.eq_ignore_ascii_case(code.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_unique_and_every_entry_says_something() {
        let mut codes: Vec<&str> = explanations().map(|e| e.code).collect();
        codes.sort_unstable();
        assert!(codes.windows(2).all(|pair| pair[0] < pair[1]), "{codes:?}");
        for e in explanations() {
            assert!(![e.title, e.meaning, e.remedy].contains(&""), "{}", e.code);
        }
    }

    #[test]
    fn a_code_is_found_in_any_case() {
        assert_eq!(explain(" bvh012 ").unwrap().code, "BVH012");
        assert_eq!(explain("BVH"), None);
    }
}
