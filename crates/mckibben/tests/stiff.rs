//! Small volumes behind a large valve: the pressure settles in microseconds, and the steps do not follow it down.

use crate::common::{ATMOSPHERE, Paper, ROOM, assert_close, assert_within};
use mckibben::air::Process;
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{InitialLength, simulate};
use mckibben::valve::{Command, Request};

const PROCESSES: [Process; 4] = [
    Process::Isentropic,
    Process::Isothermal,
    Process::Polytropic { index: 1.2 },
    Process::EnergyBalance { heat_transfer: 0.05, wall_temperature: ROOM },
];

/// A muscle of a few cubic millimetres: `scale` of the paper's in every length.
fn tiny(scale: f64, external_volume: f64, command: Command) -> Paper {
    Paper::driven(command).with(|rig| {
        rig.thread_length *= scale;
        rig.max_length *= scale;
        rig.external_volume = external_volume;
    })
}

fn worst_difference(run: &RigTrajectory, reference: &RigTrajectory) -> (f64, f64) {
    run.samples(1e-3).zip(reference.samples(1e-3)).fold((0.0, 0.0), |(length, pressure), (a, b)| {
        assert_eq!(a.time, b.time);
        let dp = (a.pressure.0 / b.pressure.0 - 1.0).abs();
        (f64::max(length, (a.length - b.length).abs()), f64::max(pressure, dp))
    })
}

#[test]
fn a_small_chamber_with_an_open_flow_path_costs_little_and_is_right() {
    for process in PROCESSES {
        for external in [1e-8, 1e-7] {
            for request in [Request::Fill, Request::Exhaust] {
                // Volume 1e-8 to 1e-7 m³ in all: the muscle itself has less than the hose.
                let paper = tiny(0.1, external, Command::Constant(request)).process(process).isometric(8.5e-3);
                let run = paper.run(1.0, 1e-7);
                let counts = run.statistics();
                assert!(counts.evaluations < 4000, "{process:?}, {external} m³, {request:?}: {counts:?}");
                let tight = paper.run(1.0, 1e-11);
                // Errors of some steps at 1e-7 each, and what the settled state forgets of them.
                let (_, pressure) = worst_difference(&run, &tight);
                assert!(pressure < 1e-5, "{process:?}, {external} m³, {request:?}: pressure off by {pressure:e}");
                let end = if request == Request::Fill { paper.supply_gauge + ATMOSPHERE } else { ATMOSPHERE };
                assert_close(run.at(1.0).pressure.0, end, 1e-5);
            }
        }
    }
}

#[test]
fn a_breathing_muscle_at_equal_pressure_costs_little_and_is_right() {
    // The load swings on the paper's muscle while the flow path stays open and the chamber is near the port's pressure.
    for process in PROCESSES {
        for external in [1e-8, 1e-7, 3e-6] {
            let paper = Paper::driven(Command::Constant(Request::Exhaust))
                .process(process)
                .gauge(1e5)
                .with(|rig| (rig.external_volume, rig.length) = (external, InitialLength::At(0.09)));
            let run = paper.run(1.0, 1e-7);
            let counts = run.statistics();
            // The load bounces off the taut braid and the tendon's slack, and each swing passes the borders of the flow: the cost
            // is by the event.
            let allowed = 2000 + 150 * counts.events;
            assert!(counts.evaluations < allowed, "{process:?}, {external} m³: {counts:?}");
            let tight = paper.run(1.0, 1e-11);
            let (length, pressure) = worst_difference(&run, &tight);
            assert!(length < 1e-6 && pressure < 1e-4, "{process:?}, {external} m³: {length:e} m, {pressure:e}");
        }
    }
}

#[test]
fn pulses_into_a_small_chamber_cost_little_and_are_right() {
    for process in PROCESSES {
        let command = Command::pwm(25.0, 0.5, Request::Fill, Request::Exhaust).expect("a command");
        let paper = tiny(0.2, 1e-8, command).process(process).isometric(1.7e-2);
        let run = paper.run(1.0, 1e-7);
        let counts = run.statistics();
        // Fifty edges a second, each with a phase of choked, subsonic and settled flow.
        assert!(counts.evaluations < 50_000, "{process:?}: {counts:?}");
        let (_, pressure) = worst_difference(&run, &paper.run(1.0, 1e-11));
        assert!(pressure < 1e-5, "{process:?}: pressure off by {pressure:e}");
    }
}

#[test]
fn the_implicit_method_takes_over_where_the_pressure_is_settled() {
    let paper = tiny(0.1, 1e-8, Command::Constant(Request::Exhaust)).isometric(8.5e-3).gauge(1e4);
    let (rig, start) = (paper.rig(), paper.start());
    let run = simulate(&rig, start, 10.0, 1e-8).expect("the run reaches its end");
    assert!(run.statistics().implicit_steps > 0, "{:?}", run.statistics());
    assert!(run.statistics().evaluations < 4000, "{:?}", run.statistics());
    // Steps grow far beyond the time of settling.
    let mut longest = 0.0_f64;
    run.replay(&mut |step| {
        longest = longest.max(step.end() - step.start());
        Ok(())
    })
    .expect("a run that is kept");
    assert!(longest > 0.1, "the longest step is {longest} s");
    assert_within(run.at(10.0).pressure.0, ATMOSPHERE, 1e-2);
}

#[test]
fn the_settling_follows_its_exponential() {
    // On the straight line near equal pressure, isothermal at the atmosphere's temperature and with the outflow's
    // temperature constant: dP/dt = −(R T/V) G ψ_lam/(1 − r_lam) (P − P_atm)/√T, an exponential.
    let paper =
        tiny(0.1, 1e-8, Command::Constant(Request::Exhaust)).process(Process::Isothermal).isometric(8.5e-3).gauge(60.0);
    let volume: f64 = paper.actuator().volume(8.5e-3);
    let law = paper.flow_law();
    let line = law.ratio_function::<f64>(0.9995) / 0.0005;
    let rate = paper.gas_constant * ROOM.sqrt() * law.conductance() * line / volume;
    let run = paper.run(40.0 / rate, 1e-10);
    for step in 0..20 {
        let time = f64::from(step) / rate;
        let excess = run.at(time).pressure.0 - ATMOSPHERE;
        // An excess e of P moves r by e − e²: good to 6e-4 of the first order, so compare with 1e-10 of P and with that.
        assert_within(excess, 60.0 * (-rate * time).exp(), 60.0 * 1e-9 + 1e-10 * ATMOSPHERE);
    }
}
