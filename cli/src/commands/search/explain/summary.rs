//! A hit in a line.

use relfeat::FeatureSet;

use super::super::mismatch::list;
use super::agreement::{Agreement, Stretch};
use crate::output::count;

/// Features that differ that the line below a hit names, with the segments they differ in.
const DIFFERENT_NAMED: usize = 5;

/// Masked features that the line below a hit names.
const LEAST_NAMED: usize = 3;

/// The set bits, the lowest first.
pub(super) fn bits(bits: u64) -> impl Iterator<Item = usize> {
    (0..u64::BITS as usize).filter(move |bit| bits >> bit & 1 == 1)
}

/// A hit in a line: the compared features that differ and where, and the masked features that are least alike.
pub(super) fn summary(set: &FeatureSet, agreement: &Agreement) -> String {
    let stretches = || agreement.stretches.iter();
    let compared = stretches().fold(0, |all, s| all | s.compared) & agreement.known;
    let different = stretches().fold(0, |all, s| all | agreement.compared(s).1);
    let n = compared.count_ones() as usize;
    let n_equal = n - different.count_ones() as usize;
    let mut text = match different {
        0 => format!("{} equal", count(n, "feature")),
        _ => format!("{n_equal} of {} equal", count(n, "feature")),
    };
    let named = bits(different).take(DIFFERENT_NAMED).map(|bit| {
        let numbered = stretches().zip(1..);
        let differs = |s: &Stretch| agreement.compared(s).1 >> bit & 1 == 1;
        let at = numbered.filter(|(s, _)| differs(s)).map(|(_, at)| at);
        let name = &set.features()[bit].name;
        format!("{name} ({})", list(&at.collect::<Vec<_>>()))
    });
    let mut named: Vec<String> = named.collect();
    if n - n_equal > named.len() {
        named.push(format!("{} more", n - n_equal - named.len()));
    }
    if !named.is_empty() {
        text += &format!(", different {}", named.join(", "));
    }
    let shares: Vec<(usize, usize, usize)> = bits(agreement.known)
        .filter_map(|bit| {
            let masked = stretches().filter(|s| s.compared >> bit & 1 == 0);
            let (alike, all) = masked.fold((0, 0), |(alike, all), s| {
                (alike + agreement.n_alike(s, bit), all + s.hit.len())
            });
            (all > 0).then_some((bit, alike, all))
        })
        .collect();
    if shares.is_empty() {
        return text;
    }
    let (alike, all) = shares.iter().fold((0, 0), |(a, b), s| (a + s.1, b + s.2));
    text += &format!("; {} masked, alike {}", shares.len(), percent(alike, all));
    let mut least: Vec<_> = shares
        .into_iter()
        .filter(|(_, alike, all)| alike < all)
        .collect();
    // By share, then by number: those come in order, and the sort is stable.
    least.sort_by(|a, b| (a.1 * b.2).cmp(&(b.1 * a.2)));
    least.truncate(LEAST_NAMED);
    let least = least
        .into_iter()
        .map(|(bit, alike, all)| format!("{} {}", set.features()[bit].name, percent(alike, all)));
    let least: Vec<String> = least.collect();
    if !least.is_empty() {
        text += &format!(", least {}", least.join(", "));
    }
    text
}

/// A share, rounded down, so that only all is 100 %.
fn percent(part: usize, all: usize) -> String {
    format!("{} %", 100 * part / all.max(1))
}
