//! Symptom: a mass that fell onto the taut braid had an error of a thousandth of its range at steps of 0.01 ms, by either
//! method, and shorter steps made it no better.
//!
//! Cause: the taut braid's damping, and viscous friction where the tendon falls slack, begin with a jump. A step across
//! it is of order 1, whatever the method: the fixed-step engine now ends a part of its step there.

mod common;

use common::Paper;
use mckibben::simulation::Method;
use mckibben::simulation::accuracy::Reference;

fn check(paper: &Paper, name: &str) {
    let reference = Reference::new(&paper.rig(), paper.start(), 0.3, 1e-12).expect("a run");
    let order = |method, step: f64| {
        let [coarse, fine] = [step, 0.5 * step].map(|step| reference.error(method, step).expect("steps").greatest());
        (coarse / fine).log2()
    };
    let orders = [order(Method::Rk4, 2e-4), order(Method::Stable, 2e-5)];
    assert!(orders[0] > 3.5 && orders[1] > 1.8, "{name}: orders {orders:?}");
}

#[test]
fn a_fall_onto_the_taut_braid() {
    check(&Paper::sealed().mass(4.5).gauge(1e5).from(0.085, 0.0), "a heavy mass");
}

#[test]
fn a_tendon_that_falls_tight_and_then_taut() {
    let paper = Paper::sealed().mass(0.5).gauge(1e4).friction(3.5, 0.0).from(0.060, 0.5);
    check(&paper, "a light mass");
}
