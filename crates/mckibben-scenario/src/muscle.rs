//! A braid as people describe it: what a file states of it, and what follows.
//!
//! ```text
//! L₀ = b cos θ₀        π n D₀ = b sin θ₀        (2), at rest
//! ```
//!
//! | symbol | key | what it is |
//! |---|---|---|
//! | b | `thread_length` | length of one thread |
//! | n | `turns` | turns of one thread |
//! | L₀ | `length` | length of the muscle at rest |
//! | D₀ | `diameter` | diameter of the braid at rest, between the middles of opposite threads |
//! | θ₀ | `braid_angle` | angle between thread and axis at rest: the paper's interweave angle |
//!
//! Two equations for five numbers: any three give the other two, but for b, L₀ and θ₀, which are those of one equation. The model
//! needs b and n, and these two are enough. What is stated beyond that must agree with what follows from the rest within
//! [`TOLERANCE`]; a stated number is used as it stands.
//!
//! The greatest length is that at rest, and the least that of the neutral angle, b/√3, where the file gives none: both are assumed.
//!
//! Checked by `tests/muscle.rs`: each determining set against the closed form, contradictions and gaps with their places.

use crate::follow::least_length;
use mckibben::parameter::{self as p, Parameter};
use mckibben::{Error, Requirement};
use std::f64::consts::PI;

/// How far a number that is stated may be from what follows from the others, relative to it: an angle that is rounded to a
/// tenth of a degree changes the turns by 0.2 %.
pub const TOLERANCE: f64 = 5e-3;

/// What describes a braid; the first two are those of the model, the others describe it at rest.
pub(crate) static BRAID: [&Parameter; 5] = [&p::THREAD_LENGTH, &p::TURNS, &p::LENGTH, &p::DIAMETER, &p::BRAID_ANGLE];

/// The keys that describe a braid at rest.
pub(crate) static AT_REST: [&Parameter; 3] = [&p::LENGTH, &p::DIAMETER, &p::BRAID_ANGLE];

const B: usize = 0;
const N: usize = 1;
const L: usize = 2;
const D: usize = 3;
const THETA: usize = 4;

/// The sets that determine a braid, with their names in messages. The first that is stated is what the rest is held to.
static SETS: [(&[usize], &str); 10] = [
    (&[L, D, THETA], "what length, diameter and braid_angle give:"),
    (&[N, L, THETA], "what turns, length and braid_angle give:"),
    (&[N, L, D], "what turns, length and diameter give:"),
    (&[N, D, THETA], "what turns, diameter and braid_angle give:"),
    (&[B, L, D], "what thread_length, length and diameter give:"),
    (&[B, D, THETA], "what thread_length, diameter and braid_angle give:"),
    (&[B, N, L], "what thread_length, turns and length give:"),
    (&[B, N, THETA], "what thread_length, turns and braid_angle give:"),
    (&[B, N, D], "what thread_length, turns and diameter give:"),
    (&[B, N], "what thread_length and turns give:"),
];

/// What is stated of a braid and its range of lengths, in SI.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stated {
    /// In the order of [`BRAID`].
    values: [Option<f64>; 5],
    max_length: Option<f64>,
    min_length: Option<f64>,
}

/// A braid at rest: all five numbers, of which a file states some.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Muscle {
    /// Length b of one thread in m.
    pub thread_length: f64,
    /// Turns n of one thread.
    pub turns: f64,
    /// Length L₀ at rest in m; `max_length` where nothing is said of rest.
    pub length: f64,
    /// Diameter D₀ in m at that length.
    pub diameter: f64,
    /// Braid angle θ₀ in rad at that length.
    pub braid_angle: f64,
    /// Greatest length L_max in m.
    pub max_length: f64,
    /// Least length L_min in m.
    pub min_length: f64,
    stated: Stated,
}

/// Why what is stated gives no braid.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Fault {
    /// Too little is stated: keys each of which would do, or of which two would.
    Open { one_of: Vec<&'static Parameter>, two_of: Vec<&'static Parameter> },
    /// A number contradicts others.
    Contradiction { of: &'static Parameter, value: f64, requirement: Requirement, others: Vec<&'static Parameter> },
}

impl Fault {
    /// As the core has it.
    pub(crate) fn error(self) -> Error {
        match self {
            Self::Open { .. } => Error::Misuse {
                what: "what is stated of the muscle does not determine its braid",
                remedy: "give length, diameter and braid_angle, or thread_length and turns",
            },
            Self::Contradiction { of, value, requirement, .. } => {
                Error::Inconsistent { parameter: of, value, requirement, remedy: REMEDY }
            }
        }
    }
}

/// What to do about a contradiction.
pub(crate) const REMEDY: &str = "correct one of these values, or leave one out: the program computes it";

impl Stated {
    /// What is stated of each key.
    pub(crate) fn new(mut of: impl FnMut(&'static Parameter) -> Option<f64>) -> Self {
        Self { values: BRAID.map(&mut of), max_length: of(&p::MAX_LENGTH), min_length: of(&p::MIN_LENGTH) }
    }

    /// Where a parameter is stated, if it is one of the braid or its range of lengths.
    pub(crate) fn slot(&mut self, row: &Parameter) -> Option<&mut Option<f64>> {
        match BRAID.iter().position(|of| of.key == row.key) {
            Some(at) => Some(&mut self.values[at]),
            None if row.key == p::MAX_LENGTH.key => Some(&mut self.max_length),
            None if row.key == p::MIN_LENGTH.key => Some(&mut self.min_length),
            None => None,
        }
    }

    /// What is stated of a parameter.
    pub(crate) fn get(mut self, row: &Parameter) -> Option<f64> {
        self.slot(row).copied().flatten()
    }

    /// Whether something is said of rest.
    pub(crate) fn is_at_rest(&self) -> bool {
        self.values[L..].iter().any(Option::is_some)
    }

    /// The keys of the braid that are stated.
    pub(crate) fn keys(&self) -> impl Iterator<Item = &'static Parameter> {
        BRAID.into_iter().zip(self.values).filter_map(|(row, value)| value.map(|_| row))
    }

    /// All that follows.
    pub(crate) fn muscle(self) -> Result<Muscle, Fault> {
        let (set, name) = self.set().ok_or_else(|| self.open())?;
        let of = |at: usize| self.values[at].unwrap_or_default();
        let [b, n, l, d, theta] = [B, N, L, D, THETA].map(of);
        let root = |square: f64| square.max(0.0).sqrt();
        let (b, n, l) = match *set {
            [L, D, THETA] => (l / theta.cos(), l * theta.tan() / (PI * d), l),
            [N, L, THETA] => (l / theta.cos(), n, l),
            [N, L, D] => (l.hypot(PI * n * d), n, l),
            [N, D, THETA] => (PI * n * d / theta.sin(), n, PI * n * d / theta.tan()),
            [B, L, D] => {
                self.less((L, l), (B, b), &[B], p::THREAD_LENGTH.key)?;
                (b, root(b * b - l * l) / (PI * d), l)
            }
            [B, D, THETA] => (b, b * theta.sin() / (PI * d), b * theta.cos()),
            [B, N, L] => {
                self.less((L, l), (B, b), &[B], p::THREAD_LENGTH.key)?;
                (b, n, l)
            }
            [B, N, THETA] => (b, n, b * theta.cos()),
            [B, N, D] => {
                self.less(
                    (D, d),
                    (B, b / (PI * n)),
                    &[B, N],
                    "the diameter at which the thread runs around in circles,",
                )?;
                (b, n, root(b * b - (PI * n * d).powi(2)))
            }
            // Nothing is said of rest: it is described where the braid is taut.
            _ => (b, n, self.max_length.unwrap_or_else(|| least_length(b))),
        };
        let around = root(b * b - l * l);
        let follows = [b, n, l, around / (PI * n), (l / b).clamp(-1.0, 1.0).acos()];
        for (at, (stated, follows)) in self.values.into_iter().zip(follows).enumerate() {
            if let Some(value) = stated.filter(|_| !set.contains(&at))
                && (value - follows).abs() > TOLERANCE * follows.abs()
            {
                let requirement = Requirement {
                    relation: "must agree within 0.5 % with",
                    other: name,
                    value: follows,
                    unit: BRAID[at].unit,
                };
                let others = set.iter().map(|of| BRAID[*of]).collect();
                return Err(Fault::Contradiction { of: BRAID[at], value, requirement, others });
            }
        }
        if let Some(max_length) = self.max_length.filter(|most| self.is_at_rest() && l > most * (1.0 + TOLERANCE)) {
            let (other, unit) = (p::MAX_LENGTH.key, p::LENGTH.unit);
            let requirement = Requirement { relation: "at rest must be at most", other, value: max_length, unit };
            return Err(Fault::Contradiction { of: &p::LENGTH, value: l, requirement, others: vec![&p::MAX_LENGTH] });
        }
        let used = |at: usize| self.values[at].unwrap_or(follows[at]);
        let [thread_length, turns, length, diameter, braid_angle] = [B, N, L, D, THETA].map(used);
        let max_length = self.max_length.unwrap_or(length);
        let min_length = self.min_length.unwrap_or_else(|| least_length(thread_length));
        Ok(Muscle { thread_length, turns, length, diameter, braid_angle, max_length, min_length, stated: self })
    }

    /// The set that determines the braid.
    fn set(&self) -> Option<(&'static [usize], &'static str)> {
        SETS.iter().find(|(set, _)| set.iter().all(|at| self.values[*at].is_some())).copied()
    }

    /// Refuses a number that must be less than what follows from others.
    fn less(
        &self,
        (at, value): (usize, f64),
        (of, most): (usize, f64),
        others: &[usize],
        other: &'static str,
    ) -> Result<(), Fault> {
        if value < most {
            return Ok(());
        }
        let requirement = Requirement { relation: "must be less than", other, value: most, unit: BRAID[of].unit };
        let others = others.iter().map(|of| BRAID[*of]).collect();
        Err(Fault::Contradiction { of: BRAID[at], value, requirement, others })
    }

    /// What more would determine the braid.
    fn open(&self) -> Fault {
        let absent = || (0..5).filter(|at| self.values[*at].is_none());
        let with = |at: usize| {
            let mut more = *self;
            more.values[at] = Some(1.0);
            more
        };
        let one_of: Vec<_> = absent().filter(|at| with(*at).set().is_some()).collect();
        let two = |at: &usize| {
            let more = with(*at);
            (0..5).any(|other| {
                let mut both = more;
                both.values[other] = Some(1.0);
                both.set().is_some()
            })
        };
        let two_of: Vec<_> = absent().filter(two).collect();
        let rows = |at: Vec<usize>| at.into_iter().map(|at| BRAID[at]).collect();
        Fault::Open { one_of: rows(one_of), two_of: rows(two_of) }
    }
}

/// Whether keys determine a braid without others.
pub(crate) fn determine(given: impl Fn(&Parameter) -> bool) -> bool {
    Stated::new(|row| given(row).then_some(1.0)).set().is_some()
}

impl Muscle {
    /// The keys from which the braid is computed, in the order of the table.
    pub fn stated(&self) -> impl Iterator<Item = &'static Parameter> {
        self.stated.keys()
    }

    /// Whether the muscle is described at rest; otherwise `length`, `diameter` and `braid_angle` are those at `max_length`.
    pub fn is_at_rest(&self) -> bool {
        self.stated.is_at_rest()
    }

    /// The range of lengths where nothing states it: greatest and least.
    pub(crate) fn assumed(&self) -> [Option<f64>; 2] {
        [
            self.stated.max_length.is_none().then_some(self.max_length),
            self.stated.min_length.is_none().then_some(self.min_length),
        ]
    }
}
