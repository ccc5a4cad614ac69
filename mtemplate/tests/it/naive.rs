//! The definitions, cell by cell, without words or rolling rows.

use mtemplate::ndarray::{ArrayView1, ArrayView2};
use mtemplate::{Cell, Ending, Match, MatchConfig, QuantizedTemplate};

/// 0, 1 or wildcard, straight from the thresholds.
pub(crate) fn quantize(value: f64, threshold: f64) -> Cell {
    if value <= threshold {
        Cell::Zero
    } else if value >= 1.0 - threshold {
        Cell::One
    } else {
        Cell::Wildcard
    }
}

/// Local cost of column k and one frame.
pub(crate) fn local_cost(
    values: ArrayView2<'_, f64>,
    weights: ArrayView1<'_, f64>,
    threshold: f64,
    k: usize,
    word: u64,
) -> f64 {
    let (mut asked, mut disagreements) = (0, 0);
    for feature in 0..values.ncols() {
        let is_on = (word >> feature) & 1 == 1;
        match quantize(values[[k, feature]], threshold) {
            Cell::Wildcard => continue,
            Cell::Zero => disagreements += usize::from(is_on),
            Cell::One => disagreements += usize::from(!is_on),
        }
        asked += 1;
    }
    if asked == 0 {
        return 0.0;
    }
    disagreements as f64 / asked as f64 * ((weights[k] + 1.0) / 2.0) / values.nrows() as f64
}

/// Cost and start of the best match with column k at frame l, by trying every way there.
pub(crate) fn reach(c: &dyn Fn(usize, usize) -> f64, k: usize, l: usize) -> Option<(f64, usize)> {
    if k == 0 {
        return Some((c(0, l), l));
    }
    let mut best: Option<(f64, usize)> = None;
    for (dk, dl, weight) in [(1, 1, 1.0), (1, 2, 1.0), (2, 1, 2.0)] {
        if k < dk || l < dl {
            continue;
        }
        let Some((before, start)) = reach(c, k - dk, l - dl) else {
            continue;
        };
        let cost = before + weight * c(k, l);
        if best.is_none_or(|(best, _)| cost < best) {
            best = Some((cost, start));
        }
    }
    best
}

/// Endings in whole numbers, with every way to every cell tried; for templates of weights 1.
pub(crate) fn exact_endings(template: &QuantizedTemplate, words: &[u64]) -> Vec<Option<Ending>> {
    /// A multiple of all numbers of features asked for.
    const WHOLE: u64 = 6;
    let n_columns = template.n_columns();
    let doubled = template.clone().with_steps(mtemplate::Steps::Advance) == *template;
    let c = |k: usize, l: usize| {
        let (care, value) = template.words(k).unwrap();
        let n_asked = care.count_ones().max(1);
        u64::from((value ^ (words[l] & care)).count_ones()) * WHOLE / u64::from(n_asked)
    };
    let end = |l| {
        let (cost, start) = exact_reach(&c, doubled, n_columns.checked_sub(1)?, l)?;
        let cost = cost as f64 / (WHOLE * n_columns as u64) as f64;
        Some(Ending { cost, start })
    };
    (0..words.len()).map(end).collect()
}

fn exact_reach(
    c: &dyn Fn(usize, usize) -> u64,
    doubled: bool,
    k: usize,
    l: usize,
) -> Option<(u64, usize)> {
    if k == 0 {
        return Some((c(0, l), l));
    }
    let mut best: Option<(u64, usize)> = None;
    for (dk, dl, weight) in [(1, 1, 1), (1, 2, 1), (2, 1, 1 + u64::from(doubled))] {
        if k < dk || l < dl {
            continue;
        }
        let Some((before, start)) = exact_reach(c, doubled, k - dk, l - dl) else {
            continue;
        };
        let cost = before + weight * c(k, l);
        if best.is_none_or(|(best, _)| cost < best) {
            best = Some((cost, start));
        }
    }
    best
}

/// The least cost up to the threshold again and again, by looking at all of them; zones are blanked
/// number by number (spec.md d).
pub(crate) fn find_matches(mut ends: Vec<Option<Ending>>, config: &MatchConfig) -> Vec<Match> {
    let ceil = |share: f64, length: i64| (share * length as f64).ceil() as i64;
    let mut claimed: Vec<(i64, i64, i64)> = Vec::new();
    let mut found = Vec::new();
    while found.len() < config.max_matches {
        let mut least: Option<(i64, Ending)> = None;
        for (end, ending) in ends.iter().enumerate() {
            let Some(ending) = ending.filter(|ending| ending.cost <= config.tau) else {
                continue;
            };
            if least.is_none_or(|(_, least)| ending.cost < least.cost) {
                least = Some((end as i64, ending));
            }
        }
        let Some((end, Ending { cost, start })) = least else {
            break;
        };
        let start = start as i64;
        let mut length = end - start + 1;
        let mut is_claimed = false;
        for (from, to, claimed) in &claimed {
            if (*from..=*to).contains(&start) {
                length = *claimed;
                is_claimed = true;
            }
        }
        if !is_claimed {
            claimed.push((start - ceil(0.1, length), start + ceil(0.5, length), length));
            found.push(Match {
                span: start as usize..end as usize + 1,
                cost,
            });
        }
        for blank in end - ceil(0.5, length)..=end + ceil(0.1, length) {
            if let Some(ending) = usize::try_from(blank).ok().and_then(|b| ends.get_mut(b)) {
                *ending = None;
            }
        }
    }
    found
}
