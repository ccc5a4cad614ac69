//! Matches while the clip is being recorded: the ones of the whole clip, each as soon as no word
//! that may still come can change it.
//!
//! Ends up to τ are taken in the order of (cost, end), the same as in `matches`. What an end does
//! to later ones it does within bounds, since a match has at most N = 2 K - 1 frames: it closes ends
//! up to ⌈N/2⌉ before itself and ⌈N/10⌉ after, and claims starts up to ⌈n/10⌉ before its own and
//! ⌈n/2⌉ after, with n the frames of its match. So an end e with the start s can be changed only by
//!
//! - ends up to e + ⌈N/2⌉, which close it, and
//! - ends up to s + ⌈N/10⌉ + N - 1, which claim its start.
//!
//! Once frames are past both, and no end that comes earlier in the order and is near enough to
//! matter is still undecided, it is decided. An end at no cost needs no frames to pass: none that
//! come can be earlier in the order. What has been decided is kept as the order, the ends and the
//! starts it takes, for as long as they can meet others.

use std::ops::Range;

use crate::matches::{Claim, closed, greater, lesser};
use crate::{Match, QuantizedTemplate, StreamMatcher};

/// Finds the matches of a template in a stream of words.
///
/// What comes out of [`push`](Self::push) and at last of [`finish`](Self::finish) is together what
/// [`QuantizedTemplate::find_matches`] gives for all the words at once, in another order and without
/// a greatest number of matches, which is no property of a stream.
///
/// A word takes O(K) time, and more only near ends up to τ. A match comes out at most 1.7 K frames
/// after its end if no cheaper end is near; a run of ever cheaper ends is decided from its last one.
/// Memory is O(K) and what the run at hand takes.
///
/// ```
/// use mtemplate::{MatchStream, MotionTemplate};
///
/// let template = MotionTemplate::from_words(&[0b01, 0b11, 0b10], 2)?.quantize(0.1)?;
/// let mut stream = MatchStream::new(&template, 0.1);
/// let words = [0b00, 0b01, 0b11, 0b10, 0b10];
/// let mut matches: Vec<_> = words.iter().flat_map(|word| stream.push(*word)).collect();
/// matches.extend(stream.finish());
/// assert_eq!((matches.len(), matches[0].span.clone()), (1, 1..4));
/// # Ok::<(), mtemplate::TemplateError>(())
/// ```
#[derive(Debug, Clone)]
pub struct MatchStream {
    matcher: StreamMatcher,
    tau: f64,
    /// N, the frames of the longest match.
    longest: usize,
    /// Ends that are not decided, in order.
    pending: Vec<End>,
    decided: Vec<Decided>,
    /// The next frame at which one of them has no more to fear.
    due: usize,
}

/// Place in the order of decisions: cost, then last frame.
type Order = (u32, usize);

/// An end up to τ.
#[derive(Debug, Clone)]
struct End {
    order: Order,
    span: Range<usize>,
}

/// An end that was taken: what it does to those after it in the order.
#[derive(Debug, Clone)]
struct Decided {
    order: Order,
    closed: Range<usize>,
    claim: Option<Claim>,
}

impl MatchStream {
    /// A stream before its first word, for matches that cost up to `tau`.
    pub fn new(template: &QuantizedTemplate, tau: f64) -> Self {
        Self {
            matcher: StreamMatcher::new(template),
            tau,
            longest: template.longest_match(),
            pending: Vec::new(),
            decided: Vec::new(),
            due: usize::MAX,
        }
    }

    /// Number of words so far.
    pub fn n_frames(&self) -> usize {
        self.matcher.n_frames()
    }

    /// The matches that this word makes certain, in order of (cost, end).
    pub fn push(&mut self, word: u64) -> Vec<Match> {
        let frame = self.matcher.n_frames();
        if let Some((cost, start)) = self.matcher.push_fixed(word)
            && self.matcher.cost(cost).is_some_and(|cost| cost <= self.tau)
        {
            self.expect(End {
                order: (cost, frame),
                span: start..frame + 1,
            });
        }
        if frame < self.due {
            Vec::new()
        } else {
            self.decide(frame)
        }
    }

    /// The matches that were not certain yet, in order of (cost, end).
    #[must_use]
    pub fn finish(mut self) -> Vec<Match> {
        self.decide(usize::MAX)
    }

    fn expect(&mut self, end: End) {
        if !self.is_closed(&end) {
            self.due = self.due.min(self.safe_at(&end));
            let place = self
                .pending
                .partition_point(|other| other.order < end.order);
            self.pending.insert(place, end);
        }
    }

    /// The frame from which on none to come can change what becomes of `end`.
    fn safe_at(&self, end: &End) -> usize {
        let (cost, last) = end.order;
        if cost == 0 {
            return last;
        }
        let is_open = last + greater(self.longest);
        is_open.max(end.span.start + lesser(self.longest) + self.longest - 1)
    }

    /// Decides what can be decided when `frame` has come.
    fn decide(&mut self, frame: usize) -> Vec<Match> {
        let mut found = Vec::new();
        let mut undecided: Vec<End> = Vec::new();
        self.due = usize::MAX;
        for end in std::mem::take(&mut self.pending) {
            if self.is_closed(&end) {
                continue;
            }
            let safe_at = self.safe_at(&end);
            let may_change = |earlier: &End| self.may_change(earlier, &end);
            if safe_at > frame {
                self.due = self.due.min(safe_at);
                undecided.push(end);
            } else if undecided.iter().any(may_change) {
                undecided.push(end);
            } else {
                found.extend(self.take(end));
            }
        }
        self.pending = undecided;
        self.forget(frame);
        found
    }

    /// Whether an end has been closed by one before it in the order.
    fn is_closed(&self, end: &End) -> bool {
        let (_, last) = end.order;
        let mut before = self.before(end.order);
        before.any(|decided| decided.closed.contains(&last))
    }

    fn before(&self, order: Order) -> impl Iterator<Item = &Decided> {
        self.decided
            .iter()
            .filter(move |decided| decided.order < order)
    }

    /// Whether `end`, which comes later in the order, may depend on what becomes of `earlier`.
    fn may_change(&self, earlier: &End, end: &End) -> bool {
        let closed = closed(earlier.order.1, self.longest);
        closed.contains(&end.order.1) || Claim::of(&earlier.span).starts.contains(&end.span.start)
    }

    /// Takes an end that is not closed: a match unless its start is claimed.
    fn take(&mut self, end: End) -> Option<Match> {
        let claims = self.before(end.order);
        let claims = claims.filter_map(|decided| Some((decided.order, decided.claim.as_ref()?)));
        let claimed = claims
            .filter(|(_, claim)| claim.starts.contains(&end.span.start))
            .max_by_key(|(order, _)| *order)
            .map(|(_, claim)| claim.length);
        let claim = claimed.is_none().then(|| Claim::of(&end.span));
        self.decided.push(Decided {
            order: end.order,
            closed: closed(end.order.1, claimed.unwrap_or(end.span.len())),
            claim,
        });
        let cost = self.matcher.cost(end.order.0)?;
        claimed.is_none().then_some(Match {
            span: end.span,
            cost,
        })
    }

    /// Forgets what can meet neither an undecided end nor one that comes after `frame`.
    fn forget(&mut self, frame: usize) {
        let ends = self.pending.iter().map(|end| end.order.1);
        let first_end = ends.min().unwrap_or(usize::MAX).min(frame);
        let starts = self.pending.iter().map(|end| end.span.start);
        let first_start = starts.min().unwrap_or(usize::MAX);
        let first_start = first_start.min(frame.saturating_sub(self.longest));
        self.decided.retain(|decided| {
            let claim = decided.claim.as_ref();
            decided.closed.end > first_end || claim.is_some_and(|c| c.starts.end > first_start)
        });
    }
}
