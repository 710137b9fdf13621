//! Plants that go through time each by itself: joints and legs.

use super::asked::Asked;
use super::fleet::{Fleet, Pace, Span};
use mckibben::Error;
use mckibben::control::Drive;
use mckibben_cli::failure::Failure;
use rayon::prelude::*;
use std::fmt::Debug;

/// Rows that a thread takes together at least.
const TOGETHER: usize = 4;

/// How plants of a kind are made, driven, stepped and shown, `VALVES` valves each.
pub(super) trait Kind<const VALVES: usize>: Send + Sync {
    /// One of them.
    type Plant: Debug + Send + Sync;

    fn columns(&self) -> Vec<String>;

    /// One with its values at t = 0.
    fn begin(&self, values: &[f64]) -> Result<Self::Plant, Failure>;

    fn drive(plant: &mut Self::Plant, drives: [Drive; VALVES]) -> Result<(), Error>;

    fn advance_to(plant: &mut Self::Plant, until: f64) -> Result<(), Error>;

    fn show(plant: &Self::Plant, into: &mut [f64]);
}

/// Plants of a kind, each with a clock of its own.
pub(super) struct Alone<K: Kind<VALVES>, const VALVES: usize> {
    kind: K,
    asked: Asked,
    plants: Vec<Member<K::Plant>>,
}

struct Member<P> {
    plant: P,
    pace: Pace,
    stopped: bool,
}

impl<P> Member<P> {
    fn new(plant: P) -> Self {
        Self { plant, pace: Pace::default(), stopped: false }
    }
}

impl<K: Kind<VALVES>, const VALVES: usize> Alone<K, VALVES> {
    pub(super) fn new(kind: K, asked: Asked) -> Self {
        Self { kind, asked, plants: Vec::new() }
    }

    fn drives(&self, asked: &[f64]) -> Result<[Drive; VALVES], Error> {
        let mut drives = [Drive::Steady(mckibben::valve::Request::Hold); VALVES];
        for (drive, number) in drives.iter_mut().zip(asked) {
            *drive = self.asked.drive(*number)?;
        }
        Ok(drives)
    }

    /// Takes one through a span; an error leaves it where it left the physics.
    fn step_one(&self, member: &mut Member<K::Plant>, span: Span, asked: &[f64]) -> Result<(), Error> {
        K::drive(&mut member.plant, self.drives(asked)?)?;
        let from = member.pace.now();
        member.pace = member.pace.on(span);
        let until = member.pace.now();
        let parts = (1..span.steps).map(|step| from + (until - from) * (step as f64 / span.steps as f64));
        parts.chain([until]).try_for_each(|until| K::advance_to(&mut member.plant, until))
    }
}

impl<K: Kind<VALVES>, const VALVES: usize> Fleet for Alone<K, VALVES> {
    fn columns(&self) -> Vec<String> {
        self.kind.columns()
    }

    fn valves(&self) -> usize {
        VALVES
    }

    fn bytes(&self) -> usize {
        size_of::<Member<K::Plant>>()
    }

    fn begin(&mut self, values: &[&[f64]]) -> Result<(), (usize, Failure)> {
        let of_row = |(row, values): (usize, &&[f64])| {
            self.kind.begin(values).map(Member::new).map_err(|failure| (row, failure))
        };
        self.plants = values.par_iter().enumerate().map(of_row).collect::<Result<_, _>>()?;
        Ok(())
    }

    fn restart(&mut self, rows: &[(usize, &[f64])]) -> Result<(), (usize, Failure)> {
        for (row, values) in rows {
            self.plants[*row] = self.kind.begin(values).map(Member::new).map_err(|failure| (*row, failure))?;
        }
        Ok(())
    }

    fn check(&self, asked: &[f64]) -> Result<(), (usize, Failure)> {
        let wrong = |(row, asked): (usize, &[f64])| Some((row, self.drives(asked).err()?));
        let wrong = asked.chunks(VALVES).enumerate().find_map(wrong);
        wrong.map_or(Ok(()), |(row, error)| Err((row, error.into())))
    }

    fn step(&mut self, span: Span, asked: &[f64], shown: &mut [f64], stopped: &mut [bool]) {
        let mut plants = core::mem::take(&mut self.plants);
        let width = (shown.len() / plants.len().max(1)).max(1);
        let places = shown.par_chunks_mut(width).zip(stopped);
        let rows = plants.par_iter_mut().zip(asked.par_chunks(VALVES)).zip(places).with_min_len(TOGETHER);
        rows.for_each(|((member, asked), (shown, stopped))| {
            if !member.stopped {
                member.stopped = self.step_one(member, span, asked).is_err();
            }
            *stopped = member.stopped;
            if !member.stopped {
                K::show(&member.plant, shown);
            }
        });
        self.plants = plants;
    }

    fn differ(&self, values: [&[f64]; 2]) -> Result<bool, Failure> {
        let [one, other] = values.map(|values| self.kind.begin(values).map(|plant| format!("{plant:?}")));
        Ok(one? != other?)
    }

    fn time(&self, row: usize) -> f64 {
        self.plants[row].pace.now()
    }

    fn show(&self, row: usize, into: &mut [f64]) {
        let Member { plant, stopped, .. } = &self.plants[row];
        if !stopped {
            K::show(plant, into);
        }
    }
}
