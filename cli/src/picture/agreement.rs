//! Pictures of where hits of a search agree with what was looked for.

use std::ops::Range;

use super::canvas::{Canvas, Charted, Image, Rgb};
use super::font;
use super::heatmap::{Grid, ticks};

#[cfg(test)]
mod tests;

/// How a feature stands in a word of a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cell {
    /// Compared, and the same as in the query.
    Equal,
    /// Compared, and another one.
    Different,
    /// Not compared, yet the same.
    Alike,
    /// Not compared, and another one.
    Unlike,
    /// One of the rigs lacks the feature.
    Unknown,
}

/// A hit.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Lines above it.
    pub captions: Vec<String>,
    /// Words of each segment, from 0, each beginning where the one before ends.
    pub segments: Vec<Range<usize>>,
    /// Per feature as many cells as words.
    pub rows: Vec<Vec<Cell>>,
}

/// Hits side by side.
#[derive(Clone, Copy, Debug)]
pub struct Sheet<'a> {
    /// Above everything.
    pub title: &'a str,
    /// Of the features.
    pub names: &'a [String],
    /// In order.
    pub panels: &'a [Panel],
    /// Words per second.
    pub rate: f64,
}

impl Cell {
    /// In the order of the legend.
    pub const ALL: [Cell; 5] = [
        Cell::Equal,
        Cell::Different,
        Cell::Alike,
        Cell::Unlike,
        Cell::Unknown,
    ];

    /// Blue agrees, orange does not, strong is compared, pale is masked. Blue and orange differ for every kind of colour
    /// blindness, and all five differ in lightness.
    fn colour(self) -> Rgb {
        match self {
            Cell::Equal => [0x14, 0x45, 0x80],
            Cell::Different => [0xd0, 0x55, 0x00],
            Cell::Alike => [0xcf, 0xdf, 0xee],
            Cell::Unlike => [0xf2, 0xb2, 0x66],
            Cell::Unknown => [0xff, 0xff, 0xff],
        }
    }

    /// What it means.
    #[must_use]
    pub fn caption(self) -> &'static str {
        match self {
            Cell::Equal => "compared, equal",
            Cell::Different => "compared, different",
            Cell::Alike => "masked, alike",
            Cell::Unlike => "masked, unlike",
            Cell::Unknown => "not in the rig",
        }
    }

    /// Whether the feature was compared.
    #[must_use]
    pub fn is_compared(self) -> bool {
        matches!(self, Cell::Equal | Cell::Different)
    }
}

const TEXT: Rgb = [0x26, 0x2d, 0x38];
const FAINT: Rgb = [0x6f, 0x79, 0x87];
const MARGIN: usize = 18;
/// Pixels of a row, and how many of them are its distance from the next one.
const ROW: usize = 12;
const GAP: usize = 1;
/// Pixels between the features compared and the masked ones.
const GROUP_GAP: usize = 8;
/// Pixels of a segment's border: a line with as much room on both sides.
const BORDER: usize = 3;
/// Pixels of a line of text.
const LINE: usize = font::HEIGHT + 5;
/// Pixels of the title's dots.
const TITLE_SCALE: usize = 2;
/// A hit is made at most about this wide, in pixels, where its words allow, and a word at most as wide as this.
const PANEL_WIDTH: usize = 360;
const WIDEST_WORD: usize = 12;
/// Words of a hit that are drawn; of a longer one every second, third … word is.
const MOST_WORDS: usize = 1400;
/// Pixels between hits.
const APART: usize = 26;
/// Hits stand side by side up to this width, in pixels.
const SHEET_WIDTH: usize = 1600;

/// Hits as panels, a row per feature, a column per word. The features that are compared anywhere stand above the
/// others. White lines with a dark core are the borders of segments, whose numbers stand above; seconds of the hit below.
#[must_use]
pub fn agreement_sheet(sheet: &Sheet<'_>) -> Image {
    let rows = Rows::new(sheet);
    let drawn: Vec<Drawn<'_>> = sheet.panels.iter().map(Drawn::new).collect();
    let left = MARGIN + rows.name_width + 8;
    let mut places: Vec<[usize; 2]> = Vec::new();
    let n_captions = sheet.panels.iter().map(|p| p.captions.len()).max();
    let above = n_captions.unwrap_or(0) * LINE + LINE + 2;
    let height = above + rows.height() + 3 * LINE;
    let legend_top = MARGIN + font::HEIGHT * TITLE_SCALE + 12;
    let mut at = [left, legend_top + 3 * LINE];
    for panel in &drawn {
        if at[0] > left && at[0] + panel.room() > SHEET_WIDTH {
            at = [left, at[1] + height];
        }
        places.push(at);
        at[0] += panel.room() + APART;
    }
    let right = places
        .iter()
        .zip(&drawn)
        .map(|(at, panel)| at[0] + panel.room());
    let legend_width: usize = Cell::ALL.into_iter().map(legend_room).sum();
    let width = [
        right.max().unwrap_or(0),
        MARGIN + font::width(sheet.title, TITLE_SCALE),
        MARGIN + legend_width,
    ];
    let width = width.into_iter().max().unwrap_or(0) + MARGIN;
    let mut canvas = Canvas::new(width, at[1] + height);
    font::write(&mut canvas, sheet.title, [MARGIN; 2], TITLE_SCALE, TEXT);
    legend(&mut canvas, [MARGIN, legend_top]);
    for (panel, &[x, y]) in drawn.iter().zip(&places) {
        if x == left {
            rows.write_names(&mut canvas, y + above);
        }
        panel.paint(&mut canvas, [x, y], above, &rows);
        panel.paint_ticks(&mut canvas, [x, y + above + rows.height()], sheet.rate);
    }
    canvas.into_image()
}

/// One hit, its rows in the given order: a column per word, `rate` of them a second.
#[must_use]
pub fn agreement_chart(names: &[String], rows: &[Vec<Cell>], rate: f64) -> Charted {
    let grid = Grid {
        captions: names.to_vec(),
        n_columns: rows.first().map_or(0, Vec::len),
        rate,
    };
    grid.paint(|row, word| {
        rows[row]
            .get(word)
            .map_or([u8::MAX; 3], |cell| cell.colour())
    })
}

/// The order and the places of the features.
struct Rows<'a> {
    names: &'a [String],
    /// Feature, pixels below the first row, whether it is compared anywhere.
    places: Vec<(usize, usize, bool)>,
    name_width: usize,
}

impl<'a> Rows<'a> {
    fn new(sheet: &Sheet<'a>) -> Rows<'a> {
        let is_compared = |bit: &usize| {
            let rows = sheet.panels.iter().filter_map(|p| p.rows.get(*bit));
            rows.flatten().any(|cell| cell.is_compared())
        };
        let all = 0..sheet.names.len();
        let (compared, masked): (Vec<usize>, Vec<usize>) = all.partition(is_compared);
        let gap = if compared.is_empty() { 0 } else { GROUP_GAP };
        let n_compared = compared.len();
        let first = compared
            .into_iter()
            .zip(0..)
            .map(|(bit, row)| (bit, row * ROW, true));
        let rest = masked.into_iter().zip(n_compared..);
        let rest = rest.map(|(bit, row)| (bit, row * ROW + gap, false));
        let widths = sheet.names.iter().map(|name| font::width(name, 1));
        Rows {
            names: sheet.names,
            places: first.chain(rest).collect(),
            name_width: widths.max().unwrap_or(0),
        }
    }

    fn height(&self) -> usize {
        self.places.last().map_or(0, |place| place.1 + ROW)
    }

    fn write_names(&self, canvas: &mut Canvas, top: usize) {
        for &(bit, y, is_compared) in &self.places {
            let name = &self.names[bit];
            let indent = self.name_width - font::width(name, 1);
            let colour = if is_compared { TEXT } else { FAINT };
            font::write(canvas, name, [MARGIN + indent, top + y + 2], 1, colour);
        }
    }
}

/// A panel and its measures.
struct Drawn<'a> {
    panel: &'a Panel,
    n_words: usize,
    /// Every so many words one is drawn.
    step: usize,
    word_width: usize,
}

impl<'a> Drawn<'a> {
    fn new(panel: &'a Panel) -> Drawn<'a> {
        let n_words = panel.segments.last().map_or(0, |segment| segment.end);
        let step = n_words.div_ceil(MOST_WORDS).max(1);
        let n_drawn = n_words.div_ceil(step);
        Drawn {
            panel,
            n_words,
            step,
            word_width: (PANEL_WIDTH / n_drawn.max(1)).clamp(1, WIDEST_WORD),
        }
    }

    /// Pixels from the left edge of the panel to a word's.
    fn x(&self, word: usize) -> usize {
        let starts = self
            .panel
            .segments
            .iter()
            .skip(1)
            .map(|segment| segment.start);
        let n_borders = starts.filter(|&start| start <= word).count();
        word.div_ceil(self.step) * self.word_width + n_borders * BORDER
    }

    fn width(&self) -> usize {
        self.x(self.n_words)
    }

    /// Pixels that the panel takes with its captions.
    fn room(&self) -> usize {
        let captions = self.panel.captions.iter().map(|text| font::width(text, 1));
        captions.max().unwrap_or(0).max(self.width())
    }

    fn paint(&self, canvas: &mut Canvas, [left, top]: [usize; 2], above: usize, rows: &Rows<'_>) {
        for (k, caption) in self.panel.captions.iter().enumerate() {
            let colour = if k == 0 { TEXT } else { FAINT };
            font::write(canvas, caption, [left, top + k * LINE], 1, colour);
        }
        let top = top + above;
        self.paint_segments(canvas, [left, top], rows.height());
        for &(bit, y, _) in &rows.places {
            let cells = self.panel.rows.get(bit).map_or(&[][..], Vec::as_slice);
            for (word, &cell) in cells.iter().enumerate().step_by(self.step) {
                let corner = [left + self.x(word), top + y];
                canvas.fill(corner, [self.word_width, ROW - GAP], cell.colour());
                if cell == Cell::Different {
                    // Not by colour alone.
                    let middle = [corner[0], corner[1] + ROW / 2 - 1];
                    canvas.fill(middle, [self.word_width, 1], [u8::MAX; 3]);
                }
            }
        }
    }

    /// Borders and numbers of segments; a number that has no room is left out.
    fn paint_segments(&self, canvas: &mut Canvas, [left, top]: [usize; 2], height: usize) {
        let mut free = 0;
        for (number, segment) in (1..).zip(&self.panel.segments) {
            let x = self.x(segment.start);
            if number > 1 {
                canvas.fill([left + x - BORDER / 2 - 1, top], [1, height], TEXT);
            }
            let text = format!("{number}");
            if x >= free && !segment.is_empty() {
                font::write(canvas, &text, [left + x, top - LINE], 1, FAINT);
                free = x + font::width(&text, 1);
            }
        }
    }

    fn paint_ticks(&self, canvas: &mut Canvas, [left, top]: [usize; 2], rate: f64) {
        let drawn_rate = rate / self.step as f64;
        for (x, caption) in ticks(
            self.n_words.div_ceil(self.step),
            drawn_rate,
            self.word_width,
        ) {
            let word = x / self.word_width * self.step;
            let x = left + self.x(word.min(self.n_words));
            canvas.fill([x, top + 1], [1, 4], FAINT);
            font::write(canvas, &caption, [x, top + 8], 1, FAINT);
        }
    }
}

fn legend_room(cell: Cell) -> usize {
    ROW + 6 + font::width(cell.caption(), 1) + APART
}

fn legend(canvas: &mut Canvas, [mut x, y]: [usize; 2]) {
    for cell in Cell::ALL {
        // A frame, so that white is seen.
        canvas.fill([x, y], [ROW + 2, ROW + 2], FAINT);
        canvas.fill([x + 1, y + 1], [ROW, ROW], cell.colour());
        if cell == Cell::Different {
            canvas.fill([x + 1, y + ROW / 2], [ROW, 1], [u8::MAX; 3]);
        }
        font::write(canvas, cell.caption(), [x + ROW + 8, y + 4], 1, TEXT);
        x += legend_room(cell);
    }
}
