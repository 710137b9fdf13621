//! A run of a plant that goes on as its caller says: step by step, with valves that are set on the way, saved and restored.

use super::evaluation::{Evaluation, System};
use super::mode::PlantMode;
use super::start::PlantStart;
use super::steps::{self, TimeStepping};
use super::trajectory::PlantTrajectory;
use super::{Plant, PlantEventKind};
use crate::command::{Driver, PlantMeasurement};
use crate::engine::{Integrator, Pace, Piece, Statistics};
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::parameter;
use crate::valve::{Command, RuntimeCommand};
use alloc::sync::Arc;
use alloc::vec::Vec;

/// Where a run of a plant is: its states, its discrete state with what its drivers remember, and how it was going.
///
/// It is a value: a run can be restored to it as often as wanted, and goes on to the same bits.
#[derive(Debug)]
pub struct PlantSnapshot<R: Instantiate = f64> {
    time: R,
    state: Vec<R>,
    mode: PlantMode<R>,
    pace: Pace,
}

impl<R: Instantiate> Clone for PlantSnapshot<R> {
    fn clone(&self) -> Self {
        let Self { time, state, mode, pace } = self;
        Self { time: *time, state: state.clone(), mode: mode.clone(), pace: *pace }
    }

    /// Takes on another snapshot in the memory that is there.
    fn clone_from(&mut self, source: &Self) {
        let Self { time, state, mode, pace } = self;
        (*time, *pace) = (source.time, source.pace);
        state.clone_from(&source.state);
        mode.clone_from(&source.mode);
    }
}

impl<R: Instantiate> PlantSnapshot<R> {
    /// The time in s.
    pub fn time(&self) -> R {
        self.time
    }

    /// The states, in the places that [`Plant::indices`] says.
    pub fn state(&self) -> &[R] {
        &self.state
    }

    /// The discrete state.
    pub fn mode(&self) -> &PlantMode<R> {
        &self.mode
    }

    /// How it was going.
    pub(super) fn pace_mut(&mut self) -> &mut Pace {
        &mut self.pace
    }

    /// Its parts, to be taken on.
    pub(super) fn parts(&mut self) -> (&mut R, &mut [R], &mut PlantMode<R>) {
        (&mut self.time, &mut self.state, &mut self.mode)
    }

    /// Becomes another snapshot of the same plant.
    pub(super) fn restore(&mut self, snapshot: &Self) -> Result<(), Error> {
        let (ours, theirs) = (&*self, snapshot);
        let alike = ours.state.len() == theirs.state.len()
            && ours.mode.actuators.len() == theirs.mode.actuators.len()
            && ours.mode.mechanisms.len() == theirs.mode.mechanisms.len()
            && ours.mode.arms.len() == theirs.mode.arms.len()
            && ours.mode.network.branches.len() == theirs.mode.network.branches.len()
            && ours.mode.network.nodes.len() == theirs.mode.network.nodes.len()
            && ours.mode.network.valves.len() == theirs.mode.network.valves.len();
        if !alike {
            return Err(Error::Misuse {
                what: "a snapshot of another plant is restored",
                remedy: "restore what a run of the same plant has saved",
            });
        }
        self.clone_from(snapshot);
        Ok(())
    }

    /// As [`PlantRun::set`].
    pub(super) fn set(&mut self, plant: &Plant<R>, valve: usize, commanded: RuntimeCommand<R>) -> Result<(), Error> {
        self.check_valve(plant, valve)?;
        plant.network.set_valve(valve, self.time, commanded, &mut self.mode.network)
    }

    /// Sets a valve to what needs nothing of where it is and of the time; whether it is that.
    pub(super) fn set_on(
        &mut self,
        plant: &Plant<R>,
        valve: usize,
        commanded: &RuntimeCommand<R>,
    ) -> Result<bool, Error> {
        self.check_valve(plant, valve)?;
        plant.network.set_valve_on(valve, commanded, &mut self.mode.network)
    }

    /// That a valve is there and can be set.
    fn check_valve(&self, plant: &Plant<R>, valve: usize) -> Result<(), Error> {
        let wrong = |what, remedy| Err(Error::Misuse { what, remedy });
        if valve >= plant.network.valves.len() {
            return wrong("a valve is set that is not there", "name a valve of the network");
        }
        if self.mode.drivers.iter().any(|driver| driver.valves().contains(&valve)) {
            return wrong("a valve is set that a driver commands", "leave it to the driver, or leave out the driver");
        }
        Ok(())
    }

    /// As [`PlantRun::set_rates`].
    pub(super) fn set_rates(
        &mut self,
        system: &System<R>,
        mechanism: usize,
        rates: &[R],
        at: &mut Evaluation<R>,
    ) -> Result<(), Error> {
        let plant = &*system.plant;
        let external = matches!(plant.mechanisms.get(mechanism), Some(crate::mechanism::Mechanism::External { .. }));
        if !external {
            return Err(Error::Misuse {
                what: "rates are set of a mechanism whose motion no host gives",
                remedy: "name an external mechanism",
            });
        }
        let here = plant.places.mechanisms[mechanism];
        if rates.len() != here.coordinates {
            return Err(Error::Table {
                name: "rates",
                problem: "there is not one rate for each coordinate",
                entry: rates.len().min(here.coordinates) + 1,
                remedy: "give as many rates as the mechanism has coordinates",
            });
        }
        rates.iter().try_for_each(|rate| parameter::INITIAL_VELOCITY.check(rate.value()).map(drop))?;
        self.state[here.rate(0)..here.rate(0) + here.coordinates].copy_from_slice(rates);
        system.enter_given_rates(mechanism, self.time, &mut self.state, &mut self.mode, at);
        Ok(())
    }

    /// Makes the pulses of all valves that were set to pulse, up to a time in s, and checks what drivers may take until then.
    pub(super) fn pulse(&mut self, plant: &Plant<R>, until: R) -> Result<(), Error> {
        let Self { time, mode, .. } = self;
        let span = (until - *time).value();
        for driver in &mode.drivers {
            driver.check_counts(span)?;
        }
        for valve in 0..mode.network.valves.len() {
            if !mode.drivers.iter().any(|driver| driver.valves().contains(&valve)) {
                plant.network.pulse_valve(valve, [*time, until], &mut mode.network)?;
            }
        }
        Ok(())
    }
}

/// A run of a plant, to be taken on step by step.
///
/// ```
/// use mckibben::plant::{Plant, PlantRun, PlantStart};
/// use mckibben::valve::Request;
///
/// # fn lifts(plant: &Plant, start: &PlantStart) -> Result<(), mckibben::Error> {
/// let mut run = PlantRun::new(plant, start, 1e-6)?;
/// for count in 1..=1000 {
///     let fill = run.measurement().actuators[0].length > 0.09;
///     run.set(0, if fill { Request::Fill } else { Request::Exhaust })?;
///     run.advance_to(f64::from(count) * 1e-3)?;
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct PlantRun<R: Instantiate = f64> {
    system: System<R>,
    stepping: TimeStepping,
    reached: PlantSnapshot<R>,
}

/// Takes a piece of a run, with the time in s and the discrete state that it leads to.
pub(crate) type Keep<'k, R> = dyn FnMut(&Piece<'_, R, PlantMode<R>, PlantEventKind>) -> Result<(), Error> + 'k;

impl<R: Instantiate> PlantRun<R> {
    /// Starts at t = 0: by the event-located engine with a relative tolerance for each step, or by another
    /// [`TimeStepping`]. Valves follow their own commands until they are set.
    ///
    /// # Errors
    /// As [`Plant::start`].
    pub fn new(plant: &Plant<R>, start: &PlantStart<R>, stepping: impl Into<TimeStepping>) -> Result<Self, Error> {
        Self::with_drivers(plant, start, stepping, Vec::new())
    }

    /// Starts at t = 0 with drivers, in place of the commands of the valves that are theirs.
    ///
    /// # Errors
    /// As [`Plant::start`]; [`Error::Misuse`] for a driver of parts that are not there, and for two of one valve.
    pub fn with_drivers(
        plant: &Plant<R>,
        start: &PlantStart<R>,
        stepping: impl Into<TimeStepping>,
        drivers: Vec<Driver<R>>,
    ) -> Result<Self, Error> {
        R::begin_plant_run(plant, start, stepping.into(), drivers)
    }

    pub(crate) fn generic_begin(
        plant: &Plant<R>,
        start: &PlantStart<R>,
        stepping: TimeStepping,
        drivers: Vec<Driver<R>>,
    ) -> Result<Self, Error> {
        if let TimeStepping::Fixed { .. } = stepping {
            stepping.check()?;
        }
        let (mut state, memories) = plant.start_with_memories(start, R::zero())?;
        let mut plant = plant.clone();
        let coordinates: Vec<usize> = plant.places.mechanisms.iter().map(|here| here.coordinates).collect();
        Driver::check_all(&drivers, plant.network.valves.len(), plant.actuators.len(), &coordinates)?;
        for &valve in drivers.iter().flat_map(Driver::valves) {
            let its = &mut plant.network.valves[valve];
            its.command = Command::nothing_of(&its.solenoid);
        }
        let system = System::new(&Arc::new(plant), stepping.tolerance());
        let plant = &*system.plant;
        let mut at = Evaluation::new(plant);
        let mut mode = system.begin((R::zero(), None), &mut state, &memories, &mut at);
        system.check_ends(R::zero(), &state, &mode, &mut at)?;
        system.balance_ends(R::zero(), &mut state, &mode, &mut at);
        system.check_jumps(R::zero(), &state, &mode, &mut at)?;
        mode.drivers = drivers;
        let reached = PlantSnapshot { time: R::zero(), state, mode, pace: Pace::begin(0.0) };
        Ok(Self { system, stepping, reached })
    }

    /// The plant. Drivers have taken the place of the commands of their valves.
    pub fn plant(&self) -> &Plant<R> {
        &self.system.plant
    }

    /// The plant, shared with its evaluation.
    pub(crate) fn shared_plant(&self) -> &Arc<Plant<R>> {
        &self.system.plant
    }

    /// How it goes through time.
    pub fn stepping(&self) -> TimeStepping {
        self.stepping
    }

    /// The relative tolerance of each step, at fixed steps that of borders alone: [`TimeStepping::tolerance`].
    pub fn relative_tolerance(&self) -> f64 {
        self.stepping.tolerance()
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.reached.time
    }

    /// The states at that time, after any event there.
    pub fn state(&self) -> &[R] {
        &self.reached.state
    }

    /// The discrete state at that time, after any event there.
    pub fn mode(&self) -> &PlantMode<R> {
        &self.reached.mode
    }

    /// Steps, evaluations and events since the start.
    pub fn statistics(&self) -> Statistics {
        self.reached.pace.statistics()
    }

    /// What there is to measure at the time that has been reached.
    pub fn measurement(&self) -> PlantMeasurement<R> {
        R::measure_plant_run(self)
    }

    pub(crate) fn generic_measurement(&self) -> PlantMeasurement<R> {
        let PlantSnapshot { time, state, mode, .. } = &self.reached;
        self.system.measure(*time, state, mode, &mut Evaluation::new(&self.system.plant))
    }

    /// The sizes by which errors in the states are scaled now.
    pub(crate) fn scales(&self) -> Vec<f64> {
        let mut scales = alloc::vec![0.0; self.state().len()];
        self.system.scales(self.state(), self.mode(), &mut scales);
        scales
    }

    /// Where the run is.
    pub fn save(&self) -> PlantSnapshot<R> {
        self.reached.clone()
    }

    /// Goes back, or on, to where a run of the same plant was.
    ///
    /// # Errors
    /// [`Error::Misuse`] for a snapshot of another plant.
    pub fn restore(&mut self, snapshot: &PlantSnapshot<R>) -> Result<(), Error> {
        self.reached.restore(snapshot)
    }

    /// Goes on from other states: valves, drivers and what is given over time go on as they were, hysteresis is relaxed.
    pub(crate) fn go_on_from(&mut self, state: &[R]) {
        R::go_on_with_plant_run(self, state);
    }

    pub(crate) fn generic_go_on_from(&mut self, state: &[R]) {
        let PlantSnapshot { time, state: own, mode, pace } = &mut self.reached;
        own.copy_from_slice(state);
        *mode = self.system.begin((*time, Some(mode)), own, &[], &mut Evaluation::new(&self.system.plant));
        *pace = pace.restarted();
    }

    /// Sets what a valve does from now on, in place of all that was to come.
    ///
    /// # Errors
    /// [`Error::Misuse`] when there is no such valve, it has a driver, or it cannot carry out the command;
    /// [`Error::OutOfRange`] for a number outside its range. Then nothing has changed.
    pub fn set(&mut self, valve: usize, commanded: impl Into<RuntimeCommand<R>>) -> Result<(), Error> {
        R::set_plant_valve(self, valve, commanded.into())
    }

    pub(crate) fn generic_set(&mut self, valve: usize, commanded: RuntimeCommand<R>) -> Result<(), Error> {
        self.reached.set(&self.system.plant, valve, commanded)
    }

    /// Sets the rates (m/s or rad/s) of a mechanism whose motion a host gives: its distances go on from where they are.
    ///
    /// # Errors
    /// [`Error::Misuse`] for a mechanism that is not external; [`Error::Table`] unless there is one rate for each
    /// coordinate; [`Error::OutOfRange`] for a rate that is not finite.
    pub fn set_rates(&mut self, mechanism: usize, rates: &[R]) -> Result<(), Error> {
        R::set_plant_rates(self, mechanism, rates)
    }

    pub(crate) fn generic_set_rates(&mut self, mechanism: usize, rates: &[R]) -> Result<(), Error> {
        let mut at = Evaluation::new(self.plant());
        self.reached.set_rates(&self.system, mechanism, rates, &mut at)
    }

    /// Goes on to `until` in s; nothing where that has been reached.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time that is not finite; [`Error::Stopped`] when the plant leaves what the model describes
    /// or no step is short enough; [`Error::TooMany`] for more samples or pulses than a run may have; those of a driver
    /// whose valve cannot carry out its commands. The run then stays where it was.
    pub fn advance_to(&mut self, until: R) -> Result<(), Error> {
        R::advance_plant_run(self, until)
    }

    /// Goes on to `until` in s and hands each piece of the run to `keep`.
    pub(crate) fn extend(&mut self, until: R, keep: &mut Keep<'_, R>) -> Result<(), Error> {
        let span = (until - self.time()).value();
        if span <= 0.0 {
            return Ok(());
        }
        parameter::DURATION.check(span)?;
        let mut from = self.reached.clone();
        from.pulse(&self.system.plant, until)?;
        let relative_tolerance = match self.stepping {
            TimeStepping::Located { relative_tolerance } => relative_tolerance,
            TimeStepping::Fixed { method, step } => {
                steps::extend(&self.system, (method, step), &mut from, until, keep)?;
                self.reached = from;
                return Ok(());
            }
        };
        let PlantSnapshot { time, state, mode, pace } = from;
        let mut integrator = Integrator::resume(&self.system, (time, &state, mode), until, relative_tolerance, pace);
        while integrator.advance()? {
            keep(&integrator.piece())?;
        }
        self.reached = PlantSnapshot {
            time: integrator.time(),
            state: integrator.state().to_vec(),
            mode: integrator.mode().clone(),
            pace: integrator.pace(),
        };
        Ok(())
    }

    /// Goes on to `until` in s and keeps the run from here to there; `watch` is called with the time in s now and then, and
    /// may end the run by an error such as [`Error::Interrupted`].
    ///
    /// # Errors
    /// As [`PlantRun::advance_to`], and those of `watch`; [`Error::Stopped`] when the run takes more steps than a kept one may
    /// have.
    pub fn record_to(
        &mut self,
        until: R,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<PlantTrajectory<R>, Error> {
        PlantTrajectory::record(self, until, watch)
    }
}

impl PlantRun {
    /// Begins the plant again at `time` in s, from a given start and without drivers: commands of valves and what is given over time,
    /// motions and pressures, are where they are at that time. The mass of air follows from them and from the temperature of the start.
    ///
    /// # Errors
    /// As [`Plant::start`]; [`Error::OutOfRange`] for a time that is negative or not finite.
    pub fn begin_again(&self, start: &PlantStart, time: f64) -> Result<Self, Error> {
        if time != 0.0 {
            parameter::DURATION.check(time)?;
        }
        let system = self.system.clone();
        let plant = &*system.plant;
        let (mut state, memories) = plant.start_with_memories(start, time)?;
        let mut at = Evaluation::new(plant);
        let mut first = system.begin((0.0, None), &mut state.clone(), &memories, &mut at);
        for valve in 0..plant.network.valves.len() {
            while plant.network.is_valve_due(valve, time, &first.network) {
                plant.network.pass_valve(valve, time, &mut first.network);
            }
        }
        let mode = system.begin((time, Some(&first)), &mut state, &memories, &mut at);
        system.check_ends(time, &state, &mode, &mut at)?;
        system.balance_ends(time, &mut state, &mode, &mut at);
        system.check_jumps(time, &state, &mode, &mut at)?;
        let reached = PlantSnapshot { time, state, mode, pace: Pace::begin(time) };
        Ok(Self { system, stepping: self.stepping, reached })
    }

    /// Goes on by other steps from where the run is. What it has cost is counted on.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a tolerance or a step outside its range. Then nothing has changed.
    pub fn set_stepping(&mut self, stepping: impl Into<TimeStepping>) -> Result<(), Error> {
        let stepping = stepping.into();
        stepping.check()?;
        // Borders between formulas are as wide as the steps need.
        self.system = System::new(&self.system.plant, stepping.tolerance());
        self.stepping = stepping;
        self.reached.pace = self.reached.pace.restarted();
        Ok(())
    }
}
