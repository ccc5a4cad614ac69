//! What a stage takes.

use std::fs;
use std::time::Instant;

use cpu_time::ProcessTime;

/// What one stage took.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stage {
    pub(crate) name: String,
    /// Seconds on the wall.
    pub(crate) wall: f64,
    /// Seconds of all threads together.
    pub(crate) cpu: f64,
    /// The most memory of the process in the stage, in megabytes, where the system says so.
    pub(crate) peak: Option<f64>,
}

/// Measures stages one after the other.
pub(crate) struct Clock {
    wall: Instant,
    cpu: ProcessTime,
    pub(crate) stages: Vec<Stage>,
}

impl Clock {
    pub(crate) fn start() -> Clock {
        forget_peak();
        Clock {
            wall: Instant::now(),
            cpu: ProcessTime::now(),
            stages: Vec::new(),
        }
    }

    /// A stage ends, and the next one begins.
    pub(crate) fn end(&mut self, name: &str) {
        self.stages.push(Stage {
            name: name.to_owned(),
            wall: self.wall.elapsed().as_secs_f64(),
            cpu: self.cpu.elapsed().as_secs_f64(),
            peak: peak(),
        });
        forget_peak();
        (self.wall, self.cpu) = (Instant::now(), ProcessTime::now());
    }
}

/// Lets the peak begin anew from what is in use; where that cannot be, peaks only grow.
fn forget_peak() {
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// Most memory at once, in megabytes.
fn peak() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
    Some(kilobytes / 1e3)
}
