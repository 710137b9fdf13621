//! The exergy of a whole circuit: filling in closed form, the sum, and what an effectiveness does in a closed cycle.

use crate::common::accounts::{Audited, Circuit};
use crate::common::{ATMOSPHERE, INCH, LB, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::air::Process;
use mckibben::force::Effectiveness;
use mckibben::load::{Load, Motion};
use mckibben::valve::{Command, Request};

const GAS_CONSTANT: f64 = 286.99;
const HEAT_CAPACITY: f64 = 3.5 * GAS_CONSTANT;

/// A muscle held at one length that fills from the atmosphere's pressure; its volume, end pressure and audit.
fn fill(process: Process, duration: f64) -> (f64, f64, Circuit) {
    let paper = Paper::driven(Command::Constant(Request::Fill)).isometric(3.5 * INCH).process(process);
    let run = paper.run(duration, 1e-10);
    let end = run.at(duration);
    (end.volume, end.pressure.0, run.circuit())
}

#[test]
fn an_isothermal_filling_has_its_closed_form() {
    // Half-way, and when the pressure of the supply has been reached.
    for duration in [0.012, 0.3] {
        let (volume, pressure, audit) = fill(Process::Isothermal, duration);
        let supply = 100.0 * PSI + ATMOSPHERE;
        let ratio = |a: f64, b: f64| (a / b).ln();
        // With T = T_0, dm = V dP/(R T_0).
        let drawn = volume * (pressure - ATMOSPHERE) * ratio(supply, ATMOSPHERE);
        let stored = volume * (pressure * ratio(pressure, ATMOSPHERE) - pressure + ATMOSPHERE);
        let integral = |p: f64| p * ratio(supply, p) + p;
        let throttled = volume * (integral(pressure) - integral(ATMOSPHERE));
        assert!(drawn > 1.0 && throttled > 0.1 * drawn);
        assert_close(audit.total.drawn, drawn, 1e-8);
        assert_close(audit.total.least_work, drawn, 1e-8);
        assert_close(audit.total.stored, stored, 1e-8);
        assert_close(audit.total.throttled, throttled, 1e-7);
        for none in [audit.total.mixed, audit.total.heat_loss, audit.total.exhaust, audit.total.gas_work] {
            assert_within(none, 0.0, 1e-9 * drawn);
        }
        // The heat leaves at T_0, worth nothing: what came in as flow work went out as heat.
        assert_close(audit.total.heat, -volume * (pressure - ATMOSPHERE), 1e-8);
        assert_within(audit.exergy.residual, 0.0, 1e-7 * drawn);
    }
}

#[test]
fn the_papers_filling_makes_energy() {
    let (volume, pressure, audit) = fill(Process::Isentropic, 0.3);
    // The contents stay on P (V/m)^γ, so m = m_0 (P/P_0)^(1/γ); the first law of the filled volume has the rest.
    let start = ATMOSPHERE * volume / (GAS_CONSTANT * ROOM);
    let gain = start * ((pressure / ATMOSPHERE).powf(1.0 / 1.4) - 1.0);
    let made = volume * (pressure - ATMOSPHERE) / 0.4 - HEAT_CAPACITY * ROOM * gain;
    assert!(made > 0.0);
    assert_close(audit.total.heat, made, 1e-7);
    assert!(audit.total.heat_loss < 0.0, "warm air from nowhere is worth something: {audit:?}");
    assert_within(audit.exergy.residual, 0.0, 1e-7 * audit.exergy.turnover);
    // The energy balance without heat makes none, and what it destroys in addition to the throttle is due to mixing.
    let adiabatic = Process::EnergyBalance { heat_transfer: 0.0, wall_temperature: ROOM };
    let (.., adiabatic) = fill(adiabatic, 0.3);
    assert_within(adiabatic.total.heat, 0.0, 1e-9 * adiabatic.total.drawn);
    assert!(adiabatic.total.mixed > 0.01 * adiabatic.total.drawn && adiabatic.total.throttled > 0.0);
    assert_within(adiabatic.exergy.residual, 0.0, 1e-7 * adiabatic.exergy.turnover);
}

#[test]
fn the_sum_closes_while_a_valve_lifts_a_load() {
    let balance = Process::EnergyBalance { heat_transfer: 0.5, wall_temperature: 300.0 };
    for process in [Process::Isothermal, Process::Isentropic, Process::Polytropic { index: 1.2 }, balance] {
        for effectiveness in [1.0, 0.85] {
            let paper = Paper::pwm(25.0, 0.5)
                .mass(5.0 * LB)
                .process(process)
                .with(|rig| rig.effectiveness = Effectiveness::Constant(effectiveness));
            let residual = |tolerance: f64| {
                let audit = paper.run(0.5, tolerance).circuit();
                assert!(audit.total.exhaust > 0.0 && audit.total.throttled > 0.0 && audit.total.mixed >= 0.0);
                let (whole, compressor) =
                    (audit.total.efficiency().unwrap(), audit.total.work / audit.total.least_work);
                assert!((0.0..0.5).contains(&whole), "{process:?}: {whole}");
                // Warm air that goes back into the supply is worth more than its pressure, which the compressor counts.
                assert_close(whole, compressor, if process == Process::Isothermal { 1e-12 } else { 0.02 });
                audit.exergy.residual.abs() / audit.exergy.turnover
            };
            for tolerance in [1e-6, 1e-9] {
                let residual = residual(tolerance);
                assert!(residual <= 100.0 * tolerance, "{process:?}, Eff {effectiveness}: {residual:e}");
            }
        }
    }
}

#[test]
fn a_sealed_actuator_draws_nothing() {
    let total = Paper::sealed().mass(5.0 * LB).run(0.1, 1e-6).circuit().total;
    assert_eq!((total.drawn, total.least_work, total.efficiency()), (0.0, 0.0, None));
}

/// The example of `docs/energy.md`: a rectangle in gauge pressure and length.
#[test]
fn an_effectiveness_takes_from_a_cycle_and_gives_to_its_reverse() {
    let (low, high, short, long) = (20.0 * PSI, 80.0 * PSI, 3.4 * INCH, 3.85 * INCH);
    let work = |effectiveness: f64, gauges: [f64; 2]| {
        let paper = Paper::sealed().with(|rig| rig.effectiveness = Effectiveness::Constant(effectiveness));
        let actuator = paper.actuator();
        // Two legs at constant pressure; the other two have no motion. Simpson's rule is exact for (3), of degree 2.
        let force = |length: f64, gauge: f64| actuator.static_force(length, gauge + ATMOSPHERE);
        let leg = |gauge: f64| {
            let ends = force(short, gauge) + force(long, gauge);
            (long - short) / 6.0 * (ends + 4.0 * force(0.5 * (short + long), gauge))
        };
        leg(gauges[0]) - leg(gauges[1])
    };
    let (b, n) = (4.3218 * INCH, 2.5);
    let volume = |l: f64| l * (b * b - l * l) / (4.0 * std::f64::consts::PI * n * n);
    let gas = (high - low) * (volume(short) - volume(long));
    // Shortening at high pressure, lengthening at low: a motor. It gives nine tenths of what the gas does.
    assert_close(work(1.0, [high, low]), gas, 1e-12);
    assert_close(work(0.9, [high, low]), 0.9 * gas, 1e-12);
    // The reverse is a pump: it takes nine tenths of what the gas receives, and the rest comes from nowhere.
    assert_close(work(0.9, [low, high]), -0.9 * gas, 1e-12);
    assert_within(0.1 * gas, 0.0808, 5e-5);
}

#[test]
fn the_audit_of_a_driven_motion_shows_what_the_effectiveness_takes() {
    let paper = Paper::pwm(2.0, 0.5).process(Process::Isothermal).with(|rig| {
        rig.effectiveness = Effectiveness::Constant(0.9);
        let motion = Motion::sinusoid(3.6 * INCH, 0.15 * INCH, 2.0, 0.0, rig.thread_length).expect("a motion");
        rig.load = Load::Prescribed(motion);
    });
    let audit = paper.run(2.0, 1e-8).circuit();
    assert!(audit.total.gas_work.abs() > 0.1);
    assert_close(audit.total.effectiveness_loss, 0.1 * audit.total.gas_work, 1e-9);
    assert_within(audit.exergy.residual, 0.0, 1e-6 * audit.exergy.turnover);
}
