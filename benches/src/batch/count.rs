//! The operations of one step, counted while it is taken: a scalar that keeps books.

use crate::work::{Row, STEP};
use mckibben::simulation::Held;
use mckibben::{Mask, Scalar};
use std::cell::RefCell;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Names of the kinds of operation, in their order.
const NAMES: [&str; 8] =
    ["additions", "multiplications", "divisions", "roots", "negations", "comparisons", "selects", "other functions"];

#[derive(Clone, Copy)]
enum Kind {
    Add,
    Multiply,
    Divide,
    Root,
    Negate,
    Compare,
    Select,
    Other,
}

thread_local! {
    static BOOKS: RefCell<Counts> = const { RefCell::new(Counts { varying: [0; 8], fixed: [0; 8] }) };
}

/// How many operations of each kind.
#[derive(Clone, Copy, Default)]
pub struct Counts {
    /// Those that a step must do.
    varying: [u64; 8],
    /// Those on parameters and constants alone, which a compiler or a kernel lifts out of the loop.
    fixed: [u64; 8],
}

impl Counts {
    /// Floating-point operations: additions, multiplications, divisions and roots on what varies, each as one.
    pub fn floating_point(&self) -> u64 {
        self.varying[..=Kind::Root as usize].iter().sum()
    }
}

/// A number that counts what is done with it.
#[derive(Clone, Copy, Debug)]
struct Counted {
    value: f64,
    varies: bool,
}

/// A truth value that remembers whether it varies.
#[derive(Clone, Copy, Debug)]
struct CountedMask {
    value: bool,
    varies: bool,
}

fn book(kind: Kind, varies: bool) -> bool {
    BOOKS.with_borrow_mut(
        |books| if varies { books.varying[kind as usize] += 1 } else { books.fixed[kind as usize] += 1 },
    );
    varies
}

impl Counted {
    fn fixed(value: f64) -> Self {
        Self { value, varies: false }
    }

    fn varying(value: f64) -> Self {
        Self { value, varies: true }
    }

    fn unary(self, kind: Kind, value: f64) -> Self {
        Self { value, varies: book(kind, self.varies) }
    }

    fn binary(self, other: Self, kind: Kind, value: f64) -> Self {
        Self { value, varies: book(kind, self.varies || other.varies) }
    }

    fn compare(self, other: Self, value: bool) -> CountedMask {
        CountedMask { value, varies: book(Kind::Compare, self.varies || other.varies) }
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
                self.binary(other, Kind::$kind, self.value $operator other.value)
            }
        })*
    };
}

arithmetic!(Add add Add +, Sub sub Add -, Mul mul Multiply *, Div div Divide /);

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        self.unary(Kind::Negate, -self.value)
    }
}

macro_rules! functions {
    ($($method:ident)*) => {
        $(fn $method(self) -> Self { self.unary(Kind::Other, self.value.$method()) })*
    };
}

impl Scalar for Counted {
    type Mask = CountedMask;

    fn constant(value: f64) -> Self {
        Self::fixed(value)
    }

    fn sqrt(self) -> Self {
        self.unary(Kind::Root, self.value.sqrt())
    }

    functions!(ln exp exp_m1 sin cos);

    fn lt(self, other: Self) -> CountedMask {
        self.compare(other, self.value < other.value)
    }

    fn le(self, other: Self) -> CountedMask {
        self.compare(other, self.value <= other.value)
    }

    fn select(mask: CountedMask, yes: Self, no: Self) -> Self {
        let varies = book(Kind::Select, mask.varies || yes.varies || no.varies);
        Self { value: if mask.value { yes.value } else { no.value }, varies }
    }
}

/// Counts one step of the classical Runge–Kutta method, with one passage open and no edge inside.
pub fn step(row: &Row) -> Counts {
    let rig = row.rig.map(|_, value| Counted::fixed(value));
    let start = row.start;
    let state = [start.length, start.velocity, start.pressure.0, start.air_mass].map(Counted::varying);
    let held = Held {
        supply: CountedMask::splat(true),
        exhaust: CountedMask::splat(false),
        sliding: Counted::varying(1.0),
        stuck: CountedMask { value: false, varies: true },
        corners_passed: 0,
    };
    BOOKS.take();
    rig.step_rk4(Counted::varying(0.0), state, Counted::fixed(STEP), &held);
    BOOKS.take()
}

/// Prints the table.
pub fn print(counts: &Counts) {
    println!("operations of one step (four evaluations of the rates), counted as `Rig::step_rk4` does them");
    println!("{:<18} {:>8} {:>22}", "", "", "on parameters alone");
    for (kind, name) in NAMES.iter().enumerate() {
        println!("{name:<18} {:>8} {:>22}", counts.varying[kind], counts.fixed[kind]);
    }
    println!("{:<18} {:>8}   additions to roots, each as one", "floating point", counts.floating_point());
}
