//! The names of what is drawn: in rows above the axes, or beside the ends of the curves.

use super::figure::{Colour, Dash, Legend, Panel, Series, Style, Symbol};
use super::scene::{Anchor, Area, Ink, Outline, Point, Scene, Words, is_open};
use super::text::Faces;

/// The size of the words in pt.
pub(super) const SIZE: f64 = 7.0;
/// From one row to the next.
pub(super) const ROW: f64 = 9.6;
/// The gaps after a sample and after a name.
const GAP: f64 = 3.0;
const BETWEEN: f64 = 9.0;
/// From the axes to a name beside a curve.
const LEADER: f64 = 9.0;
/// The width of curves.
pub(super) const LINE: f64 = 1.1;
/// The radius of data points and of marks.
pub(super) const POINT: f64 = 1.7;
pub(super) const MARK: f64 = 2.0;
/// How much of a span's colour is drawn.
pub(super) const SHADE: f64 = 0.16;
/// The height of a strip above the axes, from one to the next, and how much of its colour is drawn.
pub(super) const STRIP: f64 = 2.2;
pub(super) const STRIP_ROW: f64 = 3.0;
pub(super) const STRIP_SHADE: f64 = 0.75;

/// What the sample before a name shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Key {
    Line { ink: Ink, dash: &'static [f64], symbol: Option<Symbol> },
    Points { ink: Ink, symbol: Symbol },
    Shade { ink: Ink },
    Mark { ink: Ink, symbol: Symbol, filled: bool },
    Strip { ink: Ink },
    Rule { ink: Ink },
}

impl Key {
    /// What it belongs with: curves and points, areas, events, lines.
    fn group(self) -> u8 {
        match self {
            Key::Line { .. } | Key::Points { .. } => 0,
            Key::Shade { .. } | Key::Strip { .. } => 1,
            Key::Mark { .. } => 2,
            Key::Rule { .. } => 3,
        }
    }

    /// How wide the sample is.
    fn width(self) -> f64 {
        match self {
            Key::Line { .. } | Key::Rule { .. } => 15.0,
            Key::Shade { .. } | Key::Strip { .. } => 10.0,
            Key::Points { .. } | Key::Mark { .. } => 5.0,
        }
    }
}

/// The line and the pattern of references.
pub(super) fn rule(ink: Ink) -> Outline {
    Outline::stroked(ink, 0.7, &[3.0, 1.6])
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) key: Key,
    pub(super) label: String,
}

/// The lengths of the strokes and gaps of a pattern.
fn pattern(dash: Dash) -> &'static [f64] {
    match dash {
        Dash::Solid => &[],
        Dash::Dashed => &[4.2, 1.8],
        Dash::DashDot => &[5.0, 1.5, 1.1, 1.5],
        Dash::Dotted => &[1.1, 1.3],
        Dash::LongDash => &[8.0, 2.0],
        Dash::DashDotDot => &[5.0, 1.4, 1.1, 1.4, 1.1, 1.4],
    }
}

/// How a series of a panel is dashed.
pub(super) fn dash(panel: &Panel, series: &Series) -> &'static [f64] {
    use Dash::{DashDot, DashDotDot, Dashed, Dotted, LongDash, Solid};
    let lines = panel.series.iter().filter(|s| !matches!(s.style, Style::Points | Style::Dots)).count();
    pattern(match (series.dash, series.colour) {
        (Some(dash), _) => dash,
        (None, Colour::Category(i)) if lines > 1 => [Solid, Dashed, DashDot, Dotted, LongDash, DashDotDot][i % 6],
        _ => Solid,
    })
}

/// The symbol that goes with a colour.
pub(super) fn symbol(colour: Colour) -> Symbol {
    use Symbol::{Circle, Cross, Diamond, Plus, Square, Triangle, TriangleDown};
    match colour {
        Colour::Category(i) => [Circle, Square, Triangle, Diamond, TriangleDown, Plus, Cross][i % 7],
        Colour::Neutral | Colour::Ramp(_) => Circle,
    }
}

/// What a panel has names for, in the order of its lists.
pub(super) fn entries(panel: &Panel) -> Vec<Entry> {
    let series = panel.series.iter().map(|s| {
        let (ink, symbol) = (s.colour.into(), symbol(s.colour));
        let key = match s.style {
            Style::Points | Style::Dots => Key::Points { ink, symbol },
            Style::LineAndPoints => Key::Line { ink, dash: dash(panel, s), symbol: Some(symbol) },
            Style::Line | Style::Steps => Key::Line { ink, dash: dash(panel, s), symbol: None },
        };
        Entry { key, label: s.label.clone() }
    });
    let spans = panel.spans.iter().map(|s| Entry { key: Key::Shade { ink: s.colour.into() }, label: s.label.clone() });
    let marks = panel.marks.iter().map(|m| Entry {
        key: Key::Mark { ink: m.colour.into(), symbol: m.symbol, filled: m.filled },
        label: m.label.clone(),
    });
    let strips =
        panel.strips.iter().map(|s| Entry { key: Key::Strip { ink: s.colour.into() }, label: s.label.clone() });
    let mut entries: Vec<Entry> = Vec::new();
    for entry in series.chain(spans).chain(strips).chain(marks).filter(|e| !e.label.trim().is_empty()) {
        // What looks alike and is called alike is one thing.
        if !entries.contains(&entry) {
            entries.push(entry);
        }
    }
    entries
}

/// Whether the names of a panel of this height go beside the ends of its curves, which `reach` gives.
pub(super) fn is_direct(panel: &Panel, height: f64, reach: impl Fn(&Series) -> f64) -> bool {
    let named: Vec<&Series> = panel.series.iter().filter(|s| !s.label.trim().is_empty()).collect();
    let room = height / (SIZE + 1.0);
    let family = named.len() > 1
        && named.len() as f64 <= room
        && named.iter().all(|s| s.style == Style::Line && matches!(s.colour, Colour::Ramp(_)) && reach(s) > 0.9);
    match panel.legend {
        Legend::Direct => true,
        Legend::Auto => family,
        Legend::Above | Legend::Hidden => false,
    }
}

/// The rows of a legend: each name with where its sample starts.
pub(super) fn rows(entries: Vec<Entry>, faces: &Faces, width: f64) -> Vec<Vec<(f64, Entry)>> {
    let mut rows: Vec<Vec<(f64, Entry)>> = Vec::new();
    let mut x = 0.0;
    let needed = |entry: &Entry| entry.key.width() + GAP + faces.width(&entry.label, SIZE, false);
    let fit = |mut entry: Entry| {
        entry.label = faces.fit(&entry.label, SIZE, false, width - entry.key.width() - GAP);
        entry
    };
    let entries: Vec<Entry> = entries.into_iter().map(fit).collect();
    for group in entries.chunk_by(|a, b| a.key.group() == b.key.group()) {
        // What belongs together stands in one row if that has room for it.
        let all = group.iter().map(&needed).sum::<f64>() + (group.len() - 1) as f64 * BETWEEN;
        let mut fresh = x + all > width && all <= width;
        for entry in group {
            match rows.last_mut().filter(|_| !fresh && x + needed(entry) <= width) {
                Some(row) => row.push((x, entry.clone())),
                None => {
                    x = 0.0;
                    fresh = false;
                    rows.push(vec![(x, entry.clone())]);
                }
            }
            x += needed(entry) + BETWEEN;
        }
    }
    rows
}

/// Draws the rows from a corner downwards.
pub(super) fn draw_rows(scene: &mut Scene, rows: &[Vec<(f64, Entry)>], left: f64, top: f64) {
    for (i, row) in rows.iter().enumerate() {
        let middle = top + (i as f64 + 0.5) * ROW;
        for (x, entry) in row {
            sample(scene, entry.key, [left + x, middle]);
            scene.words(Words {
                at: [left + x + entry.key.width() + GAP, middle + 0.36 * SIZE],
                anchor: Anchor::Start,
                size: SIZE,
                bold: false,
                rotated: false,
                halo: false,
                ink: Ink::Text,
                text: entry.label.clone(),
            });
        }
    }
}

fn sample(scene: &mut Scene, key: Key, [x, y]: Point) {
    let right = x + key.width();
    let middle = [0.5 * (x + right), y];
    match key {
        Key::Line { ink, dash, symbol } => {
            let mut line = Outline::stroked(ink, LINE + 0.1, dash);
            line.polyline(&[[x, y], [right, y]]);
            scene.outline(line);
            if let Some(symbol) = symbol {
                draw_points(scene, ink, symbol, &[middle]);
            }
        }
        Key::Points { ink, symbol } => draw_points(scene, ink, symbol, &[middle]),
        Key::Mark { ink, symbol, filled } => draw_marks(scene, ink, (symbol, filled), &[middle]),
        Key::Strip { ink } => {
            let mut bar = Outline::filled(ink, STRIP_SHADE);
            bar.rectangle(Area { left: x, top: y - 0.5 * STRIP, right, bottom: y + 0.5 * STRIP });
            scene.outline(bar);
        }
        Key::Rule { ink } => {
            let mut line = rule(ink);
            line.polyline(&[[x, y], [right, y]]);
            scene.outline(line);
        }
        Key::Shade { ink } => {
            let mut shade = Outline::filled(ink, SHADE);
            shade.rectangle(Area { left: x, top: y - 3.2, right, bottom: y + 3.2 });
            scene.outline(shade);
        }
    }
}

/// Full symbols with a thin edge of background, so that neighbours stay apart.
pub(super) fn draw_points(scene: &mut Scene, ink: Ink, symbol: Symbol, points: &[Point]) {
    let mut outline = match is_open(symbol) {
        true => Outline::stroked(ink, 0.9, &[]),
        false => Outline { stroke: Outline::stroked(Ink::Background, 0.4, &[]).stroke, ..Outline::filled(ink, 1.0) },
    };
    points.iter().for_each(|p| outline.symbol(symbol, *p, POINT));
    scene.outline(outline);
}

/// Symbols, hollow ones filled with background so that they stand on a curve.
pub(super) fn draw_marks(scene: &mut Scene, ink: Ink, (symbol, filled): (Symbol, bool), points: &[Point]) {
    let mut outline = Outline::stroked(ink, 0.8, &[]);
    if !is_open(symbol) {
        outline.fill = Outline::filled(if filled { ink } else { Ink::Background }, 1.0).fill;
    }
    points.iter().for_each(|p| outline.symbol(symbol, *p, MARK));
    scene.outline(outline);
}

/// The end of a curve and its name.
pub(super) struct End {
    pub(super) at: Point,
    pub(super) ink: Ink,
    pub(super) label: String,
}

/// The margin that names beside the curves need.
pub(super) fn direct_width(panel: &Panel, faces: &Faces, most: f64) -> f64 {
    let widest = panel.series.iter().map(|s| faces.width(&s.label, SIZE, false)).fold(0.0, f64::max);
    (widest + LEADER + 5.0).min(most)
}

/// Draws names in the right margin, each led to by a thin line from the end of its curve.
pub(super) fn draw_direct(scene: &mut Scene, faces: &Faces, mut ends: Vec<End>, area: Area) {
    ends.sort_by(|a, b| a.at[1].total_cmp(&b.at[1]));
    let wanted: Vec<f64> = ends.iter().map(|end| end.at[1]).collect();
    let places = spread(&wanted, SIZE + 1.0, area.top + 2.0, area.bottom - 2.0);
    for (end, y) in ends.into_iter().zip(places) {
        let x = area.right + LEADER;
        let mut leader = Outline::stroked(end.ink, 0.7, &[]);
        leader.polyline(&[end.at, [area.right.max(end.at[0]) + 1.0, end.at[1]], [x - 2.0, y], [x, y]]);
        scene.outline(leader);
        scene.words(Words {
            at: [x + 1.5, y + 0.36 * SIZE],
            anchor: Anchor::Start,
            size: SIZE,
            bold: false,
            rotated: false,
            halo: false,
            ink: Ink::Text,
            text: faces.fit(&end.label, SIZE, false, scene.width - x - 2.5),
        });
    }
}

/// Places no closer than `gap` and within bounds, near those wanted, which rise. Where there is no room for the gap,
/// it shrinks.
fn spread(wanted: &[f64], gap: f64, low: f64, high: f64) -> Vec<f64> {
    let gap = gap.min((high - low) / (wanted.len().max(2) - 1) as f64);
    let mut places = wanted.to_vec();
    let mut least = low;
    for place in &mut places {
        *place = place.max(least);
        least = *place + gap;
    }
    let mut most = high;
    for place in places.iter_mut().rev() {
        *place = place.min(most);
        most = *place - gap;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_beside_curves_keep_apart_and_inside() {
        let places = spread(&[1.0, 1.1, 1.2, 50.0, 99.0, 99.0], 8.0, 0.0, 100.0);
        assert!(places.windows(2).all(|w| w[1] - w[0] >= 8.0 - 1e-9), "{places:?}");
        assert!(places[0] >= 0.0 && places[5] <= 100.0 && places[3] == 50.0);
        let crowded = spread(&[5.0; 30], 8.0, 0.0, 58.0);
        assert!(crowded.windows(2).all(|w| w[1] - w[0] > 1.9) && crowded[0] > -1e-9 && crowded[29] <= 58.0);
        assert!(spread(&[], 8.0, 0.0, 10.0).is_empty());
    }

    #[test]
    fn rows_break_before_they_leave_the_figure() {
        let faces = Faces::load().unwrap();
        let entry = |label: &str| Entry { key: Key::Shade { ink: Ink::Text }, label: label.to_string() };
        let rows = rows(vec![entry("valve open"), entry("valve closed"), entry(&"long ".repeat(60))], &faces, 150.0);
        assert_eq!(rows.iter().map(Vec::len).collect::<Vec<_>>(), [2, 1]);
        assert!(rows[1][0].1.label.ends_with('…'));
    }

    #[test]
    fn what_belongs_together_stands_in_one_row() {
        let faces = Faces::load().unwrap();
        let of = |key: Key, label: &str| Entry { key, label: label.to_string() };
        let mark = Key::Mark { ink: Ink::Text, symbol: Symbol::Circle, filled: false };
        let shade = Key::Shade { ink: Ink::Text };
        let entries = vec![of(shade, "supply open"), of(mark, "break-away"), of(mark, "reversal")];
        let rows = rows(entries, &faces, 130.0);
        assert_eq!(rows.iter().map(Vec::len).collect::<Vec<_>>(), [1, 2], "{rows:?}");
    }
}
