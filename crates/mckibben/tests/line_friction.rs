//! The friction law of a tube: both textbook laws, their inverse, the flow of Fanno's kind at constant temperature.

use crate::common::{ATMOSPHERE, Paper, ROOM, assert_close, bisect, slope};
use mckibben::Dual;
use mckibben::line::{LAMINAR_END, TURBULENT_START, Tube, drive_at, reynolds_at};
use proptest::prelude::*;
use std::f64::consts::PI;

const VISCOSITY: f64 = 1.82e-5;
const GAS: f64 = 286.99;

fn tube(length: f64, diameter: f64) -> Tube {
    Tube::new(length, diameter, VISCOSITY, ROOM, &Paper::sealed().air()).expect("a tube")
}

/// Hagen–Poiseuille for a gas: `ṁ = π d⁴ (P₁² − P₂²)/(256 μ L R T)`.
#[test]
fn a_slow_flow_is_that_of_hagen_and_poiseuille() {
    let (length, diameter) = (1.3, 1.1e-3_f64);
    for (from, to) in [(1.05e5, 1.04e5), (3e5, 2.99e5), (1e5, 1.003e5)] {
        let exact = PI * diameter.powi(4) * (from * from - to * to) / (256.0 * VISCOSITY * length * GAS * ROOM);
        let reynolds = 4.0 * exact.abs() / (PI * diameter * VISCOSITY);
        assert!(reynolds < LAMINAR_END, "{reynolds}");
        // What is left is the stand-in for acceleration.
        assert_close(tube(length, diameter).flow(from, to), exact, 1e-4);
    }
}

/// Darcy and Weisbach with Blasius' friction factor at the Reynolds number of the result.
#[test]
fn a_fast_flow_is_that_of_darcy_weisbach_and_blasius() {
    let (length, diameter) = (40.0, 4e-3);
    for (from, to) in [(6e5, 5e5), (7e5, 6.9e5), (2.8e5, 3e5)] {
        let flow = tube(length, diameter).flow(from, to);
        let area = PI / 4.0 * diameter * diameter;
        let reynolds = 4.0 * f64::abs(flow) / (PI * diameter * VISCOSITY);
        assert!((TURBULENT_START..1e5).contains(&reynolds), "{reynolds}");
        let factor = 0.3164 / reynolds.powf(0.25);
        let density = (from + to) / (2.0 * GAS * ROOM);
        let speed = flow / (density * area);
        let loss = factor * length / diameter * density * speed * speed.abs() / 2.0;
        assert_close(loss, from - to, 2e-3);
    }
}

#[test]
fn the_law_meets_itself_with_its_slope_at_both_bounds() {
    for bound in [LAMINAR_END, TURBULENT_START] {
        let [below, above] = [1.0 - 1e-12, 1.0 + 1e-12].map(|factor| Dual::<f64, 1>::variable(bound * factor, 0));
        let (below, above) = (drive_at(below), drive_at(above));
        assert_close(below.value, above.value, 1e-11);
        assert_close(below.slope[0], above.slope[0], 1e-10);
        let drive = drive_at(bound);
        let [below, above] = [1.0 - 1e-12, 1.0 + 1e-12].map(|factor| Dual::<f64, 1>::variable(drive * factor, 0));
        let (below, above) = (reynolds_at(below), reynolds_at(above));
        assert_close(below.value, above.value, 1e-11);
        assert_close(below.slope[0], above.slope[0], 1e-10);
    }
}

/// Isothermal flow with friction and acceleration, `G² (f L/d + 2 ln(P₁/P₂)) = (P₁² − P₂²)/(RT)`, choked where the flux is
/// largest; f by Blasius at the flux.
fn isothermal_flux(tube: [f64; 2], from: f64, to: f64) -> f64 {
    let [length, diameter] = tube;
    let at = |outlet: f64| {
        bisect(1e-3, 1e5, |flux: f64| {
            let reynolds = flux * diameter / VISCOSITY;
            let factor = if reynolds < LAMINAR_END { 64.0 / reynolds } else { 0.3164 / reynolds.powf(0.25) };
            flux * flux * (factor * length / diameter + 2.0 * (from / outlet).ln())
                - (from * from - outlet * outlet) / (GAS * ROOM)
        })
    };
    let outlets = (0..2000).map(|i| to + (from - to) * f64::from(i) / 2001.0);
    outlets.map(at).fold(0.0, f64::max)
}

#[test]
fn flow_towards_the_speed_of_sound_is_near_that_with_acceleration() {
    let mut worst = 0.0_f64;
    for per_diameter in [100.0, 200.0, 400.0, 1000.0] {
        for diameter in [2.5e-3, 4e-3] {
            for ratio in [0.15, 0.3, 0.5, 0.7, 0.9] {
                let (from, length) = (7.9e5, per_diameter * diameter);
                let flow = tube(length, diameter).flow(from, ratio * from);
                let exact = isothermal_flux([length, diameter], from, ratio * from) * PI / 4.0 * diameter * diameter;
                worst = worst.max((flow / exact - 1.0).abs());
            }
        }
    }
    assert!(worst < 0.08, "{worst}");
}

#[test]
fn no_tube_lets_more_through_than_its_opening_at_the_speed_of_sound() {
    let diameter = 2.5e-3;
    let area = PI / 4.0 * diameter * diameter;
    // (23): 0.04042 s·√K/m for air.
    let sonic = 0.040_42 * area * 7.9e5 / ROOM.sqrt();
    for length in [1e-6, 1e-3, 0.1, 1.0] {
        let flow = tube(length, diameter).flow(7.9e5, ATMOSPHERE);
        assert!(0.0 < flow && flow < 1.0001 * sonic, "{length}: {flow} of {sonic}");
    }
    assert_close(tube(1e-6, diameter).flow(7.9e5, ATMOSPHERE), sonic, 1e-3);
}

proptest! {
    #[test]
    fn each_law_is_the_other_s_inverse(logarithm in -3.0..6.0_f64) {
        let reynolds = 10_f64.powf(logarithm);
        let back = reynolds_at(drive_at(reynolds));
        prop_assert!((back / reynolds - 1.0).abs() < 1e-12, "{} {}", reynolds, back);
    }

    #[test]
    fn more_drive_gives_more_flow(logarithm in -3.0..9.0_f64, more in 1e-6..1.0_f64) {
        let drive = 10_f64.powf(logarithm);
        prop_assert!(reynolds_at(drive) < reynolds_at(drive * (1.0 + more)));
    }

    #[test]
    fn flow_goes_down_the_pressure_and_turns_with_it(from in 1e4..1e6_f64, to in 1e4..1e6_f64, length in 0.01..10.0_f64) {
        let tube = tube(length, 2.5e-3);
        let flow = tube.flow(from, to);
        prop_assert_eq!(flow, -tube.flow(to, from));
        prop_assert!(flow * (from - to) >= 0.0);
    }

    #[test]
    fn derivatives_agree_with_finite_differences(from in 1.5e5..9e5_f64, share in 0.05..0.995_f64, diameter in 1e-3..5e-3_f64) {
        let tube = tube(1.0, diameter);
        let to = share * from;
        let exact = tube.flow(Dual::<f64, 2>::variable(from, 0), Dual::variable(to, 1));
        let near = [
            slope(1.0, |h| tube.flow(from + h, to)),
            slope(1.0, |h| tube.flow(from, to + h)),
        ];
        for (exact, near) in exact.slope.iter().zip(near) {
            prop_assert!((exact - near).abs() < 1e-5 * near.abs(), "{} {}", exact, near);
        }
        let flow = tube.flow(from, to);
        let exact = tube.loss(Dual::<f64, 2>::variable(flow, 0), Dual::variable(from, 1));
        let near = [
            slope(1e-6 * flow, |h| tube.loss(flow + h, from)),
            slope(1.0, |h| tube.loss(flow, from + h)),
        ];
        for (exact, near) in exact.slope.iter().zip(near) {
            prop_assert!((exact - near).abs() < 1e-5 * near.abs(), "{} {}", exact, near);
        }
    }
}
