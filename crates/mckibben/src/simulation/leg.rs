//! A leg on six modular actuators, at fixed steps.
//!
//! ```text
//! ω½ = ω + h/2 α(θ, ω, F)        θ⁺ = θ + h ω½
//! the actuators' ends move to L(θ⁺); F⁺ = F(L⁺, L̇(ω + h α), P⁺)
//! ω⁺ = ω½ + h/2 α(θ⁺, ω + h α, F⁺)
//! ```
//!
//! Order 2 between the motions of seats. The step has to resolve what is stiff in the leg, the belt and the stops, not the
//! air. Dry friction of the actuators has its middle at rest ([`ModularActuator`]); hysteresis holds.
//!
//! Checked by `tests/leg.rs`.

use super::modular::ModularActuator;
use super::rig::{Initial, InitialLength, Rig, State};
use super::sample::Sample;
use crate::control::Drive;
use crate::error::Error;
use crate::load::Load;
use crate::load::leg::{Leg, LegState, STRANDS};
use crate::pressure::GaugePressure;
use crate::scalar::Real;

/// Steps a leg through time.
#[derive(Clone, Debug)]
pub struct LegStepper<R: Real<Time = R> = f64> {
    leg: Leg<R>,
    state: LegState<R>,
    actuators: [ModularActuator<R>; STRANDS],
}

/// What is known of a leg at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegSample<R = f64> {
    /// Time in s.
    pub time: R,
    /// Angles and angular velocities.
    pub state: LegState<R>,
    /// Of each strand its actuator, with velocity and tension at these angular velocities.
    pub actuators: [Sample<R>; STRANDS],
}

impl LegStepper {
    /// A leg at t = 0 in a state, each of its strands the actuator of a rig with air at a gauge pressure and at a
    /// temperature in K. Pulses come at `pulse_frequency` in Hz. The rigs' loads and commands do not count.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] or [`Error::Inconsistent`] for a number outside its range, or an actuator that would be longer
    /// than its thread; [`Error::NotImplemented`] for a line that fixed steps cannot take.
    pub fn new(
        leg: Leg,
        state: LegState,
        strands: [(&Rig, GaugePressure); STRANDS],
        temperature: f64,
        pulse_frequency: f64,
    ) -> Result<Self, Error> {
        let leg = leg.checked()?;
        let (lengths, velocities) = (leg.lengths(&state.angles), leg.velocities(&state.rates));
        let begin = |strand: usize| {
            let (rig, gauge_pressure) = strands[strand];
            let length = InitialLength::At(lengths[strand]);
            let initial = Initial { gauge_pressure, temperature, length, velocity: velocities[strand] };
            // Whatever the rig's load, the air at the start is that of the actuator at its length.
            let start = rig.clone().with_load(Load::Isometric).start(&initial)?;
            let start = State { velocity: velocities[strand], ..start };
            ModularActuator::new(rig, start, pulse_frequency)
        };
        let actuators = [begin(0)?, begin(1)?, begin(2)?, begin(3)?, begin(4)?, begin(5)?];
        Ok(Self { leg, state, actuators })
    }
}

impl<R: Real<Time = R>> LegStepper<R> {
    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.actuators[0].time()
    }

    /// The leg.
    pub fn leg(&self) -> &Leg<R> {
        &self.leg
    }

    /// Where the leg is.
    pub fn state(&self) -> &LegState<R> {
        &self.state
    }

    /// The actuators.
    pub fn actuators(&self) -> &[ModularActuator<R>; STRANDS] {
        &self.actuators
    }

    /// What is asked of each valve from now on.
    ///
    /// # Errors
    /// As [`ModularActuator::drive`]; the actuators before the one that is refused have been asked.
    pub fn drive(&mut self, drives: [Drive<R>; STRANDS]) -> Result<(), Error> {
        self.actuators.iter_mut().zip(drives).try_for_each(|(actuator, drive)| actuator.drive(drive))
    }

    /// Tensions of the actuators in N.
    pub fn tensions(&self) -> [R; STRANDS] {
        self.tensions_at(&self.state.rates)
    }

    /// Everything that is known at the time that has been reached.
    pub fn sample(&self) -> LegSample<R> {
        let (velocities, tensions) = (self.leg.velocities(&self.state.rates), self.tensions());
        let actuators = core::array::from_fn(|strand| {
            let (velocity, tension) = (velocities[strand], tensions[strand]);
            Sample { velocity, tension, ..self.actuators[strand].sample() }
        });
        LegSample { time: self.time(), state: self.state, actuators }
    }

    fn tensions_at(&self, rates: &[R; 2]) -> [R; STRANDS] {
        let velocities = self.leg.velocities(rates);
        core::array::from_fn(|strand| self.actuators[strand].respond(velocities[strand]).tension)
    }

    /// Goes on to `until` s, later than the time that has been reached, in one step.
    ///
    /// # Errors
    /// As [`ModularActuator::move_to`].
    pub fn advance_to(&mut self, until: R) -> Result<(), Error> {
        let step = until - self.time();
        let half = R::constant(0.5) * step;
        let LegState { angles, rates } = self.state;
        let first = self.leg.accelerations(&self.state, &self.tensions());
        let halfway = ahead(rates, half, first);
        let angles = ahead(angles, step, halfway);
        for (actuator, length) in self.actuators.iter_mut().zip(self.leg.lengths(&angles)) {
            actuator.move_to(until, length)?;
        }
        let foreseen = ahead(rates, step, first);
        let arrived = LegState { angles, rates: foreseen };
        let second = self.leg.accelerations(&arrived, &self.tensions_at(&foreseen));
        self.state = LegState { angles, rates: ahead(halfway, half, second) };
        Ok(())
    }
}

/// `y + h k`.
fn ahead<R: Real>(state: [R; 2], step: R, slope: [R; 2]) -> [R; 2] {
    [state[0] + step * slope[0], state[1] + step * slope[1]]
}
