//! What is run: a plant and its start, whatever described them, over any scalar.

use super::Observed;
use super::subject::{Subject, SubjectError};
use crate::adjustable::Seeded;
use mckibben::Error;
use mckibben::Instantiate;
use mckibben::parameter::{self, Parameter};
use mckibben::plant::{Plant, PlantReader, PlantRun, PlantSample, PlantStart, PlantTrajectory};
use mckibben::simulation::{Initial, JointInitial, JointRig, Rig, State};
use mckibben_scenario::{AdjustedPlant, Scenario, Seeds};

/// What is called now and then with the time in s that a run has reached; its error, such as [`Error::Interrupted`], ends the
/// run.
pub type Watch<'a> = dyn Fn(f64) -> Result<(), Error> + Sync + 'a;

/// What values of parameters describe, before derivatives are chosen.
pub(super) enum Built {
    /// One actuator with its load, and the scenario that it is of.
    Rig(Box<(Rig, Initial, Scenario)>),
    /// Two that turn a joint.
    Joint(Box<(JointRig, JointInitial, Scenario)>),
    /// A plant of named actuators.
    Plant(Box<AdjustedPlant>),
}

/// A plant and its start.
pub(super) struct Ready<R: Instantiate = f64> {
    pub(super) plant: Plant<R>,
    start: PlantStart<R>,
    /// The rig that the plant is, if it is one, and its state at the start.
    rig: Option<Box<(Rig<R>, State<R>)>>,
}

impl Built {
    /// Of a scenario; the start has been checked.
    pub(super) fn of(scenario: Scenario) -> Result<Self, Error> {
        if let (Some(experiment), Some(initial)) = (scenario.joint_experiment()?, scenario.joint_initial()) {
            return Ok(Self::Joint(Box::new((experiment.rig, initial, scenario))));
        }
        Ok(Self::Rig(Box::new((scenario.experiment()?.rig, scenario.initial(), scenario))))
    }

    /// Without derivatives.
    pub(super) fn ready(&self) -> Result<Ready, Error> {
        match self {
            Self::Rig(of) => Ready::of_rig(of.0.clone(), &of.1),
            Self::Joint(of) => Ready::of_joint(&of.0, &of.1),
            Self::Plant(of) => {
                let of = of.experiment();
                Ok(Ready { plant: of.plant.clone(), start: of.start.clone(), rig: None })
            }
        }
    }

    /// Over dual numbers, in the pass of the parameters of a run that begins with `first`.
    pub(super) fn seeded(&self, subject: &Subject, first: usize) -> Result<Ready<Seeded>, SubjectError> {
        match (self, subject) {
            (Self::Plant(of), _) => {
                let (plant, start) = of.seeded(first)?;
                Ok(Ready { plant, start, rig: None })
            }
            (Self::Rig(of), Subject::Scenario(adjustable)) => self.by(adjustable.seeds_at(first, &of.2)),
            (Self::Joint(of), Subject::Scenario(adjustable)) => self.by(adjustable.seeds_at(first, &of.2)),
            // Not reached: what a plant's file describes is a plant. Said rather than assumed.
            (_, Subject::Plant(_)) => Err(Error::NotImplemented(&mckibben::limit::PLANT_HERE).into()),
        }
    }

    fn by(&self, mut seeds: Seeds) -> Result<Ready<Seeded>, SubjectError> {
        Ok(self.over(|actuator, parameter, value| seeds.over_of(actuator, parameter, value))?)
    }

    /// One actuator or a joint over dual numbers; `seed` receives the actuator of a joint that a parameter belongs to.
    pub(super) fn over(
        &self,
        mut seed: impl FnMut(Option<usize>, &'static Parameter, f64) -> Seeded,
    ) -> Result<Ready<Seeded>, Error> {
        match self {
            Self::Rig(of) => {
                let mut seed = |parameter, value| seed(None, parameter, value);
                let rig = of.0.map(&mut seed);
                Ready::of_rig(rig, &of.1.map(seed))
            }
            Self::Joint(of) => {
                let rig = of.0.map_of_each(&mut seed);
                Ready::of_joint(&rig, &of.1.map_of_each(seed))
            }
            Self::Plant(_) => Err(Error::NotImplemented(&mckibben::limit::PLANT_HERE)),
        }
    }
}

impl<R: Instantiate> Ready<R> {
    fn of_rig(rig: Rig<R>, initial: &Initial<R>) -> Result<Self, Error> {
        let state = rig.begin(initial)?;
        let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &state));
        Ok(Self { plant, start, rig: Some(Box::new((rig, state))) })
    }

    fn of_joint(rig: &JointRig<R>, initial: &JointInitial<R>) -> Result<Self, Error> {
        let state = rig.begin(initial)?;
        Ok(Self { plant: Plant::of_joint(rig)?, start: Plant::start_of_joint(rig, &state), rig: None })
    }

    /// Runs it for so many seconds; an error of `watch` ends it.
    pub(super) fn simulate(&self, duration: R, tolerance: f64, watch: &Watch<'_>) -> Result<Simulated<R>, Error> {
        parameter::DURATION.check(duration.value())?;
        self.plant.check_counts(duration.value())?;
        let mut run = PlantRun::new(&self.plant, &self.start, tolerance)?;
        Ok(Simulated { trajectory: run.record_to(duration, &mut |time| watch(time))? })
    }

    /// The rig and its state at the start, of which segments are made.
    pub(super) fn rig(&self) -> Result<(&Rig<R>, State<R>), Error> {
        match &self.rig {
            Some(of) => Ok((&of.0, of.1)),
            None => Err(Error::NotImplemented(&mckibben::limit::SEGMENTS_JOINT)),
        }
    }
}

/// A simulated run.
#[derive(Clone, Debug)]
pub struct Simulated<R: Instantiate = f64> {
    pub(super) trajectory: PlantTrajectory<R>,
}

impl<R: Instantiate> Simulated<R> {
    /// End of the run in s.
    pub fn duration(&self) -> R {
        self.trajectory.duration()
    }

    /// A quantity in SI at a time in s; not a number where the run has none such. For many use a [`SimulatedReader`].
    pub fn read(&self, observed: &Observed, time: R) -> R {
        SimulatedReader::new(self).read(observed, time)
    }
}

/// Reads quantities of a simulated run: quickest where the times do not fall from one to the next.
#[derive(Debug)]
pub struct SimulatedReader<'r, R: Instantiate = f64> {
    plant: &'r Plant<R>,
    reader: PlantReader<'r, R>,
    sample: PlantSample<R>,
    /// The time in s of the sample, once one was read.
    time: Option<f64>,
}

impl<'r, R: Instantiate> SimulatedReader<'r, R> {
    /// Reads a run.
    pub fn new(simulated: &'r Simulated<R>) -> Self {
        let plant = simulated.trajectory.plant();
        let (reader, sample) = (PlantReader::new(&simulated.trajectory), PlantSample::new(plant));
        Self { plant, reader, sample, time: None }
    }

    /// A quantity in SI at a time in s; not a number where the run has none such.
    pub fn read(&mut self, observed: &Observed, time: R) -> R {
        let Some((quantity, gauge)) = observed.place(self.plant) else { return R::constant(f64::NAN) };
        let value = match quantity.state(self.plant) {
            Some(place) => self.reader.state_at(time)[place],
            None => {
                if self.time != Some(time.value()) {
                    self.reader.read_into(time, &mut self.sample);
                    self.time = Some(time.value());
                }
                quantity.of(self.plant, &self.sample)
            }
        };
        if gauge { value - self.plant.network().atmosphere } else { value }
    }
}
