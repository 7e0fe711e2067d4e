//! Boxes, and meshes made of others.

use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{BoxShape, Color, Mesh, MeshColors};

/// Each corner by complex multiplication; every normal points away from the middle and stands on its triangle.
#[test]
fn corners_of_turned_boxes_are_numbered_by_their_sides() {
    let (base, size) = (DVec3::new(10.0, -4.0, 2.0), DVec3::new(6.0, 2.0, 5.0));
    for k in 0..12 {
        let yaw = 0.55 * f64::from(k);
        let shape = BoxShape { base, size, yaw, color: Color::rgb(1, 2, 3) };
        let corners = shape.corners();
        for (i, corner) in corners.iter().enumerate() {
            let side = DVec2::new(if i % 2 == 1 { 3.0 } else { -3.0 }, if i / 2 % 2 == 1 { 1.0 } else { -1.0 });
            let plan = DVec2::from_angle(yaw).rotate(side) + base.truncate();
            let want = plan.extend(if i >= 4 { 7.0 } else { 2.0 });
            assert!((*corner - want).length() < 1e-12, "{i} {yaw}: {corner} {want}");
        }
        for (t, triangle) in BoxShape::TRIANGLES.iter().enumerate() {
            let [a, b, c] = triangle.map(|i| corners[i]);
            let normal = shape.normal_of(t);
            let middle = base + 2.5 * DVec3::Z;
            assert!((normal.length() - 1.0).abs() < 1e-12 && normal.dot(a - middle) > 0.5);
            assert!(normal.dot(b - a).abs() < 1e-12 && normal.dot(c - a).abs() < 1e-12);
        }
    }
}

/// A strip of triangles over shared vertices.
fn strip() -> Mesh {
    let places: Vec<DVec3> =
        (0..8).map(|i| DVec3::new(f64::from(i / 2), f64::from(i % 2), 0.25 * f64::from(i))).collect();
    let triangles = (0..6u32).map(|i| [i, i + 1, i + 2]).collect();
    Mesh::new(&places, triangles, MeshColors::Layer).expect("a mesh")
}

#[test]
fn some_triangles_of_a_mesh_keep_their_corners() {
    let mesh = strip();
    let only = mesh.only(&|t| {
        assert!(t < 6, "triangle {t} does not exist");
        t % 2 == 1
    });
    assert_eq!(only.triangles().len(), 3);
    for (k, t) in [1, 3, 5].into_iter().enumerate() {
        assert_eq!(only.corners(k), mesh.corners(t));
    }
}

/// Two bodies share two vertices of the strip: each takes its own copy along.
#[test]
fn bodies_carry_their_triangles_apart() {
    let mesh = strip();
    let by = |body: usize| DVec3::new(0.0, 0.0, 8.0 * (body + 1) as f64);
    let body = |t: usize| (t != 2).then_some(t / 3);
    let carried = mesh.carried(&body, &|body, p| p + by(body)).expect("finite");
    assert_eq!((0..5).map(|k| carried.part(k)).collect::<Vec<_>>(), [0, 1, 3, 4, 5].map(Some));
    for k in 0..5 {
        let t = carried.part(k).expect("a part") as usize;
        let want = mesh.corners(t).map(|p| p + by(t / 3));
        assert!(carried.corners(k).iter().zip(want).all(|(a, b)| (*a - b).length() < 1e-5), "{k}");
    }
    assert_eq!(carried.vertex_count(), 4 + 5, "corners of one body stay together");
}
