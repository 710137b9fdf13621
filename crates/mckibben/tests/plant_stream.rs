//! A run that is streamed gives what a kept one gives, number for number: samples, events, decisions and the ledger.

use crate::common::Paper;
use mckibben::command::Driver;
use mckibben::control::{Between, Quantity, Relay, Sampling, Sensors, SetPoint, Tracker};
use mckibben::plant::{Plant, PlantLedgerKeeper, PlantRun, PlantSample};
use mckibben::simulation::{Reading, SampleTimes};

#[test]
fn a_streamed_run_is_the_kept_one() {
    let paper = Paper::pwm(25.0, 0.5);
    let rig = paper.rig();
    let start = rig.start(&paper.initial()).expect("a start");
    let (plant, start) = (Plant::of_rig(&rig).expect("a plant"), Plant::start_of_rig(&rig, &start));
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
    let mut run =
        PlantRun::new(&Plant::of_rig(&rig).expect("a plant"), &Plant::start_of_rig(&rig, &start), 1e-8).expect("a run");
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
