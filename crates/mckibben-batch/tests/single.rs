//! Lanes of single precision beside scalar instances in double.
//!
//! They differ by 1e-6 to 1e-5 of the largest value that a state has had where nothing switches, and by more where an event comes in
//! another step. What is allowed is far above both and far below what a wrong formula would do.

use mckibben::Error;
use mckibben::plant::PlantSteps;
use mckibben::simulation::Method;
use mckibben_batch::{PlantBatch, Precision, Width};

/// Part of its largest value by which a state may be off, and a rate.
const STATE: f64 = 1e-2;
const RATE: f64 = 5e-2;
/// Part of its largest value by which a state of the first row may differ from that of the row alone. Rows that step in double precision
/// instead are ten times as far from it.
const BESIDE: f64 = 1e-6;
/// What slower rates (m/s, rad/s) and weaker flows (kg/s) are compared with: near rest they are rounding.
const SLOW: f64 = 1e-3;
const WEAK: f64 = 1e-5;
/// Likewise of an end that sticks and slides on a tendon, in steps of the stable method: it slides a step sooner or later.
const STICKS: f64 = 0.1;

/// Batches of every width in single precision, and how far their states come from those of scalar instances.
pub(crate) struct Singles {
    batches: Vec<PlantBatch>,
    /// Of every width, the first row alone.
    alone: Vec<PlantBatch>,
    /// Of each state of each row: how far it has been from its scalar instance, and how large that has been.
    apart: Vec<Vec<[f64; 2]>>,
}

impl Singles {
    pub(crate) fn new(rows: &[PlantSteps]) -> Self {
        let of = |rows: &[PlantSteps]| {
            let single =
                |width| PlantBatch::with_lanes(rows.to_vec(), width, Precision::Single).expect("rows at one time");
            Width::available().into_iter().map(single).collect()
        };
        let apart = rows.iter().map(|row| vec![[0.0; 2]; row.state().len()]).collect();
        Self { batches: of(rows), alone: of(&rows[..rows.len().min(1)]), apart }
    }

    /// Goes on to a time in s that the scalar instances have reached, unless they have stopped.
    pub(crate) fn go_on(&mut self, until: f64, scalar: &[PlantSteps], faults: &[Option<Error>]) {
        for (batch, alone) in self.batches.iter_mut().zip(&mut self.alone) {
            batch.advance_to(until).expect("a time");
            alone.advance_to(until).expect("a time");
            if let (Ok(beside), Ok(alone)) = (batch.row(0), alone.row(0)) {
                for ((beside, alone), [_, size]) in beside.state().iter().zip(alone.state()).zip(&self.apart[0]) {
                    let off = (beside - alone).abs();
                    assert!(off <= BESIDE * size.max(SLOW), "{beside} beside others and {alone} alone at {until} s");
                }
            }
            for (index, (row, apart)) in scalar.iter().zip(&mut self.apart).enumerate() {
                match (batch.row(index), &faults[index]) {
                    (Ok(found), None) => {
                        for ((found, expected), [most, size]) in found.state().iter().zip(row.state()).zip(apart) {
                            *most = most.max((found - expected).abs());
                            *size = size.max(expected.abs());
                        }
                    }
                    (Err(_), Some(_)) => {}
                    (found, fault) => panic!("row {index} at {until} s: {:?}, {fault:?}", found.err()),
                }
            }
        }
    }

    /// Checks that no state of a row that goes on has been too far off.
    pub(crate) fn check(&self, scalar: &[PlantSteps], faults: &[Option<Error>]) {
        for (index, (row, apart)) in scalar.iter().zip(&self.apart).enumerate() {
            if faults[index].is_some() {
                continue;
            }
            let (plant, places) = (row.plant(), row.plant().indices());
            let sticks = plant.actuators().iter().any(|its| {
                its.tendon.is_some() && its.actuator.friction().has_direction() && row.method() == Method::Stable
            });
            let is_rate = |place: usize| {
                places.mechanisms.iter().any(|here| (0..here.coordinates).any(|k| here.rate(k) == place))
            };
            let is_flow = |place: usize| places.branches.contains(&Some(place));
            let is_bent = |place: usize| places.actuators.iter().any(|here| here.bristles == Some(place));
            for (place, [most, size]) in apart.iter().enumerate() {
                let allowed = match sticks {
                    // In long steps bristles swing further than they bend, in double precision too.
                    true if is_bent(place) => continue,
                    true => STICKS * size,
                    false if is_rate(place) => RATE * size.max(SLOW),
                    false if is_flow(place) => RATE * size.max(WEAK),
                    false => STATE * size,
                };
                assert!(*most <= allowed, "state {place} of row {index} is off by {most:e}, of {size:e}");
            }
        }
    }
}

/// Rows in single precision, some of whose steps are too long, have finite states as long as they go on.
pub(crate) fn go_on_or_stop(rows: Vec<PlantSteps>, step: f64, steps: u32) {
    let mut batch = PlantBatch::with_precision(rows, Precision::Single).expect("rows at one time");
    for count in 1..=steps {
        batch.advance_to(step * f64::from(count)).expect("a time");
    }
    for row in batch.rows().into_iter().flatten() {
        assert!(row.state().iter().all(|number| number.is_finite()), "{:?}", row.state());
    }
}
