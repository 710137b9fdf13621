//! Samples: what holds in every part of a plant at an instant.
//!
//! A sample is read from the states by dense output and one evaluation of the plant. At the instant of an event it has what
//! holds after it. Over dual numbers it carries its derivatives with respect to the parameters that were seeded.
//!
//! What actuators that stick hold together is exact; redundant ones share it ([`ActuatorSample::tension`]).
//!
//! Checked by `tests/plant_sample.rs`.

use super::Plant;
use super::evaluation::{Evaluation, System};
use super::mode::PlantMode;
use super::steps::TimeStepping;
use super::trajectory::PlantTrajectory;
use crate::air::Process;
use crate::instantiate::Instantiate;
use crate::network::{BranchKind, NodeKind, flow::NetworkState};
use crate::pressure::AbsolutePressure;
use crate::simulation::{LengthRegime, SampleTimes};
use crate::valve::Ports;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

/// An actuator at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorSample<R = f64> {
    /// Distance in m that actuator and tendon span together, between the attachments.
    pub distance: R,
    /// Its rate in m/s, positive when it grows.
    pub rate: R,
    /// Length of the actuator in m: the distance without a tendon, but not below the shortest, at which a slack one rests.
    pub length: R,
    /// Its rate in m/s, positive when the actuator lengthens.
    pub velocity: R,
    /// Absolute pressure.
    pub pressure: AbsolutePressure<R>,
    /// Mass of the air in kg.
    pub air_mass: R,
    /// Temperature of the air in K.
    pub temperature: R,
    /// Volume of the air, braid and external volume, in m³.
    pub volume: R,
    /// Tension in N, zero or more. Of actuators that stick: what they hold together is exact, and redundant ones have the
    /// tensions closest to the middles of what they can hold, `min Σ (F_i − c̄_i)²/β_i`.
    pub tension: R,
    /// Net mass flow into the actuator in kg/s.
    pub mass_flow: R,
    /// Heat into the air in W by the first law, from the wall or what the process implies (see [`crate::air`]).
    pub heat_flow: R,
    /// Deflection in m of the bristles of LuGre's law; none without it.
    pub bristles: Option<R>,
    /// Force in N of the viscoelastic branches, which is a part of the tension; zero without any.
    pub branch_force: R,
}

/// A mechanism at an instant: one entry for each coordinate, in m or rad.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MechanismSample<R = f64> {
    /// The coordinates, in m or rad.
    pub position: Vec<R>,
    /// Their rates, in m/s or rad/s.
    pub rate: Vec<R>,
    /// Their accelerations, in m/s² or rad/s².
    pub acceleration: Vec<R>,
    /// Generalised force of the actuators on each coordinate, `−Σ J_iᵀ F_i`, in N or N·m.
    pub actuator_force: Vec<R>,
}

/// A node of the air network at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeSample<R = f64> {
    /// Absolute pressure.
    pub pressure: AbsolutePressure<R>,
    /// Temperature of its air in K.
    pub temperature: R,
    /// Mass of the air that it holds in kg, `V P/(κRT)` of hoses and reservoirs; zero where it holds none.
    pub air_mass: R,
    /// Net mass flow into it in kg/s, of a source or the atmosphere as well; what an outlet gets from its inlet is not counted.
    pub mass_flow: R,
}

/// A branch of the air network at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BranchSample<R = f64> {
    /// Mass flow in kg/s, positive from the branch's `from` to its `to`.
    pub mass_flow: R,
}

/// A valve at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValveSample<R = f64> {
    /// Which ports are open, as the air behind a lumped hose notices it.
    pub ports: Ports,
    /// How far the ports to the supply and to the atmosphere are open, from 0 to 1.
    pub openings: [R; 2],
}

/// Everything that is known of a plant at an instant, in the order of its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantSample<R = f64> {
    /// Time in s.
    pub time: R,
    /// The actuators.
    pub actuators: Vec<ActuatorSample<R>>,
    /// The mechanisms.
    pub mechanisms: Vec<MechanismSample<R>>,
    /// The nodes of the air network.
    pub nodes: Vec<NodeSample<R>>,
    /// Its branches.
    pub branches: Vec<BranchSample<R>>,
    /// Its valves.
    pub valves: Vec<ValveSample<R>>,
}

impl<R: Instantiate> PlantSample<R> {
    /// A sample of a plant with zeros, to be overwritten.
    pub fn new(plant: &Plant<R>) -> Self {
        R::new_plant_sample(plant)
    }

    pub(crate) fn generic_new(plant: &Plant<R>) -> Self {
        let zero = R::zero();
        let none = AbsolutePressure(zero);
        let actuator = ActuatorSample {
            distance: zero,
            rate: zero,
            length: zero,
            velocity: zero,
            pressure: none,
            air_mass: zero,
            temperature: zero,
            volume: zero,
            tension: zero,
            mass_flow: zero,
            heat_flow: zero,
            bristles: None,
            branch_force: zero,
        };
        let mechanisms = plant.mechanisms().iter().map(|mechanism| {
            let zeros = vec![zero; mechanism.coordinates()];
            let (rate, acceleration, actuator_force) = (zeros.clone(), zeros.clone(), zeros.clone());
            MechanismSample { position: zeros, rate, acceleration, actuator_force }
        });
        let node = NodeSample { pressure: none, temperature: zero, air_mass: zero, mass_flow: zero };
        let shut = ValveSample { ports: Ports { supply: false, exhaust: false }, openings: [zero; 2] };
        let network = plant.network();
        Self {
            time: zero,
            actuators: vec![actuator; plant.actuators().len()],
            mechanisms: mechanisms.collect(),
            nodes: vec![node; network.nodes.len()],
            branches: vec![BranchSample { mass_flow: zero }; network.branches.len()],
            valves: vec![shut; network.valves.len()],
        }
    }
}

/// Evaluates a plant in states and modes and makes samples of it, with room that is used again.
#[derive(Debug)]
pub(crate) struct Observer<R: Instantiate> {
    pub(crate) system: System<R>,
    pub(crate) at: Evaluation<R>,
    /// `Σ ṁ T` of what flows into each actuator, in kg·K/s.
    pub(crate) warmth: Vec<R>,
    /// Whether the run took fixed steps, whose modes do not say which pieces of laws hold.
    is_fixed: bool,
    /// Memory for a mode with its pieces.
    own: Option<PlantMode<R>>,
}

impl<R: Instantiate> Observer<R> {
    /// Of a run that goes through time by a [`TimeStepping`].
    pub(crate) fn new(plant: &Arc<Plant<R>>, stepping: TimeStepping) -> Self {
        let system = System::new(plant, stepping.tolerance());
        let is_fixed = matches!(stepping, TimeStepping::Fixed { .. });
        Self {
            system,
            at: Evaluation::new(plant),
            warmth: vec![R::zero(); plant.actuators().len()],
            is_fixed,
            own: None,
        }
    }

    /// A mode of a run at fixed steps with the pieces of laws that hold in a state; none where the mode says them itself.
    pub(crate) fn mode_with_pieces(&mut self, time: R, state: &[R], mode: &PlantMode<R>) -> Option<PlantMode<R>> {
        self.is_fixed.then(|| {
            let mut own = match self.own.take() {
                Some(mut own) => {
                    own.clone_from(mode);
                    own
                }
                None => mode.clone(),
            };
            self.system.enter_pieces(time, state, &mut own, &mut self.at);
            own
        })
    }

    /// Computes everything at a time in s, a state and a mode, but the tensions of what sticks.
    pub(crate) fn evaluate_flows(&mut self, time: R, state: &[R], mode: &PlantMode<R>) {
        let Self { system, at, warmth, .. } = self;
        let plant = &*system.plant;
        system.evaluate(time, state, mode, at);
        for (i, warmth) in warmth.iter_mut().enumerate() {
            // Air whose pressure is given comes in as warm as it is inside.
            let given = plant.actuators()[i].pressure.is_some();
            let inside = || plant.actuators()[i].actuator.air().temperature(&at.chambers[i]);
            *warmth = if given { at.units[i].flow.inward * inside() } else { R::zero() };
        }
        for (branch, flow) in plant.network().branches.iter().zip(&at.network.flows) {
            let backwards = flow.value() < 0.0;
            let (into, from) = if backwards { (branch.from, branch.to) } else { (branch.to, branch.from) };
            if let NodeKind::Chamber { actuator } = plant.network().nodes[into].kind
                && let Some(warmth) = warmth.get_mut(actuator)
            {
                let air = plant.actuators()[actuator].actuator.air();
                *warmth = *warmth + flow.magnitude() * plant.network().temperature(from, &at.chambers, air);
            }
        }
    }

    /// Heat in W into the air of an actuator, once all is computed, by the first law:
    /// `Q = dU/dt + P dV/dt − c_p (Σ ṁ_in T_in − ṁ_out T)` with `U = P V/(γ − 1)`.
    pub(crate) fn heat(&self, i: usize) -> R {
        let (unit, chamber) = (&self.at.units[i], &self.at.chambers[i]);
        let air = self.system.plant.actuators()[i].actuator.air();
        let temperature = air.temperature(chamber);
        if let Process::EnergyBalance { heat_transfer, wall_temperature } = air.process() {
            return heat_transfer * (wall_temperature - temperature);
        }
        let gamma = air.heat_capacity_ratio();
        let per_excess = R::one() / (gamma - R::one());
        let energy = (unit.pressure_rate * chamber.volume + chamber.pressure * chamber.volume_rate) * per_excess;
        let enthalpy = gamma * per_excess * air.gas_constant() * (self.warmth[i] - unit.flow.outward * temperature);
        energy + chamber.pressure * chamber.volume_rate - enthalpy
    }

    /// Mass in kg of the air that a node holds.
    pub(crate) fn content(&self, node: usize) -> R {
        let NetworkState { nodes, .. } = &self.at.network;
        match &self.system.plant.network().nodes[node].kind {
            NodeKind::Chamber { actuator } => self.at.chambers.get(*actuator).map_or(R::zero(), |chamber| chamber.mass),
            NodeKind::Hose(hose) => hose.content(nodes[node].pressure),
            NodeKind::Reservoir(reservoir) => reservoir.content(nodes[node].pressure),
            NodeKind::Atmosphere
            | NodeKind::Source
            | NodeKind::Given { .. }
            | NodeKind::Outlet { .. }
            | NodeKind::Port { .. } => R::zero(),
        }
    }

    /// Writes the sample at a time in s and a mode, once a state there has what is known exactly.
    pub(crate) fn read(&mut self, time: R, state: &mut [R], mode: &PlantMode<R>, sample: &mut PlantSample<R>) {
        self.system.project(time, state, mode, &mut self.at);
        self.observe(time, state, mode, sample);
    }

    /// Writes the sample at a time in s, a state and a mode.
    pub(crate) fn observe(&mut self, time: R, state: &[R], mode: &PlantMode<R>, sample: &mut PlantSample<R>) {
        let own = self.mode_with_pieces(time, state, mode);
        let mode = own.as_ref().unwrap_or(mode);
        self.evaluate_flows(time, state, mode);
        let plant = self.system.plant.clone();
        for m in 0..plant.mechanisms().len() {
            self.system.share_tensions(m, state, mode, &mut self.at);
        }
        let (at, places) = (&self.at, plant.indices());
        sample.time = time;
        for (i, of_actuator) in sample.actuators.iter_mut().enumerate() {
            let (unit, chamber) = (&at.units[i], &at.chambers[i]);
            let Actual { length, velocity } = actual(&self.system, i, mode, at);
            let air = plant.actuators()[i].actuator.air();
            *of_actuator = ActuatorSample {
                distance: unit.distance,
                rate: unit.rate,
                length,
                velocity,
                pressure: AbsolutePressure(chamber.pressure),
                air_mass: chamber.mass,
                temperature: air.temperature(chamber),
                volume: chamber.volume,
                tension: unit.tension.larger(R::zero()),
                mass_flow: unit.flow.net(),
                heat_flow: self.heat(i),
                bristles: places.actuators[i].bristles.map(|place| state[place]),
                branch_force: self.system.branch_force(i, state, mode, [length, chamber.pressure]),
            };
        }
        for (m, of_mechanism) in sample.mechanisms.iter_mut().enumerate() {
            let (position, rate) = places.mechanisms[m].of(state);
            of_mechanism.position.copy_from_slice(position);
            of_mechanism.rate.copy_from_slice(rate);
            let first = self.system.plant.places.mechanisms[m].acceleration;
            of_mechanism.acceleration.copy_from_slice(&at.acceleration[first..first + position.len()]);
            of_mechanism.actuator_force.fill(R::zero());
            for &i in &places.members[m] {
                let gradient = self.system.gradient(i, &at.gradient);
                for (force, entry) in of_mechanism.actuator_force.iter_mut().zip(gradient) {
                    *force = *force - *entry * at.units[i].tension.larger(R::zero());
                }
            }
        }
        let network = plant.network();
        for (index, (of_node, node)) in sample.nodes.iter_mut().zip(&at.network.nodes).enumerate() {
            let temperature = match (&network.nodes[index].kind, plant.actuators().first()) {
                (NodeKind::Chamber { .. }, Some(first)) => {
                    network.temperature(index, &at.chambers, first.actuator.air())
                }
                _ => network.nodes[index].temperature,
            };
            *of_node = NodeSample {
                pressure: AbsolutePressure(node.pressure),
                temperature,
                air_mass: self.content(index),
                mass_flow: R::zero(),
            };
        }
        for (branch, flow) in network.branches.iter().zip(&at.network.flows) {
            let copies = match branch.kind {
                BranchKind::Path { copies, .. } => copies,
                _ => R::one(),
            };
            let [into, from] = [branch.to, branch.from].map(|n| sample.nodes[n].mass_flow);
            sample.nodes[branch.to].mass_flow = into + *flow;
            sample.nodes[branch.from].mass_flow = from - *flow * copies;
        }
        for n in (0..network.nodes.len()).rev() {
            // What an outlet gives away comes from its inlet.
            if let NodeKind::Outlet { inlet: Some(inlet), .. } = network.nodes[n].kind {
                sample.nodes[inlet].mass_flow = sample.nodes[inlet].mass_flow + sample.nodes[n].mass_flow;
            }
        }
        for (of_branch, flow) in sample.branches.iter_mut().zip(&at.network.flows) {
            of_branch.mass_flow = *flow;
        }
        for (of_valve, its) in sample.valves.iter_mut().zip(&mode.network.valves) {
            let whole = [its.ports.supply, its.ports.exhaust].map(|open| R::constant(f64::from(u8::from(open))));
            *of_valve = ValveSample { ports: its.ports, openings: its.openings.at(time).unwrap_or(whole) };
        }
        self.own = own;
    }
}

/// Where an actuator itself is, and how fast it lengthens.
pub(crate) struct Actual<R> {
    pub(crate) length: R,
    pub(crate) velocity: R,
}

/// Where an actuator itself is: slack, it rests on its shortest length.
pub(crate) fn actual<R: Instantiate>(
    system: &System<R>,
    i: usize,
    mode: &PlantMode<R>,
    at: &Evaluation<R>,
) -> Actual<R> {
    let unit = &at.units[i];
    match mode.actuators[i].mode.length_regime {
        LengthRegime::Slack => {
            Actual { length: system.wires[i].member.actuator.limits().min_length(), velocity: R::zero() }
        }
        _ => Actual { length: unit.length, velocity: unit.velocity },
    }
}

/// Reads samples of a run, with room that is used again: quickest where the times do not fall from one to the next.
#[derive(Debug)]
pub struct PlantReader<'t, R: Instantiate = f64> {
    trajectory: &'t PlantTrajectory<R>,
    observer: Observer<R>,
    state: Vec<R>,
    /// Pieces that have begun by the last time that was read.
    begun: usize,
}

impl<'t, R: Instantiate> PlantReader<'t, R> {
    /// Reads a run.
    pub fn new(trajectory: &'t PlantTrajectory<R>) -> Self {
        R::new_plant_reader(trajectory)
    }

    pub(crate) fn generic_new(trajectory: &'t PlantTrajectory<R>) -> Self {
        let plant = trajectory.plant();
        let observer = Observer::new(trajectory.shared_plant(), trajectory.stepping());
        Self { trajectory, observer, state: vec![R::zero(); plant.indices().states], begun: 0 }
    }

    /// Writes the sample at `time` in s to `sample`, which was made for the same plant: see [`PlantTrajectory::sample`].
    pub fn read_into(&mut self, time: R, sample: &mut PlantSample<R>) {
        R::read_plant_sample(self, time, sample);
    }

    pub(crate) fn generic_read_into(&mut self, time: R, sample: &mut PlantSample<R>) {
        self.begun = self.trajectory.begun(self.begun, time.value());
        let Self { trajectory, observer, state, begun } = self;
        let (time, mode) = trajectory.read(&observer.system, *begun, time, state, &mut observer.at);
        observer.observe(time, state, mode, sample);
    }

    /// The states at `time` in s, in the places that [`Plant::indices`] says: quicker than a sample, which computes from them.
    pub fn state_at(&mut self, time: R) -> &[R] {
        R::read_states_at(self, time);
        &self.state
    }

    pub(crate) fn generic_read_state(&mut self, time: R) {
        self.begun = self.trajectory.begun(self.begun, time.value());
        let Self { trajectory, observer, state, begun } = self;
        trajectory.read(&observer.system, *begun, time, state, &mut observer.at);
    }

    /// The sample at `time` in s: see [`PlantTrajectory::sample`].
    pub fn read(&mut self, time: R) -> PlantSample<R> {
        let mut sample = PlantSample::new(self.trajectory.plant());
        self.read_into(time, &mut sample);
        sample
    }
}

impl<R: Instantiate> PlantTrajectory<R> {
    /// The sample at `time` in s, by dense output; at the instant of an event, what holds after it. Times before the start and
    /// after the end give the first and the last sample. For many samples use [`PlantTrajectory::samples`] or a
    /// [`PlantReader`].
    pub fn sample(&self, time: R) -> PlantSample<R> {
        PlantReader::new(self).read(time)
    }

    /// Samples at `0, interval, 2 interval, …` and at the end, interval in s above zero.
    pub fn samples(&self, interval: f64) -> impl Iterator<Item = PlantSample<R>> + '_ {
        let mut reader = PlantReader::new(self);
        let times = SampleTimes::new(self.duration().value(), interval);
        times.times().map(move |time| reader.read(R::constant(time)))
    }
}
