//! Batches of plants: many of equal structure, each with its own numbers, commands and start, stepped together.
//!
//! A step is taken side by side, by as many plants as two registers of this machine have lanes, with masks where their discrete
//! states differ. What ends a mode is watched in lanes; a plant with an event repeats the step as a scalar instance, which
//! locates the event. Where valves move or controllers sample, each plant goes to its own instant. Some are scalar instances from the start:
//! while air in a hose goes at the speed of sound, and plants with parts that [`PlantBatch::covers`] leaves out.
//!
//! A host that moves the ends of actuators gives distances to [`PlantBatch::move_to`], and gets tensions from
//! [`PlantBatch::compute_at`].
//!
//! | file | what it holds |
//! |---|---|
//! | `batch`, `group` | rows, dealt to blocks; threads over blocks |
//! | `lanes` | blocks one after the other, whatever the width |
//! | `block` | rows in lanes, and how they go through time together |
//! | `held`, `flows` | the discrete states of all lanes, as masks |
//! | `motion`, `hosted` | ends that a host moves |
//! | `kept` | what a step knows exactly |
//! | `watch`, `ends`, `facets` | the range that each quantity keeps as long as a mode lasts |
//! | `wide`, `pair`, `width` | registers as one scalar, and which of them this machine has |
//! | `precision` | the numbers that lanes hold |
//! | `deal` | the numbers of plants, dealt to lanes |
//!
//! The physics is that of the crate `mckibben`, over another scalar.
//!
//! Checked by `tests/`: every row is bit-identical to a scalar instance, [`PlantSteps`](mckibben::plant::PlantSteps); with the feature
//! `f32` also lanes of single precision, against those of double.

#![forbid(unsafe_code)]

mod batch;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod block;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod deal;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod ends;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod facets;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod flows;
mod group;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod held;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod hosted;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod kept;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod lanes;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod motion;
#[cfg(target_arch = "x86_64")]
mod pair;
mod precision;
mod row;
mod span;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod watch;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod wide;
mod width;

pub use batch::PlantBatch;
pub use precision::Precision;
pub use width::Width;
