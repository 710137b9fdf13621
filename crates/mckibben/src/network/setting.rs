//! Valves that are set during a run: what they do from then on takes the place of their own command.
//!
//! What has been set becomes a command of which only what is still on its way is kept, so that seats move at the instants
//! that they would have if all had been known beforehand, and memory stays bounded however often a valve is set.

use super::mode::NetworkMode;
use super::{Network, NodeKind};
use crate::error::Error;
use crate::parameter;
use crate::scalar::Real;
use crate::simulation::Actuation;
use crate::simulation::told::Told;
use crate::valve::Demand;
use alloc::boxed::Box;

/// What a valve has been set to during a run.
#[derive(Clone, Debug)]
pub(crate) struct Setting<R> {
    /// The valve, with what of its command is still on its way.
    actuation: Actuation<R>,
    told: Told<R>,
    /// Of pulses that go on, in Hz.
    pulse_frequency: Option<R>,
}

impl<R: Real> Setting<R> {
    /// Nothing has been set yet: the valve goes on with its own command.
    fn of(actuation: &Actuation<R>) -> Self {
        Self { actuation: actuation.clone(), told: Told::nothing(), pulse_frequency: None }
    }

    pub(crate) fn actuation(&self) -> &Actuation<R> {
        &self.actuation
    }

    /// When in s its pulses must be laid out next; infinite when never.
    #[cfg(feature = "lanes")]
    pub(crate) fn edge(&self) -> R {
        self.told.next_edge()
    }
}

impl<R: Real> Network<R> {
    /// Sets what a valve does from `time` in s on, in place of all that was to come.
    ///
    /// # Errors
    /// As [`Solenoid::check_demand`](crate::valve::Solenoid::check_demand).
    pub(crate) fn set_valve(
        &self,
        valve: usize,
        time: R,
        demand: Demand<R>,
        mode: &mut NetworkMode<R>,
    ) -> Result<(), Error> {
        self.valves[valve].solenoid.check_demand(&demand)?;
        let of_valve = &mut mode.valves[valve];
        let setting = of_valve.setting.get_or_insert_with(|| Box::new(Setting::of(&self.valves[valve])));
        let Setting { actuation, told, pulse_frequency } = &mut **setting;
        *pulse_frequency = if let Demand::Pulses { frequency, .. } = demand { Some(frequency) } else { None };
        told.tell(|| Ok((Some(&mut *actuation), &mut of_valve.progress)), time, demand)?;
        // Of set points that have taken effect the last one is still in force.
        let of_valve = |node: &NodeKind<R>| matches!(node, NodeKind::Port { valve: its, .. } if *its == valve);
        let ports = || (0..self.nodes.len()).filter(|node| of_valve(&self.nodes[*node].kind));
        if let Some(passed) = ports().map(|node| mode.nodes[node].set_points).min()
            && passed > 1
        {
            actuation.command.keep(passed - 1, R::constant(f64::INFINITY));
            for node in ports() {
                mode.nodes[node].set_points -= passed - 1;
            }
        }
        Ok(())
    }

    /// Lays the pulses of a valve that has been set out to `until`, from `time` on, both in s.
    ///
    /// # Errors
    /// [`Error::TooMany`] for more pulses than a run may have.
    pub(crate) fn pulse_valve(
        &self,
        valve: usize,
        [time, until]: [R; 2],
        mode: &mut NetworkMode<R>,
    ) -> Result<(), Error> {
        let of_valve = &mut mode.valves[valve];
        let Some(setting) = &mut of_valve.setting else { return Ok(()) };
        let Setting { actuation, told, pulse_frequency } = &mut **setting;
        if let Some(frequency) = pulse_frequency {
            let pulses = frequency.value() * (until - time).value();
            parameter::PWM_FREQUENCY.check_count(frequency.value(), pulses, "pulses")?;
        }
        told.hear(|| (Some(actuation), &mut of_valve.progress), [time, until]);
        Ok(())
    }

    /// Takes over into the valves' own commands what they have been set to from a time in s on.
    pub(crate) fn record_settings(&mut self, valves: &[usize], from: R, mode: &NetworkMode<R>) {
        for &valve in valves {
            if let Some(setting) = &mode.valves[valve].setting {
                self.valves[valve].command.take_over(&setting.actuation.command, from);
            }
        }
    }
}
