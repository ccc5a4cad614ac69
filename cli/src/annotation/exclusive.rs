//! One label a frame.

use std::cmp::Ordering;

use super::Span;

/// Cuts spans down to the frames where each is the best of those that cover them: where it costs
/// least for its threshold, then the earliest in `spans` among equals. A span whose middle is taken
/// by a better one is left in two. Spans are in order of their frames.
///
/// O(n² log n) for n spans, which overlap a few at a time.
pub(super) fn exclusive(mut spans: Vec<Span>) -> Vec<Span> {
    // A stable sort: equals stay in their order.
    spans.sort_by(better);
    let mut taken: Vec<Span> = Vec::new();
    for span in spans {
        let mut free = vec![span.frames.clone()];
        free.retain(|part| !part.is_empty());
        for other in &taken {
            free = free
                .into_iter()
                .flat_map(|part| {
                    let before = part.start..part.end.min(other.frames.start);
                    let after = part.start.max(other.frames.end)..part.end;
                    [before, after]
                })
                .filter(|part| !part.is_empty())
                .collect();
        }
        taken.extend(free.into_iter().map(|frames| Span {
            frames,
            ..span.clone()
        }));
    }
    taken.sort_by_key(|span| span.frames.start);
    taken
}

fn better(a: &Span, b: &Span) -> Ordering {
    // Costs over thresholds, without a division by a threshold of nothing.
    (a.cost * b.tau).total_cmp(&(b.cost * a.tau))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn spans() -> impl Strategy<Value = Vec<Span>> {
        let span = (0..5usize, 0..30usize, 0..12usize, 0..4u8, 1..3u8);
        let span = span.prop_map(|(label, start, len, cost, tau)| Span {
            label,
            frames: start..start + len,
            cost: f64::from(cost) / 8.0,
            tau: f64::from(tau) / 2.0,
        });
        prop::collection::vec(span, 0..8)
    }

    /// The span that a frame belongs to, frame by frame.
    fn painted(spans: &[Span]) -> Vec<Option<usize>> {
        let owner = |frame: usize| {
            let covering = spans.iter().enumerate();
            let covering = covering.filter(|(_, span)| span.frames.contains(&frame));
            let ratio = |span: &Span| span.cost / span.tau;
            let best =
                covering.min_by(|a, b| ratio(a.1).total_cmp(&ratio(b.1)).then(a.0.cmp(&b.0)));
            best.map(|(i, _)| i)
        };
        (0..60).map(owner).collect()
    }

    proptest! {
        #[test]
        fn every_frame_belongs_to_the_best_span_that_covers_it(spans in spans()) {
            let found = exclusive(spans.clone());
            let owners = painted(&spans);
            for (frame, owner) in owners.iter().enumerate() {
                let covering: Vec<&Span> =
                    found.iter().filter(|span| span.frames.contains(&frame)).collect();
                let expected: Vec<usize> = owner.iter().map(|&i| spans[i].label).collect();
                let labels: Vec<usize> = covering.iter().map(|span| span.label).collect();
                prop_assert_eq!(labels, expected);
            }
            prop_assert!(found.is_sorted_by_key(|span| span.frames.start));
            prop_assert!(found.iter().all(|span| !span.frames.is_empty()));
        }
    }
}
