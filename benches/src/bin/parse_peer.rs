//! Our side of `cargo xtask peers parse`: `parse_peer motif RUNS FILE…`, with the ASF before its AMC.

use std::path::Path;
use std::{env, fs};

use anyhow::{Context, Result, bail};
use benches::stopwatch;
use mocap_io::{Motion, parse_amc, parse_asf, parse_bvh, parse_c3d};

const READ_BEFORE: &str = "the same bytes were read before";

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(2).collect();
    let (runs, files) = arguments.split_first().context("RUNS is missing")?;
    let runs = runs.parse()?;
    let path = Path::new(files.last().context("FILE is missing")?);
    let bytes = fs::read(path)?;
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("bvh") => {
            parse_bvh(&bytes)?;
            let read = || parse_bvh(&bytes).expect(READ_BEFORE);
            stopwatch::report(runs, read, |bvh| facts(&bvh.motion));
        }
        Some("amc") => {
            let asf = parse_asf(&fs::read(&files[0])?)?;
            parse_amc(&bytes, &asf)?;
            let read = || parse_amc(&bytes, &asf).expect(READ_BEFORE);
            stopwatch::report(runs, read, |amc| facts(&amc.motion));
        }
        Some("c3d") => {
            parse_c3d(&bytes)?;
            let read = || parse_c3d(&bytes).expect(READ_BEFORE);
            stopwatch::report(runs, read, |c3d| {
                let positions = &c3d.markers.positions;
                let sum = positions.iter().copied().map(f64::from).sum();
                [("frames", positions.dim().0 as f64), ("sum", sum)]
            });
        }
        _ => bail!("{}: none of BVH, AMC, C3D", path.display()),
    }
    Ok(())
}

/// Frame count and sum of all values.
fn facts(motion: &Motion) -> [(&'static str, f64); 2] {
    let sum = motion.channels.iter().sum();
    [("frames", motion.n_frames() as f64), ("sum", sum)]
}
