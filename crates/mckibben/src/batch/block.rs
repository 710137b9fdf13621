//! A block: as many rows as a vector has lanes, with laws of the same form, whatever these laws are.

use super::Row;
use super::engine::Show;
use super::gather::gather;
use super::member::Member;
use super::rows::Rows;
use super::span::Span;
use crate::error::Error;
use crate::force::{Characteristic, IdealBraid};
use crate::lanes::wide::{Compiled, Wide};
use crate::simulation::closed_loop::Control;
use crate::simulation::fixed_step::Walk;
use crate::simulation::piped::{PIPED, PLAIN, SHORT};
use crate::simulation::sample::Sample;
use crate::simulation::{Decision, Method, Rig, State};
use crate::valve::Demand;
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use pulp::Simd;

/// Rows side by side. The law is named where it is the ideal braid, so that no stage has to ask for it, and there is room for
/// the states of an air line, and of its cells, where there are any: most rows need not carry that.
#[derive(Debug)]
pub(super) enum Block<W: Wide> {
    Ideal(Box<Rows<W, IdealBraid<W>, PLAIN>>),
    Plain(Box<Rows<W, Characteristic<W>, PLAIN>>),
    Piped(Box<Rows<W, Characteristic<W>, SHORT>>),
    Celled(Box<Rows<W, Characteristic<W>, PIPED>>),
}

/// Does the same with the rows of a block of any kind.
macro_rules! with_rows {
    ($block:expr, $rows:ident => $done:expr) => {
        match $block {
            Block::Ideal($rows) => $done,
            Block::Plain($rows) => $done,
            Block::Piped($rows) => $done,
            Block::Celled($rows) => $done,
        }
    };
}

impl<W: Wide> Block<W> {
    /// At most as many rows of the same form as there are lanes, at t = 0; `like` is a block whose rows have the same numbers.
    pub(super) fn new(rows: &[&Row], method: Method, like: Option<&Self>) -> Self {
        match like {
            Some(Self::Ideal(other)) => Self::Ideal(Box::new(other.of_others(rows))),
            Some(Self::Plain(other)) => Self::Plain(Box::new(other.of_others(rows))),
            Some(Self::Piped(other)) => Self::Piped(Box::new(other.of_others(rows))),
            Some(Self::Celled(other)) => Self::Celled(Box::new(other.of_others(rows))),
            None => Self::of(gather(&rows.iter().map(|row| &row.rig).collect::<Vec<_>>()), rows, method),
        }
    }

    fn of(rig: Rig<W>, rows: &[&Row], method: Method) -> Self {
        // One with an air line is not taken for ideal.
        match rig.ideal() {
            Some(ideal) => Self::Ideal(Box::new(Rows::new(Arc::new(ideal), rows, method, None))),
            None if rig.has_cells() => Self::Celled(Box::new(Rows::new(Arc::new(rig), rows, method, None))),
            None if rig.is_piped() => Self::Piped(Box::new(Rows::new(Arc::new(rig), rows, method, None))),
            None => Self::Plain(Box::new(Rows::new(Arc::new(rig), rows, method, None))),
        }
    }

    /// What the controller of a lane has decided; nothing where there is none.
    pub(super) fn decisions(&self, index: usize) -> &[Decision] {
        let control = with_rows!(self, rows => &rows.members[index].kept.lane.control);
        control.as_ref().map_or(&[], |control| control.decisions())
    }

    /// Tells the valve of a lane what it is to do from now on.
    pub(super) fn tell(&mut self, index: usize, demand: Demand) -> Result<(), Error> {
        with_rows!(self, rows => rows.members[index].tell(rows.time, demand))
    }

    /// Where a lane is, or why it has stopped.
    pub(super) fn state(&self, index: usize) -> Result<State, &Error> {
        with_rows!(self, rows => rows.state_of(index))
    }

    /// Writes where the lanes are.
    pub(super) fn show(&self, show: Show<'_>) {
        with_rows!(self, rows => show.where_are(|index| rows.state_of(index)));
    }

    /// Tells every lane that has not stopped what is asked of it, if anything; the first lane that cannot do that, and why.
    pub(super) fn tell_all(&mut self, demand: impl Fn(usize) -> Option<Demand>) -> Result<(), (usize, Error)> {
        with_rows!(self, rows => {
            let Rows { members, time, .. } = &mut **rows;
            let mut living = members.iter_mut().enumerate().filter(|(_, member)| member.lives);
            living.try_for_each(|(index, member)| match demand(index) {
                Some(demand) => member.tell(*time, demand).map_err(|error| (index, error)),
                None => Ok(()),
            })
        })
    }

    /// Puts other rows in the place of lanes, from now on.
    #[inline(always)]
    fn restart(&mut self, anew: &[(usize, &Row)]) -> Result<(), Error> {
        let (walks, others) = with_rows!(self, rows => {
            let begin = |(index, row): &(usize, &Row)| Ok((*index, rows.members[*index].anew(row, rows.time)?));
            let begun: Vec<(usize, (Member<_>, Walk<_>))> = anew.iter().map(begin).collect::<Result<_, Error>>()?;
            let differs = |(index, (member, _)): &(usize, (Member<_>, _))| {
                !Arc::ptr_eq(&member.kept.lane.rig, &rows.members[*index].kept.lane.rig)
            };
            let others = begun.iter().any(differs);
            let put = |(index, (member, walk))| {
                rows.members[index] = member;
                (index, walk)
            };
            (begun.into_iter().map(put).collect(), others)
        });
        if others {
            self.gather();
        }
        with_rows!(self, rows => rows.begin_anew(walks));
        Ok(())
    }

    /// Makes the rig over lanes anew of those of the rows.
    #[inline(always)]
    fn gather(&mut self) {
        let rigs: Vec<_> = with_rows!(self, rows => rows.members.iter().map(|member| &*member.kept.lane.rig).collect());
        let rig: Rig<W> = gather(&rigs);
        match self {
            Self::Ideal(rows) => {
                if let Some(ideal) = rig.ideal() {
                    rows.rig = Arc::new(ideal);
                }
            }
            Self::Plain(rows) => rows.rig = Arc::new(rig),
            Self::Piped(rows) => rows.rig = Arc::new(rig),
            Self::Celled(rows) => rows.rig = Arc::new(rig),
        }
    }
}

/// A new block, like another whose rows have the same numbers if there is one.
pub(super) struct Create<'a, W: Wide>(pub(super) &'a [&'a Row], pub(super) Method, pub(super) Option<&'a Block<W>>);

impl<W: Wide> Compiled for Create<'_, W> {
    type Wide = W;
    type Output = Block<W>;
    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Block<W> {
        Block::new(self.0, self.1, self.2)
    }
}

/// A controller for a lane of a block.
pub(super) struct Attach<'a, W: Wide>(pub(super) &'a mut Block<W>, pub(super) usize, pub(super) Box<dyn Control>);

impl<W: Wide> Compiled for Attach<'_, W> {
    type Wide = W;
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        with_rows!(self.0, rows => rows.control(self.1, self.2))
    }
}

/// Other rows for lanes of a block.
pub(super) struct Restart<'a, W: Wide>(pub(super) &'a mut Block<W>, pub(super) &'a [(usize, &'a Row)]);

impl<W: Wide> Compiled for Restart<'_, W> {
    type Wide = W;
    type Output = Result<(), Error>;
    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Self::Output {
        self.0.restart(self.1)
    }
}

/// A block's way through a span.
pub(super) struct Advance<'a, W: Wide>(pub(super) &'a mut Block<W>, pub(super) Span);

impl<W: Wide> Compiled for Advance<'_, W> {
    type Wide = W;
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        with_rows!(self.0, rows => rows.advance(simd, self.1))
    }
}

/// A fault that stops a lane of a block.
pub(super) struct Stop<'a, W: Wide>(pub(super) &'a mut Block<W>, pub(super) usize, pub(super) Error);

impl<W: Wide> Compiled for Stop<'_, W> {
    type Wide = W;
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        with_rows!(self.0, rows => rows.stop(self.1, self.2))
    }
}

/// A block's samples.
pub(super) struct Samples<'a, W: Wide>(pub(super) &'a Block<W>);

impl<W: Wide> Compiled for Samples<'_, W> {
    type Wide = W;
    type Output = Vec<Result<Sample, Error>>;
    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Self::Output {
        with_rows!(self.0, rows => rows.samples())
    }
}
