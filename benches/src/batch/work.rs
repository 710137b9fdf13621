//! The work: many hanging masses on the paper's actuator, each with its own mass and supply pressure.

use mckibben::simulation::{Initial, InitialLength, Rig, State};
use mckibben::valve::PoppetClock;
use mckibben::{GaugePressure, parameter};
use mckibben_scenario::{Document, Effectiveness, FlowPath, Load, Scenario};
use std::fmt::Write;

/// Step in s.
pub const STEP: f64 = 1e-4;
/// Steps of a run whose answer is compared: ten periods of the valve, and then to the middle of a filling.
pub const STEPS: u64 = 4_100;

/// Figure 12 of the paper, whose mass and supply pressure are then varied.
const SCENARIO: &str = r#"
[actuator]
preset = "colbrunn-2001"
[air]
process = "isentropic"
[supply]
gauge_pressure = "100 psi"
temperature = "293.15 K"
[valve]
preset = "matrix-eight-channel"
exhaust_temperature = "actuator"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
gauge_pressure = "0 psi"
temperature = "293.15 K"
length = "equilibrium"
[run]
duration = "0.41 s"
"#;

const POUND: f64 = 0.453_592_37;
const POUND_PER_SQUARE_INCH: f64 = POUND * 9.806_65 / (0.0254 * 0.0254);

/// A part of a step: the valve does not move inside it.
#[derive(Clone, Copy)]
pub struct Part {
    /// When it begins, in s.
    pub time: f64,
    /// Its length in s.
    pub step: f64,
    /// Whether the flow path to the supply is open; else that to the atmosphere is.
    pub filling: bool,
}

/// A rig and its state at the start.
#[derive(Clone, Debug)]
pub struct Row {
    /// The actuator with its valve and its load.
    pub rig: Rig,
    /// The state at t = 0.
    pub start: State,
}

/// What every row has in common.
pub struct Work {
    scenario: Scenario,
    rig: Rig,
}

impl Work {
    /// Reads the scenario.
    ///
    /// # Errors
    /// When the scenario is wrong.
    pub fn new() -> Result<Self, String> {
        let document = Document::parse(SCENARIO, "batch.toml").map_err(|error| error.to_string())?;
        let scenario = document.scenario().map_err(|error| error.to_string())?;
        let rig = scenario.rig().map_err(|error| error.to_string())?;
        Ok(Self { scenario, rig })
    }

    /// The first `count` rows of a sequence that fills 3 to 15 lb by 60 to 110 psi evenly.
    ///
    /// # Errors
    /// When a row has no equilibrium to start from.
    pub fn rows(&self, count: usize) -> Result<Vec<Row>, String> {
        (0..count).map(|index| self.row(index)).collect()
    }

    fn row(&self, index: usize) -> Result<Row, String> {
        let (mass, supply) = mass_and_supply(index);
        let rig = self.rig.map(|parameter, value| match parameter.key {
            key if key == parameter::MASS.key => mass,
            key if key == parameter::SUPPLY_GAUGE_PRESSURE.key => supply,
            _ => value,
        });
        let start = rig
            .start(&Initial {
                gauge_pressure: GaugePressure(0.0),
                temperature: self.scenario.initial.temperature,
                length: InitialLength::Equilibrium,
                velocity: 0.0,
            })
            .map_err(|error| error.to_string())?;
        Ok(Row { rig, start })
    }

    /// The steps of a run, each in `divisions` equal steps, those divided at every instant at which the poppet moves.
    pub fn parts(&self, divisions: u64) -> Vec<Part> {
        let Some(drive) = self.rig.actuation() else { return Vec::new() };
        let mut clock = PoppetClock::released();
        clock.advance(0.0, &drive.solenoid, &drive.command);
        let mut parts = Vec::new();
        let mut time = 0.0;
        for step in 1..=STEPS * divisions {
            let end = step as f64 * STEP / divisions as f64;
            let mut to = |until: f64, clock: &PoppetClock| {
                // An edge on a border of steps differs from it by a rounding.
                if until - time > 1e-9 * STEP {
                    parts.push(Part { time, step: until - time, filling: clock.ports(&drive.solenoid).supply });
                    time = until;
                }
            };
            while let Some(edge) = clock.next_motion(&drive.solenoid, &drive.command, end) {
                to(edge, &clock);
                clock.advance(edge, &drive.solenoid, &drive.command);
            }
            to(end, &clock);
        }
        parts
    }

    /// What the peers read: the numbers that all rows share, the parts of the steps, and the first rows.
    ///
    /// # Errors
    /// When the scenario is not what the peers know.
    pub fn text(&self, divisions: u64, rows: &[Row]) -> Result<String, String> {
        let mut text = String::new();
        for (name, value) in self.numbers()? {
            let _ = writeln!(text, "{name} {value:e}");
        }
        let parts = self.parts(divisions);
        let _ = writeln!(text, "parts {}", parts.len());
        for part in parts {
            let _ = writeln!(text, "{:e} {:e} {}", part.time, part.step, i32::from(part.filling));
        }
        let _ = writeln!(text, "rows {}", rows.len());
        for (index, Row { start, .. }) in rows.iter().enumerate() {
            let (mass, supply) = mass_and_supply(index);
            let supply = supply + self.scenario.air.atmospheric_pressure;
            let State { length, velocity, pressure, air_mass } = start;
            let _ = writeln!(text, "{mass:e} {supply:e} {length:e} {velocity:e} {:e} {air_mass:e}", pressure.0);
        }
        Ok(text)
    }

    fn numbers(&self) -> Result<[(&'static str, f64); 17], String> {
        let Scenario { actuator, air, supply, valve, load, .. } = &self.scenario;
        let (Some(supply), Some(valve), Load::HangingMass { gravity, .. }) = (supply, valve, load) else {
            return Err("the batch is of valves and hanging masses".into());
        };
        let (FlowPath::FlowArea(area), Effectiveness::Constant(effectiveness)) =
            (valve.flow_path, &actuator.effectiveness)
        else {
            return Err("the peers know the paper's orifice and a constant effectiveness".into());
        };
        Ok([
            ("thread_length", actuator.thread_length),
            ("turns", actuator.turns),
            ("effectiveness", *effectiveness),
            ("min_length", actuator.min_length),
            ("max_length", actuator.max_length),
            ("external_volume", actuator.external_volume),
            ("viscous", actuator.friction.viscous),
            ("coulomb_width", actuator.friction.coulomb_width),
            ("stiffness", actuator.limit.stiffness),
            ("damping", actuator.limit.damping),
            ("gamma", air.heat_capacity_ratio),
            ("gas_constant", air.gas_constant),
            ("atmosphere", air.atmospheric_pressure),
            ("temperature", supply.temperature),
            ("area", valve.efficiency * area),
            ("laminar_ratio", valve.laminar_ratio),
            ("gravity", *gravity),
        ])
    }
}

/// Mass in kg and gauge pressure of the supply in Pa of a row, by the additive recurrence of the plastic number: each
/// square of the plane gets its share from any first rows.
fn mass_and_supply(index: usize) -> (f64, f64) {
    let share = |factor: f64| (0.5 + factor * index as f64).fract();
    let mass = (3.0 + 12.0 * share(0.754_877_666_246_692_7)) * POUND;
    (mass, (60.0 + 50.0 * share(0.569_840_290_998_053_2)) * POUND_PER_SQUARE_INCH)
}
