//! From what a file says of a plant to the core's plant and its start.

use super::control::{self, PlantControl, Unfit};
use super::network::Builder;
use super::parts::SUPPLY;
use super::{Frame, JointController, MechanismNames, Member, Mount, PlantExperiment, PlantNames, PlantScenario, Store};
use crate::diagnostic::{Class, Diagnostic, Diagnostics};
use crate::document::Document;
use crate::keys;
use crate::model::{core_air, core_motion};
use crate::scenario::InitialLength;
use mckibben::force::Statics;
use mckibben::load::{Load, MomentArm};
use mckibben::mechanism::{Arm, Attachment, Coupling, Mass, Mechanism, Pull};
use mckibben::network::Network;
use mckibben::plant::{Drawn, InitialAir, InitialFriction, Mounted, Plant, PlantRun, PlantStart};
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
        let air = core_air(&of.air).map_err(|error| whole(&error))?;
        let (mut network, refused) = Builder::new(&of, &air, &mut names);
        let mut found = Found::default();
        for (index, error) in &refused {
            let store = &of.stores[*index];
            match self.diagnose_store(error, store) {
                diagnostic if store.name == SUPPLY => found.alone.push(diagnostic),
                diagnostic => found.add(diagnostic, "the supply", &store.name),
            }
        }
        // The first contradiction of each actuator, since the others do not depend on it.
        for (index, member) in of.members.iter().enumerate() {
            let drawn = match parts.add(member, index, &of, &mut network) {
                Ok(drawn) => drawn,
                Err(error) => {
                    found.add(self.of_actuator(&member.name).diagnose(&error), "the actuator", &member.name);
                    continue;
                }
            };
            names.actuators.push(member.name.clone());
            names.valves.push(drawn.valve);
            names.hoses.push(drawn.into.filter(|_| member.alone.hose.is_some()));
            if matches!(member.mount, Mount::Own) {
                names.mechanisms.push(MechanismNames::default());
            }
        }
        found.check()?;
        let Parts { mounted, mechanisms, mut start } = parts;
        if start.friction.iter().all(|friction| *friction == InitialFriction::Relaxed) {
            start.friction.clear();
        }
        let plant = Plant::new(mounted, network.network, mechanisms).map_err(|error| whole(&error))?;
        let controls = self.controls(&of, &plant, &names)?;
        // What the start refuses is refused before anything is simulated.
        let drivers = controls.iter().map(PlantControl::driver).collect();
        PlantRun::with_drivers(&plant, &start, of.run.relative_tolerance, drivers)
            .map_err(|error| self.diagnose_start(&error, (&plant, &start), &of))?;
        Ok(PlantExperiment { plant, start, run: of.run, names, controls })
    }

    /// An error of a supply, where the file states it.
    fn diagnose_store(&self, error: &Error, store: &Store) -> Diagnostic {
        match store.name.strip_suffix(".supply") {
            Some(actuator) => self.of_actuator(actuator).diagnose(error),
            None => {
                let found = self.of_supply(&store.name).diagnose(error);
                if store.name == SUPPLY { found } else { found.of_supply(&store.name) }
            }
        }
    }

    /// An error of the start, with the actuator whose start alone gives it.
    fn diagnose_start(&self, error: &Error, (plant, start): (&Plant, &PlantStart), of: &PlantScenario) -> Diagnostics {
        let is_its =
            |index: &usize| start_alone(plant, start, *index, of.run.relative_tolerance).as_ref() == Some(error);
        let index = (0..plant.actuators().len()).find(is_its);
        let Some(member) = index.and_then(|index| of.members.get(index)) else { return self.diagnose(error).into() };
        let diagnostic = self.of_actuator(&member.name).diagnose(error);
        diagnostic.help(format!("this is of the actuator `{}`", member.name)).into()
    }

    /// The controllers of actuators, in their order, then those of joints.
    fn controls(
        &self,
        of: &PlantScenario,
        plant: &Plant,
        names: &PlantNames,
    ) -> Result<Vec<PlantControl>, Diagnostics> {
        let mut controls = Vec::new();
        let mut found = Found::default();
        for (index, member) in of.members.iter().enumerate() {
            match control::of_member(member, (index, names.valves[index]), plant, of.run.duration) {
                Ok(made) => controls.extend(made),
                Err(error) => {
                    found.add(self.of_actuator(&member.name).diagnose(&error), "the controller of", &member.name);
                }
            }
        }
        for (mechanism, frame) in of.frames.iter().enumerate() {
            for controller in &frame.controllers {
                let unfit = self.unfit_roles(of, (mechanism, controller), plant);
                if !unfit.is_empty() {
                    found.alone.extend(unfit);
                    continue;
                }
                match control::of_joint(of, (mechanism, controller), plant, &names.valves) {
                    Ok(made) => controls.push(made),
                    Err(error) => found.alone.push(Diagnostic::at(
                        Class::Inconsistent,
                        controller.place.clone(),
                        error.to_string(),
                        "of this controller",
                    )),
                }
            }
        }
        found.check()?;
        Ok(controls)
    }

    /// The actuators of a joint's controller that do not turn the joint the way that their roles say.
    fn unfit_roles(
        &self,
        of: &PlantScenario,
        (mechanism, controller): (usize, &JointController),
        plant: &Plant,
    ) -> Vec<Diagnostic> {
        let frame = &of.frames[mechanism];
        let joint = &frame.joints[controller.joint];
        let section = if self.contains(keys::MECHANISM) {
            keys::MECHANISM.to_owned()
        } else {
            format!("{}.{}", keys::MECHANISMS, frame.name)
        };
        let roles = [("agonist", 1.0, "greater", "positive"), ("antagonist", -1.0, "smaller", "negative")];
        let unfit: Vec<Option<Unfit>> = (controller.actuators.iter().zip(roles))
            .map(|(name, (_, sign, ..))| {
                let index = of.members.iter().position(|member| member.name == *name)?;
                control::unfit(frame, (mechanism, controller.joint), &plant.actuators()[index], sign)
            })
            .collect();
        let swapped = unfit.iter().all(|of| *of == Some(Unfit::TurnsBack));
        let each = controller.actuators.iter().zip(&controller.places).zip(roles).zip(&unfit);
        each.filter_map(|(((name, place), (role, _, way, sign)), unfit)| {
            let key = format!("`{section}.joints.{joint}.controller.{role}` = \"{name}\"");
            let (title, label, help) = match (*unfit)? {
                Unfit::SpansAnother => (
                    format!("{key}, but `{name}` does not span the joint `{joint}`"),
                    format!("does not turn `{joint}`"),
                    format!(
                        "name an actuator whose tension turns `{joint}` towards {way} angles, or give `{name}` a {sign} arm \
                         `actuators.{name}.coupling.arms.{joint}`"
                    ),
                ),
                Unfit::TurnsBack => (
                    format!("{key}, but `{name}` turns the joint `{joint}` the other way"),
                    format!("must turn `{joint}` towards {way} angles"),
                    if swapped {
                        "swap agonist and antagonist, or change the signs of both arms".to_owned()
                    } else {
                        format!("name an actuator whose arm about `{joint}` is {sign}, or change the sign of this one")
                    },
                ),
            };
            let coupling = self.of_actuator(name);
            let arm = coupling.place(&format!("coupling.arms.{joint}")).or_else(|| coupling.place("coupling"));
            let label_of_arm = if *unfit == Some(Unfit::TurnsBack) { "turns it by this" } else { "spans this" };
            let found = Diagnostic::at(Class::Inconsistent, place.clone(), title, label);
            Some(found.related(arm.cloned(), label_of_arm).help(help))
        })
        .collect()
    }
}

/// Mistakes of several parts of a plant, to be shown together.
#[derive(Default)]
struct Found {
    /// Each with what sort of part has it, and the names of those parts.
    of_parts: Vec<(Diagnostic, &'static str, Vec<String>)>,
    /// Those that say where they are.
    alone: Vec<Diagnostic>,
}

impl Found {
    /// Adds the mistake of a part. One of what several parts share is one mistake.
    fn add(&mut self, diagnostic: Diagnostic, sort: &'static str, name: &str) {
        match self.of_parts.iter_mut().find(|(known, its, _)| *known == diagnostic && *its == sort) {
            Some((_, _, names)) => names.push(name.to_owned()),
            None => self.of_parts.push((diagnostic, sort, vec![name.to_owned()])),
        }
    }

    /// Returns `Err` with all of them when there are any.
    fn check(self) -> Result<(), Diagnostics> {
        let of_parts = self.of_parts.into_iter().map(|(diagnostic, sort, names)| {
            let also = match names.len() {
                1 => String::new(),
                more => format!(", and of {} more", more - 1),
            };
            diagnostic.help(format!("this is of {sort} `{}`{also}", names[0]))
        });
        Diagnostics::check(of_parts.chain(self.alone).collect())
    }
}

/// The error of a start for one actuator of a plant alone, without its air supply: none where its own start is sound.
fn start_alone(plant: &Plant, start: &PlantStart, index: usize, tolerance: f64) -> Option<Error> {
    let mounted = plant.actuators().get(index)?.clone();
    let network = Network::new(mounted.actuator.air());
    let alone = Plant::new(vec![mounted], network, plant.mechanisms().to_vec()).ok()?;
    let its = PlantStart {
        positions: start.positions.clone(),
        rates: start.rates.clone(),
        air: vec![*start.air.get(index)?],
        lengths: vec![*start.lengths.get(index)?],
        friction: start.friction.get(index).copied().into_iter().collect(),
    };
    PlantRun::new(&alone, &its, tolerance).err()
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
                    // Where both balance, with what the friction holds: the plant knows.
                    _ => None,
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
