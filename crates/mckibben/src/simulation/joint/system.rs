//! A joint as a hybrid system: when each formula holds, and what follows when it ends.
//!
//! The modes of its two [members](crate::simulation::member), and
//!
//! | component of the mode | values | ends when |
//! |---|---|---|
//! | turning | forward, backward, stuck, frictionless | the angular velocity comes to zero; the joint breaks away |
//! | contact | none, pressed, rebound at either stop | the angle passes a stop; the stop's torque passes zero |
//! | piece of each moment arm | 0, 1, … | the angle passes a row of its table |
//!
//! States and modes of regulated ports and of bristles are in [`beside`](super::beside). Sliding is decided once for the joint, in [`turning`](super::turning).

use super::beside::Beside;
use super::mode::{Contact, End, JointEventKind, JointGuard, JointMode, Turning};
#[cfg(feature = "alloc")]
use super::trajectory::JointSample;
use super::{JointRig, JointState};
#[cfg(feature = "alloc")]
use crate::air::Flow;
use crate::dual::Dual;
use crate::error::Error;
use crate::load::{Joint, Leverage, SIGN};
#[cfg(feature = "alloc")]
use crate::pressure::AbsolutePressure;
use crate::scalar::{Differentiable, Over, Real};
use crate::simulation::member::{Member, Trace};
use crate::simulation::mode::{EventKind, Extent, Guard, Mode, Sliding};
use crate::simulation::regulated::PortMode;
#[cfg(feature = "alloc")]
use crate::simulation::sample::Sample;
use crate::simulation::system::{GuardForm, Guards, HybridSystem};
use crate::simulation::timetable::Progress;
use crate::valve::Openings;

pub(super) const ANGLE: usize = 0;
pub(super) const VELOCITY: usize = 1;
/// Places of the pressures among the states; each is followed by the mass of the air.
pub(super) const PRESSURE: [usize; 2] = [2, 4];

/// Angle in rad and time in s by which the joint's motion is measured.
const USUAL_ANGLE: f64 = 1.0;
const USUAL_TIME: f64 = 1.0;
/// The part of the usual angular velocity below which an error in it counts absolutely.
const SLOW: f64 = 0.1;
/// Part of the depth under the usual torque by which a pressed stop is measured.
const PRESSED: f64 = 0.5;

/// The mode with what its clocks remember.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPhase<R = f64> {
    /// Which formulas hold.
    pub mode: JointMode,
    progress: [Progress<R>; 2],
    pub(super) openings: [Openings<R>; 2],
    pub(super) port: [PortMode; 2],
    /// `P V/m` of isothermal processes, which nothing changes.
    isothermal: [Option<R>; 2],
    /// What the hysteresis of each actuator remembers.
    pub(super) traces: Traces<R>,
}

/// What the hysteresis of each actuator remembers, where there is one.
pub(super) type Traces<R> = [Option<Trace<R>>; 2];

/// A joint with the tolerance to which its events are told from rounding.
#[derive(Clone, Copy, Debug)]
pub struct JointSystem<'a, R: Real = f64> {
    rig: &'a JointRig<R>,
    pub(super) members: [Member<'a, R>; 2],
    pub(super) beside: Beside<'a, R>,
    /// Angles at which each actuator is at its shortest and at its longest, and its braid straight.
    pub(super) limits: [[R; 3]; 2],
    /// Usual moment arms in m.
    arms: [f64; 2],
    /// `1/J`.
    pub(super) per_inertia: R,
    /// Width as a torque in N·m of a border between agreeing formulas.
    pub(super) torque_band: f64,
    /// Scale of the angle in rad, in general and while a stop is touched.
    pub(super) angle_scales: [f64; 2],
}

impl<'a, R: Real> JointSystem<'a, R> {
    /// A joint whose steps are controlled to `relative_tolerance`.
    pub fn new(rig: &'a JointRig<R>, relative_tolerance: f64) -> Self {
        let joint = rig.joint();
        let load = joint.weight().value().abs() + joint.torque().value().abs();
        let arms = joint.leverage(R::zero()).arms.map(R::value);
        let actuators = rig.actuators();
        let member = |i: usize| Member::new(actuators[i], relative_tolerance, load / arms[i]);
        let members = [member(0), member(1)];
        let limits = core::array::from_fn(|i| {
            let limits = actuators[i].limits();
            [limits.min_length(), limits.max_length(), members[i].thread_length()]
                .map(|length| joint.angle_at(i, length))
        });
        let torque_band = arms[0] * members[0].force_band + arms[1] * members[1].force_band;
        let angle = (0..2).fold(USUAL_ANGLE, |least, i| least.min(members[i].longest / arms[i]));
        let depth = PRESSED * torque_band / (members[0].band * joint.stops().stiffness.value());
        Self {
            rig,
            members,
            beside: Beside::new(rig),
            limits,
            arms,
            per_inertia: R::one() / joint.inertia(),
            torque_band,
            angle_scales: [angle, depth.min(angle)],
        }
    }

    /// The rig.
    pub fn rig(&self) -> &JointRig<R> {
        self.rig
    }

    pub(super) fn joint(&self) -> &Joint<R> {
        self.rig.joint()
    }

    /// The states at the start: the joint's six and those beside, zero in places that have no meaning.
    pub fn start<const N: usize>(&self, start: JointState<R>) -> [R; N] {
        let mut state = [R::zero(); N];
        state[..6].copy_from_slice(&start.to_array());
        self.start_beside(&mut state);
        state
    }

    /// The phase at t = 0 in a state.
    pub fn begin<const N: usize>(&self, state: &[R; N]) -> JointPhase<R> {
        let mut progress = [Progress::none(); 2];
        let ports = [0, 1].map(|i| self.rig.timetable(i).pass(&mut progress[i], R::zero()));
        let arm_pieces = self.joint().pieces(state[ANGLE]);
        let lengths = self.leverage(state[ANGLE], arm_pieces).lengths;
        let actuators = [0, 1].map(|i| {
            let pressure = state[PRESSURE[i]];
            let mut mode = Mode {
                ports: ports[i],
                supply_zone: None,
                exhaust_zone: None,
                effectiveness_piece: self.members[i].effectiveness_piece(pressure),
                pressed: self.members[i].pressed(pressure),
                force_piece: self.members[i].force_piece(lengths[i], pressure),
                extent: Extent::Free,
                sliding: Sliding::Frictionless,
                clamped: false,
            };
            self.members[i].enter_ports(pressure, self.feed(i, state), &mut mode);
            mode
        });
        let isothermal = [0, 1]
            .map(|i| self.members[i].isothermal_content(lengths[i], [state[PRESSURE[i]], state[PRESSURE[i] + 1]]));
        let mut mode =
            JointMode { actuators, turning: Turning::Frictionless, contact: self.contact_at(state), arm_pieces };
        for i in 0..2 {
            let above = [0, 1].map(|limit| SIGN[i] * (state[ANGLE].value() - self.limits[i][limit].value()));
            let [length, velocity, _] = self.ends(i, state, arm_pieces);
            mode.actuators[i].extent = self.members[i].extent_at([length, velocity], above, false);
        }
        let traces =
            [0, 1].map(|i| self.members[i].trace(self.members[i].actuator.limits().actuator_length(lengths[i])));
        self.enter_turning(state, &mut mode, &traces);
        let openings = [0, 1].map(|i| self.rig.timetable(i).openings(&progress[i]));
        let mut phase = JointPhase { mode, progress, openings, port: [PortMode::AT_REST; 2], isothermal, traces };
        while self.pass_set_points(R::zero(), state, &mut phase.port).is_some() {}
        self.follow(state, &mut phase, None);
        phase
    }

    /// Takes the memories of the hysteresis on to a state, and to the branches that follow; `slips` says which actuator's
    /// is at the end of its branch.
    fn follow<const N: usize>(&self, state: &[R; N], phase: &mut JointPhase<R>, slips: Option<usize>) {
        let lengths = self.leverage(state[ANGLE], phase.mode.arm_pieces).lengths;
        for (i, length) in lengths.into_iter().enumerate() {
            let member = &self.members[i];
            let length = member.actuator.limits().actuator_length(length);
            member.follow(&mut phase.traces[i], length, phase.mode.actuators[i].sliding, slips == Some(i));
        }
    }

    /// Where both actuators pull at an angle in rad, by pieces of their moment arms.
    #[inline(always)]
    pub(super) fn leverage<T: Over<R>>(&self, angle: T, pieces: [usize; 2]) -> Leverage<T> {
        self.joint().leverage_in(pieces, angle)
    }

    /// Length, velocity and pressure of an actuator.
    #[inline(always)]
    pub(super) fn ends<T: Over<R>, const N: usize>(&self, i: usize, state: &[T; N], pieces: [usize; 2]) -> [T; 3] {
        let leverage = self.leverage(state[ANGLE], pieces);
        [leverage.lengths[i], leverage.slopes()[i] * state[VELOCITY], state[PRESSURE[i]]]
    }

    /// Tensions in N of both actuators in a mode.
    pub fn tensions<const N: usize>(&self, state: &[R; N], phase: &JointPhase<R>) -> [R; 2] {
        let JointPhase { mode, traces, .. } = phase;
        if mode.turning != Turning::Stuck {
            return self.sliding_tensions(state, mode, traces);
        }
        self.shared_tensions(state, mode, traces)
    }

    #[inline(always)]
    fn sliding_tensions<T: Over<R>, const N: usize>(
        &self,
        state: &[T; N],
        mode: &JointMode,
        traces: &Traces<R>,
    ) -> [T; 2] {
        let of = |i: usize| {
            let ends = self.ends(i, state, mode.arm_pieces);
            self.members[i].tension(ends, &mode.actuators[i], self.remembered(i, state, traces))
        };
        [of(0), of(1)]
    }

    /// The sample of a state in a mode.
    #[cfg(feature = "alloc")]
    pub(super) fn sample<const N: usize>(&self, time: R, state: &[R; N], phase: &JointPhase<R>) -> JointSample<R> {
        let (mode, tensions) = (&phase.mode, self.tensions(state, phase));
        let actuators = [0, 1].map(|i| {
            let [length, velocity, pressure] = self.ends(i, state, mode.arm_pieces);
            let of_member = [length, velocity, pressure, state[PRESSURE[i] + 1]];
            let flow = self.flow(i, time, state, phase);
            let sample = self.members[i].sample(time, &of_member, tensions[i], &mode.actuators[i], flow);
            Sample { supply_pressure: self.feed(i, state).map(AbsolutePressure), ..sample }
        });
        let torque = self.leverage(state[ANGLE], mode.arm_pieces).torque_of(actuators.map(|actuator| actuator.tension));
        JointSample { time, angle: state[ANGLE], angular_velocity: state[VELOCITY], torque, actuators }
    }

    /// The flow into an actuator at a time in s.
    #[cfg(feature = "alloc")]
    pub(super) fn flow<const N: usize>(&self, i: usize, time: R, state: &[R; N], phase: &JointPhase<R>) -> Flow<R> {
        let [length, velocity, pressure] = self.ends(i, state, phase.mode.arm_pieces);
        let slack = phase.mode.actuators[i].extent == Extent::Slack;
        let chamber = self.members[i].actuator.chamber(length, velocity, pressure, state[PRESSURE[i] + 1], slack);
        self.members[i].flow(&chamber, self.through(i, time, state, phase))
    }

    /// Torque in N·m of everything but the actuators.
    #[inline(always)]
    pub(super) fn load_torque<T: Over<R>>(&self, angle: T, velocity: T, contact: Contact) -> T {
        let joint = self.joint();
        let load = joint.other_torque(angle, velocity);
        match contact {
            Contact::Pressed(end) => {
                let outwards = T::constant(SIGN[end.index()]);
                load - outwards * joint.stop_torque(end.index(), angle, velocity)
            }
            _ => load,
        }
    }

    fn contact_at<const N: usize>(&self, state: &[R; N]) -> Contact {
        let velocity = state[VELOCITY];
        for end in End::BOTH {
            let Some(stop) = self.joint().stops().ends[end.index()] else { continue };
            let outwards = SIGN[end.index()];
            let beyond = outwards * (state[ANGLE] - stop).value();
            if beyond > 0.0 || (beyond == 0.0 && outwards * velocity.value() > 0.0) {
                let presses = self.joint().stop_torque(end.index(), state[ANGLE], velocity).value() >= 0.0;
                return if presses { Contact::Pressed(end) } else { Contact::Rebound(end) };
            }
        }
        Contact::None
    }

    /// The angular velocity in rad/s by which zero must be passed before it is a turn: what a few steps may err.
    pub(super) fn rest_band(&self) -> f64 {
        10.0 * self.members[0].band * self.slow()
    }

    /// The angular velocity in rad/s below which its error counts absolutely.
    fn slow(&self) -> f64 {
        SLOW * self.angle_scales[0] / USUAL_TIME
    }

    /// The angle in rad at which a length of an actuator that ends an extent is reached.
    pub(super) fn limit_angle(&self, i: usize, guard: Guard) -> Option<(R, bool)> {
        let (limit, lasts_above) = match guard {
            Guard::Slack => (0, true),
            Guard::Tight => (0, false),
            Guard::Untaut => (1, true),
            Guard::Taut => (1, false),
            Guard::ThreadLength => (2, false),
            _ => return None,
        };
        Some((self.limits[i][limit], lasts_above == (SIGN[i] > 0.0)))
    }

    fn rates_of_member<T: Over<R>, const N: usize>(
        &self,
        i: usize,
        time: T,
        state: &[T; N],
        phase: &JointPhase<R>,
    ) -> [T; 2] {
        let [length, velocity, pressure] = self.ends(i, state, phase.mode.arm_pieces);
        let velocity = if phase.mode.turning == Turning::Stuck { T::zero() } else { velocity };
        self.members[i]
            .air_rates([length, velocity, pressure, state[PRESSURE[i] + 1]], self.through(i, time, state, phase))
    }
}

impl<R: Real, const N: usize> HybridSystem<R, N> for JointSystem<'_, R> {
    type Mode = JointPhase<R>;
    type Guard = JointGuard;
    type Kind = JointEventKind;

    fn states(&self) -> usize {
        self.states_of::<N>()
    }

    fn rates<T: Differentiable<R>>(&self, time: T, state: &[T; N], phase: &JointPhase<R>) -> [T; N] {
        let mode = &phase.mode;
        let [agonist, antagonist] = [0, 1].map(|i| self.rates_of_member(i, time, state, phase));
        let leverage = self.leverage(state[ANGLE], mode.arm_pieces);
        let [velocity, acceleration] = if mode.turning == Turning::Stuck {
            [T::zero(); 2]
        } else {
            let tensions = self.sliding_tensions(state, mode, &phase.traces);
            let load = self.load_torque(state[ANGLE], state[VELOCITY], mode.contact);
            [state[VELOCITY], (leverage.torque_of(tensions) + load) * T::of(self.per_inertia)]
        };
        let mut rates = [T::zero(); N];
        let six = [velocity, acceleration, agonist[0], agonist[1], antagonist[0], antagonist[1]];
        rates[..6].copy_from_slice(&six);
        self.rates_beside(state, (velocity, leverage.slopes()), phase, &mut rates);
        rates
    }

    fn settling_rate(&self, time: R, state: &[R; N], phase: &JointPhase<R>) -> f64 {
        let mode = &phase.mode;
        let mut damping = 0.0;
        if mode.turning != Turning::Stuck {
            let joint = self.joint();
            damping = joint.damping().value();
            if matches!(mode.contact, Contact::Pressed(_)) {
                damping += joint.stops().damping.value();
            }
            let arms = self.leverage(state[ANGLE], mode.arm_pieces).arms.map(R::value);
            for (i, arm) in arms.into_iter().enumerate() {
                damping += arm * arm * self.members[i].damping(&mode.actuators[i]);
            }
        }
        let slope = |place: usize| {
            let mut seeded = state.map(Dual::<R, 1>::of);
            seeded[place] = Dual::variable(state[place], 0);
            self.rates(Dual::of(time), &seeded, phase)[place].slope[0].value()
        };
        let settling = (damping * self.per_inertia.value()).max(self.settling_beside(state, phase, slope));
        (0..2).fold(settling, |fastest, i| {
            let rate = |pressure: Dual<R, 1>| {
                let mut seeded = state.map(Dual::<R, 1>::of);
                seeded[PRESSURE[i]] = pressure;
                self.rates_of_member(i, Dual::of(time), &seeded, phase)[0]
            };
            fastest.max(self.members[i].pressure_settling_rate(
                state[PRESSURE[i]],
                self.feed(i, state),
                &mode.actuators[i],
                rate,
            ))
        })
    }

    fn scales(&self, state: &[R; N], phase: &JointPhase<R>) -> [f64; N] {
        let [angle, velocity, pressure, mass, other_pressure, other_mass]: [f64; 6] =
            core::array::from_fn(|n| state[n].value().abs());
        let mode = &phase.mode;
        // Where a stop or a taut braid is stiff, an angle counts by the torque that an error in it makes.
        let mut scale =
            if mode.contact == Contact::None { angle.max(self.angle_scales[0]) } else { self.angle_scales[1] };
        for (i, member) in self.members.iter().enumerate() {
            if matches!(mode.actuators[i].extent, Extent::Taut | Extent::Rebound) {
                scale = scale.min(member.taut_scale / self.arms[i]);
            }
        }
        let [first, second] = &self.members;
        // What has no meaning never errs.
        let mut scales = [1.0; N];
        scales[..6].copy_from_slice(&[
            scale,
            velocity + self.slow(),
            pressure + 0.1 * first.atmosphere,
            mass + 0.1 * first.air_mass,
            other_pressure + 0.1 * second.atmosphere,
            other_mass + 0.1 * second.air_mass,
        ]);
        self.scales_beside(state, &mut scales);
        scales
    }

    fn next_instant(&self, phase: &JointPhase<R>, until: R) -> Option<R> {
        let next = [0, 1].map(|i| self.rig.timetable(i).next(&phase.progress[i], until));
        let set_point = self.next_set_point::<N>(phase, until);
        next.into_iter().chain([set_point]).flatten().min_by(|a, b| a.value().total_cmp(&b.value()))
    }

    fn pass_instant(&self, time: R, state: &mut [R; N], phase: &mut JointPhase<R>) -> Result<JointEventKind, Error> {
        // Of two seats that move in one instant the agonist's is first; the other's is the next event, at the same time.
        let due = |i: &usize| self.rig.timetable(*i).next(&phase.progress[*i], time).is_some();
        let Some(i) = [0, 1].into_iter().find(due) else {
            let actuator = self.pass_set_points(time, state, &mut phase.port);
            return Ok(JointEventKind { actuator, kind: EventKind::SetPoint });
        };
        let ports = self.rig.timetable(i).pass_seats(&mut phase.progress[i], time);
        phase.openings[i] = self.rig.timetable(i).openings(&phase.progress[i]);
        let member = &mut phase.mode.actuators[i];
        if ports != member.ports {
            member.ports = ports;
            self.members[i].enter_ports(state[PRESSURE[i]], self.feed(i, state), member);
        }
        Ok(JointEventKind { actuator: Some(i), kind: EventKind::Valve })
    }

    fn guards(&self, phase: &JointPhase<R>) -> Guards<JointGuard> {
        let mode = &phase.mode;
        let mut guards = Guards::new();
        let linear = |index, bound: R, above: bool| {
            let bound = bound.value();
            if above { GuardForm::Above { index, bound } } else { GuardForm::Below { index, bound } }
        };
        let moves = mode.turning != Turning::Stuck;
        for i in 0..2 {
            let (by_length, by_force) = self.members[i].extent_guards(mode.actuators[i].extent);
            for (guard, ..) in by_length.into_iter().flatten().filter(|_| moves) {
                if let Some((angle, above)) = self.limit_angle(i, guard) {
                    guards.add(JointGuard::Of(i, guard), linear(ANGLE, angle, above));
                }
            }
            if let Some(guard) = by_force.filter(|_| moves) {
                guards.add(JointGuard::Of(i, guard), GuardForm::Function);
            }
        }
        if moves {
            for (i, piece) in mode.arm_pieces.into_iter().enumerate() {
                let (first, last) = self.joint().tendons()[i].arm.piece_bounds(piece);
                if let Some(row) = first {
                    guards.add(JointGuard::ArmDown(i), linear(ANGLE, row, true));
                }
                if let Some(row) = last {
                    guards.add(JointGuard::ArmUp(i), linear(ANGLE, row, false));
                }
            }
            match mode.contact {
                Contact::None => {
                    for end in End::BOTH {
                        if let Some(stop) = self.joint().stops().ends[end.index()] {
                            guards.add(JointGuard::Reach(end), linear(ANGLE, stop, end == End::Lower));
                        }
                    }
                }
                Contact::Pressed(end) => guards.add(JointGuard::Rebound(end), GuardForm::Function),
                Contact::Rebound(end) => {
                    if let Some(stop) = self.joint().stops().ends[end.index()] {
                        guards.add(JointGuard::Leave(end), linear(ANGLE, stop, end == End::Upper));
                    }
                    guards.add(JointGuard::Press(end), GuardForm::Function);
                }
            }
        }
        let rest = R::constant(self.rest_band());
        match mode.turning {
            Turning::Forward => guards.add(JointGuard::Rest, linear(VELOCITY, -rest, true)),
            Turning::Backward => guards.add(JointGuard::Rest, linear(VELOCITY, rest, false)),
            Turning::Stuck => {
                guards.add(JointGuard::BreakForward, GuardForm::Function);
                guards.add(JointGuard::BreakBackward, GuardForm::Function);
            }
            Turning::Frictionless => {}
        }
        for i in 0..2 {
            let add = &mut |guard, form| guards.add(JointGuard::Of(i, guard), form);
            if mode.actuators[i].extent != Extent::Slack && phase.traces[i].as_ref().and_then(Trace::end).is_some() {
                add(Guard::Slip, GuardForm::Function);
            }
            self.members[i].each_other_guard(&mode.actuators[i], self.places::<N>(i), add);
            if let Some(form) = self.rate_limit::<N>(i, phase) {
                add(Guard::RateLimit, form);
            }
        }
        guards
    }

    fn guard<T: Differentiable<R>>(&self, guard: JointGuard, _time: T, state: &[T; N], phase: &JointPhase<R>) -> T {
        let mode = &phase.mode;
        let joint = self.joint();
        let (angle, velocity) = (state[ANGLE], state[VELOCITY]);
        let band = T::constant(self.torque_band);
        let beyond = |end: End| {
            let stop = joint.stops().ends[end.index()].map_or(angle, T::of);
            T::constant(SIGN[end.index()]) * (angle - stop)
        };
        let press = |end: End| joint.stop_torque(end.index(), angle, velocity);
        if let JointGuard::Of(i, guard) = guard
            && let Some(value) = self.guard_beside((i, guard), state, phase)
        {
            return value;
        }
        match guard {
            JointGuard::Of(i, guard) => match self.limit_angle(i, guard) {
                Some((limit, true)) => angle - T::of(limit),
                Some((limit, false)) => T::of(limit) - angle,
                None => self.members[i].guard(
                    guard,
                    self.ends(i, state, mode.arm_pieces),
                    &mode.actuators[i],
                    self.remembered(i, state, &phase.traces),
                ),
            },
            JointGuard::ArmDown(i) | JointGuard::ArmUp(i) => {
                let (first, last) = joint.tendons()[i].arm.piece_bounds(mode.arm_pieces[i]);
                let up = guard == JointGuard::ArmUp(i);
                let row = if up { last } else { first }.map_or(angle, T::of);
                if up { row - angle } else { angle - row }
            }
            JointGuard::Reach(end) => -beyond(end),
            JointGuard::Leave(end) => beyond(end),
            JointGuard::Rebound(end) => press(end) + band,
            JointGuard::Press(end) => band - press(end),
            JointGuard::Rest => T::constant(self.rest_band()) + T::constant(mode.turning.direction()) * velocity,
            JointGuard::BreakForward => band - self.torques_at_rest(state, mode, &phase.traces).0,
            JointGuard::BreakBackward => band + self.torques_at_rest(state, mode, &phase.traces).1,
        }
    }

    fn cross(
        &self,
        guard: JointGuard,
        time: R,
        state: &mut [R; N],
        phase: &mut JointPhase<R>,
    ) -> Result<JointEventKind, Error> {
        let kind = self.pass_guard(guard, time, state, phase)?;
        let slips = if let JointGuard::Of(i, Guard::Slip) = guard { Some(i) } else { None };
        self.follow(state, phase, slips);
        Ok(kind)
    }

    fn project(&self, _time: R, state: &mut [R; N], phase: &JointPhase<R>) {
        let lengths = self.leverage(state[ANGLE], phase.mode.arm_pieces).lengths;
        for i in 0..2 {
            if let Some(content) = phase.isothermal[i] {
                let volume = self.members[i].actuator.volume(lengths[i]);
                state[PRESSURE[i]] = content * state[PRESSURE[i] + 1] / volume;
            }
        }
    }

    fn stuck(&self, time: R, state: &[R; N], _phase: &JointPhase<R>) -> Error {
        Error::Stopped {
            time: time.value(),
            reason: "no step is short enough for the tolerance",
            quantity: "joint angle",
            value: state[ANGLE].value(),
            unit: "rad",
            remedy: "loosen run.relative_tolerance, or check that inertia, volumes and flow area are of usual size",
        }
    }
}
