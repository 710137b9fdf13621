//! The proportional pressure regulator: its equation, the limit of its rate, and what is refused.

use crate::common::regulated::{Regulated, TimeSeries};
use crate::common::{assert_close, assert_within, slope};
use mckibben::Error;
use mckibben::valve::{Approach, Regulator};

const TAU: f64 = 0.03;
const LIMIT: f64 = 2e6;
const CLOSED_FORM: Regulated = Regulated { time_constant: TAU, dead_time: 5e-3, rate_limit: LIMIT };

fn regulator() -> Regulator {
    Regulator::new(TAU, 5e-3, LIMIT).expect("a regulator")
}

fn series(pressure: f64, set_point: f64) -> TimeSeries {
    TimeSeries { time: 0.1, pressure, set_point }
}

/// The rate by the approach that holds is the slope of the closed form.
#[test]
fn the_pressure_obeys_its_equation() {
    for (pressure, set_point) in [(1e5, 1.3e5), (1e5, 5e5), (6e5, 1e5), (3e5, 3e5)] {
        let series = series(pressure, set_point);
        for n in 1..300 {
            let time = 0.1 + 1.037e-3 * f64::from(n);
            let at = CLOSED_FORM.pressure(&series, time);
            let rate = regulator().rate_in(regulator().approach(at, set_point), at, set_point);
            // No difference is taken over the end of the limit, where the curvature jumps.
            let end = 0.1 + ((set_point - pressure).abs() / LIMIT - TAU).max(0.0);
            if (time - end).abs() > 1e-4 {
                assert_within(slope(2e-5, |h| CLOSED_FORM.pressure(&series, time + h)), rate, 1e-7 * LIMIT);
            }
            assert!(rate.abs() <= LIMIT * (1.0 + 1e-12));
        }
    }
}

/// The limit ends `q τ` before the set point, where the formulas on both sides agree.
#[test]
fn the_limit_of_the_rate_ends_where_both_formulas_agree() {
    let set_point = 3e5;
    for (approach, end) in [(Approach::Rises, 3e5 - LIMIT * TAU), (Approach::Falls, 3e5 + LIMIT * TAU)] {
        let found = regulator().limit_end(approach, set_point).expect("it ends");
        assert_close(found, end, 1e-15);
        let rates = [approach, Approach::Settles].map(|its| regulator().rate_in(its, found, set_point));
        assert_close(rates[0], rates[1], 1e-12);
        let way = (set_point - end).signum();
        assert_eq!(regulator().approach(found - way, set_point), approach);
        assert_eq!(regulator().approach(found + way, set_point), Approach::Settles);
    }
    assert_eq!(regulator().limit_end(Approach::Settles, set_point), None);
    assert_close(regulator().dead_time(), 5e-3, 0.0);
}

#[test]
fn regulators_outside_physics_are_refused() {
    let cases = [
        ((0.0, 0.0, 1.0), "valve.time_constant"),
        ((1.0, -1.0, 1.0), "valve.dead_time"),
        ((1.0, 0.0, 0.0), "valve.rate_limit"),
    ];
    for ((time_constant, dead_time, limit), key) in cases {
        match Regulator::new(time_constant, dead_time, limit) {
            Err(Error::OutOfRange { parameter, .. }) => assert_eq!(parameter.key, key),
            other => panic!("{other:?}"),
        }
    }
}
