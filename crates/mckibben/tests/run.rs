//! A run whose steps are handed on as they are made: bit by bit what a kept trajectory gives.

use crate::common::joint::Pair;
use crate::common::{PSI, Paper, ROOM, assert_within};
use mckibben::Error;
use mckibben::control::{Output, Pid, Quantity, Regulator, Sampling, Sensors, SetPoint, Tracker};
use mckibben::friction::{Hysteresis, LuGre};
use mckibben::line::{Hose, HoseKind, Line};
use mckibben::load::{Load, Motion};
use mckibben::plant::{PlantLedgerKeeper, RigPlant};
use mckibben::simulation::{Reading, Rig, SampleTimes, simulate};
use mckibben::valve::{Command, Request, ValveKind};

const END: f64 = 0.5;
/// Does not divide the run.
const INTERVAL: f64 = 0.7e-3;

fn times() -> Reading<impl Iterator<Item = f64>> {
    Reading::new(SampleTimes::new(END, INTERVAL).times(), END)
}

/// What is read is compared by its text: every bit of a number shows in it, and so does the sign of a zero.
fn text(what: &impl std::fmt::Debug) -> String {
    format!("{what:?}")
}

fn rigs() -> Vec<Rig> {
    let hosed = Hose::new(HoseKind::Lumped, [1.0, 4e-3], [1.82e-5, ROOM, 1.0], &Paper::sealed().air());
    let line = Line { hose: Some(hosed.expect("a hose")), ..Line::NONE };
    let lugre = Hysteresis::LuGre(LuGre::new(1e-4, 1e-4).expect("a law"));
    let paper = Paper::pwm(25.0, 0.5);
    vec![
        paper.rig(),
        paper.rig().with_line(line).expect("a line"),
        paper.clone().friction(3.5, 0.0).with(|rig| rig.hysteresis = Some(lugre)).rig(),
        paper.gauge(20.0 * PSI).rig(),
    ]
}

#[test]
fn samples_events_and_accounts_are_those_of_the_trajectory() {
    let start = Paper::pwm(25.0, 0.5).start();
    for rig in rigs() {
        let kept = simulate(&rig, start, END, 1e-8).expect("a run");
        let (mut reading, mut samples, mut events) = (times(), Vec::new(), Vec::new());
        let of = RigPlant::new(&rig);
        let mut keeper = PlantLedgerKeeper::new(of.plant(), 1e-8);
        let end = of
            .stream(&start, (END, 1e-8), None, &mut |step| {
                keeper.step(step.plant());
                events.extend(step.event());
                reading.step(step, |sample| {
                    samples.push(*sample);
                    Ok(())
                })
            })
            .expect("a run");
        reading
            .finish(&end.sample, |sample| {
                samples.push(*sample);
                Ok::<_, Error>(())
            })
            .expect("samples");
        let expected: Vec<_> = kept.samples(INTERVAL).collect();
        assert_eq!(samples.len(), expected.len());
        assert!(samples.len() > 700 && events.len() > 20, "{} {}", samples.len(), events.len());
        assert_eq!(text(&samples), text(&expected));
        assert_eq!(events, kept.events());
        assert_eq!(end.run.statistics(), kept.statistics());
        assert_eq!(text(&keeper.finish(&end.run)), text(&kept.ledger()));
        assert_eq!(text(&end.sample), text(&kept.at(END)));
    }
}

fn regulator(quantity: Quantity, band: f64) -> Regulator {
    Regulator::Pid(Pid::new(quantity, band, Output::FillHoldExhaust).expect("a controller"))
}

/// A decision comes before the samples that follow it, and the samples are those of the trajectory.
#[test]
fn a_controlled_run_is_read_as_its_trajectory_is() {
    let paper = Paper::pwm(50.0, 0.5).gauge(20.0 * PSI).with(|rig| rig.kind = ValveKind::FillHoldExhaust);
    let (rig, start) = (paper.rig(), paper.start());
    let target = SetPoint::constant(Quantity::Pressure, 40.0 * PSI).expect("a set point");
    let law = Tracker::new(Quantity::Pressure, target, regulator(Quantity::Pressure, 60.0 * PSI)).expect("a tracker");
    let with = (Sampling::new(50.0, 1).expect("a rate"), Sensors::perfect());
    let of = RigPlant::new(&rig);
    let driver = || of.driver(law.clone(), with).expect("a driver");
    let kept = of.record(&start, (END, 1e-8), Some(driver()), &mut |_| Ok(())).expect("a run");
    let mut decided = Vec::new();
    let (mut reading, mut samples) = (times(), Vec::new());
    let end = of.stream(&start, (END, 1e-8), Some(driver()), &mut |step| {
        reading.step(step, |sample| {
            let before = |time: f64| (time * 50.0 * (1.0 + 1e-14)) as usize + 1;
            assert!(decided.len() >= before(sample.time), "no decision yet for {} s", sample.time);
            samples.push(*sample);
            Ok(())
        })?;
        decided.extend(step.decision());
        Ok(())
    });
    let end = end.expect("a run");
    samples.extend(std::iter::repeat_n(end.sample, kept.samples(INTERVAL).count() - samples.len()));
    assert_eq!(text(&samples), text(&kept.samples(INTERVAL).collect::<Vec<_>>()));
    assert_eq!(text(&decided), text(&kept.decisions()));
    assert_eq!(end.rig, *kept.rig());
}

/// What a consumer fails by ends the run, at once.
#[test]
fn a_consumer_ends_the_run() {
    let paper = Paper::pwm(25.0, 0.5);
    let mut steps = 0;
    let run = RigPlant::new(&paper.rig()).stream(&paper.start(), (END, 1e-8), None, &mut |step| {
        steps += 1;
        if step.end() > 0.1 { Err(Error::Interrupted { time: step.end() }) } else { Ok(()) }
    });
    let Err(Error::Interrupted { time }) = run else { panic!("{run:?}") };
    assert!((0.1..0.2).contains(&time) && steps > 10, "{time} {steps}");
}

/// More pulses, samples of a controller or periods of a motion than anybody can mean.
#[test]
fn counts_without_measure_are_refused_with_the_count() {
    let refused = |error: Error, key: &str, expected: f64| {
        let Error::TooMany { parameter, count, .. } = &error else { panic!("{error}") };
        assert_eq!(parameter.key, key);
        assert_within(*count, expected, 1e-12 * expected);
        let said = error.to_string();
        assert!(said.contains(key) && said.contains(&format!("{expected:.3e}")), "{said}");
    };
    let paper = Paper::pwm(1e15, 0.5);
    let (rig, start) = (paper.rig(), paper.start());
    refused(simulate(&rig, start, 2.0, 1e-8).unwrap_err(), "command.frequency", 2e15);
    // Just as many as a run may have are none too many.
    assert_eq!(Paper::pwm(1e9, 0.5).rig().check_counts(1.0), Ok(()));

    let pair = Pair::of(paper);
    refused(pair.try_run(1.0, 1e-8).unwrap_err(), "command.frequency", 1e15);

    let target = SetPoint::constant(Quantity::Pressure, 40.0 * PSI).expect("a set point");
    let law = Tracker::new(Quantity::Pressure, target, regulator(Quantity::Pressure, 60.0 * PSI)).expect("a tracker");
    let paper = Paper::driven(Command::Constant(Request::Exhaust)).with(|rig| rig.kind = ValveKind::FillHoldExhaust);
    for (sampling, key) in [
        (Sampling::new(1e12, 0).expect("a rate"), "controller.rate"),
        (
            Sampling::new(100.0, 0).and_then(|of| of.with_pulse_frequency(1e12)).expect("a rate"),
            "controller.pulse_frequency",
        ),
    ] {
        let of = RigPlant::new(&paper.rig());
        let driver = of.driver(law.clone(), (sampling, Sensors::perfect())).expect("a driver");
        let run = of.record(&paper.start(), (3.0, 1e-8), Some(driver), &mut |_| Ok(()));
        refused(run.unwrap_err(), key, 3e12);
    }

    let motion = Motion::sinusoid(0.09, 1e-3, 1e11, 0.0, 0.1).expect("a motion");
    let paper = Paper::sealed().with(|rig| {
        rig.load = Load::Prescribed(motion);
        rig.length = mckibben::simulation::InitialLength::Equilibrium;
    });
    let start = Paper::sealed().start();
    refused(simulate(&paper.rig(), start, 1.0, 1e-8).unwrap_err(), "load.frequency", 1e11);
}
