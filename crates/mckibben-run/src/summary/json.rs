//! What a run came to, as one JSON object for programs.
//!
//! | key | value |
//! |---|---|
//! | `scenario` | the name of the scenario file |
//! | `duration_s` | simulated time |
//! | `numbers` | the numbers of the summary in SI; each key ends with its unit, as a column of a sweep does: `length_final_m` |
//! | `events` | how many events of each kind there were |
//! | `settled` | with `--settle` an object with `settled`, `period_s`, `periods`, `guesses` and `numbers`, each column's mean, ripple, least and greatest value over a period; null without |
//! | `warnings` | a list of objects with `code`, `part` (empty where there is one actuator) and `text` |
//! | `assumed` | a list of objects with `key`, `value`, `source` and `preset`, null where it is a default |
//!
//! Nothing in it depends on the machine: equal runs have equal bytes.

use super::Summary;
use crate::failure::Failure;
use crate::settle::Settled;
use crate::warnings::Warning;
use mckibben_scenario::sweep::column_of;
use mckibben_scenario::{Document, Run};
use serde_json::{Map, Value, json};

impl Summary {
    /// The summary of a run of a document with its warnings, as JSON with a line end after it.
    ///
    /// # Errors
    /// [`Failure::stopped`] for a number that is not finite.
    pub fn json(
        &self,
        document: &Document,
        plan: &Run,
        settled: Option<&Settled>,
        warnings: &[Warning],
    ) -> Result<String, Failure> {
        let mut numbers = Map::new();
        self.check()?;
        for number in &self.numbers {
            numbers.insert(column_of(&number.name, number.unit), json!(number.value));
        }
        let events: Map<String, Value> =
            self.events.iter().map(|(kind, count)| ((*kind).to_owned(), json!(count))).collect();
        let warning = |of: &Warning| json!({ "code": of.code, "part": of.part, "text": of.text });
        let assumed = document
            .assumed()
            .into_iter()
            .map(|of| json!({ "key": of.parameter.key, "value": of.text, "source": of.source, "preset": of.preset }));
        let whole = json!({
            "scenario": document.source().name(),
            "duration_s": plan.duration,
            "numbers": numbers,
            "events": events,
            "settled": settled.map(orbit),
            "warnings": warnings.iter().map(warning).collect::<Vec<_>>(),
            "assumed": assumed.collect::<Vec<_>>(),
        });
        // A tree of words and finite numbers has nothing that could not be written.
        Ok(format!("{whole:#}\n"))
    }
}

/// What repeats on the orbit.
fn orbit(of: &Settled) -> Value {
    let mut numbers = Map::new();
    for row in &of.rows {
        for (statistic, value) in
            [("mean", row.mean), ("ripple", row.ripple()), ("min", row.least), ("max", row.greatest)]
        {
            numbers.insert(column_of(&format!("{}.{statistic}", row.name), &row.unit), json!(value));
        }
    }
    json!({
        "settled": of.orbit.settled,
        "period_s": of.orbit.period,
        "periods": of.orbit.periods,
        "guesses": of.orbit.guesses,
        "numbers": numbers,
    })
}
