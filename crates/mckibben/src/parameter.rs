//! The one table of parameters.
//!
//! Each row states once a parameter's scenario key, symbol, SI unit, range, default, meaning and source. Validation
//! here, the scenario schema, the messages of the command line and the documentation are all made from these rows.
//!
//! | column | meaning |
//! |---|---|
//! | `key` | path in a scenario file, and the name in messages |
//! | `symbol` | the paper's symbol, or the usual one |
//! | `unit` | SI unit; empty for a pure number |
//! | `range` | admissible values in that unit |
//! | `default` | the value when the key is absent; `None` when it must be given or follows from other keys |
//! | `source` | where the default or the definition comes from; "assumed" where the paper is silent |
//!
//! Checked by `tests/parameter.rs`: keys are unique, every default lies in its range, every meaning is a sentence.

use crate::error::Error;

/// An interval of admissible values, each end open or closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Whether the lower end itself is admissible.
    pub low_included: bool,
    /// Upper end.
    pub high: f64,
    /// Whether the upper end itself is admissible.
    pub high_included: bool,
}

impl Range {
    /// Every finite number.
    pub const FINITE: Self =
        Self { low: f64::NEG_INFINITY, low_included: false, high: f64::INFINITY, high_included: false };
    /// Numbers above zero.
    pub const POSITIVE: Self = Self { low: 0.0, ..Self::FINITE };
    /// Zero and above.
    pub const NON_NEGATIVE: Self = Self { low_included: true, ..Self::POSITIVE };
    /// From 0 to 1, both included.
    pub const FRACTION: Self = Self { low: 0.0, low_included: true, high: 1.0, high_included: true };

    /// Numbers strictly between two ends.
    pub const fn open(low: f64, high: f64) -> Self {
        Self { low, low_included: false, high, high_included: false }
    }

    /// Whether `value` is a finite number inside the range.
    pub fn contains(&self, value: f64) -> bool {
        let above = if self.low_included { value >= self.low } else { value > self.low };
        let below = if self.high_included { value <= self.high } else { value < self.high };
        value.is_finite() && above && below
    }
}

impl core::fmt::Display for Range {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let words = |included| if included { "at least" } else { "greater than" };
        match (self.low.is_finite(), self.high.is_finite()) {
            (false, false) => write!(f, "any finite number"),
            (true, false) => write!(f, "{} {}", words(self.low_included), self.low),
            (false, true) if self.high_included => write!(f, "at most {}", self.high),
            (false, true) => write!(f, "less than {}", self.high),
            (true, true) => {
                let upper = if self.high_included { "at most" } else { "less than" };
                write!(f, "{} {} and {upper} {}", words(self.low_included), self.low, self.high)
            }
        }
    }
}

/// One row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Path in a scenario file, for instance `actuator.turns`.
    pub key: &'static str,
    /// Symbol in the paper, or the usual one.
    pub symbol: &'static str,
    /// SI unit; empty for a pure number.
    pub unit: &'static str,
    /// Admissible values, in `unit`.
    pub range: Range,
    /// Value when the key is absent, in `unit`.
    pub default: Option<f64>,
    /// What it is, as one sentence.
    pub meaning: &'static str,
    /// Source of the definition and of the default.
    pub source: &'static str,
    /// What to do when a value is refused.
    pub remedy: &'static str,
}

impl Parameter {
    /// Returns `value` if it is finite and in range.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] otherwise; it names the parameter, the value, the range, the unit and the remedy.
    pub fn check(&'static self, value: f64) -> Result<f64, Error> {
        if self.range.contains(value) { Ok(value) } else { Err(Error::OutOfRange { parameter: self, value }) }
    }
}

/// The most samples, steps, pulses, sampling instants or periods of a motion that one run may have.
///
/// At a microsecond each it is a quarter of an hour of computing and as samples about a hundred gigabytes of text: a
/// file that requests more has most likely mistaken a unit.
pub const MAX_COUNT: f64 = 1e9;

impl Parameter {
    /// Returns `value` if what it requests in a run is not more than [`MAX_COUNT`]: `count` of what is `counted`, in
    /// the plural.
    ///
    /// # Errors
    /// [`Error::TooMany`] otherwise; it names the parameter, its value, the count and what to do.
    pub fn check_count(&'static self, value: f64, count: f64, counted: &'static str) -> Result<f64, Error> {
        // What is no number is refused too.
        if count <= MAX_COUNT {
            return Ok(value);
        }
        let remedy = match self.unit {
            "Hz" => "give a lower frequency or a shorter run",
            _ => "give a longer time or a shorter run",
        };
        Err(Error::TooMany { parameter: self, value, count, counted, remedy })
    }
}

macro_rules! parameters {
    ($(#[$about:meta])* $table:ident: $($(#[$attribute:meta])* $name:ident = $key:literal, $symbol:literal, $unit:literal, $range:expr, $default:expr,
        $meaning:literal, $source:literal, $remedy:literal;)*) => {
        $(
            #[doc = $meaning]
            pub static $name: Parameter = Parameter {
                key: $key, symbol: $symbol, unit: $unit, range: $range, default: $default,
                meaning: $meaning, source: $source, remedy: $remedy,
            };
        )*
        $(#[$about])*
        pub static $table: &[&Parameter] = &[$(&$name),*];
    };
}

#[cfg(feature = "alloc")]
pub(crate) use parameters;

parameters! {
    /// Every row, in the order of the scenario file.
    TABLE:
    THREAD_LENGTH = "actuator.thread_length", "b", "m", Range::POSITIVE, None,
        "Length of one braid thread from end to end.",
        "paper, Fig. 2 and (2)", "give the length of a thread, longer than the stretched actuator";
    TURNS = "actuator.turns", "n", "", Range::POSITIVE, None,
        "Number of turns that one thread makes around the actuator.",
        "paper, Fig. 2", "count the turns of one thread over the whole length";
    LENGTH = "actuator.length", "L_0", "m", Range::POSITIVE, None,
        "Length of the muscle at rest, without pressure and load, between its fittings.",
        "paper, Fig. 2 and (2)", "give the length at which diameter and braid angle are stated, below the thread length";
    DIAMETER = "actuator.diameter", "D_0", "m", Range::POSITIVE, None,
        "Diameter of the braid at rest, from the middle of a thread to that of the one opposite.",
        "paper, Fig. 2 and (2)", "give the outer diameter of the sleeve less the thickness of one thread";
    BRAID_ANGLE = "actuator.braid_angle", "theta_0", "rad", Range::open(0.0, core::f64::consts::FRAC_PI_2), None,
        "Angle between a thread and the axis of the muscle at rest, the paper's interweave angle.",
        "paper, Fig. 2 and (2)", "give an angle between 0 and 90 deg, such as 25 deg";
    MAX_LENGTH = "actuator.max_length", "L_max", "m", Range::POSITIVE, None,
        "Length at which the braid is taut; that at rest when absent.",
        "paper, (11) and (14)", "give a length below the thread length";
    MIN_LENGTH = "actuator.min_length", "L_min", "m", Range::POSITIVE, None,
        "Length of full contraction, below which the tendon is slack; b/sqrt(3) when absent.",
        "paper, (10)", "give a length below max_length, or leave it out for b/sqrt(3)";
    EXTERNAL_VOLUME = "actuator.external_volume", "V_ext", "m^3", Range::POSITIVE, Some(3e-6),
        "Volume of hose and fittings that shares the actuator's air.",
        "assumed: the paper gives no hose volume", "give the hose's and fittings' volume, for instance 0.01 mL for none to speak of";
    LEAKAGE = "actuator.leakage", "k", "m^3/(s*Pa)", Range::NON_NEGATIVE, None,
        "Laminar leak of the actuator: flow of volume at the mean pressure over the gauge pressure; none when absent.",
        "textbook (Hagen-Poiseuille)", "give zero or more, such as 1e-12 m^3/(s*Pa)";
    WALL_THICKNESS = "actuator.wall_thickness", "t", "m", Range::NON_NEGATIVE, Some(0.0),
        "Thickness of the bladder's wall inside the braid, the same at any length.",
        "Chou & Hannaford (1996); the paper has none", "give zero or more, below the braid's radius";
    END_FACTOR = "actuator.force.end_factor", "k", "", Range::POSITIVE, Some(1.0),
        "Contraction of the middle over that of the whole, which the taper of the ends makes larger than 1.",
        "Tondu & Lopez (2000)", "give a factor such as 1.1, or 1 for a cylinder up to its ends";
    END_FACTOR_RISE = "actuator.force.end_factor_rise", "k_r", "", Range::FINITE, Some(0.0),
        "Excess of the end factor at zero gauge pressure over that at high pressure.",
        "assumed", "give zero for an end factor that does not depend on pressure";
    END_FACTOR_PRESSURE = "actuator.force.end_factor_pressure", "P_k", "Pa", Range::POSITIVE, Some(1e5),
        "Gauge pressure over which that excess falls by the factor e.",
        "assumed", "give a pressure such as 1 bar";
    INITIAL_RADIUS = "actuator.force.radius", "r_0", "m", Range::POSITIVE, None,
        "Radius of the muscle at its longest; that of the braid when absent.",
        "Tondu & Lopez (2000)", "give half the diameter at max_length";
    TONDU_LOPEZ_A = "actuator.force.a", "a", "", Range::POSITIVE, None,
        "Factor of the pulling term, 3/tan^2 of the initial braid angle; that of the braid when absent.",
        "Tondu & Lopez (2000)", "give a factor above zero, with `b` and `radius`";
    TONDU_LOPEZ_B = "actuator.force.b", "b", "", Range::POSITIVE, None,
        "Factor of the pushing term, 1/sin^2 of the initial braid angle; that of the braid when absent.",
        "Tondu & Lopez (2000)", "give a factor above zero, with `a` and `radius`";
    SAROSI_COEFFICIENTS = "actuator.force.coefficients", "a_i", "", Range::FINITE, None,
        "The six coefficients of (a1 p + a2) e^(a3 c) + a4 c p + a5 p + a6, p in `pressure_unit`, c in percent, the sum in `force_unit`.",
        "after Sarosi (2015)", "give six finite numbers";
    THREAD_STIFFNESS = "actuator.force.thread_stiffness", "K", "N/m", Range::POSITIVE, None,
        "Axial stiffness of all threads side by side: their number times E A/b.",
        "definition", "give a stiffness above zero, or the law \"ideal-braid\" for threads that do not stretch";
    MEMBRANE_THICKNESS = "actuator.force.membrane_thickness", "H", "m", Range::POSITIVE, None,
        "Thickness of the rubber membrane that the braid is embedded in.",
        "Martens & Boblan (2017)", "give a thickness above zero, such as 1.8 mm";
    MEMBRANE_MODULUS = "actuator.force.modulus", "c_i", "", Range::FINITE, None,
        "Modulus of the membrane: the four coefficients of c0 + c1 L + c2 L^2 + c3 L^3 in `modulus_unit`, L in `length_unit`.",
        "Martens & Boblan (2017)", "give four finite numbers";
    MAX_FORCE = "actuator.force.max_force", "F_max", "N", Range::POSITIVE, None,
        "Force at max_length and `max_pressure`.",
        "the muscle's data sheet", "give a force above zero";
    MAX_PRESSURE = "actuator.force.max_pressure", "P_max", "Pa", Range::POSITIVE, None,
        "Gauge pressure at which the largest force and the largest contraction are stated.",
        "the muscle's data sheet", "give a pressure above zero, such as 620 kPa";
    MAX_CONTRACTION = "actuator.force.max_contraction", "eps_max", "", Range::open(0.0, 1.0), None,
        "Contraction without load at `max_pressure`.",
        "the muscle's data sheet", "give a contraction between 0 and 1, such as 0.25";
    BOLEN_SHAPE = "actuator.force.shape", "s_i", "", Range::NON_NEGATIVE, None,
        "The coefficients s0, s1 and s2 of s0 (e^(-s1 x) - 1) + p e^(-s2 x^2).",
        "the public code of the group of A. Hunt", "give three numbers of zero or more";
    PRESSURE_COEFFICIENTS = "actuator.force.pressure_coefficients", "a_i", "", Range::FINITE, None,
        "Coefficients of rising powers of contraction in what the pressure pulls, in `force_unit` over `pressure_unit`.",
        "after Hildebrandt et al. (2005)", "give 1 to 6 finite numbers";
    PASSIVE_COEFFICIENTS = "actuator.force.passive_coefficients", "b_i", "", Range::FINITE, None,
        "Coefficients of rising powers of contraction in what resists without pressure, in `force_unit`; none when absent.",
        "after Hildebrandt et al. (2005)", "give 1 to 6 finite numbers, or leave it out";
    MAP_PRESSURE = "actuator.force.gauge_pressure", "P_g", "Pa", Range::FINITE, None,
        "Gauge pressures of a measured force map, strictly rising.",
        "choice of the measurement", "give 2 to 24 pressures in rising order";
    MAP_LENGTH = "actuator.force.length", "L", "m", Range::POSITIVE, None,
        "Lengths of a measured force map, strictly rising.",
        "choice of the measurement", "give 2 to 24 lengths in rising order";
    MAP_TENSION = "actuator.force.tension", "F", "N", Range::FINITE, None,
        "Measured tensions: one for each length at the first pressure, then at the next.",
        "choice of the measurement", "give as many as there are lengths times pressures";
    TAPER_END_RADIUS = "actuator.taper.end_radius", "r_e", "m", Range::POSITIVE, None,
        "Radius of the braid where it is clamped to its end fittings.",
        "assumed", "give a radius above zero, at most that of the braid at max_length";
    TAPER_LENGTH_RATIO = "actuator.taper.length_ratio", "c", "", Range::NON_NEGATIVE, None,
        "Length of the cone at either end over the radius by which it widens.",
        "assumed", "give zero for no cones, 1 for a half-angle of 45 deg, 1.7 for 30 deg";
    BLADDER_FORCE = "actuator.bladder.force", "K_0", "N", Range::NON_NEGATIVE, None,
        "Force that the bladder's resistance to contraction is measured by.",
        "assumed", "give zero or more";
    BLADDER_SCALE = "actuator.bladder.scale", "s", "", Range::POSITIVE, None,
        "Contraction over which the bladder's resistance saturates or stiffens.",
        "assumed", "give a contraction above zero, such as 0.05";
    EFFECTIVENESS = "actuator.effectiveness.constant", "Eff", "", Range::NON_NEGATIVE, Some(1.0),
        "Measured force over ideal force.",
        "paper, (9); the default is assumed", "give a ratio such as 0.9";
    VISCOUS = "actuator.friction.viscous", "c", "N*s/m", Range::NON_NEGATIVE, Some(0.0),
        "Viscous damping coefficient.",
        "paper, (12); its average is 0.02 lbf*s/in; none is assumed where none is given", "give zero or more";
    STRUCTURAL_DAMPING = "actuator.friction.structural_damping", "tau_c", "s", Range::NON_NEGATIVE, Some(0.0),
        "Viscous damping in addition, over the secant stiffness.",
        "choice of the experiment; the paper has none", "give zero or more, such as 2 ms";
    COULOMB_WIDTH = "actuator.friction.coulomb_width", "Q", "m", Range::NON_NEGATIVE, Some(0.0),
        "Coulomb friction between bladder and braid as a length, mu N/k.",
        "paper, (12) and (24); its average is 0.0044 in; none is assumed where none is given", "give zero or more";
    COULOMB_FORCE = "actuator.friction.coulomb_force", "F_0", "N", Range::NON_NEGATIVE, Some(0.0),
        "Dry friction that is the same at any length and pressure.",
        "textbook; the paper has none", "give zero or more";
    COULOMB_FORCE_PER_PRESSURE = "actuator.friction.coulomb_force_per_pressure", "A", "m^2", Range::NON_NEGATIVE, Some(0.0),
        "Dry friction for the gauge pressure, at any length.",
        "textbook; the paper has none", "give zero or more, such as 1 mm^2";
    STATIC_RATIO = "actuator.friction.static_ratio", "rho", "", Range { low: 1.0, low_included: true, high: f64::INFINITY, high_included: false }, Some(1.0),
        "Dry friction at break-away over that in motion.",
        "Armstrong-Helouvry, Dupont & Canudas de Wit (1994); 1 is Coulomb's law", "give 1 or more, such as 1.3";
    STRIBECK_VELOCITY = "actuator.friction.stribeck_velocity", "v_s", "m/s", Range::POSITIVE, Some(0.01),
        "Velocity over which dry friction falls from its value at break-away to that in motion.",
        "Armstrong-Helouvry, Dupont & Canudas de Wit (1994); the value is assumed", "give a velocity above zero, such as 10 mm/s";
    HYSTERESIS_REACH = "actuator.friction.hysteresis.reach", "r_i", "m", Range::POSITIVE, None,
        "Deflections at which the elements of the hysteresis slip.",
        "Iwan (1966)", "give lengths above zero, such as 0.1 mm";
    HYSTERESIS_STIFFNESS_RATIO = "actuator.friction.hysteresis.stiffness_ratio", "w_i", "", Range::POSITIVE, None,
        "Stiffnesses of the elements over the actuator's secant stiffness.",
        "Iwan (1966), scaled by (13)", "give numbers above zero, such as 0.1";
    HYSTERESIS_WIDTH = "actuator.friction.hysteresis.width", "W", "m", Range::POSITIVE, None,
        "Force of the hysteresis in steady sliding, over the secant stiffness.",
        "Bouc (1971), Wen (1976) and Canudas de Wit et al. (1995), scaled by (13)", "give a length above zero, such as 0.1 mm";
    HYSTERESIS_BETA = "actuator.friction.hysteresis.beta", "beta", "m^-1", Range::POSITIVE, None,
        "How fast the hysteresis bends over, whichever way it goes.",
        "Bouc (1971) and Wen (1976)", "give a number above zero, such as 2000 m^-1";
    HYSTERESIS_GAMMA = "actuator.friction.hysteresis.gamma", "gamma", "m^-1", Range::FINITE, Some(0.0),
        "How much faster it bends over in loading than in unloading; zero is Dahl's law.",
        "Bouc (1971) and Wen (1976)", "give a number between -beta and beta";
    BRISTLE_REACH = "actuator.friction.hysteresis.bristle_reach", "r", "m", Range::POSITIVE, None,
        "Deflection of the bristles in fast sliding.",
        "Canudas de Wit, Olsson, Astrom & Lischinsky (1995), as F_C/sigma_0", "give a length above zero, such as 0.05 mm";
    BRISTLE_STATIC_RATIO = "actuator.friction.hysteresis.static_ratio", "rho", "", Range { low: 1.0, low_included: true, high: f64::INFINITY, high_included: false }, Some(1.0),
        "Force of the bristles in the slowest sliding over that in fast sliding.",
        "Canudas de Wit, Olsson, Astrom & Lischinsky (1995), as F_S/F_C", "give 1 or more, such as 1.3";
    BRISTLE_STRIBECK_VELOCITY = "actuator.friction.hysteresis.stribeck_velocity", "v_s", "m/s", Range::POSITIVE, Some(0.01),
        "Velocity over which the force of the bristles falls, and their damping.",
        "Canudas de Wit, Olsson, Astrom & Lischinsky (1995); the value is assumed", "give a velocity above zero, such as 10 mm/s";
    BRISTLE_DAMPING_TIME = "actuator.friction.hysteresis.damping_time", "tau", "s", Range::NON_NEGATIVE, Some(0.0),
        "Damping of the bristles over their stiffness, at rest.",
        "Canudas de Wit, Olsson, Astrom & Lischinsky (1995), as sigma_1/sigma_0", "give zero or more, such as 5 ms";
    BRANCH_STIFFNESS = "actuator.friction.viscoelastic.stiffness", "k_i", "N/m", Range::NON_NEGATIVE, None,
        "Stiffnesses of the viscoelastic branches that do not follow the pressure.",
        "generalised Maxwell model", "give zero or more, such as 100 N/m";
    BRANCH_STIFFNESS_RATIO = "actuator.friction.viscoelastic.stiffness_ratio", "w_i", "", Range::NON_NEGATIVE, None,
        "Stiffnesses of the viscoelastic branches over the actuator's secant stiffness.",
        "generalised Maxwell model, scaled by (13)", "give zero or more, such as 0.2";
    BRANCH_RELAXATION_TIME = "actuator.friction.viscoelastic.relaxation_time", "tau_i", "s", Range::POSITIVE, None,
        "Times in which the viscoelastic branches relax.",
        "generalised Maxwell model", "give times above zero, such as 1 s";
    BRANCH_INITIAL_STRETCH = "actuator.friction.viscoelastic.initial_stretch", "L - z_i", "m", Range::FINITE, Some(0.0),
        "Stretches of the springs of the viscoelastic branches at the start of a run; zero: relaxed.",
        "choice of the experiment", "give a stretch such as 0.2 mm, positive where it adds to the tension";
    LIMIT_STIFFNESS = "actuator.limit.stiffness", "K_braid", "N/m", Range::POSITIVE, Some(1.75e5),
        "Stiffness of the taut braid.",
        "paper, (11); the value is assumed", "give a stiffness much larger than the actuator's own";
    LIMIT_DAMPING = "actuator.limit.damping", "C_braid", "N*s/m", Range::NON_NEGATIVE, Some(100.0),
        "Viscous damping of the taut braid.",
        "paper, (14); the value is assumed", "give zero or more";
    POLYTROPIC_INDEX = "air.polytropic_index", "kappa", "", Range::POSITIVE, None,
        "Exponent of the polytropic process, between 1 (isothermal) and gamma (isentropic) in most cases.",
        "textbook", "give a number such as 1.2";
    HEAT_TRANSFER = "air.heat_transfer", "h A", "W/K", Range::NON_NEGATIVE, Some(0.0),
        "Heat that the wall gives the air per kelvin of difference, in the energy balance.",
        "textbook", "give zero or more";
    WALL_TEMPERATURE = "air.wall_temperature", "T_wall", "K", Range::POSITIVE, Some(293.15),
        "Temperature of the wall in the energy balance.",
        "textbook", "give an absolute temperature above zero, such as 20 degC";
    ATMOSPHERIC_PRESSURE = "air.atmospheric_pressure", "P_atm", "Pa", Range::POSITIVE, Some(101_325.0),
        "Absolute pressure of the atmosphere, zero of every gauge pressure.",
        "standard atmosphere", "give an absolute pressure above zero";
    GAS_CONSTANT = "air.gas_constant", "R", "J/(kg*K)", Range::POSITIVE, Some(286.99),
        "Specific gas constant.",
        "paper, (23): 53.34 ft*lbf/(lbm*degR)", "give a specific gas constant, 287 J/(kg*K) for air";
    HEAT_CAPACITY_RATIO = "air.heat_capacity_ratio", "gamma", "", Range { low: 1.0, low_included: false, high: 2.0, high_included: true }, Some(1.4),
        "Ratio of the heat capacities at constant pressure and constant volume.",
        "paper, (18)", "give 1.4 for air, 5/3 for helium";
    SUPPLY_GAUGE_PRESSURE = "supply.gauge_pressure", "P_g,supply", "Pa", Range::FINITE, None,
        "Gauge pressure of the supply; below zero for a vacuum.",
        "paper, section 3.3: 100 psi", "give a gauge pressure above minus the atmospheric pressure";
    SUPPLY_TEMPERATURE = "supply.temperature", "T_am", "K", Range::POSITIVE, Some(293.15),
        "Temperature of the supply's air and of the atmosphere.",
        "paper, (21); the value is assumed", "give an absolute temperature above zero, such as 20 degC";
    RESERVOIR_VOLUME = "supply.reservoir_volume", "V_r", "m^3", Range::POSITIVE, None,
        "Volume of a reservoir that feeds the valve and sags; a supply of constant pressure when absent.",
        "choice of the experiment", "give a volume such as 5 L";
    RESERVOIR_PRESSURE = "supply.reservoir_gauge_pressure", "P_g,r(0)", "Pa", Range::FINITE, None,
        "Gauge pressure in the reservoir at the start; the supply's gauge pressure when absent.",
        "choice of the experiment", "give a gauge pressure above minus the atmospheric pressure";
    RESERVOIR_INDEX = "supply.reservoir_index", "kappa_r", "", Range { low: 1.0, low_included: true, high: 2.0, high_included: true }, Some(1.0),
        "Polytropic exponent of the reservoir's air: 1 where it keeps its temperature, gamma where it is drawn upon quickly.",
        "textbook; the default is assumed", "give a number from 1 to gamma";
    DISPLACEMENT = "supply.compressor_displacement", "Q", "m^3/s", Range::POSITIVE, None,
        "Free air that a compressor takes in to fill the reservoir; a bottle, which none fills, when absent.",
        "textbook", "give a flow of free air such as 20 L/min";
    CLEARANCE = "supply.compressor_clearance", "epsilon", "", Range::FRACTION, Some(0.05),
        "Dead over swept volume of the compressor, by which it delivers less the higher the pressure.",
        "textbook; the default is assumed", "give a ratio such as 0.05";
    CUT_IN = "supply.cut_in_gauge_pressure", "P_g,in", "Pa", Range::FINITE, None,
        "Gauge pressure in the reservoir at which the compressor starts.",
        "choice of the experiment", "give a gauge pressure below supply.cut_out_gauge_pressure";
    CUT_OUT = "supply.cut_out_gauge_pressure", "P_g,out", "Pa", Range::FINITE, None,
        "Gauge pressure in the reservoir at which the compressor stops.",
        "choice of the experiment", "give a gauge pressure above supply.cut_in_gauge_pressure";
    LAG = "supply.lag", "tau", "s", Range::POSITIVE, None,
        "Time constant of a regulator that holds the supply's gauge pressure; no regulator when absent.",
        "choice of the experiment", "give a time such as 20 ms";
    DROOP = "supply.droop", "D", "Pa*s/kg", Range::NON_NEGATIVE, Some(0.0),
        "Loss of the regulator's outlet pressure over the flow.",
        "data sheet of the regulator", "give zero or more, the slope of the maker's flow curve";
    DEAD_BAND = "supply.dead_band", "B", "Pa", Range::NON_NEGATIVE, Some(0.0),
        "Error of the outlet pressure to either side within which the regulator rests.",
        "data sheet of the regulator", "give zero or more";
    ACTUATORS = "supply.actuators", "N", "", Range { low: 1.0, low_included: true, ..Range::POSITIVE }, Some(1.0),
        "How many actuators, or joints of two, all alike, draw from the reservoir or the regulator.",
        "choice of the experiment", "give a number of one or more";
    FLOW_AREA = "valve.flow_area", "A_p C_q", "m^2", Range::POSITIVE, None,
        "Effective area of the valve's flow path, area times flow coefficient.",
        "paper, section 3.2: 1.8e-5 ft^2", "give an area such as 1.8e-5 ft^2";
    SONIC_CONDUCTANCE = "valve.sonic_conductance", "C", "m^3/(s*Pa)", Range::POSITIVE, None,
        "Sonic conductance of the valve at the reference atmosphere.",
        "ISO 6358-1", "give a conductance such as 0.5 L/(s*bar)";
    CRITICAL_RATIO = "valve.critical_ratio", "b", "", Range { low: 0.0, low_included: true, high: 1.0, high_included: false }, None,
        "Critical back-pressure ratio below which the flow is choked.",
        "ISO 6358-1", "give a ratio such as 0.3";
    KV = "valve.kv", "Kv", "m^3/s", Range::POSITIVE, None,
        "Flow coefficient Kv: the flow of water at a pressure drop of 1 bar.",
        "IEC 60534-2-1", "give a flow of water with its unit, such as 0.05 m^3/h or 0.8 L/min";
    CV = "valve.cv", "Cv", "", Range::POSITIVE, None,
        "Flow coefficient Cv: the flow of water in US gallons per minute at a pressure drop of 1 psi.",
        "ISA-75.01", "give the number of the data sheet, such as 0.05";
    PRESSURE_DROP_RATIO = "valve.pressure_drop_ratio", "x_T", "", Range::open(0.0, 1.0), Some(0.7),
        "Pressure drop over upstream pressure at which air chokes in a valve stated by Kv or Cv.",
        "IEC 60534-2-1; the value is assumed, from the usual 0.6 to 0.8", "give a ratio such as 0.7";
    EXHAUST_FLOW_AREA = "valve.exhaust.flow_area", "A_p C_q", "m^2", Range::POSITIVE, None,
        "Effective area of the flow path to the atmosphere, where it differs.",
        "paper, section 3.2", "give an area such as 1.8e-5 ft^2";
    EXHAUST_SONIC_CONDUCTANCE = "valve.exhaust.sonic_conductance", "C", "m^3/(s*Pa)", Range::POSITIVE, None,
        "Sonic conductance of the flow path to the atmosphere, where it differs.",
        "ISO 6358-1", "give a conductance such as 0.5 L/(s*bar)";
    EXHAUST_CRITICAL_RATIO = "valve.exhaust.critical_ratio", "b", "", Range { low: 0.0, low_included: true, high: 1.0, high_included: false }, None,
        "Critical back-pressure ratio of the flow path to the atmosphere.",
        "ISO 6358-1", "give a ratio such as 0.3";
    EXHAUST_KV = "valve.exhaust.kv", "Kv", "m^3/s", Range::POSITIVE, None,
        "Flow coefficient Kv of the flow path to the atmosphere, where it differs.",
        "IEC 60534-2-1", "give a flow of water with its unit, such as 0.05 m^3/h or 0.8 L/min";
    EXHAUST_CV = "valve.exhaust.cv", "Cv", "", Range::POSITIVE, None,
        "Flow coefficient Cv of the flow path to the atmosphere, where it differs.",
        "ISA-75.01", "give the number of the data sheet, such as 0.05";
    EXHAUST_PRESSURE_DROP_RATIO = "valve.exhaust.pressure_drop_ratio", "x_T", "", Range::open(0.0, 1.0), Some(0.7),
        "Pressure drop over upstream pressure at which air chokes in the flow path to the atmosphere.",
        "IEC 60534-2-1; the value is assumed, from the usual 0.6 to 0.8", "give a ratio such as 0.7";
    SPOOL_FREQUENCY = "valve.spool.natural_frequency", "f_n", "Hz", Range::POSITIVE, None,
        "Undamped natural frequency of the spool with its drive.",
        "manufacturer's data sheet", "give a frequency such as 100 Hz";
    SPOOL_DAMPING_RATIO = "valve.spool.damping_ratio", "zeta", "", Range::POSITIVE, None,
        "Damping ratio of the spool with its drive.",
        "manufacturer's data sheet", "give a ratio such as 0.7";
    SUPPLY_OVERLAP = "valve.spool.supply_overlap", "o_s", "", Range::open(-1.0, 1.0), Some(0.0),
        "Share of the stroke by which the spool covers the supply's edge in the middle; below zero for underlap.",
        "manufacturer's data sheet", "give a share between -1 and 1, such as 0.05";
    EXHAUST_OVERLAP = "valve.spool.exhaust_overlap", "o_e", "", Range::open(-1.0, 1.0), Some(0.0),
        "Share of the stroke by which the spool covers the exhaust's edge in the middle; below zero for underlap.",
        "manufacturer's data sheet", "give a share between -1 and 1, such as 0.05";
    EFFICIENCY = "valve.efficiency", "eta", "", Range::POSITIVE, Some(1.0),
        "Factor on the calculated mass flow.",
        "paper, section 3.3: 0.85", "give a factor such as 0.85";
    OPENING_DELAY = "valve.opening_delay", "t_open", "s", Range::NON_NEGATIVE, Some(0.0),
        "Time from energising the coil to the poppet's motion.",
        "paper, section 3.3: 4 ms; none is assumed where none is given", "give zero or more";
    CLOSING_DELAY = "valve.closing_delay", "t_close", "s", Range::NON_NEGATIVE, Some(0.0),
        "Time from releasing the coil to the poppet's return.",
        "paper, section 3.3: 1 ms; none is assumed where none is given", "give zero or more";
    OPENING_TIME = "valve.opening_time", "t_rise", "s", Range::NON_NEGATIVE, Some(0.0),
        "Time that the poppet takes from shut to open once it moves.",
        "manufacturer's data sheet", "give zero or more";
    CLOSING_TIME = "valve.closing_time", "t_fall", "s", Range::NON_NEGATIVE, Some(0.0),
        "Time that the poppet takes from open to shut once it moves.",
        "manufacturer's data sheet", "give zero or more";
    REGULATOR_TIME_CONSTANT = "valve.time_constant", "tau", "s", Range::POSITIVE, None,
        "Time constant with which the regulated pressure follows its set point.",
        "manufacturer's data sheet", "give a time above zero, such as 30 ms";
    VALVE_DEAD_TIME = "valve.dead_time", "theta", "s", Range::NON_NEGATIVE, Some(0.0),
        "Dead time: the command acts so much later, whatever its length; opening and closing delays follow it.",
        "manufacturer's data sheet", "give zero or more";
    REGULATOR_RATE_LIMIT = "valve.rate_limit", "q", "Pa/s", Range::POSITIVE, None,
        "Largest rate of the regulated pressure.",
        "manufacturer's data sheet", "give a rate above zero, such as 20 bar/s";
    LAMINAR_RATIO = "valve.laminar_ratio", "r_lam", "", Range::open(0.0, 1.0), Some(0.999),
        "Pressure ratio above which the flow law is a straight line to zero.",
        "ISO 6358 practice; the value is assumed", "give a ratio just below 1, above the critical ratio";
    HOSE_LENGTH = "hose.length", "L_h", "m", Range::POSITIVE, None,
        "Length of the hose from the valve to the actuator.",
        "the paper names the hose and gives none", "give a length such as 1 m, or leave [hose] out";
    HOSE_DIAMETER = "hose.diameter", "d", "m", Range::POSITIVE, None,
        "Inner diameter of the hose.",
        "the paper names the hose and gives none", "give an inner diameter such as 2.5 mm";
    HOSE_VISCOSITY = "hose.viscosity", "mu", "Pa*s", Range::POSITIVE, Some(1.82e-5),
        "Dynamic viscosity of the gas in the hose.",
        "textbook: air at 20 degC", "give a viscosity such as 1.82e-5 Pa*s";
    HOSE_INDEX = "hose.polytropic_index", "kappa", "", Range { low: 1.0, low_included: true, high: 2.0, high_included: true }, Some(1.0),
        "Polytropic exponent of the hose's air: 1 where the wall keeps its temperature, gamma for quick small waves.",
        "textbook; the default is assumed", "give a number from 1 to gamma";
    HOSE_CELLS = "hose.cells", "n", "", Range { low: 1.0, low_included: true, high: 8.0, high_included: true }, Some(4.0),
        "Number of cells of a distributed hose.",
        "choice of the user", "give a whole number from 1 to 8";
    PWM_FREQUENCY = "command.frequency", "f", "Hz", Range::POSITIVE, None,
        "Frequency of the pulse-width modulation.",
        "paper, section 3.3: 25 and 50 Hz", "give a frequency such as 25 Hz";
    DUTY = "command.duty", "d", "", Range::FRACTION, None,
        "Commanded duty cycle, the share of each period that the pulse lasts; of a three-way valve, in which it is to fill.",
        "paper, section 3.3: 0.5", "give a number from 0 to 1";
    COMMAND_TIME = "command.time", "t", "s", Range::NON_NEGATIVE, None,
        "Times at which a table command or a set point changes, strictly rising.",
        "choice of the experiment", "give times of zero or more in rising order";
    COMMAND_GAUGE_PRESSURE = "command.gauge_pressure", "P_g,set", "Pa", Range::NON_NEGATIVE, None,
        "Set points of a pressure regulator from each of those times on.",
        "choice of the experiment", "give gauge pressures from zero to that of the supply";
    COMMAND_POSITION = "command.position", "u", "", Range { low: -1.0, low_included: true, high: 1.0, high_included: true }, None,
        "Positions of a proportional spool from each of those times on, as shares of its stroke: 1 opens the supply, -1 the exhaust.",
        "choice of the experiment", "give positions from -1 to 1";
    SERIES_TIME = "pressure.time", "t", "s", Range::NON_NEGATIVE, None,
        "Times of the rows of a pressure that is given, strictly rising.",
        "choice of the experiment", "give times of zero or more in rising order";
    SERIES_GAUGE_PRESSURE = "pressure.gauge_pressure", "P_g(t)", "Pa", Range::FINITE, None,
        "Gauge pressure in the actuator at each of those times, with straight lines between them.",
        "choice of the experiment", "give gauge pressures above minus the atmospheric pressure";
    SERIES_OFFSET = "pressure.offset", "o", "Pa", Range::FINITE, Some(0.0),
        "What the sensor that recorded the given pressure shows at zero gauge pressure: it is subtracted.",
        "calibration of the sensor", "give a finite pressure, or leave it out";
    SERIES_SCALE = "pressure.scale", "s", "", Range::POSITIVE, Some(1.0),
        "Reading of that sensor over the gauge pressure: what is recorded is divided by it.",
        "calibration of the sensor", "give a number above zero, or leave it out";
    SERIES_SHIFT = "pressure.shift", "delta", "s", Range::FINITE, Some(0.0),
        "By how much readings of that sensor come late; the pressure holds that much earlier than its rows say.",
        "clocks of the rig", "give a finite time, or leave it out";
    TENDON_STIFFNESS = "tendon.stiffness", "k", "N/m", Range::POSITIVE, None,
        "Stiffness of an elastic tendon in series with the actuator.",
        "Hooke", "give a stiffness above zero, or leave [tendon] out";
    TENDON_REST_LENGTH = "tendon.rest_length", "l", "m", Range::NON_NEGATIVE, Some(0.0),
        "Length of that tendon without tension, which only says where its load is.",
        "choice of the experiment", "give a length of zero or more";
    MASS = "load.mass", "M", "kg", Range::POSITIVE, None,
        "Mass that the actuator moves.",
        "paper, (15)", "give a mass above zero";
    GRAVITY = "load.gravity", "g", "m/s^2", Range::FINITE, Some(9.80665),
        "Acceleration of gravity along the actuator, positive when it stretches.",
        "standard gravity", "give a finite acceleration";
    LOAD_FORCE = "load.force", "W", "N", Range::FINITE, None,
        "Constant force that pulls the actuator longer.",
        "elementary mechanics", "give a finite force";
    PULLEY_RADIUS = "load.pulley_radius", "r", "m", Range::POSITIVE, None,
        "Radius of the pulley from which the actuator turns the joint.",
        "elementary mechanics", "give a radius such as 20 mm";
    MOMENT_ARM_ANGLE = "load.moment_arm_angle", "theta_i", "rad", Range::FINITE, None,
        "Joint angles of a table of moment arms, strictly rising.",
        "choice of the measurement", "give 2 to 16 angles in rising order";
    MOMENT_ARM = "load.moment_arm", "r_i", "m", Range::POSITIVE, None,
        "Moment arms of the actuator about the joint at those angles, in place of a pulley.",
        "virtual work", "give lengths above zero, one for each angle";
    REST_LENGTH = "load.rest_length", "L_0", "m", Range::POSITIVE, None,
        "Distance between the actuator's attachments at joint angle zero.",
        "choice of the experiment", "give a length between the shortest and the longest of the actuator";
    LIMB_DISTANCE = "load.distance", "d", "m", Range::NON_NEGATIVE, None,
        "Distance of the limb's centre of mass from the axis of the joint.",
        "elementary mechanics", "give zero for a balanced limb, or a distance such as 100 mm";
    LIMB_INERTIA = "load.inertia", "I", "kg*m^2", Range::NON_NEGATIVE, Some(0.0),
        "Moment of inertia of the limb about its own centre of mass.",
        "elementary mechanics", "give zero for a point mass, or a moment of inertia";
    HANGING_ANGLE = "load.hanging_angle", "theta_0", "rad", Range::FINITE, Some(0.0),
        "Joint angle at which the limb hangs straight below the axis.",
        "choice of the experiment", "give a finite angle";
    JOINT_TORQUE = "load.torque", "W", "N*m", Range::FINITE, Some(0.0),
        "Constant torque on the joint, positive the way that the first actuator turns it.",
        "choice of the experiment", "give a finite torque";
    JOINT_DAMPING = "load.damping", "c", "N*m*s/rad", Range::NON_NEGATIVE, Some(0.0),
        "Viscous damping of the joint.",
        "elementary mechanics", "give zero or more";
    MIN_ANGLE = "load.min_angle", "theta_min", "rad", Range::FINITE, None,
        "Joint angle at which the lower stop is met; no stop when absent.",
        "choice of the experiment", "give an angle below max_angle, or leave it out for no stop";
    MAX_ANGLE = "load.max_angle", "theta_max", "rad", Range::FINITE, None,
        "Joint angle at which the upper stop is met; no stop when absent.",
        "choice of the experiment", "give an angle above min_angle, or leave it out for no stop";
    STOP_STIFFNESS = "load.stop_stiffness", "K_stop", "N*m/rad", Range::POSITIVE, Some(500.0),
        "Stiffness of the stops of the joint.",
        "assumed", "give a stiffness much larger than the joint's own";
    STOP_DAMPING = "load.stop_damping", "C_stop", "N*m*s/rad", Range::NON_NEGATIVE, Some(1.0),
        "Viscous damping of the stops of the joint.",
        "assumed", "give zero or more";
    INITIAL_GAUGE_PRESSURE = "initial.gauge_pressure", "P_g(0)", "Pa", Range::FINITE, Some(0.0),
        "Gauge pressure in the actuator at the start.",
        "choice of the experiment", "give a gauge pressure above minus the atmospheric pressure";
    INITIAL_TEMPERATURE = "initial.temperature", "T(0)", "K", Range::POSITIVE, Some(293.15),
        "Temperature of the actuator's air at the start, which fixes its mass.",
        "choice of the experiment", "give an absolute temperature above zero";
    INITIAL_LENGTH = "initial.length", "L(0)", "m", Range::POSITIVE, None,
        "Distance between the attachments at the start.",
        "choice of the experiment", "give a length between 0 and the thread length, or \"equilibrium\"";
    INITIAL_VELOCITY = "initial.velocity", "v(0)", "m/s", Range::FINITE, Some(0.0),
        "Velocity of lengthening at the start.",
        "choice of the experiment", "give a finite velocity";
    INITIAL_ANGLE = "initial.angle", "theta(0)", "rad", Range::FINITE, None,
        "Joint angle at the start.",
        "choice of the experiment", "give an angle, or \"equilibrium\"";
    INITIAL_ANGULAR_VELOCITY = "initial.angular_velocity", "omega(0)", "rad/s", Range::FINITE, Some(0.0),
        "Angular velocity of the joint at the start.",
        "choice of the experiment", "give a finite angular velocity";
    DURATION = "run.duration", "t_end", "s", Range::POSITIVE, None,
        "Simulated time.",
        "choice of the experiment", "give a time above zero";
    SAMPLE_INTERVAL = "run.sample_interval", "dt", "s", Range::POSITIVE, Some(1e-3),
        "Time between two written samples.",
        "choice of the experiment", "give a time above zero and not above the duration";
    RELATIVE_TOLERANCE = "run.relative_tolerance", "rtol", "", Range { low: 1e-13, low_included: true, high: 1e-2, high_included: true }, Some(1e-8),
        "Relative error that the event-located integrator allows a step.",
        "choice of the experiment", "give a number such as 1e-8";
    STEP = "run.step", "h", "s", Range::POSITIVE, None,
        "Step of the fixed-step engine; when absent it follows from the accuracy.",
        "choice of the experiment", "give a time such as 0.1 ms, or leave it out and give run.accuracy";
    ACCURACY = "run.accuracy", "eps", "", Range { low: 1e-9, low_included: true, high: 1e-1, high_included: true }, Some(1e-3),
        "Largest error of the fixed-step engine as a share of each state's range, from which the step follows when none is given.",
        "choice of the experiment", "give a number such as 1e-3";
    MOTION_PHASE = "load.phase", "phi", "rad", Range::FINITE, Some(0.0),
        "Phase of a sinusoidal prescribed motion at the start.",
        "choice of the experiment", "give an angle";
    MOTION_TIME = "load.time", "t", "s", Range::NON_NEGATIVE, None,
        "Times of a prescribed motion given as a table, strictly rising.",
        "choice of the experiment", "give times of zero or more in rising order";
    MOTION_TABLE_LENGTH = "load.table_length", "L", "m", Range::POSITIVE, None,
        "Lengths of a prescribed motion given as a table, joined by straight lines.",
        "choice of the experiment", "give one length for each time";
    MOTION_LENGTH = "load.length", "L_0", "m", Range::POSITIVE, None,
        "Mean length of a sinusoidal prescribed motion.",
        "choice of the experiment", "give a length below the thread length";
    MOTION_AMPLITUDE = "load.amplitude", "A", "m", Range::NON_NEGATIVE, None,
        "Amplitude of a sinusoidal prescribed motion.",
        "choice of the experiment", "give an amplitude that keeps the length positive and below the thread length";
    MOTION_FREQUENCY = "load.frequency", "f_0", "Hz", Range::POSITIVE, None,
        "Frequency of a sinusoidal prescribed motion.",
        "choice of the experiment", "give a frequency above zero";
}

parameters! {
    /// The rows of an effectiveness that is no constant.
    EFFECTIVENESS_LISTS:
    EFFECTIVENESS_POLYNOMIAL = "actuator.effectiveness.polynomial", "e_k", "", Range::FINITE, None,
        "Coefficients of Eff = e0 + e1 p + e2 p^2 + ..., p being the gauge pressure in `pressure_unit`.",
        "choice of the experiment", "give finite numbers";
    EFFECTIVENESS_PRESSURE = "actuator.effectiveness.gauge_pressure", "P_g", "Pa", Range::FINITE, None,
        "Gauge pressures at which the effectiveness was measured, increasing.",
        "choice of the experiment", "give finite pressures";
    EFFECTIVENESS_VALUE = "actuator.effectiveness.value", "Eff", "", Range::NON_NEGATIVE, None,
        "Effectiveness at each gauge pressure.",
        "choice of the experiment", "give ratios such as 0.9";
}

parameters! {
    /// The rows of controllers. What has the unit of the controlled quantity is in [`crate::control::Quantity::rows`].
    CONTROL:
    CONTROL_RATE = "controller.rate", "f_s", "Hz", Range::POSITIVE, None,
        "Number of samples a second that the controller takes.",
        "choice of the experiment", "give a rate such as 200 Hz";
    CONTROL_DELAY = "controller.delay", "d", "", Range { low: 0.0, low_included: true, high: 16.0, high_included: true }, Some(0.0),
        "Number of sampling instants between a measurement and its effect.",
        "choice of the experiment", "give a whole number from 0 to 16";
    PULSE_FREQUENCY = "controller.pulse_frequency", "f", "Hz", Range::POSITIVE, None,
        "Frequency of the pulse-width modulation that follows a duty cycle; the rate when absent.",
        "choice of the experiment", "give a frequency such as 50 Hz, or leave it out for a pulse each sample";
    SET_GAUGE_PRESSURE = "controller.gauge_pressure", "P_g,set", "Pa", Range::FINITE, None,
        "Gauge pressure that the controller is to reach.",
        "choice of the experiment", "give a gauge pressure such as 40 psi";
    SET_LENGTH = "controller.length", "L_set", "m", Range::POSITIVE, None,
        "Distance between the attachments that the controller is to reach.",
        "choice of the experiment", "give a length between the shortest and the longest of the actuator";
    SET_AIR_MASS = "controller.air_mass", "m_set", "kg", Range::NON_NEGATIVE, None,
        "Mass of air that the controller is to reach.",
        "choice of the experiment", "give a mass such as 0.05 g";
    SET_FORCE = "controller.force", "F_set", "N", Range::NON_NEGATIVE, None,
        "Tension that the actuator is to hold.",
        "choice of the experiment", "give a force of zero or more: a tendon can only pull";
    SET_ANGLE = "controller.angle", "theta_set", "rad", Range::FINITE, None,
        "Joint angle that the controller is to reach.",
        "choice of the experiment", "give an angle such as 20 deg";
    SET_TORQUE = "controller.torque", "tau_set", "N*m", Range::FINITE, None,
        "Torque that the two actuators are to hold together, positive the way that the first one turns.",
        "choice of the experiment", "give a finite torque";
    SET_STIFFNESS = "controller.stiffness", "K_set", "N*m/rad", Range::NON_NEGATIVE, None,
        "Stiffness that the two actuators are to give the joint.",
        "choice of the experiment", "give zero or more";
    SET_FREQUENCY = "controller.frequency", "f_set", "Hz", Range::POSITIVE, None,
        "Frequency of a sinusoidal set point.",
        "choice of the experiment", "give a frequency above zero";
    SET_PHASE = "controller.phase", "phi_set", "rad", Range::FINITE, Some(0.0),
        "Phase of a sinusoidal set point at the start.",
        "choice of the experiment", "give an angle";
    SET_TIME = "controller.time", "t", "s", Range::NON_NEGATIVE, None,
        "Times of a set point given as a table, strictly rising.",
        "choice of the experiment", "give times of zero or more in rising order";
    INTEGRAL_TIME = "controller.integral_time", "T_i", "s", Range::POSITIVE, None,
        "Time in which the integral repeats the proportional action; no integral when absent.",
        "textbook", "give a time such as 0.5 s, or leave it out for no integral";
    DERIVATIVE_TIME = "controller.derivative_time", "T_d", "s", Range::NON_NEGATIVE, Some(0.0),
        "Time by which the derivative looks ahead.",
        "textbook", "give zero for no derivative, or a time such as 20 ms";
    DERIVATIVE_FILTER = "controller.derivative_filter", "N", "", Range::POSITIVE, Some(10.0),
        "Largest gain of the derivative over the proportional gain; its filter has the time constant T_d/N.",
        "textbook; the value is assumed", "give a number such as 10";
    SET_POINT_WEIGHT = "controller.set_point_weight", "beta", "", Range::FRACTION, Some(1.0),
        "Share of the set point that the proportional action sees.",
        "textbook", "give a number from 0 to 1";
    TRACKING_TIME = "controller.tracking_time", "T_t", "s", Range::POSITIVE, None,
        "Time in which the integral is drawn back while the output is at its limit; sqrt(T_i T_d), or T_i without derivative, when absent.",
        "textbook", "give a time such as that of the integral";
    BIAS = "controller.bias", "u_0", "", Range { low: -1.0, low_included: true, high: 1.0, high_included: true }, Some(0.0),
        "Output of the controller at no error before its integral has moved.",
        "choice of the experiment", "give a number from -1 to 1";
    HIGHEST_GAUGE_PRESSURE = "controller.highest_gauge_pressure", "P_g,max", "Pa", Range::POSITIVE, None,
        "Highest gauge pressure that a model in the controller requests.",
        "choice of the experiment", "give at most the gauge pressure of the supply";
    PULLEY_ARM = "controller.arm", "r", "m", Range::POSITIVE, None,
        "Radius of the pulley from which an actuator turns the joint.",
        "elementary mechanics", "give a radius such as 20 mm";
    ARM_SLOPE = "controller.arm_slope", "r'", "m/rad", Range::FINITE, None,
        "Slope of a moment arm over the joint's angle.",
        "virtual work", "give a finite slope, zero for a pulley";
    CONTROL_TEMPERATURE = "controller.temperature", "T", "K", Range::POSITIVE, Some(293.15),
        "Temperature of the air that the controller reckons with.",
        "choice of the experiment", "give an absolute temperature above zero, such as 20 degC";
}
