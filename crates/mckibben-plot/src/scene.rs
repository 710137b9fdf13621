//! The few primitives that both back ends draw, in points from the upper left corner.

use super::figure::{Colour, Symbol};

/// A point of the page in points, y downwards.
pub(super) type Point = [f64; 2];

/// What a thing is, from which the theme knows its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Ink {
    Background,
    Text,
    Muted,
    Axis,
    Grid,
    Category(usize),
    /// A place on the ramp in 255ths.
    Ramp(u8),
    /// A place on the colour scale of fields in 255ths.
    Scale(u8),
    /// A place on the diverging colour scale of fields in 255ths, whose middle is zero.
    Diverging(u8),
}

impl From<Colour> for Ink {
    fn from(colour: Colour) -> Self {
        match colour {
            Colour::Neutral => Ink::Text,
            Colour::Category(index) => Ink::Category(index % super::theme::CATEGORIES),
            // A float becomes an integer by saturation, and NaN becomes 0.
            Colour::Ramp(place) => Ink::Ramp((place * 255.0).round() as u8),
        }
    }
}

/// One step of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    Move(Point),
    Line(Point),
    Close,
    /// A full circle.
    Disc(Point, f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fill {
    pub(super) ink: Ink,
    pub(super) opacity: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    pub(super) ink: Ink,
    pub(super) width: f64,
    pub(super) dash: &'static [f64],
}

/// Lines and areas that share their ink.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Outline {
    pub(super) steps: Vec<Step>,
    pub(super) fill: Option<Fill>,
    pub(super) stroke: Option<Stroke>,
}

impl Outline {
    pub(super) fn filled(ink: Ink, opacity: f64) -> Self {
        Self { fill: Some(Fill { ink, opacity }), ..Self::default() }
    }

    pub(super) fn stroked(ink: Ink, width: f64, dash: &'static [f64]) -> Self {
        Self { stroke: Some(Stroke { ink, width, dash }), ..Self::default() }
    }

    pub(super) fn polyline(&mut self, points: &[Point]) {
        let step = |(i, p): (usize, &Point)| if i == 0 { Step::Move(*p) } else { Step::Line(*p) };
        self.steps.extend(points.iter().enumerate().map(step));
    }

    pub(super) fn polygon(&mut self, points: &[Point]) {
        self.polyline(points);
        self.steps.push(Step::Close);
    }

    pub(super) fn rectangle(&mut self, area: Area) {
        let Area { left, top, right, bottom } = area;
        self.polygon(&[[left, top], [right, top], [right, bottom], [left, bottom]]);
    }

    /// A symbol whose areas look equally large; `radius` is that of the disc.
    pub(super) fn symbol(&mut self, symbol: Symbol, [x, y]: Point, radius: f64) {
        let r = radius;
        match symbol {
            Symbol::Circle => self.steps.push(Step::Disc([x, y], r)),
            Symbol::Square => {
                let h = 0.89 * r;
                self.rectangle(Area { left: x - h, top: y - h, right: x + h, bottom: y + h });
            }
            Symbol::Triangle => {
                self.polygon(&[[x, y - 1.3 * r], [x + 1.13 * r, y + 0.72 * r], [x - 1.13 * r, y + 0.72 * r]]);
            }
            Symbol::TriangleDown => {
                self.polygon(&[[x, y + 1.3 * r], [x + 1.13 * r, y - 0.72 * r], [x - 1.13 * r, y - 0.72 * r]]);
            }
            Symbol::Diamond => {
                let d = 1.28 * r;
                self.polygon(&[[x, y - d], [x + d, y], [x, y + d], [x - d, y]]);
            }
            Symbol::TriangleLeft => {
                self.polygon(&[[x - 1.3 * r, y], [x + 0.72 * r, y + 1.13 * r], [x + 0.72 * r, y - 1.13 * r]]);
            }
            Symbol::TriangleRight => {
                self.polygon(&[[x + 1.3 * r, y], [x - 0.72 * r, y + 1.13 * r], [x - 0.72 * r, y - 1.13 * r]]);
            }
            Symbol::Hourglass => {
                let (w, h) = (1.05 * r, 1.2 * r);
                self.polygon(&[[x - w, y - h], [x + w, y - h], [x - w, y + h], [x + w, y + h]]);
            }
            Symbol::Bowtie => {
                let (w, h) = (1.2 * r, 1.05 * r);
                self.polygon(&[[x - w, y - h], [x - w, y + h], [x + w, y - h], [x + w, y + h]]);
            }
            Symbol::Star => {
                for turn in [0.5, 1.0 / 6.0, -1.0 / 6.0].map(|half_turns: f64| half_turns * std::f64::consts::PI) {
                    let (u, v) = (1.25 * r * turn.cos(), 1.25 * r * turn.sin());
                    self.polyline(&[[x - u, y - v], [x + u, y + v]]);
                }
            }
            Symbol::ChevronUp => self.polyline(&[[x - r, y + 0.6 * r], [x, y - 0.7 * r], [x + r, y + 0.6 * r]]),
            Symbol::ChevronDown => self.polyline(&[[x - r, y - 0.6 * r], [x, y + 0.7 * r], [x + r, y - 0.6 * r]]),
            Symbol::ChevronLeft => self.polyline(&[[x + 0.6 * r, y - r], [x - 0.7 * r, y], [x + 0.6 * r, y + r]]),
            Symbol::ChevronRight => self.polyline(&[[x - 0.6 * r, y - r], [x + 0.7 * r, y], [x - 0.6 * r, y + r]]),
            Symbol::CirclePlus | Symbol::CircleCross | Symbol::SquareCross | Symbol::DiamondPlus => {
                let (around, within, share) = match symbol {
                    Symbol::CirclePlus => (Symbol::Circle, Symbol::Plus, 0.87),
                    Symbol::CircleCross => (Symbol::Circle, Symbol::Cross, 0.78),
                    Symbol::SquareCross => (Symbol::Square, Symbol::Cross, 0.98),
                    _ => (Symbol::Diamond, Symbol::Plus, 1.1),
                };
                self.symbol(around, [x, y], 1.1 * r);
                self.symbol(within, [x, y], 1.1 * share * r);
            }
            Symbol::Plus => {
                self.polyline(&[[x - 1.15 * r, y], [x + 1.15 * r, y]]);
                self.polyline(&[[x, y - 1.15 * r], [x, y + 1.15 * r]]);
            }
            Symbol::Cross => {
                let d = 0.9 * r;
                self.polyline(&[[x - d, y - d], [x + d, y + d]]);
                self.polyline(&[[x - d, y + d], [x + d, y - d]]);
            }
        }
    }
}

/// Whether a symbol consists of strokes alone.
pub(super) fn is_open(symbol: Symbol) -> bool {
    use Symbol::{ChevronDown, ChevronLeft, ChevronRight, ChevronUp, Cross, Plus, Star};
    matches!(symbol, Plus | Cross | Star | ChevronUp | ChevronDown | ChevronLeft | ChevronRight)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of words.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Words {
    /// Where the anchor stands on the baseline.
    pub(super) at: Point,
    pub(super) anchor: Anchor,
    pub(super) size: f64,
    pub(super) bold: bool,
    /// Read from below, as a vertical axis is labelled.
    pub(super) rotated: bool,
    /// Surrounded by the background, where words stand on lines.
    pub(super) halo: bool,
    pub(super) ink: Ink,
    pub(super) text: String,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Item {
    Outline(Outline),
    Words(Words),
}

/// A figure ready to be drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Scene {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) title: String,
    pub(super) description: String,
    pub(super) items: Vec<Item>,
}

impl Scene {
    /// Adds lines and areas, unless there are none.
    pub(super) fn outline(&mut self, outline: Outline) {
        if !outline.steps.is_empty() {
            self.items.push(Item::Outline(outline));
        }
    }

    pub(super) fn words(&mut self, words: Words) {
        if !words.text.is_empty() {
            self.items.push(Item::Words(words));
        }
    }
}

/// A rectangle of the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Area {
    pub(super) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(super) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// Whether a point lies within, its edges included: a value at the end of an axis is shown, whatever the rounding.
    pub(super) fn contains(&self, [x, y]: Point) -> bool {
        const ROUNDING: f64 = 1e-6;
        (self.left - ROUNDING..=self.right + ROUNDING).contains(&x)
            && (self.top - ROUNDING..=self.bottom + ROUNDING).contains(&y)
    }
}
