//! The figure of a joint's run: angle, pressures and tensions over time, the agonist's valve as bands behind them.

use super::NAMES;
use crate::engine::Kept;
use crate::trajectory_plot::{Bands, POINTS, wanted};
use mckibben::control::Quantity;
use mckibben::plant::{JointEvent, JointPlant};
use mckibben::simulation::EventKind;
use mckibben_plot::{Axis, Dash, Figure, Panel, Series, Span};
use std::f64::consts::PI;

/// The figure of a run.
pub(crate) fn figure(run: &Kept<JointPlant>, title: &str) -> Figure {
    let Kept { plan, trajectory, .. } = run;
    let (goals, rig, duration) = (run.goals(), trajectory.rig(), plan.duration);
    let interval = plan.sample_interval.min(duration / POINTS.0).max(duration / POINTS.1);
    let samples: Vec<_> = trajectory.samples(interval).collect();
    let time: Vec<f64> = samples.iter().map(|sample| sample.time).collect();
    let mut supply = Bands::default();
    supply.see(0.0, trajectory.at(0.0).actuators[0].ports.supply);
    let of_valve = |event: &&JointEvent| event.kind.kind == EventKind::Valve && event.kind.actuator == Some(0);
    for event in trajectory.events().iter().filter(of_valve) {
        supply.see(event.time, event.after.actuators[0].ports.supply);
    }
    supply.see(duration, false);

    let mut angle = Panel::new(Axis::new("angle", "deg"));
    let degrees: Vec<f64> = samples.iter().map(|sample| sample.angle.to_degrees()).collect();
    let (least, greatest) = degrees.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    // A stop is drawn where the curve comes near it; further away it would only flatten the curve.
    let near = 0.15 * (greatest - least).max(0.1);
    for (stop, name) in rig.joint().stops().ends.into_iter().zip(["lower stop", "upper stop"]) {
        if let Some(stop) = stop.map(f64::to_degrees).filter(|stop| (least - near..=greatest + near).contains(stop)) {
            angle = angle.horizontal(stop, name);
        }
    }
    let mut angle = angle.series(Series::line("", time.clone(), degrees));
    if let Some(goal) = goals.iter().find(|goal| goal.quantity == Quantity::Angle) {
        angle = angle.series(wanted(goal, 180.0 / PI));
    }
    let pair = |mut panel: Panel, named: bool, value: &dyn Fn(usize, usize) -> f64| {
        for (index, name) in NAMES.into_iter().enumerate() {
            let values = (0..samples.len()).map(|row| value(row, index)).collect();
            let series = Series::line(if named { name } else { "" }, time.clone(), values);
            panel = panel.series(if index == 0 { series } else { series.dash(Dash::Dashed) });
        }
        panel
    };
    let atmospheres = rig.driven().each_ref().map(|driven| driven.actuator.air().atmosphere().0);
    let regulated = |mut panel: Panel, quantity: Quantity, factor: f64| {
        for goal in goals.iter().filter(|goal| goal.quantity == quantity) {
            // Agonist and antagonist have their own lines; one entry in the legend names both set points.
            let name = if goal.whose == Some(1) { "" } else { "set point" };
            panel = panel.series(Series { label: name.to_owned(), ..wanted(goal, factor) }.dash(Dash::Dotted));
        }
        panel
    };
    let pressure = pair(Panel::new(Axis::new("gauge pressure", "bar")), true, &|row, index| {
        (samples[row].actuators[index].pressure.0 - atmospheres[index]) * 1e-5
    });
    let pressure = regulated(pressure, Quantity::Pressure, 1e-5);
    let tension =
        pair(Panel::new(Axis::new("tension", "N")), false, &|row, index| samples[row].actuators[index].tension);
    let mut panels = vec![angle];
    if let Some(goal) = goals.iter().find(|goal| goal.quantity == Quantity::Stiffness) {
        let panel = Panel::new(Axis::new("stiffness", "N·m/rad"));
        let panel = panel.series(Series::line("", goal.time.clone(), goal.measured.clone()));
        panels.push(panel.series(wanted(goal, 1.0)));
    }
    panels.push(pressure);
    if goals.iter().any(|goal| goal.quantity == Quantity::AirMass) {
        let mass = |row: usize, index: usize| samples[row].actuators[index].air_mass * 1e6;
        let panel = pair(Panel::new(Axis::new("mass of air", "mg")), false, &mass);
        panels.push(regulated(panel, Quantity::AirMass, 1e6));
    }
    panels.push(tension);
    let mut figure = Figure::new(Axis::new("time", "s").starting_at(0.0).ending_at(duration)).title(title);
    for (index, panel) in panels.into_iter().enumerate() {
        let name = if index == 0 { "agonist's supply open" } else { "" };
        let shaded = !supply.intervals.is_empty();
        let panel = if shaded { panel.span(Span::intervals(name, supply.intervals.clone())) } else { panel };
        figure = figure.panel(panel);
    }
    figure.size_mm(120.0, 32.0)
}
