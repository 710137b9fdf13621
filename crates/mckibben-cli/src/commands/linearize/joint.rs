//! The linear model of an antagonistic joint: its point, as text, as JSON and as a script.
//!
//! Both valves are held shut. The point is the balance at the scenario's initial gauge pressures, or at `--angle` with
//! `--stiffness`.

use super::{LinearizeArguments, export, told};
use crate::failure::Failure;
use crate::joint::NAMES;
use crate::quantities::{digits, quantity};
use crate::terminal::{HEADING, styled};
use mckibben::GaugePressure;
use mckibben::control::Held;
use mckibben::linearize::{JointBalance, JointLinearization, Pole, StateSpace, linearize_joint};
use mckibben_scenario::{Assumed, JointExperiment};

/// A joint's linear model with what is known about it.
pub(super) struct JointModel<'a> {
    pub(super) name: &'a str,
    pub(super) linear: JointLinearization,
    pub(super) system: StateSpace,
    pub(super) poles: Vec<Pole>,
    pub(super) assumed: Vec<Assumed>,
}

impl<'a> JointModel<'a> {
    /// The model that the arguments ask for.
    pub(super) fn new(
        name: &'a str,
        experiment: &JointExperiment,
        arguments: &LinearizeArguments,
        assumed: Vec<Assumed>,
    ) -> Result<Self, Failure> {
        refuse(arguments)?;
        let rig = &experiment.rig;
        let initial = [0, 1].map(|i| {
            let actuator = &rig.driven()[i].actuator;
            let (pressure, mass) = (experiment.start.pressure[i], experiment.start.air_mass[i]);
            let volume = actuator.volume(rig.joint().lengths(experiment.start.angle)[i]);
            let temperature = pressure.0 * volume / (mass * actuator.air().gas_constant());
            (pressure.gauge(actuator.air().atmosphere()), arguments.temperature.unwrap_or(temperature))
        });
        let balance = match (arguments.angle, arguments.stiffness) {
            (Some(angle), Some(stiffness)) => JointBalance::AtStiffness { angle, stiffness },
            _ => JointBalance::AtPressures(initial.map(|(gauge, _)| gauge)),
        };
        let linear = linearize_joint(rig, balance, initial.map(|(_, temperature)| temperature))?;
        let system = if arguments.all_states { linear.system.clone() } else { linear.minimal() };
        Ok(Self { name, poles: system.poles()?, system, linear, assumed })
    }

    /// The gauge pressures at the point.
    fn gauge_pressures(&self) -> [GaugePressure; 2] {
        let driven = self.linear.rig.driven();
        [0, 1].map(|i| self.linear.state.pressure[i].gauge(driven[i].actuator.air().atmosphere()))
    }

    /// Stiffness of both actuators at kept pressures, and with the valves shut, in N·m/rad.
    fn stiffnesses(&self) -> [f64; 2] {
        let JointLinearization { rig, state, .. } = &self.linear;
        [Held::Pressures, Held::AirMasses].map(|held| rig.stiffness(state.angle, state.pressure, held))
    }

    /// The values at the operating point, each name with its unit at the end.
    pub(super) fn point(&self) -> Vec<(&'static str, f64)> {
        let (state, gauge) = (&self.linear.state, self.gauge_pressures());
        let [open, shut] = self.stiffnesses();
        vec![
            ("angle_rad", state.angle),
            ("angular_velocity_rad_s", state.angular_velocity),
            ("agonist_gauge_pressure_pa", gauge[0].0),
            ("antagonist_gauge_pressure_pa", gauge[1].0),
            ("agonist_air_mass_kg", state.air_mass[0]),
            ("antagonist_air_mass_kg", state.air_mass[1]),
            ("stiffness_n_m_rad", open),
            ("sealed_stiffness_n_m_rad", shut),
            ("coulomb_bound_n_m", self.linear.coulomb_bound()),
        ]
    }

    /// The model as text for people.
    pub(super) fn text(&self) -> String {
        let mut text = format!("{}\n", styled(HEADING, format!("{}, both valves held shut", self.name)));
        let (gauge, [open, shut]) = (self.gauge_pressures(), self.stiffnesses());
        let mut lines = vec![("angle", quantity(self.linear.state.angle, "rad"))];
        lines.extend((0..2).map(|i| (NAMES[i], format!("{} gauge", quantity(gauge[i].0, "Pa")))));
        lines.push(("stiffness", format!("{} N*m/rad, with the valves shut {}", digits(open), digits(shut))));
        let bound = self.linear.coulomb_bound();
        if bound > 0.0 {
            lines.push(("sticks within", format!("± {} of the balance", quantity(bound, "N*m"))));
        }
        text.push_str(&told::lines(&lines));
        for (heading, table) in [("Model", told::matrices(&self.system)), ("Poles", told::poles(&self.poles))] {
            text.push_str(&format!("\n{}  {}\n{}", styled(HEADING, heading), table.caption, table.to_text()));
        }
        text
    }

    /// The model as JSON.
    pub(super) fn json(&self) -> String {
        export::joint_json(self)
    }

    /// The model as a script for MATLAB and Octave.
    pub(super) fn matlab(&self) -> String {
        export::script(self.name, "antagonistic joint, both valves held shut", &self.point(), &self.system, &self.poles)
    }
}

/// Refuses what is asked of one actuator alone.
fn refuse(arguments: &LinearizeArguments) -> Result<(), Failure> {
    let of_one = [
        ("--pressure", arguments.pressure.is_some()),
        ("--length", arguments.length.is_some()),
        ("--load", arguments.load.is_some()),
        ("--duty", arguments.duty.is_some()),
        ("--pwm", arguments.pwm),
        ("--amplitude", arguments.amplitude.is_some()),
        ("--plot", arguments.plot.is_some()),
    ];
    match of_one.into_iter().find(|(_, given)| *given) {
        None => Ok(()),
        Some((name, _)) => Err(Failure::input(
            format!("{name}: a joint has two actuators, and is linearised with both valves held shut"),
            "give --angle with --stiffness, or --set initial.gauge_pressure and --set antagonist.initial.gauge_pressure",
        )),
    }
}
