//! Bundle extraction as it is stated: every substring, every pair of substrings, whole tables.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use bundles::ndarray::Array2;
use bundles::{Closure, ExtractOptions, MotionString, Partition, SeedInstance};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

type Pair = (usize, usize);

pub(crate) struct Naive<'a> {
    pub(crate) string: &'a MotionString,
    pub(crate) distances: &'a Array2<f64>,
    pub(crate) tau: f64,
    pub(crate) options: ExtractOptions,
    /// p(j) == 1, clip boundaries included.
    partitioned: Vec<bool>,
    /// Mean distance along the best path, of every pair of substrings asked for.
    paths: BTreeMap<(Pair, Pair), Option<f64>>,
}

#[derive(Debug, Default, PartialEq)]
pub(crate) struct Found {
    pub(crate) bundles: Vec<(Vec<Pair>, f64, f64)>,
    pub(crate) degenerate: Vec<Pair>,
}

impl From<&Partition> for Found {
    fn from(partition: &Partition) -> Self {
        let bundles = partition.bundles.iter().map(|bundle| {
            let members = bundle.members.iter().map(|m| (m.first, m.last)).collect();
            (members, bundle.mean_width, bundle.volume)
        });
        let degenerate = partition.degenerate.iter().map(|d| (d.first, d.last));
        Self {
            bundles: bundles.collect(),
            degenerate: degenerate.collect(),
        }
    }
}

impl<'a> Naive<'a> {
    pub(crate) fn new(
        string: &'a MotionString,
        distances: &'a Array2<f64>,
        tau: f64,
        options: ExtractOptions,
    ) -> Self {
        let runs = string.runs();
        let ends = |j: usize| j + 1 >= runs.len() || runs[j].clip != runs[j + 1].clip;
        Self {
            string,
            distances,
            tau,
            options,
            partitioned: (0..runs.len()).map(ends).collect(),
            paths: BTreeMap::new(),
        }
    }

    pub(crate) fn run(&mut self) -> Found {
        self.extend(Found::default())
    }

    pub(crate) fn extend(&mut self, mut found: Found) -> Found {
        for (members, _, _) in &found.bundles {
            members
                .iter()
                .for_each(|&member| mark(&mut self.partitioned, member));
        }
        let degenerate = found.degenerate.clone();
        degenerate
            .iter()
            .for_each(|&single| mark(&mut self.partitioned, single));
        for index in 0..found.bundles.len() {
            let old = found.bundles[index].0.clone();
            let band = self.mean(&old);
            let members = self.close(&old, band, true);
            let members = self.test_gamma(members, old.len());
            members
                .iter()
                .for_each(|&member| mark(&mut self.partitioned, member));
            found.bundles[index] = self.bundle(members);
        }

        let mut dice = match self.options.seed {
            SeedInstance::Random(seed) => Some(ChaCha8Rng::seed_from_u64(seed)),
            _ => None,
        };
        let mut single = Vec::new();
        if self.options.seed == SeedInstance::Largest {
            while let Some(members) = self.best(None) {
                members
                    .iter()
                    .for_each(|&member| mark(&mut self.partitioned, member));
                found.bundles.push(self.bundle(members));
            }
            let free = (0..self.string.len()).filter(|&j| !self.partitioned[j]);
            single.extend(free.map(|j| (j, j + 1)));
            self.partitioned.fill(true);
        }
        while let Some(c) = self.seed(&mut dice) {
            match self.best(Some(c)) {
                Some(members) => {
                    members
                        .iter()
                        .for_each(|&member| mark(&mut self.partitioned, member));
                    found.bundles.push(self.bundle(members));
                }
                None => {
                    let sides = [c.checked_sub(1), Some(c)].into_iter().flatten();
                    let free = sides.filter(|&j| !self.partitioned[j]).map(|j| (j, j + 1));
                    let side = free.reduce(|left, right| {
                        if self.width(right) < self.width(left) {
                            right
                        } else {
                            left
                        }
                    });
                    mark(&mut self.partitioned, side.unwrap());
                    single.push(side.unwrap());
                }
            }
        }
        // Adjacent ones merge until none are.
        while let Some((a, b)) = pair_where(&single, |a, b| a.1 == b.0) {
            let merged = (single[a].0, single[b].1);
            single[a] = merged;
            single.remove(b);
        }
        found.degenerate.extend(single);
        found.degenerate.sort();
        found
    }

    /// An unpartitioned occurrence of the most frequent unpartitioned letter.
    fn seed(&self, dice: &mut Option<ChaCha8Rng>) -> Option<usize> {
        let mut occurrences: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (j, run) in self.string.runs().iter().enumerate() {
            if !self.partitioned[j] || (j > 0 && !self.partitioned[j - 1]) {
                occurrences.entry(run.letter.label()).or_default().push(j);
            }
        }
        let most = occurrences.values().map(Vec::len).max()?;
        let instances = occurrences.values().find(|all| all.len() == most)?;
        let index = match dice {
            None => 0,
            Some(dice) => (u128::from(dice.next_u64()) * most as u128 / (1 << 64)) as usize,
        };
        Some(instances[index])
    }

    fn is_free(&self, (first, last): Pair) -> bool {
        (first..last).all(|j| !self.partitioned[j])
    }

    fn substrings(&self) -> Vec<Pair> {
        let m = self.string.len();
        let pairs = (0..m).flat_map(|first| (first + 1..m).map(move |last| (first, last)));
        let short = pairs.filter(|(first, last)| last - first < self.options.max_letters);
        short.filter(|&pair| self.is_free(pair)).collect()
    }

    /// The largest set of the seeds that contain `c`, or of all.
    fn best(&mut self, c: Option<usize>) -> Option<Vec<Pair>> {
        let mut best: Option<(f64, usize, Vec<Pair>)> = None;
        for seed in self.substrings() {
            if c.is_some_and(|c| c < seed.0 || seed.1 < c) {
                continue;
            }
            let direct = self.options.closure == Closure::Direct;
            let members = self.close(&[seed], self.width(seed), !direct);
            let members = self.test_gamma(members, 1);
            if members.len() < 2 {
                continue;
            }
            let (height, volume) = (members.len(), self.volume(&members));
            // Seeds come in order, so that only what is better replaces an earlier one.
            if best.as_ref().is_none_or(|b| (volume, height) > (b.0, b.1)) {
                best = Some((volume, height, members));
            }
        }
        best.map(|(_, _, members)| members)
    }

    /// What is similar to `roots`, and to what is found then, if `deep` or the roots are many.
    fn close(&mut self, roots: &[Pair], reference: f64, deep: bool) -> Vec<Pair> {
        let deep = deep && self.options.closure == Closure::Transitive;
        let mut members = roots.to_vec();
        let mut queue: VecDeque<Pair> = roots.iter().copied().collect();
        while let Some(member) = queue.pop_front() {
            let mut candidates = Vec::new();
            for other in self.substrings() {
                if !self.is_like(self.width(other), reference) {
                    continue;
                }
                if let Some(mean) = self.path(member, other) {
                    let stretch = (self.width(other) - self.width(member)).abs();
                    candidates.push((mean, stretch, other));
                }
            }
            candidates.sort_by(|a, b| a.partial_cmp(b).unwrap());
            for (_, _, other) in candidates {
                let used: BTreeSet<usize> = members.iter().flat_map(|m| m.0..m.1).collect();
                if (other.0..other.1).all(|j| !used.contains(&j)) {
                    members.push(other);
                    if deep {
                        queue.push_back(other);
                    }
                }
            }
        }
        members
    }

    fn test_gamma(&self, members: Vec<Pair>, kept: usize) -> Vec<Pair> {
        let mean = self.mean(&members);
        let tested = members.into_iter().enumerate();
        let passed = tested.filter(|&(i, m)| i < kept || self.is_like(self.width(m), mean));
        passed.map(|(_, member)| member).collect()
    }

    fn is_like(&self, a: f64, b: f64) -> bool {
        let gamma = self.options.gamma;
        gamma * a <= b && gamma * b <= a
    }

    /// The mean distance along the path of least sum, then of fewest cells, by a whole table.
    pub(crate) fn path(&mut self, a: Pair, b: Pair) -> Option<f64> {
        if let Some(&known) = self.paths.get(&(a, b)) {
            return known;
        }
        let label = |j: usize| self.string.runs()[j].letter.label() as usize;
        let (rows, columns) = (a.1 - a.0 + 1, b.1 - b.0 + 1);
        let mut table: Vec<Vec<Option<(f64, usize)>>> = vec![vec![None; columns]; rows];
        for i in 0..rows {
            for k in 0..columns {
                let d = self.distances[[label(a.0 + i), label(b.0 + k)]];
                if d > self.tau {
                    continue;
                }
                let mut before = Vec::new();
                if i > 0 {
                    before.extend(table[i - 1][k]);
                }
                if k > 0 {
                    before.extend(table[i][k - 1]);
                }
                if i > 0 && k > 0 {
                    before.extend(table[i - 1][k - 1]);
                }
                if (i, k) == (0, 0) {
                    before.push((0.0, 0));
                }
                before.sort_by(|x, y| x.partial_cmp(y).unwrap());
                table[i][k] = before.first().map(|(sum, cells)| (sum + d, cells + 1));
            }
        }
        let mean = table[rows - 1][columns - 1].map(|(sum, cells)| sum / cells as f64);
        self.paths.insert((a, b), mean);
        mean
    }

    /// F̄(last) - F̄(first).
    fn width(&self, (first, last): Pair) -> f64 {
        self.string.width(first, last).unwrap()
    }

    fn mean(&self, members: &[Pair]) -> f64 {
        members.iter().map(|&m| self.width(m)).sum::<f64>() / members.len() as f64
    }

    fn volume(&self, members: &[Pair]) -> f64 {
        (members.len() - 1) as f64 * self.mean(members).powf(self.options.rho)
    }

    fn bundle(&self, mut members: Vec<Pair>) -> (Vec<Pair>, f64, f64) {
        members.sort();
        let (mean, volume) = (self.mean(&members), self.volume(&members));
        (members, mean, volume)
    }
}

fn mark(partitioned: &mut [bool], (first, last): Pair) {
    partitioned[first..last].fill(true);
}

fn pair_where(all: &[Pair], is: impl Fn(Pair, Pair) -> bool) -> Option<(usize, usize)> {
    let pairs = (0..all.len()).flat_map(|a| (0..all.len()).map(move |b| (a, b)));
    pairs.into_iter().find(|&(a, b)| is(all[a], all[b]))
}
