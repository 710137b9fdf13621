//! The columns of a plant's run.
//!
//! First those of each actuator, as in the run of one alone, then those of the mechanisms and of the air, then the set points
//! of controllers and what they measured.

use crate::closed_loop::Goals;
use crate::record::{Field, goal_fields, number, word};
use mckibben::plant::PlantSample;
use mckibben_scenario::{PlantContent, PlantExperiment};
use std::rc::Rc;

/// The columns in their order; `names` says what each goal is of.
pub(crate) fn fields(of: &PlantExperiment, goals: &Goals, names: &[String]) -> Vec<Field<PlantSample>> {
    let plant = Rc::new(of.plant.clone());
    let mut fields = vec![number("time_s", "s", |sample: &PlantSample| sample.time)];
    fields.extend(of.columns().into_iter().map(|column| match column.content {
        PlantContent::Number(quantity) => {
            let plant = plant.clone();
            number(&column.title(), column.unit, move |sample: &PlantSample| quantity.of(&plant, sample))
        }
        PlantContent::Ports(valve) => word(&column.title(), move |sample: &PlantSample| ports(valve, sample)),
    }));
    fields.extend(goal_fields(goals, |index| format!("{}.", names[index]), |sample: &PlantSample| sample.time));
    fields
}

/// The open ports of a valve in a word.
pub(crate) fn ports(valve: Option<usize>, sample: &PlantSample) -> &'static str {
    valve.map_or(mckibben::valve::Ports::CLOSED, |valve| sample.valves[valve].ports).name()
}
