//! A glTF document as it grows, and its binary form.

use std::io::Write;

use super::json::{
    Accessor, Animation, Asset, Buffer, BufferView, Channel, FLOAT, Interpolation, Mesh, Node,
    Path, Root, Sampler, Scene, Skin, Target, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT,
};
use crate::{FrameRate, WriteError};

/// `glTF`, read as a little-endian number.
const MAGIC: u32 = 0x4654_6c67;
const VERSION: u32 = 2;
const JSON_CHUNK: u32 = 0x4e4f_534a;
const BINARY_CHUNK: u32 = 0x004e_4942;
/// Header, and two chunks' lengths and types.
const FRAMING: usize = 12 + 2 * 8;

const BEYOND_SINGLE: WriteError = WriteError::Limit {
    format: "GLB",
    what: "a number beyond single precision",
};

/// A number as glTF stores it.
pub(super) trait Component: Copy {
    /// glTF's code of the type.
    const CODE: u32;
    fn push_to(self, bytes: &mut Vec<u8>);
    fn is_a_number(self) -> bool {
        true
    }
}

impl Component for f32 {
    const CODE: u32 = FLOAT;
    fn push_to(self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&self.to_le_bytes());
    }
    fn is_a_number(self) -> bool {
        self.is_finite()
    }
}

impl Component for u32 {
    const CODE: u32 = UNSIGNED_INT;
    fn push_to(self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&self.to_le_bytes());
    }
}

impl Component for u16 {
    const CODE: u32 = UNSIGNED_SHORT;
    fn push_to(self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&self.to_le_bytes());
    }
}

impl Component for u8 {
    const CODE: u32 = UNSIGNED_BYTE;
    fn push_to(self, bytes: &mut Vec<u8>) {
        bytes.push(self);
    }
}

/// How glTF calls an element of `n` components.
const fn kind(n: usize) -> &'static str {
    match n {
        3 => "VEC3",
        4 => "VEC4",
        16 => "MAT4",
        _ => "SCALAR",
    }
}

/// Objects name each other by index.
pub(super) struct Document {
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) skins: Vec<Skin>,
    channels: Vec<Channel>,
    samplers: Vec<Sampler>,
    pub(super) accessors: Vec<Accessor>,
    buffer_views: Vec<BufferView>,
    binary: Vec<u8>,
}

impl Document {
    pub(super) fn new() -> Self {
        Document {
            nodes: Vec::new(),
            meshes: Vec::new(),
            skins: Vec::new(),
            channels: Vec::new(),
            samplers: Vec::new(),
            accessors: Vec::new(),
            buffer_views: Vec::new(),
            binary: Vec::new(),
        }
    }

    /// Stores elements and returns the index of their accessor.
    pub(super) fn add<C: Component, const N: usize>(
        &mut self,
        elements: &[[C; N]],
        target: Option<u32>,
    ) -> Result<usize, WriteError> {
        // All elements are whole multiples of four bytes long, so everything stays aligned.
        let byte_offset = self.binary.len();
        self.binary.reserve(size_of_val(elements));
        for &component in elements.as_flattened() {
            if !component.is_a_number() {
                return Err(BEYOND_SINGLE);
            }
            component.push_to(&mut self.binary);
        }
        check_size(self.binary.len())?;
        self.buffer_views.push(BufferView {
            buffer: 0,
            byte_offset,
            byte_length: self.binary.len() - byte_offset,
            target,
        });
        self.accessors.push(Accessor {
            buffer_view: self.buffer_views.len() - 1,
            component_type: C::CODE,
            normalized: false,
            count: elements.len(),
            kind: kind(N),
            min: Vec::new(),
            max: Vec::new(),
        });
        Ok(self.accessors.len() - 1)
    }

    /// The times of the given frames: an animation's input, with its bounds.
    pub(super) fn add_times(
        &mut self,
        frames: impl Iterator<Item = usize>,
        rate: FrameRate,
    ) -> Result<usize, WriteError> {
        let times: Vec<[f32; 1]> = frames.map(|f| [(f as f64 / rate.hz()) as f32]).collect();
        if !times.is_sorted_by(|a, b| a < b) {
            return Err(WriteError::Limit {
                format: "GLB",
                what: "times that single precision cannot tell apart",
            });
        }
        let accessor = self.add(&times, None)?;
        let bound = |time: Option<&[f32; 1]>| time.copied().map(Vec::from).unwrap_or_default();
        self.accessors[accessor].min = bound(times.first());
        self.accessors[accessor].max = bound(times.last());
        Ok(accessor)
    }

    /// Animates a property of a node: `output` holds a value for each time in the accessor `input`.
    pub(super) fn animate<const N: usize>(
        &mut self,
        node: usize,
        path: Path,
        input: usize,
        output: &[[f32; N]],
    ) -> Result<(), WriteError> {
        let output = self.add(output, None)?;
        self.samplers.push(Sampler {
            input,
            interpolation: match path {
                Path::Scale => Interpolation::Step,
                Path::Translation | Path::Rotation => Interpolation::Linear,
            },
            output,
        });
        self.channels.push(Channel {
            sampler: self.samplers.len() - 1,
            target: Target { node, path },
        });
        Ok(())
    }

    /// Writes the document with a scene of the given nodes (glTF 2.0, section 4.4).
    pub(super) fn write(self, roots: Vec<usize>, mut out: impl Write) -> Result<(), WriteError> {
        let animation = Animation {
            channels: self.channels,
            samplers: self.samplers,
        };
        let is_moving = !animation.channels.is_empty();
        let root = Root {
            asset: Asset {
                version: "2.0",
                generator: "motif",
            },
            scene: 0,
            scenes: [Scene { nodes: roots }],
            nodes: self.nodes,
            meshes: self.meshes,
            skins: self.skins,
            animations: Vec::from_iter(is_moving.then_some(animation)),
            accessors: self.accessors,
            buffer_views: self.buffer_views,
            buffers: [Buffer {
                byte_length: self.binary.len(),
            }],
        };
        let mut json = serde_json::to_vec(&root).map_err(std::io::Error::from)?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let json_length = check_size(json.len())?;
        let binary_length = check_size(self.binary.len())?;
        let length = check_size(FRAMING + json.len() + self.binary.len())?;
        for number in [MAGIC, VERSION, length, json_length, JSON_CHUNK] {
            out.write_all(&number.to_le_bytes())?;
        }
        out.write_all(&json)?;
        for number in [binary_length, BINARY_CHUNK] {
            out.write_all(&number.to_le_bytes())?;
        }
        out.write_all(&self.binary)?;
        Ok(())
    }
}

/// `number` in single precision, which is all that glTF has.
pub(super) fn single(number: f64) -> Result<f32, WriteError> {
    let single = number as f32;
    if single.is_finite() {
        Ok(single)
    } else {
        Err(BEYOND_SINGLE)
    }
}

fn check_size(n_bytes: usize) -> Result<u32, WriteError> {
    u32::try_from(n_bytes).map_err(|_| WriteError::Limit {
        format: "GLB",
        what: "4 GiB or more",
    })
}
