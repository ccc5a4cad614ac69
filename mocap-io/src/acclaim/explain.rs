use crate::Explanation;

/// By number.
pub(crate) const EXPLANATIONS: &[Explanation] = &[
    Explanation {
        code: "ASF001",
        title: "a bone outside the hierarchy",
        meaning: "The bone is defined, but no line of :hierarchy connects it to the root, so it has no place. It was left out.",
        remedy: "Add the bone to :hierarchy if it belongs to the figure.",
    },
    Explanation {
        code: "ASF002",
        title: "an unknown section",
        meaning: "The file has a section that the Acclaim format does not have. It was skipped.",
        remedy: "None is needed if the section only holds notes of a program.",
    },
    Explanation {
        code: "AMC001",
        title: "the file ends within a frame",
        meaning: "The last frame lacks bones or values, as if writing had been interrupted. Whole frames were kept.",
        remedy: "Export the file again if the end matters.",
    },
    Explanation {
        code: "AMC002",
        title: "a bone that never moves",
        meaning: "The skeleton gives this bone degrees of freedom, but no frame has values for it. It keeps its rest pose.",
        remedy: "Check that the motion belongs to this skeleton.",
    },
    Explanation {
        code: "AMC003",
        title: "frame numbers do not count up by one",
        meaning: "Frames were taken in file order, whatever their numbers say.",
        remedy: "Check whether frames were cut out or the file was put together from several.",
    },
    Explanation {
        code: "AMC004",
        title: "an unknown keyword",
        meaning: "The header has a keyword that the AMC format does not have. It was skipped.",
        remedy: "None is needed if the keyword only holds notes of a program.",
    },
    Explanation {
        code: "AMC005",
        title: "skeleton and motion disagree about degrees and radians",
        meaning: "The ASF names one angle unit, the AMC another. The motion's own word was used for its values.",
        remedy: "Look at the motion; if it trembles or hardly moves, correct the word in the AMC.",
    },
];
