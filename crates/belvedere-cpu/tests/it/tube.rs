//! Tubes along centrelines: volumes and surfaces straightened, by both renderers, and a cut beside a straight CPR.

use crate::exact::{difference, trace};
use crate::support::{layer, options, render, scene};
use belvedere_core::map::straighten::{SmoothedCentreline, Tube};
use belvedere_core::{DMat3, DVec2, DVec3, Pinhole, Projection, Stage, View};
use belvedere_scene::{
    BoxLayer, BoxShape, Color, LayerKind, Scene, TransferFunction, TransferPoint, Volume, VolumeLayer, VolumeModel,
    VoxelValues,
};

/// Voxels along each side; the space that they fill lies around the origin.
const SIDE: usize = 72;
const RADIUS: f64 = 8.0;

/// A vessel that winds through the voxels.
fn place(t: f64) -> DVec3 {
    DVec3::new(22.0 * (2.6 * t).cos(), 20.0 * (2.6 * t).sin(), 40.0 * (t - 0.5) + 4.0 * (5.0 * t).sin())
}

fn tube(share: f64) -> Tube {
    let points: Vec<DVec3> = (0..=300).map(|i| place(f64::from(i) / 300.0)).collect();
    let line = SmoothedCentreline::new(&points, 2.0, None).unwrap_or_else(|e| panic!("{e}"));
    Tube::parted(line.curve, RADIUS, share, place(0.5)).unwrap_or_else(|e| panic!("{e}"))
}

/// A bright vessel with a darker wall in tissue that changes slowly.
fn value(p: DVec3) -> f64 {
    let off = (0..=120).map(|i| place(f64::from(i) / 120.0).distance(p)).fold(f64::INFINITY, f64::min);
    let tissue = 70.0 + 9.0 * (0.11 * p.x).sin() + 8.0 * (0.09 * p.y + 0.13 * p.z).cos();
    tissue + 130.0 * (-(off / 3.0).powi(2)).exp()
}

fn voxels(transfer: TransferFunction, model: VolumeModel, step: f64) -> Scene {
    let half = 0.5 * (SIDE - 1) as f64;
    let at = |i: usize| DVec3::new((i % SIDE) as f64, (i / SIDE % SIDE) as f64, (i / SIDE / SIDE) as f64) - half;
    let values = VoxelValues::F32((0..SIDE.pow(3)).map(|i| value(at(i)) as f32).collect());
    let volume = Volume::new([SIDE; 3], DMat3::IDENTITY, DVec3::splat(-half), values).expect("well formed");
    let mut drawn = VolumeLayer::new(volume, transfer);
    (drawn.model, drawn.step) = (model, step);
    scene(vec![layer("voxels", LayerKind::Volume(drawn))])
}

/// Colours and opacities by value, of steps of this many voxel edges.
fn by_value(points: &[(f64, u8, f64)], reference_step: f64) -> TransferFunction {
    let point = |&(value, grey, opacity)| TransferPoint { value, color: Color::rgb(grey, grey, grey), opacity };
    TransferFunction::new("test", points.iter().map(point).collect(), reference_step).expect("rising")
}

/// A camera across the straightened line; `cut`: its near plane goes through the line.
fn camera(tube: &Tube, image: [u32; 2], cut: bool) -> Pinhole {
    let [start, end] = [0.0, tube.line().length()].map(|g| tube.unrolled().at(g).p);
    let (middle, along) = (0.5 * (start + end), (end - start).normalize());
    let up = DVec3::Z.reject_from_normalized(along).normalize();
    let forward = up.cross(along);
    let height = start.distance(end) * f64::from(image[1]) / f64::from(image[0]);
    let near = if cut { 30.0 } else { 20.0 };
    let lens = Projection::Orthographic { height };
    Pinhole::look_at(middle - 30.0 * forward, middle, up, lens, image, near, Some(40.0)).expect("a camera")
}

fn view(tube: Tube, image: [u32; 2], cut: bool) -> View {
    View::new(camera(&tube, image, cut), vec![Stage::Tube(tube)]).expect("in order")
}

#[test]
fn a_cut_shows_the_values_of_a_straight_cpr() {
    let tube = tube(1.0);
    let grey = by_value(&[(0.0, 0, 1.0), (255.0, 255, 1.0)], 0.01);
    let scene = voxels(grey, VolumeModel::Plain, 0.01);
    let LayerKind::Volume(layer) = &scene.layers[0].kind else { unreachable!() };
    let volume = &layer.volume;
    let view = view(tube.clone(), [460, 64], true);
    let frame = render(&scene, &view, &options(1));
    let anchor = tube.line().nearest(place(0.5));
    let straight = tube.line().at(anchor);
    let (mut on_centre, mut elsewhere) = (Vec::new(), Vec::new());
    for (i, color) in frame.color.iter().enumerate() {
        let pixel = DVec2::new((i % frame.width) as f64 + 0.5, (i / frame.width) as f64 + 0.5);
        // The place of the cut that the pixel looks at, in coordinates of the straightened line.
        let q = view.pinhole().unproject(pixel, 30.0) - straight.p;
        let (along, across) = (
            q.dot(straight.tangent()),
            DVec2::new(q.dot(straight.beside(DVec2::X) - straight.p), q.dot(straight.beside(DVec2::Y) - straight.p)),
        );
        let cpr = tube.line().at(anchor + along).beside(across);
        let Some(expected) = volume.at(volume.lattice_from_scene(cpr)) else { continue };
        if tube.coordinates(cpr).is_none_or(|at| at.a.distance(across) > 1e-6) {
            continue;
        }
        let off = (f64::from(color[0]) - expected).abs();
        if across.length() < 0.5 { on_centre.push(off) } else { elsewhere.push(off) }
    }
    let worst = |all: &[f64]| all.iter().copied().fold(0.0, f64::max);
    assert!(on_centre.len() > 400 && worst(&on_centre) <= 1.0, "{} {}", on_centre.len(), worst(&on_centre));
    let within = elsewhere.iter().filter(|off| **off <= 1.0).count();
    let worst = worst(&elsewhere);
    assert!(within as f64 > 0.999 * elsewhere.len() as f64, "{within} of {}, worst {worst}", elsewhere.len());
    assert!(elsewhere.len() > 10_000, "{}", elsewhere.len());
}

#[test]
fn the_straightened_vessel_is_straight_and_in_the_middle() {
    let tube = tube(1.0);
    let bright = by_value(&[(0.0, 255, 0.0), (130.0, 255, 0.0), (140.0, 255, 1.0), (255.0, 255, 1.0)], 1.0);
    let scene = voxels(bright, VolumeModel::Plain, 0.25);
    let frame = render(&scene, &view(tube, [460, 64], false), &options(1));
    let is_hit = |x: usize, y: usize| frame.depth[y * frame.width + x].is_finite();
    for x in 20..frame.width - 20 {
        let hit: Vec<usize> = (0..frame.height).filter(|y| is_hit(x, *y)).collect();
        let (first, last) = (hit[0] as f64, hit[hit.len() - 1] as f64);
        assert!((0.5 * (first + last) - 31.5).abs() <= 1.0, "column {x}: rows {first} to {last}");
    }
}

#[test]
fn both_renderers_draw_the_same_voxels() {
    for share in [1.0, 0.6] {
        for model in [VolumeModel::Plain, VolumeModel::Shaded] {
            let veil = by_value(&[(0.0, 60, 0.0), (80.0, 90, 0.0), (120.0, 120, 0.2), (255.0, 255, 0.9)], 1.0);
            let (scene, view) = (voxels(veil, model, 0.5), view(tube(share), [120, 40], false));
            let (fast, exact) = (render(&scene, &view, &options(1)), trace(&scene, &view, &options(1)));
            let differs = |i: &usize| (0..3).any(|c| fast.color[*i][c].abs_diff(exact.color[*i][c]) > 6);
            let count = (0..fast.color.len()).filter(differs).count();
            assert!(count * 100 < fast.color.len(), "share {share}: {count} of {} differ", fast.color.len());
            assert!(fast.depth.iter().filter(|d| d.is_finite()).count() > 500);
        }
    }
}

#[test]
fn rasteriser_and_tracer_agree_on_surfaces() {
    // Boxes beside the line.
    let cube = |i: i32| {
        let p = place(f64::from(i) / 40.0) + DVec3::new(2.0, -2.0, 1.0);
        BoxShape { base: p, size: DVec3::splat(3.2), yaw: 0.1 * f64::from(i), color: Color::rgb(190, 180, 170) }
    };
    let boxes = (0..=40).map(cube).collect();
    let scene = scene(vec![layer("boxes", LayerKind::Boxes(BoxLayer::new(boxes)))]);
    for share in [1.0, 0.5] {
        let d = difference(&scene, &view(tube(share), [200, 60], false));
        // The borders of the cells of a tube that meets itself are drawn to a 64th of a triangle.
        assert!(d.is_below([1e-3, 5e-3]), "share {share}: {d:?}");
    }
}
