//! Subsequence alignment. D(1,l) = c(1,l), and for k > 1
//! D(k,l) = min(D(k-1,l-1) + c(k,l), D(k-1,l-2) + c(k,l), D(k-2,l-1) + w c(k,l)),
//! with c the local cost of template column k and data frame l, and w the weight of a step that
//! skips a column; the curve is D(K,l).

/// What a step that skips a template column counts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Steps {
    /// Steps (template, data) of (1,1), (1,2), (2,1) weigh 1, 1, 2: the template's advance, so that
    /// the weights of every path sum to K.
    #[default]
    Advance,
    /// Every step weighs 1, as equation 2 is printed; paths that skip columns are cheaper then.
    Unit,
}

impl Steps {
    fn over_a_column(self) -> f64 {
        match self {
            Steps::Advance => 2.0,
            Steps::Unit => 1.0,
        }
    }
}

/// Cost of the best match that ends at each frame: the function Δ of section 5.2.
#[derive(Debug, Clone, PartialEq)]
pub struct DistanceCurve {
    costs: Vec<Option<f64>>,
}

impl DistanceCurve {
    /// Number of frames.
    pub fn len(&self) -> usize {
        self.costs.len()
    }

    /// Whether there is no frame.
    pub fn is_empty(&self) -> bool {
        self.costs.is_empty()
    }

    /// Cost of the best match that ends at `frame`; `None` where none can end, and past the last.
    pub fn cost(&self, frame: usize) -> Option<f64> {
        self.costs.get(frame).copied().flatten()
    }

    /// The cost for each frame.
    pub fn costs(&self) -> impl ExactSizeIterator<Item = Option<f64>> + '_ {
        self.costs.iter().copied()
    }
}

#[derive(Debug, Clone, Copy)]
struct Reached {
    cost: f64,
    start: usize,
}

pub(crate) fn distance_curve(
    n_columns: usize,
    words: &[u64],
    steps: Steps,
    local: impl Fn(usize, u64) -> f64,
) -> DistanceCurve {
    let mut costs = Vec::with_capacity(words.len());
    sweep(n_columns, words, steps, local, |end| {
        costs.push(end.map(|end| end.cost));
    });
    DistanceCurve { costs }
}

/// Start of the best match that ends with the last of `words`.
pub(crate) fn start(
    n_columns: usize,
    words: &[u64],
    steps: Steps,
    local: impl Fn(usize, u64) -> f64,
) -> Option<usize> {
    let mut last = None;
    sweep(n_columns, words, steps, local, |end| last = end);
    last.map(|end| end.start)
}

/// Ties go to the first of (1,1), (1,2), (2,1).
fn sweep(
    n_columns: usize,
    words: &[u64],
    steps: Steps,
    local: impl Fn(usize, u64) -> f64,
    mut each: impl FnMut(Option<Reached>),
) {
    if n_columns < 2 {
        words.iter().for_each(|_| each(None));
        return;
    }
    // Invariant: before frame l, `before` is D(·,l-1) and `twice_before` is D(·,l-2).
    let mut before: Vec<Option<Reached>> = vec![None; n_columns];
    let mut twice_before = before.clone();
    let mut now = before.clone();
    for (frame, &word) in words.iter().enumerate() {
        now[0] = Some(Reached {
            cost: local(0, word),
            start: frame,
        });
        for k in 1..n_columns {
            let cost = local(k, word);
            let over_a_column = if k >= 2 { before[k - 2] } else { None };
            let ways = [
                step(before[k - 1], cost),
                step(twice_before[k - 1], cost),
                step(over_a_column, steps.over_a_column() * cost),
            ];
            // `min_by` keeps the first of equals.
            now[k] = ways
                .into_iter()
                .flatten()
                .min_by(|a, b| a.cost.total_cmp(&b.cost));
        }
        each(now[n_columns - 1]);
        // The oldest of the three is overwritten next.
        std::mem::swap(&mut before, &mut twice_before);
        std::mem::swap(&mut before, &mut now);
    }
}

fn step(from: Option<Reached>, cost: f64) -> Option<Reached> {
    from.map(|from| Reached {
        cost: from.cost + cost,
        ..from
    })
}
