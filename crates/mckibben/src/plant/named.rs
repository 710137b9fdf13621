//! The linear models of an actuator and of a joint in their own words: names of the states, inputs and outputs of their plants.
//!
//! | of the plant | of one actuator | of a joint |
//! |---|---|---|
//! | position and rate | `length`, `velocity`; on a tendon `load_distance`, `load_velocity` | `angle`, `angular_velocity` |
//! | pressure, air mass | `pressure`, `air_mass` | `agonist_pressure`, `antagonist_pressure`, … |
//! | nodes and branches | `hose_pressure`, `supply_pressure`, `reservoir_pressure`, `regulated_pressure`, … | the same of each, or of neither where both draw from it |

use super::feed::Feed;
use super::linear::{PlantInput, PlantLinearization, PlantOutput, PlantState, PlantStateSpace};
use crate::linearize::{Signal, StateSpace};
use crate::mechanism::Mechanism;
use crate::network::NodeKind;
use crate::plant::Plant;
use crate::valve::Port;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

/// Identities of the actuators of a plant.
pub(super) struct Words<'a> {
    pub(super) plant: &'a Plant,
    /// What feeds each actuator.
    pub(super) feeds: &'a [Feed],
    /// How the names of each begin, and its subscript.
    pub(super) whose: &'static [[&'static str; 2]],
}

/// The words of one actuator, and of agonist and antagonist.
pub(super) const ALONE: &[[&str; 2]] = &[["", ""]];
pub(super) const PAIR: &[[&str; 2]] = &[["agonist_", "₁"], ["antagonist_", "₂"]];

impl Words<'_> {
    fn of(&self, actuator: usize, name: &str, symbol: &str, unit: &'static str) -> Signal {
        let [prefix, subscript] = self.whose[actuator];
        let signal = Signal::new(format!("{prefix}{name}"), unit);
        match symbol {
            "" => signal,
            symbol => signal.with_symbol(format!("{symbol}{subscript}")),
        }
    }

    fn turns(&self) -> bool {
        matches!(self.plant.mechanisms().first(), Some(Mechanism::Chain(_)))
    }

    fn is_on_tendon(&self, actuator: usize) -> bool {
        self.plant.actuators()[actuator].tendon.is_some()
    }

    /// Whose valve it is.
    fn valve(&self, valve: usize) -> usize {
        self.feeds.iter().position(|feed| feed.valve == Some(valve)).unwrap_or(0)
    }

    /// How the name of something of a supply begins: that of both has no owner.
    fn supply(&self, node: usize) -> &'static str {
        let draws = |feed: &Feed| feed.supply.is_some_and(|of| of.outlet == node || of.reservoir == Some(node));
        let mut who = self.feeds.iter().enumerate().filter(|(_, feed)| draws(feed) || feed.port == Some(node));
        match (who.next(), who.next()) {
            (Some((first, _)), None) => self.whose[first][0],
            _ => "",
        }
    }

    fn node(&self, node: usize) -> String {
        for (feed, [prefix, _]) in self.feeds.iter().zip(self.whose) {
            match feed.hose {
                Some([first, 1]) if node == first => return format!("{prefix}hose_pressure"),
                Some([first, count]) if (first..first + count).contains(&node) => {
                    return format!("{prefix}hose_pressure_{}", node - first + 1);
                }
                _ => {}
            }
        }
        let is_outlet = self.feeds.iter().filter_map(|feed| feed.supply).any(|supply| supply.outlet == node);
        let is_port = self.feeds.iter().any(|feed| feed.port == Some(node));
        let name = match (is_port, is_outlet) {
            (true, _) => "regulated_pressure",
            (false, true) => "supply_pressure",
            (false, false) => "reservoir_pressure",
        };
        format!("{}{name}", self.supply(node))
    }

    fn position(&self, velocity: bool) -> Signal {
        let [angle, load, length] = match velocity {
            false => [("angle", "θ", "rad"), ("load_distance", "x", "m"), ("length", "L", "m")],
            true => [("angular_velocity", "ω", "rad/s"), ("load_velocity", "ẋ", "m/s"), ("velocity", "v", "m/s")],
        };
        let (name, symbol, unit) = match (self.turns(), self.is_on_tendon(0)) {
            (true, _) => angle,
            (false, true) => load,
            (false, false) => length,
        };
        Signal::new(name, unit).with_symbol(symbol)
    }

    pub(super) fn state(&self, of: &PlantState) -> Signal {
        match *of {
            PlantState::Position { .. } => self.position(false),
            PlantState::Velocity { .. } => self.position(true),
            PlantState::Pressure { actuator } => self.of(actuator, "pressure", "P", "Pa"),
            PlantState::AirMass { actuator } => self.of(actuator, "air_mass", "m", "kg"),
            PlantState::Length { actuator } => self.of(actuator, "length", "L", "m"),
            PlantState::Bristles { actuator } => self.of(actuator, "bristles", "z", "m"),
            PlantState::Branch { actuator, branch } => {
                self.of(actuator, &format!("relaxed_length_{}", branch + 1), "z", "m")
            }
            PlantState::NodePressure { node } => Signal::new(self.node(node), of.unit(self.plant)),
            PlantState::BranchFlow { branch } => {
                let from = self.plant.network().branches[branch].from;
                Signal::new(self.node(from).replace("pressure", "flow"), of.unit(self.plant))
            }
            PlantState::SpoolPosition { valve } => self.of(self.valve(valve), "spool_position", "", ""),
            PlantState::SpoolVelocity { valve } => self.of(self.valve(valve), "spool_velocity", "", "1/s"),
        }
    }

    pub(super) fn input(&self, of: &PlantInput) -> Signal {
        match *of {
            PlantInput::Duty { valve } => self.of(self.valve(valve), "duty", "d", ""),
            PlantInput::SetPoint { valve } => self.of(self.valve(valve), "set_point", "", "Pa"),
            PlantInput::SpoolCommand { valve } => self.of(self.valve(valve), "spool_command", "", ""),
            PlantInput::Opening { valve, port } => {
                let name = match port {
                    Port::Supply => "supply_opening",
                    Port::Exhaust => "exhaust_opening",
                };
                self.of(self.valve(valve), name, "", "")
            }
            PlantInput::SupplyPressure { node } => {
                let name = match self.plant.network().nodes[node].kind {
                    NodeKind::Outlet { .. } => "supply_set_point",
                    _ => "supply_pressure",
                };
                Signal::new(format!("{}{name}", self.supply(node)), "Pa")
            }
            PlantInput::MassFlow { actuator } => self.of(actuator, "mass_flow", "ṁ", "kg/s"),
            PlantInput::NodeFlow { node } => Signal::new(format!("{}reservoir_mass_flow", self.supply(node)), "kg/s"),
            PlantInput::Force { .. } => match self.turns() {
                true => Signal::new("torque", "N*m").with_symbol("W"),
                false => Signal::new("force", "N").with_symbol("W"),
            },
            PlantInput::Motion { .. } => Signal::new("motion", of.unit(self.plant)),
            PlantInput::MotionRate { .. } => Signal::new("motion_rate", of.unit(self.plant)),
            PlantInput::GivenPressure { actuator } => self.of(actuator, "given_pressure", "P", "Pa"),
        }
    }

    pub(super) fn output(&self, of: &PlantOutput) -> Signal {
        match *of {
            PlantOutput::Length { actuator } => self.of(actuator, "length", "L", "m"),
            PlantOutput::LengthRate { actuator } => self.of(actuator, "velocity", "v", "m/s"),
            PlantOutput::Pressure { actuator } => self.of(actuator, "pressure", "P", "Pa"),
            PlantOutput::Tension { actuator } => self.of(actuator, "tension", "F", "N"),
            PlantOutput::Position { .. } => self.position(false),
            PlantOutput::Velocity { .. } => self.position(true),
            PlantOutput::ActuatorForce { .. } => match self.turns() {
                true => Signal::new("actuator_torque", "N*m").with_symbol("τ"),
                false => Signal::new("actuator_force", "N"),
            },
            PlantOutput::NodePressure { node } => Signal::new(self.node(node), of.unit(self.plant)),
        }
    }

    /// Where a state stands among those of one actuator or a joint.
    fn state_rank(&self, of: &PlantState) -> usize {
        match of {
            PlantState::Position { .. } | PlantState::Velocity { .. } => 0,
            PlantState::Length { .. } | PlantState::Bristles { .. } | PlantState::Branch { .. } if !self.turns() => 1,
            PlantState::Pressure { .. } | PlantState::AirMass { .. } => 2,
            PlantState::Length { .. } | PlantState::Bristles { .. } | PlantState::Branch { .. } => 3,
            _ => 4,
        }
    }

    fn input_rank(of: &PlantInput) -> usize {
        match of {
            PlantInput::Duty { .. } | PlantInput::SetPoint { .. } | PlantInput::SpoolCommand { .. } => 0,
            PlantInput::GivenPressure { .. } => 1,
            PlantInput::MassFlow { .. } => 2,
            PlantInput::Force { .. } => 3,
            _ => 4,
        }
    }

    /// Where an output stands, unless another says the same.
    fn output_rank(&self, of: &PlantOutput) -> Option<usize> {
        let moves = |actuator: usize| {
            let mechanism = &self.plant.mechanisms()[self.plant.actuators()[actuator].mechanism];
            mechanism.is_dynamic() || self.is_on_tendon(actuator)
        };
        match (*of, self.turns()) {
            (PlantOutput::Position { .. } | PlantOutput::Velocity { .. }, true) => Some(0),
            (PlantOutput::Pressure { .. }, true) => Some(1),
            (PlantOutput::ActuatorForce { .. }, turns) => turns.then_some(2),
            (PlantOutput::Length { actuator } | PlantOutput::LengthRate { actuator }, false) => {
                moves(actuator).then_some(0)
            }
            (PlantOutput::Position { .. } | PlantOutput::Velocity { .. }, false) => self.is_on_tendon(0).then_some(1),
            (PlantOutput::Pressure { .. }, false) => Some(2),
            (PlantOutput::NodePressure { .. }, _) => Some(4),
            _ => Some(3),
        }
    }

    /// A model of the plant with names: first what every actuator or joint has, then what else is there.
    pub(super) fn named(&self, system: &PlantStateSpace) -> StateSpace {
        let states = system.states.iter().map(|of| Some((self.state_rank(of), self.state(of))));
        let inputs = system.inputs.iter().map(|of| Some((Self::input_rank(of), self.input(of))));
        let outputs = system.outputs.iter().map(|of| Some((self.output_rank(of)?, self.output(of))));
        system.named([ranked(states), ranked(inputs), ranked(outputs)])
    }

    /// The sizes by which controllability measures the states of a named model of a linearisation.
    #[cfg(feature = "analysis")]
    pub(super) fn controllability(
        &self,
        linear: &PlantLinearization,
        system: &StateSpace,
        input: usize,
    ) -> Result<crate::linearize::Controllability, crate::Error> {
        let known: Vec<(String, _)> =
            linear.system.states.iter().map(|of| (self.state(of).name, linear.usual_size(of))).collect();
        let other = crate::linearize::UsualSize { size: 1.0, is_rate: false };
        let of = |signal: &Signal| known.iter().find(|(name, _)| *name == signal.name).map_or(other, |(_, size)| *size);
        let sizes: Vec<_> = system.states.iter().map(of).collect();
        system.controllability(input, &sizes)
    }

    /// The values of the inputs at the point of a linearisation, each by its name.
    pub(super) fn inputs(&self, linear: &PlantLinearization) -> Vec<(Signal, f64)> {
        linear.point.inputs.iter().map(|(input, value)| (self.input(input), *value)).collect()
    }
}

/// The places of those that have a rank, by that and then in their own order.
fn ranked(of: impl Iterator<Item = Option<(usize, Signal)>>) -> Vec<(usize, Signal)> {
    let mut ranked: Vec<(usize, usize, Signal)> =
        of.enumerate().filter_map(|(place, it)| it.map(|(rank, signal)| (rank, place, signal))).collect();
    ranked.sort_by_key(|(rank, place, _)| (*rank, *place));
    ranked.into_iter().map(|(_, place, signal)| (place, signal)).collect()
}
