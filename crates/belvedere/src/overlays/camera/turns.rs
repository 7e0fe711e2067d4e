//! Viewpoints and transition planes of curved rays.

use super::subject::{Subject, line, point, segment_color};
use belvedere_core::map::curved_rays::LinearForm;
use belvedere_core::{CurvedRays, DVec2, DVec3};
use belvedere_scene::{Color, Overlay, OverlayFace, Symbol};

/// Depths tried along a corner's ray before the crossing with a plane is halved.
const STEPS: usize = 400;

/// * `ways`: curved rays and the corners of the part of the image that they draw.
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
}

fn way(subject: &Subject<'_>, camera: &CurvedRays, pixels: &[DVec2], overlay: &mut Overlay) {
    for (j, turn) in camera.turns().iter().enumerate() {
        let after = segment_color(2 * j as u32 + 2);
        overlay.points.push(point(turn.viewpoint, Symbol::Dot, 9.0, after, &format!("viewpoint {}", j + 1)));
        // From where the rays past the turn seem to come.
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

/// A corner moved a little into its part of the image: on a seam its ray would be the neighbour's.
fn inward(corner: DVec2, part: &[DVec2]) -> DVec2 {
    let middle = part.iter().sum::<DVec2>() / part.len() as f64;
    corner.lerp(middle, 1e-6)
}

/// Where the ray of a pixel passes a plane.
fn crossing(subject: &Subject<'_>, pixel: DVec2, form: &LinearForm) -> Option<DVec3> {
    let ray = subject.view.ray(pixel);
    let at = |depth: f64| ray.at(depth).ok().map(|p| p.point);
    let value = |depth: f64| at(depth).map(|p| form.at(p));
    let far = 3.0 * subject.far;
    let depth = |i: usize| far * (i as f64 / STEPS as f64).max(1e-5);
    let (mut lo, mut hi) = (1..=STEPS)
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
