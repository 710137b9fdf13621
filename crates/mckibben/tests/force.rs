//! Static force: the paper's equations transcribed, virtual work, and the three forms of effectiveness.

use crate::common;
use common::{ATMOSPHERE, PSI, Paper, assert_close, assert_within, slope};
use mckibben::force::{Effective, Effectiveness, IdealBraid, MAX_COEFFICIENTS, MAX_KNOTS, StaticForce};
use mckibben::{AbsolutePressure, Braid, Dual, Error, GaugePressure, Over};
use proptest::prelude::*;
use std::f64::consts::PI;

/// (1) with the angle of (2).
fn equation_1(gauge: f64, b: f64, n: f64, length: f64) -> f64 {
    let theta = (length / b).acos();
    gauge * b.powi(2) * (3.0 * theta.cos().powi(2) - 1.0) / (4.0 * PI * n.powi(2))
}

/// (3).
fn equation_3(gauge: f64, b: f64, n: f64, length: f64) -> f64 {
    gauge * b.powi(2) / (4.0 * PI * n.powi(2)) * (3.0 * length.powi(2) / b.powi(2) - 1.0)
}

proptest! {
    #[test]
    fn the_ideal_force_is_the_papers(b in 0.01..2.0_f64, n in 0.5..10.0_f64, share in 0.05..0.99_f64, gauge in -1e5..1e6_f64) {
        let ideal = IdealBraid { braid: Braid::new(b, n).expect("a braid") };
        let length = share * b;
        let force = ideal.force(Dual::<f64, 1>::variable(length, 0), GaugePressure(Dual::of(gauge)));
        // 3L² − b² cancels near the neutral length: compare with the size of its terms.
        let size = gauge.abs() * b * b / (4.0 * PI * n * n);
        prop_assert!((force.value - equation_1(gauge, b, n, length)).abs() < 1e-14 * size.max(1e-300) * 4.0);
        prop_assert!((force.value - equation_3(gauge, b, n, length)).abs() < 1e-14 * size.max(1e-300));
        // (7), and (8) where the force does not vanish.
        let equation_7 = 3.0 * gauge * length / (2.0 * PI * n.powi(2));
        prop_assert!((force.slope[0] - equation_7).abs() <= 1e-14 * equation_7.abs());
        if (share - 1.0 / 3.0_f64.sqrt()).abs() > 0.01 {
            let equation_8 = 6.0 * force.value / (3.0 * length - b.powi(2) / length);
            prop_assert!((force.slope[0] - equation_8).abs() <= 1e-12 * equation_7.abs());
        }
    }

    #[test]
    fn the_gas_does_the_work_that_the_ends_do(b in 0.05..1.0_f64, n in 0.5..5.0_f64, p in 0.1..0.9_f64, q in 0.1..0.9_f64) {
        // At constant pressure ∫F dL = P_g (V₁ − V₂). Simpson's rule is exact for the parabola that F is.
        let gauge = 3e5;
        let ideal = IdealBraid { braid: Braid::new(b, n).expect("a braid") };
        let (start, end) = (p * b, q * b);
        let force = |length: f64| -> f64 { ideal.force(length, GaugePressure(gauge)) };
        let work = (end - start) / 6.0 * (force(start) + 4.0 * force(0.5 * (start + end)) + force(end));
        let volume = |length: f64| -> f64 { ideal.braid.volume(length) };
        let scale = gauge * b.powi(3) / (4.0 * PI * n * n);
        prop_assert!((work - gauge * (volume(start) - volume(end))).abs() < 1e-14 * scale);
    }

    #[test]
    fn the_secant_stiffness_is_the_secants(share in 0.6..0.95_f64, from in 0.3..0.55_f64, gauge in 1e4..1e6_f64) {
        let table = Effectiveness::table(&[0.0, 4e5, 8e5], &[0.5, 0.8, 0.9]).expect("a table");
        let law = Effective { law: IdealBraid { braid: Braid::new(0.11, 2.5).expect("a braid") }, effectiveness: table };
        let (length, from) = (share * 0.11, from * 0.11);
        let force = |length: f64| -> f64 { law.force(length, GaugePressure(gauge)) };
        // (13): a quotient of differences, here taken far from its 0/0.
        let literal = (force(length) - force(from)) / (length - from);
        let secant: f64 = law.secant_stiffness(length, from, GaugePressure(gauge));
        prop_assert!((secant / literal - 1.0).abs() < 1e-12);
        // At L = from the secant is the tangent.
        let tangent = law.force(Dual::<f64, 1>::variable(from, 0), GaugePressure(Dual::of(gauge))).slope[0];
        let there: f64 = law.secant_stiffness(from, from, GaugePressure(gauge));
        prop_assert!((there / tangent - 1.0).abs() < 1e-14);
    }

    #[test]
    fn a_table_never_overshoots(
        steps in prop::collection::vec((1.0..100.0_f64, 0.0..2.0_f64), 2..=MAX_KNOTS),
        places in prop::collection::vec(0.0..1.0_f64, 40),
    ) {
        let mut pressures = Vec::new();
        let mut sum = -50.0;
        for (width, _) in &steps {
            sum += width;
            pressures.push(sum * 1e3);
        }
        let values: Vec<f64> = steps.iter().map(|(_, value)| *value).collect();
        let table = Effectiveness::table(&pressures, &values).expect("a table");
        let at = |pressure: f64| -> f64 { table.at(GaugePressure(pressure)) };
        for row in 0..pressures.len() - 1 {
            let (low, high) = (values[row].min(values[row + 1]), values[row].max(values[row + 1]));
            let mut before = at(pressures[row]);
            prop_assert!((before - values[row]).abs() < 1e-14);
            let mut sorted = places.clone();
            sorted.sort_by(f64::total_cmp);
            for place in sorted {
                let now = at(pressures[row] + place * (pressures[row + 1] - pressures[row]));
                prop_assert!(now >= low - 1e-14 && now <= high + 1e-14, "{now} outside {low}..{high}");
                // Monotone between two knots.
                prop_assert!((now - before) * (values[row + 1] - values[row]) >= -1e-14);
                before = now;
            }
        }
        prop_assert_eq!(at(pressures[0] - 1.0), values[0]);
        prop_assert_eq!(at(-1e9), values[0]);
        prop_assert_eq!(at(pressures[pressures.len() - 1] + 1.0), values[values.len() - 1]);
    }
}

/// Pressure in Pa, value and slope in 1/Pa.
type Row = (f64, f64, f64);

/// Computed with `scipy.interpolate.PchipInterpolator` of SciPy 1.17.1.
#[test]
fn a_table_is_the_interpolant_that_scipy_calls_pchip() {
    let rising = ([100e3, 200e3, 350e3, 420e3, 600e3], [0.55, 0.7, 0.86, 0.86, 0.91]);
    let from_scipy: [Row; 9] = [
        (120e3, 0.5829836403969644, 1.6224018680677164e-6),
        (150e3, 0.630154845300642, 1.5164302393461755e-6),
        (200e3, 0.7, 1.2609457092819614e-6),
        (275e3, 0.8036427320490367, 1.2847635726795101e-6),
        (300e3, 0.8325290263994293, 1.001906985794902e-6),
        (400e3, 0.86, 0.0),
        (450e3, 0.861712962962963, 1.1203703703703713e-7),
        (500e3, 0.8714128943758573, 2.6995884773662577e-7),
        (590e3, 0.905292524005487, 4.634773662551444e-7),
    ];
    check_table(&rising.0, &rising.1, &from_scipy);
    let crooked = ([0.0, 1e5, 3e5, 4e5], [0.5, 0.9, 0.4, 0.45]);
    let from_scipy: [Row; 7] = [
        (0.3e5, 0.67705, 5.471666666666667e-6),
        (0.9e5, 0.89435, 1.1116666666666665e-6),
        (1.5e5, 0.821875, -2.8125e-6),
        (2.9e5, 0.4036250000000001, -7.124999999999987e-7),
        (3.1e5, 0.40005, 1.5e-8),
        (3.5e5, 0.40625, 3.7499999999999996e-7),
        (3.99e5, 0.44851495, 1.4701499999999998e-6),
    ];
    check_table(&crooked.0, &crooked.1, &from_scipy);
}

fn check_table(pressures: &[f64], values: &[f64], expected: &[Row]) {
    let table = Effectiveness::table(pressures, values).expect("a table");
    for &(pressure, value, derivative) in expected {
        let got = table.at(GaugePressure(Dual::<f64, 1>::variable(pressure, 0)));
        // A few roundings of values of order one, and of slopes of order one over the width.
        assert_within(got.value, value, 4e-16);
        assert_within(got.slope[0], derivative, 1e-20);
    }
}

#[test]
fn two_rows_are_joined_by_a_straight_line() {
    let table = Effectiveness::table(&[1e5, 3e5], &[0.4, 0.8]).expect("a table");
    for share in [0.0, 0.25, 0.5, 0.9, 1.0] {
        let value: f64 = table.at(GaugePressure(1e5 + share * 2e5));
        assert_within(value, 0.4 + 0.4 * share, 4e-16);
    }
}

#[test]
fn a_polynomial_is_the_sum_of_its_powers() {
    let coefficients = [0.7, 3e-7, -2e-13, 5e-20, -1e-26, 2e-33, -3e-40, 1e-47];
    assert_eq!(coefficients.len(), MAX_COEFFICIENTS);
    let law = Effectiveness::polynomial(&coefficients).expect("a polynomial");
    for gauge in [-5e4_f64, 0.0, 1e5, 4.1e5, 7e5] {
        let literal: f64 = coefficients.iter().zip(0..).map(|(c, k)| c * gauge.powi(k)).sum();
        let value: f64 = law.at(GaugePressure(gauge));
        assert_close(value, literal, 1e-15);
    }
}

#[test]
fn the_force_is_multiplied_by_the_effectiveness_and_its_slope_over_pressure_with_it() {
    let table = Effectiveness::table(&[1e5, 2e5, 3.5e5, 6e5], &[0.55, 0.7, 0.86, 0.91]).expect("a table");
    let polynomial = Effectiveness::polynomial(&[0.5, 1e-6, -5e-13]).expect("a polynomial");
    for effectiveness in [Effectiveness::Constant(0.9), polynomial, table] {
        let paper = Paper::sealed().with(|rig| rig.effectiveness = effectiveness);
        let (actuator, b, n) = (paper.actuator(), paper.thread_length, paper.turns);
        for (length, gauge) in [(0.07, 1.5e5), (0.09, 2.7e5), (0.095, 4.4e5)] {
            let ratio: f64 = effectiveness.at(GaugePressure(gauge));
            let force: f64 = actuator.static_force(length, gauge + ATMOSPHERE);
            assert_close(force, ratio * equation_3(gauge, b, n, length), 1e-13);
            let dual = actuator.static_force(Dual::of(length), Dual::<f64, 1>::variable(gauge + ATMOSPHERE, 0));
            let along = slope(10.0, |h| actuator.static_force(length, gauge + ATMOSPHERE + h));
            // Differences over 10 Pa lose 1e-16 · F/(10 Pa), nine digits below F/P.
            assert_close(dual.slope[0], along, 1e-8);
            let stiffness = actuator.stiffness(length, AbsolutePressure(gauge + ATMOSPHERE));
            assert_close(stiffness, ratio * 3.0 * gauge * length / (2.0 * PI * n.powi(2)), 1e-13);
        }
    }
}

#[test]
fn the_papers_actuator_lifts_what_the_paper_hangs_on_it() {
    // Section 2.1: up to 15 lb hang from the muscle; the assumed n lets it hold them at 60 psi within its range.
    let paper = Paper::sealed();
    let law = IdealBraid { braid: paper.braid() };
    let force: f64 = law.force(paper.max_length, GaugePressure(60.0 * PSI));
    assert!(force > 15.0 * common::LBF, "{force} N at full stretch");
    let at_neutral: f64 = law.force(paper.braid().neutral_length(), GaugePressure(60.0 * PSI));
    assert_within(at_neutral, 0.0, 1e-12);
    assert!(at_neutral < force);
}

#[test]
fn malformed_effectiveness_is_refused_where_it_is_wrong() {
    let entry = |result: Result<Effectiveness, Error>| match result {
        Err(Error::Table { entry, .. }) => entry,
        other => panic!("{other:?}"),
    };
    assert_eq!(entry(Effectiveness::table(&[0.0, 1.0, 1.0], &[1.0; 3])), 3);
    assert_eq!(entry(Effectiveness::table(&[0.0, 2.0, 1.0], &[1.0; 3])), 3);
    assert_eq!(entry(Effectiveness::table(&[0.0, 1.0, 2.0], &[1.0, -0.1, 1.0])), 2);
    assert_eq!(entry(Effectiveness::table(&[0.0, 1.0], &[1.0, f64::NAN])), 2);
    assert_eq!(entry(Effectiveness::table(&[0.0, 1.0, 2.0], &[1.0, 1.0])), 3);
    assert_eq!(entry(Effectiveness::table(&[0.0], &[1.0])), 2);
    assert_eq!(entry(Effectiveness::table(&[0.0; MAX_KNOTS + 1], &[1.0; MAX_KNOTS + 1])), MAX_KNOTS + 1);
    assert_eq!(entry(Effectiveness::polynomial(&[])), 1);
    assert_eq!(entry(Effectiveness::polynomial(&[1.0; MAX_COEFFICIENTS + 1])), MAX_COEFFICIENTS + 1);
    assert_eq!(entry(Effectiveness::polynomial(&[1.0, f64::INFINITY])), 2);
    assert!(matches!(Effectiveness::constant(-0.1), Err(Error::OutOfRange { .. })));
}
