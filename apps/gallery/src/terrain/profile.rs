//! The ground along the line of sight that is hidden most, before and after.

use super::area::Area;
use crate::chart::{self, Chart, Corner, Curve, Look};
use crate::sheet::Pixels;
use anyhow::Result;
use belvedere::core::DVec2;
use belvedere::disocclusion::{ReferencePoint, Solved};

/// Places along the line, besides its ends.
const PLACES: usize = 1200;

/// The chart, or `None` if nothing is in view.
pub(crate) fn profile(area: &Area, solved: &Solved) -> Result<Option<Pixels>> {
    let Some(point) = worst(area) else { return Ok(None) };
    let field = &area.field;
    let eye = area.eye();
    let foot = field.scene_from_grid(point.grid);
    let away = foot.distance(eye.truncate());
    let (mut before, mut after) = (Vec::new(), Vec::new());
    for i in 0..=PLACES {
        let t = i as f64 / PLACES as f64;
        let xy: DVec2 = eye.truncate().lerp(foot, t);
        let Some(ground) = field.surface_at(field.grid_from_scene(xy)) else { continue };
        let km = t * away / 1000.0;
        before.push((km, ground));
        after.push((km, ground + solved.stage.delta_at(xy.extend(0.0))));
    }
    let seen_from = |ground: f64| vec![(0.0, eye.z), (away / 1000.0, ground + point.lift)];
    let moved = point.ground + solved.stage.delta_at(foot.extend(0.0));
    let curves = vec![
        Curve::new("ground before", before, [176, 168, 156], Look::Ground),
        Curve::new("ground after", after, [120, 160, 108], Look::Ground),
        Curve::new("line of sight before", seen_from(point.ground), [200, 70, 60], Look::Dashes),
        Curve::new("line of sight after", seen_from(moved), [30, 90, 170], Look::Line),
        Curve::new("eye and point", seen_from(moved), [30, 40, 60], Look::Dots),
    ];
    let chart = Chart {
        title: "The line of sight that is hidden most, before and after (mode qp)".into(),
        x: "distance from the eye, km".into(),
        y: "height, m".into(),
        names: Corner::Right,
        curves,
    };
    Ok(Some(chart::draw(&chart)?))
}

/// The point in view over whose line of sight the ground rises most.
fn worst(area: &Area) -> Option<&ReferencePoint> {
    let (field, eye) = (&area.field, area.eye());
    let to = field.grid_from_scene(eye.truncate());
    let excess = |p: &ReferencePoint| {
        let samples = belvedere::sight::sight_samples(field, p.grid, to, true);
        let guard = belvedere::sight::guard_tau(p.grid, to, area.settings.guard);
        let from = p.ground + p.lift;
        let over =
            samples.iter().filter(|s| s.tau > guard).map(|s| s.of(field.heights()) - (from + s.tau * (eye.z - from)));
        over.fold(f64::NEG_INFINITY, f64::max)
    };
    let judged: Vec<(f64, &ReferencePoint)> = area.points.iter().map(|p| (excess(p), p)).collect();
    judged.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, p)| p)
}
