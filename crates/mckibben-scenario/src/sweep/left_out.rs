//! Keys that rows leave out: a word that varies may leave other keys without a meaning.
//!
//! Checked by `tests/sweep.rs`.

use super::axis::Values;
use super::vary::{self, Varied};
use crate::document::Document;
use crate::keys::{self, Key};
use std::fmt;

/// A key that rows leave out: it has no meaning under a word of another key, and has one under another of its words.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct LeftOut {
    /// Path of the key.
    pub key: String,
    /// Path of the key that varies.
    pub chooses: String,
    /// Its word in these rows.
    pub word: String,
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} in rows with {} = {}", self.key, self.chooses, self.word)
    }
}

impl LeftOut {
    /// Takes the key out of the document of a row, if the row has the word.
    pub(super) fn leave_out(&self, document: &mut Document) {
        if document.is_word(&self.chooses, &self.word) {
            document.remove(&self.key);
        }
    }
}

/// What rows of a document leave out.
pub(super) fn of(document: &Document, varied: &[Varied<'_>]) -> Vec<LeftOut> {
    let whole = vary::first(document, varied);
    let mut all: Vec<LeftOut> = varied.iter().flat_map(Varied::idle).collect();
    all.retain(|of| whole.contains(&of.key));
    all
}

impl Varied<'_> {
    /// The keys that have no meaning under one of its words and have one under another.
    fn idle(&self) -> Vec<LeftOut> {
        let Values::Words(words) = &self.values else { return Vec::new() };
        // `actuators.flexor.force.law` stands for `actuator.force.law`: so do the keys that hang on it.
        let segments = |path: &str| path.split('.').map(str::to_owned).collect::<Vec<_>>();
        let (own, row) = (segments(&self.path), segments(self.row.path));
        let common = own.iter().rev().zip(row.iter().rev()).take_while(|(one, other)| one == other).count();
        let (own, row) = (&own[..own.len() - common], &row[..row.len() - common]);
        let path_of = |key: &Key| {
            let key = segments(key.path);
            key.starts_with(row).then(|| [own, &key[row.len()..]].concat().join("."))
        };
        let mut idle = Vec::new();
        for key in keys::all_keys() {
            let Some(when) = key.when.filter(|when| when.key == self.row.path) else { continue };
            let applies = |word: &String| when.words.contains(&word.as_str());
            let Some(path) = path_of(key).filter(|_| words.iter().any(applies)) else { continue };
            let of = |word: &String| LeftOut { key: path.clone(), chooses: self.path.clone(), word: word.clone() };
            idle.extend(words.iter().filter(|word| !applies(word)).map(of));
        }
        idle
    }
}
