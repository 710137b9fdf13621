//! The one table of sections and keys.
//!
//! A key that is a physical quantity refers to its row of the core's parameter table, which holds its unit, range,
//! default, source and sentence; the few quantities that only a file has (times and lengths of tables, a phase) have
//! rows of the same kind here. The check for unknown keys, the JSON schema and the starter file are made from this
//! table, and the reading looks up nothing that is not in it.
//!
//! Checked by `tests/tables.rs`: every row of the core's table has its key, and every example is accepted.

mod plant;

use crate::choice::{
    BladderForm, Choice, CommandKind, CommandState, ControllerKind, DesignKind, Engine, ExhaustTemperature, ForceLaw,
    HoseKind, HysteresisLaw, LoadKind, Method, PressurePlace, ProcessKind, RecordKind, SetPointTable, StatisticsOver,
    ValveKind,
};
use crate::nearest::nearest;
use crate::presets;
use crate::sweep::{MOST_ROWS, Reduction};
use mckibben::parameter::{self as p, Parameter, Range};
pub(crate) use plant::*;
pub use plant::{PLANT_KEYS, PLANT_SECTIONS};

/// What a key holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A quantity: a string with a unit, or a number when the parameter has no unit.
    Quantity(&'static Parameter),
    /// A quantity or one word.
    QuantityOr(&'static Parameter, Choice),
    /// A list of quantities.
    Quantities(&'static Parameter),
    /// A whole number.
    Whole(&'static Parameter),
    /// A unit of the same dimension as this one.
    Unit(&'static str),
    /// A quantity, or a list of them at the times of a table.
    TimeSeries(&'static Parameter),
    /// A quantity in the unit of what the controller regulates.
    Regulated,
    /// The name of another part of the file.
    Name,
    /// One of these words.
    Choice(&'static [Choice]),
    /// A list of these words.
    Choices(&'static [Choice]),
}

/// The choice under which a key has a meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct When {
    /// Path of the key that holds the choice.
    pub key: &'static str,
    /// The words under which this key applies.
    pub words: &'static [&'static str],
}

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Path, such as `valve.efficiency`.
    pub path: &'static str,
    /// What it holds.
    pub kind: Kind,
    /// What it is, as one sentence.
    pub meaning: &'static str,
    /// The word that stands in for an absent choice.
    pub default: Option<&'static str>,
    /// Whether it must be given wherever its section is and it applies. Keys that a preset can give are not.
    pub required: bool,
    /// When it applies; always, when `None`.
    pub when: Option<When>,
    /// A value as it is written in a file.
    pub example: &'static str,
}

impl Key {
    /// Path of the section, such as `actuator.friction`.
    pub fn section(&self) -> &'static str {
        self.path.rsplit_once('.').map_or("", |(section, _)| section)
    }

    /// Name inside the section, such as `viscous`.
    pub fn name(&self) -> &'static str {
        self.path.rsplit_once('.').map_or(self.path, |(_, name)| name)
    }

    /// The row of the parameter table, when the key is a quantity or a list of them.
    pub fn parameter(&self) -> Option<&'static Parameter> {
        match self.kind {
            Kind::Quantity(row)
            | Kind::QuantityOr(row, _)
            | Kind::Quantities(row)
            | Kind::Whole(row)
            | Kind::TimeSeries(row) => Some(row),
            Kind::Regulated | Kind::Unit(_) | Kind::Name | Kind::Choice(_) | Kind::Choices(_) => None,
        }
    }

    /// Whether a sweep can vary it: it can hold one value and describes the scenario, not the sweep.
    pub fn varies(&self) -> bool {
        !matches!(self.kind, Kind::Quantities(_) | Kind::Choices(_)) && self.section() != SWEEP
    }

    const fn required(self) -> Self {
        Self { required: true, ..self }
    }

    const fn when(self, key: &'static str, words: &'static [&'static str]) -> Self {
        Self { when: Some(When { key, words }), ..self }
    }

    const fn or(self, default: &'static str) -> Self {
        Self { default: Some(default), ..self }
    }
}

/// A section of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Path, such as `actuator.friction`.
    pub path: &'static str,
    /// What it describes, as one sentence.
    pub meaning: &'static str,
    /// Whether every file must have it.
    pub required: bool,
}

/// The word of `initial.length` that stands for the length at which the load is balanced.
pub const EQUILIBRIUM: Choice = Choice {
    name: "equilibrium",
    meaning: "Where the actuator balances the load at the initial pressure, on the taut braid if need be.",
};

/// The word of `initial.angle` that stands for the angle at which the torques balance.
pub const BALANCED: Choice = Choice {
    name: "equilibrium",
    meaning: "Where the torques of both actuators and the load balance at the initial pressures.",
};

const fn row(
    key: &'static str,
    symbol: &'static str,
    unit: &'static str,
    range: Range,
    text: [&'static str; 2],
) -> Parameter {
    let [meaning, remedy] = text;
    Parameter { key, symbol, unit, range, default: None, meaning, source: "choice of the experiment", remedy }
}

/// Whole numbers from 1 to the most rows of a sweep.
const COUNTS: Range = Range { low: 1.0, low_included: true, high: MOST_ROWS as f64, high_included: true };

/// Rows of a sweep.
pub static SWEEP_ROWS: Parameter = row(
    "sweep.rows",
    "n",
    "",
    COUNTS,
    ["Number of rows, with every design but a grid.", "give a whole number such as 4096"],
);
/// Seed of a sweep.
pub static SWEEP_SEED: Parameter = Parameter {
    default: Some(0.0),
    ..row(
        "sweep.seed",
        "seed",
        "",
        Range { low: 0.0, low_included: true, high: 9_007_199_254_740_992.0, high_included: true },
        ["Seed of the random numbers; of a Sobol' sequence, of its scrambling.", "give a whole number of zero or more"],
    )
};
/// Times of a sweep's samples.
pub static SAMPLE_TIMES: Parameter = row(
    "sweep.sample_times",
    "t",
    "s",
    Range::NON_NEGATIVE,
    ["Times at which each row is recorded, increasing.", "give times from zero to the run's duration"],
);
/// Rows in a part of a sweep's result.
pub static PART_ROWS: Parameter = row(
    "sweep.part_rows",
    "n_part",
    "",
    COUNTS,
    ["Rows in a part of the result; chosen from what is recorded when absent.", "give a whole number such as 4096"],
);
/// Steps of a range that varies.
pub static COUNT: Parameter =
    row("count", "n", "", Range { low: 2.0, ..COUNTS }, ["Number of evenly spaced values.", COUNT_REMEDY]);
const COUNT_REMEDY: &str = "give 2 or more, so that both ends are among the values, or one value as a list";
/// Geometric standard deviation of a log-normal distribution.
pub static FACTOR: Parameter = row(
    "factor",
    "exp(sigma)",
    "",
    Range { low: 1.0, ..Range::POSITIVE },
    ["Geometric standard deviation.", "give a factor above 1, such as 1.5"],
);

/// The section of the second actuator of a joint.
pub const ANTAGONIST: &str = "antagonist";
/// What that section may hold: whole sections, and single keys.
const OF_ANTAGONIST: (&[&str], &[&str]) = (
    &["actuator", "supply", "valve", "hose", "command", "pressure", "tendon"],
    &[
        "load.pulley_radius",
        "load.moment_arm_angle",
        "load.moment_arm",
        "load.rest_length",
        "initial.gauge_pressure",
        "initial.temperature",
    ],
);

/// Whether a key can be given to the second actuator of a joint, under [`ANTAGONIST`].
pub fn is_of_antagonist(path: &str) -> bool {
    let (sections, keys) = OF_ANTAGONIST;
    keys.contains(&path) || path.split('.').next().is_some_and(|root| path != root && sections.contains(&root))
}

/// Whether a section can be given to the second actuator of a joint, under [`ANTAGONIST`].
pub fn is_section_of_antagonist(path: &str) -> bool {
    section_at(path).is_some() && KEYS.iter().any(|key| key.section() == path && is_of_antagonist(key.path))
}

/// The path that a path under [`ANTAGONIST`] stands for, of the first actuator.
pub fn in_antagonist(path: &str) -> Option<&str> {
    path.strip_prefix(ANTAGONIST)?.strip_prefix('.')
}

/// The section that describes a controller.
pub const CONTROLLER: &str = "controller";
/// The section that describes a sweep.
pub const SWEEP: &str = "sweep";
/// The section whose entries are the paths of other keys.
pub const VARY: &str = "sweep.vary";

/// Every section in the order of the file.
pub static SECTIONS: &[Section] = &[
    section("actuator", "The braided actuator.", false),
    section("actuator.force", "The law of static force.", false),
    section("actuator.taper", "Cones at the ends; without it the muscle is a cylinder up to its fittings.", false),
    section("actuator.bladder", "Elasticity of the bladder; without it the bladder is limp.", false),
    section("actuator.effectiveness", "Measured force over ideal force: a constant, a polynomial or a table.", false),
    section("actuator.friction", "Friction between threads and bladder.", false),
    section("actuator.friction.hysteresis", "Friction that remembers the turns of the length.", false),
    section("actuator.friction.viscoelastic", "Springs with dashpots in series: creep and relaxation.", false),
    section("actuator.limit", "The taut braid at full stretch.", false),
    section("air", "The gas in the actuator and around it.", false),
    section("supply", "The air that the valve joins the actuator to.", false),
    section("valve", "The valve; without it the actuator is sealed.", false),
    section(
        "valve.exhaust",
        "The valve's flow path to the atmosphere, where it differs from the one to the supply.",
        false,
    ),
    section("valve.spool", "The proportional spool; given exactly when `valve.kind` is `proportional-spool`.", false),
    section("hose", "The hose from the valve to the actuator; none when absent.", false),
    section("command", "The command to the valve; given exactly when there is a valve.", false),
    section(CONTROLLER, "The controller; given exactly when `command.kind` is `controllers`.", false),
    section(
        "pressure",
        "The pressure in the actuator or its hose over time, in place of a valve; none when absent.",
        false,
    ),
    section("tendon", "An elastic tendon between actuator and load; none when absent.", false),
    section("load", "What the actuator pulls on.", true),
    section("initial", "The state at the start.", false),
    section(
        ANTAGONIST,
        "What differs of the second actuator of an antagonistic joint: the sections above once more, key by key.",
        false,
    ),
    section("run", "How long to simulate and what to record.", true),
    section(SWEEP, "Many runs: how their rows are chosen and what is recorded of each.", false),
    section(VARY, "What varies: for the path of each key a list, a range or a distribution.", false),
];

const fn section(path: &'static str, meaning: &'static str, required: bool) -> Section {
    Section { path, meaning, required }
}

const fn key(path: &'static str, kind: Kind, meaning: &'static str, example: &'static str) -> Key {
    Key { path, kind, meaning, default: None, required: false, when: None, example }
}

const fn quantity(row: &'static Parameter, example: &'static str) -> Key {
    key(row.key, Kind::Quantity(row), row.meaning, example)
}

const fn list(row: &'static Parameter, example: &'static str) -> Key {
    key(row.key, Kind::Quantities(row), row.meaning, example)
}

const fn set_point_series(row: &'static Parameter, example: &'static str) -> Key {
    key(row.key, Kind::TimeSeries(row), row.meaning, example)
}

const fn regulated(path: &'static str, meaning: &'static str, example: &'static str) -> Key {
    key(path, Kind::Regulated, meaning, example)
}

const fn whole(row: &'static Parameter, example: &'static str) -> Key {
    key(row.key, Kind::Whole(row), row.meaning, example)
}

const fn choice(path: &'static str, choices: &'static [Choice], meaning: &'static str, example: &'static str) -> Key {
    key(path, Kind::Choice(choices), meaning, example)
}

const DESIGN: &str = "sweep.design";
const RECORD: &str = "sweep.record";
const NO_GRID: &[&str] = &[DesignKind::Random.name(), DesignKind::LatinHypercube.name(), DesignKind::Sobol.name()];
const HYSTERESIS: &str = "actuator.friction.hysteresis.law";
const ELEMENTS: &[&str] = &[HysteresisLaw::MaxwellSlip.name()];
const ROUNDED: &[&str] = &[HysteresisLaw::BoucWen.name()];
const BRISTLES: &[&str] = &[HysteresisLaw::LuGre.name()];
const ONE_WIDTH: &[&str] = &[HysteresisLaw::BoucWen.name(), HysteresisLaw::LuGre.name()];
pub(crate) const PRESSURE_AT: &str = "pressure.at";
const FORCE: &str = "actuator.force.law";
const TONDU_LOPEZ: &[&str] = &[ForceLaw::TonduLopez.name()];
const SAROSI: &[&str] = &[ForceLaw::Sarosi.name()];
const WITH_UNITS: &[&str] = &[ForceLaw::Sarosi.name(), ForceLaw::Polynomial.name()];
const POLYNOMIAL_LAW: &[&str] = &[ForceLaw::Polynomial.name()];
const MARTENS_BOBLAN: &[&str] = &[ForceLaw::MartensBoblan.name()];
const EXTENSIBLE: &[&str] = &[ForceLaw::ExtensibleBraid.name()];
const BOLEN: &[&str] = &[ForceLaw::Bolen.name()];
const MAP: &[&str] = &[ForceLaw::Map.name()];
const BLADDER: &str = "actuator.bladder.form";
const CURVED: &[&str] = &[BladderForm::Saturating.name(), BladderForm::Exponential.name()];
const PROCESS: &str = "air.process";
const VALVE: &str = "valve.kind";
const REGULATING: &[&str] = &[ValveKind::PressureRegulator.name()];
const SPOOLING: &[&str] = &[ValveKind::ProportionalSpool.name()];
const HOSE: &str = "hose.kind";
const COMMAND: &str = "command.kind";
const CONTROL: &str = "controller.kind";
const TRACKING: &[&str] = &[ControllerKind::BangBang.name(), ControllerKind::Pid.name()];
const BY_MODEL: &[&str] = &[ControllerKind::FeedForward.name(), ControllerKind::AirMass.name()];
const RELAYS: &[&str] =
    &[ControllerKind::BangBang.name(), ControllerKind::FeedForward.name(), ControllerKind::AirMass.name()];
const PIDS: &[&str] = &[ControllerKind::Pid.name(), ControllerKind::FeedForward.name(), ControllerKind::AirMass.name()];
const LOAD: &str = "load.kind";
const MOTION: &[&str] = &[LoadKind::PrescribedMotion.name()];
const JOINT: &[&str] = &[LoadKind::AntagonisticJoint.name()];
const WITH_MASS: &[&str] =
    &[LoadKind::HangingMass.name(), LoadKind::ConstantForce.name(), LoadKind::AntagonisticJoint.name()];
const WITH_GRAVITY: &[&str] = &[LoadKind::HangingMass.name(), LoadKind::AntagonisticJoint.name()];

/// Every key in the order of the file.
pub static KEYS: &[Key] = &[
    choice(
        "actuator.preset",
        presets::ACTUATOR_CHOICES,
        "A named set of values that the other keys override.",
        "\"colbrunn-2001\"",
    ),
    quantity(&p::THREAD_LENGTH, "\"4.3218 in\""),
    quantity(&p::TURNS, "2.5"),
    quantity(&p::LENGTH, "\"200 mm\""),
    quantity(&p::DIAMETER, "\"10 mm\""),
    quantity(&p::BRAID_ANGLE, "\"25 deg\""),
    quantity(&p::MAX_LENGTH, "\"3.85 in\""),
    quantity(&p::MIN_LENGTH, "\"2.4952 in\""),
    quantity(&p::EXTERNAL_VOLUME, "\"3 cm^3\""),
    quantity(&p::LEAKAGE, "\"1e-12 m^3/(s*Pa)\""),
    quantity(&p::WALL_THICKNESS, "\"0.5 mm\""),
    choice(FORCE, ForceLaw::CHOICES, "The law of static force.", "\"ideal-braid\"").or("ideal-braid"),
    quantity(&p::END_FACTOR, "1.1").when(FORCE, TONDU_LOPEZ),
    quantity(&p::END_FACTOR_RISE, "0.2").when(FORCE, TONDU_LOPEZ),
    quantity(&p::END_FACTOR_PRESSURE, "\"1 bar\"").when(FORCE, TONDU_LOPEZ),
    quantity(&p::INITIAL_RADIUS, "\"3.2 mm\"").when(FORCE, TONDU_LOPEZ),
    quantity(&p::TONDU_LOPEZ_A, "11.5").when(FORCE, TONDU_LOPEZ),
    quantity(&p::TONDU_LOPEZ_B, "4.8").when(FORCE, TONDU_LOPEZ),
    list(&p::SAROSI_COEFFICIENTS, "[-4.4, 290, -0.33, -9.3, 298, -300]").required().when(FORCE, SAROSI),
    key("actuator.force.pressure_unit", Kind::Unit("Pa"), "Unit of the pressure in the coefficients.", "\"kPa\"")
        .required()
        .when(FORCE, WITH_UNITS),
    key("actuator.force.force_unit", Kind::Unit("N"), "Unit of the force in the coefficients.", "\"N\"")
        .required()
        .when(FORCE, WITH_UNITS),
    quantity(&p::MEMBRANE_THICKNESS, "\"1.8 mm\"").required().when(FORCE, MARTENS_BOBLAN),
    list(&p::MEMBRANE_MODULUS, "[93.2, -715, 1548, -503]").required().when(FORCE, MARTENS_BOBLAN),
    key("actuator.force.modulus_unit", Kind::Unit("Pa"), "Unit of the modulus in its coefficients.", "\"MPa\"")
        .required()
        .when(FORCE, MARTENS_BOBLAN),
    key("actuator.force.length_unit", Kind::Unit("m"), "Unit of the length in those coefficients.", "\"m\"")
        .required()
        .when(FORCE, MARTENS_BOBLAN),
    quantity(&p::THREAD_STIFFNESS, "\"50 kN/m\"").required().when(FORCE, EXTENSIBLE),
    quantity(&p::MAX_FORCE, "\"1570 N\"").required().when(FORCE, BOLEN),
    quantity(&p::MAX_PRESSURE, "\"620 kPa\"").required().when(FORCE, BOLEN),
    quantity(&p::MAX_CONTRACTION, "0.25").required().when(FORCE, BOLEN),
    list(&p::BOLEN_SHAPE, "[0.2607, 6.398, 1.303]").required().when(FORCE, BOLEN),
    list(&p::PRESSURE_COEFFICIENTS, "[2.9, -21.5, 29.3]").required().when(FORCE, POLYNOMIAL_LAW),
    list(&p::PASSIVE_COEFFICIENTS, "[150, 990]").when(FORCE, POLYNOMIAL_LAW),
    list(&p::MAP_PRESSURE, "[\"2 bar\", \"4 bar\"]").required().when(FORCE, MAP),
    list(&p::MAP_LENGTH, "[\"7 cm\", \"8 cm\", \"9 cm\"]").required().when(FORCE, MAP),
    list(&p::MAP_TENSION, "[\"4 N\", \"16 N\", \"30 N\", \"9 N\", \"33 N\", \"61 N\"]").required().when(FORCE, MAP),
    quantity(&p::TAPER_END_RADIUS, "\"3 mm\"").required(),
    quantity(&p::TAPER_LENGTH_RATIO, "1.7").required(),
    choice(BLADDER, BladderForm::CHOICES, "How the bladder's resistance grows with contraction.", "\"linear\"")
        .required(),
    quantity(&p::BLADDER_FORCE, "\"20 N\"").required(),
    quantity(&p::BLADDER_SCALE, "0.05").required().when(BLADDER, CURVED),
    quantity(&p::EFFECTIVENESS, "0.9"),
    list(&p::EFFECTIVENESS_POLYNOMIAL, "[0.7, 0.003]"),
    key(
        "actuator.effectiveness.pressure_unit",
        Kind::Unit("Pa"),
        "Unit of the polynomial's gauge pressure.",
        "\"psi\"",
    ),
    list(&p::EFFECTIVENESS_PRESSURE, "[\"20 psi\", \"60 psi\"]"),
    list(&p::EFFECTIVENESS_VALUE, "[0.8, 0.9]"),
    quantity(&p::VISCOUS, "\"0.02 lbf*s/in\""),
    quantity(&p::STRUCTURAL_DAMPING, "\"2 ms\""),
    quantity(&p::COULOMB_WIDTH, "\"0.0044 in\""),
    quantity(&p::COULOMB_FORCE, "\"0.5 N\""),
    quantity(&p::COULOMB_FORCE_PER_PRESSURE, "\"2 mm^2\""),
    quantity(&p::STATIC_RATIO, "1.3"),
    quantity(&p::STRIBECK_VELOCITY, "\"10 mm/s\""),
    choice(HYSTERESIS, HysteresisLaw::CHOICES, "The law of hysteresis.", "\"maxwell-slip\"").or("maxwell-slip"),
    list(&p::HYSTERESIS_REACH, "[\"0.05 mm\", \"0.3 mm\"]").required().when(HYSTERESIS, ELEMENTS),
    list(&p::HYSTERESIS_STIFFNESS_RATIO, "[0.8, 0.1]").required().when(HYSTERESIS, ELEMENTS),
    quantity(&p::HYSTERESIS_WIDTH, "\"0.1 mm\"").required().when(HYSTERESIS, ONE_WIDTH),
    quantity(&p::HYSTERESIS_BETA, "\"4000 m^-1\"").required().when(HYSTERESIS, ROUNDED),
    quantity(&p::HYSTERESIS_GAMMA, "\"-1500 m^-1\"").when(HYSTERESIS, ROUNDED),
    quantity(&p::BRISTLE_REACH, "\"0.05 mm\"").required().when(HYSTERESIS, BRISTLES),
    quantity(&p::BRISTLE_STATIC_RATIO, "1.5").when(HYSTERESIS, BRISTLES),
    quantity(&p::BRISTLE_STRIBECK_VELOCITY, "\"10 mm/s\"").when(HYSTERESIS, BRISTLES),
    quantity(&p::BRISTLE_DAMPING_TIME, "\"5 ms\"").when(HYSTERESIS, BRISTLES),
    list(&p::BRANCH_RELAXATION_TIME, "[\"1 s\"]").required(),
    list(&p::BRANCH_STIFFNESS, "[\"100 N/m\"]"),
    list(&p::BRANCH_STIFFNESS_RATIO, "[0.2]"),
    list(&p::BRANCH_INITIAL_STRETCH, "[\"0.2 mm\"]"),
    quantity(&p::LIMIT_STIFFNESS, "\"1.75e5 N/m\""),
    quantity(&p::LIMIT_DAMPING, "\"100 N*s/m\""),
    choice(PROCESS, ProcessKind::CHOICES, "How the actuator's air changes its state.", "\"isentropic\"")
        .or("isentropic"),
    quantity(&p::POLYTROPIC_INDEX, "1.2").required().when(PROCESS, &[ProcessKind::Polytropic.name()]),
    quantity(&p::HEAT_TRANSFER, "\"0.1 W/K\"").when(PROCESS, &[ProcessKind::EnergyBalance.name()]),
    quantity(&p::WALL_TEMPERATURE, "\"20 degC\"").when(PROCESS, &[ProcessKind::EnergyBalance.name()]),
    quantity(&p::ATMOSPHERIC_PRESSURE, "\"101325 Pa\""),
    quantity(&p::GAS_CONSTANT, "\"286.99 J/(kg*K)\""),
    quantity(&p::HEAT_CAPACITY_RATIO, "1.4"),
    quantity(&p::SUPPLY_GAUGE_PRESSURE, "\"100 psi\"").required(),
    quantity(&p::SUPPLY_TEMPERATURE, "\"293.15 K\""),
    quantity(&p::RESERVOIR_VOLUME, "\"2 L\""),
    quantity(&p::RESERVOIR_PRESSURE, "\"110 psi\""),
    quantity(&p::RESERVOIR_INDEX, "1.4"),
    quantity(&p::DISPLACEMENT, "\"20 L/min\""),
    quantity(&p::CLEARANCE, "0.05"),
    quantity(&p::CUT_IN, "\"90 psi\""),
    quantity(&p::CUT_OUT, "\"110 psi\""),
    quantity(&p::LAG, "\"20 ms\""),
    quantity(&p::DROOP, "\"2e7 Pa*s/kg\""),
    quantity(&p::DEAD_BAND, "\"5 kPa\""),
    quantity(&p::ACTUATORS, "4.0"),
    choice(
        "valve.preset",
        presets::VALVE_CHOICES,
        "A named valve whose values the other keys override.",
        "\"matrix-eight-channel\"",
    ),
    choice(VALVE, ValveKind::CHOICES, "How the valve joins the actuator to supply and exhaust.", "\"three-way\""),
    quantity(&p::FLOW_AREA, "\"1.8e-5 ft^2\""),
    quantity(&p::SONIC_CONDUCTANCE, "\"20 L/(min*bar) ANR\""),
    quantity(&p::CRITICAL_RATIO, "0.3"),
    quantity(&p::KV, "\"0.05 m^3/h\""),
    quantity(&p::CV, "0.06"),
    quantity(&p::PRESSURE_DROP_RATIO, "0.7"),
    quantity(&p::EFFICIENCY, "0.85"),
    quantity(&p::VALVE_DEAD_TIME, "\"5 ms\""),
    quantity(&p::OPENING_DELAY, "\"4 ms\""),
    quantity(&p::CLOSING_DELAY, "\"1 ms\""),
    quantity(&p::OPENING_TIME, "\"2 ms\""),
    quantity(&p::CLOSING_TIME, "\"2 ms\""),
    quantity(&p::REGULATOR_TIME_CONSTANT, "\"30 ms\"").required().when(VALVE, REGULATING),
    quantity(&p::REGULATOR_RATE_LIMIT, "\"20 bar/s\"").required().when(VALVE, REGULATING),
    quantity(&p::LAMINAR_RATIO, "0.999"),
    choice(
        "valve.exhaust_temperature",
        ExhaustTemperature::CHOICES,
        "Whose temperature the leaving air has in the flow law.",
        "\"actuator\"",
    )
    .or("actuator"),
    quantity(&p::EXHAUST_FLOW_AREA, "\"1.8e-5 ft^2\""),
    quantity(&p::EXHAUST_SONIC_CONDUCTANCE, "\"25 L/(min*bar) ANR\""),
    quantity(&p::EXHAUST_CRITICAL_RATIO, "0.3"),
    quantity(&p::EXHAUST_KV, "\"0.06 m^3/h\""),
    quantity(&p::EXHAUST_CV, "0.07"),
    quantity(&p::EXHAUST_PRESSURE_DROP_RATIO, "0.7"),
    quantity(&p::SPOOL_FREQUENCY, "\"100 Hz\"").required().when(VALVE, SPOOLING),
    quantity(&p::SPOOL_DAMPING_RATIO, "0.7").required().when(VALVE, SPOOLING),
    quantity(&p::SUPPLY_OVERLAP, "0.05").when(VALVE, SPOOLING),
    quantity(&p::EXHAUST_OVERLAP, "0.05").when(VALVE, SPOOLING),
    choice(HOSE, HoseKind::CHOICES, "How finely the hose is resolved.", "\"lumped\"").or("lumped"),
    quantity(&p::HOSE_LENGTH, "\"1 m\"").required(),
    quantity(&p::HOSE_DIAMETER, "\"2.5 mm\"").required(),
    quantity(&p::HOSE_VISCOSITY, "\"1.82e-5 Pa*s\""),
    quantity(&p::HOSE_INDEX, "1.0"),
    whole(&p::HOSE_CELLS, "4").when(HOSE, &[HoseKind::Distributed.name()]),
    choice(COMMAND, CommandKind::CHOICES, "What makes the valve's command.", "\"pwm\"").required(),
    quantity(&p::PWM_FREQUENCY, "\"25 Hz\"").required().when(COMMAND, &["pwm"]),
    quantity(&p::DUTY, "0.5").required().when(COMMAND, &["pwm"]),
    choice(
        "command.pulse",
        CommandState::CHOICES,
        "State during the pulse, with a valve that has a third position.",
        "\"fill\"",
    )
    .or("fill")
    .when(COMMAND, &["pwm"]),
    choice(
        "command.rest",
        CommandState::CHOICES,
        "State between pulses, with a valve that has a third position.",
        "\"exhaust\"",
    )
    .or("exhaust")
    .when(COMMAND, &["pwm"]),
    list(&p::COMMAND_TIME, "[\"0 s\", \"0.5 s\"]").required().when(COMMAND, &["table", "set-points", "positions"]),
    key(
        "command.state",
        Kind::Choices(CommandState::CHOICES),
        "State commanded from each time on.",
        "[\"fill\", \"exhaust\"]",
    )
    .required()
    .when(COMMAND, &["table"]),
    list(&p::COMMAND_GAUGE_PRESSURE, "[\"2 bar\", \"4 bar\"]").required().when(COMMAND, &["set-points"]),
    list(&p::COMMAND_POSITION, "[0.5, -1.0]").required().when(COMMAND, &["positions"]),
    choice(CONTROL, ControllerKind::CHOICES, "The law of the controller.", "\"pid\"").required(),
    set_point_series(&p::SET_GAUGE_PRESSURE, "\"3 bar\"").when(CONTROL, TRACKING),
    set_point_series(&p::SET_LENGTH, "\"85 mm\""),
    set_point_series(&p::SET_AIR_MASS, "\"0.05 g\"").when(CONTROL, TRACKING),
    set_point_series(&p::SET_FORCE, "\"20 N\""),
    set_point_series(&p::SET_ANGLE, "\"20 deg\""),
    set_point_series(&p::SET_STIFFNESS, "\"1 N*m/rad\"").when(CONTROL, BY_MODEL),
    regulated("controller.amplitude", "Amplitude of a sinusoidal set point.", "\"0.5 bar\"").when(CONTROL, TRACKING),
    quantity(&p::SET_FREQUENCY, "\"0.5 Hz\"").when(CONTROL, TRACKING),
    quantity(&p::SET_PHASE, "\"0 deg\"").when(CONTROL, TRACKING),
    list(&p::SET_TIME, "[\"0 s\", \"1 s\"]"),
    choice("controller.table", SetPointTable::CHOICES, "What lies between the rows of a table.", "\"lines\"")
        .or("steps"),
    quantity(&p::CONTROL_RATE, "\"200 Hz\"").required(),
    whole(&p::CONTROL_DELAY, "1"),
    quantity(&p::PULSE_FREQUENCY, "\"50 Hz\""),
    regulated(
        "controller.resolution",
        "Step between two values that the sensor can show; zero for a perfect sensor.",
        "\"10 mbar\"",
    ),
    regulated(
        "controller.dead_band",
        "Error, either way, within which a bang-bang controller requests nothing.",
        "\"50 mbar\"",
    )
    .when(CONTROL, RELAYS),
    regulated(
        "controller.hysteresis",
        "Part of the dead band that the error must come back before a bang-bang controller lets go.",
        "\"20 mbar\"",
    )
    .when(CONTROL, RELAYS),
    regulated(
        "controller.proportional_band",
        "Error at which the proportional action alone gives the full output; the gain is 1/B.",
        "\"4 bar\"",
    )
    .when(CONTROL, PIDS),
    quantity(&p::INTEGRAL_TIME, "\"0.2 s\"").when(CONTROL, PIDS),
    quantity(&p::DERIVATIVE_TIME, "\"10 ms\"").when(CONTROL, PIDS),
    quantity(&p::DERIVATIVE_FILTER, "10").when(CONTROL, PIDS),
    quantity(&p::SET_POINT_WEIGHT, "1.0").when(CONTROL, PIDS),
    quantity(&p::TRACKING_TIME, "\"0.2 s\"").when(CONTROL, PIDS),
    quantity(&p::BIAS, "0.0").when(CONTROL, PIDS),
    quantity(&p::HIGHEST_GAUGE_PRESSURE, "\"5 bar\"").required().when(CONTROL, BY_MODEL),
    quantity(&p::CONTROL_TEMPERATURE, "\"20 degC\"").when(CONTROL, &[ControllerKind::AirMass.name()]),
    choice(PRESSURE_AT, PressurePlace::CHOICES, "Where that pressure stands.", "\"muscle\"").or("muscle"),
    list(&p::SERIES_TIME, "[\"0 s\", \"0.5 s\"]").required(),
    list(&p::SERIES_GAUGE_PRESSURE, "[\"1 bar\", \"3 bar\"]").required(),
    quantity(&p::SERIES_OFFSET, "\"2 kPa\""),
    quantity(&p::SERIES_SCALE, "1.02"),
    quantity(&p::SERIES_SHIFT, "\"3 ms\""),
    quantity(&p::TENDON_STIFFNESS, "\"10 kN/m\"").required(),
    quantity(&p::TENDON_REST_LENGTH, "\"50 mm\""),
    choice(LOAD, LoadKind::CHOICES, "What the actuator pulls on.", "\"hanging-mass\"").required(),
    quantity(&p::MASS, "\"5 lb\"").required().when(LOAD, WITH_MASS),
    quantity(&p::GRAVITY, "\"9.80665 m/s^2\"").when(LOAD, WITH_GRAVITY),
    quantity(&p::LOAD_FORCE, "\"5 lbf\"").required().when(LOAD, &[LoadKind::ConstantForce.name()]),
    quantity(&p::MOTION_LENGTH, "\"3.5 in\"").when(LOAD, MOTION),
    quantity(&p::MOTION_AMPLITUDE, "\"0.2 in\"").when(LOAD, MOTION),
    quantity(&p::MOTION_FREQUENCY, "\"2 Hz\"").when(LOAD, MOTION),
    quantity(&p::MOTION_PHASE, "\"0 deg\"").when(LOAD, MOTION),
    list(&p::MOTION_TIME, "[\"0 s\", \"1 s\"]").when(LOAD, MOTION),
    list(&p::MOTION_TABLE_LENGTH, "[\"3.8 in\", \"3.5 in\"]").when(LOAD, MOTION),
    quantity(&p::PULLEY_RADIUS, "\"15 mm\"").when(LOAD, JOINT),
    list(&p::MOMENT_ARM_ANGLE, "[\"-40 deg\", \"40 deg\"]").when(LOAD, JOINT),
    list(&p::MOMENT_ARM, "[\"14 mm\", \"18 mm\"]").when(LOAD, JOINT),
    quantity(&p::REST_LENGTH, "\"3.3 in\"").required().when(LOAD, JOINT),
    quantity(&p::LIMB_DISTANCE, "\"100 mm\"").required().when(LOAD, JOINT),
    quantity(&p::LIMB_INERTIA, "\"1e-3 kg*m^2\"").when(LOAD, JOINT),
    quantity(&p::HANGING_ANGLE, "\"0 deg\"").when(LOAD, JOINT),
    quantity(&p::JOINT_TORQUE, "\"0 N*m\"").when(LOAD, JOINT),
    quantity(&p::JOINT_DAMPING, "\"0.01 N*m*s/rad\"").when(LOAD, JOINT),
    quantity(&p::MIN_ANGLE, "\"-45 deg\"").when(LOAD, JOINT),
    quantity(&p::MAX_ANGLE, "\"45 deg\"").when(LOAD, JOINT),
    quantity(&p::STOP_STIFFNESS, "\"500 N*m/rad\"").when(LOAD, JOINT),
    quantity(&p::STOP_DAMPING, "\"1 N*m*s/rad\"").when(LOAD, JOINT),
    quantity(&p::INITIAL_GAUGE_PRESSURE, "\"0 psi\""),
    quantity(&p::INITIAL_TEMPERATURE, "\"293.15 K\""),
    key(
        p::INITIAL_LENGTH.key,
        Kind::QuantityOr(&p::INITIAL_LENGTH, EQUILIBRIUM),
        "Distance between the attachments at the start; on a tendon the length of the muscle alone.",
        "\"equilibrium\"",
    )
    .or("equilibrium"),
    quantity(&p::INITIAL_VELOCITY, "\"0 m/s\""),
    key(
        p::INITIAL_ANGLE.key,
        Kind::QuantityOr(&p::INITIAL_ANGLE, BALANCED),
        p::INITIAL_ANGLE.meaning,
        "\"equilibrium\"",
    )
    .or("equilibrium")
    .when(LOAD, JOINT),
    quantity(&p::INITIAL_ANGULAR_VELOCITY, "\"0 rad/s\"").when(LOAD, JOINT),
    quantity(&p::DURATION, "\"2 s\"").required(),
    quantity(&p::SAMPLE_INTERVAL, "\"1 ms\""),
    choice("run.engine", Engine::CHOICES, "How the simulation goes through time.", "\"event-located\"")
        .or("event-located"),
    quantity(&p::RELATIVE_TOLERANCE, "1e-8"),
    choice("run.method", Method::CHOICES, "Formula of the fixed-step engine.", "\"stable\"").or("stable"),
    quantity(&p::STEP, "\"0.1 ms\""),
    quantity(&p::ACCURACY, "1e-3"),
    choice(DESIGN, DesignKind::CHOICES, "How the rows are chosen.", "\"latin-hypercube\"").or("grid"),
    whole(&SWEEP_ROWS, "4096").required().when(DESIGN, NO_GRID),
    whole(&SWEEP_SEED, "1").when(DESIGN, NO_GRID),
    choice(RECORD, RecordKind::CHOICES, "What is recorded of each row.", "\"reductions\"").or("reductions"),
    key(
        "sweep.reductions",
        Kind::Choices(Reduction::CHOICES),
        "The numbers that each run is reduced to.",
        "[\"length.final\", \"length.ripple\", \"air.used\"]",
    )
    .when(RECORD, &[RecordKind::Reductions.name()]),
    choice("sweep.over", StatisticsOver::CHOICES, "What statistics are taken over.", "\"orbit\"")
        .or("run")
        .when(RECORD, &[RecordKind::Reductions.name()]),
    list(&SAMPLE_TIMES, "[\"0.5 s\", \"1 s\"]").required().when(RECORD, &[RecordKind::Samples.name()]),
    whole(&PART_ROWS, "4096"),
];

/// The row of a key, of one actuator or of a plant.
pub fn key_at(path: &str) -> Option<&'static Key> {
    all_keys().find(|key| key.path == path)
}

/// The row of the key that a path in a file stands for: of the second actuator of a joint and of named parts of a plant those of
/// one actuator.
pub fn key_for(path: &str) -> Option<&'static Key> {
    key_at(in_antagonist(path).unwrap_or(path)).or_else(|| key_at(&stands_for(path)))
}

/// The row of a section, of one actuator or of a plant.
pub fn section_at(path: &str) -> Option<&'static Section> {
    all_sections().find(|section| section.path == path)
}

/// Every key, those of a plant last.
pub fn all_keys() -> impl Iterator<Item = &'static Key> {
    KEYS.iter().chain(PLANT_KEYS)
}

/// Every section, those of a plant last.
pub fn all_sections() -> impl Iterator<Item = &'static Section> {
    SECTIONS.iter().chain(PLANT_SECTIONS)
}

/// The section or key with the name nearest to a misspelt one, where there is one that may be meant.
pub fn nearest_path(path: &str) -> Option<&'static str> {
    nearest(path, all_sections().map(|section| section.path).chain(all_keys().map(|key| key.path)))
}

/// The keys and subsections that may stand in a section (`""` for the file itself) of a file of one actuator, by name.
pub fn names_in(section: &str) -> impl Iterator<Item = &'static str> {
    let of_second = section == ANTAGONIST || in_antagonist(section).is_some();
    let section = if of_second { in_antagonist(section).unwrap_or("") } else { section };
    let keys = KEYS.iter().map(|key| key.path).filter(move |path| !of_second || is_of_antagonist(path));
    let sections = SECTIONS.iter().map(|section| section.path);
    let sections = sections.filter(move |path| !of_second || is_section_of_antagonist(path));
    names_among(keys.chain(sections), section).into_iter()
}

/// The paths of the keys and subsections that may stand in a section (`""` for the file itself), of one actuator or of a plant, in
/// order; those of subsections end with a point. Names that a file chooses are not among them.
pub fn paths_in(section: &str) -> Vec<String> {
    let path = |name: &str| if section.is_empty() { name.to_owned() } else { format!("{section}.{name}") };
    let mut paths: Vec<String> = plant::names_in_plant(section).into_iter().map(path).collect();
    for path in &mut paths {
        if key_for(path).is_none() {
            path.push('.');
        }
    }
    paths.sort_unstable();
    paths.dedup();
    paths
}

/// The last names of paths that lie in a section.
fn names_among(paths: impl Iterator<Item = &'static str>, section: &str) -> Vec<&'static str> {
    let parent = |path: &'static str| path.rsplit_once('.').unwrap_or(("", path));
    paths.map(parent).filter(|(of, name)| *of == section && *name != "*").map(|(_, name)| name).collect()
}
