//! Cameras for pictures of the camera.

use super::subject::CameraPicture;
use belvedere_core::{Aabb, DVec2, DVec3, Pinhole, PinholeError, Projection, View};
use belvedere_scene::{Overlay, Scene};

/// Factor by which pictures from above are larger than their contents.
const MARGIN: f64 = 1.12;
/// Vertical field of view from outside, radians.
const FOV_Y: f64 = 0.7;

pub(super) fn view(
    (scene, view): (&Scene, &View),
    picture: CameraPicture,
    overlay: &Overlay,
) -> Result<View, PinholeError> {
    let subject = view.pinhole();
    // Only opaque lines must fit: hulls and continuations may leave the picture.
    let lines = overlay.over.iter().filter(|l| l.color.a == 255).flat_map(|l| l.points.iter().copied());
    let points: Vec<DVec3> = lines.chain(overlay.points.iter().map(|p| p.position)).collect();
    let shown = Aabb::of(points.iter().copied());
    let pinhole = match picture {
        CameraPicture::Overhead => overhead(&shown, top(scene, &shown), subject.image),
        CameraPicture::Outside(Some(eye_and_target)) => outside(eye_and_target.map(DVec3::from_array), subject.image),
        CameraPicture::Outside(None) => outside(beside(&shown, &points, subject), subject.image),
    };
    Ok(View::straight(pinhole?))
}

/// Largest height of the scene and of the marks over it.
fn top(scene: &Scene, shown: &Aabb) -> f64 {
    let bounds = scene.bounds();
    if bounds.is_empty() { shown.max.z } else { shown.max.z.max(bounds.max.z) }
}

/// * `top`: largest height, above which nothing is cut off.
fn overhead(shown: &Aabb, top: f64, image: [u32; 2]) -> Result<Pinhole, PinholeError> {
    let [w, h] = image.map(f64::from);
    let size = (shown.max - shown.min).truncate() * MARGIN;
    let height = size.y.max(size.x * h / w).max(1e-3);
    let middle = 0.5 * (shown.min + shown.max);
    let above = top + 0.01 * height;
    let projection = Projection::Orthographic { height };
    let [eye, below] = [above, above - height].map(|z| middle.with_z(z));
    Pinhole::look_at(eye, below, DVec3::Y, projection, image, 1e-3 * height, None)
}

fn outside([eye, target]: [DVec3; 2], image: [u32; 2]) -> Result<Pinhole, PinholeError> {
    let near = (1e-4 * eye.distance(target)).max(1e-3);
    Pinhole::look_at(eye, target, DVec3::Z, Projection::Perspective { fov_y: FOV_Y }, image, near, None)
}

/// Eye to the right of the camera and above, as near as all points fit, and its target.
fn beside(shown: &Aabb, points: &[DVec3], subject: &Pinhole) -> [DVec3; 2] {
    let middle = 0.5 * (shown.min + shown.max);
    let reach = (0.5 * (shown.max - shown.min).length()).max(1e-3);
    let heading = subject.forward.truncate().try_normalize().unwrap_or(DVec2::Y);
    let right = DVec2::new(heading.y, -heading.x);
    let from = (0.9 * right - 0.3 * heading).extend(0.4).normalize();
    let size = DVec2::from(subject.image.map(f64::from));
    let mut best = [middle + from * reach * 4.0, middle];
    for i in 0..60 {
        let nearer = [middle + from * reach * 4.0 * 0.96f64.powi(i), middle];
        let Ok(camera) = outside(nearer, subject.image) else { break };
        let fits = |p: &DVec3| {
            let image = camera.project(*p).ok().map(|(pixel, _)| pixel / size);
            image.is_some_and(|s| (0.04..=0.96).contains(&s.x) && (0.08..=0.95).contains(&s.y))
        };
        if !points.iter().all(fits) {
            break;
        }
        best = nearer;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::{BoxLayer, BoxShape, Color, Layer, LayerKind, OverlayPoint, Symbol};

    #[test]
    fn from_above_no_tower_is_cut_off_however_tall() {
        let tower = BoxShape {
            base: DVec3::new(40.0, 0.0, 0.0),
            size: DVec3::new(20.0, 20.0, 300.0),
            yaw: 0.0,
            color: Color::rgb(200, 200, 200),
        };
        let kind = LayerKind::Boxes(BoxLayer::new(vec![tower]));
        let layers = vec![Layer { id: "towers".into(), must_see: false, kind }];
        let lens = Projection::Perspective { fov_y: FOV_Y };
        let camera =
            Pinhole::look_at(DVec3::Z, DVec3::new(0.0, 1.0, 1.0), DVec3::Z, lens, [64, 64], 0.1, None).unwrap();
        let (scene, camera) = (Scene { layers, ..Scene::default() }, View::straight(camera));
        let mark = |x: f64| OverlayPoint {
            position: DVec3::new(x, 0.5 * x, 1.0),
            symbol: Symbol::Dot,
            size_px: 4.0,
            color: Color::rgb(0, 0, 0),
            hidden: belvedere_scene::Hidden::Show,
            label: String::new(),
        };
        let overlay = Overlay { points: vec![mark(0.0), mark(60.0)], ..Overlay::default() };
        let above = view((&scene, &camera), CameraPicture::Overhead, &overlay).unwrap();
        let depth = above.project(DVec3::new(40.0, 0.0, 300.0)).unwrap().depth;
        assert!(depth > above.pinhole().near, "{depth}");
    }
}
