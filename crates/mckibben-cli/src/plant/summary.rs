//! What the run of a plant came to, as text for people.

use super::{PlantRun, coordinates};
use crate::describe;
use crate::failure::Failure;
use crate::observation::Range;
use crate::quantities::{count, given};
use crate::summary::{Page, assumptions, cost, counts, events};
use crate::terminal::{FAINT, styled};
use mckibben::mechanism::Mechanism;
use mckibben::plant::PlantSample;
use mckibben_scenario::Assumed;
use std::collections::BTreeMap;
use std::time::Duration;

/// Everything that the summary tells about.
pub(crate) struct Summary<'a> {
    /// The name of the scenario file.
    pub(crate) name: &'a str,
    pub(crate) run: &'a PlantRun,
    /// How long the computer took.
    pub(crate) elapsed: Duration,
    /// The assumed values in force.
    pub(crate) assumed: &'a [Assumed],
}

impl Summary<'_> {
    /// The summary, with colours.
    ///
    /// # Errors
    /// [`Failure::stopped`] for a number that is not finite.
    pub(crate) fn render(&self) -> Result<String, Failure> {
        let page = &Page::default();
        self.what_ran(page);
        page.heading("Events");
        let mut kinds = BTreeMap::new();
        for event in self.run.trajectory.events() {
            *kinds.entry(event.kind.kind).or_insert(0_u64) += 1;
        }
        events(page, kinds.into_iter().map(|(kind, number)| (kind.name(), number)));
        self.states(page);
        page.finish(&assumptions(self.assumed))
    }

    fn what_ran(&self, page: &Page) {
        let of = &self.run.experiment;
        page.heading(&format!("{}  {}", self.name, styled(FAINT, given(of.run.duration, "s"))));
        page.line("actuators", &of.names.actuators.join(", "));
        for (names, mechanism) in of.names.mechanisms.iter().zip(of.plant.mechanisms()) {
            if let Some(name) = &names.name {
                page.line(name, &described(mechanism, &names.joints));
            }
        }
        let supplies: Vec<&str> = of.names.nodes.iter().map(|(name, _)| name.as_str()).collect();
        if !supplies.is_empty() {
            page.line("supplies", &supplies.join(", "));
        }
        page.line("engine", &describe::engine(&of.run));
        let cost = cost(counts(self.run.trajectory.statistics()));
        page.line("cost", &format!("{cost}, {}", page.quantity(self.elapsed.as_secs_f64(), "s")));
    }

    fn states(&self, page: &Page) {
        let of = &self.run.experiment;
        let atmosphere = of.plant.network().atmosphere;
        let mut rows = Vec::new();
        for its in coordinates(of) {
            let (m, k) = (its.mechanism, its.index);
            let unit = if its.is_angle { "rad" } else { "m" };
            let value = move |sample: &PlantSample| sample.mechanisms[m].position[k];
            rows.push(Row { name: its.name, unit, value: Box::new(value), range: Range::NONE, last: 0.0 });
        }
        for (index, name) in of.names.actuators.iter().enumerate() {
            let mut row = |name: &str, unit, value: Box<dyn Fn(&PlantSample) -> f64>| {
                rows.push(Row { name: name.to_owned(), unit, value, range: Range::NONE, last: 0.0 });
            };
            row(name, "", Box::new(|_| 0.0));
            row("length", "m", Box::new(move |sample| sample.actuators[index].length));
            row("tension", "N", Box::new(move |sample| sample.actuators[index].tension));
            row("gauge pressure", "Pa", Box::new(move |sample| sample.actuators[index].pressure.0 - atmosphere));
        }
        for (name, node) in &of.names.nodes {
            let node = *node;
            let value = move |sample: &PlantSample| sample.nodes[node].pressure.0 - atmosphere;
            let (name, range) = (format!("{name}, gauge"), Range::NONE);
            rows.push(Row { name, unit: "Pa", value: Box::new(value), range, last: 0.0 });
        }
        for sample in self.run.trajectory.samples(of.run.sample_interval) {
            for row in &mut rows {
                row.last = (row.value)(&sample);
                row.range.see(row.last);
            }
        }
        page.heading("State");
        page.head(["at the end", "least", "greatest"]);
        for Row { name, unit, range, last, .. } in rows {
            match unit {
                "" => page.line("", &name),
                unit => page.range(&name, last, range, unit),
            }
        }
    }
}

/// A line of the table of states; without a unit a heading.
struct Row {
    name: String,
    unit: &'static str,
    value: Box<dyn Fn(&PlantSample) -> f64>,
    range: Range,
    last: f64,
}

/// A mechanism in words.
fn described(mechanism: &Mechanism, joints: &[String]) -> String {
    match mechanism {
        Mechanism::Mass(mass) => format!("a mass of {}", given(mass.mass(), "kg")),
        Mechanism::Chain(chain) => {
            let belt = if chain.belt().is_some() { " over a belt" } else { "" };
            let what = if joints.len() == 1 { "joint" } else { "joints" };
            format!("a chain of {} {what}: {}{belt}", count(joints.len() as u64), joints.join(", "))
        }
        Mechanism::Prescribed(_) => "a distance that is given over time".to_owned(),
        Mechanism::Fixed => "a distance that stays".to_owned(),
        Mechanism::External { .. } => "distances that a host gives".to_owned(),
    }
}
