//! The size of each state, by which errors are measured, and how fast states settle.

use super::dense;
use super::evaluation::{Evaluation, System};
use super::formulas::Formulas;
use super::mode::PlantMode;
use super::wire::{Assembly, Wire};
use super::{Mounted, Plant};
use crate::dual::Dual;
use crate::mechanism::{Contact, Mechanism};
use crate::network::formulas::FlowFormulas;
use crate::network::piping::Piping;
use crate::network::{BranchKind, NodeKind};
use crate::scalar::{Real, Scalar};
use crate::simulation::member::Member;
use crate::simulation::{LengthRegime, Sliding};
use crate::valve::FlowZone;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

/// The largest part by which a number of a plant changes with each direction of its derivatives; numbers that are zero have none.
fn influences<R: Real>(plant: &Plant<R>) -> Vec<f64> {
    let mut influences = vec![0.0_f64; R::SLOPES];
    if R::HAS_DERIVATIVES {
        let _ = plant.map(|_, _, number: R| {
            if number.value() != 0.0 {
                for (direction, most) in influences.iter_mut().enumerate() {
                    *most = most.max((number.slope(direction) / number.value()).abs());
                }
            }
            number
        });
    }
    influences
}

/// The part of the usual velocity below which its error counts absolutely.
const SLOW: f64 = 0.1;
/// Rate of settling for which two pressures that would meet in a second count.
const MEETING: f64 = 4.0;
/// Part of the depth under the usual torque by which a pressed stop is measured.
const PRESSED: f64 = 0.5;

impl<R: Real> System<R> {
    /// A plant whose steps are controlled to `relative_tolerance`.
    pub(crate) fn new(plant: &Arc<Plant<R>>, relative_tolerance: f64) -> Self {
        let wire = |(index, mounted): (usize, &Mounted<R>)| {
            let arm = usual_arm(plant, mounted);
            let pull = match &plant.mechanisms[mounted.mechanism] {
                Mechanism::Mass(mass) => mass.pull().value().abs(),
                Mechanism::Chain(chain) => chain.usual_torque() / arm,
                _ => 0.0,
            };
            Wire::new(plant, index, Member::new(&mounted.actuator, relative_tolerance, pull))
        };
        let wires: Vec<Wire<R>> = plant.actuators.iter().enumerate().map(wire).collect();
        let band = wires.first().map_or(relative_tolerance, |wire| wire.member.band);
        let piping = Piping::new(plant);
        let assemblies = (0..plant.mechanisms.len()).map(|m| Assembly::new(plant, m)).collect();
        let plant = plant.clone();
        let influences = influences(&plant);
        let (usual_torque, arms) = (Vec::new(), Vec::new());
        let speed = |mechanism: &Mechanism<R>| match mechanism {
            Mechanism::Prescribed(motion) => motion.usual_speed(),
            _ => f64::INFINITY,
        };
        let usual_speeds = plant.mechanisms.iter().map(speed).collect();
        let mut system = Self { plant, wires, assemblies, piping, band, usual_torque, arms, usual_speeds, influences };
        system.enter_usual();
        system
    }

    /// Usual arms of the actuators, and the torques that they make.
    fn enter_usual(&mut self) {
        let plant = self.plant.clone();
        self.arms = plant.actuators.iter().map(|mounted| usual_arm(&plant, mounted)).collect();
        self.usual_torque = vec![0.0; plant.mechanisms.len()];
        for (i, mounted) in plant.actuators.iter().enumerate() {
            self.usual_torque[mounted.mechanism] += self.arms[i] * self.wires[i].member.force_band / self.band;
        }
        for (m, mechanism) in plant.mechanisms.iter().enumerate() {
            if let (Mechanism::Chain(chain), true) = (mechanism, plant.places.members[m].is_empty()) {
                let own = chain.usual_torque();
                self.usual_torque[m] = if own > 0.0 { own } else { 1.0 };
            }
        }
    }

    /// Scales of the states in a mode, above zero.
    pub(crate) fn scales(&self, state: &[R], mode: &PlantMode<R>, scales: &mut [f64]) {
        let plant = &*self.plant;
        for (scale, value) in scales.iter_mut().zip(state) {
            *scale = value.value().abs();
        }
        for (m, mechanism) in plant.mechanisms.iter().enumerate() {
            let here = &plant.places.mechanisms[m];
            let its = &mode.mechanisms[m];
            // An actuator measures the coordinates that it spans by its own length.
            let (mut usual, mut stiff) = (f64::INFINITY, f64::INFINITY);
            for &i in &plant.places.members[m] {
                let (member, arm) = (&self.wires[i].member, self.arms[i]);
                usual = usual.min(member.longest / arm);
                if matches!(mode.actuators[i].mode.length_regime, LengthRegime::Taut | LengthRegime::Rebound) {
                    stiff = stiff.min(member.taut_scale / arm);
                }
                if let Some(tendon) = &plant.actuators[i].tendon {
                    stiff = stiff.min(self.tendon_scale(i, tendon) / arm);
                }
            }
            let chain = match mechanism {
                Mechanism::Chain(chain) => Some(chain),
                _ => None,
            };
            if chain.is_some() {
                usual = usual.min(1.0);
            }
            if !usual.is_finite() {
                usual = 1.0;
            }
            for k in 0..here.coordinates {
                let mut bound = stiff;
                if let Some(chain) = chain {
                    let stops = &chain.joints()[k].stops;
                    if its.stops[k].iter().any(|contact| *contact != Contact::None) {
                        bound = bound.min(PRESSED * self.usual_torque[m] / stops.stiffness.value());
                    }
                    if let (Some(belt), true) = (chain.belt(), its.foot != Contact::None) {
                        let depth = belt.depth.value();
                        bound = bound.min(PRESSED * self.usual_torque[m] / (belt.stiffness.value() * depth * depth));
                    }
                }
                let position = &mut scales[here.position(k)];
                *position = if bound.is_finite() { bound.min(usual) } else { position.max(usual) };
                scales[here.rate(k)] += self.slow(m, usual);
            }
        }
        for (i, here) in plant.places.actuators.iter().enumerate() {
            let member = &self.wires[i].member;
            scales[here.pressure] += 0.1 * member.atmosphere;
            scales[here.pressure + 1] += 0.1 * member.air_mass;
            if let (Some(place), Some(tendon)) = (here.length, &plant.actuators[i].tendon) {
                let taut = matches!(mode.actuators[i].mode.length_regime, LengthRegime::Taut | LengthRegime::Rebound);
                let own = if taut { member.taut_scale } else { member.longest };
                scales[place] = own.min(self.tendon_scale(i, tendon));
            }
            if let (Some(place), Some(law)) = (here.bristles, member.lugre()) {
                scales[place] += law.reach().value();
            }
            for place in here.branches() {
                scales[place] = member.longest;
            }
        }
        let atmosphere = plant.network.atmosphere.value();
        for place in plant.places.nodes.iter().flatten() {
            scales[*place] += 0.1 * atmosphere;
        }
        for (branch, place) in plant.network.branches.iter().zip(&plant.places.branches) {
            if let (BranchKind::Inertia(hose), Some(place)) = (&branch.kind, place) {
                scales[*place] += SLOW * 0.685 * atmosphere * hose.tube().area().value() / hose.wave_speed().value();
            }
        }
    }

    /// The speed in m/s or rad/s by which velocities at rest are measured, of a mechanism with a usual length or angle. A prescribed
    /// motion that is slower is measured by its usual speed: however slow it is, it turns where its velocity changes its sign.
    pub(crate) fn slow(&self, m: usize, usual: f64) -> f64 {
        (SLOW * usual).min(self.usual_speeds[m])
    }

    /// The fastest rate in 1/s at which a state settles, zero when none does; `at` is evaluated at the state.
    pub(crate) fn settling_rate(&self, state: &[R], mode: &PlantMode<R>, at: &mut Evaluation<R>) -> f64 {
        let mut fastest = self.network_settling(mode, at);
        for m in 0..self.plant.mechanisms.len() {
            fastest = fastest.max(self.mechanism_settling(m, state, mode, at));
        }
        for i in 0..self.wires.len() {
            fastest = fastest.max(self.actuator_settling(i, state, mode, at));
        }
        fastest
    }

    /// How fast the rates of a mechanism settle: the trace of `M⁻¹ D`, which no rate exceeds. It overwrites force and matrix.
    fn mechanism_settling(&self, m: usize, state: &[R], mode: &PlantMode<R>, at: &mut Evaluation<R>) -> f64 {
        let its = &mode.mechanisms[m];
        if its.frozen {
            return 0.0;
        }
        let members = &self.plant.places.members[m];
        match &self.plant.mechanisms[m] {
            Mechanism::Mass(mass) => {
                members.iter().map(|&i| self.damping(i, state, mode, at)).sum::<f64>() / mass.mass().value()
            }
            Mechanism::Chain(chain) => {
                let count = self.plant.places.mechanisms[m].coordinates;
                self.mass_matrix(m, &at.directions, &mut at.matrix[..count * count]);
                dense::factor(&mut at.matrix[..count * count], count);
                let mut sum = 0.0;
                let foot = match (chain.belt(), its.foot) {
                    (Some(belt), Contact::Pressed) => belt.damping.value() * belt.depth.value() * belt.depth.value(),
                    _ => 0.0,
                };
                for (k, joint) in chain.joints().iter().enumerate() {
                    let pressed = its.stops[k].contains(&Contact::Pressed);
                    let stop = if pressed { joint.stops.damping.value() } else { 0.0 };
                    let damping = joint.damping.value() + stop + foot;
                    if damping > 0.0 {
                        at.force[..count].fill(R::zero());
                        at.force[k] = R::one();
                        dense::solve(&at.matrix[..count * count], count, &mut at.force[..count]);
                        sum += damping * at.force[k].value();
                    }
                }
                for &i in members {
                    let damping = self.damping(i, state, mode, at);
                    if damping > 0.0 {
                        let gradient = self.gradient(i, &at.gradient);
                        at.force[..count].copy_from_slice(gradient);
                        dense::solve(&at.matrix[..count * count], count, &mut at.force[..count]);
                        sum += damping * dense::dot(gradient, &at.force[..count]).value();
                    }
                }
                sum
            }
            Mechanism::Prescribed(_) | Mechanism::Fixed | Mechanism::External { .. } => 0.0,
        }
    }

    /// `∂F/∂v` in N·s/m of an actuator without a tendon.
    fn damping(&self, i: usize, state: &[R], mode: &PlantMode<R>, at: &Evaluation<R>) -> f64 {
        if self.plant.actuators[i].tendon.is_some() {
            return 0.0;
        }
        let (member, its) = (&self.wires[i].member, &mode.actuators[i]);
        let unit = &at.units[i];
        let plain = member.damping([unit.length, state[self.plant.places.actuators[i].pressure]], &its.mode);
        let moves =
            its.mode.length_regime != LengthRegime::Slack && its.mode.sliding != Sliding::Stuck && !its.mode.clamped;
        let deflections = self.deflections(i, state);
        match deflections.bristles {
            Some(_) if moves => {
                let seeded = |number| Dual::<R, 1> { value: number, slope: [R::zero()] };
                let pressure = seeded(state[self.plant.places.actuators[i].pressure]);
                let ends = [seeded(unit.length), Dual::variable(unit.velocity, 0), pressure];
                let force = member.signed_force(ends, &its.mode, (&its.trace, deflections.constant()));
                plain.max(force.slope[0].value())
            }
            _ => plain,
        }
    }

    /// How fast the bristles, the branches and the length of an actuator settle.
    fn actuator_settling(&self, i: usize, state: &[R], mode: &PlantMode<R>, at: &Evaluation<R>) -> f64 {
        let (mounted, here, its) = (&self.plant.actuators[i], &self.plant.places.actuators[i], &mode.actuators[i]);
        let mut fastest = self.heat_settling(i, at).value();
        let constant = |number: R| Dual::<R, 1> { value: number, slope: [R::zero()] };
        if let (Some(place), Some(law)) = (here.bristles, self.wires[i].member.lugre())
            && its.mode.length_regime != LengthRegime::Slack
        {
            let direction = constant(R::constant(its.mode.sliding.direction()));
            let rate = law.rate(Dual::variable(state[place], 0), constant(at.units[i].velocity), direction);
            fastest = fastest.max(-rate.slope[0].value());
        }
        if let Some(law) = mounted.actuator.friction().viscoelastic() {
            let settling = (0..law.count()).map(|branch| 1.0 / law.relaxation_time(branch).value());
            fastest = settling.fold(fastest, f64::max);
        }
        if let (Some(tendon), Some(_)) = (&mounted.tendon, here.length)
            && its.mode.sliding != Sliding::Stuck
            && mode.is_damped(self, i)
        {
            // F(L, v) = T: ∂v/∂L = −(∂F/∂L + k)/(∂F/∂v).
            let unit = &at.units[i];
            let pressure = state[here.pressure];
            let pull = |length: Dual<R, 1>, velocity: Dual<R, 1>| {
                let deflections = self.deflections(i, state).constant();
                let ends = [length, velocity, constant(pressure)];
                self.wires[i].member.signed_force(ends, &its.mode, (&its.trace, deflections)).slope[0].value()
            };
            let stiffness = if its.loose { 0.0 } else { tendon.stiffness().value() };
            let per_length = pull(Dual::variable(unit.length, 0), constant(unit.velocity)) + stiffness;
            let per_velocity = pull(constant(unit.length), Dual::variable(unit.velocity, 0));
            fastest = fastest.max(per_length / per_velocity);
        }
        fastest
    }

    /// By how much the flow of an orifice, wholly open, or of a lumped hose rises in kg/(s·Pa) with the gap between two pressures
    /// that are equal; zero for other branches.
    fn slope_at_rest(&self, index: usize, mode: &PlantMode<R>, at: &Evaluation<R>) -> f64 {
        let (network, of_branch) = (&self.plant.network, &mode.network.branches[index]);
        let branch = &network.branches[index];
        if let BranchKind::Loss(hose) = &branch.kind {
            let pressure = at.network.nodes[branch.from].pressure;
            let ends = [Dual::<R, 1>::variable(pressure, 0), Dual { value: pressure, slope: [R::zero()] }];
            return mode.network.loss(index, hose, ends).slope[0].value();
        }
        let (BranchKind::Path { law, .. } | BranchKind::Check { law }, Some(zone)) = (&branch.kind, of_branch.zone)
        else {
            return 0.0;
        };
        let air = self.plant.actuators[0].actuator.air();
        let upstream = if zone.is_inward() { branch.from } else { branch.to };
        let temperature = network.temperature(upstream, &at.chambers, air).value();
        (law.conductance() * law.in_zone(zone, R::one)).value() / Scalar::sqrt(temperature)
    }

    /// How fast the pressures of nodes settle against each other: each with the sum of its branches' conductances.
    fn network_settling(&self, mode: &PlantMode<R>, at: &mut Evaluation<R>) -> f64 {
        let network = &self.plant.network;
        if network.branches.is_empty() {
            return 0.0;
        }
        let mut sums = core::mem::take(&mut at.settling);
        sums.fill(0.0);
        // By how much the pressure of each node rises with what flows in, in Pa/kg.
        let answer = |node: usize| match &network.nodes[node].kind {
            NodeKind::Chamber { actuator } => {
                let chamber = &at.chambers[*actuator];
                let air = self.plant.actuators[*actuator].actuator.air();
                (air.index() * chamber.pressure / chamber.mass).value()
            }
            NodeKind::Hose(hose) => hose.stiffness().value(),
            NodeKind::Reservoir(reservoir) => reservoir.pressure_rate(R::one()).value(),
            _ => 0.0,
        };
        let rate = |node: usize| match &network.nodes[node].kind {
            NodeKind::Chamber { actuator } => at.units[*actuator].pressure_rate.value(),
            _ => network.node_rate(node, &mode.network, &at.network).value(),
        };
        let mut fastest: f64 = 0.0;
        for (node, kind) in network.nodes.iter().enumerate() {
            match &kind.kind {
                NodeKind::Outlet { regulator, .. } => {
                    fastest = fastest.max(1.0 / Scalar::larger(regulator.lag().value(), f64::MIN_POSITIVE));
                }
                NodeKind::Port { regulator, .. } => {
                    if let (Some(approach), Some(set)) =
                        (mode.network.nodes[node].approach, network.set_point(node, &mode.network))
                    {
                        let pressure = Dual::<R, 1>::variable(at.network.nodes[node].pressure, 0);
                        let set = Dual { value: set, slope: [R::zero()] };
                        fastest = fastest.max(-regulator.rate_in(approach, pressure, set).slope[0].value());
                    }
                }
                NodeKind::Chamber { actuator } => sums[node] = self.heat_settling(*actuator, at).value(),
                _ => {}
            }
        }
        for (index, (branch, of_branch)) in network.branches.iter().zip(&mode.network.branches).enumerate() {
            let (from, to) = (branch.from, branch.to);
            let [near, far] = [from, to].map(|node| at.network.nodes[node].pressure.value());
            let flow = at.network.flows[index].value();
            let zone = of_branch.zone;
            let gap = near - far;
            let closing = || rate(to) - rate(from);
            // Where the pressures are equal, their flow says nothing of its slope.
            let slope = |gap: f64| {
                if gap == 0.0 { self.slope_at_rest(index, mode, at) } else { (flow / gap).abs() }
            };
            let conductance = match &branch.kind {
                BranchKind::Path { .. } | BranchKind::Check { .. } => match zone {
                    Some(FlowZone::LaminarIn | FlowZone::LaminarOut) => slope(gap),
                    Some(FlowZone::SubsonicIn | FlowZone::SubsonicOut) => {
                        // Below the speed of sound the slope grows without bound as the pressures meet: the time until they
                        // would counts.
                        fastest = fastest.max(MEETING * closing() / gap);
                        (0.5 * flow / gap).abs()
                    }
                    _ => 0.0,
                },
                BranchKind::Loss(_) => {
                    if of_branch.regime != crate::line::FlowRegime::Laminar {
                        let squares = near * near - far * far;
                        let closing = 2.0 * (near * rate(from) - far * rate(to));
                        fastest = fastest.max((MEETING * closing / squares).abs());
                    }
                    slope(gap)
                }
                BranchKind::Leak(_) => slope(gap),
                BranchKind::Inertia(_) | BranchKind::Compressor => 0.0,
            };
            if conductance.is_finite() {
                sums[from] += conductance * answer(from);
                sums[to] += conductance * answer(to);
            }
        }
        for branch in &network.branches {
            if !matches!(branch.kind, BranchKind::Inertia(_)) {
                fastest = fastest.max(sums[branch.from] + sums[branch.to]);
            }
        }
        at.settling = sums;
        fastest
    }
}

/// The largest entry of the gradient of an actuator's distance at coordinates zero: its moment arm, or one.
fn usual_arm<R: Real>(plant: &Plant<R>, mounted: &Mounted<R>) -> f64 {
    let mechanism = &plant.mechanisms[mounted.mechanism];
    let chain = match mechanism {
        Mechanism::Chain(chain) => Some(chain),
        _ => None,
    };
    let position = vec![R::zero(); mechanism.coordinates()];
    let mut gradient = position.clone();
    mounted.coupling.distance_at(chain, &position, &mut gradient);
    let arm = gradient.iter().fold(0.0, |most: f64, entry| most.max(entry.value().abs()));
    if arm.is_finite() && arm > 0.0 { arm } else { 1.0 }
}
