//! The muscle on its load in plain `f64`, as a user of an ODE crate writes it: the physics and the modes of `muscle.c`.

use crate::problem::{Port, Problem};
use std::f64::consts::PI;

/// Length, velocity, pressure, air mass.
pub type State = [f64; 4];

/// The pieces of the flow law in order of rising pressure in the actuator: choked, subsonic and laminar inflow, then
/// laminar, subsonic and choked outflow.
const LAST_ZONE: usize = 5;

/// Where the length lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthRegime {
    /// Below the shortest length.
    Slack,
    /// Between the limits.
    Free,
    /// Beyond the longest length.
    Taut,
    /// Taut, but shortening too fast for the braid to pull.
    Rebound,
}

/// Which formulas hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    port: Port,
    zone: usize,
    length_regime: LengthRegime,
    /// +1 lengthening, −1 shortening, 0 stuck.
    sliding: f64,
    clamped: bool,
}

/// Number of guards; those that a mode does not have are constantly positive.
pub const GUARDS: usize = 8;
const PRESSURE_DOWN: usize = 0;
const PRESSURE_UP: usize = 1;
const LENGTH_LOW: usize = 2;
const LENGTH_HIGH: usize = 3;
const VELOCITY_ZERO: usize = 4;
const TENSION_ZERO: usize = 5;
const BREAK_LONGER: usize = 6;
const BREAK_SHORTER: usize = 7;

/// Parameters in SI and what follows from them.
pub struct Muscle {
    thread_length: f64,
    min_length: f64,
    max_length: f64,
    external_volume: f64,
    viscous: f64,
    coulomb_width: f64,
    stiffness: f64,
    damping: f64,
    gamma: f64,
    gas_constant: f64,
    atmosphere: f64,
    supply: f64,
    temperature: f64,
    mass: f64,
    pull: f64,
    inverse_turns: f64,
    throat: f64,
    choked: f64,
    laminar_slope: f64,
    bounds: [[f64; LAST_ZONE]; 2],
    band: f64,
    force_band: f64,
}

impl Muscle {
    /// The muscle of a problem; formulas that agree at their border are kept until it is passed by `tolerance`.
    pub fn new(problem: &Problem, tolerance: f64) -> Self {
        let numbers = problem.numbers();
        let number = |name: &str| numbers.iter().find(|(other, _)| *other == name).map_or(f64::NAN, |entry| entry.1);
        let (gamma, gas_constant, area) = (number("gamma"), number("gas_constant"), number("area"));
        let (atmosphere, supply, laminar) = (number("atmosphere"), number("supply"), number("laminar_ratio"));
        let critical = (2.0 / (gamma + 1.0)).powf(gamma / (gamma - 1.0));
        let throat = area * (2.0 * gamma / (gas_constant * (gamma - 1.0))).sqrt();
        let at_laminar = (laminar.powf(2.0 / gamma) - laminar.powf((gamma + 1.0) / gamma)).sqrt();
        let band = tolerance.max(1e-12);
        Self {
            thread_length: number("thread_length"),
            min_length: number("min_length"),
            max_length: number("max_length"),
            external_volume: number("external_volume"),
            viscous: number("viscous"),
            coulomb_width: number("coulomb_width"),
            stiffness: number("stiffness"),
            damping: number("damping"),
            gamma,
            gas_constant,
            atmosphere,
            supply,
            temperature: number("temperature"),
            mass: number("mass"),
            pull: number("pull"),
            inverse_turns: 1.0 / (4.0 * PI * number("turns").powi(2)),
            throat,
            choked: area * (gamma / gas_constant * (2.0 / (gamma + 1.0)).powf((gamma + 1.0) / (gamma - 1.0))).sqrt(),
            laminar_slope: throat * at_laminar / (1.0 - laminar),
            bounds: [supply, atmosphere].map(|p| [p * critical, p * laminar, p, p / laminar, p / critical]),
            band,
            force_band: band * number("pull"),
        }
    }

    #[inline]
    fn static_force(&self, length: f64, pressure: f64) -> f64 {
        let bracket = 3.0 * length * length - self.thread_length * self.thread_length;
        (pressure - self.atmosphere) * bracket * self.inverse_turns
    }

    #[inline]
    fn coulomb(&self, length: f64, pressure: f64) -> f64 {
        let gauge = (pressure - self.atmosphere).max(0.0);
        self.coulomb_width * 3.0 * gauge * (length + self.min_length) * self.inverse_turns
    }

    #[inline]
    fn limit(&self, length: f64, velocity: f64) -> f64 {
        self.stiffness * (length - self.max_length) + self.damping * velocity
    }

    #[inline]
    fn force(&self, mode: &Mode, &[length, velocity, pressure, _]: &State) -> f64 {
        let force = self.static_force(length, pressure)
            + self.viscous * velocity
            + mode.sliding * self.coulomb(length, pressure);
        if mode.length_regime == LengthRegime::Taut { force + self.limit(length, velocity) } else { force }
    }

    /// (21)(23): flow over `√T_up` in a zone, between two pressures.
    #[inline]
    fn flow(&self, zone: usize, up: f64, down: f64) -> f64 {
        match zone {
            0 | LAST_ZONE => self.choked * up,
            2 | 3 => self.laminar_slope * (up - down),
            _ => {
                let ratio = down / up;
                let root = ratio.powf(1.0 / self.gamma);
                // Continued as an odd function where a trial stage has a ratio above 1.
                let under = root * (root - ratio);
                self.throat * up * under.abs().sqrt().copysign(under)
            }
        }
    }

    /// The right-hand side in a mode.
    #[inline]
    pub fn rates(&self, mode: &Mode, state: &State) -> State {
        let &[length, velocity, pressure, mass] = state;
        let (slack, stuck) = (mode.length_regime == LengthRegime::Slack, mode.sliding == 0.0);
        let (length, moving) = if slack { (self.min_length, 0.0) } else { (length, velocity) };
        let (thread2, length2) = (self.thread_length * self.thread_length, length * length);
        let volume = length * (thread2 - length2) * self.inverse_turns + self.external_volume;
        let volume_rate = (thread2 - 3.0 * length2) * self.inverse_turns * if stuck { 0.0 } else { moving };
        let beyond = if mode.port == Port::Supply { self.supply } else { self.atmosphere };
        let net = match mode.port {
            Port::Closed => 0.0,
            _ if mode.zone <= 2 => self.flow(mode.zone, beyond, pressure) / self.temperature.sqrt(),
            _ => {
                let temperature = pressure * volume / (mass * self.gas_constant);
                -self.flow(mode.zone, pressure, beyond) / temperature.sqrt()
            }
        };
        let pressure_rate = self.gamma * pressure * (net / mass - volume_rate / volume);
        if stuck {
            return [0.0, 0.0, pressure_rate, net];
        }
        let tension = if slack || mode.clamped { 0.0 } else { self.force(mode, state) };
        [velocity, (self.pull - tension) / self.mass, pressure_rate, net]
    }

    fn holdable(&self, length: f64, pressure: f64) -> (f64, f64) {
        let bound = self.coulomb(length, pressure);
        let middle = self.static_force(length, pressure) + self.limit(length, 0.0).max(0.0);
        let least = if length <= self.min_length { 0.0 } else { (middle - bound).max(0.0) };
        (least, (middle + bound).max(0.0))
    }

    /// The guards of a mode, positive while it lasts.
    #[inline]
    pub fn guards(&self, mode: &Mode, state: &State) -> [f64; GUARDS] {
        let &[length, velocity, pressure, _] = state;
        let mut guards = [1.0; GUARDS];
        if mode.port != Port::Closed {
            let bounds = &self.bounds[mode.port as usize];
            if mode.zone > 0 {
                guards[PRESSURE_DOWN] = pressure - bounds[mode.zone - 1] * (1.0 - self.band);
            }
            if mode.zone < LAST_ZONE {
                guards[PRESSURE_UP] = bounds[mode.zone] * (1.0 + self.band) - pressure;
            }
        }
        if mode.length_regime == LengthRegime::Slack {
            guards[LENGTH_LOW] = self.min_length - length;
            return guards;
        }
        if mode.sliding == 0.0 {
            let (least, most) = self.holdable(length, pressure);
            guards[BREAK_LONGER] = most + self.force_band - self.pull;
            guards[BREAK_SHORTER] = self.pull - least + self.force_band;
            return guards;
        }
        guards[VELOCITY_ZERO] = mode.sliding * velocity;
        match mode.length_regime {
            LengthRegime::Taut => guards[LENGTH_HIGH] = self.limit(length, velocity),
            LengthRegime::Rebound => {
                guards[LENGTH_LOW] = length - self.max_length;
                guards[LENGTH_HIGH] = -self.limit(length, velocity);
            }
            _ => {
                guards[LENGTH_LOW] = length - self.min_length;
                guards[LENGTH_HIGH] = self.max_length - length;
            }
        }
        let sign = if mode.clamped { -1.0 } else { 1.0 };
        guards[TENSION_ZERO] = sign * self.force(mode, state) + self.force_band;
        guards
    }

    fn clamp(&self, mode: &mut Mode, state: &State) {
        let moves = mode.length_regime != LengthRegime::Slack && mode.sliding != 0.0;
        mode.clamped = moves && self.force(mode, state) < 0.0;
    }

    fn slide(&self, sliding: f64, mode: &mut Mode, state: &State) {
        mode.sliding = sliding;
        if sliding < 0.0 && state[0] <= self.min_length {
            mode.length_regime = LengthRegime::Slack;
        }
        self.clamp(mode, state);
    }

    fn rest_or_slide(&self, mode: &mut Mode, state: &State) {
        let (least, most) = self.holdable(state[0], state[2]);
        let sliding = if self.pull > most + self.force_band {
            1.0
        } else if self.pull < least - self.force_band {
            -1.0
        } else {
            0.0
        };
        self.slide(sliding, mode, state);
    }

    fn rests_on_the_stop(&self, state: &State) -> bool {
        let most = self.holdable(state[0], state[2]).1;
        let acceleration = self.pull.min(most - self.pull) / self.mass;
        acceleration > 0.0 && state[1] * state[1] <= 2.0 * acceleration * self.band * self.max_length
    }

    /// Opens a flow path.
    pub fn open(&self, port: Port, mode: &mut Mode, state: &State) {
        mode.port = port;
        mode.zone = match port {
            Port::Closed => 0,
            _ => self.bounds[port as usize].iter().filter(|bound| state[2] > **bound).count(),
        };
    }

    /// The mode at the start.
    pub fn begin(&self, port: Port, state: &State) -> Mode {
        let sliding = if state[1] < 0.0 { -1.0 } else { 1.0 };
        let mut mode = Mode { port, zone: 0, length_regime: LengthRegime::Free, sliding, clamped: false };
        self.open(port, &mut mode, state);
        if state[0] > self.max_length {
            let pulls = self.limit(state[0], state[1]) >= 0.0;
            mode.length_regime = if pulls { LengthRegime::Taut } else { LengthRegime::Rebound };
        } else if state[0] < self.min_length {
            mode.length_regime = LengthRegime::Slack;
        }
        if state[1] == 0.0 && mode.length_regime != LengthRegime::Slack {
            self.rest_or_slide(&mut mode, state);
        }
        self.clamp(&mut mode, state);
        mode
    }

    /// What follows when a guard has come down to zero.
    pub fn cross(&self, guard: usize, mode: &mut Mode, state: &mut State) {
        match guard {
            PRESSURE_DOWN => mode.zone -= 1,
            PRESSURE_UP => mode.zone += 1,
            LENGTH_LOW if mode.length_regime == LengthRegime::Rebound => {
                state[0] = self.max_length;
                mode.length_regime = LengthRegime::Free;
                self.clamp(mode, state);
            }
            LENGTH_LOW => {
                state[0] = self.min_length;
                if self.rests_on_the_stop(state) {
                    state[1] = 0.0;
                    mode.length_regime = LengthRegime::Free;
                    self.slide(0.0, mode, state);
                } else if mode.length_regime == LengthRegime::Free {
                    mode.length_regime = LengthRegime::Slack;
                    self.clamp(mode, state);
                } else {
                    mode.length_regime = LengthRegime::Free;
                    self.slide(1.0, mode, state);
                }
            }
            LENGTH_HIGH => {
                if mode.length_regime == LengthRegime::Free {
                    state[0] = self.max_length;
                }
                mode.length_regime =
                    if mode.length_regime == LengthRegime::Taut { LengthRegime::Rebound } else { LengthRegime::Taut };
                self.clamp(mode, state);
            }
            VELOCITY_ZERO => {
                state[1] = 0.0;
                self.rest_or_slide(mode, state);
            }
            TENSION_ZERO => mode.clamped = !mode.clamped,
            BREAK_LONGER => self.slide(1.0, mode, state),
            _ => self.slide(-1.0, mode, state),
        }
    }
}
