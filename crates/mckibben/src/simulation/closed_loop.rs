//! A closed loop: what is seen at each sampling instant becomes the command until the next.
//!
//! Between two samples the command is a known function of time. So a run under control is the run of the same rig whose
//! [`Command::Table`] is continued at each sampling instant by what is asked up to the next: seats move at exact instants,
//! and the finished table is the whole command, with which the run can be read or repeated without the controller. The same
//! holds of a joint with its two valves.

use super::rig::{Actuation, Rig};
use super::sample::Sample;
use crate::actuator::Actuator;
use crate::control::{Controller, Drive, Measurement, Modulator, Quantity, Sampled, Sampling, Sensors};
use crate::error::Error;
use crate::scalar::Real;
use crate::valve::{Command, Request, Solenoid, is_due};
#[cfg(feature = "batch")]
use alloc::{boxed::Box, vec::Vec};

/// What a controller saw at a sampling instant and what it decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision<R = f64> {
    /// What the sensors showed; its time is the sampling instant.
    pub seen: Measurement<R>,
    /// What the controller tried to reach and in which quantity, if it has such an aim.
    pub aim: Option<(Quantity, R)>,
    /// What the valve is to do once the decision takes effect.
    pub drive: Drive<R>,
}

/// The clockwork of a loop around `N` valves: when it samples, what has been decided, and the pulses that follow.
#[derive(Debug)]
pub(super) struct Clockwork<R: Real, M, const N: usize> {
    sampling: Sampling<R>,
    sampled: Sampled<M, [Drive<R>; N]>,
    modulators: [Modulator<R>; N],
}

impl<R: Real, M, const N: usize> Clockwork<R, M, N> {
    /// Before the first sample; nothing is asked of the valves yet.
    pub(super) fn begin(
        memory: M,
        sampling: Sampling<R>,
        valves: [Option<&mut Actuation<R>>; N],
    ) -> Result<Self, Error> {
        for valve in valves {
            with_seats(valve, |actuation| actuation.solenoid.has_seats())?.command = Command::nothing();
        }
        Ok(Self { sampling, sampled: Sampled::begin(memory), modulators: [Modulator::idle(); N] })
    }

    /// The next sampling instant in s.
    pub(super) fn next(&self) -> R {
        self.sampled.next(&self.sampling)
    }

    /// Takes the sample that is due by `decide`, and continues the commands of the valves up to the next.
    pub(super) fn sample(
        &mut self,
        valves: [Option<&mut Actuation<R>>; N],
        decide: impl FnOnce(&mut M) -> [Drive<R>; N],
    ) -> Result<[Drive<R>; N], Error> {
        let time = self.next();
        let mut drives = [Drive::Steady(Request::Hold); N];
        let effective = self.sampled.take(&self.sampling, |memory| {
            drives = decide(memory);
            drives
        });
        let (until, frequency) = (self.next(), self.sampling.pulse_frequency());
        for (i, (valve, modulator)) in valves.into_iter().zip(&mut self.modulators).enumerate() {
            let Some(Actuation { solenoid, command }) = valve else { continue };
            let mut ask =
                |at: R, request: Option<Request>| request.map_or(Ok(()), |request| ask(solenoid, command, at, request));
            if let Some(drives) = effective {
                ask(time, modulator.command(drives[i], time, frequency))?;
            }
            while let Some(instant) = modulator.next(frequency).filter(|instant| !is_due(until, *instant)) {
                // A period that begins with the sample may lie a rounding before it.
                ask(instant.larger(time), modulator.pass(instant, frequency))?;
            }
        }
        Ok(drives)
    }
}

/// The valve that a controller drives, which must have seats.
///
/// # Errors
/// [`Error::Misuse`] when there is no valve, or one without seats.
pub(crate) fn with_seats<V>(valve: Option<V>, has_seats: impl FnOnce(&V) -> bool) -> Result<V, Error> {
    match valve {
        None => Err(Error::Misuse {
            what: "a controller is given, but the actuator has no valve",
            remedy: "give the actuator a valve, or simulate it without a controller",
        }),
        Some(valve) if has_seats(&valve) => Ok(valve),
        Some(_) => Err(Error::Misuse {
            what: "a controller drives the seats of a valve, and a pressure regulator or a proportional spool has none",
            remedy: "choose a valve such as valve.kind = \"three-way\", or give set points or positions",
        }),
    }
}

/// What there is to measure of an actuator at a sampling instant in s.
pub(crate) fn measurement<R: Real>(time: R, truth: &Sample<R>, actuator: &Actuator<R>) -> Measurement<R> {
    let pressure = truth.pressure.gauge(actuator.air().atmosphere());
    let Sample { length, velocity, air_mass, tension, .. } = *truth;
    Measurement { time, length, velocity, pressure, air_mass, tension }
}

/// The clockwork of a controller of one valve.
pub(super) type OneValve<R, C> = Clockwork<R, <C as Controller<R>>::Memory, 1>;

/// A controller of one actuator with its sensors.
#[derive(Debug)]
pub(super) struct ClosedLoop<R: Real, C: Controller<R>> {
    pub(super) controller: C,
    pub(super) sensors: Sensors<R>,
}

impl<R: Real, C: Controller<R>> ClosedLoop<R, C> {
    /// The clockwork before the first sample, with a copy of the rig of which nothing has been asked yet.
    pub(super) fn begin(&self, rig: &Rig<R>, sampling: Sampling<R>) -> Result<(OneValve<R, C>, Rig<R>), Error> {
        let mut rig = rig.clone();
        Ok((Clockwork::begin(self.controller.begin(), sampling, [rig.actuation_mut()])?, rig))
    }

    /// Takes the sample that is due, and continues the rig's command up to the next.
    pub(super) fn sample(
        &self,
        clockwork: &mut OneValve<R, C>,
        truth: &Sample<R>,
        rig: &mut Rig<R>,
    ) -> Result<Decision<R>, Error> {
        let truth = measurement(clockwork.next(), truth, rig.actuator());
        self.decide(clockwork, &truth, rig.actuation_mut())
    }

    /// The same of what is measured, for a valve by itself.
    fn decide(
        &self,
        clockwork: &mut OneValve<R, C>,
        truth: &Measurement<R>,
        valve: Option<&mut Actuation<R>>,
    ) -> Result<Decision<R>, Error> {
        let seen = self.sensors.show(truth);
        let [drive] = clockwork.sample([valve], |memory| [self.controller.decide(&seen, memory)])?;
        Ok(Decision { seen, aim: self.controller.aim(&seen), drive })
    }
}

/// A loop around one valve, whatever its controller: each row of a batch may have one of its own.
#[cfg(feature = "batch")]
pub trait Control: core::fmt::Debug + Send + Sync {
    /// The next sampling instant in s.
    fn next(&self) -> f64;
    /// Takes the sample that is due, and continues the valve's command up to the next.
    fn sample(&mut self, truth: &Measurement, valve: Option<&mut Actuation>) -> Result<(), Error>;
    /// What has been decided, in order of time.
    fn decisions(&self) -> &[Decision];
}

/// A controller with its clockwork.
#[cfg(feature = "batch")]
#[derive(Debug)]
struct Own<C: Controller> {
    closed_loop: ClosedLoop<f64, C>,
    clockwork: OneValve<f64, C>,
    decisions: Vec<Decision>,
}

/// A loop before its first sample, with a copy of the rig of which nothing has been asked yet.
#[cfg(feature = "batch")]
pub(crate) fn own_loop<C>(
    rig: &Rig,
    controller: C,
    (sampling, sensors): (Sampling, Sensors),
) -> Result<(Box<dyn Control>, Rig), Error>
where
    C: Controller<Memory: Send + Sync> + core::fmt::Debug + Send + Sync + 'static,
{
    let closed_loop = ClosedLoop { controller, sensors };
    let (clockwork, rig) = closed_loop.begin(rig, sampling)?;
    Ok((Box::new(Own { closed_loop, clockwork, decisions: Vec::new() }), rig))
}

#[cfg(feature = "batch")]
impl<C> Control for Own<C>
where
    C: Controller<Memory: Send + Sync> + core::fmt::Debug + Send + Sync,
{
    fn next(&self) -> f64 {
        self.clockwork.next()
    }

    fn sample(&mut self, truth: &Measurement, valve: Option<&mut Actuation>) -> Result<(), Error> {
        self.decisions.push(self.closed_loop.decide(&mut self.clockwork, truth, valve)?);
        Ok(())
    }

    fn decisions(&self) -> &[Decision] {
        &self.decisions
    }
}

/// Adds a request at a time in s to a table; of two in one instant the later counts, and none is said twice.
fn ask<R: Real>(solenoid: &Solenoid<R>, command: &mut Command<R>, at: R, asked: Request) -> Result<(), Error> {
    solenoid.check_request(asked)?;
    if let Command::Table { time, request } = command {
        match (time.last(), request.last_mut()) {
            (Some(last), Some(before)) if is_due(at, *last) => *before = asked,
            (_, Some(before)) if *before == asked => {}
            _ => {
                time.push(at);
                request.push(asked);
            }
        }
    }
    Ok(())
}
