//! Rows that are taken together: in lanes where they are of equal structure, else one after the other.

use crate::batch::PlantBatch;
#[cfg(target_arch = "x86_64")]
use crate::block::Block;
use crate::block::{self, Lanes};
#[cfg(target_arch = "x86_64")]
use crate::pair;
use crate::precision::Precision;
use crate::row::{Change, Row};
use crate::span::Span;
use crate::width::Width;
use mckibben::plant::{Plant, PlantSteps};
use mckibben::valve::RuntimeCommand;
use mckibben::{Error, Response};

/// Elements that a thread takes together where they are stepped individually.
const INDIVIDUALLY: usize = 8;
/// The least number of rows that are stepped side by side; fewer are stepped as scalar instances, which is less work.
pub(crate) const FEW: usize = 4;

/// Rows that are taken together.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    pub(crate) rows: Vec<Row>,
    /// None where every element is stepped individually.
    pub(crate) lanes: Option<Box<dyn Lanes>>,
    /// What the actuators of the rows answered last, row after row; nothing before.
    pub(crate) responses: Vec<Response>,
    /// What the valves of the rows have been set to, row after row; nothing before.
    pub(crate) commands: Vec<Option<RuntimeCommand>>,
}

impl Group {
    pub(crate) fn advance(&mut self, span: Span<'_>) {
        match &mut self.lanes {
            Some(lanes) => lanes.advance(&mut self.rows, span),
            None => self.rows.iter_mut().for_each(|row| row.advance(&span)),
        }
    }

    /// Computes what the actuators of the rows answer.
    pub(crate) fn compute_at(&mut self, ends: [&[f64]; 2]) -> Result<(), Error> {
        let Self { rows, lanes, responses, .. } = self;
        let counts = rows.iter().map(|row| row.steps.plant().actuators().len());
        if responses.is_empty() {
            responses.resize(counts.sum(), Response::default());
        }
        if let Some(lanes) = lanes {
            return lanes.compute_at(rows, ends, responses);
        }
        let count = responses.len() / rows.len();
        for (row, responses) in rows.iter_mut().zip(responses.chunks_mut(count.max(1))) {
            if row.is_alive() {
                row.compute_at(ends, responses)?;
            }
        }
        Ok(())
    }

    /// Sets what a valve of a row does from now on; the edges of pulses in a second that it then has.
    pub(crate) fn set(&mut self, lane: usize, valve: usize, commanded: RuntimeCommand) -> Result<f64, Error> {
        let place = match self.command_place(lane, valve) {
            // What goes on as it is needs nothing.
            Some(place) if self.commands[place] == Some(commanded) && goes_on(&commanded) => return Ok(0.0),
            place => place,
        };
        let row = &mut self.rows[lane];
        if let Some(fault) = &row.fault {
            return Err(fault.clone());
        }
        let mut edges = 0.0;
        // Most commands go on with what there is, of which lanes know all.
        if !row.steps.set_on(valve, &commanded)? {
            let row = self.bring(lane);
            row.changes(Change::Commands);
            row.steps.set(valve, commanded)?;
            edges = row.steps.edge_rate();
        }
        if let Some(place) = place {
            self.commands[place] = Some(commanded);
        }
        Ok(edges)
    }

    /// Where it is kept what a valve of a row has been set to.
    fn command_place(&mut self, lane: usize, valve: usize) -> Option<usize> {
        let valves = self.rows[0].steps.plant().network().valves.len();
        if self.commands.is_empty() {
            self.commands.resize(valves * self.rows.len(), None);
        }
        (valve < valves).then_some(valves * lane + valve)
    }

    /// Brings a row to where its lane is.
    pub(crate) fn bring(&mut self, lane: usize) -> &mut Row {
        let row = &mut self.rows[lane];
        if let Some(lanes) = &mut self.lanes {
            lanes.bring(lane, row);
        }
        row
    }
}

/// Whether a valve that is set to a command again goes on as it is.
fn goes_on(command: &RuntimeCommand) -> bool {
    matches!(command, RuntimeCommand::Request(_) | RuntimeCommand::Pulses { .. })
}

/// Deals rows to groups: those of equal structure side by side, all others individually. The groups, the places of the rows in
/// them, and how many coordinates a host moves.
pub(crate) fn arrange(
    rows: Vec<PlantSteps>,
    width: Width,
    precision: Precision,
) -> (Vec<Group>, Vec<[usize; 2]>, usize) {
    let most = if width.rows() > 1 { width.rows() * precision.per_double() } else { INDIVIDUALLY };
    let mut groups: Vec<(Group, Option<Plant>)> = Vec::new();
    // Of each structure the group that has room.
    let mut open: Vec<usize> = Vec::new();
    let mut places = Vec::with_capacity(rows.len());
    let mut coordinates = 0;
    for (index, steps) in rows.into_iter().enumerate() {
        let side_by_side = width.rows() > 1 && PlantBatch::covers(steps.plant());
        let form = side_by_side.then(|| block::structure(steps.plant()));
        let found = open.iter().position(|group| groups[*group].1 == form && groups[*group].0.rows.len() < most);
        let group = match found {
            Some(found) => open[found],
            None => {
                open.retain(|group| groups[*group].1 != form);
                open.push(groups.len());
                groups
                    .push((Group { rows: Vec::new(), lanes: None, responses: Vec::new(), commands: Vec::new() }, form));
                groups.len() - 1
            }
        };
        places.push([group, groups[group].0.rows.len()]);
        let row = Row::new(steps, index, coordinates);
        coordinates = row.coordinates.end;
        groups[group].0.rows.push(row);
    }
    let finished = groups.into_iter().map(|(mut group, form)| {
        if form.is_some() && group.rows.len() >= FEW {
            group.lanes = in_lanes(&mut group.rows, width, precision);
        }
        group
    });
    (finished.collect(), places, coordinates)
}

/// Rows of equal structure in lanes.
#[cfg_attr(not(target_arch = "x86_64"), allow(unused_variables))]
fn in_lanes(rows: &mut [Row], width: Width, precision: Precision) -> Option<Box<dyn Lanes>> {
    match (width, precision) {
        // Where the program is built without single precision, a batch of it is refused.
        #[cfg(all(target_arch = "x86_64", not(feature = "f32")))]
        (_, Precision::Single) => None,
        (Width::Baseline, _) => None,
        #[cfg(target_arch = "x86_64")]
        (Width::Avx2, Precision::Double) => Some(Box::new(Block::<pair::Doubles256>::new(rows))),
        #[cfg(target_arch = "x86_64")]
        (Width::Avx512, Precision::Double) => Some(Box::new(Block::<pair::Doubles512>::new(rows))),
        #[cfg(all(target_arch = "x86_64", feature = "f32"))]
        (Width::Avx2, Precision::Single) => Some(Box::new(Block::<pair::Singles256>::new(rows))),
        #[cfg(all(target_arch = "x86_64", feature = "f32"))]
        (Width::Avx512, Precision::Single) => Some(Box::new(Block::<pair::Singles512>::new(rows))),
    }
}
