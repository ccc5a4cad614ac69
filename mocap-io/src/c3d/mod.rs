//! C3D files of the C3D file format user guide (Motion Lab Systems, c3d.org).

mod analog;
mod error;
mod events;
mod explain;
mod header;
mod labels;
mod layout;
mod order;
mod parameters;
mod parse;
mod points;

pub use analog::Analog;
pub use error::{C3dErrorKind, C3dWarningKind};
pub use events::{Event, EventSource};
pub(crate) use explain::EXPLANATIONS;
pub use order::{ByteOrder, Storage};
pub use parameters::{Parameter, ParameterGroup, ParameterValue, Parameters};
pub use parse::{C3d, OtherPoints, parse_c3d};
