//! Extraction as it is stated, for the direct closure from the first instance: every pair of substrings in each round.

use bundles::{Accessibility, ExtractOptions, MotionString, Substring};

/// The members of each bundle.
pub fn bundles(
    string: &MotionString,
    access: &Accessibility,
    options: &ExtractOptions,
) -> Vec<Vec<Substring>> {
    let runs = string.runs();
    let is_inside = |j: usize| {
        runs.get(j + 1)
            .is_some_and(|next| next.clip == runs[j].clip)
    };
    let mut free: Vec<bool> = (0..runs.len()).map(is_inside).collect();
    let mut found = Vec::new();
    while let Some(c) = seed(string, access, &free) {
        let all = substrings(&free, options.max_letters);
        let mut best: Option<(f64, usize, Vec<Substring>)> = None;
        for &seed in all.iter().filter(|s| s.first <= c && c <= s.last) {
            let members = similar(string, access, options, (seed, &all));
            let height = members.len();
            let volume = (height - 1) as f64 * mean(string, &members).powf(options.rho);
            if best.as_ref().is_none_or(|b| (volume, height) > (b.0, b.1)) {
                best = Some((volume, height, members));
            }
        }
        let Some((_, height, mut members)) = best else {
            break;
        };
        if height == 1 {
            let sides = [c.checked_sub(1), Some(c)].into_iter().flatten();
            let sides = sides.filter(|&j| free[j]);
            let width = |j: &usize| {
                width(
                    string,
                    Substring {
                        first: *j,
                        last: j + 1,
                    },
                )
            };
            if let Some(side) = sides.min_by(|a, b| width(a).total_cmp(&width(b))) {
                free[side] = false;
            }
            continue;
        }
        members.sort_unstable();
        members
            .iter()
            .for_each(|member| free[member.intervals()].fill(false));
        found.push(members);
    }
    found
}

fn seed(string: &MotionString, access: &Accessibility, free: &[bool]) -> Option<usize> {
    let is_free = |j: &usize| free[*j] || (*j > 0 && free[j - 1]);
    let label = |j: usize| string.runs()[j].letter.label() as usize;
    let mut counts = vec![0; access.n_letters()];
    (0..free.len())
        .filter(is_free)
        .for_each(|j| counts[label(j)] += 1);
    let most = *counts.iter().max()?;
    let letter = counts.iter().position(|&count| count == most)?;
    (0..free.len())
        .filter(is_free)
        .find(|&j| label(j) == letter)
}

fn substrings(free: &[bool], max_letters: usize) -> Vec<Substring> {
    let from = |first: usize| {
        let lasts = (first + 1..first + max_letters).take_while(|last| free[last - 1]);
        lasts.map(move |last| Substring { first, last })
    };
    (0..free.len()).flat_map(from).collect()
}

fn similar(
    string: &MotionString,
    access: &Accessibility,
    options: &ExtractOptions,
    (seed, all): (Substring, &[Substring]),
) -> Vec<Substring> {
    let is_like = |a: f64, b: f64| options.gamma * a <= b && options.gamma * b <= a;
    let reference = width(string, seed);
    let mut candidates = Vec::new();
    for &other in all
        .iter()
        .filter(|&&other| is_like(width(string, other), reference))
    {
        if let Some(mean) = path(string, access, seed, other) {
            candidates.push((mean, (width(string, other) - reference).abs(), other));
        }
    }
    candidates.sort_by(|a, b| a.partial_cmp(b).expect("no NaN"));
    let mut members = vec![seed];
    for (_, _, other) in candidates {
        if !members.iter().any(|member| member.shares_interval(other)) {
            members.push(other);
        }
    }
    let mean = mean(string, &members);
    members.retain(|&member| member == seed || is_like(width(string, member), mean));
    members
}

/// Mean distance along the path of least sum, then fewest cells, by the whole table.
fn path(string: &MotionString, access: &Accessibility, a: Substring, b: Substring) -> Option<f64> {
    let letter = |j: usize| string.runs()[j].letter;
    let columns = b.last - b.first + 1;
    let mut table: Vec<Option<(f64, u32)>> = Vec::new();
    for (i, row) in (a.first..=a.last).enumerate() {
        for (k, column) in (b.first..=b.last).enumerate() {
            let at = |i: usize, k: usize| table[i * columns + k];
            let mut before = (i + k == 0).then_some((0.0, 0));
            let entries = [
                (i > 0).then(|| at(i - 1, k)),
                (k > 0).then(|| at(i, k - 1)),
                (i > 0 && k > 0).then(|| at(i - 1, k - 1)),
            ];
            for entry in entries.into_iter().flatten().flatten() {
                before = Some(before.map_or(
                    entry,
                    |known: (f64, u32)| {
                        if entry < known { entry } else { known }
                    },
                ));
            }
            let is_near = access.is_near(letter(row), letter(column)) == Some(true);
            let distance = access
                .distance(letter(row), letter(column))
                .filter(|_| is_near);
            let cell = before.zip(distance).map(|((sum, n), d)| (sum + d, n + 1));
            table.push(cell);
        }
    }
    let (sum, n) = table.pop()??;
    Some(sum / f64::from(n))
}

fn width(string: &MotionString, substring: Substring) -> f64 {
    string
        .width(substring.first, substring.last)
        .expect("a substring of a clip")
}

fn mean(string: &MotionString, members: &[Substring]) -> f64 {
    members
        .iter()
        .map(|&member| width(string, member))
        .sum::<f64>()
        / members.len() as f64
}
