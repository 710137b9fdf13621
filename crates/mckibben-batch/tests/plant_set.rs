//! Valves that are set while time goes on: the run is that of the command which would have been known beforehand, bit for bit, in
//! batches too. Rows that begin again in the middle of a batch are rows that began there, and touch no other.

use crate::common::{LB, PSI, Paper, ROOM, between, spread};
use mckibben::friction::Coulomb;
use mckibben::line::{Hose, HoseKind, Line};
use mckibben::load::SeriesTendon;
use mckibben::plant::{Plant, PlantRow, PlantRun, PlantSteps};
use mckibben::simulation::{Actuation, Method, Rig, State};
use mckibben::valve::{Command, Ramp, Regulator, Request, RuntimeCommand, Solenoid, Spool, ValveKind};
use mckibben::{Error, GaugePressure};
use mckibben_batch::{PlantBatch, Precision, Width};

/// A rig and its state at the start.
#[derive(Clone, Debug)]
struct Row {
    rig: Rig,
    start: State,
}

impl Row {
    fn run(&self) -> PlantRun {
        let (plant, start) = (Plant::of_rig(&self.rig), Plant::start_of_rig(&self.rig, &self.start));
        PlantRun::new(&plant, &start, 1e-9).expect("a start")
    }

    fn steps(&self, method: Method) -> PlantSteps {
        self.run().steps(method)
    }
}

/// Steps between two commands.
const STEPS: u64 = 4;
/// How many commands there are.
const COMMANDS: usize = 120;

/// What a valve of a row is set to at an instant.
type CommandOf = fn(usize, usize) -> RuntimeCommand;

/// Fill or exhaust, as it comes.
fn fill_or_exhaust(row: usize, count: usize) -> RuntimeCommand {
    if spread(count * 37 + row, 0) < 0.6 { Request::Fill.into() } else { Request::Exhaust.into() }
}

fn any_request(row: usize, count: usize) -> RuntimeCommand {
    [Request::Fill, Request::Hold, Request::Exhaust][(spread(count * 37 + row, 1) * 3.0) as usize].into()
}

fn a_position(row: usize, count: usize) -> RuntimeCommand {
    RuntimeCommand::Position(between(count * 37 + row, 2, -1.0, 1.0))
}

fn a_set_point(row: usize, count: usize) -> RuntimeCommand {
    RuntimeCommand::SetPoint(GaugePressure(between(count * 37 + row, 3, 1e5, 5e5)))
}

fn paper(row: usize) -> Paper {
    let rests = Command::Constant(Request::Exhaust);
    Paper::driven(rests).mass(between(row, 4, 2.0, 10.0) * LB).gauge(between(row, 5, 20.0, 50.0) * PSI)
}

fn with_solenoid(paper: &Paper, solenoid: Solenoid, command: Command) -> Rig {
    let actuator = paper.actuator();
    Rig::new(actuator, Some(Actuation { solenoid, command }), paper.load.clone()).expect("a rig")
}

/// Rows of many kinds and their commands: delays longer than the time between two instants, a hose behind which
/// everything is seen later still, poppets that take their time, poppets that jump at once, dry friction, spools,
/// regulators, tendons.
fn row(index: usize) -> (Row, CommandOf) {
    let paper = paper(index);
    let hold = |kind: &Paper| kind.clone().with(|rig| rig.kind = ValveKind::FillHoldExhaust);
    let start = |rig: &Rig, of: &Paper| rig.start(&of.initial()).expect("a start");
    let (rig, command_of): (Rig, CommandOf) = match index % 9 {
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
            let with_friction = |rig: &mut Paper| rig.coulomb = Coulomb::new(1e-4).ok();
            (hold(&paper).with(with_friction).rig(), any_request)
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
    (Row { rig, start }, command_of)
}

/// All commands to a row, as a command known beforehand. A request that is repeated changes nothing: left in, its
/// instant could differ by a rounding from that of a poppet, and replace it.
fn known(index: usize, command_of: CommandOf, at: impl Fn(usize) -> f64) -> Command {
    let mut commands: Vec<(f64, RuntimeCommand)> =
        (0..COMMANDS).map(|count| (at(count), command_of(index, count))).collect();
    commands.dedup_by(|(_, next), (_, before)| matches!(next, RuntimeCommand::Request(_)) && next == before);
    let time = commands.iter().map(|(time, _)| *time).collect();
    let numbers = commands.iter().filter_map(|(_, commanded)| match commanded {
        RuntimeCommand::Position(number) | RuntimeCommand::SetPoint(GaugePressure(number)) => Some(*number),
        _ => None,
    });
    let requests = commands.iter().filter_map(|(_, commanded)| match commanded {
        RuntimeCommand::Request(request) => Some(*request),
        _ => None,
    });
    match commands[0].1 {
        RuntimeCommand::Position(_) => Command::positions(time, numbers.collect()),
        RuntimeCommand::SetPoint(_) => Command::set_points(time, numbers.collect()),
        _ => Command::table(time, requests.collect()),
    }
    .expect("a command")
}

/// A rig under another command.
fn under(rig: &Rig, command: Command) -> Rig {
    let Actuation { solenoid, .. } = rig.actuation().expect("a valve");
    let actuation = Some(Actuation { solenoid: *solenoid, command });
    let copy = Rig::new(rig.actuator().clone(), actuation, rig.load().clone()).expect("a rig");
    let copy = copy.with_line(*rig.line()).expect("a line");
    rig.tendon().map_or(copy.clone(), |tendon| copy.with_tendon(*tendon))
}

/// Equal steps from one time to another, as a batch takes them.
fn in_steps(from: f64, until: f64, mut advance_to: impl FnMut(f64)) {
    (1..STEPS).for_each(|step| advance_to(from + (until - from) * (step as f64 / STEPS as f64)));
    advance_to(until);
}

fn millisecond(count: usize) -> f64 {
    count as f64 * 1e-3
}

/// All that is known of a row, in digits that distinguish any two numbers.
fn end(steps: &PlantRow) -> String {
    format!("{:?} {:?}", steps.state(), steps.sample().actuators)
}

/// The run with the command known beforehand.
fn beforehand(row: &Row, command: Command, method: Method) -> String {
    let Row { rig, start } = row;
    let mut steps = Row { rig: under(rig, command), start: *start }.steps(method);
    for count in 0..COMMANDS {
        in_steps(millisecond(count), millisecond(count + 1), |until| steps.advance_to(until).expect("a step"));
    }
    end(&steps)
}

/// Where steps come to that are set at each millisecond.
fn set(mut steps: PlantSteps, from: usize, commanded: impl Fn(usize) -> RuntimeCommand) -> String {
    for count in 0..COMMANDS {
        steps.set(0, commanded(count)).expect("set");
        let [from, until] = [from + count, from + count + 1].map(millisecond);
        in_steps(from, until, |until| steps.advance_to(until).expect("a step"));
    }
    end(&steps)
}

fn batch(rows: &[Row], method: Method, width: Width) -> PlantBatch {
    PlantBatch::with_lanes(rows.iter().map(|row| row.steps(method)), width, Precision::Double).expect("a batch")
}

fn ends(batch: &mut PlantBatch) -> Vec<String> {
    (0..batch.len()).map(|row| end(batch.row(row).expect("it goes on"))).collect()
}

#[test]
fn a_row_that_is_set_is_the_run_of_the_command_known_beforehand_bit_for_bit() {
    for method in [Method::Stable, Method::Rk4] {
        let rows: Vec<(Row, CommandOf)> = (0..45).map(row).collect();
        let known = |index: usize| known(index, rows[index].1, millisecond);
        let expected: Vec<String> =
            (0..rows.len()).map(|index| beforehand(&rows[index].0, known(index), method)).collect();
        let plain: Vec<Row> = rows.iter().map(|(row, _)| row.clone()).collect();
        for width in Width::available() {
            let mut batch = batch(&plain, method, width);
            for count in 0..COMMANDS {
                for (index, (_, command_of)) in rows.iter().enumerate() {
                    batch.set(index, 0, command_of(index, count)).expect("set");
                }
                batch.advance(millisecond(count + 1), STEPS).expect("a time");
            }
            for (index, found) in ends(&mut batch).iter().enumerate() {
                assert_eq!(found, &expected[index], "row {index}, {method:?}, {width:?}");
            }
        }
        for (index, (row, command_of)) in rows.iter().enumerate().take(9) {
            let found = set(row.steps(method), 0, |count| command_of(index, count));
            assert_eq!(found, expected[index], "row {index}, {method:?}");
        }
    }
}

fn pulses(frequency: f64, duty: f64) -> RuntimeCommand {
    RuntimeCommand::Pulses { frequency, duty, pulse: Request::Fill, rest: Request::Exhaust }
}

/// Rows under pulses of `duty(index, count)`, set at each millisecond.
fn pulsing(rows: &[Row], width: Width, frequency: f64, duty: impl Fn(usize, usize) -> f64) -> Vec<String> {
    let mut batch = batch(rows, Method::Stable, width);
    for count in 0..COMMANDS {
        for index in 0..rows.len() {
            batch.set(index, 0, pulses(frequency, duty(index, count))).expect("set");
        }
        batch.advance(millisecond(count + 1), STEPS).expect("a time");
    }
    ends(&mut batch)
}

fn plain(count: usize) -> Vec<Row> {
    (0..count).map(|index| Row { rig: paper(index).rig(), start: paper(index).start() }).collect()
}

#[test]
fn pulses_that_are_set_are_those_of_a_duty_cycle_known_beforehand() {
    let (rows, duty) = (plain(19), |index: usize, _: usize| between(index, 6, 0.2, 0.8));
    for width in Width::available() {
        for (index, found) in pulsing(&rows, width, 30.0, duty).into_iter().enumerate() {
            let command = Command::pwm(30.0, duty(index, 0), Request::Fill, Request::Exhaust).expect("a command");
            assert_eq!(found, beforehand(&rows[index], command, Method::Stable), "row {index}, {width:?}");
        }
    }
}

#[test]
fn a_duty_cycle_that_changes_is_taken_up_by_the_next_period() {
    // Set in the middle of the period before: period p has the duty of 7 ms before it begins.
    const PERIOD: usize = 20;
    let of_period = |index: usize, period: usize| between(index * 11 + period, 6, 0.1, 0.9);
    let duty = |index: usize, count: usize| of_period(index, (count + 7) / PERIOD);
    let rows = plain(19);
    for width in Width::available() {
        for (index, found) in pulsing(&rows, width, 50.0, duty).into_iter().enumerate() {
            let edges = |period: usize| [period as f64 / 50.0, (period as f64 + of_period(index, period)) / 50.0];
            let time = (0..COMMANDS.div_ceil(PERIOD)).flat_map(edges).collect::<Vec<f64>>();
            let request = (0..time.len()).map(|edge| [Request::Fill, Request::Exhaust][edge % 2]).collect();
            let command = Command::table(time, request).expect("a table");
            assert_eq!(found, beforehand(&rows[index], command, Method::Stable), "row {index}, {width:?}");
        }
    }
}

/// More commands on their way to a valve than its numbers have room for would be refused.
#[test]
fn of_two_in_one_instant_the_later_counts_and_the_memory_does_not_grow() {
    let paper = paper(0).with(|rig| rig.kind = ValveKind::FillHoldExhaust);
    let mut steps = Row { rig: paper.rig(), start: paper.start() }.steps(Method::Stable);
    let mut numbers = vec![0.0; steps.state_size()];
    // Coils that are never driven for as long as a poppet takes to move.
    for count in 0..2000 {
        steps.set(0, Request::Exhaust).expect("set");
        steps.set(0, if count % 2 == 0 { Request::Fill } else { Request::Hold }).expect("set");
        steps.advance_to(millisecond(count + 1)).expect("a step");
        steps.save_to(&mut numbers).expect("room for what is on its way");
    }
    let ports = steps.mode().network.valves[0].ports;
    assert!(!ports.supply && !ports.exhaust, "{ports:?}");
}

#[test]
fn a_row_that_begins_again_is_one_that_began_there_and_touches_no_other() {
    const BEFORE: usize = 64;
    let rows = plain(21);
    let again = |index: usize, method: Method| {
        let row = Row { rig: paper(index + 100).rig(), start: paper(index + 100).start() };
        let start = Plant::start_of_rig(&row.rig, &row.start);
        row.run().begin_again(&start, millisecond(BEFORE)).expect("a start").steps(method)
    };
    let restarted = |index: usize| index % 5 == 3;
    for (width, method) in
        Width::available().into_iter().flat_map(|width| [(width, Method::Stable), (width, Method::Rk4)])
    {
        let mut batches = [false, true].map(|_| batch(&rows, method, width));
        for (some_restart, batch) in batches.iter_mut().enumerate() {
            for count in 0..BEFORE + COMMANDS {
                for index in 0..batch.len() {
                    if some_restart == 1 && count == BEFORE && restarted(index) {
                        batch.restart(index, again(index, method)).expect("begins again");
                    }
                    let count = if restarted(index) { (count + COMMANDS - BEFORE) % COMMANDS } else { count };
                    batch.set(index, 0, fill_or_exhaust(index, count)).expect("set");
                }
                batch.advance(millisecond(count + 1), STEPS).expect("a time");
            }
        }
        let [untouched, found] = batches.each_mut().map(ends);
        for (index, (found, before)) in found.into_iter().zip(untouched).enumerate() {
            if restarted(index) {
                let expected = set(again(index, method), BEFORE, |count| fill_or_exhaust(index, count));
                assert_eq!(found, expected, "row {index}, {width:?}, {method:?}");
            } else {
                assert_eq!(found, before, "row {index}, {width:?}, {method:?}");
            }
        }
    }
}

#[test]
fn a_row_that_has_stopped_lives_again() {
    for width in Width::available() {
        // Two of five loads pull the braid straight.
        let row = |index: usize| {
            let of = if index % 3 == 1 { paper(index).mass(500.0) } else { paper(index) };
            let of = of.from(0.085, 0.0);
            Row { rig: of.rig(), start: of.start() }
        };
        let rows: Vec<Row> = (0..5).map(row).collect();
        let mut batch = batch(&rows, Method::Rk4, width);
        batch.advance(0.2, 400).expect("a time");
        for index in 0..5 {
            let stopped = index % 3 == 1;
            assert_eq!(batch.row(index).is_err(), stopped, "{width:?} {index}");
            assert_eq!(batch.set(index, 0, Request::Exhaust).is_err(), stopped);
            let Row { rig, start } = &rows[index];
            let start = Plant::start_of_rig(rig, start);
            let again = rows[index].run().begin_again(&start, 0.2).expect("a start");
            batch.restart(index, again.steps(Method::Rk4)).expect("begins again");
        }
        batch.advance(0.201, STEPS).expect("a time");
        assert!((0..5).all(|index| batch.row(index).is_ok()), "{width:?}");
    }
}

/// A row that begins again with other numbers has those of its block taken again; the time is the batch's, wherever a row that
/// stopped before has been.
#[test]
fn a_row_that_has_stopped_does_not_hold_up_those_that_begin_again() {
    let row = |index: usize| {
        let of = if index == 0 { paper(index).mass(500.0) } else { paper(index) };
        let of = of.from(0.085, 0.0);
        Row { rig: of.rig(), start: of.start() }
    };
    for width in Width::available() {
        let rows: Vec<Row> = (0..3).map(row).collect();
        let mut batch = batch(&rows, Method::Stable, width);
        batch.advance(0.2, 200).expect("a time");
        assert!(batch.row(0).is_err(), "the first load pulls the braid straight, {width:?}");
        let other = row(7);
        let start = Plant::start_of_rig(&other.rig, &other.start);
        let again = other.run().begin_again(&start, 0.2).expect("a start").steps(Method::Stable);
        let [mut scalar, mut beside] = [again.clone(), rows[2].steps(Method::Stable)];
        batch.restart(1, again).expect("begins again");
        batch.advance(0.3, 100).expect("a time");
        (1..=200).for_each(|count| beside.advance_to(0.2 * (f64::from(count) / 200.0)).expect("a step"));
        for steps in [&mut scalar, &mut beside] {
            let length = 0.3 - 0.2;
            (1..100).for_each(|count| {
                steps.advance_to(0.2 + length * (f64::from(count) / 100.0)).expect("a step");
            });
            steps.advance_to(0.3).expect("a step");
        }
        assert_eq!(batch.row(1).map(end), Ok(end(&scalar)), "{width:?}");
        assert_eq!(batch.row(2).map(end), Ok(end(&beside)), "{width:?}");
    }
}

#[test]
fn what_cannot_be_set_is_refused_and_changes_nothing() {
    let rows = [row(0).0, Row { rig: Paper::sealed().rig(), start: Paper::sealed().start() }, row(6).0, row(7).0];
    let mut batch = batch(&rows, Method::Stable, Width::widest());
    batch.set(0, 0, Request::Fill).expect("set");
    let feed = batch.plant(3).and_then(|plant| plant.network().feed_of(0)).expect("a regulator");
    batch.set(3, 0, RuntimeCommand::SetPoint(GaugePressure(feed))).expect("set");
    let unchanged = ends(&mut batch);
    let said = |refused: Result<(), Error>| refused.expect_err("refused").to_string();
    assert!(said(batch.set(0, 0, Request::Hold)).contains("cannot hold"));
    assert!(said(batch.set(0, 0, pulses(50.0, 1.5))).contains("duty"));
    assert!(said(batch.set(0, 0, pulses(0.0, 0.5))).contains("frequency"));
    assert!(said(batch.set(0, 0, RuntimeCommand::Position(0.5))).contains("no proportional spool"));
    assert!(said(batch.set(0, 0, RuntimeCommand::SetPoint(GaugePressure(1e5)))).contains("no pressure regulator"));
    assert!(said(batch.set(1, 0, Request::Fill)).contains("not there"));
    assert!(said(batch.set(2, 0, Request::Fill)).contains("positions"));
    assert!(said(batch.set(2, 0, RuntimeCommand::Position(1.5))).contains("command.position"));
    // Also where one that it takes is in force.
    let above = RuntimeCommand::SetPoint(GaugePressure(feed + 1.0));
    assert!(said(batch.set(3, 0, above)).contains("cannot give more than feeds it"));
    assert!(said(batch.set(4, 0, Request::Fill)).contains("count the rows"));
    assert_eq!(ends(&mut batch), unchanged);
}
