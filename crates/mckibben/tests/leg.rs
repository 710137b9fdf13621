//! A leg of two segments on six actuators.

use crate::common;
use common::{ATMOSPHERE, PSI, Paper, assert_close, assert_within, between, slope};
use mckibben::control::Drive;
use mckibben::load::leg::{Belt, Leg, LegState, Range, STRANDS, Segment, Strand};
use mckibben::simulation::LegStepper;
use mckibben::valve::Request;
use mckibben::{Dual, GaugePressure, Over};

pub(crate) fn free() -> Leg {
    let thigh = Segment { length: 0.3, mass: 0.9, distance: 0.13, inertia: 0.008 };
    let shank = Segment { length: 0.28, mass: 0.5, distance: 0.12, inertia: 0.004 };
    let range = |low, high| Range { ends: [low, high], damping: 0.0, stop_stiffness: 100.0, stop_damping: 0.5 };
    let strand = |hip, knee| Strand { arms: [hip, knee], rest_length: 0.083 };
    Leg {
        segments: [thigh, shank],
        gravity: common::GRAVITY,
        ranges: [range(-3.0, 3.0), range(-3.0, 3.0)],
        strands: [
            strand(0.015, 0.0),
            strand(-0.015, 0.0),
            strand(0.0, 0.012),
            strand(0.0, -0.012),
            strand(0.01, 0.008),
            strand(-0.01, -0.008),
        ],
        belt: None,
    }
}

fn state(row: usize) -> LegState {
    LegState {
        angles: [between(row, 0, -0.4, 0.4), between(row, 1, -0.5, 0.3)],
        rates: [between(row, 2, -3.0, 3.0), between(row, 3, -4.0, 4.0)],
    }
}

fn tensions(row: usize) -> [f64; STRANDS] {
    std::array::from_fn(|strand| between(row + 100 * strand, 4, 0.0, 200.0))
}

/// d'Alembert: over each virtual turn of a joint the inertial forces of both centres of mass do the work of all others.
#[test]
fn its_accelerations_are_newton_s_for_both_centres_of_mass() {
    let belt = Belt { depth: 0.4, velocity: -0.5, stiffness: 2e3, damping: 20.0, friction: 0.7, slipping_speed: 0.05 };
    for leg in [free(), Leg { belt: Some(belt), ..free() }] {
        for row in 0..40 {
            let (state, tensions) = (state(row), tensions(row));
            let [hip, knee] = leg.accelerations(&state, &tensions);
            let at = |time: f64| {
                let turn = |joint: usize, rate: f64| {
                    state.angles[joint] + state.rates[joint] * time + 0.5 * rate * time * time
                };
                [turn(0, hip), turn(1, knee)]
            };
            // Places of both centres of mass, and the inclinations.
            let bodies = |angles: [f64; 2]| {
                let [thigh, shank] = leg.segments;
                let (first, second) = (angles[0], angles[0] + angles[1]);
                let middle = [thigh.distance * first.sin(), -thigh.distance * first.cos(), first];
                let knee = [thigh.length * first.sin(), -thigh.length * first.cos()];
                let far = [knee[0] + shank.distance * second.sin(), knee[1] - shank.distance * second.cos(), second];
                [middle, far]
            };
            let [pulled_hip, pulled_knee] = leg.torques(&tensions);
            for (joint, torque) in [pulled_hip, pulled_knee].into_iter().enumerate() {
                let turned = |by: f64| {
                    let mut angles = state.angles;
                    angles[joint] += by;
                    angles
                };
                let mut work = torque;
                let force = leg.belt_force(&state);
                for axis in 0..2 {
                    work += force[axis] * slope(1e-3, |by| leg.places(&turned(by))[1][axis]);
                }
                let mut inertial = 0.0;
                for (body, segment) in leg.segments.iter().enumerate() {
                    let weights = [segment.mass, segment.mass, segment.inertia];
                    for (axis, weight) in weights.into_iter().enumerate() {
                        let per_turn = slope(1e-3, |by| bodies(turned(by))[body][axis]);
                        let acceleration = slope(2e-4, |time| slope(2e-4, |more| bodies(at(time + more))[body][axis]));
                        let gravity = if axis == 1 { leg.gravity } else { 0.0 };
                        inertial += weight * (acceleration + gravity) * per_turn;
                    }
                }
                assert_within(inertial, work, 1e-6 * (1.0 + work.abs()));
            }
        }
    }
}

#[test]
fn a_strand_does_the_work_that_it_loses_by_shortening() {
    let leg = free();
    for joint in 0..2 {
        let mut angles: [Dual<f64, 1>; 2] = [0.2, -0.3].map(Dual::of);
        angles[joint] = Dual::variable(angles[joint].value, 0);
        let lengths = leg.lengths(&angles);
        for strand in 0..STRANDS {
            let mut tensions = [0.0; STRANDS];
            tensions[strand] = 1.0;
            assert_close(leg.torques(&tensions)[joint] + 1.0, 1.0 - lengths[strand].slope[0], 1e-15);
        }
    }
}

/// With sealed isentropic air, which is a spring of its own, and nothing that rubs.
#[test]
fn energy_of_leg_and_sealed_air_stays_and_the_step_is_of_second_order() {
    let leg = free();
    let paper = Paper::sealed().friction(0.0, 0.0);
    let rig = paper.rig();
    let start = LegState { angles: [0.25, -0.2], rates: [0.0, 1.0] };
    let gauge = GaugePressure(30.0 * PSI);
    let run = |steps: u32| {
        let mut stepper = LegStepper::new(leg, start, [(&rig, gauge); STRANDS], 293.15, 25.0).expect("a leg");
        for count in 1..=steps {
            stepper.advance_to(0.5 * f64::from(count) / f64::from(steps)).expect("a step");
        }
        stepper
    };
    let energy = |stepper: &LegStepper| {
        let gas: f64 = stepper
            .actuators()
            .iter()
            .map(|actuator| {
                let sample = actuator.sample();
                sample.pressure.0 * sample.volume / 0.4 + ATMOSPHERE * sample.volume
            })
            .sum();
        let [kinetic, potential] = leg.energies(stepper.state());
        kinetic + potential + gas
    };
    let begin = LegStepper::new(leg, start, [(&rig, gauge); STRANDS], 293.15, 25.0).expect("a leg");
    let runs = [1000, 2000, 4000].map(run);
    let exact = run(32_000).state().angles[0];
    let errors = runs.each_ref().map(|stepper| (stepper.state().angles[0] - exact).abs());
    for pair in errors.windows(2) {
        assert!((3.6..4.4).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
    let drift = (energy(&runs[2]) - energy(&begin)).abs();
    assert!(drift < 1e-5, "{drift} J of a swing of about 1 J");
    assert!(start.angles[0] - exact > 0.02, "it swings: {exact}");
}

#[test]
fn on_a_belt_at_rest_the_foot_carries_what_the_hip_does_not() {
    // Both joints locked by their stops, the leg straight down and pressed 2 mm into the belt.
    let stiff = |low: f64| Range { ends: [low, low + 1e-6], damping: 0.0, stop_stiffness: 1e5, stop_damping: 0.0 };
    let belt = Belt { depth: 0.578, velocity: 0.0, stiffness: 1e4, damping: 0.0, friction: 0.5, slipping_speed: 0.01 };
    let leg = Leg { ranges: [stiff(0.0), stiff(0.0)], belt: Some(belt), ..free() };
    let still = LegState { angles: [0.0; 2], rates: [0.0; 2] };
    assert_close(leg.belt_force(&still)[1], 20.0, 1e-12);
    assert_within(leg.belt_force(&still)[0], 0.0, 0.0);
    assert_within(leg.accelerations(&still, &[0.0; STRANDS])[0], 0.0, 1e-9);
    // It drags towards where it runs, never more than friction allows.
    for velocity in [-2.0, -0.02, 0.02, 2.0] {
        let leg = Leg { belt: Some(Belt { velocity, ..belt }), ..leg };
        let [across, up] = leg.belt_force(&still);
        assert!(across * velocity > 0.0 && across.abs() < 0.5 * up, "{across} N of {up} N at {velocity} m/s");
        assert_close(across, 0.5 * up * velocity / velocity.hypot(0.01), 1e-12);
    }
}

#[test]
fn pulses_make_it_step_the_way_that_they_pull() {
    let paper = Paper::pwm(25.0, 0.5).friction(60.0, 0.0);
    let rig = paper.rig();
    let damped = |low, high| Range { ends: [low, high], damping: 0.05, stop_stiffness: 50.0, stop_damping: 0.5 };
    let leg = Leg { ranges: [damped(-1.0, 1.0), damped(-1.5, 0.1)], ..free() };
    let still = LegState { angles: [0.0, -0.2], rates: [0.0; 2] };
    let gauge = GaugePressure(10.0 * PSI);
    let mut stepper = LegStepper::new(leg, still, [(&rig, gauge); STRANDS], 293.15, 25.0).expect("a leg");
    let pulses = |duty: f64| Drive::Pulses { duty, pulse: Request::Fill, rest: Request::Exhaust };
    stepper.drive([0.8, 0.2, 0.3, 0.7, 0.3, 0.3].map(pulses)).expect("pulses");
    for count in 1..=20_000 {
        stepper.advance_to(f64::from(count) * 1e-4).expect("a step");
    }
    let [hip, knee] = stepper.state().angles;
    assert!(hip > 0.2 && knee < -0.3, "{hip} {knee}");
    assert!(stepper.actuators()[0].state().pressure.0 > stepper.actuators()[1].state().pressure.0);
}

#[test]
fn what_is_out_of_range_is_refused_by_name() {
    let mut leg = free();
    leg.segments[1].mass = 0.0;
    assert!(leg.checked().expect_err("no mass").to_string().contains("leg.segment_mass"));
    let mut leg = free();
    leg.strands[3].arms[1] = f64::NAN;
    assert!(leg.checked().expect_err("no arm").to_string().contains("leg.moment_arm"));
    let mut leg = free();
    leg.ranges[0].ends = [0.5, 0.5];
    assert!(leg.checked().expect_err("no range").to_string().contains("min_angle"));
    let rig = Paper::sealed().rig();
    let bent = LegState { angles: [-3.0, 0.0], rates: [0.0; 2] };
    let gauge = GaugePressure(0.0);
    let long =
        LegStepper::new(free(), bent, [(&rig, gauge); STRANDS], 293.15, 25.0).expect_err("longer than its thread");
    assert!(long.to_string().contains("thread"), "{long}");
}
