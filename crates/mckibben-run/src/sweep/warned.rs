//! The warnings of the runs of a sweep: of how many runs each is, the first of them, and what it says there.
//!
//! They are known of a run from its start and from its samples, as far as these show it: what happens between two samples is not
//! seen. In the metadata of a part they stand as JSON, so that parts that are kept, or computed elsewhere, count too.

use crate::warnings::Warning;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Key of a part's metadata: the warnings of its runs.
pub const WARNINGS: &str = "mckibben.warnings";

/// The runs that warnings of a code are of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warned {
    /// How many runs.
    pub runs: u64,
    /// The first of them.
    pub first: u64,
    /// What its warning says.
    pub text: String,
}

/// Warnings by their codes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WarnedRuns(BTreeMap<String, Warned>);

impl WarnedRuns {
    /// Takes the warnings of a run, each code once.
    pub fn see(&mut self, row: u64, warnings: &[Warning]) {
        for (place, warning) in warnings.iter().enumerate() {
            if warnings[..place].iter().all(|before| before.code != warning.code) {
                self.add(warning.code, &Warned { runs: 1, first: row, text: warning.to_string() });
            }
        }
    }

    /// Takes those of other runs.
    pub fn add_all(&mut self, others: &Self) {
        others.0.iter().for_each(|(code, warned)| self.add(code, warned));
    }

    fn add(&mut self, code: &str, new: &Warned) {
        match self.0.get_mut(code) {
            None => {
                self.0.insert(code.to_owned(), new.clone());
            }
            Some(known) => {
                known.runs += new.runs;
                if new.first < known.first {
                    (known.first, known.text) = (new.first, new.text.clone());
                }
            }
        }
    }

    /// The codes, each with its runs.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Warned)> {
        self.0.iter().map(|(code, warned)| (code.as_str(), warned))
    }

    /// As it stands in the metadata of a part.
    pub(super) fn to_json(&self) -> String {
        let object = |(code, of): (&String, &Warned)| {
            (code.clone(), json!({ "runs": of.runs, "first": of.first, "text": of.text }))
        };
        Value::Object(self.0.iter().map(object).collect::<Map<_, _>>()).to_string()
    }

    /// From the metadata of a part; none where it is no such text.
    pub(super) fn from_json(text: &str) -> Option<Self> {
        let whole: Map<String, Value> = serde_json::from_str(text).ok()?;
        let warned = |of: &Value| {
            let text = of["text"].as_str()?.to_owned();
            Some(Warned { runs: of["runs"].as_u64()?, first: of["first"].as_u64()?, text })
        };
        whole.iter().map(|(code, of)| Some((code.clone(), warned(of)?))).collect::<Option<_>>().map(Self)
    }
}

/// The codes of the warnings of a run, each once, for its line of the table.
pub(super) fn codes(warnings: &[Warning]) -> String {
    let mut codes: Vec<&str> = warnings.iter().map(|warning| warning.code).collect();
    codes.sort_unstable();
    codes.dedup();
    codes.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_counted_once_for_a_run_and_come_back_from_json() {
        let of = |code, part: &str| Warning { code, part: part.to_owned(), text: format!("\"{code}\" of {part}") };
        let (mut all, mut late, mut early) = (WarnedRuns::default(), WarnedRuns::default(), WarnedRuns::default());
        late.see(7, &[of("thrown", "a"), of("thrown", "b"), of("pressure", "a")]);
        late.see(9, &[of("thrown", "c")]);
        early.see(2, &[of("thrown", "d")]);
        all.add_all(&late);
        all.add_all(&early);
        let found: Vec<_> = all.iter().map(|(code, of)| (code, of.runs, of.first, of.text.as_str())).collect();
        assert_eq!(found, [("pressure", 1, 7, "a: \"pressure\" of a"), ("thrown", 3, 2, "d: \"thrown\" of d")]);
        assert_eq!(WarnedRuns::from_json(&all.to_json()), Some(all));
        assert_eq!(WarnedRuns::from_json("{}"), Some(WarnedRuns::default()));
        assert_eq!(WarnedRuns::from_json("{\"thrown\": 1}"), None);
        assert_eq!(codes(&[of("thrown", "a"), of("pressure", ""), of("thrown", "b")]), "pressure, thrown");
    }
}
