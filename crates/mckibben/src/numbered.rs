//! A state as numbers in a row, to be kept in a file or sent to another process, and back.
//!
//! One walk through the fields does both: a [`Row`] that keeps takes each number from its field, one that puts back sets the
//! field to the next number. So that what is kept and what is put back cannot come apart, and a field that is new is missed
//! by neither. Checked by `tests/snapshot.rs`.

use crate::parameter;
use crate::valve::Request;
use alloc::vec::Vec;

/// Numbers in a row that are taken from fields, or fields are set to.
pub(crate) trait Row {
    /// Keeps the number, or puts another one in its place.
    fn any(&mut self, number: &mut f64);

    /// What has been put back is no state.
    fn refuse(&mut self);

    /// A finite number.
    fn number(&mut self, number: &mut f64) {
        self.any(number);
        if !number.is_finite() {
            self.refuse();
        }
    }

    /// Several of them.
    fn numbers(&mut self, numbers: &mut [f64]) {
        numbers.iter_mut().for_each(|number| self.number(number));
    }

    /// A count, which is far below 2⁵³.
    fn count(&mut self, count: &mut u64) {
        let mut number = *count as f64;
        self.number(&mut number);
        *count = number as u64;
        if *count as f64 != number {
            self.refuse();
        }
    }

    /// True or false, as 1 or 0.
    fn truth(&mut self, truth: &mut bool) {
        self.choice(truth, [false, true]);
    }

    /// One of few, by its place among them.
    fn choice<T: Copy + PartialEq, const N: usize>(&mut self, choice: &mut T, all: [T; N]) {
        let mut place = all.iter().position(|one| one == choice).unwrap_or(0) as u64;
        self.count(&mut place);
        match usize::try_from(place).ok().and_then(|place| all.get(place)) {
            Some(one) => *choice = *one,
            None => self.refuse(),
        }
    }

    /// What is asked of a valve.
    fn request(&mut self, request: &mut Request) {
        self.choice(request, [Request::Fill, Request::Hold, Request::Exhaust]);
    }

    /// A duty cycle.
    fn duty(&mut self, duty: &mut f64) {
        self.number(duty);
        if !parameter::DUTY.range.contains(*duty) {
            self.refuse();
        }
    }

    /// An instant in s, at infinity where there is none.
    fn instant(&mut self, instant: &mut Option<f64>) {
        let mut number = instant.unwrap_or(f64::INFINITY);
        self.any(&mut number);
        *instant = (number != f64::INFINITY).then_some(number);
        if instant.is_some_and(|instant| !instant.is_finite()) {
            self.refuse();
        }
    }
}

/// The numbers are kept.
pub(crate) struct Kept(pub(crate) Vec<f64>);

impl Row for Kept {
    fn any(&mut self, number: &mut f64) {
        self.0.push(*number);
    }

    /// What a state has is of its kind.
    fn refuse(&mut self) {}
}

/// The numbers are put back.
pub(crate) struct PutBack<'a> {
    numbers: core::slice::Iter<'a, f64>,
    refused: bool,
}

impl<'a> PutBack<'a> {
    /// From the first on.
    pub(crate) fn from(numbers: &'a [f64]) -> Self {
        Self { numbers: numbers.iter(), refused: false }
    }

    /// Whether all have been put where they may be.
    pub(crate) fn is_whole(&self) -> bool {
        !self.refused && self.numbers.as_slice().is_empty()
    }
}

impl Row for PutBack<'_> {
    fn any(&mut self, number: &mut f64) {
        match self.numbers.next() {
            Some(next) => *number = *next,
            None => self.refused = true,
        }
    }

    fn refuse(&mut self) {
        self.refused = true;
    }
}
