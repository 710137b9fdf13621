//! Poles, frequency response and controllability of linear models: closed forms, polynomials, ring-downs in simulation.
#![cfg(feature = "analysis")]

use crate::common::tendon::on_tendon;
use crate::common::{LB, PSI, Paper, ROOM, assert_close, assert_within, between, bisect};
use mckibben::GaugePressure;
use mckibben::air::Process;
use mckibben::friction::Coulomb;
use mckibben::linearize::{Aim, Balance, Content, Linearization, Pole, StateSpace, linearize, linearize_driven};
use mckibben::plant::RigTrajectory;
use mckibben::simulation::Rig;
use std::f64::consts::{PI, TAU};

const MASS: f64 = 5.0 * LB;

fn at_60_psi(paper: &Paper) -> Linearization {
    linearize(&paper.rig(), Balance::AtPressure(GaugePressure(60.0 * PSI)), Content::Temperature(ROOM))
        .expect("a point")
}

/// A system with this matrix and nothing else of interest.
fn of_matrix(a: Vec<Vec<f64>>) -> StateSpace {
    let names = at_60_psi(&Paper::sealed()).system;
    let n = a.len();
    let states = names.states[..n].to_vec();
    StateSpace { a, states, b: vec![vec![0.0; 2]; n], c: vec![vec![0.0; n]; 4], ..names }
}

#[test]
fn the_sealed_actuators_poles_are_those_of_a_damped_spring_and_an_integrator() {
    for process in [Process::Isentropic, Process::Isothermal] {
        let paper = Paper::sealed().process(process);
        let linear = at_60_psi(&paper);
        let state = linear.point.state;
        let stiffness = paper.actuator().sealed_stiffness(state.length, state.pressure);
        let natural = (stiffness / MASS).sqrt();
        let damping = paper.viscous / (2.0 * (stiffness * MASS).sqrt());
        for (system, zeros) in [(linear.minimal(), 1), (linear.system.clone(), 2)] {
            let poles = system.poles().unwrap();
            assert_eq!(poles.iter().filter(|pole| pole.is_zero()).count(), zeros);
            for (pole, sign) in poles.iter().zip([1.0, -1.0]) {
                assert_close(pole.natural_frequency(), natural, 1e-12);
                assert_close(pole.damping_ratio().unwrap(), damping, 1e-10);
                assert_close(pole.time_constant().unwrap(), 2.0 * MASS / paper.viscous, 1e-10);
                assert_close(pole.imaginary, sign * natural * (1.0 - damping * damping).sqrt(), 1e-12);
            }
            assert_eq!((poles[2].damping_ratio(), poles[2].time_constant()), (None, None));
        }
    }
}

#[test]
fn poles_are_roots_of_the_characteristic_polynomial() {
    // Companion matrices of polynomials with roots −p, −q, −r ± s i, scaled as badly as a rig's states are.
    for row in 0..50 {
        let [p, q, r, s] = [0, 1, 2, 3].map(|column| 10_f64.powf(between(row, column, -1.0, 3.0)));
        let product = |x: &[f64], y: &[f64]| {
            let mut z = vec![0.0; x.len() + y.len() - 1];
            for (i, x) in x.iter().enumerate() {
                for (j, y) in y.iter().enumerate() {
                    z[i + j] += x * y;
                }
            }
            z
        };
        let polynomial = product(&product(&[p, 1.0], &[q, 1.0]), &[r * r + s * s, 2.0 * r, 1.0]);
        let sizes = [1e-1, 1.0, 1e6, 1e-6];
        let companion = |i: usize, j: usize| if i == 3 { -polynomial[j] } else { f64::from(j == i + 1) };
        let a = (0..4).map(|i| (0..4).map(|j| companion(i, j) * sizes[i] / sizes[j]).collect()).collect();
        let mut expected = vec![(-p, 0.0), (-q, 0.0), (-r, s), (-r, -s)];
        for Pole { real, imaginary } in of_matrix(a).poles().unwrap() {
            let far = |root: &(f64, f64)| (root.0 - real).hypot(root.1 - imaginary);
            let nearest = (0..expected.len()).min_by(|a, b| far(&expected[*a]).total_cmp(&far(&expected[*b]))).unwrap();
            let root = expected.remove(nearest);
            // Roots that lie close together answer to rounding by its root.
            assert_within(far(&root), 0.0, 1e-5 * root.0.hypot(root.1));
        }
    }
}

/// The peaks of the length, by the zeros of the velocity.
fn peaks(run: &RigTrajectory, duration: f64) -> Vec<(f64, f64)> {
    let velocity = |time: f64| run.at(time).velocity;
    let count = 4000;
    let time = |n: usize| duration * n as f64 / count as f64;
    let falls = (1..count - 1).filter(|n| velocity(time(*n)) > 0.0 && velocity(time(n + 1)) <= 0.0);
    falls.map(|n| bisect(time(n), time(n + 1), velocity)).map(|at| (at, run.at(at).length)).collect()
}

#[test]
fn a_ring_down_has_the_period_and_the_decrement_of_the_poles() {
    let paper = Paper::sealed().friction(6.0, 0.0).gauge(60.0 * PSI);
    let pole = at_60_psi(&paper).minimal().poles().unwrap()[0];
    let rest = paper.start().length;
    let run = paper.from(rest, 1e-3).run(1.2, 1e-12);
    let peaks = peaks(&run, 1.2);
    assert!(peaks.len() > 4);
    let period = TAU / pole.imaginary;
    for pair in peaks.windows(2) {
        assert_close(pair[1].0 - pair[0].0, period, 1e-4);
        let drop = ((pair[0].1 - rest) / (pair[1].1 - rest)).ln();
        assert_close(drop, -pole.real * period, 5e-3);
    }
}

#[test]
fn the_equivalent_damping_takes_as_much_as_coulomb_friction_does() {
    let paper = Paper::sealed().friction(0.0, 5e-6).gauge(60.0 * PSI);
    let linear = at_60_psi(&paper);
    let free = linear.minimal().poles().unwrap()[0];
    assert_within(free.real, 0.0, 1e-9);
    let rest = paper.start().length;
    let run = paper.from(rest, 0.05).run(1.2, 1e-10);
    let peaks = peaks(&run, 1.2);
    println!("{peaks:?}");
    assert!(peaks.len() > 3);
    for pair in peaks.windows(2) {
        let [first, second] = [pair[0].1 - rest, pair[1].1 - rest];
        let amplitude = 0.5 * (first + second);
        let damped = linear.with_equivalent_damping(amplitude, free.imaginary).unwrap();
        let pole = damped.minimal().poles().unwrap()[0];
        assert_close((first / second).ln(), -pole.real * TAU / pole.imaginary, 0.03);
    }
    // The loss in a cycle is π c ω X² = 4 Q k_sec X.
    let damping = linear.equivalent_damping(1e-3, 70.0).unwrap();
    assert_close(PI * damping * 70.0 * 1e-6, 4.0 * linear.point.coulomb_bound() * 1e-3, 1e-14);
}

/// Friction that falls with velocity holds ρ F_c at rest. Over a cycle `∫ s(v cos θ) cos θ dθ` of a quarter is 1 + (ρ − 1) D(r)/r,
/// with r = ωX/v_s and Dawson's integral D, whose values are tabulated.
#[test]
fn friction_that_falls_with_velocity_holds_more_and_damps_by_dawsons_integral() {
    let (ratio, scale) = (1.8, 0.02);
    let coulomb = Coulomb::new(5e-6).expect("a width").with_force(0.3, 0.0).expect("a force");
    let at = |coulomb: Coulomb| at_60_psi(&Paper::sealed().with(|rig| rig.coulomb = Some(coulomb)));
    let [_, kinetic] = at(coulomb).plant.coulomb_bounds(0);
    let linear = at(coulomb.with_stribeck(ratio, scale).expect("a fall"));
    assert_close(linear.plant.coulomb_bounds(0)[1], ratio * kinetic, 1e-12);
    let amplitude = 1e-3;
    for (r, dawson) in [(0.5, 0.424_436_383_502_022), (1.0, 0.538_079_506_912_768), (2.0, 0.301_340_388_923_792)] {
        let frequency = r * scale / amplitude;
        let mean = kinetic * (1.0 + (ratio - 1.0) * dawson / r);
        let damping = linear.equivalent_damping(amplitude, frequency).expect("a damping");
        assert_close(damping, 4.0 * mean / (PI * frequency * amplitude), 1e-9);
    }
}

#[test]
fn the_response_to_a_force_is_that_of_a_damped_spring() {
    let paper = Paper::sealed();
    let linear = at_60_psi(&paper);
    let state = linear.point.state;
    let stiffness = paper.actuator().sealed_stiffness(state.length, state.pressure);
    for system in [&linear.system, &linear.minimal()] {
        let (input, output) = (system.input("force").unwrap(), system.output("length").unwrap());
        for frequency in [0.1, 3.0, 60.0, 70.0, 500.0, 1e4] {
            // 1/(k − M ω² + c ω i)
            let (real, imaginary) = (stiffness - MASS * frequency * frequency, paper.viscous * frequency);
            let squared = real * real + imaginary * imaginary;
            let response = system.response(input, output, frequency).unwrap();
            assert_within(response.real, real / squared, 1e-11 / squared.sqrt());
            assert_within(response.imaginary, -imaginary / squared, 1e-11 / squared.sqrt());
            assert_close(response.magnitude(), 1.0 / squared.sqrt(), 1e-11);
            assert_within(response.phase(), -imaginary.atan2(real), 1e-10);
        }
    }
}

#[test]
fn the_air_mass_is_an_integrator_that_the_flow_reaches_and_a_force_does_not() {
    let linear = at_60_psi(&Paper::sealed());
    let (minimal, full) = (linear.minimal(), linear.system.clone());
    let reach = |system: &StateSpace, name| linear.controllability(system, system.input(name).unwrap()).unwrap();
    let by_flow = reach(&minimal, "mass_flow");
    assert_eq!(by_flow.rank, 3);
    assert!(by_flow.condition > 1.0 && by_flow.condition < 1e3, "{by_flow:?}");
    let by_force = reach(&minimal, "force");
    assert_eq!((by_force.rank, by_force.condition), (2, f64::INFINITY));
    assert_eq!(reach(&full, "mass_flow").rank, 3);
    for reach in [by_flow, by_force] {
        assert_eq!(reach.singular_values.len(), 3);
        assert_eq!(reach.singular_values[0], 1.0);
        assert!(reach.singular_values.windows(2).all(|pair| pair[0] >= pair[1]));
    }
}

/// A system with a matrix and one input.
fn of_input(a: Vec<Vec<f64>>, b: &[f64]) -> StateSpace {
    let names = at_60_psi(&Paper::sealed()).system;
    let (states, b) = (vec![names.states[0].clone(); a.len()], b.iter().map(|entry| vec![*entry]).collect());
    StateSpace { a, states, b, c: Vec::new(), ..names }
}

/// A chain of first-order lags, each driven by the one before: an input of the k-th moves those from it on, whatever the time constants
/// are. Powers of the matrix lost the slow ones beside fast ones.
#[test]
fn a_chain_of_lags_is_reached_from_its_input_on() {
    let n = 8;
    for rising in [true, false] {
        let lag = |k: usize| 10_f64.powf(4.0 * (if rising { k } else { n - 1 - k }) as f64 / (n - 1) as f64 - 4.0);
        let entry = |row: usize, column: usize| match row {
            _ if row == column => -1.0 / lag(row),
            _ if row == column + 1 => 1.0 / lag(row),
            _ => 0.0,
        };
        let a: Vec<Vec<f64>> = (0..n).map(|row| (0..n).map(|column| entry(row, column)).collect()).collect();
        for from in 0..n {
            let b: Vec<f64> = (0..n).map(|row| if row == from { 1.0 / lag(row) } else { 0.0 }).collect();
            assert_eq!(of_input(a.clone(), &b).reached(0), n - from, "from {from}, rising {rising}");
        }
    }
}

/// Two modes of one pole that nothing couples move in a fixed proportion; with other poles each is moved.
#[test]
fn equal_modes_are_moved_together() {
    for (poles, due) in [([-3.0, -3.0], 1), ([-3.0, -3.1], 2), ([-3.0, -3e4], 2)] {
        let reached = |b: [f64; 2]| of_input(vec![vec![poles[0], 0.0], vec![0.0, poles[1]]], &b).reached(0);
        assert_eq!([reached([1.0, 2.0]), reached([1.0, 0.0]), reached([0.0, 0.0])], [due, 1, 0]);
    }
}

#[test]
fn stability_and_air_under_pwm() {
    let paper = Paper::pwm(100.0, 0.5).with(|rig| rig.delays = (1e-3, 1e-3));
    let start = paper.start();
    for process in [Process::Isentropic, Process::EnergyBalance { heat_transfer: 0.05, wall_temperature: ROOM }] {
        let rig = paper.clone().process(process).rig();
        let linear = linearize_driven(&rig, Aim::Duty(0.5), Content::Of(start)).unwrap();
        let system = linear.minimal();
        let poles = system.poles().unwrap();
        assert!(poles.iter().all(|pole| pole.real < 0.0), "{poles:?}");
        assert_eq!(poles.len(), if matches!(process, Process::Isentropic) { 3 } else { 4 });
        let reach = linear.controllability(&system, system.input("duty").unwrap()).unwrap();
        assert_eq!(reach.rank, system.states.len());
        assert!(linear.ripple("length").unwrap() > 0.0 && linear.ripple("length").unwrap() < 1e-3);
    }
    assert!(at_60_psi(&Paper::sealed()).ripple("length").is_none());
}

#[test]
fn a_stiff_tendon_is_none_under_pulses_on_average() {
    let paper = Paper::pwm(100.0, 0.5);
    let averaged = |rig: &Rig| linearize_driven(rig, Aim::Duty(0.5), Content::Temperature(ROOM)).expect("a point");
    let (with, without) = (averaged(&on_tendon(&paper, 1e10)), averaged(&paper.rig()));
    assert_eq!(with.point.state, without.point.state);
    let (with, without) = (with.minimal(), without.minimal());
    for input in ["duty", "force"] {
        for (output, same) in [("length", "length"), ("load_distance", "length"), ("pressure", "pressure")] {
            for frequency in [0.1, 10.0, 60.0] {
                let response = |system: &StateSpace, output: &str| {
                    let of = [system.input(input).expect("an input"), system.output(output).expect("an output")];
                    system.response(of[0], of[1], frequency).expect("bounded")
                };
                let (of, expected) = (response(&with, output), response(&without, same));
                // The tendon gives a part 2e-5 of what the muscle does.
                let size = 1e-4 * expected.magnitude();
                assert_within(of.real, expected.real, size);
                assert_within(of.imaginary, expected.imaginary, size);
            }
        }
    }
}

/// A muscle pulls or is slack: where friction exceeds the tension T, it holds T less and F_c more, and a cycle takes T + F_c in place
/// of 2 F_c. A slack one neither holds nor takes anything.
#[test]
fn friction_beyond_the_tension_holds_and_damps_by_what_is_pulled() {
    let friction = 400.0;
    let coulomb = Coulomb::new(0.0).expect("a width").with_force(friction, 0.0).expect("a force");
    let linear = at_60_psi(&Paper::sealed().with(|rig| rig.coulomb = Some(coulomb)));
    let tension = linear.point.tension();
    assert!(tension < friction, "{tension}");
    let [less, more] = linear.plant.coulomb_bounds(0);
    assert_close(less, tension, 1e-9);
    assert_close(more, friction, 1e-12);
    let damping = linear.equivalent_damping(1e-3, 70.0).expect("a damping");
    assert_close(PI * damping * 70.0 * 1e-6, 2.0 * (tension + friction) * 1e-3, 1e-9);
}
