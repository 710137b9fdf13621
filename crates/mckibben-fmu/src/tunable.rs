//! Which parameters a host may change while a unit runs.
//!
//! A parameter is tunable if the states of the plant can stay as they are when it changes: a flow, a damping, a weight. Fixed
//! are starts, dimensions, the gas, motions given over time, and what decides which parts there are.

use mckibben::network::{Network, Node, NodeKind};
use mckibben::parameter;
use mckibben_run::host::experiment_of;
use mckibben_scenario::{Document, DocumentNumber};

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

/// By how much a pressure in Pa is changed to see whether the plant changes.
const NUDGE: f64 = 1.0;

/// Whether a number of a document can be changed while its unit runs.
pub(crate) fn is_tunable(document: &Document, number: &DocumentNumber) -> bool {
    TUNABLE.contains(&number.key) && !(number.key == parameter::SUPPLY_GAUGE_PRESSURE.key && is_start(document, number))
}

/// Whether a number only says how the plant starts: the pressure of a supply is that of its air at the start where it has a
/// volume and no regulator, its own or of another supply that follows it.
fn is_start(document: &Document, number: &DocumentNumber) -> bool {
    let given = |value: f64| {
        let mut document = document.clone();
        document.set_in_si("parameter of the unit", &number.path, &format!("{value:?}")).ok()?;
        Some(given_pressures(experiment_of(&document).ok()?.plant.network()))
    };
    let nudged = given(number.value + NUDGE).or_else(|| given(number.value - NUDGE));
    nudged.is_some() && nudged == given(number.value)
}

/// The gauge pressures in Pa of a network that are no states: of its mains, and what regulators are set to and fed by.
fn given_pressures(network: &Network) -> Vec<f64> {
    let of = |node: &Node| match node.kind {
        NodeKind::Source => Some(node.gauge),
        NodeKind::Outlet { set, .. } => Some(set),
        NodeKind::Port { feed, .. } => Some(feed),
        _ => None,
    };
    network.nodes.iter().filter_map(of).collect()
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
