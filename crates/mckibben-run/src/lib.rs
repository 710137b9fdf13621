//! A scenario of any kind to a result: trajectory, columns, events, static curves, linear model, sweep, identification, the
//! paper's experiments; each with its figure and its files.
//!
//! | module | what it holds |
//! |---|---|
//! | [`settle`] | the periodic orbit or equilibrium that a run comes to |
//! | [`run`] | whatever a scenario describes, run; its columns, events and figure |
//! | [`curves`] | force, stiffness and volume over length |
//! | [`linearize`] | the linear model at an operating point |
//! | [`sweep`] | many runs of one scenario |
//! | [`design`] | a constrained search for the best values of keys |
//! | [`identify`] | measured data to the numbers of a scenario |
//! | [`reproduce`] | the paper's experiments as a report |
//! | [`engine`], [`closed_loop`] | a run by the engine that the scenario names, and a controller's part in it |
//! | [`host`] | any scenario as a plant that another simulator steps |
//! | [`observation`], [`summary`] | the figures of a run: extremes, ripple, air used, energy; as numbers with names |
//! | [`joint`], [`plant`] | all of this for a joint of two actuators, and for plants with names |
//! | [`events`] | the log of events |
//! | [`warnings`] | what a scenario cannot mean, before a run and by what it reached |
//! | [`record`] | a run as columns, in memory and in a file |
//! | [`table`] | columns and cells, and the writer of them as CSV or Parquet |
//! | [`figure`], [`axis`] | runs as a figure, and the horizontal axes that figures may have |
//! | [`report`] | figures, tables and findings as a page |
//! | [`output`] | files that are whole or not there |
//! | [`progress`] | how far work is, for a listener |
//! | [`failure`] | why something could not be done |
//! | [`units`] | the units in which results are shown |
//! | [`quantities`], [`text`] | numbers with units, lines and aligned columns, for people |
//!
//! Requests are typed and so are failures; nothing here reads arguments, prints, or knows a terminal. The program, the Python
//! package and other hosts are built on this.

#![forbid(unsafe_code)]

pub mod axis;
pub mod closed_loop;
pub mod curves;
pub mod design;
pub mod engine;
pub mod events;
pub mod failure;
pub mod figure;
pub mod host;
pub mod identify;
pub mod joint;
pub mod linearize;
pub mod observation;
pub mod output;
pub mod plant;
pub mod progress;
pub mod quantities;
pub mod record;
pub mod report;
pub mod reproduce;
pub mod run;
pub mod settle;
mod single_actuator;
pub mod size;
pub mod summary;
pub mod sweep;
pub mod table;
mod temporary;
pub mod text;
pub mod units;
pub mod warnings;
