//! Figures as a page that is read in a browser: it can be zoomed, read at the cursor, and its curves taken away one by one.
//!
//! The page is one file that loads nothing. `page.js` draws the data that stand in it as JSON. A figure with coloured cells, which
//! the script does not draw, stands on the page as SVG.

use super::axis::Scale;
use super::figure::{Colour, Dash, Extent, Figure, Panel, Reference, Series, Style};
use super::scene::Ink;
use super::theme::{Theme, colour};
use super::{Axis, PlotError};
use std::fmt::Write as _;

const SCRIPT: &str = include_str!("page.js");
const STYLE: &str = "body{font:14px Noto Sans,Helvetica,Arial,sans-serif;max-width:900px;margin:1em auto;padding:0 1em}\
    text{font-size:12px;fill:currentColor}.muted,.read{opacity:.7}.read{min-height:2.6em;margin:0}.grid{stroke:#8884}\
    .axis,.cursor{stroke:#888;fill:none}.rule{stroke:#888;stroke-dasharray:4 2}svg[data-panel]{width:100%;cursor:crosshair}section p{\
    text-align:center;margin:.2em}button{background:none;border:0;font:inherit;cursor:pointer;color:inherit}button.off{opacity:\
    .35}i{display:inline-block;width:14px;height:4px;margin-right:5px;vertical-align:middle}";

/// Words and figures, one below the other, as a page.
pub(super) fn page(title: &str, notes: &[&str], figures: &[Figure]) -> Result<String, PlotError> {
    let mut data = String::from("{\"figures\":[");
    let mut fixed = String::new();
    let mut first = true;
    for figure in figures {
        figure.validate()?;
        if figure.panels.iter().any(|panel| panel.field.is_some()) {
            fixed.push_str(&figure.to_svg(Theme::Light)?);
            continue;
        }
        data.push_str(if first { "" } else { "," });
        first = false;
        one(&mut data, figure);
    }
    data.push_str("]}");
    let words = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;");
    let notes: String = notes
        .iter()
        .filter(|note| !note.is_empty())
        .map(|note| format!("<p class=\"muted\">{}</p>", words(note)))
        .collect();
    let title = words(title);
    let help = "Drag to zoom, double-click for the whole, click a name to take its curves away.";
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title><style>{STYLE}</style></head>\n\
         <body><h3>{title}</h3>{notes}<p class=\"muted\">{help}</p>{fixed}<main></main>\n\
         <script id=\"data\" type=\"application/json\">{data}</script>\n<script>\n{SCRIPT}</script></body></html>\n"
    ))
}

fn one(out: &mut String, figure: &Figure) {
    let xs = || figure.panels.iter().flat_map(|panel| &panel.series).flat_map(|series| &series.x).copied();
    let seen = xs().filter(|x| figure.x.scale.admits(*x));
    let (low, high) = seen.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let ends = if low < high { (low, high) } else { (0.0, 1.0) };
    let x = Axis { min: figure.x.min.or(Some(ends.0)), max: figure.x.max.or(Some(ends.1)), ..figure.x.clone() };
    out.push_str("{\"x\":");
    axis(out, &x);
    out.push_str(",\"panels\":[");
    for (index, its) in figure.panels.iter().enumerate() {
        out.push_str(if index == 0 { "" } else { "," });
        panel(out, its);
    }
    out.push_str("]}");
}

fn panel(out: &mut String, of: &Panel) {
    out.push_str("{\"y\":");
    axis(out, &of.y);
    list(out, "series", &of.series, |out, series| {
        let (steps, points) =
            (series.style == Style::Steps, matches!(series.style, Style::Points | Style::Dots | Style::LineAndPoints));
        let _ =
            write!(out, "{{\"label\":{},\"key\":{},", string(&series.label), string(&key(series.colour, series.dash)));
        let dash = pattern(series);
        let _ = write!(
            out,
            "\"colour\":\"{}\",\"dash\":\"{dash}\",\"steps\":{steps},\"points\":{points}",
            hex(series.colour)
        );
        let _ = write!(out, ",\"x\":{},\"y\":{}}}", numbers(&series.x), numbers(&series.y));
    });
    let bands = of.spans.iter().filter_map(|span| match &span.length_regime {
        Extent::Between { x, lower, upper } => Some((span.colour, x, lower, upper)),
        _ => None,
    });
    let bands: Vec<_> = bands.collect();
    list(out, "bands", &bands, |out, (of, x, lower, upper)| {
        let _ = write!(out, "{{\"key\":{},\"colour\":\"{}\",", string(&key(*of, Some(Dash::Solid))), hex(*of));
        let _ = write!(out, "\"x\":{},\"lower\":{},\"upper\":{}}}", numbers(x), numbers(lower), numbers(upper));
    });
    list(out, "strips", &of.strips, |out, strip| {
        let intervals: Vec<String> = strip.intervals.iter().map(|(from, to)| numbers(&[*from, *to])).collect();
        let _ = write!(out, "{{\"colour\":\"{}\",\"intervals\":[{}]}}", hex(strip.colour), intervals.join(","));
    });
    list(out, "marks", &of.marks, |out, marks| {
        let _ = write!(out, "{{\"label\":{},\"colour\":\"{}\",", string(&marks.label), hex(marks.colour));
        let _ = write!(out, "\"filled\":{},\"x\":{},\"y\":{}}}", marks.filled, numbers(&marks.x), numbers(&marks.y));
    });
    let lines = of.references.iter().filter_map(|reference| match reference {
        Reference::Horizontal { y, label, .. } => Some((*y, label)),
        Reference::Vertical { .. } => None,
    });
    let lines: Vec<_> = lines.collect();
    list(out, "references", &lines, |out, (y, label)| {
        let _ = write!(out, "{{\"y\":{},\"label\":{}}}", number(*y), string(label));
    });
    out.push('}');
}

fn list<T>(out: &mut String, name: &str, items: &[T], mut write: impl FnMut(&mut String, &T)) {
    let _ = write!(out, ",\"{name}\":[");
    for (index, item) in items.iter().enumerate() {
        out.push_str(if index == 0 { "" } else { "," });
        write(out, item);
    }
    out.push(']');
}

fn axis(out: &mut String, of: &Axis) {
    let title = if of.unit.is_empty() { of.label.clone() } else { format!("{} ({})", of.label, of.unit) };
    let words: Vec<String> =
        of.words.iter().map(|(value, word)| format!("[{},{}]", number(*value), string(word))).collect();
    let end = |end: Option<f64>| end.map_or("null".to_owned(), number);
    let _ = write!(out, "{{\"title\":{},\"log\":{},", string(&title), of.scale == Scale::Logarithmic);
    let _ = write!(out, "\"min\":{},\"max\":{},\"words\":[{}]}}", end(of.min), end(of.max), words.join(","));
}

/// What curves that are taken away together have in common.
fn key(colour: Colour, dash: Option<Dash>) -> String {
    format!("{colour:?} {:?}", dash.unwrap_or(Dash::Solid))
}

fn pattern(series: &Series) -> &'static str {
    match series.dash {
        None | Some(Dash::Solid) => "",
        Some(Dash::Dashed) => "6 3",
        Some(Dash::DashDot) => "7 2 2 2",
        Some(Dash::Dotted) => "2 2",
        Some(Dash::LongDash) => "11 3",
        Some(Dash::DashDotDot) => "7 2 2 2 2 2",
    }
}

/// A colour; that of text is the text's, light or dark.
fn hex(of: Colour) -> String {
    if of == Colour::Neutral {
        return "currentColor".to_owned();
    }
    let [r, g, b] = colour(Ink::from(of), false);
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn numbers(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|value| number(*value)).collect();
    format!("[{}]", all.join(","))
}

/// A number in seven digits, which a screen cannot exceed; `null` for what is none.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(f64::NAN);
    if rounded.is_finite() { format!("{rounded}") } else { "null".to_owned() }
}

/// A string that cannot leave its element.
fn string(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            '<' | '>' | '&' => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_one_file_whose_words_stay_words() {
        let series = Series::line("</script><b>", vec![0.0, 1.0, 2.0], vec![1.0, f64::NAN, 3.0]);
        let panel = Panel::new(Axis::new("a \"b\"", "m")).series(series);
        let figure = Figure::new(Axis::new("time", "s")).panel(panel);
        let page = page("<i>", &["a & b"], &[figure]).unwrap();
        assert_eq!((page.matches("<script").count(), page.matches("</script>").count()), (2, 2), "{page}");
        assert!(page.contains("\"y\":[1,null,3]") && page.contains("a \\\"b\\\""), "{page}");
        for outside in ["http:", "https:", "src=", "import ", "fetch(", "@import", "url("] {
            assert!(!page.contains(outside), "{outside}");
        }
        assert!(SCRIPT.lines().count() < 200);
    }
}
