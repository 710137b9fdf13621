//! A tendon in series as a part of the hybrid system: where the actuator's end goes, and how it slides.
//!
//! ```text
//! M ẍ = W − T          T = k max(0, x − ℓ − L)          F(L, L̇, P) = T
//!
//! with viscous friction      L̇ by F(L, L̇, P) = T
//! without                    L̇ by ∂F/∂L L̇ + ∂F/∂P Ṗ(L̇) = k (ẋ − L̇), and L kept to F(L, P) = T
//! ```
//!
//! Nothing has a mass between actuator and tendon, so that the actuator's length is a state whose rate follows from the balance
//! of both tensions; the load's distance and velocity are states too. Without viscous friction the balance holds the length
//! itself: its rate is that by which the balance stays, and every state that is kept is brought back to it by Newton's step, with
//! the air sealed. Bristles of LuGre's law count with their rate.
//!
//! | component of the mode | values | ends when |
//! |---|---|---|
//! | sliding | lengthening, shortening, stuck, frictionless | the rate comes to zero; the tension leaves what can be held |
//! | loose | yes, no | the stretch passes zero |
//! | extent | free, taut, rebound | as of a rig; on its shortest length the actuator sticks and bears any tension |
//!
//! Dry friction that falls with velocity faster than viscous friction grows has no balance at some tensions: an end without a
//! mass would jump there, and the run stops. Without viscous friction there is none at any, which is refused beforehand.
//!
//! Checked by `tests/tendon_rig.rs` and `tests/tendon_located.rs`.

use super::hybrid::{AIR_MASS, LENGTH, PRESSURE, Phase, RigSystem, VELOCITY};
use super::member::Member;
use super::mode::{EventKind, Extent, Guard, Mode, Sliding};
use super::rig::{Rig, State};
use super::system::{GuardForm, Guards};
use crate::air::Flow;
use crate::dual::Dual;
use crate::error::{Error, Requirement};
use crate::friction::Rubbing;
use crate::load::SeriesTendon;
use crate::parameter;
use crate::scalar::{Differentiable, Over, Real};

/// Part of the stretch under the usual force by which lengths are measured.
const TENSE: f64 = 0.5;
/// A velocity in m/s at which no force falls any more.
const FAST: f64 = 1e6;
/// Steps of Newton's in search of a velocity, and the part of it to which it is found.
const MOST_SEARCHED: u32 = 100;
const SEARCHED: f64 = 1e-9;
/// Viscous force in widths of a border above which the end has jumped.
const JUMP: f64 = 1e3;

/// The tendon and the place of the load's distance among the states.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tether<R> {
    tendon: SeriesTendon<R>,
    /// Place of the load's distance; its velocity stands where a rig has that of the length.
    pub(super) distance: usize,
    /// Scale in m of the length and the distance.
    scale: f64,
}

impl<R: Real> Rig<R> {
    /// That the event-located engine can take the rig's tendon, if there is one, from a start on.
    ///
    /// # Errors
    /// [`Error::Inconsistent`] below the shortest length; [`Error::NotImplemented`] for friction that depends on the velocity
    /// without viscous friction.
    pub fn check_located(&self, start: &State<R>) -> Result<(), Error> {
        if self.tendon().is_none() {
            return Ok(());
        }
        let (friction, shortest) = (self.actuator().friction(), self.actuator().limits().min_length().value());
        if start.length.value() < shortest {
            return Err(Error::Inconsistent {
                parameter: &parameter::INITIAL_LENGTH,
                value: start.length.value(),
                requirement: Requirement {
                    relation: "must be at least",
                    other: parameter::MIN_LENGTH.key,
                    value: shortest,
                    unit: parameter::MIN_LENGTH.unit,
                },
                remedy: "start longer: with a tendon in series it is the tendon that hangs loose, and not the actuator",
            });
        }
        let falls = friction.coulomb().falls() || friction.lugre().is_some_and(|law| law.is_damped());
        if friction.viscous().value() == 0.0 && falls {
            return Err(Error::Misuse {
                what: "the event-located engine takes friction that depends on the velocity in series with a tendon only \
                       beside viscous friction: without, an end that has no mass would jump",
                remedy: "give actuator.friction.viscous, set static_ratio = 1 or damping_time = 0, or set run.engine = \"fixed-step\"",
            });
        }
        Ok(())
    }
}

impl<R: Real> Tether<R> {
    /// The tendon of a rig, if it has one, with a usual force in N.
    pub(super) fn new(rig: &Rig<R>, distance: usize, member: &Member<'_, R>) -> Option<Self> {
        let (tendon, force) = (*rig.tendon()?, member.force_band / member.band);
        Some(Self { tendon, distance, scale: (TENSE * force / tendon.stiffness().value()).min(member.longest) })
    }

    /// The distance in m between both ends without the actuator.
    fn stretched<T: Over<R>, const N: usize>(&self, state: &[T; N]) -> T {
        state[self.distance] - state[LENGTH]
    }

    /// Tension in N; in a mode that has it tight also below zero.
    fn tension<T: Over<R>, const N: usize>(&self, state: &[T; N], phase: &Phase<R>) -> T {
        if phase.loose {
            return T::zero();
        }
        T::of(self.tendon.stiffness()) * (self.stretched(state) - T::of(self.tendon.rest_length()))
    }

    /// The distance in m at a length and a tension.
    pub(super) fn distance_at(&self, length: R, tension: R) -> R {
        length + self.tendon.rest_length() + tension / self.tendon.stiffness()
    }

    pub(super) fn scales<const N: usize>(&self, scales: &mut [f64; N]) {
        scales[LENGTH] = scales[LENGTH].min(self.scale);
        scales[self.distance] = scales[LENGTH];
    }
}

/// Whether the velocity follows from the balance at once.
fn is_damped<R: Real>(rig: &Rig<R>, mode: &Mode) -> bool {
    let taut = mode.extent == Extent::Taut && rig.actuator().limits().damping().value() > 0.0;
    taut || rig.actuator().friction().viscous().value() > 0.0
}

impl<R: Real> RigSystem<'_, R> {
    /// Tension in N of a tendon in series, if there is one.
    #[inline(always)]
    pub(super) fn tethered_tension<T: Over<R>, const N: usize>(&self, state: &[T; N], phase: &Phase<R>) -> Option<T> {
        Some(self.tether::<N>()?.tension(state, phase))
    }

    /// The length's rate in m/s.
    pub(super) fn velocity<const N: usize>(&self, time: R, state: &[R; N], phase: &Phase<R>) -> R {
        match self.tether::<N>() {
            Some(tether) => self.end_velocity(tether, state, phase, &self.inflow(time, state, phase)),
            None => state[VELOCITY],
        }
    }

    /// Distance (m) and velocity (m/s) of the load on a tendon.
    #[cfg(feature = "alloc")]
    pub(super) fn far_end<const N: usize>(&self, state: &[R; N]) -> Option<[R; 2]> {
        Some([state[self.tether::<N>()?.distance], state[VELOCITY]])
    }

    /// The rates of all states.
    pub(super) fn tethered_rates<T: Differentiable<R>, const N: usize>(
        &self,
        tether: &Tether<R>,
        time: T,
        state: &[T; N],
        phase: &Phase<R>,
    ) -> [T; N] {
        let mut rates = [T::zero(); N];
        let inflow = self.line_rates(time, state, phase, &mut rates);
        let velocity = self.end_velocity(tether, state, phase, &inflow);
        rates[LENGTH] = velocity;
        if let Some(inertia) = self.inertia {
            rates[VELOCITY] = (T::of(inertia.pull) - tether.tension(state, phase)) * T::of(self.per_mass);
            rates[tether.distance] = state[VELOCITY];
        }
        if let Some((law, [bent, velocity, direction])) = self.bent(state, velocity, &phase.mode) {
            rates[self.line_states()] = law.rate(bent, velocity, direction);
        }
        rates[PRESSURE] = self.air_rate(state, velocity, &inflow);
        rates[AIR_MASS] = inflow.net();
        rates
    }

    /// `dP/dt` in Pa/s while the length changes at a velocity in m/s.
    fn air_rate<T: Over<R>, const N: usize>(&self, state: &[T; N], velocity: T, inflow: &Flow<T>) -> T {
        let actuator = self.rig.actuator();
        let chamber = actuator.chamber(state[LENGTH], velocity, state[PRESSURE], state[AIR_MASS], false);
        actuator.pressure_rate(&chamber, inflow)
    }

    /// The actuator's force in N at a length, velocity and pressure, with its bristles bent so far.
    fn pull<T: Over<R>>(&self, ends: [T; 3], bent: Option<T>, phase: &Phase<R>) -> T {
        self.member.signed_force(ends, &phase.mode, (&phase.trace, bent))
    }

    /// The actuator's force less the tendon's in N, as the end begins to slide.
    fn excess<T: Over<R>, const N: usize>(&self, tether: &Tether<R>, state: &[T; N], phase: &Phase<R>) -> T {
        let ends = [state[LENGTH], T::zero(), state[PRESSURE]];
        self.pull(ends, self.bristles(state), phase) - tether.tension(state, phase)
    }

    /// The rate L̇ in m/s of the actuator's length.
    fn end_velocity<T: Differentiable<R>, const N: usize>(
        &self,
        tether: &Tether<R>,
        state: &[T; N],
        phase: &Phase<R>,
        inflow: &Flow<T>,
    ) -> T {
        match phase.mode.sliding {
            Sliding::Stuck => T::zero(),
            _ if is_damped(self.rig, &phase.mode) => self.damped_velocity(tether, state, phase),
            _ => self.kept_velocity(tether, state, phase, inflow),
        }
    }

    /// The rate at which both tensions are equal.
    fn damped_velocity<T: Differentiable<R>, const N: usize>(
        &self,
        tether: &Tether<R>,
        state: &[T; N],
        phase: &Phase<R>,
    ) -> T {
        let tension = tether.tension(state, phase);
        let [length, pressure] = [LENGTH, PRESSURE].map(|place| state[place].along(T::zero()));
        let bent = self.bristles(state).map(|bent| bent.along(T::zero()));
        let at = |velocity: T| {
            let [force, slope] = T::split(self.pull([length, velocity.along(T::one()), pressure], bent, phase));
            [force - tension, slope]
        };
        let from_zero = || {
            let [value, slope] = at(T::zero());
            -value / slope
        };
        let friction = self.rig.actuator().friction();
        if !friction.coulomb().falls() && friction.lugre().is_none_or(|law| !law.falls()) {
            return from_zero();
        }
        // Above its solution the force rises to a straight line; zero lies below, as the end slides.
        let direction = phase.mode.sliding.direction();
        let fast = T::constant(direction * FAST);
        let [value, slope] = at(fast);
        let mut most = fast - value / slope;
        let sign = T::constant(direction);
        if (sign * most).le(T::zero()) || T::zero().le(sign * at(T::zero())[0]) {
            return from_zero();
        }
        let (mut least, mut velocity) = (T::zero(), most);
        let mut left = None;
        for _ in 0..MOST_SEARCHED {
            let [value, slope] = at(velocity);
            let below = (sign * value).lt(T::zero());
            least = T::select(below, velocity, least);
            most = T::select(below, most, velocity);
            let next = velocity - value / slope;
            let within = (sign * least).le(sign * next) & (sign * next).le(sign * most);
            let next = T::select(within, next, T::constant(0.5) * (least + most));
            let found = (next - velocity).magnitude().le(T::constant(SEARCHED) * next.magnitude());
            velocity = next;
            // Each step more carries one derivative more.
            left = match left {
                None if found => Some(2),
                Some(0) => break,
                Some(steps) => Some(steps - 1),
                None => None,
            };
        }
        velocity
    }

    /// The rate at which both tensions stay equal.
    fn kept_velocity<T: Differentiable<R>, const N: usize>(
        &self,
        tether: &Tether<R>,
        state: &[T; N],
        phase: &Phase<R>,
        inflow: &Flow<T>,
    ) -> T {
        let direction = T::constant(phase.mode.sliding.direction());
        let lugre = self.rig.actuator().friction().lugre().zip(self.bristles(state));
        let stiffness = if phase.loose { T::zero() } else { T::of(tether.tendon.stiffness()) };
        let grows = |velocity: T| {
            let length = state[LENGTH].along(velocity);
            let pressure = state[PRESSURE].along(self.air_rate(state, velocity, inflow));
            let bent = lugre.map(|(law, bent)| bent.along(law.rate(bent, velocity, direction)));
            let [_, rate] = T::split(self.pull([length, T::zero().along(T::zero()), pressure], bent, phase));
            rate - stiffness * (state[VELOCITY] - velocity)
        };
        let at_rest = grows(T::zero());
        let slope = grows(T::one()) - at_rest;
        let mut velocity = -at_rest / slope;
        if lugre.is_some_and(|(law, _)| law.falls()) {
            for _ in 0..MOST_SEARCHED {
                let step = grows(velocity) / slope;
                velocity = velocity - step;
                if step.magnitude().le(T::constant(SEARCHED * SEARCHED)) {
                    break;
                }
            }
        }
        velocity
    }

    /// Brings a length to where both tensions are equal, with the air sealed, where nothing but the balance holds it.
    pub(super) fn keep_balance<const N: usize>(&self, tether: &Tether<R>, state: &mut [R; N], phase: &Phase<R>) {
        if phase.mode.sliding == Sliding::Stuck || is_damped(self.rig, &phase.mode) {
            return;
        }
        let sealed = Flow::none();
        let per_length = self.air_rate(state, R::one(), &sealed) - self.air_rate(state, R::zero(), &sealed);
        let mut seeded = state.map(Dual::<R, 1>::of);
        seeded[LENGTH] = Dual::variable(state[LENGTH], 0);
        seeded[PRESSURE] = Dual { value: state[PRESSURE], slope: [per_length] };
        let excess = self.excess(tether, &seeded, phase);
        let step = excess.value / excess.slope[0];
        if step.value().is_finite() {
            state[LENGTH] = state[LENGTH] - step;
            state[PRESSURE] = state[PRESSURE] - step * per_length;
        }
    }

    /// Where the load hangs at the start, at rest: what is held of its pull, or the middle of what can be.
    pub(super) fn hang<const N: usize>(&self, tether: &Tether<R>, state: &mut [R; N]) {
        let rubbing = Rubbing::from(R::zero());
        let (least, most) = self.rig.holdable(state[LENGTH], state[PRESSURE], rubbing);
        let middle = R::constant(0.5) * (least + most);
        let tension = self.inertia.map_or(middle, |inertia| inertia.pull.larger(least).smaller(most));
        state[tether.distance] = tether.distance_at(state[LENGTH], tension);
        if self.inertia.is_none() {
            state[VELOCITY] = R::zero();
        }
    }

    /// The mode at the start.
    pub(super) fn begin_tethered<const N: usize>(
        &self,
        tether: &Tether<R>,
        time: R,
        state: &[R; N],
        phase: &mut Phase<R>,
    ) {
        phase.loose = tether.tendon.tension(tether.stretched(state)).value() <= 0.0;
        let beyond = state[LENGTH].value() > self.rig.actuator().limits().max_length().value();
        phase.mode.extent = if beyond { Extent::Taut } else { Extent::Free };
        self.rest_or_pull(tether, time, state, phase);
    }

    /// From rest: stick if the tension can be held, else slide the way it pulls.
    fn rest_or_pull<const N: usize>(&self, tether: &Tether<R>, time: R, state: &[R; N], phase: &mut Phase<R>) {
        let friction = self.rig.actuator().friction();
        let on_the_stop = state[LENGTH].value() <= self.rig.actuator().limits().min_length().value();
        phase.mode.sliding = Sliding::Stuck;
        let (least, most) = self.holdable(state, phase);
        let (pull, band) = (tether.tension(state, phase).value(), self.member.force_band);
        let heading = match (pull - least.value(), pull - most.value()) {
            (_, above) if above > band => 1.0,
            (below, _) if below < -band => -1.0,
            _ if friction.has_coulomb() || on_the_stop => return,
            // It goes the way of the balance, however small.
            _ => {
                phase.mode.sliding = self.rig.sliding(1.0);
                self.follow(state, phase, false);
                self.velocity(time, state, phase).value()
            }
        };
        phase.mode.sliding = self.rig.sliding(heading);
    }

    /// Adds the guards of the tendon and of the end on it.
    pub(super) fn tethered_guards(&self, phase: &Phase<R>, guards: &mut Guards<Guard>) {
        let mode = &phase.mode;
        let on = |index, bound: R, above| {
            let bound = bound.value();
            if above { GuardForm::Above { index, bound } } else { GuardForm::Below { index, bound } }
        };
        if mode.sliding != Sliding::Stuck {
            let (by_length, by_force) = self.member.extent_guards(mode.extent);
            for (guard, bound, lasts_above) in by_length.into_iter().flatten() {
                guards.add(guard, on(LENGTH, bound, lasts_above));
            }
            if let Some(guard) = by_force {
                guards.add(guard, GuardForm::Function);
            }
        }
        match mode.sliding {
            Sliding::Lengthening | Sliding::Shortening => guards.add(Guard::Rest, GuardForm::Function),
            Sliding::Stuck => {
                guards.add(Guard::BreakLonger, GuardForm::Function);
                guards.add(Guard::BreakShorter, GuardForm::Function);
            }
            Sliding::Held | Sliding::Frictionless => {}
        }
        if let Some((end, lasts_above)) = phase.trace.as_ref().and_then(super::member::Trace::end) {
            guards.add(Guard::Slip, on(LENGTH, end, lasts_above));
        }
        guards.add(if phase.loose { Guard::TendonTight } else { Guard::TendonLoose }, GuardForm::Function);
    }

    /// Value of a guard of the tendon or of the end on it; `None` for one that is not theirs.
    pub(super) fn tethered_guard<T: Differentiable<R>, const N: usize>(
        &self,
        tether: &Tether<R>,
        (guard, time): (Guard, T),
        state: &[T; N],
        phase: &Phase<R>,
    ) -> Option<T> {
        let band = T::constant(self.member.force_band);
        let slack = T::constant(self.member.band * tether.scale);
        let limits = self.rig.actuator().limits();
        let stretch = || tether.stretched(state) - T::of(tether.tendon.rest_length());
        let pull = || tether.tension(state, phase);
        let velocity = || self.end_velocity(tether, state, phase, &self.inflow(time, state, phase));
        let direction = T::constant(phase.mode.sliding.direction());
        Some(match guard {
            Guard::Rest if is_damped(self.rig, &phase.mode) => band - direction * self.excess(tether, state, phase),
            Guard::Rest => T::constant(self.rest_band()) + direction * velocity(),
            Guard::BreakLonger => self.holdable(state, phase).1 + band - pull(),
            Guard::BreakShorter => pull() - self.holdable(state, phase).0 + band,
            Guard::Rebound => limits.taut_force(state[LENGTH], velocity()) + band,
            Guard::Retaut => band - limits.taut_force(state[LENGTH], velocity()),
            Guard::TendonLoose => stretch() + slack,
            Guard::TendonTight => slack - stretch(),
            _ => return None,
        })
    }

    /// What follows when a guard of the tendon or of the end on it has come down through zero; `None` for one that is not
    /// theirs.
    pub(super) fn cross_tethered<const N: usize>(
        &self,
        (guard, time): (Guard, R),
        state: &mut [R; N],
        phase: &mut Phase<R>,
    ) -> Result<Option<EventKind>, Error> {
        let limits = self.rig.actuator().limits();
        Ok(Some(match guard {
            Guard::Slack => {
                state[LENGTH] = limits.min_length();
                phase.mode.sliding = Sliding::Stuck;
                EventKind::Stick
            }
            Guard::Rest => {
                self.check_no_jump(time, state, phase)?;
                if self.rig.actuator().friction().has_coulomb() {
                    phase.mode.sliding = Sliding::Stuck;
                    if phase.mode.extent == Extent::Rebound {
                        phase.mode.extent = Extent::Taut;
                    }
                    EventKind::Stick
                } else {
                    phase.mode.sliding = self.rig.sliding(-phase.mode.sliding.direction());
                    EventKind::Reversal
                }
            }
            Guard::BreakLonger | Guard::BreakShorter => {
                phase.mode.sliding = self.rig.sliding(if guard == Guard::BreakLonger { 1.0 } else { -1.0 });
                self.check_no_jump(time, state, phase)?;
                EventKind::BreakAway
            }
            Guard::TendonLoose | Guard::TendonTight => {
                phase.loose = guard == Guard::TendonLoose;
                if phase.loose { EventKind::TendonLoose } else { EventKind::TendonTight }
            }
            Guard::Taut | Guard::Untaut => {
                state[LENGTH] = limits.max_length();
                let taut = guard == Guard::Taut;
                phase.mode.extent = if taut { Extent::Taut } else { Extent::Free };
                if taut { EventKind::Taut } else { EventKind::Untaut }
            }
            _ => return Ok(None),
        }))
    }

    /// That the end, on the border of what dry friction holds, slides no faster than a border is wide.
    fn check_no_jump<const N: usize>(&self, time: R, state: &[R; N], phase: &Phase<R>) -> Result<(), Error> {
        if !self.rig.actuator().friction().coulomb().falls() {
            return Ok(());
        }
        let velocity = self.velocity(time, state, phase).value();
        if self.member.damping(&phase.mode) * velocity.abs() <= JUMP * self.member.force_band {
            return Ok(());
        }
        Err(Error::Stopped {
            time: time.value(),
            reason: "dry friction falls with velocity faster than viscous friction grows, and an end without a mass jumps",
            quantity: "velocity of the actuator's end",
            value: velocity,
            unit: "m/s",
            remedy: "raise actuator.friction.viscous or stribeck_velocity, lower static_ratio, or set \
                     run.engine = \"fixed-step\"",
        })
    }

    /// After an event that lets the rate jump: rest, or turn, where the end would slide against its direction, and break away
    /// where no friction holds it.
    pub(super) fn settle_end<const N: usize>(&self, tether: &Tether<R>, time: R, state: &[R; N], phase: &mut Phase<R>) {
        let value = |guard| {
            let value: Option<R> = self.tethered_guard(tether, (guard, time), state, phase);
            value.map_or(0.0, R::value)
        };
        let sliding = phase.mode.sliding;
        phase.mode.sliding = match sliding {
            Sliding::Lengthening | Sliding::Shortening if value(Guard::Rest) < 0.0 => {
                match self.rig.actuator().friction().has_coulomb() {
                    true => Sliding::Stuck,
                    false => self.rig.sliding(-sliding.direction()),
                }
            }
            Sliding::Stuck if value(Guard::BreakLonger) < 0.0 => self.rig.sliding(1.0),
            Sliding::Stuck if value(Guard::BreakShorter) < 0.0 => self.rig.sliding(-1.0),
            same => same,
        };
        if phase.mode.sliding != sliding {
            self.follow(state, phase, false);
        }
    }
}
