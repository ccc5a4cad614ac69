//! How well groups of stretches of clips, such as bundles, keep to what somebody has labelled.

use std::collections::BTreeMap;
use std::ops::Range;

use ndarray::{Array2, ArrayView1, ArrayView2, Axis, s};

use super::Bundled;

/// Stretches that are held to be alike: each the index of its clip and frames of the clip's file.
pub type Group = Vec<(usize, Range<usize>)>;

/// For each clip and frame of its file the label, `None` where there is none.
pub type FrameLabels = Vec<Vec<Option<String>>>;

/// Rounds of Lloyd's algorithm, if it does not settle before.
const MAX_ROUNDS: usize = 100;

/// Poses of a window that stand for it.
const PICKED: usize = 8;

/// The labels of the frames of take `stem` in a table of `take,first,last,label` lines, frames counting
/// from 1, the last one included; what goes beyond `n_frames` is cut off.
///
/// # Errors
/// The line that has other fields, or no frame of the take.
pub fn frame_labels(
    table: &str,
    stem: &str,
    n_frames: usize,
) -> Result<Vec<Option<String>>, String> {
    let mut labels = vec![None; n_frames];
    let own = table
        .lines()
        .filter(|line| line.split(',').next() == Some(stem));
    for line in own {
        let bad = || format!("expected take,first,last,label, found {line:?}");
        let fields: Vec<&str> = line.split(',').collect();
        let [_, first, last, label] = fields[..] else {
            return Err(bad());
        };
        let first: usize = first.parse().map_err(|_| bad())?;
        let last: usize = last.parse().map_err(|_| bad())?;
        let start = first.checked_sub(1).ok_or_else(bad)?;
        let span = labels.get_mut(start..last.min(n_frames)).ok_or_else(bad)?;
        span.fill(Some(label.to_owned()));
    }
    Ok(labels)
}

/// The share of the labelled frames of all groups that have the label that most frames of their group
/// have, and the number of labelled frames; no share where there are none.
#[must_use]
pub fn purity(groups: &[Group], labels: &FrameLabels) -> (Option<f64>, usize) {
    let (mut pure, mut all) = (0, 0);
    for group in groups {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for (clip, span) in group {
            let of_clip = labels
                .get(*clip)
                .and_then(|labels| labels.get(span.clone()));
            for label in of_clip.unwrap_or_default().iter().flatten() {
                *counts.entry(label).or_default() += 1;
            }
        }
        pure += counts.values().max().copied().unwrap_or_default();
        all += counts.values().sum::<usize>();
    }
    ((all > 0).then(|| pure as f64 / all as f64), all)
}

/// The submotions of each bundle.
#[must_use]
pub fn bundle_groups(bundled: &Bundled) -> Vec<Group> {
    let of_bundle = |bundle: &bundles::Bundle| {
        let spans = bundle.submotions.iter().filter_map(|submotion| {
            let (_, frames) = bundled.source(submotion)?;
            Some((submotion.clip, frames))
        });
        spans.collect()
    };
    bundled
        .model
        .graph()
        .bundles()
        .iter()
        .map(of_bundle)
        .collect()
}

/// Lloyd's k-means of clips cut into windows of `len` frames, at most `k` groups of them: what bundles have
/// to be better than. `reduced` are the clips' poses, of shape `(frames, components)`; a window is the chain
/// of eight of them, evenly spaced. It starts from evenly spaced windows; ties go to the earlier centre.
/// What is left at the end of a clip is in no window.
#[must_use]
pub fn window_groups(reduced: &[ArrayView2<'_, f64>], len: usize, k: usize) -> Vec<Group> {
    let len = len.max(1);
    let (mut windows, mut points) = (Vec::new(), Vec::new());
    for (clip, poses) in reduced.iter().enumerate() {
        for start in (0..poses.nrows() / len).map(|window| window * len) {
            windows.push((clip, start..start + len));
            let picked = (0..PICKED).map(|i| start + i * len / PICKED);
            points.extend(picked.flat_map(|frame| poses.row(frame).to_vec()));
        }
    }
    let dims = points.len() / windows.len().max(1);
    let points = Array2::from_shape_vec((windows.len(), dims), points).unwrap_or_default();
    let k = k.min(windows.len());
    let mut groups = vec![Group::new(); k];
    for (window, own) in windows.into_iter().zip(k_means(&points, k)) {
        groups[own].push(window);
    }
    groups
}

/// The centre of each point.
fn k_means(points: &Array2<f64>, k: usize) -> Vec<usize> {
    let n = points.nrows();
    let first: Vec<usize> = (0..k).map(|centre| centre * n / k).collect();
    let mut centres = points.select(Axis(0), &first);
    let mut nearest = vec![0; n];
    for _ in 0..MAX_ROUNDS {
        let before = nearest.clone();
        for (point, own) in points.rows().into_iter().zip(&mut nearest) {
            let distances = centres.rows().into_iter().map(|c| squares(point, c));
            let least = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            *own = least.map_or(0, |(centre, _)| centre);
        }
        for centre in 0..k {
            let own: Vec<usize> = (0..n).filter(|&point| nearest[point] == centre).collect();
            if let Some(mean) = points.select(Axis(0), &own).mean_axis(Axis(0)) {
                centres.slice_mut(s![centre, ..]).assign(&mean);
            }
        }
        if nearest == before {
            break;
        }
    }
    nearest
}

fn squares(a: ArrayView1<'_, f64>, b: ArrayView1<'_, f64>) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use ndarray::array;

    use super::*;

    const TABLE: &str = "take,first,last,label\na,1,2,walk\na,4,9,jump\nb,1,1,run\n";

    fn labels() -> FrameLabels {
        ["a", "b"]
            .map(|stem| frame_labels(TABLE, stem, 5).unwrap())
            .to_vec()
    }

    #[test]
    fn labels_count_from_one_and_include_their_last_frame() {
        let labels = labels();
        let of = |clip: usize| {
            labels[clip]
                .iter()
                .map(Option::as_deref)
                .collect::<Vec<_>>()
        };
        let (walk, jump) = (Some("walk"), Some("jump"));
        assert_eq!(of(0), [walk, walk, None, jump, jump]);
        assert_eq!(of(1), [Some("run"), None, None, None, None]);
    }

    #[test]
    fn lines_that_say_no_frames() {
        for line in [
            "a,0,2,walk",
            "a,1,x,walk",
            "a,1,2",
            "a,3,1,walk",
            "a,9,9,walk",
        ] {
            assert!(frame_labels(line, "a", 5).is_err(), "{line}");
        }
    }

    #[test]
    fn purity_counts_labelled_frames_of_the_majority() {
        // Two of walk, one of jump, one of none; then one of jump and one of run, of which either is most.
        let groups = [vec![(0, 0..4)], vec![(0, 4..5), (1, 0..3)]];
        assert_eq!(purity(&groups, &labels()), (Some(3.0 / 5.0), 5));
        assert_eq!(purity(&[vec![(1, 2..4)]], &labels()), (None, 0));
    }

    #[test]
    fn windows_of_two_places_are_two_groups() {
        let near = array![[0.0], [0.1], [9.0], [9.1], [0.2], [0.0], [5.0]];
        let far = array![[9.0], [9.0]];
        let groups = window_groups(&[near.view(), far.view()], 2, 2);
        assert_eq!(
            groups,
            [vec![(0, 0..2), (0, 4..6)], vec![(0, 2..4), (1, 0..2)]]
        );
        // No more groups than windows, and none of no windows.
        assert_eq!(window_groups(&[far.view()], 1, 5).len(), 2);
        assert!(window_groups(&[far.view()], 3, 5).is_empty());
    }
}
