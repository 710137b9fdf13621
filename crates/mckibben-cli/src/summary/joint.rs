//! What the run of a joint came to, as text for people.

use crate::describe;
use crate::summary::{Common, Page, effort, goals, is_periodic, ledger};
use mckibben::plant::JointPlant;
use mckibben::simulation::JointRig;
use mckibben_run::closed_loop::Closed;
use mckibben_run::failure::Failure;
use mckibben_run::joint::NAMES;
use mckibben_run::joint::observation::Observation;
use mckibben_run::observation::{AirUse, Range};
use mckibben_scenario::Scenario;

/// What the summary describes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Summary<'a> {
    /// What every summary prints.
    pub common: Common<'a>,
    /// The scenario as it was understood, and as it stands for the antagonist.
    pub scenarios: [&'a Scenario; 2],
    /// The joint.
    pub rig: &'a JointRig,
    /// The figures of the run.
    pub observation: &'a Observation,
    /// The controller's part in it, if there is one.
    pub control: Option<&'a Closed>,
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
        let Observation { air: used, ended, .. } = self.observation;
        air(page, *used);
        page.events(&self.observation.events);
        if let Some(closed) = self.control {
            goals(page, &closed.goals);
            effort(page, closed, ended.ledger.air_used());
        }
        let periodic = self.control.is_some() || JointPlant::new(self.rig).is_ok_and(|view| is_periodic(view.plant()));
        page.settled(self.common.settled, periodic);
        if page.verbose {
            ledger::energy(page, &ended.ledger, &NAMES);
            if ended.draws {
                ledger::exergy(page, &ended.ledger);
            }
        }
        page.finish(&self.common.assumptions())
    }

    fn what_ran(&self, page: &Page) {
        let [scenario, _] = self.scenarios;
        self.common.title(page, &scenario.run);
        if page.verbose {
            for (names, text) in describe::muscles(self.common.muscles) {
                // Below, the names say what drives each.
                page.line("braid", &if names.contains(',') { text } else { format!("{names}: {text}") });
            }
        }
        page.line("load", &describe::load(&scenario.load));
        for (name, scenario) in NAMES.into_iter().zip(self.scenarios) {
            page.line(name, &describe::drive(scenario));
        }
        if page.verbose {
            page.line("air", &describe::air(&scenario.air.process));
        }
        self.common.cost(page, &self.observation.ended, &scenario.run);
    }

    fn states(&self, page: &Page) {
        let Observation { last, joint, actuators, .. } = self.observation;
        page.heading("State");
        page.fit(["antagonist, gauge"]);
        page.head(["at the end", "least", "greatest"]);
        page.range("angle", last.angle, joint[0], "rad");
        if page.verbose {
            page.range("angular vel.", last.angular_velocity, joint[1], "rad/s");
        }
        page.range("torque", last.torque, joint[2], "N*m");
        for (index, name) in NAMES.into_iter().enumerate() {
            let (last, [length, tension, pressure]) = (&last.actuators[index], actuators[index]);
            let atmosphere = self.rig.driven()[index].actuator.air().atmosphere().0;
            let Range { least, greatest } = pressure;
            let gauge = Range { least: least - atmosphere, greatest: greatest - atmosphere };
            if page.verbose {
                page.line("", name);
                page.range("length", last.length, length, "m");
                page.range("tension", last.tension, tension, "N");
                page.range("gauge pressure", last.pressure.0 - atmosphere, gauge, "Pa");
            } else {
                page.range(&format!("{name}, gauge"), last.pressure.0 - atmosphere, gauge, "Pa");
            }
        }
    }
}

fn air(page: &Page, used: [AirUse; 2]) {
    if !page.verbose {
        let all = used.iter().map(|air| air.from_supply).sum();
        return page.line("air", &format!("{} from the supply", page.quantity(all, "kg")));
    }
    page.heading("Air");
    for (name, air) in NAMES.into_iter().zip(used) {
        let (from, to) = (page.quantity(air.from_supply, "kg"), page.quantity(air.to_atmosphere, "kg"));
        page.line(name, &format!("{from} from the supply, {to} to the exhaust"));
    }
}
