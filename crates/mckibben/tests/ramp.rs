//! A poppet that takes its time: the line, its ends, turning under way, and what a pulse passes.

use crate::common::{assert_close, assert_within, slope};
use mckibben::valve::{Command, PoppetClock, Ramp, Request, Solenoid, Stroke, ValveKind};
use mckibben::{Dual, Error};

const RISE: f64 = 2e-3;
const FALL: f64 = 3e-3;

fn ramp() -> Ramp {
    Ramp::new(RISE, FALL).expect("a ramp")
}

#[test]
fn the_opening_is_a_straight_line_between_shut_and_open() {
    let up = ramp().send(&Stroke::resting(false), 1.0, true);
    for share in [0.0, 0.25, 0.5, 0.999] {
        assert_within(up.opening(1.0 + share * RISE), share, 1e-12);
    }
    assert_eq!((up.opening(1.0 + RISE), up.opening(5.0)), (1.0, 1.0));
    assert_close(up.slope(), 1.0 / RISE, 1e-12);
    assert_eq!((up.arrival(1.0), up.arrival(1.0 + 2.0 * RISE)), (Some(1.0 + RISE), None));
    let down = ramp().send(&up, 2.0, false);
    assert_within(down.opening(2.0 + 0.25 * FALL), 0.75, 1e-12);
    assert_eq!((down.opening(2.1), down.arrival(2.1)), (0.0, None));
    let opening: Dual<f64, 1> = down.opening(Dual::variable(2.0 + 0.5 * FALL, 0));
    assert_close(opening.slope[0], -1.0 / FALL, 1e-9);
    assert_close(opening.slope[0], slope(1e-5, |h| down.opening(2.0 + 0.5 * FALL + h)), 1e-6);
}

#[test]
fn a_reversed_poppet_turns_where_it_is() {
    let up = ramp().send(&Stroke::resting(false), 0.0, true);
    let back = ramp().send(&up, 0.3 * RISE, false);
    assert_within(back.opening(0.3 * RISE), 0.3, 1e-15);
    // It falls at its own rate and arrives after its share of the way.
    assert_close(back.slope(), -1.0 / FALL, 1e-12);
    assert_close(back.arrival(0.3 * RISE).expect("under way"), 0.3 * RISE + 0.3 * FALL, 1e-12);
    let again = ramp().send(&back, 0.3 * RISE + 0.1 * FALL, true);
    assert_within(again.opening(0.3 * RISE + 0.1 * FALL), 0.2, 1e-15);
}

#[test]
fn without_times_the_seat_jumps() {
    let jump = Ramp::new(0.0, 0.0).expect("a seat that jumps");
    let up = jump.send(&Stroke::resting(false), 0.5, true);
    assert_eq!((up.opening(0.5), up.slope(), up.arrival(0.5)), (1.0, 0.0, None));
    assert_eq!(jump.send(&up, 0.7, false).opening(0.7), 0.0);
}

/// A seat that opens at once while it is on its way to shut stands open from then on: its way has ended, though the path was open
/// all the time.
#[test]
fn a_seat_that_jumps_back_ends_its_way() {
    let solenoid = Solenoid::new(ValveKind::TwoWay, 0.0, 0.0).expect("a solenoid");
    let solenoid = solenoid.with_ramp(Ramp::new(0.0, 30e-3).expect("a ramp"));
    let requests = [Request::Fill, Request::Hold, Request::Fill, Request::Hold];
    let command = Command::table(vec![0.01, 0.02, 0.04, 0.06], requests.to_vec()).expect("a table");
    let mut clock = PoppetClock::released();
    let mut motions = Vec::new();
    while let Some(next) = clock.next_motion(&solenoid, &command, 1.0) {
        clock.advance(next, &solenoid, &command);
        let opening = clock.openings(&solenoid).at(next).map_or(f64::NAN, |[supply, _]| supply);
        motions.push((next, clock.ports(&solenoid).supply, opening));
    }
    assert_eq!(motions.iter().map(|motion| motion.0).collect::<Vec<_>>(), [0.01, 0.02, 0.04, 0.06, 0.06 + 30e-3]);
    assert_eq!(motions.iter().map(|motion| motion.1).collect::<Vec<_>>(), [true, true, true, true, false]);
    // Whole while no stroke is under way.
    assert!(motions[2].2.is_nan() && motions[3].2 == 1.0 && motions[4].2.is_nan());
}

#[test]
fn a_pulse_passes_what_the_page_says() {
    let (opening_delay, closing_delay, width) = (4e-3, 1e-3, 20e-3);
    let up = ramp().send(&Stroke::resting(false), opening_delay, true);
    let released = width + closing_delay;
    let down = ramp().send(&up, released, false);
    // Trapezia are exact on straight lines: the corners of the opening are on the grid.
    let grid = 0.5e-3;
    let steps = 60;
    let at = |n: i32| {
        let time = grid * f64::from(n);
        if time < opening_delay {
            0.0
        } else if time < released {
            up.opening(time)
        } else {
            down.opening(time)
        }
    };
    let area: f64 = (0..steps).map(|n| 0.5 * grid * (at(n) + at(n + 1))).sum();
    assert_close(area, width - opening_delay + closing_delay - (RISE - FALL) / 2.0, 1e-12);
}

#[test]
fn times_below_zero_are_refused() {
    for (times, key) in [((-1.0, 0.0), "valve.opening_time"), ((0.0, f64::INFINITY), "valve.closing_time")] {
        match Ramp::new(times.0, times.1) {
            Err(Error::OutOfRange { parameter, .. }) => assert_eq!(parameter.key, key),
            other => panic!("{other:?}"),
        }
    }
}
