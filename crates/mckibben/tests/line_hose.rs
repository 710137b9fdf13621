//! A single hose: volumes, wave speed and attenuation against the closed form of the line.

use crate::common;
use common::{ATMOSPHERE, Paper, ROOM, assert_close};
use mckibben::Dual;
use mckibben::line::linear::{Complex, LinearLine};
use mckibben::line::{Hose, HoseKind, MAX_CELLS};
use std::f64::consts::PI;

const LENGTH: f64 = 2.0;
const DIAMETER: f64 = 1.5e-3;
const VISCOSITY: f64 = 1.82e-5;
const GAS: f64 = 286.99;
const PRESSURE: f64 = 4.0 * ATMOSPHERE;

fn hose(kind: HoseKind, index: f64) -> Hose {
    Hose::new(kind, [LENGTH, DIAMETER], [VISCOSITY, ROOM, index], &Paper::sealed().air()).expect("a hose")
}

fn cells(cells: usize) -> Hose {
    hose(HoseKind::Distributed { cells }, 1.4)
}

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn over(a: Complex, b: Complex) -> Complex {
    let size = b[0] * b[0] + b[1] * b[1];
    let [re, im] = times(a, [b[0], -b[1]]);
    [re / size, im / size]
}

fn distance(a: Complex, b: Complex) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Series impedance and shunt admittance of a cell at an angular frequency, from the exact derivatives of its rates at rest.
fn cell(hose: &Hose, frequency: f64) -> [Complex; 2] {
    let rate = hose.flow_rate(Dual::<f64, 2>::variable(0.0, 0), Dual::variable(PRESSURE, 1), Dual::of_value(PRESSURE));
    let [by_flow, by_pressure] = rate.slope;
    [[-by_flow / by_pressure, frequency / by_pressure], [0.0, frequency / hose.stiffness()]]
}

trait OfValue {
    fn of_value(value: f64) -> Self;
}

impl OfValue for Dual<f64, 2> {
    fn of_value(value: f64) -> Self {
        mckibben::Scalar::constant(value)
    }
}

#[test]
fn the_volume_and_the_delay_do_not_depend_on_how_the_hose_is_divided() {
    let volume = PI / 4.0 * DIAMETER * DIAMETER * LENGTH;
    for kind in [HoseKind::Lumped, HoseKind::Distributed { cells: 3 }, HoseKind::Distributed { cells: MAX_CELLS }] {
        for index in [1.0, 1.4] {
            let hose = hose(kind, index);
            assert_close(hose.volume(), volume, 1e-14);
            assert_close(hose.wave_speed(), (index * GAS * ROOM).sqrt(), 1e-14);
            assert_close(hose.delay(), LENGTH / (index * GAS * ROOM).sqrt(), 1e-14);
        }
    }
    // Sound in dry air at 20 °C.
    assert_close(cells(1).wave_speed(), 343.2, 1e-3);
}

/// A cell of a ladder passes a wave on with `cosh g = 1 + ZY/2`; the line over the same length with `g = ΓΔx`. Twice
/// `sinh(g/2) = √(ZY)/2` once more shows that the first error is `−(ΓΔx)²/24`.
#[test]
fn wave_speed_and_attenuation_are_those_of_the_line_but_for_the_square_of_a_cell() {
    let hose = cells(MAX_CELLS);
    let line = LinearLine::new(&hose, PRESSURE);
    let length = LENGTH / MAX_CELLS as f64;
    for part in [0.02, 0.1, 0.3] {
        let frequency = part * hose.wave_speed() / length;
        let [series, shunt] = cell(&hose, frequency);
        let exact = line.propagation(frequency).map(|number| number * length);
        // g = 2 arsinh(√(ZY)/2) by its series: s − s³/24 + 3 s⁵/640 with s = √(ZY), which is ΓΔx itself.
        let square = times(series, shunt);
        let own = times(exact, exact);
        assert!(distance(square, own) < 1e-12 * own[0].hypot(own[1]), "{square:?} {own:?}");
        let of_ladder = {
            let correction = [
                1.0 - square[0] / 24.0 + 3.0 * (square[0] * square[0] - square[1] * square[1]) / 640.0,
                -square[1] / 24.0 + 3.0 * 2.0 * square[0] * square[1] / 640.0,
            ];
            times(exact, correction)
        };
        let allowed = 0.06 * part * part;
        assert!((of_ladder[0] / exact[0] - 1.0).abs() < 3.0 * allowed, "attenuation at {part}");
        assert!((of_ladder[1] / exact[1] - 1.0).abs() < allowed, "phase at {part}");
    }
    // Far above the friction's own rate the phase goes at the speed of sound and the attenuation is R'/(2 I' c).
    let quick = 100.0 * line.resistance / line.inertance;
    let [attenuation, phase] = line.propagation(quick);
    assert_close(quick / phase, hose.wave_speed(), 1e-4);
    assert_close(attenuation, line.resistance / (2.0 * line.inertance * hose.wave_speed()), 1e-4);
    // Far below it, air diffuses: α = β = √(ω R' C'/2).
    let slow = 1e-4 * line.resistance / line.inertance;
    let [attenuation, phase] = line.propagation(slow);
    let diffusive = (slow * line.resistance * line.capacitance / 2.0).sqrt();
    assert_close(attenuation, diffusive, 1e-4);
    assert_close(phase, diffusive, 1e-4);
}

/// Pressure at the outlet, before a volume, over that at the inlet: from the outlet back, cell by cell.
fn ladder(hose: &Hose, frequency: f64, end: f64) -> Complex {
    let [series, shunt] = cell(hose, frequency);
    let (mut pressure, mut flow) = ([1.0, 0.0], [0.0, frequency * end]);
    for number in (0..hose.cells()).rev() {
        let drop = times(series, flow);
        pressure = [pressure[0] + drop[0], pressure[1] + drop[1]];
        if number > 0 {
            let stored = times(shunt, pressure);
            flow = [flow[0] + stored[0], flow[1] + stored[1]];
        }
    }
    over([1.0, 0.0], pressure)
}

#[test]
fn the_response_with_a_volume_at_the_end_approaches_the_closed_form_with_more_cells() {
    for index in [0.3, 0.8, 1.5] {
        let frequency = index * cells(1).wave_speed() / LENGTH;
        let end = 3e-6 / (1.4 * GAS * ROOM);
        let errors = [2, 4, 8].map(|count| {
            let hose = cells(count);
            distance(ladder(&hose, frequency, end), LinearLine::new(&hose, PRESSURE).response(frequency, end))
        });
        let exact = LinearLine::new(&cells(1), PRESSURE).response(frequency, end);
        let size = exact[0].hypot(exact[1]);
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((0.7..2.3).contains(&order), "order {order} at {index}: {errors:?}");
        }
        assert!(errors[2] < 0.2 * size, "{errors:?} of {size}");
    }
}

#[test]
fn a_steady_flow_loses_in_the_cells_what_it_loses_in_the_whole() {
    let whole = hose(HoseKind::Lumped, 1.0);
    for (from, to) in [(5e5, 4.9e5), (6e5, 3e5)] {
        let flow: f64 = whole.flow(from, to);
        // From the outlet back: each cell's loss at its own mean pressure keeps the flow steady.
        let hose = cells(MAX_CELLS);
        let mut pressure = to;
        for _ in 0..MAX_CELLS {
            pressure = common::bisect(pressure, 2.0 * from, |upstream| hose.flow_rate(flow, upstream, pressure));
        }
        assert_close(pressure, from, 0.02);
    }
}

#[test]
fn derivatives_with_respect_to_the_states_are_those_of_finite_differences() {
    let hose = cells(4);
    for (flow, pressure, next) in [(2e-5, 3e5, 2.99e5), (-4e-4, 3e5, 3.1e5), (1e-3, 6e5, 5e5)] {
        let at = |flow, pressure, next| hose.flow_rate(flow, pressure, next);
        let exact =
            hose.flow_rate(Dual::<f64, 3>::variable(flow, 0), Dual::variable(pressure, 1), Dual::variable(next, 2));
        let near = [
            common::slope(1e-5 * flow, |h| at(flow + h, pressure, next)),
            common::slope(1.0, |h| at(flow, pressure + h, next)),
            common::slope(1.0, |h| at(flow, pressure, next + h)),
        ];
        for (exact, near) in exact.slope.iter().zip(near) {
            assert_close(*exact, near, 1e-5);
        }
    }
}

#[test]
fn what_is_out_of_range_is_refused_by_name() {
    let air = Paper::sealed().air();
    let make = |kind, shape, gas| Hose::new(kind, shape, gas, &air).expect_err("refused").to_string();
    let gas = [VISCOSITY, ROOM, 1.0];
    let lumped = HoseKind::Lumped;
    assert!(make(lumped, [0.0, 1e-3], gas).contains("hose.length = 0"));
    assert!(make(lumped, [1.0, -1e-3], gas).contains("hose.diameter = -0.001"));
    assert!(make(lumped, [1.0, 1e-3], [VISCOSITY, ROOM, 0.9]).contains("hose.polytropic_index = 0.9"));
    assert!(make(HoseKind::Distributed { cells: 9 }, [1.0, 1e-3], gas).contains("hose.cells = 9"));
}
