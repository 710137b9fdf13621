//! The page: one HTML file that needs nothing else, with its figures as inline SVG.
//!
//! Figures and page follow the reader's light or dark setting together. Links lead within the page and to the files
//! that are written to the same folder; nothing is loaded from anywhere.

use super::{Finding, Plate, Report, Section, Table, Verdict};
use crate::units;
use mckibben_plot::{PlotError, Theme};
use std::fmt::Write as _;

/// How a page looks.
pub const STYLE: &str = include_str!("style.css");

/// Writing into a `String` cannot fail.
macro_rules! put {
    ($out:expr, $($arg:tt)*) => {{ let _ = write!($out, $($arg)*); }};
}

impl Report {
    /// The page.
    ///
    /// # Errors
    /// When a figure contradicts itself.
    pub fn to_html(&self) -> Result<String, PlotError> {
        let mut out = String::new();
        put!(out, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
        put!(out, "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
        put!(out, "<meta name=\"color-scheme\" content=\"light dark\">\n");
        put!(out, "<title>{}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n", escaped(&self.title));
        self.navigation(&mut out);
        put!(out, "<main>\n<header id=\"top\">\n<h1>{}</h1>\n", rich(&self.title));
        paragraphs(&mut out, &self.introduction);
        put!(out, "</header>\n");
        if self.has_findings() {
            self.summary_table(&mut out);
        }
        if !self.assumptions.head.is_empty() {
            put!(out, "<section id=\"assumed\">\n<h2>What is assumed</h2>\n");
            table(&mut out, &self.assumptions);
            put!(out, "</section>\n");
        }
        for part in &self.sections {
            section(&mut out, part)?;
        }
        put!(out, "<footer><p>{}</p></footer>\n</main>\n</body>\n</html>\n", rich(&self.colophon));
        Ok(out)
    }

    pub(super) fn has_findings(&self) -> bool {
        self.sections.iter().any(|part| !part.findings.is_empty())
    }

    fn navigation(&self, out: &mut String) {
        put!(out, "<nav aria-label=\"Contents\">\n<ol>\n<li><a href=\"#top\">Top</a></li>\n");
        if self.has_findings() {
            put!(out, "<li><a href=\"#summary\">Summary</a></li>\n");
        }
        if !self.assumptions.head.is_empty() {
            put!(out, "<li><a href=\"#assumed\">Assumed</a></li>\n");
        }
        for part in &self.sections {
            put!(out, "<li><a href=\"#{}\">{}</a></li>\n", part.id, escaped(part.label));
        }
        put!(out, "</ol>\n</nav>\n");
    }

    fn summary_table(&self, out: &mut String) {
        let count = |wanted: &str| {
            let all = self.sections.iter().flat_map(|part| &part.findings);
            all.filter(|finding| finding.verdict.name() == wanted).count()
        };
        put!(out, "<section id=\"summary\">\n<h2>Summary</h2>\n<p class=\"counts\">");
        let mut names = Vec::new();
        for finding in self.sections.iter().flat_map(|part| &part.findings) {
            let name = (finding.verdict.name(), class(&finding.verdict));
            if !names.contains(&name) {
                names.push(name);
            }
        }
        for (name, class) in names {
            put!(out, "<span class=\"verdict {class}\">{name}</span>&nbsp;{} ", count(name));
        }
        put!(out, "</p>\n<div class=\"wide\"><table class=\"findings\">\n<thead><tr><th scope=\"col\">Figure</th>");
        finding_head(out);
        put!(out, "</tr></thead>\n");
        for part in self.sections.iter().filter(|part| !part.findings.is_empty()) {
            put!(out, "<tbody>\n");
            for (place, finding) in part.findings.iter().enumerate() {
                put!(out, "<tr>");
                if place == 0 {
                    let (id, label, rows) = (part.id, escaped(part.label), part.findings.len());
                    put!(out, "<th scope=\"rowgroup\" rowspan=\"{rows}\"><a href=\"#{id}\">{label}</a></th>");
                }
                finding_cells(out, finding, false);
                put!(out, "</tr>\n");
            }
            put!(out, "</tbody>\n");
        }
        put!(out, "</table></div>\n<p class=\"files\"><a href=\"numbers.csv\">numbers.csv</a></p>\n</section>\n");
    }
}

fn section(out: &mut String, part: &Section) -> Result<(), PlotError> {
    put!(out, "<section id=\"{}\">\n", part.id);
    put!(out, "<h2><span class=\"label\">{}</span> {}</h2>\n", escaped(part.label), rich(part.title));
    paragraphs(out, &part.paragraphs);
    for plate in &part.plates {
        figure(out, plate)?;
    }
    for each in &part.tables {
        table(out, each);
    }
    if !part.findings.is_empty() {
        put!(out, "<h3>Findings</h3>\n<div class=\"wide\"><table class=\"findings\">\n<thead><tr>");
        finding_head(out);
        put!(out, "</tr></thead>\n<tbody>\n");
        for finding in &part.findings {
            put!(out, "<tr>");
            finding_cells(out, finding, true);
            put!(out, "</tr>\n");
        }
        put!(out, "</tbody>\n</table></div>\n");
    }
    for (name, text) in &part.files {
        put!(out, "<details><summary>Scenario file <code>{}</code></summary>\n", escaped(name));
        put!(out, "<pre><code>{}</code></pre></details>\n", scenario(text));
    }
    put!(out, "</section>\n");
    Ok(())
}

fn figure(out: &mut String, plate: &Plate) -> Result<(), PlotError> {
    put!(out, "<figure>\n{}", units::drawn(plate.figure.clone()).to_svg(Theme::Auto)?);
    let stem = plate.stem;
    put!(out, "<figcaption>{} <span class=\"files\">", rich(&plate.caption));
    put!(out, "<a href=\"{stem}.svg\">SVG</a> <a href=\"{stem}.png\">PNG</a> <a href=\"{stem}.csv\">CSV</a>");
    put!(out, "</span></figcaption>\n</figure>\n");
    Ok(())
}

fn table(out: &mut String, table: &Table) {
    let table = &*table.in_units();
    if table.head.is_empty() {
        return;
    }
    put!(out, "<div class=\"wide\"><table>\n");
    if !table.caption.is_empty() {
        put!(out, "<caption>{}</caption>\n", rich(&table.caption));
    }
    let class = |column: usize| if table.is_numeric(column) { " class=\"number\"" } else { "" };
    put!(out, "<thead><tr>");
    for (column, name) in table.head.iter().enumerate() {
        put!(out, "<th scope=\"col\"{}>{}</th>", class(column), rich(name));
    }
    put!(out, "</tr></thead>\n<tbody>\n");
    for row in &table.rows {
        put!(out, "<tr>");
        for (column, cell) in row.iter().enumerate() {
            match column {
                0 => put!(out, "<th scope=\"row\">{}</th>", rich(cell)),
                _ => put!(out, "<td{}>{}</td>", class(column), rich(cell)),
            }
        }
        put!(out, "</tr>\n");
    }
    put!(out, "</tbody>\n</table></div>\n");
}

fn finding_head(out: &mut String) {
    for (name, class) in [("Quantity", ""), ("Paper’s text", ""), ("Here", " class=\"number\""), ("Comparison", "")] {
        put!(out, "<th scope=\"col\"{class}>{name}</th>");
    }
}

fn finding_cells(out: &mut String, finding: &Finding, with_reason: bool) {
    let stated = if finding.stated.is_empty() { "–".to_owned() } else { rich(&finding.stated) };
    put!(out, "<td>{}</td><td>{stated}</td>", rich(&finding.quantity));
    put!(out, "<td class=\"number\">{}</td>", finding.shown().replace(' ', "\u{a0}"));
    let (name, class) = (finding.verdict.name(), class(&finding.verdict));
    put!(out, "<td><span class=\"verdict {class}\">{name}</span>");
    if with_reason && !finding.verdict.reason().is_empty() {
        put!(out, " <span class=\"reason\">{}</span>", rich(finding.verdict.reason()));
    }
    put!(out, "</td>");
}

fn class(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Agrees(_) => "agrees",
        Verdict::Differs(_) => "differs",
        Verdict::Input(_) | Verdict::RoundTrip(_) => "input",
        Verdict::NotComparable(_) => "none",
    }
}

fn paragraphs(out: &mut String, paragraphs: &[String]) {
    for paragraph in paragraphs {
        put!(out, "<p>{}</p>\n", rich(paragraph));
    }
}

/// A scenario file with its comments set apart.
fn scenario(text: &str) -> String {
    let mut out = String::new();
    for line in text.lines() {
        // No value of these files holds a `#`, so what follows one is a comment.
        match line.find('#') {
            Some(at) => put!(out, "{}<i>{}</i>\n", escaped(&line[..at]), escaped(&line[at..])),
            None => put!(out, "{}\n", escaped(line)),
        }
    }
    out
}

/// Words as HTML: `x_ab` and `x_{a b}` with a subscript, `` `code` ``, and nothing else with a meaning.
fn rich(words: &str) -> String {
    let mut out = String::new();
    for (place, part) in words.split('`').enumerate() {
        if place % 2 == 1 {
            put!(out, "<code>{}</code>", escaped(part));
        } else {
            subscripts(&mut out, part);
        }
    }
    out
}

fn subscripts(out: &mut String, words: &str) {
    let mut rest = words;
    while let Some(at) = rest.find('_') {
        let (before, after) = (&rest[..at], &rest[at + 1..]);
        out.push_str(&escaped(before));
        let (inner, next) = match after.strip_prefix('{').and_then(|braced| braced.split_once('}')) {
            Some(split) => split,
            None => after.split_at(after.find(|c: char| !c.is_alphanumeric()).unwrap_or(after.len())),
        };
        match inner {
            "" => out.push('_'),
            _ => put!(out, "<sub>{}</sub>", escaped(inner)),
        }
        rest = next;
    }
    out.push_str(&escaped(rest));
}

/// Text escaped for HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_become_html_and_nothing_escapes() {
        assert_eq!(rich("L_min < x_{eq 1}"), "L<sub>min</sub> &lt; x<sub>eq 1</sub>");
        assert_eq!(rich("see `a_b<c` and _"), "see <code>a_b&lt;c</code> and _");
        assert_eq!(scenario("a = \"1 in\" # why\n"), "a = &quot;1 in&quot; <i># why</i>\n");
    }

    #[test]
    fn an_empty_report_is_a_page() {
        let page = Report { title: "T & U".into(), ..Report::default() }.to_html().unwrap();
        assert!(page.starts_with("<!DOCTYPE html>") && page.contains("<title>T &amp; U</title>"));
    }
}
