//! The linear model of a joint: closed forms of its entries, finite differences of simulated trajectories, the model without
//! air masses, the point for a stiffness, and what has none.

use crate::common::joint::Pair;
use crate::common::{ATMOSPHERE, GRAVITY, PSI, Paper, ROOM, assert_close, assert_within, slope};
use mckibben::GaugePressure;
use mckibben::control::Held;
use mckibben::linearize::{JointBalance, JointLinearization, StateSpace, linearize_driven_joint, linearize_joint};
use mckibben::load::{MomentArm, Tendon};
use mckibben::plant::{JointPlant, PlantAir};
use mckibben::simulation::{JointRig, JointState};
use mckibben::valve::{Command, FlowStandard, Request};
use std::f64::consts::PI;

/// Two unlike actuators, sealed, with arms that change and a limb that hangs askew.
fn uneven() -> Pair {
    Pair::of(Paper::sealed().friction(2.0, 0.0)).with(|pair| {
        pair.papers[0].gauge = 45.0 * PSI;
        pair.papers[1].gauge = 30.0 * PSI;
        pair.papers[1].external_volume = 9e-6;
        pair.limb.distance = 0.05;
        pair.limb.hanging_angle = 0.4;
        pair.damping = 1e-3;
        let arm = |arms: [f64; 2]| MomentArm::table(&[-0.6, 0.6], &arms).expect("a table");
        pair.tendons = [[0.012, 0.017], [0.016, 0.013]].map(|arms| Tendon { arm: arm(arms), rest_length: 0.082 });
    })
}

fn linear(pair: &Pair) -> JointLinearization {
    let gauge = [0, 1].map(|i| GaugePressure(pair.papers[i].gauge));
    linearize_joint(&pair.rig().expect("a rig"), JointBalance::AtPressures(gauge), [ROOM; 2]).expect("a model")
}

/// Symmetric, isentropic, on pulleys: every entry of the motion by hand.
#[test]
fn a_symmetric_pair_has_its_entries_in_closed_form() {
    let gauge = 40.0 * PSI;
    let pair = Pair::of(Paper::sealed().friction(3.0, 0.0).gauge(gauge)).with(|pair| {
        pair.limb.distance = 0.1;
        pair.damping = 4e-3;
    });
    let system = linear(&pair).system;
    let paper = &pair.papers[0];
    let (b, n, l, r) = (paper.thread_length, paper.turns, 0.082, 0.015);
    let turns = 4.0 * PI * n * n;
    let inertia = 1e-3 + 0.3 * 0.01;
    let area = (3.0 * l * l - b * b) / turns;
    let volume = l * (b * b - l * l) / turns + paper.external_volume;
    let stiffness = 2.0 * r * r * 6.0 * gauge * l / turns + 0.3 * GRAVITY * 0.1;
    assert_close(system.a[1][0], -stiffness / inertia, 1e-10);
    assert_close(system.a[1][1], -(4e-3 + 2.0 * r * r * 3.0) / inertia, 1e-10);
    assert_close(system.a[1][2], r * area / inertia, 1e-10);
    assert_close(system.a[1][4], -r * area / inertia, 1e-10);
    // (19): the volume falls by the area for each metre of lengthening, and the agonist shortens.
    let per_turn = paper.heat_capacity_ratio * (gauge + ATMOSPHERE) * area * r / volume;
    assert_close(system.a[2][1], -per_turn, 1e-10);
    assert_close(system.a[4][1], per_turn, 1e-10);
    let mass = (gauge + ATMOSPHERE) * volume / (paper.gas_constant * ROOM);
    assert_close(system.b[1][2], 1.0 / inertia, 1e-12);
    assert_eq!((system.b[3][0], system.b[5][1], system.b[5][0]), (1.0, 1.0, 0.0));
    // The torque of both on the joint, without its own damping and weight.
    let torque = system.output("actuator_torque").expect("an output");
    assert_close(system.c[torque][0], -2.0 * r * r * 6.0 * gauge * l / turns, 1e-10);
    assert!(mass > 0.0 && system.b[2][0] > 0.0);
}

/// The pair under PWM on three-way valves with delays, both fast.
fn pulsed(duties: [f64; 2], frequency: f64) -> Pair {
    uneven().with(|pair| {
        for (paper, duty) in pair.papers.iter_mut().zip(duties) {
            paper.command = Some(Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("a command"));
            paper.delays = (0.2e-3, 0.1e-3);
            paper.standard = FlowStandard::Orifice { flow_area: 1e-6 };
        }
    })
}

fn start(pair: &Pair, rig: &JointRig) -> JointState {
    rig.start(&pair.initial()).expect("a start")
}

fn averaged(pair: &Pair) -> JointLinearization {
    let rig = pair.rig().expect("a rig");
    linearize_driven_joint(&rig, &start(pair, &rig), &PlantAir::Temperatures(vec![ROOM; 2])).expect("a model")
}

/// `−A⁻¹ B` of one input: how far the balance moves. `A x = −b` by elimination.
fn moves(system: &StateSpace, input: usize) -> Vec<f64> {
    let n = system.a.len();
    let mut rows: Vec<Vec<f64>> =
        (0..n).map(|row| system.a[row].iter().copied().chain([-system.b[row][input]]).collect()).collect();
    for column in 0..n {
        let pivot = (column..n).max_by(|a, b| rows[*a][column].abs().total_cmp(&rows[*b][column].abs())).expect("rows");
        rows.swap(column, pivot);
        for row in (0..n).filter(|row| *row != column) {
            let factor = rows[row][column] / rows[column][column];
            for place in column..=n {
                rows[row][place] -= factor * rows[column][place];
            }
        }
    }
    (0..n).map(|row| rows[row][n] / rows[row][row]).collect()
}

#[test]
fn a_duty_moves_the_balance_of_the_mean_flows() {
    let duties = [0.5, 0.35];
    let linear = averaged(&pulsed(duties, 400.0));
    let (model, state) = (linear.minimal(), linear.state);
    assert_eq!(
        model.inputs.iter().map(|input| input.name.as_str()).collect::<Vec<_>>()[..2],
        ["agonist_duty", "antagonist_duty"]
    );
    for input in 0..2 {
        let found = moves(&model, input);
        // The air keeps `P (V/m)^κ` from one balance to the next, as in the model.
        let at = |by: f64| {
            let mut duties = duties;
            duties[input] += by;
            let rig = pulsed(duties, 400.0).rig().expect("a rig");
            linearize_driven_joint(&rig, &state, &PlantAir::Start).expect("a model").state
        };
        assert_close(found[0], slope(1e-4, |by| at(by).angle), 1e-4);
        for i in 0..2 {
            let expected = slope(1e-4, |by| at(by).pressure[i].0);
            assert_within(found[2 + i], expected, 1e-4 * model_pressure(&found));
        }
    }
    // The agonist's pulses turn the joint its way.
    assert!(moves(&model, 0)[0] > 0.0 && moves(&model, 1)[0] < 0.0);
}

fn model_pressure(found: &[f64]) -> f64 {
    found[2].abs().max(found[3].abs())
}

#[test]
fn simulated_pulses_swing_about_the_balance_of_the_mean_flows() {
    let pair = pulsed([0.5, 0.35], 400.0);
    let model = averaged(&pair);
    let [first, second] = model.averages() else { panic!("{:?}", model.averages()) };
    assert!(first.follows() && second.follows() && first.ripple_is_small() && second.ripple_is_small());
    let run = JointPlant::new(&model.rig).and_then(|joint| joint.simulate(&model.state, 0.5, 1e-9)).expect("runs");
    // The mean over the last periods.
    let samples: Vec<_> = (0..4000).map(|n| run.at(0.4 + 0.1 * f64::from(n) / 4000.0)).collect();
    for i in 0..2 {
        let mean = samples.iter().map(|sample| sample.actuators[i].pressure.0).sum::<f64>() / 4000.0;
        let ripple = [first, second][i].pressure_ripple;
        assert_within(mean, model.state.pressure[i].0, 0.1 * ripple);
    }
    let mean = samples.iter().map(|sample| sample.angle).sum::<f64>() / 4000.0;
    let greatest = |by: f64| samples.iter().map(|sample| by * sample.angle).fold(f64::MIN, f64::max);
    assert_within(mean, model.state.angle, 0.01_f64.max(greatest(1.0) + greatest(-1.0)));
}

#[test]
fn only_pulses_on_both_are_averaged() {
    let pair = uneven();
    let rig = pair.rig().expect("a rig");
    let error = linearize_driven_joint(&rig, &start(&pair, &rig), &PlantAir::Start).expect_err("sealed");
    assert!(error.to_string().contains("no PWM"), "{error}");
}

/// `x(t)` of `dx/dt = A x` by small Runge-Kutta steps.
fn follow(system: &StateSpace, start: &[f64], duration: f64) -> Vec<f64> {
    let steps = 4000;
    let h = duration / f64::from(steps);
    let rate =
        |x: &[f64]| -> Vec<f64> { system.a.iter().map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect() };
    let ahead = |x: &[f64], h: f64, k: &[f64]| -> Vec<f64> { x.iter().zip(k).map(|(x, k)| x + h * k).collect() };
    (0..steps).fold(start.to_vec(), |x, _| {
        let k1 = rate(&x);
        let k2 = rate(&ahead(&x, h / 2.0, &k1));
        let k3 = rate(&ahead(&x, h / 2.0, &k2));
        let k4 = rate(&ahead(&x, h, &k3));
        (0..x.len()).map(|n| x[n] + h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n])).collect()
    })
}

fn numbers(state: JointState) -> [f64; 6] {
    let [first, second] = state.pressure.map(|pressure| pressure.0);
    [state.angle, state.angular_velocity, first, state.air_mass[0], second, state.air_mass[1]]
}

#[test]
fn it_is_the_difference_of_two_simulated_trajectories() {
    let pair = uneven();
    let model = linear(&pair);
    let sizes = [1e-5, 1e-3, 2.0, 1e-11, 2.0, 1e-11];
    for disturbed in 0..6 {
        let run = |sign: f64| {
            let mut start = model.state;
            match disturbed {
                0 => start.angle += sign * sizes[0],
                1 => start.angular_velocity += sign * sizes[1],
                2 | 4 => start.pressure[(disturbed - 2) / 2].0 += sign * sizes[disturbed],
                _ => start.air_mass[(disturbed - 3) / 2] += sign * sizes[disturbed],
            }
            let run = JointPlant::new(&model.rig).and_then(|joint| joint.simulate(&start, 0.1, 1e-12)).expect("runs");
            numbers(run.at(0.1).state())
        };
        let (plus, minus) = (run(1.0), run(-1.0));
        let mut start = [0.0; 6];
        start[disturbed] = 2.0 * sizes[disturbed];
        let expected = follow(&model.system, &start, 0.1);
        for n in 0..6 {
            // A pressure or a mass moves the others by many times its own size.
            let scale = sizes[n] * (1.0 + expected.iter().zip(&sizes).map(|(x, s)| (x / s).abs()).fold(0.0, f64::max));
            assert_within(plus[n] - minus[n], expected[n], 2e-4 * scale);
        }
    }
}

#[test]
fn without_air_masses_it_moves_as_with_them() {
    let model = linear(&uneven());
    let minimal = model.minimal();
    assert_eq!(minimal.states.len(), 4);
    // A start that keeps `P (V/m)^κ` of both: motion alone.
    let whole = follow(&model.system, &[1e-3, 0.02, 0.0, 0.0, 0.0, 0.0], 0.2);
    let few = follow(&minimal, &[1e-3, 0.02, 0.0, 0.0], 0.2);
    // The air masses at the start are those of pressure and angle in the small model, in the whole one unchanged: the paper's
    // process does not depend on them, so the motion is the same.
    for (n, m) in [(0, 0), (1, 1), (2, 2), (4, 3)] {
        assert_within(whole[n], few[m], 1e-9 * whole[n].abs().max(1e-6));
    }
}

#[test]
fn a_stiffness_has_its_point() {
    let pair = uneven();
    let rig = pair.rig().expect("a rig");
    let there = linear(&pair);
    let requested = 1.3 * rig.stiffness(there.state.angle, there.state.pressure, Held::Pressures);
    let angle = there.state.angle + 0.05;
    let model =
        linearize_joint(&rig, JointBalance::AtStiffness { angle, stiffness: requested }, [ROOM; 2]).expect("a model");
    assert_within(model.state.angle, angle, 1e-9);
    assert_close(rig.stiffness(model.state.angle, model.state.pressure, Held::Pressures), requested, 1e-8);
    // Against the joint's inertia the model has that stiffness and the weight's.
    let swing = 0.3 * GRAVITY * 0.05 * (angle - 0.4).cos();
    let inertia = 1e-3 + 0.3 * 0.05 * 0.05;
    assert_close(model.system.a[1][0], -(requested + swing) / inertia, 1e-7);
    assert!(model.coulomb_bounds() == [0.0; 2]);
}

#[test]
fn a_point_with_a_corner_is_refused() {
    let pair = Pair::of(Paper::sealed().gauge(60.0 * PSI)).with(|pair| {
        pair.papers.iter_mut().for_each(|paper| paper.min_length = Some(0.078));
        pair.torque = -0.1;
    });
    let rig = pair.rig().expect("a rig");
    let gauge = [GaugePressure(60.0 * PSI), GaugePressure(0.0)];
    let error = linearize_joint(&rig, JointBalance::AtPressures(gauge), [ROOM; 2]).expect_err("refused").to_string();
    assert!(error.contains("slack or at its shortest"), "{error}");
    let soft = JointBalance::AtStiffness { angle: 0.0, stiffness: 1e-6 };
    let error = linearize_joint(&rig, soft, [ROOM; 2]).expect_err("refused").to_string();
    assert!(error.contains("stiffness"), "{error}");
}
