//! A scenario near an operating point: matrices, poles, and a Bode plot.
//!
//! | part | what |
//! |---|---|
//! | `linear_model` | the model of whatever the scenario describes |
//! | `given` | the requested point |
//! | `account` | the model in words and tables |
//! | `export` | the model as JSON and as a MATLAB or Octave script |
//! | `bode` | the figure |
//! | `joint` | all of this for an antagonistic joint |
//! | `plant` | all of this for a file of many actuators |
//!
//! Everything is computed by [`mckibben::linearize`]. Checked by the tests of the program, `tests/linearize.rs`.

mod account;
mod bode;
mod export;
mod given;
mod joint;
mod linear_model;
mod plant;

use crate::failure::Failure;
use crate::quantities;
pub use account::{Account, Block, Line};
pub use linear_model::LinearModel;
use mckibben::linearize::{Controllability, Linearization, Pole, Signal, StateSpace};
use mckibben::plant::PlantLinearization;
use mckibben_scenario::Assumed;

/// Which linear model is requested. What is not given is that of the scenario.
///
/// Two of gauge pressure, length and load give the third. A duty gives the pressure by the valve's mean flow; so does the
/// scenario's own PWM where neither pressure nor length is given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Gauge pressure at the point in Pa.
    pub gauge_pressure: Option<f64>,
    /// Distance between the attachments at the point in m.
    pub length: Option<f64>,
    /// The load.
    pub load: Option<Measure>,
    /// Commanded duty at the point: the valve by its mean flow under PWM.
    pub duty: Option<f64>,
    /// The valve by its mean flow under PWM, at the duty that holds the pressure.
    pub pwm: bool,
    /// Temperature of the air at the point in K; else the scenario's air, brought there by its process.
    pub temperature: Option<f64>,
    /// Angle of a joint at the point in rad; with `stiffness`.
    pub angle: Option<f64>,
    /// Stiffness that the two actuators give a joint at that angle, in N·m/rad; with `angle`.
    pub stiffness: Option<f64>,
    /// Amplitude in m of an oscillation: Coulomb friction is replaced by the viscous damping that takes as much from it.
    pub amplitude: Option<f64>,
    /// Keep the air mass as a state where it follows from the others; its pole is zero.
    pub all_states: bool,
}

/// A load as it can be given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Mass in kg.
    Mass(f64),
    /// Force in N.
    Force(f64),
}

impl Measure {
    /// A mass or a force as users write it, such as `10 lb` or `40 N`.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn read(text: &str) -> Result<Self, String> {
        let force = quantities::read(text, "mass or force", "N", "10 lb\" or \"40 N").map(Self::Force);
        force.or_else(|fault| quantities::read(text, "mass", "kg", "10 lb").map(Self::Mass).map_err(|_| fault))
    }
}

/// A linear model of an actuator on its load, with what is known about it.
struct Model {
    /// The name of the scenario file.
    name: String,
    linear: Linearization,
    /// All states, or those that are needed.
    system: StateSpace,
    poles: Vec<Pole>,
    /// What each input reaches.
    reach: Vec<Controllability>,
    /// Amplitude in m, and the angular frequency in rad/s at which Coulomb friction was replaced.
    oscillation: Option<(f64, f64)>,
    /// By how much later in s than each input its effect begins.
    delays: Vec<f64>,
    /// Numbers of the actuator that no source states.
    assumed: Vec<Assumed>,
}

impl Request {
    /// The first field that is given and has no meaning where only some are allowed.
    fn first_beyond(&self, allowed: &[&str]) -> Option<&'static str> {
        let fields = [
            ("gauge_pressure", self.gauge_pressure.is_some()),
            ("length", self.length.is_some()),
            ("load", self.load.is_some()),
            ("duty", self.duty.is_some()),
            ("pwm", self.pwm),
            ("angle", self.angle.is_some()),
            ("amplitude", self.amplitude.is_some()),
        ];
        fields.into_iter().find(|(name, given)| *given && !allowed.contains(name)).map(|(name, _)| name)
    }

    /// That what belongs together is given together.
    fn check(&self) -> Result<(), Failure> {
        let refused = |title: &str, help: &str| Err(Failure::input(title, help));
        match (self.duty, self.gauge_pressure, self.pwm, self.angle, self.stiffness) {
            (Some(_), Some(_), ..) => refused(
                "`duty` and `gauge_pressure` cannot both be given: the duty makes the pressure",
                "leave one of them out",
            ),
            (Some(_), _, true, ..) => {
                refused("`duty` and `pwm` cannot both be given: `pwm` finds the duty", "leave one of them out")
            }
            (.., Some(_), None) | (.., None, Some(_)) => refused(
                "`angle` and `stiffness` of a joint belong together: they give the two pressures",
                "give both or none of them",
            ),
            _ => Ok(()),
        }
    }
}

impl Model {
    fn new(name: &str, linear: Linearization, request: &Request, assumed: Vec<Assumed>) -> Result<Self, Failure> {
        let oscillation = match request.amplitude {
            Some(amplitude) => oscillations(&linear.plant, amplitude)?[0],
            None => None,
        };
        let linear = match oscillation {
            Some((amplitude, frequency)) => linear.with_equivalent_damping(amplitude, frequency)?,
            None => linear,
        };
        let system = if request.all_states { linear.system.clone() } else { linear.minimal() };
        let reach = (0..system.inputs.len()).map(|input| linear.controllability(&system, input));
        let reach = reach.collect::<Result<_, _>>()?;
        let delays = delays(&system, &linear.plant, &linear.inputs());
        let (name, poles) = (name.to_owned(), system.poles()?);
        Ok(Self { name, poles, system, reach, linear, oscillation, delays, assumed })
    }
}

/// Amplitude in m and angular frequency in rad/s of the oscillation of each actuator: in the mode in which it takes part most. An
/// actuator that takes part in none has none.
fn oscillations(linear: &PlantLinearization, amplitude: f64) -> Result<Vec<Option<(f64, f64)>>, Failure> {
    let count = linear.point.plant.actuators().len();
    let of = |actuator: usize| Ok(linear.oscillation(actuator)?.map(|frequency| (amplitude, frequency)));
    let all = (0..count).map(of).collect::<Result<Vec<_>, Failure>>()?;
    if all.iter().all(Option::is_none) {
        let title = "no load swings in the model, so no oscillation has an amplitude";
        return Err(Failure::input(title, "leave `amplitude` out"));
    }
    Ok(all)
}

/// By how much later in s than each input of a model its effect begins, of inputs in the order of the point's, with their names.
fn delays(system: &StateSpace, linear: &PlantLinearization, inputs: &[(Signal, f64)]) -> Vec<f64> {
    let of = |name: &str| {
        let place = inputs.iter().position(|(its, _)| its.name == name)?;
        linear.point.inputs.get(place).map(|(input, _)| linear.delay(input))
    };
    system.inputs.iter().map(|signal| of(&signal.name).unwrap_or(0.0)).collect()
}
