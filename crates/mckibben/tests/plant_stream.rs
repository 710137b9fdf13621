//! Runs of plants whose steps are handed on as they are made: bit by bit what a kept run gives.

use crate::common::joint::Pair;
use crate::common::{PSI, Paper};
use mckibben::Error;
use mckibben::control::{JointSensors, JointTracker, Output, Pid, Quantity, Regulator, Sampling, SetPoint};
use mckibben::plant::{Bookkeeper, JointPlant, Plant, PlantRun, simulate_plant};
use mckibben::simulation::{Reading, SampleTimes};
use mckibben::valve::ValveKind;

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

/// Samples, quadrature and events of a rig's plant, of which one sample is read while another is looked at.
#[test]
fn a_plant_is_read_as_its_trajectory_is() {
    let paper = Paper::pwm(25.0, 0.5);
    let rig = paper.rig();
    let plant = Plant::of_rig(&rig).expect("a plant");
    let start = Plant::start_of_rig(&rig, &rig.start(&paper.initial()).expect("a start"));
    let kept = simulate_plant(&plant, &start, END, 1e-8).expect("a run");
    let mut run = PlantRun::new(&plant, &start, 1e-8).expect("a run");
    let (mut events, mut air, mut middles) = (Vec::new(), 0.0, Vec::new());
    run.stream_to(END, &mut |step| {
        events.extend(step.event().map(|(event, _)| (event.time, event.kind)));
        step.quadrature(|weight, sample| {
            air += weight * sample.actuators[0].mass_flow;
            // Another sample has room of its own.
            assert_eq!(step.at(sample.time), *sample);
        });
        if step.end() - step.start() > 1e-9 {
            let middle = 0.5 * (step.start() + step.end());
            middles.push((middle, step.at(middle)));
        }
        Ok(())
    })
    .expect("a run");
    assert_eq!(events, kept.events().iter().map(|event| (event.time, event.kind)).collect::<Vec<_>>());
    assert_eq!(kept.modes().len(), events.len() + 1);
    assert_eq!(text(&run.sample()), text(&kept.sample(END)));
    assert!(middles.len() > 50);
    for (time, sample) in &middles {
        assert_eq!(text(sample), text(&kept.sample(*time)));
    }
    let gained = kept.sample(END).actuators[0].air_mass - kept.sample(0.0).actuators[0].air_mass;
    assert!((air - gained).abs() < 1e-8 * gained, "{air} {gained}");
}

#[test]
fn a_joint_is_read_as_its_trajectory_is() {
    let pair = Pair::of(Paper::pwm(25.0, 0.5)).with(|pair| pair.damping = 0.01);
    let rig = pair.rig().expect("a rig");
    let start = rig.start(&pair.initial()).expect("a start");
    let joint = JointPlant::new(&rig).expect("a plant");
    let kept = joint.simulate(&start, END, 1e-8).expect("a run");
    let (mut reading, mut samples, mut events) = (times(), Vec::new(), Vec::new());
    let mut ledger = Bookkeeper::new(joint.plant(), 1e-8);
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

/// What a consumer fails by ends the run, at once.
#[test]
fn a_consumer_ends_the_run() {
    let pair = Pair::of(Paper::pwm(25.0, 0.5));
    let rig = pair.rig().expect("a rig");
    let joint = JointPlant::new(&rig).expect("a plant");
    let start = rig.start(&pair.initial()).expect("a start");
    let mut steps = 0;
    let run = joint.stream(&start, (END, 1e-8), None, &mut |step| {
        steps += 1;
        if step.end() > 0.1 { Err(Error::Interrupted { time: step.end() }) } else { Ok(()) }
    });
    let Err(Error::Interrupted { time }) = run else { panic!("{run:?}") };
    assert!((0.1..0.2).contains(&time) && steps > 10, "{time} {steps}");
}
