//! Which rows make a part, which parts a shard, and which rows a unit of work.
//!
//! A part is a fixed range of rows, whatever computes it: part p holds the rows from `p · part_rows` up to the next
//! part. Shard i of n, counted from 1, holds the parts i − 1, i − 1 + n, i − 1 + 2n, …

use crate::failure::Failure;
use crate::quantities::count;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// One of several processes that share a sweep.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Shard {
    /// Which one, from 1.
    pub index: u64,
    /// Of how many.
    pub of: u64,
}

impl Shard {
    /// The whole sweep.
    pub const WHOLE: Self = Self { index: 1, of: 1 };
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            None => Err("write it as I/N with two whole numbers, as in 2/8"),
            Some((_, 0)) => Err("there must be at least one shard, as in 1/1"),
            Some((index, of)) if (1..=of).contains(&index) => Ok(Self { index, of }),
            Some(_) => Err("shards are counted from 1: with N = 8 they are 1/8, 2/8, … 8/8"),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

/// The rows of a sweep in parts.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Plan {
    /// How many rows there are.
    pub rows: u64,
    /// How many of them make a part; at least one.
    pub part_rows: u64,
}

/// Parts that one process takes at most: it keeps a list of them.
pub const MOST_PARTS: u64 = 10_000_000;

/// Rows that are computed together.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Unit {
    /// The part that they belong to.
    pub part: u64,
    /// The rows.
    pub rows: Range<u64>,
}

impl Plan {
    /// How many parts there are.
    pub fn parts(&self) -> u64 {
        self.rows.div_ceil(self.part_rows)
    }

    /// The rows of a part.
    pub fn rows_of(&self, part: u64) -> Range<u64> {
        let start = part.saturating_mul(self.part_rows).min(self.rows);
        start..start.saturating_add(self.part_rows).min(self.rows)
    }

    /// Checks that there is a part with that index.
    ///
    /// # Errors
    /// [`Failure::input`] beyond the last.
    pub fn check_part(&self, part: u64) -> Result<(), Failure> {
        match self.parts() {
            parts if part < parts => Ok(()),
            parts => Err(Failure::input(
                format!("the sweep has no part {part}"),
                format!("parts are counted from 0, and there are {parts}"),
            )),
        }
    }

    /// The parts of a shard.
    pub fn shard(&self, shard: Shard) -> impl Iterator<Item = u64> + use<> {
        (shard.index - 1..self.parts()).step_by(usize::try_from(shard.of).unwrap_or(usize::MAX))
    }

    /// The parts of a shard, as far as one process can keep account of them.
    ///
    /// # Errors
    /// [`Failure::input`] for more than [`MOST_PARTS`].
    pub fn parts_of(&self, shard: Shard) -> Result<Vec<u64>, Failure> {
        let all = self.parts().div_ceil(shard.of);
        if all > MOST_PARTS {
            let [rows, all, most] = [self.rows, all, MOST_PARTS].map(count);
            return Err(Failure::input(
                format!("the sweep has {rows} runs: {all} parts, of which one process takes at most {most}"),
                "give fewer values or `sweep.rows`, a larger `sweep.part_rows`, or a share of the parts by --shard I/N \
                 and a folder",
            ));
        }
        Ok(self.shard(shard).collect())
    }

    /// The rows of parts in units of at most `size` rows, in their order.
    pub fn units(self, parts: Vec<u64>, size: u64) -> impl Iterator<Item = Unit> {
        parts.into_iter().flat_map(move |part| {
            let rows = self.rows_of(part);
            let starts = rows.clone().step_by(usize::try_from(size).unwrap_or(usize::MAX));
            starts.map(move |start| Unit { part, rows: start..(start + size).min(rows.end) })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_units_and_shards_hold_each_row_once() {
        for (rows, part_rows, size, shards) in [(1, 1, 1, 1), (10, 4, 3, 2), (4096, 1000, 128, 3), (7, 100, 2, 5)] {
            let plan = Plan { rows, part_rows };
            let mut seen = Vec::new();
            for index in 1..=shards {
                let parts: Vec<u64> = plan.shard(Shard { index, of: shards }).collect();
                for unit in plan.units(parts, size) {
                    assert!(unit.rows.end - unit.rows.start <= size);
                    assert!(unit.rows.clone().all(|row| row / part_rows == unit.part));
                    seen.extend(unit.rows);
                }
            }
            seen.sort_unstable();
            assert_eq!(seen, (0..rows).collect::<Vec<_>>());
        }
    }

    /// A list of all parts of 10¹² runs would be 2 GB.
    #[test]
    fn more_parts_than_a_process_lists_are_refused_with_the_remedy() {
        let plan = Plan { rows: 1_000_000_000_000, part_rows: 4096 };
        let refused = plan.parts_of(Shard::WHOLE).unwrap_err().to_string();
        assert!(refused.contains("--shard I/N") && refused.contains("part_rows"), "{refused}");
        assert_eq!(plan.parts_of(Shard { index: 1, of: 1_000_000 }).unwrap().len(), 245);
    }

    #[test]
    fn shards_are_counted_from_one() {
        assert_eq!("2/8".parse(), Ok(Shard { index: 2, of: 8 }));
        for text in ["0/8", "9/8", "1/0", "1", "a/b", "-1/2", "1/2/3", ""] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
