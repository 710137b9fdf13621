//! What is known before a run: from the commands of the valves, the pressures that are given, and the start.

use super::{PRESSURE, Parts, STRETCH, Warning, behind, fed, reached, valve};
use crate::quantities::{given, quantity};
use mckibben::control::{Quantity, SetPoint};
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::plant::{Plant, PlantStart};
use mckibben::valve::Port;

/// A share of a length that is rounding of its unit.
const ROUNDING: f64 = 1e-9;

/// The warnings of a plant at its start.
pub(super) fn warnings(of: &Parts<'_>, start: &PlantStart) -> Vec<Warning> {
    let mut found = valve::warnings(of);
    found.extend(of_network(of));
    for (index, name) in of.actuators.iter().enumerate() {
        found.extend(of_actuator(of, start, index, name));
    }
    found
}

/// The pressures and the length at which an actuator starts.
fn of_actuator(of: &Parts<'_>, start: &PlantStart, index: usize, name: &str) -> Vec<Warning> {
    let mut found = Vec::new();
    let (Some(mounted), Some(air)) = (of.plant.actuators().get(index), start.air.get(index)) else { return found };
    let (gauge, key) = match &mounted.pressure {
        Some(series) => (series.greatest().0, "pressure.gauge_pressure"),
        None => (air.gauge_pressure.0, "initial.gauge_pressure"),
    };
    if gauge > PRESSURE {
        found.push(reached::beyond_pressure(name, &format!("{key} = {} is", given(gauge, "Pa")), key));
    }
    let positions = start.positions.get(mounted.mechanism);
    let mechanism = &of.plant.mechanisms()[mounted.mechanism];
    let on_tendon = start.lengths.get(index).copied().flatten();
    let spanned = || positions.map(|positions| mounted.coupling.span(mechanism, positions));
    let Some(length) = on_tendon.or_else(spanned) else { return found };
    let limits = mounted.actuator.limits();
    if length < limits.min_length() * (1.0 - ROUNDING) {
        let text = format!(
            "it starts slack, {} long, below actuator.min_length = {}: the muscle cannot be so short; raise {}",
            quantity(length, "m"),
            quantity(limits.min_length(), "m"),
            reached::key_of_length(mechanism),
        );
        found.push(Warning::new("starts-slack", name, text));
    }
    if length > limits.max_length() * (1.0 + STRETCH) {
        found.push(reached::overstretched(name, "starts at", length, limits.max_length(), mechanism));
    }
    found
}

/// The pressures of what feeds the valves.
fn of_network(of: &Parts<'_>) -> Vec<Warning> {
    let network = of.plant.network();
    let mut found: Vec<Warning> = Vec::new();
    for (index, node) in network.nodes.iter().enumerate() {
        let NodeKind::Given { series, .. } = node.kind else { continue };
        let greatest = network.series[series].greatest().0;
        if greatest > PRESSURE {
            let text = format!("pressure.gauge_pressure = {} is", given(greatest, "Pa"));
            let name = behind(network, index).and_then(|actuator| of.actuators.get(actuator));
            found.push(reached::beyond_pressure(name.map_or("", String::as_str), &text, "pressure.gauge_pressure"));
        }
    }
    for index in 0..network.valves.len() {
        let name = of.valves.get(index).map_or("", String::as_str);
        let Some(feed) = feed(network, index) else { continue };
        if feed > PRESSURE && fed(network, index).is_some() {
            let text = format!("supply.gauge_pressure = {} is", given(feed, "Pa"));
            found.push(reached::beyond_pressure(name, &text, "supply.gauge_pressure"));
        }
    }
    found
}

/// The gauge pressure in Pa of what feeds a valve, where it does not change.
fn feed(network: &Network, valve: usize) -> Option<f64> {
    let is_fed = |kind: &BranchKind| match kind {
        BranchKind::Path { valve: its, port, .. } => *its == valve && *port == Port::Supply,
        _ => false,
    };
    let from = network.branches.iter().find(|branch| is_fed(&branch.kind))?.from;
    let node = &network.nodes[from];
    match node.kind {
        NodeKind::Source => Some(node.gauge),
        NodeKind::Port { feed, .. } => Some(feed),
        _ => None,
    }
}

/// What is wrong with a gauge pressure in Pa that an actuator is to have, where the supply of its valve cannot make it.
pub(crate) fn feed_of(plant: &Plant, actuator: usize, gauge: f64) -> Option<String> {
    let network = plant.network();
    let valve = (0..network.valves.len()).find(|valve| fed(network, *valve) == Some(actuator))?;
    let feed = feed(network, valve)?;
    (gauge > feed * (1.0 + ROUNDING)).then(|| {
        format!(
            "exceeds supply.gauge_pressure = {}, which cannot make it; raise supply.gauge_pressure or ask for less",
            given(feed, "Pa")
        )
    })
}

/// The set points of a controller, against the supply of the only valve.
pub(super) fn of_set_points(of: &Parts<'_>, set_points: &[(Quantity, SetPoint)]) -> Option<Warning> {
    let feed = feed(of.plant.network(), 0)?;
    let pressures = set_points.iter().filter(|(quantity, _)| *quantity == Quantity::Pressure);
    let highest = pressures.map(|(_, set_point)| set_point.ends()[1]).reduce(f64::max)?;
    (highest > feed * (1.0 + ROUNDING)).then(|| exceeded("", "command.set_point", highest, feed))
}

fn exceeded(name: &str, key: &str, requested: f64, feed: f64) -> Warning {
    let text = format!(
        "the requested pressure {key} = {} exceeds supply.gauge_pressure = {} and is never reached; lower {key} or raise \
         supply.gauge_pressure",
        given(requested, "Pa"),
        given(feed, "Pa"),
    );
    Warning::new("supply-exceeded", name, text)
}
