//! A scenario as a plant that a host steps: commands in, tensions and pressures out, by names and by numbers.
//!
//! ```text
//! read        a scenario of any kind: one actuator, a joint, many actuators on one air network
//! command     a number for each valve, in the mode of that valve: see `command`
//! advance     all ends go in straight lines to their distances, in m, and everything else to a time, in s
//! compute_at  tensions with their derivatives, where the ends are
//! outputs     the columns of a run, as many numbers in the same order
//! begin_at    begin again, with the ends where the host has them
//! save, restore   the whole state as numbers in the host's memory
//! ```
//!
//! [`HostPlant`] is one plant, and [`HostBatch`] many that are stepped side by side.
//!
//! A plug-in of a robot's simulator, a functional mock-up unit and a library for C are adapters over this: they hold no physics,
//! and a test of each proves that its trajectory is this one's. Nothing here is global, and once begun no step
//! allocates.
//!
//! The ends are either the host's ([`Motion::Host`]): it owns masses, joints and contacts, gives distances and takes
//! tensions; or the scenario's ([`Motion::Scenario`]): then loads and mechanisms move as the file says.
//!
//! ```
//! use mckibben_run::host::{HostOptions, HostPlant};
//! use mckibben_scenario::Document;
//!
//! let text = r#"
//! [supply]
//! gauge_pressure = "100 psi"
//! [valve]
//! preset = "matrix-eight-channel"
//! [command]
//! kind = "pwm"
//! frequency = "25 Hz"
//! duty = 0.5
//! [load]
//! kind = "isometric"
//! [initial]
//! length = "90 mm"
//! [run]
//! duration = "1 s"
//! "#;
//! let document = Document::parse(text, "muscle.toml")?;
//! let mut host = HostPlant::read(&document, &HostOptions::default())?;
//! assert_eq!(host.commands()[0].name, "actuator.duty");
//! host.command(0, 0.8)?;
//! for step in 1..=500 {
//!     host.advance(f64::from(step) * 1e-3, &[0.09])?;
//! }
//! assert!(host.steps_mut().compute(0)?.tension > 100.0);
//! # Ok::<(), mckibben_run::failure::Failure>(())
//! ```
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 4, the modular actuator. Checked by `tests/host/`.

mod batch;
pub mod command;
mod ends;
mod experiment;
mod mark;
mod model;
mod plant;

pub use batch::HostBatch;
pub use command::{COMMAND_MODES, CommandMode, Pulses};
pub use ends::GREATEST_MOTION;
pub use experiment::{experiment_of, experiment_of_one, open};
pub use mark::mark;
pub use model::{CommandInput, HostModel, HostOptions, Motion, command_inputs};
pub use plant::HostPlant;

use mckibben::internals::SIMULTANEOUS;

/// The end in s of a step of `step` s from a time: the next multiple of `step` where the time is one.
///
/// A sum of equal steps drifts by a rounding in each. A duty cycle that is set where a pulse begins would then come after
/// that begin, and count from the next pulse on. Where a pulse takes whole steps, steps that meet its begin lie at multiples
/// of the step: so no state need count them, and any state goes on in this way.
pub fn end_of_step(from: f64, step: f64) -> f64 {
    let until = from + step;
    let multiple = (until / step).round() * step;
    if (multiple - until).abs() <= SIMULTANEOUS * until { multiple } else { until }
}
