//! What is run: one actuator with its load, or a joint that two turn against each other, behind one face.

use super::Observed;
use crate::adjustable::{Adjustable, Seeded};
use mckibben::parameter::Parameter;
use mckibben::plant::{JointPlant, JointReader, JointTrajectory, RigPlant, RigReader, RigTrajectory};
use mckibben::simulation::{Initial, JointInitial, JointRig, JointSample, Rig, Sample, State};
use mckibben::{Actuator, Error, Real};
use mckibben_scenario::Scenario;

/// What is called now and then with the time in s that a run has reached; its error, such as [`Error::Interrupted`], ends the
/// run.
pub type Watch<'a> = dyn Fn(f64) -> Result<(), Error> + Sync + 'a;

/// What a scenario describes, and its start.
pub(super) enum Plant<R: Real = f64> {
    /// One actuator with its load.
    Rig(Box<(Rig<R>, Initial<R>)>),
    /// Two that turn a joint.
    Joint(Box<(JointRig<R>, JointInitial<R>)>),
}

impl Plant {
    /// Of a scenario; the start has been checked.
    pub(super) fn of(scenario: &Scenario) -> Result<Self, Error> {
        if let (Some(experiment), Some(initial)) = (scenario.joint_experiment()?, scenario.joint_initial()) {
            return Ok(Self::Joint(Box::new((experiment.rig, initial))));
        }
        Ok(Self::Rig(Box::new((scenario.experiment()?.rig, scenario.initial()))))
    }

    /// The same over dual numbers, in the pass of the numbers that are looked for that begins with `first`.
    pub(super) fn seeded(&self, adjustable: &Adjustable, first: usize) -> Plant<Seeded> {
        let mut seeds = adjustable.seeds(first);
        self.over(|actuator, parameter, value| seeds.over_of(actuator, parameter, value))
    }

    /// The same over dual numbers; `seed` is told of which actuator of a joint a parameter is.
    pub(super) fn over(&self, mut seed: impl FnMut(Option<usize>, &'static Parameter, f64) -> Seeded) -> Plant<Seeded> {
        match self {
            Self::Rig(of) => {
                let mut seed = |parameter, value| seed(None, parameter, value);
                let rig = of.0.map(&mut seed);
                Plant::Rig(Box::new((rig, of.1.map(seed))))
            }
            Self::Joint(of) => {
                let rig = of.0.map_of_each(&mut seed);
                Plant::Joint(Box::new((rig, of.1.map_of_each(seed))))
            }
        }
    }
}

impl<R: Real> Plant<R> {
    /// Runs it for so many seconds; an error of `watch` ends it.
    pub(super) fn simulate(&self, duration: R, tolerance: f64, watch: &Watch<'_>) -> Result<Simulated<R>, Error> {
        match self {
            Self::Rig(of) => {
                let start = of.0.begin(&of.1)?;
                let run = RigPlant::new(&of.0).record(&start, (duration, tolerance), None, &mut |time| watch(time))?;
                Ok(Simulated::Rig(Box::new(run)))
            }
            Self::Joint(of) => {
                let start = of.0.begin(&of.1)?;
                let run =
                    JointPlant::new(&of.0)?.record(&start, (duration, tolerance), None, &mut |time| watch(time))?;
                Ok(Simulated::Joint(Box::new(run)))
            }
        }
    }

    /// The rig and its state at the start, of which segments are made.
    pub(super) fn rig(&self) -> Result<(&Rig<R>, State<R>), Error> {
        match self {
            Self::Rig(of) => Ok((&of.0, of.0.begin(&of.1)?)),
            Self::Joint(_) => Err(Error::NotImplemented(&mckibben::limit::SEGMENTS_JOINT)),
        }
    }
}

/// A simulated run.
#[derive(Clone, Debug)]
pub enum Simulated<R: Real = f64> {
    /// Of one actuator with its load.
    Rig(Box<RigTrajectory<R>>),
    /// Of two that turn a joint.
    Joint(Box<JointTrajectory<R>>),
}

impl<R: Real> Simulated<R> {
    /// End of the run in s.
    pub fn duration(&self) -> R {
        match self {
            Self::Rig(run) => run.duration(),
            Self::Joint(run) => run.duration(),
        }
    }

    /// A quantity in SI at a time in s; not a number where the run has none such. For many use a [`SimulatedReader`].
    pub fn read(&self, observed: Observed, time: R) -> R {
        SimulatedReader::new(self).read(observed, time)
    }
}

/// Reads quantities of a simulated run: quickest where the times do not fall from one to the next.
#[derive(Debug)]
pub struct SimulatedReader<'r, R: Real = f64> {
    of: ReaderOf<'r, R>,
}

/// A reader with what it reads, and the sample that was read last.
#[derive(Debug)]
enum ReaderOf<'r, R: Real> {
    Rig(&'r RigTrajectory<R>, RigReader<'r, R>, Option<Sample<R>>),
    Joint(&'r JointTrajectory<R>, JointReader<'r, R>, Option<JointSample<R>>),
}

impl<'r, R: Real> SimulatedReader<'r, R> {
    /// Reads a run.
    pub fn new(simulated: &'r Simulated<R>) -> Self {
        let of = match simulated {
            Simulated::Rig(run) => ReaderOf::Rig(run, RigReader::new(run), None),
            Simulated::Joint(run) => ReaderOf::Joint(run, JointReader::new(run), None),
        };
        Self { of }
    }

    /// A quantity in SI at a time in s; not a number where the run has none such.
    pub fn read(&mut self, observed: Observed, time: R) -> R {
        match &mut self.of {
            ReaderOf::Joint(run, reader, last) => {
                let same = last.filter(|sample| sample.time.value() == time.value());
                let sample = same.unwrap_or_else(|| reader.read(time));
                *last = Some(sample);
                let one = |i: usize| of_actuator(observed, &run.rig().driven()[i].actuator, &sample.actuators[i]);
                match observed {
                    Observed::Angle => sample.angle,
                    Observed::AngularVelocity => sample.angular_velocity,
                    Observed::Torque => sample.torque,
                    of if of.is_of_joint() => one(1),
                    _ => one(0),
                }
            }
            ReaderOf::Rig(run, reader, last) if !observed.is_of_joint() => {
                let same = last.filter(|sample| sample.time.value() == time.value());
                let sample = same.unwrap_or_else(|| reader.read(time));
                *last = Some(sample);
                of_actuator(observed, run.rig().actuator(), &sample)
            }
            ReaderOf::Rig(..) => R::constant(f64::NAN),
        }
    }
}

/// What one actuator has of a quantity.
fn of_actuator<R: Real>(observed: Observed, actuator: &Actuator<R>, sample: &Sample<R>) -> R {
    match observed {
        Observed::Length | Observed::AntagonistLength => sample.length,
        Observed::GaugePressure | Observed::AntagonistGaugePressure => {
            sample.pressure.0 - actuator.air().atmosphere().0
        }
        Observed::Tension | Observed::AntagonistTension => sample.tension,
        Observed::Angle | Observed::AngularVelocity | Observed::Torque => R::constant(f64::NAN),
    }
}
