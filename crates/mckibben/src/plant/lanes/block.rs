//! Plants of equal structure side by side: their numbers dealt to lanes, and the stages of a step for all of them.

use super::super::Plant;
use super::super::evaluation::{Evaluation, System};
use super::super::steps::{PlantSteps, Stages};
use super::super::wire::{Assembly, Wire};
use super::held::Held;
use crate::batch::gather::{Blank, Deal, List};
use crate::batch::wide::{Compiled, Wide, compiled};
use crate::network::piping::Piping;
use crate::simulation::Method;
use crate::simulation::member::Member;
use crate::valve::{Command, Request};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt::Debug;
use core::marker::PhantomData;
use pulp::Simd;

/// The stages of a step for several plants, whatever the width.
pub(super) trait Lanes: Debug + Send + Sync {
    /// Takes a step of rows that nothing interrupts, from a time in s over a length in s, and hands on the end of each row
    /// where it is to be believed.
    fn take(
        &mut self,
        rows: &[&PlantSteps],
        method: Method,
        span: [f64; 2],
        end: &mut dyn FnMut(usize, Option<&[f64]>),
    );

    /// Takes the numbers of rows anew.
    fn gather(&mut self, rows: &[&PlantSteps]);
}

/// A plant with all its numbers zero: two plants of equal structure are equal.
pub(super) fn structure(plant: &Plant) -> Plant {
    without_commands(plant).convert(&mut Blank)
}

/// Commands differ from row to row, and are not looked at by any stage.
fn without_commands(plant: &Plant) -> Plant {
    let mut plant = plant.clone();
    for actuation in &mut plant.network.valves {
        actuation.command = Command::Constant(Request::Hold);
    }
    plant
}

/// Rows in lanes.
#[derive(Debug)]
pub(super) struct Block<W: Wide<Lane = f64>> {
    system: System<W>,
    stages: Stages<W>,
    at: Evaluation<W>,
    state: Vec<W>,
    end: Vec<W>,
    row: Vec<f64>,
}

/// What a new block is made of.
struct Create<'a, W>(&'a [&'a PlantSteps], PhantomData<W>);

/// A step of a block.
struct Take<'a, W: Wide<Lane = f64>> {
    block: &'a mut Block<W>,
    rows: &'a [&'a PlantSteps],
    method: Method,
    span: [f64; 2],
    end: &'a mut dyn FnMut(usize, Option<&[f64]>),
}

impl<W: Wide<Lane = f64>> Block<W> {
    /// A block of rows of equal structure, as many as there are lanes at most.
    pub(super) fn new(rows: &[&PlantSteps]) -> Self {
        compiled(Create::<W>(rows, PhantomData))
    }
}

impl<W: Wide<Lane = f64>> Lanes for Block<W> {
    fn take(
        &mut self,
        rows: &[&PlantSteps],
        method: Method,
        span: [f64; 2],
        end: &mut dyn FnMut(usize, Option<&[f64]>),
    ) {
        compiled(Take { block: self, rows, method, span, end });
    }

    fn gather(&mut self, rows: &[&PlantSteps]) {
        *self = Self::new(rows);
    }
}

impl<W: Wide<Lane = f64>> Compiled for Create<'_, W> {
    type Wide = W;
    type Output = Block<W>;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Block<W> {
        let rows = self.0;
        let lists: Vec<Vec<f64>> = rows
            .iter()
            .map(|row| {
                let mut list = List(Vec::new());
                without_commands(row.plant()).convert(&mut list);
                list.0
            })
            .collect();
        let plant: Plant<W> = without_commands(rows[0].plant()).convert(&mut Deal::new(&lists));
        let plant = Arc::new(plant);
        let wires = plant.actuators.iter().enumerate();
        let wires = wires.map(|(index, mounted)| Wire::new(&plant, index, Member::in_lanes(&mounted.actuator)));
        let system = System {
            wires: wires.collect(),
            assemblies: (0..plant.mechanisms.len()).map(|m| Assembly::new(&plant, m)).collect(),
            piping: Piping::new(&plant),
            band: 0.0,
            arms: Vec::new(),
            usual_torque: Vec::new(),
            plant,
        };
        let states = system.plant.places().states;
        let (stages, at) = (Stages::new(&system.plant), Evaluation::new(&system.plant));
        let zeros = vec![W::zero(); states];
        Block { stages, at, state: zeros.clone(), end: zeros, row: vec![0.0; states], system }
    }
}

impl<W: Wide<Lane = f64>> Compiled for Take<'_, W> {
    type Wide = W;
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Self { block, rows, method, span, end: hand_on } = self;
        let Block { system, stages, at, state, end, row } = block;
        let last = rows.len() - 1;
        for (place, number) in state.iter_mut().enumerate() {
            *number = W::from_lanes(|lane| rows[lane.min(last)].state()[place]);
        }
        let mut held = Held::of(&system.plant.network, |lane| rows[lane.min(last)].mode());
        let span = (W::constant(span[0]), W::constant(span[1]));
        let believed = stages.take_unchecked(system, method, span, state, &mut held, at, end);
        for lane in 0..rows.len() {
            for (number, of_lanes) in row.iter_mut().zip(&*end) {
                *number = of_lanes.lane(lane);
            }
            hand_on(lane, W::holds(believed, lane).then_some(&row[..]));
        }
    }
}
