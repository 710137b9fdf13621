//! Two ways through time, one physics.
//!
//! * [`simulate`]: adaptive steps of high order, every switching instant, stick, slip, slack and taut located; the
//!   reference that everything is compared with. Its rules for events are in [`event`].
//! * [`FixedStepper`]: bounded cost, no allocation, valve edges honoured inside the step; for hosts, batches and real time.
//!   How far it lies from the other, and the step that an accuracy needs, is measured in [`accuracy`].
//!
//! A joint that two actuators turn against each other is a plant where every event is located
//! ([`JointPlant`](crate::plant::JointPlant)), and goes through time at fixed steps by [`JointStepper`]. [`simulate_controlled`]
//! and [`ControlledStepper`] are the two with a [controller](crate::control) that decides the valve's command on the way.
//!
//! Whatever goes through time at fixed steps is a [`Stepper`].
//!
//! [`simulate_into`] keeps nothing: it hands each accepted step to a consumer, of which a [`Trajectory`] is one, and so does
//! [`simulate_controlled_into`].
//!
//! Whoever moves the ends and drives the valve in a loop of his own takes a [`ModularActuator`]; [`LegStepper`] is such a loop,
//! and a [`Manifold`] feeds several that are unlike from one supply.

#[cfg(feature = "alloc")]
pub mod accuracy;
pub(crate) mod arc;
mod chain;
#[cfg(feature = "alloc")]
mod circuit;
#[cfg(feature = "alloc")]
pub(crate) mod closed_loop;
#[cfg(feature = "alloc")]
mod controlled;
pub(crate) mod course;
#[cfg(feature = "alloc")]
mod energy;
pub mod event;
mod explicit;
pub(crate) mod fixed_step;
mod hybrid;
mod integrator;
pub(crate) mod joint;
pub(crate) mod kernel;
#[cfg(feature = "alloc")]
mod leg;
#[cfg(feature = "alloc")]
mod manifold;
pub(crate) mod member;
mod mode;
#[cfg(feature = "alloc")]
mod modular;
pub(crate) mod piped;
mod plumbing;
mod pressure_course;
mod regulated;
pub(crate) mod rig;
mod rosenbrock;
#[cfg(feature = "alloc")]
pub(crate) mod run;
pub(crate) mod sample;
#[cfg(feature = "alloc")]
mod segments;
#[cfg(feature = "alloc")]
mod series_tendon;
#[cfg(feature = "alloc")]
mod snapshot;
#[cfg(feature = "alloc")]
mod stepper;
#[cfg(feature = "alloc")]
mod stored;
pub mod system;
mod tendon_mode;
mod tendon_step;
pub(crate) mod timetable;
#[cfg(feature = "alloc")]
pub(crate) mod told;
#[cfg(feature = "alloc")]
pub(crate) mod trajectory;
pub(crate) mod zones;

pub use crate::load::SeriesTendon;
pub use arc::Arc;
#[cfg(feature = "alloc")]
pub use circuit::CircuitAudit;
#[cfg(feature = "alloc")]
pub use closed_loop::Decision;
#[cfg(feature = "alloc")]
pub use controlled::{
    Controlled, ControlledStepper, simulate_controlled, simulate_controlled_into, simulate_controlled_watched,
};
#[cfg(feature = "alloc")]
pub use energy::{EnergyAudit, Ledger};
pub use fixed_step::FixedStepper;
pub use hybrid::{Phase, RigSystem};
pub use integrator::{Counts, Integrator, Piece, PieceOf};
#[cfg(feature = "alloc")]
pub use joint::{
    ControlledJointStepper, JointCourse, JointDecision, JointSample, JointStepError, JointStepper,
    joint_step_for_accuracy,
};
pub use joint::{Driven, InitialAngle, JointInitial, JointRig, JointState};
pub use kernel::{Held, Method};
#[cfg(feature = "alloc")]
pub use leg::{LegSample, LegStepper};
#[cfg(feature = "alloc")]
pub use manifold::{Manifold, ManifoldState};
pub use mode::{EventKind, Extent, Guard, Mode, Sliding};
#[cfg(feature = "alloc")]
pub use modular::{MOST_PARTS, ModularActuator};
pub use pressure_course::PressureCourse;
pub use rig::{Actuation, Initial, InitialLength, Rig, State};
#[cfg(feature = "alloc")]
pub use run::{AcceptedStep, Consumer, Readable, Reading, RunEnd, simulate_into};
pub use sample::{Sample, SampleTimes, steps_between};
#[cfg(feature = "alloc")]
pub use segments::simulate_in_segments;
#[cfg(feature = "alloc")]
pub use series_tendon::TendonActuator;
#[cfg(feature = "alloc")]
pub use snapshot::Snapshot;
#[cfg(feature = "alloc")]
pub use stepper::Stepper;
#[cfg(feature = "alloc")]
pub use stored::STEPS_WATCHED;
#[cfg(feature = "alloc")]
pub use told::ToldStepper;
#[cfg(feature = "alloc")]
pub use trajectory::{Event, Trajectory, simulate, simulate_watched};
