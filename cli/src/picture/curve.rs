//! Curves over time as SVG, drawn by plotters.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;

/// Pixels from left to right.
pub const WIDTH: u32 = 1200;
/// Pixels from top to bottom.
pub const HEIGHT: u32 = 170;
/// Pixels of margins, and for the captions of the axes.
const MARGIN: u32 = 8;
const LEFT: u32 = 52;
/// Half of the last second's caption stands beyond the data.
const RIGHT: u32 = 32;
const BELOW: u32 = 26;
/// Pixels of captions' letters.
const LETTERS: u32 = 13;

/// Of Okabe and Ito's palette: the curve, the threshold, what was found.
const CURVE: RGBColor = RGBColor(0x00, 0x72, 0xb2);
const LIMIT: RGBColor = RGBColor(0xd5, 0x5e, 0x00);
const FOUND: RGBColor = RGBColor(0x00, 0x9e, 0x73);
const TEXT: RGBColor = RGBColor(0x33, 0x3b, 0x47);

/// A number per column, evenly spread.
#[derive(Clone, Debug)]
pub struct Curve<'a> {
    /// `None` where there is none.
    pub y: &'a [Option<f32>],
    /// What the left and the right edge stand for, in seconds.
    pub seconds: [f64; 2],
    /// The least that counts as found is below it.
    pub limit: Option<f32>,
    /// What was found, in seconds.
    pub found: &'a [Range<f64>],
}

/// A curve as it was drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Text of an SVG file, [`WIDTH`] by [`HEIGHT`].
    pub svg: String,
    /// Left, top, right, bottom of the data, in pixels.
    pub area: [u32; 4],
}

impl Curve<'_> {
    /// Draws the curve over its time, from 0 up; `None` if it has no extent.
    #[must_use]
    pub fn draw(&self) -> Option<Drawing> {
        let mut svg = String::new();
        let root = SVGBackend::with_string(&mut svg, (WIDTH, HEIGHT)).into_drawing_area();
        let area = self.paint(&root).ok()??;
        root.present().ok()?;
        drop(root);
        Some(Drawing { svg, area })
    }

    fn paint<'b>(
        &self,
        root: &DrawingArea<SVGBackend<'b>, Shift>,
    ) -> Result<Option<[u32; 4]>, DrawingAreaErrorKind<<SVGBackend<'b> as DrawingBackend>::ErrorType>>
    {
        let [from, to] = self.seconds;
        let known = self.y.iter().flatten().chain(&self.limit);
        let highest = known.copied().filter(|y| y.is_finite()).fold(0.0, f32::max);
        if !(from < to && highest > 0.0) {
            return Ok(None);
        }
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(root)
            .margin(MARGIN)
            .margin_right(RIGHT)
            .set_label_area_size(LabelAreaPosition::Left, LEFT)
            .set_label_area_size(LabelAreaPosition::Bottom, BELOW)
            .build_cartesian_2d(from..to, 0.0..f64::from(highest) * 1.05)?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .light_line_style(TRANSPARENT)
            .y_labels(4)
            .x_labels(12)
            .x_label_formatter(&|seconds| format!("{seconds:.1} s"))
            .label_style(("sans-serif", LETTERS).into_font().color(&TEXT))
            .draw()?;
        let top = f64::from(highest) * 1.05;
        let found = self.found.iter();
        chart.draw_series(found.map(|span| {
            let corners = [(span.start.max(from), 0.0), (span.end.min(to), top)];
            Rectangle::new(corners, FOUND.mix(0.25).filled())
        }))?;
        let step = (to - from) / self.y.len().max(1) as f64;
        let places = self.y.iter().enumerate();
        let places: Vec<Option<(f64, f64)>> = places
            .map(|(k, y)| Some((from + (k as f64 + 0.5) * step, f64::from((*y)?))))
            .collect();
        for run in places.split(Option::is_none).filter(|run| !run.is_empty()) {
            chart.draw_series(LineSeries::new(run.iter().flatten().copied(), CURVE))?;
        }
        if let Some(limit) = self.limit.map(f64::from) {
            let ends = [(from, limit), (to, limit)];
            chart.draw_series(DashedLineSeries::new(ends, 6, 4, LIMIT.into()))?;
        }
        let (x, y) = chart.plotting_area().get_pixel_range();
        let pixel = |at: i32| u32::try_from(at).unwrap_or(0);
        Ok(Some([x.start, y.start, x.end, y.end].map(pixel)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_drawn_with_its_limit_and_what_was_found() {
        let y: Vec<Option<f32>> = (0..60)
            .map(|k| (k != 30).then_some(0.01 * k as f32))
            .collect();
        let curve = Curve {
            y: &y,
            seconds: [1.0, 3.0],
            limit: Some(0.06),
            found: &[1.1..1.3],
        };
        let drawing = curve.draw().unwrap();
        assert!(drawing.svg.starts_with("<svg"));
        assert!(!drawing.svg.contains("style=") && !drawing.svg.contains("href"));
        assert!(drawing.svg.contains("#009E73") && drawing.svg.contains("#D55E00"));
        let [left, top, right, bottom] = drawing.area;
        assert!(left >= LEFT && right <= WIDTH && left < right);
        assert!(top < bottom && bottom <= HEIGHT - BELOW);
        assert_eq!(curve.draw().unwrap(), drawing);
    }

    /// Of a letter's height: no digit of the usual fonts is wider.
    const WIDEST_DIGIT: f64 = 0.65;

    #[test]
    fn captions_are_not_cut() {
        for seconds in [[0.0, 1.0], [0.0, 12.0], [3.3, 95.0], [0.0, 3600.0]] {
            let curve = Curve {
                y: &[Some(0.5); 10],
                seconds,
                limit: None,
                found: &[],
            };
            let svg = curve.draw().unwrap().svg;
            let mut n_captions = 0;
            for text in svg
                .split("<text ")
                .skip(1)
                .filter(|text| text.contains(" s\n"))
            {
                let (_, x) = text.split_once("x=\"").unwrap();
                let x: f64 = x.split_once('"').unwrap().0.parse().unwrap();
                let (_, caption) = text.split_once('>').unwrap();
                let n_letters = caption.split_once('<').unwrap().0.trim().len() as f64;
                let half = n_letters * WIDEST_DIGIT * f64::from(LETTERS) / 2.0;
                assert!(
                    x + half <= f64::from(WIDTH) && x >= half,
                    "{seconds:?}: {text}"
                );
                n_captions += 1;
            }
            assert!(n_captions > 3, "{svg}");
        }
    }

    #[test]
    fn nothing_is_no_curve() {
        let curve = |y, seconds| Curve {
            y,
            seconds,
            limit: None,
            found: &[],
        };
        assert_eq!(curve(&[], [0.0, 1.0]).draw(), None);
        assert_eq!(curve(&[None, Some(f32::NAN)], [0.0, 1.0]).draw(), None);
        assert_eq!(curve(&[Some(1.0)], [1.0, 1.0]).draw(), None);
        assert!(curve(&[Some(1.0)], [0.0, 1.0]).draw().is_some());
    }
}
