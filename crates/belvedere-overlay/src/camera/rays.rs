//! A fan of rays, each as [`View::ray`] gives it, up to the surface that it meets.

use super::subject::{Subject, line, segment_color};
use belvedere_core::{CurvedRays, DVec2, DVec3, SplitRays, View};
use belvedere_scene::{Color, Overlay};
use belvedere_sight::trace::{RayHit, Tracer};

/// Numbers of rays across the picture and from its bottom to its top.
const ACROSS: usize = 11;
const UP: usize = 9;
/// Number of points of a ray.
const POINTS: usize = 240;

/// Pixels of the fan: a row somewhat below the middle, and the middle column.
pub(super) fn pixels(view: &View) -> Vec<DVec2> {
    let [w, h] = view.pinhole().image.map(f64::from);
    let row = (0..ACROSS).map(|i| DVec2::new(w * (i as f64 + 0.5) / ACROSS as f64, 0.6 * h));
    let column = (0..UP).map(|i| DVec2::new(0.5 * w, h * (i as f64 + 0.5) / UP as f64));
    row.chain(column).collect()
}

/// Corners of the image, in order.
pub(super) fn corners(view: &View) -> [DVec2; 4] {
    let [w, h] = view.pinhole().image.map(f64::from);
    [DVec2::ZERO, DVec2::new(w, 0.0), DVec2::new(w, h), DVec2::new(0.0, h)]
}

/// First hits of the rays of the fan and of the corners.
pub(super) fn hits(view: &View, tracer: &Tracer<'_>) -> Vec<RayHit> {
    pixels(view).into_iter().chain(corners(view)).filter_map(|p| tracer.first_hit(p)).collect()
}

/// The ray of a pixel from the eye to a depth, cut where its segment changes.
pub(super) fn pieces(view: &View, pixel: DVec2, depth: f64) -> Vec<(u32, Vec<DVec3>)> {
    let ray = view.ray(pixel);
    let mut out: Vec<(u32, Vec<DVec3>)> = Vec::new();
    let near = 1e-4 * depth;
    for seen in ray.samples(near, depth, POINTS).map_while(Result::ok) {
        match out.last_mut() {
            Some((segment, points)) if *segment == seen.segment => points.push(seen.point),
            last => {
                // The parts join: each begins where the one before ends.
                let joint = last.and_then(|(_, points)| points.last().copied());
                out.push((seen.segment, joint.into_iter().chain([seen.point]).collect()));
            }
        }
    }
    out.retain(|(_, points)| points.len() > 1);
    out
}

pub(super) fn draw(subject: &Subject<'_>, overlay: &mut Overlay, legend: &mut Vec<(Color, String)>) {
    let view = subject.view;
    for pixel in pixels(view) {
        let depth = subject.tracer.first_hit(pixel).map_or(subject.far, |hit| hit.depth);
        for (segment, points) in pieces(view, pixel, depth) {
            overlay.over.push(line(points, segment_color(segment), 1.7));
        }
    }
    for pixel in corners(view) {
        for (segment, points) in pieces(view, pixel, subject.far) {
            overlay.over.push(line(points, segment_color(segment).with_alpha(150), 1.0));
        }
    }
    let longest = |split: &SplitRays| split.branches().iter().map(|b| b.rays.turn_count()).max();
    match view.curved_rays().map(CurvedRays::turn_count).or_else(|| view.split_rays().and_then(longest)) {
        None | Some(0) => legend.push((segment_color(0), "rays, to what they meet".into())),
        Some(turns) => {
            for segment in 0..=2 * turns as u32 {
                let name = match segment {
                    0 => "rays from the eye".into(),
                    s if s % 2 == 1 => format!("rays in transition {}", s / 2 + 1),
                    s => format!("rays as from viewpoint {}", s / 2),
                };
                legend.push((segment_color(segment), name));
            }
        }
    }
}
