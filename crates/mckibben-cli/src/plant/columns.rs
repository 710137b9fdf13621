//! The columns of a plant's run.
//!
//! First those of each actuator, as in the run of one alone, then those of the mechanisms and of the air.

use super::coordinates;
use crate::record::{Field, member, number, word};
use mckibben::plant::PlantSample;
use mckibben::simulation::Sample;
use mckibben::valve::Ports;
use mckibben_scenario::PlantExperiment;

/// The columns in their order.
pub(crate) fn fields(of: &PlantExperiment) -> Vec<Field<PlantSample>> {
    let mut fields = vec![number("time_s", "s", |sample: &PlantSample| sample.time)];
    let network = of.plant.network();
    for (index, name) in of.names.actuators.iter().enumerate() {
        let (valve, hose) = (of.names.valves[index], of.names.hoses[index]);
        let has_tendon = of.plant.actuators()[index].tendon.is_some();
        let its = move |sample: &PlantSample| as_one(sample, index, valve, hose, has_tendon);
        // The time stands in front already.
        fields.extend(member(&format!("{name}."), its).into_iter().skip(1));
        let own = |column: &str| format!("{name}.{column}");
        if let Some(node) = hose {
            fields.push(number(&own("hose_pressure_pa"), "Pa", move |sample: &PlantSample| {
                sample.nodes[node].pressure.0
            }));
        }
        let port = valve.and_then(|valve| super::port_of(network, valve));
        if let Some(node) = port {
            let regulated = move |sample: &PlantSample| sample.nodes[node].pressure.0;
            fields.push(number(&own("regulated_pressure_pa"), "Pa", regulated));
        }
        if has_tendon {
            let distance = move |sample: &PlantSample| sample.actuators[index].distance;
            fields.push(number(&own("load_distance_m"), "m", distance));
            let rate = move |sample: &PlantSample| sample.actuators[index].rate;
            fields.push(number(&own("load_velocity_m_s"), "m/s", rate));
        }
    }
    for of in coordinates(of) {
        let [position, rate, force] = match of.is_angle {
            true => [("angle_rad", "rad"), ("angular_velocity_rad_s", "rad/s"), ("torque_n_m", "N*m")],
            false => [("position_m", "m"), ("velocity_m_s", "m/s"), ("force_n", "N")],
        };
        let (m, k) = (of.mechanism, of.index);
        let column = |(name, unit): (&str, &'static str),
                      value: fn(&mckibben::plant::MechanismSample, usize) -> f64| {
            let value = move |sample: &PlantSample| value(&sample.mechanisms[m], k);
            number(&format!("{}.{name}", of.name), unit, value)
        };
        fields.push(column(position, |its, k| its.position[k]));
        fields.push(column(rate, |its, k| its.rate[k]));
        fields.push(column(force, |its, k| its.actuator_force[k]));
    }
    for (name, node) in &of.names.nodes {
        let node = *node;
        let value = move |sample: &PlantSample| sample.nodes[node].pressure.0;
        fields.push(number(&format!("{name}.pressure_pa"), "Pa", value));
    }
    for (name, valve) in &of.names.supply_valves {
        let valve = *valve;
        fields.push(word(&format!("{name}.valve"), move |sample: &PlantSample| sample.valves[valve].ports.name()));
    }
    fields
}

/// One actuator of a plant as the sample of one that is alone.
fn as_one(sample: &PlantSample, index: usize, valve: Option<usize>, hose: Option<usize>, has_tendon: bool) -> Sample {
    let of = &sample.actuators[index];
    let (length, velocity) = if has_tendon { (of.length, of.velocity) } else { (of.distance, of.rate) };
    Sample {
        time: sample.time,
        length,
        velocity,
        pressure: of.pressure,
        air_mass: of.air_mass,
        temperature: of.temperature,
        volume: of.volume,
        tension: of.tension,
        mass_flow: of.mass_flow,
        ports: valve.map_or(Ports { supply: false, exhaust: false }, |valve| sample.valves[valve].ports),
        hose_pressure: hose.map_or(of.pressure, |node| sample.nodes[node].pressure),
        hose_air_mass: hose.map_or(0.0, |node| sample.nodes[node].air_mass),
        supply_pressure: None,
        load_distance: of.distance,
        load_velocity: of.rate,
    }
}
