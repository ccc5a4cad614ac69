//! What makes joints and markers visible: octahedra.

use nalgebra::Vector3;

use super::document::Document;
use super::json::{ARRAY_BUFFER, Attributes, ELEMENT_ARRAY_BUFFER, Mesh, Primitive};
use crate::WriteError;

/// The ring's distance from a bone's start and from its axis, as a share of its length: the shape in
/// which modelling programs draw bones.
const BONE_WAIST: f64 = 0.1;
/// Half the width of a marker, and of the one at the place of a root, in metres: about that of the
/// spheres glued on actors.
const MARKER_RADIUS: f64 = 0.01;
/// Shorter bones, in metres, are not drawn: they could not be seen, and have no certain direction.
const SHORTEST_BONE: f64 = 1e-4;

/// Octahedra, each bound to one joint of a skin.
#[derive(Default)]
pub(super) struct Octahedra {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    /// Joint of each vertex, within its skin.
    joints: Vec<u16>,
    indices: Vec<[u32; 1]>,
}

impl Octahedra {
    pub(super) fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    pub(super) fn add_marker(&mut self, at: Vector3<f64>, joint: u16) {
        let up = Vector3::y() * MARKER_RADIUS;
        self.add(at - up, at + up, 0.5, MARKER_RADIUS, joint);
    }

    pub(super) fn add_bone(&mut self, from: Vector3<f64>, to: Vector3<f64>, joint: u16) {
        let length = (to - from).norm();
        if length > SHORTEST_BONE {
            self.add(from, to, BONE_WAIST, BONE_WAIST * length, joint);
        }
    }

    /// An octahedron with tips at `from` and `to` and a ring of four vertices at `share` of the way.
    fn add(&mut self, from: Vector3<f64>, to: Vector3<f64>, share: f64, radius: f64, joint: u16) {
        let along = (to - from).normalize();
        let (aside, across) = perpendicular(along);
        let waist = from.lerp(&to, share);
        // So many vertices are refused for their size when they are stored.
        let first = u32::try_from(self.positions.len()).unwrap_or(u32::MAX);
        let mut push = |position: Vector3<f64>, normal: Vector3<f64>| {
            self.positions.push(position.map(|v| v as f32).into());
            self.normals.push(normal.map(|v| v as f32).into());
            self.joints.push(joint);
        };
        push(from, -along);
        push(to, along);
        for outwards in [aside, across, -aside, -across] {
            push(waist + outwards * radius, outwards);
        }
        for i in 0..4 {
            let (this, next) = (2 + i, 2 + (i + 1) % 4);
            // Counter-clockwise from outside: aside × across points along.
            self.indices
                .extend([0, next, this, 1, this, next].map(|v| [first.saturating_add(v)]));
        }
    }

    /// Stores the octahedra, with their joints if they belong to a skin, and returns their mesh.
    pub(super) fn store(
        &self,
        document: &mut Document,
        skinned: bool,
    ) -> Result<usize, WriteError> {
        let position = document.add(&self.positions, Some(ARRAY_BUFFER))?;
        let bound = |pick: fn(f32, f32) -> f32| {
            let corner = self.positions.iter().copied();
            corner.reduce(|a, b| std::array::from_fn(|i| pick(a[i], b[i])))
        };
        let accessor = &mut document.accessors[position];
        accessor.min = bound(f32::min).unwrap_or_default().to_vec();
        accessor.max = bound(f32::max).unwrap_or_default().to_vec();
        let normal = document.add(&self.normals, Some(ARRAY_BUFFER))?;
        let (mut joints, mut weights) = (None, None);
        if skinned {
            let of_vertex: Vec<[u16; 4]> = self.joints.iter().map(|&j| [j, 0, 0, 0]).collect();
            joints = Some(document.add(&of_vertex, Some(ARRAY_BUFFER))?);
            let whole = vec![[u8::MAX, 0, 0, 0]; self.joints.len()];
            let accessor = document.add(&whole, Some(ARRAY_BUFFER))?;
            document.accessors[accessor].normalized = true;
            weights = Some(accessor);
        }
        let indices = document.add(&self.indices, Some(ELEMENT_ARRAY_BUFFER))?;
        document.meshes.push(Mesh {
            primitives: [Primitive {
                attributes: Attributes {
                    position,
                    normal,
                    joints,
                    weights,
                },
                indices,
            }],
        });
        Ok(document.meshes.len() - 1)
    }
}

/// Two directions with which `along` makes a right-handed frame (they come first).
fn perpendicular(along: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    // The coordinate axis along which it points least is far from parallel.
    let mut other = Vector3::zeros();
    other[along.iamin()] = 1.0;
    let aside = along.cross(&other).normalize();
    (aside, along.cross(&aside))
}
