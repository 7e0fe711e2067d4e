//! Views of models around a target: the whole model fills the picture, and what a bend moves is brought back into its middle.

use crate::BelvedereError;
use belvedere_construct::rays::{Sidestep, Target, TargetSight};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_scene::{Layer, LayerKind, Scene, Unit};
use rayon::prelude::*;

/// Headings of the views that are tried, degrees clockwise, those from the front first; and their pitches, degrees: of things that stand
/// on ground, and of others.
const HEADINGS: [f64; 12] = [30.0, 330.0, 60.0, 300.0, 0.0, 90.0, 270.0, 120.0, 240.0, 150.0, 210.0, 180.0];
const PITCHES: [[f64; 2]; 2] = [[20.0, 35.0], [8.0, 30.0]];
/// Views for which bends are searched, at most.
pub(super) const KEPT: usize = 8;
/// Visible share that a heading of the list must gain over an earlier one.
const WORTH: f64 = 0.03;
/// Share of half the picture's width and height that the model takes up.
const FITTED: f64 = 0.92;
/// Share of the picture's height that the target takes up at least.
const LEAST_TARGET: f64 = 0.22;
/// Points by which a layer is framed, at most about.
const MOST_POINTS: usize = 3000;
/// Visible share that moving the frame may cost.
const MAY_COST: f64 = 0.005;

/// Points that show how far the visible layers reach.
pub(super) fn outline(scene: &Scene) -> Vec<DVec3> {
    let of = |layer: &Layer| -> Vec<DVec3> {
        let thin = |count: usize| count.div_ceil(MOST_POINTS).max(1);
        match &layer.kind {
            LayerKind::Volume(v) => v.visible_voxels(MOST_POINTS),
            LayerKind::Mesh(m) => {
                let count = m.mesh.triangles().len();
                (0..count).step_by(thin(count)).flat_map(|t| m.mesh.corners(t)).collect()
            }
            LayerKind::Molecule(m) => {
                let mesh = &m.surface.mesh;
                let count = mesh.triangles().len();
                (0..count).step_by(thin(count)).flat_map(|t| mesh.corners(t)).collect()
            }
            _ => Target::around(layer.bounds()).points,
        }
    };
    let solid = scene.layers.iter().filter(|layer| !layer.bounds().is_empty());
    solid.flat_map(of).filter(|p| p.is_finite()).collect()
}

/// Axes to the right, ahead and up of a model whose up is `up`.
fn axes(up: DVec3) -> [DVec3; 3] {
    let north = if up.cross(DVec3::Y).length() > 0.5 { DVec3::Y } else { DVec3::Z };
    let right = north.cross(up).normalize();
    [right, up.cross(right), up]
}

/// The views from all around that are worth a search for bends, the best first; only one if it shows the whole target.
///
/// * `up`: unit vector; `image`, `fov_y`: size in pixels, and full vertical field of view, radians;
/// * `most`: number of views at most, [`KEPT`] for the search of one.
///
/// # Errors
/// [`BelvedereError`] if no camera is possible.
pub(super) fn around(
    (scene, sight): (&Scene, &TargetSight<'_>),
    target: &Target,
    up: DVec3,
    (image, fov_y): ([u32; 2], f64),
    most: usize,
) -> Result<Vec<View>, BelvedereError> {
    let points = outline(scene);
    let points = if points.is_empty() { target.points.clone() } else { points };
    let [east, north, up] = axes(up);
    let mut views = Vec::new();
    for pitch in PITCHES[usize::from(scene.unit != Unit::Metre)] {
        for heading in HEADINGS {
            let ((sin, cos), (down, ahead)) = (heading.to_radians().sin_cos(), pitch.to_radians().sin_cos());
            let forward = ahead * (sin * east + cos * north) - down * up;
            views.push(View::straight(fitted(&points, target, (forward, up), (image, fov_y))?));
        }
    }
    let mut judged: Vec<(f64, f64, View)> = views
        .into_par_iter()
        .enumerate()
        .map(|(i, view)| {
            let shown = sight.shown(&view, 0.0);
            (shown.share, shown.share + 0.1 * shown.light - WORTH * i as f64 / HEADINGS.len() as f64, view)
        })
        .collect();
    judged.sort_by(|a, b| b.1.total_cmp(&a.1));
    let whole = judged.first().is_some_and(|best| best.0 >= 1.0) && most == KEPT;
    judged.truncate(if whole { 1 } else { most });
    Ok(judged.into_iter().map(|(.., view)| view).collect())
}

/// The camera in a direction from which the model fills the picture; nearer, at the target, where that is small.
pub(super) fn fitted(
    points: &[DVec3],
    target: &Target,
    (forward, up): (DVec3, DVec3),
    (image, fov_y): ([u32; 2], f64),
) -> Result<Pinhole, BelvedereError> {
    let right = forward.cross(up).normalize();
    let above = right.cross(forward);
    let half = (0.5 * fov_y).tan();
    let tangent = FITTED * half * DVec2::new(f64::from(image[0]) / f64::from(image[1]), 1.0);
    let (mut least, mut most) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let mut depths = [f64::INFINITY, f64::NEG_INFINITY];
    for p in points {
        let (aside, z) = (DVec2::new(p.dot(right), p.dot(above)), p.dot(forward));
        (least, most) = (least.min(aside + tangent * z), most.max(aside - tangent * z));
        depths = [depths[0].min(z), depths[1].max(z)];
    }
    let aside = 0.5 * (least + most);
    let reach = (depths[1] - depths[0]).max(1e-6);
    let z = (0.5 * (least - most) / tangent).min_element().min(depths[0] - 0.05 * reach);
    let mut eye = aside.x * right + aside.y * above + z * forward;
    let center = target.center();
    let distance = (center - eye).dot(forward);
    // A small target is looked at from nearer, and towards its middle.
    let size = target.extent() / (distance * half);
    if size < LEAST_TARGET && size > 0.0 {
        let nearer = distance * (size / LEAST_TARGET).max(0.35);
        let onto = eye + distance * forward;
        let middle = onto.lerp(center, ((distance - nearer) / (0.65 * distance)).clamp(0.0, 1.0));
        eye = middle - nearer * forward;
    }
    let middle = eye + distance.max(1e-6) * forward;
    // Rays may bend long before they reach the model.
    let near = 0.02 * (depths[0] - eye.dot(forward)).max(0.05 * distance).max(1e-6);
    let lens = Projection::Perspective { fov_y };
    Ok(Pinhole::look_at(eye, middle, up, lens, image, near, None)?)
}

/// The camera of a bent picture, turned and zoomed so that the model fills the bent picture and lies in the middle of the straight and the
/// bent one together; `None` if it stays as it is because the target would be seen less.
///
/// * `points`: what the picture is to hold.
pub(super) fn reframed(sight: &TargetSight<'_>, base: &View, sidestep: &Sidestep, points: &[DVec3]) -> Option<View> {
    let share = |view: &View| sidestep.view(view).map_or(0.0, |bent| sight.share(&bent, 0.0));
    let (before, mut best) = (share(base), None);
    let mut view = base.clone();
    for _ in 0..3 {
        let (low, high) = extent(&view, sidestep, points)?;
        view = turned(&view, (low, high))?;
        if share(&view) + MAY_COST >= before {
            best = Some(view.clone());
        }
    }
    best
}

/// Box in the picture around the bent and the straight image of the points, pixels; without the outermost hundredth.
fn extent(view: &View, sidestep: &Sidestep, points: &[DVec3]) -> Option<(DVec2, DVec2)> {
    let bent = sidestep.view(view).ok()?;
    let images = |view: &View| points.iter().filter_map(|p| Some(view.project(*p).ok()?.pixel)).collect::<Vec<_>>();
    let all: Vec<DVec2> = images(&bent).into_iter().chain(images(view)).filter(|p| p.is_finite()).collect();
    let range = |of: fn(&DVec2) -> f64| {
        let mut values: Vec<f64> = all.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        let last = values.len().checked_sub(1)?;
        let cut = last / 200;
        Some((values[cut], values[last - cut]))
    };
    let ((left, right), (top, bottom)) = (range(|p| p.x)?, range(|p| p.y)?);
    Some((DVec2::new(left, top), DVec2::new(right, bottom)))
}

/// The camera turned towards the middle of a box in its picture, with the field of view that holds the box.
fn turned(view: &View, (low, high): (DVec2, DVec2)) -> Option<View> {
    let old = view.pinhole();
    let Projection::Perspective { fov_y } = old.projection else { return None };
    let size = DVec2::from(old.image.map(f64::from));
    let off = (0.5 * (low + high) - old.center_px()) / old.scale_px();
    let forward = (old.forward + off.x * old.right + off.y * old.down).normalize();
    let zoom = ((high - low) / (FITTED * size)).max_element().clamp(0.5, 2.0);
    let fov_y = 2.0 * ((0.5 * fov_y).tan() * zoom).atan();
    let lens = Projection::Perspective { fov_y: fov_y.clamp(0.02, 1.6) };
    let pinhole = Pinhole::look_at(old.eye, old.eye + forward, -old.down, lens, old.image, old.near, old.far).ok()?;
    View::new(pinhole, view.stages().to_vec()).ok()
}
