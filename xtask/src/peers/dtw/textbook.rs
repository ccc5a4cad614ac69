//! What everybody must find, from whole tables:
//! D(i,j) = C(i,j) + min(D(i-1,j-1), D(i,j-1), D(i-1,j)), infinite outside the band.

use super::super::Fact;

/// Of costs, relative: peers that sum a few thousand local costs in `f32` are right.
const ROUNDING: f64 = 1e-5;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Local {
    Euclidean,
    /// Of the sum the root is taken.
    Squared,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Warping {
    local: Local,
    radius: usize,
}

impl Warping {
    pub(super) const fn new(local: Local, radius: Option<usize>) -> Self {
        let radius = match radius {
            Some(cells) => cells,
            None => usize::MAX,
        };
        Self { local, radius }
    }

    /// Inside the band, of two sequences of `n` frames.
    pub(super) fn cells(self, n: usize) -> usize {
        (0..n).map(|i| self.columns(i, n).len()).sum()
    }

    fn columns(self, i: usize, n: usize) -> std::ops::Range<usize> {
        i.saturating_sub(self.radius)..i.saturating_add(self.radius).saturating_add(1).min(n)
    }

    /// D of two sequences of `n` frames one after the other, with a row and a column before the
    /// first; stops after a row whose cheapest cell is dearer than `limit`.
    fn fill(self, table: &mut Vec<f64>, (a, b): (&[f64], &[f64]), n: usize, limit: f64) {
        let (dims, width) = (a.len() / n, n + 1);
        table.resize(width * width, f64::INFINITY);
        table[..width].fill(f64::INFINITY);
        table[width * width - 1] = f64::INFINITY;
        table[0] = 0.0;
        for (i, x) in a.chunks_exact(dims).enumerate() {
            let (before, row) = table.split_at_mut((i + 1) * width);
            let (before, row) = (&before[i * width..], &mut row[..width]);
            row.fill(f64::INFINITY);
            let mut cheapest = f64::INFINITY;
            for j in self.columns(i, n) {
                let y = &b[j * dims..][..dims];
                let squares: f64 = x.iter().zip(y).map(|(x, y)| (x - y) * (x - y)).sum();
                let best = before[j].min(before[j + 1]).min(row[j]);
                row[j + 1] = best
                    + match self.local {
                        Local::Euclidean => squares.sqrt(),
                        Local::Squared => squares,
                    };
                cheapest = cheapest.min(row[j + 1]);
            }
            if cheapest > limit {
                return;
            }
        }
    }

    fn cost(self, sum: f64) -> f64 {
        match self.local {
            Local::Euclidean => sum,
            Local::Squared => sum.sqrt(),
        }
    }

    /// Cost of the cheapest path of two sequences of `n` frames, and its number of cells.
    pub(super) fn facts_of_pair(self, n: usize, both: &[f64]) -> Vec<Fact> {
        let mut table = Vec::new();
        self.fill(&mut table, both.split_at(both.len() / 2), n, f64::INFINITY);
        let at = |i: usize, j: usize| table[i * (n + 1) + j];
        let (mut i, mut j, mut steps) = (n, n, 1);
        while (i, j) != (1, 1) {
            let ways = [(i - 1, j - 1), (i, j - 1), (i - 1, j)];
            let dearer =
                |x: &(usize, usize), y: &(usize, usize)| at(x.0, x.1).total_cmp(&at(y.0, y.1));
            (i, j) = ways.into_iter().min_by(dearer).unwrap_or((1, 1));
            steps += 1;
        }
        vec![cost(self.cost(at(n, n))), exactly("steps", steps)]
    }

    /// Sum of the costs of all pairs of series of `n` samples.
    pub(super) fn facts_of_all_pairs(self, n: usize, numbers: &[f64]) -> Vec<Fact> {
        let series: Vec<&[f64]> = numbers.chunks_exact(n).collect();
        let mut table = Vec::new();
        let mut sum = 0.0;
        for (i, a) in series.iter().enumerate() {
            for b in &series[..i] {
                self.fill(&mut table, (a, b), n, f64::INFINITY);
                sum += self.cost(table.last().copied().unwrap_or(f64::NAN));
            }
        }
        vec![cost(sum)]
    }

    /// Where the window begins that is nearest to the query, all of them with mean 0 and deviation 1,
    /// and how near it is.
    pub(super) fn facts_of_windows(self, query: &[f64], series: &[f64]) -> Vec<Fact> {
        let query = normalised(query);
        let mut table = Vec::new();
        let mut nearest = (0, f64::INFINITY);
        for (start, window) in series.windows(query.len()).enumerate() {
            let window = normalised(window);
            self.fill(&mut table, (&query, &window), query.len(), nearest.1);
            let sum = table.last().copied().unwrap_or(f64::INFINITY);
            if sum < nearest.1 {
                nearest = (start, sum);
            }
        }
        vec![exactly("start", nearest.0), cost(self.cost(nearest.1))]
    }
}

/// With mean 0 and deviation 1.
pub(super) fn normalised(numbers: &[f64]) -> Vec<f64> {
    let n = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / n;
    let squares = numbers.iter().map(|x| (x - mean) * (x - mean));
    let deviation = (squares.sum::<f64>() / n).sqrt();
    numbers.iter().map(|x| (x - mean) / deviation).collect()
}

fn cost(value: f64) -> Fact {
    Fact {
        key: "cost",
        value,
        tolerance: ROUNDING * value,
    }
}

fn exactly(key: &'static str, value: usize) -> Fact {
    Fact {
        key,
        value: value as f64,
        tolerance: 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A few roundings of numbers near 1 by either normalisation.
    const NORMALISED_TWICE: f64 = 8.0 * f64::EPSILON;

    fn stated(facts: &[Fact]) -> Vec<f64> {
        facts.iter().map(|fact| fact.value).collect()
    }

    #[test]
    fn pairs_by_hand() {
        // The way down the first column and along the last row costs nothing but 1 at its corner.
        let both = [0.0, 0.0, 2.0, 0.0, 2.0, 3.0];
        let full = Warping::new(Local::Euclidean, None);
        assert_eq!(stated(&full.facts_of_pair(3, &both)), [1.0, 4.0]);
        let diagonal = Warping::new(Local::Squared, Some(0));
        assert_eq!(
            stated(&diagonal.facts_of_pair(3, &both)),
            [5_f64.sqrt(), 3.0]
        );
        assert_eq!(
            stated(&diagonal.facts_of_all_pairs(3, &both)),
            [5_f64.sqrt()]
        );
        assert_eq!((full.cells(3), diagonal.cells(3)), (9, 3));
    }

    #[test]
    fn a_window_is_found_at_any_level_and_size() {
        let warping = Warping::new(Local::Squared, Some(1));
        let series = [5.0, 3.0, 9.0, 10.0, 20.0, 10.0, 40.0, 30.0];
        let facts = stated(&warping.facts_of_windows(&[1.0, 2.0, 1.0, 4.0], &series));
        assert_eq!(facts[0], 3.0);
        assert!(facts[1] <= NORMALISED_TWICE, "{facts:?}");
    }
}
