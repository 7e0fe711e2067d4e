//! PDF with optional content by layer, live text in the embedded font, and the same shapes as the SVG.

use super::pdf_letters::{self, DrawnLetters};
use super::{Page, Piece, VectorPicture, is_blank, tolerance_px};
use crate::sheet::REFERENCE_DPI;
use belvedere_composite::canvas::{CanvasShape, FONT_FILE, Fonts, Letter};
use belvedere_composite::marks::{LayerShapes, LineShape, Paint, Role, SymbolShape, outline, simplified};
use belvedere_core::DVec2;
use belvedere_scene::Color;
use flate2::{Compression, write::ZlibEncoder};
use pdf_writer::types::{
    CidFontType, FontFlags, LineCapStyle, LineJoinStyle, SystemInfo, TextRenderingMode, UnicodeCmap,
};
use pdf_writer::writers::Resources;
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};
use std::io::Write;

const SYSTEM: SystemInfo<'static> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };
/// Name of the font: a tag of a subset, and the family.
const FONT_NAME: Name<'static> = Name(b"BLVDRE+DejaVuSansCondensed");
/// Bounds of letters, ascent, descent and height of capitals, thousandths of an em.
const FONT_BOX: [f32; 4] = [-918.0, -463.0, 1614.0, 1232.0];
const ASCENT: f32 = 928.0;
const DESCENT: f32 = -236.0;
const CAPITALS: f32 = 729.0;
/// Handle of a circle's quarter, radii.
const QUARTER: f64 = 0.552_284_75;

/// A text whose letters are set.
struct SetText<'a> {
    at: DVec2,
    size: f64,
    text: &'a str,
    fonts: &'a Fonts,
    letters: Vec<Letter>,
    /// Place and direction of each letter, pixels.
    turned: Vec<(DVec2, DVec2)>,
    /// Whether it is a straight line in the embedded font, copied by the map of the font.
    plain: bool,
}

/// The document.
pub fn write(picture: &VectorPicture, page: &Page<'_>) -> Vec<u8> {
    let [w, h] = page.size.map(|side| side as f64);
    let dpi = page.sheet.map_or(REFERENCE_DPI, |sheet| sheet.dpi);
    let points = |mm: f64| mm / 25.4 * 72.0;
    let margin = points(page.sheet.map_or(0.0, |sheet| sheet.margin_mm));
    let paper = page.sheet.map_or([w, h].map(|px| px / dpi * 72.0), |sheet| sheet.paper_mm.map(points));
    let mut out = Drawing {
        content: Content::new(),
        tolerance: tolerance_px(dpi),
        alone: !picture.over_raster,
        layers: Vec::new(),
        alphas: Vec::new(),
        glyphs: BTreeMap::new(),
        drawn: DrawnLetters::default(),
    };
    // From pixels, y down, to points, y up.
    let scale = (72.0 / dpi) as f32;
    out.content.transform([scale, 0.0, 0.0, -scale, margin as f32, (paper[1] - margin) as f32]);
    out.content.rect(0.0, 0.0, w as f32, h as f32).clip_nonzero().end_path();
    out.content.set_line_cap(LineCapStyle::RoundCap).set_line_join(LineJoinStyle::RoundJoin);
    if page.raster.is_some() {
        out.open(None, "surfaces");
        out.content.save_state().transform([w as f32, 0.0, 0.0, -(h as f32), 0.0, h as f32]);
        out.content.x_object(Name(b"Surfaces")).restore_state();
        out.close();
    }
    out.layers(picture);
    out.document(page, paper)
}

struct Drawing {
    content: Content,
    /// Of simplified lines, pixels.
    tolerance: f64,
    alone: bool,
    /// Layers in the order of drawing: index in the scene, and name.
    layers: Vec<(Option<usize>, String)>,
    /// Opacities in use, thousandths.
    alphas: Vec<u16>,
    /// Glyphs in use: their widths in thousandths of an em, and their characters.
    glyphs: BTreeMap<u16, (f32, String)>,
    /// Letters of further fonts.
    drawn: DrawnLetters,
}

impl Drawing {
    /// Begins a part of a layer: fills and outlines of areas are one, which is shown or hidden as a whole.
    fn open(&mut self, layer: Option<usize>, label: &str) {
        let known = self.layers.iter().position(|(other, _)| layer.is_some() && *other == layer);
        let number = known.unwrap_or(self.layers.len());
        if known.is_none() {
            self.layers.push((layer, label.to_owned()));
        }
        let name = format!("L{number}");
        self.content.begin_marked_content_with_properties(Name(b"OC")).properties_named(Name(name.as_bytes()));
    }

    fn close(&mut self) {
        self.content.end_marked_content();
    }

    fn group(&mut self, layer: Option<usize>, label: &str, is_empty: bool, draw: impl FnOnce(&mut Self)) {
        if !is_empty {
            self.open(layer, label);
            draw(self);
            self.close();
        }
    }

    fn layers(&mut self, picture: &VectorPicture) {
        let alone = self.alone;
        for piece in picture.pieces() {
            match piece {
                // In the raster areas are coloured with the light and the relief of the ground.
                Piece::Fills(index, areas) => self.group(Some(index), &picture.layers[index], !alone, |out| {
                    areas.iter().for_each(|area| out.polygon(&area.rings, area.fill));
                }),
                Piece::Grid(sheets) => self.sheets((None, "grid"), sheets),
                Piece::Marks(index, sheets) => self.sheets((Some(index), &picture.layers[index]), sheets),
                Piece::Overlay(sheets) => self.sheets((None, "overlay"), sheets),
            }
        }
        let names = &picture.marks.names;
        self.group(None, "names", names.is_empty(), |out| names.iter().for_each(|shape| out.shape(shape)));
        for furniture in &picture.furniture {
            let shapes = &furniture.shapes;
            self.group(None, furniture.name, shapes.is_empty(), |out| shapes.iter().for_each(|shape| out.shape(shape)));
        }
    }

    fn sheets(&mut self, (layer, label): (Option<usize>, &str), sheets: &[LayerShapes]) {
        self.group(layer, label, is_blank(sheets), |out| sheets.iter().for_each(|sheet| out.sheet(sheet)));
    }

    /// Colour of strokes and fills, with an opacity in 0..=1.
    fn paint(&mut self, color: Color, opacity: f32) {
        let [r, g, b] = [color.r, color.g, color.b].map(|v| f32::from(v) / 255.0);
        let alpha = (opacity * 1000.0).round().clamp(0.0, 1000.0) as u16;
        if !self.alphas.contains(&alpha) {
            self.alphas.push(alpha);
        }
        self.content.set_parameters(Name(format!("A{alpha}").as_bytes()));
        self.content.set_stroke_rgb(r, g, b).set_fill_rgb(r, g, b);
    }

    fn color(&mut self, color: Color) {
        self.paint(color, f32::from(color.a) / 255.0);
    }

    fn path(&mut self, points: &[DVec2], closed: bool) {
        let Some((first, rest)) = points.split_first() else { return };
        self.content.move_to(first.x as f32, first.y as f32);
        for p in rest {
            self.content.line_to(p.x as f32, p.y as f32);
        }
        if rest.is_empty() && !closed {
            self.content.line_to(first.x as f32, first.y as f32);
        }
        if closed {
            self.content.close_path();
        }
    }

    fn circle(&mut self, at: DVec2, radius: f64) {
        let place = |x: f64, y: f64| [(at.x + radius * x) as f32, (at.y + radius * y) as f32];
        let [x, y] = place(1.0, 0.0);
        self.content.move_to(x, y);
        for k in 0..4 {
            let turned = |x: f64, y: f64| {
                let p = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y][k].rotate(DVec2::new(x, y));
                place(p.x, p.y)
            };
            let [[ax, ay], [bx, by], [cx, cy]] = [turned(1.0, QUARTER), turned(QUARTER, 1.0), turned(0.0, 1.0)];
            self.content.cubic_to(ax, ay, bx, by, cx, cy);
        }
        self.content.close_path();
    }

    fn polygon(&mut self, rings: &[Vec<DVec2>], color: Color) {
        self.color(color);
        rings.iter().for_each(|ring| self.path(ring, true));
        self.content.fill_even_odd();
    }

    fn sheet(&mut self, sheet: &LayerShapes) {
        for (role, paint) in [(Role::Hidden, sheet.hidden), (Role::Casing, sheet.casing), (Role::Fill, sheet.fill)] {
            self.role(sheet, role, paint);
        }
    }

    fn role(&mut self, sheet: &LayerShapes, role: Role, paint: Paint) {
        if paint.opacity <= 0.0 {
            return;
        }
        self.paint(paint.color, paint.opacity);
        let width = |line: &LineShape| match role {
            Role::Casing => line.casing,
            _ => (line.role == role).then_some(line.width),
        };
        // Lines of one width are one path, so that crossings are not darker.
        let mut open: Option<(f64, Option<[f64; 2]>)> = None;
        for line in sheet.lines.iter().filter(|line| line.drawn) {
            let Some(width) = width(line).filter(|width| *width > 0.0) else { continue };
            let dash = line.dash.filter(|dash| dash.iter().all(|length| *length > 0.0));
            if open.is_some_and(|pen| pen != (width, dash)) {
                self.content.stroke();
                open = None;
            }
            if open.is_none() {
                self.content.set_line_width(width as f32);
                self.content.set_dash_pattern(dash.into_iter().flatten().map(|length| length as f32), 0.0);
                open = Some((width, dash));
            }
            let points = simplified(&line.points, self.tolerance);
            self.path(&points, false);
        }
        if open.is_some() {
            self.content.stroke();
            self.content.set_dash_pattern([], 0.0);
        }
        for symbol in sheet.symbols.iter().filter(|symbol| symbol.role == role) {
            self.symbol(symbol);
        }
    }

    fn symbol(&mut self, symbol: &SymbolShape) {
        match symbol.symbol {
            belvedere_scene::Symbol::Dot => self.circle(symbol.at, symbol.half),
            other => {
                for ring in outline(other, symbol.half) {
                    self.path(&ring.into_iter().map(|p| symbol.at + p).collect::<Vec<_>>(), true);
                }
            }
        }
        if symbol.grow > 0.0 {
            // A rim is the outline drawn with a pen.
            self.content.set_line_width(2.0 * symbol.grow as f32).fill_even_odd_and_stroke();
        } else {
            self.content.fill_even_odd();
        }
    }

    fn shape(&mut self, shape: &CanvasShape) {
        match shape {
            CanvasShape::Rect { corners: [lo, hi], radius, color } => {
                self.color(*color);
                let r = radius.min(0.5 * (*hi - *lo).min_element());
                let corner = |out: &mut Self, middle: DVec2, from: f64| {
                    (0..=8).map(|i| middle + r * DVec2::from_angle(from + FRAC_PI_2 * f64::from(i) / 8.0)).for_each(
                        |p| {
                            out.content.line_to(p.x as f32, p.y as f32);
                        },
                    );
                };
                self.content.move_to(lo.x as f32, (lo.y + r) as f32);
                corner(self, DVec2::new(lo.x + r, lo.y + r), PI);
                corner(self, DVec2::new(hi.x - r, lo.y + r), -FRAC_PI_2);
                corner(self, DVec2::new(hi.x - r, hi.y - r), 0.0);
                corner(self, DVec2::new(lo.x + r, hi.y - r), FRAC_PI_2);
                self.content.close_path().fill_even_odd();
            }
            CanvasShape::Line { points, width, color } => {
                self.color(*color);
                self.content.set_line_width(*width as f32);
                let points = simplified(points, self.tolerance);
                self.path(&points, false);
                self.content.stroke();
            }
            CanvasShape::Disc { at, radius, color } => {
                self.color(*color);
                self.circle(*at, *radius);
                self.content.fill_even_odd();
            }
            CanvasShape::Polygon { rings, color } => self.polygon(rings, *color),
            CanvasShape::Text { at, size, text, fonts, along, color, halo, .. } => {
                let letters = fonts.letters(text);
                let plain = along.is_empty() && self.knows_all(&letters);
                let turned = match along.is_empty() {
                    true => letters.iter().map(|l| (*at + *size * DVec2::new(l.at[0], -l.at[1]), DVec2::X)).collect(),
                    false => {
                        fonts.turned(*size, text, along).into_iter().map(|turn| (turn.at, turn.direction)).collect()
                    }
                };
                let set = SetText { at: *at, size: *size, text, fonts, letters, turned, plain };
                if let Some((color, width)) = halo {
                    // The rim is not text: it is not found or copied.
                    self.color(*color);
                    self.content.set_line_width(2.0 * *width as f32);
                    self.rim(&set);
                }
                self.color(*color);
                self.text(&set);
            }
        }
    }

    /// Whether the embedded font has all letters and each glyph stands for the same characters as elsewhere, so that the map of the font
    /// tells what is copied.
    fn knows_all(&self, letters: &[Letter]) -> bool {
        let mut own: BTreeMap<u16, &str> = BTreeMap::new();
        letters.iter().all(|letter| {
            let before = self.glyphs.get(&letter.glyph).map(|(_, characters)| characters.as_str());
            let before = before.unwrap_or_else(|| own.entry(letter.glyph).or_insert(&letter.characters));
            letter.font == 0 && letter.glyph != 0 && before == letter.characters
        })
    }

    fn actual_text(&mut self, text: &str) {
        let mut span = self.content.begin_marked_content_with_properties(Name(b"Span"));
        span.properties().actual_text(TextStr(text));
        span.finish();
    }

    fn rim(&mut self, set: &SetText<'_>) {
        if set.plain {
            self.actual_text("");
            self.line(set, TextRenderingMode::Stroke);
            self.content.end_marked_content();
            return;
        }
        for (letter, (at, right)) in set.letters.iter().zip(&set.turned) {
            let outline = set.fonts.outline(letter.font, letter.glyph);
            if outline.is_empty() {
                continue;
            }
            let up = DVec2::new(right.y, -right.x);
            pdf_letters::path(&mut self.content, &outline, |[x, y]| {
                (*at + set.size * (f64::from(x) * *right + f64::from(y) * up)).as_vec2().to_array()
            });
            self.content.stroke();
        }
    }

    fn text(&mut self, set: &SetText<'_>) {
        if set.plain {
            return self.line(set, TextRenderingMode::Fill);
        }
        // The order of the letters, or what they stand for, is not that of the text.
        self.actual_text(set.text);
        self.content.begin_text().set_text_rendering_mode(TextRenderingMode::Fill);
        for (letter, (at, right)) in set.letters.iter().zip(&set.turned) {
            let [x, y] = right.as_vec2().to_array();
            self.content.set_text_matrix([x, y, y, -x, at.x as f32, at.y as f32]);
            if letter.font == 0 {
                self.content.set_font(Name(b"F"), set.size as f32).show(Str(&letter.glyph.to_be_bytes()));
                self.uses(letter);
            } else {
                let (font, code) = self.drawn.code(set.fonts, letter);
                let name = DrawnLetters::name(font);
                self.content.set_font(Name(name.as_bytes()), set.size as f32).show(Str(&[code]));
            }
        }
        self.content.end_text();
        self.content.end_marked_content();
    }

    /// Notes a glyph of the embedded font.
    fn uses(&mut self, letter: &Letter) {
        let width = (1000.0 * letter.width) as f32;
        // A glyph for letters that no font has stands for no character of its own.
        let characters = if letter.glyph == 0 { String::new() } else { letter.characters.clone() };
        self.glyphs.entry(letter.glyph).or_insert_with(|| (width, characters));
    }

    fn line(&mut self, set: &SetText<'_>, mode: TextRenderingMode) {
        self.content.begin_text().set_font(Name(b"F"), set.size as f32).set_text_rendering_mode(mode);
        self.content.set_text_matrix([1.0, 0.0, 0.0, -1.0, set.at.x as f32, set.at.y as f32]);
        let mut line = self.content.show_positioned();
        let mut items = line.items();
        let mut pen = 0.0;
        for letter in &set.letters {
            // Thousandths of an em to the left.
            let back = 1000.0 * (pen - letter.at[0]);
            if back.abs() > 0.5 {
                items.adjust(back as f32);
            }
            items.show(Str(&letter.glyph.to_be_bytes()));
            pen = letter.at[0] + letter.width;
        }
        items.finish();
        line.finish();
        self.content.end_text();
        set.letters.iter().for_each(|letter| self.uses(letter));
    }

    fn document(mut self, page: &Page<'_>, paper: [f64; 2]) -> Vec<u8> {
        let mut next = 0;
        let mut id = || {
            next += 1;
            Ref::new(next)
        };
        let [catalog, pages, sheet, content, info] = std::array::from_fn(|_| id());
        let [font, cid, descriptor, file, unicode, image] = std::array::from_fn(|_| id());
        let parts = Parts {
            font: (!self.glyphs.is_empty()).then_some(font),
            image: page.raster.is_some().then_some(image),
            groups: self.layers.iter().map(|_| id()).collect(),
            states: self.alphas.iter().map(|_| id()).collect(),
            drawn: (0..self.drawn.fonts()).map(|_| id()).collect(),
        };
        let mut pdf = Pdf::new();
        self.layers_of(&mut pdf, (catalog, pages), &parts.groups);
        pdf.pages(pages).kids([sheet]).count(1);
        let mut leaf = pdf.page(sheet);
        leaf.parent(pages).media_box(Rect::new(0.0, 0.0, paper[0] as f32, paper[1] as f32)).contents(content);
        self.resources(leaf.resources(), &parts);
        leaf.finish();
        for (alpha, state) in self.alphas.iter().zip(&parts.states) {
            let alpha = f32::from(*alpha) / 1000.0;
            pdf.ext_graphics(*state).stroking_alpha(alpha).non_stroking_alpha(alpha);
        }
        let painted = deflated(&std::mem::replace(&mut self.content, Content::new()).finish());
        pdf.stream(content, &painted).filter(Filter::FlateDecode);
        if let Some(png) = page.raster {
            surfaces(&mut pdf, image, png, page.size);
        }
        if parts.font.is_some() {
            self.font(&mut pdf, [font, cid, descriptor, file, unicode]);
        }
        self.drawn.write(&mut pdf, &parts.drawn, id);
        let mut document = pdf.document_info(info);
        document.producer(TextStr(page.description));
        if !page.title.is_empty() {
            document.title(TextStr(page.title));
        }
        document.finish();
        pdf.finish()
    }

    /// The catalog with the list of layers, and each layer.
    fn layers_of(&self, pdf: &mut Pdf, (catalog, pages): (Ref, Ref), groups: &[Ref]) {
        let mut root = pdf.catalog(catalog);
        root.pages(pages);
        let mut optional = root.insert(Name(b"OCProperties")).dict();
        optional.insert(Name(b"OCGs")).array().items(groups.iter().copied());
        let mut usual = optional.insert(Name(b"D")).dict();
        // Without an order readers show no list of layers. The topmost stands first.
        usual.insert(Name(b"Order")).array().items(groups.iter().rev().copied());
        usual.insert(Name(b"ON")).array().items(groups.iter().copied());
        usual.finish();
        optional.finish();
        root.finish();
        for (group, (_, label)) in groups.iter().zip(&self.layers) {
            let mut dict = pdf.indirect(*group).dict();
            dict.pair(Name(b"Type"), Name(b"OCG")).pair(Name(b"Name"), TextStr(label));
        }
    }

    /// What the page refers to by name.
    fn resources(&self, mut resources: Resources<'_>, parts: &Parts) {
        let mut properties = resources.insert(Name(b"Properties")).dict();
        for (number, group) in parts.groups.iter().enumerate() {
            properties.pair(Name(format!("L{number}").as_bytes()), *group);
        }
        properties.finish();
        let mut alphas = resources.ext_g_states();
        for (alpha, state) in self.alphas.iter().zip(&parts.states) {
            alphas.pair(Name(format!("A{alpha}").as_bytes()), *state);
        }
        alphas.finish();
        if let Some(image) = parts.image {
            resources.x_objects().pair(Name(b"Surfaces"), image);
        }
        if parts.font.is_some() || !parts.drawn.is_empty() {
            let mut fonts = resources.fonts();
            if let Some(font) = parts.font {
                fonts.pair(Name(b"F"), font);
            }
            for (number, font) in parts.drawn.iter().enumerate() {
                fonts.pair(Name(DrawnLetters::name(number).as_bytes()), *font);
            }
        }
    }

    fn font(&self, pdf: &mut Pdf, [font, cid, descriptor, file, unicode]: [Ref; 5]) {
        pdf.type0_font(font)
            .base_font(FONT_NAME)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(cid)
            .to_unicode(unicode);
        let mut letters = pdf.cid_font(cid);
        letters.subtype(CidFontType::Type2).base_font(FONT_NAME).system_info(SYSTEM).font_descriptor(descriptor);
        letters.default_width(600.0).cid_to_gid_map_predefined(Name(b"Identity"));
        let mut widths = letters.widths();
        for (glyph, (width, _)) in &self.glyphs {
            widths.consecutive(*glyph, [*width]);
        }
        widths.finish();
        letters.finish();
        let [x0, y0, x1, y1] = FONT_BOX;
        pdf.font_descriptor(descriptor)
            .name(FONT_NAME)
            .flags(FontFlags::SYMBOLIC)
            .bbox(Rect::new(x0, y0, x1, y1))
            .italic_angle(0.0)
            .ascent(ASCENT)
            .descent(DESCENT)
            .cap_height(CAPITALS)
            .stem_v(80.0)
            .font_file2(file);
        let data = deflated(FONT_FILE);
        pdf.stream(file, &data).filter(Filter::FlateDecode).pair(Name(b"Length1"), FONT_FILE.len() as i32);
        let mut map: UnicodeCmap = UnicodeCmap::new(Name(b"Letters"), SYSTEM);
        for (glyph, (_, characters)) in self.glyphs.iter().filter(|(_, (_, text))| !text.is_empty()) {
            map.pair_with_multiple(*glyph, characters.chars());
        }
        let data = map.finish();
        pdf.cmap(unicode, &data);
    }
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // Memory takes everything.
    encoder.write_all(bytes).and_then(|()| encoder.finish()).unwrap_or_default()
}

/// The compressed rows of a PNG that is not interlaced: the contents of its `IDAT` chunks.
fn image_data(png: &[u8]) -> Vec<u8> {
    let mut data = Vec::new();
    let mut rest = png.get(8..).unwrap_or_default();
    while let Some((head, after)) = rest.split_at_checked(8) {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        let Some(chunk) = after.get(..length) else { break };
        if &head[4..] == b"IDAT" {
            data.extend_from_slice(chunk);
        }
        rest = after.get(length + 4..).unwrap_or_default();
    }
    data
}
/// Numbers of the objects that the page refers to.
struct Parts {
    /// Letters of the embedded font, if there are any.
    font: Option<Ref>,
    /// The raster of the surfaces.
    image: Option<Ref>,
    groups: Vec<Ref>,
    states: Vec<Ref>,
    drawn: Vec<Ref>,
}

/// The raster of the surfaces.
fn surfaces(pdf: &mut Pdf, image: Ref, png: &[u8], [width, height]: [usize; 2]) {
    let data = image_data(png);
    let mut surfaces = pdf.image_xobject(image, &data);
    surfaces.filter(Filter::FlateDecode);
    surfaces.width(width as i32).height(height as i32);
    surfaces.color_space().device_rgb();
    surfaces.bits_per_component(8);
    // The filters of PNG are predictors of PDF.
    let mut parameters = surfaces.insert(Name(b"DecodeParms")).dict();
    parameters.pair(Name(b"Predictor"), 15).pair(Name(b"Colors"), 3).pair(Name(b"BitsPerComponent"), 8);
    parameters.pair(Name(b"Columns"), width as i32);
}
