//! Two ways through time, one physics.
//!
//! * *Event-located*: adaptive steps of high order, every switching instant, stick, slip, slack and taut located; the
//!   reference that everything is compared with. It is the [plant's](crate::plant): [`simulate`] runs a rig of one actuator,
//!   [`JointPlant`](crate::plant::JointPlant) a joint.
//! * *Fixed-step*: bounded cost, valve edges honoured inside the step; for hosts, batches and real time:
//!   [`TimeStepping::Fixed`](crate::plant::TimeStepping), [`PlantSteps`](crate::plant::PlantSteps). How far fixed steps lie from the
//!   other, and the step that an accuracy needs, is measured by a [`PlantReference`](crate::plant::PlantReference).
//!
//! With a [controller](crate::control) that decides the valve's command both take a [driver](crate::plant::RigPlant::driver).
//! [`FixedStepper`] and [`JointStepper`] are earlier forms of the second.
//!
//! Whoever moves the ends and drives the valve in a loop of his own takes a [`ModularActuator`]; [`LegStepper`] is such a loop.
//! Several on one supply are a [plant](crate::plant) whose ends a host [moves](crate::plant::PlantSteps::move_to).

mod chain;
pub(crate) mod course;
#[cfg(feature = "alloc")]
pub(crate) mod decision;
pub(crate) mod fixed_step;
pub(crate) mod joint;
pub(crate) mod kernel;
#[cfg(feature = "alloc")]
mod leg;
#[cfg(feature = "alloc")]
pub(crate) mod member;
mod mode;
#[cfg(feature = "alloc")]
mod modular;
#[cfg(feature = "alloc")]
mod pieces;
pub(crate) mod piped;
mod pressure_course;
mod reading;
mod regulated;
pub(crate) mod rig;
pub(crate) mod sample;
#[cfg(feature = "alloc")]
mod snapshot;
mod tendon_step;
pub(crate) mod timetable;
#[cfg(feature = "alloc")]
pub(crate) mod told;

pub use crate::load::SeriesTendon;
#[cfg(feature = "alloc")]
pub use crate::plant::{simulate, simulate_in_segments};
#[cfg(feature = "alloc")]
pub use decision::{Decision, JointDecision};
pub use fixed_step::FixedStepper;
pub use joint::{Driven, Fittings, InitialAngle, JointInitial, JointRig, JointState, JointSupply};
#[cfg(feature = "alloc")]
pub use joint::{JointCourse, JointSample, JointStepper};
pub use kernel::{Held, Method};
#[cfg(feature = "alloc")]
pub use leg::{LegSample, LegStepper};
pub use mode::{EventKind, Extent, Guard, Mode, Sliding};
#[cfg(feature = "alloc")]
pub use modular::{MOST_PARTS, ModularActuator};
pub use pressure_course::PressureCourse;
pub use reading::{Readable, Reading};
pub use rig::{Actuation, Initial, InitialLength, Rig, State};
pub use sample::{Sample, SampleTimes, steps_between};
#[cfg(feature = "alloc")]
pub use snapshot::Snapshot;
