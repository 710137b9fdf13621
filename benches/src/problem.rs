//! The problem of all solvers: one scenario as plain SI numbers, and the answer to compare with.

use mckibben::simulation::simulate;
use mckibben_scenario::{
    Command, CommandState, Document, Effectiveness, Experiment, FlowPath, Load, Process, Scenario, ValveKind,
};
use std::fmt::Write;
use std::path::Path;

/// Time in s between the samples at which answers are compared.
pub const SAMPLE_INTERVAL: f64 = 1e-3;
/// Tolerance of the run that stands for the truth.
pub const REFERENCE_TOLERANCE: f64 = 1e-12;

/// A flow path of the three-way valve, as the peers number them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// Sealed.
    Closed = -1,
    /// Joined to the supply.
    Supply = 0,
    /// Joined to the atmosphere.
    Exhaust = 1,
}

/// One scenario of the kind that the peers know: a hanging mass, isentropic air, and a three-way orifice or none.
pub struct Problem {
    /// What our own integrator is given.
    pub experiment: Experiment,
    /// The scenario in SI.
    pub scenario: Scenario,
    /// The flow path that is open at first.
    pub initial_port: Port,
    /// Instants in s at which the poppet moves, and the flow path that is open from then on.
    pub edges: Vec<(f64, Port)>,
    /// Length and pressure at each sample, from a run at [`REFERENCE_TOLERANCE`].
    reference: Vec<[f64; 2]>,
}

impl Problem {
    /// Reads a scenario file.
    ///
    /// # Errors
    /// When the file is wrong, or outside what the peers know.
    pub fn load(path: &Path) -> Result<Self, String> {
        let document = Document::load(path).map_err(|error| error.to_string())?;
        let scenario = document.scenario().map_err(|error| error.to_string())?;
        let experiment = document.experiment().map_err(|error| error.to_string())?;
        let known = scenario.air.process == Process::Isentropic
            && scenario.actuator.effectiveness == Effectiveness::Constant(1.0)
            && scenario.actuator.friction.coulomb_width > 0.0
            && matches!(scenario.load, Load::HangingMass { .. })
            && scenario.valve.as_ref().is_none_or(|valve| {
                valve.kind == ValveKind::ThreeWay
                    && matches!(valve.flow_path, FlowPath::FlowArea(_))
                    && valve.exhaust.is_none()
            });
        if !known {
            return Err(format!("{}: the peers know only the paper's own laws", path.display()));
        }
        let (initial_port, edges) = edges(&scenario)?;
        let trajectory = simulate(&experiment.rig, experiment.start, experiment.run.duration, REFERENCE_TOLERANCE)
            .map_err(|error| error.to_string())?;
        let reference = trajectory.samples(SAMPLE_INTERVAL).map(|row| [row.length, row.pressure.0]).collect();
        Ok(Self { experiment, scenario, initial_port, edges, reference })
    }

    /// Simulated time in s.
    pub fn duration(&self) -> f64 {
        self.experiment.run.duration
    }

    /// Largest difference from the reference over the samples, in length or in pressure, each relative to its range.
    pub fn error(&self, samples: &[[f64; 2]]) -> f64 {
        if samples.len() != self.reference.len() {
            return f64::INFINITY;
        }
        let column = |index: usize| {
            let values = self.reference.iter().map(|row| row[index]);
            let range = values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min);
            let pairs = samples.iter().zip(&self.reference);
            pairs.map(|(a, b)| (a[index] - b[index]).abs()).fold(0.0, f64::max) / range
        };
        let (length, pressure) = (column(0), column(1));
        if length.is_nan() || pressure.is_nan() { f64::INFINITY } else { length.max(pressure) }
    }

    /// The numbers by name, in the order in which the peers read them; then the edges.
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        let Scenario { actuator, air, supply, valve, load, .. } = &self.scenario;
        let start = &self.experiment.start;
        let (mass, gravity) = match load {
            Load::HangingMass { mass, gravity } => (*mass, *gravity),
            _ => (f64::NAN, f64::NAN),
        };
        let (supply_pressure, temperature) = supply.as_ref().map_or((air.atmospheric_pressure, 293.15), |s| {
            (s.gauge_pressure + air.atmospheric_pressure, s.temperature)
        });
        let (area, laminar_ratio) = valve.as_ref().map_or((0.0, 0.999), |valve| match valve.flow_path {
            FlowPath::FlowArea(area) => (valve.efficiency * area, valve.laminar_ratio),
            FlowPath::Iso6358 { .. } | FlowPath::Kv { .. } | FlowPath::Cv { .. } => (f64::NAN, f64::NAN),
        });
        let magnitudes = self.magnitudes();
        vec![
            ("thread_length", actuator.thread_length),
            ("turns", actuator.turns),
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
            ("supply", supply_pressure),
            ("temperature", temperature),
            ("area", area),
            ("laminar_ratio", laminar_ratio),
            ("mass", mass),
            ("pull", mass * gravity),
            ("length", start.length),
            ("velocity", start.velocity),
            ("pressure", start.pressure.0),
            ("air_mass", start.air_mass),
            ("length_scale", magnitudes[0]),
            ("velocity_scale", magnitudes[1]),
            ("pressure_scale", magnitudes[2]),
            ("air_mass_scale", magnitudes[3]),
            ("duration", self.duration()),
            ("sample_interval", SAMPLE_INTERVAL),
            ("initial_port", f64::from(self.initial_port as i32)),
            ("edges", self.edges.len() as f64),
        ]
    }

    /// Typical sizes of the four states, which set the absolute tolerances of every peer: the longest length, that length
    /// in a second, the atmosphere, and the air at the start.
    pub fn magnitudes(&self) -> [f64; 4] {
        let actuator = self.experiment.rig.actuator();
        let longest = actuator.limits().max_length();
        [longest, longest, actuator.air().atmosphere().0, self.experiment.start.air_mass]
    }

    /// The problem as the text that peers in other languages read.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for (name, value) in self.numbers() {
            writeln!(text, "{name} {value:e}").expect("a string takes any text");
        }
        for (time, port) in &self.edges {
            writeln!(text, "{time:e} {}", *port as i32).expect("a string takes any text");
        }
        text
    }
}

/// The first open flow path and the instants at which the poppet of a three-way valve moves under PWM.
fn edges(scenario: &Scenario) -> Result<(Port, Vec<(f64, Port)>), String> {
    let Some(valve) = &scenario.valve else { return Ok((Port::Closed, Vec::new())) };
    let Some(Command::Pwm { frequency, duty, pulse: CommandState::Fill, rest: CommandState::Exhaust }) =
        scenario.command
    else {
        return Err("the peers know only pulse-width modulation between fill and exhaust".into());
    };
    let (pulse, gap) = (duty / frequency, (1.0 - duty) / frequency);
    if pulse <= valve.opening_delay || gap <= valve.closing_delay {
        return Err("a pulse or a gap is too short to move the seat".into());
    }
    let mut edges = Vec::new();
    for period in 0.. {
        let start = f64::from(period) / frequency;
        for (time, port) in [
            (start + valve.opening_delay, Port::Supply),
            ((f64::from(period) + duty) / frequency + valve.closing_delay, Port::Exhaust),
        ] {
            if time >= scenario.run.duration * (1.0 - 1e-12) {
                return Ok((Port::Exhaust, edges));
            }
            edges.push((time, port));
        }
    }
    unreachable!("the periods go on until the run is over")
}
