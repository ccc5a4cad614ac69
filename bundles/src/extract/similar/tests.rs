//! Searches over rows of several words, which strings short enough for the whole definition never need.

use ndarray::Array2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::*;
use crate::draw::below;
use crate::{Accessibility, spell};

const N_LETTERS: usize = 6;

/// Similar substrings of `seed`, a whole table for each first letter.
fn naive(text: &Text<'_>, free: &[bool], seed: Substring, band: Band) -> Vec<Candidate> {
    let mut found = Vec::new();
    let near = |a: usize, b: usize| {
        let d = text.access.distance_row(text.letters[a])[text.letters[b]];
        (d <= text.access.tau()).then_some(d)
    };
    for first in 0..text.len() {
        let columns = (first..text.len()).take(text.max_letters);
        let n = 1 + columns.clone().skip(1).take_while(|&k| free[k - 1]).count();
        let mut table = vec![vec![None::<(f64, u32)>; n]; seed.last - seed.first + 1];
        for i in 0..table.len() {
            for k in 0..n {
                let Some(d) = near(seed.first + i, first + k) else {
                    continue;
                };
                let mut before = vec![];
                if i > 0 {
                    before.push(table[i - 1][k]);
                }
                if k > 0 {
                    before.push(table[i][k - 1]);
                }
                if i > 0 && k > 0 {
                    before.push(table[i - 1][k - 1]);
                }
                if i + k == 0 {
                    before.push(Some((0.0, 0)));
                }
                let best = before.into_iter().flatten();
                let best = best.min_by(|a, b| a.partial_cmp(b).unwrap());
                table[i][k] = best.map(|(sum, cells)| (sum + d, cells + 1));
            }
        }
        for (k, cell) in table.pop().unwrap().into_iter().enumerate().skip(1) {
            let last = first + k;
            let substring = Substring { first, last };
            let width = text.width(substring);
            if let Some((sum, cells)) = cell.filter(|_| band.contains(width)) {
                found.push(Candidate {
                    mean: sum / f64::from(cells),
                    stretch: width.abs_diff(text.width(seed)),
                    substring,
                });
            }
        }
    }
    found
}

#[test]
fn long_rows_equal_whole_tables() {
    let mut dice = ChaCha8Rng::seed_from_u64(1);
    for round in 0..18 {
        let distances: Vec<f64> = (0..N_LETTERS * N_LETTERS)
            .map(|_| below(&mut dice, 8) as f64)
            .collect();
        let distances = Array2::from_shape_fn((N_LETTERS, N_LETTERS), |(a, b)| {
            if a == b {
                0.0
            } else {
                distances[a.min(b) * N_LETTERS + a.max(b)]
            }
        });
        // From what is only near itself to what is always near.
        let access = Accessibility::new(distances.view(), f64::from(round % 9)).unwrap();
        let mut labels = vec![0_u32];
        for _ in 0..300 {
            let next = below(&mut dice, N_LETTERS) as u32;
            let is_repeated = below(&mut dice, 2) == 0 && labels.len() > 120;
            labels.push(if is_repeated {
                labels[labels.len() - 120]
            } else {
                next
            });
        }
        let string = spell(&labels, std::slice::from_ref(&(0..labels.len()))).unwrap();
        let max_letters = 2 + below(&mut dice, 200);
        let text = Text::new(&string, &access, max_letters).unwrap();
        let free: Vec<bool> = (0..text.len()).map(|_| below(&mut dice, 150) > 0).collect();
        let is_inside = |(j, &is_free): (usize, &bool)| is_free && j + 1 < text.len();
        let intervals: Bits = free.iter().enumerate().map(is_inside).collect();
        let taken = Bits::none(text.len());
        let allowed = Allowed {
            free: &intervals,
            taken: &taken,
        };
        let first = below(&mut dice, text.len() - 1);
        let last = (first + 1 + below(&mut dice, 180)).min(text.len() - 1);
        let gamma = [0.0, 0.5, 0.8][below(&mut dice, 3)];
        let mut ends = Vec::new();
        for last in (first + 1..=last)
            .filter(|_| below(&mut dice, 60) == 0)
            .chain([last])
        {
            let width = text.width(Substring { first, last }) as f64;
            ends.push(End {
                last,
                band: Band::around(width, gamma),
            });
        }
        ends.dedup_by_key(|end| end.last);
        for ends in [&ends[..], &ends[ends.len() - 1..]] {
            let mut found = vec![Vec::new(); ends.len()];
            let emit = |end: usize, candidate| found[end].push(candidate);
            Search::default().similar((&text, allowed), first, ends, emit);
            for (end, found) in ends.iter().zip(found) {
                let last = end.last;
                assert_eq!(
                    found,
                    naive(&text, &free, Substring { first, last }, end.band)
                );
            }
        }
    }
}
