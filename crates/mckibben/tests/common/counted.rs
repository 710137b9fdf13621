//! The operations of one step, counted while it is taken: a scalar that keeps books.
//!
//! Shared by `tests/work.rs`, which pins the counts, and by the benchmark of batches, which measures speed by them.

use mckibben::friction::Memory;
use mckibben::load::Line;
use mckibben::simulation::{Held, Method, Rig, State};
use mckibben::{Mask, Scalar};
use std::cell::Cell;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// How many operations of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    /// Sums.
    pub(crate) add: u64,
    /// Differences.
    pub(crate) subtract: u64,
    /// Products.
    pub(crate) multiply: u64,
    /// Quotients.
    pub(crate) divide: u64,
    /// Square roots.
    pub(crate) root: u64,
    /// Changes of sign.
    pub(crate) negate: u64,
    /// Comparisons.
    pub(crate) compare: u64,
    /// Choices between two values by a mask.
    pub(crate) select: u64,
    /// Logarithms, exponentials, sines and cosines.
    pub(crate) transcendental: u64,
}

impl Counts {
    const NONE: Self = Self {
        add: 0,
        subtract: 0,
        multiply: 0,
        divide: 0,
        root: 0,
        negate: 0,
        compare: 0,
        select: 0,
        transcendental: 0,
    };

    /// Floating-point operations: sums, differences, products, quotients and roots, each as one.
    pub(crate) fn floating_point(&self) -> u64 {
        self.add + self.subtract + self.multiply + self.divide + self.root
    }
}

/// The operations of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Books {
    /// Those that every step must do.
    pub(crate) varying: Counts,
    /// Those on parameters and constants alone, which a compiler lifts out of the loop.
    pub(crate) fixed: Counts,
}

thread_local! {
    static BOOKS: Cell<Books> = const { Cell::new(Books { varying: Counts::NONE, fixed: Counts::NONE }) };
}

fn book(kind: fn(&mut Counts) -> &mut u64, varies: bool) -> bool {
    let mut books = BOOKS.get();
    *kind(if varies { &mut books.varying } else { &mut books.fixed }) += 1;
    BOOKS.set(books);
    varies
}

/// A number that counts what is done with it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counted {
    value: f64,
    varies: bool,
}

/// A truth value that remembers whether it varies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CountedMask {
    value: bool,
    varies: bool,
}

impl Counted {
    fn fixed(value: f64) -> Self {
        Self { value, varies: false }
    }

    fn varying(value: f64) -> Self {
        Self { value, varies: true }
    }

    fn transcendental(self, value: f64) -> Self {
        Self { value, varies: book(|counts| &mut counts.transcendental, self.varies) }
    }

    fn compare(self, other: Self, value: bool) -> CountedMask {
        CountedMask { value, varies: book(|counts| &mut counts.compare, self.varies || other.varies) }
    }
}

impl Mask for CountedMask {
    fn splat(value: bool) -> Self {
        Self { value, varies: false }
    }

    fn any(self) -> bool {
        self.value
    }
}

impl BitAnd for CountedMask {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self { value: self.value & other.value, varies: self.varies || other.varies }
    }
}

impl BitOr for CountedMask {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self { value: self.value | other.value, varies: self.varies || other.varies }
    }
}

impl Not for CountedMask {
    type Output = Self;
    fn not(self) -> Self {
        Self { value: !self.value, ..self }
    }
}

macro_rules! arithmetic {
    ($($trait:ident $method:ident $kind:ident $operator:tt),*) => {
        $(impl $trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                let varies = book(|counts| &mut counts.$kind, self.varies || other.varies);
                Self { value: self.value $operator other.value, varies }
            }
        })*
    };
}

arithmetic!(Add add add +, Sub sub subtract -, Mul mul multiply *, Div div divide /);

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, varies: book(|counts| &mut counts.negate, self.varies) }
    }
}

macro_rules! transcendental {
    ($($method:ident)*) => {
        $(fn $method(self) -> Self { self.transcendental(self.value.$method()) })*
    };
}

impl Scalar for Counted {
    type Mask = CountedMask;

    fn constant(value: f64) -> Self {
        Self::fixed(value)
    }

    fn sqrt(self) -> Self {
        Self { value: self.value.sqrt(), varies: book(|counts| &mut counts.root, self.varies) }
    }

    transcendental!(ln exp exp_m1 sin cos);

    fn lt(self, other: Self) -> CountedMask {
        self.compare(other, self.value < other.value)
    }

    fn le(self, other: Self) -> CountedMask {
        self.compare(other, self.value <= other.value)
    }

    fn select(mask: CountedMask, yes: Self, no: Self) -> Self {
        let varies = book(|counts| &mut counts.select, mask.varies || yes.varies || no.varies);
        Self { value: if mask.value { yes.value } else { no.value }, varies }
    }
}

/// Takes one step of `length` s that nothing divides, and says where it ends and what it took. What is held varies, as it
/// does from lane to lane; the step's length and the parameters do not.
pub(crate) fn step(rig: &Rig, start: State, held: &Held<f64>, length: f64, method: Method) -> ([f64; 4], Books) {
    let rig = rig.map(|_, value| Counted::fixed(value));
    let state = [start.length, start.velocity, start.pressure.0, start.air_mass].map(Counted::varying);
    let mask = |value| CountedMask { value, varies: true };
    let Line { time, length: of_line, slope } = held.line;
    let held = Held {
        supply: mask(held.supply),
        exhaust: mask(held.exhaust),
        openings: mckibben::valve::Openings::Whole,
        sliding: Counted::varying(held.sliding),
        stuck: mask(held.stuck),
        slack: mask(held.slack),
        taut: mask(held.taut),
        line: Line { time: Counted::varying(time), length: Counted::varying(of_line), slope: Counted::varying(slope) },
        compressor: mask(held.compressor),
        memory: Memory::relaxed(Counted::varying(start.length)),
    };
    let (time, length) = (Counted::fixed(0.0), Counted::fixed(length));
    BOOKS.take();
    let end = match method {
        Method::Rk4 => rig.step_rk4(time, state, length, &held),
        Method::Stable => rig.step_stable(time, state, length, &held),
    };
    (end.map(|number| number.value), BOOKS.take())
}
