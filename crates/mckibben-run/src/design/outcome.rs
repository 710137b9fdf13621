//! What a search found: the best values, how far each constraint is from its bound, and which ends of ranges were reached.

use super::chart;
use super::constraint::Constraint;
use super::search::TOLERANCE;
use super::vary::Vary;
use super::written::Written;
use super::{Goal, Request};
use crate::failure::Failure;
use crate::quantities::{digits, plain};
use crate::report::Table;
use crate::units::units;
use crate::warnings::Warning;
use mckibben_plot::Figure;
use mckibben_scenario::Document;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Part of its scale within which a constraint is active.
const ACTIVE: f64 = 1e-4;
/// Part of a range within which a value is at its end.
const AT_END: f64 = 1e-4;

/// A point that was run.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// Its place in the unit box.
    pub at: Vec<f64>,
    /// The value of each key in the unit of its range.
    pub values: Vec<f64>,
    /// The objective and the number of each constraint in SI, or why there are none.
    pub numbers: Result<Vec<f64>, String>,
    /// By how much the constraint that is broken most is broken, in parts of its bound.
    pub violation: f64,
}

impl Reached {
    /// Whether every constraint is met, to a millionth of its bound.
    pub fn is_feasible(&self) -> bool {
        self.violation <= TOLERANCE
    }
}

/// An end of a range.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum End {
    /// The lower one.
    Low,
    /// The upper one.
    High,
}

/// What a search found.
#[derive(Debug)]
pub struct Outcome {
    pub(super) document: Document,
    pub(super) request: Request,
    /// The unit of the objective in SI.
    pub(super) unit: String,
    /// Every point that was run, in the order of the search.
    pub(super) points: Vec<Reached>,
    pub(super) best: usize,
    pub(super) scales: Vec<f64>,
    pub(super) is_converged: bool,
    pub(super) interrupted: bool,
    /// The document with the values of the best point.
    pub(super) found: Document,
    /// The warnings of its run.
    pub(super) warnings: Vec<Warning>,
}

impl Outcome {
    /// Whether the search came to its smallest steps before its evaluations were used up.
    pub fn is_converged(&self) -> bool {
        self.is_converged
    }

    /// The scenario with the settings and the values found.
    pub fn found(&self) -> &Document {
        &self.found
    }

    /// Whether the search was ended before it was done.
    pub fn is_interrupted(&self) -> bool {
        self.interrupted
    }

    /// The warnings of the run at the best point, as `mckibben simulate` has them.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// The request.
    pub fn request(&self) -> &Request {
        &self.request
    }

    /// Every point that was run, in the order of the search.
    pub fn points(&self) -> &[Reached] {
        &self.points
    }

    /// The best point; the one that breaks the constraints the least where none meets them.
    pub fn best(&self) -> &Reached {
        &self.points[self.best]
    }

    /// The objective at the best point in SI, with its unit; nothing where every run failed.
    pub fn objective(&self) -> Option<(f64, &str)> {
        Some((*self.best().numbers.as_ref().ok()?.first()?, self.unit.as_str()))
    }

    /// The numbers of the constraints at the best point, in SI.
    fn numbers(&self) -> &[f64] {
        self.best().numbers.as_ref().map_or(&[], |numbers| &numbers[1..])
    }

    /// Whether a constraint is met at a value in SI, to a millionth of its scale; and whether it is active there.
    fn state(&self, place: usize, value: f64) -> (bool, bool) {
        let excess = self.request.constraints[place].excess(value) / self.scales[place];
        (excess <= TOLERANCE, excess.abs() <= ACTIVE)
    }

    /// The value of each key at the best point in SI.
    pub fn values_in_si(&self) -> Vec<f64> {
        self.request.vary.iter().zip(&self.best().values).map(|(vary, value)| vary.in_si(*value)).collect()
    }

    /// The value of each constraint at the best point, its margin, and whether it is active, in SI; nothing where every run failed.
    pub fn margins(&self) -> Vec<(f64, f64, bool)> {
        let of = |(place, value): (usize, &f64)| {
            // A difference of zero has no sign.
            (*value, -self.request.constraints[place].excess(*value) + 0.0, self.state(place, *value).1)
        };
        self.numbers().iter().enumerate().map(of).collect()
    }

    /// The end of its range that the value of a key has reached.
    pub fn end(&self, key: usize) -> Option<End> {
        match self.best().at[key] {
            x if x <= AT_END => Some(End::Low),
            x if x >= 1.0 - AT_END => Some(End::High),
            _ => None,
        }
    }

    /// The values found, with the ranges.
    pub fn values(&self) -> Table {
        let row = |(place, vary): (usize, &Vary)| {
            let scale = if vary.is_logarithmic() { ", logarithmic" } else { "" };
            let remark = match self.end(place) {
                Some(End::Low) => "at its lower end: widen --vary",
                Some(End::High) => "at its upper end: widen --vary",
                None => "",
            };
            let value = with_unit(self.best().values[place], &vary.unit);
            vec![vary.key.clone(), value, format!("{}{scale}", vary.range()), remark.to_owned()]
        };
        let rows = self.request.vary.iter().enumerate().map(row).collect();
        table(["key", "value", "looked for in", ""], rows)
    }

    /// The constraints with their margins; no rows where there are none or every run failed.
    pub fn constraints(&self) -> Table {
        let row = |((place, of), value): ((usize, &Constraint), &f64)| {
            let state = match self.state(place, *value) {
                (false, _) => "broken",
                (true, true) => "active",
                (true, false) => "",
            };
            let (found, margin) = (of.in_unit(*value), of.margin(*value));
            vec![of.to_string(), with_unit(found, &of.unit), with_unit(margin, of.unit_of_margin()), state.to_owned()]
        };
        let rows = self.request.constraints.iter().enumerate().zip(self.numbers()).map(row).collect();
        table(["constraint", "value", "margin", ""], rows)
    }

    /// The objective and how the search went, in sentences.
    pub fn sentences(&self) -> Vec<String> {
        let mut words = Vec::new();
        let goal = match self.request.goal {
            Goal::Minimize => "Least",
            Goal::Maximize => "Greatest",
        };
        if let Some((value, unit)) = self.objective() {
            let name = &self.request.objective;
            let value = format!("{name} = {}", units().for_name(name).quantity(value, unit));
            words.push(if self.best().is_feasible() {
                format!("{goal} {value}.")
            } else {
                format!("No point meets every constraint. The one that breaks them the least has {value}.")
            });
        }
        let failures = self.failures();
        let failed: usize = failures.values().sum();
        let feasible = self.points.iter().filter(|point| point.is_feasible()).count();
        let runs = |count: usize| format!("{count} {}", if count == 1 { "run" } else { "runs" });
        let mut search = format!("{}, of which {feasible} met every constraint", runs(self.points.len()));
        if failed > 0 {
            search.push_str(&format!(" and {failed} failed and counted as infeasible"));
        }
        let local = if self.best().is_feasible() { " A local optimum: there may be a better one." } else { "" };
        let spent = match (self.interrupted, self.is_converged) {
            (true, _) => " The search was interrupted: these are the best values so far.",
            (false, true) => "",
            (false, false) => " The evaluations are used up: give more --evaluations for a closer optimum.",
        };
        let local = if self.interrupted { "" } else { local };
        words.push(format!("{search}.{local}{spent}"));
        for (reason, count) in failures {
            words.push(format!("{}: {reason}", runs(count)));
        }
        words
    }

    /// Why runs failed, and how many for each reason.
    fn failures(&self) -> BTreeMap<String, usize> {
        let mut failures = BTreeMap::new();
        for reason in self.points.iter().filter_map(|point| point.numbers.as_ref().err()) {
            *failures.entry(alike(reason)).or_insert(0) += 1;
        }
        failures
    }

    /// That something meets the constraints.
    ///
    /// # Errors
    /// [`Failure::stopped`] with the constraint that is broken most at the best point, and what to do.
    pub fn verdict(&self) -> Result<(), Failure> {
        if self.best().is_feasible() {
            return Ok(());
        }
        let part = |(place, value): (usize, &f64)| self.request.constraints[place].excess(*value) / self.scales[place];
        let parts = self.numbers().iter().enumerate().map(|of| (part(of), of));
        let Some((_, (place, value))) = parts.max_by(|(one, _), (other, _)| one.total_cmp(other)) else {
            return Err(Failure::stopped("no run within --vary came to its end: change the ranges"));
        };
        let of = &self.request.constraints[place];
        Err(Failure::stopped(format!(
            "no values within --vary meet every constraint: at best {} = {}, not {} {}; widen --vary, ease this constraint, or give \
             more --evaluations",
            of.name,
            with_unit(of.in_unit(*value), &of.unit),
            of.relation.sign(),
            of.limit(),
        )))
    }

    /// The scenario file with the settings and the values found in it; the rest of it as it stands, comments too.
    pub fn scenario(&self) -> String {
        let Some(mut written) = Written::of(self.document.source().text()) else { return self.document.to_toml() };
        for (key, value) in &self.request.settings {
            written.set(key, value);
        }
        for (vary, value) in self.request.vary.iter().zip(&self.best().values) {
            written.set(&vary.key, &vary.toml(*value));
        }
        written.text()
    }

    /// The search as a figure: over one key, over two, or over the runs.
    pub fn figure(&self) -> Figure {
        chart::figure(self)
    }

    /// All of it as one JSON object with a line end after it: values and constraints in the units of the request, the
    /// objective in SI.
    pub fn json(&self) -> String {
        let end = |place: usize| match self.end(place) {
            Some(End::Low) => json!("low"),
            Some(End::High) => json!("high"),
            None => Value::Null,
        };
        let value = |(place, vary): (usize, &Vary)| {
            json!({
                "key": vary.key,
                "value": self.best().values[place],
                "unit": vary.unit,
                "low": vary.ends[0],
                "high": vary.ends[1],
                "scale": if vary.is_logarithmic() { "logarithmic" } else { "linear" },
                "at_end": end(place),
            })
        };
        let constraint = |(place, of): (usize, &Constraint)| {
            let value = self.numbers().get(place).copied();
            let state = value.map(|value| self.state(place, value));
            json!({
                "name": of.name,
                "relation": of.relation.sign(),
                "bound": of.bound,
                "unit": of.unit,
                "value": value.map(|value| of.in_unit(value)),
                "margin": value.map(|value| of.margin(value)),
                "met": state.map(|(met, _)| met),
                "active": state.map(|(met, active)| met && active),
            })
        };
        let goal = match self.request.goal {
            Goal::Minimize => "minimize",
            Goal::Maximize => "maximize",
        };
        let failures = self.failures();
        let whole = json!({
            "scenario": self.document.source().name(),
            "goal": goal,
            "objective": self.request.objective,
            "value": self.objective().map(|(value, _)| value),
            "unit": self.unit,
            "feasible": self.best().is_feasible(),
            "values": self.request.vary.iter().enumerate().map(value).collect::<Vec<_>>(),
            "constraints": self.request.constraints.iter().enumerate().map(constraint).collect::<Vec<_>>(),
            "evaluations": self.points.len(),
            "converged": self.is_converged,
            "interrupted": self.interrupted,
            "warnings": self.warnings.iter().map(|of| json!({ "code": of.code, "part": of.part, "text": of.text })).collect::<Vec<_>>(),
            "failed": failures.values().sum::<usize>(),
            "failures": failures,
        });
        format!("{whole:#}\n")
    }
}

fn table(head: [&str; 4], rows: Vec<Vec<String>>) -> Table {
    Table { caption: String::new(), head: head.map(String::from).to_vec(), rows }
}

/// Four digits and a unit.
fn with_unit(number: f64, unit: &str) -> String {
    let number = plain(&digits(number)).to_owned();
    if unit.is_empty() { number } else { format!("{number} {unit}") }
}

/// A reason without its numbers, so that reasons of one kind are counted together.
fn alike(reason: &str) -> String {
    let mut words = String::new();
    let mut rest = reason;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let is_inside = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let before = rest[..start].chars().next_back().is_some_and(is_inside);
        let is_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | 'e' | '-');
        let end = rest[start..].find(|c| !is_number(c)).map_or(rest.len(), |end| start + end);
        words.push_str(&rest[..start]);
        words.push_str(if before { &rest[start..end] } else { "…" });
        rest = &rest[end..];
    }
    words + rest
}

#[cfg(test)]
mod tests {
    use super::alike;

    #[test]
    fn reasons_that_differ_in_numbers_are_alike() {
        assert_eq!(alike("stopped at t = 0.25 s: 1e-3 m"), alike("stopped at t = 0.5 s: 2 m"));
        assert_eq!(alike("key2 is bad"), "key2 is bad");
    }
}
