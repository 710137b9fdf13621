//! The fixed-step engine: its orders with edges, reversals, limits of the length and the port's pressure inside steps, its
//! stability, true sticking, and its agreement with the event-located engine.

use crate::common::steps::RigSteps;
use crate::common::{PSI, Paper};
use mckibben::air::Process;
use mckibben::load::{Load, Motion};
use mckibben::plant::{PlantReference, RigPlant};
use mckibben::simulation::{InitialLength, Method, Rig, SampleTimes, State, simulate};
use mckibben::valve::{Command, Request, ValveKind};

/// A rig whose flow is choked throughout, so that the rates are smooth between edges: a big volume between a strong
/// supply and the atmosphere, moving between its limits.
fn smooth(coulomb_width: f64) -> Paper {
    Paper::pwm(20.0, 0.5).gauge(45.0 * PSI).friction(3.5, coulomb_width).with(|rig| {
        rig.external_volume = 1e-3;
        rig.supply_gauge = 250.0 * PSI;
        rig.delays = (4.3e-3, 1.1e-3);
    })
}

fn end_of(rig: &Rig, start: State, method: Method, step: f64, duration: f64) -> State {
    let mut stepper = RigSteps::new(rig, start, method);
    let steps = (duration / step).round() as u32;
    for index in 1..=steps {
        stepper.advance_to(duration * f64::from(index) / f64::from(steps)).expect("a step");
    }
    stepper.state()
}

/// Largest difference of two states, each in units of its usual size.
fn difference(a: State, b: State) -> f64 {
    let parts = [
        (a.length - b.length) / 0.1,
        a.velocity - b.velocity,
        (a.pressure.0 - b.pressure.0) / 1e5,
        (a.air_mass - b.air_mass) / 1e-4,
    ];
    parts.into_iter().fold(0.0, |most: f64, part| most.max(part.abs()))
}

/// The order fitted to errors at halved steps: the slope of a straight line in the logarithms.
fn fitted_order(errors: &[f64]) -> f64 {
    let count = errors.len() as f64;
    let mean = (count - 1.0) / 2.0;
    let (mut over, mut under) = (0.0, 0.0);
    for (index, error) in errors.iter().enumerate() {
        let x = index as f64 - mean;
        over -= x * error.log2();
        under += x * x;
    }
    over / under
}

fn order(paper: &Paper, method: Method, steps: &[f64], duration: f64) -> f64 {
    let (rig, start) = (paper.rig(), paper.start());
    let exact = simulate(&rig, start, duration, 1e-13).expect("a trajectory");
    let last = exact.at(duration);
    let exact =
        State { length: last.length, velocity: last.velocity, pressure: last.pressure, air_mass: last.air_mass };
    let errors: Vec<f64> =
        steps.iter().map(|&step| difference(end_of(&rig, start, method, step, duration), exact)).collect();
    assert!(errors.iter().all(|error| *error > 1e-13), "errors have reached rounding: {errors:?}");
    fitted_order(&errors)
}

#[test]
fn rk4_is_of_order_four_with_edges_inside_its_steps() {
    let order = order(&smooth(0.0), Method::Rk4, &[4e-3, 2e-3, 1e-3, 0.5e-3], 0.3);
    assert!((order - 4.0).abs() < 0.1, "fitted order {order}");
}

#[test]
fn the_stable_method_is_of_order_two_with_edges_inside_its_steps() {
    let order = order(&smooth(0.0), Method::Stable, &[1e-3, 0.5e-3, 0.25e-3, 0.125e-3], 0.3);
    assert!((order - 2.0).abs() < 0.1, "fitted order {order}");
}

#[test]
fn rk4_keeps_its_order_through_reversals_with_coulomb_friction() {
    // Where the velocity turns is found on the method's own step: plain RK4 would fall to order 1 at the jump of friction.
    let order = order(&smooth(1.1e-4), Method::Rk4, &[4e-3, 2e-3, 1e-3, 0.5e-3], 0.3);
    assert!((order - 4.0).abs() < 0.1, "fitted order {order}");
}

/// The order of the largest error of the four states between a step and half of it.
fn order_at(paper: &Paper, method: Method, step: f64, duration: f64) -> f64 {
    let of = RigPlant::new(&paper.rig());
    let start = of.start(&paper.start());
    let reference = PlantReference::new((of.plant(), &start), &Vec::new, duration, 1e-12).expect("a run");
    let error = |step| reference.errors(method, step).expect("steps").into_iter().fold(0.0, f64::max);
    let [coarse, fine] = [step, 0.5 * step].map(error);
    (coarse / fine).log2()
}

#[test]
fn both_methods_keep_their_order_where_the_braid_comes_taut_and_the_tendon_tight() {
    // The taut braid's damping, and viscous friction where the tendon falls tight, begin with a jump: a step across it
    // would be of order 1.
    let heavy = Paper::sealed().mass(4.5).gauge(1e5).from(0.085, 0.0);
    let light = Paper::sealed().mass(0.5).gauge(1e4).friction(3.5, 0.0).from(0.060, 0.5);
    for (paper, name) in [(heavy, "a fall onto the taut braid"), (light, "a tendon that falls tight and then taut")] {
        let orders = [order_at(&paper, Method::Rk4, 2e-4, 0.3), order_at(&paper, Method::Stable, 2e-5, 0.3)];
        assert!(orders[0] > 3.5 && orders[1] > 1.8, "{name}: orders {orders:?}");
    }
}

#[test]
fn the_stable_method_keeps_its_order_where_the_volume_carries_the_pressure_across_the_supplys() {
    // The muscle is filled to the supply's pressure and moved to and fro with the supply open. Only the flow settles at the
    // port: a secant of the whole rate would be endless where the gap is nil and the rate is not.
    let paper = Paper::driven(Command::Constant(Request::Fill)).gauge(99.0 * PSI).with(|rig| {
        let motion = Motion::sinusoid(0.08, 5e-3, 10.0, 0.0, rig.thread_length).expect("a motion");
        (rig.load, rig.length) = (Load::Prescribed(motion), InitialLength::Equilibrium);
        rig.laminar_ratio = 0.95;
        rig.delays = (0.0, 0.0);
    });
    let order = order_at(&paper, Method::Stable, 2e-4, 0.2);
    assert!(order > 1.8, "order {order}");
}

/// Air behind a shut valve comes back to its pressure with every cycle of the length, P ∝ V^−κ. Where the fall of pressure was taken
/// implicitly as the volume grew, and not as it shrank, each cycle left a part of its error: 0.3 % in these ten seconds of steps of 5 ms.
#[test]
fn the_stable_method_keeps_the_air_behind_a_shut_valve() {
    let paper = Paper::driven(Command::Constant(Request::Hold)).gauge(2e5).with(|rig| {
        let motion = Motion::sinusoid(0.087, 7e-3, 4.0, 0.0, rig.thread_length).expect("a motion");
        (rig.load, rig.length) = (Load::Prescribed(motion), InitialLength::Equilibrium);
        rig.kind = ValveKind::FillHoldExhaust;
    });
    let drift = |step: f64| {
        let (rig, start) = (paper.rig(), paper.start());
        let mut stepper = RigSteps::new(&rig, start, Method::Stable);
        for (time, _) in SampleTimes::new(10.0, 0.25).steps(step) {
            stepper.advance_to(time).expect("a step");
        }
        (stepper.state().pressure.0 / start.pressure.0 - 1.0).abs()
    };
    let drifts = [drift(5e-3), drift(1e-3)];
    assert!(drifts[0] < 1.2e-3 && drifts[1] < 1.2e-5, "{drifts:?}");
}

#[test]
fn the_stable_method_bears_heat_at_the_ports_pressure() {
    // From the port's own pressure heat moves the air off at once: a gap of nil, and a rate that is not.
    for (heat_transfer, wall_temperature) in [(0.1, 293.15), (0.1, 320.0), (10.0, 280.0), (0.0, 293.15)] {
        for length in [0.07, 0.08, 0.085, 0.0897, 0.095] {
            let process = Process::EnergyBalance { heat_transfer, wall_temperature };
            let paper = Paper::pwm(25.0, 0.5).isometric(length).process(process);
            let (rig, start) = (paper.rig(), paper.start());
            let mut stepper = RigSteps::new(&rig, start, Method::Stable);
            for index in 1..=100 {
                stepper.advance_to(1e-3 * f64::from(index)).unwrap_or_else(|error| panic!("{length}: {error}"));
            }
        }
    }
}

#[test]
fn the_stable_method_holds_a_small_chamber_near_equal_pressure_at_any_step() {
    // Near equal pressure this chamber settles in 0.1 ms, ten to fifty times faster than these steps.
    for process in [
        Process::Isentropic,
        Process::Isothermal,
        Process::EnergyBalance { heat_transfer: 0.1, wall_temperature: 293.15 },
    ] {
        for step in [1e-3, 2e-3, 5e-3] {
            let paper = Paper::pwm(5.0, 0.5).isometric(0.08).process(process).with(|rig| rig.external_volume = 0.5e-6);
            let (rig, start) = (paper.rig(), paper.start());
            let (low, high) = (start.pressure.0, start.pressure.0 + paper.supply_gauge);
            let mut stepper = RigSteps::new(&rig, start, Method::Stable);
            let mut index = 0;
            while stepper.time() < 1.0 {
                index += 1;
                stepper.advance_to(step * f64::from(index)).expect("a step");
                let pressure = stepper.state().pressure.0;
                assert!(
                    pressure > 0.99 * low && pressure < 1.01 * high,
                    "{process:?}, step {step}: {pressure} Pa at {} s",
                    stepper.time()
                );
            }
            // At 0.18 s the valve has been shut to the exhaust for long: the pressure is the supply's.
            let mut stepper = RigSteps::new(&rig, start, Method::Stable);
            for index in 1..=(0.1 / step).round() as u32 {
                stepper.advance_to(step * f64::from(index)).expect("a step");
            }
            let gap = stepper.state().pressure.0 / high - 1.0;
            assert!(gap.abs() < 1e-3, "{process:?}, step {step}: {gap} from the supply");
        }
    }
}

#[test]
fn a_ring_down_ends_in_true_sticking() {
    let paper = Paper::sealed().gauge(60.0 * PSI).friction(3.5, 4e-4).from(0.088, 0.0);
    let (rig, start) = (paper.rig(), paper.start());
    for method in [Method::Rk4, Method::Stable] {
        let step = if method == Method::Rk4 { 1e-3 } else { 1e-4 };
        let end = end_of(&rig, start, method, step, 3.0);
        assert_eq!(end.velocity, 0.0, "{method:?}");
        let exact = simulate(&rig, start, 3.0, 1e-10).expect("a trajectory");
        let last = exact.at(3.0);
        assert_eq!(last.velocity, 0.0);
        // Friction remembers where it caught the mass: an error of the last reversal stays, of the order of the method.
        let allowed = if method == Method::Rk4 { 1e-9 } else { 5e-7 };
        assert!((end.length - last.length).abs() < allowed, "{method:?}: {} and {}", end.length, last.length);
    }
}

#[test]
fn both_engines_agree_on_the_papers_pwm_run() {
    let paper = Paper::pwm(25.0, 0.5);
    let (rig, start) = (paper.rig(), paper.start());
    let exact = simulate(&rig, start, 1.0, 1e-10).expect("a trajectory");
    for (method, step, allowed) in [(Method::Rk4, 2e-5, 2e-5), (Method::Stable, 2e-5, 2e-4)] {
        let mut stepper = RigSteps::new(&rig, start, method);
        for index in 1..=(1.0 / step) as u32 {
            stepper.advance_to(step * f64::from(index)).expect("a step");
            if index % 100 == 0 {
                let (ours, theirs) = (stepper.sample(), exact.at(stepper.time()));
                assert_eq!(ours.ports, theirs.ports);
                let distance = (ours.length - theirs.length).abs() / 0.05;
                assert!(distance < allowed, "{method:?} at {} s: {distance}", stepper.time());
            }
        }
    }
}
