//! The modular actuator: (12) transcribed, derivatives against finite differences, both stiffnesses.

use crate::common;
use common::{ATMOSPHERE, Paper, assert_close, assert_within, between, slope};
use mckibben::air::Process;
use mckibben::force::Effectiveness;
use mckibben::valve::Ports;
use mckibben::{AbsolutePressure, ActuatorState, GaugePressure};
use std::f64::consts::PI;

const SHUT: Ports = Ports::CLOSED;
const SUPPLY: Ports = Ports { supply: true, exhaust: false };
const EXHAUST: Ports = Ports { supply: false, exhaust: true };
const BOTH: Ports = Ports { supply: true, exhaust: true };

/// One way the ends and the air may stand.
#[derive(Clone, Copy, Debug)]
struct Stand {
    length: f64,
    velocity: f64,
    pressure: f64,
    mass: f64,
}

/// Free, slack and taut, both directions, vacuum to high pressure; never within 1e-4 m or m/s of a corner.
fn stands() -> impl Iterator<Item = Stand> {
    (0..600).filter_map(|row| {
        let length = between(row, 0, 0.055, 0.0988);
        let velocity = between(row, 1, -1.0, 1.0);
        let pressure = between(row, 2, 0.4, 8.0) * ATMOSPHERE;
        let mass = between(row, 3, 1e-5, 1e-4);
        let corners = [4.3218 * common::INCH / 3.0_f64.sqrt(), 3.85 * common::INCH];
        let rebound = 1.75e5 * (length - corners[1]) + 100.0 * velocity;
        let clear = corners.iter().all(|corner| (length - corner).abs() > 1e-4)
            && velocity.abs() > 1e-2
            && (pressure - ATMOSPHERE).abs() > 1e3
            && rebound.abs() > 1.0;
        clear.then_some(Stand { length, velocity, pressure, mass })
    })
}

fn state(stand: &Stand) -> ActuatorState {
    ActuatorState::new(AbsolutePressure(stand.pressure), stand.mass, stand.length)
}

fn table() -> Effectiveness {
    Effectiveness::table(&[0.0, 1e5, 3e5, 6e5], &[0.5, 0.8, 0.86, 0.9]).expect("a table")
}

fn papers() -> [Paper; 3] {
    let balance = Process::EnergyBalance { heat_transfer: 0.1, wall_temperature: 300.0 };
    [
        Paper::pwm(25.0, 0.5),
        Paper::pwm(25.0, 0.5).process(balance).with(|rig| rig.effectiveness = table()),
        Paper::pwm(25.0, 0.5).process(Process::Polytropic { index: 1.15 }).friction(0.0, 0.0),
    ]
}

/// (12)(13)(14) in powers, with two bounds that the paper leaves out: no push of the taut braid, no push of the tendon.
fn equation_12(paper: &Paper, stand: &Stand) -> f64 {
    let (b, n) = (paper.thread_length, paper.turns);
    let (shortest, longest) = (b / 3.0_f64.sqrt(), paper.max_length);
    let (l, v, gauge) = (stand.length, stand.velocity, stand.pressure - ATMOSPHERE);
    if l < shortest {
        return 0.0;
    }
    let ratio: f64 = paper.effectiveness.at(GaugePressure(gauge));
    let force = |l: f64| gauge * b.powi(2) / (4.0 * PI * n.powi(2)) * (3.0 * l.powi(2) / b.powi(2) - 1.0) * ratio;
    let k = ((force(l) - force(shortest)) / (l - shortest)).max(0.0);
    let limit =
        if l > longest { (paper.limit_stiffness * (l - longest) + paper.limit_damping * v).max(0.0) } else { 0.0 };
    (force(l) + limit + paper.viscous * v + paper.coulomb_width * k * v.signum()).max(0.0)
}

#[test]
fn the_tension_is_equation_12() {
    let mut kinds = [0; 3];
    for paper in papers() {
        let actuator = paper.actuator();
        for stand in stands() {
            let expected = equation_12(&paper, &stand);
            let response = actuator.respond(&state(&stand), stand.length, stand.velocity, SHUT);
            // Terms of up to some hundred newton, each a few roundings; (13) loses a thousand near L_min.
            assert_within(response.tension, expected, 1e-11);
            kinds[usize::from(stand.length > 0.0634) + usize::from(stand.length > paper.max_length)] += 1;
        }
    }
    assert!(kinds.iter().all(|count| *count > 20), "slack, free, taut: {kinds:?}");
}

#[test]
fn the_derivatives_of_the_tension_are_its_differences() {
    for paper in papers() {
        let actuator = paper.actuator();
        for stand in stands() {
            let Stand { length, velocity, pressure, .. } = stand;
            let tension =
                |dl: f64, dv: f64, dp: f64| -> f64 { actuator.tension(length + dl, velocity + dv, pressure + dp) };
            // Some states lie within a difference of where the tendon would push: there is a kink.
            if (1..=2).any(|k| tension(1e-6 * f64::from(k), 0.0, 0.0) == 0.0) != (tension(-2e-6, 0.0, 0.0) == 0.0) {
                continue;
            }
            let response = actuator.respond(&state(&stand), length, velocity, SHUT);
            // F is piecewise cubic in L, linear in v, and near enough cubic in P over 100 Pa: the five-point rule has only
            // the rounding of F, 1e-13 N, over the step.
            assert_within(response.per_length, slope(1e-6, |h| tension(h, 0.0, 0.0)), 1e-6 * 1.75e5);
            assert_within(response.per_velocity, slope(1e-4, |h| tension(0.0, h, 0.0)), 1e-8);
            assert_within(response.per_pressure, slope(50.0, |h| tension(0.0, 0.0, h)), 1e-13);
        }
    }
}

#[test]
fn the_rates_of_a_sealed_actuator_are_those_of_its_adiabat() {
    for paper in papers() {
        let actuator = paper.actuator();
        for stand in stands() {
            let response = actuator.respond(&state(&stand), stand.length, stand.velocity, SHUT);
            assert_eq!(response.mass_flow, 0.0);
            let volume = |h: f64| -> f64 { actuator.volume(stand.length + stand.velocity * h) };
            let kappa = actuator.air().index();
            // P = P₀ (V₀/V)^κ along the motion; the heat of the wall comes on top.
            let along = slope(1e-5, |h| stand.pressure * (volume(0.0) / volume(h)).powf(kappa));
            let temperature = stand.pressure * volume(0.0) / (stand.mass * paper.gas_constant);
            let heat = match paper.process {
                Process::EnergyBalance { heat_transfer, wall_temperature } => {
                    (paper.heat_capacity_ratio - 1.0) * heat_transfer * (wall_temperature - temperature) / volume(0.0)
                }
                _ => 0.0,
            };
            // Rounding of P over the step: 1e-10 Pa over 1e-5 s.
            assert_within(response.pressure_rate, along + heat, 1e-3 + 1e-9 * heat.abs());
            assert_close(response.temperature, temperature, 1e-15);
            assert_close(response.volume, volume(0.0), 1e-15);
        }
    }
}

#[test]
fn the_rates_through_the_valve_are_equations_19_and_21() {
    let paper = Paper::pwm(25.0, 0.5);
    let actuator = paper.actuator();
    let supply = paper.supply_gauge + ATMOSPHERE;
    let flow = |inside: f64, beyond: f64, kelvin: f64| {
        let (up, down, upstream, sign) = if inside < beyond {
            (beyond, inside, paper.supply_temperature, 1.0)
        } else {
            (inside, beyond, kelvin, -1.0)
        };
        let (g, r) = (1.4_f64, down / up);
        let choked = (2.0 / (g + 1.0)).powf(g / (g - 1.0));
        let kept = r.max(choked).min(paper.laminar_ratio);
        let line = ((1.0 - r) / (1.0 - paper.laminar_ratio)).min(1.0);
        let powers = kept.powf(2.0 / g) - kept.powf((g + 1.0) / g);
        let c_m = line * (2.0 * g / (paper.gas_constant * (g - 1.0)) * powers).sqrt();
        sign * paper.efficiency * 1.8e-5 * 0.3048_f64.powi(2) * up * c_m / upstream.sqrt()
    };
    for stand in stands() {
        let volume: f64 = actuator.volume(stand.length);
        let kelvin = stand.pressure * volume / (stand.mass * paper.gas_constant);
        let slack = stand.length < actuator.limits().min_length();
        let (b, n) = (paper.thread_length, paper.turns);
        let rate = if slack {
            0.0
        } else {
            (b.powi(2) - 3.0 * stand.length.powi(2)) / (4.0 * PI * n.powi(2)) * stand.velocity
        };
        let (a, c) = (flow(stand.pressure, supply, kelvin), flow(stand.pressure, ATMOSPHERE, kelvin));
        for (ports, expected) in [(SUPPLY, a), (EXHAUST, c), (BOTH, a + c)] {
            let response = actuator.respond(&state(&stand), stand.length, stand.velocity, ports);
            // On the straight line 1 − r and the powers of (23) lose a thousand roundings.
            let size = a.abs().max(c.abs());
            assert_within(response.mass_flow, expected, 1e-12 * size);
            let literal = 1.4 * stand.pressure * (expected / stand.mass - rate / volume);
            let terms = 1.4 * stand.pressure * (size / stand.mass + (rate / volume).abs());
            assert_within(response.pressure_rate, literal, 1e-12 * terms);
        }
    }
}

#[test]
fn the_stiffness_at_constant_pressure_is_equation_7() {
    let paper = Paper::sealed();
    let actuator = paper.actuator();
    for (length, gauge) in [(0.07, 1e5), (0.085, 4e5), (0.097, 6e5)] {
        let stiffness = actuator.stiffness(length, AbsolutePressure(ATMOSPHERE + gauge));
        assert_close(stiffness, 3.0 * gauge * length / (2.0 * PI * paper.turns.powi(2)), 1e-14);
    }
}

#[test]
fn the_stiffness_by_the_force_is_equation_8() {
    let paper = Paper::sealed();
    let actuator = paper.actuator();
    for (length, gauge) in [(0.07, 1e5), (0.085, 4e5), (0.097, 6e5)] {
        let force: f64 = actuator.static_force(length, ATMOSPHERE + gauge);
        let stiffness = actuator.stiffness(length, AbsolutePressure(ATMOSPHERE + gauge));
        assert_close(stiffness, 6.0 * force / (3.0 * length - paper.thread_length.powi(2) / length), 1e-13);
    }
}

#[test]
fn the_sealed_stiffness_is_the_slope_along_the_adiabat() {
    // (5) with its first term, for each process and with an effectiveness that follows the pressure.
    let cases = [(Process::Isentropic, 1.4), (Process::Isothermal, 1.0), (Process::Polytropic { index: 1.2 }, 1.2)];
    for (process, kappa) in cases {
        for effectiveness in [Effectiveness::Constant(1.0), table()] {
            let paper = Paper::sealed().process(process).with(|rig| rig.effectiveness = effectiveness);
            let actuator = paper.actuator();
            for (length, gauge) in [(0.07, 1.5e5), (0.085, 4e5), (0.097, 5.5e5)] {
                let pressure = ATMOSPHERE + gauge;
                let volume = |h: f64| -> f64 { actuator.volume(length + h) };
                let sealed = actuator.sealed_stiffness(length, AbsolutePressure(pressure));
                let along = slope(1e-5, |h| {
                    actuator.static_force(length + h, pressure * (volume(0.0) / volume(h)).powf(kappa))
                });
                // Rounding of F over the step: 1e-14 N over 1e-5 m of some thousand N/m.
                assert_close(sealed, along, 1e-9);
                if effectiveness == Effectiveness::Constant(1.0) {
                    let (b, n) = (paper.thread_length, paper.turns);
                    let slope = (b * b - 3.0 * length * length) / (4.0 * PI * n * n);
                    let literal =
                        3.0 * gauge * length / (2.0 * PI * n * n) + kappa * pressure * slope * slope / volume(0.0);
                    assert_close(sealed, literal, 1e-13);
                }
                // A sealed muscle is the stiffer one: (6) leaves that out.
                assert!(sealed > actuator.stiffness(length, AbsolutePressure(pressure)));
            }
        }
    }
}

#[test]
fn equation_6_is_good_when_the_external_volume_is_large() {
    let excess = |external: f64| {
        let actuator = Paper::sealed().with(|rig| rig.external_volume = external).actuator();
        let pressure = AbsolutePressure(ATMOSPHERE + 4e5);
        actuator.sealed_stiffness(0.085, pressure) / actuator.stiffness(0.085, pressure) - 1.0
    };
    assert!(excess(3e-6) > 0.1, "a hose of 3 mL: {}", excess(3e-6));
    // The first term of (5) falls as one over the volume.
    assert_close(excess(1.0) / excess(10.0), 10.0, 1e-4);
    assert!(excess(1.0) < 1e-5);
}

#[test]
fn an_actuator_without_valve_or_volume() {
    let sealed = Paper::sealed().actuator();
    let stand = Stand { length: 0.08, velocity: 0.2, pressure: 3e5, mass: 1e-5 };
    let shut = sealed.respond(&state(&stand), stand.length, stand.velocity, SHUT);
    assert_eq!(sealed.respond(&state(&stand), stand.length, stand.velocity, BOTH), shut);
    let paper = Paper::sealed();
    let law = paper.actuator().law().clone();
    let limits = *paper.actuator().limits();
    let friction = *paper.actuator().friction();
    let refused = mckibben::Actuator::new(law, limits, friction, 0.0, paper.air());
    assert!(matches!(refused, Err(mckibben::Error::OutOfRange { .. })), "{refused:?}");
}
