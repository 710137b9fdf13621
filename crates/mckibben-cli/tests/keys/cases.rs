//! For each key a scenario in which it matters and another valid value of it.

/// A key and a value that is set over a scenario file, as `--set` takes it.
pub(crate) type Setting = (String, &'static str);
type Settings = &'static [(&'static str, &'static str)];

/// Settings as they are kept.
pub(crate) fn set(settings: Settings) -> impl Iterator<Item = Setting> {
    settings.iter().map(|(key, value)| ((*key).to_owned(), *value))
}

/// A key, the scenario it is tried in, and two sets of values that differ in it.
pub(crate) struct Case<'a> {
    /// The path of the key.
    pub(crate) key: &'static str,
    /// The pieces of the scenario file.
    pub(crate) pieces: Vec<&'a str>,
    /// What is set over it.
    pub(crate) before: Vec<Setting>,
    /// Settings with another value of the key.
    pub(crate) after: Vec<Setting>,
}

impl Case<'_> {
    /// What a message names it by.
    pub(crate) fn name(&self) -> &str {
        self.after.last().map_or(self.key, |(key, _)| key)
    }
}

const BODY: &str = r#"
[actuator]
thread_length = "4.3218 in"
turns = 2.5
max_length = "3.85 in"
external_volume = "3 cm^3"
friction.viscous = "3 N*s/m"
friction.coulomb_width = "0.05 mm"
"#;
/// A muscle that is described at rest.
const AT_REST: &str = r#"
[actuator]
length = "97.8 mm"
diameter = "6.35 mm"
braid_angle = "27 deg"
external_volume = "3 cm^3"
friction.viscous = "3 N*s/m"
friction.coulomb_width = "0.05 mm"
"#;
/// What a preset has besides is left to it.
const GEOMETRY: &str = "\n[actuator]\nthread_length = \"4.3218 in\"\nturns = 2.5\nmax_length = \"3.85 in\"\n";
const SUPPLY: &str = r#"
[supply]
gauge_pressure = "6 bar"
"#;
/// A valve that lets through what a setting says.
const VALVE: &str = r#"
[valve]
kind = "three-way"
opening_delay = "4 ms"
closing_delay = "1 ms"
"#;
const SEATS: &str = r#"
[valve]
kind = "three-way"
flow_area = "1.7 mm^2"
opening_delay = "4 ms"
closing_delay = "1 ms"
"#;
const REGULATOR: &str = r#"
[valve]
kind = "pressure-regulator"
flow_area = "1.7 mm^2"
time_constant = "10 ms"
dead_time = "4 ms"
rate_limit = "100 bar/s"
"#;
const SPOOL: &str = r#"
[valve]
kind = "proportional-spool"
flow_area = "1.7 mm^2"
spool.natural_frequency = "80 Hz"
spool.damping_ratio = 0.8
spool.supply_overlap = 0.05
spool.exhaust_overlap = 0.05
"#;
const PWM: &str = r#"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
"#;
const FILL: &str = "\n[command]\nkind = \"fill\"\n";
const TABLE: &str = r#"
[command]
kind = "table"
time = ["0 s", "20 ms"]
state = ["fill", "exhaust"]
"#;
const SET_POINTS: &str = r#"
[command]
kind = "set-points"
time = ["0 s", "20 ms"]
gauge_pressure = ["3 bar", "1 bar"]
"#;
const POSITIONS: &str = r#"
[command]
kind = "positions"
time = ["0 s", "20 ms"]
position = [0.8, -0.6]
"#;
const CONTROLLERS: &str = "\n[command]\nkind = \"controllers\"\n";
/// PID control of pressure with every action, and an error that reaches the limit of the output.
const PID: &str = r#"
[controller]
kind = "pid"
gauge_pressure = "3 bar"
amplitude = "1 bar"
frequency = "15 Hz"
rate = "200 Hz"
proportional_band = "1 bar"
integral_time = "50 ms"
derivative_time = "10 ms"
bias = 0.4
"#;
const PID_OF_LENGTH: &str =
    "\n[controller]\nkind = \"pid\"\nlength = \"88 mm\"\nrate = \"200 Hz\"\nproportional_band = \"8 mm\"\n";
const PID_OF_AIR: &str =
    "\n[controller]\nkind = \"pid\"\nair_mass = \"20 mg\"\nrate = \"200 Hz\"\nproportional_band = \"20 mg\"\n";
const PID_OF_FORCE: &str =
    "\n[controller]\nkind = \"pid\"\nforce = \"25 N\"\nrate = \"200 Hz\"\nproportional_band = \"20 N\"\n";
const PID_OF_ANGLE: &str =
    "\n[controller]\nkind = \"pid\"\nangle = \"5 deg\"\nrate = \"200 Hz\"\nproportional_band = \"20 deg\"\n";
const PID_ON_A_TABLE: &str = r#"
[controller]
kind = "pid"
gauge_pressure = ["3 bar", "2 bar", "4 bar"]
time = ["0 s", "15 ms", "50 ms"]
rate = "200 Hz"
proportional_band = "1.5 bar"
"#;
const RELAY: &str = r#"
[controller]
kind = "bang-bang"
gauge_pressure = "3 bar"
rate = "500 Hz"
dead_band = "0.3 bar"
hysteresis = "0.1 bar"
"#;
const BY_MODEL: &str = r#"
[controller]
force = "25 N"
rate = "500 Hz"
highest_gauge_pressure = "5 bar"
"#;
const BY_MODEL_OF_JOINT: &str = r#"
[controller]
kind = "air-mass"
angle = "5 deg"
stiffness = "0.9 N*m/rad"
highest_gauge_pressure = "5 bar"
rate = "500 Hz"
dead_band = "0.1 mg"
"#;
const PRESSURE: &str = r#"
[pressure]
time = ["0 s", "50 ms"]
gauge_pressure = ["2 bar", "4 bar"]
"#;
const HANGING: &str = r#"
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
gauge_pressure = "2 bar"
"#;
const LOADED: &str = "\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n";
const ISOMETRIC: &str = r#"
[load]
kind = "isometric"
[initial]
gauge_pressure = "2 bar"
length = "88 mm"
"#;
const CONSTANT_FORCE: &str = r#"
[load]
kind = "constant-force"
mass = "2 kg"
force = "20 N"
[initial]
gauge_pressure = "2 bar"
"#;
const SINUSOID: &str = r#"
[load]
kind = "prescribed-motion"
length = "88 mm"
amplitude = "2 mm"
frequency = "20 Hz"
[initial]
gauge_pressure = "2 bar"
"#;
const PATH: &str = r#"
[load]
kind = "prescribed-motion"
time = ["0 s", "30 ms", "60 ms"]
table_length = ["90 mm", "86 mm", "88 mm"]
[initial]
gauge_pressure = "2 bar"
"#;
/// A load of any kind, which a setting names.
const OPEN_LOAD: &str = "\n[load]\n[initial]\ngauge_pressure = \"2 bar\"\nlength = \"88 mm\"\n";
/// A limb that falls from 2° towards its stop.
pub(crate) const JOINT_LOAD: &str = r#"[load]
kind = "antagonistic-joint"
mass = "0.3 kg"
distance = "100 mm"
pulley_radius = "15 mm"
rest_length = "3.3 in"
[initial]
gauge_pressure = "2 bar"
angle = "2 deg"
"#;
/// The load of a joint whose pressure at the start is given over time.
pub(crate) const GIVEN_JOINT_LOAD: &str = r#"[load]
kind = "antagonistic-joint"
mass = "0.3 kg"
distance = "100 mm"
pulley_radius = "15 mm"
rest_length = "3.3 in"
[initial]
angle = "2 deg"
"#;
const TABLE_LOAD: &str = r#"[load]
kind = "antagonistic-joint"
mass = "0.3 kg"
distance = "100 mm"
moment_arm_angle = ["-40 deg", "0 deg", "40 deg"]
moment_arm = ["14 mm", "15 mm", "18 mm"]
rest_length = "3.3 in"
[initial]
gauge_pressure = "2 bar"
angle = "2 deg"
"#;
const RUN: &str = "\n[run]\nduration = \"60 ms\"\nsample_interval = \"2 ms\"\n";
const SWEEP: &str = "\n[sweep]\nvary.\"load.mass\" = [\"4 lb\", \"5 lb\", \"6 lb\"]\n";
const RANDOM: &str =
    "\n[sweep]\ndesign = \"random\"\nrows = 3\nvary.\"load.mass\".uniform = { from = \"4 lb\", to = \"6 lb\" }\n";
const SAMPLES: &str =
    "\n[sweep]\nrecord = \"samples\"\nsample_times = [\"20 ms\"]\nvary.\"load.mass\" = [\"4 lb\", \"5 lb\"]\n";

const SEALED: &[&str] = &[BODY, HANGING, RUN];
const MUSCLE: &[&str] = &[BODY, SUPPLY, SEATS, PWM, HANGING, RUN];
/// Lacks what its valve lets through.
const OPEN: &[&str] = &[BODY, SUPPLY, VALVE, PWM, HANGING, RUN];
const HELD: &[&str] = &[BODY, ISOMETRIC, RUN];
const MOVED: &[&str] = &[BODY, SINUSOID, RUN];
const JOINT: &[&str] = &[BODY, SUPPLY, SEATS, PWM, JOINT_LOAD, RUN];
const BY_PID: &[&str] = &[BODY, SUPPLY, SEATS, CONTROLLERS, PID, HANGING, RUN];
const STATIC: &[&str] = &[BODY, SUPPLY, SEATS, CONTROLLERS, BY_MODEL, ISOMETRIC, RUN];
const SWEPT: &[&str] = &[BODY, SUPPLY, SEATS, PWM, HANGING, RUN, SWEEP];

type Group = (&'static [&'static str], Settings, Settings);

/// A scenario, what is set over it, and for keys another value each.
const GROUPS: &[Group] = &[
    (
        MUSCLE,
        &[],
        &[
            ("actuator.thread_length", "4.33 in"),
            ("actuator.turns", "2.45"),
            ("actuator.min_length", "2.6 in"),
            ("actuator.external_volume", "4 cm^3"),
            ("actuator.leakage", "1e-10 m^3/(s*Pa)"),
            ("actuator.wall_thickness", "0.4 mm"),
            ("actuator.effectiveness.constant", "0.9"),
            ("actuator.friction.viscous", "6 N*s/m"),
            ("actuator.friction.coulomb_width", "0.1 mm"),
            ("actuator.friction.coulomb_force", "0.5 N"),
            ("actuator.friction.coulomb_force_per_pressure", "2 mm^2"),
            ("air.process", "isothermal"),
            ("air.atmospheric_pressure", "95 kPa"),
            ("air.gas_constant", "290 J/(kg*K)"),
            ("air.heat_capacity_ratio", "1.3"),
            ("supply.gauge_pressure", "5 bar"),
            ("supply.temperature", "320 K"),
            ("valve.kind", "three-way-normally-open"),
            ("valve.flow_area", "1.5 mm^2"),
            ("valve.efficiency", "0.7"),
            ("valve.dead_time", "3 ms"),
            ("valve.opening_delay", "5 ms"),
            ("valve.closing_delay", "2 ms"),
            ("valve.opening_time", "3 ms"),
            ("valve.closing_time", "3 ms"),
            ("valve.laminar_ratio", "0.9"),
            ("valve.exhaust_temperature", "ambient"),
            ("valve.exhaust.flow_area", "1 mm^2"),
            ("valve.exhaust.kv", "0.06 m^3/h"),
            ("valve.exhaust.cv", "0.07"),
            ("command.frequency", "30 Hz"),
            ("command.duty", "0.6"),
            ("load.mass", "6 lb"),
            ("load.gravity", "9 m/s^2"),
            ("initial.gauge_pressure", "3 bar"),
            ("initial.temperature", "320 K"),
            ("initial.length", "88 mm"),
            ("run.duration", "70 ms"),
            ("run.sample_interval", "1 ms"),
            ("run.engine", "fixed-step"),
            ("run.relative_tolerance", "1e-5"),
        ],
    ),
    (&[GEOMETRY, SUPPLY, SEATS, PWM, HANGING, RUN], &[], &[("actuator.preset", "colbrunn-2001")]),
    (
        &[AT_REST, SUPPLY, SEATS, PWM, HANGING, RUN],
        &[],
        &[("actuator.length", "99 mm"), ("actuator.diameter", "6.5 mm"), ("actuator.braid_angle", "26 deg")],
    ),
    (SEALED, &[("initial.length", "88 mm")], &[("initial.velocity", "0.1 m/s")]),
    // Falls into the taut braid; contracts to its shortest.
    (
        SEALED,
        &[("initial.gauge_pressure", "0.2 bar"), ("initial.length", "97 mm")],
        &[
            ("actuator.max_length", "3.84 in"),
            ("actuator.limit.stiffness", "1e5 N/m"),
            ("actuator.limit.damping", "200 N*s/m"),
        ],
    ),
    (MUSCLE, &[("actuator.min_length", "86 mm"), ("load.mass", "0.1 kg")], &[("actuator.min_length", "85 mm")]),
    // Laws of force.
    (
        HELD,
        &[("actuator.force.law", "tondu-lopez"), ("actuator.force.end_factor_rise", "0.2")],
        &[
            ("actuator.force.end_factor", "1.2"),
            ("actuator.force.end_factor_rise", "0.4"),
            ("actuator.force.end_factor_pressure", "3 bar"),
        ],
    ),
    (
        HELD,
        &[
            ("actuator.force.law", "tondu-lopez"),
            ("actuator.force.radius", "3.2 mm"),
            ("actuator.force.a", "11.5"),
            ("actuator.force.b", "4.8"),
        ],
        &[("actuator.force.radius", "3.3 mm"), ("actuator.force.a", "11.6"), ("actuator.force.b", "4.7")],
    ),
    (
        HELD,
        &[
            ("actuator.force.law", "sarosi"),
            ("actuator.force.coefficients", "[0.01, 5, -0.2, -0.006, 0.2, -6]"),
            ("actuator.force.pressure_unit", "kPa"),
            ("actuator.force.force_unit", "N"),
        ],
        &[
            ("actuator.force.coefficients", "[0.01, 5, -0.2, -0.006, 0.2, -5]"),
            ("actuator.force.pressure_unit", "psi"),
            ("actuator.force.force_unit", "lbf"),
        ],
    ),
    (
        HELD,
        &[
            ("actuator.force.law", "martens-boblan"),
            ("actuator.force.membrane_thickness", "0.3 mm"),
            ("actuator.force.modulus", "[0.4, -6, 30, 10]"),
            ("actuator.force.modulus_unit", "MPa"),
            ("actuator.force.length_unit", "m"),
        ],
        &[
            ("actuator.force.membrane_thickness", "0.25 mm"),
            ("actuator.force.modulus", "[0.4, -6, 30, 11]"),
            ("actuator.force.modulus_unit", "psi"),
            ("actuator.force.length_unit", "ft"),
        ],
    ),
    (
        HELD,
        &[("actuator.force.law", "extensible-braid"), ("actuator.force.thread_stiffness", "30 kN/m")],
        &[("actuator.force.thread_stiffness", "40 kN/m")],
    ),
    (
        HELD,
        &[
            ("actuator.force.law", "bolen"),
            ("actuator.force.max_force", "90 N"),
            ("actuator.force.max_pressure", "620 kPa"),
            ("actuator.force.max_contraction", "0.3"),
            ("actuator.force.shape", "[0.26, 6.4, 1.3]"),
        ],
        &[
            ("actuator.force.max_force", "95 N"),
            ("actuator.force.max_pressure", "600 kPa"),
            ("actuator.force.max_contraction", "0.28"),
            ("actuator.force.shape", "[0.26, 6.4, 1.4]"),
        ],
    ),
    (
        HELD,
        &[
            ("actuator.force.law", "polynomial"),
            ("actuator.force.pressure_coefficients", "[120, -800, 900]"),
            ("actuator.force.passive_coefficients", "[1, 40]"),
            ("actuator.force.pressure_unit", "MPa"),
            ("actuator.force.force_unit", "N"),
        ],
        &[
            ("actuator.force.pressure_coefficients", "[121, -800, 900]"),
            ("actuator.force.passive_coefficients", "[1, 50]"),
            ("actuator.force.pressure_unit", "bar"),
            ("actuator.force.force_unit", "lbf"),
        ],
    ),
    (
        HELD,
        &[
            ("actuator.force.law", "map"),
            ("actuator.force.gauge_pressure", "[\"1 bar\", \"4 bar\"]"),
            ("actuator.force.length", "[\"7 cm\", \"9 cm\"]"),
            ("actuator.force.tension", "[\"4 N\", \"20 N\", \"12 N\", \"60 N\"]"),
        ],
        &[
            ("actuator.force.gauge_pressure", "[\"1 bar\", \"5 bar\"]"),
            ("actuator.force.length", "[\"7.5 cm\", \"9 cm\"]"),
            ("actuator.force.tension", "[\"4 N\", \"21 N\", \"12 N\", \"60 N\"]"),
        ],
    ),
    (
        HELD,
        &[("actuator.taper.end_radius", "2.8 mm"), ("actuator.taper.length_ratio", "1.5")],
        &[("actuator.taper.end_radius", "2.7 mm"), ("actuator.taper.length_ratio", "1.2")],
    ),
    (
        HELD,
        &[
            ("actuator.bladder.form", "saturating"),
            ("actuator.bladder.force", "6 N"),
            ("actuator.bladder.scale", "0.05"),
        ],
        &[
            ("actuator.bladder.form", "exponential"),
            ("actuator.bladder.force", "7 N"),
            ("actuator.bladder.scale", "0.06"),
        ],
    ),
    (
        HELD,
        &[("actuator.effectiveness.polynomial", "[0.9, 0.001]"), ("actuator.effectiveness.pressure_unit", "psi")],
        &[("actuator.effectiveness.polynomial", "[0.9, 0.002]"), ("actuator.effectiveness.pressure_unit", "kPa")],
    ),
    (
        HELD,
        &[
            ("actuator.effectiveness.gauge_pressure", "[\"20 psi\", \"60 psi\"]"),
            ("actuator.effectiveness.value", "[0.8, 0.9]"),
        ],
        &[
            ("actuator.effectiveness.gauge_pressure", "[\"20 psi\", \"70 psi\"]"),
            ("actuator.effectiveness.value", "[0.8, 0.95]"),
        ],
    ),
    // Friction.
    (
        MOVED,
        &[("actuator.friction.static_ratio", "1.3"), ("actuator.friction.stribeck_velocity", "0.1 m/s")],
        &[("actuator.friction.static_ratio", "1.5"), ("actuator.friction.stribeck_velocity", "0.2 m/s")],
    ),
    (
        MOVED,
        &[
            ("actuator.friction.hysteresis.reach", "[\"0.1 mm\", \"1 mm\"]"),
            ("actuator.friction.hysteresis.stiffness_ratio", "[0.5, 0.1]"),
        ],
        &[
            ("actuator.friction.hysteresis.reach", "[\"0.05 mm\", \"1 mm\"]"),
            ("actuator.friction.hysteresis.stiffness_ratio", "[0.5, 0.2]"),
        ],
    ),
    (
        MOVED,
        &[
            ("actuator.friction.hysteresis.law", "bouc-wen"),
            ("actuator.friction.hysteresis.width", "0.1 mm"),
            ("actuator.friction.hysteresis.beta", "4000 m^-1"),
        ],
        &[
            ("actuator.friction.hysteresis.width", "0.2 mm"),
            ("actuator.friction.hysteresis.beta", "5000 m^-1"),
            ("actuator.friction.hysteresis.gamma", "1500 m^-1"),
        ],
    ),
    (
        MOVED,
        &[
            ("actuator.friction.hysteresis.law", "lugre"),
            ("actuator.friction.hysteresis.width", "0.1 mm"),
            ("actuator.friction.hysteresis.bristle_reach", "0.05 mm"),
            ("actuator.friction.hysteresis.static_ratio", "1.4"),
            ("actuator.friction.hysteresis.stribeck_velocity", "0.1 m/s"),
        ],
        &[
            ("actuator.friction.hysteresis.bristle_reach", "0.1 mm"),
            ("actuator.friction.hysteresis.static_ratio", "1.6"),
            ("actuator.friction.hysteresis.stribeck_velocity", "0.2 m/s"),
            ("actuator.friction.hysteresis.damping_time", "1 ms"),
        ],
    ),
    (MOVED, &[], &[("actuator.friction.structural_damping", "2 ms")]),
    (
        MOVED,
        &[
            ("actuator.friction.viscoelastic.relaxation_time", "[\"20 ms\", \"1 s\"]"),
            ("actuator.friction.viscoelastic.stiffness", "[\"100 N/m\", \"0 N/m\"]"),
            ("actuator.friction.viscoelastic.stiffness_ratio", "[0, 0.2]"),
            ("actuator.friction.viscoelastic.initial_stretch", "[\"0 mm\", \"0.1 mm\"]"),
        ],
        &[
            ("actuator.friction.viscoelastic.relaxation_time", "[\"30 ms\", \"1 s\"]"),
            ("actuator.friction.viscoelastic.stiffness", "[\"100 N/m\", \"50 N/m\"]"),
            ("actuator.friction.viscoelastic.stiffness_ratio", "[0, 0.3]"),
            ("actuator.friction.viscoelastic.initial_stretch", "[\"0 mm\", \"-0.2 mm\"]"),
        ],
    ),
    // Air.
    (MUSCLE, &[("air.process", "polytropic"), ("air.polytropic_index", "1.2")], &[("air.polytropic_index", "1.3")]),
    (
        MUSCLE,
        &[("air.process", "energy-balance"), ("air.heat_transfer", "0.1 W/K")],
        &[("air.heat_transfer", "0.2 W/K"), ("air.wall_temperature", "40 degC")],
    ),
    // The air line.
    (
        MUSCLE,
        &[
            ("supply.reservoir_volume", "50 mL"),
            ("supply.reservoir_gauge_pressure", "5.5 bar"),
            ("supply.compressor_displacement", "400 L/min"),
            ("supply.compressor_clearance", "0.02"),
            ("supply.cut_in_gauge_pressure", "5.4 bar"),
            ("supply.cut_out_gauge_pressure", "5.6 bar"),
        ],
        &[
            ("supply.reservoir_volume", "60 mL"),
            ("supply.reservoir_gauge_pressure", "5.7 bar"),
            ("supply.reservoir_index", "1.4"),
            ("supply.compressor_displacement", "500 L/min"),
            ("supply.compressor_clearance", "0.05"),
            ("supply.cut_in_gauge_pressure", "5.3 bar"),
            ("supply.cut_out_gauge_pressure", "5.55 bar"),
            ("supply.actuators", "2"),
        ],
    ),
    (
        MUSCLE,
        &[("supply.lag", "10 ms"), ("supply.droop", "2e7 Pa*s/kg"), ("supply.dead_band", "5 kPa")],
        &[("supply.lag", "15 ms"), ("supply.droop", "3e7 Pa*s/kg"), ("supply.dead_band", "20 kPa")],
    ),
    (
        MUSCLE,
        &[("hose.length", "0.5 m"), ("hose.diameter", "2 mm")],
        &[
            ("hose.kind", "distributed"),
            ("hose.length", "0.6 m"),
            ("hose.diameter", "2.5 mm"),
            ("hose.viscosity", "3e-5 Pa*s"),
            ("hose.polytropic_index", "1.4"),
        ],
    ),
    (
        MUSCLE,
        &[("hose.length", "0.5 m"), ("hose.diameter", "2 mm"), ("hose.kind", "distributed"), ("hose.cells", "3")],
        &[("hose.cells", "4")],
    ),
    // Valves and commands.
    (
        &[BODY, SUPPLY, "\n[valve]\n", PWM, HANGING, RUN],
        &[("valve.preset", "matrix-eight-channel")],
        &[("valve.preset", "matrix-821")],
    ),
    (
        OPEN,
        &[("valve.sonic_conductance", "20 L/(min*bar) ANR"), ("valve.critical_ratio", "0.3")],
        &[("valve.sonic_conductance", "25 L/(min*bar) ANR"), ("valve.critical_ratio", "0.4")],
    ),
    (OPEN, &[("valve.kv", "0.05 m^3/h")], &[("valve.kv", "0.06 m^3/h"), ("valve.pressure_drop_ratio", "0.6")]),
    (OPEN, &[("valve.cv", "0.06")], &[("valve.cv", "0.07")]),
    (
        MUSCLE,
        &[("valve.exhaust.sonic_conductance", "10 L/(min*bar) ANR"), ("valve.exhaust.critical_ratio", "0.3")],
        &[("valve.exhaust.sonic_conductance", "15 L/(min*bar) ANR"), ("valve.exhaust.critical_ratio", "0.6")],
    ),
    (
        MUSCLE,
        &[("valve.exhaust.cv", "0.05"), ("valve.exhaust.pressure_drop_ratio", "0.8")],
        &[("valve.exhaust.pressure_drop_ratio", "0.5")],
    ),
    (
        &[BODY, SUPPLY, REGULATOR, SET_POINTS, HANGING, RUN],
        &[],
        &[
            ("valve.time_constant", "15 ms"),
            ("valve.dead_time", "6 ms"),
            ("valve.rate_limit", "80 bar/s"),
            ("command.time", "[\"0 s\", \"25 ms\"]"),
            ("command.gauge_pressure", "[\"3 bar\", \"1.5 bar\"]"),
        ],
    ),
    (
        &[BODY, SUPPLY, SPOOL, POSITIONS, HANGING, RUN],
        &[],
        &[
            ("valve.spool.natural_frequency", "90 Hz"),
            ("valve.spool.damping_ratio", "0.7"),
            ("valve.spool.supply_overlap", "0.1"),
            ("valve.spool.exhaust_overlap", "0.1"),
            ("command.position", "[0.8, -0.5]"),
        ],
    ),
    (MUSCLE, &[("valve.kind", "fill-hold-exhaust")], &[("command.pulse", "hold"), ("command.rest", "hold")]),
    (&[BODY, SUPPLY, SEATS, FILL, HANGING, RUN], &[], &[("command.kind", "exhaust")]),
    (
        &[BODY, SUPPLY, SEATS, TABLE, HANGING, RUN],
        &[],
        &[("command.time", "[\"0 s\", \"30 ms\"]"), ("command.state", "[\"exhaust\", \"fill\"]")],
    ),
    // Controllers.
    (
        BY_PID,
        // Slow and without delays to speak of, so that the output is not always at a limit.
        &[("valve.flow_area", "0.3 mm^2"), ("valve.opening_delay", "0.1 ms"), ("valve.closing_delay", "0.1 ms")],
        &[
            ("controller.gauge_pressure", "3.5 bar"),
            ("controller.amplitude", "0.5 bar"),
            ("controller.frequency", "20 Hz"),
            ("controller.phase", "90 deg"),
            ("controller.rate", "250 Hz"),
            ("controller.delay", "1"),
            ("controller.pulse_frequency", "100 Hz"),
            ("controller.resolution", "0.2 bar"),
            ("controller.proportional_band", "2 bar"),
            ("controller.integral_time", "30 ms"),
            ("controller.derivative_time", "15 ms"),
            ("controller.derivative_filter", "3"),
            ("controller.set_point_weight", "0.5"),
            ("controller.tracking_time", "10 ms"),
            ("controller.bias", "0.2"),
        ],
    ),
    (&[BODY, SUPPLY, SEATS, CONTROLLERS, PID_OF_LENGTH, HANGING, RUN], &[], &[("controller.length", "87 mm")]),
    (&[BODY, SUPPLY, SEATS, CONTROLLERS, PID_OF_AIR, HANGING, RUN], &[], &[("controller.air_mass", "25 mg")]),
    (&[BODY, SUPPLY, SEATS, CONTROLLERS, PID_OF_FORCE, HANGING, RUN], &[], &[("controller.force", "28 N")]),
    (&[BODY, SUPPLY, SEATS, CONTROLLERS, PID_OF_ANGLE, JOINT_LOAD, RUN], &[], &[("controller.angle", "8 deg")]),
    (
        &[BODY, SUPPLY, SEATS, CONTROLLERS, PID_ON_A_TABLE, HANGING, RUN],
        &[],
        &[("controller.time", "[\"0 s\", \"25 ms\", \"50 ms\"]"), ("controller.table", "lines")],
    ),
    (
        &[BODY, SUPPLY, SEATS, CONTROLLERS, RELAY, HANGING, RUN],
        &[("valve.kind", "fill-hold-exhaust"), ("valve.opening_delay", "0.5 ms"), ("valve.closing_delay", "0.5 ms")],
        &[("controller.dead_band", "0.5 bar"), ("controller.hysteresis", "0.3 bar")],
    ),
    (
        STATIC,
        &[("controller.kind", "feed-forward"), ("controller.dead_band", "0.1 bar"), ("controller.force", "80 N")],
        &[("controller.highest_gauge_pressure", "4 bar")],
    ),
    (
        STATIC,
        &[("controller.kind", "air-mass"), ("controller.dead_band", "0.1 mg")],
        &[("controller.temperature", "60 degC")],
    ),
    (
        &[BODY, SUPPLY, SEATS, CONTROLLERS, BY_MODEL_OF_JOINT, JOINT_LOAD, RUN],
        &[("valve.kind", "fill-hold-exhaust")],
        &[("controller.stiffness", "1.1 N*m/rad")],
    ),
    // Loads.
    (
        &[BODY, PRESSURE, LOADED, RUN],
        &[],
        &[
            ("pressure.time", "[\"0 s\", \"40 ms\"]"),
            ("pressure.gauge_pressure", "[\"2 bar\", \"3 bar\"]"),
            ("pressure.offset", "0.1 bar"),
            ("pressure.scale", "1.05"),
            ("pressure.shift", "3 ms"),
        ],
    ),
    (
        MUSCLE,
        &[("tendon.stiffness", "10 kN/m"), ("tendon.rest_length", "50 mm")],
        &[("tendon.stiffness", "12 kN/m"), ("tendon.rest_length", "60 mm")],
    ),
    (&[BODY, CONSTANT_FORCE, RUN], &[("initial.length", "88 mm")], &[("load.force", "25 N")]),
    (
        MOVED,
        &[],
        &[("load.length", "87 mm"), ("load.amplitude", "3 mm"), ("load.frequency", "30 Hz"), ("load.phase", "90 deg")],
    ),
    (
        &[BODY, PATH, RUN],
        &[],
        &[("load.time", "[\"0 s\", \"20 ms\", \"60 ms\"]"), ("load.table_length", "[\"90 mm\", \"87 mm\", \"88 mm\"]")],
    ),
    (
        JOINT,
        &[("load.max_angle", "3 deg"), ("load.min_angle", "-3 deg"), ("load.torque", "0.1 N*m")],
        &[
            ("load.pulley_radius", "16 mm"),
            ("load.rest_length", "3.35 in"),
            ("load.distance", "90 mm"),
            ("load.inertia", "2e-3 kg*m^2"),
            ("load.hanging_angle", "5 deg"),
            ("load.torque", "0.2 N*m"),
            ("load.damping", "0.01 N*m*s/rad"),
            ("load.max_angle", "2.5 deg"),
            ("load.stop_stiffness", "300 N*m/rad"),
            ("load.stop_damping", "2 N*m*s/rad"),
            ("initial.angle", "1 deg"),
            ("initial.angular_velocity", "1 rad/s"),
        ],
    ),
    (JOINT, &[("load.min_angle", "-3 deg"), ("load.torque", "-0.3 N*m")], &[("load.min_angle", "-2 deg")]),
    (
        &[BODY, SUPPLY, SEATS, PWM, TABLE_LOAD, RUN],
        &[],
        &[
            ("load.moment_arm_angle", "[\"-40 deg\", \"1 deg\", \"40 deg\"]"),
            ("load.moment_arm", "[\"14 mm\", \"16 mm\", \"18 mm\"]"),
        ],
    ),
    // How to run, and sweeps.
    (MUSCLE, &[("run.engine", "fixed-step"), ("run.step", "0.1 ms")], &[("run.method", "rk4"), ("run.step", "0.2 ms")]),
    (MUSCLE, &[("run.engine", "fixed-step")], &[("run.accuracy", "1e-4")]),
    (
        SWEPT,
        &[("run.step", "0.1 ms")],
        &[
            ("sweep.record", "trajectories"),
            ("sweep.reductions", "[\"length.min\"]"),
            ("sweep.over", "orbit"),
            ("sweep.part_rows", "2"),
        ],
    ),
    (
        &[BODY, SUPPLY, SEATS, PWM, HANGING, RUN, RANDOM],
        &[("run.step", "0.1 ms")],
        &[("sweep.design", "latin-hypercube"), ("sweep.rows", "4"), ("sweep.seed", "1")],
    ),
    (
        &[BODY, SUPPLY, SEATS, PWM, HANGING, RUN, SAMPLES],
        &[("run.step", "0.1 ms")],
        &[("sweep.sample_times", "[\"30 ms\"]")],
    ),
];

pub(crate) type Words = (&'static str, &'static [&'static str], Settings, Settings);

/// Words that need other keys than the word before: both scenarios whole.
pub(crate) const WORDS: &[Words] = &[
    (
        "actuator.force.law",
        HELD,
        &[("actuator.force.law", "ideal-braid")],
        &[("actuator.force.law", "extensible-braid"), ("actuator.force.thread_stiffness", "30 kN/m")],
    ),
    (
        "actuator.friction.hysteresis.law",
        MOVED,
        &[
            ("actuator.friction.hysteresis.law", "bouc-wen"),
            ("actuator.friction.hysteresis.width", "0.1 mm"),
            ("actuator.friction.hysteresis.beta", "5000 m^-1"),
        ],
        &[
            ("actuator.friction.hysteresis.law", "lugre"),
            ("actuator.friction.hysteresis.width", "0.1 mm"),
            ("actuator.friction.hysteresis.bristle_reach", "0.05 mm"),
        ],
    ),
    (
        "controller.kind",
        STATIC,
        &[("controller.kind", "feed-forward"), ("controller.dead_band", "0.1 bar")],
        &[("controller.kind", "air-mass"), ("controller.dead_band", "0.1 mg")],
    ),
    (
        "load.kind",
        &[BODY, SUPPLY, SEATS, PWM, OPEN_LOAD, RUN],
        &[("load.kind", "isometric")],
        &[("load.kind", "hanging-mass"), ("load.mass", "5 lb")],
    ),
    (
        "pressure.at",
        &[BODY, PRESSURE, LOADED, RUN],
        &[("pressure.at", "muscle")],
        &[("pressure.at", "hose"), ("hose.length", "2 m"), ("hose.diameter", "2 mm")],
    ),
];

/// What a joint needs for keys of its second actuator to matter, over what the first's case sets.
pub(crate) const OF_JOINTS: &[(&[&str], Settings)] = &[
    // A valve of another kind is said whole, and so is a moment arm.
    (
        &["valve.kind", "command.pulse", "command.rest"],
        &[
            ("antagonist.valve.flow_area", "1.7 mm^2"),
            ("antagonist.valve.opening_delay", "4 ms"),
            ("antagonist.valve.closing_delay", "1 ms"),
        ],
    ),
    (
        &["load.moment_arm_angle", "load.moment_arm"],
        &[
            ("antagonist.load.moment_arm_angle", "[\"-40 deg\", \"0 deg\", \"40 deg\"]"),
            ("antagonist.load.moment_arm", "[\"14 mm\", \"15 mm\", \"18 mm\"]"),
        ],
    ),
    // The tendon is longer by so much, and pulls.
    (&["tendon.stiffness", "tendon.rest_length"], &[("load.rest_length", "5.3 in")]),
    // Longer than it ever is, so that the braid is taut; long enough for these laws to pull.
    (
        &["actuator.max_length", "actuator.limit.stiffness", "actuator.limit.damping"],
        &[("antagonist.load.rest_length", "3.85 in")],
    ),
    (
        &[
            "actuator.force.pressure_coefficients",
            "actuator.force.passive_coefficients",
            "actuator.force.force_unit",
            "actuator.force.max_force",
            "actuator.force.max_contraction",
            "actuator.force.shape",
        ],
        &[("load.rest_length", "3.55 in")],
    ),
];

/// Every case.
pub(crate) fn cases() -> Vec<Case<'static>> {
    let grouped = GROUPS.iter().flat_map(|(pieces, before, changes)| {
        changes.iter().map(|(key, value)| {
            let others = set(before).filter(|(other, _)| other != key);
            let after = others.chain([((*key).to_owned(), *value)]).collect();
            Case { key, pieces: pieces.to_vec(), before: set(before).collect(), after }
        })
    });
    let words = WORDS.iter().map(|(key, pieces, before, after)| Case {
        key,
        pieces: pieces.to_vec(),
        before: set(before).collect(),
        after: set(after).collect(),
    });
    grouped.chain(words).collect()
}
