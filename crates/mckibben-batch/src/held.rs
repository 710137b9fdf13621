//! The discrete state of several plants side by side, as masks.
//!
//! Where a border lies between pieces of a law that agree there, each lane takes the piece of its state by a select.
//! The formulas are those that a [`PlantMode`] names, so that a lane is bit-identical to a scalar instance.

use crate::flows::{HeldFlows, enter_line};
use crate::wide::Wide;
use mckibben::Actuator;
use mckibben::air::Chamber;
use mckibben::friction::{Deflections, LuGre};
use mckibben::internals::{
    Branch, Evaluation, Formulas, Presses, SlidingState, StraightLine, System, ThreadContact, Unit, Wire, end_is_damped,
};
use mckibben::load::{MomentArm, Motion};
use mckibben::mechanism::chain::ChainMotion;
use mckibben::mechanism::{Contact, Mechanism};
use mckibben::plant::{Plant, PlantMode};
use mckibben::scalar::{Differentiable, Mask, Over, Scalar};
use mckibben::simulation::{LengthRegime, Sliding};
use std::f64::consts::TAU;

/// Of an actuator in every lane.
#[derive(Clone, Copy, Debug)]
struct HeldActuator<W: Scalar> {
    slack: W::Mask,
    taut: W::Mask,
    stuck: W::Mask,
    on_stop: W::Mask,
    /// Whether it is within its lengths and on no stop, and whether what moves its ends holds them.
    free: W::Mask,
    still: W::Mask,
    /// Whether its tendon hangs loose.
    loose: W::Mask,
    /// Whether it has no tension: the sum of its forces is kept from pushing, or it is slack, or it sticks.
    idle: W::Mask,
    /// −1, 0 or +1.
    direction: W,
    /// Of a hysteresis that follows the length alone.
    branch: Branch<W>,
}

/// Flags as numbers, 1 where something holds and 0 elsewhere, so that one lane is entered without the others.
#[derive(Clone, Copy, Debug)]
struct Flags<W> {
    slack: W,
    taut: W,
    stuck: W,
    on_stop: W,
    free: W,
    still: W,
    /// Whether its friction has a direction.
    directed: W,
    loose: W,
    idle: W,
    direction: W,
}

/// What a given motion does: the line of a table under way, or the phase of a sinusoid in rad.
#[derive(Clone, Copy, Debug)]
enum HeldMotion<W> {
    Line(StraightLine<W>),
    Phase(W),
}

/// Which contacts of a chain press.
#[derive(Clone, Debug)]
struct HeldContacts<W: Scalar> {
    /// At the least and the greatest angle of each joint.
    stops: Vec<[W::Mask; 2]>,
    foot: W::Mask,
    stop_flags: Vec<[W; 2]>,
    foot_flag: W,
}

/// Which actuators of a chain that moves on stick: a list in every lane, of those whose gradients are independent.
#[derive(Clone, Debug)]
struct HeldRows<W: Scalar> {
    /// By place in the list and by member of the mechanism: where it stands there.
    is_member: Vec<Vec<W::Mask>>,
    member_flags: Vec<Vec<W>>,
    /// How long the longest list is.
    count: usize,
}

/// The discrete states of the plants in all lanes.
#[derive(Clone, Debug)]
pub(crate) struct Held<W: Scalar> {
    actuators: Vec<HeldActuator<W>>,
    frozen: Vec<W::Mask>,
    flows: HeldFlows<W>,
    contacts: Vec<HeldContacts<W>>,
    rows: Vec<HeldRows<W>>,
    flags: Vec<Flags<W>>,
    frozen_flags: Vec<W>,
    /// Whether actuators have a hysteresis that follows the length alone.
    has_branches: Vec<bool>,
    /// Of mechanisms whose motion is given.
    motions: Vec<Option<HeldMotion<W>>>,
    /// Of actuators whose gauge pressure is given: the line under way.
    pressures: Vec<Option<StraightLine<W>>>,
}

/// Whether lanes can take the stages of a plant with a structure.
pub(crate) fn covers_structure(plant: &Plant) -> bool {
    plant.actuators().iter().all(|mounted| {
        let friction = mounted.actuator.friction();
        let falls = friction.coulomb().falls() || friction.lugre().is_some_and(LuGre::falls);
        !(mounted.tendon.is_some() && falls)
    })
}

/// Whether a lane can take a step in a mode.
pub(crate) fn covers_mode(mode: &PlantMode) -> bool {
    mode.network.branches.iter().all(|its| its.sonic.is_none())
}

impl<W: Wide> HeldMotion<W> {
    /// Enters what a motion does after so many corners.
    fn enter(&mut self, lane: usize, motion: &Motion, corners: usize, origin: f64) {
        match (self, motion) {
            (Self::Phase(held), Motion::Sinusoid { frequency, phase, .. }) => {
                held.put(lane, phase + TAU * frequency * origin % TAU);
            }
            (Self::Line(line), _) => {
                if let Some(its) = motion.line(corners) {
                    enter_line(lane, line, &its, origin);
                }
            }
            _ => {}
        }
    }
}

impl<W: Wide> HeldContacts<W> {
    #[inline(always)]
    fn new(joints: usize) -> Self {
        let (no, zero) = (W::Mask::splat(false), W::zero());
        Self { stops: vec![[no; 2]; joints], foot: no, stop_flags: vec![[zero; 2]; joints], foot_flag: zero }
    }
}

impl<W: Wide> Presses<W::Mask> for HeldContacts<W> {
    #[inline(always)]
    fn stop(&self, joint: usize, end: usize) -> W::Mask {
        self.stops[joint][end]
    }

    #[inline(always)]
    fn foot(&self) -> W::Mask {
        self.foot
    }
}

impl<W: Wide> HeldRows<W> {
    #[inline(always)]
    fn new(coordinates: usize, members: usize) -> Self {
        Self {
            is_member: vec![vec![W::Mask::splat(false); members]; coordinates],
            member_flags: vec![vec![W::zero(); members]; coordinates],
            count: 0,
        }
    }

    fn enter(&mut self, lane: usize, members: &[usize], list: &[usize]) {
        for (place, flags) in self.member_flags.iter_mut().enumerate() {
            for (flag, member) in flags.iter_mut().zip(members) {
                let stands = list.get(place) == Some(member);
                flag.mark(lane, stands);
            }
        }
    }

    #[inline(always)]
    fn update(&mut self) {
        self.count = 0;
        for (place, (masks, flags)) in self.is_member.iter_mut().zip(&self.member_flags).enumerate() {
            for (mask, flag) in masks.iter_mut().zip(flags) {
                *mask = W::zero().lt(*flag);
                if mask.any() {
                    self.count = place + 1;
                }
            }
        }
    }
}

impl<W: Wide> Held<W> {
    /// Of a plant, before any lane is entered.
    #[inline(always)]
    pub(crate) fn new(system: &System<W>) -> Self {
        let (no, zero, plant) = (W::Mask::splat(false), W::zero(), &system.plant);
        let nothing = HeldActuator {
            slack: no,
            taut: no,
            stuck: no,
            on_stop: no,
            free: no,
            still: no,
            loose: no,
            idle: no,
            direction: zero,
            branch: Branch::nothing(),
        };
        let mut has_branches = Vec::new();
        for wire in &system.wires {
            let friction = wire.member.actuator.friction();
            has_branches.push(friction.hysteresis().is_some() && friction.lugre().is_none());
        }
        let (mut motions, mut pressures) = (Vec::new(), Vec::new());
        for mechanism in plant.mechanisms() {
            motions.push(match mechanism {
                Mechanism::Prescribed(Motion::Table { .. }) => Some(HeldMotion::Line(StraightLine::constant(zero))),
                Mechanism::Prescribed(Motion::Sinusoid { .. }) => Some(HeldMotion::Phase(zero)),
                _ => None,
            });
        }
        for mounted in plant.actuators() {
            pressures.push(mounted.pressure.is_some().then_some(StraightLine::constant(zero)));
        }
        let mut rows = Vec::new();
        for (mechanism, members) in plant.mechanisms().iter().zip(&plant.indices().members) {
            rows.push(HeldRows::new(mechanism.coordinates(), members.len()));
        }
        let flags = Flags {
            slack: zero,
            taut: zero,
            stuck: zero,
            on_stop: zero,
            free: zero,
            still: zero,
            directed: zero,
            loose: zero,
            idle: zero,
            direction: zero,
        };
        Self {
            actuators: vec![nothing; plant.actuators().len()],
            frozen: vec![no; plant.mechanisms().len()],
            flows: HeldFlows::new(plant.network()),
            contacts: plant.mechanisms().iter().map(|mechanism| HeldContacts::new(mechanism.coordinates())).collect(),
            rows,
            flags: vec![flags; plant.actuators().len()],
            frozen_flags: vec![zero; plant.mechanisms().len()],
            has_branches,
            motions,
            pressures,
        }
    }

    /// Enters the mode of the row in a lane, whose times are counted from an origin in s; [`Held::update`] makes masks of it.
    pub(crate) fn enter(&mut self, lane: usize, plant: &Plant, mode: &PlantMode, origin: f64) {
        for (flags, (its, mounted)) in self.flags.iter_mut().zip(mode.actuators.iter().zip(plant.actuators())) {
            let (slack, stuck) = (its.mode.length_regime == LengthRegime::Slack, its.mode.sliding == Sliding::Stuck);
            flags.slack.mark(lane, slack);
            flags.taut.mark(lane, its.mode.length_regime == LengthRegime::Taut);
            flags.stuck.mark(lane, stuck);
            flags.on_stop.mark(lane, its.on_stop);
            flags.free.mark(lane, its.mode.length_regime == LengthRegime::Free && !its.on_stop);
            flags.still.mark(lane, its.mode.sliding == Sliding::Held);
            flags.directed.mark(lane, mounted.actuator.friction().has_direction());
            flags.loose.mark(lane, its.loose);
            flags.idle.mark(lane, slack || stuck || its.mode.clamped);
            flags.direction.put(lane, its.mode.sliding.direction());
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
            flag.mark(lane, its.frozen);
        }
        for (contacts, its) in self.contacts.iter_mut().zip(&mode.mechanisms) {
            for (flags, stops) in contacts.stop_flags.iter_mut().zip(&its.stops) {
                flags[0].mark(lane, stops[0] == Contact::Pressed);
                flags[1].mark(lane, stops[1] == Contact::Pressed);
            }
            contacts.foot_flag.mark(lane, its.foot == Contact::Pressed);
        }
        for (rows, (its, members)) in self.rows.iter_mut().zip(mode.mechanisms.iter().zip(&plant.indices().members)) {
            rows.enter(lane, members, &its.basis);
        }
        for (held, (mechanism, its)) in self.motions.iter_mut().zip(plant.mechanisms().iter().zip(&mode.mechanisms)) {
            if let (Some(held), Mechanism::Prescribed(motion)) = (held, mechanism) {
                held.enter(lane, motion, its.corners_passed, origin);
            }
        }
        for (line, (mounted, its)) in self.pressures.iter_mut().zip(plant.actuators().iter().zip(&mode.actuators)) {
            if let (Some(line), Some(series)) = (line, &mounted.pressure) {
                enter_line(lane, line, &series.line(its.rows_passed), origin);
            }
        }
        self.flows.enter(lane, plant.network(), &mode.network, origin);
    }

    /// Makes masks of what has been entered.
    #[inline(always)]
    pub(crate) fn update(&mut self) {
        let zero = W::zero();
        for (masks, flags) in self.actuators.iter_mut().zip(&self.flags) {
            masks.slack = zero.lt(flags.slack);
            masks.taut = zero.lt(flags.taut);
            masks.stuck = zero.lt(flags.stuck);
            masks.on_stop = zero.lt(flags.on_stop);
            masks.free = zero.lt(flags.free);
            masks.still = zero.lt(flags.still);
            masks.loose = zero.lt(flags.loose);
            masks.idle = zero.lt(flags.idle);
            masks.direction = flags.direction;
        }
        for (mask, flag) in self.frozen.iter_mut().zip(&self.frozen_flags) {
            *mask = zero.lt(*flag);
        }
        for contacts in &mut self.contacts {
            for (masks, flags) in contacts.stops.iter_mut().zip(&contacts.stop_flags) {
                (masks[0], masks[1]) = (zero.lt(flags[0]), zero.lt(flags[1]));
            }
            contacts.foot = zero.lt(contacts.foot_flag);
        }
        for rows in &mut self.rows {
            rows.update();
        }
        self.flows.update();
    }

    /// Whether the pressure of an actuator is given.
    #[inline(always)]
    pub(crate) fn is_given(&self, actuator: usize) -> bool {
        self.pressures[actuator].is_some()
    }

    /// The absolute pressure in Pa of an actuator whose pressure is given, at a time in s.
    #[allow(clippy::manual_map, reason = "a closure would be compiled separately, without the instructions of a batch")]
    #[inline(always)]
    pub(crate) fn given_pressure(&self, system: &System<W>, actuator: usize, time: W) -> Option<W> {
        match &self.pressures[actuator] {
            Some(line) => Some(line.at(time)[0] + system.plant.actuators()[actuator].actuator.air().atmosphere().0),
            None => None,
        }
    }

    /// Where an actuator rests on its shortest length.
    #[inline(always)]
    pub(crate) fn is_on_stop(&self, actuator: usize) -> W::Mask {
        self.actuators[actuator].on_stop
    }

    /// Lets an actuator slide the way of a rate, in masks alone; where it is within its lengths and does not stick.
    #[inline(always)]
    pub(crate) fn turn(&mut self, actuator: usize, rate: W) -> W::Mask {
        let (flags, held, zero) = (&self.flags[actuator], &mut self.actuators[actuator], W::zero());
        held.direction = W::select(zero.lt(flags.directed), rate.sign(), zero);
        held.still = rate.le(zero) & zero.le(rate);
        held.free & !held.stuck
    }

    /// Enters the way that an actuator slides, as [`Held::turn`] has found it, in some lanes.
    #[inline(always)]
    pub(crate) fn enter_turn(&mut self, actuator: usize, lanes: W::Mask) {
        let (flags, held) = (&mut self.flags[actuator], &self.actuators[actuator]);
        let still = W::select(held.still, W::one(), W::zero());
        flags.direction = W::select(lanes, held.direction, flags.direction);
        flags.still = W::select(lanes, still, flags.still);
    }

    /// Where an actuator that slides is kept from pushing as long as it `pushes`.
    #[inline(always)]
    pub(crate) fn is_kept_from_pushing(&self, actuator: usize, pushes: W::Mask) -> W::Mask {
        let idle = self.actuators[actuator].idle;
        (pushes & idle) | (!pushes & !idle)
    }

    /// How an actuator slides at a length and a velocity.
    #[inline(always)]
    pub(crate) fn sliding_state<T: Over<W>>(
        &self,
        wire: &Wire<W>,
        [length, velocity]: [T; 2],
        deflections: Deflections<T>,
        (direction, touch): (T, ThreadContact),
    ) -> SlidingState<T> {
        let held = &self.actuators[wire.index];
        let width = match (deflections.bristles, wire.member.actuator.friction().lugre()) {
            (Some(bent), Some(law)) => Some(law.width_at(bent, velocity, T::of(held.direction))),
            _ if self.has_branches[wire.index] => Some(held.branch.width_in_lanes(length)),
            _ => None,
        };
        let sliding = SlidingState { direction, width, force: None, touch };
        sliding.with_branches(wire.member.actuator.friction().viscoelastic(), length, deflections.branches)
    }
}

/// Where nothing presses the threads of an actuator together, as far as that matters: below the pressure of the atmosphere.
#[inline(always)]
pub(crate) fn are_apart<W: Wide, T: Over<W>>(actuator: &Actuator<W>, pressure: T) -> T::Mask {
    match actuator.friction().follows_normal_load() {
        true => pressure.lt(T::of(actuator.air().atmosphere().0)),
        false => T::Mask::splat(false),
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
    fn torques<T: Over<W>>(&self, system: &System<W>, m: usize, motion: ChainMotion<'_, T>, torque: &mut [T]) {
        if let Mechanism::Chain(chain) = &system.plant.mechanisms()[m] {
            chain.torques(motion, &self.contacts[m], torque);
        }
    }

    #[inline(always)]
    fn stiff_torques(&self, system: &System<W>, m: usize, (angle, rate): (&[W], &[W]), answers: (&mut [W], &mut [W])) {
        if let Mechanism::Chain(chain) = &system.plant.mechanisms()[m] {
            chain.stiffness(angle, rate, &self.contacts[m], answers);
        }
    }

    #[inline(always)]
    fn tension<T: Over<W>>(&self, wire: &Wire<W>, ends: [T; 3], deflections: Deflections<T>) -> T {
        T::select(self.actuators[wire.index].idle, T::zero(), self.signed_force(wire, ends, deflections))
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

    #[inline(always)]
    fn held_count(&self, mechanism: usize) -> usize {
        self.rows[mechanism].count
    }

    #[inline(always)]
    fn enter_held<T: Over<W>>(
        &self,
        system: &System<W>,
        (m, place): (usize, usize),
        gradients: &[T],
        row: &mut [T],
    ) -> W::Mask {
        row.fill(T::zero());
        let mut used = W::Mask::splat(false);
        for (&i, mask) in system.plant.indices().members[m].iter().zip(&self.rows[m].is_member[place]) {
            if !mask.any() {
                continue;
            }
            used = used | *mask;
            for (entry, its) in row.iter_mut().zip(system.gradient(i, gradients)) {
                *entry = T::select(*mask, *its, *entry);
            }
        }
        used
    }

    #[inline(always)]
    fn held_bending<T: Differentiable<W>>(&self, system: &System<W>, (m, place): (usize, usize), state: &[T]) -> T {
        let mut bending = T::zero();
        for (&i, mask) in system.plant.indices().members[m].iter().zip(&self.rows[m].is_member[place]) {
            if mask.any() {
                bending = T::select(*mask, system.bending(i, state, self), bending);
            }
        }
        bending
    }

    #[inline(always)]
    fn signed_force<T: Over<W>>(&self, wire: &Wire<W>, ends: [T; 3], deflections: Deflections<T>) -> T {
        let (held, actuator) = (&self.actuators[wire.index], &wire.member.actuator);
        let factors = actuator.factors(ends[0], ends[2]);
        let of_sliding = (T::of(held.direction), ThreadContact::Pressed);
        let state_of_sliding = self.sliding_state(wire, [ends[0], ends[1]], deflections, of_sliding);
        let force = actuator.signed_force(ends, state_of_sliding, held.taut, factors);
        let apart = are_apart(actuator, ends[2]);
        if apart.any() {
            let state_of_sliding = SlidingState { touch: ThreadContact::Apart, ..state_of_sliding };
            return T::select(apart, actuator.signed_force(ends, state_of_sliding, held.taut, factors), force);
        }
        force
    }

    #[inline(always)]
    fn direction(&self, actuator: usize) -> W {
        self.actuators[actuator].direction
    }

    #[inline(always)]
    fn is_loose(&self, actuator: usize) -> W::Mask {
        self.actuators[actuator].loose
    }

    #[inline(always)]
    fn is_damped(&self, system: &System<W>, actuator: usize) -> W::Mask {
        end_is_damped(&system.wires[actuator].member.actuator, self.actuators[actuator].taut)
    }

    #[inline(always)]
    fn motion<T: Over<W>>(&self, mechanism: usize, motion: &Motion<W>, time: T) -> [T; 3] {
        match (motion, self.motions[mechanism]) {
            (&Motion::Sinusoid { length, amplitude, frequency, .. }, Some(HeldMotion::Phase(phase))) => {
                Motion::Sinusoid { length, amplitude, frequency, phase }.on(time, None)
            }
            (_, Some(HeldMotion::Line(line))) => motion.on(time, Some(line)),
            _ => motion.on(time, None),
        }
    }

    #[inline(always)]
    fn given_rate<T: Over<W>>(&self, _: &System<W>, actuator: usize, _: T) -> T {
        match &self.pressures[actuator] {
            Some(line) => T::of(line.slope),
            None => T::zero(),
        }
    }

    // What lanes do not cover.

    fn searched_velocity<T: Differentiable<W>>(
        &self,
        _: &System<W>,
        _: usize,
        _: (&Unit<T>, &Chamber<T>),
        _: Deflections<T>,
    ) -> Option<T> {
        None
    }
}
