//! Directional derivatives: exact, of rates, outputs and event indicators with respect to continuous states and the motion of
//! the ends, in the mode that holds.

use super::{Instance, Refusal};
use crate::variables::{Array, Slot};
use mckibben::plant::PlantSample;
use mckibben_scenario::PlantColumn;

impl Instance {
    /// Writes how unknowns change where knowns change by `seed`, the elements of arrays one behind the other.
    ///
    /// # Errors
    /// Before initialisation; for a reference that no variable has, another count of numbers; for a known that is no continuous state, distance or
    /// rate, and an unknown that is computed otherwise.
    pub fn directional(
        &mut self,
        (unknowns, knowns): (&[u32], &[u32]),
        seed: &[f64],
        sensitivity: &mut [f64],
    ) -> Result<(), Refusal> {
        self.check_begun()?;
        let (needed, given) = (self.count(knowns)?, seed.len());
        let (unknown, places) = (self.count(unknowns)?, sensitivity.len());
        if needed != given || unknown != places {
            return Err(Refusal::error(format!(
                "{given} seeds and {places} sensitivities are given for {needed} knowns and {unknown} unknowns"
            )));
        }
        if self.exchange.is_none() {
            self.exchange = Some(mckibben::plant::PlantExchange::new(self.plant.steps(), self.tolerance)?);
        }
        let direction = self.direction(knowns, seed)?;
        let Some(exchange) = &mut self.exchange else { return Err(Refusal::error("not initialised")) };
        let steps = self.plant.steps();
        let mut rates = vec![0.0; steps.state().len()];
        exchange.rates_along(steps, &direction, &mut rates)?;
        let mut guards = vec![0.0; self.model.variables().indicators];
        exchange.guards_along(steps, &direction, &mut guards)?;
        let nil = PlantSample::new(steps.plant());
        let mut sample = nil.clone();
        exchange.sample_along(steps, &direction, &mut sample)?;
        // Columns are affine in a sample: what does not change falls out of the difference.
        let of_column = |column: &PlantColumn| {
            column.quantity().map_or(0.0, |of| of.of(steps.plant(), &sample) - of.of(steps.plant(), &nil))
        };
        let (variables, columns) = (self.model.variables(), self.plant.outputs());
        let mut rest = sensitivity;
        for reference in unknowns {
            let Some(its) = variables.find(*reference) else { continue };
            let (into, behind) = rest.split_at_mut(its.dimension.unwrap_or(1));
            match its.slot {
                Slot::Derivative(index) => into[0] = rates[variables.states[index]],
                Slot::Indicator(index) => into[0] = guards[index],
                Slot::Output(index) => into[0] = of_column(&columns[index]),
                Slot::Array(array @ (Array::Tensions | Array::Pressures | Array::MassFlows)) => {
                    let of = Array::ALL.iter().position(|its| *its == array).unwrap_or(3) - 3;
                    for (into, output) in into.iter_mut().zip(&variables.of_arrays[of]) {
                        *into = of_column(&columns[*output]);
                    }
                }
                _ => return Err(Refusal::error(format!("`{}` is no unknown", its.name))),
            }
            rest = behind;
        }
        Ok(())
    }

    /// The direction of the plant's states.
    fn direction(&self, knowns: &[u32], seed: &[f64]) -> Result<Vec<f64>, Refusal> {
        let (variables, indices) = (self.model.variables(), self.plant.steps().plant().indices());
        let mut direction = vec![0.0; indices.states];
        let mut rest = seed;
        for reference in knowns {
            let Some(its) = variables.find(*reference) else { continue };
            let (given, behind) = rest.split_at(its.dimension.unwrap_or(1));
            let first = indices.mechanisms.first();
            match (its.slot, first) {
                (Slot::State(index), _) => direction[variables.states[index]] += given[0],
                (Slot::Distance(index), Some(here)) => direction[here.position(index)] += given[0],
                (Slot::Rate(index), Some(here)) => direction[here.rate(index)] += given[0],
                (Slot::Array(array @ (Array::Distances | Array::Rates)), Some(here)) => {
                    for (index, number) in given.iter().enumerate() {
                        let place = if array == Array::Distances { here.position(index) } else { here.rate(index) };
                        direction[place] += number;
                    }
                }
                // Commands take effect by events: in the mode that holds nothing depends on them.
                (Slot::Command(_) | Slot::Array(Array::Commands), _) => {}
                _ => return Err(Refusal::error(format!("`{}` is no known", its.name))),
            }
            rest = behind;
        }
        Ok(direction)
    }
}
