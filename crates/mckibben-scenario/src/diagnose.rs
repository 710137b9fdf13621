//! Locates an error of the core in the scenario file.
//!
//! The core names the parameter at fault by its scenario key. The place is the value at that key; where the file does
//! not give it, the description of a muscle at rest that it follows from, else the preset that did, else the section it
//! belongs to, else the file. The other side of a contradiction
//! is located too when the file gives it. Two faults are reported in the words of the file, since their keys are not those that the
//! core checks: a braid whose angle at rest is too large, and frequencies without a common period.

use crate::diagnostic::{Class, Diagnostic, Place};
use crate::document::{Document, Value};
use crate::keys;
use crate::muscle;
use crate::quantity;
use mckibben::limit::Limit;
use mckibben::parameter::{self as p, DURATION, MAX_COUNT, Parameter};
use mckibben::{Count, Error};

impl Document {
    /// The diagnostic of an error that the core returned for values of this document.
    pub fn diagnose(&self, error: &Error) -> Diagnostic {
        match error {
            Error::OutOfRange { parameter, value } => {
                let value = self.in_words(parameter.key, *value, parameter.unit, parameter.key);
                let title = format!("`{}` = {value} is out of range", parameter.key);
                let label = format!("must be {} {}", parameter.range, parameter.unit);
                self.shown(Class::OutOfRange, parameter.key, None, title, label.trim_end().to_owned())
                    .help(parameter.remedy)
            }
            Error::TooMany { parameter, value, count, counted, remedy } => {
                let value = self.in_words(parameter.key, *value, parameter.unit, parameter.key);
                let title = format!("`{}` = {value} makes {} {counted}", parameter.key, Count(*count));
                let label = format!("a run may have {} {counted}", Count(MAX_COUNT));
                let length = self.given(DURATION.key, parameter.key).filter(|_| self.entry(parameter.key).is_some());
                self.shown(Class::OutOfRange, parameter.key, None, title, label)
                    .related(length, "the run's duration")
                    .help(*remedy)
            }
            Error::Inconsistent { parameter, .. }
                if parameter.key == p::MAX_LENGTH.key && self.angle_at_greatest_length().is_some() =>
            {
                self.pushes()
            }
            Error::Inconsistent { parameter, value: number, requirement, remedy } => {
                let mut bound = self.in_words(requirement.other, requirement.value, requirement.unit, parameter.key);
                let mut value = self.in_words(parameter.key, *number, parameter.unit, requirement.other);
                // Numbers that differ by less than the digits that are shown have all of theirs.
                if value == bound {
                    bound = quantity::format(requirement.value, requirement.unit);
                    value = quantity::format(*number, parameter.unit);
                }
                let other = format!("{} = {bound}", requirement.other);
                let label = format!("{} {other}", requirement.relation);
                // A relation may begin with what it holds for, as in "on a tendon must be at least".
                let (holds_for, must) = requirement.relation.split_at(requirement.relation.find("must").unwrap_or(0));
                if let Some((key, place)) =
                    self.length_follows_from().filter(|_| parameter.key == p::INITIAL_LENGTH.key)
                {
                    let value = self.in_words(key, *number, parameter.unit, key);
                    let title = format!("an actuator starts {value} long, and {holds_for}this {must} {other}");
                    return Diagnostic::at(
                        Class::Inconsistent,
                        place,
                        title,
                        format!("its length at the start {label}"),
                    )
                    .related(self.given(requirement.other, parameter.key), "the other value")
                    .help(*remedy);
                }
                let title =
                    format!("`{}` = {value} contradicts the rule that {holds_for}it {must} {other}", parameter.key);
                self.shown(Class::Inconsistent, parameter.key, None, title, label)
                    .related(self.given(requirement.other, parameter.key), "the other value")
                    .help(self.remedy_of(parameter, requirement.other, remedy))
            }
            Error::Table { name, problem, entry, remedy } => {
                if let Some([given, pressures, lengths]) = self.tensions(name).filter(|[given, p, l]| *given != p * l) {
                    let due = pressures * lengths;
                    let title = format!("`{name}` has {given} entries, and {due} are due");
                    let label = format!("{pressures} pressures times {lengths} lengths are {due}");
                    return self.shown(Class::BadList, name, None, title, label).help(*remedy);
                }
                let title = format!("`{name}`: {problem}");
                let label = format!("entry {entry}: {problem}");
                self.shown(Class::BadList, name, entry.checked_sub(1), title, label).help(*remedy)
            }
            Error::NotImplemented(limit) if **limit == mckibben::limit::COMMON_PERIOD => self.periods(limit),
            Error::NotImplemented(limit) => {
                Diagnostic::whole(Class::NotImplemented, self.source().name(), limit.title().to_string())
                    .help(limit.remedy)
            }
            Error::NoSolution { what, remedy } => {
                Diagnostic::whole(Class::NoSolution, self.source().name(), *what).help(*remedy)
            }
            Error::Misuse { what, remedy } => {
                Diagnostic::whole(Class::NotApplicable, self.source().name(), *what).help(*remedy)
            }
            Error::Stopped { remedy, .. } => {
                // The remedy is printed as help and need not stand in the title as well.
                let text = error.to_string();
                let title = text.strip_suffix(&format!("; {remedy}")).unwrap_or(&text);
                Diagnostic::whole(Class::Stopped, self.source().name(), title).help(*remedy)
            }
            other => Diagnostic::whole(Class::Stopped, self.source().name(), other.to_string()),
        }
    }

    /// The key and the place of what says how long an actuator is at the start, where the file gives no `initial.length`.
    fn length_follows_from(&self) -> Option<(&'static str, Place)> {
        let of = |key: &'static str| Some((key, self.entry(key)?.node.place.clone()));
        let found = [keys::REST_LENGTH.key, p::REST_LENGTH.key].into_iter().find_map(of);
        found.filter(|_| self.entry(p::INITIAL_LENGTH.key).is_none())
    }

    /// The remedy of a contradiction, where another one than that of the core fits the file: a start that a wall or fittings bound,
    /// not the thread; a braid that the file describes at rest.
    fn remedy_of(&self, parameter: &Parameter, other: &str, remedy: &str) -> String {
        if parameter.key == p::INITIAL_LENGTH.key && other != p::THREAD_LENGTH.key {
            return remedy.replace("between 0 and the thread length", "between 0 and this limit");
        }
        if self.stated_braid().is_at_rest() {
            return remedy.replace("a shorter max_length or fewer turns", "a larger diameter of the muscle at rest");
        }
        remedy.to_owned()
    }

    /// A number in a unit of SI as the file writes it at its key. One that the file does not write is rounded, in the unit at that key or
    /// else at another.
    fn in_words(&self, key: &str, value: f64, unit: &str, another: &str) -> String {
        let written = [key, another].map(|key| match &self.entry(key)?.node.value {
            Value::String(text) => Some((text.trim(), quantity::parse(text).ok()?)),
            _ => None,
        });
        let is = |number: f64, value: f64| (number - value).abs() <= ROUNDING * value.abs();
        if let Some((text, _)) = written[0].as_ref().filter(|(_, read)| is(read.value, value)) {
            return (*text).to_owned();
        }
        let dimension = quantity::parse_unit(unit).map(|of| of.0);
        for (text, read) in written.into_iter().flatten() {
            // Where the number times the unit is not the value, the unit has a zero that is its own.
            let Some((number, name)) = text.split_once(' ') else { continue };
            let Ok((its, size)) = quantity::parse_unit(name.trim()) else { continue };
            let is_plain = number.parse().is_ok_and(|number: f64| is(number * size, read.value));
            if is_plain && dimension.as_ref().is_ok_and(|dimension| *dimension == its) {
                return quantity::format(rounded(value / size), name.trim());
            }
        }
        quantity::format(rounded(value), unit)
    }

    /// How many entries the tensions of a force map, its pressures and its lengths have; none where `name` is no such list.
    fn tensions(&self, name: &str) -> Option<[usize; 3]> {
        let count = |row: &Parameter| match &self.entry(row.key)?.node.value {
            Value::List(items) => Some(items.len()),
            _ => None,
        };
        let is_map = name == p::MAP_TENSION.key;
        is_map.then(|| Some([count(&p::MAP_TENSION)?, count(&p::MAP_PRESSURE)?, count(&p::MAP_LENGTH)?]))?
    }

    /// The braid angle in rad at the greatest length, where that is the length at rest since nothing else states it.
    fn angle_at_greatest_length(&self) -> Option<f64> {
        let stated = self.stated_braid();
        let follows = stated.is_at_rest() && stated.get(&p::MAX_LENGTH).is_none();
        stated.muscle().ok().filter(|_| follows).map(|muscle| muscle.braid_angle)
    }

    /// A braid whose angle at rest is above that at which it pushes, in the unit in which the file gives the angle.
    fn pushes(&self) -> Diagnostic {
        let (key, neutral) = (p::BRAID_ANGLE.key, 2_f64.sqrt().atan());
        let angle = self.angle_at_greatest_length().unwrap_or(neutral);
        let written = self.entry(key).map(|entry| entry.node.place.text().trim_matches(['"', '\'']).to_owned());
        let (size, unit) = match &written {
            Some(text) if text.contains("rad") || !text.contains(|c: char| c.is_alphabetic() || c == '°') => {
                (1.0, "rad")
            }
            _ => (1_f64.to_degrees(), "deg"),
        };
        let title = match written {
            Some(text) => format!("`{key}` = {text} is out of range for a muscle at its greatest length"),
            None => format!("the braid angle at rest that follows, {:.4} {unit}, is out of range", angle * size),
        };
        let label = format!(
            "must be greater than 0 {unit} and less than {:.3} {unit}; `{}` follows from the muscle at rest",
            neutral * size,
            p::MAX_LENGTH.key
        );
        self.shown(Class::Inconsistent, key, None, title, label).help(format!(
            "give an angle such as {:.3} {unit}: above {:.3} {unit} a braid pushes, and no muscle pulls; give `{}` too if \
             the muscle at rest is shorter than its greatest length",
            25_f64.to_radians() * size,
            neutral * size,
            p::MAX_LENGTH.key
        ))
    }

    /// Pulses and sinusoids without a common period: each with its key and its period.
    fn periods(&self, limit: &Limit) -> Diagnostic {
        let is_one = |key: &str| FREQUENCIES.iter().any(|row| row.key == key) || key == keys::MOTION_FREQUENCY.key;
        let mut found = self.quantities(is_one);
        found.retain(|(_, _, frequency)| *frequency > 0.0);
        found.sort_by(|a, b| b.2.total_cmp(&a.2));
        found.dedup_by(|a, b| a.2 == b.2);
        let title = limit.title().to_string();
        let [(fastest, first, most), others @ ..] = found.as_slice() else {
            return Diagnostic::whole(Class::NotImplemented, self.source().name(), title).help(limit.remedy);
        };
        let label = |key: &str, frequency: f64| format!("`{key}` has a period of {}", period(frequency));
        let shown = Diagnostic::at(Class::NotImplemented, first.place.clone(), title, label(fastest, *most));
        let shown = others.iter().fold(shown, |shown, (key, node, frequency)| {
            shown.related(Some(node.place.clone()), label(key, *frequency))
        });
        match others {
            // Whole pulses of the fastest in each period of the other.
            [(other, _, frequency)] if most / frequency <= 1000.0 => {
                let count = (most / frequency).round();
                let near = quantity::format(most / count, "Hz");
                shown.help(format!(
                    "change one of them: with `{other}` = \"{near}\" its period is {count} of those of `{fastest}`"
                ))
            }
            _ => shown.help(limit.remedy),
        }
    }

    /// A diagnostic at the best place for a key.
    fn shown(&self, class: Class, key: &str, entry: Option<usize>, title: String, label: String) -> Diagnostic {
        let section = key.rsplit_once('.').map_or(key, |(section, _)| section);
        let root = key.split('.').next().unwrap_or(key);
        if let Some(found) = self.entry(key) {
            let item = match (&found.node.value, entry) {
                (Value::List(items), Some(at)) => items.get(at),
                _ => None,
            };
            return Diagnostic::at(class, item.unwrap_or(&found.node).place.clone(), title, label);
        }
        if muscle::BRAID.iter().any(|row| row.key == key) || [p::MAX_LENGTH.key, p::MIN_LENGTH.key].contains(&key) {
            // The angle is what most such rules are about.
            if let Some(rest) = muscle::AT_REST.iter().rev().find_map(|row| self.entry(row.key)) {
                let label = format!("{label}; `{key}` follows from the muscle at rest");
                return Diagnostic::at(class, rest.node.place.clone(), title, label);
            }
        }
        if let Some(preset) = self.entry(&format!("{root}.preset")) {
            return Diagnostic::at(
                class,
                preset.node.place.clone(),
                title,
                format!("{label}; the preset gives `{key}`"),
            );
        }
        match self.place(section).or_else(|| self.place(root)) {
            Some(place) => Diagnostic::at(class, place.clone(), title, format!("{label}; `{key}` is not given here")),
            None => Diagnostic::whole(class, self.source().name(), title),
        }
    }

    /// The value of the other quantity of a contradiction: a key, or the name of one in any section.
    fn given(&self, name: &str, beside: &str) -> Option<Place> {
        let section = beside.rsplit_once('.').map_or("", |(section, _)| section);
        let near = format!("{section}.{name}");
        let by_name = || keys::KEYS.iter().find(|key| key.name() == name).map(|key| key.path);
        let entry = self.entry(name).or_else(|| self.entry(&near)).or_else(|| self.entry(by_name()?))?;
        Some(entry.node.place.clone())
    }
}

/// Digits of a number in a message that no file has.
const DIGITS: usize = 6;
/// Part of a number that is rounding of its unit.
const ROUNDING: f64 = 1e-12;

/// A number in the digits of a message.
pub(crate) fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

/// Keys of the frequencies of pulses and given sinusoids.
static FREQUENCIES: [&Parameter; 3] = [&p::PWM_FREQUENCY, &p::MOTION_FREQUENCY, &p::SET_FREQUENCY];

/// The period of a frequency in Hz, in four digits.
fn period(frequency: f64) -> String {
    let (size, unit) = if frequency > 1.0 { (1e3, "ms") } else { (1.0, "s") };
    let rounded: f64 = format!("{:.3e}", size / frequency).parse().unwrap_or(f64::NAN);
    format!("{rounded} {unit}")
}
