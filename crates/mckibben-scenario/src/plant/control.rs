//! The controllers of a plant: of single actuators, and of joints with an agonist and an antagonist.

use super::{Frame, JointController, Member, Mount, PlantScenario};
use crate::controlled::{ActuatorLoop, ControlLaw, GreatestRequest, loop_of, ways};
use crate::controlled_joint::{JointLaw, JointLoop, joint_loop};
use crate::scenario::Command;
use mckibben::Error;
use mckibben::command::Driver;
use mckibben::control::{JointSensors, Quantity, Sampling, Sensors, SetPoint};
use mckibben::load::{Joint, Limb, Stops, Tendon};
use mckibben::mechanism::{Coupling, Mechanism};
use mckibben::plant::{Mounted, Plant};
use mckibben::simulation::{Driven, JointRig};

/// A controller of a plant.
#[derive(Clone, Debug, PartialEq)]
pub enum PlantControl {
    /// Of one actuator.
    Actuator(Box<ActuatorControl>),
    /// Of a joint.
    Joint(Box<JointControl>),
}

/// A controller of one actuator of a plant.
#[derive(Clone, Debug, PartialEq)]
pub struct ActuatorControl {
    /// The actuator.
    pub actuator: usize,
    /// Its valve.
    pub valve: usize,
    /// The controller.
    pub law: ControlLaw,
    /// When it samples.
    pub sampling: Sampling,
    /// What it measures by.
    pub sensors: Sensors,
    /// What it regulates.
    pub regulated: Quantity,
    /// The set points of the file.
    pub set_points: Vec<(Quantity, SetPoint)>,
    /// The greatest gauge pressure that it may request, where it requests any.
    pub greatest_request: Option<GreatestRequest>,
}

/// A controller of two actuators about a joint of a plant.
#[derive(Clone, Debug, PartialEq)]
pub struct JointControl {
    /// The mechanism and its coordinate.
    pub joint: (usize, usize),
    /// Agonist and antagonist.
    pub actuators: [usize; 2],
    /// Their valves.
    pub valves: [usize; 2],
    /// The controller.
    pub law: JointLaw,
    /// When it samples.
    pub sampling: Sampling,
    /// What it measures by.
    pub sensors: JointSensors,
    /// What it regulates: the angle, or the pressures or air masses of both actuators.
    pub regulated: Quantity,
    /// The set points of the file.
    pub set_points: Vec<(Quantity, SetPoint)>,
    /// The greatest gauge pressure that it may request, where it requests any.
    pub greatest_request: Option<GreatestRequest>,
    /// The joint that a law by the model knows.
    pub model: Option<JointRig>,
}

impl PlantControl {
    /// The controller as a driver of the plant's valves, before its first sampling instant.
    pub fn driver(&self) -> Driver {
        let driver = match self {
            Self::Actuator(of) => Driver::of_actuator(of.law.clone(), of.actuator, of.valve, (of.sampling, of.sensors)),
            Self::Joint(of) => {
                Driver::of_joint(of.law.clone(), of.joint, of.actuators, of.valves, (of.sampling, of.sensors))
            }
        };
        driver.with_set_points(self.set_points().iter().map(|(_, set_point)| set_point))
    }

    /// What it regulates.
    pub fn regulated(&self) -> Quantity {
        match self {
            Self::Actuator(of) => of.regulated,
            Self::Joint(of) => of.regulated,
        }
    }

    /// The greatest gauge pressure that it may request, where it requests any, and the valves that are to make it.
    pub fn greatest_request(&self) -> Option<(GreatestRequest, &[usize])> {
        let (request, valves) = match self {
            Self::Actuator(of) => (of.greatest_request, core::slice::from_ref(&of.valve)),
            Self::Joint(of) => (of.greatest_request, &of.valves[..]),
        };
        request.map(|request| (request, valves))
    }

    /// The set points of the file.
    pub fn set_points(&self) -> &[(Quantity, SetPoint)] {
        match self {
            Self::Actuator(of) => &of.set_points,
            Self::Joint(of) => &of.set_points,
        }
    }
}

/// The controller of a member, where it has one; `actuator` is its actuator in the plant.
pub(super) fn of_member(
    member: &Member,
    (actuator, valve): (usize, Option<usize>),
    plant: &Plant,
    duration: f64,
) -> Result<Option<PlantControl>, Error> {
    let (Some(Command::Controller(of)), Some(valve)) = (&member.alone.command, valve) else { return Ok(None) };
    let mounted = &plant.actuators()[actuator].actuator;
    let ActuatorLoop { law, sampling, sensors, regulated, set_points, greatest_request } =
        loop_of(of, ways(&member.alone)?, mounted, duration)?;
    let control = ActuatorControl { actuator, valve, law, sampling, sensors, regulated, set_points, greatest_request };
    Ok(Some(PlantControl::Actuator(Box::new(control))))
}

/// The controller of a joint of a frame.
pub(super) fn of_joint(
    scenario: &PlantScenario,
    (mechanism, controller): (usize, &JointController),
    plant: &Plant,
    valves: &[Option<usize>],
) -> Result<PlantControl, Error> {
    let JointController { joint, actuators: names, controller: of, .. } = controller;
    let find = |name: &String| scenario.members.iter().position(|member| member.name == *name);
    let [Some(agonist), Some(antagonist)] = names.each_ref().map(find) else { return Err(no_pair()) };
    let actuators = [agonist, antagonist];
    let [first, second] = actuators.map(|index| ways(&scenario.members[index].alone));
    let (first, second) = (first?, second?);
    if first != second {
        return Err(Error::Misuse {
            what: "one controller drives both actuators of a joint, and their valves are of different kinds",
            remedy: "give both valves the same kind",
        });
    }
    let [Some(of_agonist), Some(of_antagonist)] = actuators.map(|index| valves[index]) else { return Err(no_pair()) };
    if of_agonist == of_antagonist {
        return Err(Error::Misuse {
            what: "agonist and antagonist of a controller have one valve",
            remedy: "give each a valve that the other has not",
        });
    }
    let model = || model(plant, &scenario.frames[mechanism], (mechanism, *joint), scenario, actuators);
    let kept = model();
    let JointLoop { law, sampling, sensors, regulated, set_points, greatest_request } =
        joint_loop(of, first, || kept.clone(), scenario.run.duration)?;
    let control = JointControl {
        joint: (mechanism, *joint),
        actuators,
        valves: [of_agonist, of_antagonist],
        law,
        sampling,
        sensors,
        regulated,
        set_points,
        greatest_request,
        model: kept.ok(),
    };
    Ok(PlantControl::Joint(Box::new(control)))
}

/// What keeps an actuator from its role at a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unfit {
    /// It does not span the joint.
    SpansAnother,
    /// It turns the joint the other way.
    TurnsBack,
}

/// What keeps an actuator from turning a joint towards greater angles (`sign` 1) or smaller ones (−1). An arm keeps its sign;
/// between two points it counts at the start and at the stops, since a dead centre between them may be meant.
pub(super) fn unfit(frame: &Frame, (mechanism, joint): (usize, usize), mounted: &Mounted, sign: f64) -> Option<Unfit> {
    /// Half the angle in rad of a difference.
    const STEP: f64 = 1e-5;
    /// An arm in m below which a difference does not show its sign.
    const LEAST_ARM: f64 = 1e-6;
    let Mechanism::Chain(chain) = &frame.mechanism else { return None };
    if mounted.mechanism != mechanism {
        return Some(Unfit::SpansAnother);
    }
    match &mounted.coupling {
        Coupling::Direct { .. } => Some(Unfit::SpansAnother),
        Coupling::Arms { arms, .. } => match arms.iter().find(|arm| arm.joint == joint) {
            None => Some(Unfit::SpansAnother),
            Some(arm) => (arm.sign != sign).then_some(Unfit::TurnsBack),
        },
        Coupling::Points(ends) => {
            let turns = |end: usize| ends[end].segment.is_some_and(|segment| joint <= segment);
            if turns(0) == turns(1) {
                return Some(Unfit::SpansAnother);
            }
            let span = |angle: f64| {
                let mut position = frame.positions.clone();
                position[joint] = angle;
                mounted.coupling.span(&frame.mechanism, &position)
            };
            // Virtual work: the arm is how much shorter the actuator becomes for each radian.
            let turns_back = |angle: &f64| sign * (span(angle - STEP) - span(angle + STEP)) / (2.0 * STEP) < -LEAST_ARM;
            let stops = chain.joints()[joint].stops.ends;
            let mut angles = [Some(frame.positions[joint]), stops[0], stops[1]].into_iter().flatten();
            angles.all(|angle| turns_back(&angle)).then_some(Unfit::TurnsBack)
        }
    }
}

/// A controller of a joint whose actuators have no valves.
fn no_pair() -> Error {
    Error::Misuse {
        what: "a controller of a joint drives two actuators with a valve each",
        remedy: "name an agonist and an antagonist that have valves",
    }
}

/// The joint that a controller by the model knows: a chain of one joint, with one moment arm of each actuator.
fn model(
    plant: &Plant,
    frame: &Frame,
    (mechanism, joint): (usize, usize),
    scenario: &PlantScenario,
    actuators: [usize; 2],
) -> Result<JointRig, Error> {
    let unlike = || Error::NotImplemented(&mckibben::limit::PLANT_MODEL);
    let Mechanism::Chain(chain) = &frame.mechanism else { return Err(unlike()) };
    let ([segment], [axis], None) = (chain.segments(), chain.joints(), chain.belt()) else { return Err(unlike()) };
    let limb = Limb {
        mass: segment.mass,
        distance: segment.distance,
        inertia: segment.inertia,
        gravity: chain.gravity(),
        hanging_angle: chain.hanging_angle(),
    };
    let lead = |index: usize, sign: f64| match &plant.actuators()[index] {
        Mounted { mechanism: on, coupling: Coupling::Arms { rest_length, arms }, tendon: None, .. }
            if *on == mechanism =>
        {
            match arms.as_slice() {
                [arm] if arm.joint == joint && arm.sign == sign => {
                    Ok(Tendon { arm: arm.arm, rest_length: *rest_length })
                }
                _ => Err(unlike()),
            }
        }
        _ => Err(unlike()),
    };
    let tendons = [lead(actuators[0], 1.0)?, lead(actuators[1], -1.0)?];
    let stops = Stops { ends: axis.stops.ends, stiffness: axis.stops.stiffness, damping: axis.stops.damping };
    let core = Joint::new(limb, tendons, axis.torque, axis.damping, stops)?;
    let driven = |index: usize| -> Result<Driven, Error> {
        let member = &scenario.members[index];
        debug_assert!(!matches!(member.mount, Mount::Own));
        member.alone.open_loop().driven_by(member.output)
    };
    JointRig::new([driven(actuators[0])?, driven(actuators[1])?], core)
}
