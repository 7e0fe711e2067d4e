//! Vectors without the raster are painted in the order of pictures of pixels, and never an empty file in silence.

use crate::vectors::{attribute, lines};
use belvedere::core::{DVec2, polygon};
use belvedere::picture::{Picture, PictureOptions};
use belvedere::scene_file::parse;
use belvedere::vectors::VectorContent;
use belvedere::{BelvedereError, OpenOptions, Session};
use quick_xml::Reader;
use quick_xml::events::Event;
use std::path::Path;

const GROUND: &str = "[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'builtin:massif?seed=7&size=65'\n";
const CAMERA: &str =
    "[camera]\neye = [300, -9000, 14000]\nlook_at = [0, 0, 2000]\nfov_y_deg = 30\nimage = [640, 400]\n";
/// Layers that cross each other: name, kind, geometry, coordinates, style.
const LAYERS: [[&str; 5]; 7] = [
    [
        "lake",
        "area",
        "Polygon",
        "[[[-2500,-1500],[2500,-1500],[2500,1500],[-2500,1500],[-2500,-1500]]]",
        "color = '#4a85a8', outline = '#103050', width_px = 6.0",
    ],
    ["park", "area", "Polygon", "[[[-3500,-600],[600,-2600],[3200,800],[-3500,-600]]]", "color = '#40a04080'"],
    ["trail", "line", "LineString", "[[-3200,-200],[0,300],[3200,-200]]", "color = '#d7301f', width_px = 8.0"],
    ["road", "line", "LineString", "[[-200,-2600],[300,0],[-100,2600]]", "color = '#f0c020', width_px = 9.0"],
    ["path", "line", "LineString", "[[-2800,-1800],[2800,1900]]", "color = '#7030a0', width_px = 7.0, casing = 'none'"],
    ["huts", "point", "Point", "[300,0]", "color = '#202020', symbol = 'dot', size_px = 22.0"],
    ["wells", "point", "Point", "[1500,50]", "color = '#2060f0', symbol = 'square', size_px = 18.0"],
];

/// A scene whose layers stand in an order.
fn session(folder: &Path, order: &[usize], more: &str) -> Session {
    let mut text = format!("format = 1\ncrs = 'local'\n{GROUND}");
    for &k in order {
        let [name, kind, geometry, at, style] = LAYERS[k];
        let feature = format!(
            "{{\"type\":\"Feature\",\"properties\":{{}},\"geometry\":{{\"type\":\"{geometry}\",\"coordinates\":{at}}}}}"
        );
        std::fs::write(folder.join(format!("{name}.geojson")), feature).expect("written");
        text +=
            &format!("[[layer]]\nid = '{name}'\nkind = '{kind}'\nsource = '{name}.geojson'\nstyle = {{ {style} }}\n");
    }
    opened(folder, &(text + more + CAMERA)).expect("a session")
}

fn opened(folder: &Path, text: &str) -> Result<Session, BelvedereError> {
    Session::from_document(parse(&folder.join("s.toml"), text).expect("a scene"), &OpenOptions::default())
}

fn drawn(session: &Session, vectors: VectorContent) -> Result<Picture, BelvedereError> {
    session.render(&PictureOptions { vectors, ..PictureOptions::default() })
}

/// A filled or stroked path, or a disc, as it is painted.
struct Shape {
    layer: String,
    lines: Vec<Vec<DVec2>>,
    fill: Option<([u8; 3], f64)>,
    stroke: Option<([u8; 3], f64)>,
    width: f64,
    dashed: bool,
    disc: Option<(DVec2, f64)>,
}

fn color(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#')?;
    Some([0, 2, 4].map(|at| u8::from_str_radix(&digits[at..at + 2], 16).expect("a colour")))
}

/// The shapes of a document in the order of painting, and where its texts begin.
fn shapes(svg: &str) -> (Vec<Shape>, Vec<DVec2>) {
    // Layer, stroke, width and opacity of the open groups.
    let mut open: Vec<(String, String, f64, f64)> = vec![(String::new(), "none".into(), 1.0, 1.0)];
    let (mut out, mut texts, mut reader) = (Vec::new(), Vec::new(), Reader::from_str(svg));
    loop {
        let event = reader.read_event().expect("XML");
        match &event {
            Event::Start(tag) | Event::Empty(tag) => {
                let get = |name: &str| attribute(tag, name);
                let number = |name: &str| get(name).map(|v| v.parse::<f64>().expect("a number"));
                let (layer, stroke, width, opacity) = open.last().cloned().expect("a root");
                let here = (
                    get("inkscape:label").unwrap_or(layer),
                    get("stroke").unwrap_or(stroke),
                    number("stroke-width").unwrap_or(width),
                    opacity * number("opacity").unwrap_or(1.0),
                );
                let name = tag.name();
                if name.as_ref() == "path" || name.as_ref() == "circle" {
                    let disc = number("cx").map(|x| (DVec2::new(x, number("cy").expect("y")), number("r").expect("r")));
                    let alpha = here.3 * number("fill-opacity").unwrap_or(1.0);
                    out.push(Shape {
                        layer: here.0.clone(),
                        lines: get("d").map_or_else(Vec::new, |data| lines(&data)),
                        fill: color(&get("fill").unwrap_or_default()).map(|c| (c, alpha)),
                        stroke: color(&here.1).map(|c| (c, here.3)),
                        width: here.2,
                        dashed: get("stroke-dasharray").is_some(),
                        disc,
                    });
                }
                if name.as_ref() == "text" {
                    texts.push(DVec2::new(number("x").expect("x"), number("y").expect("y")));
                }
                if matches!(event, Event::Start(_)) {
                    open.push(here);
                }
            }
            Event::End(_) => drop(open.pop()),
            Event::Eof => return (out, texts),
            _ => {}
        }
    }
}

impl Shape {
    /// Signed distances from the borders of fill and stroke, negative inside, pixels.
    fn off(&self, p: DVec2) -> [f64; 2] {
        if let Some((at, radius)) = self.disc {
            let off = p.distance(at) - radius;
            return [off, off - 0.5 * self.width];
        }
        let pieces = || self.lines.iter().flat_map(|line| line.windows(2));
        let rim = pieces().map(|w| polygon::to_segment(p, w[0], w[1]).length()).fold(f64::INFINITY, f64::min);
        let inside = polygon::is_inside(&self.lines, p);
        [if inside { -rim } else { rim }, rim - 0.5 * self.width]
    }
}

/// Colour of vectors at a pixel; `None` where they do not cover what lies below, or where the border of a shape runs through it and nothing
/// covers that.
fn painted(shapes: &[Shape], p: DVec2) -> Option<[u8; 3]> {
    let mut color: Option<[f64; 3]> = None;
    for shape in shapes {
        let [fill, stroke] = shape.off(p);
        for (paint, off) in [(shape.fill, fill), (shape.stroke, stroke)] {
            let Some((rgb, alpha)) = paint else { continue };
            if off.abs() < 1.2 || shape.dashed && off < 0.0 {
                color = None;
            } else if off < 0.0 && alpha >= 1.0 {
                color = Some(rgb.map(f64::from));
            } else if off < 0.0 {
                color = color.map(|below| std::array::from_fn(|k| below[k] + alpha * (f64::from(rgb[k]) - below[k])));
            }
        }
    }
    color.map(|c| c.map(|v| v.round() as u8))
}

#[test]
fn lines_and_points_have_the_colours_of_the_raster_whatever_the_order_of_layers() {
    let folder = tempfile::tempdir().expect("a folder");
    let grid = "[overlay]\ngrid = 1000.0\n";
    let mut seed = 0x2545_f491_u64;
    let mut compared = std::collections::BTreeMap::<String, usize>::new();
    for round in 0..6 {
        let mut order: Vec<usize> = (0..LAYERS.len()).collect();
        for k in (1..order.len()).rev() {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            order.swap(k, (seed >> 33) as usize % (k + 1));
        }
        let session = session(folder.path(), &order, if round == 0 { grid } else { "" });
        let picture = drawn(&session, VectorContent::Nothing).expect("a picture");
        let svg =
            drawn(&session, VectorContent::Alone).expect("a picture").to_svg().expect("written").expect("vectors");
        let (shapes, texts) = shapes(&svg);
        let (width, _, pixels) = picture.pixels();
        let mut wrong = Vec::new();
        for shape in shapes.iter().filter(|shape| shape.fill.is_none() || shape.disc.is_some()) {
            let places = shape.lines.iter().flat_map(|line| line.windows(2)).flat_map(|w| {
                let n = (w[0].distance(w[1]) / 3.0).ceil().max(1.0) as usize;
                (0..n).map(move |k| w[0].lerp(w[1], (k as f64 + 0.5) / n as f64))
            });
            for at in places.chain(shape.disc.map(|(at, _)| at)) {
                let inside = at.cmpge(DVec2::ONE).all() && at.x < width as f64 - 1.0 && at.y < 399.0;
                let centre = at.floor() + 0.5;
                let free = inside && texts.iter().all(|text| text.distance(at) > 60.0);
                let Some(color) = painted(&shapes, centre).filter(|_| free) else { continue };
                let here = pixels[centre.y as usize * width + centre.x as usize];
                *compared.entry(shape.layer.clone()).or_default() += 1;
                if color.iter().zip(here).any(|(a, b)| a.abs_diff(b) > 3) {
                    wrong.push((shape.layer.clone(), centre, color, here));
                }
            }
        }
        let names: Vec<&str> = order.iter().map(|k| LAYERS[*k][0]).collect();
        assert!(wrong.is_empty(), "{} wrong in {names:?}, such as {:?}", wrong.len(), wrong[0]);
    }
    // Enough of every line, hut and outline was compared.
    for (layer, least) in [("lake", 100), ("trail", 300), ("road", 300), ("path", 300), ("huts", 6)] {
        assert!(compared.get(layer).is_some_and(|count| *count >= least), "{layer}: {compared:?}");
    }
}

#[test]
fn a_scene_without_vectors_is_refused_and_what_some_layers_lack_is_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let head = "format = 1\ncrs = 'local'\n";
    let church = "[[layer]]\nid = 'church'\nkind = 'mesh'\nsource = 'builtin:church'\n";
    let houses =
        "[[layer]]\nid = 'houses'\nkind = 'boxes'\nboxes = [{ base = [0, 0, 2500], size = [300, 300, 300] }]\n";
    for (layers, words) in [(GROUND, "ground (terrain)"), (houses, "houses (boxes)"), (church, "church (mesh)")] {
        let session = opened(folder.path(), &format!("{head}{layers}{CAMERA}")).expect("a session");
        let error = drawn(&session, VectorContent::Alone).expect_err("nothing to draw").to_string();
        assert!(error.contains(words) && error.contains("nothing in this scene is drawn as vectors"), "{error}");
        assert!(error.len() <= 500 && !error.contains('\n') && error.contains("PNG"), "{error}");
        // Over the raster there is something to see.
        drawn(&session, VectorContent::OverRaster).expect("a picture");
    }
    let all: Vec<usize> = (0..LAYERS.len()).collect();
    let counts = |more: &str, vectors: VectorContent| {
        let picture = drawn(&session(folder.path(), &all, more), vectors).expect("a picture");
        let said = &picture.sidecar.warnings;
        said.iter().filter(|w| w.text().contains("vectors")).map(|w| w.text().to_owned()).collect::<Vec<_>>()
    };
    assert!(counts("", VectorContent::Alone).is_empty());
    assert!(counts(houses, VectorContent::OverRaster).is_empty());
    let said = counts(&format!("{houses}{church}"), VectorContent::Alone);
    assert!(said.len() == 1 && said[0].starts_with("2 layers"), "{said:?}");
    assert!(said[0].contains("houses (boxes), church (mesh)"), "{said:?}");
}
