//! A quantity over the plane: its cells, and the bar beside the axes that says what their colours mean.

use super::axis::{Axis, Scale};
use super::draw::Frame;
use super::figure::Field;
use super::layout::{LABEL_SIZE, LEADING, ROW, TICK, TICK_GAP, TICK_SIZE, words};
use super::range::Range;
use super::scene::{Anchor, Area, Ink, Outline, Scene, Step, Words};
use super::text::Faces;
use super::ticks::{Ticks, ticks};

/// From the axes to the bar.
const GAP: f64 = 6.0;
/// The width of the bar.
const WIDTH: f64 = 7.0;
/// How far a cell reaches under the next, so that no ground shows between them.
const OVERLAP: f64 = 0.4;
/// Both signs are shown from this part of the larger magnitude on: less is rounding around zero.
const TWO_SIGNS: f64 = 0.02;
/// Positive values over more than these decades have a logarithmic scale.
const DECADES: f64 = 2.0;
/// Half the size of the cross in a cell without a value.
const CROSS: f64 = 1.6;

/// The scale of a field: logarithmic for positive values over many decades, symmetrical about zero for values of two signs.
pub(super) struct Bar {
    range: Range,
    diverges: bool,
    ticks: Ticks,
    label: Vec<String>,
    /// The room that it needs beside the axes.
    pub(super) width: f64,
}

impl Bar {
    /// The bar of a field beside axes of this height.
    pub(super) fn new(field: &Field, height: f64, faces: &Faces) -> Self {
        let finite = field.values.iter().copied().filter(|value| value.is_finite());
        let length_regime = finite.fold(None, |length_regime: Option<(f64, f64)>, value| {
            Some(length_regime.map_or((value, value), |(low, high)| (low.min(value), high.max(value))))
        });
        let (least, greatest) = length_regime.unwrap_or((0.0, 0.0));
        let largest = greatest.max(-least);
        let diverges = greatest > TWO_SIGNS * largest && -least > TWO_SIGNS * largest;
        let axis = match least > 0.0 && (greatest / least).log10() > DECADES {
            true => Axis::logarithmic(&field.label, &field.unit),
            false => Axis::new(&field.label, &field.unit),
        };
        let length_regime = if diverges { Some((-largest, largest)) } else { length_regime };
        let range = Range::new(length_regime, &axis, 0.0);
        let ticks = ticks(&axis, range, height, ROW);
        let numbers = ticks.at.iter().map(|tick| faces.width(&tick.1, TICK_SIZE, false)).fold(0.0, f64::max);
        let label = faces.wrap(&ticks.label, LABEL_SIZE, false, height + 4.0);
        let words = 3.5 + label.len() as f64 * LABEL_SIZE * LEADING;
        Self { range, diverges, ticks, label, width: GAP + WIDTH + TICK + TICK_GAP + numbers + words }
    }

    fn ink(&self, value: f64) -> Ink {
        // A float becomes an integer by saturation.
        self.ink_at((self.range.place(value) * 255.0).round() as u8)
    }

    fn ink_at(&self, place: u8) -> Ink {
        if self.diverges { Ink::Diverging(place) } else { Ink::Scale(place) }
    }

    /// Draws the bar to the right of the axes.
    pub(super) fn draw(&self, scene: &mut Scene, axes: Area, faces: &Faces) {
        let left = axes.right + GAP;
        let bar = Area { left, right: left + WIDTH, ..axes };
        for place in 0..=255u8 {
            let bottom = bar.bottom - f64::from(place) / 256.0 * bar.height();
            let top = bar.bottom - (f64::from(place) + 1.0) / 256.0 * bar.height();
            let mut slice = Outline::filled(self.ink_at(place), 1.0);
            // Each reaches under the next, so that no ground shows between them.
            slice.rectangle(Area { top: (top - OVERLAP).max(bar.top), bottom, ..bar });
            scene.outline(slice);
        }
        let mut lines = Outline::stroked(Ink::Axis, 0.7, &[]);
        lines.rectangle(bar);
        let mut widest = 0.0_f64;
        for (value, label) in &self.ticks.at {
            let y = bar.bottom - self.range.place(*value) * bar.height();
            lines.polyline(&[[bar.right, y], [bar.right + TICK, y]]);
            let at = [bar.right + TICK + TICK_GAP, y + 0.36 * TICK_SIZE];
            widest = widest.max(faces.width(label, TICK_SIZE, false));
            scene.words(words(label.clone(), at, Anchor::Start, TICK_SIZE));
        }
        scene.outline(lines);
        let start = bar.right + TICK + TICK_GAP + widest + 3.5;
        for (i, line) in self.label.iter().enumerate() {
            let at = [start + (i as f64 + 0.75) * LABEL_SIZE * LEADING, 0.5 * (bar.top + bar.bottom)];
            scene.words(Words { rotated: true, ..words(line.clone(), at, Anchor::Middle, LABEL_SIZE) });
        }
    }
}

/// Draws the cells of a field; those without a value are crossed.
pub(super) fn draw(scene: &mut Scene, field: &Field, bar: &Bar, frame: &Frame<'_>) {
    let place = |edges: Vec<f64>, on_page: &dyn Fn(f64) -> f64| edges.into_iter().map(on_page).collect::<Vec<f64>>();
    let area = frame.area;
    let columns = place(edges(&field.x, frame.x.scale), &|x| frame.page_x(x).clamp(area.left, area.right));
    let rows = place(edges(&field.y, frame.y.scale), &|y| frame.page_y(y).clamp(area.top, area.bottom));
    let mut crosses = Outline::stroked(Ink::Muted, 0.5, &[]);
    let (left_out, below) = (absent(&field.x, frame.x.scale), absent(&field.y, frame.y.scale));
    for (row, values) in field.values.chunks(field.x.len().max(1)).skip(below).enumerate() {
        let Some(&[bottom, top]) = rows.get(row..row + 2).and_then(|edges| edges.first_chunk()) else { break };
        let mut column = 0;
        // Neighbours of one colour are one rectangle.
        for run in values[left_out..].chunk_by(|a, b| a.is_finite() && b.is_finite() && bar.ink(*a) == bar.ink(*b)) {
            let (left, right) = (columns[column], columns[column + run.len()]);
            column += run.len();
            if run[0].is_finite() {
                let mut cell = Outline::filled(bar.ink(run[0]), 1.0);
                // Those drawn later, to the right and above, cover what reaches under them; where none is, there is an end.
                let at = left_out + column - run.len();
                let over = |from: usize, to: usize, row: usize| {
                    let start = (row + below) * field.x.len();
                    (from..to).all(|column| {
                        column < field.x.len()
                            && field.values.get(start + column).is_some_and(|value| value.is_finite())
                    })
                };
                let right = if over(at + run.len(), at + run.len() + 1, row) { right + OVERLAP } else { right };
                let top = if over(at, at + run.len(), row + 1) { top - OVERLAP } else { top };
                let (right, top) = (right.min(area.right), top.max(area.top));
                cell.rectangle(Area { left, top, right, bottom });
                scene.outline(cell);
            } else {
                let ([x, y], r) = ([0.5 * (left + right), 0.5 * (top + bottom)], CROSS);
                crosses.steps.extend([Step::Move([x - r, y - r]), Step::Line([x + r, y + r])]);
                crosses.steps.extend([Step::Move([x - r, y + r]), Step::Line([x + r, y - r])]);
            }
        }
    }
    scene.outline(crosses);
}

/// How many of rising centres have no place on a scale: those have no cell.
fn absent(centres: &[f64], scale: Scale) -> usize {
    centres.iter().take_while(|centre| !scale.admits(**centre)).count()
}

/// The edges of cells around rising centres: half way on the scale to the neighbours, and as far beyond the outer ones.
pub(super) fn edges(centres: &[f64], scale: Scale) -> Vec<f64> {
    let centres = &centres[absent(centres, scale)..];
    let (Some(first), Some(last)) = (centres.first(), centres.last()) else { return Vec::new() };
    let half = |pair: &[f64]| 0.5 * (scale.coordinate(pair[1]) - scale.coordinate(pair[0]));
    let beyond = |from: f64, by: f64| scale.value(scale.coordinate(from) + by);
    let lone = if *first == 0.0 { 0.5 } else { 0.05 * first.abs() };
    let (low, high) = match centres {
        [.., a, b] => (beyond(*first, -half(&centres[..2])), beyond(*last, half(&[*a, *b]))),
        _ => (first - lone, last + lone),
    };
    let inner = centres.windows(2).map(|pair| beyond(pair[0], half(pair)));
    std::iter::once(low).chain(inner).chain([high]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_meet_half_way() {
        assert_eq!(edges(&[1.0, 2.0, 4.0], Scale::Linear), [0.5, 1.5, 3.0, 5.0]);
        assert_eq!(edges(&[0.0], Scale::Linear), [-0.5, 0.5]);
        assert!(edges(&[], Scale::Linear).is_empty());
        let ratios = edges(&[-1.0, 0.0, 1.0, 4.0, 16.0], Scale::Logarithmic);
        assert!(ratios.iter().zip([0.5, 2.0, 8.0, 32.0]).all(|(edge, expected)| (edge - expected).abs() < 1e-13));
        assert_eq!((ratios.len(), edges(&[-1.0, 0.0], Scale::Logarithmic)), (4, Vec::new()));
    }
}
