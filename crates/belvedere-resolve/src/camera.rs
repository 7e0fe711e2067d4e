//! Resolves the camera of a document to a pinhole.

use super::ground::Ground;
use crate::BelvedereError;
use belvedere_core::{DVec2, DVec3, Pinhole, PinholeError, Projection};
use belvedere_document::{CameraDoc, MapPointDoc, PointDoc, ProjectionDoc, SourceDocument};

/// A camera in scene coordinates.
#[derive(Debug, Clone)]
pub(crate) struct ResolvedCamera {
    /// The pinhole.
    pub pinhole: Pinhole,
    /// The given or implied point on the optical axis.
    pub look_at: Option<DVec3>,
    /// The document with every position as `[x, y, z]`.
    pub document: CameraDoc,
}

/// Distance at which a heading and pitch become a point, scene units: so large that rounding does not tilt the view.
const AIM_DISTANCE: f64 = 1e6;

/// Builds the pinhole. `spline_normal` is the plane normal of a spline stage, which then supplies the heading.
pub(crate) fn resolve(
    source: &SourceDocument,
    ground: &Ground<'_>,
    spline_normal: Option<DVec3>,
) -> Result<ResolvedCamera, BelvedereError> {
    let doc = &source.document.camera;
    let eye = position(source, ground, "eye", &doc.eye)?;
    let look_at = match (&doc.look_at, doc.heading_deg, doc.pitch_deg) {
        (Some(point), None, None) => Some(position(source, ground, "look_at", point)?),
        (None, Some(_), Some(_)) => None,
        (Some(_), _, _) => {
            let key = if doc.heading_deg.is_some() { "heading_deg" } else { "pitch_deg" };
            return Err(source
                .error(
                    &["camera", key],
                    "camera has look_at and heading_deg/pitch_deg; give either look_at or both angles",
                )
                .into());
        }
        (None, None, None) => {
            return Err(source
                .error(&["camera"], "camera has no direction; give look_at, or heading_deg and pitch_deg")
                .into());
        }
        (None, given, _) => {
            let (has, lacks) =
                if given.is_some() { ("heading_deg", "pitch_deg") } else { ("pitch_deg", "heading_deg") };
            return Err(source.error(&["camera", has], format!("camera has {has} but no {lacks}; add it")).into());
        }
    };
    let heading = doc.heading_deg.unwrap_or(0.0).to_radians();
    let aim = match look_at {
        Some(p) => p,
        None => eye + AIM_DISTANCE * direction(source, heading, doc.pitch_deg.unwrap_or(0.0))?,
    };
    let projection = projection(source)?;
    let make = |up: DVec3| Pinhole::look_at(eye, aim, up, projection, doc.image, doc.near, doc.far);
    let mut made = make(DVec3::from_array(doc.up));
    if let (Err(PinholeError::AlongUp { .. }), Some(normal)) = (&made, spline_normal) {
        // The spline's plane gives the heading. Straight down onto a level plane, the heading is that of the angles, and without
        // angles north.
        let level = DVec3::new(heading.sin(), heading.cos(), 0.0);
        made = make(normal).or_else(|_| make(level));
    }
    let pinhole = made.map_err(|e| {
        let key = if matches!(e, PinholeError::Range { .. }) && doc.far.is_some() { "far" } else { key_of(&e) };
        source.error(&["camera", key], e)
    })?;
    let mut document = doc.clone();
    document.eye = PointDoc::Scene(eye.to_array());
    document.look_at = look_at.map(|p| PointDoc::Scene(p.to_array()));
    Ok(ResolvedCamera { pinhole, look_at, document })
}

fn direction(source: &SourceDocument, heading: f64, pitch_deg: f64) -> Result<DVec3, BelvedereError> {
    if !(-90.0..=90.0).contains(&pitch_deg) {
        return Err(source
            .error(
                &["camera", "pitch_deg"],
                format!("camera pitch_deg is {pitch_deg}, it must lie in -90..=90 (down is positive)"),
            )
            .into());
    }
    let pitch = pitch_deg.to_radians();
    Ok(DVec3::new(heading.sin() * pitch.cos(), heading.cos() * pitch.cos(), -pitch.sin()))
}

fn projection(source: &SourceDocument) -> Result<Projection, BelvedereError> {
    let doc = &source.document.camera;
    match (doc.projection, doc.ortho_height_m) {
        (ProjectionDoc::Perspective, None) => Ok(Projection::Perspective { fov_y: doc.fov_y_deg.to_radians() }),
        (ProjectionDoc::Perspective, Some(_)) => Err(source.error(
            &["camera", "ortho_height_m"],
            "camera has ortho_height_m but projection is \"perspective\"; set projection = \"orthographic\" or remove it",
        ).into()),
        (ProjectionDoc::Orthographic, Some(height)) => Ok(Projection::Orthographic { height }),
        (ProjectionDoc::Orthographic, None) => {
            Err(source.error(&["camera", "projection"], "an orthographic camera needs ortho_height_m; add it").into())
        }
    }
}

fn key_of(error: &PinholeError) -> &'static str {
    match error {
        PinholeError::NotFinite { name, .. } => name,
        PinholeError::EyeIsTarget { .. } => "look_at",
        PinholeError::AlongUp { .. } => "up",
        PinholeError::FieldOfView { .. } => "fov_y_deg",
        PinholeError::OrthoHeight { .. } => "ortho_height_m",
        PinholeError::ImageSize { .. } => "image",
        PinholeError::Range { .. } => "near",
        _ => "eye",
    }
}

/// A position in scene coordinates; `key` is `eye` or `look_at`.
fn position(
    source: &SourceDocument,
    ground: &Ground<'_>,
    key: &str,
    point: &PointDoc,
) -> Result<DVec3, BelvedereError> {
    let fail = |reason: String| source.error(&["camera", key], reason);
    let map = match point {
        PointDoc::Scene(p) => return Ok(DVec3::from_array(*p)),
        PointDoc::Map(map) => map,
    };
    let xy = match map {
        MapPointDoc { lon: Some(lon), lat: Some(lat), x: None, y: None, .. } => {
            ground.position_of(*lon, *lat).map_err(|e| fail(format!("camera {key}: {e}")))?
        }
        MapPointDoc { lon: None, lat: None, x: Some(x), y: Some(y), height_m: None, .. } => DVec2::new(*x, *y),
        _ => {
            return Err(fail(format!(
                "camera {key} needs [x, y, z], or lon and lat with height_m or above_ground_m, or x and y with above_ground_m"
            )).into());
        }
    };
    let z = match (map.height_m, map.above_ground_m) {
        (Some(height), None) => height,
        (None, Some(above)) => {
            let degrees = map.lon.zip(map.lat).and_then(|(lon, lat)| ground.outside(lon, lat));
            let wrong = |e: String| fail(format!("camera {key}: {}", degrees.unwrap_or(e)));
            above + ground.height_at(xy).map_err(wrong)?
        }
        _ => return Err(fail(format!("camera {key} needs exactly one of height_m and above_ground_m")).into()),
    };
    Ok(xy.extend(z))
}
