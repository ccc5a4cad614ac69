//! GLB files as another crate reads them, with node transforms multiplied out one by one.

use gltf::Gltf;
use gltf::animation::util::ReadOutputs;
use mocap_io::ndarray::Array3;

/// Translation, rotation (x, y, z, w) and scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Transform {
    pub(crate) translation: [f64; 3],
    pub(crate) rotation: [f64; 4],
    pub(crate) scale: [f64; 3],
}

/// One animated property of one node: times and values.
pub(crate) enum Track {
    Translation(Vec<[f32; 3]>),
    Rotation(Vec<[f32; 4]>),
    Scale(Vec<[f32; 3]>),
}

pub(crate) struct Scene {
    pub(crate) gltf: Gltf,
    pub(crate) names: Vec<String>,
    pub(crate) parents: Vec<Option<usize>>,
    pub(crate) rest: Vec<Transform>,
    /// Node, times, values.
    pub(crate) tracks: Vec<(usize, Vec<f32>, Track)>,
}

impl Scene {
    pub(crate) fn read(bytes: &[u8]) -> Scene {
        let gltf = Gltf::from_slice(bytes).unwrap();
        let binary = gltf.blob.as_deref();
        let mut parents = vec![None; gltf.nodes().len()];
        let (mut names, mut rest) = (Vec::new(), Vec::new());
        for node in gltf.nodes() {
            for child in node.children() {
                assert_eq!(parents[child.index()].replace(node.index()), None);
            }
            names.push(node.name().unwrap().to_owned());
            let (translation, rotation, scale) = node.transform().decomposed();
            rest.push(Transform {
                translation: translation.map(f64::from),
                rotation: rotation.map(f64::from),
                scale: scale.map(f64::from),
            });
        }
        let mut tracks = Vec::new();
        for channel in gltf
            .animations()
            .flat_map(|a| a.channels().collect::<Vec<_>>())
        {
            let reader = channel.reader(|_| binary);
            let times: Vec<f32> = reader.read_inputs().unwrap().collect();
            let values = match reader.read_outputs().unwrap() {
                ReadOutputs::Translations(values) => Track::Translation(values.collect()),
                ReadOutputs::Rotations(values) => Track::Rotation(values.into_f32().collect()),
                ReadOutputs::Scales(values) => Track::Scale(values.collect()),
                ReadOutputs::MorphTargetWeights(_) => panic!("there is nothing to morph"),
            };
            assert!(times.windows(2).all(|t| t[0] < t[1]), "times go backwards");
            tracks.push((channel.target().node().index(), times, values));
        }
        Scene {
            names,
            parents,
            rest,
            tracks,
            gltf,
        }
    }

    /// The nodes' own transforms at key `key` of every track.
    pub(crate) fn locals_at_key(&self, key: usize) -> Vec<Transform> {
        let mut locals = self.rest.clone();
        for (node, _, track) in &self.tracks {
            match track {
                Track::Translation(values) => {
                    locals[*node].translation = values[key].map(f64::from)
                }
                Track::Rotation(values) => locals[*node].rotation = values[key].map(f64::from),
                Track::Scale(values) => locals[*node].scale = values[key].map(f64::from),
            }
        }
        locals
    }

    /// From each node to the world, row by row.
    pub(crate) fn worlds(&self, locals: &[Transform]) -> Vec<[[f64; 4]; 4]> {
        let mut worlds = Vec::new();
        for (local, parent) in locals.iter().zip(&self.parents) {
            let own = matrix(local);
            worlds.push(parent.map_or(own, |p| product(&worlds[p], &own)));
        }
        worlds
    }

    /// Where the given nodes are at each of the first `n_keys` keys.
    pub(crate) fn positions(&self, n_keys: usize, nodes: &[usize]) -> Array3<f32> {
        let mut positions = Array3::zeros((n_keys, nodes.len(), 3));
        for key in 0..n_keys {
            let worlds = self.worlds(&self.locals_at_key(key));
            for (i, &node) in nodes.iter().enumerate() {
                for axis in 0..3 {
                    positions[[key, i, axis]] = worlds[node][axis][3] as f32;
                }
            }
        }
        positions
    }

    /// The first node of this name.
    pub(crate) fn find(&self, name: &str) -> usize {
        self.names.iter().position(|n| n == name).unwrap()
    }
}

pub(crate) fn product(a: &[[f64; 4]; 4], b: &[[f64; 4]; 4]) -> [[f64; 4]; 4] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

/// T · R · S (glTF 2.0, section 3.5.3).
fn matrix(local: &Transform) -> [[f64; 4]; 4] {
    let [x, y, z, w] = local.rotation;
    let turn = [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - z * w),
            2.0 * (x * z + y * w),
        ],
        [
            2.0 * (x * y + z * w),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - x * w),
        ],
        [
            2.0 * (x * z - y * w),
            2.0 * (y * z + x * w),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ];
    let mut matrix = [[0.0; 4]; 4];
    for i in 0..3 {
        for j in 0..3 {
            matrix[i][j] = turn[i][j] * local.scale[j];
        }
        matrix[i][3] = local.translation[i];
    }
    matrix[3][3] = 1.0;
    matrix
}
