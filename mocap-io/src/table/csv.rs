use std::fmt::Write as _;
use std::io::Write;

use ndarray::{ArrayView3, Axis as ArrayAxis};

use crate::error::check_shape;
use crate::{FrameRate, WriteError};

/// Writes positions as a table: one row per frame, with the columns `frame` (from 0), `time_s` (in
/// seconds), then `NAME_x`, `NAME_y`, `NAME_z` for each joint or marker.
///
/// `positions` has shape `(frames, names, 3)`: the positions of
/// [`forward_kinematics`](crate::forward_kinematics), or markers. A missing coordinate (NaN) is an empty
/// cell. Numbers are as short as they can be and read back to the same bits. UTF-8, commas, LF at line
/// ends; a name with a comma, a quote or a line break stands in quotes (RFC 4180). O(frames · names).
///
/// # Errors
/// [`WriteError::Shape`] if names and positions do not fit, [`WriteError::NotFinite`] for an infinite
/// coordinate, [`WriteError::Io`] when the sink fails.
pub fn write_csv(
    names: &[&str],
    positions: ArrayView3<'_, f32>,
    rate: FrameRate,
    mut out: impl Write,
) -> Result<(), WriteError> {
    check_shape(names, positions)?;
    let mut row = String::from("frame,time_s");
    for name in names {
        for axis in ["x", "y", "z"] {
            row.push(',');
            push_quoted(&mut row, &format!("{name}_{axis}"));
        }
    }
    for (frame, pose) in positions.axis_iter(ArrayAxis(0)).enumerate() {
        row.push('\n');
        out.write_all(row.as_bytes())?;
        row.clear();
        push_number(&mut row, frame);
        row.push(',');
        push_number(&mut row, frame as f64 / rate.hz());
        for (place, name) in pose.rows().into_iter().zip(names) {
            for &value in place {
                if value.is_infinite() {
                    return Err(WriteError::NotFinite {
                        joint: (*name).to_owned(),
                        frame,
                        value: f64::from(value),
                    });
                }
                row.push(',');
                if !value.is_nan() {
                    push_number(&mut row, value);
                }
            }
        }
    }
    row.push('\n');
    out.write_all(row.as_bytes())?;
    Ok(())
}

fn push_number(row: &mut String, number: impl std::fmt::Display) {
    write!(row, "{number}").expect("a string takes any text");
}

fn push_quoted(row: &mut String, cell: &str) {
    if cell.contains([',', '"', '\n', '\r']) {
        row.push('"');
        row.push_str(&cell.replace('"', "\"\""));
        row.push('"');
    } else {
        row.push_str(cell);
    }
}
