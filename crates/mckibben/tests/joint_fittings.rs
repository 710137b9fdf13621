//! A joint whose actuators have air lines, tendons and given pressures: its energy closes, its balance is one, its stiffness is
//! the slope of its torque, its derivatives are those of differences, and its events name whose they are.

use crate::common::joint::Pair;
use crate::common::{PSI, Paper, assert_close, assert_within};
use mckibben::Scalar as _;
use mckibben::air::Process;
use mckibben::control::Held;
use mckibben::line::{Compressor, Hose, HoseKind, Leakage, Line, Regulator, Reservoir, SupplyLine};

use mckibben::load::{MomentArm, SeriesTendon, Tendon};
use mckibben::mechanism::Contact;
use mckibben::plant::{JointPlant, JointTrajectory, TimeStepping};
use mckibben::simulation::{
    EventKind, Fittings, InitialAngle, JointInitial, JointRig, JointSupply, Method, PressureSeries,
};
use mckibben::valve::{Command, Request};
use mckibben::{AbsolutePressure, Error, GaugePressure, parameter};

const ROOM: f64 = 293.15;

fn hose(kind: HoseKind, length: f64) -> Line {
    let gas = [1.82e-5, ROOM, 1.0];
    let hose = Hose::new(kind, [length, 2.5e-3], gas, &Paper::sealed().air()).expect("a hose");
    Line { hose: Some(hose), ..Line::NONE }
}

fn tank(volume: f64, compressor: bool) -> Reservoir {
    let air = Paper::sealed().air();
    let compressor = compressor.then(|| {
        let switch = [95.0 * PSI, 105.0 * PSI].map(GaugePressure);
        Compressor::new([5e-3, 0.05], switch, &air).expect("a compressor")
    });
    Reservoir::new([volume, 1.2, ROOM], GaugePressure(100.0 * PSI), compressor, &air).expect("a tank")
}

fn supply(reservoir: Option<Reservoir>, regulated: bool) -> Line {
    let regulator = regulated.then(|| Regulator::new(2e7, 2e3, 0.02).expect("a regulator"));
    Line { supply: Some(SupplyLine::new(reservoir, regulator, 1.0).expect("a supply")), ..Line::NONE }
}

fn with_line(line: Line) -> Fittings {
    Fittings { line, ..Fittings::NONE }
}

fn on_tendon(stiffness: f64, line: Line) -> Fittings {
    Fittings { line, tendon: Some(SeriesTendon::new(stiffness, 0.03).expect("a tendon")), pressure: None }
}

fn given(gauges: [f64; 3], tendon: Option<SeriesTendon>) -> Fittings {
    let pressure = PressureSeries::new(&[0.0, 0.1, 0.3], &gauges).expect("a time series");
    Fittings { line: Line::NONE, tendon, pressure: Some(pressure) }
}

/// A joint of two pulsed muscles with a limb that hangs beside its axis.
fn pulsed() -> Pair {
    let pulses = |frequency, duty| Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("pulses");
    Pair::of(Paper::driven(pulses(10.0, 0.6)).friction(3.0, 1e-4).gauge(20.0 * PSI)).with(|pair| {
        pair.papers[1].command = Some(pulses(7.0, 0.3));
        (pair.limb.distance, pair.damping) = (0.1, 5e-3);
        pair.angle = InitialAngle::At(0.1);
    })
}

/// A pulsed pair on tendons, which take 30 mm more.
fn pulsed_on_tendons() -> Pair {
    pulsed().with(|pair| pair.tendons.iter_mut().for_each(|over| over.rest_length += 0.03))
}

fn fitted(pair: &Pair, fittings: [Fittings; 2], supply: JointSupply) -> Result<JointRig, Error> {
    let rig = pair.with_rest_only().rig()?;
    let bare = pair.clone();
    let joint = mckibben::load::Joint::new(bare.limb, bare.tendons, bare.torque, bare.damping, bare.stops)?;
    JointRig::fitted(rig.driven().clone(), joint, fittings, supply)
}

trait RestOnly {
    fn with_rest_only(&self) -> Pair;
}

impl RestOnly for Pair {
    /// With a place over the joint that suits a muscle without a tendon: only its actuators are wanted.
    fn with_rest_only(&self) -> Pair {
        let pulley = Tendon { arm: MomentArm::Pulley(0.015), rest_length: 0.082 };
        self.clone().with(|pair| pair.tendons = [pulley; 2])
    }
}

fn sealed(pair: Pair) -> Pair {
    pair.with(|pair| {
        for paper in &mut pair.papers {
            paper.command = None;
        }
    })
}

fn run(pair: &Pair, fittings: [Fittings; 2], supply: JointSupply, duration: f64, tolerance: f64) -> JointTrajectory {
    let rig = fitted(pair, fittings, supply).expect("a rig");
    let start = rig.start(&pair.initial()).expect("a start");
    JointPlant::new(&rig).expect("a plant").simulate(&start, duration, tolerance).expect("the run reaches its end")
}

#[test]
fn energy_and_exergy_close_with_every_fitting() {
    use JointSupply::{Separate, Shared};
    let lumped = || hose(HoseKind::Lumped, 1.0);
    let leak = || Line { leakage: Some(Leakage::new(2e-11).expect("a leak")), ..Line::NONE };
    let all = |line: Line| Line { supply: line.supply, leakage: leak().leakage, ..lumped() };
    let own = |line: Line| [with_line(line), with_line(line)];
    let of_both = |line: Line| [with_line(line), with_line(Line { supply: None, ..line })];
    let (bare, tendons) = (pulsed(), pulsed_on_tendons());
    let cases: Vec<(&str, &Pair, [Fittings; 2], JointSupply)> = vec![
        ("hoses", &bare, own(lumped()), Separate),
        ("unlike hoses", &bare, [with_line(lumped()), with_line(hose(HoseKind::Lumped, 2.0))], Separate),
        ("waves", &bare, own(hose(HoseKind::Distributed { cells: 3 }, 1.0)), Separate),
        ("leaks", &bare, own(leak()), Separate),
        ("two tanks", &bare, own(supply(Some(tank(5e-4, false)), false)), Separate),
        ("one tank", &bare, of_both(supply(Some(tank(5e-4, false)), false)), Shared),
        ("one regulator", &bare, of_both(supply(None, true)), Shared),
        (
            "tank, compressor, regulator, hoses, leaks",
            &bare,
            of_both(all(supply(Some(tank(5e-4, true)), true))),
            Shared,
        ),
        ("tendons", &tendons, [on_tendon(2e4, Line::NONE), on_tendon(8e3, Line::NONE)], Separate),
        ("tendons and hoses", &tendons, [on_tendon(2e4, lumped()), on_tendon(8e3, lumped())], Separate),
    ];
    for (name, pair, fittings, supply) in cases {
        let ledger = run(pair, fittings, supply, 0.4, 1e-8).ledger();
        for (sum, of) in [("work", ledger.work()), ("exergy", ledger.exergy())] {
            assert!(of.turnover > 0.1, "{name}: {sum} turns over {} J", of.turnover);
            assert_within(of.residual, 0.0, 1e-6 * of.turnover);
        }
    }
}

#[test]
fn energy_closes_under_given_pressures() {
    let pair = sealed(pulsed());
    for process in [Process::Isentropic, Process::Isothermal] {
        let pair = pair.clone().with(|pair| pair.papers.iter_mut().for_each(|paper| paper.process = process));
        let fittings = [given([1e5, 3e5, 2e5], None), given([1.5e5, 1.5e5, 3e5], None)];
        let made = run(&pair, fittings, JointSupply::Separate, 0.4, 1e-8);
        let work = made.ledger().work();
        assert_within(work.residual, 0.0, 1e-6 * work.turnover);
        let gauge = |time: f64| made.at(time).actuators.map(|of| of.pressure.0 - 101_325.0);
        assert_within(gauge(0.05)[0], 2e5, 1e-3);
        assert_within(gauge(0.2)[1], 2.25e5, 1e-3);
        let corners = made.events().iter().filter(|event| event.kind.kind == EventKind::Corner);
        let mut whose: Vec<_> = corners.map(|event| event.kind.actuator).collect();
        whose.sort_unstable();
        assert_eq!(whose, [Some(0), Some(0), Some(1), Some(1)]);
    }
}

#[test]
fn energy_closes_under_given_pressures_on_tendons() {
    let tendon = |stiffness| Some(SeriesTendon::new(stiffness, 0.03).expect("a tendon"));
    for (viscous, width) in [(0.0, 0.0), (0.0, 1e-4), (3.0, 1e-4)] {
        let pair = sealed(pulsed_on_tendons())
            .with(|pair| pair.papers.iter_mut().for_each(|paper| *paper = paper.clone().friction(viscous, width)));
        let fittings = [given([1e5, 3e5, 2e5], tendon(2e4)), given([1.5e5, 1.5e5, 3e5], tendon(8e3))];
        let made = run(&pair, fittings, JointSupply::Separate, 0.4, 1e-8);
        let work = made.ledger().work();
        assert!(work.turnover > 0.1, "{work:?}");
        assert_within(work.residual, 0.0, 1e-6 * work.turnover);
        assert_within(made.at(0.25).actuators[0].pressure.0, 2.25e5 + 101_325.0, 1e-3);
    }
}

/// A joint on tendons that begins in its balance, sealed and without friction, stays there.
#[test]
fn a_balance_on_tendons_lasts() {
    for (pressures, arm) in [([30.0, 45.0], false), ([60.0, 25.0], true)] {
        let pair = sealed(pulsed_on_tendons()).with(|pair| {
            for (paper, gauge) in pair.papers.iter_mut().zip(pressures) {
                (paper.gauge, paper.coulomb_width) = (gauge * PSI, 0.0);
            }
            if arm {
                let table = MomentArm::table(&[-0.5, 0.0, 0.5], &[0.013, 0.015, 0.018]).expect("an arm");
                pair.tendons[0].arm = table;
            }
            pair.angle = InitialAngle::Equilibrium;
        });
        let made =
            run(&pair, [on_tendon(2e4, Line::NONE), on_tendon(8e3, Line::NONE)], JointSupply::Separate, 0.3, 1e-9);
        let start = made.at(0.0);
        assert!(start.angle.abs() > 0.02, "{}", start.angle);
        for sample in made.samples(0.01) {
            assert_within(sample.angle, start.angle, 1e-9);
            assert_within(sample.angular_velocity, 0.0, 1e-7);
        }
        // Actuator and tendon pull alike.
        for (of, stiffness) in start.actuators.iter().zip([2e4, 8e3]) {
            assert_close(of.tension, stiffness * (of.load_distance - of.length - 0.03), 1e-9);
        }
    }
}

#[test]
fn the_stiffness_on_tendons_is_the_slope_of_the_torque() {
    let pair = sealed(pulsed_on_tendons()).with(|pair| {
        for (paper, gauge) in pair.papers.iter_mut().zip([40.0, 55.0]) {
            (paper.gauge, paper.coulomb_width) = (gauge * PSI, 0.0);
        }
    });
    let rig =
        fitted(&pair, [on_tendon(2e4, Line::NONE), on_tendon(8e3, Line::NONE)], JointSupply::Separate).expect("a rig");
    let plant = JointPlant::new(&rig).expect("a plant");
    let torque = |angle: f64| {
        let initial = JointInitial { angle: InitialAngle::At(angle), ..pair.initial() };
        let start = rig.start(&initial).expect("a start");
        plant.simulate(&start, 1e-6, 1e-9).expect("a run").at(0.0).torque
    };
    let (angle, step) = (0.05, 1e-4);
    let slope = (torque(angle + step) - torque(angle - step)) / (2.0 * step);
    let pressure = [40.0, 55.0].map(|gauge| GaugePressure(gauge * PSI).absolute(AbsolutePressure(101_325.0)));
    assert_close(rig.stiffness(angle, pressure, Held::Pressures), -slope, 1e-6);
}

#[test]
fn derivatives_by_numbers_of_the_fittings_are_those_of_differences() {
    let pair = pulsed_on_tendons().with(|pair| {
        pair.papers.iter_mut().for_each(|paper| paper.coulomb_width = 0.0);
        pair.angle = InitialAngle::Equilibrium;
    });
    let line = Line { supply: supply(Some(tank(5e-4, false)), false).supply, ..hose(HoseKind::Lumped, 1.0) };
    let fittings = [on_tendon(2e4, line), on_tendon(8e3, Line { supply: None, ..line })];
    let rig = fitted(&pair, fittings, JointSupply::Shared).expect("a rig");
    let end = |rig: &JointRig| {
        let start = rig.start(&pair.initial()).expect("a start");
        JointPlant::new(rig).and_then(|plant| plant.simulate(&start, 0.08, 1e-11)).expect("a run").at(0.08).angle
    };
    for (row, whose) in [
        (&parameter::HOSE_LENGTH, 0),
        (&parameter::HOSE_DIAMETER, 1),
        (&parameter::TENDON_STIFFNESS, 1),
        (&parameter::TENDON_REST_LENGTH, 0),
        (&parameter::RESERVOIR_VOLUME, 0),
    ] {
        let scaled = |by: f64| {
            let change = |i, parameter: &'static parameter::Parameter, value: f64| {
                if i == Some(whose) && parameter.key == row.key { value * (1.0 + by) } else { value }
            };
            end(&rig.map_of_each(change))
        };
        let difference = (scaled(1e-5) - scaled(-1e-5)) / 2e-5;
        let seeded: JointRig<mckibben::Seeded> = rig.map_of_each(|i, parameter, value| {
            let seed = if i == Some(whose) && parameter.key == row.key { value } else { 0.0 };
            crate::common::toward(value, seed)
        });
        let initial = pair.initial().map_of_each(|_, _, value| mckibben::Seeded::constant(value));
        let start = seeded.begin(&initial).expect("a start");
        let run = JointPlant::new(&seeded)
            .and_then(|plant| plant.simulate(&start, mckibben::Seeded::constant(0.08), 1e-11))
            .expect("a run");
        let exact = run.at(mckibben::Seeded::constant(0.08)).angle.slope[0];
        assert!(exact.abs() > 1e-6, "{}: {exact}", row.key);
        assert_within(exact, difference, 2e-4 * exact.abs() + 1e-7);
    }
}

#[test]
fn events_of_a_supply_of_both_are_of_neither() {
    let line = supply(Some(tank(3e-4, true)), true);
    let shared = [with_line(line), with_line(Line { supply: None, ..line })];
    let of_supply = |made: &JointTrajectory| {
        let events = made.events().iter().filter(|event| event.kind.kind == EventKind::Compressor);
        events.map(|event| event.kind.actuator).collect::<Vec<_>>()
    };
    let made = run(&pulsed(), shared, JointSupply::Shared, 0.5, 1e-8);
    let events = of_supply(&made);
    assert!(!events.is_empty() && events.iter().all(Option::is_none), "{events:?}");
    let [first, second] = made.at(0.3).actuators.map(|of| of.supply_pressure.expect("a tank").0);
    assert_close(first, second, 1e-15);
    let apart = run(&pulsed(), [with_line(line), with_line(line)], JointSupply::Separate, 0.5, 1e-8);
    let events = of_supply(&apart);
    assert!(!events.is_empty() && events.iter().all(Option::is_some), "{events:?}");
    assert_eq!(apart.events()[0].after.stops, [Contact::None; 2]);
}

#[test]
fn what_does_not_fit_is_refused() {
    use JointSupply::{Separate, Shared};
    let error_of = |pair: &Pair, fittings: [Fittings; 2], supply| match fitted(pair, fittings, supply) {
        Ok(_) => panic!("taken"),
        Err(error) => error.to_string(),
    };
    let (line, bare) = (supply(Some(tank(1e-3, false)), false), || Fittings::NONE);
    let two = error_of(&pulsed(), [with_line(line), with_line(line)], Shared);
    assert!(two.contains("one supply feeds both"), "{two}");
    let none = error_of(&sealed(pulsed()), [with_line(line), bare()], Shared);
    assert!(none.contains("neither actuator of the joint has a valve"), "{none}");
    let hose = error_of(&sealed(pulsed()), [with_line(hose(HoseKind::Lumped, 1.0)), bare()], Separate);
    assert!(hose.contains("has no valve"), "{hose}");
    let valve = error_of(&pulsed(), [given([1e5, 2e5, 3e5], None), bare()], Separate);
    assert!(valve.contains("a valve or a leak would change it"), "{valve}");
    let vacuum = error_of(&sealed(pulsed()), [given([1e5, -2e5, 3e5], None), bare()], Separate);
    assert!(vacuum.contains("vacuum"), "{vacuum}");
}

/// A joint with a reservoir goes by fixed steps as by the other engine, nearer by the order of the method with shorter steps.
#[test]
fn it_goes_by_fixed_steps_too() {
    let fittings = [with_line(supply(Some(tank(5e-4, false)), false)), Fittings::NONE];
    let rig = fitted(&pulsed(), fittings, JointSupply::Separate).expect("a rig");
    let start = rig.start(&pulsed().initial()).expect("a start");
    let of = JointPlant::new(&rig).expect("a plant");
    let exact = of.simulate(&start, 0.2, 1e-11).expect("a run").at(0.2).angle;
    let off = |step: f64| {
        let fixed = TimeStepping::Fixed { method: Method::Stable, step };
        (of.simulate(&start, 0.2, fixed).expect("a run").at(0.2).angle - exact).abs()
    };
    let (coarse, fine) = (off(1e-4), off(2.5e-5));
    assert!(coarse < 1e-3 && fine < coarse / 6.0, "{coarse:e} {fine:e}");
}
