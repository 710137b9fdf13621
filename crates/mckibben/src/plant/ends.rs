//! The ends of actuators on elastic tendons: how they start, what follows when one of their modes ends, and their balance.
//!
//! Nothing has a mass between an actuator and its tendon, so that its end sticks, slides and comes to a limit by the balance
//! of both tensions, whatever the mechanism does. The [tendon](super::tendon) says how fast it slides.

use super::evaluation::{Evaluation, System};
use super::formulas::Formulas;
use super::guard::PlantGuard;
use super::mode::PlantMode;
use super::tendon;
use crate::error::{Error, Requirement};
use crate::load::SeriesTendon;
use crate::parameter;
use crate::scalar::Real;
use crate::simulation::member::Member;
use crate::simulation::{EventKind, Guard, LengthRegime, Sliding};

/// Viscous force in widths of a border above which an end has jumped.
const JUMP: f64 = 1e3;
/// Part of its length by which an end without viscous friction may miss its balance.
const UNBALANCED: f64 = 1e-6;

impl<R: Real> System<R> {
    /// How an actuator slides whose length changes with the sign of `heading`; zero counts as longer.
    #[inline]
    pub(super) fn sliding_towards(&self, i: usize, heading: f64) -> Sliding {
        match self.wires[i].member.actuator.friction().has_direction() {
            false => Sliding::Frictionless,
            true if heading < 0.0 => Sliding::Shortening,
            true => Sliding::Lengthening,
        }
    }

    /// The mode of an actuator on a tendon at the start.
    pub(super) fn begin_end(&self, i: usize, time: R, state: &[R], mode: &mut PlantMode<R>, at: &mut Evaluation<R>) {
        let mounted = &self.plant.actuators[i];
        let (Some(tendon), member) = (&mounted.tendon, &self.wires[i].member) else { return };
        self.enter_distances(time, state, mode, at);
        let unit = at.units[i];
        let limits = member.actuator.limits();
        let its = &mut mode.actuators[i];
        its.loose = (unit.distance - unit.length - tendon.rest_length()).value() <= 0.0;
        let beyond = unit.length.value() > limits.max_length().value();
        its.mode.length_regime = if beyond { LengthRegime::Taut } else { LengthRegime::Free };
        its.mode.sliding = Sliding::Stuck;
        let friction = member.actuator.friction();
        let on_the_stop = unit.length.value() <= limits.min_length().value();
        its.on_stop = on_the_stop;
        let (least, most) = self.holdable(i, state, mode, unit.length);
        let pull = tendon::tension(tendon, mode.actuators[i].loose, unit.distance, unit.length).value();
        let heading = if pull - most.value() > member.force_band {
            1.0
        } else if pull - least.value() < -member.force_band {
            -1.0
        } else if friction.has_coulomb() || on_the_stop {
            return;
        } else {
            // It goes the way of the balance, however small.
            mode.actuators[i].mode.sliding = self.sliding_towards(i, 1.0);
            self.follow_all(time, state, mode, at, None);
            self.enter_distances(time, state, mode, at);
            self.velocity_of_end(i, time, state, mode, at).value()
        };
        let its = &mut mode.actuators[i];
        (its.mode.sliding, its.on_stop) = (self.sliding_towards(i, heading), false);
    }

    /// That the ends on tendons can start where they are: nothing has a mass there, so that without viscous friction their
    /// tensions balance from the start on, and friction that falls with velocity needs a viscous one that outweighs the fall.
    ///
    /// # Errors
    /// [`Error::Inconsistent`] otherwise.
    pub(crate) fn check_ends(
        &self,
        time: R,
        state: &[R],
        mode: &PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> Result<(), Error> {
        self.enter_distances(time, state, mode, at);
        for (i, mounted) in self.plant.actuators.iter().enumerate() {
            let Some(tendon) = &mounted.tendon else { continue };
            let (actuator, unit) = (&mounted.actuator, at.units[i]);
            let (friction, pressure) = (actuator.friction(), state[self.plant.places.actuators[i].pressure]);
            let kinetic: R = actuator.coulomb_bound(unit.length, pressure);
            let mut fall = friction.coulomb().steepest_fall(kinetic.value());
            if let Some(law) = friction.lugre() {
                fall += law.steepest_fall(actuator.secant_stiffness(unit.length, pressure).value());
            }
            if let (Some(time), true) = (friction.structural_damping(), friction.viscous().value() == 0.0) {
                return Err(Error::Inconsistent {
                    parameter: &parameter::STRUCTURAL_DAMPING,
                    value: time.value(),
                    requirement: Requirement {
                        relation: "on a tendon without viscous friction must be",
                        other: "absent, since it vanishes with the pressure:",
                        value: 0.0,
                        unit: "s",
                    },
                    remedy: "give actuator.friction.viscous, such as 1 N*s/m",
                });
            }
            if friction.viscous().value() < fall {
                return Err(Error::Inconsistent {
                    parameter: &parameter::VISCOUS,
                    value: friction.viscous().value(),
                    requirement: Requirement {
                        relation: "on a tendon must be at least",
                        other: "the steepest fall of dry friction with velocity, here at the start",
                        value: fall,
                        unit: "N*s/m",
                    },
                    remedy: "raise viscous or stribeck_velocity, or lower static_ratio or damping_time: an end without a mass \
                             would have no velocity of its own",
                });
            }
            if mode.is_damped(self, i) {
                continue;
            }
            let pull = tendon::tension(tendon, mode.actuators[i].loose, unit.distance, unit.length).value();
            let (least, most) = self.holdable(i, state, mode, unit.length);
            let missed = match mode.actuators[i].mode.sliding {
                Sliding::Stuck => (pull - most.value()).max(least.value() - pull),
                _ => self.missed(i, tendon, state, mode, at),
            };
            if missed > UNBALANCED * tendon.stiffness().value() * unit.length.value() {
                return Err(Error::Inconsistent {
                    parameter: &parameter::INITIAL_LENGTH,
                    value: unit.length.value(),
                    requirement: Requirement {
                        relation: "on a tendon without viscous friction must balance; the tendon's tension misses",
                        other: "what the actuator holds there",
                        value: missed,
                        unit: "N",
                    },
                    remedy: "leave the length out, or give actuator.friction.viscous",
                });
            }
        }
        Ok(())
    }

    /// Crosses a guard of an actuator on a tendon.
    pub(super) fn cross_end(
        &self,
        i: usize,
        guard: Guard,
        time: R,
        state: &mut [R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> Result<EventKind, Error> {
        let (limits, friction) = (self.wires[i].member.actuator.limits(), self.wires[i].member.actuator.friction());
        let place = self.plant.places.actuators[i].length.unwrap_or(0);
        let its = &mut mode.actuators[i];
        Ok(match guard {
            Guard::ThreadLength => return Err(Self::straight(time, state[place])),
            Guard::Slack => {
                state[place] = limits.min_length();
                its.mode.sliding = Sliding::Stuck;
                its.on_stop = true;
                EventKind::Stick
            }
            Guard::Rest => {
                self.check_no_jump(i, time, state, mode, at)?;
                let its = &mut mode.actuators[i];
                if friction.has_coulomb() {
                    its.mode.sliding = Sliding::Stuck;
                    if its.mode.length_regime == LengthRegime::Rebound {
                        its.mode.length_regime = LengthRegime::Taut;
                    }
                    EventKind::Stick
                } else {
                    its.mode.sliding = opposite(its.mode.sliding);
                    EventKind::Reversal
                }
            }
            Guard::BreakLonger | Guard::BreakShorter => {
                its.on_stop = false;
                its.mode.sliding = self.sliding_towards(i, if guard == Guard::BreakLonger { 1.0 } else { -1.0 });
                self.check_held(i, time, state, mode, at)?;
                self.check_no_jump(i, time, state, mode, at)?;
                EventKind::BreakAway
            }
            Guard::TendonLoose | Guard::TendonTight => {
                its.loose = guard == Guard::TendonLoose;
                if its.loose { EventKind::TendonLoose } else { EventKind::TendonTight }
            }
            Guard::Taut | Guard::TautEnd => {
                state[place] = limits.max_length();
                let taut = guard == Guard::Taut;
                its.mode.length_regime = if taut { LengthRegime::Taut } else { LengthRegime::Free };
                if taut { EventKind::Taut } else { EventKind::TautEnd }
            }
            Guard::Slip => EventKind::Slip,
            _ => return Member::<R>::cross(guard, &mut its.mode).ok_or_else(|| self.unknown_guard(time)),
        })
    }

    /// That an end, on the border of what dry friction holds, slides no faster than a border is wide. Where viscous friction
    /// outweighs the fall of dry friction it cannot jump: it then slides by what a fixed step has missed the border.
    fn check_no_jump(
        &self,
        i: usize,
        time: R,
        state: &[R],
        mode: &PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> Result<(), Error> {
        let (member, pressure) = (&self.wires[i].member, state[self.plant.places.actuators[i].pressure]);
        let coulomb = member.actuator.friction().coulomb();
        if !coulomb.falls() {
            return Ok(());
        }
        self.enter_distances(time, state, mode, at);
        let length = at.units[i].length;
        let damping = member.damping([length, pressure], &mode.actuators[i].mode);
        let kinetic: R = member.actuator.coulomb_bound(length, pressure);
        if coulomb.steepest_fall(kinetic.value()) <= damping {
            return Ok(());
        }
        let velocity = self.velocity_of_end(i, time, state, mode, at).value();
        if damping * velocity.abs() <= JUMP * member.force_band {
            return Ok(());
        }
        Err(Error::Stopped {
            time: time.value(),
            reason: "dry friction falls with velocity faster than viscous friction grows, and an end without a mass jumps",
            quantity: "velocity of the actuator's end",
            value: velocity,
            unit: "m/s",
            remedy: "raise actuator.friction.viscous or stribeck_velocity, or lower static_ratio",
        })
    }

    /// Brings ends without viscous friction to their balance, of which a start gives less than all digits.
    pub(crate) fn balance_ends(&self, time: R, state: &mut [R], mode: &PlantMode<R>, at: &mut Evaluation<R>) {
        /// Newton steps.
        const MOST: u32 = 3;
        for i in 0..self.wires.len() {
            for _ in 0..MOST {
                self.keep_balance(i, time, state, mode, at);
            }
        }
    }

    /// That no end without viscous friction jumps after an event.
    ///
    /// # Errors
    /// [`Error::Stopped`] otherwise.
    pub(crate) fn check_jumps(
        &self,
        time: R,
        state: &[R],
        mode: &PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> Result<(), Error> {
        self.sliding_ends(mode).try_for_each(|(i, _)| self.check_held(i, time, state, mode, at))
    }

    /// The actuators on tendons whose ends slide, with their tendons.
    fn sliding_ends(&self, mode: &PlantMode<R>) -> impl Iterator<Item = (usize, &SeriesTendon<R>)> {
        let ends = self.plant.actuators.iter().zip(&mode.actuators).enumerate();
        ends.filter(|(_, (_, its))| its.mode.sliding != Sliding::Stuck)
            .filter_map(|(i, (mounted, _))| Some((i, mounted.tendon.as_ref()?)))
    }

    /// That the stiffness of a sliding end without viscous friction keeps it on its balance. What it misses of that, as a fixed
    /// step begins, the balance makes good.
    fn check_held(
        &self,
        i: usize,
        time: R,
        state: &[R],
        mode: &PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> Result<(), Error> {
        if mode.is_damped(self, i) || self.guard(PlantGuard::Jump(i), time, state, mode, at).value() >= 0.0 {
            return Ok(());
        }
        Err(self.jumps(i, time, state, mode, at))
    }

    /// That every sliding end without viscous friction is on its balance after an event. One that has rebounded from the end
    /// of its braid with its tendon loose, or has left its stop where the braid would push, is not: it goes there at once.
    ///
    /// # Errors
    /// [`Error::Stopped`] otherwise.
    pub(super) fn check_balanced(
        &self,
        time: R,
        state: &[R],
        mode: &PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> Result<(), Error> {
        for (i, tendon) in self.sliding_ends(mode) {
            if mode.is_damped(self, i) {
                continue;
            }
            self.enter_ends_of(i, time, state, mode, at);
            let missed = self.missed(i, tendon, state, mode, at);
            let allowed = UNBALANCED * tendon.stiffness().value() * at.units[i].length.value();
            if missed > allowed + JUMP * self.wires[i].member.force_band {
                return Err(Error::Stopped {
                    time: time.value(),
                    reason: "the end of an actuator on a tendon jumps: nothing holds it any more, and without a mass and \
                             without viscous friction nothing slows it",
                    quantity: "force that is not balanced",
                    value: missed,
                    unit: "N",
                    remedy: "give actuator.friction.viscous, however small",
                });
            }
        }
        Ok(())
    }

    /// By how much in N the tensions of a sliding end differ, whose distance has been entered.
    fn missed(&self, i: usize, tendon: &SeriesTendon<R>, state: &[R], mode: &PlantMode<R>, at: &Evaluation<R>) -> f64 {
        let (unit, pressure) = (&at.units[i], state[self.plant.places.actuators[i].pressure]);
        let ends = [unit.distance, unit.length, pressure];
        self.excess(i, tendon, mode, ends, self.deflections(i, state)).value().abs()
    }

    /// The error of an end without viscous friction that jumps: its air, near the pressure of the atmosphere or below, holds its
    /// length no more, and nothing else does.
    pub(super) fn jumps(&self, i: usize, time: R, state: &[R], mode: &PlantMode<R>, at: &mut Evaluation<R>) -> Error {
        self.enter_distances(time, state, mode, at);
        Error::Stopped {
            time: time.value(),
            reason: "the end of an actuator on a tendon jumps: without a mass and without viscous friction the air alone \
                     holds it, and at the pressure of the atmosphere or below that does not",
            quantity: "velocity of the actuator's end",
            value: self.velocity_of_end(i, time, state, mode, at).value(),
            unit: "m/s",
            remedy: "give actuator.friction.viscous, however small, or keep the actuator's pressure above the atmosphere's",
        }
    }

    /// After an event that lets the rates of ends on tendons jump: rest or reversal where an end would slide against its
    /// direction, and break-away where no friction holds it.
    pub(crate) fn settle_ends(&self, time: R, state: &mut [R], mode: &mut PlantMode<R>, at: &mut Evaluation<R>) {
        for i in 0..self.wires.len() {
            if self.plant.actuators[i].tendon.is_none() {
                continue;
            }
            let friction = self.wires[i].member.actuator.friction();
            let fires = |guard, mode: &PlantMode<R>, at: &mut Evaluation<R>| {
                self.guard(PlantGuard::Of(i, guard), time, state, mode, at).value() < 0.0
            };
            let sliding = mode.actuators[i].mode.sliding;
            let next = match sliding {
                Sliding::Lengthening | Sliding::Shortening if fires(Guard::Rest, mode, at) => {
                    if friction.has_coulomb() { Sliding::Stuck } else { opposite(sliding) }
                }
                Sliding::Stuck if fires(Guard::BreakLonger, mode, at) => self.sliding_towards(i, 1.0),
                Sliding::Stuck if fires(Guard::BreakShorter, mode, at) => self.sliding_towards(i, -1.0),
                same => same,
            };
            if next != sliding {
                mode.actuators[i].mode.sliding = next;
                mode.actuators[i].on_stop = false;
                self.follow(i, time, state, mode, at, false);
            }
        }
    }
}

/// The other way.
pub(super) fn opposite(sliding: Sliding) -> Sliding {
    match sliding {
        Sliding::Lengthening => Sliding::Shortening,
        Sliding::Shortening => Sliding::Lengthening,
        same => same,
    }
}
