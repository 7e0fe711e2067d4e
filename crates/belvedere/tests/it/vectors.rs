//! Pictures as vectors, read by another reader of XML: where lines and areas lie, how much of them is hidden, names, layers.

use belvedere::core::{DVec2, DVec3};
use belvedere::picture::PictureOptions;
use belvedere::print::Sheet;
use belvedere::scene::{LayerKind, Scene};
use belvedere::scene_file::{PrintDoc, parse};
use belvedere::sight::trace::Tracer;
use belvedere::vectors::VectorContent;
use belvedere::verbs::measure::MeasureOptions;
use belvedere::{OpenOptions, Session};
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use std::path::Path;

const LAYERS: &str = "[[layer]]
id = 'ground'
kind = 'terrain'
source = 'builtin:massif?seed=7&size=129'
[[layer]]
id = 'lake'
kind = 'area'
source = 'builtin:massif?seed=7&size=129'
style = { color = '#4a85a8', outline = '#2a5878' }
[[layer]]
id = 'trail'
kind = 'line'
source = 'builtin:massif?seed=7&size=129'
must_see = true
style = { distance_markers_m = 'auto' }
";
const CURVED: &str = "[[stage]]
kind = 'curved_rays'
[[stage.turn]]
viewpoint = [7971.7, -7336.9, 9380.0]
t0 = [4738.3, -4103.5, 3280.0]
t1 = [2840.4, -2205.6, 2986.5]
t2 = [239.6, 395.1, 2584.3]
normal = [-0.7029, 0.7029, -0.1087]
";
const SPLINE: &str = "[[stage]]\nkind = 'spline_bend'\npresets = 'progressive'\n";
const TERRAIN: &str = "[[stage]]\nkind = 'terrain_disocclusion'\nmode = 'paper+qp'\nsolver_nodes = 33\n";
const TECHNIQUES: [(&str, &str); 4] =
    [("straight", ""), ("curved rays", CURVED), ("spline", SPLINE), ("terrain", TERRAIN)];

fn session(stages: &str, seed: u32, image: [u32; 2]) -> Session {
    // Eyes apart from each other by up to a kilometre.
    let off = |k: u32| f64::from((seed * 7919 + k * 104_729) % 1000);
    let eye = [7971.7 - off(1), -7336.9 + off(2), 3780.0 + off(3)];
    let text = format!(
        "format = 1\ncrs = 'local'\n{LAYERS}[camera]\neye = {eye:?}\nlook_at = [-952.3, 1587.0, 2400.0]\nfov_y_deg = 51\nimage = {image:?}\n{stages}"
    );
    Session::from_document(parse(Path::new("s.toml"), &text).expect("scene"), &OpenOptions::default()).expect("session")
}

fn svg(session: &Session, vectors: VectorContent) -> String {
    let picture = session.render(&PictureOptions { vectors, ..PictureOptions::default() }).expect("a picture");
    picture.to_svg().expect("written").expect("vectors")
}

pub(crate) fn attribute(tag: &BytesStart<'_>, name: &str) -> Option<String> {
    let found = tag.attributes().map(|a| a.expect("an attribute")).find(|a| a.key.as_ref() == name)?;
    Some(found.normalized_value(XmlVersion::Implicit1_0).expect("its value").into_owned())
}

/// A path with the layer and the class of the group that it stands in.
struct Path2 {
    layer: String,
    class: String,
    lines: Vec<Vec<DVec2>>,
}

/// Everything that tests ask a document about.
#[derive(Default)]
struct Document {
    layers: Vec<String>,
    texts: Vec<String>,
    paths: Vec<Path2>,
    /// Layer, and visible and hidden length of its lines.
    lengths: Vec<(String, [f64; 2])>,
    images: usize,
    view_box: Vec<f64>,
    size: [String; 2],
}

fn read(svg: &str) -> Document {
    let mut reader = Reader::from_str(svg);
    let mut out = Document::default();
    let mut open: Vec<(String, String)> = Vec::new();
    let mut text: Option<String> = None;
    loop {
        let event = reader.read_event().expect("XML");
        match &event {
            Event::Start(tag) | Event::Empty(tag) => {
                let (mut layer, mut class) = open.last().cloned().unwrap_or_default();
                let get = |name: &str| attribute(tag, name);
                match tag.name().as_ref() {
                    "svg" => {
                        let numbers = get("viewBox").expect("a box");
                        out.view_box = numbers.split(' ').map(|v| v.parse().expect("a number")).collect();
                        out.size = [get("width").expect("a width"), get("height").expect("a height")];
                    }
                    "g" => {
                        if get("inkscape:groupmode").as_deref() == Some("layer") {
                            layer = get("inkscape:label").expect("a name");
                            out.layers.push(layer.clone());
                        }
                        class = get("class").unwrap_or(class);
                        if let (Some(a), Some(b)) = (get("data-visible-length"), get("data-hidden-length")) {
                            out.lengths.push((layer.clone(), [a, b].map(|v| v.parse().expect("a number"))));
                        }
                    }
                    "path" => {
                        let class = get("class").unwrap_or(class.clone());
                        let lines = lines(&get("d").expect("data"));
                        out.paths.push(Path2 { layer: layer.clone(), class, lines });
                    }
                    "image" => out.images += 1,
                    "text" => text = Some(String::new()),
                    _ => {}
                }
                if matches!(event, Event::Start(_)) {
                    open.push((layer, class));
                }
            }
            Event::Text(found) => {
                if let Some(text) = &mut text {
                    text.push_str(&found.xml10_content());
                }
            }
            Event::GeneralRef(found) => {
                if let Some(text) = &mut text {
                    text.push_str(match &found[..] {
                        "amp" => "&",
                        "lt" => "<",
                        "gt" => ">",
                        other => panic!("{other}"),
                    });
                }
            }
            Event::End(tag) => {
                open.pop();
                if tag.name().as_ref() == "text" {
                    out.texts.extend(text.take());
                }
            }
            Event::Eof => return out,
            _ => {}
        }
    }
}

/// Polylines of path data of `M`, `l` and `Z`.
pub(crate) fn lines(data: &str) -> Vec<Vec<DVec2>> {
    let mut out: Vec<Vec<DVec2>> = Vec::new();
    let commands =
        ["M", "l", "Z"].iter().fold(data.replace('-', " -"), |text, sign| text.replace(sign, &format!("\n{sign}")));
    for command in commands.lines() {
        let (sign, rest) = command.trim().split_at_checked(1).unwrap_or_default();
        let values: Vec<f64> = rest.split_whitespace().map(|v| v.parse().expect("a number")).collect();
        match (sign, &values[..]) {
            ("M", [x, y]) => out.push(vec![DVec2::new(*x, *y)]),
            ("l", [x, y]) => {
                let line = out.last_mut().expect("a beginning");
                line.push(*line.last().expect("a point") + DVec2::new(*x, *y));
            }
            ("Z", []) => {
                let line = out.last_mut().expect("a beginning");
                line.push(line[0]);
            }
            ("", []) => {}
            other => panic!("{other:?} in {data}"),
        }
    }
    out
}

/// Distance of a point from the nearest of some paths, pixels.
fn off<'a>(p: DVec2, paths: impl Iterator<Item = &'a Path2>) -> f64 {
    let pieces = paths.flat_map(|path| &path.lines).flat_map(|line| line.windows(2));
    pieces.map(|w| belvedere::core::polygon::to_segment(p, w[0], w[1]).length()).fold(f64::INFINITY, f64::min)
}

fn layer<'s>(scene: &'s Scene, id: &str) -> &'s LayerKind {
    &scene.layers.iter().find(|layer| layer.id == id).expect("a layer").kind
}

/// Pixels of points on the ground, `lift` over it, where they lie well inside the picture.
fn projected(session: &Session, points: impl Iterator<Item = DVec2>, lift: f64) -> Vec<(DVec3, DVec2)> {
    let size = session.view().pinhole().image.map(f64::from);
    let ground = session.scene().terrain().expect("ground");
    let on_ground = points.filter_map(|p| Some(p.extend(ground.surface_at(p)? + lift)));
    let images = on_ground.filter_map(|p| Some((p, session.view().project(p).ok()?.pixel)));
    images.filter(|(_, at)| at.cmpge(DVec2::splat(1.0)).all() && at.x < size[0] - 1.0 && at.y < size[1] - 1.0).collect()
}

#[test]
fn lines_and_borders_of_areas_lie_where_they_are_seen() {
    let mut worst: [(f64, usize); 2] = [(0.0, 0); 2];
    for (name, stages) in TECHNIQUES {
        let seeds = if cfg!(debug_assertions) { 1 } else { 2 };
        for seed in 0..seeds {
            let session = session(stages, seed, [640, 400]);
            let document = read(&svg(&session, VectorContent::Alone));
            let scene = session.scene();
            let LayerKind::Line(trail) = layer(scene, "trail") else { panic!("no line") };
            let vertices = trail.features.iter().flat_map(|f| &f.points).map(|p| p.truncate());
            for (_, at) in projected(&session, vertices, trail.lift_m) {
                let of_trail = |path: &&Path2| path.layer == "trail" && path.class != "casing";
                let off = off(at, document.paths.iter().filter(of_trail));
                worst[0] = (worst[0].0.max(off), worst[0].1 + 1);
                assert!(off <= 0.1, "{name} {seed}: a vertex at {at} is {off} pixels beside the line");
            }
            let LayerKind::Area(lake) = layer(scene, "lake") else { panic!("no area") };
            let tracer = Tracer::new(scene, session.view());
            // Corners are cut within a pixel; the middles of edges that are longer than that are not.
            let edges = lake
                .features
                .iter()
                .flat_map(|f| &f.rings)
                .flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
            let apart = |a: DVec2, b: DVec2| match &projected(&session, [a, b].into_iter(), 0.0)[..] {
                [(_, a), (_, b)] => a.distance(*b),
                _ => 0.0,
            };
            let middles = edges.filter(|(a, b)| apart(**a, **b) > 3.0).map(|(a, b)| 0.5 * (*a + *b));
            for (p, at) in projected(&session, middles, 0.0) {
                // Both sides of the border must be seen, or it ends at a ridge.
                let near = |d: DVec2| {
                    tracer
                        .first_hit(at + d)
                        .is_some_and(|hit| hit.point.distance(p) < 0.01 * session.view().pinhole().eye.distance(p))
                };
                if ![DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y].into_iter().all(near) {
                    continue;
                }
                let off = off(at, document.paths.iter().filter(|path| path.class == "area"));
                worst[1] = (worst[1].0.max(off), worst[1].1 + 1);
                assert!(off <= 0.1, "{name} {seed}: a border of the lake at {at} is {off} pixels beside its border");
            }
        }
    }
    assert!(worst[0].1 > 200 && worst[1].1 > 10, "{worst:?}");
}

#[test]
fn the_hidden_length_is_that_of_measure() {
    let mut off = Vec::new();
    for (name, stages) in &TECHNIQUES[..2] {
        // Gaps and specks below 4 pixels are closed: the finer the picture, the less.
        let session = session(stages, 0, [2560, 1600]);
        let mut options = PictureOptions { vectors: VectorContent::Alone, ..PictureOptions::default() };
        options.quality.samples = 1;
        let picture = session.render(&options).expect("a picture");
        let document = read(&picture.to_svg().expect("written").expect("vectors"));
        let [visible, hidden] = document
            .lengths
            .iter()
            .filter(|(layer, _)| layer == "trail")
            .fold([0.0; 2], |[v, h], (_, [a, b])| [v + a, h + b]);
        let report = session.measure(&MeasureOptions::default()).expect("measured");
        let measured = report.measures.lines.as_ref().expect("lines").bent.sight.share.expect("in view");
        let written = visible / (visible + hidden);
        off.push((*name, written, measured));
    }
    assert!(off.iter().all(|(_, written, measured)| (written - measured).abs() < 0.005), "{off:?}");
}

#[test]
fn layers_names_and_page_are_found_by_other_readers() {
    let folder = tempfile::tempdir().expect("a folder");
    let point = |name: &str, x: f64, y: f64| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"name\":\"{name}\"}},\"geometry\":{{\"type\":\"Point\",\"coordinates\":[{x},{y}]}}}}"
        )
    };
    let names = ["Großer <Piz> & Söhne", "Ärger", "Ψηλό"];
    let at = [[2000.0, -1000.0], [-1000.0, 2000.0], [1000.0, 500.0]];
    let features: Vec<String> = names.iter().zip(at).map(|(name, [x, y])| point(name, x, y)).collect();
    let text = format!("{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", features.join(","));
    std::fs::write(folder.path().join("huts.geojson"), text).expect("written");
    let text = format!(
        "format = 1\ncrs = 'local'\ntitle = 'A & B'\n{LAYERS}[[layer]]\nid = 'huts \"&\"'\nkind = 'point'\nsource = 'huts.geojson'\n\
         style = {{ labels = true, symbol = 'pin', hidden = 'show' }}\n[overlay]\ngrid = 2000.0\n\
         [camera]\neye = [7971.7, -7336.9, 5780.0]\nlook_at = [-952.3, 1587.0, 400.0]\nfov_y_deg = 51\nimage = [640, 400]\n{SPLINE}"
    );
    let source = parse(&folder.path().join("s.toml"), &text).expect("scene");
    let session = Session::from_document(source, &OpenOptions::default()).expect("session");
    let doc = PrintDoc { paper: Some("A6".into()), dpi: None, margin_mm: Some(5.0) };
    let sheet = Sheet::of(&doc, Some([640, 441]), [640, 441]).expect("fits").expect("a sheet");
    let session = session.resized(sheet.pixels(), &belvedere::scene::Progress::silent()).expect("resized");
    let options = PictureOptions { vectors: VectorContent::OverRaster, ..PictureOptions::default() }.on(sheet);
    let picture = session.render(&options).expect("a picture");
    let text = picture.to_svg().expect("written").expect("vectors");
    let document = read(&text);
    assert_eq!(document.layers, ["surfaces", "grid", "lake", "trail", "huts \"&\"", "names", "mark"]);
    assert_eq!((document.images, &document.size), (1, &["148mm".to_owned(), "105mm".to_owned()]));
    let [x, y, w, h] = document.view_box[..] else { panic!("{:?}", document.view_box) };
    assert!((w / h - 148.0 / 105.0).abs() < 0.002 && x < 0.0 && (x - y).abs() < 1e-9, "{:?}", document.view_box);
    assert!(x + w > 640.0 && (w - 2.0 * -x - 640.0).abs() < 0.02);
    for name in names {
        assert!(document.texts.iter().any(|text| text == name), "{name} in {:?}", document.texts);
    }
    let mark = picture.sidecar.overlay.mark_words.as_deref().expect("a mark");
    assert!(
        document.texts.iter().any(|text| text == mark)
            && document.texts.iter().any(|text| text.starts_with("E ") || text.contains("km"))
    );
    assert!(text.contains("<title>A &amp; B</title>") && text.contains("bent view (spline"));
    // Without the raster a file is small, and areas have their colour.
    let alone = svg(&session, VectorContent::Alone);
    assert!(alone.len() < 200_000 && alone.len() < text.len(), "{} and {} bytes", alone.len(), text.len());
    assert_eq!(read(&alone).images, 0);
    assert!(alone.contains("class=\"area\" fill=\"#4a85a8\"") && text.contains("class=\"area\" fill=\"none\""));
}
