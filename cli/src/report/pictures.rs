//! Pictures with what it takes to read values off them.

use std::ops::Range;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mtemplate::ClassTemplate;
use relfeat::FeatureSet;

use super::document::{Picture, Values};
use crate::commands::search::explain::Agreement;
use crate::commands::search::scene::SceneAgreement;
use crate::picture::agreement::{Cell, agreement_chart};
use crate::picture::curve::{Curve, HEIGHT, WIDTH};
use crate::picture::heatmap::{distance_chart, feature_chart};
use crate::picture::scene::{State, scene_chart};
use crate::picture::template::template_chart;
use crate::picture::{Charted, Image};
use crate::selection;

/// Numbers of a curve at most: the columns of one that has more are put together.
const MOST_NUMBERS: usize = 1600;

/// Steps that values from 0 to 1, and metres up to one, are told in.
const SHARE: f32 = 0.01;

/// Digits of a curve's numbers behind the point.
const DIGITS: f32 = 1e4;

/// Features over time. `from` is the time of the first word in seconds, `rate` is in words per second.
#[must_use]
pub fn features(set: &FeatureSet, words: &[u64], rate: f64, from: f64) -> Option<Picture> {
    let names = selection::names(set, set.all());
    let bits =
        (0..names.len()).flat_map(|bit| words.iter().map(move |w| u8::from(w >> bit & 1 == 1)));
    let cells = Cells {
        columns: words.len(),
        codes: bits.collect(),
        meanings: ["off", "on"].map(str::to_owned).to_vec(),
        unit: None,
    };
    let seconds = [from, from + words.len() as f64 / rate];
    cells.picture(feature_chart(&names, words, rate), names, seconds)
}

/// A template's values.
#[must_use]
pub fn template(class: &ClassTemplate) -> Option<Picture> {
    let values = class.template.values();
    let code = |value: &f64| (value.clamp(0.0, 1.0) as f32 / SHARE).round() as u8;
    let cells = Cells {
        columns: values.nrows(),
        codes: values.t().iter().map(code).collect(),
        meanings: Vec::new(),
        unit: Some(SHARE),
    };
    let seconds = [0.0, values.nrows() as f64 / class.rate];
    let chart = template_chart(&class.features, values, class.rate);
    cells.picture(chart, class.features.clone(), seconds)
}

/// Where a hit agrees with what was asked; the features compared stand above the others. `from` is the time of
/// its first word in seconds.
#[must_use]
pub fn agreement(set: &FeatureSet, agreement: &Agreement, rate: f64, from: f64) -> Option<Picture> {
    let names = selection::names(set, set.all());
    let named = names.into_iter().enumerate();
    let rows = named.map(|(bit, name)| (name, agreement.cells(bit)));
    let (mut rows, masked): (Vec<_>, Vec<_>) =
        rows.partition(|(_, cells)| cells.iter().any(|cell| cell.is_compared()));
    rows.extend(masked);
    let (names, rows): (Vec<String>, Vec<Vec<Cell>>) = rows.into_iter().unzip();
    let code = |cell: &Cell| Cell::ALL.iter().position(|c| c == cell).unwrap_or(0) as u8;
    let cells = Cells {
        columns: rows.first().map_or(0, Vec::len),
        codes: rows.iter().flatten().map(code).collect(),
        meanings: Cell::ALL.map(|cell| cell.caption().to_owned()).to_vec(),
        unit: None,
    };
    let seconds = [from, from + cells.columns as f64 / rate];
    cells.picture(agreement_chart(&names, &rows, rate), names, seconds)
}

/// Where a hit is as its scene asks, a row per line. `from` is the time of its first word in seconds.
#[must_use]
pub fn scene(agreement: &SceneAgreement, rate: f64, from: f64) -> Option<Picture> {
    let SceneAgreement { names, rows } = agreement;
    let code = |state: &State| State::ALL.iter().position(|s| s == state).unwrap_or(0) as u8;
    let cells = Cells {
        columns: rows.first().map_or(0, Vec::len),
        codes: rows.iter().flatten().map(code).collect(),
        meanings: State::ALL.map(|state| state.caption().to_owned()).to_vec(),
        unit: None,
    };
    let seconds = [from, from + cells.columns as f64 / rate];
    cells.picture(scene_chart(names, rows, rate), names.clone(), seconds)
}

/// Distances in metres, a row per name, the first column at `from` seconds, `rate` columns per second. All from `far`
/// on are drawn alike.
#[must_use]
pub fn distances(
    names: &[String],
    rows: &[Vec<Option<f32>>],
    far: f32,
    (rate, from): (f64, f64),
) -> Option<Picture> {
    let columns = rows.first().map_or(0, Vec::len);
    // What is not known cannot be told apart from what is very far, which does not occur.
    let code =
        |metres: &Option<f32>| metres.map_or(u8::MAX, |m| (m / SHARE).round().min(254.0) as u8);
    let cells = Cells {
        columns,
        codes: rows.iter().flatten().map(code).collect(),
        meanings: Vec::new(),
        unit: Some(SHARE),
    };
    let seconds = [from, from + columns as f64 / rate];
    cells.picture(
        distance_chart(names, rows, far, rate),
        names.to_vec(),
        seconds,
    )
}

/// A curve from 0 up called `name`, with the limit of what counts as found and what was found, in seconds.
#[must_use]
pub fn curve(
    y: &[Option<f32>],
    name: &str,
    limit: Option<f32>,
    (seconds, found): ([f64; 2], &[Range<f64>]),
) -> Option<Picture> {
    let y = thinned(y);
    let curve = Curve {
        y: &y,
        seconds,
        limit,
        found,
    };
    let drawing = curve.draw()?;
    let rounded = y.iter().map(|y| y.map(|y| (y * DIGITS).round() / DIGITS));
    Some(Picture {
        image: drawing.svg,
        width: WIDTH,
        height: HEIGHT,
        area: drawing.area,
        seconds,
        values: Values::Curve {
            y: rounded.collect(),
            name: name.to_owned(),
        },
    })
}

/// The least number of every few columns, so that low places, which matter, stay.
fn thinned(y: &[Option<f32>]) -> Vec<Option<f32>> {
    let n_together = y.len().div_ceil(MOST_NUMBERS).max(1);
    let least = |together: &[Option<f32>]| together.iter().flatten().copied().reduce(f32::min);
    y.chunks(n_together).map(least).collect()
}

/// Codes of a picture.
struct Cells {
    columns: usize,
    codes: Vec<u8>,
    meanings: Vec<String>,
    unit: Option<f32>,
}

impl Cells {
    /// `None` for a picture that PNG cannot hold.
    fn picture(self, chart: Charted, rows: Vec<String>, seconds: [f64; 2]) -> Option<Picture> {
        let Charted { image, area } = chart;
        let pixels = |n: usize| u32::try_from(n).ok();
        let [left, top, right, bottom] = area.map(pixels);
        Some(Picture {
            width: pixels(image.width)?,
            height: pixels(image.height)?,
            image: data_address(&image)?,
            area: [left?, top?, right?, bottom?],
            seconds,
            values: Values::Cells {
                rows,
                columns: self.columns,
                codes: STANDARD.encode(self.codes),
                meanings: self.meanings,
                unit: self.unit,
            },
        })
    }
}

fn data_address(image: &Image) -> Option<String> {
    let png = image.to_png().ok()?;
    Some(format!("data:image/png;base64,{}", STANDARD.encode(png)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_the_bits_of_words() {
        let set = FeatureSet::builtin("mueller2006").unwrap();
        let picture = features(&set, &[0b01, 0b10, 0b11], 30.0, 2.0).unwrap();
        let Values::Cells {
            rows,
            columns,
            codes,
            ..
        } = picture.values
        else {
            panic!("no cells");
        };
        assert_eq!((rows.len(), columns), (set.features().len(), 3));
        let codes = STANDARD.decode(codes).unwrap();
        assert_eq!(codes.len(), rows.len() * columns);
        assert_eq!(codes[..6], [1, 0, 1, 0, 1, 1]);
        assert!(codes[6..].iter().all(|&code| code == 0));
        assert_eq!(picture.seconds, [2.0, 2.1]);
        let [left, top, right, bottom] = picture.area;
        assert!(left < right && right < picture.width && top < bottom && bottom < picture.height);
    }

    #[test]
    fn a_long_curve_keeps_its_low_places() {
        let mut y = vec![Some(1.0); 10 * MOST_NUMBERS];
        y[7777] = Some(0.25);
        y[..20].fill(None);
        let thin = thinned(&y);
        assert_eq!(thin.len(), MOST_NUMBERS);
        assert_eq!(thin[777], Some(0.25));
        assert_eq!(thin[..3], [None, None, Some(1.0)]);
        assert_eq!(thinned(&y[..5]), y[..5]);
    }

    #[test]
    fn unknown_distances_are_not_near() {
        let rows = [vec![Some(0.0), None, Some(0.5), Some(9.0)]];
        let picture = distances(&["root".to_owned()], &rows, 0.3, (30.0, 0.0)).unwrap();
        let Values::Cells { codes, unit, .. } = picture.values else {
            panic!("no cells");
        };
        assert_eq!(STANDARD.decode(codes).unwrap(), [0, 255, 50, 254]);
        assert_eq!(unit, Some(0.01));
    }
}
