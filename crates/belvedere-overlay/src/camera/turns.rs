//! Viewpoints and transition planes of curved rays.

use super::subject::{Subject, line, point, segment_color};
use belvedere_core::map::curved_rays::{LinearForm, Turn};
use belvedere_core::{CurvedRays, DVec2, DVec3};
use belvedere_scene::{Color, Overlay, OverlayFace, Symbol};

/// Depths tested along a corner's ray before the crossing with a plane is bisected.
const DEPTHS: usize = 400;
/// Number of marked intermediate viewpoints per turn.
const BETWEEN: u32 = 7;

/// Colour of the line between two viewpoints.
const BASELINE: Color = Color::rgb(110, 60, 160);

/// * `ways`: each branch of curved rays, with the corners of its part of the image.
pub(super) fn draw(
    subject: &Subject<'_>,
    ways: &[(&CurvedRays, &[DVec2])],
    overlay: &mut Overlay,
    legend: &mut Vec<(Color, String)>,
) {
    for (camera, corners) in ways {
        way(subject, camera, corners, overlay);
    }
    legend.push((Color::rgb(120, 124, 132), "planes t0, t1, t2: the rays bend between them".into()));
    if ways.iter().any(|(camera, _)| camera.turns().iter().any(|turn| turn.intermediate_viewpoint(0.5).is_some())) {
        legend.push((BASELINE, "viewpoints in between, while the rays bend".into()));
    }
}

fn way(subject: &Subject<'_>, camera: &CurvedRays, pixels: &[DVec2], overlay: &mut Overlay) {
    for (j, turn) in camera.turns().iter().enumerate() {
        let after = segment_color(2 * j as u32 + 2);
        overlay.points.push(point(turn.viewpoint, Symbol::Dot, 9.0, after, &format!("viewpoint {}", j + 1)));
        between(turn, overlay);
        // Lines to the viewpoint from which the rays past the turn seem to come.
        for &corner in pixels {
            if let Some(p) = crossing(subject, inward(corner, pixels), &turn.b) {
                overlay.over.push(line(vec![turn.viewpoint, p], after.with_alpha(110), 0.9));
            }
        }
        for (form, name, color) in [
            (&turn.a, "t0", segment_color(2 * j as u32)),
            (&turn.h, "t1", segment_color(2 * j as u32 + 1)),
            (&turn.b, "t2", after),
        ] {
            let corners: Vec<DVec3> =
                pixels.iter().filter_map(|c| crossing(subject, inward(*c, pixels), form)).collect();
            if corners.len() < pixels.len() {
                continue;
            }
            overlay.over.push(line([&corners[..], &corners[..1]].concat(), color, 1.6));
            overlay.faces.push(OverlayFace { corners: corners.clone(), color: color.with_alpha(64) });
            let top = corners.iter().copied().max_by(|a, b| a.z.total_cmp(&b.z)).unwrap_or(corners[0]);
            overlay.points.push(point(top, Symbol::Square, 4.0, color, name));
        }
    }
}

/// Draws the line from the viewpoint before a turn to that after it, with the intermediate viewpoints of the bending rays.
fn between(turn: &Turn, overlay: &mut Overlay) {
    let share = |k: u32| f64::from(k) / f64::from(BETWEEN + 1);
    let places: Vec<DVec3> = (1..=BETWEEN).filter_map(|k| turn.intermediate_viewpoint(share(k))).collect();
    if !places.is_empty() {
        overlay.over.push(line(vec![turn.viewpoint_before, turn.viewpoint], BASELINE.with_alpha(150), 1.0));
    }
    overlay.points.extend(places.into_iter().map(|place| point(place, Symbol::Dot, 4.0, BASELINE, "")));
}

/// A corner moved slightly into its part of the image, since on a seam its ray would belong to the neighbour.
fn inward(corner: DVec2, part: &[DVec2]) -> DVec2 {
    let middle = part.iter().sum::<DVec2>() / part.len() as f64;
    corner.lerp(middle, 1e-6)
}

/// Point where the ray of a pixel crosses a plane.
fn crossing(subject: &Subject<'_>, pixel: DVec2, form: &LinearForm) -> Option<DVec3> {
    let ray = subject.view.ray(pixel);
    let at = |depth: f64| ray.at(depth).ok().map(|p| p.point);
    let value = |depth: f64| at(depth).map(|p| form.at(p));
    let far = 3.0 * subject.far;
    let depth = |i: usize| far * (i as f64 / DEPTHS as f64).max(1e-5);
    let (mut lo, mut hi) = (1..=DEPTHS)
        .map(|i| (depth(i - 1), depth(i)))
        .find(|&(a, b)| matches!((value(a), value(b)), (Some(u), Some(v)) if (u > 0.0) != (v > 0.0)))?;
    let rising = value(hi)? > 0.0;
    for _ in 0..50 {
        let middle = 0.5 * (lo + hi);
        match value(middle) {
            Some(v) if (v > 0.0) == rising => hi = middle,
            Some(_) => lo = middle,
            None => break,
        }
    }
    at(0.5 * (lo + hi))
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
    use belvedere_core::{Pinhole, Projection};

    #[test]
    fn viewpoints_in_between_lie_in_order_from_the_eye_to_the_second_viewpoint() {
        let lens = Projection::Perspective { fov_y: 0.7 };
        let root = Pinhole::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, lens, [640, 360], 0.1, None).unwrap();
        let viewpoint = DVec3::new(30.0, 5.0, 4.0);
        let at = |y: f64| DVec3::new(0.0, y, 0.0);
        let pencil = Pencil::Parallel { normal: DVec3::Y };
        let turn = TurnSpec { viewpoint, t0: at(40.0), t1: at(50.0), t2: at(60.0), pencil, m: Sharpness::Bend };
        let marked = |model| {
            let mut overlay = Overlay::default();
            between(&CurvedRays::new(&root, model, &[turn]).unwrap().turns()[0], &mut overlay);
            overlay.points.iter().map(|p| p.position).collect::<Vec<_>>()
        };
        let places = marked(Model::Modified);
        assert_eq!(places.len(), BETWEEN as usize);
        let mut last = 0.0;
        for place in places {
            let share = place.dot(viewpoint) / viewpoint.length_squared();
            assert!(place.distance(share * viewpoint) < 1e-9 && share > last && share < 1.0, "{place} after {last}");
            last = share;
        }
        assert!(marked(Model::C0).is_empty(), "rays with a kink have none");
    }
}
