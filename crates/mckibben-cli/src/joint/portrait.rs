//! The figure of a joint's run: angle, pressures and tensions over time, the agonist's valve as bands behind them.

use super::NAMES;
use crate::failure::Failure;
use crate::plot::{Axis, Dash, Figure, Panel, Series, Span};
use crate::portrait::{Bands, Format, POINTS, bytes};
use mckibben::simulation::{EventKind, JointTrajectory};
use std::path::Path;

/// Draws a run; the bytes of the file.
///
/// # Errors
/// [`Failure::output`], which names `path`, when the figure cannot be drawn.
pub fn draw(
    trajectory: &JointTrajectory,
    interval: f64,
    title: &str,
    target: (&Path, Format),
) -> Result<Vec<u8>, Failure> {
    bytes(&figure(trajectory, interval, title), target)
}

/// The figure of a run.
pub(crate) fn figure(trajectory: &JointTrajectory, interval: f64, title: &str) -> Figure {
    let duration = trajectory.duration();
    let interval = interval.min(duration / POINTS.0).max(duration / POINTS.1);
    let samples: Vec<_> = trajectory.samples(interval).collect();
    let time: Vec<f64> = samples.iter().map(|sample| sample.time).collect();
    let mut supply = Bands::default();
    supply.see(0.0, trajectory.at(0.0).actuators[0].ports.supply);
    for event in trajectory.events() {
        if event.kind.kind == EventKind::Valve && event.kind.actuator == Some(0) {
            supply.see(event.time, event.after.actuators[0].ports.supply);
        }
    }
    supply.see(duration, false);

    let mut angle = Panel::new(Axis::new("angle", "deg"));
    let degrees: Vec<f64> = samples.iter().map(|sample| sample.angle.to_degrees()).collect();
    let (least, greatest) = degrees.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    // A stop is shown where the curve comes near it; further away it would only flatten the curve.
    let near = 0.15 * (greatest - least).max(0.1);
    for (stop, name) in trajectory.rig().joint().stops().ends.into_iter().zip(["lower stop", "upper stop"]) {
        if let Some(stop) = stop.map(f64::to_degrees).filter(|stop| (least - near..=greatest + near).contains(stop)) {
            angle = angle.horizontal(stop, name);
        }
    }
    let angle = angle.series(Series::line("", time.clone(), degrees));
    let pair = |mut panel: Panel, named: bool, value: &dyn Fn(usize, usize) -> f64| {
        for (index, name) in NAMES.into_iter().enumerate() {
            let values = (0..samples.len()).map(|row| value(row, index)).collect();
            let series = Series::line(if named { name } else { "" }, time.clone(), values);
            panel = panel.series(if index == 0 { series } else { series.dash(Dash::Dashed) });
        }
        panel
    };
    let atmospheres = trajectory.rig().driven().each_ref().map(|driven| driven.actuator.air().atmosphere().0);
    let pressure = pair(Panel::new(Axis::new("gauge pressure", "bar")), true, &|row, index| {
        (samples[row].actuators[index].pressure.0 - atmospheres[index]) * 1e-5
    });
    let tension =
        pair(Panel::new(Axis::new("tension", "N")), false, &|row, index| samples[row].actuators[index].tension);
    let mut figure = Figure::new(Axis::new("time", "s").starting_at(0.0).ending_at(duration)).title(title);
    for (panel, name) in [(angle, "agonist's supply open"), (pressure, ""), (tension, "")] {
        let shaded = !supply.intervals.is_empty();
        let panel = if shaded { panel.span(Span::intervals(name, supply.intervals.clone())) } else { panel };
        figure = figure.panel(panel);
    }
    figure.size_mm(120.0, 32.0)
}
