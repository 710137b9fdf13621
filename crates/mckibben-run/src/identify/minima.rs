//! Whether a fit depends on where the search starts: the ends of searches from several starts, in words and as a table.

use super::outcome::WARNED;
use super::values::rounded;
use crate::report::Table;
use crate::units::units;
use mckibben_identify::least_squares::{Ending, Found, Minimum, Unknown};

/// The sum of squares of another minimum, over the least, up to which it casts doubt on the estimates.
const RIVAL: f64 = 2.0;
/// Other ends that are named.
const NAMED: usize = 5;

/// Where another search has ended.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherMinimum {
    /// The values of the parameters there, in the order of the estimates.
    pub values: Vec<f64>,
    /// Root mean square of the weighted residuals there, over that of the estimates; infinite where these leave nothing.
    pub error_ratio: f64,
    /// How many searches ended there.
    pub searches: usize,
    /// Whether it is a minimum; else a kink, or the search was not done.
    pub is_minimum: bool,
}

/// The ends of the searches of a fit.
pub(super) struct Minima {
    pub(super) table: Table,
    pub(super) others: Vec<OtherMinimum>,
    summary: Option<String>,
    rivals: Option<String>,
}

impl Minima {
    /// What a reader should know of them.
    pub(super) fn words(&self) -> impl Iterator<Item = String> {
        self.rivals.iter().chain(&self.summary).cloned().collect::<Vec<_>>().into_iter()
    }
}

/// The ends of the searches of a fit of these unknowns.
pub(super) fn of(found: &Found, unknowns: &[Unknown]) -> Minima {
    let others: Vec<OtherMinimum> = found.others.iter().map(|end| other(end, found.cost)).collect();
    let screened = match found.screened {
        0 => String::new(),
        count => format!(" (of {count} more starts that were evaluated, the best)"),
    };
    let failed = match found.failed {
        0 => String::new(),
        count => format!("; {count} found nothing, as the model cannot be simulated there"),
    };
    let summary = (found.tried > 1).then(|| match others.len() {
        0 => format!("{} of {} searches{screened} led to these values{failed}.", found.agreeing, found.tried),
        ends => format!(
            "{} of {} searches{screened} led to these values, the others to {ends} other {}{failed}.",
            found.agreeing,
            found.tried,
            if ends == 1 { "end" } else { "ends" }
        ),
    });
    let rivals: Vec<&OtherMinimum> = others.iter().filter(|of| of.error_ratio.powi(2) <= RIVAL).collect();
    let rivals = rivals.first().map(|nearest| {
        let value = |(unknown, value): (&Unknown, &f64)| {
            let bound = unknown.bound_of(*value);
            let value = bound.unwrap_or(*value);
            let shown = units().shown(unknown.unit, value.abs());
            let rests = if bound.is_some() { " (on its bound)" } else { "" };
            format!("`{}` = {}{rests}", unknown.name, shown.with(&rounded(shown.number(value), None)))
        };
        let values: Vec<String> = unknowns.iter().zip(&nearest.values).map(value).take(NAMED).collect();
        let more = if unknowns.len() > NAMED { " …" } else { "" };
        format!(
            "{WARNED}the values depend on the start: another search ended at {}{more}, where {:.3} times as much is left. Give bounds \
             that leave one of them out, more or other runs, or a prior.",
            values.join(", "),
            nearest.error_ratio
        )
    });
    Minima { table: table(found, unknowns, &others), others, summary, rivals }
}

fn other(end: &Minimum, least: f64) -> OtherMinimum {
    let ratio = (end.cost / least).sqrt();
    OtherMinimum {
        values: end.values.clone(),
        error_ratio: if ratio.is_nan() { f64::INFINITY } else { ratio },
        searches: end.searches,
        is_minimum: end.ending == Ending::Minimum,
    }
}

/// A row for each end, that of the values first; nothing where there is but one.
fn table(found: &Found, unknowns: &[Unknown], others: &[OtherMinimum]) -> Table {
    if others.is_empty() {
        return Table::default();
    }
    let head = |unknown: &Unknown| match unknown.unit {
        "" => unknown.name.clone(),
        unit => format!("{} ({unit})", unknown.name),
    };
    let head = unknowns.iter().map(head).chain(["left, over the least", "searches", "minimum"].map(String::from));
    let row = |values: &[f64], ratio: f64, searches: usize, is_minimum: bool| -> Vec<String> {
        let ratio = match ratio.is_finite() {
            true if ratio < 1e4 => format!("{ratio:.4}"),
            true => format!("{ratio:.3e}"),
            false => "–".to_owned(),
        };
        let values = unknowns
            .iter()
            .zip(values)
            .map(|(unknown, value)| rounded(unknown.bound_of(*value).unwrap_or(*value), None));
        values.chain([ratio, searches.to_string(), if is_minimum { "yes" } else { "no" }.to_owned()]).collect()
    };
    let is_minimum = found.fit.ending == Ending::Minimum;
    let rows = std::iter::once(row(&found.fit.values(), 1.0, found.agreeing, is_minimum))
        .chain(others.iter().map(|of| row(&of.values, of.error_ratio, of.searches, of.is_minimum)));
    Table {
        caption: "Where searches from several starts ended: the values of this fit first, then the others, with the root mean square of \
                  what they leave, over the least."
            .to_owned(),
        head: head.collect(),
        rows: rows.collect(),
    }
}
