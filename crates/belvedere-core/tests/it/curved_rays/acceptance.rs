//! The paper's claims about its camera, measured: figures of section 12 of our specification, printed with `--nocapture`.

#![allow(clippy::print_stdout, reason = "figures to read")]

use super::cameras::{self, Spec};
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_testkit::Random;
use belvedere_testkit::laws::Similarity;

const STILL: Similarity = Similarity::IDENTITY;

/// One turn by an angle about a vertical line on the left, 100 units ahead and 1.3 half widths of the picture to the side, where constructors
/// put it; the planes an angle apart, the viewpoints as far from the bend.
fn corner(turn_deg: f64, planes_deg: f64) -> Spec {
    let out = 1.3 * 100.0 * 20f64.to_radians().tan() * 16.0 / 9.0;
    let line = DVec3::new(-out, 100.0, 0.0);
    let half = 0.5 * planes_deg;
    let arm = |angle: f64| line + out * DVec3::new(angle.to_radians().cos(), angle.to_radians().sin(), 0.0);
    let away = DVec3::new(-turn_deg.to_radians().sin(), turn_deg.to_radians().cos(), 0.0);
    let turn = TurnSpec {
        viewpoint: DVec3::new(0.0, 100.0, 0.0) - 100.0 * away,
        t0: arm(-half),
        t1: arm(0.0),
        t2: arm(half),
        pencil: Pencil::Line { point: line, dir: DVec3::Z },
        m: Sharpness::Bend,
    };
    Spec { turns: vec![turn] }
}

/// Points that the picture shows inside the transition.
fn shown(view: &View, random: &mut Random, count: usize) -> Vec<DVec3> {
    let mut out = Vec::new();
    while out.len() < count {
        let pixel = DVec2::new(random.range(0.0, 1280.0), random.range(0.0, 720.0));
        let ray = view.ray(pixel);
        let Ok(pieces) = ray.pieces() else { continue };
        let depth = pieces[1].depth;
        out.extend(ray.at(random.range(depth[0], depth[1])).map(|p| p.point));
    }
    out
}

/// "Modified rays look like the original ones": within a pixel of 1280 x 720 for turns up to 45 degrees with planes up to 30 degrees apart;
/// planes as far apart as a turn of 45 degrees, the largest that can be, make it two in the corners of the picture.
#[test]
fn modified_pictures_are_within_a_pixel_of_original_ones() {
    for (turn_deg, planes_deg, most) in [
        (10.0, 10.0, 1.0),
        (20.0, 20.0, 1.0),
        (30.0, 30.0, 1.0),
        (45.0, 20.0, 1.0),
        (45.0, 30.0, 1.0),
        (45.0, 45.0, 2.0),
    ] {
        let spec = corner(turn_deg, planes_deg);
        let [modified, original] = [Model::Modified, Model::Original].map(|model| spec.view(model, &STILL));
        let points = shown(&modified, &mut Random::new(9), 3000);
        let apart = points
            .iter()
            .filter_map(|&p| Some(modified.project(p).ok()?.pixel.distance(original.project(p).ok()?.pixel)));
        let apart: Vec<f64> = apart.collect();
        let (mean, worst) = (apart.iter().sum::<f64>() / apart.len() as f64, apart.iter().copied().fold(0.0, f64::max));
        println!(
            "modified against original, turn of {turn_deg} degrees, planes {planes_deg} apart: mean {mean:.2} px, worst {worst:.2} px"
        );
        assert!(apart.len() > 2900 && worst <= most, "{turn_deg} degrees: worst {worst} px of {}", apart.len());
        assert!(worst > 0.0, "two models, not one");
    }
}

/// The pinhole matrix (12 numbers of unit norm) that maps points to pixels best: least eigenvector of the direct linear transform.
fn best_pinhole(places: &[DVec3], pixels: &[DVec2]) -> [f64; 12] {
    let mut normal = [[0.0f64; 12]; 12];
    for (p, q) in places.iter().zip(pixels) {
        let x = [p.x, p.y, p.z, 1.0];
        for (axis, value) in [(0, q.x), (1, q.y)] {
            let mut row = [0.0; 12];
            for k in 0..4 {
                row[4 * axis + k] = x[k];
                row[8 + k] = -value * x[k];
            }
            for i in 0..12 {
                for j in 0..12 {
                    normal[i][j] += row[i] * row[j];
                }
            }
        }
    }
    least_eigenvector(normal)
}

/// The eigenvector of the least eigenvalue of a symmetric matrix, by Jacobi rotations.
fn least_eigenvector(mut a: [[f64; 12]; 12]) -> [f64; 12] {
    let mut v: [[f64; 12]; 12] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for _ in 0..60 {
        for p in 0..12 {
            for q in p + 1..12 {
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = 0.5 * (2.0 * a[p][q]).atan2(a[q][q] - a[p][p]);
                let (s, c) = theta.sin_cos();
                for row in &mut a {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                let (mut up, mut uq) = (a[p], a[q]);
                for k in 0..12 {
                    (up[k], uq[k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                }
                (a[p], a[q]) = (up, uq);
                for row in &mut v {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
            }
        }
    }
    let least = (0..12).min_by(|&i, &j| a[i][i].total_cmp(&a[j][j])).unwrap();
    v.map(|row| row[least])
}

/// Largest distance between the images of an object's points and those by the best fitting pinhole, relative to the radius of its image.
fn distortion(view: &View, center: DVec3, half: f64) -> Option<f64> {
    let lattice = (0..125).map(|i| DVec3::new((i % 5) as f64, (i / 5 % 5) as f64, (i / 25) as f64) / 2.0 - 1.0);
    let shape: Vec<DVec3> = lattice.collect();
    let pixels =
        shape.iter().map(|p| view.project(center + half * *p).ok().map(|i| i.pixel)).collect::<Option<Vec<_>>>()?;
    let middle = pixels.iter().sum::<DVec2>() / pixels.len() as f64;
    let radius = pixels.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
    let unit: Vec<DVec2> = pixels.iter().map(|p| (*p - middle) / radius).collect();
    let m = best_pinhole(&shape, &unit);
    let image = |p: &DVec3| {
        let row = |k: usize| m[4 * k] * p.x + m[4 * k + 1] * p.y + m[4 * k + 2] * p.z + m[4 * k + 3];
        DVec2::new(row(0), row(1)) / row(2)
    };
    Some(shape.iter().zip(&unit).map(|(p, q)| image(p).distance(*q)).fold(0.0, f64::max))
}

/// "Little distortion of objects that cross the transition": far less than broken rays make.
#[test]
fn objects_crossing_a_transition_keep_their_shape() {
    for (turn_deg, most) in [(20.0, 0.05), (45.0, 0.05), (70.0, 0.15)] {
        let spec = corner(turn_deg, turn_deg);
        let views = [Model::Modified, Model::C0].map(|model| spec.view(model, &STILL));
        let worst = views.each_ref().map(|view| {
            let mut random = Random::new(4);
            let poses = (0..60).filter_map(|_| {
                let ray = view.ray(DVec2::new(random.range(240.0, 1040.0), random.range(200.0, 520.0)));
                let pieces = ray.pieces().ok()?;
                let depth = pieces.get(1)?.depth[0];
                let at = ray.at(depth * random.range(0.97, 1.3)).ok()?.point;
                distortion(view, at, 1.0)
            });
            poses.fold(0.0, f64::max)
        });
        println!(
            "turn of {turn_deg} degrees: worst distortion {:.1} % curved, {:.1} % broken",
            100.0 * worst[0],
            100.0 * worst[1]
        );
        assert!(worst[0] < most && worst[1] > 2.0 * worst[0], "{turn_deg} degrees: {worst:?}");
    }
}

/// The fit itself: a straight picture has no distortion.
#[test]
fn a_pinhole_does_not_distort() {
    let view = Spec { turns: Vec::new() }.view(Model::Modified, &STILL);
    let worst = distortion(&view, DVec3::new(3.0, 100.0, 2.0), 1.0).unwrap();
    assert!(worst < 1e-6, "{worst:e}");
}

/// "Rays are C1": the directions just before and after each joint differ by no more than the step explains; broken rays have a kink.
#[test]
fn rays_have_one_direction_at_each_joint() {
    let spec = cameras::street_corner();
    let kink = |model: Model| {
        let view = spec.view(model, &STILL);
        let mut worst = 0.0f64;
        for pixel in [[100.0, 100.0], [640.0, 360.0], [1200.0, 650.0], [320.0, 500.0]].map(DVec2::from_array) {
            let ray = view.ray(pixel);
            for piece in &ray.pieces().unwrap()[1..] {
                let (w, h) = (piece.depth[0], 1e-5 * piece.depth[0]);
                let at = |w: f64| ray.at(w).unwrap().point;
                worst = worst.max((at(w) - at(w - h)).angle_between(at(w + h) - at(w)).to_degrees());
            }
        }
        worst
    };
    let (curved, broken) = (kink(Model::Modified), kink(Model::C0));
    println!("largest kink: {curved:.1e} degrees curved, {broken:.0} degrees broken");
    assert!(curved < 0.01 && broken > 13.0, "{curved} {broken}");
}
