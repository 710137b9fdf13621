//! A measured force map: through its nodes, smooth, monotone where it was measured so, a plane outside; its derivatives and
//! secants; and both engines, with the lines of its grid as events.

use crate::common;
use crate::common::laws;
use crate::common::steps::RigSteps;

use common::accounts::Audited;
use common::{PSI, Paper, assert_close, assert_within, slope, spread};
use mckibben::force::{ForceMap, MAX_MAP, Piece, StaticForce};
use mckibben::simulation::{EventKind, Method};
use mckibben::{Dual, Error, GaugePressure, Over};

/// A grid whose steps differ, with tensions that rise with length and pressure by steps that differ much.
fn random(seed: usize) -> ([Vec<f64>; 3], ForceMap) {
    let (rows, columns) = (2 + seed % 5, 2 + seed % 4);
    let rising = |count: usize, column: usize, start: f64, step: f64| -> Vec<f64> {
        let mut place = start;
        (0..count)
            .map(|n| {
                place += step * (0.2 + spread(31 * seed + n, column));
                place
            })
            .collect()
    };
    let pressures = rising(rows, 0, 5e4, 1e5);
    let lengths = rising(columns, 1, 0.05, 0.01);
    let mut tensions = vec![0.0; rows * columns];
    for row in 0..rows {
        for column in 0..columns {
            let below = if row > 0 { tensions[(row - 1) * columns + column] } else { 0.0 };
            let before = if column > 0 { tensions[row * columns + column - 1] } else { 0.0 };
            let jump = spread(97 * seed + row * columns + column, 2);
            tensions[row * columns + column] =
                f64::max(below, before) + if jump < 0.3 { 0.0 } else { 30.0 * jump.powi(4) };
        }
    }
    let map = ForceMap::new(&pressures, &lengths, &tensions).expect("a map");
    ([pressures, lengths, tensions], map)
}

fn force(map: &ForceMap, length: f64, gauge: f64) -> f64 {
    map.force(length, GaugePressure(gauge))
}

#[test]
fn the_surface_goes_through_every_node() {
    for seed in 0..40 {
        let ([pressures, lengths, tensions], map) = random(seed);
        for (row, &gauge) in pressures.iter().enumerate() {
            for (column, &length) in lengths.iter().enumerate() {
                assert_within(force(&map, length, gauge), tensions[row * lengths.len() + column], 1e-12 * 200.0);
            }
        }
    }
}

#[test]
fn a_plane_is_itself_everywhere() {
    let plane = |length: f64, gauge: f64| 3.0 + 500.0 * length + 2e-5 * gauge;
    let (pressures, lengths) = ([1e5, 2.5e5, 3e5], [0.06, 0.07, 0.1, 0.11]);
    let tensions: Vec<f64> =
        pressures.iter().flat_map(|&gauge| lengths.iter().map(move |&length| plane(length, gauge))).collect();
    let map = ForceMap::new(&pressures, &lengths, &tensions).expect("a map");
    for place in 0..100 {
        let (length, gauge) = (common::between(place, 0, 0.04, 0.13), common::between(place, 1, -1e5, 5e5));
        assert_close(force(&map, length, gauge), plane(length, gauge), 1e-12);
        let inside = (0.06..=0.11).contains(&length) && (1e5..=3e5).contains(&gauge);
        assert_eq!(map.covers(length, GaugePressure(gauge)), inside);
    }
}

#[test]
fn the_surface_rises_wherever_the_measured_tensions_do() {
    let mut bent = 0;
    for seed in 0..300 {
        let ([pressures, lengths, _], map) = random(seed);
        let fine = 40;
        let along = |knots: &[f64], n: usize| knots[0] + (knots[knots.len() - 1] - knots[0]) * n as f64 / fine as f64;
        for row in 0..=fine {
            for column in 0..fine {
                let (here, next) = (along(&lengths, column), along(&lengths, column + 1));
                let gauge = along(&pressures, row);
                let rise = force(&map, next, gauge) - force(&map, here, gauge);
                assert!(rise >= -1e-10, "map {seed} falls by {rise} over length");
                let (low, high) = (along(&pressures, column), along(&pressures, column + 1));
                let length = along(&lengths, row);
                let rise = force(&map, length, high) - force(&map, length, low);
                assert!(rise >= -1e-10, "map {seed} falls by {rise} over pressure");
                bent += usize::from(rise > 1e-3);
            }
        }
    }
    assert!(bent > 10_000, "the maps are flat");
}

/// On one row of nodes the surface is the cubic of Fritsch & Butland, here by the textbook's Hermite formula.
#[test]
fn along_the_border_it_is_the_monotone_cubic() {
    let lengths = [0.06, 0.07, 0.1];
    let values = [1.0, 4.0, 6.0];
    let tensions: Vec<f64> = [values, values].concat();
    let map = ForceMap::new(&[1e5, 2e5], &lengths, &tensions).expect("a map");
    let secants = [300.0, 2.0 / 0.03];
    let middle = {
        let (h0, h1) = (0.01, 0.03);
        let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
        (w0 + w1) / (w0 / secants[0] + w1 / secants[1])
    };
    let first = ((2.0 * 0.01 + 0.03) * secants[0] - 0.01 * secants[1]) / 0.04;
    for n in 0..=20 {
        let u = f64::from(n) / 20.0;
        let (h00, h10) = ((1.0 + 2.0 * u) * (1.0 - u).powi(2), u * (1.0 - u).powi(2));
        let (h01, h11) = (u * u * (3.0 - 2.0 * u), u * u * (u - 1.0));
        let expected = h00 + 0.01 * h10 * first + 4.0 * h01 + 0.01 * h11 * middle;
        assert_close(force(&map, 0.06 + 0.01 * u, 1.5e5), expected, 1e-12);
    }
}

#[test]
fn derivatives_are_exact_and_continuous_over_every_line() {
    for seed in 0..40 {
        let ([pressures, lengths, _], map) = random(seed);
        let dual = |length: f64, gauge: f64| -> Dual<f64, 2> {
            map.force(Dual::variable(length, 0), GaugePressure(Dual::variable(gauge, 1)))
        };
        let bend = |size: f64| 1e-6 * size + 1e-7;
        for place in 0..30 {
            let (length, gauge) = (common::between(place, 0, 0.045, 0.12), common::between(place, 1, 0.0, 6e5));
            // A five-point rule does not see a kink of the second derivative within its reach as none.
            let near = |knots: &[f64], at: f64, reach: f64| knots.iter().any(|knot| (knot - at).abs() < reach);
            if near(&lengths, length, 2e-5) || near(&pressures, gauge, 200.0) {
                continue;
            }
            let value = dual(length, gauge);
            let by_length = slope(1e-6, |h| force(&map, length + h, gauge));
            let by_pressure = slope(10.0, |h| force(&map, length, gauge + h));
            assert_within(value.slope[0], by_length, bend(1e4));
            assert_within(value.slope[1], by_pressure, bend(1e-3));
        }
        for &knot in &lengths {
            let gauge = 2e5 + 1e4 * seed as f64;
            let (before, after) = (dual(knot * (1.0 - 1e-12), gauge), dual(knot * (1.0 + 1e-12), gauge));
            assert_within(before.slope[0], after.slope[0], 1e-5 * (1.0 + after.slope[0].abs()));
        }
    }
}

#[test]
fn each_piece_is_the_surface_between_its_bounds_and_goes_on_smoothly() {
    for seed in 0..40 {
        let ([pressures, lengths, _], map) = random(seed);
        for place in 0..60 {
            let (length, gauge) = (common::between(place, 0, 0.045, 0.12), common::between(place, 1, 0.0, 6e5));
            let of = |knots: &[f64], at: f64| knots.iter().filter(|knot| **knot < at).count();
            let piece = Piece { length: of(&lengths, length), pressure: of(&pressures, gauge) };
            let (low, high) = map.length_bounds(piece.length);
            assert!(low.is_none_or(|low| low < length) && high.is_none_or(|high| length <= high));
            let (low, high) = map.pressure_bounds(piece.pressure);
            assert!(low.is_none_or(|low| low < gauge) && high.is_none_or(|high| gauge <= high));
            let whole = force(&map, length, gauge);
            assert_within(map.in_piece(piece, length, GaugePressure(gauge)), whole, 1e-11 * (1.0 + whole.abs()));
        }
    }
}

#[test]
fn the_secant_is_the_quotient_over_any_number_of_lines() {
    for seed in 0..40 {
        let ([_, lengths, _], map) = random(seed);
        for place in 0..40 {
            let gauge = common::between(place, 1, 0.0, 6e5);
            let (length, from) = (common::between(place, 0, 0.045, 0.12), common::between(place, 2, 0.045, 0.12));
            let secant: f64 = map.secant_stiffness(length, from, GaugePressure(gauge));
            let quotient = (force(&map, length, gauge) - force(&map, from, gauge)) / (length - from);
            let size =
                (1.0 + force(&map, length, gauge).abs() + force(&map, from, gauge).abs()) / (length - from).abs();
            assert_within(secant, quotient, 1e-12 * size);
            for at in [from, lengths[0], lengths[lengths.len() - 1]] {
                let tangent: Dual<f64, 1> = map.force(Dual::variable(at, 0), GaugePressure(Dual::of(gauge)));
                let here: f64 = map.secant_stiffness(at, at, GaugePressure(gauge));
                assert_within(here, tangent.slope[0], 1e-10 * (1.0 + here.abs()));
            }
        }
    }
}

#[test]
fn both_engines_agree_and_the_lines_of_the_grid_are_events() {
    let paper = Paper::pwm(20.0, 0.5).gauge(40.0 * PSI);
    let ideal = paper.run(0.1, 1e-9).at(0.1);
    let paper = paper.clone().with(|rig| rig.characteristic = Some(laws::measured(&paper)));
    let (rig, start) = (paper.rig(), paper.start());
    let run = paper.run(0.1, 1e-9);
    let located = run.at(0.1);
    let mut stepper = RigSteps::new(&rig, start, Method::Rk4);
    for step in 1..=8000 {
        stepper.advance_to(0.1 * f64::from(step) / 8000.0).expect("a step");
    }
    let stepped = stepper.state();
    assert_within(stepped.length, located.length, 2e-7);
    assert_close(stepped.pressure.0, located.pressure.0, 2e-5);
    let lines = run.events().iter().filter(|event| event.kind == EventKind::ForceMap).count();
    assert!(lines > 4, "{lines} events");
    // A map of the ideal braid moves nearly as the ideal braid.
    assert_within(located.length, ideal.length, 2e-4);
    let audit = run.audit();
    assert!(audit.residual().abs() < 1e-7 * audit.turnover(), "{audit:?}");
}

#[test]
fn a_malformed_map_is_refused_where_it_is_wrong() {
    let refuse = |pressure: &[f64], length: &[f64], tension: &[f64]| match ForceMap::new(pressure, length, tension) {
        Err(Error::Table { name, entry, .. }) => (name.rsplit('.').next().unwrap_or(name), entry),
        other => panic!("{other:?}"),
    };
    let (two, four) = ([0.1, 0.2], [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(refuse(&[1.0], &two, &four), ("gauge_pressure", 2));
    assert_eq!(refuse(&two, &[0.2, 0.1], &four), ("length", 2));
    assert_eq!(refuse(&two, &[-0.2, 0.1], &four), ("length", 1));
    assert_eq!(refuse(&two, &two, &four[..3]), ("tension", 4));
    assert_eq!(refuse(&two, &two, &[1.0, f64::NAN, 3.0, 4.0]), ("tension", 2));
    let many: Vec<f64> = (0..=MAX_MAP).map(|n| n as f64 + 1.0).collect();
    assert_eq!(refuse(&many, &two, &four), ("gauge_pressure", MAX_MAP + 1));
}
