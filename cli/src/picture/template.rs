//! Pictures of motion templates.

use ndarray::ArrayView2;

use super::canvas::{Canvas, Charted, Image, Rgb};
use super::font;
use super::heatmap::ticks;

/// Off in all motions; with [`ON`] a pair that no common colour blindness confuses (Okabe and Ito,
/// *Color universal design*, 2008).
const OFF: Rgb = [0xe6, 0x9f, 0x00];
/// On in all motions.
const ON: Rgb = [0x00, 0x72, 0xb2];
/// Does not matter.
const ANY: Rgb = [0xee, 0xf1, 0xf5];
const TEXT: Rgb = [0x33, 0x3b, 0x47];
const MARGIN: usize = 12;
/// Pixels of a row.
const ROW: usize = 13;
/// Pixels between rows.
const GAP: usize = 1;
/// The template is made about this wide, in pixels, where its columns allow.
const WIDTH: usize = 900;
/// A column is at most this wide.
const WIDEST_COLUMN: usize = 12;

/// A row per feature, a column per template column: orange where a feature is off, blue where it is on,
/// light grey where it does not matter, and shades of orange and blue for shares in between. Seconds
/// and what the colours mean stand below.
///
/// `values` has shape `(columns, features)`; `rate` is in columns per second.
#[must_use]
pub fn template_heatmap(names: &[String], values: ArrayView2<'_, f64>, rate: f64) -> Image {
    template_chart(names, values, rate).image
}

/// As [`template_heatmap`], with the place of the columns.
#[must_use]
pub fn template_chart(names: &[String], values: ArrayView2<'_, f64>, rate: f64) -> Charted {
    let numbered = names.iter().zip(1..);
    let captions: Vec<String> = numbered
        .map(|(name, number): (_, usize)| format!("{name} F{number}"))
        .collect();
    let caption_width = captions
        .iter()
        .map(|c| font::width(c, 1))
        .max()
        .unwrap_or(0);
    let left = MARGIN + caption_width + MARGIN / 2;
    let n_columns = values.nrows();
    let column_width = (WIDTH / n_columns.max(1)).clamp(1, WIDEST_COLUMN);
    let legend = [(OFF, "off"), (ANY, "does not matter"), (ON, "on")];
    let legend_width: usize = legend.iter().map(|(_, text)| swatch_width(text)).sum();
    let width = left + (column_width * n_columns).max(legend_width) + 2 * MARGIN;
    let bottom = MARGIN + captions.len() * ROW;
    let mut canvas = Canvas::new(width, bottom + 4 * MARGIN + 2 * font::HEIGHT);
    for (row, (caption, values)) in captions.iter().zip(values.columns()).enumerate() {
        let top = MARGIN + row * ROW;
        let indent = caption_width - font::width(caption, 1);
        font::write(&mut canvas, caption, [MARGIN + indent, top + 2], 1, TEXT);
        for (column, &value) in values.iter().enumerate() {
            let corner = [left + column * column_width, top];
            canvas.fill(corner, [column_width, ROW - GAP], colour(value));
        }
    }
    for (x, caption) in ticks(n_columns, rate, column_width) {
        canvas.fill([left + x, bottom], [1, 4], TEXT);
        font::write(&mut canvas, &caption, [left + x, bottom + 7], 1, TEXT);
    }
    let mut x = left;
    let top = bottom + 2 * MARGIN + font::HEIGHT;
    for (colour, text) in legend {
        canvas.fill([x, top - 2], [ROW, ROW - GAP], colour);
        font::write(&mut canvas, text, [x + ROW + GAP + 4, top], 1, TEXT);
        x += swatch_width(text);
    }
    Charted {
        image: canvas.into_image(),
        area: [left, MARGIN, left + column_width * n_columns, bottom],
    }
}

/// Pixels of an entry of the legend.
fn swatch_width(text: &str) -> usize {
    ROW + font::width(text, 1) + 2 * MARGIN
}

/// The colour of a share: from that of 0 over that of one half to that of 1.
fn colour(value: f64) -> Rgb {
    let (end, share) = if value < 0.5 {
        (OFF, 1.0 - 2.0 * value)
    } else {
        (ON, 2.0 * value - 1.0)
    };
    std::array::from_fn(|i| {
        let (from, to) = (f64::from(ANY[i]), f64::from(end[i]));
        (from + (to - from) * share).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use ndarray::{Array2, array};

    use super::*;

    #[test]
    fn cells_have_the_colours_of_the_legend() {
        let names = ["a".to_owned(), "b".to_owned()];
        let values = array![[0.0, 1.0], [0.5, 0.75]];
        let image = template_heatmap(&names, values.view(), 30.0);
        let cell = |row: usize, column: usize| {
            let left = MARGIN + font::width("a F1", 1) + MARGIN / 2;
            let (x, y) = (left + column * WIDEST_COLUMN + 3, MARGIN + row * ROW + 3);
            let start = (y * image.width + x) * 3;
            [0, 1, 2].map(|i| image.pixels[start + i])
        };
        assert_eq!([cell(0, 0), cell(0, 1)], [OFF, ANY]);
        // Half way from #eef1f5 to #0072b2.
        assert_eq!([cell(1, 0), cell(1, 1)], [ON, [0x77, 0xb2, 0xd4]]);
    }

    #[test]
    fn nothing_at_all_is_a_picture_too() {
        let image = template_heatmap(&[], Array2::zeros((0, 0)).view(), 30.0);
        assert_eq!(image.pixels.len(), image.width * image.height * 3);
        assert!(image.to_png().is_ok());
    }
}
