use std::fmt;

/// A side of the body. Left is +X when the figure faces +Z.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Side {
    Left,
    Right,
}

impl Side {
    pub(crate) const BOTH: [Side; 2] = [Side::Left, Side::Right];

    pub(crate) fn idx(self) -> usize {
        self as usize
    }

    /// +1 for left, −1 for right: the sign of X on this side.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

/// What a labelled span of the corpus shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Class {
    /// Four steps forward, the right foot first.
    Walk,
    /// Four steps backward, the right foot first.
    WalkBackwards,
    /// Five running steps with a flight phase, the right foot first.
    Jog,
    /// One deep knee bend with the arms stretched forward.
    Squat,
    /// Two jumps into a straddle with the arms overhead, and back.
    JumpingJack,
    /// A front kick of the left leg.
    KickLeft,
    /// A front kick of the right leg.
    KickRight,
    /// A straight punch of the left hand, from a guard.
    PunchLeft,
    /// A straight punch of the right hand, from a guard.
    PunchRight,
    /// Three waves of the raised right hand.
    Wave,
    /// Two circles of both straight arms, forward at the top.
    RotateArmsForward,
    /// Two circles of both straight arms, backward at the top.
    RotateArmsBackward,
    /// A jump forward off both feet.
    Hop,
    /// Sitting down on a seat of knee height.
    SitDown,
    /// From standing, over a crouch and a seat on the floor, onto the back.
    LieDown,
}

impl Class {
    /// All classes, in the order in which the corpus lists them.
    pub const ALL: [Class; 15] = [
        Class::Walk,
        Class::WalkBackwards,
        Class::Jog,
        Class::Squat,
        Class::JumpingJack,
        Class::KickLeft,
        Class::KickRight,
        Class::PunchLeft,
        Class::PunchRight,
        Class::Wave,
        Class::RotateArmsForward,
        Class::RotateArmsBackward,
        Class::Hop,
        Class::SitDown,
        Class::LieDown,
    ];

    /// The name used in clip names and labels, in snake case.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Class::Walk => "walk",
            Class::WalkBackwards => "walk_backwards",
            Class::Jog => "jog",
            Class::Squat => "squat",
            Class::JumpingJack => "jumping_jack",
            Class::KickLeft => "kick_left",
            Class::KickRight => "kick_right",
            Class::PunchLeft => "punch_left",
            Class::PunchRight => "punch_right",
            Class::Wave => "wave",
            Class::RotateArmsForward => "rotate_arms_forward",
            Class::RotateArmsBackward => "rotate_arms_backward",
            Class::Hop => "hop",
            Class::SitDown => "sit_down",
            Class::LieDown => "lie_down",
        }
    }

    /// The class with this [name](Class::name).
    #[must_use]
    pub fn from_name(name: &str) -> Option<Class> {
        Class::ALL.into_iter().find(|class| class.name() == name)
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
