//! Acclaim skeletons (ASF) and motions (AMC).

mod amc;
mod asf;
mod explain;
mod names;
mod write;

pub use amc::{Amc, parse_amc};
pub use asf::{AngleUnit, Asf, parse_asf};
pub(crate) use explain::EXPLANATIONS;
pub use write::{write_amc, write_asf};
