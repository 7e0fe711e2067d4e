use super::*;
use crate::{Color, TransferPoint, VoxelValues};
use belvedere_core::DMat3;
use belvedere_core::random::Random;

#[test]
fn the_outline_holds_every_voxel_that_is_not_transparent_and_reaches_no_farther() {
    let mut random = Random::new(12);
    for _ in 0..40 {
        let dims = std::array::from_fn(|_| 2 + random.below(30));
        let places: Vec<[usize; 3]> = (0..1 + random.below(40)).map(|_| dims.map(|n| random.below(n))).collect();
        let number = |[x, y, z]: [usize; 3]| (z * dims[1] + y) * dims[0] + x;
        let mut values = vec![0u8; dims.iter().product()];
        places.iter().for_each(|at| values[number(*at)] = 30);
        let axes = DMat3::from_cols(DVec3::X, DVec3::new(0.3, 1.1, 0.0), DVec3::new(0.0, -0.2, 4.0));
        let volume = Volume::new(dims, axes, DVec3::ONE, VoxelValues::U8(values)).unwrap();
        let point = |value, opacity| TransferPoint { value, color: Color::rgb(0, 0, 0), opacity };
        let transfer = TransferFunction::new("test", vec![point(20.0, 0.0), point(255.0, 0.1)], 1.0).unwrap();
        let layer = VolumeLayer::new(volume, transfer);
        let all = places.iter().map(|at| layer.volume.scene_from_lattice(DVec3::from_array(at.map(|n| n as f64))));
        let (all, outline) = (all.collect::<Vec<_>>(), layer.outline());
        // In every direction the farthest of the outline is the farthest of the voxels.
        for _ in 0..60 {
            let towards = random.direction();
            let farthest = |points: &[DVec3]| points.iter().map(|p| p.dot(towards)).fold(f64::NEG_INFINITY, f64::max);
            assert!((farthest(&all) - farthest(&outline)).abs() < 1e-9, "{dims:?} {places:?}");
        }
    }
}

#[test]
fn what_is_visible_is_known_by_box_and_by_voxels() {
    let mut values = vec![0u8; 40 * 40 * 40];
    let at = |x: usize, y: usize, z: usize| (z * 40 + y) * 40 + x;
    (values[at(10, 20, 30)], values[at(11, 20, 30)], values[at(37, 20, 30)]) = (90, 120, 200);
    let volume = Volume::new([40; 3], DMat3::from_diagonal(DVec3::splat(0.5)), DVec3::X, VoxelValues::U8(values));
    let point = |value, opacity| TransferPoint { value, color: Color::rgb(0, 0, 0), opacity };
    let transfer = TransferFunction::new("test", vec![point(80.0, 0.0), point(255.0, 1.0)], 1.0).unwrap();
    let mut layer = VolumeLayer::new(volume.unwrap(), transfer);
    let scene = |x: f64, y: f64, z: f64| DVec3::X + 0.5 * DVec3::new(x, y, z);
    assert_eq!(layer.visible_voxels(9), [scene(11.0, 20.0, 30.0), scene(37.0, 20.0, 30.0)]);
    assert_eq!(layer.visible_voxels(1), [scene(11.0, 20.0, 30.0)]);
    let bounds = layer.visible_bounds();
    assert_eq!((bounds.min, bounds.max), (scene(8.0, 16.0, 24.0), scene(39.0, 24.0, 32.0)));
    layer.transfer = TransferFunction::new("none", vec![point(0.0, 0.0)], 1.0).unwrap();
    assert!(layer.visible_bounds().is_empty() && layer.visible_voxels(9).is_empty());
}
