//! SVG with layers of Inkscape and live text; its units are the pixels of the picture, its page is the paper.

use super::{AreaShape, Page, Piece, VectorPicture, is_blank, tolerance_px};
use crate::sheet::REFERENCE_DPI;
use belvedere_composite::canvas::CanvasShape;
use belvedere_composite::marks::{LayerShapes, LineShape, Paint, Role, SymbolShape, outline, simplified};
use belvedere_core::DVec2;
use belvedere_core::plain::escaped;
use belvedere_scene::{Color, Symbol};
use std::fmt::Write;

/// Parts of a pixel that positions are rounded to.
const PARTS: f64 = 100.0;
/// Families of letters, the embedded one of pictures first.
const FAMILIES: &str = "'DejaVu Sans Condensed', 'DejaVu Sans', sans-serif";

/// The document.
pub fn write(picture: &VectorPicture, page: &Page<'_>) -> String {
    let [w, h] = page.size.map(|side| side as f64);
    let dpi = page.sheet.map_or(REFERENCE_DPI, |sheet| sheet.dpi);
    let margin = page.sheet.map_or(0.0, |sheet| sheet.margin_mm / 25.4 * dpi);
    let paper = page.sheet.map_or([w, h].map(|px| px / dpi * 25.4), |sheet| sheet.paper_mm);
    let mut out = Svg { text: String::new(), tolerance: tolerance_px(dpi), alone: !picture.over_raster, baselines: 0 };
    out.line("<?xml version=\"1.0\" encoding=\"UTF-8\"?>");
    out.line(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
         xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" version=\"1.1\" width=\"{}mm\" height=\"{}mm\" \
         viewBox=\"{} {} {} {}\">",
        number(paper[0]),
        number(paper[1]),
        number(-margin),
        number(-margin),
        number(w + 2.0 * margin),
        number(h + 2.0 * margin)
    ));
    if !page.title.is_empty() {
        out.line(&format!("<title>{}</title>", xml(page.title)));
    }
    out.line(&format!("<desc>{}</desc>", xml(page.description)));
    out.line(&format!(
        "<defs><clipPath id=\"frame\"><rect width=\"{}\" height=\"{}\"/></clipPath></defs>",
        number(w),
        number(h)
    ));
    if let Some(png) = page.raster {
        out.open("surfaces", "surfaces");
        out.line(&format!(
            "<image width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" xlink:href=\"data:image/png;base64,{}\"/>",
            number(w),
            number(h),
            base64(png)
        ));
        out.close();
    }
    out.layers(picture);
    if !picture.marks.names.is_empty() {
        out.open("names", "names");
        picture.marks.names.iter().for_each(|shape| out.shape(shape));
        out.close();
    }
    for furniture in picture.furniture.iter().filter(|f| !f.shapes.is_empty()) {
        out.open(furniture.name, furniture.name);
        furniture.shapes.iter().for_each(|shape| out.shape(shape));
        out.close();
    }
    out.line("</svg>");
    out.text
}

struct Svg {
    text: String,
    /// Of simplified lines, pixels.
    tolerance: f64,
    /// Whether there is no raster below.
    alone: bool,
    /// Baselines of curved texts.
    baselines: usize,
}

impl Svg {
    fn line(&mut self, text: &str) {
        self.text.push_str(text);
        self.text.push('\n');
    }

    fn open(&mut self, id: &str, label: &str) {
        self.line(&format!(
            "<g inkscape:groupmode=\"layer\" id=\"{id}\" inkscape:label=\"{}\" clip-path=\"url(#frame)\">",
            xml(label)
        ));
    }

    fn close(&mut self) {
        self.line("</g>");
    }

    /// Fills, grid, lines and symbols.
    fn layers(&mut self, picture: &VectorPicture) {
        for piece in picture.pieces() {
            match piece {
                Piece::Fills(index, areas) => {
                    let label = &picture.layers[index];
                    match picture.has_marks(index) {
                        // Its outlines are the layer.
                        true => self.line(&format!(
                            "<g id=\"layer{}-fill\" inkscape:label=\"{}\" clip-path=\"url(#frame)\">",
                            index + 1,
                            xml(label)
                        )),
                        false => self.open(&format!("layer{}", index + 1), label),
                    }
                    areas.into_iter().for_each(|area| self.area(area));
                    self.close();
                }
                Piece::Grid(sheets) if is_blank(sheets) => {}
                Piece::Overlay(sheets) if is_blank(sheets) => {}
                Piece::Grid(sheets) => self.sheets(("grid", "grid"), sheets),
                Piece::Overlay(sheets) => self.sheets(("overlay", "overlay"), sheets),
                Piece::Marks(index, sheets) => {
                    self.sheets((&format!("layer{}", index + 1), &picture.layers[index]), sheets);
                }
            }
        }
    }

    fn sheets(&mut self, (id, label): (&str, &str), sheets: &[LayerShapes]) {
        self.open(id, label);
        sheets.iter().for_each(|sheet| self.sheet(sheet));
        self.close();
    }

    /// Lines and symbols that are painted alike: hidden parts, rims, visible parts.
    fn sheet(&mut self, sheet: &LayerShapes) {
        let lengths = [true, false].map(|visible| {
            let of = sheet.lines.iter().filter(|line| line.visible == visible);
            of.map(|line| line.length).sum::<f64>()
        });
        let said = match sheet.lines.is_empty() {
            true => String::new(),
            false => {
                format!(" data-visible-length=\"{}\" data-hidden-length=\"{}\"", number(lengths[0]), number(lengths[1]))
            }
        };
        self.line(&format!("<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\"{said}>"));
        for (role, paint, class) in [
            (Role::Hidden, sheet.hidden, "hidden"),
            (Role::Casing, sheet.casing, "casing"),
            (Role::Fill, sheet.fill, "visible"),
        ] {
            self.role(sheet, (role, paint, class));
        }
        self.close();
    }

    fn role(&mut self, sheet: &LayerShapes, (role, paint, class): (Role, Paint, &str)) {
        let width = |line: &LineShape| match role {
            Role::Casing => line.casing,
            _ => (line.role == role).then_some(line.width),
        };
        let lines: Vec<(&LineShape, f64)> = sheet
            .lines
            .iter()
            .filter(|line| line.drawn)
            .filter_map(|line| Some((line, width(line)?)))
            .filter(|(_, width)| *width > 0.0)
            .collect();
        let symbols: Vec<&SymbolShape> = sheet.symbols.iter().filter(|symbol| symbol.role == role).collect();
        if paint.opacity <= 0.0 || (lines.is_empty() && symbols.is_empty()) {
            return;
        }
        let opacity = if paint.opacity < 1.0 { format!(" opacity=\"{}\"", part(paint.opacity)) } else { String::new() };
        let color = hex(paint.color);
        let stroke_width = lines.first().map(|(_, width)| *width);
        let attributes = stroke_width
            .map_or(String::new(), |width| format!(" stroke=\"{color}\" stroke-width=\"{}\"", number(width)));
        self.line(&format!("<g class=\"{class}\"{attributes}{opacity}>"));
        for (line, own) in lines {
            let data = path(&simplified(&line.points, self.tolerance), false);
            let own = match stroke_width {
                Some(width) if number(width) != number(own) => format!(" stroke-width=\"{}\"", number(own)),
                _ => String::new(),
            };
            let dash = match line.dash.filter(|dash| dash.iter().all(|length| *length > 0.0)) {
                Some([ink, gap]) => format!(" stroke-dasharray=\"{},{}\"", number(ink), number(gap)),
                None => String::new(),
            };
            self.line(&format!("<path d=\"{data}\"{own}{dash}/>"));
        }
        for symbol in symbols {
            self.symbol(symbol, &color);
        }
        self.close();
    }

    fn symbol(&mut self, symbol: &SymbolShape, color: &str) {
        // A rim is the outline drawn with a pen.
        let pen = match symbol.grow > 0.0 {
            true => format!(" stroke=\"{color}\" stroke-width=\"{}\"", number(2.0 * symbol.grow)),
            false => " stroke=\"none\"".to_owned(),
        };
        let shape = match symbol.symbol {
            Symbol::Dot => format!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"",
                number(symbol.at.x),
                number(symbol.at.y),
                number(symbol.half)
            ),
            other => {
                let moved = |ring: Vec<DVec2>| ring.into_iter().map(|p| symbol.at + p).collect::<Vec<_>>();
                let rings = outline(other, symbol.half).into_iter().map(|ring| path(&moved(ring), true));
                format!("<path d=\"{}\"", rings.collect::<String>())
            }
        };
        self.line(&format!("{shape} fill=\"{color}\"{pen}/>"));
    }

    fn area(&mut self, area: &AreaShape) {
        let data: Vec<String> =
            area.rings.iter().map(|ring| path(&ring[..ring.len().saturating_sub(1)], true)).collect();
        // In the raster areas are coloured with the light and the relief of the ground.
        let fill = match self.alone {
            true => format!("fill=\"{}\"{}", hex(area.fill), opacity("fill-opacity", area.fill)),
            false => "fill=\"none\"".to_owned(),
        };
        let name = if area.name.is_empty() { String::new() } else { format!("<title>{}</title>", xml(&area.name)) };
        self.line(&format!("<path class=\"area\" {fill} fill-rule=\"evenodd\" d=\"{}\">{name}</path>", data.join("")));
    }

    fn shape(&mut self, shape: &CanvasShape) {
        let text = match shape {
            CanvasShape::Rect { corners: [lo, hi], radius, color } => format!(
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{} fill=\"{}\"{}/>",
                number(lo.x),
                number(lo.y),
                number(hi.x - lo.x),
                number(hi.y - lo.y),
                if *radius > 0.0 { format!(" rx=\"{}\"", number(*radius)) } else { String::new() },
                hex(*color),
                opacity("fill-opacity", *color)
            ),
            CanvasShape::Line { points, width, color } => format!(
                "<path d=\"{}\" fill=\"none\" stroke=\"{}\"{} stroke-width=\"{}\" stroke-linecap=\"round\" \
                 stroke-linejoin=\"round\"/>",
                path(&simplified(points, self.tolerance), false),
                hex(*color),
                opacity("stroke-opacity", *color),
                number(*width)
            ),
            CanvasShape::Disc { at, radius, color } => format!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"{}/>",
                number(at.x),
                number(at.y),
                number(*radius),
                hex(*color),
                opacity("fill-opacity", *color)
            ),
            CanvasShape::Polygon { rings, color } => {
                let data: String = rings.iter().map(|ring| path(ring, true)).collect();
                let (fill, alpha) = (hex(*color), opacity("fill-opacity", *color));
                format!("<path d=\"{data}\" fill=\"{fill}\"{alpha} fill-rule=\"evenodd\"/>")
            }
            CanvasShape::Text { at, size, text, fonts, along, color, halo, .. } => {
                let halo = halo.map_or(String::new(), |(color, width)| {
                    let alpha = opacity("stroke-opacity", color);
                    format!(
                        " stroke=\"{}\"{alpha} stroke-width=\"{}\" stroke-linejoin=\"round\" paint-order=\"stroke\"",
                        hex(color),
                        number(2.0 * width)
                    )
                });
                let families = fonts.families().into_iter().map(|family| format!("'{}', ", family.replace('\'', "")));
                let families = FAMILIES.replace("sans-serif", &format!("{}sans-serif", families.collect::<String>()));
                let look = format!(
                    "font-family=\"{}\" font-stretch=\"condensed\" font-size=\"{}\" fill=\"{}\"{}{halo}",
                    xml(&families),
                    number(*size),
                    hex(*color),
                    opacity("fill-opacity", *color),
                );
                match along.is_empty() {
                    true => format!("<text x=\"{}\" y=\"{}\" {look}>{}</text>", number(at.x), number(at.y), xml(text)),
                    false => {
                        self.baselines += 1;
                        let (id, data) = (self.baselines, path(&simplified(along, self.tolerance), false));
                        format!(
                            "<defs><path id=\"baseline{id}\" d=\"{data}\"/></defs>\n\
                             <text {look}><textPath xlink:href=\"#baseline{id}\">{}</textPath></text>",
                            xml(text)
                        )
                    }
                }
            }
        };
        self.line(&text);
    }
}

/// Path data of a polyline, positions relative to the one before.
fn path(points: &[DVec2], closed: bool) -> String {
    let rounded = |p: &DVec2| (*p * PARTS).round().as_i64vec2();
    let mut out = String::new();
    let mut last = None;
    for point in points.iter().map(rounded) {
        let (sign, at) = match last.replace(point) {
            None => ("M", point),
            Some(before) if before == point => continue,
            Some(before) => ("l", point - before),
        };
        let [x, y] = [at.x, at.y].map(|v| number(v as f64 / PARTS));
        let _ = write!(out, "{sign}{x}{}{y}", if y.starts_with('-') { "" } else { " " });
    }
    if closed {
        out.push('Z');
    } else if points.len() > 1 && !out.contains('l') {
        // A dot: a line shorter than its rounding.
        out.push_str("l0 0");
    }
    out
}

/// A number with at most two decimals.
fn number(value: f64) -> String {
    let rounded = (value * PARTS).round() / PARTS;
    // No negative zero.
    format!("{}", rounded + 0.0)
}

fn part(share: f32) -> String {
    format!("{}", (f64::from(share) * 1000.0).round() / 1000.0)
}

fn hex(c: Color) -> String {
    format!("#{:02x}{:02x}{:02x}", c.r, c.g, c.b)
}

/// The opacity of a colour as an attribute; empty for an opaque one.
fn opacity(attribute: &str, c: Color) -> String {
    if c.a == 255 { String::new() } else { format!(" {attribute}=\"{}\"", part(f32::from(c.a) / 255.0)) }
}

/// Text without control characters and with the signs of XML replaced.
fn xml(text: &str) -> String {
    // XML has no such signs, and those that turn the direction of text are not drawn.
    let lost = |c: char| matches!(c, '\u{fffe}' | '\u{ffff}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let known: String = text.chars().filter(|c| !lost(*c)).collect();
    escaped(&known).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let word = (0..3).fold(0u32, |word, i| word << 8 | u32::from(three.get(i).copied().unwrap_or(0)));
        for i in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * i)) as usize & 63] as char;
            out.push(if i <= three.len() { digit } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_those_that_xml_has() {
        assert_eq!(xml("a<b>&\"c\" \u{ffff}\u{fffe}\u{202e}d"), "a&lt;b&gt;&amp;&quot;c&quot; d");
    }

    #[test]
    fn base64_is_that_of_the_standard() {
        // Test vectors of RFC 4648, section 10.
        for (text, wanted) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(text.as_bytes()), wanted);
        }
    }

    #[test]
    fn roundings_of_a_path_do_not_add_up() {
        let points: Vec<DVec2> = (0..5000).map(|i| DVec2::new(0.3337 * f64::from(i), -0.0049 * f64::from(i))).collect();
        let data = path(&points, false);
        let numbers = data.replace(['M', 'l'], " ").replace('-', " -");
        let values: Vec<f64> = numbers.split_whitespace().map(|v| v.parse().expect("a number")).collect();
        let sum = values.chunks(2).fold(DVec2::ZERO, |sum, v| sum + DVec2::new(v[0], v[1]));
        assert!(sum.distance(points[4999]) < 0.008, "{sum} instead of {}", points[4999]);
        assert_eq!(path(&[DVec2::ONE, DVec2::ONE], false), "M1 1l0 0");
        assert_eq!(number(-0.001), "0");
    }
}
