//! The features of spec.md b written out one by one.

use super::{
    Clip, Is, LessOrEqual, More, MoreOrEqual, NEAR, Point, cross, dot, minus, norm, trigger,
};
use crate::figure;

/// One value per frame; `None` where this twin does not know it: rounding decides, or a step is
/// missing inside a window.
type Values = Vec<Option<f64>>;

/// θ1 and θ2 of the authors' code, and the one of the paper.
type Levels = [Is; 3];

/// Where a segment ends in a plane instead of a ball.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Start {
    Ball,
    Flat,
}

/// The smallest or largest value, NaN if one is.
pub(crate) fn extreme(values: &[f64], largest: bool) -> f64 {
    let mut sorted = values.to_vec();
    if values.iter().any(|v| v.is_nan()) {
        return f64::NAN;
    }
    sorted.sort_by(f64::total_cmp);
    if largest {
        sorted[sorted.len() - 1]
    } else {
        sorted[0]
    }
}

impl Clip {
    pub(crate) fn at(&self, name: &str, t: usize) -> Point {
        self.paths[figure::idx(name)][t]
    }

    pub(crate) fn n_frames(&self) -> usize {
        self.n
    }

    /// Three cases: before the first end, beyond the second, or between, where the distance is the
    /// height of a triangle.
    pub(crate) fn segment_distance(
        &self,
        t: usize,
        of: &str,
        ends: [&str; 2],
        start: Start,
    ) -> Option<f64> {
        let [q, a, b] = [of, ends[0], ends[1]].map(|name| self.at(name, t));
        let axis = minus(b, a);
        if norm(axis) == 0.0 {
            return Some(norm(minus(q, a)));
        }
        let before = dot(minus(q, a), axis);
        if let Start::Flat = start {
            if before.abs() <= NEAR * norm(axis) * norm(minus(q, a)) {
                return None;
            } else if before < 0.0 {
                return Some(norm(minus(q, b)));
            }
        }
        Some(if before <= 0.0 {
            norm(minus(q, a))
        } else if dot(minus(q, b), axis) >= 0.0 {
            norm(minus(q, b))
        } else {
            norm(cross(axis, minus(q, a))) / norm(axis)
        })
    }

    /// Over the radius, which is in multiples of the segment's length in the first frame.
    fn outside(&self, t: usize, of: &str, ends: [&str; 2], radius: f64) -> f64 {
        let segment_distance = self.segment_distance(t, of, ends, Start::Ball);
        segment_distance.unwrap() - radius * self.length(ends[0], ends[1])
    }

    fn known_speed(&self, names: &[&str], ms: f64) -> Values {
        let speeds: Vec<Vec<f64>> = names.iter().map(|name| self.speed(name, ms)).collect();
        (0..self.n)
            .map(|t| {
                let speeds: Vec<f64> = speeds.iter().map(|s| s[t]).collect();
                Some(extreme(&speeds, false)).filter(|v| !v.is_nan())
            })
            .collect()
    }

    fn frames(&self, value: impl Fn(usize) -> f64) -> Values {
        (0..self.n).map(|t| Some(value(t))).collect()
    }

    /// Bit `bit` of the set's words.
    fn feature2005(&self, bit: usize) -> (Values, Levels) {
        let hl = self.length("rshoulder", "relbow");
        let fl = self.length("rhip", "rknee");
        let sw = self.length("rshoulder", "lshoulder");
        let hw = self.length("rhip", "lhip");
        let chest = self.length("chest", "neck");
        // No body length, no threshold, not even of none.
        let zero = |length: f64| 0.0 * length;
        let known = |values: Vec<f64>| -> Values { values.into_iter().map(Some).collect() };
        let below = Is::Less;
        let least = |strict, loose, text| [strict, loose, text].map(MoreOrEqual);
        let most = |strict, loose, text| [strict, loose, text].map(LessOrEqual);
        // The paper calls a bent joint one of less than 120 degrees.
        let bent = |strict, loose| [LessOrEqual(strict), LessOrEqual(loose), below(120.0)];
        let faster = |strict, loose, text| [strict, loose, text].map(More);
        match bit {
            0 => {
                let n = self.normal("root", "lankle", "lhip");
                (
                    known(self.along(&n, "lhip", "rtoes")),
                    least(zero(fl), -0.25 * fl, zero(fl)),
                )
            }
            1 => {
                // The mirror image of the plane above, which points the other way: swapped.
                let n = self.normal("root", "rhip", "rankle");
                (
                    known(self.along(&n, "rankle", "ltoes")),
                    least(zero(fl), -0.25 * fl, zero(fl)),
                )
            }
            2 | 3 => {
                let toes = ["rtoes", "ltoes"][bit - 2];
                let up = [0.0, 1.0, 0.0];
                let below_root =
                    self.frames(|t| dot(up, minus(self.at(toes, t), self.at("root", t))));
                (below_root, least(-1.2 * fl, -1.4 * fl, -1.4 * fl))
            }
            4 => (
                self.known_speed(&["rtoes", "rankle"], 100.0),
                faster(fl, fl, fl),
            ),
            5 => (
                self.known_speed(&["ltoes", "lankle"], 100.0),
                faster(fl, fl, fl),
            ),
            6 => (
                known(self.angle("rknee", "rhip", "rknee", "rankle")),
                bent(110.0, 120.0),
            ),
            7 => (
                known(self.angle("lknee", "lhip", "lknee", "lankle")),
                bent(110.0, 120.0),
            ),
            8 => {
                let n = self.direction("lhip", "rhip");
                (
                    known(self.along(&n, "rhip", "rankle")),
                    least(1.2 * hw, hw, hw),
                )
            }
            9 => {
                let n = self.direction("rhip", "lhip");
                (
                    known(self.along(&n, "lhip", "lankle")),
                    least(1.2 * hw, hw, hw),
                )
            }
            10 => {
                let n = self.direction("lhip", "rhip");
                let (r, l) = (
                    self.along(&n, "lhip", "rankle"),
                    self.along(&n, "lhip", "lankle"),
                );
                (
                    self.frames(|t| r[t] - l[t]),
                    most(-0.125 * hw, zero(hw), zero(hw)),
                )
            }
            11 | 12 => {
                let wrist = ["rwrist", "lwrist"][bit - 11];
                let n = self.normal("root", "lshoulder", "rshoulder");
                (
                    known(self.along(&n, "rshoulder", wrist)),
                    least(1.15 * hl, hl, hl),
                )
            }
            13 | 14 => {
                let wrist = ["rwrist", "lwrist"][bit - 13];
                let n = self.direction("chest", "neck");
                (
                    known(self.along(&n, "neck", wrist)),
                    least(0.15 * chest, -chest, zero(chest)),
                )
            }
            15 => {
                let n = self.direction("lshoulder", "rshoulder");
                (
                    known(self.along(&n, "rshoulder", "rwrist")),
                    least(0.5 * sw, 0.4 * sw, 0.4 * sw),
                )
            }
            16 => {
                let n = self.direction("rshoulder", "lshoulder");
                (
                    known(self.along(&n, "lshoulder", "lwrist")),
                    least(0.5 * sw, 0.4 * sw, 0.4 * sw),
                )
            }
            17 => (
                known(self.angle("relbow", "rshoulder", "relbow", "rwrist")),
                bent(110.0, 120.0),
            ),
            18 => (
                known(self.angle("lelbow", "lshoulder", "lelbow", "lwrist")),
                bent(110.0, 120.0),
            ),
            19 => (
                self.known_speed(&["rfingers"], 100.0),
                faster(1.25 * hl, hl, hl),
            ),
            20 => (
                self.known_speed(&["lfingers"], 100.0),
                faster(1.25 * hl, hl, hl),
            ),
            21 => {
                let n = self.direction("lshoulder", "rshoulder");
                let (r, l) = (
                    self.along(&n, "lshoulder", "rwrist"),
                    self.along(&n, "lshoulder", "lwrist"),
                );
                (
                    self.frames(|t| r[t] - l[t]),
                    most(-0.125 * sw, zero(sw), zero(sw)),
                )
            }
            22 => {
                let hand = self.length("rwrist", "rfingers");
                let (right, left) = (["rwrist", "rfingers"], ["lwrist", "lfingers"]);
                let apart = self.frames(|t| {
                    let distances = [
                        self.outside(t, "rwrist", left, 0.0),
                        self.outside(t, "rfingers", left, 0.0),
                        self.outside(t, "lwrist", right, 0.0),
                        self.outside(t, "lfingers", right, 0.0),
                    ];
                    extreme(&distances, false)
                });
                (apart, most(0.75 * hand, hand, hand))
            }
            23 | 24 => {
                let hand = [["rfingers", "rwrist"], ["lfingers", "lwrist"]][bit - 23];
                let apart = self.frames(|t| {
                    let mut distances = Vec::new();
                    for point in hand {
                        for leg in [["rknee", "rankle", "rtoes"], ["lknee", "lankle", "ltoes"]] {
                            distances.push(self.outside(t, point, [leg[0], leg[1]], 0.5));
                            distances.push(self.outside(t, point, [leg[1], leg[2]], 1.5));
                        }
                    }
                    extreme(&distances, false)
                });
                (apart, most(0.0, 0.0, 0.0))
            }
            25 | 26 => {
                let fingers = ["rfingers", "lfingers"][bit - 25];
                let ends = ["neck", "headtop"];
                let apart = (0..self.n)
                    .map(|t| self.segment_distance(t, fingers, ends, Start::Flat))
                    .collect();
                let length = self.length("neck", "headtop");
                (apart, most(length, length, length))
            }
            27 | 28 => {
                let fingers = ["rfingers", "lfingers"][bit - 27];
                let apart = self.frames(|t| self.outside(t, fingers, ["lhip", "rhip"], 0.0));
                (apart, most(hw, hw, hw))
            }
            29 => {
                let (r, l) = (
                    self.angle("root", "neck", "rhip", "rknee"),
                    self.angle("root", "neck", "lhip", "lknee"),
                );
                let both = self.frames(|t| extreme(&[r[t], l[t]], true));
                (both, bent(110.0, 110.0))
            }
            30 => (
                self.known_speed(&["root"], 12.0),
                faster(2.0 * hl, 2.0 * hl, 2.0 * hl),
            ),
            _ => panic!("there are 31 features"),
        }
    }

    /// Whether a feature of `mueller2005` is on in each frame; `None` where this twin does not know.
    pub(crate) fn states2005(&self, bit: usize) -> Vec<Option<bool>> {
        if self.n == 0 {
            return Vec::new();
        }
        let (values, [strict, loose, _]) = self.feature2005(bit);
        trigger(values.into_iter(), strict, loose)
    }

    /// The same of `mueller2005-text`.
    pub(crate) fn states2005_text(&self, bit: usize) -> Vec<Option<bool>> {
        if self.n == 0 {
            return Vec::new();
        }
        let (values, [.., text]) = self.feature2005(bit);
        trigger(values.into_iter(), text, text)
    }
}
