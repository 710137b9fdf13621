//! Units in which results are shown to people: a system of units, and a custom unit for any quantity.
//!
//! | quantity | SI unit | `metric` | `si` | `imperial` |
//! |---|---|---|---|---|
//! | `length` | m | mm, µm, … | mm, µm, … | in |
//! | `pressure` | Pa | bar, below 0.01 bar Pa | kPa, … | psi |
//! | `force` | N | N | N | lbf |
//! | `mass` | kg | g, mg, … | kg, below 0.01 kg g, mg, … | lb |
//! | `angle` | rad | degree | rad | degree |
//! | … | | the whole list is the table in this file | | |
//!
//! Everything that shows a number uses this module: summaries, figures, curves, warnings, reports, and the columns of files where a
//! choice was made. Without a choice files have SI units, so that programs read what they always read, and people see `metric`. A unit
//! that was chosen without a system changes its own quantity alone: in files the others stay in SI. Files have no prefixes, so those in
//! `si` are in base units.
//!
//! A difference of temperatures, such as a ripple, has no offset: in °C it is in K, and in °F in °R ([`is_difference`]).
//!
//! The choice is the program's, made once before anything is shown, as a language is: [`choose`]. Hosts that call this crate as a
//! library leave it and get `metric`. Values inside the program are SI throughout.

use crate::quantities::{digits, plain, prefixed};
use crate::table::{Column, Kind};
use mckibben_plot::{Conversion, Figure};
use mckibben_scenario::quantity;
use mckibben_scenario::sweep::column_of;
use std::borrow::Cow;
use std::fmt::Write as _;
use std::str::FromStr;
use std::sync::{LazyLock, OnceLock};

/// A system of units.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum System {
    /// Millimetre, bar, newton, degree.
    #[default]
    Metric,
    /// SI units with prefixes; radian.
    Si,
    /// Inch, psi, pound-force, degree.
    Imperial,
}

/// A quantity: its name, its SI units as this project writes them, and its units in the systems, metric, SI and imperial.
type Row = (&'static str, &'static str, [&'static str; 3]);

/// The quantities. A unit after `~` takes prefixes; one behind `|` is for values below a hundredth of the unit before it.
const ROWS: [Row; 24] = [
    ("length", "m", ["~m", "~m", "in"]),
    ("area", "m^2", ["mm^2", "m^2", "in^2"]),
    ("volume", "m^3", ["~L", "m^3", "in^3"]),
    ("velocity", "m/s", ["~m/s", "~m/s", "in/s"]),
    ("acceleration", "m/s^2", ["~m/s^2", "~m/s^2", "in/s^2"]),
    ("pressure", "Pa", ["bar|~Pa", "~Pa", "psi"]),
    ("force", "N", ["~N", "~N", "lbf"]),
    ("mass", "kg", ["~g", "kg|~g", "lb"]),
    ("mass-flow", "kg/s", ["~g/s", "kg/s|~g/s", "lb/s"]),
    ("volume-flow", "m^3/s", ["L/min", "m^3/s", "cfm"]),
    ("conductance", "m^3/(s*Pa)", ["L/(s*bar)", "~m^3/(s*Pa)", "L/(s*bar)"]),
    ("angle", "rad", ["deg", "~rad", "deg"]),
    ("angular-velocity", "rad/s", ["deg/s", "~rad/s", "deg/s"]),
    ("torque", "N*m", ["~N*m", "~N*m", "lbf*in"]),
    ("angular-stiffness", "N*m/rad", ["~N*m/rad", "~N*m/rad", "lbf*in/rad"]),
    ("angular-damping", "N*m*s/rad", ["~N*m*s/rad", "~N*m*s/rad", "lbf*in*s/rad"]),
    ("inertia", "kg*m^2", ["kg*m^2", "kg*m^2", "lb*in^2"]),
    ("stiffness", "N/m", ["~N/m", "~N/m", "lbf/in"]),
    ("damping", "N*s/m", ["~N*s/m", "~N*s/m", "lbf*s/in"]),
    ("energy", "J", ["~J", "~J", "ft*lbf"]),
    ("power", "W", ["~W", "~W", "ft*lbf/s"]),
    ("temperature", "K", ["K", "K", "degF"]),
    ("time", "s", ["~s", "~s", "~s"]),
    ("frequency", "Hz", ["~Hz", "~Hz", "~Hz"]),
];

/// A unit as something is shown in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// How it is written in a scenario file.
    symbol: String,
    /// Its size in SI.
    size: f64,
    /// What is taken off the number in this unit, of a scale with an offset zero.
    zero: f64,
    /// Whether it takes the prefix that puts a number between 1 and 1000.
    prefixes: bool,
    /// The unit for values below a hundredth of this one, where that has another.
    small: Option<Box<Unit>>,
}

/// A unit with its prefix, and what makes the number in it of one in SI: `factor · value − zero`.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// The unit as people read it, such as `mm` or `°`; empty for a pure number.
    pub text: String,
    /// How many of the unit there are in one of SI.
    pub factor: f64,
    zero: f64,
}

/// The unit of every quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Units(Vec<Entry>);

/// The unit of a quantity.
#[derive(Clone, Debug, PartialEq)]
struct Entry {
    row: Row,
    unit: Unit,
    /// Whether a user chose it, with its system or alone: then files have it too.
    chosen: bool,
}

static CHOSEN: OnceLock<Units> = OnceLock::new();
static USUAL: LazyLock<Units> = LazyLock::new(Units::usual);

/// Chooses the units of this process; what was chosen first stays.
pub fn choose(units: Units) {
    let _ = CHOSEN.set(units);
}

/// The units of this process: those that were chosen, or metric ones.
pub fn units() -> &'static Units {
    CHOSEN.get().unwrap_or(&USUAL)
}

/// The unit that was chosen for values in an SI unit, as a scenario file writes it, with the factor and the offset that give a number in
/// it; none where no choice was made of it, and of an SI unit that is not in the table.
pub fn chosen_scale(si: &str) -> Option<(String, f64, f64)> {
    CHOSEN.get().and_then(|units| units.scale(si))
}

/// [`chosen_scale`] of a difference of values, where no unit has an offset.
pub(crate) fn chosen_scale_of_differences(si: &str) -> Option<(String, f64, f64)> {
    CHOSEN.get().and_then(|units| units.of_differences().scale(si))
}

/// Whether units were chosen of which none of length, pressure, mass and force is imperial: then a file to start from is metric.
pub fn is_metric_chosen() -> bool {
    CHOSEN.get().is_some_and(Units::is_metric)
}

/// The size in SI below which a value is rounding and nothing that was simulated or measured: a picometre, a billionth of the
/// atmosphere's pressure.
pub fn rounding(si: &str) -> f64 {
    match si {
        "m" | "m/s" | "rad" | "rad/s" => 1e-12,
        "Pa" => 1e-4,
        "N" | "N*m" => 1e-10,
        "kg" | "kg/s" | "J" => 1e-15,
        _ => 0.0,
    }
}

/// The columns of a file in the units that were chosen, and what makes their numbers; nothing where no choice was made and they stay
/// in SI.
pub(crate) fn columns(columns: Vec<Column>) -> (Vec<Column>, Vec<Shown>) {
    match CHOSEN.get() {
        Some(units) => columns.into_iter().map(|column| units.column(column)).unzip(),
        None => (columns, Vec::new()),
    }
}

/// A figure in the units of this process. Where its unit was not chosen an axis in SI becomes metric, and another, such as those of
/// the paper's figures, stays.
pub fn drawn(figure: Figure) -> Figure {
    figure.converted(&|unit, largest| units().conversion(unit, largest, true))
}

/// What makes numbers in a unit as people read it of which the largest is given those of the units that were chosen; nothing where no
/// choice was made of it, or the unit is of no quantity.
pub(crate) fn chosen(unit: &str, largest: f64) -> Option<Conversion> {
    CHOSEN.get()?.conversion(unit, largest, false)
}

/// Whether a number with that name is a difference of two values of its quantity, so that a scale with an offset zero does not apply:
/// a ripple, a drift, an error. Names end with their SI unit or do not, and have words between `.`, `_` or spaces.
pub fn is_difference(name: &str) -> bool {
    // Only the end counts: a part may have any of these words as its name.
    let mut words = stem(name, unit_of(name)).rsplit(['.', '_', ' ']);
    match (words.next(), words.next()) {
        (Some("ripple" | "drift" | "error" | "deviation"), _) => true,
        (Some("rms" | "peak"), before) => before == Some("error"),
        _ => false,
    }
}

/// The unit of temperature with an absolute zero whose degrees have a size in K: of °C or of °F.
pub(crate) fn degrees_without_offset(size: f64) -> &'static str {
    if size > 0.9 { "K" } else { "degR" }
}

/// How many decimals show as much of a number that is multiplied by a factor as so many did before.
pub(crate) fn decimals(before: usize, factor: f64) -> usize {
    let digits = before as f64 - factor.abs().log10().round();
    if digits.is_finite() { digits.clamp(0.0, 12.0) as usize } else { before }
}

/// The SI unit that the name of a column ends with; empty where it ends with none.
pub(crate) fn unit_of(name: &str) -> &'static str {
    let units = ROWS.iter().map(|(_, si, _)| *si).filter(|si| name.ends_with(&ending(si)));
    units.max_by_key(|si| ending(si).len()).unwrap_or_default()
}

impl Unit {
    /// A unit of the table: `~` before a symbol lets it take prefixes.
    fn of(symbol: &str) -> Result<Self, String> {
        let (symbol, small) = symbol.split_once('|').map_or((symbol, None), |(symbol, small)| (symbol, Some(small)));
        let small = small.map(|small| Self::of(small).map(Box::new)).transpose()?;
        let (symbol, prefixes) = symbol.strip_prefix('~').map_or((symbol, false), |symbol| (symbol, true));
        let at = |number: &str| quantity::parse(&format!("{number} {symbol}")).map_err(|error| error.to_string());
        // Of a scale with an offset zero, two points give size and zero.
        let (none, one) = (at("0")?.value, at("1")?.value);
        let size = one - none;
        Ok(Self { symbol: symbol.to_owned(), size, zero: none / size, prefixes, small })
    }

    /// The unit of differences: of a scale with an offset zero, the one whose zero is absolute and whose degrees are as large.
    fn of_differences(&self) -> Self {
        if self.zero == 0.0 {
            return self.clone();
        }
        Self::of(degrees_without_offset(self.size)).unwrap_or_else(|_| self.clone())
    }

    fn shown(&self, largest: f64) -> Shown {
        let size = largest / self.size;
        if let Some(small) = self.small.as_ref().filter(|_| size > 0.0 && size < 0.01) {
            return small.shown(largest);
        }
        let (scaled, prefix) = if self.prefixes { prefixed(size) } else { (size, "") };
        let factor = if size.is_finite() && size != 0.0 { scaled / size / self.size } else { 1.0 / self.size };
        Shown { text: format!("{prefix}{}", readable(&self.symbol)), factor, zero: self.zero }
    }
}

/// Signs of a unit in a scenario file, and as people read them. `degF` and `degC` follow from `deg`.
const SIGNS: [(&str, &str); 4] = [("deg", "°"), ("^2", "²"), ("^3", "³"), ("*", "·")];

/// A unit as people read it.
pub(crate) fn readable(symbol: &str) -> String {
    SIGNS.iter().fold(symbol.to_owned(), |text, (written, sign)| text.replace(written, sign))
}

impl Shown {
    /// The number in this unit of a value in SI.
    pub fn number(&self, value: f64) -> f64 {
        self.factor * value - self.zero
    }

    /// The number in this unit of a value in SI, for a file: in SI as it is, and else with 15 significant digits, so that a value that was
    /// given in this unit comes back.
    pub(crate) fn written(&self, value: f64) -> f64 {
        if self.factor == 1.0 && self.zero == 0.0 {
            return value;
        }
        let number = self.number(value);
        // Of a scale with an offset zero the rounding is that of the offset, which is some hundred degrees.
        let text = if self.zero == 0.0 { format!("{number:.14e}") } else { format!("{number:.11}") };
        text.parse().unwrap_or(number)
    }

    /// A number with the unit behind it.
    pub fn with(&self, number: &str) -> String {
        let gap = if self.text.is_empty() || self.text == "°" { "" } else { " " };
        format!("{number}{gap}{}", self.text)
    }
}

impl Units {
    /// The units of a system.
    pub fn of(system: System) -> Self {
        let place = match system {
            System::Metric => 0,
            System::Si => 1,
            System::Imperial => 2,
        };
        // Checked by a test: every symbol of the table is a unit.
        let entry = |row: Row| Unit::of(row.2[place]).ok().map(|unit| Entry { row, unit, chosen: true });
        Self(ROWS.into_iter().filter_map(entry).collect())
    }

    /// Metric units, none of them chosen.
    fn usual() -> Self {
        let Self(entries) = Self::of(System::default());
        Self(entries.into_iter().map(|entry| Entry { chosen: false, ..entry }).collect())
    }

    /// The units for differences, in which no scale has an offset.
    #[must_use]
    pub fn of_differences(&self) -> Self {
        let of = |entry: &Entry| Entry { unit: entry.unit.of_differences(), ..entry.clone() };
        Self(self.0.iter().map(of).collect())
    }

    /// The units for numbers with that name: those for differences where it is one.
    pub fn for_name(&self, name: &str) -> Cow<'_, Self> {
        if is_difference(name) { Cow::Owned(self.of_differences()) } else { Cow::Borrowed(self) }
    }

    /// The unit of the quantity with an SI unit, whose powers stand with or without their sign: columns of plants are in `m3`.
    fn of_si(&self, si: &str) -> Option<&Entry> {
        let is_it = |known: &str| known == si || known.replace('^', "") == si;
        self.0.iter().find(|entry| is_it(entry.row.1))
    }

    /// Whether none of length, pressure, mass and force has an imperial unit.
    fn is_metric(&self) -> bool {
        let main = |name: &str| matches!(name, "length" | "pressure" | "mass" | "force");
        !self.0.iter().any(|Entry { row: (name, _, [.., imperial]), unit, .. }| main(name) && unit.symbol == *imperial)
    }

    /// The unit for values in an SI unit of which the largest size is given; another unit than those of the table is itself.
    pub fn shown(&self, si: &str, largest: f64) -> Shown {
        let found = self.of_si(si).map(|entry| entry.unit.clone());
        // A prefix before a power would be raised with it.
        let first = si.split(['*', '/']).next().unwrap_or_default();
        let prefixes = !first.is_empty() && first.chars().all(char::is_alphabetic);
        let own = || Unit { symbol: si.to_owned(), size: 1.0, zero: 0.0, prefixes, small: None };
        found.unwrap_or_else(own).shown(largest)
    }

    /// One unit for several values in an SI unit.
    pub fn common(&self, si: &str, values: impl IntoIterator<Item = f64>) -> Shown {
        let largest = values.into_iter().filter(|value| value.is_finite());
        self.shown(si, largest.fold(0.0, |largest: f64, value| largest.max(value.abs())))
    }

    /// A value with its unit: four significant digits, and zero for what is no more than rounding.
    pub fn quantity(&self, value: f64, si: &str) -> String {
        let value = if value.abs() < rounding(si) { 0.0 } else { value };
        // Kiloseconds are not in use.
        let shown = self.shown(si, if si == "s" { value.abs().min(1.0) } else { value.abs() });
        let number = shown.number(value);
        // Kelvins and degrees of temperature are printed to a tenth.
        shown.with(&if si == "K" { format!("{number:.1}") } else { digits(number) })
    }

    /// A value that a user gave: as [`Units::quantity`], without zeros that say nothing.
    pub fn given(&self, value: f64, si: &str) -> String {
        let text = self.quantity(value, si);
        let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c))).unwrap_or(text.len());
        format!("{}{}", plain(&text[..end]), &text[end..])
    }

    /// What makes the number in these units of one in a unit as people read it. Units that are not of the table stay, and so do those
    /// of quantities whose unit was not chosen, save SI where `from_si`.
    fn conversion(&self, unit: &str, largest: f64, from_si: bool) -> Option<Conversion> {
        let symbol = SIGNS.iter().fold(unit.to_owned(), |text, (written, sign)| text.replace(sign, written));
        if symbol.is_empty() {
            return None;
        }
        let is_due = |entry: &&Entry| entry.chosen || (from_si && entry.row.1 == symbol);
        // A scale with an offset zero is no factor, and is refused here.
        let (dimension, factor) = quantity::parse_unit(&symbol).ok()?;
        let of = |entry: &&Entry| quantity::parse_unit(entry.row.1).is_ok_and(|(its, _)| its == dimension);
        // Torque and energy have one dimension; a torque has the unit of a force in its own.
        let found = self.0.iter().filter(of).find(|entry| symbol.contains('J') == entry.row.1.contains('J'));
        let shown = self.shown(found.filter(is_due)?.row.1, largest * factor);
        Some(Conversion { unit: shown.text, factor: shown.factor * factor, zero: shown.zero })
    }

    /// A column in these units, without prefixes, and what makes its numbers. Its name ends with the unit.
    fn column(&self, column: Column) -> (Column, Shown) {
        let units = self.for_name(&column.name);
        let entry = units.of_si(&column.unit).filter(|entry| entry.chosen && column.kind == Kind::Number);
        let Some(Entry { unit, .. }) = entry else {
            return (column, Shown { text: String::new(), factor: 1.0, zero: 0.0 });
        };
        let shown = Shown { text: unit.symbol.clone(), factor: 1.0 / unit.size, zero: unit.zero };
        let name = format!("{}{}", stem(&column.name, &column.unit), ending(&unit.symbol));
        (Column { name, unit: unit.symbol.clone(), ..column }, shown)
    }

    /// The unit of values in an SI unit, with the factor and the offset that give a number in it.
    pub(crate) fn scale(&self, si: &str) -> Option<(String, f64, f64)> {
        let Entry { unit, .. } = self.of_si(si).filter(|entry| entry.chosen)?;
        // No unit has minus zero as its offset.
        Some((unit.symbol.clone(), 1.0 / unit.size, 0.0 - unit.zero))
    }

    /// The names of the quantities with their units, for a help text.
    pub fn names() -> String {
        let mut text = String::new();
        for (name, si, _) in ROWS {
            let _ = write!(text, "{}{name} ({})", if text.is_empty() { "" } else { ", " }, readable(si));
        }
        text
    }
}

/// The end of the name of a column in a unit; empty for a pure number.
pub(crate) fn ending(symbol: &str) -> String {
    column_of("", symbol)
}

/// The name of a column without the unit at its end.
pub(crate) fn stem<'n>(name: &'n str, unit: &str) -> &'n str {
    name.strip_suffix(&ending(unit)).unwrap_or(name)
}

impl FromStr for Units {
    type Err = String;

    /// `imperial`, `si,angle=deg` or `pressure=psi,length=in`: a system, and units for quantities. Where no system is named text is
    /// metric, and files have SI units but for these quantities.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut units: Option<Self> = None;
        let mut chosen: Vec<&str> = Vec::new();
        for item in text.split(',').map(str::trim) {
            let Some((name, symbol)) = item.split_once('=') else {
                let system = match item {
                    "metric" => System::Metric,
                    "si" => System::Si,
                    "imperial" => System::Imperial,
                    _ => {
                        return Err(format!(
                            "`{item}` is no system of units; give metric, si or imperial, or QUANTITY=UNIT such as \
                             pressure=psi"
                        ));
                    }
                };
                if units.is_some() {
                    return Err(format!("`{item}` must stand first, and only one system can be chosen"));
                }
                units = Some(Self::of(system));
                continue;
            };
            let (name, symbol) = (name.trim(), symbol.trim());
            let all = units.get_or_insert_with(Self::usual);
            let Some(entry) = all.0.iter_mut().find(|entry| entry.row.0 == name) else {
                return Err(format!("`{name}` is no quantity; give one of {}", Self::names()));
            };
            if chosen.contains(&name) {
                return Err(format!("`{name}` stands twice; give one unit for each quantity"));
            }
            chosen.push(name);
            let fits = |of: &str| quantity::parse(&format!("1 {of}")).map(|read| read.dimension);
            let si = entry.row.1;
            let (found, expected) = (fits(symbol), fits(si).map_err(|error| error.to_string())?);
            match found {
                Ok(dimension) if dimension == expected => (entry.unit, entry.chosen) = (Unit::of(symbol)?, true),
                Ok(_) => return Err(format!("`{symbol}` is no unit of {name}; one is {}", readable(si))),
                Err(error) => return Err(error.to_string()),
            }
        }
        units.ok_or_else(|| "give metric, si or imperial".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SYSTEMS: [System; 3] = [System::Metric, System::Si, System::Imperial];

    #[test]
    fn a_choice_without_inches_psi_pounds_is_metric() {
        for (text, is_metric) in [
            ("metric", true),
            ("si", true),
            ("metric,angle=rad", true),
            ("pressure=kPa", true),
            ("imperial", false),
            ("pressure=psi", false),
            ("si,mass=lb", false),
        ] {
            assert_eq!(text.parse::<Units>().unwrap().is_metric(), is_metric, "{text}");
        }
    }

    #[test]
    fn every_system_has_a_unit_of_every_quantity_and_of_its_dimension() {
        for system in SYSTEMS {
            let units = Units::of(system);
            assert_eq!(units.0.len(), ROWS.len(), "{system:?}");
            for Entry { row: (name, si, _), unit, .. } in &units.0 {
                let dimension = |of: &str| quantity::parse(&format!("1 {of}")).unwrap().dimension;
                assert_eq!(dimension(si), dimension(&unit.symbol), "{system:?}: {name}");
            }
        }
    }

    #[test]
    fn what_is_shown_is_read_back_as_the_value() {
        for system in SYSTEMS {
            let units = Units::of(system);
            for (_, si, _) in ROWS {
                for value in [273.15_f64, -0.012_34, 1e-9, 5.1e6] {
                    let shown = units.shown(si, value.abs());
                    let back = (shown.number(value) + shown.zero) / shown.factor;
                    let size = value.abs().max((shown.zero / shown.factor).abs());
                    assert!((back - value).abs() <= 1e-12 * size, "{system:?}: {value} {si} as {}", shown.text);
                }
            }
        }
    }

    #[test]
    fn a_quantity_is_written_in_the_units_of_its_system() {
        let text = |system: &str, value: f64, si: &str| system.parse::<Units>().unwrap().quantity(value, si);
        assert_eq!(text("metric", 413_685.438, "Pa"), "4.137 bar");
        assert_eq!(text("metric", 45.58, "Pa"), "45.58 Pa");
        assert_eq!(text("imperial", 413_685.438, "Pa"), "60.00 psi");
        assert_eq!(text("si", 413_685.438, "Pa"), "413.7 kPa");
        assert_eq!([text("si", 2.267_96, "kg"), text("si", 7.304e-6, "kg")], ["2.268 kg", "7.304 mg"]);
        assert_eq!(text("metric", 20f64.to_radians(), "rad"), "20.00°");
        assert_eq!(text("si", 0.3491, "rad"), "349.1 mrad");
        assert_eq!(text("imperial", 0.0254, "m"), "1.000 in");
        assert_eq!(text("metric", 2.9e-5, "m"), "29.00 µm");
        assert_eq!(text("imperial", 293.15, "K"), "68.0 °F");
        assert_eq!(text("metric,temperature=degC", 293.15, "K"), "20.0 °C");
        assert_eq!(text("pressure=psi", 0.086, "m"), "86.00 mm");
        assert_eq!(text("metric", 3000.0, "s"), "3000 s");
        assert_eq!("metric".parse::<Units>().unwrap().given(20f64.to_radians(), "rad"), "20°");
        assert_eq!("imperial".parse::<Units>().unwrap().given(413_685.438, "Pa"), "60 psi");
    }

    #[test]
    fn axes_are_converted_from_any_unit_to_the_chosen_one() {
        let converted = |units: &Units, unit: &str, from_si| {
            let conversion = units.conversion(unit, 1.0, from_si)?;
            Some((conversion.unit, (1e6 * conversion.factor).round() / 1e6))
        };
        let of = |system: &str, unit: &str, from_si| converted(&system.parse::<Units>().unwrap(), unit, from_si);
        let some = |unit: &str, factor: f64| Some((unit.to_owned(), factor));
        assert_eq!(of("metric", "Pa", false), some("Pa", 1.0));
        assert_eq!(of("imperial", "mm", true), some("in", 0.03937));
        assert_eq!(of("imperial", "bar", true), some("psi", 14.503774));
        assert_eq!(of("si", "°", true), some("mrad", 17.453293));
        // Without a choice SI becomes metric and the paper's units stay; a unit that was chosen alone changes its quantity.
        assert_eq!(converted(&Units::usual(), "m", true), some("m", 1.0));
        assert_eq!([converted(&Units::usual(), "psi", true), converted(&Units::usual(), "m", false)], [None, None]);
        assert_eq!([of("length=in", "psi", true), of("length=in", "Pa", false)], [None, None]);
        assert_eq!(of("length=in", "mm", false), some("in", 0.03937));
        // What is no unit stays always.
        assert_eq!(of("imperial", "10⁻³ in", true), None);
        assert_eq!(of("imperial", "%", true), None);
        assert_eq!(of("imperial", "", true), None);
    }

    #[test]
    fn a_number_in_another_unit_has_as_many_digits() {
        // 12.3 mm are 0.484 in, 0.484 in are 12.3 mm, and 1234.5 kPa 12.345 bar.
        assert_eq!([decimals(1, 1.0 / 25.4), decimals(3, 25.4), decimals(1, 0.01)], [2, 2, 3]);
        assert_eq!([decimals(0, 1000.0), decimals(2, f64::NAN)], [0, 2]);
    }

    #[test]
    fn a_column_ends_with_its_unit() {
        let units: Units = "imperial".parse().unwrap();
        let named = |name: &str, si: &str| units.column(Column::number(name, si)).0.name;
        assert_eq!(named("length_m", "m"), "length_in");
        assert_eq!(named("flexor.gauge_pressure_pa", "Pa"), "flexor.gauge_pressure_psi");
        assert_eq!(named("angular_velocity_rad_s", "rad/s"), "angular_velocity_deg_s");
        assert_eq!(named("torque_n_m", "N*m"), "torque_lbf_in");
        assert_eq!(named("contraction", ""), "contraction");
        // A column of a plant writes the unit without the sign of the power; a litre is a thousandth of it, and 1 in = 25.4 mm.
        let volume = |system: &str| system.parse::<Units>().unwrap().column(Column::number("flexor.volume_m3", "m3"));
        let (column, shown) = volume("imperial");
        assert_eq!((column.name.as_str(), column.unit.as_str()), ("flexor.volume_in3", "in^3"));
        assert!((shown.number(0.0254_f64.powi(3)) - 1.0).abs() < 1e-12, "{shown:?}");
        assert_eq!(volume("metric").0.name, "flexor.volume_l");
        let units =
            ["length_m", "stiffness_n_m", "sonic_conductance_m3_s_pa", "damping_n_s_m", "contraction"].map(unit_of);
        assert_eq!(units, ["m", "N/m", "m^3/(s*Pa)", "N*s/m", ""]);
    }

    /// `si` is SI in files, metres and kilograms; a unit that is chosen alone changes no other column.
    #[test]
    fn files_in_si_are_in_base_units_and_a_single_unit_changes_its_quantity_alone() {
        let columns = |choice: &str| -> Vec<(String, f64)> {
            let units: Units = choice.parse().unwrap();
            let of = |(_, si, _): Row| {
                let (column, shown) = units.column(Column::number("x", si));
                (column.unit, shown.number(300.0))
            };
            ROWS.into_iter().map(of).collect()
        };
        let si: Vec<(String, f64)> = ROWS.iter().map(|(_, si, _)| ((*si).to_owned(), 300.0)).collect();
        assert_eq!(columns("si"), si);
        for ((name, _, [_, _, imperial]), place) in ROWS.into_iter().zip(0..) {
            let mut expected = si.clone();
            let imperial = imperial.trim_start_matches('~');
            let single = columns(&format!("{name}={imperial}"));
            expected[place] = (imperial.to_owned(), single[place].1);
            assert_eq!(single, expected, "{name}");
        }
    }

    /// A difference of 50 K is one of 90 °R, and none of −223 °C; the temperature in the next column keeps its offset.
    #[test]
    fn a_difference_of_temperatures_has_no_offset() {
        for (choice, unit, text, number) in [
            ("metric,temperature=degC", "K", "50.0 K", 50.0),
            ("imperial", "degR", "90.0 °R", 90.0),
            ("metric", "K", "50.0 K", 50.0),
        ] {
            let units: Units = choice.parse().unwrap();
            for name in ["temperature_ripple_k", "x_temperature_drift_k", "x.temperature.ripple"] {
                let (column, shown) = units.column(Column::number(name, "K"));
                assert_eq!(column.unit, unit, "{choice}: {name}");
                assert!((shown.number(50.0) - number).abs() < 1e-9, "{choice}: {shown:?}");
                assert_eq!(units.for_name(name).quantity(50.0, "K"), text);
            }
        }
        let units: Units = "temperature=degC".parse().unwrap();
        for (name, own) in
            [("temperature_mean_k", "temperature_mean_degc"), ("drift.temperature_k", "drift.temperature_degc")]
        {
            let (column, shown) = units.column(Column::number(name, "K"));
            assert_eq!((column.name.as_str(), shown.number(323.15)), (own, 50.0));
        }
    }

    #[test]
    fn a_value_that_was_given_in_the_unit_comes_back_in_a_file() {
        let units: Units = "imperial".parse().unwrap();
        for (si, symbol) in
            [("kg", "lb"), ("Pa", "psi"), ("m", "in"), ("N", "lbf"), ("K", "degF"), ("rad", "deg"), ("s", "s")]
        {
            let shown = units.column(Column::number("x", si)).1;
            for tenths in 1..2000 {
                let number = f64::from(tenths) / 10.0;
                let value = quantity::parse(&format!("{number} {symbol}")).unwrap().value;
                assert_eq!(shown.written(value), number, "{number} {symbol}");
            }
        }
        let seconds = units.column(Column::number("x", "s")).1;
        let value = 0.1 + 0.2;
        assert_eq!(seconds.written(value).to_bits(), value.to_bits(), "SI is lossless");
    }

    #[test]
    fn what_is_no_choice_is_refused_with_a_remedy() {
        for (text, part) in [
            ("furlongs", "give metric, si or imperial"),
            ("pressure=mm", "is no unit of pressure"),
            ("presure=psi", "is no quantity"),
            ("pressure=psi,imperial", "must stand first"),
            ("pressure=pzi", "pzi"),
            ("pressure=psi,pressure=bar", "`pressure` stands twice"),
            ("imperial,metric", "only one system"),
        ] {
            let refused = text.parse::<Units>().unwrap_err();
            assert!(refused.contains(part), "{text}: {refused}");
        }
    }
}
