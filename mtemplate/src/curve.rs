//! What matching gives for each frame.

use crate::fixed::{self, FixedCosts};

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

/// What becomes of a clip with fewer frames than the shortest match has.
///
/// Streams know no end that could be held: there such a clip is unmatched.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum ShortClips {
    /// It has no cost, as section 5.2 prints it (∞), and cannot be found.
    #[default]
    Unmatched,
    /// Its first and its last frame are held until it has just enough frames for a match: half of those
    /// missing come before it, the other half after it, and there the odd one. A match takes all of
    /// them; it is one of the whole clip, and its cost stands at the clip's last frame.
    ///
    /// This deviates from section 5.2, but not so far from section 5.4, where all clips are one stream
    /// and a match goes on into the neighbours: held frames stand in for neighbours, so that a clip's
    /// cost is its own. Longer clips are matched as ever.
    Held,
}

/// Cost of the best match that ends at each frame: the function Δ of section 5.2.
#[derive(Debug, Clone, PartialEq)]
pub struct DistanceCurve {
    costs: Vec<u32>,
    /// What a cost of 1 is.
    scale: f64,
}

impl DistanceCurve {
    pub(crate) fn new(costs: Vec<u32>, scale: f64) -> Self {
        Self { costs, scale }
    }

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
        fixed::cost(*self.costs.get(frame)?, self.scale)
    }

    /// The cost for each frame.
    pub fn costs(&self) -> impl ExactSizeIterator<Item = Option<f64>> + '_ {
        let costs = self.costs.iter();
        costs.map(|cost| fixed::cost(*cost, self.scale))
    }
}

/// The best match that ends at a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ending {
    /// Its cost.
    pub cost: f64,
    /// Its first frame.
    pub start: usize,
}

impl FixedCosts {
    /// The ending at `frame` of a path that starts at `start` modulo 2³².
    pub(crate) fn ending(&self, frame: usize, cost: u32, start: u32) -> Option<Ending> {
        Some(Ending {
            cost: self.cost(cost)?,
            start: start_before(frame, start),
        })
    }
}

/// The frame up to `frame` that is `start` modulo 2³²: paths are shorter than that.
pub(crate) fn start_before(frame: usize, start: u32) -> usize {
    frame.saturating_sub((frame as u32).wrapping_sub(start) as usize)
}
