use super::*;
use crate::picture::scene::State;

fn names() -> Vec<String> {
    ["first", "second", "third"].map(str::to_owned).to_vec()
}

fn panel(rows: Vec<Vec<Cell>>, segments: &[usize]) -> Panel {
    let starts = segments.iter().copied();
    let ends = segments.iter().skip(1).copied();
    Panel {
        captions: vec!["1: a.bvh".to_owned(), "frames 0-3".to_owned()],
        segments: starts.zip(ends).map(|(start, end)| start..end).collect(),
        rows,
    }
}

fn picture(panels: &[Panel]) -> Image {
    agreement_sheet(&Sheet {
        title: "squat.amc",
        names: &names(),
        panels,
        rate: 30.0,
    })
}

fn pixel(image: &Image, [x, y]: [usize; 2]) -> Rgb {
    let start = (y * image.width + x) * 3;
    [0, 1, 2].map(|channel| image.pixels[start + channel])
}

/// Where the first row of the first panel begins.
fn corner(n_captions: usize) -> [usize; 2] {
    let legend = MARGIN + font::HEIGHT * TITLE_SCALE + 12 + 3 * LINE;
    let names = MARGIN + font::width("second", 1) + 8;
    [names, legend + n_captions * LINE + LINE + 2]
}

#[test]
fn cells_have_their_colours_and_compared_features_stand_first() {
    use Cell::{Alike, Different, Equal, Unknown, Unlike};
    let rows = vec![
        vec![Alike, Unlike, Unlike],
        vec![Equal, Equal, Different],
        vec![Unknown; 3],
    ];
    let image = picture(&[panel(rows.clone(), &[0, 2, 3])]);
    let [left, top] = corner(2);
    // Rows from the top: the second feature is compared, the others are masked.
    let order = [(1, 0), (0, ROW + GROUP_GAP), (2, 2 * ROW + GROUP_GAP)];
    for (feature, y) in order {
        for (word, cell) in rows[feature].iter().enumerate() {
            let borders = usize::from(word >= 2) * BORDER;
            let x = left + word * WIDEST_WORD + borders;
            for at in [[x, top + y], [x + WIDEST_WORD - 1, top + y + 2]] {
                assert_eq!(pixel(&image, at), cell.colour(), "{feature} {word}");
            }
        }
    }
    let border = left + 2 * WIDEST_WORD + 1;
    assert_eq!(pixel(&image, [border, top]), TEXT);
    for beside in [border - 1, border + 1] {
        assert_eq!(pixel(&image, [beside, top]), [u8::MAX; 3]);
    }
    // What differs has a white line, too.
    let middle = left + 2 * WIDEST_WORD + BORDER;
    assert_eq!(pixel(&image, [middle, top + ROW / 2 - 1]), [u8::MAX; 3]);
}

/// Relative luminance as the sRGB standard (IEC 61966-2-1) and WCAG 2 have it, 0 to 1.
fn luminance(colour: Rgb) -> f64 {
    let linear = |value: u8| {
        let value = f64::from(value) / 255.0;
        match value {
            v if v <= 0.04045 => v / 12.92,
            v => ((v + 0.055) / 1.055).powf(2.4),
        }
    };
    let [r, g, b] = colour.map(linear);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// CIE lightness, 0 to 100.
fn lightness(colour: Rgb) -> f64 {
    116.0 * luminance(colour).cbrt() - 16.0
}

/// Steps of lightness that neighbouring areas are told apart by at a glance: a just noticeable one is about 1.
const LEAST_STEP: f64 = 8.0;

#[test]
fn cells_can_be_told_apart_without_seeing_colours() {
    let cells = Cell::ALL.map(Cell::colour).to_vec();
    let states = State::ALL.map(State::colour).to_vec();
    for colours in [cells, states] {
        let mut all: Vec<f64> = colours.into_iter().map(lightness).collect();
        all.sort_by(f64::total_cmp);
        for pair in all.windows(2) {
            assert!(pair[1] - pair[0] >= LEAST_STEP, "{all:?}");
        }
    }
}

#[test]
fn pictures_stay_small_however_long_hits_are() {
    let n = 100_000;
    let long = panel(vec![vec![Cell::Equal; n]; 3], &[0, n / 3, n]);
    let image = picture(&vec![long; 12]);
    assert!(image.width < SHEET_WIDTH + 200, "{}", image.width);
    assert_eq!(image.pixels.len(), image.width * image.height * 3);
}

#[test]
fn panels_stand_side_by_side_as_long_as_there_is_room() {
    let one = panel(vec![vec![Cell::Equal; 60]; 3], &[0, 60]);
    let sizes = [1, 2, 3, 4, 5].map(|n| {
        let image = picture(&vec![one.clone(); n]);
        (image.width, image.height)
    });
    let row = sizes[0].1;
    assert_eq!(sizes[1].1, row);
    assert_eq!(sizes[3].1, row);
    assert!(sizes[4].1 > row && sizes[4].0 <= SHEET_WIDTH + MARGIN);
}

#[test]
fn nothing_at_all_is_a_picture_too() {
    let empty = Panel {
        captions: Vec::new(),
        segments: Vec::new(),
        rows: Vec::new(),
    };
    for panels in [vec![], vec![empty]] {
        let image = agreement_sheet(&Sheet {
            title: "",
            names: &[],
            panels: &panels,
            rate: 30.0,
        });
        assert!(image.to_png().is_ok());
    }
}
