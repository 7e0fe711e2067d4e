use super::*;

const BLACK: Color = Color::rgb(0, 0, 0);
const WHITE: Color = Color::rgb(255, 255, 255);

/// A bowl of `n` x `n` squares in two colours.
fn bowl(n: u32) -> MeshLayer {
    let at = |i: u32| f64::from(i) / f64::from(n) - 0.5;
    let vertex = |k: u32| DVec3::new(at(k % (n + 1)), at(k / (n + 1)), 0.0);
    let positions: Vec<DVec3> = (0..(n + 1) * (n + 1)).map(vertex).map(|p| p + DVec3::Z * p.length_squared()).collect();
    let cell = |k: u32| {
        let a = k / n * (n + 1) + k % n;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    };
    let triangles: Vec<[u32; 3]> = (0..n * n).flat_map(cell).collect();
    let color = |k: usize| if k % (2 * n as usize) < n as usize { BLACK } else { WHITE };
    let colors = MeshColors::PerTriangle((0..triangles.len()).map(color).collect());
    let parts = (0..triangles.len()).map(|k| u32::from(color(k) == WHITE)).collect();
    let mesh = Mesh::in_parts(&positions, triangles, colors, parts).expect("mesh");
    MeshLayer::new(mesh, BLACK)
}

#[test]
fn a_mesh_keeps_its_shape_colours_and_parts_with_few_triangles() {
    let fine = bowl(100);
    assert!(layer(&fine, 20_000).is_none(), "few enough");
    let coarse = layer(&fine, 1000).expect("coarser");
    let count = coarse.mesh.triangles().len();
    assert!((200..=1000).contains(&count), "{count}");
    let [a, b] = [&fine, &coarse].map(|layer| layer.mesh.bounds());
    assert!(a.min.distance(b.min) < 0.1 && a.max.distance(b.max) < 0.1, "{a:?} {b:?}");
    for t in 0..count {
        let middle = coarse.mesh.corners(t).into_iter().sum::<DVec3>() / 3.0;
        assert!((middle.z - middle.truncate().length_squared()).abs() < 0.02, "off the bowl: {middle}");
        let color = coarse.mesh.color_at(t, [1.0 / 3.0; 3]).expect("colour");
        assert_eq!(coarse.mesh.part(t), Some(u32::from(color == WHITE)));
    }
}

#[test]
fn rigid_parts_share_no_vertices() {
    let coarse = clustered(&bowl(60).mesh, 800, true, BLACK).expect("coarser");
    let mut parts = HashMap::new();
    for (t, corners) in coarse.triangles().iter().enumerate() {
        for v in corners {
            assert_eq!(*parts.entry(*v).or_insert(coarse.part(t)), coarse.part(t));
        }
    }
}
