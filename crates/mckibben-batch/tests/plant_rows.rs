//! Batches of plants of many kinds: a row is bit-identical to its scalar instance, wherever it stands and whatever steps it; a
//! row that fails reports an error and changes no other.
//!
//! `cargo xtask rows` tries ten million random rows.

use crate::common::laws;
use crate::common::random;
use crate::common::{INCH, LB, PSI, Paper, ROOM};
use mckibben::line::{Compressor, Hose, HoseKind, Leakage, Line, Regulator, Reservoir, SupplyLine};
use mckibben::load::{Load, Motion, SeriesTendon};
use mckibben::plant::{Plant, PlantRow, PlantRun, PlantSteps};
use mckibben::simulation::{InitialLength, Method, Rig, State};
use mckibben::{Error, GaugePressure, air::Process};
use mckibben_batch::{PlantBatch, Precision, Width};
use proptest::strategy::{Strategy, ValueTree};
use random::{cases, runner};

/// Random rows that are tried when `MCKIBBEN_CASES` is not set.
const CASES: u32 = 100_000;
/// Random rows that are stepped together.
const TOGETHER: usize = 500;

/// A rig and its state at the start.
#[derive(Clone, Debug)]
struct Row {
    rig: Rig,
    start: State,
}

impl Row {
    fn steps(&self, method: Method) -> Result<PlantSteps, Error> {
        let (plant, start) = (Plant::of_rig(&self.rig), Plant::start_of_rig(&self.rig, &self.start));
        Ok(PlantRun::new(&plant, &start, 1e-9)?.steps(method))
    }
}

/// A machine without wide registers tests fewer kernels: which ones were tested is printed, past the capture of output.
#[test]
fn the_vector_widths_of_this_machine_are_printed() {
    use std::io::Write;
    let widths = Width::available();
    assert_eq!(widths[0], Width::Baseline);
    writeln!(std::io::stdout(), "\ntested: vector widths {widths:?}").expect("standard output");
}

/// A number between 0 and 1 that differs from row to row.
fn spread(row: usize, stride: f64) -> f64 {
    (row as f64 * stride).fract()
}

/// Rows of several forms: masses under PWM of different frequency and duty, held ends, a motion by a table, a sealed one,
/// and other laws of force.
fn row(index: usize) -> Row {
    let (u, v) = (spread(index, 0.618_033_988_749_895), spread(index, 0.754_877_666_246_693));
    let paper = Paper::pwm(15.0 + 20.0 * u, 0.2 + 0.6 * v).mass((3.0 + 10.0 * v) * LB).gauge(30.0 * PSI);
    let paper = paper.with(|rig| rig.supply_gauge = (60.0 + 50.0 * u) * PSI);
    let paper = match index % 11 {
        3 => paper.isometric((3.0 + 0.8 * u) * INCH),
        5 => paper.process(Process::EnergyBalance { heat_transfer: 0.1 * v, wall_temperature: 290.0 }),
        7 => paper.with(|rig| {
            let corners = vec![0.0, 0.013 + 0.02 * u, 0.05, 0.2];
            let lengths = [3.5, 3.0 + 0.4 * v, 3.7, 3.2].map(|inches| inches * INCH).to_vec();
            rig.load = Load::Prescribed(Motion::table(corners, lengths, rig.thread_length).expect("a motion"));
            rig.length = InitialLength::At(3.5 * INCH);
        }),
        kind @ (1 | 2 | 4 | 6) => {
            let place = 4 * (index / 11) + [1, 2, 4, 6].iter().position(|of| *of == kind).unwrap_or(0);
            let all = laws::all(&paper);
            let law = all[1 + place % (all.len() - 1)].1.clone();
            paper.with(|rig| rig.characteristic = Some(law))
        }
        8 => {
            let map = laws::measured(&paper);
            paper.with(|rig| rig.characteristic = Some(map))
        }
        9 => paper.with(|rig| rig.command = None).from((3.3 + 0.2 * u) * INCH, v - 0.5),
        _ => paper,
    };
    let line = match index % 11 {
        1 => Line { hose: Some(hose(HoseKind::Lumped, [0.3 + 2.0 * u, (1.5 + 3.0 * v) * 1e-3])), ..Line::NONE },
        2 => Line { leakage: Some(Leakage::new(2e-11 * u).expect("a leak")), ..Line::NONE },
        0 => Line { supply: Some(supply(u, true, true)), ..Line::NONE },
        4 => Line {
            supply: Some(supply(v, true, false)),
            leakage: Some(Leakage::new(2e-11 * u).expect("a leak")),
            ..Line::NONE
        },
        5 => Line {
            hose: Some(hose(HoseKind::Distributed { cells: 3 }, [0.3 + 2.0 * u, (2.0 + 3.0 * v) * 1e-3])),
            supply: Some(supply(u, true, true)),
            ..Line::NONE
        },
        6 => Line {
            hose: Some(hose(HoseKind::Lumped, [0.3 + 2.0 * u, (2.0 + 3.0 * v) * 1e-3])),
            supply: Some(supply(u, false, true)),
            ..Line::NONE
        },
        10 => Line {
            hose: Some(hose(HoseKind::Distributed { cells: 8 }, [1.0 + 2.0 * u, (2.0 + 3.0 * v) * 1e-3])),
            ..Line::NONE
        },
        8 => Line {
            hose: Some(hose(HoseKind::Lumped, [0.3 + 2.0 * u, (1.5 + 3.0 * v) * 1e-3])),
            leakage: Some(Leakage::new(2e-11 * v).expect("a leak")),
            ..Line::NONE
        },
        _ => Line::NONE,
    };
    Row { rig: paper.rig().with_line(line).expect("a line"), start: paper.start() }
}

/// A supply whose compressor starts and stops within the run.
fn supply(u: f64, tank: bool, regulated: bool) -> SupplyLine {
    let air = Paper::sealed().air();
    let bounds = [GaugePressure((60.0 + 20.0 * u) * PSI), GaugePressure((60.5 + 20.0 * u) * PSI)];
    let compressor = Compressor::new([5e-3, 0.03], bounds, &air).expect("a compressor");
    let reservoir = Reservoir::new([3e-4 + 1e-4 * u, 1.2, ROOM], bounds[0], Some(compressor), &air).expect("a tank");
    let regulator = Regulator::new(1e7 * u, 500.0, 4e-3).expect("a regulator");
    SupplyLine::new(tank.then_some(reservoir), regulated.then_some(regulator), 1.0 + 2.0 * u).expect("a supply")
}

fn hose(kind: HoseKind, size: [f64; 2]) -> Hose {
    Hose::new(kind, size, [1.82e-5, ROOM, 1.2], &Paper::sealed().air()).expect("a hose")
}

fn rows(count: usize) -> Vec<Row> {
    (0..count).map(row).collect()
}

/// Steps of 0.1 ms in three unequal spans.
const SPANS: [(f64, u64); 3] = [(0.01, 100), (0.013, 30), (0.12, 1070)];

/// All that a row shows at the end, to the bit, or why it stopped.
type End = Result<String, Error>;

fn begun(rows: &[Row], method: Method, width: Width) -> PlantBatch {
    let steps = rows.iter().map(|row| row.steps(method).expect("a start"));
    PlantBatch::with_lanes(steps, width, Precision::Double).expect("rows at one time")
}

fn ends(batch: &mut PlantBatch) -> Vec<End> {
    (0..batch.len()).map(|row| batch.row(row).map(end)).collect()
}

/// What is known of a row, in digits that distinguish any two numbers.
fn end(steps: &PlantRow) -> String {
    format!("{:?} {:?}", steps.state(), steps.sample())
}

fn end_of(rows: &[Row], method: Method, width: Width) -> Vec<End> {
    let mut batch = begun(rows, method, width);
    for (until, steps) in SPANS {
        batch.advance(until, steps).expect("a time");
    }
    ends(&mut batch)
}

/// The end of a row stepped as a scalar instance.
fn scalar(row: &Row, method: Method) -> End {
    let mut stepper = row.steps(method)?;
    let mut from = 0.0;
    for (until, steps) in SPANS {
        go_on(&mut stepper, [from, until], steps)?;
        from = until;
    }
    Ok(end(&stepper))
}

fn go_on(stepper: &mut PlantSteps, [from, until]: [f64; 2], steps: u64) -> Result<(), Error> {
    (1..=steps).try_for_each(|step| {
        let part = from + (until - from) * (step as f64 / steps as f64);
        stepper.advance_to(if step == steps { until } else { part })
    })
}

#[test]
fn a_row_is_the_run_of_its_steps_bit_for_bit_at_any_width() {
    let rows = rows(45);
    for method in [Method::Rk4, Method::Stable] {
        let expected: Vec<End> = rows.iter().map(|row| scalar(row, method)).collect();
        for width in Width::available() {
            for (index, (found, expected)) in end_of(&rows, method, width).iter().zip(&expected).enumerate() {
                assert_eq!(found, expected, "row {index}, {method:?}, {width:?}");
                assert!(found.is_ok(), "row {index} goes on");
            }
        }
    }
}

#[test]
fn a_row_has_the_same_bits_whatever_the_size_the_place_and_the_threads() {
    let all = rows(45);
    let whole = end_of(&all, Method::Rk4, Width::widest());
    for count in [1, 2, 7, 8, 9, 17, 44] {
        assert_eq!(end_of(&all[..count], Method::Rk4, Width::widest()), whole[..count], "{count} rows");
    }
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let backwards: Vec<Row> = all.iter().rev().cloned().collect();
        let mut found = pool.install(|| end_of(&backwards, Method::Rk4, Width::widest()));
        found.reverse();
        assert_eq!(found, whole, "{threads} threads");
    }
}

#[test]
fn rigs_on_a_tendon_go_on_wherever_they_stand() {
    let others = rows(16);
    let good = end_of(&others, Method::Stable, Width::widest());
    let tendon = SeriesTendon::new(1e4, 0.1).expect("a tendon");
    let on_tendon = [1, 3, 9].map(|index| {
        let Row { rig, start } = row(index);
        Row { rig: rig.with_tendon(tendon), start }
    });
    let expected = on_tendon.each_ref().map(|row| scalar(row, Method::Stable));
    for width in Width::available() {
        let mut mixed = others.clone();
        let places = [0, 6, 18];
        for (place, row) in places.into_iter().zip(&on_tendon) {
            mixed.insert(place, row.clone());
        }
        let mut ended = end_of(&mixed, Method::Stable, width);
        for (place, expected) in places.into_iter().zip(&expected).rev() {
            assert_eq!(&ended.remove(place), expected, "{width:?}");
        }
        assert_eq!(ended, good, "{width:?}");
    }
}

/// A load that pulls the braid straight within the run.
fn doomed() -> Row {
    let paper = Paper::pwm(25.0, 0.5).mass(500.0).gauge(30.0 * PSI).from(0.085, 0.0);
    Row { rig: paper.rig(), start: paper.start() }
}

#[test]
fn a_row_that_fails_has_an_error_and_changes_no_other() {
    let others = rows(16);
    let good = end_of(&others, Method::Rk4, Width::widest());
    let expected = scalar(&doomed(), Method::Rk4);
    assert!(matches!(expected, Err(Error::Stopped { .. })), "{expected:?}");
    for width in Width::available() {
        for place in [0, 3, 8, 16] {
            let mut mixed = others.clone();
            mixed.insert(place, doomed());
            let mut batch = begun(&mixed, Method::Rk4, width);
            for (until, steps) in SPANS {
                batch.advance(until, steps).expect("a time");
            }
            let mut ended = ends(&mut batch);
            assert_eq!(ended.remove(place), expected, "at {place}, {width:?}");
            assert_eq!(ended, good);
            // It does not come back.
            batch.advance(0.2, 100).expect("a time");
            assert!(batch.row(place).is_err());
            assert_eq!(batch.row(usize::from(place == 0)).map(|row| row.time()), Ok(0.2));
        }
    }
}

#[test]
fn any_admissible_row_goes_on_or_says_why_not() {
    let (mut runner, strategy) = (runner(CASES), cases());
    let wanted = runner.config().cases as usize;
    let (mut tried, mut stopped, mut checked) = (0, 0, 0);
    while tried < wanted {
        let mut papers = Vec::with_capacity(TOGETHER);
        let round = tried / TOGETHER;
        let method = if round.is_multiple_of(2) { Method::Rk4 } else { Method::Stable };
        while papers.len() < TOGETHER {
            let case = strategy.new_tree(&mut runner).expect("a case").current();
            let rig = case.paper.rig();
            if let Ok(start) = rig.start(&case.paper.initial()) {
                let row = Row { rig, start };
                // Some ends on tendons have no balance at the start.
                if row.steps(method).is_ok() {
                    papers.push(row);
                }
            }
        }
        let (until, steps) = [(2e-3, 20), (5e-3, 10), (1e-3, 200), (2e-2, 20)][round / 2 % 4];
        let mut batch = begun(&papers, method, Width::widest());
        batch.advance(until, steps).expect("a time");
        for (index, of) in papers.iter().enumerate() {
            if index % 23 == round % 7 {
                let mut stepper = of.steps(method).expect("a start");
                let expected = go_on(&mut stepper, [0.0, until], steps).map(|()| end(&stepper));
                // What is not a number equals nothing, but reads the same.
                let text = |found: End| found.map_err(|error| error.to_string());
                assert_eq!(text(batch.row(index).map(end)), text(expected), "{of:?}");
                checked += 1;
            }
            match batch.row(index).map(PlantRow::sample) {
                Ok(sample) => {
                    let s = &sample.actuators[0];
                    let numbers = [s.length, s.velocity, s.pressure.0, s.air_mass, s.temperature, s.volume, s.tension];
                    assert!(numbers.iter().all(|number| number.is_finite()), "{s:?} of {of:?}");
                    assert!(s.pressure.0 > 0.0 && s.air_mass > 0.0 && s.tension >= 0.0, "{s:?} of {of:?}");
                }
                Err(Error::Stopped { time, .. }) => {
                    assert!(time <= until, "{time}");
                    stopped += 1;
                }
                Err(other) => panic!("{other}"),
            }
        }
        tried += TOGETHER;
    }
    println!("{tried} rows, {stopped} left the physics at their step; {checked} compared bit for bit");
    assert!(stopped < tried / 2, "{stopped} of {tried} rows say nothing");
}
