//! The figure of one run or of several: one code for an actuator, a joint and a plant, from the columns of the run.
//!
//! | file | its idea |
//! |---|---|
//! | `quantity` | what a column is of, the unit that it is shown in, and the least difference that is shown |
//! | `source` | what a figure reads of a run |
//! | `choice` | which columns are shown in which panels |
//! | `panels` | curves, colours, names, limits and strips |
//! | `symbols`, `marks` | the symbol of each kind of event, and where marks stand |
//! | `envelope` | oscillations that are faster than a figure can show |
//! | `loops` | tension over length |
//! | `labels` | the names of compared files |
//! | `title` | a sentence that says what is shown |
//!
//! Checked by the program's `tests/figure.rs`.

mod choice;
mod envelope;
mod labels;
mod loops;
mod marks;
mod panels;
mod quantity;
mod source;
pub(crate) mod symbols;
pub mod title;

use crate::axis::TrajectoryAxis;
use crate::failure::Failure;
use crate::run::Finished;
use choice::Run;
pub use labels::labels;
use mckibben_plot::{Figure, Format, PlotError, SideBySide, Theme};
use panels::Looks;
use source::Source;

/// What a figure of runs shows.
#[derive(Clone, Copy, Debug)]
pub struct Request<'r> {
    /// Its horizontal axis.
    pub over: TrajectoryAxis,
    /// The words above; may be empty.
    pub title: &'r str,
    /// The columns that are shown over time; the usual ones where none is named.
    pub columns: &'r [String],
}

/// One figure, or two side by side.
#[derive(Clone, Debug, PartialEq)]
pub enum Picture {
    /// One.
    One(Box<Figure>),
    /// The whole, and a part of it larger.
    SideBySide(SideBySide),
}

impl Picture {
    /// As SVG.
    ///
    /// # Errors
    /// As [`Figure::to_svg`].
    pub fn to_svg(&self, theme: Theme) -> Result<String, PlotError> {
        match self {
            Self::One(figure) => figure.to_svg(theme),
            Self::SideBySide(beside) => beside.to_svg(theme),
        }
    }

    /// As a file that is read on paper.
    ///
    /// # Errors
    /// As [`Figure::bytes`].
    pub fn bytes(&self, format: Format) -> Result<Vec<u8>, PlotError> {
        match self {
            Self::One(figure) => figure.bytes(format),
            Self::SideBySide(beside) => beside.bytes(format),
        }
    }

    /// Its figures, from the left.
    pub fn figures(&self) -> &[Figure] {
        match self {
            Self::One(figure) => std::slice::from_ref(&**figure),
            Self::SideBySide(beside) => &beside.figures,
        }
    }
}

/// The figure of runs, each with its name in the legend, which may be empty for a run alone.
///
/// # Errors
/// [`Failure::input`] for a column that no run has; [`Failure::stopped`] for a number that is not finite.
pub fn draw(runs: &[(&str, &Finished)], request: &Request<'_>) -> Result<Picture, Failure> {
    let sources = runs.iter().map(|(_, run)| Source::of(run)).collect::<Result<Vec<_>, _>>()?;
    let runs: Vec<Run<'_>> = runs.iter().zip(&sources).map(|((label, _), source)| Run { label, source }).collect();
    let looks = Looks::new(&runs);
    if request.over == TrajectoryAxis::Length {
        return Ok(loops::draw(&runs, request.title));
    }
    let choice = choice::choose(&runs, request.columns)?;
    let end = runs.iter().map(|run| run.source.duration).fold(0.0, f64::max);
    let (whole, has_envelope) = panels::figure(&choice, &looks, (0.0, end, true));
    let mut notes = choice.notes.clone();
    notes.extend([marks::note(&runs)].into_iter().filter(|note| !note.is_empty()));
    let detail = if has_envelope { detail(&choice) } else { None };
    let Some(begin) = detail else {
        let figure = whole.title(request.title).note(notes.join("; ")).size_mm(120.0, 32.0);
        return Ok(Picture::One(Box::new(figure)));
    };
    notes.insert(0, "band: least to greatest, line in it: mean; right: the last periods".to_owned());
    let mut right = panels::figure(&choice, &looks, (begin, end, false)).0;
    for panel in &mut right.panels {
        panel.legend = mckibben_plot::Legend::Hidden;
    }
    Ok(Picture::SideBySide(SideBySide {
        title: request.title.to_owned(),
        note: notes.join("; "),
        figures: vec![whole.size_mm(110.0, 32.0), right.size_mm(65.0, 32.0)],
        ..SideBySide::default()
    }))
}

/// Where the last periods of the fastest curve begin, if there is one that only its envelope shows.
fn detail(choice: &choice::Choice<'_>) -> Option<f64> {
    let of = |group: &choice::Group<'_>| {
        let (low, high, _) = group.extent();
        let begins = group.lines.iter().filter(|_| high - low > group.tolerance());
        let begins =
            begins.filter_map(|line| envelope::last_periods(&line.source.time, &line.column.values, high - low));
        begins.collect::<Vec<f64>>()
    };
    choice.groups.iter().flat_map(of).max_by(f64::total_cmp)
}
