//! The air: blow-down and filling in closed form, the invariant of the polytropic processes, what is in and what is out.

use crate::common::{ATMOSPHERE, Paper, ROOM, assert_close, assert_within};
use mckibben::air::{Air, Chamber, Flow, Process};
use mckibben::plant::RigTrajectory;
use mckibben::valve::{Command, ExhaustTemperature, Request};
use mckibben::{AbsolutePressure, Error};
use proptest::prelude::*;

const LENGTH: f64 = 0.085;

/// `η A_p C_q C_m` of choked flow, (21)(23) literally, in kg·√K/(s·Pa).
fn choked(paper: &Paper) -> f64 {
    let (gamma, r) = (paper.heat_capacity_ratio, paper.gas_constant);
    let power = (2.0 / (gamma + 1.0)).powf((gamma + 1.0) / (gamma - 1.0));
    paper.efficiency * 1.8e-5 * 0.3048 * 0.3048 * (gamma / r * power).sqrt()
}

fn volume(paper: &Paper) -> f64 {
    paper.actuator().volume(LENGTH)
}

fn exhausting() -> Paper {
    Paper::driven(Command::Constant(Request::Exhaust)).gauge(7e5).isometric(LENGTH)
}

/// Fills from the start: without delays the poppet stands at the supply at t = 0.
fn filling() -> Paper {
    Paper::driven(Command::Constant(Request::Fill)).with(|rig| rig.delays = (0.0, 0.0)).isometric(LENGTH)
}

#[test]
fn an_isentropic_choked_blow_down_follows_its_closed_form() {
    // T ∝ P^((γ−1)/γ), so d(1/√T)/dt is constant: P = P₀ (1 + (γ−1)/2 · K t)^(−2γ/(γ−1)), K = G R √T₀/V.
    let paper = exhausting().with(|rig| rig.temperature = 310.0);
    let rate = choked(&paper) * paper.gas_constant * 310.0_f64.sqrt() / volume(&paper);
    let run = paper.run(0.01, 1e-11);
    let start = 7e5 + ATMOSPHERE;
    for sample in run.samples(5e-4) {
        let growth = 1.0 + 0.2 * rate * sample.time;
        let expected = start * growth.powf(-7.0);
        assert!(expected > ATMOSPHERE / 0.52, "no longer choked at {} s", sample.time);
        // Some ten steps of 1e-11 each.
        assert_close(sample.pressure.0, expected, 1e-10);
        assert_close(sample.temperature, 310.0 / growth.powi(2), 1e-10);
        assert_close(sample.air_mass, run.at(0.0).air_mass * growth.powf(-5.0), 1e-10);
    }
}

#[test]
fn an_isothermal_blow_down_at_ambient_temperature_is_exponential() {
    // dm/dt = −G P/√T = −(G R √T/V) m: with T constant an exponential.
    for exhaust in [ExhaustTemperature::Actuator, ExhaustTemperature::Ambient] {
        let paper = exhausting().process(Process::Isothermal).with(|rig| rig.exhaust_temperature = exhaust);
        let rate = choked(&paper) * paper.gas_constant * ROOM.sqrt() / volume(&paper);
        for sample in paper.run(0.01, 1e-11).samples(1e-3) {
            assert_close(sample.pressure.0, (7e5 + ATMOSPHERE) * (-rate * sample.time).exp(), 1e-10);
        }
    }
}

#[test]
fn choked_filling_is_linear_in_time() {
    // Isothermal: dP/dt = R T ṁ/V with the chamber's T. Energy balance: γ R T_in ṁ/V with the supply's.
    let balance = Process::EnergyBalance { heat_transfer: 0.0, wall_temperature: ROOM };
    for (process, factor) in [(Process::Isothermal, 280.0), (balance, 1.4 * 320.0)] {
        let paper = filling().process(process).with(|rig| (rig.temperature, rig.supply_temperature) = (280.0, 320.0));
        let supply = paper.supply_gauge + ATMOSPHERE;
        let flow = choked(&paper) * supply / 320.0_f64.sqrt();
        let slope = paper.gas_constant * factor * flow / volume(&paper);
        let run = paper.run(4e-3, 1e-11);
        for sample in run.samples(5e-4) {
            let expected = ATMOSPHERE + slope * sample.time;
            assert!(expected < 0.52 * supply, "no longer choked at {} s", sample.time);
            assert_close(sample.pressure.0, expected, 1e-12);
            assert_close(sample.mass_flow, flow, 1e-13);
        }
    }
}

#[test]
fn heat_from_the_wall_decays_exponentially_in_a_sealed_chamber() {
    // dT/dt = hA (T_wall − T)/(m c_v), c_v = R/(γ − 1).
    let process = Process::EnergyBalance { heat_transfer: 0.02, wall_temperature: 290.0 };
    let paper = Paper::sealed().process(process).gauge(3e5).isometric(LENGTH).with(|rig| rig.temperature = 350.0);
    let run = paper.run(1.0, 1e-11);
    let rate = 0.02 * 0.4 / (paper.gas_constant * run.at(0.0).air_mass);
    for sample in run.samples(0.1) {
        assert_within(sample.temperature, 290.0 + 60.0 * (-rate * sample.time).exp(), 1e-8);
        // Nothing flows: constant but for the rounding of the weights of the dense output.
        assert_close(sample.air_mass, run.at(0.0).air_mass, 4.0 * f64::EPSILON);
    }
}

#[test]
fn charging_ends_at_the_temperatures_of_the_model() {
    // A fixed volume from 1.013 to 7.9 bar.
    let ratio = 7.9e5_f64 / 1.013e5;
    let cases = [
        // Invariant P (V/m)^γ: m ∝ P^(1/γ).
        (Process::Isentropic, ratio.powf(1.0 / 1.4), 527.0, 4.34),
        // First law: P V/(γ−1) rises by c_p T_in Δm.
        (Process::EnergyBalance { heat_transfer: 0.0, wall_temperature: ROOM }, 1.0 + (ratio - 1.0) / 1.4, 390.0, 5.86),
    ];
    for (process, times, kelvin, stated) in cases {
        let paper = filling().process(process).gauge(1.013e5 - ATMOSPHERE);
        let run = paper.with(|rig| rig.supply_gauge = 7.9e5 - ATMOSPHERE).run(0.5, 1e-10);
        let (first, last) = (run.at(0.0), run.at(0.5));
        assert_close(last.pressure.0, 7.9e5, 1e-8);
        assert_close(last.air_mass / first.air_mass, times, 1e-8);
        assert_close(last.temperature, ROOM * ratio / times, 1e-8);
        // The words: near 527 K with 4.34 times, near 390 K with 5.86 times.
        assert_within(last.temperature, kelvin, 0.5);
        assert_within(last.air_mass / first.air_mass, stated, 0.005);
    }
}

fn invariant(run: &RigTrajectory, index: f64) -> Vec<f64> {
    run.samples(1e-3).map(|s| s.pressure.0 * (s.volume / s.air_mass).powf(index)).collect()
}

#[test]
fn the_invariant_is_kept_over_pulses() {
    let cases = [(Process::Isentropic, 1.4), (Process::Isothermal, 1.0), (Process::Polytropic { index: 1.2 }, 1.2)];
    for (process, index) in cases {
        let run = Paper::pwm(25.0, 0.5).process(process).run(1.0, 1e-11);
        let values = invariant(&run, index);
        let worst = values.iter().map(|value| (value / values[0] - 1.0).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-9, "{process:?}: the invariant drifts by {worst:e}");
        // The motion did change the volume and the valve the mass.
        let (low, high) = run
            .samples(1e-3)
            .fold((f64::MAX, 0.0_f64), |(low, high), sample| (low.min(sample.air_mass), high.max(sample.air_mass)));
        assert!(high > 3.0 * low, "air from {low} to {high} kg");
    }
}

#[test]
fn what_came_in_is_inside_or_went_out() {
    for process in [Process::Isentropic, Process::EnergyBalance { heat_transfer: 0.05, wall_temperature: ROOM }] {
        let run = Paper::pwm(25.0, 0.5).process(process).run(1.0, 1e-10);
        let (mut inward, mut outward) = (0.0, 0.0);
        run.quadrature(|weight, sample, _| {
            let flow = weight * sample.mass_flow;
            if sample.ports.supply { inward += flow } else { outward -= flow }
        });
        let stored = run.at(1.0).air_mass - run.at(0.0).air_mass;
        assert!(inward > 10.0 * run.at(0.0).air_mass && outward > 10.0 * run.at(0.0).air_mass);
        assert_within(inward, stored + outward, 1e-9 * inward);
    }
}

#[test]
fn the_first_law_holds_over_pulses() {
    // d(P V/(γ−1)) = c_p (T_in dm_in − T dm_out) + hA (T_wall − T) dt − P dV, integrated over the samples.
    let (transfer, wall) = (0.05, 280.0);
    let process = Process::EnergyBalance { heat_transfer: transfer, wall_temperature: wall };
    let paper = Paper::pwm(25.0, 0.5).process(process);
    let run = paper.run(0.5, 1e-10);
    let (b, n) = (paper.thread_length, paper.turns);
    let c_p = 1.4 / 0.4 * paper.gas_constant;
    let (mut gain, mut size) = (0.0, 0.0);
    run.quadrature(|weight, s, _| {
        let length = s.length.max(b / 3.0_f64.sqrt());
        let slack = s.length < b / 3.0_f64.sqrt();
        let slope = (b * b - 3.0 * length * length) / (4.0 * std::f64::consts::PI * n * n);
        let upstream = if s.mass_flow > 0.0 { ROOM } else { s.temperature };
        let enthalpy = c_p * upstream * s.mass_flow;
        let work = if slack { 0.0 } else { s.pressure.0 * slope * s.velocity };
        gain += weight * (enthalpy + transfer * (wall - s.temperature) - work);
        size += weight * enthalpy.abs();
    });
    let energy = |time: f64| run.at(time).pressure.0 * run.at(time).volume / 0.4;
    assert_within(gain, energy(0.5) - energy(0.0), 1e-9 * size);
}

fn chamber() -> impl Strategy<Value = (Chamber, Flow)> {
    (1e3..1e6_f64, 1e-7..1e-3_f64, 1e-7..1e-3_f64, -1e-4..1e-4_f64, 0.0..1e-2_f64, 0.0..1e-2_f64).prop_map(
        |(pressure, mass, volume, volume_rate, inward, outward)| {
            (Chamber::new(pressure, mass, volume, volume_rate), Flow { inward, outward })
        },
    )
}

proptest! {
    #[test]
    fn the_rates_are_the_table_of_the_model((chamber, flow) in chamber(), t_in in 200.0..500.0_f64) {
        let Chamber { pressure: p, mass: m, volume: v, volume_rate: dv, .. } = chamber;
        let (r, gamma, ha, wall) = (286.99, 1.4, 0.3, 300.0);
        let relative = (flow.inward - flow.outward) / m - dv / v;
        let size = (flow.inward + flow.outward) / m + dv.abs() / v;
        let rate = |process| Air::standard(process).expect("air").pressure_rate(&chamber, &flow, t_in);
        for (process, index) in
            [(Process::Isentropic, gamma), (Process::Isothermal, 1.0), (Process::Polytropic { index: 1.27 }, 1.27)]
        {
            prop_assert!((rate(process) - index * p * relative).abs() <= 1e-14 * index * p * size);
        }
        let t = p * v / (m * r);
        let terms = [gamma * r * t_in * flow.inward, -gamma * r * t * flow.outward, -gamma * p * dv,
            (gamma - 1.0) * ha * (wall - t)];
        let balance = Process::EnergyBalance { heat_transfer: ha, wall_temperature: wall };
        let size: f64 = terms.iter().map(|term| term.abs()).sum::<f64>() + (gamma - 1.0) * ha * (wall + t);
        prop_assert!((rate(balance) - terms.iter().sum::<f64>() / v).abs() <= 1e-14 * size / v);
        let air = Air::standard(Process::Isothermal).expect("air");
        prop_assert!((air.temperature(&chamber) / t - 1.0).abs() < 1e-15);
        prop_assert!((air.mass(AbsolutePressure(p), v, t) / m - 1.0).abs() < 1e-14);
    }
}

#[test]
fn air_outside_physics_is_refused() {
    let key = |result: Result<Air, Error>| match result {
        Err(Error::OutOfRange { parameter, .. }) => parameter.key,
        other => panic!("{other:?}"),
    };
    let air = |r, gamma, atmosphere| Air::new(r, gamma, AbsolutePressure(atmosphere), Process::Isentropic);
    assert_eq!(key(air(0.0, 1.4, 1e5)), "air.gas_constant");
    assert_eq!(key(air(287.0, 1.0, 1e5)), "air.heat_capacity_ratio");
    assert_eq!(key(air(287.0, 1.4, 0.0)), "air.atmospheric_pressure");
    assert_eq!(key(Air::standard(Process::Polytropic { index: 0.0 })), "air.polytropic_index");
    let balance = |heat_transfer, wall_temperature| {
        key(Air::standard(Process::EnergyBalance { heat_transfer, wall_temperature }))
    };
    assert_eq!(balance(-1.0, 300.0), "air.heat_transfer");
    assert_eq!(balance(1.0, f64::NAN), "air.wall_temperature");
}
