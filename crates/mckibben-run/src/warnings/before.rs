//! What is known before a run: from the commands of the valves, the pressures that are given, and the start.

use super::{BEYOND_STOP, PRESSURE, Parts, STRETCH, Warning, behind, fed, reached, valve};
use crate::quantities::{given, quantity};
use mckibben::mechanism::{Coupling, Mechanism};
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::parameter;
use mckibben::plant::{Mounted, Plant, PlantRun, PlantStart};
use mckibben::valve::Port;
use mckibben_scenario::GreatestRequest;

/// The key of the pressure that feeds a valve, and of that up to which a compressor fills a tank.
const SUPPLY: &str = parameter::SUPPLY_GAUGE_PRESSURE.key;
const CUT_OUT: &str = parameter::CUT_OUT.key;
/// A share of a length, and an angle in rad, that is rounding of its unit.
const ROUNDING: f64 = 1e-9;
/// The relative tolerance of a run that is begun and goes no further.
const BEGINNING: f64 = 1e-6;

/// The warnings of a plant at its start.
pub(super) fn warnings(of: &Parts<'_>, start: &PlantStart) -> Vec<Warning> {
    let mut found = valve::warnings(of);
    found.extend(of_network(of));
    let lengths = lengths(of.plant, start);
    for (index, name) in of.actuators.iter().enumerate() {
        let length = lengths.get(index).copied().flatten();
        found.extend(of_actuator(of, start, (index, name), length));
    }
    found.extend(of_stops(of, start));
    found
}

/// The length in m at which each actuator starts, without its tendon: with one, muscle and tendon share the distance as their
/// forces balance, which the begun run has computed. None where the run cannot begin; it then fails with the reason.
fn lengths(plant: &Plant, start: &PlantStart) -> Vec<Option<f64>> {
    let has_tendon = plant.actuators().iter().any(|mounted| mounted.tendon.is_some());
    let begun = has_tendon.then(|| PlantRun::new(plant, start, BEGINNING).ok()).flatten().map(|run| run.sample());
    let length = |(index, mounted): (usize, &Mounted)| match mounted.tendon {
        Some(_) => begun.as_ref()?.actuators.get(index).map(|sample| sample.length),
        None => {
            let positions = start.positions.get(mounted.mechanism)?;
            Some(mounted.coupling.span(&plant.mechanisms()[mounted.mechanism], positions))
        }
    };
    plant.actuators().iter().enumerate().map(length).collect()
}

/// The pressures and the length in m at which an actuator starts.
fn of_actuator(of: &Parts<'_>, start: &PlantStart, (index, name): (usize, &str), length: Option<f64>) -> Vec<Warning> {
    let mut found = Vec::new();
    let (Some(mounted), Some(air)) = (of.plant.actuators().get(index), start.air.get(index)) else { return found };
    let (gauge, key) = match &mounted.pressure {
        Some(series) => (series.greatest().0, "pressure.gauge_pressure"),
        None => (air.gauge_pressure.0, "initial.gauge_pressure"),
    };
    if gauge > PRESSURE {
        found.push(reached::beyond_pressure(name, &format!("{key} = {} is", given(gauge, "Pa")), key));
    }
    let (mechanism, coupling) = (&of.plant.mechanisms()[mounted.mechanism], &mounted.coupling);
    let limits = mounted.actuator.limits();
    let apart = start.positions.get(mounted.mechanism).map(|positions| coupling.span(mechanism, positions));
    let is_point = |apart: f64| apart <= limits.min_length() * ROUNDING;
    if matches!(coupling, Coupling::Points(_)) && apart.is_some_and(is_point) {
        // The length of a muscle on a tendon does not show it.
        let text = format!(
            "it starts slack with both ends at one point, from where it has no direction to pull in; raise {}",
            reached::key_of_length(mechanism, coupling),
        );
        found.push(Warning::new("starts-slack", name, text));
        return found;
    }
    let Some(length) = length else { return found };
    if length < limits.min_length() * (1.0 - ROUNDING) {
        let text = format!(
            "it starts slack, {} long, below actuator.min_length = {}: the muscle cannot be so short; raise {}",
            quantity(length, "m"),
            quantity(limits.min_length(), "m"),
            reached::key_of_length(mechanism, coupling),
        );
        found.push(Warning::new("starts-slack", name, text));
    }
    if length > limits.max_length() * (1.0 + STRETCH) {
        found.push(reached::starts_overstretched(name, [length, limits.max_length()], mechanism, coupling));
    }
    found
}

/// The joints that start beyond a stop, whose spring then pushes them back from the first instant.
fn of_stops(of: &Parts<'_>, start: &PlantStart) -> Vec<Warning> {
    let mut found = Vec::new();
    for (index, (mechanism, angles)) in of.plant.mechanisms().iter().zip(&start.positions).enumerate() {
        let Mechanism::Chain(chain) = mechanism else { continue };
        for (place, (joint, angle)) in chain.joints().iter().zip(angles).enumerate() {
            let name = of.joints.get(index).and_then(|names| names.get(place)).map_or("", String::as_str);
            let [min, max, at] = match name {
                "" => ["load.min_angle", "load.max_angle", "initial.angle"].map(str::to_owned),
                name => ["min_angle", "max_angle", "angle"].map(|key| format!("joints.{name}.{key}")),
            };
            let [low, high] = joint.stops.ends;
            let below = low.filter(|low| *angle < low - ROUNDING).map(|low| (low, min, ["raise", "lower"]));
            let above = high.filter(|high| *angle > high + ROUNDING).map(|high| (high, max, ["lower", "raise"]));
            found.extend(below.or(above).map(|(stop, key, [change, or])| {
                let text = format!(
                    "the joint starts at {}, beyond its stop at {key} = {}, which pushes it back; {change} {at} or {or} {key}",
                    given(*angle, "rad"),
                    given(stop, "rad"),
                );
                Warning::new(BEYOND_STOP, name, text)
            }));
        }
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
        let Some((key, feed)) = feed(network, index) else { continue };
        if feed > PRESSURE && fed(network, index).is_some() {
            let text = format!("{key} = {} is", given(feed, "Pa"));
            found.push(reached::beyond_pressure(name, &text, key));
        }
    }
    found
}

/// The gauge pressure in Pa of what feeds a valve, of a tank the highest, with the key that sets it.
fn feed(network: &Network, valve: usize) -> Option<(&'static str, f64)> {
    let is_fed = |kind: &BranchKind| match kind {
        BranchKind::Path { valve: its, port, .. } => *its == valve && *port == Port::Supply,
        _ => false,
    };
    let from = network.branches.iter().find(|branch| is_fed(&branch.kind))?.from;
    let node = &network.nodes[from];
    match node.kind {
        NodeKind::Source => Some((SUPPLY, node.gauge)),
        NodeKind::Port { feed, .. } => Some((SUPPLY, feed)),
        NodeKind::Reservoir(tank) => {
            let start = (SUPPLY, tank.start().0 - network.atmosphere);
            let filled = tank.switch_pressures().map(|[_, cut_out]| (CUT_OUT, cut_out - network.atmosphere));
            Some(filled.filter(|filled| filled.1 > start.1).unwrap_or(start))
        }
        _ => None,
    }
}

/// What is wrong with a gauge pressure in Pa that an actuator is to have, where it does not lie between the supply of its valve and
/// the atmosphere, of which either may be lower.
pub(crate) fn feed_of(plant: &Plant, actuator: usize, gauge: f64) -> Option<String> {
    let network = plant.network();
    let valve = (0..network.valves.len()).find(|valve| fed(network, *valve) == Some(actuator))?;
    let (key, feed) = feed(network, valve)?;
    let rounding = ROUNDING * feed.abs().max(network.atmosphere);
    let (is_above, is_below) = (gauge > feed.max(0.0) + rounding, gauge < feed.min(0.0) - rounding);
    (is_above || is_below).then(|| {
        let (lies, raise, less) = if is_above { ("exceeds", "raise", "less") } else { ("lies below", "lower", "more") };
        let supply = format!("{key} = {}", given(feed, "Pa"));
        let limit = match is_above == (feed > 0.0) {
            true => format!("{supply}, which cannot make it"),
            false => format!("the pressure of the atmosphere, and {supply} cannot make it either"),
        };
        format!("{lies} {limit}; {raise} {key} or request {less}")
    })
}

/// What a controller may request of a valve, against what feeds that.
pub(super) fn of_request(of: &Parts<'_>, request: GreatestRequest, valve: usize) -> Option<Warning> {
    let (supply, feed) = feed(of.plant.network(), valve)?;
    let GreatestRequest { key, gauge_pressure } = request;
    let name = of.valves.get(valve).map_or("", String::as_str);
    (gauge_pressure > feed * (1.0 + ROUNDING)).then(|| {
        let text = format!(
            "the requested pressure {key} = {} exceeds {supply} = {} and is never reached; lower {key} or raise {supply}",
            given(gauge_pressure, "Pa"),
            given(feed, "Pa"),
        );
        Warning::new("supply-exceeded", name, text)
    })
}
