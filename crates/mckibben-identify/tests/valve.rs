//! Valves whose numbers are known: the core's flow law with noise, closed forms, and simulated tanks and pulse trains.

use crate::noise::{HITS, Noise, coverage, holds};
use mckibben::air::{Air, Process};
use mckibben::force::{Characteristic, Effective, Effectiveness, IdealBraid, LengthLimits};
use mckibben::friction::Friction;
use mckibben::load::Load;
use mckibben::simulation::{Actuation, Initial, InitialLength, Rig, simulate};
use mckibben::valve::{
    Command, ExhaustTemperature, FlowLaw, FlowStandard, Request, Solenoid, Supply, Valve, ValveKind,
};
use mckibben::{AbsolutePressure, Actuator, Braid, GaugePressure};
use mckibben_identify::valve::{
    Delays, DutyPoint, FlowCurve, PulseTrain, Scatter, SteadyPoint, Tank, TankFit, TankRecord, TankUnknown, Transfer,
    ValveError, delay_difference, efficiency, flow_coefficient,
};

const ROOM: f64 = 293.15;
const ATMOSPHERE: f64 = 101_325.0;
/// 0.6 L/(s·bar).
const CONDUCTANCE: f64 = 6e-9;
const RATIO: f64 = 0.32;

fn air(process: Process) -> Air {
    Air::standard(process).expect("a gas")
}

fn close(value: f64, exact: f64, relative: f64, what: &str) {
    assert!((value - exact).abs() <= relative * exact.abs(), "{what}: {value:e} is not {exact:e}");
}

/// ISO 6358-1 written out.
fn iso(upstream: f64, downstream: f64, temperature: f64) -> f64 {
    let r = downstream / upstream;
    let shape = if r <= RATIO { 1.0 } else { (1.0 - ((r - RATIO) / (1.0 - RATIO)).powi(2)).sqrt() };
    CONDUCTANCE * 1.185 * upstream * (293.15 / temperature).sqrt() * shape
}

fn point(upstream: f64, ratio: f64, temperature: f64) -> SteadyPoint {
    let downstream = ratio * upstream;
    SteadyPoint {
        upstream: AbsolutePressure(upstream),
        downstream: AbsolutePressure(downstream),
        temperature,
        mass_flow: iso(upstream, downstream, temperature),
    }
}

fn curve() -> Vec<SteadyPoint> {
    (1..=14).map(|place| point(7e5, 0.065 * f64::from(place) + 0.05, 290.0 + f64::from(place))).collect()
}

fn with_noise(points: &[SteadyPoint], seed: u64, part: f64) -> Vec<SteadyPoint> {
    let mut noise = Noise::new(seed);
    let changed =
        |point: &SteadyPoint| SteadyPoint { mass_flow: point.mass_flow * (1.0 + part * noise.normal()), ..*point };
    points.iter().map(changed).collect()
}

#[test]
fn a_flow_curve_gives_c_and_b_back() {
    for scatter in [Scatter::Constant, Scatter::Proportional] {
        let found =
            FlowCurve::fit(&with_noise(&curve(), 1, 1e-7), &air(Process::Isothermal), scatter).expect("a curve");
        close(found.sonic_conductance.value, CONDUCTANCE, 1e-6, "C");
        close(found.critical_ratio.value, RATIO, 1e-5, "b");
        close(found.choked_conductance.value, CONDUCTANCE, 1e-6, "C of choked points");
        close(found.subsonic_ratio.value, RATIO, 1e-5, "b of subsonic points");
        // 0.05 + 0.065·4 = 0.31 is the last choked one.
        assert_eq!((found.choked, found.subsonic), (4, 10));
    }
    // SMC's worked example: C = 2 dm³/(s·bar), b = 0.3, from 0.5 to 0.4 MPa absolute: 420 dm³/min ANR, the chart's 0.7 of 600.
    let smc = SteadyPoint::of_reference_volume(AbsolutePressure(5e5), AbsolutePressure(4e5), ROOM, 0.42 / 60.0);
    let law = FlowStandard::Iso6358 { sonic_conductance: 2e-8, critical_ratio: 0.3 };
    let law = FlowLaw::new(law, 1.0, 0.999, &air(Process::Isothermal)).expect("a law");
    close(efficiency(&[smc, smc], &law, Scatter::Constant).expect("a factor").factor.value, 1.0, 5e-3, "η");
}

#[test]
fn intervals_of_c_and_b_hold_the_truth_in_95_of_100_trials() {
    let air = air(Process::Isothermal);
    let hits = coverage(|seed| {
        let points = with_noise(&curve(), seed, 0.01);
        let found = FlowCurve::fit(&points, &air, Scatter::Proportional).expect("a curve");
        [holds(&found.sonic_conductance, CONDUCTANCE), holds(&found.critical_ratio, RATIO)]
    });
    println!("flow curve: C, b {hits:?}");
    assert!(hits.iter().all(|hits| HITS.contains(hits)), "{hits:?}");
}

#[test]
fn the_efficiency_is_measured_over_calculated_flow() {
    let air = air(Process::Isentropic);
    let area = 1.8e-5 * 0.3048 * 0.3048;
    let law = FlowLaw::new(FlowStandard::Orifice { flow_area: area }, 1.0, 0.999, &air).expect("a law");
    // (21)(23) written out for two choked points and a subsonic one.
    let c_m = |r: f64| match r {
        r if r <= 0.528_281_787_717 => (1.4 / 286.99 * (2.0_f64 / 2.4).powi(6)).sqrt(),
        r => (2.0 * 1.4 / (286.99 * 0.4) * (r.powf(2.0 / 1.4) - r.powf(2.4 / 1.4))).sqrt(),
    };
    let exact = |r: f64| 0.85 * area * 7e5 * c_m(r) / ROOM.sqrt();
    let of = |ratio: f64| SteadyPoint { mass_flow: exact(ratio), ..point(7e5, ratio, ROOM) };
    let points = [of(0.2), of(0.4), of(0.8), of(0.9)];
    let found = efficiency(&points, &law, Scatter::Proportional).expect("a factor");
    close(found.factor.value, 0.85, 1e-5, "η");
    assert!(found.ratios.iter().all(|ratio| (ratio - 0.85).abs() < 1e-5), "{:?}", found.ratios);
    let coefficient = flow_coefficient(&points, 2.0 * area, &air, Scatter::Proportional).expect("a factor");
    close(coefficient.factor.value, 0.425, 1e-5, "C_q");
    let hits = coverage(|seed| {
        let noisy = with_noise(&points, seed, 0.02);
        [holds(&efficiency(&noisy, &law, Scatter::Proportional).expect("a factor").factor, 0.85)]
    });
    println!("efficiency: {hits:?}");
    assert!(hits.iter().all(|hits| HITS.contains(hits)), "{hits:?}");
}

#[test]
fn curves_that_identify_nothing_are_refused_with_a_remedy() {
    let air = air(Process::Isothermal);
    let refused = |points: &[SteadyPoint]| {
        FlowCurve::fit(points, &air, Scatter::Proportional).expect_err("it is refused").to_string()
    };
    let of = |ratios: &[f64], seed: u64| {
        let points: Vec<SteadyPoint> = ratios.iter().map(|ratio| point(7e5, *ratio, ROOM)).collect();
        with_noise(&points, seed, 1e-3)
    };
    for seed in 0..20 {
        let choked = refused(&of(&[0.05, 0.1, 0.15, 0.2, 0.22, 0.25, 0.3], seed));
        assert!(choked.contains("b is not identifiable") && choked.contains("0.3"), "{choked}");
        let subsonic = refused(&of(&[0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9], seed));
        assert!(subsonic.contains("C is not identifiable") && subsonic.contains("0.5"), "{subsonic}");
    }
    let few = refused(&of(&[0.1, 0.5, 0.9], 1));
    assert!(few.contains("3 points") && few.contains("at least 5"), "{few}");
    // Gauge pressures given as absolute, both with a downstream of no more than the atmosphere.
    let gauge = |point: &SteadyPoint| SteadyPoint {
        upstream: AbsolutePressure(point.upstream.0 - ATMOSPHERE),
        downstream: AbsolutePressure(point.downstream.0 - ATMOSPHERE),
        ..*point
    };
    let vacuum = refused(&curve().iter().map(gauge).collect::<Vec<_>>());
    assert!(vacuum.contains("gauge pressure") && vacuum.contains("downstream pressure of point 1"), "{vacuum}");
    let one = |change: fn(&mut SteadyPoint)| {
        let mut points = curve();
        change(&mut points[2]);
        refused(&points)
    };
    assert!(one(|point| point.temperature = 21.0).contains("give it in kelvin, or with its own unit"));
    assert!(one(|point| point.upstream.0 = 7.0).contains("Pa"));
    assert!(one(|point| point.downstream = point.upstream).contains("swap the two"));
    assert!(one(|point| point.mass_flow = f64::NAN).contains("mass flow of point 3"));
    assert!(one(|point| point.mass_flow = -1.0).contains("not above zero"));
}

#[test]
fn gauge_pressures_taken_for_absolute_make_an_impossible_ratio() {
    // From 2 bar over the atmosphere down to the atmosphere and back pressures above it, as gauge pressures: the flow falls
    // from the very first ratio on.
    let ratios = [0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
    let points: Vec<SteadyPoint> = ratios
        .iter()
        .map(|gauge| {
            let (upstream, downstream) = (2e5, gauge * 2e5);
            SteadyPoint {
                upstream: AbsolutePressure(upstream),
                downstream: AbsolutePressure(downstream),
                temperature: ROOM,
                mass_flow: iso(upstream + ATMOSPHERE, downstream + ATMOSPHERE, ROOM),
            }
        })
        .collect();
    let error = FlowCurve::fit(&with_noise(&points, 2, 1e-3), &air(Process::Isothermal), Scatter::Proportional);
    let error = error.expect_err("it is refused");
    assert!(matches!(error, ValveError::CriticalRatio { value } if value < 0.0), "{error}");
    assert!(error.to_string().contains("both pressures are absolute"));
}

const VALVE: FlowStandard = FlowStandard::Iso6358 { sonic_conductance: CONDUCTANCE, critical_ratio: RATIO };

fn tank(process: Process, transfer: Transfer) -> Tank {
    Tank { volume: 5e-4, temperature: ROOM, air: air(process), transfer }
}

fn times(until: f64, count: usize) -> Vec<f64> {
    (0..count).map(|place| until * place as f64 / (count - 1) as f64).collect()
}

#[test]
fn an_isothermal_tank_empties_as_the_closed_form_says() {
    let tank = tank(Process::Isothermal, Transfer::Discharge);
    // Choked down to 1.013/0.32 = 3.2 bar: dP/dt = −(RT/V) C ρ₀ √(T₀/T) P.
    let rate = 286.99 * ROOM / 5e-4 * CONDUCTANCE * 1.185;
    let times = times(0.6, 121);
    let pressures = tank.pressures(AbsolutePressure(8e5), VALVE, 1.0, &times).expect("pressures");
    assert!(pressures[120] > ATMOSPHERE / RATIO, "{}", pressures[120]);
    for (time, pressure) in times.iter().zip(&pressures) {
        close(*pressure, 8e5 * (-rate * time).exp(), 1e-8, "P");
    }
    let record = TankRecord::new(times, pressures).expect("a record");
    for point in tank.isothermal_flow(&record, 10).expect("points") {
        close(point.mass_flow, iso(point.upstream.0, ATMOSPHERE, ROOM), 1e-6, "ṁ");
    }
}

/// C and b of a record by windows, from the points that are not near equal pressures.
fn by_windows(tank: &Tank, record: &TankRecord) -> FlowCurve {
    let points = tank.isothermal_flow(record, 40).expect("points");
    let points: Vec<SteadyPoint> = points.into_iter().filter(|point| point.ratio() < 0.9).collect();
    FlowCurve::fit(&points, &tank.air, Scatter::Constant).expect("a curve")
}

#[test]
fn intervals_by_windows_of_an_isothermal_tank_hold_c_and_b_in_95_of_100_trials() {
    let supply = AbsolutePressure(7e5);
    let charge = tank(Process::Isothermal, Transfer::Charge { supply, temperature: ROOM });
    let discharge = tank(Process::Isothermal, Transfer::Discharge);
    let runs = [(charge, ATMOSPHERE, 0.8), (discharge, 8e5, 1.6)].map(|(tank, from, until)| {
        let times = times(until, 801);
        let exact = tank.pressures(AbsolutePressure(from), VALVE, 1.0, &times).expect("pressures");
        (tank, times, exact)
    });
    let record = |run: &(Tank, Vec<f64>, Vec<f64>), seed: u64| {
        TankRecord::new(run.1.clone(), Noise::new(seed).added_to(&run.2, 50.0)).expect("a record")
    };
    let hits = coverage(|seed| {
        let [charge, discharge] = [0, 1].map(|run| by_windows(&runs[run].0, &record(&runs[run], seed)));
        [
            holds(&charge.sonic_conductance, CONDUCTANCE),
            holds(&charge.critical_ratio, RATIO),
            holds(&discharge.sonic_conductance, CONDUCTANCE),
            holds(&discharge.critical_ratio, RATIO),
        ]
    });
    println!("windows: C, b of a charge, C, b of a discharge {hits:?}");
    assert!(hits.iter().all(|hits| HITS.contains(hits)), "{hits:?}");
    // The trajectory determines more.
    let guess = TankUnknown::Valve { sonic_conductance: 1e-8, critical_ratio: 0.5 };
    for run in &runs {
        let record = record(run, 1);
        let (windows, trajectory) = (by_windows(&run.0, &record), run.0.fit(&record, guess, false).expect("a fit"));
        let [windows, by_trajectory] = [windows.critical_ratio, trajectory.critical_ratio.expect("b")]
            .map(|estimate| estimate.standard_error.expect("it is identifiable"));
        println!("standard error of b by windows {windows:.2e}, by the trajectory {by_trajectory:.2e}");
        assert!(by_trajectory < 0.7 * windows);
        close(trajectory.scatter, 50.0, 0.1, "the noise");
    }
}

#[test]
fn intervals_of_a_discharge_hold_c_and_b_in_95_of_100_trials() {
    let balance = Process::EnergyBalance { heat_transfer: 0.3, wall_temperature: ROOM };
    let tank = tank(balance, Transfer::Discharge);
    let times = times(1.5, 60);
    let exact = tank.pressures(AbsolutePressure(8e5), VALVE, 1.0, &times).expect("pressures");
    let guess = TankUnknown::Valve { sonic_conductance: 7e-9, critical_ratio: 0.4 };
    let hits = coverage(|seed| {
        let record = TankRecord::new(times.clone(), Noise::new(seed).added_to(&exact, 500.0)).expect("a record");
        let found = tank.fit(&record, guess, false).expect("a fit");
        let (conductance, ratio) = (found.sonic_conductance.expect("C"), found.critical_ratio.expect("b"));
        [holds(&conductance, CONDUCTANCE), holds(&ratio, RATIO)]
    });
    println!("discharge: C, b {hits:?}");
    assert!(hits.iter().all(|hits| HITS.contains(hits)), "{hits:?}");
}

#[test]
fn a_charge_and_a_discharge_together_are_more_informative_than_either() {
    let supply = AbsolutePressure(7e5);
    let charge = tank(Process::Isothermal, Transfer::Charge { supply, temperature: ROOM });
    let discharge = tank(Process::Isothermal, Transfer::Discharge);
    let runs = [(charge, ATMOSPHERE, 0.8, 50.0, 3), (discharge, 8e5, 1.6, 200.0, 4)];
    let records = runs.map(|(tank, from, until, noise, seed)| {
        let times = times(until, 401);
        let exact = tank.pressures(AbsolutePressure(from), VALVE, 1.0, &times).expect("pressures");
        (tank, TankRecord::new(times, Noise::new(seed).added_to(&exact, noise)).expect("a record"))
    });
    let guess = TankUnknown::Valve { sonic_conductance: 7e-9, critical_ratio: 0.4 };
    let both = records.each_ref().map(|(tank, record)| (*tank, record));
    let together = Tank::fit_together(&both, guess, false).expect("a fit");
    let alone = records.each_ref().map(|(tank, record)| tank.fit(record, guess, false).expect("a fit"));
    let estimates =
        |fit: &TankFit| [&fit.sonic_conductance, &fit.critical_ratio].map(|of| of.clone().expect("estimated"));
    let deviations = |fit: &TankFit| estimates(fit).map(|estimate| estimate.standard_error.expect("a deviation"));
    for ((estimate, truth), place) in estimates(&together).iter().zip([CONDUCTANCE, RATIO]).zip(0..) {
        let own = deviations(&together)[place];
        assert!((estimate.value - truth).abs() < 4.0 * own, "{estimate:?}");
        // By the weights of both: 1/s² of the whole is the sum of those of the parts, or more where they complete each other.
        let parts: f64 = alone.iter().map(|fit| deviations(fit)[place].powi(-2)).sum();
        assert!(own.powi(-2) > 0.9 * parts, "{own}, {parts}");
    }
    for ([scatter, noise], deviation) in together.of_records.iter().zip([50.0, 200.0]) {
        close(*scatter, deviation, 0.15, "the scatter");
        close(*noise, deviation, 0.2, "the noise");
    }
    assert!(Tank::fit_together(&[], guess, false).is_err());
}

#[test]
fn intervals_of_a_charge_hold_the_volume_in_95_of_100_trials() {
    let transfer = Transfer::Charge { supply: AbsolutePressure(7e5), temperature: ROOM };
    let tank = tank(Process::Polytropic { index: 1.2 }, transfer);
    let times = times(0.5, 40);
    let exact = tank.pressures(AbsolutePressure(ATMOSPHERE), VALVE, 0.9, &times).expect("pressures");
    let guess = Tank { volume: 2e-4, ..tank };
    let hits = coverage(|seed| {
        let record = TankRecord::new(times.clone(), Noise::new(seed).added_to(&exact, 1e3)).expect("a record");
        let unknowns = TankUnknown::Volume { standard: VALVE, efficiency: 0.9 };
        [holds(&guess.fit(&record, unknowns, false).expect("a fit").volume.expect("V"), 5e-4)]
    });
    println!("charge: V {hits:?}");
    assert!(hits.iter().all(|hits| HITS.contains(hits)), "{hits:?}");
}

#[test]
fn heat_transfer_is_estimated_together_with_the_valve() {
    let of = |heat_transfer: f64| {
        tank(Process::EnergyBalance { heat_transfer, wall_temperature: ROOM }, Transfer::Discharge)
    };
    let times = times(1.5, 200);
    let exact = of(0.5).pressures(AbsolutePressure(8e5), VALVE, 1.0, &times).expect("pressures");
    let record = TankRecord::new(times, Noise::new(8).added_to(&exact, 20.0)).expect("a record");
    let guess = TankUnknown::Valve { sonic_conductance: 7e-9, critical_ratio: 0.4 };
    let found = of(0.2).fit(&record, guess, true).expect("a fit");
    close(found.heat_transfer.expect("h A").value, 0.5, 0.05, "h A");
    close(found.sonic_conductance.expect("C").value, CONDUCTANCE, 0.01, "C");
    // A record that ends at half of the upstream pressure: from these guesses alone the search ends elsewhere.
    let times: Vec<f64> = (0..=240).map(|place| 5e-3 * f64::from(place)).collect();
    let exact = of(0.5).pressures(AbsolutePressure(8.01325e5), VALVE, 1.0, &times).expect("pressures");
    let short = TankRecord::new(times, Noise::new(8).added_to(&exact, 5.0)).expect("a record");
    let far = TankUnknown::Valve { sonic_conductance: 1e-8, critical_ratio: 0.5 };
    let found = of(0.2).fit(&short, far, true).expect("a fit");
    close(found.heat_transfer.expect("h A").value, 0.5, 0.05, "h A");
    close(found.critical_ratio.expect("b").value, RATIO, 0.05, "b");
    let without = tank(Process::Isothermal, Transfer::Discharge).fit(&record, guess, true).expect_err("no heat");
    assert!(without.to_string().contains("energy balance"), "{without}");
}

/// From four times C and h A the sum of squares falls to the bound of b, where it has another minimum.
#[test]
fn heat_transfer_and_valve_do_not_depend_on_the_guesses() {
    let of = |heat_transfer: f64| {
        tank(Process::EnergyBalance { heat_transfer, wall_temperature: ROOM }, Transfer::Discharge)
    };
    let times = times(2.5, 60);
    let exact = of(0.5).pressures(AbsolutePressure(8e5), VALVE, 1.0, &times).expect("pressures");
    let record = TankRecord::new(times, Noise::new(8).added_to(&exact, 100.0)).expect("a record");
    for (part, heat) in [(4.0, 2.0), (0.2, 0.05)] {
        let guess = TankUnknown::Valve { sonic_conductance: part * CONDUCTANCE, critical_ratio: 0.5 };
        let found = of(heat).fit(&record, guess, true).expect("a fit");
        close(found.scatter, 100.0, 0.3, "the noise");
        let estimates =
            [(found.sonic_conductance, CONDUCTANCE), (found.critical_ratio, RATIO), (found.heat_transfer, 0.5)];
        for (estimate, truth) in estimates {
            let estimate = estimate.expect("it was unknown");
            let error = estimate.standard_error.expect("it is identifiable");
            assert!((estimate.value - truth).abs() < 4.0 * error, "{part}, {heat}: {estimate:?}, not {truth}");
        }
        assert!(!found.all_choked);
    }
}

/// A discharge whose flow is choked to its end says of b that it is at least the largest pressure ratio, whatever the guess is.
#[test]
fn b_is_not_identifiable_where_all_samples_are_choked() {
    let tank = tank(Process::Isothermal, Transfer::Discharge);
    let times = times(0.6, 60);
    let exact = tank.pressures(AbsolutePressure(8e5), VALVE, 1.0, &times).expect("pressures");
    let ratio = ATMOSPHERE / exact[59];
    assert!(ratio < RATIO, "{ratio}");
    for seed in [1, 3, 6] {
        let record = TankRecord::new(times.clone(), Noise::new(seed).added_to(&exact, 200.0)).expect("a record");
        for critical_ratio in [0.05, 0.6] {
            let guess = TankUnknown::Valve { sonic_conductance: 8e-9, critical_ratio };
            let found = tank.fit(&record, guess, false).expect("a fit");
            assert!(found.all_choked, "{found:?}");
            let b = found.critical_ratio.expect("it was unknown");
            close(b.value, ratio, 1e-3, "the least b");
            assert!(b.standard_error.is_none() && b.confidence_interval.is_none(), "{b:?}");
            let c = found.sonic_conductance.expect("it was unknown");
            let error = c.standard_error.expect("it is identifiable");
            assert!((c.value - CONDUCTANCE).abs() < 4.0 * error, "{c:?}");
        }
    }
}

/// Without the readings about its opening a tank has its valve still: the model begins at the opening, not at the first reading.
#[test]
fn a_tank_whose_first_readings_are_lacking_is_simulated_from_the_opening_of_its_valve() {
    let guess = TankUnknown::Valve { sonic_conductance: 1e-8, critical_ratio: 0.5 };
    let tank = tank(Process::Isentropic, Transfer::Discharge);
    let times = times(1.2, 241);
    let exact = tank.pressures(AbsolutePressure(7e5), VALVE, 1.0, &times).expect("pressures");
    let noisy = Noise::new(5).added_to(&exact, 100.0);
    let record = || TankRecord::new(times[8..].to_vec(), noisy[8..].to_vec()).expect("a record");
    let found = tank.fit(&record().opened_at(0.0).expect("before it"), guess, false).expect("a fit");
    let conductance = found.sonic_conductance.expect("it was unknown");
    let error = conductance.standard_error.expect("it is identifiable");
    assert!((conductance.value - CONDUCTANCE).abs() < 3.0 * error, "{conductance:?}");
    close(conductance.value, CONDUCTANCE, 5e-3, "C");
    // Air that has cooled by then is taken for warm otherwise.
    let later = tank.fit(&record(), guess, false).expect("a fit").sonic_conductance.expect("it was unknown");
    assert!((later.value / CONDUCTANCE - 1.0).abs() > 5e-3, "{later:?}");
    assert!(record().opened_at(0.5).expect_err("after it").to_string().contains("before it opens"));
}

#[test]
fn records_of_a_tank_that_cannot_be_are_refused() {
    let times = times(1.0, 20);
    let refused = |pressure: Vec<f64>| TankRecord::new(times.clone(), pressure).expect_err("it is refused").to_string();
    let mut gauge = vec![2e5; 20];
    gauge[4] = -300.0;
    assert!(refused(gauge).contains("add the atmosphere's pressure"));
    assert!(refused(vec![7.0; 20]).contains("Pa"));
    assert!(refused(vec![f64::NAN; 20]).contains("not a finite number"));
    let record = TankRecord::new(times.clone(), vec![2e5; 20]).expect("a record");
    let tank = tank(Process::Isothermal, Transfer::Discharge);
    assert!(tank.isothermal_flow(&record, 10).expect_err("too few").to_string().contains("fewer windows"));
}

const DELAYS: [f64; 2] = [4e-3, 1e-3];

/// Pressure in a rigid volume of 50 mL behind a three-way valve under PWM.
fn pulsed(frequency: f64, duty: f64, time: &[f64]) -> Vec<f64> {
    pulsed_by(VALVE, [frequency, duty], time)
}

fn pulsed_by(valve: FlowStandard, [frequency, duty]: [f64; 2], time: &[f64]) -> Vec<f64> {
    let air = air(Process::Isentropic);
    let supply = Supply::new(GaugePressure(6e5), ROOM, &air).expect("a supply");
    let law = FlowLaw::new(valve, 1.0, 0.999, &air).expect("a law");
    let valve = Valve::new(law, supply, ExhaustTemperature::Actuator, &air);
    let braid = Braid::new(0.1, 100.0).expect("a braid");
    let limits = LengthLimits::new(&braid, None, 0.09, 1e5, 0.0).expect("limits");
    let law =
        Effective { law: Characteristic::from(IdealBraid { braid }), effectiveness: Effectiveness::Constant(1.0) };
    let actuator = Actuator::new(law, limits, Friction::NONE, 5e-5, air).expect("an actuator").with_valve(valve);
    let solenoid = Solenoid::new(ValveKind::ThreeWay, DELAYS[0], DELAYS[1]).expect("a solenoid");
    let command = Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("a command");
    let rig = Rig::new(actuator, Some(Actuation { solenoid, command }), Load::Isometric).expect("a rig");
    let initial = Initial {
        gauge_pressure: GaugePressure(2e5),
        temperature: ROOM,
        length: InitialLength::At(0.08),
        velocity: 0.0,
    };
    let start = rig.start(&initial).expect("a start");
    let run = simulate(&rig, start, time[time.len() - 1], 1e-9).expect("the run reaches its end");
    time.iter().map(|time| run.at(*time).pressure.0).collect()
}

#[test]
fn delays_come_out_to_a_fraction_of_the_sample_interval() {
    let interval = 5e-4;
    let time: Vec<f64> = (0..=1600).map(|place| f64::from(place) * interval + 1.3e-4).collect();
    let exact = pulsed(20.0, 0.5, &time);
    let noisy = Noise::new(6).added_to(&exact, 100.0);
    let train = PulseTrain::pwm(20.0, 0.5, 16).expect("a train");
    let found = Delays::find(&time, &noisy, &train).expect("delays");
    println!("{:?} {:?} {:?} {}", found.opening, found.closing, found.effective_duty, found.missed);
    assert!((found.opening.value - DELAYS[0]).abs() < 0.1 * interval, "{:?}", found.opening);
    assert!((found.closing.value - DELAYS[1]).abs() < 0.1 * interval, "{:?}", found.closing);
}

#[test]
fn the_effective_duty_is_the_papers() {
    let mut points = Vec::new();
    for (frequency, effective) in [(10.0, 0.47), (25.0, 0.425), (50.0, 0.35)] {
        let time: Vec<f64> = (0..=3200).map(|place| f64::from(place) * 2.5e-4).collect();
        let noisy = Noise::new(9).added_to(&pulsed(frequency, 0.5, &time), 30.0);
        let train = PulseTrain::pwm(frequency, 0.5, (0.8 * frequency) as usize).expect("a train");
        let found = Delays::find(&time, &noisy, &train).expect("delays");
        let duty = found.effective_duty.expect("a duty").value;
        println!("{frequency} Hz: {duty} for {effective}");
        assert!((duty - effective).abs() < 2e-3, "{duty} at {frequency} Hz");
        points.push(DutyPoint { frequency, commanded: 0.5, effective: duty });
    }
    let difference = delay_difference(&points).expect("a difference");
    assert!((difference.value - 3e-3).abs() < 5e-5, "{difference:?}");
    // The paper's own figures: 43 % at 25 Hz and 35 % at 50 Hz. Σ f(d − d′)/Σ f² = (25·0.07 + 50·0.15)/3125.
    let paper =
        [(25.0, 0.43), (50.0, 0.35)].map(|(frequency, effective)| DutyPoint { frequency, commanded: 0.5, effective });
    let difference = delay_difference(&paper).expect("a difference");
    close(difference.value, (25.0 * 0.07 + 50.0 * 0.15) / 3125.0, 1e-9, "t_open − t_close");
}

#[test]
fn intervals_of_delays_hold_the_truth_in_95_of_100_trials() {
    let time: Vec<f64> = (0..=800).map(|place| f64::from(place) * 5e-4 + 2e-4).collect();
    let exact = pulsed(20.0, 0.5, &time);
    let train = PulseTrain::pwm(20.0, 0.5, 8).expect("a train");
    let hits = coverage(|seed| {
        let noisy = Noise::new(seed).added_to(&exact, 300.0);
        let found = Delays::find(&time, &noisy, &train).expect("delays");
        [holds(&found.opening, DELAYS[0]), holds(&found.closing, DELAYS[1])]
    });
    println!("delays: opening, closing {hits:?}");
    // The error of the model that they allow for is hardly there.
    assert!(hits.iter().all(|hits| hits >= HITS.start()), "{hits:?}");
}

/// A fast valve, whose flow ceases to be choked within milliseconds of an edge, and a pulse that reaches the supply's pressure: two
/// cubics from the pause to the next edge are tens of microseconds off there, many of their standard errors.
#[test]
fn a_pressure_that_bends_near_an_edge_does_not_bias_the_delays() {
    let fast = FlowStandard::Iso6358 { sonic_conductance: 1.2e-8, critical_ratio: 0.3 };
    for (interval, frequency, duty) in [(5e-4, 10.0, 0.25), (1e-3, 10.0, 0.25), (5e-4, 20.0, 0.5), (1e-3, 20.0, 0.5)] {
        let time: Vec<f64> = (0..(1.6 / interval) as u32).map(|place| f64::from(place) * interval + 1.1e-4).collect();
        let exact = pulsed_by(fast, [frequency, duty], &time);
        let noisy = Noise::new(4).added_to(&exact, 30.0);
        let train = PulseTrain::pwm(frequency, duty, (1.6 * frequency) as usize).expect("a train");
        let found = Delays::find(&time, &noisy, &train).expect("delays");
        for (delay, truth) in [(&found.opening, DELAYS[0]), (&found.closing, DELAYS[1])] {
            let error = delay.standard_error.expect("it is identifiable");
            println!("{interval} s, {frequency} Hz: {} for {truth}, ± {error}, {:?}", delay.value, found.windows);
            let off = (delay.value - truth).abs();
            assert!(off < 4.0 * error && off < 0.02 * interval, "{delay:?}, not {truth}");
        }
    }
}

#[test]
fn pulse_trains_without_an_answer_are_refused() {
    let time: Vec<f64> = (0..400).map(|place| f64::from(place) * 1e-3).collect();
    let train = PulseTrain::pwm(10.0, 0.5, 4).expect("a train");
    let still = Noise::new(2).added_to(&vec![3e5; 400], 100.0);
    let error = Delays::find(&time, &still, &train).expect_err("nothing happens").to_string();
    assert!(error.contains("after any of 4 times the coil was energised"), "{error}");
    // Ten samples in a pulse and ten in a pause: of 15 half of a pause and a pulse are made, and 16 take 16/30 ms.
    let every = |interval: f64| -> Vec<f64> { (0..480).map(|place| 0.013 + interval * f64::from(place)).collect() };
    let train = PulseTrain::pwm(25.0, 0.5, 19).expect("a train");
    let [slow, fast] = [2e-3, 1.0 / 600.0].map(|interval| {
        let time = every(interval);
        Delays::find(&time, &pulsed(25.0, 0.5, &time), &train)
    });
    let error = slow.expect_err("too few samples").to_string();
    assert!(error.contains("only 15 samples") && error.contains("at 19 of 19 times"), "{error}");
    assert!(error.contains("sample at 534 Hz or more"), "{error}");
    assert!(!matches!(fast, Err(ValveError::Coarse { .. })), "{fast:?}");
    assert!(PulseTrain::new(&[0.0, 0.1], &[0.3]).expect_err("not by turns").to_string().contains("by turns"));
    assert!(PulseTrain::pwm(10.0, 50.0, 4).expect_err("percent").to_string().contains("50 % is 0.5"));
    let percent = [DutyPoint { frequency: 25.0, commanded: 50.0, effective: 43.0 }; 2];
    assert!(delay_difference(&percent).expect_err("percent").to_string().contains("50 % is 0.5"));
}

#[test]
fn edges_of_a_sampled_command_lie_on_the_line_through_the_threshold() {
    let time = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
    let train = PulseTrain::of_command(&time, &[0.0, 0.0, 24.0, 24.0, 0.0, 0.0, 24.0], 6.0).expect("a train");
    let exact = [(0.125, true), (0.375, false), (0.525, true)];
    for (edge, exact) in train.edges().iter().zip(exact) {
        assert!((edge.0 - exact.0).abs() < 1e-12 && edge.1 == exact.1, "{edge:?}");
    }
    let [frequency, duty] = train.frequency_and_duty().expect("a period");
    close(frequency, 1.0 / 0.4, 1e-12, "frequency");
    close(duty, 0.25 / 0.4, 1e-12, "duty");
    assert!(!train.clone().turned().edges()[0].1);
    let later = train.within(1.0, [1.2, 1.4]);
    assert_eq!(later.edges().len(), 1);
    assert!(later.frequency_and_duty().is_none());
    let never = PulseTrain::of_command(&time, &[0.0; 7], 0.5).expect_err("no edge").to_string();
    assert!(never.contains("never crosses the threshold"), "{never}");
}

#[test]
fn delays_over_all_records_are_the_mean_of_all_pulses() {
    let time: Vec<f64> = (0..=800).map(|place| f64::from(place) * 5e-4 + 2e-4).collect();
    let of = |frequency: f64, seed: u64| {
        let noisy = Noise::new(seed).added_to(&pulsed(frequency, 0.5, &time), 100.0);
        let train = PulseTrain::pwm(frequency, 0.5, 40).expect("a train").within(0.0, [time[0], time[800]]);
        Delays::find(&time, &noisy, &train).expect("delays")
    };
    let records = [of(10.0, 1), of(20.0, 2)];
    let [opening, closing] = Delays::over_all(&records).expect("delays");
    let all = || records.iter().flat_map(|record| &record.onsets);
    for (found, energised) in [(&opening, true), (&closing, false)] {
        let delays: Vec<f64> =
            all().filter(|onset| onset.energised == energised).map(|onset| onset.time - onset.edge).collect();
        close(found.value, delays.iter().sum::<f64>() / delays.len() as f64, 1e-12, "mean");
    }
    assert!(holds(&opening, DELAYS[0]) && holds(&closing, DELAYS[1]), "{opening:?} {closing:?}");
    assert!(Delays::over_all(&[]).is_none());
}

#[test]
fn conductance_is_c_at_any_choked_point() {
    for (upstream, ratio, temperature) in [(7e5, 0.1, 250.0), (3e5, 0.3, 340.0)] {
        close(point(upstream, ratio, temperature).conductance(), CONDUCTANCE, 1e-12, "C");
    }
}
