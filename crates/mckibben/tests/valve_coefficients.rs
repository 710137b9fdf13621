//! Flow through valves stated by Kv or Cv, what manufacturers say of both, and a separate flow path for the exhaust.

use crate::common::{ATMOSPHERE, Paper, ROOM, assert_close, assert_within, slope};
use mckibben::air::{Air, Chamber, Process};
use mckibben::valve::{FlowLaw, FlowStandard, Port, Ports, REFERENCE_DENSITY};
use mckibben::{AbsolutePressure, ActuatorState, Dual, Error, Over, parameter};

/// Molar gas constant in J/(mol·K).
const MOLAR: f64 = 8.314_462_618;

fn air(gas_constant: f64, gamma: f64) -> Air {
    Air::new(gas_constant, gamma, AbsolutePressure(ATMOSPHERE), Process::Isentropic).expect("a gas")
}

fn law(standard: FlowStandard, air: &Air) -> FlowLaw {
    FlowLaw::new(standard, 1.0, 0.9999, air).expect("a law")
}

/// Mass flow in kg/s from upstream pressure (Pa), pressure ratio and upstream temperature (K).
fn mass_flow(law: &FlowLaw, upstream: f64, ratio: f64, kelvin: f64) -> f64 {
    law.conductance() * upstream / kelvin.sqrt() * law.ratio_function::<f64>(ratio)
}

/// IEC 60534-2-1 in its own units: kg/h from Kv in m³/h, pressure in bar and density in kg/m³, with its rounded N₆.
fn kilograms_an_hour(kv: f64, x: f64, gamma: f64, x_t: f64, bar: f64, density: f64) -> f64 {
    let limit = gamma / 1.4 * x_t;
    let x = x.min(limit);
    31.6 * kv * (1.0 - x / (3.0 * limit)) * (x * bar * density).sqrt()
}

#[test]
fn kv_is_iec_60534_in_its_own_units() {
    for (gas_constant, gamma) in [(286.99, 1.4), (2077.0, 5.0 / 3.0), (188.9, 1.29)] {
        for x_t in [0.3, 0.55, 0.7] {
            let standard = FlowStandard::Kv { kv: 0.05 / 3600.0, pressure_drop_ratio: x_t };
            let law = law(standard, &air(gas_constant, gamma));
            assert_close(law.critical_ratio(), 1.0 - gamma / 1.4 * x_t, 1e-14);
            for step in 0..=995 {
                let r = f64::from(step) / 1000.0;
                let literal = kilograms_an_hour(0.05, 1.0 - r, gamma, x_t, 7.0, 7e5 / (gas_constant * 300.0));
                // 31.6 is √999.1 to its three digits: 31.6085.
                assert_close(3600.0 * mass_flow(&law, 7e5, r, 300.0), literal, 3e-4);
            }
        }
    }
}

#[test]
fn a_law_over_dual_numbers_has_the_derivatives_of_iso_6358() {
    let (c, b, r) = (6e-9, 0.3, 0.8_f64);
    let plain = law(FlowStandard::Iso6358 { sonic_conductance: c, critical_ratio: b }, &air(286.99, 1.4));
    let of = plain.map(|row, value| match row.key {
        key if key == parameter::SONIC_CONDUCTANCE.key => Dual::<f64, 2>::variable(value, 0),
        key if key == parameter::CRITICAL_RATIO.key => Dual::variable(value, 1),
        _ => Dual::of(value),
    });
    let squared_drive = 7e5 * 7e5 / 300.0;
    let flow = of.mass_flow(Dual::<f64, 2>::of(squared_drive), Dual::of(1.0 - r));
    // ψ = √(1 − u²), u = (r − b)/(1 − b): dψ/db = −u/ψ · (r − 1)/(1 − b)².
    let u = (r - b) / (1.0 - b);
    let (psi, choked) = ((1.0 - u * u).sqrt(), 1.185 * (293.15_f64 * squared_drive).sqrt());
    assert_close(flow.value, c * choked * psi, 1e-13);
    assert_close(flow.slope[0], choked * psi, 1e-13);
    assert_close(flow.slope[1], c * choked * u / psi * (1.0 - r) / (1.0 - b).powi(2), 1e-12);
}

/// The Python package `fluids`, which implements the standard independently, gives Kv 58.6107 m³/h at these conditions (carbon
/// dioxide, x_T = 0.7 as it assumes): <https://www.boardflare.com/tools/engineering/fluids/control-valve/size_cv_gas>.
#[test]
fn an_independent_sizing_program_needs_the_same_valve() {
    let (kelvin, molar_mass, compressibility) = (433.0, 44.01e-3, 0.988);
    // The law knows ideal gases: the compressibility makes the gas lighter or heavier at its pressure.
    let gas = air(compressibility * MOLAR / molar_mass, 1.3);
    let sized = law(FlowStandard::Kv { kv: 58.6107 / 3600.0, pressure_drop_ratio: 0.7 }, &gas);
    let got = mass_flow(&sized, 680e3, 310e3 / 680e3, kelvin);
    // 38/36 m³/s at 0 °C and 1 atm; the standard's constants have three digits.
    let requested = 38.0 / 36.0 * ATMOSPHERE * molar_mass / (MOLAR * 273.15);
    assert_close(got, requested, 2e-3);
}

#[test]
fn cv_is_a_gallon_a_minute_at_one_psi() {
    let air = air(286.99, 1.4);
    let by_cv = law(FlowStandard::Cv { cv: 0.3, pressure_drop_ratio: 0.7 }, &air);
    // Kv = 0.865 Cv in m³/h, as it is usually rounded.
    let by_kv = law(FlowStandard::Kv { kv: 0.3 * 0.865 / 3600.0, pressure_drop_ratio: 0.7 }, &air);
    assert_close(by_cv.conductance(), by_kv.conductance(), 1e-4);
    assert_eq!(by_cv.critical_ratio(), by_kv.critical_ratio());
}

#[test]
fn a_small_drop_is_the_flow_of_water_at_the_gas_s_density() {
    // As x → 0 the expansion factor is one: Q = Kv √(Δp ρ_w/(1 bar ρ)).
    let air = air(286.99, 1.4);
    let law = FlowLaw::new(FlowStandard::Kv { kv: 1e-5, pressure_drop_ratio: 0.7 }, 1.0, 1.0 - 1e-9, &air);
    let law = law.expect("a law");
    let (density, drop) = (5e5 / (286.99 * ROOM), 1e-6);
    let water = 1e-5 * (5e5 * drop * 999.1 / 1e5 / density).sqrt() * density;
    assert_close(mass_flow(&law, 5e5, 1.0 - drop, ROOM), water, 1e-6);
}

/// The sonic conductance in L/(s·bar) that a law has.
fn sonic_conductance(law: &FlowLaw) -> f64 {
    law.conductance() / (REFERENCE_DENSITY * ROOM.sqrt()) * 1e3 * 1e5
}

/// SMC, catalogue EUS11-83B-UK, states C and Cv of four sizes of one series: what Cv with the usual x_T says of C.
#[test]
fn c_from_cv_is_within_a_quarter_of_what_a_catalogue_states() {
    let air = air(286.99, 1.4);
    let stated = [(1.1, 0.29), (2.8, 0.90), (4.5, 1.4), (10.0, 2.5)];
    let ratios =
        stated.map(|(c, cv)| sonic_conductance(&law(FlowStandard::Cv { cv, pressure_drop_ratio: 0.7 }, &air)) / c);
    // What `docs/valves.md` says.
    for (ratio, published) in ratios.into_iter().zip([1.03, 1.25, 1.21, 0.97]) {
        assert_within(ratio, published, 0.005);
    }
}

/// SMC's worked example of ISO 6358 (catalogue, front matter): C = 2 dm³/(s·bar), b = 0.3, 0.4 to 0.3 MPa gauge, 20 °C:
/// 600 dm³/min choked, 420 there, read off a graph as 0.7 of it.
#[test]
fn the_worked_example_of_a_catalogue() {
    let air = air(286.99, 1.4);
    let law = law(FlowStandard::Iso6358 { sonic_conductance: 2e-8, critical_ratio: 0.3 }, &air);
    let minute = |ratio| mass_flow(&law, 5e5, ratio, ROOM) / REFERENCE_DENSITY * 60e3;
    assert_close(minute(0.0), 600.0, 1e-12);
    assert_within(minute(0.8), 420.0, 0.005 * 600.0);
}

#[test]
fn the_slope_is_exact_and_the_law_falls_to_zero() {
    let air = air(286.99, 1.4);
    let law = law(FlowStandard::Cv { cv: 0.1, pressure_drop_ratio: 0.6 }, &air);
    for r in [0.45, 0.6, 0.8, 0.95] {
        let dual = law.ratio_function(Dual::<f64, 1>::variable(r, 0)).slope[0];
        assert_close(dual, slope(1e-4, |h| law.ratio_function::<f64>(r + h)), 1e-8);
    }
    assert_eq!(law.ratio_function::<f64>(1.0), 0.0);
    for r in [0.0, 0.2, 0.4] {
        assert_within(law.ratio_function::<f64>(r), 1.0, 2e-15);
    }
}

#[test]
fn a_gas_that_never_chokes_flows_ever_more() {
    // γ x_T/1.4 above one: no pressure ratio chokes it.
    let law = law(FlowStandard::Kv { kv: 1e-5, pressure_drop_ratio: 0.95 }, &air(2077.0, 5.0 / 3.0));
    assert!(law.critical_ratio() < 0.0);
    assert!(law.ratio_function::<f64>(0.0) > law.ratio_function::<f64>(0.01));
}

#[test]
fn coefficients_outside_physics_are_refused() {
    let air = air(286.99, 1.4);
    let key = |port, standard| match FlowLaw::of_flow_path(port, standard, 1.0, 0.999, &air) {
        Err(Error::OutOfRange { parameter, .. } | Error::Inconsistent { parameter, .. }) => parameter.key,
        other => panic!("{other:?}"),
    };
    let kv = |kv, pressure_drop_ratio| FlowStandard::Kv { kv, pressure_drop_ratio };
    let cv = |cv, pressure_drop_ratio| FlowStandard::Cv { cv, pressure_drop_ratio };
    assert_eq!(key(Port::Supply, kv(0.0, 0.7)), "valve.kv");
    assert_eq!(key(Port::Supply, kv(1e-5, 1.0)), "valve.pressure_drop_ratio");
    assert_eq!(key(Port::Supply, kv(1e-5, 5e-4)), "valve.laminar_ratio");
    assert_eq!(key(Port::Supply, cv(-1.0, 0.7)), "valve.cv");
    assert_eq!(key(Port::Exhaust, cv(f64::NAN, 0.7)), "valve.exhaust.cv");
    assert_eq!(key(Port::Exhaust, kv(1e-5, 0.0)), "valve.exhaust.pressure_drop_ratio");
}

#[test]
fn a_separate_exhaust_path_serves_only_its_port() {
    let paper = Paper::pwm(25.0, 0.5);
    let air = paper.air();
    let wide = FlowStandard::Iso6358 { sonic_conductance: 2e-8, critical_ratio: 0.2 };
    let wide = FlowLaw::of_flow_path(Port::Exhaust, wide, 1.0, 0.999, &air).expect("a law");
    let (plain, own) = (paper.valve(), paper.valve().with_exhaust(wide));
    let chamber = Chamber::new(3e5, 3e5 * 1e-5 / (286.99 * ROOM), 1e-5, 0.0);
    assert_eq!(own.flow(Port::Supply, &chamber), plain.flow(Port::Supply, &chamber));
    let outward = own.flow(Port::Exhaust, &chamber).outward;
    // Choked at 3 bar to the atmosphere by C ρ₀ P √(T₀/T), ISO 6358-1.
    let ellipse = (1.0 - ((ATMOSPHERE / 3e5 - 0.2) / 0.8).powi(2)).sqrt();
    assert_close(outward, 2e-8 * 1.185 * 3e5 * ellipse, 1e-12);
    let both = own.open_flow(&chamber, true, true);
    assert_eq!((both.inward, both.outward), (own.flow(Port::Supply, &chamber).inward, outward));
    assert_eq!(own.open_flow(&chamber, false, true), own.flow(Port::Exhaust, &chamber));
    assert_eq!(own.open_flow(&chamber, false, false).net(), 0.0);

    // And in the actuator's answer, with the rows of the two flow paths distinguished.
    let actuator = paper.actuator().with_valve(own);
    let state = ActuatorState::new(AbsolutePressure(3e5), 1e-4, 0.08);
    let vented = |actuator: &mckibben::Actuator| {
        actuator.respond(&state, 0.09, 0.0, Ports { supply: false, exhaust: true }).mass_flow
    };
    let doubled =
        actuator.map(|row, value| if row.key == "valve.exhaust.sonic_conductance" { 2.0 * value } else { value });
    assert_close(vented(&doubled), 2.0 * vented(&actuator), 1e-14);
    let tripled = actuator.map(|row, value| if row.key == "valve.flow_area" { 3.0 * value } else { value });
    assert_eq!(vented(&tripled), vented(&actuator));
}
