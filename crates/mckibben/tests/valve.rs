//! The valve's flow path: (21)(23) transcribed, ISO 6358, continuity, both directions.

use crate::common::{ATMOSPHERE, INCH, LB, LBF, Paper, ROOM, assert_close, assert_within, slope};
use mckibben::air::{Air, Chamber, Process};
use mckibben::valve::{ExhaustTemperature, FlowLaw, FlowStandard, FlowZone, Port, Supply, flow_parameter};
use mckibben::{AbsolutePressure, Dual, Error, GaugePressure};

const GAMMAS: [f64; 6] = [1.05, 1.1, 1.3, 1.4, 5.0 / 3.0, 2.0];
const AREA: f64 = 1.7e-6;
const R: f64 = 286.99;

fn air(gamma: f64) -> Air {
    Air::new(R, gamma, AbsolutePressure(ATMOSPHERE), Process::Isentropic).expect("a gas")
}

/// Ten millilitres of the paper's air at a pressure and a temperature.
fn air_at(pressure: f64, kelvin: f64) -> Chamber {
    Chamber::new(pressure, pressure * 1e-5 / (R * kelvin), 1e-5, 0.0)
}

fn orifice(gamma: f64, laminar_ratio: f64) -> FlowLaw {
    FlowLaw::new(FlowStandard::Orifice { flow_area: AREA }, 0.85, laminar_ratio, &air(gamma)).expect("a law")
}

/// `r_c`, where the two formulas of (23) meet.
fn critical(gamma: f64) -> f64 {
    (2.0 / (gamma + 1.0)).powf(gamma / (gamma - 1.0))
}

/// (23) in powers.
fn c_m(gamma: f64, r: f64) -> f64 {
    if r <= critical(gamma) {
        (gamma / R * (2.0 / (gamma + 1.0)).powf((gamma + 1.0) / (gamma - 1.0))).sqrt()
    } else {
        (2.0 * gamma / (R * (gamma - 1.0)) * (r.powf(2.0 / gamma) - r.powf((gamma + 1.0) / gamma))).sqrt()
    }
}

#[test]
fn the_orifice_is_equation_23() {
    for gamma in GAMMAS {
        let law = orifice(gamma, 0.9999);
        assert_close(law.critical_ratio(), critical(gamma), 1e-14);
        for step in 0..=995 {
            let r = f64::from(step) / 1000.0;
            let literal = 0.85 * AREA * c_m(gamma, r);
            let got = law.conductance() * law.ratio_function::<f64>(r);
            // The literal form itself cancels: its two powers differ by about (γ−1)/γ (1 − r), which costs that many
            // roundings. Below r = 0.9 and for γ ≥ 1.3 it is good to 1e-13.
            let own = f64::EPSILON * gamma / (gamma - 1.0) / (1.0 - r);
            assert_close(got, literal, 5e-15 + 2.0 * own);
            if r < 0.9 && gamma >= 1.3 {
                assert_close(got, literal, 1e-13);
            }
        }
    }
}

/// The documented literal form is the transcription, and the law that runs evaluate is the literal form to 1e-13 where
/// that does not cancel.
#[test]
fn the_fast_form_is_the_literal_form_of_equation_23() {
    for gamma in GAMMAS {
        let law = orifice(gamma, 0.9999);
        for step in 0..=999 {
            let r = f64::from(step) / 1000.0;
            let literal = flow_parameter(gamma, R, r);
            // Powers differ by roundings, which cancelling enlarges as above.
            let own = f64::EPSILON * gamma / (gamma - 1.0) / (1.0 - r);
            assert_close(literal, c_m(gamma, r), 4e-15 + 2.0 * own);
            assert_close(law.conductance() * law.ratio_function::<f64>(r), 0.85 * AREA * literal, 5e-15 + 2.0 * own);
        }
        assert_eq!(flow_parameter(gamma, R, 1.0), 0.0);
    }
    // 0.04042 s·√K/m for choked air.
    assert_within(flow_parameter(1.4, R, 0.0), 0.04042, 5e-6);
}

#[test]
fn choked_air_flows_by_the_constant_of_the_model() {
    let law = orifice(1.4, 0.999);
    // 0.04042 s·√K/m, and r_c = 0.52828.
    assert_within(law.conductance() / (0.85 * AREA), 0.04042, 5e-6);
    assert_within(law.critical_ratio(), 0.52828, 5e-6);
    for r in [0.0, 0.2, 0.5, 0.528] {
        // A polynomial at its end times a root: a few roundings.
        assert_within(law.ratio_function(r), 1.0, 2e-15);
    }
}

#[test]
fn the_papers_own_units_give_the_same_flow() {
    // (21)(23) in lbm, ft, °R: in those the flow needs the root of g_c = 32.174 lbm·ft/(lbf·s²).
    let (gamma, r_imperial, area): (f64, f64, f64) = (1.4, 53.34, 1.8e-5);
    let g_c = 9.80665 / 0.3048;
    let choked = (gamma / r_imperial * (2.0 / (gamma + 1.0)).powf((gamma + 1.0) / (gamma - 1.0)) * g_c).sqrt();
    let (psia, rankine) = (114.7, 1.8 * ROOM);
    let pounds_a_second = 0.85 * area * (psia * 144.0) * choked / rankine.sqrt();
    let law = Paper::sealed().flow_law();
    let flow = law.conductance() * psia * LBF / (INCH * INCH) / ROOM.sqrt();
    // 53.34 ft·lbf/(lbm·°R) are 286.986 J/(kg·K), and 286.99 is what is used: half of 1.5e-5.
    assert_close(flow, pounds_a_second * LB, 8e-6);
}

#[test]
fn iso_6358_is_a_quarter_ellipse() {
    for b in [0.0_f64, 0.2, 0.3, 0.528, 0.9] {
        let standard = FlowStandard::Iso6358 { sonic_conductance: 5e-9, critical_ratio: b };
        let law = FlowLaw::new(standard, 0.9, 0.9999, &air(1.4)).expect("a law");
        assert_close(law.conductance(), 0.9 * 5e-9 * 1.185 * ROOM.sqrt(), 1e-15);
        for step in 0..=999 {
            let r = f64::from(step) / 1000.0;
            let ellipse = if r <= b { 1.0 } else { (1.0 - ((r - b) / (1.0 - b)).powi(2)).sqrt() };
            assert_close(law.ratio_function(r), ellipse, 5e-15 + 2.0 * f64::EPSILON / (1.0 - r));
        }
        // Choked flow of the standard: C ρ₀ P √(T₀/T).
        let choked = law.conductance() * 6e5 / 280.0_f64.sqrt();
        assert_close(choked, 0.9 * 5e-9 * 1.185 * 6e5 * (ROOM / 280.0).sqrt(), 1e-14);
    }
}

#[test]
fn the_law_is_continuous_at_both_of_its_corners() {
    for gamma in GAMMAS {
        let law = orifice(gamma, 0.999);
        let r_c = law.critical_ratio();
        let at = |r: f64| -> f64 { law.ratio_function(r) };
        for apart in [1e-15, 1e-12, 1e-9, 1e-6] {
            // ψ leaves 1 with slope zero: ψ″ is of order ten. For γ = 1.05 the powers amplify rounding tenfold.
            assert_within(at(r_c * (1.0 + apart)), 1.0, 5e-15 + 20.0 * apart * apart);
            // The slope at r_lam is that of the line, ψ/(1 − r) ≈ 40 to 60.
            assert_within(at(0.999 + apart), at(0.999), 100.0 * apart + 1e-15);
            assert_within(at(0.999 - apart), at(0.999), 100.0 * apart + 1e-15);
        }
        let beyond = law.ratio_function(Dual::<f64, 1>::variable(r_c * (1.0 + 1e-9), 0));
        assert_within(beyond.slope[0], 0.0, 1e-7);
        // Falls all the way down to zero, and in a straight line at the end.
        assert_eq!(at(1.0), 0.0);
        assert_close(at(0.9995), 0.5 * at(0.999), 1e-12);
        let mut before = 1.0 + 4e-16;
        for step in 0..=2000 {
            let r = r_c + (1.0 - r_c) * f64::from(step) / 2000.0;
            let now = at(r);
            assert!(now <= before + 4e-16, "γ = {gamma}: ψ rises to {now} at {r}");
            before = now;
        }
    }
}

#[test]
fn the_slope_of_the_law_is_its_derivative() {
    for gamma in GAMMAS {
        let law = orifice(gamma, 0.999);
        for r in [0.61, 0.7, 0.8, 0.9, 0.95] {
            let dual = law.ratio_function(Dual::<f64, 1>::variable(r, 0)).slope[0];
            // Differences of the literal form, which is good to 1e-14 there.
            let scale = law.conductance() / (0.85 * AREA);
            let numeric = slope(1e-3, |h| c_m(gamma, r + h)) / scale;
            assert_close(dual, numeric, 1e-7);
        }
    }
}

#[test]
fn zones_are_the_pieces_of_the_law_and_meet_at_their_bounds() {
    let valve = Paper::pwm(25.0, 0.5).valve();
    for port in [Port::Supply, Port::Exhaust] {
        let beyond = valve.port_pressure(port);
        for zone in FlowZone::RISING {
            let (low, high) = valve.law.bounds(zone, beyond);
            let (low, high) = (low.unwrap_or(0.01 * beyond), high.unwrap_or(4.0 * beyond));
            assert!(low < high);
            for share in [0.0, 0.1, 0.5, 0.9, 1.0] {
                let pressure: f64 = low + share * (high - low);
                let piece = valve.flow_in_zone(port, zone, &air_at(pressure, 280.0)).net();
                let whole = valve.flow(port, &air_at(pressure, 280.0)).net();
                // One rounding of the ratio against 1 − r ≥ 0, and the sign of zero.
                assert_within(piece, whole, 1e-13 * valve.law.conductance() * beyond);
                if share > 0.0 && share < 1.0 {
                    assert_eq!(valve.law.zone(beyond, pressure), zone);
                }
                assert_eq!(zone.is_inward(), piece > 0.0 || (piece == 0.0 && zone == FlowZone::LaminarIn));
            }
        }
        for pair in FlowZone::RISING.windows(2) {
            assert_eq!(valve.law.bounds(pair[0], beyond).1, valve.law.bounds(pair[1], beyond).0);
        }
    }
}

#[test]
fn flow_reverses_with_the_pressure_difference() {
    for temperature in [ExhaustTemperature::Actuator, ExhaustTemperature::Ambient] {
        let paper =
            Paper::pwm(25.0, 0.5).with(|rig| (rig.exhaust_temperature, rig.supply_temperature) = (temperature, 300.0));
        let valve = paper.valve();
        let literal = |up: f64, down: f64, kelvin: f64| {
            0.85 * 1.8e-5 * 0.3048 * 0.3048 * up * c_m(1.4, down / up) / kelvin.sqrt()
        };
        let kelvin_out = if temperature == ExhaustTemperature::Actuator { 250.0 } else { 300.0 };
        for port in [Port::Supply, Port::Exhaust] {
            let beyond = valve.port_pressure(port);
            for ratio in [0.1, 0.6, 0.9, 0.99] {
                let flow = valve.flow(port, &air_at(ratio * beyond, 250.0));
                assert_eq!(flow.outward, 0.0);
                assert_close(flow.inward, literal(beyond, ratio * beyond, 300.0), 1e-13);
                assert_eq!(flow.net(), flow.inward);
                let flow = valve.flow(port, &air_at(beyond / ratio, 250.0));
                assert_eq!(flow.inward, 0.0);
                assert_close(flow.outward, literal(beyond / ratio, beyond, kelvin_out), 1e-13);
                assert_eq!(flow.net(), -flow.outward);
            }
            assert_eq!(valve.flow(port, &air_at(beyond, 250.0)).net(), 0.0);
        }
    }
}

#[test]
fn a_vacuum_is_a_supply_too() {
    let air = air(1.4);
    let supply = Supply::new(GaugePressure(-0.9 * ATMOSPHERE), ROOM, &air).expect("a vacuum");
    assert_close(supply.pressure().0, 0.1 * ATMOSPHERE, 1e-15);
    let valve = Paper::pwm(25.0, 0.5).with(|rig| rig.supply_gauge = -0.9 * ATMOSPHERE).valve();
    assert!(valve.flow(Port::Supply, &air_at(ATMOSPHERE, ROOM)).net() < 0.0);
    let error = Supply::new(GaugePressure(-ATMOSPHERE), ROOM, &air).expect_err("less than nothing");
    assert!(matches!(error, Error::Inconsistent { .. }), "{error}");
    assert!(error.to_string().contains("supply.gauge_pressure"), "{error}");
}

#[test]
fn non_physical_flow_paths_are_refused() {
    let key = |standard, efficiency, laminar| match FlowLaw::new(standard, efficiency, laminar, &air(1.4)) {
        Err(Error::OutOfRange { parameter, .. } | Error::Inconsistent { parameter, .. }) => parameter.key,
        other => panic!("{other:?}"),
    };
    let hole = |flow_area| FlowStandard::Orifice { flow_area };
    let iso = |sonic_conductance, critical_ratio| FlowStandard::Iso6358 { sonic_conductance, critical_ratio };
    assert_eq!(key(hole(0.0), 1.0, 0.999), "valve.flow_area");
    assert_eq!(key(hole(1e-6), 0.0, 0.999), "valve.efficiency");
    assert_eq!(key(hole(1e-6), 1.0, 1.0), "valve.laminar_ratio");
    assert_eq!(key(hole(1e-6), 1.0, 0.5), "valve.laminar_ratio");
    assert_eq!(key(iso(-1.0, 0.3), 1.0, 0.999), "valve.sonic_conductance");
    assert_eq!(key(iso(1e-9, 1.0), 1.0, 0.999), "valve.critical_ratio");
    assert_eq!(key(iso(1e-9, 0.9995), 1.0, 0.999), "valve.laminar_ratio");
}
