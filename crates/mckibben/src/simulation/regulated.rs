//! The port of a proportional pressure regulator in the event-located engine: what lies beyond the open passage is a state.
//!
//! The set point in force and the branch of the regulator's rate are components of the mode. A set point takes effect at a
//! known instant, its time and the dead time (and the delay of a lumped hose, behind which everything is seen late); a rate
//! at its limit ends by a guard. Until the first takes effect the regulator rests at the actuator's initial pressure, as far
//! as it lies between the surroundings and the supply.
//!
//! Checked by `tests/regulated_rig.rs` against the closed form of the regulator.

#[cfg(feature = "alloc")]
use super::joint::{Driven, JointRig};
use super::rig::{Actuation, Rig};
use super::system::GuardForm;
use crate::actuator::Actuator;
use crate::pressure::AbsolutePressure;
use crate::scalar::{Over, Real};
use crate::valve::{Approach, Command, Port, Regulator, RegulatorClock, Valve, is_due};

/// A regulator's port and the place of its pressure among the states.
#[derive(Clone, Copy, Debug)]
pub(super) struct RegulatedPort<'a, R> {
    regulator: Regulator<R>,
    command: &'a Command<R>,
    /// From the time of a set point to its effect, in s.
    delay: R,
    atmosphere: R,
    pub(super) place: usize,
}

/// Which set point is in force, and how the pressure goes there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PortMode {
    passed: u64,
    /// At rest until the first set point takes effect.
    approach: Option<Approach>,
}

impl PortMode {
    pub(super) const AT_REST: Self = Self { passed: 0, approach: None };

    /// The rate falls below its limit.
    pub(super) fn settle(&mut self) {
        self.approach = Some(Approach::Settles);
    }
}

impl<R: Real> Rig<R> {
    /// What a pressure regulator does over time by its closed form, with a pressure in Pa in the actuator at the start.
    pub(crate) fn regulator_clock(&self, pressure: R) -> Option<RegulatorClock<R>> {
        self.regulator().and(self.actuator().valve()).map(|valve| clock(valve, pressure))
    }
}

#[cfg(feature = "alloc")]
impl<R: Real> JointRig<R> {
    /// The same of one of the actuators of a joint.
    pub(super) fn regulator_clock(&self, actuator: usize, pressure: R) -> Option<RegulatorClock<R>> {
        let Driven { actuator, actuation } = &self.driven()[actuator];
        actuation.as_ref()?.solenoid.regulator().and(actuator.valve()).map(|valve| clock(valve, pressure))
    }
}

fn clock<R: Real>(valve: &Valve<R>, pressure: R) -> RegulatorClock<R> {
    let at_rest = AbsolutePressure(RegulatedPort::start(valve, pressure));
    RegulatorClock::resting(at_rest, AbsolutePressure(valve.port_pressure(Port::Exhaust)))
}

impl<'a, R: Real> RegulatedPort<'a, R> {
    /// The port of the regulator that drives an actuator, if there is one.
    pub(super) fn new(actuation: Option<&'a Actuation<R>>, actuator: &Actuator<R>, place: usize) -> Option<Self> {
        let Actuation { solenoid, command } = actuation?;
        let regulator = *solenoid.regulator()?;
        let delay = solenoid.latency();
        Some(Self { regulator, command, delay, atmosphere: actuator.air().atmosphere().0, place })
    }

    /// The regulated pressure at the start, with a pressure in the actuator.
    pub(super) fn start(valve: &Valve<R>, pressure: R) -> R {
        pressure.larger(valve.port_pressure(Port::Exhaust)).smaller(valve.port_pressure(Port::Supply))
    }

    /// The next instant in s at which a set point takes effect, up to and with `until`.
    pub(super) fn next(&self, mode: &PortMode, until: R) -> Option<R> {
        let (time, _) = self.command.set_point(mode.passed)?;
        Some(time + self.delay).filter(|instant| is_due(*instant, until))
    }

    /// Lets what is due up to and with `time` take effect; whether anything did.
    pub(super) fn pass<const N: usize>(&self, time: R, state: &[R; N], mode: &mut PortMode) -> bool {
        let before = mode.passed;
        while self.next(mode, time).is_some() {
            mode.passed += 1;
        }
        if mode.passed == before {
            return false;
        }
        mode.approach = self.set_point(mode).map(|set| self.regulator.approach(state[self.place], set));
        true
    }

    /// The absolute pressure in Pa that is in force.
    fn set_point(&self, mode: &PortMode) -> Option<R> {
        self.command.set_point(mode.passed.checked_sub(1)?).map(|(_, gauge)| gauge + self.atmosphere)
    }

    /// `dp/dt` in Pa/s.
    #[inline(always)]
    pub(super) fn rate<T: Over<R>, const N: usize>(&self, state: &[T; N], mode: &PortMode) -> T {
        let (Some(approach), Some(set)) = (mode.approach, self.set_point(mode)) else { return T::zero() };
        self.regulator.rate_in(approach, state[self.place], T::of(set))
    }

    /// Where the rate falls below its limit: the absolute pressure in Pa, and whether the mode lasts above it.
    fn limit_end(&self, mode: &PortMode) -> Option<(R, bool)> {
        let (approach, set) = (mode.approach?, self.set_point(mode)?);
        Some((self.regulator.limit_end(approach, set)?, approach == Approach::Falls))
    }

    /// The guard of the limit, if the rate is at it.
    pub(super) fn guard_form(&self, mode: &PortMode) -> Option<GuardForm> {
        let (bound, lasts_above) = self.limit_end(mode)?;
        let (index, bound) = (self.place, bound.value());
        Some(if lasts_above { GuardForm::Above { index, bound } } else { GuardForm::Below { index, bound } })
    }

    /// The value of that guard.
    pub(super) fn guard<T: Over<R>, const N: usize>(&self, state: &[T; N], mode: &PortMode) -> Option<T> {
        let (bound, lasts_above) = self.limit_end(mode)?;
        let above = state[self.place] - T::of(bound);
        Some(if lasts_above { above } else { -above })
    }
}
