//! Legs of six actuators each.

use super::alone::Kind;
use super::leg_numbers::{KNOWN, Posed};
use super::numbers::Numbers;
use crate::scenario::Scenario;
use mckibben::Error;
use mckibben::control::Drive;
use mckibben::load::leg::STRANDS;
use mckibben::simulation::LegStepper;
use mckibben_cli::failure::Failure;
use pyo3::prelude::*;

/// Prefix of the numbers of the leg itself.
const OF_LEG: &str = "leg.";
/// Prefix of those of one strand's actuator, before its number.
const OF_STRAND: &str = "strands[";

/// Legs on the actuator of a scenario, one for each strand.
pub(super) struct Legs {
    posed: Posed,
    /// Paths of numbers of the leg, with where their values are.
    of_leg: Vec<(usize, String)>,
    /// Those of each strand's actuator; one for all where no strand has its own.
    strands: Vec<Numbers>,
    /// In Hz.
    pulse_frequency: f64,
}

impl Legs {
    /// Legs whose numbers `set` are others than assumed, and those `by` which each leg has its own.
    pub(super) fn new(
        py: Python<'_>,
        scenario: &Py<Scenario>,
        by: &[String],
        set: &[(String, f64)],
        pulse_frequency: f64,
    ) -> Result<Self, Failure> {
        let mut posed = Posed::assumed();
        for (path, value) in set {
            *number(&mut posed, path)? = *value;
        }
        let (mut of_leg, mut of_all, mut of_one) = (Vec::new(), Vec::new(), vec![Vec::new(); STRANDS]);
        for (which, path) in by.iter().enumerate() {
            if path.starts_with(OF_LEG) {
                number(&mut posed, path)?;
                of_leg.push((which, path.clone()));
            } else if let Some((strand, path)) = path.strip_prefix(OF_STRAND).and_then(|rest| rest.split_once("].")) {
                let strand = strand.parse::<usize>().ok().filter(|strand| *strand < STRANDS);
                let strand = strand.ok_or_else(|| {
                    Failure::input(format!("a leg has no such strand: `{path}`"), "count them from 0 to 5")
                })?;
                of_one[strand].push((which, path));
            } else {
                of_all.push((which, path.as_str()));
            }
        }
        let alike = of_one.iter().all(Vec::is_empty);
        let of = |own: &Vec<(usize, &str)>| {
            Numbers::find(scenario.clone_ref(py), &[of_all.as_slice(), own.as_slice()].concat())
        };
        let strands = of_one.iter().take(if alike { 1 } else { STRANDS }).map(of).collect::<Result<_, _>>()?;
        Ok(Self { posed, of_leg, strands, pulse_frequency })
    }

    /// What each number is in the scenario and the assumed leg, with where it is among all.
    pub(super) fn given(&self) -> Vec<(usize, f64)> {
        let mut posed = self.posed;
        let of_leg =
            self.of_leg.iter().map(|(which, path)| (*which, number(&mut posed, path).map_or(f64::NAN, |n| *n)));
        let of_leg: Vec<_> = of_leg.collect();
        of_leg.into_iter().chain(self.strands.iter().flat_map(Numbers::given)).collect()
    }
}

/// The number of a leg at a path with its prefix.
fn number<'a>(posed: &'a mut Posed, path: &str) -> Result<&'a mut f64, Failure> {
    let number = path.strip_prefix(OF_LEG).and_then(|path| posed.number(path));
    number.ok_or_else(|| Failure::input(format!("`{path}` is no number of a leg"), format!("name one of {KNOWN}")))
}

impl Kind<STRANDS> for Legs {
    type Plant = LegStepper;

    fn columns(&self) -> Vec<String> {
        let of_joints = ["hip", "knee"].map(|joint| format!("{joint}_angle_rad"));
        let of_rates = ["hip", "knee"].map(|joint| format!("{joint}_angular_velocity_rad_s"));
        let pressures = (0..STRANDS).map(|strand| format!("pressure_{strand}_pa"));
        let of_foot = ["foot_x_m", "foot_y_m"].map(str::to_owned);
        of_joints.into_iter().chain(of_rates).chain(pressures).chain(of_foot).collect()
    }

    fn begin(&self, values: &[f64]) -> Result<LegStepper, Failure> {
        let mut posed = self.posed;
        for (which, path) in &self.of_leg {
            *number(&mut posed, path)? = values[*which];
        }
        let made = self.strands.iter().map(|strand| strand.with(values, |s| Ok((s.rig()?, s.initial()))));
        let made = made.collect::<Result<Vec<_>, _>>()?;
        let strand = |strand: usize| {
            let (rig, initial) = &made[if made.len() == 1 { 0 } else { strand }];
            (rig, initial.gauge_pressure)
        };
        let temperature = made[0].1.temperature;
        LegStepper::new(posed.leg, posed.state, core::array::from_fn(strand), temperature, self.pulse_frequency)
            .map_err(|error| self.strands[0].failed(&error))
    }

    fn drive(leg: &mut LegStepper, drives: [Drive; STRANDS]) -> Result<(), Error> {
        leg.drive(drives)
    }

    fn advance_to(leg: &mut LegStepper, until: f64) -> Result<(), Error> {
        leg.advance_to(until)
    }

    fn show(leg: &LegStepper, into: &mut [f64]) {
        let state = leg.state();
        let [_, foot] = leg.leg().places(&state.angles);
        let pressures = leg.actuators().each_ref().map(|actuator| actuator.state().pressure.0);
        let shown = state.angles.into_iter().chain(state.rates).chain(pressures).chain(foot);
        into.iter_mut().zip(shown).for_each(|(into, number)| *into = number);
    }
}
