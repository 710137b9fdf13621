//! Braided pneumatic actuators as an engine plugin of MuJoCo, with the air, valves and hoses that they share.
//!
//! ```text
//! MuJoCo                          plugin                                   mckibben-run::host
//! actuator_length, _velocity  →   distance = length + length_offset    →   compute_at, advance
//! ctrl                        →   duty cycle, request, position, set point → command
//! actuator_force              ←   −tension (a muscle pulls)            ←   compute_at
//! plugin_state, act           ↔   the whole state as numbers; gauge pressures
//! sensordata                  ←   an output by the sensor's name       ←   read_outputs
//! ```
//!
//! An instance is one plant: a single muscle, or the actuators of a scenario file with their common tank, manifold and
//! hoses. There is no physics here, and nothing global: what an instance needs lies in its `mjData`.
//!
//! | module | what it holds |
//! |---|---|
//! | `config` | attributes of an instance to a scenario and options |
//! | `instance` | one plant in a model: names, start, forces, the step, sensors |
//! | `callbacks` | what MuJoCo calls, and the way from its memory to an instance |
//! | `view` | fields of `mjModel` and `mjData` |
//! | `layout` | where those fields are, by MuJoCo's version |
//! | `library` | MuJoCo's own functions, found in the library that is loaded |
//!
//! One binary serves many versions of MuJoCo: it links to none, finds the one that is loaded, and refuses a version whose
//! structures it does not know. Checked in MuJoCo itself by `python/tests/test_mujoco.py`.

#[cfg(target_os = "linux")]
mod callbacks;
mod config;
mod instance;
#[cfg(target_os = "linux")]
mod layout;
#[cfg(target_os = "linux")]
mod library;
#[cfg(target_os = "linux")]
mod view;

/// The name by which a model refers to the plugin.
pub const PLUGIN: &str = "mckibben.muscle";

/// Registers the plugin with the MuJoCo that is loaded in this process; registering it again changes nothing.
///
/// # Errors
/// In words: when no MuJoCo is loaded, when its version is not supported, and where this system is not.
#[cfg(target_os = "linux")]
pub fn register() -> Result<(), String> {
    callbacks::register()
}

/// Says that this system is not supported.
///
/// # Errors
/// Always.
#[cfg(not(target_os = "linux"))]
pub fn register() -> Result<(), String> {
    Err("the plugin for MuJoCo is for Linux so far; step the plant alongside MuJoCo with mckibben.mujoco.Driver"
        .to_owned())
}

/// The versions of MuJoCo that the plugin knows, as `mj_version()` numbers.
pub fn versions() -> Vec<i32> {
    #[cfg(target_os = "linux")]
    let known = layout::versions();
    #[cfg(not(target_os = "linux"))]
    let known = Vec::new();
    known
}
