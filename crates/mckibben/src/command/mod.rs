//! Commands of a plant's valves: schedules, controllers and what is set at run time, by one interface.
//!
//! | source | what it is |
//! |---|---|
//! | schedule | the [`Command`](crate::valve::Command) of a valve in the network, known from the start |
//! | controller | a [`Driver`]: at its sampling instants it measures the plant and sets the valves that are its own |
//! | run time | [`PlantRun::set`](crate::plant::PlantRun::set), between two calls of `advance_to` |
//!
//! All of them say what a valve is to do as a [`RuntimeCommand`]: a request of poppets, pulses, a set point of a pressure regulator or
//! a position of a spool. A valve has one source: a driver takes the place of its schedule, and a command at run time
//! takes the place of the rest of it.
//!
//! ```text
//! measurement at t = k/f_s  →  sensors (step, range)  →  controller  →  commands from t = (k + d)/f_s on
//! ```
//!
//! A driver commands one valve or several, and any number of drivers run side by side, each with its own sampling. Sampling
//! instants, ends of pulses and motions of poppets are exact instants of the event-located engine. What a controller remembers
//! is part of the plant's discrete state: a run that is restored goes on with it.
//!
//! | driver | controller |
//! |---|---|
//! | [`Driver::of_actuator`] | a [`Controller`] of one actuator |
//! | [`Driver::of_joint`] | a [`JointController`] of two actuators about a joint |
//! | [`Driver::of_function`] | a function, with what it remembers |
//! | [`Driver::new`] | any [`PlantController`] |
//!
//! Checked by `tests/plant_control.rs`: against the engine of one actuator and fixed steps of a joint, and against the schedule that a
//! controller has requested.

mod adapter;
mod measurement;

pub use measurement::{PlantMeasurement, PlantSensors};

use crate::control::{
    Controller, Drive, JointController, JointSensors, Quantity, Sampled, Sampling, Sensors, SetPoint,
};
use crate::error::Error;
use crate::scalar::Real;
use crate::valve::RuntimeCommand;
use adapter::{OnActuator, OnJoint, Unit};
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt::Debug;

/// A controller of one or several valves of a plant.
pub trait PlantController<R: Real = f64> {
    /// What it remembers from one sampling instant to the next; it belongs to the run.
    type Memory: Clone + Debug;

    /// The memory before the first sampling instant.
    fn begin(&self) -> Self::Memory;

    /// Sets what each of its valves is to do, in their order; a valve that is left at `None` goes on with what it does.
    fn decide(&self, seen: &PlantMeasurement<R>, memory: &mut Self::Memory, commands: &mut [Option<RuntimeCommand<R>>]);

    /// What it tries to reach at a sampling instant and in which quantities, if it has such aims.
    fn aims(&self, seen: &PlantMeasurement<R>) -> Vec<(Quantity, R)> {
        let _ = seen;
        Vec::new()
    }
}

/// What the valves of a driver are to do; `None` where one goes on as it does.
type Demands<R> = Vec<Option<RuntimeCommand<R>>>;

/// What a driver saw at a sampling instant and what it decided.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantDecision<R = f64> {
    /// What the sensors showed; its time is the sampling instant.
    pub seen: PlantMeasurement<R>,
    /// What the controller tried to reach and in which quantities.
    pub aims: Vec<(Quantity, R)>,
    /// What each of the driver's valves is to do once the decision takes effect; `None` where it goes on as it does.
    pub commands: Demands<R>,
}

impl<R: Real> PlantDecision<R> {
    /// What the poppets of one of the driver's valves are to do; none where it goes on as it does, or has no seats.
    pub fn drive(&self, valve: usize) -> Option<Drive<R>> {
        match self.commands.get(valve)?.as_ref()? {
            RuntimeCommand::Request(request) => Some(Drive::Steady(*request)),
            RuntimeCommand::Pulses { duty, pulse, rest, .. } => {
                Some(Drive::Pulses { duty: *duty, pulse: *pulse, rest: *rest })
            }
            _ => None,
        }
    }
}

/// What stays the same of a driver.
#[derive(Debug)]
struct Plan<R: Real> {
    valves: Vec<usize>,
    sampling: Sampling<R>,
    sensors: PlantSensors<R>,
    /// The parts of the plant that the controller must find there.
    needs: Needs,
    /// Frequencies in Hz of the set points that it follows, and the time in s of their last change besides.
    course: (Vec<f64>, f64),
}

/// Parts of a plant by their indices.
#[derive(Clone, Debug, Default)]
struct Needs {
    actuators: Vec<usize>,
    /// A mechanism and one of its coordinates.
    joint: Option<(usize, usize)>,
}

/// Commands one or several valves of a plant at its sampling instants.
///
/// It is a value: a copy has its own memory.
#[derive(Clone, Debug)]
pub struct Driver<R: Real = f64> {
    plan: Arc<Plan<R>>,
    sampled: Sampled<Box<dyn Unit<R>>, Demands<R>>,
    last: Option<Arc<PlantDecision<R>>>,
}

impl<R: Real> Driver<R> {
    /// A controller that commands `valves` of the network.
    pub fn new<C>(controller: C, valves: &[usize], sampling: Sampling<R>, sensors: PlantSensors<R>) -> Self
    where
        R: 'static,
        C: PlantController<R, Memory: Send + Sync> + Debug + Send + Sync + 'static,
    {
        Self::assemble(controller, valves, sampling, (sensors, Needs::default()))
    }

    fn assemble<C>(
        controller: C,
        valves: &[usize],
        sampling: Sampling<R>,
        (sensors, needs): (PlantSensors<R>, Needs),
    ) -> Self
    where
        R: 'static,
        C: PlantController<R, Memory: Send + Sync> + Debug + Send + Sync + 'static,
    {
        let plan = Arc::new(Plan { valves: valves.to_vec(), sampling, sensors, needs, course: (Vec::new(), 0.0) });
        Self { plan, sampled: Sampled::begin(adapter::unit(controller)), last: None }
    }

    /// A controller of one actuator that commands a valve of the network.
    pub fn of_actuator<C>(
        controller: C,
        actuator: usize,
        valve: usize,
        (sampling, sensors): (Sampling<R>, Sensors<R>),
    ) -> Self
    where
        R: Send + Sync + 'static,
        C: Controller<R, Memory: Send + Sync> + Debug + Send + Sync + 'static,
    {
        let on = OnActuator { controller, actuator, pulse_frequency: sampling.pulse_frequency() };
        let sensors = PlantSensors::perfect().with_actuator(actuator, sensors);
        Self::assemble(on, &[valve], sampling, (sensors, Needs { actuators: vec![actuator], joint: None }))
    }

    /// A controller of agonist and antagonist about the joint `(mechanism, coordinate)` that commands the valve of each.
    pub fn of_joint<C>(
        controller: C,
        joint: (usize, usize),
        actuators: [usize; 2],
        valves: [usize; 2],
        (sampling, sensors): (Sampling<R>, JointSensors<R>),
    ) -> Self
    where
        R: Send + Sync + 'static,
        C: JointController<R, Memory: Send + Sync> + Debug + Send + Sync + 'static,
    {
        let on = OnJoint { controller, joint, actuators, pulse_frequency: sampling.pulse_frequency() };
        let mut shown = PlantSensors::perfect().with_coordinate(joint, [sensors.angle, sensors.angular_velocity]);
        for (actuator, sensors) in actuators.into_iter().zip(sensors.actuators) {
            shown = shown.with_actuator(actuator, sensors);
        }
        let needs = Needs { actuators: actuators.to_vec(), joint: Some(joint) };
        Self::assemble(on, &valves, sampling, (shown, needs))
    }

    /// A function from what is measured and remembered to what `valves` are to do; it starts with `memory`.
    pub fn of_function<M, F>(
        function: F,
        memory: M,
        valves: &[usize],
        sampling: Sampling<R>,
        sensors: PlantSensors<R>,
    ) -> Self
    where
        R: 'static,
        M: Clone + Debug + Send + Sync + 'static,
        F: Fn(&PlantMeasurement<R>, &mut M, &mut [Option<RuntimeCommand<R>>]) + Send + Sync + 'static,
    {
        Self::new(adapter::ByFunction { function, memory }, valves, sampling, sensors)
    }

    /// Says which set points it follows: where the plant settles to repeats with them.
    pub fn with_set_points<'p>(mut self, set_points: impl IntoIterator<Item = &'p SetPoint<R>>) -> Self
    where
        R: 'p,
    {
        // A driver that has just been made has its plan for itself.
        if let Some(Plan { course: (frequencies, last_change), .. }) = Arc::get_mut(&mut self.plan) {
            for set_point in set_points {
                frequencies.extend(set_point.frequency().map(Real::value));
                *last_change = last_change.max(set_point.last_change().value());
            }
        }
        self
    }

    /// The valves that it commands.
    pub fn valves(&self) -> &[usize] {
        &self.plan.valves
    }

    /// When it measures, and when its decisions take effect.
    pub fn sampling(&self) -> &Sampling<R> {
        &self.plan.sampling
    }

    /// The next sampling instant in s.
    pub fn next(&self) -> R {
        self.sampled.next(&self.plan.sampling)
    }

    /// What was decided last; none before the first sampling instant.
    pub fn last(&self) -> Option<&PlantDecision<R>> {
        self.last.as_deref()
    }

    /// Takes the sample that is due; what its valves are to do from now on.
    pub(crate) fn take(&mut self, truth: PlantMeasurement<R>) -> Option<Demands<R>> {
        let plan = self.plan.clone();
        let seen = plan.sensors.show(truth);
        let mut commands = vec![None; plan.valves.len()];
        let mut aims = Vec::new();
        let effective = self.sampled.take(&plan.sampling, |unit| {
            unit.decide(&seen, &mut commands);
            aims = unit.aims(&seen);
            commands.clone()
        });
        self.last = Some(Arc::new(PlantDecision { seen, aims, commands }));
        effective
    }

    /// That a plant has the parts that drivers need, and that no valve has two of them.
    ///
    /// # Errors
    /// [`Error::Misuse`] otherwise.
    pub(crate) fn check_all(
        drivers: &[Self],
        valves: usize,
        actuators: usize,
        coordinates: &[usize],
    ) -> Result<(), Error> {
        let wrong = |what, remedy| Err(Error::Misuse { what, remedy });
        let mut taken = vec![false; valves];
        for plan in drivers.iter().map(|driver| &driver.plan) {
            for &valve in &plan.valves {
                match taken.get_mut(valve) {
                    None => return wrong("a driver commands a valve that is not there", "name a valve of the network"),
                    Some(true) => {
                        return wrong(
                            "a valve has two drivers",
                            "let one driver command each valve, or decide both in one controller",
                        );
                    }
                    Some(free) => *free = true,
                }
            }
            let joint = |(mechanism, coordinate): (usize, usize)| {
                coordinates.get(mechanism).is_some_and(|count| coordinate < *count)
            };
            if plan.needs.actuators.iter().any(|actuator| *actuator >= actuators) || !plan.needs.joint.is_none_or(joint)
            {
                return wrong(
                    "a driver measures an actuator or a joint that is not there",
                    "name actuators and joints of the plant",
                );
            }
        }
        Ok(())
    }

    /// That the span between two times in s has no more samples and pulses than a run may have.
    ///
    /// # Errors
    /// [`Error::TooMany`] otherwise.
    pub(crate) fn check_counts(&self, span: f64) -> Result<(), Error> {
        self.plan.sampling.check_counts(span)
    }
}

/// What the search for an orbit asks.
#[cfg(feature = "analysis")]
impl<R: Real> Driver<R> {
    /// Frequencies in Hz of the set points that it follows.
    pub(crate) fn frequencies(&self) -> &[f64] {
        &self.plan.course.0
    }

    /// The time in s from which on its set points change no more but by their frequencies.
    pub(crate) fn last_change(&self) -> f64 {
        self.plan.course.1
    }

    /// Whether what was decided last is what was decided then, apart from numbers that differ by a part of 1.
    pub(crate) fn decided_as(&self, then: Option<&PlantDecision<R>>, part: f64) -> bool {
        let near = |a: R, b: R| (a - b).value().abs() <= part * a.value().abs().max(b.value().abs()).max(1.0);
        let alike = |pair: (&Option<RuntimeCommand<R>>, &Option<RuntimeCommand<R>>)| match pair {
            (
                Some(RuntimeCommand::Pulses { duty, pulse, rest, frequency }),
                Some(RuntimeCommand::Pulses { duty: other, pulse: up, rest: down, frequency: at }),
            ) => near(*duty, *other) && (pulse, rest, frequency) == (up, down, at),
            (Some(RuntimeCommand::SetPoint(set)), Some(RuntimeCommand::SetPoint(other))) => near(set.0, other.0),
            (Some(RuntimeCommand::Position(set)), Some(RuntimeCommand::Position(other))) => near(*set, *other),
            (now, then) => now == then,
        };
        match (self.last(), then) {
            (Some(now), Some(then)) => now.commands.iter().zip(&then.commands).all(alike),
            (now, then) => now.is_none() && then.is_none(),
        }
    }
}
