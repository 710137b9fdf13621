//! A scene as an SVG document.
//!
//! Colours are presentation attributes, which every reader of SVG understands. For [`Theme::Auto`] they are the light
//! ones, and classes override them where the reader prefers dark. Class names are the same in every figure, and there
//! are no identifiers, so many figures can stand in one HTML page.

use super::scene::{Anchor, Ink, Item, Outline, Scene, Step, Words};
use super::text::{Script, scripts};
use super::theme::{Theme, colour};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Writing into a `String` cannot fail.
macro_rules! put {
    ($out:expr, $($arg:tt)*) => {{ let _ = write!($out, $($arg)*); }};
}

pub(super) fn document(scene: &Scene, theme: Theme) -> String {
    let mut out = String::new();
    let (w, h) = (scene.width, scene.height);
    put!(out, r#"<svg xmlns="http://www.w3.org/2000/svg" width="{}mm" height="{}mm""#, number(w / MM), number(h / MM));
    put!(out, r#" viewBox="0 0 {} {}" role="img" fill="none" stroke-linejoin="round""#, number(w), number(h));
    put!(out, r#" font-family="{FAMILY}">"#);
    put!(out, "\n");
    if !scene.title.is_empty() {
        put!(out, "<title>{}</title>\n", escaped(&scene.title));
    }
    if !scene.description.is_empty() {
        put!(out, "<desc>{}</desc>\n", escaped(&scene.description));
    }
    if theme == Theme::Auto {
        put!(out, "{}", style(scene));
    }
    for item in &scene.items {
        match item {
            Item::Outline(outline) => match discs(outline) {
                Some(radius) => dots(&mut out, outline, radius, theme),
                None => path(&mut out, outline, theme),
            },
            Item::Words(words) => text(&mut out, words, theme),
        }
    }
    out.push_str("</svg>\n");
    out
}

/// Points in a millimetre.
const MM: f64 = 72.0 / 25.4;
const FAMILY: &str = "Noto Sans, Helvetica Neue, Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif";

/// The rules that recolour a figure in the dark.
fn style(scene: &Scene) -> String {
    let (mut fills, mut strokes) = (BTreeSet::new(), BTreeSet::new());
    for item in &scene.items {
        match item {
            Item::Outline(outline) => {
                let inks = match discs(outline) {
                    Some(_) => &mut strokes,
                    None => &mut fills,
                };
                inks.extend(outline.fill.map(|f| f.ink));
                strokes.extend(outline.stroke.map(|s| s.ink));
            }
            Item::Words(words) => {
                fills.insert(words.ink);
                strokes.extend(words.halo.then_some(Ink::Background));
            }
        }
    }
    let mut rules = String::from("<style>@media (prefers-color-scheme:dark){");
    for (property, letter, inks) in [("fill", 'f', fills), ("stroke", 's', strokes)] {
        for ink in inks {
            put!(rules, ".{}{{{property}:{}}}", class(letter, ink), hex(ink, true));
        }
    }
    rules.push_str("}</style>\n");
    rules
}

fn class(letter: char, ink: Ink) -> String {
    let name = match ink {
        Ink::Background => "ground".to_string(),
        Ink::Text => "text".to_string(),
        Ink::Muted => "muted".to_string(),
        Ink::Axis => "axis".to_string(),
        Ink::Grid => "grid".to_string(),
        Ink::Category(i) => format!("c{i}"),
        Ink::Ramp(i) => format!("r{i}"),
        Ink::Scale(i) => format!("m{i}"),
        Ink::Diverging(i) => format!("d{i}"),
    };
    format!("mckp-{letter}-{name}")
}

fn hex(ink: Ink, dark: bool) -> String {
    let [r, g, b] = colour(ink, dark);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The colour attributes of an element.
fn paint(out: &mut String, fill: Option<Ink>, stroke: Option<Ink>, theme: Theme) {
    let dark = theme == Theme::Dark;
    if let Some(ink) = fill {
        put!(out, r#" fill="{}""#, hex(ink, dark));
    }
    if let Some(ink) = stroke {
        put!(out, r#" stroke="{}""#, hex(ink, dark));
    }
    if theme == Theme::Auto {
        let classes: Vec<String> =
            [('f', fill), ('s', stroke)].into_iter().filter_map(|(letter, ink)| Some(class(letter, ink?))).collect();
        put!(out, r#" class="{}""#, classes.join(" "));
    }
}

/// The radius of the discs, where an outline is nothing but filled discs of one size.
fn discs(outline: &Outline) -> Option<f64> {
    let Some(Step::Disc(_, radius)) = outline.steps.first() else { return None };
    let same = outline.steps.iter().all(|step| matches!(step, Step::Disc(_, r) if r == radius));
    (same && outline.fill.is_some() && outline.stroke.is_none()).then_some(*radius)
}

/// Discs of one size: ends of lines that have no length, a quarter of the text of two arcs.
fn dots(out: &mut String, outline: &Outline, radius: f64, theme: Theme) {
    let Some(fill) = outline.fill else { return };
    out.push_str("<path");
    paint(out, None, Some(fill.ink), theme);
    if fill.opacity < 1.0 {
        put!(out, r#" stroke-opacity="{}""#, number(fill.opacity));
    }
    put!(out, r#" stroke-width="{}" stroke-linecap="round" d=""#, number(2.0 * radius));
    for step in &outline.steps {
        if let Step::Disc(centre, _) = step {
            let [x, y] = centre.map(number);
            put!(out, "M{x} {y}h0");
        }
    }
    out.push_str("\"/>\n");
}

fn path(out: &mut String, outline: &Outline, theme: Theme) {
    out.push_str("<path");
    paint(out, outline.fill.map(|f| f.ink), outline.stroke.map(|s| s.ink), theme);
    if let Some(opacity) = outline.fill.map(|f| f.opacity).filter(|o| *o < 1.0) {
        put!(out, r#" fill-opacity="{}""#, number(opacity));
    }
    if let Some(stroke) = outline.stroke {
        put!(out, r#" stroke-width="{}""#, number(stroke.width));
        if !stroke.dash.is_empty() {
            let dash: Vec<String> = stroke.dash.iter().map(|d| number(*d)).collect();
            put!(out, r#" stroke-dasharray="{}""#, dash.join(" "));
        }
    }
    out.push_str(" d=\"");
    // Where the pen is, as it was written, and whether the last letter was that of a line.
    let (mut pen, mut after_line) = ([String::new(), String::new()], false);
    for step in &outline.steps {
        let mut is_line = false;
        match step {
            Step::Move(to) => {
                pen = to.map(number);
                put!(out, "M{} {}", pen[0], pen[1]);
            }
            // Half of a square, a sixth of a long curve: a line along an axis has one number, and a repeated letter is left out.
            Step::Line(to) => {
                let [x, y] = to.map(number);
                match (x == pen[0], y == pen[1]) {
                    (false, true) => put!(out, "H{x}"),
                    (true, false) => put!(out, "V{y}"),
                    _ => {
                        put!(out, "{}{x} {y}", if after_line { ' ' } else { 'L' });
                        is_line = true;
                    }
                }
                pen = [x, y];
            }
            Step::Close => out.push('Z'),
            Step::Disc([x, y], r) => {
                let (start, r, d) = (number(x - r), number(*r), number(2.0 * r));
                put!(out, "M{start} {}a{r} {r} 0 1 1 {d} 0a{r} {r} 0 1 1 -{d} 0Z", number(*y));
            }
        }
        after_line = is_line;
    }
    out.push_str("\"/>\n");
}

fn text(out: &mut String, words: &Words, theme: Theme) {
    out.push_str("<text");
    paint(out, Some(words.ink), words.halo.then_some(Ink::Background), theme);
    if words.halo {
        out.push_str(r#" stroke-width="2.4" paint-order="stroke""#);
    }
    let [x, y] = words.at.map(number);
    match words.rotated {
        true => put!(out, r#" transform="translate({x} {y}) rotate(-90)""#),
        false => put!(out, r#" x="{x}" y="{y}""#),
    }
    put!(out, r#" font-size="{}""#, number(words.size));
    if words.bold {
        out.push_str(r#" font-weight="bold""#);
    }
    match words.anchor {
        Anchor::Start => {}
        Anchor::Middle => out.push_str(r#" text-anchor="middle""#),
        Anchor::End => out.push_str(r#" text-anchor="end""#),
    }
    out.push('>');
    let mut baseline = 0.0;
    for (script, part) in scripts(&words.text) {
        let (rise, scale) = script.shape();
        let part = escaped(&part);
        if script == Script::Ordinary && baseline == 0.0 {
            out.push_str(&part);
            continue;
        }
        // `dy` moves the pen for good, so each part undoes the rise of the one before.
        let dy = number((baseline - rise) * words.size);
        put!(out, r#"<tspan dy="{dy}" font-size="{}">{part}</tspan>"#, number(words.size * scale));
        baseline = rise;
    }
    out.push_str("</text>\n");
}

/// Two places, which is 3.5 µm, without trailing zeros.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

/// Text as XML allows it.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // XML has no place for control characters and the two noncharacters, not even escaped.
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Discs of one size are round ends of lines, in the colour and with the diameter of the discs; others stay arcs.
    #[test]
    fn discs_of_one_size_are_dots() {
        let fill = Some(crate::scene::Fill { ink: Ink::Category(0), opacity: 0.5 });
        let outline = |radii: [f64; 2]| Outline {
            steps: vec![Step::Disc([1.0, 2.0], radii[0]), Step::Disc([3.0, 4.5], radii[1])],
            fill,
            stroke: None,
        };
        let scene = |radii| Scene { items: vec![Item::Outline(outline(radii))], ..Scene::default() };
        let dots = document(&scene([0.8, 0.8]), Theme::Light);
        assert!(
            dots.contains(r#"stroke-opacity="0.5" stroke-width="1.6" stroke-linecap="round" d="M1 2h0M3 4.5h0""#),
            "{dots}"
        );
        let arcs = document(&scene([0.8, 0.7]), Theme::Light);
        assert!(arcs.contains("fill-opacity") && arcs.contains("a0.7 0.7"), "{arcs}");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([1.0, 1.5, -0.001, 0.25, 100.0, -3.456].map(number), ["1", "1.5", "0", "0.25", "100", "-3.46"]);
    }

    #[test]
    fn text_cannot_leave_its_element() {
        assert_eq!(escaped("a<b> & \"c\"\u{1}\n"), "a&lt;b&gt; &amp; &quot;c&quot;  ");
    }
}
