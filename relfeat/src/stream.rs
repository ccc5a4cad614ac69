//! Words of a motion that is still being recorded.

use ndarray::ArrayView3;

use crate::extract::{bounds, check_rates, check_shape, n_words};
use crate::hysteresis::schmitt;
use crate::measure::{FirstPose, Kept, Paths};
use crate::velocity::window_frames;
use crate::{BodyMap, Bound, ExtractError, FeatureSet, Unavailable, source_frame};

/// Computes the words of a motion while its frames come, the very words that
/// [`extract`](crate::extract) gives for the whole motion.
///
/// Mean velocities look ahead, so the word of a frame is certain once the frames within half the
/// set's longest window after it have come: 16 frames at 120 Hz for the sets of the papers.
///
/// ```
/// use relfeat::ndarray::Array3;
/// use relfeat::{BodyMap, FeatureSet, Rig, WordStream, extract};
///
/// let set = FeatureSet::builtin("mueller2006").ok_or("no such set")?;
/// let rig = Rig::from_toml("name = 'two'\n[points]\nrshoulder = ['a']\nrelbow = ['b']")?;
/// let map = BodyMap::with_rig(&["a", "b"], &rig);
/// let motion = Array3::<f32>::zeros((100, 2, 3));
/// let mut stream = WordStream::new(set.clone(), map.clone(), 120.0, 30.0)?;
/// let mut words = stream.push(motion.view())?;
/// words.extend(stream.finish());
/// assert_eq!(words, extract(&set, motion.view(), &map, 120.0, 30.0)?.words);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct WordStream {
    set: FeatureSet,
    map: BodyMap,
    rate: f64,
    library_rate: f64,
    unavailable: Vec<Unavailable>,
    /// Frames that a frame's values depend on, before it and after it.
    reach: [usize; 2],
    n_joints: Option<usize>,
    /// Coordinates of the frames from `first` on that have come.
    held: Vec<f32>,
    first: usize,
    /// Frames whose words are certain.
    n_decided: usize,
    n_words: usize,
    first_pose: Option<FirstPose>,
    states: Vec<State>,
}

/// What a feature has to know of the frames that are gone.
#[derive(Clone, Debug, Default)]
struct State {
    bounds: Option<[Bound; 2]>,
    kept: Kept,
    on: bool,
}

impl WordStream {
    /// A stream without a frame so far; arguments as in [`extract`](crate::extract).
    ///
    /// # Errors
    /// [`ExtractError`] for rates that do not fit.
    pub fn new(
        set: FeatureSet,
        map: BodyMap,
        rate: f64,
        library_rate: f64,
    ) -> Result<WordStream, ExtractError> {
        check_rates(rate, library_rate)?;
        n_words(1, rate, library_rate).ok_or(ExtractError::TooManyFrames {
            n_frames: 1,
            rate,
            library_rate,
        })?;
        let windows = set.features().iter().map(|f| f.quantity.window_ms());
        let window = window_frames(windows.fold(0.0, f64::max), rate);
        Ok(WordStream {
            unavailable: set.unavailable(&map),
            states: vec![State::default(); set.features().len()],
            // The motion's last frames look back into what came before, as if in a mirror.
            reach: [window + 2, window - window.div_ceil(2) + 1],
            set,
            map,
            rate,
            library_rate,
            n_joints: None,
            held: Vec::new(),
            first: 0,
            n_decided: 0,
            n_words: 0,
            first_pose: None,
        })
    }

    /// Features whose body points the rig lacks. Their bits are 0 in every word.
    pub fn unavailable(&self) -> &[Unavailable] {
        &self.unavailable
    }

    /// Takes the next frames, shape `(frames, joints, 3)`, and gives the words that have become
    /// certain, in order.
    ///
    /// O((window + frames) · features): frames that have come together are best pushed together.
    ///
    /// # Errors
    /// [`ExtractError`] for a shape or a map that do not fit, and for another number of joints than
    /// before; the frames are not taken then.
    pub fn push(&mut self, positions: ArrayView3<'_, f32>) -> Result<Vec<u64>, ExtractError> {
        check_shape(positions, &self.map)?;
        let (n_frames, n_joints, n_axes) = positions.dim();
        if *self.n_joints.get_or_insert(n_joints) != n_joints {
            return Err(ExtractError::Shape(n_frames, n_joints, n_axes));
        }
        self.held.extend(positions.iter());
        let until = self.n_frames().saturating_sub(self.reach[1]);
        Ok(self.decide(until))
    }

    /// Gives the words of the last frames.
    #[must_use]
    pub fn finish(mut self) -> Vec<u64> {
        let until = self.n_frames();
        self.decide(until)
    }

    /// Frames that have come.
    fn n_frames(&self) -> usize {
        self.first + self.held.len() / self.frame_len().max(1)
    }

    fn frame_len(&self) -> usize {
        self.n_joints.unwrap_or(0) * 3
    }

    fn decide(&mut self, until: usize) -> Vec<u64> {
        if until <= self.n_decided {
            return Vec::new();
        }
        let shape = (self.n_frames() - self.first, self.frame_len() / 3, 3);
        let Ok(positions) = ArrayView3::from_shape(shape, &self.held) else {
            return Vec::new();
        };
        let paths = Paths::gather(positions, &self.map, self.rate);
        let paths = match &self.first_pose {
            Some(pose) => paths.of_motion(pose.clone()),
            None => {
                for (state, feature) in self.states.iter_mut().zip(self.set.features()) {
                    state.bounds = bounds(&self.set, &paths, feature);
                }
                self.first_pose = Some(paths.first_pose().clone());
                paths
            }
        };
        let next_first = until.saturating_sub(self.reach[0]).max(self.first);
        let fresh = self.n_decided - self.first..until - self.first;
        let mut native = vec![0u64; fresh.len()];
        for (feature_idx, feature) in self.set.features().iter().enumerate() {
            let state = &mut self.states[feature_idx];
            let lacks = |u: &Unavailable| u.feature_idx == feature_idx;
            if let Some(bounds) = state.bounds.filter(|_| !self.unavailable.iter().any(lacks)) {
                state.kept.rewind((next_first - self.first).checked_sub(1));
                let values = paths.measure(&feature.quantity, &mut state.kept);
                state.on = schmitt(&values[fresh.clone()], bounds, state.on, |t| {
                    native[t] |= 1 << feature_idx;
                });
            }
        }
        let mut words = Vec::new();
        loop {
            let frame = source_frame(self.n_words, self.rate, self.library_rate);
            if frame >= until {
                break;
            }
            words.push(native[frame - self.n_decided]);
            self.n_words += 1;
        }
        self.held
            .drain(..(next_first - self.first) * self.frame_len());
        (self.first, self.n_decided) = (next_first, until);
        words
    }
}
