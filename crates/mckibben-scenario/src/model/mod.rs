//! From what a file says to what the core simulates: the same numbers, in the core's types. No physics here.

mod parts;

pub(crate) use parts::{core_actuation, core_air, core_hose, core_motion, core_supply_line, core_valve};

use crate::choice::{BladderForm, Engine, Method};
use crate::diagnostic::Diagnostics;
use crate::document::Document;
use crate::scenario::{
    self, Antagonist, Effectiveness, Force, InitialAngle, InitialLength, Joint, Load, PressureSensor, Run, Scenario,
};
use mckibben::command::Driver;
use mckibben::force::{self, Characteristic, Effective, LengthLimits, Statics};
use mckibben::line::{self, Line};
use mckibben::parameter as p;
use mckibben::plant::{JointPlant, Plant, PlantStart, PlantStepError, RigPlant, TimeStepping, plant_step_for_accuracy};
use mckibben::simulation::{
    self, Driven, Fittings, Initial, JointInitial, JointRig, JointState, JointSupply, PressureSeries, Rig, State,
};
use mckibben::{Actuator, Braid, Error, GaugePressure, air, load};

use parts::{core_friction, core_joint};

/// A scenario ready to run.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// The actuator, what drives its valve, and its load.
    pub rig: Rig,
    /// The state at the start.
    pub start: State,
    /// How long to simulate and what to record.
    pub run: Run,
}

impl Experiment {
    /// The method of the fixed-step engine, as the core names it.
    pub fn method(&self) -> simulation::Method {
        self.run.core_method()
    }

    /// The step of the fixed-step engine in s: the one that is given, whatever the accuracy; else the longest that the accuracy
    /// allows, with its error.
    ///
    /// # Errors
    /// As [`plant_step_for_accuracy`], when no step is given.
    pub fn step(&self) -> Result<(f64, Option<PlantStepError>), Error> {
        let of = RigPlant::new(&self.rig);
        self.run.step_of((of.plant(), &of.start(&self.start)), &Vec::new)
    }

    /// How it goes through time. A fixed step that no one gives is the longest that the accuracy allows, with its error.
    ///
    /// # Errors
    /// As [`plant_step_for_accuracy`], when a step is chosen.
    pub fn stepping(&self) -> Result<(TimeStepping, Option<PlantStepError>), Error> {
        let of = RigPlant::new(&self.rig);
        self.run.stepping_of((of.plant(), &of.start(&self.start)), &Vec::new)
    }
}

impl Document {
    /// Reads the scenario and builds what it describes.
    ///
    /// # Errors
    /// Every mistake in the file; then, if there is none, the first contradiction that the model finds, with its place
    /// in the file.
    pub fn experiment(&self) -> Result<Experiment, Diagnostics> {
        let scenario = self.scenario()?;
        scenario.experiment().map_err(|error| self.diagnose(&error).into())
    }
}

/// A scenario with a joint ready to run.
#[derive(Clone, Debug, PartialEq)]
pub struct JointExperiment {
    /// The joint with its two actuators.
    pub rig: JointRig,
    /// The state at the start.
    pub start: JointState,
    /// How long to simulate and what to record.
    pub run: Run,
}

impl JointExperiment {
    /// The method of the fixed-step engine, as the core names it.
    pub fn method(&self) -> simulation::Method {
        self.run.core_method()
    }

    /// The step of the fixed-step engine in s: the one that is given, whatever the accuracy; else the longest that the accuracy
    /// allows, with its error.
    ///
    /// # Errors
    /// As [`plant_step_for_accuracy`], when no step is given.
    pub fn step(&self) -> Result<(f64, Option<PlantStepError>), Error> {
        let of = JointPlant::new(&self.rig)?;
        self.run.step_of((of.plant(), &of.start(&self.start)), &Vec::new)
    }

    /// How it goes through time. A fixed step that no one gives is the longest that the accuracy allows, with its error.
    ///
    /// # Errors
    /// As [`plant_step_for_accuracy`], when a step is chosen.
    pub fn stepping(&self) -> Result<(TimeStepping, Option<PlantStepError>), Error> {
        let of = JointPlant::new(&self.rig)?;
        self.run.stepping_of((of.plant(), &of.start(&self.start)), &Vec::new)
    }
}

impl Document {
    /// Reads the scenario and builds the joint that it describes, or `None` when its load is another.
    ///
    /// # Errors
    /// Every mistake in the file; then, if there is none, the first contradiction that the model finds, with its place
    /// in the file.
    pub fn joint_experiment(&self) -> Result<Option<JointExperiment>, Diagnostics> {
        self.joint_of(&self.scenario()?)
    }

    /// The joint that a scenario describes, which is that of this document or one made of it; `None` when its load is another.
    ///
    /// # Errors
    /// The first contradiction that the model finds, with its place in the file.
    pub fn joint_of(&self, scenario: &Scenario) -> Result<Option<JointExperiment>, Diagnostics> {
        scenario.joint().map_err(|(of, error)| match of {
            Part::Joint => self.diagnose(&error).into(),
            Part::Antagonist => self.antagonist().diagnose(&error).into(),
        })
    }
}

/// What of a joint contradicts itself.
enum Part {
    /// The joint, or its agonist.
    Joint,
    /// The second actuator.
    Antagonist,
}

impl Scenario {
    /// Builds the joint that the scenario describes, or `None` when its load is another.
    ///
    /// # Errors
    /// As [`Scenario::experiment`].
    pub fn joint_experiment(&self) -> Result<Option<JointExperiment>, Error> {
        self.joint().map_err(|(_, error)| error)
    }

    fn joint(&self) -> Result<Option<JointExperiment>, (Part, Error)> {
        let (Load::AntagonisticJoint(joint), Some(second)) = (&self.load, self.of_antagonist()) else {
            return Ok(None);
        };
        let failed = |error: Error| (Part::Joint, error);
        let agonist = self.driven().map_err(failed)?;
        let output = opposite_output(self, &second).map_err(failed)?;
        let antagonist = second.driven_by(output).map_err(|error| (Part::Antagonist, error))?;
        let its = self.fittings(agonist.actuator.air()).map_err(failed)?;
        let others = second.fittings(antagonist.actuator.air()).map_err(|error| (Part::Antagonist, error))?;
        let rig = core_joint(joint)
            .and_then(|joint| {
                let (fittings, supply) = self.shared([its, others]);
                JointRig::fitted([agonist, antagonist], joint, fittings, supply)
            })
            .map_err(failed)?;
        self.run.check_counts().map_err(failed)?;
        for (part, driven) in [Part::Joint, Part::Antagonist].into_iter().zip(rig.driven()) {
            let counts = driven.actuation.as_ref().map_or(Ok(()), |of| of.check_counts(self.run.duration));
            counts.map_err(|error| (part, error))?;
        }
        let start = rig.start(&self.start_of(joint)).map_err(failed)?;
        Ok(Some(JointExperiment { rig, start, run: self.run }))
    }

    /// What the actuator of a joint has in addition to its valve.
    fn fittings(&self, air: &air::Air) -> Result<Fittings, Error> {
        Ok(Fittings { line: self.core_line(air)?, tendon: self.core_tendon()?, pressure: self.core_pressure()? })
    }

    /// What both actuators of a joint have, the supply at the one that it is of.
    fn shared(&self, [mut its, mut others]: [Fittings; 2]) -> ([Fittings; 2], JointSupply) {
        if !self.shares_supply() {
            return ([its, others], JointSupply::Separate);
        }
        let antagonists = others.line.supply.take();
        its.line.supply = its.line.supply.or(antagonists);
        ([its, others], JointSupply::Shared)
    }

    /// The start of its joint as the core takes it, or `None` when its load is another.
    pub fn joint_initial(&self) -> Option<JointInitial> {
        match &self.load {
            Load::AntagonisticJoint(joint) => Some(self.start_of(joint)),
            _ => None,
        }
    }

    fn start_of(&self, joint: &Joint) -> JointInitial {
        let (first, second) = (&self.initial, &joint.antagonist);
        let second_pressure = first_gauge_pressure(second.gauge_pressure, second.pressure.as_ref());
        JointInitial {
            gauge_pressure: [self.first_gauge_pressure(), second_pressure].map(GaugePressure),
            temperature: [first.temperature, second.temperature],
            angle: match joint.angle {
                InitialAngle::Equilibrium => simulation::InitialAngle::Equilibrium,
                InitialAngle::At(angle) => simulation::InitialAngle::At(angle),
            },
            angular_velocity: joint.angular_velocity,
        }
    }
}

/// The output of the second actuator's valve that drives it: B where both hang on one five-way valve.
fn opposite_output(first: &Scenario, second: &Scenario) -> Result<usize, Error> {
    let two = |scenario: &Scenario| scenario.valve.is_some_and(|valve| valve.kind.has_two_outputs());
    if !(two(first) && two(second)) {
        return Ok(0);
    }
    let kind = |scenario: &Scenario| scenario.valve.map(|valve| valve.kind);
    if kind(first) != kind(second) || first.command != second.command {
        return Err(Error::Misuse {
            what: "one five-way valve drives both actuators of a joint, and the antagonist is given another valve",
            remedy: "remove the kind from [antagonist.valve] and the section [antagonist.command], or give the antagonist a \
                     valve of another kind",
        });
    }
    Ok(1)
}

impl Run {
    /// The method of the fixed-step engine, as the core names it.
    pub fn core_method(&self) -> simulation::Method {
        match self.method {
            Method::Stable => simulation::Method::Stable,
            Method::Rk4 => simulation::Method::Rk4,
        }
    }

    /// How it goes through time; a fixed step that is to be chosen stands at the sample interval.
    pub fn stepping(&self) -> TimeStepping {
        match self.engine {
            Engine::EventLocated => self.relative_tolerance.into(),
            Engine::FixedStep => self.fixed(self.step.unwrap_or(self.sample_interval)),
        }
    }

    /// Fixed steps that divide the sample interval into the least number of equal parts not longer than `step` s.
    pub fn fixed(&self, step: f64) -> TimeStepping {
        let parts = simulation::steps_between(0.0, self.sample_interval, step);
        TimeStepping::Fixed { method: self.core_method(), step: self.sample_interval / parts as f64 }
    }

    /// The step in s of a run of a plant: the one that is given, or the longest that the accuracy allows, with its error.
    /// `drivers` makes the drivers again.
    pub(crate) fn step_of(
        &self,
        of: (&Plant, &PlantStart),
        drivers: &dyn Fn() -> Vec<Driver>,
    ) -> Result<(f64, Option<PlantStepError>), Error> {
        if let Some(step) = self.step {
            return Ok((step, None));
        }
        let times = (self.duration, self.sample_interval);
        let chosen = plant_step_for_accuracy(of, drivers, times, self.core_method(), self.accuracy)?;
        Ok((chosen.step, Some(chosen)))
    }

    /// How a run of a plant goes through time; see [`Run::step_of`].
    pub(crate) fn stepping_of(
        &self,
        of: (&Plant, &PlantStart),
        drivers: &dyn Fn() -> Vec<Driver>,
    ) -> Result<(TimeStepping, Option<PlantStepError>), Error> {
        if self.engine == Engine::EventLocated {
            return Ok((self.stepping(), None));
        }
        let (step, chosen) = self.step_of(of, drivers)?;
        Ok((self.fixed(step), chosen))
    }

    /// That the run has no more samples and steps than [`MAX_COUNT`](mckibben::parameter::MAX_COUNT).
    ///
    /// # Errors
    /// [`Error::TooMany`] otherwise.
    pub fn check_counts(&self) -> Result<(), Error> {
        let interval = self.sample_interval;
        p::SAMPLE_INTERVAL.check_count(interval, self.duration / interval, "samples")?;
        if let Some(step) = self.step.filter(|_| self.engine == Engine::FixedStep) {
            p::STEP.check_count(step, self.duration / step, "steps")?;
        }
        Ok(())
    }
}

impl Scenario {
    /// Builds what the scenario describes.
    ///
    /// # Errors
    /// What the core finds contradictory, such as a length above the thread length; [`Error::TooMany`] for more samples, steps
    /// or pulses than a run may have.
    pub fn experiment(&self) -> Result<Experiment, Error> {
        let rig = self.rig()?;
        self.run.check_counts()?;
        rig.check_counts(self.run.duration)?;
        let start = rig.start(&self.initial())?;
        Ok(Experiment { rig, start, run: self.run })
    }

    /// The actuator, what drives its valve, and its load.
    ///
    /// # Errors
    /// As [`Scenario::experiment`].
    pub fn rig(&self) -> Result<Rig, Error> {
        if matches!(self.load, Load::AntagonisticJoint(_)) {
            return Err(Error::NotImplemented(&mckibben::limit::JOINT_ALONE));
        }
        let Driven { actuator, actuation } = self.driven()?;
        let line = self.core_line(actuator.air())?;
        let load = self.core_load(actuator.law().law.end_length())?;
        let rig = Rig::new(actuator, actuation, load)?;
        let rig = match self.core_tendon()? {
            Some(tendon) => rig.with_tendon(tendon),
            None => rig,
        };
        let rig = match self.core_pressure()? {
            Some(series) => rig.with_pressure(series)?,
            None => rig,
        };
        rig.with_line(line)
    }

    /// The elastic tendon in series, if there is one.
    pub(crate) fn core_tendon(&self) -> Result<Option<load::SeriesTendon>, Error> {
        self.tendon.map(|of| load::SeriesTendon::new(of.stiffness, of.rest_length)).transpose()
    }

    /// Gauge pressure in the actuator at the start in Pa.
    pub fn first_gauge_pressure(&self) -> f64 {
        first_gauge_pressure(self.initial.gauge_pressure, self.pressure.as_ref())
    }

    /// The pressure over time, where it is given.
    pub(crate) fn core_pressure(&self) -> Result<Option<PressureSeries>, Error> {
        let Some(series) = &self.pressure else { return Ok(None) };
        let PressureSensor { offset, scale, shift } = series.sensor;
        PressureSeries::new(&series.time, &series.gauge_pressure)?.with_sensor(offset, scale, shift).map(Some)
    }

    /// The air line: hose, leak, reservoir and regulator, as far as there are such.
    pub(crate) fn core_line(&self, air: &air::Air) -> Result<Line, Error> {
        let room = mckibben::parameter::SUPPLY_TEMPERATURE.default.unwrap_or_default();
        let temperature = self.supply.map_or(room, |supply| supply.temperature);
        let hose = self.hose.map(|hose| core_hose(&hose, temperature, air));
        let supply = self.supply.filter(|_| self.valve.is_some()).map(|supply| core_supply_line(&supply, air));
        Ok(Line {
            hose: hose.transpose()?,
            leakage: self.actuator.leakage.map(line::Leakage::new).transpose()?,
            supply: supply.transpose()?.flatten(),
        })
    }

    /// The actuator and what drives its valve; of a joint the agonist.
    ///
    /// # Errors
    /// As [`Scenario::experiment`].
    pub fn driven(&self) -> Result<Driven, Error> {
        self.driven_by(0)
    }

    /// The actuator as driven by one output of the valve, 0 or 1: only a five-way valve has the second.
    pub(crate) fn driven_by(&self, output: usize) -> Result<Driven, Error> {
        let air = core_air(&self.air)?;
        let mut actuator = self.core_actuator(air)?;
        let mut actuation = None;
        if let (Some(valve), Some(supply), Some(command)) = (&self.valve, &self.supply, &self.command) {
            actuator = actuator.with_valve(core_valve(valve, supply, &air)?);
            actuation = Some(core_actuation(valve, command, output)?);
        }
        Ok(Driven { actuator, actuation })
    }

    /// The scenario with the second actuator of its joint in place of the first, or `None` when it has no joint.
    pub fn of_antagonist(&self) -> Option<Self> {
        let Load::AntagonisticJoint(joint) = &self.load else { return None };
        let Antagonist { gauge_pressure, temperature, .. } = &*joint.antagonist;
        let initial = scenario::Initial { gauge_pressure: *gauge_pressure, temperature: *temperature, ..self.initial };
        let Antagonist { actuator, supply, valve, hose, command, pressure, series_tendon, .. } =
            (*joint.antagonist).clone();
        Some(Self {
            actuator,
            supply,
            valve,
            hose,
            command,
            pressure,
            tendon: series_tendon,
            air: self.air,
            load: self.load.clone(),
            initial,
            run: self.run,
        })
    }

    fn core_actuator(&self, air: air::Air) -> Result<Actuator, Error> {
        let actuator = &self.actuator;
        let braid = Braid::new(actuator.thread_length, actuator.turns)?;
        let limits = LengthLimits::new(
            &braid,
            Some(actuator.min_length),
            actuator.max_length,
            actuator.limit.stiffness,
            actuator.limit.damping,
        )?;
        let effectiveness = match &actuator.effectiveness {
            Effectiveness::Constant(ratio) => force::Effectiveness::constant(*ratio)?,
            Effectiveness::Polynomial(coefficients) => force::Effectiveness::polynomial(coefficients)?,
            Effectiveness::Table { gauge_pressure, value } => force::Effectiveness::table(gauge_pressure, value)?,
        };
        let friction = core_friction(&actuator.friction)?;
        let law = Effective { law: self.core_characteristic(braid)?, effectiveness };
        Actuator::new(law, limits, friction, actuator.external_volume, air)
    }

    fn core_characteristic(&self, braid: Braid) -> Result<Characteristic, Error> {
        let actuator = &self.actuator;
        let longest = actuator.max_length;
        let law = match &actuator.force {
            Force::IdealBraid => force::Law::IdealBraid,
            Force::TonduLopez { end_factor, end_factor_rise, end_factor_pressure, coefficients } => {
                let end_factor = force::EndFactor::falling(*end_factor, *end_factor_rise, *end_factor_pressure)?;
                let given = coefficients.map(|of| force::Coefficients { radius: of.radius, a: of.a, b: of.b });
                force::Law::TonduLopez(force::TonduLopez::new(&braid, longest, end_factor, given)?)
            }
            Force::Map { gauge_pressure, length, tension } => {
                force::Law::Map(force::ForceMap::new(gauge_pressure, length, tension)?)
            }
            Force::MartensBoblan { membrane_thickness, modulus } => {
                force::Law::MartensBoblan(force::MartensBoblan::new(&braid, longest, *membrane_thickness, *modulus)?)
            }
            Force::ExtensibleBraid { thread_stiffness } => {
                force::Law::ExtensibleBraid(force::ExtensibleBraid::new(braid, *thread_stiffness)?)
            }
            Force::Bolen { max_force, max_pressure, max_contraction, shape } => {
                force::Law::Bolen(force::Bolen::new(longest, *max_force, *max_pressure, *max_contraction, *shape)?)
            }
            Force::Polynomial { pressure, passive } => {
                force::Law::Polynomial(force::Polynomial::new(longest, pressure, passive)?)
            }
            Force::Sarosi(coefficients) => force::Law::Sarosi(force::Sarosi::new(longest, *coefficients)?),
        };
        let mut characteristic = Characteristic::new(braid, law).with_wall(actuator.wall_thickness, longest)?;
        if let Some(taper) = actuator.taper {
            let lengths = [actuator.min_length, longest];
            characteristic = characteristic.with_taper(taper.end_radius, taper.length_ratio, lengths)?;
        }
        let Some(bladder) = actuator.bladder else { return Ok(characteristic) };
        let form = match bladder.form {
            BladderForm::Linear => force::BladderForm::Linear,
            BladderForm::Saturating => force::BladderForm::Saturating,
            BladderForm::Exponential => force::BladderForm::Exponential,
        };
        Ok(characteristic.with_bladder(force::Bladder::new(form, longest, bladder.force, bladder.scale)?))
    }

    pub(crate) fn core_load(&self, end_length: f64) -> Result<load::Load, Error> {
        match &self.load {
            Load::HangingMass { mass, gravity } => load::Load::hanging_mass(*mass, *gravity),
            Load::ConstantForce { force, mass } => load::Load::constant_force(*mass, *force),
            // A joint is no load of one actuator: `rig` has refused it.
            Load::Isometric | Load::AntagonisticJoint(_) => Ok(load::Load::Isometric),
            Load::PrescribedMotion(motion) => {
                // A tendon takes whatever the actuator cannot follow.
                let end = if self.tendon.is_some() { f64::MAX } else { end_length };
                core_motion(motion, end).map(load::Load::Prescribed)
            }
        }
    }

    /// The start as the core takes it.
    pub fn initial(&self) -> Initial {
        Initial {
            gauge_pressure: GaugePressure(self.first_gauge_pressure()),
            temperature: self.initial.temperature,
            length: match self.initial.length {
                InitialLength::At(length) => simulation::InitialLength::At(length),
                InitialLength::Equilibrium | InitialLength::OfMotion | InitialLength::OfJoint => {
                    simulation::InitialLength::Equilibrium
                }
            },
            velocity: self.initial.velocity,
        }
    }
}

/// The gauge pressure in Pa that an actuator starts at: its own, else that of t = 0 where it is given.
fn first_gauge_pressure(own: Option<f64>, given: Option<&scenario::PressureSeries>) -> f64 {
    own.or_else(|| Some(given?.start())).unwrap_or_default()
}
