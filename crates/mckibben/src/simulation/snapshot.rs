//! Where a modular actuator is, as a value: to go back to, and as numbers to be kept in a file or sent to another process.
//!
//! Checked by `tests/snapshot.rs`: what has gone through numbers goes on to the same bits.

use super::course::Course;
use super::fixed_step::Walk;
use super::kernel::Held;
use super::modular::Place;
use super::piped::{PIPED, of_rig};
use super::rig::State;
use super::timetable::Progress;
use crate::control::Modulator;
use crate::error::Error;
use crate::friction::Memory;
use crate::load::Line;
use crate::numbered::{Counted, Kept, PutBack, Row};
use crate::scalar::Real;
use crate::valve::Ports;
use alloc::vec::Vec;

/// Where an actuator is in time, with its air, its valve's seats and pulses and what its hysteresis remembers: kept by a
/// caller who wants to go on from there more than once.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<R: Real<Time = R> = f64>(pub(super) Place<R>);

impl<R: Real<Time = R>> Snapshot<R> {
    /// The time in s.
    pub fn time(&self) -> R {
        self.0.0.course.time
    }

    /// Length, velocity of the last step, pressure and air mass.
    pub fn state(&self) -> State<R> {
        State::from_array(of_rig(&self.0.0.course.state))
    }

    /// Which passages are open.
    pub fn ports(&self) -> Ports {
        self.0.0.ports
    }
}

impl Snapshot {
    /// The numbers that [`Snapshot::of_numbers`] takes: all of the state in SI, infinity for an instant that does not come. Their
    /// order and how many they are may change from one version of the crate to the next.
    pub fn numbers(&self) -> Vec<f64> {
        let (mut place, mut size) = (self.0, Counted::default());
        each_number(&mut place, &mut size);
        let mut numbers = alloc::vec![0.0; size.0];
        each_number(&mut place, &mut Kept::into(&mut numbers));
        numbers
    }

    /// What gave these [`Snapshot::numbers`]; an actuator of the same rig goes on from there to the same bits.
    ///
    /// # Errors
    /// [`Error::Misuse`] for numbers that no snapshot of this version has.
    pub fn of_numbers(numbers: &[f64]) -> Result<Self, Error> {
        let nothing = Course { time: 0.0, state: [0.0; PIPED], held: Held::nothing() };
        let walk = Walk { course: nothing, progress: Progress::none(), ports: Ports::CLOSED };
        let (mut place, mut row) = ((walk, Modulator::idle()), PutBack::from(numbers));
        each_number(&mut place, &mut row);
        let snapshot = Self(place);
        let State { pressure, air_mass, .. } = snapshot.state();
        if row.is_whole() && pressure.0 > 0.0 && air_mass > 0.0 {
            return Ok(snapshot);
        }
        Err(Error::Misuse {
            what: "these numbers are no state of an actuator",
            remedy: "give those that a state of this version was kept as, all of them in their order",
        })
    }
}

/// All that differs from one state of an actuator to another, in a row. How far the passages are open between their ends
/// follows from the seats.
fn each_number((walk, modulator): &mut Place<f64>, row: &mut impl Row) {
    let Walk { course: Course { time, state, held }, progress, ports } = walk;
    row.number(time);
    row.numbers(state);
    let Held { supply, exhaust, openings: _, sliding, stuck, slack, taut, compressor, line, memory } = held;
    [supply, exhaust, stuck, slack, taut, compressor].into_iter().for_each(|held| row.truth(held));
    row.number(sliding);
    let Line { time, length, slope } = line;
    [time, length, slope].into_iter().for_each(|number| row.number(number));
    let Memory { at, elements } = memory;
    row.number(at);
    row.numbers(elements);
    let Ports { supply, exhaust } = ports;
    row.truth(supply);
    row.truth(exhaust);
    progress.each_number_of_seats(row);
    modulator.each_number(row);
}
