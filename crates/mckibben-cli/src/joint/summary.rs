//! What the run of a joint came to, as text for people.

use super::control::Closed;
use super::outcome::Outcome;
use super::{NAMES, events};
use crate::describe;
use crate::observation::{AirUse, Range};
use crate::quantities::{count, digits, given, quantity};
use crate::summary::{Page, assumptions, circuit, cost, effort, goals, residual, step_of};
use crate::terminal::{FAINT, styled};
use mckibben::simulation::{JointAudit, JointSample, JointTrajectory};
use mckibben_scenario::{Assumed, Scenario};
use std::time::Duration;

/// Samples in which extremes are looked for at least.
const LEAST_SAMPLES: f64 = 5000.0;

/// Everything that the summary tells about.
#[derive(Clone, Copy, Debug)]
pub struct Summary<'a> {
    /// The name of the scenario file.
    pub name: &'a str,
    /// The scenario as it was understood, and as it stands for the antagonist.
    pub scenarios: [&'a Scenario; 2],
    /// The run.
    pub outcome: &'a Outcome,
    /// The controller's part in it, if there is one.
    pub control: Option<&'a Closed>,
    /// How long the computer took.
    pub elapsed: Duration,
    /// The assumed values in force.
    pub assumed: &'a [Assumed],
}

impl Summary<'_> {
    /// The summary, with colours.
    pub fn render(&self) -> String {
        let mut page = Page::default();
        self.what_ran(&mut page);
        self.events(&mut page);
        self.states(&mut page);
        let used = self.outcome.located().map(used);
        if let Some(closed) = self.control {
            goals(&mut page, &closed.goals);
            let requests = closed.requests.map(|requests| count(requests as u64)).join(" and ");
            let air = used.map(|used| quantity(used.iter().map(|air| air.from_supply).sum(), "kg"));
            effort(&mut page, closed.samples, &requests, air.as_deref());
        }
        let (Some(trajectory), Some(used)) = (self.outcome.located(), used) else {
            return page.text + &assumptions(self.assumed);
        };
        air(&mut page, used);
        let of_circuit = trajectory.circuit();
        energy(&mut page, &of_circuit.map_or_else(|| trajectory.audit(), |audit| audit.work));
        if let Some(audit) = of_circuit {
            let process = trajectory.rig().driven()[0].actuator.air().process();
            circuit(&mut page, &audit.total(), process, [audit.residual(), audit.turnover()]);
        }
        page.text + &assumptions(self.assumed)
    }

    fn what_ran(&self, page: &mut Page) {
        let [scenario, _] = self.scenarios;
        let run = &scenario.run;
        page.heading(&format!("{}  {}", self.name, styled(FAINT, given(run.duration, "s"))));
        page.line("load", &describe::load(&scenario.load));
        for (name, scenario) in NAMES.into_iter().zip(self.scenarios) {
            page.line(name, &describe::drive(scenario));
        }
        page.line("air", &describe::air(&scenario.air.process));
        page.line("engine", &describe::engine(run));
        let steps = match self.outcome {
            Outcome::Located(trajectory) => cost(trajectory.counts()),
            Outcome::Stepped(stepped) => {
                let error = stepped.chosen.map(|error| [error.compared, error.greatest]);
                page.line("step", &step_of(stepped.step, error, run));
                format!("{} steps", count(stepped.steps))
            }
        };
        page.line("cost", &format!("{steps}, {}", quantity(self.elapsed.as_secs_f64(), "s")));
    }

    fn events(&self, page: &mut Page) {
        page.heading("Events");
        if self.outcome.located().is_none() {
            return page.line("", "the fixed-step engine keeps no log of events");
        }
        let log = self.outcome.events();
        let kinds: Vec<String> = events::counts(log)
            .iter()
            .map(|(kind, number)| format!("{}\u{a0}{}", kind.name(), count(*number)))
            .collect();
        match kinds.as_slice() {
            [] => page.line("", "none"),
            kinds => page.line(&count(log.len() as u64), &kinds.join(", ")),
        }
    }

    fn states(&self, page: &mut Page) {
        let run = &self.scenarios[0].run;
        let interval = run.sample_interval.min(run.duration / LEAST_SAMPLES);
        let Some(last) = self.outcome.samples(interval).last() else { return };
        let range = |value: &dyn Fn(&JointSample) -> f64| {
            let mut range = Range::NONE;
            if let Some(trajectory) = self.outcome.located() {
                trajectory.quadrature(|_, sample, _| range.see(value(sample)));
            }
            self.outcome.samples(interval).for_each(|sample| range.see(value(&sample)));
            range
        };
        page.heading("State");
        page.head(["at the end", "least", "greatest"]);
        let mut tell = |name: &str, unit: &str, value: &dyn Fn(&JointSample) -> f64| {
            page.range(name, value(&last), range(value), unit);
        };
        tell("angle", "rad", &|sample| sample.angle);
        tell("angular vel.", "rad/s", &|sample| sample.angular_velocity);
        tell("torque", "N*m", &|sample| sample.torque);
        for (index, name) in NAMES.into_iter().enumerate() {
            let driven = &self.outcome.rig().driven()[index];
            let atmosphere = driven.actuator.air().atmosphere().0;
            page.line("", name);
            let mut tell = |name: &str, unit: &str, value: &dyn Fn(&JointSample) -> f64| {
                page.range(name, value(&last), range(value), unit);
            };
            tell("length", "m", &|sample| sample.actuators[index].length);
            tell("tension", "N", &|sample| sample.actuators[index].tension);
            tell("gauge pressure", "Pa", &|sample| sample.actuators[index].pressure.0 - atmosphere);
        }
    }
}

/// The air of agonist and antagonist in a run.
pub(crate) fn used(trajectory: &JointTrajectory) -> [AirUse; 2] {
    let mut used = [AirUse::default(); 2];
    trajectory.quadrature(|weight, sample, mode| {
        for (index, air) in used.iter_mut().enumerate() {
            let actuator = &trajectory.rig().driven()[index].actuator;
            air.see_actuator(actuator, weight, &sample.actuators[index], &mode.actuators[index]);
        }
    });
    used
}

fn air(page: &mut Page, used: [AirUse; 2]) {
    page.heading("Air");
    for (name, air) in NAMES.into_iter().zip(used) {
        let (from, to) = (quantity(air.from_supply, "kg"), quantity(air.to_surroundings, "kg"));
        page.line(name, &format!("{from} from the supply, {to} to the exhaust"));
    }
}

fn energy(page: &mut Page, audit: &JointAudit) {
    page.heading("Energy");
    let [first, second] = &audit.actuators;
    let joules = |value: f64| format!("{} J", digits(value));
    page.value("gas work", &joules(first.gas_work), "by the agonist's gauge pressure");
    page.value("", &joules(second.gas_work), "by the antagonist's");
    page.value("to the limb", &joules(audit.gain), "kinetic and potential, pressed stops included");
    page.value("dissipated", &joules(first.dissipated() + second.dissipated()), "in both actuators");
    page.value("", &joules(audit.damping + audit.stops), "in the joint and its stops");
    residual(page, audit.residual(), audit.turnover());
}
