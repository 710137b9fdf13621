//! Parameters of a plant's file that are given other values, and derivatives with respect to them.
//!
//! ```text
//! y(θ) = run(n(θ))        ∂y/∂θ = Σ_j ∂run/∂n_j · ∂n_j/∂θ
//! ```
//!
//! A file is read again with the values θ put in, as in a sweep, so that whatever a file may say may be a parameter: of one
//! actuator (`actuators.flexor.friction.viscous`), of all (`actuator.friction.viscous`), of a supply, hose, joint or start. The
//! plant's numbers n follow from the file. Their derivatives `∂n/∂θ` are central differences of the reading, which most numbers
//! pass exactly and all to about nine digits, since a reading is smooth and costs no run; `∂run/∂n` is exact, in dual numbers
//! through every event.
//!
//! Checked by `tests/plant.rs` of the identify crate: against differences of runs, for parameters of every section.

use super::PlantExperiment;
use crate::choice::PressurePlace;
use crate::diagnostic::{Class, Diagnostic, Diagnostics, Place as FilePlace, Source};
use crate::document::{Document, Node, Value, list_and_entry};
use crate::keys::{self, ACTUATORS, Kind};
use crate::muscle::BRAID;
use crate::place::{Place, PlaceError};
use crate::quantity;
use crate::read::describes_braid;
use crate::scenario::{PressureSensor, PressureSeries};
use mckibben::parameter::{self as p, Parameter};
use mckibben::plant::{Part, Plant, PlantStart, StartNumber};
use mckibben::{Dual, Error};

/// The relative change of a parameter by which the numbers that follow are differenced.
const STEP: f64 = 1e-5;
/// The change of a parameter that is zero here and in the file, in its SI unit.
const STEP_FROM_ZERO: f64 = 1e-6;

/// A parameter of a plant's file, by its path.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantPlace {
    /// The path, without the entry of a list.
    key: String,
    /// Which entry of a list.
    entry: Option<usize>,
    parameter: &'static Parameter,
    /// The value in the file.
    value: f64,
}

/// What a number of a plant is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Label {
    Plant(Option<Part>, &'static str),
    Start(StartNumber),
}

/// A plant and its start over a scalar.
pub type PlantOver<S> = (Plant<S>, PlantStart<S>);

/// A plant's file with other values of some parameters, read.
#[derive(Clone, Debug)]
pub struct AdjustedPlant {
    document: Document,
    places: Vec<PlantPlace>,
    values: Vec<f64>,
    experiment: PlantExperiment,
}

impl PlantPlace {
    /// Its path.
    pub fn path(&self) -> String {
        match self.entry {
            Some(entry) => format!("{}[{entry}]", self.key),
            None => self.key.clone(),
        }
    }

    /// Its row in the table of parameters.
    pub fn parameter(&self) -> &'static Parameter {
        self.parameter
    }

    /// The value in the file, in SI.
    pub fn value(&self) -> f64 {
        self.value
    }
}

impl Document {
    /// The parameter at a path of a plant's file, such as `actuators.flexor.friction.viscous`; what stands at the top of the
    /// file is one parameter of all parts that have no other.
    ///
    /// # Errors
    /// When there is no such key or part, when it is no number, or when the file gives it no value.
    pub fn find_in_plant(&self, path: &str) -> Result<PlantPlace, PlaceError> {
        let fault = |why: &str, remedy: String| PlaceError::new(path, why, remedy);
        let (key, entry) = match list_and_entry(path) {
            Some((key, digits)) => {
                let entry = digits.parse::<usize>();
                (
                    key,
                    Some(
                        entry
                            .map_err(|_| fault("names no entry of its list", "count from 0, as in `[0]`".to_owned()))?,
                    ),
                )
            }
            None => (path, None),
        };
        if let Some(unknown) = self.nameless(key, &FilePlace::new(Source::new("[fit]", path), 0..path.len())) {
            let remedy = unknown.remedies().first().cloned().unwrap_or_default();
            return Err(fault("names a part that the file does not have", remedy));
        }
        let row = keys::key_at(&keys::stands_for(key));
        let kind = row.map(|row| row.kind);
        let parameter = match (kind, entry) {
            (Some(Kind::Quantity(row) | Kind::QuantityOr(row, _)), None) => row,
            (Some(Kind::Quantities(row) | Kind::TimeSeries(row)), Some(_)) => row,
            (Some(Kind::Quantities(_)), None) => {
                return Err(fault("is a list", format!("name one of its entries, as in `{key}[0]`")));
            }
            (Some(Kind::TimeSeries(row)), None) => row,
            (Some(Kind::Quantity(_) | Kind::QuantityOr(..)), Some(_)) => {
                return Err(fault("is no list", format!("write `{key}`")));
            }
            (Some(_), _) => {
                let remedy = "name a quantity of an actuator, a supply, a mechanism or a valve".to_owned();
                return Err(fault("is no quantity", remedy));
            }
            (None, _) => {
                let remedy = match key.split('.').next() {
                    Some(first) if self.contains(&format!("{ACTUATORS}.{first}")) => {
                        format!("did you mean `{ACTUATORS}.{path}`?")
                    }
                    _ => "write it as `--set` takes it, such as `actuators.NAME.friction.viscous`".to_owned(),
                };
                return Err(fault("is no key of a plant", remedy));
            }
        };
        if self.braid_follows_without(key, parameter) {
            let remedy = "name a key that the file gives, and leave no more in it than describe the braid".to_owned();
            return Err(fault("follows from what else the file gives of the braid", remedy));
        }
        match self.value_in_plant(key, entry, parameter) {
            Some(value) => Ok(PlantPlace { key: key.to_owned(), entry, parameter, value }),
            None => Err(fault("has no value in the file to begin with", "write it there".to_owned())),
        }
    }

    /// Gives the pressure over time of one actuator of a plant, or at the end of its hose, in place of its valve and what belongs to
    /// that. Behind a hose it starts at the gauge pressure `first` in Pa, if there is one, else where the file says.
    ///
    /// # Errors
    /// When the file has something there that is no section.
    pub fn give_pressure(
        &mut self,
        actuator: &str,
        series: &PressureSeries,
        first: Option<f64>,
    ) -> Result<(), Diagnostics> {
        let of_muscle = ["hose", p::INITIAL_GAUGE_PRESSURE.key];
        let also: &[&str] = if series.at == PressurePlace::Muscle { &of_muscle } else { &[] };
        for section in ["valve", "command", "controller", "supply", "pressure"].iter().chain(also) {
            self.remove(&format!("{ACTUATORS}.{actuator}.{section}"));
        }
        let said = |number: f64, row: &Parameter| match row.unit {
            "" => number.to_string(),
            unit => format!("\"{}\"", quantity::format(number, unit)),
        };
        let mut give = |key: &str, text: &str| {
            self.set_text_from("the measured pressure", &format!("{ACTUATORS}.{actuator}.{key}"), text)
        };
        for (row, numbers) in [(&p::SERIES_TIME, &series.time), (&p::SERIES_GAUGE_PRESSURE, &series.gauge_pressure)] {
            let list: Vec<String> = numbers.iter().map(|number| said(*number, row)).collect();
            give(row.key, &format!("[{}]", list.join(", ")))?;
        }
        let PressureSensor { offset, scale, shift } = series.sensor;
        for (row, number) in [(&p::SERIES_OFFSET, offset), (&p::SERIES_SCALE, scale), (&p::SERIES_SHIFT, shift)] {
            give(row.key, &said(number, row))?;
        }
        if let Some(first) = first {
            give(p::INITIAL_GAUGE_PRESSURE.key, &said(first, &p::INITIAL_GAUGE_PRESSURE))?;
        }
        give(keys::PRESSURE_AT, &format!("\"{}\"", series.at.name()))?;
        Ok(())
    }

    /// The value at a key of a plant's file; where it does not say it, that in force.
    fn value_in_plant(&self, key: &str, entry: Option<usize>, parameter: &Parameter) -> Option<f64> {
        if let Some(written) = self.entry(key) {
            let node = match (&written.node.value, entry) {
                (Value::List(items), Some(entry)) => items.get(entry)?,
                (_, None) => &written.node,
                _ => return None,
            };
            return match &node.value {
                Value::Number(number) => Some(*number),
                Value::String(text) => quantity::parse(text).ok().map(|read| read.value),
                _ => None,
            };
        }
        let row = keys::stands_for(key);
        let path = entry.map_or(row.clone(), |entry| format!("{row}[{entry}]"));
        let name = key.strip_prefix(ACTUATORS).and_then(|rest| rest.trim_start_matches('.').split('.').next());
        let members = self.read_plant().ok()?.members;
        let mut of = members.into_iter().filter(|member| name.is_none_or(|name| member.name == name));
        let in_force = of.find_map(|mut member| Place::find(&path, &mut member.alone).ok()?.value(&mut member.alone));
        in_force.or(parameter.default)
    }

    /// Whether a parameter of a braid that is described at rest follows from the others, so that another value would contradict
    /// them.
    fn braid_follows_without(&self, key: &str, parameter: &Parameter) -> bool {
        let name = key.strip_prefix(ACTUATORS).and_then(|rest| rest.trim_start_matches('.').split('.').next());
        let names =
            self.named(ACTUATORS).into_iter().map(|(of, _)| of).filter(|of| name.is_none_or(|name| *of == name));
        BRAID.iter().any(|row| row.key == parameter.key)
            && names.map(|name| self.of_actuator(name).stated_braid()).any(|mut stated| {
                let at_rest = stated.is_at_rest();
                if let Some(slot) = stated.slot(parameter) {
                    *slot = None;
                }
                at_rest && stated.muscle().is_ok()
            })
    }

    /// The file with other values of some parameters.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when one is outside its parameter's range.
    pub fn with_plant_values(&self, places: &[PlantPlace], values: &[f64]) -> Result<Self, Error> {
        let mut document = self.clone();
        for (place, value) in places.iter().zip(values) {
            let (row, path) = (place.parameter, place.path());
            let said = quantity::format(row.check(*value)?, row.unit);
            let whole = Source::new("[fit]", format!("{path} = {said}"));
            let at = FilePlace::new(whole, 0..path.len());
            let value = if row.unit.is_empty() { Value::Number(*value) } else { Value::String(said) };
            let node = Node { place: at.clone(), value };
            let node = match (place.entry, document.entry(&place.key).map(|entry| &entry.node)) {
                (Some(entry), Some(Node { place, value: Value::List(items) })) => {
                    let mut items = items.clone();
                    if let Some(item) = items.get_mut(entry) {
                        *item = node;
                    }
                    Node { place: place.clone(), value: Value::List(items) }
                }
                _ => node,
            };
            // The default preset that a file means without a word still applies where the file gives one number of the
            // braid.
            if describes_braid(|path| path == place.key) {
                document.name_default_preset(self, &at);
            }
            document.put(&place.key, &at, &node);
        }
        Ok(document)
    }
}

impl AdjustedPlant {
    /// The plant of a file with these values of some parameters.
    ///
    /// # Errors
    /// What the file with these values cannot say.
    pub fn new(document: &Document, places: &[PlantPlace], values: &[f64]) -> Result<Self, Diagnostics> {
        let experiment = experiment_at(document, places, values)?;
        Ok(Self { document: document.clone(), places: places.to_vec(), values: values.to_vec(), experiment })
    }

    /// The plant, its start and its names.
    pub fn experiment(&self) -> &PlantExperiment {
        &self.experiment
    }

    /// Plant and start over dual numbers, with the derivatives with respect to the parameters from `first` on, one direction
    /// for each of up to `K`.
    ///
    /// # Errors
    /// When the file can say no value together with one of these.
    pub fn seeded<const K: usize>(&self, first: usize) -> Result<PlantOver<Dual<f64, K>>, Diagnostics> {
        let (labels, here) = numbers_of(&self.experiment);
        let mut slopes = vec![[0.0; K]; here.len()];
        for direction in 0..K.min(self.places.len().saturating_sub(first)) {
            for (slope, derivative) in slopes.iter_mut().zip(self.derivatives(first + direction, (&labels, &here))?) {
                slope[direction] = derivative;
            }
        }
        let mut slopes = slopes.into_iter();
        let mut next = |value: f64| Dual { value, slope: slopes.next().unwrap_or([0.0; K]) };
        let plant = self.experiment.plant.map(|_, _, value| next(value));
        let start = self.experiment.start.map(|_, value| next(value));
        Ok((plant, start))
    }

    /// The derivatives of all numbers with respect to one parameter; zero where the plant has other parts on either side, as
    /// where a part is absent at zero.
    fn derivatives(&self, index: usize, (labels, here): (&[Label], &[f64])) -> Result<Vec<f64>, Diagnostics> {
        let value = self.values[index];
        let size = value.abs().max(self.places[index].value.abs());
        let step = if size > 0.0 { STEP * size } else { STEP_FROM_ZERO };
        let at = |value: f64| -> Result<(f64, Vec<f64>), Diagnostics> {
            let mut values = self.values.clone();
            values[index] = value;
            let (its, numbers) = numbers_of(&experiment_at(&self.document, &self.places, &values)?);
            Ok((value, if its == labels { numbers } else { Vec::new() }))
        };
        let (below, above) = (at(value - step), at(value + step));
        let usable =
            |side: &Result<(f64, Vec<f64>), Diagnostics>| side.as_ref().is_ok_and(|(_, found)| !found.is_empty());
        let difference = |(a, low): &(f64, Vec<f64>), (b, high): &(f64, Vec<f64>)| -> Vec<f64> {
            low.iter().zip(high).map(|(low, high)| (high - low) / (b - a)).collect()
        };
        match (below, above) {
            (Ok(below), Ok(above)) if !below.1.is_empty() && !above.1.is_empty() => Ok(difference(&below, &above)),
            (Err(found), Err(_)) => Err(found),
            (below, above) => {
                // At the end of its range: by three points on the other side, exact where a number goes with the square.
                let Some((near, way)) = [(below, -1.0), (above, 1.0)].into_iter().find(|(side, _)| usable(side)) else {
                    return Ok(vec![0.0; here.len()]);
                };
                let near = difference(&(value, here.to_vec()), &near?);
                let far = at(value + 2.0 * way * step)?;
                if far.1.is_empty() {
                    return Ok(near);
                }
                let far = difference(&(value, here.to_vec()), &far);
                Ok(near.into_iter().zip(far).map(|(near, far)| 2.0 * near - far).collect())
            }
        }
    }
}

/// The plant of a file with these values.
fn experiment_at(document: &Document, places: &[PlantPlace], values: &[f64]) -> Result<PlantExperiment, Diagnostics> {
    let adjusted = document.with_plant_values(places, values).map_err(|error| -> Diagnostics {
        Diagnostic::whole(Class::OutOfRange, document.source().name(), error.to_string()).into()
    })?;
    match adjusted.plant_experiment()? {
        Some(experiment) => Ok(experiment),
        None => {
            let title = "the file describes no plant";
            Err(Diagnostic::whole(Class::Missing, document.source().name(), title).into())
        }
    }
}

/// Every number of a plant and its start in one order, with what it is.
fn numbers_of(of: &PlantExperiment) -> (Vec<Label>, Vec<f64>) {
    let (mut labels, mut numbers) = (Vec::new(), Vec::new());
    let mut note = |label: Label, value: f64| {
        labels.push(label);
        numbers.push(value);
        value
    };
    of.plant.map(|part, parameter, value| note(Label::Plant(part, parameter.key), value));
    of.start.map(|number, value| note(Label::Start(number), value));
    (labels, numbers)
}
