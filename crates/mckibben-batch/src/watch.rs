//! What is watched of plants in lanes: the range that each quantity keeps as long as a mode lasts.
//!
//! | guard | quantity |
//! |---|---|
//! | of one state | the state |
//! | slack, taut, rest of an actuator that spans joints | its length, its rate |
//! | tension comes to zero, or back | the sum of its forces |
//! | the taut braid lets go, or pulls again | the force of the taut braid |
//! | what sticks on one coordinate lets go | the force that is held, conservatively |
//! | what sticks on a chain lets go | the torque that is held along the normal of each [facet](super::facets) |
//! | a stop or the belt presses, or ceases to | the press of the contact; of the foot its depth as well |
//! | of the end of an actuator on a tendon | see [ends](crate::ends) |
//! | the poppet of a regulator, and what limits it | its error and the margin of its inlet, conservatively |
//!
//! A step that leaves a range is repeated by the row as a scalar instance, which locates the event. That a range is left although no guard is
//! violated is harmless; so states that are no numbers and chambers without air are found by ranges, too.

use crate::ends::Ends;
use crate::facets::Facets;
use crate::held::{Held, are_apart};
use crate::motion::HostEnds;
use crate::wide::Wide;
use mckibben::internals::{
    Evaluation, Formulas, GuardForm, MOST_AIR, NetworkGuard, System, ThreadContact, Trace, tendon_tension,
};
use mckibben::line::Poppet;
use mckibben::mechanism::Mechanism;
use mckibben::mechanism::chain::ChainMotion;
use mckibben::network::NodeKind;
use mckibben::plant::{ContactEvent, PlantGuard, PlantMode};
use mckibben::scalar::{Mask, Scalar};
use mckibben::simulation::Guard;

/// Part of its outlet's pressure above which the inlet of a regulator is watched no more: its guard is far below.
const FAR_FROM_EMPTY: f64 = 2e-3;

/// A range in every lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range<W> {
    low: W,
    high: W,
}

/// The ranges of an actuator's quantities.
#[derive(Clone, Copy, Debug)]
struct ActuatorRanges<W> {
    length: Range<W>,
    rate: Range<W>,
    force: Range<W>,
    taut_force: Range<W>,
}

/// The ranges of a contact: of a stop, or of the foot with the belt.
#[derive(Clone, Copy, Debug)]
struct ContactRanges<W> {
    press: Range<W>,
    depth: Range<W>,
    /// Whether any lane has one.
    watched: bool,
}

/// The ranges of a regulator's outlet.
#[derive(Clone, Copy, Debug)]
struct OutletRanges<W> {
    node: usize,
    inlet: Option<usize>,
    error: Range<W>,
    margin: Range<W>,
}

/// Which quantities of a row are watched besides its states.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Watched {
    ends: bool,
    forces: bool,
}

/// The ranges of all quantities in every lane.
#[derive(Clone, Debug)]
pub(crate) struct Watch<W: Wide> {
    states: Vec<Range<W>>,
    actuators: Vec<ActuatorRanges<W>>,
    /// Of each mechanism: both stops of each joint, then the foot.
    contacts: Vec<Vec<ContactRanges<W>>>,
    /// Of regulators whose law has pieces.
    outlets: Vec<OutletRanges<W>>,
    /// Of actuators on tendons.
    ends: Ends<W>,
    /// Of chains of several joints.
    facets: Facets<W>,
    /// 1 where a mechanism is held at rest, 0 elsewhere.
    holds: Vec<W>,
    /// What is watched of each actuator in any lane, and which mechanisms are held in any.
    watched: Vec<Watched>,
    held: Vec<bool>,
    /// Watched guards lane by lane.
    of_lanes: Vec<Vec<Watched>>,
}

impl<W: Wide> Range<W> {
    pub(crate) fn all() -> Self {
        Self { low: W::constant(f64::NEG_INFINITY), high: W::constant(f64::INFINITY) }
    }

    fn put(&mut self, lane: usize, [low, high]: [f64; 2]) {
        self.low.put(lane, low);
        self.high.put(lane, high);
    }

    /// Ends nowhere in a lane.
    pub(crate) fn open(&mut self, lane: usize) {
        self.put(lane, [f64::NEG_INFINITY, f64::INFINITY]);
    }

    pub(crate) fn above(&mut self, lane: usize, bound: f64) {
        self.low.put(lane, Scalar::larger(self.low.lane(lane), bound));
    }

    pub(crate) fn below(&mut self, lane: usize, bound: f64) {
        self.high.put(lane, Scalar::smaller(self.high.lane(lane), bound));
    }

    /// Whether it has an end in any lane.
    pub(crate) fn is_any(&self) -> bool {
        let ends = |lane| f64::NEG_INFINITY < self.low.lane(lane) || self.high.lane(lane) < f64::INFINITY;
        (0..W::LANES).any(ends)
    }

    pub(crate) fn bound(&mut self, lane: usize, (bound, lasts_above): (f64, bool)) {
        if lasts_above { self.above(lane, bound) } else { self.below(lane, bound) }
    }

    /// Where a number lies within; nowhere for what is not a number.
    #[inline(always)]
    pub(crate) fn holds(&self, number: W) -> W::Mask {
        self.low.le(number) & number.le(self.high)
    }
}

impl<W: Wide> Watch<W> {
    /// Of a plant, before anything is watched.
    #[inline(always)]
    pub(crate) fn new(system: &System<W>) -> Self {
        let (all, actuators) = (Range::all(), system.wires.len());
        let of_actuator = ActuatorRanges { length: all, rate: all, force: all, taut_force: all };
        let contact = ContactRanges { press: all, depth: all, watched: false };
        let mut contacts = Vec::new();
        for mechanism in system.plant.mechanisms() {
            contacts.push(vec![contact; 2 * mechanism.coordinates() + 1]);
        }
        let mut outlets = Vec::new();
        for (node, its) in system.plant.network().nodes.iter().enumerate() {
            if let NodeKind::Outlet { regulator, inlet, .. } = its.kind
                && (inlet.is_some() || W::zero().lt(regulator.dead_band()).any())
            {
                outlets.push(OutletRanges { node, inlet, error: all, margin: all });
            }
        }
        Self {
            states: vec![all; system.plant.indices().states],
            actuators: vec![of_actuator; actuators],
            contacts,
            outlets,
            ends: Ends::new(system),
            facets: Facets::new(actuators),
            holds: vec![W::zero(); system.assemblies.len()],
            watched: vec![Watched::default(); actuators],
            held: vec![false; system.assemblies.len()],
            of_lanes: vec![vec![Watched::default(); actuators]; W::LANES],
        }
    }

    /// Enters what is watched of a row in its mode, whose guards are given; whether that is all that there is to watch.
    pub(crate) fn enter(
        &mut self,
        lane: usize,
        (system, mode): (&System<f64>, &PlantMode),
        guards: &[(PlantGuard, GuardForm)],
        hosts: &HostEnds<W>,
    ) -> bool {
        for range in &mut self.states {
            range.put(lane, [-W::LARGEST, W::LARGEST]);
        }
        for place in system.places_of_air() {
            self.states[place].above(lane, W::SMALLEST);
            self.states[place].below(lane, W::below(MOST_AIR));
        }
        for wire in &system.wires {
            if let Some(place) = wire.length_place() {
                self.states[place].below(lane, W::below(wire.member.thread_length()));
            }
            if let Some(place) = wire.places.length {
                self.states[place].above(lane, W::SMALLEST);
            }
        }
        for its in &mut self.actuators {
            for range in [&mut its.length, &mut its.rate, &mut its.force, &mut its.taut_force] {
                range.open(lane);
            }
        }
        for its in self.contacts.iter_mut().flatten() {
            its.press.open(lane);
            its.depth.open(lane);
        }
        for its in &mut self.outlets {
            its.error.open(lane);
            its.margin.open(lane);
        }
        self.ends.leave(lane);
        self.facets.leave(lane);
        self.of_lanes[lane].fill(Watched::default());
        for hold in &mut self.holds {
            hold.mark(lane, false);
        }
        let mut is_all = true;
        for (guard, form) in guards {
            // The ends that a host moves come to rest between moves alone.
            if let (PlantGuard::Of(_, Guard::Rest), GuardForm::Above { index, .. } | GuardForm::Below { index, .. }) =
                (guard, form)
                && hosts.is_rate(*index)
            {
                continue;
            }
            is_all &= self.enter_guard(lane, system, mode, (*guard, *form));
        }
        for i in 0..self.watched.len() {
            let any = |which: fn(&Watched) -> bool| self.of_lanes.iter().any(|of_lane| which(&of_lane[i]));
            self.watched[i] = Watched { ends: any(|its| its.ends), forces: any(|its| its.forces) };
        }
        for its in self.contacts.iter_mut().flatten() {
            its.watched = its.press.is_any() || its.depth.is_any();
        }
        self.ends.update();
        self.facets.update();
        for (held, hold) in self.held.iter_mut().zip(&self.holds) {
            *held = hold.is_marked();
        }
        is_all
    }

    fn enter_guard(
        &mut self,
        lane: usize,
        system: &System<f64>,
        mode: &PlantMode,
        (guard, form): (PlantGuard, GuardForm),
    ) -> bool {
        match (form, guard) {
            (GuardForm::Above { index, bound }, _) => self.states[index].above(lane, bound),
            (GuardForm::Below { index, bound }, _) => self.states[index].below(lane, bound),
            (GuardForm::Function, PlantGuard::Jump(i)) => return self.ends.enter(lane, system, mode, (i, None)),
            (GuardForm::Function, PlantGuard::Of(i, guard)) if system.wires[i].places.length.is_some() => {
                return self.ends.enter(lane, system, mode, (i, Some(guard)));
            }
            (GuardForm::Function, PlantGuard::Of(i, guard)) => {
                let (wire, its, ranges) = (&system.wires[i], &mode.actuators[i].mode, &mut self.actuators[i]);
                let band = wire.member.force_band;
                let watched = &mut self.of_lanes[lane][i];
                let (by_length, _) = wire.member.length_regime_guards(its.length_regime);
                if let Some((_, bound, lasts_above)) = by_length.into_iter().flatten().find(|(own, ..)| *own == guard) {
                    ranges.length.bound(lane, (bound, lasts_above));
                    watched.ends = true;
                    return true;
                }
                match guard {
                    Guard::Rest => {
                        let direction = its.sliding.direction();
                        ranges.rate.bound(lane, (-direction * system.rest_band(i), direction > 0.0));
                        watched.ends = true;
                    }
                    Guard::Slip => {
                        let Some((end, lasts_above)) = mode.actuators[i].trace.as_ref().and_then(Trace::end) else {
                            return false;
                        };
                        ranges.length.bound(lane, (end, lasts_above));
                        watched.ends = true;
                    }
                    Guard::TensionZero | Guard::TensionBack => {
                        let is_zero = guard == Guard::TensionZero;
                        ranges.force.bound(lane, (if is_zero { -band } else { band }, is_zero));
                        watched.forces = true;
                    }
                    Guard::Rebound | Guard::Retaut => {
                        let rebounds = guard == Guard::Rebound;
                        ranges.taut_force.bound(lane, (if rebounds { -band } else { band }, rebounds));
                        watched.forces = true;
                    }
                    _ => return false,
                }
            }
            (GuardForm::Function, PlantGuard::Release { mechanism, facet, .. }) => {
                let (its, places) = (&mode.mechanisms[mechanism], system.plant.indices());
                if !(its.frozen && places.mechanisms[mechanism].coordinates == 1) {
                    return self.facets.enter(lane, mechanism, &its.facets[facet]);
                }
                self.holds[mechanism].mark(lane, true);
            }
            (GuardForm::Function, PlantGuard::ThreadContact { mechanism, stop, touch }) => {
                let contacts = &mut self.contacts[mechanism];
                let place = stop.map_or(contacts.len() - 1, |(k, end)| 2 * k + end);
                let (its, band) = (&mut contacts[place], system.contact_band(mechanism, stop.is_some()));
                match touch {
                    ContactEvent::Reach => its.depth.below(lane, 0.0),
                    ContactEvent::Leave => its.depth.above(lane, 0.0),
                    ContactEvent::Rebound => its.press.above(lane, -band),
                    ContactEvent::Press => its.press.below(lane, band),
                }
            }
            (GuardForm::Function, PlantGuard::Network(guard)) => return self.enter_outlet(lane, system, mode, guard),
            _ => return false,
        }
        true
    }

    /// Enters a guard of a regulator's outlet; whether it is one.
    fn enter_outlet(&mut self, lane: usize, system: &System<f64>, mode: &PlantMode, guard: NetworkGuard) -> bool {
        let (NetworkGuard::Poppet { node, .. } | NetworkGuard::Limit { node } | NetworkGuard::Empty { node }) = guard
        else {
            return false;
        };
        let (network, modes) = (system.plant.network(), &mode.network.nodes[node]);
        let Some(ranges) = self.outlets.iter_mut().find(|its| its.node == node) else { return false };
        let NodeKind::Outlet { regulator, .. } = &network.nodes[node].kind else { return false };
        let room = W::MARGIN * network.atmosphere;
        match guard {
            NetworkGuard::Poppet { up, .. } => {
                let rests = modes.poppet == Poppet::Rests;
                let bound = if rests == up { regulator.dead_band() } else { -regulator.dead_band() };
                ranges.error.bound(lane, if up { (bound - room, false) } else { (bound + room, true) });
            }
            NetworkGuard::Limit { .. } => {
                ranges.margin.bound(lane, if modes.limited { (-room, false) } else { (room, true) });
            }
            // In `holds`, of all lanes.
            _ => {}
        }
        true
    }

    /// Where every quantity is within its range at the end of a step.
    #[inline(always)]
    pub(crate) fn holds(
        &mut self,
        system: &System<W>,
        (time, end): (W, &[W]),
        held: &Held<W>,
        at: &mut Evaluation<W>,
    ) -> W::Mask {
        let mut within = W::Mask::splat(true);
        for (range, number) in self.states.iter().zip(end) {
            within = within & range.holds(*number);
        }
        let holds = self.held.iter().any(|held| *held);
        for (i, (ranges, watched)) in self.actuators.iter().zip(&self.watched).enumerate() {
            if !(holds || watched.ends || watched.forces) {
                continue;
            }
            system.enter_ends_of(i, time, end, held, at);
            let (wire, unit) = (&system.wires[i], at.units[i]);
            if watched.ends {
                within = within & ranges.length.holds(unit.length) & ranges.rate.holds(unit.rate);
            }
            if watched.forces {
                let ends = [unit.length, unit.velocity, end[wire.places.pressure]];
                let taut_force = wire.member.actuator.limits().taut_force(unit.length, unit.velocity);
                let force = held.signed_force(wire, ends, system.deflections(i, end));
                within = within & ranges.force.holds(force) & ranges.taut_force.holds(taut_force);
            }
        }
        for (m, holds) in self.holds.iter().enumerate() {
            if self.held[m] {
                within = within & (holds.le(W::zero()) | hold_margin(system, m, end, held, at));
            }
        }
        for (m, contacts) in self.contacts.iter().enumerate() {
            within = within & contacts_hold(system, m, contacts, end);
        }
        within = within & self.ends.hold(system, (time, end), held, at);
        within = within & self.facets.hold(system, (time, end), held, at);
        if !self.outlets.is_empty() {
            within = within & self.outlets_hold(system, (time, end), held, at);
        }
        within
    }

    /// Where the errors of all regulators, and what feeds them, are within their ranges.
    #[inline(always)]
    fn outlets_hold(
        &self,
        system: &System<W>,
        (time, end): (W, &[W]),
        held: &Held<W>,
        at: &mut Evaluation<W>,
    ) -> W::Mask {
        let network = system.plant.network();
        system.enter_air(time, end, held, at);
        let mut within = W::Mask::splat(true);
        for its in &self.outlets {
            let limited = held.flows().is_limited(its.node);
            if let Some(error) = network.outlet_error(its.node, limited, &at.network) {
                within = within & its.error.holds(error);
            }
            let (Some(inlet), Some(margin)) = (its.inlet, network.inlet_margin(its.node, &at.network)) else {
                continue;
            };
            within = within & its.margin.holds(margin);
            if let NodeKind::Reservoir(_) = network.nodes[inlet].kind {
                let [inlet, outlet] = [at.network.nodes[inlet].pressure, at.network.nodes[its.node].pressure];
                within = within & (W::constant(FAR_FROM_EMPTY) * outlet).le(inlet);
            }
        }
        within
    }
}

/// Where the contacts of a mechanism are within their ranges.
#[inline(always)]
fn contacts_hold<W: Wide>(system: &System<W>, m: usize, contacts: &[ContactRanges<W>], end: &[W]) -> W::Mask {
    let mut within = W::Mask::splat(true);
    let Mechanism::Chain(chain) = &system.plant.mechanisms()[m] else { return within };
    let (angle, rate) = system.plant.indices().mechanisms[m].of(end);
    for (place, its) in contacts.iter().enumerate() {
        if !its.watched {
            continue;
        }
        let (k, side) = (place / 2, place % 2);
        let stop = if k < angle.len() { Some((k, side)) } else { None };
        let [depth, press] = chain.contact(stop, angle, rate);
        within = within & its.depth.holds(depth) & its.press.holds(press);
    }
    within
}

/// The least and the largest tension in N that an actuator at rest can hold, which is not slack.
#[inline(always)]
pub(crate) fn holdable<W: Wide>(system: &System<W>, i: usize, end: &[W], held: &Held<W>, at: &Evaluation<W>) -> (W, W) {
    let (least, most) = holdable_by(system, i, ThreadContact::Pressed, end, held, at);
    let wire = &system.wires[i];
    let apart = are_apart(&wire.member.actuator, end[wire.places.pressure]);
    if apart.any() {
        let (low, high) = holdable_by(system, i, ThreadContact::Apart, end, held, at);
        return (W::select(apart, low, least), W::select(apart, high, most));
    }
    (least, most)
}

/// What an actuator can hold whose threads touch in this way.
#[inline(always)]
fn holdable_by<W: Wide>(
    system: &System<W>,
    i: usize,
    touch: ThreadContact,
    end: &[W],
    held: &Held<W>,
    at: &Evaluation<W>,
) -> (W, W) {
    let (wire, unit, zero) = (&system.wires[i], &at.units[i], W::zero());
    let state_of_sliding = held.sliding_state(wire, [unit.length, zero], system.deflections(i, end), (zero, touch));
    wire.member.actuator.holdable(unit.length, end[wire.places.pressure], held.is_on_stop(i), state_of_sliding)
}

/// Where sticking actuators on the one coordinate of a mechanism hold it by more than a margin.
#[inline(always)]
fn hold_margin<W: Wide>(system: &System<W>, m: usize, end: &[W], held: &Held<W>, at: &mut Evaluation<W>) -> W::Mask {
    let zero = W::zero();
    let position = end[system.plant.indices().mechanisms[m].first];
    let mut load = match &system.plant.mechanisms()[m] {
        Mechanism::Mass(mass) => mass.force(position),
        Mechanism::Chain(chain) => {
            let (mut torque, mut directions) = ([zero], [[zero; 2]]);
            chain.enter_directions(&[position], &mut directions);
            let motion = ChainMotion { directions: &directions, angle: &[position], rate: &[zero] };
            held.torques(system, m, motion, &mut torque);
            torque[0]
        }
        _ => return W::Mask::splat(false),
    };
    let (mut least, mut most) = (zero, zero);
    let mut size = load.magnitude();
    for &i in &system.plant.indices().members[m] {
        let (wire, unit) = (&system.wires[i], at.units[i]);
        let arm = system.gradient(i, &at.gradient)[0];
        if let Some(tendon) = &system.plant.actuators()[i].tendon {
            let pull = tendon_tension(tendon, held.is_loose(i), unit.distance, unit.length);
            load = load - arm * pull;
            size = size + (arm * pull).magnitude();
            continue;
        }
        let pressure = end[wire.places.pressure];
        let deflections = system.deflections(i, end);
        let sticks = held.is_stuck(i) & !held.is_slack(i);
        let (low, high) = holdable(system, i, end, held, at);
        let pulls = held.tension(wire, [unit.length, zero, pressure], deflections).larger(zero);
        load = load - arm * pulls;
        let (by_low, by_high) = (arm * low, arm * high);
        least = least + W::select(sticks, by_low.smaller(by_high), zero);
        most = most + W::select(sticks, by_low.larger(by_high), zero);
        size = size + by_high.magnitude().larger(by_low.magnitude());
    }
    let margin = W::constant(W::MARGIN) * size;
    (least + margin).le(load) & load.le(most - margin)
}
