use crate::Explanation;

/// By number.
pub(crate) const EXPLANATIONS: &[Explanation] = &[
    Explanation {
        code: "C3D001",
        title: "unknown processor type",
        meaning: "The parameter section names a processor other than Intel, DEC and MIPS, so the order of bytes is not known. The one under which the header makes sense was taken.",
        remedy: "Look whether positions are sensible; if not, export the file again.",
    },
    Explanation {
        code: "C3D002",
        title: "no parameter section",
        meaning: "There are no parameters where the header says. The header alone gives counts, scale and rate; points have no labels and the unit is a guess.",
        remedy: "Export the file again, or name the unit yourself.",
    },
    Explanation {
        code: "C3D003",
        title: "the parameter section is broken",
        meaning: "Each parameter says where the next one is; at this byte that leads to nothing sensible. The parameters before were kept.",
        remedy: "Look whether labels, unit and rate are right.",
    },
    Explanation {
        code: "C3D004",
        title: "a parameter is longer than its record",
        meaning: "The sizes of a parameter ask for more bytes than there are before the next one. What is there was kept.",
        remedy: "Nothing, unless it is one that you need.",
    },
    Explanation {
        code: "C3D005",
        title: "parameters without a group",
        meaning: "Some parameters belong to a group that the file does not define. They were kept under an empty name.",
        remedy: "Nothing, unless they are some that you need.",
    },
    Explanation {
        code: "C3D006",
        title: "header and parameters disagree",
        meaning: "A number that stands in the header and in the parameters differs. For counts, scale and the place of the data, the one that accounts for the size of the file was taken, else the parameter.",
        remedy: "Look whether positions and rate are right; the rate can be given by hand.",
    },
    Explanation {
        code: "C3D007",
        title: "the number of frames is wrong",
        meaning: "The file says another number of frames than its size allows for, or says several. The number that accounts for the size was taken.",
        remedy: "Nothing, if the recording is complete.",
    },
    Explanation {
        code: "C3D008",
        title: "the file is cut off",
        meaning: "The file ends before its last frame does. Whole frames were kept.",
        remedy: "Copy or export the file again if the end matters.",
    },
    Explanation {
        code: "C3D009",
        title: "no usable scale",
        meaning: "The scale says by its sign whether numbers are integers or floats, and how long an integer's unit is. It is zero or no number, so the size of the file decided, and integers count as file units.",
        remedy: "Look whether the figure has the size of a person.",
    },
    Explanation {
        code: "C3D010",
        title: "no frame rate",
        meaning: "Neither the parameters nor the header name a frame rate.",
        remedy: "Give the rate by hand; times and speeds are wrong otherwise.",
    },
    Explanation {
        code: "C3D011",
        title: "unknown unit of length",
        meaning: "POINT:UNITS is not one of mm, cm, m and their like. The unit was guessed from the extent of the markers.",
        remedy: "Give the unit by hand if the figure has the wrong size.",
    },
    Explanation {
        code: "C3D012",
        title: "points without labels",
        meaning: "There are more points than labels. The others are called point and their number.",
        remedy: "Label the markers where the file was recorded; a rig cannot know them.",
    },
    Explanation {
        code: "C3D013",
        title: "a label appears twice",
        meaning: "Several points have the same label, as two people in one file without prefixes do. The later ones got a number: NAME_2.",
        remedy: "Check which is which before using either.",
    },
    Explanation {
        code: "C3D014",
        title: "zeros taken for missing markers",
        meaning: "The format marks missing points by a negative fourth word. Some writers put the point at 0 0 0 instead, or store the mark wrongly. Markers exactly at the origin that nothing measured count as missing.",
        remedy: "Nothing; a real marker is never exactly there.",
    },
    Explanation {
        code: "C3D015",
        title: "every point is marked invalid",
        meaning: "All points carry the mark of missing ones, yet have coordinates; SIMI Motion wrote such files. The coordinates were used and gaps cannot be told.",
        remedy: "Distrust points that jump or stay at one place.",
    },
    Explanation {
        code: "C3D016",
        title: "the vertical axis is not the one the file names",
        meaning: "POINT:Y_SCREEN says how the recording was looked at, which is usually the vertical. Feet on a floor and heads above say something else here, and clearly.",
        remedy: "Name the up axis by hand if the figure lies on its side or stands on its head.",
    },
    Explanation {
        code: "C3D017",
        title: "an event without a time",
        meaning: "An event is counted but its time is missing or no number. It was left out.",
        remedy: "Nothing, unless you need the event.",
    },
];
