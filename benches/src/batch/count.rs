//! The operations of one step of each method, which a core test pins; see [`counted`].

#[path = "../../../crates/mckibben/tests/common/counted.rs"]
mod counted;

use crate::work::{Row, STEP};
use counted::{Books, Counts};
use mckibben::friction::Memory;
use mckibben::load::Line;
use mckibben::simulation::{Held, Method};

/// One number of the counts.
type Count = fn(&Counts) -> u64;

/// The operations of a step of both methods.
pub struct Operations {
    runge_kutta: Books,
    stable: Books,
}

impl Operations {
    /// Counts a step while the actuator fills and shortens; the step does the same whatever it does.
    pub fn count(row: &Row) -> Self {
        let held = Held {
            supply: true,
            exhaust: false,
            openings: mckibben::valve::Openings::Whole,
            sliding: -1.0,
            stuck: false,
            slack: false,
            taut: false,
            compressor: false,
            line: Line::resting(0.0),
            memory: Memory::relaxed(0.0),
        };
        let step = |method| counted::step(&row.rig, row.start, &held, STEP, method).1;
        Self { runge_kutta: step(Method::Rk4), stable: step(Method::Stable) }
    }

    /// Floating-point operations that a step must do.
    pub fn floating_point(&self, method: Method) -> u64 {
        match method {
            Method::Rk4 => self.runge_kutta.varying.floating_point(),
            Method::Stable => self.stable.varying.floating_point(),
        }
    }

    /// Prints the table.
    pub fn print(&self) {
        println!("operations of one step, counted as the core does them (in brackets those on parameters alone)");
        println!("{:<16} {:>14} {:>14}", "", "RK4", "stable");
        let kinds: [(&str, Count); 10] = [
            ("add", |counts| counts.add),
            ("subtract", |counts| counts.subtract),
            ("multiply", |counts| counts.multiply),
            ("divide", |counts| counts.divide),
            ("root", |counts| counts.root),
            ("negate", |counts| counts.negate),
            ("compare", |counts| counts.compare),
            ("select", |counts| counts.select),
            ("transcendental", |counts| counts.transcendental),
            ("floating point", Counts::floating_point),
        ];
        for (name, count) in kinds {
            let cell = |books: &Books| format!("{} ({})", count(&books.varying), count(&books.fixed));
            println!("{name:<16} {:>14} {:>14}", cell(&self.runge_kutta), cell(&self.stable));
        }
        println!("floating point: add to root, each as one. Not in it: the look for an end of sliding, slack or taut");
    }
}
