//! The braid: closed forms of its geometry.

use crate::common::{INCH, assert_close, assert_within};
use mckibben::{Braid, Dual, Error};
use proptest::prelude::*;
use std::f64::consts::PI;

#[test]
fn the_papers_braid_is_a_quarter_inch_wide_when_stretched() {
    // The text gives the diameter and the length; b is chosen so that n = 2.5 turns fit, to five digits.
    let braid = Braid::new(4.3218 * INCH, 2.5).expect("a braid");
    assert_close(braid.diameter(3.85 * INCH) / INCH, 0.25, 3e-5);
    assert_close(braid.neutral_length() / INCH, 2.4952, 2e-5);
}

#[test]
fn the_neutral_angle_is_that_of_a_cosine_of_one_over_root_three() {
    let braid = Braid::new(0.2, 1.7).expect("a braid");
    let angle = braid.interweave_angle(braid.neutral_length());
    assert_close(angle, (1.0 / 3.0_f64.sqrt()).acos(), 1e-15);
    assert_within(angle.to_degrees(), 54.7356, 5e-5);
    // Largest volume: the slope is zero there, up to the rounding of b².
    assert_within(braid.volume_slope(braid.neutral_length()), 0.0, 1e-15 * 0.04 / (4.0 * PI * 1.7 * 1.7));
    // Above the thread length there is no angle; the cosine is kept in bounds.
    assert_eq!(braid.interweave_angle(0.3), 0.0);
    assert_eq!(braid.interweave_angle(0.2), 0.0);
}

#[test]
fn a_braid_without_length_or_turns_is_refused() {
    for (length, turns, key) in [
        (0.0, 1.0, "actuator.thread_length"),
        (-1.0, 1.0, "actuator.thread_length"),
        (f64::NAN, 1.0, "actuator.thread_length"),
        (0.1, 0.0, "actuator.turns"),
        (0.1, f64::INFINITY, "actuator.turns"),
    ] {
        match Braid::new(length, turns) {
            Err(Error::OutOfRange { parameter, .. }) => assert_eq!(parameter.key, key),
            other => panic!("{other:?}"),
        }
    }
}

proptest! {
    #[test]
    fn the_volume_is_the_cylinders_own(b in 0.01..2.0_f64, n in 0.3..20.0_f64, share in 0.01..0.999_f64) {
        let braid = Braid::new(b, n).expect("a braid");
        let length = share * b;
        let diameter = braid.diameter(length);
        // b² − L² cancels by at most 1/(1 − share²), five hundred roundings.
        let cylinder = PI * diameter * diameter * length / 4.0;
        let volume: f64 = braid.volume(length);
        prop_assert!((volume / cylinder - 1.0).abs() < 1e-12);
        // Unrolled, a thread is the diagonal of n turns by the length.
        let diagonal = (n * PI * diameter).hypot(length);
        prop_assert!((diagonal / b - 1.0).abs() < 1e-14);
        // (2), and the angle whose cosine it is.
        prop_assert!((braid.cosine(length) - share).abs() < 1e-15);
        prop_assert!((braid.interweave_angle(length) - share.acos()).abs() < 1e-13);
    }

    #[test]
    fn the_slope_of_the_volume_is_its_derivative(b in 0.01..2.0_f64, n in 0.3..20.0_f64, share in 0.01..0.999_f64) {
        let braid = Braid::new(b, n).expect("a braid");
        let volume = braid.volume(Dual::<f64, 1>::variable(share * b, 0));
        // (20) in powers, against the dual derivative of V: both sum terms of the size of b² per turns.
        let literal = (b.powi(2) - 3.0 * (share * b).powi(2)) / (4.0 * PI * n.powi(2));
        let scale = b * b * braid.per_turns();
        prop_assert!((volume.slope[0] - literal).abs() < 8.0 * f64::EPSILON * scale);
        prop_assert!((braid.volume_slope(share * b) - literal).abs() < 8.0 * f64::EPSILON * scale);
    }

    #[test]
    fn geometry_scales(b in 0.01..2.0_f64, n in 0.3..20.0_f64, share in 0.01..0.999_f64, by in 0.1..10.0_f64) {
        let (one, other) = (Braid::new(b, n).expect("a braid"), Braid::new(by * b, n).expect("a braid"));
        let (small, large) = (share * b, share * by * b);
        let ratio = |large: f64, small: f64, expected: f64| (large / (expected * small) - 1.0).abs();
        prop_assert!(ratio(other.volume(large), one.volume(small), by.powi(3)) < 1e-12);
        prop_assert!(ratio(other.diameter(large), one.diameter(small), by) < 1e-12);
        let more = Braid::new(b, by * n).expect("a braid");
        prop_assert!(ratio(one.volume(small), more.volume(small), by * by) < 1e-14);
    }
}
