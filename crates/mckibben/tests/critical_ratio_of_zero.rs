//! A critical ratio of zero by ISO 6358, which never chokes.
//!
//! Symptom: the event-located engine pumped without end, from a supply of 6 bar to 328 bar in the muscle, and reported success.
//! Cause: the zones of the flow law had no choked piece for `b = 0`, so a search for the zone of a pressure by the upper ends
//! of the zones stopped at the first, `choked in`, which then had no end either.
//!
//! With `b = 0` the law is `ψ = √(1 − r²)`, and a volume at constant temperature and length has closed forms. With
//! `κ = R √T G/V`, from `r₀`:
//!
//! ```text
//! filling       r = sin(asin r₀ + κ t)               r = P/P_s, up to r_lam; then 1 − r falls as exp(−κ ψ_lam t/(1 − r_lam))
//! emptying      P = P_0 cosh(acosh(P₁/P_0) − κ t)    down to P_0/r_lam
//! ```

use crate::common::joint::Pair;
use crate::common::steps::RigSteps;
use crate::common::{ATMOSPHERE, INCH, PSI, Paper, ROOM, assert_close};
use mckibben::GaugePressure;
use mckibben::air::Process;
use mckibben::line::{Line, Reservoir, SupplyLine};
use mckibben::simulation::{Method, simulate};
use mckibben::valve::{Command, FlowStandard, Request};

const LENGTH: f64 = 3.5 * INCH;
const LAMINAR: f64 = 0.999;
const SUPPLY: f64 = 100.0 * PSI + ATMOSPHERE;

fn held(request: Request, gauge: f64, critical_ratio: f64) -> Paper {
    let paper = Paper::driven(Command::Constant(request)).isometric(LENGTH).process(Process::Isothermal).gauge(gauge);
    paper.with(|rig| {
        rig.delays = (0.0, 0.0);
        rig.standard = FlowStandard::Iso6358 { sonic_conductance: 5e-9, critical_ratio };
    })
}

/// `κ` in 1/s.
fn rate(paper: &Paper) -> f64 {
    let volume = paper.actuator().volume(LENGTH);
    paper.gas_constant * ROOM.sqrt() * paper.flow_law().conductance() / volume
}

#[test]
fn filling_follows_its_closed_form_and_ends_at_the_supply() {
    let paper = held(Request::Fill, 0.0, 0.0);
    let (rate, run) = (rate(&paper), paper.run(0.5, 1e-11));
    let first = (ATMOSPHERE / SUPPLY).asin();
    let laminar = (LAMINAR.asin() - first) / rate;
    let pressure = |time: f64| {
        let slope = (1.0 - LAMINAR * LAMINAR).sqrt() / (1.0 - LAMINAR);
        let ratio = match time < laminar {
            true => (first + rate * time).sin(),
            false => 1.0 - (1.0 - LAMINAR) * (-rate * slope * (time - laminar)).exp(),
        };
        ratio * SUPPLY
    };
    assert!((0.01..0.4).contains(&laminar), "{laminar} s leave no time for both pieces");
    for time in [0.1 * laminar, 0.5 * laminar, 0.99 * laminar, 1.01 * laminar, 1.1 * laminar, 0.5] {
        assert_close(run.at(time).pressure.0, pressure(time), 1e-9);
    }
    assert_close(run.at(0.5).pressure.0, SUPPLY, 1e-9);
    let rig = paper.rig();
    let mut stepper = RigSteps::new(&rig, paper.start(), Method::Stable);
    (1..=5000).for_each(|step| stepper.advance_to(f64::from(step) * 1e-4).expect("a step"));
    assert_close(stepper.sample().pressure.0, SUPPLY, 1e-9);
}

#[test]
fn emptying_follows_its_closed_form() {
    let paper = held(Request::Exhaust, 80.0 * PSI, 0.0);
    let (rate, run) = (rate(&paper), paper.run(0.5, 1e-11));
    let first = ((80.0 * PSI + ATMOSPHERE) / ATMOSPHERE).acosh();
    let laminar = (first - (1.0 / LAMINAR).acosh()) / rate;
    for part in [0.1, 0.5, 0.9] {
        let time = part * laminar;
        assert_close(run.at(time).pressure.0, ATMOSPHERE * (first - rate * time).cosh(), 1e-9);
    }
    assert_close(run.at(0.5).pressure.0, ATMOSPHERE, 1e-6);
}

/// Nothing happens at `b = 0`: it is the limit of small ratios, on a mass, from a reservoir, and at a joint.
#[test]
fn a_ratio_of_zero_is_the_limit_of_small_ones() {
    let lifting = |b: f64| {
        let standard = FlowStandard::Iso6358 { sonic_conductance: 5e-9, critical_ratio: b };
        let paper = Paper::pwm(25.0, 0.6).with(|rig| (rig.standard, rig.exhaust) = (standard, Some(standard)));
        let air = paper.air();
        let reservoir = Reservoir::new([1e-4, 1.0, ROOM], GaugePressure(100.0 * PSI), None, &air).expect("a reservoir");
        let supply = SupplyLine::new(Some(reservoir), None, 1.0).expect("a supply");
        let line = Line { supply: Some(supply), ..Line::NONE };
        let fed = simulate(&paper.rig().with_line(line).expect("a line"), paper.start(), 0.3, 1e-10).expect("a run");
        let joint = Pair::of(paper.clone()).run(0.3, 1e-10);
        [paper.run(0.3, 1e-10).at(0.3), fed.at(0.3), joint.at(0.3).actuators[0]].map(|sample| sample.pressure.0)
    };
    for (zero, small) in lifting(0.0).into_iter().zip(lifting(1e-14)) {
        assert!(zero < SUPPLY, "{zero} Pa");
        assert_close(zero, small, 1e-7);
    }
}
