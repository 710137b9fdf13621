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
//! A caller that moves the ends and drives the valve in a custom loop takes a [plant](crate::plant) whose ends a host
//! [moves](crate::plant::PlantSteps::move_to).

#[cfg(feature = "alloc")]
pub(crate) mod decision;
pub(crate) mod joint;
#[cfg(feature = "alloc")]
pub(crate) mod member;
mod mode;
#[cfg(feature = "alloc")]
mod pieces;
mod pressure_series;
mod reading;
pub(crate) mod rig;
pub(crate) mod sample;

pub use crate::load::SeriesTendon;
#[cfg(feature = "alloc")]
pub use crate::plant::steps::{MOST_PARTS, Method};
#[cfg(feature = "alloc")]
pub use crate::plant::{simulate, simulate_in_segments};
#[cfg(feature = "alloc")]
pub use decision::{Decision, JointDecision};
#[cfg(feature = "alloc")]
pub use joint::JointSample;
pub use joint::{Driven, Fittings, InitialAngle, JointInitial, JointRig, JointState, JointSupply};
pub use mode::{EventKind, Guard, LengthRegime, Mode, Sliding};
pub use pressure_series::PressureSeries;
pub use reading::{Readable, Reading};
pub use rig::{Actuation, Initial, InitialLength, Rig, State};
pub use sample::{Sample, SampleTimes, steps_between};
