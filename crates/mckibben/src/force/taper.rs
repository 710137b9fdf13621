//! Tapered ends: between its end fittings and its full width the muscle is a cone, where the gas has less room than a cylinder.
//!
//! ```text
//! ΔV      = (2π/3) c (r − r_e)² (2r + r_e − 3t)         both cones, each of length c (r − r_e)
//! −dΔV/dL = (c/(πn²)) L (r − r_e) (1 − t/r)
//! F       = P_g [3L² − b² − 4c L (r − r_e)]/(4πn²)      with V − ΔV, without a wall
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | r | half the diameter of the [`Braid`] | m |
//! | r_e | `end_radius` of the braid, where it is clamped | m |
//! | c | `length_ratio`: length of a cone over `r − r_e`, the cotangent of its half-angle | – |
//! | t | thickness of the [`Wall`], zero without one | m |
//!
//! Assumed: the middle has the radius of a braid that is a cylinder all along, the cones keep their angle, and a wall keeps its
//! thickness in them. The force is the gradient of `P_g (V − ΔV)`: virtual work holds, and without cones, `c = 0`, it is the
//! force of the ideal braid bit for bit. To first order in contraction from an unswollen end, `r_e` that of the braid
//! at `L_max`, the taper is an end factor `k = 1 + (2/3) c (r_e/L_max)/tan² θ₀` in Tondu & Lopez's law.
//!
//! Holds while the braid is wider than its fittings, `r ≥ r_e`, which must hold at the longest length; a muscle that is
//! pulled longer goes on by the same formulas until the radius of the bore is half that in the fittings, where the model ends.
//! The cones drawn out to their tips must fit into the shortest muscle. The gas's volume is then above zero everywhere.
//!
//! Source: derived from the volume above. That muscles taper to their fittings is in Tondu & Lopez (2000), and models with
//! cones as ends are cited (M. Doumit, A. Fahim & M. Munro, "Analytical modeling and experimental validation of the braided
//! pneumatic muscle", IEEE Transactions on Robotics 25(6) (2009)); none was at hand, and that any is this one is not claimed.
//! Checked by `tests/laws.rs`: cones by numerical integration, closed form, virtual work, closed cycle, the limit without
//! cones, the end factor, dual against finite difference, secant; `tests/measured_muscles.rs`: independent fits.

use super::Wall;
use crate::braid::Braid;
use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::parameter;
use crate::scalar::{Over, Scalar};
use core::f64::consts::PI;

/// Two cones at the ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taper<S = f64> {
    end_radius: S,
    length_ratio: S,
    /// Length in m at which the bore is half as wide as in the fittings.
    end_length: S,
}

impl Taper {
    /// Cones from `end_radius` (m, above zero) up to the radius of `braid`, `length_ratio` (zero or more) times as long as they
    /// widen, around a bore that a `wall` may narrow, for lengths from `min_length` to `max_length` (m).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a number is outside its range; [`Error::Inconsistent`] when the fittings are wider than the
    /// braid at the longest length, the wall fills them, or the cones do not fit into the shortest.
    pub fn new(
        end_radius: f64,
        length_ratio: f64,
        braid: &Braid,
        wall: Option<&Wall>,
        [min_length, max_length]: [f64; 2],
    ) -> Result<Self, Error> {
        parameter::TAPER_END_RADIUS.check(end_radius)?;
        parameter::TAPER_LENGTH_RATIO.check(length_ratio)?;
        let slimmest = 0.5 * braid.diameter(max_length);
        // The radius of a braid that is pulled straight is no number.
        if slimmest.is_nan() || end_radius > slimmest {
            return Err(Error::Inconsistent {
                parameter: &parameter::TAPER_END_RADIUS,
                value: end_radius,
                requirement: Requirement {
                    relation: "must be at most",
                    other: "the braid's radius at actuator.max_length",
                    value: slimmest,
                    unit: "m",
                },
                remedy: "give narrower fittings, a shorter max_length or fewer turns",
            });
        }
        let steepest = 0.5 * min_length / (0.5 * braid.diameter(min_length));
        if steepest.is_nan() || length_ratio >= steepest {
            return Err(Error::Inconsistent {
                parameter: &parameter::TAPER_LENGTH_RATIO,
                value: length_ratio,
                requirement: Requirement {
                    relation: "must be less than",
                    other: "actuator.min_length over the braid's diameter there",
                    value: steepest,
                    unit: "",
                },
                remedy: "give shorter cones, or a longer min_length",
            });
        }
        Self::assemble(end_radius, length_ratio, braid, None).beside(braid, wall)
    }

    /// The taper around a bore that a wall narrows.
    ///
    /// # Errors
    /// [`Error::Inconsistent`] when the wall fills the fittings.
    pub(super) fn beside(self, braid: &Braid, wall: Option<&Wall>) -> Result<Self, Error> {
        match wall {
            Some(wall) if wall.thickness() >= self.end_radius => Err(Error::Inconsistent {
                parameter: &parameter::TAPER_END_RADIUS,
                value: self.end_radius,
                requirement: Requirement {
                    relation: "must be greater than",
                    other: parameter::WALL_THICKNESS.key,
                    value: wall.thickness(),
                    unit: "m",
                },
                remedy: "give the radius of the braid where it is clamped, or a thinner wall",
            }),
            _ => Ok(Self::assemble(self.end_radius, self.length_ratio, braid, wall)),
        }
    }
}

impl<S: Scalar> Taper<S> {
    fn assemble(end_radius: S, length_ratio: S, braid: &Braid<S>, wall: Option<&Wall<S>>) -> Self {
        let thread = braid.thread_length();
        // Twice the radius there: half a bore and a wall on either side.
        let width = end_radius + thickness(wall);
        let squared = thread * thread - S::constant(0.25 * PI) * width * width / braid.per_turns();
        Self { end_radius, length_ratio, end_length: squared.sqrt() }
    }

    /// Converts the taper to another scalar type, in the braid and the wall that have been converted before.
    pub(crate) fn convert<T: Scalar>(
        &self,
        braid: &Braid<T>,
        wall: Option<&Wall<T>>,
        convert: &mut impl Convert<S, T>,
    ) -> Taper<T> {
        let end_radius = convert.parameter(&parameter::TAPER_END_RADIUS, self.end_radius);
        let length_ratio = convert.parameter(&parameter::TAPER_LENGTH_RATIO, self.length_ratio);
        match convert.carry() {
            Some(mut carry) => Taper { end_radius, length_ratio, end_length: carry(self.end_length) },
            None => Taper::assemble(end_radius, length_ratio, braid, wall),
        }
    }

    /// Radius `r_e` in m of the braid where it is clamped.
    pub fn end_radius(&self) -> S {
        self.end_radius
    }

    /// Length of a cone over the radius by which it widens.
    pub fn length_ratio(&self) -> S {
        self.length_ratio
    }

    /// Length in m at which the bore is half as wide as in the fittings, where the model ends.
    #[inline(always)]
    pub fn end_length(&self) -> S {
        self.end_length
    }

    /// By how much in m the braid is wider than its ends.
    #[inline(always)]
    fn swelling<T: Over<S>>(&self, braid: &Braid<S>, length: T) -> T {
        T::constant(0.5) * braid.diameter(length) - T::of(self.end_radius)
    }

    /// Volume in m³ that the gas has less than without cones, at a length in m.
    #[inline(always)]
    pub fn lost_volume<T: Over<S>>(&self, braid: &Braid<S>, wall: Option<&Wall<S>>, length: T) -> T {
        let (swelling, ends) = (self.swelling(braid, length), T::of(self.end_radius));
        let width = T::constant(2.0) * swelling + T::constant(3.0) * (ends - T::of(thickness(wall)));
        T::constant(2.0 * PI / 3.0) * T::of(self.length_ratio) * swelling * swelling * width
    }

    /// Its slope over length in m².
    #[inline(always)]
    pub fn lost_slope<T: Over<S>>(&self, braid: &Braid<S>, wall: Option<&Wall<S>>, length: T) -> T {
        let swelling = self.swelling(braid, length);
        -self.size::<T>(braid) * length * swelling * self.open(braid, wall, length)
    }

    /// The secant of that slope between two lengths in m.
    #[inline(always)]
    pub(super) fn slope_secant<T: Over<S>>(&self, braid: &Braid<S>, wall: Option<&Wall<S>>, length: T, from: T) -> T {
        let (end, start) = (braid.diameter(length), braid.diameter(from));
        // Of r: D² + L²/(nπ)² is the same at any length.
        let widening = -T::constant(2.0 / PI) * T::of(braid.per_turns()) * (length + from) / (end + start);
        let mut secant = (self.swelling(braid, length) + from * widening) * self.open(braid, wall, length);
        if let Some(wall) = wall {
            let opening = T::constant(4.0) * T::of(wall.thickness()) * widening / (end * start);
            secant = secant + from * self.swelling(braid, from) * opening;
        }
        -self.size::<T>(braid) * secant
    }

    /// `c/(πn²)`.
    #[inline(always)]
    fn size<T: Over<S>>(&self, braid: &Braid<S>) -> T {
        T::constant(4.0) * T::of(self.length_ratio) * T::of(braid.per_turns())
    }

    /// Radius of the bore over that of the braid.
    #[inline(always)]
    fn open<T: Over<S>>(&self, braid: &Braid<S>, wall: Option<&Wall<S>>, length: T) -> T {
        match wall {
            None => T::one(),
            Some(wall) => T::one() - T::constant(2.0) * T::of(wall.thickness()) / braid.diameter(length),
        }
    }
}

/// Thickness in m of a wall, if there is one.
#[inline(always)]
fn thickness<S: Scalar>(wall: Option<&Wall<S>>) -> S {
    match wall {
        None => S::zero(),
        Some(wall) => wall.thickness(),
    }
}
