//! Figures side by side under one title: the columns of a matrix of panels, each over a separate axis.

use super::layout::{self, CAPTION_SIZE, RIM, TITLE_SIZE, paragraph};
use super::scene::{Area, Ink, Item, Outline, Scene, Step};
use super::text::Faces;
use super::{Figure, Format, PlotError, Theme, pdf, raster, svg};

/// Figures from the left to the right.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SideBySide {
    /// The words above; may be empty.
    pub title: String,
    /// Smaller words under the title; may be empty.
    pub note: String,
    /// The words below; may be empty.
    pub caption: String,
    /// The figures; their panels stand level when they are equally many and equally high, whatever stands above each.
    pub figures: Vec<Figure>,
}

impl SideBySide {
    /// All of it as one SVG document.
    ///
    /// # Errors
    /// As [`Figure::to_svg`].
    pub fn to_svg(&self, theme: Theme) -> Result<String, PlotError> {
        Ok(svg::document(&self.scene()?, theme))
    }

    /// All of it as one PNG.
    ///
    /// # Errors
    /// As [`Figure::to_png`].
    pub fn to_png(&self, theme: Theme, scale: f64) -> Result<Vec<u8>, PlotError> {
        raster::png(&self.scene()?, theme, scale)
    }

    /// All of it as one PDF.
    ///
    /// # Errors
    /// As [`Figure::to_pdf`].
    pub fn to_pdf(&self, theme: Theme) -> Result<Vec<u8>, PlotError> {
        pdf::document(&self.scene()?, theme)
    }

    /// All of it as a file that is read on paper.
    ///
    /// # Errors
    /// As [`Figure::to_svg`].
    pub fn bytes(&self, format: Format) -> Result<Vec<u8>, PlotError> {
        if format == Format::Html {
            return Ok(super::page::page(&self.title, &[&self.note, &self.caption], &self.figures)?.into_bytes());
        }
        super::bytes(&self.scene()?, format)
    }

    /// The figures, each panel with as much above it as the panel beside it has.
    fn columns(&self) -> Result<Vec<Scene>, PlotError> {
        let mut heads: Vec<f64> = Vec::new();
        for figure in &self.figures {
            let its = layout::laid_out(figure, &[])?.1;
            heads.resize(heads.len().max(its.len()), 0.0);
            heads.iter_mut().zip(its).for_each(|(head, own)| *head = head.max(own));
        }
        self.figures.iter().map(|figure| Ok(layout::laid_out(figure, &heads)?.0)).collect()
    }

    fn scene(&self) -> Result<Scene, PlotError> {
        let faces = Faces::load()?;
        let columns = self.columns()?;
        let width = columns.iter().map(|column| column.width).sum::<f64>().max(10.0 * RIM);
        let mut scene = Scene { width, title: self.title.clone(), ..Scene::default() };
        scene.description.clone_from(&self.caption);
        let title = faces.wrap(&self.title, TITLE_SIZE, true, width - 4.0 * RIM);
        let mut items = Scene::default();
        let top = paragraph(&mut items, &title, 2.0 * RIM, RIM, TITLE_SIZE, true, Ink::Text);
        let note = faces.wrap(&self.note, CAPTION_SIZE, false, width - 4.0 * RIM);
        let top = paragraph(&mut items, &note, 2.0 * RIM, top, CAPTION_SIZE, false, Ink::Muted);
        let mut left = 0.0;
        let mut bottom = top;
        for column in columns {
            bottom = bottom.max(top + column.height);
            // The first item of each is its ground, for which all of it has one.
            items.items.extend(column.items.into_iter().skip(1).map(|item| moved(item, left, top)));
            left += column.width;
        }
        let caption = faces.wrap(&self.caption, CAPTION_SIZE, false, width - 4.0 * RIM);
        let bottom = paragraph(&mut items, &caption, 2.0 * RIM, bottom, CAPTION_SIZE, false, Ink::Muted);
        scene.height = bottom + RIM;
        let mut ground = Outline::filled(Ink::Background, 1.0);
        ground.rectangle(Area { left: 0.0, top: 0.0, right: width, bottom: scene.height });
        scene.outline(ground);
        scene.items.extend(items.items);
        Ok(scene)
    }
}

/// An item at another place.
fn moved(item: Item, right: f64, down: f64) -> Item {
    let point = |[x, y]: [f64; 2]| [x + right, y + down];
    match item {
        Item::Outline(mut outline) => {
            for step in &mut outline.steps {
                *step = match *step {
                    Step::Move(p) => Step::Move(point(p)),
                    Step::Line(p) => Step::Line(point(p)),
                    Step::Close => Step::Close,
                    Step::Disc(p, r) => Step::Disc(point(p), r),
                };
            }
            Item::Outline(outline)
        }
        Item::Words(mut words) => {
            words.at = point(words.at);
            Item::Words(words)
        }
    }
}
