//! What is printed of a job.

use super::race::{Outcome, median};
use super::{Amount, Contestant, Job, ROUNDS, Role};

/// Everybody, counted or not, fastest first.
pub(super) fn table(job: &Job, outcomes: &[Outcome], core: Option<u32>) -> String {
    let Amount { millions, unit } = job.amount;
    let place = core.map_or("not pinned".to_owned(), |core| format!("on core {core}"));
    let mut text = format!(
        "\n{}: {millions:.2} {unit}, process CPU time {place}, median (min to max) of {ROUNDS} rounds\n",
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
            let rate = millions / (ms / 1e3);
            row += &format!("{ms:>10.3} ms {range:<22}{rate:>8.1} {unit}/s");
        }
        if let Some(fault) = &outcome.fault {
            row += &format!("  {fault}");
        }
        text += row.trim_end();
        text.push('\n');
    }
    text
}

/// One line of each of ours against the fastest peer that counts, and one of the first of ours for
/// each duel.
pub(super) fn lines(job: &Job, outcomes: &[Outcome]) -> String {
    let of_role = |role: Role| {
        let all = job.contestants.iter().zip(outcomes);
        all.filter(move |(contestant, _)| contestant.role == role)
            .map(|(contestant, outcome)| (contestant.name, outcome.counted()))
    };
    let fastest = |role: Role| {
        let counted = of_role(role).filter_map(|(name, ms)| Some((name, ms?)));
        counted.min_by(|(_, a), (_, b)| a.total_cmp(b))
    };
    let limit = fastest(Role::Limit).map(|(_, ms)| ms);
    let mut text = String::new();
    let mut ours = of_role(Role::Ours);
    let first = ours.next().and_then(|(_, ms)| ms);
    text += &line(job.name, first, fastest(Role::Peer), limit);
    for (name, ms) in ours {
        let (_, variant) = name.split_once(':').unwrap_or(("", name));
        let name = format!("{}-{variant}", job.name);
        text += &line(&name, ms, fastest(Role::Peer), None);
    }
    for (name, rival) in job.duels {
        let mut peers = of_role(Role::Peer).filter_map(|(name, ms)| Some((name, ms?)));
        text += &line(name, first, peers.find(|(name, _)| name == rival), limit);
    }
    text
}

fn line(
    name: &str,
    ours: Option<f64>,
    peer: Option<(&'static str, f64)>,
    limit: Option<f64>,
) -> String {
    let peer_ms = peer.map(|(_, ms)| ms);
    let share = |of: Option<f64>| Some(of? / ours?);
    format!(
        "job={name} ours_ms={} best_peer={} peer_ms={} ratio={} limit_ms={} limit_share={}\n",
        number(ours, 3),
        peer.map_or("-", |(name, _)| name),
        number(peer_ms, 3),
        number(share(peer_ms), 2),
        number(limit, 3),
        number(share(limit), 3),
    )
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
            amount: Amount {
                millions: 5.0,
                unit: "MB",
            },
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
    fn further_ones_of_ours_have_lines_without_a_limit() {
        let peers = [(Role::Ours, "motif:f64"), (Role::Peer, "slow")];
        let job = job(&[
            &[(Role::Ours, "motif")],
            &peers[..],
            &[(Role::Limit, "limit")],
        ]
        .concat());
        let text = lines(&job, &[10.0, 20.0, 100.0, 5.0].map(took));
        assert_eq!(
            text.lines().nth(1),
            Some(
                "job=bvh-f64 ours_ms=20.000 best_peer=slow peer_ms=100.000 ratio=5.00 limit_ms=- \
                 limit_share=-"
            )
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
