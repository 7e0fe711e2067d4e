use super::*;

fn corners() -> Vec<DVec3> {
    [[5e5, 4.7e6, 100.0], [5e5 + 10.0, 4.7e6, 100.0], [5e5, 4.7e6 + 10.0, 100.0], [5e5, 4.7e6, 110.5]]
        .map(DVec3::from_array)
        .to_vec()
}

#[test]
fn a_mesh_keeps_its_places_far_from_the_origin() {
    let mesh = Mesh::new(&corners(), vec![[0, 1, 2], [0, 1, 3]], MeshColors::Layer).unwrap();
    for (i, p) in corners().iter().enumerate() {
        assert!(mesh.vertex(i as u32).distance(*p) < 1e-6);
    }
    assert_eq!(mesh.face_normal(0), DVec3::Z);
    assert_eq!(mesh.face_normal(1), -DVec3::Y);
    let p = mesh.corners(0)[0] * 0.2 + mesh.corners(0)[1] * 0.5 + mesh.corners(0)[2] * 0.3;
    let weights = mesh.weights_at(0, p);
    assert!(weights.iter().zip([0.2, 0.5, 0.3]).all(|(a, b)| (a - b).abs() < 1e-7), "{weights:?}");
}

#[test]
fn faulty_meshes_are_refused_and_flat_triangles_left_out() {
    let index = Mesh::new(&corners(), vec![[0, 1, 4]], MeshColors::Layer).unwrap_err();
    assert_eq!(index.to_string(), "triangle 0 names vertex 4 of 4; repair the mesh");
    let mut bad = corners();
    bad[2].y = f64::NAN;
    assert!(matches!(Mesh::new(&bad, vec![], MeshColors::Layer), Err(MeshError::NotFinite { vertex: 2, .. })));
    let huge = [DVec3::splat(1e300)];
    assert!(matches!(Mesh::new(&huge, vec![], MeshColors::Layer), Err(MeshError::NotFinite { .. })));
    let one = MeshColors::PerTriangle(vec![Color::rgb(1, 2, 3)]);
    assert!(matches!(
        Mesh::new(&corners(), vec![[0, 1, 2], [0, 1, 3]], one),
        Err(MeshError::Count { found: 1, expected: 2, .. })
    ));
    let colors = MeshColors::PerTriangle(vec![Color::rgb(1, 2, 3), Color::rgb(4, 5, 6)]);
    let flat = Mesh::new(&corners(), vec![[0, 1, 1], [0, 1, 3]], colors).unwrap();
    assert_eq!(flat.triangles(), [[0, 1, 3]]);
    assert_eq!(flat.color_at(0, [1.0, 0.0, 0.0]), Some(Color::rgb(4, 5, 6)));
}

#[test]
fn normals_follow_the_corners_and_colours_blend() {
    let colors = MeshColors::PerVertex([0, 100, 200, 0].map(|g| Color::rgb(g, g, g)).to_vec());
    let mesh = Mesh::new(&corners(), vec![[0, 1, 2]], colors).unwrap();
    let turned = mesh.with_normals(&[-DVec3::Z, DVec3::Z, DVec3::ZERO, DVec3::X]).unwrap();
    assert!(turned.normal_at(0, [0.5, 0.25, 0.25]).distance(DVec3::Z) < 1e-12);
    assert_eq!(turned.color_at(0, [0.5, 0.25, 0.25]), Some(Color::rgb(75, 75, 75)));
}
