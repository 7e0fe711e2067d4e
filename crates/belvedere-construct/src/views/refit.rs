//! The camera of a picture, turned and zoomed where it stands, so that what a bend moved lies inside with an even margin.
//!
//! A bend displaces space in the same way wherever the camera at its eye looks. It is therefore kept as it is: nothing comes to stand in
//! front of anything else, and the frame alone changes.

use crate::rays::{Sidestep, TargetSight};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use serde::Serialize;

/// Share of the picture's width or height that the content takes up.
const FITTED: f64 = 0.92;
/// Factors by which the picture may show more or less than before, and the largest tangent of half its angle.
const ZOOM: [f64; 2] = [0.5, 3.0];
const WIDEST: f64 = 1.03;
/// Times that the middle of the content is sought: its extent on the picture plane depends on where the camera looks.
const ROUNDS: usize = 12;
/// Tangent of the angle from the direction of view beyond which content is not framed.
const FARTHEST: f64 = 4.0;
/// Visible share that another frame may cost: rounding.
const MAY_COST: f64 = 0.005;

/// What another frame changed; in each pair before and after.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RefitRecord {
    /// Angle by which the camera was turned, degrees.
    pub turned_deg: f64,
    /// Full vertical field of view, degrees.
    pub fov_y_deg: [f64; 2],
    /// Share of the content that lies outside the bent picture.
    pub outside: [f64; 2],
}

/// A camera in another frame.
#[derive(Debug, Clone)]
pub struct Refit {
    /// The view without its bend.
    pub straight: View,
    /// What changed.
    pub record: RefitRecord,
}

/// What a frame is fitted to.
pub struct Content<'a> {
    /// Points of all that the picture is to hold.
    pub points: &'a [DVec3],
    /// Direction that is up in the picture.
    pub up: DVec3,
    /// Whether the field of view may change.
    pub may_zoom: bool,
}

/// The view `base` in another frame, with its bend if there is one; `None` where that would show less of the target, straight or bent.
pub fn refit(
    sight: &TargetSight<'_>,
    base: &View,
    sidestep: Option<&Sidestep>,
    content: &Content<'_>,
) -> Option<Refit> {
    let old = base.pinhole();
    let bent = |view: &View| sidestep.map_or_else(|| Some(view.clone()), |s| s.seen_by(old, view).ok());
    let before = bent(base)?;
    let direction = |view: &View, p: &DVec3| view.displace(*p).ok().map(|d| d.point - old.eye);
    let moved: Vec<DVec3> = content.points.iter().filter_map(|p| direction(&before, p)).collect();
    let shown = [base, &before].map(|view| (sight.share(view, 0.0), sight.in_frame(view)));
    let tried = |directions: &[DVec3]| {
        let straight = View::new(framed(old, content, directions)?, base.stages().to_vec()).ok()?;
        let after = bent(&straight)?;
        // The straight picture beside the bent one keeps the target, too, so that the two can be compared.
        let is_as_good = |view: &View, (share, in_frame): (f64, f64)| {
            sight.share(view, 0.0) + MAY_COST >= share && sight.in_frame(view) + MAY_COST >= in_frame
        };
        (is_as_good(&straight, shown[0]) && is_as_good(&after, shown[1])).then_some((straight, after))
    };
    let (straight, after) = tried(&moved).or_else(|| {
        let target = sight.target().points.iter().filter_map(|p| direction(base, p));
        tried(&moved.iter().copied().chain(target).collect::<Vec<_>>())
    })?;
    let record = RefitRecord {
        turned_deg: old.forward.angle_between(straight.pinhole().forward).to_degrees(),
        fov_y_deg: [old, straight.pinhole()].map(|p| 2.0 * half_tangent(p).atan().to_degrees()),
        outside: [&before, &after].map(|view| outside(view, content.points)),
    };
    Some(Refit { straight, record })
}

/// Share of points that lie outside the picture.
fn outside(view: &View, points: &[DVec3]) -> f64 {
    let is_inside = |p: &&DVec3| view.project(**p).is_ok_and(|image| view.pinhole().contains(image.pixel));
    1.0 - points.iter().filter(is_inside).count() as f64 / points.len().max(1) as f64
}

fn half_tangent(pinhole: &Pinhole) -> f64 {
    0.5 * f64::from(pinhole.image[1]) / pinhole.scale_px()
}

/// The camera at the same eye in whose picture the directions lie in the middle, and fill it if that may zoom. `None` without directions in
/// front of it.
fn framed(old: &Pinhole, content: &Content<'_>, directions: &[DVec3]) -> Option<Pinhole> {
    let Projection::Perspective { .. } = old.projection else { return None };
    let looking = |forward: DVec3, projection: Projection| {
        Pinhole::look_at(old.eye, old.eye + forward, content.up, projection, old.image, old.near, old.far).ok()
    };
    let mut pinhole = looking(old.forward, old.projection)?;
    let mut half = DVec2::ZERO;
    for _ in 0..ROUNDS {
        let (low, high) = extent(&pinhole, directions)?;
        let middle = 0.5 * (low + high);
        half = 0.5 * (high - low);
        let forward = (pinhole.forward + middle.x * pinhole.right + middle.y * pinhole.down).normalize();
        pinhole = looking(forward, old.projection)?;
    }
    if !content.may_zoom {
        return Some(pinhole);
    }
    let [width, height] = old.image.map(f64::from);
    let own = half_tangent(old);
    let wanted = half.y.max(half.x * height / width) / FITTED;
    let tangent = wanted.clamp(ZOOM[0] * own, ZOOM[1] * own).min(WIDEST.max(own));
    looking(pinhole.forward, Projection::Perspective { fov_y: 2.0 * tangent.atan() })
}

/// The box around directions on the picture plane, as tangents to the right and down.
fn extent(pinhole: &Pinhole, directions: &[DVec3]) -> Option<(DVec2, DVec2)> {
    let tangents = directions.iter().filter_map(|d| {
        let ahead = d.dot(pinhole.forward);
        let t = DVec2::new(d.dot(pinhole.right), d.dot(pinhole.down)) / ahead;
        (ahead > 0.0 && t.abs().max_element() < FARTHEST).then_some(t)
    });
    let empty = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (low, high) = tangents.fold(empty, |(low, high), t| (low.min(t), high.max(t)));
    (low.cmple(high).all()).then_some((low, high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rays::Target;
    use belvedere_core::Aabb;
    use belvedere_scene::{BoxLayer, BoxShape, Color, Layer, Scene, Unit};

    /// A row of slabs, a target behind them, and the eye in front of them.
    fn scene() -> Scene {
        let slab = |y: f64, size: DVec3, z: f64| {
            let base = DVec3::new(0.0, y, z);
            BoxShape { base, size, yaw: 0.0, color: Color::rgb(200, 200, 200) }
        };
        let wall = BoxLayer::new(vec![slab(0.0, DVec3::new(60.0, 2.0, 40.0), 0.0)]);
        let low = BoxLayer::new(vec![slab(40.0, DVec3::new(50.0, 2.0, 12.0), 28.0)]);
        let layer = |id: &str, boxes: BoxLayer| Layer { id: id.into(), must_see: false, kind: boxes.into() };
        Scene { layers: vec![layer("wall", wall), layer("low", low)], unit: Unit::Angstrom, ..Scene::default() }
    }

    fn base(image: [u32; 2]) -> View {
        let (eye, look) = (DVec3::new(0.0, -150.0, 22.0), DVec3::new(0.0, 20.0, 20.0));
        let lens = Projection::Perspective { fov_y: 0.45 };
        View::straight(Pinhole::look_at(eye, look, DVec3::Z, lens, image, 1.0, None).unwrap())
    }

    /// A bend by which everything moves up in the picture, partly out of it.
    fn over() -> Sidestep {
        Sidestep { offset: DVec3::new(0.0, 0.0, -16.0), planes: [20.0, 70.0, 120.0] }
    }

    fn points(scene: &Scene) -> Vec<DVec3> {
        scene.layers.iter().flat_map(|l| l.bounds().corners()).collect()
    }

    /// Images as shares of the picture.
    fn images(view: &View, points: &[DVec3]) -> Vec<DVec2> {
        let size = DVec2::from(view.pinhole().image.map(f64::from));
        points.iter().map(|p| view.project(*p).unwrap().pixel / size).collect()
    }

    /// Shares of the picture beside images: left, above, right, below.
    fn margins(images: &[DVec2]) -> [f64; 4] {
        let all = Aabb::of(images.iter().map(|p| p.extend(0.0)));
        [all.min.x, all.min.y, 1.0 - all.max.x, 1.0 - all.max.y]
    }

    fn are_even([left, above, right, below]: [f64; 4]) -> bool {
        (left - right).abs() < 0.01 && (above - below).abs() < 0.01
    }

    #[test]
    fn all_that_a_bend_moved_lies_inside_with_an_even_margin_in_every_shape_of_picture() {
        let scene = scene();
        let points = points(&scene);
        let target = Target::layer(&scene, 1).unwrap();
        let sight = TargetSight::new(&scene, &target);
        for image in [[640, 360], [360, 640], [500, 500], [1200, 200]] {
            let base = base(image);
            let before = over().view(&base).unwrap();
            assert!(margins(&images(&before, &points)).iter().any(|m| *m < 0.0), "cut off before: {image:?}");
            let content = Content { points: &points, up: DVec3::Z, may_zoom: true };
            let found = refit(&sight, &base, Some(&over()), &content).unwrap();
            let after = over().seen_by(base.pinhole(), &found.straight).unwrap();
            let bent = images(&after, &points);
            let beside = margins(&bent);
            assert!(beside.iter().all(|m| *m > 0.039), "{image:?} {beside:?}");
            assert!(beside.iter().any(|m| *m < 0.041), "as large as it can be: {image:?} {beside:?}");
            // Where the target would leave the straight picture, its place there counts, too.
            let with_target = [bent, images(&found.straight, &target.points)].concat();
            assert!(are_even(beside) || are_even(margins(&with_target)), "{image:?} {beside:?}");
            assert!(found.record.outside[0] > 0.0 && found.record.outside[1] == 0.0, "{:?}", found.record);
            assert!(sight.share(&after, 0.0) >= sight.share(&before, 0.0));
        }
    }

    #[test]
    fn the_bend_stays_where_it_was_in_space() {
        let scene = scene();
        let (base, points) = (base([640, 360]), points(&scene));
        let target = Target::layer(&scene, 1).unwrap();
        let sight = TargetSight::new(&scene, &target);
        let content = Content { points: &points, up: DVec3::Z, may_zoom: true };
        let found = refit(&sight, &base, Some(&over()), &content).unwrap();
        assert!(found.record.turned_deg > 1.0, "{:?}", found.record);
        let before = over().view(&base).unwrap();
        let after = over().seen_by(base.pinhole(), &found.straight).unwrap();
        for p in &points {
            let [a, b] = [&before, &after].map(|view| view.displace(*p).unwrap().point);
            assert!(a.distance(b) < 1e-9, "{p}: {a} {b}");
        }
        assert!(found.straight.pinhole().right.z.abs() < 1e-12, "level");
    }

    #[test]
    fn a_field_of_view_that_was_asked_for_stays() {
        let scene = scene();
        let (base, points) = (base([640, 360]), points(&scene));
        let target = Target::layer(&scene, 1).unwrap();
        let content = Content { points: &points, up: DVec3::Z, may_zoom: false };
        let found = refit(&TargetSight::new(&scene, &target), &base, Some(&over()), &content).unwrap();
        let [before, after] = found.record.fov_y_deg;
        assert!((before - after).abs() < 1e-12 && found.record.turned_deg > 1.0, "{:?}", found.record);
    }
}
