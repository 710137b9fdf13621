//! Valves that are told what to do while time goes on: the run is that of the command which would have been known beforehand,
//! bit for bit. Rows that begin anew in the middle of a batch are rows that began there, and touch no other.

use crate::common::{LB, PSI, Paper, ROOM, assert_close, assert_within, between, single_rounding, spread};
use mckibben::batch::{Batch, ControlledRow, Row, RowByRow, Width};
use mckibben::control::{Output, Pid, Quantity, Regulator as Keeps, Sampling, Sensors, SetPoint, Tracker};
use mckibben::friction::Coulomb;
use mckibben::line::{Hose, HoseKind, Line};
use mckibben::load::{Load, Motion, SeriesTendon};
use mckibben::simulation::{Actuation, FixedStepper, Method, Rig, Sample, State, ToldStepper};
use mckibben::valve::{Command, Demand, Ramp, Regulator, Request, Solenoid, Spool, ValveKind};
use mckibben::{Error, GaugePressure};

/// Steps between two instants at which something is told.
const STEPS: u64 = 4;
/// How often something is told.
const TOLD: usize = 120;

/// What a row is told at an instant.
type Tells = fn(usize, usize) -> Demand;

/// Fill or exhaust, as it comes.
fn fill_or_exhaust(row: usize, count: usize) -> Demand {
    if spread(count * 37 + row, 0) < 0.6 { Request::Fill.into() } else { Request::Exhaust.into() }
}

fn any_request(row: usize, count: usize) -> Demand {
    [Request::Fill, Request::Hold, Request::Exhaust][(spread(count * 37 + row, 1) * 3.0) as usize].into()
}

fn a_position(row: usize, count: usize) -> Demand {
    Demand::Position(between(count * 37 + row, 2, -1.0, 1.0))
}

fn a_set_point(row: usize, count: usize) -> Demand {
    Demand::SetPoint(GaugePressure(between(count * 37 + row, 3, 1e5, 5e5)))
}

fn paper(row: usize) -> Paper {
    let rests = Command::Constant(Request::Exhaust);
    Paper::driven(rests).mass(between(row, 4, 2.0, 10.0) * LB).gauge(between(row, 5, 20.0, 50.0) * PSI)
}

fn with_solenoid(paper: &Paper, solenoid: Solenoid, command: Command) -> Rig {
    let actuator = paper.actuator();
    Rig::new(actuator, Some(Actuation { solenoid, command }), paper.load.clone()).expect("a rig")
}

/// Rows of many kinds and what they are told: delays longer than the time between two instants, a hose behind which everything
/// is seen later still, seats that take their time, seats that jump at once, dry friction, spools, regulators, tendons.
fn row(index: usize) -> (Row, Tells) {
    let paper = paper(index);
    let hold = |kind: &Paper| kind.clone().with(|rig| rig.kind = ValveKind::FillHoldExhaust);
    let start = |rig: &Rig, of: &Paper| rig.start(&of.initial()).expect("a start");
    let (rig, tells): (Rig, Tells) = match index % 9 {
        0 => (paper.rig(), fill_or_exhaust),
        1 => (hold(&paper).rig(), any_request),
        2 => (paper.clone().with(|rig| rig.delays = (0.0, 0.0)).rig(), fill_or_exhaust),
        3 => {
            let hose = Hose::new(HoseKind::Lumped, [1.0 + spread(index, 6), 3e-3], [1.82e-5, ROOM, 1.0], &paper.air());
            let line = Line { hose: Some(hose.expect("a hose")), ..Line::NONE };
            (hold(&paper).rig().with_line(line).expect("a line"), any_request)
        }
        4 => {
            let ramp = Ramp::new(3.1e-3, 2.3e-3).expect("a ramp");
            let solenoid = Solenoid::new(ValveKind::ThreeWay, 2.2e-3, 1.4e-3).expect("a solenoid").with_ramp(ramp);
            (with_solenoid(&paper, solenoid, Command::Constant(Request::Exhaust)), fill_or_exhaust)
        }
        5 => {
            let rubs = |rig: &mut Paper| rig.coulomb = Coulomb::new(1e-4).ok();
            (hold(&paper).with(rubs).rig(), any_request)
        }
        6 => {
            let solenoid = Solenoid::proportional(Spool::new(60.0, 0.7, 0.05, 0.05).expect("a spool"));
            (with_solenoid(&paper, solenoid, Command::positions(vec![0.0], vec![0.0]).expect("positions")), a_position)
        }
        7 => {
            let solenoid = Solenoid::regulating(Regulator::new(0.02, 5.5e-3, 5e6).expect("a regulator"));
            let nothing = Command::set_points(vec![0.0], vec![1e5]).expect("set points");
            (with_solenoid(&paper, solenoid, nothing), a_set_point)
        }
        _ => {
            let tendon = SeriesTendon::new(2e4, 0.1).expect("a tendon");
            (hold(&paper).rig().with_tendon(tendon), any_request)
        }
    };
    let start = start(&rig, &paper);
    (Row { rig, start }, tells)
}

/// All that a row is told, as a command known beforehand. A request that is told again asks nothing new: left in, its instant
/// could meet that of a seat and stand for it, a rounding beside.
fn known(index: usize, tells: Tells, at: impl Fn(usize) -> f64) -> Command {
    let mut told: Vec<(f64, Demand)> = (0..TOLD).map(|count| (at(count), tells(index, count))).collect();
    told.dedup_by(|(_, next), (_, before)| matches!(next, Demand::Request(_)) && next == before);
    let time = told.iter().map(|(time, _)| *time).collect();
    let numbers = told.iter().filter_map(|(_, demand)| match demand {
        Demand::Position(number) | Demand::SetPoint(GaugePressure(number)) => Some(*number),
        _ => None,
    });
    let requests = told.iter().filter_map(|(_, demand)| match demand {
        Demand::Request(request) => Some(*request),
        _ => None,
    });
    match told[0].1 {
        Demand::Position(_) => Command::positions(time, numbers.collect()),
        Demand::SetPoint(_) => Command::set_points(time, numbers.collect()),
        _ => Command::table(time, requests.collect()),
    }
    .expect("a command")
}

/// The same rig under another command.
fn under(rig: &Rig, command: Command) -> Rig {
    let Actuation { solenoid, .. } = rig.actuation().expect("a valve");
    let actuation = Some(Actuation { solenoid: *solenoid, command });
    let anew = Rig::new(rig.actuator().clone(), actuation, rig.load().clone()).expect("a rig");
    let anew = anew.with_line(*rig.line()).expect("a line");
    rig.tendon().map_or(anew.clone(), |tendon| anew.with_tendon(*tendon))
}

/// Equal steps from one time to another, as a batch takes them.
fn in_steps(from: f64, until: f64, mut advance_to: impl FnMut(f64)) {
    (1..STEPS).for_each(|step| advance_to(from + (until - from) * (step as f64 / STEPS as f64)));
    advance_to(until);
}

fn millisecond(count: usize) -> f64 {
    count as f64 * 1e-3
}

/// The run with the command known beforehand.
fn beforehand(row: &Row, command: Command, method: Method, at: impl Fn(usize) -> f64) -> Sample {
    let rig = under(&row.rig, command);
    let mut stepper = FixedStepper::new(&rig, row.start, method);
    for count in 0..TOLD {
        in_steps(at(count), at(count + 1), |until| stepper.advance_to(until).expect("a step"));
    }
    stepper.sample()
}

/// What a stepper shows after all that it is told, at instants that begin with its own.
fn told(mut stepper: ToldStepper, tells: impl Fn(usize) -> Demand, at: impl Fn(usize) -> f64) -> Sample {
    for count in 0..TOLD {
        stepper.tell(tells(count)).expect("told");
        in_steps(at(count), at(count + 1), |until| stepper.advance_to(until).expect("a step"));
    }
    stepper.sample()
}

#[test]
fn a_row_that_is_told_is_the_run_of_the_command_known_beforehand_bit_for_bit() {
    for method in [Method::Stable, Method::Rk4] {
        let rows: Vec<(Row, Tells)> = (0..45).map(row).collect();
        let expected: Vec<Sample> = (0..rows.len())
            .map(|index| beforehand(&rows[index].0, known(index, rows[index].1, millisecond), method, millisecond))
            .collect();
        for width in Width::available() {
            let plain = rows.iter().map(|(row, _)| row.clone()).collect();
            let mut batch: Batch = Batch::with_width(plain, method, width);
            for count in 0..TOLD {
                for (index, (_, tells)) in rows.iter().enumerate() {
                    batch.tell(index, tells(index, count)).expect("told");
                }
                batch.advance(millisecond(count + 1), STEPS);
            }
            for (index, sample) in batch.samples().into_iter().enumerate() {
                assert_eq!(sample.expect("a row"), expected[index], "row {index}, {method:?}, {width:?}");
                let State { length, pressure, .. } = *batch.state(index).as_ref().expect("a row");
                assert_eq!((length, pressure), (expected[index].length, expected[index].pressure));
            }
        }
        for (index, (Row { rig, start }, tells)) in rows.iter().enumerate().take(9) {
            let began = ToldStepper::new(rig.clone(), *start, method);
            let sample = told(began, |count| tells(index, count), millisecond);
            assert_eq!(sample, expected[index], "row {index}, {method:?}");
        }
    }
}

fn pulses(frequency: f64, duty: f64) -> Demand {
    Demand::Pulses { frequency, duty, pulse: Request::Fill, rest: Request::Exhaust }
}

/// Row `index` under pulses of `duty(index, count)`, told at each millisecond.
fn pulsing(rows: &[Row], width: Width, frequency: f64, duty: impl Fn(usize, usize) -> f64) -> Vec<Sample> {
    let mut batch: Batch = Batch::with_width(rows.to_vec(), Method::Stable, width);
    for count in 0..TOLD {
        for index in 0..rows.len() {
            batch.tell(index, pulses(frequency, duty(index, count))).expect("told");
        }
        batch.advance(millisecond(count + 1), STEPS);
    }
    batch.samples().into_iter().map(|sample| sample.expect("a row")).collect()
}

fn plain(count: usize) -> Vec<Row> {
    let row = |index| Row { rig: paper(index).rig(), start: paper(index).start() };
    (0..count).map(row).collect()
}

#[test]
fn pulses_that_are_told_are_those_of_a_duty_cycle_known_beforehand() {
    let (rows, duty) = (plain(19), |index: usize, _: usize| between(index, 6, 0.2, 0.8));
    for width in Width::available() {
        for (index, sample) in pulsing(&rows, width, 30.0, duty).into_iter().enumerate() {
            let command = Command::pwm(30.0, duty(index, 0), Request::Fill, Request::Exhaust).expect("a command");
            assert_eq!(
                sample,
                beforehand(&rows[index], command, Method::Stable, millisecond),
                "row {index}, {width:?}"
            );
        }
    }
}

#[test]
fn a_duty_cycle_that_changes_is_taken_up_by_the_next_period() {
    // Told in the middle of the period before: period p has the duty of 7 ms before it begins.
    const PERIOD: usize = 20;
    let of_period = |index: usize, period: usize| between(index * 11 + period, 6, 0.1, 0.9);
    let duty = |index: usize, count: usize| of_period(index, (count + 7) / PERIOD);
    let rows = plain(19);
    for width in Width::available() {
        for (index, sample) in pulsing(&rows, width, 50.0, duty).into_iter().enumerate() {
            let edges = |period: usize| [period as f64 / 50.0, (period as f64 + of_period(index, period)) / 50.0];
            let time = (0..TOLD.div_ceil(PERIOD)).flat_map(edges).collect::<Vec<f64>>();
            let request = (0..time.len()).map(|edge| [Request::Fill, Request::Exhaust][edge % 2]).collect();
            let command = Command::table(time, request).expect("a table");
            assert_eq!(
                sample,
                beforehand(&rows[index], command, Method::Stable, millisecond),
                "row {index}, {width:?}"
            );
        }
    }
}

#[test]
fn of_two_in_one_instant_the_later_counts_and_the_memory_does_not_grow() {
    let paper = paper(0).with(|rig| rig.kind = ValveKind::FillHoldExhaust);
    let mut stepper = ToldStepper::new(paper.rig(), paper.start(), Method::Stable);
    // Coils that are never driven for as long as a seat takes to move.
    for count in 0..2000 {
        stepper.tell(Request::Exhaust).expect("told");
        stepper.tell(if count % 2 == 0 { Request::Fill } else { Request::Hold }).expect("told");
        stepper.advance_to(millisecond(count + 1)).expect("a step");
        let Some(Actuation { command: Command::Table { time, .. }, .. }) = stepper.rig().actuation() else {
            panic!("{:?}", stepper.rig().actuation())
        };
        assert!(time.len() <= 2, "{time:?}");
    }
    let resting = FixedStepper::new(&Paper::sealed().rig(), paper.start(), Method::Stable).ports();
    assert_eq!(stepper.sample().ports, resting);
}

#[test]
fn a_row_that_begins_anew_is_one_that_began_there_and_touches_no_other() {
    const BEFORE: usize = 64;
    let rows = plain(21);
    let anew = |index: usize| Row { rig: paper(index + 100).rig(), start: paper(index + 100).start() };
    let restarted = |index: usize| index % 5 == 3;
    for (width, method) in
        Width::available().into_iter().flat_map(|width| [(width, Method::Stable), (width, Method::Rk4)])
    {
        let mut batches = [false, true].map(|_| Batch::<f64>::with_width(rows.clone(), method, width));
        for (some_restart, batch) in batches.iter_mut().enumerate() {
            for count in 0..BEFORE + TOLD {
                for index in 0..batch.len() {
                    if some_restart == 1 && count == BEFORE && restarted(index) {
                        batch.restart(index, anew(index)).expect("begins anew");
                    }
                    let count = if restarted(index) { (count + TOLD - BEFORE) % TOLD } else { count };
                    batch.tell(index, fill_or_exhaust(index, count)).expect("told");
                }
                batch.advance(millisecond(count + 1), STEPS);
            }
        }
        let [untouched, batch] = batches.map(|batch| batch.samples());
        for (index, (sample, before)) in batch.into_iter().zip(untouched).enumerate() {
            let (sample, before) = (sample.expect("a row"), before.expect("a row"));
            if !restarted(index) {
                assert_eq!(sample, before, "row {index}, {width:?}");
                continue;
            }
            let Row { rig, start } = anew(index);
            let began = ToldStepper::begin_at(millisecond(BEFORE), rig, start, method).expect("a row");
            let at = |count| millisecond(BEFORE + count);
            assert_eq!(sample, told(began, |count| fill_or_exhaust(index, count), at), "row {index}, {width:?}");
            // An instant at which the load turns is rounded as time is, so it is that of t = 0 but for what that makes.
            let from_zero = beforehand(&anew(index), known(index, fill_or_exhaust, millisecond), method, millisecond);
            assert_close(sample.length, from_zero.length, 1e-10);
            assert_close(sample.pressure.0, from_zero.pressure.0, 1e-10);
        }
    }
}

#[test]
fn rows_told_and_begun_anew_together_are_each_told_and_begun() {
    let rows = || plain(21).into_iter().chain([row(8).0]).collect::<Vec<_>>();
    let anew = |count: usize| {
        let of = |index: usize| (index, if index < 21 { plain(40).swap_remove(index + 10) } else { row(8).0 });
        (0..22).filter(move |index| (index + count).is_multiple_of(3)).map(of)
    };
    for width in Width::available() {
        let mut batches = [false, true].map(|_| Batch::<f64>::with_width(rows(), Method::Stable, width));
        for count in 0..40 {
            let [one_by_one, together] = &mut batches;
            if count % 10 == 9 {
                anew(count).for_each(|(index, row)| one_by_one.restart(index, row).expect("begins anew"));
                together.restart_all(anew(count).collect()).expect("begin anew");
            }
            let told = |index: usize| (index != 5).then(|| fill_or_exhaust(index, count));
            for (index, demand) in (0..22).filter_map(|index| Some((index, told(index)?))) {
                one_by_one.tell(index, demand).expect("told");
            }
            one_by_one.advance(millisecond(count + 1), STEPS);
            let (mut shown, mut stopped) = (vec![[f64::NAN; 4]; 22], vec![true; 22]);
            together.go(millisecond(count + 1), STEPS, told, (&mut shown, &mut stopped)).expect("as many as rows");
            for (index, shown) in shown.into_iter().enumerate() {
                assert_eq!(one_by_one.state(index).map(|state| state.to_array()), Ok(shown), "{width:?} {index}");
            }
            assert_eq!(stopped, [false; 22]);
        }
        let [one_by_one, together] = batches.map(|batch| batch.samples());
        assert_eq!(one_by_one, together, "{width:?}");
    }
}

#[test]
fn a_row_that_has_stopped_lives_again() {
    for width in Width::available() {
        let mut batch: Batch = Batch::with_width(plain(5), Method::Rk4, width);
        (0..5).for_each(|index| batch.tell(index, Request::Fill).expect("told"));
        // A step as long as this leaves the physics.
        batch.advance(1.0, 1);
        assert!(batch.samples().iter().any(Result::is_err), "{width:?}");
        for index in 0..5 {
            let stopped = batch.state(index).is_err();
            assert_eq!(batch.tell(index, Request::Exhaust).is_err(), stopped);
            let (mut shown, mut stops) = (vec![[f64::NAN; 4]; 5], vec![false; 5]);
            let places = (&mut shown[..], &mut stops[..]);
            batch.go(batch.time(), 0, |_| Some(Request::Exhaust.into()), places).expect("as many as rows");
            assert_eq!((stops[index], shown[index][0].is_nan()), (stopped, stopped), "{width:?} {index}");
            batch.restart(index, plain(5).swap_remove(index)).expect("begins anew");
            assert_eq!(batch.state(index), Ok(plain(5)[index].start));
            batch.tell(index, Request::Exhaust).expect("told");
        }
        batch.advance(1.001, STEPS);
        assert!(batch.samples().iter().all(Result::is_ok), "{width:?}");
    }
}

#[test]
fn tendons_begin_anew_too_and_a_stepper_in_a_batch_of_its_kind() {
    let (Row { rig, start }, _) = row(8);
    let mut batch = RowByRow::new(vec![ToldStepper::new(rig.clone(), start, Method::Stable)]).expect("a row");
    let mut mixed: Batch = Batch::new(vec![row(0).0, row(8).0], Method::Stable);
    batch.advance(0.125, 128);
    mixed.advance(0.125, 128);
    let late = ToldStepper::new(rig.clone(), start, Method::Stable);
    assert!(matches!(batch.restart(0, late), Err(Error::Misuse { .. })));
    let there = ToldStepper::begin_at(0.125, rig.clone(), start, Method::Stable).expect("a row");
    batch.restart(0, there).expect("begins anew");
    mixed.restart(1, Row { rig, start }).expect("begins anew");
    batch.advance(0.25, 128);
    mixed.advance(0.25, 128);
    assert_eq!(batch.samples()[0], mixed.samples()[1]);
    assert!(batch.restart(1, row_stepper()).is_err());
}

fn row_stepper() -> ToldStepper {
    let (Row { rig, start }, _) = row(0);
    ToldStepper::new(rig, start, Method::Stable)
}

#[test]
fn half_the_precision_follows_as_well() {
    /// No row is faster, in m/s.
    const FASTEST: f64 = 1.0;
    let run = |single: bool| {
        let mut double: Batch<f64> = Batch::new(plain(19), Method::Stable);
        let mut half: Batch<f32> = Batch::new(plain(19), Method::Stable);
        for count in 0..TOLD {
            for index in 0..19 {
                let demand = fill_or_exhaust(index, count);
                if single { half.tell(index, demand) } else { double.tell(index, demand) }.expect("told");
            }
            half.advance(millisecond(count + 1), STEPS);
            double.advance(millisecond(count + 1), STEPS);
        }
        if single { half.samples() } else { double.samples() }
    };
    for (double, half) in run(false).into_iter().zip(run(true)) {
        let (double, half) = (double.expect("a row"), half.expect("a row"));
        let rounding = single_rounding(TOLD as u64 * STEPS);
        assert_close(half.length, double.length, rounding);
        assert_within(half.velocity, double.velocity, rounding * FASTEST);
        assert_close(half.pressure.0, double.pressure.0, rounding);
        assert_close(half.air_mass, double.air_mass, rounding);
    }
}

#[test]
fn what_cannot_be_is_refused_and_changes_nothing() {
    let sealed = Row { rig: Paper::sealed().rig(), start: Paper::sealed().start() };
    let mut batch: Batch = Batch::new(vec![row(0).0, sealed, row(6).0], Method::Stable);
    batch.tell(0, Request::Fill).expect("told");
    let unchanged = format!("{batch:?}");
    let said = |refused: Result<(), Error>| refused.expect_err("refused").to_string();
    assert!(said(batch.tell(0, Request::Hold)).contains("cannot hold"));
    assert!(said(batch.tell(0, pulses(50.0, 1.5))).contains("duty"));
    assert!(said(batch.tell(0, pulses(0.0, 0.5))).contains("frequency"));
    assert!(said(batch.tell(0, Demand::Position(0.5))).contains("no proportional spool"));
    assert!(said(batch.tell(0, Demand::SetPoint(GaugePressure(1e5)))).contains("no pressure regulator"));
    assert!(said(batch.tell(1, Request::Fill)).contains("has none"));
    assert!(said(batch.tell(2, Request::Fill)).contains("positions"));
    assert!(said(batch.tell(2, Demand::Position(1.5))).contains("command.position"));
    assert!(said(batch.tell(3, Request::Fill)).contains("count the rows"));
    assert!(said(batch.restart(0, row(8).0)).contains("another form"));
    assert!(said(batch.restart(0, row(3).0)).contains("another form"));
    let motion = Motion::sinusoid(0.09, 1e-3, 1.0, 0.0, 0.1).expect("a motion");
    let moved = paper(0).with(|rig| rig.load = Load::Prescribed(motion));
    let moved = Row { rig: moved.rig(), start: paper(0).start() };
    assert!(said(batch.restart(0, moved)).contains("motion"));
    assert_eq!(format!("{batch:?}"), unchanged);

    let pid = Pid::new(Quantity::Pressure, 3e5, Output::FillHoldExhaust).expect("a controller");
    let set_point = SetPoint::constant(Quantity::Pressure, 3e5).expect("a set point");
    let Row { rig, start } = row(1).0;
    let mut controlled: Batch = Batch::controlled(
        vec![ControlledRow {
            rig,
            start,
            controller: Tracker::new(Quantity::Pressure, set_point, Keeps::Pid(pid)).expect("a tracker"),
            sampling: Sampling::new(50.0, 0).expect("a rate"),
            sensors: Sensors::perfect(),
        }],
        Method::Stable,
    )
    .expect("a loop");
    assert!(said(controlled.tell(0, Request::Fill)).contains("controller"));
    assert!(said(controlled.restart(0, row(1).0)).contains("controller"));
}
