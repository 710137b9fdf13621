//! A load on an elastic tendon near an operating point: two springs in series, with a damper beside one and without; held ends;
//! trajectories of the event-located engine; what is refused. A stiff one is in `linearize_analysis.rs`.

use crate::common::tendon::{MASS, REST, STIFFNESS, on_tendon};
use crate::common::{GRAVITY, INCH, PSI, Paper, ROOM, assert_close, assert_within, runge_kutta};
use mckibben::air::Process;
use mckibben::linearize::{Balance, Content, Linearization, StateSpace, linearize};
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{Rig, State, simulate};
use mckibben::{AbsolutePressure, GaugePressure};

const PROCESSES: [Process; 3] = [Process::Isentropic, Process::Isothermal, Process::Polytropic { index: 1.2 }];

fn at_60_psi(rig: &Rig) -> Linearization {
    linearize(rig, Balance::AtPressure(GaugePressure(60.0 * PSI)), Content::Temperature(ROOM)).expect("a point")
}

fn names(system: &StateSpace) -> [Vec<&str>; 3] {
    [&system.states, &system.inputs, &system.outputs]
        .map(|signals| signals.iter().map(|signal| signal.name.as_str()).collect())
}

/// The coefficients 1, a₁, a₂, … of det(λ I − A), by Faddeev and Le Verrier.
fn characteristic(a: &[Vec<f64>]) -> Vec<f64> {
    let n = a.len();
    let mut coefficients = vec![1.0];
    let mut m = vec![vec![0.0; n]; n];
    for k in 1..=n {
        let last = coefficients[k - 1];
        m = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| (0..n).map(|l| a[i][l] * m[l][j]).sum::<f64>() + if i == j { last } else { 0.0 })
                    .collect()
            })
            .collect();
        let trace: f64 = (0..n).map(|i| (0..n).map(|l| a[i][l] * m[l][i]).sum::<f64>()).sum();
        coefficients.push(-trace / k as f64);
    }
    coefficients
}

/// `s (s² + k_s/M)`: sealed, two springs in series carry the mass, `1/k_s = 1/k + 1/k_m`.
#[test]
fn without_friction_it_is_two_springs_in_series() {
    for process in PROCESSES {
        let paper = Paper::sealed().friction(0.0, 0.0).process(process);
        let linear = at_60_psi(&on_tendon(&paper, STIFFNESS));
        let (actuator, State { length, pressure, .. }) = (paper.actuator(), linear.point.state);
        // The tendon changes nothing of where the actuator is, and the load hangs below by what it gives.
        assert_close(length, paper.clone().gauge(60.0 * PSI).balance(MASS * GRAVITY), 1e-13);
        let stretch = MASS * GRAVITY / STIFFNESS;
        assert_close(linear.point.load_distance().expect("a tendon"), length + REST + stretch, 1e-14);
        let own = actuator.sealed_stiffness(length, pressure);
        let both = STIFFNESS * own / (STIFFNESS + own);
        let system = linear.minimal();
        assert_eq!(names(&system)[0], ["load_distance", "load_velocity", "pressure"]);
        let polynomial = characteristic(&system.a);
        assert_within(polynomial[1], 0.0, 1e-9);
        assert_close(polynomial[2], both / MASS, 1e-12);
        assert_within(polynomial[3], 0.0, 1e-9 * polynomial[2]);
        // At a pressure that is kept the actuator takes k/(k + F_L) of what the load does, and both share one tension.
        let constant = actuator.stiffness(length, pressure);
        let of = |output: &str| &system.c[system.output(output).expect("an output")];
        assert_close(of("length")[0], STIFFNESS / (STIFFNESS + constant), 1e-13);
        assert_close(of("tension")[0], STIFFNESS * constant / (STIFFNESS + constant), 1e-12);
        assert_close(of("velocity")[1], STIFFNESS / (STIFFNESS + own), 1e-12);
    }
}

/// `(M s² + k)(c s + k_m + k) − k²` for a damper c beside the muscle.
#[test]
fn with_viscous_friction_the_length_is_a_state() {
    for process in PROCESSES {
        for (own_damping, coulomb) in [(3.5, 0.0), (80.0, 0.0), (3.5, 1e-4)] {
            let paper = Paper::sealed().friction(own_damping, coulomb).process(process);
            let linear = at_60_psi(&on_tendon(&paper, STIFFNESS));
            let (linear, damping) = if coulomb > 0.0 {
                let beside = linear.equivalent_damping(1e-4, 50.0).expect("a damping");
                assert_close(beside, 4.0 * linear.point.coulomb_bound() / (std::f64::consts::PI * 50.0 * 1e-4), 1e-14);
                (linear.with_equivalent_damping(1e-4, 50.0).expect("a model"), own_damping + beside)
            } else {
                (linear, own_damping)
            };
            let State { length, pressure, .. } = linear.point.state;
            let own = paper.actuator().sealed_stiffness(length, pressure);
            let system = linear.minimal();
            assert_eq!(names(&system)[0], ["load_distance", "load_velocity", "length", "pressure"]);
            let polynomial = characteristic(&system.a);
            assert_close(polynomial[1], (own + STIFFNESS) / damping, 1e-12);
            assert_close(polynomial[2], STIFFNESS / MASS, 1e-9);
            assert_close(polynomial[3], own * STIFFNESS / (MASS * damping), 1e-9);
            assert_within(polynomial[4], 0.0, 1e-9 * polynomial[3]);
        }
    }
}

#[test]
fn held_ends_leave_the_muscle_what_the_tendon_gives() {
    let held = |viscous: f64| {
        let paper = Paper::sealed().friction(viscous, 0.0).isometric(3.5 * INCH);
        let balance = Balance::AtBoth(GaugePressure(60.0 * PSI), 3.5 * INCH);
        let linear = linearize(&on_tendon(&paper, STIFFNESS), balance, Content::Temperature(ROOM)).expect("a point");
        (paper.actuator(), linear)
    };
    let (actuator, linear) = held(20.0);
    let State { length, pressure, air_mass, .. } = linear.point.state;
    let own = actuator.sealed_stiffness(length, pressure);
    let system = linear.minimal();
    assert_eq!(
        names(&system),
        [vec!["length", "pressure"], vec!["mass_flow"], vec!["length", "velocity", "pressure", "tension"]]
    );
    let polynomial = characteristic(&system.a);
    assert_close(polynomial[1], (own + STIFFNESS) / 20.0, 1e-12);
    assert_within(polynomial[2], 0.0, 1e-9 * polynomial[1]);
    // Without a damper air lets the muscle shorten at once: P′ = κ P ṁ/m (k + F_L)/(k + k_m).
    let (actuator, linear) = held(0.0);
    let constant = actuator.stiffness(length, pressure);
    let system = linear.minimal();
    assert_eq!(names(&system)[0], ["pressure"]);
    let given = 1.4 * pressure.0 / air_mass * (STIFFNESS + constant) / (STIFFNESS + own);
    assert_close(system.b[0][0], given, 1e-12);
    let per_pressure =
        (actuator.static_force(length, pressure.0 + 1.0) - actuator.static_force(length, pressure.0 - 1.0)) / 2.0;
    let tension = system.output("tension").expect("a tension");
    assert_close(system.c[tension][0], per_pressure * STIFFNESS / (STIFFNESS + constant), 1e-9);
}

/// The states of the model at a time in s of a run.
fn numbers(linear: &Linearization, run: &RigTrajectory, time: f64) -> Vec<f64> {
    let sample = run.at(time);
    let of = |name: &str| match name {
        "load_distance" => sample.load_distance,
        "load_velocity" => sample.load_velocity,
        "length" => sample.length,
        "pressure" => sample.pressure.0,
        "air_mass" => sample.air_mass,
        other => panic!("{other}"),
    };
    linear.system.states.iter().map(|signal| of(&signal.name)).collect()
}

/// Half the difference of two runs that start a little to either side follows `dx/dt = A x`.
#[test]
fn it_is_the_difference_of_two_simulated_trajectories() {
    for viscous in [0.0, 20.0] {
        let paper = Paper::sealed().friction(viscous, 0.0);
        let linear = at_60_psi(&on_tendon(&paper, STIFFNESS));
        let (rig, point) = (linear.point.rig.clone(), linear.point.state);
        for disturbed in 0..4 {
            let start = |sign: f64| {
                let State { mut length, mut velocity, pressure: AbsolutePressure(mut pressure), mut air_mass } = point;
                let size = [1e-6, 1e-4, 20.0, 1e-10][disturbed];
                *[&mut length, &mut velocity, &mut pressure, &mut air_mass][disturbed] += sign * size;
                State { length, velocity, pressure: AbsolutePressure(pressure), air_mass }
            };
            let runs = [1.0, -1.0].map(|sign| simulate(&rig, start(sign), 0.05, 1e-12).expect("a run"));
            let apart = |time: f64| -> Vec<f64> {
                let [plus, minus] = runs.each_ref().map(|run| numbers(&linear, run, time));
                plus.iter().zip(&minus).map(|(plus, minus)| 0.5 * (plus - minus)).collect()
            };
            let (begun, ended) = (apart(0.0), apart(0.05));
            let mut state = [0.0; 5];
            state[..begun.len()].copy_from_slice(&begun);
            let a = &linear.system.a;
            let rates = |state: [f64; 5]| -> [f64; 5] {
                std::array::from_fn(|i| a.get(i).map_or(0.0, |row| row.iter().zip(state).map(|(a, x)| a * x).sum()))
            };
            for _ in 0..20_000 {
                state = runge_kutta(state, 0.05 / 20_000.0, |_, state| rates(state));
            }
            for (place, signal) in linear.system.states.iter().enumerate() {
                let size = match signal.name.as_str() {
                    "load_velocity" => 1e-4,
                    "pressure" => 20.0,
                    "air_mass" => 1e-10,
                    _ => 1e-6,
                };
                assert_within(state[place], ended[place], 2e-3 * size);
            }
        }
    }
}

#[test]
fn a_loose_tendon_has_no_linear_model() {
    let paper = Paper::sealed().isometric(3.5 * INCH);
    let balance = Balance::AtBoth(GaugePressure(0.0), 3.5 * INCH);
    let error = linearize(&on_tendon(&paper, STIFFNESS), balance, Content::Temperature(ROOM)).expect_err("loose");
    assert!(error.to_string().contains("carries nothing"), "{error}");
}
