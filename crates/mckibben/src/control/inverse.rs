//! The static model inverted: the pressure that holds a force at a length.
//!
//! ```text
//! F = Eff(P_g) P_g A(L) + F_limit(L)          A = −dV/dL = (3L² − b²)/(4πn²)          (3)(9)(10)
//! P_g Eff(P_g) = (F − F_limit(L))/A(L)
//! ```
//!
//! With a constant effectiveness that is the answer. With another law of pressure the least pressure that gives it is
//! bracketed, walking upwards, and a Newton step polishes it and carries the derivatives, which are those of the implicit
//! function: `∂P/∂F = 1/(∂F/∂P)`, `∂P/∂L = −(∂F/∂L)/(∂F/∂P)`. A law of force other than the ideal braid's, or one with wall or
//! bladder, is inverted as a whole in the same way.
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | F | `force`, of a tendon: zero or more | N |
//! | L | `length`, above the shortest and below the thread's | m |
//! | A | `pull_area`, above zero where the braid pulls | m² |
//!
//! Without friction: at rest the tension lies within `± Q k_sec` of this. Source: Colbrunn, Nelson & Quinn (2001), (3), (9)
//! and (10), and its remark before (8) that (3) is solved for the pressure. Checked by `tests/inverse.rs`.

use crate::actuator::Actuator;
use crate::dual::Dual;
use crate::error::{Error, Requirement};
use crate::force::{Effectiveness, StaticForce, Statics};
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::root;
use crate::scalar::{Over, Real};

/// Highest gauge pressure in Pa that is looked at.
pub(super) const HIGHEST: f64 = 1e9;
/// Where the walk upwards begins, in Pa, and by how much each step is longer than the one before.
const FIRST: f64 = 1e3;
const GROWTH: f64 = 1.25;

impl<R: Real> Actuator<R> {
    /// The area `A = −dV/dL` in m² with which the gas pulls at a length in m.
    pub fn pull_area(&self, length: R) -> R {
        -self.law().law.volume_slope(length)
    }

    /// The least gauge pressure at which the actuator holds a tension of `force` N at rest at `length` m, without friction.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a negative force; [`Error::Inconsistent`] when no pressure gives it: the tendon is slack
    /// or the braid does not pull at that length, the taut braid alone pulls harder, or the effectiveness is too low.
    pub fn holding_pressure(&self, force: R, length: R) -> Result<GaugePressure<R>, Error> {
        parameter::SET_FORCE.check(force.value())?;
        self.check_pulling(length)?;
        let limit = self.limits().force(length, R::zero());
        let rest = force - limit;
        let refused = |relation, other, value: f64, remedy| {
            Err(Error::Inconsistent {
                parameter: &parameter::SET_FORCE,
                value: force.value(),
                requirement: Requirement { relation, other, value, unit: "N" },
                remedy,
            })
        };
        if rest.value() < 0.0 {
            let other = "the pull of the taut braid alone at this length";
            return refused("must not be less than", other, limit.value(), "give a shorter length or a larger force");
        }
        match self.giving(rest, length) {
            Ok(gauge) => Ok(gauge),
            Err(least) if least > rest.value() => {
                let other = "what the law of force gives at this length without pressure,";
                refused(
                    "must not be less than",
                    other,
                    least + limit.value(),
                    "give a shorter length or a larger force",
                )
            }
            Err(most) => {
                let other = "what any pressure gives at this length with the effectiveness,";
                let most = most + limit.value();
                refused("must not be more than", other, most, "give a longer length or a smaller force")
            }
        }
    }

    /// The least gauge pressure of zero or more at which the law gives `force` N at `length` m; otherwise the force that comes
    /// nearest.
    fn giving(&self, force: R, length: R) -> Result<GaugePressure<R>, f64> {
        if self.law().law.ideal().is_some() {
            let area = self.pull_area(length);
            return effective_pressure(&self.law().effectiveness, force / area).map_err(|most| most * area.value());
        }
        let at = |pressure: f64| self.law().force(length, GaugePressure(R::constant(pressure))).value() - force.value();
        let mut most = at(0.0);
        if most > 0.0 {
            return Err(most + force.value());
        }
        let (mut low, mut high) = (0.0, FIRST);
        while at(high) < 0.0 {
            most = most.max(at(high));
            (low, high) = (high, GROWTH * high);
            if high > HIGHEST {
                return Err(most + force.value());
            }
        }
        let root = root::bracketed(low, high, 1e-16 * high, at);
        let gauge: Dual<R, 1> = Dual::variable(R::constant(root), 0);
        let near = self.law().force(Dual::of(length), GaugePressure(gauge));
        let step = (near.value - force) / near.slope[0];
        let root = R::constant(root);
        Ok(GaugePressure(if step.value().abs() < 1e-9 * root.value() { root - step } else { root }))
    }

    /// The gauge pressure between zero and `highest` that holds a force; `highest` where no pressure below it gives the
    /// force.
    pub fn holding_pressure_within(&self, force: R, length: R, highest: GaugePressure<R>) -> GaugePressure<R> {
        let none = GaugePressure(R::zero());
        let rest = force - self.limits().force(length, R::zero());
        if rest.value() <= 0.0 {
            return none;
        }
        if self.check_pulling(length).is_err() {
            return highest;
        }
        match self.giving(rest, length) {
            Ok(gauge) => GaugePressure(gauge.0.smaller(highest.0)),
            Err(nearest) if nearest > rest.value() => none,
            Err(_) => highest,
        }
    }

    /// Mass of air in kg at a gauge pressure, a distance between the attachments in m and a temperature in K.
    pub fn air_mass(&self, gauge: GaugePressure<R>, distance: R, temperature: R) -> R {
        let air = self.air();
        air.mass(gauge.absolute(air.atmosphere()), self.volume(distance), temperature)
    }

    /// Checks that the tendon is tight, the braid pulls and its threads are not straight at a length in m.
    pub(super) fn check_pulling(&self, length: R) -> Result<(), Error> {
        let (limits, law) = (self.limits(), &self.law().law);
        let value = length.value();
        parameter::SET_LENGTH.check(value)?;
        let refused = |relation, other: &'static str, bound: R, remedy| {
            let requirement = Requirement { relation, other, value: bound.value(), unit: "m" };
            Err(Error::Inconsistent { parameter: &parameter::SET_LENGTH, value, requirement, remedy })
        };
        let longer = "give a longer length";
        if value <= limits.min_length().value() {
            return refused("must be greater than", parameter::MIN_LENGTH.key, limits.min_length(), longer);
        }
        if law.ideal().is_some() && self.pull_area(length).value() <= 0.0 {
            let other = "thread_length/sqrt(3), where the braid ceases to pull,";
            return refused("must be greater than", other, law.braid.neutral_length(), longer);
        }
        if value >= law.end_length().value() {
            let other = law.end_name();
            return refused("must be less than", other, law.end_length(), "give a shorter length");
        }
        Ok(())
    }
}

/// The part of the force that follows the pressure alone, `Eff(P) P` in Pa.
pub(super) fn effective<R: Real>(effectiveness: &Effectiveness<R>, gauge: R) -> R {
    effectiveness.at(GaugePressure(gauge)) * gauge
}

/// Its derivative with respect to the pressure.
fn effective_slope<R: Real>(effectiveness: &Effectiveness<R>, gauge: R) -> R {
    let gauge: Dual<R, 1> = Dual::variable(gauge, 0);
    (effectiveness.at(GaugePressure(gauge)) * gauge).slope[0]
}

/// Intervals of pressure in Pa, upwards, each ended where `Eff(P) P` has a peak in it, and whether it has.
fn upwards<R: Real>(effectiveness: &Effectiveness<R>) -> impl Iterator<Item = (f64, f64, bool)> {
    let falls = move |pressure: f64| -effective_slope(effectiveness, R::constant(pressure)).value();
    let mut low = 0.0;
    core::iter::from_fn(move || {
        let (start, end) = (low, if low > 0.0 { GROWTH * low } else { FIRST });
        low = end;
        let has_peak = falls(start) <= 0.0 && falls(end) > 0.0;
        let top = if has_peak { root::bracketed(start, end, 1e-16 * end, falls) } else { end };
        (end <= HIGHEST).then_some((start, top, has_peak))
    })
}

/// The highest gauge pressure up to which `Eff(P) P` rises.
pub(super) fn top<R: Real>(effectiveness: &Effectiveness<R>) -> R {
    if let Effectiveness::Constant(_) = effectiveness {
        return R::constant(HIGHEST);
    }
    let peak = upwards(effectiveness).find(|(.., has_peak)| *has_peak);
    R::constant(peak.map_or(HIGHEST, |(_, top, _)| top))
}

/// The least gauge pressure with `Eff(P) P` equal to `target` Pa, which is zero or more; otherwise the greatest `Eff(P) P`.
pub(super) fn effective_pressure<R: Real>(
    effectiveness: &Effectiveness<R>,
    target: R,
) -> Result<GaugePressure<R>, f64> {
    if target.value() <= 0.0 {
        return Ok(GaugePressure(target));
    }
    if let Effectiveness::Constant(ratio) = effectiveness {
        return if ratio.value() > 0.0 { Ok(GaugePressure(target / *ratio)) } else { Err(0.0) };
    }
    let surplus = |pressure: R| effective(effectiveness, pressure) - target;
    let at = |pressure: f64| surplus(R::constant(pressure)).value();
    let mut most = 0.0_f64;
    for (low, high, _) in upwards(effectiveness) {
        if at(high) < 0.0 {
            most = most.max(at(high) + target.value());
            continue;
        }
        let root = R::constant(root::bracketed(low, high, 1e-16 * high, at));
        let step = surplus(root) / effective_slope(effectiveness, root);
        return Ok(GaugePressure(if step.value().abs() < 1e-9 * root.value() { root - step } else { root }));
    }
    Err(most)
}
