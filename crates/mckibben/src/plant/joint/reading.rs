//! What a plant is doing, in the words of the joint that it is.

use super::JointPlant;
use crate::air::Flow;
use crate::command::PlantDecision;
use crate::instantiate::Instantiate;
use crate::mechanism::Contact;
use crate::network::NodeKind;
use crate::plant::{Feed, Part, PlantEventKind, PlantMode, PlantSample, SupplyNodes};
use crate::simulation::{EventKind, JointDecision, JointSample, Mode, Sliding};

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

/// Which formulas hold, as an event log reports it.
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
    /// The actuator to which it happened, 0 the agonist and 1 the antagonist, or `None` for the joint itself and for a supply
    /// that both draw from.
    pub actuator: Option<usize>,
    /// What happened.
    pub kind: EventKind,
}

/// A change of mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointEvent<R = f64> {
    /// When, in s.
    pub time: R,
    /// What happened, and to which part.
    pub kind: JointEventKind,
    /// The mode before.
    pub before: JointMode,
    /// The mode after.
    pub after: JointMode,
}

impl<R: Instantiate> JointPlant<R> {
    /// A sample of the plant as one of the joint. While the joint sticks only the torque of both tensions is determined: see
    /// [`ActuatorSample::tension`](crate::plant::ActuatorSample::tension).
    pub fn sample(&self, of: &PlantSample<R>) -> JointSample<R> {
        let mechanism = &of.mechanisms[0];
        let actuators = [0, 1].map(|i| self.feeds[i].sample(&self.plant, i, of));
        let (angle, angular_velocity) = (mechanism.position[0], mechanism.rate[0]);
        JointSample { time: of.time, angle, angular_velocity, torque: mechanism.actuator_force[0], actuators }
    }

    /// The flows of each actuator through its valve's flow paths to the supply and to the atmosphere. What flows out to a
    /// pressure regulator it lets go to the atmosphere.
    pub fn valve_flows(&self, of: &PlantSample<R>) -> [[Flow<R>; 2]; 2] {
        self.feeds.each_ref().map(|feed| feed.flows(of))
    }

    /// The mode of the plant as that of the joint.
    pub fn mode(&self, of: &PlantMode<R>) -> JointMode {
        let actuators = [0, 1].map(|i| self.feeds[i].mode(i, of));
        // On a tendon an end slides independently, and its friction does not depend on the joint's velocity.
        let sliding = |i: usize| match self.plant.actuators()[i].tendon {
            Some(_) => Sliding::Frictionless,
            None => actuators[i].sliding,
        };
        let turning = match [0, 1].map(sliding) {
            _ if of.mechanisms[0].frozen => Turning::Stuck,
            [Sliding::Shortening, _] | [_, Sliding::Lengthening] => Turning::Forward,
            [Sliding::Lengthening, _] | [_, Sliding::Shortening] => Turning::Backward,
            [Sliding::Stuck, _] | [_, Sliding::Stuck] => Turning::Stuck,
            _ => Turning::Frictionless,
        };
        let arm_pieces = core::array::from_fn(|i| of.arms[self.plant.indices().actuators[i].arms]);
        JointMode { actuators, turning, stops: of.mechanisms[0].stops[0], arm_pieces }
    }

    /// What happened to the plant as it happened to the joint; of a supply that both actuators draw from, to neither. None for a sample that a driver took, which changes no mode.
    pub fn event_kind(&self, of: PlantEventKind) -> Option<JointEventKind> {
        let network = self.plant.network();
        let shares = self.rig.shared_supply().is_some();
        let behind = |node: usize| match network.nodes[node].kind {
            NodeKind::Chamber { actuator } => Some(actuator),
            _ => (0..2).find(|i| {
                let Feed { port, hose, supply, .. } = self.feeds[*i];
                let is_its = |of: SupplyNodes| !shares && [of.reservoir, Some(of.outlet)].contains(&Some(node));
                port == Some(node)
                    || hose.is_some_and(|[first, count]| (first..first + count).contains(&node))
                    || supply.is_some_and(is_its)
            }),
        };
        let actuator = match (of.part, of.kind) {
            (Part::Driver(_), _) => return None,
            // The end of an actuator on a tendon moves independently; else one joint turns both.
            (Part::Actuator(i), _) if self.plant.actuators()[i].tendon.is_some() => Some(i),
            (_, EventKind::Stick | EventKind::Reversal | EventKind::BreakAway) => None,
            (Part::Actuator(i), _) => Some(i),
            (Part::Valve(valve), _) => (0..2).find(|i| self.feeds[*i].valve == Some(valve)),
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
        Some(JointDecision { seen, aim, drive: [of.drive(0)?, of.drive(1)?] })
    }
}
