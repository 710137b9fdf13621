//! The rig near an operating point: closed forms, the invariant's pole, simulated trajectories, and what is refused.

use crate::common::{ATMOSPHERE, GRAVITY, INCH, LB, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::air::Process;
use mckibben::friction::{Hysteresis, MaxwellSlip};
use mckibben::linearize::{
    Aim, Balance, Content, Linearization, OperatingPoint, Signal, StateSpace, linearize, linearize_driven,
};
use mckibben::load::{Load, Motion};
use mckibben::simulation::{State, simulate};
use mckibben::{AbsolutePressure, Error, GaugePressure};

const PROCESSES: [Process; 4] = [
    Process::Isentropic,
    Process::Isothermal,
    Process::Polytropic { index: 1.2 },
    Process::EnergyBalance { heat_transfer: 0.05, wall_temperature: ROOM },
];

fn at_60_psi(paper: &Paper) -> Linearization {
    linearize(&paper.rig(), Balance::AtPressure(GaugePressure(60.0 * PSI)), Content::Temperature(ROOM))
        .expect("a point")
}

/// The coefficients 1, a₁, a₂, … of det(λ I − A), by Faddeev and Le Verrier.
fn characteristic(a: &[Vec<f64>]) -> Vec<f64> {
    let n = a.len();
    let mut coefficients = vec![1.0];
    let mut m = vec![vec![0.0; n]; n];
    for k in 1..=n {
        let last = coefficients[k - 1];
        let mut next = vec![vec![0.0; n]; n];
        for (i, row) in next.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = (0..n).map(|l| a[i][l] * m[l][j]).sum::<f64>() + if i == j { last } else { 0.0 };
            }
        }
        m = next;
        let trace: f64 = (0..n).map(|i| (0..n).map(|l| a[i][l] * m[l][i]).sum::<f64>()).sum();
        coefficients.push(-trace / k as f64);
    }
    coefficients
}

#[test]
fn a_sealed_actuator_is_the_spring_of_equation_5_on_its_mass() {
    for process in &PROCESSES[..3] {
        let paper = Paper::sealed().process(*process);
        let linear = at_60_psi(&paper);
        let (actuator, state) = (paper.actuator(), linear.point.state);
        let mass = 5.0 * LB;
        assert_close(state.length, paper.clone().gauge(60.0 * PSI).balance(mass * GRAVITY), 1e-13);
        assert_close(linear.point.temperature(), ROOM, 1e-14);
        assert_close(linear.point.tension(), mass * GRAVITY, 1e-13);
        // λ (λ² + (c/M) λ + k/M), k the stiffness with the valve shut.
        let stiffness = actuator.sealed_stiffness(state.length, state.pressure);
        let polynomial = characteristic(&linear.minimal().a);
        assert_close(polynomial[1], paper.viscous / mass, 1e-12);
        assert_close(polynomial[2], stiffness / mass, 1e-12);
        assert_within(polynomial[3], 0.0, 1e-12 * polynomial[2]);
        // At constant pressure it is that of equation (7).
        let constant = actuator.stiffness(state.length, state.pressure);
        assert_close(linear.system.a[1][0], -constant / mass, 1e-13);
        assert_close(linear.system.c[3][0], constant, 1e-13);
    }
}

#[test]
fn entries_of_the_matrices_in_closed_form() {
    let paper = Paper::sealed();
    let linear = at_60_psi(&paper);
    let State { length, pressure, air_mass, .. } = linear.point.state;
    let (b, n, mass) = (paper.thread_length, paper.turns, 5.0 * LB);
    let per_turns = 1.0 / (4.0 * std::f64::consts::PI * n * n);
    let volume = length * (b * b - length * length) * per_turns + paper.external_volume;
    let slope = (b * b - 3.0 * length * length) * per_turns;
    let StateSpace { a, b, c, d, states, inputs, outputs } = &linear.system;
    fn names(signals: &[Signal]) -> Vec<(&str, &str)> {
        signals.iter().map(|signal| (signal.name.as_str(), signal.unit)).collect()
    }
    assert_eq!(names(states), [("length", "m"), ("velocity", "m/s"), ("pressure", "Pa"), ("air_mass", "kg")]);
    assert_eq!(names(inputs), [("mass_flow", "kg/s"), ("force", "N")]);
    assert_eq!(names(outputs), [("length", "m"), ("velocity", "m/s"), ("pressure", "Pa"), ("tension", "N")]);
    assert_eq!(a[0], [0.0, 1.0, 0.0, 0.0]);
    assert_close(a[1][1], -paper.viscous / mass, 1e-14);
    assert_close(a[1][2], slope / mass, 1e-14); // −∂F/∂P = dV/dL
    assert_close(a[2][1], -1.4 * pressure.0 * slope / volume, 1e-14);
    assert_close(b[2][0], 1.4 * pressure.0 / air_mass, 1e-14);
    assert_eq!((b[3][0], b[1][1], b[1][0], b[2][1]), (1.0, 1.0 / mass, 0.0, 0.0));
    assert_close(c[3][2], -slope, 1e-14);
    assert_eq!(c[3][1], paper.viscous);
    assert!(d.iter().flatten().all(|entry| *entry == 0.0));
    assert_eq!((c[0].as_slice(), c[2].as_slice()), (&[1.0, 0.0, 0.0, 0.0][..], &[0.0, 0.0, 1.0, 0.0][..]));
}

/// Before any element of Maxwell slip slides, all of them together are a spring of Σ wᵢ k_sec.
#[test]
fn elements_that_stick_add_their_stiffness() {
    let law = MaxwellSlip::new(&[1e-4, 5e-4], &[0.3, 0.2]).expect("a law");
    let paper = Paper::sealed();
    let with = at_60_psi(&paper.clone().with(|rig| rig.hysteresis = Some(Hysteresis::MaxwellSlip(law))));
    let without = at_60_psi(&paper);
    let stiffness = |linear: &Linearization| linear.system.c[linear.system.output("tension").expect("a tension")][0];
    let state = without.point.state;
    let secant = paper.actuator().secant_stiffness(state.length, state.pressure.0);
    assert_close(stiffness(&with) - stiffness(&without), 0.5 * secant, 1e-9);
}

/// The row of d ln[P (V/m)^κ] by the states.
fn invariant(linear: &Linearization, index: f64) -> [f64; 4] {
    let State { length, pressure, air_mass, .. } = linear.point.state;
    let actuator = linear.point.rig.actuator();
    let slope = actuator.law().law.braid.volume_slope(length);
    [index * slope / actuator.volume(length), 0.0, 1.0 / pressure.0, -index / air_mass]
}

#[test]
fn what_the_process_keeps_is_a_pole_at_zero_that_no_input_reaches() {
    for (process, index) in PROCESSES.into_iter().zip([1.4, 1.0, 1.2]) {
        let paper = Paper::pwm(50.0, 0.5).process(process);
        let held = at_60_psi(&paper);
        let start = paper.start();
        let pulsed = linearize_driven(&paper.rig(), Aim::Duty(0.5), Content::Of(start)).expect("a point");
        for linear in [held, pulsed] {
            let row = invariant(&linear, index);
            let StateSpace { a, b, .. } = &linear.system;
            for matrix in [a, b] {
                for column in 0..matrix[0].len() {
                    let terms: Vec<f64> = (0..4).map(|state| row[state] * matrix[state][column]).collect();
                    let size = terms.iter().fold(0.0_f64, |most, term| most.max(term.abs()));
                    assert_within(terms.iter().sum(), 0.0, 1e-12 * size);
                }
            }
            let (full, minimal) = (characteristic(a), characteristic(&linear.minimal().a));
            let scale = full[1].abs() + full[2].abs().sqrt();
            assert_within(full[4], 0.0, 1e-12 * scale.powi(4));
            for power in 1..=3 {
                assert_within(minimal[power], full[power], 1e-9 * full[power].abs() + 1e-12 * scale.powi(power as i32));
            }
        }
    }
}

/// exp(A t) by its series on a halved interval, squared again.
fn exponential(a: &[Vec<f64>], time: f64) -> Vec<Vec<f64>> {
    let n = a.len();
    let product = |x: &[Vec<f64>], y: &[Vec<f64>]| -> Vec<Vec<f64>> {
        (0..n).map(|i| (0..n).map(|j| (0..n).map(|l| x[i][l] * y[l][j]).sum()).collect()).collect()
    };
    let unit: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| f64::from(i == j)).collect()).collect();
    let step = time / 1024.0;
    let (mut sum, mut term) = (unit.clone(), unit);
    for k in 1..20 {
        term = product(&term, a);
        term.iter_mut().flatten().for_each(|entry| *entry *= step / k as f64);
        sum.iter_mut().flatten().zip(term.iter().flatten()).for_each(|(sum, term)| *sum += term);
    }
    for _ in 0..10 {
        sum = product(&sum, &sum);
    }
    sum
}

/// The end of a simulated stretch of time from a state.
fn end_of(paper: &Paper, start: [f64; 4], time: f64) -> [f64; 4] {
    let [length, velocity, pressure, air_mass] = start;
    let start = State { length, velocity, pressure: AbsolutePressure(pressure), air_mass };
    let end = simulate(&paper.rig(), start, time, 1e-12).expect("a run").at(time);
    [end.length, end.velocity, end.pressure.0, end.air_mass]
}

#[test]
fn simulated_trajectories_leave_the_point_as_the_exponential_says() {
    const TIME: f64 = 0.02;
    for process in PROCESSES {
        let paper = Paper::sealed().process(process).friction(3.5, 0.0);
        let linear = at_60_psi(&paper);
        let State { length, pressure, air_mass, .. } = linear.point.state;
        let point = [length, 0.0, pressure.0, air_mass];
        let transition = exponential(&linear.system.a, TIME);
        let steps = [1e-5, 1e-3, 50.0, 1e-4 * air_mass];
        for from in 0..4 {
            let end = |sign: f64| {
                let mut start = point;
                start[from] += sign * steps[from];
                end_of(&paper, start, TIME)
            };
            let (above, below) = (end(1.0), end(-1.0));
            for to in 0..4 {
                let simulated = (above[to] - below[to]) / (2.0 * steps[from]);
                // As a part of the largest response of that state.
                let size = (0..4).map(|n| (transition[to][n] * steps[n] / steps[from]).abs()).fold(0.0, f64::max);
                assert_within(simulated, transition[to][from], 2e-5 * size);
            }
        }
    }
}

#[test]
fn the_taut_braid_is_part_of_the_model() {
    let paper = Paper::sealed();
    let linear = linearize(&paper.rig(), Balance::AtPressure(GaugePressure(0.0)), Content::Temperature(ROOM)).unwrap();
    assert!(linear.point.is_taut());
    let mass = 5.0 * LB;
    assert_close(linear.system.a[1][0], -paper.limit_stiffness / mass, 1e-12);
    assert_close(linear.system.a[1][1], -(paper.viscous + paper.limit_damping) / mass, 1e-12);
    assert_close(linear.system.c[3][1], paper.viscous + paper.limit_damping, 1e-12);
}

#[test]
fn two_of_pressure_length_and_load_give_the_third() {
    let paper = Paper::sealed();
    let rig = paper.rig();
    let content = Content::Temperature(ROOM);
    let gauge = GaugePressure(60.0 * PSI);
    let first = OperatingPoint::held(&rig, Balance::AtPressure(gauge), content).unwrap();
    let length = first.state.length;
    let second = OperatingPoint::held(&rig, Balance::AtLength(length), content).unwrap();
    assert_close(second.gauge_pressure().0, gauge.0, 1e-12);
    let third =
        OperatingPoint::held(&Paper::sealed().mass(1.0).rig(), Balance::AtBoth(gauge, length), content).unwrap();
    let Load::HangingMass { mass, .. } = third.rig.load() else { panic!("another load") };
    assert_close(*mass, 5.0 * LB, 1e-12);
    let pulled = Paper::sealed().with(|rig| rig.load = Load::ConstantForce { mass: 2.0, force: 1.0 });
    let third = OperatingPoint::held(&pulled.rig(), Balance::AtBoth(gauge, length), content).unwrap();
    let Load::ConstantForce { mass, force } = third.rig.load() else { panic!("another load") };
    assert_eq!(*mass, 2.0);
    assert_close(*force, 5.0 * LB * GRAVITY, 1e-12);
}

#[test]
fn held_ends_leave_pressure_and_air_mass() {
    let paper = Paper::sealed().isometric(3.5 * INCH);
    let both = Balance::AtBoth(GaugePressure(60.0 * PSI), 3.5 * INCH);
    let linear = linearize(&paper.rig(), both, Content::Temperature(ROOM)).unwrap();
    assert_eq!(linear.system.states.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["pressure", "air_mass"]);
    assert_eq!(linear.minimal().states.len(), 1);
    assert_eq!(linear.system.inputs.len(), 1);
    let State { length, pressure, air_mass, .. } = linear.point.state;
    assert_close(linear.minimal().b[0][0], 1.4 * pressure.0 / air_mass, 1e-14);
    let force = paper.actuator().static_force(length, pressure.0);
    assert_close(linear.system.c[1][0], force / (pressure.0 - ATMOSPHERE), 1e-12);
}

#[test]
fn the_content_of_a_state_is_that_of_a_run_from_it() {
    for process in PROCESSES {
        // Sealed, stretched, run down: wherever the run comes by, the point there has its air.
        let paper = Paper::sealed().process(process).gauge(60.0 * PSI).friction(3.5, 0.0).from(0.083, 0.0);
        let start = paper.start();
        let sample = paper.run(0.01, 1e-12).at(0.01);
        let gauge = sample.pressure.gauge(AbsolutePressure(ATMOSPHERE));
        let both = Balance::AtBoth(gauge, sample.length);
        let point = OperatingPoint::held(&paper.rig(), both, Content::Of(start)).unwrap();
        if matches!(process, Process::EnergyBalance { .. }) {
            assert_close(point.temperature(), ROOM, 1e-12);
        } else {
            assert_close(point.state.air_mass, sample.air_mass, 1e-9);
        }
    }
}

#[test]
fn points_that_cannot_be_are_refused_with_a_remedy() {
    let content = Content::Temperature(ROOM);
    let no = |paper: &Paper, balance| match linearize(&paper.rig(), balance, content) {
        Err(error) => error.to_string(),
        Ok(linear) => panic!("{:?}", linear.point),
    };
    let paper = Paper::sealed();
    let pressure = |psi: f64| Balance::AtPressure(GaugePressure(psi * PSI));
    assert!(no(&paper.clone().with(|rig| rig.min_length = Some(0.08)), pressure(200.0)).contains("shortest length"));
    assert!(no(&paper, pressure(-20.0)).contains("vacuum"));
    assert!(no(&paper, Balance::AtLength(0.2)).contains("thread_length"));
    assert!(no(&paper, Balance::AtLength(0.05)).contains("min_length"));
    assert!(no(&paper, Balance::AtLength(paper.thread_length / 3_f64.sqrt())).contains("no pressure"));
    assert!(no(&paper, Balance::AtLength(0.1)).contains("taut braid alone"));
    assert!(no(&paper, Balance::AtBoth(GaugePressure(-1e4), 0.09)).contains("no hanging mass"));
    let held = paper.clone().isometric(0.09);
    assert!(no(&held, pressure(60.0)).contains("isometric"));
    assert!(no(&held, Balance::AtLength(0.09)).contains("any pressure"));
    let motion = Motion::sinusoid(0.09, 0.002, 1.0, 0.0, paper.thread_length).unwrap();
    let moved = paper.clone().with(|rig| rig.load = Load::Prescribed(motion));
    assert!(no(&moved, pressure(60.0)).contains("prescribed motion"));
    let weightless = paper.clone().with(|rig| rig.load = Load::ConstantForce { mass: 1.0, force: 0.0 });
    assert!(no(&weightless, pressure(60.0)).contains("slack") || no(&weightless, pressure(60.0)).contains("shortest"));
    let warm = paper.clone().process(Process::EnergyBalance { heat_transfer: 1.0, wall_temperature: 350.0 });
    assert!(no(&warm, pressure(60.0)).contains("wall"));
    let cold = linearize(&paper.rig(), pressure(60.0), Content::Temperature(-1.0));
    assert!(matches!(cold, Err(Error::OutOfRange { .. })));
    let linear = at_60_psi(&paper);
    assert!(linear.with_equivalent_damping(0.0, 60.0).is_err() && linear.equivalent_damping(1e-3, f64::NAN).is_err());
}
