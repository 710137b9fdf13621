//! Joints that two actuators turn against each other.

use super::alone::Kind;
use super::numbers::Numbers;
use mckibben::Error;
use mckibben::control::Drive;
use mckibben::simulation::{JointCourse, JointState, JointStepper, Method};
use mckibben_cli::failure::Failure;

const COLUMNS: &[&str] = &[
    "angle_rad",
    "angular_velocity_rad_s",
    "pressure_pa",
    "air_mass_kg",
    "antagonist_pressure_pa",
    "antagonist_air_mass_kg",
];

/// Joints of a scenario.
pub(super) struct Joints {
    pub(super) numbers: Numbers,
    pub(super) method: Method,
    /// In Hz.
    pub(super) pulse_frequency: f64,
}

impl Kind<2> for Joints {
    type Plant = (JointStepper, JointCourse);

    fn columns(&self) -> Vec<String> {
        COLUMNS.iter().map(|name| (*name).to_owned()).collect()
    }

    fn begin(&self, values: &[f64]) -> Result<Self::Plant, Failure> {
        self.numbers.with(values, |scenario| {
            let experiment = scenario.joint_experiment()?.ok_or(Error::Misuse {
                what: "the load is no antagonistic joint",
                remedy: "set load.kind = \"antagonistic-joint\"",
            })?;
            let stepper = JointStepper::driven(experiment.rig, self.method, self.pulse_frequency)?;
            let course = stepper.begin(experiment.start);
            Ok((stepper, course))
        })
    }

    fn drive((stepper, course): &mut Self::Plant, drives: [Drive; 2]) -> Result<(), Error> {
        stepper.drive(course, drives)
    }

    fn advance_to((stepper, course): &mut Self::Plant, until: f64) -> Result<(), Error> {
        stepper.advance_to(course, until)
    }

    fn show((_, course): &Self::Plant, into: &mut [f64]) {
        let JointState { angle, angular_velocity, pressure, air_mass } = course.state();
        let [of, other] = pressure.map(|pressure| pressure.0);
        into.copy_from_slice(&[angle, angular_velocity, of, air_mass[0], other, air_mass[1]]);
    }
}
