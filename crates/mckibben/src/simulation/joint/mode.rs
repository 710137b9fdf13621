//! The discrete state of a joint: which formulas hold.

use crate::simulation::mode::{EventKind, Guard, Mode, Sliding};

/// How the joint turns, which decides the Coulomb friction of both actuators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turning {
    /// Towards greater angles: the agonist shortens.
    Forward,
    /// Towards smaller angles: the antagonist shortens.
    Backward,
    /// The friction of both actuators together holds the joint at rest.
    Stuck,
    /// There is no friction to decide that depends on the direction.
    Frictionless,
}

impl Turning {
    /// The sign of the angular velocity: −1, 0 or +1.
    pub fn direction(self) -> f64 {
        match self {
            Self::Forward => 1.0,
            Self::Backward => -1.0,
            Self::Stuck | Self::Frictionless => 0.0,
        }
    }

    /// How the ends of an actuator slide whose length has a slope of this sign over the angle.
    pub(super) fn sliding(self, has_direction: bool, slope: f64) -> Sliding {
        match self {
            Self::Stuck => Sliding::Stuck,
            Self::Frictionless => Sliding::Frictionless,
            _ if !has_direction => Sliding::Frictionless,
            _ if self.direction() * slope < 0.0 => Sliding::Shortening,
            _ => Sliding::Lengthening,
        }
    }
}

/// One end of the joint's range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The stop at the smallest angle.
    Lower,
    /// The stop at the greatest angle.
    Upper,
}

impl End {
    pub(super) const BOTH: [Self; 2] = [Self::Lower, Self::Upper];

    pub(super) fn index(self) -> usize {
        usize::from(self == Self::Upper)
    }
}

/// What the limb touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// Nothing: the angle is within its range.
    None,
    /// A stop, which it presses.
    Pressed(End),
    /// A stop, from which it comes back so fast that the stop does not press.
    Rebound(End),
}

/// Which formulas hold, as an event log shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointMode {
    /// The modes of agonist and antagonist.
    pub actuators: [Mode; 2],
    /// The direction of turning, or sticking.
    pub turning: Turning,
    /// What the limb touches.
    pub contact: Contact,
    /// The pieces of the tables of both moment arms; 0 for a pulley.
    pub arm_pieces: [usize; 2],
}

/// What happened at an event of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JointEventKind {
    /// The actuator to which it happened, 0 the agonist and 1 the antagonist, or `None` for the joint itself.
    pub actuator: Option<usize>,
    /// What happened.
    pub kind: EventKind,
}

/// Why a mode of a joint ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointGuard {
    /// A guard of an actuator, 0 or 1.
    Of(usize, Guard),
    /// The angle comes to the first row of a piece of a moment arm's table, 0 or 1.
    ArmDown(usize),
    /// The angle comes to the last row of a piece.
    ArmUp(usize),
    /// The angle reaches a stop.
    Reach(End),
    /// A pressed stop ceases to press.
    Rebound(End),
    /// A stop presses again.
    Press(End),
    /// The angle comes back into its range.
    Leave(End),
    /// The angular velocity comes to zero.
    Rest,
    /// The torque exceeds what friction can hold and turns the joint forward.
    BreakForward,
    /// The torque exceeds what friction can hold and turns the joint backward.
    BreakBackward,
}
