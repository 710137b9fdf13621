//! What the run of a plant came to, as text for people.

use crate::describe;
use crate::summary::{Common, Page, goals_by_name, is_periodic, ledger};
use mckibben::mechanism::Mechanism;
use mckibben::network::NodeKind;
use mckibben_run::failure::Failure;
use mckibben_run::plant::{PlantFigures, control};
use mckibben_run::quantities::{counted, given};

/// Printed behind the name of a part whose gauge pressure is on a line.
const GAUGE: &str = ", gauge";

/// What the summary describes.
pub(crate) struct Summary<'a> {
    /// What every summary prints.
    pub(crate) common: Common<'a>,
    pub(crate) run: &'a PlantFigures,
}

impl Summary<'_> {
    /// The summary, with colours.
    ///
    /// # Errors
    /// [`Failure::stopped`] for a number that is not finite.
    pub(crate) fn render(&self) -> Result<String, Failure> {
        let page = &Page::of(self.common.verbose);
        self.what_ran(page);
        self.states(page);
        self.air(page);
        page.events(&self.run.observation.events);
        if let Some(closed) = &self.run.control {
            self.control(page, closed);
        }
        let periodic = self.run.control.is_some() || is_periodic(&self.run.experiment.plant);
        page.settled(self.common.settled, periodic);
        if page.verbose {
            let (ledger, names) = (&self.run.observation.ended.ledger, &self.run.experiment.names.actuators);
            ledger::energy(page, ledger, &names.iter().map(String::as_str).collect::<Vec<_>>());
            ledger::exergy(page, ledger);
        }
        page.finish(&self.common.assumptions())
    }

    fn what_ran(&self, page: &Page) {
        let of = &self.run.experiment;
        self.common.title(page, &of.run);
        page.line("actuators", &of.names.actuators.join(", "));
        if page.verbose {
            for (names, text) in describe::muscles(self.common.muscles) {
                page.line("braid", &format!("{names}: {text}"));
            }
        }
        for (names, mechanism) in of.names.mechanisms.iter().zip(of.plant.mechanisms()) {
            if let Some(name) = &names.name {
                page.line(name, &described(mechanism, &names.joints));
            }
        }
        let supplies: Vec<&str> = of.names.nodes.iter().map(|(name, _)| name.as_str()).collect();
        if !supplies.is_empty() {
            page.line("supplies", &supplies.join(", "));
        }
        self.common.cost(page, &self.run.observation.ended, &of.run);
    }

    /// The states; in short what moves and the pressures, each in a line.
    fn states(&self, page: &Page) {
        page.heading("State");
        let rows = &self.run.observation.rows;
        let short = if page.verbose { String::new() } else { GAUGE.to_owned() };
        let names: Vec<String> = rows.iter().map(|row| format!("{}{short}", row.name)).collect();
        page.fit(names.iter().map(String::as_str));
        page.head(["at the end", "least", "greatest"]);
        let mut owner = "";
        for row in rows {
            match row.unit {
                "" => {
                    owner = &row.name;
                    if page.verbose {
                        page.line("", &row.name);
                    }
                }
                unit if page.verbose || owner.is_empty() || !row.key.starts_with(owner) => {
                    page.range(&row.name, row.last, row.range, unit);
                }
                "Pa" => page.range(&format!("{owner}{GAUGE}"), row.last, row.range, "Pa"),
                _ => {}
            }
        }
    }

    /// How far the controllers missed, and what they did.
    fn control(&self, page: &Page, closed: &control::Closed) {
        let named = closed.names.iter().zip(&closed.goals);
        goals_by_name(
            page,
            named.map(|(name, goal)| (format!("{name}, {}", describe::controlled(goal.quantity)), goal)),
        );
        let of = &self.run.experiment;
        for ((control, samples), requests) in of.controls.iter().zip(&closed.samples).zip(&closed.requests) {
            let (samples, changes) = (counted(*samples, "sample"), counted(*requests, "change"));
            page.line(control::name(of, control), &format!("{samples}, {changes} of what is commanded"));
        }
    }

    /// Where the air came from and went.
    fn air(&self, page: &Page) {
        let (of, ledger) = (&self.run.experiment, &self.run.observation.ended.ledger);
        if ledger.nodes.is_empty() {
            return;
        }
        let network = of.plant.network();
        // A remainder of rounding is no mass.
        let fine = 1e-9 * ledger.air().turnover;
        let mass = |mass: f64| page.quantity(if mass.abs() < fine { 0.0 } else { mass }, "kg");
        if !page.verbose {
            return page.line("air", &format!("{} from the supplies", mass(ledger.air_used())));
        }
        page.heading("Air");
        let mut gained: f64 = ledger.nodes.iter().map(|of| of.air_gain).sum();
        let mut drawn = Vec::new();
        for (name, node) in &of.names.nodes {
            let its = &ledger.nodes[*node];
            if matches!(network.nodes[*node].kind, NodeKind::Reservoir(_)) {
                page.value(name, &mass(its.air_gain), "gained by what is stored there");
                gained -= its.air_gain;
            } else if its.supplied.mass != 0.0 {
                page.value(name, &mass(its.supplied.mass), "drawn");
                drawn.push(*node);
            }
        }
        let (mut outside, mut given) = (0.0, ledger.actuators.iter().map(|of| of.given.mass).sum::<f64>());
        for (index, (node, its)) in network.nodes.iter().zip(&ledger.nodes).enumerate() {
            match node.kind {
                NodeKind::Atmosphere => outside -= its.supplied.mass,
                _ if drawn.contains(&index) => {}
                _ => given += its.supplied.mass,
            }
        }
        let shown = |mass: f64| mass.abs() > fine;
        if shown(given) {
            page.value("brought", &mass(given), "by given pressures and mains without a name");
        }
        page.value("atmosphere", &mass(outside), "let out, less what came in");
        let within: f64 = ledger.actuators.iter().map(|of| of.air_gain).sum();
        page.value("left inside", &mass(within), "gained by the actuators");
        if shown(gained) {
            page.value("in hoses", &mass(gained), "gained by hoses and what else has a volume");
        }
        ledger::balance(page, &ledger.air(), "kg");
    }
}

/// A mechanism in words.
fn described(mechanism: &Mechanism, joints: &[String]) -> String {
    match mechanism {
        Mechanism::Mass(mass) => format!("a mass of {}", given(mass.mass(), "kg")),
        Mechanism::Chain(chain) => {
            let belt = if chain.belt().is_some() { " over a belt" } else { "" };
            format!("a chain of {}: {}{belt}", counted(joints.len() as u64, "joint"), joints.join(", "))
        }
        Mechanism::Prescribed(_) => "a distance that is given over time".to_owned(),
        Mechanism::Fixed => "a distance that stays".to_owned(),
        Mechanism::External { .. } => "distances that a host gives".to_owned(),
    }
}
