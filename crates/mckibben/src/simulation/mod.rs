//! Two ways through time, one physics.
//!
//! * [`simulate`]: adaptive steps of high order, every switching instant, stick, slip, slack and taut located; the
//!   reference that everything is compared with. Its rules for events are in [`event`].

mod arc;
pub mod event;
mod explicit;
mod hybrid;
mod integrator;
mod mode;
mod rig;
mod rosenbrock;
pub mod system;
#[cfg(feature = "alloc")]
mod trajectory;

pub use arc::Arc;
pub use hybrid::{Phase, RigSystem};
pub use integrator::{Counts, Integrator, Piece};
pub use mode::{EventKind, Extent, Guard, Mode, Sliding};
pub use rig::{Actuation, Initial, InitialLength, Rig, State};
#[cfg(feature = "alloc")]
pub use trajectory::{Event, Sample, Trajectory, simulate};
