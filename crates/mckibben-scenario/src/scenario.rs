//! What a scenario file says, as plain validated values in SI.
//!
//! Units, presets and defaults are resolved: every field is a number in the unit its sentence names, or one of a few
//! choices. Each number is within the range of its row in the core's parameter table. What takes the model to judge
//! (whether the braid's lengths fit each other, say) is judged by the constructors of the core, whose errors
//! [`Document::diagnose`](crate::Document::diagnose) locates in the file.

use crate::choice::{
    BladderForm, CommandState, Engine, ExhaustTemperature, HoseKind, Method, PressurePlace, ValveKind,
};
use crate::diagnostic::Diagnostics;
use crate::document::Document;
use mckibben::control::{Quantity, SetPoint};
use mckibben::plant::InitialFriction;
use std::path::Path;

/// One experiment: what is built, what drives it, what is recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The braided actuator.
    pub actuator: Actuator,
    /// The gas in the actuator and around it.
    pub air: Air,
    /// The air behind the valve; always there when `valve` is.
    pub supply: Option<Supply>,
    /// The valve; without one the actuator is sealed.
    pub valve: Option<Valve>,
    /// The hose from the valve to the actuator; there only with a valve.
    pub hose: Option<Hose>,
    /// The command to the valve; there exactly when `valve` is.
    pub command: Option<Command>,
    /// The pressure in the actuator over time, where it is given; in place of a valve.
    pub pressure: Option<PressureSeries>,
    /// The elastic tendon between actuator and load, if there is one.
    pub tendon: Option<SeriesTendon>,
    /// What the actuator pulls on.
    pub load: Load,
    /// The state at the start.
    pub initial: Initial,
    /// How long to simulate and what to record.
    pub run: Run,
}

/// The braided actuator.
#[derive(Clone, Debug, PartialEq)]
pub struct Actuator {
    /// Length of one braid thread b in m.
    pub thread_length: f64,
    /// Number of turns n that one thread makes around the actuator.
    pub turns: f64,
    /// Length L_max in m at which the braid is taut.
    pub max_length: f64,
    /// Length L_min in m of full contraction.
    pub min_length: f64,
    /// Volume V_ext of hose and fittings in m³; a [`Hose`] has its volume in addition.
    pub external_volume: f64,
    /// Conductance k of a leak in m³/(s·Pa), if there is one.
    pub leakage: Option<f64>,
    /// Thickness t in m of the bladder's wall.
    pub wall_thickness: f64,
    /// The taper of the ends, if they have one.
    pub taper: Option<Taper>,
    /// The law of static force.
    pub force: Force,
    /// The bladder, where its elasticity counts.
    pub bladder: Option<Bladder>,
    /// Measured force over ideal force.
    pub effectiveness: Effectiveness,
    /// Friction between threads and bladder.
    pub friction: Friction,
    /// The taut braid.
    pub limit: Limit,
}

/// The law of static force.
#[derive(Clone, Debug, PartialEq)]
pub enum Force {
    /// Virtual work of the gas on the braid.
    IdealBraid,
    /// The law of Tondu & Lopez.
    TonduLopez {
        /// End factor k at high pressure.
        end_factor: f64,
        /// Excess of the end factor at zero gauge pressure.
        end_factor_rise: f64,
        /// Gauge pressure in Pa over which that excess falls by the factor e.
        end_factor_pressure: f64,
        /// Its coefficients, where they are not those of the braid.
        coefficients: Option<TonduLopezCoefficients>,
    },
    /// Sárosi's law: coefficients for pressures in Pa, contractions in percent and forces in N.
    Sarosi([f64; 6]),
    /// The law of Martens & Boblan.
    MartensBoblan {
        /// Thickness H in m of the rubber membrane.
        membrane_thickness: f64,
        /// Coefficients of its modulus over the length in m: in Pa, Pa/m, Pa/m², Pa/m³.
        modulus: [f64; 4],
    },
    /// The ideal braid of threads that stretch.
    ExtensibleBraid {
        /// Axial stiffness in N/m of all threads side by side.
        thread_stiffness: f64,
    },
    /// Bolen's law.
    Bolen {
        /// Force in N at the longest length and the largest pressure.
        max_force: f64,
        /// Gauge pressure in Pa at which the largest force and contraction are stated.
        max_pressure: f64,
        /// Contraction without load at that pressure.
        max_contraction: f64,
        /// Coefficients s0, s1, s2 of the surface.
        shape: [f64; 3],
    },
    /// A surface polynomial in contraction.
    Polynomial {
        /// Coefficients a_i in m^2 of rising powers of contraction, at least one.
        pressure: Vec<f64>,
        /// Coefficients b_i in N of rising powers of contraction; none for no passive part.
        passive: Vec<f64>,
    },
    /// A measured force map.
    Map {
        /// Gauge pressures in Pa, strictly increasing.
        gauge_pressure: Vec<f64>,
        /// Lengths in m, strictly increasing.
        length: Vec<f64>,
        /// Tensions in N: one for each length at the first pressure, then at the next.
        tension: Vec<f64>,
    },
}

/// Measured coefficients of the law of Tondu & Lopez.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TonduLopezCoefficients {
    /// Radius r_0 in m of the muscle at its longest.
    pub radius: f64,
    /// Factor a of the pulling term.
    pub a: f64,
    /// Factor b of the pushing term.
    pub b: f64,
}

/// Cones at the ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taper {
    /// Radius r_e in m of the braid where it is clamped.
    pub end_radius: f64,
    /// Length of a cone over the radius by which it widens.
    pub length_ratio: f64,
}

/// An elastic bladder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bladder {
    /// How its resistance grows with contraction.
    pub form: BladderForm,
    /// Its force K_0 in N.
    pub force: f64,
    /// Contraction s over which it saturates or stiffens; without effect when linear.
    pub scale: f64,
}

/// Measured force over ideal force, as a law over gauge pressure.
#[derive(Clone, Debug, PartialEq)]
pub enum Effectiveness {
    /// A ratio that is constant over pressure.
    Constant(f64),
    /// Coefficients e_k of Eff = Σ e_k Pg^k, with the gauge pressure Pg in Pa; e_k is in Pa^-k.
    Polynomial(Vec<f64>),
    /// Ratios at increasing gauge pressures.
    Table {
        /// Gauge pressures in Pa, strictly increasing.
        gauge_pressure: Vec<f64>,
        /// The ratio at each.
        value: Vec<f64>,
    },
}

/// Friction of the actuator.
#[derive(Clone, Debug, PartialEq)]
pub struct Friction {
    /// Viscous damping coefficient c in N·s/m.
    pub viscous: f64,
    /// Viscous damping in addition, over the secant stiffness, in s.
    pub structural_damping: f64,
    /// Coulomb friction Q as a length in m.
    pub coulomb_width: f64,
    /// Dry friction F_0 in N that is the same at any length and pressure.
    pub coulomb_force: f64,
    /// Dry friction A in m² for the gauge pressure.
    pub coulomb_force_per_pressure: f64,
    /// Dry friction ρ at break-away over that in motion.
    pub static_ratio: f64,
    /// Velocity v_s in m/s over which it falls from the one to the other.
    pub stribeck_velocity: f64,
    /// Hysteresis that remembers the turns of the length.
    pub hysteresis: Option<Hysteresis>,
    /// Branches that relax.
    pub viscoelastic: Option<Viscoelastic>,
}

/// Viscoelastic branches, one entry for each. An empty list stands for zeros.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Viscoelastic {
    /// Times in s in which they relax, increasing.
    pub relaxation_time: Vec<f64>,
    /// Stiffness of each in N/m that does not follow the pressure.
    pub stiffness: Vec<f64>,
    /// Stiffness of each over the actuator's secant stiffness.
    pub stiffness_ratio: Vec<f64>,
    /// Stretch of the spring of each in m at the start.
    pub initial_stretch: Vec<f64>,
}

/// Hysteresis that remembers the turns of the length.
#[derive(Clone, Debug, PartialEq)]
pub enum Hysteresis {
    /// Elastic elements that slip.
    MaxwellSlip {
        /// Deflections in m at which the elements slip.
        reach: Vec<f64>,
        /// Stiffness of each over the actuator's secant stiffness.
        stiffness_ratio: Vec<f64>,
    },
    /// A loop with rounded corners.
    BoucWen {
        /// Force in steady sliding over the secant stiffness, in m.
        width: f64,
        /// β in 1/m.
        beta: f64,
        /// γ in 1/m.
        gamma: f64,
    },
    /// Bristles whose friction falls with velocity.
    LuGre {
        /// Force in fast sliding over the secant stiffness, in m.
        width: f64,
        /// Deflection in fast sliding, in m.
        reach: f64,
        /// Force in the slowest sliding over that in fast sliding.
        static_ratio: f64,
        /// Velocity in m/s over which it falls.
        stribeck_velocity: f64,
        /// Damping over stiffness at rest, in s.
        damping_time: f64,
    },
}

/// The taut braid at full stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Stiffness K_braid in N/m.
    pub stiffness: f64,
    /// Viscous damping C_braid in N·s/m.
    pub damping: f64,
}

/// The gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// How the actuator's air changes its state.
    pub process: Process,
    /// Absolute pressure of the atmosphere P_atm in Pa.
    pub atmospheric_pressure: f64,
    /// Specific gas constant R in J/(kg·K).
    pub gas_constant: f64,
    /// Ratio of heat capacities γ.
    pub heat_capacity_ratio: f64,
}

/// How the actuator's air changes its state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Process {
    /// The paper's isentropic law.
    Isentropic,
    /// Constant temperature.
    Isothermal,
    /// A given exponent.
    Polytropic {
        /// The exponent κ.
        index: f64,
    },
    /// The first law of thermodynamics.
    EnergyBalance {
        /// Heat transfer coefficient times area h A in W/K.
        heat_transfer: f64,
        /// Temperature of the wall T_wall in K.
        wall_temperature: f64,
    },
}

/// The air behind the valve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supply {
    /// Gauge pressure in Pa.
    pub gauge_pressure: f64,
    /// Temperature in K of the supply's air and the atmosphere.
    pub temperature: f64,
    /// A reservoir that sags; without one the air has no end.
    pub reservoir: Option<Reservoir>,
    /// A regulator that holds the gauge pressure above; without one it is constant, or the reservoir's.
    pub regulator: Option<PressureRegulator>,
    /// How many actuators, all alike, draw from reservoir or regulator.
    pub actuators: f64,
}

/// A reservoir that feeds the valve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reservoir {
    /// Volume V_r in m³.
    pub volume: f64,
    /// Gauge pressure at the start in Pa; the supply's when absent.
    pub gauge_pressure: Option<f64>,
    /// Polytropic exponent κ_r of its air.
    pub polytropic_index: f64,
    /// What fills it; a bottle when absent.
    pub compressor: Option<Compressor>,
}

/// A compressor with a pressure switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compressor {
    /// Free air Q in m³/s.
    pub displacement: f64,
    /// Dead over swept volume ε.
    pub clearance: f64,
    /// Gauge pressure in Pa at which it starts.
    pub cut_in: f64,
    /// Gauge pressure in Pa at which it stops.
    pub cut_out: f64,
}

/// A pressure regulator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureRegulator {
    /// Time constant τ in s.
    pub lag: f64,
    /// Loss of outlet pressure over flow D in Pa·s/kg.
    pub droop: f64,
    /// Error within which it rests B in Pa.
    pub dead_band: f64,
}

/// The hose from the valve to the actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hose {
    /// How finely it is resolved.
    pub kind: HoseKind,
    /// How many cells it is divided into when distributed.
    pub cells: usize,
    /// Length L_h in m.
    pub length: f64,
    /// Inner diameter d in m.
    pub diameter: f64,
    /// Viscosity μ of the gas in Pa·s.
    pub viscosity: f64,
    /// Polytropic exponent κ of its air.
    pub polytropic_index: f64,
}

/// A pressure as a given function of time: straight lines between points, constant outside.
#[derive(Clone, Debug, PartialEq)]
pub struct PressureSeries {
    /// Where it stands.
    pub at: PressurePlace,
    /// Times in s, strictly increasing, from zero on.
    pub time: Vec<f64>,
    /// Gauge pressure in Pa at each, as it was recorded.
    pub gauge_pressure: Vec<f64>,
    /// What its sensor makes of the pressure.
    pub sensor: PressureSensor,
}

/// What the sensor of a given pressure makes of it: r(t) = s P(t − δ) + o.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureSensor {
    /// Reading o in Pa at zero gauge pressure.
    pub offset: f64,
    /// Reading over the gauge pressure s.
    pub scale: f64,
    /// By how much readings come late, δ in s.
    pub shift: f64,
}

impl Default for PressureSensor {
    /// Shows the pressure as it is.
    fn default() -> Self {
        Self { offset: 0.0, scale: 1.0, shift: 0.0 }
    }
}

impl PressureSeries {
    /// The gauge pressures in Pa at its rows.
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        let PressureSensor { offset, scale, .. } = self.sensor;
        self.gauge_pressure.iter().map(move |shown| (shown - offset) / scale)
    }
}

/// An elastic tendon between actuator and load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesTendon {
    /// Stiffness k in N/m.
    pub stiffness: f64,
    /// Length ℓ without tension in m.
    pub rest_length: f64,
}

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

/// What the actuator pulls on.
#[derive(Clone, Debug, PartialEq)]
pub enum Load {
    /// A mass that hangs from the actuator.
    HangingMass {
        /// Mass M in kg.
        mass: f64,
        /// Acceleration of gravity g in m/s² along the actuator.
        gravity: f64,
    },
    /// A mass that a constant force pulls.
    ConstantForce {
        /// The force in N, positive when it stretches the actuator.
        force: f64,
        /// Mass M in kg.
        mass: f64,
    },
    /// The length is fixed at the initial one.
    Isometric,
    /// The length is a given function of time.
    PrescribedMotion(Motion),
    /// A joint that two actuators turn against each other.
    AntagonisticJoint(Joint),
}

/// A joint that the scenario's actuator, the agonist, and a second one turn against each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Mass M of the limb in kg.
    pub mass: f64,
    /// Acceleration of gravity g in m/s².
    pub gravity: f64,
    /// Distance d in m of the limb's centre of mass from the axis.
    pub distance: f64,
    /// Moment of inertia I of the limb about its centre of mass in kg·m².
    pub inertia: f64,
    /// Angle θ_0 in rad at which the limb hangs straight down.
    pub hanging_angle: f64,
    /// Constant torque W in N·m.
    pub torque: f64,
    /// Viscous damping c in N·m·s/rad.
    pub damping: f64,
    /// Angle in rad of the lower stop, if there is one.
    pub min_angle: Option<f64>,
    /// Angle in rad of the upper stop, if there is one.
    pub max_angle: Option<f64>,
    /// Stiffness K_stop of the stops in N·m/rad.
    pub stop_stiffness: f64,
    /// Damping C_stop of the stops in N·m·s/rad.
    pub stop_damping: f64,
    /// How the agonist is led over the joint.
    pub tendon: Tendon,
    /// Angle at the start.
    pub angle: InitialAngle,
    /// Angular velocity at the start in rad/s.
    pub angular_velocity: f64,
    /// The second actuator.
    pub antagonist: Box<Antagonist>,
}

/// How an actuator is led over a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Tendon {
    /// Its moment arm.
    pub arm: MomentArm,
    /// Distance in m between the attachments at angle zero.
    pub rest_length: f64,
}

/// The moment arm of an actuator about a joint.
#[derive(Clone, Debug, PartialEq)]
pub enum MomentArm {
    /// A pulley of this radius in m.
    Pulley(f64),
    /// A monotone cubic through moment arms in m.
    Table {
        /// Rising joint angles in rad.
        angle: Vec<f64>,
        /// The arm at each, above zero.
        arm: Vec<f64>,
    },
}

/// Angle of a joint at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialAngle {
    /// Where the torques balance at the initial pressures.
    Equilibrium,
    /// This angle in rad.
    At(f64),
}

/// The second actuator of a joint; what the file does not say of it is as of the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Antagonist {
    /// The braided actuator.
    pub actuator: Actuator,
    /// The air behind the valve.
    pub supply: Option<Supply>,
    /// The valve.
    pub valve: Option<Valve>,
    /// Whether it draws from a separate supply, which the file then describes for it; else both draw from one.
    pub has_own_supply: bool,
    /// The hose from its valve.
    pub hose: Option<Hose>,
    /// The command to the valve.
    pub command: Option<Command>,
    /// The pressure over time, where it is given; in place of a valve.
    pub pressure: Option<PressureSeries>,
    /// How it is led over the joint.
    pub tendon: Tendon,
    /// The elastic tendon between it and the joint, if there is one.
    pub series_tendon: Option<SeriesTendon>,
    /// Gauge pressure at the start in Pa.
    pub gauge_pressure: f64,
    /// Temperature of the air at the start in K.
    pub temperature: f64,
}

/// A length as a function of time.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// L(t) = L_0 + A sin(2π f t + φ).
    Sinusoid {
        /// Mean length L_0 in m.
        length: f64,
        /// Amplitude A in m, less than the mean length.
        amplitude: f64,
        /// Frequency f in Hz.
        frequency: f64,
        /// Phase φ in rad.
        phase: f64,
    },
    /// Straight lines between points, constant outside.
    Table {
        /// Times in s, strictly increasing, from zero on.
        time: Vec<f64>,
        /// Lengths in m.
        length: Vec<f64>,
    },
}

/// The state at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Initial {
    /// Gauge pressure in the actuator in Pa.
    pub gauge_pressure: f64,
    /// Temperature of the actuator's air in K.
    pub temperature: f64,
    /// Distance between the attachments.
    pub length: InitialLength,
    /// Velocity of lengthening in m/s.
    pub velocity: f64,
    /// Where friction with a memory starts; relaxed in a file of one actuator.
    pub friction: InitialFriction,
}

/// Distance between the attachments at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialLength {
    /// Where the load is balanced at the initial pressure.
    Equilibrium,
    /// This length in m; always so with an isometric load.
    At(f64),
    /// What the prescribed motion says at t = 0; always and only so with that load.
    OfMotion,
    /// What the joint's angle says; always and only so with an antagonistic joint.
    OfJoint,
}

/// How long to simulate and what to record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Simulated time in s.
    pub duration: f64,
    /// Time between two written samples in s, not above the duration.
    pub sample_interval: f64,
    /// How the simulation goes through time.
    pub engine: Engine,
    /// Relative error that the event-located integrator allows a step.
    pub relative_tolerance: f64,
    /// Formula of the fixed-step engine.
    pub method: Method,
    /// Step of the fixed-step engine in s; when absent it follows from the accuracy.
    pub step: Option<f64>,
    /// Largest error of the fixed-step engine as a share of each state's range; without effect when a step is given.
    pub accuracy: f64,
}

impl Scenario {
    /// Whether two actuators turn a joint.
    pub fn has_joint(&self) -> bool {
        matches!(self.load, Load::AntagonisticJoint(_))
    }

    /// Whether both actuators of a joint draw from one supply.
    pub fn shares_supply(&self) -> bool {
        match &self.load {
            Load::AntagonisticJoint(joint) => {
                !joint.antagonist.has_own_supply && joint.antagonist.supply == self.supply
            }
            _ => false,
        }
    }

    /// Whether a controller drives the valve.
    pub fn has_controller(&self) -> bool {
        matches!(self.command, Some(Command::Controller(_)))
    }

    /// Reads a scenario from text; `file_name` stands in messages.
    ///
    /// # Errors
    /// Every mistake in the text.
    pub fn from_str(text: &str, file_name: &str) -> Result<Self, Diagnostics> {
        Document::parse(text, file_name)?.scenario()
    }

    /// Reads a scenario file.
    ///
    /// # Errors
    /// When the file cannot be read, or every mistake in it.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Diagnostics> {
        Document::load(path)?.scenario()
    }
}
