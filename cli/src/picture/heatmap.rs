//! Pictures of feature matrices.

use super::canvas::{Canvas, Image, Rgb};
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
    let captions: Vec<String> = names
        .iter()
        .enumerate()
        .map(|(bit, name)| format!("{name} F{}", bit + 1))
        .collect();
    let text_width = captions
        .iter()
        .map(|c| font::width(c, 1))
        .max()
        .unwrap_or(0);
    let left = MARGIN + text_width + MARGIN / 2;
    let word_width = (WIDTH / words.len().max(1)).clamp(1, WIDEST_WORD);
    let width = left + word_width * words.len() + 2 * MARGIN;
    let bottom = MARGIN + captions.len() * ROW;
    let mut canvas = Canvas::new(width, bottom + 2 * MARGIN + font::HEIGHT);
    for (bit, caption) in captions.iter().enumerate() {
        let top = MARGIN + bit * ROW;
        let indent = text_width - font::width(caption, 1);
        font::write(&mut canvas, caption, [MARGIN + indent, top + 2], 1, TEXT);
        for (k, word) in words.iter().enumerate() {
            let colour = if word >> bit & 1 == 1 { ON } else { OFF };
            let corner = [left + k * word_width, top];
            canvas.fill(corner, [word_width, ROW - GAP], colour);
        }
    }
    for (x, caption) in ticks(words.len(), rate, word_width) {
        canvas.fill([left + x, bottom], [1, 4], TEXT);
        font::write(&mut canvas, &caption, [left + x, bottom + 7], 1, TEXT);
    }
    canvas.into_image()
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
    fn nothing_at_all_is_a_picture_too() {
        let image = feature_heatmap(&[], &[], 30.0);
        assert_eq!(image.pixels.len(), image.width * image.height * 3);
        assert!(image.to_png().is_ok());
    }
}
