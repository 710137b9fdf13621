//! Rows that are taken together: in lanes where they are of equal structure, else one after the other.

use crate::batch::PlantBatch;
#[cfg(target_arch = "x86_64")]
use crate::block::Block;
use crate::block::{self, Lanes};
#[cfg(target_arch = "x86_64")]
use crate::pair;
use crate::precision::Precision;
use crate::row::{Change, Row, Rows};
use crate::span::Span;
#[cfg(target_arch = "x86_64")]
use crate::wide::Wide;
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
    pub(crate) rows: Rows,
    /// None where every element is stepped individually.
    pub(crate) lanes: Option<Box<dyn Lanes>>,
    /// What the actuators of the rows answered last, row after row; nothing before.
    pub(crate) responses: Vec<Response>,
    /// What the valves of the rows have been set to, row after row; nothing before.
    pub(crate) commands: Vec<Option<RuntimeCommand>>,
}

impl Group {
    /// A group of one row, which is stepped individually.
    fn of(row: Row) -> Self {
        Self { rows: Rows::of(row), lanes: None, responses: Vec::new(), commands: Vec::new() }
    }

    /// The plant of its first row.
    fn plant(&self) -> &Plant {
        self.rows.list[0].steps.plant()
    }

    pub(crate) fn advance(&mut self, span: Span<'_>) {
        match &mut self.lanes {
            Some(lanes) => lanes.advance(&mut self.rows, span),
            None => {
                let Rows { list, desk } = &mut self.rows;
                list.iter_mut().for_each(|row| row.advance(desk, &span));
            }
        }
    }

    /// Computes what the actuators of the rows answer.
    pub(crate) fn compute_at(&mut self, ends: [&[f64]; 2]) -> Result<(), Error> {
        let Self { rows, lanes, responses, .. } = self;
        let counts = rows.list.iter().map(|row| row.steps.plant().actuators().len());
        if responses.is_empty() {
            responses.resize(counts.sum(), Response::default());
        }
        if let Some(lanes) = lanes {
            return lanes.compute_at(rows, ends, responses);
        }
        let Rows { list, desk } = rows;
        let count = responses.len() / list.len();
        for (row, responses) in list.iter_mut().zip(responses.chunks_mut(count.max(1))) {
            if row.is_alive() {
                row.compute_at(desk, ends, responses)?;
            }
        }
        Ok(())
    }

    /// Sets what a valve of a row does from now on; the edges of pulses in a second that it then has.
    pub(crate) fn set(&mut self, lane: usize, valve: usize, commanded: RuntimeCommand) -> Result<f64, Error> {
        let place = match self.command_place(lane, valve) {
            // What goes on as it is needs nothing.
            Some(place) if self.commands[place] == Some(commanded) => return Ok(0.0),
            place => place,
        };
        let row = &mut self.rows.list[lane];
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
        let valves = self.plant().network().valves.len();
        if self.commands.is_empty() {
            self.commands.resize(valves * self.rows.list.len(), None);
        }
        (valve < valves).then_some(valves * lane + valve)
    }

    /// Brings a row to where its lane is.
    pub(crate) fn bring(&mut self, lane: usize) -> &mut Row {
        let Rows { list, desk } = &mut self.rows;
        let row = &mut list[lane];
        if let Some(lanes) = &mut self.lanes {
            lanes.bring(lane, row, desk);
        }
        row
    }
}

/// Deals rows to groups: those of equal structure side by side, all others individually. The groups, the places of the rows in
/// them, and how many coordinates a host moves.
pub(crate) fn arrange(
    rows: Vec<PlantSteps>,
    width: Width,
    precision: Precision,
) -> (Vec<Group>, Vec<[usize; 2]>, usize) {
    let most = if width.rows() > 1 { width.rows() * precision.per_double() } else { INDIVIDUALLY };
    let mut groups: Vec<Group> = Vec::new();
    let mut forms: Vec<Form> = Vec::new();
    let mut places = Vec::with_capacity(rows.len());
    let mut coordinates = 0;
    for (index, steps) in rows.into_iter().enumerate() {
        let plant = block::structure(steps.plant());
        let mut row = Row::new(steps, index, coordinates);
        coordinates = row.coordinates.end;
        let Some(form) = forms.iter_mut().find(|form| form.plant == plant) else {
            let side_by_side = width.rows() > 1 && PlantBatch::covers(row.steps.plant());
            forms.push(Form { plant, side_by_side, groups: vec![groups.len()] });
            places.push([groups.len(), 0]);
            groups.push(Group::of(row));
            continue;
        };
        // Rows of equal plants have the numbers of one, also where they are of several groups.
        row.steps.share(&groups[form.groups[0]].rows.list[0].steps);
        let last = form.groups[form.groups.len() - 1];
        if groups[last].rows.list.len() < most {
            places.push([last, groups[last].rows.list.len()]);
            groups[last].rows.list.push(row);
        } else {
            places.push([groups.len(), 0]);
            form.groups.push(groups.len());
            groups.push(Group::of(row));
        }
    }
    for form in forms.iter().filter(|form| form.side_by_side) {
        in_lanes(&mut groups, &form.groups, width, precision);
    }
    (groups, places, coordinates)
}

/// Plants of one structure, and their groups, of which the last may have room.
struct Form {
    plant: Plant,
    side_by_side: bool,
    groups: Vec<usize>,
}

/// Puts rows of one structure in lanes, those groups that have enough of them.
#[cfg_attr(not(target_arch = "x86_64"), allow(unused_variables))]
fn in_lanes(groups: &mut [Group], of_form: &[usize], width: Width, precision: Precision) {
    match (width, precision) {
        // Where the program is built without single precision, a batch of it is refused.
        #[cfg(all(target_arch = "x86_64", not(feature = "f32")))]
        (_, Precision::Single) => {}
        (Width::Baseline, _) => {}
        #[cfg(target_arch = "x86_64")]
        (Width::Avx2, Precision::Double) => in_blocks::<pair::Doubles256>(groups, of_form),
        #[cfg(target_arch = "x86_64")]
        (Width::Avx512, Precision::Double) => in_blocks::<pair::Doubles512>(groups, of_form),
        #[cfg(all(target_arch = "x86_64", feature = "f32"))]
        (Width::Avx2, Precision::Single) => in_blocks::<pair::Singles256>(groups, of_form),
        #[cfg(all(target_arch = "x86_64", feature = "f32"))]
        (Width::Avx512, Precision::Single) => in_blocks::<pair::Singles512>(groups, of_form),
    }
}

/// Puts groups in blocks of lanes. Those whose rows have equal numbers have them in common: they are read in every step, and take
/// more memory than all else of a block.
#[cfg(target_arch = "x86_64")]
fn in_blocks<W: Wide>(groups: &mut [Group], of_form: &[usize]) {
    let mut known = None;
    for &group in of_form {
        let group = &mut groups[group];
        if group.rows.list.len() >= FEW {
            group.lanes = Some(Box::new(Block::<W>::new(&mut group.rows.list, &mut known)));
        }
    }
}
