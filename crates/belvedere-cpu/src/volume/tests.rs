//! Volumes against closed forms, and the fast method against the reference.

use super::clip::Segment;
use super::march::Marcher;
use super::ray::Rays;
use super::{Gathered, reference};
use belvedere_core::map::StageMap;
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{
    CurvedRays, DMat3, DVec2, DVec3, EarthCurvature, Miss, Pinhole, Projection, SpaceMap, SplineBend, Stage, View,
};
use belvedere_scene::{
    Color, Crs, Layer, LayerKind, Scene, TransferFunction, TransferPoint, Unit, Volume, VolumeLayer, VolumeModel,
    VoxelValues,
};
use belvedere_sight::Voxels;
use belvedere_sight::volume::place_in_step;

const IMAGE: [u32; 2] = [64, 48];

fn pinhole(eye: DVec3, look_at: DVec3, lens: Projection) -> Pinhole {
    Pinhole::look_at(eye, look_at, DVec3::Z, lens, IMAGE, 1.0, None).unwrap()
}

fn camera() -> Pinhole {
    pinhole(DVec3::new(-60.0, -90.0, 70.0), DVec3::new(20.0, 20.0, 16.0), Projection::Perspective { fov_y: 0.3 })
}

/// A view with turns at distances from the eye; each transition extends a tenth of the distance to both sides.
fn bent(model: Model, turns: &[(f64, DVec3)]) -> View {
    bent_in(camera(), model, turns)
}

fn bent_in(pinhole: Pinhole, model: Model, turns: &[(f64, DVec3)]) -> View {
    let spec = |&(at, viewpoint): &(f64, DVec3)| TurnSpec {
        viewpoint: pinhole.eye + viewpoint,
        t0: pinhole.eye + pinhole.forward * (0.9 * at),
        t1: pinhole.eye + pinhole.forward * at,
        t2: pinhole.eye + pinhole.forward * (1.1 * at),
        pencil: Pencil::Parallel { normal: -pinhole.forward },
        m: Sharpness::Bend,
    };
    let specs: Vec<TurnSpec> = turns.iter().map(spec).collect();
    let rays = CurvedRays::new(&pinhole, model, &specs).unwrap();
    View::new(pinhole, vec![Stage::CurvedRays(rays)]).unwrap()
}

/// Views of a volume of about 40 units around (20, 20, 16), each with a turn inside it where there is one.
fn views() -> Vec<(&'static str, View)> {
    let side = DVec3::new(-40.0, 30.0, 20.0);
    let level = ReferencePlane::level(0.0);
    let document = PresetDocument::builtin("progressive").unwrap();
    let spline = SplineBend::new(&camera(), &document, &level, default_pivot(&camera(), &level)).unwrap();
    let spline = View::new(spline.adapted_pinhole(&camera()), vec![Stage::SplineBend(spline)]).unwrap();
    let earth = EarthCurvature { eye: camera().eye, radius: 900.0, refraction: 0.13 };
    let parallel = pinhole(camera().eye, DVec3::new(20.0, 20.0, 16.0), Projection::Orthographic { height: 40.0 });
    vec![
        ("straight", View::straight(camera())),
        ("parallel", View::straight(parallel)),
        ("modified", bent(Model::Modified, &[(146.0, side)])),
        ("original", bent(Model::Original, &[(146.0, side)])),
        ("kink", bent(Model::C0, &[(146.0, side)])),
        ("C2", bent(Model::C2, &[(146.0, side)])),
        ("two turns", bent(Model::Modified, &[(130.0, side), (165.0, -side)])),
        ("spline", spline),
        ("small planet", View::new(camera(), vec![Stage::EarthCurvature(earth)]).unwrap()),
        ("a map of one's own", View::new(camera(), vec![Stage::own(Swayed)]).unwrap()),
    ]
}

/// `x' = x + 6 sin(y / 10)`.
#[derive(Debug)]
struct Swayed;

impl SpaceMap for Swayed {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        Ok(p + 6.0 * (0.1 * p.y).sin() * DVec3::X)
    }
    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        Ok(p_displaced - 6.0 * (0.1 * p_displaced.y).sin() * DVec3::X)
    }
    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        Ok(DMat3::from_cols(DVec3::X, DVec3::new(0.6 * (0.1 * p.y).cos(), 1.0, 0.0), DVec3::Z))
    }
}

impl StageMap for Swayed {}

const RANGE: [f64; 2] = [1.0, 2000.0];
const CENTER: DVec2 = DVec2::splat(0.5);

/// Light that one ray gathers, with samples at a place within their steps.
fn alone(marcher: &Marcher<'_>, segments: &[Segment], within: f64) -> Gathered {
    marcher.gather(segments, &[segments.len()], &[within])[0]
}

fn center(pixel: [usize; 2]) -> DVec2 {
    DVec2::from_array(pixel.map(|v| v as f64)) + CENTER
}

/// Light gathered by the fast method, and the segments.
fn fast(view: &View, layer: &VolumeLayer, pixel: [usize; 2], far: f64) -> (Gathered, Vec<Segment>) {
    let marcher = Marcher::new(layer);
    let rays = Rays::new(view, RANGE);
    let mut out = None;
    let wanted = |x: usize| (x == pixel[0]).then_some(far);
    rays.row((pixel[1], CENTER), IMAGE[0] as usize, &layer.volume, wanted, |_, segments| {
        let mut found = alone(&marcher, segments, place_in_step(center(pixel)));
        found.half = found.half.map(|(depth, place)| (rays.depth_of(place, depth), place));
        out = Some((found, segments.to_vec()));
    });
    out.unwrap()
}

fn exact(view: &View, layer: &VolumeLayer, pixel: [usize; 2], far: f64) -> Gathered {
    reference::gather(view, layer, center(pixel), [RANGE[0], far.min(RANGE[1])])
}

fn pixels() -> impl Iterator<Item = [usize; 2]> {
    (0..96usize).map(|i| [i * 37 % 64, i * 11 % 48])
}

/// A transfer function with one opacity from a value on, and 0 below.
fn from_value(value: f64, opacity: f64) -> TransferFunction {
    let point = |value, opacity| TransferPoint { value, color: Color::rgb(255, 255, 255), opacity };
    TransferFunction::new("test", vec![point(value, 0.0), point(value, opacity)], 1.0).unwrap()
}

/// Length of a ray within `inside`, by short steps in depth.
fn length_within(view: &View, [x, y]: [usize; 2], range: [f64; 2], inside: impl Fn(DVec3) -> bool) -> f64 {
    let ray = view.ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
    let steps = 400_000;
    let at = |i: usize| ray.at(range[0] + (range[1] - range[0]) * i as f64 / steps as f64).unwrap().point;
    let mut before = at(0);
    let mut sum = 0.0;
    for i in 1..=steps {
        let here = at(i);
        if inside(before.lerp(here, 0.5)) {
            sum += before.distance(here);
        }
        before = here;
    }
    sum
}

#[test]
fn a_homogeneous_box_absorbs_by_the_length_of_the_ray_whatever_the_step() {
    let turn = DMat3::from_rotation_z(0.4) * DMat3::from_diagonal(DVec3::new(1.5, 1.0, 2.0));
    let volume =
        Volume::new([20, 30, 12], turn, DVec3::new(18.0, 2.0, 4.0), VoxelValues::U16(vec![700; 7200])).unwrap();
    let mut layer = VolumeLayer::new(volume, from_value(0.0, 0.04));
    layer.model = VolumeModel::Plain;
    let most = DVec3::new(19.0, 29.0, 11.0);
    let volume = layer.volume.clone();
    let inside = |p: DVec3| {
        let q = volume.lattice_from_scene(p);
        q.cmpge(DVec3::ZERO).all() && q.cmple(most).all()
    };
    let mut crossed = 0;
    for (name, view) in views().into_iter().filter(|(name, _)| *name != "small planet" && *name != "spline") {
        for pixel in [[32, 24], [21, 20], [43, 29]] {
            let length = length_within(&view, pixel, [60.0, 260.0], inside);
            let want = 1.0 - 0.96f64.powf(length);
            crossed += u32::from(length > 20.0);
            for step in [0.3, 0.5, 1.0, 2.7] {
                layer.step = step;
                let (found, _) = fast(&view, &layer, pixel, 1e9);
                let off = (f64::from(found.alpha) - want).abs();
                assert!(off < 2e-4, "{name} {pixel:?} step {step}: {} for {want} over {length}", found.alpha);
                for (depth, _) in [found.half, exact(&view, &layer, pixel, 1e9).half].into_iter().flatten() {
                    let (way, half) = (length_within(&view, pixel, [60.0, depth], inside), 0.5f64.ln() / 0.96f64.ln());
                    assert!((way - half).abs() < 0.05, "{name} {pixel:?} step {step}: half after {way} for {half}");
                }
            }
            let off = (f64::from(exact(&view, &layer, pixel, 1e9).alpha) - want).abs();
            // The chord of a step over a kink is shorter than the arc.
            assert!(off < if name == "kink" { 1e-3 } else { 2e-4 }, "{name} {pixel:?}: reference off by {off}");
        }
    }
    assert!(crossed > 12, "{crossed}");
}

#[test]
fn a_homogeneous_ball_absorbs_by_its_chord() {
    let n = 65;
    let radius = 12.0f64;
    let centre = DVec3::new(20.0, 20.0, 16.0);
    let at = |i: usize| DVec3::new((i % n) as f64, (i / n % n) as f64, (i / n / n) as f64) * 0.5;
    let origin = centre - DVec3::splat(16.0);
    let values = (0..n * n * n).map(|i| (radius - (origin + at(i)).distance(centre)) as f32).collect();
    let axes = DMat3::from_diagonal(DVec3::splat(0.5));
    let volume = Volume::new([n; 3], axes, origin, VoxelValues::F32(values)).unwrap();
    let mut layer = VolumeLayer::new(volume, from_value(0.0, 0.02));
    let mut crossed = 0;
    for (name, view) in views().into_iter().filter(|(name, _)| ["straight", "modified", "kink"].contains(name)) {
        for pixel in [[32, 24], [28, 22], [37, 26], [50, 40]] {
            let length = length_within(&view, pixel, [60.0, 260.0], |p| p.distance(centre) < radius);
            crossed += u32::from(length > 10.0);
            let want = 1.0 - 0.98f64.powf(2.0 * length);
            for step in [0.25, 0.5, 1.0] {
                layer.step = step;
                let (found, _) = fast(&view, &layer, pixel, 1e9);
                // The steps in which the ray enters and leaves count whole or not at all.
                let bound = 0.02 * step + 5e-4;
                let off = (f64::from(found.alpha) - want).abs();
                assert!(off < bound, "{name} {pixel:?} step {step}: {} for {want}", found.alpha);
            }
        }
    }
    assert!(crossed > 5, "{crossed}");
}

/// Storage of made-up values.
type Stored = fn(Vec<f64>) -> VoxelValues;

/// Waves and a shell: empty, thin and dense parts.
fn wavy(values: Stored) -> Volume {
    let [nx, ny, nz] = [41, 37, 33];
    let of = |i: usize| {
        let p = DVec3::new((i % nx) as f64, (i / nx % ny) as f64, (i / nx / ny) as f64);
        let r = p.distance(DVec3::new(20.0, 18.0, 15.0));
        let wave = (p.x * 0.31).sin() * (p.y * 0.23).cos() * (p.z * 0.29 + 1.0).sin();
        0.5 + 0.35 * (-((r - 11.0) / 3.0).powi(2)).exp() - 0.3 * f64::from(u8::from(r > 16.5)) + 0.15 * wave
    };
    let axes = DMat3::from_rotation_z(0.3) * DMat3::from_diagonal(DVec3::new(1.0, 1.1, 0.9));
    Volume::new([nx, ny, nz], axes, DVec3::new(7.0, -3.0, 1.0), values((0..nx * ny * nz).map(of).collect())).unwrap()
}

fn colors(volume: Volume) -> VolumeLayer {
    let [lo, hi] = volume.range().map(f64::from);
    let stops =
        [(0.0, [0, 0, 0], 0.0), (0.5, [90, 90, 200], 0.0), (0.6, [90, 200, 90], 0.05), (0.9, [250, 160, 40], 0.6)];
    let point = |(share, [r, g, b], opacity): (f64, [u8; 3], f64)| TransferPoint {
        value: lo + share * (hi - lo),
        color: Color::rgb(r, g, b),
        opacity,
    };
    VolumeLayer::new(volume, TransferFunction::new("test", stops.map(point).to_vec(), 1.0).unwrap())
}

#[test]
fn the_fast_way_is_the_obvious_one_in_every_view_and_for_every_type() {
    let kinds: [(&str, Stored); 4] = [
        ("u8", |v| VoxelValues::U8(v.into_iter().map(|v| (255.0 * v) as u8).collect())),
        ("u16", |v| VoxelValues::U16(v.into_iter().map(|v| (60000.0 * v) as u16).collect())),
        ("i16", |v| VoxelValues::I16(v.into_iter().map(|v| (60000.0 * v - 30000.0) as i16).collect())),
        ("f32", |v| VoxelValues::F32(v.into_iter().map(|v| v as f32 * 1e-3).collect())),
    ];
    for (kind, values) in kinds {
        let layer = colors(wavy(values));
        for (name, view) in views() {
            let (mut sum, mut worst, mut seen, mut count) = (0.0, 0.0f32, 0, 0);
            for pixel in pixels().step_by(if kind == "u8" { 1 } else { 4 }) {
                let (a, _) = fast(&view, &layer, pixel, 1e9);
                let b = exact(&view, &layer, pixel, 1e9);
                let off = (a.color - b.color).abs().max_element().max((a.alpha - b.alpha).abs());
                assert!(off.is_finite());
                sum += f64::from(off);
                worst = worst.max(off);
                seen += u32::from(b.alpha > 0.2);
                count += 1;
            }
            let mean = 255.0 * sum / f64::from(count);
            assert!(seen * 8 > count, "{kind} {name}: {seen} of {count} rays see anything");
            assert!(mean < 0.2 && worst < 3.0 / 255.0, "{kind} {name}: mean {mean}/255, worst {}/255", 255.0 * worst);
        }
    }
}

#[test]
fn samples_go_on_over_joints_as_if_there_were_none() {
    let layer = colors(wavy(|v| VoxelValues::U8(v.into_iter().map(|v| (255.0 * v) as u8).collect())));
    let marcher = Marcher::new(&layer);
    let mut joined = 0;
    for pixel in pixels() {
        let (whole, segments) = fast(&View::straight(camera()), &layer, pixel, 1e9);
        let [segment] = segments[..] else { continue };
        let cut = |ends: [f64; 2], is_new| Segment {
            curve: segment.curve.part(ends),
            length: segment.length * (ends[1] - ends[0]),
            is_new,
            ..segment
        };
        let parts = [cut([0.0, 0.2345], true), cut([0.2345, 0.61], false), cut([0.61, 1.0], false)];
        let within = place_in_step(center(pixel));
        let again = alone(&marcher, &parts, within);
        assert!((again.alpha - whole.alpha).abs() < 2e-3 && again.color.distance(whole.color) < 2e-3, "{pixel:?}");
        let apart = alone(&marcher, &parts.map(|part| Segment { is_new: true, ..part }), place_in_step(center(pixel)));
        joined += u32::from(apart.alpha != again.alpha);
    }
    assert!(joined > 5, "steps that begin anew at every joint give other pictures: {joined}");
}

#[test]
fn interpolated_rays_are_those_computed_on_their_own() {
    let layer = colors(wavy(|v| VoxelValues::U8(v.into_iter().map(|v| (255.0 * v) as u8).collect())));
    let camera = || Pinhole { image: [640, 480], ..camera() };
    let side = DVec3::new(-40.0, 30.0, 20.0);
    let turned = |model| bent_in(camera(), model, &[(146.0, side)]);
    let views = [
        ("straight", View::straight(camera())),
        ("modified", turned(Model::Modified)),
        ("original", turned(Model::Original)),
        ("kink", turned(Model::C0)),
        ("C2", turned(Model::C2)),
        ("two turns", bent_in(camera(), Model::Modified, &[(130.0, side), (165.0, -side)])),
    ];
    for (name, view) in views {
        let rays = Rays::new(&view, RANGE);
        let mut alone = Rays::new(&view, RANGE);
        alone.forget_neighbours();
        let (mut met, mut copied) = (0, 0);
        for y in [100, 200, 240, 301, 380] {
            let ends = |x: usize| Some(if x.is_multiple_of(3) { 150.0 } else { 1e9 });
            let mut want = Vec::new();
            alone.row((y, CENTER), 640, &layer.volume, ends, |_, segments| want.push(segments.to_vec()));
            rays.row((y, CENTER), 640, &layer.volume, ends, |x, found| {
                let want = &want[x];
                let length = |list: &[Segment]| list.iter().map(|s| s.length).sum::<f64>();
                let off = (length(found) - length(want)).abs();
                assert!(off < 0.02 || length(want) < 1.0, "{name} {x} {y}: {} for {}", length(found), length(want));
                let ([Some(a), Some(b)], [Some(p), Some(q)]) =
                    ([found.first(), want.first()], [found.last(), want.last()])
                else {
                    return;
                };
                if length(want) > 1.0 {
                    met += 1;
                    copied += u32::from(a.curve == b.curve && p.curve == q.curve);
                    let ends = [(a.curve.at(0.0), b.curve.at(0.0)), (p.curve.at(1.0), q.curve.at(1.0))];
                    assert!(ends.iter().all(|(a, b)| a.distance(*b) < 0.02), "{name} {x} {y}: {ends:?}");
                    let depths = [a.depth.at(0.0) - b.depth.at(0.0), p.depth.at(1.0) - q.depth.at(1.0)];
                    assert!(depths.iter().all(|d| d.abs() < 0.02), "{name} {x} {y}: {depths:?}");
                    let breaks = |list: &[Segment]| list.iter().filter(|s| s.is_new).count();
                    assert_eq!(breaks(found), breaks(want), "{name} {x} {y}");
                }
            });
        }
        assert!(met > 500, "{name}: {met}");
        assert!(copied * 2 < met, "{name}: {copied} of {met} rays are not interpolated");
    }
}

#[test]
fn rays_side_by_side_gather_what_each_gathers_alone() {
    let layer = colors(wavy(|v| VoxelValues::U8(v.into_iter().map(|v| (255.0 * v) as u8).collect())));
    let marcher = Marcher::new(&layer);
    let view = bent(Model::Modified, &[(146.0, DVec3::new(-40.0, 30.0, 20.0))]);
    let rays = Rays::new(&view, RANGE);
    let (mut segments, mut ends) = (Vec::new(), Vec::new());
    for y in 0..IMAGE[1] as usize {
        rays.row(
            (y, CENTER),
            IMAGE[0] as usize,
            &layer.volume,
            |_| Some(1e9),
            |_, ray| {
                segments.extend_from_slice(ray);
                ends.push(segments.len());
            },
        );
    }
    let within: Vec<f64> = (0..ends.len()).map(|i| (0.3 * i as f64).fract()).collect();
    let together = marcher.gather(&segments, &ends, &within);
    let mut begin = 0;
    let mut seen = 0;
    for (i, (end, found)) in ends.iter().zip(&together).enumerate() {
        assert_eq!(*found, alone(&marcher, &segments[begin..*end], within[i]));
        seen += u32::from(found.alpha > 0.0);
        begin = *end;
    }
    assert!(seen > 500, "{seen}");
}

#[test]
fn leaps_miss_nothing_and_save_samples() {
    let layer = colors(wavy(|v| VoxelValues::U8(v.into_iter().map(|v| (255.0 * v) as u8).collect())));
    let (mut all, mut taken) = (0, 0);
    for (name, view) in views() {
        for pixel in pixels() {
            let (found, segments) = fast(&view, &layer, pixel, 1e9);
            let mut plodding = Marcher::new(&layer);
            plodding.forget_leaps();
            let want = alone(&plodding, &segments, place_in_step(center(pixel)));
            let off = (found.alpha - want.alpha).abs().max(found.color.distance(want.color));
            assert!(off < 2e-3, "{name} {pixel:?}: {found:?} {want:?}");
            (all, taken) = (all + want.samples, taken + found.samples);
        }
    }
    assert!(f64::from(taken) < 0.9 * f64::from(all), "{taken} of {all}");
}

#[test]
fn every_pixel_that_sees_anything_lies_in_the_spans() {
    // One brick seen towards its faces.
    let axes = DMat3::from_rotation_z(0.3) * DMat3::from_diagonal(DVec3::splat(2.0));
    let block = Volume::new([9; 3], axes, DVec3::new(14.0, 10.0, 8.0), VoxelValues::U8(vec![200; 729])).unwrap();
    let layer = VolumeLayer::new(block, from_value(100.0, 0.5));
    for (name, view) in views() {
        let spans = Marcher::new(&layer).spans(&view);
        let [mut held, mut seen] = [0, 0];
        for pixel in (0..IMAGE[0] as usize).flat_map(|x| (0..IMAGE[1] as usize).map(move |y| [x, y])) {
            let (holds, sees) = (spans.hold(pixel), fast(&view, &layer, pixel, 1e9).0.alpha > 0.0);
            assert!(holds || !sees, "{name} {pixel:?}");
            (held, seen) = (held + u32::from(holds), seen + u32::from(sees));
        }
        assert!(seen > 0 && (name != "straight" || held < 3 * seen), "{name}: {seen} of {held}");
    }
}

#[test]
fn what_lies_behind_a_surface_is_not_gathered_and_places_are_seen_where_they_are() {
    let layer = colors(wavy(|v| VoxelValues::U8(v.into_iter().map(|v| (255.0 * v) as u8).collect())));
    let mut halves = 0;
    for (name, view) in views() {
        for pixel in pixels() {
            let (whole, _) = fast(&view, &layer, pixel, 1e9);
            let Some((depth, place)) = whole.half else { continue };
            halves += 1;
            let image = view.project(place).unwrap();
            let centre = DVec2::new(pixel[0] as f64 + 0.5, pixel[1] as f64 + 0.5);
            assert!(image.pixel.distance(centre) < 0.05, "{name} {pixel:?}: {}", image.pixel);
            assert!((image.depth - depth).abs() < 0.05, "{name}: {} {depth}", image.depth);
            let (before, _) = fast(&view, &layer, pixel, depth - 1.0);
            let obvious = exact(&view, &layer, pixel, depth - 1.0);
            assert!(before.alpha < whole.alpha && before.half.is_none(), "{name} {pixel:?}");
            assert!((before.alpha - obvious.alpha).abs() < 0.02, "{name}: {} {}", before.alpha, obvious.alpha);
        }
    }
    assert!(halves > 100, "{halves}");
}

#[test]
fn lines_of_sight_let_through_what_the_picture_does() {
    let mut layer = colors(wavy(|v| VoxelValues::U8(v.into_iter().map(|v| (255.0 * v) as u8).collect())));
    layer.transfer = TransferFunction::new("thin", layer.transfer.points().to_vec(), 8.0).unwrap();
    let kind = LayerKind::Volume(layer.clone());
    let layers = vec![Layer { id: "wavy".into(), must_see: false, kind }];
    let scene = Scene { title: String::new(), crs: Crs::Local, unit: Unit::Voxel, layers, ..Scene::default() };
    let voxels = Voxels::without(&scene, &[]);
    let (mut dim, mut worst) = (0, 0.0f64);
    for (name, view) in views() {
        for (pixel, depth) in pixels().zip([120.0, 135.0, 150.0, 300.0].into_iter().cycle()) {
            let centre = DVec2::new(pixel[0] as f64 + 0.5, pixel[1] as f64 + 0.5);
            let Ok(point) = view.ray(centre).at(depth) else { continue };
            // To within one voxel edge before the point, which does not hide itself.
            let before = view.ray(centre).at(depth - 1e-3).map_or(1.0, |p| p.point.distance(point.point) / 1e-3);
            let want = 1.0 - f64::from(exact(&view, &layer, pixel, depth - layer.volume.voxel_edge() / before).alpha);
            let off = (voxels.light(&view, centre, depth) - want).abs();
            assert!(off < 0.02, "{name} {pixel:?} {depth}: off by {off} of {want}");
            worst = worst.max(off);
            dim += u32::from(want > 0.1 && want < 0.9);
        }
    }
    assert!(dim > 80, "{dim} are neither light nor dark; worst {worst}");
}

#[test]
fn samples_of_neighbouring_pixels_lie_apart_within_their_steps_and_fill_them_evenly() {
    let of = |x: i32, y: i32| place_in_step(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
    let mut counts = [0; 8];
    for (x, y) in (0..64).flat_map(|y| (0..64).map(move |x| (x, y))) {
        counts[(8.0 * of(x, y)) as usize] += 1;
        let apart = (of(x, y) - of(x + 1, y)).abs();
        assert!(apart.min(1.0 - apart) > 0.1, "{x} {y}: {apart}");
    }
    assert!(counts.iter().all(|n| (400..640).contains(n)), "{counts:?}");
}
