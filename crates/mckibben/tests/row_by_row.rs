//! Rows that go by themselves: each is the run of its stepper alone, bit for bit, on any number of threads; one that fails says
//! so by itself. Rigs on a tendon stand among those in lanes.

use crate::common::joint::Pair;
use crate::common::{PSI, Paper, between};
use core::fmt::Debug;
use mckibben::batch::RowByRow;
use mckibben::control::{
    Drive, JointSensors, JointTracker, Output, Pid, Quantity, Regulator, Sampling, Sensors, SetPoint, Tracker,
};
use mckibben::load::SeriesTendon;
use mckibben::load::leg::{LegState, STRANDS};
use mckibben::simulation::{
    ControlledJointStepper, ControlledStepper, FixedStepper, InitialAngle, JointCourse, JointStepper, LegStepper,
    Method, Rig, State, Stepper,
};
use mckibben::valve::{Request, ValveKind};
use mckibben::{Error, GaugePressure};

const ROWS: usize = 21;
const METHOD: Method = Method::Stable;
/// Steps of half a millisecond, in two spans of which one ends between two samples.
const SPANS: [(f64, u64); 2] = [(0.013, 26), (0.1, 174)];

/// Every bit of what a row shows, or why it stopped.
fn shown<T: Debug>(sample: &Result<T, Error>) -> String {
    format!("{sample:?}")
}

fn alone<S: Stepper>(mut stepper: S) -> Result<S::Sample, Error> {
    let mut from = 0.0;
    for (until, steps) in SPANS {
        for step in 1..=steps {
            let part = from + (until - from) * (step as f64 / steps as f64);
            stepper.advance_to(if step == steps { until } else { part })?;
        }
        from = until;
    }
    Ok(stepper.sample())
}

fn together<S: Stepper + Send>(steppers: Vec<S>) -> RowByRow<S> {
    let mut batch = RowByRow::new(steppers).expect("rows that begin together");
    SPANS.into_iter().for_each(|(until, steps)| batch.advance(until, steps));
    batch
}

/// That the rows which `of` makes are the same bits alone and together, whatever the number of rows and of threads.
fn assert_the_same<S: Stepper<Sample: Debug + Send> + Send>(of: impl Fn(usize) -> S + Sync) {
    let expected: Vec<String> = (0..ROWS).map(|row| shown(&alone(of(row)))).collect();
    assert!(expected.iter().all(|row| row.starts_with("Ok")), "{expected:?}");
    assert_ne!(expected[0], expected[1]);
    for count in [1, 2, 5, ROWS] {
        let samples = together((0..count).map(&of).collect()).samples();
        assert_eq!(samples.iter().map(shown).collect::<Vec<_>>(), expected[..count], "{count} rows");
    }
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let samples = pool.install(|| together((0..ROWS).rev().map(&of).collect()).samples());
        assert_eq!(samples.iter().rev().map(shown).collect::<Vec<_>>(), expected, "{threads} threads");
    }
}

fn paper(row: usize) -> Paper {
    let paper = Paper::pwm(between(row, 0, 20.0, 60.0), between(row, 1, 0.3, 0.7)).gauge(between(row, 2, 1e5, 3e5));
    paper.with(|rig| rig.kind = ValveKind::FillHoldExhaust)
}

fn pair(row: usize) -> Pair {
    Pair::of(paper(row)).with(|pair| {
        pair.papers[1] = paper(row + 40);
        pair.angle = InitialAngle::At(between(row, 3, -0.3, 0.3));
        pair.limb.distance = 0.05;
    })
}

fn joint(row: usize) -> (JointStepper, JointCourse) {
    begun(&pair(row))
}

fn begun(pair: &Pair) -> (JointStepper, JointCourse) {
    let rig = pair.rig().expect("a rig");
    let start = rig.start(&pair.initial()).expect("a start");
    let stepper = JointStepper::new(rig, METHOD).expect("a stepper");
    let course = stepper.begin(start);
    (stepper, course)
}

fn on_tendon(row: usize) -> (Rig, State) {
    let tendon = SeriesTendon::new(between(row, 3, 3e3, 3e4), 0.1).expect("a tendon");
    let paper = paper(row);
    (paper.rig().with_tendon(tendon), paper.start())
}

fn regulator(quantity: Quantity, band: f64) -> Regulator {
    Regulator::Pid(Pid::new(quantity, band, Output::FillHoldExhaust).expect("a controller"))
}

fn aim(quantity: Quantity, value: f64) -> SetPoint {
    SetPoint::constant(quantity, value).expect("a set point")
}

fn sampling(row: usize) -> Sampling {
    Sampling::new([50.0, 80.0, 130.0][row % 3], row % 2).expect("a rate")
}

fn tracker(row: usize) -> Tracker {
    let target = aim(Quantity::Pressure, between(row, 4, 2e5, 4e5));
    Tracker::new(Quantity::Pressure, target, regulator(Quantity::Pressure, 40.0 * PSI)).expect("a tracker")
}

fn joint_tracker(row: usize) -> JointTracker {
    JointTracker { angle: aim(Quantity::Angle, between(row, 4, -0.2, 0.2)), regulator: regulator(Quantity::Angle, 0.4) }
}

#[test]
fn a_joint_is_the_stepper_s_run_bit_for_bit() {
    assert_the_same(joint);
    // Many courses on one stepper.
    let (stepper, _) = joint(0);
    let start = |row: usize| stepper.rig().start(&pair(row).initial()).expect("a start");
    assert_the_same(|row| (&stepper, stepper.begin(start(row))));
}

#[test]
fn a_leg_is_the_stepper_s_run_bit_for_bit() {
    let rigs: Vec<Rig> = (0..ROWS).map(|row| paper(row).rig()).collect();
    assert_the_same(|row| {
        let state = LegState { angles: [between(row, 0, -0.2, 0.2), between(row, 1, -0.3, 0.0)], rates: [0.0, 0.5] };
        let strands = [(&rigs[row], GaugePressure(2e5)); STRANDS];
        let mut leg = LegStepper::new(crate::leg::free(), state, strands, 293.15, 50.0).expect("a leg");
        let pulses = |duty: f64| Drive::Pulses { duty, pulse: Request::Fill, rest: Request::Exhaust };
        leg.drive([0.6, 0.4, 0.3, 0.5, 0.4, 0.3].map(pulses)).expect("pulses");
        leg
    });
}

#[test]
fn a_load_on_a_tendon_is_the_stepper_s_run_bit_for_bit() {
    let rows: Vec<(Rig, State)> = (0..ROWS).map(on_tendon).collect();
    assert_the_same(|row| FixedStepper::new(&rows[row].0, rows[row].1, METHOD));
}

#[test]
fn controllers_are_owned_or_borrowed_and_their_decisions_told() {
    let laws: Vec<JointTracker> = (0..ROWS).map(joint_tracker).collect();
    let begin = |row: usize| {
        let rig = pair(row).rig().expect("a rig");
        let start = rig.start(&pair(row).initial()).expect("a start");
        (rig, start, (sampling(row), JointSensors::perfect()))
    };
    let owned = |row: usize| {
        let (rig, start, set_up) = begin(row);
        ControlledJointStepper::new(&rig, start, METHOD, joint_tracker(row), set_up).expect("a loop")
    };
    let borrowed = |row: usize| {
        let (rig, start, set_up) = begin(row);
        ControlledJointStepper::new(&rig, start, METHOD, &laws[row], set_up).expect("a loop")
    };
    assert_the_same(owned);
    assert_the_same(borrowed);
    let (one, other) = (together((0..ROWS).map(owned).collect()), together((0..ROWS).map(borrowed).collect()));
    for row in 0..ROWS {
        assert!(one.decisions(row).len() >= 6);
        assert_eq!(one.decisions(row), other.decisions(row));
    }
    assert!(one.decisions(ROWS).is_empty());
    let single = |row: usize| {
        let (rig, start) = on_tendon(row);
        ControlledStepper::new(&rig, start, METHOD, tracker(row), (sampling(row), Sensors::perfect())).expect("a loop")
    };
    assert_the_same(single);
    assert_eq!(together(vec![single(3)]).decisions(0).len(), 6);
}

#[test]
fn rows_are_told_between_two_spans_what_their_valves_do() {
    let steppers: Vec<JointStepper> = (0..3)
        .map(|row| JointStepper::driven(pair(row).rig().expect("a rig"), METHOD, 50.0).expect("a stepper"))
        .collect();
    let begin = |row: usize| {
        let start = steppers[row].rig().start(&pair(row).initial()).expect("a start");
        (&steppers[row], steppers[row].begin(start))
    };
    let asked = |row: usize| {
        [Drive::Steady(Request::Fill), Drive::Steady(Request::Hold)].map(|drive| match row {
            1 => drive.mirrored(),
            _ => drive,
        })
    };
    let mut batch = RowByRow::new((0..3).map(begin).collect()).expect("a batch");
    batch.advance(0.01, 20);
    for (row, (stepper, course)) in batch.rows_mut().enumerate() {
        stepper.drive(course, asked(row)).expect("a drive");
    }
    batch.advance(0.02, 20);
    assert_eq!((batch.len(), batch.is_empty(), batch.time()), (3, false, 0.02));
    for (row, sample) in batch.samples().iter().enumerate() {
        let (stepper, mut course) = begin(row);
        for step in 1..=40_u32 {
            let (from, part) = if step > 20 { (0.01, f64::from(step - 20)) } else { (0.0, f64::from(step)) };
            let until = if step == 40 { 0.02 } else { from + 0.01 * (part / 20.0) };
            stepper.advance_to(&mut course, until).expect("a step");
            if step == 20 {
                stepper.drive(&mut course, asked(row)).expect("a drive");
            }
        }
        assert_eq!(shown(sample), shown(&Ok(stepper.sample(&course))));
    }
}

#[test]
fn a_row_that_fails_has_an_error_of_its_own_and_touches_no_other() {
    // A torque that pulls the agonist's braid straight.
    let doomed = || begun(&pair(0).with(|pair| pair.torque = -60.0));
    let fault = alone(doomed()).expect_err("no braid holds that");
    assert!(matches!(fault, Error::Stopped { .. }), "{fault}");
    let good: Vec<String> = (0..ROWS).map(|row| shown(&alone(joint(row)))).collect();
    for place in [0, 3, ROWS] {
        let mut rows: Vec<_> = (0..ROWS).map(joint).collect();
        rows.insert(place, doomed());
        let mut batch = together(rows);
        let mut samples = batch.samples();
        assert_eq!(samples.remove(place).expect_err("a fault"), fault);
        assert_eq!(samples.iter().map(shown).collect::<Vec<_>>(), good);
        // It does not come back.
        batch.advance(0.2, 10);
        assert_eq!(batch.samples().remove(place).expect_err("a fault"), fault);
    }
}

#[test]
fn rows_at_different_times_are_refused() {
    let (stepper, mut course) = joint(0);
    let begun = (&stepper, course);
    stepper.advance_to(&mut course, 1e-3).expect("a step");
    let error = RowByRow::new(vec![begun, (&stepper, course)]).expect_err("refused");
    assert!(matches!(error, Error::Misuse { .. }), "{error}");
    let mut later = RowByRow::new(vec![(&stepper, course)]).expect("one time");
    later.advance(1e-3, 5);
    assert_eq!(later.time(), 1e-3);
}
