//! A closed loop: what is seen at each sampling instant becomes the command until the next.
//!
//! Between two samples the command is a known function of time. So a run under control is the run of the same rig whose
//! [`Command::Table`] is continued at each sampling instant by what is asked up to the next: seats move at exact instants,
//! and the finished table is the whole command, with which the run can be read or repeated without the controller.

use super::rig::Rig;
use super::sample::Sample;
use crate::control::{Controller, Drive, Measurement, Modulator, Quantity, Sampled, Sampling, Sensors};
use crate::error::Error;
use crate::scalar::Real;
use crate::valve::{Command, Request, Solenoid, is_due};
use alloc::vec::Vec;

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

/// A controller with what it and the modulation remember.
#[derive(Debug)]
pub(super) struct ClosedLoop<'c, R: Real, C: Controller<R>> {
    controller: &'c C,
    sampling: Sampling<R>,
    sensors: Sensors<R>,
    sampled: Sampled<C::Memory, Drive<R>>,
    modulator: Modulator<R>,
}

impl<'c, R: Real, C: Controller<R>> ClosedLoop<'c, R, C> {
    /// Before the first sample, with a copy of the rig of which nothing has been asked yet.
    pub(super) fn begin(
        rig: &Rig<R>,
        controller: &'c C,
        sampling: Sampling<R>,
        sensors: Sensors<R>,
    ) -> Result<(Self, Rig<R>), Error> {
        let mut rig = rig.clone();
        let Some(actuation) = rig.actuation_mut() else {
            return Err(Error::Unsupported {
                what: "a controller is given, but the actuator has no valve",
                remedy: "give the actuator a valve, or simulate it without a controller",
            });
        };
        if actuation.solenoid.regulator().is_some() {
            return Err(Error::Unsupported {
                what: "a controller drives the seats of a valve, and a pressure regulator has none",
                remedy: "choose a valve such as valve.kind = \"three-way\", or give the regulator set points",
            });
        }
        actuation.command = Command::Table { time: Vec::new(), request: Vec::new() };
        let sampled = Sampled::begin(controller.begin());
        Ok((Self { controller, sampling, sensors, sampled, modulator: Modulator::idle() }, rig))
    }

    /// The next sampling instant in s.
    pub(super) fn next(&self) -> R {
        self.sampled.next(&self.sampling)
    }

    /// Takes the sample that is due, and continues the rig's command up to the next.
    pub(super) fn sample(&mut self, truth: &Sample<R>, rig: &mut Rig<R>) -> Result<Decision<R>, Error> {
        let time = self.next();
        let pressure = truth.pressure.gauge(rig.actuator().air().atmosphere());
        let Sample { length, velocity, air_mass, tension, .. } = *truth;
        let seen = self.sensors.show(&Measurement { time, length, velocity, pressure, air_mass, tension });
        let aim = self.controller.aim(&seen);
        let mut drive = Drive::Steady(Request::Hold);
        let effective = self.sampled.take(&self.sampling, |memory| {
            drive = self.controller.decide(&seen, memory);
            drive
        });
        if let Some(actuation) = rig.actuation_mut() {
            let (until, frequency) = (self.next(), self.sampling.pulse_frequency());
            let mut ask = |at: R, request: Option<Request>| {
                request.map_or(Ok(()), |request| ask(&actuation.solenoid, &mut actuation.command, at, request))
            };
            if let Some(drive) = effective {
                ask(time, self.modulator.command(drive, time, frequency))?;
            }
            while let Some(instant) = self.modulator.next(frequency).filter(|instant| !is_due(until, *instant)) {
                // A period that begins with the sample may lie a rounding before it.
                ask(instant.larger(time), self.modulator.pass(instant, frequency))?;
            }
        }
        Ok(Decision { seen, aim, drive })
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
