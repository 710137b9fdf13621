//! The work of one step: how many operations of each kind, so that a change that makes a step dearer is seen where it is
//! made, on any machine.

#[path = "common/counted.rs"]
mod counted;

use crate::common::{INCH, Paper};
use counted::{Books, Counts, step};
use mckibben::friction::Memory;
use mckibben::load::Line;
use mckibben::simulation::{Held, Method, Rig, State};

/// Length of the step in s.
const STEP: f64 = 1e-4;

/// Pulled along while it fills.
fn sliding() -> Held<f64> {
    Held {
        supply: true,
        exhaust: false,
        openings: mckibben::valve::Openings::Whole,
        sliding: 1.0,
        stuck: false,
        slack: false,
        taut: false,
        line: Line::resting(0.0),
        compressor: false,
        memory: Memory::relaxed(0.0),
    }
}

/// The hanging mass of the paper under pulse-width modulation, between the limits of its length.
fn hanging_mass() -> (Rig, State) {
    let paper = Paper::pwm(25.0, 0.5).from(3.5 * INCH, 0.1).gauge(2e5);
    (paper.rig(), paper.start())
}

fn count(held: &Held<f64>, method: Method) -> Books {
    let (rig, start) = hanging_mass();
    step(&rig, start, held, STEP, method).1
}

/// These numbers are a snapshot of what the code does, not a claim about what it should: after a change that is meant,
/// write down the new ones, and the reason with the change.
#[test]
fn snapshot_of_the_operations_of_a_step() {
    let runge_kutta = Counts {
        add: 140,
        subtract: 44,
        multiply: 284,
        divide: 4,
        root: 4,
        negate: 12,
        compare: 28,
        select: 84,
        transcendental: 0,
    };
    let stable = Counts {
        add: 186,
        subtract: 40,
        multiply: 326,
        divide: 8,
        root: 2,
        negate: 11,
        compare: 20,
        select: 75,
        transcendental: 0,
    };
    assert_eq!([Method::Rk4, Method::Stable].map(|method| count(&sliding(), method).varying), [runge_kutta, stable]);
    assert_eq!([runge_kutta, stable].map(|counts| counts.floating_point()), [476, 562]);
}

#[test]
fn a_step_does_the_same_work_whatever_holds() {
    let others = [
        Held { supply: false, exhaust: true, sliding: -1.0, ..sliding() },
        Held { supply: false, sliding: 0.0, stuck: true, ..sliding() },
        Held { slack: true, ..sliding() },
        Held { taut: true, ..sliding() },
    ];
    for method in [Method::Rk4, Method::Stable] {
        for held in &others {
            assert_eq!(count(held, method), count(&sliding(), method), "{method:?} {held:?}");
        }
    }
}

#[test]
fn the_step_that_is_counted_is_the_step_that_is_taken() {
    let (rig, start) = hanging_mass();
    let State { length, velocity, pressure, air_mass } = start;
    let state = [length, velocity, pressure.0, air_mass];
    let taken = [
        (Method::Rk4, rig.step_rk4(0.0, state, STEP, &sliding())),
        (Method::Stable, rig.step_stable(0.0, state, STEP, &sliding())),
    ];
    for (method, end) in taken {
        let (counted, _) = step(&rig, start, &sliding(), STEP, method);
        assert_eq!(counted.map(f64::to_bits), end.map(f64::to_bits), "{method:?}");
    }
}
