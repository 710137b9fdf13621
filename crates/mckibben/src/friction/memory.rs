//! What friction remembers: the hysteresis laws behind one face, and the state that they share.
//!
//! The memory is a value that belongs to the caller, as pressure and air mass do. It says what the elements of the law were
//! at an actuator length, and every law can say what they are when the length has moved on from there in one direction:
//! a step of any length is stable, and one that goes in one direction is exact. LuGre's law needs the velocity too, and
//! its error falls with the square of the step.

use super::bouc_wen::BoucWen;
use super::lugre::LuGre;
use super::maxwell_slip::MaxwellSlip;
use crate::convert::Convert;
use crate::force::relative_exponential;
use crate::scalar::Mask;
use crate::scalar::{Over, Real, Scalar, Work};

/// The largest number of elements of a hysteresis law.
pub const MAX_ELEMENTS: usize = 12;

/// A law of hysteresis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hysteresis<S = f64> {
    /// Elastic elements that slip.
    MaxwellSlip(MaxwellSlip<S>),
    /// A loop with rounded corners.
    BoucWen(BoucWen<S>),
    /// Bristles whose friction falls with velocity.
    LuGre(LuGre<S>),
}

/// The state of a law of hysteresis; it belongs to the caller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Memory<S = f64> {
    /// The actuator length in m at which the elements are as they are.
    pub at: S,
    /// The elements in the law's own unit: deflections in m, and behind the one of LuGre's law how far its friction has
    /// fallen with velocity, from 0 at rest to 1; those that the law does not have are zero.
    pub elements: [S; MAX_ELEMENTS],
}

impl<S: Scalar> Memory<S> {
    /// A relaxed one at an actuator length in m.
    pub fn relaxed(length: S) -> Self {
        Self { at: length, elements: [S::zero(); MAX_ELEMENTS] }
    }
}

/// The smooth law that a hysteresis follows while the length goes in one direction, up to where the next element slips or
/// the deflection goes through zero: `width + slope (1 − e^{−decay x})/decay` at x from its beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch<S = f64> {
    /// Where it begins, as an actuator length in m.
    pub from: S,
    /// The force over the secant stiffness in m at its beginning.
    pub width: S,
    /// How the width grows with the length at its beginning.
    pub slope: S,
    /// Rate in 1/m at which that slope falls with the length; zero for a straight line.
    pub decay: S,
    /// The part of the width that slips, in magnitude: what dissipates.
    pub slipping: S,
    /// What dissipates in addition, over the square of the width, in 1/m.
    pub wear: S,
    /// The actuator length in m at which it ends, if it does.
    pub end: Option<S>,
}

impl<S: Scalar> Branch<S> {
    /// A force of zero.
    #[doc(hidden)]
    pub fn nothing() -> Self {
        let zero = S::zero();
        Self { from: zero, width: zero, slope: zero, decay: zero, slipping: zero, wear: zero, end: None }
    }

    /// The width in m at an actuator length in m, each lane by its own branch.
    #[doc(hidden)]
    #[inline(always)]
    pub fn width_in_lanes<T: Over<S>>(&self, length: T) -> T {
        let way = length - T::of(self.from);
        let mut straight = T::of(self.slope) * way;
        let bent = S::zero().lt(self.decay.magnitude());
        if bent.any() {
            straight = T::select(bent, straight * T::apart(Slackened(-T::of(self.decay) * way)), straight);
        }
        T::of(self.width) + straight
    }
}

impl<R: Real> Branch<R> {
    /// The width in m at an actuator length in m.
    #[inline(always)]
    pub fn width<T: Over<R>>(&self, length: T) -> T {
        let way = length - T::of(self.from);
        let straight = T::of(self.slope) * way;
        // Most laws have straight lines, and an exponential costs more than all else here.
        let bent = self.decay.value() != 0.0;
        T::of(self.width) + if bent { straight * T::apart(Slackened(-T::of(self.decay) * way)) } else { straight }
    }

    /// The part of the width in m that dissipates, in magnitude, at an actuator length in m.
    #[inline(always)]
    pub fn dissipating(&self, length: R) -> R {
        let width = self.width(length);
        self.slipping + self.wear * width * width
    }
}

/// How much less than a straight line a branch rises.
struct Slackened<T>(T);

impl<T: Scalar> Work for Slackened<T> {
    type Output = T;
    #[inline(always)]
    fn done(self) -> T {
        relative_exponential(self.0)
    }
}

impl<R: Real> Hysteresis<R> {
    /// The branch from where the memory is, in a `direction` of the length (−1 or +1; 0 when it does not move).
    pub fn branch(&self, memory: &Memory<R>, direction: f64) -> Branch<R> {
        match self {
            Self::MaxwellSlip(law) => law.branch(memory, direction),
            Self::BoucWen(law) => law.branch(memory, direction),
            Self::LuGre(law) => law.branch(memory, direction),
        }
    }

    /// Takes the memory to the end of its branch: what slips from there on has reached its bound, what came back is at zero.
    pub fn slip(&self, memory: &mut Memory<R>, direction: f64, length: R) {
        match self {
            Self::MaxwellSlip(law) => law.slip(memory, direction, length),
            Self::BoucWen(law) => law.slip(memory, length),
            // Its branches do not end.
            Self::LuGre(_) => memory.at = length,
        }
    }
}

impl<S: Scalar> Hysteresis<S> {
    pub(super) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Hysteresis<T> {
        match self {
            Self::MaxwellSlip(law) => Hysteresis::MaxwellSlip(law.convert(convert)),
            Self::BoucWen(law) => Hysteresis::BoucWen(law.convert(convert)),
            Self::LuGre(law) => Hysteresis::LuGre(law.convert(convert)),
        }
    }

    /// How many elements of the memory the law has.
    pub fn count(&self) -> usize {
        match self {
            Self::MaxwellSlip(law) => law.count(),
            Self::BoucWen(_) => 1,
            Self::LuGre(_) => 2,
        }
    }

    /// The force over the secant stiffness in m, at an actuator length in m that has been reached from the memory's in one
    /// direction, and a velocity in m/s, which only LuGre's law needs; positive when it adds to the tension.
    #[inline(always)]
    pub fn width<T: Over<S>>(&self, memory: &Memory<S>, length: T, velocity: T) -> T {
        match self {
            Self::MaxwellSlip(law) => law.width(memory, length),
            Self::BoucWen(law) => T::apart(Rounded { law, memory, length }),
            Self::LuGre(law) => T::apart(Bent { law, memory, length, velocity }),
        }
    }

    /// Takes the memory on to an actuator length in m in one direction, and a velocity in m/s, which only LuGre's law
    /// needs.
    #[inline(always)]
    pub fn moved(&self, memory: &mut Memory<S>, length: S, velocity: S) {
        match self {
            Self::MaxwellSlip(law) => law.moved(memory, length),
            Self::BoucWen(law) => S::apart(MoveRounded { law, memory, length }),
            Self::LuGre(law) => S::apart(MoveBent { law, memory, length, velocity }),
        }
    }
}

/// The width by the law of Bouc and Wen.
struct Rounded<'a, S, T> {
    law: &'a BoucWen<S>,
    memory: &'a Memory<S>,
    length: T,
}

impl<S: Scalar, T: Over<S>> Work for Rounded<'_, S, T> {
    type Output = T;
    #[inline(always)]
    fn done(self) -> T {
        self.law.width(self.memory, self.length)
    }
}

/// The memory taken on by that law.
struct MoveRounded<'a, S> {
    law: &'a BoucWen<S>,
    memory: &'a mut Memory<S>,
    length: S,
}

impl<S: Scalar> Work for MoveRounded<'_, S> {
    type Output = ();
    #[inline(always)]
    fn done(self) {
        self.law.moved(self.memory, self.length);
    }
}

/// The width by LuGre's law.
struct Bent<'a, S, T> {
    law: &'a LuGre<S>,
    memory: &'a Memory<S>,
    length: T,
    velocity: T,
}

impl<S: Scalar, T: Over<S>> Work for Bent<'_, S, T> {
    type Output = T;
    #[inline(always)]
    fn done(self) -> T {
        self.law.width(self.memory, self.length, self.velocity)
    }
}

/// The memory taken on by that law.
struct MoveBent<'a, S> {
    law: &'a LuGre<S>,
    memory: &'a mut Memory<S>,
    length: S,
    velocity: S,
}

impl<S: Scalar> Work for MoveBent<'_, S> {
    type Output = ();
    #[inline(always)]
    fn done(self) {
        self.law.moved(self.memory, self.length, self.velocity);
    }
}
