//! What is known before a run: from the commands of the valves, the pressures that are given, and the start.

use super::{
    BEYOND_STOP, EFFECTIVENESS, Loop, PRESSURE, Parts, STRETCH, Warning, behind, compared, fed, reached, valve,
};
use crate::quantities::{digits, given, given_percent, percent, plain, quantity};
use mckibben::control::Quantity;
use mckibben::force::Law;
use mckibben::load::SeriesTendon;
use mckibben::mechanism::{Coupling, Mechanism};
use mckibben::network::{BranchKind, NodeKind};
use mckibben::parameter;
use mckibben::plant::{Mounted, Plant, PlantRun, PlantStart};
use mckibben::valve::Port;
use mckibben::{Actuator, GaugePressure};
use mckibben_scenario::{GreatestRequest, presets};

/// The key of the pressure that feeds a valve, and of that up to which a compressor fills a tank.
const SUPPLY: &str = parameter::SUPPLY_GAUGE_PRESSURE.key;
const CUT_OUT: &str = parameter::CUT_OUT.key;
/// That a controller requests what supply and atmosphere cannot make.
const SUPPLY_EXCEEDED: &str = "supply-exceeded";
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
    let network = of.plant.network();
    let supply =
        (0..network.valves.len()).find(|valve| fed(network, *valve) == Some(index)).and_then(|valve| feed(of, valve));
    let gauges: Vec<f64> = [0.0, gauge].into_iter().chain(supply.map(|(_, feed)| feed)).collect();
    found.extend(of_effectiveness(&mounted.actuator, name, &gauges));
    found.extend(of_preset(&mounted.actuator, name));
    let (mechanism, coupling) = (&of.plant.mechanisms()[mounted.mechanism], &mounted.coupling);
    let limits = mounted.actuator.limits();
    let apart = start.positions.get(mounted.mechanism).map(|positions| coupling.span(mechanism, positions));
    let is_point = |apart: f64| apart <= limits.min_length() * ROUNDING;
    if matches!(coupling, Coupling::Points(_)) && apart.is_some_and(is_point) {
        // The length of a muscle on a tendon does not show it.
        let text = format!(
            "it starts slack with both ends at one point, from where it has no direction to pull in; raise {}",
            reached::key_of_length(of, mounted),
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
            reached::key_of_length(of, mounted),
        );
        found.push(Warning::new("starts-slack", name, text));
    }
    if length > limits.max_length() * (1.0 + STRETCH) {
        found.push(reached::starts_overstretched(of, (mounted, name), [length, limits.max_length()]));
    }
    found
}

/// The joints that start beyond a stop, whose spring then pushes them back from the first instant.
fn of_stops(of: &Parts<'_>, start: &PlantStart) -> Vec<Warning> {
    let mut found = Vec::new();
    for (index, (mechanism, angles)) in of.plant.mechanisms().iter().zip(&start.positions).enumerate() {
        let Mechanism::Chain(chain) = mechanism else { continue };
        for (place, (joint, angle)) in chain.joints().iter().zip(angles).enumerate() {
            let name = of.joint(index, place);
            let [min, max, at] = match name {
                "" => ["load.min_angle", "load.max_angle", "initial.angle"].map(str::to_owned),
                name => ["min_angle", "max_angle", "angle"].map(|key| format!("joints.{name}.{key}")),
            };
            let [low, high] = joint.stops.ends;
            let below = low.filter(|low| *angle < low - ROUNDING).map(|low| (low, min, ["raise", "lower"]));
            let above = high.filter(|high| *angle > high + ROUNDING).map(|high| (high, max, ["lower", "raise"]));
            found.extend(below.or(above).map(|(stop, key, [change, or])| {
                let [start, end] = compared([*angle, stop], "rad");
                let text = format!(
                    "the joint starts at {start}, beyond its stop at {key} = {end}, which pushes it back; {change} {at} or {or} {key}"
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
        let Some((key, feed)) = feed(of, index) else { continue };
        if feed > PRESSURE && fed(network, index).is_some() {
            let text = format!("{key} = {} is", given(feed, "Pa"));
            found.push(reached::beyond_pressure(name, &text, &key));
        }
    }
    found
}

/// The gauge pressure in Pa of what feeds a valve, of a tank the highest, with the key that sets it.
pub(super) fn feed(of: &Parts<'_>, valve: usize) -> Option<(String, f64)> {
    let network = of.plant.network();
    let is_fed = |kind: &BranchKind| match kind {
        BranchKind::Path { valve: its, port, .. } => *its == valve && *port == Port::Supply,
        _ => false,
    };
    let from = network.branches.iter().find(|branch| is_fed(&branch.kind))?.from;
    let node = &network.nodes[from];
    let (key, gauge) = match node.kind {
        NodeKind::Source => (SUPPLY, node.gauge),
        NodeKind::Port { feed, .. } => (SUPPLY, feed),
        NodeKind::Reservoir(tank) => {
            let start = (SUPPLY, tank.start().0 - network.atmosphere);
            let filled = tank.switch_pressures().map(|[_, cut_out]| (CUT_OUT, cut_out - network.atmosphere));
            filled.filter(|filled| filled.1 > start.1).unwrap_or(start)
        }
        _ => return None,
    };
    Some((of.key_of_supply(from, key), gauge))
}

/// What is wrong with a gauge pressure in Pa that an actuator is to have, where it does not lie between the supply of its valve and
/// the atmosphere, of which either may be lower.
pub(crate) fn feed_of(plant: &Plant, actuator: usize, gauge: f64) -> Option<String> {
    beyond_feed(&Parts::named(plant, &[]), actuator, gauge)
}

fn beyond_feed(of: &Parts<'_>, actuator: usize, gauge: f64) -> Option<String> {
    let network = of.plant.network();
    let valve = (0..network.valves.len()).find(|valve| fed(network, *valve) == Some(actuator))?;
    let (key, feed) = feed(of, valve)?;
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

/// What a controller may request of its valves and is to reach, against what feeds them, their delays and the muscle.
pub(super) fn of_controller(of: &Parts<'_>, controller: &Loop<'_>) -> Vec<Warning> {
    let mut found = Vec::new();
    for &valve in controller.valves {
        // A five-way valve feeds both actuators of a joint.
        let Some(actuation) = of.plant.network().valves.get(valve) else { continue };
        let name = of.valves.get(valve).map_or("", String::as_str);
        found.extend(controller.request.and_then(|request| of_request(of, request, valve)));
        found.extend(controller.pulses.and_then(|pulses| valve::of_controller(actuation, name, pulses)));
    }
    for &actuator in controller.actuators {
        let name = of.actuators.get(actuator).map_or("", String::as_str);
        for (quantity, set_point) in controller.set_points {
            let (key, ends) = (quantity.rows().set_point.key, set_point.ends());
            let text = match quantity {
                Quantity::Pressure => too_low(of, actuator, key, ends[0]).map(|text| (SUPPLY_EXCEEDED, text)),
                Quantity::Length => too_far(of, actuator, key, ends).map(|text| ("set-point-beyond", text)),
                _ => None,
            };
            found.extend(text.map(|(code, text)| Warning::new(code, name, text)));
        }
    }
    found
}

/// That a gauge pressure in Pa that an actuator is to have is lower than anything that its valve can make.
fn too_low(of: &Parts<'_>, actuator: usize, key: &str, gauge: f64) -> Option<String> {
    let vacuum = -of.plant.network().atmosphere;
    let requested = format!("the requested pressure {key} = {}", given(gauge, "Pa"));
    if gauge <= vacuum {
        let vacuum = given(vacuum, "Pa");
        return Some(format!(
            "{requested} is a gauge pressure and not above vacuum, {vacuum}: it is never reached; raise {key}"
        ));
    }
    let why = beyond_feed(of, actuator, gauge).filter(|_| gauge < 0.0)?;
    Some(format!("{requested} {why}"))
}

/// That a distance in m between the attachments that an actuator is to have is none that its braid allows. A tendon stretches, but
/// it does not push.
fn too_far(of: &Parts<'_>, actuator: usize, key: &str, [least, greatest]: [f64; 2]) -> Option<String> {
    let mounted = of.plant.actuators().get(actuator)?;
    let limits = mounted.actuator.limits();
    let tendon = mounted.tendon.as_ref().map(SeriesTendon::rest_length);
    let shortest = limits.min_length() + tendon.unwrap_or(0.0);
    let (length, limit, remedy) = if least < shortest * (1.0 - ROUNDING) {
        let with = if tendon.is_some() { " with the tendon's rest_length" } else { "" };
        (least, format!("below the {} of actuator.min_length{with}", quantity(shortest, "m")), "raise")
    } else if tendon.is_none() && greatest > limits.max_length() * (1.0 + STRETCH) {
        let longest = limits.max_length();
        let more = percent((greatest - longest) / longest);
        (greatest, format!("{more} above actuator.max_length = {}", quantity(longest, "m")), "lower")
    } else {
        return None;
    };
    Some(format!(
        "the set point {key} = {} is {limit}: the muscle never has this length; {remedy} {key}",
        given(length, "m")
    ))
}

/// That an effectiveness, at a gauge pressure in Pa of those that an actuator may have, is no share.
fn of_effectiveness(actuator: &Actuator, name: &str, gauges: &[f64]) -> Option<Warning> {
    let at = |gauge: &f64| actuator.law().effectiveness.at(GaugePressure(*gauge));
    let (value, gauge) = gauges.iter().map(|gauge| (at(gauge), *gauge)).find(|(value, _)| *value > EFFECTIVENESS)?;
    let text = format!(
        "the effectiveness is {} at a gauge pressure of {}, above {}, where this program begins to doubt it: measured forces are not so \
         far above the ideal braid's; correct actuator.effectiveness, where 80 % is 0.8",
        digits(value),
        given(gauge, "Pa"),
        plain(&digits(EFFECTIVENESS)),
    );
    Some(Warning::new("effectiveness", name, text))
}

/// That the wall of a preset's law, whose modulus was fitted over the length of its muscle, is that of a muscle of another length.
fn of_preset(actuator: &Actuator, name: &str) -> Option<Warning> {
    let Law::MartensBoblan(wall) = actuator.law().law.law() else { return None };
    let longest = actuator.limits().max_length();
    let (preset, fitted) = presets::ACTUATORS.iter().find_map(|preset| {
        let fitted = preset.get(&parameter::MAX_LENGTH)?.value()?;
        let [c0, c1, c2, c3] = preset.modulus()?;
        // Two cubics that agree at four lengths agree everywhere.
        let is_its = |share: f64| {
            let length = share * fitted;
            let its = c0 + length * (c1 + length * (c2 + length * c3));
            (wall.modulus(length) - its).abs() <= ROUNDING * c0.abs()
        };
        [0.0, 0.5, 1.0, 1.5].into_iter().all(is_its).then_some((preset, fitted))
    })?;
    ((longest - fitted).abs() > STRETCH * fitted).then(|| {
        let text = format!(
            "the law of force is that of the preset {}, whose wall was fitted to a muscle of {}, and actuator.max_length = {}: it says \
             nothing of a muscle of this length; give another actuator.force, or a muscle of {} ± {}",
            preset.name,
            given(fitted, "m"),
            quantity(longest, "m"),
            given(fitted, "m"),
            given_percent(STRETCH),
        );
        Warning::new("preset-length", name, text)
    })
}

/// What a controller may request of a valve, against what feeds that.
fn of_request(of: &Parts<'_>, request: GreatestRequest, valve: usize) -> Option<Warning> {
    let (supply, feed) = feed(of, valve)?;
    let GreatestRequest { key, gauge_pressure } = request;
    let name = of.valves.get(valve).map_or("", String::as_str);
    (gauge_pressure > feed * (1.0 + ROUNDING)).then(|| {
        let [requested, made] = compared([gauge_pressure, feed], "Pa");
        let text = format!(
            "the requested pressure {key} = {requested} exceeds {supply} = {made} and is never reached; lower {key} or raise {supply}"
        );
        Warning::new(SUPPLY_EXCEEDED, name, text)
    })
}
