//! Laws of alignments, and a slow twin of the alignment of pieces.

use std::ops::Range;

use ndarray::{Array2, Array3};
use proptest::prelude::*;
use relfeat::{BodyMap, BodyPoint, Rig};

use super::blend::positions;
use super::pose::{Body, MIN_POINTS, shared_points};
use super::segments::{Level, align_pieces, pieces, rows_around};
use super::*;

type Path = Vec<(usize, usize)>;

/// The cheapest way to cell `(i, j)` and its cost by the definition, every way tried.
fn cheapest(
    (i, j): (usize, usize),
    lengths: (&[usize], &[usize]),
    rows: &[Range<usize>],
    distances: &Array2<u8>,
) -> Option<(f64, Path)> {
    if !rows[i].contains(&j) {
        return None;
    }
    let d = f64::from(distances[[i, j]]);
    let (len_a, len_b) = (lengths.0[i] as f64, lengths.1[j] as f64);
    if (i, j) == (0, 0) {
        return Some((d * len_a.max(len_b), vec![(0, 0)]));
    }
    let mut best: Option<(f64, Path)> = None;
    for (di, dj, weight) in [(1, 1, len_a.max(len_b)), (1, 0, len_a), (0, 1, len_b)] {
        if i < di || j < dj {
            continue;
        }
        if let Some((cost, mut path)) = cheapest((i - di, j - dj), lengths, rows, distances) {
            let cost = cost + d * weight;
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                path.push((i, j));
                best = Some((cost, path));
            }
        }
    }
    best
}

fn assert_is_path(path: &[(usize, usize)], n: usize, m: usize) {
    assert_eq!(path.first(), Some(&(0, 0)));
    assert_eq!(path.last(), Some(&(n - 1, m - 1)));
    for pair in path.windows(2) {
        let step = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
        assert!(matches!(step, (1, 1) | (1, 0) | (0, 1)), "{pair:?}");
    }
}

/// Lengths of up to six pieces per clip, small distances so that ties are common, and any rows.
fn coarse_problem() -> impl Strategy<Value = (Vec<usize>, Vec<usize>, Vec<Range<usize>>, Array2<u8>)>
{
    (1..7usize, 1..7usize).prop_flat_map(|(n, m)| {
        let lengths = |n| prop::collection::vec(1..5usize, n);
        let row =
            prop_oneof![3 => Just(0..m), 1 => (0..=m, 0..=m).prop_map(|(a, b)| a.min(b)..a.max(b))];
        let rows = prop::collection::vec(row, n);
        let distances = prop::collection::vec(0..4u8, n * m)
            .prop_map(move |d| Array2::from_shape_vec((n, m), d).unwrap());
        (lengths(n), lengths(m), rows, distances)
    })
}

/// A smooth motion of four points; now and then nothing moves for a while.
fn motion(len: Range<usize>) -> impl Strategy<Value = Poses> {
    let stroke = (1..30usize, prop::array::uniform12(-0.05f32..0.05));
    (len, prop::collection::vec(stroke, 1..12)).prop_map(|(n, strokes)| {
        let mut pose = [0.0f32; 12];
        let mut coords = Vec::new();
        let mut steps = strokes.iter().cycle();
        while coords.len() < 12 * n {
            if let Some((len, step)) = steps.next() {
                for k in 0..*len {
                    // A stroke, and a rest as long.
                    let share = if k % 2 == 0 { 1.0 } else { 0.0 };
                    pose.iter_mut().zip(step).for_each(|(p, s)| *p += share * s);
                    coords.extend(pose);
                }
            }
        }
        coords.truncate(12 * n);
        Poses::from_coords(Array2::from_shape_vec((n, 12), coords).unwrap())
    })
}

/// Words that change every so many frames.
fn words(n: usize, every: usize) -> Vec<u64> {
    (0..n).map(|t| (t / every) as u64).collect()
}

/// Sums of at most a few hundred distances below 10 m.
const SUM_TOLERANCE: f64 = 1e-9;

proptest! {
    #[test]
    fn pieces_are_aligned_as_trying_every_way_does((a, b, rows, distances) in coarse_problem()) {
        let ends = (a.len() - 1, b.len() - 1);
        let expected = cheapest(ends, (&a, &b), &rows, &distances).map(|(_, path)| path);
        let found = align_pieces(&a, &b, &rows, |i, j| f64::from(distances[[i, j]]));
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn pieces_tile_the_clip_and_are_cut_where_words_change(
        words in prop::collection::vec(0..3u64, 0..60),
        stride in 1..5usize,
        max_piece in 1..9usize,
    ) {
        let found = pieces(&words, stride, max_piece);
        let covered: Vec<usize> = found.iter().cloned().flatten().collect();
        prop_assert_eq!(covered, (0..words.len()).collect::<Vec<_>>());
        for piece in &found {
            prop_assert!(!piece.is_empty() && piece.len() <= max_piece);
            let sampled = piece.clone().filter(|t| t % stride == 0);
            let inside: Vec<u64> = sampled.map(|t| words[t]).collect();
            prop_assert!(inside.windows(2).all(|w| w[0] == w[1]));
        }
    }

    #[test]
    fn a_band_connects_both_ends_and_holds_the_path_it_is_made_of(
        a in motion(1..80), b in motion(1..80),
        (every_a, every_b) in (1..9usize, 1..9usize),
        (stride, margin) in (1..4usize, 0..4usize),
    ) {
        let cut = |clip: &Poses, every| pieces(&words(clip.n_frames(), every), 1, every);
        let coarse = (Level::new(&a, cut(&a, every_a)), Level::new(&b, cut(&b, every_b)));
        let whole = vec![0..coarse.1.len(); coarse.0.len()];
        let distance = |i: usize, j: usize| coarse.0.poses.distance(i, &coarse.1.poses, j);
        let path = align_pieces(&coarse.0.lengths(), &coarse.1.lengths(), &whole, distance).unwrap();
        assert_is_path(&path, coarse.0.len(), coarse.1.len());

        let fine = (Level::even(&a, stride), Level::even(&b, stride));
        let rows = rows_around(&path, (&coarse.0, &coarse.1), (&fine.0, &fine.1), margin);
        prop_assert!(rows.windows(2).all(|w| w[0].start <= w[1].start && w[0].end <= w[1].end));
        let through = align_pieces(&fine.0.lengths(), &fine.1.lengths(), &rows, |_, _| 1.0);
        assert_is_path(&through.unwrap(), fine.0.len(), fine.1.len());

        let same = rows_around(&path, (&coarse.0, &coarse.1), (&coarse.0, &coarse.1), margin);
        prop_assert!(path.iter().all(|&(i, j)| same[i].contains(&j)));
    }

    #[test]
    fn an_alignment_is_a_path_that_costs_its_steps_and_no_less_than_the_best(
        a in motion(60..140), b in motion(60..140),
        rate in prop::sample::select(vec![10.0, 30.0, 60.0, 120.0]),
        max_segment_cells in prop::sample::select(vec![4, 40, MAX_SEGMENT_CELLS]),
    ) {
        let (words_a, words_b) = (words(a.n_frames(), 7), words(b.n_frames(), 5));
        let side_a = Side { poses: &a, words: &words_a };
        let side_b = Side { poses: &b, words: &words_b };
        let resolution = Resolution { max_segment_cells, ..Resolution::new(rate) };
        let found = align(side_a, side_b, &resolution).unwrap().unwrap();
        assert_is_path(&found.steps, a.n_frames(), b.n_frames());
        let sum: f64 = found.steps.iter().map(|&(i, j)| a.distance(i, &b, j)).sum();
        prop_assert!((found.cost - sum).abs() <= SUM_TOLERANCE);
        let best = full_cost(&a, &b).unwrap().unwrap();
        prop_assert!(found.cost >= best - SUM_TOLERANCE);
        prop_assert!(found.cells.bands >= found.steps.len() as u64);
        prop_assert_eq!(found.cells.full, (a.n_frames() * b.n_frames()) as u64);
    }

    #[test]
    fn a_clip_is_aligned_with_itself_frame_by_frame_for_nothing(
        a in motion(1..200), rate in prop::sample::select(vec![30.0, 120.0]),
    ) {
        let words = words(a.n_frames(), 6);
        let side = Side { poses: &a, words: &words };
        let found = align(side, side, &Resolution::new(rate)).unwrap().unwrap();
        prop_assert_eq!(found.cost, 0.0);
        prop_assert_eq!(found.steps, (0..a.n_frames()).map(|t| (t, t)).collect::<Vec<_>>());
    }

    #[test]
    fn a_band_as_wide_as_the_clip_finds_the_best_path(a in motion(65..90), b in motion(65..90)) {
        // One rate only, so that no narrower band follows.
        let (words_a, words_b) = (words(a.n_frames(), 7), words(b.n_frames(), 5));
        let side_a = Side { poses: &a, words: &words_a };
        let side_b = Side { poses: &b, words: &words_b };
        let resolution = Resolution { margin: 10.0, ..Resolution::new(20.0) };
        let found = align(side_a, side_b, &resolution).unwrap().unwrap();
        prop_assert_eq!(Some(found.cost), full_cost(&a, &b).unwrap());
    }

    #[test]
    fn a_blend_lasts_as_its_weight_says_and_never_goes_back(
        steps in prop::collection::vec(0..3u8, 0..80), weight in 0.0..=1.0f64,
    ) {
        let mut path = vec![(0.0, 0.0)];
        for step in steps {
            let (i, j) = path[path.len() - 1];
            path.push(match step { 0 => (i + 1.0, j + 1.0), 1 => (i + 1.0, j), _ => (i, j + 1.0) });
        }
        let (n, m) = path[path.len() - 1];
        let found = positions(&path, weight, 30.0);
        let duration = (1.0 - weight) * n + weight * m;
        prop_assert_eq!(found.len(), duration.round() as usize + 1);
        prop_assert_eq!(found[0], (0.0, 0.0));
        prop_assert!(found.windows(2).all(|w| w[0].0 <= w[1].0 + SUM_TOLERANCE && w[0].1 <= w[1].1 + SUM_TOLERANCE));
        if found.len() > 1 {
            prop_assert_eq!(found[found.len() - 1], (n, m));
            for (k, &(i, j)) in found.iter().enumerate() {
                let expected = k as f64 * duration / (found.len() - 1) as f64;
                prop_assert!(((1.0 - weight) * i + weight * j - expected).abs() <= SUM_TOLERANCE);
            }
        }
    }

    #[test]
    fn poses_do_not_know_place_heading_and_height(
        at in prop::collection::vec(-1.0f32..1.0, 3 * NAMES.len()),
        (yaw, size) in (-3.2f32..3.2, 0.5f32..2.0),
        (x, y, z) in (-5.0f32..5.0, -1.0f32..1.0, -5.0f32..5.0),
    ) {
        let map = map(&NAMES);
        let points = shared_points(&map, &map).unwrap();
        let here = Array3::from_shape_vec((1, NAMES.len(), 3), at).unwrap();
        let (sin, cos) = yaw.sin_cos();
        let there = Array3::from_shape_fn(here.dim(), |(t, joint, axis)| {
            let p = |axis| here[[t, joint, axis]];
            let turned = [cos * p(0) + sin * p(2), p(1), cos * p(2) - sin * p(0)];
            size * turned[axis] + [x, y, z][axis]
        });
        let body = |positions: &Array3<f32>| {
            let body = Body { positions: positions.view(), map: &map };
            let scale = 1.0 / body.size(&points, &[0]).unwrap();
            body.poses(&points, &[0], scale).0
        };
        let width = |positions: &Array3<f32>| {
            let across = |axis| (0..2).map(|k| positions[[0, 1 + 2 * k, axis]] - positions[[0, 2 + 2 * k, axis]]).sum::<f32>();
            across(0).hypot(across(2))
        };
        // Nearer sides do not tell a heading.
        prop_assume!(width(&here).min(width(&there)) > 0.1);
        prop_assert!(body(&here).distance(0, &body(&there), 0) < POSE_TOLERANCE);
    }
}

/// Coordinates of a few metres in single precision, turned and divided.
const POSE_TOLERANCE: f64 = 1e-4;

/// Root, both hips, both shoulders, and a leg.
const NAMES: [&str; 7] = [
    "hips",
    "lhip",
    "rhip",
    "lshoulder",
    "rshoulder",
    "lknee",
    "lankle",
];

/// A map that places body points by their own names, `hips` being the root.
fn map(names: &[&str]) -> BodyMap {
    let all = BodyPoint::ALL.iter().map(|point| match point {
        BodyPoint::Root => "root = [\"hips\"]\n".to_owned(),
        _ => format!("{0} = [\"{0}\"]\n", point.name()),
    });
    let toml = format!("name = \"plain\"\n[points]\n{}", all.collect::<String>());
    BodyMap::with_rig(names, &Rig::from_toml(&toml).unwrap())
}

#[test]
fn clips_without_common_points_have_no_poses() {
    let legs = map(&["hips", "lhip", "rhip", "lknee", "rknee", "lankle", "rankle"]);
    let arms = map(&[
        "hips",
        "lshoulder",
        "rshoulder",
        "lelbow",
        "relbow",
        "lwrist",
        "rwrist",
    ]);
    assert!(shared_points(&legs, &legs).unwrap().len() >= MIN_POINTS);
    let too_few = shared_points(&legs, &arms).unwrap_err();
    assert!(too_few.n_shared < MIN_POINTS);
    assert!(too_few.to_string().contains("in common"), "{too_few}");
}

#[test]
fn frames_without_a_root_or_half_the_body_are_left_out() {
    let map = map(&NAMES);
    let points = shared_points(&map, &map).unwrap();
    let mut positions = Array3::from_shape_fn((4, NAMES.len(), 3), |(t, joint, axis)| {
        (t + joint * axis) as f32
    });
    positions[[1, 0, 0]] = f32::NAN;
    for joint in 3..NAMES.len() {
        positions[[2, joint, 1]] = f32::NAN;
    }
    positions[[3, 6, 2]] = f32::NAN;
    let body = Body {
        positions: positions.view(),
        map: &map,
    };
    let (poses, kept) = body.poses(&points, &[0, 1, 2, 3], 1.0);
    assert_eq!(kept, [0, 3]);
    let distances = poses.distances(0, &poses, 1);
    let known: Vec<f64> = distances.iter().copied().flatten().collect();
    assert!(known.len() < distances.len());
    let mean = known.iter().sum::<f64>() / known.len() as f64;
    assert!((poses.distance(0, &poses, 1) - mean).abs() <= SUM_TOLERANCE);
}

#[test]
fn nothing_is_aligned_with_nothing() {
    let none = Poses::from_coords(Array2::zeros((0, 12)));
    let one = Poses::from_coords(Array2::zeros((1, 12)));
    let resolution = Resolution::new(30.0);
    let side = |poses, words| Side { poses, words };
    assert_eq!(
        align(side(&none, &[]), side(&one, &[0]), &resolution),
        Ok(None)
    );
    assert_eq!(
        align(side(&one, &[]), side(&one, &[0]), &resolution),
        Ok(None)
    );
    assert_eq!(full_cost(&none, &one), Ok(None));
}

/// A swaying body: two frequencies, at a speed that changes, slightly another one for each clip.
fn swaying(n: usize, speed: f32) -> Poses {
    let coords = Array2::from_shape_fn((n, 12), |(t, axis)| {
        let t = t as f32 * speed / 30.0;
        let t = t + 0.5 * (0.3 * t).sin();
        let phase = axis as f32;
        0.3 * (2.0 * t + phase).sin() + 0.1 * (0.7 * t + 2.0 * phase).cos() * speed
    });
    Poses::from_coords(coords)
}

/// Long clips are aligned by pieces, whose path is near the best one, see the module.
const NEAR_THE_BEST: f64 = 0.02;

#[test]
fn the_mean_distance_is_that_of_the_best_path_however_long_clips_are() {
    for (n, m) in [(1, 1), (90, 120), (2_100, 2_200)] {
        let (a, b) = (swaying(n, 1.0), swaying(m, 1.1));
        let path = path_within(Band::Full, &a, &b).unwrap().unwrap();
        let expected = path.cost / path.steps.len() as f64;
        let found = mean_distance(&a, &b, 30.0).unwrap().unwrap();
        let is_whole = n * m <= MEAN_DISTANCE_CELLS;
        let tolerance = if is_whole {
            0.0
        } else {
            NEAR_THE_BEST * expected
        };
        assert!(
            (found - expected).abs() <= tolerance,
            "{n} {found} {expected}"
        );
        assert_eq!(mean_distance(&a, &a, 30.0).unwrap(), Some(0.0));
        let nothing = swaying(0, 1.0);
        assert_eq!(mean_distance(&a, &nothing, 30.0).unwrap(), None);
    }
}
