//! One actuator as a member of a hybrid system: its part of the mode, and what ends it.
//!
//! | component of the mode | values | ends when |
//! |---|---|---|
//! | piece of a tabulated effectiveness | 0, 1, … | the pressure passes a row |
//! | pressed | yes, no | the gauge pressure passes zero |
//! | piece of a measured force map | 0, 1, … each way | length or pressure passes a line of the grid |
//! | length regime | slack, free, taut, rebound | the length passes a limit; the taut braid's force passes zero |
//! | clamped | yes, no | the sum of forces passes zero |
//!
//! How the ends move, and so the sliding, is the mechanism's to say, and the flow zones are the network's. The pieces are in
//! `pieces.rs`.

use super::mode::{EventKind, Guard, LengthRegime, Mode, Sliding};
use crate::actuator::Actuator;
use crate::air::Process;
use crate::engine::event::band;
use crate::force::Statics;
use crate::friction::{Branch, Deflections, Hysteresis, LuGre, Memory, SlidingState};
use crate::numbered::Row;
use crate::scalar::{Over, Real, Scalar};

/// Temperature in K at which the scale of the air mass is taken.
const ROOM_TEMPERATURE: f64 = 293.15;
/// Part of the stretch under the usual force that a taut length is measured by.
const TAUT: f64 = 0.5;

/// An actuator with the tolerance that separates its events from rounding.
#[derive(Clone, Debug)]
pub struct Member<R: Scalar> {
    /// The actuator.
    pub actuator: Actuator<R>,
    /// Usual sizes: the longest length, the atmosphere's pressure, the air at that.
    pub(crate) longest: f64,
    pub(crate) atmosphere: f64,
    pub(crate) air_mass: f64,
    /// Relative width of a border between agreeing formulas.
    pub(crate) band: f64,
    /// Width in N of a border between agreeing formulas, as a force.
    pub force_band: f64,
    /// Scale of the length in m while the braid is taut.
    pub(crate) taut_scale: f64,
}

/// What the hysteresis of a member remembers, and the branch of it that holds in the mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace<R> {
    memory: Memory<R>,
    branch: Branch<R>,
    /// −1, 0 or +1: the way that the length goes.
    direction: f64,
}

impl<R: Real> Trace<R> {
    /// Begins the branch from where the memory is, in a direction.
    fn head(&mut self, hysteresis: &Hysteresis<R>, direction: f64) {
        self.direction = direction;
        self.branch = hysteresis.branch(&self.memory, direction);
    }

    /// The force of the hysteresis over the secant stiffness in m, at an actuator length in m on the branch.
    #[inline(always)]
    pub(crate) fn width<T: Over<R>>(&self, length: T) -> T {
        self.branch.width(length)
    }

    /// The branch that holds.
    pub fn branch(&self) -> &Branch<R> {
        &self.branch
    }

    /// That and the part of it in m that dissipates, in magnitude; zero where there is no trace.
    pub(crate) fn widths(trace: &Option<Self>, length: R) -> [R; 2] {
        let Some(Self { branch, .. }) = trace else { return [R::zero(); 2] };
        [branch.width(length), branch.dissipating(length)]
    }

    /// The guard of the next slip: the actuator length in m, and whether the branch lasts above it.
    pub fn end(&self) -> Option<(R, bool)> {
        self.branch.end.map(|length| (length, self.direction < 0.0))
    }
}

impl<R: Real> Trace<R> {
    /// As numbers in a row.
    pub(crate) fn each_number(&mut self, row: &mut impl Row<R>) {
        let Self { memory: Memory { at, elements }, branch, direction } = self;
        row.number(at);
        row.numbers(elements);
        let Branch { from, width, slope, decay, slipping, wear, end } = branch;
        [from, width, slope, decay, slipping, wear].into_iter().for_each(|number| row.number(number));
        row.instant(end);
        row.choice(direction, [0.0, 1.0, -1.0]);
    }
}

/// A length in m that ends a length regime: the guard, the length, and whether the regime lasts above it.
pub(crate) type LengthGuard<R> = (Guard, R, bool);

impl<S: Scalar> Member<S> {
    /// An actuator in lanes, where no event is separated from rounding.
    pub(crate) fn in_lanes(actuator: &Actuator<S>) -> Self {
        let actuator = actuator.clone();
        Self { actuator, longest: 0.0, atmosphere: 0.0, air_mass: 0.0, band: 0.0, force_band: 0.0, taut_scale: 0.0 }
    }
}

impl<R: Real> Member<R> {
    /// An actuator against a usual force of `pull` N whose steps are controlled to `relative_tolerance`.
    pub(crate) fn new(actuator: &Actuator<R>, relative_tolerance: f64, pull: f64) -> Self {
        let (air, limits, braid) = (actuator.air(), actuator.limits(), &actuator.law().law.braid);
        let atmosphere = air.atmosphere().0.value();
        let longest = limits.max_length();
        let volume = actuator.volume(longest).value();
        let air_mass = atmosphere * volume / (air.gas_constant().value() * ROOM_TEMPERATURE);
        let thread = braid.thread_length().value();
        let gas_force = atmosphere * thread * thread * braid.per_turns().value();
        let force = pull.max(gas_force);
        let band = band(relative_tolerance);
        Self {
            actuator: actuator.clone(),
            longest: longest.value(),
            atmosphere,
            air_mass,
            band,
            force_band: band * force,
            taut_scale: (TAUT * force / limits.stiffness().value()).min(longest.value()),
        }
    }

    /// Length in m at which the braid would be straight, or its wall would close the bore.
    pub fn thread_length(&self) -> R {
        self.actuator.law().law.end_length()
    }

    /// `P V/m` of a state, if the process keeps it.
    pub(crate) fn isothermal_content(&self, length: R, [pressure, mass]: [R; 2]) -> Option<R> {
        let content = || pressure * self.actuator.volume(length) / mass;
        matches!(self.actuator.air().process(), Process::Isothermal).then(content)
    }

    /// A relaxed hysteresis at an actuator length in m, if there is one that follows the length alone.
    pub(crate) fn trace(&self, length: R) -> Option<Trace<R>> {
        self.trace_from(Memory::relaxed(length))
    }

    /// A hysteresis with a memory, if there is one that follows the length alone.
    pub(crate) fn trace_from(&self, memory: Memory<R>) -> Option<Trace<R>> {
        let hysteresis = self.actuator.friction().hysteresis().filter(|law| !matches!(law, Hysteresis::LuGre(_)))?;
        Some(Trace { memory, branch: hysteresis.branch(&memory, 0.0), direction: 0.0 })
    }

    /// Takes the memory on to an actuator length in m and sets the branch that follows in the sliding of a mode; `slips`
    /// says whether it is at the end of its branch.
    pub(crate) fn follow(&self, trace: &mut Option<Trace<R>>, length: R, sliding: Sliding, slips: bool) {
        let (Some(trace), Some(hysteresis)) = (trace, self.actuator.friction().hysteresis()) else { return };
        // A branch lasts until it ends or the length turns. Begun again at its very end, it would end there again by
        // rounding.
        if !slips && sliding.direction() == trace.direction {
            return;
        }
        if slips {
            hysteresis.slip(&mut trace.memory, trace.direction, length);
        } else {
            // With a trace the velocity does not matter.
            hysteresis.moved(&mut trace.memory, length, R::zero());
        }
        trace.head(hysteresis, sliding.direction());
    }

    /// Takes the memory on to an actuator length in m, where it rests: past all that slips on the way.
    pub(crate) fn carry(&self, trace: &mut Option<Trace<R>>, length: R) {
        let (Some(trace), Some(hysteresis)) = (trace, self.actuator.friction().hysteresis()) else { return };
        hysteresis.moved(&mut trace.memory, length, R::zero());
        trace.head(hysteresis, 0.0);
    }

    /// LuGre's law, if that is the friction.
    #[inline(always)]
    pub(crate) fn lugre(&self) -> Option<&LuGre<R>> {
        self.actuator.friction().lugre()
    }

    /// The sliding state at an actuator length and velocity, by what the states and the hysteresis say.
    #[inline(always)]
    pub(crate) fn sliding_state<T: Over<R>>(
        &self,
        [length, velocity]: [T; 2],
        mode: &Mode,
        (trace, deflections): (&Option<Trace<R>>, Deflections<T>),
    ) -> SlidingState<T> {
        let direction = T::constant(mode.sliding.direction());
        let width = match (deflections.bristles, self.lugre()) {
            (Some(bent), Some(law)) => Some(law.width_at(bent, velocity, direction)),
            _ => trace.as_ref().map(|trace| trace.width(length)),
        };
        let sliding_state = SlidingState { direction, width, force: None, touch: mode.touch() };
        sliding_state.with_branches(self.actuator.friction().viscoelastic(), length, deflections.branches)
    }

    /// The sum of (12) at a length, velocity and pressure, before it is kept from pushing, by what the hysteresis remembers.
    #[inline(always)]
    pub(crate) fn signed_force<T: Over<R>>(
        &self,
        ends: [T; 3],
        mode: &Mode,
        remembered: (&Option<Trace<R>>, Deflections<T>),
    ) -> T {
        self.signed_force_sliding(ends, mode, self.sliding_state([ends[0], ends[1]], mode, remembered))
    }

    /// Force by its sign for a given sliding state.
    #[inline(always)]
    pub(crate) fn signed_force_sliding<T: Over<R>>(
        &self,
        ends: [T; 3],
        mode: &Mode,
        sliding_state: SlidingState<T>,
    ) -> T {
        let actuator = &self.actuator;
        let (law, gauge) = (actuator.law(), actuator.gauge(ends[2]));
        let effectiveness = law.effectiveness.in_piece(mode.effectiveness_piece, gauge);
        let factors = [effectiveness, law.law.force_in_piece(mode.force_piece, ends[0], gauge)];
        actuator.signed_force(ends, sliding_state, mode.length_regime == LengthRegime::Taut, factors)
    }

    /// Tension in N while the ends move: what the load feels.
    #[inline(always)]
    pub(crate) fn tension<T: Over<R>>(
        &self,
        ends: [T; 3],
        mode: &Mode,
        remembered: (&Option<Trace<R>>, Deflections<T>),
    ) -> T {
        if mode.length_regime == LengthRegime::Slack || mode.clamped {
            return T::zero();
        }
        self.signed_force(ends, mode, remembered)
    }

    /// Rate of the force in N with the velocity, from viscous friction and the taut braid, at a length and a pressure while the
    /// ends move.
    pub(crate) fn damping(&self, [length, pressure]: [R; 2], mode: &Mode) -> f64 {
        if mode.length_regime == LengthRegime::Slack || mode.clamped || mode.sliding == Sliding::Stuck {
            return 0.0;
        }
        let taut =
            if mode.length_regime == LengthRegime::Taut { self.actuator.limits().damping().value() } else { 0.0 };
        let pressing = self.actuator.normal_load(length, pressure, mode.touch());
        self.actuator.friction().viscous_at(pressing.secant_stiffness()).value() + taut
    }

    /// The length regime at a length and velocity that lie so far (negative: less) from the shortest and the longest length; on a
    /// limit the velocity, or at rest the balance, decides: `pushed` says whether the ends are pushed together.
    pub(crate) fn length_regime_at(
        &self,
        ends: [R; 2],
        [above_shortest, above_longest]: [f64; 2],
        pushed: bool,
    ) -> LengthRegime {
        let velocity = ends[1].value();
        if above_shortest < 0.0 || (above_shortest == 0.0 && (velocity < 0.0 || (velocity == 0.0 && pushed))) {
            LengthRegime::Slack
        } else if above_longest < 0.0 || (above_longest == 0.0 && velocity <= 0.0) {
            LengthRegime::Free
        } else if self.actuator.limits().taut_force(ends[0], ends[1]).value() >= 0.0 {
            LengthRegime::Taut
        } else {
            LengthRegime::Rebound
        }
    }

    /// Decides again whether the force is kept from pushing.
    pub(crate) fn enter_clamp(&self, ends: [R; 3], mode: &mut Mode, remembered: (&Option<Trace<R>>, Deflections<R>)) {
        let moves = mode.length_regime != LengthRegime::Slack && mode.sliding != Sliding::Stuck;
        mode.clamped = moves && self.signed_force(ends, mode, remembered).value() < 0.0;
    }

    /// The guards that end a length regime: by length, and by the force of the taut braid.
    pub fn length_regime_guards(&self, regime: LengthRegime) -> ([Option<LengthGuard<R>>; 2], Option<Guard>) {
        let limits = self.actuator.limits();
        let (shortest, longest) = (limits.min_length(), limits.max_length());
        match regime {
            LengthRegime::Slack => ([Some((Guard::Tight, shortest, false)), None], None),
            LengthRegime::Free => ([Some((Guard::Slack, shortest, true)), Some((Guard::Taut, longest, false))], None),
            LengthRegime::Taut => {
                ([Some((Guard::ThreadLength, self.thread_length(), false)), None], Some(Guard::Rebound))
            }
            LengthRegime::Rebound => ([Some((Guard::TautEnd, longest, true)), None], Some(Guard::Retaut)),
        }
    }

    /// Value of a guard that is the member's own at a length, velocity and pressure, positive while the mode lasts.
    pub(crate) fn guard<T: Over<R>>(
        &self,
        guard: Guard,
        ends: [T; 3],
        mode: &Mode,
        remembered: (&Option<Trace<R>>, Deflections<T>),
    ) -> T {
        let limits = self.actuator.limits();
        let [length, velocity, pressure] = ends;
        let (shortest, longest) = (T::of(limits.min_length()), T::of(limits.max_length()));
        let band = T::constant(self.force_band);
        let within = |number: T, (bound, lasts_above): (R, bool)| {
            if lasts_above { number - T::of(bound) } else { T::of(bound) - number }
        };
        if let Some(limit) = self.pressure_limit(guard, mode) {
            return within(pressure, limit);
        }
        match guard {
            Guard::ThreadLength => T::of(self.thread_length()) - length,
            Guard::Slack => length - shortest,
            Guard::Tight => shortest - length,
            Guard::Taut => longest - length,
            Guard::TautEnd => length - longest,
            Guard::Rebound => limits.taut_force(length, velocity) + band,
            Guard::Retaut => band - limits.taut_force(length, velocity),
            Guard::TensionZero => self.signed_force(ends, mode, remembered) + band,
            Guard::TensionBack => band - self.signed_force(ends, mode, remembered),
            Guard::Slip => remembered.0.as_ref().and_then(Trace::end).map_or(T::one(), |end| within(length, end)),
            Guard::MapShorter | Guard::MapLonger => {
                self.map_length_limit(guard, mode).map_or(T::one(), |limit| within(length, limit))
            }
            // An end that the mode has not, or the mechanism's: they never end what a member knows of.
            Guard::PieceDown | Guard::PieceUp | Guard::MapDown | Guard::MapUp => T::one(),
            Guard::PressDown | Guard::PressUp => T::one(),
            Guard::TendonLoose | Guard::TendonTight => T::one(),
            Guard::Rest | Guard::BreakLonger | Guard::BreakShorter => T::one(),
        }
    }

    /// Crosses a guard that changes nothing but the member's mode; `None` for one that is the load's.
    pub(crate) fn cross(guard: Guard, mode: &mut Mode) -> Option<EventKind> {
        match guard {
            Guard::Rebound | Guard::Retaut => {
                let taut = guard == Guard::Retaut;
                mode.length_regime = if taut { LengthRegime::Taut } else { LengthRegime::Rebound };
                Some(if taut { EventKind::Taut } else { EventKind::Rebound })
            }
            Guard::TensionZero | Guard::TensionBack => {
                mode.clamped = guard == Guard::TensionZero;
                Some(if mode.clamped { EventKind::TensionZero } else { EventKind::TensionBack })
            }
            Guard::PieceDown | Guard::PieceUp => {
                step(&mut mode.effectiveness_piece, guard == Guard::PieceUp);
                Some(EventKind::Effectiveness)
            }
            Guard::PressDown | Guard::PressUp => {
                mode.pressed = guard == Guard::PressUp;
                Some(EventKind::Press)
            }
            Guard::MapShorter | Guard::MapLonger => {
                step(&mut mode.force_piece.length, guard == Guard::MapLonger);
                Some(EventKind::ForceMap)
            }
            Guard::MapDown | Guard::MapUp => {
                step(&mut mode.force_piece.pressure, guard == Guard::MapUp);
                Some(EventKind::ForceMap)
            }
            _ => None,
        }
    }
}

/// Goes to the next piece or the one before.
fn step(piece: &mut usize, up: bool) {
    *piece = if up { *piece + 1 } else { piece.saturating_sub(1) };
}
