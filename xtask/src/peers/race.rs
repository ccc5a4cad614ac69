//! Contestants in turn, round after round, pinned to one core.

use std::fs;
use std::process;

use anyhow::{Result, bail};

use super::{Contestant, Fact, Job, ROUNDS, Role};
use crate::workspace::{capture, tail, text};

/// Variables that set how many threads a pool has.
const POOLS: [&str; 5] = [
    "MKL_NUM_THREADS",
    "NUMBA_NUM_THREADS",
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "RAYON_NUM_THREADS",
];

/// What one contestant showed.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Outcome {
    /// CPU milliseconds of each round.
    pub(super) ms: Vec<f64>,
    /// Why it is not counted.
    pub(super) fault: Option<String>,
}

impl Outcome {
    /// The time that counts.
    pub(super) fn counted(&self) -> Option<f64> {
        median(&self.ms).filter(|_| self.fault.is_none())
    }
}

/// The middle one, or the mean of the two in the middle.
pub(super) fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let upper = *sorted.get(sorted.len() / 2)?;
    let lower = sorted[(sorted.len() - 1) / 2];
    Some(f64::midpoint(lower, upper))
}

/// The last core this process may use; none where that is unknown or nothing pins.
pub(super) fn last_core() -> Option<u32> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let list = status
        .lines()
        .find_map(|line| line.strip_prefix("Cpus_allowed_list:"))?;
    let core = list.trim().rsplit([',', '-']).next()?.parse().ok()?;
    let mut taskset = process::Command::new("taskset");
    capture(taskset.arg("--version")).ok().map(|_| core)
}

/// Outcomes in the order of the contestants. Fails when ours is the one that fails.
pub(super) fn run(job: &Job, core: Option<u32>) -> Result<Vec<Outcome>> {
    let mut outcomes = vec![Outcome::default(); job.contestants.len()];
    for _ in 0..ROUNDS {
        for (contestant, outcome) in job.contestants.iter().zip(&mut outcomes) {
            if outcome.fault.is_some() {
                continue;
            }
            match run_once(contestant, core).and_then(|out| judge(&out, contestant, &job.facts)) {
                Ok(ms) => outcome.ms.push(ms),
                Err(Fault { ms, reason }) => {
                    outcome.ms.extend(ms);
                    outcome.fault = Some(reason);
                }
            }
            if let (Role::Ours, Some(fault)) = (contestant.role, &outcome.fault) {
                bail!("job {}: ours failed: {fault}", job.name);
            }
        }
    }
    Ok(outcomes)
}

#[derive(Debug, PartialEq)]
struct Fault {
    /// The time of a wrong answer.
    ms: Option<f64>,
    reason: String,
}

impl Fault {
    fn new(reason: impl Into<String>) -> Self {
        Self {
            ms: None,
            reason: reason.into(),
        }
    }
}

/// The last line a contestant prints.
fn run_once(contestant: &Contestant, core: Option<u32>) -> Result<String, Fault> {
    let line = contestant.command.as_ref().map_err(Fault::new)?;
    let mut command = process::Command::new("taskset");
    match (core, line.split_first()) {
        (Some(core), _) => {
            command.arg("--cpu-list").arg(core.to_string()).args(line);
        }
        (None, Some((program, arguments))) => {
            command = process::Command::new(program);
            command.args(arguments);
        }
        (None, None) => return Err(Fault::new("no program")),
    }
    // One core, one thread: pools would only get in their own way.
    for pool in POOLS {
        command.env(pool, "1");
    }
    let output = capture(&mut command).map_err(|error| Fault::new(format!("{error:#}")))?;
    if !output.status.success() {
        let last = tail(text(&output.stderr).trim(), 1);
        return Err(Fault::new(format!("failed: {last}")));
    }
    Ok(tail(text(&output.stdout).trim(), 1))
}

/// Milliseconds out of `key=value …`, if every fact that must be stated is stated rightly.
fn judge(line: &str, contestant: &Contestant, facts: &[Fact]) -> Result<f64, Fault> {
    let stated = |key: &str| {
        line.split_whitespace()
            .filter_map(|word| word.split_once('='))
            .find_map(|(k, value)| (k == key).then(|| value.parse::<f64>().ok())?)
    };
    let ms = stated("ms").ok_or_else(|| Fault::new(format!("no time in `{line}`")))?;
    for key in contestant.states {
        let fact = facts.iter().find(|fact| fact.key == *key);
        let is_right = |f: &Fact| stated(key).is_some_and(|v| (v - f.value).abs() <= f.tolerance);
        if !fact.is_some_and(is_right) {
            let shown = |value: Option<f64>| value.map_or("nothing".into(), |v| v.to_string());
            let (found, expected) = (shown(stated(key)), shown(fact.map(|f| f.value)));
            return Err(Fault {
                ms: Some(ms),
                reason: format!("not counted: {key} is {found}, {expected} expected"),
            });
        }
    }
    Ok(ms)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACTS: [Fact; 2] = [
        Fact {
            key: "frames",
            value: 10.0,
            tolerance: 0.0,
        },
        Fact {
            key: "sum",
            value: 2.5,
            tolerance: 0.1,
        },
    ];

    fn contestant(states: &'static [&'static str]) -> Contestant {
        Contestant {
            role: Role::Peer,
            name: "peer",
            version: String::new(),
            command: Ok(Vec::new()),
            states,
        }
    }

    #[test]
    fn median_of_odd_even_and_none() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median(&[]), None);
    }

    #[test]
    fn right_facts_give_the_time() {
        let line = "frames=10 sum=2.45 ms=7.25";
        assert_eq!(
            judge(line, &contestant(&["frames", "sum"]), &FACTS),
            Ok(7.25)
        );
    }

    #[test]
    fn wrong_missing_or_unreadable_facts_do_not_count() {
        let states = contestant(&["frames", "sum"]);
        for line in [
            "frames=9 sum=2.5 ms=7",
            "frames=10 ms=7",
            "frames=10 sum=NaN ms=7",
        ] {
            let fault = judge(line, &states, &FACTS).unwrap_err();
            assert_eq!(fault.ms, Some(7.0), "{line}");
            assert!(fault.reason.starts_with("not counted"), "{line}");
        }
        assert_eq!(
            judge("frames=10 sum=2.5", &states, &FACTS).unwrap_err().ms,
            None
        );
    }

    #[test]
    fn a_fault_is_never_counted() {
        let outcome = Outcome {
            ms: vec![1.0],
            fault: Some("wrong".into()),
        };
        assert_eq!(outcome.counted(), None);
    }
}
