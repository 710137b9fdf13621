//! `[search]` of a study file: starts, limits, weights, and how much of trajectories is fitted at once.

use super::file::{Kind, Within};
use super::{Quantity, StudyError};
use crate::trajectories::Horizon;
use serde::Deserialize;
use toml::Spanned;

/// More starts than a study may have.
const MOST_STARTS: usize = 1_000_000;

/// How a study is searched.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchEntry {
    /// More starts than the first, each of which is searched from; where it is not said, that is the kind's to choose.
    pub more_starts: Option<usize>,
    /// Steps after which a search ends.
    pub most_steps: Option<u64>,
    /// Time in s after which the search ends.
    pub time_limit: Option<f64>,
    /// Standard deviations up to which a residual counts in full; beyond it counts less (Huber).
    pub robust: Option<f64>,
    /// How much of the trajectories is fitted, and in which parts.
    pub horizon: Horizon,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawSearch {
    more_starts: Option<Spanned<usize>>,
    most_steps: Option<Spanned<u64>>,
    time_limit: Option<Spanned<String>>,
    robust: Option<Spanned<f64>>,
    horizon: Option<Spanned<Vec<Spanned<String>>>>,
    segments: Option<Spanned<String>>,
}

impl RawSearch {
    /// Refuses a key that a study of this kind does not read.
    fn check_kind(&self, within: &Within<'_>, kind: Kind) -> Result<(), StudyError> {
        let place = |span: std::ops::Range<usize>| span.start;
        let (searched, followed) = (Kind::SEARCHED.as_slice(), [Kind::Trajectories].as_slice());
        let keys = [
            ("more_starts", self.more_starts.as_ref().map(|of| place(of.span())), Kind::OF_NUMBERS.as_slice()),
            ("most_steps", self.most_steps.as_ref().map(|of| place(of.span())), searched),
            ("time_limit", self.time_limit.as_ref().map(|of| place(of.span())), searched),
            ("robust", self.robust.as_ref().map(|of| place(of.span())), searched),
            ("horizon", self.horizon.as_ref().map(|of| place(of.span())), followed),
            ("segments", self.segments.as_ref().map(|of| place(of.span())), followed),
        ];
        for (key, at, kinds) in keys {
            if at.is_some() {
                within.read_by(&format!("`{key}` in [search]"), at, kind, kinds)?;
            }
        }
        Ok(())
    }

    /// What it says, checked.
    pub(super) fn read(self, within: &Within<'_>, kind: Kind) -> Result<SearchEntry, StudyError> {
        self.check_kind(within, kind)?;
        let robust = self.robust.map(Spanned::into_inner);
        if robust.is_some_and(|scale| scale.is_nan() || scale <= 0.0) {
            return Err(within.fault(
                None,
                "`search.robust` is not above zero",
                "give a number of deviations such as 2.5",
            ));
        }
        let more_starts = self.more_starts.map(Spanned::into_inner);
        if let Some(count) = more_starts.filter(|count| *count > MOST_STARTS) {
            let what = format!("`search.more_starts` is {count}, above {MOST_STARTS}");
            return Err(within.fault(None, what, "give fewer starts, such as 16"));
        }
        if let Some(most) = self.most_steps.as_ref().filter(|most| *most.as_ref() == 0) {
            let what = "`search.most_steps` is 0, but a search takes 1 step or more";
            return Err(within.fault(
                Some(most.span().start),
                what,
                "give a number of steps such as 500, or leave it out",
            ));
        }
        let time_limit = within.maybe(self.time_limit.as_ref(), Quantity::Time)?;
        if let (Some(text), Some(limit)) = (&self.time_limit, time_limit)
            && !(limit > 0.0 && limit.is_finite())
        {
            let what = format!("`search.time_limit` is \"{}\", which is not above zero", text.as_ref());
            return Err(within.fault(Some(text.span().start), what, "give a time such as \"600 s\", or leave it out"));
        }
        let ends = |texts: &Vec<Spanned<String>>| {
            texts.iter().map(|text| within.si(text, Quantity::Time)).collect::<Result<Vec<f64>, _>>()
        };
        let horizon = match (&self.horizon, &self.segments) {
            (None, None) => Horizon::Whole,
            (Some(texts), None) => Horizon::Growing(ends(texts.as_ref())?),
            (None, Some(text)) => Horizon::Segments(within.si(text, Quantity::Time)?),
            (Some(_), Some(text)) => {
                let what = "`search.horizon` and `search.segments` exclude each other";
                return Err(within.fault(Some(text.span().start), what, "leave one of them out"));
            }
        };
        let most_steps = self.most_steps.map(Spanned::into_inner);
        Ok(SearchEntry { more_starts, most_steps, time_limit, robust, horizon })
    }
}
