//! Pictures of feature matrices.

use super::canvas::{Canvas, Charted, Image, Rgb};
use super::font;

const ON: Rgb = [0x1f, 0x4e, 0x8c];
const OFF: Rgb = [0xee, 0xf1, 0xf5];
const TEXT: Rgb = [0x33, 0x3b, 0x47];
const MARGIN: usize = 12;
/// Pixels of a row.
const ROW: usize = 13;
/// Pixels between rows.
const GAP: usize = 1;
/// The matrix is made about this wide, in pixels, where its words allow.
const WIDTH: usize = 1200;
/// A word is at most this wide.
const WIDEST_WORD: usize = 12;

/// A row per feature, a column per word, dark where the feature is on; seconds below.
///
/// `rate` is in words per second. A word is 1 to 12 pixels wide, so that short clips fill the width
/// and long ones are as wide as they have words.
#[must_use]
pub fn feature_heatmap(names: &[String], words: &[u64], rate: f64) -> Image {
    feature_chart(names, words, rate).image
}

/// As [`feature_heatmap`], with the place of the words.
#[must_use]
pub fn feature_chart(names: &[String], words: &[u64], rate: f64) -> Charted {
    let numbered = names.iter().enumerate();
    let grid = Grid {
        captions: numbered
            .map(|(bit, name)| format!("{name} F{}", bit + 1))
            .collect(),
        n_columns: words.len(),
        rate,
    };
    grid.paint(|bit, k| match words[k] >> bit & 1 {
        1 => ON,
        _ => OFF,
    })
}

/// A row per name, a column per step, dark green where two poses are near, yellow where they are `far` metres
/// apart or more, white where it is not known.
///
/// `distances` has a row per name; `rate` is in columns per second.
#[must_use]
pub fn distance_chart(
    names: &[String],
    distances: &[Vec<Option<f32>>],
    far: f32,
    rate: f64,
) -> Charted {
    let grid = Grid {
        captions: names.to_vec(),
        n_columns: distances.first().map_or(0, Vec::len),
        rate,
    };
    grid.paint(|row, column| {
        let metres = distances[row].get(column).copied().flatten();
        metres.map_or([u8::MAX; 3], |metres| scale_colour(metres / far))
    })
}

/// From dark to bright, which every kind of colour blindness tells apart: five colours of viridis
/// (van der Walt and Smith, 2015).
fn scale_colour(share: f32) -> Rgb {
    const SCALE: [Rgb; 5] = [
        [0x44, 0x01, 0x54],
        [0x3b, 0x52, 0x8b],
        [0x21, 0x91, 0x8c],
        [0x5e, 0xc9, 0x62],
        [0xfd, 0xe7, 0x25],
    ];
    let at = share.clamp(0.0, 1.0) * (SCALE.len() - 1) as f32;
    let low = (at as usize).min(SCALE.len() - 2);
    std::array::from_fn(|i| {
        let (from, to) = (f32::from(SCALE[low][i]), f32::from(SCALE[low + 1][i]));
        (from + (to - from) * (at - low as f32)).round() as u8
    })
}

/// Rows with captions, columns over time.
pub(super) struct Grid {
    pub(super) captions: Vec<String>,
    pub(super) n_columns: usize,
    /// Columns per second.
    pub(super) rate: f64,
}

impl Grid {
    /// Paints each row and column in its colour.
    pub(super) fn paint(&self, colour: impl Fn(usize, usize) -> Rgb) -> Charted {
        let widths = self.captions.iter().map(|c| font::width(c, 1));
        let text_width = widths.max().unwrap_or(0);
        let left = MARGIN + text_width + MARGIN / 2;
        let column_width = (WIDTH / self.n_columns.max(1)).clamp(1, WIDEST_WORD);
        let right = left + column_width * self.n_columns;
        let bottom = MARGIN + self.captions.len() * ROW;
        let mut canvas = Canvas::new(right + 2 * MARGIN, bottom + 2 * MARGIN + font::HEIGHT);
        for (row, caption) in self.captions.iter().enumerate() {
            let top = MARGIN + row * ROW;
            let indent = text_width - font::width(caption, 1);
            font::write(&mut canvas, caption, [MARGIN + indent, top + 2], 1, TEXT);
            for column in 0..self.n_columns {
                let corner = [left + column * column_width, top];
                canvas.fill(corner, [column_width, ROW - GAP], colour(row, column));
            }
        }
        for (x, caption) in ticks(self.n_columns, self.rate, column_width) {
            canvas.fill([left + x, bottom], [1, 4], TEXT);
            font::write(&mut canvas, &caption, [left + x, bottom + 7], 1, TEXT);
        }
        Charted {
            image: canvas.into_image(),
            area: [left, MARGIN, right, bottom],
        }
    }
}

/// Places and captions of whole seconds, far enough apart to be read.
pub(super) fn ticks(n_words: usize, rate: f64, word_width: usize) -> Vec<(usize, String)> {
    /// Room for a caption such as `120 s`.
    const APART: f64 = 48.0;
    let pixels_per_second = rate * word_width as f64;
    let steps = [1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 300.0, 600.0, 3600.0];
    let step = steps
        .into_iter()
        .find(|s| s * pixels_per_second >= APART)
        .unwrap_or(3600.0);
    let n_ticks = (n_words as f64 / rate / step).floor() as usize;
    let tick = |i: usize| {
        let seconds = i as f64 * step;
        (
            (seconds * pixels_per_second) as usize,
            format!("{seconds} s"),
        )
    };
    (0..=n_ticks).map(tick).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_feature_that_is_on_is_dark_where_it_is_on() {
        let names = ["a".to_owned(), "b".to_owned()];
        let image = feature_heatmap(&names, &[0b01, 0b10], 30.0);
        let cell = |bit: usize, k: usize| {
            let left = MARGIN + font::width("a F1", 1) + MARGIN / 2;
            let (x, y) = (left + k * WIDEST_WORD + 3, MARGIN + bit * ROW + 3);
            let start = (y * image.width + x) * 3;
            [
                image.pixels[start],
                image.pixels[start + 1],
                image.pixels[start + 2],
            ]
        };
        assert_eq!([cell(0, 0), cell(0, 1)], [ON, OFF]);
        assert_eq!([cell(1, 0), cell(1, 1)], [OFF, ON]);
    }

    #[test]
    fn distances_go_from_dark_to_bright() {
        assert_eq!(scale_colour(0.0), [0x44, 0x01, 0x54]);
        assert_eq!(scale_colour(0.5), [0x21, 0x91, 0x8c]);
        assert_eq!(scale_colour(7.0), [0xfd, 0xe7, 0x25]);
        let names = ["a".to_owned()];
        let chart = distance_chart(&names, &[vec![None, Some(0.2)]], 0.2, 30.0);
        let [left, top, right, bottom] = chart.area;
        assert_eq!((right - left, bottom - top), (2 * WIDEST_WORD, ROW));
        let pixel = |x: usize| {
            let start = ((top + 3) * chart.image.width + x) * 3;
            [0, 1, 2].map(|i| chart.image.pixels[start + i])
        };
        assert_eq!(
            [pixel(left + 1), pixel(right - 1)],
            [[u8::MAX; 3], [0xfd, 0xe7, 0x25]]
        );
    }

    #[test]
    fn nothing_at_all_is_a_picture_too() {
        let image = feature_heatmap(&[], &[], 30.0);
        assert_eq!(image.pixels.len(), image.width * image.height * 3);
        assert!(image.to_png().is_ok());
    }
}
