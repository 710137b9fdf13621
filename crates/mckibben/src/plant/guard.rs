//! When a mode of the plant ends: its guards, and their values on a state.
//!
//! A guard is positive while its mode lasts. Guards of one state are linear and are found on the polynomial of a step alone;
//! the others are evaluated. Where a tie is, the first of the list is crossed first: mechanisms, then actuators in their
//! order, then the network.

use super::Plant;
use super::evaluation::{Evaluation, System};
use super::formulas::Formulas;
use super::mode::PlantMode;
use super::tendon;
use crate::engine::GuardForm;
use crate::load::SeriesTendon;
use crate::mechanism::{Contact, Coupling, Mechanism};
use crate::network::BranchKind;
use crate::network::guard::NetworkGuard;
use crate::scalar::{Differentiable, Real};
use crate::simulation::member::Trace;
use crate::simulation::{Guard, LengthRegime, Sliding};
use alloc::vec::Vec;

/// Why a mode of a plant ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlantGuard {
    /// A guard of an actuator.
    Of(usize, Guard),
    /// An angle leaves a piece of a moment arm.
    Arm {
        /// Of which actuator.
        actuator: usize,
        /// Which of its arms.
        arm: usize,
        /// Towards greater angles.
        up: bool,
    },
    /// A contact of a mechanism begins, ends, presses or ceases to press.
    ThreadContact {
        /// Which mechanism.
        mechanism: usize,
        /// Of which joint and end; the foot where there is none.
        stop: Option<(usize, usize)>,
        /// What happens.
        touch: ContactEvent,
    },
    /// The end of an actuator on a tendon, without viscous friction, jumps: its air holds its length no more.
    Jump(usize),
    /// What sticks can no longer be held.
    Release {
        /// Of which mechanism.
        mechanism: usize,
        /// Which facet of what it can hold.
        facet: usize,
        /// On which side.
        positive: bool,
    },
    /// A guard of the network.
    Network(NetworkGuard),
}

/// What happens to a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactEvent {
    /// It is reached.
    Reach,
    /// It ceases to press while the other side comes back.
    Rebound,
    /// It presses again.
    Press,
    /// It is left.
    Leave,
}

/// The velocity in m/s above which an end without a mass does not slide any more, but jumps.
pub const FASTEST: f64 = 100.0;

impl<R: Real> System<R> {
    /// The velocity in m/s by which zero must be passed before an actuator is at rest: what a few steps may err.
    pub fn rest_band(&self, i: usize) -> f64 {
        10.0 * self.band * self.slow(self.plant.actuators[i].mechanism, self.wires[i].member.longest)
    }

    /// Lists the guards of a mode.
    pub(crate) fn guards(&self, mode: &PlantMode<R>, guards: &mut Vec<(PlantGuard, GuardForm<R>)>) {
        guards.clear();
        for m in 0..self.plant.mechanisms.len() {
            self.mechanism_guards(m, mode, guards);
        }
        for i in 0..self.wires.len() {
            self.actuator_guards(i, mode, guards);
        }
        let plant = &*self.plant;
        let place = |node: usize| match plant.network.nodes[node].kind {
            crate::network::NodeKind::Chamber { actuator } => Some(plant.places.actuators[actuator].pressure),
            _ => plant.places.nodes[node],
        };
        plant.network.guards(&mode.network, self.band, place, |guard, form| {
            guards.push((PlantGuard::Network(guard), form));
        });
    }

    fn mechanism_guards(&self, m: usize, mode: &PlantMode<R>, guards: &mut Vec<(PlantGuard, GuardForm<R>)>) {
        let of_mechanism = &mode.mechanisms[m];
        for facet in 0..of_mechanism.facets.len() {
            for positive in [true, false] {
                guards.push((PlantGuard::Release { mechanism: m, facet, positive }, GuardForm::Function));
            }
        }
        let Mechanism::Chain(chain) = &self.plant.mechanisms[m] else { return };
        if of_mechanism.frozen {
            return;
        }
        let here = self.plant.places.mechanisms[m];
        let touch = |stop, touch| PlantGuard::ThreadContact { mechanism: m, stop, touch };
        for (k, joint) in chain.joints().iter().enumerate() {
            for end in 0..2 {
                let Some(angle) = joint.stops.ends[end] else { continue };
                let (index, bound) = (here.position(k), angle);
                let [inside, outside] = [end == 0, end != 0].map(|above| GuardForm::on(index, bound, above));
                let stop = Some((k, end));
                match of_mechanism.stops[k][end] {
                    Contact::None => guards.push((touch(stop, ContactEvent::Reach), inside)),
                    Contact::Pressed => guards.push((touch(stop, ContactEvent::Rebound), GuardForm::Function)),
                    Contact::Rebound => {
                        guards.push((touch(stop, ContactEvent::Leave), outside));
                        guards.push((touch(stop, ContactEvent::Press), GuardForm::Function));
                    }
                }
            }
        }
        if chain.belt().is_some() {
            match of_mechanism.foot {
                Contact::None => guards.push((touch(None, ContactEvent::Reach), GuardForm::Function)),
                Contact::Pressed => guards.push((touch(None, ContactEvent::Rebound), GuardForm::Function)),
                Contact::Rebound => {
                    guards.push((touch(None, ContactEvent::Leave), GuardForm::Function));
                    guards.push((touch(None, ContactEvent::Press), GuardForm::Function));
                }
            }
        }
    }

    fn actuator_guards(&self, i: usize, mode: &PlantMode<R>, guards: &mut Vec<(PlantGuard, GuardForm<R>)>) {
        let (mounted, here) = (&self.plant.actuators[i], &self.plant.places.actuators[i]);
        let of_actuator = &mode.actuators[i];
        let (member, its) = (&self.wires[i].member, &of_actuator.mode);
        let mut add = |guard, form| guards.push((PlantGuard::Of(i, guard), form));
        let stuck = its.sliding == Sliding::Stuck;
        let mechanism = &self.plant.mechanisms[mounted.mechanism];
        let held = matches!(mechanism, Mechanism::Fixed) && here.length.is_none();
        if !stuck && !held {
            let (by_length, by_force) = member.length_regime_guards(its.length_regime);
            for (guard, bound, lasts_above) in by_length.into_iter().flatten() {
                add(guard, self.length_form(i, bound, lasts_above));
            }
            if let Some(guard) = by_force {
                add(guard, GuardForm::Function);
            }
        }
        match its.sliding {
            Sliding::Lengthening | Sliding::Shortening if here.length.is_some() => {
                add(Guard::Rest, GuardForm::Function);
            }
            Sliding::Lengthening | Sliding::Shortening
                if its.length_regime != LengthRegime::Slack && self.leads_to_rest(i, mode) =>
            {
                add(Guard::Rest, self.rest_form(i, its.sliding));
            }
            Sliding::Stuck if here.length.is_some() => {
                add(Guard::BreakLonger, GuardForm::Function);
                add(Guard::BreakShorter, GuardForm::Function);
            }
            _ => {}
        }
        if its.length_regime != LengthRegime::Slack
            && let Some((end, lasts_above)) = of_actuator.trace.as_ref().and_then(Trace::end)
        {
            add(Guard::Slip, self.length_form(i, end, lasts_above));
        }
        if let (Some(_), false, false) = (&mounted.tendon, stuck, mode.is_damped(self, i)) {
            guards.push((PlantGuard::Jump(i), GuardForm::Function));
        }
        let mut add = |guard, form| guards.push((PlantGuard::Of(i, guard), form));
        if mounted.tendon.is_some() {
            add(if of_actuator.loose { Guard::TendonTight } else { Guard::TendonLoose }, GuardForm::Function);
        } else if !stuck && its.length_regime != LengthRegime::Slack {
            add(if its.clamped { Guard::TensionBack } else { Guard::TensionZero }, GuardForm::Function);
        }
        for guard in [
            Guard::PieceDown,
            Guard::PieceUp,
            Guard::MapDown,
            Guard::MapUp,
            Guard::MapShorter,
            Guard::MapLonger,
            Guard::PressDown,
            Guard::PressUp,
        ] {
            if let Some((bound, lasts_above)) = member.pressure_limit(guard, its) {
                add(guard, GuardForm::on(here.pressure, bound, lasts_above));
            } else if let Some((bound, lasts_above)) = member.map_length_limit(guard, its) {
                add(guard, self.length_form(i, bound, lasts_above));
            }
        }
        if let Coupling::Arms { arms, .. } = &mounted.coupling {
            let from = self.plant.places.mechanisms[mounted.mechanism].first;
            for (place, arm) in arms.iter().enumerate() {
                let (low, high) = arm.arm.piece_bounds(mode.arms[here.arms + place]);
                for (bound, up) in [(low, false), (high, true)] {
                    if let Some(bound) = bound {
                        let form = GuardForm::on(from + arm.joint, bound, !up);
                        guards.push((PlantGuard::Arm { actuator: i, arm: place, up }, form));
                    }
                }
            }
        }
    }

    /// How a bound on an actuator's length is searched for: on a state where one alone decides it.
    fn length_form(&self, i: usize, bound: R, lasts_above: bool) -> GuardForm<R> {
        let (mounted, here) = (&self.plant.actuators[i], &self.plant.places.actuators[i]);
        if let Some(place) = here.length {
            return GuardForm::on(place, bound, lasts_above);
        }
        match mounted.coupling.coordinate_at(bound) {
            Some((coordinate, value, grows)) => {
                let index = self.plant.places.mechanisms[mounted.mechanism].position(coordinate);
                GuardForm::on(index, value, lasts_above == grows)
            }
            None => GuardForm::Function,
        }
    }

    /// How the velocity of an actuator without a tendon comes to rest.
    fn rest_form(&self, i: usize, sliding: Sliding) -> GuardForm<R> {
        let mounted = &self.plant.actuators[i];
        match mounted.coupling.constant_gradient() {
            Some((coordinate, slope)) => {
                let index = self.plant.places.mechanisms[mounted.mechanism].rate(coordinate);
                let (slope, direction) = (slope.value(), sliding.direction());
                let bound = R::constant(self.rest_band(i) / slope.abs());
                if direction * slope > 0.0 {
                    GuardForm::Above { index, bound: -bound }
                } else {
                    GuardForm::Below { index, bound }
                }
            }
            None => GuardForm::Function,
        }
    }

    /// Whether the rest of an actuator is looked for: on one coordinate all come to rest together, and one is enough. Between points
    /// each comes to rest at its dead centre besides.
    fn leads_to_rest(&self, i: usize, mode: &PlantMode<R>) -> bool {
        let Plant { actuators, places, .. } = &*self.plant;
        let m = actuators[i].mechanism;
        if places.mechanisms[m].coordinates > 1 || actuators[i].coupling.has_dead_centres() {
            return true;
        }
        let rests_with_others = |&&other: &&usize| {
            let its = &mode.actuators[other].mode;
            let sliding = matches!(its.sliding, Sliding::Lengthening | Sliding::Shortening);
            let is_slack = its.length_regime == LengthRegime::Slack;
            sliding
                && !is_slack
                && places.actuators[other].length.is_none()
                && !actuators[other].coupling.has_dead_centres()
        };
        places.members[m].iter().find(rests_with_others) == Some(&i)
    }

    /// Value of a guard at a time in s and a state, positive while the mode lasts.
    pub(crate) fn guard<T: Differentiable<R>>(
        &self,
        guard: PlantGuard,
        time: T,
        state: &[T],
        mode: &PlantMode<R>,
        at: &mut Evaluation<T>,
    ) -> T {
        match guard {
            PlantGuard::Release { mechanism, facet, positive } => {
                self.facet_guard((mechanism, facet, positive), time, state, mode, at)
            }
            PlantGuard::ThreadContact { mechanism, stop, touch } => self.touch_guard(mechanism, stop, touch, state),
            PlantGuard::Arm { actuator, arm, up } => {
                let mounted = &self.plant.actuators[actuator];
                let Coupling::Arms { arms, .. } = &mounted.coupling else { return T::one() };
                let piece = mode.arms[self.plant.places.actuators[actuator].arms + arm];
                let (low, high) = arms[arm].arm.piece_bounds(piece);
                let angle = state[self.plant.places.mechanisms[mounted.mechanism].position(arms[arm].joint)];
                match if up { high } else { low } {
                    Some(bound) if up => T::of(bound) - angle,
                    Some(bound) => angle - T::of(bound),
                    None => T::one(),
                }
            }
            PlantGuard::Jump(i) => {
                self.enter_air(time, state, mode, at);
                let Some(tendon) = &self.plant.actuators[i].tendon else { return T::one() };
                let of_unit = (&at.units[i], &at.chambers[i]);
                self.hold_of_end(i, tendon, mode, of_unit, self.deflections(i, state), FASTEST)
            }
            PlantGuard::Network(NetworkGuard::Sonic { branch, forwards }) => {
                let network = &self.plant.network;
                let (Some(place), Some((behind, per_pressure))) =
                    (self.plant.places.branches[branch], network.sonic::<T>(branch, forwards))
                else {
                    return T::one();
                };
                let atmosphere = T::of(network.atmosphere);
                let pressure = self.piping.pressure(behind, state).unwrap_or(atmosphere);
                let left = per_pressure * (pressure + T::constant(self.band) * atmosphere) - state[place];
                if forwards { left } else { -left }
            }
            PlantGuard::Network(NetworkGuard::Slower { branch }) => {
                let Some(forwards) = mode.network.branches[branch].sonic else { return T::one() };
                self.evaluate(time, state, mode, at);
                let network = &self.plant.network;
                let Some((behind, per_pressure)) = network.sonic::<T>(branch, forwards) else { return T::one() };
                let drive = network.sonic_drive(branch, forwards, self.pressure_rate(behind, mode, at), &at.network);
                // A border as wide as that which the flow has passed, over the time of a wave through the cell.
                let per_time = match network.branches[branch].kind {
                    BranchKind::Inertia(hose) => T::of(hose.wave_speed() / hose.tube().length()),
                    _ => T::one(),
                };
                drive + per_pressure.magnitude() * per_time * T::constant(self.band) * T::of(network.atmosphere)
            }
            PlantGuard::Network(guard) => {
                if let NetworkGuard::Poppet { .. } | NetworkGuard::Limit { .. } = guard {
                    self.enter_air(time, state, mode, at);
                } else {
                    self.piping.enter_pressures(state, &mut at.network);
                }
                self.plant.network.guard(guard, &mode.network, self.band, &at.network)
            }
            PlantGuard::Of(i, guard) => match &self.plant.actuators[i].tendon {
                Some(tendon) => {
                    self.enter_distances(time, state, mode, at);
                    self.tendon_guard(i, tendon, guard, time, state, mode, at)
                }
                None => {
                    self.enter_ends_of(i, time, state, mode, at);
                    self.member_guard(i, guard, state, mode, at)
                }
            },
        }
    }

    fn member_guard<T: Differentiable<R>>(
        &self,
        i: usize,
        guard: Guard,
        state: &[T],
        mode: &PlantMode<R>,
        at: &Evaluation<T>,
    ) -> T {
        let (unit, of_actuator) = (&at.units[i], &mode.actuators[i]);
        if guard == Guard::Rest {
            let (band, sliding) = (T::constant(self.rest_band(i)), of_actuator.mode.sliding);
            // What slides does so until its rate has turned, what is held at rest until it moves either way.
            return match sliding {
                Sliding::Held => band - unit.rate.magnitude(),
                _ => band + T::constant(sliding.direction()) * unit.rate,
            };
        }
        let ends = [unit.length, unit.velocity, state[self.plant.places.actuators[i].pressure]];
        self.wires[i].member.guard(guard, ends, &of_actuator.mode, (&of_actuator.trace, self.deflections(i, state)))
    }

    #[allow(clippy::too_many_arguments)]
    fn tendon_guard<T: Differentiable<R>>(
        &self,
        i: usize,
        tendon: &SeriesTendon<R>,
        guard: Guard,
        time: T,
        state: &[T],
        mode: &PlantMode<R>,
        at: &mut Evaluation<T>,
    ) -> T {
        let (member, of_actuator) = (&self.wires[i].member, &mode.actuators[i]);
        let band = T::constant(member.force_band);
        let direction = T::constant(of_actuator.mode.sliding.direction());
        let unit = at.units[i];
        let pressure = state[self.plant.places.actuators[i].pressure];
        let deflections = self.deflections(i, state);
        let stretch = || unit.distance - unit.length - T::of(tendon.rest_length());
        let slack = T::constant(self.stretch_band(i, tendon));
        let pull = || tendon::tension(tendon, of_actuator.loose, unit.distance, unit.length);
        let limits = member.actuator.limits();
        match guard {
            Guard::Rest if mode.is_damped(self, i) => {
                let ends = [unit.distance, unit.length, pressure];
                band - direction * self.excess(i, tendon, mode, ends, deflections)
            }
            Guard::Rest => {
                let velocity = self.velocity_of_end(i, time, state, mode, at);
                T::constant(self.rest_band(i)) + direction * velocity
            }
            Guard::BreakLonger => self.holdable(i, state, mode, unit.length).1 + band - pull(),
            Guard::BreakShorter => pull() - self.holdable(i, state, mode, unit.length).0 + band,
            Guard::Rebound => {
                let velocity = self.velocity_of_end(i, time, state, mode, at);
                limits.taut_force(unit.length, velocity) + band
            }
            Guard::Retaut => {
                let velocity = self.velocity_of_end(i, time, state, mode, at);
                band - limits.taut_force(unit.length, velocity)
            }
            Guard::TendonLoose => stretch() + slack,
            Guard::TendonTight => slack - stretch(),
            _ => self.member_guard(i, guard, state, mode, at),
        }
    }

    /// The rate of the length of an actuator on a tendon in m/s.
    pub(crate) fn velocity_of_end<T: Differentiable<R>>(
        &self,
        i: usize,
        time: T,
        state: &[T],
        mode: &PlantMode<R>,
        at: &mut Evaluation<T>,
    ) -> T {
        self.enter_air(time, state, mode, at);
        match &self.plant.actuators[i].tendon {
            Some(tendon) => {
                let of_unit = (&at.units[i], &at.chambers[i]);
                self.end_velocity(i, tendon, mode, of_unit, self.deflections(i, state))
            }
            None => at.units[i].velocity,
        }
    }

    /// Scale in m of the length of an actuator on a tendon: a part of the tendon's stretch under a usual force.
    pub(crate) fn tendon_scale(&self, i: usize, tendon: &SeriesTendon<R>) -> f64 {
        /// Part of the stretch under the usual force by which lengths are measured.
        const TENSE: f64 = 0.5;
        let member = &self.wires[i].member;
        (TENSE * member.force_band / member.band / tendon.stiffness().value()).min(member.longest)
    }

    /// By how much in m the stretch of a tendon must pass zero.
    pub fn stretch_band(&self, i: usize, tendon: &SeriesTendon<R>) -> f64 {
        self.wires[i].member.band * self.tendon_scale(i, tendon)
    }

    /// By how much in N·m the torque of a stop of a chain must pass zero, or by how much in N the press of its foot.
    pub fn contact_band(&self, m: usize, is_stop: bool) -> f64 {
        let band = self.band * self.usual_torque[m];
        match &self.plant.mechanisms[m] {
            Mechanism::Chain(chain) if !is_stop => band / chain.belt().map_or(1.0, |belt| belt.depth.value()),
            _ => band,
        }
    }

    fn touch_guard<T: Differentiable<R>>(
        &self,
        m: usize,
        stop: Option<(usize, usize)>,
        touch: ContactEvent,
        state: &[T],
    ) -> T {
        let Mechanism::Chain(chain) = &self.plant.mechanisms[m] else { return T::one() };
        let (angle, rate) = self.plant.places.mechanisms[m].of(state);
        let [beyond, press] = chain.contact(stop, angle, rate);
        let band = T::constant(self.contact_band(m, stop.is_some()));
        match touch {
            ContactEvent::Reach => -beyond,
            ContactEvent::Leave => beyond,
            ContactEvent::Rebound => press + band,
            ContactEvent::Press => band - press,
        }
    }
}
