//! The length, and the pressure, at which an actuator at rest bears a pull.
//!
//! ```text
//! F_s(L, P) + F_limit(L) = F          (9)(14), without friction
//! ```
//!
//! Both grow with the length in the paper's law, so that there is one such length at most between the shortest one and the end
//! of the law. A measured law may fall on a part of it. Then the longest length counts at which the sum grows: the one to which
//! a muscle comes when it is filled from full length.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), (9) and (14). Checked by `tests/plant_host_pulses.rs`, `tests/simulation.rs`,
//! `tests/plant_host.rs` and `tests/equilibrium.rs`.

use crate::actuator::Actuator;
use crate::dual::Dual;
use crate::error::Error;
use crate::force::Statics;
use crate::parameter;
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::root;
use crate::scalar::{Over, Real};
use crate::valve::below_vacuum;

/// Part of a length to which its last step of Newton's is believed.
const CLOSE: f64 = 1e-9;
/// Parts of the range of lengths, or of pressures, in which the one that bears a pull is looked for.
const BRACKETS: u32 = 64;
/// Golden sections about the highest force: to rounding.
const SECTIONS: u32 = 80;

impl<R: Real> Actuator<R> {
    /// The distance in m between the ends at which a pull in N balances the static force at a pressure; the shortest length
    /// where even that bears more.
    ///
    /// # Errors
    /// [`Error::NoSolution`] for a pull that the braid does not bear below the length at which its law ends, and for ends that
    /// are pushed together.
    pub fn length_under(&self, pull: R, pressure: AbsolutePressure<R>) -> Result<R, Error> {
        let limits = self.limits();
        let surplus = |length: R| self.static_force(length, pressure.0) + limits.force(length, R::zero()) - pull;
        let at = |length: f64| surplus(R::constant(length)).value();
        let (shortest, longest) = (limits.min_length().value(), limits.max_length().value());
        let thread = self.law().law.end_length().value();
        // From the longest length upwards where that bears less than the pull, downwards where it bears more.
        let is_beyond = at(longest) < 0.0;
        let end = if is_beyond { thread } else { shortest };
        let point = |part: u32| {
            let share = f64::from(part) / f64::from(BRACKETS);
            if part == BRACKETS { end } else { longest + (end - longest) * share }
        };
        let mut parts = 0..=BRACKETS;
        let found = if is_beyond {
            parts.find(|part| at(point(*part)) >= 0.0)
        } else {
            parts.find(|part| at(point(*part)) <= 0.0)
        };
        let Some(part) = found else {
            if is_beyond {
                return Err(Error::NoSolution {
                    what: "the load would pull the braid straight: there is no equilibrium below the thread length",
                    remedy: "lighten the load or stiffen actuator.limit.stiffness",
                });
            }
            return if pull.value() >= 0.0 {
                Ok(limits.min_length())
            } else {
                Err(Error::NoSolution {
                    what: "the load pushes the attachments together: there is no equilibrium",
                    remedy: "give initial.length a length",
                })
            };
        };
        let (one, other) = (point(part.saturating_sub(1)), point(part));
        let root = R::constant(root::bracketed(one.min(other), one.max(other), 1e-16, at));
        // One Newton step over the scalar: it polishes the value and carries the derivatives.
        let slope: Dual<R, 1> = {
            let length = Dual::variable(root, 0);
            self.static_force(length, Dual::of(pressure.0)) + limits.force(length, Dual::of(R::zero()))
        };
        let step = surplus(root) / slope.slope[0];
        Ok(if step.value().abs() < CLOSE * root.value() { root - step } else { root })
    }

    /// The longest distance in m between the ends at which the actuator, at rest at a gauge pressure and without friction,
    /// does not pull; its shortest length where it pulls even there.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] or [`Error::Inconsistent`] for a pressure that air cannot have; [`Error::NoSolution`] where the
    /// braid pushes up to the length at which its law ends.
    pub fn rest_length(&self, gauge: GaugePressure<R>) -> Result<R, Error> {
        parameter::INITIAL_GAUGE_PRESSURE.check(gauge.0.value())?;
        let pressure = gauge.absolute(self.air().atmosphere());
        if pressure.0.le(R::zero()) {
            let gauge = GaugePressure(gauge.0.value());
            return Err(below_vacuum(&parameter::INITIAL_GAUGE_PRESSURE, gauge, self.air()));
        }
        self.length_under(R::zero(), pressure)
    }
}

impl Actuator<f64> {
    /// The least gauge pressure up to `most` in Pa at which the actuator, at rest and without friction, bears a pull in N at a
    /// length in m between its shortest and its longest; `None` where none does. At a pull of zero it is zero: a slack braid
    /// needs no pressure.
    pub fn pressure_under(&self, length: f64, pull: f64, most: GaugePressure) -> Option<GaugePressure> {
        let limits = self.limits();
        let in_reach = limits.min_length() <= length && length <= limits.max_length();
        if !in_reach || !pull.is_finite() || pull < 0.0 {
            return None;
        }
        let atmosphere = self.air().atmosphere();
        let surplus = |gauge: f64| self.static_force(length, GaugePressure(gauge).absolute(atmosphere).0) - pull;
        if pull == 0.0 || surplus(0.0) >= 0.0 {
            return Some(GaugePressure(0.0));
        }
        // Effectiveness may fall with the pressure and threads may stretch, so that the force need not rise all the way, and may
        // just reach the pull. It turns at a low pressure rather than at a high one: there the brackets are narrow.
        let at = |part: u32| {
            let share = f64::from(part.min(BRACKETS)) / f64::from(BRACKETS);
            most.0 * share * share
        };
        let [mut behind, mut found] = [0, 1].map(|part| surplus(at(part)));
        for part in 1..=BRACKETS {
            let [before, here, after] = [at(part - 1), at(part), at(part + 1)];
            if found >= 0.0 {
                return Some(GaugePressure(root::bracketed(before, here, 1e-16, surplus)));
            }
            let ahead = surplus(after);
            if found >= behind.max(ahead) {
                let highest = root::lowest([before, after], SECTIONS, |gauge| -surplus(gauge));
                if surplus(highest) >= 0.0 {
                    return Some(GaugePressure(root::bracketed(before, highest, 1e-16, surplus)));
                }
            }
            (behind, found) = (found, ahead);
        }
        None
    }
}
