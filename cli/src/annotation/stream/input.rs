//! Frames or words from a stream of lines.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use mocap_io::FrameRate;
use ndarray::Array3;
use relfeat::BodyMap;

use crate::failure::Failure;
use crate::recording::{Files, ReadOptions, Recording, map_of, parse};
use crate::source::Format;

/// What errors call the stream.
const STREAM: &str = "standard input";

/// Bytes of lines that are looked at together, if they have come together.
const BATCH: usize = 1 << 18;

/// The lines of a stream.
#[derive(Debug)]
pub(super) struct Lines<R> {
    reader: BufReader<R>,
    n_read: usize,
}

impl<R: Read> Lines<R> {
    pub(super) fn new(stream: R) -> Self {
        let reader = BufReader::with_capacity(BATCH, stream);
        Self { reader, n_read: 0 }
    }

    /// Waits for a line; nothing at the end.
    fn line(&mut self) -> Result<Option<String>, Failure> {
        let mut line = String::new();
        self.n_read += 1;
        match self.reader.read_line(&mut line) {
            Ok(0) => Ok(None),
            Ok(_) => Ok(Some(line)),
            Err(e) => Err(self.error(e)),
        }
    }

    /// Waits for a line and takes those that have come with it; empty lines are left out. Nothing at
    /// the end.
    fn batch(&mut self) -> Result<Option<Vec<String>>, Failure> {
        let mut lines = Vec::new();
        while let Some(line) = self.line()? {
            if !line.trim().is_empty() {
                lines.push(line);
            }
            let has_more = self.reader.buffer().contains(&b'\n');
            if !lines.is_empty() && !has_more {
                return Ok(Some(lines));
            }
        }
        Ok(Some(lines).filter(|lines| !lines.is_empty()))
    }

    /// What is wrong in the last line read.
    fn error(&self, what: impl std::fmt::Display) -> Failure {
        Failure::input(Path::new(STREAM), format!("line {}: {what}", self.n_read))
    }
}

/// A stream whose beginning has been read.
#[derive(Debug)]
pub(super) enum Input<R> {
    /// A word a line.
    Words(WordLines<R>),
    /// A frame a line.
    Frames(Box<FrameLines<R>>),
}

impl<R: Read> Input<R> {
    /// Reads what comes before the frames.
    pub(super) fn open(mut lines: Lines<R>, options: &ReadOptions) -> Result<Self, Failure> {
        let first = loop {
            match lines.line()? {
                None => return Err(lines.error("expected frames or words, found the end")),
                Some(line) if line.trim().is_empty() => {}
                Some(line) => break line,
            }
        };
        let first = first.trim_start_matches('\u{feff}');
        if parse_word(first).is_some() {
            let ahead = vec![first.to_owned()];
            return Ok(Input::Words(WordLines { lines, ahead }));
        }
        let frames = match first.trim().eq_ignore_ascii_case("HIERARCHY") {
            true => FrameLines::bvh(lines, first, options)?,
            false => FrameLines::csv(lines, first, options)?,
        };
        Ok(Input::Frames(Box::new(frames)))
    }
}

/// Words as `features --json` writes them.
#[derive(Debug)]
pub(super) struct WordLines<R> {
    lines: Lines<R>,
    /// Lines that were read already.
    ahead: Vec<String>,
}

impl<R: Read> WordLines<R> {
    /// The next words; nothing at the end.
    pub(super) fn next(&mut self) -> Result<Option<Vec<u64>>, Failure> {
        let lines = match std::mem::take(&mut self.ahead) {
            ahead if !ahead.is_empty() => ahead,
            _ => match self.lines.batch()? {
                Some(lines) => lines,
                None => return Ok(None),
            },
        };
        let words = lines.iter().map(|line| {
            let expected = || format!("expected a word such as 0x2f, found {:?}", line.trim());
            parse_word(line).ok_or_else(|| self.lines.error(expected()))
        });
        words.collect::<Result<_, _>>().map(Some)
    }
}

fn parse_word(line: &str) -> Option<u64> {
    let digits = line.trim().strip_prefix("0x")?;
    u64::from_str_radix(digits, 16).ok()
}

/// Frames of a body.
#[derive(Debug)]
pub(super) struct FrameLines<R> {
    lines: Lines<R>,
    form: Form,
    /// Frames that were read already.
    ahead: Option<Array3<f32>>,
    /// Which joint is which body point.
    pub(super) map: BodyMap,
    /// Frames per second.
    pub(super) rate: f64,
}

/// How a line becomes a frame.
#[derive(Debug)]
enum Form {
    /// Behind this header, with the unit and the axis that the first frames had.
    Bvh(String, Box<ReadOptions>),
    /// Columns of x, y, z for each joint.
    Csv(Vec<[usize; 3]>),
}

impl<R: Read> FrameLines<R> {
    fn bvh(mut lines: Lines<R>, first: &str, options: &ReadOptions) -> Result<Self, Failure> {
        let mut header = first.to_owned();
        loop {
            let line = lines.line()?;
            let line =
                line.ok_or_else(|| lines.error("expected \"Frame Time:\", found the end"))?;
            // How many frames there will be is not known.
            if !line.trim_start().starts_with("Frames:") {
                header.push_str(&line);
            }
            if line.trim_start().starts_with("Frame Time:") {
                break;
            }
        }
        let batch = lines.batch()?.unwrap_or_default();
        let recording = read_bvh(&lines, &header, &batch, options)?;
        let settled = ReadOptions {
            rate: Some(recording.rate().0),
            unit: Some(recording.unit().0),
            up: Some(recording.up().0),
            ..options.clone()
        };
        Ok(Self {
            map: map_of(Path::new(STREAM), &recording.names(), options)?,
            rate: recording.rate().0.hz(),
            ahead: Some(recording.positions()),
            form: Form::Bvh(header, Box::new(settled)),
            lines,
        })
    }

    fn csv(mut lines: Lines<R>, header: &str, options: &ReadOptions) -> Result<Self, Failure> {
        let heads = record(header).map_err(|e| lines.error(e))?;
        let column = |name: &str| heads.iter().position(|head| head == name);
        let mut names = Vec::new();
        let mut columns = Vec::new();
        for (x, head) in heads.iter().enumerate() {
            let Some(name) = head.strip_suffix("_x") else {
                continue;
            };
            let others = ["y", "z"].map(|axis| column(&format!("{name}_{axis}")));
            if let [Some(y), Some(z)] = others {
                names.push(name);
                columns.push([x, y, z]);
            }
        }
        if names.is_empty() {
            let found = header.trim().chars().take(40).collect::<String>();
            return Err(lines.error(format!(
                "expected HIERARCHY, a header with columns such as root_x, root_y, root_z, or a word such as 0x2f; \
                 found {found:?}"
            )));
        }
        let mut batch = Vec::new();
        // Times tell the rate once there are two.
        while batch.len() < 2 {
            match lines.batch()? {
                Some(more) => batch.extend(more),
                None => break,
            }
        }
        let rate = match (options.rate, column("time_s")) {
            (Some(rate), _) => rate,
            (None, Some(time)) => rate_of(&lines, &batch, time)?,
            (None, None) => {
                return Err(
                    lines.error("expected a column time_s, or --source-rate, found neither")
                );
            }
        };
        let map = map_of(Path::new(STREAM), &names, options)?;
        Ok(Self {
            ahead: Some(read_csv(&lines, &columns, &batch)?),
            form: Form::Csv(columns),
            map,
            rate: rate.hz(),
            lines,
        })
    }

    /// The next frames, shape `(frames, joints, 3)`, metres, Y up; nothing at the end.
    pub(super) fn next(&mut self) -> Result<Option<Array3<f32>>, Failure> {
        if let Some(ahead) = self.ahead.take() {
            return Ok(Some(ahead));
        }
        let Some(batch) = self.lines.batch()? else {
            return Ok(None);
        };
        let frames = match &self.form {
            Form::Bvh(header, settled) => {
                read_bvh(&self.lines, header, &batch, settled)?.positions()
            }
            Form::Csv(columns) => read_csv(&self.lines, columns, &batch)?,
        };
        Ok(Some(frames))
    }
}

fn read_bvh<R: Read>(
    lines: &Lines<R>,
    header: &str,
    batch: &[String],
    options: &ReadOptions,
) -> Result<Recording, Failure> {
    let at = header.rfind("Frame Time:").unwrap_or(header.len());
    let (before, time) = header.split_at(at);
    let text = format!("{before}Frames: {}\n{time}{}", batch.len(), batch.concat());
    let files = Files::of_bytes(Format::Bvh, text.into_bytes());
    let loaded = parse(Path::new(STREAM), files, options);
    Ok(loaded.map_err(|e| lines.error(e))?.recording)
}

fn read_csv<R: Read>(
    lines: &Lines<R>,
    columns: &[[usize; 3]],
    batch: &[String],
) -> Result<Array3<f32>, Failure> {
    let mut frames = Array3::from_elem((batch.len(), columns.len(), 3), f32::NAN);
    for (line, mut frame) in batch.iter().zip(frames.outer_iter_mut()) {
        let values = record(line).map_err(|e| lines.error(e))?;
        for (columns, mut place) in columns.iter().zip(frame.outer_iter_mut()) {
            for (&column, to) in columns.iter().zip(&mut place) {
                let found = values.get(column).map_or("nothing", |v| v.trim());
                *to = match found {
                    // What is missing is left empty.
                    "" => f32::NAN,
                    number => number.parse().map_err(|_| {
                        lines.error(format!(
                            "expected a number in column {}, found {number:?}",
                            column + 1
                        ))
                    })?,
                };
            }
        }
    }
    Ok(frames)
}

/// Rates are told apart to this many parts of one: times are printed with about six digits.
const RATE_STEPS: f64 = 1e4;

fn rate_of<R: Read>(
    lines: &Lines<R>,
    batch: &[String],
    column: usize,
) -> Result<FrameRate, Failure> {
    let time = |line: &String| record(line).ok()?.get(column)?.trim().parse::<f64>().ok();
    let times: Vec<f64> = batch.iter().filter_map(time).collect();
    let rate = match (times.first(), times.last()) {
        (Some(first), Some(last)) if times.len() > 1 => (times.len() - 1) as f64 / (last - first),
        // A single frame stands still at any rate.
        _ => 1.0,
    };
    FrameRate::from_hz((rate * RATE_STEPS).round() / RATE_STEPS)
        .ok_or_else(|| lines.error("expected ascending times in column time_s, found others"))
}

/// The fields of a line.
fn record(line: &str) -> Result<Vec<String>, csv::Error> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(line.as_bytes());
    match reader.records().next() {
        Some(record) => Ok(record?.iter().map(str::to_owned).collect()),
        None => Ok(Vec::new()),
    }
}
