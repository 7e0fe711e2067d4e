//! Walls of vessels: the value at which they begin, and previews that stay inside.

use belvedere_construct::ConstructError;
use belvedere_construct::centreline::centreline;
use belvedere_construct::rays::{Lens, PathPreview, Target, TargetSight, find_wall, share_inside};
use belvedere_core::{DMat3, DVec2, DVec3, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{
    Crs, Layer, LayerKind, Light, Progress, RenderJob, RenderOptions, Renderer, Scene, TransferFunction, Unit, Volume,
    VolumeLayer, VoxelValues,
};
use belvedere_testkit::Random;

const DIMS: [usize; 3] = [72, 72, 80];
/// Radius of the vessel, voxels; edge of a voxel, scene units.
const RADIUS: f64 = 7.0;
const VOXEL: f64 = 0.5;
const IMAGE: [u32; 2] = [96, 54];

/// Values of what a vessel holds, of its wall, and of what lies around: the rest on one side, a bone or a cavity on the other.
#[derive(Clone, Copy)]
struct Tissue {
    lumen: f64,
    wall: f64,
    around: f64,
    /// A slab beside the vessel.
    beside: f64,
    noise: f64,
}

/// A contrast agent in tissue beside bone, with air around; and air in a thin wall, with tissue beside and air around.
const BRIGHT: Tissue = Tissue { lumen: 320.0, wall: 60.0, around: -900.0, beside: 1400.0, noise: 0.0 };
const DARK: Tissue = Tissue { lumen: -1000.0, wall: 40.0, around: -850.0, beside: 60.0, noise: 0.0 };

/// A curve that bends to random sides while it rises through the volume, whose ends close within it.
fn middle(seed: u64) -> Vec<DVec3> {
    let mut random = Random::new(seed);
    let [a, b, c, d] = [(); 4].map(|()| random.range(0.0, std::f64::consts::TAU));
    let at = |k: usize| {
        let t = k as f64 / 240.0;
        let [x, y] = [(a, 1.3, b), (c, 1.1, d)]
            .map(|(p, n, q)| 36.0 + 12.0 * (p + n * std::f64::consts::TAU * t).sin() + 4.0 * (q + 9.0 * t).sin());
        DVec3::new(x, y, 12.0 + 56.0 * t)
    };
    (0..=240).map(at).collect()
}

/// A vessel along a curve; its wall is three voxels thick in the dark case, and the tissue 12 voxels in the bright one.
fn vessel(seed: u64, tissue: Tissue, thick: f64) -> Volume {
    let middle = middle(seed);
    let mut random = Random::new(seed + 100);
    let [nx, ny, _] = DIMS;
    let near: Vec<Vec<DVec3>> = (0..DIMS[2])
        .map(|z| middle.iter().copied().filter(|p| (p.z - z as f64).abs() < RADIUS + thick + 2.0).step_by(3).collect())
        .collect();
    let mut value = |i: usize| {
        let p = DVec3::new((i % nx) as f64, (i / nx % ny) as f64, (i / nx / ny) as f64);
        let off = near[i / nx / ny].iter().map(|q| p.distance_squared(*q)).fold(f64::INFINITY, f64::min).sqrt();
        // Edges are blurred over two voxels.
        let share = |beyond: f64| (0.5 + 0.5 * beyond).clamp(0.0, 1.0);
        let rest = if p.x > 60.0 { tissue.beside } else { tissue.around };
        let outside = tissue.wall + share(off - RADIUS - thick) * (rest - tissue.wall);
        let noise: f64 = (0..3).map(|_| random.range(-1.0, 1.0)).sum();
        (tissue.lumen + share(off - RADIUS) * (outside - tissue.lumen) + tissue.noise * noise) as i16
    };
    let values = VoxelValues::I16((0..DIMS.iter().product()).map(&mut value).collect());
    Volume::new(DIMS, DMat3::from_diagonal(DVec3::splat(VOXEL)), DVec3::new(100.0, 50.0, -20.0), values).unwrap()
}

/// The curve in the scene.
fn path(seed: u64) -> Vec<DVec3> {
    middle(seed).into_iter().map(|p| VOXEL * p + DVec3::new(100.0, 50.0, -20.0)).collect()
}

fn scene(volume: Volume, transfer: TransferFunction) -> Scene {
    let kind = LayerKind::Volume(VolumeLayer::new(volume, transfer));
    let layers = vec![Layer { id: "vessel".into(), must_see: false, kind }];
    Scene { title: "A vessel".into(), crs: Crs::Local, unit: Unit::Voxel, layers, ..Scene::default() }
}

#[test]
fn walls_are_found_midway_whether_the_lumen_is_bright_or_dark() {
    for seed in 0..2 {
        for (tissue, thick) in [(BRIGHT, 8.0), (DARK, 3.0)] {
            for noise in [0.0, 40.0] {
                let tissue = Tissue { noise, ..tissue };
                let wall = find_wall(&vessel(seed, tissue, thick), &path(seed)).unwrap();
                let off = (wall.isovalue - 0.5 * (tissue.lumen + tissue.wall)) / (tissue.wall - tissue.lumen);
                assert!((wall.lumen - tissue.lumen).abs() < 2.0 + 0.5 * noise, "{wall:?}");
                assert!(off.abs() < 0.08 && wall.share > 0.7, "seed {seed}, noise {noise}: {wall:?}, off by {off}");
            }
        }
    }
}

#[test]
fn where_nothing_differs_from_the_path_no_wall_is_made_up() {
    let flat = Tissue { lumen: 40.0, wall: 40.0, around: 40.0, beside: 40.0, noise: 30.0 };
    let volume = vessel(1, flat, 3.0);
    let error = find_wall(&volume, &path(1)).unwrap_err();
    assert!(matches!(error, ConstructError::NoWall { .. }), "{error}");
    let away: Vec<DVec3> = path(1).into_iter().map(|p| p + 500.0 * DVec3::X).collect();
    assert!(matches!(find_wall(&volume, &away), Err(ConstructError::PathOutside)));
    assert_eq!([share_inside(&volume, &away), share_inside(&volume, &path(1))], [0.0, 1.0]);
}

#[test]
fn the_wall_of_a_real_vessel_is_found() {
    let Some(file) = belvedere_testkit::data("volumes/aneurism.vti") else { return };
    let request = belvedere_io::VolumeRequest::default();
    let file = belvedere_io::load_volume(&file, &request).unwrap().value;
    let volume = Volume::new(file.dims, file.axes, file.origin, file.values).unwrap();
    let [from, to] = [[185.0, 35.0, 152.0], [95.0, 119.0, 179.0]].map(DVec3::from_array);
    let path = centreline(&volume, from, to, [110.0, 255.0]).unwrap().points;
    let wall = find_wall(&volume, &path).unwrap();
    // Vessels of 255 in tissue of about 0.
    assert!((110.0..150.0).contains(&wall.isovalue) && wall.lumen > 250.0 && wall.share > 0.9, "{wall:?}");
}

/// Share of a picture in which the ray sees a place of the vessel's wall: its first absorbing value within a voxel of the border.
fn wall_share(scene: &Scene, view: &View, middle: &[DVec3]) -> f64 {
    let (light, progress) = (Light::default(), Progress::silent());
    let options = RenderOptions { samples: 1, ..RenderOptions::default() };
    let job = RenderJob { scene, view, light: &light, options: &options, progress: &progress };
    let frame = CpuRenderer::default().render(&job).unwrap();
    let [w, h] = IMAGE;
    let on_wall = |i: usize| {
        let depth = f64::from(frame.depth[i]);
        let pixel = DVec2::new((i as u32 % w) as f64 + 0.5, (i as u32 / w) as f64 + 0.5);
        let Ok(at) = view.ray(pixel).at(depth) else { return false };
        let off = middle.iter().map(|q| q.distance(at.point)).fold(f64::INFINITY, f64::min) / VOXEL;
        (off - RADIUS).abs() < 1.5
    };
    (0..(w * h) as usize).filter(|i| frame.id[*i] != 0 && on_wall(*i)).count() as f64 / f64::from(w * h)
}

#[test]
fn previews_of_vessels_show_the_wall_alone_from_inside() {
    for (seed, tissue, thick) in [(0, BRIGHT, 8.0), (1, DARK, 3.0)] {
        let volume = vessel(seed, Tissue { noise: 15.0, ..tissue }, thick);
        let path = path(seed);
        let wall = find_wall(&volume, &path).unwrap();
        let scene = scene(volume, TransferFunction::wall(wall.lumen, wall.isovalue, wall.wall));
        let usual = Lens { width_m: 25.0, ..Lens::for_preview(25.0, false) };
        let preview = match seed {
            0 => PathPreview::fitted(&scene, &path, 25.0, usual, false, IMAGE),
            // A lens of one's own; only the eye is fitted.
            _ => PathPreview::new(&path, 25.0, Lens { width_m: 12.0, ..usual }, false, IMAGE)
                .and_then(|preview| preview.standing_in(&scene, IMAGE)),
        };
        let preview = preview.unwrap();
        // The picture is about twice as wide as the vessel, and no more.
        let diameters = preview.lens().width_m / (2.0 * RADIUS * VOXEL);
        assert!((0.7..=2.1).contains(&diameters), "seed {seed}: {diameters} diameters wide");
        let mut seen = Vec::new();
        for k in [1, 3, 6, 8] {
            let at = 0.1 * f64::from(k) * preview.length();
            let view = preview.at(at, IMAGE, None).unwrap().view;
            let eye = view.pinhole().eye;
            let off = path.iter().map(|q| q.distance(eye)).fold(f64::INFINITY, f64::min) / VOXEL;
            assert!(off < RADIUS, "seed {seed} at {at:.1}: the eye is {off:.1} voxels off the path");
            let share = wall_share(&scene, &view, &path);
            assert!(share > 0.99, "seed {seed} at {at:.1}: {share} of the picture shows the wall");
            let ahead = preview.samples(at, 24f64.min(preview.length() - at), 1.0);
            seen.push(TargetSight::new(&scene, &Target::points(ahead)).share(&view, 0.0));
        }
        let mean = seen.iter().sum::<f64>() / seen.len() as f64;
        assert!(mean >= 0.96, "seed {seed}: {seen:.2?} of the path ahead is seen");
    }
}
