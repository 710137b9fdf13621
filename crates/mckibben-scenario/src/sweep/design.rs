//! Designs: which part of an axis each row takes, as a function of the row alone.
//!
//! | design | row r of n |
//! |---|---|
//! | grid | every combination once; the last axis changes from row to row, the first changes least often |
//! | random | independent uniform numbers |
//! | Latin hypercube | (π(r) + u) / n, π a random permutation of each axis, u a uniform number: each of n strata once |
//! | Sobol' | point r of the sequence, scrambled |
//!
//! McKay, Beckman & Conover, "A comparison of three methods for selecting values of input variables", Technometrics 21,
//! 239-245 (1979), for the Latin hypercube; [`super::sobol`] for the sequence. Random numbers are those of
//! [`super::random`], keyed by seed and axis. Checked by `tests/sweep.rs`.

use super::permutation::Permutation;
use super::random::Stream;
use super::sobol;

/// Most rows of a sweep, 2^40: the strata of a Latin hypercube then stay far wider than a rounding.
pub(crate) const MOST_ROWS: u64 = 1 << 40;

/// How one axis is sampled.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Sampler {
    /// Steps of a list, each for as many rows on end.
    Grid {
        /// Rows between two steps: the number of combinations of the axes behind.
        stride: u64,
    },
    /// Independent draws.
    Random(Stream),
    /// One draw in each stratum.
    LatinHypercube {
        /// Which stratum each row takes.
        strata: Permutation,
        /// Number of strata.
        rows: u64,
        /// Where in its stratum the draw lies.
        within: Stream,
    },
    /// A dimension of the sequence.
    Sobol(Box<sobol::Dimension>),
}

/// What a row takes of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Draw {
    /// A step, counted from 0, that may go round a list more than once.
    Step(u64),
    /// A number above 0 and below 1.
    Unit(f64),
}

impl Sampler {
    /// One draw in each of `rows` strata, in an order of the stream's own.
    pub(super) fn latin_hypercube(rows: u64, stream: Stream) -> Self {
        Self::LatinHypercube { strata: Permutation::new(rows, stream.split(0)), rows, within: stream.split(1) }
    }

    /// What a row takes.
    pub(super) fn draw(&self, row: u64) -> Draw {
        match self {
            Self::Grid { stride } => Draw::Step(row / stride),
            Self::Random(stream) => Draw::Unit(stream.unit(row)),
            Self::LatinHypercube { strata, rows, within } => {
                // As many bits as leave stratum and place in it exact, so that the quotient cannot round into the next.
                let bits = 48 - rows.ilog2();
                let place = ((within.bits(row) >> (64 - bits)) as f64 + 0.5) / (1_u64 << bits) as f64;
                Draw::Unit((strata.at(row) as f64 + place) / *rows as f64)
            }
            Self::Sobol(dimension) => Draw::Unit(dimension.at(row)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_latin_hypercube_has_one_point_in_each_stratum() {
        for rows in [1, 2, 3, 10, 1000, 4096, 99_991] {
            let sampler = Sampler::latin_hypercube(rows, Stream::new(5, "load.mass"));
            let mut seen = vec![false; rows as usize];
            for row in 0..rows {
                let Draw::Unit(share) = sampler.draw(row) else { panic!("a share") };
                let stratum = (share * rows as f64).floor() as usize;
                assert!(!std::mem::replace(&mut seen[stratum], true), "{rows}: stratum {stratum} twice");
            }
        }
    }

    /// The widest sweep: a number in the last stratum stays below 1, and row and stratum stay one to one at the ends.
    #[test]
    fn the_largest_latin_hypercube_stays_in_the_unit_interval() {
        let sampler = Sampler::latin_hypercube(MOST_ROWS, Stream::new(5, ""));
        let mut strata: Vec<u64> = [0, 1, 2, MOST_ROWS - 2, MOST_ROWS - 1]
            .into_iter()
            .map(|row| match sampler.draw(row) {
                Draw::Unit(share) if share > 0.0 && share < 1.0 => (share * MOST_ROWS as f64).floor() as u64,
                other => panic!("{other:?}"),
            })
            .collect();
        strata.sort_unstable();
        strata.dedup();
        assert_eq!(strata.len(), 5);
    }
}
