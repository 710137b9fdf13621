//! Which parameters a host may change while a unit runs.
//!
//! A parameter is tunable if the states of the plant can stay as they are when it changes: a flow, a damping, a weight. Fixed
//! are starts, dimensions, the gas, motions given over time, and what decides which parts there are.

use mckibben_scenario::DocumentNumber;

/// Keys of a scenario file.
const TUNABLE: [&str; 49] = [
    "actuator.leakage",
    "actuator.force.end_factor",
    "actuator.force.end_factor_rise",
    "actuator.force.end_factor_pressure",
    "actuator.effectiveness.constant",
    "actuator.friction.viscous",
    "actuator.friction.structural_damping",
    "actuator.friction.coulomb_width",
    "actuator.friction.coulomb_force",
    "actuator.friction.coulomb_force_per_pressure",
    "actuator.limit.stiffness",
    "actuator.limit.damping",
    "air.heat_transfer",
    "air.wall_temperature",
    "supply.gauge_pressure",
    "supply.temperature",
    "supply.compressor_displacement",
    "supply.cut_in_gauge_pressure",
    "supply.cut_out_gauge_pressure",
    "valve.flow_area",
    "valve.sonic_conductance",
    "valve.critical_ratio",
    "valve.kv",
    "valve.cv",
    "valve.efficiency",
    "valve.dead_time",
    "valve.opening_delay",
    "valve.closing_delay",
    "valve.exhaust.flow_area",
    "valve.exhaust.sonic_conductance",
    "valve.exhaust.critical_ratio",
    "valve.exhaust.kv",
    "valve.exhaust.cv",
    "tendon.stiffness",
    "load.mass",
    "load.gravity",
    "load.force",
    "load.inertia",
    "load.torque",
    "load.damping",
    "mechanism.mass",
    "mechanism.gravity",
    "mechanism.force",
    "mechanism.spring_stiffness",
    "mechanism.joints.*.mass",
    "mechanism.joints.*.inertia",
    "mechanism.joints.*.torque",
    "mechanism.joints.*.damping",
    "mechanism.belt.velocity",
];
/// Of these zero is another thing than a small number: a muscle without dry friction never sticks.
const APART_FROM_ZERO: [&str; 4] = [
    "actuator.leakage",
    "actuator.friction.coulomb_width",
    "actuator.friction.coulomb_force",
    "actuator.friction.coulomb_force_per_pressure",
];

/// Whether a number of a scenario can be changed while its unit runs.
pub(crate) fn is_tunable(number: &DocumentNumber) -> bool {
    TUNABLE.contains(&number.key)
}

/// Whether a change adds or removes a part of the plant.
pub(crate) fn changes_parts(number: &DocumentNumber, from: f64, to: f64) -> bool {
    APART_FROM_ZERO.contains(&number.key) && (from == 0.0) != (to == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mckibben_scenario::keys;

    #[test]
    fn tunable_parameters_are_keys_of_scenario_files() {
        for key in TUNABLE.iter().chain(&APART_FROM_ZERO) {
            assert!(keys::key_at(key).is_some(), "{key}");
        }
        assert!(APART_FROM_ZERO.iter().all(|key| TUNABLE.contains(key)));
    }
}
