//! What is printed of a job.

use std::fmt::Write as _;

use super::race::{Outcome, median};
use super::{Contestant, Job, ROUNDS, Role};

/// Everybody, counted or not, fastest first.
pub(super) fn table(job: &Job, outcomes: &[Outcome], core: Option<u32>) -> String {
    let megabytes = job.input_bytes as f64 / 1e6;
    let place = core.map_or("not pinned".to_owned(), |core| format!("on core {core}"));
    let mut text = format!(
        "\n{}: {megabytes:.2} MB, process CPU time {place}, median (min to max) of {ROUNDS} rounds\n",
        job.name
    );
    let mut rows: Vec<(&Contestant, &Outcome)> = job.contestants.iter().zip(outcomes).collect();
    let time = |outcome: &Outcome| median(&outcome.ms).unwrap_or(f64::INFINITY);
    rows.sort_by(|(_, a), (_, b)| time(a).total_cmp(&time(b)));
    for (contestant, outcome) in rows {
        let mut row = format!("  {:<18}{:<8}", contestant.name, contestant.version);
        if let Some(ms) = median(&outcome.ms) {
            let min = outcome.ms.iter().copied().fold(f64::INFINITY, f64::min);
            let max = outcome.ms.iter().copied().fold(0.0, f64::max);
            let range = format!("({min:.2} to {max:.2})");
            let rate = megabytes / (ms / 1e3);
            row += &format!("{ms:>10.3} ms {range:<22}{rate:>8.1} MB/s");
        }
        if let Some(fault) = &outcome.fault {
            row += &format!("  {fault}");
        }
        text += row.trim_end();
        text.push('\n');
    }
    text
}

/// One line against the fastest peer that counts, one for each duel.
pub(super) fn lines(job: &Job, outcomes: &[Outcome]) -> String {
    let counted = |role: Role| {
        let all = job.contestants.iter().zip(outcomes);
        all.filter(move |(contestant, _)| contestant.role == role)
            .filter_map(|(contestant, outcome)| Some((contestant.name, outcome.counted()?)))
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
    };
    let duels = job.duels.iter().map(|&(line, rival)| {
        let all = job.contestants.iter().zip(outcomes);
        let peer = all.filter(|(contestant, _)| contestant.name == rival);
        let time = peer.filter_map(|(_, outcome)| outcome.counted()).next();
        (line, time.map(|ms| (rival, ms)))
    });
    let mut text = String::new();
    let ours = counted(Role::Ours).map(|(_, ms)| ms);
    let limit = counted(Role::Limit).map(|(_, ms)| ms);
    for (name, peer) in [(job.name, counted(Role::Peer))].into_iter().chain(duels) {
        let peer_ms = peer.map(|(_, ms)| ms);
        let share = |of: Option<f64>| Some(of? / ours?);
        let _ = writeln!(
            text,
            "job={name} ours_ms={} best_peer={} peer_ms={} ratio={} limit_ms={} limit_share={}",
            number(ours, 3),
            peer.map_or("-", |(name, _)| name),
            number(peer_ms, 3),
            number(share(peer_ms), 2),
            number(limit, 3),
            number(share(limit), 3),
        );
    }
    text
}

fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".into(), |value| format!("{value:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job(roles: &[(Role, &'static str)]) -> Job {
        let contestants = roles.iter().map(|&(role, name)| Contestant {
            role,
            name,
            version: "1.0.0".into(),
            command: Ok(Vec::new()),
            states: &[],
        });
        Job {
            name: "bvh",
            input_bytes: 5_000_000,
            facts: Vec::new(),
            contestants: contestants.collect(),
            duels: &[("bvh-slow", "slow")],
        }
    }

    fn took(ms: f64) -> Outcome {
        Outcome {
            ms: vec![ms; ROUNDS],
            fault: None,
        }
    }

    #[test]
    fn lines_name_the_fastest_that_counts() {
        let peers = [
            (Role::Peer, "slow"),
            (Role::Peer, "fast"),
            (Role::Peer, "wrong"),
        ];
        let job = job(&[
            &[(Role::Ours, "motif")],
            &peers[..],
            &[(Role::Limit, "limit")],
        ]
        .concat());
        let mut outcomes = [10.0, 100.0, 40.0, 1.0, 5.0].map(took);
        outcomes[3].fault = Some("not counted".into());
        assert_eq!(
            lines(&job, &outcomes),
            "job=bvh ours_ms=10.000 best_peer=fast peer_ms=40.000 ratio=4.00 limit_ms=5.000 \
             limit_share=0.500\n\
             job=bvh-slow ours_ms=10.000 best_peer=slow peer_ms=100.000 ratio=10.00 \
             limit_ms=5.000 limit_share=0.500\n"
        );
    }

    #[test]
    fn what_was_not_measured_is_a_dash() {
        let job = job(&[(Role::Ours, "motif")]);
        let line = "ours_ms=10.000 best_peer=- peer_ms=- ratio=- limit_ms=- limit_share=-\n";
        assert_eq!(
            lines(&job, &[took(10.0)]),
            format!("job=bvh {line}job=bvh-slow {line}")
        );
    }

    #[test]
    fn the_table_has_rates_and_faults() {
        let job = job(&[(Role::Ours, "motif"), (Role::Peer, "absent")]);
        let absent = Outcome {
            ms: Vec::new(),
            fault: Some("not installed: no network".into()),
        };
        let table = table(&job, &[took(10.0), absent], Some(1));
        assert!(table.contains("500.0 MB/s"), "{table}");
        assert!(table.contains("absent            1.0.0   "), "{table}");
        assert!(table.contains("not installed: no network"), "{table}");
    }
}
