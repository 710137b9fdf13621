//! The figure of a plant's run: what moves, the pressures, and the tensions, over time.

use super::PlantOutcome;
use crate::closed_loop::Goal;
use crate::trajectory_plot::{POINTS, wanted};
use mckibben::control::Quantity;
use mckibben::plant::PlantSample;
use mckibben_plot::{Axis, Colour, Dash, Figure, Panel, Series};
use std::f64::consts::PI;

/// The figure.
pub(crate) fn figure(run: &PlantOutcome, title: &str) -> Figure {
    let of = &run.experiment;
    let (duration, interval) = (of.run.duration, of.run.sample_interval);
    let interval = interval.min(duration / POINTS.0).max(duration / POINTS.1);
    let samples: Vec<PlantSample> = run.trajectory.samples(interval).collect();
    let time: Vec<f64> = samples.iter().map(|sample| sample.time).collect();
    let atmosphere = of.plant.network().atmosphere;
    let lines = |mut panel: Panel, names: &[&str], value: &dyn Fn(&PlantSample, usize) -> f64| {
        for (index, name) in names.iter().enumerate() {
            let values = samples.iter().map(|sample| value(sample, index)).collect();
            panel = panel.series(Series::line(*name, time.clone(), values).colour(Colour::Category(index)));
        }
        panel
    };
    // Set points stand dotted in the colour of what they are of.
    let goals: Vec<(&str, &Goal)> = match &run.control {
        Some(closed) => closed.names.iter().map(String::as_str).zip(&closed.goals).collect(),
        None => Vec::new(),
    };
    let with_goals = |mut panel: Panel, names: &[&str], quantity: Quantity, factor: f64| {
        for (name, goal) in goals.iter().filter(|(_, goal)| goal.quantity == quantity) {
            let Some(index) = names.iter().position(|known| known == name) else { continue };
            let series = Series { label: String::new(), ..wanted(goal, factor) };
            panel = panel.series(series.colour(Colour::Category(index)).dash(Dash::Dotted));
        }
        panel
    };
    let (angles, lengths): (Vec<_>, Vec<_>) = of.coordinates().into_iter().partition(|of| of.is_angle);
    let mut panels = Vec::new();
    if !angles.is_empty() {
        let names: Vec<&str> = angles.iter().map(|of| of.name.as_str()).collect();
        let panel = lines(Panel::new(Axis::new("angle", "deg")), &names, &|sample, index| {
            let of = &angles[index];
            sample.mechanisms[of.mechanism].position[of.index].to_degrees()
        });
        panels.push(with_goals(panel, &names, Quantity::Angle, 180.0 / PI));
    }
    if !lengths.is_empty() {
        let names: Vec<&str> = lengths.iter().map(|of| of.name.as_str()).collect();
        panels.push(lines(Panel::new(Axis::new("position", "mm")), &names, &|sample, index| {
            let of = &lengths[index];
            sample.mechanisms[of.mechanism].position[of.index] * 1e3
        }));
    }
    let names: Vec<&str> = of.names.actuators.iter().map(String::as_str).collect();
    let is_alone = |mechanism: usize| of.names.mechanisms[mechanism].name.is_none();
    let alone: Vec<usize> = (0..names.len()).filter(|i| is_alone(of.plant.actuators()[*i].mechanism)).collect();
    if !alone.is_empty() {
        let names: Vec<&str> = alone.iter().map(|index| names[*index]).collect();
        let panel = lines(Panel::new(Axis::new("length", "mm")), &names, &|sample, index| {
            sample.actuators[alone[index]].distance * 1e3
        });
        panels.push(with_goals(panel, &names, Quantity::Length, 1e3));
    }
    // One legend names the actuators' lines in all panels.
    let unnamed = vec![""; names.len()];
    let shown = if alone.len() == names.len() { &unnamed } else { &names };
    let panel = lines(Panel::new(Axis::new("gauge pressure", "bar")), shown, &|sample, index| {
        (sample.actuators[index].pressure.0 - atmosphere) * 1e-5
    });
    panels.push(with_goals(panel, &names, Quantity::Pressure, 1e-5));
    let panel =
        lines(Panel::new(Axis::new("tension", "N")), &unnamed, &|sample, index| sample.actuators[index].tension);
    panels.push(with_goals(panel, &names, Quantity::Force, 1.0));
    // What does not change is not worth a curve.
    let changes = |node: usize| {
        let first = samples.first().map_or(0.0, |sample| sample.nodes[node].pressure.0);
        samples.iter().any(|sample| sample.nodes[node].pressure.0 != first)
    };
    let nodes: Vec<(&str, usize)> =
        of.names.nodes.iter().map(|(name, node)| (name.as_str(), *node)).filter(|(_, node)| changes(*node)).collect();
    if !nodes.is_empty() {
        let names: Vec<&str> = nodes.iter().map(|(name, _)| *name).collect();
        panels.push(lines(Panel::new(Axis::new("supply, gauge", "bar")), &names, &|sample, index| {
            (sample.nodes[nodes[index].1].pressure.0 - atmosphere) * 1e-5
        }));
    }
    let figure = Figure::new(Axis::new("time", "s").starting_at(0.0).ending_at(duration)).title(title);
    panels.into_iter().fold(figure, Figure::panel).size_mm(120.0, 32.0)
}
