//! Batches: a row is the fixed-step engine's run, bit for bit, wherever it stands and whatever steps it; a row that fails
//! says so by itself; half the precision has its bound.
//!
//! `cargo xtask rows` tries ten million random rows.

use crate::common::laws;
use crate::common::random;
use crate::common::{INCH, LB, PSI, Paper, ROOM};
use mckibben::batch::{Batch, Float, Row, Width};
use mckibben::line::{Compressor, Hose, HoseKind, Leakage, Line, Regulator, Reservoir, SupplyLine};
use mckibben::load::{Load, Motion, SeriesTendon};
use mckibben::simulation::{FixedStepper, InitialLength, Method, Sample};
use mckibben::valve::{Command, Request};
use mckibben::{Error, GaugePressure, air::Process};
use proptest::strategy::{Strategy, ValueTree};
use random::{cases, runner};

/// Random rows that are tried when `MCKIBBEN_CASES` is not set.
const CASES: u32 = 100_000;
/// Random rows that are stepped together.
const TOGETHER: usize = 500;

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

/// Rows of several forms: masses under PWM of their own frequency and duty, held ends, a motion by a table, a sealed one,
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

fn end_of<F: Float>(rows: Vec<Row>, method: Method, width: Width) -> Vec<Result<Sample, Error>> {
    let mut batch: Batch<F> = Batch::with_width(rows, method, width);
    for (until, steps) in SPANS {
        batch.advance(until, steps);
    }
    batch.samples()
}

/// The same by the fixed-step engine.
fn alone(row: &Row, method: Method) -> Result<Sample, Error> {
    let mut stepper = FixedStepper::new(&row.rig, row.start, method);
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

/// Bits, so that no two numbers are equal that are not the same.
fn bits(sample: &Result<Sample, Error>) -> [u64; 12] {
    let s = sample.as_ref().expect("a row that goes on");
    let [pressure, hose] = [s.pressure.0, s.hose_pressure.0];
    let supply = s.supply_pressure.map_or(0.0, |pressure| pressure.0);
    let of_line = [hose, s.hose_air_mass, supply].map(f64::to_bits);
    let numbers = [s.time, s.length, s.velocity, pressure, s.air_mass, s.temperature, s.volume, s.tension, s.mass_flow];
    let mut bits = [0; 12];
    bits[..9].copy_from_slice(&numbers.map(f64::to_bits));
    bits[9..].copy_from_slice(&of_line);
    bits
}

#[test]
fn a_row_is_the_fixed_step_engines_run_bit_for_bit_at_any_width() {
    for method in [Method::Rk4, Method::Stable] {
        for width in Width::available() {
            let together = end_of::<f64>(rows(45), method, width);
            for (index, sample) in together.iter().enumerate() {
                assert_eq!(bits(sample), bits(&alone(&row(index), method)), "row {index}, {method:?}, {width:?}");
            }
        }
    }
}

#[test]
fn a_row_has_the_same_bits_whatever_the_size_the_place_and_the_threads() {
    let whole: Vec<_> = end_of::<f64>(rows(45), Method::Rk4, Width::widest()).iter().map(bits).collect();
    let single: Vec<_> = end_of::<f32>(rows(45), Method::Rk4, Width::widest()).iter().map(bits).collect();
    for count in [1, 2, 7, 8, 9, 17, 44] {
        let some = end_of::<f64>(rows(count), Method::Rk4, Width::widest());
        assert_eq!(some.iter().map(bits).collect::<Vec<_>>(), whole[..count], "{count} rows");
    }
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let backwards: Vec<Row> = (0..45).rev().map(row).collect();
        let run = || {
            (
                end_of::<f64>(backwards.clone(), Method::Rk4, Width::widest()),
                end_of::<f32>(backwards.clone(), Method::Rk4, Width::Baseline),
            )
        };
        let (double, half) = pool.install(run);
        assert_eq!(double.iter().rev().map(bits).collect::<Vec<_>>(), whole, "{threads} threads");
        assert_eq!(half.iter().rev().map(bits).collect::<Vec<_>>(), single, "{threads} threads, f32");
    }
}

#[test]
fn rigs_on_a_tendon_go_by_themselves_wherever_they_stand() {
    let good = end_of::<f64>(rows(16), Method::Stable, Width::widest());
    let tendon = SeriesTendon::new(1e4, 0.1).expect("a tendon");
    let on_tendon = [1, 3, 9].map(|index| {
        let Row { rig, start } = row(index);
        Row { rig: rig.with_tendon(tendon), start }
    });
    let expected = on_tendon.each_ref().map(|row| bits(&alone(row, Method::Stable)));
    assert_ne!(expected[0], bits(&alone(&row(1), Method::Stable)));
    for width in Width::available() {
        let mut mixed = rows(16);
        let places = [0, 6, 18];
        for (place, row) in places.into_iter().zip(&on_tendon) {
            mixed.insert(place, row.clone());
        }
        let ended: Vec<_> = end_of::<f64>(mixed.clone(), Method::Stable, width).iter().map(bits).collect();
        // They have their precision whatever that of the lanes.
        let single: Vec<_> = end_of::<f32>(mixed, Method::Stable, width).iter().map(bits).collect();
        assert_eq!(places.map(|place| ended[place]), expected);
        assert_eq!(places.map(|place| single[place]), expected);
        let others = ended.iter().enumerate().filter(|(place, _)| !places.contains(place)).map(|(_, bits)| *bits);
        assert_eq!(others.collect::<Vec<_>>(), good.iter().map(bits).collect::<Vec<_>>());
    }
}

/// A rig a centimetre long, whose air is so little that explicit steps of 0.1 ms leave the physics when it is filled.
fn doomed() -> Row {
    let command = Command::table(vec![0.0, 0.02], vec![Request::Exhaust, Request::Fill]).expect("a command");
    let paper = Paper::driven(command).isometric(0.008).with(|rig| {
        (rig.thread_length, rig.max_length, rig.external_volume) = (0.01, 0.009, 1e-10);
    });
    Row { rig: paper.rig(), start: paper.start() }
}

#[test]
fn a_row_that_fails_has_an_error_of_its_own_and_touches_no_other() {
    let good = end_of::<f64>(rows(16), Method::Rk4, Width::widest());
    let expected = alone(&doomed(), Method::Rk4).expect_err("the step is too long");
    for width in Width::available() {
        for place in [0, 3, 8, 16] {
            let mut mixed = rows(16);
            mixed.insert(place, doomed());
            let mut batch: Batch = Batch::with_width(mixed, Method::Rk4, width);
            for (until, steps) in SPANS {
                batch.advance(until, steps);
            }
            let mut ended = batch.samples();
            assert_eq!(ended.remove(place).expect_err("a fault"), expected, "at {place}, {width:?}");
            assert_eq!(ended.iter().map(bits).collect::<Vec<_>>(), good.iter().map(bits).collect::<Vec<_>>());
            // It does not come back.
            batch.advance(0.2, 100);
            assert_eq!(batch.samples().remove(place).expect_err("a fault"), expected);
        }
    }
}

/// Each of n steps rounds a state of size x by at most a few half units, u = 2⁻²⁴, and the damped rig does not amplify
/// them: the sum of a few roundings a step is below 4 n u x.
#[test]
fn half_the_precision_keeps_its_bound() {
    let steps: u64 = SPANS.iter().map(|(_, steps)| steps).sum();
    let bound = 4.0 * steps as f64 * 2.0_f64.powi(-24);
    let smooth: Vec<Row> =
        rows(45).into_iter().enumerate().filter(|(n, _)| n % 11 == 3 || n % 11 == 7).map(|(_, row)| row).collect();
    let (double, single) = (
        end_of::<f64>(smooth.clone(), Method::Rk4, Width::widest()),
        end_of::<f32>(smooth, Method::Rk4, Width::widest()),
    );
    for (double, single) in double.iter().zip(&single) {
        let (a, b) = (double.as_ref().expect("a run"), single.as_ref().expect("a run"));
        for (a, b) in [(a.length, b.length), (a.pressure.0, b.pressure.0), (a.air_mass, b.air_mass)] {
            assert!((a - b).abs() < bound * a.abs(), "{a} and {b}");
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
        while papers.len() < TOGETHER {
            let case = strategy.new_tree(&mut runner).expect("a case").current();
            let rig = case.paper.rig();
            if let Ok(start) = rig.start(&case.paper.initial()) {
                papers.push(Row { rig, start });
            }
        }
        let round = tried / TOGETHER;
        let method = if round.is_multiple_of(2) { Method::Rk4 } else { Method::Stable };
        let (until, steps) = [(2e-3, 20), (5e-3, 10), (1e-3, 200), (2e-2, 20)][round / 2 % 4];
        let samples = if round.is_multiple_of(3) {
            let mut batch: Batch<f32> = Batch::new(papers.clone(), method);
            batch.advance(until, steps);
            batch.samples()
        } else {
            let mut batch: Batch = Batch::new(papers.clone(), method);
            batch.advance(until, steps);
            let samples = batch.samples();
            for index in (round % 7..TOGETHER).step_by(23) {
                let Row { rig, start } = &papers[index];
                let mut stepper = FixedStepper::new(rig, *start, method);
                let end = (1..=steps).try_for_each(|step| {
                    stepper.advance_to(if step == steps { until } else { until * (step as f64 / steps as f64) })
                });
                match (&samples[index], end) {
                    (Ok(_), Ok(())) => assert_eq!(bits(&samples[index]), bits(&Ok(stepper.sample())), "{rig:?}"),
                    (Err(one), Err(other)) => assert_eq!(one.to_string(), other.to_string(), "{rig:?}"),
                    (one, other) => panic!("{one:?} and {other:?} of {rig:?}"),
                }
                checked += 1;
            }
            samples
        };
        for (sample, Row { rig, start }) in samples.iter().zip(&papers) {
            match sample {
                Ok(s) => {
                    let numbers = [
                        s.length,
                        s.velocity,
                        s.pressure.0,
                        s.air_mass,
                        s.temperature,
                        s.volume,
                        s.tension,
                        s.mass_flow,
                    ];
                    assert!(numbers.iter().all(|number| number.is_finite()), "{s:?} of {rig:?} from {start:?}");
                    assert!(
                        s.pressure.0 > 0.0 && s.air_mass > 0.0 && s.tension >= 0.0,
                        "{s:?} of {rig:?} from {start:?}"
                    );
                }
                Err(Error::Stopped { time, .. }) => {
                    assert!(*time <= until, "{time}");
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
