//! A state as numbers in a row, to be kept in a file or sent to another process, and back.
//!
//! One pass over the fields does both: a [`Row`] that keeps takes each number from its field, one that puts back sets the
//! field to the next number. Over dual numbers the derivatives pass with the values. So that what is kept and what is put back cannot come apart, and a field that is new is missed
//! by neither. How many there are never depends on the values. Checked by `tests/plant_saved.rs`.

use crate::parameter;
use crate::scalar::Real;
use crate::valve::Request;
use alloc::vec::Vec;

/// Numbers in a row that are taken from fields, or fields are set to.
pub(crate) trait Row<R: Real> {
    /// Keeps the number, or puts another one in its place.
    fn any(&mut self, number: &mut R);

    /// The numbers cannot hold what is to be kept, or what has been put back is no state.
    fn refuse(&mut self);

    /// Whether fields are set from the numbers: then they are checked, and what follows from them is set as well.
    fn puts_back(&self) -> bool {
        false
    }

    /// A finite number.
    fn number(&mut self, number: &mut R) {
        self.any(number);
        if !number.value().is_finite() {
            self.refuse();
        }
    }

    /// Several of them.
    fn numbers(&mut self, numbers: &mut [R]) {
        numbers.iter_mut().for_each(|number| self.number(number));
    }

    /// A count, which is far below 2⁵³.
    fn count(&mut self, count: &mut u64) {
        // As a number with a sign, which is one instruction.
        let mut number = R::constant(*count as i64 as f64);
        self.any(&mut number);
        if self.puts_back() {
            let back = number.value() as i64;
            *count = back.max(0) as u64;
            if *count as f64 != number.value() {
                self.refuse();
            }
        }
    }

    /// An index below `end`; zero where what is put back is none.
    fn index(&mut self, index: &mut usize, end: usize) {
        let mut count = *index as u64;
        self.count(&mut count);
        match usize::try_from(count).ok().filter(|index| *index < end) {
            Some(within) => *index = within,
            None => {
                *index = 0;
                self.refuse();
            }
        }
    }

    /// A list of indices below `end`, no longer than `capacity`.
    fn indices(&mut self, list: &mut Vec<usize>, capacity: usize, end: usize) {
        if let Some(length) = self.length(list.len(), capacity) {
            list.resize(length, 0);
        }
        for place in 0..capacity {
            match list.get_mut(place) {
                Some(index) => self.index(index, end),
                None => self.nothing(),
            }
        }
    }

    /// The length of a list, if it is no more than `capacity`.
    fn length(&mut self, length: usize, capacity: usize) -> Option<usize> {
        let mut count = length as u64;
        self.count(&mut count);
        let length = usize::try_from(count).ok().filter(|length| *length <= capacity);
        if length.is_none() {
            self.refuse();
        }
        length
    }

    /// A place that holds nothing.
    fn nothing(&mut self) {
        let mut number = R::zero();
        self.any(&mut number);
        if number.value().to_bits() != 0 {
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
        if !self.puts_back() {
            return;
        }
        match usize::try_from(place).ok().and_then(|place| all.get(place)) {
            Some(one) => *choice = *one,
            None => self.refuse(),
        }
    }

    /// None, or one of few, by its place among them.
    fn option<T: Copy + PartialEq, const N: usize>(&mut self, option: &mut Option<T>, all: [T; N]) {
        let mut is_some = option.is_some();
        self.truth(&mut is_some);
        let mut choice = option.unwrap_or(all[0]);
        self.choice(&mut choice, all);
        *option = is_some.then_some(choice);
    }

    /// The command to a valve.
    fn request(&mut self, request: &mut Request) {
        self.choice(request, [Request::Fill, Request::Hold, Request::Exhaust]);
    }

    /// A duty cycle.
    fn duty(&mut self, duty: &mut R) {
        self.number(duty);
        if !parameter::DUTY.range.contains(duty.value()) {
            self.refuse();
        }
    }

    /// An instant in s, or another number, at infinity where there is none.
    fn instant(&mut self, instant: &mut Option<R>) {
        let mut number = instant.unwrap_or(R::constant(f64::INFINITY));
        self.any(&mut number);
        *instant = (number.value() != f64::INFINITY).then_some(number);
        if instant.is_some_and(|instant| !instant.value().is_finite()) {
            self.refuse();
        }
    }
}

/// The numbers are counted.
#[derive(Default)]
pub(crate) struct Counted(pub(crate) usize);

impl<R: Real> Row<R> for Counted {
    fn any(&mut self, _number: &mut R) {
        self.0 += 1;
    }

    /// Only their count is wanted.
    fn refuse(&mut self) {}
}

/// The numbers are kept.
pub(crate) struct Kept<'a, R> {
    numbers: core::slice::IterMut<'a, R>,
    refused: bool,
}

impl<'a, R> Kept<'a, R> {
    /// From the first place on.
    pub(crate) fn into(numbers: &'a mut [R]) -> Self {
        Self { numbers: numbers.iter_mut(), refused: false }
    }

    /// Whether all places hold what they may.
    pub(crate) fn is_whole(&self) -> bool {
        !self.refused && self.numbers.len() == 0
    }
}

impl<R: Real> Row<R> for Kept<'_, R> {
    fn any(&mut self, number: &mut R) {
        match self.numbers.next() {
            Some(place) => *place = *number,
            None => self.refused = true,
        }
    }

    fn refuse(&mut self) {
        self.refused = true;
    }
}

/// The numbers are put back.
pub(crate) struct PutBack<'a, R> {
    numbers: core::slice::Iter<'a, R>,
    refused: bool,
}

impl<'a, R> PutBack<'a, R> {
    /// From the first on.
    pub(crate) fn from(numbers: &'a [R]) -> Self {
        Self { numbers: numbers.iter(), refused: false }
    }

    /// Whether all have been put where they may be.
    pub(crate) fn is_whole(&self) -> bool {
        !self.refused && self.numbers.as_slice().is_empty()
    }
}

impl<R: Real> Row<R> for PutBack<'_, R> {
    fn any(&mut self, number: &mut R) {
        match self.numbers.next() {
            Some(next) => *number = *next,
            None => self.refused = true,
        }
    }

    fn refuse(&mut self) {
        self.refused = true;
    }

    fn puts_back(&self) -> bool {
        true
    }
}
