//! The viewpoints between the first and the second one, from which bent rays seem to come.

use super::town::{AVENUE, CROSSING, town, turn};
use crate::easel::{Easel, above, bent, with_lines, with_points};
use crate::figure_set::{Facts, Figure};
use anyhow::{Context, Result};
use belvedere::core::map::curved_rays::{Model, Turn};
use belvedere::core::{DVec2, DVec3, View};
use belvedere::scene::Color;

/// Points of a ray that are joined with their viewpoints.
const PLACES: u32 = 7;
/// Rays drawn, extent of the ground that is shown, metres, and the crossing.
const RAYS: u32 = 9;
const SHOWN: f64 = 135.0;
const CROSSING_AT: DVec3 = DVec3::new(AVENUE, CROSSING, 12.0);
const LINE: Color = Color::rgb(110, 60, 160);
const RAY: Color = Color::rgb(230, 150, 0);
const END: Color = Color::rgb(0, 96, 168);

/// The turn to the left from above: points of one of its rays, each joined with the intermediate viewpoint that sees it.
pub(super) fn viewpoints(easel: &Easel<'_>) -> Result<Figure> {
    let town = town(easel, [640, 640])?;
    let session = bent(&town, Model::Modified, &[turn(CROSSING, -1.0)])?;
    let view = session.view();
    let rays = view.curved_rays().context("the street's rays are bent")?;
    let turn = rays.turns().first().context("the street's rays turn once")?;
    let [w, h] = view.pinhole().image.map(f64::from);
    let (mut lines, mut shares) = (Vec::new(), Vec::new());
    let baseline = turn.viewpoint - turn.viewpoint_before;
    for k in 1..=PLACES {
        let s = f64::from(k) / f64::from(PLACES + 1);
        let between = turn.intermediate_viewpoint(s).context("modified rays have viewpoints in between")?;
        let place = place_at(view, turn, DVec2::new(0.5 * w, 0.5 * h), s).context("the ray bends")?;
        shares.push((between - turn.viewpoint_before).dot(baseline) / baseline.length_squared());
        lines.push(vec![between, place]);
    }
    let rising = shares.windows(2).all(|p| p[0] < p[1]);
    let inside = shares.iter().all(|s| *s > 0.0 && *s < 1.0);
    let facts = Facts::from([
        ("viewpoints between", if rising && inside { shares.len() as f64 } else { 0.0 }),
        ("first share of the way", shares[0]),
        ("last share of the way", shares[shares.len() - 1]),
    ]);
    let ends = [("eye (C0)", turn.viewpoint_before), ("second viewpoint (C1)", turn.viewpoint)];
    let dots: Vec<(&str, DVec3)> = lines.iter().map(|l| ("", l[0])).collect();
    let middle = CROSSING_AT.lerp(turn.viewpoint_before.midpoint(turn.viewpoint), 0.5);
    let baseline = vec![vec![turn.viewpoint_before, turn.viewpoint]];
    let marked = with_lines(
        &session,
        [("rays", fan(view), RAY, 1.2), ("baseline", baseline, LINE, 1.2), ("lines of sight", lines, LINE, 1.6)],
    );
    let marked = with_points(&with_points(&marked, &dots, LINE), &ends, END);
    let note = format!("{PLACES} places of the middle ray, joined with where they are seen from");
    let panel = easel.panel(&above(&marked, middle, SHOWN)?, "From above: bent rays and their viewpoints", note)?;
    Ok(Figure { panels: vec![panel], columns: 1, facts, ..Figure::default() })
}

/// Rays along the horizon of the picture, to just past their bend.
fn fan(view: &View) -> Vec<Vec<DVec3>> {
    let [w, h] = view.pinhole().image.map(f64::from);
    let points = |i: u32| {
        let ray = view.ray(DVec2::new(w * (f64::from(i) + 0.5) / f64::from(RAYS), 0.5 * h));
        let end = ray.pieces().ok()?.get(1)?.depth[1];
        Some(ray.samples(1e-3 * end, 1.2 * end, 120).map_while(Result::ok).map(|p| p.point).collect())
    };
    (0..RAYS).filter_map(points).collect()
}

/// The point at which the ray of a pixel passes the plane of the pencil at `s` (bisection), see [`Turn::intermediate_viewpoint`].
fn place_at(view: &View, turn: &Turn, pixel: DVec2, s: f64) -> Option<DVec3> {
    let ray = view.ray(pixel);
    let [mut low, mut high] = ray.pieces().ok()?.get(1)?.depth;
    let at = |depth: f64| ray.at(depth).ok().map(|p| p.point);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let p = at(middle)?;
        let (a, b) = (turn.a.at(p), turn.b.at(p));
        if a / (a + b) < s { low = middle } else { high = middle }
    }
    at(low)
}
