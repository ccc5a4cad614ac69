//! How good ranked hits are.

use std::ops::Range;

/// What a clip is to a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Judgement {
    /// It shows the motion.
    Relevant,
    /// It may show the motion among others; its hits are left out.
    Unjudged,
    Other,
}

/// A stretch of a document, in frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Stretch {
    pub(crate) doc: usize,
    pub(crate) span: Range<usize>,
}

impl Stretch {
    pub(crate) fn overlaps(&self, other: &Stretch) -> bool {
        let (a, b) = (&self.span, &other.span);
        self.doc == other.doc && a.start < b.end && b.start < a.end
    }

    pub(crate) fn contains(&self, other: &Stretch) -> bool {
        let (a, b) = (&self.span, &other.span);
        self.doc == other.doc && a.start <= b.start && b.end <= a.end
    }
}

/// Hits beside the query itself, judged.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Quality {
    /// Judged hits in order of rank: whether each is relevant.
    pub(crate) ranked: Vec<bool>,
    /// Relevant clips other than the query's that have a hit, and all of them.
    pub(crate) found: (usize, usize),
}

impl Quality {
    /// Of hits in order of rank. Hits that overlap the query are left out, as are unjudged ones.
    pub(crate) fn of(query: &Stretch, hits: &[Stretch], judged: &[Judgement]) -> Quality {
        let others = hits.iter().filter(|hit| !hit.overlaps(query));
        let others: Vec<&Stretch> = others
            .filter(|hit| judged[hit.doc] != Judgement::Unjudged)
            .collect();
        let is_relevant = |doc: usize| judged[doc] == Judgement::Relevant;
        let wanted = (0..judged.len()).filter(|&doc| doc != query.doc && is_relevant(doc));
        let is_found = |doc: &usize| others.iter().any(|hit| hit.doc == *doc);
        Quality {
            ranked: others.iter().map(|hit| is_relevant(hit.doc)).collect(),
            found: (wanted.clone().filter(is_found).count(), wanted.count()),
        }
    }

    /// The relevant share of the first `n` hits, or of all if they are fewer; `None` without hits.
    pub(crate) fn precision_at(&self, n: usize) -> Option<f64> {
        let top = &self.ranked[..n.min(self.ranked.len())];
        (!top.is_empty()).then(|| share(top.iter().filter(|hit| **hit).count(), top.len()))
    }

    /// The relevant share of all hits: what the first few have on average if they are not ranked.
    pub(crate) fn precision(&self) -> Option<f64> {
        self.precision_at(usize::MAX)
    }

    /// The share of the relevant clips that are found.
    pub(crate) fn recall(&self) -> Option<f64> {
        let (found, wanted) = self.found;
        (wanted > 0).then(|| share(found, wanted))
    }

    /// Relevant hits before the first that is not.
    pub(crate) fn n_leading(&self) -> usize {
        self.ranked.iter().take_while(|hit| **hit).count()
    }
}

fn share(part: usize, whole: usize) -> f64 {
    part as f64 / whole as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use Judgement::{Other, Relevant, Unjudged};

    fn stretch(doc: usize, span: Range<usize>) -> Stretch {
        Stretch { doc, span }
    }

    #[test]
    fn the_query_and_unjudged_clips_do_not_count() {
        let query = stretch(0, 10..20);
        let hits = [
            query.clone(),
            stretch(0, 20..30),
            stretch(3, 0..5),
            stretch(2, 0..5),
            stretch(1, 0..5),
        ];
        let quality = Quality::of(
            &query,
            &hits,
            &[Relevant, Relevant, Other, Unjudged, Relevant],
        );
        assert_eq!(quality.ranked, [true, false, true]);
        assert_eq!(quality.found, (1, 2));
        assert_eq!(quality.precision(), Some(2.0 / 3.0));
        assert_eq!(quality.precision_at(1), Some(1.0));
        assert_eq!(quality.recall(), Some(0.5));
        assert_eq!(quality.n_leading(), 1);
    }

    #[test]
    fn nothing_found_has_no_precision() {
        let query = stretch(0, 0..5);
        let quality = Quality::of(&query, &[], &[Relevant, Other]);
        assert_eq!((quality.precision(), quality.recall()), (None, None));
        assert_eq!(
            Quality::of(&query, &[], &[Other, Relevant]).recall(),
            Some(0.0)
        );
    }

    #[test]
    fn stretches_of_one_document_overlap_and_contain() {
        let a = stretch(0, 5..10);
        assert!(a.overlaps(&stretch(0, 9..20)) && !a.overlaps(&stretch(0, 10..20)));
        assert!(!a.overlaps(&stretch(1, 5..10)));
        assert!(a.contains(&stretch(0, 5..10)) && !a.contains(&stretch(0, 4..6)));
        assert!(!a.contains(&stretch(1, 6..7)));
    }
}
