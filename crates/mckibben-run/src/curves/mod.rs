//! Force, stiffness and volume of a scenario's actuator over length, for a range of pressures.
//!
//! ```text
//! F_s(L, P_g)                                   (3)(9)    at rest, without friction
//! k = ∂F/∂L at constant pressure                (7)
//! k = ∂F/∂L + (∂F/∂P)(dP/dL), valve shut        (5)       dP/dL = −κ P (dV/dL)/V
//! ```
//!
//! How good (6) is, which leaves the second term out, is printed at the operating point: where the scenario's load
//! balances the actuator at each pressure, with the scenario's volume outside and with one as large as the largest
//! inside, which the paper holds to be enough.
//!
//! Checked by the tests of the program, `tests/curves.rs`.

mod compare;
mod pressures;

use crate::axis::{CurveAxis, HorizontalAxis as _};
use crate::failure::Failure;
use crate::report::{Data, Table, number, typeset};
use crate::units::{Shown, units};
pub use compare::compare;
use mckibben::force::Statics;
use mckibben::load::Load;
use mckibben::{AbsolutePressure, Actuator, GaugePressure};
use mckibben_plot::{Axis, Colour, Dash, Figure, Legend, Panel, Series, Span};
use mckibben_scenario::{Document, Experiment, Force, Scenario};
pub use pressures::{Pressure, Pressures};

/// Intervals of a curve, and every how many stand in the short table.
const INTERVALS: usize = 120;
const PRINTED: usize = 12;

/// A scenario's actuator at several pressures.
#[derive(Clone, Debug)]
pub struct Curves {
    scenario: Scenario,
    experiment: Experiment,
    pressures: Vec<Pressure>,
    notes: String,
}

/// What a scenario describes; its curves do not depend on the valve's command.
fn built(document: &Document) -> Result<Experiment, Failure> {
    Ok(match document.controlled_experiment()? {
        Some(controlled) => controlled.experiment,
        None => document.experiment()?,
    })
}

/// What a reader of the curves must know, as sentences; empty when there is nothing.
fn notes(scenario: &Scenario, document: &Document) -> String {
    let notes = [beyond_ideal(&scenario.actuator), assumed(document)];
    notes.into_iter().filter(|note| !note.is_empty()).collect::<Vec<_>>().join(" ")
}

/// The assumed numbers of the actuator as a sentence; empty when there are none.
fn assumed(document: &Document) -> String {
    let numbers = document.assumed();
    let of_actuator = numbers.iter().filter(|each| each.parameter.key.starts_with("actuator."));
    let words: Vec<String> =
        of_actuator.map(|each| format!("{} = {}", each.parameter.symbol, typeset(&each.text))).collect();
    if words.is_empty() { String::new() } else { format!("Assumed: {}.", words.join(", ")) }
}

/// What the actuator has beyond the ideal braid as a sentence; empty when that is all.
fn beyond_ideal(actuator: &mckibben_scenario::Actuator) -> String {
    let law = match &actuator.force {
        Force::IdealBraid => None,
        Force::TonduLopez { .. } => Some("law of Tondu & Lopez".to_owned()),
        Force::Sarosi(_) => Some("law of Sárosi".to_owned()),
        Force::MartensBoblan { .. } => Some("law of Martens & Boblan".to_owned()),
        Force::ExtensibleBraid { thread_stiffness } => {
            Some(format!("threads of {} kN/m together", number(1e-3 * thread_stiffness, 1)))
        }
        Force::Bolen { .. } => Some("law of Bolen".to_owned()),
        Force::Polynomial { .. } => Some("polynomial in contraction".to_owned()),
        Force::Map { gauge_pressure, length, .. } => {
            let span = |list: &[f64], factor: f64, decimals| {
                let ends =
                    [list.first(), list.last()].map(|end| number(factor * end.copied().unwrap_or(0.0), decimals));
                ends.join(" to ")
            };
            let (lengths, pressures) = (span(length, 1e3, 1), span(gauge_pressure, 1e-3, 0));
            Some(format!("force map of {lengths} mm and {pressures} kPa, a plane outside"))
        }
    };
    let bladder = actuator.bladder.map(|bladder| format!("{} bladder", bladder.form.name()));
    let thickness = actuator.wall_thickness;
    let wall = (thickness > 0.0).then(|| format!("wall of {} mm", number(1e3 * thickness, 2)));
    let taper = actuator.taper.map(|taper| {
        let (radius, ratio) = (number(1e3 * taper.end_radius, 2), number(taper.length_ratio, 2));
        format!("ends that taper to a radius of {radius} mm, {ratio} times as long as they widen")
    });
    let words: Vec<String> = [law, bladder, wall, taper].into_iter().flatten().collect();
    if words.is_empty() { String::new() } else { format!("Beyond the ideal braid: {}.", words.join("; ")) }
}

/// The panel with what is below zero shaded, if there is any: a braid does not push, so the law says nothing there.
fn below_zero(panel: Panel) -> Panel {
    let least = panel.series.iter().flat_map(|series| &series.y).copied().fold(0.0, f64::min);
    if panel.y.label != "force" || least >= 0.0 {
        return panel;
    }
    // The shade reaches the lower end of the axis.
    let most = panel.series.iter().flat_map(|series| &series.y).copied().fold(0.0, f64::max);
    let least = least - 0.04 * (most - least);
    let panel = panel.span(Span::strip("below zero, where a braid does not push", least, 0.0));
    Panel { y: panel.y.clone().starting_at(least), ..panel }
}

impl Curves {
    /// Of the actuator that a document describes, at given pressures or at those of the scenario: [`Pressures::of_scenario`].
    ///
    /// # Errors
    /// The scenario or a pressure is wrong.
    pub fn of(document: &Document, pressures: Option<&Pressures>) -> Result<Self, Failure> {
        let (scenario, experiment) = (document.scenario()?, built(document)?);
        let own = pressures.is_none().then(|| Pressures::of_scenario(&scenario));
        let pressures = pressures.or(own.as_ref()).map_or_else(Pressures::default, Clone::clone);
        let pressures = pressures.above_vacuum(scenario.air.atmospheric_pressure)?.to_vec();
        let notes = notes(&scenario, document);
        Ok(Self { scenario, experiment, pressures, notes })
    }

    /// The gauge pressures.
    pub fn pressures(&self) -> &[Pressure] {
        &self.pressures
    }

    /// What a reader of the curves must know, as sentences; empty when there is nothing.
    pub fn notes(&self) -> &str {
        &self.notes
    }

    fn actuator(&self) -> &Actuator {
        self.experiment.rig.actuator()
    }

    /// Lengths in m from full contraction to full stretch.
    fn lengths(&self) -> Vec<f64> {
        let limits = self.actuator().limits();
        let (shortest, longest) = (limits.min_length(), limits.max_length());
        (0..=INTERVALS).map(|i| shortest + (longest - shortest) * i as f64 / INTERVALS as f64).collect()
    }

    /// Share by which a length in m lies below the longest.
    fn contraction(&self, length: f64) -> f64 {
        1.0 - length / self.actuator().limits().max_length()
    }

    fn absolute(&self, pressure: &Pressure) -> AbsolutePressure {
        GaugePressure(pressure.gauge).absolute(self.actuator().air().atmosphere())
    }

    /// All numbers: for each pressure a row for each length.
    ///
    /// # Errors
    /// As [`Data::check`].
    pub fn data(&self) -> Result<Data, Failure> {
        let mut data = Data::new(&[
            "gauge_pressure_pa",
            "length_m",
            "contraction",
            "diameter_m",
            "braid_volume_m3",
            "volume_m3",
            "force_n",
            "stiffness_n_m",
            "sealed_stiffness_n_m",
        ]);
        let actuator = self.actuator();
        let characteristic = &actuator.law().law;
        for pressure in &self.pressures {
            let absolute = self.absolute(pressure);
            data.rows.extend(self.lengths().into_iter().map(|length| {
                vec![
                    pressure.gauge,
                    length,
                    self.contraction(length),
                    characteristic.braid.diameter(length),
                    characteristic.volume(length),
                    actuator.volume(length),
                    actuator.static_force(length, absolute.0),
                    actuator.stiffness(length, absolute),
                    actuator.sealed_stiffness(length, absolute),
                ]
            }));
        }
        data.check()?;
        Ok(data)
    }

    /// Force at round parts of the range.
    pub fn table(&self) -> Table {
        let characteristic = &self.actuator().law().law;
        let fixed = ["length mm", "contraction %", "volume cm³"].map(String::from);
        let head = fixed.into_iter().chain(self.pressures.iter().map(|pressure| pressure.label.clone()));
        let rows = self.lengths().into_iter().step_by(PRINTED).map(|length| {
            let forces = self
                .pressures
                .iter()
                .map(|pressure| number(self.actuator().static_force(length, self.absolute(pressure).0), 1));
            let fixed = [
                number(1e3 * length, 2),
                number(100.0 * self.contraction(length), 1),
                number(1e6 * characteristic.volume(length), 3),
            ];
            fixed.into_iter().chain(forces).collect()
        });
        Table {
            caption: "Force in N at rest, without friction, at gauge pressures:".into(),
            head: head.collect(),
            rows: rows.collect(),
        }
    }

    /// A sentence that says what the figure shows.
    pub fn title(over: CurveAxis) -> String {
        format!("Force, stiffness and volume over {} at rest, without friction", over.name())
    }

    /// The horizontal axis.
    fn axis(over: CurveAxis, longest: f64) -> Axis {
        match over {
            CurveAxis::Length => Axis::new("length", units().shown("m", longest).text),
            CurveAxis::Contraction => Axis::new("contraction", "%"),
        }
    }

    /// The horizontal values of the lengths, in the unit of the axis.
    fn over(&self, over: CurveAxis) -> Vec<f64> {
        let shown = units().shown("m", self.longest());
        let value = |length: f64| match over {
            CurveAxis::Length => shown.number(length),
            CurveAxis::Contraction => 100.0 * self.contraction(length),
        };
        self.lengths().into_iter().map(value).collect()
    }

    fn longest(&self) -> f64 {
        self.actuator().limits().max_length()
    }

    /// The units of force, stiffness and volume inside, by their largest values.
    fn shown(&self) -> [Shown; 3] {
        let largest = |of: &dyn Fn(f64, AbsolutePressure) -> f64| {
            let pressures = self.pressures.iter().map(|pressure| self.absolute(pressure));
            let all = pressures.flat_map(|pressure| self.lengths().into_iter().map(move |length| of(length, pressure)));
            all.filter(|value| value.is_finite()).fold(0.0, |largest: f64, value| largest.max(value.abs()))
        };
        let actuator = self.actuator();
        [
            units().shown("N", largest(&|length, pressure| actuator.static_force(length, pressure.0))),
            units().shown("N/m", largest(&|length, pressure| actuator.sealed_stiffness(length, pressure))),
            units().shown("m^3", largest(&|length, _| actuator.law().law.volume(length))),
        ]
    }

    /// Whether (5) and (7) are two curves in a figure: somewhere further apart than a five-hundredth of the greatest, the width of a
    /// line. With a large volume outside they are one.
    fn stiffnesses_differ(&self) -> bool {
        const APART: f64 = 2e-3;
        let (actuator, lengths) = (self.actuator(), self.lengths());
        let pairs = self.pressures.iter().map(|pressure| self.absolute(pressure)).flat_map(|pressure| {
            lengths.iter().map(move |length| {
                [actuator.stiffness(*length, pressure), actuator.sealed_stiffness(*length, pressure)]
            })
        });
        let (mut apart, mut greatest) = (0.0_f64, 0.0_f64);
        for [open, shut] in pairs {
            apart = apart.max((open - shut).abs());
            greatest = greatest.max(open.abs());
        }
        apart > APART * greatest
    }

    /// Force, stiffness and volume inside; the pressures in the units of the rest.
    pub fn figure(&self, over: CurveAxis) -> Figure {
        let (lengths, x) = (self.lengths(), self.over(over));
        let [newtons, stiff, inside] = self.shown();
        let mut force = Panel::new(Axis::new("force", newtons.text.clone()));
        let mut stiffness = Panel::new(Axis::new("stiffness", stiff.text.clone())).legend(Legend::Above);
        let differ = self.stiffnesses_differ();
        for (place, pressure) in self.pressures.iter().enumerate() {
            let colour = Colour::Ramp(place as f64 / (self.pressures.len().max(2) - 1) as f64);
            let absolute = self.absolute(pressure);
            let curve = |label: &str, (unit, y): (&Shown, &dyn Fn(f64) -> f64), dash| {
                let y = lengths.iter().map(|length| unit.number(y(*length))).collect();
                Series::line(label, x.clone(), y).colour(colour).dash(dash)
            };
            // The pressures are labelled in the panel above; one curve of each kind labels the kind.
            let once = |words| if place + 1 == self.pressures.len() { words } else { "" };
            let label = units().given(pressure.gauge, "Pa");
            let of_force = |length: f64| self.actuator().static_force(length, absolute.0);
            force = force.series(curve(&label, (&newtons, &of_force), Dash::Solid));
            let open = if differ { "constant pressure (7)" } else { "constant pressure (7) and valve shut (5)" };
            stiffness =
                stiffness.series(curve(once(open), (&stiff, &|l| self.actuator().stiffness(l, absolute)), Dash::Solid));
            if differ {
                let sealed = |l: f64| self.actuator().sealed_stiffness(l, absolute);
                stiffness = stiffness.series(curve(once("valve shut (5)"), (&stiff, &sealed), Dash::Dashed));
            }
        }
        let characteristic = &self.actuator().law().law;
        let volumes = lengths.iter().map(|length| inside.number(characteristic.volume(*length))).collect();
        let volume = Panel::new(Axis::new("volume inside", inside.text.clone()))
            .series(Series::line("", x.clone(), volumes).colour(Colour::Neutral))
            .height_mm(24.0);
        let figure = Figure::new(Self::axis(over, self.longest())).caption(self.notes.clone()).size_mm(120.0, 44.0);
        figure.panel(below_zero(force)).panel(stiffness).panel(volume)
    }

    /// Where the load balances the actuator at each pressure, and a sentence on how good (6) is there.
    ///
    /// # Errors
    /// None but those of the core.
    pub fn operating_points(&self) -> Result<(Table, String), Failure> {
        let Self { scenario, experiment, pressures, .. } = self;
        let (rig, start) = (&experiment.rig, experiment.start.length);
        let failed = |error: mckibben::Error| Failure::stopped(error.to_string());
        let largest = rig.actuator().law().law.volume(rig.actuator().limits().min_length());
        let mut wide = scenario.open_loop();
        wide.actuator.external_volume = largest;
        let wide = wide.rig().map_err(failed)?;
        let actuator = rig.actuator();
        let limits = actuator.limits();
        let held = match rig.load() {
            Load::Isometric => Some(start),
            // A motion has no one length; the middle of the actuator's range stands for it.
            Load::Prescribed(_) => Some(0.5 * (limits.min_length() + limits.max_length())),
            _ => None,
        };
        let mut rows = Vec::new();
        let mut worst = (1.0_f64, 1.0_f64);
        for pressure in pressures {
            let absolute = GaugePressure(pressure.gauge).absolute(actuator.air().atmosphere());
            let Some(length) = held.or_else(|| rig.equilibrium(absolute).ok()) else {
                let mut row = vec![pressure.label.clone(), "–".to_owned(), "no balance".to_owned()];
                row.resize(8, "–".to_owned());
                rows.push(row);
                continue;
            };
            let place = match length {
                _ if held.is_some() => "held",
                length if length >= limits.max_length() => "taut",
                length if length <= limits.min_length() => "shortest",
                _ => "balanced",
            };
            let (plain, sealed) = (actuator.stiffness(length, absolute), actuator.sealed_stiffness(length, absolute));
            let (ratio, wide_ratio) = (sealed / plain, wide.actuator().sealed_stiffness(length, absolute) / plain);
            if ratio.is_finite() {
                worst = (worst.0.max(ratio), worst.1.max(wide_ratio));
            }
            rows.push(vec![
                pressure.label.clone(),
                number(1e3 * length, 2),
                place.to_owned(),
                number(actuator.static_force(length, absolute.0), 1),
                number(1e-3 * plain, 3),
                number(1e-3 * sealed, 3),
                number(ratio, 3),
                number(wide_ratio, 3),
            ]);
        }
        let head = ["gauge", "length mm", "", "force N", "k (7) N/mm", "k shut (5)", "(5)/(7)", "with V_ext = V_in"];
        let caption = "Operating points, where the load balances the actuator without friction:";
        let caption = match rig.load() {
            Load::Isometric => "Operating points, at the length that is held:",
            Load::Prescribed(_) => "Operating points, in the middle of the range:",
            _ => caption,
        };
        let table = Table { caption: caption.into(), head: head.map(String::from).to_vec(), rows };
        let percent = |ratio: f64| number(100.0 * (1.0 - 1.0 / ratio), 1);
        let words = format!(
            "With the valve shut, (6) leaves out up to {} % of the stiffness here with {} cm³ outside, and up to {} % \
             with {} cm³, the largest volume inside.",
            percent(worst.0),
            number(1e6 * scenario.actuator.external_volume, 2),
            percent(worst.1),
            number(1e6 * largest, 2),
        );
        Ok((table, words))
    }
}
