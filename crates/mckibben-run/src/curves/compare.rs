//! The static curves of several actuators over each other, one colour for each.

use super::Curves;
use crate::axis::CurveAxis;
use crate::units::{Shown, units};
use mckibben::force::Statics;
use mckibben_plot::{Axis, Colour, Dash, Figure, Legend, Panel, Series};

/// Patterns that go with the colours.
const DASHES: [Dash; 4] = [Dash::Solid, Dash::Dashed, Dash::DashDot, Dash::LongDash];

/// Force, stiffness at constant pressure and volume inside of several actuators, each with its name, in the units of the first.
pub fn compare(each: &[(&str, &Curves)], over: CurveAxis) -> Figure {
    let Some((_, first)) = each.first() else { return Figure::default() };
    let ([newtons, stiff, inside], lengths) = (first.shown(), units().shown("m", first.longest()));
    let mut force = Panel::new(Axis::new("force", newtons.text.clone())).legend(Legend::Above);
    let mut stiffness = Panel::new(Axis::new("stiffness", stiff.text.clone()));
    let mut volume = Panel::new(Axis::new("volume inside", inside.text.clone())).height_mm(24.0);
    for (index, (label, of)) in each.iter().enumerate() {
        let x: Vec<f64> = match over {
            CurveAxis::Length => of.lengths().into_iter().map(|length| lengths.number(length)).collect(),
            CurveAxis::Contraction => of.over(over),
        };
        let curve = |label: &str, unit: &Shown, y: &dyn Fn(f64) -> f64| {
            let y = of.lengths().into_iter().map(|length| unit.number(y(length))).collect();
            Series::line(label, x.clone(), y).colour(Colour::Category(index)).dash(DASHES[index % DASHES.len()])
        };
        for (place, pressure) in of.pressures.iter().enumerate() {
            let absolute = of.absolute(pressure);
            let label = if place == 0 { label } else { "" };
            force = force.series(curve(label, &newtons, &|length| of.actuator().static_force(length, absolute.0)));
            stiffness = stiffness.series(curve("", &stiff, &|length| of.actuator().stiffness(length, absolute)));
        }
        volume = volume.series(curve("", &inside, &|length| of.actuator().law().law.volume(length)));
    }
    let pressures: Vec<String> = first.pressures.iter().map(|pressure| units().given(pressure.gauge, "Pa")).collect();
    let panels = [force, stiffness, volume].map(super::below_zero);
    let figure = panels.into_iter().fold(Figure::new(Curves::axis(over, first.longest())), Figure::panel);
    figure
        .title(Curves::title(over))
        .note(format!("gauge pressures: {}; stiffness at constant pressure (7)", pressures.join(", ")))
        .size_mm(120.0, 44.0)
}
