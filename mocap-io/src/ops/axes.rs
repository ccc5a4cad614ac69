use ndarray::Array2;

use crate::{Axis, AxisFrame, Channel, Joint, Motion, Skeleton, UpAxis, UpSource};

impl Motion {
    /// The same motion written in axes with another way up: positions, which are always Y up, stay.
    ///
    /// Every offset, axis frame and channel is renamed to the new axes, with its sign. So no number
    /// changes but in sign, the rest pose stands upright as before, and the way back is exact; `Zrotation`
    /// becomes `Yrotation` where Z was up and Y is to be.
    ///
    /// O(frames · channels).
    #[must_use]
    pub fn to_up(&self, up: UpAxis) -> Motion {
        let turn = Turn::between(self.up, up);
        let joints = self.skeleton.joints().iter().map(|j| turn.joint(j));
        let skeleton = Skeleton::new(joints.collect(), self.skeleton.offset_frame())
            .expect("the tree stays, and signs keep numbers finite");
        let kinds = self.skeleton.joints().iter().flat_map(|j| &j.channels);
        let signs: Vec<f64> = kinds.map(|&kind| turn.channel(kind).1).collect();
        let mut channels = Array2::zeros((self.n_frames(), signs.len()));
        for (values, mut row) in self.rows().zip(channels.rows_mut()) {
            for ((to, value), sign) in row.iter_mut().zip(values.iter()).zip(&signs) {
                *to = value * sign;
            }
        }
        Motion {
            skeleton,
            channels,
            up,
            up_source: UpSource::Given,
            ..self.without_frames()
        }
    }
}

/// Where each axis of a file goes in another one: axis and sign.
struct Turn([(Axis, f64); 3]);

impl Turn {
    fn between(from: UpAxis, to: UpAxis) -> Turn {
        let mut turn = [(Axis::X, 1.0); 3];
        for ((axis, sign), (to_axis, to_sign)) in from.axes().into_iter().zip(to.axes()) {
            turn[axis.idx()] = (to_axis, sign * to_sign);
        }
        Turn(turn)
    }

    /// A quarter turn makes of a rotation about an axis the one about where the axis goes.
    fn channel(&self, channel: Channel) -> (Channel, f64) {
        let to = |axis: Axis| self.0[axis.idx()];
        match channel {
            Channel::Translation(axis) => (Channel::Translation(to(axis).0), to(axis).1),
            Channel::Rotation(axis) => (Channel::Rotation(to(axis).0), to(axis).1),
            Channel::Length => (Channel::Length, 1.0),
        }
    }

    fn joint(&self, joint: &Joint) -> Joint {
        let mut turned = joint.clone();
        for (from, &(axis, sign)) in joint.offset.iter().zip(&self.0) {
            turned.offset[axis.idx()] = from * sign;
        }
        for channel in &mut turned.channels {
            *channel = self.channel(*channel).0;
        }
        turned.axis = joint.axis.map(|frame| {
            let to = frame.order.map(|axis| self.0[axis.idx()]);
            AxisFrame {
                degrees: [0, 1, 2].map(|i| frame.degrees[i] * to[i].1),
                order: to.map(|(axis, _)| axis),
            }
        });
        turned
    }
}
