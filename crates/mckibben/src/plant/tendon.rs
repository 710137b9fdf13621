//! An elastic tendon in series: where the actuator's end goes.
//!
//! ```text
//! T = k max(0, x − ℓ − L)          F(L, L̇, P) = T
//!
//! with viscous friction      L̇ by F(L, L̇, P) = T
//! without                    L̇ by ∂F/∂L L̇ + ∂F/∂P Ṗ(L̇) = k (ẋ − L̇), and L kept to F(L, P) = T
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x | distance that actuator and tendon span together | m |
//! | L, P | length and absolute pressure of the actuator: states | m, Pa |
//! | k, ℓ | `stiffness` and `rest_length` of the [tendon](crate::load::SeriesTendon) | N/m, m |
//! | F | tension of the actuator (12) | N |
//!
//! Nothing has a mass between actuator and tendon, so that the actuator's length is a state whose rate follows from the
//! balance of both tensions. Without viscous friction the balance holds the length itself: its rate is that by which the
//! balance stays, and every state that is kept is brought back to it by a Newton step, with the air sealed or at the pressure that
//! is given. Bristles of LuGre's law count with their rate.
//!
//! Source: balance of forces at an end without mass. Checked by `tests/plant_reference.rs` against an independent program and by
//! `tests/plant_linear.rs`.

use super::evaluation::{System, Unit};
use super::mode::ActuatorMode;
use crate::actuator::Actuator;
use crate::air::Chamber;
use crate::load::SeriesTendon;
use crate::scalar::{Differentiable, Over, Real};
use crate::simulation::{Extent, Sliding};

/// A velocity in m/s at which no force falls any more.
const FAST: f64 = 1e6;
/// Newton steps in search of a velocity, and the part of it to which it is found.
const MOST_SEARCHED: u32 = 100;
const SEARCHED: f64 = 1e-9;

/// Tension in N of a tendon between a distance and an actuator length (m); in a mode that has it tight also below zero.
#[inline(always)]
pub(crate) fn tension<R: Real, T: Over<R>>(
    tendon: &SeriesTendon<R>,
    of_actuator: &ActuatorMode<R>,
    distance: T,
    length: T,
) -> T {
    if of_actuator.loose {
        return T::zero();
    }
    T::of(tendon.stiffness()) * (distance - length - T::of(tendon.rest_length()))
}

/// Whether the velocity of an end follows from the balance at once.
pub(crate) fn is_damped<R: Real>(actuator: &Actuator<R>, of_actuator: &ActuatorMode<R>) -> bool {
    let taut = of_actuator.mode.extent == Extent::Taut && actuator.limits().damping().value() > 0.0;
    taut || actuator.friction().viscous().value() > 0.0
}

impl<R: Real> System<R> {
    /// The rate L̇ in m/s of the length of an actuator on a tendon.
    pub(crate) fn end_velocity<T: Differentiable<R>>(
        &self,
        i: usize,
        tendon: &SeriesTendon<R>,
        of_actuator: &ActuatorMode<R>,
        at: (&Unit<T>, &Chamber<T>),
        bristles: Option<T>,
    ) -> T {
        match of_actuator.mode.sliding {
            Sliding::Stuck => T::zero(),
            _ if is_damped(&self.plant.actuators[i].actuator, of_actuator) => {
                self.damped_velocity(i, tendon, of_actuator, at, bristles)
            }
            _ => self.kept_velocity(i, tendon, of_actuator, at, bristles),
        }
    }

    /// The actuator's force in N as its end slides at a velocity, over one derivative more.
    fn pull<T: Over<R>>(&self, i: usize, ends: [T; 3], bristles: Option<T>, of_actuator: &ActuatorMode<R>) -> T {
        self.wires[i].member.signed_force(ends, &of_actuator.mode, (&of_actuator.trace, bristles))
    }

    /// The actuator's force less the tendon's in N, as the end begins to slide.
    pub(crate) fn excess<T: Over<R>>(
        &self,
        i: usize,
        tendon: &SeriesTendon<R>,
        of_actuator: &ActuatorMode<R>,
        [distance, length, pressure]: [T; 3],
        bristles: Option<T>,
    ) -> T {
        self.pull(i, [length, T::zero(), pressure], bristles, of_actuator)
            - tension(tendon, of_actuator, distance, length)
    }

    /// `dP/dt` in Pa/s while the length changes at a velocity in m/s; where it is given over time, that whatever the length does.
    pub(crate) fn air_rate<T: Over<R>>(&self, i: usize, (unit, chamber): (&Unit<T>, &Chamber<T>), velocity: T) -> T {
        if self.wires[i].is_given {
            return unit.pressure_rate;
        }
        let actuator = &self.plant.actuators[i].actuator;
        let moving = actuator.chamber(unit.length, velocity, chamber.pressure, chamber.mass, false);
        actuator.air().pressure_rate_by(&moving, &unit.flow, || unit.warmth)
    }

    /// The rate at which both tensions are equal.
    fn damped_velocity<T: Differentiable<R>>(
        &self,
        i: usize,
        tendon: &SeriesTendon<R>,
        of_actuator: &ActuatorMode<R>,
        (unit, chamber): (&Unit<T>, &Chamber<T>),
        bristles: Option<T>,
    ) -> T {
        let tension = tension(tendon, of_actuator, unit.distance, unit.length);
        let [length, pressure] = [unit.length, chamber.pressure].map(|number| number.along(T::zero()));
        let bent = bristles.map(|bent| bent.along(T::zero()));
        let at = |velocity: T| {
            let ends = [length, velocity.along(T::one()), pressure];
            let [force, slope] =
                T::split(self.wires[i].member.signed_force(ends, &of_actuator.mode, (&of_actuator.trace, bent)));
            [force - tension, slope]
        };
        let from_zero = || {
            let [value, slope] = at(T::zero());
            -value / slope
        };
        let friction = self.plant.actuators[i].actuator.friction();
        if !friction.coulomb().falls() && friction.lugre().is_none_or(|law| !law.falls()) {
            return from_zero();
        }
        // Above its solution the force rises to a straight line; zero lies below, as the end slides.
        let direction = of_actuator.mode.sliding.direction();
        let fast = T::constant(direction * FAST);
        let [value, slope] = at(fast);
        let mut most = fast - value / slope;
        let sign = T::constant(direction);
        if (sign * most).le(T::zero()) || T::zero().le(sign * at(T::zero())[0]) {
            return from_zero();
        }
        let (mut least, mut velocity) = (T::zero(), most);
        let mut left = None;
        for _ in 0..MOST_SEARCHED {
            let [value, slope] = at(velocity);
            let below = (sign * value).lt(T::zero());
            least = T::select(below, velocity, least);
            most = T::select(below, most, velocity);
            let next = velocity - value / slope;
            let within = (sign * least).le(sign * next) & (sign * next).le(sign * most);
            let next = T::select(within, next, T::constant(0.5) * (least + most));
            let found = (next - velocity).magnitude().le(T::constant(SEARCHED) * next.magnitude());
            velocity = next;
            // Each step more carries one derivative more.
            left = match left {
                None if found => Some(2),
                Some(0) => break,
                Some(steps) => Some(steps - 1),
                None => None,
            };
        }
        velocity
    }

    /// The rate in N/s at which the actuator's force outgrows the tendon's, as the end slides at a velocity.
    fn growth<T: Differentiable<R>>(
        &self,
        i: usize,
        tendon: &SeriesTendon<R>,
        of_actuator: &ActuatorMode<R>,
        at: (&Unit<T>, &Chamber<T>),
        bristles: Option<T>,
        velocity: T,
    ) -> T {
        let (unit, chamber) = at;
        let direction = T::constant(of_actuator.mode.sliding.direction());
        let stiffness = if of_actuator.loose { T::zero() } else { T::of(tendon.stiffness()) };
        let length = unit.length.along(velocity);
        let pressure = chamber.pressure.along(self.air_rate(i, at, velocity));
        let lugre = self.wires[i].member.lugre().zip(bristles);
        let bent = lugre.map(|(law, bent)| bent.along(law.rate(bent, velocity, direction)));
        let ends = [length, T::zero().along(T::zero()), pressure];
        let force = self.wires[i].member.signed_force(ends, &of_actuator.mode, (&of_actuator.trace, bent));
        T::split(force)[1] - stiffness * (unit.rate - velocity)
    }

    /// By how much in N/s the stiffness of an end without viscous friction, that of its sealed air and of its tendon, keeps it
    /// below a velocity in m/s; below zero where it jumps: it goes faster, or nothing brings it back to its balance.
    pub(crate) fn hold_of_end<T: Differentiable<R>>(
        &self,
        i: usize,
        tendon: &SeriesTendon<R>,
        of_actuator: &ActuatorMode<R>,
        at: (&Unit<T>, &Chamber<T>),
        bristles: Option<T>,
        fastest: f64,
    ) -> T {
        let growth = |velocity: T| self.growth(i, tendon, of_actuator, at, bristles, velocity);
        let at_rest = growth(T::zero());
        (growth(T::one()) - at_rest) * T::constant(fastest) - at_rest.magnitude()
    }

    /// The rate at which both tensions stay equal.
    fn kept_velocity<T: Differentiable<R>>(
        &self,
        i: usize,
        tendon: &SeriesTendon<R>,
        of_actuator: &ActuatorMode<R>,
        at: (&Unit<T>, &Chamber<T>),
        bristles: Option<T>,
    ) -> T {
        let grows = |velocity: T| self.growth(i, tendon, of_actuator, at, bristles, velocity);
        let at_rest = grows(T::zero());
        let slope = grows(T::one()) - at_rest;
        let mut velocity = -at_rest / slope;
        let lugre = self.wires[i].member.lugre().zip(bristles);
        if lugre.is_some_and(|(law, _)| law.falls()) {
            for _ in 0..MOST_SEARCHED {
                let step = grows(velocity) / slope;
                velocity = velocity - step;
                if step.magnitude().le(T::constant(SEARCHED * SEARCHED)) {
                    break;
                }
            }
        }
        velocity
    }
}
