use crate::Explanation;

/// By number.
pub(crate) const EXPLANATIONS: &[Explanation] = &[
    Explanation {
        code: "BVH003",
        title: "two numbers without a blank between them",
        meaning: "Some exporters print numbers in columns of a fixed width, so that a minus sign can touch the number before it (0.0-7.5). They were read as two numbers.",
        remedy: "Compare the pose in that frame with what you expect; nothing else is needed.",
    },
    Explanation {
        code: "BVH012",
        title: "the header's frame count is wrong",
        meaning: "The line Frames: says another number than there are rows. The rows decide.",
        remedy: "If the file should be longer, it was cut off: export it again.",
    },
    Explanation {
        code: "BVH013",
        title: "the file ends within a row",
        meaning: "The last row has fewer values than the skeleton has channels, as if writing had been interrupted. The row was dropped.",
        remedy: "Export the file again if the end matters.",
    },
];
