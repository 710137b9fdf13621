//! Controllers in batches: each row is the run of the fixed-step engine with that controller, bit for bit.

use crate::common;
use common::{LB, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::batch::{Batch, ControlledRow, Float, Width};
use mckibben::control::{
    Controller, Drive, Measurement, Output, Pid, Quantity, Regulator, Sampling, Sensor, Sensors, SetPoint, Tracker,
};
use mckibben::line::{Hose, HoseKind, Line, Reservoir, SupplyLine};
use mckibben::load::SeriesTendon;
use mckibben::simulation::{ControlledStepper, Decision, Method, Rig, Sample};
use mckibben::valve::{Request, ValveKind};
use mckibben::{Error, GaugePressure};

type Trackers = Vec<ControlledRow<Tracker>>;

/// Pressures that are to be kept, by rows that differ in mass, gain, rate, line and tendon; some sample together.
fn rows(count: usize) -> Trackers {
    (0..count)
        .map(|row| {
            let (u, v) = (common::spread(row, 0), common::spread(row, 1));
            let paper = Paper::pwm(50.0, 0.5).mass((2.0 + 8.0 * u) * LB).gauge(20.0 * PSI);
            let paper = paper.with(|rig| rig.kind = ValveKind::FillHoldExhaust);
            let air = paper.air();
            let hose = Hose::new(HoseKind::Lumped, [0.5 + u, 3e-3], [1.82e-5, ROOM, 1.0], &air).expect("a hose");
            let bottle = Reservoir::new([5e-4, 1.0, ROOM], GaugePressure(6.5e5), None, &air).expect("a bottle");
            let supply = SupplyLine::new(Some(bottle), None, 1.0).expect("a supply");
            let line = match row % 5 {
                2 => Line { hose: Some(hose), ..Line::NONE },
                4 => Line { supply: Some(supply), ..Line::NONE },
                _ => Line::NONE,
            };
            let pid = Pid::new(Quantity::Pressure, (30.0 + 40.0 * v) * PSI, Output::FillHoldExhaust);
            let pid = pid.and_then(|pid| pid.with_integral(0.2)).expect("a controller");
            let set_point = SetPoint::constant(Quantity::Pressure, (30.0 + 40.0 * u) * PSI).expect("a set point");
            let coarse = Sensor::new(Quantity::Pressure, 500.0, None).expect("a sensor");
            let rig = paper.rig().with_line(line).expect("a line");
            let tendon = SeriesTendon::new(5e3 + 2e4 * v, 0.1).expect("a tendon");
            ControlledRow {
                rig: if row % 7 == 4 { rig.with_tendon(tendon) } else { rig },
                start: paper.start(),
                controller: Tracker::new(Quantity::Pressure, set_point, Regulator::Pid(pid)).expect("a tracker"),
                sampling: Sampling::new([50.0, 50.0, 80.0][row % 3], row % 2).expect("a rate"),
                sensors: Sensors { pressure: coarse, ..Sensors::perfect() },
            }
        })
        .collect()
}

/// Steps of half a millisecond, in two spans of which one ends between two samples.
const SPANS: [(f64, u64); 2] = [(0.113, 226), (0.4, 574)];

fn alone(row: &ControlledRow<Tracker>, method: Method) -> (Sample, Vec<Decision>) {
    let set_up = (row.sampling, row.sensors);
    let mut stepper = ControlledStepper::new(&row.rig, row.start, method, &row.controller, set_up).expect("a loop");
    let mut from = 0.0;
    for (until, steps) in SPANS {
        for step in 1..=steps {
            let part = from + (until - from) * (step as f64 / steps as f64);
            stepper.advance_to(if step == steps { until } else { part }).expect("a step");
        }
        from = until;
    }
    (stepper.sample(), stepper.decisions().to_vec())
}

fn together<F: Float>(rows: Trackers, method: Method, width: Width) -> Batch<F> {
    let mut batch = Batch::controlled_with_width(rows, method, width).expect("loops");
    SPANS.into_iter().for_each(|(until, steps)| batch.advance(until, steps));
    batch
}

#[test]
fn a_row_is_the_controlled_run_bit_for_bit_at_any_width() {
    for method in [Method::Stable, Method::Rk4] {
        for width in Width::available() {
            let batch = together::<f64>(rows(37), method, width);
            for (index, sample) in batch.samples().into_iter().enumerate() {
                let (expected, decisions) = alone(&rows(37)[index], method);
                assert!(decisions.len() > 15, "{}", decisions.len());
                assert_eq!(batch.decisions(index), decisions, "row {index}, {method:?}, {width:?}");
                assert_eq!(sample.expect("a row"), expected, "row {index}, {method:?}, {width:?}");
            }
        }
    }
}

/// Asks of a three-way valve what it cannot do.
#[derive(Debug)]
struct Holds;

impl Controller for Holds {
    type Memory = ();

    fn begin(&self) {}

    fn decide(&self, _seen: &Measurement, (): &mut ()) -> Drive {
        Drive::Steady(Request::Hold)
    }
}

#[test]
fn what_a_valve_cannot_do_is_the_row_s_own_fault_on_a_tendon_too() {
    let paper = Paper::pwm(50.0, 0.5);
    let tendon = SeriesTendon::new(1e4, 0.1).expect("a tendon");
    let set_up = (Sampling::new(50.0, 0).expect("a rate"), Sensors::perfect());
    let row = |rig: Rig| ControlledRow {
        rig,
        start: paper.start(),
        controller: Holds,
        sampling: set_up.0,
        sensors: set_up.1,
    };
    let rows = vec![row(paper.rig()), row(paper.rig().with_tendon(tendon))];
    let mut batch = Batch::<f64>::controlled(rows, Method::Stable).expect("loops");
    batch.advance(0.1, 100);
    for sample in batch.samples() {
        assert!(sample.expect_err("refused").to_string().contains("cannot hold"));
    }
}

#[test]
fn half_the_precision_keeps_to_the_set_point_as_well() {
    /// No row is faster, in m/s.
    const FASTEST: f64 = 1.0;
    let (double, single) = (
        together::<f64>(rows(20), Method::Stable, Width::widest()),
        together::<f32>(rows(20), Method::Stable, Width::widest()),
    );
    for (double, single) in double.samples().into_iter().zip(single.samples()) {
        let (double, single) = (double.expect("a row"), single.expect("a row"));
        let rounding = common::single_rounding(SPANS.iter().map(|(_, steps)| steps).sum());
        assert_close(single.length, double.length, rounding);
        assert_within(single.velocity, double.velocity, rounding * FASTEST);
        assert_close(single.pressure.0, double.pressure.0, rounding);
        assert_close(single.air_mass, double.air_mass, rounding);
    }
}

#[test]
fn a_controller_without_a_valve_is_refused_at_once() {
    let mut without = rows(2);
    without[1].rig = Paper::sealed().rig();
    assert!(matches!(Batch::<f64>::controlled(without, Method::Stable), Err(Error::Misuse { .. })));
}
