//! A curve while its clip is being recorded.

use pulp::{Arch, Simd, WithSimd};

use crate::curve::start_before;
use crate::fixed::{FixedCosts, UNREACHED};
use crate::relax::{self, From};
use crate::{Ending, QuantizedTemplate};

/// Matches a template against words as they come: for each one the ending that
/// [`QuantizedTemplate::endings`] has at its frame, bit for bit. A word takes O(K) time, the matcher
/// O(K) memory.
///
/// ```
/// use mtemplate::{MotionTemplate, StreamMatcher};
///
/// let template = MotionTemplate::from_words(&[0b01, 0b11, 0b10], 2)?.quantize(0.1)?;
/// let mut matcher = StreamMatcher::new(&template);
/// let endings = [0b00, 0b01, 0b11, 0b10].map(|word| matcher.push(word));
/// assert_eq!(endings[0], None);
/// assert!(endings[3].is_some_and(|ending| ending.cost == 0.0 && ending.start == 1));
/// # Ok::<(), mtemplate::TemplateError>(())
/// ```
#[derive(Debug, Clone)]
pub struct StreamMatcher {
    costs: FixedCosts,
    n_frames: usize,
    /// Cost of each column with the last word.
    local: Vec<u32>,
    /// The last word; `local` stands as long as it stays.
    word: Option<u64>,
    now: Front,
    before: Front,
    twice_before: Front,
}

/// Paths to the columns at one frame, after a place before the first column.
#[derive(Debug, Clone)]
struct Front {
    costs: Vec<u32>,
    starts: Vec<u32>,
}

impl StreamMatcher {
    /// A matcher before its first word.
    pub fn new(template: &QuantizedTemplate) -> Self {
        let costs = template.costs().clone();
        let n_columns = costs.n_columns();
        let nowhere = Front {
            costs: vec![UNREACHED; 1 + n_columns],
            starts: vec![0; 1 + n_columns],
        };
        Self {
            n_frames: 0,
            local: vec![0; n_columns],
            word: None,
            now: nowhere.clone(),
            before: nowhere.clone(),
            twice_before: nowhere,
            costs,
        }
    }

    /// Number of words so far.
    pub fn n_frames(&self) -> usize {
        self.n_frames
    }

    /// The best match that ends with this word, at the frame [`n_frames`](Self::n_frames) told
    /// before; `None` where none can end.
    pub fn push(&mut self, word: u64) -> Option<Ending> {
        let (cost, start) = self.push_fixed(word)?;
        let cost = self.cost(cost)?;
        Some(Ending { cost, start })
    }

    /// As [`push`](Self::push), with the cost as the kernels have it.
    pub(crate) fn push_fixed(&mut self, word: u64) -> Option<(u32, usize)> {
        let frame = self.n_frames;
        self.n_frames += 1;
        if self.local.len() < 2 {
            return None;
        }
        Arch::new().dispatch(Push {
            frame: frame as u32,
            word,
            is_new: self.word.replace(word) != Some(word),
            matcher: self,
        });
        let (cost, start) = (*self.now.costs.last()?, *self.now.starts.last()?);
        // The oldest of the three is overwritten next.
        std::mem::swap(&mut self.before, &mut self.twice_before);
        std::mem::swap(&mut self.before, &mut self.now);
        (cost < UNREACHED).then(|| (cost, start_before(frame, start)))
    }

    pub(crate) fn cost(&self, fixed: u32) -> Option<f64> {
        self.costs.cost(fixed)
    }
}

struct Push<'a> {
    matcher: &'a mut StreamMatcher,
    frame: u32,
    word: u64,
    is_new: bool,
}

impl WithSimd for Push<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (matcher, word) = (self.matcher, self.word);
        let fixed = &matcher.costs;
        if self.is_new {
            let asked = fixed.care.iter().zip(&fixed.value).zip(&fixed.weight);
            for (local, ((care, value), weight)) in matcher.local.iter_mut().zip(asked) {
                *local = ((word ^ value) & care).count_ones() * weight;
            }
        }
        let (now, before, twice_before) =
            (&mut matcher.now, &matcher.before, &matcher.twice_before);
        let costs = From {
            ahead: &before.costs[1..],
            over_a_frame: &twice_before.costs[1..],
            over_a_column: &before.costs,
        };
        let starts = From {
            ahead: &before.starts[1..],
            over_a_frame: &twice_before.starts[1..],
            over_a_column: &before.starts,
        };
        let local = &matcher.local[1..];
        now.costs[1] = matcher.local[0];
        now.starts[1] = self.frame;
        let all = || local.iter().copied();
        relax::costs(&mut now.costs[2..], costs, fixed.skip, all());
        relax::starts(&mut now.starts[2..], costs, starts, fixed.skip, all());
    }
}
