//! Which frame of a clip each column of a template is matched with.

use crate::{MatchConfig, QuantizedTemplate};

#[derive(Clone, Copy, PartialEq)]
enum Way {
    None,
    Start,
    /// (template, data): (1,1).
    Both,
    /// (1,2).
    OverFrame,
    /// (2,1).
    OverColumn,
}

/// The frames of the columns in the first match of a clip by (cost, end); `None` where none is possible. A column that the
/// match skips has the frame of the next one. Steps and their weights are those of section d of spec.md.
pub(super) fn best_match(template: &QuantizedTemplate, words: &[u64]) -> Option<Vec<usize>> {
    let any = MatchConfig {
        tau: f64::INFINITY,
        max_matches: 1,
    };
    let span = template.find_matches(words, &any).into_iter().next()?.span;
    let mut frames = path(template, &words[span.clone()])?;
    frames.iter_mut().for_each(|frame| *frame += span.start);
    Some(frames)
}

/// The frames of the columns in the cheapest path through all of `words`.
fn path(template: &QuantizedTemplate, words: &[u64]) -> Option<Vec<usize>> {
    let (n_columns, n_frames) = (template.n_columns(), words.len());
    let end = n_frames.checked_sub(1)?;
    let cost = |k: usize, l: usize| template.local_cost(k, words[l]).unwrap_or_default();
    let mut ways = vec![Way::None; n_columns * n_frames];
    // Rows k − 2, k − 1 and k of the accumulated costs.
    let mut rows = [(); 3].map(|()| vec![f64::INFINITY; n_frames]);
    for k in 0..n_columns {
        let [two_before, before, row] = &mut rows;
        for l in 0..n_frames {
            let local = cost(k, l);
            let candidates = if k == 0 {
                let is_start = (local, Way::Start);
                [if l == 0 { is_start } else { OUT }, OUT, OUT]
            } else {
                let at = |row: &[f64], back: usize| {
                    l.checked_sub(back).map_or(f64::INFINITY, |l| row[l])
                };
                [
                    (at(before, 1) + local, Way::Both),
                    (at(before, 2) + local, Way::OverFrame),
                    (at(two_before, 1) + 2.0 * local, Way::OverColumn),
                ]
            };
            let mut best = OUT;
            for candidate in candidates {
                if candidate.0 < best.0 {
                    best = candidate;
                }
            }
            row[l] = best.0;
            ways[k * n_frames + l] = best.1;
        }
        rows.rotate_left(1);
    }
    let (mut k, mut l) = (n_columns - 1, end);
    let mut frames = vec![end; n_columns];
    loop {
        frames[k] = l;
        match ways[k * n_frames + l] {
            Way::None => return None,
            Way::Start => return Some(frames),
            Way::Both => (k, l) = (k - 1, l - 1),
            Way::OverFrame => (k, l) = (k - 1, l - 2),
            Way::OverColumn => {
                frames[k - 1] = l;
                (k, l) = (k - 2, l - 1);
            }
        }
    }
}

const OUT: (f64, Way) = (f64::INFINITY, Way::None);
