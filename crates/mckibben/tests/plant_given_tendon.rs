//! An actuator on a tendon whose pressure is given over time: its end against closed forms and another integrator, its energy,
//! and the linear model that would need the pressure's rate.

use crate::common::steps::RigSteps;
use crate::common::{ATMOSPHERE, INCH, Paper, assert_within, runge_kutta};
use mckibben::GaugePressure;
use mckibben::air::Process;
use mckibben::load::{Load, Motion, SeriesTendon};
use mckibben::mechanism::{Coupling, Mass, Mechanism, Pull};
use mckibben::network::Network;
use mckibben::plant::{
    InitialAir, Mounted, Plant, PlantAir, PlantBalance, PlantStart, linearize_plant, simulate_plant,
};
use mckibben::simulation::{Initial, InitialLength, Method, PressureSeries, simulate};
use std::f64::consts::PI;

const STIFFNESS: f64 = 2e4;
const REST: f64 = 0.05;
const ROOM: f64 = 293.15;
const TIMES: [f64; 3] = [0.0, 0.1, 0.2];
const GAUGES: [f64; 3] = [1.5e5, 4e5, 2.5e5];
const DISTANCE: f64 = REST + 3.55 * INCH;

/// The gauge pressure in Pa at a time in s.
fn gauge(time: f64) -> f64 {
    let row = if time < TIMES[1] { 0 } else { 1 };
    let part = ((time - TIMES[row]) / (TIMES[row + 1] - TIMES[row])).min(1.0);
    GAUGES[row] + part * (GAUGES[row + 1] - GAUGES[row])
}

fn plant(paper: &Paper, mechanism: Mechanism) -> (Plant, PlantStart) {
    let mounted = Mounted {
        actuator: paper.actuator(),
        mechanism: 0,
        coupling: Coupling::Direct { coordinate: 0 },
        tendon: Some(SeriesTendon::new(STIFFNESS, REST).expect("a tendon")),
        pressure: Some(PressureSeries::new(&TIMES, &GAUGES).expect("a time series")),
    };
    let plant = Plant::new(vec![mounted], Network::new(&paper.air()), vec![mechanism]).expect("a plant");
    let start = PlantStart {
        positions: vec![vec![DISTANCE]],
        rates: vec![vec![0.0]],
        air: vec![InitialAir { gauge_pressure: GaugePressure(0.0), temperature: ROOM }],
        lengths: vec![None],
        ..PlantStart::default()
    };
    (plant, start)
}

/// Static force (3) of the ideal braid in N at a length in m and a gauge pressure in Pa.
fn pull(paper: &Paper, length: f64, gauge: f64) -> f64 {
    let (b, n) = (paper.thread_length, paper.turns);
    gauge * (3.0 * length * length - b * b) / (4.0 * PI * n * n)
}

/// Without friction, `P_g(t) (3 L² − b²)/(4πn²) = k (x − ℓ − L)` at every time: a quadratic equation of the length. A closed
/// process takes the mass of air `P V/(R T)` that it needs; an isothermal one at the temperature of the start.
#[test]
fn a_frictionless_end_is_where_both_tensions_are_equal() {
    for process in [Process::Isothermal, Process::Isentropic] {
        let paper = Paper::sealed().friction(0.0, 0.0).process(process);
        let (plant, start) = plant(&paper, Mechanism::Fixed);
        let run = simulate_plant(&plant, &start, 0.3, 1e-9).expect("a run");
        let (b, n) = (paper.thread_length, paper.turns);
        let mut lengths = (f64::INFINITY, 0.0_f64);
        for step in 0..=60 {
            let time = 0.005 * f64::from(step);
            // a L² + k L − (k (x − ℓ) + a b²/3) = 0 with a = 3 P_g/(4πn²).
            let a = 3.0 * gauge(time) / (4.0 * PI * n * n);
            let rest = STIFFNESS * (DISTANCE - REST) + a * b * b / 3.0;
            let length = ((STIFFNESS * STIFFNESS + 4.0 * a * rest).sqrt() - STIFFNESS) / (2.0 * a);
            let own = run.sample(time).actuators[0];
            assert_within(own.length, length, 1e-9);
            assert_within(own.tension, STIFFNESS * (DISTANCE - REST - length), 1e-4);
            assert_within(own.pressure.0, ATMOSPHERE + gauge(time), 1e-6);
            if process == Process::Isothermal {
                let mass = own.pressure.0 * own.volume / (paper.air().gas_constant() * ROOM);
                assert_within(own.air_mass, mass, 1e-9 * mass);
            }
            lengths = (lengths.0.min(length), lengths.1.max(length));
        }
        assert!(lengths.1 - lengths.0 > 1e-3, "{lengths:?}");
    }
}

/// With viscous friction, `c dL/dt = k (x − ℓ − L) − F(L, P(t))` and `M d²x/dt² = W − k (x − ℓ − L)`, here by the classical
/// Runge–Kutta method with steps of 2 µs.
#[test]
fn a_damped_end_on_a_mass_is_that_of_another_integrator() {
    let (viscous, mass, weight) = (40.0, 1.5, 30.0);
    let paper = Paper::sealed().friction(viscous, 0.0);
    let load = Mass::new(mass, Pull::Force(weight), None).expect("a mass");
    let (plant, start) = plant(&paper, Mechanism::Mass(load));
    let run = simulate_plant(&plant, &start, 0.2, 1e-10).expect("a run");
    let first = run.sample(0.0).actuators[0];
    let balance = STIFFNESS * (DISTANCE - REST - first.length) - pull(&paper, first.length, GAUGES[0]);
    assert_within(balance, 0.0, 1e-8);
    let step = 2e-6;
    let mut state = [DISTANCE, 0.0, first.length];
    for index in 0..100_000 {
        let start = f64::from(index) * step;
        if index % 5000 == 0 {
            let sample = run.sample(start);
            assert_within(sample.mechanisms[0].position[0], state[0], 1e-9);
            assert_within(sample.actuators[0].length, state[2], 1e-9);
        }
        state = runge_kutta(state, step, |since, [distance, rate, length]| {
            let tension = STIFFNESS * (distance - REST - length);
            // The rows lie on whole steps, so that none is crossed within one.
            let pressure = gauge((start + since).min(if start < TIMES[1] - 0.5 * step { TIMES[1] } else { TIMES[2] }));
            [rate, (weight - tension) / mass, (tension - pull(&paper, length, pressure)) / viscous]
        });
    }
    assert!((state[0] - DISTANCE).abs() > 1e-3, "{state:?}");
}

#[test]
fn energy_closes_with_and_without_friction() {
    for (viscous, width) in [(0.0, 0.0), (0.0, 2e-4), (5.0, 2e-4)] {
        let paper = Paper::sealed().friction(viscous, width);
        let load = Mass::new(1.5, Pull::Force(30.0), None).expect("a mass");
        let (plant, start) = plant(&paper, Mechanism::Mass(load));
        let ledger = simulate_plant(&plant, &start, 0.3, 1e-8).expect("a run").ledger();
        let work = ledger.work();
        assert!(work.turnover > 0.1, "{work:?}");
        assert_within(work.residual, 0.0, 1e-6 * work.turnover);
        let exergy = ledger.exergy();
        assert_within(exergy.residual, 0.0, 1e-6 * exergy.turnover);
    }
}

/// A linear model has the pressure for an input, not its rate, which the end of a tendon without viscous friction follows.
#[test]
fn a_linear_model_needs_viscous_friction() {
    let model = |viscous: f64| {
        let load = Mass::new(1.5, Pull::Force(30.0), None).expect("a mass");
        let (plant, start) = plant(&Paper::sealed().friction(viscous, 0.0), Mechanism::Mass(load));
        let balance = PlantBalance::Shut(vec![GaugePressure(GAUGES[0])]);
        linearize_plant(&plant, &start, &balance, &PlantAir::Temperatures(vec![ROOM]))
    };
    let error = model(0.0).expect_err("refused").to_string();
    assert!(error.contains("give actuator.friction.viscous, however small"), "{error}");
    model(5.0).expect("a model");
}

/// One actuator on a tendon, its pressure and the motion of the tendon's load end both given: the tendon's tension is
/// the braid's and the viscous friction's at every time.
#[test]
fn one_actuator_follows_a_pressure_and_a_motion() {
    let (viscous, amplitude, frequency) = (3.0, 1e-3, 3.0);
    let paper = Paper::sealed().friction(viscous, 0.0);
    let motion = Motion::sinusoid(DISTANCE, amplitude, frequency, 0.0, f64::MAX).expect("a motion");
    let tendon = SeriesTendon::new(STIFFNESS, REST).expect("a tendon");
    let series = PressureSeries::new(&TIMES, &GAUGES).expect("a time series");
    let rig = paper.rig().with_load(Load::Prescribed(motion)).with_tendon(tendon).with_pressure(series).expect("a rig");
    let initial = Initial {
        gauge_pressure: GaugePressure(0.0),
        temperature: ROOM,
        length: InitialLength::Equilibrium,
        velocity: 0.0,
    };
    let start = rig.start(&initial).expect("a start");
    let balanced = STIFFNESS * (DISTANCE - REST - start.length);
    assert_within(pull(&paper, start.length, GAUGES[0]), balanced, 1e-9 * balanced);
    let run = simulate(&rig, start, TIMES[2], 1e-11).expect("a run");
    for sample in run.samples(1e-3) {
        let distance = DISTANCE + amplitude * (2.0 * PI * frequency * sample.time).sin();
        assert_within(sample.load_distance, distance, 1e-12);
        let tension = STIFFNESS * (distance - REST - sample.length);
        assert_within(sample.tension, tension, 1e-9 * tension);
        let own = pull(&paper, sample.length, gauge(sample.time)) + viscous * sample.velocity;
        assert_within(own, tension, 1e-8 * tension);
    }
    let mut steps = RigSteps::new(&rig, start, Method::Stable);
    for index in 1..=1000 {
        steps.advance_to(1e-4 * f64::from(index)).expect("a step");
        let (sample, exact) = (steps.sample(), run.at(steps.time()));
        assert_within(sample.load_distance, exact.load_distance, 1e-12);
        assert_within(sample.length, exact.length, 1e-6);
        let tension = STIFFNESS * (sample.load_distance - REST - sample.length);
        assert_within(sample.tension, tension, 1e-9 * tension);
    }
}
