//! A scenario with values of its keys set, run, as numbers with names.
//!
//! The numbers are those of the [summary](crate::summary), and with a search for the orbit behind the run also those of
//! [`Settled`](crate::settle::Settled): `settled.length.mean`, `settled.length.ripple`, `settled.length.min`, `settled.length.max`.

use super::constraint::Constraint;
use super::vary::Vary;
use super::written::Written;
use crate::failure::Failure;
use crate::run::Ready;
use crate::settle::End;
use crate::warnings::{Warning, of_run};
use mckibben_scenario::Document;

/// What the names of the numbers of an orbit begin with.
pub(super) const SETTLED: &str = "settled.";

/// A number with its name.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Named {
    pub name: String,
    /// Its unit in SI; empty for a pure number.
    pub unit: String,
    pub value: f64,
}

/// Runs a scenario with values of its keys set.
#[derive(Debug)]
pub(super) struct Evaluator {
    document: Document,
    vary: Vec<Vary>,
    settle: bool,
    /// The numbers that are looked at, the objective first; none before they are known.
    names: Vec<String>,
}

impl Evaluator {
    /// Of a document in which everything else is set.
    ///
    /// # Errors
    /// [`Failure::input`] for a place in a list that the document does not have.
    pub(super) fn new(document: &Document, vary: &[Vary], settle: bool) -> Result<Self, Failure> {
        let written = Written::of(document.to_toml().as_str());
        let is_there = |vary: &Vary| {
            let Some((list, place)) = vary.entry() else { return Ok(()) };
            let entries = written.as_ref().and_then(|written| written.entries(list)).unwrap_or_default();
            if place < entries.len() {
                return Ok(());
            }
            let title = format!("--vary: there is no `{}`", vary.key);
            let help = format!("the scenario gives `{list}` {} entries, counted from 0", entries.len());
            Err(Failure::input(title, help))
        };
        vary.iter().try_for_each(is_there)?;
        Ok(Self { document: document.clone(), vary: vary.to_vec(), settle, names: Vec::new() })
    }

    /// Looks at the objective and at what the constraints bound, and at nothing else from now on.
    pub(super) fn want(&mut self, objective: String, constraints: &[Constraint]) {
        self.names = [objective].into_iter().chain(constraints.iter().map(|of| of.name.clone())).collect();
    }

    /// The numbers of a run with these values, in the units of their keys.
    pub(super) fn numbers(&self, values: &[f64]) -> Result<Vec<Named>, Failure> {
        let document = self.document(values)?;
        let end = if self.settle { End::Orbit } else { End::Duration };
        let (figures, settled) = Ready::of(&document)?.stream(&document, None, end)?;
        let named = |of: crate::summary::Number| Named { name: of.name, unit: of.unit.into(), value: of.value };
        let mut numbers: Vec<Named> = figures.summary().numbers.into_iter().map(named).collect();
        if let Some(settled) = settled {
            // Where a run does not settle there are no rows.
            for row in settled.rows {
                let statistics =
                    [("mean", row.mean), ("ripple", row.ripple()), ("min", row.least), ("max", row.greatest)];
                numbers.extend(statistics.map(|(statistic, value)| Named {
                    name: format!("{SETTLED}{}.{statistic}", row.name),
                    unit: row.unit.clone(),
                    value,
                }));
            }
        }
        Ok(numbers)
    }

    /// The warnings of the run of a document; none where it fails, which its numbers say.
    pub(super) fn warnings(&self, document: &Document) -> Vec<Warning> {
        let run = || {
            let ready = Ready::of(document)?;
            let before = ready.warnings();
            let (figures, _) = ready.stream(document, None, End::Duration)?;
            Ok::<_, Failure>(of_run(before, &figures))
        };
        run().unwrap_or_default()
    }

    /// The values of what is looked at; in words what there is no number of.
    pub(super) fn wanted(&self, numbers: &[Named]) -> Result<Vec<f64>, String> {
        let value = |name: &String| match numbers.iter().find(|number| number.name == *name) {
            Some(number) if number.value.is_finite() => Ok(number.value),
            Some(number) => Err(format!("{name} = {} is not finite", number.value)),
            None if name.starts_with(SETTLED) || name.starts_with("length.") => {
                Err(format!("the run has not settled, and so has no {name}"))
            }
            None => Err(format!("the run has no {name}")),
        };
        self.names.iter().map(value).collect()
    }

    /// The document with these values set.
    pub(super) fn document(&self, values: &[f64]) -> Result<Document, Failure> {
        let mut document = self.document.clone();
        for (vary, value) in self.vary.iter().zip(values) {
            document.set_text_from("--vary", &vary.key, &vary.toml(*value))?;
        }
        Ok(document)
    }
}
