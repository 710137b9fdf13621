//! A scene as a PNG.

use super::PlotError;
use super::scene::{Anchor, Ink, Item, Outline, Scene, Step, Words};
use super::text::Faces;
use super::theme::{Theme, colour};
use tiny_skia::{Color, FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};
use ttf_parser::OutlineBuilder;

/// Pixels in a point at a scale of 1, which is 96 pixels per inch.
const PIXELS: f64 = 96.0 / 72.0;
/// Pixels in a metre at a scale of 1.
const PER_METRE: f64 = 96.0 / 0.0254;

pub(super) fn png(scene: &Scene, theme: Theme, scale: f64) -> Result<Vec<u8>, PlotError> {
    if !(0.25..=16.0).contains(&scale) {
        let range = "0.25 to 16, where 1 is 96 pixels per inch";
        return Err(PlotError::Dimension { name: "the scale of the picture", value: scale, unit: "", range });
    }
    let canvas = Canvas { faces: Faces::load()?, dark: theme == Theme::Dark, scale: scale * PIXELS };
    let size = |points: f64| (points * canvas.scale).round().max(1.0) as u32;
    let (width, height) = (size(scene.width), size(scene.height));
    let mut picture = Pixmap::new(width, height).ok_or_else(|| PlotError::Raster {
        reason: format!("{width} × {height} pixels are too many; lower the scale"),
    })?;
    // The ground reaches to the last pixel, where the outline of the figure ends at a fraction of one.
    picture.fill(canvas.color(Ink::Background, 1.0));
    for item in &scene.items {
        match item {
            Item::Outline(outline) => canvas.outline(&mut picture, outline),
            Item::Words(words) => canvas.words(&mut picture, words),
        }
    }
    encode(&picture, scale).map_err(|e| PlotError::Raster { reason: e.to_string() })
}

/// Everything is opaque, so three bytes per pixel are enough.
fn encode(picture: &Pixmap, scale: f64) -> Result<Vec<u8>, png::EncodingError> {
    let rgb: Vec<u8> = picture.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width(), picture.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let density = (PER_METRE * scale).round() as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: density, yppu: density, unit: png::Unit::Meter }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgb)?;
    writer.finish()?;
    Ok(bytes)
}

struct Canvas {
    faces: Faces,
    dark: bool,
    /// Pixels in a point.
    scale: f64,
}

impl Canvas {
    fn color(&self, ink: Ink, opacity: f64) -> Color {
        let [r, g, b] = colour(ink, self.dark);
        Color::from_rgba8(r, g, b, (opacity * 255.0).round() as u8)
    }

    fn paint(&self, ink: Ink, opacity: f64) -> Paint<'static> {
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color(self.color(ink, opacity));
        paint
    }

    fn outline(&self, picture: &mut Pixmap, outline: &Outline) {
        let px = |v: f64| (v * self.scale) as f32;
        let mut builder = PathBuilder::new();
        for step in &outline.steps {
            match *step {
                Step::Move([x, y]) => builder.move_to(px(x), px(y)),
                Step::Line([x, y]) => builder.line_to(px(x), px(y)),
                Step::Close => builder.close(),
                Step::Disc([x, y], r) => builder.push_circle(px(x), px(y), px(r)),
            }
        }
        let Some(path) = builder.finish() else {
            return;
        };
        if let Some(fill) = outline.fill {
            self.fill(picture, &path, fill.ink, fill.opacity);
        }
        if let Some(stroke) = outline.stroke {
            self.stroke(picture, &path, stroke.ink, stroke.width, stroke.dash);
        }
    }

    fn fill(&self, picture: &mut Pixmap, path: &Path, ink: Ink, opacity: f64) {
        picture.fill_path(path, &self.paint(ink, opacity), FillRule::Winding, Transform::identity(), None);
    }

    fn stroke(&self, picture: &mut Pixmap, path: &Path, ink: Ink, width: f64, dash: &[f64]) {
        let px = |v: f64| (v * self.scale) as f32;
        let dash = StrokeDash::new(dash.iter().map(|d| px(*d)).collect(), 0.0);
        let stroke = Stroke { width: px(width), line_join: LineJoin::Round, dash, ..Stroke::default() };
        picture.stroke_path(path, &self.paint(ink, 1.0), &stroke, Transform::identity(), None);
    }

    fn words(&self, picture: &mut Pixmap, words: &Words) {
        let size = words.size * self.scale;
        let start = match words.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * self.faces.width(&words.text, size, words.bold),
            Anchor::End => -self.faces.width(&words.text, size, words.bold),
        };
        let [x, y] = words.at.map(|v| v * self.scale);
        let mut pen = Pen { builder: PathBuilder::new(), origin: [x, y], unit: 0.0, rotated: words.rotated };
        self.faces.draw((&words.text, size, words.bold), &mut pen, |pen, along, rise, unit| {
            pen.unit = unit;
            pen.origin = if pen.rotated { [x - rise, y - start - along] } else { [x + start + along, y - rise] };
        });
        let Some(path) = pen.builder.finish() else {
            return;
        };
        if words.halo {
            self.stroke(picture, &path, Ink::Background, 2.4, &[]);
        }
        self.fill(picture, &path, words.ink, 1.0);
    }
}

/// Takes the outline of a glyph, whose y points up, to the page.
struct Pen {
    builder: PathBuilder,
    /// Where the present glyph starts.
    origin: [f64; 2],
    /// Pixels in a unit of the face.
    unit: f64,
    rotated: bool,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> [f32; 2] {
        let (x, y) = (self.unit * f64::from(x), self.unit * f64::from(y));
        let [u, v] = if self.rotated { [-y, -x] } else { [x, -y] };
        [(self.origin[0] + u) as f32, (self.origin[1] + v) as f32]
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let [x, y] = self.at(x, y);
        self.builder.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let [x, y] = self.at(x, y);
        self.builder.line_to(x, y);
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        let ([cx, cy], [x, y]) = (self.at(cx, cy), self.at(x, y));
        self.builder.quad_to(cx, cy, x, y);
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let ([ax, ay], [bx, by], [x, y]) = (self.at(ax, ay), self.at(bx, by), self.at(x, y));
        self.builder.cubic_to(ax, ay, bx, by, x, y);
    }

    fn close(&mut self) {
        self.builder.close();
    }
}
