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
        code: "ASF003",
        title: "a unit is not said",
        meaning: "The section :units is missing, or its length or angle. Inches and degrees were assumed, as the format says.",
        remedy: "Compare the size of the figure with a person, and say the unit if it differs.",
    },
    Explanation {
        code: "ASF004",
        title: "an unknown keyword",
        meaning: "A bone, the root or the units have a keyword that the Acclaim format does not have. The line was skipped.",
        remedy: "None is needed if the keyword only holds notes of a program; check the spelling otherwise.",
    },
    Explanation {
        code: "ASF005",
        title: "a bone without length",
        meaning: "The bone does not say its length. Zero was used, so the bone ends where it begins.",
        remedy: "Add the length.",
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
    Explanation {
        code: "AMC006",
        title: "a name in other letter case",
        meaning: "A bone is written in other upper and lower case than where it is defined, and no other bone fits. It was taken for that bone.",
        remedy: "None is needed; write both alike if other programs refuse the file.",
    },
    Explanation {
        code: "TXT001",
        title: "more warnings than are listed",
        meaning: "The file is odd throughout. A thousand warnings are listed, the rest is counted.",
        remedy: "Look at the first ones; the rest is probably alike.",
    },
];
