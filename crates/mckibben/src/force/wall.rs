//! A bladder of constant wall thickness inside the braid: the gas fills less than the braid encloses.
//!
//! ```text
//! V      = π L (D − 2t)²/4
//! −dV/dL = (3L² − b²)/(4πn²) + π [t (2D − D₀²/D) − t²]         D₀ = b/(nπ)
//! ```
//!
//! With `D = D₀ sin θ` the second line times `P_g` is Chou & Hannaford's law of a thick wall,
//! `F = π D₀² P_g/4 (3 cos² θ − 1) + π P_g [D₀ t (2 sin θ − 1/sin θ) − t²]`.
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | t | `thickness` | m |
//! | D, D₀ | of the [`Braid`], the latter at θ = 90° | m |
//!
//! The wall keeps its thickness. (Rubber keeps its volume instead; the braid's volume and the gas's
//! then differ by a constant and the force is the one without a wall.) The force is the gradient of `P_g V` with the gas's
//! own volume: virtual work holds.
//!
//! Valid while the bore is open, `D > 2t`, which is below `L = √(b² − (2nπt)²)`. There, as where a braid without a wall
//! is pulled straight, the model ends.
//! Source: C.-P. Chou & B. Hannaford, "Measurement and modeling of McKibben pneumatic artificial muscles", IEEE
//! Transactions on Robotics and Automation 12(1), 90–102 (1996). The article was not at hand: the force here is derived from
//! the volume above, and that it is theirs is assumed.
//! Checked by `tests/laws.rs`: transcription over the braid angle, virtual work, the thin wall, dual against finite
//! difference, secant.

use crate::braid::Braid;
use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::parameter;
use crate::scalar::{Over, Scalar};
use core::f64::consts::PI;

/// A wall of constant thickness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall<S = f64> {
    thickness: S,
    /// Length in m at which the bore is closed.
    closed: S,
}

impl Wall {
    /// A wall of `thickness` (m, zero or more) in `braid`, whose bore is open up to `max_length` (m).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when the thickness is negative or not finite; [`Error::Inconsistent`] when the wall fills the
    /// braid at the longest length.
    pub fn new(thickness: f64, braid: &Braid, max_length: f64) -> Result<Self, Error> {
        parameter::WALL_THICKNESS.check(thickness)?;
        let radius = 0.5 * braid.diameter(max_length);
        // The radius of a braid that is pulled straight is no number.
        if radius.is_nan() || thickness >= radius {
            return Err(Error::Inconsistent {
                parameter: &parameter::WALL_THICKNESS,
                value: thickness,
                requirement: Requirement {
                    relation: "must be less than",
                    other: "the braid's radius at actuator.max_length",
                    value: radius,
                    unit: "m",
                },
                remedy: "give a thinner wall, a shorter max_length or fewer turns",
            });
        }
        Ok(Self::assemble(thickness, braid))
    }
}

impl<S: Scalar> Wall<S> {
    fn assemble(thickness: S, braid: &Braid<S>) -> Self {
        let thread = braid.thread_length();
        let squared = thread * thread - S::constant(PI) * thickness * thickness / braid.per_turns();
        Self { thickness, closed: squared.sqrt() }
    }

    /// Converts the wall to another scalar type, in the braid that has been converted before.
    pub(crate) fn convert<T: Scalar>(&self, braid: &Braid<T>, convert: &mut impl Convert<S, T>) -> Wall<T> {
        let thickness = convert.parameter(&parameter::WALL_THICKNESS, self.thickness);
        match convert.carry() {
            Some(mut carry) => Wall { thickness, closed: carry(self.closed) },
            None => Wall::assemble(thickness, braid),
        }
    }

    /// Length in m at which the bore is closed.
    #[inline(always)]
    pub fn closed_length(&self) -> S {
        self.closed
    }

    /// Thickness `t` in m.
    pub fn thickness(&self) -> S {
        self.thickness
    }

    /// Volume of the gas in m³.
    #[inline(always)]
    pub fn volume<T: Over<S>>(&self, braid: &Braid<S>, length: T) -> T {
        let bore = braid.diameter(length) - T::constant(2.0) * T::of(self.thickness);
        T::constant(0.25 * PI) * length * bore * bore
    }

    /// Its slope over length in m².
    #[inline(always)]
    pub fn volume_slope<T: Over<S>>(&self, braid: &Braid<S>, length: T) -> T {
        let (diameter, thickness) = (braid.diameter(length), T::of(self.thickness));
        let widening = T::constant(2.0) * diameter - self.squared_widest::<T>(braid) / diameter;
        braid.volume_slope(length) - T::constant(PI) * thickness * (widening - thickness)
    }

    /// The secant of that slope between two lengths in m.
    #[inline(always)]
    pub(super) fn slope_secant<T: Over<S>>(&self, braid: &Braid<S>, length: T, from: T) -> T {
        let (end, start) = (braid.diameter(length), braid.diameter(from));
        let sum = length + from;
        // D² + L²/(nπ)² is the same at any length.
        let per_length = -T::constant(4.0 / PI) * T::of(braid.per_turns()) * sum / (end + start);
        let widening = per_length * (T::constant(2.0) + self.squared_widest::<T>(braid) / (end * start));
        -T::constant(3.0) * sum * T::of(braid.per_turns()) - T::constant(PI) * T::of(self.thickness) * widening
    }

    /// `D₀²` in m².
    #[inline(always)]
    fn squared_widest<T: Over<S>>(&self, braid: &Braid<S>) -> T {
        let thread = T::of(braid.thread_length());
        T::constant(4.0 / PI) * T::of(braid.per_turns()) * thread * thread
    }
}
