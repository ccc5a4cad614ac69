//! What is in a C3D file: markers, rate, unit, up axis, and what is missing.
//!
//! `markers FILE.c3d [SECONDS]` fills gaps of up to so many seconds and says which.

use std::error::Error;
use std::fs;

use mocap_io::parse_c3d;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let Some(path) = arguments.next() else {
        println!("usage: markers FILE.c3d [SECONDS]");
        return Ok(());
    };
    let longest: f64 = arguments.next().map_or(Ok(0.0), |s| s.parse())?;
    let c3d = parse_c3d(&fs::read(path)?)?;
    for warning in &c3d.warnings {
        println!("warning: {warning}");
    }
    let (markers, filled) = c3d.markers.filled(longest);
    println!("{} {} points", c3d.byte_order, c3d.storage);
    let (n_frames, rate, seconds) = (markers.n_frames(), markers.rate.hz(), markers.duration());
    println!("{n_frames} frames at {rate} Hz, {seconds:.2} s");
    println!("unit {} ({:?})", markers.unit, markers.unit_source);
    println!("up {} ({:?})", markers.up, markers.up_source);
    let positions = markers.positions_y_up();
    let gaps = markers.gaps();
    for (idx, name) in markers.names.iter().enumerate() {
        let at: Vec<f32> = (0..3).map(|axis| positions[[0, idx, axis]]).collect();
        let of_marker = gaps.iter().filter(|gap| gap.marker == idx);
        let n_missing: usize = of_marker.map(|gap| gap.frames.len()).sum();
        println!(
            "{name:>20} {:8.3} {:8.3} {:8.3} m, missing in {n_missing} frames",
            at[0], at[1], at[2]
        );
    }
    for gap in &filled {
        println!(
            "filled {} in frames {:?}",
            markers.names[gap.marker], gap.frames
        );
    }
    for event in &c3d.events {
        let context = event.context.as_deref().unwrap_or("");
        println!("{:8.3} s {context} {}", event.seconds, event.label);
    }
    Ok(())
}
