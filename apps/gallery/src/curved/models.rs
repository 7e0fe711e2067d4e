//! Modified rays beside, and drawn over, original rays.

use super::street::TILE;
use super::town::{CROSSING, town, turn};
use crate::easel::{Easel, above, bent, with_lines};
use crate::figure_set::{Facts, Figure};
use crate::sheet::Panel;
use anyhow::Result;
use belvedere::Session;
use belvedere::core::map::curved_rays::Model;
use belvedere::core::{DVec2, DVec3};
use belvedere::scene::{Color, Frame};

/// Factor by which differences of colours are amplified.
const STRONGER: u8 = 20;
/// Rays drawn of each model, and points of each in its transition.
const RAYS: u32 = 9;
const POINTS: u32 = 60;
const MODIFIED: Color = Color::rgb(0, 96, 168);
const ORIGINAL: Color = Color::rgb(250, 180, 60);

/// Both pictures of the turn to the left, their difference, and the rays over each other.
pub(super) fn models(easel: &Easel<'_>) -> Result<Figure> {
    let town = town(easel, TILE)?;
    let turn = turn(CROSSING, -1.0);
    let (modified, original) = (bent(&town, Model::Modified, &[turn])?, bent(&town, Model::Original, &[turn])?);
    let (a, b) = (easel.draw(&modified)?, easel.draw(&original)?);
    let colors = a.color.iter().zip(&b.color).map(|(a, b)| difference(*a, *b)).collect();
    let difference = Frame { color: colors, ..a.clone() };
    let panel = |title: &str, note: String, frame| Panel { title: title.into(), note, frame };
    let [most, mean] = apart(&modified, &original);
    let (over, mut facts) = rays_over_each_other(easel, &town, [&modified, &original])?;
    facts.insert("places, mean, pixels", mean);
    facts.insert("places, most, pixels", most);
    let panels = vec![
        panel("Modified rays", "conic arcs: projection in closed form".into(), a),
        panel("Original rays", "parabolas".into(), b),
        panel(
            "Difference",
            format!("{STRONGER} times as strong; places move by {mean:.1} pixels, {most:.1} at most"),
            difference,
        ),
        over,
    ];
    Ok(Figure { panels, columns: 2, facts, ..Figure::default() })
}

/// From above, around the transition: original rays as broad lines, modified ones as thin lines over them.
fn rays_over_each_other(easel: &Easel<'_>, town: &Session, both: [&Session; 2]) -> Result<(Panel, Facts)> {
    let [modified, original] = both.map(arcs);
    let all = modified.iter().flatten();
    let (low, high) = all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let off =
        modified.iter().zip(&original).flat_map(|(m, o)| m.iter().map(|p| to_polyline(*p, o))).fold(0.0, f64::max);
    let long = modified.iter().map(|m| m.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>()).fold(0.0, f64::max);
    let size = 1.2 * (high - low).truncate().max_element();
    let lines = [("original rays", original, ORIGINAL, 7.0), ("modified rays", modified, MODIFIED, 2.0)];
    let session = above(&with_lines(town, lines), 0.5 * (low + high), size)?;
    let note = format!("original rays broad, modified ones thin: at most {off:.2} m apart in arcs of {long:.0} m");
    let panel = easel.panel(&session, "Modified over original rays", note)?;
    let shown = |color: Color| {
        let near = |c: &&[u8; 3]| [color.r, color.g, color.b].iter().zip(**c).all(|(a, b)| a.abs_diff(b) < 16);
        panel.frame.color.iter().filter(near).count() as f64
    };
    let facts = [
        ("rays, most apart, m", off),
        ("arcs, longest, m", long),
        ("pixels of modified rays", shown(MODIFIED)),
        ("pixels of original rays", shown(ORIGINAL)),
    ];
    Ok((panel, facts.into()))
}

/// The bent pieces of rays along the horizon of the picture.
fn arcs(session: &Session) -> Vec<Vec<DVec3>> {
    let [w, h] = session.view().pinhole().image.map(f64::from);
    let arc = |i: u32| {
        let ray = session.view().ray(DVec2::new(w * (f64::from(i) + 0.5) / f64::from(RAYS), 0.5 * h));
        let [from, to] = ray.pieces().ok()?.get(1)?.depth;
        let at = |k: u32| ray.at(from + (to - from) * f64::from(k) / f64::from(POINTS)).ok().map(|p| p.point);
        (0..=POINTS).map(at).collect::<Option<Vec<_>>>()
    };
    (0..RAYS).filter_map(arc).collect()
}

/// Distance of a point from a polyline.
fn to_polyline(p: DVec3, line: &[DVec3]) -> f64 {
    let off = |w: &[DVec3]| {
        let along = w[1] - w[0];
        let share = (p - w[0]).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
        p.distance(w[0] + share.clamp(0.0, 1.0) * along)
    };
    line.windows(2).map(off).fold(f64::INFINITY, f64::min)
}

/// Amplified difference of two colours on white: white where they are the same.
fn difference(a: [u8; 3], b: [u8; 3]) -> [u8; 3] {
    std::array::from_fn(|k| 255 - a[k].abs_diff(b[k]).saturating_mul(STRONGER))
}

/// Largest and mean distance, pixels, between the images of one point in two pictures.
fn apart(a: &Session, b: &Session) -> [f64; 2] {
    let [w, h] = a.view().pinhole().image.map(f64::from);
    let (mut most, mut sum, mut count) = (0.0f64, 0.0, 0.0);
    for i in 0..20u32 * 20 * 20 {
        let share = |k: u32| (f64::from(k % 20) + 0.5) / 20.0;
        let pixel = DVec2::new(w * share(i), h * share(i / 20));
        let place = a.view().ray(pixel).at(40.0 + 140.0 * share(i / 400));
        let Some(image) = place.ok().and_then(|p| b.view().project(p.point).ok()) else { continue };
        let off = image.pixel.distance(pixel);
        (most, sum, count) = (most.max(off), sum + off, count + 1.0);
    }
    [most, sum / f64::max(count, 1.0)]
}
