use mocap_io::Position;

/// Why a text is no scene description, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{at}: {kind}")]
pub struct SceneTextError {
    /// Where in the text.
    pub at: Position,
    /// What was expected and what was found.
    pub kind: SceneTextErrorKind,
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneTextErrorKind {
    /// Some other word was needed here.
    #[error("expected {expected}, found {found}")]
    Expected {
        /// What the syntax asks for.
        expected: &'static str,
        /// The word that is there.
        found: String,
    },
    /// A text of relations and comments alone.
    #[error("expected a line such as `rknee_bent : 0 1 0`, found none")]
    NoLines,
    /// A feature that the library's set lacks.
    #[error("{set} has no feature {found:?}{}; the nearest name is {nearest}",
        elsewhere.as_ref().map_or(String::new(), |set| format!(", but {set} has it (motif index --set {set})")))]
    UnknownFeature {
        /// The name as written.
        found: String,
        /// The library's feature set.
        set: String,
        /// The name of the set that is closest.
        nearest: String,
        /// A built-in set that has the feature.
        elsewhere: Option<&'static str>,
    },
    /// A part of the set where one feature belongs.
    #[error("expected one feature, found {found:?}, which names {n_features}")]
    ManyFeatures {
        /// The name as written.
        found: String,
        /// Features of that name.
        n_features: u32,
    },
    /// Two lines of one name.
    #[error(
        "expected another name than {name:?}, which line {first_line} has; `{name} as NAME : …` gives one"
    )]
    Twice {
        /// The name.
        name: String,
        /// Line of the text that has it, 1-based.
        first_line: usize,
    },
    /// A `*` between values.
    #[error(
        "expected 0 or 1 between values, found *, which would be one run with all of them; write two lines and `before`"
    )]
    Wildcard,
    /// A line of `*` alone.
    #[error("expected 0 or 1 somewhere in the line, found * alone, which every motion satisfies")]
    Unspecified,
    /// A relation to a line that does not exist.
    #[error("expected the name of a line, found {found:?}; the nearest is {nearest}")]
    UnknownLine {
        /// The name as written.
        found: String,
        /// The closest name of a line.
        nearest: String,
    },
    /// A relation to a position that does not exist.
    #[error("expected a position from 1 to {n_positions} of {name}, found {found}")]
    Position {
        /// The line's name.
        name: String,
        /// Number of its positions.
        n_positions: usize,
        /// As written.
        found: String,
    },
    /// A relation between runs of one line that their order contradicts.
    #[error("{relation} can never hold: the runs of {name} follow each other in order")]
    Never {
        /// `overlap` or `before`.
        relation: &'static str,
        /// The line's name.
        name: String,
    },
}
