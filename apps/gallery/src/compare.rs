//! `figures compare`: one hidden target shown by every technique of the system.

use crate::easel::{Easel, bent, pixels_of, straight};
use crate::html::{self, escape};
use crate::sheet::{self, Panel};
use anyhow::{Context, Result};
use belvedere::core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere::core::{DVec2, DVec3, View};
use belvedere::output::{self, pretty};
use belvedere::scene::{BoxShape, Frame};
use belvedere::{OpenOptions, Session};
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

const SCENE: &str = include_str!("../../../scenes/church_hidden.toml");
/// Line of the scene file that names the fallback for the target.
const FALLBACK: &str = "fallback = [\"towers:cutaway\"]";
const TARGET: &str = "church";
const TILE: [u32; 2] = [640, 480];
/// The turn: depths of its planes and height of the second viewpoint over the eye, metres.
const PLANES: [f64; 3] = [520.0, 620.0, 690.0];
const RISE: f64 = 560.0;
/// Frames drawn of each technique; the fastest counts.
const FRAMES: usize = 3;
/// Steps along the projected edge of a house, and the shortest edge that is measured, pixels.
const POINTS: u32 = 8;
const SHORTEST_PX: f64 = 6.0;

/// Measured values of one technique.
#[derive(Debug, Clone, Serialize)]
struct Row {
    means: String,
    /// Share of the target's pixels, as drawn without occluders, that show it in this picture, 0..=1.
    visible: f64,
    /// Largest distance of the image of a straight edge of a house from the chord between its ends, as a share of the chord's length.
    bent_edges: f64,
    /// Share of the pixels whose colour is not that of the straight picture.
    changed: f64,
    /// Wall time of the fastest frame, milliseconds.
    frame_ms: f64,
    says: &'static str,
}

/// Draws the comparison into `folder`, which is made if need be: `compare.png`, `compare.json` and `compare.html`. Returns the files.
///
/// * `scale`: factor of the width and height of the pictures, in (0, 1].
///
/// # Errors
/// A file that exists if `overwrite` is false; those of drawing a scene.
pub fn figures(folder: &Path, options: &OpenOptions, scale: f64, overwrite: bool) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let paths = ["compare.png", "compare.json", "compare.html"].map(|name| folder.join(name));
    paths.iter().try_for_each(|path| output::check(path, &[], overwrite))?;
    let easel = Easel::new(options, scale);
    let sessions = sessions(&easel)?;
    let reference = easel.draw(&sessions[0].1)?;
    let (mut panels, mut rows) = (Vec::new(), Vec::new());
    for (k, (means, session, says)) in sessions.iter().enumerate() {
        options.progress.tick("comparison", k as f64 / sessions.len() as f64)?;
        let mut frame_ms = f64::INFINITY;
        let mut frame = Frame::default();
        for _ in 0..FRAMES {
            let start = Instant::now();
            frame = easel.draw(session)?;
            frame_ms = frame_ms.min(1e3 * start.elapsed().as_secs_f64());
        }
        let alone = easel.draw(&alone(session))?;
        let whole = pixels_of(&alone, session, TARGET).max(1);
        let visible = pixels_of(&frame, session, TARGET) as f64 / whole as f64;
        let row = Row {
            means: (*means).into(),
            visible: visible.min(1.0),
            bent_edges: bent_edges(session),
            changed: changed(&frame, &reference),
            frame_ms,
            says,
        };
        let note = format!(
            "{:.0} % of the church is seen, edges bend by {:.1} %, {frame_ms:.0} ms",
            100.0 * row.visible,
            100.0 * row.bent_edges
        );
        panels.push(Panel { title: (*means).into(), note, frame });
        rows.push(row);
    }
    sheet::write(&paths[0], sheet::sheet(&panels, 3), NOTE, overwrite)?;
    output::write_text(&paths[1], &pretty(&rows)?, overwrite)?;
    output::write_text(&paths[2], &page(&rows), overwrite)?;
    Ok(paths.into())
}

/// Comment in the metadata of the picture.
const NOTE: &str = "a hidden target by several means; not to scale, not for navigation";

/// Name of each technique, its session, and a sentence on its drawbacks.
fn sessions(easel: &Easel<'_>) -> Result<Vec<(&'static str, Session, &'static str)>> {
    anyhow::ensure!(SCENE.contains(FALLBACK), "the scene of the church does not say {FALLBACK}");
    let fallback = |kind: &str| easel.open(&SCENE.replace(FALLBACK, &format!("fallback = [\"{kind}\"]")), TILE);
    let plain = easel.open(SCENE.split("[constructor]").next().unwrap_or(SCENE), TILE)?;
    let camera = plain.view().pinhole().clone();
    let at = |depth: f64| camera.eye + depth * camera.forward;
    let [t0, t1, t2] = PLANES.map(at);
    let turn = TurnSpec {
        viewpoint: camera.eye + RISE * DVec3::Z,
        t0,
        t1,
        t2,
        pencil: Pencil::Parallel { normal: -camera.forward },
        m: Sharpness::Bend,
    };
    Ok(vec![
        ("Straight", straight(&plain), "the houses hide the church"),
        ("Transparency", fallback("transparency")?, "depth is hard to read through layers"),
        ("Cutaway", fallback("cutaway")?, "what stood before the church is gone"),
        ("Explosion", fallback("explosion")?, "houses stand where they are not"),
        ("Rays with a kink (C0)", bent(&plain, Model::C0, &[turn])?, "what crosses the kink breaks"),
        ("Curved rays (C1)", bent(&plain, Model::Modified, &[turn])?, "what lies behind is seen from above"),
    ])
}

/// The session with the boxes removed, in the same view.
fn alone(session: &Session) -> Session {
    let mut scene = session.scene().clone();
    for layer in &mut scene.layers {
        if let Some(boxes) = layer.kind.boxes_mut() {
            boxes.boxes.clear();
        }
    }
    Session::from_parts(scene, session.view().clone()).with_light(*session.light())
}

/// See [`Row::bent_edges`].
fn bent_edges(session: &Session) -> f64 {
    let boxes = session.scene().layers.iter().filter_map(|l| l.kind.boxes().map(|layer| &layer.boxes));
    boxes.flatten().map(|shape| bent_edges_of(shape, session.view())).fold(0.0, f64::max)
}

pub(crate) fn bent_edges_of(shape: &BoxShape, view: &View) -> f64 {
    let corners = shape.corners();
    let edges = (0..8usize).flat_map(|a| [1, 2, 4].map(|bit| (a, a | bit))).filter(|(a, b)| a != b);
    edges.filter_map(|(a, b)| bow(corners[a], corners[b], view)).fold(0.0, f64::max)
}

/// Largest distance of the image of a straight edge from its chord, as a share of the chord's length; `None` for a short edge, or one not
/// wholly in the picture.
fn bow(a: DVec3, b: DVec3, view: &View) -> Option<f64> {
    let image = |k: u32| {
        let place = a.lerp(b, f64::from(k) / f64::from(POINTS));
        view.project(place).ok().map(|i| i.pixel).filter(|p| view.pinhole().contains(*p))
    };
    let images: Vec<DVec2> = (0..=POINTS).map(image).collect::<Option<_>>()?;
    let way = images[POINTS as usize] - images[0];
    let length = way.length();
    (length >= SHORTEST_PX)
        .then(|| images.iter().map(|p| (*p - images[0]).perp_dot(way).abs() / (length * length)).fold(0.0, f64::max))
}

/// See [`Row::changed`].
fn changed(frame: &Frame, reference: &Frame) -> f64 {
    let differs = |(a, b): &(&[u8; 3], &[u8; 3])| a.iter().zip(b.iter()).any(|(a, b)| a.abs_diff(*b) > 8);
    let count = frame.color.iter().zip(&reference.color).filter(differs).count();
    count as f64 / frame.color.len().max(1) as f64
}

fn page(rows: &[Row]) -> String {
    let mut table = String::new();
    for r in rows {
        let _ = writeln!(
            table,
            "<tr><td>{}</td><td>{:.0} %</td><td>{:.1} %</td><td>{:.0} %</td><td>{:.0} ms</td><td>{}</td></tr>",
            escape(&r.means),
            100.0 * r.visible,
            100.0 * r.bent_edges,
            100.0 * r.changed,
            r.frame_ms,
            escape(r.says)
        );
    }
    let body = format!(
        "<h1>One church, six pictures</h1>\n<p>Houses hide a church. Each picture shows it by other means from the same camera.</p>\n\
         <figure>{}</figure>\n<table>\n<tr><th>means</th><th>church seen</th><th>edges of houses bend by at most</th>\
         <th>picture changed</th><th>time of a frame</th><th>price</th></tr>\n{table}</table>\n\
         <p class=\"small\">belvedere {} · <a href=\"compare.json\">record</a></p>\n",
        html::picture("compare.png", "The church by six means"),
        belvedere::VERSION
    );
    html::page("Belvedere: one target by several means", html::TABLES, &body)
}
