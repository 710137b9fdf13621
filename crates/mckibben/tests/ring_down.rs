//! The estimators of a ring-down against recursions in closed form, and the oscillator's own solution.

use mckibben::ring_down::{Cycle, Damping, Form, half_cycle};
use mckibben::{Dual, Error};
use proptest::prelude::*;
use std::f64::consts::PI;

fn peaks(form: Form, first: f64, decay: f64, width: f64, count: usize) -> Vec<f64> {
    std::iter::successors(Some(first), |x| Some(x - form.drop(*x, decay, width))).take(count).collect()
}

fn close(value: f64, exact: f64, tolerance: f64, what: &str) {
    assert!((value - exact).abs() <= tolerance * exact.abs(), "{what}: {value} is not {exact}");
}

#[test]
fn each_form_recovers_its_own_recursion() {
    let (mass, period) = (2.7, 0.2);
    for form in [Form::Paper, Form::Exact] {
        for (decay, width) in [(0.8, 1e-4), (0.97, 5e-5), (0.55, 2e-4)] {
            let peaks = peaks(form, 1e-2, decay, width, 4);
            for few in [3, 4] {
                let found = Damping::from_peaks(&peaks[..few], period, mass, form).unwrap();
                close(found.decay, decay, 1e-12, "β");
                close(found.coulomb_width, width, 1e-11, "Q");
                close(found.viscous, 2.0 * mass / period * (1.0 / decay).ln(), 1e-12, "c");
            }
        }
    }
}

#[test]
fn two_cycles_far_apart_are_the_papers_equations_written_out() {
    let (x1, x2, n1, n2): (f64, f64, f64, f64) = (5.0e-3, 2.1e-3, 3.7e-3, 1.4e-3);
    let (d1, d2) = (x1 - n1, x2 - n2);
    let b = 1.0 - (d1 - d2) / (x1 - x2); // (27)
    let q = (d1 - x1 * (1.0 - b)) / 4.0; // (28)
    let c = 2.0 * 3.0 / 0.25 * (1.0 / b).ln(); // (31)
    let cycles = [Cycle { amplitude: x1, next: n1 }, Cycle { amplitude: x2, next: n2 }];
    let found = Damping::from_cycles(&cycles, 0.25, 3.0, Form::Paper).unwrap();
    close(found.decay, b, 1e-13, "β");
    close(found.coulomb_width, q, 1e-12, "Q");
    close(found.viscous, c, 1e-12, "c");
    close(cycles[0].equivalent_ratio().unwrap(), (x1 / (x1 - d1)).ln() / (2.0 * PI), 1e-15, "ζ_eq");
}

/// The oscillator `x″ + 2ζω x′ + ω² x = −ω² Q sgn(x′)`, half cycle by half cycle from its solution: from rest at `x` it
/// swings about `∓Q` and comes to rest after half a damped period, shrunk by `exp(−πζ/√(1−ζ²))`.
fn oscillator(first: f64, ratio: f64, width: f64, count: usize) -> Vec<f64> {
    let shrink = (-PI * ratio / (1.0 - ratio * ratio).sqrt()).exp();
    let half = |x: f64| {
        let centre = width * x.signum();
        centre - (x - centre) * shrink
    };
    std::iter::successors(Some(first), |x| Some(half(half(*x)))).take(count).collect()
}

#[test]
fn the_exact_form_inverts_the_oscillator_and_the_papers_q_is_low_by_a_known_factor() {
    let (ratio, width, omega, mass) = (0.035, 1.1e-4, 30.0, 2.0);
    let period = 2.0 * PI / (omega * (1.0_f64 - ratio * ratio).sqrt());
    let peaks = oscillator(6e-3, ratio, width, 6);
    let exact = Damping::from_peaks(&peaks, period, mass, Form::Exact).unwrap();
    close(exact.coulomb_width, width, 1e-12, "Q");
    close(exact.damping_ratio, ratio, 1e-12, "ζ");
    close(exact.viscous, 2.0 * ratio * mass * omega, 1e-12, "c");
    let paper = Damping::from_peaks(&peaks, period, mass, Form::Paper).unwrap();
    close(paper.decay, exact.decay, 1e-14, "β");
    let low = (1.0 + exact.decay.sqrt()).powi(2) / 4.0;
    close(paper.coulomb_width / exact.coulomb_width, low, 1e-12, "ratio of Q");
    assert!((0.89..0.91).contains(&low), "10 % low at ζ = 0.035, not a factor of {low}");
}

#[test]
fn half_of_peak_to_trough_obeys_the_same_recursion() {
    let (ratio, width) = (0.05, 1.3e-4);
    let shrink = (-PI * ratio / (1.0_f64 - ratio * ratio).sqrt()).exp();
    let swings: Vec<f64> = oscillator(7e-3, ratio, width, 4)
        .into_iter()
        .map(|peak| 0.5 * (peak - (width - (peak - width) * shrink)))
        .collect();
    let found = Damping::from_peaks(&swings, 0.2, 1.0, Form::Exact).unwrap();
    close(found.coulomb_width, width, 1e-12, "Q");
    close(found.damping_ratio, ratio, 1e-12, "ζ");
}

#[test]
fn two_half_cycles_are_a_cycle_of_the_oscillator() {
    let (ratio, width): (f64, f64) = (0.05, 1.3e-4);
    let decay = (-2.0 * PI * ratio / (1.0 - ratio * ratio).sqrt()).exp();
    let exact = oscillator(7e-3, ratio, width, 2)[1];
    close(half_cycle(half_cycle(7e-3, decay, width), decay, width), exact, 1e-14, "X");
    close(7e-3 - Form::Exact.drop(7e-3, decay, width), exact, 1e-14, "X");
}

#[test]
fn estimates_carry_the_derivatives_by_the_peaks() {
    let peaks = peaks(Form::Exact, 1e-2, 0.8, 1e-4, 4);
    for place in 0..4 {
        let seeded: Vec<Dual<f64, 1>> = peaks
            .iter()
            .enumerate()
            .map(|(at, peak)| if at == place { Dual::variable(*peak, 0) } else { Dual { value: *peak, slope: [0.0] } })
            .collect();
        let constant = |value: f64| Dual { value, slope: [0.0] };
        let found = Damping::from_peaks(&seeded, constant(0.2), constant(1.5), Form::Exact).unwrap();
        let moved = |by: f64| {
            let mut moved = peaks.clone();
            moved[place] += by;
            Damping::from_peaks(&moved, 0.2, 1.5, Form::Exact).unwrap()
        };
        let (above, below) = (moved(1e-7), moved(-1e-7));
        close(found.coulomb_width.slope[0], (above.coulomb_width - below.coulomb_width) / 2e-7, 1e-6, "dQ");
        close(found.viscous.slope[0], (above.viscous - below.viscous) / 2e-7, 1e-6, "dc");
        close(found.damping_ratio.slope[0], (above.damping_ratio - below.damping_ratio) / 2e-7, 1e-6, "dζ");
    }
}

#[test]
fn pure_viscous_and_pure_coulomb_friction_are_distinguished() {
    let viscous = Damping::from_peaks(&oscillator(5e-3, 0.02, 0.0, 5), 0.2, 1.0, Form::Exact).unwrap();
    assert!(viscous.coulomb_width.abs() < 1e-15, "{}", viscous.coulomb_width);
    close(viscous.damping_ratio, 0.02, 1e-12, "ζ");
    let coulomb = Damping::from_peaks(&oscillator(5e-3, 0.0, 1e-4, 5), 0.2, 1.0, Form::Exact).unwrap();
    close(coulomb.coulomb_width, 1e-4, 1e-12, "Q");
    assert!(coulomb.viscous.abs() < 1e-11, "{}", coulomb.viscous);
}

#[test]
fn bad_input_is_refused_where_it_stands() {
    let entry = |result: Result<Damping, Error>| match result {
        Err(Error::Table { name: "ring_down.amplitude", entry, problem, .. }) => (entry, problem),
        other => panic!("{other:?}"),
    };
    let peaks = |amplitudes: &[f64]| Damping::from_peaks(amplitudes, 0.2, 1.0, Form::Exact);
    assert_eq!(entry(peaks(&[3.0, 2.0])).0, 3);
    assert_eq!(entry(peaks(&[3.0, 2.0, 2.5])), (3, "the amplitudes do not fall"));
    assert_eq!(entry(peaks(&[3.0, 3.0, 2.5])), (2, "the amplitudes do not fall"));
    assert_eq!(entry(peaks(&[3.0, f64::NAN, 1.0])), (2, "an amplitude is not a finite number"));
    assert_eq!(entry(peaks(&[f64::INFINITY, 2.0, 1.0])).0, 1);
    assert_eq!(entry(peaks(&[3.0, 2.0, -1.0])), (3, "an amplitude is not above zero"));
    let cycle = Cycle { amplitude: 3.0, next: 2.0 };
    let cycles = |cycles: &[Cycle]| Damping::from_cycles(cycles, 0.2, 1.0, Form::Paper);
    assert_eq!(entry(cycles(&[cycle])).0, 2);
    assert_eq!(entry(cycles(&[cycle, cycle])).1, "all cycles have one amplitude");
    assert_eq!(entry(cycles(&[cycle, Cycle { amplitude: 2.0, next: 2.0 }])).0, 2);
    // The larger amplitude ends below the smaller one: β would be negative.
    let crossed = [Cycle { amplitude: 3.0, next: 1.0 }, Cycle { amplitude: 2.0, next: 1.5 }];
    assert!(entry(cycles(&crossed)).1.contains("faster than any damping"));
    assert!(Cycle { amplitude: 1.0, next: 1.5 }.equivalent_ratio().is_err());
    for (period, mass, key) in
        [(0.0, 1.0, "ring_down.period"), (0.2, -1.0, "load.mass"), (f64::NAN, 1.0, "ring_down.period")]
    {
        match Damping::from_peaks(&[3.0, 2.0, 1.2], period, mass, Form::Exact) {
            Err(Error::OutOfRange { parameter, .. }) => assert_eq!(parameter.key, key),
            other => panic!("{other:?}"),
        }
    }
}

proptest! {
    #[test]
    fn recursions_are_recovered_anywhere(decay in 0.3..0.999_f64, width in 1e-6..3e-4_f64, exact: bool) {
        let form = if exact { Form::Exact } else { Form::Paper };
        let peaks = peaks(form, 1e-2, decay, width, 3);
        prop_assume!(peaks[2] > 0.0);
        let found = Damping::from_peaks(&peaks, 0.2, 1.0, form).unwrap();
        prop_assert!((found.decay - decay).abs() < 1e-9);
        prop_assert!((found.coulomb_width - width).abs() < 1e-9);
    }
}
