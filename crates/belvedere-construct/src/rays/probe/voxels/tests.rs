use super::*;
use belvedere_core::random::Random;
use belvedere_scene::{BoxLayer, Color, MeshColors, MeshLayer};

fn region() -> Aabb {
    Aabb { min: DVec3::new(-50.0, -50.0, -10.0), max: DVec3::new(50.0, 50.0, 40.0) }
}

#[test]
fn every_point_of_a_surface_lies_in_a_solid_cell_and_clearance_is_kept_by_all_of_them() {
    let mut random = Random::new(5);
    let mut at = |r: f64| DVec3::new(random.unit() - 0.5, random.unit() - 0.5, random.unit()) * r;
    let corners: Vec<DVec3> = (0..60).map(|i| if i % 3 == 0 { at(80.0) } else { DVec3::ZERO }).collect();
    let corners: Vec<DVec3> = (0..60).map(|i| corners[i / 3 * 3] + at(12.0)).collect();
    let triangles = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = Mesh::new(&corners, triangles, MeshColors::Layer).unwrap();
    let shape = BoxShape {
        base: DVec3::new(20.0, -10.0, 0.0),
        size: DVec3::new(18.0, 9.0, 14.0),
        yaw: 0.6,
        color: Color::rgb(1, 2, 3),
    };
    let heights = (0..121).map(|i| (3.0 * f64::from(i).sin() - 5.0) as f32).collect();
    let ground = Heightfield::measured(DVec2::new(-50.0, 50.0), DVec2::splat(10.0), 11, 11, heights).unwrap();
    let scene = Scene::default()
        .with_terrain("ground", ground)
        .with_layer("box", BoxLayer::new(vec![shape]))
        .with_layer("mesh", MeshLayer::new(mesh.clone(), Color::rgb(1, 2, 3)));
    let voxels = Voxels::new(&scene, &region());
    assert!(voxels.len() <= MOST_CELLS as usize * 5 / 4 && voxels.size().into_iter().max() >= Some(64));
    let mut points = Vec::new();
    for _ in 0..3000 {
        let [u, v, w] = [random.unit(), random.unit(), random.unit()];
        let [a, b, c] = mesh.corners((w * 20.0) as usize);
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        points.push(a + u * (b - a) + v * (c - a));
        let local = DVec3::new((u - 0.5) * shape.size.x, (v - 0.5) * shape.size.y, w * shape.size.z);
        let (sin, cos) = shape.yaw.sin_cos();
        points.push(shape.base + DVec3::new(cos * local.x - sin * local.y, sin * local.x + cos * local.y, local.z));
        let xy = DVec2::new(100.0 * u - 50.0, 100.0 * w - 50.0);
        let z = scene.terrain().unwrap().surface_at(xy).unwrap();
        points.push(xy.extend(z - 1e-6 - 2.0 * v));
    }
    let inside: Vec<DVec3> = points.into_iter().filter(|p| voxels.at(*p).is_some()).collect();
    assert!(inside.len() > 6000);
    for p in &inside {
        assert!(voxels.at(*p).is_some_and(|cell| voxels.is_solid(cell)), "{p} is in no solid cell");
    }
    let mut free = 0;
    for cell in (0..voxels.len()).step_by(97).filter(|c| !voxels.is_solid(*c)) {
        free += 1;
        let center = voxels.center(cell);
        let nearest = inside.iter().map(|p| p.distance(center)).fold(f64::INFINITY, f64::min);
        // Half the diagonal of a cell instead of half its edge.
        assert!(nearest >= voxels.clearance(cell) - 0.37 * voxels.cell(), "{center} {nearest}");
    }
    assert!(free > 500, "{free}");
}

#[test]
fn ways_are_free_up_to_what_stands_there() {
    let wall = BoxShape {
        base: DVec3::new(0.0, 0.0, -10.0),
        size: DVec3::new(4.0, 100.0, 30.0),
        yaw: 0.0,
        color: Color::rgb(1, 2, 3),
    };
    let scene = Scene::default().with_layer("wall", BoxLayer::new(vec![wall]));
    let voxels = Voxels::new(&scene, &region());
    let [left, right] = [-30.0, 30.0].map(|x| DVec3::new(x, 0.0, 5.0));
    assert!(!voxels.is_free(left, right, 0.0, 0.0) && !voxels.sees(left, right));
    let [up, down] = [left, right].map(|p| p + 30.0 * DVec3::Z);
    assert!(voxels.is_free(up, down, 0.0, 0.0) && voxels.sees(up, down));
    // 15 m over the wall, in its middle after 30 m.
    assert!(voxels.is_free(up, down, 0.0, 0.4) && !voxels.is_free(up, down, 0.0, 0.6));
    assert!(!voxels.is_free(up, down, 30.0, 0.4));
    assert!(voxels.is_free(left, left + 90.0 * DVec3::NEG_X, 0.0, 0.1), "outside everything is free");
}
