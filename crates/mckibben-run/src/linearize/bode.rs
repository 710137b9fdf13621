//! The frequency response as a figure: magnitude in dB and phase over a range that the poles choose.

use super::Model;
use super::account::{is_held, left_out};
use super::joint::JointModel;
use super::plant::PlantModel;
use crate::failure::Failure;
use crate::quantities::quantity;
use mckibben::linearize::{Phasor, Pole, Signal, StateSpace};
use mckibben_plot::{Axis, Colour, Figure, Legend, Panel, Series};
use std::f64::consts::{PI, TAU};

/// Points in each decade of frequency.
const POINTS: f64 = 120.0;
/// A factor of ten in dB, and labels of an axis of levels at most.
const DECADE: f64 = 20.0;
const MOST_LEVELS: f64 = 6.0;
/// Decades drawn beyond the slowest and the fastest pole, and at most in all.
const BEYOND: (f64, f64) = (1.0, 6.0);

/// What a figure of a model has.
struct View<'m> {
    system: &'m StateSpace,
    poles: &'m [Pole],
    /// Frequencies in Hz of the pulses that are averaged.
    averaged: Vec<f64>,
    /// The outputs, of which the first two that the model has are drawn.
    outputs: Vec<String>,
    caption: String,
}

/// The figure of one input; the valve's where none is named.
pub(super) fn figure(model: &Model, input: Option<&str>) -> Result<Figure, Failure> {
    let averaged = model.linear.averaged().into_iter().map(|of| of.frequency).collect();
    let outputs = ["length", "pressure", "tension"].map(str::to_owned).to_vec();
    let system = &model.system;
    draw(&View { system, poles: &model.poles, averaged, outputs, caption: caption(model) }, input)
}

/// The figure of one input of a joint; the agonist's valve's where none is named.
pub(super) fn of_joint(model: &JointModel, input: Option<&str>) -> Result<Figure, Failure> {
    let averaged = model.linear.averages().iter().map(|of| of.frequency).collect();
    let outputs = ["angle", "actuator_torque"].map(str::to_owned).to_vec();
    let system = &model.system;
    draw(&View { system, poles: &model.poles, averaged, outputs, caption: model.caption() }, input)
}

/// The figure of one input of a plant; its first where none is named.
pub(super) fn of_plant(model: &PlantModel, input: Option<&str>) -> Result<Figure, Failure> {
    let averaged = model.linear.averages.iter().map(|of| of.frequency).collect();
    let (system, caption) = (&model.system, model.caption());
    draw(&View { system, poles: &model.poles, averaged, outputs: model.drawn(), caption }, input)
}

fn draw(view: &View<'_>, input: Option<&str>) -> Result<Figure, Failure> {
    let system = view.system;
    let names: Vec<&str> = system.inputs.iter().map(|signal| signal.name.as_str()).collect();
    let name = input.or(names.first().copied()).unwrap_or_default();
    let Some(input) = names.iter().position(|known| *known == name) else {
        let title = format!("the model has no input `{name}`");
        return Err(Failure::input(title, format!("give one of {}", names.join(", "))));
    };
    let frequencies = frequencies(view);
    let shown = view.outputs.iter().filter_map(|name| system.outputs.iter().position(|of| of.name == *name)).take(2);
    let mut phase = Panel::new(quarters());
    let (mut figure, mut least, mut greatest) =
        (Figure::new(decades("frequency", "Hz", &frequencies)), 0.0_f64, 0.0_f64);
    for (place, output) in shown.enumerate() {
        let signal = &system.outputs[output];
        let response: Vec<Option<Phasor>> =
            frequencies.iter().map(|frequency| system.response(input, output, TAU * frequency)).collect();
        let magnitude: Vec<f64> = response.iter().map(|g| g.map_or(f64::NAN, |g| g.magnitude())).collect();
        let label = format!("{} over {}", words(&signal.name), words(name));
        let level: Vec<f64> = magnitude.iter().map(|magnitude| 20.0 * magnitude.log10()).collect();
        let axis = decibels(&label, &unit(signal, &system.inputs[input]), &level);
        let colour = Colour::Category(place);
        let panel = Panel::new(axis).series(Series::line("", frequencies.clone(), level).colour(colour));
        figure = figure.panel(lines(view, panel, place == 0));
        let angles = unwrapped(&response);
        for angle in angles.iter().filter(|angle| angle.is_finite()) {
            (least, greatest) = (least.min(*angle), greatest.max(*angle));
        }
        phase = phase.series(Series::line(words(&signal.name), frequencies.clone(), angles).colour(colour));
    }
    phase.y =
        phase.y.starting_at((least / 90.0).floor() * 90.0 - 15.0).ending_at((greatest / 90.0).ceil() * 90.0 + 15.0);
    let title = format!("Frequency response to {}: magnitude and phase", words(name));
    let figure = figure.title(title);
    Ok(figure.panel(lines(view, phase, false).legend(Legend::Above)).size_mm(120.0, 40.0).caption(view.caption.clone()))
}

/// The frequencies of the figure in Hz, equally many in each decade.
fn frequencies(view: &View<'_>) -> Vec<f64> {
    let moving = view.poles.iter().map(|pole| pole.natural_frequency() / TAU).filter(|frequency| *frequency > 0.0);
    let pwm = view.averaged.iter().copied();
    let (low, high) = match extent(moving.chain(pwm)) {
        Some((least, greatest)) => {
            let high = (greatest.log10() + BEYOND.0).ceil();
            ((least.log10() - BEYOND.0).floor().max(high - BEYOND.1), high)
        }
        None => (-2.0, 3.0),
    };
    let count = ((high - low) * POINTS).ceil();
    (0..=count as usize).map(|n| 10_f64.powf(low + (high - low) * n as f64 / count)).collect()
}

/// The least and the greatest of the values that have a logarithm.
fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.filter(|value| *value > 0.0 && value.is_finite()).fold(None, |ends, value| {
        let (least, greatest) = ends.unwrap_or((value, value));
        Some((least.min(value), greatest.max(value)))
    })
}

/// Lines at the natural frequency of each pair of poles and at the PWM's frequency.
fn lines(view: &View<'_>, mut panel: Panel, named: bool) -> Panel {
    let pairs = view.poles.iter().filter(|pole| pole.imaginary > 0.0).map(Pole::natural_frequency);
    let mut marked: Vec<(f64, String)> = pairs.map(|rate| (rate / TAU, quantity(rate / TAU, "Hz"))).collect();
    for pulses in &view.averaged {
        if marked.iter().all(|(frequency, _)| frequency != pulses) {
            marked.push((*pulses, "PWM".to_owned()));
        }
    }
    for (frequency, words) in marked {
        panel = panel.vertical(frequency, if named { words } else { String::new() });
    }
    panel
}

/// A logarithmic axis of whole decades around values.
fn decades(label: &str, unit: &str, values: &[f64]) -> Axis {
    let axis = Axis::logarithmic(label, unit);
    let Some((least, greatest)) = extent(values.iter().copied()) else { return axis };
    let (low, high) = (least.log10().floor(), greatest.log10().ceil());
    axis.starting_at(10_f64.powf(low)).ending_at(10_f64.powf(high.max(low + 1.0)))
}

/// An axis of levels in dB of a unit, with round numbers at multiples of 20 dB, which is a decade.
fn decibels(label: &str, unit: &str, levels: &[f64]) -> Axis {
    let finite = levels.iter().copied().filter(|level| level.is_finite());
    let (least, greatest) = finite.fold((f64::MAX, f64::MIN), |(l, g), level| (l.min(level), g.max(level)));
    let unit = if unit.is_empty() { "dB".to_owned() } else { format!("dB re 1 {unit}") };
    let axis = Axis::new(label, unit);
    if least > greatest {
        return axis;
    }
    let (low, high) = ((least / DECADE).floor(), (greatest / DECADE).ceil().max((least / DECADE).floor() + 1.0));
    let step = [1.0, 2.0, 3.0, 5.0, 10.0].into_iter().find(|step| (high - low) / step <= MOST_LEVELS).unwrap_or(20.0);
    let first = (low / step).ceil();
    let count = ((high / step).floor() - first).max(0.0) as usize;
    let levels = (0..=count).map(|n| DECADE * step * (first + n as f64));
    let words = levels.map(|level| (level, format!("{level:.0}").replace('-', "−")));
    axis.starting_at(DECADE * low).ending_at(DECADE * high).words(words)
}

/// An axis of angles with a word at every quarter turn.
fn quarters() -> Axis {
    let words = (-8..=8).map(|quarter| (f64::from(90 * quarter), format!("{}", 90 * quarter).replace('-', "−")));
    Axis::new("phase", "°").words(words)
}

/// Angles in degrees without the jumps of a whole turn.
fn unwrapped(response: &[Option<Phasor>]) -> Vec<f64> {
    let (mut turns, mut last) = (0.0, None);
    let angle = response.iter().map(|phasor| {
        let Some(phase) = phasor.map(|phasor| phasor.phase()) else { return f64::NAN };
        let before = last.replace(phase).unwrap_or(phase);
        turns -= ((phase - before) / TAU).round();
        (phase + TAU * turns) * 180.0 / PI
    });
    angle.collect()
}

fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// The unit of an output over that of an input.
fn unit(output: &Signal, input: &Signal) -> String {
    let typeset = |unit: &str| unit.replace('*', "·");
    let (of, per) = (typeset(output.unit), typeset(input.unit));
    match per.as_str() {
        "" => of,
        unit if unit.contains(['/', '·']) => format!("{of}/({unit})"),
        unit => format!("{of}/{unit}"),
    }
}

fn caption(model: &Model) -> String {
    let point = &model.linear.point;
    let valve = match model.linear.averaged() {
        Some(averaged) => format!("duty {:.3} at {}", averaged.duty, quantity(averaged.frequency, "Hz")),
        None if model.linear.is_driven() => "valve by its command".to_owned(),
        None => "valve held shut".to_owned(),
    };
    let coulomb = if model.oscillation.is_none() && is_held(model.linear.plant.coulomb_bounds(0)) {
        ", sliding without Coulomb friction"
    } else {
        ""
    };
    format!(
        "At {} gauge and {}, {valve}{coulomb}{}.",
        quantity(point.gauge_pressure().0, "Pa"),
        quantity(point.state.length, "m"),
        left_out(&model.delays)
    )
}
