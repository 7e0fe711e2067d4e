//! The deformation curve with its control points, the reference plane and the pivot.

use super::rays;
use super::subject::{CURVE, DARK, PLANE, Subject, TAG, line, point};
use belvedere_core::map::spline::SplineBend;
use belvedere_core::{DVec2, DVec3, SpaceMap};
use belvedere_scene::{Color, Hidden, Overlay, OverlayFace, OverlayLine, Symbol};

/// Numbers of points of the curve, and of rungs of the bent plane.
const POINTS: usize = 120;
const RUNGS: usize = 13;

pub(super) fn draw(subject: &Subject<'_>, bend: &SplineBend, overlay: &mut Overlay, legend: &mut Vec<(Color, String)>) {
    let [right, heading, _] = bend.axes();
    let pivot = bend.pivot();
    let length = bend.curve().length() * bend.scale();
    // From the near end of the curve to its far end, with short straight extensions.
    let start = -bend.coordinates(pivot).l * bend.scale();
    let along = |share: f64| start + length * (1.2 * share - 0.1);
    let half = 0.22 * length.min(subject.extent);
    let bent = |z: f64, a: f64| bend.apply(pivot + z * heading + a * right).ok();
    let flat = |z: f64, a: f64| pivot + z * heading + a * right;
    let curve: Vec<DVec3> = (0..=POINTS).filter_map(|i| bent(along(i as f64 / POINTS as f64), 0.0)).collect();
    for side in [-half, half] {
        let rail = (0..=POINTS).filter_map(|i| bent(along(i as f64 / POINTS as f64), side)).collect();
        overlay.over.push(line(rail, CURVE.with_alpha(190), 1.2));
    }
    let mut before: Option<[DVec3; 2]> = None;
    for i in 0..RUNGS {
        let z = along(i as f64 / (RUNGS - 1) as f64);
        let (Some(a), Some(b)) = (bent(z, -half), bent(z, half)) else { continue };
        overlay.over.push(line(vec![a, b], CURVE.with_alpha(150), 1.0));
        if let Some([c, d]) = before {
            overlay.faces.push(OverlayFace { corners: vec![c, d, b, a], color: CURVE.with_alpha(34) });
        }
        before = Some([a, b]);
    }
    let (near, far) = (along(0.0), along(1.0));
    let plane = vec![flat(near, -half), flat(near, half), flat(far, half), flat(far, -half)];
    overlay.over.push(line([&plane[..], &plane[..1]].concat(), PLANE.with_alpha(200), 1.4));
    overlay.faces.push(OverlayFace { corners: plane, color: PLANE.with_alpha(40) });
    // The eye's straight rays, up to the displaced positions of their hits.
    for hit in rays::pixels(subject.view).into_iter().filter_map(|p| subject.tracer.first_hit(p)) {
        if let Ok(seen) = subject.view.displace(hit.point) {
            overlay.over.push(line(vec![subject.view.pinhole().eye, seen.point], CURVE.with_alpha(120), 1.0));
        }
    }
    overlay.over.push(OverlayLine { hidden: Hidden::Show, ..line(curve, CURVE, 3.0) });
    let controls = controls(bend);
    overlay.over.push(OverlayLine { hidden: Hidden::Show, ..line(controls.clone(), DARK.with_alpha(150), 1.0) });
    overlay.points.extend(controls.iter().map(|p| point(*p, Symbol::Square, 6.0, CURVE, "")));
    overlay.points.push(point(pivot, Symbol::Cross, 11.0, DARK, "pivot"));
    let tags = bend.sections().tags();
    for tag in tags {
        let z = start + length * tag.u;
        let ends = [-half, half].iter().filter_map(|a| bent(z, *a)).collect();
        overlay.over.push(OverlayLine { hidden: Hidden::Show, ..line(ends, TAG, 2.4) });
    }
    if !tags.is_empty() {
        legend.push((TAG, "tag points, between styling sections".into()));
    }
    legend.push((PLANE, "reference plane".into()));
    legend.push((CURVE, "where it is bent to; the eye sees it straight".into()));
}

/// The control points in the plane of the curve, placed by the curve's own coordinates.
fn controls(bend: &SplineBend) -> Vec<DVec3> {
    let [u, v] = bend.curve_axes();
    let pivot = bend.pivot();
    let Ok(image) = bend.apply(pivot) else { return Vec::new() };
    let at = bend.curve().at(bend.coordinates(pivot).l).0;
    let scene = |q: DVec2| image + bend.scale() * ((q.x - at.x) * u + (q.y - at.y) * v);
    bend.resolved().control.iter().map(|c| scene(DVec2::from_array(*c))).collect()
}
