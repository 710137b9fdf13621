//! Overshoot, first peak, frequency and settling against the closed form of a damped oscillation.

use crate::noise::Noise;
use mckibben_identify::trajectories::StepInfo;
use std::f64::consts::PI;

/// From 0.09 m by a stroke of −0.01 m, with a damping ratio and a natural frequency of 40 rad/s.
const FIRST: f64 = 0.09;
const STROKE: f64 = -0.01;
const NATURAL: f64 = 40.0;

fn times() -> Vec<f64> {
    (0..=2000).map(|place| 1e-3 * f64::from(place)).collect()
}

/// The step response of an oscillator with a damping ratio below 1.
fn oscillation(damping: f64) -> Vec<f64> {
    let damped = NATURAL * (1.0 - damping * damping).sqrt();
    let of = |time: &f64| {
        let decay = (-damping * NATURAL * time).exp();
        let swing = (damped * time).cos() + damping * NATURAL / damped * (damped * time).sin();
        FIRST + STROKE * (1.0 - decay * swing)
    };
    times().iter().map(of).collect()
}

#[test]
fn an_oscillation_has_the_numbers_of_its_closed_form() {
    for damping in [0.1, 0.2, 0.4] {
        let root = (1.0_f64 - damping * damping).sqrt();
        let (overshoot, peak) = ((-PI * damping / root).exp(), PI / (NATURAL * root));
        let frequency = NATURAL * root / (2.0 * PI);
        for noise in [0.0, 2e-5] {
            let values = Noise::new(3).added_to(&oscillation(damping), noise);
            let found = StepInfo::of_readings(&times(), &values).expect("it is step-like");
            // Two standard deviations of noise are 0.4 % of the stroke; a parabola about the peak is good to a hundredth of the swing.
            assert!((found.stroke / STROKE - 1.0).abs() < 4e-3, "{found:?}");
            assert!((found.overshoot - overshoot).abs() < 1e-2, "{} is not {overshoot}", found.overshoot);
            assert!((found.first_peak.expect("one") / peak - 1.0).abs() < 2e-2, "{found:?}, not {peak}");
            assert!((found.frequency.expect("one") / frequency - 1.0).abs() < 2e-2, "{found:?}, not {frequency}");
            // The envelope is within 5 % of the stroke from ln(20/root)/(ζω) on, and the time series a half swing
            // before that at most.
            let envelope = (20.0 / root).ln() / (damping * NATURAL);
            assert!(found.settling <= envelope + 1e-3, "{found:?}");
            assert!(found.settling >= envelope - 0.5 / frequency, "{found:?}, not {envelope}");
            let model = StepInfo::of_model(&times(), &oscillation(damping)).expect("one");
            assert!((model.overshoot - overshoot).abs() < 1e-2, "{model:?}");
        }
    }
}

#[test]
fn a_course_without_oscillation_has_neither_peak_nor_frequency() {
    let rate = 15.0;
    let values: Vec<f64> = times().iter().map(|time| FIRST + STROKE * (1.0 - (-rate * time).exp())).collect();
    for noise in [0.0, 2e-5] {
        let found = StepInfo::of_readings(&times(), &Noise::new(5).added_to(&values, noise)).expect("it is step-like");
        assert_eq!((found.overshoot, found.first_peak, found.frequency), (0.0, None, None), "{noise}");
        // It comes within 5 % at ln(20)/15, where noise of 0.2 % moves it by up to four standard deviations in its slope of 0.75 /s.
        assert!((found.settling - 20.0_f64.ln() / rate).abs() < 0.02, "{found:?}");
    }
}

#[test]
fn what_does_not_come_to_rest_is_no_step() {
    let swing: Vec<f64> = times().iter().map(|time| FIRST + STROKE * (NATURAL * time).sin()).collect();
    assert_eq!(StepInfo::of_readings(&times(), &swing), None);
    let ramp: Vec<f64> = times().iter().map(|time| FIRST + STROKE * time).collect();
    assert_eq!(StepInfo::of_readings(&times(), &ramp), None);
    let flat = vec![FIRST; times().len()];
    assert_eq!(StepInfo::of_readings(&times(), &Noise::new(1).added_to(&flat, 1e-5)), None);
    assert_eq!(StepInfo::of_readings(&times(), &flat), None);
    assert_eq!(StepInfo::of_readings(&[], &[]), None);
    assert_eq!(StepInfo::of_readings(&times(), &vec![f64::NAN; times().len()]), None);
    assert_eq!(StepInfo::of_model(&times(), &flat), None);
}
