//! Blocks of one structure, which share a workspace, whatever the width of their lanes.

use crate::block::{Block, Known, Workspace, read};
use crate::row::{BlockRows, Row, Rows};
use crate::span::Span;
use crate::wide::Wide;
use mckibben::plant::PlantSteps;
use mckibben::{Error, Response};
use std::fmt::Debug;

/// Rows in lanes: each row has the lane of its place in the list.
pub(crate) trait Lanes: Debug + Send + Sync {
    /// These lanes again.
    fn copy(&self) -> Box<dyn Lanes>;

    /// Takes the rows, whose lanes these are, through a span.
    fn advance(&mut self, rows: &mut Rows, span: Span<'_>);

    /// Brings a row to where its lane is.
    fn bring(&mut self, lane: usize, row: &mut Row, desk: &mut PlantSteps);

    /// Forgets what a lane has, whose row is another.
    fn forget(&mut self, lane: usize);

    /// The states of a lane.
    fn read(&self, lane: usize, state: &mut [f64]);

    /// A state of a lane.
    fn read_one(&self, lane: usize, place: usize) -> f64;

    /// Takes the numbers of a row again, and of those beside it.
    fn gather(&mut self, lane: usize, rows: &mut Rows);

    /// Computes what the actuators of all rows answer, row after row, with the ends that a host moves at these distances in m and
    /// rates in m/s.
    ///
    /// # Errors
    /// Those of a row.
    fn compute_at(&mut self, rows: &mut Rows, ends: [&[f64]; 2], responses: &mut [Response]) -> Result<(), Error>;
}

impl Clone for Box<dyn Lanes> {
    fn clone(&self) -> Self {
        (**self).copy()
    }
}

/// Blocks of one structure.
#[derive(Clone, Debug)]
pub(crate) struct Blocks<W: Wide> {
    list: Vec<Block<W>>,
    work: Workspace<W>,
}

impl<W: Wide> Blocks<W> {
    /// Of rows of equal structure, one at least.
    pub(crate) fn new(rows: &mut [Row], known: &mut Known<W>) -> Self {
        let list: Vec<Block<W>> = rows.chunks_mut(W::LANES).map(|rows| Block::new(rows, known)).collect();
        let work = Workspace::new(&list[0]);
        Self { list, work }
    }
}

impl<W: Wide> Lanes for Blocks<W> {
    fn copy(&self) -> Box<dyn Lanes> {
        Box::new(self.clone())
    }

    fn advance(&mut self, Rows { list, desk }: &mut Rows, span: Span<'_>) {
        for (block, list) in self.list.iter_mut().zip(list.chunks_mut(W::LANES)) {
            block.advance(&mut self.work, BlockRows { list, desk }, span);
        }
    }

    fn bring(&mut self, lane: usize, row: &mut Row, desk: &mut PlantSteps) {
        self.list[lane / W::LANES].bring(lane % W::LANES, row, desk);
    }

    fn forget(&mut self, lane: usize) {
        self.list[lane / W::LANES].behind.put(lane % W::LANES, 0.0);
    }

    fn read(&self, lane: usize, state: &mut [f64]) {
        read(&self.list[lane / W::LANES].state, lane % W::LANES, state);
    }

    fn read_one(&self, lane: usize, place: usize) -> f64 {
        self.list[lane / W::LANES].state[place].lane(lane % W::LANES)
    }

    fn gather(&mut self, lane: usize, Rows { list, desk }: &mut Rows) {
        let block = lane / W::LANES;
        let last = list.len().min((block + 1) * W::LANES);
        self.list[block].gather(BlockRows { list: &mut list[block * W::LANES..last], desk });
    }

    fn compute_at(
        &mut self,
        Rows { list, desk }: &mut Rows,
        ends: [&[f64]; 2],
        responses: &mut [Response],
    ) -> Result<(), Error> {
        let each = responses.len() / list.len();
        let (blocks, rows) = (self.list.iter_mut(), list.chunks_mut(W::LANES));
        for ((block, list), responses) in blocks.zip(rows).zip(responses.chunks_mut((each * W::LANES).max(1))) {
            block.compute_at(&mut self.work, BlockRows { list, desk }, ends, responses)?;
        }
        Ok(())
    }
}
