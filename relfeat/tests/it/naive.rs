//! The features of spec.md a.1 and a.2 written out one by one, over plain numbers.

use relfeat::ndarray::Array3;

use crate::figure;

pub(crate) mod features2005;

type Point = [f64; 3];

pub(crate) struct Clip {
    paths: Vec<Vec<Point>>,
    n: usize,
    rate: f64,
}

/// A comparison with a threshold.
#[derive(Clone, Copy)]
enum Is {
    More(f64),
    MoreOrEqual(f64),
    Less(f64),
    LessOrEqual(f64),
    Between(f64, f64),
}
use Is::{Between, Less, LessOrEqual, More, MoreOrEqual};

/// Values this close to a threshold, relative to metres, degrees or the threshold, may fall on either
/// side of it: sums in another order differ by some 1e-15 of their terms, which at 240 Hz are up to
/// hundreds of metres per second.
const NEAR: f64 = 1e-9;

impl Is {
    /// `None` where rounding decides.
    fn holds(self, value: f64) -> Option<bool> {
        let near = |x: f64| (value - x).abs() <= NEAR * (1.0 + x.abs() + value.abs());
        match self {
            More(x) | MoreOrEqual(x) | Less(x) | LessOrEqual(x) if near(x) => None,
            Between(a, b) if near(a) || near(b) => None,
            More(x) => Some(value > x),
            MoreOrEqual(x) => Some(value >= x),
            Less(x) => Some(value < x),
            LessOrEqual(x) => Some(value <= x),
            Between(a, b) => Some(a <= value && value <= b),
        }
    }
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

impl Clip {
    pub(crate) fn new(positions: &Array3<f32>, rate: f64) -> Clip {
        let n = positions.dim().0;
        let at = |frame, joint| [0, 1, 2].map(|axis| f64::from(positions[[frame, joint, axis]]));
        let path = |joint| (0..n).map(|frame| at(frame, joint)).collect();
        Clip {
            paths: (0..24).map(path).collect(),
            n,
            rate,
        }
    }

    fn path(&self, name: &str) -> &[Point] {
        &self.paths[figure::idx(name)]
    }

    fn length(&self, a: &str, b: &str) -> f64 {
        norm(minus(self.path(a)[0], self.path(b)[0]))
    }

    /// b − a in every frame.
    fn between(&self, a: &str, b: &str) -> Vec<Point> {
        (0..self.n)
            .map(|t| minus(self.path(b)[t], self.path(a)[t]))
            .collect()
    }

    /// Unit vectors; a vector without length keeps the unit vector before it.
    fn units(&self, vectors: Vec<Point>) -> Vec<Point> {
        let mut units: Vec<Point> = Vec::new();
        for v in vectors {
            let length = norm(v);
            let is_known = |unit: &&Point| !norm(**unit).is_nan();
            let before = units.iter().rev().find(is_known);
            let before = before.copied().unwrap_or([f64::NAN; 3]);
            units.push(if length == 0.0 {
                before
            } else {
                v.map(|x| x / length)
            });
        }
        units
    }

    /// n = (p1 − p3) × (p2 − p3).
    fn normal(&self, p1: &str, p2: &str, p3: &str) -> Vec<Point> {
        let (u, v) = (self.between(p3, p1), self.between(p3, p2));
        self.units((0..self.n).map(|t| cross(u[t], v[t])).collect())
    }

    fn direction(&self, from: &str, to: &str) -> Vec<Point> {
        self.units(self.between(from, to))
    }

    /// n · (q − p).
    fn along(&self, n: &[Point], p: &str, q: &str) -> Vec<f64> {
        let v = self.between(p, q);
        (0..self.n).map(|t| dot(n[t], v[t])).collect()
    }

    /// Forward differences, the last one repeated; padded by their mirror image, edge repeated, on both
    /// sides; averaged over a box; per second.
    fn velocity(&self, path: &[Point], ms: f64) -> Vec<Point> {
        if self.n < 2 {
            return vec![[0.0; 3]; self.n];
        }
        let mut v: Vec<Point> = (1..self.n).map(|t| minus(path[t], path[t - 1])).collect();
        v.push(v[self.n - 2]);
        let w = ((ms * self.rate / 1000.0).ceil() as usize).max(1);
        let half = w.div_ceil(2);
        let backwards: Vec<Point> = v.iter().rev().copied().collect();
        // From the edges outwards: there and back again, for as long as it takes.
        let before: Vec<Point> = v
            .iter()
            .chain(&backwards)
            .cycle()
            .take(half)
            .copied()
            .collect();
        let after: Vec<Point> = backwards
            .iter()
            .chain(&v)
            .cycle()
            .take(half)
            .copied()
            .collect();
        let mut padded: Vec<Point> = before.into_iter().rev().collect();
        padded.extend(v);
        padded.extend(after);
        let mut mean = Vec::new();
        for t in 0..self.n {
            // Samples t + 1 − half … t + w − half of the velocity; sample 0 is padded[half].
            let mut sum = [0.0; 3];
            for sample in &padded[t + 1..=t + w] {
                for axis in 0..3 {
                    sum[axis] += sample[axis];
                }
            }
            mean.push(sum.map(|s| s / w as f64 * self.rate));
        }
        mean
    }

    /// n · velocity of (q − p).
    fn moving(&self, n: &[Point], p: &str, q: &str, ms: f64) -> Vec<f64> {
        let v = self.velocity(&self.between(p, q), ms);
        (0..self.n).map(|t| dot(n[t], v[t])).collect()
    }

    fn speed(&self, q: &str, ms: f64) -> Vec<f64> {
        self.velocity(self.path(q), ms)
            .into_iter()
            .map(norm)
            .collect()
    }

    /// Degrees between a→b and c→d; while one of them has no length, what it was.
    fn angle(&self, a: &str, b: &str, c: &str, d: &str) -> Vec<f64> {
        self.angle_of(self.between(a, b), self.between(c, d))
    }

    fn angle_of(&self, u: Vec<Point>, v: Vec<Point>) -> Vec<f64> {
        let mut angles: Vec<f64> = Vec::new();
        for t in 0..self.n {
            let before = angles.iter().rev().find(|angle| !angle.is_nan());
            let before = before.copied().unwrap_or(f64::NAN);
            let is_missing = (norm(u[t]) + norm(v[t])).is_nan();
            angles.push(if is_missing {
                f64::NAN
            } else if norm(u[t]) == 0.0 || norm(v[t]) == 0.0 {
                before
            } else {
                let cosine = dot(u[t], v[t]) / norm(u[t]) / norm(v[t]);
                cosine.clamp(-1.0, 1.0).acos() * 180.0 / std::f64::consts::PI
            });
        }
        angles
    }

    fn lowest(&self, t: usize, but: &[&str]) -> f64 {
        let mut lowest = f64::INFINITY;
        for name in figure::names() {
            if !but.contains(&name) {
                lowest = lowest.min(self.path(name)[t][1]);
            }
        }
        lowest
    }

    fn highest(&self, t: usize) -> f64 {
        self.paths
            .iter()
            .map(|p| p[t][1])
            .fold(f64::NEG_INFINITY, f64::max)
    }

    fn above_lowest(&self, q: &str, but: &[&str]) -> Vec<f64> {
        (0..self.n)
            .map(|t| self.path(q)[t][1] - self.lowest(t, but))
            .collect()
    }

    fn spread(&self, t: usize, names: &[&str]) -> f64 {
        let mut largest = 0.0f64;
        for a in names {
            for b in names {
                let d = minus(self.path(a)[t], self.path(b)[t]);
                largest = largest.max((d[0] * d[0] + d[2] * d[2]).sqrt());
            }
        }
        largest
    }

    /// Values of feature F`number` and its tests: θ1, then θ2.
    fn feature(&self, number: usize) -> (Vec<f64>, Is, Is) {
        let hl = self.length("rshoulder", "relbow");
        let sw = self.length("rshoulder", "lshoulder");
        let hw = self.length("rhip", "lhip");
        let chest = self.length("chest", "neck");
        let body = self.length("rankle", "rknee")
            + self.length("rknee", "rhip")
            + self.length("root", "belly")
            + self.length("belly", "chest")
            + self.length("chest", "neck")
            + self.length("neck", "head")
            + self.length("head", "headtop");
        let hips = || self.direction("lhip", "rhip");
        let up = || self.direction("chest", "neck");
        match number {
            1 => {
                let n = self.normal("neck", "rhip", "lhip");
                (
                    self.moving(&n, "lhip", "rwrist", 250.0),
                    More(1.8 * hl),
                    More(1.3 * hl),
                )
            }
            2 => {
                let n = self.normal("neck", "rhip", "lhip");
                (
                    self.moving(&n, "lhip", "lwrist", 250.0),
                    More(1.8 * hl),
                    More(1.3 * hl),
                )
            }
            3 => (
                self.along(&up(), "neck", "rwrist"),
                MoreOrEqual(0.2 * chest),
                MoreOrEqual(0.0),
            ),
            4 => (
                self.along(&up(), "neck", "lwrist"),
                MoreOrEqual(0.2 * chest),
                MoreOrEqual(0.0),
            ),
            5 => (
                self.moving(&up(), "neck", "rwrist", 250.0),
                More(1.8 * hl),
                More(1.3 * hl),
            ),
            6 => (
                self.moving(&up(), "neck", "lwrist", 250.0),
                More(1.8 * hl),
                More(1.3 * hl),
            ),
            7 => (
                self.angle("relbow", "rshoulder", "relbow", "rwrist"),
                Between(0.0, 110.0),
                Between(0.0, 120.0),
            ),
            8 => (
                self.angle("lelbow", "lshoulder", "lelbow", "lwrist"),
                Between(0.0, 110.0),
                Between(0.0, 120.0),
            ),
            9 => {
                let n = self.direction("lshoulder", "rshoulder");
                let apart = self
                    .along(&n, "lwrist", "rwrist")
                    .into_iter()
                    .map(f64::abs)
                    .collect();
                (apart, MoreOrEqual(2.5 * sw), MoreOrEqual(2.0 * sw))
            }
            10 => {
                let n = self.direction("lwrist", "rwrist");
                (
                    self.moving(&n, "rwrist", "lwrist", 100.0),
                    MoreOrEqual(1.4 * hl),
                    MoreOrEqual(1.2 * hl),
                )
            }
            11 => {
                let n = self.direction("rwrist", "root");
                (
                    self.moving(&n, "rwrist", "root", 0.0),
                    MoreOrEqual(1.4 * hl),
                    MoreOrEqual(1.2 * hl),
                )
            }
            12 => {
                let n = self.direction("lwrist", "root");
                (
                    self.moving(&n, "lwrist", "root", 0.0),
                    MoreOrEqual(1.4 * hl),
                    MoreOrEqual(1.2 * hl),
                )
            }
            13 => (
                self.speed("rfingers", 100.0),
                MoreOrEqual(2.5 * hl),
                MoreOrEqual(2.0 * hl),
            ),
            14 => (
                self.speed("lfingers", 100.0),
                MoreOrEqual(2.5 * hl),
                MoreOrEqual(2.0 * hl),
            ),
            15 => {
                let n = self.normal("root", "lhip", "lankle");
                (
                    self.along(&n, "lankle", "rankle"),
                    MoreOrEqual(0.375 * hl),
                    MoreOrEqual(0.0),
                )
            }
            16 => {
                let n = self.normal("root", "rankle", "rhip");
                (
                    self.along(&n, "rhip", "lankle"),
                    MoreOrEqual(0.375 * hl),
                    MoreOrEqual(0.0),
                )
            }
            17 => (
                self.above_lowest("rtoes", &[]),
                MoreOrEqual(1.2 * hl),
                MoreOrEqual(hl),
            ),
            18 => (
                self.above_lowest("ltoes", &[]),
                MoreOrEqual(1.2 * hl),
                MoreOrEqual(hl),
            ),
            19 => {
                let apart = self
                    .along(&hips(), "lankle", "rankle")
                    .into_iter()
                    .map(f64::abs)
                    .collect();
                (apart, MoreOrEqual(2.1 * hl), MoreOrEqual(1.8 * hl))
            }
            20 => (
                self.angle("rknee", "rhip", "rknee", "rankle"),
                Between(0.0, 110.0),
                Between(0.0, 120.0),
            ),
            21 => (
                self.angle("lknee", "lhip", "lknee", "lankle"),
                Between(0.0, 110.0),
                Between(0.0, 120.0),
            ),
            22 => {
                let (r, l) = (
                    self.along(&hips(), "lhip", "rankle"),
                    self.along(&hips(), "lhip", "lankle"),
                );
                let crossed = r.iter().zip(&l).map(|(r, l)| r - l).collect();
                (crossed, LessOrEqual(-0.125 * hw), LessOrEqual(0.0))
            }
            23 | 24 => {
                let n = hips();
                let l = self.velocity(&self.between("rhip", "lankle"), 100.0);
                let r = self.velocity(&self.between("rhip", "rankle"), 100.0);
                let sign = if number == 23 { 1.0 } else { -1.0 };
                let closer = (0..self.n)
                    .map(|t| sign * dot(minus(l[t], r[t]), n[t]))
                    .collect();
                (closer, MoreOrEqual(1.5 * hl), MoreOrEqual(1.3 * hl))
            }
            25 | 26 => {
                let side = if number == 25 {
                    ["rtoes", "rankle"]
                } else {
                    ["ltoes", "lankle"]
                };
                let (a, b) = (self.speed(side[0], 100.0), self.speed(side[1], 100.0));
                let slower = a.iter().zip(&b).map(|(a, b)| a.min(*b)).collect();
                (slower, MoreOrEqual(2.5 * hl), MoreOrEqual(2.0 * hl))
            }
            27 => (
                self.angle("neck", "root", "rshoulder", "relbow"),
                More(30.0),
                More(25.0),
            ),
            28 => (
                self.angle("neck", "root", "lshoulder", "lelbow"),
                More(30.0),
                More(25.0),
            ),
            29 => (
                self.angle("neck", "root", "rhip", "rknee"),
                More(50.0),
                More(45.0),
            ),
            30 => (
                self.angle("neck", "root", "lhip", "lknee"),
                More(50.0),
                More(45.0),
            ),
            31 => {
                let n = self.normal("rankle", "neck", "lankle");
                (
                    self.along(&n, "lankle", "root"),
                    More(0.5 * hl),
                    More(0.35 * hl),
                )
            }
            32 => {
                let up = vec![[0.0, 1.0, 0.0]; self.n];
                (
                    self.angle_of(self.between("root", "neck"), up),
                    Between(70.0, 110.0),
                    Between(60.0, 120.0),
                )
            }
            33 => (
                self.above_lowest("rfingers", &["rfingers", "rwrist"]),
                Less(1.2 * hl),
                Less(1.4 * hl),
            ),
            34 => (
                self.above_lowest("lfingers", &["lfingers", "lwrist"]),
                Less(1.2 * hl),
                Less(1.4 * hl),
            ),
            35 | 36 => {
                let n = self.normal("rhip", "lhip", "neck");
                let (l, r) = (
                    self.along(&n, "neck", "lshoulder"),
                    self.along(&n, "neck", "rshoulder"),
                );
                let sign = if number == 35 { 1.0 } else { -1.0 };
                let turned = l.iter().zip(&r).map(|(l, r)| sign * (l - r)).collect();
                (turned, More(0.40 * hl), More(0.35 * hl))
            }
            37 => {
                let tall = (0..self.n)
                    .map(|t| self.highest(t) - self.lowest(t, &[]))
                    .collect();
                (tall, LessOrEqual(0.8 * body), LessOrEqual(0.9 * body))
            }
            38 => {
                let points = ["lankle", "rankle", "lwrist", "rwrist", "headtop", "root"];
                let wide = (0..self.n).map(|t| self.spread(t, &points)).collect();
                (wide, MoreOrEqual(3.25 * hl), MoreOrEqual(3.0 * hl))
            }
            39 => (
                self.speed("root", 0.0),
                MoreOrEqual(2.3 * hl),
                MoreOrEqual(2.0 * hl),
            ),
            _ => panic!("there are 39 features"),
        }
    }

    /// Whether F`number` is on in each frame; `None` while rounding may have decided.
    pub(crate) fn states(&self, number: usize) -> Vec<Option<bool>> {
        if self.n == 0 {
            return Vec::new();
        }
        let (values, strict, loose) = self.feature(number);
        trigger(values.into_iter().map(Some), strict, loose)
    }
}

/// A Schmitt trigger over values of which some may be anything.
fn trigger(values: impl Iterator<Item = Option<f64>>, strict: Is, loose: Is) -> Vec<Option<bool>> {
    let mut state = Some(false);
    let mut states = Vec::new();
    for value in values {
        let strict = value.and_then(|v| strict.holds(v));
        let loose = value.and_then(|v| loose.holds(v));
        state = match state {
            Some(true) => loose,
            Some(false) => strict,
            None if loose == Some(false) => Some(false),
            None if strict == Some(true) => Some(true),
            None => None,
        };
        states.push(state);
    }
    states
}

/// The frames that are kept: for every tick of the library clock the frame nearest in time, the later
/// one of two, for as long as the nearest frame is one of the clip's.
pub(crate) fn kept_frames(n: usize, rate: f64, library_rate: f64) -> Vec<usize> {
    let mut kept = Vec::new();
    loop {
        let tick = kept.len() as f64;
        let mut nearest = 0;
        for frame in 0..=n {
            let distance = |frame: usize| (frame as f64 * library_rate - tick * rate).abs();
            if distance(frame) <= distance(nearest) {
                nearest = frame;
            }
        }
        if nearest == n {
            return kept;
        }
        kept.push(nearest);
    }
}
