//! The static model of an antagonistic pair inverted: two pressures from torque and stiffness of the joint.
//!
//! ```text
//! τ = r₁ F₁ − r₂ F₂                F = Eff(P_g) P_g A(L)                                  (3)(9)
//! K = −dτ/dθ = r₁² k₁ − r₁′ F₁ + r₂² k₂ + r₂′ F₂    k = ∂F/∂L + (∂F/∂P_g)(dP/dL)         (5)
//! dP/dL = 0                        open: each valve keeps the pressure                    (6)
//! dP/dL = κ P A/V                  sealed: the valves are shut, the air masses are kept
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | τ, K | `torque`, `stiffness`, of the two actuators on the joint | N·m, N·m/rad |
//! | r, r′, L | `arm`, above zero; `arm_slope`, its slope over θ, zero for a pulley; `length` | m, m/rad, m |
//! | A, A′ | pull area `(3L² − b²)/(4πn²)`, its slope `6L/(4πn²)` | m², m |
//! | P, V, κ | absolute pressure, volume with the hose, index of the process | Pa, m³, – |
//!
//! The joint's torque and stiffness are set together by the two pressures, and with the valves shut by the two masses of air
//! ([`Actuator::air_mass`]). With a constant effectiveness both equations are linear in the two pressures. Otherwise the
//! agonist's pressure follows from the antagonist's along the line of the torque, up to where `Eff(P_g) P_g` ceases to rise,
//! the stiffness is bracketed on that line, and a Newton step of both equations polishes the pair and carries the
//! derivatives.
//!
//! The weight of a limb adds its own `M g d cos(θ − θ₀)` to K. Lengths lie between the limits: what a taut braid adds is not
//! for a valve to set.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), (3), (5) and (9), and its section 2.1 on the mass of air as what is controlled.
//! Checked by `tests/inverse.rs`.

use super::inverse::{effective, effective_pressure, top};
use crate::actuator::Actuator;
use crate::dual::Dual;
use crate::error::{Error, Requirement};
use crate::force::Effectiveness;
use crate::load::SIGN;
use crate::parameter::{self, Parameter};
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::root;
use crate::scalar::{Over, Real};

/// What is kept while the joint gives way, which decides its stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// The two pressures, (6).
    Pressures,
    /// The two masses of air: the valves are shut, (5) with its first term.
    AirMasses,
}

/// Two actuators that turn a joint against each other, at one angle.
#[derive(Clone, Copy, Debug)]
pub struct AntagonisticPair<'a, R = f64> {
    actuators: [&'a Actuator<R>; 2],
    length: [R; 2],
    arm: [R; 2],
    arm_slope: [R; 2],
    /// The highest gauge pressures up to which `Eff(P) P` rises.
    top: [R; 2],
}

/// Where the antagonist's pressure may lie on the line of a torque, and why not further.
enum Line<R> {
    /// From the one to the other.
    Between(R, R),
    /// The torque needs more than the highest pressure of one of them: that pair comes nearest.
    Beyond([R; 2]),
}

impl<'a, R: Real> AntagonisticPair<'a, R> {
    /// Agonist and antagonist with their lengths in m at an angle, on pulleys of constant radii `arm` in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a radius that is not above zero; [`Error::Inconsistent`] for a length at which an actuator
    /// is slack, does not pull, or is taut; [`Error::NotImplemented`] for a law of force other than the ideal braid's.
    pub fn new(actuators: [&'a Actuator<R>; 2], length: [R; 2], arm: [R; 2]) -> Result<Self, Error> {
        for i in 0..2 {
            parameter::PULLEY_ARM.check(arm[i].value())?;
            if actuators[i].law().law.ideal().is_none() {
                return Err(Error::NotImplemented(&crate::limit::CONTROLLER_PAIR));
            }
            actuators[i].check_pulling(length[i])?;
            let longest = actuators[i].limits().max_length().value();
            if length[i].value() > longest {
                return Err(Error::Inconsistent {
                    parameter: &parameter::SET_LENGTH,
                    value: length[i].value(),
                    requirement: Requirement {
                        relation: "must not be more than",
                        other: parameter::MAX_LENGTH.key,
                        value: longest,
                        unit: "m",
                    },
                    remedy: "give an angle at which neither braid is taut",
                });
            }
        }
        let top = actuators.map(|actuator| top(&actuator.law().effectiveness));
        Ok(Self { actuators, length, arm, arm_slope: [R::zero(); 2], top })
    }

    /// Gives the moment arms a slope over the angle, in m/rad.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a slope that is not finite; [`Error::NoSolution`] where the arms change so fast that more
    /// pressure in both makes the joint softer: no stiffness has its pressures then.
    pub fn with_arm_slopes(self, arm_slope: [R; 2]) -> Result<Self, Error> {
        for slope in arm_slope {
            parameter::ARM_SLOPE.check(slope.value())?;
        }
        let pair = Self { arm_slope, ..self };
        // What each newton metre adds to the stiffness, at kept pressures.
        let of = |i: usize| pair.slope_per_pascal(i) / pair.lever(i);
        if (of(0) + of(1)).value() > 0.0 {
            return Ok(pair);
        }
        Err(Error::NoSolution {
            what: "the moment arms change so fast with the angle that more pressure in both actuators makes the joint softer",
            remedy: "choose another range of angles, or control the angle alone",
        })
    }

    /// `r² A′ ∓ r′ A`: the stiffness in N·m/rad of a pascal of `Eff(P) P` at kept pressures.
    fn slope_per_pascal(&self, i: usize) -> R {
        let (actuator, length, arm) = (self.actuators[i], self.length[i], self.arm[i]);
        let slope = R::constant(6.0) * length * actuator.law().law.braid.per_turns();
        arm * arm * slope + R::constant(SIGN[i]) * self.arm_slope[i] * actuator.pull_area(length)
    }

    fn absolute(&self, i: usize, gauge: GaugePressure<R>) -> AbsolutePressure<R> {
        gauge.absolute(self.actuators[i].air().atmosphere())
    }

    /// Torque τ in N·m at two gauge pressures, at rest without friction.
    pub fn torque(&self, gauge: [GaugePressure<R>; 2]) -> R {
        let of = |i: usize| self.arm[i] * self.actuators[i].static_force(self.length[i], self.absolute(i, gauge[i]).0);
        of(0) - of(1)
    }

    /// Stiffness K in N·m/rad at two gauge pressures.
    pub fn stiffness(&self, gauge: [GaugePressure<R>; 2], held: Held) -> R {
        let of = |i: usize| {
            let (actuator, pressure) = (self.actuators[i], self.absolute(i, gauge[i]));
            let stiffness = match held {
                Held::Pressures => actuator.stiffness(self.length[i], pressure),
                Held::AirMasses => actuator.sealed_stiffness(self.length[i], pressure),
            };
            let force = actuator.static_force(self.length[i], pressure.0);
            self.arm[i] * self.arm[i] * stiffness + R::constant(SIGN[i]) * self.arm_slope[i] * force
        };
        of(0) + of(1)
    }

    /// The gauge pressures at which the pair gives a torque in N·m and a stiffness in N·m/rad, both zero or more.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for numbers outside their range; [`Error::Inconsistent`] when no two pressures of zero or more
    /// give both.
    pub fn pressures(&self, torque: R, stiffness: R, held: Held) -> Result<[GaugePressure<R>; 2], Error> {
        parameter::SET_TORQUE.check(torque.value())?;
        parameter::SET_STIFFNESS.check(stiffness.value())?;
        let refused = |parameter: &'static Parameter, value: R, relation, other, bound: R, remedy| {
            let requirement = Requirement { relation, other, value: bound.value(), unit: parameter.unit };
            Err(Error::Inconsistent { parameter, value: value.value(), requirement, remedy })
        };
        let (low, high) = match self.line(torque, self.top) {
            Line::Between(low, high) => (low, high),
            Line::Beyond(most) => {
                let (bound, other) = (self.torque(most.map(GaugePressure)), "what the pair gives at any pressure,");
                let remedy = "give a smaller torque or longer arms";
                return refused(&parameter::SET_TORQUE, torque, "must not go beyond", other, bound, remedy);
            }
        };
        let at = |antagonist: R| self.stiffness(self.on_line(torque, antagonist).map(GaugePressure), held);
        let (least, most) = (at(low), at(high));
        // At an end of the line the stiffness is what it is but for rounding.
        let slack = R::constant(1e-12) * (least.magnitude() + stiffness);
        if stiffness.value() < (least - slack).value() {
            let other = "what this torque alone gives, with one of the actuators without pressure,";
            let remedy = "give a larger stiffness or a smaller torque";
            return refused(&parameter::SET_STIFFNESS, stiffness, "must not be less than", other, least, remedy);
        }
        if stiffness.value() > most.value() {
            let other = "what the pair gives at any pressure,";
            let remedy = "give a smaller stiffness or longer arms";
            return refused(&parameter::SET_STIFFNESS, stiffness, "must not be more than", other, most, remedy);
        }
        Ok(self.solve(torque, stiffness, held, [low, high]))
    }

    /// Gauge pressures between zero and `highest` that come as near as they can: to the torque first, to the stiffness
    /// as far as the torque leaves it free.
    pub fn pressures_within(
        &self,
        torque: R,
        stiffness: R,
        held: Held,
        highest: GaugePressure<R>,
    ) -> [GaugePressure<R>; 2] {
        let (low, high) = match self.line(torque, self.top.map(|top| top.smaller(highest.0))) {
            Line::Between(low, high) => (low, high),
            Line::Beyond(most) => return most.map(GaugePressure),
        };
        let at = |antagonist: R| self.on_line(torque, antagonist).map(GaugePressure);
        if stiffness.value() <= self.stiffness(at(low), held).value() {
            return at(low);
        }
        if stiffness.value() >= self.stiffness(at(high), held).value() {
            return at(high);
        }
        self.solve(torque, stiffness, held, [low, high])
    }

    /// `r A`, the torque in N·m of a pascal of `Eff(P) P`.
    fn lever(&self, i: usize) -> R {
        self.arm[i] * self.actuators[i].pull_area(self.length[i])
    }

    fn effectiveness(&self, i: usize) -> &Effectiveness<R> {
        &self.actuators[i].law().effectiveness
    }

    /// The torque in N·m of an actuator at a gauge pressure in Pa.
    fn torque_of(&self, i: usize, gauge: R) -> R {
        self.lever(i) * effective(self.effectiveness(i), gauge)
    }

    /// The least gauge pressure of an actuator that gives a torque in N·m, at most `highest`.
    fn giving(&self, i: usize, torque: R, highest: R) -> R {
        let found = effective_pressure(self.effectiveness(i), torque / self.lever(i));
        found.map_or(highest, |gauge| gauge.0.smaller(highest))
    }

    /// Agonist's and antagonist's pressure on the line of a torque.
    fn on_line(&self, torque: R, antagonist: R) -> [R; 2] {
        let needed = (torque + self.torque_of(1, antagonist)).larger(R::zero());
        [self.giving(0, needed, self.top[0]), antagonist]
    }

    /// Where the antagonist's pressure may lie for a torque, with both pressures between none and the highest.
    fn line(&self, torque: R, highest: [R; 2]) -> Line<R> {
        let most = [0, 1].map(|i| self.torque_of(i, highest[i]));
        if torque.value() > most[0].value() {
            return Line::Beyond([highest[0], R::zero()]);
        }
        if -torque.value() > most[1].value() {
            return Line::Beyond([R::zero(), highest[1]]);
        }
        let low = self.giving(1, (-torque).larger(R::zero()), highest[1]);
        Line::Between(low, self.giving(1, most[0] - torque, highest[1]))
    }

    /// The pair on the line of a torque with a stiffness that is bracketed by the antagonist's pressures.
    fn solve(&self, torque: R, stiffness: R, held: Held, [low, high]: [R; 2]) -> [GaugePressure<R>; 2] {
        if let [Effectiveness::Constant(first), Effectiveness::Constant(second)] =
            [self.effectiveness(0), self.effectiveness(1)]
        {
            let [(a, s, t), (b, u, w)] = [self.linear(0, *first, held), self.linear(1, *second, held)];
            let rest = stiffness - t - w;
            let determinant = a * u + b * s;
            let gauge = [(torque * u + b * rest) / determinant, (a * rest - torque * s) / determinant];
            return gauge.map(|gauge| GaugePressure(gauge.larger(R::zero())));
        }
        let surplus = |antagonist: f64| {
            let gauge = self.on_line(torque, R::constant(antagonist)).map(GaugePressure);
            (self.stiffness(gauge, held) - stiffness).value()
        };
        let root = root::bracketed(low.value(), high.value(), 1e-16 * high.value(), surplus);
        let near = self.on_line(R::constant(torque.value()), R::constant(root)).map(|p| R::constant(p.value()));
        self.polish(near, torque, stiffness, held)
    }

    /// Torque per pascal, and stiffness per pascal and at no gauge pressure, of an actuator of constant effectiveness.
    fn linear(&self, i: usize, ratio: R, held: Held) -> (R, R, R) {
        let (actuator, length, arm) = (self.actuators[i], self.length[i], self.arm[i]);
        let area = actuator.pull_area(length);
        let spring = match held {
            Held::Pressures => R::zero(),
            Held::AirMasses => area * area * actuator.air().index() / actuator.volume(length),
        };
        let square = arm * arm * ratio;
        (
            arm * ratio * area,
            ratio * self.slope_per_pascal(i) + square * spring,
            square * spring * actuator.air().atmosphere().0,
        )
    }

    /// One Newton step of both equations from a pair that is near.
    fn polish(&self, near: [R; 2], torque: R, stiffness: R, held: Held) -> [GaugePressure<R>; 2] {
        let wide = self.actuators.map(|actuator| actuator.map(|_, number| Dual::<R, 2>::of(number)));
        let pair = AntagonisticPair {
            actuators: wide.each_ref(),
            length: self.length.map(Dual::of),
            arm: self.arm.map(Dual::of),
            arm_slope: self.arm_slope.map(Dual::of),
            top: self.top.map(Dual::of),
        };
        let gauge = [0, 1].map(|i| GaugePressure(Dual::variable(near[i], i)));
        let (of_torque, of_stiffness) = (pair.torque(gauge), pair.stiffness(gauge, held));
        let (e, f) = (torque - of_torque.value, stiffness - of_stiffness.value);
        let ([a, b], [c, d]) = (of_torque.slope, of_stiffness.slope);
        let determinant = a * d - b * c;
        let step = [(e * d - b * f) / determinant, (a * f - e * c) / determinant];
        let scale = near[0].value() + near[1].value();
        let close = step.iter().all(|step| step.value().abs() <= 1e-6 * scale);
        [0, 1].map(|i| GaugePressure(if close { (near[i] + step[i]).larger(R::zero()) } else { near[i] }))
    }
}
