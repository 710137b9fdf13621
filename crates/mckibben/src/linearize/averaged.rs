//! The valve under PWM by its mean flow over a period.
//!
//! ```text
//! dP/dt, dm/dt  by  Σ sᵢ ṁᵢ(P, m)        sᵢ the share of the period in which the passages stand open as i says
//! s_supply = d − (t_open − t_close) f     for a three-way valve, between t_open f ≤ d ≤ 1 − t_close f
//!
//! in balance     Σ sᵢ ṁᵢ = 0;   energy balance: also  γ R (T_in ṁ_in − T ṁ_out) + (γ−1) h A (T_wall − T) = 0
//! ripple         ΔP = (∂Ṗ/∂ṁ) · (greatest − least of ∫(ṁᵢ − mean) dt over a period), at a fixed length
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | d | `duty`, as commanded | – |
//! | f | `frequency` | Hz |
//! | sᵢ | `share` | – |
//! | ΔP | `pressure_ripple` | Pa, peak to peak |
//!
//! The shares come from the solenoid's own clock ([`SeatClock`](crate::valve::SeatClock)) run over dual numbers, so their
//! slope in d is exact and a pulse too short to open the valve has none.
//!
//! Valid while the duty lies in `duty_range`, while the period is short against the model's time constants, and while the
//! ripple is smaller than the way to the nearer of supply and exhaust (`ripple_is_small`): the mean of simulated cycles then
//! lies within 0.1 ΔP of the balance. Each is reported, none is enforced.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.3; averaging: Sanders & Verhulst, Averaging Methods in Nonlinear
//! Dynamical Systems (1985). Checked by `tests/linearize_pwm.rs`.

use super::Linearization;
use super::point::{self, Balance, Content, OperatingPoint};
use super::rates::mean_flow;

use crate::air::{Chamber, Flow, Process};
use crate::convert::Anew;
use crate::dual::Dual;
use crate::error::Error;
use crate::parameter;
use crate::pressure::AbsolutePressure;
use crate::root;
use crate::scalar::Scalar;
use crate::simulation::{Actuation, Rig};
use crate::valve::{Command, Interval, Port, Ports, Valve, duty_range, period, with_duty};
use alloc::vec::Vec;

/// A valve under PWM, on average.
#[derive(Clone, Debug)]
pub struct Averaged {
    /// Frequency f in Hz.
    pub frequency: f64,
    /// Commanded duty d.
    pub duty: f64,
    /// One period of the seats, from the instant at which the pulse is commanded.
    pub intervals: Vec<Interval>,
    /// Mean flow through the valve, into the actuator and out of it, in kg/s each.
    pub flow: Flow,
    /// Peak to peak ripple of the pressure in Pa, at a fixed length.
    pub pressure_ripple: f64,
    /// Pressure in Pa from the operating point to the nearer of supply and exhaust.
    pub pressure_margin: f64,
    /// Commanded duties between which every pulse and every gap moves the seats.
    pub duty_range: (f64, f64),
    actuation: Actuation,
}

impl Averaged {
    fn new(pwm: &Pwm<'_>, point: &OperatingPoint, duty: f64) -> Self {
        let intervals = pwm.seats(duty);
        let actuator = point.rig.actuator();
        let chamber = point.chamber();
        let flow = mean_flow(actuator, &chamber, &intervals);
        // The air mass beside its mean, at the ends of the intervals.
        let (mut beside, mut least, mut greatest) = (0.0_f64, 0.0_f64, 0.0_f64);
        for Interval { ports, share, .. } in &intervals {
            let net = actuator.flow(&chamber, ports.supply, ports.exhaust).net();
            beside += (net - flow.net()) * share / pwm.frequency;
            (least, greatest) = (least.min(beside), greatest.max(beside));
        }
        let rate = |flow| actuator.pressure_rate(&chamber, &flow);
        let pressure = point.state.pressure.0;
        let [supply, exhaust] = [Port::Supply, Port::Exhaust].map(|port| pwm.valve.port_pressure(port));
        let per_mass = rate(Flow { inward: 1.0, outward: 0.0 }) - rate(Flow::none());
        Self {
            frequency: pwm.frequency,
            duty,
            intervals,
            flow,
            pressure_ripple: per_mass * (greatest - least),
            pressure_margin: f64::min((supply - pressure).abs(), (exhaust - pressure).abs()),
            duty_range: pwm.duty_range,
            actuation: pwm.actuation.clone(),
        }
    }

    /// Share of the period in which the passage to the supply is open.
    pub fn supply_share(&self) -> f64 {
        self.intervals.iter().filter(|interval| interval.ports.supply).map(|interval| interval.share).sum()
    }

    /// Amplitude in kg/s of the first harmonic of the flow through the valve, at constant pressure.
    #[cfg(feature = "analysis")]
    pub(super) fn fundamental(&self, point: &OperatingPoint) -> f64 {
        use core::f64::consts::{PI, TAU};
        let actuator = point.rig.actuator();
        let chamber = point.chamber();
        let (mut cosine, mut sine, mut from) = (0.0, 0.0, 0.0);
        for Interval { ports, share, .. } in &self.intervals {
            let net = actuator.flow(&chamber, ports.supply, ports.exhaust).net();
            let (begin, end) = (TAU * from, TAU * (from + share));
            cosine += net * (end.sin() - begin.sin()) / PI;
            sine += net * (begin.cos() - end.cos()) / PI;
            from += share;
        }
        f64::hypot(cosine, sine)
    }

    /// Whether every pulse and every gap moves the seats.
    pub fn follows(&self) -> bool {
        (self.duty_range.0..=self.duty_range.1).contains(&self.duty)
    }

    /// Whether the ripple is smaller than the way to the nearer of supply and exhaust, so that the flow keeps its direction
    /// and about its size through a period.
    pub fn ripple_is_small(&self) -> bool {
        self.pressure_ripple < self.pressure_margin
    }

    /// The same period with the slopes of its shares by the duty, which is the direction `duty` of a differentiation.
    pub(super) fn seats<const N: usize>(&self, duty: usize) -> Vec<Interval<Dual<f64, N>>> {
        let solenoid = self.actuation.solenoid.convert(&mut Anew(|_: &'static _, value| Dual::constant(value)));
        let pulses = with_duty(&self.actuation.command, Dual::variable(self.duty, duty));
        pulses.and_then(|pulses| period(&solenoid, &pulses)).unwrap_or_default()
    }
}

/// What of the averaged valve is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// The commanded duty, which gives the pressure; the length follows from the rig's load.
    Duty(f64),
    /// The commanded duty and a length in m; the load follows, unless both ends are held.
    DutyAtLength(f64, f64),
    /// A balance, which gives the pressure; the duty follows.
    Balance(Balance),
}

/// Linearises a rig under PWM by the mean flow of its valve; duty and mass flow are inputs.
///
/// # Errors
/// [`Error::Misuse`] when the command is no PWM; [`Error::NotImplemented`] when the seats take their time; [`Error::NoSolution`]
/// when no air ever flows, or no duty in the range of the seats holds the pressure; and as [`OperatingPoint::held`].
pub fn average(rig: &Rig, aim: Aim, content: Content) -> Result<Linearization, Error> {
    let pwm = Pwm::of(rig)?;
    let (point, duty) = match aim {
        Aim::Duty(duty) | Aim::DutyAtLength(duty, _) => {
            let seats = pwm.seats(parameter::DUTY.check(duty)?);
            let (pressure, content) = pwm.steady(content, |content| pwm.pressure(&seats, content))?;
            let gauge = AbsolutePressure(pressure).gauge(rig.actuator().air().atmosphere());
            let balance = match aim {
                Aim::DutyAtLength(_, length) => Balance::AtBoth(gauge, length),
                _ => Balance::AtPressure(gauge),
            };
            let (rig, pressure, length) = point::balanced(rig, balance)?;
            (OperatingPoint::filled(rig, pressure, length, content)?, duty)
        }
        Aim::Balance(balance) => {
            let (rig, pressure, length) = point::balanced(rig, balance)?;
            let (duty, content) = pwm.steady(content, |content| pwm.duty(pressure.0, content))?;
            (OperatingPoint::filled(rig, pressure, length, content)?, duty)
        }
    };
    let averaged = Averaged::new(&pwm, &point, duty);
    Ok(Linearization::at(point, Some(averaged), 0.0))
}

/// The rig's valve under its PWM. The mean flow depends on pressure and density only, so any length serves.
struct Pwm<'a> {
    rig: &'a Rig,
    actuation: &'a Actuation,
    valve: &'a Valve,
    frequency: f64,
    duty_range: (f64, f64),
}

impl<'a> Pwm<'a> {
    fn of(rig: &'a Rig) -> Result<Self, Error> {
        if rig.actuation().is_some_and(|drive| !drive.solenoid.ramp().is_none()) {
            return Err(Error::NotImplemented(&crate::limit::AVERAGE_STROKE));
        }
        if let (Some(actuation), Some(valve)) = (rig.actuation(), rig.actuator().valve())
            && let (Command::Pwm { frequency, .. }, Some(duty_range)) =
                (&actuation.command, duty_range(&actuation.solenoid, &actuation.command))
        {
            return Ok(Self { rig, actuation, valve, frequency: *frequency, duty_range });
        }
        Err(Error::Misuse {
            what: "there is no PWM to average: the command is another, or the actuator has no valve",
            remedy: "set command.kind = \"pwm\", or linearise with the valve held",
        })
    }

    fn seats(&self, duty: f64) -> Vec<Interval> {
        let pulses = with_duty(&self.actuation.command, duty);
        pulses.and_then(|pulses| period(&self.actuation.solenoid, &pulses)).unwrap_or_default()
    }

    /// The air at a pressure in Pa.
    fn chamber(&self, pressure: f64, content: Content) -> Result<Chamber, Error> {
        let actuator = self.rig.actuator();
        let length = actuator.limits().max_length();
        let mass = point::air_mass(self.rig, AbsolutePressure(pressure), length, content)?;
        Ok(actuator.chamber(length, 0.0, pressure, mass, false))
    }

    /// Mean net flow in kg/s.
    fn net(&self, seats: &[Interval], pressure: f64, content: Content) -> f64 {
        self.chamber(pressure, content).map_or(0.0, |chamber| mean_flow(self.rig.actuator(), &chamber, seats).net())
    }

    /// The pressure in Pa at which as much air comes as goes.
    fn pressure(&self, seats: &[Interval], content: Content) -> Result<(f64, f64), Error> {
        if seats.iter().all(|interval| interval.ports == Ports::CLOSED) {
            return Err(Error::NoSolution {
                what: "at this duty the valve never opens: any pressure stays as it is",
                remedy: "give a duty at which the pulse is longer than the opening delay, or hold the valve",
            });
        }
        let (supply, exhaust) = (self.valve.port_pressure(Port::Supply), self.valve.port_pressure(Port::Exhaust));
        let (low, high) = (supply.min(exhaust), supply.max(exhaust));
        self.chamber(high, content)?;
        let pressure = root::bracketed(low, high, 1e-16 * high, |pressure| self.net(seats, pressure, content));
        Ok((pressure, self.energy(seats, pressure, content)?))
    }

    /// The duty at which as much air comes as goes at a pressure in Pa.
    fn duty(&self, pressure: f64, content: Content) -> Result<(f64, f64), Error> {
        self.chamber(pressure, content)?;
        let net = |duty: f64| self.net(&self.seats(duty), pressure, content);
        let (low, high) = self.duty_range;
        if !(low < high && (net(low) > 0.0) != (net(high) > 0.0)) {
            return Err(Error::NoSolution {
                what: "no duty that the seats can follow holds this pressure",
                remedy: "give a pressure well between supply and exhaust, or a lower command.frequency",
            });
        }
        let duty = root::bracketed(low, high, 1e-16, net);
        Ok((duty, self.energy(&self.seats(duty), pressure, content)?))
    }

    /// The rate of the pressure in Pa/s where as much air comes as goes: by heat and by the temperatures alone.
    fn energy(&self, seats: &[Interval], pressure: f64, content: Content) -> Result<f64, Error> {
        let chamber = self.chamber(pressure, content)?;
        Ok(self.rig.actuator().pressure_rate(&chamber, &mean_flow(self.rig.actuator(), &chamber, seats)))
    }

    /// What balances the flow, and the air there: as much as is given where the process keeps that, else at the
    /// temperature that lasts. `of` gives what balances the flow, with the rate of the pressure there.
    fn steady(
        &self,
        content: Content,
        of: impl Fn(Content) -> Result<(f64, f64), Error>,
    ) -> Result<(f64, Content), Error> {
        let Process::EnergyBalance { heat_transfer, wall_temperature } = self.rig.actuator().air().process() else {
            return Ok((of(content)?.0, content));
        };
        if matches!(content, Content::Temperature(_)) {
            return Err(Error::Misuse {
                what: "under the energy balance the temperature follows from the flow: it cannot be given",
                remedy: "leave the temperature out",
            });
        }
        let inflow = self.valve.supply.temperature();
        let wall = if heat_transfer > 0.0 { wall_temperature } else { inflow };
        let (low, high) = (inflow.min(wall), inflow.max(wall));
        of(Content::Temperature(low))?;
        let rate = |kelvin| of(Content::Temperature(kelvin)).map_or(0.0, |(_, rate)| rate);
        let content = Content::Temperature(root::bracketed(low, high, 1e-16 * high, rate));
        Ok((of(content)?.0, content))
    }
}
