//! New clips beside an existing partition.

use crate::extract::closure::{Scratch, mean_half_frames};
use crate::extract::free::Free;
use crate::extract::rounds::Extraction;
use crate::extract::text::{Band, Text};
use crate::extract::{Closure, ExtractError, ExtractOptions, Partition, Substring};
use crate::{Accessibility, MotionString};

/// Partitions the clips of `string` that `old` does not cover, and keeps what it covers.
///
/// `old` covers some clips of `string` entirely, usually the first ones: the string of a larger
/// library begins with the string of the smaller one when labels come from the same clusters.
///
/// 1. Each bundle of `old`, in order, takes new members. Its members in turn, in order of position,
///    and each accepted one after them (or only the old ones, under [`Closure::Direct`]), bring
///    similar substrings of the new clips as a seed does in [`extract`](crate::extract), their
///    widths like the mean width of the old members. Then the γ test removes those new members
///    that are not like the mean of all. Mean width and volume are computed again.
/// 2. What is still free is partitioned as [`extract`](crate::extract) does it. Bundles follow the
///    old ones; degenerate submotions join the old ones by position.
///
/// Old members and old degenerate submotions are never changed, moved or removed, and old
/// degenerate submotions take no members.
///
/// # Errors
///
/// Those of [`extract`](crate::extract), and when the substrings of `old` overlap, leave their
/// clips, or cover a clip in part.
pub fn extend(
    old: &Partition,
    string: &MotionString,
    access: &Accessibility,
    options: &ExtractOptions,
) -> Result<Partition, ExtractError> {
    options.check()?;
    let text = Text::new(string, access, options.max_letters)?;
    let mut free = Free::all(string, &text);
    check(old, string)?;
    let mut partition = old.clone();
    for &substring in old.substrings() {
        free.mark(&text, substring);
    }
    let mut scratch = Scratch::new(&text);
    for bundle in &mut partition.bundles {
        let old_members = bundle.members.clone();
        let band = Band::around(mean_half_frames(&text, &old_members), options.gamma);
        scratch.begin(&old_members);
        match options.closure {
            Closure::Transitive => scratch.close((&text, &free), band, 0),
            Closure::Direct => {
                for &member in &old_members {
                    scratch.accept_like((&text, &free), band, member);
                }
            }
        }
        scratch.release();
        scratch.drop_unlike(&text, options.gamma, old_members.len());
        if let Some(grown) = scratch.bundle(&text, options.rho) {
            *bundle = grown;
        }
        for &member in &bundle.members {
            free.mark(&text, member);
        }
    }
    Extraction::new(text, free, options).run(&mut partition);
    Ok(partition)
}

impl Partition {
    /// All substrings, those of the bundles first.
    pub fn substrings(&self) -> impl Iterator<Item = &Substring> {
        let bundles = self.bundles.iter().flat_map(|bundle| &bundle.members);
        bundles.chain(&self.degenerate)
    }
}

/// That the substrings are disjoint and cover each clip wholly or not at all.
pub(crate) fn check(partition: &Partition, string: &MotionString) -> Result<(), ExtractError> {
    let mut is_covered = vec![false; string.len()];
    let mut covered = vec![0; string.n_clips()];
    for &substring in partition.substrings() {
        let Substring { first, last } = substring;
        let overlap = ExtractError::Overlap { first, last };
        if first >= last || string.width(first, last).is_none() {
            return Err(overlap);
        }
        for interval in substring.intervals() {
            if std::mem::replace(&mut is_covered[interval], true) {
                return Err(overlap);
            }
        }
        covered[string.runs()[first].clip] += last - first;
    }
    for (clip, found) in covered.into_iter().enumerate() {
        let span = string.clip_span(clip).unwrap_or_default();
        let n_intervals = span.len().saturating_sub(1);
        if found != 0 && found != n_intervals {
            return Err(ExtractError::Partly {
                clip,
                found,
                n_intervals,
            });
        }
    }
    Ok(())
}
