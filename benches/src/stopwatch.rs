//! How a contestant of `cargo xtask peers` measures itself and shows that it did its work.
//!
//! `cargo xtask peers` compiles this file into the drivers of other people's crates too.

use std::hint::black_box;

use cpu_time::ProcessTime;

/// Works once unmeasured and then `runs` times; prints `key=value` for each fact and the median
/// of the process's CPU milliseconds as `ms`.
///
/// # Panics
/// If `runs` is 0.
pub fn report<T, const N: usize>(
    runs: usize,
    mut work: impl FnMut() -> T,
    facts: impl FnOnce(&T) -> [(&'static str, f64); N],
) {
    let facts = facts(&work());
    let mut times: Vec<f64> = Vec::with_capacity(runs);
    for _ in 0..runs {
        let start = ProcessTime::now();
        let result = black_box(work());
        times.push(start.elapsed().as_secs_f64() * 1e3);
        drop(result);
    }
    times.sort_by(f64::total_cmp);
    for (key, value) in facts {
        print!("{key}={value} ");
    }
    println!("ms={}", times[runs / 2]);
}
