//! The blocks of a batch behind one face, whatever their number, width and rounding.

use super::Row;
use super::block::{Advance, Block, Samples, Span};
use super::lanes::{Lanes, Number};
use super::width::Width;
use crate::error::Error;
use crate::scalar::Vector;
use crate::simulation::{Method, Rig, Sample, State};
use alloc::boxed::Box;
use alloc::vec::Vec;
use core::fmt::Debug;
use rayon::prelude::*;

/// Blocks of rows.
pub trait Engine: Debug + Send + Sync {
    /// Takes every block from one time in s to another in equal steps, on all cores.
    fn advance(&mut self, from: f64, until: f64, steps: u64);
    /// What each row of each block shows.
    fn samples(&self) -> Vec<Vec<Result<Sample, Error>>>;
}

/// A number that blocks are made of.
pub trait Build: Number {
    /// How many rows are in a block.
    const LANES: usize;
    /// Blocks with the given rows in each.
    fn build(rows: &[Row], members: &[Vec<usize>], method: Method, width: Width) -> Box<dyn Engine>;
}

#[derive(Debug)]
struct Blocks<S: Vector> {
    blocks: Vec<Block<S>>,
    width: Width,
}

impl<S: Vector<Lane = f64> + Send + Sync> Blocks<S>
where
    S::Mask: Send + Sync,
    S::Time: Send + Sync,
{
    fn new(rows: &[Row], members: &[Vec<usize>], method: Method, width: Width) -> Self {
        let block = |members: &Vec<usize>| {
            let rows: Vec<(&Rig, State)> = members.iter().map(|&row| (&rows[row].rig, rows[row].start)).collect();
            Block::new(&rows, method)
        };
        Self { blocks: members.par_iter().map(block).collect(), width }
    }
}

impl<S: Vector<Lane = f64> + Send + Sync> Engine for Blocks<S>
where
    S::Mask: Send + Sync,
    S::Time: Send + Sync,
{
    fn advance(&mut self, from: f64, until: f64, steps: u64) {
        let (width, span) = (self.width, Span { from, until, steps });
        match self.blocks.as_mut_slice() {
            [block] => width.run(Advance(block, span)),
            blocks => blocks.par_iter_mut().for_each(|block| width.run(Advance(block, span))),
        }
    }

    fn samples(&self) -> Vec<Vec<Result<Sample, Error>>> {
        self.blocks.iter().map(|block| self.width.run(Samples(block))).collect()
    }
}

macro_rules! build {
    ($number:ident, $lanes:literal) => {
        impl Build for $number {
            const LANES: usize = $lanes;

            fn build(rows: &[Row], members: &[Vec<usize>], method: Method, width: Width) -> Box<dyn Engine> {
                match width.is_fused() {
                    true => Box::new(Blocks::<Lanes<$number, $lanes, true>>::new(rows, members, method, width)),
                    false => Box::new(Blocks::<Lanes<$number, $lanes, false>>::new(rows, members, method, width)),
                }
            }
        }
    };
}
build!(f64, 8);
build!(f32, 16);
