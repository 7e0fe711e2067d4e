use super::*;
use belvedere_core::{DMat3, Pinhole, Projection};
use belvedere_scene::{Color, Crs, Layer, TransferFunction, TransferPoint, Unit, Volume, VoxelValues};

/// A wall of value 100 between y = 20 and y = 30 in air, with a window where x and z lie in 12..=18; 30 voxels of edge 2.
fn scene(opacity: f64) -> Scene {
    let value = |i: usize| {
        let [x, y, z] = [i % 30, i / 30 % 30, i / 900].map(|v| 2 * v);
        let window = (12..=18).contains(&x) && (12..=18).contains(&z);
        if (20..=30).contains(&y) && !window { 100u8 } else { 0 }
    };
    let values = VoxelValues::U8((0..27_000).map(value).collect());
    let volume = Volume::new([30; 3], DMat3::from_diagonal(DVec3::splat(2.0)), DVec3::ZERO, values).unwrap();
    let point = |value, opacity| TransferPoint { value, color: Color::rgb(0, 0, 0), opacity };
    let transfer = TransferFunction::new("test", vec![point(50.0, 0.0), point(50.0, opacity)], 1.0).unwrap();
    let kind = VolumeLayer::new(volume, transfer).into();
    let layers = vec![Layer { id: "wall".into(), must_see: false, kind }];
    Scene { title: String::new(), crs: Crs::Local, unit: Unit::Voxel, layers, ..Scene::default() }
}

fn light(scene: &Scene, p: DVec3, without: &[usize]) -> f64 {
    let lens = Projection::Perspective { fov_y: 0.8 };
    let pinhole = Pinhole::look_at(DVec3::new(p.x, -100.0, p.z), p, DVec3::Z, lens, [64, 48], 1.0, None).unwrap();
    let view = View::straight(pinhole);
    let image = view.project(p).unwrap();
    Voxels::without(scene, without).light(&view, image.pixel, image.depth)
}

#[test]
fn light_comes_through_by_the_length_of_the_way_and_by_windows() {
    let thin = scene(0.1);
    // Values pass 50 half a voxel beside the wall: 12 units, 6 voxel edges.
    let behind = light(&thin, DVec3::new(40.0, 50.0, 40.0), &[]);
    assert!((behind - 0.9f64.powf(6.0)).abs() < 0.03, "{behind}");
    assert_eq!(light(&thin, DVec3::new(40.0, 10.0, 40.0), &[]), 1.0);
    assert_eq!(light(&thin, DVec3::new(15.0, 50.0, 15.0), &[]), 1.0, "through the window");
    assert_eq!(light(&thin, DVec3::new(62.0, 50.0, 40.0), &[]), 1.0, "along its side, outside it");
    assert_eq!(light(&thin, DVec3::new(40.0, 50.0, 40.0), &[0]), 1.0, "what is looked for does not hide itself");
    let solid = scene(1.0);
    assert_eq!(light(&solid, DVec3::new(40.0, 50.0, 40.0), &[]), 0.0);
    // The surface of the wall is seen, what lies three voxels deep in it is not.
    assert_eq!(light(&solid, DVec3::new(40.0, 20.5, 40.0), &[]), 1.0);
    assert_eq!(light(&solid, DVec3::new(40.0, 26.0, 40.0), &[]), 0.0);
}
