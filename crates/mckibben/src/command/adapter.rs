//! Controllers as drivers see them: of one actuator, of a joint, and by a function.

use super::{PlantController, PlantMeasurement};
use crate::control::{Controller, Drive, JointController, Quantity};
use crate::scalar::Real;
use crate::valve::RuntimeCommand;
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::fmt::{self, Debug};

/// A controller with its memory, whatever its type.
pub(super) trait Unit<R: Real>: Debug + Send + Sync {
    fn decide(&mut self, seen: &PlantMeasurement<R>, commands: &mut [Option<RuntimeCommand<R>>]);
    fn aims(&self, seen: &PlantMeasurement<R>) -> Vec<(Quantity, R)>;
    fn copy(&self) -> Box<dyn Unit<R>>;
}

impl<R: Real> Clone for Box<dyn Unit<R>> {
    fn clone(&self) -> Self {
        (**self).copy()
    }
}

#[derive(Debug)]
struct WithMemory<C, M> {
    controller: Arc<C>,
    memory: M,
}

impl<R, C> Unit<R> for WithMemory<C, C::Memory>
where
    R: Real + 'static,
    C: PlantController<R, Memory: Send + Sync> + Debug + Send + Sync + 'static,
{
    fn decide(&mut self, seen: &PlantMeasurement<R>, commands: &mut [Option<RuntimeCommand<R>>]) {
        self.controller.decide(seen, &mut self.memory, commands);
    }

    fn aims(&self, seen: &PlantMeasurement<R>) -> Vec<(Quantity, R)> {
        self.controller.aims(seen)
    }

    fn copy(&self) -> Box<dyn Unit<R>> {
        Box::new(Self { controller: self.controller.clone(), memory: self.memory.clone() })
    }
}

/// A controller before its first sampling instant.
pub(super) fn unit<R, C>(controller: C) -> Box<dyn Unit<R>>
where
    R: Real + 'static,
    C: PlantController<R, Memory: Send + Sync> + Debug + Send + Sync + 'static,
{
    let memory = controller.begin();
    Box::new(WithMemory { controller: Arc::new(controller), memory })
}

/// The command of a drive to a valve whose pulses have a frequency in Hz.
fn command<R: Real>(drive: Drive<R>, frequency: R) -> RuntimeCommand<R> {
    match drive {
        Drive::Steady(request) => RuntimeCommand::Request(request),
        Drive::Pulses { duty, pulse, rest } => RuntimeCommand::Pulses { frequency, duty, pulse, rest },
    }
}

/// A controller of one actuator of a plant.
#[derive(Debug)]
pub(super) struct OnActuator<C, R> {
    pub(super) controller: C,
    pub(super) actuator: usize,
    pub(super) pulse_frequency: R,
}

impl<R: Real, C: Controller<R>> PlantController<R> for OnActuator<C, R> {
    type Memory = C::Memory;

    fn begin(&self) -> C::Memory {
        self.controller.begin()
    }

    fn decide(&self, seen: &PlantMeasurement<R>, memory: &mut C::Memory, commands: &mut [Option<RuntimeCommand<R>>]) {
        if let (Some(seen), [its]) = (seen.actuators.get(self.actuator), commands) {
            *its = Some(command(self.controller.decide(seen, memory), self.pulse_frequency));
        }
    }

    fn aims(&self, seen: &PlantMeasurement<R>) -> Vec<(Quantity, R)> {
        seen.actuators.get(self.actuator).and_then(|seen| self.controller.aim(seen)).into_iter().collect()
    }
}

/// A controller of two actuators about a joint of a plant.
#[derive(Debug)]
pub(super) struct OnJoint<C, R> {
    pub(super) controller: C,
    pub(super) joint: (usize, usize),
    pub(super) actuators: [usize; 2],
    pub(super) pulse_frequency: R,
}

impl<R: Real, C: JointController<R>> PlantController<R> for OnJoint<C, R> {
    type Memory = C::Memory;

    fn begin(&self) -> C::Memory {
        self.controller.begin()
    }

    fn decide(&self, seen: &PlantMeasurement<R>, memory: &mut C::Memory, commands: &mut [Option<RuntimeCommand<R>>]) {
        let Some(seen) = seen.of_joint(self.joint, self.actuators) else { return };
        for (its, drive) in commands.iter_mut().zip(self.controller.decide(&seen, memory)) {
            *its = Some(command(drive, self.pulse_frequency));
        }
    }

    fn aims(&self, seen: &PlantMeasurement<R>) -> Vec<(Quantity, R)> {
        let aims = seen.of_joint(self.joint, self.actuators).map(|seen| self.controller.aim(&seen));
        aims.into_iter().flatten().flatten().collect()
    }
}

/// A function with what it remembers at the start.
pub(super) struct ByFunction<M, F> {
    pub(super) function: F,
    pub(super) memory: M,
}

impl<M: Debug, F> Debug for ByFunction<M, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ByFunction").field("memory", &self.memory).finish_non_exhaustive()
    }
}

impl<R, M, F> PlantController<R> for ByFunction<M, F>
where
    R: Real,
    M: Clone + Debug,
    F: Fn(&PlantMeasurement<R>, &mut M, &mut [Option<RuntimeCommand<R>>]),
{
    type Memory = M;

    fn begin(&self) -> M {
        self.memory.clone()
    }

    fn decide(&self, seen: &PlantMeasurement<R>, memory: &mut M, commands: &mut [Option<RuntimeCommand<R>>]) {
        (self.function)(seen, memory, commands);
    }
}
