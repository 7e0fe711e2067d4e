use super::*;
use belvedere_scene::MeshColors;

/// Rectangles across z: middle and half sides.
fn plates(plates: &[(DVec3, f64)]) -> Mesh {
    let corner = |(middle, half): &(DVec3, f64), k: usize| {
        let [x, y] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]][k];
        *middle + *half * DVec3::new(x, y, 0.0)
    };
    let places: Vec<DVec3> = plates.iter().flat_map(|p| (0..4).map(move |k| corner(p, k))).collect();
    let triangles = (0..plates.len() as u32).flat_map(|i| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k| 4 * i + k)));
    Mesh::new(&places, triangles.collect(), MeshColors::Layer).unwrap()
}

#[test]
fn a_plate_takes_as_much_of_the_light_as_it_covers_of_it() {
    for height in [10.0, 25.0, 60.0] {
        let mesh = plates(&[(DVec3::ZERO, 40.0), (DVec3::new(0.0, 0.0, height), 8.0)]);
        let shadows = KeyShadows::new(&[&mesh], DVec3::Z, 800.0);
        let half = f64::from(SPREAD) * height;
        for i in -160..160 {
            let x = 0.1 * f64::from(i) + 8.0;
            let lit = f64::from(shadows.lit(DVec3::new(x, 0.0, 0.0), DVec3::Z));
            // Share of a disc that lies to the right of the edge of the plate.
            let t = ((x - 8.0) / half).clamp(-1.0, 1.0);
            let share = 1.0 - (t.acos() - t * (1.0 - t * t).sqrt()) / std::f64::consts::PI;
            let alone = x > -8.0 + half;
            assert!(!alone || (lit - share).abs() < 0.13, "{height}: {lit} at {x}, {share} expected");
        }
        assert_eq!(shadows.lit(DVec3::new(0.0, 0.0, height), DVec3::Z), 1.0, "the plate itself");
        assert_eq!(shadows.lit(DVec3::ZERO, DVec3::NEG_Z), 0.0, "turned away");
    }
}

#[test]
fn slanted_and_round_surfaces_do_not_shade_themselves() {
    let (rings, sectors) = (120u32, 240u32);
    let place = |i: u32, j: u32| {
        let (polar, turn) = (TAU * 0.5 * f64::from(i) / f64::from(rings), TAU * f64::from(j) / f64::from(sectors));
        10.0 * DVec3::new(polar.sin() * turn.cos(), polar.sin() * turn.sin(), polar.cos())
    };
    let places: Vec<DVec3> = (0..=rings).flat_map(|i| (0..sectors).map(move |j| place(i, j))).collect();
    let at = |i: u32, j: u32| i * sectors + j % sectors;
    let quads =
        (0..rings).flat_map(|i| (0..sectors).map(move |j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
    let triangles = quads.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let ball = Mesh::new(&places, triangles, MeshColors::Layer).unwrap();
    let light = DVec3::new(-0.4, 0.5, 0.8).normalize();
    let shadows = KeyShadows::new(&[&ball], light, 400.0);
    for p in places.iter().filter(|p| p.normalize().dot(light) > 0.05) {
        let lit = shadows.lit(*p, p.normalize());
        assert!(lit > 0.99, "{lit} at {p}, {}", p.normalize().dot(light));
    }
}

#[test]
fn the_map_is_the_same_in_any_order_of_triangles() {
    let list: Vec<(DVec3, f64)> = (0..60)
        .map(|i| (DVec3::new(f64::from(i * 7 % 23), f64::from(i * 5 % 19), f64::from(i * 3 % 11)), 2.0))
        .collect();
    let turned: Vec<_> = list.iter().rev().copied().collect();
    let [a, b] =
        [plates(&list), plates(&turned)].map(|m| KeyShadows::new(&[&m], DVec3::new(0.2, 0.3, 0.9).normalize(), 300.0));
    assert!(a.size == b.size && a.heights.iter().filter(|h| h.is_finite()).count() > 1000);
    let most = a.heights.iter().zip(&b.heights).map(|(a, b)| if a == b { 0.0 } else { (a - b).abs() });
    assert!(most.fold(0.0, f32::max) < 1e-2);
}
