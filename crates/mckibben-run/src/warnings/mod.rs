//! Warnings for what a scenario cannot mean: it runs, and its result is not what anyone builds.
//!
//! A warning has a code, the actuator that it is of, and one sentence with the quantity, its value, the limit, and what to change.
//!
//! | code | when | known |
//! |---|---|---|
//! | `valve-never-opens` | a path that the command requests stays shut: its pulses are shorter than the delay | before |
//! | `valve-never-closes` | a path stays open: the pauses of the command are shorter than the delay | before |
//! | `supply-exceeded` | a controller may request a pressure that supply and atmosphere cannot make; of linear models, that of the point | before |
//! | `set-point-beyond` | a controller is to reach a length that the muscle never has | before |
//! | `effectiveness` | the effectiveness is above [`EFFECTIVENESS`] | before |
//! | `preset-length` | a law of force with the wall of a preset is that of a muscle of another length, by more than [`STRETCH`] | before |
//! | `starts-slack` | an actuator starts shorter than `actuator.min_length`, or with both ends at one point | before |
//! | `beyond-stop` | a joint starts beyond one of its stops, and not at rest against it | before |
//! | `overstretched` | an actuator is longer than its taut length by more than [`STRETCH`] | both |
//! | `pressure` | a gauge pressure is above [`PRESSURE`] | both |
//! | `tension` | a tension is above what the ideal braid makes at [`STRENGTH`] and its taut length | after |
//! | `thrown` | the load passes the attachment: the distance falls below zero | after |
//! | `law-extrapolated` | a measured map or effectiveness is used beyond its table | after |
//! | `law-negative` | the static force of an actuator that is not slack is below zero | after |
//! | `energy-open` | more than [`OPEN`] of the work and energy, the exergy or the air of a run does not close: fixed steps that are too long | after |
//!
//! The limits are conventions. None is a limit of the equations, which go on beyond:
//!
//! - [`PRESSURE`], 20 bar: chosen, nearly three times the 7 bar (100 psi) of the paper's experiments; no source states what braids hold.
//! - [`STRETCH`], 5 %: a load that falls onto the taut braid stretches it by up to 4.4 % in this project's examples, with the assumed
//!   stiffness, and springs back. Beyond 5 % the straight line of `actuator.limit.stiffness` is no longer that of a taut thread.
//! - [`STRENGTH`], 50 bar: chosen, so that an impact on the taut braid in this project's examples stays below. The tension is compared
//!   with what the same braid makes then, so that the limit grows with the muscle.
//! - [`EFFECTIVENESS`], 2: chosen. Measured ones lie below 1 or little above; a number in percent is far above.
//! - [`OPEN`], 2 %: chosen. Steps that `run.accuracy` chooses leave less than a quarter of it in this project's examples; steps of 1 ms
//!   leave 15 % of the work of `examples/fill-hold-exhaust.toml`, whose length is then off by a quarter of its way. What the tolerance
//!   of a run may leave whatever is turned over ([`Balance::resolution`]) is not counted.
//! - [`NEGATIVE`], 5 %: a law that falls to zero at full contraction may miss it by the rounding of its coefficients.
//!
//! Checked by the tests below and by the program's `tests/warnings.rs`.

mod before;
mod reached;
mod valve;

pub(crate) use before::feed_of;
pub(crate) use reached::Reached;

use crate::joint::NAMES;
use crate::plant;
use crate::quantities::{given, percent, plain, quantity};
use crate::run::{Figures, Ready};
use crate::units::units;
use mckibben::control::{Controller as _, JointController as _, Quantity, RegulatorMemory, Sampling, SetPoint};
use mckibben::network::{Network, NodeKind};
use mckibben::plant::{Balance, JointPlant, Part, Plant, PlantLedger, PlantStart, RigPlant};
use mckibben::simulation::JointState;
use mckibben_scenario::{GreatestRequest, PlantControl, PlantExperiment, PlantNames};
use std::fmt;

/// Gauge pressure in Pa above which a scenario is doubted: chosen.
pub const PRESSURE: f64 = 20e5;
/// Gauge pressure in Pa at which the force of the ideal braid at its taut length is the largest tension that is not doubted: chosen.
pub const STRENGTH: f64 = 50e5;
/// Stretch beyond the taut length, as a share of it, up to which the stiffness of the taut braid describes it.
pub const STRETCH: f64 = 0.05;
/// Measured over ideal force above which an effectiveness is doubted: chosen.
pub const EFFECTIVENESS: f64 = 2.0;
/// Force below zero, as a share of the largest force of the run, that is more than rounding of a law's coefficients.
pub const NEGATIVE: f64 = 0.05;

/// That an actuator is longer than its taut length by more than [`STRETCH`].
const OVERSTRETCHED: &str = "overstretched";
/// What a file calls the one supply, the one mechanism and the load of an actuator, which have no names.
const SUPPLY: &str = "supply";
const MECHANISM: &str = "mechanism";
const LOAD: &str = "load";
/// That a joint starts beyond a stop.
const BEYOND_STOP: &str = "beyond-stop";
/// The angle in rad by which a joint may miss its equilibrium and be at rest.
const AT_REST: f64 = 1e-9;

/// Part of the turnover up to which a run may leave a balance open: chosen.
pub const OPEN: f64 = 0.02;

/// Something that a scenario cannot mean.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What it is, in a short word, such as `valve-never-opens`.
    pub code: &'static str,
    /// The actuator or part that it is of; empty where there is one actuator.
    pub part: String,
    /// One sentence: the quantity, its value, the limit, and what to change.
    pub text: String,
}

impl Warning {
    fn new(code: &'static str, part: &str, text: String) -> Self {
        Self { code, part: part.to_owned(), text }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.part.as_str() {
            "" => f.write_str(&self.text),
            part => write!(f, "{part}: {}", self.text),
        }
    }
}

/// Two values that a user gave and a warning compares, in four digits, or in as many as it takes to see that they differ.
fn compared(values: [f64; 2], unit: &str) -> [String; 2] {
    let short = values.map(|value| given(value, unit));
    if short[0] != short[1] {
        return short;
    }
    let shown = units().common(unit, values);
    let long = |decimals: usize| values.map(|value| shown.with(plain(&format!("{:.decimals$}", shown.number(value)))));
    (1..=f64::DIGITS as usize).map(long).find(|[one, other]| one != other).unwrap_or(short)
}

/// The warnings of a run: those known before it and those that follow from what it reached, each actuator once for a code. What a run
/// reached says more than what was known, but that an actuator started too long is why it was.
pub fn of_run(before: Vec<Warning>, figures: &Figures) -> Vec<Warning> {
    joined(before, figures.warnings())
}

fn joined(before: Vec<Warning>, after: Vec<Warning>) -> Vec<Warning> {
    let mut all = before;
    for new in after {
        match all.iter_mut().find(|known| (known.code, &known.part) == (new.code, &new.part)) {
            Some(_) if new.code == OVERSTRETCHED => {}
            Some(known) => *known = new,
            None => all.push(new),
        }
    }
    all
}

impl Ready {
    /// The warnings of a run in which its actuators reached these extremes; of none those that are known before.
    pub(crate) fn warnings_with(&self, reached: &[Reached]) -> Vec<Warning> {
        let of_rig = |rig| reached::warnings(&Parts::named(RigPlant::new(rig).plant(), &[""]), reached);
        let of_joint = |rig| match JointPlant::new(rig) {
            Ok(view) => reached::warnings(&Parts::named(view.plant(), &NAMES), reached),
            Err(_) => Vec::new(),
        };
        let after = match self {
            _ if reached.is_empty() => Vec::new(),
            Self::Actuator(of) => of_rig(&of.rig),
            Self::Controlled(of) => of_rig(&of.experiment.rig),
            Self::Joint(of) => of_joint(&of.rig),
            Self::ControlledJoint(of) => of_joint(&of.experiment.rig),
            Self::Plant(of) => reached::warnings(&Parts::of(of), reached),
        };
        joined(self.warnings(), after)
    }

    /// The warnings that are known before anything is simulated.
    pub fn warnings(&self) -> Vec<Warning> {
        match self {
            Self::Actuator(of) => of_rig(&of.rig, |of_rig| of_rig.start(&of.start), None),
            Self::Controlled(of) => {
                let (rig, start) = (&of.experiment.rig, of.experiment.start);
                let loop_of = Loop {
                    request: of.greatest_request,
                    set_points: &of.set_points,
                    pulses: pulses(&of.law.begin(), &of.sampling),
                    actuators: &[0],
                    valves: &[0],
                };
                of_rig(rig, |of_rig| of_rig.start(&start), Some(loop_of))
            }
            Self::Joint(of) => of_joint(&of.rig, &of.start, None),
            Self::ControlledJoint(of) => {
                let loop_of = Loop {
                    request: of.greatest_request,
                    set_points: &of.set_points,
                    pulses: pulses(&of.law.begin()[0], &of.sampling),
                    actuators: &[],
                    valves: &[0, 1],
                };
                of_joint(&of.experiment.rig, &of.experiment.start, Some(loop_of))
            }
            Self::Plant(of) => Parts::of(of).warnings(&of.start, of.controls.iter().map(Loop::of_plant)),
        }
    }
}

/// What of a controller is known before a run.
struct Loop<'c> {
    /// The greatest gauge pressure that it may request, where it requests any.
    request: Option<GreatestRequest>,
    set_points: &'c [(Quantity, SetPoint)],
    /// When it samples and pulses, where it commands pulses.
    pulses: Option<&'c Sampling>,
    /// The actuator of a controller that regulates one.
    actuators: &'c [usize],
    valves: &'c [usize],
}

/// When a regulator samples and pulses, where it commands pulses, as a PID does.
fn pulses<'c>(regulator: &RegulatorMemory, sampling: &'c Sampling) -> Option<&'c Sampling> {
    matches!(regulator, RegulatorMemory::Pid(_)).then_some(sampling)
}

impl<'c> Loop<'c> {
    fn of_plant(of: &'c PlantControl) -> Self {
        match of {
            PlantControl::Actuator(of) => Self {
                request: of.greatest_request,
                set_points: &of.set_points,
                pulses: pulses(&of.law.begin(), &of.sampling),
                actuators: core::slice::from_ref(&of.actuator),
                valves: core::slice::from_ref(&of.valve),
            },
            PlantControl::Joint(of) => Self {
                request: of.greatest_request,
                set_points: &of.set_points,
                pulses: pulses(&of.law.begin()[0], &of.sampling),
                actuators: &[],
                valves: &of.valves,
            },
        }
    }
}

fn of_rig(
    rig: &mckibben::simulation::Rig,
    start: impl FnOnce(&RigPlant) -> PlantStart,
    controller: Option<Loop<'_>>,
) -> Vec<Warning> {
    let view = RigPlant::new(rig);
    Parts::named(view.plant(), &[""]).warnings(&start(&view), controller)
}

fn of_joint(rig: &mckibben::simulation::JointRig, state: &JointState, controller: Option<Loop<'_>>) -> Vec<Warning> {
    // A joint that was read has been checked; what cannot be built fails in the run, which says why.
    let Ok(view) = JointPlant::new(rig) else { return Vec::new() };
    let mut found = Parts::named(view.plant(), &NAMES).warnings(&view.start(state), controller);
    // A joint that starts where its torques balance may rest against a stop, which gives way by what presses it.
    let rests = |angle: f64| (state.angle - angle).abs() <= AT_REST;
    if found.iter().any(|of| of.code == BEYOND_STOP) && rig.equilibrium(state.pressure).is_ok_and(rests) {
        found.retain(|of| of.code != BEYOND_STOP);
    }
    found
}

impl Figures {
    /// The warnings that follow from what a run reached, and from how far its balances close.
    pub fn warnings(&self) -> Vec<Warning> {
        let (mut found, ended) = match self {
            Self::Actuator(of) => {
                let (view, seen) = (RigPlant::new(&of.rig), &of.observation);
                (reached::warnings(&Parts::named(view.plant(), &[""]), &seen.reached), &seen.ended)
            }
            Self::Joint(of) => {
                let seen = &of.observation;
                // A joint that has run has been built.
                let view = JointPlant::new(&of.rig).ok();
                let of_view = |view: &JointPlant| reached::warnings(&Parts::named(view.plant(), &NAMES), &seen.reached);
                (view.as_ref().map(of_view).unwrap_or_default(), &seen.ended)
            }
            Self::Plant(of) => {
                let seen = &of.observation;
                (reached::warnings(&Parts::of(&of.experiment), &seen.reached), &seen.ended)
            }
        };
        found.extend(open_balance(&ended.ledger, ended.draws));
        found
    }
}

/// That steps are so long that energy, exergy or air comes from nowhere or is lost. Only a run that draws air through valves has
/// balances of exergy and air.
fn open_balance(ledger: &PlantLedger, draws: bool) -> Option<Warning> {
    let of_air = draws.then(|| [("exergy", "J", ledger.exergy()), ("air", "kg", ledger.air())]);
    let balances = [("work and energy", "J", ledger.work())].into_iter().chain(of_air.into_iter().flatten());
    let share = |(name, unit, of): (&str, &str, Balance)| {
        let [residual, turnover] = [of.residual.abs(), of.turnover].map(|value| quantity(value, unit));
        format!("{} of its {name} ({residual} of {turnover})", percent(of.residual.abs() / of.turnover))
    };
    // Numbers that are none are refused elsewhere: they say nothing of the steps.
    let is_open = |of: &Balance| (of.residual + of.turnover).is_finite() && !of.closes(OPEN);
    let open: Vec<String> = balances.filter(|(.., balance)| is_open(balance)).map(share).collect();
    (!open.is_empty()).then(|| {
        let text = format!(
            "the steps are too long for this run: {} comes from nowhere or is lost; give a shorter run.step, or leave it out",
            open.join(" and "),
        );
        Warning::new("energy-open", "", text)
    })
}

/// A plant with the names of its actuators and valves, and what else its file names, where it is the file of a plant.
struct Parts<'p> {
    plant: &'p Plant,
    actuators: Vec<String>,
    valves: Vec<String>,
    names: Option<&'p PlantNames>,
}

impl<'p> Parts<'p> {
    /// The warnings before a run from a start, under controllers.
    fn warnings<'c>(&self, start: &PlantStart, controllers: impl IntoIterator<Item = Loop<'c>>) -> Vec<Warning> {
        let mut found = before::warnings(self, start);
        found.extend(controllers.into_iter().flat_map(|controller| before::of_controller(self, &controller)));
        found
    }

    /// Of a plant whose valves have the names of the actuators that they feed.
    fn named(plant: &'p Plant, names: &[&str]) -> Self {
        let actuators: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let of = |valve| fed(plant.network(), valve).and_then(|index| actuators.get(index).cloned());
        let valves = (0..plant.network().valves.len()).map(|valve| of(valve).unwrap_or_default()).collect();
        Self { plant, actuators, valves, names: None }
    }

    /// Of a plant whose file names its parts.
    fn of(of: &'p PlantExperiment) -> Self {
        let valves = 0..of.plant.network().valves.len();
        Self {
            plant: &of.plant,
            actuators: of.names.actuators.clone(),
            valves: valves.map(|valve| plant::name_of(of, Part::Valve(valve)).to_owned()).collect(),
            names: Some(&of.names),
        }
    }

    /// The name of a joint of a chain; that of two actuators has none.
    fn joint(&self, mechanism: usize, joint: usize) -> &str {
        let names = self.names.and_then(|names| names.mechanisms.get(mechanism));
        names.and_then(|names| names.joints.get(joint)).map_or("", String::as_str)
    }

    /// The path of a section of a mechanism: `load` where an actuator has it alone.
    fn section_of(&self, mechanism: usize) -> String {
        match self.names.and_then(|names| names.mechanisms.get(mechanism)?.name.as_deref()) {
            None => LOAD.to_owned(),
            Some(name) if name == MECHANISM => name.to_owned(),
            Some(name) => format!("mechanisms.{name}"),
        }
    }

    /// The path of a key of the supply that a node of the network is, such as `supplies.tank.gauge_pressure`, from that of
    /// `[supply]`.
    fn key_of_supply(&self, node: usize, key: &str) -> String {
        let name = self.names.and_then(|names| names.nodes.iter().find(|(_, its)| *its == node));
        let Some(name) = name.map(|(name, _)| name.strip_suffix(".reservoir").unwrap_or(name)) else {
            return key.to_owned();
        };
        match (name, key.strip_prefix("supply.")) {
            (SUPPLY, _) | (_, None) => key.to_owned(),
            // The supply of one actuator is called after it.
            (name, Some(_)) if name.contains('.') => {
                format!("actuators.{}.{key}", name.split('.').next().unwrap_or_default())
            }
            (name, Some(own)) => format!("supplies.{name}.{own}"),
        }
    }
}

/// The actuator that a valve feeds, through a hose or a manifold the first.
fn fed(network: &Network, valve: usize) -> Option<usize> {
    use mckibben::network::BranchKind;
    let is_its = |kind: &BranchKind| matches!(kind, BranchKind::Path { valve: its, .. } if *its == valve);
    behind(network, network.branches.iter().find(|branch| is_its(&branch.kind))?.to)
}

/// The first actuator behind a node of the network, or at it.
fn behind(network: &Network, mut node: usize) -> Option<usize> {
    for _ in 0..=network.branches.len() {
        if let NodeKind::Chamber { actuator } = network.nodes[node].kind {
            return Some(actuator);
        }
        node = network.branches.iter().find(|branch| branch.from == node)?.to;
    }
    None
}

#[cfg(test)]
mod tests;
