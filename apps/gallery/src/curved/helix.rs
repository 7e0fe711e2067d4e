//! Two double helices, one behind the other.

use crate::easel::{Easel, Shown, bent, straight, turns};
use crate::figure_set::{Facts, Figure};
use crate::sheet::Panel;
use anyhow::{Context, Result};
use belvedere::Session;
use belvedere::composite::canvas::Canvas;
use belvedere::core::map::curved_rays::{Model, TurnSpec};
use belvedere::core::{Aabb, DVec2, DVec3};
use belvedere::scene::Color;

const SCENE: &str = include_str!("../../../../scenes/dna.toml");
/// Layer of the required feature.
const BEHIND: &str = "behind";
const GOLD: Color = Color::rgb(214, 138, 0);
/// Margin between the box and the atoms, angstrom, and steps along an edge.
const MARGIN: f64 = 1.0;
const POINTS: u32 = 24;

/// Corners of the surface of the atoms that must be seen.
fn wanted_corners(session: &Session) -> Result<Vec<DVec3>> {
    for layer in &session.scene().layers {
        let Some(layer) = layer.kind.molecule() else { continue };
        let Some(wanted) = &layer.wanted else { continue };
        let (mask, mesh) = (layer.mask_of(wanted), &layer.surface.mesh);
        let shown = |t: usize| mesh.part(t).is_some_and(|atom| mask.get(atom as usize) == Some(&true));
        let corners = mesh.triangles().iter().enumerate().filter(|(t, _)| shown(*t)).flat_map(|(_, c)| *c);
        return Ok(corners.map(|v| mesh.vertex(v)).collect());
    }
    None.context("no molecule must be seen")
}

/// Box around the atoms that must be seen.
fn wanted_box(session: &Session) -> Result<Aabb> {
    let around = Aabb::of(wanted_corners(session)?);
    Ok(Aabb { min: around.min - MARGIN, max: around.max + MARGIN })
}

/// A picture with a box drawn over it, edges bent as the rays bend them.
fn boxed(easel: &Easel<'_>, session: &Session, around: &Aabb, title: &str) -> Result<(Panel, f64, f64)> {
    let Shown { share: seen, mut frame } = easel.shown(session, BEHIND)?;
    let mut canvas = Canvas::new(&mut frame.color, frame.width);
    let corners = around.corners();
    let mut outline = Vec::new();
    for (a, b) in (0..8usize).flat_map(|a| [1, 2, 4].map(|bit| (a, a | bit))).filter(|(a, b)| a != b) {
        let at = |k: u32| corners[a].lerp(corners[b], f64::from(k) / f64::from(POINTS));
        let points: Vec<DVec2> =
            (0..=POINTS).filter_map(|k| session.view().project(at(k)).ok()).map(|p| p.pixel).collect();
        canvas.line(&points, 2.0, GOLD);
        outline.extend(points);
    }
    let note = format!("{:.0} % of the marked atoms' picture is seen", 100.0 * seen);
    Ok((Panel { title: title.into(), note, frame }, seen, inside(session, &hull(outline))?))
}

/// The convex hull, counterclockwise.
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut out: Vec<DVec2> = Vec::new();
    for _ in 0..2 {
        let from = out.len();
        for p in &points {
            while out.len() >= from + 2
                && (out[out.len() - 1] - out[out.len() - 2]).perp_dot(*p - out[out.len() - 2]) <= 0.0
            {
                out.pop();
            }
            out.push(*p);
        }
        out.pop();
        points.reverse();
    }
    out
}

/// Share of the corners of the marked atoms' surface whose image lies within the picture and within an outline.
fn inside(session: &Session, outline: &[DVec2]) -> Result<f64> {
    let view = session.view();
    let within = |p: DVec2| {
        (0..outline.len()).all(|i| (outline[(i + 1) % outline.len()] - outline[i]).perp_dot(p - outline[i]) >= 0.0)
    };
    let corners = wanted_corners(session)?;
    let good = corners
        .iter()
        .filter_map(|p| view.project(*p).ok())
        .filter(|i| view.pinhole().contains(i.pixel) && within(i.pixel));
    Ok(good.count() as f64 / corners.len().max(1) as f64)
}

/// Before and after.
pub(super) fn behind(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(SCENE, [640, 480])?;
    let around = wanted_box(&session)?;
    let (before, seen_before, _) = boxed(easel, &straight(&session), &around, "Straight rays")?;
    let (after, seen_after, inside) = boxed(easel, &session, &around, "Rays that turn behind the front helix")?;
    let facts = Facts::from([("marked atoms in their box", inside)]);
    Ok(Figure {
        panels: vec![before, after],
        columns: 2,
        seen: vec![seen_before, seen_after],
        facts,
        ..Figure::default()
    })
}

/// No bend, beside, above, and both.
pub(super) fn directions(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(SCENE, [560, 420])?;
    let [turn] = turns(&session)?[..] else { return None.context("the scene has not one turn") };
    let eye = session.view().pinhole().eye;
    let (mut panels, mut seen) = (Vec::new(), Vec::new());
    for (title, [x, y, z]) in [
        ("No bend", [0.0; 3]),
        ("Lateral", [104.0, 40.0, 0.0]),
        ("Vertical", [0.0, 40.0, 56.0]),
        ("Diagonal", [90.0, 40.0, 52.0]),
    ] {
        let spec = TurnSpec { viewpoint: eye + DVec3::new(x, y, z), ..turn };
        let turned = if x + z > 0.0 { bent(&session, Model::Modified, &[spec])? } else { straight(&session) };
        let Shown { share, frame } = easel.shown(&turned, BEHIND)?;
        let note = format!("second viewpoint {x} angstrom to the right, {z} up; {:.0} % seen", 100.0 * share);
        panels.push(Panel { title: title.into(), note, frame });
        seen.push(share);
    }
    Ok(Figure { panels, columns: 2, seen, ..Figure::default() })
}
