use super::interpolate::{frame_by_frame, row};
use super::root::{Facing, Roots};
use crate::Motion;

impl Motion {
    /// Which way the figure faces: the yaw of the root's +Z axis in radians, in −π..=π. 0 faces +Z, a
    /// quarter turn +X; axes are those of positions, Y up (spec.md i.2). Of several roots the first counts.
    ///
    /// `None` if there is no such frame or root, if the axis is vertical, or an angle is missing.
    #[must_use]
    pub fn heading(&self, frame: usize) -> Option<f64> {
        if frame >= self.n_frames() {
            return None;
        }
        Roots::new(self).yaw(row(&self.dense(), frame))
    }

    /// The motion turned by `yaw` radians about the Y axis and then moved by `[x, z]` metres: a rigid motion
    /// on the floor of all roots together, in the axes of positions (Y up). Heights and shapes stay.
    ///
    /// Only channels of roots change, and by no turn at all their rotations keep every bit. Roots get the
    /// channels they need ([`Motion::with_free_roots`]). O(frames · channels).
    #[must_use]
    pub fn moved(&self, yaw: f64, [x, z]: [f64; 2]) -> Motion {
        self.shifted(Facing { yaw, at: [x, z] })
    }

    /// The whole motion moved on the floor so that in `frame` the root stands over the origin and faces +Z
    /// (spec.md i.2). Of several roots the first decides, and all move together.
    ///
    /// `None` where that frame has no [`Motion::heading`], or the root's place is missing.
    /// O(frames · channels).
    #[must_use]
    pub fn in_facing_frame(&self, frame: usize) -> Option<Motion> {
        Some(self.shifted(self.facing(frame)?.inverse()))
    }

    pub(super) fn facing(&self, frame: usize) -> Option<Facing> {
        let yaw = self.heading(frame)?;
        Roots::new(self).facing(row(&self.dense(), frame), yaw)
    }

    pub(super) fn shifted(&self, by: Facing) -> Motion {
        let free = self.with_free_roots();
        let roots = Roots::new(&free);
        let source = free.dense();
        let (n_frames, n_channels) = source.dim();
        let frames = (0..n_frames).map(|frame| row(&source, frame));
        let channels = frame_by_frame(n_frames, n_channels, frames, |old, near, new| {
            new.copy_from_slice(old);
            roots.shift(by, near.unwrap_or(old), new);
        });
        Motion {
            channels,
            ..free.without_frames()
        }
    }
}
