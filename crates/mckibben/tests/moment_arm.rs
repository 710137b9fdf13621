//! Moment arms by a table: SciPy's interpolant and its integral, two closed forms, virtual work, the inverse, equivalence
//! with the pulley, stiffness and period with an arm that changes, events at the rows, energy, and what is refused.

use crate::common::joint::Pair;
use crate::common::random::runner;
use crate::common::{ATMOSPHERE, PSI, Paper, assert_close, assert_within, bisect, slope};
use mckibben::control::{AntagonisticPair, Held};
use mckibben::load::{MomentArm, Tendon};
use mckibben::plant::JointPlant;
use mckibben::simulation::{EventKind, InitialAngle};
use mckibben::valve::{Command, Request};
use mckibben::{AbsolutePressure, Dual, GaugePressure};
use proptest::prelude::*;
use std::f64::consts::PI;

const ANGLES: [f64; 6] = [-0.9, -0.5, -0.1, 0.2, 0.6, 1.0];
const ARMS: [f64; 6] = [0.012, 0.0155, 0.0162, 0.0161, 0.0188, 0.0241];

fn table(angle: &[f64], arm: &[f64]) -> MomentArm {
    MomentArm::table(angle, arm).expect("a table")
}

/// Arms that grow the way that the joint turns, mirrored for the antagonist.
fn varied() -> Pair {
    Pair::of(Paper::sealed().friction(0.0, 0.0).gauge(40.0 * PSI)).with(|pair| {
        let rising = table(&[-0.5, -0.2, 0.1, 0.4], &[0.011, 0.014, 0.016, 0.017]);
        let falling = table(&[-0.4, -0.1, 0.2, 0.5], &[0.017, 0.016, 0.014, 0.011]);
        pair.tendons = [rising, falling].map(|arm| Tendon { arm, rest_length: 0.082 });
    })
}

fn pulses(frequency: f64, duty: f64) -> Command {
    Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("a command")
}

/// `PchipInterpolator(ANGLES, ARMS)` of SciPy 1.17.1 and the difference of its `antiderivative()` from that at zero.
#[test]
fn arm_and_excursion_are_those_of_scipy() {
    let arm = table(&ANGLES, &ARMS);
    for (angle, expected, excursion) in [
        (-0.9, 0.012, -0.013622407407407408),
        (-0.73, 0.013926560416666667, -0.011413216471643518),
        (-0.3, 0.01599583333333333, -0.00484497685185185),
        (0.0, 0.016174074074074073, 0.0),
        (0.11, 0.0161216, 0.0017762374259259282),
        (0.45, 0.0174216552734375, 0.007370333579734522),
        (0.83, 0.0214859319140625, 0.01469699092504702),
        (1.0, 0.024100000000000003, 0.018565925925925923),
    ] {
        let [found, length] = arm.at(angle);
        assert_close(found, expected, 1e-14);
        assert_within(length, excursion, 1e-16);
    }
}

/// Two rows are a straight line, whose integral is a parabola; beyond them the arm stays.
#[test]
fn two_rows_are_a_line_and_the_ends_hold_on() {
    let arm = table(&[-0.5, 1.5], &[0.01, 0.03]);
    for angle in [-0.5, -0.2, 0.0, 0.7, 1.5] {
        assert_close(arm.at(angle)[0], 0.015 + 0.01 * angle, 1e-14);
        assert_within(arm.at(angle)[1], 0.015 * angle + 0.005 * angle * angle, 1e-17);
    }
    let (low, high) = (arm.at(-0.5)[1], arm.at(1.5)[1]);
    for beyond in [1e-9, 0.3, 4.0] {
        assert_eq!((arm.at(-0.5 - beyond)[0], arm.at(1.5 + beyond)[0]), (0.01, 0.03));
        assert_within(arm.at(-0.5 - beyond)[1], low - 0.01 * beyond, 1e-16);
        assert_within(arm.at(1.5 + beyond)[1], high + 0.03 * beyond, 1e-16);
    }
    // A table that does not hold angle zero counts its excursion from there all the same.
    let away = table(&[0.5, 1.5], &[0.02, 0.03]);
    assert_within(away.at(0.0)[1], 0.0, 1e-17);
    assert_within(away.at(1.5)[1], 0.5 * 0.02 + 0.025, 1e-16);
}

/// A tendon straight from a point at a on the one link to a point at b on the other: `L² = a² + b² + 2 a b sin θ`,
/// `dL/dθ = a b cos θ/L`. The table nears it as its rows become dense.
#[test]
fn a_table_nears_the_triangle_of_two_attachments() {
    let (a, b) = (0.03_f64, 0.25_f64);
    let length = |angle: f64| (a * a + b * b + 2.0 * a * b * angle.sin()).sqrt();
    let arm = |angle: f64| a * b * angle.cos() / length(angle);
    let worst = |rows: usize| {
        let angles: Vec<f64> = (0..rows).map(|row| -1.0 + 2.0 * row as f64 / (rows - 1) as f64).collect();
        let table = table(&angles, &angles.iter().map(|angle| arm(*angle)).collect::<Vec<_>>());
        let errors = (0..=400).map(|place| {
            let angle = -1.0 + f64::from(place) / 200.0;
            (table.at(angle)[1] - (length(angle) - length(0.0))).abs()
        });
        errors.fold(0.0, f64::max)
    };
    let errors = [4, 8, 16].map(worst);
    assert!(errors[2] < 2e-5, "{errors:?}");
    assert!(errors[0] > 4.0 * errors[1] && errors[1] > 4.0 * errors[2], "{errors:?}");
}

#[test]
fn the_length_is_the_integral_of_the_arm_and_the_inverse_comes_back() {
    let rows = (2..16_usize)
        .prop_flat_map(|rows| (prop::collection::vec((0.02..1.0_f64, 1e-3..0.1_f64), rows), -3.0..0.5_f64));
    let result = runner(500).run(&rows, |(rows, first)| {
        let further = |angle: &mut f64, (wide, _): &(f64, f64)| {
            *angle += wide;
            Some(*angle)
        };
        let angles: Vec<f64> = rows.iter().scan(first, further).collect();
        let arms: Vec<f64> = rows.iter().map(|(_, arm)| *arm).collect();
        let of = table(&angles, &arms);
        let (low, high) = (angles[0] - 0.5, angles[angles.len() - 1] + 0.5);
        for place in 0..=60 {
            let angle = low + (high - low) * f64::from(place) / 60.0;
            let [arm, excursion] = of.at(angle);
            let wide: [Dual<f64, 1>; 2] = of.at(Dual::variable(angle, 0));
            prop_assert!((wide[1].slope[0] - arm).abs() <= 1e-13, "{angle}: {wide:?}");
            prop_assert!((of.angle_of(excursion) - angle).abs() <= 1e-12, "{angle}: {}", of.angle_of(excursion));
            let between = arms.iter().copied().fold(f64::INFINITY, f64::min)..=arms.iter().copied().fold(0.0, f64::max);
            prop_assert!(between.contains(&arm) || arms.iter().any(|row| (row - arm).abs() < 1e-15), "{arm}");
        }
        // Pieces agree on their rows, in value and slope.
        for (row, angle) in angles.iter().enumerate() {
            let at = |piece: usize| of.in_piece(piece, Dual::<f64, 1>::variable(*angle, 0));
            let ([before, _], [after, _]) = (at(row), at(row + 1));
            prop_assert!((before.value - after.value).abs() < 1e-15);
            let inner = row > 0 && row + 1 < angles.len();
            prop_assert!(!inner || (before.slope[0] - after.slope[0]).abs() < 1e-12, "{before:?} {after:?}");
        }
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
}

/// Rows of one radius are the pulley, rows or not.
#[test]
fn a_table_of_one_arm_is_the_pulley() {
    let pair = Pair::of(Paper::driven(pulses(20.0, 0.6))).with(|pair| {
        pair.papers[1].command = Some(pulses(7.0, 0.3));
        pair.limb.distance = 0.12;
    });
    let same = pair.clone().with(|pair| {
        for tendon in &mut pair.tendons {
            tendon.arm = table(&[-0.3, -0.05, 0.0, 0.2], &[0.015; 4]);
        }
    });
    let (pulley, tabled) = (pair.run(0.6, 1e-11), same.run(0.6, 1e-11));
    for (a, b) in pulley.samples(1e-2).zip(tabled.samples(1e-2)) {
        assert_within(a.angle, b.angle, 1e-9);
        assert_close(a.actuators[0].pressure.0, b.actuators[0].pressure.0, 1e-8);
    }
    let rows = tabled.events().iter().filter(|event| event.kind.kind == EventKind::MomentArm).count();
    assert!(rows > 4, "{rows}");
}

#[test]
fn torque_is_arm_times_tension_and_energy_closes() {
    let pair = varied().with(|pair| {
        pair.papers = [Paper::driven(pulses(20.0, 0.6)), Paper::driven(pulses(7.0, 0.3))];
        pair.limb.distance = 0.12;
    });
    let run = pair.run(1.0, 1e-10);
    let mut rows = [0, 0];
    for event in run.events().iter().filter(|event| event.kind.kind == EventKind::MomentArm) {
        let actuator = event.kind.actuator.expect("of an actuator");
        let angles = [[-0.5, -0.2, 0.1, 0.4], [-0.4, -0.1, 0.2, 0.5]][actuator];
        let angle = run.at(event.time).angle;
        assert!(angles.iter().any(|row| (angle - row).abs() < 1e-9), "{angle}");
        rows[actuator] += 1;
    }
    assert!(rows[0] > 0 && rows[1] > 0, "{rows:?}");
    for sample in run.samples(7e-3) {
        let arms = pair.tendons.map(|tendon| tendon.arm.at(sample.angle)[0]);
        let [agonist, antagonist] = sample.actuators;
        assert_within(sample.torque, arms[0] * agonist.tension - arms[1] * antagonist.tension, 1e-12);
        assert_close(agonist.velocity, -arms[0] * sample.angular_velocity, 1e-9);
        assert_close(antagonist.velocity, arms[1] * sample.angular_velocity, 1e-9);
    }
    let work = run.ledger().work();
    assert_within(work.residual, 0.0, 1e-8 * work.turnover);
}

/// Static torque written out again, with the pressures kept or following their volumes.
fn torque(pair: &Pair, angle: f64, from: f64, gauge: [f64; 2], held: Held) -> f64 {
    let at = |i: usize| {
        let (paper, tendon) = (&pair.papers[i], &pair.tendons[i]);
        let actuator = paper.actuator();
        let length = |angle: f64| tendon.rest_length + [-1.0, 1.0][i] * tendon.arm.at(angle)[1];
        let volume = |angle: f64| actuator.volume(length(angle));
        let index = actuator.air().index();
        let kept = (gauge[i] + ATMOSPHERE) * (volume(from) / volume(angle)).powf(index) - ATMOSPHERE;
        let gauge = if held == Held::Pressures { gauge[i] } else { kept };
        tendon.arm.at(angle)[0] * actuator.tension_sliding(length(angle), 0.0, gauge + ATMOSPHERE, 0.0)
    };
    at(0) - at(1)
}

#[test]
fn stiffness_includes_the_derivatives_of_the_moment_arms() {
    let (pair, gauge) = (varied(), [35.0 * PSI, 50.0 * PSI]);
    let rig = pair.rig().expect("a rig");
    for held in [Held::Pressures, Held::AirMasses] {
        for angle in [-0.3, -0.15, 0.02, 0.25] {
            let found = rig.stiffness(angle, gauge.map(|gauge| AbsolutePressure(gauge + ATMOSPHERE)), held);
            let expected = -slope(1e-4, |turn| torque(&pair, angle + turn, angle, gauge, held));
            assert_close(found, expected, 1e-6);
            let leverage = rig.joint().leverage(Dual::<f64, 1>::variable(angle, 0));
            let actuators = rig.driven().each_ref().map(|driven| &driven.actuator);
            let (lengths, arms) = (leverage.lengths.map(|of| of.value), leverage.arms.map(|of| of.value));
            let turned = AntagonisticPair::new(actuators, lengths, arms)
                .and_then(|pair| pair.with_arm_slopes(leverage.arms.map(|arm| arm.slope[0])))
                .expect("a pair");
            assert_close(turned.stiffness(gauge.map(GaugePressure), held), expected, 1e-6);
            let back = turned.pressures(turned.torque(gauge.map(GaugePressure)), found, held).expect("pressures");
            for i in 0..2 {
                assert_close(back[i].0, gauge[i], 1e-9);
            }
        }
    }
}

/// Small oscillations about the balance: `2π √(J/K)` with the sealed stiffness above.
#[test]
fn small_oscillations_have_the_period_of_the_whole_stiffness() {
    let pair = varied();
    let gauge = [40.0 * PSI; 2];
    let balance = bisect(-0.4, 0.4, |angle| -torque(&pair, angle, angle, gauge, Held::Pressures));
    let stiffness = -slope(1e-4, |turn| torque(&pair, balance + turn, balance, gauge, Held::AirMasses));
    let period = 2.0 * PI * (1e-3 / stiffness).sqrt();
    let rig = pair.rig().expect("a rig");
    let balanced = pair.clone().with(|pair| pair.angle = InitialAngle::Equilibrium);
    let start = rig.start(&balanced.initial()).expect("a start");
    assert_within(start.angle, balance, 1e-9);
    let mut start = start;
    start.angular_velocity = 1e-4 * (stiffness / 1e-3).sqrt();
    let run = JointPlant::new(&rig).and_then(|joint| joint.simulate(&start, 10.5 * period, 1e-11)).expect("runs");
    let crossing =
        |count: f64| bisect((count - 0.05) * period, (count + 0.05) * period, |time| run.at(time).angle - balance);
    assert_close((crossing(10.0) - crossing(0.5)) / 9.5, period, 1e-5);
}

/// From a row on, either way, the arm is that of the piece that follows.
#[test]
fn a_run_may_begin_on_a_row() {
    for speed in [-3.0, 3.0] {
        let pair = varied().with(|pair| {
            pair.angle = InitialAngle::At(0.1);
            pair.angular_velocity = speed;
        });
        let run = pair.run(0.05, 1e-10);
        let after = run.at(0.01);
        let arm = pair.tendons[0].arm.at(after.angle)[0];
        assert_within(
            after.torque,
            arm * after.actuators[0].tension - pair.tendons[1].arm.at(after.angle)[0] * after.actuators[1].tension,
            1e-12,
        );
        let work = run.ledger().work();
        assert_within(work.residual, 0.0, 1e-8 * work.turnover);
    }
}

#[test]
fn what_is_no_table_of_arms_is_refused_with_a_reason() {
    let error_of = |angle: &[f64], arm: &[f64]| MomentArm::table(angle, arm).expect_err("refused").to_string();
    for (angle, arm, words) in [
        (&[0.0][..], &[0.01][..], "too few entries"),
        (&[0.0, 1.0], &[0.01], "not as many entries"),
        (&[0.0, 0.0], &[0.01, 0.01], "do not rise"),
        (&[0.0, f64::NAN], &[0.01, 0.01], "load.moment_arm_angle"),
        (&[0.0, 1.0], &[0.01, 0.0], "load.moment_arm = 0 m"),
    ] {
        let error = error_of(angle, arm);
        assert!(error.contains(words), "{error}");
    }
    let many: Vec<f64> = (0..17).map(f64::from).collect();
    assert!(error_of(&many, &[0.01; 17]).contains("keep to 16 rows"));
    // Arms that change so fast that more pressure in both softens the joint have no pressures for a stiffness.
    let paper = Paper::sealed();
    let actuators = [paper.actuator(), paper.actuator()];
    let pair = AntagonisticPair::new(actuators.each_ref(), [0.085; 2], [0.015; 2]).expect("a pair");
    let error = pair.with_arm_slopes([0.02, -0.02]).expect_err("refused").to_string();
    assert!(error.contains("makes the joint softer"), "{error}");
}
