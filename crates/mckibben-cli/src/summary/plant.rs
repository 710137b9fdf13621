//! What the run of a plant came to, as text for people.

use crate::describe;
use crate::summary::{Page, assumptions, cost, events, goals_by_name, residual_in as residual};
use crate::terminal::{FAINT, styled};
use mckibben::mechanism::Mechanism;
use mckibben::network::NodeKind;
use mckibben::plant::{ActuatorLedger, Balance, MechanismLedger};
use mckibben_run::failure::Failure;
use mckibben_run::plant::{PlantFigures, control};
use mckibben_run::quantities::{common_prefix, count, given};
use mckibben_scenario::{Assumed, Muscle};
use std::time::Duration;

/// Everything that the summary tells about.
pub(crate) struct Summary<'a> {
    /// The name of the scenario file.
    pub(crate) name: &'a str,
    pub(crate) run: &'a PlantFigures,
    /// How long the computer took.
    pub(crate) elapsed: Duration,
    /// The muscles with their names.
    pub(crate) muscles: &'a [(String, Muscle)],
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
        events(page, self.run.observation.events.iter().map(|(kind, number)| (kind.name(), *number)));
        if let Some(closed) = &self.run.control {
            self.control(page, closed);
        }
        self.states(page);
        self.air(page);
        self.energy(page);
        self.exergy(page);
        page.finish(&assumptions(self.assumed))
    }

    fn what_ran(&self, page: &Page) {
        let of = &self.run.experiment;
        page.heading(&format!("{}  {}", self.name, styled(FAINT, given(of.run.duration, "s"))));
        page.line("actuators", &of.names.actuators.join(", "));
        for (names, text) in describe::muscles(self.muscles) {
            page.line("braid", &format!("{names}: {text}"));
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
        page.line("engine", &describe::engine(&of.run));
        cost(page, &self.run.observation.ended, &of.run, self.elapsed);
    }

    fn states(&self, page: &Page) {
        page.heading("State");
        page.head(["at the end", "least", "greatest"]);
        for row in &self.run.observation.rows {
            match row.unit {
                "" => page.line("", &row.name),
                unit => page.range(&row.name, row.last, row.range, unit),
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
            let (name, samples, requests) = (control::name(of, control), count(*samples), count(*requests));
            page.line(name, &format!("{samples} samples, {requests} changes of what is commanded"));
        }
    }

    /// Where the air came from and went.
    fn air(&self, page: &Page) {
        let (of, ledger) = (&self.run.experiment, &self.run.observation.ended.ledger);
        if ledger.nodes.is_empty() {
            return;
        }
        page.heading("Air");
        let network = of.plant.network();
        for (name, node) in &of.names.nodes {
            let supplied = ledger.nodes[*node].supplied.mass;
            let stores = matches!(network.nodes[*node].kind, NodeKind::Reservoir(_));
            if stores {
                page.value(name, &page.quantity(ledger.nodes[*node].air_gain, "kg"), "gained by what is stored there");
            } else if supplied != 0.0 {
                page.value(name, &page.quantity(supplied, "kg"), "drawn");
            }
        }
        let outside = network.nodes.iter().zip(&ledger.nodes);
        let outside = outside.filter(|(node, _)| matches!(node.kind, NodeKind::Atmosphere));
        let outside: f64 = outside.map(|(_, node)| -node.supplied.mass).sum();
        page.value("atmosphere", &page.quantity(outside, "kg"), "let out, less what came in");
        let gained: f64 = ledger.actuators.iter().map(|of| of.air_gain).sum();
        page.value("left inside", &page.quantity(gained, "kg"), "gained by the actuators");
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
        table(page, &named, work.turnover);
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
        table(page, &named, exergy.turnover);
        balance(page, &exergy, "J");
        if let Some(efficiency) = total.efficiency() {
            page.value("efficiency", &page.percent(efficiency), "work on the loads over what was drawn and compressed");
        }
    }
}

/// Values under one prefix; the first two always, the others where they are more than rounding.
fn table(page: &Page, named: &[(&str, f64, &str)], turnover: f64) {
    let (factor, prefix) = common_prefix(&named.iter().map(|(_, value, _)| *value).collect::<Vec<_>>());
    for (index, (name, value, what)) in named.iter().enumerate() {
        if index < 2 || value.abs() > 1e-12 * turnover {
            page.value(name, &format!("{} {prefix}J", page.digits(value * factor)), what);
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
            let what = if joints.len() == 1 { "joint" } else { "joints" };
            format!("a chain of {} {what}: {}{belt}", count(joints.len() as u64), joints.join(", "))
        }
        Mechanism::Prescribed(_) => "a distance that is given over time".to_owned(),
        Mechanism::Fixed => "a distance that stays".to_owned(),
        Mechanism::External { .. } => "distances that a host gives".to_owned(),
    }
}
