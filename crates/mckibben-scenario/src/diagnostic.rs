//! Errors that show the place: file, line, column, the line itself, what is wrong there, and what to do.
//!
//! A reading collects every [`Diagnostic`] it can find, so that a file is mended in one go, and returns them together
//! as [`Diagnostics`]. Each has a class for programs, and a title, a label under the place and help for people:
//!
//! ```text
//! error: `thread_lenght` is not a key of [actuator]
//!  --> muscle.toml:2:1
//!   |
//! 2 | thread_lenght = "4.3 in"
//!   | ^^^^^^^^^^^^^ unknown key
//!   |
//!   = help: did you mean `thread_length`?
//! ```

use crate::keys;
use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A named text that places refer to: a scenario file, or a value set from outside.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Source {
    name: String,
    text: String,
    /// Whether a number where a quantity is due is in SI: so in what a program hands over, never in a file.
    numbers_are_si: bool,
    /// Whether a user sets the value in addition to a file, as by `--set`. It is then meant to reach a part.
    is_setting: bool,
}

impl Source {
    pub(crate) fn new(name: impl Into<String>, text: impl Into<String>) -> Arc<Self> {
        Arc::new(Self { name: name.into(), text: text.into(), numbers_are_si: false, is_setting: false })
    }

    /// The text of values that a program hands over: numbers without a unit are in SI.
    pub(crate) fn in_si(name: impl Into<String>, text: impl Into<String>) -> Arc<Self> {
        Arc::new(Self { name: name.into(), text: text.into(), numbers_are_si: true, is_setting: false })
    }

    /// The text of a value that a user sets in addition to a file.
    pub(crate) fn setting(name: impl Into<String>, text: impl Into<String>) -> Arc<Self> {
        Arc::new(Self { name: name.into(), text: text.into(), numbers_are_si: false, is_setting: true })
    }

    /// Whether a user sets the value in addition to a file.
    pub(crate) fn is_setting(&self) -> bool {
        self.is_setting
    }

    /// Whether a number without a unit is in SI.
    pub(crate) fn numbers_are_si(&self) -> bool {
        self.numbers_are_si
    }

    /// The file's name, or words for where the text comes from.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// Some bytes of a source.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Place {
    source: Arc<Source>,
    span: Range<usize>,
}

impl Place {
    pub(crate) fn new(source: Arc<Source>, span: Range<usize>) -> Self {
        let text = &source.text;
        // Bounds are made safe once, here, so that rendering cannot fail on them.
        let end = (0..=span.end.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
        let start = (0..=span.start.min(end)).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
        Self { source, span: start..end }
    }

    /// Whether the other is the same place in the same text.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.source, &other.source) && self.span == other.span
    }

    /// Other bytes of the same text.
    pub(crate) fn narrowed(&self, span: Range<usize>) -> Self {
        Self::new(self.source.clone(), span)
    }

    /// The text that holds the place.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The bytes of that text.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// The text at the place.
    pub fn text(&self) -> &str {
        self.source.text.get(self.span()).unwrap_or_default()
    }

    /// Line, counted from 1.
    pub fn line(&self) -> usize {
        self.before().matches('\n').count() + 1
    }

    /// Column in characters, counted from 1.
    pub fn column(&self) -> usize {
        self.before().rsplit('\n').next().unwrap_or_default().chars().count() + 1
    }

    fn before(&self) -> &str {
        self.source.text.get(..self.span.start).unwrap_or_default()
    }
}

/// What sort of mistake a diagnostic is about.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
#[non_exhaustive]
pub enum Class {
    /// The file cannot be read.
    Unreadable,
    /// The text is not TOML.
    Syntax,
    /// No such section or key.
    UnknownKey,
    /// A value of another type is due: a section, a string, a number, a list.
    WrongType,
    /// A number stands where a quantity with a unit is due.
    MissingUnit,
    /// A unit stands where a pure number is due.
    UnexpectedUnit,
    /// A quantity cannot be understood: no number, an unknown unit, a wrong grammar.
    BadQuantity,
    /// A quantity of another dimension is due.
    WrongDimension,
    /// The value is outside its range.
    OutOfRange,
    /// Not one of the words that are valid here.
    InvalidChoice,
    /// A required section or key is absent.
    Missing,
    /// Keys exclude each other.
    Conflict,
    /// The key has no meaning under the choices made elsewhere.
    NotApplicable,
    /// Values contradict each other.
    Inconsistent,
    /// A list is unsorted, too short or too long.
    BadList,
    /// What makes sense and is not implemented.
    NotImplemented,
    /// There is no such point: no equilibrium, nothing that holds the load.
    NoSolution,
    /// The simulation could not go on.
    Stopped,
}

/// One mistake, where it is, and what to do about it.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Diagnostic {
    class: Class,
    title: String,
    label: String,
    help: Vec<String>,
    place: Option<Place>,
    file: String,
    related: Vec<(Place, String)>,
}

/// Whether a rendered diagnostic carries terminal colours.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Style {
    /// Text alone.
    #[default]
    Plain,
    /// ANSI colours.
    Coloured,
}

impl Diagnostic {
    /// A mistake at a place.
    pub(crate) fn at(class: Class, place: Place, title: impl Into<String>, label: impl Into<String>) -> Self {
        let file = place.source.name.clone();
        let (title, label) = (title.into(), label.into());
        Self { class, title, label, help: Vec::new(), place: Some(place), file, related: Vec::new() }
    }

    /// A mistake of a whole file.
    pub(crate) fn whole(class: Class, file: impl Into<String>, title: impl Into<String>) -> Self {
        let (file, title) = (file.into(), title.into());
        Self { class, title, label: String::new(), help: Vec::new(), place: None, file, related: Vec::new() }
    }

    /// Adds a line of help.
    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help.push(help.into());
        self
    }

    /// Adds a second place that takes part.
    pub(crate) fn related(mut self, place: Option<Place>, label: impl Into<String>) -> Self {
        self.related.extend(place.map(|place| (place, label.into())));
        self
    }

    /// Renames each path between backticks as `name` has it.
    pub(crate) fn renamed(mut self, name: impl Fn(&str) -> Option<String>) -> Self {
        let texts = [&mut self.title, &mut self.label].into_iter().chain(&mut self.help);
        for text in texts {
            let words = text.split('`').enumerate().map(|(index, word)| match index % 2 {
                1 => name(word).unwrap_or_else(|| word.to_owned()),
                _ => word.to_owned(),
            });
            *text = words.collect::<Vec<_>>().join("`");
        }
        self
    }

    /// Names the keys of `[supply]` as those of a supply that the file names.
    pub(crate) fn of_supply(mut self, name: &str) -> Self {
        let texts = [&mut self.title, &mut self.label].into_iter().chain(&mut self.help);
        let keys: Vec<&str> = keys::KEYS.iter().filter(|key| key.section() == "supply").map(|key| key.path).collect();
        for text in texts {
            for key in &keys {
                // A key that begins as a longer one does is part of that.
                let is_end = |rest: &str| !rest.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
                let mut parts = text.split(key).peekable();
                let mut named = String::new();
                while let Some(part) = parts.next() {
                    named.push_str(part);
                    match parts.peek() {
                        Some(rest) if is_end(rest) => {
                            named.push_str(&format!("supplies.{name}.{}", key.trim_start_matches("supply.")));
                        }
                        Some(_) => named.push_str(key),
                        None => {}
                    }
                }
                *text = named;
            }
        }
        self
    }

    /// What sort of mistake it is.
    pub fn class(&self) -> Class {
        self.class
    }

    /// What is wrong, as one sentence.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// What is said under the place; empty when there is none.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// What to do about it.
    pub fn remedies(&self) -> &[String] {
        &self.help
    }

    /// Where it is, unless it is about a whole file.
    pub fn place(&self) -> Option<&Place> {
        self.place.as_ref()
    }

    /// Name of the file, or of the setting that the text comes from.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Line, counted from 1, unless it is about a whole file.
    pub fn line(&self) -> Option<usize> {
        self.place().map(Place::line)
    }

    /// Column in characters, counted from 1, unless it is about a whole file.
    pub fn column(&self) -> Option<usize> {
        self.place().map(Place::column)
    }

    /// The diagnostic as text for people, without a line end after it.
    pub fn render(&self, style: Style) -> String {
        let mut group = Group::with_title(Level::ERROR.primary_title(self.title.as_str()));
        match &self.place {
            None => group = group.element(Origin::path(self.file.as_str())),
            Some(place) => {
                let mut snippet = Snippet::source(place.source.text.as_str())
                    .path(place.source.name.as_str())
                    .annotation(AnnotationKind::Primary.span(place.span()).label(self.label.as_str()));
                let mut elsewhere = Vec::new();
                for (other, label) in &self.related {
                    let annotation = AnnotationKind::Context.span(other.span()).label(label.as_str());
                    if Arc::ptr_eq(&other.source, &place.source) {
                        snippet = snippet.annotation(annotation);
                    } else {
                        let text = Snippet::source(other.source.text.as_str()).path(other.source.name.as_str());
                        elsewhere.push(text.annotation(annotation));
                    }
                }
                group = group.element(snippet).elements(elsewhere);
            }
        }
        group = group.elements(self.help.iter().map(|help| Level::HELP.message(help.as_str())));
        let renderer = match style {
            Style::Plain => Renderer::plain(),
            Style::Coloured => Renderer::styled(),
        };
        renderer.render(&[group])
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(Style::Plain))
    }
}

impl std::error::Error for Diagnostic {}

/// Every mistake found in one reading, in the order of the file; at least one.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Diagnostics(Vec<Diagnostic>);

impl Diagnostics {
    /// Sorts by place; those without a place come last. Returns `Err` when there are any.
    pub(crate) fn check(mut found: Vec<Diagnostic>) -> Result<(), Self> {
        let order = |d: &Diagnostic| d.place().map_or((usize::MAX, 0), |place| (place.span.start, place.span.end));
        found.sort_by_key(order);
        found.dedup();
        if found.is_empty() { Ok(()) } else { Err(Self(found)) }
    }

    /// Adds a line of help to each.
    pub(crate) fn help(self, help: &str) -> Self {
        Self(self.0.into_iter().map(|diagnostic| diagnostic.help(help)).collect())
    }

    /// The mistakes in the order of the file.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.0.iter()
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// All of them as text, with an empty line between.
    pub fn render(&self, style: Style) -> String {
        self.0.iter().map(|diagnostic| diagnostic.render(style)).collect::<Vec<_>>().join("\n\n")
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(diagnostic: Diagnostic) -> Self {
        Self(vec![diagnostic])
    }
}

impl<'d> IntoIterator for &'d Diagnostics {
    type Item = &'d Diagnostic;
    type IntoIter = std::slice::Iter<'d, Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(Style::Plain))
    }
}

impl std::error::Error for Diagnostics {}
