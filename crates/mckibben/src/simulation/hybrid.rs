//! The rig as a hybrid system: when each formula of the actuator holds, and what follows when it ends.
//!
//! The mode of its [member](super::member), and
//!
//! | component of the mode | values | ends when |
//! |---|---|---|
//! | sliding | lengthening, shortening, stuck, held, frictionless | the velocity comes to zero; the load breaks away |
//!
//! The bristles of LuGre's law are a state behind those of the air line; they bend while the ends move. With a tendon in series
//! the load's distance is the last state ([`tendon_mode`](super::tendon_mode)).
//!
//! At rest, a tension between `F_s + F_limit − Q k_sec` and `F_s + F_limit + Q k_sec` can be held, and any from zero up
//! when the actuator rests on its shortest length. The load sticks while its pull lies between.

use super::member::{Member, Trace};
use super::mode::{EventKind, Extent, Guard, Mode, Sliding};
use super::plumbing::{FIRST, LineMode, Plumbing};
use super::rig::{Rig, State};
use super::system::{self, GuardForm, Guards, HybridSystem};
use super::tendon_mode::Tether;
use super::timetable::Progress;
use super::zones::{Places, Through};
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
use crate::error::Error;
use crate::friction::{LuGre, Rubbing};
use crate::load::{Inertia, Load};
use crate::scalar::{Differentiable, Over, Real};
use crate::valve::Openings;

pub(super) const LENGTH: usize = 0;
pub(super) const VELOCITY: usize = 1;
pub(super) const PRESSURE: usize = 2;
pub(super) const AIR_MASS: usize = 3;

type Room<const N: usize> = system::Room<N, FIRST>;

/// The mode with what its clocks remember.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase<R = f64> {
    /// Which formulas hold.
    pub mode: Mode,
    pub(super) progress: Progress<R>,
    openings: Openings<R>,
    /// `P V/m` of an isothermal process, which nothing changes.
    isothermal: Option<R>,
    line: LineMode,
    /// Whether a tendon in series hangs loose.
    pub(super) loose: bool,
    /// What the hysteresis remembers, where there is one.
    pub(super) trace: Option<Trace<R>>,
}

impl<R: Real> Phase<R> {
    /// What the valve lets through at a time in s.
    #[inline(always)]
    pub(super) fn through<T: Over<R>>(&self, time: T) -> Through<'_, T> {
        Through { mode: &self.mode, shares: self.openings.at(time), feed: None }
    }
}

/// A rig with the tolerance to which its events are told from rounding.
#[derive(Clone, Copy, Debug)]
pub struct RigSystem<'a, R: Real = f64> {
    pub(super) rig: &'a Rig<R>,
    pub(super) member: Member<'a, R>,
    plumbing: Option<Plumbing<'a, R>>,
    tether: Option<Tether<R>>,
    pub(super) inertia: Option<Inertia<R>>,
    /// `1/M`, or zero when the motion is given.
    pub(super) per_mass: R,
}

impl<'a, R: Real> RigSystem<'a, R> {
    /// A rig whose steps are controlled to `relative_tolerance`.
    pub fn new(rig: &'a Rig<R>, relative_tolerance: f64) -> Self {
        let inertia = rig.load().inertia();
        let pull = inertia.map_or(0.0, |inertia| inertia.pull.value().abs());
        let member = Member::new(rig.actuator(), relative_tolerance, pull);
        let plumbing = Plumbing::new(rig);
        let before =
            plumbing.map_or(4, |plumbing| plumbing.states) + usize::from(rig.actuator().friction().lugre().is_some());
        Self {
            rig,
            member,
            plumbing,
            tether: Tether::new(rig, before, &member),
            inertia,
            per_mass: inertia.map_or(R::zero(), |inertia| R::one() / inertia.mass),
        }
    }

    /// The rig.
    pub fn rig(&self) -> &Rig<R> {
        self.rig
    }

    /// The actuator as a member of the system.
    #[cfg(feature = "alloc")]
    pub(super) fn member(&self) -> &Member<'a, R> {
        &self.member
    }

    /// The usual size of each state: the longest length, a usual velocity, the atmosphere's pressure, the air at that.
    pub(super) fn magnitudes(&self) -> [f64; 4] {
        let Member { longest, atmosphere, air_mass, .. } = self.member;
        [longest, longest * USUAL_RATE, atmosphere, air_mass]
    }

    /// How many states the rig has with its line, its bristles and a load on a tendon.
    pub fn states(&self) -> usize {
        self.line_states() + usize::from(self.lugre().is_some()) + usize::from(self.tether.is_some())
    }

    /// The tendon in series, if there is one.
    #[inline(always)]
    pub(super) fn tether<const N: usize>(&self) -> Option<&Tether<R>> {
        if Room::<N>::BESIDE { self.tether.as_ref() } else { None }
    }

    /// How many states the rig has with its line.
    pub(super) fn line_states(&self) -> usize {
        self.plumbing.map_or(4, |plumbing| plumbing.states)
    }

    #[inline(always)]
    fn lugre(&self) -> Option<&LuGre<R>> {
        self.member.lugre()
    }

    /// Deflection in m of the bristles, if there are such.
    #[inline(always)]
    pub(super) fn bristles<T: Copy, const N: usize>(&self, state: &[T; N]) -> Option<T> {
        (Room::<N>::BESIDE && self.lugre().is_some()).then(|| state[self.line_states()])
    }

    /// LuGre's law, the deflection of its bristles, and velocity and direction of sliding, where the ends move.
    #[inline(always)]
    pub(super) fn bent<T: Over<R>, const N: usize>(
        &self,
        state: &[T; N],
        velocity: T,
        mode: &Mode,
    ) -> Option<(&LuGre<R>, [T; 3])> {
        let (law, deflection) = (self.lugre()?, self.bristles(state)?);
        Some((law, [deflection, velocity, T::constant(mode.sliding.direction())]))
    }

    /// How the threads rub.
    #[inline(always)]
    fn rubbing<T: Over<R>, const N: usize>(&self, state: &[T; N], phase: &Phase<R>) -> Rubbing<T> {
        // On a tendon the velocity is the load's; who asks then asks for rest.
        let velocity = if self.tether::<N>().is_some() { T::zero() } else { state[VELOCITY] };
        self.member.rubbing([state[LENGTH], velocity], &phase.mode, (&phase.trace, self.bristles(state)))
    }

    /// The sum of (12), before it is kept from pushing.
    #[inline(always)]
    fn signed_force<T: Over<R>, const N: usize>(&self, state: &[T; N], phase: &Phase<R>) -> T {
        self.member.signed_force_rubbing(ends(state), &phase.mode, self.rubbing(state, phase))
    }

    /// The force of the hysteresis over the secant stiffness in m, and the part of it that dissipates, in magnitude.
    #[cfg(feature = "alloc")]
    pub(super) fn widths<const N: usize>(&self, time: R, state: &[R; N], phase: &Phase<R>) -> [R; 2] {
        match self.bent(state, self.velocity(time, state, phase), &phase.mode) {
            Some((law, [bent, velocity, direction])) => {
                [law.width_at(bent, velocity, direction), law.dissipating(bent, velocity, direction)]
            }
            None => Trace::widths(&phase.trace, state[LENGTH]),
        }
    }

    /// The states at the start: the rig's four, and those of its line; zero in places that have no meaning.
    pub fn start<const N: usize>(&self, rig: State<R>) -> [R; N] {
        debug_assert!(Room::<N>::BESIDE || self.states() == 4, "{} states have no room in {N}", self.states());
        let mut state = [R::zero(); N];
        state[..4].copy_from_slice(&rig.to_array());
        if let Some(plumbing) = &self.plumbing {
            plumbing.start(&self.member, &mut state);
        }
        if let Some(tether) = self.tether::<N>() {
            self.hang(tether, &mut state);
        }
        state
    }

    /// Places of the pressures that the air depends on.
    #[inline(always)]
    pub(super) fn places(&self) -> Places {
        self.plumbing.as_ref().map_or(Places::direct(PRESSURE), Plumbing::places)
    }

    /// Enters the zones of the passages that are open.
    fn enter_ports<const N: usize>(&self, state: &[R; N], mode: &mut Mode) {
        let Places { valve, supply, .. } = self.places();
        self.member.enter_ports(state[valve], supply.map(|place| state[place]), mode);
    }

    /// The air in the actuator.
    pub(super) fn chamber<T: Over<R>, const N: usize>(&self, state: &[T; N], mode: &Mode) -> Chamber<T> {
        let slack = mode.extent == Extent::Slack;
        self.rig.actuator().chamber(state[LENGTH], state[VELOCITY], state[PRESSURE], state[AIR_MASS], slack)
    }

    /// Flow into the actuator at a time in s.
    pub(super) fn inflow<T: Over<R>, const N: usize>(&self, time: T, state: &[T; N], phase: &Phase<R>) -> Flow<T> {
        let (through, chamber) = (phase.through(time), self.chamber(state, &phase.mode));
        if let Some([_, rate]) = self.given(time, phase) {
            return self.flow_for(&chamber, rate);
        }
        match &self.plumbing {
            Some(plumbing) => plumbing.inflow(&self.member, &chamber, state, (through, &phase.line)),
            None => self.member.flow(&chamber, through),
        }
    }

    /// The same, with the rates of the line's states.
    pub(super) fn line_rates<T: Over<R>, const N: usize>(
        &self,
        time: T,
        state: &[T; N],
        phase: &Phase<R>,
        rates: &mut [T; N],
    ) -> Flow<T> {
        let (through, chamber) = (phase.through(time), self.chamber(state, &phase.mode));
        match &self.plumbing {
            Some(plumbing) => plumbing.rates(&self.member, &chamber, state, (through, &phase.line), rates),
            None => self.member.flow(&chamber, through),
        }
    }

    /// Flow between the rig with its line and the surroundings or the supply at a time in s.
    #[cfg(feature = "alloc")]
    pub(super) fn exchange<const N: usize>(&self, time: R, state: &[R; N], phase: &Phase<R>) -> Flow<R> {
        let (through, chamber) = (phase.through(time), self.chamber(state, &phase.mode));
        if let Some([_, rate]) = self.given(time, phase) {
            return self.flow_for(&chamber, rate);
        }
        match &self.plumbing {
            Some(plumbing) => plumbing.exchange(&self.member, &chamber, state, through),
            None => self.member.flow(&chamber, through),
        }
    }

    /// Flows through the valve's passages to the supply and to the surroundings, into hose or actuator, at a time in s. What flows out to a
    /// pressure regulator it lets go to the surroundings.
    #[cfg(feature = "alloc")]
    pub(super) fn valve_flows<const N: usize>(&self, time: R, state: &[R; N], phase: &Phase<R>) -> [Flow<R>; 2] {
        let (mode, through) = (&phase.mode, phase.through(time));
        let chamber = self.chamber(state, mode);
        match &self.plumbing {
            Some(plumbing) => {
                let flows = plumbing.passages(&self.member, &chamber, state, through);
                if self.rig.regulator().is_none() {
                    return flows;
                }
                let [Flow { inward, outward }, _] = flows;
                [Flow { inward, outward: R::zero() }, Flow { inward: R::zero(), outward }]
            }
            None => {
                let only = |supply: bool, exhaust: bool| Mode {
                    supply_zone: mode.supply_zone.filter(|_| supply),
                    exhaust_zone: mode.exhaust_zone.filter(|_| exhaust),
                    ..*mode
                };
                [only(true, false), only(false, true)]
                    .map(|one| self.member.flow(&chamber, Through { mode: &one, ..through }))
            }
        }
    }

    /// Content of the hose in kg.
    #[cfg(feature = "alloc")]
    pub(super) fn hose_content<const N: usize>(&self, state: &[R; N]) -> R {
        self.plumbing.as_ref().map_or(R::zero(), |plumbing| plumbing.content(state))
    }

    /// The phase at t = 0 in a state.
    pub fn begin<const N: usize>(&self, state: &[R; N]) -> Phase<R> {
        self.enter(R::zero(), state, Progress::none())
    }

    /// The phase in a state that is set anew at a time in s: only valve and command go on as they were.
    #[cfg(feature = "alloc")]
    pub(super) fn resume<const N: usize>(&self, time: R, state: &[R; N], before: &Phase<R>) -> Phase<R> {
        self.enter(time, state, before.progress)
    }

    fn enter<const N: usize>(&self, time: R, state: &[R; N], mut progress: Progress<R>) -> Phase<R> {
        let ports = self.rig.timetable().pass(&mut progress, time);
        let mode = Mode {
            ports,
            supply_zone: None,
            exhaust_zone: None,
            effectiveness_piece: self.member.effectiveness_piece(state[PRESSURE]),
            pressed: self.member.pressed(state[PRESSURE]),
            force_piece: self.member.force_piece(state[LENGTH], state[PRESSURE]),
            extent: Extent::Free,
            sliding: Sliding::Held,
            clamped: false,
        };
        let mut phase = Phase {
            mode,
            progress,
            openings: self.rig.timetable().openings(&progress),
            isothermal: self.member.isothermal_content(state[LENGTH], [state[PRESSURE], state[AIR_MASS]]),
            line: LineMode::AT_REST,
            loose: false,
            trace: self.member.trace(self.rig.actuator().limits().actuator_length(state[LENGTH])),
        };
        self.enter_ports(state, &mut phase.mode);
        if let Some(plumbing) = &self.plumbing {
            phase.line = plumbing.enter(&self.member, state, phase.through(time));
            plumbing.pass_set_points(time, state, &mut phase.line);
        }
        if let Some(tether) = self.tether::<N>() {
            self.begin_tethered(tether, time, state, &mut phase);
        } else {
            self.enter_extent(state, &mut phase.mode);
            self.enter_sliding(time, state, &mut phase);
        }
        self.follow(state, &mut phase, false);
        phase
    }

    /// Tension in N in a mode: what the load feels.
    #[inline(always)]
    pub fn tension<T: Over<R>, const N: usize>(&self, state: &[T; N], phase: &Phase<R>) -> T {
        let mode = &phase.mode;
        if let Some(tension) = self.tethered_tension(state, phase) {
            return tension;
        }
        if mode.sliding == Sliding::Stuck {
            return self.inertia.map_or(T::zero(), |inertia| T::of(inertia.pull));
        }
        if mode.extent == Extent::Slack || mode.clamped {
            return T::zero();
        }
        self.signed_force(state, phase)
    }

    /// The least and the largest tension in N that can be held at rest.
    pub(super) fn holdable<T: Over<R>, const N: usize>(&self, state: &[T; N], phase: &Phase<R>) -> (T, T) {
        self.rig.holdable(state[LENGTH], state[PRESSURE], self.rubbing(state, phase))
    }

    /// Takes the memory of the hysteresis on to a state, and to the branch that follows.
    pub(super) fn follow<const N: usize>(&self, state: &[R; N], phase: &mut Phase<R>, slips: bool) {
        if phase.trace.is_some() {
            let length = self.rig.actuator().limits().actuator_length(state[LENGTH]);
            self.member.follow(&mut phase.trace, length, phase.mode.sliding, slips);
        }
    }

    /// The extent of a state that may lie on a limit: then the velocity, or at rest the balance, decides.
    fn enter_extent<const N: usize>(&self, state: &[R; N], mode: &mut Mode) {
        let limits = self.rig.actuator().limits();
        let [length, velocity] = [state[LENGTH], state[VELOCITY]];
        let above = [limits.min_length(), limits.max_length()].map(|limit| length.value() - limit.value());
        let pushed_up = self.inertia.is_some_and(|inertia| inertia.pull.value() < 0.0);
        mode.extent = self.member.extent_at([length, velocity], above, pushed_up);
    }

    /// The direction of sliding in a state that may be at rest, and whether the force is clamped.
    fn enter_sliding<const N: usize>(&self, time: R, state: &[R; N], phase: &mut Phase<R>) {
        let velocity = state[VELOCITY].value();
        phase.mode.sliding = match (self.rig.load(), self.inertia) {
            (Load::Isometric, _) => Sliding::Held,
            (Load::Prescribed(motion), _) => {
                let [_, velocity, acceleration] = motion.at::<R>(time, phase.progress.corners_passed).map(Real::value);
                let heading = if velocity == 0.0 { acceleration } else { velocity };
                if heading == 0.0 { Sliding::Held } else { self.rig.sliding(heading) }
            }
            (_, Some(inertia)) if velocity == 0.0 => self.rest_or_slide(inertia, state, phase),
            _ => self.rig.sliding(velocity),
        };
        self.enter_clamp(state, phase);
    }

    /// From rest: stick if the load can be held, else slide the way it pulls.
    fn rest_or_slide<const N: usize>(&self, inertia: Inertia<R>, state: &[R; N], phase: &mut Phase<R>) -> Sliding {
        let actuator = self.rig.actuator();
        let on_the_stop = state[LENGTH].value() == actuator.limits().min_length().value();
        if phase.mode.extent == Extent::Slack || !(actuator.friction().has_direction() || on_the_stop) {
            return self.rig.sliding(inertia.pull.value());
        }
        let (least, most) = self.holdable(state, phase);
        let (least, most, pull) = (least.value(), most.value(), inertia.pull.value());
        if !(actuator.friction().has_coulomb() || on_the_stop) {
            // Without dry friction it does not stick: it goes the way of the balance, however small.
            return self.rig.sliding(pull - most);
        }
        if pull > most + self.member.force_band {
            self.rig.sliding(1.0)
        } else if pull < least - self.member.force_band {
            if on_the_stop {
                phase.mode.extent = Extent::Slack;
            }
            self.rig.sliding(-1.0)
        } else {
            Sliding::Stuck
        }
    }

    fn enter_clamp<const N: usize>(&self, state: &[R; N], phase: &mut Phase<R>) {
        let moves = phase.mode.extent != Extent::Slack && phase.mode.sliding != Sliding::Stuck;
        phase.mode.clamped = moves && self.signed_force(state, phase).value() < 0.0;
    }

    /// Whether the load, arriving at the shortest length, comes to rest there: it can be held, and it would bounce less
    /// than the tolerance of its length.
    fn rests_on_the_stop<const N: usize>(&self, state: &[R; N], phase: &Phase<R>) -> bool {
        let Some(inertia) = self.inertia else { return false };
        let (pull, mass) = (inertia.pull.value(), inertia.mass.value());
        let most = self.holdable(state, phase).1.value();
        let acceleration = pull.min(most - pull) / mass;
        let velocity = state[VELOCITY].value();
        acceleration > 0.0 && velocity * velocity <= 2.0 * acceleration * self.member.band * self.member.longest
    }
}

/// Velocity scale: one length a second.
const USUAL_RATE: f64 = 1.0;
/// The part of that scale below which an error in velocity counts absolutely.
const SLOW: f64 = 0.1;

/// Length, velocity and pressure of a state.
#[inline(always)]
fn ends<T: Copy, const N: usize>(state: &[T; N]) -> [T; 3] {
    [state[LENGTH], state[VELOCITY], state[PRESSURE]]
}

impl<R: Real, const N: usize> HybridSystem<R, N> for RigSystem<'_, R> {
    type Mode = Phase<R>;
    type Guard = Guard;
    type Kind = EventKind;

    #[inline(always)]
    fn states(&self) -> usize {
        if Room::<N>::BESIDE { RigSystem::states(self) } else { N }
    }

    #[inline(always)]
    fn rates<T: Differentiable<R>>(&self, time: T, state: &[T; N], phase: &Phase<R>) -> [T; N] {
        if let Some(tether) = self.tether::<N>() {
            return self.tethered_rates(tether, time, state, phase);
        }
        let (mode, through) = (&phase.mode, phase.through(time));
        let mut ends = [state[LENGTH], state[VELOCITY], T::zero()];
        match self.rig.load() {
            Load::Prescribed(motion) => ends = motion.at(time, phase.progress.corners_passed),
            Load::Isometric => ends[1] = T::zero(),
            _ if mode.sliding == Sliding::Stuck => ends[1] = T::zero(),
            _ => {
                if let Some(inertia) = self.inertia {
                    ends[2] = (T::of(inertia.pull) - self.tension(state, phase)) * T::of(self.per_mass);
                }
            }
        }
        let [length, velocity, acceleration] = ends;
        let air = [length, velocity, state[PRESSURE], state[AIR_MASS]];
        let mut rates = [T::zero(); N];
        (rates[LENGTH], rates[VELOCITY]) = (velocity, acceleration);
        if mode.extent != Extent::Slack
            && let Some((law, [bent, velocity, direction])) = self.bent(state, velocity, mode)
        {
            rates[self.line_states()] = law.rate(bent, velocity, direction);
        }
        [rates[PRESSURE], rates[AIR_MASS]] = if let Some([_, rate]) = self.given(time, phase) {
            let slack = mode.extent == Extent::Slack;
            let chamber = self.rig.actuator().chamber(length, velocity, state[PRESSURE], state[AIR_MASS], slack);
            [rate, self.flow_for(&chamber, rate).net()]
        } else if Room::<N>::BESIDE
            && let Some(plumbing) = &self.plumbing
        {
            let [length, velocity, pressure, mass] = air;
            let actuator = self.rig.actuator();
            let chamber = actuator.chamber(length, velocity, pressure, mass, mode.extent == Extent::Slack);
            let inflow = plumbing.rates(&self.member, &chamber, state, (through, &phase.line), &mut rates);
            [actuator.pressure_rate(&chamber, &inflow), inflow.net()]
        } else {
            self.member.air_rates(air, through)
        };
        rates
    }

    fn settling_rate(&self, time: R, state: &[R; N], phase: &Phase<R>) -> f64 {
        let seeded_at = |place: usize, value: Dual<R, 1>| {
            let mut seeded = state.map(Dual::<R, 1>::of);
            seeded[place] = value;
            self.rates(Dual::of(time), &seeded, phase)
        };
        let Places { valve, supply, .. } = self.places();
        let supply = supply.map(|place| state[place]);
        let rate = |pressure| seeded_at(valve, pressure)[valve];
        let settling = self.member.pressure_settling_rate(state[valve], supply, &phase.mode, rate);
        let mut fastest = (self.member.damping(&phase.mode) * self.per_mass.value()).max(settling);
        let settles = |place: usize| -seeded_at(place, Dual::variable(state[place], 0))[place].slope[0].value();
        if self.bristles(state).is_some() {
            fastest = fastest.max(settles(self.line_states())).max(settles(VELOCITY));
        }
        if self.tether::<N>().is_some() {
            fastest = settling.max(settles(LENGTH));
        }
        if Room::<N>::BESIDE
            && let Some(plumbing) = &self.plumbing
        {
            let rates = |place| seeded_at(place, Dual::variable(state[place], 0));
            return fastest.max(plumbing.settling_rate(state, &phase.line, rates));
        }
        fastest
    }

    fn scales(&self, state: &[R; N], phase: &Phase<R>) -> [f64; N] {
        let Member { longest, atmosphere, air_mass, taut_scale, .. } = self.member;
        let [length, velocity, pressure, mass] =
            [LENGTH, VELOCITY, PRESSURE, AIR_MASS].map(|place| state[place].value().abs());
        // On the taut braid a length counts by the force that an error in it makes.
        let length = match phase.mode.extent {
            Extent::Taut | Extent::Rebound => taut_scale,
            Extent::Slack | Extent::Free => length.max(longest),
        };
        // What has no meaning never errs.
        let mut scales = [1.0; N];
        scales[..4].copy_from_slice(&[
            length,
            velocity + self.slow(),
            pressure + 0.1 * atmosphere,
            mass + 0.1 * air_mass,
        ]);
        if Room::<N>::BESIDE
            && let Some(plumbing) = &self.plumbing
        {
            plumbing.scales(&self.member, state, &mut scales);
        }
        if let (Some(bent), Some(law)) = (self.bristles(state), self.lugre()) {
            scales[self.line_states()] = bent.value().abs() + law.reach().value();
        }
        if let Some(tether) = self.tether::<N>() {
            tether.scales(&mut scales);
        }
        scales
    }

    fn next_instant(&self, phase: &Phase<R>, until: R) -> Option<R> {
        let instant = self.rig.timetable().next(&phase.progress, until);
        let set_point = self.plumbing.as_ref().and_then(|plumbing| plumbing.next_set_point(&phase.line, until));
        [instant, set_point].into_iter().flatten().min_by(|a, b| a.value().total_cmp(&b.value()))
    }

    fn pass_instant(&self, time: R, state: &mut [R; N], phase: &mut Phase<R>) -> Result<EventKind, Error> {
        let kind = self.pass_due(time, state, phase);
        if let Some(tether) = self.tether::<N>() {
            self.settle_end(tether, time, state, phase);
        }
        Ok(kind)
    }

    fn guards(&self, phase: &Phase<R>) -> Guards<Guard> {
        let mode = &phase.mode;
        let mut guards = Guards::new();
        if self.tether::<N>().is_some() {
            self.tethered_guards(phase, &mut guards);
            self.member.piece_guards(mode, self.places(), &mut |guard, form| guards.add(guard, form));
            if let Some(plumbing) = &self.plumbing {
                plumbing.guards(&phase.line, &mut guards);
            }
            return guards;
        }
        let above = |index, bound: R| GuardForm::Above { index, bound: bound.value() };
        let below = |index, bound: R| GuardForm::Below { index, bound: bound.value() };
        let moves = !matches!(self.rig.load(), Load::Isometric) && mode.sliding != Sliding::Stuck;
        if moves {
            let (by_length, by_force) = self.member.extent_guards(mode.extent);
            for (guard, bound, lasts_above) in by_length.into_iter().flatten() {
                guards.add(guard, if lasts_above { above(LENGTH, bound) } else { below(LENGTH, bound) });
            }
            if let Some(guard) = by_force {
                guards.add(guard, GuardForm::Function);
            }
        }
        match mode.sliding {
            Sliding::Lengthening if mode.extent != Extent::Slack => {
                guards.add(Guard::Rest, above(VELOCITY, R::constant(-self.rest_band())))
            }
            Sliding::Shortening if mode.extent != Extent::Slack => {
                guards.add(Guard::Rest, below(VELOCITY, R::constant(self.rest_band())))
            }
            Sliding::Stuck => {
                guards.add(Guard::BreakLonger, GuardForm::Function);
                guards.add(Guard::BreakShorter, GuardForm::Function);
            }
            _ => {}
        }
        if mode.extent != Extent::Slack
            && let Some((end, lasts_above)) = phase.trace.as_ref().and_then(Trace::end)
        {
            guards.add(Guard::Slip, if lasts_above { above(LENGTH, end) } else { below(LENGTH, end) });
        }
        let mut add = |guard, form| guards.add(guard, form);
        self.member.each_other_guard(mode, self.places(), &mut add);
        if let Some(plumbing) = &self.plumbing {
            plumbing.guards(&phase.line, &mut guards);
        }
        guards
    }

    fn guard<T: Differentiable<R>>(&self, guard: Guard, time: T, state: &[T; N], phase: &Phase<R>) -> T {
        let mode = &phase.mode;
        if let Some(tether) = self.tether::<N>()
            && let Some(value) = self.tethered_guard(tether, (guard, time), state, phase)
        {
            return value;
        }
        let [length, velocity, _] = ends(state);
        if Room::<N>::BESIDE
            && let Some(plumbing) = &self.plumbing
        {
            if matches!(guard, Guard::ExhaustDown | Guard::ExhaustUp) {
                let ends = [length, velocity, state[plumbing.places().valve]];
                return self.member.guard(guard, ends, mode, (&phase.trace, None));
            }
            if let Some(value) = plumbing.guard(guard, &self.member, state, (phase.through(time), &phase.line)) {
                return value;
            }
        }
        let band = T::constant(self.member.force_band);
        let pull = || self.inertia.map_or(T::zero(), |inertia| T::of(inertia.pull));
        match guard {
            Guard::Rest if mode.sliding == Sliding::Shortening => T::constant(self.rest_band()) - velocity,
            Guard::Rest => T::constant(self.rest_band()) + velocity,
            Guard::BreakLonger => self.holdable(state, phase).1 + band - pull(),
            Guard::BreakShorter => pull() - self.holdable(state, phase).0 + band,
            Guard::TensionZero => self.signed_force(state, phase) + band,
            Guard::TensionBack => band - self.signed_force(state, phase),
            _ => self.member.guard(guard, ends(state), mode, (&phase.trace, None)),
        }
    }

    fn cross(&self, guard: Guard, time: R, state: &mut [R; N], phase: &mut Phase<R>) -> Result<EventKind, Error> {
        let of_tether = match self.tether::<N>() {
            Some(_) => self.cross_tethered((guard, time), state, phase)?,
            None => None,
        };
        let kind = match of_tether {
            Some(kind) => kind,
            None => self.pass_guard(guard, time, state, phase)?,
        };
        self.follow(state, phase, guard == Guard::Slip);
        if let Some(tether) = self.tether::<N>() {
            self.settle_end(tether, time, state, phase);
        }
        Ok(kind)
    }

    fn project(&self, time: R, state: &mut [R; N], phase: &Phase<R>) {
        if let Load::Prescribed(motion) = self.rig.load() {
            let [length, velocity, _] = motion.at(time, phase.progress.corners_passed);
            (state[LENGTH], state[VELOCITY]) = (length, velocity);
        }
        if let Some(tether) = self.tether::<N>() {
            self.keep_balance(tether, state, phase);
        }
        if let Some([gauge, _]) = self.given(time, phase) {
            state[PRESSURE] = gauge + self.rig.actuator().air().atmosphere().0;
            if let Some(content) = phase.isothermal {
                state[AIR_MASS] = state[PRESSURE] * self.rig.actuator().volume(state[LENGTH]) / content;
            }
        } else if let Some(content) = phase.isothermal {
            state[PRESSURE] = content * state[AIR_MASS] / self.rig.actuator().volume(state[LENGTH]);
        }
    }

    fn stuck(&self, time: R, state: &[R; N], _phase: &Phase<R>) -> Error {
        Error::Stopped {
            time: time.value(),
            reason: "no step is short enough for the tolerance",
            quantity: "absolute pressure",
            value: state[PRESSURE].value(),
            unit: "Pa",
            remedy: "loosen run.relative_tolerance, or check that masses, volumes and flow area are of usual size",
        }
    }
}

impl<R: Real> RigSystem<'_, R> {
    /// Passes what is due at an instant.
    fn pass_due<const N: usize>(&self, time: R, state: &mut [R; N], phase: &mut Phase<R>) -> EventKind {
        let (timetable, counted) = (self.rig.timetable(), phase.progress.openings_counted());
        let ports = timetable.pass_seats(&mut phase.progress, time);
        if ports != phase.mode.ports || phase.progress.openings_counted() != counted {
            phase.openings = timetable.openings(&phase.progress);
            if ports != phase.mode.ports {
                phase.mode.ports = ports;
                self.enter_ports(state, &mut phase.mode);
            }
            if let Some(plumbing) = &self.plumbing {
                let through = Through { mode: &phase.mode, shares: phase.openings.at(time), feed: None };
                plumbing.pass_seats(&self.member, state, through, &mut phase.line);
            }
            return EventKind::Valve;
        }
        if let Some(plumbing) = &self.plumbing
            && plumbing.pass_set_points(time, state, &mut phase.line)
        {
            return EventKind::SetPoint;
        }
        if timetable.pass_row(&mut phase.progress, time) {
            self.project(time, state, phase);
            return EventKind::Corner;
        }
        phase.progress.corners_passed += 1;
        self.project(time, state, phase);
        self.enter_extent(state, &mut phase.mode);
        self.enter_sliding(time, state, phase);
        self.follow(state, phase, false);
        EventKind::Corner
    }

    /// What follows when a guard has come down through zero; the memory of the hysteresis is taken on after it.
    fn pass_guard<const N: usize>(
        &self,
        guard: Guard,
        time: R,
        state: &mut [R; N],
        phase: &mut Phase<R>,
    ) -> Result<EventKind, Error> {
        let limits = self.rig.actuator().limits();
        let inertial = self.inertia.is_some();
        match guard {
            Guard::ThreadLength => Err(Error::Stopped {
                time: time.value(),
                reason: "the load pulled the braid straight",
                quantity: "length",
                value: state[LENGTH].value(),
                unit: "m",
                remedy: "lighten the load or stiffen actuator.limit.stiffness",
            }),
            Guard::Slack | Guard::Tight => {
                if inertial {
                    state[LENGTH] = limits.min_length();
                }
                if self.rests_on_the_stop(state, phase) {
                    state[VELOCITY] = R::zero();
                    phase.mode.extent = Extent::Free;
                    phase.mode.sliding = Sliding::Stuck;
                    phase.mode.clamped = false;
                    return Ok(EventKind::Stick);
                }
                let slack = guard == Guard::Slack;
                phase.mode.extent = if slack { Extent::Slack } else { Extent::Free };
                self.enter_sliding(time, state, phase);
                Ok(if slack { EventKind::Slack } else { EventKind::Tight })
            }
            Guard::Taut | Guard::Untaut => {
                if inertial {
                    state[LENGTH] = limits.max_length();
                }
                let taut = guard == Guard::Taut;
                phase.mode.extent = if taut { Extent::Taut } else { Extent::Free };
                self.enter_clamp(state, phase);
                Ok(if taut { EventKind::Taut } else { EventKind::Untaut })
            }
            Guard::Rest => {
                if inertial {
                    state[VELOCITY] = R::zero();
                }
                Ok(self.turn(state, phase))
            }
            Guard::BreakLonger | Guard::BreakShorter => {
                phase.mode.sliding = self.rig.sliding(if guard == Guard::BreakLonger { 1.0 } else { -1.0 });
                if guard == Guard::BreakShorter && state[LENGTH].value() <= limits.min_length().value() {
                    phase.mode.extent = Extent::Slack;
                }
                self.enter_clamp(state, phase);
                Ok(EventKind::BreakAway)
            }
            Guard::Slip => Ok(EventKind::Slip),
            _ => Member::<R>::cross(guard, &mut phase.mode)
                .or_else(|| Plumbing::<R>::cross(guard, &mut phase.line))
                .ok_or_else(|| self.stuck(time, state, phase)),
        }
    }

    /// The velocity in m/s by which zero must be passed before it is a turn: what a few steps may err.
    pub(super) fn rest_band(&self) -> f64 {
        10.0 * self.member.band * self.slow()
    }

    /// The velocity in m/s below which its error counts absolutely.
    fn slow(&self) -> f64 {
        SLOW * self.magnitudes()[VELOCITY]
    }

    /// The velocity has come to zero: stick, or go the other way.
    fn turn<const N: usize>(&self, state: &[R; N], phase: &mut Phase<R>) -> EventKind {
        phase.mode.sliding = match self.inertia {
            Some(inertia) => self.rest_or_slide(inertia, state, phase),
            None => self.rig.sliding(-phase.mode.sliding.direction()),
        };
        self.enter_clamp(state, phase);
        if phase.mode.sliding == Sliding::Stuck { EventKind::Stick } else { EventKind::Reversal }
    }
}
