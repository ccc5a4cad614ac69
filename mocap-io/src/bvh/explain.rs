use crate::Explanation;

/// By number.
pub(crate) const EXPLANATIONS: &[Explanation] = &[
    Explanation {
        code: "BVH001",
        title: "a keyword line is missing",
        meaning: "The line HIERARCHY before the first ROOT, or the line MOTION before Frames:, is not there. What follows was read as if it were.",
        remedy: "Add the line if other programs refuse the file.",
    },
    Explanation {
        code: "BVH002",
        title: "a comment",
        meaning: "BVH has no comments, but people and scripts write them behind # or //. The text up to the end of the line was skipped.",
        remedy: "Remove the comment if other programs refuse the file.",
    },
    Explanation {
        code: "BVH003",
        title: "two numbers without a blank between them",
        meaning: "Some exporters print numbers in columns of a fixed width, so that a minus sign can touch the number before it (0.0-7.5). They were read as two numbers.",
        remedy: "Compare the pose in that frame with what you expect; nothing else is needed.",
    },
    Explanation {
        code: "BVH004",
        title: "text that BVH does not have",
        meaning: "Before the hierarchy, between MOTION and the first row, behind the frame time or behind the last row there is text that is no part of the format. It was skipped; no number was.",
        remedy: "Check that the text does not say anything that matters, such as another rate.",
    },
    Explanation {
        code: "BVH005",
        title: "commas in or between numbers",
        meaning: "Programs in countries with a decimal comma write 1,5 for 1.5; spreadsheets write commas between numbers. If the file has no points in its numbers, a comma between two digits was read as a decimal point, otherwise as a blank.",
        remedy: "Compare a pose with what you expect, or export the file again with points and blanks.",
    },
    Explanation {
        code: "BVH006",
        title: "no-break spaces",
        meaning: "The file has no-break spaces, as text copied from a web page has. They were read as blanks.",
        remedy: "None is needed; replace them if other programs refuse the file.",
    },
    Explanation {
        code: "BVH007",
        title: "a wrong number of channels",
        meaning: "CHANNELS says another number than names follow. The names decide; the rows must have as many values.",
        remedy: "Correct the number if other programs refuse the file.",
    },
    Explanation {
        code: "BVH008",
        title: "a keyword appears twice",
        meaning: "A joint has OFFSET or CHANNELS twice, or the motion has Frames: or Frame Time: twice. The last OFFSET, Frames or Frame Time counts; lists of channels were joined.",
        remedy: "Look at the joint; if the file was edited by hand, a line was left over.",
    },
    Explanation {
        code: "BVH009",
        title: "a joint without OFFSET",
        meaning: "The joint or End Site does not say where it is. It was put where its parent is.",
        remedy: "Add the OFFSET if the bone should have a length.",
    },
    Explanation {
        code: "BVH010",
        title: "closing braces are missing",
        meaning: "The hierarchy ends before every joint is closed. The joints were closed before MOTION; if the brace is missing further up, joints hang on the wrong parent.",
        remedy: "Compare the hierarchy with what you expect.",
    },
    Explanation {
        code: "BVH011",
        title: "a closing brace too many",
        meaning: "There is a closing brace where no joint is open. It was skipped.",
        remedy: "Compare the hierarchy with what you expect.",
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
    Explanation {
        code: "BVH014",
        title: "the number of frames is not said",
        meaning: "There is no line Frames:, or no whole number behind it. The rows were counted.",
        remedy: "None is needed, unless the file was cut off.",
    },
    Explanation {
        code: "BVH015",
        title: "no frame time",
        meaning: "There is no line Frame Time:, or no number behind it, so the rate is unknown. 30 frames per second were assumed.",
        remedy: "Say the rate, such as --rate 120.",
    },
    Explanation {
        code: "BVH016",
        title: "a frame time that cannot be meant",
        meaning: "The frame time is zero, negative, longer than a second or shorter than 0.1 ms: nobody records movement like that. It may be a rate, or a time in milliseconds. 30 frames per second were assumed.",
        remedy: "Say the rate, such as --rate 120.",
    },
    Explanation {
        code: "BVH017",
        title: "frames and lines do not agree",
        meaning: "Frames go on over several lines, or lines hold several frames. The values were taken in order, since frames and lines begin together or the number of values is right.",
        remedy: "Compare a pose with what you expect.",
    },
    Explanation {
        code: "BVH018",
        title: "scale channels",
        meaning: "Joints have channels such as Xscale, which stretch them. They were left out.",
        remedy: "Export the file without scale if the figure is stretched; otherwise none is needed.",
    },
    Explanation {
        code: "BVH019",
        title: "two joints with one name",
        meaning: "Two joints of one figure have the same name. Both were read; whatever looks for the name finds the first.",
        remedy: "Rename one of them if features need it.",
    },
    Explanation {
        code: "BVH020",
        title: "no motion",
        meaning: "The file ends behind its hierarchy. The skeleton was read, with no frames.",
        remedy: "Export the file again if it should move.",
    },
];
