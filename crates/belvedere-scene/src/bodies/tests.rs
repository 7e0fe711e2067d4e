use super::*;
use crate::{BoxLayer, BoxShape, Color, MeshColors, MeshLayer};

/// Two prisms with L-shaped floors, 10 m apart, and a loose triangle under both.
fn prisms() -> MeshLayer {
    let plan = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 2.0], [2.0, 6.0], [0.0, 6.0]];
    let fan = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
    let (mut places, mut triangles, mut parts) = (Vec::new(), Vec::new(), Vec::new());
    for (part, x) in [(1, 0.0), (2, 10.0)] {
        let first = places.len() as u32;
        for z in [3.0, 9.0] {
            places.extend(plan.iter().map(|[px, py]| DVec3::new(5e5 + x + px, 4e6 + py, z)));
        }
        for [a, b, c] in fan {
            triangles.push([a, c, b].map(|v| first + v));
            triangles.push([a, b, c].map(|v| first + 6 + v));
        }
        for i in 0..6 {
            let j = (i + 1) % 6;
            triangles.push([i, j, j + 6].map(|v| first + v));
            triangles.push([i, j + 6, i + 6].map(|v| first + v));
        }
        parts.resize(triangles.len(), part);
    }
    triangles.push([0, 12, 4]);
    parts.push(0);
    let mesh = Mesh::in_parts(&places, triangles, MeshColors::Layer, parts).unwrap();
    MeshLayer { rigid: RigidParts::Only(vec![1, 2, 77]), ..MeshLayer::new(mesh, Color::rgb(1, 2, 3)) }
}

#[test]
fn bodies_stand_on_the_centroid_of_their_plan() {
    let layer = prisms();
    let bodies = Bodies::of(&LayerKind::Mesh(layer.clone())).unwrap();
    // 4 x 2 and 2 x 4: areas 8 and 8 about (2, 1) and (1, 4).
    for (foot, x) in bodies.feet().iter().zip([0.0, 10.0]) {
        assert!(foot.distance(DVec3::new(5e5 + x + 1.5, 4e6 + 2.5, 3.0)) < 1e-5, "{foot}");
    }
    let last = layer.mesh.triangles().len() - 1;
    let of: Vec<Option<usize>> = [0, 19, 20, last, last + 1].map(|t| bodies.of_triangle(t)).to_vec();
    assert_eq!(of, [Some(0), Some(0), Some(1), None, None]);
    assert!(!bodies.are_all());
}

#[test]
fn what_is_not_rigid_has_no_bodies_and_what_has_no_parts_is_one() {
    let with = |rigid| Bodies::of(&LayerKind::Mesh(MeshLayer { rigid, ..prisms() }));
    assert_eq!(with(RigidParts::None), None);
    assert_eq!(with(RigidParts::Only(vec![9])), None);
    assert_eq!(with(RigidParts::All).unwrap().feet().len(), 3);
    let mesh = Mesh::new(&[DVec3::ZERO, DVec3::X, 2.0 * DVec3::Z], vec![[0, 1, 2]], MeshColors::Layer).unwrap();
    let wall = MeshLayer { rigid: RigidParts::All, ..MeshLayer::new(mesh, Color::rgb(1, 2, 3)) };
    let bodies = Bodies::of(&LayerKind::Mesh(wall)).unwrap();
    assert!(bodies.feet()[0].distance(DVec3::X / 3.0) < 1e-7, "a wall stands on the mean of its corners");
    let shape = BoxShape { base: DVec3::ONE, size: DVec3::ONE, yaw: 0.0, color: Color::rgb(1, 2, 3) };
    let boxes = |rigid| Bodies::of(&LayerKind::Boxes(BoxLayer { rigid, ..BoxLayer::new(vec![shape; 2]) }));
    assert_eq!(boxes(false), None);
    let bodies = boxes(true).unwrap();
    assert_eq!([11, 12, 24].map(|t| bodies.of_triangle(t)), [Some(0), Some(1), None]);
    assert!(bodies.are_all() && bodies.feet() == [DVec3::ONE; 2]);
}
