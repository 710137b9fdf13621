//! Each parameter of a file sets its parameter in the core: what is built from a file whose numbers all differ is what is
//! built by hand from the same numbers, so that two which trade places are found. That each place means what it says is tested
//! in the core, against closed forms; that each key matters is tested in `mckibben-cli`, `tests/keys`.

use mckibben::air::{Air, Process};
use mckibben::control::{
    AirMass, Between, Output, Pid, Place, Quantity, Regulator as Keeps, Relay, Sampling, Sensor, SetPoint, StaticAim,
    Tracker,
};
use mckibben::force::{
    Bladder, BladderForm, Bolen, Characteristic, Coefficients, Effective, Effectiveness, EndFactor, Law, LengthLimits,
    MartensBoblan, TonduLopez,
};
use mckibben::friction::{BoucWen, Coulomb, Friction, Hysteresis, LuGre, MaxwellSlip, Viscoelastic};
use mckibben::line::{Compressor, Hose, HoseKind, Leakage, Line, Regulator, Reservoir, SupplyLine};
use mckibben::load::{Joint, Limb, Load, MomentArm, Motion, SeriesTendon, Stops, Tendon};
use mckibben::simulation::{Actuation, Initial, InitialAngle, InitialLength, JointInitial, Rig};
use mckibben::valve::{
    self, Command, ExhaustTemperature, FlowLaw, FlowStandard, Port, Ramp, Request, Solenoid, Spool, Supply, Valve,
    ValveKind,
};
use mckibben::{AbsolutePressure, Actuator, Braid, GaugePressure};
use mckibben_scenario::keys::KEYS;
use mckibben_scenario::{ControlLaw, Document, JointLaw, Scenario, quantity};

/// Geometry, friction and air, every number another.
const BODY: &str = r#"
[actuator]
thread_length = "0.11 m"
turns = 2.3
max_length = "0.098 m"
min_length = "0.064 m"
external_volume = "3e-6 m^3"
wall_thickness = "4e-4 m"
effectiveness.constant = 0.93
limit.stiffness = "1.5e5 N/m"
limit.damping = "120 N*s/m"
[actuator.friction]
viscous = "3.5 N*s/m"
coulomb_width = "1.1e-4 m"
coulomb_force = "0.4 N"
coulomb_force_per_pressure = "2e-6 m^2"
static_ratio = 1.3
stribeck_velocity = "0.02 m/s"
[air]
process = "energy-balance"
heat_transfer = "0.1 W/K"
wall_temperature = "290 K"
atmospheric_pressure = "99000 Pa"
gas_constant = "288 J/(kg*K)"
heat_capacity_ratio = 1.41
"#;
const DRIVE: &str = r#"
[supply]
gauge_pressure = "6e5 Pa"
temperature = "295 K"
[valve]
kind = "fill-hold-exhaust"
sonic_conductance = "3e-9 m^3/(s*Pa)"
critical_ratio = 0.31
efficiency = 0.87
laminar_ratio = 0.995
exhaust_temperature = "ambient"
opening_delay = "4e-3 s"
closing_delay = "1e-3 s"
dead_time = "6e-3 s"
opening_time = "2e-3 s"
closing_time = "3e-3 s"
exhaust.sonic_conductance = "5e-9 m^3/(s*Pa)"
exhaust.critical_ratio = 0.27
"#;
const PWM: &str = r#"
[command]
kind = "pwm"
frequency = "21 Hz"
duty = 0.4
pulse = "exhaust"
rest = "hold"
"#;
const HANGING: &str = r#"
[load]
kind = "hanging-mass"
mass = "2.1 kg"
gravity = "9.7 m/s^2"
[initial]
gauge_pressure = "1.5e5 Pa"
temperature = "297 K"
length = "0.085 m"
velocity = "0.01 m/s"
[run]
duration = "1 s"
"#;
const JOINT: &str = r#"
[load]
kind = "antagonistic-joint"
mass = "0.3 kg"
gravity = "9.7 m/s^2"
distance = "0.11 m"
inertia = "1.2e-3 kg*m^2"
hanging_angle = "0.05 rad"
torque = "0.07 N*m"
damping = "0.013 N*m*s/rad"
min_angle = "-0.6 rad"
max_angle = "0.7 rad"
stop_stiffness = "450 N*m/rad"
stop_damping = "1.7 N*m*s/rad"
pulley_radius = "0.015 m"
rest_length = "0.083 m"
[initial]
gauge_pressure = "1.5e5 Pa"
temperature = "297 K"
angle = "0.09 rad"
angular_velocity = "0.4 rad/s"
[antagonist]
load.pulley_radius = "0.017 m"
load.rest_length = "0.084 m"
initial.gauge_pressure = "1.7e5 Pa"
initial.temperature = "299 K"
[run]
duration = "1 s"
"#;

fn document(pieces: &[&str]) -> Document {
    Document::parse(&pieces.concat(), "test.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn scenario(pieces: &[&str]) -> Scenario {
    document(pieces).scenario().unwrap_or_else(|error| panic!("{error}"))
}

fn rig(pieces: &[&str]) -> Rig {
    scenario(pieces).rig().unwrap_or_else(|error| panic!("{error}"))
}

fn braid() -> Braid {
    Braid::new(0.11, 2.3).expect("a braid")
}

fn air() -> Air {
    let process = Process::EnergyBalance { heat_transfer: 0.1, wall_temperature: 290.0 };
    Air::new(288.0, 1.41, AbsolutePressure(99_000.0), process).expect("a gas")
}

fn friction() -> Friction {
    let coulomb = Coulomb::new(1.1e-4).and_then(|law| law.with_force(0.4, 2e-6));
    let coulomb = coulomb.and_then(|law| law.with_stribeck(1.3, 0.02)).expect("dry friction");
    Friction::with_coulomb(3.5, coulomb).expect("a friction")
}

fn characteristic(law: Law) -> Characteristic {
    Characteristic::new(braid(), law).with_wall(4e-4, 0.098).expect("a wall")
}

/// The actuator of `BODY` with another law or friction.
fn body(characteristic: Characteristic, friction: Friction) -> Actuator {
    let limits = LengthLimits::new(&braid(), Some(0.064), 0.098, 1.5e5, 120.0).expect("limits");
    let effectiveness = Effectiveness::constant(0.93).expect("a share");
    Actuator::new(Effective { law: characteristic, effectiveness }, limits, friction, 3e-6, air()).expect("an actuator")
}

fn plain() -> Actuator {
    body(characteristic(Law::IdealBraid), friction())
}

fn iso(port: Port, sonic_conductance: f64, critical_ratio: f64) -> FlowLaw {
    let standard = FlowStandard::Iso6358 { sonic_conductance, critical_ratio };
    FlowLaw::of_flow_path(port, standard, 0.87, 0.995, &air()).expect("a flow law")
}

/// The actuator of `BODY` on the valve of `DRIVE`.
fn driven() -> Actuator {
    let supply = Supply::new(GaugePressure(6e5), 295.0, &air()).expect("a supply");
    let inlet = iso(Port::Supply, 3e-9, 0.31);
    let valve = Valve::new(inlet, supply, ExhaustTemperature::Ambient, &air());
    plain().with_valve(valve.with_exhaust(iso(Port::Exhaust, 5e-9, 0.27)))
}

fn seats(kind: ValveKind) -> Solenoid {
    let solenoid = Solenoid::new(kind, 4e-3, 1e-3).and_then(|valve| valve.with_dead_time(6e-3)).expect("a solenoid");
    solenoid.with_ramp(Ramp::new(2e-3, 3e-3).expect("a ramp"))
}

fn pulsed() -> Actuation {
    let command = Command::pwm(21.0, 0.4, Request::Exhaust, Request::Hold).expect("a command");
    Actuation { solenoid: seats(ValveKind::FillHoldExhaust), command }
}

fn hanging() -> Load {
    Load::hanging_mass(2.1, 9.7).expect("a load")
}

#[test]
fn an_actuator_on_a_valve_with_a_load() {
    let expected = Rig::new(driven(), Some(pulsed()), hanging()).expect("a rig");
    assert_eq!(rig(&[BODY, DRIVE, PWM, HANGING]), expected);
    let initial = Initial {
        gauge_pressure: GaugePressure(1.5e5),
        temperature: 297.0,
        length: InitialLength::At(0.085),
        velocity: 0.01,
    };
    assert_eq!(scenario(&[BODY, DRIVE, PWM, HANGING]).initial(), initial);
}

#[test]
fn an_air_line() {
    let leak = BODY.replace("turns = 2.3", "turns = 2.3\nleakage = \"2e-12 m^3/(s*Pa)\"");
    let supply = DRIVE.replace(
        "temperature = \"295 K\"",
        r#"temperature = "295 K"
reservoir_volume = "2e-3 m^3"
reservoir_gauge_pressure = "7e5 Pa"
reservoir_index = 1.25
compressor_displacement = "3e-4 m^3/s"
compressor_clearance = 0.06
cut_in_gauge_pressure = "5e5 Pa"
cut_out_gauge_pressure = "8e5 Pa"
lag = "0.02 s"
droop = "3e7 Pa*s/kg"
dead_band = "4e3 Pa"
actuators = 3"#,
    );
    let hose = "\n[hose]\nkind = \"distributed\"\nlength = \"0.7 m\"\ndiameter = \"3e-3 m\"\nviscosity = \"1.9e-5 Pa*s\"\n\
                polytropic_index = 1.1\ncells = 5\n";
    let compressor = Compressor::new([3e-4, 0.06], [5e5, 8e5].map(GaugePressure), &air()).expect("a compressor");
    let reservoir = Reservoir::new([2e-3, 1.25, 295.0], GaugePressure(7e5), Some(compressor), &air());
    let regulator = Regulator::new(3e7, 4e3, 0.02).expect("a regulator");
    let expected = Line {
        hose: Hose::new(HoseKind::Distributed { cells: 5 }, [0.7, 3e-3], [1.9e-5, 295.0, 1.1], &air()).ok(),
        leakage: Leakage::new(2e-12).ok(),
        supply: SupplyLine::new(reservoir.ok(), Some(regulator), 3.0).ok(),
    };
    assert!(expected.hose.is_some() && expected.leakage.is_some() && expected.supply.is_some());
    assert_eq!(*rig(&[&leak, &supply, PWM, hose, HANGING]).line(), expected);
}

#[test]
fn flow_paths_of_every_standard() {
    let standard = |text: &str| {
        let drive = DRIVE.replace("sonic_conductance = \"3e-9 m^3/(s*Pa)\"\ncritical_ratio = 0.31", text);
        *rig(&[BODY, &drive, PWM, HANGING]).actuator().valve().expect("a valve")
    };
    let expected = |standard| {
        let law = FlowLaw::of_flow_path(Port::Supply, standard, 0.87, 0.995, &air()).expect("a flow law");
        let supply = Supply::new(GaugePressure(6e5), 295.0, &air()).expect("a supply");
        Valve::new(law, supply, ExhaustTemperature::Ambient, &air()).with_exhaust(iso(Port::Exhaust, 5e-9, 0.27))
    };
    let orifice = FlowStandard::Orifice { flow_area: 1.7e-6 };
    assert_eq!(standard("flow_area = \"1.7e-6 m^2\""), expected(orifice));
    let kv = FlowStandard::Kv { kv: 1.4e-5, pressure_drop_ratio: 0.65 };
    assert_eq!(standard("kv = \"1.4e-5 m^3/s\"\npressure_drop_ratio = 0.65"), expected(kv));
    let cv = FlowStandard::Cv { cv: 0.06, pressure_drop_ratio: 0.75 };
    assert_eq!(standard("cv = 0.06\npressure_drop_ratio = 0.75"), expected(cv));
}

#[test]
fn valves_without_seats() {
    let valve = |kind: &str, own: &str, command: &str| {
        let seats = DRIVE.find("opening_delay").expect("it is there");
        let drive = DRIVE[..seats].replace("fill-hold-exhaust", kind) + own;
        rig(&[BODY, &drive, command, HANGING]).actuation().expect("a valve").clone()
    };
    let spool = "spool.natural_frequency = \"75 Hz\"\nspool.damping_ratio = 0.7\nspool.supply_overlap = 0.03\n\
                 spool.exhaust_overlap = 0.05\n";
    let positions = "[command]\nkind = \"positions\"\ntime = [\"0 s\", \"0.5 s\"]\nposition = [0.2, -0.4]\n";
    let expected = Spool::new(75.0, 0.7, 0.03, 0.05).map(Solenoid::proportional).expect("a spool");
    let command = Command::positions(vec![0.0, 0.5], vec![0.2, -0.4]).expect("positions");
    assert_eq!(valve("proportional-spool", spool, positions), Actuation { solenoid: expected, command });
    let regulator = "time_constant = \"0.03 s\"\ndead_time = \"0.005 s\"\nrate_limit = \"2e6 Pa/s\"\n";
    let set_points =
        "[command]\nkind = \"set-points\"\ntime = [\"0 s\", \"0.5 s\"]\ngauge_pressure = [\"4e5 Pa\", \"1e5 Pa\"]\n";
    let expected = valve::Regulator::new(0.03, 0.005, 2e6).map(Solenoid::regulating).expect("a regulator");
    let command = Command::set_points(vec![0.0, 0.5], vec![4e5, 1e5]).expect("set points");
    assert_eq!(valve("pressure-regulator", regulator, set_points), Actuation { solenoid: expected, command });
}

#[test]
fn friction_that_remembers() {
    let with = |hysteresis: &str| {
        let section = format!("[actuator.friction.hysteresis]\n{hysteresis}\n");
        rig(&[BODY, &section, HANGING]).actuator().clone()
    };
    let expected = |law| body(characteristic(Law::IdealBraid), friction().with_hysteresis(law));
    let elements = MaxwellSlip::new(&[5e-5, 3e-4], &[0.8, 0.1]).expect("elements");
    assert_eq!(
        with("reach = [\"5e-5 m\", \"3e-4 m\"]\nstiffness_ratio = [0.8, 0.1]"),
        expected(Hysteresis::MaxwellSlip(elements))
    );
    let rounded = BoucWen::new(1.2e-4, 4e3, -1.5e3).expect("a law");
    let text = "law = \"bouc-wen\"\nwidth = \"1.2e-4 m\"\nbeta = \"4000 m^-1\"\ngamma = \"-1500 m^-1\"";
    assert_eq!(with(text), expected(Hysteresis::BoucWen(rounded)));
    let bristles = LuGre::new(1.2e-4, 5e-5).and_then(|law| law.with_velocity(1.5, 0.01, 5e-3)).expect("a law");
    let text = "law = \"lugre\"\nwidth = \"1.2e-4 m\"\nbristle_reach = \"5e-5 m\"\nstatic_ratio = 1.5\n\
                stribeck_velocity = \"0.01 m/s\"\ndamping_time = \"5e-3 s\"";
    assert_eq!(with(text), expected(Hysteresis::LuGre(bristles)));
    let branches = Viscoelastic::new(&[50.0, 0.0], &[0.1, 0.2], &[0.1, 1.0]).expect("branches");
    let branches = branches.with_initial_stretch(&[1e-4, -2e-4]).expect("branches");
    let section = "[actuator.friction.viscoelastic]\nrelaxation_time = [\"0.1 s\", \"1 s\"]\n\
                   stiffness = [\"50 N/m\", \"0 N/m\"]\nstiffness_ratio = [0.1, 0.2]\ninitial_stretch = [\"1e-4 m\", \"-2e-4 m\"]\n";
    assert_eq!(
        rig(&[BODY, section, HANGING]).actuator(),
        &body(characteristic(Law::IdealBraid), friction().with_viscoelastic(branches))
    );
}

#[test]
fn laws_of_force() {
    let with = |section: &str| rig(&[BODY, section, HANGING]).actuator().clone();
    let expected = |law| body(characteristic(law), friction());
    let falling = EndFactor::falling(1.1, 0.3, 2e5).expect("a factor");
    let coefficients = Coefficients { radius: 3.2e-3, a: 11.5, b: 4.8 };
    let law = TonduLopez::new(&braid(), 0.098, falling, Some(coefficients)).expect("a law");
    let text = "[actuator.force]\nlaw = \"tondu-lopez\"\nend_factor = 1.1\nend_factor_rise = 0.3\n\
                end_factor_pressure = \"2e5 Pa\"\nradius = \"3.2e-3 m\"\na = 11.5\nb = 4.8\n";
    assert_eq!(with(text), expected(Law::TonduLopez(law)));
    let law = Bolen::new(0.098, 90.0, 6.2e5, 0.3, [0.26, 6.4, 1.3]).expect("a law");
    let text = "[actuator.force]\nlaw = \"bolen\"\nmax_force = \"90 N\"\nmax_pressure = \"6.2e5 Pa\"\nmax_contraction = 0.3\n\
                shape = [0.26, 6.4, 1.3]\n";
    assert_eq!(with(text), expected(Law::Bolen(law)));
    let law = MartensBoblan::new(&braid(), 0.098, 3e-4, [4e6, -60e6, 300e6, 100e6]).expect("a law");
    let text = "[actuator.force]\nlaw = \"martens-boblan\"\nmembrane_thickness = \"3e-4 m\"\n\
                modulus = [4e6, -60e6, 300e6, 100e6]\nmodulus_unit = \"Pa\"\nlength_unit = \"m\"\n";
    assert_eq!(with(text), expected(Law::MartensBoblan(law)));
    let bladder = Bladder::new(BladderForm::Exponential, 0.098, 6.0, 0.07).expect("a bladder");
    let text = "[actuator.bladder]\nform = \"exponential\"\nforce = \"6 N\"\nscale = 0.07\n";
    assert_eq!(with(text), body(characteristic(Law::IdealBraid).with_bladder(bladder), friction()));
    let tapered = characteristic(Law::IdealBraid).with_taper(2.9e-3, 1.3, [0.064, 0.098]).expect("a taper");
    assert_eq!(with("[actuator.taper]\nend_radius = \"2.9e-3 m\"\nlength_ratio = 1.3\n"), body(tapered, friction()));
}

#[test]
fn loads() {
    let with = |load: &str| rig(&[BODY, load, "[run]\nduration = \"1 s\"\n"]);
    let expected = |load| Rig::new(plain(), None, load).expect("a rig");
    let force = with(
        "[load]\nkind = \"constant-force\"\nmass = \"2.1 kg\"\nforce = \"20 N\"\n[tendon]\nstiffness = \"9e3 N/m\"\nrest_length = \"0.05 m\"\n",
    );
    let tendon = SeriesTendon::new(9e3, 0.05).expect("a tendon");
    let load = Load::constant_force(2.1, 20.0).expect("a load");
    assert_eq!(force, expected(load).with_tendon(tendon));
    let motion = Motion::sinusoid(0.088, 2e-3, 3.0, 0.4, 0.11).expect("a motion");
    let text = "[load]\nkind = \"prescribed-motion\"\nlength = \"0.088 m\"\namplitude = \"2e-3 m\"\nfrequency = \"3 Hz\"\nphase = \"0.4 rad\"\n";
    assert_eq!(with(text), expected(Load::Prescribed(motion)));
}

#[test]
fn a_joint() {
    let limb = Limb { mass: 0.3, distance: 0.11, inertia: 1.2e-3, gravity: 9.7, hanging_angle: 0.05 };
    let stops = Stops { ends: [Some(-0.6), Some(0.7)], stiffness: 450.0, damping: 1.7 };
    let tendons = [(0.015, 0.083), (0.017, 0.084)]
        .map(|(radius, rest_length)| Tendon { arm: MomentArm::pulley(radius).expect("an arm"), rest_length });
    let expected = Joint::new(limb, tendons, 0.07, 0.013, stops).expect("a joint");
    let built = document(&[BODY, DRIVE, PWM, JOINT]).joint_experiment().unwrap_or_else(|error| panic!("{error}"));
    let built = built.expect("a joint");
    assert_eq!(*built.rig.joint(), expected);
    for driven_one in built.rig.driven() {
        assert_eq!((&driven_one.actuator, &driven_one.actuation), (&driven(), &Some(pulsed())));
    }
    let initial = JointInitial {
        gauge_pressure: [1.5e5, 1.7e5].map(GaugePressure),
        temperature: [297.0, 299.0],
        angle: InitialAngle::At(0.09),
        angular_velocity: 0.4,
    };
    assert_eq!(scenario(&[BODY, DRIVE, PWM, JOINT]).joint_initial(), Some(initial));
}

/// PID control of pressure along a sinusoid.
const SWING: &str = "[controller]\nkind = \"pid\"\ngauge_pressure = \"3e5 Pa\"\namplitude = \"5e4 Pa\"\nfrequency = \"0.5 Hz\"\n\
    phase = \"0.3 rad\"\nrate = \"190 Hz\"\ndelay = 2\npulse_frequency = \"47 Hz\"\nresolution = \"900 Pa\"\n\
    proportional_band = \"3.9e5 Pa\"\n";
/// Control of a force at a length by the mass of air that the model needs.
const MODEL: &str = "[controller]\nkind = \"air-mass\"\nforce = \"25 N\"\nlength = \"0.087 m\"\nrate = \"190 Hz\"\n\
    highest_gauge_pressure = \"5e5 Pa\"\ntemperature = \"301 K\"\nproportional_band = \"2e-5 kg\"\n";
const CONTROLLERS: &str = "[command]\nkind = \"controllers\"\n";
/// The actions of a PID controller, every number another; the band is in the unit of what it keeps.
const ACTIONS: &str = r#"
integral_time = "0.21 s"
derivative_time = "0.011 s"
derivative_filter = 7.0
set_point_weight = 0.6
tracking_time = "0.13 s"
bias = 0.15
"#;

fn pid(quantity: Quantity, band: f64, output: Output) -> Keeps {
    let pid = Pid::new(quantity, band, output).and_then(|pid| pid.with_integral(0.21));
    let pid = pid.and_then(|pid| pid.with_derivative(0.011, 7.0)).and_then(|pid| pid.with_tracking(0.13));
    let pid = pid.and_then(|pid| pid.with_set_point_weight(0.6)).and_then(|pid| pid.with_bias(0.15));
    Keeps::Pid(pid.expect("a controller"))
}

#[test]
fn a_pid_controller() {
    let built = document(&[BODY, DRIVE, CONTROLLERS, SWING, ACTIONS, HANGING]).controlled_experiment();
    let built = built.unwrap_or_else(|error| panic!("{error}")).expect("a controller");
    let set_point = SetPoint::sinusoid(Quantity::Pressure, 3e5, 5e4, 0.5, 0.3).expect("a set point");
    let keeps = pid(Quantity::Pressure, 3.9e5, Output::FillHoldExhaust);
    let expected = Tracker::new(Quantity::Pressure, set_point, keeps).expect("a tracker");
    assert_eq!(built.law, ControlLaw::Tracker(expected));
    let sampling = Sampling::new(190.0, 2).and_then(|sampling| sampling.with_pulse_frequency(47.0));
    assert_eq!(built.sampling, sampling.expect("a rate"));
    assert_eq!(built.sensors.pressure, Sensor::new(Quantity::Pressure, 900.0, None).expect("a sensor"));
    // A joint's is read by the same keys in another unit.
    let angle =
        "[controller]\nkind = \"pid\"\nangle = \"0.1 rad\"\nrate = \"190 Hz\"\nproportional_band = \"0.35 rad\"\n";
    let built = document(&[BODY, DRIVE, CONTROLLERS, angle, ACTIONS, JOINT]).controlled_joint_experiment();
    let JointLaw::Tracker(tracker) = built.unwrap_or_else(|error| panic!("{error}")).expect("a controller").law else {
        panic!("another law")
    };
    assert_eq!(tracker.regulator, pid(Quantity::Angle, 0.35, Output::FillHoldExhaust));
}

#[test]
fn controllers_by_a_relay_and_by_the_model() {
    let relay = "[controller]\nkind = \"bang-bang\"\ngauge_pressure = \"3e5 Pa\"\nrate = \"190 Hz\"\ndead_band = \"3e4 Pa\"\n\
                 hysteresis = \"1e4 Pa\"\n";
    let law = |text: &str| {
        let built = document(&[BODY, DRIVE, CONTROLLERS, text, HANGING]).controlled_experiment();
        built.unwrap_or_else(|error| panic!("{error}")).expect("a controller").law
    };
    let set_point = SetPoint::constant(Quantity::Pressure, 3e5).expect("a set point");
    let keeps = Relay::new(Quantity::Pressure, 3e4, 1e4, Between::Hold).map(Keeps::Relay).expect("a relay");
    let expected = Tracker::new(Quantity::Pressure, set_point, keeps).expect("a tracker");
    assert_eq!(law(relay), ControlLaw::Tracker(expected));
    let force = SetPoint::constant(Quantity::Force, 25.0).expect("a set point");
    let length = SetPoint::constant(Quantity::Length, 0.087).expect("a set point");
    let aim = StaticAim::new(driven(), force, Place::Wanted(length), GaugePressure(5e5)).expect("an aim");
    let keeps = pid(Quantity::AirMass, 2e-5, Output::FillHoldExhaust);
    let expected = AirMass::new(aim, 301.0, keeps).expect("a controller");
    assert_eq!(law(&format!("{MODEL}{ACTIONS}")), ControlLaw::AirMass(Box::new(expected)));
}

/// What a file says at a path, in SI.
fn said(table: &toml::Table, path: &str) -> Option<f64> {
    let mut value: Option<&toml::Value> = None;
    for name in path.split('.') {
        value = value.map_or(table.get(name), |table| table.get(name));
        value?;
    }
    match value? {
        toml::Value::String(text) => quantity::parse(text).ok().map(|read| read.value),
        toml::Value::Float(number) => Some(*number),
        toml::Value::Integer(number) => Some(*number as f64),
        _ => None,
    }
}

/// A sweep, `--set` by a number and a derivative reach a number by its path: it is the one that the file says there.
#[test]
fn each_number_is_found_by_its_path() {
    let relay = "[controller]\nkind = \"bang-bang\"\ngauge_pressure = \"3e5 Pa\"\nrate = \"190 Hz\"\ndead_band = \"3e4 Pa\"\n\
                 hysteresis = \"1e4 Pa\"\n";
    let mut found = std::collections::BTreeSet::new();
    for pieces in [
        &[BODY, DRIVE, PWM, HANGING][..],
        &[BODY, DRIVE, CONTROLLERS, SWING, ACTIONS, HANGING],
        &[BODY, DRIVE, CONTROLLERS, relay, HANGING],
        &[BODY, DRIVE, CONTROLLERS, MODEL, ACTIONS, HANGING],
        &[BODY, DRIVE, PWM, JOINT],
    ] {
        let (table, mut read) = (pieces.concat().parse::<toml::Table>().expect("TOML"), scenario(pieces));
        for path in KEYS.iter().flat_map(|key| [key.path.to_owned(), format!("antagonist.{}", key.path)]) {
            let Some(number) = said(&table, &path) else { continue };
            let Ok(place) = mckibben_scenario::Place::find(&path, &mut read) else { continue };
            assert_eq!(place.value(&mut read), Some(number), "{path}");
            found.insert(path);
        }
    }
    let actions =
        ["integral_time", "derivative_time", "derivative_filter", "set_point_weight", "tracking_time", "bias"];
    assert!(actions.iter().all(|name| found.contains(&format!("controller.{name}"))), "{found:?}");
    assert!(found.len() > 60, "{}: {found:?}", found.len());
}
