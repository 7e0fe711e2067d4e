use super::*;
use belvedere_scene::MeshColors;

/// A heap of random triangles.
fn heap(n: usize) -> Mesh {
    let mut seed = 7u64;
    let mut next = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / f64::from(1u32 << 31)
    };
    let mut positions = Vec::new();
    for _ in 0..n {
        let middle = DVec3::new(5e5 + 100.0 * next(), 4.7e6 + 100.0 * next(), 100.0 * next());
        for _ in 0..3 {
            positions.push(middle + 8.0 * DVec3::new(next(), next(), next()));
        }
    }
    let triangles = (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new(&positions, triangles, MeshColors::Layer).unwrap()
}

fn segments() -> Vec<(DVec3, DVec3)> {
    let corner = DVec3::new(5e5, 4.7e6, 0.0);
    (0..400)
        .map(|i| {
            let angle = f64::from(i) * 0.37;
            let a = corner + DVec3::new(50.0 + 90.0 * angle.cos(), 50.0 + 90.0 * angle.sin(), f64::from(i % 100));
            (a, corner + DVec3::new(f64::from(i * 7 % 100), f64::from(i * 31 % 100), 50.0))
        })
        .collect()
}

#[test]
fn the_tree_finds_what_trying_every_triangle_finds() {
    let mesh = heap(3000);
    let tree = MeshTree::new(&mesh);
    let mut hits = 0;
    for (a, b) in segments() {
        let all = (0..mesh.triangles().len()).filter_map(|i| Some((tree.crossing(i, a, b)?, i)));
        let expected = all.min_by(|x, y| x.partial_cmp(y).unwrap());
        hits += usize::from(expected.is_some());
        assert_eq!(tree.first_crossing(a, b), expected);
        assert_eq!(tree.is_crossed(a, b), expected.is_some());
    }
    // Along an axis, through faces of boxes, and of no length.
    let corner = DVec3::new(5e5, 4.7e6, 0.0);
    for i in 0..200 {
        let from = corner + DVec3::new(f64::from(i % 20) * 5.0, f64::from(i / 20) * 10.0, -10.0);
        for along in [DVec3::Z, DVec3::X, DVec3::Y, DVec3::ZERO].map(|axis| 150.0 * axis) {
            let found = tree.first_crossing(from, from + along).is_some();
            assert_eq!(tree.is_crossed(from, from + along), found, "{from} {along}");
        }
    }
    assert!(hits > 200, "{hits}");
}

#[test]
fn reach_and_lift_widen_the_search() {
    let mesh = heap(500);
    for (reach, lift) in [(2.5, [0.0, 0.0]), (0.0, [-4.0, 3.0])] {
        let tree = MeshTree::lifted(&mesh, lift);
        for (a, b) in segments().into_iter().take(60) {
            let mut seen = vec![false; mesh.triangles().len()];
            tree.near(a, b, reach, &mut |t| {
                seen[t] = true;
                1.0
            });
            for i in 0..=1000 {
                let p = a.lerp(b, f64::from(i) / 1000.0);
                for (t, seen) in seen.iter().enumerate() {
                    let corners = mesh.corners(t);
                    let lo = corners.iter().fold(DVec3::INFINITY, |m, c| m.min(*c)) - reach + lift[0] * DVec3::Z;
                    let hi = corners.iter().fold(DVec3::NEG_INFINITY, |m, c| m.max(*c)) + reach + lift[1] * DVec3::Z;
                    let inside = p.cmpge(lo).all() && p.cmple(hi).all();
                    assert!(*seen || !inside, "triangle {t} at {p}");
                }
            }
        }
    }
}

#[test]
fn parts_that_are_left_out_are_passed_through() {
    let whole = heap(600);
    let places: Vec<DVec3> = (0..whole.vertex_count() as u32).map(|v| whole.vertex(v)).collect();
    let parts: Vec<u32> = (0..600).map(|t| t % 3).collect();
    let mesh = Mesh::textured(&places, whole.triangles().to_vec(), MeshColors::Layer, parts, None).unwrap();
    let tree = MeshTree::without_parts(&mesh, &[1]);
    let mut hits = 0;
    for (a, b) in segments() {
        let others = (0..600).filter(|t| t % 3 != 1).filter_map(|t| Some((tree.crossing(t, a, b)?, t)));
        let expected = others.min_by(|x, y| x.partial_cmp(y).unwrap());
        hits += usize::from(expected.is_some());
        assert_eq!(tree.first_crossing(a, b), expected);
    }
    assert!(hits > 30, "{hits}");
    assert_eq!(MeshTree::without_parts(&mesh, &[0, 1, 2]).first_crossing(DVec3::ZERO, DVec3::ONE), None);
}

#[test]
fn empty_meshes_and_single_triangles_have_trees() {
    let empty = Mesh::default();
    assert_eq!(MeshTree::new(&empty).first_crossing(DVec3::ZERO, DVec3::ONE), None);
    let one = Mesh::new(&[DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]], MeshColors::Layer).unwrap();
    let p = DVec3::new(0.25, 0.25, 2.0);
    assert_eq!(MeshTree::new(&one).first_crossing(p, p - 4.0 * DVec3::Z), Some((0.5, 0)));
    assert_eq!(MeshTree::new(&one).first_crossing(p, p - DVec3::Z), None);
}
