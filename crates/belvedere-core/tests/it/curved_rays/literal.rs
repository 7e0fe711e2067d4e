//! The paper's constructions, with planes, lines and their intersections only, against the closed form.
//!
//! Nothing here uses phi, m or the forms a and b: reference arcs are quadratic Bezier curves, other arcs their images from
//! the centre A with the axis through both viewpoints, projections go through the intermediate viewpoint R.

use super::cameras::{self, Spec, pinhole};
use belvedere_core::map::curved_rays::{Model, Pencil, TurnSpec};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_testkit::Random;
use belvedere_testkit::laws::Similarity;

/// Point and unit normal.
#[derive(Clone, Copy)]
struct Plane(DVec3, DVec3);

impl Plane {
    fn of(turn: &TurnSpec, point: DVec3) -> Self {
        match turn.pencil {
            Pencil::Parallel { normal } => Self(point, normal.normalize()),
            Pencil::Line { point: on, dir } => Self(point, (point - on).cross(dir).normalize()),
        }
    }

    fn meet(self, p: DVec3, q: DVec3) -> DVec3 {
        let d = q - p;
        p + d * ((self.0 - p).dot(self.1) / d.dot(self.1))
    }
}

/// Where two lines of one plane meet: the point of p1 q1 nearest to p2 q2.
fn meet_lines(p1: DVec3, q1: DVec3, p2: DVec3, q2: DVec3) -> DVec3 {
    let (d1, d2) = (q1 - p1, q2 - p2);
    let n = d1.cross(d2);
    p1 + d1 * ((p2 - p1).cross(d2).dot(n) / n.length_squared())
}

/// The control points of the ray with direction towards `s`, a point of t1.
fn control_points(before: DVec3, turn: &TurnSpec, s: DVec3) -> [DVec3; 3] {
    [Plane::of(turn, turn.t0).meet(before, s), s, Plane::of(turn, turn.t2).meet(turn.viewpoint, s)]
}

fn bezier([t, s, q]: [DVec3; 3], u: f64) -> DVec3 {
    t.lerp(s, u).lerp(s.lerp(q, u), u)
}

/// The reference ray in the epipolar plane of `p`: it meets t1 on the parallel to the common line through the bend point.
fn reference_s(before: DVec3, turn: &TurnSpec, p: DVec3) -> DVec3 {
    let Pencil::Line { dir, .. } = turn.pencil else { panic!("a common line is needed") };
    Plane(before, (turn.viewpoint - before).cross(p - before).normalize()).meet(turn.t1, turn.t1 + dir)
}

/// Centre A of the epipolar plane of `p`.
fn center_a(before: DVec3, turn: &TurnSpec, p: DVec3) -> DVec3 {
    let Pencil::Line { point, dir } = turn.pencil else { panic!("a common line is needed") };
    Plane(before, (turn.viewpoint - before).cross(p - before).normalize()).meet(point, point + dir)
}

/// A point of the modified ray through `s`: image of the reference arc's point under the homology with centre A, axis C'C, that takes S_n to S.
fn modified_point(before: DVec3, turn: &TurnSpec, s: DVec3, u: f64) -> DVec3 {
    let s_n = reference_s(before, turn, s);
    if (s_n - s).length() < 1e-9 * s.length() {
        return bezier(control_points(before, turn, s), u);
    }
    let reference = control_points(before, turn, s_n);
    let p_n = bezier(reference, u);
    // Any pair of corresponding points will do that is not in line with A and P_n; S at mid-arc is in line.
    let (from, to) = if (u - 0.5).abs() < 0.2 { (reference[0], control_points(before, turn, s)[0]) } else { (s_n, s) };
    let z = meet_lines(from, p_n, before, turn.viewpoint);
    meet_lines(z, to, center_a(before, turn, s), p_n)
}

/// The paper's projection of a point between t0 and t2: the point S of t1 whose ray passes through it.
fn projected_to_t1(before: DVec3, turn: &TurnSpec, x: DVec3) -> DVec3 {
    let Pencil::Line { point, dir } = turn.pencil else { panic!("a common line is needed") };
    let reference = control_points(before, turn, reference_s(before, turn, x));
    // 1. The plane of the pencil through X meets the reference arc in P_n.
    let t_s = Plane(point, (x - point).cross(dir).normalize());
    let side = |u: f64| (bezier(reference, u) - t_s.0).dot(t_s.1);
    let (mut low, mut high) = (0.0, 1.0);
    let sign = side(low).signum();
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if side(middle) * sign > 0.0 { low = middle } else { high = middle }
    }
    let p_n = bezier(reference, 0.5 * (low + high));
    // 2. P_n Q_n meets the line of the viewpoints in the intermediate viewpoint R.
    let r = meet_lines(p_n, reference[2], before, turn.viewpoint);
    // 3. From R onto t2, 4. from C onto t1.
    let q = Plane::of(turn, turn.t2).meet(r, x);
    Plane::of(turn, turn.t1).meet(turn.viewpoint, q)
}

/// Pixel of a point of t1 of turn `j`: back through the earlier viewpoints, whose image planes are the t1.
fn pixel_of(spec: &Spec, j: usize, mut s: DVec3) -> DVec2 {
    for i in (0..j).rev() {
        s = Plane::of(&spec.turns[i], spec.turns[i].t1).meet(spec.turns[i].viewpoint, s);
    }
    pinhole(&Similarity::IDENTITY, DVec3::ZERO, DVec3::Y).project(s).unwrap().0
}

/// Viewpoints before turn `j`, and the point of t1 of turn `j` that a pixel sees.
fn s_of_pixel(spec: &Spec, j: usize, pixel: DVec2) -> (DVec3, DVec3) {
    let root = pinhole(&Similarity::IDENTITY, DVec3::ZERO, DVec3::Y);
    let (mut eye, mut s) = (DVec3::ZERO, root.unproject(pixel, 1.0));
    for (i, turn) in spec.turns.iter().enumerate().take(j + 1) {
        s = Plane::of(turn, turn.t1).meet(eye, s);
        if i < j {
            eye = turn.viewpoint;
        }
    }
    (eye, s)
}

fn pixels(seed: u64, count: usize) -> impl Iterator<Item = DVec2> {
    let mut random = Random::new(seed);
    (0..count).map(move |_| DVec2::new(random.range(0.0, 1280.0), random.range(0.0, 720.0)))
}

fn assert_sees(view: &View, pixel: DVec2, x: DVec3, segment: usize, limit_px: f64) {
    let image = view.project(x).unwrap();
    let error = (image.pixel - pixel).length();
    assert!(error < limit_px, "{x}: pixel {} instead of {pixel}, {error:e} px off", image.pixel);
    assert_eq!(image.segment as usize, segment, "at {x}");
}

#[test]
fn modified_arcs_are_the_perspective_images_of_the_reference_arc() {
    for spec in [cameras::street_corner(), cameras::zigzag(), cameras::long_bend()] {
        let view = spec.view(Model::Modified, &Similarity::IDENTITY);
        for j in 0..spec.turns.len() {
            for pixel in pixels(11 + j as u64, 60) {
                let (eye, s) = s_of_pixel(&spec, j, pixel);
                for u in [0.02, 0.3, 0.5, 0.77, 0.98] {
                    let x = modified_point(eye, &spec.turns[j], s, u);
                    assert_sees(&view, pixel, x, 2 * j + 1, 1e-8);
                }
            }
        }
    }
}

#[test]
fn modified_projection_is_the_one_through_the_intermediate_viewpoint() {
    for spec in [cameras::street_corner(), cameras::zigzag(), cameras::long_bend()] {
        let view = spec.view(Model::Modified, &Similarity::IDENTITY);
        for (j, turn) in spec.turns.iter().enumerate() {
            for pixel in pixels(21 + j as u64, 60) {
                let ray = view.ray(pixel);
                let depth = ray.pieces().unwrap()[2 * j + 1].depth;
                let mut random = Random::new(pixel.x.to_bits());
                let x = ray.at(random.range(depth[0], depth[1])).unwrap().point;
                let eye = if j == 0 { DVec3::ZERO } else { spec.turns[j - 1].viewpoint };
                let again = pixel_of(&spec, j, projected_to_t1(eye, turn, x));
                assert!((again - pixel).length() < 1e-7, "turn {j}: {pixel} came back as {again}");
            }
        }
    }
}

/// R as constructed: the reference arc's point in a plane of the pencil, joined with the arc's end on t2, meets the line of the viewpoints.
#[test]
fn intermediate_viewpoints_are_those_of_the_construction() {
    for spec in [cameras::street_corner(), cameras::zigzag(), cameras::long_bend()] {
        let view = spec.view(Model::Modified, &Similarity::IDENTITY);
        let rays = view.curved_rays().unwrap();
        for (j, turn) in spec.turns.iter().enumerate() {
            let eye = if j == 0 { DVec3::ZERO } else { spec.turns[j - 1].viewpoint };
            let made = &rays.turns()[j];
            let mut last = 0.0;
            for pixel in pixels(61 + j as u64, 40) {
                let reference = control_points(eye, turn, reference_s(eye, turn, s_of_pixel(&spec, j, pixel).1));
                for u in [0.03, 0.3, 0.5, 0.8, 0.97] {
                    let p_n = bezier(reference, u);
                    let (a, b) = (made.a.at(p_n), made.b.at(p_n));
                    let expected = meet_lines(p_n, reference[2], eye, turn.viewpoint);
                    let found = made.intermediate_viewpoint(a / (a + b)).unwrap();
                    let baseline = eye.distance(turn.viewpoint);
                    assert!(found.distance(expected) < 1e-6 * baseline, "turn {j}, {u}: {found} is not {expected}");
                }
            }
            for k in 0..=20 {
                let r = made.intermediate_viewpoint(f64::from(k) / 20.0).unwrap();
                let share = (r - eye).dot(turn.viewpoint - eye) / (turn.viewpoint - eye).length_squared();
                assert!(share > last && share <= 1.0 + 1e-12, "turn {j}, {k}: {share} after {last}");
                last = share;
            }
            assert!((last - 1.0).abs() < 1e-12);
        }
        for model in [Model::C0, Model::Original] {
            let view = spec.view(model, &Similarity::IDENTITY);
            assert_eq!(view.curved_rays().unwrap().turns()[0].intermediate_viewpoint(0.5), None, "{model:?}");
        }
    }
}

#[test]
fn original_arcs_are_bezier_arcs() {
    for spec in [cameras::street_corner(), cameras::sideways(), cameras::zigzag(), cameras::long_bend()] {
        let view = spec.view(Model::Original, &Similarity::IDENTITY);
        for j in 0..spec.turns.len() {
            for pixel in pixels(31 + j as u64, 60) {
                let (eye, s) = s_of_pixel(&spec, j, pixel);
                for u in [0.02, 0.3, 0.5, 0.77, 0.98] {
                    let x = bezier(control_points(eye, &spec.turns[j], s), u);
                    assert_sees(&view, pixel, x, 2 * j + 1, 1e-8);
                }
            }
        }
    }
}

/// With parallel planes both models are one, as the paper's construction also says (A at infinity).
#[test]
fn models_agree_for_parallel_planes() {
    let spec = cameras::sideways();
    let [modified, original] = [Model::Modified, Model::Original].map(|m| spec.view(m, &Similarity::IDENTITY));
    for pixel in pixels(41, 200) {
        for depth in [61.0, 70.0, 80.0, 95.0, 130.0] {
            let (a, b) = (modified.ray(pixel).at(depth).unwrap(), original.ray(pixel).at(depth).unwrap());
            assert!((a.point - b.point).length() < 1e-10, "{pixel} {depth}: {} {}", a.point, b.point);
        }
    }
}

/// Numeric projection as in the paper: bisection for the ray through X among the Bezier rays of X's epipolar plane.
#[test]
fn original_projection_agrees_with_bisection() {
    let spec = cameras::street_corner();
    let turn = &spec.turns[0];
    let Pencil::Line { point, dir } = turn.pencil else { panic!("a line") };
    let view = spec.view(Model::Original, &Similarity::IDENTITY);
    let t1 = Plane::of(turn, turn.t1);
    let mut checked = 0;
    for pixel in pixels(51, 300) {
        let depth = view.ray(pixel).pieces().unwrap()[1].depth;
        let x = view.ray(pixel).at(0.4 * depth[0] + 0.6 * depth[1]).unwrap().point;
        // The ray meets t1 beyond the straight ray of the viewpoint on whose side of t1 X lies, as seen from the other viewpoint's.
        let straight = [DVec3::ZERO, turn.viewpoint].map(|eye| t1.meet(eye, x));
        let before_t1 = (x - t1.0).dot(t1.1) * (DVec3::ZERO - t1.0).dot(t1.1) > 0.0;
        let (mut low, other) = if before_t1 { (straight[0], straight[1]) } else { (straight[1], straight[0]) };
        let mut high = low + 1.5 * (low - other).length().max(10.0) * (low - other).normalize();
        let t_s = Plane(point, (x - point).cross(dir).normalize());
        let across = high - low;
        let beside = |s: DVec3| {
            let arc = control_points(DVec3::ZERO, turn, s);
            let side = |u: f64| (bezier(arc, u) - t_s.0).dot(t_s.1);
            let (mut u0, mut u1) = (0.0, 1.0);
            let sign = side(0.0).signum();
            for _ in 0..60 {
                let middle = 0.5 * (u0 + u1);
                if side(middle) * sign > 0.0 { u0 = middle } else { u1 = middle }
            }
            (bezier(arc, 0.5 * (u0 + u1)) - x).dot(across)
        };
        let sign = beside(low).signum();
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if beside(middle) * sign > 0.0 { low = middle } else { high = middle }
        }
        let found = pixel_of(&spec, 0, 0.5 * (low + high));
        let projected = view.project(x).unwrap().pixel;
        assert!((found - projected).length() < 1e-8, "{projected}, bisection says {found}");
        checked += 1;
    }
    assert_eq!(checked, 300);
}

/// The straight parts: a pinhole at each viewpoint with the pixel grid that the one before draws on t1; depth grows with
/// the factor by which the new viewpoint sees t1 nearer or farther.
#[test]
fn straight_parts_are_pinholes_through_the_grid_on_t1() {
    for spec in [cameras::street_corner(), cameras::sideways(), cameras::zigzag(), cameras::long_bend()] {
        for model in [Model::Modified, Model::Original, Model::C0, Model::C2, Model::Circular] {
            let view = spec.view(model, &Similarity::IDENTITY);
            for pixel in pixels(61, 20) {
                for j in 0..spec.turns.len() {
                    let (_, s) = s_of_pixel(&spec, j, pixel);
                    let ray = view.ray(pixel);
                    let straight = ray.pieces().unwrap().into_iter().find(|p| p.segment as usize == 2 * j + 2).unwrap();
                    for depth in [straight.depth[0] * 1.001, (straight.depth[1] * 0.999).min(3e3)] {
                        let x = ray.at(depth).unwrap().point;
                        let eye = spec.turns[j].viewpoint;
                        let off = (x - eye).normalize().cross((s - eye).normalize()).length();
                        assert!(off < 1e-11, "{model:?} turn {j} pixel {pixel}: {off:e}");
                    }
                }
            }
        }
    }
}
