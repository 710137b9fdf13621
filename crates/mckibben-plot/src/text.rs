//! The built-in face: how wide words are, and their outlines.
//!
//! Noto Sans is compiled in from the crate `notosans` (SIL Open Font License 1.1), so a figure is laid out and drawn
//! without a font on the machine. It is wider than the Helvetica kind; a reader of the SVG who lacks it finds a little
//! more room, not less.
//!
//! Raised and lowered figures, as in N mm⁻¹ or p₀, are drawn from the ordinary ones at [`SCRIPT`] of their size: few
//! faces have them all, and one from another face beside one that is built in looks like a mistake.

use super::PlotError;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// The size of raised and lowered figures, of the ordinary one.
pub(super) const SCRIPT: f64 = 0.66;

/// Where a run of words stands against the baseline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Script {
    Ordinary,
    Raised,
    Lowered,
}

impl Script {
    /// How far its baseline stands above that of the line, and its size, both of the ordinary size.
    pub(super) fn shape(self) -> (f64, f64) {
        match self {
            Script::Ordinary => (0.0, 1.0),
            Script::Raised => (0.34, SCRIPT),
            Script::Lowered => (-0.16, SCRIPT),
        }
    }
}

/// A line of words split where the script changes, with ordinary characters in each part.
pub(super) fn scripts(text: &str) -> Vec<(Script, String)> {
    let mut parts: Vec<(Script, String)> = Vec::new();
    for c in text.chars() {
        let (script, plain) = plain(c);
        match parts.last_mut().filter(|(last, _)| *last == script) {
            Some((_, part)) => part.push(plain),
            None => parts.push((script, plain.to_string())),
        }
    }
    parts
}

fn plain(c: char) -> (Script, char) {
    let figure = |base: u32| char::from_digit(c as u32 - base, 10).unwrap_or(c);
    match c {
        '¹' => (Script::Raised, '1'),
        '²' => (Script::Raised, '2'),
        '³' => (Script::Raised, '3'),
        '⁰' | '⁴'..='⁹' => (Script::Raised, figure(0x2070)),
        '⁺' => (Script::Raised, '+'),
        '⁻' => (Script::Raised, '−'),
        '₀'..='₉' => (Script::Lowered, figure(0x2080)),
        '₊' => (Script::Lowered, '+'),
        '₋' => (Script::Lowered, '−'),
        // A line break or a tab inside a label is a space, and what else cannot be seen is nothing to XML either.
        c if c.is_control() => (Script::Ordinary, ' '),
        c => (Script::Ordinary, c),
    }
}

/// A glyph of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    pub(super) glyph: GlyphId,
    /// What it stands for; a raised figure for an ordinary one.
    pub(super) character: char,
    /// How far along the line it begins, and how high.
    pub(super) along: f64,
    pub(super) rise: f64,
    /// The size that it is drawn in.
    pub(super) size: f64,
}

/// The two weights.
pub(super) struct Faces {
    regular: Face<'static>,
    bold: Face<'static>,
}

impl Faces {
    pub(super) fn load() -> Result<Self, PlotError> {
        let face = |bytes: &'static [u8]| {
            Face::parse(bytes, 0)
                .map_err(|e| PlotError::Raster { reason: format!("the built-in face is damaged: {e}") })
        };
        Ok(Self { regular: face(notosans::REGULAR_TTF)?, bold: face(notosans::BOLD_TTF)? })
    }

    /// A face and its file.
    pub(super) fn face(&self, bold: bool) -> (&Face<'static>, &'static [u8]) {
        if bold { (&self.bold, notosans::BOLD_TTF) } else { (&self.regular, notosans::REGULAR_TTF) }
    }

    /// Walks over the glyphs of a line. Returns the width.
    pub(super) fn walk(&self, text: &str, size: f64, bold: bool, mut visit: impl FnMut(Placed)) -> f64 {
        let (face, _) = self.face(bold);
        let (em, mut x) = (f64::from(face.units_per_em()), 0.0);
        for (script, part) in scripts(text) {
            let (rise, scale) = script.shape();
            for c in part.chars() {
                let glyph = face.glyph_index(c).unwrap_or_default();
                visit(Placed { glyph, character: c, along: x, rise: rise * size, size: size * scale });
                x += size * scale * face.glyph_hor_advance(glyph).map_or(0.6, |advance| f64::from(advance) / em);
            }
        }
        x
    }

    /// The width of a line in the unit of `size`.
    pub(super) fn width(&self, text: &str, size: f64, bold: bool) -> f64 {
        self.walk(text, size, bold, |_| {})
    }

    /// Draws a line, y upwards. Before each glyph `start` gives the pen how far along and how high it begins, and how long a unit of
    /// the face is.
    pub(super) fn draw<P: OutlineBuilder>(
        &self,
        (text, size, bold): (&str, f64, bool),
        pen: &mut P,
        start: impl Fn(&mut P, f64, f64, f64),
    ) {
        let (face, _) = self.face(bold);
        let em = f64::from(face.units_per_em());
        self.walk(text, size, bold, |placed| {
            start(pen, placed.along, placed.rise, placed.size / em);
            // A glyph that cannot be drawn leaves its room empty; the others still say the most.
            let _ = face.outline_glyph(placed.glyph, pen);
        });
    }

    /// Lines no wider than `width`, broken at spaces but not at no-break spaces. A word that is wider by itself is shortened.
    pub(super) fn wrap(&self, text: &str, size: f64, bold: bool, width: f64) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        let is_break = |c: char| c.is_whitespace() && c != '\u{a0}';
        for word in text.split(is_break).filter(|word| !word.is_empty()) {
            match lines.last_mut().filter(|line| self.width(&format!("{line} {word}"), size, bold) <= width) {
                Some(line) => {
                    line.push(' ');
                    line.push_str(word);
                }
                None => lines.push(self.fit(word, size, bold, width)),
            }
        }
        lines
    }

    /// The words, or as much of their beginning as fits before an ellipsis.
    pub(super) fn fit(&self, text: &str, size: f64, bold: bool, width: f64) -> String {
        if self.width(text, size, bold) <= width {
            return text.to_string();
        }
        let mut shorter: Vec<char> = text.chars().collect();
        while shorter.pop().is_some() {
            let line: String = shorter.iter().chain(&['…']).collect();
            if self.width(&line, size, bold) <= width {
                return line;
            }
        }
        String::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_are_split_and_made_plain() {
        let parts = scripts("N mm⁻¹ p₀");
        let texts: Vec<_> = parts.iter().map(|(s, t)| (*s, t.as_str())).collect();
        use Script::{Lowered, Ordinary, Raised};
        assert_eq!(texts, [(Ordinary, "N mm"), (Raised, "−1"), (Ordinary, " p"), (Lowered, "0")]);
    }

    #[test]
    fn the_face_has_what_labels_need() {
        let faces = Faces::load().unwrap();
        for c in "−–·×°µΩαβγδεθλμνπρστφω Δ±≤≥≈∂∞√ ⁻⁰¹²³⁴⁵⁶⁷⁸⁹₀₁₂₃₄₅₆₇₈₉éüß…".chars()
        {
            faces.walk(&c.to_string(), 10.0, false, |placed| assert_ne!(placed.glyph, GlyphId::default(), "{c}"));
        }
    }

    #[test]
    fn words_are_broken_and_shortened() {
        let faces = Faces::load().unwrap();
        let lines = faces.wrap("force of the muscle against its length", 7.0, false, 60.0);
        assert!(lines.len() > 1 && lines.iter().all(|l| faces.width(l, 7.0, false) <= 60.0), "{lines:?}");
        assert_eq!(lines.join(" "), "force of the muscle against its length");
        let short = faces.fit("Donaudampfschifffahrt", 7.0, false, 40.0);
        assert!(short.ends_with('…') && faces.width(&short, 7.0, false) <= 40.0);
        assert!(faces.wrap("", 7.0, false, 10.0).is_empty());
    }
}
