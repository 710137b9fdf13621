//! Shared by the tests: the paper's rig with every number open to change, and a comparison that says what it compared.
#![allow(dead_code)]

pub(crate) mod accounts;
pub(crate) mod joint;
pub(crate) mod laws;
pub(crate) mod plants;
pub(crate) mod random;
pub(crate) mod random_plants;
pub(crate) mod regulated;
pub(crate) mod steps;
pub(crate) mod tendon;

use mckibben::air::{Air, Process};
use mckibben::force::{Characteristic, Effective, Effectiveness, IdealBraid, LengthLimits};
use mckibben::friction::{Coulomb, Friction, Hysteresis, Viscoelastic};
use mckibben::load::Load;
use mckibben::parameter::Parameter;
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{Actuation, Initial, InitialLength, Rig, State, simulate};
use mckibben::valve::{
    Command, ExhaustTemperature, FlowLaw, FlowStandard, Port, Request, Solenoid, Supply, Valve, ValveKind,
};
use mckibben::{AbsolutePressure, Actuator, Braid, Dual, GaugePressure, Over, Scalar};

/// One inch in m.
pub(crate) const INCH: f64 = 0.0254;
/// One pound-force in N.
pub(crate) const LBF: f64 = 4.448_221_615_260_5;
/// One pound in kg.
pub(crate) const LB: f64 = 0.453_592_37;
/// One pound-force per square inch in Pa.
pub(crate) const PSI: f64 = LBF / (INCH * INCH);
/// Standard gravity in m/s².
pub(crate) const GRAVITY: f64 = 9.80665;
/// Standard atmosphere in Pa.
pub(crate) const ATMOSPHERE: f64 = 101_325.0;
/// Room temperature in K.
pub(crate) const ROOM: f64 = 293.15;

/// A rig in plain numbers: the paper's actuator, valve and a 5 lb mass, unless changed.
#[derive(Clone, Debug)]
pub(crate) struct Paper {
    pub(crate) thread_length: f64,
    pub(crate) turns: f64,
    pub(crate) min_length: Option<f64>,
    pub(crate) max_length: f64,
    pub(crate) limit_stiffness: f64,
    pub(crate) limit_damping: f64,
    /// The ideal braid when `None`.
    pub(crate) characteristic: Option<Characteristic>,
    pub(crate) effectiveness: Effectiveness,
    pub(crate) viscous: f64,
    pub(crate) coulomb_width: f64,
    pub(crate) coulomb: Option<Coulomb>,
    pub(crate) hysteresis: Option<Hysteresis>,
    /// Structural damping in s.
    pub(crate) structural: f64,
    pub(crate) viscoelastic: Option<Viscoelastic>,
    pub(crate) external_volume: f64,
    pub(crate) gas_constant: f64,
    pub(crate) heat_capacity_ratio: f64,
    pub(crate) process: Process,
    pub(crate) supply_gauge: f64,
    pub(crate) supply_temperature: f64,
    pub(crate) standard: FlowStandard,
    pub(crate) exhaust: Option<FlowStandard>,
    pub(crate) efficiency: f64,
    pub(crate) laminar_ratio: f64,
    pub(crate) exhaust_temperature: ExhaustTemperature,
    pub(crate) kind: ValveKind,
    pub(crate) delays: (f64, f64),
    pub(crate) command: Option<Command>,
    pub(crate) load: Load,
    pub(crate) gauge: f64,
    pub(crate) temperature: f64,
    pub(crate) length: InitialLength,
    pub(crate) velocity: f64,
}

impl Paper {
    /// The paper's rig, sealed, at atmospheric pressure and in equilibrium.
    pub(crate) fn sealed() -> Self {
        Self {
            thread_length: 4.3218 * INCH,
            turns: 2.5,
            min_length: None,
            max_length: 3.85 * INCH,
            limit_stiffness: 1.75e5,
            limit_damping: 100.0,
            characteristic: None,
            effectiveness: Effectiveness::Constant(1.0),
            viscous: 0.02 * LBF / INCH,
            coulomb_width: 0.0044 * INCH,
            coulomb: None,
            hysteresis: None,
            structural: 0.0,
            viscoelastic: None,
            external_volume: 3e-6,
            gas_constant: 286.99,
            heat_capacity_ratio: 1.4,
            process: Process::Isentropic,
            supply_gauge: 100.0 * PSI,
            supply_temperature: ROOM,
            standard: FlowStandard::Orifice { flow_area: 1.8e-5 * 0.3048 * 0.3048 },
            exhaust: None,
            efficiency: 0.85,
            laminar_ratio: 0.999,
            exhaust_temperature: ExhaustTemperature::Actuator,
            kind: ValveKind::ThreeWay,
            delays: (4e-3, 1e-3),
            command: None,
            load: Load::HangingMass { mass: 5.0 * LB, gravity: GRAVITY },
            gauge: 0.0,
            temperature: ROOM,
            length: InitialLength::Equilibrium,
            velocity: 0.0,
        }
    }

    /// The paper's rig on its three-way valve under a command.
    pub(crate) fn driven(command: Command) -> Self {
        Self::sealed().with(|rig| rig.command = Some(command))
    }

    /// The paper's rig under pulse-width modulation of fill and exhaust.
    pub(crate) fn pwm(frequency: f64, duty: f64) -> Self {
        Self::driven(Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("a command"))
    }

    /// Makes a change.
    pub(crate) fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// Sets the process of the air.
    pub(crate) fn process(self, process: Process) -> Self {
        self.with(|rig| rig.process = process)
    }

    /// Sets viscous friction in N·s/m and the Coulomb friction length in m.
    pub(crate) fn friction(self, viscous: f64, coulomb_width: f64) -> Self {
        self.with(|rig| (rig.viscous, rig.coulomb_width) = (viscous, coulomb_width))
    }

    /// Hangs a mass in kg on the actuator.
    pub(crate) fn mass(self, mass: f64) -> Self {
        self.with(|rig| rig.load = Load::HangingMass { mass, gravity: GRAVITY })
    }

    /// Holds both ends at a length in m.
    pub(crate) fn isometric(self, length: f64) -> Self {
        self.with(|rig| (rig.load, rig.length) = (Load::Isometric, InitialLength::At(length)))
    }

    /// Starts at a gauge pressure in Pa.
    pub(crate) fn gauge(self, gauge: f64) -> Self {
        self.with(|rig| rig.gauge = gauge)
    }

    /// Starts at a length in m with a velocity in m/s.
    pub(crate) fn from(self, length: f64, velocity: f64) -> Self {
        self.with(|rig| (rig.length, rig.velocity) = (InitialLength::At(length), velocity))
    }

    pub(crate) fn braid(&self) -> Braid {
        Braid::new(self.thread_length, self.turns).expect("a braid")
    }

    pub(crate) fn air(&self) -> Air {
        Air::new(self.gas_constant, self.heat_capacity_ratio, AbsolutePressure(ATMOSPHERE), self.process)
            .expect("a gas")
    }

    pub(crate) fn flow_law(&self) -> FlowLaw {
        FlowLaw::new(self.standard, self.efficiency, self.laminar_ratio, &self.air()).expect("a flow law")
    }

    pub(crate) fn valve(&self) -> Valve {
        let air = self.air();
        let supply = Supply::new(GaugePressure(self.supply_gauge), self.supply_temperature, &air).expect("a supply");
        let valve = Valve::new(self.flow_law(), supply, self.exhaust_temperature, &air);
        let own = |standard| FlowLaw::of_flow_path(Port::Exhaust, standard, self.efficiency, self.laminar_ratio, &air);
        self.exhaust.map_or(valve, |standard| valve.with_exhaust(own(standard).expect("a flow law")))
    }

    /// The actuator, with its valve when there is a command.
    pub(crate) fn actuator(&self) -> Actuator {
        let braid = self.braid();
        let limits =
            LengthLimits::new(&braid, self.min_length, self.max_length, self.limit_stiffness, self.limit_damping)
                .expect("limits");
        let law = self.characteristic.clone().unwrap_or(IdealBraid { braid }.into());
        let law = Effective { law, effectiveness: self.effectiveness };
        let coulomb = self.coulomb.unwrap_or_else(|| Coulomb::new(self.coulomb_width).expect("dry friction"));
        let friction = Friction::with_coulomb(self.viscous, coulomb).expect("a friction");
        let friction = friction.with_structural_damping(self.structural).expect("a damping");
        let friction = self.hysteresis.map_or(friction, |law| friction.with_hysteresis(law));
        let friction = self.viscoelastic.map_or(friction, |law| friction.with_viscoelastic(law));
        let actuator = Actuator::new(law, limits, friction, self.external_volume, self.air()).expect("an actuator");
        if self.command.is_some() { actuator.with_valve(self.valve()) } else { actuator }
    }

    pub(crate) fn rig(&self) -> Rig {
        let actuation = self.command.clone().map(|command| Actuation {
            solenoid: Solenoid::new(self.kind, self.delays.0, self.delays.1).expect("a solenoid"),
            command,
        });
        Rig::new(self.actuator(), actuation, self.load.clone()).expect("a rig")
    }

    pub(crate) fn initial(&self) -> Initial {
        Initial {
            gauge_pressure: GaugePressure(self.gauge),
            temperature: self.temperature,
            length: self.length,
            velocity: self.velocity,
        }
    }

    pub(crate) fn start(&self) -> State {
        self.rig().start(&self.initial()).expect("a start")
    }

    pub(crate) fn run(&self, duration: f64, relative_tolerance: f64) -> RigTrajectory {
        simulate(&self.rig(), self.start(), duration, relative_tolerance).expect("the run reaches its end")
    }

    /// Length in m at which the ideal braid holds `pull` N at the initial gauge pressure, (3) solved for L.
    pub(crate) fn balance(&self, pull: f64) -> f64 {
        let (b, n) = (self.thread_length, self.turns);
        ((b * b + 4.0 * std::f64::consts::PI * n * n * pull / self.gauge) / 3.0).sqrt()
    }
}

/// Asserts that two numbers agree to a relative tolerance.
#[track_caller]
pub(crate) fn assert_close(actual: f64, expected: f64, relative: f64) {
    assert_within(actual, expected, relative * expected.abs());
}

/// Asserts that two numbers agree to an absolute tolerance.
#[track_caller]
pub(crate) fn assert_within(actual: f64, expected: f64, absolute: f64) {
    let difference = (actual - expected).abs();
    assert!(difference <= absolute, "{actual:e} is not {expected:e}: off by {difference:e}, allowed {absolute:e}");
}

/// What the stable method of the fixed-step engine may be off by, in the unit of `amplitude`, after `duration` s at steps of
/// `step` s, of a swing whose stiffest spring makes `omega` 1/s. Its stability function is e^z + c z³ with
/// c = 3γ² − 2γ³ − 1/6 to leading order, γ = 1 + 1/√2: a step errs by c (ωh)³ of the amplitude, and the errors of T/h steps add
/// up at most.
pub(crate) fn stable_error(omega: f64, step: f64, duration: f64, amplitude: f64) -> f64 {
    let gamma = 1.0 + std::f64::consts::FRAC_1_SQRT_2;
    let constant = 3.0 * gamma.powi(2) - 2.0 * gamma.powi(3) - 1.0 / 6.0;
    constant.abs() * omega.powi(3) * step.powi(2) * duration * amplitude
}

/// Derivative by the central five-point rule, of fourth order in `step`.
pub(crate) fn slope(step: f64, function: impl Fn(f64) -> f64) -> f64 {
    let pair = |h: f64| function(h) - function(-h);
    (8.0 * pair(step) - pair(2.0 * step)) / (12.0 * step)
}

pub(crate) use mckibben::Seeded;

/// A number that changes by a slope in the first direction.
pub(crate) fn toward(value: f64, slope: f64) -> Seeded {
    Dual::constant(value) + Dual::variable(0.0, 0) * Dual::constant(slope)
}

/// A rig with one direction of change: that of all numbers which a row describes, each by its own size.
pub(crate) fn seeded(rig: &Rig, row: &'static Parameter) -> Rig<Seeded> {
    rig.map(|parameter, value| {
        let factor = if std::ptr::eq(parameter, row) { Dual::variable(1.0, 0) } else { Dual::constant(1.0) };
        Dual::of(value) * factor
    })
}

/// The rig moved a `relative` part of those numbers in that direction.
pub(crate) fn scaled(rig: &Rig, row: &'static Parameter, relative: f64) -> Rig {
    rig.map(|parameter, value| if std::ptr::eq(parameter, row) { value * (1.0 + relative) } else { value })
}

/// One step of the classical Runge–Kutta method; rates by the time since its start, and the state.
pub(crate) fn runge_kutta<const N: usize>(
    state: [f64; N],
    step: f64,
    rates: impl Fn(f64, [f64; N]) -> [f64; N],
) -> [f64; N] {
    let at = |part: f64, k: [f64; N]| rates(part * step, std::array::from_fn(|i| state[i] + part * step * k[i]));
    let k1 = rates(0.0, state);
    let k2 = at(0.5, k1);
    let k3 = at(0.5, k2);
    let k4 = at(1.0, k3);
    std::array::from_fn(|i| state[i] + step / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
}

/// Root of a function that changes sign between two places, by bisection to rounding.
pub(crate) fn bisect(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    let rises = function(high) > 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if (function(middle) > 0.0) == rises {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

/// Numbers that look random and are the same in every run, evenly spread over `[0, 1)` (a Weyl sequence per column).
pub(crate) fn spread(row: usize, column: usize) -> f64 {
    const ROOTS: [f64; 8] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0];
    ((row as f64 + 1.0) * ROOTS[column].sqrt()).fract()
}

/// A number between two ends.
pub(crate) fn between(row: usize, column: usize, low: f64, high: f64) -> f64 {
    low + (high - low) * spread(row, column)
}
