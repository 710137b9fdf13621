//! The linear model of an antagonistic joint: its point, in words, as JSON and as a script.
//!
//! | requested | the valves | the point |
//! |---|---|---|
//! | `angle` with `stiffness` | held shut | there; the pressures follow |
//! | pulses, set points or positions of a spool | by their commands, pulses on average | the balance at the pressures that they make |
//! | else | held shut | the balance at the scenario's initial gauge pressures |

use super::account::{self, Account, Block, Line, around, is_held};
use super::export::owned;
use super::{Request, delays, export};
use crate::failure::Failure;
use crate::joint::NAMES;
use crate::quantities::{digits, given, quantity};
use crate::warnings;
use mckibben::control::Held;
use mckibben::linearize::{
    Controllability, JointBalance, JointLinearization, Pole, StateSpace, linearize_driven_joint, linearize_joint,
};
use mckibben::plant::{JointPlant, PlantAir, ValveAverage};
use mckibben::simulation::Driven;
use mckibben::{Error, GaugePressure, parameter};
use mckibben_scenario::{Assumed, JointExperiment};

/// A joint's linear model with what is known about it.
pub(super) struct JointModel {
    pub(super) name: String,
    pub(super) linear: JointLinearization,
    pub(super) system: StateSpace,
    pub(super) poles: Vec<Pole>,
    /// What each input reaches.
    pub(super) reach: Vec<Controllability>,
    /// By how much later in s than each input its effect begins.
    pub(super) delays: Vec<f64>,
    pub(super) assumed: Vec<Assumed>,
    driven: bool,
}

impl JointModel {
    /// The requested model.
    pub(super) fn new(
        name: &str,
        experiment: &JointExperiment,
        request: &Request,
        assumed: Vec<Assumed>,
    ) -> Result<Self, Failure> {
        refuse(request)?;
        let rig = &experiment.rig;
        let initial = [0, 1].map(|i| {
            let actuator = &rig.driven()[i].actuator;
            let (pressure, mass) = (experiment.start.pressure[i], experiment.start.air_mass[i]);
            let volume = actuator.volume(rig.lengths(experiment.start.angle, experiment.start.pressure)[i]);
            let temperature = pressure.0 * volume / (mass * actuator.air().gas_constant());
            (pressure.gauge(actuator.air().atmosphere()), request.temperature.unwrap_or(temperature))
        });
        let commanded = |driven: &Driven| driven.actuation.as_ref().is_some_and(|of| of.command.is_continuous());
        let balance = match (request.angle, request.stiffness) {
            (Some(angle), Some(stiffness)) => Some(JointBalance::AtStiffness { angle, stiffness }),
            _ if rig.driven().iter().any(commanded) => None,
            _ => Some(JointBalance::AtPressures(initial.map(|(gauge, _)| gauge))),
        };
        let driven = balance.is_none();
        let linear = match balance {
            Some(balance) => linearize_joint(rig, balance, initial.map(|(_, temperature)| temperature))
                .map_err(|error| of_request(request, error))?,
            None => {
                let air = request.temperature.map_or(PlantAir::Start, |kelvin| PlantAir::Temperatures(vec![kelvin; 2]));
                linearize_driven_joint(rig, &experiment.start, &air)?
            }
        };
        let system = if request.all_states { linear.system.clone() } else { linear.minimal() };
        let reach = (0..system.inputs.len()).map(|input| linear.controllability(&system, input));
        let reach = reach.collect::<Result<_, _>>()?;
        let delays = delays(&system, &linear.plant, &linear.inputs());
        Ok(Self { name: name.to_owned(), poles: system.poles()?, reach, delays, system, linear, assumed, driven })
    }

    /// Whether the valves are taken by their commands.
    pub(super) fn is_driven(&self) -> bool {
        self.driven
    }

    /// How the valves are taken.
    fn valves(&self) -> String {
        let frequency = |of: &ValveAverage| quantity(of.frequency, "Hz");
        match self.linear.averages() {
            _ if !self.driven => "both valves held shut".to_owned(),
            [first, second] if first.frequency == second.frequency => {
                format!("both valves under PWM at {} on average", frequency(first))
            }
            [first, second] => {
                format!("valves under PWM at {} and {} on average", frequency(first), frequency(second))
            }
            _ => "valves by their commands, pulses on average".to_owned(),
        }
    }

    /// Whose a valve is.
    pub(super) fn whose(&self, valve: usize) -> &'static str {
        let has_valve = self.linear.rig.driven()[0].actuation.is_some();
        NAMES[if has_valve { valve.min(1) } else { 1 }]
    }

    /// The caption of a figure.
    pub(super) fn caption(&self) -> String {
        let gauge = self.gauge_pressures().map(|gauge| quantity(gauge.0, "Pa"));
        let coulomb = if is_held(self.linear.coulomb_bounds()) { ", sliding without Coulomb friction" } else { "" };
        let angle = quantity(self.linear.state.angle, "rad");
        let delays = account::left_out(&self.delays);
        format!("At {angle}, {} and {} gauge, {}{coulomb}{delays}.", gauge[0], gauge[1], self.valves())
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
        let [less, more] = self.linear.coulomb_bounds();
        let mut point = vec![
            ("angle_rad", state.angle),
            ("angular_velocity_rad_s", state.angular_velocity),
            ("agonist_gauge_pressure_pa", gauge[0].0),
            ("antagonist_gauge_pressure_pa", gauge[1].0),
            ("agonist_air_mass_kg", state.air_mass[0]),
            ("antagonist_air_mass_kg", state.air_mass[1]),
            ("stiffness_n_m_rad", open),
            ("sealed_stiffness_n_m_rad", shut),
            ("coulomb_bound_n_m", more),
            ("coulomb_bound_below_n_m", less),
        ];
        for average in self.linear.averages() {
            let name = if self.whose(average.valve) == NAMES[0] { "agonist_duty" } else { "antagonist_duty" };
            point.push((name, average.duty));
        }
        point
    }

    /// The model in words and tables.
    pub(super) fn account(&self) -> Account {
        let (gauge, [open, shut]) = (self.gauge_pressures(), self.stiffnesses());
        let mut lines = vec![Line::new("angle", quantity(self.linear.state.angle, "rad"))];
        let exceeded = JointPlant::new(&self.linear.rig)
            .map(|view| [0, 1].map(|i| warnings::feed_of(view.plant(), i, gauge[i].0)))
            .unwrap_or_default();
        lines.extend(exceeded.into_iter().enumerate().map(|(i, exceeded)| Line {
            warning: account::doubts(exceeded, &self.linear.rig.driven()[i].actuator),
            ..Line::new(NAMES[i], format!("{} gauge", quantity(gauge[i].0, "Pa")))
        }));
        let whose = |valve: usize| format!("{}'s spool", self.whose(valve));
        lines.extend(account::of_spools(&self.linear.plant, whose));
        let of = |stiffness| quantity(stiffness, "N*m/rad");
        let actuators = self.linear.rig.driven().iter().map(|driven| &driven.actuator);
        let left_out = account::without_hysteresis(actuators);
        let stiffness = format!("{}, with the valves shut {}{left_out}", of(open), of(shut));
        lines.push(Line::new("stiffness", stiffness));
        let bounds = self.linear.coulomb_bounds();
        if is_held(bounds) {
            lines.push(Line::new("sticks within", format!("{} of the balance", around(bounds, "N*m"))));
        }
        let mut blocks = vec![Block::of_lines("", lines)];
        for average in self.linear.averages() {
            let heading = format!("Mean flow of the {}'s valve", self.whose(average.valve));
            blocks.push(Block::of_lines(&heading, account::pwm(average, &self.poles, Vec::new())));
        }
        blocks.push(Block::of_table("Model", account::matrices(&self.system)));
        blocks.extend(account::dynamics(&self.system, &self.poles, &self.reach));
        let notes = account::of_delays(&self.system, &self.delays).into_iter().collect();
        Account { title: format!("{}, {}", self.name, self.valves()), blocks, notes }
    }

    /// The model as JSON.
    pub(super) fn json(&self) -> String {
        export::joint_json(self)
    }

    /// The model as a script for MATLAB and Octave.
    pub(super) fn matlab(&self) -> String {
        let kind = format!("antagonistic joint, {}", self.valves());
        export::script((&self.name, &kind), &owned(self.point()), (&self.system, &self.delays), &self.poles)
    }
}

/// An error of the core, in which a requested angle and stiffness have the names of the request: the core calls them, and the lengths
/// that follow, after the keys of a controller.
fn of_request(request: &Request, error: Error) -> Failure {
    let (parameter, remedy) = match &error {
        Error::Inconsistent { parameter, remedy, .. } => (*parameter, *remedy),
        Error::OutOfRange { parameter, .. } => (*parameter, parameter.remedy),
        _ => return error.into(),
    };
    let named = [
        (&parameter::SET_ANGLE, "angle", request.angle, "rad"),
        (&parameter::SET_STIFFNESS, "stiffness", request.stiffness, "N*m/rad"),
        (&parameter::SET_LENGTH, "angle", request.angle, "rad"),
    ];
    let Some((_, name, Some(value), unit)) = named.into_iter().find(|(of, ..)| of.key == parameter.key) else {
        return error.into();
    };
    let value = format!("`{name}` = {} {unit}", digits(value));
    let (is_length, title) = match &error {
        Error::Inconsistent { value: length, requirement, .. } if parameter.key == parameter::SET_LENGTH.key => (
            true,
            format!("{value} gives an actuator a length of {}, which contradicts {requirement}", given(*length, "m")),
        ),
        Error::OutOfRange { value: length, .. } if parameter.key == parameter::SET_LENGTH.key => {
            (true, format!("{value} gives an actuator a length of {}", given(*length, "m")))
        }
        Error::Inconsistent { requirement, .. } => (false, format!("{value} contradicts {requirement}")),
        _ => (false, format!("{value} is outside its range ({})", parameter.range)),
    };
    let nearer =
        "give an angle nearer to that at which both actuators rest; a number is in rad, and text may be \"20 deg\"";
    Failure::input(title, if is_length { nearer } else { remedy })
}

/// Refuses options of one actuator alone.
fn refuse(request: &Request) -> Result<(), Failure> {
    match request.first_beyond(&["angle"]) {
        None => Ok(()),
        Some("amplitude") => Err(Failure::input(
            "`amplitude` is not supported for a joint: its Coulomb friction is left out of the model",
            "leave `amplitude` out, or describe the joint by a mechanism and two actuators with names",
        )),
        Some(name) => Err(Failure::input(
            format!("a joint has two actuators, and `{name}` names no one of them"),
            "give `angle` with `stiffness`, or set initial.gauge_pressure and command.duty in the scenario, and those of \
             the antagonist",
        )),
    }
}
