//! The rig as a hybrid system: when each formula of the actuator holds, and what follows when it ends.
//!
//! | component of the mode | values | ends when |
//! |---|---|---|
//! | passages | supply, exhaust | a seat moves (an instant) |
//! | flow zone of each passage | choked, subsonic, near equal; in, out | the pressure leaves its bounds |
//! | piece of a tabulated effectiveness | 0, 1, … | the pressure passes a row |
//! | piece of a measured force map | 0, 1, … each way | length or pressure passes a line of the grid |
//! | extent | slack, free, taut, rebound | the length passes a limit; the taut braid's force passes zero |
//! | sliding | lengthening, shortening, stuck, held, frictionless | the velocity comes to zero; the load breaks away |
//! | clamped | yes, no | the sum of forces passes zero |
//!
//! At rest, a tension between `F_s + F_limit − Q k_sec` and `F_s + F_limit + Q k_sec` can be held, and any from zero up
//! when the actuator rests on its shortest length. The load sticks while its pull lies between.

use super::event::band;
use super::mode::{EventKind, Extent, Guard, Mode, Sliding};
use super::rig::Rig;
use super::system::{GuardForm, Guards, HybridSystem};
use super::timetable::Progress;
use crate::air::Process;
use crate::error::Error;
use crate::force::Statics;
use crate::load::{Inertia, Load};
use crate::scalar::{Over, Real};
use crate::valve::{FlowZone, Port};

pub(super) const LENGTH: usize = 0;
const VELOCITY: usize = 1;
pub(super) const PRESSURE: usize = 2;

/// The mode with what its clocks remember.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase<R = f64> {
    /// Which formulas hold.
    pub mode: Mode,
    progress: Progress<R>,
    /// `P V/m` of an isothermal process, which nothing changes.
    isothermal: Option<R>,
}

/// A rig with the tolerance to which its events are told from rounding.
#[derive(Clone, Copy, Debug)]
pub struct RigSystem<'a, R: Real = f64> {
    rig: &'a Rig<R>,
    magnitudes: [f64; 4],
    /// Relative width of a border between agreeing formulas.
    band: f64,
    /// The same as a force in N.
    force_band: f64,
    /// Scale of the length in m while the braid is taut.
    taut_scale: f64,
    inertia: Option<Inertia<R>>,
    /// `1/M`, or zero when the motion is given.
    per_mass: R,
}

impl<'a, R: Real> RigSystem<'a, R> {
    /// A rig whose steps are controlled to `relative_tolerance`.
    pub fn new(rig: &'a Rig<R>, relative_tolerance: f64) -> Self {
        let actuator = rig.actuator();
        let (air, limits, braid) = (actuator.air(), actuator.limits(), &actuator.law().law.braid);
        let atmosphere = air.atmosphere().0.value();
        let longest = limits.max_length();
        let volume = actuator.volume(longest).value();
        let air_mass = atmosphere * volume / (air.gas_constant().value() * ROOM_TEMPERATURE);
        let inertia = rig.load().inertia();
        let thread = braid.thread_length().value();
        let gas_force = atmosphere * thread * thread * braid.per_turns().value();
        let force = inertia.map_or(0.0, |inertia| inertia.pull.value().abs()).max(gas_force);
        let band = band(relative_tolerance);
        Self {
            rig,
            magnitudes: [longest.value(), longest.value() * USUAL_RATE, atmosphere, air_mass],
            band,
            force_band: band * force,
            taut_scale: (TAUT * force / limits.stiffness().value()).min(longest.value()),
            inertia,
            per_mass: inertia.map_or(R::zero(), |inertia| R::one() / inertia.mass),
        }
    }

    /// The rig.
    pub fn rig(&self) -> &Rig<R> {
        self.rig
    }

    /// Relative width of a border between agreeing formulas.
    pub(super) fn band(&self) -> f64 {
        self.band
    }

    /// The usual size of each state: the longest length, a usual velocity, the atmosphere's pressure, the air at that.
    #[cfg(feature = "alloc")]
    pub(super) fn magnitudes(&self) -> [f64; 4] {
        self.magnitudes
    }

    /// The phase at t = 0 in a state.
    pub fn begin(&self, state: &[R; 4]) -> Phase<R> {
        let mut progress = Progress::none();
        let ports = self.rig.timetable().pass(&mut progress, R::zero());
        let mode = Mode {
            ports,
            supply_zone: None,
            exhaust_zone: None,
            effectiveness_piece: self.effectiveness_piece(state[PRESSURE]),
            force_piece: self.force_piece(state[LENGTH], state[PRESSURE]),
            extent: Extent::Free,
            sliding: Sliding::Held,
            clamped: false,
        };
        let mut phase = Phase { mode, progress, isothermal: self.isothermal_content(state) };
        self.enter_ports(state, &mut phase.mode);
        self.enter_extent(state, &mut phase.mode);
        self.enter_sliding(R::zero(), state, &mut phase);
        phase
    }

    /// Tension in N in a mode: what the load feels.
    #[inline(always)]
    pub fn tension<T: Over<R>>(&self, state: &[T; 4], mode: &Mode) -> T {
        if mode.sliding == Sliding::Stuck {
            return self.inertia.map_or(T::zero(), |inertia| T::of(inertia.pull));
        }
        if mode.extent == Extent::Slack || mode.clamped {
            return T::zero();
        }
        self.signed_force(state, mode)
    }

    /// The sum of (12) before it is kept from pushing.
    #[inline(always)]
    fn signed_force<T: Over<R>>(&self, state: &[T; 4], mode: &Mode) -> T {
        let [length, velocity, pressure, _] = *state;
        let actuator = self.rig.actuator();
        let (law, gauge) = (actuator.law(), actuator.gauge(pressure));
        let effectiveness = law.effectiveness.in_piece(mode.effectiveness_piece, gauge);
        let factors = [effectiveness, law.law.force_in_piece(mode.force_piece, length, gauge)];
        let direction = T::constant(mode.sliding.direction());
        actuator.signed_force([length, velocity, pressure], direction, mode.extent == Extent::Taut, factors)
    }

    /// The extent of a state that may lie on a limit: then the velocity, or at rest the balance, decides.
    fn enter_extent(&self, state: &[R; 4], mode: &mut Mode) {
        let limits = self.rig.actuator().limits();
        let [length, velocity] = [state[LENGTH].value(), state[VELOCITY].value()];
        let (shortest, longest) = (limits.min_length().value(), limits.max_length().value());
        let pushed_up = self.inertia.is_some_and(|inertia| inertia.pull.value() < 0.0);
        mode.extent = if length < shortest || (length == shortest && (velocity < 0.0 || (velocity == 0.0 && pushed_up)))
        {
            Extent::Slack
        } else if length < longest || (length == longest && velocity <= 0.0) {
            Extent::Free
        } else if limits.taut_force(state[LENGTH], state[VELOCITY]).value() >= 0.0 {
            Extent::Taut
        } else {
            Extent::Rebound
        };
    }

    /// The direction of sliding in a state that may be at rest, and whether the force is clamped.
    fn enter_sliding(&self, time: R, state: &[R; 4], phase: &mut Phase<R>) {
        let velocity = state[VELOCITY].value();
        phase.mode.sliding = match (self.rig.load(), self.inertia) {
            (Load::Isometric, _) => Sliding::Held,
            (Load::Prescribed(motion), _) => {
                let [_, velocity, acceleration] = motion.at::<R>(time, phase.progress.corners_passed).map(Real::value);
                let heading = if velocity == 0.0 { acceleration } else { velocity };
                if heading == 0.0 { Sliding::Held } else { self.rig.sliding(heading) }
            }
            (_, Some(inertia)) if velocity == 0.0 => self.rest_or_slide(inertia, state, &mut phase.mode),
            _ => self.rig.sliding(velocity),
        };
        self.enter_clamp(state, &mut phase.mode);
    }

    /// From rest: stick if the load can be held, else slide the way it pulls.
    fn rest_or_slide(&self, inertia: Inertia<R>, state: &[R; 4], mode: &mut Mode) -> Sliding {
        let actuator = self.rig.actuator();
        let on_the_stop = state[LENGTH].value() == actuator.limits().min_length().value();
        if mode.extent == Extent::Slack || !(actuator.friction().has_coulomb() || on_the_stop) {
            return self.rig.sliding(inertia.pull.value());
        }
        let (least, most) = self.rig.holdable(state[LENGTH], state[PRESSURE]);
        let (least, most, pull) = (least.value(), most.value(), inertia.pull.value());
        if pull > most + self.force_band {
            self.rig.sliding(1.0)
        } else if pull < least - self.force_band {
            if on_the_stop {
                mode.extent = Extent::Slack;
            }
            self.rig.sliding(-1.0)
        } else {
            Sliding::Stuck
        }
    }

    fn enter_clamp(&self, state: &[R; 4], mode: &mut Mode) {
        let moves = mode.extent != Extent::Slack && mode.sliding != Sliding::Stuck;
        mode.clamped = moves && self.signed_force(state, mode).value() < 0.0;
    }

    /// Whether the load, arriving at the shortest length, comes to rest there: it can be held, and it would bounce less
    /// than the tolerance of its length.
    fn rests_on_the_stop(&self, state: &[R; 4]) -> bool {
        let Some(inertia) = self.inertia else { return false };
        let (pull, mass) = (inertia.pull.value(), inertia.mass.value());
        let most = self.rig.holdable(state[LENGTH], state[PRESSURE]).1.value();
        let acceleration = pull.min(most - pull) / mass;
        let velocity = state[VELOCITY].value();
        acceleration > 0.0 && velocity * velocity <= 2.0 * acceleration * self.band * self.magnitudes[LENGTH]
    }
}

/// Velocity scale: one length a second.
const USUAL_RATE: f64 = 1.0;
/// The part of that scale below which an error in velocity counts absolutely.
const SLOW: f64 = 0.1;
/// Part of the stretch under the usual force that a taut length is measured by.
const TAUT: f64 = 0.5;
/// Temperature in K at which the scale of the air mass is taken.
const ROOM_TEMPERATURE: f64 = 293.15;

/// Goes to the next piece or the one before.
fn step(piece: &mut usize, up: bool) {
    *piece = if up { *piece + 1 } else { piece.saturating_sub(1) };
}

impl<R: Real> HybridSystem<R, 4> for RigSystem<'_, R> {
    type Mode = Phase<R>;
    type Guard = Guard;
    type Kind = EventKind;

    #[inline(always)]
    fn rates<T: Over<R>>(&self, time: T, state: &[T; 4], phase: &Phase<R>) -> [T; 4] {
        let mode = &phase.mode;
        let actuator = self.rig.actuator();
        let mut ends = [state[LENGTH], state[VELOCITY], T::zero()];
        match self.rig.load() {
            Load::Prescribed(motion) => ends = motion.at(time, phase.progress.corners_passed),
            Load::Isometric => ends[1] = T::zero(),
            _ if mode.sliding == Sliding::Stuck => ends[1] = T::zero(),
            _ => {
                if let Some(inertia) = self.inertia {
                    ends[2] = (T::of(inertia.pull) - self.tension(state, mode)) * T::of(self.per_mass);
                }
            }
        }
        let [length, velocity, acceleration] = ends;
        let slack = mode.extent == Extent::Slack;
        let chamber = actuator.chamber(length, velocity, state[PRESSURE], state[3], slack);
        let flow = self.flow(&chamber, mode);
        [velocity, acceleration, actuator.pressure_rate(&chamber, &flow), flow.net()]
    }

    fn settling_rate(&self, time: R, state: &[R; 4], phase: &Phase<R>) -> f64 {
        self.damping_rate(&phase.mode).max(self.pressure_settling_rate(time, state, phase))
    }

    fn scales(&self, state: &[R; 4], phase: &Phase<R>) -> [f64; 4] {
        let [longest, _, atmosphere, air_mass] = self.magnitudes;
        let [length, velocity, pressure, mass] = state.map(|value| value.value().abs());
        // On the taut braid a length counts by the force that an error in it makes.
        let length = match phase.mode.extent {
            Extent::Taut | Extent::Rebound => self.taut_scale,
            Extent::Slack | Extent::Free => length.max(longest),
        };
        [length, velocity + self.slow(), pressure + 0.1 * atmosphere, mass + 0.1 * air_mass]
    }

    fn next_instant(&self, phase: &Phase<R>, until: R) -> Option<R> {
        self.rig.timetable().next(&phase.progress, until)
    }

    fn pass_instant(&self, time: R, state: &mut [R; 4], phase: &mut Phase<R>) -> Result<EventKind, Error> {
        let ports = self.rig.timetable().pass_seats(&mut phase.progress, time);
        if ports != phase.mode.ports {
            phase.mode.ports = ports;
            self.enter_ports(state, &mut phase.mode);
            return Ok(EventKind::Valve);
        }
        phase.progress.corners_passed += 1;
        self.project(time, state, phase);
        self.enter_extent(state, &mut phase.mode);
        self.enter_sliding(time, state, phase);
        Ok(EventKind::Corner)
    }

    fn guards(&self, phase: &Phase<R>) -> Guards<Guard> {
        let mode = &phase.mode;
        let limits = self.rig.actuator().limits();
        let mut guards = Guards::new();
        let above = |index, bound: R| GuardForm::Above { index, bound: bound.value() };
        let below = |index, bound: R| GuardForm::Below { index, bound: bound.value() };
        let moves = !matches!(self.rig.load(), Load::Isometric) && mode.sliding != Sliding::Stuck;
        if moves {
            match mode.extent {
                Extent::Slack => guards.add(Guard::Tight, below(LENGTH, limits.min_length())),
                Extent::Free => {
                    guards.add(Guard::Slack, above(LENGTH, limits.min_length()));
                    guards.add(Guard::Taut, below(LENGTH, limits.max_length()));
                }
                Extent::Taut => {
                    guards.add(Guard::ThreadLength, below(LENGTH, self.thread_length()));
                    guards.add(Guard::Rebound, GuardForm::Function);
                }
                Extent::Rebound => {
                    guards.add(Guard::Untaut, above(LENGTH, limits.max_length()));
                    guards.add(Guard::Retaut, GuardForm::Function);
                }
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
        if mode.sliding != Sliding::Stuck && mode.extent != Extent::Slack {
            guards.add(if mode.clamped { Guard::TensionBack } else { Guard::TensionZero }, GuardForm::Function);
        }
        self.zone_guards(mode, &mut guards);
        self.piece_guards(mode, &mut guards);
        guards
    }

    fn guard<T: Over<R>>(&self, guard: Guard, _time: T, state: &[T; 4], phase: &Phase<R>) -> T {
        let mode = &phase.mode;
        let limits = self.rig.actuator().limits();
        let [length, velocity, pressure, _] = *state;
        let (shortest, longest) = (T::of(limits.min_length()), T::of(limits.max_length()));
        let band = T::constant(self.force_band);
        let pull = || self.inertia.map_or(T::zero(), |inertia| T::of(inertia.pull));
        let bound = |port, zone: Option<FlowZone>, up| {
            zone.and_then(|zone| self.zone_bound(port, zone, up)).map_or(pressure, T::of)
        };
        match guard {
            Guard::ThreadLength => T::of(self.thread_length()) - length,
            Guard::Slack => length - shortest,
            Guard::Tight => shortest - length,
            Guard::Taut => longest - length,
            Guard::Untaut => length - longest,
            Guard::Rebound => limits.taut_force(length, velocity) + band,
            Guard::Retaut => band - limits.taut_force(length, velocity),
            Guard::Rest if mode.sliding == Sliding::Shortening => T::constant(self.rest_band()) - velocity,
            Guard::Rest => T::constant(self.rest_band()) + velocity,
            Guard::BreakLonger => self.rig.holdable(length, pressure).1 + band - pull(),
            Guard::BreakShorter => pull() - self.rig.holdable(length, pressure).0 + band,
            Guard::TensionZero => self.signed_force(state, mode) + band,
            Guard::TensionBack => band - self.signed_force(state, mode),
            Guard::SupplyDown => pressure - bound(Port::Supply, mode.supply_zone, false),
            Guard::SupplyUp => bound(Port::Supply, mode.supply_zone, true) - pressure,
            Guard::ExhaustDown => pressure - bound(Port::Exhaust, mode.exhaust_zone, false),
            Guard::ExhaustUp => bound(Port::Exhaust, mode.exhaust_zone, true) - pressure,
            Guard::MapShorter => length - self.map_length_bound(mode, false).map_or(length, T::of),
            Guard::MapLonger => self.map_length_bound(mode, true).map_or(length, T::of) - length,
            Guard::MapDown => pressure - self.map_pressure_bound(mode, false).map_or(pressure, T::of),
            Guard::MapUp => self.map_pressure_bound(mode, true).map_or(pressure, T::of) - pressure,
            Guard::PieceDown => pressure - self.piece_bound(mode, false).map_or(pressure, T::of),
            Guard::PieceUp => self.piece_bound(mode, true).map_or(pressure, T::of) - pressure,
        }
    }

    fn cross(&self, guard: Guard, time: R, state: &mut [R; 4], phase: &mut Phase<R>) -> Result<EventKind, Error> {
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
                if self.rests_on_the_stop(state) {
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
                self.enter_clamp(state, &mut phase.mode);
                Ok(if taut { EventKind::Taut } else { EventKind::Untaut })
            }
            Guard::Rebound | Guard::Retaut => {
                let taut = guard == Guard::Retaut;
                phase.mode.extent = if taut { Extent::Taut } else { Extent::Rebound };
                Ok(if taut { EventKind::Taut } else { EventKind::Rebound })
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
                self.enter_clamp(state, &mut phase.mode);
                Ok(EventKind::BreakAway)
            }
            Guard::TensionZero | Guard::TensionBack => {
                phase.mode.clamped = guard == Guard::TensionZero;
                Ok(if phase.mode.clamped { EventKind::TensionZero } else { EventKind::TensionBack })
            }
            Guard::SupplyDown | Guard::SupplyUp => {
                Self::move_zone(&mut phase.mode.supply_zone, guard == Guard::SupplyUp);
                Ok(EventKind::Flow)
            }
            Guard::ExhaustDown | Guard::ExhaustUp => {
                Self::move_zone(&mut phase.mode.exhaust_zone, guard == Guard::ExhaustUp);
                Ok(EventKind::Flow)
            }
            Guard::MapShorter | Guard::MapLonger => {
                step(&mut phase.mode.force_piece.length, guard == Guard::MapLonger);
                Ok(EventKind::ForceMap)
            }
            Guard::MapDown | Guard::MapUp => {
                step(&mut phase.mode.force_piece.pressure, guard == Guard::MapUp);
                Ok(EventKind::ForceMap)
            }
            Guard::PieceDown | Guard::PieceUp => {
                step(&mut phase.mode.effectiveness_piece, guard == Guard::PieceUp);
                Ok(EventKind::Effectiveness)
            }
        }
    }

    fn project(&self, time: R, state: &mut [R; 4], phase: &Phase<R>) {
        if let Load::Prescribed(motion) = self.rig.load() {
            let [length, velocity, _] = motion.at(time, phase.progress.corners_passed);
            (state[LENGTH], state[VELOCITY]) = (length, velocity);
        }
        if let Some(content) = phase.isothermal {
            state[PRESSURE] = content * state[3] / self.rig.actuator().volume(state[LENGTH]);
        }
    }

    fn stuck(&self, time: R, state: &[R; 4], _phase: &Phase<R>) -> Error {
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
    /// The velocity in m/s by which zero must be passed before it is a turn: what a few steps may err.
    fn rest_band(&self) -> f64 {
        10.0 * self.band * self.slow()
    }

    /// The velocity in m/s below which its error counts absolutely.
    fn slow(&self) -> f64 {
        SLOW * self.magnitudes[VELOCITY]
    }

    /// `P V/m` of a state, if the process keeps it.
    fn isothermal_content(&self, state: &[R; 4]) -> Option<R> {
        let actuator = self.rig.actuator();
        let content = || state[PRESSURE] * actuator.volume(state[LENGTH]) / state[3];
        matches!(actuator.air().process(), Process::Isothermal).then(content)
    }

    fn thread_length(&self) -> R {
        self.rig.actuator().law().law.end_length()
    }

    /// Rate in 1/s at which friction and the taut braid damp the load.
    fn damping_rate(&self, mode: &Mode) -> f64 {
        let actuator = self.rig.actuator();
        if mode.extent == Extent::Slack || mode.clamped || mode.sliding == Sliding::Stuck {
            return 0.0;
        }
        let taut = if mode.extent == Extent::Taut { actuator.limits().damping().value() } else { 0.0 };
        (actuator.friction().viscous().value() + taut) * self.per_mass.value()
    }

    /// The velocity has come to zero: stick, or go the other way.
    fn turn(&self, state: &[R; 4], phase: &mut Phase<R>) -> EventKind {
        phase.mode.sliding = match self.inertia {
            Some(inertia) => self.rest_or_slide(inertia, state, &mut phase.mode),
            None => self.rig.sliding(-phase.mode.sliding.direction()),
        };
        self.enter_clamp(state, &mut phase.mode);
        if phase.mode.sliding == Sliding::Stuck { EventKind::Stick } else { EventKind::Reversal }
    }
}
