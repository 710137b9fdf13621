//! A joint in plain numbers, every one open to change.

use super::{GRAVITY, Paper};
use mckibben::load::{Joint, Limb, MomentArm, Stops, Tendon};
use mckibben::simulation::{
    Actuation, Driven, InitialAngle, InitialLength, JointInitial, JointRig, JointTrajectory, simulate_joint,
};
use mckibben::valve::{Command, Solenoid};
use mckibben::{Error, GaugePressure};

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
        simulate_joint(&rig, rig.start(&self.initial())?, duration, tolerance)
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
