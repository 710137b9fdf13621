//! PID control: each action in closed form, the limits, bumpless behaviour, and its derivatives.

use crate::common::{assert_close, assert_within, between, slope};
use mckibben::control::{Drive, Output, Pid, Quantity};
use mckibben::valve::Request;
use mckibben::{Dual, Over};

const SIGNED: Output = Output::FillHoldExhaust;

fn band(width: f64, output: Output) -> Pid {
    Pid::new(Quantity::Pressure, width, output).expect("a controller")
}

/// Outputs over samples of `(time, target, measured)`.
fn outputs(pid: &Pid, samples: impl IntoIterator<Item = (f64, f64, f64)>) -> Vec<f64> {
    let mut memory = pid.begin();
    samples.into_iter().map(|(time, target, measured)| pid.act(time, target, measured, &mut memory)).collect()
}

#[test]
fn proportional_action_is_the_error_over_the_band() {
    let pid = band(4.0, SIGNED);
    let given = outputs(&pid, [(0.0, 3.0, 1.0), (0.1, 3.0, 4.0), (0.2, 3.0, 100.0), (0.3, 100.0, 0.0)]);
    assert_eq!(given, [0.5, -0.25, -1.0, 1.0]);
    let weighted = pid.with_set_point_weight(0.5).expect("a share").with_bias(0.25).expect("a bias");
    assert_eq!(outputs(&weighted, [(0.0, 3.0, 1.0)]), [0.25 + 0.125]);
    assert_eq!(outputs(&band(4.0, Output::FillExhaust), [(0.0, 1.0, 3.0), (0.1, 3.0, 1.0)]), [0.0, 0.5]);
}

#[test]
fn integral_action_repeats_the_proportional_in_the_integral_time() {
    let pid = band(10.0, SIGNED).with_integral(0.5).expect("an integral");
    // A constant error of 1: p = 0.1, and i grows by 0.1 in each 0.5 s, whatever the times between samples.
    let times = [0.0, 0.05, 0.06, 0.2, 0.5, 0.9, 1.0, 2.5];
    for (time, output) in times.iter().zip(outputs(&pid, times.map(|time| (time, 1.0, 0.0)))) {
        assert_within(output, 0.1 + 0.1 * time / 0.5, 1e-15);
    }
}

#[test]
fn derivative_action_fades_geometrically_and_does_not_see_the_set_point() {
    let (ahead, filter, step) = (0.2, 8.0, 0.01);
    let pid = band(100.0, SIGNED).with_derivative(ahead, filter).expect("a derivative");
    // The measurement steps by 1 at sample 3, the target by 5 at sample 6.
    let sample = |k: u32| {
        let time = f64::from(k) * step;
        (time, if k >= 6 { 5.0 } else { 0.0 }, if k >= 3 { 1.0 } else { 0.0 })
    };
    let ratio = ahead / (ahead + filter * step);
    for (k, output) in (0..30).zip(outputs(&pid, (0..30).map(sample))) {
        let (_, target, measured) = sample(k);
        let kick = -0.01 * filter * ratio;
        let fading = if k >= 3 { kick * ratio.powi(k as i32 - 3) } else { 0.0 };
        assert_within(output, 0.01 * (target - measured) + fading, 1e-14);
    }
    // A ramp: the derivative settles at K T_d times its slope.
    let ramp = outputs(&pid, (0..2000).map(|k| (f64::from(k) * step, 0.0, 0.3 * f64::from(k) * step)));
    let proportional = -0.01 * 0.3 * 1999.0 * step;
    assert_within(ramp[1999] - proportional, -0.01 * ahead * 0.3, 1e-13);
}

#[test]
fn the_integral_does_not_wind_up() {
    let (integral, tracking, step) = (0.4, 0.3, 0.001);
    let pid = band(10.0, SIGNED).with_integral(integral).expect("one").with_tracking(tracking).expect("one");
    let error = 6.0;
    let mut memory = pid.begin();
    for k in 0..20_000 {
        assert!(pid.act(f64::from(k) * step, error, 0.0, &mut memory) <= 1.0);
    }
    // At the limit v − u settles at K e T_t/T_i.
    let excess = 0.6 + memory.integral - 1.0;
    assert_close(excess, 0.1 * error * tracking / integral, 1e-9);
    // Without it the integral would be 30. The error changes sign: the output leaves the limit at once.
    assert!(pid.act(20.0, -error, 0.0, &mut memory) < 1.0);
    // By the customary time: √(T_i T_d), or T_i.
    for (ahead, customary) in [(0.0, 0.4), (0.1, 0.2)] {
        let own = band(10.0, SIGNED).with_integral(0.4).expect("one").with_derivative(ahead, 10.0).expect("one");
        let same = own.with_tracking(customary).expect("one");
        let samples = || (0..500).map(|k| (f64::from(k) * 0.01, 20.0 * (f64::from(k) * 0.05).sin(), 0.0));
        assert_eq!(outputs(&own, samples()), outputs(&same, samples()));
    }
}

#[test]
fn the_output_stays_within_its_limits_whatever_is_measured() {
    for (output, least) in [(SIGNED, -1.0), (Output::FillExhaust, 0.0)] {
        let pid = band(3.0, output).with_integral(0.05).expect("one").with_derivative(0.3, 20.0).expect("one");
        let samples = (0..5000).map(|k| (k as f64 * 0.003, between(k, 0, -50.0, 50.0), between(k, 1, -50.0, 50.0)));
        for given in outputs(&pid, samples) {
            assert!((least..=1.0).contains(&given), "{given}");
        }
    }
}

#[test]
fn an_output_is_a_share_of_pulses() {
    let pulses = |duty, pulse, rest| Drive::Pulses { duty, pulse, rest };
    let (signed, plain) = (band(1.0, SIGNED), band(1.0, Output::FillExhaust));
    assert_eq!(signed.drive(0.3), pulses(0.3, Request::Fill, Request::Hold));
    assert_eq!(signed.drive(-0.3), pulses(0.3, Request::Exhaust, Request::Hold));
    assert_eq!(plain.drive(0.3), pulses(0.3, Request::Fill, Request::Exhaust));
    assert_eq!(plain.drive(0.3).mirrored(), pulses(0.3, Request::Exhaust, Request::Fill));
}

#[test]
fn it_closes_the_loop_on_an_integrator_as_the_characteristic_polynomial_says() {
    // y₊ = y + h g u, u = K (w − y) + i: z² − (2 − a) z + (1 − a + a h/T_i) with a = h g K, for the error.
    let (step, flow, integral) = (0.01, 2.0, 0.2);
    let pid = band(10.0, SIGNED).with_integral(integral).expect("an integral");
    let a = step * flow / 10.0;
    let (mut memory, mut level, mut errors) = (pid.begin(), 0.0, Vec::new());
    for k in 0..20_000 {
        errors.push(1.0 - level);
        level += step * flow * pid.act(f64::from(k) * step, 1.0, level, &mut memory);
    }
    for three in errors.windows(3) {
        let expected = (2.0 - a) * three[1] - (1.0 - a + a * step / integral) * three[0];
        assert_within(three[2], expected, 1e-13);
    }
    // Its roots have the modulus √(1 − a + a h/T_i), 0.99905: nothing is left after so many samples.
    assert!(errors[19_999].abs() < 1e-6, "{}", errors[19_999]);
}

#[test]
fn dual_numbers_pass_through() {
    let pid = band(8.0, SIGNED).with_integral(0.3).expect("one").with_derivative(0.05, 10.0).expect("one");
    let samples = || (0..40).map(|k| (f64::from(k) * 0.01, 2.0, 2.0 - 1.5 * (f64::from(k) * 0.1).cos()));
    let with = |name: &str, change: f64| {
        let changed = pid.map(Quantity::Pressure, |row, value| if row.key == name { value + change } else { value });
        outputs(&changed, samples())[39]
    };
    for name in ["controller.proportional_band", "controller.integral_time", "controller.derivative_time"] {
        let wide = pid.map(Quantity::Pressure, |row, value| {
            if row.key == name { Dual::<f64, 1>::variable(value, 0) } else { Dual::of(value) }
        });
        let mut memory = wide.begin();
        let mut last = None;
        for (time, target, measured) in samples() {
            last = Some(wide.act(Dual::of(time), Dual::of(target), Dual::of(measured), &mut memory));
        }
        let last = last.expect("an output");
        assert_close(last.value, with(name, 0.0), 1e-14);
        assert_close(last.slope[0], slope(1e-4, |h| with(name, h)), 1e-8);
    }
}

#[test]
fn numbers_outside_their_range_are_refused() {
    let refused = |result: Result<Pid, mckibben::Error>, key: &str| {
        let message = result.expect_err("refused").to_string();
        assert!(message.contains(key), "{message}");
    };
    refused(Pid::new(Quantity::Length, 0.0, SIGNED), "controller.proportional_band = 0 m");
    let pid = band(1.0, SIGNED);
    refused(pid.with_integral(0.0), "controller.integral_time");
    refused(pid.with_derivative(-1.0, 10.0), "controller.derivative_time");
    refused(pid.with_derivative(1.0, 0.0), "controller.derivative_filter");
    refused(pid.with_tracking(f64::NAN), "controller.tracking_time");
    refused(pid.with_set_point_weight(1.5), "controller.set_point_weight");
    refused(pid.with_bias(-2.0), "controller.bias");
}
