//! The modular actuator: valve state in, force out.
//!
//! Everything that one actuator is, composed: a law of static force with effectiveness (9), friction (12), length limits
//! (10)(14), air (19) and valve (21). Parameters are immutable; the state, and whether the flow paths are open, belong
//! to the caller. A robot simulator needs one call:
//!
//! ```text
//! F = F_s + F_limit + c v + Q k_sec sgn(v),  never below zero,  zero when slack     (12)
//!
//! [`Actuator::respond`]:  distance, velocity, pressure, air mass, ports
//!                         → tension and ∂F/∂L, ∂F/∂v, ∂F/∂P; dP/dt, dm/dt
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | F_s, F_limit | static force with effectiveness, force of the taut braid | N |
//! | c, Q, k_sec | viscous damping, friction length, secant stiffness (13) | N·s/m, m, N/m |
//! | L, v, P | length, its rate, absolute pressure | m, m/s, Pa |
//!
//! The other functions are the pieces of that call, for callers that step time and keep track of the branches
//! themselves.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), sections 2 and 3.
//! Checked by `tests/actuator.rs`: transcription of (12), derivatives against finite differences, both stiffnesses.

use crate::air::{Air, Chamber, Flow};
use crate::convert::{Convert, ConvertEach};
use crate::dual::Dual;
use crate::error::Error;
use crate::force::{Characteristic, Effective, LengthLimits, StaticForce, Statics};
use crate::friction::{Friction, Memory, NormalLoad, SlidingState, ThreadContact};
use crate::parameter::{self, Parameter};
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::scalar::{Mask, Over, Scalar};
use crate::valve::{Ports, Valve};

/// One braided pneumatic actuator with its air and, if it has one, its valve.
#[derive(Clone, Debug, PartialEq)]
pub struct Actuator<S = f64> {
    law: Effective<Characteristic<S>, S>,
    limits: LengthLimits<S>,
    friction: Friction<S>,
    external_volume: S,
    air: Air<S>,
    valve: Option<Valve<S>>,
}

/// The state of an actuator, without that of its ends; it belongs to the caller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorState<S = f64> {
    /// Absolute pressure.
    pub pressure: AbsolutePressure<S>,
    /// Mass of air in kg.
    pub air_mass: S,
    /// What the hysteresis remembers; a relaxed one where there is none.
    pub memory: Memory<S>,
}

impl<S: Scalar> ActuatorState<S> {
    /// Air at an absolute pressure, its mass in kg, and a hysteresis that is relaxed at an actuator length in m.
    pub fn new(pressure: AbsolutePressure<S>, air_mass: S, length: S) -> Self {
        Self { pressure, air_mass, memory: Memory::relaxed(length) }
    }
}

/// What an actuator answers to its ends and its valve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response<S = f64> {
    /// Tension F in N, zero or more.
    pub tension: S,
    /// `∂F/∂L` in N/m at constant pressure.
    pub per_length: S,
    /// `∂F/∂v` in N·s/m.
    pub per_velocity: S,
    /// `∂F/∂P` in m².
    pub per_pressure: S,
    /// `dP/dt` in Pa/s.
    pub pressure_rate: S,
    /// Net mass flow `dm/dt` into the actuator in kg/s.
    pub mass_flow: S,
    /// Temperature of the air in K.
    pub temperature: S,
    /// Volume of the air in the braid and the external volume, in m³; that of a hose is not in it.
    pub volume: S,
}

impl Actuator {
    /// An actuator without a valve, sealed until [`Actuator::with_valve`] gives it one.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless `external_volume` (m³) is above zero.
    pub fn new(
        law: Effective<impl Into<Characteristic>>,
        limits: LengthLimits,
        friction: Friction,
        external_volume: f64,
        air: Air,
    ) -> Result<Self, Error> {
        let external_volume = parameter::EXTERNAL_VOLUME.check(external_volume)?;
        let law = Effective { law: law.law.into(), effectiveness: law.effectiveness };
        Ok(Self { law, limits, friction, external_volume, air, valve: None })
    }

    /// Adds a valve to the actuator.
    pub fn with_valve(self, valve: Valve) -> Self {
        Self { valve: Some(valve), ..self }
    }
}

impl<S: Scalar> Actuator<S> {
    /// The actuator without its valve.
    pub fn without_valve(self) -> Self {
        Self { valve: None, ..self }
    }

    /// Converts the actuator to another scalar type; `function` receives each number with its parameter.
    pub fn map<T: Scalar>(&self, function: impl FnMut(&'static Parameter, S) -> T) -> Actuator<T> {
        self.convert(&mut ConvertEach(function))
    }

    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Actuator<T> {
        Actuator {
            law: Effective {
                law: self.law.law.convert(convert),
                effectiveness: self.law.effectiveness.convert(convert),
            },
            limits: self.limits.convert(convert),
            friction: self.friction.convert(convert),
            external_volume: convert.parameter(&parameter::EXTERNAL_VOLUME, self.external_volume),
            air: self.air.convert(convert),
            valve: self.valve.as_ref().map(|valve| valve.convert(convert)),
        }
    }

    /// The static force law with its effectiveness.
    #[inline(always)]
    pub fn law(&self) -> &Effective<Characteristic<S>, S> {
        &self.law
    }

    /// The length limits.
    #[inline(always)]
    pub fn limits(&self) -> &LengthLimits<S> {
        &self.limits
    }

    /// The friction.
    #[inline(always)]
    pub fn friction(&self) -> &Friction<S> {
        &self.friction
    }

    /// The air.
    #[inline(always)]
    pub fn air(&self) -> &Air<S> {
        &self.air
    }

    /// The valve, unless the actuator is sealed.
    #[inline(always)]
    pub fn valve(&self) -> Option<&Valve<S>> {
        self.valve.as_ref()
    }

    /// Gauge pressure at an absolute pressure in Pa.
    #[inline(always)]
    pub fn gauge<T: Over<S>>(&self, pressure: T) -> GaugePressure<T> {
        GaugePressure(pressure - T::of(self.air.atmosphere().0))
    }

    /// Static force `F_s` in N at an actuator length in m and an absolute pressure in Pa.
    #[inline(always)]
    pub fn static_force<T: Over<S>>(&self, length: T, pressure: T) -> T {
        self.law.force(length, self.gauge(pressure))
    }

    /// Secant stiffness `k_sec` of the static force in N/m (13), at an actuator length and an absolute pressure.
    #[inline(always)]
    pub fn secant_stiffness<T: Over<S>>(&self, length: T, pressure: T) -> T {
        self.law.secant_stiffness(length, T::of(self.limits.min_length()), self.gauge(pressure))
    }

    /// What presses the threads together at an actuator length and an absolute pressure.
    #[inline(always)]
    pub fn normal_load<T: Over<S>>(&self, length: T, pressure: T, touch: ThreadContact) -> NormalLoad<T> {
        NormalLoad::new(self.secant_stiffness(length, pressure), self.gauge(pressure).0, touch)
    }

    /// Coulomb force in N in motion, `Q k_sec` in the paper's law, at an actuator length and an absolute pressure.
    #[inline(always)]
    pub fn coulomb_bound<T: Over<S>>(&self, length: T, pressure: T) -> T {
        self.friction.coulomb().kinetic(self.normal_load(length, pressure, ThreadContact::ByPressure))
    }

    /// The least and the largest tension in N that can be held at rest, at an actuator length and absolute pressure:
    /// `F_s + F_limit + F_h ± Q k_sec` with the hysteresis and viscoelastic branches `F_h`, and any from zero up where it rests on
    /// the shortest length.
    #[inline(always)]
    pub fn holdable<T: Over<S>>(
        &self,
        length: T,
        pressure: T,
        on_the_stop: S::Mask,
        sliding: impl Into<SlidingState<T>>,
    ) -> (T, T) {
        let sliding = sliding.into();
        let pressing = self.normal_load(length, pressure, sliding.touch);
        let mut middle = self.static_force(length, pressure) + self.limits.force(length, T::zero());
        if let Some(held) = sliding.held_force(pressing) {
            middle = middle + held;
        }
        let coulomb = self.friction.coulomb();
        let bound = coulomb.holding(coulomb.kinetic(pressing));
        let least = T::select(on_the_stop, T::zero(), (middle - bound).larger(T::zero()));
        (least, (middle + bound).larger(T::zero()))
    }

    /// The sum of (12) for a given sliding state, for a given taut branch, and effectiveness and force of the law (N),
    /// before it is kept from pushing.
    #[inline(always)]
    pub fn signed_force<T: Over<S>>(
        &self,
        [length, velocity, pressure]: [T; 3],
        sliding: impl Into<SlidingState<T>>,
        taut: S::Mask,
        [effectiveness, law_force]: [T; 2],
    ) -> T {
        let limit = T::select(taut, self.limits.taut_force(length, velocity), T::zero());
        let mut force = effectiveness * law_force + limit + self.friction.viscous_force(velocity);
        if self.friction.follows_normal_load() {
            let gauge = self.gauge(pressure);
            let secant = self.law.law.secant_stiffness(length, T::of(self.limits.min_length()), gauge);
            let sliding = sliding.into();
            let pressing = NormalLoad::new(effectiveness * secant, gauge.0, sliding.touch);
            force = force + self.friction.pressed_force(sliding, velocity, pressing);
        }
        force
    }

    /// Effectiveness and force of the law in N, whose product is the static force (9).
    #[inline(always)]
    pub fn factors<T: Over<S>>(&self, length: T, pressure: T) -> [T; 2] {
        let gauge = self.gauge(pressure);
        [self.law.effectiveness.at(gauge), self.law.law.force(length, gauge)]
    }

    /// Force of the hysteresis over the secant stiffness in m, for the ends at `distance` (m) and `velocity` (m/s), if there is
    /// such a law.
    #[inline(always)]
    pub fn width<T: Over<S>>(&self, memory: &Memory<S>, distance: T, velocity: T) -> Option<T> {
        // No closure: it would be compiled separately, without the instructions of a batch.
        match self.friction.hysteresis() {
            Some(hysteresis) => Some(hysteresis.width(memory, self.limits.actuator_length(distance), velocity)),
            None => None,
        }
    }

    /// Takes the memory of the hysteresis on to where the ends are at `distance` (m) and `velocity` (m/s).
    #[inline(always)]
    pub fn remember(&self, memory: &mut Memory<S>, distance: S, velocity: S) {
        if let Some(hysteresis) = self.friction.hysteresis() {
            hysteresis.moved(memory, self.limits.actuator_length(distance), velocity);
        }
    }

    /// Tension in N for the ends at `distance` (m) and `velocity` (m/s), (12), without hysteresis: never negative, zero when
    /// slack.
    #[inline(always)]
    pub fn tension<T: Over<S>>(&self, distance: T, velocity: T, pressure: T) -> T {
        self.tension_sliding(distance, velocity, pressure, velocity.sign())
    }

    /// Tension in N for a given sliding state, for methods that keep the direction of sliding over a step.
    #[inline(always)]
    pub fn tension_sliding<T: Over<S>>(
        &self,
        distance: T,
        velocity: T,
        pressure: T,
        sliding: impl Into<SlidingState<T>>,
    ) -> T {
        let slack = self.limits.is_slack(distance);
        let taut =
            T::of(self.limits.max_length()).lt(distance) & T::zero().lt(self.limits.taut_force(distance, velocity));
        let ends = [self.limits.actuator_length(distance), velocity, pressure];
        let force = self.signed_force(ends, sliding, taut, self.factors(ends[0], pressure));
        T::select(slack, T::zero(), force.larger(T::zero()))
    }

    /// Volume of braid and hose in m³ for the ends at `distance`.
    #[inline(always)]
    pub fn volume<T: Over<S>>(&self, distance: T) -> T {
        self.law.law.volume(self.limits.actuator_length(distance)) + T::of(self.external_volume)
    }

    /// The contents at an instant. A slack actuator rests at its shortest: its volume does not change.
    #[inline(always)]
    pub fn chamber<T: Over<S>>(&self, distance: T, velocity: T, pressure: T, mass: T, slack: S::Mask) -> Chamber<T> {
        let length = T::select(slack, T::of(self.limits.min_length()), distance);
        let [volume, slope] = self.law.law.volume_and_slope(length);
        let volume = volume + T::of(self.external_volume);
        Chamber::new(pressure, mass, volume, T::select(slack, T::zero(), slope * velocity))
    }

    /// `dP/dt` in Pa/s for a flow through the valve.
    #[inline(always)]
    pub fn pressure_rate<T: Over<S>>(&self, chamber: &Chamber<T>, flow: &Flow<T>) -> T {
        let inflow = self.valve.as_ref().map_or(T::one(), |valve| T::of(valve.supply.temperature()));
        self.air.pressure_rate(chamber, flow, inflow)
    }

    /// Flow through the paths whose masks are set.
    #[inline(always)]
    pub fn flow<T: Over<S>>(&self, chamber: &Chamber<T>, supply: S::Mask, exhaust: S::Mask) -> Flow<T> {
        let Some(valve) = &self.valve else { return Flow::none() };
        valve.open_flow(chamber, supply, exhaust)
    }

    /// The modular actuator: its tension, the tension's derivatives, and the rates of its state, for the ends at
    /// `distance` (m) moving apart at `velocity` (m/s) with the flow paths of `ports` open.
    ///
    /// At rest the Coulomb force is set-valued; this returns its middle, zero. The memory of a hysteresis is taken on by
    /// [`Actuator::remember`] once the ends have moved. Viscoelastic branches, which are states of a
    /// [plant](crate::plant), are relaxed here and add nothing.
    pub fn respond(&self, state: &ActuatorState<S>, distance: S, velocity: S, ports: Ports) -> Response<S> {
        let [length, rate, pressure] = [distance, velocity, state.pressure.0];
        let [end, speed]: [Dual<S, 2>; 2] = [Dual::variable(length, 0), Dual::variable(rate, 1)];
        let sliding = SlidingState { width: self.width(&state.memory, end, speed), ..speed.sign().into() };
        let force = self.tension_sliding(end, speed, Dual::of(pressure), sliding);
        let [end, speed]: [Dual<S, 1>; 2] = [Dual::of(length), Dual::of(rate)];
        let sliding = SlidingState { width: self.width(&state.memory, end, speed), ..speed.sign().into() };
        let by_pressure = self.tension_sliding(end, speed, Dual::variable(pressure, 0), sliding);
        let chamber = self.chamber(distance, velocity, pressure, state.air_mass, self.limits.is_slack(distance));
        let flow = self.flow(&chamber, S::Mask::splat(ports.supply), S::Mask::splat(ports.exhaust));
        Response {
            tension: force.value,
            per_length: force.slope[0],
            per_velocity: force.slope[1],
            per_pressure: by_pressure.slope[0],
            pressure_rate: self.pressure_rate(&chamber, &flow),
            mass_flow: flow.net(),
            temperature: self.air.temperature(&chamber),
            volume: chamber.volume,
        }
    }

    /// Stiffness `∂F_s/∂L` in N/m at constant pressure, (7).
    pub fn stiffness(&self, length: S, pressure: AbsolutePressure<S>) -> S {
        let force: Dual<S, 1> = self.static_force(Dual::variable(length, 0), Dual::of(pressure.0));
        force.slope[0]
    }

    /// Stiffness in N/m with the valve shut, (5) with its first term: the pressure follows the volume,
    /// `dP/dL = −κ P (dV/dL)/V`. For the energy balance κ = γ: a change too quick for heat.
    pub fn sealed_stiffness(&self, length: S, pressure: AbsolutePressure<S>) -> S {
        let volume: Dual<S, 1> = self.volume(Dual::variable(length, 0));
        let pressure_slope = -self.air.index() * pressure.0 * volume.slope[0] / volume.value;
        let force: Dual<S, 1> =
            self.static_force(Dual::variable(length, 0), Dual { value: pressure.0, slope: [pressure_slope] });
        force.slope[0]
    }
}
