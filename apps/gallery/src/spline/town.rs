//! A town at levels of abstraction.

use super::bent::{IN_THREE, TILE, document, panel};
use crate::easel::{Easel, straight};
use crate::figure_set::Figure;
use anyhow::Result;
use belvedere::Session;
use belvedere::core::{DVec3, Pinhole, View};
use belvedere::scene_file::{LayerDoc, parse};
use std::path::Path;

/// Reach of ambient occlusion, metres: that of our specification, section 7.
const REACH_M: f64 = 40.0;
const SCENE: &str = include_str!("../../../../scenes/town_sections.toml");

/// The town of the scenes folder, seen from a viewing angle; straight.
pub(super) fn seen(easel: &Easel<'_>, phi_deg: f64, distance: f64) -> Result<Session> {
    let session = easel.open(SCENE, TILE)?;
    from(&session, phi_deg, distance)
}

/// The same town with ambient occlusion.
pub(super) fn shaded(easel: &Easel<'_>, phi_deg: f64, distance: f64) -> Result<Session> {
    let mut document = parse(Path::new("figure.toml"), SCENE)?.document;
    for layer in &mut document.layer {
        if let LayerDoc::City(city) = layer {
            city.style.ambient_occlusion = Some(REACH_M);
        }
    }
    let text = belvedere::output::document_toml(&document)?;
    from(&easel.open(&text, TILE)?, phi_deg, distance)
}

/// The session seen from a viewing angle.
pub(super) fn from(session: &Session, phi_deg: f64, distance: f64) -> Result<Session> {
    let pinhole = session.view().pinhole();
    let (sin, cos) = phi_deg.to_radians().sin_cos();
    let (eye, up) = (distance * DVec3::new(-0.14 * cos, -0.99 * cos, sin), DVec3::new(0.14 * sin, 0.99 * sin, cos));
    let camera = Pinhole::look_at(eye, DVec3::ZERO, up, pinhole.projection, pinhole.image, 1.0, None)?;
    Ok(session.clone().with_view(View::straight(camera)))
}

/// Straight, progressive, degressive, and both hybrids.
pub(super) fn views(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(SCENE, TILE)?;
    let mut panels = vec![easel.panel(
        &straight(&from(&session, 35.0, 900.0)?),
        "Straight",
        "an ordinary perspective, viewing angle 35°".into(),
    )?];
    for (name, title) in [
        ("progressive", "Progressive: steep in front, flat behind"),
        ("degressive", "Degressive: flat in front, steep behind"),
        ("flat-steep-flat", "Hybrid: a map between"),
        ("steep-flat-steep", "Hybrid: a close view between two maps"),
    ] {
        let document = document(name, &IN_THREE)?;
        let phi = document.presets[0].phi;
        panels.push(panel(easel, &from(&session, phi, 900.0)?, &document, 0.0, title)?);
    }
    Ok(Figure { panels, columns: 3, ..Figure::default() })
}
