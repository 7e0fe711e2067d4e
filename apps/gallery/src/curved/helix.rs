//! Two double helices, one behind the other.

use crate::easel::{Easel, bent, straight, turns};
use crate::figure_set::Figure;
use crate::sheet::Panel;
use anyhow::{Context, Result};
use belvedere::Session;
use belvedere::construct::{self, MeasureOptions};
use belvedere::core::map::curved_rays::{Model, TurnSpec};
use belvedere::core::{Aabb, DVec2, DVec3};
use belvedere::cpu::canvas::Canvas;
use belvedere::scene::{Color, LayerKind, Progress};

const SCENE: &str = include_str!("../../../../scenes/dna.toml");
const GOLD: Color = Color::rgb(214, 138, 0);
/// Room between the box and the atoms, angstrom, and points along an edge.
const MARGIN: f64 = 1.0;
const POINTS: u32 = 24;

/// Box around the atoms that must be seen.
fn wanted_box(session: &Session) -> Result<Aabb> {
    for layer in &session.scene().layers {
        let LayerKind::Molecule(layer) = &layer.kind else { continue };
        let Some(wanted) = &layer.wanted else { continue };
        let (mask, mesh) = (wanted.mask(&layer.molecule), &layer.surface.mesh);
        let shown = |t: usize| mesh.part(t).is_some_and(|atom| mask.get(atom as usize) == Some(&true));
        let corners = mesh.triangles().iter().enumerate().filter(|(t, _)| shown(*t)).flat_map(|(_, c)| *c);
        let around = Aabb::of(corners.map(|v| mesh.vertex(v)));
        return Ok(Aabb { min: around.min - MARGIN, max: around.max + MARGIN });
    }
    None.context("no molecule must be seen")
}

/// Share of the atoms that must be seen.
fn share(session: &Session) -> Result<f64> {
    let options = MeasureOptions::default();
    let measures = construct::measure(session.scene(), session.view(), None, &options, &Progress::silent())?;
    measures.surfaces.and_then(|s| s.bent.sight.share).context("the molecule lies outside the picture")
}

/// A picture with a box drawn over it, edges bent as the rays bend them.
fn boxed(easel: &Easel<'_>, session: &Session, around: &Aabb, title: &str) -> Result<(Panel, f64)> {
    let mut frame = easel.draw(session)?;
    let mut canvas = Canvas::new(&mut frame.color, frame.width);
    let corners = around.corners();
    for (a, b) in (0..8usize).flat_map(|a| [1, 2, 4].map(|bit| (a, a | bit))).filter(|(a, b)| a != b) {
        let at = |k: u32| corners[a].lerp(corners[b], f64::from(k) / f64::from(POINTS));
        let points: Vec<DVec2> =
            (0..=POINTS).filter_map(|k| session.view().project(at(k)).ok()).map(|p| p.pixel).collect();
        canvas.line(&points, 2.0, GOLD);
    }
    let seen = share(session)?;
    let note = format!("{:.0} % of the marked atoms' surface is seen", 100.0 * seen);
    Ok((Panel { title: title.into(), note, frame }, seen))
}

/// Before and after.
pub(super) fn behind(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(SCENE, [640, 480])?;
    let around = wanted_box(&session)?;
    let (before, seen_before) = boxed(easel, &straight(&session), &around, "Straight rays")?;
    let (after, seen_after) = boxed(easel, &session, &around, "Rays that turn behind the front helix")?;
    Ok(Figure { panels: vec![before, after], columns: 2, seen: vec![seen_before, seen_after] })
}

/// No bend, beside, above, and both.
pub(super) fn directions(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(SCENE, [560, 420])?;
    let [turn] = turns(&session)?[..] else { return None.context("the scene has not one turn") };
    let eye = session.view().pinhole().eye;
    let (mut panels, mut seen) = (Vec::new(), Vec::new());
    for (title, [x, y, z]) in [
        ("No bend", [0.0; 3]),
        ("Lateral", [90.0, 26.0, 0.0]),
        ("Vertical", [0.0, 26.0, 90.0]),
        ("Diagonal", [64.0, 26.0, 64.0]),
    ] {
        let spec = TurnSpec { viewpoint: eye + DVec3::new(x, y, z), ..turn };
        let turned = if x + z > 0.0 { bent(&session, Model::Modified, &[spec])? } else { straight(&session) };
        let share = share(&turned)?;
        let note = format!("second viewpoint {x} angstrom to the right, {z} up; {:.0} % seen", 100.0 * share);
        panels.push(easel.panel(&turned, title, note)?);
        seen.push(share);
    }
    Ok(Figure { panels, columns: 2, seen })
}
