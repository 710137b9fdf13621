//! Rows that are taken together: in lanes where they are of equal structure, else one after the other.

use crate::batch::PlantBatch;
use crate::block;
#[cfg(target_arch = "x86_64")]
use crate::lanes::Blocks;
use crate::lanes::Lanes;
#[cfg(target_arch = "x86_64")]
use crate::pair;
use crate::precision::Precision;
use crate::row::{Change, Row, Rows};
use crate::span::Span;
#[cfg(target_arch = "x86_64")]
use crate::wide::Wide;
use crate::width::Width;
use mckibben::plant::{Plant, PlantRow};
use mckibben::valve::RuntimeCommand;
use mckibben::{Error, Response};

/// Elements that a thread takes together where they are stepped individually.
const INDIVIDUALLY: usize = 8;
/// Groups that each thread has at least where there are so many blocks, and the most blocks of a group.
const SHARES: usize = 4;
const MOST_BLOCKS: usize = 8;
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
    /// A group of rows that are stepped individually, one at least.
    fn of(rows: Vec<Row>) -> Self {
        Self { rows: Rows::of(rows), lanes: None, responses: Vec::new(), commands: Vec::new() }
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

/// Rows in their groups.
pub(crate) struct Arranged {
    pub(crate) groups: Vec<Group>,
    /// The group of each row, and its lane there.
    pub(crate) places: Vec<[usize; 2]>,
    /// How many coordinates a host moves.
    pub(crate) coordinates: usize,
}

/// Deals rows to groups, each as it comes: those of equal structure side by side, all others individually.
///
/// # Errors
/// [`Error::Misuse`] where they differ in time or method.
pub(crate) fn arrange(
    rows: &mut dyn Iterator<Item = PlantRow>,
    width: Width,
    precision: Precision,
) -> Result<Arranged, Error> {
    let (mut groups, mut places, mut coordinates): (Vec<Group>, Vec<[usize; 2]>, usize) = (Vec::new(), Vec::new(), 0);
    let mut forms: Vec<Form> = Vec::new();
    for (index, steps) in rows.enumerate() {
        let mut row = Row::new(steps, index, coordinates);
        coordinates = row.coordinates.end;
        places.push([0, 0]);
        if let Some(first) = forms.first().map(Form::first)
            && (row.steps.time() != first.time() || row.steps.method() != first.method())
        {
            return Err(Error::Misuse {
                what: "the plants of a batch are at different times, or are stepped by different methods",
                remedy: "begin all of them at the same time with the same method, or make a batch of those that agree",
            });
        }
        if let Some(form) = forms.iter_mut().find(|form| row.steps.shares_with(form.first())) {
            form.rows.push(row);
            continue;
        }
        let plant = block::structure(row.steps.plant());
        match forms.iter_mut().find(|form| form.plant == plant) {
            Some(form) => {
                // Rows of equal plants have the numbers of one.
                form.are_equal &= row.steps.share(form.first());
                form.rows.push(row);
            }
            None => forms.push(Form { plant, rows: vec![row], are_equal: true }),
        }
    }
    for form in forms {
        form.divide(width, precision, &mut groups);
    }
    for (place, group) in groups.iter().enumerate() {
        for (lane, row) in group.rows.list.iter().enumerate() {
            places[row.index] = [place, lane];
        }
    }
    Ok(Arranged { groups, places, coordinates })
}

/// Plants of one structure, one at least.
struct Form {
    plant: Plant,
    rows: Vec<Row>,
    /// Whether all have the numbers of the first.
    are_equal: bool,
}

impl Form {
    fn first(&self) -> &PlantRow {
        &self.rows[0].steps
    }

    /// Divides them into groups.
    fn divide(mut self, width: Width, precision: Precision, groups: &mut Vec<Group>) {
        let lanes = width.rows() * precision.per_double();
        let mut side_by_side = Vec::new();
        if width.rows() > 1 && PlantBatch::covers(self.first().plant()) {
            let left = self.rows.len() % lanes;
            // In single precision a row must not depend on how many stand beside it.
            let few = if left < FEW && precision == Precision::Double { left } else { 0 };
            let individually = self.rows.split_off(self.rows.len() - few);
            side_by_side = std::mem::replace(&mut self.rows, individually);
        }
        let first = groups.len();
        let blocks = side_by_side.len().div_ceil(lanes);
        let most = match blocks / SHARES {
            // Blocks of other numbers would each have the workspace take them on, at each step.
            many if many > 1 && self.are_equal => (many / rayon::current_num_threads()).clamp(1, MOST_BLOCKS),
            _ => 1,
        };
        groups.extend(chunks(side_by_side, most * lanes).map(Group::of));
        in_lanes(&mut groups[first..], width, precision);
        groups.extend(chunks(self.rows, INDIVIDUALLY).map(Group::of));
    }
}

/// Rows one after the other, so many at a time.
fn chunks(rows: Vec<Row>, most: usize) -> impl Iterator<Item = Vec<Row>> {
    let mut left = rows.into_iter();
    std::iter::from_fn(move || Some(left.by_ref().take(most).collect::<Vec<Row>>()).filter(|some| !some.is_empty()))
}

/// Puts the rows of groups of one structure in lanes.
#[cfg_attr(not(target_arch = "x86_64"), allow(unused_variables))]
fn in_lanes(groups: &mut [Group], width: Width, precision: Precision) {
    match (width, precision) {
        // Where the program is built without single precision, a batch of it is refused.
        #[cfg(all(target_arch = "x86_64", not(feature = "f32")))]
        (_, Precision::Single) => {}
        (Width::Baseline, _) => {}
        #[cfg(target_arch = "x86_64")]
        (Width::Avx2, Precision::Double) => in_blocks::<pair::Doubles256>(groups),
        #[cfg(target_arch = "x86_64")]
        (Width::Avx512, Precision::Double) => in_blocks::<pair::Doubles512>(groups),
        #[cfg(all(target_arch = "x86_64", feature = "f32"))]
        (Width::Avx2, Precision::Single) => in_blocks::<pair::Singles256>(groups),
        #[cfg(all(target_arch = "x86_64", feature = "f32"))]
        (Width::Avx512, Precision::Single) => in_blocks::<pair::Singles512>(groups),
    }
}

/// Puts groups in blocks of lanes. Those whose rows have equal numbers have them in common: they are read in every step, and take
/// more memory than all else of a block.
#[cfg(target_arch = "x86_64")]
fn in_blocks<W: Wide>(groups: &mut [Group]) {
    let mut known = None;
    for group in groups {
        group.lanes = Some(Box::new(Blocks::<W>::new(&mut group.rows.list, &mut known)));
    }
}
