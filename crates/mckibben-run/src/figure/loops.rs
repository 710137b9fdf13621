//! Tension over length: the loops of hysteresis, and beside them the loops less their secant, which is so much steeper than they are
//! wide that it hides them.

use super::Picture;
use super::choice::{Run, extremes};
use super::quantity::{Of, shown, tolerance};
use mckibben_plot::{Axis, Colour, Figure, Panel, Series, SideBySide};

/// Lengths in m and tensions in N of a run.
fn columns<'s>(run: &Run<'s>) -> Option<(&'s [f64], &'s [f64])> {
    let of = |quantity: &str| {
        let is_it = |of: &Of| of.place.is_empty() && of.quantity == quantity;
        run.source.columns.iter().find(|column| is_it(&column.of)).map(|column| &column.values[..])
    };
    Some((of("length")?, of("tension")?))
}

/// The straight line between the shortest and the longest, as the tension at a length.
fn secant(lengths: &[f64], tensions: &[f64]) -> impl Fn(f64) -> f64 {
    let at = |better: fn(f64, f64) -> bool| {
        let mut best = 0;
        for (index, length) in lengths.iter().enumerate() {
            if better(*length, lengths[best]) {
                best = index;
            }
        }
        (lengths[best], tensions[best])
    };
    let ((short, low), (long, high)) = (at(|a, b| a < b), at(|a, b| a > b));
    move |length| low + (high - low) * (length - short) / (long - short)
}

/// The loops of runs of one actuator each.
pub(super) fn draw(runs: &[Run<'_>], title: &str) -> Picture {
    let tensions = runs.iter().filter_map(columns).flat_map(|(_, tensions)| tensions);
    let (low, high) = extremes(tensions);
    let force = shown("N", low.abs().max(high.abs()));
    let panel = |label: &str| Panel::new(Axis::new(label, force.text.clone()));
    let (mut whole, mut less, mut moves) = (panel("tension"), panel("tension less secant"), true);
    let lengths = runs.iter().filter_map(columns).flat_map(|(lengths, _)| lengths);
    let (low, high) = extremes(lengths);
    let shown = shown("m", low.abs().max(high.abs()));
    for (index, run) in runs.iter().enumerate() {
        let Some((lengths, tensions)) = columns(run) else { continue };
        let (low, high) = extremes(lengths);
        moves &= high - low > tolerance(1e-6, high.abs());
        let x: Vec<f64> = lengths.iter().map(|length| shown.number(*length)).collect();
        let secant = secant(lengths, tensions);
        let rest =
            lengths.iter().zip(tensions).map(|(length, tension)| force.number(tension - secant(*length))).collect();
        let series = |y: Vec<f64>| Series::line(run.label, x.clone(), y).colour(Colour::Category(index));
        whole = whole.series(series(tensions.iter().map(|tension| force.number(*tension)).collect()));
        less = less.series(Series { label: String::new(), ..series(rest) });
    }
    let figure = |panel: Panel| Figure::new(Axis::new("length", shown.text.clone())).panel(panel);
    if !moves {
        return Picture::One(Box::new(figure(whole).title(title).size_mm(120.0, 80.0)));
    }
    let figures = vec![figure(whole).size_mm(88.0, 62.0), figure(less).size_mm(88.0, 62.0)];
    Picture::SideBySide(SideBySide { title: title.to_owned(), figures, ..SideBySide::default() })
}

#[cfg(test)]
mod tests {
    use super::secant;

    #[test]
    fn the_secant_passes_through_the_ends() {
        let (lengths, tensions) = ([2.0, 1.0, 4.0, 3.0], [5.0, 1.0, 7.0, 0.0]);
        let of = secant(&lengths, &tensions);
        assert_eq!([of(1.0), of(4.0), of(2.0)], [1.0, 7.0, 3.0]);
    }
}
