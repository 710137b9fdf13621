//! The static curves of several actuators over each other, one colour for each.

use super::Curves;
use crate::axis::CurveAxis;
use mckibben::force::Statics;
use mckibben_plot::{Axis, Colour, Dash, Figure, Legend, Panel, Series};

/// Patterns that go with the colours.
const DASHES: [Dash; 4] = [Dash::Solid, Dash::Dashed, Dash::DashDot, Dash::LongDash];

/// Force, stiffness at constant pressure and volume inside of several actuators, each with its name.
pub fn compare(each: &[(&str, &Curves)], over: CurveAxis) -> Figure {
    let mut force = Panel::new(Axis::new("force", "N")).legend(Legend::Above);
    let mut stiffness = Panel::new(Axis::new("stiffness", "N/m"));
    let mut volume = Panel::new(Axis::new("volume inside", "cm³")).height_mm(24.0);
    for (index, (label, of)) in each.iter().enumerate() {
        let (lengths, x) = (of.lengths(), of.over(over));
        let curve = |label: &str, y: &dyn Fn(f64) -> f64| {
            let y = lengths.iter().map(|length| y(*length)).collect();
            Series::line(label, x.clone(), y).colour(Colour::Category(index)).dash(DASHES[index % DASHES.len()])
        };
        for (place, pressure) in of.pressures.iter().enumerate() {
            let absolute = of.absolute(pressure);
            let label = if place == 0 { label } else { "" };
            force = force.series(curve(label, &|length| of.actuator().static_force(length, absolute.0)));
            stiffness = stiffness.series(curve("", &|length| of.actuator().stiffness(length, absolute)));
        }
        volume = volume.series(curve("", &|length| 1e6 * of.actuator().law().law.volume(length)));
    }
    let pressures: Vec<&str> = each
        .first()
        .map_or(Vec::new(), |(_, of)| of.pressures.iter().map(|pressure| pressure.label.as_str()).collect());
    let panels = [force, stiffness, volume].map(|panel| super::below_zero(panel));
    let figure = panels.into_iter().fold(Figure::new(Curves::axis(over)), Figure::panel);
    figure
        .title(Curves::title(over))
        .note(format!("gauge pressures: {}; stiffness at constant pressure (7)", pressures.join(", ")))
        .size_mm(120.0, 44.0)
}
