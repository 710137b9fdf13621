//! The discrete state of several plants side by side, as masks.
//!
//! Where a border lies between pieces of a law that agree there, each lane takes the piece of its own state by a select. The
//! formulas are those that a [`PlantMode`] names, so that a lane has the numbers of its plant alone, bit for bit.

use super::super::PlantMode;
use super::super::evaluation::{Evaluation, System, Unit};
use super::super::formulas::Formulas;
use super::super::steps::TensionResponse;
use super::super::wire::Wire;
use crate::air::Chamber;
use crate::friction::{Branch, Rubbing, Touch};
use crate::lanes::wide::{Number, Wide};
use crate::line::Hose;
use crate::load::{MomentArm, Motion};
use crate::mechanism::chain::{Contacts, MAX_JOINTS};
use crate::mechanism::{Contact, Mechanism};
use crate::network::flow::{NetworkState, OrificeEnds, SquaredDrive};
use crate::network::formulas::FlowFormulas;
use crate::network::implicit::RegulatedResponse;
use crate::network::piping::Orifice;
use crate::network::{BranchKind, Network, NodeKind};
use crate::scalar::{Differentiable, Mask, Over, Scalar};
use crate::simulation::{Extent, Sliding};
use crate::valve::Port;
use alloc::vec;
use alloc::vec::Vec;

/// Of an actuator in every lane.
#[derive(Clone, Copy, Debug)]
struct HeldActuator<W: Scalar> {
    slack: W::Mask,
    taut: W::Mask,
    stuck: W::Mask,
    on_stop: W::Mask,
    /// Whether it has no tension: the sum of its forces is kept from pushing, or it is slack, or it sticks.
    idle: W::Mask,
    /// −1, 0 or +1.
    direction: W,
    /// Of a hysteresis that follows the length alone.
    branch: Branch<W>,
}

/// The same as numbers, 1 where something holds and 0 elsewhere, so that one lane is entered without the others.
#[derive(Clone, Copy, Debug)]
struct Flags<W> {
    slack: W,
    taut: W,
    stuck: W,
    on_stop: W,
    idle: W,
    direction: W,
}

/// The discrete states of the plants in all lanes.
#[derive(Clone, Debug)]
pub(super) struct Held<W: Scalar> {
    actuators: Vec<HeldActuator<W>>,
    frozen: Vec<W::Mask>,
    flows: HeldFlows<W>,
    flags: Vec<Flags<W>>,
    frozen_flags: Vec<W>,
    open_flags: Vec<W>,
    /// Whether actuators have a hysteresis that follows the length alone.
    has_branches: Vec<bool>,
}

/// Which branches are open, and of compressors which run.
#[derive(Clone, Debug)]
pub(super) struct HeldFlows<W: Scalar>(Vec<W::Mask>);

/// Whether lanes can take the stages of a plant with a structure.
pub(super) fn covers_structure(plant: &super::super::Plant) -> bool {
    let actuators = plant.actuators.iter().all(|mounted| {
        let law = mounted.actuator.law();
        let smooth = law.effectiveness.piece_bounds(0).1.is_none()
            && law.law.length_bounds(0).1.is_none()
            && law.law.pressure_bounds(0).1.is_none();
        mounted.tendon.is_none() && mounted.pressure.is_none() && smooth
    });
    let mechanisms = plant.mechanisms.iter().all(|mechanism| !matches!(mechanism, Mechanism::Prescribed(_)));
    let nodes =
        plant.network.nodes.iter().all(|node| !matches!(node.kind, NodeKind::Outlet { .. } | NodeKind::Port { .. }));
    actuators && mechanisms && nodes
}

/// Whether a lane can take a step in a mode from a time in s on.
pub(super) fn covers_mode<R: Number>(mode: &PlantMode<R>, time: R) -> bool {
    let touches = |contact: &Contact| *contact != Contact::None;
    let mechanism = mode.mechanisms.iter().all(|its| {
        (its.basis.is_empty() || its.frozen) && !its.stops.iter().flatten().any(touches) && !touches(&its.foot)
    });
    let subsonic = mode.network.branches.iter().all(|its| its.sonic.is_none());
    mechanism && subsonic && mode.network.valves.iter().all(|valve| valve.openings.at(time).is_none())
}

impl<W: Wide> Held<W> {
    /// Of a plant, before any lane is entered.
    #[inline(always)]
    pub(super) fn new(system: &System<W>) -> Self {
        let (no, zero, plant) = (W::Mask::splat(false), W::zero(), &system.plant);
        let nothing = HeldActuator {
            slack: no,
            taut: no,
            stuck: no,
            on_stop: no,
            idle: no,
            direction: zero,
            branch: Branch::nothing(),
        };
        let mut has_branches = Vec::new();
        for wire in &system.wires {
            let friction = wire.member.actuator.friction();
            has_branches.push(friction.hysteresis().is_some() && friction.lugre().is_none());
        }
        let flags = Flags { slack: zero, taut: zero, stuck: zero, on_stop: zero, idle: zero, direction: zero };
        Self {
            actuators: vec![nothing; plant.actuators.len()],
            frozen: vec![no; plant.mechanisms.len()],
            flows: HeldFlows(vec![no; plant.network.branches.len()]),
            flags: vec![flags; plant.actuators.len()],
            frozen_flags: vec![zero; plant.mechanisms.len()],
            open_flags: vec![zero; plant.network.branches.len()],
            has_branches,
        }
    }

    /// Enters the mode of the row in a lane; [`Held::update`] makes masks of it.
    pub(super) fn enter<S: Scalar>(&mut self, lane: usize, network: &Network<S>, mode: &PlantMode<W::Lane>) {
        let put = |number: &mut W, holds: bool| number.put(lane, W::Lane::constant(if holds { 1.0 } else { 0.0 }));
        for (flags, its) in self.flags.iter_mut().zip(&mode.actuators) {
            let (slack, stuck) = (its.mode.extent == Extent::Slack, its.mode.sliding == Sliding::Stuck);
            put(&mut flags.slack, slack);
            put(&mut flags.taut, its.mode.extent == Extent::Taut);
            put(&mut flags.stuck, stuck);
            put(&mut flags.on_stop, its.on_stop);
            put(&mut flags.idle, slack || stuck || its.mode.clamped);
            flags.direction.put(lane, W::Lane::constant(its.mode.sliding.direction()));
        }
        for (held, its) in self.actuators.iter_mut().zip(&mode.actuators) {
            if let Some(trace) = &its.trace {
                let (of_lanes, branch) = (&mut held.branch, trace.branch());
                of_lanes.from.put(lane, branch.from);
                of_lanes.width.put(lane, branch.width);
                of_lanes.slope.put(lane, branch.slope);
                of_lanes.decay.put(lane, branch.decay);
            }
        }
        for (flag, its) in self.frozen_flags.iter_mut().zip(&mode.mechanisms) {
            put(flag, its.frozen);
        }
        for ((flag, branch), its) in self.open_flags.iter_mut().zip(&network.branches).zip(&mode.network.branches) {
            let open = match branch.kind {
                BranchKind::Path { valve, port, .. } => {
                    let ports = mode.network.valves[valve].ports;
                    if port == Port::Supply { ports.supply } else { ports.exhaust }
                }
                _ => true,
            };
            let runs = !matches!(branch.kind, BranchKind::Compressor) || its.runs;
            put(flag, open && runs);
        }
    }

    /// Makes masks of what has been entered.
    #[inline(always)]
    pub(super) fn update(&mut self) {
        let zero = W::zero();
        for (masks, flags) in self.actuators.iter_mut().zip(&self.flags) {
            masks.slack = zero.lt(flags.slack);
            masks.taut = zero.lt(flags.taut);
            masks.stuck = zero.lt(flags.stuck);
            masks.on_stop = zero.lt(flags.on_stop);
            masks.idle = zero.lt(flags.idle);
            masks.direction = flags.direction;
        }
        for (mask, flag) in self.frozen.iter_mut().zip(&self.frozen_flags) {
            *mask = zero.lt(*flag);
        }
        for (mask, flag) in self.flows.0.iter_mut().zip(&self.open_flags) {
            *mask = zero.lt(*flag);
        }
    }

    /// Where an actuator rests on its shortest length.
    #[inline(always)]
    pub(super) fn is_on_stop(&self, actuator: usize) -> W::Mask {
        self.actuators[actuator].on_stop
    }

    /// Force of the hysteresis over the secant stiffness in m, at a length and a velocity, if there is such a law.
    #[inline(always)]
    pub(super) fn width<T: Over<W>>(&self, wire: &Wire<W>, [length, velocity]: [T; 2], bent: Option<T>) -> Option<T> {
        let held = &self.actuators[wire.index];
        match (bent, wire.member.actuator.friction().lugre()) {
            (Some(bent), Some(law)) => Some(law.width_at(bent, velocity, T::of(held.direction))),
            _ if self.has_branches[wire.index] => Some(held.branch.width_in_lanes(length)),
            _ => None,
        }
    }

    /// The sum of the forces of an actuator at its length, velocity and pressure.
    #[inline(always)]
    pub(super) fn signed_force<T: Over<W>>(&self, wire: &Wire<W>, ends: [T; 3], bent: Option<T>) -> T {
        let (held, actuator) = (&self.actuators[wire.index], &wire.member.actuator);
        let factors = actuator.factors(ends[0], ends[2]);
        let width = self.width(wire, [ends[0], ends[1]], bent);
        let rubbing = Rubbing { direction: T::of(held.direction), width, touch: Touch::Pressed };
        let force = actuator.signed_force(ends, rubbing, held.taut, factors);
        if actuator.friction().has_direction() {
            let apart = ends[2].lt(T::of(actuator.air().atmosphere().0));
            if apart.any() {
                let rubbing = Rubbing { touch: Touch::Apart, ..rubbing };
                return T::select(apart, actuator.signed_force(ends, rubbing, held.taut, factors), force);
            }
        }
        force
    }
}

impl<W: Wide> Formulas<W> for Held<W> {
    type Flows = HeldFlows<W>;

    #[inline(always)]
    fn flows(&self) -> &HeldFlows<W> {
        &self.flows
    }

    #[inline(always)]
    fn enter_pieces(&mut self, _: &System<W>, _: W, _: &[W], _: &mut Evaluation<W>) {}

    #[inline(always)]
    fn is_slack(&self, actuator: usize) -> W::Mask {
        self.actuators[actuator].slack
    }

    #[inline(always)]
    fn is_stuck(&self, actuator: usize) -> W::Mask {
        self.actuators[actuator].stuck
    }

    #[inline(always)]
    fn is_frozen(&self, mechanism: usize) -> W::Mask {
        self.frozen[mechanism]
    }

    #[inline(always)]
    fn arm<T: Over<W>>(&self, _: usize, arm: &MomentArm<W>, angle: T) -> [T; 2] {
        arm.at(angle)
    }

    #[inline(always)]
    fn torques<T: Over<W>>(&self, system: &System<W>, m: usize, (angle, rate): (&[T], &[T]), torque: &mut [T]) {
        if let Mechanism::Chain(chain) = &system.plant.mechanisms[m] {
            let none = [[Contact::None; 2]; MAX_JOINTS];
            chain.torques(angle, rate, Contacts { stops: &none, foot: Contact::None }, torque);
        }
    }

    #[inline(always)]
    fn tension<T: Over<W>>(&self, wire: &Wire<W>, ends: [T; 3], bent: Option<T>) -> T {
        T::select(self.actuators[wire.index].idle, T::zero(), self.signed_force(wire, ends, bent))
    }

    #[inline(always)]
    fn bristle_rate<T: Over<W>>(&self, wire: &Wire<W>, deflection: T, velocity: T) -> T {
        let held = &self.actuators[wire.index];
        match wire.member.actuator.friction().lugre() {
            Some(law) => {
                let rate = law.rate(deflection, velocity, T::of(held.direction));
                T::select(held.slack, T::zero(), rate)
            }
            None => T::zero(),
        }
    }

    // What lanes do not cover.

    fn motion<T: Over<W>>(&self, _: usize, _: &Motion<W>, _: T) -> [T; 3] {
        [T::zero(); 3]
    }

    fn given_rate<T: Over<W>>(&self, _: &System<W>, _: usize, _: T) -> T {
        T::zero()
    }

    fn enter_end<T: Differentiable<W>>(
        &self,
        _: &System<W>,
        _: usize,
        _: Option<T>,
        _: (&mut Unit<T>, &mut Chamber<T>),
    ) {
    }

    fn end_response(&self, _: &System<W>, _: usize, _: W, _: &[W], _: &Evaluation<W>) -> TensionResponse<W> {
        TensionResponse::none()
    }

    fn hold<T: Differentiable<W>>(&self, _: &System<W>, _: usize, _: &[T], _: &mut Evaluation<T>) {}
}

impl<W: Wide> FlowFormulas<W> for HeldFlows<W> {
    #[inline(always)]
    fn orifice<T: Over<W>>(
        &self,
        orifice: &Orifice<W>,
        ends: OrificeEnds<'_, T, impl SquaredDrive<T>>,
        _: T,
    ) -> Option<(W::Mask, T)> {
        let mut open = self.0[orifice.branch];
        if !open.any() {
            return None;
        }
        let [near, far] = ends.pressures();
        if orifice.opened.is_none() {
            // A check valve lets nothing back.
            open = open & far.le(near);
        }
        let (critical, laminar) = (T::of(orifice.law.critical_ratio()), T::of(orifice.law.laminar_ratio()));
        let is_inward = far.le(near);
        // No closures: they would be compiled by themselves, without the instructions of a batch.
        let flow = if !(!is_inward).any() {
            ends.inwards(orifice, [critical, laminar])
        } else if is_inward.any() {
            let flows = [ends.inwards(orifice, [critical, laminar]), ends.outwards(orifice, [critical, laminar])];
            T::select(is_inward, flows[0], flows[1])
        } else {
            ends.outwards(orifice, [critical, laminar])
        };
        Some((is_inward, T::select(open, flow, T::zero())))
    }

    #[inline(always)]
    fn is_under_way(&self, _: W) -> bool {
        false
    }

    #[inline(always)]
    fn loss<T: Over<W>>(&self, _: usize, hose: &Hose<W>, [near, far]: [T; 2]) -> T {
        hose.tube().flow_in_lanes(near, far)
    }

    #[inline(always)]
    fn runs(&self, branch: usize) -> W::Mask {
        self.0[branch]
    }

    // What lanes do not cover.

    fn regulated_rate<T: Over<W>>(&self, _: &Network<W>, _: usize, _: &NetworkState<T>) -> T {
        T::zero()
    }

    fn regulated_response(&self, _: &Network<W>, _: usize, _: W) -> RegulatedResponse<W> {
        RegulatedResponse { answer: W::zero(), own: W::one(), by_inlet: W::zero() }
    }

    fn sonic<T: Over<W>>(&self, _: &Network<W>, _: usize) -> Option<(usize, T)> {
        None
    }
}
