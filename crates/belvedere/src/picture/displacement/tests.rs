use super::*;
use belvedere_core::grid::Grid;
use belvedere_core::{Pinhole, Projection, Stage, TerrainDisocclusion};

const SIZE: [u32; 2] = [200, 120];

/// A view in which everything is raised by `by`.
fn raised(by: f64) -> View {
    let lens = Projection::Perspective { fov_y: 1.0 };
    let pinhole = Pinhole::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, lens, SIZE, 0.01, None).unwrap();
    let grid = Grid::new(DVec2::new(-500.0, 500.0), DVec2::splat(1000.0), 2, 2, vec![by; 4]).unwrap();
    View::new(pinhole, vec![Stage::TerrainDisocclusion(TerrainDisocclusion::new(grid))]).unwrap()
}

/// A picture of sky in which pixels show a surface at a depth.
fn frame(surfaces: &[([usize; 2], f32)]) -> Frame {
    let [width, height] = SIZE.map(|n| n as usize);
    let mut depth = vec![f32::INFINITY; width * height];
    let mut id = vec![0; width * height];
    for ([col, row], at) in surfaces {
        (depth[row * width + col], id[row * width + col]) = (*at, 1);
    }
    Frame { width, height, color: vec![[0; 3]; width * height], depth, id, ..Frame::default() }
}

fn measure(view: &View, rigid: &RigidLayers, frame: &Frame) -> DisplacementReport {
    super::measure(view, rigid, frame).expect("drawn")
}

#[test]
fn a_single_pixel_is_enough_and_its_size_is_said_in_every_unit() {
    for at in [[0, 0], [3, 7], [101, 59], [199, 119]] {
        let found = measure(&raised(2.5), &RigidLayers::default(), &frame(&[(at, 40.0)]));
        assert_eq!(found.samples, 1, "{at:?}");
        assert!((found.max_m - 2.5).abs() < 1e-9 && (found.rms_m - 2.5).abs() < 1e-9, "{found:?}");
        let said = [Unit::Metre, Unit::Angstrom, Unit::Voxel].map(|unit| found.most(unit));
        assert_eq!(said, ["2.5 m", "2.5 angstrom", "2.5 voxels"]);
    }
    let small = measure(&raised(0.003), &RigidLayers::default(), &frame(&[([100, 60], 40.0)]));
    assert_eq!(small.most(Unit::Angstrom), "0.1 angstrom");
    let sky = measure(&raised(2.5), &RigidLayers::default(), &frame(&[]));
    assert_eq!((sky.samples, sky.max_m, sky.max_px), (0, 0.0, 0.0));
}

#[test]
fn pixels_are_of_points_in_both_pictures_and_never_beside_the_eye() {
    // Far away 2 m are few pixels; nearer than 1 m the straight image lies below the picture, up to right below the eye.
    for near in [1.5, 1.0, 0.3, 0.05, 0.011] {
        let found = measure(&raised(2.0), &RigidLayers::default(), &frame(&[([100, 60], near), ([100, 50], 80.0)]));
        let diagonal = f64::from(SIZE[0]).hypot(f64::from(SIZE[1]));
        assert!(found.max_px <= diagonal && found.rms_px <= found.max_px, "{near}: {found:?}");
        let scale = raised(2.0).pinhole().scale_px();
        assert!((found.max_px - 2.0 * scale / 80.0).abs() < 1e-6, "only the far point lies in both: {found:?}");
        assert!((found.max_m - 2.0).abs() < 1e-9, "both are moved: {found:?}");
    }
}
