//! A run that is streamed gives what a kept one gives, number for number: samples, events, decisions and the ledger.

use crate::common::joint::Pair;
use crate::common::{PSI, Paper};
use mckibben::Error;
use mckibben::command::Driver;
use mckibben::control::{
    Between, JointSensors, JointTracker, Output, Pid, Quantity, Regulator, Relay, Sampling, Sensors, SetPoint, Tracker,
};
use mckibben::plant::{JointPlant, Plant, PlantLedgerKeeper, PlantRun, PlantSample};
use mckibben::simulation::{Reading, SampleTimes};
use mckibben::valve::ValveKind;

#[test]
fn a_streamed_run_is_the_kept_one() {
    let paper = Paper::pwm(25.0, 0.5);
    let rig = paper.rig();
    let start = rig.start(&paper.initial()).expect("a start");
    let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &start));
    let relay = Relay::new(Quantity::Pressure, 5e3, 0.0, Between::Keep).expect("a relay");
    let set_point = SetPoint::Constant(2e5);
    let tracker =
        Tracker::new(Quantity::Pressure, set_point, mckibben::control::Regulator::Relay(relay)).expect("a tracker");
    let sampling = Sampling::new(100.0, 0).expect("a sampling");
    for driven in [false, true] {
        let drivers = || match driven {
            true => vec![Driver::of_actuator(tracker.clone(), 0, 0, (sampling, Sensors::perfect()))],
            false => Vec::new(),
        };
        let (duration, interval) = (0.3, 1.3e-3);
        let begun = || PlantRun::with_drivers(&plant, &start, 1e-8, drivers()).expect("a run");
        let kept = begun().record_to(duration, &mut |_| Ok(())).expect("a kept run");
        let mut run = begun();
        let mut keeper = PlantLedgerKeeper::new(&plant, 1e-8);
        let mut reading = Reading::new(SampleTimes::new(duration, interval).times(), duration);
        let (mut samples, mut events, mut decisions) = (Vec::<PlantSample>::new(), Vec::new(), Vec::new());
        run.stream_to(duration, &mut |step| {
            keeper.step(step);
            events.extend(step.event().map(|event| (event.time, event.kind)));
            decisions.extend(step.decision().map(|(driver, decision)| (driver, decision.clone())));
            reading.step(step, |sample: &PlantSample| {
                samples.push(sample.clone());
                Ok(())
            })
        })
        .expect("a streamed run");
        let last = run.sample();
        reading
            .finish(&last, |sample| {
                samples.push(sample.clone());
                Ok::<_, mckibben::Error>(())
            })
            .expect("no error");
        assert_eq!(samples, kept.samples(interval).collect::<Vec<_>>());
        assert_eq!(events, kept.events().iter().map(|event| (event.time, event.kind)).collect::<Vec<_>>());
        assert_eq!(decisions, kept.decisions());
        assert_eq!(decisions.is_empty(), !driven);
        assert_eq!(keeper.finish(&run), kept.ledger());
        let (mut replayed, mut reread) = (Vec::new(), Vec::new());
        let mut reading = Reading::new(SampleTimes::new(duration, interval).times(), duration);
        kept.replay(&mut |step| {
            replayed.extend(step.event().map(|event| (event.time, event.kind)));
            reading.step(step, |sample: &PlantSample| {
                reread.push(sample.clone());
                Ok(())
            })
        })
        .expect("a replay");
        assert_eq!(replayed, events);
        // The last sample is that of the end.
        assert_eq!(reread, samples[..samples.len() - 1]);
        assert_eq!(run.statistics(), kept.statistics());
        assert!(samples.len() > 200 && events.len() > 5);
    }
}

/// The consumer's error ends the run, which stays where it was.
#[test]
fn a_consumer_ends_the_run() {
    let paper = Paper::pwm(25.0, 0.5);
    let rig = paper.rig();
    let start = rig.start(&paper.initial()).expect("a start");
    let mut run = PlantRun::new(&Plant::of_rig(&rig), &Plant::start_of_rig(&rig, &start), 1e-8).expect("a run");
    let mut steps = 0;
    let ended = run.stream_to(1.0, &mut |step| {
        steps += 1;
        if steps == 3 { Err(mckibben::Error::Interrupted { time: step.end() }) } else { Ok(()) }
    });
    assert!(matches!(ended, Err(mckibben::Error::Interrupted { .. })), "{ended:?}");
    assert_eq!((steps, run.time()), (3, 0.0));
    // It is as good as new.
    run.advance_to(0.01).expect("goes on");
}

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

/// The quadrature of the flow into the air is the air that is gained.
#[test]
fn a_quadrature_gives_the_air_that_is_gained() {
    let pair = Pair::of(Paper::pwm(25.0, 0.5));
    let run = pair.run(END, 1e-8);
    let mut air = [0.0; 2];
    run.plant()
        .replay(&mut |step| {
            step.quadrature(|weight, sample| {
                air.iter_mut().zip(&sample.actuators).for_each(|(air, of)| *air += weight * of.mass_flow);
            });
            Ok(())
        })
        .expect("it is kept");
    for (i, air) in air.into_iter().enumerate() {
        let gained = run.at(END).actuators[i].air_mass - run.at(0.0).actuators[i].air_mass;
        assert!((air - gained).abs() < 1e-8 * gained, "{air} {gained}");
    }
}

#[test]
fn a_joint_is_read_as_its_trajectory_is() {
    let pair = Pair::of(Paper::pwm(25.0, 0.5)).with(|pair| pair.damping = 0.01);
    let rig = pair.rig().expect("a rig");
    let start = rig.start(&pair.initial()).expect("a start");
    let joint = JointPlant::new(&rig).expect("a plant");
    let kept = joint.simulate(&start, END, 1e-8).expect("a run");
    let (mut reading, mut samples, mut events) = (times(), Vec::new(), Vec::new());
    let mut ledger = PlantLedgerKeeper::new(joint.plant(), 1e-8);
    let end = joint
        .stream(&start, (END, 1e-8), None, &mut |step| {
            ledger.step(step.plant());
            events.extend(step.event());
            reading.step(step, |sample| {
                samples.push(*sample);
                Ok(())
            })
        })
        .expect("a run");
    samples.extend(std::iter::repeat_n(end.sample, kept.samples(INTERVAL).count() - samples.len()));
    assert_eq!(text(&samples), text(&kept.samples(INTERVAL).collect::<Vec<_>>()));
    assert_eq!((events.as_slice(), end.run.statistics()), (kept.events(), kept.statistics()));
    assert_eq!(text(&ledger.finish(&end.run)), text(&kept.ledger()));
    let mut replayed = Vec::new();
    kept.replay(&mut |step| {
        replayed.extend(step.event());
        Ok(())
    })
    .expect("it is kept");
    assert_eq!(replayed, events);
}

fn regulator(quantity: Quantity, band: f64) -> Regulator {
    Regulator::Pid(Pid::new(quantity, band, Output::FillHoldExhaust).expect("a controller"))
}

#[test]
fn a_controlled_joint_is_read_as_its_trajectory_is() {
    let paper = Paper::pwm(50.0, 0.5).gauge(30.0 * PSI).with(|rig| rig.kind = ValveKind::FillHoldExhaust);
    let pair = Pair::of(paper).with(|pair| pair.damping = 0.03);
    let rig = pair.rig().expect("a rig");
    let start = rig.start(&pair.initial()).expect("a start");
    let angle = SetPoint::constant(Quantity::Angle, 0.1).expect("a set point");
    let law = JointTracker { angle, regulator: regulator(Quantity::Angle, 0.5) };
    let with = (Sampling::new(40.0, 0).expect("a rate"), JointSensors::perfect());
    let joint = JointPlant::new(&rig).expect("a plant");
    let driver = || Some(joint.driver(law.clone(), with).expect("a driver"));
    let kept = joint.record(&start, (END, 1e-8), driver(), &mut |_| Ok(())).expect("a run");
    let (mut decisions, mut reading, mut samples) = (Vec::new(), times(), Vec::new());
    let end = joint
        .stream(&start, (END, 1e-8), driver(), &mut |step| {
            reading.step(step, |sample| {
                let before = (sample.time * 40.0 * (1.0 + 1e-14)) as usize + 1;
                assert!(decisions.len() >= before, "no decision yet for {} s", sample.time);
                samples.push(*sample);
                Ok::<_, Error>(())
            })?;
            decisions.extend(step.decision());
            Ok(())
        })
        .expect("a run");
    samples.extend(std::iter::repeat_n(end.sample, kept.samples(INTERVAL).count() - samples.len()));
    assert_eq!(text(&samples), text(&kept.samples(INTERVAL).collect::<Vec<_>>()));
    assert_eq!(text(&decisions), text(&kept.decisions()));
    assert_eq!(end.rig, *kept.rig());
}
