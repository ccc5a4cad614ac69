//! Local costs as whole numbers. Sums of them are exact, so that ties are ties and the order of
//! additions does not matter: kernels of any width, batch and stream give the same bits.

use crate::Steps;

/// Of a cell that no path reaches, and the least number that says so: costs of paths lie below, and
/// whatever is added to it on the way through a template does not overflow.
pub(crate) const UNREACHED: u32 = 1 << 31;

/// A curve's cost is within this times K times A of the sum of
/// [`local_cost`](crate::QuantizedTemplate::local_cost)s, with A the largest (α + 1)/2 of the
/// template, for templates of up to ten million columns.
///
/// The weight of a disagreement is rounded to a whole number once, by half a unit at most, and a
/// path has at most 64 disagreements in each of K columns. The unit is at most 4 A/2³¹: the dearest
/// path costs 3/2 A, since it may begin a column early; costs that are fractions of a common
/// denominator may double the unit to be exact; a percent or so makes up for rounding up.
pub const COST_ERROR: f64 = 32.0 * 4.0 / UNREACHED as f64;

/// What a template asks in one column.
///
/// Invariant: bits outside `care` are 0 in `value`, and `care` has none past the last feature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Column {
    pub(crate) care: u64,
    pub(crate) value: u64,
    /// Weight α.
    pub(crate) weight: f64,
}

impl Column {
    /// Number of cells that are no wildcards, but at least 1.
    fn n_asked(&self) -> u32 {
        self.care.count_ones().max(1)
    }

    /// Local cost, not yet divided by K.
    pub(crate) fn cost(&self, word: u64) -> f64 {
        let disagreements = f64::from(((word ^ self.value) & self.care).count_ones());
        disagreements / f64::from(self.n_asked()) * ((self.weight + 1.0) / 2.0)
    }
}

/// A feature counts another way than in the column before: frames that have it gain `by`
/// disagreements, modulo 256.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Change {
    /// The feature is bit `bit` of byte `byte` of a word.
    pub(crate) byte: usize,
    pub(crate) bit: u8,
    pub(crate) by: u8,
}

/// Columns with their weights as whole numbers, one vector for each part as kernels read them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FixedCosts {
    pub(crate) care: Vec<u64>,
    pub(crate) value: Vec<u64>,
    /// Cost of one disagreement.
    pub(crate) weight: Vec<u32>,
    /// For each column. Disagreements with a word are the ones asked for, plus `by` of all changes
    /// up to the column whose feature the word has.
    pub(crate) changes: Vec<Vec<Change>>,
    /// All ones when a step that skips a column counts it twice, else zero.
    pub(crate) skip: u32,
    /// What a cost of 1 is.
    scale: f64,
}

impl FixedCosts {
    pub(crate) fn new(columns: &[Column], steps: Steps) -> Self {
        let n_columns = columns.len() as f64;
        let of_one = |c: &Column| (c.weight / 2.0 + 0.5) / f64::from(c.n_asked()) / n_columns;
        let weights: Vec<f64> = columns.iter().map(of_one).collect();
        let mut fixed = Self {
            care: columns.iter().map(|column| column.care).collect(),
            value: columns.iter().map(|column| column.value).collect(),
            weight: Vec::new(),
            changes: changes(columns),
            skip: match steps {
                Steps::Advance => u32::MAX,
                Steps::Unit => 0,
            },
            scale: 1.0,
        };
        let mut scale = f64::from(UNREACHED - 1) / fixed.dearest_path(&weights);
        loop {
            fixed.scale = rounder(columns, scale);
            fixed.weight = weights
                .iter()
                .map(|weight| (weight * fixed.scale).round() as u32)
                .collect();
            let rounded: Vec<f64> = fixed.weight.iter().map(|w| f64::from(*w)).collect();
            if fixed.dearest_path(&rounded) < f64::from(UNREACHED) {
                return fixed;
            }
            // Rounded up too often.
            scale *= 0.99;
        }
    }

    pub(crate) fn n_columns(&self) -> usize {
        self.weight.len()
    }

    /// A path's cost; `None` if there is no path.
    pub(crate) fn cost(&self, fixed: u32) -> Option<f64> {
        cost(fixed, self.scale)
    }

    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// The most that a path may cost which begins in the first columns, or before them, and goes
    /// through every cell at its worst.
    fn dearest_path(&self, weights: &[f64]) -> f64 {
        let (mut before, mut twice_before) = (0.0_f64, 0.0_f64);
        for (weight, care) in weights.iter().zip(&self.care) {
            let cost = weight * f64::from(care.count_ones());
            let skip = if self.skip == 0 { 0.0 } else { cost };
            let now = before.max(twice_before + skip) + cost;
            (before, twice_before) = (now, before);
        }
        before.max(f64::MIN_POSITIVE)
    }
}

/// See [`FixedCosts::cost`].
pub(crate) fn cost(fixed: u32, scale: f64) -> Option<f64> {
    (fixed < UNREACHED).then(|| f64::from(fixed) / scale)
}

/// The scale, or a little less so that costs of columns with weights of 1 are whole numbers, where
/// that is possible: then costs of such templates are exact fractions.
fn rounder(columns: &[Column], scale: f64) -> f64 {
    let fraction = columns.iter().try_fold(1_u64, |fraction, column| {
        let n_asked = u64::from(column.n_asked());
        fraction.checked_mul(n_asked / common_divisor(fraction, n_asked))
    });
    let fraction = fraction.and_then(|fraction| fraction.checked_mul(columns.len() as u64));
    match fraction.map(|fraction| (fraction as f64, (scale / fraction as f64).floor())) {
        Some((fraction, times)) if times >= 1.0 && times.is_finite() => fraction * times,
        // Nothing to be paid, or too fine a fraction.
        _ => scale.min(f64::from(UNREACHED)),
    }
}

fn common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

fn changes(columns: &[Column]) -> Vec<Vec<Change>> {
    // What a frame that has a feature adds to the ones asked for.
    let adds = |column: &Column, feature: usize| {
        let asked = column.care >> feature & 1;
        let one = column.value >> feature & 1;
        (asked as u8).wrapping_sub(2 * one as u8)
    };
    let nothing = Column {
        care: 0,
        value: 0,
        weight: 1.0,
    };
    let before = std::iter::once(&nothing).chain(columns);
    let of_column = |(before, column): (&Column, &Column)| {
        let change = |feature: usize| Change {
            byte: feature / 8,
            bit: 1 << (feature % 8),
            by: adds(column, feature).wrapping_sub(adds(before, feature)),
        };
        (0..64)
            .map(change)
            .filter(|change| change.by != 0)
            .collect()
    };
    before.zip(columns).map(of_column).collect()
}
