//! What the run of a plant came to, as text for people.

use crate::describe;
use crate::summary::{Common, Page, goals_by_name, is_periodic, residual_in as residual};
use mckibben::mechanism::Mechanism;
use mckibben::network::NodeKind;
use mckibben::plant::{ActuatorLedger, Balance, MechanismLedger};
use mckibben_run::failure::Failure;
use mckibben_run::plant::{PlantFigures, control, observation};
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
            self.energy(page);
            self.exergy(page);
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
            let used = observation::air_used(of, ledger);
            return page.line("air", &format!("{} from the supplies", mass(used)));
        }
        page.heading("Air");
        for (name, node) in &of.names.nodes {
            let supplied = ledger.nodes[*node].supplied.mass;
            let stores = matches!(network.nodes[*node].kind, NodeKind::Reservoir(_));
            if stores {
                page.value(name, &mass(ledger.nodes[*node].air_gain), "gained by what is stored there");
            } else if supplied != 0.0 {
                page.value(name, &mass(supplied), "drawn");
            }
        }
        let outside = network.nodes.iter().zip(&ledger.nodes);
        let outside = outside.filter(|(node, _)| matches!(node.kind, NodeKind::Atmosphere));
        let outside: f64 = outside.map(|(_, node)| -node.supplied.mass).sum();
        page.value("atmosphere", &mass(outside), "let out, less what came in");
        let gained: f64 = ledger.actuators.iter().map(|of| of.air_gain).sum();
        page.value("left inside", &mass(gained), "gained by the actuators");
        balance(page, &ledger.air(), "kg");
    }

    /// Where the work of the gas went.
    fn energy(&self, page: &Page) {
        page.heading("Energy");
        let (ledger, total) = (&self.run.observation.ended.ledger, self.run.observation.ended.ledger.total());
        let mechanisms = |of: fn(&MechanismLedger) -> f64| -> f64 { ledger.mechanisms.iter().map(of).sum() };
        let actuators = |of: fn(&ActuatorLedger) -> f64| -> f64 { ledger.actuators.iter().map(of).sum() };
        let named = [
            ("gas work", total.gas_work, "by the gauge pressures"),
            ("to the loads", total.work, "work of the actuators on what they move"),
            ("kinetic", mechanisms(|of| of.kinetic), "gained by what moves"),
            ("potential", mechanisms(|of| of.potential), "gained: weights, constant forces, springs, stops"),
            ("given motion", mechanisms(|of| of.driven), "work on motions that are given"),
            ("joints", mechanisms(|of| of.damping + of.stops), "dissipated by damping and stops"),
            ("belt", mechanisms(|of| of.belt - of.belt_work), "dissipated under the foot, less the work of the belt"),
            ("stored", total.elastic, "in braids, bladders, tendons, hysteresis and branches"),
            ("viscous", actuators(|of| of.viscous), "dissipated by viscous friction"),
            ("Coulomb", actuators(|of| of.coulomb), "dissipated by Coulomb friction"),
            ("slip", actuators(|of| of.slip), "dissipated by hysteresis that slips"),
            ("relaxation", actuators(|of| of.branches), "dissipated by viscoelastic branches"),
            ("exchanged", actuators(|of| of.branch_exchange), "taken from branches by changes of the pressure"),
            ("braid damping", actuators(|of| of.braid), "dissipated by taut braids"),
            ("slack", actuators(|of| of.slack), "correction of friction while a tension cannot push"),
            (
                "effectiveness",
                total.effectiveness_loss,
                "taken by an effectiveness other than 1, or a law other than virtual work",
            ),
        ];
        let work = ledger.work();
        page.energies(&named, work.turnover);
        balance(page, &work, "J");
    }

    /// Where the exergy of the air went.
    fn exergy(&self, page: &Page) {
        let (ledger, total) = (&self.run.observation.ended.ledger, self.run.observation.ended.ledger.total());
        let exergy = ledger.exergy();
        if exergy.turnover <= exergy.rounding {
            return;
        }
        page.heading("Exergy of the air");
        let named = [
            ("drawn", total.drawn, "work potential of what sources gave"),
            ("gas work", total.gas_work, "by the gauge pressures, see Energy"),
            ("compressed", total.compressed, "least work of the compressors in the plant"),
            ("left inside", total.stored, "gained by the air in actuators, hoses and reservoirs"),
            ("exhaust", total.exhaust, "let go with the air"),
            ("leaked", total.leaked, "let go with the air that leaked"),
            ("throttled", total.throttled, "destroyed in valves, hoses and regulators"),
            ("mixing", total.mixed, "destroyed as air of two temperatures mixes"),
            ("heat", total.heat_loss, "lost with heat; negative: gained"),
        ];
        page.energies(&named, exergy.turnover);
        balance(page, &exergy, "J");
        if let Some(efficiency) = total.efficiency() {
            page.value("efficiency", &page.percent(efficiency), "work on the loads over what was drawn and compressed");
        }
    }
}

/// What of a sum does not close.
fn balance(page: &Page, of: &Balance, unit: &str) {
    residual(page, [of.residual, of.turnover, of.rounding], unit);
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
