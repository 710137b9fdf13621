//! From what a file says of a plant to the core's plant and its start.

use super::control::{self, PlantControl};
use super::network::Builder;
use super::{Frame, MechanismNames, Member, Mount, PlantExperiment, PlantNames, PlantScenario};
use crate::diagnostic::{Class, Diagnostic, Diagnostics};
use crate::document::Document;
use crate::model::{core_air, core_motion};
use crate::scenario::InitialLength;
use mckibben::force::Statics;
use mckibben::load::{Load, MomentArm};
use mckibben::mechanism::{Arm, Attachment, Coupling, Mass, Mechanism, Pull};
use mckibben::plant::{
    Drawn, INITIAL_FRICTION_FORCE, InitialAir, InitialFriction, Mounted, Plant, PlantRun, PlantStart,
};
use mckibben::simulation::{Driven, Rig};
use mckibben::{Error, GaugePressure};

impl Document {
    pub(super) fn build_plant(&self, of: PlantScenario) -> Result<PlantExperiment, Diagnostics> {
        let mut names = PlantNames::default();
        let whole = |error: &Error| -> Diagnostics { self.diagnose(error).into() };
        of.run.check_counts().map_err(|error| whole(&error))?;
        let mut parts = Parts { mounted: Vec::new(), mechanisms: Vec::new(), start: PlantStart::default() };
        for Frame { name, mechanism, joints, positions, rates, .. } in &of.frames {
            parts.mechanisms.push(mechanism.clone());
            parts.start.positions.push(positions.clone());
            parts.start.rates.push(rates.clone());
            names.mechanisms.push(MechanismNames { name: Some(name.clone()), joints: joints.clone() });
        }
        let mut network =
            core_air(&of.air).and_then(|air| Builder::new(&of, &air, &mut names)).map_err(|error| whole(&error))?;
        for (index, member) in of.members.iter().enumerate() {
            let in_its_part = |error: &Error| -> Diagnostics {
                let diagnostic = self.of_actuator(&member.name).diagnose(error);
                diagnostic.help(format!("this is of the actuator `{}`", member.name)).into()
            };
            let drawn = parts.add(member, index, &of, &mut network).map_err(|error| in_its_part(&error))?;
            names.actuators.push(member.name.clone());
            names.valves.push(drawn.valve);
            names.hoses.push(drawn.into.filter(|_| member.alone.hose.is_some()));
            if matches!(member.mount, Mount::Own) {
                names.mechanisms.push(MechanismNames::default());
            }
        }
        let Parts { mounted, mechanisms, mut start } = parts;
        if start.friction.iter().all(|friction| *friction == InitialFriction::Relaxed) {
            start.friction.clear();
        }
        let plant = Plant::new(mounted, network.network, mechanisms).map_err(|error| whole(&error))?;
        let controls = self.controls(&of, &plant, &names)?;
        // What the start refuses is refused before anything is simulated.
        let drivers = controls.iter().map(PlantControl::driver).collect();
        PlantRun::with_drivers(&plant, &start, of.run.relative_tolerance, drivers)
            .map_err(|error| self.diagnose_start(&error, &of))?;
        Ok(PlantExperiment { plant, start, run: of.run, names, controls })
    }

    /// An error of the start, where the actuator that it is of says it.
    fn diagnose_start(&self, error: &Error, of: &PlantScenario) -> Diagnostics {
        let held = match error {
            Error::Inconsistent { parameter, value, .. } if parameter.key == INITIAL_FRICTION_FORCE.key => Some(*value),
            _ => None,
        };
        let is_its = |member: &&Member| match member.alone.initial.friction {
            InitialFriction::Held(force) => held == Some(force),
            _ => false,
        };
        match of.members.iter().find(is_its) {
            Some(member) => self.of_actuator(&member.name).diagnose(error).into(),
            None => self.diagnose(error).into(),
        }
    }

    /// The controllers of actuators, in their order, then those of joints.
    fn controls(
        &self,
        of: &PlantScenario,
        plant: &Plant,
        names: &PlantNames,
    ) -> Result<Vec<PlantControl>, Diagnostics> {
        let mut controls = Vec::new();
        for (index, member) in of.members.iter().enumerate() {
            let made = control::of_member(member, (index, names.valves[index]), plant, of.run.duration);
            controls.extend(made.map_err(|error| {
                let diagnostic = self.of_actuator(&member.name).diagnose(&error);
                diagnostic.help(format!("this is of the controller of `{}`", member.name))
            })?);
        }
        for (mechanism, frame) in of.frames.iter().enumerate() {
            for controller in &frame.controllers {
                let made = control::of_joint(of, (mechanism, controller), plant, &names.valves);
                controls.push(made.map_err(|error| {
                    let title = error.to_string();
                    Diagnostic::at(Class::Inconsistent, controller.place.clone(), title, "of this controller")
                })?);
            }
        }
        Ok(controls)
    }
}

/// The parts of a plant other than its network.
struct Parts {
    mounted: Vec<Mounted>,
    mechanisms: Vec<Mechanism>,
    start: PlantStart,
}

impl Parts {
    /// Adds an actuator; what it draws by.
    fn add(
        &mut self,
        member: &Member,
        index: usize,
        of: &PlantScenario,
        network: &mut Builder<'_>,
    ) -> Result<Drawn, Error> {
        // A controller's valve does nothing before the first sample.
        let alone = &member.alone.open_loop();
        let driven = alone.driven_by(member.output)?;
        if let Some(actuation) = &driven.actuation {
            actuation.check_counts(of.run.duration)?;
        }
        let air = *driven.actuator.air();
        let line = alone.core_line(&air)?;
        let line = mckibben::line::Line { supply: None, ..line };
        let (tendon, given) = (alone.core_tendon()?, alone.core_pressure()?);
        let of_hose = given.as_ref().filter(|_| line.hose.is_some());
        let drawn = network.draw(index, (&driven, of_hose), &line, alone, member.supply.as_deref())?;
        let pressure = given.clone().filter(|_| line.hose.is_none());
        let bare = driven.actuator.clone().without_valve();
        let mut initial = InitialAir {
            gauge_pressure: GaugePressure(alone.first_gauge_pressure()),
            temperature: alone.initial.temperature,
        };
        let (mechanism, coupling, length);
        match &member.mount {
            Mount::Own => {
                let Driven { actuator, actuation } = driven;
                let load = alone.core_load(actuator.law().law.end_length())?;
                let mut rig = Rig::new(actuator, actuation, load)?;
                if let Some(tendon) = tendon {
                    rig = rig.with_tendon(tendon);
                }
                if let Some(series) = given {
                    rig = rig.with_pressure(series)?;
                }
                let rig = rig.with_line(line)?;
                let state = rig.start(&alone.initial())?;
                let start = Plant::start_of_rig(&rig, &state);
                mechanism = self.mechanisms.len();
                coupling = Coupling::Direct { coordinate: 0 };
                self.mechanisms.push(match rig.load() {
                    Load::HangingMass { mass, gravity } => {
                        Mechanism::Mass(Mass::new(*mass, Pull::Gravity(*gravity), None)?)
                    }
                    Load::ConstantForce { mass, force } => {
                        Mechanism::Mass(Mass::new(*mass, Pull::Force(*force), None)?)
                    }
                    Load::Isometric => Mechanism::Fixed,
                    Load::Prescribed(motion) => Mechanism::Prescribed(motion.clone()),
                });
                self.start.positions.extend(start.positions);
                self.start.rates.extend(start.rates);
                initial = start.air[0];
                length = start.lengths[0];
            }
            mount => {
                (mechanism, coupling) = mounted_on(mount)?;
                let frame = &of.frames[mechanism];
                let end = bare.law().law.end_length();
                if let (Some(motion), None) = (&frame.motion, tendon) {
                    core_motion(motion, end)?;
                }
                length = match (tendon, alone.initial.length) {
                    (Some(_), InitialLength::At(length)) => Some(length),
                    (Some(tendon), _) => {
                        let distance = coupling.span(&frame.mechanism, &frame.positions);
                        let gauge =
                            pressure.as_ref().map_or(initial.gauge_pressure.0, |pressure| pressure.at(0.0, 0)[0]);
                        let pressure = GaugePressure(gauge).absolute(bare.air().atmosphere());
                        Some(tendon.balance(&bare, distance, pressure.0))
                    }
                    (None, _) => None,
                };
            }
        }
        self.mounted.push(Mounted { actuator: bare, mechanism, coupling, tendon, pressure });
        self.start.air.push(initial);
        self.start.lengths.push(length);
        self.start.friction.push(alone.initial.friction);
        Ok(drawn)
    }
}

fn mounted_on(mount: &Mount) -> Result<(usize, Coupling), Error> {
    match mount {
        Mount::Own => Ok((0, Coupling::Direct { coordinate: 0 })),
        Mount::Direct { mechanism } => Ok((*mechanism, Coupling::Direct { coordinate: 0 })),
        Mount::Arms { mechanism, rest_length, arms } => {
            let arms = arms.iter().map(|(joint, angle, arm)| {
                let back = arm.iter().any(|arm| *arm < 0.0);
                let sizes: Vec<f64> = arm.iter().map(|arm| arm.abs()).collect();
                let arm = match (angle.as_slice(), sizes.as_slice()) {
                    ([], [radius]) => MomentArm::pulley(*radius)?,
                    (angle, sizes) => MomentArm::table(angle, sizes)?,
                };
                Ok(Arm { joint: *joint, sign: if back { -1.0 } else { 1.0 }, arm })
            });
            Ok((*mechanism, Coupling::arms(*rest_length, arms.collect::<Result<_, Error>>()?)?))
        }
        Mount::Points { mechanism, ends } => {
            let ends = ends.map(|(segment, place)| Attachment { segment, place });
            Ok((*mechanism, Coupling::Points(ends)))
        }
    }
}
