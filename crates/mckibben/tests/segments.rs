//! A run in segments: joints that change nothing leave the run as it is, valve and command go on through any joint, and
//! derivatives by the state at a joint are those of differences.

use crate::common::{PSI, Paper, assert_close, assert_within};
use mckibben::friction::{Hysteresis, MaxwellSlip};
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{EventKind, State, simulate_in_segments};
use mckibben::{AbsolutePressure, Dual, Error, Scalar};

const DURATION: f64 = 0.5;

/// Pulses of the paper's valve, at a load that neither bounces nor hangs slack.
fn paper() -> Paper {
    Paper::pwm(25.0, 0.45).gauge(30.0 * PSI)
}

fn run(paper: &Paper, joints: &[f64], next_start: impl FnMut(usize, State) -> State) -> Result<RigTrajectory, Error> {
    simulate_in_segments(&paper.rig(), paper.start(), (DURATION, 1e-11), joints, next_start)
}

#[test]
fn joints_that_change_nothing_leave_the_run_as_it_is() {
    let whole = paper().run(DURATION, 1e-11);
    // In the middle of a pulse, at an edge of the command, while the poppet is on its way, and off any grid.
    let joints = [0.05, 0.12, 0.1215, 0.2, 0.333_33, 0.49];
    let parts = run(&paper(), &joints, |_, reached| reached).expect("a run");
    for time in (0..=500).map(|step| 1e-3 * f64::from(step)) {
        let (part, all) = (parts.at(time), whole.at(time));
        assert_within(part.length, all.length, 1e-9);
        assert_within(part.velocity, all.velocity, 1e-6);
        assert_close(part.pressure.0, all.pressure.0, 1e-7);
        assert_close(part.air_mass, all.air_mass, 1e-7);
    }
    let seats = |run: &RigTrajectory| -> Vec<f64> {
        run.events().iter().filter(|event| event.kind == EventKind::Valve).map(|event| event.time).collect()
    };
    assert_eq!(seats(&parts), seats(&whole));
}

#[test]
fn a_joint_sets_the_states_and_the_valve_goes_on() {
    // Shorter, on its way, and with a tenth more air at the same temperature, as nearly as the volume is the same.
    let elsewhere = |state: State| State {
        length: state.length - 2e-3,
        velocity: -0.05,
        pressure: AbsolutePressure(1.1 * state.pressure.0),
        air_mass: 1.1 * state.air_mass,
    };
    let mut reached = Vec::new();
    let joined = run(&paper(), &[0.21], |place, state| {
        reached.push((place, state));
        elsewhere(state)
    });
    let joined = joined.expect("a run");
    let whole = paper().run(DURATION, 1e-11);
    assert_eq!(reached.len(), 1);
    assert_within(reached[0].1.length, whole.at(0.21).length, 1e-9);
    let after = joined.at(0.21);
    let State { length, velocity, pressure, air_mass } = elsewhere(reached[0].1);
    for (is, set) in [(after.length, length), (after.velocity, velocity), (after.pressure.0, pressure.0)] {
        assert_close(is, set, 1e-12);
    }
    assert_close(after.air_mass, air_mass, 1e-12);
    let last_seat = |run: &RigTrajectory| {
        run.events().iter().rev().find(|event| event.kind == EventKind::Valve).map(|event| event.time)
    };
    assert_eq!(last_seat(&joined), last_seat(&whole));
}

#[test]
fn derivatives_by_the_state_at_a_joint_are_those_of_differences() {
    let joint = paper().run(DURATION, 1e-11).at(0.2);
    let at = [joint.length, joint.velocity, joint.pressure.0, joint.air_mass];
    let state =
        |at: [f64; 4]| State { length: at[0], velocity: at[1], pressure: AbsolutePressure(at[2]), air_mass: at[3] };
    let end = |at: [f64; 4]| {
        let sample = run(&paper(), &[0.2], |_, _| state(at)).expect("a run").at(0.35);
        [sample.length, sample.velocity, sample.pressure.0, sample.air_mass]
    };
    type Four = crate::common::Seeded;
    let rig = paper().rig().map(|_, value| Four::constant(value));
    let start = rig.begin(&paper().initial().map(|_, value| Four::constant(value))).expect("a start");
    let seeded = State {
        length: Dual::variable(at[0], 0),
        velocity: Dual::variable(at[1], 1),
        pressure: AbsolutePressure(Dual::variable(at[2], 2)),
        air_mass: Dual::variable(at[3], 3),
    };
    let dual = simulate_in_segments(&rig, start, (Four::constant(DURATION), 1e-11), &[0.2], |_, _| seeded);
    let sample = dual.expect("a run").at(Four::constant(0.35));
    let exact = [sample.length, sample.velocity, sample.pressure.0, sample.air_mass];
    for (state, step) in [1e-7, 1e-6, 1.0, 1e-10].into_iter().enumerate() {
        let moved = |by: f64| {
            let mut at = at;
            at[state] += by;
            end(at)
        };
        let (above, below) = (moved(step), moved(-step));
        for (place, number) in exact.iter().enumerate() {
            let difference = (above[place] - below[place]) / (2.0 * step);
            let size = (exact.map(|number| number.slope[state])[place].abs()).max(1e-12);
            assert_within(number.slope[state], difference, 2e-4 * size);
        }
    }
}

#[test]
fn what_remembers_more_than_four_states_is_refused() {
    let slips = MaxwellSlip::new(&[1e-3], &[0.1]).expect("a law");
    let remembering = paper().with(|rig| rig.hysteresis = Some(Hysteresis::MaxwellSlip(slips)));
    let refused = run(&remembering, &[0.1], |_, state| state).expect_err("a memory");
    assert!(refused.to_string().contains("remembers more"), "{refused}");
    let nowhere = run(&paper(), &[0.1], |_, state| State { air_mass: 0.0, ..state }).expect_err("no air");
    assert!(nowhere.to_string().contains("mass of the air = 0"), "{nowhere}");
}
