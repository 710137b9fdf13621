//! Two actuators that turn a joint against each other: a system of six states.
//!
//! ```text
//! dθ/dt = ω
//! dω/dt = (r₁(θ) F₁ − r₂(θ) F₂ + W − M g d sin(θ − θ₀) − c ω − S)/J        (see `load::Joint`)
//! dP/dt, dm/dt of each actuator by its process (19) and its valve (21)
//! ```
//!
//! | state | name in code | unit |
//! |---|---|---|
//! | θ | `angle`, growing the way that the first actuator turns | rad |
//! | ω | `angular_velocity` | rad/s |
//! | P₁, P₂ | `pressure`, absolute | Pa |
//! | m₁, m₂ | `air_mass` | kg |
//!
//! Actuators may also have [`Fittings`]: an air line, a tendon, a given pressure. These add states of the plant.
//!
//! [`JointPlant`](crate::plant::JointPlant) goes through time. Checked by `tests/joint.rs` and `tests/joint_steps.rs`.

mod fittings;
#[cfg(feature = "alloc")]
mod sample;

pub use fittings::{Fittings, JointSupply};
#[cfg(feature = "alloc")]
pub use sample::JointSample;

use super::rig::{Actuation, check_air, check_drive};
use crate::actuator::Actuator;
use crate::control::Held;
#[cfg(feature = "alloc")]
use crate::convert::{Convert, ConvertEachOf};
use crate::dual::Dual;
use crate::error::{Error, Requirement};
use crate::force::Statics;
use crate::load::{Joint, SIGN, SeriesTendon};
use crate::parameter::{self, Parameter};
#[cfg(feature = "alloc")]
use crate::plant::Part;
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::root;
use crate::scalar::{Over, Real, Scalar};
#[cfg(feature = "alloc")]
use crate::valve::Command;

/// An actuator and what drives its valve.
#[derive(Clone, Debug, PartialEq)]
pub struct Driven<S = f64> {
    /// The actuator.
    pub actuator: Actuator<S>,
    /// What drives its valve; there exactly when it has one.
    pub actuation: Option<Actuation<S>>,
}

/// A joint with the two actuators that turn it.
#[derive(Clone, Debug, PartialEq)]
pub struct JointRig<S = f64> {
    driven: [Driven<S>; 2],
    joint: Joint<S>,
    fittings: [Fittings<S>; 2],
    supply: JointSupply,
}

/// The six states; of two, the agonist's is first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointState<S = f64> {
    /// Angle in rad.
    pub angle: S,
    /// Angular velocity in rad/s.
    pub angular_velocity: S,
    /// Absolute pressures of the air.
    pub pressure: [AbsolutePressure<S>; 2],
    /// Masses of the air in kg.
    pub air_mass: [S; 2],
}

/// Where the angle starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialAngle<S = f64> {
    /// Where the torques balance at the initial pressures, without friction.
    Equilibrium,
    /// An angle in rad.
    At(S),
}

/// The start of an experiment with a joint; of two, the agonist's is first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointInitial<S = f64> {
    /// Gauge pressures in the actuators.
    pub gauge_pressure: [GaugePressure<S>; 2],
    /// Temperatures in K, which fix the masses of air.
    pub temperature: [S; 2],
    /// The angle.
    pub angle: InitialAngle<S>,
    /// Angular velocity in rad/s.
    pub angular_velocity: S,
}

impl<S: Scalar> JointInitial<S> {
    /// Converts the start to another scalar type; `function` receives each number with its parameter and its
    /// actuator, as by [`JointRig::map_of_each`].
    pub fn map_of_each<T: Scalar>(
        &self,
        mut function: impl FnMut(Option<usize>, &'static Parameter, S) -> T,
    ) -> JointInitial<T> {
        let mut of_each = |row, values: [S; 2]| [0, 1].map(|i| function(Some(i), row, values[i]));
        let gauge_pressure = of_each(&parameter::INITIAL_GAUGE_PRESSURE, self.gauge_pressure.map(|gauge| gauge.0));
        let temperature = of_each(&parameter::INITIAL_TEMPERATURE, self.temperature);
        JointInitial {
            gauge_pressure: gauge_pressure.map(GaugePressure),
            temperature,
            angle: match self.angle {
                InitialAngle::Equilibrium => InitialAngle::Equilibrium,
                InitialAngle::At(angle) => InitialAngle::At(function(None, &parameter::INITIAL_ANGLE, angle)),
            },
            angular_velocity: function(None, &parameter::INITIAL_ANGULAR_VELOCITY, self.angular_velocity),
        }
    }
}

impl<S: Real> JointRig<S> {
    /// That neither command has more than [`MAX_COUNT`](parameter::MAX_COUNT) pulses in a run of `duration` s.
    ///
    /// # Errors
    /// [`Error::TooMany`] otherwise.
    pub fn check_counts(&self, duration: f64) -> Result<(), Error> {
        let mut actuations = self.driven.iter().filter_map(|driven| driven.actuation.as_ref());
        actuations.try_for_each(|actuation| actuation.check_counts(duration))
    }
}

impl JointRig {
    /// A joint with its agonist and its antagonist.
    ///
    /// # Errors
    /// [`Error::Misuse`] when an actuator has a valve and nothing drives it, the other way round, or the valve cannot
    /// carry out the command; [`Error::Inconsistent`] when no angle leaves both braids shorter than their threads.
    pub fn new(driven: [Driven; 2], joint: Joint) -> Result<Self, Error> {
        Self { driven, joint, fittings: [Fittings::NONE; 2], supply: JointSupply::Separate }.checked()
    }

    /// Checks that the parts of the joint fit each other, and returns it.
    fn checked(self) -> Result<Self, Error> {
        let rig = self;
        for Driven { actuator, actuation } in &rig.driven {
            check_drive(actuator, actuation.as_ref())?;
        }
        let [low, high] = rig.straight();
        if low < high {
            return Ok(rig);
        }
        let [first, second] = rig.joint.tendons();
        Err(Error::Inconsistent {
            parameter: &parameter::REST_LENGTH,
            value: second.rest_length,
            requirement: Requirement {
                relation: "must leave an angle at which both actuators are shorter than their threads, given",
                other: "the agonist's rest length",
                value: first.rest_length,
                unit: "m",
            },
            remedy: "shorten load.rest_length of either actuator",
        })
    }

    /// The state at the start.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] or [`Error::Inconsistent`] for a start outside the physics; [`Error::Misuse`] when an
    /// equilibrium is requested and there is none.
    pub fn start(&self, initial: &JointInitial) -> Result<JointState, Error> {
        for i in 0..2 {
            check_air(&self.driven[i].actuator, initial.gauge_pressure[i], initial.temperature[i])?;
        }
        parameter::INITIAL_ANGULAR_VELOCITY.check(initial.angular_velocity)?;
        if let InitialAngle::At(angle) = initial.angle {
            parameter::INITIAL_ANGLE.check(angle)?;
            let [low, high] = self.straight();
            let beyond = |relation, value| Error::Inconsistent {
                parameter: &parameter::INITIAL_ANGLE,
                value: angle,
                requirement: Requirement {
                    relation,
                    other: "the angle at which a braid is straight,",
                    value,
                    unit: "rad",
                },
                remedy: "start where both actuators are shorter than their threads, or at \"equilibrium\"",
            };
            if angle <= low {
                return Err(beyond("must be greater than", low));
            }
            if angle >= high {
                return Err(beyond("must be less than", high));
            }
        }
        self.begin(initial)
    }
}

impl<S: Scalar> JointRig<S> {
    /// Converts the rig to another scalar type; `function` receives each number with its parameter.
    #[cfg(feature = "alloc")]
    pub fn map<T: Scalar>(&self, mut function: impl FnMut(&'static Parameter, S) -> T) -> JointRig<T> {
        self.map_of_each(|_, parameter, value| function(parameter, value))
    }

    /// Converts the rig to another scalar type; `function` receives each number with its parameter and its actuator: 0
    /// for the agonist, 1 for the antagonist, `None` for the joint itself. What leads a tendon over the joint is of its
    /// actuator.
    #[cfg(feature = "alloc")]
    pub fn map_of_each<T: Scalar>(
        &self,
        mut function: impl FnMut(Option<usize>, &'static Parameter, S) -> T,
    ) -> JointRig<T> {
        let function = move |part, parameter, value| match part {
            Some(Part::Actuator(i)) => function(Some(i), parameter, value),
            _ => function(None, parameter, value),
        };
        let convert = &mut ConvertEachOf { function, part: None };
        let each = [0, 1].map(|i| {
            let Driven { actuator, actuation } = &self.driven[i];
            convert.turn_to(Some(Part::Actuator(i)));
            let actuator = actuator.convert(convert);
            let actuation = actuation.as_ref().map(|actuation| actuation.convert(convert));
            (Driven { actuator, actuation }, self.fittings[i].convert(convert))
        });
        convert.turn_to(None);
        let [(agonist, its), (antagonist, others)] = each;
        let joint = self.joint.convert(convert);
        JointRig { driven: [agonist, antagonist], joint, fittings: [its, others], supply: self.supply }
    }

    /// The joint with other commands of its valves; an actuator without one keeps what it has.
    #[cfg(feature = "alloc")]
    pub(crate) fn commanded(&self, commands: [Option<Command<S>>; 2]) -> Self {
        let mut rig = self.clone();
        for (driven, command) in rig.driven.iter_mut().zip(commands) {
            if let (Some(actuation), Some(command)) = (&mut driven.actuation, command) {
                actuation.command = command;
            }
        }
        rig
    }

    /// Agonist and antagonist.
    pub fn driven(&self) -> &[Driven<S>; 2] {
        &self.driven
    }

    /// The joint.
    pub fn joint(&self) -> &Joint<S> {
        &self.joint
    }

    fn actuators(&self) -> [&Actuator<S>; 2] {
        self.driven.each_ref().map(|driven| &driven.actuator)
    }
}

impl<S: Real> JointRig<S> {
    /// The angles in rad at which the agonist's and the antagonist's braid would be straight, on tendons at least so far: the
    /// open range of the angle.
    fn straight(&self) -> [S; 2] {
        core::array::from_fn(|i| {
            let actuator = &self.driven[i].actuator;
            let end = actuator.law().law.end_length();
            let distance = match &self.fittings[i].tendon {
                // The taut braid stretches it so far.
                Some(tendon) => {
                    end + tendon.rest_length() + actuator.limits().force(end, S::zero()) / tendon.stiffness()
                }
                None => end,
            };
            self.joint.angle_at(i, distance)
        })
    }

    /// Stiffness in N·m/rad that the two actuators give the joint at an angle in rad and absolute pressures, at rest without
    /// friction, `r₁² k₁ − r₁′ F₁ + r₂² k₂ + r₂′ F₂` with the arms' slopes r′; a slack tendon gives none, and what a taut
    /// braid adds is left out. An elastic tendon stands in series, `1/k = 1/k_actuator + 1/k_tendon`; a pressure that is given
    /// over time is kept whatever `held` says, and air in a hose is not counted. The weight of the limb adds its own.
    pub fn stiffness(&self, angle: S, pressure: [AbsolutePressure<S>; 2], held: Held) -> S {
        let leverage = self.joint.leverage(Dual::<S, 1>::variable(angle, 0));
        let lengths = self.lengths(angle, pressure);
        let of = |i: usize| {
            let (actuator, arm, length) = (&self.driven[i].actuator, leverage.arms[i], lengths[i]);
            let Fittings { tendon, pressure: given, .. } = &self.fittings[i];
            let own = || match (held, given) {
                (Held::AirMasses, None) => actuator.sealed_stiffness(length, pressure[i]),
                (Held::Pressures, _) | (_, Some(_)) => actuator.stiffness(length, pressure[i]),
            };
            let (stiffness, force) = match tendon {
                None if actuator.limits().is_slack(length) => return S::zero(),
                None => (own(), actuator.static_force(length, pressure[i].0).larger(S::zero())),
                Some(tendon) => {
                    let force = tendon.tension(leverage.lengths[i].value - length);
                    if force.value() <= 0.0 {
                        return S::zero();
                    }
                    // At its shortest length the actuator gives way no further.
                    let rigid = length.value() <= actuator.limits().min_length().value();
                    let (own, its) = (own(), tendon.stiffness());
                    (if rigid { its } else { own * its / (own + its) }, force)
                }
            };
            arm.value * arm.value * stiffness + S::constant(SIGN[i]) * arm.slope[0] * force
        };
        of(0) + of(1)
    }

    /// The state at a start that has been checked, over any scalar with one value.
    ///
    /// # Errors
    /// [`Error::NoSolution`] when an equilibrium is requested and there is none.
    pub fn begin(&self, initial: &JointInitial<S>) -> Result<JointState<S>, Error> {
        let actuators = self.actuators();
        let pressure = core::array::from_fn(|i| self.first_pressure(i, initial.gauge_pressure[i]));
        let angle = match initial.angle {
            InitialAngle::At(angle) => angle,
            InitialAngle::Equilibrium => self.equilibrium(pressure)?,
        };
        let lengths = self.lengths(angle, pressure);
        let air_mass = core::array::from_fn(|i| {
            actuators[i].air().mass(pressure[i], actuators[i].volume(lengths[i]), initial.temperature[i])
        });
        Ok(JointState { angle, angular_velocity: initial.angular_velocity, pressure, air_mass })
    }

    /// Torque in N·m at rest without friction, of actuators, load and stops, at an angle `near` another; an actuator on its
    /// shortest length pulls on a tendon alone.
    fn static_torque<T: Over<S>>(&self, angle: T, near: S, pressure: [S; 2]) -> T {
        let (leverage, actuators) = (self.joint.leverage(angle), self.actuators());
        let tensions = core::array::from_fn(|i| {
            let (actuator, length) = (actuators[i], leverage.lengths[i]);
            if let Some(tendon) = &self.fittings[i].tendon {
                let [balanced, per_distance] = self.balance_on(i, tendon, near, pressure[i]);
                let moved = T::of(balanced) + T::of(per_distance) * (length - T::of(self.joint.lengths(near)[i]));
                let stretch = length - T::of(tendon.rest_length()) - moved;
                return T::of(tendon.stiffness()) * stretch.larger(T::zero());
            }
            let force = actuator.static_force(length, T::of(pressure[i])) + actuator.limits().force(length, T::zero());
            let slack = length.le(T::of(actuator.limits().min_length()));
            T::select(slack, T::zero(), force.larger(T::zero()))
        });
        let stops = (0..2).fold(T::zero(), |sum, end| {
            sum - T::constant(SIGN[end]) * self.joint.stop_torque(end, angle, T::zero()).larger(T::zero())
        });
        leverage.torque_of(tensions) + self.joint.other_torque(angle, T::zero()) + stops
    }

    /// The length in m at which an actuator balances its tendon at an angle in rad and an absolute pressure in Pa, and how it
    /// changes with the distance that both span.
    fn balance_on(&self, i: usize, tendon: &SeriesTendon<S>, angle: S, pressure: S) -> [S; 2] {
        let actuator = &self.driven[i].actuator;
        let length = tendon.balance(actuator, self.joint.lengths(angle)[i], pressure);
        let at = Dual::<S, 1>::variable(length, 0);
        let own = actuator.static_force(at, Dual::of(pressure)) + actuator.limits().force(at, Dual::zero());
        let free = length.value() > actuator.limits().min_length().value() && own.value.value() > 0.0;
        let its = tendon.stiffness();
        [length, if free { its / (its + own.slope[0]) } else { S::zero() }]
    }

    /// The angle in rad at which the torques balance at two pressures, without friction; where an actuator has come to its
    /// shortest length if it turns the joint no further than that. Of several such angles, one.
    ///
    /// # Errors
    /// [`Error::NoSolution`] when the load would pull a braid straight.
    pub fn equilibrium(&self, pressure: [AbsolutePressure<S>; 2]) -> Result<S, Error> {
        let pressure = pressure.map(|pressure| pressure.0);
        let torque = |angle: S| self.static_torque(angle, angle, pressure);
        let at = |angle: f64| torque(S::constant(angle)).value();
        let [low, high] = self.straight();
        for (i, actuator) in
            self.actuators().into_iter().enumerate().filter(|(i, _)| self.fittings[*i].tendon.is_none())
        {
            let shortest = actuator.limits().min_length();
            let angle = self.joint.angle_at(i, shortest);
            let within = low.value() < angle.value() && angle.value() < high.value();
            // Slack, the actuator lets the joint come back; at its shortest length it may pull with all its force.
            let pull =
                actuator.static_force(shortest, pressure[i]).larger(S::zero()) * self.joint.leverage(angle).arms[i];
            let back = S::constant(SIGN[i]) * torque(angle);
            if within && back.value() >= 0.0 && back.value() <= pull.value() {
                return Ok(angle);
            }
        }
        let (low, high) = (low.value(), high.value());
        if at(low) < 0.0 || at(high) > 0.0 {
            return Err(Error::NoSolution {
                what: "the load would pull a braid straight: there is no angle at which the joint is in equilibrium",
                remedy: "lighten the load, stiffen actuator.limit.stiffness or give the joint stops",
            });
        }
        let root = S::constant(root::bracketed(low, high, 1e-16, at));
        // One Newton step over the scalar: it polishes the value and carries the derivatives.
        let slope: Dual<S, 1> = self.static_torque(Dual::variable(root, 0), root, pressure);
        let step = torque(root) / slope.slope[0];
        Ok(if step.value().abs() < 1e-9 { root - step } else { root })
    }
}
