//! Bolen's law: one normalized surface for all muscles of a diameter.
//!
//! ```text
//! F = F_max [s₀ (e^(−s₁ x) − 1) + p e^(−s₂ x²)]        x = ε/ε_max,  p = P_g/P_max,  ε = (L₀ − L)/L₀
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | F_max | `max_force`, at the longest length and `P_max` | N |
//! | P_max | `max_pressure` | Pa |
//! | ε_max | `max_contraction`, without load at `P_max` | – |
//! | s₀, s₁, s₂ | `shape` | – |
//! | L₀ | `initial_length` | m |
//!
//! A muscle is described by its largest force and contraction; the shape is that of its diameter:
//! `[0.5822, 4.142, 0.5368]` for fluidic muscles of 10 mm, `[0.2607, 6.398, 1.303]` of 20 mm, `[0.1224, 10.47, 2.023]` of 40 mm, each
//! with `P_max = 620 kPa`. At the longest length the force is in proportion to pressure; at any other it is linear in
//! pressure. The law says nothing of the muscle's volume: a cycle in pressure and length gains or loses energy against
//! the air, and the energy audit says how much.
//!
//! Holds for `0 ≤ x ≤ 1` and up to `P_max`.
//!
//! Source: the muscle model of the robot legs of the Agile and Adaptive Robotics group (B. Bolen, A. Hunt), as it stands in
//! their public code, Bipedal_Robot, `f_festo.m`, with the numbers above. A publication of it was not seen. It follows
//! A. J. Hunt, A. Graber-Tilton & R. D. Quinn, "Modeling length effects of braided pneumatic actuators", ASME IDETC 2017,
//! V05AT08A008, whose relation gives the pressure for a force and has a pole at finite forces, so it is not taken here.
//! Checked by `tests/laws.rs`: transcription, its two ends, dual against finite difference, secant;
//! `tests/measured_muscles.rs`: an independent fit to published measurements.

use super::{StaticForce, relative_exponential};
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::{Over, Scalar};

/// Bolen's law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bolen<S = f64> {
    initial_length: S,
    max_force: S,
    max_pressure: S,
    max_contraction: S,
    shape: [S; 3],
}

impl Bolen {
    /// The law of a muscle of `initial_length` (m, above zero) that holds `max_force` (N, above zero) at that length and
    /// `max_pressure` (Pa gauge, above zero), where it contracts by `max_contraction` (between 0 and 1) without load; with the
    /// `shape` `s₀`, `s₁`, `s₂` (zero or more each).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a number is outside its range.
    pub fn new(
        initial_length: f64,
        max_force: f64,
        max_pressure: f64,
        max_contraction: f64,
        shape: [f64; 3],
    ) -> Result<Self, Error> {
        for coefficient in shape {
            parameter::BOLEN_SHAPE.check(coefficient)?;
        }
        Ok(Self {
            initial_length: parameter::MAX_LENGTH.check(initial_length)?,
            max_force: parameter::MAX_FORCE.check(max_force)?,
            max_pressure: parameter::MAX_PRESSURE.check(max_pressure)?,
            max_contraction: parameter::MAX_CONTRACTION.check(max_contraction)?,
            shape,
        })
    }
}

impl<S: Scalar> Bolen<S> {
    /// Converts the law to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Bolen<T> {
        Bolen {
            initial_length: convert.parameter(&parameter::MAX_LENGTH, self.initial_length),
            max_force: convert.parameter(&parameter::MAX_FORCE, self.max_force),
            max_pressure: convert.parameter(&parameter::MAX_PRESSURE, self.max_pressure),
            max_contraction: convert.parameter(&parameter::MAX_CONTRACTION, self.max_contraction),
            shape: self.shape.map(|s| convert.parameter(&parameter::BOLEN_SHAPE, s)),
        }
    }

    /// Contraction over the largest contraction.
    #[inline(always)]
    fn relative_contraction<T: Over<S>>(&self, length: T) -> T {
        let initial = T::of(self.initial_length);
        (initial - length) / (initial * T::of(self.max_contraction))
    }
}

impl<S: Scalar> StaticForce<S> for Bolen<S> {
    #[inline(always)]
    fn force<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        let [s0, s1, s2] = self.shape.map(T::of);
        let (x, p) = (self.relative_contraction(length), gauge.0 / T::of(self.max_pressure));
        T::of(self.max_force) * (s0 * (-s1 * x).exp_m1() + p * (-s2 * x * x).exp())
    }

    #[inline(always)]
    fn secant_stiffness<T: Over<S>>(&self, length: T, from: T, gauge: GaugePressure<T>) -> T {
        let [s0, s1, s2] = self.shape.map(T::of);
        let (x, start) = (self.relative_contraction(length), self.relative_contraction(from));
        let p = gauge.0 / T::of(self.max_pressure);
        let of_rubber = s0 * s1 * (-s1 * start).exp() * relative_exponential(s1 * (start - x));
        let at_start = s2 * start * start;
        let of_gas = p * s2 * (x + start) * (-at_start).exp() * relative_exponential(at_start - s2 * x * x);
        T::of(self.max_force) * (of_rubber + of_gas) / (T::of(self.initial_length) * T::of(self.max_contraction))
    }
}
