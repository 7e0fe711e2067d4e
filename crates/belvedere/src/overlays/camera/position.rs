//! From where a picture of the camera is taken.

use super::subject::CameraPicture;
use crate::{BelvedereError, Session};
use belvedere_core::{Aabb, DVec2, DVec3, Pinhole, PinholeError, Projection, View};
use belvedere_scene::Overlay;

/// Margin around what is shown from above, as a share.
const MARGIN: f64 = 1.12;
/// Vertical field of view from outside, radians.
const FOV_Y: f64 = 0.7;

pub(super) fn view(session: &Session, picture: CameraPicture, overlay: &Overlay) -> Result<View, BelvedereError> {
    let subject = session.view().pinhole();
    // What is drawn in full: hulls and continuations may leave the picture.
    let lines = overlay.over.iter().filter(|l| l.color.a == 255).flat_map(|l| l.points.iter().copied());
    let points: Vec<DVec3> = lines.chain(overlay.points.iter().map(|p| p.position)).collect();
    let shown = Aabb::of(points.iter().copied());
    let pinhole = match picture {
        CameraPicture::Overhead => overhead(&shown, subject.image),
        CameraPicture::Outside(Some(eye_and_target)) => outside(eye_and_target.map(DVec3::from_array), subject.image),
        CameraPicture::Outside(None) => outside(beside(&shown, &points, subject), subject.image),
    };
    Ok(View::straight(pinhole?))
}

fn overhead(shown: &Aabb, image: [u32; 2]) -> Result<Pinhole, PinholeError> {
    let [w, h] = image.map(f64::from);
    let size = (shown.max - shown.min).truncate() * MARGIN;
    let height = size.y.max(size.x * h / w).max(1e-3);
    let middle = 0.5 * (shown.min + shown.max);
    let above = shown.max.z + 0.01 * height;
    let projection = Projection::Orthographic { height };
    let [eye, below] = [above, above - height].map(|z| middle.with_z(z));
    Pinhole::look_at(eye, below, DVec3::Y, projection, image, 1e-3 * height, None)
}

fn outside([eye, target]: [DVec3; 2], image: [u32; 2]) -> Result<Pinhole, PinholeError> {
    let near = (1e-4 * eye.distance(target)).max(1e-3);
    Pinhole::look_at(eye, target, DVec3::Z, Projection::Perspective { fov_y: FOV_Y }, image, near, None)
}

/// From the right of the camera and above, as near as lets everything be seen.
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
