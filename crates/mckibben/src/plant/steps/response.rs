//! Tensions with their derivatives, where the ends of actuators are or would be.
//!
//! ```text
//! F(L, v, P)      tension in N, of the state of the air and of the friction that the steps have reached
//! ∂F/∂L           N/m, at constant pressure; on a tendon its stiffness, since the length of the actuator is a state
//! ∂F/∂v           N·s/m
//! ∂F/∂P           m²
//! ```
//!
//! Source: Colbrunn, Nelson & Quinn (2001), (1), (11), (12). Checked by `tests/plant_host.rs` and `tests/plant_saved.rs`.

use super::host::{NO_ACTUATOR, host_mechanisms};
use super::{PlantRow, PlantSteps};
use crate::actuator::Response;
use crate::dual::Dual;
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::parameter;
use crate::scalar::Over;
use crate::simulation::Sliding;

impl<R: Instantiate> PlantSteps<R> {
    /// The tension of an actuator, its derivatives over the distance, its rate and the pressure, and the rates of its air,
    /// while its ends move as they do now. On a tendon the length of the actuator is a state, and the derivative over the
    /// distance is the tendon's stiffness.
    ///
    /// # Errors
    /// [`Error::Misuse`] when there is no such actuator.
    pub fn compute(&mut self, actuator: usize) -> Result<Response<R>, Error> {
        R::compute_plant_steps(self, actuator)
    }

    pub(crate) fn generic_compute(&mut self, actuator: usize) -> Result<Response<R>, Error> {
        let mechanism = self.plant().actuators().get(actuator).ok_or(NO_ACTUATOR)?.mechanism;
        self.evaluate(core::iter::once(mechanism));
        Ok(self.response(actuator))
    }

    /// The responses of all actuators, as [`PlantSteps::compute`] has them, with the ends of all external mechanisms at
    /// `distances` in m and moving at `rates` in m/s in place of where they are: one of each for each coordinate, in the order
    /// of the mechanisms. The pressure of the air is that of the state that has been reached, which stays. Hysteresis without a
    /// rate is what it is after a straight move from there; bristles and the length on a tendon, which follow in time, stay.
    ///
    /// # Errors
    /// [`Error::Table`] unless there is one distance and one rate for each coordinate, and one response for each actuator;
    /// [`Error::OutOfRange`] for a number that is not finite, and for a distance that is not above zero.
    pub fn compute_at(&mut self, distances: &[R], rates: &[R], responses: &mut [Response<R>]) -> Result<(), Error> {
        R::compute_plant_steps_at(self, distances, rates, responses)
    }

    pub(crate) fn generic_compute_at(
        &mut self,
        distances: &[R],
        rates: &[R],
        responses: &mut [Response<R>],
    ) -> Result<(), Error> {
        self.check_count("distances", distances.len())?;
        self.check_count("rates", rates.len())?;
        distances.iter().try_for_each(|its| parameter::INITIAL_LENGTH.check(its.value()).map(drop))?;
        rates.iter().try_for_each(|its| parameter::INITIAL_VELOCITY.check(its.value()).map(drop))?;
        let count = self.plant().actuators().len();
        if responses.len() != count {
            return Err(Error::Table {
                name: "responses",
                problem: "there is not one for each actuator",
                entry: responses.len().min(count) + 1,
                remedy: "give as many as the plant has actuators",
            });
        }
        if self.are_at(distances, rates) {
            self.evaluate(0..self.plant().mechanisms().len());
            for (actuator, response) in responses.iter_mut().enumerate() {
                *response = self.response(actuator);
            }
            return Ok(());
        }
        let Self { row, work, .. } = self;
        let PlantRow { system, reached, .. } = &mut **row;
        let (time, state, mode) = reached.parts();
        work.begin(*time, state);
        work.rates_jump(mode);
        let mut first = 0;
        for (m, here) in host_mechanisms(&system.plant) {
            let theirs = first..first + here.coordinates;
            first += here.coordinates;
            system.carry_memories(m, *time, state, mode, &mut work.at);
            state[here.position(0)..here.position(0) + here.coordinates].copy_from_slice(&distances[theirs.clone()]);
            state[here.rate(0)..here.rate(0) + here.coordinates].copy_from_slice(&rates[theirs]);
            system.carry_memories(m, *time, state, mode, &mut work.at);
            system.enter_jumped_ends(m, *time, state, mode, &mut work.at);
        }
        self.evaluate(0..self.plant().mechanisms().len());
        for (actuator, response) in responses.iter_mut().enumerate() {
            *response = self.response(actuator);
        }
        self.work.return_ends(&mut self.row.reached);
        Ok(())
    }

    /// Whether the ends that a host moves are at these distances and move at these rates, to the bit.
    fn are_at(&self, distances: &[R], rates: &[R]) -> bool {
        let same = |one: &R, other: R| one.value().to_bits() == other.value().to_bits();
        let mut there = distances.iter().zip(rates);
        !R::HAS_DERIVATIVES
            && host_mechanisms(self.plant()).all(|(_, here)| {
                let state = self.state();
                let mut own = (0..here.coordinates).map(|k| (state[here.position(k)], state[here.rate(k)]));
                own.all(|own| there.next().is_some_and(|(distance, rate)| same(distance, own.0) && same(rate, own.1)))
            })
    }

    /// Evaluates the plant where the steps are, with the tensions that actuators on these mechanisms share.
    fn evaluate(&mut self, mechanisms: impl Iterator<Item = usize>) {
        let Self { row, work, .. } = self;
        let PlantRow { system, reached, .. } = &mut **row;
        let (time, state, mode) = reached.parts();
        system.enter_pieces(*time, state, mode, &mut work.at);
        system.evaluate(*time, state, mode, &mut work.at);
        mechanisms.for_each(|m| system.share_tensions(m, state, mode, &mut work.at));
    }

    /// The response of an actuator that is there, once the plant has been evaluated.
    fn response(&mut self, actuator: usize) -> Response<R> {
        let Self { row, work, .. } = self;
        let PlantRow { system, reached, .. } = &mut **row;
        let (_, state, mode) = reached.parts();
        let mounted = &system.plant.actuators()[actuator];
        let (unit, chamber, its) = (work.at.units[actuator], work.at.chambers[actuator], &mode.actuators[actuator]);
        let slopes = match &mounted.tendon {
            Some(_) if its.loose || unit.tension.value() <= 0.0 => [R::zero(); 3],
            Some(tendon) => [tendon.stiffness(), R::zero(), R::zero()],
            None => {
                let mut sliding = its.mode;
                if sliding.sliding == Sliding::Stuck {
                    sliding.sliding = Sliding::Frictionless;
                }
                let (member, deflections) = (&system.wires[actuator].member, system.deflections(actuator, state));
                let [length, velocity, pressure] = [unit.length, unit.velocity, chamber.pressure];
                let ends = [Dual::<R, 2>::variable(length, 0), Dual::variable(velocity, 1), Dual::of(pressure)];
                let air = [Dual::<R, 1>::of(length), Dual::of(velocity), Dual::variable(pressure, 0)];
                let [by_length, by_velocity] =
                    member.tension(ends, &sliding, (&its.trace, deflections.constant())).slope;
                let [by_pressure] = member.tension(air, &sliding, (&its.trace, deflections.constant())).slope;
                [by_length, by_velocity, by_pressure]
            }
        };
        let air = mounted.actuator.air();
        Response {
            tension: unit.tension.larger(R::zero()),
            per_length: slopes[0],
            per_velocity: slopes[1],
            per_pressure: slopes[2],
            pressure_rate: unit.pressure_rate,
            mass_flow: unit.flow.net(),
            temperature: air.temperature(&chamber),
            volume: chamber.volume,
        }
    }
}
