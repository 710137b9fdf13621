//! Figures for papers and reports: stacked panels over one horizontal axis, as SVG, PNG or PDF.
//!
//! A [`Figure`] is data and words only. `layout` turns it into a list of primitives in points (1 pt = 1/72 inch), and
//! three small back ends write that one list, so the SVG, the PNG and the PDF of a figure are the same picture.
//!
//! | file | its idea |
//! |---|---|
//! | `figure`, `axis` | what is to be shown: panels, series, spans, marks, references, over linear or logarithmic axes |
//! | `convert` | a figure in other units |
//! | `range` | the interval of an axis, and where a value lies in it |
//! | `ticks`, `decades` | round tick values of linear and of logarithmic axes, SI prefixes, offsets |
//! | `decimate` | the fewest points that draw the same curve |
//! | `text` | widths and outlines of the built-in face |
//! | `layout`, `legend`, `draw`, `field`, `beside` | where everything goes |
//! | `scene`, `theme`, `scale` | the primitives and their colours |
//! | `svg`, `raster`, `pdf` | the three back ends |
//! | `page`, `page.js` | a page for a browser, with zoom, cursor and curves that can be taken away |
//!
//! What holds for every figure, and the tests that hold it:
//!
//! * The same figure gives the same bytes (`the_same_figure_gives_the_same_bytes`).
//! * A point that is NaN or infinite is a gap, never a line to somewhere (`decimate::tests`).
//! * A value that a logarithmic axis has no place for, zero or negative, is a gap too
//!   (`what_has_no_logarithm_is_a_gap`).
//! * A long series is reduced to what its ink can show; the extremes of each column of 0.09 mm stay to within 7 µm
//!   (`decimate::tests::extremes_survive`, `a_long_series_gives_a_small_file`).
//! * A legend stands outside the axes, and the words on a reference line move there before they would cover data
//!   (`words_on_a_reference_line_leave_before_they_cover_data`).
//! * Nothing is read from the machine: the PNG uses the Noto Sans that is compiled in, the PDF holds what it shows of
//!   it, and the SVG names a stack of common faces with that one first.
//!
//! Colours follow M. Okabe and K. Ito, "Color Universal Design" (2008), and each is paired with a dash pattern or a
//! symbol so that a grey copy stays readable.

#![forbid(unsafe_code)]

mod axis;
mod beside;
mod convert;
mod decades;
mod decimate;
mod draw;
mod field;
mod figure;
mod layout;
mod legend;
mod page;
mod pdf;
mod range;
mod raster;
mod scale;
mod scene;
mod svg;
mod text;
mod theme;
mod ticks;

pub use axis::{Axis, Scale};
pub use beside::SideBySide;
pub use convert::Conversion;
pub use figure::{
    Colour, Dash, Extent, Field, Figure, Legend, Marks, Panel, Reference, Series, Span, Strip, Style, Symbol,
};
pub use theme::Theme;

use std::path::{Path, PathBuf};
use thiserror::Error;

/// The scale of the PNG in a file: 300 pixels per inch, which journals require of a raster figure.
pub const PRINT_SCALE: f64 = 300.0 / 96.0;

/// Why a figure could not be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlotError {
    /// The columns of a series differ in length.
    #[error("series \"{label}\" has {x} values of x and {y} of y; give as many of one as of the other")]
    Columns {
        /// The label of the series, marks or band.
        label: String,
        /// How many values of x there are.
        x: usize,
        /// How many values of y there are.
        y: usize,
    },
    /// A dimension of the figure cannot be drawn.
    #[error("{name} = {value} {unit} cannot be drawn; it must lie in {range}")]
    Dimension {
        /// What is wrong.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: &'static str,
        /// What would be right.
        range: &'static str,
    },
    /// The two ends of an axis do not make an interval.
    #[error("the axis \"{axis}\" runs from {min} to {max}; its lower end must be the smaller, and both finite")]
    Range {
        /// The label of the axis.
        axis: String,
        /// Its lower end.
        min: f64,
        /// Its upper end.
        max: f64,
    },
    /// A logarithmic axis is given an end that has no logarithm.
    #[error("the logarithmic axis \"{axis}\" has an end at {end}; give a positive one")]
    Logarithm {
        /// The label of the axis.
        axis: String,
        /// The end.
        end: f64,
    },
    /// The name of the file does not say which format to write.
    #[error("`{path}` does not say how to draw the figure: its name ends with none of .svg, .png, .pdf and .html")]
    Ending {
        /// The requested file.
        path: PathBuf,
    },
    /// The raster could not be made.
    #[error("the figure could not be drawn as PNG: {reason}")]
    Raster {
        /// What went wrong.
        reason: String,
    },
    /// The PDF could not be made.
    #[error("the figure could not be drawn as PDF: {reason}")]
    Document {
        /// What went wrong.
        reason: String,
    },
}

impl Figure {
    /// The figure as a self-contained SVG document.
    ///
    /// # Errors
    /// [`PlotError::Columns`], [`PlotError::Dimension`], [`PlotError::Range`] or [`PlotError::Logarithm`] when the figure contradicts itself.
    pub fn to_svg(&self, theme: Theme) -> Result<String, PlotError> {
        Ok(svg::document(&layout::scene(self)?, theme))
    }

    /// The figure as a PNG. A `scale` of 1 is 96 pixels per inch; [`PRINT_SCALE`] is 300. The file states its
    /// resolution, so it takes its true width in a document. [`Theme::Auto`] is drawn as light.
    ///
    /// # Errors
    /// As [`Figure::to_svg`]; also [`PlotError::Dimension`] when `scale` is not within 0.25 to 16.
    pub fn to_png(&self, theme: Theme, scale: f64) -> Result<Vec<u8>, PlotError> {
        raster::png(&layout::scene(self)?, theme, scale)
    }

    /// The figure as a PDF of one page in its true width, with its words as text in embedded fonts. [`Theme::Auto`] is
    /// drawn as light.
    ///
    /// # Errors
    /// As [`Figure::to_svg`].
    pub fn to_pdf(&self, theme: Theme) -> Result<Vec<u8>, PlotError> {
        pdf::document(&layout::scene(self)?, theme)
    }

    /// The figure as a file that is read on paper: light, a PNG at [`PRINT_SCALE`].
    ///
    /// # Errors
    /// As [`Figure::to_svg`].
    pub fn bytes(&self, format: Format) -> Result<Vec<u8>, PlotError> {
        if format == Format::Html {
            return Ok(page::page(&self.title, &[&self.note, &self.caption], std::slice::from_ref(self))?.into_bytes());
        }
        bytes(&layout::scene(self)?, format)
    }
}

/// What a file of a figure holds.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Format {
    /// Scalable vector graphics.
    Svg,
    /// A raster of 300 pixels per inch.
    Png,
    /// A page as large as the figure.
    Pdf,
    /// A page for a browser, with zoom and cursor.
    Html,
}

impl Format {
    /// The format that a file's ending selects.
    ///
    /// # Errors
    /// [`PlotError::Ending`] for another ending.
    pub fn of(path: &Path) -> Result<Self, PlotError> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            Some("pdf") => Ok(Self::Pdf),
            Some("html") => Ok(Self::Html),
            _ => Err(PlotError::Ending { path: path.to_path_buf() }),
        }
    }
}

/// A scene as a file.
fn bytes(scene: &scene::Scene, format: Format) -> Result<Vec<u8>, PlotError> {
    match format {
        // A page is made from figures, not from a scene.
        Format::Svg | Format::Html => Ok(svg::document(scene, Theme::Light).into_bytes()),
        Format::Png => raster::png(scene, Theme::Light, PRINT_SCALE),
        Format::Pdf => pdf::document(scene, Theme::Light),
    }
}

#[cfg(test)]
mod tests;
