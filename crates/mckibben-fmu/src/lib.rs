//! Functional mock-up units: a scenario as a file that other simulators step, by FMI 2.0 and FMI 3.0.
//!
//! | module | what it holds |
//! |---|---|
//! | [`options`] | what is chosen when a unit is written |
//! | [`model`] | a scenario with its variables, as the unit's library reads it from the unit |
//! | [`variables`] | names, value references, units, ranges and start values |
//! | `tunable` | which parameters a host may change while a unit runs |
//! | [`description`] | `modelDescription.xml` of either version |
//! | [`export`], [`archive`] | the file: description, library, scenario |
//! | [`instance`] | an instance between two calls of its host: values, steps, events, saved states |
//! | `abi` | the functions of both versions, as C calls them |
//!
//! One library serves every scenario and both versions: it reads the scenario from the unit's resources. It is an adapter
//! over [`mckibben_run::host`] and [`mckibben::plant::PlantExchange`] and holds no physics.
//!
//! Sources: FMI 2.0.4 and FMI 3.0.2, fmi-standard.org. Checked by `tests/` here and, in FMPy, by
//! `python/tests/test_fmu.py`.

mod abi;
pub mod archive;
pub mod description;
pub mod export;
pub mod instance;
pub mod model;
pub mod options;
mod tunable;
pub mod variables;

/// The name of the library within a unit.
pub const MODEL_IDENTIFIER: &str = "mckibben";
