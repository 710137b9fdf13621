//! `[sweep]`: many runs of one scenario, on all cores, into files that need no merge.
//!
//! ```text
//! plan ──> units of rows ──> schedule (threads) ──> in row order ──> lines of a table ──> part, CSV
//!               │                                        │
//!          rows, reduce                                counts ─> summary, chart
//! ```
//!
//! | module | its idea |
//! |---|---|
//! | [`prepared`] | a sweep that is ready to be done, by this process or part by part by any others |
//! | [`plan`] | which rows make a part, which parts a shard, which rows a unit of work |
//! | [`step`] | the step of the fixed-step engine, one for all rows |
//! | [`rows`] | the runs of a unit: side by side at fixed steps, else individually |
//! | `plant` | what is made of the run of a plant |
//! | [`reduce`] | a run as a few numbers |
//! | `series` | quantities over a run, and over the orbit behind it |
//! | [`schedule`] | units on threads, results in order, a bounded number of them |
//! | [`table`] | columns, and a run as lines of them |
//! | [`destination`] | where the lines go |
//! | [`folder`] | the parts of a sweep, finished or to be done |
//! | [`read`] | the reductions of a finished part |
//! | [`warned`] | the warnings of the runs, counted |
//! | [`counts`] | what is printed and drawn of the runs |
//! | [`chart`] | lines, maps and scatter plots of the reductions |
//!
//! What a run comes to depends on its row alone: not on the unit, part, shard, thread or engine batch that it is in.
//! Checked by the program's `tests/sweep.rs`.

pub mod chart;
pub mod counts;
pub mod destination;
pub mod folder;
pub mod plan;
mod plant;
pub mod prepared;
pub mod read;
pub mod reduce;
pub mod rows;
pub mod schedule;
mod series;
pub mod step;
pub mod table;
pub mod warned;
