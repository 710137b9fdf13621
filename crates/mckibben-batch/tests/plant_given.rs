//! Motions and pressures that are given, and valves whose poppets or spool are under way, side by side: each row is its own steps, bit
//! for bit.

use crate::common::{PSI, Paper, ROOM, spread};
use crate::plant_batch::{agree, bits, rows};
use mckibben::line::{Hose, HoseKind, Line};
use mckibben::load::{Load, Motion, SeriesTendon};
use mckibben::plant::{Plant, PlantRun, PlantSteps};
use mckibben::simulation::{Actuation, Method, PressureSeries, Rig};
use mckibben::valve::{Command, Ramp, RuntimeCommand, Solenoid, Spool};
use mckibben_batch::PlantBatch;

/// Steps rows of a rig with different parameters, which go in lanes, by both methods.
fn go(rig: &Rig, paper: &Paper, prepare: impl Fn(usize, &mut PlantSteps)) {
    let start = rig.start(&paper.initial()).expect("a start");
    let (plant, start) = (Plant::of_rig(rig), Plant::start_of_rig(rig, &start));
    assert!(PlantBatch::covers(&plant), "it goes in lanes");
    for (method, step) in [(Method::Rk4, 5e-5), (Method::Stable, 1e-3)] {
        let mut made = rows(&plant, &start, method, 21).expect("rows");
        made.iter_mut().enumerate().for_each(|(row, steps)| prepare(row, steps));
        agree(&made, step, 300);
    }
}

fn motions() -> [Motion; 2] {
    let table = Motion::table(vec![0.004, 0.01, 0.2], vec![0.085, 0.088, 0.079], 0.1).expect("a table");
    [Motion::sinusoid(0.085, 3e-3, 8.0, 0.3, 0.1).expect("a sinusoid"), table]
}

fn pressures() -> PressureSeries {
    PressureSeries::new(&[0.002, 0.009, 0.1], &[1e5, 3e5, 5e4]).expect("a time series")
}

#[test]
fn prescribed_motions_equal_scalar_instances() {
    for motion in motions() {
        for coulomb in [0.0, 1e-4] {
            let paper = Paper::pwm(25.0, 0.5).gauge(30.0 * PSI).friction(3.5, coulomb);
            let paper = paper.with(|rig| rig.load = Load::Prescribed(motion.clone()));
            go(&paper.rig(), &paper, |_, _| {});
        }
    }
}

/// A row whose poppets have arrived has the matrix of where its motion is at the beginning of a step, whatever is under way in others.
#[test]
fn prescribed_motions_beside_others_whose_poppets_are_under_way_equal_scalar_instances() {
    for motion in motions() {
        let paper = Paper::pwm(25.0, 0.5).gauge(30.0 * PSI).with(|rig| rig.load = Load::Prescribed(motion.clone()));
        let rig = paper.rig();
        let Some(Actuation { solenoid, command }) = rig.actuation().cloned() else { unreachable!("it has a valve") };
        let made = (0..21).map(|row| {
            let ramp = Ramp::new(1e-3 * f64::from(row), 5e-4 * f64::from(row)).expect("a ramp");
            let ramped = Actuation { solenoid: solenoid.with_ramp(ramp), command: command.clone() };
            let actuator = paper.actuator().with_valve(paper.valve());
            let rig = Rig::new(actuator, Some(ramped), paper.load.clone()).expect("a rig");
            let start = rig.start(&paper.initial()).expect("a start");
            let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &start));
            PlantRun::new(&plant, &start, 1e-9).expect("a run").steps(Method::Stable)
        });
        agree(&made.collect::<Vec<_>>(), 5e-3, 100);
    }
}

/// In the muscle, at the inlet of a hose, with a tendon, and with a motion that is given as well.
#[test]
fn prescribed_pressures_equal_scalar_instances() {
    for coulomb in [0.0, 1e-4] {
        let paper = Paper::sealed().gauge(1e5).friction(3.5, coulomb);
        go(&paper.rig().with_pressure(pressures()).expect("a rig"), &paper, |_, _| {});
        let tendon = SeriesTendon::new(2e4, 0.05).expect("a tendon");
        let on_tendon = paper.rig().with_tendon(tendon).with_pressure(pressures()).expect("a rig");
        go(&on_tendon, &paper, |_, _| {});
        let hose = Hose::new(HoseKind::Lumped, [1.0, 3e-3], [1.82e-5, ROOM, 1.0], &paper.air()).expect("a hose");
        let line = Line { hose: Some(hose), ..Line::NONE };
        let behind = paper.rig().with_pressure(pressures()).and_then(|rig| rig.with_line(line)).expect("a rig");
        go(&behind, &paper, |_, _| {});
        let moved = paper.clone().with(|rig| rig.load = Load::Prescribed(motions()[0].clone()));
        go(&moved.rig().with_pressure(pressures()).expect("a rig"), &moved, |_, _| {});
    }
}

#[test]
fn moving_poppets_and_spools_equal_scalar_instances() {
    let paper = Paper::pwm(25.0, 0.5).gauge(30.0 * PSI).friction(3.5, 1e-4);
    let ramp = Ramp::new(3.1e-3, 2.3e-3).expect("a ramp");
    let rig = paper.rig();
    let Some(Actuation { solenoid, command }) = rig.actuation().cloned() else { unreachable!("it has a valve") };
    let ramped = Actuation { solenoid: solenoid.with_ramp(ramp), command };
    let actuator = || paper.actuator().with_valve(paper.valve());
    go(&Rig::new(actuator(), Some(ramped), paper.load.clone()).expect("a rig"), &paper, |_, _| {});
    for (frequency, damping, overlap) in [(60.0, 0.7, 0.05), (40.0, 1.0, -0.1), (20.0, 2.5, 0.0)] {
        let spool = Spool::new(frequency, damping, overlap, overlap).expect("a spool");
        let command = Command::Positions { time: vec![0.0, 0.06, 0.11], position: vec![0.8, -0.6, 0.1] };
        let moved = Actuation { solenoid: Solenoid::proportional(spool), command };
        let rig = Rig::new(actuator(), Some(moved), paper.load.clone()).expect("a rig");
        go(&rig, &paper, |row, steps| {
            if row % 3 == 1 {
                steps.set(0, RuntimeCommand::Position(2.0 * spread(row, 2) - 1.0)).expect("a position");
            }
        });
    }
}

/// Many steps in one go, whose poppets are under way: rows are looked after less often.
#[test]
fn moving_poppets_in_long_spans_equal_scalar_instances() {
    for (ramp, standard) in [([3.1e-3, 2.3e-3], 0), ([2e-3, 1e-3], 1)] {
        let paper = Paper::pwm(25.0, 0.5).gauge(30.0 * PSI).friction(3.5, if standard == 0 { 0.0 } else { 1e-4 });
        let ramp = Ramp::new(ramp[0], ramp[1]).expect("a ramp");
        let rig = paper.rig();
        let Some(Actuation { solenoid, command }) = rig.actuation().cloned() else { unreachable!("it has a valve") };
        let ramped = Actuation { solenoid: solenoid.with_ramp(ramp), command };
        let actuator = paper.actuator().with_valve(paper.valve());
        let rig = Rig::new(actuator, Some(ramped), paper.load.clone()).expect("a rig");
        let start = rig.start(&paper.initial()).expect("a start");
        let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &start));
        for method in [Method::Rk4, Method::Stable] {
            let mut scalar = rows(&plant, &start, method, 5).expect("rows");
            let mut batch = PlantBatch::new(scalar.clone()).expect("a batch");
            for count in 0..20 {
                let from = batch.time();
                let until = f64::from(count + 1) * 0.05;
                batch.advance(until, 500).expect("on");
                for step in 1..=500_u32 {
                    let end = if step == 500 { until } else { from + (until - from) * (f64::from(step) / 500.0) };
                    scalar.iter_mut().for_each(|row| row.advance_to(end).expect("on"));
                }
                for (index, row) in scalar.iter().enumerate() {
                    let found = batch.row(index).expect("it goes on").state().to_vec();
                    assert_eq!(bits(&found), bits(row.state()), "row {index}, {method:?}, {until} s: {found:?}");
                }
            }
        }
    }
}
