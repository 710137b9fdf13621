//! Several unlike actuators on one supply, in a loop of one's own.

use crate::common;
use crate::leg::free;
use common::accounts::Audited;
use common::{ATMOSPHERE, INCH, PSI, Paper, ROOM, assert_close, between};
use mckibben::air::Process;
use mckibben::control::Drive;
use mckibben::line::{Compressor, Hose, HoseKind, Leakage, Line, Regulator, Reservoir, SupplyLine};
use mckibben::load::leg::{LegState, Range, STRANDS};
use mckibben::simulation::{Actuation, LegStepper, Manifold, ModularActuator, Rig, simulate};
use mckibben::valve::{Command, Ramp, Request, Solenoid, Supply, ValveKind};
use mckibben::{AbsolutePressure, Error, GaugePressure};

const GAS: f64 = 286.99;
const FREQUENCY: f64 = 25.0;
const SUPPLY: f64 = 100.0 * PSI;
const FILL: Drive = Drive::Steady(Request::Fill);

fn pulses(duty: f64) -> Drive {
    Drive::Pulses { duty, pulse: Request::Fill, rest: Request::Exhaust }
}

fn bottle(volume: f64) -> Reservoir {
    filled(volume, SUPPLY, None)
}

fn filled(volume: f64, gauge: f64, compressor: Option<Compressor>) -> Reservoir {
    Reservoir::new([volume, 1.0, ROOM], GaugePressure(gauge), compressor, &Paper::sealed().air()).expect("a reservoir")
}

fn compressor(displacement: f64, cut_in: f64, cut_out: f64) -> Compressor {
    let switch = [GaugePressure(cut_in), GaugePressure(cut_out)];
    Compressor::new([displacement, 0.0], switch, &Paper::sealed().air()).expect("a compressor")
}

fn supply() -> Supply {
    Paper::sealed().valve().supply
}

fn manifold(reservoir: Option<Reservoir>, regulator: Option<Regulator>) -> Manifold {
    let line = SupplyLine::new(reservoir, regulator, 1.0).expect("a supply");
    Manifold::new(&line, &supply()).expect("a manifold")
}

/// An actuator at 3.5 in whose valve is a part of the paper's, beside so much volume in m³.
fn held(share: f64, external_volume: f64) -> Paper {
    Paper::driven(Command::Constant(Request::Exhaust)).isometric(3.5 * INCH).with(|rig| {
        rig.efficiency *= share;
        rig.external_volume = external_volume;
    })
}

fn modular(paper: &Paper, drive: Drive) -> ModularActuator {
    driven(&paper.rig(), paper, drive)
}

fn driven(rig: &Rig, paper: &Paper, drive: Drive) -> ModularActuator {
    let mut actuator = ModularActuator::new(rig, paper.start(), FREQUENCY).expect("an actuator");
    actuator.drive(drive).expect("something to do");
    actuator
}

/// Keeps the ends at 3.5 in; `watch` sees every step.
fn run(
    manifold: &mut Manifold,
    actuators: &mut [ModularActuator],
    (duration, steps): (f64, u32),
    mut watch: impl FnMut(&Manifold, &[ModularActuator]),
) {
    manifold.feed(actuators).expect("valves");
    for count in 1..=steps {
        let until = duration * f64::from(count) / f64::from(steps);
        for actuator in actuators.iter_mut() {
            actuator.move_to(until, 3.5 * INCH).expect("a step");
        }
        manifold.serve(until, actuators).expect("a step");
        watch(manifold, actuators);
    }
}

/// A hose, a leak and seats that take their time: every way in which the account is kept.
fn plumbed(paper: &Paper) -> Rig {
    let hose = Hose::new(HoseKind::Lumped, [0.5, 2e-3], [1.81e-5, ROOM, 1.0], &paper.air()).expect("a hose");
    let leakage = Leakage::new(1e-12).expect("a leak");
    let line = Line { hose: Some(hose), leakage: Some(leakage), ..Line::NONE };
    ramped(paper).with_line(line).expect("a line")
}

fn ramped(paper: &Paper) -> Rig {
    let solenoid = Solenoid::new(ValveKind::ThreeWay, 4e-3, 1e-3).expect("a solenoid");
    let solenoid = solenoid.with_ramp(Ramp::new(6e-3, 3e-3).expect("a ramp"));
    let command = Command::pwm(FREQUENCY, 0.5, Request::Fill, Request::Exhaust).expect("a command");
    Rig::new(paper.actuator(), Some(Actuation { solenoid, command }), paper.load.clone()).expect("a rig")
}

#[test]
fn no_air_is_lost_between_reservoir_actuators_and_surroundings() {
    let papers = [held(1.0, 3e-6), held(4.0, 2e-5), held(0.5, 1e-5)];
    let rigs = [papers[0].rig(), ramped(&papers[1]), plumbed(&papers[2])];
    let mut actuators: Vec<_> = rigs
        .iter()
        .zip(&papers)
        .zip([0.3, 0.5, 0.7])
        .map(|((rig, paper), duty)| driven(rig, paper, pulses(duty)))
        .collect();
    let tank = filled(2e-4, 5e5, Some(compressor(5e-3, 4e5, 5.5e5)));
    let mut manifold = manifold(Some(tank), None);
    let here = |manifold: &Manifold, actuators: &[ModularActuator]| {
        manifold.content().expect("a tank") + actuators.iter().map(ModularActuator::content).sum::<f64>()
    };
    let begin = here(&manifold, &actuators);
    let [mut exhausted, mut delivered, mut switches] = [0.0; 3];
    let mut runs = manifold.state().compressor_runs;
    run(&mut manifold, &mut actuators, (1.0, 700), |manifold, actuators| {
        exhausted += actuators.iter().map(ModularActuator::exhausted).sum::<f64>();
        delivered += manifold.state().delivered;
        switches += f64::from(u8::from(runs != manifold.state().compressor_runs));
        runs = manifold.state().compressor_runs;
        assert_close(here(manifold, actuators) + exhausted, begin + delivered, 1e-13);
    });
    assert!(exhausted > 0.1 * begin && delivered > 0.1 * begin && switches > 0.0, "{exhausted} {delivered} {switches}");
}

/// The account of a step is its method's: of second order in what the event-located run counts.
#[test]
fn what_it_draws_and_exhausts_is_what_flows_in_the_event_located_run() {
    let paper = held(1.0, 3e-6).with(|rig| {
        rig.command = Some(Command::pwm(FREQUENCY, 0.5, Request::Fill, Request::Exhaust).expect("a command"));
    });
    let leakage = Some(Leakage::new(1e-12).expect("a leak"));
    let leaky = paper.rig().with_line(Line { leakage, ..Line::NONE }).expect("a line");
    for rig in [paper.rig(), leaky, ramped(&paper), plumbed(&paper)] {
        let audit = simulate(&rig, paper.start(), 0.2, 1e-10).expect("a run").audit();
        let errors = [800, 3200, 12_800].map(|steps| {
            let [mut drawn, mut exhausted] = [0.0; 2];
            let mut actuators = [driven(&rig, &paper, pulses(0.5))];
            run(&mut manifold(None, None), &mut actuators, (0.2, steps), |_, actuators| {
                drawn += actuators[0].drawn();
                exhausted += actuators[0].exhausted();
            });
            let off = [drawn / audit.air_in - 1.0, exhausted / audit.air_out - 1.0].map(f64::abs);
            // Requests reach a modular actuator without the hose's delay: the last exhaust begins before that of the run.
            if rig.line().hose.is_some() { off[0] } else { off[0].max(off[1]) }
        });
        // Four times the steps: on the way to sixteen times less.
        assert!(errors[2] < 1e-4 && errors.windows(2).all(|pair| pair[0] > 5.0 * pair[1]), "{errors:?}");
    }
}

/// At longer steps the error of the actuators' own steps, of order 2, is the larger.
#[test]
fn two_alike_approach_the_event_located_run_with_order_one() {
    let duration = 0.1;
    let paper = held(1.0, 3e-6).with(|rig| {
        rig.command = Some(Command::pwm(FREQUENCY, 0.5, Request::Fill, Request::Exhaust).expect("a command"));
    });
    let regulator = Regulator::new(1e7, 0.0, 10e-3).expect("a regulator");
    for regulator in [None, Some(regulator)] {
        let supply = SupplyLine::new(Some(bottle(5e-5)), regulator, 2.0).expect("a supply");
        let rig = paper.rig().with_line(Line { supply: Some(supply), ..Line::NONE }).expect("a line");
        let exact = simulate(&rig, paper.start(), duration, 1e-10).expect("a run");
        let errors = [16_000, 32_000, 64_000].map(|steps| {
            let mut off = [0.0_f64; 2];
            let mut actuators = [modular(&paper, pulses(0.5)), modular(&paper, pulses(0.5))];
            run(
                &mut manifold(Some(bottle(5e-5)), regulator),
                &mut actuators,
                (duration, steps),
                |manifold, actuators| {
                    let expected = exact.at(manifold.time());
                    let outlet = expected.supply_pressure.expect("it changes").0;
                    off[0] = off[0].max((manifold.pressure().0 - outlet).abs() / outlet);
                    off[1] = off[1].max((actuators[0].state().pressure.0 / expected.pressure.0 - 1.0).abs());
                    assert_eq!(actuators[0].state(), actuators[1].state());
                },
            );
            off
        });
        for quantity in 0..2 {
            for pair in errors.windows(2) {
                let ratio = pair[0][quantity] / pair[1][quantity];
                assert!((1.8..2.2).contains(&ratio), "{ratio} of {errors:?}");
            }
        }
        assert!(errors[2][0] < 1e-5 && errors[2][1] < 1e-4, "{errors:?}");
        let sags = exact.at(duration).supply_pressure.expect("it changes").0;
        assert!(sags < 0.9 * (SUPPLY + ATMOSPHERE), "{sags} Pa");
    }
}

#[test]
fn a_reservoir_without_end_is_a_supply_of_constant_pressure() {
    let papers = [held(1.0, 3e-6), held(4.0, 2e-5)];
    let alone = papers.each_ref().map(|paper| modular(paper, pulses(0.6)));
    let [mut constant, mut endless, mut plain] = [alone.clone(), alone.clone(), alone];
    run(&mut manifold(None, None), &mut constant, (0.3, 200), |_, _| {});
    run(&mut manifold(Some(bottle(1e5)), None), &mut endless, (0.3, 200), |_, _| {});
    for count in 1..=200 {
        for actuator in &mut plain {
            actuator.move_to(0.3 * f64::from(count) / 200.0, 3.5 * INCH).expect("a step");
        }
    }
    for ((plain, constant), endless) in plain.iter().zip(&constant).zip(&endless) {
        assert_eq!(plain.state(), constant.state());
        assert_close(endless.state().pressure.0, plain.state().pressure.0, 1e-9);
        assert_close(endless.state().air_mass, plain.state().air_mass, 1e-9);
    }
}

/// At constant temperature all air comes to one pressure, `Σ P_i V_i/Σ V_i`, whatever the valves.
#[test]
fn unlike_actuators_come_to_the_pressure_of_all_air_in_all_volumes() {
    let volume = 2e-4;
    let papers = [held(1.0, 3e-6), held(4.0, 5e-5), held(0.2, 1e-5)].map(|paper| paper.process(Process::Isothermal));
    let alone = papers.each_ref().map(|paper| modular(paper, FILL));
    let volumes = alone.each_ref().map(|actuator| actuator.sample().volume);
    let all: f64 = volumes.iter().sum();
    let expected = ((SUPPLY + ATMOSPHERE) * volume + ATMOSPHERE * all) / (volume + all);
    let errors = [1500, 3000, 6000].map(|steps| {
        let (mut manifold, mut actuators) = (manifold(Some(bottle(volume)), None), alone.clone());
        run(&mut manifold, &mut actuators, (3.0, steps), |_, _| {});
        for actuator in &actuators {
            assert_close(actuator.state().pressure.0, manifold.pressure().0, 1e-12);
        }
        (manifold.pressure().0 / expected - 1.0).abs()
    });
    // The pressure follows the mass with the order of the step, which is 2.
    assert!(errors[2] < 1e-6 && errors.windows(2).all(|pair| pair[0] > 3.0 * pair[1]), "{errors:?}");
    assert!(expected < 0.8 * (SUPPLY + ATMOSPHERE));
}

#[test]
fn a_large_neighbour_slows_the_filling_of_a_small_actuator() {
    let small = held(0.2, 1e-5);
    let large = held(6.0, 5e-5);
    let half = ATMOSPHERE + 0.5 * SUPPLY;
    let reaches = |reservoir: Option<Reservoir>, neighbours: usize| {
        let mut actuators = vec![modular(&small, FILL)];
        actuators.extend((0..neighbours).map(|_| modular(&large, FILL)));
        let mut reached = None;
        run(&mut manifold(reservoir, None), &mut actuators, (0.3, 3000), |manifold, actuators| {
            if actuators[0].state().pressure.0 >= half {
                reached = reached.or(Some(manifold.time()));
            }
        });
        reached.expect("half the supply's pressure")
    };
    let times = [0, 1, 2].map(|neighbours| reaches(Some(bottle(1.5e-4)), neighbours));
    assert!(times[1] > 1.1 * times[0] && times[2] > 1.1 * times[1], "{times:?}");
    // On a supply of constant pressure they do not feel each other.
    assert_eq!(reaches(None, 0), reaches(None, 2));
}

/// Without clearance the compressor brings `P_atm Q` of pressure times volume a second.
#[test]
fn a_compressor_fills_and_stops_within_the_step_in_which_its_bound_is_crossed() {
    let (volume, displacement, step) = (1e-3, 5e-4, 7e-3);
    let tank = filled(volume, 4e5, Some(compressor(displacement, 3e5, 5e5)));
    let mut manifold = manifold(Some(tank), None);
    let rise = ATMOSPHERE * displacement / volume;
    let mut count = 0;
    while manifold.state().compressor_runs {
        count += 1;
        manifold.advance(f64::from(count) * step, 0.0).expect("a step");
        let expected = 4e5 + ATMOSPHERE + rise * f64::from(count) * step;
        assert_close(manifold.pressure().0, expected, 1e-12);
    }
    let over = manifold.pressure().0 - (5e5 + ATMOSPHERE);
    assert!((0.0..rise * step).contains(&over), "{over} Pa above its bound");
    // It rests until the pressure has come down to the lower bound.
    while !manifold.state().compressor_runs {
        count += 1;
        manifold.advance(f64::from(count) * step, 1e-5).expect("a step");
    }
    let under = 3e5 + ATMOSPHERE - manifold.pressure().0;
    assert!((0.0..1e-5 * GAS * ROOM / volume).contains(&under), "{under} Pa below its bound");
}

/// With an even flow the outlet follows the exponential to `P_set − D ṁ ∓ B`, whatever the step.
#[test]
fn a_regulator_follows_its_exponential_at_any_step() {
    let (droop, band, lag, flow) = (2e7, 500.0, 20e-3, 5e-3);
    let regulator = Regulator::new(droop, band, lag).expect("a regulator");
    let set = SUPPLY + ATMOSPHERE;
    for steps in [1, 10, 100] {
        let mut manifold = manifold(None, Some(regulator));
        let advance = |manifold: &mut Manifold, begin: f64, flow: f64| {
            for count in 1..=steps {
                let step = 0.05 / f64::from(steps);
                manifold.advance(begin + f64::from(count) * step, flow * step).expect("a step");
            }
        };
        advance(&mut manifold, 0.0, flow);
        let kept = (-0.05 / lag).exp();
        let low = set - (droop * flow - band) * (1.0 - kept);
        assert_close(manifold.pressure().0, low, 1e-12);
        advance(&mut manifold, 0.05, 0.0);
        assert_close(manifold.pressure().0, set - band + (low - set + band) * kept, 1e-12);
    }
    // It gives no more than its reservoir has, and is exact there from the first step on.
    let poor = filled(1e-3, 0.5 * SUPPLY, None);
    let fed = manifold(Some(poor), Some(regulator));
    assert_close(fed.pressure().0, 0.5 * SUPPLY + ATMOSPHERE, 1e-15);
}

#[test]
fn six_unlike_actuators_of_a_leg_sag_one_tank() {
    let damped = |low, high| Range { ends: [low, high], damping: 0.05, stop_stiffness: 50.0, stop_damping: 0.5 };
    let leg = mckibben::load::leg::Leg { ranges: [damped(-1.0, 1.0), damped(-1.5, 0.1)], ..free() };
    let still = LegState { angles: [0.0, -0.2], rates: [0.0; 2] };
    let paper = Paper::pwm(FREQUENCY, 0.5).friction(60.0, 0.0);
    let rigs: [Rig; STRANDS] = std::array::from_fn(|strand| {
        let mut paper = paper.clone();
        paper.efficiency *= between(strand, 0, 0.5, 3.0);
        paper.external_volume = between(strand, 1, 3e-6, 2e-5);
        paper.rig()
    });
    let strands = rigs.each_ref().map(|rig| (rig, GaugePressure(10.0 * PSI)));
    let begin = || LegStepper::new(leg, still, strands, ROOM, FREQUENCY).expect("a leg");
    let step = |stepper: &mut LegStepper, watch: &mut dyn FnMut(&LegStepper)| {
        stepper.drive([0.8, 0.2, 0.3, 0.7, 0.3, 0.3].map(pulses)).expect("pulses");
        for count in 1..=3000 {
            stepper.advance_to(f64::from(count) * 2e-4).expect("a step");
            watch(stepper);
        }
    };
    let mut plain = begin();
    step(&mut plain, &mut |_| {});
    let on = |volume: f64| begin().with_manifold(manifold(Some(bottle(volume)), None)).expect("valves");

    let mut endless = on(1e5);
    step(&mut endless, &mut |_| {});
    for joint in 0..2 {
        assert_close(endless.state().angles[joint], plain.state().angles[joint], 1e-6);
    }

    let mut sagging = on(5e-4);
    let here = |stepper: &LegStepper| {
        let tank = stepper.manifold().and_then(Manifold::content).expect("a tank");
        tank + stepper.actuators().iter().map(ModularActuator::content).sum::<f64>()
    };
    let (all, mut exhausted) = (here(&sagging), 0.0);
    step(&mut sagging, &mut |stepper| {
        exhausted += stepper.actuators().iter().map(ModularActuator::exhausted).sum::<f64>();
        assert_close(here(stepper) + exhausted, all, 1e-12);
    });
    let left = sagging.manifold().expect("a manifold").pressure().0;
    assert!(left < 0.8 * (SUPPLY + ATMOSPHERE), "{left} Pa");
    // The strand that fills most has less than on a supply of its own.
    let [with, without] = [&sagging, &plain].map(|stepper| stepper.actuators()[0].state().pressure.0);
    assert!(with < 0.95 * without, "{with} {without}");
}

#[test]
fn what_cannot_be_served_is_refused_and_changes_nothing() {
    let refused = |result: Result<(), Error>, text: &str| {
        let said = result.expect_err("refused").to_string();
        assert!(said.contains(text), "{said}");
    };
    let paper = held(1.0, 3e-6);
    let mut actuator = modular(&paper, FILL);
    actuator.move_to(0.02, 3.5 * INCH).expect("a step");
    let (before, drawn) = (actuator.sample(), actuator.drawn());
    assert!(drawn > 0.0, "{drawn} kg");
    for pressure in [0.0, -1e5, f64::NAN, f64::INFINITY] {
        refused(actuator.feed(AbsolutePressure(pressure)), "supply.gauge_pressure");
    }
    refused(actuator.move_to(0.03, 0.2), "left the physics");
    assert_eq!((actuator.sample(), actuator.drawn()), (before, drawn));
    let mut sealed = ModularActuator::new(&Paper::sealed().rig(), Paper::sealed().start(), 25.0).expect("an actuator");
    refused(sealed.feed(AbsolutePressure(5e5)), "no valve");

    let mut manifold = manifold(Some(bottle(1e-4)), None);
    let begin = manifold;
    refused(manifold.serve(0.01, &mut [actuator.clone()]), "another time");
    refused(manifold.feed(&mut [actuator]), "another time");
    refused(manifold.advance(0.0, 0.0), "back in time");
    refused(manifold.advance(f64::NAN, 0.0), "back in time");
    refused(manifold.advance(0.01, 1.0), "absolute pressure");
    refused(manifold.advance(0.01, f64::NAN), "air drawn");
    assert_eq!(manifold, begin);

    let counted = SupplyLine::new(Some(bottle(1e-4)), None, 2.0).expect("a supply");
    refused(Manifold::new(&counted, &supply()).map(|_| ()), "supply.actuators = 2");
}
