//! A figure in other units: every place of its data moves with its axis.

use crate::axis::Axis;
use crate::figure::{Extent, Figure, Panel, Reference};

/// What makes the number in another unit of a number in the unit of an axis: `factor · value − zero`.
#[derive(Clone, Debug, PartialEq)]
pub struct Conversion {
    /// The other unit.
    pub unit: String,
    /// How many of it one of the axis's unit is.
    pub factor: f64,
    /// What is taken off, of a scale with an offset zero.
    pub zero: f64,
}

impl Conversion {
    fn apply(&self, value: &mut f64) {
        *value = self.factor * *value - self.zero;
    }

    fn apply_all(&self, values: &mut [f64]) {
        values.iter_mut().for_each(|value| self.apply(value));
    }

    fn axis(&self, axis: &mut Axis) {
        axis.unit.clone_from(&self.unit);
        axis.min.iter_mut().chain(&mut axis.max).for_each(|end| self.apply(end));
        axis.words.iter_mut().for_each(|(at, _)| self.apply(at));
    }
}

impl Figure {
    /// The figure in other units. `choose` gets the unit of each axis and the largest magnitude on it, and returns what to do; an axis
    /// for which it returns nothing stays.
    #[must_use]
    pub fn converted(mut self, choose: &dyn Fn(&str, f64) -> Option<Conversion>) -> Self {
        let largest_x = self.panels.iter().flat_map(Panel::all_x).fold(0.0, larger);
        if let Some(conversion) = choose(&self.x.unit, largest_x) {
            conversion.axis(&mut self.x);
            self.panels.iter_mut().for_each(|panel| panel.convert_x(&conversion));
        }
        for panel in &mut self.panels {
            let largest = panel.all_y().fold(0.0, larger);
            if let Some(conversion) = choose(&panel.y.unit, largest) {
                panel.convert_y(&conversion);
            }
            if let Some(field) = &mut panel.field
                && let Some(conversion) = choose(&field.unit, field.values.iter().copied().fold(0.0, larger))
            {
                conversion.apply_all(&mut field.values);
                field.unit = conversion.unit;
            }
        }
        self
    }
}

/// The larger magnitude, of what is finite.
fn larger(largest: f64, value: f64) -> f64 {
    if value.is_finite() { largest.max(value.abs()) } else { largest }
}

impl Panel {
    fn all_x(&self) -> impl Iterator<Item = f64> + '_ {
        let of_series = self.series.iter().flat_map(|series| series.x.iter().copied());
        of_series.chain(self.field.iter().flat_map(|field| field.x.iter().copied()))
    }

    fn all_y(&self) -> impl Iterator<Item = f64> + '_ {
        let of_series = self.series.iter().flat_map(|series| series.y.iter().copied());
        of_series.chain(self.field.iter().flat_map(|field| field.y.iter().copied()))
    }

    fn convert_x(&mut self, by: &Conversion) {
        self.series.iter_mut().for_each(|series| by.apply_all(&mut series.x));
        self.marks.iter_mut().for_each(|marks| by.apply_all(&mut marks.x));
        self.field.iter_mut().for_each(|field| by.apply_all(&mut field.x));
        let ends = |(from, to): &mut (f64, f64)| {
            by.apply(from);
            by.apply(to);
        };
        self.strips.iter_mut().for_each(|strip| strip.intervals.iter_mut().for_each(ends));
        for span in &mut self.spans {
            match &mut span.length_regime {
                Extent::Horizontal(intervals) => intervals.iter_mut().for_each(ends),
                Extent::Between { x, .. } => by.apply_all(x),
                Extent::Vertical(..) => {}
            }
        }
        for reference in &mut self.references {
            if let Reference::Vertical { x, .. } = reference {
                by.apply(x);
            }
        }
    }

    fn convert_y(&mut self, by: &Conversion) {
        by.axis(&mut self.y);
        self.series.iter_mut().for_each(|series| by.apply_all(&mut series.y));
        self.marks.iter_mut().for_each(|marks| by.apply_all(&mut marks.y));
        self.field.iter_mut().for_each(|field| by.apply_all(&mut field.y));
        for span in &mut self.spans {
            match &mut span.length_regime {
                Extent::Vertical(from, to) => {
                    by.apply(from);
                    by.apply(to);
                }
                Extent::Between { lower, upper, .. } => {
                    by.apply_all(lower);
                    by.apply_all(upper);
                }
                Extent::Horizontal(_) => {}
            }
        }
        for reference in &mut self.references {
            if let Reference::Horizontal { y, .. } = reference {
                by.apply(y);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Colour, Marks, Series, Span, Symbol};

    /// Metres to millimetres and kelvins to degrees: each number of the figure has moved once, whatever it is of.
    #[test]
    fn every_number_moves_with_its_axis() {
        let panel = Panel::new(Axis::new("length", "m").starting_at(0.0).ending_at(0.2))
            .series(Series::line("", vec![0.0, 1.0], vec![0.1, 0.2]))
            .horizontal(0.15, "limit")
            .span(Span::strip("", 0.1, 0.12))
            .span(Span::between("", vec![0.0, 1.0], vec![0.1, 0.1], vec![0.2, 0.2]))
            .marks(Marks::at("", Symbol::Circle, vec![1.0], vec![0.2]));
        let warm = Panel::new(Axis::new("temperature", "K")).series(Series::line("", vec![0.0], vec![300.0]));
        let figure = Figure::new(Axis::new("time", "s")).panel(panel).panel(warm);
        let choose = |unit: &str, _: f64| match unit {
            "m" => Some(Conversion { unit: "mm".to_owned(), factor: 1e3, zero: 0.0 }),
            "K" => Some(Conversion { unit: "°C".to_owned(), factor: 1.0, zero: 273.15 }),
            "s" => Some(Conversion { unit: "ms".to_owned(), factor: 1e3, zero: 0.0 }),
            _ => None,
        };
        let shown = figure.clone().converted(&choose);
        let [first, second] = [&shown.panels[0], &shown.panels[1]];
        assert_eq!((first.y.unit.as_str(), shown.x.unit.as_str(), second.y.unit.as_str()), ("mm", "ms", "°C"));
        assert_eq!((first.y.min, first.y.max), (Some(0.0), Some(200.0)));
        assert_eq!((&first.series[0].x, &first.series[0].y), (&vec![0.0, 1000.0], &vec![100.0, 200.0]));
        assert_eq!(
            first.references,
            [Reference::Horizontal { y: 150.0, label: "limit".to_owned(), colour: Colour::Neutral }]
        );
        assert_eq!(first.spans[0].length_regime, Extent::Vertical(100.0, 120.0));
        assert_eq!((&first.marks[0].x, &first.marks[0].y), (&vec![1000.0], &vec![200.0]));
        assert!((second.series[0].y[0] - 26.85).abs() < 1e-12);
        assert_eq!(figure.clone().converted(&|_, _| None), figure);
    }
}
