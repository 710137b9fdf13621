//! One panel, from the back to the front: spans, grid, reference lines, axes, series, marks, words on the lines.

use super::axis::Scale;
use super::decimate::{COLUMN, chord, clip, clip_polygon, reduce, runs, staircase, thin};
use super::figure::{Colour, Extent, Marks, Panel, Reference, Series, Span, Style};
use super::layout::{TICK, TICK_GAP, TICK_SIZE, words};
use super::legend::{
    End, LINE, MARK, SHADE, STRIP, STRIP_ROW, STRIP_SHADE, dash, draw_marks, draw_points, rule, symbol,
};
use super::range::Range;
use super::scene::{Anchor, Area, Ink, Outline, Point, Scene, Step, Words};
use super::text::Faces;
use super::ticks::Ticks;

/// The size of the words on reference lines.
const REFERENCE_SIZE: f64 = 6.6;
/// The radius of the dots of a cloud.
const DOT: f64 = 0.8;
/// Points are kept this close to the page, so that a fixed axis over distant data leaves numbers that can be clipped.
const FAR: f64 = 1e6;
/// More intervals than this per column of the page are drawn by how much of the column they cover.
const DENSE: f64 = 0.5;
/// The size of minor ticks and the width of their lines, as a share of those of ticks with labels.
const MINOR: f64 = 0.6;
/// The least width of a bar of a strip.
const THINNEST: f64 = 0.4;
/// The steps of such a shade.
const SHADES: usize = 8;

/// The axes of a panel and where they stand.
pub(super) struct Frame<'a> {
    pub(super) area: Area,
    pub(super) x: Range,
    pub(super) y: Range,
    pub(super) x_ticks: &'a Ticks,
    pub(super) y_ticks: &'a Ticks,
    /// Whether the horizontal ticks have labels: those of the lowest panel.
    pub(super) numbered: bool,
}

impl Frame<'_> {
    pub(super) fn page_x(&self, x: f64) -> f64 {
        (self.area.left + self.x.place(x) * self.area.width()).clamp(-FAR, FAR)
    }

    pub(super) fn page_y(&self, y: f64) -> f64 {
        (self.area.bottom - self.y.place(y) * self.area.height()).clamp(-FAR, FAR)
    }

    /// Where a point of the data stands, if it has a place on both scales.
    fn page(&self, x: f64, y: f64) -> Option<Point> {
        let admitted = self.x.scale.admits(x) && self.y.scale.admits(y);
        admitted.then(|| [self.page_x(x), self.page_y(y)])
    }
}

/// Draws a panel without its legend and labels.
pub(super) fn panel(scene: &mut Scene, panel: &Panel, frame: &Frame<'_>, faces: &Faces) {
    for span in &panel.spans {
        draw_span(scene, span, frame);
    }
    // Lines across the cells of a field would be read as edges of it.
    if panel.field.is_none() {
        grid(scene, frame);
    }
    rules(scene, panel, frame);
    axes(scene, frame);
    for series in &panel.series {
        draw_series(scene, panel, series, frame);
    }
    let mut taken = Vec::new();
    for marks in &panel.marks {
        let places = places(panel, marks, frame);
        let moved = if marks.stay {
            taken.extend(&places);
            places
        } else {
            let (moved, leaders) = apart(&places, &mut taken, frame.area);
            scene.outline(leaders);
            moved
        };
        draw_marks(scene, marks.colour.into(), (marks.symbol, marks.filled), &moved);
    }
    for (row, strip) in panel.strips.iter().rev().enumerate() {
        let bottom = frame.area.top - 1.5 - row as f64 * STRIP_ROW;
        let rows = Area { top: bottom - STRIP, bottom, ..frame.area };
        draw_intervals(scene, (strip.colour.into(), STRIP_SHADE), &strip.intervals, (frame, rows));
    }
    rule_words(panel, frame, faces).0.into_iter().for_each(|words| scene.words(words));
}

/// Where the curves of a panel end on the right, for names beside them.
pub(super) fn ends(panel: &Panel, frame: &Frame<'_>) -> Vec<End> {
    let named = panel.series.iter().filter(|s| !s.label.trim().is_empty());
    let end = |s: &Series| {
        let (lines, points) = shape(s, frame);
        let at = lines.into_iter().flatten().chain(points).max_by(|a, b| a[0].total_cmp(&b[0]))?;
        Some(End { at, ink: s.colour.into(), label: s.label.clone() })
    };
    named.filter_map(end).collect()
}

/// What a series looks like within the axes: its lines, then its points.
fn shape(series: &Series, frame: &Frame<'_>) -> (Vec<Vec<Point>>, Vec<Point>) {
    let runs = runs(&series.x, &series.y, |x, y| frame.page(x, y));
    let path = |run: &Vec<Point>| match series.style {
        Style::Steps => staircase(&reduce(run)),
        _ => reduce(run),
    };
    let lines = match series.style {
        Style::Points | Style::Dots => Vec::new(),
        _ => runs.iter().flat_map(|run| clip(&path(run), frame.area)).collect(),
    };
    let points = match series.style {
        Style::Line | Style::Steps => Vec::new(),
        _ => thin(runs.into_iter().flatten().filter(|p| frame.area.contains(*p))),
    };
    (lines, points)
}

fn draw_series(scene: &mut Scene, panel: &Panel, series: &Series, frame: &Frame<'_>) {
    let ink: Ink = series.colour.into();
    let (lines, points) = shape(series, frame);
    let mut outline = Outline::stroked(ink, LINE, dash(panel, series));
    let mut dots = Outline::filled(ink, 1.0);
    for line in &lines {
        match line.as_slice() {
            // A point alone between gaps has no line; it is shown as a dot a little heavier than the line.
            [dot] => dots.steps.push(Step::Disc(*dot, 0.9 * LINE)),
            _ => outline.polyline(line),
        }
    }
    scene.outline(outline);
    scene.outline(dots);
    if series.style == Style::Dots {
        let mut cloud = Outline::filled(ink, 1.0);
        cloud.steps = points.into_iter().map(|point| Step::Disc(point, DOT)).collect();
        scene.outline(cloud);
    } else if !points.is_empty() {
        draw_points(scene, ink, symbol(series.colour), &points);
    }
}

/// Where events stand: on their values, or along the upper edge outside the axes, above the strips.
fn places(panel: &Panel, marks: &Marks, frame: &Frame<'_>) -> Vec<Point> {
    let area = frame.area;
    if marks.y.is_empty() {
        let on_page = marks.x.iter().filter(|x| x.is_finite()).map(|x| frame.page_x(*x));
        let strips = panel.strips.len() as f64 * STRIP_ROW + if panel.strips.is_empty() { 0.0 } else { 1.5 };
        let y = area.top - 3.4 - strips;
        return thin(on_page.filter(|x| (area.left..=area.right).contains(x)).map(|x| [x, y]));
    }
    let points = runs(&marks.x, &marks.y, |x, y| frame.page(x, y)).concat();
    thin(points.into_iter().filter(|p| area.contains(*p)))
}

/// Marks beside those that stand where they would: above, or below where there is no room above. Also the lines from where
/// they belong.
pub(super) fn apart(points: &[Point], taken: &mut Vec<Point>, area: Area) -> (Vec<Point>, Outline) {
    const STEP: f64 = 2.0 * MARK + 1.6;
    let mut leaders = Outline::stroked(Ink::Muted, 0.5, &[]);
    let free = |at: Point, taken: &[Point]| taken.iter().all(|other| distance(*other, at) >= STEP - 0.1);
    let moved = points.iter().map(|point| {
        let places = (0..12).flat_map(|n| [f64::from(n), -f64::from(n)]).map(|n| [point[0], point[1] - n * STEP]);
        let fits = |at: &Point| *at == *point || (area.top..=area.bottom).contains(&at[1]);
        let at = places.filter(fits).find(|at| free(*at, taken)).unwrap_or(*point);
        if at != *point {
            leaders.polyline(&[*point, at]);
        }
        taken.push(at);
        at
    });
    (moved.collect(), leaders)
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn draw_span(scene: &mut Scene, span: &Span, frame: &Frame<'_>) {
    let (ink, area) = (Ink::from(span.colour), frame.area);
    let mut shade = Outline::filled(ink, SHADE);
    match &span.length_regime {
        Extent::Vertical(from, to) => {
            let (a, b) = (frame.page_y(*from), frame.page_y(*to));
            let (top, bottom) = (a.min(b).max(area.top), a.max(b).min(area.bottom));
            if top < bottom {
                shade.rectangle(Area { top, bottom, ..area });
            }
        }
        Extent::Between { x, lower, upper } => {
            // Both edges must be numbers, or the strip has no width there.
            let both: Vec<f64> = lower.iter().zip(upper).map(|(l, u)| l + u).collect();
            for range in stretches(x, &both, frame.x.scale) {
                let edge = |y: &[f64]| -> Vec<Point> {
                    let run: Vec<Point> = range.clone().map(|i| [frame.page_x(x[i]), frame.page_y(y[i])]).collect();
                    reduce(&run)
                };
                let mut polygon = edge(upper);
                polygon.extend(edge(lower).into_iter().rev());
                let polygon = clip_polygon(&polygon, area);
                if polygon.len() > 2 {
                    shade.polygon(&polygon);
                }
            }
        }
        Extent::Horizontal(intervals) => {
            return draw_intervals(scene, (ink, SHADE), intervals, (frame, area));
        }
    }
    scene.outline(shade);
}

/// The index ranges in which x has a place on its scale and y is a number.
fn stretches(x: &[f64], y: &[f64], scale: Scale) -> Vec<std::ops::Range<usize>> {
    let fine: Vec<bool> = x.iter().zip(y).map(|(x, y)| scale.admits(*x) && y.is_finite()).collect();
    let mut start = 0;
    let mut found = Vec::new();
    for piece in fine.chunk_by(|a, b| a == b) {
        if piece[0] {
            found.push(start..start + piece.len());
        }
        start += piece.len();
    }
    found
}

/// Shades intervals of x within an area that is as wide as the axes.
fn draw_intervals(
    scene: &mut Scene,
    (ink, opacity): (Ink, f64),
    intervals: &[(f64, f64)],
    (frame, area): (&Frame<'_>, Area),
) {
    let finite = intervals.iter().filter(|(a, b)| !a.is_nan() && !b.is_nan());
    let on_page =
        finite.map(|(a, b)| (frame.page_x(a.min(*b)).max(area.left), frame.page_x(a.max(*b)).min(area.right)));
    let mut pieces: Vec<(f64, f64)> = on_page.filter(|(a, b)| a < b).collect();
    pieces.sort_by(|p, q| p.0.total_cmp(&q.0));
    // Intervals that touch are one; what overlaps must not be shaded twice.
    let mut merged: Vec<(f64, f64)> = Vec::new();
    for (a, b) in pieces {
        match merged.last_mut().filter(|last| a <= last.1) {
            Some(last) => last.1 = last.1.max(b),
            None => merged.push((a, b)),
        }
    }
    let columns = (area.width() / (2.0 * COLUMN)).ceil();
    if merged.len() as f64 <= DENSE * columns {
        let mut shade = Outline::filled(ink, opacity);
        let least = if area == frame.area { 0.0 } else { THINNEST };
        for (left, right) in &merged {
            shade.rectangle(Area { left: *left, right: right.max(left + least).min(area.right), ..area });
        }
        scene.outline(shade);
        return;
    }
    // Finer than the page can show: each column is as dark as the share of it that is covered.
    let width = area.width() / columns;
    let mut covered = vec![0.0; columns as usize];
    for (a, b) in merged {
        let first = ((a - area.left) / width) as usize;
        for (i, column) in covered.iter_mut().enumerate().skip(first) {
            let (left, right) = (area.left + i as f64 * width, area.left + (i as f64 + 1.0) * width);
            if left >= b {
                break;
            }
            *column += (b.min(right) - a.max(left)).max(0.0) / width;
        }
    }
    let level: Vec<usize> = covered.iter().map(|c| (c * SHADES as f64).round() as usize).collect();
    for shade in 1..=SHADES {
        let mut outline = Outline::filled(ink, opacity * shade as f64 / SHADES as f64);
        let mut i = 0;
        for run in level.chunk_by(|a, b| a == b) {
            if run[0].min(SHADES) == shade {
                let left = area.left + i as f64 * width;
                outline.rectangle(Area { left, right: left + run.len() as f64 * width, ..area });
            }
            i += run.len();
        }
        scene.outline(outline);
    }
}

fn grid(scene: &mut Scene, frame: &Frame<'_>) {
    let area = frame.area;
    let lines = |width: f64, xs: &[f64], ys: &[f64]| {
        let mut lines = Outline::stroked(Ink::Grid, width, &[]);
        for x in xs.iter().map(|x| frame.page_x(*x)) {
            lines.polyline(&[[x, area.top], [x, area.bottom]]);
        }
        for y in ys.iter().map(|y| frame.page_y(*y)) {
            lines.polyline(&[[area.left, y], [area.right, y]]);
        }
        lines
    };
    scene.outline(lines(0.5 * MINOR, &frame.x_ticks.minor, &frame.y_ticks.minor));
    scene.outline(lines(0.5, &frame.x_ticks.values(), &frame.y_ticks.values()));
}

fn axes(scene: &mut Scene, frame: &Frame<'_>) {
    let area = frame.area;
    let marks = |lines: &mut Outline, length: f64, xs: &[f64], ys: &[f64]| {
        for x in xs.iter().map(|x| frame.page_x(*x)) {
            lines.polyline(&[[x, area.bottom], [x, area.bottom + length]]);
        }
        for y in ys.iter().map(|y| frame.page_y(*y)) {
            lines.polyline(&[[area.left - length, y], [area.left, y]]);
        }
    };
    let mut lines = Outline::stroked(Ink::Axis, 0.7, &[]);
    lines.polyline(&[[area.left, area.top], [area.left, area.bottom], [area.right, area.bottom]]);
    marks(&mut lines, TICK, &frame.x_ticks.values(), &frame.y_ticks.values());
    for (x, label) in frame.x_ticks.at.iter().filter(|_| frame.numbered) {
        let at = [frame.page_x(*x), area.bottom + TICK + TICK_GAP + 0.8 * TICK_SIZE];
        scene.words(words(label.clone(), at, Anchor::Middle, TICK_SIZE));
    }
    for (y, label) in &frame.y_ticks.at {
        let at = [area.left - TICK - TICK_GAP, frame.page_y(*y) + 0.36 * TICK_SIZE];
        scene.words(words(label.clone(), at, Anchor::End, TICK_SIZE));
    }
    let mut minor = Outline::stroked(Ink::Axis, 0.7 * MINOR, &[]);
    marks(&mut minor, MINOR * TICK, &frame.x_ticks.minor, &frame.y_ticks.minor);
    scene.outline(minor);
    scene.outline(lines);
}

/// The reference lines of a panel, behind the data.
fn rules(scene: &mut Scene, panel: &Panel, frame: &Frame<'_>) {
    let area = frame.area;
    for reference in &panel.references {
        let mut line = rule(ink_of(reference));
        let (a, b) = match reference {
            Reference::Horizontal { y, .. } => ([area.left, frame.page_y(*y)], [area.right, frame.page_y(*y)]),
            Reference::Vertical { x, .. } => ([frame.page_x(*x), area.top], [frame.page_x(*x), area.bottom]),
        };
        // A position that is not a number is nowhere.
        if (a[0] + a[1]).is_finite()
            && let Some(ends) = chord(a, b, area)
        {
            line.polyline(&ends);
            scene.outline(line);
        }
    }
}

/// What a reference line is drawn in.
fn ink_of(reference: &Reference) -> Ink {
    match reference {
        Reference::Horizontal { colour, .. } if *colour != Colour::Neutral => (*colour).into(),
        _ => Ink::Muted,
    }
}

/// The words on the vertical reference lines, each where it covers no data; and those for which there is no such place, with those of
/// horizontal lines: the data decide where on these there is room, and what is called so in one figure would be called elsewhere in the
/// next. Only distances within the axes matter, so the answer is the same wherever the panel stands.
pub(super) fn rule_words(panel: &Panel, frame: &Frame<'_>, faces: &Faces) -> (Vec<Words>, Vec<(String, Ink)>) {
    let (mut placed, mut homeless) = (Vec::new(), Vec::new());
    if panel.references.is_empty() {
        return (placed, homeless);
    }
    let mut taken: Vec<Vec<Point>> = Vec::new();
    for series in &panel.series {
        let (lines, points) = shape(series, frame);
        taken.extend(lines.into_iter().chain(points.into_iter().map(|p| vec![p])));
    }
    taken.extend(panel.marks.iter().flat_map(|marks| places(panel, marks, frame)).map(|p| vec![p]));
    for reference in &panel.references {
        let (Reference::Horizontal { label, .. } | Reference::Vertical { label, .. }) = reference;
        let of_legend = |homeless: &mut Vec<(String, Ink)>| {
            let entry = (label.clone(), ink_of(reference));
            if is_on(reference, frame) && !homeless.contains(&entry) {
                homeless.push(entry);
            }
        };
        let Reference::Vertical { x, .. } = reference else {
            of_legend(&mut homeless);
            continue;
        };
        let width = faces.width(label, REFERENCE_SIZE, false);
        let free = |start: &Point| {
            let room = room(*start, width);
            let rim =
                Area { left: room.left - 2.0, top: room.top - 1.0, right: room.right + 2.0, bottom: room.bottom + 1.0 };
            let hit = |run: &Vec<Point>| match run.as_slice() {
                [point] => rim.contains(*point),
                run => run.windows(2).any(|w| chord(w[0], w[1], rim).is_some()),
            };
            let a = frame.area;
            let inside =
                room.left >= a.left && room.right <= a.right && room.top >= a.top - 0.5 && room.bottom <= a.bottom;
            inside && !taken.iter().any(hit)
        };
        match candidates(*x, frame, width).into_iter().find(free) {
            Some(start) => {
                let room = room(start, width);
                taken.push(vec![[room.left, room.top], [room.right, room.bottom]]);
                let plain = words(label.clone(), start, Anchor::Start, REFERENCE_SIZE);
                placed.push(Words { halo: true, ink: Ink::Muted, ..plain });
            }
            None => of_legend(&mut homeless),
        }
    }
    (placed, homeless)
}

/// The room of words that start at a point.
fn room([x, y]: Point, width: f64) -> Area {
    Area { left: x, top: y - 0.76 * REFERENCE_SIZE, right: x + width, bottom: y + 0.2 * REFERENCE_SIZE }
}

/// Whether a reference line crosses the axes.
fn is_on(reference: &Reference, frame: &Frame<'_>) -> bool {
    let place = match reference {
        Reference::Horizontal { y, .. } => frame.y.place(*y),
        Reference::Vertical { x, .. } => frame.x.place(*x),
    };
    (0.0..=1.0).contains(&place)
}

/// Where the words of a vertical reference line may start, the best place first: near its ends, close to the line.
fn candidates(x: f64, frame: &Frame<'_>, width: f64) -> Vec<Point> {
    let Area { top, bottom, .. } = frame.area;
    let share = [0.0, 1.0, 0.1, 0.9, 0.2, 0.8, 0.3, 0.7, 0.4, 0.6, 0.5];
    let x = frame.page_x(x);
    let (from, to) = (top + 0.76 * REFERENCE_SIZE + 1.0, bottom - 3.0);
    let along = share.map(|t| from + t * (to - from));
    [x + 2.5, x - 2.5 - width].iter().flat_map(|x| along.map(|y| [*x, y])).collect()
}
