//! Values of variables by their references.

use super::{Instance, Kind, Phase, Refusal};
use crate::tunable::changes_parts;
use crate::variables::{Array, Causality, Slot, Variable};
use mckibben_run::host::{CommandInput, CommandMode, GREATEST_MOTION, Motion};

/// Variables that a message names, of more.
const MOST_NAMED: usize = 4;

impl Instance {
    /// The variable of a reference, and how many elements it has.
    fn variable(&self, reference: u32) -> Result<(&Variable, usize), Refusal> {
        let its = self.model.variables().find(reference);
        let its = its.ok_or_else(|| Refusal::error(format!("no variable has the value reference {reference}")))?;
        Ok((its, its.dimension.unwrap_or(1)))
    }

    /// How many values variables have together.
    ///
    /// # Errors
    /// For a reference that no variable has.
    pub fn count(&self, references: &[u32]) -> Result<usize, Refusal> {
        references.iter().try_fold(0, |sum, reference| Ok(sum + self.variable(*reference)?.1))
    }

    /// That there are as many values as the variables have elements.
    fn check_count(&self, references: &[u32], given: usize) -> Result<(), Refusal> {
        let needed = self.count(references)?;
        if needed == given {
            return Ok(());
        }
        let named = references.iter().take(MOST_NAMED).filter_map(|its| self.model.variables().find(*its));
        let mut names: Vec<String> = named.map(|its| format!("`{}`", its.name)).collect();
        if references.len() > MOST_NAMED {
            names.push("…".to_owned());
        }
        let (names, have) = (names.join(", "), if references.len() == 1 { "has" } else { "have" });
        let title = format!("{given} values are given for {names}, which {have} {needed}");
        Err(Refusal::error(format!("{title}; give one for each element")))
    }

    /// Writes the values of variables, the elements of arrays one behind the other.
    ///
    /// # Errors
    /// For a reference that no variable has, another count of values, and a start that the plant cannot have.
    pub fn get(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Refusal> {
        self.check_count(references, values.len())?;
        if matches!(self.phase, Phase::Instantiated | Phase::Initialization) {
            self.refresh_start()?;
        }
        let mut rest = values;
        for reference in references {
            let (its, count) = self.variable(*reference)?;
            let slot = its.slot;
            let (into, behind) = rest.split_at_mut(count);
            self.read(slot, into)?;
            rest = behind;
        }
        Ok(())
    }

    fn read(&mut self, slot: Slot, into: &mut [f64]) -> Result<(), Refusal> {
        match slot {
            Slot::Time => into[0] = self.time(),
            Slot::Command(index) => into[0] = self.inputs.commands[index],
            Slot::Distance(index) => into[0] = self.inputs.distances[index],
            Slot::Rate(index) => into[0] = self.inputs.rates[index],
            Slot::Parameter(index) => into[0] = self.parameters[index],
            Slot::Output(index) => {
                self.refresh_outputs()?;
                into[0] = self.outputs[index];
            }
            Slot::State(index) => into[0] = self.plant.steps().state()[self.model.variables().states[index]],
            Slot::Derivative(index) => {
                let rates = self.rates()?;
                into[0] = rates[index];
            }
            Slot::Indicator(index) => {
                let mut values = vec![0.0; self.model.variables().indicators];
                self.read_indicators(&mut values)?;
                into[0] = values[index];
            }
            Slot::Array(Array::Commands) => into.copy_from_slice(&self.inputs.commands),
            Slot::Array(Array::Distances) => into.copy_from_slice(&self.inputs.distances),
            Slot::Array(Array::Rates) => into.copy_from_slice(&self.inputs.rates),
            Slot::Array(array) => {
                self.refresh_outputs()?;
                let of = match array {
                    Array::Tensions => 0,
                    Array::Pressures => 1,
                    _ => 2,
                };
                for (into, output) in into.iter_mut().zip(&self.model.variables().of_arrays[of]) {
                    *into = self.outputs[*output];
                }
            }
        }
        Ok(())
    }

    /// Computes the outputs where the plant is, unless they are known.
    fn refresh_outputs(&mut self) -> Result<(), Refusal> {
        if !self.are_outputs_known {
            match self.kind {
                Kind::ModelExchange => self.plant.read_placed_outputs(&mut self.outputs)?,
                Kind::CoSimulation { .. } => self.plant.read_outputs(&mut self.outputs)?,
            }
            self.are_outputs_known = true;
        }
        Ok(())
    }

    /// Sets the values of variables, the elements of arrays one behind the other. Of two values of one input the later counts.
    /// Tunable parameters that change while the unit runs take effect at once, all together; in continuous time, at the next event.
    /// So do distances and rates of model exchange, in the mode that holds.
    ///
    /// # Errors
    /// For a reference that no variable has or that is no input and no parameter, another count of values, a value that the
    /// variable does not take, a fixed parameter once initialisation has ended. Then nothing
    /// has changed.
    pub fn set(&mut self, references: &[u32], values: &[f64]) -> Result<(), Refusal> {
        self.check_count(references, values.len())?;
        self.check_phase(&[Phase::Instantiated, Phase::Initialization, Phase::Event, Phase::Step, Phase::Continuous])?;
        let mut rest = values;
        for reference in references {
            let (its, count) = self.variable(*reference)?;
            let (given, behind) = rest.split_at(count);
            self.check_values(its, given)?;
            rest = behind;
        }
        let before = (self.parameters.clone(), self.inputs.clone());
        let mut rest = values;
        for reference in references {
            let (its, count) = self.variable(*reference)?;
            let slot = its.slot;
            let (given, behind) = rest.split_at(count);
            self.write(slot, given);
            rest = behind;
        }
        if matches!(self.phase, Phase::Event | Phase::Step)
            && let Err(refusal) = self.retune()
        {
            (self.parameters, self.inputs) = before;
            return Err(refusal);
        }
        let is_run = matches!(self.phase, Phase::Event | Phase::Continuous);
        if is_run && self.kind == Kind::ModelExchange && self.plant.motion() == Motion::Host {
            self.place_motion()?;
        }
        Ok(())
    }

    /// That a variable may be set now, to these values.
    fn check_values(&self, its: &Variable, given: &[f64]) -> Result<(), Refusal> {
        let is_before = matches!(self.phase, Phase::Instantiated | Phase::Initialization);
        let name = &its.name;
        match its.slot {
            Slot::Parameter(index) => {
                let is_tunable = its.causality == Causality::Parameter { is_tunable: true };
                if !(is_before || is_tunable) {
                    return Err(Refusal::error(format!("`{name}` is fixed: set it before initialisation has ended")));
                }
                let number = &self.model.variables().parameters[index];
                let checked = number.parameter.check(given[0]).map_err(Refusal::from);
                checked.map_err(|refusal| refusal.of_variable(number.parameter.key, name))?;
                if !is_before && changes_parts(number, self.built[index], given[0]) {
                    return Err(Refusal::error(format!(
                        "`{name}` is set from {:?} to {:?}: a run cannot gain or lose it; set it to a small number, or before \
                         initialisation has ended",
                        self.built[index], given[0]
                    )));
                }
            }
            Slot::Command(index) => {
                self.check_command(index, given[0])?;
            }
            Slot::Array(Array::Commands) => {
                given.iter().enumerate().try_for_each(|(index, number)| self.check_command(index, *number))?;
            }
            Slot::Distance(_) | Slot::Array(Array::Distances) => {
                if let Some(wrong) = given.iter().find(|number| !(**number > 0.0 && **number <= GREATEST_MOTION)) {
                    return Err(Refusal::error(format!(
                        "`{name}` = {wrong:?} m is no distance; give one above zero and up to {GREATEST_MOTION:e} m"
                    )));
                }
            }
            Slot::Rate(_) | Slot::Array(Array::Rates) => {
                let is_none = |number: &&f64| number.is_nan() || number.abs() > GREATEST_MOTION;
                if let Some(wrong) = given.iter().find(is_none) {
                    return Err(Refusal::error(format!(
                        "`{name}` = {wrong:?} m/s is no rate; give one from -{GREATEST_MOTION:e} to {GREATEST_MOTION:e} m/s"
                    )));
                }
            }
            _ => return Err(Refusal::error(format!("`{name}` is computed; set inputs and parameters"))),
        }
        Ok(())
    }

    fn check_command(&self, index: usize, number: f64) -> Result<(), Refusal> {
        let Err(refused) = self.plant.check_command(index, number) else { return Ok(()) };
        // Hosts set values in any order, so the supply that feeds a set point may follow: both are checked together when the run
        // begins, and in a run once all values of a call are set.
        let is_open = self.phase != Phase::Continuous || self.parameters != self.built;
        if is_open && self.may_take(index, number) { Ok(()) } else { Err(refused.into()) }
    }

    /// Whether a valve takes a number at some values of the parameters: a set point may be as high as the supply is set.
    pub(super) fn may_take(&self, index: usize, number: f64) -> bool {
        let is_free = |input: &CommandInput| {
            matches!(input.mode, CommandMode::SetPoint { .. }) && input.mode.command(number).is_ok()
        };
        self.plant.accepts(index, number) || self.plant.commands().get(index).is_some_and(is_free)
    }

    fn write(&mut self, slot: Slot, given: &[f64]) {
        let is_before = matches!(self.phase, Phase::Instantiated | Phase::Initialization);
        match slot {
            Slot::Parameter(index) => self.parameters[index] = given[0],
            Slot::Command(index) => self.inputs.commands[index] = given[0],
            Slot::Distance(index) => {
                (self.inputs.distances[index], self.inputs.are_distances_set[index]) = (given[0], true);
            }
            Slot::Rate(index) => (self.inputs.rates[index], self.inputs.are_rates_set[index]) = (given[0], true),
            Slot::Array(Array::Commands) => self.inputs.commands.copy_from_slice(given),
            Slot::Array(Array::Distances) => {
                self.inputs.distances.copy_from_slice(given);
                self.inputs.are_distances_set.fill(true);
            }
            Slot::Array(Array::Rates) => {
                self.inputs.rates.copy_from_slice(given);
                self.inputs.are_rates_set.fill(true);
            }
            _ => {}
        }
        // Commands take effect when the run begins or goes on.
        self.is_stale |= is_before && !matches!(slot, Slot::Command(_) | Slot::Array(Array::Commands));
    }
}
