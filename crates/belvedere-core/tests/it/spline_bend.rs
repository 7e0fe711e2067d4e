//! Laws of the spline bend, and its printed formulas evaluated by brute force.

use crate::spline_curve::{by_basis, dense_lengths};
use crate::spline_figures::{bend, camera_at};
use belvedere_core::bspline::BSpline;
use belvedere_core::map::spline::{ReferencePlane, SplineBend, default_pivot, viewing_angle};
use belvedere_core::presets::{BendFrame, DepthUnits, PresetDocument};
use belvedere_core::{Aabb, DVec2, DVec3, Pinhole, Projection, SpaceMap, Stage, View};
use belvedere_testkit::Random;
use belvedere_testkit::laws::{CameraCase, Continuity, Joint, MapCase, Similarity};

const EYE: DVec3 = DVec3::new(120.0, -780.0, 690.0);
const TARGET: DVec3 = DVec3::new(-40.0, 60.0, 15.0);
const FIVE: [&str; 5] = ["progressive", "degressive", "hybrid-flat-steep-flat", "hybrid-steep-flat-steep", "map"];

fn moved_camera(s: &Similarity) -> Pinhole {
    let projection = Projection::Perspective { fov_y: 50f64.to_radians() };
    let (eye, target, up) = (s.point(EYE), s.point(TARGET), s.direction(DVec3::Z));
    Pinhole::look_at(eye, target, up, projection, [1280, 720], s.length(1.0), None).unwrap()
}

fn moved_bend(s: &Similarity, document: &PresetDocument) -> SplineBend {
    let normal = s.direction(DVec3::Z);
    let plane = ReferencePlane::new(normal, s.point(TARGET).dot(normal)).unwrap();
    let mut document = document.clone();
    if document.units == DepthUnits::Absolute {
        for p in &mut document.presets {
            (p.s, p.e) = (s.length(p.s), s.length(p.e));
        }
    }
    SplineBend::new(&moved_camera(s), &document, &plane, s.point(TARGET)).unwrap()
}

fn bend_case(name: &'static str, frame: BendFrame, continuity: Continuity) -> MapCase<SplineBend> {
    let document = PresetDocument { frame, ..PresetDocument::builtin(name).unwrap() };
    let plain = moved_bend(&Similarity::IDENTITY, &document);
    let region = Aabb::of([DVec3::new(-3e3, -3e3, -200.0), DVec3::new(3e3, 5e3, 400.0)]);
    let ends = [0.0, plain.curve().length()].map(|l| {
        let back = plain.coordinates(plain.pivot()).l;
        let ahead = (TARGET - EYE).with_z(0.0).normalize();
        Joint { point: plain.pivot() + (l - back) * plain.scale() * ahead, across: ahead }
    });
    let camera = moved_camera(&Similarity::IDENTITY);
    MapCase::new(format!("{name} {frame:?}"), region, move |s| moved_bend(s, &document))
        .continuity(continuity)
        .joints(ends)
        .domain(0.25, |map, p| {
            let ([low, high], d) = (map.fold_heights(), map.coordinates(p).d);
            d > 0.8 * low && d < 0.8 * high
        })
        .identity_at_zero_strength(move || {
            let phi = viewing_angle(&camera, &ReferencePlane::level(TARGET.z)).to_degrees();
            moved_bend(&Similarity::IDENTITY, &PresetDocument::builtin(&format!("identity({phi})")).unwrap())
        })
}

belvedere_testkit::space_map_laws!(
    progressive,
    super::bend_case("progressive", super::BendFrame::Camera, super::Continuity::C1)
);
belvedere_testkit::space_map_laws!(
    degressive_in_plane,
    super::bend_case("degressive", super::BendFrame::Plane, super::Continuity::C1)
);
// Doubled control points leave the curve without curvature at its ends.
belvedere_testkit::space_map_laws!(
    hybrid,
    super::bend_case("hybrid-flat-steep-flat", super::BendFrame::Camera, super::Continuity::C2)
);

fn view_case(name: &'static str, share: f64) -> CameraCase {
    let document = PresetDocument::builtin("demo").unwrap();
    CameraCase::new(name, [200.0, 6000.0], move |s| {
        let view = View::new(moved_camera(s), vec![Stage::SplineBend(moved_bend(s, &document))]).unwrap();
        view.eased(share).unwrap()
    })
    .tolerance_px(1e-8)
    .least_share(0.99)
}

belvedere_testkit::camera_laws!(view, super::view_case("demo preset", 1.0));
belvedere_testkit::camera_laws!(half_bent, super::view_case("demo preset, half bent", 0.5));

/// The formulas of the paper as our specification writes them, with arc length from a hundred thousand samples.
struct Literal {
    camera: Pinhole,
    origin: DVec3,
    s: f64,
    e: f64,
    frame: BendFrame,
    pin: bool,
    spline: BSpline,
    lengths: Vec<f64>,
}

impl Literal {
    fn curve(&self, l: f64) -> (DVec2, DVec2) {
        let samples = self.lengths.len() - 1;
        let length = self.lengths[samples];
        let at = |t: f64| by_basis(self.spline.control(), self.spline.knots(), t);
        let tangent = |t: f64| self.spline.derivative(1, t).normalize();
        if l < 0.0 {
            return (at(0.0) + l * tangent(0.0), tangent(0.0));
        }
        if l > length {
            return (at(1.0) + (l - length) * tangent(1.0), tangent(1.0));
        }
        let i = (self.lengths.partition_point(|&x| x <= l) - 1).min(samples - 1);
        let start = i as f64 / samples as f64;
        let speed = |t: f64| self.spline.derivative(1, t).length();
        let (mut lo, mut hi) = (0.0, 1.0 / samples as f64);
        for _ in 0..60 {
            let w = 0.5 * (lo + hi);
            let piece = w / 6.0 * (speed(start) + 4.0 * speed(start + 0.5 * w) + speed(start + w));
            if self.lengths[i] + piece < l { lo = w } else { hi = w }
        }
        (at(start + lo), tangent(start + lo))
    }

    fn apply(&self, v: DVec3) -> DVec3 {
        let (c, n) = (self.camera.forward, DVec3::Z);
        let r = c.cross(n).normalize();
        let f = n.cross(r);
        let y = r.cross(c);
        let z_o = (self.origin - self.camera.eye).dot(c);
        let (a, b, d) = ((v - self.origin).dot(r), (v - self.origin).dot(f), (v - self.origin).dot(n));
        let z = z_o + b;
        let k = self.e - self.s;
        let l = (z - self.s) / k;
        let (p, t) = self.curve(l);
        let mut q = p + d / k * DVec2::new(-t.y, t.x);
        if self.pin {
            let l_o = (z_o - self.s) / k;
            q += DVec2::new(l_o, 0.0) - self.curve(l_o).0;
        }
        let (up, ahead) = if self.frame == BendFrame::Camera { (y, c) } else { (n, f) };
        self.origin + a * r + k * q.y * up + (self.s + k * q.x - z_o) * ahead
    }
}

#[test]
fn displacement_agrees_with_the_literal_formula_to_a_nanometre() {
    let mut random = Random::new(21);
    for name in FIVE {
        for (frame, pin) in [(BendFrame::Camera, true), (BendFrame::Camera, false), (BendFrame::Plane, true)] {
            let mut document = PresetDocument { frame, pin, follow: false, ..PresetDocument::builtin(name).unwrap() };
            document.units = DepthUnits::Absolute;
            (document.presets[0].s, document.presets[0].e) = (430.0, 1750.0);
            let camera = moved_camera(&Similarity::IDENTITY);
            let plane = ReferencePlane::level(15.0);
            let map = SplineBend::new(&camera, &document, &plane, TARGET + 33.0 * DVec3::Z).unwrap();
            let spline = document.presets[0].spline().unwrap();
            let lengths = dense_lengths(&spline, 99_999);
            let literal = Literal { camera, origin: TARGET, s: 430.0, e: 1750.0, frame, pin, spline, lengths };
            for _ in 0..300 {
                let p = DVec3::new(random.range(-2e3, 2e3), random.range(-2e3, 3e3), random.range(-300.0, 600.0));
                let error = (map.apply(p).unwrap() - literal.apply(p)).length();
                assert!(error < 1e-9, "{name} {frame:?} pin {pin}: {p} off by {error:e} m");
            }
        }
    }
}

#[test]
fn a_straight_curve_of_the_viewing_angle_is_the_ordinary_perspective() {
    let mut random = Random::new(3);
    for phi_deg in [8.0, 30.0, 57.0, 90.0] {
        for distance in [300.0, 1000.0] {
            let camera = camera_at(phi_deg, distance);
            let map = bend(&PresetDocument::builtin(&format!("identity({phi_deg})")).unwrap(), &camera);
            let flat = bend(&PresetDocument::builtin("identity").unwrap(), &camera);
            for _ in 0..500 {
                let p = DVec3::new(random.range(-1e3, 1e3), random.range(-1e3, 3e3), random.range(-200.0, 600.0));
                for map in [&map, &flat] {
                    let error = (map.apply(p).unwrap() - p).length();
                    assert!(error < 1e-10, "phi {phi_deg}, D {distance}: {p} moved by {error:e} m");
                }
            }
        }
    }
}

#[test]
fn the_pivot_stays_where_it_is_if_and_only_if_the_curve_is_pinned() {
    let mut document = PresetDocument::builtin("demo").unwrap();
    for phi_deg in [3.0, 25.0, 33.0, 42.0, 61.0, 80.0, 88.0, 90.0] {
        let camera = camera_at(phi_deg, 900.0);
        let pinned = bend(&document, &camera);
        let error = (pinned.apply(pinned.pivot()).unwrap() - pinned.pivot()).length();
        assert!(error < 1e-10, "pivot moved by {error:e} m at {phi_deg} degrees");
    }
    document.pin = false;
    let free = bend(&document, &camera_at(25.0, 900.0));
    assert!((free.apply(free.pivot()).unwrap() - free.pivot()).length() > 1.0);
}

#[test]
fn lengths_along_the_ground_are_kept() {
    for name in FIVE {
        for frame in [BendFrame::Camera, BendFrame::Plane] {
            let document = PresetDocument { frame, ..PresetDocument::builtin(name).unwrap() };
            let map = bend(&document, &camera_at(35.0, 1000.0));
            let (mut last, step) = (map.apply(DVec3::new(0.0, -2000.0, 0.0)).unwrap(), 0.02);
            let mut worst = 0.0f64;
            for i in 1..=250_000 {
                let now = map.apply(DVec3::new(0.0, -2000.0 + step * f64::from(i), 0.0)).unwrap();
                worst = worst.max(((now - last).length() / step - 1.0).abs());
                last = now;
            }
            assert!(worst < 1e-7, "{name} {frame:?}: lengths off by {worst:e}");
        }
    }
}

#[test]
fn position_and_direction_are_continuous_where_the_curve_ends() {
    for name in FIVE {
        let map = bend(&PresetDocument::builtin(name).unwrap(), &camera_at(35.0, 1000.0));
        let start = map.coordinates(map.pivot()).l;
        for l in [0.0, map.curve().length()] {
            for d in [0.0, 60.0, -60.0] {
                let at = |h: f64| map.apply(DVec3::new(30.0, (l - start) * map.scale() + h, d)).unwrap();
                let jump = (at(1e-9) - at(-1e-9)).length();
                assert!(jump < 1e-8, "{name}: jump of {jump:e} m at l = {l}, height {d}");
                let directions = [at(1e-2) - at(1e-9), at(-1e-9) - at(-1e-2)].map(DVec3::normalize);
                let kink_deg = directions[0].angle_between(directions[1]).to_degrees();
                assert!(kink_deg < 0.05, "{name}: kink of {kink_deg} degrees at l = {l}, height {d}");
            }
        }
    }
}

#[test]
fn folds_are_where_finite_differences_turn_round() {
    let mut random = Random::new(8);
    for name in FIVE {
        let map = bend(&PresetDocument::builtin(name).unwrap(), &camera_at(35.0, 300.0));
        let [low, high] = map.fold_heights();
        let mut folded = 0;
        for _ in 0..4000 {
            let p = DVec3::new(0.0, random.range(-300.0, 900.0), random.range(-500.0, 500.0));
            let h = 1e-4;
            let step = map.apply(p + h * DVec3::Y).unwrap() - map.apply(p - h * DVec3::Y).unwrap();
            let tangent = map.apply(p.with_z(h)).unwrap() - map.apply(p.with_z(0.0)).unwrap();
            let along = tangent.cross(DVec3::X).normalize();
            let stretch = step.dot(along) / (2.0 * h);
            let kink = (map.stretch(p + h * DVec3::Y) - map.stretch(p - h * DVec3::Y)).abs();
            if stretch.abs() < 1e-3 || kink > 1e-3 {
                continue;
            }
            assert!((stretch - map.stretch(p)).abs() < 1e-3 * (1.0 + stretch.abs()), "{name}: {stretch} at {p}");
            assert_eq!(map.is_folded(p), stretch < 0.0, "{name} at {p}");
            if map.is_folded(p) {
                folded += 1;
                assert!(p.z < low || p.z > high, "{name}: folded at {p}, limits {low}..{high}");
            }
            let det = map.jacobian(p).unwrap().determinant();
            assert!((det - map.stretch(p)).abs() < 1e-12 * (1.0 + det.abs()), "{name}: det {det}");
        }
        assert!(folded > 20 || name == "map", "{name}: only {folded} folded points were tried");
    }
}

#[test]
fn inverse_answers_beyond_the_fold_with_a_point_of_the_same_image() {
    let mut random = Random::new(9);
    for name in FIVE {
        let map = bend(&PresetDocument::builtin(name).unwrap(), &camera_at(35.0, 1000.0));
        for _ in 0..2000 {
            let q = DVec3::new(random.range(-1e3, 1e3), random.range(-2e3, 4e3), random.range(-3e3, 3e3));
            let p = map.invert(q).unwrap();
            assert!(!map.is_folded(p), "{name}: {p}");
            let error = (map.apply(p).unwrap() - q).length();
            assert!(error < 1e-10, "{name}: image of the inverse of {q} off by {error:e} m");
        }
    }
}

#[test]
fn following_tilts_the_picture_above_the_last_plateau_only() {
    let mut document = PresetDocument::builtin("demo").unwrap();
    let camera = camera_at(89.0, 1000.0);
    let follows = bend(&document, &camera);
    assert!((follows.resolved().follow_deg - 9.0).abs() < 1e-9);
    // Above the end of the plateau the deformed world no longer changes.
    let at_end = bend(&document, &camera_at(80.0, 1000.0));
    assert_eq!(at_end.resolved().follow_deg, 0.0);
    for p in [DVec3::new(10.0, 300.0, 20.0), DVec3::new(-200.0, -250.0, 5.0)] {
        let error = (follows.apply(p).unwrap() - at_end.apply(p).unwrap()).length();
        assert!(error < 1e-9, "{p} moves by {error:e}");
    }
    document.follow = false;
    assert!(
        (bend(&document, &camera).apply(DVec3::Y * 300.0).unwrap() - at_end.apply(DVec3::Y * 300.0).unwrap()).length()
            > 1.0
    );
}

#[test]
fn nadir_and_level_cameras_have_a_heading_and_a_pivot() {
    let projection = Projection::Perspective { fov_y: 50f64.to_radians() };
    let look =
        |eye: DVec3, at: DVec3, up: DVec3| Pinhole::look_at(eye, at, up, projection, [640, 480], 1.0, None).unwrap();
    let plane = ReferencePlane::level(100.0);
    let document = PresetDocument::builtin("demo").unwrap();

    let down = look(DVec3::new(5.0, 6.0, 700.0), DVec3::new(5.0, 6.0, 0.0), DVec3::new(0.6, 0.8, 0.0));
    assert_eq!(default_pivot(&down, &plane), DVec3::new(5.0, 6.0, 100.0));
    assert!((viewing_angle(&down, &plane).to_degrees() - 90.0).abs() < 1e-12);
    let map = bend_over(&down, &document, &plane);
    let ahead = map.apply(DVec3::new(5.6, 6.8, 100.0)).unwrap() - map.apply(DVec3::new(5.0, 6.0, 100.0)).unwrap();
    assert!(ahead.dot(DVec3::new(0.8, -0.6, 0.0)).abs() < 1e-12, "the hint's heading is kept: {ahead}");

    let eye = DVec3::new(0.0, 0.0, 400.0);
    for (pitch_deg, hits) in [(5.1, true), (4.9, false), (0.0, false), (-30.0, false), (-89.0, false)] {
        let (sin, cos) = f64::to_radians(pitch_deg).sin_cos();
        let camera = look(eye, eye + DVec3::new(0.0, cos, -sin), DVec3::Z);
        let pivot = default_pivot(&camera, &plane);
        let distance = if hits { 300.0 / sin } else { 300.0 / 5f64.to_radians().sin() };
        assert!((pivot.distance(eye) - distance).abs() < 1e-9 && (pivot.z - 100.0).abs() < 1e-9, "pivot {pivot}");
        assert!((viewing_angle(&camera, &plane).to_degrees() - pitch_deg).abs() < 1e-12);
        let map = bend_over(&camera, &document, &plane);
        for p in [DVec3::ZERO, DVec3::new(3.0, 9e3, 50.0), eye] {
            assert!(map.apply(p).unwrap().is_finite());
        }
    }
    let below = look(DVec3::ZERO, DVec3::new(0.0, 1.0, 0.01), DVec3::Z);
    assert!(bend_over(&below, &document, &plane).apply(DVec3::ONE).unwrap().is_finite());
    let on_plane = look(DVec3::new(0.0, 0.0, 100.0), DVec3::new(0.0, 1.0, 100.0), DVec3::Z);
    let error = SplineBend::new(&on_plane, &document, &plane, default_pivot(&on_plane, &plane)).unwrap_err();
    assert!(error.to_string().contains("from the eye"), "{error}");
    let error = SplineBend::new(&down, &document, &plane, DVec3::NAN).unwrap_err();
    assert!(error.to_string().contains("not finite"), "{error}");
}

fn bend_over(camera: &Pinhole, document: &PresetDocument, plane: &ReferencePlane) -> SplineBend {
    SplineBend::new(camera, document, plane, default_pivot(camera, plane)).unwrap()
}

#[test]
fn a_presets_field_of_view_keeps_the_scale_at_the_pivot() {
    let mut document = PresetDocument::builtin("demo").unwrap();
    document.presets[2].fov_y_deg = Some(20.0);
    for (phi_deg, fov_deg) in [(20.0, 50.0), (50.0, 50.0), (65.0, 35.0), (80.0, 20.0)] {
        let camera = camera_at(phi_deg, 1000.0);
        let map = bend(&document, &camera);
        let adapted = map.adapted_pinhole(&camera);
        let Projection::Perspective { fov_y } = adapted.projection else { panic!() };
        assert!((fov_y.to_degrees() - fov_deg).abs() < 1e-9, "{} at {phi_deg}", fov_y.to_degrees());
        let views = [camera, adapted].map(|c| View::new(c, vec![Stage::SplineBend(map.clone())]).unwrap());
        let widths = views.map(|v| {
            let px = |x: f64| v.project(DVec3::new(x, 0.0, 0.0)).unwrap().pixel;
            assert!((px(0.0) - DVec2::new(640.0, 360.0)).length() < 1e-9);
            px(1.0).distance(px(-1.0))
        });
        assert!((widths[0] - widths[1]).abs() < 1e-9, "{widths:?}");
    }
}

#[test]
fn the_picture_moves_without_a_jump_while_the_camera_pitches() {
    let document = PresetDocument::builtin("demo").unwrap();
    let points: Vec<DVec3> = (-6..=12).map(|i| DVec3::new(50.0, 100.0 * f64::from(i), 0.0)).collect();
    let mut last: Option<Vec<Option<DVec2>>> = None;
    let mut worst = 0.0f64;
    for i in 0..=340 {
        let camera = camera_at(5.0 + 0.25 * f64::from(i), 1000.0);
        let view = View::new(camera.clone(), vec![Stage::SplineBend(bend(&document, &camera))]).unwrap();
        let tangents =
            |p: &DVec3| view.project(*p).ok().filter(|i| camera.contains(i.pixel)).map(|i| i.pixel / camera.scale_px());
        let now: Vec<_> = points.iter().map(tangents).collect();
        for (a, b) in last.iter().flatten().zip(&now) {
            if let (Some(a), Some(b)) = (a, b) {
                worst = worst.max(a.distance(*b));
            }
        }
        last = Some(now);
    }
    assert!(worst > 1e-3 && worst < 0.05, "largest motion {worst} per quarter degree");
}
