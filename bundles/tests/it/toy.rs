//! Curves in the plane after figure 1: some run G O A C E N, one of them past H, others cross them and share A C E.

use bundles::ndarray::{Array1, Array2, ArrayView1};
use bundles::{
    Accessibility, ExtractOptions, Letter, MotionString, Partition, PoseClusters, SeedInstance,
    extract, max_letters, spell,
};

const LETTERS: [(char, f64, f64); 11] = [
    ('G', -5.0, 0.0),
    ('O', 10.0, 0.0),
    ('A', 20.0, 0.0),
    ('C', 30.0, 0.0),
    ('H', 30.0, 4.0),
    ('E', 40.0, 0.0),
    ('N', 55.0, 0.0),
    ('P', 20.0, 20.0),
    ('Q', 20.0, -20.0),
    ('T', 40.0, 20.0),
    ('U', 40.0, -20.0),
];
/// Between the distance of C and H, 4, and that of other neighbours, 10 and more.
const TAU: f64 = 5.0;

const ALONG: [(f64, f64); 2] = [(-5.0, 0.0), (55.0, 0.0)];
const PAST_H: [(f64, f64); 5] = [
    (-5.0, 0.0),
    (28.0, 0.0),
    (30.0, 4.0),
    (32.0, 0.0),
    (55.0, 0.0),
];

fn across(entry: f64, exit: f64) -> [(f64, f64); 4] {
    [(20.0, entry), (20.0, 0.0), (40.0, 0.0), (40.0, exit)]
}

/// Points about 1 apart along a polyline.
fn sampled(corners: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    for side in corners.windows(2) {
        let ((x, y), (to_x, to_y)) = (side[0], side[1]);
        let n = (to_x - x).hypot(to_y - y).round();
        let at = |k: f64| (x + (to_x - x) * k / n, y + (to_y - y) * k / n);
        points.extend((0..n as usize).map(|k| at(k as f64)));
    }
    points
}

fn nearest((x, y): (f64, f64)) -> u32 {
    let distance = |at: usize| (LETTERS[at].1 - x).hypot(LETTERS[at].2 - y);
    let nearest = (0..LETTERS.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    nearest.unwrap() as u32
}

fn string() -> MotionString {
    let curves: [&[(f64, f64)]; 7] = [
        &ALONG,
        &PAST_H,
        &ALONG,
        &across(20.0, 20.0),
        &across(20.0, -20.0),
        &across(-20.0, 20.0),
        &across(-20.0, -20.0),
    ];
    let (mut labels, mut clips) = (Vec::new(), Vec::new());
    for (index, corners) in curves.into_iter().enumerate() {
        let start = labels.len();
        // Each a little apart from the others.
        let shift = index as f64 / 10.0;
        labels.extend(
            sampled(corners)
                .into_iter()
                .map(|(x, y)| nearest((x, y + shift))),
        );
        clips.push(start..labels.len());
    }
    spell(&labels, &clips).unwrap()
}

fn text(string: &MotionString, first: usize, last: usize) -> String {
    let runs = &string.runs()[first..=last];
    runs.iter()
        .map(|run| LETTERS[run.letter.label() as usize].0)
        .collect()
}

fn extracted(rho: f64) -> (MotionString, Partition) {
    let string = string();
    let means = Array2::from_shape_fn((LETTERS.len(), 2), |(letter, dim)| {
        if dim == 0 {
            LETTERS[letter].1
        } else {
            LETTERS[letter].2
        }
    });
    let sigmas: Array1<f64> = Array1::ones(LETTERS.len());
    let clusters = PoseClusters::new(means.view(), ArrayView1::from(&sigmas)).unwrap();
    let letter = |label: usize| Letter::from_label(label as u32);
    let distances = Array2::from_shape_fn((LETTERS.len(), LETTERS.len()), |(a, b)| {
        clusters.distance(letter(a), letter(b)).unwrap()
    });
    let access = Accessibility::new(distances.view(), TAU).unwrap();
    let options = ExtractOptions {
        rho,
        // On a curve along, where both kinds of bundle contain it.
        seed: SeedInstance::First,
        ..ExtractOptions::new(max_letters(&string, 200.0))
    };
    let partition = extract(&string, &access, &options).unwrap();
    (string, partition)
}

/// The substrings of each bundle, by bundle.
fn texts(string: &MotionString, partition: &Partition) -> Vec<Vec<String>> {
    let of = |bundle: &bundles::StringBundle| {
        let members = bundle.members.iter();
        members
            .map(|member| text(string, member.first, member.last))
            .collect()
    };
    partition.bundles.iter().map(of).collect()
}

#[test]
fn curves_are_spelt_as_drawn() {
    let string = string();
    let clips = (0..7).map(|clip| string.clip_span(clip).unwrap());
    let spelt: Vec<String> = clips
        .map(|span| text(&string, span.start, span.end - 1))
        .collect();
    let expected = [
        "GOACEN", "GOACHCEN", "GOACEN", "PACET", "PACEU", "QACET", "QACEU",
    ];
    assert_eq!(spelt, expected);
}

#[test]
fn rho_1_bundles_what_all_share() {
    let (string, partition) = extracted(1.0);
    let bundles = texts(&string, &partition);
    assert_eq!(
        bundles[0],
        ["ACE", "ACHCE", "ACE", "ACE", "ACE", "ACE", "ACE"]
    );
    // What is left on both sides is bundled by where it comes from and where it goes.
    let mut rest = bundles[1..].to_vec();
    rest.sort();
    let twice = |text: &str| vec![text.to_owned(); 2];
    let thrice = |text: &str| vec![text.to_owned(); 3];
    let expected = [
        twice("ET"),
        twice("EU"),
        thrice("EN"),
        thrice("GOA"),
        twice("PA"),
        twice("QA"),
    ];
    assert_eq!(rest, {
        let mut all = expected.to_vec();
        all.sort();
        all
    });
    assert!(partition.degenerate.is_empty());
}

#[test]
fn rho_2_bundles_whole_curves() {
    let (string, partition) = extracted(2.0);
    let bundles = texts(&string, &partition);
    assert_eq!(bundles[0], ["GOACEN", "GOACHCEN", "GOACEN"]);
    // No other bundle mixes those that cross with those along.
    assert!(
        bundles[1..]
            .iter()
            .flatten()
            .all(|text| !text.contains(['G', 'O', 'N', 'H']))
    );
    assert!(bundles.len() < texts(&string, &extracted(1.0).1).len());
}
