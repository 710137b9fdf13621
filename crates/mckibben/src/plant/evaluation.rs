//! Everything that a plant does at an instant: distances, flows, tensions, accelerations, and with them the rates of all
//! states.
//!
//! ```text
//! mechanism  →  distances x, ẋ            J = ∂x/∂q
//! air        →  chambers, flows ṁ         (19)(21)(23)
//! tendon     →  L̇ by the balance of both tensions
//! actuator   →  tension F (12), dP/dt
//! mechanism  →  M q̈ = τ − h − Σ Jᵀ F      (16), with what friction holds at rest
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | q, M, h, τ | coordinates of a mechanism, its inertia, its velocity terms and the forces on it | m or rad, … |
//! | x, J | distances of the actuators and their gradients over the coordinates | m, m per unit |
//! | ṁ, P | mass flows through branches, absolute pressures of nodes and actuators | kg/s, Pa |
//! | L, F | length and tension of an actuator | m, N |
//!
//! It is done once for rates, samples, guards and audits alike, over any scalar; the discrete state says which
//! [formulas](super::formulas) hold.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.1, for one actuator; virtual work for several. Checked by
//! `tests/simulation.rs`, `tests/joint.rs` and, against an independent program, `tests/plant_reference.rs`.

use super::Plant;
use super::formulas::Formulas;
use super::held_motion::Holding;
use super::mode::ActuatorMode;
use super::wire::{Assembly, Wire};
use crate::air::{Air, Chamber, Flow};
use crate::friction::Deflections;
use crate::line::split;
use crate::mechanism::Coupling;
use crate::network::NodeKind;
use crate::network::flow::{AroundNetwork, NetworkState};
use crate::network::formulas::FlowFormulas;
use crate::network::piping::Piping;
use crate::scalar::{Differentiable, Over, Real, Scalar, Work};
use crate::simulation::LengthRegime;
use crate::simulation::member::Member;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

/// An actuator at an instant.
#[derive(Clone, Copy, Debug)]
pub struct Unit<T> {
    /// Between the attachments in m.
    pub distance: T,
    /// Its rate in m/s.
    pub rate: T,
    /// Of the actuator in m: without a tendon the distance, as long as it is not slack.
    pub length: T,
    /// The rate of the length in m/s.
    pub velocity: T,
    /// In N; of a sticking actuator without a tendon not known here.
    pub tension: T,
    /// What flows into its chamber and out, in kg/s.
    pub flow: Flow<T>,
    pub(crate) warmth: T,
    /// The rate of its pressure in Pa/s.
    pub pressure_rate: T,
    pub(crate) mass_rate: T,
}

/// A plant at an instant, and room for what is computed on the way.
#[derive(Clone, Debug)]
pub struct Evaluation<T: Scalar> {
    /// The actuators.
    pub units: Vec<Unit<T>>,
    /// Their chambers.
    pub chambers: Vec<Chamber<T>>,
    /// The air network.
    pub network: NetworkState<T>,
    /// `J`: the gradient of each actuator's distance over the coordinates of its mechanism.
    pub gradient: Vec<T>,
    /// Accelerations of all coordinates.
    pub(crate) acceleration: Vec<T>,
    /// Of the segments of all chains, by their coordinates: sine and cosine of their inclinations.
    pub(crate) directions: Vec<[T; 2]>,
    /// Forces on the coordinates of one mechanism, and its mass matrix.
    pub force: Vec<T>,
    pub(crate) matrix: Vec<T>,
    pub(super) holding: Holding<T>,
    /// How fast the pressure of each node settles, in 1/s.
    pub(crate) settling: Vec<f64>,
}

impl<T: Scalar> Evaluation<T> {
    /// Room for a plant.
    pub fn new<R: Scalar>(plant: &Plant<R>) -> Self
    where
        T: Over<R>,
    {
        let zero = T::zero();
        let unit = Unit {
            distance: zero,
            rate: zero,
            length: zero,
            velocity: zero,
            tension: zero,
            flow: Flow::none(),
            warmth: zero,
            pressure_rate: zero,
            mass_rate: zero,
        };
        let actuators = plant.actuators.len();
        let coordinates = plant.places.mechanisms.iter().map(|places| places.coordinates);
        let most = coordinates.clone().max().unwrap_or(0);
        // The gradient of a coordinate itself does not change.
        let mut gradient = vec![zero; plant.places.gradients];
        for (mounted, here) in plant.actuators.iter().zip(&plant.places.actuators) {
            if let Coupling::Direct { coordinate } = mounted.coupling {
                gradient[here.gradient + coordinate] = T::one();
            }
        }
        Self {
            units: vec![unit; actuators],
            chambers: vec![Chamber::new(T::one(), T::one(), T::one(), zero); actuators],
            network: NetworkState::new(&plant.network),
            gradient,
            acceleration: vec![zero; coordinates.clone().sum()],
            directions: vec![[zero; 2]; coordinates.sum()],
            force: vec![zero; most],
            matrix: vec![zero; most * most],
            holding: Holding::new(most),
            settling: vec![0.0; plant.network.nodes.len()],
        }
    }

    /// Takes on the numbers of another plant of equal structure.
    #[inline(always)]
    pub fn adapt<R: Scalar>(&mut self, plant: &Plant<R>)
    where
        T: Over<R>,
    {
        self.network.adapt(&plant.network);
    }
}

/// A plant with what separates its events from rounding.
#[derive(Clone, Debug)]
pub struct System<R: Scalar> {
    /// The plant.
    pub plant: Arc<Plant<R>>,
    /// Its actuators with their places.
    pub wires: Vec<Wire<R>>,
    /// Its mechanisms with their places.
    pub assemblies: Vec<Assembly<R>>,
    pub(crate) piping: Piping<R>,
    /// Relative width of a border between agreeing formulas.
    pub(crate) band: f64,
    /// Usual arms of the actuators, and usual torques on each mechanism.
    pub(crate) arms: Vec<f64>,
    pub(crate) usual_torque: Vec<f64>,
    /// Usual speeds in m/s of prescribed motions; infinite of other mechanisms.
    pub(crate) usual_speeds: Vec<f64>,
    /// The largest part by which a number of the plant changes with each direction of its derivatives.
    pub(crate) influences: Vec<f64>,
}

/// How much of a plant is computed.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Scope {
    /// Distances and chambers.
    Distances,
    /// With them all flows.
    Air,
    /// With them tensions and accelerations.
    Motion,
    /// With them the rates of all states, without tensions that change none.
    Rates,
}

/// The evaluation of a plant. There are many callers, and it is long: it is compiled once for each scalar, in a
/// separate function.
struct Compute<'a, R: Scalar, T: Scalar, F> {
    system: &'a System<R>,
    scope: Scope,
    time: T,
    state: &'a [T],
    mode: &'a F,
    at: &'a mut Evaluation<T>,
    rates: &'a mut [T],
}

impl<R: Scalar, T: Differentiable<R>, F: Formulas<R>> Work for Compute<'_, R, T, F> {
    type Output = ();

    #[inline(always)]
    fn done(self) {
        let Self { system, scope, time, state, mode, at, rates } = self;
        system.compute_distances(time, state, mode, at);
        if scope >= Scope::Air {
            system.enter_flows(time, state, mode, at);
        }
        if scope == Scope::Air {
            for (i, wire) in system.wires.iter().enumerate() {
                system.fill(wire, time, mode, &at.network, &mut at.units[i]);
            }
        }
        if scope >= Scope::Motion {
            system.enter_actuators(scope, time, state, mode, at);
            for assembly in &system.assemblies {
                system.accelerate(assembly, time, state, mode, at);
            }
        }
        if scope == Scope::Rates {
            system.enter_rates(time, state, mode, at, rates);
        }
    }
}

/// The flow that the rate of a given pressure takes.
struct FlowFor<'a, R: Scalar, T> {
    air: &'a Air<R>,
    chamber: &'a Chamber<T>,
    rate: T,
}

impl<R: Scalar, T: Over<R>> Work for FlowFor<'_, R, T> {
    type Output = T;

    #[inline(always)]
    fn done(self) -> T {
        self.air.flow_for(self.chamber, self.rate)
    }
}

impl<R: Scalar> System<R> {
    /// Of a plant in lanes, which watch their events individually: its borders have no width.
    #[inline(always)]
    pub fn in_lanes(plant: Plant<R>) -> Self {
        let plant = Arc::new(plant);
        let wires = plant.actuators.iter().enumerate();
        let wires = wires.map(|(index, mounted)| Wire::new(&plant, index, Member::in_lanes(&mounted.actuator)));
        Self {
            wires: wires.collect(),
            assemblies: (0..plant.mechanisms.len()).map(|m| Assembly::new(&plant, m)).collect(),
            piping: Piping::new(&plant),
            band: 0.0,
            arms: Vec::new(),
            usual_torque: Vec::new(),
            usual_speeds: Vec::new(),
            influences: Vec::new(),
            plant,
        }
    }

    /// Gradient of an actuator's distance.
    #[inline(always)]
    pub fn gradient<'e, T>(&self, i: usize, gradient: &'e [T]) -> &'e [T] {
        let plant = &*self.plant;
        let from = plant.places.actuators[i].gradient;
        &gradient[from..from + plant.places.mechanisms[plant.actuators[i].mechanism].coordinates]
    }

    /// What the states say of an actuator's friction.
    #[allow(clippy::manual_map, reason = "a closure would be compiled separately, without the instructions of a batch")]
    #[inline(always)]
    pub fn deflections<T: Over<R>>(&self, i: usize, state: &[T]) -> Deflections<T> {
        let wire = &self.wires[i];
        let bristles = match wire.places.bristles {
            Some(place) => Some(state[place]),
            None => None,
        };
        let branches = match wire.member.actuator.friction().viscoelastic() {
            Some(law) => Some(law.sums(&state[wire.places.branches()])),
            None => None,
        };
        Deflections { bristles, branches }
    }

    /// Computes everything at a time in s and a state.
    #[inline(always)]
    pub fn evaluate<T: Differentiable<R>>(
        &self,
        time: T,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
    ) {
        T::apart(Compute { system: self, scope: Scope::Motion, time, state, mode, at, rates: &mut [] });
    }

    /// Computes distances and chambers.
    #[inline(always)]
    pub fn enter_distances<T: Differentiable<R>>(
        &self,
        time: T,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
    ) {
        T::apart(Compute { system: self, scope: Scope::Distances, time, state, mode, at, rates: &mut [] });
    }

    /// Computes distances, chambers, all flows, and what of them goes into each chamber.
    #[inline(always)]
    pub fn enter_air<T: Differentiable<R>>(
        &self,
        time: T,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
    ) {
        T::apart(Compute { system: self, scope: Scope::Air, time, state, mode, at, rates: &mut [] });
    }

    /// The rates of all states at a time in s. The tension of an actuator whose ends are moved is not known then.
    #[inline(always)]
    pub(crate) fn rates<T: Differentiable<R>>(
        &self,
        time: T,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
        rates: &mut [T],
    ) {
        T::apart(Compute { system: self, scope: Scope::Rates, time, state, mode, at, rates });
    }

    /// Takes what flows into the chamber of an actuator, or the rate of a pressure that is given, which an end on a tendon
    /// follows.
    #[inline(always)]
    fn fill<T: Over<R>>(
        &self,
        wire: &Wire<R>,
        time: T,
        mode: &impl Formulas<R>,
        network: &NetworkState<T>,
        unit: &mut Unit<T>,
    ) {
        (unit.flow, unit.warmth) = match wire.chamber {
            Some(node) => {
                let node = &network.nodes[node];
                (Flow { inward: node.inward, outward: node.outward }, node.warmth)
            }
            None => (Flow::none(), T::zero()),
        };
        if wire.is_given {
            unit.pressure_rate = mode.given_rate(self, wire.index, time);
        }
    }

    /// Computes all flows.
    #[inline(always)]
    fn enter_flows<T: Over<R>>(&self, time: T, state: &[T], mode: &impl Formulas<R>, at: &mut Evaluation<T>) {
        let Some(first) = self.wires.first() else { return };
        let around = AroundNetwork { chambers: &at.chambers, state };
        let air = first.member.actuator.air();
        self.plant.network.flows(time, &self.piping, around, air, mode.flows(), &mut at.network);
    }

    /// Computes tensions and air of all actuators, whose flows are known; for rates alone the tensions to which states answer.
    #[inline(always)]
    fn enter_actuators<T: Differentiable<R>>(
        &self,
        scope: Scope,
        time: T,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
    ) {
        let Evaluation { units, chambers, network, .. } = at;
        for (i, wire) in self.wires.iter().enumerate() {
            let (unit, chamber) = (&mut units[i], &mut chambers[i]);
            self.fill(wire, time, mode, network, unit);
            if wire.places.length.is_some() {
                self.enter_end(i, mode, self.deflections(i, state), (unit, chamber));
            } else if wire.is_answered || scope == Scope::Motion {
                let ends = [unit.length, unit.velocity, chamber.pressure];
                unit.tension = mode.tension(wire, ends, self.deflections(i, state));
            }
            if wire.is_given {
                let air = self.plant.actuators[i].actuator.air();
                unit.flow = split(T::apart(FlowFor { air, chamber, rate: unit.pressure_rate }));
            } else {
                unit.pressure_rate = wire.member.actuator.air().pressure_rate_by(chamber, &unit.flow, || unit.warmth);
            }
            unit.mass_rate = unit.flow.net();
        }
    }

    /// Writes the rates of all states, once everything is computed.
    #[inline(always)]
    fn enter_rates<T: Differentiable<R>>(
        &self,
        time: T,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &Evaluation<T>,
        rates: &mut [T],
    ) {
        for (wire, unit) in self.wires.iter().zip(&at.units) {
            let places = &wire.places;
            (rates[places.pressure], rates[places.pressure + 1]) = (unit.pressure_rate, unit.mass_rate);
            if let Some(place) = places.length {
                rates[place] = unit.velocity;
            }
            if let Some(place) = places.bristles {
                rates[place] = mode.bristle_rate(wire, state[place], unit.velocity);
            }
            if let Some(law) = wire.member.actuator.friction().viscoelastic() {
                let length = wire.resting_length(mode.is_slack(wire.index), unit.length);
                for (branch, place) in places.branches().enumerate() {
                    rates[place] = law.rate(branch, state[place], length);
                }
            }
        }
        for assembly in &self.assemblies {
            self.enter_motion(assembly, time, state, mode, &at.acceleration, rates);
        }
        let Plant { network, places, .. } = &*self.plant;
        for &[node, place] in &places.state_nodes {
            rates[place] = network.node_rate(node, mode.flows(), &at.network);
        }
        for &[branch, place] in &places.state_branches {
            rates[place] = match mode.flows().sonic::<T>(network, branch) {
                None => network.branch_rate(branch, &at.network),
                Some((behind, per_pressure)) => per_pressure * self.pressure_rate(behind, mode, at),
            };
        }
    }

    /// The rate of the pressure of a node in Pa/s, once everything is evaluated.
    #[inline(always)]
    pub(crate) fn pressure_rate<T: Over<R>>(&self, node: usize, mode: &impl Formulas<R>, at: &Evaluation<T>) -> T {
        match self.plant.network.nodes[node].kind {
            NodeKind::Chamber { actuator } => at.units[actuator].pressure_rate,
            _ => self.plant.network.node_rate(node, mode.flows(), &at.network),
        }
    }
}

impl<R: Real> Wire<R> {
    /// The rate of the bristles in m/s.
    #[inline(always)]
    pub(super) fn bristle_rate<T: Over<R>>(&self, deflection: T, velocity: T, of_actuator: &ActuatorMode<R>) -> T {
        match self.member.lugre() {
            Some(law) if of_actuator.mode.length_regime != LengthRegime::Slack => {
                law.rate(deflection, velocity, T::constant(of_actuator.mode.sliding.direction()))
            }
            _ => T::zero(),
        }
    }
}
