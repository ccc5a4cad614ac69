//! A stick figure with all 24 body points, and the map that names them.

use relfeat::ndarray::Array3;
use relfeat::{BodyMap, BodyPoint, Rig};

/// In metres, upright, facing +Z with its left at +X, arms hanging, in the order of [`BodyPoint::ALL`].
pub(crate) const STANDING: [[f32; 3]; 24] = [
    [0.0, 1.0, 0.0],
    [0.1, 0.95, 0.0],
    [-0.1, 0.95, 0.0],
    [0.1, 0.5, 0.02],
    [-0.1, 0.5, 0.02],
    [0.1, 0.08, 0.0],
    [-0.1, 0.08, 0.0],
    [0.1, 0.0, 0.2],
    [-0.1, 0.0, 0.2],
    [0.0, 1.1, 0.0],
    [0.0, 1.25, 0.0],
    [0.0, 1.4, 0.0],
    [0.0, 1.5, 0.0],
    [0.0, 1.7, 0.0],
    [0.0, 1.4, 0.0],
    [0.0, 1.4, 0.0],
    [0.2, 1.4, 0.0],
    [-0.2, 1.4, 0.0],
    [0.2, 1.1, 0.0],
    [-0.2, 1.1, 0.0],
    [0.2, 0.85, 0.02],
    [-0.2, 0.85, 0.02],
    [0.2, 0.7, 0.03],
    [-0.2, 0.7, 0.03],
];

pub(crate) fn idx(name: &str) -> usize {
    names().iter().position(|n| *n == name).unwrap()
}

pub(crate) fn names() -> Vec<&'static str> {
    BodyPoint::ALL.iter().map(|p| p.name()).collect()
}

/// A rig in which each joint is the body point of its name.
pub(crate) fn rig() -> Rig {
    let points: String = names()
        .iter()
        .map(|n| format!("{n} = [\"{n}\"]\n"))
        .collect();
    Rig::from_toml(&format!("name = \"plain\"\n[points]\n{points}")).unwrap()
}

pub(crate) fn map() -> BodyMap {
    BodyMap::with_rig(&names(), &rig())
}

/// A motion of `n_frames`; `place` moves a point from where it stands.
pub(crate) fn motion(
    n_frames: usize,
    mut place: impl FnMut(usize, &str, [f32; 3]) -> [f32; 3],
) -> Array3<f32> {
    let names = names();
    let mut positions = Array3::zeros((n_frames, names.len(), 3));
    for frame in 0..n_frames {
        for (point, name) in names.iter().enumerate() {
            let at = place(frame, name, STANDING[point]);
            for axis in 0..3 {
                positions[[frame, point, axis]] = at[axis];
            }
        }
    }
    positions
}
