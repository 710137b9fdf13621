//! What a plant is doing, in the words of the joint that it is.

use super::JointPlant;
use crate::air::Flow;
use crate::command::PlantDecision;
use crate::control::Drive;
use crate::mechanism::Contact;
use crate::network::NodeKind;
use crate::plant::{Part, PlantEventKind, PlantMode, PlantSample};
use crate::scalar::Real;
use crate::simulation::{EventKind, JointDecision, JointSample, Mode, Sample, Sliding};
use crate::valve::{Demand, Ports};

/// How the joint turns, which decides the Coulomb friction of both actuators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turning {
    /// Towards greater angles: the agonist shortens.
    Forward,
    /// Towards smaller angles: the antagonist shortens.
    Backward,
    /// The friction of both actuators together holds the joint at rest.
    Stuck,
    /// There is no friction to decide that depends on the direction.
    Frictionless,
}

/// Which formulas hold, as an event log shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointMode {
    /// The modes of agonist and antagonist.
    pub actuators: [Mode; 2],
    /// The direction of turning, or sticking.
    pub turning: Turning,
    /// Contacts with the stops at the smallest and at the greatest angle.
    pub stops: [Contact; 2],
    /// The pieces of the tables of both moment arms; 0 for a pulley.
    pub arm_pieces: [usize; 2],
}

/// What happened at an event of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JointEventKind {
    /// The actuator to which it happened, 0 the agonist and 1 the antagonist, or `None` for the joint itself.
    pub actuator: Option<usize>,
    /// What happened.
    pub kind: EventKind,
}

/// A change of mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointEvent<R = f64> {
    /// When, in s.
    pub time: R,
    /// What happened, and to whom.
    pub kind: JointEventKind,
    /// The mode before.
    pub before: JointMode,
    /// The mode after.
    pub after: JointMode,
}

impl<R: Real> JointPlant<R> {
    /// A sample of the plant as one of the joint. While the joint sticks only the torque of both tensions is determined: see
    /// [`ActuatorSample::tension`](crate::plant::ActuatorSample::tension).
    pub fn sample(&self, of: &PlantSample<R>) -> JointSample<R> {
        R::read_joint_sample(self, of)
    }

    pub(crate) fn generic_sample(&self, of: &PlantSample<R>) -> JointSample<R> {
        let mechanism = &of.mechanisms[0];
        let actuators = [0, 1].map(|i| {
            let actuator = &of.actuators[i];
            let feed = self.feeds[i];
            Sample {
                time: of.time,
                length: actuator.distance,
                velocity: actuator.rate,
                pressure: actuator.pressure,
                air_mass: actuator.air_mass,
                temperature: actuator.temperature,
                volume: actuator.volume,
                tension: actuator.tension,
                mass_flow: actuator.mass_flow,
                ports: feed.map_or(Ports::CLOSED, |feed| of.valves[feed.valve].ports),
                hose_pressure: actuator.pressure,
                hose_air_mass: R::zero(),
                supply_pressure: feed.and_then(|feed| feed.port).map(|node| of.nodes[node].pressure),
                load_distance: actuator.distance,
                load_velocity: actuator.rate,
            }
        });
        let (angle, angular_velocity) = (mechanism.position[0], mechanism.rate[0]);
        JointSample { time: of.time, angle, angular_velocity, torque: mechanism.actuator_force[0], actuators }
    }

    /// The flows of each actuator through its valve's flow paths to the supply and to the atmosphere. What flows out to a
    /// pressure regulator it lets go to the atmosphere.
    pub fn valve_flows(&self, of: &PlantSample<R>) -> [[Flow<R>; 2]; 2] {
        self.feeds.map(|feed| {
            let none = Flow { inward: R::zero(), outward: R::zero() };
            let Some(feed) = feed else { return [none; 2] };
            let flow = |path: Option<usize>| {
                let Some(path) = path else { return none };
                let flow = of.branches[path].mass_flow;
                Flow { inward: flow.larger(R::zero()), outward: (-flow).larger(R::zero()) }
            };
            let [supply, exhaust] = feed.paths.map(flow);
            match feed.port {
                None => [supply, exhaust],
                Some(_) => [
                    Flow { outward: R::zero(), ..supply },
                    Flow { inward: exhaust.inward, outward: exhaust.outward + supply.outward },
                ],
            }
        })
    }

    /// The mode of the plant as that of the joint.
    pub fn mode(&self, of: &PlantMode<R>) -> JointMode {
        let actuators = [0, 1].map(|i| {
            let mode = of.actuators[i].mode;
            let Some(feed) = self.feeds[i] else { return mode };
            let [supply_zone, exhaust_zone] =
                feed.paths.map(|path| path.and_then(|path| of.network.branches[path].zone));
            Mode { ports: of.network.valves[feed.valve].ports, supply_zone, exhaust_zone, ..mode }
        });
        let turning = match actuators.map(|mode| mode.sliding) {
            _ if of.mechanisms[0].frozen => Turning::Stuck,
            [Sliding::Shortening, _] | [_, Sliding::Lengthening] => Turning::Forward,
            [Sliding::Lengthening, _] | [_, Sliding::Shortening] => Turning::Backward,
            [Sliding::Stuck, _] | [_, Sliding::Stuck] => Turning::Stuck,
            _ => Turning::Frictionless,
        };
        let arm_pieces = core::array::from_fn(|i| of.arms[self.plant.places().actuators[i].arms]);
        JointMode { actuators, turning, stops: of.mechanisms[0].stops[0], arm_pieces }
    }

    /// What happened to the plant as it happened to the joint; none for a sample that a driver took, which changes no mode.
    pub fn event_kind(&self, of: PlantEventKind) -> Option<JointEventKind> {
        let network = self.plant.network();
        let behind = |node: usize| match network.nodes[node].kind {
            NodeKind::Chamber { actuator } => Some(actuator),
            _ => (0..2).find(|i| self.feeds[*i].is_some_and(|feed| feed.port == Some(node))),
        };
        let actuator = match (of.part, of.kind) {
            (Part::Driver(_), _) => return None,
            // One joint turns both.
            (_, EventKind::Stick | EventKind::Reversal | EventKind::BreakAway) => None,
            (Part::Actuator(i), _) => Some(i),
            (Part::Valve(valve), _) => (0..2).find(|i| self.feeds[*i].is_some_and(|feed| feed.valve == valve)),
            (Part::Branch(branch), _) => behind(network.branches[branch].to),
            (Part::Node(node), _) => behind(node),
            (Part::Mechanism(_) | Part::Joint(..), _) => None,
        };
        Some(JointEventKind { actuator, kind: of.kind })
    }

    /// What a driver of both valves saw and decided, as of the joint. The aims are in their order, those that there are first.
    pub fn decision(&self, of: &PlantDecision<R>) -> Option<JointDecision<R>> {
        let seen = of.seen.of_joint((0, 0), [0, 1])?;
        let aim = [0, 1].map(|i| of.aims.get(i).copied());
        let drive = |i: usize| match of.demands.get(i)? {
            Some(Demand::Request(request)) => Some(Drive::Steady(*request)),
            Some(Demand::Pulses { duty, pulse, rest, .. }) => {
                Some(Drive::Pulses { duty: *duty, pulse: *pulse, rest: *rest })
            }
            _ => None,
        };
        Some(JointDecision { seen, aim, drive: [drive(0)?, drive(1)?] })
    }
}
