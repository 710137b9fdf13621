//! The blocks of a batch behind one face, whatever their number and width.

use super::baseline::Baseline;
use super::block::{Advance, Attach, Block, Create, Restart, Samples, Stop};
use super::gather::are_same;
use super::span::Span;
use super::{Row, Width};
use crate::error::Error;
use crate::lanes::twice::Twice;
#[cfg(feature = "batch-single")]
use crate::lanes::wide::Singles;
use crate::lanes::wide::{Doubles, Number, Wide, compiled};
use crate::simulation::closed_loop::Control;
use crate::simulation::{Decision, Method, Sample, State};
use crate::valve::Demand;
use alloc::boxed::Box;
use alloc::vec::Vec;
use core::fmt::Debug;
use rayon::prelude::*;

/// What is asked of the valve of a block's lane, if anything.
pub(super) type Demands<'a> = dyn Fn(usize, usize) -> Option<Demand> + Sync + 'a;

/// Where all lanes of all blocks are, one after the other, and which have stopped: of those nothing is written.
pub struct Show<'a> {
    pub(super) states: &'a mut [[f64; 4]],
    pub(super) stopped: &'a mut [bool],
}

impl Show<'_> {
    /// Writes them as they are.
    #[inline(always)]
    pub(super) fn where_are<'a>(self, state: impl Fn(usize) -> Result<State, &'a Error>) {
        for (count, (shown, stopped)) in self.states.iter_mut().zip(self.stopped).enumerate() {
            let state = state(count);
            *stopped = state.is_err();
            if let Ok(state) = state {
                *shown = state.to_array();
            }
        }
    }
}

/// Blocks of rows.
pub trait Engine: Debug + Send + Sync {
    /// Takes every block through a span, on all cores.
    fn advance(&mut self, span: Span);
    /// The same, with what is asked of the valves told first, and where the lanes are then written, if that is wanted: block by
    /// block, while it is at hand. A lane that cannot do what is asked stops.
    fn go(&mut self, span: Span, demand: &Demands<'_>, show: Option<Show<'_>>);
    /// Gives a lane of a block a controller.
    fn control(&mut self, block: usize, lane: usize, control: Box<dyn Control>);
    /// What the controller of a lane has decided.
    fn decisions(&self, block: usize, lane: usize) -> &[Decision];
    /// What the valve of a lane is to do from now on.
    fn tell(&mut self, block: usize, lane: usize, demand: Demand) -> Result<(), Error>;
    /// Other rows in the place of lanes of a block, from now on.
    fn restart(&mut self, block: usize, rows: &[(usize, &Row)]) -> Result<(), Error>;
    /// The same of every block.
    fn restart_all(&mut self, rows: &[Vec<(usize, &Row)>]) -> Result<(), Error>;
    /// Where a lane is, or why it has stopped.
    fn state(&self, block: usize, lane: usize) -> Result<State, &Error>;
    /// What each row of each block shows.
    fn samples(&self) -> Vec<Vec<Result<Sample, Error>>>;
}

/// How rows are dealt to blocks: given the number of lanes, the rows of each block.
pub(super) type Dealing<'a> = &'a mut dyn FnMut(usize) -> Vec<Vec<usize>>;

/// A number that blocks are made of.
pub trait Build: Number {
    /// Blocks of the width that is given.
    fn build(rows: &[Row], deal: Dealing<'_>, method: Method, width: Width) -> Box<dyn Engine>;
}

#[derive(Debug)]
struct Blocks<W: Wide>(Vec<Block<W>>);

impl<W: Wide> Blocks<W> {
    fn build(rows: &[Row], deal: Dealing<'_>, method: Method) -> Box<dyn Engine> {
        let members = deal(W::LANES);
        let block = |members: &Vec<usize>, first: Option<(&Row, &Block<W>)>| {
            let rows: Vec<&Row> = members.iter().map(|&row| &rows[row]).collect();
            let same = |(first, _): &(&Row, _)| rows.iter().all(|row| are_same(&row.rig, &first.rig));
            compiled(Create(&rows, method, first.filter(same).map(|(_, block)| block)))
        };
        let Some((first, others)) = members.split_first() else { return Box::new(Self(Vec::new())) };
        let mut blocks = Vec::from([block(first, None)]);
        // A first block of rows that differ is nothing that others could be like.
        let shared = &rows[first[0]];
        let like = first.iter().all(|row| are_same(&rows[*row].rig, &shared.rig)).then_some((shared, &blocks[0]));
        let others: Vec<_> = others.par_iter().map(|members| block(members, like)).collect();
        blocks.extend(others);
        Box::new(Self(blocks))
    }
}

impl<W: Wide> Engine for Blocks<W> {
    fn advance(&mut self, span: Span) {
        match self.0.as_mut_slice() {
            [block] => compiled(Advance(block, span)),
            blocks => blocks.par_iter_mut().for_each(|block| compiled(Advance(block, span))),
        }
    }

    fn go(&mut self, span: Span, demand: &Demands<'_>, show: Option<Show<'_>>) {
        let go = |count: usize, block: &mut Block<W>| {
            while let Err((lane, fault)) = block.tell_all(|lane| demand(count, lane)) {
                compiled(Stop(block, lane, fault));
            }
            compiled(Advance(block, span));
        };
        let blocks = self.0.par_iter_mut();
        match show {
            Some(Show { states, stopped }) => {
                let shown = states.par_chunks_mut(W::LANES).zip(stopped.par_chunks_mut(W::LANES));
                blocks.zip(shown).enumerate().for_each(|(count, (block, (states, stopped)))| {
                    go(count, block);
                    block.show(Show { states, stopped });
                });
            }
            None => blocks.enumerate().for_each(|(count, block)| go(count, block)),
        }
    }

    fn control(&mut self, block: usize, lane: usize, control: Box<dyn Control>) {
        compiled(Attach(&mut self.0[block], lane, control));
    }

    fn decisions(&self, block: usize, lane: usize) -> &[Decision] {
        self.0[block].decisions(lane)
    }

    fn tell(&mut self, block: usize, lane: usize, demand: Demand) -> Result<(), Error> {
        self.0[block].tell(lane, demand)
    }

    fn restart(&mut self, block: usize, rows: &[(usize, &Row)]) -> Result<(), Error> {
        compiled(Restart(&mut self.0[block], rows))
    }

    fn restart_all(&mut self, rows: &[Vec<(usize, &Row)>]) -> Result<(), Error> {
        let pairs = self.0.par_iter_mut().zip(rows).filter(|(_, rows)| !rows.is_empty());
        pairs.try_for_each(|(block, rows)| compiled(Restart(block, rows)))
    }

    fn state(&self, block: usize, lane: usize) -> Result<State, &Error> {
        self.0[block].state(lane)
    }

    fn samples(&self) -> Vec<Vec<Result<Sample, Error>>> {
        self.0.iter().map(|block| compiled(Samples(block))).collect()
    }
}

macro_rules! build {
    ($number:ident, $wide:ident) => {
        impl Build for $number {
            fn build(rows: &[Row], deal: Dealing<'_>, method: Method, width: Width) -> Box<dyn Engine> {
                match width.or_widest() {
                    Width::Baseline => Baseline::<$number>::build(rows, deal, method),
                    #[cfg(target_arch = "x86_64")]
                    Width::Avx2 => Blocks::<Twice<$wide<pulp::x86::V3>>>::build(rows, deal, method),
                    #[cfg(target_arch = "x86_64")]
                    Width::Avx512 => Blocks::<Twice<$wide<pulp::x86::V4>>>::build(rows, deal, method),
                }
            }
        }
    };
}
build!(f64, Doubles);
#[cfg(feature = "batch-single")]
build!(f32, Singles);
