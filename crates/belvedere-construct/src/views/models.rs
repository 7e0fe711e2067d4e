//! Views of models around a target: the whole model fills the picture.

use crate::ConstructError;
use crate::rays::{Target, TargetSight};
use belvedere_core::quantile::{Rank, quantile};
use belvedere_core::{Aabb, DVec2, DVec3, Pinhole, Projection, View};
use belvedere_scene::{Layer, LayerKind, Mesh, OwnLayer, Scene, Unit};
use rayon::prelude::*;

/// Headings of the views that are tried, degrees clockwise, those from the front first; and their pitches, degrees: of things that stand
/// on ground, and of others.
const HEADINGS: [f64; 12] = [30.0, 330.0, 60.0, 300.0, 0.0, 90.0, 270.0, 120.0, 240.0, 150.0, 210.0, 180.0];
const PITCHES: [[f64; 2]; 2] = [[20.0, 35.0], [8.0, 30.0]];
/// Views for which bends are searched, at most.
const KEPT: usize = 8;
/// Visible share that a heading of the list must gain over an earlier one.
const WORTH: f64 = 0.03;
/// Share of half the picture's width and height that the model takes up.
const FITTED: f64 = 0.92;
/// Triangles by which a layer is framed, at most about, when many views are tried.
const FEW: usize = 3000;
/// The same when the view that was chosen is refitted.
pub const MANY: usize = 200_000;

/// Buildings, at least, of a town of which some may stand apart; the share of buildings that lies beyond either side of its core along an
/// axis, and how much farther than the core the town reaches.
const TOWN: usize = 50;
const BEYOND: f64 = 0.05;
const TOWN_REACH: f64 = 1.25;

/// The extent in plan of a town without what stands far apart from it, and how many buildings and structures do; `None` where none does.
pub fn core_of_town(mesh: &Mesh) -> Option<([DVec2; 2], usize)> {
    let mut places: Vec<DVec2> = Vec::new();
    let mut last = 0;
    for t in 0..mesh.triangles().len() {
        let part = mesh.part(t).unwrap_or(0);
        if part > 0 && part != last {
            places.push(mesh.corners(t)[0].truncate());
            last = part;
        }
    }
    if places.len() < TOWN {
        return None;
    }
    let at = |axis: usize, share: f64| {
        quantile(&mut places.iter().map(|p| p[axis]).collect::<Vec<_>>(), share, Rank::Nearest)
    };
    let [low, high] = [BEYOND, 1.0 - BEYOND].map(|share| DVec2::new(at(0, share), at(1, share)));
    // Towns along a street are narrow, and their houses stand on both sides of it.
    let half = 0.5 * TOWN_REACH * (high - low).max(DVec2::splat(0.2 * (high - low).max_element()));
    let core = [0.5 * (low + high) - half, 0.5 * (low + high) + half];
    let apart = places.iter().filter(|p| !is_within(core, **p)).count();
    (apart > 0).then_some((core, apart))
}

fn is_within([low, high]: [DVec2; 2], p: DVec2) -> bool {
    p.cmpge(low).all() && p.cmple(high).all()
}

/// Points that show how far the visible layers reach.
/// * `most`: triangles of a layer by which that is told, at most about;
/// * `cities`: ids of layers of cities, of which buildings and structures count that do not stand [far apart](core_of_town); of those
///   without any, all but the margin of their plate.
pub fn outline(scene: &Scene, most: usize, cities: &[&str]) -> Vec<DVec3> {
    let of = |layer: &Layer| -> Vec<DVec3> {
        match &layer.kind {
            LayerKind::Volume(v) => v.outline(),
            LayerKind::Mesh(m) | LayerKind::Own(OwnLayer { surface: m, .. }) => {
                let Aabb { min, max } = layer.bounds();
                let is_inside = |p: &DVec3| p.cmpgt(min).all() && p.cmplt(max).all();
                // Part 0 is the ground and its cover.
                let stands = |t: usize| m.mesh.part(t).is_some_and(|part| part > 0);
                let is_city = cities.contains(&layer.id.as_str());
                let has_buildings = is_city && (0..m.mesh.triangles().len()).any(stands);
                let core = core_of_town(&m.mesh).filter(|_| has_buildings).map(|(core, _)| core);
                reach(&m.mesh, most, &|t, p| match (is_city, has_buildings) {
                    (false, _) => true,
                    (true, true) => stands(t) && core.is_none_or(|core| is_within(core, p.truncate())),
                    (true, false) => is_inside(&p.with_z(0.5 * (min.z + max.z))),
                })
            }
            LayerKind::Molecule(m) => reach(&m.surface.mesh, most, &|_, _| true),
            _ => Target::around(layer.bounds()).points,
        }
    };
    let solid = scene.layers.iter().filter(|layer| !layer.bounds().is_empty());
    solid.flat_map(of).filter(|p| p.is_finite()).collect()
}

/// Corners of triangles that tell how far a mesh reaches: of at most `most` triangles all, of more, where many views are tried, those of some.
/// Else the first and the last along x in every cell of a lattice over y and z: no other lies farther out than a cell is wide.
fn reach(mesh: &Mesh, most: usize, counts: &dyn Fn(usize, &DVec3) -> bool) -> Vec<DVec3> {
    let count = mesh.triangles().len();
    let of = |t: usize| mesh.corners(t).into_iter().filter(move |p| counts(t, p));
    let all = || (0..count).flat_map(of);
    if count <= most {
        return all().collect();
    }
    if most <= FEW {
        return (0..count).step_by(count.div_ceil(most)).flat_map(of).collect();
    }
    let (side, bounds) = ((most as f64 / 2.0).sqrt().floor(), mesh.bounds());
    let mut ends: Vec<Option<[DVec3; 2]>> = vec![None; (side * side) as usize];
    for p in all() {
        let at = (side * (p - bounds.min) / (bounds.max - bounds.min)).clamp(DVec3::ZERO, DVec3::splat(side - 1.0));
        let [first, last] = ends[at.y as usize * side as usize + at.z as usize].get_or_insert([p; 2]);
        (*first, *last) = (if p.x < first.x { p } else { *first }, if p.x > last.x { p } else { *last });
    }
    ends.into_iter().flatten().flatten().collect()
}

/// Axes to the right, ahead and up of a model whose up is `up`.
fn axes(up: DVec3) -> [DVec3; 3] {
    let north = if up.cross(DVec3::Y).length() > 0.5 { DVec3::Y } else { DVec3::Z };
    let right = north.cross(up).normalize();
    [right, up.cross(right), up]
}

/// The views from all around that are worth a search for bends, the best first.
///
/// * `up`: unit vector; `image`, `fov_y`: size in pixels, and full vertical field of view, radians;
/// * `most`: number of views at most; `None` = 8.
///
/// # Errors
/// [`ConstructError::Pinhole`] if no camera is possible.
pub fn around_model(
    (scene, sight): (&Scene, &TargetSight<'_>),
    target: &Target,
    up: DVec3,
    (image, fov_y): ([u32; 2], f64),
    most: Option<usize>,
) -> Result<Vec<View>, ConstructError> {
    let points = outline(scene, FEW, &[]);
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
    let mut judged: Vec<(f64, View)> = views
        .into_par_iter()
        .enumerate()
        .map(|(i, view)| {
            let shown = sight.shown(&view, 0.0);
            (shown.share + 0.1 * shown.light - WORTH * i as f64 / HEADINGS.len() as f64, view)
        })
        .collect();
    judged.sort_by(|a, b| b.0.total_cmp(&a.0));
    judged.truncate(most.unwrap_or(KEPT));
    Ok(judged.into_iter().map(|(_, view)| view).collect())
}

/// The camera in a direction from which the model fills the picture.
pub(super) fn fitted(
    points: &[DVec3],
    target: &Target,
    (forward, up): (DVec3, DVec3),
    (image, fov_y): ([u32; 2], f64),
) -> Result<Pinhole, ConstructError> {
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
    let eye = aside.x * right + aside.y * above + z * forward;
    let distance = (target.center() - eye).dot(forward);
    let middle = eye + distance.max(1e-6) * forward;
    // Rays may bend long before they reach the model.
    let near = 0.02 * (depths[0] - eye.dot(forward)).max(0.05 * distance).max(1e-6);
    let lens = Projection::Perspective { fov_y };
    Ok(Pinhole::look_at(eye, middle, up, lens, image, near, None)?)
}
