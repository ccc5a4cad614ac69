//! One hit of a search, named by its place.

use segidx::Hit;

use super::super::asked::Asked;
use super::super::example::Example;
use super::super::segments::Changes;
use super::super::{SILENT, What};
use super::{Agreement, agreement};
use crate::failure::Failure;
use crate::library::{Clip, Library};
use crate::source::Span;
use crate::take::Take;

/// A hit by its place.
#[derive(Clone, Copy, Debug)]
pub struct HitPlace<'a> {
    /// Where it was found.
    pub clip: &'a Clip,
    /// Its source frames.
    pub frames: Span,
    /// Whether it is one of the left/right mirrored example.
    pub mirrored: bool,
}

/// Where one hit of [`search_indexed`](crate::commands::search::search_indexed) agrees with the example, as the search itself tells it when
/// it is to explain; `None` if there is no such hit. Only its clip is searched.
///
/// # Errors
/// As the search.
pub fn explain_indexed(
    library: &Library,
    (clip, frames): (&Clip, Span),
    what: &What<'_>,
    place: HitPlace<'_>,
) -> Result<Option<Agreement>, Failure> {
    let example = Example::indexed(library, clip, frames, what.features)?;
    explain_by(library, example, what, place)
}

/// As [`explain_indexed`], for [`search_take`](crate::commands::search::search_take).
///
/// # Errors
/// As the search.
pub fn explain_take(
    library: &Library,
    take: Take,
    what: &What<'_>,
    place: HitPlace<'_>,
) -> Result<Option<Agreement>, Failure> {
    let example = Example::of_take(take, library, what.features, SILENT)?;
    explain_by(library, example, what, place)
}

fn explain_by(
    library: &Library,
    example: Example,
    what: &What<'_>,
    HitPlace {
        clip,
        frames,
        mirrored,
    }: HitPlace<'_>,
) -> Result<Option<Agreement>, Failure> {
    let set = &library.features.set;
    let changes = Changes::read(what.segments, set, example.care)?;
    let (example, changes) = match mirrored {
        false => (example, changes),
        true => (example.mirrored(library)?, changes.mirrored(set)),
    };
    let asked = Asked::new(&example, what, &changes, library)?;
    if asked.care & !clip.meta.available != 0 {
        return Ok(None);
    }
    let (words, hits) = asked.find_in_clip(library, clip)?;
    let is_it = |hit: &&Hit| {
        let span = clip.meta.source_span(hit.span(), words.len(), library.rate);
        span == frames
    };
    let hit = hits.iter().find(is_it);
    Ok(hit.map(|hit| agreement(set, (&example, asked.query()), clip, (hit, &words))))
}
