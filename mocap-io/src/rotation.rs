use nalgebra::{Matrix3, Quaternion, UnitQuaternion};

use crate::Axis;

/// Below this angle between two unit quaternions a straight line and the arc differ by less than
/// rounding: the relative error is angle²/6.
const STRAIGHT: f64 = 1e-7;

/// The cosine of the second angle below which the first and third one turn about the same axis.
/// Keeping one of them moves the result by at most this many radians.
const LOCKED: f64 = 1e-10;

/// Three rotation channels about three different axes: what can hold any rotation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Euler {
    /// Leftmost factor first.
    pub(crate) order: [Axis; 3],
    /// The column of each factor.
    pub(crate) columns: [usize; 3],
}

impl Euler {
    /// `None` unless `factors` (leftmost first) are three different axes.
    pub(crate) fn new(factors: &[(Axis, usize)]) -> Option<Euler> {
        match *factors {
            [(a, i), (b, j), (c, k)] if a != b && b != c && a != c => Some(Euler {
                order: [a, b, c],
                columns: [i, j, k],
            }),
            _ => None,
        }
    }

    /// The angles in a frame, in degrees.
    pub(crate) fn degrees(&self, row: &[f64]) -> [f64; 3] {
        self.columns.map(|column| row[column])
    }

    pub(crate) fn quaternion(&self, row: &[f64]) -> UnitQuaternion<f64> {
        let [a, b, c] = self.degrees(row);
        about(self.order[0], a) * about(self.order[1], b) * about(self.order[2], c)
    }

    /// Writes angles that are equivalent to `degrees`, as near as possible to those in `near`.
    pub(crate) fn write_degrees(&self, degrees: [f64; 3], near: &[f64], row: &mut [f64]) {
        let degrees = nearest_angles(degrees, self.degrees(near));
        for (column, degrees) in self.columns.into_iter().zip(degrees) {
            row[column] = degrees;
        }
    }

    /// Writes the angles of `rotation`, as near as possible to those in `near`.
    pub(crate) fn write(&self, rotation: &Matrix3<f64>, near: &[f64], row: &mut [f64]) {
        self.write_near(rotation, self.degrees(near), row);
    }

    /// Writes the angles of `rotation`, as near as possible to `near`.
    pub(crate) fn write_near(&self, rotation: &Matrix3<f64>, near: [f64; 3], row: &mut [f64]) {
        let degrees = euler_degrees(rotation, self.order, near);
        for (column, degrees) in self.columns.into_iter().zip(degrees) {
            row[column] = degrees;
        }
    }
}

/// The rotation about an axis.
pub(crate) fn about(axis: Axis, degrees: f64) -> UnitQuaternion<f64> {
    let (sin, cos) = (degrees.to_radians() * 0.5).sin_cos();
    let mut imaginary = [0.0; 3];
    imaginary[axis.idx()] = sin;
    let [x, y, z] = imaginary;
    UnitQuaternion::new_unchecked(Quaternion::new(cos, x, y, z))
}

/// The rotation at `t` (0 is `a`, 1 is `b`) of the way from `a` to `b`, the shorter way round, at
/// constant speed (Shoemake 1985). Of two ways of equal length it takes one, always the same.
pub(crate) fn slerp(a: UnitQuaternion<f64>, b: UnitQuaternion<f64>, t: f64) -> UnitQuaternion<f64> {
    let a = a.into_inner();
    // Opposite quaternions are the same rotation.
    let b = b.into_inner() * if a.dot(&b) < 0.0 { -1.0 } else { 1.0 };
    // An arc cosine would lose half the digits of a small angle.
    let (far, near) = ((a - b).norm(), (a + b).norm());
    let angle = 2.0 * far.atan2(near);
    let (from, to) = if angle < STRAIGHT {
        (1.0 - t, t)
    } else {
        // far = 2 sin(angle / 2), near = 2 cos(angle / 2)
        let sin = 0.5 * far * near;
        (((1.0 - t) * angle).sin() / sin, (t * angle).sin() / sin)
    };
    UnitQuaternion::new_normalize(a * from + b * to)
}

/// The angles in degrees of `rotation = R(order[0]) · R(order[1]) · R(order[2])`, axes all
/// different. Of all equivalent triples the one nearest to `near`; where the first and third angle turn
/// about the same axis (gimbal lock) the first one keeps its value. What is missing in `near` is 0.
pub(crate) fn euler_degrees(rotation: &Matrix3<f64>, order: [Axis; 3], near: [f64; 3]) -> [f64; 3] {
    let near = near.map(|v| if v.is_finite() { v } else { 0.0 });
    let [i, j, k] = order.map(Axis::idx);
    let sign = if (i + 1) % 3 == j { 1.0 } else { -1.0 };
    let m = rotation;
    let first = if m[(j, k)].hypot(m[(k, k)]) < LOCKED {
        near[0].to_radians()
    } else {
        (-sign * m[(j, k)]).atan2(m[(k, k)])
    };
    // With the first rotation undone the others stand in single entries, so that whatever rounding
    // did to the first angle the others make up for.
    let (sin, cos) = first.sin_cos();
    let sin = sign * sin;
    let undone_j = |column| cos * m[(j, column)] + sin * m[(k, column)];
    let undone_kk = cos * m[(k, k)] - sin * m[(j, k)];
    let second = (sign * m[(i, k)]).atan2(undone_kk);
    let third = (sign * undone_j(i)).atan2(undone_j(j));
    nearest_angles([first, second, third].map(f64::to_degrees), near)
}

/// The angle nearest to `near` of those that `degrees` is equal to but for full turns.
pub(crate) fn nearest_angle(degrees: f64, near: f64) -> f64 {
    let turns = ((near - degrees) / 360.0).round();
    if turns.is_finite() {
        degrees + 360.0 * turns
    } else {
        degrees
    }
}

/// Of the angles about three different axes that mean the same rotation as `degrees`, those nearest
/// to `near`.
pub(crate) fn nearest_angles(degrees: [f64; 3], near: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = degrees;
    let nearest = |angles: [f64; 3]| [0, 1, 2].map(|i| nearest_angle(angles[i], near[i]));
    let distance =
        |angles: [f64; 3]| -> f64 { (0..3).map(|i| (angles[i] - near[i]).powi(2)).sum() };
    let same = nearest(degrees);
    let other = nearest([a + 180.0, 180.0 - b, c + 180.0]);
    if distance(other) < distance(same) {
        other
    } else {
        same
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::rotate_columns;

    /// Angles are rounded to degrees and back; entries of a rotation are at most 1.
    const ROUNDING: f64 = 1e-14;

    const ORDERS: [[Axis; 3]; 6] = {
        let [x, y, z] = Axis::ALL;
        [
            [x, y, z],
            [x, z, y],
            [y, x, z],
            [y, z, x],
            [z, x, y],
            [z, y, x],
        ]
    };

    fn matrix(order: [Axis; 3], degrees: [f64; 3]) -> Matrix3<f64> {
        let mut matrix = Matrix3::identity();
        for (axis, degrees) in order.into_iter().zip(degrees) {
            rotate_columns(&mut matrix, axis, degrees.to_radians());
        }
        matrix
    }

    #[test]
    fn angles_of_every_order_give_their_rotation_back() {
        let near = [10.0, -20.0, 400.0];
        for order in ORDERS {
            for a in (-360..360).step_by(45) {
                for b in [
                    -180.0,
                    -90.0,
                    -89.999_999_9,
                    -90.000_001,
                    -30.0,
                    0.0,
                    45.0,
                    90.0,
                ] {
                    for c in [-100.0, 0.0, 77.0] {
                        let rotation = matrix(order, [f64::from(a), b, c]);
                        let found = euler_degrees(&rotation, order, near);
                        let again = matrix(order, found);
                        let off = (again - rotation).abs().max();
                        assert!(
                            off <= 2.0 * LOCKED,
                            "{order:?} {a} {b} {c}: {found:?}, {off}"
                        );
                        let is_locked = b.abs() == 90.0;
                        assert!(is_locked || off <= ROUNDING, "{order:?} {a} {b} {c}: {off}");
                    }
                }
            }
        }
    }

    #[test]
    fn angles_stay_near_the_ones_before() {
        for order in ORDERS {
            // Past the lock, above and below, and four times round: no angle may jump.
            let mut near = [0.0; 3];
            for step in 0..1440 {
                let turn = f64::from(step);
                let expected = [turn * 0.5, 60.3 + turn * 0.5, 30.0 - turn];
                let start = if step == 0 { expected } else { near };
                let found = euler_degrees(&matrix(order, expected), order, start);
                for (found, expected) in found.into_iter().zip(expected) {
                    // Near the lock two angles share what is left of the third.
                    assert!(
                        (found - expected).abs() <= 1e-6,
                        "{order:?} {step}: {found} {expected}"
                    );
                }
                near = found;
            }
        }
    }

    #[test]
    fn the_nearest_angle_is_itself_where_it_is_near() {
        assert_eq!(nearest_angle(179.5, 181.0), 179.5);
        assert_eq!(nearest_angle(-179.0, 179.0), 181.0);
        assert_eq!(nearest_angle(5.0, f64::NAN), 5.0);
        assert_eq!(
            nearest_angles([170.0, 100.0, -170.0], [0.0, 90.0, 0.0]),
            [-10.0, 80.0, 10.0]
        );
    }

    #[test]
    fn slerp_of_half_a_turn_is_a_quarter() {
        let (a, b) = (about(Axis::Z, 0.0), about(Axis::Z, 180.0));
        let half = slerp(a, b, 0.5).to_rotation_matrix().into_inner();
        let quarter = matrix(ORDERS[5], [90.0, 0.0, 0.0]);
        assert!(
            (half - quarter).abs().max() <= ROUNDING
                || (half - quarter.transpose()).abs().max() <= ROUNDING
        );
    }
}
