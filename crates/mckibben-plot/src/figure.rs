//! What a figure shows: panels, and the series, spans, marks and reference lines in them.
//!
//! Everything is plain data. Columns are `f64`, and a value that is not finite is a gap.

use super::{Axis, PlotError};

/// Which colour a thing is drawn in. Colours adapt to the theme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Colour {
    /// Grey, for what frames the data: an open valve, a tolerance.
    Neutral,
    /// One of seven colours that the colour-blind can distinguish, counted from 0 and repeated after the seventh. The
    /// number also chooses the dash pattern or the symbol.
    Category(usize),
    /// A place on a ramp of one direction from 0 to 1, for families of curves that have an order, such as pressures.
    Ramp(f64),
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Straight lines from point to point.
    #[default]
    Line,
    /// A symbol at each point.
    Points,
    /// A small dot at each point, for clouds.
    Dots,
    /// A line with a symbol at each point.
    LineAndPoints,
    /// Each value is held until the next: commands, valve positions.
    Steps,
}

/// The pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    /// No gaps.
    Solid,
    /// Dashes.
    Dashed,
    /// A dash, a dot.
    DashDot,
    /// Dots.
    Dotted,
    /// Long dashes.
    LongDash,
    /// A dash, two dots.
    DashDotDot,
}

/// The shape at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Symbol {
    /// A disc.
    #[default]
    Circle,
    /// A square.
    Square,
    /// A triangle that points up.
    Triangle,
    /// A square on its corner.
    Diamond,
    /// A triangle that points down.
    TriangleDown,
    /// An upright cross.
    Plus,
    /// A diagonal cross.
    Cross,
    /// A triangle that points left.
    TriangleLeft,
    /// A triangle that points right.
    TriangleRight,
    /// Two triangles that meet in their points, one above the other.
    Hourglass,
    /// Two triangles that meet in their points, side by side.
    Bowtie,
    /// Six rays.
    Star,
    /// An angle that points up.
    ChevronUp,
    /// An angle that points down.
    ChevronDown,
    /// An angle that points left.
    ChevronLeft,
    /// An angle that points right.
    ChevronRight,
    /// A disc with an upright cross in it.
    CirclePlus,
    /// A disc with a diagonal cross in it.
    CircleCross,
    /// A square with a diagonal cross in it.
    SquareCross,
    /// A square on its corner with an upright cross in it.
    DiamondPlus,
}

/// One curve or cloud of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Its name in the legend; without one it is not listed.
    pub label: String,
    /// The horizontal values, in any order: a loop may run back.
    pub x: Vec<f64>,
    /// The vertical values, as many.
    pub y: Vec<f64>,
    /// How it is drawn.
    pub style: Style,
    /// Its colour.
    pub colour: Colour,
    /// Its pattern. Where none is given, the only line of a panel is solid and the others follow their colour.
    pub dash: Option<Dash>,
}

impl Series {
    /// A curve in the first colour.
    pub fn line(label: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { label: label.into(), x, y, style: Style::Line, colour: Colour::Category(0), dash: None }
    }

    /// A cloud of points in the first colour.
    pub fn points(label: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { style: Style::Points, ..Self::line(label, x, y) }
    }

    /// A cloud of many points as dots in the first colour.
    pub fn dots(label: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { style: Style::Dots, ..Self::line(label, x, y) }
    }

    /// A staircase in the first colour.
    pub fn steps(label: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { style: Style::Steps, ..Self::line(label, x, y) }
    }

    /// Returns the series in another colour.
    #[must_use]
    pub fn colour(mut self, colour: Colour) -> Self {
        self.colour = colour;
        self
    }

    /// Returns the series with its pattern stated.
    #[must_use]
    pub fn dash(mut self, dash: Dash) -> Self {
        self.dash = Some(dash);
        self
    }
}

/// What a [`Span`] shades.
#[derive(Clone, Debug, PartialEq)]
pub enum Extent {
    /// The full height of the panel within these intervals of x, each as (from, to).
    Horizontal(Vec<(f64, f64)>),
    /// The full width of the panel between two values of y.
    Vertical(f64, f64),
    /// The area between two curves over the same x: an uncertainty, a tolerance.
    Between {
        /// The common horizontal values, rising.
        x: Vec<f64>,
        /// The lower curve.
        lower: Vec<f64>,
        /// The upper curve.
        upper: Vec<f64>,
    },
}

/// A shaded part of a panel, behind the data.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// Its name in the legend; without one it is not listed.
    pub label: String,
    /// What it covers.
    pub length_regime: Extent,
    /// Its colour, which is drawn thin.
    pub colour: Colour,
}

impl Span {
    /// Grey intervals of x, such as those in which a valve is open.
    pub fn intervals(label: impl Into<String>, intervals: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), length_regime: Extent::Horizontal(intervals), colour: Colour::Neutral }
    }

    /// A grey strip between two values of y.
    pub fn strip(label: impl Into<String>, from: f64, to: f64) -> Self {
        Self { label: label.into(), length_regime: Extent::Vertical(from, to), colour: Colour::Neutral }
    }

    /// The area between two curves, in the first colour.
    pub fn between(label: impl Into<String>, x: Vec<f64>, lower: Vec<f64>, upper: Vec<f64>) -> Self {
        Self { label: label.into(), length_regime: Extent::Between { x, lower, upper }, colour: Colour::Category(0) }
    }

    /// Returns the span in another colour.
    #[must_use]
    pub fn colour(mut self, colour: Colour) -> Self {
        self.colour = colour;
        self
    }
}

/// A thin row of bars above the axes: when something is so, such as a valve open.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// Its name in the legend; without one it is not listed.
    pub label: String,
    /// The intervals of x that are covered, each as (from, to).
    pub intervals: Vec<(f64, f64)>,
    /// Its colour.
    pub colour: Colour,
}

/// Events: small symbols, hollow or filled, on a curve or along the upper edge of the panel. Those that would stand on
/// others are moved up from the curve, with a thin line to where they belong, unless their place is what they say.
#[derive(Clone, Debug, PartialEq)]
pub struct Marks {
    /// Their name in the legend; without one they are not listed.
    pub label: String,
    /// When.
    pub x: Vec<f64>,
    /// At which value. Empty: they stand on the upper edge, outside the axes.
    pub y: Vec<f64>,
    /// Their shape.
    pub symbol: Symbol,
    /// Whether a shape that has an inside is filled.
    pub filled: bool,
    /// Whether they stay where they are, also on others: of points both coordinates are read.
    pub stay: bool,
    /// Their colour.
    pub colour: Colour,
}

impl Marks {
    /// Marks on a curve, in the colour of text.
    pub fn at(label: impl Into<String>, symbol: Symbol, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { label: label.into(), x, y, symbol, filled: false, stay: false, colour: Colour::Neutral }
    }

    /// Marks on the upper edge of the panel.
    pub fn on_edge(label: impl Into<String>, symbol: Symbol, x: Vec<f64>) -> Self {
        Self { label: label.into(), x, y: Vec::new(), symbol, filled: false, stay: false, colour: Colour::Neutral }
    }

    /// Returns the marks with their inside filled.
    #[must_use]
    pub fn filled(mut self) -> Self {
        self.filled = true;
        self
    }

    /// Returns the marks such that they stay where they are, also on others.
    #[must_use]
    pub fn staying(mut self) -> Self {
        self.stay = true;
        self
    }

    /// Returns the marks in another colour.
    #[must_use]
    pub fn colour(mut self, colour: Colour) -> Self {
        self.colour = colour;
        self
    }
}

/// A thin straight line across a panel, with words on it.
#[derive(Clone, Debug, PartialEq)]
pub enum Reference {
    /// At a value of y.
    Horizontal {
        /// Where.
        y: f64,
        /// Its words; may be empty.
        label: String,
        /// That of the curve that it belongs to; neutral where it belongs to none or to all.
        colour: Colour,
    },
    /// At a value of x.
    Vertical {
        /// Where.
        x: f64,
        /// Its words; may be empty.
        label: String,
    },
}

/// A quantity over the plane, as coloured cells behind everything else, with its scale beside the axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Field {
    /// The quantity, such as `tension`.
    pub label: String,
    /// The unit of its values. Empty for none.
    pub unit: String,
    /// The horizontal centres of the cells, rising.
    pub x: Vec<f64>,
    /// The vertical centres of the cells, rising.
    pub y: Vec<f64>,
    /// The values, first all of the first y. A value that is not finite is an empty cell.
    pub values: Vec<f64>,
}

/// Where the names of the series go. None of these places covers data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Legend {
    /// At the ends of the curves for a family on a ramp, above the axes otherwise, and nowhere for what only repeats
    /// the vertical axis or an upper panel.
    #[default]
    Auto,
    /// In rows above the axes.
    Above,
    /// In the right margin, each beside the end of its curve.
    Direct,
    /// Nowhere.
    Hidden,
}

/// One pair of axes of a figure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// The vertical axis.
    pub y: Axis,
    /// The coloured cells.
    pub field: Option<Field>,
    /// The curves and points.
    pub series: Vec<Series>,
    /// The shaded parts.
    pub spans: Vec<Span>,
    /// The rows of bars above the axes, from the top.
    pub strips: Vec<Strip>,
    /// The events.
    pub marks: Vec<Marks>,
    /// The straight lines.
    pub references: Vec<Reference>,
    /// Where the names go.
    pub legend: Legend,
    /// The height of the axes in mm, where it should differ from the figure's.
    pub height_mm: Option<f64>,
}

impl Panel {
    /// An empty panel with this vertical axis.
    pub fn new(y: Axis) -> Self {
        Self { y, ..Self::default() }
    }

    /// Returns the panel with coloured cells.
    #[must_use]
    pub fn field(mut self, field: Field) -> Self {
        self.field = Some(field);
        self
    }

    /// Returns the panel with one more series.
    #[must_use]
    pub fn series(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Returns the panel with one more shaded part.
    #[must_use]
    pub fn span(mut self, span: Span) -> Self {
        self.spans.push(span);
        self
    }

    /// Returns the panel with one more row of bars above the axes.
    #[must_use]
    pub fn strip(mut self, strip: Strip) -> Self {
        self.strips.push(strip);
        self
    }

    /// Returns the panel with one more set of events.
    #[must_use]
    pub fn marks(mut self, marks: Marks) -> Self {
        self.marks.push(marks);
        self
    }

    /// Returns the panel with a line at a value of y.
    #[must_use]
    pub fn horizontal(self, y: f64, label: impl Into<String>) -> Self {
        self.horizontal_of(y, label, Colour::Neutral)
    }

    /// Returns the panel with a line at a value of y in the colour of the curve that it belongs to.
    #[must_use]
    pub fn horizontal_of(mut self, y: f64, label: impl Into<String>, colour: Colour) -> Self {
        self.references.push(Reference::Horizontal { y, label: label.into(), colour });
        self
    }

    /// Returns the panel with a line at a value of x.
    #[must_use]
    pub fn vertical(mut self, x: f64, label: impl Into<String>) -> Self {
        self.references.push(Reference::Vertical { x, label: label.into() });
        self
    }

    /// Returns the panel with its names elsewhere.
    #[must_use]
    pub fn legend(mut self, legend: Legend) -> Self {
        self.legend = legend;
        self
    }

    /// Returns the panel with its own height, in mm.
    #[must_use]
    pub fn height_mm(mut self, height: f64) -> Self {
        self.height_mm = Some(height);
        self
    }
}

/// Panels stacked over one horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The words above; may be empty.
    pub title: String,
    /// Smaller words under the title; may be empty.
    pub note: String,
    /// The words below; may be empty.
    pub caption: String,
    /// The width of the whole figure in mm.
    pub width_mm: f64,
    /// The height of the axes of each panel in mm.
    pub panel_height_mm: f64,
    /// The common horizontal axis.
    pub x: Axis,
    /// The panels, from the top.
    pub panels: Vec<Panel>,
}

impl Default for Figure {
    /// One column of a two-column journal: 85 mm wide, panels of 32 mm.
    fn default() -> Self {
        Self {
            title: String::new(),
            note: String::new(),
            caption: String::new(),
            width_mm: 85.0,
            panel_height_mm: 32.0,
            x: Axis::default(),
            panels: Vec::new(),
        }
    }
}

impl Figure {
    /// An empty figure, one column wide, with this horizontal axis.
    pub fn new(x: Axis) -> Self {
        Self { x, ..Self::default() }
    }

    /// Returns the figure with words above.
    #[must_use]
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// Returns the figure with smaller words under the title.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// Returns the figure with words below.
    #[must_use]
    pub fn caption(mut self, caption: impl Into<String>) -> Self {
        self.caption = caption.into();
        self
    }

    /// Returns the figure with one more panel at the bottom.
    #[must_use]
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// Returns the figure in another size, in mm: the whole width, and the height of each panel's axes.
    #[must_use]
    pub fn size_mm(mut self, width: f64, panel_height: f64) -> Self {
        (self.width_mm, self.panel_height_mm) = (width, panel_height);
        self
    }

    /// Refuses what cannot be drawn, so that everything after this is free of errors.
    pub(super) fn validate(&self) -> Result<(), PlotError> {
        let within = |name, value: f64, low: f64, high: f64, range| {
            let fine = (low..=high).contains(&value);
            if fine { Ok(()) } else { Err(PlotError::Dimension { name, value, unit: "mm", range }) }
        };
        within("the width of the figure", self.width_mm, 40.0, 1000.0, "40 to 1000 mm")?;
        within("the height of a panel", self.panel_height_mm, 4.0, 1000.0, "4 to 1000 mm")?;
        self.x.validate()?;
        for panel in &self.panels {
            if let Some(height) = panel.height_mm {
                within("the height of a panel", height, 4.0, 1000.0, "4 to 1000 mm")?;
            }
            panel.y.validate()?;
            panel.columns()?;
        }
        Ok(())
    }
}

impl Panel {
    /// Columns that belong together have one length.
    fn columns(&self) -> Result<(), PlotError> {
        let equal = |label: &str, x: usize, y: usize| match x == y {
            true => Ok(()),
            false => Err(PlotError::Columns { label: label.to_string(), x, y }),
        };
        if let Some(field) = &self.field {
            equal(&field.label, field.x.len() * field.y.len(), field.values.len())?;
            for centres in [&field.x, &field.y] {
                if let Some(pair) = centres.windows(2).find(|pair| pair[0].is_nan() || pair[1] <= pair[0]) {
                    return Err(PlotError::Range { axis: field.label.clone(), min: pair[0], max: pair[1] });
                }
            }
        }
        for series in &self.series {
            equal(&series.label, series.x.len(), series.y.len())?;
        }
        for marks in self.marks.iter().filter(|marks| !marks.y.is_empty()) {
            equal(&marks.label, marks.x.len(), marks.y.len())?;
        }
        for span in &self.spans {
            if let Extent::Between { x, lower, upper } = &span.length_regime {
                equal(&span.label, x.len(), lower.len())?;
                equal(&span.label, x.len(), upper.len())?;
            }
        }
        Ok(())
    }
}
