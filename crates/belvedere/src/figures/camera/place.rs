//! Where a picture of the camera is taken from.

use super::CameraPicture;
use crate::{BelvedereError, Session};
use belvedere_core::{Aabb, DVec2, DVec3, Pinhole, Projection, View};
use belvedere_scene::Overlay;

/// Room around what is shown, as a share.
const MARGIN: f64 = 1.12;

pub(super) fn view(session: &Session, picture: CameraPicture, overlay: &Overlay) -> Result<View, BelvedereError> {
    let subject = session.view().pinhole();
    let points =
        overlay.over.iter().flat_map(|l| l.points.iter().copied()).chain(overlay.points.iter().map(|p| p.position));
    let shown = Aabb::of(points).union(session.scene().bounds());
    let image = subject.image;
    let pinhole = match picture {
        CameraPicture::Overhead => overhead(&shown, image),
        CameraPicture::Outside(places) => {
            let [eye, look] = match places {
                Some(places) => places.map(DVec3::from_array),
                None => beside(&shown, subject),
            };
            let fov_y = 40f64.to_radians();
            let near = (1e-4 * eye.distance(look)).max(1e-3);
            Pinhole::look_at(eye, look, DVec3::Z, Projection::Perspective { fov_y }, image, near, None)
        }
    };
    let pinhole = pinhole.map_err(|e| BelvedereError::Usage(format!("picture of the camera: {e}")))?;
    Ok(View::straight(pinhole))
}

fn overhead(shown: &Aabb, image: [u32; 2]) -> Result<Pinhole, belvedere_core::PinholeError> {
    let [w, h] = image.map(f64::from);
    let size = (shown.max - shown.min).truncate() * MARGIN;
    let height = size.y.max(size.x * h / w).max(1e-3);
    let middle = 0.5 * (shown.min + shown.max);
    let above = shown.max.z + 0.1 * height + 1.0;
    let eye = middle.with_z(above);
    let projection = Projection::Orthographic { height };
    Pinhole::look_at(eye, middle.with_z(above - 1.0), DVec3::Y, projection, image, 1e-3 * height, None)
}

/// From the right of the camera and above, far enough to see all of it.
fn beside(shown: &Aabb, subject: &Pinhole) -> [DVec3; 2] {
    let middle = 0.5 * (shown.min + shown.max);
    let reach = 0.5 * (shown.max - shown.min).length();
    let heading = subject.forward.truncate().try_normalize().unwrap_or(DVec2::Y);
    let right = DVec2::new(heading.y, -heading.x);
    let from = (0.9 * right - 0.35 * heading).extend(0.42).normalize();
    [middle + from * reach * 2.5, middle]
}
