//! Where everything goes: margins from the words that stand in them, panels from the top, one horizontal axis.
//!
//! All lengths are points. The sizes are for print at the figure's true width: ticks and names 7 pt, labels 7.5 pt, the
//! title 8.5 pt, which journals require of a figure one column wide.

use super::PlotError;
use super::axis::{Axis, Scale};
use super::draw::{self, Frame};
use super::field::{self, Bar};
use super::figure::{Extent, Figure, Legend, Panel, Reference, Series, Style};
use super::legend::{self, Entry, Key};
use super::range::Range;
use super::scene::{Anchor, Area, Ink, Outline, Scene, Words};
use super::text::Faces;
use super::ticks::{Ticks, ticks, ticks_in_powers};

/// Points in a millimetre.
const MM: f64 = 72.0 / 25.4;
/// The free rim of a figure.
pub(super) const RIM: f64 = 3.0;
/// The length of a tick, and from its end to its label.
pub(super) const TICK: f64 = 2.6;
pub(super) const TICK_GAP: f64 = 2.0;
/// The sizes of words.
pub(super) const TICK_SIZE: f64 = 7.0;
pub(super) const LABEL_SIZE: f64 = 7.5;
pub(super) const TITLE_SIZE: f64 = 8.5;
pub(super) const CAPTION_SIZE: f64 = 6.8;
/// From one line of words to the next, of their size.
pub(super) const LEADING: f64 = 1.28;
/// From one label of a vertical axis to the next, at least.
pub(super) const ROW: f64 = 15.5;
/// Between the axes of one panel and what belongs to the next.
const PANEL_GAP: f64 = 8.0;
/// What events on the upper edge need.
const EDGE: f64 = 6.5;

/// The figure as primitives.
pub(super) fn scene(figure: &Figure) -> Result<Scene, PlotError> {
    Ok(laid_out(figure, &[])?.0)
}

/// The figure as primitives with at least so much room above the axes of each panel, and the room that each needs there.
pub(super) fn laid_out(figure: &Figure, least: &[f64]) -> Result<(Scene, Vec<f64>), PlotError> {
    figure.validate()?;
    let faces = Faces::load()?;
    let width = figure.width_mm * MM;
    let x = x_range(figure);
    let heights: Vec<f64> = figure.panels.iter().map(|p| p.height_mm.unwrap_or(figure.panel_height_mm) * MM).collect();
    let mut ys: Vec<(Range, Ticks)> = figure
        .panels
        .iter()
        .zip(&heights)
        .map(|(panel, height)| {
            let range = y_range(panel, x);
            (range, ticks(&panel.y, range, *height, ROW))
        })
        .collect();
    // Powers of ten on one axis are powers of ten on all.
    let in_powers = ys.iter().any(|(_, ticks)| ticks.has_powers())
        || (x.scale == Scale::Logarithmic && ticks(&figure.x, x, 0.8 * width, 24.0).has_powers());
    if in_powers {
        for ((panel, height), (range, its)) in figure.panels.iter().zip(&heights).zip(&mut ys) {
            *its = ticks_in_powers(&panel.y, *range, *height, ROW);
        }
    }

    // The margins, from what stands in them.
    let widest = |ticks: &Ticks| ticks.at.iter().map(|t| faces.width(&t.1, TICK_SIZE, false)).fold(0.0, f64::max);
    let numbers = ys.iter().map(|(_, ticks)| widest(ticks)).fold(0.0, f64::max).min(0.3 * width);
    let labels: Vec<Vec<String>> =
        ys.iter().zip(&heights).map(|((_, t), h)| faces.wrap(&t.label, LABEL_SIZE, false, h + 4.0)).collect();
    let lines = labels.iter().map(Vec::len).max().unwrap_or(0) as f64;
    let label_width = lines * LABEL_SIZE * LEADING;
    let left = RIM + label_width + 3.5 + numbers + TICK_GAP + TICK;
    let direct: Vec<bool> =
        figure.panels.iter().zip(&heights).map(|(p, h)| legend::is_direct(p, *h, |s| reach(s, x))).collect();
    let beside = figure.panels.iter().zip(&direct).filter(|(_, direct)| **direct);
    let mut right = beside.map(|(p, _)| legend::direct_width(p, &faces, 0.35 * width)).fold(RIM + 2.0, f64::max);
    let bars: Vec<Option<Bar>> = figure
        .panels
        .iter()
        .zip(&heights)
        .map(|(panel, height)| panel.field.as_ref().map(|field| Bar::new(field, *height, &faces)))
        .collect();
    right = bars.iter().flatten().map(|bar| bar.width + RIM).fold(right, f64::max);
    let x_ticks = x_ticks(&figure.x, (x, in_powers), width - left - right, &faces);
    if let Some((at, text)) = x_ticks.at.last() {
        // The last number must not be cut off.
        let overhang = 0.5 * faces.width(text, TICK_SIZE, false) - (1.0 - x.place(*at)) * (width - left - right);
        right = right.max(overhang + RIM);
    }

    let mut scene = Scene { width, title: figure.title.clone(), ..Scene::default() };
    scene.description.clone_from(&figure.caption);
    // The ground is drawn first and its height is known last.
    scene.outline(Outline { steps: vec![super::scene::Step::Close], ..Outline::filled(Ink::Background, 1.0) });
    let mut top = RIM;
    let title = faces.wrap(&figure.title, TITLE_SIZE, true, width - left - RIM);
    top = paragraph(&mut scene, &title, left, top, TITLE_SIZE, true, Ink::Text);
    let note = faces.wrap(&figure.note, CAPTION_SIZE, false, width - left - RIM);
    top = paragraph(&mut scene, &note, left, top, CAPTION_SIZE, false, Ink::Muted);
    if !title.is_empty() || !note.is_empty() {
        top += 1.5;
    }
    let (mut known, mut heads): (Vec<Entry>, Vec<f64>) = (Vec::new(), Vec::new());
    let panels = figure.panels.iter().zip(ys).zip(heights.iter().zip(&labels)).zip(direct).enumerate();
    for (i, (((panel, (y, y_ticks)), (height, label)), direct)) in panels {
        let mut names = names(panel, direct, &mut known);
        // Where the panel stands is not known before its legend; what fits in it is.
        let area = Area { left, top: 0.0, right: width - right, bottom: *height };
        let mut frame =
            Frame { area, x, y, x_ticks: &x_ticks, y_ticks: &y_ticks, numbered: i + 1 == figure.panels.len() };
        let homeless = draw::rule_words(panel, &frame, &faces).1.into_iter();
        names.extend(
            homeless
                .filter(|(label, _)| !label.trim().is_empty())
                .map(|(label, ink)| Entry { key: Key::Rule { ink }, label }),
        );
        let head = top;
        let rows = legend::rows(names, &faces, width - left - RIM);
        legend::draw_rows(&mut scene, &rows, left, top);
        top += rows.len() as f64 * legend::ROW + if rows.is_empty() { 0.5 * TICK_SIZE } else { 2.0 };
        if panel.marks.iter().any(|m| m.y.is_empty() && !m.x.is_empty()) {
            top += EDGE - if rows.is_empty() { 0.5 * TICK_SIZE } else { 0.0 };
        }
        if !panel.strips.is_empty() {
            top += panel.strips.len() as f64 * legend::STRIP_ROW + 1.5;
        }
        heads.push(top - head);
        top = top.max(head + least.get(i).copied().unwrap_or(0.0));
        let area = Area { top, bottom: top + height, ..area };
        frame.area = area;
        if let (Some(field), Some(bar)) = (&panel.field, &bars[i]) {
            field::draw(&mut scene, field, bar, &frame);
            bar.draw(&mut scene, area, &faces);
        }
        draw::panel(&mut scene, panel, &frame, &faces);
        if direct {
            legend::draw_direct(&mut scene, &faces, draw::ends(panel, &frame), area);
        }
        axis_label(&mut scene, label, area, RIM + label_width);
        top = area.bottom + if frame.numbered { 0.0 } else { PANEL_GAP };
    }

    if !figure.panels.is_empty() {
        top += TICK + TICK_GAP + TICK_SIZE * 1.1;
        for line in faces.wrap(&x_ticks.label, LABEL_SIZE, false, width - left - RIM) {
            top += LABEL_SIZE * LEADING;
            let middle = 0.5 * (left + width - right);
            // A long label moves left before it would leave the figure.
            let half = 0.5 * faces.width(&line, LABEL_SIZE, false);
            let middle = middle.min(width - RIM - half);
            scene.words(words(line, [middle, top], Anchor::Middle, LABEL_SIZE));
        }
        top += 2.5;
    }
    // Words below stand under the axes, as those above stand over them.
    let caption = faces.wrap(&figure.caption, CAPTION_SIZE, false, width - left - RIM);
    if !caption.is_empty() {
        top += 3.0;
    }
    top = paragraph(&mut scene, &caption, left, top, CAPTION_SIZE, false, Ink::Muted);
    scene.height = top + RIM;
    if let Some(super::scene::Item::Outline(ground)) = scene.items.first_mut() {
        ground.steps.clear();
        ground.rectangle(Area { left: 0.0, top: 0.0, right: width, bottom: scene.height });
    }
    Ok((scene, heads))
}

/// Words that stand plainly on the ground.
pub(super) fn words(text: String, at: [f64; 2], anchor: Anchor, size: f64) -> Words {
    Words { at, anchor, size, bold: false, rotated: false, halo: false, ink: Ink::Text, text }
}

/// Lines of words from a corner downwards. Returns where the next thing may start.
pub(super) fn paragraph(
    scene: &mut Scene,
    lines: &[String],
    left: f64,
    top: f64,
    size: f64,
    bold: bool,
    ink: Ink,
) -> f64 {
    for (i, line) in lines.iter().enumerate() {
        let baseline = top + size * (i as f64 * LEADING + 1.0);
        scene.words(Words { bold, ink, ..words(line.clone(), [left, baseline], Anchor::Start, size) });
    }
    top + lines.len() as f64 * size * LEADING
}

/// The label of a vertical axis, whose last line ends at `right`.
fn axis_label(scene: &mut Scene, lines: &[String], area: Area, right: f64) {
    for (i, line) in lines.iter().rev().enumerate() {
        let baseline = right - 0.25 * LABEL_SIZE - i as f64 * LABEL_SIZE * LEADING;
        let middle = 0.5 * (area.top + area.bottom);
        scene.words(Words { rotated: true, ..words(line.clone(), [baseline, middle], Anchor::Middle, LABEL_SIZE) });
    }
}

/// The names that go above a panel: those that no other has.
fn names(panel: &Panel, direct: bool, known: &mut Vec<Entry>) -> Vec<Entry> {
    let mut names = legend::entries(panel);
    match panel.legend {
        Legend::Hidden => names.clear(),
        Legend::Above => {}
        Legend::Auto | Legend::Direct => {
            // The only series of a panel is named by the axis already, if the words are the same.
            if let ([only], Legend::Auto) = (panel.series.as_slice(), panel.legend)
                && only.label.trim().eq_ignore_ascii_case(panel.y.label.trim())
            {
                names.retain(|entry| entry.label != only.label);
            }
            names.retain(|entry| !known.contains(entry));
        }
    }
    if direct {
        names.retain(|entry| !panel.series.iter().any(|s| s.label == entry.label));
    }
    known.extend(names.iter().cloned());
    names
}

/// Round values of the horizontal axis whose labels keep apart.
fn x_ticks(axis: &Axis, (range, in_powers): (Range, bool), width: f64, faces: &Faces) -> Ticks {
    let spaced = |ticks: &Ticks| {
        ticks.at.windows(2).all(|w| {
            let needed = 0.5 * (faces.width(&w[0].1, TICK_SIZE, false) + faces.width(&w[1].1, TICK_SIZE, false)) + 7.0;
            (range.place(w[1].0) - range.place(w[0].0)) * width >= needed
        })
    };
    let attempt = |spacing: f64| match in_powers {
        true => ticks_in_powers(axis, range, width, spacing),
        false => ticks(axis, range, width, spacing),
    };
    [24.0, 32.0, 44.0, 60.0, 80.0].into_iter().map(attempt).find(spaced).unwrap_or_else(|| attempt(110.0))
}

/// Grows an length_regime by a value, if that has a place on the scale.
fn grow(length_regime: &mut Option<(f64, f64)>, scale: Scale, value: f64) {
    if scale.admits(value) {
        let (low, high) = length_regime.unwrap_or((value, value));
        *length_regime = Some((low.min(value), high.max(value)));
    }
}

/// The common range of x: that of the data, tight around curves that only go forth, with a margin around others.
fn x_range(figure: &Figure) -> Range {
    let scale = figure.x.scale;
    let mut length_regime = None;
    let mut frames = None;
    for panel in &figure.panels {
        let edges = panel.field.iter().flat_map(|field| field::edges(&field.x, scale));
        edges.for_each(|x| grow(&mut length_regime, scale, x));
        for series in &panel.series {
            let points = series.x.iter().zip(&series.y).filter(|(_, y)| panel.y.scale.admits(**y));
            points.for_each(|(x, _)| grow(&mut length_regime, scale, *x));
        }
        panel.marks.iter().flat_map(|m| &m.x).for_each(|x| grow(&mut length_regime, scale, *x));
        for span in &panel.spans {
            match &span.length_regime {
                Extent::Between { x, .. } => x.iter().for_each(|x| grow(&mut length_regime, scale, *x)),
                Extent::Horizontal(spans) => spans.iter().for_each(|s| {
                    grow(&mut frames, scale, s.0);
                    grow(&mut frames, scale, s.1);
                }),
                Extent::Vertical(..) => {}
            }
        }
        for strip in &panel.strips {
            for (from, to) in &strip.intervals {
                grow(&mut frames, scale, *from);
                grow(&mut frames, scale, *to);
            }
        }
        for reference in &panel.references {
            if let Reference::Vertical { x, .. } = reference {
                grow(&mut length_regime, scale, *x);
            }
        }
    }
    let forth = |s: &Series| !matches!(s.style, Style::Points | Style::Dots | Style::LineAndPoints) && s.x.is_sorted();
    let tight = figure.panels.iter().flat_map(|p| &p.series).all(forth);
    let margin = if figure.x.words.is_empty() { 0.04 } else { 0.25 };
    Range::new(length_regime.or(frames), &figure.x, if tight { 0.0 } else { margin })
}

/// The range of y of a panel: that of what is seen within the range of x.
fn y_range(panel: &Panel, x: Range) -> Range {
    let scale = panel.y.scale;
    let mut length_regime = None;
    let mut column = |xs: &[f64], ys: &[f64]| {
        let seen = xs.iter().zip(ys).filter(|(at, _)| x.contains(**at, 1e-9));
        seen.for_each(|(_, y)| grow(&mut length_regime, scale, *y));
    };
    panel.series.iter().for_each(|s| column(&s.x, &s.y));
    panel.marks.iter().for_each(|m| column(&m.x, &m.y));
    for span in &panel.spans {
        if let Extent::Between { x, lower, upper } = &span.length_regime {
            column(x, lower);
            column(x, upper);
        }
    }
    for span in &panel.spans {
        if let Extent::Vertical(from, to) = span.length_regime {
            grow(&mut length_regime, scale, from);
            grow(&mut length_regime, scale, to);
        }
    }
    for reference in &panel.references {
        if let Reference::Horizontal { y, .. } = reference {
            grow(&mut length_regime, scale, *y);
        }
    }
    if let Some(field) = &panel.field {
        field::edges(&field.y, scale).into_iter().for_each(|y| grow(&mut length_regime, scale, y));
        return Range::new(length_regime, &panel.y, 0.0);
    }
    Range::new(length_regime, &panel.y, if panel.y.words.is_empty() { 0.06 } else { 0.25 })
}

/// How far to the right a curve ends, 1 at the edge of the axes.
fn reach(series: &Series, x: Range) -> f64 {
    let ends = series.x.iter().zip(&series.y).filter(|(x, y)| x.is_finite() && y.is_finite());
    ends.map(|(at, _)| x.place(*at)).fold(f64::NEG_INFINITY, f64::max)
}
