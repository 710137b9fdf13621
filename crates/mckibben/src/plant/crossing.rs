//! What follows when a mode of the plant ends: instants that are known beforehand, and guards that have fired.

use super::ends::opposite;
use super::evaluation::{Evaluation, System};
use super::guard::{ContactEvent, PlantGuard};
use super::mode::PlantMode;
use crate::error::Error;
use crate::mechanism::{Contact, Coupling, Mechanism};
use crate::network::guard::NetworkGuard;
use crate::network::{BranchKind, NodeKind};
use crate::scalar::Real;
use crate::simulation::member::Member;
use crate::simulation::{EventKind, Guard, LengthRegime, Sliding};
use crate::valve::is_due;

/// Which part of a plant an event belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Part {
    /// An actuator.
    Actuator(usize),
    /// A mechanism.
    Mechanism(usize),
    /// A joint of a mechanism.
    Joint(usize, usize),
    /// A valve.
    Valve(usize),
    /// A node of the network.
    Node(usize),
    /// A branch of the network.
    Branch(usize),
    /// A driver.
    Driver(usize),
}

/// What happened, and to which part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlantEventKind {
    /// The part.
    pub part: Part,
    /// What happened.
    pub kind: EventKind,
}

impl<R: Real> System<R> {
    /// The next instant in s, up to and with `until`, at which a mode ends without an event of a guard.
    pub(crate) fn next_instant(&self, mode: &PlantMode<R>, until: R) -> Option<R> {
        let network = self.plant.network.next_instant(&mode.network, until);
        let corners =
            self.plant.mechanisms.iter().zip(&mode.mechanisms).filter_map(|(mechanism, its)| match mechanism {
                Mechanism::Prescribed(motion) => motion.corner(its.corners_passed),
                _ => None,
            });
        let rows = self
            .plant
            .actuators
            .iter()
            .zip(&mode.actuators)
            .filter_map(|(mounted, its)| mounted.pressure.as_ref()?.row(its.rows_passed));
        let samples = mode.drivers.iter().map(crate::command::Driver::next);
        let due = corners.chain(rows).chain(samples).filter(|instant| is_due(*instant, until));
        network.into_iter().chain(due).min_by(|a, b| a.value().total_cmp(&b.value()))
    }

    /// Passes one thing that is due at an instant; what is due besides is the next instant, at the same time.
    pub(crate) fn pass_instant(
        &self,
        time: R,
        state: &mut [R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> Result<PlantEventKind, Error> {
        let network = &self.plant.network;
        for valve in 0..network.valves.len() {
            if network.is_valve_due(valve, time, &mode.network) {
                network.pass_valve(valve, time, &mut mode.network);
                self.enter_valve(valve, time, state, mode, at);
                self.settle_ends(time, state, mode, at);
                self.check_jumps(time, state, mode, at)?;
                return Ok(PlantEventKind { part: Part::Valve(valve), kind: EventKind::Valve });
            }
        }
        for node in 0..network.nodes.len() {
            let Some(place) = self.plant.places.nodes[node] else { continue };
            if network.pass_set_points(node, time, state[place], &mut mode.network) {
                self.settle_ends(time, state, mode, at);
                return Ok(PlantEventKind { part: Part::Node(node), kind: EventKind::SetPoint });
            }
        }
        for node in 0..network.nodes.len() {
            if network.pass_row(node, time, &mut mode.network) {
                self.project(time, state, mode, at);
                return Ok(PlantEventKind { part: Part::Node(node), kind: EventKind::Corner });
            }
        }
        for (i, mounted) in self.plant.actuators.iter().enumerate() {
            let its = &mut mode.actuators[i];
            let row = mounted.pressure.as_ref().and_then(|series| series.row(its.rows_passed));
            if row.is_some_and(|row| is_due(row, time)) {
                its.rows_passed += 1;
                self.project(time, state, mode, at);
                return Ok(PlantEventKind { part: Part::Actuator(i), kind: EventKind::Corner });
            }
        }
        for (m, mechanism) in self.plant.mechanisms.iter().enumerate() {
            let Mechanism::Prescribed(motion) = mechanism else { continue };
            let its = &mut mode.mechanisms[m];
            if motion.corner(its.corners_passed).is_some_and(|corner| is_due(corner, time)) {
                its.corners_passed += 1;
                self.project(time, state, mode, at);
                self.enter_length_regimes(m, time, state, mode, at);
                self.settle(m, time, state, mode, at);
                self.follow_all(time, state, mode, at, None);
                return Ok(PlantEventKind { part: Part::Mechanism(m), kind: EventKind::Corner });
            }
        }
        if let Some(driver) = self.sample_due(time, state, mode, at)? {
            return Ok(PlantEventKind { part: Part::Driver(driver), kind: EventKind::Sample });
        }
        Ok(PlantEventKind { part: Part::Mechanism(0), kind: EventKind::Corner })
    }

    /// Enters the zones of a valve's flow paths, and decides poppets whose flow has jumped.
    fn enter_valve(&self, valve: usize, time: R, state: &[R], mode: &mut PlantMode<R>, at: &mut Evaluation<R>) {
        let network = &self.plant.network;
        self.piping.enter_pressures(state, &mut at.network);
        for (index, branch) in network.branches.iter().enumerate() {
            if let BranchKind::Path { valve: its, .. } = branch.kind
                && its == valve
            {
                let before = mode.network.branches[index].zone;
                // A path that stays open keeps its zone.
                if before.is_some() != network.is_open(index, &mode.network) {
                    let pressure = [branch.from, branch.to].map(|node| at.network.nodes[node].pressure);
                    network.enter_branch(index, pressure, &mut mode.network);
                }
            }
        }
        self.enter_poppets(time, state, mode, at);
    }

    /// Decides all poppets by the flows that there are.
    pub(crate) fn enter_poppets(&self, time: R, state: &[R], mode: &mut PlantMode<R>, at: &mut Evaluation<R>) {
        let network = &self.plant.network;
        if !network.nodes.iter().any(|node| matches!(node.kind, NodeKind::Outlet { .. })) {
            return;
        }
        self.enter_air(time, state, mode, at);
        for node in 0..network.nodes.len() {
            if let NodeKind::Outlet { regulator, .. } = &network.nodes[node].kind {
                let limited = network.inlet_margin(node, &at.network).is_some_and(|margin| margin.value() < 0.0);
                mode.network.nodes[node].limited = limited;
                let Some(error) = network.outlet_error(node, limited, &at.network) else { continue };
                mode.network.nodes[node].poppet = regulator.poppet(error);
            }
        }
    }

    /// Crosses a guard that has come down through zero: the mode and, where it is reset, the state after it.
    pub(crate) fn cross(
        &self,
        guard: PlantGuard,
        time: R,
        state: &mut [R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> Result<PlantEventKind, Error> {
        let slips = if let PlantGuard::Of(i, Guard::Slip) = guard { Some(i) } else { None };
        let kind = self.pass_guard(guard, time, state, mode, at)?;
        self.follow_all(time, state, mode, at, slips);
        self.settle_ends(time, state, mode, at);
        self.check_jumps(time, state, mode, at)?;
        Ok(kind)
    }

    fn pass_guard(
        &self,
        guard: PlantGuard,
        time: R,
        state: &mut [R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> Result<PlantEventKind, Error> {
        let of = |part, kind| Ok(PlantEventKind { part, kind });
        match guard {
            PlantGuard::Jump(i) => Err(self.jumps(i, time, state, mode, at)),
            PlantGuard::Network(NetworkGuard::Empty { node }) => Err(self.empty(node, time, state)),
            PlantGuard::Network(guard) => {
                let kind = self.plant.network.cross(guard, &mut mode.network);
                let part = match guard {
                    NetworkGuard::Poppet { node, .. }
                    | NetworkGuard::Limit { node }
                    | NetworkGuard::Empty { node }
                    | NetworkGuard::RateLimit { node } => Part::Node(node),
                    NetworkGuard::Zone { branch, .. }
                    | NetworkGuard::Regime { branch, .. }
                    | NetworkGuard::Sonic { branch, .. }
                    | NetworkGuard::Slower { branch }
                    | NetworkGuard::Switch { branch } => Part::Branch(branch),
                };
                of(part, kind)
            }
            PlantGuard::Arm { actuator, arm, up } => {
                let mounted = &self.plant.actuators[actuator];
                if let Coupling::Arms { arms, .. } = &mounted.coupling {
                    let piece = &mut mode.arms[self.plant.places.actuators[actuator].arms + arm];
                    let (low, high) = arms[arm].arm.piece_bounds(*piece);
                    let place = self.plant.places.mechanisms[mounted.mechanism].position(arms[arm].joint);
                    if let Some(bound) = if up { high } else { low } {
                        // The value alone: the border is smooth, so the place of its crossing has no derivatives.
                        state[place] = state[place] + R::constant((bound - state[place]).value());
                    }
                    *piece = if up { *piece + 1 } else { piece.saturating_sub(1) };
                }
                of(Part::Actuator(actuator), EventKind::MomentArm)
            }
            PlantGuard::ThreadContact { mechanism, stop, touch } => {
                let contact = match touch {
                    ContactEvent::Reach | ContactEvent::Press => Contact::Pressed,
                    ContactEvent::Rebound => Contact::Rebound,
                    ContactEvent::Leave => Contact::None,
                };
                let kind = match touch {
                    ContactEvent::Reach | ContactEvent::Press => EventKind::StopReached,
                    ContactEvent::Rebound => EventKind::StopRebound,
                    ContactEvent::Leave => EventKind::StopLeft,
                };
                let its = &mut mode.mechanisms[mechanism];
                match stop {
                    Some((k, end)) => {
                        its.stops[k][end] = contact;
                        if let (ContactEvent::Reach | ContactEvent::Leave, Mechanism::Chain(chain)) =
                            (touch, &self.plant.mechanisms[mechanism])
                            && let Some(angle) = chain.joints()[k].stops.ends[end]
                        {
                            state[self.plant.places.mechanisms[mechanism].position(k)] = angle;
                        }
                        of(Part::Joint(mechanism, k), kind)
                    }
                    None => {
                        its.foot = contact;
                        of(Part::Mechanism(mechanism), kind)
                    }
                }
            }
            PlantGuard::Release { mechanism, facet, positive } => {
                self.release(mechanism, facet, positive, time, state, mode, at);
                of(Part::Mechanism(mechanism), EventKind::BreakAway)
            }
            PlantGuard::Of(i, guard) if self.plant.actuators[i].tendon.is_some() => {
                let kind = self.cross_end(i, guard, time, state, mode, at)?;
                of(Part::Actuator(i), kind)
            }
            PlantGuard::Of(i, guard) => {
                let kind = self.cross_member(i, guard, time, state, mode, at)?;
                of(Part::Actuator(i), kind)
            }
        }
    }

    /// The coordinate at which an actuator has a length, where one alone decides.
    fn put_on(&self, i: usize, length: R, state: &mut [R]) {
        let mounted = &self.plant.actuators[i];
        if !self.plant.mechanisms[mounted.mechanism].is_dynamic() {
            return;
        }
        if let Some((coordinate, value, _)) = mounted.coupling.coordinate_at(length) {
            state[self.plant.places.mechanisms[mounted.mechanism].position(coordinate)] = value;
        }
    }

    /// Crosses a guard of an actuator without a tendon.
    fn cross_member(
        &self,
        i: usize,
        guard: Guard,
        time: R,
        state: &mut [R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> Result<EventKind, Error> {
        let m = self.plant.actuators[i].mechanism;
        let limits = self.wires[i].member.actuator.limits();
        match guard {
            Guard::ThreadLength => Err(Self::straight(time, at.units[i].length)),
            Guard::Slack | Guard::Tight => {
                self.put_on(i, limits.min_length(), state);
                if self.rests_on_the_shortest(i, time, state, mode, at) {
                    mode.actuators[i].mode.length_regime = LengthRegime::Free;
                    mode.actuators[i].mode.clamped = false;
                    mode.actuators[i].on_stop = true;
                    self.bring_to_rest(i, time, state, mode, at);
                    self.settle(m, time, state, mode, at);
                    return Ok(EventKind::Stick);
                }
                let slack = guard == Guard::Slack;
                mode.actuators[i].mode.length_regime = if slack { LengthRegime::Slack } else { LengthRegime::Free };
                self.start_sliding(i, time, state, mode, at);
                Ok(if slack { EventKind::Slack } else { EventKind::Tight })
            }
            Guard::Taut | Guard::TautEnd => {
                self.put_on(i, limits.max_length(), state);
                let taut = guard == Guard::Taut;
                mode.actuators[i].mode.length_regime = if taut { LengthRegime::Taut } else { LengthRegime::Free };
                self.clamp_all(m, time, state, mode, at);
                Ok(if taut { EventKind::Taut } else { EventKind::TautEnd })
            }
            Guard::Rest => {
                self.enter_distances(time, state, mode, at);
                if self.plant.mechanisms[m].is_dynamic() && !self.is_at_dead_centre(i, at) {
                    self.bring_to_rest(i, time, state, mode, at);
                    self.settle(m, time, state, mode, at);
                } else {
                    // On one given distance all reverse together.
                    let given = !self.plant.mechanisms[m].is_dynamic();
                    let together = given && self.plant.places.mechanisms[m].coordinates == 1;
                    for &other in &self.plant.places.members[m] {
                        if other == i || (together && self.plant.places.actuators[other].length.is_none()) {
                            let its = &mut mode.actuators[other].mode;
                            its.sliding = opposite(its.sliding);
                        }
                    }
                    self.clamp_all(m, time, state, mode, at);
                }
                let stuck = mode.actuators[i].mode.sliding == Sliding::Stuck;
                Ok(if stuck { EventKind::Stick } else { EventKind::Reversal })
            }
            Guard::Slip => Ok(EventKind::Slip),
            _ => Member::<R>::cross(guard, &mut mode.actuators[i].mode).ok_or_else(|| self.unknown_guard(time)),
        }
    }

    /// How an actuator slides that moves on over its shortest length.
    fn start_sliding(&self, i: usize, time: R, state: &[R], mode: &mut PlantMode<R>, at: &mut Evaluation<R>) {
        self.enter_distances(time, state, mode, at);
        mode.actuators[i].mode.sliding = self.sliding_towards(i, at.units[i].rate.value());
        self.clamp_all(self.plant.actuators[i].mechanism, time, state, mode, at);
    }

    /// Brings the rate of an actuator's distance to zero, by the least change in kinetic energy.
    fn bring_to_rest(&self, i: usize, time: R, state: &mut [R], mode: &mut PlantMode<R>, at: &mut Evaluation<R>) {
        let m = self.plant.actuators[i].mechanism;
        let here = self.plant.places.mechanisms[m];
        if here.coordinates == 1 {
            state[here.rate(0)] = R::zero();
            return;
        }
        self.enter_distances(time, state, mode, at);
        let mut held = mode.mechanisms[m].basis.clone();
        if !held.contains(&i) {
            held.push(i);
        }
        let before = core::mem::replace(&mut mode.mechanisms[m].basis, held);
        self.hold_rates(m, state, mode, at);
        mode.mechanisms[m].basis = before;
    }

    /// Whether an actuator that arrives at its shortest length comes to rest there: it can be held, and it moves too slowly to
    /// be separated from rest, or would bounce less than the tolerance of its length.
    fn rests_on_the_shortest(
        &self,
        i: usize,
        time: R,
        state: &[R],
        mode: &PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> bool {
        let m = self.plant.actuators[i].mechanism;
        if !self.plant.mechanisms[m].is_dynamic() {
            return false;
        }
        self.enter_distances(time, state, mode, at);
        let rate = at.units[i].rate.value();
        // As it would be at rest, on its shortest length and slack.
        let at_rest = |length_regime: LengthRegime, at: &mut Evaluation<R>| {
            let (mut state, mut mode) = (state.to_vec(), mode.clone());
            mode.actuators[i].mode.length_regime = length_regime;
            mode.actuators[i].on_stop = length_regime == LengthRegime::Free;
            self.bring_to_rest(i, time, &mut state, &mut mode, at);
            self.settle(m, time, &mut state, &mut mode, at);
            self.evaluate(time, &state, &mode, at);
            (state, mode)
        };
        at_rest(LengthRegime::Slack, at);
        let count = self.plant.places.mechanisms[m].coordinates;
        let first = self.plant.places.mechanisms[m].acceleration;
        let gradient = self.gradient(i, &at.gradient).to_vec();
        let back = super::dense::dot(&gradient, &at.acceleration[first..first + count]).value();
        let (held_state, held) = at_rest(LengthRegime::Free, at);
        if held.actuators[i].mode.sliding != Sliding::Stuck {
            return false;
        }
        if rate.abs() <= self.rest_band(i) {
            return true;
        }
        let most = self.holdable(i, &held_state, &held, at.units[i].distance).1;
        let mut matrix = alloc::vec![R::zero(); count * count];
        self.mass_matrix(m, &at.directions, &mut matrix);
        super::dense::factor(&mut matrix, count);
        let mut row = gradient.clone();
        super::dense::solve(&matrix, count, &mut row);
        let against = (super::dense::dot(&gradient, &row) * most).value() - back;
        let acceleration = back.min(against);
        acceleration > 0.0
            && rate * rate <= 2.0 * acceleration * self.wires[i].member.band * self.wires[i].member.longest
    }

    /// Takes the memories of all hysteresis on to a state, and to the branches that follow.
    pub(crate) fn follow_all(
        &self,
        time: R,
        state: &[R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
        slips: Option<usize>,
    ) {
        for i in 0..self.wires.len() {
            self.follow(i, time, state, mode, at, slips == Some(i));
        }
    }

    pub(super) fn follow(
        &self,
        i: usize,
        time: R,
        state: &[R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
        slips: bool,
    ) {
        if mode.actuators[i].trace.is_none() {
            return;
        }
        let length = self.remembered_length(i, time, state, mode, at);
        let its = &mut mode.actuators[i];
        let sliding = its.mode.sliding;
        self.wires[i].member.follow(&mut its.trace, length, sliding, slips);
    }

    /// The length in m that the hysteresis of an actuator follows, in a state.
    fn remembered_length(&self, i: usize, time: R, state: &[R], mode: &PlantMode<R>, at: &mut Evaluation<R>) -> R {
        self.enter_distances(time, state, mode, at);
        self.wires[i].member.actuator.limits().actuator_length(at.units[i].length)
    }

    /// Takes what the friction of actuators on a mechanism remembers straight on to where their ends are in a state.
    pub(crate) fn carry_memories(
        &self,
        m: usize,
        time: R,
        state: &[R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) {
        let follows = |i: &usize| self.wires[*i].places.length.is_none();
        for &i in self.plant.places.members[m].iter().filter(|i| follows(i)) {
            if mode.actuators[i].trace.is_none() {
                continue;
            }
            let length = self.remembered_length(i, time, state, mode, at);
            self.wires[i].member.carry(&mut mode.actuators[i].trace, length);
        }
    }

    /// Restores what a step knows exactly: given motions and pressures, isothermal contents, balances without viscosity, and
    /// the rates of what sticks.
    pub(crate) fn project(&self, time: R, state: &mut [R], mode: &PlantMode<R>, at: &mut Evaluation<R>) {
        for (m, mechanism) in self.plant.mechanisms.iter().enumerate() {
            let here = &self.plant.places.mechanisms[m];
            match mechanism {
                Mechanism::Prescribed(motion) => {
                    let [length, velocity, _] = motion.at(time, mode.mechanisms[m].corners_passed);
                    (state[here.position(0)], state[here.rate(0)]) = (length, velocity);
                }
                Mechanism::Chain(_) if !mode.mechanisms[m].basis.is_empty() => {
                    self.enter_distances(time, state, mode, at);
                    self.hold_rates(m, state, mode, at);
                }
                _ => {}
            }
        }
        for &[node, place] in &self.plant.places.state_nodes {
            let passed = mode.network.nodes[node].rows_passed;
            if let Some([pressure, _]) = self.plant.network.given(node, time, passed) {
                state[place] = pressure;
            }
        }
        for &[branch, place] in &self.plant.places.state_branches {
            if let Some(forwards) = mode.network.branches[branch].sonic
                && let Some((behind, per_pressure)) = self.plant.network.sonic::<R>(branch, forwards)
                && let Some(pressure) = self.piping.pressure(behind, state)
            {
                state[place] = per_pressure * pressure;
            }
        }
        for (i, mounted) in self.plant.actuators.iter().enumerate() {
            let (here, its) = (&self.plant.places.actuators[i], &mode.actuators[i]);
            let air = mounted.actuator.air();
            let given = mounted.pressure.as_ref().map(|series| series.at(time, its.rows_passed));
            if let Some([gauge, _]) = given {
                state[here.pressure] = gauge + air.atmosphere().0;
            }
            if mounted.tendon.is_some() {
                self.keep_balance(i, time, state, mode, at);
            }
            if given.is_none() && its.isothermal.is_none() {
                continue;
            }
            self.enter_distances(time, state, mode, at);
            let volume = at.chambers[i].volume;
            if given.is_some() {
                if let Some(content) = its.isothermal {
                    state[here.pressure + 1] = state[here.pressure] * volume / content;
                }
            } else if let Some(content) = its.isothermal {
                state[here.pressure] = content * state[here.pressure + 1] / volume;
            }
        }
    }
}
