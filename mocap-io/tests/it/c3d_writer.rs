//! Writes C3D files in every byte order, as the user guide of c3d.org says and, where a test asks for it,
//! otherwise.

use mocap_io::{ByteOrder, Storage};

/// Blocks are counted from 1.
const BLOCK: usize = 512;
/// Where words of the header are.
const EVENT_KEY: usize = 298;

/// A file to be written. Points are `[x, y, z, word]`, the first three in file units.
#[derive(Clone, Debug)]
pub(crate) struct Writer {
    pub(crate) order: ByteOrder,
    pub(crate) storage: Storage,
    /// Magnitude of POINT:SCALE.
    pub(crate) scale: f32,
    pub(crate) rate: f32,
    pub(crate) first_frame: u16,
    /// Per frame.
    pub(crate) points: Vec<Vec<[f32; 4]>>,
    /// Per frame, stored as they are; all samples of one time, then those of the next.
    pub(crate) analog: Vec<Vec<f32>>,
    pub(crate) samples_per_frame: u16,
    /// Group, name, value.
    pub(crate) parameters: Vec<(&'static str, String, Value)>,
    /// Seconds and label.
    pub(crate) events: Vec<(f32, &'static str)>,
    /// Block where the parameters start.
    pub(crate) parameter_block: u8,
}

#[derive(Clone, Debug)]
pub(crate) enum Value {
    Texts(Vec<String>),
    Integers(Vec<u16>),
    Floats(Vec<f32>),
    /// Dimensions, then values.
    Times(Vec<[f32; 2]>),
}

pub(crate) fn texts(all: &[&str]) -> Value {
    Value::Texts(all.iter().map(|&t| t.to_owned()).collect())
}

impl Writer {
    pub(crate) fn new(order: ByteOrder, storage: Storage, points: Vec<Vec<[f32; 4]>>) -> Writer {
        let mut writer = Writer {
            order,
            storage,
            scale: 0.1,
            rate: 100.0,
            first_frame: 1,
            points,
            analog: Vec::new(),
            samples_per_frame: 1,
            parameters: Vec::new(),
            events: Vec::new(),
            parameter_block: 2,
        };
        let n_points = writer.n_points();
        let labels: Vec<String> = (0..n_points).map(|i| format!("M{i}")).collect();
        let n_frames = writer.points.len().min(65_535) as u16;
        let scale = writer.signed_scale();
        for (name, value) in [
            ("USED", Value::Integers(vec![n_points as u16])),
            ("FRAMES", Value::Integers(vec![n_frames])),
            ("SCALE", Value::Floats(vec![scale])),
            ("RATE", Value::Floats(vec![100.0])),
            ("UNITS", texts(&["mm"])),
        ] {
            writer.set("POINT", name, value);
        }
        for (i, labels) in labels.chunks(255).enumerate() {
            let name = if i == 0 {
                "LABELS".to_owned()
            } else {
                format!("LABELS{}", i + 1)
            };
            writer.set("POINT", &name, Value::Texts(labels.to_vec()));
        }
        writer
    }

    /// Replaces or adds a parameter.
    pub(crate) fn set(&mut self, group: &'static str, name: &str, value: Value) {
        self.remove(group, name);
        self.parameters.push((group, name.to_owned(), value));
    }

    pub(crate) fn remove(&mut self, group: &str, name: &str) {
        self.parameters.retain(|(g, n, _)| *g != group || n != name);
    }

    pub(crate) fn n_points(&self) -> usize {
        self.points.first().map_or(0, Vec::len)
    }

    fn signed_scale(&self) -> f32 {
        match self.storage {
            Storage::Integer => self.scale,
            Storage::Float => -self.scale,
        }
    }

    pub(crate) fn integer(&self, value: u16) -> [u8; 2] {
        match self.order {
            ByteOrder::Intel | ByteOrder::Dec => value.to_le_bytes(),
            ByteOrder::Mips => value.to_be_bytes(),
        }
    }

    pub(crate) fn float(&self, value: f32) -> [u8; 4] {
        match self.order {
            ByteOrder::Intel => value.to_le_bytes(),
            ByteOrder::Mips => value.to_be_bytes(),
            // The exponent of a VAX is two larger, and its words change places.
            ByteOrder::Dec if value == 0.0 => [0; 4],
            ByteOrder::Dec => {
                let [a, b, c, d] = (value * 4.0).to_le_bytes();
                [c, d, a, b]
            }
        }
    }

    fn number(&self, value: f32, scale: f32) -> Vec<u8> {
        match self.storage {
            Storage::Integer => self.integer((value / scale).round() as i16 as u16).to_vec(),
            Storage::Float => self.float(value).to_vec(),
        }
    }

    pub(crate) fn write(&self) -> Vec<u8> {
        let start = usize::from(self.parameter_block - 1) * BLOCK;
        let length = self.parameter_section(0).len();
        let n_blocks = length.div_ceil(BLOCK);
        let data_start = usize::from(self.parameter_block) + n_blocks;
        let mut bytes = self.header(data_start as u16);
        bytes.resize(start, 0);
        bytes.extend(self.parameter_section(data_start as u16));
        bytes.resize(start + n_blocks * BLOCK, 0);
        bytes.extend(self.data());
        bytes.resize(bytes.len().next_multiple_of(BLOCK), 0);
        bytes
    }

    fn header(&self, data_start: u16) -> Vec<u8> {
        let mut block = vec![0; BLOCK];
        block[..2].copy_from_slice(&[self.parameter_block, 80]);
        let n_analog = self.analog.first().map_or(0, Vec::len);
        let last = usize::from(self.first_frame) + self.points.len() - 1;
        let words = [
            (2, self.n_points() as u16),
            (4, n_analog as u16),
            (6, self.first_frame),
            (8, last.min(65_535) as u16),
            (10, 10),
            (16, data_start),
            (18, self.samples_per_frame),
            (EVENT_KEY, 12_345),
            (EVENT_KEY + 2, self.events.len() as u16),
        ];
        for (at, word) in words {
            block[at..at + 2].copy_from_slice(&self.integer(word));
        }
        block[12..16].copy_from_slice(&self.float(self.signed_scale()));
        block[20..24].copy_from_slice(&self.float(self.rate));
        for (i, (seconds, label)) in self.events.iter().enumerate() {
            block[304 + 4 * i..][..4].copy_from_slice(&self.float(*seconds));
            block[396 + 4 * i..][..4].copy_from_slice(format!("{label:4}").as_bytes());
        }
        block
    }

    fn parameter_section(&self, data_start: u16) -> Vec<u8> {
        let processor = match self.order {
            ByteOrder::Intel => 84,
            ByteOrder::Dec => 85,
            ByteOrder::Mips => 86,
        };
        let mut parameters = self.parameters.clone();
        if parameters.iter().all(|(_, name, _)| name != "DATA_START") {
            let value = Value::Integers(vec![data_start]);
            parameters.push(("POINT", "DATA_START".to_owned(), value));
        }
        let mut groups: Vec<&str> = Vec::new();
        let mut records = Vec::new();
        for (group, name, value) in &parameters {
            let id = groups.iter().position(|g| g == group).unwrap_or_else(|| {
                groups.push(group);
                records.extend(self.record(group, -(groups.len() as i8), &[0]));
                groups.len() - 1
            });
            records.extend(self.record(name, id as i8 + 1, &self.value(value)));
        }
        let n_blocks = (records.len() + 6).div_ceil(BLOCK);
        let mut section = vec![1, 80, n_blocks as u8, processor];
        section.extend(records);
        section.extend([0, 0]);
        section
    }

    fn record(&self, name: &str, id: i8, body: &[u8]) -> Vec<u8> {
        let mut record = vec![name.len() as u8, id as u8];
        record.extend(name.as_bytes());
        record.extend(self.integer(body.len() as u16 + 2));
        record.extend(body);
        record
    }

    /// Type, dimensions, values, and an empty description.
    fn value(&self, value: &Value) -> Vec<u8> {
        let sizes = |n: usize| if n == 1 { vec![0] } else { vec![1, n as u8] };
        let mut bytes = Vec::new();
        match value {
            Value::Texts(all) => {
                let width = all.iter().map(String::len).max().unwrap_or(0);
                bytes.extend([0xff, 2, width as u8, all.len() as u8]);
                for text in all {
                    bytes.extend(format!("{text:width$}").as_bytes());
                }
            }
            Value::Integers(all) => {
                bytes.push(2);
                bytes.extend(sizes(all.len()));
                bytes.extend(all.iter().flat_map(|&v| self.integer(v)));
            }
            Value::Floats(all) => {
                bytes.push(4);
                bytes.extend(sizes(all.len()));
                bytes.extend(all.iter().flat_map(|&v| self.float(v)));
            }
            Value::Times(all) => {
                bytes.extend([4, 2, 2, all.len() as u8]);
                bytes.extend(all.iter().flatten().flat_map(|&v| self.float(v)));
            }
        }
        bytes.push(0);
        bytes
    }

    fn data(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (frame_idx, frame) in self.points.iter().enumerate() {
            for [x, y, z, word] in frame {
                for coordinate in [x, y, z] {
                    bytes.extend(self.number(*coordinate, self.scale));
                }
                bytes.extend(self.number(*word, 1.0));
            }
            for &sample in self.analog.get(frame_idx).into_iter().flatten() {
                bytes.extend(match self.storage {
                    // Unsigned samples do not fit into i16.
                    Storage::Integer => self.integer(sample as i32 as u16).to_vec(),
                    Storage::Float => self.float(sample).to_vec(),
                });
            }
        }
        bytes
    }
}
