//! The discrete state of a plant: which formulas hold.

use super::evaluation::System;
use super::sliding::Facet;
use super::wire::Wire;
use crate::command::Driver;
use crate::mechanism::Contact;
use crate::network::mode::NetworkMode;
use crate::scalar::Real;
use crate::simulation::member::Trace;
use crate::simulation::{LengthRegime, Mode, Sliding};
use crate::valve::Ports;
use alloc::vec;
use alloc::vec::Vec;

/// The discrete state of an actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorMode<R = f64> {
    /// Slack, free or taut, sliding or sticking, pieces of its laws.
    pub mode: Mode,
    /// Whether it rests on its shortest length, where it holds any tension up to its most.
    pub on_stop: bool,
    /// Whether its tendon in series hangs loose.
    pub loose: bool,
    /// What the hysteresis remembers, where there is one.
    #[doc(hidden)]
    pub trace: Option<Trace<R>>,
    /// `P V/m` of an isothermal process, which nothing changes.
    #[doc(hidden)]
    pub isothermal: Option<R>,
    /// Rows of a given pressure that have been passed.
    pub rows_passed: usize,
}

/// The discrete state of a mechanism.
#[derive(Debug, PartialEq)]
pub struct MechanismMode {
    /// Whether friction holds all of its coordinates.
    pub frozen: bool,
    /// Contacts with the stops of each joint.
    pub stops: Vec<[Contact; 2]>,
    /// Contact of the foot with the belt.
    pub foot: Contact,
    /// Sticking actuators whose gradients are independent: those that hold what is held.
    #[doc(hidden)]
    pub basis: Vec<usize>,
    /// Facets of what they can hold.
    #[doc(hidden)]
    pub facets: Vec<Facet>,
    /// Corners of a given motion that have been passed.
    pub corners_passed: usize,
}

impl Clone for MechanismMode {
    fn clone(&self) -> Self {
        let Self { frozen, stops, foot, basis, facets, corners_passed } = self;
        let (stops, basis, facets) = (stops.clone(), basis.clone(), facets.clone());
        Self { frozen: *frozen, stops, foot: *foot, basis, facets, corners_passed: *corners_passed }
    }

    /// Takes on another mode in the memory that is there.
    fn clone_from(&mut self, source: &Self) {
        let Self { frozen, stops, foot, basis, facets, corners_passed } = self;
        (*frozen, *foot, *corners_passed) = (source.frozen, source.foot, source.corners_passed);
        stops.clone_from(&source.stops);
        basis.clone_from(&source.basis);
        facets.clone_from(&source.facets);
    }
}

/// The discrete state of a plant.
#[derive(Debug)]
pub struct PlantMode<R: Real = f64> {
    /// Of each actuator.
    pub actuators: Vec<ActuatorMode<R>>,
    /// Of each mechanism.
    pub mechanisms: Vec<MechanismMode>,
    /// Of the network.
    pub network: NetworkMode<R>,
    /// The piece of each moment arm, those of each actuator one after the other.
    pub(crate) arms: Vec<usize>,
    /// The drivers, with what their controllers remember.
    pub drivers: Vec<Driver<R>>,
}

impl<R: Real> Clone for PlantMode<R> {
    fn clone(&self) -> Self {
        let Self { actuators, mechanisms, network, arms, drivers } = self;
        let (actuators, mechanisms, network) = (actuators.clone(), mechanisms.clone(), network.clone());
        Self { actuators, mechanisms, network, arms: arms.clone(), drivers: drivers.clone() }
    }

    /// Takes on another mode in the memory that is there.
    fn clone_from(&mut self, source: &Self) {
        let Self { actuators, mechanisms, network, arms, drivers } = self;
        actuators.clone_from(&source.actuators);
        mechanisms.clone_from(&source.mechanisms);
        network.clone_from(&source.network);
        arms.clone_from(&source.arms);
        drivers.clone_from(&source.drivers);
    }
}

impl<R: Real> System<R> {
    /// The mode of a plant of which nothing but the pieces of its laws is known yet, in a state: all paths as their valves begin,
    /// all actuators at rest between their limits, no contacts.
    pub(super) fn first_mode(&self, state: &[R]) -> PlantMode<R> {
        let plant = &*self.plant;
        let mut arms = vec![0; plant.places.arms];
        for (mounted, here) in plant.actuators.iter().zip(&plant.places.actuators) {
            let (position, _) = plant.places.mechanisms[mounted.mechanism].of(state);
            mounted.coupling.pieces(position, &mut arms[here.arms..here.arms + mounted.coupling.arm_count()]);
        }
        let actuator = |Wire { member, places, .. }: &Wire<R>| ActuatorMode {
            mode: Mode {
                ports: Ports::CLOSED,
                supply_zone: None,
                exhaust_zone: None,
                effectiveness_piece: member.effectiveness_piece(state[places.pressure]),
                pressed: member.pressed(state[places.pressure]),
                force_piece: Default::default(),
                length_regime: LengthRegime::Free,
                sliding: Sliding::Held,
                clamped: false,
            },
            on_stop: false,
            loose: false,
            trace: None,
            isothermal: None,
            rows_passed: 0,
        };
        let mechanism = |here: &super::MechanismIndices| MechanismMode {
            frozen: false,
            stops: vec![[Contact::None; 2]; here.coordinates],
            foot: Contact::None,
            basis: Vec::new(),
            facets: Vec::new(),
            corners_passed: 0,
        };
        PlantMode {
            actuators: self.wires.iter().map(actuator).collect(),
            mechanisms: plant.places.mechanisms.iter().map(mechanism).collect(),
            network: plant.network.begin(),
            arms,
            drivers: Vec::new(),
        }
    }
}
