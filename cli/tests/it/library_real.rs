//! Libraries of real files.

use std::fs;

use cli::library::verify;
use tempfile::TempDir;

use crate::command::{motif, text};
use crate::library::{counts, shard_files};
use crate::real::data;

/// Bytes per segment that the format promises at the rate of the recordings.
const BYTES_PER_SEGMENT: f64 = 8.0;

#[test]
fn real_libraries_are_small_and_read_once() {
    let Some(data) = data() else { return };
    let dir = TempDir::new().unwrap();
    for rate in ["30", "120"] {
        let library = dir.path().join(rate);
        let (hdm05, cmu) = (data.join("hdm05"), data.join("cmu"));
        let args = [
            "index",
            text(&hdm05),
            text(&cmu),
            "-o",
            text(&library),
            "--rate",
            rate,
            "--json",
        ];
        let first = motif(&args).json()["result"].clone();
        assert_eq!(first["clips"], 288 + 195);
        let segments = first["total"]["segments"].as_f64().unwrap();
        let bytes = fs::metadata(library.join("shards/0001.shard"))
            .unwrap()
            .len();
        let per_segment = bytes as f64 / segments;
        println!("{rate} Hz: {segments} segments, {bytes} bytes, {per_segment:.2} per segment");
        assert!(
            rate != "120" || per_segment <= BYTES_PER_SEGMENT,
            "{per_segment}"
        );
        let second = motif(&args).json()["result"].clone();
        assert_eq!(counts(&second), [0, 0, 483, 0, 483]);
        assert_eq!(shard_files(&library), ["0001.shard"]);
        assert_eq!(verify(&library).unwrap().damage, []);
    }
}
