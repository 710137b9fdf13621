//! The matrices: which states are independent, which inputs there are, and the derivatives of rates and outputs by each.

use super::PlantStateSpace;
use super::frame::{Drive, Fed, Frame, Instant, Quantity};
use super::signal::{PlantInput, PlantOutput, PlantState};
use crate::mechanism::Mechanism;
use crate::network::NodeKind;
use crate::plant::{Plant, dense, tendon};
use crate::simulation::LengthRegime;
use crate::valve::{Port, ValveKind};
use alloc::vec;
use alloc::vec::Vec;

/// A direction in which the length of an actuator changes.
pub(super) fn length_seed(frame: &Frame, i: usize) -> Vec<(Quantity, f64)> {
    let places = &frame.plant.places;
    if let Some(slot) = places.actuators[i].length {
        return vec![(Quantity::Slot(slot), 1.0)];
    }
    let here = places.mechanisms[frame.plant.actuators[i].mechanism];
    let gradient = frame.evaluate(&[]).at.gradient;
    let own = &gradient[places.actuators[i].gradient..][..here.coordinates];
    own.iter().enumerate().map(|(k, entry)| (Quantity::Slot(here.position(k)), entry.value)).collect()
}

/// The states of the model, each with the place of it and of its rate.
fn states(frame: &Frame) -> Vec<(PlantState, usize)> {
    let Plant { actuators, network, mechanisms, places } = &frame.plant;
    let mut states = Vec::new();
    for (m, here) in places.mechanisms.iter().enumerate().filter(|(m, _)| mechanisms[*m].is_dynamic()) {
        states.extend(
            (0..here.coordinates).map(|k| (PlantState::Position { mechanism: m, coordinate: k }, here.position(k))),
        );
        states.extend(
            (0..here.coordinates).map(|k| (PlantState::Velocity { mechanism: m, coordinate: k }, here.rate(k))),
        );
    }
    for (actuator, here) in places.actuators.iter().enumerate() {
        if actuators[actuator].pressure.is_none() {
            states.push((PlantState::Pressure { actuator }, here.pressure));
            states.push((PlantState::AirMass { actuator }, here.mass()));
        }
        states.extend(here.length.map(|slot| (PlantState::Length { actuator }, slot)));
        states.extend(here.bristles.map(|slot| (PlantState::Bristles { actuator }, slot)));
        let branches = here.branches().enumerate();
        states.extend(branches.map(|(branch, slot)| (PlantState::Branch { actuator, branch }, slot)));
    }
    for node in 0..network.nodes.len() {
        states.extend(places.nodes[node].map(|slot| (PlantState::NodePressure { node }, slot)));
    }
    for branch in 0..network.branches.len() {
        let own = places.branches[branch].filter(|slot| !frame.feeds.iter().any(|(_, feed)| feed == slot));
        states.extend(own.map(|slot| (PlantState::BranchFlow { branch }, slot)));
    }
    for &(valve, slot) in &frame.spools {
        states.push((PlantState::SpoolPosition { valve }, slot));
        states.push((PlantState::SpoolVelocity { valve }, slot + 1));
    }
    states
}

/// The inputs of the model, each with what to differentiate by; each force has its own column.
fn inputs(frame: &Frame) -> Vec<(PlantInput, Option<Quantity>)> {
    let Plant { actuators, network, mechanisms, places } = &frame.plant;
    let mut inputs = Vec::new();
    for (valve, drive) in frame.drives.iter().enumerate() {
        let of_drive = |input| (input, Some(Quantity::Drive(valve)));
        match drive {
            Drive::Duty(_) => inputs.push(of_drive(PlantInput::Duty { valve })),
            Drive::Spool(_) => inputs.push(of_drive(PlantInput::SpoolCommand { valve })),
            Drive::SetPoint(..) => inputs.push(of_drive(PlantInput::SetPoint { valve })),
            Drive::Openings(_) => {
                let ports = match network.valves[valve].solenoid.kind() {
                    ValveKind::TwoWay => &[Port::Supply][..],
                    _ => &[Port::Supply, Port::Exhaust][..],
                };
                let of_port =
                    |port: &Port| (PlantInput::Opening { valve, port: *port }, Some(Quantity::Opening(valve, *port)));
                inputs.extend(ports.iter().map(of_port));
            }
        }
    }
    let is_feed = |node: usize| {
        let of_feed = |(branch, slot): (usize, &Option<usize>)| {
            network.branches[branch].from == node
                && slot.is_some_and(|slot| frame.feeds.iter().any(|(_, it)| *it == slot))
        };
        places.branches.iter().enumerate().any(of_feed)
    };
    for (node, its) in network.nodes.iter().enumerate() {
        if matches!(its.kind, NodeKind::Source | NodeKind::Outlet { .. }) && !is_feed(node) {
            inputs.push((PlantInput::SupplyPressure { node }, Some(Quantity::Supply(node))));
        }
    }
    for (whose, slot) in &frame.feeds {
        let input = match *whose {
            Fed::Actuator(actuator) => PlantInput::MassFlow { actuator },
            Fed::Node(node) => PlantInput::NodeFlow { node },
        };
        inputs.push((input, Some(Quantity::Slot(*slot))));
    }
    for (mechanism, here) in places.mechanisms.iter().enumerate() {
        for coordinate in 0..here.coordinates {
            match &mechanisms[mechanism] {
                Mechanism::Mass(_) | Mechanism::Chain(_) => {
                    inputs.push((PlantInput::Force { mechanism, coordinate }, None));
                }
                Mechanism::External { .. } => {
                    let (position, rate) = (here.position(coordinate), here.rate(coordinate));
                    inputs.push((PlantInput::Motion { mechanism, coordinate }, Some(Quantity::Slot(position))));
                    inputs.push((PlantInput::MotionRate { mechanism, coordinate }, Some(Quantity::Slot(rate))));
                }
                Mechanism::Prescribed(_) | Mechanism::Fixed => {}
            }
        }
    }
    for (actuator, mounted) in actuators.iter().enumerate() {
        if mounted.pressure.is_some() {
            let slot = places.actuators[actuator].pressure;
            inputs.push((PlantInput::GivenPressure { actuator }, Some(Quantity::Slot(slot))));
        }
    }
    inputs
}

/// The outputs of the model with their derivatives at an instant.
fn outputs(frame: &Frame, instant: &Instant, seeds: &[(Quantity, f64)]) -> Vec<(PlantOutput, f64)> {
    let Plant { network, mechanisms, places, .. } = &frame.plant;
    let of = |slot: usize| seeds.iter().filter(|(its, _)| *its == Quantity::Slot(slot)).map(|(_, slope)| slope).sum();
    let mut outputs = Vec::new();
    for (actuator, unit) in instant.at.units.iter().enumerate() {
        outputs.push((PlantOutput::Length { actuator }, unit.length.slope[0]));
        outputs.push((PlantOutput::LengthRate { actuator }, unit.velocity.slope[0]));
        outputs.push((PlantOutput::Pressure { actuator }, of(places.actuators[actuator].pressure)));
        outputs.push((PlantOutput::Tension { actuator }, unit.tension.slope[0]));
    }
    for (mechanism, here) in places.mechanisms.iter().enumerate().filter(|(m, _)| mechanisms[*m].is_dynamic()) {
        for coordinate in 0..here.coordinates {
            outputs.push((PlantOutput::Position { mechanism, coordinate }, of(here.position(coordinate))));
            outputs.push((PlantOutput::Velocity { mechanism, coordinate }, of(here.rate(coordinate))));
            let pulls = places.members[mechanism].iter().map(|&i| {
                let along = instant.at.gradient[places.actuators[i].gradient + coordinate];
                -(along * instant.at.units[i].tension).slope[0]
            });
            outputs.push((PlantOutput::ActuatorForce { mechanism, coordinate }, pulls.sum()));
        }
    }
    for node in 0..network.nodes.len() {
        outputs.extend(places.nodes[node].map(|slot| (PlantOutput::NodePressure { node }, of(slot))));
    }
    outputs
}

/// The matrices.
pub(super) fn derivatives(frame: &Frame) -> PlantStateSpace {
    let (states, inputs) = (states(frame), inputs(frame));
    let none = frame.evaluate(&[]);
    let names: Vec<PlantOutput> = outputs(frame, &none, &[]).into_iter().map(|(output, _)| output).collect();
    let blank = |rows: usize, columns: usize| vec![vec![0.0; columns]; rows];
    let mut system = PlantStateSpace {
        a: blank(states.len(), states.len()),
        b: blank(states.len(), inputs.len()),
        c: blank(names.len(), states.len()),
        d: blank(names.len(), inputs.len()),
        states: states.iter().map(|(state, _)| *state).collect(),
        inputs: inputs.iter().map(|(input, _)| *input).collect(),
        outputs: names,
    };
    let actuators = frame.plant.actuators.len();
    // How the excess force of each actuator on a tendon depends on states and inputs.
    let mut excess = vec![[vec![0.0; states.len()], vec![0.0; inputs.len()]]; actuators];
    let mut column = |seeds: &[(Quantity, f64)], place: usize, is_input: bool, system: &mut PlantStateSpace| {
        let (rates, shown) = if is_input { (&mut system.b, &mut system.d) } else { (&mut system.a, &mut system.c) };
        for (share, along) in frame.sides(seeds) {
            for ((_, slot), row) in states.iter().zip(&mut *rates) {
                row[place] += share * along.rates[*slot].slope[0];
            }
            for ((_, slope), row) in outputs(frame, &along, seeds).into_iter().zip(&mut *shown) {
                row[place] += share * slope;
            }
            for (of_actuator, number) in excess.iter_mut().zip(&along.excess) {
                of_actuator[usize::from(is_input)][place] += share * number.map_or(0.0, |number| number.slope[0]);
            }
        }
    };
    for (place, (_, slot)) in states.iter().enumerate() {
        column(&[(Quantity::Slot(*slot), 1.0)], place, false, &mut system);
    }
    for (place, (input, quantity)) in inputs.iter().enumerate() {
        match (quantity, input) {
            (Some(quantity), _) => column(&[(*quantity, 1.0)], place, true, &mut system),
            (None, PlantInput::Force { mechanism, coordinate }) => {
                let here = frame.plant.places.mechanisms[*mechanism];
                let mut answer = vec![0.0; here.coordinates];
                answer[*coordinate] = 1.0;
                dense::solve(&frame.factored_mass_matrix(*mechanism), here.coordinates, &mut answer);
                for ((state, _), row) in states.iter().zip(&mut system.b) {
                    if let PlantState::Velocity { mechanism: its, coordinate } = state
                        && its == mechanism
                    {
                        row[place] = answer[*coordinate];
                    }
                }
            }
            (None, _) => {}
        }
    }
    // Without viscous friction both tensions give the length.
    for (i, mounted) in frame.plant.actuators.iter().enumerate() {
        let is_taut = none.mode.actuators[i].mode.length_regime == LengthRegime::Taut;
        if mounted.tendon.is_none() || tendon::is_damped(&mounted.actuator, is_taut) {
            continue;
        }
        let length = PlantState::Length { actuator: i };
        let Some(gone) = system.states.iter().position(|state| *state == length) else { continue };
        let of = |state: PlantState| states.iter().position(|(its, _)| *its == state);
        let own = of(length).map_or(1.0, |place| excess[i][0][place]);
        let now = system.states.clone();
        system = system.eliminate(
            gone,
            |n| of(now[n]).map_or(0.0, |place| -excess[i][0][place] / own),
            |k| -excess[i][1][k] / own,
        );
    }
    system
}
