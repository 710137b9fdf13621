//! A scene as a PDF of one page, as large as the figure.
//!
//! Words are text in the built-in faces, of which the file holds the glyphs that it shows: every character looks as in
//! the PNG, can be searched and copied, and needs no font of the reader. A character that the faces lack is an empty box,
//! as in the PNG; raised and lowered figures are copied as ordinary ones. The file holds no date, so that the same figure
//! gives the same bytes.

use super::PlotError;
use super::scene::{Anchor, Ink, Item, Outline, Scene, Step, Words};
use super::text::{Faces, Placed};
use super::theme::{Rgb, Theme, colour};
use pdf_writer::types::{CidFontType, FontFlags, LineJoinStyle, SystemInfo, TextRenderingMode, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use std::collections::{BTreeMap, BTreeSet};
use subsetter::GlyphRemapper;

/// Of the radius of a circle, the length of the handles of four curves that draw it to within 0.03 %.
const HANDLE: f64 = 0.552_285;
/// The identity of glyph numbers, as PDF names it.
const IDENTITY: SystemInfo<'static> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };
/// The names of the regular and of the bold face in the page, and in their files.
const NAMES: [(&[u8], &str); 2] = [(b"R", "NotoSans-Regular"), (b"B", "NotoSans-Bold")];

pub(super) fn document(scene: &Scene, theme: Theme) -> Result<Vec<u8>, PlotError> {
    let mut page = Page {
        content: Content::new(),
        faces: Faces::load()?,
        dark: theme == Theme::Dark,
        glyphs: [GlyphRemapper::new(), GlyphRemapper::new()],
        characters: [BTreeMap::new(), BTreeMap::new()],
        opacities: BTreeSet::new(),
    };
    // The scene's y points down.
    page.content.transform([1.0, 0.0, 0.0, -1.0, 0.0, number(scene.height)]);
    page.content.set_line_join(LineJoinStyle::RoundJoin);
    for item in &scene.items {
        match item {
            Item::Outline(outline) => page.outline(outline),
            Item::Words(words) => page.words(words),
        }
    }
    page.finish(scene)
}

/// A length of the page: a hundredth of a point is 3.5 µm.
fn number(value: f64) -> f32 {
    ((value * 100.0).round() / 100.0) as f32
}

/// The name of an opacity in ten-thousandths.
fn opacity_name(opacity: u32) -> String {
    format!("O{opacity}")
}

struct Page {
    content: Content,
    faces: Faces,
    dark: bool,
    /// Of each face, the glyphs that are shown in the order in which they come, and what each stands for.
    glyphs: [GlyphRemapper; 2],
    characters: [BTreeMap<u16, char>; 2],
    /// The opacities that are used, in ten-thousandths.
    opacities: BTreeSet<u32>,
}

impl Page {
    fn rgb(&self, ink: Ink) -> [f32; 3] {
        let rgb: Rgb = colour(ink, self.dark);
        rgb.map(|part| (f32::from(part) / 255.0 * 1000.0).round() / 1000.0)
    }

    fn outline(&mut self, outline: &Outline) {
        self.content.save_state();
        if let Some(fill) = outline.fill {
            let [r, g, b] = self.rgb(fill.ink);
            self.content.set_fill_rgb(r, g, b);
            if fill.opacity < 1.0 {
                let opacity = (fill.opacity * 1e4).round() as u32;
                self.opacities.insert(opacity);
                self.content.set_parameters(Name(opacity_name(opacity).as_bytes()));
            }
        }
        if let Some(stroke) = outline.stroke {
            let [r, g, b] = self.rgb(stroke.ink);
            self.content.set_stroke_rgb(r, g, b).set_line_width(number(stroke.width));
            self.content.set_dash_pattern(stroke.dash.iter().map(|dash| number(*dash)), 0.0);
        }
        for step in &outline.steps {
            match *step {
                Step::Move([x, y]) => self.content.move_to(number(x), number(y)),
                Step::Line([x, y]) => self.content.line_to(number(x), number(y)),
                Step::Close => self.content.close_path(),
                Step::Disc(centre, radius) => self.disc(centre, radius),
            };
        }
        match (outline.fill, outline.stroke) {
            (Some(_), Some(_)) => self.content.fill_nonzero_and_stroke(),
            (Some(_), None) => self.content.fill_nonzero(),
            (None, Some(_)) => self.content.stroke(),
            (None, None) => self.content.end_path(),
        };
        self.content.restore_state();
    }

    fn disc(&mut self, [x, y]: [f64; 2], r: f64) -> &mut Content {
        let h = HANDLE * r;
        let at = |along: f64, down: f64| [number(x + along), number(y + down)];
        let quarters = [
            [at(r, h), at(h, r), at(0.0, r)],
            [at(-h, r), at(-r, h), at(-r, 0.0)],
            [at(-r, -h), at(-h, -r), at(0.0, -r)],
            [at(h, -r), at(r, -h), at(r, 0.0)],
        ];
        let [start_x, start_y] = at(r, 0.0);
        self.content.move_to(start_x, start_y);
        for [a, b, to] in quarters {
            self.content.cubic_to(a[0], a[1], b[0], b[1], to[0], to[1]);
        }
        self.content.close_path()
    }

    fn words(&mut self, words: &Words) {
        let face = usize::from(words.bold);
        let mut placed: Vec<Placed> = Vec::new();
        let width = self.faces.walk(&words.text, words.size, words.bold, |glyph| placed.push(glyph));
        let start = match words.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * width,
            Anchor::End => -width,
        };
        let [r, g, b] = self.rgb(words.ink);
        let [br, bg, bb] = self.rgb(Ink::Background);
        self.content.save_state().set_fill_rgb(r, g, b);
        let halo = words.halo.then_some(TextRenderingMode::Stroke);
        for mode in halo.into_iter().chain([TextRenderingMode::Fill]) {
            // What surrounds words is not read out.
            if mode == TextRenderingMode::Stroke {
                self.content.begin_marked_content(Name(b"Artifact"));
            }
            self.content.begin_text().set_text_rendering_mode(mode);
            self.content.set_stroke_rgb(br, bg, bb).set_line_width(2.4);
            for part in placed.chunk_by(|a, b| a.size == b.size && a.rise == b.rise) {
                let (along, rise) = (start + part[0].along, part[0].rise);
                let [x, y] = words.at;
                // The page's y points down and the glyphs' up.
                let matrix = match words.rotated {
                    true => [0.0, -1.0, -1.0, 0.0, number(x - rise), number(y - along)],
                    false => [1.0, 0.0, 0.0, -1.0, number(x + along), number(y - rise)],
                };
                let codes: Vec<u8> = part.iter().flat_map(|placed| self.code(face, placed)).collect();
                self.content.set_font(Name(NAMES[face].0), number(part[0].size));
                self.content.set_text_matrix(matrix).show(Str(&codes));
            }
            self.content.end_text();
            if mode == TextRenderingMode::Stroke {
                self.content.end_marked_content();
            }
        }
        self.content.restore_state();
    }

    /// The code of a glyph in the file.
    fn code(&mut self, face: usize, placed: &Placed) -> [u8; 2] {
        let code = self.glyphs[face].remap(placed.glyph.0);
        self.characters[face].entry(code).or_insert(placed.character);
        code.to_be_bytes()
    }

    fn finish(self, scene: &Scene) -> Result<Vec<u8>, PlotError> {
        let mut pdf = Pdf::new();
        let mut last = 0;
        let mut next = || {
            last += 1;
            Ref::new(last)
        };
        let (catalog, pages, page, content, info) = (next(), next(), next(), next(), next());
        pdf.catalog(catalog).pages(pages);
        pdf.pages(pages).kids([page]).count(1);
        if !scene.title.is_empty() {
            pdf.document_info(info).title(TextStr(&scene.title));
        }
        let mut fonts: Vec<(&[u8], Ref)> = Vec::new();
        for face in [0, 1] {
            if !self.characters[face].is_empty() {
                let ids = [next(), next(), next(), next(), next()];
                self.embed(&mut pdf, face, ids)?;
                fonts.push((NAMES[face].0, ids[0]));
            }
        }
        let mut writer = pdf.page(page);
        writer.media_box(Rect::new(0.0, 0.0, number(scene.width), number(scene.height)));
        writer.parent(pages).contents(content);
        let mut resources = writer.resources();
        resources.fonts().pairs(fonts.into_iter().map(|(name, id)| (Name(name), id)));
        let mut states = resources.ext_g_states();
        for opacity in &self.opacities {
            let name = opacity_name(*opacity);
            let mut state = states.insert(Name(name.as_bytes())).start::<pdf_writer::writers::ExtGraphicsState<'_>>();
            state.non_stroking_alpha(*opacity as f32 / 1e4);
        }
        states.finish();
        resources.finish();
        writer.finish();
        let bytes = deflated(&self.content.finish());
        pdf.stream(content, &bytes).filter(Filter::FlateDecode);
        Ok(pdf.finish())
    }

    /// Puts what is shown of a face into the file.
    fn embed(&self, pdf: &mut Pdf, face: usize, ids: [Ref; 5]) -> Result<(), PlotError> {
        let [font, cid, descriptor, file, unicode] = ids;
        let (glyphs, (of, bytes)) = (&self.glyphs[face], self.faces.face(face == 1));
        let subset = subsetter::subset(bytes, 0, glyphs)
            .map_err(|e| PlotError::Document { reason: format!("the built-in face is damaged: {e}") })?;
        // Programs that join files take two subsets of one name for the same one: the name follows from the glyphs.
        let mix = |sum: u32, glyph: u16| (sum ^ u32::from(glyph)).wrapping_mul(0x0100_0193);
        let mut sum = glyphs.remapped_gids().fold(0x811c_9dc5, mix);
        let mut tag = [b'A'; 6];
        for letter in &mut tag {
            *letter += (sum % 26) as u8;
            sum /= 26;
        }
        let name = format!("{}+{}", String::from_utf8_lossy(&tag), NAMES[face].1);
        let name = Name(name.as_bytes());
        let em = |units: f32| units * 1000.0 / f32::from(of.units_per_em());

        let mut type0 = pdf.type0_font(font);
        type0.base_font(name).encoding_predefined(Name(b"Identity-H")).descendant_font(cid).to_unicode(unicode);
        type0.finish();
        let mut writer = pdf.cid_font(cid);
        writer.subtype(CidFontType::Type2).base_font(name).system_info(IDENTITY).font_descriptor(descriptor);
        writer.cid_to_gid_map_predefined(Name(b"Identity"));
        let advance = |glyph| of.glyph_hor_advance(ttf_parser::GlyphId(glyph)).unwrap_or(0);
        writer.widths().consecutive(0, glyphs.remapped_gids().map(|glyph| em(f32::from(advance(glyph)))));
        writer.finish();
        let bounds = of.global_bounding_box();
        let mut writer = pdf.font_descriptor(descriptor);
        writer.name(name).flags(FontFlags::NON_SYMBOLIC).italic_angle(0.0).font_file2(file);
        writer.bbox(Rect::new(
            em(bounds.x_min.into()),
            em(bounds.y_min.into()),
            em(bounds.x_max.into()),
            em(bounds.y_max.into()),
        ));
        writer
            .ascent(em(of.ascender().into()))
            .descent(em(of.descender().into()))
            .cap_height(em(of.capital_height().unwrap_or(714).into()));
        // Stem widths of Noto Sans in thousandths of the size.
        writer.stem_v(if face == 1 { 148.0 } else { 92.0 });
        writer.finish();
        let packed = deflated(&subset);
        let mut stream = pdf.stream(file, &packed);
        stream.filter(Filter::FlateDecode).pair(Name(b"Length1"), subset.len() as i32);
        stream.finish();
        let mut map = UnicodeCmap::<u16>::new(Name(b"Characters"), IDENTITY);
        self.characters[face].iter().for_each(|(code, character)| map.pair(*code, *character));
        let packed = deflated(&map.finish());
        pdf.cmap(unicode, &packed).filter(Filter::FlateDecode);
        Ok(())
    }
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    miniz_oxide::deflate::compress_to_vec_zlib(bytes, 9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Area;

    /// The streams of a document, in their order, without compression.
    fn streams(pdf: &[u8]) -> Vec<Vec<u8>> {
        let find = |from: usize, words: &[u8]| {
            pdf[from..].windows(words.len()).position(|window| window == words).map(|at| from + at)
        };
        let (mut found, mut from) = (Vec::new(), 0);
        while let Some(start) = find(from, b"\nstream\n") {
            let end = find(start, b"\nendstream").unwrap();
            found.push(miniz_oxide::inflate::decompress_to_vec_zlib(&pdf[start + 8..end]).unwrap());
            from = end + 10;
        }
        found
    }

    fn words(text: &str, rotated: bool) -> Words {
        let (anchor, ink) = (Anchor::Start, Ink::Text);
        Words { at: [10.0, 20.0], anchor, size: 8.0, bold: false, rotated, halo: false, ink, text: text.to_string() }
    }

    #[test]
    fn outlines_and_words_stand_where_the_scene_has_them() {
        let mut scene = Scene { width: 100.0, height: 50.0, ..Scene::default() };
        let mut shade = Outline::filled(Ink::Background, 0.25);
        shade.rectangle(Area { left: 1.0, top: 2.0, right: 3.0, bottom: 4.5 });
        scene.outline(shade);
        scene.words(words("ab", false));
        scene.words(words("a²", true));
        let pdf = document(&scene, Theme::Light).unwrap();
        let plain = String::from_utf8_lossy(&pdf).into_owned();
        assert!(plain.contains("/MediaBox [0 0 100 50]") && plain.contains("/O2500") && plain.contains("/ca 0.25"));
        let streams = streams(&pdf);
        let page = streams.iter().find(|stream| stream.starts_with(b"1 0 0 -1 0 50 cm")).unwrap();
        let page = String::from_utf8_lossy(page);
        assert!(page.contains("1 1 1 rg\n/O2500 gs\n1 2 m\n3 2 l\n3 4.5 l\n1 4.5 l\nh\nf"), "{page}");
        assert!(
            page.contains("/R 8 Tf\n1 0 0 -1 10 20 Tm\n(\\000\\001\\000\\002) Tj") || page.contains("<00010002> Tj"),
            "{page}"
        );
        // The raised figure stands 0.34 of the size to the left, after the width of an a, 0.561 of the size.
        assert!(page.contains("/R 5.28 Tf\n0 -1 -1 0 7.28 15.51 Tm"), "{page}");
    }

    #[test]
    fn every_character_is_in_the_file_and_can_be_copied() {
        let text = "−–·×°µΩαβγδεθλμνπρστφω Δ±≤≥≈∂∞√éüß… N mm⁻¹";
        let mut scene = Scene { width: 100.0, height: 50.0, ..Scene::default() };
        scene.words(words(text, false));
        let pdf = document(&scene, Theme::Light).unwrap();
        let streams = streams(&pdf);
        let map =
            streams.iter().map(|stream| String::from_utf8_lossy(stream)).find(|s| s.contains("beginbfchar")).unwrap();
        for c in text.chars().filter(|c| !"⁻¹".contains(*c)) {
            assert!(map.contains(&format!("<{:04X}>", c as u32)), "{c}");
        }
        let face = streams.iter().find_map(|stream| ttf_parser::Face::parse(stream, 0).ok()).unwrap();
        assert!(usize::from(face.number_of_glyphs()) > 40 && pdf.len() < 20_000, "{}", pdf.len());
    }
}
