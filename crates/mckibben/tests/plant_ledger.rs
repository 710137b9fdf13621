//! The ledger of energy and exergy: closed forms, the audits of rigs, the samples of a joint, and that every sum closes.

use crate::common::joint::{Pair, pairs};
use crate::common::plants::{Muscle, TANK, leg_on_its_belt, on_one_tank, reservoir, unlike_muscles_on_one_tank};
use crate::common::random::{self, runner};
use crate::common::{ATMOSPHERE, GRAVITY, INCH, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::air::Process;
use mckibben::line::{Compressor, Hose, HoseKind, Leakage, Line, Regulator, SupplyLine};
use mckibben::mechanism::{Coupling, Mass, Mechanism, Pull, Spring};
use mckibben::network::Network;
use mckibben::plant::{Balance, InitialAir, Mounted, Plant, PlantLedger, PlantStart, PlantTrajectory, simulate_plant};
use mckibben::simulation::{Actuation, JointSample, PressureSeries, Rig, SeriesTendon};
use mckibben::valve::{Command, FlowStandard, Request, Solenoid, ValveKind};
use mckibben::{Error, GaugePressure};
use proptest::prelude::*;

const GAS_CONSTANT: f64 = 286.99;
const HEAT_CAPACITY: f64 = 3.5 * GAS_CONSTANT;

fn sums(ledger: &PlantLedger) -> [(&'static str, Balance); 4] {
    [("work", ledger.work()), ("energy", ledger.energy()), ("exergy", ledger.exergy()), ("air", ledger.air())]
}

/// Asserts that every sum closes to a part of its turnover.
#[track_caller]
fn assert_closes(what: &str, ledger: &PlantLedger, relative: f64) {
    for (name, balance) in sums(ledger) {
        assert!(balance.closes(relative), "{what}: {name} leaves {balance:?} of {ledger:?}");
    }
}

fn run_of(rig: &Rig, paper: &Paper, duration: f64, tolerance: f64) -> PlantTrajectory {
    let start = rig.start(&paper.initial()).expect("a start");
    let plant = Plant::of_rig(rig);
    simulate_plant(&plant, &Plant::start_of_rig(rig, &start), duration, tolerance).expect("the run reaches its end")
}

/// Exergy in J of a cubic metre of air at T_0.
fn worth(pressure: f64) -> f64 {
    pressure * (pressure / ATMOSPHERE).ln() - pressure + ATMOSPHERE
}

#[test]
fn a_mass_on_a_spring() {
    let (mass, stiffness, rest, from) = (1.0, 1e4, 0.04, 0.05);
    // The muscle is slack throughout.
    let spring = Spring { stiffness, rest_length: rest };
    let load = Mass::new(mass, Pull::Gravity(GRAVITY), Some(spring)).expect("a mass");
    let mounted = Mounted {
        actuator: Paper::sealed().actuator(),
        mechanism: 0,
        coupling: Coupling::Direct { coordinate: 0 },
        tendon: None,
        pressure: None,
    };
    let network = Network::new(&Paper::sealed().air());
    let plant = Plant::new(vec![mounted], network, vec![Mechanism::Mass(load)]).expect("a plant");
    let start = PlantStart {
        positions: vec![vec![from]],
        rates: vec![vec![0.0]],
        air: vec![InitialAir { gauge_pressure: GaugePressure(3e5), temperature: ROOM }],
        lengths: vec![None],
        ..PlantStart::default()
    };
    let (omega, middle) = ((stiffness / mass).sqrt(), rest + mass * GRAVITY / stiffness);
    for duration in [0.01, 0.27] {
        let ledger = simulate_plant(&plant, &start, duration, 1e-10).expect("a run").ledger();
        let kinetic = 0.5 * mass * ((from - middle) * omega * (omega * duration).sin()).powi(2);
        assert_close(ledger.mechanisms[0].kinetic, kinetic, 1e-7);
        assert_close(ledger.mechanisms[0].potential, -kinetic, 1e-7);
        assert_eq!((ledger.actuators[0].gas_work, ledger.actuators[0].work), (0.0, 0.0));
        assert_closes("spring", &ledger, 1e-7);
    }
}

#[test]
fn a_bottle_empties_into_a_sealed_chamber() {
    let paper = Paper::driven(Command::Constant(Request::Fill)).isometric(3.5 * INCH).process(Process::Isothermal);
    let (bottle, gauge) = (2e-5, 7e5);
    let (plant, start) = on_one_tank(reservoir([bottle, 1.0], gauge, None), None, &[Muscle::of(paper.clone())]);
    let run = simulate_plant(&plant, &start, 3.0, 1e-10).expect("a run");
    let ledger = run.ledger();
    let chamber: f64 = paper.actuator().volume(3.5 * INCH);
    let first = gauge + ATMOSPHERE;
    let last = (first * bottle + ATMOSPHERE * chamber) / (bottle + chamber);
    let total = ledger.total();
    assert_close(ledger.nodes[TANK].air_gain, (last - first) * bottle / (GAS_CONSTANT * ROOM), 1e-8);
    assert_close(ledger.nodes[TANK].exergy_gain, bottle * (worth(last) - worth(first)), 1e-8);
    assert_close(ledger.actuators[0].exergy_gain, chamber * worth(last), 1e-8);
    let destroyed = bottle * worth(first) - (bottle + chamber) * worth(last);
    assert_close(total.throttled, destroyed, 1e-6);
    assert_eq!((total.drawn, total.compressed), (0.0, 0.0));
    // Until the poppet moves the exhaust is open between equal pressures.
    assert_within(total.exhaust, 0.0, 1e-12);
    assert_closes("a bottle", &ledger, 1e-7);
}

/// What a bottle gives, is what it held: here under PWM, with what branches.
#[test]
fn a_bottle_gives_no_more_than_it_holds() {
    for index in [1.0, 1.4] {
        let (volume, gauge) = (2e-5, 7e5);
        let (plant, start) =
            on_one_tank(reservoir([volume, index], gauge, None), None, &[Muscle::of(Paper::pwm(25.0, 0.5))]);
        let ledger = simulate_plant(&plant, &start, 2.0, 1e-8).expect("a run").ledger();
        // Let out at T_0, a volume of index κ holds a κ-th of the mass.
        let held = volume * worth(gauge + ATMOSPHERE) / index;
        let given = -ledger.nodes[TANK].exergy_gain;
        assert!(given > 0.2 * held && given < held, "{index}: {given} of {held}");
        assert_eq!(ledger.total().drawn, 0.0);
        assert!(ledger.exergy().imbalance() < 1e-6, "{:?}", ledger.exergy());
        assert_closes("a bottle", &ledger, 1e-6);
    }
}

#[test]
fn a_compressor_fills_a_tank_at_a_constant_flow() {
    let (displacement, volume, gauge, duration) = (2e-4, 1e-3, 1e5, 2.0);
    let switch = [GaugePressure(8e5), GaugePressure(9e5)];
    let compressor = Compressor::new([displacement, 0.0], switch, &Paper::sealed().air()).expect("a compressor");
    let rests = Muscle::of(Paper::driven(Command::Constant(Request::Hold)).isometric(3.4 * INCH).with(|it| {
        it.kind = ValveKind::FillHoldExhaust;
    }));
    let (plant, start) = on_one_tank(reservoir([volume, 1.0], gauge, Some(compressor)), None, &[rests]);
    let ledger = simulate_plant(&plant, &start, duration, 1e-10).expect("a run").ledger();
    let mass = displacement * ATMOSPHERE / (GAS_CONSTANT * ROOM) * duration;
    assert_close(ledger.nodes[TANK].air_gain, mass, 1e-9);
    assert_close(ledger.nodes[0].supplied.mass, mass, 1e-9);
    assert_close(ledger.nodes[0].supplied.enthalpy, mass * HEAT_CAPACITY * ROOM, 1e-9);
    // At T_0 all that an ideal compressor puts in is there: ∫ R T_0 ln(P/P_0) dm with V dP = R T_0 dm.
    let (first, last) = (gauge + ATMOSPHERE, gauge + ATMOSPHERE + mass * GAS_CONSTANT * ROOM / volume);
    let put_in = volume * (worth(last) - worth(first));
    assert_close(ledger.total().compressed, put_in, 1e-8);
    assert_close(ledger.nodes[TANK].exergy_gain, put_in, 1e-8);
    assert_close(ledger.nodes[TANK].heat, -volume * (last - first), 1e-8);
    assert_closes("a compressor", &ledger, 1e-7);
}

/// A leak inwards brings what the atmosphere has: its enthalpy, at its density.
#[test]
fn a_leak_inwards_brings_the_atmospheres_enthalpy() {
    let warm = 350.0;
    let paper = Paper::driven(Command::Constant(Request::Hold))
        .isometric(3.4 * INCH)
        .process(Process::EnergyBalance { heat_transfer: 0.0, wall_temperature: ROOM })
        .gauge(-5e4)
        .with(|it| {
            it.kind = ValveKind::FillHoldExhaust;
            it.temperature = warm;
        });
    let leak = Leakage::new(2e-11).expect("a leak");
    let muscle = Muscle { leak: Some(leak), ..Muscle::of(paper.clone()) };
    let (plant, start) = on_one_tank(reservoir([1e-3, 1.0], 5e5, None), None, &[muscle]);
    let run = simulate_plant(&plant, &start, 0.5, 1e-10).expect("a run");
    let ledger = run.ledger();
    let of = &ledger.actuators[0];
    let before = (ATMOSPHERE - 5e4) * paper.actuator().volume(3.4 * INCH) / (GAS_CONSTANT * warm);
    assert!(of.air_gain > 0.05 * before, "{} of {before}", of.air_gain);
    assert_close(of.internal_energy, HEAT_CAPACITY * ROOM * of.air_gain, 1e-8);
    assert_eq!(of.heat, 0.0);
    // The flow at the start, by the law with the density outside: k (P_0² − P²)/(2 R T_0).
    let flow = 2e-11 * (ATMOSPHERE.powi(2) - (ATMOSPHERE - 5e4).powi(2)) / (2.0 * GAS_CONSTANT * ROOM);
    assert_close(run.sample(0.0).actuators[0].mass_flow, flow, 1e-10);
    assert!(of.mixed > 0.0 && ledger.total().throttled > 0.0);
    assert_within(ledger.total().leaked, 0.0, 1e-12);
    assert_closes("a leak", &ledger, 1e-7);
}

/// Nothing that is turned over is no reason to complain about rounding.
#[test]
fn of_nothing_nothing_is_left() {
    let still = Paper::sealed().gauge(3e5).isometric(3.4 * INCH);
    // A valve between equal pressures: what flows is rounding.
    let equal = Paper::driven(Command::Constant(Request::Exhaust)).isometric(3.4 * INCH);
    for (name, paper) in [("sealed", still), ("equal pressures", equal)] {
        let ledger = run_of(&paper.rig(), &paper, 0.5, 1e-8).ledger();
        for (sum, balance) in sums(&ledger) {
            assert_eq!(balance.imbalance(), 0.0, "{name}: {sum} {balance:?}");
            assert!(balance.rounding < 1e-11, "{name}: {sum} {balance:?}");
        }
    }
}

/// What a joint's ledger has is what follows from its samples: energies of the limb at the ends, and integrals over time.
#[test]
fn the_ledger_of_a_joint_follows_from_its_samples() {
    let pair = Pair::of(Paper::pwm(25.0, 0.5)).with(|pair| {
        pair.papers[1] = Paper::pwm(25.0, 0.3);
        pair.damping = 0.01;
        pair.stops.ends = [Some(-0.1), Some(0.1)];
        pair.limb.distance = 0.1;
    });
    let run = pair.run(0.4, 1e-10);
    let (ledger, joint) = (run.ledger(), *run.rig().joint());
    let (of, total) = (&ledger.mechanisms[0], ledger.total());
    let (first, last) = (run.at(0.0), run.at(0.4));
    let energy = |sample: &JointSample| joint.energy(sample.angle, sample.angular_velocity);
    assert_close(of.kinetic + of.potential, energy(&last) - energy(&first), 1e-9);
    // Trapezia over corners at every edge of a valve err by h² times the jumps of slopes, here by less than 1e-5 of the whole.
    let samples: Vec<JointSample> = run.samples(2e-5).collect();
    let integral = |of: &dyn Fn(&JointSample) -> f64| {
        samples.windows(2).map(|pair| 0.5 * (of(&pair[0]) + of(&pair[1])) * (pair[1].time - pair[0].time)).sum::<f64>()
    };
    assert_close(of.damping, integral(&|it| 0.01 * it.angular_velocity.powi(2)), 1e-5);
    assert_within(total.work, integral(&|it| it.torque * it.angular_velocity), 1e-5 * ledger.work().turnover);
    for i in 0..2 {
        let work = samples.windows(2).map(|pair| {
            let [a, b] = [0, 1].map(|k| pair[k].actuators[i]);
            (0.5 * (a.pressure.0 + b.pressure.0) - ATMOSPHERE) * (b.volume - a.volume)
        });
        assert_within(ledger.actuators[i].gas_work, work.sum(), 1e-5 * ledger.work().turnover);
        let air = last.actuators[i].air_mass - first.actuators[i].air_mass;
        assert_close(ledger.actuators[i].air_gain, air, 1e-9);
    }
    assert!(of.stops > 0.0 && of.damping > 0.0);
    assert_close(total.efficiency().expect("it draws"), total.work / total.drawn, 1e-12);
    assert_closes("joint", &ledger, 1e-7);
}

/// Hose, leak, bottle, tank, regulators, other actuators on the same supply, a tendon, a given pressure.
#[test]
fn lines_close() {
    let paper = Paper::pwm(25.0, 0.5);
    let air = paper.air();
    let hose = |kind| Hose::new(kind, [1.0, 3e-3], [1.8e-5, 293.15, 1.2], &air).expect("a hose");
    let compressor = Compressor::new([2e-4, 0.03], [GaugePressure(5e5), GaugePressure(6.5e5)], &air).expect("one");
    let tank = reservoir([2e-3, 1.0], 6e5, Some(compressor));
    let bottle = reservoir([1e-4, 1.4], 7e5, None);
    let regulator = Regulator::new(2e7, 3e3, 0.01).expect("a regulator");
    let drooping = Regulator::new(2e8, 0.0, 0.01).expect("a regulator");
    let leak = Leakage::new(2e-11).expect("a leak");
    let supply = |reservoir, regulator, count| Some(SupplyLine::new(reservoir, regulator, count).expect("a supply"));
    let lumped = Some(hose(HoseKind::Lumped));
    let cases = [
        ("lumped", Line { hose: lumped, ..Line::NONE }),
        ("distributed", Line { hose: Some(hose(HoseKind::Distributed { cells: 4 })), ..Line::NONE }),
        ("leak", Line { leakage: Some(leak), ..Line::NONE }),
        ("bottle", Line { supply: supply(Some(bottle), None, 1.0), ..Line::NONE }),
        ("bottle of three", Line { supply: supply(Some(bottle), None, 3.0), ..Line::NONE }),
        ("tank", Line { supply: supply(Some(tank), None, 1.0), ..Line::NONE }),
        ("drooping", Line { supply: supply(None, Some(drooping), 1.0), ..Line::NONE }),
        ("dead band", Line { supply: supply(Some(tank), Some(regulator), 2.0), ..Line::NONE }),
        ("all", Line { hose: lumped, leakage: Some(leak), supply: supply(Some(tank), Some(drooping), 1.0) }),
    ];
    let balance = Process::EnergyBalance { heat_transfer: 0.5, wall_temperature: 300.0 };
    for (name, line) in cases {
        for process in [Process::Isentropic, balance] {
            let paper = paper.clone().process(process);
            let rig = paper.rig().with_line(line).expect(name);
            let ledger = run_of(&rig, &paper, 0.4, 1e-8).ledger();
            assert_closes(name, &ledger, 1e-6);
            for (sum, balance) in sums(&ledger) {
                assert!(balance.imbalance() < 1e-6, "{name}: {sum} {:e} of {balance:?}", balance.imbalance());
            }
            let total = ledger.total();
            assert!(total.exhaust > 0.0 && total.throttled > 0.0 && total.mixed >= 0.0, "{name}: {total:?}");
            assert_eq!(total.others > 0.0, name.contains("three") || name.contains("dead"), "{name}: {total:?}");
        }
    }
    let tendon = SeriesTendon::new(2e4, 0.05).expect("a tendon");
    let filled = paper.clone().gauge(40.0 * PSI);
    let ledger = run_of(&filled.rig().with_tendon(tendon), &filled, 0.3, 1e-8).ledger();
    assert!(ledger.actuators[0].tendon_storage != 0.0);
    assert_closes("tendon", &ledger, 1e-6);
    let series = PressureSeries::new(&[0.0, 0.2, 0.4], &[1e5, 4e5, 2e5]).expect("a time series");
    let given = Paper::sealed().gauge(1e5);
    for process in [Process::Isentropic, Process::Isothermal, balance] {
        let given = given.clone().process(process);
        let ledger = run_of(&given.rig().with_pressure(series.clone()).expect("a rig"), &given, 0.4, 1e-8).ledger();
        assert!(ledger.actuators[0].given.mass > 0.0);
        assert_closes("given", &ledger, 1e-6);
    }
}

/// A tank with a compressor, a regulator and a muscle that stands for three is the plant of three muscles: its efficiency is theirs, and
/// the muscle's share of their air a third.
#[test]
fn actuators_alike_have_the_efficiency_of_the_plant_written_out() {
    let air = Paper::sealed().air();
    let compressor = Compressor::new([1e-3, 0.0], [GaugePressure(5.5e5), GaugePressure(6.05e5)], &air).expect("one");
    let tank = reservoir([1e-4, 1.3], 6e5, Some(compressor));
    let muscle = |copies| Muscle { copies, ..Muscle::of(Paper::pwm(12.0, 0.4).mass(4.0)) };
    for regulator in [None, Some(Regulator::new(1e7, 2e3, 0.01).expect("a regulator"))] {
        let ledger_of = |muscles: &[Muscle]| {
            let (plant, start) = on_one_tank(tank, regulator, muscles);
            simulate_plant(&plant, &start, 0.4, 1e-9).expect("a run").ledger()
        };
        let (one, three) = (ledger_of(&[muscle(3.0)]), ledger_of(&[muscle(1.0), muscle(1.0), muscle(1.0)]));
        let [alike, all] = [&one, &three].map(|ledger| ledger.total());
        assert!(alike.compressed > 0.0 && alike.others > 0.0 && all.others == 0.0 && alike.work != 0.0, "{alike:?}");
        assert_close(alike.efficiency().expect("it draws"), all.efficiency().expect("they draw"), 1e-5);
        assert_close(alike.efficiency().expect("it draws"), 3.0 * alike.work / alike.compressed, 1e-9);
        assert_close(one.air_used(), three.air_used() / 3.0, 1e-5);
    }
}

/// What comes in at a given pressure is used, and what goes out there is not given back: in an isothermal chamber of a constant volume
/// `V ΔP/(R T)` of the rise. Behind a hose it is what the muscle gains.
#[test]
fn air_that_comes_in_at_a_given_pressure_is_used() {
    let paper = Paper::sealed().gauge(1e5).isometric(3.4 * INCH).process(Process::Isothermal);
    let ledger_of = |rig: &Rig| run_of(rig, &paper, 0.4, 1e-9).ledger();
    let volume: f64 = paper.actuator().volume(3.4 * INCH);
    let series = PressureSeries::new(&[0.0, 0.2, 0.4], &[1e5, 4e5, 2e5]).expect("a time series");
    let ledger = ledger_of(&paper.rig().with_pressure(series).expect("a rig"));
    assert!(ledger.has_given_pressure());
    assert_close(ledger.air_used(), 3e5 * volume / (GAS_CONSTANT * ROOM), 1e-8);
    assert_close(ledger.actuators[0].given.mass, 1e5 * volume / (GAS_CONSTANT * ROOM), 1e-8);
    let hose = Hose::new(HoseKind::Lumped, [1.0, 3e-3], [1.8e-5, ROOM, 1.2], &paper.air()).expect("a hose");
    let line = Line { hose: Some(hose), ..Line::NONE };
    for (gauges, both_ways) in [([1e5, 4e5, 4e5], false), ([1e5, 4e5, 2e5], true)] {
        let series = PressureSeries::new(&[0.0, 0.2, 0.4], &gauges).expect("a time series");
        let rig = paper.rig().with_pressure(series).and_then(|rig| rig.with_line(line)).expect("a rig");
        let ledger = ledger_of(&rig);
        let gained = ledger.actuators[0].air_gain + ledger.nodes.iter().map(|of| of.air_gain).sum::<f64>();
        if both_ways {
            assert!(ledger.air_used() > 1.5 * gained && gained > 0.0, "{} of {gained}", ledger.air_used());
        } else {
            assert_close(ledger.air_used(), gained, 1e-5);
        }
    }
    let sealed = ledger_of(&paper.rig());
    assert!(!sealed.has_given_pressure() && sealed.air_used().to_bits() == 0, "no air, and no −0");
}

/// By long fixed steps flows between equal pressures are integrated badly. What comes from a bottle is even so what that lost, and
/// of a muscle that stands for three a third.
#[test]
fn air_from_a_bottle_is_what_that_lost() {
    use mckibben::plant::TimeStepping;
    use mckibben::simulation::Method;
    let two_way = (ValveKind::TwoWay, Request::Hold);
    let three_way = (ValveKind::ThreeWay, Request::Exhaust);
    for ((kind, off), copies) in [(two_way, 1.0), (two_way, 3.0), (three_way, 1.0)] {
        let command = Command::pwm(17.0, 0.5, Request::Fill, off).expect("a command");
        let paper = Paper::driven(command).isometric(3.5 * INCH).process(Process::Isothermal).with(|it| it.kind = kind);
        let hose = Hose::new(HoseKind::Lumped, [1.0, 2e-3], [1.8e-5, ROOM, 1.0], &paper.air()).expect("a hose");
        let muscle = Muscle { hose: Some(hose), copies, ..Muscle::of(paper) };
        let (plant, start) = on_one_tank(reservoir([5e-5, 1.0], 4e5, None), None, &[muscle]);
        let how = TimeStepping::Fixed { method: Method::Stable, step: 5e-3 };
        let ledger = simulate_plant(&plant, &start, 0.5, how).expect("a run").ledger();
        let lost = -ledger.nodes[TANK].air_gain / copies;
        assert_close(ledger.air_used(), lost, 1e-9);
        let integral = -ledger.nodes[TANK].air_in / copies;
        assert!((integral / lost - 1.0).abs() > 1e-3, "{integral} is as good as {lost}");
    }
}

/// An end on a tendon without much viscous friction: its velocity follows from a balance of stiff forces, and errs by much more than its
/// length in long steps. The ledger goes by the length, and so has the work of located events.
#[test]
fn long_steps_on_a_tendon_keep_the_ledger() {
    use mckibben::plant::TimeStepping;
    use mckibben::simulation::Method;
    let tendon = SeriesTendon::new(6e4, 0.05).expect("a tendon");
    let requests = vec![Request::Fill, Request::Hold, Request::Exhaust];
    let command = Command::table(vec![0.0, 0.1, 0.2], requests).expect("a command");
    for viscous in [1.0, 20.0] {
        for process in [Process::Isentropic, Process::Isothermal] {
            let paper =
                Paper::driven(command.clone()).gauge(2e5).process(process).friction(viscous, 0.0).with(|paper| {
                    paper.kind = ValveKind::FillHoldExhaust;
                    paper.standard = FlowStandard::Orifice { flow_area: 3e-7 };
                });
            let rig = paper.rig().with_tendon(tendon);
            let start = rig.start(&paper.initial()).expect("a start");
            let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &start));
            let ledger_of = |how: TimeStepping| simulate_plant(&plant, &start, 0.35, how).expect("a run").ledger();
            let exact = ledger_of(1e-9.into());
            let steps = ledger_of(TimeStepping::Fixed { method: Method::Stable, step: 5e-4 });
            let [ours, theirs] = [&steps, &exact].map(|ledger| ledger.actuators[0].gas_work);
            assert!((ours - theirs).abs() < 0.05 * theirs.abs(), "{viscous} {process:?}: {ours} for {theirs}");
            for (name, balance) in sums(&steps) {
                assert!(balance.imbalance() < 0.02, "{viscous} {process:?}: {name} leaves {balance:?}");
            }
        }
    }
}

/// A proportional pressure regulator draws what it needs from its supply and lets go to the atmosphere what comes back.
#[test]
fn a_pressure_regulator_closes() {
    let regulator = mckibben::valve::Regulator::new(0.03, 5e-3, 2e6).expect("a regulator");
    let command = Command::set_points(vec![0.0, 0.2, 0.4], vec![4e5, 1e5, 3e5]).expect("set points");
    let paper =
        Paper::driven(command.clone()).process(Process::EnergyBalance { heat_transfer: 0.3, wall_temperature: 300.0 });
    let actuation = Actuation { solenoid: Solenoid::regulating(regulator), command };
    let rig = Rig::new(paper.actuator(), Some(actuation), paper.load.clone()).expect("a rig");
    let ledger = run_of(&rig, &paper, 0.6, 1e-10).ledger();
    let total = ledger.total();
    assert!(total.drawn > 0.0 && total.stored > 0.0);
    assert!(total.exhaust > 0.0 && ledger.nodes.iter().any(|of| of.released > 0.0 && of.throttled > 0.0));
    // What it drew is what it let go besides what the muscle keeps.
    let port = ledger.nodes.iter().find(|of| of.vented > 0.0).expect("a port");
    assert!(port.supplied.mass + port.vented > 1.5 * port.supplied.mass, "{port:?}");
    assert_close(port.supplied.mass, ledger.actuators[0].air_gain, 1e-6);
    assert_closes("a regulator", &ledger, 1e-7);
}

#[test]
fn unlike_muscles_on_one_tank_close() {
    for seed in 0..24 {
        let (plant, start) = unlike_muscles_on_one_tank(seed);
        let run = simulate_plant(&plant, &start, 0.3, 1e-8).unwrap_or_else(|error| panic!("{seed}: {error}"));
        let ledger = run.ledger();
        assert_closes(&format!("seed {seed}"), &ledger, 1e-6);
        let parts: f64 = ledger.actuators.iter().map(|of| of.gas_work).sum();
        assert_eq!(parts, ledger.total().gas_work);
        for (m, members) in plant.indices().members.iter().enumerate() {
            let allowed = 1e-6 * ledger.work().turnover;
            assert_within(ledger.mechanism_residual(m, members), 0.0, allowed);
        }
    }
}

#[test]
fn a_leg_on_its_belt_closes() {
    let (plant, start) = leg_on_its_belt(&Paper::sealed());
    let ledger = simulate_plant(&plant, &start, 1.0, 1e-8).expect("a run").ledger();
    let of = &ledger.mechanisms[0];
    assert!(of.belt > 0.0 && of.damping > 0.0 && of.belt_work != 0.0, "{of:?}");
    assert!(of.stops >= 0.0);
    for (sum, balance) in sums(&ledger) {
        assert!(balance.imbalance() < 1e-6, "{sum} {:e} of {balance:?}", balance.imbalance());
    }
}

/// Cases that are tried when `MCKIBBEN_CASES` is not set.
const CASES: u32 = 120;

/// What random plants leave.
#[derive(Default)]
struct Left {
    ran: usize,
    /// How many leave more than 1e-6 of the turnover beyond rounding, sum by sum.
    open: [usize; 4],
}

impl Left {
    fn add(&mut self, run: Result<PlantTrajectory, Error>) -> Result<(), TestCaseError> {
        let run = match run {
            Err(Error::Stopped { reason, .. }) if reason.ends_with("straight") => return Ok(()),
            other => other.map_err(|error| TestCaseError::fail(error.to_string()))?,
        };
        let ledger = run.ledger();
        self.ran += 1;
        for ((sum, balance), open) in sums(&ledger).into_iter().zip(&mut self.open) {
            let numbers = [balance.residual, balance.turnover, balance.rounding, balance.resolution];
            prop_assert!(numbers.iter().all(|number| number.is_finite()), "{sum}: {balance:?}");
            prop_assert!(balance.closes(1e-6), "{sum}: {balance:?} of {ledger:?}");
            *open += usize::from(balance.imbalance() > 1e-6);
        }
        prop_assert!(ledger.total().mixed >= 0.0);
        Ok(())
    }

    /// Where next to nothing is turned over, the tolerance leaves a larger part of it.
    fn report(&self, what: &str) {
        let Self { ran, open } = self;
        println!("{what}: of {ran} leave more than 1e-6 of the turnover of work, energy, exergy and air {open:?}");
        assert!(*ran > CASES as usize / 2);
        for (open, most) in open.iter().zip([0.01, 0.04, 0.02, 0.06]) {
            assert!(*open as f64 <= most * *ran as f64, "{what}: {:?} of {ran}", self.open);
        }
    }
}

#[test]
fn random_rigs_close() {
    let left = std::cell::RefCell::new(Left::default());
    let result = runner(CASES).run(&random::cases(), |case| {
        let rig = case.paper.rig();
        let Ok(start) = rig.start(&case.paper.initial()) else { return Ok(()) };
        let plant = Plant::of_rig(&rig);
        left.borrow_mut().add(simulate_plant(&plant, &Plant::start_of_rig(&rig, &start), case.duration, 1e-8))
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    left.borrow().report("rigs");
}

#[test]
fn random_joints_close() {
    let left = std::cell::RefCell::new(Left::default());
    let result = runner(CASES).run(&pairs(), |(pair, duration, _)| {
        let Ok(rig) = pair.rig() else { return Ok(()) };
        let Ok(start) = rig.start(&pair.initial()) else { return Ok(()) };
        let plant = Plant::of_joint(&rig).expect("a plant");
        left.borrow_mut().add(simulate_plant(&plant, &Plant::start_of_joint(&rig, &start), duration, 1e-8))
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    left.borrow().report("joints");
}
