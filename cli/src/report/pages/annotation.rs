//! Annotations.

use std::ops::Range;

use crate::annotation::{Labeller, Span};
use crate::failure::Failure;
use crate::report::document::{AnnotationPage, LabelledSpan, Picture, Place, Track};
use crate::report::make::Maker;
use crate::report::pictures;
use crate::report::results::AnnotationRead;
use crate::take::Take;

/// A clip with spans as they were found before; `None` if the clip cannot be read. There are no curves: what was found
/// does not have the templates.
pub fn page(maker: &mut Maker<'_>, read: &AnnotationRead) -> Option<AnnotationPage> {
    let clip = maker.clip(&read.clip)?;
    let rate = maker.rate(clip);
    let mut tracks: Vec<Track> = Vec::new();
    for span in &read.spans {
        let labelled = LabelledSpan {
            place: Place::new(clip, span.start..span.end, rate),
            cost: span.cost,
        };
        match tracks.iter_mut().find(|track| track.label == span.label) {
            Some(track) => {
                // Templates of one name may have several.
                track.tau = track.tau.filter(|tau| Some(*tau) == span.tau);
                track.spans.push(labelled);
            }
            None => tracks.push(Track {
                label: span.label.clone(),
                tau: span.tau,
                spans: vec![labelled],
                curve: None,
            }),
        }
    }
    tracks.sort_by(|a, b| a.label.cmp(&b.label));
    Some(AnnotationPage { clip, tracks })
}

/// A clip that was read, with the curve and the matches of each template that its rig has the features for; `None` if
/// the clip is not in the document.
///
/// # Errors
/// [`Failure::Input`] if features cannot be computed.
pub fn of_take(
    maker: &mut Maker<'_>,
    take: &Take,
    labeller: &Labeller,
) -> Result<Option<AnnotationPage>, Failure> {
    let Some(clip) = maker.builder.id(&take.clip.display()) else {
        return Ok(None);
    };
    let rate = take.rate();
    let found = labeller.annotate(take)?;
    let mut tracks = Vec::new();
    for group in labeller.groups() {
        let words = take.words(&group.set, group.rate)?;
        for labelled in &group.templates {
            if found.lacking.contains(&labelled.label) {
                continue;
            }
            let spans = found
                .spans
                .iter()
                .filter(|span| span.label == labelled.label);
            let spans: Vec<&Span> = spans.collect();
            let curve = labelled.template.distance_curve(&words.words);
            let y: Vec<Option<f32>> = curve.costs().map(|cost| cost.map(|c| c as f32)).collect();
            let from = words.first_word as f64 / group.rate;
            let seconds = [from, from + y.len() as f64 / group.rate];
            let curve = curve_of(&y, labelled.tau, seconds, &spans, rate);
            let spans = spans.iter().map(|span| LabelledSpan {
                place: Place::new(clip, span.frames.clone(), rate),
                cost: span.cost,
            });
            tracks.push(Track {
                label: labeller.labels()[labelled.label].clone(),
                tau: Some(labelled.tau),
                spans: spans.collect(),
                curve,
            });
        }
    }
    Ok(Some(AnnotationPage { clip, tracks }))
}

fn curve_of(
    y: &[Option<f32>],
    tau: f64,
    seconds: [f64; 2],
    spans: &[&Span],
    rate: f64,
) -> Option<Picture> {
    let found = spans.iter().map(|span| {
        let Range { start, end } = span.frames;
        start as f64 / rate..end as f64 / rate
    });
    let found: Vec<Range<f64>> = found.collect();
    pictures::curve(y, "Δ", Some(tau as f32), (seconds, &found))
}
