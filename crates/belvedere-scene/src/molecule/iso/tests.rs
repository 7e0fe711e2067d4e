use super::super::shape::closed::euler;
use super::*;

fn whole(balls: &[Ball], detail: Option<u32>) -> Shape {
    let atoms: Vec<u32> = (0..balls.len() as u32).collect();
    let colors = vec![Color::rgb(9, 9, 9); balls.len()];
    Shape::joined(build(balls, &atoms, &colors, detail)).unwrap()
}

fn area_and_volume(shape: &Shape) -> [f64; 2] {
    shape.triangles.iter().fold([0.0; 2], |[area, volume], t| {
        let [a, b, c] = t.map(|v| shape.positions[v as usize]);
        [area + 0.5 * (b - a).cross(c - a).length(), volume + a.dot(b.cross(c)) / 6.0]
    })
}

#[test]
fn the_surface_of_one_atom_is_its_sphere() {
    let r = 1.7;
    let center = DVec3::new(3.1, -2.2, 0.4);
    let shape = whole(&[(center, r)], Some(16));
    let [area, volume] = area_and_volume(&shape);
    let [sphere, ball] = [4.0 * std::f64::consts::PI * r * r, 4.0 / 3.0 * std::f64::consts::PI * r * r * r];
    assert!(
        (area / sphere - 1.0).abs() < 0.03 && (volume / ball - 1.0).abs() < 0.05,
        "{area} {sphere} {volume} {ball}"
    );
    for (p, n) in shape.positions.iter().zip(&shape.normals) {
        assert!((p.distance(center) - r).abs() < 0.04 && n.dot((*p - center).normalize()) > 0.99, "{p}");
    }
    assert_eq!(euler(&shape), 2);
}

#[test]
fn surfaces_are_closed_and_hold_every_centre() {
    let mut seed = 11u64;
    let mut next = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / f64::from(1u32 << 31)
    };
    let balls: Vec<Ball> = (0..120).map(|_| (14.0 * DVec3::new(next(), next(), next()), 1.2 + 0.7 * next())).collect();
    for detail in [1, 4, 9] {
        let shape = whole(&balls, Some(detail));
        assert_eq!(euler(&shape) % 2, 0, "closed surfaces have an even number");
        // The solid angle of a closed surface seen from inside is that of the sphere.
        for (center, _) in balls.iter().step_by(7) {
            let angle: f64 =
                shape.triangles.iter().map(|t| solid_angle(t.map(|v| shape.positions[v as usize] - *center))).sum();
            assert!((angle / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-6, "{detail}: {angle}");
        }
        // Each triangle belongs to a ball near it.
        for (t, part) in shape.triangles.iter().zip(&shape.parts) {
            let (c, r) = balls[*part as usize];
            assert!(shape.positions[t[0] as usize].distance(c) < 2.0 * r + 1.7);
        }
    }
    let apart = [(DVec3::ZERO, 1.5), (DVec3::new(9.0, 0.0, 0.0), 1.5)];
    assert_eq!(euler(&whole(&apart, Some(6))), 4, "two balls");
}

/// Source: van Oosterom and Strackee 1983.
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let [la, lb, lc] = [a.length(), b.length(), c.length()];
    let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * a.dot(b.cross(c)).atan2(below)
}
