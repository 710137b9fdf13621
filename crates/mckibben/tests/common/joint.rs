//! A joint in plain numbers, every one open to change.

use super::random::{Case, cases};
use super::{GRAVITY, Paper};
use mckibben::load::{Joint, Limb, MomentArm, Stops, Tendon};
use mckibben::plant::{JointPlant, JointTrajectory};
use mckibben::simulation::{Actuation, Driven, InitialAngle, InitialLength, JointInitial, JointRig};
use mckibben::valve::{Command, Solenoid};
use mckibben::{Error, GaugePressure};
use proptest::prelude::*;

/// A joint in plain numbers.
#[derive(Clone, Debug)]
pub(crate) struct Pair {
    pub(crate) papers: [Paper; 2],
    /// In place of the papers' own.
    pub(crate) solenoids: [Option<Solenoid>; 2],
    pub(crate) limb: Limb,
    pub(crate) tendons: [Tendon; 2],
    pub(crate) torque: f64,
    pub(crate) damping: f64,
    pub(crate) stops: Stops,
    pub(crate) angle: InitialAngle,
    pub(crate) angular_velocity: f64,
}

impl Pair {
    /// Two equal actuators on equal tendons, half contracted at angle zero, with a balanced limb and no stops.
    pub(crate) fn of(paper: Paper) -> Self {
        let pulley = Tendon { arm: MomentArm::Pulley(0.015), rest_length: 0.082 };
        Self {
            papers: [paper.clone(), paper],
            solenoids: [None, None],
            limb: Limb { mass: 0.3, distance: 0.0, inertia: 1e-3, gravity: GRAVITY, hanging_angle: 0.0 },
            tendons: [pulley; 2],
            torque: 0.0,
            damping: 0.0,
            stops: Stops { ends: [None; 2], stiffness: 500.0, damping: 1.0 },
            angle: InitialAngle::At(0.0),
            angular_velocity: 0.0,
        }
    }

    pub(crate) fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    pub(crate) fn rig(&self) -> Result<JointRig, Error> {
        let driven = [0, 1].map(|i| {
            let paper = &self.papers[i];
            let seats = || Solenoid::new(paper.kind, paper.delays.0, paper.delays.1).expect("a solenoid");
            Driven {
                actuator: paper.actuator(),
                actuation: paper
                    .command
                    .clone()
                    .map(|command| Actuation { solenoid: self.solenoids[i].unwrap_or_else(seats), command }),
            }
        });
        JointRig::new(driven, Joint::new(self.limb, self.tendons, self.torque, self.damping, self.stops)?)
    }

    pub(crate) fn initial(&self) -> JointInitial {
        JointInitial {
            gauge_pressure: self.papers.each_ref().map(|paper| GaugePressure(paper.gauge)),
            temperature: self.papers.each_ref().map(|paper| paper.temperature),
            angle: self.angle,
            angular_velocity: self.angular_velocity,
        }
    }

    pub(crate) fn try_run(&self, duration: f64, tolerance: f64) -> Result<JointTrajectory, Error> {
        let rig = self.rig()?;
        JointPlant::new(&rig)?.simulate(&rig.start(&self.initial())?, duration, tolerance)
    }

    pub(crate) fn run(&self, duration: f64, tolerance: f64) -> JointTrajectory {
        self.try_run(duration, tolerance).expect("the run reaches its end")
    }
}

/// The paper's rig under a command, and the joint that it is with a slack antagonist, a limb of inertia M r² and the constant
/// torque −M g r.
pub(crate) fn on_a_line(command: Command) -> (Paper, Pair) {
    let (mass, radius, rest) = (2.0, 0.02, 0.09);
    let paper = Paper::driven(command).mass(mass).with(|rig| rig.length = InitialLength::Equilibrium);
    let pair = Pair::of(paper.clone()).with(|pair| {
        pair.papers[1] = Paper::sealed();
        pair.limb = Limb { mass, distance: 0.0, inertia: mass * radius * radius, gravity: GRAVITY, hanging_angle: 0.0 };
        let slack = Tendon { arm: MomentArm::Pulley(1e-3), rest_length: 0.02 };
        pair.tendons = [Tendon { arm: MomentArm::Pulley(radius), rest_length: rest }, slack];
        pair.torque = -mass * GRAVITY * radius;
        pair.angle = InitialAngle::Equilibrium;
    });
    (paper, pair)
}

/// A pulley, or an arm that goes up and down about its radius.
pub(crate) fn moment_arm(radius: f64, varies: bool) -> MomentArm {
    let arms = [1.0, 1.3, 0.8, 1.2].map(|part| part * radius);
    let table = || MomentArm::table(&[-0.5, -0.1, 0.2, 0.6], &arms).expect("a table");
    if varies { table() } else { MomentArm::Pulley(radius) }
}

/// Any joint, how long it runs in s, and its tolerance.
pub(crate) fn pairs() -> impl Strategy<Value = (Pair, f64, f64)> {
    let share = || 0.5..1.0_f64;
    let radius = || 0.02..0.6_f64;
    let start = prop_oneof![1 => Just(None), 2 => (-0.5..0.5_f64).prop_map(Some)];
    let limb = (0.01..5.0_f64, 0.0..0.5_f64, 1e-4..1e-1_f64, -3.0..3.0_f64);
    let stops = (prop::option::of(-0.5..0.0_f64), prop::option::of(0.01..0.5_f64), 0.0..3.0_f64, any::<bool>());
    ((cases(), cases()), (share(), share(), radius(), radius()), limb, stops, start, -3.0..3.0_f64).prop_map(
        |(
            (first, second),
            (rest, other_rest, radius, other),
            (mass, distance, inertia, hanging),
            stops,
            start,
            speed,
        )| {
            let Case { duration, tolerance, .. } = first;
            let pulley = |paper: &Paper, share: f64, radius: f64| Tendon {
                arm: moment_arm(radius * paper.thread_length, stops.3),
                rest_length: share * paper.max_length,
            };
            let tendons = [pulley(&first.paper, rest, radius), pulley(&second.paper, other_rest, other)];
            let pair = Pair {
                solenoids: [None, None],
                papers: [first.paper, second.paper],
                limb: Limb { mass, distance, inertia, gravity: GRAVITY, hanging_angle: hanging },
                tendons,
                torque: 0.0,
                damping: 1e-3,
                stops: Stops { ends: [stops.0, stops.1], stiffness: 500.0, damping: stops.2 },
                angle: start.map_or(InitialAngle::Equilibrium, InitialAngle::At),
                angular_velocity: if start.is_some() { speed } else { 0.0 },
            };
            (pair, duration, tolerance)
        },
    )
}
