//! Errors where the fit has not looked: each group of points is left out in turn, and the law that was fitted to the
//! others is held to it.
//!
//! Groups are lengths, pressures or runs. Up to 24 different lengths or pressures are a group each; more are cut into
//! five ranges with as many points each. How a law predicts between measured lengths is tested by leaving out one in
//! the middle, and what it says beyond them by leaving out the first or the last.

use super::{Candidate, Errors, ForceMap, Point};
use crate::least_squares::Search;

/// The most values that are a group each.
const MOST_VALUES: usize = 24;
/// Ranges of more values than that.
const FOLDS: usize = 5;
/// Values closer than this part of the largest are one.
const ALIKE: f64 = 1e-6;

/// What the groups are.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Grouping {
    /// Points at one length.
    Lengths,
    /// Points at one gauge pressure.
    Pressures,
    /// Points of one run.
    Runs,
}

impl Grouping {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Lengths, Self::Pressures, Self::Runs];

    /// As it is written in a study.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lengths => "lengths",
            Self::Pressures => "pressures",
            Self::Runs => "runs",
        }
    }

    /// Unit of its values.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Lengths => "m",
            Self::Pressures => "Pa",
            Self::Runs => "",
        }
    }

    fn of(self, point: &Point) -> f64 {
        match self {
            Self::Lengths => point.length,
            Self::Pressures => point.gauge_pressure,
            Self::Runs => point.run as f64,
        }
    }

    /// The least and largest value of each group, rising, of the points that hold a tension.
    pub fn groups(self, map: &ForceMap) -> Vec<[f64; 2]> {
        let mut values: Vec<f64> = map.held().map(|point| self.of(point)).collect();
        values.sort_by(f64::total_cmp);
        let apart = ALIKE * values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let mut groups: Vec<[f64; 2]> = Vec::new();
        for value in &values {
            match groups.last_mut() {
                Some(last) if value - last[1] <= apart => last[1] = *value,
                _ => groups.push([*value; 2]),
            }
        }
        if groups.len() <= MOST_VALUES || self == Self::Runs {
            return groups;
        }
        let ends = |fold: usize| [values[fold * values.len() / FOLDS], values[(fold + 1) * values.len() / FOLDS - 1]];
        (0..FOLDS).map(ends).collect()
    }
}

/// A law held to points that it was not fitted to.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldOut {
    /// What was left out, one group at a time.
    pub by: Grouping,
    /// Each group.
    pub folds: Vec<Fold>,
}

/// One group that was left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// Least and largest length (m), pressure (Pa) or number of the run.
    pub of: [f64; 2],
    /// Errors there; `None` when the others do not determine the law.
    pub errors: Option<Errors>,
}

impl HeldOut {
    /// Errors of all groups together; `None` when one of them has none.
    pub fn errors(&self) -> Option<Errors> {
        Self::of(&self.folds)
    }

    /// Errors of the groups between the first and the last, for which the law is held to what lies between its points; `None`
    /// when one of them has none, or there is none.
    pub fn between(&self) -> Option<Errors> {
        let inner = self.folds.get(1..self.folds.len().saturating_sub(1))?;
        if inner.is_empty() { None } else { Self::of(inner) }
    }

    fn of(folds: &[Fold]) -> Option<Errors> {
        folds.iter().try_fold(Errors::default(), |sum, fold| Some(sum.and(fold.errors?)))
    }
}

impl Candidate {
    /// Leaves each group out in turn, and looks for the law also from `values`, those of all points; `None` when
    /// there is but one group.
    pub fn held_out(
        &self,
        map: &ForceMap,
        by: Grouping,
        values: &[f64],
        deviation: Option<f64>,
        search: &Search,
    ) -> Option<HeldOut> {
        let groups = by.groups(map);
        if groups.len() < 2 {
            return None;
        }
        let mut candidate = self.clone();
        candidate.starts.push(values.to_vec());
        let fold = |of: &[f64; 2]| {
            let within = |point: &Point| (of[0]..=of[1]).contains(&by.of(point));
            let errors = || {
                let (others, rest) = (map.only(|point| !within(point))?, map.only(within)?);
                let fit = candidate.fit(&others, deviation, search).ok()?;
                Some(rest.errors(&fit.scenario.driven().ok()?.actuator))
            };
            Fold { of: *of, errors: errors() }
        };
        Some(HeldOut { by, folds: groups.iter().map(fold).collect() })
    }
}
