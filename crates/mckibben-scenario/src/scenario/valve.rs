//! Valves, and what drives them: commands and controllers.

use crate::choice::{CommandState, ExhaustTemperature, ValveKind};
use mckibben::control::{Quantity, SetPoint};

/// The valve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Valve {
    /// How it joins the actuator to supply and exhaust.
    pub kind: ValveKind,
    /// How much it lets through.
    pub flow_path: FlowPath,
    /// How much the flow path to the atmosphere lets through, where it differs.
    pub exhaust: Option<FlowPath>,
    /// Factor η on the calculated mass flow.
    pub efficiency: f64,
    /// What makes the pressure beyond the flow path, exactly of a pressure regulator.
    pub regulator: Option<ProportionalRegulator>,
    /// What uncovers the flow paths, exactly of a proportional spool.
    pub spool: Option<Spool>,
    /// Dead time in s by which the command acts late, whatever the kind of valve.
    pub dead_time: f64,
    /// Time t_open in s from energising the coil to the poppet's motion.
    pub opening_delay: f64,
    /// Time t_close in s from releasing the coil to the poppet's return.
    pub closing_delay: f64,
    /// Time t_rise in s that the poppet takes from shut to open.
    pub opening_time: f64,
    /// Time t_fall in s that the poppet takes from open to shut.
    pub closing_time: f64,
    /// Pressure ratio r_lam above which the flow law is a straight line.
    pub laminar_ratio: f64,
    /// Whose temperature the leaving air has in the flow law.
    pub exhaust_temperature: ExhaustTemperature,
}

/// A proportional pressure regulator in the place of a valve with seats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProportionalRegulator {
    /// Time constant τ in s.
    pub time_constant: f64,
    /// Largest rate of the pressure in Pa/s.
    pub rate_limit: f64,
}

/// A proportional spool in the place of poppets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spool {
    /// Undamped natural frequency f_n in Hz.
    pub natural_frequency: f64,
    /// Damping ratio ζ.
    pub damping_ratio: f64,
    /// Overlap o_s of the edge to the supply, a share of the stroke.
    pub supply_overlap: f64,
    /// Overlap o_e of the edge to the exhaust, a share of the stroke.
    pub exhaust_overlap: f64,
}

/// The usual ways to state how much a valve lets through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlowPath {
    /// Effective area A_p C_q in m².
    FlowArea(f64),
    /// ISO 6358.
    Iso6358 {
        /// Sonic conductance C in m³/(s·Pa) at the reference atmosphere.
        sonic_conductance: f64,
        /// Critical back-pressure ratio b.
        critical_ratio: f64,
    },
    /// IEC 60534-2-1, by Kv.
    Kv {
        /// Flow of water Kv in m³/s at a pressure drop of 1 bar.
        kv: f64,
        /// Pressure drop ratio x_T at which air chokes.
        pressure_drop_ratio: f64,
    },
    /// IEC 60534-2-1, by Cv.
    Cv {
        /// Flow of water Cv in US gallons per minute at a pressure drop of 1 psi.
        cv: f64,
        /// Pressure drop ratio x_T at which air chokes.
        pressure_drop_ratio: f64,
    },
}

/// The command to the valve.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Pulse-width modulation.
    Pwm {
        /// Frequency f in Hz.
        frequency: f64,
        /// Commanded duty cycle d.
        duty: f64,
        /// State during the pulse, with which each period starts.
        pulse: CommandState,
        /// State between pulses.
        rest: CommandState,
    },
    /// Constant over time.
    Constant(CommandState),
    /// A list of changes; before the first the coils are released.
    Table {
        /// Times in s, strictly increasing, from zero on.
        time: Vec<f64>,
        /// The state commanded from each time on.
        state: Vec<CommandState>,
    },
    /// Set points of a pressure regulator, which keeps the initial pressure until the first.
    SetPoints {
        /// Times in s, strictly increasing, from zero on.
        time: Vec<f64>,
        /// Gauge pressure in Pa from each time on.
        gauge_pressure: Vec<f64>,
    },
    /// Positions of a proportional spool, which rests in the middle until the first.
    Positions {
        /// Times in s, strictly increasing, from zero on.
        time: Vec<f64>,
        /// Position from each time on, from −1 (exhaust open) to 1 (supply open).
        position: Vec<f64>,
    },
    /// What a controller decides.
    Controller(Box<Controller>),
}

/// A controller.
#[derive(Clone, Debug, PartialEq)]
pub struct Controller {
    /// What it regulates and where that is to be.
    pub aim: Aim,
    /// From an error to what the valve is to do.
    pub regulator: Regulator,
    /// Samples a second in Hz.
    pub rate: f64,
    /// Sampling instants between a measurement and its effect.
    pub delay: usize,
    /// Frequency of the pulses in Hz, where it is not the rate.
    pub pulse_frequency: Option<f64>,
    /// Step between two values that the sensor of the regulated quantity can show, in its unit.
    pub resolution: f64,
}

/// What a controller regulates and where that is to be.
#[derive(Clone, Debug, PartialEq)]
pub enum Aim {
    /// A quantity at its set point.
    Track {
        /// Gauge pressure, length, air mass or tension; of a joint the angle.
        quantity: Quantity,
        /// Where it is to be, in its unit.
        set_point: SetPoint,
    },
    /// What the static model of a joint needs for an angle and a stiffness.
    Joint {
        /// The angle in rad.
        angle: SetPoint,
        /// The stiffness of the two actuators in N·m/rad.
        stiffness: SetPoint,
        /// Highest gauge pressure in Pa.
        highest_gauge_pressure: f64,
        /// Regulates the masses of air at this temperature in K, or the pressures when absent.
        temperature: Option<f64>,
    },
    /// What the static model needs for a force at a length.
    Model {
        /// The force in N.
        force: SetPoint,
        /// The length in m; the measured one, when absent.
        length: Option<SetPoint>,
        /// Highest gauge pressure in Pa.
        highest_gauge_pressure: f64,
        /// Regulates the mass of air at this temperature in K, or the pressure when absent.
        temperature: Option<f64>,
    },
}

impl Aim {
    /// What is regulated.
    pub fn regulated(&self) -> Quantity {
        match self {
            Self::Track { quantity, .. } => *quantity,
            Self::Model { temperature, .. } | Self::Joint { temperature, .. } => match temperature {
                Some(_) => Quantity::AirMass,
                None => Quantity::Pressure,
            },
        }
    }
}

/// From an error to what the valve is to do; numbers without a unit named are in the regulated quantity's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regulator {
    /// Bang-bang with a dead band.
    Relay {
        /// Error within which nothing is requested.
        dead_band: f64,
        /// Part of it that the error must come back.
        hysteresis: f64,
    },
    /// Pulses by proportional, integral and derivative action.
    Pid {
        /// Error at which the proportional action gives the full output.
        proportional_band: f64,
        /// Time of the integral in s, if there is one.
        integral_time: Option<f64>,
        /// Time of the derivative in s.
        derivative_time: f64,
        /// Largest gain of the derivative over the proportional gain.
        derivative_filter: f64,
        /// Share of the set point that the proportional action sees.
        set_point_weight: f64,
        /// Time in s in which the integral is drawn back, where it is not the customary one.
        tracking_time: Option<f64>,
        /// Output at no error.
        bias: f64,
    },
}
