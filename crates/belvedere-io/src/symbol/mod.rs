//! Symbols of a scene's own: SVG files of filled shapes. What would be drawn otherwise than in a browser is refused, never left out.

mod path;

use crate::{InputFile, IoError, Loaded, fs};
use belvedere_scene::{Color, Drawing};
use glam::{DAffine2, DMat2, DVec2};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::io::Read;
use std::path::Path;

/// Largest file that is read, bytes.
const MAX_BYTES: u64 = 1 << 20;
/// Most vertices of a drawing.
const MAX_VERTICES: usize = 20_000;
/// Deepest nesting of elements.
const MAX_DEPTH: usize = 64;
/// Elements that draw nothing.
const SILENT: [&str; 6] = ["title", "desc", "metadata", "namedview", "perspective", "RDF"];

/// Reads a symbol: the view box of the drawing is two half sizes wide or high, whichever is more, and its middle is the point.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for a file that is no SVG, that holds nothing filled, or something that is not read: strokes,
/// gradients, texts, pictures, style sheets, clips, masks, filters.
pub fn load_symbol(path: &Path) -> Result<Loaded<Drawing>, IoError> {
    let os = |e| IoError::os(path, e);
    let mut bytes = Vec::new();
    fs::File::open(path).map_err(os)?.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(os)?;
    let bad = |reason: String| IoError::format(path, reason);
    if bytes.len() as u64 > MAX_BYTES {
        return Err(bad(format!("it is larger than {MAX_BYTES} bytes; a symbol is a small drawing, give one")));
    }
    let text = std::str::from_utf8(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes))
        .map_err(|_| bad("it is no text; give an SVG file of filled shapes".into()))?;
    let drawing = drawing(text).map_err(bad)?;
    Ok(Loaded::clean(drawing).with_file(InputFile::of(path, &bytes)))
}

/// What an element hands on to those inside.
#[derive(Clone, Copy)]
struct Look {
    place: DAffine2,
    fill: Fill,
    opacity: f64,
    even_odd: bool,
    silent: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Fill {
    None,
    /// The colour of the layer.
    Layer,
    Own(Color),
}

type Attributes = BTreeMap<String, String>;
/// Rings, colour, and whether a point inside an even number of rings is outside.
type Shape = (Vec<Vec<DVec2>>, Option<Color>, bool);

fn drawing(text: &str) -> Result<Drawing, String> {
    let mut reader = Reader::from_str(text);
    let outer = Look { place: DAffine2::IDENTITY, fill: Fill::Layer, opacity: 1.0, even_odd: false, silent: false };
    let mut open = vec![outer];
    let (mut view, mut shapes): (Option<[f64; 4]>, Vec<Shape>) = (None, Vec::new());
    loop {
        let event = reader.read_event().map_err(|e| format!("it is no well-formed XML ({e}); write it anew"))?;
        let (start, is_empty) = match &event {
            Event::Start(start) => (start, false),
            Event::Empty(start) => (start, true),
            Event::End(_) => {
                open.pop();
                continue;
            }
            Event::Eof => break,
            _ => continue,
        };
        let name = start.local_name().as_ref().to_owned();
        let attributes = attributes(start)?;
        let mut look = open.last().copied().unwrap_or(outer);
        if view.is_none() {
            if name != "svg" {
                return Err(format!("its first element is <{}>, not <svg>; give an SVG file", shorten(&name)));
            }
            view = Some(view_box(&attributes)?);
        }
        if !look.silent {
            look = element(&name, &attributes, look, &mut shapes)?;
        }
        if shapes.iter().flat_map(|shape| &shape.0).map(Vec::len).sum::<usize>() > MAX_VERTICES {
            return Err(format!("it has more than {MAX_VERTICES} vertices; simplify the drawing"));
        }
        if !is_empty {
            open.push(look);
            if open.len() > MAX_DEPTH {
                return Err(format!("its elements are nested more than {MAX_DEPTH} deep; flatten the drawing"));
            }
        }
    }
    let [x, y, w, h] = view.ok_or("it has no <svg> element; give an SVG file")?;
    let (middle, half) = (DVec2::new(x + 0.5 * w, y + 0.5 * h), 0.5 * w.max(h));
    let shapes = shapes.into_iter().filter_map(|(rings, color, even_odd)| {
        let placed = rings.into_iter().map(|ring| ring.into_iter().map(|p| (p - middle) / half).collect());
        let rings: Vec<Vec<DVec2>> = placed.filter(|ring: &Vec<DVec2>| ring.len() >= 3).collect();
        (!rings.is_empty()).then(|| (if even_odd { path::oriented(rings) } else { rings }, color))
    });
    let shapes: Vec<_> = shapes.collect();
    let far = shapes.iter().flat_map(|(rings, _)| rings.iter().flatten()).any(|p| !(p.abs().max_element() < 50.0));
    match (shapes.is_empty(), far) {
        (true, _) => Err("it has no filled shape; give one with <path>, <circle>, <rect> or <polygon>".into()),
        (_, true) => Err("its shapes lie far outside its viewBox; fit the viewBox to the drawing".into()),
        _ => Ok(Drawing { shapes }),
    }
}

/// Reads one element; its look for those inside.
fn element(name: &str, own: &Attributes, mut look: Look, shapes: &mut Vec<Shape>) -> Result<Look, String> {
    if SILENT.contains(&name) {
        look.silent = true;
        return Ok(look);
    }
    restyle(own, &mut look)?;
    let rings = match name {
        "svg" | "g" => return Ok(look),
        "defs" => return Ok(Look { silent: true, ..look }),
        "path" => path::rings(own.get("d").map_or("", String::as_str))?,
        "circle" | "ellipse" => {
            let [rx, ry] = match name {
                "circle" => [length(own, "r")?; 2],
                _ => [length(own, "rx")?, length(own, "ry")?],
            };
            let middle = DVec2::new(length(own, "cx")?, length(own, "cy")?);
            let at = |i: u32| middle + DVec2::new(rx, ry) * DVec2::from_angle(f64::from(i) * TAU / 72.0);
            vec![(0..72).map(at).collect()]
        }
        "rect" => {
            let radius = |key: &str, other: &str| length(own, if own.contains_key(key) { key } else { other });
            path::rectangle(
                [length(own, "x")?, length(own, "y")?],
                [length(own, "width")?, length(own, "height")?],
                [radius("rx", "ry")?, radius("ry", "rx")?],
            )
        }
        "polygon" => {
            let numbers = path::numbers(own.get("points").map_or("", String::as_str))?;
            vec![numbers.chunks_exact(2).map(|p| DVec2::new(p[0], p[1])).collect()]
        }
        other => {
            return Err(format!(
                "<{}> is not read; a symbol is made of <path>, <circle>, <ellipse>, <rect> and <polygon> in <g>",
                shorten(other)
            ));
        }
    };
    let color = match look.fill {
        Fill::None => return Ok(look),
        Fill::Layer if look.opacity >= 1.0 => None,
        Fill::Layer => return Err("opacity without a fill is not read; give the shape a fill".into()),
        Fill::Own(color) => Some(color.with_alpha((f64::from(color.a) * look.opacity).round() as u8)),
    };
    let moved = |ring: Vec<DVec2>| ring.into_iter().map(|p| look.place.transform_point2(p)).collect();
    let rings: Vec<Vec<DVec2>> = rings.into_iter().map(moved).collect();
    if rings.iter().flatten().any(|p| !p.is_finite()) {
        return Err("a coordinate is not finite; write the drawing anew".into());
    }
    shapes.push((rings, color, look.even_odd));
    Ok(look)
}

fn attributes(start: &BytesStart<'_>) -> Result<Attributes, String> {
    let mut out = Attributes::new();
    for attribute in start.attributes() {
        let attribute = attribute.map_err(|e| format!("an attribute is damaged ({e}); write it anew"))?;
        let key = attribute.key.as_ref().to_owned();
        let value = attribute.value.to_string();
        if key == "style" {
            let pairs = value.split(';').filter_map(|pair| pair.split_once(':'));
            out.extend(pairs.map(|(key, value)| (key.trim().to_owned(), value.trim().to_owned())));
        } else {
            out.entry(key).or_insert(value);
        }
    }
    Ok(out)
}

/// Takes fill, opacity and place from attributes, and refuses what else would be drawn.
fn restyle(own: &Attributes, look: &mut Look) -> Result<(), String> {
    for key in ["clip-path", "mask", "filter"] {
        if own.get(key).is_some_and(|value| value != "none") {
            return Err(format!("{key} is not read; draw the shape as it is seen"));
        }
    }
    if own.get("stroke").is_some_and(|stroke| stroke != "none") {
        return Err("stroke is not read; turn strokes into filled paths (Inkscape: Path, Stroke to Path)".into());
    }
    if own.get("display").is_some_and(|v| v == "none") || own.get("visibility").is_some_and(|v| v == "hidden") {
        look.silent = true;
    }
    if let Some(fill) = own.get("fill") {
        look.fill = match fill.as_str() {
            "none" => Fill::None,
            "currentColor" => Fill::Layer,
            "inherit" => look.fill,
            other => Fill::Own(color(other)?),
        };
    }
    for key in ["opacity", "fill-opacity"] {
        if let Some(value) = own.get(key) {
            look.opacity *= number(key, value)?.clamp(0.0, 1.0);
        }
    }
    if let Some(rule) = own.get("fill-rule") {
        look.even_odd = rule == "evenodd";
    }
    if let Some(transform) = own.get("transform") {
        look.place *= placed(transform)?;
    }
    Ok(())
}

fn color(text: &str) -> Result<Color, String> {
    const NAMES: [(&str, [u8; 3]); 10] = [
        ("black", [0; 3]),
        ("white", [255; 3]),
        ("red", [255, 0, 0]),
        ("green", [0, 128, 0]),
        ("blue", [0, 0, 255]),
        ("yellow", [255, 255, 0]),
        ("gray", [128; 3]),
        ("grey", [128; 3]),
        ("orange", [255, 165, 0]),
        ("brown", [165, 42, 42]),
    ];
    let refused = || format!("fill \"{}\" is not read; give #rgb, #rrggbb or none", shorten(text));
    if let Some((_, [r, g, b])) = NAMES.iter().find(|(name, _)| *name == text) {
        return Ok(Color::rgb(*r, *g, *b));
    }
    let digits = text.strip_prefix('#').filter(|d| d.is_ascii()).ok_or_else(refused)?;
    let long: String = match digits.len() {
        3 => digits.chars().flat_map(|c| [c, c]).collect(),
        6 => digits.to_owned(),
        _ => return Err(refused()),
    };
    let value = u32::from_str_radix(&long, 16).map_err(|_| refused())?;
    let [_, r, g, b] = value.to_be_bytes();
    Ok(Color::rgb(r, g, b))
}

/// `translate`, `scale`, `rotate`, `skewX`, `skewY` and `matrix`, in a row.
fn placed(text: &str) -> Result<DAffine2, String> {
    let refused = || format!("transform \"{}\" is not read; apply it to the shapes", shorten(text));
    let mut place = DAffine2::IDENTITY;
    for part in text.split(')').map(|part| part.trim_matches([' ', ',', '\n', '\t', '\r'])).filter(|p| !p.is_empty()) {
        let (name, values) = part.split_once('(').ok_or_else(refused)?;
        let values = path::numbers(values)?;
        place *= match (name.trim(), values.as_slice()) {
            ("translate", [x]) => DAffine2::from_translation(DVec2::new(*x, 0.0)),
            ("translate", [x, y]) => DAffine2::from_translation(DVec2::new(*x, *y)),
            ("scale", [s]) => DAffine2::from_scale(DVec2::splat(*s)),
            ("scale", [x, y]) => DAffine2::from_scale(DVec2::new(*x, *y)),
            ("rotate", [a]) => DAffine2::from_angle(a.to_radians()),
            ("rotate", [a, x, y]) => {
                let at = DVec2::new(*x, *y);
                let turned = DAffine2::from_translation(at) * DAffine2::from_angle(a.to_radians());
                turned * DAffine2::from_translation(-at)
            }
            ("skewX", [a]) => DAffine2::from_mat2(DMat2::from_cols_array(&[1.0, 0.0, a.to_radians().tan(), 1.0])),
            ("skewY", [a]) => DAffine2::from_mat2(DMat2::from_cols_array(&[1.0, a.to_radians().tan(), 0.0, 1.0])),
            ("matrix", [a, b, c, d, e, f]) => DAffine2::from_cols_array(&[*a, *b, *c, *d, *e, *f]),
            _ => return Err(refused()),
        };
    }
    Ok(place)
}

/// Left, top, width and height.
fn view_box(own: &Attributes) -> Result<[f64; 4], String> {
    let numbers = match own.get("viewBox") {
        Some(text) => path::numbers(text)?,
        None => vec![0.0, 0.0, length(own, "width")?, length(own, "height")?],
    };
    match numbers.as_slice() {
        [x, y, w, h] if *w > 0.0 && *h > 0.0 => Ok([*x, *y, *w, *h]),
        _ => Err("its <svg> has neither a viewBox of positive size nor width and height; give it one".into()),
    }
}

/// A length in units of the drawing; 0 where it is not given.
fn length(own: &Attributes, key: &str) -> Result<f64, String> {
    own.get(key).map_or(Ok(0.0), |text| number(key, text.trim_end_matches("px")))
}

fn number(key: &str, text: &str) -> Result<f64, String> {
    let value: Option<f64> = text.trim().parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| format!("{key}=\"{}\" is not read; give a number without a unit", shorten(text)))
}

fn shorten(text: &str) -> String {
    text.chars().take(40).collect()
}

#[cfg(test)]
mod tests;
