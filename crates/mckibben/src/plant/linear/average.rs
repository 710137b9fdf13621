//! Pulsed valves on average, and how far that holds.
//!
//! ```text
//! ripple    ΔP = (∂Ṗ/∂ṁ) · (greatest − least of ∫(ṁ − mean) dt over a period)     at a fixed length
//! ```
//!
//! The model is valid while every pulse and gap moves the poppets ([`ValveAverage::follows`]), while the ripple is smaller than
//! the way to the nearest pressure beyond a path ([`ValveAverage::ripple_is_small`]), and while the period is short against
//! the model's time constants. Each is reported, none is enforced.

use super::frame::{Drive, Fed, Frame, Number, Quantity};
use crate::air::Flow;
use crate::network::{BranchKind, NodeKind};
use crate::plant::Plant;
use crate::scalar::Scalar;
use crate::simulation::Actuation;
use crate::valve::{Command, Interval, duty_range, period};
use alloc::vec::Vec;

/// A pulsed valve on average, and how far that holds.
#[derive(Clone, Debug, PartialEq)]
pub struct ValveAverage {
    /// The valve.
    pub valve: usize,
    /// Frequency f in Hz.
    pub frequency: f64,
    /// Commanded duty d.
    pub duty: f64,
    /// Actual duty cycles of the flow paths to supply and atmosphere: mean openings over a period.
    pub shares: [f64; 2],
    /// One period of the poppets, from the instant at which the pulse is commanded.
    pub intervals: Vec<Interval>,
    /// Mean flow through the valve, into what it opens into and out of it, in kg/s each.
    pub flow: Flow,
    /// Commanded duties between which every pulse and every gap moves the poppets.
    pub duty_range: (f64, f64),
    /// Peak to peak ripple in Pa of the pressure that the valve opens into, at a fixed length: of a hose that of its volume or
    /// its first cell, which is larger than the ripple in the actuator.
    pub pressure_ripple: f64,
    /// Pressure in Pa from there to the nearest pressure beyond a path.
    pub pressure_margin: f64,
}

impl ValveAverage {
    /// The part of the period in which the path to the supply is open.
    pub fn supply_share(&self) -> f64 {
        self.shares[0]
    }

    /// Whether every pulse and every gap moves the poppets.
    pub fn follows(&self) -> bool {
        (self.duty_range.0..=self.duty_range.1).contains(&self.duty)
    }

    /// Whether the ripple is smaller than the margin, so that the flow keeps its direction and about its size.
    pub fn ripple_is_small(&self) -> bool {
        self.pressure_ripple < self.pressure_margin
    }
}

/// The pulsed valves on average, and how far that holds.
pub(super) fn averages(plant: &Plant, frame: &Frame) -> Vec<ValveAverage> {
    let mut open = frame.clone();
    open.drives.iter_mut().for_each(|drive| *drive = Drive::Openings([1.0; 2]));
    let flows: Vec<f64> = open.evaluate(&[]).at.network.flows.iter().map(|flow| flow.value).collect();
    let now = frame.evaluate(&[]);
    let mut averages = Vec::new();
    for (valve, drive) in frame.drives.iter().enumerate() {
        let (Drive::Duty(duty), Actuation { solenoid, command }) = (drive, &plant.network.valves[valve]) else {
            continue;
        };
        let pulses = crate::valve::with_duty(command, *duty);
        let Some(intervals) = pulses.as_ref().and_then(|pulses| period(solenoid, pulses)) else { continue };
        let Command::Pwm { frequency, .. } = *command else { continue };
        let (mut ripple, mut margin) = (0.0_f64, f64::INFINITY);
        let paths = || {
            plant.network.branches.iter().enumerate().filter_map(move |(index, branch)| match branch.kind {
                BranchKind::Path { valve: its, port, .. } if its == valve => Some((index, branch, port)),
                _ => None,
            })
        };
        for (_, first, _) in paths() {
            let node = first.to;
            let into = |openings: [f64; 2]| -> f64 {
                paths()
                    .filter(|(_, it, _)| it.to == node)
                    .map(|(index, _, port)| flows[index] * openings[port as usize])
                    .sum()
            };
            let mean: f64 = intervals.iter().map(|part| part.share * into(part.openings)).sum();
            let (mut sum, mut least, mut greatest) = (0.0_f64, 0.0_f64, 0.0_f64);
            for part in &intervals {
                let [first, last] = part.ends.map(|openings| into(openings) - mean);
                let lasting = part.share / frequency;
                // Where the flow passes its mean on a stroke, the sum has an extreme.
                let extreme = if first * last < 0.0 { 0.5 * first * first / (first - last) * lasting } else { 0.0 };
                let after = sum + 0.5 * (first + last) * lasting;
                for value in [sum + extreme, after] {
                    (least, greatest) = (least.min(value), greatest.max(value));
                }
                sum = after;
            }
            ripple = ripple.max((greatest - least) * per_mass(frame, node));
            let [here, beyond] = [node, first.from].map(|node| now.at.network.nodes[node].pressure.value);
            margin = margin.min((here - beyond).abs());
        }
        let shares: [f64; 2] = [0, 1].map(|port| intervals.iter().map(|part| part.share * part.openings[port]).sum());
        let mut flow = Flow::none();
        for (index, _, port) in paths() {
            let mean = shares[port as usize] * flows[index];
            flow = flow.and(Flow { inward: mean.max(0.0), outward: (-mean).max(0.0) });
        }
        averages.push(ValveAverage {
            valve,
            frequency,
            duty: *duty,
            shares,
            intervals,
            flow,
            duty_range: duty_range(solenoid, command).unwrap_or((0.0, 1.0)),
            pressure_ripple: ripple,
            pressure_margin: margin,
        });
    }
    averages
}

/// By how much the pressure of a node rises with the air that comes in, in Pa/kg, at a fixed length.
fn per_mass(frame: &Frame, node: usize) -> f64 {
    match &frame.plant.network.nodes[node].kind {
        NodeKind::Chamber { actuator } => {
            let Some(slot) = frame.feed(Fed::Actuator(*actuator)) else { return 0.0 };
            let along = frame.evaluate(&[(Quantity::Slot(slot), 1.0)]);
            let (unit, chamber) = (&along.at.units[*actuator], &along.at.chambers[*actuator]);
            let air = frame.plant.actuators[*actuator].actuator.air();
            let held = crate::air::Chamber { volume_rate: Scalar::constant(0.0), ..*chamber };
            air.pressure_rate_by(&held, &unit.flow, || unit.warmth).slope[0]
        }
        NodeKind::Hose(hose) => hose.stiffness().value,
        NodeKind::Reservoir(reservoir) => reservoir.pressure_rate(Number::constant(1.0)).value,
        _ => 0.0,
    }
}
