//! Tables and arrays of positions: CSV, NPY and NPZ.

mod csv;
mod npy;
mod npz;
mod zip;

pub use csv::write_csv;
pub use npy::write_npy;
pub use npz::{write_npz, write_npz_points};
