//! From a plant, a start and what is given to a plant in balance: what drives each valve, which pressures are known, what
//! holds those that are.

use super::air::{AirSolver, command_range};
use super::frame::{Drive, Frame, Instant, Number};
use super::{PlantAir, PlantBalance, balance};
use crate::error::Error;
use crate::network::{BranchKind, NodeKind};
use crate::parameter;
use crate::plant::{Plant, PlantStart};
use crate::scalar::Scalar;
use crate::simulation::Actuation;
use crate::valve::{Command, PoppetClock, Port, Request, Solenoid, ValveKind};
use alloc::vec;
use alloc::vec::Vec;

/// A plant whose air is at rest, or flows through on average, its mechanisms where they start.
pub(super) struct Filled<'a> {
    pub(super) frame: Frame,
    solver: AirSolver<'a>,
    /// Of the air of each actuator, `P V/m` in J/kg.
    pub(super) heats: Vec<f64>,
}

/// The air of a plant.
pub(super) fn fill<'a>(
    plant: &'a Plant,
    start: &PlantStart,
    what: &PlantBalance,
    air: &'a PlantAir,
) -> Result<Filled<'a>, Error> {
    let mut state = plant.start(start)?;
    let count = plant.actuators.len();
    let listed = |name, given: usize| match given == count {
        true => Ok(()),
        false => Err(Error::Table {
            name,
            problem: "there is not one entry for each actuator",
            entry: given.min(count) + 1,
            remedy: "give as many entries as there are actuators",
        }),
    };
    if let PlantAir::Temperatures(kelvin) = air {
        listed(parameter::INITIAL_TEMPERATURE.key, kelvin.len())?;
        kelvin.iter().try_for_each(|kelvin| parameter::INITIAL_TEMPERATURE.check(*kelvin).map(drop))?;
    }
    let content: Vec<[f64; 2]> =
        plant.places.actuators.iter().map(|here| [state[here.pressure], state[here.mass()]]).collect();
    let mut given = vec![true; count];
    if let PlantBalance::Shut(gauges) | PlantBalance::DrivenAt(gauges) = what {
        listed(parameter::INITIAL_GAUGE_PRESSURE.key, gauges.len())?;
        for (i, gauge) in gauges.iter().enumerate() {
            let of_actuator = plant.actuators[i].actuator.air();
            parameter::INITIAL_GAUGE_PRESSURE.check(gauge.0)?;
            let absolute = gauge.absolute(of_actuator.atmosphere()).0;
            if absolute <= 0.0 {
                return Err(crate::valve::below_vacuum(&parameter::INITIAL_GAUGE_PRESSURE, *gauge, of_actuator));
            }
            state[plant.places.actuators[i].pressure] = absolute;
        }
    }
    for (i, mounted) in plant.actuators.iter().enumerate() {
        let (here, limits) = (plant.places.actuators[i], mounted.actuator.limits());
        if let (Some(slot), Some(tendon), None) = (here.length, &mounted.tendon, start.lengths[i]) {
            // Without a given length it starts between its limits, its tendon straight.
            let longest = limits.max_length();
            state[slot] = (state[slot] - tendon.rest_length()).clamp(limits.min_length(), longest);
        }
    }
    for here in &plant.places.mechanisms {
        state[here.rate(0)..here.rate(0) + here.coordinates].fill(0.0);
    }
    let valves = plant.network.valves.iter().enumerate();
    let drives: Vec<Drive> = valves.map(|(valve, actuation)| drive(plant, valve, actuation, what, &state)).collect();
    let mut frame = Frame::new(plant, drives, &state)?;
    if let PlantBalance::Driven = what {
        let fed = fed(&frame);
        given = (0..count).map(|i| plant.actuators[i].pressure.is_some() || !fed[i]).collect();
    }
    let mut holders = vec![None; count];
    if let PlantBalance::DrivenAt(_) = what {
        holders = (0..count).map(|i| holder(&frame, i)).collect();
        let repeats = |i: usize| holders[i].is_some() && holders[..i].contains(&holders[i]);
        if (0..count).any(repeats) {
            return Err(Error::NoSolution {
                what: "one valve cannot hold the pressures of two actuators: its one command gives one pressure",
                remedy: "give the commands instead of the pressures, or a valve to each actuator",
            });
        }
        // The duty is looked for: the start's may be one to which nothing answers.
        for valve in holders.iter().flatten() {
            if let Drive::Duty(duty) = &mut frame.drives[*valve] {
                let [low, high] = command_range(plant, *valve);
                *duty = duty.clamp(low, high);
            }
        }
    }
    let volumes = volumes(&frame);
    let start = content.iter().zip(&volumes).map(|([pressure, mass], volume)| [*pressure, *mass, *volume]).collect();
    let supplied = supplied(&frame);
    let solver = AirSolver { plant, air, start, given, holders, supplied };
    solver.solve(&mut frame)?;
    let heat = |i: usize| {
        let here = plant.places.actuators[i];
        volumes[i] * frame.state[here.pressure] / frame.state[here.mass()]
    };
    let heats = (0..count).map(heat).collect();
    Ok(Filled { frame, solver, heats })
}

/// The plant in balance.
pub(super) fn begin(plant: &Plant, start: &PlantStart, what: &PlantBalance, air: &PlantAir) -> Result<Frame, Error> {
    let Filled { mut frame, solver, heats } = fill(plant, start, what, air)?;
    balance::balance(&mut frame)?;
    let lengths = frame.evaluate(&[]).at.units.into_iter().map(|unit| unit.length.value);
    plant.relax_branches(lengths, &mut frame.state);
    frame.holds_ends = false;
    for (i, volume) in self::volumes(&frame).into_iter().enumerate() {
        let here = plant.places.actuators[i];
        let pressure = frame.state[here.pressure];
        // Flows leave a temperature, a process that is kept leaves a content.
        frame.state[here.mass()] = match plant.places.keeps_heat[i] {
            true => volume * pressure / heats[i],
            false => solver.mass(i, pressure, volume)[0],
        };
    }
    Ok(frame)
}

fn volumes(frame: &Frame) -> Vec<f64> {
    frame.evaluate(&[]).at.chambers.iter().map(|chamber| chamber.volume.value).collect()
}

/// What drives a valve at the point.
fn drive(plant: &Plant, valve: usize, actuation: &Actuation, what: &PlantBalance, state: &[f64]) -> Drive {
    let Actuation { solenoid, command } = actuation;
    let shut = matches!(what, PlantBalance::Shut(_));
    if solenoid.regulator().is_some() {
        let last = (0..).map_while(|index| command.set_point(index)).last();
        let port = plant.network.nodes.iter().zip(&plant.places.nodes).find_map(|(node, place)| match node.kind {
            NodeKind::Port { valve: its, .. } if its == valve => place.map(|place| state[place]),
            _ => None,
        });
        let kept = port.map_or(0.0, |pressure| pressure - plant.network.atmosphere);
        return Drive::SetPoint(last.map_or(kept, |(_, gauge)| gauge), !shut);
    }
    if shut && !is_passive(plant, valve) {
        return Drive::Openings([0.0; 2]);
    }
    match command {
        Command::Pwm { duty, .. } if solenoid.has_poppets() => Drive::Duty(*duty),
        Command::Positions { .. } => {
            let last = (0..).map_while(|index| command.position(index)).last();
            Drive::Spool(last.map_or(0.0, |(_, position)| position))
        }
        Command::Constant(request) => Drive::Openings(resting(solenoid, Some(*request))),
        _ => {
            let last = match command {
                Command::Table { request, .. } => request.last().copied(),
                _ => None,
            };
            match what {
                // Nothing commands it, so that none of its commands can hold a pressure.
                PlantBalance::DrivenAt(_) if last.is_none() => Drive::Openings([0.0; 2]),
                _ => Drive::Openings(resting(solenoid, last)),
            }
        }
    }
}

/// Whether a valve stands for a flow path without one, such as the inlet of a manifold: it has one path, which stays open.
fn is_passive(plant: &Plant, valve: usize) -> bool {
    let Actuation { solenoid, command } = &plant.network.valves[valve];
    let exhausts =
        |kind: &BranchKind| matches!(kind, BranchKind::Path { valve: its, port: Port::Exhaust, .. } if *its == valve);
    solenoid.kind() == ValveKind::TwoWay
        && matches!(command, Command::Constant(Request::Fill))
        && !plant.network.branches.iter().any(|branch| exhausts(&branch.kind))
}

/// The openings of a valve long after a request.
fn resting(solenoid: &Solenoid, request: Option<Request>) -> [f64; 2] {
    let mut clock = PoppetClock::released();
    let command = request.map_or(Command::nothing(), Command::Constant);
    let late = solenoid.delays().into_iter().chain(solenoid.ramp().times()).sum::<f64>() + solenoid.latency() + 1.0;
    clock.advance(late, solenoid, &command);
    let ports = clock.ports(solenoid);
    [ports.supply, ports.exhaust].map(|open| f64::from(u8::from(open)))
}

/// The node that is each actuator's chamber, with the nodes that air can come to from there.
fn reachable(frame: &Frame, from: usize, passes: &dyn Fn(usize) -> bool) -> Vec<usize> {
    let network = &frame.plant.network;
    let mut reached = vec![from];
    let mut next = 0;
    while next < reached.len() {
        let node = reached[next];
        next += 1;
        let is_fixed = !matches!(network.nodes[node].kind, NodeKind::Chamber { .. } | NodeKind::Hose(_));
        if is_fixed {
            continue;
        }
        for (index, branch) in network.branches.iter().enumerate() {
            let is_feed = frame.plant.places.branches[index]
                .is_some_and(|slot| frame.feeds.iter().any(|(_, feed)| *feed == slot));
            if is_feed || !passes(index) {
                continue;
            }
            for (one, other) in [(branch.from, branch.to), (branch.to, branch.from)] {
                if one == node && !reached.contains(&other) {
                    reached.push(other);
                }
            }
        }
    }
    reached
}

/// Whether each branch is open: the path of a valve, as that is driven.
fn open(frame: &Frame) -> Vec<bool> {
    let state: Vec<Number> = frame.state.iter().map(|value| Scalar::constant(*value)).collect();
    let number = |_, value| Scalar::constant(value);
    let openings: Vec<[Number; 2]> =
        (0..frame.drives.len()).map(|valve| frame.openings(valve, &state, &number)).collect();
    let is_open = |kind: &BranchKind<Number>| match *kind {
        BranchKind::Path { valve, port, .. } => openings[valve][port as usize].value > 0.0,
        _ => true,
    };
    frame.plant.network.branches.iter().map(|branch| is_open(&branch.kind)).collect()
}

/// Whether each node has an open path from what feeds it, or to the atmosphere, so that flows balance there: a bottle has none.
fn supplied(frame: &Frame) -> Vec<bool> {
    let (network, open) = (&frame.plant.network, open(frame));
    let supplies = |node: usize| {
        network.branches.iter().zip(&open).any(|(branch, open)| {
            let is_path = matches!(branch.kind, BranchKind::Path { .. } | BranchKind::Check { .. });
            branch.to == node && is_path && *open
        })
    };
    let mut supplied: Vec<bool> = (0..network.nodes.len()).map(supplies).collect();
    // A path into a hose supplies what the hose leads to; its cells lie one behind the other.
    for _ in 0..network.nodes.len() {
        for branch in &network.branches {
            let is_hose = matches!(branch.kind, BranchKind::Loss(_) | BranchKind::Inertia(_));
            supplied[branch.to] |= is_hose && supplied[branch.from];
        }
    }
    supplied
}

/// Whether air comes to or goes from each actuator by way of an open path or a leak.
fn fed(frame: &Frame) -> Vec<bool> {
    let (network, open) = (&frame.plant.network, open(frame));
    let passes = |index: usize| open[index];
    let chamber = |i: usize| frame.plant.places.chambers[i];
    let fixed = |node: &usize| !matches!(network.nodes[*node].kind, NodeKind::Chamber { .. } | NodeKind::Hose(_));
    (0..frame.plant.actuators.len())
        .map(|i| chamber(i).is_some_and(|node| reachable(frame, node, &passes).iter().any(fixed)))
        .collect()
}

/// The valve whose command can hold the pressure of an actuator.
fn holder(frame: &Frame, i: usize) -> Option<usize> {
    let network = &frame.plant.network;
    let chamber = frame.plant.places.chambers[i]?;
    let nodes = reachable(frame, chamber, &|index| !matches!(network.branches[index].kind, BranchKind::Path { .. }));
    network.branches.iter().find_map(|branch| match branch.kind {
        BranchKind::Path { valve, .. }
            if nodes.contains(&branch.to) && !matches!(frame.drives[valve], Drive::Openings(_)) =>
        {
            Some(valve)
        }
        _ => None,
    })
}

/// Refuses a point on a corner of the model.
pub(super) fn check_corners(frame: &Frame) -> Result<(), Error> {
    let Instant { at, mode, .. } = frame.evaluate(&[]);
    for (i, mounted) in frame.plant.actuators.iter().enumerate() {
        let (unit, limits) = (&at.units[i], mounted.actuator.limits());
        let moves = frame.plant.mechanisms[mounted.mechanism].is_dynamic() || mounted.tendon.is_some();
        let shortest = limits.min_length().value;
        let on_tendon = mounted.tendon.is_some();
        let least = if on_tendon { f64::MIN } else { shortest * (1.0 - 1e-12) };
        if moves && (least..=shortest * (1.0 + 1e-12)).contains(&unit.length.value) {
            return Err(Error::NoSolution {
                what: "an actuator is at its shortest length at this point, where it rests on the stop: nothing is linear \
                       there",
                remedy: "lower the pressure, or give a heavier load or a longer length",
            });
        }
        if on_tendon && (mode.actuators[i].loose || unit.tension.value <= 0.0) {
            return Err(Error::NoSolution {
                what: "a tendon carries nothing at this point: it goes slack on one side of it",
                remedy: "give a load above zero, a higher pressure or a shorter tendon",
            });
        }
    }
    Ok(())
}
